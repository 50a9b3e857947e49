"""The pile of many balls: goals, sentences, a table and a figure."""

from curriculum import plotting, reporting
from curriculum.bench import piles
from curriculum.reporting import Claim, Goal, listed, ms, number

GOAL = 0.6  # x the fastest rival's time per settled step
LOOKS = {
    piles.LCP: "lcp",
    "pymunk, 10 iterations": "pymunk",
    "Box2D 2.3": "box2d",
    "Box2D 3, 4 substeps": "box2d3",
    "MuJoCo as shipped": "mujoco",
}


def row(section, name, bodies):
    """One method at one size, or None."""
    return next((r for r in section["rows"] if (r["method"], r["bodies"]) == (name, bodies)), None)


def sizes(section):
    return sorted({r["bodies"] for r in section["rows"]})


def rivals(section, bodies):
    """The rows of the engines that the goal names, where they end finite."""
    return [
        r
        for r in section["rows"]
        if r["bodies"] == bodies
        and r["finite"]
        and piles.ENGINES.get(r["method"], ("",))[0] in piles.RIVALS
    ]


def goals(section):
    """The compiled twin against the fastest rival, at every size."""
    for bodies in sizes(section):
        wanted = (
            f"lcp compiled, {bodies:,} balls, settled: at most {GOAL:g} x the fastest of pymunk, "
            "Box2D 3 and MuJoCo"
        )
        ours, others = row(section, piles.LCP, bodies), rivals(section, bodies)
        if ours is None or not others:
            yield Goal(wanted, "numba or the engines are not installed", None)
            continue
        best = min(others, key=lambda r: r["settled"]["median"])
        ratio = ours["settled"]["median"] / best["settled"]["median"]
        yield Goal(
            wanted,
            f"{number(ratio)} x {best['method']}: {ms(ours['settled']['median'])} ms "
            f"against {ms(best['settled']['median'])} ms; mean depth "
            f"{number(ours['mean_depth'], 2)} r against {number(best['mean_depth'], 2)} r",
            ratio <= GOAL,
        )


def claims(section):
    if not section["rows"]:
        return  # neither numba nor an engine is installed
    largest = sizes(section)[-1]
    sound = [
        r
        for r in section["rows"]
        if r["bodies"] == largest and r["finite"] and r["method"] != piles.PLAIN
    ]
    flattest = min(sound, key=lambda r: r["mean_depth"])
    yield Claim(
        True,
        f"On {largest:,} balls {flattest['method']} leaves the least mean depth, "
        f"{number(flattest['mean_depth'], 2)} r.",
    )
    known = max((r["bodies"] for r in section["rows"] if r["method"] == piles.PLAIN), default=None)
    if known:
        ratio = (
            row(section, piles.PLAIN, known)["settled"]["median"]
            / row(section, piles.LCP, known)["settled"]["median"]
        )
        yield Claim(
            True,
            f"The plain loops take {ratio:,.0f} times as long on {known:,} balls, to the "
            "same bits.",
        )
    broken = [f"{r['method']} ({r['bodies']:,} balls)" for r in section["rows"] if not r["finite"]]
    yield Claim(bool(broken), f"Not finite at the end: {listed(broken)}.")
    asleep = [
        f"{r['bodies']:,}" for r in section["rows"] if r["method"] == piles.LCP and r["repeated"]
    ]
    yield Claim(
        bool(asleep),
        f"Some turns of lcp ended in a state that repeats, so that it copied the "
        f"rest of the turn: {listed(asleep)} balls.",
    )


