"""The pages: goals, checked sentences and tables in Markdown, from results.json alone.

A sentence of reading is a Claim: it carries the condition it stands on, and where the data do not
bear it out, the other sentence is printed instead. Nothing here measures.
"""

import math
import statistics
from typing import NamedTuple

from curriculum.bench import skips, store

MISSED, MET = "**missed**", "met"
REF = "0.002"       # s, the step of the tables with every error


class Claim(NamedTuple):
    """`said` where it holds, `instead` where it does not: never `said` without its condition."""
    holds: bool
    said: str
    instead: str

    def __str__(self):
        return self.said if self.holds else self.instead


class Goal(NamedTuple):
    """A number to reach, what was measured, and whether that reaches it (None: could not be measured)."""
    wanted: str
    measured: str
    met: object

    def row(self):
        return [self.wanted, self.measured, "not measured" if self.met is None else MET if self.met else MISSED]


def table(head, rows):
    """A Markdown table; numbers are right-aligned by the reader's own renderer."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def number(value, digits=3):
    """A number with that many significant digits, never in a form like 1e+03; "-" for None."""
    if value is None:
        return "-"
    if value == 0 or math.isinf(value):
        return f"{value:g}"
    if 1e-3 <= abs(value) < 1e5:
        decimals = max(0, digits - 1 - _exponent(value, digits))
        return f"{value:.{decimals}f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def _exponent(value, digits):
    return int(f"{value:.{digits - 1}e}".split("e")[1])


def listed(items):
    """a, b and c."""
    items = list(items)
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))


class Points:
    """The points of the error section, found by problem, method and dt."""

    def __init__(self, section):
        self.section, self.dts = section, section["dts"]
        self.by_key = {(p["problem"], p["method"], p["dt"]): p for p in section["points"]}
        self.orders = {(o["problem"], o["method"]): o["order"] for o in section["orders"]}
        self.present = [name for name in section["methods"]
                        if (next(iter(section["problems"])), name, self.dts[0]) in self.by_key]
        self.peers = [name for name in self.present if name not in ("exact", "penalty", "lcp", "lcp10", "lcp100")]

    def label(self, name):
        return self.section["methods"][name]["label"]

    def error(self, problem, method, dt):
        """Median height error / r; infinite where a run diverged."""
        p = self.by_key[problem, method, dt]
        value = p["height_error"]["median"]
        return float("inf") if p["diverged"] or value is None else value

    def time(self, problem, method, dt, way="read"):
        """Least time of the whole run [s]; contact.py's models have only the read one."""
        times = self.by_key[problem, method, dt]["times"]
        return times.get(way, times["read"])["min"]

    def fastest_peer(self, problem, dt, way):
        return min(self.peers, key=lambda name: self.time(problem, name, dt, way)) if self.peers else None


def error_goals(section):
    """Issue: exact against the fastest peer on the drop, lcp against all peers on the bounce."""
    data, dt = Points(section), 0.002
    goals = []
    for way, said in (("read", "every height read in both"), ("bare", "the peer reading nothing")):
        peer = data.fastest_peer("drop", dt, way)
        if peer is None:
            goals.append(Goal(f"exact, drop: at most 0.25 x the time of the fastest peer, {said}",
                              "no peer is installed", None))
            continue
        ratio = data.time("drop", "exact", dt) / data.time("drop", peer, dt, way)
        goals.append(Goal(
            f"exact, drop: at most 0.25 x the time of the fastest peer, {said}",
            f"{number(ratio)} x {data.label(peer)}: {number(1e3 * data.time('drop', 'exact', dt))} ms against "
            f"{number(1e3 * data.time('drop', peer, dt, way))} ms", ratio <= 0.25))
    if data.peers:
        peer = data.fastest_peer("drop", dt, "bare")
        exact, other = data.error("drop", "exact", dt), data.error("drop", peer, dt)
        goals.append(Goal("exact, drop: its error at least 1e8 times smaller than that peer's",
                          f"{number(exact)} r against {number(other)} r", exact * 1e8 <= other))
        worse = [(name, step) for name in data.peers for step in data.dts
                 if data.error("bounce", "lcp", step) >= data.error("bounce", name, step)]
        goals.append(Goal(
            "lcp, bounce: a smaller median error than every peer at every dt",
            "smaller at all of them" if not worse else "not smaller than " + listed(
                f"{data.label(name)} at {step * 1e3:g} ms ({number(data.error('bounce', 'lcp', step))} r against "
                f"{number(data.error('bounce', name, step))} r)" for name, step in worse), not worse))
        for way, said in (("read", "every height read in both"), ("bare", "the peer reading nothing")):
            peer = data.fastest_peer("bounce", dt, way)
            ratio = data.time("bounce", "lcp", dt) / data.time("bounce", peer, dt, way)
            goals.append(Goal(
                f"lcp, bounce: at most 2 x the time of the fastest peer, {said}",
                f"{number(ratio)} x {data.label(peer)}: {number(1e3 * data.time('bounce', 'lcp', dt))} ms against "
                f"{number(1e3 * data.time('bounce', peer, dt, way))} ms", ratio <= 2.0))
    return goals


