"""Run time against error, as a page: goals, checked sentences, tables."""

from curriculum.bench import methods, report
from curriculum.bench.problems import REFERENCE_DT
from curriculum.bench.report import Claim, Goal, listed, ms, number

COMMAND = "python -m curriculum.bench"
WAYS = (("read", "every height read in both"), ("bare", "the peer reading nothing"))
CLOSE = 0.1     # r, the error that "the cheapest to stay within" speaks of


class Points:
    """The points of the error section, found by problem, method and dt."""

    def __init__(self, section):
        self.section, self.dts = section, section["dts"]
        self.by_key = {(p["problem"], p["method"], p["dt"]): p for p in section["points"]}
        self.orders = {(o["problem"], o["method"]): o["order"] for o in section["orders"]}
        self.present = [name for name, method in section["methods"].items() if not method["missing"]]
        self.peers = [name for name in self.present if name not in methods.OURS]

    def label(self, name):
        return self.section["methods"][name]["label"]

    def error(self, problem, method, dt=REFERENCE_DT):
        """Median height error / r; infinite where a run diverged."""
        p = self.by_key[problem, method, dt]
        value = p["height_error"]["median"]
        return float("inf") if p["diverged"] or value is None else value

    def errors(self, problem, method):
        return [self.error(problem, method, dt) for dt in self.dts]

    def time(self, problem, method, dt=REFERENCE_DT, way="read"):
        """Least time of the whole run [s]; contact.py's models have only the read one."""
        times = self.by_key[problem, method, dt]["times"]
        return times.get(way, times["read"])["min"]

    def fastest_peer(self, problem, way):
        return min(self.peers, key=lambda name: self.time(problem, name, REFERENCE_DT, way))


def goals(section):
    """exact against the fastest peer on the drop, lcp against all peers on the bounce."""
    data = Points(section)
    return [*(_time_goal(data, "exact", "drop", 0.25, way, said) for way, said in WAYS),
            _exact_error_goal(data), _lcp_error_goal(data),
            *(_time_goal(data, "lcp", "bounce", 2.0, way, said) for way, said in WAYS)]


def _time_goal(data, model, problem, limit, way, said):
    wanted = f"{model}, {problem}: at most {limit:g} x the time of the fastest peer, {said}"
    if not data.peers:
        return Goal(wanted, "no peer is installed", None)
    peer = data.fastest_peer(problem, way)
    ours, theirs = data.time(problem, model), data.time(problem, peer, way=way)
    return Goal(wanted, f"{number(ours / theirs)} x {data.label(peer)}: {ms(ours)} ms against "
                f"{ms(theirs)} ms", ours <= limit * theirs)


def _exact_error_goal(data):
    wanted = "exact, drop: its error at least 1e8 times smaller than that peer's"
    if not data.peers:
        return Goal(wanted, "no peer is installed", None)
    ours = data.error("drop", "exact")
    theirs = data.error("drop", data.fastest_peer("drop", "bare"))
    return Goal(wanted, f"{number(ours)} r against {number(theirs)} r", ours * 1e8 <= theirs)


def _lcp_error_goal(data):
    wanted = "lcp, bounce: a smaller median error than every peer at every dt"
    if not data.peers:
        return Goal(wanted, "no peer is installed", None)
    ours = dict(zip(data.dts, data.errors("bounce", "lcp")))
    worse = [f"{data.label(name)} at {dt * 1e3:g} ms ({number(ours[dt])} r against {number(theirs)} r)"
             for name in data.peers for dt, theirs in zip(data.dts, data.errors("bounce", name))
             if ours[dt] >= theirs]
    told = "not smaller than " + listed(worse) if worse else (
        f"smaller at all of them; at {REFERENCE_DT:g} s {number(ours[REFERENCE_DT])} r against " + listed(
            f"{number(data.error('bounce', name))} ({data.label(name)})" for name in data.peers))
    return Goal(wanted, told, not worse)


def claims(section, problem):
    """The sentences under one problem's figure."""
    data = Points(section)
    said = [_exact_claim(data, problem)]
    if problem in ("drop", "bounce"):
        said.append(_penalty_claim(data, problem))
    else:
        said.append(_sweeps_claim(data, problem))
    if data.peers:
        said += [_lcp_claim(data, problem), *_cheapest_claim(data, problem)]
    return [*said, _diverged_claim(data, problem)]


def _others(data):
    return [name for name in data.present if name != "exact"]


def _exact_claim(data, problem):
    worst = max(data.errors(problem, "exact"))
    best = min(_others(data), key=lambda name: min(data.errors(problem, name)))
    least = min(data.errors(problem, best))
    others = f"the least error of all the others is {number(least)} r ({data.label(best)})."
    return Claim(worst < 1e-9 and worst < 1e-3 * least,
                 f"exact is off by rounding alone, at most {number(worst)} r at any step; {others}",
                 f"exact is off by up to {number(worst)} r; {others}")


def _penalty_claim(data, problem):
    fine, coarse = min(data.dts), max(dt for dt in data.dts if dt <= 0.004)
    small, large = data.error(problem, "penalty", fine), data.error(problem, "penalty", coarse)
    from_to = f"{number(large)} r at {coarse * 1e3:g} ms and {number(small)} r at {fine * 1e3:g} ms"
    point = data.by_key[problem, "penalty", fine]
    own = (f"its spring gives way by {number(point['max_penetration']['median'], 2)} r"
           if problem == "drop" else
           f"it has no restitution to set, and rebounds with {number(point['restitution']['median'])}")
    return Claim(small > 0.5 * large, f"Smaller steps do not help penalty ({from_to}), since {own}.",
                 f"penalty's error depends on the step: {from_to}.")


