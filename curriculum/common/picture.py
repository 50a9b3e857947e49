"""A run as a picture, for those without rerun. Imports matplotlib when asked."""

from curriculum.common.files import whole

DASHES = ("-", (0, (6, 2)), (0, (2, 1)), (0, (1, 2)))  # lines that coincide are seen beneath


def write(path, title, runs, curves, colors):
    """Draw the curves {title: {label: values}} over the time of the runs, a panel each, as SVG.

    Written whole; the same bytes for the same runs. Raises ImportError without matplotlib.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(
        {
            "svg.hashsalt": "run",
            "svg.fonttype": "none",
            "font.size": 9,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "path.simplify_threshold": 0.2,
        }
    ):
        figure = Figure(figsize=(7.0, 1.0 + 1.7 * len(curves)), layout="constrained")
        axes = figure.subplots(len(curves), sharex=True, squeeze=False)[:, 0]
        for axis, (name, lines) in zip(axes, curves.items()):
            axis.set_title(name, loc="left", fontsize=9)
            if from_zero(lines.values()):
                axis.axhline(0.0, color="#999999", linewidth=0.6)
            for place, (label, values) in enumerate(lines.items()):
                axis.plot(
                    runs[label].t,
                    finite(values),
                    label=label,
                    color=colors[label],
                    linestyle=DASHES[place % len(DASHES)],
                    linewidth=2.6 - 0.5 * place,
                )
        figure.legend(
            *axes[0].get_legend_handles_labels(),
            loc="outside lower right",
            ncols=len(runs),
            frameon=False,
        )  # below the panels: within one it would lie on the curves
        axes[-1].set_xlabel("time [s]")
        figure.suptitle(title, x=0.01, ha="left", fontsize=11)
        with whole(path) as temporary:
            figure.savefig(temporary, format="svg", metadata={"Date": None, "Creator": None})


def from_zero(lines):
    """Whether zero is so near to the values that the panel should show it."""
    import numpy as np

    values = np.concatenate([finite(line) for line in lines])
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return True
    low, high = float(values.min()), float(values.max())
    return max(low, -high) <= 0.3 * (high - low)


def finite(values):
    """The values with a gap where a run has overflowed what can be drawn."""
    import numpy as np

    return np.where(np.abs(values) < 1e30, values, np.nan)
