"""What the page shows with JavaScript off: the poster of the run and the small figures, as SVG.

All of it is drawn from runs of contact.py made now. The look is that of draw.js and figure.js: colour,
dash and marker of a model come from the same CSS classes, and the lane has the same measures.
"""

import math

import numpy as np

import contact
from curriculum import terminal

# A lane of the live figure, in SVG units; the page hands these to figure.js, too.
LANE = {"width": 200, "height": 452, "floor": 297, "scale": 250, "lens_x": 100, "lens_y": 374, "lens_r": 68}
ZOOM = 50
WIDE = 312  # px of a small figure: never scaled, so that its text stays at 14 px
R = contact.RADIUS
WEIGHT = -contact.GRAVITY
FLAGS = terminal.parse_flags([])  # what contact.py runs with when nothing is said


def show(value):
    """A number as text: two digits after the first point, no trailing zeros."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def number(value):
    """Three digits, as draw.js writes them."""
    if abs(value) < 5e-13:  # contact.py prints twelve decimals; less is rounding
        return "0"
    if abs(value) < 1e-3 or abs(value) >= 1e6:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{mantissa}e{int(exponent)}".replace("-", "−")
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}".replace("-", "−")


def marker(model, x, y, r):
    """The marker of a model as an SVG path, as in the benchmark's figures: triangle, disc, star."""

    def corner(turn, size):
        angle = 2.0 * math.pi * turn
        return f"{show(x + size * math.sin(angle))} {show(y - size * math.cos(angle))}"

    if model == "lcp":
        return f"M{show(x - r)} {show(y)}a{r} {r} 0 1 0 {2 * r} 0a{r} {r} 0 1 0 {-2 * r} 0Z"
    if model == "penalty":
        corners = [corner(turn, 1.35 * r) for turn in (1 / 6, 1 / 2, 5 / 6)]
    else:
        corners = [corner(k / 10, 0.62 * r if k % 2 else 1.5 * r) for k in range(10)]
    return f"M{'L'.join(corners)}Z"


# ---- the poster


def lane_defs(model):
    """Hatching and clips of one lane; they stay when JavaScript draws the rest anew."""
    w, h, floor = LANE["width"], LANE["height"], LANE["floor"]
    return (
        f'<defs><pattern id="hatch-{model}" width="9" height="9" patternUnits="userSpaceOnUse" '
        f'patternTransform="rotate(45)"><rect width="9" height="9" class="hatch-ground"/>'
        f'<path d="M0 0V9" class="hatch-line"/></pattern>'
        f'<clipPath id="air-{model}"><rect width="{w}" height="{h}"/></clipPath>'
        f'<clipPath id="glass-{model}"><circle cx="{LANE["lens_x"]}" cy="{LANE["lens_y"]}" r="{LANE["lens_r"]}"/>'
        f'</clipPath></defs><rect class="air" width="{w}" height="{floor}" fill="none"/>'
    )


def lane_picture(model, run):
    """One lane at the end of a run: the fall as outlines, the deepest moment dashed, the ball at rest.

    The table is drawn first and the ball over it, so that a ball inside the table is seen inside it.
    """
    w, h, floor, scale = LANE["width"], LANE["height"], LANE["floor"], LANE["scale"]
    x, y, r = LANE["lens_x"], LANE["lens_y"], LANE["lens_r"]
    heights = run.q[:, 1, 0]
    depth = contact.max_penetration(run.q, np.array([R]))

    def circle(height, kind):
        return f'<circle cx="{w // 2}" cy="{show(floor - scale * height)}" r="{show(scale * R)}" class="{kind}"/>'

    parts = [
        f'<rect x="0" y="{floor}" width="{w}" height="{h - floor}" fill="url(#hatch-{model})" class="table"/>',
        f'<line x1="0" x2="{w}" y1="{floor}" y2="{floor}" class="table-top"/>',
    ]
    landing = int(np.argmax(heights <= R))
    every = max(1, round(0.05 / (run.t[1] - run.t[0])))
    parts += [circle(heights[k], "strobe") for k in range(0, landing, every)]
    last = float(heights[-1])
    if depth.max() > 0.02 * R:
        parts.append(circle(heights[int(depth.argmax())], f"ghost m-{model}"))
    parts.append(circle(last, f"ball m-{model}"))
    parts.append(f'<path d="{marker(model, w / 2, floor - scale * last, 8)}" class="ball-mark"/>')
    parts.append(
        f'<path d="M{w / 2 - 3:g} {floor}L{show(x - 0.94 * r)} {show(y - 0.34 * r)}'
        f'M{w / 2 + 3:g} {floor}L{show(x + 0.94 * r)} {show(y - 0.34 * r)}" class="lens-ray"/>'
    )
    zoom = scale * ZOOM
    parts.append(
        f'<circle cx="{x}" cy="{y}" r="{r}" class="lens-glass"/><g clip-path="url(#glass-{model})">'
        f'<rect x="{x - r}" y="{y}" width="{2 * r}" height="{r}" fill="url(#hatch-{model})" class="table"/>'
        f'<line x1="{x - r}" x2="{x + r}" y1="{y}" y2="{y}" class="table-top"/>'
        f'<circle cx="{x}" cy="{show(y - last * zoom)}" r="{show(R * zoom)}" class="ball m-{model}"/>'
    )
    if model == "penalty":
        sink = y + zoom * WEIGHT / FLAGS.stiffness
        parts.append(
            f'<line x1="{x - r}" x2="{x + r}" y1="{show(sink)}" y2="{show(sink)}" class="sink-line"/>'
        )
    parts.append(f'</g><circle cx="{x}" cy="{y}" r="{r}" class="lens-rim"/>')
    return "".join(parts)


