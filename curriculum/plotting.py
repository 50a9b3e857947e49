"""How every measured figure is drawn: by matplotlib, as small SVG files whose text is text.

    figure, axes = plotting.figure(rows=2, title="...", explained="...")
    plotting.line(axes[0], x, y, "lcp", label="lcp, 20 sweeps")
    svg = plotting.svg(figure, section)

One method has one colour, marker and dash in every figure (`LOOKS`); models have contact.py's
colours. A figure is 6 inches wide, so that a phone can show its words large enough, and panels
stand below one another. The SVG carries a few lines of style for dark mode, has no date and fixed
ids, and so the same results give the same bytes.
"""

import io
import math
import re
import textwrap

import contact

INK, PALE, GRID, FAINT = "#222222", "#666666", "#e2e2e2", "#c0c0c0"
RAMP = (
    "#fde9c9",
    "#f7c987",
    "#ec9c5a",
    "#cf6a4f",
    "#9c4058",
    "#612a5c",
    "#2b1741",
)  # light to dark
WIDTH = 6.0  # inches: a phone of 375 pixels then shows 10 points as 8.7 pixels
LARGEST = 100_000  # bytes that a figure may have

# colour, marker, dash: told apart without colour too. Colours are safe for colour-blind readers.
LOOKS = {
    "penalty": (contact.COLORS["penalty"], "v", (0, (1, 1))),
    "lcp": (contact.COLORS["lcp"], "o", "-"),
    "soft": (contact.COLORS.get("soft", "#cc79a7"), "d", (0, (5, 1))),
    "exact": (contact.COLORS["exact"], "*", "-"),
    "mujoco": ("#222222", "s", "-"),
    "pymunk": ("#a6611a", "D", (0, (4, 2))),
    "box2d": ("#e69f00", "P", (0, (3, 1, 1, 1))),
    "box2d3": ("#7b5ea7", "^", (0, (1, 2))),
    "drake": ("#56b4e9", "X", (0, (6, 2, 1, 2))),
}
IN_THE_DARK = {
    INK: "#e6e6e6",
    PALE: "#a8a8a8",
    GRID: "#3a3f4a",
    FAINT: "#666c78",
    "#0072b2": "#56a8e0",
    "#7b5ea7": "#b59ae0",
    "#a6611a": "#cf8f4f",
    "#d55e00": "#ef7a2a",
    "#009e73": "#2fc79a",
    "#cc79a7": "#e096bd",
}


def pyplot():
    """matplotlib.pyplot, set up for these figures; ImportError that says how to install it."""
    try:
        import matplotlib
    except ImportError:
        raise ImportError("figures need matplotlib: pip install -e '.[bench]'") from None
    matplotlib.use("svg")
    matplotlib.rcParams.update(
        {
            "svg.hashsalt": "contact",
            "svg.fonttype": "none",
            "font.size": 10,
            "font.family": "DejaVu Sans",
            "text.color": INK,
            "axes.labelcolor": INK,
            "xtick.color": INK,
            "ytick.color": INK,
            "axes.titlesize": 10.5,
            "axes.titlelocation": "left",
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.edgecolor": INK,
            "axes.grid": True,
            "grid.color": GRID,
            "grid.linewidth": 0.6,
            "axes.axisbelow": True,
            "legend.frameon": False,
            "legend.fontsize": 9,
            "lines.linewidth": 1.5,
            "lines.markersize": 5.5,
            "figure.facecolor": "none",
            "axes.facecolor": "none",
        }
    )
    from matplotlib import pyplot as plt

    return plt


def figure(
    rows=1, title="", explained="", height=3.4, columns=1, share=None, below=0.0, left=0.125
):
    """A figure with its heading, and the list of its axes, row by row.

    height: inches of a row of panels. share: widths of the columns, as ratios. below: inches kept
    free under the panels, for a legend; left: the share of the width kept free for the labels
    of the rows. Heading and note wrap by themselves.
    """
    plt = pyplot()
    said = textwrap.wrap(explained, 84)
    top, bottom = 0.42 + 0.17 * len(said) + 0.28, 0.62 + below
    tall = top + bottom + rows * height
    made, axes = plt.subplots(
        rows,
        columns,
        figsize=(WIDTH, tall),
        squeeze=False,
        gridspec_kw=dict(
            width_ratios=share or [1] * columns,
            left=left,
            right=0.98,
            top=1 - top / tall,
            bottom=bottom / tall,
            hspace=0.42,
            wspace=0.08 if share else 0.3,
        ),
    )
    made.text(0.01, 1 - 0.26 / tall, title, fontsize=12, fontweight="bold")
    for k, line_ in enumerate(said):
        made.text(0.01, 1 - (0.46 + 0.17 * k) / tall, line_, fontsize=9, color=PALE)
    made.told = title, explained
    return made, list(axes.flat)


def look(name: str) -> dict:
    """How a method is drawn, as keywords of axes.plot; "mujoco-direct" looks like "mujoco"."""
    color, marker, dash = LOOKS[name if name in LOOKS else name.split("-")[0]]
    size = {"*": 9.0, "d": 6.5}.get(marker, 5.5)
    return dict(color=color, marker=marker, ls=dash, markersize=size, markeredgewidth=0.8)


def line(axis, x, y, name, label=None, **changes):
    """One method as a line with its own look."""
    axis.plot(x, y, label=label or name, **{**look(name), **changes})