def error_claims(section, problem):
    """The sentences under one problem's figure."""
    data, dt = Points(section), 0.002
    others = [name for name in data.present if name != "exact"]
    exact = max(data.error(problem, "exact", step) for step in data.dts)
    best = min(others, key=lambda name: min(data.error(problem, name, step) for step in data.dts))
    least = min(data.error(problem, best, step) for step in data.dts)
    claims = [Claim(
        exact < 1e-9 and exact < 1e-3 * least,
        f"exact is off by rounding alone, at most {number(exact)} r at any step; the least error of all the "
        f"others is {number(least)} r ({data.label(best)}).",
        f"exact is off by up to {number(exact)} r; the least error of the others is {number(least)} r "
        f"({data.label(best)}).")]
    if problem in ("drop", "bounce"):
        fine, coarse = min(data.dts), max(step for step in data.dts if step <= 0.004)
        small, large = (data.error(problem, "penalty", step) for step in (fine, coarse))
        claims.append(Claim(
            small > 0.5 * large,
            f"Smaller steps do not help penalty: {number(large)} r at {coarse * 1e3:g} ms and {number(small)} r at "
            f"{fine * 1e3:g} ms, what is wrong is the spring itself.",
            f"penalty's error falls from {number(large)} r at {coarse * 1e3:g} ms to {number(small)} r at "
            f"{fine * 1e3:g} ms."))
    if problem == "bounce" and data.peers:
        claims.append(Claim(
            all(data.error(problem, "lcp", step) < data.error(problem, name, step)
                for name in data.peers for step in data.dts),
            "At every step lcp's error is the least of all time steppers in the figure.",
            "lcp's error is not the least of the time steppers at every step: see the table."))
    if problem in ("stack", "tower"):
        sweeps = [data.error(problem, name, dt) for name in ("lcp10", "lcp", "lcp100")]
        shown = listed(f"{number(e)} r" for e in sweeps)
        claims.append(Claim(
            sweeps[0] > 1.2 * sweeps[1] > 1.44 * sweeps[2],
            f"More sweeps buy accuracy: 10, 20 and 100 of them leave {shown} at {dt * 1e3:g} ms.",
            f"More sweeps buy little height accuracy here: 10, 20 and 100 of them leave {shown} at "
            f"{dt * 1e3:g} ms."))
    if data.peers:
        within = [(data.time(problem, name, step), name, step) for name in others for step in data.dts
                  if data.error(problem, name, step) <= 0.1]
        if within:
            time, name, step = min(within)
            claims.append(Claim(
                True, f"The cheapest time stepper to stay within 0.1 r is {data.label(name)} at {step * 1e3:g} ms: "
                f"{number(1e3 * time)} ms, against {number(1e3 * data.time(problem, 'exact', dt))} ms for exact "
                f"sampled every {dt * 1e3:g} ms.", ""))
    blown = [f"{data.label(name)} at {listed(f'{step * 1e3:g}' for step in steps)} ms"
             for name in data.present
             if (steps := [s for s in data.dts if data.by_key[problem, name, s]["diverged"]])]
    claims.append(Claim(bool(blown), f"Diverged: {'; '.join(blown)}.", "Nothing diverged."))
    return claims


