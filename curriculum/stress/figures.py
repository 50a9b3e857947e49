"""Heat maps as SVG text: no library, no date, the same bytes for the same results.

Colours are told apart by lightness alone, so they read in black and white and by every eye.
"""

import math
from typing import NamedTuple
from xml.sax.saxutils import escape

FONT = "DejaVu Sans, Verdana, sans-serif"
INK, PALE = "#222222", "#666666"
RAMP = (
    "#fde9c9",
    "#f7c987",
    "#ec9c5a",
    "#cf6a4f",
    "#9c4058",
    "#612a5c",
    "#2b1741",
)  # light to dark
MISSING = "#ffffff"
CLASSES = ("#e3eef5", "#93bfdc", "#cf7f1b", "#3c1533")  # calm to exploded
WIDTH, HEIGHT, LEFT, TOP, GAP = 300, 260, 74, 98, 26
LEGEND = 96


class Axis(NamedTuple):
    """One axis of every panel: label with unit, the values of the cells' centres, log or not.

    names: words for the values, one a cell, where the values only number the cells.
    """

    label: str
    values: list
    log: bool = True
    names: tuple = ()


class Line(NamedTuple):
    """A curve over a panel: points (x, y) in the axes' units, and how it is drawn."""

    points: list
    style: str


class Panel(NamedTuple):
    """cells[row][column] are indices into the legend's colours (None: blank); row 0 is lowest."""

    title: str
    cells: list
    lines: list = []


STYLES = {
    "theory": f'stroke="{INK}" stroke-width="1.8" stroke-dasharray="6 4" fill="none"',
    "other": f'stroke="{INK}" stroke-width="1.4" stroke-dasharray="1.5 3" fill="none"',
}


def edges(axis):
    """Borders of the cells, one more than there are values, halfway between neighbours."""
    values = [math.log(v) for v in axis.values] if axis.log else list(axis.values)
    middle = [(a + b) / 2 for a, b in zip(values, values[1:])]
    first = values[0] - (middle[0] - values[0] if middle else 0.5)
    last = values[-1] + (values[-1] - middle[-1] if middle else 0.5)
    return [first, *middle, last]


def scale(axis, start, stop):
    """A function from a value on the axis to pixels."""
    low, *_, high = edges(axis)

    def to_pixels(value):
        at = math.log(value) if axis.log else value
        return start + (stop - start) * (at - low) / (high - low)

    return to_pixels


def ticks(axis):
    """(value, label) of the ticks: powers of ten, or at most six round numbers."""
    low, *_, high = edges(axis)
    if axis.names:
        return list(zip(axis.values, axis.names))
    if not axis.log:
        step = next(s for s in (0.1, 0.2, 0.25, 0.5, 1.0, 2.0, 5.0) if (high - low) / s <= 6)
        first = math.ceil(low / step - 1e-9)
        return [(k * step, f"{k * step:g}") for k in range(first, int(high / step + 1e-9) + 1)]
    powers = range(math.ceil(low / math.log(10) - 1e-9), math.floor(high / math.log(10) + 1e-9) + 1)
    return [(10.0**p, power_label(p)) for p in powers]


def power_label(p):
    """10^p as a reader likes it: 0.001 to 1000 in full, else with a raised exponent."""
    raised = "".join(
        "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[int(digit)]
        for digit in str(abs(p))
    )
    return f"{10.0**p:g}" if -3 <= p <= 3 else f"10{chr(0x207B) * (p < 0)}{raised}"


def text(x, y, words, size=11, anchor="start", colour=INK, extra=""):
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}"{extra}>'
        f"{escape(words)}</text>"
    )


