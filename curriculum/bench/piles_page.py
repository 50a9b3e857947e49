"""The pile of many balls, as a page: goals, checked sentences, tables."""

from curriculum.bench import methods, report
from curriculum.bench.report import Claim, Goal, listed, ms, number

COMMAND = "python -m curriculum.bench pile"
LEVEL = 1.05    # times pymunk's: what counts as level


def label(name):
    """How a row of the pile is called."""
    names = {"lcp": "lcp", "all pairs": "lcp, all pairs one by one"}
    return names.get(name) or methods.BY_NAME[name].label


def row(section, name, bodies):
    """One method at one size, or None."""
    return next((r for r in section["rows"] if (r["method"], r["bodies"]) == (name, bodies)), None)


def largest(section):
    return max(r["bodies"] for r in section["rows"])


def goals(section):
    """Growth of lcp's time per step, and where it stands beside pymunk on the largest pile."""
    return [_growth_goal(section["exponents"].get("lcp")), _level_goal(section)]


def _growth_goal(exponent):
    wanted = "lcp: exponent of the time per settled step at most 1.15 from 1,000 to 10,000 balls"
    if exponent is None:
        return Goal(wanted, "needs the full run", None)
    return Goal(wanted, f"{exponent['settled']:.2f} settled, {exponent['early']:.2f} early",
                exponent["settled"] <= 1.15)


def _level_goal(section):
    count = largest(section)
    wanted = f"lcp level with pymunk on {count:,} balls, settled, {section['sweeps']} sweeps each"
    ours, theirs = row(section, "lcp", count), row(section, "pymunk", count)
    if theirs is None:
        return Goal(wanted, section["missing"].get("pymunk", "-"), None)
    ratio = ours["settled"]["median"] / theirs["settled"]["median"]
    return Goal(wanted, f"{number(ratio)} x its time per step; mean depth {number(ours['mean_depth'])} r "
                f"against {number(theirs['mean_depth'])} r", ratio <= LEVEL)


def claims(section):
    """The sentences under the figure."""
    count = largest(section)
    ours, slow = row(section, "lcp", count), row(section, "all pairs", count)
    sound = [r for r in section["rows"]
             if r["bodies"] == count and r["method"] != "all pairs" and r["finite"]]
    fastest = min(sound, key=lambda r: r["settled"]["median"])
    flattest = min(sound, key=lambda r: r["mean_depth"])
    yield Claim(True, f"On {count:,} settled balls {label(fastest['method'])} is the fastest, "
                f"{ms(fastest['settled']['median'])} ms a step (lcp: {ms(ours['settled']['median'])} ms), "
                f"and {label(flattest['method'])} leaves the least mean depth, "
                f"{number(flattest['mean_depth'], 2)} r (lcp: {number(ours['mean_depth'], 2)} r).", "")
    if slow:
        ratio = slow["settled"]["median"] / ours["settled"]["median"]
        yield Claim(ratio > 1.0, "Looking at near pairs only and sweeping groups at once gives the same "
                    f"bits {ratio:,.0f} times faster than all pairs one by one.",
                    f"All pairs one by one take {ratio:.2f} times as long as near pairs in groups.")
    broken = [f"{label(r['method'])} ({r['bodies']:,} balls)" for r in section["rows"] if not r["finite"]]
    if broken:
        yield Claim(True, f"Not finite at the end: {listed(broken)}.", "")


def page(section):
    """The whole page."""
    rows = [[f"{r['bodies']:,}", label(r["method"]),
             *(f"{ms(r[phase]['median'])} {report.spread(r[phase])}" for phase in ("early", "settled")),
             number(r["mean_depth"], 2), number(r["worst_depth"], 2),
             r["contacts"] if r["finite"] else "not finite"] for r in section["rows"]]
    grown = [[label(name), f"{exponent['early']:.2f}", f"{exponent['settled']:.2f}"]
             for name, exponent in section["exponents"].items()]
    missing = [f"{name}: {what}" for name, what in section["missing"].items()]
    return report.page(
        "A pile of many balls", COMMAND, section,
        f"All engines step the same pile (seed 0, steps of {section['dt'] * 1e3:g} ms) in turns of one "
        "run, reading nothing. Early is the first tenth of the run, settled the last quarter. \"All pairs "
        "one by one\" takes single steps from lcp's first and last state, to the same bits.",
        f"Left out: {'; '.join(missing)}." if missing else "",
        "## Goals", report.goal_table(goals(section)), "![A pile of N balls](pile.svg)",
        report.sentences(claims(section)),
        report.table(["balls", "method", "early [ms a step]", "settled [ms a step]", "mean depth / r",
                      "worst depth / r", "contacts at the end"], rows),
        "Exponent of the time per step, from 1,000 balls on:" if grown else "",
        report.table(["method", "early", "settled"], grown) if grown else "")
