"""Run time against error: goals, sentences, tables and one figure per problem."""

import math

from curriculum import plotting, reporting
from curriculum.bench import contestants, tables
from curriculum.bench.problems import REFERENCE_DT
from curriculum.reporting import Claim, Goal, listed, ms, number

CLOSE = 0.1  # r, the error that "the cheapest to stay within" speaks of
TINY = 1e-10  # r, what exact has to stay within
GOAL_DTS = (0.0005, 0.001, 0.002, 0.004, 0.008)
LCP, FLYING = "20 sweeps", contestants.FLYING
LEAST = 1e-17  # r: an error of exactly zero is drawn here


class Points:
    """The points of a section, found by problem, family, words and dt."""

    def __init__(self, section):
        self.section = section
        self.all = tables.unpack(section["points"])

    def of(self, problem, family=None, words=None, dt=None):
        """The points that did not diverge."""
        return [
            p
            for p in self.all
            if p["problem"] == problem
            and not p["diverged"]
            and p["position_error"] is not None
            and family in (None, p["family"])
            and words in (None, p["words"])
            and dt in (None, p["dt"])
        ]

    def one(self, problem, family, words, dt=REFERENCE_DT):
        """One point, or None."""
        return next(iter(self.of(problem, family, words, dt)), None)

    def peers(self, problem, dt=REFERENCE_DT, adaptive=True):
        """The points of other engines at one dt; without `adaptive`, of those that step by it."""
        return [
            p
            for p in self.of(problem, dt=dt)
            if p["family"] not in contestants.OURS and (adaptive or not is_adaptive(p))
        ]

    def best(self, problem, family):
        """The setting of a family with the least error at the reference step, or None."""
        found = [p for p in self.of(problem, family, dt=REFERENCE_DT) if p["words"] != FLYING]
        return min(found, key=lambda p: p["position_error"], default=None)


def is_adaptive(point):
    found = contestants.BY_NAME.get(called(point, short=False))
    return found is not None and found.adaptive


def substeps(point):
    """How many steps an engine takes for each that it is asked for."""
    found = contestants.BY_NAME.get(called(point, short=False))
    return found.substeps if found else 1


def called(point, short=True):
    """The family and the setting of a point."""
    family = contestants.LABELS[point["family"]] if short else point["family"]
    return f"{family}: {point['words']}"


# goals


def goals(section):
    """Met or missed, one by one; only of problems that were measured."""
    data = Points(section)
    for problem, factor in (("drop", 0.1), ("bounce", 1.0)):
        if problem in section["problems"]:
            yield from _exact_goals(data, problem, factor)
    for problem in ("drop", "bounce", "stack"):
        if problem in section["problems"]:
            yield from _fast_goals(data, problem)
            yield _small_goal(data, problem)
            yield _small_goal(data, problem, by_substep=True)


def _exact_goals(data, problem, factor):
    exact = next(iter(data.of(problem, "exact")), None)
    wanted = f"exact, {problem}: its error at most {TINY:g} r"
    if exact is None:
        yield Goal(wanted, "exact did not run", None)
        return
    yield Goal(wanted, f"{number(exact['position_error'])} r", exact["position_error"] <= TINY)
    for way, words in (("read", "every height read in both"), ("bare", "the peer reading nothing")):
        peers = [p for p in data.peers(problem) if p[f"{way}_median"]]
        wanted = f"exact, {problem}: at most {factor:g} x the time of the fastest peer, {words}"
        if not peers:
            yield Goal(wanted, "no peer is installed", None)
            continue
        fastest = min(peers, key=lambda p: p[f"{way}_median"])
        ours, theirs = exact["read_median"], fastest[f"{way}_median"]
        yield Goal(
            wanted,
            f"{number(ours / theirs)} x {called(fastest)}: {ms(ours)} ms against {ms(theirs)} ms",
            ours <= factor * theirs,
        )


def _fast_goals(data, problem):
    """With the sweeps that lcp has as shipped; and with 10 where that was measured: pymunk's number."""
    wanted = (
        f"lcp, {problem}: at most 1 x the time of the fastest peer that steps by 2 ms, "
        "the peer reading nothing"
    )
    peers = data.peers(problem, adaptive=False)
    if not peers or data.one(problem, "lcp", LCP) is None:
        yield Goal(wanted, "no peer is installed", None)
        return
    fastest = min(peers, key=lambda p: p["bare_median"])
    for words, note in ((LCP, ""), ("10 sweeps", "; lcp with 10 sweeps, too")):
        ours = data.one(problem, "lcp", words)
        if ours is not None:
            mine, theirs = ours["read_median"], fastest["bare_median"]
            yield Goal(
                wanted + note,
                f"{number(mine / theirs)} x {called(fastest)}: {ms(mine)} ms against "
                f"{ms(theirs)} ms; error {number(ours['position_error'], 2)} r against "
                f"{number(fastest['position_error'], 2)} r",
                mine <= theirs,
            )


