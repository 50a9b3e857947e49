"""Numbers that the chapter quotes and no run of contact.py prints.

Each function returns {name: number}; the chapter quotes one as {{jump:before}}.
"""

import inspect
import math
from functools import partial
from itertools import product

import numpy as np

import contact
from curriculum import predict
from curriculum.source import replace_once
from curriculum.variants import core_step, implicit_step, turn

DT = 0.002  # s


def implicit_spring():
    """Measure the drop under the implicit spring, c = 80 N s/m, at a step of 64 ms."""
    scene, dt, k = contact.build_scene("drop"), 0.064, 1e4
    softness = 1.0 / (k * dt * dt + 80.0 * dt)
    spring = lambda depth: (softness, dt * k * depth * softness)  # noqa: E731
    run = contact.simulate(partial(implicit_step, dt=dt, spring=spring), scene, dt, 250, skip=True)
    return contact.contact_quality(run, scene, dt) | {"dt": dt}


def soft_heavy():
    """Measure soft where the upper one of two balls is a hundred times as heavy."""
    scene = contact.scene_of([0.0, 0.0], [0.1055, 0.3055], mass=[1.0, 100.0])
    return contact.contact_quality(contact.run_model("soft", scene, DT, 2000), scene, DT)


def sweeps():
    """Count sweeps until they converge, plain and accelerated, for towers at rest after one kick.

    Converged: the sweep corrects no velocity by more than a millionth of gravity's kick in a step.
    """
    values, enough = {}, -1e-6 * contact.GRAVITY * DT
    ways = {"plain": contact.solve_contacts, "momentum": contact.solve_accelerated}
    for (way, solve), count in product(ways.items(), (20, 40)):
        balls = contact.make_balls(contact.scene_of(0.0, 0.1 + 0.2 * np.arange(count)))
        contact.accelerate(balls, DT)
        contacts = contact.detect_contacts(balls, margin=1e-6)
        values[f"{way}_{count}"] = solve(contacts, contact.MAX_SWEEPS, enough)
    return values


def landing():
    """Measure lcp's landing in the drop: depth at touch and one step later [m]; speeds [m/s]: of
    the fall by its formula, upwards as its target asks, and upwards after that step."""
    scene = contact.build_scene("drop")
    run = contact.run_model("lcp", scene, DT, 400)
    gap = run.q[:, 1, 0] - contact.RADIUS
    k = int((gap < 0.0).argmax())
    return {
        "speed": math.sqrt(-2.0 * contact.GRAVITY * gap[0]),
        "depth": -gap[k],
        "asked": -gap[k] * contact.Settings().baumgarte / DT,
        "left": -gap[k + 1],
        "has": run.v[k + 1, 1, 0] + DT * contact.GRAVITY,
    }


def paper():
    """Compute errors by their formulas, at the default settings [r]; flicker [degrees]."""
    usual, dt = contact.Settings(), DT
    speed, depth = landing()["speed"], landing()["depth"]
    ball, step = (1.0, usual.stiffness, 80.0), (dt, usual.baumgarte)
    lengths = {
        "sink": predict.sink(*ball[:2]),
        "stack": predict.sink(*ball[:2], count=3),
        "undamped": speed * math.sqrt(ball[0] / ball[1]),
        "dive": predict.dive_of_penalty(speed, *ball),
        "late": predict.dive_of_lcp(speed, dt),
        "hop": predict.hop(depth, *step),
        "full_hop": predict.hop(depth, dt, 1.0),
        "sag_30": predict.sag(29.0, 1.0, *step, usual.iters),
    }
    angle = math.degrees(predict.flicker(predict.START, contact.SOLIMP[0]))
    return {"flicker": angle} | {name: each / contact.RADIUS for name, each in lengths.items()}


def landings():
    """Measure penalty's landings by step [s]: the largest ratio of the speeds after and before, of
    forty starts, so that the ball lands anywhere in a step."""
    values = {}
    for dt in (0.01, 0.011, 0.0125):
        shares = []
        for y in np.linspace(0.98, 1.02, 40):
            run = contact.run_model("penalty", contact.scene_of(0.0, y), dt, round(1.0 / dt))
            gap, v = run.q[:, 1, 0] - contact.RADIUS, run.v[:, 1, 0]
            lands = int((gap < 0.0).argmax())
            leaves = lands + int((gap[lands:] > 0.0).argmax())
            shares.append(v[leaves] / -v[lands] if leaves > lands else 0.0)
        values[f"{dt}"] = max(shares)
    return values


def jaws():
    """Measure a ball that overlaps two fixed jaws: lcp's largest impulse [N s] by sweeps and its
    speed after them [m/s]; the same of soft."""

    def held():
        x, mass = (-0.15, 0.0, 0.15), (math.inf, 1.0, math.inf)
        balls = contact.make_balls(contact.scene_of(x, 1.0, mass))
        return balls[1], [c for c in contact.detect_contacts(balls) if c.m_eff > 0.0]

    values = {}
    for sweeps in (1, 20, 2000):
        ball, contacts = held()
        for c in contacts:
            c.target = contact.contact_target(c, 0.0, contact.Settings().baumgarte, DT)
        contact.solve_contacts(contacts, sweeps)
        values |= {f"lam_{sweeps}": max(c.lam for c in contacts), "leaves": abs(ball.vx)}
    ball, contacts = held()
    for c in contacts:
        contact.soften(c, DT, *contact.soft_defaults(0.0, DT))
    contact.solve_contacts(contacts, contact.MAX_SWEEPS)
    return values | {"soft": contacts[0].lam, "soft_leaves": abs(ball.vx)}


