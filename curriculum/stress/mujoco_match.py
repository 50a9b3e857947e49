"""soft against the real engine: how far contact.py and MuJoCo are apart.

The benchmark's MuJoCo, whose balls slide and do not turn. By default its solver stops early, up to
7e-4 m from its own answer; here its tolerance is 0.
"""

from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import engines

OPTIONS = 'tolerance="0" iterations="1000" ls_iterations="200"'
SPRINGS = (-5000.0, -100.0), (0.05, 0.5)
CURVES = (0.0, 0.95, 0.001, 0.5, 2.0), (0.9, 0.95, 0.0, 0.5, 2.0), (0.2, 0.9, 0.005, 0.4, 2.5)
STRIDE = 20  # every 20th state is stepped from


class Case(NamedTuple):
    """A run to be made by both."""

    what: str
    scene: contact.Scene
    dt: float
    steps: int = 2000
    settings: contact.Settings = contact.Settings()


def cases():
    """Yield the cases: every kind of scene, step, mass and setting.

    Balls that start exactly in touch are left out: they fall as one, the last bit of a gap decides
    whether there is a contact, and with d0 > 0 a contact begins with a jump of its force.
    """
    drop, bounce, stack = map(contact.build_scene, ("drop", "bounce", "stack"))
    stack.q0[1] += 0.005 * np.arange(3)  # m between the balls
    for dt in (0.0005, 0.002, 0.008, 0.016):
        yield Case("drop", drop, dt)
        yield Case("bounce, direct solref", bounce, dt)
        yield Case("stack of 3, 5 mm apart", stack, dt)
        yield Case("pile of 8", contact.build_scene("pile", bodies=8), dt, 300)
    for mass, steps in (((10.0, 1.0, 0.1), 2000), ((0.1, 1.0, 10.0), 300)):
        yield Case(f"stack of {mass} kg", stack._replace(mass=np.array(mass)), 0.002, steps)
    for name, value in [("solref", s) for s in SPRINGS] + [("solimp", c) for c in CURVES]:
        yield Case(f"{name} {value}", stack, 0.002, 2000, contact.Settings(**{name: value}))


def match_jobs(quick):
    """Yield a job for every case, --quick for every fourth; none without MuJoCo."""
    for case in list(cases())[:: 4 if quick else 1] if not engines.missing("mujoco") else ():
        yield f"{case.what}, dt {case.dt:g}", case, [soft_is_mujoco]


def soft_is_mujoco(case):
    """soft: a step from MuJoCo's state ends where its own does, within 1e-14 m and 1e-12 m/s; a
    whole run stays within 1e-11 m.
    """
    scene, dt, steps, settings = case[1:]
    knobs = contact.soft_defaults(scene.restitution, dt, settings.solref, settings.solimp)
    texts = [" ".join(map(repr, values)) for values in knobs]
    q, v = engines.Mujoco(scene, dt, texts, xml=OPTIONS).states(steps)
    for k in range(0, steps, STRIDE):
        balls = contact.make_balls(scene._replace(q0=q[k], v0=v[k]))
        contact.soft_step(balls, dt, *knobs)
        ends = np.array([(ball.x, ball.y, ball.vx, ball.vy) for ball in balls]).T
        yield f"[m], step {k}", np.abs(ends[:2] - q[k + 1]), 1e-14
        yield f"[m/s], step {k}", np.abs(ends[2:] - v[k + 1]), 1e-12
    run = contact.run_model("soft", scene, dt, steps, settings)
    yield "[m], run", np.abs(run.q - q), 1e-11