def poster(runs, qualities):
    """What the template needs for the poster: lanes with their words, a caption, the measured table."""
    lanes = []
    for model, run in runs.items():
        q = qualities[model]
        deepest, rest = q["max_penetration_frac"], q["rest_penetration_frac"]
        words = f"rests {number(rest)} r deep" if rest > 1e-9 else "rests on the table"
        lanes.append(
            {
                "model": model,
                "now": words,
                "verdict": f"deepest {number(deepest)} r",
                "label": f"{model}: a ball falls on the table, gets {number(deepest)} radii into it and {words}",
                "svg": f'{lane_defs(model)}<g class="moving">{lane_picture(model, run)}</g>',
            }
        )
    rows = (
        ("deepest / r", "max_penetration_frac"),
        ("at the end / r", "rest_penetration_frac"),
        ("energy above start", "energy_excess"),
        ("energy put in by contact", "contact_energy"),
        ("height error / r", "height_error_frac"),
        ("jitter / r", "rest_jitter"),
    )
    results = [(name, [number(q[key]) for q in qualities.values()]) for name, key in rows]
    results.append(("verdict", ["EXPLODED" if q["blew_up"] else "ok" for q in qualities.values()]))
    stiffness = FLAGS.stiffness
    caption = (
        f"The same fall three times, computed by contact.py: outlines every 0.05 s, the deepest moment dashed, "
        f"the ball where it ends after {runs['penalty'].t[-1]:g} s. The lens magnifies the contact {ZOOM} times. "
        f"The dashed line in penalty’s is m g / k = {1000 * WEIGHT / stiffness:.3f} mm, as deep as a spring of "
        f"{number(stiffness)} N/m must be pressed to carry 1 kg."
    )
    return {**LANE, "lanes": lanes, "caption": caption, "results": results}


# ---- a small plotter, the same grammar as draw.js


class Axis:
    """One axis: `low` to `high`, linear or logarithmic; on a log axis `zero` makes room for 0."""

    def __init__(self, low, high, ticks, label="", log=False, zero=False):
        self.low, self.high, self.ticks, self.label, self.log, self.zero = (
            low,
            high,
            ticks,
            label,
            log,
            zero,
        )

    def share(self, value):
        """0 at the low end, 1 at the high end."""
        if not self.log:
            return (value - self.low) / (self.high - self.low)
        base = math.log10(self.low) - (1.0 if self.zero else 0.0)
        return max(math.log10(value) - base, 0.0) / (math.log10(self.high) - base) if value > 0 else 0.0


def escape(text):
    """Text inside SVG."""
    return str(text).replace("&", "&amp;").replace("<", "&lt;")