def error_page(section):
    """Run time against error, as a page."""
    data = Points(section)
    heights = len(section["seeds"])
    parts = ["# Run time against error\n", "Written by `python -m curriculum.bench`; do not edit.\n",
             f"Each problem has a known answer (`closed_form.py`). An error is the median over {heights} start "
             f"heights, a time the least of up to {section['rounds']} interleaved rounds, each the median over the "
             "start heights. In the figures every method's every height is read after every step; \"bare\" is the "
             "peer's stepping loop alone. Nothing else is inside the timed part.\n",
             "## Goals\n", table(["goal", "measured", ""], [goal.row() for goal in error_goals(section)])]
    missing = [f"{m['label']}: {m['missing']}" for m in section["methods"].values() if m["missing"]]
    if missing:
        parts.append("Left out: " + "; ".join(missing) + ".\n")
    for name, problem in section["problems"].items():
        parts += [f"## {problem['title']}\n", f"Hard on: {problem['stresses']}.\n",
                  f"![Run time against error: {name}](error-{name}.svg)\n",
                  " ".join(map(str, error_claims(section, name))) + "\n",
                  f"At dt = {REF} s:\n", _all_errors(section, data, name),
                  "Worst height error / r, by dt [ms], and order of convergence, fitted up to 8 ms:\n",
                  _by_dt(section, data, name)]
    return "\n".join([*parts, "---\n", store.footer(section)]) + "\n"


def _all_errors(section, data, problem):
    head = ["method", "height error / r (least to greatest)", "deepest / r", "depth at the end / r",
            "energy put in by contact", "restitution", "impact time off by [ms]", "time, read [ms] (slowest round)",
            "bare [us a step]"]
    rows = []
    for name, method in section["methods"].items():
        if name not in data.present:
            rows.append([method["label"], method["missing"], *[""] * (len(head) - 2)])
            continue
        p = data.by_key[problem, name, float(REF)]
        read, bare = p["times"]["read"], p["times"].get("bare")
        error = p["height_error"]
        late = p["impact_time_error"]["median"]
        rows.append([
            method["label"],
            _diverged(p) or f"{number(error['median'])} ({number(error['min'], 2)} to {number(error['max'], 2)})",
            *(number(p[key]["median"], 2) for key in ("max_penetration", "rest_penetration", "contact_energy")),
            number(p["restitution"]["median"]), number(None if late is None else 1e3 * late, 2),
            f"{number(1e3 * read['min'])} ({number(1e3 * read['max'])})",
            number(1e6 * bare["min"] / p["steps"]) if bare else "-"])
    return table(head, rows)


def _by_dt(section, data, problem):
    rows = []
    for name in data.present:
        method, order = section["methods"][name], data.orders[problem, name]
        theory = "-" if method["theory"] is None else method["theory"]
        cells = [_diverged(p, short=True) or number(p["height_error"]["median"])
                 for p in (data.by_key[problem, name, dt] for dt in data.dts)]
        rows.append([method["label"], *cells, "-" if order is None else f"{order:.2f}",
                     f"{theory}: {method['why']}"])
    return table(["method", *(f"{dt * 1e3:g}" for dt in data.dts), "order, fitted", "in theory"], rows)


def _diverged(point, short=False):
    """'' or where and why a point diverged."""
    d = point["diverged"]
    if not d:
        return ""
    if short:
        return f"diverged, step {d['step']}"
    return f"diverged at step {d['step']} ({d['reason']}; {d['count']} of {d['of']} start heights)"


def skip_limits():
    return {**skips.LIMITS, skips.RECORDED: skips.RECORDING_LIMIT}


