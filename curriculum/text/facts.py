"""Facts that the chapter quotes and no run of contact.py prints: each a function, no arguments.

Each returns {name: number}; the text quotes one as {{fact:tower_sweeps.20}}.
"""

import itertools
import math
import statistics
from functools import partial
from unittest.mock import patch

import numpy as np

import contact
from curriculum.implicit import implicit_step

DT = 0.002


def _quality(model, scene, dt=DT, steps=2000, exact=None, **knobs):
    """The quality of a run with these Settings."""
    run = contact.run_model(model, scene, dt, steps, contact.Settings(**knobs))
    return contact.contact_quality(run, scene, dt, exact)


def implicit_spring():
    """The quality of the drop under the implicit spring, c = 80, by stiffness and step."""
    found, scene = {"10000": {}, "1e+06": {}}, contact.build_scene("drop")
    for stiffness, dt in itertools.product(found, (0.002, 0.004, 0.008, 0.016, 0.032, 0.064)):
        k = float(stiffness)
        softness = 1.0 / (k * dt * dt + 80.0 * dt)

        def step(balls, k=k, dt=dt, softness=softness):
            implicit_step(balls, dt, lambda depth: (softness, dt * k * depth * softness))

        run = contact.simulate(step, scene, dt, int(16.0 / dt), skip=True)
        found[stiffness][f"{dt:g}"] = contact.contact_quality(run, scene, dt)
    return found


def _sweeps(masses):
    """How many sweeps bring a column at rest to a millionth of what gravity adds in a step."""
    balls = [contact.Ball(0.0, 0.1 + 0.2 * k, 0.0, 0.0, m, 0.1) for k, m in enumerate(masses)]
    contacts = contact.detect_contacts(balls, margin=1e-6)
    contact.accelerate(balls, DT)
    count, enough = 0, -1e-6 * contact.GRAVITY * DT
    while max(abs(c.v_n()) for c in contacts) > enough:
        contact.solve_contacts(contacts, 1)
        count += 1
    return count


def tower_sweeps():
    """Sweeps to a millionth, by the height of a tower of equal balls."""
    return {str(count): _sweeps([1.0] * count) for count in (2, 5, 10, 20, 40)}


def ratio_sweeps():
    """Sweeps to a millionth of two balls, by how much heavier the upper one is."""
    return {str(ratio): _sweeps([1.0, ratio]) for ratio in (1, 10, 100, 1000)}


def soft_sweeps():
    """Sweeps a step until soft's stack of three settles, from nothing and from the step before."""
    scene, solve, found = contact.build_scene("stack"), contact.solve_contacts, {}
    for name, start in (("cold", lambda contacts: None), ("warm", contact.warm_start)):
        sweeps = []

        def counted(contacts, iters, tolerance, sweeps=sweeps):
            count = 1
            while not solve(contacts, 1, tolerance):
                count += 1
            sweeps.append(count)

        with patch.multiple(contact, warm_start=start, solve_contacts=counted):
            contact.run_model("soft", scene, DT, 1000, contact.Settings(skip=False))
        found[name] = sum(sweeps) / len(sweeps)
    return found


def no_margin():
    """The quality of lcp's stack where detect_contacts has no margin."""
    scene, touching = contact.build_scene("stack"), partial(contact.detect_contacts, margin=0.0)
    exact = contact.run_model("exact", scene, DT, 2000)
    with patch.object(contact, "detect_contacts", touching):
        return _quality("lcp", scene, exact=exact, skip=False)


def order():
    """The largest difference of velocities [m/s] if contacts are taken backwards, by sweeps."""
    scene, found = contact.build_scene("pile", bodies=8), {}
    start = contact.run_model("lcp", scene, DT, 400)
    scene = scene._replace(q0=start.q[-1], v0=start.v[-1])
    detect = contact.detect_contacts

    def backwards(balls):
        return detect(balls)[::-1]

    for sweeps in (20, 20_000):
        ends = []
        for seen in (detect, backwards):
            balls = contact.make_balls(scene)
            with patch.object(contact, "detect_contacts", seen):
                contact.lcp_step(balls, DT, 0.0, 0.2, sweeps)
            ends.append(np.array(contact.state_of(balls)).reshape(-1, 4)[:, 2:])
        found[str(sweeps)] = float(np.abs(ends[0] - ends[1]).max())
    return found


