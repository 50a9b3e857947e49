"""The stress report's figure, from the results of the maps alone."""

from curriculum import plotting
from curriculum.stress.maps import OUTCOMES, WORDS

COLOURS = ("#fde9c9", "#ec9c5a", "#9c4058", "#2b1741")  # light to dark, as an outcome gets worse
LINE = "#111111"  # over coloured cells, which stay as they are in the dark
MARKS = (0.3, 1, 3, 10, 30, 100, 300)  # ms


def penalty_map(section):
    """What the drop does over dt and stiffness, a panel for each damper, with the theory: SVG."""
    figure, axes = plotting.figure(
        rows=2,
        title="penalty: what a ball dropped 1 m does",
        below=0.6,
        explained="Left of the line a ball that stays in contact is stable; circles: measured. "
        "The speckle is luck: where in a step the ball meets the table.",
    )
    for axis, damping in zip(axes, (0.0, 80.0)):
        rows = [row for row in section["penalty"] if row["damping"] == damping]
        draw_panel(axis, rows, f"c = {damping:g} N s/m; line: k dt² + 2 c dt = 4 m")
    axes[0].get_legend().remove()
    axes[0].set_xlabel("")
    return plotting.svg(figure, section)


def draw_panel(axis, rows, title):
    """The outcomes at one damping, the theory, and every fourth critical dt that was measured."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    dt, stiffness = rows[0]["dt"], [row["stiffness"] for row in rows]
    classes = [[OUTCOMES.index(letter) for letter in row["outcomes"]] for row in rows]
    look = dict(cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=3.5, shading="nearest")
    axis.pcolormesh(dt, stiffness, classes, rasterized=True, **look)
    axis.grid(False)
    for look in (dict(color="white", lw=4), dict(color=LINE, lw=1.8)):
        axis.plot([row["theory"] for row in rows], stiffness, **look)
    measured = [row["measured"] for row in rows[::4]]
    axis.plot(measured, stiffness[::4], "o", color=LINE, mfc="white", markersize=5)
    patches = [Patch(color=colour, label=text) for colour, text in zip(COLOURS, WORDS)]
    axis.legend(handles=patches, loc="upper left", bbox_to_anchor=(-0.1, -0.17), ncols=2)
    axis.set(xscale="log", yscale="log", xlim=(dt[0], dt[-1]), ylim=(stiffness[0], stiffness[-1]))
    axis.set(ylabel="stiffness k [N/m]", title=title)
    axis.set_xticks([1e-3 * mark for mark in MARKS], MARKS)
    axis.minorticks_off()
    axis.set_xlabel("time step dt [ms]", loc="right")
