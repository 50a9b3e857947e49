"""The cells that only the notebook has: its set-up, its knobs and its pictures.

Each cell begins with a line `# %% NAME`. curriculum/notebook/ puts it where the chapter has the
figure of that name; `start` and `tools` come first. Names that are not defined here are
contact.py's.
"""
# ruff: noqa: B007, B008, B018, E401, E402, F811, F821, I001
# fmt: off

# %% start
#@title Run me first: the course's folder is unpacked beside the notebook, and contact.py is read
import base64, importlib.util, io, math, os, subprocess, sys, zipfile

absent = [name for name in ("numpy", "matplotlib") if importlib.util.find_spec(name) is None]
if absent:
    subprocess.check_call([sys.executable, "-m", "pip", "install", "--quiet", *absent])
COURSE = os.path.abspath("contact_chapter")
zipfile.ZipFile(io.BytesIO(base64.b64decode(FOLDER))).extractall(COURSE)
sys.path.insert(0, COURSE)
sys.modules["contact"] = sys.modules["__main__"]    # whatever you change below is used everywhere
__file__ = os.path.join(COURSE, "contact.py")
with open(__file__, encoding="utf-8") as file:
    exec(file.read().split('if __name__ == "__main__"')[0])

# %% tools
#@title And me second: what the pictures and the knobs below share
import zlib

import matplotlib.pyplot as plt
from IPython.display import SVG, display
from IPython.utils.capture import capture_output

from curriculum.run.plotting import COLORS


def course(*words):
    """Run a script of the course's folder and print what it prints."""
    done = subprocess.run([sys.executable, *words], cwd=COURSE, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)
    print(done.stdout + done.stderr)


def plain(value, digits=4):
    """The number as text; what is rounded to zero has no sign."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"


def legend_beside(axes):
    """The legend to the right of the picture, where it hides nothing."""
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def film(runs, slow=1.0):
    """The balls of runs {model: Run} as a moving picture, over and over; hold the mouse on it to
    stop it. `slow` times slower than the clock."""
    first = next(iter(runs.values()))
    stride = max(1, round(1.0 / 60.0 / slow / (first.t[1] - first.t[0])))
    scale = 220.0 / (first.q[0, 1].max() + RADIUS)
    made = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -240 {150 * len(runs)} 290" '
            f'width="{150 * len(runs)}" font-family="sans-serif" font-size="14">']
    for lane, (model, run) in enumerate(runs.items()):
        path, color = np.clip(scale * run.q[::stride], -400.0, 400.0), COLORS[model]
        made.append(f'<g transform="translate({150 * lane + 75})">')
        for ball in range(path.shape[2]):
            last = len(path) - 1
            frames = "".join(f"{100 * k / last:.3g}%{{transform:translate({x:.1f}px,{-y:.2f}px)}}"
                             for k, (x, y) in enumerate(path[:, :, ball]))
            key = f"b{lane}-{ball}-{zlib.crc32(frames.encode())}"     # other films are on this page
            made.append(f"<style>@keyframes {key}{{{frames}}}"
                        f"#{key}{{animation:{key} {slow * run.t[-1]:g}s linear infinite}}"
                        f"svg:hover #{key}{{animation-play-state:paused}}</style>"
                        f'<circle id="{key}" r="{scale * RADIUS:.1f}" fill="{color}"/>')
        made.append('<path d="M-75 0h150" stroke="#888888" stroke-width="2"/>'
                    f'<text y="30" text-anchor="middle" fill="{color}">{model}</text></g>')
    return SVG("".join(made) + "</svg>")


def knobs(draw, **ranges):
    """The pictures that `draw` shows, below a slider for each of the ranges {name: (low, value,
    high)}; without ipywidgets once, with these values. A range that begins above 0 is turned by
    powers. (`interact` would be shorter, but `jupyter nbconvert --execute` often hangs in it: it
    answers an Output widget on the socket on which it waits; see jupyter/nbclient, issue 312.)"""
    try:
        from ipywidgets import FloatLogSlider, FloatSlider, Image, VBox
    except ImportError:
        return draw(**{name: value for name, (_, value, _) in ranges.items()})
    look = {"continuous_update": False, "readout_format": ".3g",
            "style": {"description_width": "initial"}}
    sliders, pictures = {}, VBox()
    for name, (low, value, high) in ranges.items():
        if low > 0.0:
            kind, look["min"], look["max"] = FloatLogSlider, math.log10(low), math.log10(high)
        else:
            kind, look["min"], look["max"] = FloatSlider, low, high
        sliders[name] = kind(value, description=name, step=(look["max"] - look["min"]) / 50, **look)

    def redraw(_=None):
        with capture_output() as caught:
            draw(**{name: slider.value for name, slider in sliders.items()})
        pictures.children = [Image(value=base64.b64decode(each.data["image/png"]))
                             for each in caught.outputs]

    redraw()
    for slider in sliders.values():
        slider.observe(redraw, "value")
    return VBox([*sliders.values(), pictures])


def draw_gaps(runs, scene, **look):
    """The gaps over time of runs {model: Run}, exact below the others."""
    drawing, axes = plt.subplots(figsize=(7, 3))
    axes.axhline(0.0, color="0.3", linewidth=1)
    for model in sorted(runs):
        axes.plot(runs[model].t, smallest_gap(runs[model].q, scene.radius) / RADIUS, label=model,
                  color=COLORS[model], linewidth=3 if model == "exact" else 1.5)
    axes.set(xlabel="time [s]", ylabel="gap [r]", **look)
    legend_beside(axes)
    plt.show()


def watch(model, scene, dt, settings=Settings()):
    """The gap over time of a model's run beside the exact one, and its depths."""
    runs = {name: run_model(name, scene, dt, int(2.0 / dt), settings) for name in ("exact", model)}
    depth = np.maximum(-smallest_gap(runs[model].q, scene.radius) / RADIUS, 0.0)
    title = f"{model}: {plain(depth.max())} r at the deepest, {plain(depth[-1])} r at the end"
    draw_gaps(runs, scene, ylim=(-1.2 * min(max(depth.max(), 0.1), 2.5), 1.2), title=title)

