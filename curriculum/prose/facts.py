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


def paper():
    """Compute errors by their formulas, at the default settings [r]; flicker [degrees]; and the
    speed that lcp's target asks for at the depth where the drop lands [m/s]."""
    usual, drop = contact.Settings(), contact.build_scene("drop")
    speed = math.sqrt(-2.0 * contact.GRAVITY * (drop.q0[1, 0] - contact.RADIUS))
    depth = predict.quality("lcp", drop, DT, 4.0)["max_penetration_frac"] * contact.RADIUS
    ball, step = (1.0, usual.stiffness, 80.0), (DT, usual.baumgarte)
    lengths = {
        "sink": predict.sink(*ball[:2]),
        "stack": predict.sink(3.0 * ball[0], ball[1]),
        "undamped": speed * math.sqrt(ball[0] / ball[1]),
        "dive": predict.dive_of_penalty(speed, *ball),
        "late": predict.dive_of_lcp(speed, DT),
        "hop": predict.hop(depth, *step),
        "full_hop": predict.hop(depth, DT, 1.0),
        "sag_30": predict.sag(29.0, 1.0, *step, usual.iters),
    }
    angle = math.degrees(predict.flicker(predict.START, contact.SOLIMP[0]))
    others = {"flicker": angle, "asked": usual.baumgarte * depth / DT}
    return others | {name: each / contact.RADIUS for name, each in lengths.items()}


def jaws():
    """Measure one step of a ball that overlaps two fixed jaws: the largest impulse [N s] and the
    ball's speed after it [m/s], of lcp by its sweeps and of soft."""
    values, scene = {}, contact.scene_of((-0.15, 0.0, 0.15), 1.0, (math.inf, 1.0, math.inf))
    for name, sweeps in (("lcp", 1), ("lcp", 20), ("lcp", 2000), ("soft", 20)):
        step = contact.step_of(name, scene, DT, contact.Settings(iters=sweeps))
        balls = contact.make_balls(scene)
        values[f"{name}_{sweeps}"] = max(c.lam for c in step(balls))
        values[f"{name}_leaves"] = abs(balls[1].vx)
    return values


def flicker():
    """Measure the angles [degrees] at which a ball that slides off a hill starts, and at which
    soft's force is first absent."""
    angles = predict.START, predict.first_without_force(DT, predict.START)
    return dict(zip(("start", "first"), map(math.degrees, angles)))


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
    """Measure that ball's error [r] over 0.48 s, by model and step [s]."""
    scene, values = _on_a_ball(), {}
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


ALL = implicit_spring, soft_heavy, sweeps, paper, jaws, flicker, friction, slide, core
FACTS = {each.__name__: each for each in ALL}
