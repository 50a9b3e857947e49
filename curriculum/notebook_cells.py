"""The cells that only the notebook has: its pictures, and the comparison with MuJoCo.

Each cell begins with a line `# %% NAME`. curriculum/notebook.py puts it where the chapter has the
figure of that name, or as soon as everything it uses is defined. The names that are not defined
here are those of contact.py and curriculum/exact.py, whose regions are cells before it.
"""
# ruff: noqa: B007, E402, F811, F821
# fmt: off

# %% first
# A ball falls, and the integrator of chapter 3.3 has never heard of a table.
import matplotlib.pyplot as plt
import numpy as np

gravity, radius, dt = -9.81, 0.1, 0.002
height, speed, heights = 1.0, 0.0, []
for step in range(260):
    speed += dt * gravity       # semi-implicit Euler: the velocity first,
    height += dt * speed        # then the position
    heights.append(height)

figure, axes = plt.subplots(figsize=(7.5, 3.4))
axes.axhspan(-0.4, 0.0, color="0.85")
for step in range(0, 260, 20):
    axes.add_patch(plt.Circle((step / 100.0, heights[step]), radius, fill=False, color="C0"))
axes.annotate("the table", (0.0, -0.22))
axes.annotate("What force would\nhave stopped it here?", (2.2, 0.06), (2.5, 0.5),
              arrowprops={"arrowstyle": "->"})
axes.set(xlim=(-0.2, 3.4), ylim=(-0.4, 1.2), aspect="equal", xticks=[], xlabel="time",
         ylabel="height [m]")
figure.tight_layout()

# %% corner
figure, axes = plt.subplots(figsize=(4.5, 3))
axes.plot([0.0, 0.0, 1.0], [1.0, 0.0, 0.0], color="0.2", linewidth=4, solid_joinstyle="miter")
axes.annotate("lies:\nany push", (0.03, 0.7))
axes.annotate("flies: no push", (0.5, 0.04))
axes.set(xlim=(-0.3, 1.0), ylim=(-0.05, 1.0), xlabel="gap", ylabel="force", xticks=[0], yticks=[0])
figure.tight_layout()

# %% balance
stiffnesses = [300.0, 1e3, 3e3, 1e4, 3e4, 1e5]
depths = []
for stiffness in stiffnesses:
    ball = Ball(0.0, RADIUS, 0.0, 0.0, 1.0, RADIUS)
    for _ in range(4000):
        penalty_step([ball], 0.001, stiffness, 30.0)
    depths.append((RADIUS - ball.y) / RADIUS)
figure, axes = plt.subplots(figsize=(6, 3))
axes.loglog(stiffnesses, [-GRAVITY / k / RADIUS for k in stiffnesses], color="0.6", label="m g / k")
axes.loglog(stiffnesses, depths, "o", color="#d55e00", label="measured")
axes.set(xlabel="stiffness k [N/m]", ylabel="depth at rest [r]", title="penalty: the sink")
axes.legend()
figure.tight_layout()

# %% dive
ball = Ball(0.0, 1.0 + RADIUS, 0.0, 0.0, 1.0, RADIUS)
times, gaps, forces = [], [], []
for step in range(450):
    penalty_step([ball], 0.002, 1e4, 80.0)
    times.append(0.002 * (step + 1))
    gaps.append((ball.y - RADIUS) / RADIUS)
    forces.append(ball.fy)
figure, (above, below) = plt.subplots(2, sharex=True, figsize=(7, 4))
above.plot(times, gaps, color="#d55e00")
above.axhline(0.0, color="0.3")
above.set(xlim=(0.42, 0.9), ylim=(-0.4, 1.1), ylabel="gap [r]", title="penalty: the dive, the throw")
below.plot(times, forces, color="#d55e00")
below.axhline(-GRAVITY, color="0.6", label="its weight")
below.set(xlabel="time [s]", ylabel="push [N]", yscale="symlog")
below.legend()
figure.tight_layout()

# %% sweeps
figure, axes = plt.subplots(figsize=(6, 3))
for count in (2, 3, 6, 12):
    left = []
    for sweeps in range(60):
        balls = [Ball(0.0, (2 * i + 1) * RADIUS, 0.0, -1.0, 1.0, RADIUS) for i in range(count)]
        contacts = detect_contacts(balls)
        solve_contacts(contacts, sweeps)
        left.append(max(-c.v_n() for c in contacts))
    axes.semilogy(np.maximum(left, 1e-17), label=f"{count} balls")