# %% grab
scene = build_scene("drop")
moving = film({"exact": run_model("exact", scene, 0.002, 600)})
moving

# %% two
scene = build_scene("drop")     # up to the landing: what happens then?
film({model: run_model(model, scene, 0.002, 212) for model in ("penalty", "lcp")}, slow=4.0)

# %% lanes
scene = build_scene("drop")
runs = {model: run_model(model, scene, 0.002, 2000) for model in MODELS}
qualities = {model: contact_quality(run, scene, 0.002, runs["exact"])
             for model, run in runs.items()}
display(film({model: run._replace(t=run.t[:750], q=run.q[:750]) for model, run in runs.items()}))
draw_gaps(runs, scene, xlim=(0.4, 1.0), ylim=(-0.4, 1.1), title="drop")
for model, quality in qualities.items():
    print(f"{model:<8} deepest {plain(quality['max_penetration_frac'])} r,",
          f"gap at rest {plain(quality['rest_gap_frac'])} r,",
          f"rebound {plain(quality['rebound_frac'])} r")

# %% corner
drawing, axes = plt.subplots(figsize=(5, 3.2))
axes.plot([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], color="0.2", linewidth=4, solid_joinstyle="miter")
axes.annotate("in touch: any push", (0.02, 0.7), (0.15, 0.75), arrowprops={"arrowstyle": "->"})
axes.annotate("apart: no push", (0.6, 0.02), (0.5, 0.25), arrowprops={"arrowstyle": "->"})
axes.set(xlim=(-0.3, 1.0), ylim=(-0.15, 1.0), xticks=[0.0], yticks=[0.0], xlabel="gap",
         ylabel="force", title="the corner: where a contact may be")

# %% signs
drawing, axes = plt.subplots(figsize=(6, 3.4))
a, b = Ball(0.13, 0.22, -0.6, -0.3, 1.0, RADIUS), Ball(0.0, RADIUS, 0.0, 0.0, 1.0, RADIUS)
axes.axhspan(-0.06, 0.0, color="0.8")
for name, ball in ("a", a), ("b", b):
    axes.add_patch(plt.Circle((ball.x, ball.y), RADIUS, color=COLORS["exact"], alpha=0.3))
    axes.text(ball.x, ball.y, name, ha="center", va="center")