def skip_goals(section):
    """Same bytes, whole processes, memory, and lcp in the process against pymunk."""
    same, processes, inside = section["same_bytes"], section["processes"], section["in_process"]
    differ = f"; they differ in {listed(same['differing'][:5])}" if same["differing"] else ""
    goals = [Goal("the same bytes with and without skips",
                  f"{len(same['differing'])} of {same['runs']} pairs of runs and {same['command_lines']} pairs of "
                  f"command lines differ{differ}", not same["differing"])]
    for name, limit in skip_limits().items():
        ratio = processes["ratios"].get(name)
        wanted = f"whole process, {name}: at most {limit:g} x importing {'rerun' if name == skips.RECORDED else 'numpy'}"
        if ratio is None:
            goals.append(Goal(wanted, "rerun is not installed", None))
            continue
        published = skips.PUBLISHED.get(name)
        goals.append(Goal(wanted, f"{number(ratio['time'])} x" + (f" (published script: {published:g} x)"
                                                              if published else ""), ratio["time"] <= limit))
    memory = {name: r["memory"] for name, r in processes["ratios"].items() if r["base"] == "numpy"}
    worst = max(memory, key=memory.get)
    goals.append(Goal(f"peak memory: at most {skips.MEMORY_LIMIT:g} x importing numpy",
                      f"{number(memory[worst])} x at most ({worst})", memory[worst] <= skips.MEMORY_LIMIT))
    times = inside["times"]
    if inside["missing"]:
        goals.append(Goal("2000 steps of the drop: lcp no slower than pymunk", inside["missing"], None))
    else:
        lcp, peer = (times[name]["median"] for name in ("lcp", skips.BARE_PEER))
        goals.append(Goal("2000 steps of the drop: lcp, recorded, no slower than pymunk, nothing read",
                          f"{number(1e3 * lcp)} ms against {number(1e3 * peer)} ms, {number(lcp / peer)} x",
                          lcp <= peer))
    return goals


def skip_claims(section):
    rows = section["speed_up"]
    best, least = (pick(rows, key=lambda row: row["ratio"]) for pick in (max, min))
    return [Claim(least["ratio"] >= 1.0,
                  f"Skipping pays in every case, from {least['ratio']:.1f} x ({least['scene']}, {least['model']}) to "
                  f"{best['ratio']:.1f} x ({best['scene']}, {best['model']}).",
                  f"Skipping pays most on {best['scene']} with {best['model']}, {best['ratio']:.1f} x; where no state "
                  f"comes back and nothing flies it costs a little: {least['scene']}, {least['model']}, "
                  f"{least['ratio']:.2f} x.")]


def skip_page(section):
    """Skipping, as a page."""
    measured = section["processes"]["measured"]
    processes = [[name, number(1e3 * statistics.median(parts["seconds"])), number(1e3 * min(parts["seconds"])),
                  number(1e3 * max(parts["seconds"])), number(statistics.median(parts["memory"]) / 2**20)]
                 for name, parts in measured.items()]
    speed = [[row["scene"], row["bodies"], row["model"], row["steps"], number(1e3 * row["skip"]["median"]),
              number(1e3 * row["no_skip"]["median"]), f"{row['ratio']:.2f}"] for row in section["speed_up"]]
    inside = [[name, number(1e3 * t["median"]), number(1e3 * t["min"]), number(1e3 * t["max"])]
              for name, t in section["in_process"]["times"].items()]
    return "\n".join([
        "# Skipping what a scene does not need\n", "Written by `python -m curriculum.bench skip`; do not edit.\n",
        "Everything is interleaved in rounds of one run; ratios are ratios of medians.\n",
        "## Goals\n", table(["goal", "measured", ""], [goal.row() for goal in skip_goals(section)]),
        "![Skipping: cost and saving](skip.svg)\n", " ".join(map(str, skip_claims(section))) + "\n",
        "## One run in the process, with and without skips\n",
        table(["scene", "balls", "model", "steps", "skip [ms]", "no-skip [ms]", "speed-up"], speed),
        "## Whole processes\n",
        table(["process", "median [ms]", "least [ms]", "greatest [ms]", "peak memory [MiB]"], processes),
        "## 2000 steps of the drop in the process\n", table(["", "median [ms]", "least [ms]", "greatest [ms]"], inside),
        "---\n", store.footer(section)]) + "\n"


def pile_row(section, name, bodies):
    return next((r for r in section["rows"] if (r["method"], r["bodies"]) == (name, bodies)), None)


