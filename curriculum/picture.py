"""The curves of runs as a picture, for those without rerun.

Raises ImportError on import where matplotlib is missing.
"""

import io

import numpy as np

import contact
from curriculum import hints
from curriculum.curves import colors, curves

try:
    import matplotlib
    from matplotlib.figure import Figure
except ImportError:
    raise ImportError(hints.missing("matplotlib")) from None

DASHES = ("-", (0, (6, 2)), (0, (2, 1)), (0, (1, 2)))  # lines that coincide are seen beneath
STYLE = {
    "svg.hashsalt": "run",  # the same bytes for the same runs
    "svg.fonttype": "none",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "path.simplify_threshold": 0.2,
}


def write(path, runs, scene, title):
    """Draw the curves of runs {model: Run} over time, a panel each, as SVG, whole or not at all."""
    drawn = curves(runs, scene)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 1.0 + 1.7 * len(drawn)), layout="constrained")
        axes = figure.subplots(len(drawn), sharex=True)
        for panel, (name, lines) in zip(axes, drawn.items()):
            draw(panel, name, lines, runs)
        figure.legend(
            *axes[0].get_legend_handles_labels(),
            loc="outside lower right",
            ncols=len(runs),
            frameon=False,
        )  # below the panels: within one it would lie on the curves
        axes[-1].set_xlabel("time [s]")
        figure.suptitle(title, x=0.01, ha="left", fontsize=11)
        content = io.BytesIO()
        figure.savefig(content, format="svg", metadata={"Date": None, "Creator": None})
    contact.write_whole(path, content.getvalue())


def draw(panel, name, lines, runs):
    """One panel: the lines {model: values}, thick beneath thin."""
    panel.set_title(name, loc="left", fontsize=9)
    if near_zero(lines.values()):
        panel.axhline(0.0, color="#999999", linewidth=0.6)
    for place, (model, values) in enumerate(lines.items()):
        panel.plot(
            runs[model].t,
            drawable(values),
            label=model,
            color=colors(lines)[model],
            linestyle=DASHES[place % len(DASHES)],
            linewidth=2.6 - 0.5 * place,
        )


def near_zero(lines):
    """Whether zero is so near to the values that the panel should show it."""
    values = np.concatenate([drawable(line) for line in lines])
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return True
    low, high = float(values.min()), float(values.max())
    return max(low, -high) <= 0.3 * (high - low)


def drawable(values):
    """The values, with a gap where a run has overflowed what can be drawn."""
    return np.where(np.abs(values) < 1e30, values, np.nan)