arrow = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.008}
axes.quiver(a.x, a.y, 0.2 * a.vx, 0.2 * a.vy, color="0.4", **arrow)
for other, c in zip(("the floor", "b"), (c for c in detect_contacts([a, b], 0.2) if c.a is a)):
    foot = c.b.x + RADIUS * c.nx if c.b is b else a.x, c.b.y + c.b.radius * c.ny
    axes.quiver(*foot, 0.08 * c.nx, 0.08 * c.ny, color=COLORS["lcp"], **arrow)
    axes.text(0.32, foot[1] + 0.05, f"a and {other}: depth {plain(c.depth / RADIUS, 2)} r,\n    "
              f"v_n {plain(c.v_n(), 2)} m/s: {'separating' if c.v_n() > 0.0 else 'closing'}")
axes.set(xlim=(-0.15, 0.85), ylim=(-0.06, 0.36), aspect="equal", xticks=[], yticks=[],
         title="blue: n, from b to a and from the floor up; grey: the velocity of a")

# %% sponge
#@title penalty: turn the stiffness, the damping and the step
def try_penalty(stiffness, damping, dt):
    watch("penalty", build_scene("drop", damping=damping), dt, Settings(stiffness=stiffness))


knobs(try_penalty, stiffness=(100.0, 1e4, 1e6), damping=(0.0, 80.0, 300.0),
      dt=(0.0005, 0.002, 0.064))

# %% cliff
grid = np.geomspace(0.004, 0.05, 40)
scene = build_scene("drop")
drawing, axes = plt.subplots(figsize=(7, 3))
for model in ("penalty", "lcp", "soft"):
    gained = []
    for step in grid:
        run = run_model(model, scene, float(step), int(8.0 / step))
        gained.append(max(contact_quality(run, scene, float(step))["energy_excess"], 1e-6))
    axes.loglog(grid, gained, ".-", color=COLORS[model], label=model)
axes.axvline(critical_dt(1.0, 1e4, 80.0), color="0.6", label="critical dt")
axes.axvline(critical_dt(1.0, 1e4, 0.0), color="0.6", linestyle=":", label="without the damper")
axes.set(xlabel="dt [s]", ylabel="energy gained [start]", title="the cliff", ylim=(5e-7, 1e7))
legend_beside(axes)

# %% corner-lcp
#@title lcp: turn the gain and the step
def try_lcp(baumgarte, dt):
    watch("lcp", build_scene("drop"), dt, Settings(baumgarte=baumgarte))


knobs(try_lcp, baumgarte=(0.0, 0.2, 1.0), dt=(0.0005, 0.002, 0.064))

# %% sweeps
drawing, axes = plt.subplots(figsize=(7, 3))
for count, style in ((2, ":"), (3, "-."), (6, "--"), (12, "-")):
    left = []
    for sweeps in range(60):
        balls = [Ball(0.0, (2 * i + 1) * RADIUS, 0.0, -1.0, 1.0, RADIUS) for i in range(count)]
        contacts = detect_contacts(balls)
        solve_contacts(contacts, sweeps)
        left.append(max(-c.v_n() for c in contacts))
    axes.semilogy(np.maximum(left, 1e-17), style, color=COLORS["lcp"], label=f"{count} balls")
axes.set(xlabel="sweeps", ylabel="fastest approach [m/s]", title="lcp: sweeps on a stack",
         ylim=(1e-9, 2))
legend_beside(axes)


# %% clamp
def clamp_the_change(contacts, iters, tolerance=0.0):
    """The sweep with the wrong clamp: it can push, and never take a push back."""
    for c in [*contacts] * iters:
        change = max(0.0, (c.target - c.v_n()) * c.m_eff)
        c.lam += change
        c.push(change)