def pile_goals(section):
    """Growth of lcp's time per step, and where it stands beside pymunk on the largest pile."""
    largest = max(row["bodies"] for row in section["rows"])
    goals = []
    exponent = section["exponents"].get("lcp")
    wanted = "lcp's time per settled step grows with exponent at most 1.15 from 1,000 to 10,000 balls"
    if exponent is None:
        goals.append(Goal(wanted, "needs the full run", None))
    else:
        goals.append(Goal(wanted, f"{exponent['settled']:.2f} settled, {exponent['early']:.2f} early",
                          exponent["settled"] <= 1.15))
    ours, peer = (pile_row(section, name, largest) for name in ("lcp", "pymunk"))
    wanted = f"lcp level with pymunk on {largest:,} balls, settled, {section['sweeps']} sweeps each"
    if peer is None:
        goals.append(Goal(wanted, section["missing"].get("pymunk", "-"), None))
    else:
        ratio = ours["settled"]["median"] / peer["settled"]["median"]
        goals.append(Goal(wanted, f"{number(ratio)} x its time per step, mean depth {number(ours['mean_depth'])} r against "
                          f"{number(peer['mean_depth'])} r", ratio <= 1.05))
    return goals


def pile_claims(section):
    largest = max(row["bodies"] for row in section["rows"])
    rows = [r for r in section["rows"] if r["bodies"] == largest and r["method"] != "all pairs" and r["finite"]]
    fastest, shallow = min(rows, key=lambda r: r["settled"]["median"]), min(rows, key=lambda r: r["mean_depth"])
    ours, slow = (pile_row(section, name, largest) for name in ("lcp", "all pairs"))
    claims = [Claim(True, f"On {largest:,} settled balls {_pile_label(fastest)} is the fastest, "
                    f"{number(1e3 * fastest['settled']['median'])} ms a step (lcp: "
                    f"{number(1e3 * ours['settled']['median'])} ms); {_pile_label(shallow)} leaves the least mean "
                    f"depth, {number(shallow['mean_depth'], 2)} r (lcp: {number(ours['mean_depth'], 2)} r).", "")]
    if slow is not None:
        ratio = slow["settled"]["median"] / ours["settled"]["median"]
        claims.append(Claim(ratio > 1.0, f"Looking at near pairs only and sweeping groups at once, with the same "
                            f"bits, is {ratio:,.0f} times faster than all pairs one by one.",
                            f"All pairs one by one take {ratio:.2f} times as long as near pairs in groups."))
    broken = [_pile_label(r) for r in section["rows"] if not r["finite"]]
    if broken:
        claims.append(Claim(True, f"Not finite at the end: {listed(broken)}.", ""))
    return claims


def _pile_label(row):
    from curriculum.bench import methods
    names = {"lcp": "lcp", "all pairs": "lcp, all pairs one by one"}
    return names.get(row["method"]) or methods.BY_NAME[row["method"]].label


def pile_page(section):
    """The pile, as a page."""
    rows = [[f"{r['bodies']:,}", _pile_label(r), *(f"{number(1e3 * r[phase]['median'])} "
             f"({number(1e3 * r[phase]['min'], 2)} to {number(1e3 * r[phase]['max'], 2)})"
             for phase in ("early", "settled")), number(r["mean_depth"], 2), number(r["worst_depth"], 2),
             r["contacts"] if r["finite"] else "not finite"] for r in section["rows"]]
    grown = [[_pile_label(dict(method=name)), f"{e['early']:.2f}", f"{e['settled']:.2f}"]
             for name, e in section["exponents"].items()]
    missing = [f"{name}: {what}" for name, what in section["missing"].items()]
    return "\n".join([
        "# A pile of many balls\n", "Written by `python -m curriculum.bench pile`; do not edit.\n",
        f"All engines step the same pile (seed 0, steps of {section['dt'] * 1e3:g} ms) in turns of one run, reading "
        "nothing. Early is the first tenth of the run, settled the last quarter. \"All pairs one by one\" takes single "
        "steps from lcp's first and last state.\n", *([f"Left out: {'; '.join(missing)}.\n"] if missing else []),
        "## Goals\n", table(["goal", "measured", ""], [goal.row() for goal in pile_goals(section)]),
        "![A pile of N balls](pile.svg)\n", " ".join(map(str, pile_claims(section))) + "\n",
        table(["balls", "method", "early [ms a step]", "settled [ms a step]", "mean depth / r", "worst depth / r",
               "contacts at the end"], rows),
        *(["Exponent of the time per step, from 1,000 balls on:\n", table(["method", "early", "settled"], grown)]
          if grown else []),
        "---\n", store.footer(section)]) + "\n"