def heat_map(title, subtitle, panels, x, y, legend, colours, line_names=None, note="", columns=2):
    """The SVG text of some panels that share axes. legend: words for each colour, in order.

    line_names: {style: words} for the legend, of the styles that any panel's lines use.
    """
    columns = min(columns, len(panels))
    rows = -(-len(panels) // columns)
    width = LEFT + columns * (WIDTH + GAP) + 6
    height = TOP + rows * (HEIGHT + 78) + LEGEND
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f'font-family="{FONT}" role="img" aria-label="{escape(title)}">',
        f"<title>{escape(title)}</title>",
        f"<desc>{escape(subtitle)}</desc>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        text(16, 28, title, 17, extra=' font-weight="bold"'),
    ]
    out += [
        text(16, 50 + 16 * k, line, 12, colour=PALE)
        for k, line in enumerate(wrap(subtitle, width / 6.6))
    ]
    for number, panel in enumerate(panels):
        left = LEFT + (number % columns) * (WIDTH + GAP)
        top = TOP + (number // columns) * (HEIGHT + 78)
        out += draw_panel(panel, x, y, left, top, colours, first=number % columns == 0)
    out += draw_legend(legend, colours, line_names or {}, height - LEGEND + 2, width)
    notes = wrap(note, width / 5.6)
    out += [
        text(16, height - 8 - 13 * (len(notes) - 1 - k), line, 9.5, colour=PALE)
        for k, line in enumerate(notes)
    ]
    return "\n".join([*out, "</svg>"]) + "\n"


def draw_panel(panel, x, y, left, top, colours, first):
    """One panel: cells (equal neighbours in a row drawn as one), frame, ticks, lines, title."""
    right, bottom = left + WIDTH, top + HEIGHT
    to_x, to_y = scale(x, left, right), scale(y, bottom, top)
    ex = [left + (right - left) * share for share in shares(x)]
    ey = [bottom + (top - bottom) * share for share in shares(y)]
    out = [text((left + right) / 2, top - 8, panel.title, 12, "middle")]
    out.append('<g shape-rendering="crispEdges">')
    for row, cells in enumerate(panel.cells):
        start = 0
        for column in range(1, len(cells) + 1):
            if column == len(cells) or cells[column] != cells[start]:
                fill = MISSING if cells[start] is None else colours[cells[start]]
                out.append(
                    f'<rect x="{ex[start]:.2f}" y="{ey[row + 1]:.2f}" width="{ex[column] - ex[start]:.2f}" '
                    f'height="{ey[row] - ey[row + 1]:.2f}" fill="{fill}"/>'
                )
                start = column
    out.append("</g>")
    clip = f"clip-{left:.0f}-{top:.0f}"
    out.append(
        f'<clipPath id="{clip}"><rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}"/></clipPath>'
    )
    for line in panel.lines:
        points = [(to_x(a), to_y(b)) for a, b in line.points]
        if line.style == "measured":
            out += [
                f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2.6" fill="#ffffff" stroke="{INK}" stroke-width="1"/>'
                for a, b in points
                if left <= a <= right and top <= b <= bottom
            ]
        else:
            path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
            halo = f'<polyline points="{path}" stroke="#ffffff" stroke-width="3.6" stroke-opacity="0.75" fill="none" clip-path="url(#{clip})"/>'
            out += [
                halo,
                f'<polyline points="{path}" {STYLES[line.style]} clip-path="url(#{clip})"/>',
            ]
    out.append(
        f'<rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="{INK}"/>'
    )
    for value, label in ticks(x):
        at = to_x(value)
        out += [
            f'<path d="M{at:.1f} {bottom}v5" stroke="{INK}"/>',
            text(at, bottom + 19, label, 11, "middle"),
        ]
    out.append(text((left + right) / 2, bottom + 38, x.label, 12, "middle"))
    for value, label in ticks(y):
        at = to_y(value)
        out.append(f'<path d="M{left} {at:.1f}h-5" stroke="{INK}"/>')
        if first:
            out.append(text(left - 8, at + 4, label, 11, "end"))
    if first:
        middle = (top + bottom) / 2
        out.append(
            text(
                22, middle, y.label, 12, "middle", extra=f' transform="rotate(-90 22 {middle:.1f})"'
            )
        )
    return out


def shares(axis):
    """The cells' borders as shares of the axis, 0 to 1."""
    low, *_, high = at = edges(axis)
    return [(value - low) / (high - low) for value in at]


def draw_legend(legend, colours, line_names, top, width):
    """Swatches, then the lines; each kind starts a row, and goes on in the next where one is full."""
    swatches = [
        (
            f'<rect x="0" y="0" width="18" height="14" fill="{colour}" stroke="{INK}" stroke-width="0.6"/>',
            24,
            words,
        )
        for words, colour in zip(legend, colours)
    ]
    strokes = [
        (
            f'<circle cx="16" cy="7" r="2.6" fill="#ffffff" stroke="{INK}"/>'
            if style == "measured"
            else f'<path d="M0 7h32" {STYLES[style]}/>',
            40,
            words,
        )
        for style, words in line_names.items()
    ]
    out = []
    for items in filter(None, (swatches, strokes)):
        at = 20.0
        for mark, indent, words in items:
            room = indent + 22 + 6.9 * len(words)
            if at > 20.0 and at + room > width:
                at, top = 20.0, top + 22
            out.append(
                f'<g transform="translate({at:.1f} {top})">{mark}{text(indent, 11, words, 11.5)}</g>'
            )
            at += room
        top += 24
    return out


def wrap(words, width):
    """Lines of at most `width` characters."""
    lines = [""]
    for word in words.split():
        if len(lines[-1]) + len(word) + 1 > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def levels(value, bounds):
    """Which of the classes cut at `bounds` a value is in; the last one for NaN or words."""
    if not isinstance(value, (int, float)) or math.isnan(value):
        return len(bounds)
    return sum(value >= bound for bound in bounds)
