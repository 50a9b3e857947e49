"""Newton's cradle by gap, and the forces in a tower: two tables and a figure."""

from curriculum import plotting, reporting
from curriculum.bench import cradle
from curriculum.bench.contestants import LABELS
from curriculum.reporting import Claim, listed, number

RIGHT = 1e-3  # of the speed: the outcome is right


def goals(section):
    """None is asked for here."""
    return []


def by_setting(section):
    """{(family, words): {gap: row}}."""
    found = {}
    for row in section["outcomes"]:
        found.setdefault((row["family"], row["words"]), {})[row["gap"]] = row
    return found


def claims(section):
    found = by_setting(section)
    right = sorted(
        {
            LABELS[family]
            for (family, _), rows in found.items()
            if all(row["error"] is not None and row["error"] < RIGHT for row in rows.values())
        }
    )
    yield Claim(
        bool(right), f"Right at every gap: {listed(right)}.", "Nobody is right at every gap."
    )
    least = min(cradle.GAPS)
    wrong = [
        f"{LABELS[family]} ({number(rows[least]['error'], 2)})"
        for (family, words), rows in found.items()
        if family in ("lcp", "soft") and rows[least]["error"] > RIGHT
    ]
    yield Claim(
        bool(wrong),
        f"At {least * 1e6:g} um, largest error of a speed: {listed(wrong)}; a step "
        "meets all the gaps at once there, and shares the speed out.",
    )


def page(section):
    """The whole page."""
    gaps = cradle.GAPS
    rows = [
        [
            f"{LABELS[family]}: {words}",
            *(number(found[gap]["error"], 2) if gap in found else "-" for gap in gaps),
        ]
        for (family, words), found in by_setting(section).items()
    ]
    speeds = [
        [
            f"{LABELS[row['family']]}: {row['words']}",
            *(f"{v:.3f}" if v is not None else "-" for v in row["speeds"]),
        ]
        for row in section["outcomes"]
        if row["gap"] == 1e-4
    ]
    forces = [
        [f"{LABELS[row['family']]}: {row['words']}", number(row["worst"], 2)]
        for row in section["forces"]
    ]
    return reporting.page(
        "Newton's cradle by gap, and the forces in a tower",
        section,
        f"Five balls in a row, e = 1, steps of {1e3 * cradle.DT:g} ms, one coming in at 1 m/s. With any "
        "gap the last one leaves at 1 m/s and all others stop.",
        "![Newton's cradle by gap](cradle.svg)",
        reporting.sentences(claims(section)),
        "Largest error of a speed after the impacts [of the incoming speed], by gap [mm]:",
        reporting.table(["", *(f"{1e3 * gap:g}" for gap in gaps)], rows),
        "The five speeds at a gap of 0.1 mm; right is 0 0 0 0 1:",
        reporting.table(["", *"12345"], speeds),
        f"## Forces in a tower of {cradle.TOWER}",
        "Under ball k stands (N - k + 1) m g. Largest error of "
        f"a force after {cradle.SETTLE:g} s at rest [m g]:",
        reporting.table(["", "error / m g"], forces),
        f"Not told by: {listed(section['untold'])}." if section["untold"] else "",
    )


def figures(section):
    """{file name: SVG text}: the error of the outcome against the gap, best setting of each."""
    figure, (axis,) = plotting.figure(
        height=3.2,
        below=0.75,
        title="Newton's cradle: how wrong are the speeds, by gap",
        explained="Left of the mark a step of 2 ms crosses more than one gap. The setting of each with "
        "the least worst error. An error of 0 is drawn at the bottom.",
    )
    best = {}
    for (family, _), rows in by_setting(section).items():
        errors = [rows[gap]["error"] for gap in cradle.GAPS if gap in rows]
        if None not in errors and (family not in best or sum(errors) < sum(best[family])):
            best[family] = errors
    for family, errors in best.items():
        plotting.line(
            axis,
            [1e3 * gap for gap in cradle.GAPS],
            [max(e, 1e-16) for e in errors],
            family,
            label=LABELS[family],
        )
    axis.axvline(1e3 * cradle.SPEED * cradle.DT, color=plotting.PALE, lw=0.9, ls=(0, (3, 2)))
    axis.set(xscale="log", yscale="log", xlabel="gap [mm]", ylabel="error of a speed")
    plotting.legend_below(axis, columns=4)
    return {"cradle.svg": plotting.svg(figure, section)}
