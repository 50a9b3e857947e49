"""The stress report's figures, from the results of the maps alone."""

import numpy as np

import contact
from curriculum import plotting
from curriculum.stress import maps

COLOURS = ("#fde9c9", "#ec9c5a", "#9c4058", "#2b1741")  # light to dark, as an outcome gets worse
LINE = "#111111"  # over coloured cells, which stay as they are in the dark
DEPTHS = (0.03, 0.1, 0.3)  # r


def draw(section):
    """{file name: SVG text} of the maps."""
    makers = {"penalty-map": penalty_map, "soft-map": soft_map}
    return {f"{name}.svg": plotting.svg(make(section), section) for name, make in makers.items()}


def coloured(axis, rows, y, classes, words, theory):
    """A map of classes 0 to 3 over dt and y, its legend, and a line of theory (x, y)."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    look = dict(cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5, shading="nearest")
    axis.pcolormesh(rows[0]["dt"], y, classes, rasterized=True, **look)
    axis.grid(False)
    axis.plot(*theory, color="white", lw=4)
    axis.plot(*theory, color=LINE, lw=1.8)
    patches = [Patch(color=colour, label=text) for colour, text in zip(COLOURS, words)]
    axis.legend(handles=patches, loc="upper left", bbox_to_anchor=(-0.1, -0.17), ncols=2)
    axis.set(ylim=(y[0], y[-1]))
    over_dt(axis, rows[0]["dt"])


def over_dt(axis, dt):
    """Two logarithmic axes; time steps in milliseconds, as numbers that one reads."""
    axis.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]))
    marks = [mark for mark in (0.3, 1, 3, 10, 30, 100, 300) if dt[0] <= 1e-3 * mark <= dt[-1]]
    axis.set_xticks([1e-3 * mark for mark in marks], [f"{mark:g}" for mark in marks])
    axis.minorticks_off()
    axis.set_xlabel("time step dt [ms]", loc="right")


def penalty_map(section):
    """What the drop does over dt and stiffness, a panel for each damper, with the theory."""
    figure, axes = plotting.figure(
        rows=2,
        title="penalty: what a ball dropped 1 m does",
        below=0.6,
        explained="Left of the line a ball that stays in contact is stable; circles: measured. "
        "The speckle is luck: where in a step the ball meets the table.",
    )
    for axis, damping in zip(axes, (0.0, 80.0)):
        rows = [row for row in section["penalty"] if row["at"][0] == damping]
        stiffness, measured = [row["at"][1] for row in rows], [row["measured"] for row in rows]
        classes = [[maps.OUTCOMES.index(letter) for letter in row["outcomes"]] for row in rows]
        theory = [contact.critical_dt(1.0, k, damping) for k in stiffness], stiffness
        coloured(axis, rows, stiffness, classes, maps.WORDS, theory)
        axis.plot(measured[::4], stiffness[::4], "o", color=LINE, mfc="white", markersize=5)
        title = f"c = {damping:g} N s/m; line: k dt² + 2 c dt = 4 m"
        axis.set(ylabel="stiffness k [N/m]", title=title)
    axes[0].get_legend().remove()
    axes[0].set_xlabel("")
    return figure


def soft_map(section):
    """How deep the drop gets under soft over dt and the time constant."""
    figure, (axis,) = plotting.figure(
        title="soft: how deep the ball gets",
        below=0.7,
        explained="MuJoCo's contact, damping ratio 1. Below the line T = 2 dt the time constant "
        "that counts is 2 dt, and the depth is that of the step.",
    )
    rows = section["soft"]
    dt, classes = rows[0]["dt"], [np.searchsorted(DEPTHS, row["depth"]) for row in rows]
    words = [f"under {DEPTHS[0]:g} r", *(f"to {deep:g} r" for deep in DEPTHS[1:]), "deeper"]
    theory = dt, [2 * step for step in dt]
    coloured(axis, rows, [row["at"][0] for row in rows], classes, words, theory)
    axis.set_ylabel("time constant T [s]")
    return figure
