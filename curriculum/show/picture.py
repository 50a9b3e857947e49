"""Draw every measured figure and the curves of a run: as small SVG files, text as text.

    figure, axes = picture.figure(rows=2, title="...", explained="...")
    picture.line(axes[0], x, y, "lcp", label="lcp, 20 sweeps")
    svg = picture.svg(figure, origin)

One method has one colour, marker and dash in every figure; models have the course's colours. A
figure is 6 inches wide, so that a phone can show its words large enough, and panels stand below one
another. The SVG has no date and fixed ids: the same results give the same bytes.
"""

import io
import os
import re
import textwrap
from pathlib import Path

import numpy as np

import contact
from curriculum import commands

INK, PALE, GRID = "#222222", "#666666", "#e2e2e2"  # INK and GRID as in figures.mplstyle
WIDTH = 6.0  # inches: a phone of 375 pixels then shows 10 points as 8.7 pixels

# colour, marker, dash: to be told apart without colour too; the models' colours are Okabe and Ito's
LOOKS = {
    **{model: row.style for model, row in contact.MODELS.items()},
    "mujoco": ("#222222", "s", "-"),
    "pymunk": ("#a6611a", "D", (0, (4, 2))),
    "box2d3": ("#7b5ea7", "^", (0, (1, 2))),
    "drake": ("#56b4e9", "X", (0, (6, 2, 1, 2))),
    "rapier": ("#b2182b", "<", (0, (3, 1, 1, 1))),
    "dart": ("#1b7837", ">", (0, (2, 1))),
    "events": ("#333399", "p", (0, (8, 2))),
}
COLORS = {model: LOOKS[model][0] for model in contact.MODELS}
IN_THE_DARK = {
    INK: "#e6e6e6", PALE: "#a8a8a8", GRID: "#3a3f4a", "#0072b2": "#56a8e0",
    "#7b5ea7": "#b59ae0", "#a6611a": "#cf8f4f", "#b2182b": "#e8737f",
    "#1b7837": "#5cc47c", "#333399": "#9a9af0", "#d55e00": "#ef7a2a", "#009e73": "#2fc79a",
    "#cc79a7": "#e096bd", "#e69f00": "#f5b83d",
}  # fmt: skip


def figure(rows=1, title="", explained="", height=3.4, below=0.0) -> tuple:
    """Return a figure with its heading, and the list of its axes, one below the other.

    height: inches of a panel. below: inches kept free under them, for a legend. No backend is
    chosen, so a notebook keeps its own. Raises contact.MissingPackage.
    """
    os.environ["MPLBACKEND"] = "svg"  # whatever stood there; it may be none of matplotlib's
    try:
        from matplotlib import style
        from matplotlib.figure import Figure
    except ImportError:
        raise contact.MissingPackage(commands.to_install("matplotlib")) from None
    style.use(Path(__file__).with_name("figures.mplstyle"))
    lines = textwrap.wrap(explained, 84)
    top, bottom = 0.7 + 0.17 * len(lines), 0.62 + below
    tall = top + bottom + rows * height
    made = Figure(figsize=(WIDTH, tall))
    axes = made.subplots(rows, squeeze=False)
    made.subplots_adjust(top=1 - top / tall, bottom=bottom / tall)
    made.text(0.01, 1 - 0.26 / tall, title, fontsize=12, fontweight="bold")
    for k, words in enumerate(lines):
        made.text(0.01, 1 - (0.46 + 0.17 * k) / tall, words, fontsize=9, color=PALE)
    made.words = title, explained  # type: ignore[attr-defined]
    return made, list(axes.flat)


def line(axis, x, y, name: str, label: str | None = None, **changes) -> None:
    """Draw one method as a line with its own look."""
    color, marker, dash = LOOKS[name]
    size = {"*": 9.0, "d": 6.5}.get(marker, 5.5)
    look = dict(color=color, marker=marker, ls=dash, markersize=size)
    axis.plot(x, y, label=label or name, **look | changes)


def legend_below(axis, columns: int, down: float) -> None:
    """Put the legend under a panel, `down` of its heights below it, where it covers nothing."""
    axis.legend(loc="upper left", ncols=columns, bbox_to_anchor=(-0.1, -down))


def svg(figure, made=None) -> str:
    """Return a figure as SVG text, with the date and machine of stored.origin under it."""
    if made:
        note = f"{made['date']}, {made['cores']} cores of {made['cpu']}, {made['command']}"
        figure.text(0.01, 0.06 / figure.get_figheight(), note, fontsize=7, color=PALE, va="bottom")
    out, (title, explained) = io.StringIO(), figure.words
    about = {"Date": None, "Creator": None, "Title": title, "Description": explained}
    figure.savefig(out, format="svg", metadata=about)
    return smaller(out.getvalue())


