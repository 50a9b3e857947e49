"""The problems: a scene, how long, what it is hard on, and the right answer at any time."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import closed_form

DTS = (0.0005, 0.001, 0.002, 0.004, 0.008, 0.016)  # s
SEEDS = tuple(range(9))  # nine starts: the error of one is a lottery of where a step falls
REFERENCE_DT = 0.002  # s, the step of contact.py's own default run
R = contact.RADIUS


class Problem(NamedTuple):
    """A scene for each seed, run for `duration` seconds, and its true motion."""

    name: str
    title: str
    stresses: str  # what it is hard on, for the reader
    duration: float
    build: Callable  # seed -> contact.Scene
    truth: Callable  # (scene, t) -> q, v, shape (len(t), 2, N)
    dts: tuple = DTS
    seeds: tuple = SEEDS

    def steps(self, dt):
        return round(self.duration / dt)


def column(scene, t):
    """The motion of balls over one another, e = 0, or of one ball with any e."""
    height = scene.q0[1]
    gap, speed = closed_form.bounce_motion(float(height[0]) - R, scene.restitution, t)
    y = R * (2.0 * np.arange(len(height)) + 1.0) + gap[:, None]
    vy = np.repeat(speed[:, None], len(height), axis=1)
    return np.stack([0.0 * y, y], axis=1), np.stack([0.0 * y, vy], axis=1)


def slide_scene(seed):
    """A ball at rest on a fixed one, off the top by an angle that the seed chooses."""
    theta = slide_angle(seed)
    x, y = [0.0, 2.0 * R * math.sin(theta)], [R, R + 2.0 * R * math.cos(theta)]
    return contact.Scene(
        f"slide {seed}",
        np.array([x, y]),
        np.zeros((2, 2)),
        np.array([math.inf, 1.0]),
        np.full(2, R),
        0.0,
        80.0,
    )


def slide_angle(seed):
    return 0.1 + 0.02 * seed


def slide_truth(scene, t):
    moving, speed = slid(int(scene.name.split()[1]), t.tobytes())
    held = np.broadcast_to(scene.q0[:, 0], moving.shape)
    return np.stack([held, moving], axis=2), np.stack([0.0 * speed, speed], axis=2)


@lru_cache(maxsize=128)
def slid(seed, times):
    """The closed form at some times, as bytes: many contestants are held to the same."""
    return closed_form.slide_motion(slide_angle(seed), 2.0 * R, R, R, np.frombuffer(times))


def pyramid_scene(seed):
    """Two balls on the floor and one on both, at 60 degrees less what the seed takes off."""
    theta = pyramid_angle(seed)
    side, top = 2.0 * R * math.cos(theta), R + 2.0 * R * math.sin(theta)
    return contact.Scene(
        f"pyramid {seed}",
        np.array([[-side, side, 0.0], [R, R, top]]),
        np.zeros((2, 3)),
        np.ones(3),
        np.full(3, R),
        0.0,
        80.0,
    )


def pyramid_angle(seed):
    return math.radians(60.0 - seed)


def pyramid_truth(scene, t):
    return fallen(int(scene.name.split()[1]), t.tobytes())


@lru_cache(maxsize=128)
def fallen(seed, times):
    """The closed form at some times, as bytes."""
    return closed_form.pyramid_motion(pyramid_angle(seed), 2.0 * R, R, np.frombuffer(times))


def scene_of(name, bodies=None, restitution=None):
    return lambda seed: contact.build_scene(name, seed, bodies, restitution)


PROBLEMS = (
    Problem(
        "drop",
        "Drop: one ball, no rebound, 4 s",
        "a free fall, one impact that must stop the ball, then rest at no depth",
        4.0,
        scene_of("drop"),
        column,
    ),
    Problem(
        "bounce",
        "Bounce: one ball, restitution 0.7, 4 s",
        "infinitely many impacts in 2.4 s: an error in any impact time shifts all later flights",
        4.0,
        scene_of("bounce"),
        column,
    ),
    Problem(
        "stack",
        "Stack: three balls, no rebound, 4 s",
        "three contacts that share bodies: the impact stops all at once, then nothing may sink",
        4.0,
        scene_of("stack"),
        column,
    ),
    Problem(
        "tower",
        "Tower: thirty balls, no rebound, 2 s",
        "thirty contacts in a chain: sweeps and substeps that are too few let it sag",
        2.0,
        scene_of("stack", 30),
        column,
        (0.002, 0.004, 0.008, 0.016),
        SEEDS[:3],
    ),
    Problem(
        "elastic",
        "Elastic bounce: one ball, restitution 1, 20 s",
        "two dozen impacts that may neither take nor give energy, and whose times add up",
        20.0,
        scene_of("bounce", restitution=1.0),
        column,
        DTS[1:],
    ),
    Problem(
        "slide",
        "Slide: a ball off a fixed ball, 0.7 s",
        "a contact that turns while it pushes, and must let go at cos = 2/3 of its start",
        0.7,
        slide_scene,
        slide_truth,
    ),
    Problem(
        "pyramid",
        "Pyramid: a ball between two others, 0.5 s",
        "two turning contacts that share a ball, a release, and a landing at its own time",
        0.5,
        pyramid_scene,
        pyramid_truth,
    ),
)
BY_NAME = {problem.name: problem for problem in PROBLEMS}


def quality(problem, scene, dt, run):
    """Every error of one run (a contact.Run) of a problem, as a flat dict of numbers.

    position_error, final_error: distance of a ball from where it should be, worst ball, in radii;
        over the whole run, and at its end
    energy_error, final_energy_error: the same of the energy, in start energies
    max_penetration, rest_gap, contact_energy: see contact.contact_quality
    restitution: one ball only: square root of (highest gap after the first impact / first gap)
    impact_time_error: s, of the first impact. phase_error: s, of the last apex that an elastic
        ball and its closed form share; apexes: how many they share
    blew_up_step: None, or the step at which it diverged; blew_up_reason says what was seen
    """
    told = contact.contact_quality(run, scene, dt)
    with np.errstate(all="ignore"):
        q, v = problem.truth(scene, run.t)
        distance = np.sqrt(((run.q - q) ** 2).sum(axis=1)).max(axis=1) / R
        total = contact.energy(run.q, run.v, scene.mass)
        energy = np.abs(total - contact.energy(q, v, scene.mass)) / abs(total[0])
    result = dict(
        position_error=float(distance.max()),
        final_error=float(distance[-1]),
        energy_error=float(energy.max()),
        final_energy_error=float(energy[-1]),
        max_penetration=told["max_penetration_frac"],
        rest_gap=told["rest_gap_frac"],
        contact_energy=told["contact_energy"],
        **_blow_up(run, told),
    )
    if problem.truth is column:
        result |= _impacts(run, scene, dt)
    return result


def _blow_up(run, told):
    step, reason = told["blew_up_step"], None
    if step is not None:
        finite = np.isfinite(run.q[step]).all() and np.isfinite(run.v[step]).all()
        reason = f"energy above {contact.EXPLODED:g} x the start" if finite else "not finite"
    return dict(blew_up_step=step, blew_up_reason=reason)


def _impacts(run, scene, dt):
    """Rebound, first impact and phase of the lowest ball."""
    gap = run.q[:, 1, 0] - R
    impact = float(closed_form.first_impact_time(gap[0]))
    after = gap[np.searchsorted(run.t, impact) + 1 :]
    with np.errstate(all="ignore"):
        rebound = np.sqrt(max(after.max(initial=0.0), 0.0) / gap[0])
    found = dict(impact_time_error=abs(first_impact(run, dt) - impact))
    if len(scene.mass) == 1:
        found["restitution"] = float(rebound)
    if scene.restitution == 1.0:
        apexes = apex_times(run)
        known = int((run.t[-1] / impact) // 2)  # one apex every two fall times
        found["apexes"] = min(len(apexes), known)
        found["phase_error"] = (
            abs(
                float(apexes[found["apexes"] - 1])
                - closed_form.apex_time(gap[0], 1.0, found["apexes"] - 1)
            )
            if found["apexes"]
            else None
        )
    return found


def apex_times(run):
    """Times [s] at which the lowest ball turns from rising to falling, exact between two steps."""
    v = run.v[:, 1, 0]
    tops = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0))
    return run.t[tops] + v[tops] / closed_form.g


def first_impact(run, dt):
    """Time [s] of the lowest ball's first impact, read off a recording: NaN when there is none.

    The first step whose velocity is not that of free fall has the impact in it. The moment is where
    the parabola that arrives at the step meets the path that leaves it (a parabola too, or rest),
    kept within the step; so a model that resolves impacts is not charged for being sampled.
    """
    y, v, g = run.q[:, 1, 0], run.v[:, 1, 0], contact.GRAVITY
    change = np.diff(v) / dt  # mean acceleration of each step
    steps = np.flatnonzero(change > 0.999 * g)
    if len(steps) == 0 or not np.isfinite(y[steps[0] + 1]):
        return float("nan")
    k = steps[0]
    leaving = g if k + 1 < len(change) and change[k + 1] < 0.5 * g else 0.0
    # y[k] + v[k] s + g s^2 / 2 = y[k+1] - v[k+1] (dt - s) + leaving (dt - s)^2 / 2, for s >= 0
    c2, c1 = 0.5 * (g - leaving), v[k] - v[k + 1] + leaving * dt
    c0 = y[k] - y[k + 1] + v[k + 1] * dt - 0.5 * leaving * dt * dt
    with np.errstate(all="ignore"):
        s = 2.0 * c0 / (-c1 + np.sqrt(max(c1 * c1 - 4.0 * c2 * c0, 0.0)))
    return float(run.t[k] + min(max(s, 0.0), dt))