def _small_goal(data, problem, by_substep=False):
    """At the dt that was asked for; or, by substep, at the step that an engine makes of it."""
    wanted = f"lcp, {problem}: the smallest error of all that step by dt, at every dt to 8 ms"
    wanted += "; a substep counted as a step" if by_substep else ""
    better = []
    for dt in GOAL_DTS:
        ours = data.one(problem, "lcp", LCP, dt)
        others = [
            p
            for p in data.of(problem)
            if p["family"] not in ("lcp", "exact")
            and not is_adaptive(p)
            and math.isclose(dt, p["dt"] / (substeps(p) if by_substep else 1))
        ]
        if ours and others:
            best = min(others, key=lambda p: p["position_error"])
            if best["position_error"] < ours["position_error"]:
                better.append(
                    f"{called(best)} at {1e3 * dt:g} ms ({number(best['position_error'], 4)} "
                    f"against {number(ours['position_error'], 4)} r)"
                )
    return Goal(wanted, f"smaller: {listed(better)}" if better else "the smallest", not better)


# sentences


def claims(section, problem):
    """What the figure shows, each sentence with the condition it stands on."""
    data = Points(section)
    exact = max((p["position_error"] for p in data.of(problem, "exact")), default=None)
    if exact is not None:
        yield Claim(
            exact <= TINY,
            f"exact is off by rounding alone, {number(exact, 2)} r.",
            f"exact is off by {number(exact)} r.",
        )
    best = [p for p in (data.best(problem, f) for f in contestants.LABELS if f != "exact") if p]
    best.sort(key=lambda p: p["position_error"])
    if best:
        told = [f"{called(p)} {number(p['position_error'], 2)} r" for p in best[:4]]
        yield Claim(True, f"Least error at 2 ms, best setting of each: {'; '.join(told)}.")
    within = [
        p
        for p in data.of(problem)
        if p["family"] != "exact" and p["position_error"] <= CLOSE and p["words"] != FLYING
    ]
    if within:
        p = min(within, key=lambda p: p["read_median"])
        yield Claim(
            True,
            f"The cheapest to stay within {CLOSE:g} r is {called(p)} at "
            f"{1e3 * p['dt']:g} ms: {ms(p['read_median'])} ms.",
        )
    yield from _flying_claim(data, problem)
    yield from _diverged_claim(data, problem)


def _flying_claim(data, problem):
    plain, flying = data.one(problem, "lcp", LCP), data.one(problem, "lcp", FLYING)
    if plain and flying:
        a, b = (number(p["position_error"], 2) for p in (plain, flying))
        yield Claim(
            flying["position_error"] < plain["position_error"],
            f"Of lcp's {a} r at 2 ms, contact alone leaves {b} r when the ball flies exactly "
            "(dotted).",
            f"Flight and contact partly cancel in lcp: {a} r at 2 ms, but {b} r when the "
            "ball flies exactly (dotted).",
        )


def _diverged_claim(data, problem):
    blown = {}
    for p in data.all:
        if p["problem"] == problem and p["diverged"]:
            blown.setdefault(called(p), []).append(f"{1e3 * p['dt']:g}")
    told = [f"{name} at {listed(dts)} ms" for name, dts in blown.items()]
    yield Claim(bool(told), f"Diverged: {'; '.join(told)}.", "Nothing diverged.")


# the page


def page(section):
    """The whole page."""
    data = Points(section)
    parts = [
        f"Each problem has a known answer (`closed_form.py`). An error is the median over up to "
        f"{section['seeds']} starts; a time is the median over {section['processes']} processes, "
        "each of which runs everything in a random order of its own, after a warm-up (CPU time, one "
        "thread). In all alike "
        'every height is read after every step; "bare" is an engine\'s stepping loop alone. The '
        "closed forms are right to about 1e-14 r, the engines in float32 to about 1e-6 r.",
        "An engine that could do better: add a line to `SETTINGS` in "
        "[engines.py](../engines.py), measure, and send it.",
        "## Goals",
        reporting.goal_table(goals(section)),
        _left_out(section),
    ]
    for name, problem in section["problems"].items():
        parts += [
            f"## {problem['title']}",
            f"Hard on: {problem['stresses']}.",
            f"![Run time against error: {name}](error-{name}.svg)",
            reporting.sentences(claims(section, name)),
            f"At dt = {REFERENCE_DT:g} s:",
            _every_error(data, name),
            "Worst position error / r by dt [ms], and the order of convergence up to 8 ms:",
            _by_dt(data, name),
        ]
    return reporting.page("Run time against error", section, *parts)


def _left_out(section):
    told = [
        f"{contestants.LABELS[out['family']]} ({listed(out['problems'])}): {out['why']}"
        for out in section["left_out"]
    ]
    return f"Left out: {'; '.join(told)}." if told else ""


HEAD = {
    "worst position error / r (least to greatest start)": None,
    "final": "final_error",
    "worst energy error / E0": "energy_error",
    "final ": "final_energy_error",
    "deepest / r": "max_penetration",
    "rest gap / r": "rest_gap",
    "restitution": "restitution",
    "first impact off by / s": "impact_time_error",
    "phase off by / s": "phase_error",
}