axes.set(xlabel="sweeps", ylabel="fastest approach left [m/s]", title="lcp: sweeps on a stack",
         ylim=(1e-9, 2))
axes.legend()
figure.tight_layout()


# %% clamp
def fall_into_groove(clamp):
    """The path of a ball that falls into a groove of two fixed balls, with that clamp."""
    global project_impulse
    right, project_impulse = project_impulse, clamp
    fixed = [Ball(x, 1.0, 0.0, 0.0, math.inf, RADIUS) for x in (-0.12, 0.12)]
    ball, path = Ball(0.0, 2.0, 0.0, 0.0, 1.0, RADIUS), []
    for _ in range(500):
        lcp_step([*fixed, ball], 0.002, 0.0, 0.2, 20)
        path.append((ball.x / RADIUS, (ball.y - 1.0) / RADIUS))
    project_impulse = right
    return np.transpose(path)


figure, axes = plt.subplots(figsize=(6, 4))
for x in (-1.2, 1.2):
    axes.add_patch(plt.Circle((x, 0.0), 1.0, color="0.85"))
axes.plot(*fall_into_groove(lambda lam, dlam: max(0.0, lam + dlam)), label="clamp on the sum")
axes.plot(*fall_into_groove(lambda lam, dlam: lam + max(0.0, dlam)), "--",
          label="clamp on the change")
axes.set(xlim=(-2.5, 2.5), ylim=(-0.5, 3.5), aspect="equal", xlabel="x [r]", ylabel="y [r]",
         title="lcp: the path of a ball that falls into a groove")
axes.legend()
figure.tight_layout()


# %% larger
def bounce_by(target):
    """Heights of a ball that bounces, with that target in place of contact_target."""
    global contact_target
    right, contact_target = contact_target, target
    ball, heights = Ball(0.0, 1.0, 0.0, 0.0, 1.0, RADIUS), []
    for _ in range(900):
        lcp_step([ball], 0.002, 0.7, 0.2, 20)
        heights.append(ball.y)
    contact_target = right
    return heights


def sum_of_both(c, restitution, baumgarte, dt):
    return baumgarte / dt * max(c.depth, 0.0) - restitution * c.v_n()


figure, axes = plt.subplots(figsize=(7, 3))
axes.plot(np.arange(900) * 0.002, bounce_by(contact_target), label="the larger of the two")
axes.plot(np.arange(900) * 0.002, bounce_by(sum_of_both), "--", label="their sum")
axes.axhline(RADIUS + 0.7**2 * 0.9, color="0.6", linewidth=1, label="what e = 0.7 allows")
axes.set(xlabel="time [s]", ylabel="height [m]", title="lcp: the first bounce")
axes.legend()
figure.tight_layout()

# %% hop
figure, axes = plt.subplots(figsize=(7, 3))
for gain in (0.0, 0.2, 1.0):
    ball, gaps = Ball(0.0, 1.0054785, 0.0, 0.0, 1.0, RADIUS), []
    for _ in range(400):
        lcp_step([ball], 0.002, 0.0, gain, 20)
        gaps.append((ball.y - RADIUS) / RADIUS)
    axes.plot(np.arange(1, 401) * 0.002, gaps, label=f"beta = {gain:g}")
axes.axhline(0.0, color="0.3")
axes.set(xlim=(0.4, 0.8), ylim=(-0.3, 1.0), xlabel="time [s]", ylabel="gap [r]",
         title="lcp: Baumgarte's push makes the ball hop")
axes.legend()
figure.tight_layout()

# %% impedance
deep = np.linspace(0.0, 0.0015, 200)
figure, axes = plt.subplots(figsize=(6, 3))
axes.plot(1000.0 * deep, [impedance(x, SOLIMP) for x in deep], color="#cc79a7", label="default")
axes.plot(1000.0 * deep, [impedance(x, (0.0001, 0.95, 0.001, 0.5, 2.0)) for x in deep], "--",
          color="#cc79a7", label="from almost nothing")
axes.set(xlabel="depth [mm]", ylabel="d", title="soft: how firmly it asks")
axes.legend()
figure.tight_layout()