def smaller(text: str) -> str:
    """Cut an SVG's numbers to two decimals, enough for a pixel, and add a style for dark mode."""

    def shorter(match):
        return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")

    text = re.sub(r"<[^>]*>", lambda tag: re.sub(r"-?\d+\.\d{3,}", shorter, tag[0]), text)
    rules = "".join(
        f'[style*="{part}: {day}"]{{{part}:{night}!important}}'
        for day, night in IN_THE_DARK.items()
        for part in ("fill", "stroke")
    )
    dark = f"@media (prefers-color-scheme: dark) {{svg{{background:#14161b}}{rules}}}"
    text = re.sub(r"(<svg\b[^>]*>)", rf"\1\n<style>{dark}</style>", text, count=1)
    return re.sub(r">\s+<", "><", " ".join(text.split())) + "\n"


@np.errstate(all="ignore")
def contact_impulses(run: contact.Run, scene: contact.Scene) -> np.ndarray:
    """Return the impulse [N s] that all contacts of a ball give it in each step, (S, 2, N).

    It is the change of momentum that gravity does not explain, so it is there for every model.
    """
    gained = np.diff(run.t[:2]).sum() * np.array([[0.0], [contact.GRAVITY]])
    mass = np.where(np.isfinite(scene.mass), scene.mass, 0.0)
    return np.concatenate((np.zeros_like(run.v[:1]), mass * (np.diff(run.v, axis=0) - gained)))


def weight(scene: contact.Scene) -> float:
    """Return the weight [N] of all balls that can move."""
    return -contact.GRAVITY * float(scene.mass[np.isfinite(scene.mass)].sum())


@np.errstate(all="ignore")
def curves(runs: dict[str, contact.Run], scene: contact.Scene) -> dict:
    """Return the curves of runs {model: Run}, {title: {model: values (S,)}}."""
    drawn: dict = {}
    free = np.isfinite(scene.mass)
    for model, run in runs.items():
        gap = contact.smallest_gap(run.q, scene.radius)
        total = contact.energy(run.q, run.v, scene.mass)
        force = contact_impulses(run, scene)[:, 1].sum(-1) / np.diff(run.t[:2]).sum()
        lines = {
            "height [m], mean": run.q[:, 1, free].mean(-1),
            "gap [r], below 0 it is an overlap": gap / scene.radius.min(),
            f"force of contacts, upwards [N], weight {weight(scene):.3g} N": force,
            "energy above start [J]": total - total[0],
            "rises of energy [J]": np.maximum(np.diff(total, prepend=total[0]), 0.0).cumsum(),
        }
        for title, line in lines.items():
            drawn.setdefault(title, {})[model] = line
    return drawn


@np.errstate(all="ignore")
def worth_seeing(runs: dict, scene: contact.Scene) -> tuple[float, float]:
    """Return two times [s]: when every model has pushed, and when the last ball rests.

    A ball rests once it goes slower than 1 cm/s for good, judged by its way, since speeds at the
    end of leapfrog's steps may be larger; a tenth more is shown, at most to the end.
    """
    pushes, rests = [], [0.0]
    for run in runs.values():
        push = np.abs(contact_impulses(run, scene)).max((1, 2))
        pushes += run.t[np.flatnonzero(push > 1e-6 * weight(scene) * run.t[1:2])[:1]].tolist()
        slow = np.abs(np.diff(run.q, axis=0)) < 0.01 * np.diff(run.t)[:, None, None]
        moving = np.flatnonzero(~slow.all((1, 2)))
        rests += [run.t[min(len(run.t) - 1, k + k // 10 + 1)] for k in moving[-1:]]
    return float(max(pushes, default=0.0)), float(max(rests))


def write(path: str, runs: dict, scene: contact.Scene, quality: dict, title: str) -> None:
    """Draw the curves of runs {model: Run} from the landing to rest, a panel each, as SVG.

    Takes what recording.write takes. Raises contact.MissingPackage where matplotlib is missing.
    """
    drawn, (first, last) = curves(runs, scene), worth_seeing(runs, scene)
    first -= 0.03 * max(last - first, 0.0)
    picture, axes = figure(len(drawn), title, height=1.5, below=0.3)
    for axis, (name, lines) in zip(axes, drawn.items()):
        axis.set_title(name)
        axis.tick_params(labelbottom=axis is axes[-1])
        for place, (model, values) in enumerate(lines.items()):
            t = runs[model].t
            seen = (t >= first) & (t <= max(first, last)) & (np.abs(values) < 1e30)  # or not drawn
            width = 2.6 - 0.45 * place  # thick beneath thin: lines that coincide are all seen
            line(axis, t[seen], values[seen], model, marker="", linewidth=width)
        if name.startswith("force"):
            axis.set_ylim(0.0, 5.0 * weight(scene))
    axes[-1].set_xlabel("time [s]")
    legend_below(axes[-1], columns=len(runs), down=0.4)
    commands.write_atomic(path, svg(picture))
