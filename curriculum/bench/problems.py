"""The problems: a scene for every start, how long it runs, and the right answer at any time.

The closed forms are of paper and pencil, and take nothing from contact.py. A ball that starts at
rest with a gap h0 under it first lands after t1 = sqrt(2 h0 / g). Each impact multiplies its speed
by -e, so flight k = 1, 2, ... lasts 2 e^k t1. For e < 1 their sum has a limit: infinitely many
impacts, then rest. A ball that slides off a fixed one moves along one angle, and its energy gives
its speed; it leaves where cos(theta) = 2/3 cos(theta0), theta from the vertical. Equal balls in a
row that strike one another with e = 1 hand on their speeds: the row moves as if each flew on
through the others. Metres, seconds.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

import contact

R = contact.RADIUS
g = 9.81  # m/s^2, the magnitude of gravity
FLIGHTS = 10_000  # after so many a bounce is over in the last bit, or the run


def bounce_motion(gap, e, t):
    """Return the gap [m] at t [s] of a ball released at a gap [m]."""
    t, t1 = np.asarray(t, dtype=float), math.sqrt(2.0 * gap / g)
    flights = 2.0 * e ** np.arange(1.0, FLIGHTS)
    impacts = t1 * (1.0 + np.append(0.0, np.cumsum(flights)))
    k = np.searchsorted(impacts, t, side="right") - 1
    s, leaving = t - impacts[k], g * t1 * e ** (k + 1.0)
    flight = np.maximum(leaving * s - 0.5 * g * s * s, 0.0)  # s may round to just outside
    when = [k < 0, k == FLIGHTS - 1]  # it falls, it rests
    return np.select(when, [gap - 0.5 * g * t * t, np.zeros_like(t)], flight)


def slide_motion(theta0, length, radius, height, t):
    """Return q, (len(t), 2), of a ball that starts at rest on a fixed one and slides off it.

    theta0: its angle from the vertical at the start; length: distance of the centres while they
    touch; height: of the fixed centre, which stands at x = 0. On the floor it loses its vertical
    speed and slides on. Sliding is a pendulum upside down, theta'' = g / length sin(theta), by an
    integrator of order 8 that keeps twelve digits.
    """

    def slope(t, state):
        return state[1], g / length * math.sin(state[0])

    def leaves(t, state):
        return math.cos(state[0]) - 2.0 / 3.0 * math.cos(theta0)

    leaves.terminal = True
    how = dict(dense_output=True, events=leaves, rtol=3e-14, atol=1e-16)
    found = solve_ivp(slope, (0.0, 1e3), (theta0, 0.0), "DOP853", **how)
    release = found.t_events[0][0]
    theta, speed = found.sol(np.minimum(t, release))
    sine, cosine = np.sin(theta), np.cos(theta)
    x, y = length * sine, height + length * cosine
    vx, vy = length * cosine * speed, -length * sine * speed
    free = np.maximum(t - release, 0.0)  # it flies with what it has at the release; no rebound
    down = free >= (vy + np.sqrt(np.maximum(vy**2 + 2.0 * g * (y - radius), 0.0))) / g
    y = np.where(down, radius, y + vy * free - 0.5 * g * free * free)
    return np.stack([x + vx * free, y], axis=1)


class Problem(NamedTuple):
    """A scene for each start, run for `duration` seconds, and its true motion."""

    name: str
    what: str
    duration: float  # s
    build: Callable  # start -> contact.Scene
    truth: Callable  # (scene, t) -> q, (len(t), 2, N)
    starts: int = 5  # the error of one is a lottery of where a step falls

    @property
    def title(self):
        return f"{self.what}, {self.duration:g} s"

    def steps(self, dt):
        return round(self.duration / dt)


def column(scene, t):
    """Return the motion of balls over one another, e = 0, or of one ball with any e."""
    height = scene.q0[1]
    gap = bounce_motion(float(height[0]) - R, scene.restitution, t)
    y = R * (2.0 * np.arange(len(height)) + 1.0) + gap[:, None]
    return np.stack([0.0 * y, y], axis=1)


def slide(scene, t):
    """Return the motion of a ball off a fixed one."""
    x, y = scene.q0[:, 1]
    hill, radius = scene.radius
    q = slide_motion(math.atan2(x, y - hill), hill + radius, radius, hill, t)
    return np.stack([np.broadcast_to(scene.q0[:, 0], q.shape), q], axis=2)


def judged(scene, t):
    """Return the motion by contact.py's own exact: no closed form is known."""
    return contact.run_model("exact", scene, t[1], len(t) - 1).q