def _sweeps_claim(data, problem):
    errors = [data.error(problem, name) for name in ("lcp10", "lcp", "lcp100")]
    shown = f"10, 20 and 100 of them leave {listed(f'{number(e)} r' for e in errors)} at 2 ms."
    return Claim(errors[0] > 1.2 * errors[1] > 1.44 * errors[2],
                 f"More sweeps of lcp buy accuracy: {shown}",
                 f"More sweeps of lcp buy little height accuracy here: {shown}")


def _lcp_claim(data, problem):
    """How lcp stands among the peers at each step: better than all, or which are better."""
    better = {name: [dt for dt in data.dts
                     if data.error(problem, name, dt) < data.error(problem, "lcp", dt)]
              for name in data.peers}
    told = [f"{data.label(name)} at {listed(f'{dt * 1e3:g}' for dt in dts)} ms"
            for name, dts in better.items() if dts]
    return Claim(not told, "At no step does a peer have a smaller error than lcp with 20 sweeps.",
                 f"A smaller error than lcp with 20 sweeps: {'; '.join(told)}.")


def _cheapest_claim(data, problem):
    within = [(data.time(problem, name, dt), name, dt) for name in _others(data) for dt in data.dts
              if data.error(problem, name, dt) <= CLOSE]
    if within:
        time, name, dt = min(within)
        yield Claim(True, f"The cheapest time stepper to stay within {CLOSE:g} r is {data.label(name)} "
                    f"at {dt * 1e3:g} ms: {ms(time)} ms, against {ms(data.time(problem, 'exact'))} ms "
                    f"for exact sampled every {REFERENCE_DT * 1e3:g} ms.", "")


def _diverged_claim(data, problem):
    blown = {name: [f"{dt * 1e3:g}" for dt in data.dts if data.by_key[problem, name, dt]["diverged"]]
             for name in data.present}
    told = [f"{data.label(name)} at {listed(dts)} ms" for name, dts in blown.items() if dts]
    return Claim(bool(told), f"Diverged: {'; '.join(told)}.", "Nothing diverged.")


def page(section):
    """The whole page."""
    data = Points(section)
    missing = [f"{m['label']}: {m['missing']}" for m in section["methods"].values() if m["missing"]]
    parts = [
        f"Each problem has a known answer (`closed_form.py`). An error is the median over "
        f"{len(section['seeds'])} start heights; a time is the least of up to {section['rounds']} "
        "interleaved rounds, each of them the median over the start heights. In all methods alike every "
        "height is read after every step; \"bare\" is a peer's stepping loop alone. Nothing else is "
        "inside the timed part.",
        "## Goals", report.goal_table(goals(section)),
        f"Left out: {'; '.join(missing)}." if missing else ""]
    for name, problem in section["problems"].items():
        parts += [f"## {problem['title']}", f"Hard on: {problem['stresses']}.",
                  f"![Run time against error: {name}](error-{name}.svg)",
                  report.sentences(claims(section, name)),
                  f"At dt = {REFERENCE_DT:g} s:", _every_error(section, data, name),
                  "Worst height error / r, by dt [ms], and order of convergence, fitted up to 8 ms:",
                  _by_dt(section, data, name),
                  "Least time of the run [ms], by dt [ms], every height read:", _times(data, name)]
    return report.page("Run time against error", COMMAND, section, *parts)


def _every_error(section, data, problem):
    head = ["method", "height error / r (least to greatest)", "deepest / r", "depth at the end / r",
            "energy put in by contact / start energy", "restitution", "impact time off by [ms]",
            "time, read [ms] (slowest round)", "bare [us a step]"]
    rows = []
    for name, method in section["methods"].items():
        if method["missing"]:
            rows.append([method["label"], method["missing"], *[""] * (len(head) - 2)])
            continue
        p = data.by_key[problem, name, REFERENCE_DT]
        error, read, bare = p["height_error"], p["times"]["read"], p["times"].get("bare")
        median = {key: p[key]["median"] for key in (
            "max_penetration", "rest_penetration", "contact_energy", "restitution", "impact_time_error")}
        rows.append([
            method["label"],
            _diverged(p) or f"{number(error['median'])} ({number(error['min'], 2)} to "
                            f"{number(error['max'], 2)})",
            number(median["max_penetration"], 2), number(median["rest_penetration"], 2),
            number(median["contact_energy"], 2), number(median["restitution"]),
            ms(median["impact_time_error"], 2), f"{ms(read['min'])} ({ms(read['max'])})",
            number(1e6 * bare["min"] / p["steps"]) if bare else "-"])
    return report.table(head, rows)


def _by_dt(section, data, problem):
    rows = []
    for name in data.present:
        method, order = section["methods"][name], data.orders[problem, name]
        points = [data.by_key[problem, name, dt] for dt in data.dts]
        rows.append([method["label"],
                     *(_diverged(p, short=True) or number(p["height_error"]["median"]) for p in points),
                     "-" if order is None else f"{order:.2f}",
                     method["why"] if method["theory"] is None else f"{method['theory']}: {method['why']}"])
    return report.table(["method", *(f"{dt * 1e3:g}" for dt in data.dts), "order", "in theory"], rows)


def _times(data, problem):
    return report.table(["method", *(f"{dt * 1e3:g}" for dt in data.dts)], [
        [data.label(name), *(ms(data.time(problem, name, dt)) for dt in data.dts)]
        for name in data.present])


def _diverged(point, short=False):
    """Empty, or where and why a point diverged."""
    d = point["diverged"]
    if not d:
        return ""
    if short:
        return f"diverged, step {d['step']}"
    return (f"diverged at step {d['step']} ({d['reason']}; {d['count']} of {d['of']} start heights)")