class Plot:
    """An SVG plot of WIDE x height px: add lines, points and rules, then str() it."""

    def __init__(self, name, label, height, x, y, top=26):
        wide = max(len(text) for _, text in y.ticks)
        self.height, self.x, self.y, self.name, self.label = height, x, y, name, label
        self.left, self.right, self.top = max(30, 10 + 8 * wide), WIDE - 10, top
        self.bottom = height - (42 if x.label else 24 if x.ticks else 6)
        self.inside, self.outside = [], []

    def at(self, x, y):
        return (
            self.left + self.x.share(x) * (self.right - self.left),
            self.bottom - self.y.share(y) * (self.bottom - self.top),
        )

    def line(self, model, xs, ys, kind=""):
        points = [self.at(x, y) for x, y in zip(xs, ys) if math.isfinite(y)]
        path = "M" + "L".join(
            f"{show(x)} {show(min(max(y, self.top - 40), self.bottom + 40))}" for x, y in points
        )
        self.inside.append(
            f'<path d="{path}" class="{f"line m-{model}" if model else ""} {kind}"/>'.replace(' "', '"')
        )
        return self

    def points(self, model, xs, ys, size=4.5):
        self.inside += [
            f'<path d="{marker(model, *self.at(x, y), size)}" class="mark m-{model}"/>'
            for x, y in zip(xs, ys)
            if math.isfinite(y)
        ]
        return self

    def rule(self, x=None, y=None, text="", dashed=False, row=0, side=None):
        if x is not None:
            px = self.at(x, self.y.low)[0]
            ends = f'x1="{show(px)}" x2="{show(px)}" y1="{self.top}" y2="{self.bottom}"'
            left = side == "end" if side else px > (self.left + self.right) / 2
            place, anchor = (px - 5 if left else px + 5, self.top + 12 + 18 * row), (
                "end" if left else "start"
            )
        else:
            py = self.at(self.x.low, y)[1]
            ends = f'x1="{self.left}" x2="{self.right}" y1="{show(py)}" y2="{show(py)}"'
            place, anchor = (self.right - 4, py - 5), "end"
        self.inside.append(f'<line {ends} class="rule{" dashed" if dashed else ""}"/>')
        if text:
            self.note(*place, text, anchor)
        return self

    def note(self, px, py, text, anchor="start"):
        self.outside.append(
            f'<text x="{show(px)}" y="{show(py)}" class="tick strong" text-anchor="{anchor}">'
            f"{escape(text)}</text>"
        )
        return self

    def __str__(self):
        out = [
            f'<svg class="plot" width="{WIDE}" height="{self.height}" viewBox="0 0 {WIDE} {self.height}" role="img" '
            f'aria-label="{escape(self.label)}"><clipPath id="clip-{self.name}"><rect x="{self.left}" '
            f'y="{self.top - 3}" width="{self.right - self.left}" height="{self.bottom - self.top + 6}"/></clipPath>'
        ]
        if self.y.label:
            out.append(f'<text x="0" y="14" class="axis-name">{escape(self.y.label)}</text>')
        for value, text in self.y.ticks:
            py = show(self.at(self.x.low, value)[1])
            out.append(
                f'<line x1="{self.left}" x2="{self.right}" y1="{py}" y2="{py}" class="grid"/>'
                f'<text x="{self.left - 6}" y="{show(float(py) + 5)}" class="tick" text-anchor="end">{escape(text)}</text>'
            )
        for value, text in self.x.ticks:
            px = self.at(value, self.y.high)[0]
            end = px > self.right - 14
            out.append(
                f'<line x1="{show(px)}" x2="{show(px)}" y1="{self.bottom}" y2="{self.bottom + 5}" class="axis"/>'
                f'<text x="{show(self.right if end else px)}" y="{self.bottom + 20}" class="tick" '
                f'text-anchor="{"end" if end else "middle"}">{escape(text)}</text>'
            )
        if self.x.label:
            out.append(
                f'<text x="{self.right}" y="{self.height - 4}" class="axis-name" text-anchor="end">{escape(self.x.label)}</text>'
            )
        out.append(
            f'<line x1="{self.left}" x2="{self.right}" y1="{self.bottom}" y2="{self.bottom}" class="axis"/>'
        )
        return "".join(
            [*out, f'<g clip-path="url(#clip-{self.name})">', *self.inside, "</g>", *self.outside, "</svg>"]
        )


def plain_ticks(*values):
    return [(value, f"{value:g}") for value in values]


def one_ball(height, restitution=0.0, damping=None):
    """The drop, from another height."""
    scene = contact.build_scene("drop", restitution=restitution, damping=damping)
    return scene._replace(q0=np.array([[0.0], [height]]))


