"""The curves of runs as a picture, for those without rerun."""

import numpy as np

import contact
from curriculum.files import write_whole
from curriculum.run import plotting
from curriculum.run.curves import curves

DASHES = ("-", (0, (6, 2)), (0, (2, 1)), (0, (1, 2)))  # lines that coincide are seen beneath


def write(path: str, runs: dict[str, contact.Run], scene: contact.Scene, title: str) -> None:
    """Draw the curves of runs {model: Run} over time, a panel each, as SVG, whole or not at all.

    Raises ImportError where matplotlib is missing.
    """
    drawn = curves(runs, scene)
    figure, axes = plotting.figure(len(drawn), title, height=1.5, below=0.3)
    for axis, (name, lines) in zip(axes, drawn.items()):
        axis.set_title(name)
        axis.tick_params(labelbottom=axis is axes[-1])
        for place, (model, values) in enumerate(lines.items()):
            seen = np.where(np.abs(values) < 1e30, values, np.nan)  # more cannot be drawn
            width = 2.6 - 0.5 * place  # thick beneath thin
            dash = DASHES[place % len(DASHES)]
            t = runs[model].t
            plotting.line(axis, t, seen, model, marker="", ls=dash, linewidth=width)
    axes[-1].set_xlabel("time [s]")
    plotting.legend_below(axes[-1], columns=len(runs), down=0.4)
    write_whole(path, plotting.svg(figure))
