"""The problems with a known answer: which scene, for how long, and what each of them is hard on."""

from typing import NamedTuple, Optional

import numpy as np

import contact
from curriculum.bench import closed_form

DTS = (0.0005, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032)    # s
SEEDS = tuple(range(9))     # nine start heights: the error of one is a lottery of where a step falls
REFERENCE_DT = 0.002        # s, the step of contact.py's own default run


class Problem(NamedTuple):
    """A scene of contact.py, run for `duration` seconds; its closed form is the reference."""
    name: str
    title: str
    scene: str
    bodies: Optional[int]
    duration: float
    stresses: str       # what it is hard on, for the reader

    def build(self, seed):
        return contact.build_scene(self.scene, seed, self.bodies)

    def steps(self, dt):
        return round(self.duration / dt)

    def reference(self, scene, t):
        """The closed form's heights [m], shape (len(t), N)."""
        height, radius = scene.q0[1], float(scene.radius[0])
        if len(height) > 1:
            return closed_form.column_heights(height, radius, t)
        return closed_form.ball_height(float(height[0]), radius, scene.restitution, t)[:, None]


PROBLEMS = (
    Problem("drop", "Drop: one ball, no rebound, 4 s", "drop", None, 4.0,
            "a free fall, one impact that must stop the ball, then rest at no depth"),
    Problem("bounce", "Bounce: one ball, restitution 0.7, 4 s", "bounce", None, 4.0,
            "infinitely many impacts in 2.4 s: an error in any impact time shifts all later flights"),
    Problem("stack", "Stack: three balls, no rebound, 4 s", "stack", None, 4.0,
            "three contacts that share bodies: the impact must stop all at once, then nothing may sink"),
    Problem("tower", "Tower: thirty balls, no rebound, 2 s", "stack", 30, 2.0,
            "thirty contacts in a chain: sweeps and substeps that are too few let it sag"),
)


def quality(problem, scene, dt, run):
    """Every error of one run (a contact.Run) of a problem, as a flat dict of numbers.

    height_error: worst |y - closed form| over run and balls, in radii. max_penetration and
    rest_penetration in radii, contact_energy in start energies: see contact.contact_quality.
    restitution: square root of (highest gap under the lowest ball after the first impact / first gap).
    impact_time_error: seconds, see first_impact. blew_up_step: None, or the step at which it
    diverged; blew_up_reason says what was seen.
    """
    reference = problem.reference(scene, run.t)
    told = contact.contact_quality(run, scene, dt)
    gap = run.q[:, 1, 0] - scene.radius[0]
    impact = float(closed_form.first_impact_time(gap[0]))
    after = gap[np.searchsorted(run.t, impact) + 1:]
    with np.errstate(all="ignore"):
        error = np.abs(run.q[:, 1] - reference).max() / scene.radius[0]
        rebound = np.sqrt(max(after.max(initial=0.0), 0.0) / gap[0])
    step, reason = told["blew_up_step"], None
    if step is not None:
        finite = np.isfinite(run.q[step]).all() and np.isfinite(run.v[step]).all()
        reason = (f"energy above {contact.EXPLODED:g} x the start" if finite else "not finite")
    return dict(height_error=float(error), max_penetration=told["max_penetration_frac"],
                rest_penetration=told["rest_penetration_frac"], contact_energy=told["contact_energy"],
                energy_excess=told["energy_excess"], restitution=float(rebound),
                impact_time_error=abs(first_impact(run, dt) - impact), blew_up_step=step,
                blew_up_reason=reason)


def first_impact(run, dt):
    """Time [s] of the lowest ball's first impact, read off a recording: NaN when there is none.

    The first step whose velocity is not that of free fall has the impact in it. The moment is where
    the parabola that arrives at the step meets the path that leaves it (a parabola too, or rest), kept
    within the step; so a model that resolves impacts is not charged for being sampled at step ends.
    """
    y, v, g = run.q[:, 1, 0], run.v[:, 1, 0], contact.GRAVITY
    change = np.diff(v) / dt                                # mean acceleration of each step
    steps = np.flatnonzero(change > 0.999 * g)
    if len(steps) == 0 or not np.isfinite(y[steps[0] + 1]):
        return float("nan")
    k = steps[0]
    leaving = g if k + 1 < len(change) and change[k + 1] < 0.5 * g else 0.0
    # y[k] + v[k] s + g s^2 / 2 = y[k+1] - v[k+1] (dt - s) + leaving (dt - s)^2 / 2, for s >= 0
    c2, c1 = 0.5 * (g - leaving), v[k] - v[k + 1] + leaving * dt
    c0 = y[k] - y[k + 1] + v[k + 1] * dt - 0.5 * leaving * dt * dt
    s = 2.0 * c0 / (-c1 + np.sqrt(max(c1 * c1 - 4.0 * c2 * c0, 0.0)))
    return float(run.t[k] + min(max(s, 0.0), dt))
