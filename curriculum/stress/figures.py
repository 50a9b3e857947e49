"""The stress report's figures, from the sections of results.json alone."""

from curriculum import plotting
from curriculum.stress import maps
from curriculum.stress.under_test import contact

ORDER = maps.SETTLES + maps.RESTLESS + maps.GAINS + maps.EXPLODES
ERRORS = (0.03, 0.1, 0.3, 1.0, 3.0)  # r
DEPTHS = (0.03, 0.1, 0.3, 1.0)  # r
ON_COLORS = "#111111"  # of a line over coloured cells, which stay as they are in the dark


def draw(section):
    """{file name: SVG text} of every figure that the section `maps` gives."""
    makers = {
        "penalty": penalty_map,
        "lcp": lcp_error,
        "depth": lcp_depth,
        "converges": lcp_converges,
        "soft": soft_map,
    }
    names = {
        "penalty": "penalty-map",
        "lcp": "lcp-error",
        "depth": "lcp-depth",
        "converges": "lcp-converges",
        "soft": "soft-map",
    }
    return {f"{names[key]}.svg": make(section) for key, make in makers.items() if key in section}


def penalty_map(section):
    """What the drop does over dt and stiffness, a panel for each of two dampers, with the theory."""
    found = section["penalty"]
    dampings = [c for c in (0.0, 80.0) if f"{c:g}" in found["outcomes"]]
    figure, axes = plotting.figure(
        rows=len(dampings),
        title="penalty: what a ball dropped 1 m does",
        below=0.6,
        explained="Left of the line a ball that stays in contact is stable. The speckle is luck: "
        "where in a step the table is met.",
    )
    stiffness = found["stiffness"]
    for axis, c in zip(axes, dampings):
        rows = found["outcomes"][f"{c:g}"]
        cells = [[ORDER.index(letter) for letter in row] for row in rows]
        plotting.heat(
            axis,
            found["dt"],
            stiffness,
            cells,
            (0.5, 1.5, 2.5),
            "",
            [maps.OUTCOMES[letter] for letter in ORDER],
        )
        theory = [contact.critical_dt(1.0, k, c) for k in stiffness]
        axis.plot(theory, stiffness, color="white", lw=4)
        axis.plot(theory, stiffness, color=ON_COLORS, lw=1.8)
        axis.plot(
            found["measured"][f"{c:g}"][::5],
            stiffness[::5],
            "o",
            color=ON_COLORS,
            mfc="white",
            markersize=5,
        )
        axis.set(
            ylabel="stiffness k [N/m]",
            title=f"damping c = {c:g} N s/m; line: k dt² + 2 c dt = 4 m; circles: measured",
            xlim=(found["dt"][0], found["dt"][-1]),
        )
    only_the_last_legend(axes)
    return plotting.svg(figure, section)


def only_the_last_legend(axes):
    """One legend serves all panels; the time axis is named under the last."""
    for axis in axes[:-1]:
        axis.get_legend().remove()
    for axis in axes:
        plain_ticks(axis)
    axes[-1].set_xlabel("time step dt [ms]", loc="right")


def plain_ticks(axis):
    """Time steps in milliseconds, as numbers one reads; no labels between them."""
    from matplotlib.ticker import NullLocator

    low, high = axis.get_xlim()
    marks = [mark for mark in (0.1, 0.3, 1, 3, 10, 30, 100, 300) if low <= 1e-3 * mark <= high]
    axis.set_xticks([1e-3 * mark for mark in marks], [f"{mark:g}" for mark in marks])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.yaxis.set_minor_locator(NullLocator())


