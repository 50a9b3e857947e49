"""The figures, as SVG text that is the same for the same results: no date, fixed ids.

Methods are told apart by marker and dash as well as colour, so they read in black and white.
"""

import io
import textwrap

import numpy as np

from curriculum.bench import methods, piles_page, skips, store

GRAY, INK = "#c8c8c8", "#222222"
PANELS = (("contact.py: exact", ("exact",)),
          ("contact.py: penalty and lcp", ("penalty", "lcp10", "lcp", "lcp100")),
          ("MuJoCo and pymunk", ("mujoco", "mujoco_stiff", "pymunk")),
          ("Box2D", ("box2d", "box2d3", "box2d3_stiff")))
LEAST = 1e-17       # r: an error of exactly zero is drawn here
# where a line's labels stand, by its place in the panel: most lines fall, so not along them
TOWARDS = ((4, 3, "left", "bottom"), (-4, -3, "right", "top"), (1, -6, "center", "top"),
           (4, 3, "left", "bottom"))


def pyplot():
    """matplotlib.pyplot, set up; ImportError that says how to install it."""
    try:
        import matplotlib
    except ImportError:
        raise ImportError("they need matplotlib: pip install -e '.[bench]'") from None
    matplotlib.use("svg")
    matplotlib.rcParams.update({
        "svg.hashsalt": "contact", "svg.fonttype": "path", "font.family": "DejaVu Sans", "font.size": 9,
        "axes.titlesize": 9.5, "axes.spines.top": False, "axes.spines.right": False,
        "axes.edgecolor": INK, "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.6,
        "legend.frameon": False, "legend.fontsize": 8, "lines.linewidth": 1.4, "lines.markersize": 5.5,
        "axes.axisbelow": True, "path.simplify": False})
    from matplotlib import pyplot as plt
    return plt


def svg(figure, plt, section):
    """The figure as SVG text, with the footer of its section under it."""
    note = "\n".join(textwrap.wrap(store.footer(section), int(figure.get_figwidth() * 15.5)))
    figure.text(0.012, 0.008, note, fontsize=6.5, color="#555555", va="bottom")
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    return "\n".join(line.rstrip() for line in out.getvalue().splitlines()) + "\n"


def error_figure(section, problem):
    """Run time against error of one problem: four panels that share the time axis."""
    plt = pyplot()
    about, told = section["problems"][problem], section["methods"]
    lines = {name: [p for p in section["points"] if (p["problem"], p["method"]) == (problem, name)]
             for name in told}
    figure, axes = plt.subplots(1, 4, figsize=(13, 5.8), sharey=True,
                                gridspec_kw=dict(width_ratios=(1.0, 2.5, 2.5, 2.5), wspace=0.08,
                                                 left=0.055, right=0.99, top=0.855, bottom=0.315))
    _heading(figure, f"{about['title']}: run time against error",
             "Left and down is better. Numbers at the points are the time step in ms, bars reach from the "
             "fastest to the slowest round, gray lines are those of the other panels.")
    edge = _limits(axes, lines)
    for axis, (heading, names) in zip(axes, PANELS):
        axis.set_title(heading)
        if axis is not axes[0]:
            for name, points in lines.items():
                if name not in names and name != "exact" and points:
                    axis.plot(*_curve(points), color=GRAY, lw=0.8, zorder=1)
        place = 0
        for name in filter(told.get, names):
            if told[name]["missing"]:
                axis.plot([], [], " ", label=f"{told[name]['label']}: not installed")
            elif not (name in ("lcp10", "lcp100") and _same(lines, name)):
                same = name == "lcp" and _same(lines, "lcp10") and _same(lines, "lcp100")
                label = "lcp, 10, 20 or 100 sweeps: one contact, same run" if same else told[name]["label"]
                _line(axis, methods.BY_NAME[name], lines[name], label, place, edge)
                place += 1
        if axis.get_legend_handles_labels()[0]:
            axis.legend(loc="upper left", bbox_to_anchor=(-0.02 if axis is not axes[0] else -0.3, -0.17),
                        handlelength=4.2, borderaxespad=0)
        axis.set_xlabel("worst height error / r" if axis is not axes[0] else "error / r")
    axes[0].set_ylabel(f"time for {about['duration']:g} s of motion [ms],\nevery height read")
    axes[0].set_xticks([1e-16, 1e-13, 1e-10])
    return svg(figure, plt, section)


def _heading(figure, title, explained):
    inch = 1.0 / figure.get_figheight()
    figure.text(0.012, 1.0 - 0.28 * inch, title, fontsize=12, fontweight="bold")
    figure.text(0.012, 1.0 - 0.5 * inch, explained, fontsize=9, color="#444444")