def fall_into_groove(sweep):
    """The path of a ball that falls into a groove of two fixed balls, [r]."""
    global solve_contacts
    right, solve_contacts = solve_contacts, sweep
    fixed = math.inf
    scene = scene_of([0.0, -0.12, 0.12], [2.0, 1.0, 1.0], [1.0, fixed, fixed])
    run = run_model("lcp", scene, 0.002, 500)
    solve_contacts = right
    return run.q[:, 0, 0] / RADIUS, (run.q[:, 1, 0] - 1.0) / RADIUS


grooves = {"on the sum": fall_into_groove(solve_contacts),
           "on the change": fall_into_groove(clamp_the_change)}
drawing, axes = plt.subplots(figsize=(7, 4))
for x in (-1.2, 1.2):
    axes.add_patch(plt.Circle((x, 0.0), 1.0, color="0.85"))
for (clamp, path), style in zip(grooves.items(), ("-", "--")):
    axes.plot(*path, style, color=COLORS["lcp"], label=f"clamp {clamp}")
axes.set(xlim=(-2.5, 2.5), ylim=(-0.5, 3.5), aspect="equal", xlabel="x [r]", ylabel="y [r]",
         title="lcp: a ball falls into a groove")
legend_beside(axes)


# %% bounces
#@title exact: turn the restitution; all four models
def try_bounce(restitution, dt):
    scene = build_scene("bounce", restitution=restitution)
    runs = {model: run_model(model, scene, dt, int(4.0 / dt)) for model in MODELS}
    draw_gaps(runs, scene, ylim=(-2.0, 12.0), title="bounce")


knobs(try_bounce, restitution=(0.0, 0.7, 1.0), dt=(0.0005, 0.002, 0.064))

# %% cradle
drawing, pictures = plt.subplots(1, 2, sharey=True, figsize=(8, 3))
for axes, between in zip(pictures, (0.0, 0.01)):
    x = np.arange(4) * (2.0 + between) * RADIUS
    x[0] -= 0.3
    row = scene_of(x, RADIUS, vx=[1.0, 0.0, 0.0, 0.0], restitution=1.0)
    run = run_model("exact", row, 0.005, 150)
    axes.plot(run.t, run.q[:, 0], color=COLORS["exact"])
    axes.set(xlabel="time [s]", ylabel="x [m]", title="touching" if between == 0.0 else
             "a hundredth of r between")

# %% slide
start, middle = 0.3, 5.0        # rad from the top of a ball that is held at this height [m]
x, y = 2 * RADIUS * math.sin(start), middle + 2 * RADIUS * math.cos(start)
hill = scene_of([0.0, x], [middle, y], [math.inf, 1.0])
drawing, axes = plt.subplots(figsize=(7, 3))
for model in ("exact", "penalty", "lcp", "soft"):
    run = run_model(model, hill, 0.001, 400)
    apart = run.q[:, :, 1] - run.q[:, :, 0]
    distance = np.hypot(*apart.T)
    axes.plot(apart[:, 1] / distance / math.cos(start), distance / RADIUS - 2.0,
              color=COLORS[model], label=model, linewidth=3 if model == "exact" else 1)
axes.axvline(2.0 / 3.0, color="0.6", linestyle=":", label="2/3")
axes.set(xlim=(1.0, 0.55), ylim=(-0.02, 0.05), xlabel="cos(theta) / cos(theta0)", ylabel="gap [r]",
         title="a ball slides off a ball, and leaves it")
legend_beside(axes)

# %% impedance
#@title soft: turn the time constant and the impedance
def try_soft(timeconst, impedance_at_surface, dt):
    solimp = (impedance_at_surface, max(impedance_at_surface, 0.95), 0.001, 0.5, 2.0)
    deep = np.linspace(0.0, 0.0015, 200)
    plt.figure(figsize=(5, 1.8))
    plt.plot(1000.0 * deep, [impedance(x, solimp) for x in deep], color=COLORS["soft"])
    plt.gca().set(xlabel="depth [mm]", ylabel="d", ylim=(0.0, 1.05), title="soft: how firm it is")
    watch("soft", build_scene("drop"), dt, Settings(solref=(timeconst, 1.0), solimp=solimp))


knobs(try_soft, timeconst=(0.002, 0.02, 0.2), dt=(0.0005, 0.002, 0.064),
      impedance_at_surface=(0.0, 0.9, 0.9999))