def _every_error(data, problem):
    rows = [p for p in data.all if p["problem"] == problem and p["dt"] == REFERENCE_DT]
    shown = {
        head: key
        for head, key in HEAD.items()
        if key is None or any(p[key] is not None for p in rows)
    }
    lines = []
    for p in rows:
        error = (
            p["diverged"]
            and f"diverged, {p['diverged']}"
            or (
                f"{number(p['position_error'])} ({number(p['least_error'], 2)} to "
                f"{number(p['greatest_error'], 2)})"
            )
        )
        cells = [error if key is None else number(p[key], 2) for key in shown.values()]
        bare = p["bare_median"]
        lines.append(
            [
                called(p),
                *cells,
                f"{ms(p['read_median'])} ({ms(p['read_min'], 2)} to {ms(p['read_max'], 2)})",
                ms(bare) if bare else "-",
            ]
        )
    return reporting.table(["", *shown, "time, read [ms] (spread)", "bare [ms]"], lines)


def _by_dt(data, problem):
    mine = [p for p in data.all if p["problem"] == problem and not is_adaptive(p)]
    dts = sorted({p["dt"] for p in mine})
    orders = {
        (o["family"], o["words"]): o["order"]
        for o in data.section["orders"]
        if o["problem"] == problem
    }
    rows = []
    for family, words in dict.fromkeys((p["family"], p["words"]) for p in mine):
        found = {p["dt"]: p for p in mine if (p["family"], p["words"]) == (family, words)}
        cells = [
            "-"
            if dt not in found
            else "diverged"
            if found[dt]["diverged"]
            else number(found[dt]["position_error"])
            for dt in dts
        ]
        order = orders.get((family, words))
        rows.append([called(found[min(found)]), *cells, "-" if order is None else f"{order:.2f}"])
    return reporting.table(["", *(f"{1e3 * dt:g}" for dt in dts), "order"], rows)


# the figures


def figures(section):
    """{file name: SVG text}, one figure per problem."""
    return {f"error-{problem}.svg": _figure(section, problem) for problem in section["problems"]}


def _figure(section, problem):
    """Time against error: every point faint, the front of each family as a line."""
    data, about = Points(section), section["problems"][problem]
    figure, (left, axis) = plotting.figure(
        columns=2,
        share=(1, 6),
        height=3.6,
        below=1.9,
        title=about["title"],
        explained="Left and down is better. A faint dot is one setting at one step; lines join the "
        "best of an engine, whose best setting at 2 ms is named. Numbers: lcp's dt in ms.",
    )
    for panel in (left, axis):
        panel.set(xscale="log", yscale="log")
    for family in contestants.LABELS:
        points = [
            dict(p, shown=max(p["position_error"], LEAST))
            for p in data.of(problem, family)
            if p["words"] != FLYING
        ]
        if points:
            _family(left if family == "exact" else axis, data, problem, family, points)
    _flying_line(axis, data, problem)
    left.set(
        xlim=(1e-17, 1e-9),
        xticks=[1e-16, 1e-10],
        ylabel=f"time for {about['duration']:g} s of motion [ms]",
    )
    low, high = axis.get_xlim()
    axis.set(xlabel="worst position error / r", xlim=(low, min(high, 30)))
    left.minorticks_off()
    everything = [p["read_median"] * 1e3 for p in data.of(problem)]
    for panel in (left, axis):
        panel.set_ylim(min(everything) / 1.6, max(everything) * 1.6)
    axis.tick_params(labelleft=False)
    handles = [h for panel in (left, axis) for h in zip(*panel.get_legend_handles_labels())]
    figure.legend(
        *zip(*handles),
        loc="lower left",
        bbox_to_anchor=(0.0, 0.22 / figure.get_figheight()),
        handlelength=3.2,
        borderaxespad=0,
        fontsize=8.5,
    )
    return plotting.svg(figure, section)


def _family(axis, data, problem, family, points):
    look = plotting.look(family)
    axis.scatter(
        [p["shown"] for p in points],
        [p["read_median"] * 1e3 for p in points],
        s=7,
        color=look["color"],
        alpha=0.35,
        linewidths=0,
    )
    line = tables.front(points, "shown", "read_median")
    best = data.best(problem, family)
    label = called(best) if best else contestants.LABELS[family]
    plotting.line(
        axis,
        [p["shown"] for p in line],
        [p["read_median"] * 1e3 for p in line],
        family,
        label=label,
    )
    if family == "lcp":
        nearest = {p["dt"]: p for p in sorted(line, key=lambda p: -p["shown"])}
        for dt, p in nearest.items():  # each step once, where its error is least
            axis.annotate(
                f"{1e3 * dt:g}",
                (p["shown"], p["read_median"] * 1e3),
                (-3, -4),
                textcoords="offset points",
                fontsize=7.5,
                ha="right",
                va="top",
                color=look["color"],
            )


def _flying_line(axis, data, problem):
    points = sorted(data.of(problem, "lcp", FLYING), key=lambda p: p["dt"])
    if points:
        plotting.line(
            axis,
            [max(p["position_error"], LEAST) for p in points],
            [p["read_median"] * 1e3 for p in points],
            "lcp",
            ls=":",
            marker="",
            label="lcp, flying exactly (every step taken)",
        )