def air_push():
    """What lcp does to a ball 0.9 mm above the table at -0.3 m/s, without and with a bounce."""
    found = {}
    for name, e in (("e0", 0.0), ("e1e-9", 1e-9)):
        scene = contact.scene_of([0.0], [0.1009], vy=[-0.3], restitution=e)
        run = contact.run_model("lcp", scene, DT, 200)
        found[f"{name}_speed"] = float(run.v[1, 1, 0])
        found[f"{name}_steps"] = int((run.q[:, 1, 0] - 0.1 < 1e-6).argmax())
    return found


def jump():
    """What soft adds to v_n = -1 m/s in one step, a picometre before the touch and after it."""
    found = {}
    solref, solimp = contact.soft_defaults(0.0, DT)
    for name, height in (("before", 0.1 + 1e-12), ("after", 0.1 - 1e-12)):
        ball = contact.Ball(0.0, height, 0.0, -1.0, 1.0, 0.1)
        contact.soft_step([ball], DT, solref, solimp)
        found[name] = ball.vy + 1.0
    return found


def seeds():
    """What lcp does to the drop from forty start heights; `hover`: how often without a gain."""
    scenes = [contact.build_scene("drop", seed) for seed in range(40)]
    with_gain = [_quality("lcp", scene) for scene in scenes]
    without = [_quality("lcp", scene, baumgarte=0.0) for scene in scenes]
    depths = [quality["max_penetration_frac"] for quality in with_gain]
    return {
        "depth": {"least": min(depths), "most": max(depths), "none": depths.count(0.0)},
        "hop": statistics.median(quality["rebound_frac"] for quality in with_gain),
        "hover": sum(quality["rest_gap_frac"] > 0.0 for quality in without),
    }


def sag():
    """The quality of lcp's stacks whose sweeps are not done, and the overlap [r] by the law."""
    cases = {"ten": (10, 1e-4, 1, 1.0, 0.0), "thirty": (30, DT, 20, 0.2, 0.0)}
    for name, bodies in (("three", 3), ("twenty", 20)):
        cases[name] = (bodies, DT, 20, 0.2, 0.0)
        cases[f"{name}_substeps"] = (bodies, DT / 4, 5, 0.2, 0.0)
    cases |= {f"warm_{warm:g}": (10, 1e-3, 1, 1.0, warm) for warm in (0.5, 0.75)}
    found = {}
    for name, (bodies, dt, iters, gain, warm) in cases.items():
        scene, knobs = contact.build_scene("stack", bodies=bodies), {"iters": iters, "warm": warm}
        found[name] = _quality("lcp", scene, dt, int(2.0 / dt), baumgarte=gain, **knobs)
        law = (warm - 1.0) * (bodies - 1) * contact.GRAVITY * dt * dt / gain / iters
        found[name]["law"] = law / contact.RADIUS
    return found


def ahead():
    """The quality of lcp as it is, looking ahead, and looking ahead with a gain of 1."""
    scenes = {"drop": contact.build_scene("drop")}
    scenes |= {str(n): contact.build_scene("stack", bodies=n) for n in (10, 30)}
    scenes["heavy"] = contact.scene_of([0.0, 0.0], [0.1055, 0.3055], mass=[1.0, 100.0])
    ways = {"lcp": {}, "ahead": {"ahead": True}, "gain_1": {"ahead": True, "baumgarte": 1.0}}
    found = {}
    for name, scene in scenes.items():
        exact = contact.run_model("exact", scene, DT, 1000)
        found[name] = {
            way: _quality("lcp", scene, DT, 1000, exact, **knobs) for way, knobs in ways.items()
        }
    return found