# %% mujoco
# soft beside the real engine, where it is installed (%pip install mujoco==3.10.0).
WORLD = """<mujoco><option timestep="0.002" tolerance="0"/><worldbody>
<geom type="plane" size="9 9 1" condim="1"/>
<body pos="0 0 1.0"><joint type="slide" axis="0 0 1"/>
<geom type="sphere" size="0.1" mass="1" condim="1"/></body></worldbody></mujoco>"""
try:
    import mujoco
except ImportError:
    print("mujoco is not installed, so there is nothing to compare with")
else:
    world = mujoco.MjModel.from_xml_string(WORLD)
    theirs, ours = mujoco.MjData(world), Ball(0.0, 1.0, 0.0, 0.0, 1.0, RADIUS)
    worst = 0.0
    for _ in range(2000):
        mujoco.mj_step(world, theirs)
        soft_step([ours], 0.002, *soft_defaults(0.0, 0.002))
        worst = max(worst, abs(1.0 + theirs.qpos[0] - ours.y))
    print(f"mujoco {mujoco.__version__} and soft, 2000 steps of the drop: at most {worst:.1e} m apart")

# %% bounces
scene = build_scene("bounce")
figure, axes = plt.subplots(figsize=(7, 3))
for model in ("exact", "penalty", "lcp", "soft"):
    run = run_model(model, scene, 0.002, 2000)
    axes.plot(run.t, (run.q[:, 1, 0] - RADIUS) / RADIUS, color=COLORS[model], label=model,
              linewidth=3 if model == "exact" else 1)
axes.set(xlabel="time [s]", ylabel="gap [r]", title="bounce: infinitely many, and they end")
axes.legend()
figure.tight_layout()

# %% cradle
figure, pictures = plt.subplots(1, 2, sharey=True, figsize=(8, 3))
for axes, between in zip(pictures, (0.0, 0.01)):
    x = np.arange(4) * (2.0 + between) * RADIUS
    x[0] -= 0.3
    start = np.array((x, np.full(4, RADIUS)))
    row = Scene("cradle", start, np.array([[1.0, 0, 0, 0], [0.0] * 4]), np.ones(4),
                np.full(4, RADIUS), 1.0, 0.0)
    run = run_model("exact", row, 0.005, 150)
    axes.plot(run.t, run.q[:, 0])
    axes.set(xlabel="time [s]", title="touching" if between == 0.0 else "a hundredth of r between")
pictures[0].set_ylabel("x [m]")
figure.tight_layout()

# %% slide
start = 0.3                     # rad from the top of a ball that is held
held_y = 5.0
place = [[0.0, 2 * RADIUS * math.sin(start)], [held_y, held_y + 2 * RADIUS * math.cos(start)]]
hill = Scene("slide", np.array(place), np.zeros((2, 2)), np.array([np.inf, 1.0]),
             np.full(2, RADIUS), 0.0, 80.0)
figure, axes = plt.subplots(figsize=(7, 3))
for model in ("exact", "penalty", "lcp", "soft"):
    run = run_model(model, hill, 0.001, 400)
    apart = run.q[:, :, 1] - run.q[:, :, 0]
    distance = np.hypot(*apart.T)
    axes.plot(apart[:, 1] / distance / math.cos(start), distance / RADIUS - 2.0,
              color=COLORS[model], label=model, linewidth=3 if model == "exact" else 1)
axes.axvline(2.0 / 3.0, color="0.6", linestyle=":")
axes.annotate("2/3", (2.0 / 3.0, 0.03))
axes.set(xlim=(1.0, 0.55), ylim=(-0.02, 0.05), xlabel="cos(theta) / cos(theta0)", ylabel="gap [r]",
         title="a ball slides off a ball, and leaves it")
axes.legend()
figure.tight_layout()

# %% lanes
scene = build_scene("drop")
runs = {model: run_model(model, scene, 0.002, 2000) for model in MODELS}
qualities = {model: contact_quality(run, scene, 0.002, runs["exact"])
             for model, run in runs.items()}
figure, lanes = plt.subplots(4, sharex=True, sharey=True, figsize=(7.5, 6))
for axes, (model, run) in zip(lanes, runs.items()):
    axes.axhspan(-0.5, 0.0, color="0.9")
    axes.plot(run.t, (run.q[:, 1, 0] - RADIUS) / RADIUS, color=COLORS[model])
    axes.set(xlim=(0.4, 1.0), ylim=(-0.4, 1.1), ylabel=model)
