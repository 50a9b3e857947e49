"""The problems: a scene for every start, how long it runs, and the right answer at any time."""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import closed_form

REFERENCE_DT = 0.002  # s, the step of contact.py's own default run
SUBSTEPS = (1, 4, 16)  # at that step; coarser ones are taken whole
COARSER = (0.004, 0.008, 0.016)  # s
R = contact.RADIUS


class Problem(NamedTuple):
    """A scene for each start, run for `duration` seconds, and its true motion."""

    name: str
    title: str
    duration: float  # s
    build: Callable  # start -> contact.Scene
    truth: Callable  # (scene, t) -> q, v, (len(t), 2, N)
    stresses: str  # what it is hard on, for the reader
    starts: int = 5  # the error of one is a lottery of where a step falls

    def steps(self, dt):
        return round(self.duration / dt)


def column(scene, t):
    """The motion of balls over one another, e = 0, or of one ball with any e."""
    height = scene.q0[1]
    gap, speed = closed_form.bounce_motion(float(height[0]) - R, scene.restitution, t)
    y = R * (2.0 * np.arange(len(height)) + 1.0) + gap[:, None]
    vy = np.repeat(speed[:, None], len(height), axis=1)
    return np.stack([0.0 * y, y], axis=1), np.stack([0.0 * y, vy], axis=1)


def slide_scene(start):
    """A ball at rest on a fixed one, off the top by an angle that the start chooses."""
    theta = 0.1 + 0.02 * start
    x, y = 2.0 * R * math.sin(theta), R + 2.0 * R * math.cos(theta)
    return contact.scene_of([0.0, x], [R, y], [math.inf, 1.0])


def slide(scene, t):
    """The motion of a ball off a fixed one."""
    x, y = scene.q0[:, 1]
    q, v = closed_form.slide_motion(math.atan2(x, y - R), 2.0 * R, R, R, t)
    held = np.broadcast_to(scene.q0[:, 0], q.shape)
    return np.stack([held, q], axis=2), np.stack([0.0 * v, v], axis=2)


def pile(scene, t):
    """The motion of a pile, by contact.py's own exact: no closed form is known."""
    return pile_at(scene.q0.tobytes(), len(scene.mass), len(t), float(t[1]))


@lru_cache(maxsize=16)
def pile_at(places, count, steps, dt):
    scene = contact.build_scene("pile", 0, count)
    scene = scene._replace(q0=np.frombuffer(places).reshape(2, count))
    run = contact.run_model("exact", scene, dt, steps - 1)
    return run.q, run.v


def heavy(ratio, start):
    """A ball of so many kg on a ball of one, a little above the floor."""
    return contact.build_scene("stack", start, 2)._replace(mass=np.array((1.0, ratio)))


def built(name, bodies=None, restitution=None):
    return partial(contact.build_scene, name, bodies=bodies, restitution=restitution)


# fmt: off
PROBLEMS = (
    Problem("drop", "Drop: one ball, no rebound, 4 s", 4.0, built("drop"), column,
            "a free fall, one impact that must stop the ball, then rest at no depth"),
    Problem("bounce", "Bounce: one ball, restitution 0.7, 4 s", 4.0, built("bounce"), column,
            "infinitely many impacts in 2.4 s: an error in any impact time shifts all that follow"),
    Problem("stack", "Stack: three balls, no rebound, 4 s", 4.0, built("stack"), column,
            "three contacts that share balls: the impact stops all at once, then nothing may sink"),
    Problem("slide", "Slide: a ball off a fixed ball, 0.7 s", 0.7, slide_scene, slide,
            "a contact that turns while it pushes, and must let go at cos = 2/3 of its start"),
    Problem("pile", "Pile: eight balls fall beside and over one another, 1 s", 1.0,
            built("pile", 8), pile,
            "impacts that decide where everything goes next: small errors grow", 3),
    Problem("elastic", "Elastic bounce: one ball, restitution 1, 20 s", 20.0,
            built("bounce", restitution=1.0), column,
            "two dozen impacts that may neither take nor give energy, and whose times add up", 3),
    Problem("heavy_100", "Heavy on light: 100 kg on 1 kg, no rebound, 2 s", 2.0,
            partial(heavy, 100.0), column,
            "a large impulse must go through a small ball: a sweep hands on little of it", 3),
    Problem("heavy_1000", "Heavy on light: 1,000 kg on 1 kg, no rebound, 2 s", 2.0,
            partial(heavy, 1000.0), column, "the same, ten times as hard", 3),
    Problem("tower", "Tower: twenty balls, no rebound, 2 s", 2.0, built("stack", 20), column,
            "twenty contacts in a row, each of which carries all that is above it", 3),
)
# fmt: on
BY_NAME = {problem.name: problem for problem in PROBLEMS}


@np.errstate(all="ignore")
def quality(problem, scene, run):
    """The errors of one run (a contact.Run) of a problem, as a flat dict of numbers.

    error, final_error: distance of a ball from where it should be, worst ball, in radii: over the
        whole run, and at its end
    energy_error: the worst error of the energy, in start energies; depth: the deepest overlap [r]
    diverged: None, or the step at which the energy exploded
    """
    q, v = problem.truth(scene, run.t)
    distance = np.sqrt(((run.q - q) ** 2).sum(axis=1)).max(axis=1) / R
    total = contact.energy(run.q, run.v, scene.mass)
    energy = np.abs(total - contact.energy(q, v, scene.mass)) / abs(total[0])
    gap = contact.smallest_gap(run.q, scene.radius)
    return dict(
        error=float(distance.max()),
        final_error=float(distance[-1]),
        energy_error=float(energy.max()),
        depth=float(np.maximum(-gap, 0.0).max() / R),
        diverged=contact.blow_up_step(total),
    )