def xpbd():
    """By how much [m] heights of XPBD, found in positions, differ from lcp's with one sweep."""
    scene, dt, steps = contact.build_scene("stack", bodies=10), DT / 20, 5_000
    knobs = contact.Settings(ahead=True, iters=1, baumgarte=1.0)
    run = contact.run_model("lcp", scene, dt, steps, knobs)
    y, v, r, worst = scene.q0[1].copy(), np.zeros(10), contact.RADIUS, 0.0
    for k in range(steps):  # predict, push apart what overlaps, take the velocities from the places
        before, y = y, y + dt * (v + dt * contact.GRAVITY)
        y[0] = max(y[0], r)
        for low, high in zip(range(9), range(1, 10)):
            half = 0.5 * max(0.0, 2.0 * r - (y[high] - y[low]))
            y[low], y[high] = y[low] - half, y[high] + half
        v = (y - before) / dt
        worst = max(worst, float(np.abs(run.q[k + 1, 1] - y).max()))
    return {"difference": worst}


def soft_heavy():
    """The quality of soft where the upper one of two balls is a hundred times as heavy."""
    return _quality("soft", contact.scene_of([0.0, 0.0], [0.1055, 0.3055], mass=[1.0, 100.0]))


def crowd():
    """Three balls in a row, e = 1, speeds -1, 0, -3 m/s: what they leave with, by the target."""
    found = {}
    for name, least in (("moreau", -math.inf), ("zero", 0.0)):
        balls = [contact.Ball(0.2 * k, 1.0, v, 0.0, 1.0, 0.1) for k, v in enumerate((-1, 0, -3))]
        contacts = [contact.Contact(balls[k + 1], balls[k], 1.0, 0.0, 0.0) for k in (0, 1)]
        for c in contacts:
            c.target = max(least, -c.v_n())
        contact.solve_contacts(contacts, 200)
        found[name] = {"energy": sum(0.5 * ball.vx**2 for ball in balls)} | {
            str(k): ball.vx for k, ball in enumerate(balls)
        }
    return found


def slide():
    """cos of the angle at which a ball leaves a fixed one, over cos at the start, by model."""
    found, start, dt = {}, math.radians(20.0), 1e-4
    x, y = 0.2 * math.sin(start), 0.2 * math.cos(start)
    scene = contact.scene_of([0.0, x], [1.0, 1.0 + y], mass=[math.inf, 1.0])
    for model in ("penalty", "exact"):
        run = contact.run_model(model, scene, dt, 7000)
        gained = np.diff(run.v[:, :, 1], axis=0) - [0.0, dt * contact.GRAVITY]
        last = np.flatnonzero((np.hypot(*gained.T) > 1e-9) & (run.q[:-1, 1, 1] > 0.5))[-1]
        away = run.q[last, :, 1] - run.q[last, :, 0]
        found[model] = float(away[1] / np.hypot(*away) / math.cos(start))
    return found


def blocks():
    """How often exact changes the light block's speed, between a wall and one 100^n times as heavy.

    Samples are 0.02 ms apart, so that no two impacts fall between them.
    """
    found = {}
    for n in (0, 1, 2):
        x, vx, mass = [0.0, 1.0, 2.0], [0.0, 0.0, -1.0], [math.inf, 1.0, 100.0**n]
        scene = contact.scene_of(x, [0.1] * 3, mass, vx=vx, restitution=1.0)
        run = contact.run_model("exact", scene, 2e-5, 350_000)
        found[f"exact_{100**n}"] = int((np.abs(np.diff(run.v[:, 0, 1])) > 1e-9).sum())
    return found


FACTS = {
    each.__name__: each
    for each in (implicit_spring, tower_sweeps, ratio_sweeps, soft_sweeps, no_margin, order)
    + (air_push, jump, seeds, sag, ahead, xpbd, soft_heavy, crowd, slide, blocks)
}
