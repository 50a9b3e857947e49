"""Facts that the chapter quotes and no run of contact.py prints: each a function, no arguments.

Each returns {name: number}; the text quotes one as {{fact:jump.before}}.
"""

import inspect
import itertools
import math
from functools import partial

import numpy as np

import contact
from curriculum.core import core_step, turn
from curriculum.implicit import implicit_step

DT = 0.002


def implicit_spring():
    """The quality of the drop under the implicit spring, c = 80, at a step of 64 ms."""
    scene, dt, k = contact.build_scene("drop"), 0.064, 1e4
    softness = 1.0 / (k * dt * dt + 80.0 * dt)
    spring = lambda depth: (softness, dt * k * depth * softness)  # noqa: E731
    run = contact.simulate(partial(implicit_step, dt=dt, spring=spring), scene, dt, 250, skip=True)
    return contact.contact_quality(run, scene, dt)


def _tower(count):
    """The contacts of a tower at rest, after gravity has acted for a step."""
    balls = [contact.Ball(0.0, 0.1 + 0.2 * k, 0.0, 0.0, 1.0, 0.1) for k in range(count)]
    contact.accelerate(balls, DT)
    return contact.detect_contacts(balls, margin=1e-6)


def _fastest(solve, contacts, sweeps):
    """The fastest approach or parting [m/s] that so many sweeps leave."""
    solve(contacts, sweeps)
    return max(abs(c.v_n()) for c in contacts)


def sweeps():
    """Sweeps, plain and with momentum, to a millionth of what gravity added: of two towers."""
    values, enough, momentum = {}, -1e-6 * contact.GRAVITY * DT, contact.solve_with_momentum
    for balls in (20, 40):
        tower, counts = _tower(balls), itertools.count(1)
        plain = next(n for n in counts if _fastest(contact.solve_contacts, tower, 1) <= enough)
        counts = itertools.count(1)  # with momentum from the start each time: it has its own pace
        fewer = next(n for n in counts if _fastest(momentum, _tower(balls), n) <= enough)
        values[f"tower_{balls}"] = {"plain": plain, "momentum": fewer}
    return values


def landing():
    """lcp's landing in the drop: gap and depths [mm], and speeds [m/s] upwards."""
    run = contact.run_model("lcp", contact.build_scene("drop"), DT, 400)
    gap = 1000.0 * (run.q[:, 1, 0] - contact.RADIUS)
    k = int((gap < 0.0).argmax())
    share = contact.Settings().baumgarte / (1000.0 * DT)
    return {
        "gap": gap[k - 1],
        "depth": -gap[k],
        "asked": -gap[k] * share,
        "left": -gap[k + 1],
        "next": -gap[k + 1] * share,
        "has": run.v[k + 1, 1, 0] + DT * contact.GRAVITY,
    }


def _on_a_ball():
    """A ball that is about to slide off a fixed one, 20 degrees from its top."""
    lean = math.radians(20.0)
    x, y = [0.0, 0.2 * math.sin(lean)], [1.0, 1.0 + 0.2 * math.cos(lean)]
    return contact.scene_of(x, y, mass=[math.inf, 1.0])


def slide():
    """cos of the angle at which exact's ball leaves the fixed one, over cos at the start.

    It leaves where v^2 = g 2 r cos, and keeps its vx = v cos: so cos^3 = vx^2 / (g 2 r).
    """
    vx = contact.run_model("exact", _on_a_ball(), 0.01, 60).v[-1, 0, 1]
    leaves = (vx * vx / (-contact.GRAVITY * 0.2)) ** (1 / 3)
    return {"exact": float(leaves / math.cos(math.radians(20.0)))}


def _off(run, scene, dt):
    """How far [r] the last ball is from where exact has it, at worst."""
    right = contact.run_model("exact", scene, dt, len(run.t) - 1)
    return float(np.hypot(*(run.q - right.q)[:, :, -1].T).max()) / contact.RADIUS


def order():
    """The error of that ball over 0.48 s, by model and step [s]."""
    values, scene = {"lcp": {}, "leapfrog": {}}, _on_a_ball()
    for model, dt in itertools.product(values, (0.002, 0.001)):
        run = contact.run_model(model, scene, dt, round(0.48 / dt))
        values[model][f"{dt:g}"] = _off(run, scene, dt)
    return values