def spread_scene(start):
    """Return a ball at rest on two that lie on the table, a little apart, and give way."""
    half = R + 0.004 + 0.003 * start
    return contact.scene_of([-half, half, 0.0], [R, R, R + math.sqrt(4 * R * R - half * half)])


def glance_scene(start):
    """Return a ball that falls on the side of a fixed one, at an angle that the start chooses."""
    return contact.scene_of([0.0, 0.05 + 0.007 * start], [R, 0.6], [math.inf, 1.0])


def cradle_scene(start):
    """Return five balls in a row on the table, e = 1; the first is thrown at the others."""
    gaps = np.random.default_rng(start).uniform(0.001, 0.01, 4)
    x = np.concatenate(([0.0], np.cumsum(2 * R + gaps)))
    return contact.scene_of(x, R, vx=[2.0, 0.0, 0.0, 0.0, 0.0], restitution=1.0, damping=0.0)


def cradle(scene, t):
    """Return the motion of equal balls in a row, e = 1: each flies on through the others."""
    free = scene.q0[0] - 2 * R * np.arange(len(scene.mass)) + np.outer(t, scene.v0[0])
    x = np.sort(free, axis=1) + 2 * R * np.arange(len(scene.mass))
    return np.stack([x, 0 * x + R], axis=1)


def heavy(ratio, start):
    """Return a ball of so many kg on a ball of one, a little above the floor."""
    return contact.build_scene("stack", start, 2)._replace(mass=np.array((1.0, ratio)))


def built(name, bodies=None, e=None):
    return partial(contact.build_scene, name, bodies=bodies, restitution=e)


PROBLEMS = (
    Problem("drop", "one ball, no rebound", 4.0, built("drop"), column),
    Problem("bounce", "one ball, restitution 0.7", 4.0, built("bounce"), column),
    Problem("stack", "a stack of three", 4.0, built("stack"), column),
    Problem("slide", "a ball slides off a fixed one of 20 m", 4.6, built("slide"), slide),
    Problem("pile", "eight balls fall on one another", 1.0, built("pile", 8), judged, 20),
    Problem("elastic", "one ball, restitution 1", 20.0, built("bounce", e=1.0), column, 3),
    Problem("heavy_100", "100 kg on 1 kg, no rebound", 2.0, partial(heavy, 100.0), column, 3),
    Problem("heavy_1000", "1,000 kg on 1 kg, no rebound", 2.0, partial(heavy, 1000.0), column, 3),
    Problem("tower", "a stack of twenty", 2.0, built("stack", 20), column, 3),
    Problem("spread", "a ball pushes two others apart", 0.3, spread_scene, judged),
    Problem("glance", "a ball glances off a fixed one", 0.6, glance_scene, judged),
    Problem("cradle", "five balls in a row, restitution 1", 1.0, cradle_scene, cradle),
    Problem("pile_bounce", "eight balls, restitution 0.5", 0.5, built("pile", 8, 0.5), judged, 20),
)
BY_NAME = {problem.name: problem for problem in PROBLEMS}


@lru_cache(maxsize=256)  # starts and steps of a problem
def answer(name, start, dt):
    """Return q (T, 2, N) of a start of a problem, as it should be at each look."""
    problem = BY_NAME[name]
    return problem.truth(problem.build(start), np.arange(problem.steps(dt) + 1) * dt)


@np.errstate(all="ignore")
def worst_error(truth, q):
    """Return the largest position error [r] of a run q (T, 2, N), of any ball at any time; of one
    that exploded inf, which sorts behind all others."""
    worst = np.sqrt(((q - truth) ** 2).sum(axis=1)).max() / R
    return float(worst) if np.isfinite(worst) else math.inf