def _limits(axes, lines):
    """Set the axes' scales and limits, and the strip for what diverged; returns the x to draw that at."""
    points = [p for some in lines.values() for p in some]
    times = [p["times"]["read"][which] * 1e3 for p in points for which in ("min", "max")]
    sound = [_error(p) for p in points
             if p["method"] != "exact" and not p["diverged"] and _error(p) is not None]
    low, high = min(sound, default=1e-3), max(sound, default=1.0)
    low, high = low / (high / low) ** 0.09, high * (high / low) ** 0.07
    strip = (high / low) ** 0.35 if any(p["diverged"] for p in points) else 1.0
    for axis in axes:
        axis.set(xscale="log", yscale="log", ylim=(min(times) / 1.5, max(times) * 1.7))
    axes[0].set_xlim(LEAST / 3, 1e-9)
    for axis in axes[1:]:
        axis.set_xlim(low, high * strip)
        if strip > 1.0:
            axis.axvspan(high, high * strip, color="#f4f4f4", lw=0)
            axis.text(high * strip**0.06, 0.985, "diverged", transform=axis.get_xaxis_transform(),
                      fontsize=7.5, va="top", color="#666666")
    return high * strip**0.12


def _error(point):
    value = point["height_error"]["median"]
    return None if value is None else max(value, LEAST)


def _same(lines, name):
    """Whether a method's errors are those of lcp, point by point: for one ball all sweeps agree."""
    ours, lcp = ([p["height_error"]["all"] for p in lines[which]] for which in (name, "lcp"))
    return ours == lcp


def _curve(points):
    sound = [p for p in points if not p["diverged"]]
    return [_error(p) for p in sound], [p["times"]["read"]["min"] * 1e3 for p in sound]


def _line(axis, method, points, label, place, edge):
    """One method: line, markers, spread and the knob at each point; diverged points at x = edge."""
    look = dict(color=method.color, marker=method.marker, ls=method.dash,
                markerfacecolor="white" if place % 2 else method.color)
    if method.marker == "*":
        look["markersize"] = 9
    axis.plot(*_curve(points), label=label, zorder=3, **look)
    ink = method.color if method.color != "#999999" else "#666666"
    labels, strip = [], []     # [x, y, first knob, last knob]: close points share a label
    for p in points:
        time, knob = p["times"]["read"], f"{p['dt'] * 1e3:g}"
        x, y = edge if p["diverged"] else _error(p), time["min"] * 1e3
        axis.plot([x, x], [y, time["max"] * 1e3], color=method.color, lw=0.9, zorder=2)
        if p["diverged"]:
            axis.plot([x], [y], zorder=3, **{**look, "ls": ""})
            shift = 9 if strip and _close(axis, (x, y), (x, strip[-1])) else 0
            strip.append(y)
            axis.annotate(f"{knob}: step {p['diverged']['step']}", (x, y), (6, -shift), va="center",
                          textcoords="offset points", fontsize=7, color=ink, zorder=4)
        elif labels and _close(axis, (x, y), labels[-1][:2]):
            labels[-1][3] = knob
        else:
            labels.append([x, y, knob, knob])
    dx, dy, ha, va = TOWARDS[place]
    for x, y, first, last in labels:
        axis.annotate(first if first == last else f"{first} to {last}", (x, y), (dx, dy), ha=ha, va=va,
                      textcoords="offset points", fontsize=7, color=ink, zorder=4)


def _close(axis, point, other):
    """Whether two points are so close, in units of 1/72 inch, that their labels would overlap."""
    dx, dy = abs(np.subtract(*axis.transData.transform([point, other]))) * 72 / axis.figure.dpi
    return dx < 14 and dy < 8


def pile_figure(section):
    """Time per step against the number of balls, early and settled, and the depth that is left."""
    plt = pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(13, 5.2), gridspec_kw=dict(
        wspace=0.25, left=0.055, right=0.99, top=0.84, bottom=0.3))
    _heading(figure, "A pile of N balls: time per step, and the depth each engine leaves",
             f"Steps of {section['dt'] * 1e3:g} ms; lcp and pymunk with {section['sweeps']} sweeps, the "
             "others with their own number. Points are medians, bars reach from the fastest turn to "
             "the slowest.")
    names = list(dict.fromkeys(row["method"] for row in section["rows"]))
    sizes = sorted({row["bodies"] for row in section["rows"]})
    for axis, phase, heading in ((axes[0], "early", "Early: the first tenth, mostly free fall"),
                                 (axes[1], "settled", "Settled: the last quarter, the fair figure")):
        axis.sharey(axes[0]) if axis is not axes[0] else None
        for name in names:
            rows = [row for row in section["rows"] if row["method"] == name]
            look, label = _pile_look(name)
            n = [row["bodies"] for row in rows]
            axis.plot(n, [row[phase]["median"] * 1e3 for row in rows], label=label, **look)
            for count, row in zip(n, rows):
                axis.plot([count] * 2, [row[phase]["min"] * 1e3, row[phase]["max"] * 1e3],
                          color=look["color"], lw=0.9)
        axis.set(xscale="log", yscale="log", title=heading, xlabel="balls")
        axis.set_xticks(sizes, [f"{n:,}" for n in sizes])
        axis.tick_params(axis="x", which="minor", bottom=False)
    axes[0].set_ylabel("time per step [ms]")
    axes[0].legend(loc="upper left", bbox_to_anchor=(0, -0.17), ncols=4, handlelength=4.2, borderaxespad=0)
    _depth_panel(axes[2], [row for row in section["rows"]
                           if row["bodies"] == sizes[-1] and row["method"] != "all pairs"])
    axes[2].set_title(f"{sizes[-1]:,} balls, settled: time against depth")
    return svg(figure, plt, section)