# ---- the small figures


def complementarity(runs):
    """Gap against push, per step, for all three models: the corner that contact is."""
    plot = Plot(
        "complementarity",
        "Push of the table over weight against gap, one mark a step. The allowed states are "
        "the two arms of a corner: a gap and no push, or a push and no gap. Only exact and lcp at rest are on it.",
        280,
        Axis(-1.5, 1.5, plain_ticks(-1, 0, 1), "gap (mm)"),
        Axis(-0.2, 2.4, plain_ticks(0, 1, 2), "push / weight"),
    )
    x0, y0 = plot.at(0, 0)
    corner = f"M{show(x0)} {plot.top}V{show(y0)}H{plot.right}"
    plot.inside.append(
        f'<path d="{corner}" style="fill:none;stroke:var(--rule);stroke-width:9;stroke-linejoin:round"/>'
    )
    for model, run in runs.items():
        gap = 1000 * (run.q[:-1, 1, 0] - R)
        push = np.diff(run.v[:, 1, 0]) / np.diff(run.t) / WEIGHT + 1.0
        near = np.flatnonzero((np.abs(gap) < 1.5) & (push < 2.4))
        seen = sorted({(round(float(gap[k]), 2), round(float(push[k]), 2)) for k in near})
        plot.points(model, *zip(*seen), size=3.6 if model == "penalty" else 5)
    plot.note(x0 + 8, plot.at(0, 1.75)[1], "push, no gap")
    plot.note(plot.right - 4, plot.at(0, 0.12)[1], "gap, no push", "end")
    return {
        "name": "complementarity",
        "svg": str(plot),
        "caption": "One mark a step of the drop, while the ball is near the table. Contact allows only the grey corner. "
        "penalty lives left of it, inside the table. lcp gets in, is pushed out, and pushes a little early on its way "
        "back. exact never leaves the corner.",
    }


def sink():
    """What a stiffer spring buys, and what it costs."""
    ks = np.geomspace(1e3, 1e6, 61)
    damping = contact.build_scene("drop").damping
    measured = []
    for k in np.geomspace(1.5e3, 7e5, 6):
        dt = 0.5 * contact.critical_dt(1.0, k, damping)
        steps = min(20000, math.ceil(4 / dt))
        run = contact.run_model("penalty", one_ball(R), dt, steps, stiffness=k)
        measured.append((k, (R - run.q[-1, 1, 0]) / R))
    ticks = [(10.0**p, f"{10 ** p:g}" if p < 4 else f"1e{p}") for p in (3, 4, 5, 6)]
    top = Plot(
        "sink-depth",
        "Depth at rest over radius against stiffness: it falls as one over k.",
        150,
        Axis(1e3, 1e6, [], log=True),
        Axis(
            1e-4,
            0.1,
            [(1e-4, "1e−4"), (1e-3, "0.001"), (0.01, "0.01"), (0.1, "0.1")],
            "rest depth / r: m g / k",
            log=True,
        ),
    )
    top.line("penalty", ks, WEIGHT / ks / R).points("penalty", *zip(*measured))
    bottom = Plot(
        "sink-dt",
        "Largest stable time step against stiffness: it falls as well.",
        190,
        Axis(1e3, 1e6, ticks, "stiffness k (N/m)", log=True),
        Axis(1e-3, 0.1, [(1e-3, "0.001"), (0.01, "0.01"), (0.1, "0.1")], "largest stable dt (s)", log=True),
    )
    bottom.line("penalty", ks, [contact.critical_dt(1.0, k, damping) for k in ks])
    return {
        "name": "sink",
        "svg": f"{top}{bottom}",
        "slider": "Stiffness",
        "caption": "A stiffer spring sinks less (above: line m g / k, marks measured) and needs smaller steps (below). "
        "Both curves go down together; that is the trap.",
    }