def lcp_error(section):
    """Height error of the drop under lcp over dt and beta, without and with bounces."""
    found = section["lcp"]
    given = list(found["height_error"])
    figure, axes = plotting.figure(
        rows=len(given),
        title="lcp: how wrong the height gets",
        below=0.75,
        explained=f"Worst distance from the closed form over 4 s and {maps.SEEDS} start heights. "
        "Without a bounce the bias velocity pops the ball off the table, the higher the "
        "larger beta.",
    )
    for axis, e in zip(axes, given):
        plotting.heat(
            axis,
            found["dt"],
            [beta + 0.025 for beta in found["baumgarte"]],
            found["height_error"][e],
            ERRORS,
            "height error [r]",
        )
        axis.set(
            yscale="linear",
            ylabel="Baumgarte gain beta",
            title=f"restitution e = {e}",
            ylim=(0.0, 1.05),
        )
    only_the_last_legend(axes)
    return plotting.svg(figure, section)


def lcp_depth(section):
    """How deep lcp gets over dt: one curve for all e and beta, with its theory."""
    found = section["depth"]
    figure, (axis,) = plotting.figure(
        title="lcp: how deep the ball gets",
        below=0.55,
        explained="The landing step decides it: no Baumgarte gain changes it, and no restitution makes it "
        "deeper than the line. "
        f"Worst of {maps.SEEDS} start heights.",
    )
    dt = found["dt"]
    axis.plot(
        dt,
        [maps.IMPACT_SPEED * step / maps.RADIUS for step in dt],
        color=plotting.PALE,
        label="impact speed times dt",
    )
    shown = {"e=0 beta=0.2": "e = 0, beta = 0.2", "e=0.7 beta=1": "e = 0.7, beta = 1"}
    for (name, label), marker in zip(shown.items(), ("o", "x")):
        if name in found["rows"]:
            plotting.line(axis, dt, found["rows"][name], "lcp", label, ls="", marker=marker)
    finish_over_dt(axis, "deepest penetration [r]", [0.01, 0.1, 1.0])
    return plotting.svg(figure, section)


def finish_over_dt(axis, label, marks):
    """Two logarithmic axes over dt, with plain numbers at the marks, and the legend below."""
    axis.set(xscale="log", yscale="log", ylabel=label)
    axis.set_yticks(marks, [f"{mark:g}" for mark in marks])
    axis.set_xlabel("time step dt [ms]", loc="right")
    plain_ticks(axis)
    plotting.legend_below(axis, down=0.16)


def lcp_converges(section):
    """Height error of the bounce over dt, down to 0.06 ms, with a line of first order."""
    found = section["converges"]
    figure, (axis,) = plotting.figure(
        title="lcp: the bounce converges",
        below=0.55,
        explained=f"Worst height error over 4 s, e = 0.7, median of {maps.SEEDS} start heights.",
    )
    dt, error = found["dt"], found["height_error"]
    axis.plot(
        dt, [error[-1] * step / dt[-1] for step in dt], color=plotting.PALE, label="first order"
    )
    plotting.line(axis, dt, error, "lcp", "lcp, 20 sweeps")
    marks = [mark for mark in (0.003, 0.01, 0.03, 0.1, 0.3) if error[-1] / 2 < mark]
    finish_over_dt(axis, "height error [r]", marks)
    return plotting.svg(figure, section)


def soft_map(section):
    """How deep the drop gets under soft over dt and the time constant."""
    found = section["soft"]
    figure, (axis,) = plotting.figure(
        title="soft: how deep the ball gets",
        below=0.75,
        explained="MuJoCo's contact, damping ratio 1. Below the line T = 2 dt the time constant "
        "that counts is 2 dt, and the depth is that of the step.",
    )
    plotting.heat(
        axis, found["dt"], found["timeconst"], found["depth"], DEPTHS, "deepest penetration [r]"
    )
    axis.plot(found["dt"], [2 * step for step in found["dt"]], color="white", lw=4)
    axis.plot(found["dt"], [2 * step for step in found["dt"]], color=ON_COLORS, lw=1.8)
    axis.set(
        ylabel="time constant T [s]",
        xlim=(found["dt"][0], found["dt"][-1]),
        ylim=(found["timeconst"][0], found["timeconst"][-1]),
    )
    only_the_last_legend([axis])
    return plotting.svg(figure, section)