def _depth_panel(axis, rows):
    """Time per step against the mean depth at the end; each point carries its engine's name."""
    broken = [_pile_look(row["method"])[1] for row in rows if not row["finite"]]
    for row in rows:
        if row["finite"]:
            look, label = _pile_look(row["method"])
            at = (max(row["mean_depth"], 1e-6), row["settled"]["median"] * 1e3)
            axis.plot(*at, **{**look, "ls": ""})
            left = row["method"].endswith("_stiff")
            axis.annotate(label, at, (-7 if left else 7, 0), textcoords="offset points", fontsize=7.5,
                          color=INK, ha="right" if left else "left", va="center")
    axis.set(xscale="log", yscale="log", xlabel="mean depth of overlap / r", ylabel="time per step [ms]")
    low, high = axis.get_xlim()
    axis.set_xlim(low / (high / low) ** 0.35, high * (high / low) ** 0.45)
    axis.margins(y=0.15)
    if broken:
        axis.text(0.98, 0.03, f"not finite: {', '.join(broken)}", ha="right", transform=axis.transAxes,
                  fontsize=7.5)


def _pile_look(name):
    """How a method of the pile is drawn, and its label."""
    method = methods.BY_NAME["lcp" if name == "all pairs" else name]
    look = dict(color=method.color, marker=method.marker, ls=method.dash)
    if name == "all pairs":
        look.update(marker="1", ls=(0, (1, 3)), markersize=8)
    return look, piles_page.label(name)


def skip_figure(section):
    """Whole processes against their limits, and what skipping saves; bars with hatches."""
    plt = pyplot()
    figure, axes = plt.subplots(1, 2, figsize=(13, 4.8), gridspec_kw=dict(
        wspace=0.28, left=0.13, right=0.98, top=0.8, bottom=0.24))
    _heading(figure, "Skipping: what a run costs, and what it saves",
             "Left: shorter is better, and the bar should end before its limit. Right: longer is better.")
    ratios, limits = section["processes"]["ratios"], skips.LIMITS
    names = [name for name in limits if name in ratios][::-1]
    for row, name in enumerate(names):
        ratio = ratios[name]["time"]
        axes[0].barh(row, ratio, height=0.5, color="#0072b2")
        axes[0].plot([limits[name]] * 2, [row - 0.34, row + 0.34], color=INK, lw=2.2)
        axes[0].text(limits[name], row + 0.37, f"limit {limits[name]:g}", ha="center", fontsize=8)
        axes[0].text(ratio / 2, row, f"{ratio:.2f}", color="white", ha="center", va="center",
                     fontweight="bold")
    axes[0].axvline(1.0, color="#666666", lw=0.9, ls=(0, (3, 2)))
    axes[0].set_yticks(range(len(names)),
                       [f"{name}\n(import {ratios[name]['base']} is 1)" for name in names])
    axes[0].set(title="Time of a whole run, as a multiple of importing its library alone",
                xlim=(0, 1.08 * max(max(limits[name], ratios[name]["time"]) for name in names)),
                ylim=(-0.5, len(names) - 0.3), xlabel="ratio of median times")
    rows = section["speed_up"][::-1]
    for row, case in enumerate(rows):
        penalty = case["model"] == "penalty"
        axes[1].barh(row, case["ratio"], height=0.62, color="white" if penalty else "#0072b2",
                     edgecolor="#d55e00" if penalty else "#0072b2", hatch="////" if penalty else None)
        axes[1].text(case["ratio"], row, f"  {case['ratio']:.1f}", va="center")
    axes[1].axvline(1.0, color="#666666", lw=0.9, ls=(0, (3, 2)))
    axes[1].set_yticks(range(len(rows)), [
        f"{case['scene']}{' of ' + str(case['bodies']) if case['bodies'] > 3 else ''}, {case['model']}"
        for case in rows])
    axes[1].set(title="Speed-up of one run by skipping, in the process",
                xlabel="median time --no-skip / --skip",
                xlim=(0, 1.12 * max(case["ratio"] for case in rows)))
    for axis in axes:
        axis.grid(axis="y", visible=False)
    return svg(figure, plt, section)