def cliff():
    """Does the ball come to rest? Against dt, with both critical steps."""
    scene, k = contact.build_scene("drop"), FLAGS.stiffness
    dts = np.geomspace(0.004, 0.064, 80)

    def unrest(model, dt):
        steps = int(20 / dt)
        run = contact.run_model(model, scene, dt, steps)
        late = run.q[int(0.75 * steps) :, 1, 0]
        return min(1e9, float(np.ptp(late)) / R)

    damped, undamped = contact.critical_dt(1.0, k, scene.damping), contact.critical_dt(1.0, k, 0.0)
    plot = Plot(
        "cliff",
        "How much the ball still moves after 15 s against the time step. lcp rests at every one. "
        f"penalty never rests above {damped:.4f} s.",
        260,
        Axis(0.004, 0.064, plain_ticks(0.004, 0.008, 0.016, 0.032), "time step dt (s)", log=True),
        Axis(
            1e-6,
            1e9,
            [(0, "0"), (1e-4, "1e−4"), (1, "1"), (1e4, "1e4"), (1e8, "1e8")],
            "still moving after 15 s (r)",
            log=True,
            zero=True,
        ),
        top=64,
    )
    for model in ("penalty", "lcp"):
        values = [unrest(model, dt) for dt in dts]
        plot.line(model, dts, values)
        some = [8, 24, 40, 56, 72] if model == "penalty" else [16, 32, 48, 64]
        plot.points(model, dts[some], [values[i] for i in some])
    plot.rule(x=undamped, text=f"2√(m/k) {number(undamped)}", dashed=True, row=-2, side="start")
    plot.rule(x=damped, text=f"with damper {number(damped)}", row=-1, side="end")
    return {
        "name": "cliff",
        "svg": str(plot),
        "slider": "Damping",
        "caption": "The drop, 20 s long, at 80 time steps. The textbook’s limit (dashed) ignores the damper; past the other one "
        "the ball never rests. Both speak of a ball that stays in contact: a little below, a hard landing can "
        "still throw it off (the spike). More damping moves the cliff to smaller steps.",
    }


def sweeps():
    """lam of the three contacts of a resting stack, after each sweep."""
    dt = FLAGS.dt
    q = [0.0] * 3, [R, 3 * R, 5 * R]
    contacts = contact.detect_contacts(q, [R] * 3)
    history = [[0.0] * 3]
    for count in range(1, 21):
        fall = [0.0] * 3, [contact.GRAVITY * dt] * 3
        _, lam = contact.solve_contacts(fall, [1.0] * 3, contacts, [0.0] * 3, count)
        history.append([value / (WEIGHT * dt) for value in lam])
    plot = Plot(
        "sweeps",
        "Impulse of each contact over what one ball needs, after each of 20 sweeps: they approach 3, 2 "
        "and 1 from below.",
        220,
        Axis(0, 20, plain_ticks(0, 5, 10, 15, 20), "sweep"),
        Axis(0, 3.4, plain_ticks(0, 1, 2, 3), "lam / (m g dt)"),
    )
    for level in (1, 2, 3):
        plot.rule(y=level, dashed=True)
    for ys in zip(*history):
        plot.line("lcp", range(21), ys).points("lcp", range(21), ys)
    return {
        "name": "sweeps",
        "svg": str(plot),
        "slider": "Sweeps",
        "caption": "Three balls at rest, one on another. Each sweep visits the three contacts once; what they should carry "
        "(3, 2 and 1 balls, dashed) is approached from below, sweep by sweep, and after 20 still a little short.",
    }


def bounces():
    """Infinitely many bounces, over at a finite time."""
    e = 0.7
    scene = contact.build_scene("bounce")
    first = math.sqrt(2 * (scene.q0[1, 0] - R) / WEIGHT)
    end = first * (1 + e) / (1 - e)
    until = 1.15 * end
    run = contact.run_model("exact", scene._replace(restitution=e), until / 300, 300)
    plot = Plot(
        "bounces",
        f"Height against time with restitution {e}: lower and quicker bounces, all over at "
        f"{number(end)} s.",
        210,
        Axis(0, until, plain_ticks(0, 1, 2), "time (s)"),
        Axis(0, 1.1, plain_ticks(0, 0.5, 1), "height (m)"),
    )
    plot.line("exact", run.t, run.q[:, 1, 0]).rule(x=end, text=f"over at {number(end)} s", dashed=True)
    return {
        "name": "bounces",
        "svg": str(plot),
        "slider": "Restitution",
        "caption": "exact takes each impact at its own time. The bounces get quicker without end and still end: the dashed "
        "time is the closed form t₁ (1 + e) / (1 − e).",
    }


def small_figures(runs):
    """Every small figure by name; `runs` is the drop's, by model."""
    figures = (complementarity(runs), sink(), cliff(), sweeps(), bounces())
    return {figure["name"]: figure for figure in figures}
