"""Maps: one ball dropped a metre, over every knob that decides what becomes of it, with the theory.

A job is one row of a map: every dt for one setting of the other knobs.
"""

import math

import numpy as np

import contact
from curriculum.stress.trial import G, U, run_twin

SETTLES, RESTLESS, GAINS, EXPLODES = OUTCOMES = "srgx"
WORDS = ("settles at m g / k", "keeps moving", "gains over 1 % energy", "explodes (gains over 10x)")
SCENE = contact.build_scene("drop")
R = contact.RADIUS
SECONDS = 4.0
SEEDS = 9  # start heights: how deep a landing gets depends on where in a step it falls
BISECTED = 1.001  # ratio of the bounds at which the search for the critical dt ends
AMPLIFIED, WATCHED = 20.0, 2000  # a ball that gets 20 times as far off within 2,000 steps leaves
LATE = 0.004  # share of the critical dt: 0.3 %, and what the search leaves open


def grid(low, high, count):
    """`count` values from low to high, equal ratios."""
    return np.geomspace(low, high, count).tolist()


def map_jobs(quick):
    """The rows of all maps."""
    dts, stiff, times = (8, 6, 4) if quick else (40, 31, 26)
    for c in (0.0, 80.0):
        for k in grid(1e2, 1e7, stiff):
            row = PenaltyRow(c, k, grid(3e-4, 0.3, dts))
            yield f"k {k:.4g}, c {c:g}", row, [penalty_leaves_above_its_critical_dt]
    for dt in grid(1e-3, 0.128, dts):
        yield f"dt {dt:.4g}", dt, [lcp_sinks_as_deep_as_its_landing_step]
    for T in grid(2e-3, 0.3, times):
        given = T, grid(1e-3, 0.128, dts)
        yield f"T {T:.4g}", given, [soft_rests_where_its_spring_bears_the_ball]


def run(model, scene, dt, seconds, **knobs):
    """A run of that many seconds, at least 50 steps."""
    steps = max(50, math.ceil(seconds / dt))
    return run_twin(model, scene, dt, steps, contact.Settings(**knobs))


class PenaltyRow:
    """What penalty does at one damping [N s/m] and stiffness [N/m], over the time steps dt [s]."""

    def __init__(self, damping, stiffness, dts):
        self.stiffness, self.scene = stiffness, SCENE._replace(damping=damping)
        self.dts, self.noted = dts, {}

    def outcome(self, dt):
        """One letter of OUTCOMES for the drop, watched until it should have settled.

        For eight times the slowest of: two decays of the damped spring, and the end of the bounces.
        """
        c, k = self.scene.damping, self.stiffness
        decay = max(2.0, c * c / k, 0.1 * math.sqrt(k)) / c if c else 0.0
        found = run("penalty", self.scene, dt, SECONDS + 8 * decay, stiffness=k)
        if contact.blow_up_step(contact.energy(found.q, found.v, SCENE.mass)) is not None:
            return EXPLODES
        y, vy = found.q[:, 1, 0], found.v[:, 1, 0]
        tail = slice(-max(10, len(y) // 10), None)
        off = np.abs(y[tail] - (R - G / k)).max()
        if off < 0.01 * G / k and np.abs(vy[tail]).max() < 1e-3:
            return SETTLES
        return GAINS if (vy * vy / 2 + G * y > 1.01 * G * SCENE.q0[1, 0]).any() else RESTLESS

    def critical_dt(self, guess):
        """Largest dt [s] at which a ball kept in contact stays where it rests, by bisection."""
        low, high = 0.5 * guess, 2.0 * guess
        if self.leaves(low) or not self.leaves(high):
            return math.nan
        while high / low > BISECTED:
            middle = math.sqrt(low * high)
            low, high = (low, middle) if self.leaves(middle) else (middle, high)
        return math.sqrt(low * high)

    def leaves(self, dt):
        """Whether a ball that starts a little off its rest depth moves away from it.

        So little that no clamp acts: half a percent of what would lift it or stop the damper.
        """
        rest = R - G / self.stiffness
        little = 0.005 * G * min(1.0 / self.stiffness, dt * dt)
        scene = self.scene._replace(q0=np.array([[0.0], [rest - little]]))
        found = run("penalty", scene, dt, WATCHED * dt, stiffness=self.stiffness)
        return not np.abs(found.q[:, 1, 0] - rest).max() < AMPLIFIED * little


def penalty_leaves_above_its_critical_dt(row):
    """penalty: a ball kept in contact moves away from where it rests above the critical dt, within
    0.4 %. Whether it moves away is seen within 2,000 steps up to 0.3 % late, as its eigenvalue is
    near -1.
    """
    c, k = row.scene.damping, row.stiffness
    theory = contact.critical_dt(1.0, k, c)
    measured = row.critical_dt(theory)
    yield "critical dt [s]", abs(measured - theory), LATE * theory
    found = dict(damping=c, stiffness=k, dt=row.dts, theory=theory, measured=measured)
    row.noted["penalty"] = found | {"outcomes": "".join(map(row.outcome, row.dts))}


def lcp_sinks_as_deep_as_its_landing_step(dt):
    """lcp: the drop sinks as deep as the first state within the margin, from nine heights.

    A step rounds y and v twice each, which moves y by 2 U (h + v t) <= 6 U h until the landing.
    """
    for seed in range(SEEDS):
        scene = contact.build_scene("drop", seed)
        found, gap = run("lcp", scene, dt, SECONDS), float(scene.q0[1, 0]) - R
        deep = max(0.0, R - float(found.q[:, 1].min()))
        off = abs(deep - landing_depth(gap, dt))
        yield f"depth [m], seed {seed}", off, 6 * U * len(found.t) * (gap + R)


def landing_depth(gap, dt):
    """Depth [m] of the first state within the margin: g dt^2 n (n + 1) / 2 - gap."""
    n = np.arange(1000)  # more steps than any of these falls takes
    depth = G * dt * dt / 2 * n * (n + 1) - gap
    return max(0.0, depth[np.argmax(depth > -contact.CONTACT_MARGIN)])


def soft_rests_where_its_spring_bears_the_ball(given):
    """soft: at rest (1 - d) g = d^2 K depth, within 1e-6.

    K has the time constant that counts, max(T, 2 dt). Judged where the ball has come to rest: it
    moves by under 1e-12 r in a step.
    """
    timeconst, dts = given
    for dt in dts:
        T = max(timeconst, 2 * dt)
        found = run("soft", SCENE, dt, SECONDS + 20 * T, solref=(timeconst, 1.0))
        if abs(found.v[-1, 1, 0]) * dt < 1e-12 * R:
            rest = R - float(found.q[-1, 1, 0])
            d = contact.impedance(rest, contact.SOLIMP)
            spring = d * d * rest / (contact.SOLIMP[1] * T) ** 2
            yield f"spring [m/s^2] at dt {dt:.4g} s", abs(spring - (1 - d) * G), 1e-6 * (1 - d) * G