lanes[0].set_title("drop: the gap between ball and table [r]")
lanes[-1].set_xlabel("time [s]")
figure.tight_layout()
for model, quality in qualities.items():
    print(f"{model:<8} deepest {quality['max_penetration_frac']:.4f} r, "
          f"gap at rest {quality['rest_gap_frac']:.4f} r, "
          f"rebound {quality['rebound_frac']:.4f} r")

# %% cliff
steps = np.geomspace(0.004, 0.05, 40)
scene = build_scene("drop")
figure, axes = plt.subplots(figsize=(7, 3))
for model in ("penalty", "lcp", "soft"):
    gained = []
    for dt in steps:
        run = run_model(model, scene, float(dt), int(8.0 / dt))
        total = energy(run.q, run.v, scene.mass)
        gained.append(max((total - total[0]).max() / total[0], 1e-6))
    axes.loglog(steps, gained, ".-", color=COLORS[model], label=model)
axes.axvline(critical_dt(1.0, 1e4, 80.0), color="0.6", label="critical dt")
axes.axvline(critical_dt(1.0, 1e4, 0.0), color="0.6", linestyle=":", label="without the damper")
axes.set(xlabel="dt [s]", ylabel="energy gained [start]", title="the cliff", ylim=(5e-7, 1e7))
axes.legend()
figure.tight_layout()

# %% long-step
# One step from deep inside: the push belongs to the depth at its start, for the whole of the step.
steps = np.geomspace(0.001, 0.03, 200)
figure, axes = plt.subplots(figsize=(6, 3))
leaves = []
for dt in steps:
    ball = Ball(0.0, 0.8 * RADIUS, 0.0, 0.0, 1.0, RADIUS)
    penalty_step([ball], float(dt), 1e4, 0.0)
    leaves.append(ball.vy)
axes.loglog(steps, leaves, color="#d55e00", label="penalty")
most = math.sqrt(1e4) * 0.2 * RADIUS
axes.axhline(most, color="0.6", label="all that the spring has stored")
axes.set(xlabel="dt [s]", ylabel="speed after it [m/s]", title="one step, from 0.2 r deep at rest")
axes.legend()
figure.tight_layout()

# %% puzzle
stiffness, damping = 1e4, 80.0          # yours
run = run_model("penalty", build_scene("drop", damping=damping), 0.01, 2000, stiffness)
depth = max_penetration(run.q, np.array([RADIUS])) / RADIUS
still = np.abs(np.diff(run.q[-200:, 1, 0])).max() < 1e-6
print(f"sinks {-GRAVITY / stiffness / RADIUS:.5f} r (less than 0.001 wanted), critical dt "
      f"{critical_dt(1.0, stiffness, damping):.4f} s,",
      f"at rest {depth[-1]:.5f} r deep" if still else "does not come to rest")

# %% one-line
scene = build_scene("drop")
shares = [0.0001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999, 0.9999]
figure, (above, below) = plt.subplots(2, sharex=True, figsize=(7, 4.5))
for name, solref in (("penalty's spring", (-1e4, -80.0)), ("MuJoCo's default", SOLREF),
                     ("a stop in one step", (0.0, -500.0))):
    found = [run_model("soft", scene, 0.002, 800, solref=solref,
                       solimp=(d, d, 0.001, 0.5, 2.0)) for d in shares]
    depths = [max_penetration(run.q, scene.radius) / RADIUS for run in found]
    above.plot(shares, [depth.max() for depth in depths], "o-", label=name)
    below.plot(shares, [depth[-1] for depth in depths], "o-", label=name)
for model, d, gain in (("penalty", 0.0, 0.2), ("lcp", 1.0, 0.0)):
    depth = max_penetration(run_model(model, scene, 0.002, 800, baumgarte=gain).q, scene.radius)
    above.plot(d, depth.max() / RADIUS, "*", color=COLORS[model], markersize=14, label=model)
    below.plot(d, depth[-1] / RADIUS, "*", color=COLORS[model], markersize=14)
above.set(ylabel="deepest [r]", ylim=(0, 0.6), title="soft: one line from penalty to lcp")
below.set(xlabel="impedance d", ylabel="depth at rest [r]", ylim=(-0.005, 0.08))
above.legend(fontsize=8)
figure.tight_layout()