def friction():
    """What one rubbing contact of a rod may do in a step, and what is left of it in a convex law.

    A rod of 1 kg and 2 m, its lower end ahead, mu = 2. Without the contact the end would rise at
    0.4 m/s and slide at 4 m/s. Coulomb's law has three answers [N s along n and t]; in the convex
    law impulses are sums of the cone's edges, and the sweep finds the same one from each.
    """
    mu, x, y = 2.0, math.sqrt(0.2), -math.sqrt(0.8)  # the end, seen from the middle [m]
    W = np.eye(2) + 3.0 * np.array([[x * x, -x * y], [-x * y, y * y]])  # inertia 1/3 kg m^2
    free, edges = np.array([0.4, 4.0]), np.array([[1.0, 1.0], [mu, -mu]])
    slides = free[0] / (mu * W[0, 1] - W[0, 0]) * np.array([1.0, -mu])
    ways = {"leaves": np.zeros(2), "slides": slides, "sticks": np.linalg.solve(W, -free)}
    values, bowl = {}, edges.T @ W @ edges
    for name, lam in ways.items():
        v, pushes = free + W @ lam, np.linalg.solve(edges, lam)
        for k in [0, 1] * 200:  # projected Gauss-Seidel
            missing = -(edges.T @ free + bowl @ pushes)[k]
            pushes[k] = max(0.0, pushes[k] + missing / bowl[k, k])
        values[name] = {"push": lam[0], "rub": lam[1], "v_n": v[0], "v_t": v[1]}
        values[name]["convex"] = float((edges @ pushes)[0])
    values["half"] = {"push": slides[0] / 2.0, "v_n": float((free + W @ slides / 2.0)[0])}
    return values


def jump():
    """What soft adds to v_n = -1 m/s in one step, a picometre before the touch and after it."""
    values = {}
    solref, solimp = contact.soft_defaults(0.0, DT)
    for name, height in (("before", 0.1 + 1e-12), ("after", 0.1 - 1e-12)):
        ball = contact.Ball(0.0, height, 0.0, -1.0, 1.0, 0.1)
        contact.soft_step([ball], DT, solref, solimp)
        values[name] = ball.vy + 1.0
    return values


def soft_heavy():
    """The quality of soft where the upper one of two balls is a hundred times as heavy."""
    scene = contact.scene_of([0.0, 0.0], [0.1055, 0.3055], mass=[1.0, 100.0])
    return contact.contact_quality(contact.run_model("soft", scene, DT, 2000), scene, DT)


def blocks():
    """How often exact changes the light block's speed, between a wall and one 100^n times as heavy.

    Samples are 0.02 ms apart, so that no two impacts fall between them.
    """
    values = {}
    for n in (1, 2):
        x, vx, mass = [0.0, 1.0, 2.0], [0.0, 0.0, -1.0], [math.inf, 1.0, 100.0**n]
        scene = contact.scene_of(x, [0.1] * 3, mass, vx=vx, restitution=1.0)
        run = contact.run_model("exact", scene, 2e-5, 350_000)
        values[f"exact_{100**n}"] = int((np.abs(np.diff(run.v[:, 0, 1])) > 1e-9).sum())
    return values


def predict():
    """What a pencil says of the drop [r]: penalty's and lcp's deepest overlap, and lcp's hop."""
    scene, g = contact.build_scene("drop"), -contact.GRAVITY
    speed = math.sqrt(2.0 * g * (float(scene.q0[1, 0]) - contact.RADIUS))
    depth, beta = landing()["depth"] / 1000.0, contact.Settings().baumgarte
    leaves = beta * depth / DT
    return {
        "dive_penalty": speed * math.sqrt(1.0 / contact.Settings().stiffness) / contact.RADIUS,
        "dive_lcp": (speed * DT - contact.CONTACT_MARGIN) / contact.RADIUS,
        "hop": (leaves**2 / (2.0 * g) - (depth - leaves * DT)) / contact.RADIUS,
        "hop_full": (depth / DT) ** 2 / (2.0 * g) / contact.RADIUS,
    }


LEFT_OUT = {  # what of core_step: {what stands there: what then stands there instead}
    "whole": {},
    "kick": {
        "0.5 * dt)\n    contact.solve": "dt)\n    contact.solve",
        "    contact.accelerate(balls, 0.5 * dt)\n": "",
    },
    "lam": {"turn(c)\n": "turn(c)\n        c.lam = 0.0\n"},
    "normals": {"turn(c)": "pass"},
    "all": {"[c for c in contacts if c.lam > 0.0]": "contacts"},
    "margin": {"contact.step_reach(balls, dt)": "contact.CONTACT_MARGIN"},
}


def core():
    """What leapfrog's core is worth without one of its lines [r].

    drop, slide: the worst error; inside: how high a ball flies that starts 0.3 r in the table.
    """
    values, drop, slides = {}, contact.build_scene("drop"), _on_a_ball()
    for name, changes in LEFT_OUT.items():
        source = inspect.getsource(core_step)
        for old, new in changes.items():
            source = source.replace(old, new)
        exec(source, made := {"contact": contact, "turn": turn})
        run = partial(contact.simulate, partial(made["core_step"], dt=DT, iters=20), dt=DT)
        values[name] = {
            "drop": _off(run(drop, steps=2000), drop, DT),
            "slide": _off(run(slides, steps=240), slides, DT),
            "inside": float(run(contact.scene_of(0.0, 0.07), steps=500).q[:, 1].max()) / 0.1 - 1.0,
        }
    return values


FACTS = {
    each.__name__: each
    for each in (implicit_spring, sweeps, landing, jump, soft_heavy, predict, core)
    + (slide, order, friction, blocks)
}
