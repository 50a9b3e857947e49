"""Facts that the chapter quotes and no run of contact.py prints: each a function, no arguments.

Each returns {name: number}; the text quotes one as {{fact:tower_sweeps.20}}.
"""

import itertools
import math

import numpy as np

import contact
from curriculum.implicit import implicit_step

DT = 0.002


def implicit_spring():
    """The quality of the drop under the implicit spring, c = 80, by stiffness and step."""
    values, scene = {"10000": {}, "1e+06": {}}, contact.build_scene("drop")
    for stiffness, dt in itertools.product(values, (0.002, 0.004, 0.008, 0.016, 0.032, 0.064)):
        k = float(stiffness)
        softness = 1.0 / (k * dt * dt + 80.0 * dt)

        def step(balls, k=k, dt=dt, softness=softness):
            implicit_step(balls, dt, lambda depth: (softness, dt * k * depth * softness))

        run = contact.simulate(step, scene, dt, int(16.0 / dt), skip=True)
        values[stiffness][f"{dt:g}"] = contact.contact_quality(run, scene, dt)
    return values


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
    """Sweeps until a step of soft's stack of three at rest settles, from nothing and warm."""
    scene, values = contact.build_scene("stack"), {}
    run = contact.run_model("soft", scene, DT, 1000)
    solref, solimp = contact.soft_defaults(0.0, DT)
    for name, share in (("cold", 0.0), ("warm", 1.0)):
        balls = contact.make_balls(scene._replace(q0=run.q[-1], v0=run.v[-1]))
        contact.soft_step(balls, DT, solref, solimp)  # whose impulses are kept
        contacts = contact.detect_contacts(balls, margin=0.0)
        for c in contacts:
            contact.soften(c, DT, solref, solimp)
        contact.accelerate(balls, DT)
        contact.warm_start(contacts, share)
        enough = contact.LAST_BITS * -contact.GRAVITY * DT
        values[name] = contact.solve_contacts(contacts, contact.MOST_SWEEPS, enough)
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


def xpbd():
    """By how much [m] heights of XPBD, found in positions, differ from one sweep for depth / dt."""
    scene, dt, steps = contact.build_scene("stack", bodies=10), DT / 20, 5_000

    def step(balls):
        contacts = contact.detect_contacts(balls, margin=contact.RADIUS)
        for c in contacts:
            c.target = c.depth / dt
        contact.accelerate(balls, dt)
        contact.solve_contacts(contacts, 1)
        contact.move(balls, dt)

    run = contact.simulate(step, scene, dt, steps, skip=True)
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
    scene = contact.scene_of([0.0, 0.0], [0.1055, 0.3055], mass=[1.0, 100.0])
    return contact.contact_quality(contact.run_model("soft", scene, DT, 2000), scene, DT)


def crowd():
    """Three balls in a row, e = 1, speeds -1, 0, -3 m/s: what they leave with, by the target."""
    values = {}
    for name, least in (("moreau", -math.inf), ("zero", 0.0)):
        balls = [contact.Ball(0.2 * k, 1.0, v, 0.0, 1.0, 0.1) for k, v in enumerate((-1, 0, -3))]
        contacts = [contact.Contact(balls[k + 1], balls[k], 1.0, 0.0, 0.0) for k in (0, 1)]
        for c in contacts:
            c.target = max(least, -c.v_n())
        contact.solve_contacts(contacts, 200)
        values[name] = {"energy": sum(0.5 * ball.vx**2 for ball in balls)} | {
            str(k): ball.vx for k, ball in enumerate(balls)
        }
    return values


def slide():
    """cos of the angle at which a ball leaves a fixed one, over cos at the start, by model."""
    values, start, dt = {}, math.radians(20.0), 1e-4
    x, y = 0.2 * math.sin(start), 0.2 * math.cos(start)
    scene = contact.scene_of([0.0, x], [1.0, 1.0 + y], mass=[math.inf, 1.0])
    for model in ("penalty", "exact"):
        run = contact.run_model(model, scene, dt, 7000)
        gained = np.diff(run.v[:, :, 1], axis=0) - [0.0, dt * contact.GRAVITY]
        last = np.flatnonzero((np.hypot(*gained.T) > 1e-9) & (run.q[:-1, 1, 1] > 0.5))[-1]
        away = run.q[last, :, 1] - run.q[last, :, 0]
        values[model] = float(away[1] / np.hypot(*away) / math.cos(start))
    return values


def blocks():
    """How often exact changes the light block's speed, between a wall and one 100^n times as heavy.

    Samples are 0.02 ms apart, so that no two impacts fall between them.
    """
    values = {}
    for n in (0, 1, 2):
        x, vx, mass = [0.0, 1.0, 2.0], [0.0, 0.0, -1.0], [math.inf, 1.0, 100.0**n]
        scene = contact.scene_of(x, [0.1] * 3, mass, vx=vx, restitution=1.0)
        run = contact.run_model("exact", scene, 2e-5, 350_000)
        values[f"exact_{100**n}"] = int((np.abs(np.diff(run.v[:, 0, 1])) > 1e-9).sum())
    return values


FACTS = {
    each.__name__: each
    for each in (implicit_spring, tower_sweeps, ratio_sweeps, soft_sweeps, jump, xpbd)
    + (soft_heavy, crowd, slide, blocks)
}