def page(section):
    """The whole page."""
    rows = [
        [
            f"{r['bodies']:,}",
            r["method"],
            *(_time(r[phase]) for phase in ("early", "settled")),
            number(r["mean_depth"], 2),
            number(r["worst_depth"], 2),
            r["contacts"] if r["finite"] else "not finite",
        ]
        for r in section["rows"]
    ]
    rows += [
        [f"{bodies:,}", "lcp of the first edition, as measured then", "-", ms(time), "-", "-", "-"]
        for bodies, time in piles.FIRST_EDITION.items()
        if bodies in sizes(section)
    ]
    rows.sort(key=lambda cells: int(cells[0].replace(",", "")))
    grown = [
        [name, f"{exponent['early']:.2f}", f"{exponent['settled']:.2f}"]
        for name, exponent in section["exponents"].items()
    ]
    missing = [f"{name}: {why}" for name, why in section["missing"].items()]
    return reporting.page(
        "A pile of many balls",
        section,
        f"All step the same pile (seed 0, steps of {section['dt'] * 1e3:g} ms), reading nothing; lcp and "
        f"pymunk with {section['sweeps']} sweeps a step. Early is the first tenth of the run, settled "
        "the last quarter; times are medians over processes, in brackets from the least to the greatest.",
        f"Left out: {'; '.join(missing)}." if missing else "",
        "## Goals",
        reporting.goal_table(goals(section)),
        "![A pile of N balls](pile.svg)",
        reporting.sentences(claims(section)),
        reporting.table(
            [
                "balls",
                "method",
                "early [ms a step]",
                "settled [ms a step]",
                "mean depth / r",
                "worst depth / r",
                "contacts at the end",
            ],
            rows,
        ),
        "Exponent of the time per step, from 1,000 balls on:" if grown else "",
        reporting.table(["method", "early", "settled"], grown) if grown else "",
    )


def _time(times):
    return f"{ms(times['median'])} {reporting.spread(times)}"


def figures(section):
    """{file name: SVG text}: time per settled step against N, and against the depth left."""
    figure, (upper, lower) = plotting.figure(
        rows=2,
        height=3.0,
        below=1.05,
        title="A pile of N balls: time per settled step",
        explained=f"lcp and pymunk with {section['sweeps']} sweeps a step, the others with their own "
        "number. Hollow: the hardest setting, or MuJoCo's direct one. Below: what the speed "
        "costs in depth.",
    )
    largest = sizes(section)[-1]
    for name in dict.fromkeys(r["method"] for r in section["rows"]):
        look = dict(_look(name), label=name)
        mine = [r for r in section["rows"] if r["method"] == name]
        upper.plot(
            [r["bodies"] for r in mine], [r["settled"]["median"] * 1e3 for r in mine], **look
        )
        last = row(section, name, largest)
        if last and last["finite"] and name != piles.PLAIN:
            lower.plot(
                [max(last["mean_depth"], 1e-6)],
                [last["settled"]["median"] * 1e3],
                **{**look, "ls": ""},
            )
    then = {n: time for n, time in piles.FIRST_EDITION.items() if n in sizes(section)}
    upper.plot(
        list(then),
        [time * 1e3 for time in then.values()],
        color=plotting.PALE,
        ls=":",
        label="lcp of the first edition",
    )
    upper.set(xscale="log", yscale="log", xlabel="balls", ylabel="time per step [ms]")
    upper.set_xticks(sizes(section), [f"{n:,}" for n in sizes(section)])
    upper.minorticks_off()
    lower.set(
        xscale="log",
        yscale="log",
        xlabel=f"mean depth of overlap / r, {largest:,} balls",
        ylabel="time per step [ms]",
    )
    lower.margins(0.12)
    plotting.legend_below(lower, of=upper)
    return {"pile.svg": plotting.svg(figure, section)}


def _look(name):
    """How a method is drawn: its family's look, hollow where it is a second setting."""
    if name == piles.PLAIN:
        return dict(plotting.look("lcp"), ls=(0, (1, 3)), marker="1", markersize=8)
    if name in LOOKS:
        return plotting.look(LOOKS[name])
    family = {"Box2D 3, 4 substeps, hardest": "box2d3"}.get(name, "mujoco")
    return dict(plotting.look(family), markerfacecolor="none", ls=(0, (1, 1)))