def row():
    """Measure velocities [m/s] after a ball hits a row of two at 1 m/s, e = 1, by exact: where the
    two touch, and where they are a micrometre apart."""
    values = {}
    for name, apart in (("touching", 0.0), ("apart", 1e-6)):
        start = {"vx": [1.0, 0.0, 0.0], "restitution": 1.0}
        scene = contact.scene_of([-0.25, 0.0, 0.2 + apart], 5.0, **start)
        run = contact.run_model("exact", scene, DT, 60)
        values[name] = [round(vx, 9) + 0.0 for vx in run.v[-1, 0]]
    return values


def flicker():
    """Measure angles [degrees] of a ball that slides off a hill of 20 m, or of 1 m: its start; the
    first without soft's force, also with d0 = 1e-4; and where it leaves the hill."""
    first = partial(predict.first_without_force, DT, predict.START)
    angles = {
        "start": predict.START,
        "small": first(hill=1.0),
        "first": first(),
        "cured": first(solimp=(1e-4, *contact.SOLIMP[1:])),
        "leaves": math.acos(2.0 / 3.0 * math.cos(predict.START)),
    }
    return {name: math.degrees(angle) for name, angle in angles.items()}


def jump():
    """Measure what soft adds to v_n = -1 m/s in a step, a picometre before the touch and after."""
    values = {}
    for when, gap in (("before", 1e-12), ("after", -1e-12)):
        scene = contact.scene_of(0.0, contact.RADIUS + gap, vy=-1.0)
        values[when] = contact.run_model("soft", scene, DT, 1).v[1, 1, 0] + 1.0
    return values


def friction():
    """Compute the impulses [N s] of Coulomb's law at the contact of a rod that slides on the floor.

    A rod of 1 kg and 2 m, its lower end ahead, mu = 2 (Painleve's paradox). Without contact the end
    would rise at 0.4 m/s and slide at 4 m/s. Three solutions: no impulse; sliding, with friction mu
    times as large; sticking, with the friction impulse `rub`.
    """
    x, y = math.sqrt(0.2), -math.sqrt(0.8)  # the end, seen from the middle [m]
    W = np.eye(2) + 3.0 * np.array([[x * x, -x * y], [-x * y, y * y]])  # inertia 1/3 kg m^2
    rises, ahead = 0.4, 4.0
    jams, back = np.linalg.solve(W, [-rises, -ahead])
    takes = 2.0 * W[0, 1] - W[0, 0]  # m/s that the end loses upwards for each N s, as it rubs
    found = {"slides": rises / takes, "jams": jams, "rub": -back}
    return {"rises": rises, "ahead": ahead} | found


def _on_a_ball():
    """Return the scene of a ball that slides off a fixed one, from 20 degrees beside its top."""
    lean = math.radians(20.0)
    x, y = [0.0, 0.2 * math.sin(lean)], [1.0, 1.0 + 0.2 * math.cos(lean)]
    return contact.scene_of(x, y, mass=[math.inf, 1.0])


def _off(run, scene, dt):
    """Return the largest position error [r] of the last ball, compared with exact."""
    right = contact.run_model("exact", scene, dt, len(run.t) - 1)
    return float(np.hypot(*(run.q - right.q)[:, :, -1].T).max()) / contact.RADIUS


def slide():
    """Measure that ball's error [r] over 0.48 s, by model and step [s]; and by exact, the cosine of
    the angle at which it leaves the fixed ball, over that at the start.

    It leaves where v^2 = g 2 r cos, and keeps its vx = v cos: so cos^3 = vx^2 / (g 2 r).
    """
    scene = _on_a_ball()
    vx = contact.run_model("exact", scene, 0.01, 60).v[-1, 0, 1]
    leaves = (vx * vx / (-contact.GRAVITY * 0.2)) ** (1 / 3)
    values = {"leaves": float(leaves / math.cos(math.radians(20.0)))}
    for model, dt in product(("lcp", "leapfrog"), (0.002, 0.001)):
        run = contact.run_model(model, scene, dt, round(0.48 / dt))
        values[f"{model}.{dt}"] = _off(run, scene, dt)
    return values


LEFT_OUT = {  # part of core_step: {its code: the code in its place}
    "whole": {},
    "kick": {
        "0.5 * dt)\n    contact.solve": "dt)\n    contact.solve",
        "    contact.accelerate(balls, 0.5 * dt)\n": "",
    },
    "lam": {"turn(c)\n": "turn(c)\n        c.lam = 0.0\n"},
    "normals": {"turn(c)": "pass"},
    "all": {"[c for c in contacts if c.lam > 0.0]": "contacts"},
    "margin": {"contact.detection_distance(balls, dt)": "contact.CONTACT_MARGIN"},
}


def core():
    """Measure leapfrog's core without one of its parts [r].

    drop, slide: the largest error; inside: the rebound of a ball that starts 0.3 r deep.
    """
    values, drop, slides = {}, contact.build_scene("drop"), _on_a_ball()
    for name, changes in LEFT_OUT.items():
        source = inspect.getsource(core_step)
        for old, new in changes.items():
            source = replace_once(source, old, new, "curriculum/variants.py, core_step")
        exec(source, made := {"contact": contact, "turn": turn})
        run = partial(contact.simulate, partial(made["core_step"], dt=DT, iters=20), dt=DT)
        values[name] = {
            "drop": _off(run(drop, steps=2000), drop, DT),
            "slide": _off(run(slides, steps=240), slides, DT),
            "inside": float(run(contact.scene_of(0.0, 0.07), steps=500).q[:, 1].max()) / 0.1 - 1.0,
        }
    return values


ALL = implicit_spring, soft_heavy, sweeps, landing, paper, landings, jaws, row, flicker, jump
FACTS = {each.__name__: each for each in (*ALL, friction, slide, core)}
