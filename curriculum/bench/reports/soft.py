"""From penalty over MuJoCo to lcp: two tables, the bill of each end, and a figure."""

import math

from curriculum import plotting, reporting
from curriculum.bench.soft import BETWEEN, LCP_END, PENALTY_END
from curriculum.reporting import Claim, number

LOOKS = {PENALTY_END: "penalty", BETWEEN: "soft", LCP_END: "lcp"}
LAST = 1e-12  # of the largest impulse: one answer, but for rounding


def goals(section):
    """None is asked for here."""
    return []


def line(section, end):
    return [row for row in section["line"] if row["end"] == end]


def claims(section):
    models = section["models"]
    first, last = line(section, PENALTY_END)[0], line(section, LCP_END)[-1]
    yield Claim(
        first["distance"] < 1e-3,
        f"With the spring of penalty and d = {first['d']:g}, soft is "
        f"within {number(first['distance'], 2)} r of penalty over the whole drop.",
    )
    yield Claim(
        last["distance"] < 1e-3,
        f"With that of lcp and d = {last['d']:g} it is within "
        f"{number(last['distance'], 2)} r of lcp (both without a push).",
    )
    yield Claim(
        True,
        f"At rest the ball is {number(-models['penalty']['rest_gap'], 3)} r deep in penalty, "
        f"{number(-models['soft']['rest_gap'], 3)} r as MuJoCo ships it, and "
        f"{number(abs(models['lcp']['rest_gap']), 2)} r off in lcp.",
    )
    soft, hard = section["orders"][0], section["orders"][-1]
    yield Claim(
        soft["impulses"] < LAST < hard["impulses"],
        f"In any order of sweeps soft gives the same impulses to {number(soft['impulses'], 1)}, "
        f"lcp's differ by {number(100 * hard['impulses'], 2)} % where contacts are redundant.",
    )


def page(section):
    """The whole page."""
    head = [
        "d",
        "rest gap / r",
        "deepest / r",
        "energy in / E0",
        "distance from its end / r",
        "critical step [ms]",
    ]
    keys = ("rest_gap", "deepest", "energy_in", "distance")

    def rows_of(end):
        return [
            [f"{row['d']:g}", *(number(row[key]) for key in keys), reporting.ms(row["critical_dt"])]
            for row in line(section, end)
        ]

    models = [
        [name, *(number(row[key]) for key in keys[:3]), reporting.ms(row["critical_dt"])]
        for name, row in section["models"].items()
    ]
    orders = [
        [row["name"], row["contacts"], number(row["impulses"], 2), number(row["speeds"], 2)]
        for row in section["orders"]
    ]
    return reporting.page(
        "From penalty over MuJoCo to lcp, on one line",
        section,
        "While a ball touches, soft is a spring k = m d^2 K and a damper c = m d B that carry the share "
        "1 - d of the load. The runs are the drop, 2000 steps of 2 ms.",
        "![The line](soft.svg)",
        reporting.sentences(claims(section)),
        "## The models themselves",
        reporting.table(["", *head[1:4], head[5]], models),
        "## With the spring of penalty (k = 1e4 N/m, c = 80 N s/m)",
        "d -> 0 is penalty. The critical step does not move: it is that of the spring.",
        reporting.table(head, rows_of(PENALTY_END)),
        "## From MuJoCo to lcp",
        "At d = 0.95 the spring of solref 0.02 1, at d = 0.9999 that of lcp, in equal ratios between.",
        reporting.table(head, rows_of(BETWEEN)),
        "## With the spring of lcp (K = 0.2 / dt^2, B = 1 / dt)",
        "d -> 1 is lcp. This spring is made for the step, so no step is too long. The distance is that of "
        "runs without a push (K = 0, beta = 0): with it lcp treats a gap under its margin as contact, "
        "which soft does not.",
        reporting.table(head, rows_of(LCP_END)),
        "## What each end costs",
        "Softness buys one answer: a strictly convex problem, so any order of the sweeps gives the same "
        "impulses to rounding. It costs that the ball rests inside, (1 - d) g = d^2 K depth, whatever "
        "its mass. lcp rests on the surface, but where contacts are redundant its impulses depend on the "
        "order. Seven balls wedged between two held ones, twenty orders, largest differences:",
        reporting.table(["", "contacts", "impulses [of the largest]", "speeds [m/s]"], orders),
        "How far soft is from the engine itself: `python -m curriculum.stress.mujoco_match`.",
    )


PANELS = (
    ("rest_gap", "rest depth / r", "log"),
    ("deepest", "deepest / r", "log"),
    ("energy_in", "energy in / E0", "log"),
    ("distance", "distance from its end / r", "log"),
)


def figures(section):
    """{file name: SVG text}: four measures over d, with the three models marked."""
    figure, axes = plotting.figure(
        rows=2,
        columns=2,
        height=2.3,
        below=0.75,
        title="One line: penalty, MuJoCo, lcp",
        explained="One ball dropped, soft with the spring of penalty or of lcp, and its impedance d moved. "
        "Ends 0.0001 and 0.9999. Marks: the models themselves. A zero is drawn at 1e-9.",
    )
    for axis, (key, label, scale) in zip(axes, PANELS):
        for end, name in LOOKS.items():
            rows = line(section, end)
            plotting.line(
                axis,
                [_place(row["d"]) for row in rows],
                [max(abs(row[key]), 1e-9) for row in rows],
                name,
                label=f"soft, {end}",
                marker="",
            )
        for name, d in (("penalty", 1e-4), ("soft", 0.95), ("lcp", 0.9999)):
            if key in section["models"][name]:
                axis.plot(
                    [_place(d)],
                    [max(abs(section["models"][name][key]), 1e-9)],
                    label={"soft": "MuJoCo as shipped"}.get(name, name),
                    **{**plotting.look(name), "ls": ""},
                )
        axis.set(yscale=scale, title=label)
        axis.set_xticks(
            [_place(d) for d in (0.001, 0.1, 0.9, 0.999)], ["0.001", "0.1", "0.9", "0.999"]
        )
    for axis in axes[2:]:
        axis.set_xlabel("impedance d")
    figure.legend(
        *axes[0].get_legend_handles_labels(),
        loc="lower left",
        ncols=2,
        fontsize=8.5,
        bbox_to_anchor=(0.02, 0.2 / figure.get_figheight()),
        borderaxespad=0,
    )
    return {"soft.svg": plotting.svg(figure, section)}


def _place(d):
    """Where d stands on an axis that stretches both ends."""
    return math.log10(d / (1.0 - d))