def legend_below(axis, columns=2, of=None, down=0.2):
    """The legend under a panel, where it covers nothing; `of`: the panel whose lines it names.

    down: how far below the panel it begins, in heights of the panel.
    """
    axis.legend(
        *(of or axis).get_legend_handles_labels(),
        loc="upper left",
        bbox_to_anchor=(-0.1, -down),
        ncols=columns,
        borderaxespad=0,
        columnspacing=1.0,
        fontsize=8.5,
    )


def heat(axis, x, y, cells, bounds, label, words=None):
    """A map: cells[row][column] over x and y (centres), coloured by the class that `bounds` make.

    bounds: rising borders between classes, one class more than borders. A cell of None stays blank.
    words: what the classes are called in the legend; the numbers by default.
    """
    import numpy as np

    count = len(bounds) + 1
    colours = [RAMP[round(k * (len(RAMP) - 1) / max(1, count - 1))] for k in range(count)]
    values = np.array(
        [
            [
                np.nan if cell is None else np.searchsorted(bounds, cell, side="right")
                for cell in row
            ]
            for row in cells
        ],
        dtype=float,
    )
    _tiles(axis, _edges(x), _edges(y), values, colours)
    axis.set(xscale="log", yscale="log")
    axis.grid(False)
    names = words or [
        f"under {bounds[0]:g}",
        *(f"{low:g} to {high:g}" for low, high in zip(bounds, bounds[1:])),
        f"over {bounds[-1]:g}",
    ]
    handles = [pyplot().Rectangle((0, 0), 1, 1, color=colour) for colour in colours]
    axis.legend(
        handles,
        names,
        title=label,
        loc="upper left",
        bbox_to_anchor=(-0.1, -0.16),
        ncols=2 if words else 3,
        borderaxespad=0,
        alignment="left",
    )


def _tiles(axis, x, y, values, colours):
    """Draw cells as one path a colour, neighbours in a row as one tile, so that files stay small."""
    import numpy as np
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    corners = {number: [] for number in range(len(colours))}
    for row, (low, high) in zip(values, zip(y, y[1:])):
        changes = [0, *(np.flatnonzero(row[1:] != row[:-1]) + 1), len(row)]
        for first, last in zip(changes, changes[1:]):
            if np.isfinite(row[first]):
                left, right = x[first], x[last]
                corners[int(row[first])] += [
                    (left, low),
                    (right, low),
                    (right, high),
                    (left, high),
                    (left, low),
                ]
    codes = [Path.MOVETO, *[Path.LINETO] * 3, Path.CLOSEPOLY]
    for number, points in corners.items():
        if points:
            path = Path(points, codes * (len(points) // 5))
            axis.add_patch(
                PathPatch(
                    path,
                    facecolor=colours[number],
                    edgecolor=colours[number],
                    linewidth=0.3,
                    zorder=0.5,
                )
            )
    axis.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))


def _edges(values):
    """Borders of cells around `values`, halfway between neighbours on a logarithmic axis."""
    import numpy as np

    logs = np.log(np.asarray(values, dtype=float))
    middle = (logs[1:] + logs[:-1]) / 2
    return np.exp(np.concatenate([[2 * logs[0] - middle[0]], middle, [2 * logs[-1] - middle[-1]]]))


def svg(figure, section=None) -> str:
    """The figure as SVG text, with the date and machine of its section under it, and closed.

    Raises ValueError when it is larger than LARGEST.
    """
    if section is not None:
        about = section["measured"]
        note = (
            f"{about['date']}, {about['cores']} cores of {about['processor']}, {about['command']}"
        )
        figure.text(0.01, 0.06 / figure.get_figheight(), note, fontsize=7, color=PALE, va="bottom")
    for axis in figure.axes:
        _whole_decades(axis.xaxis)
        _whole_decades(axis.yaxis)
    out, (title, explained) = io.StringIO(), figure.told
    figure.savefig(
        out,
        format="svg",
        metadata={"Date": None, "Creator": None, "Title": title, "Description": explained},
    )
    pyplot().close(figure)
    made = _small(out.getvalue())
    if len(made.encode()) > LARGEST:
        raise ValueError(f"{title}: {len(made.encode()):,} bytes; a figure may have {LARGEST:,}")
    return made


def _whole_decades(axis):
    """Words at powers of ten only on a logarithmic axis, and room for at least two of them."""
    from matplotlib.ticker import NullFormatter

    if axis.get_scale() != "log":
        return
    axis.set_minor_formatter(NullFormatter())
    low, high = (math.log10(value) for value in axis.get_view_interval())
    if math.floor(high) - math.ceil(low) < 1:
        axis.set_view_interval(10 ** math.floor(low), 10 ** math.ceil(high), ignore=True)


def _small(text):
    """Two decimals are enough for a pixel; a <title>, and a style for dark mode, at the front."""

    def shorter(match):
        return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")

    text = re.sub(r"<[^>]*>", lambda tag: re.sub(r"-?\d+\.\d{3,}", shorter, tag[0]), text)
    rules = "".join(
        f'[style*="{part}: {day}"]{{{part}:{night}!important}}'
        for day, night in IN_THE_DARK.items()
        for part in ("fill", "stroke")
    )
    style = (
        f"<style>@media (prefers-color-scheme: dark) {{svg{{background:#14161b}}{rules}}}</style>"
    )
    text = re.sub(r"(<svg\b[^>]*>)", lambda match: match[1] + "\n" + style, text, count=1)
    return "\n".join(line_.rstrip() for line_ in text.splitlines()) + "\n"
