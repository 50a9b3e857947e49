"""A map of penalty: what becomes of a ball dropped a metre, over step, stiffness and damping.

A job is one row of the map: every dt for one setting of the other knobs.
"""

import math

import numpy as np

import contact
from curriculum.stress.trial import G, run_twin

SETTLES, RESTLESS, GAINS, EXPLODES = OUTCOMES = "srgx"
WORDS = ("settles at m g / k", "keeps moving", "gains over 1 % energy", "explodes (gains over 10x)")
SCENE = contact.build_scene("drop")
R = contact.RADIUS
SECONDS = 4.0


def map_jobs(quick):
    """Yield the rows of the map."""
    dts, stiff = (8, 6) if quick else (40, 31)
    for c in (0.0, 80.0):
        for k in np.geomspace(1e2, 1e7, stiff).tolist():
            row = PenaltyRow(c, k, steps_of(dts))
            yield f"k {k:.4g}, c {c:g}", row, [penalty_settles_as_its_critical_dt_says]


def steps_of(count):
    """Return so many time steps [s] of the map."""
    return np.geomspace(3e-4, 0.3, count).tolist()


class PenaltyRow:
    """What penalty does at one damping [N s/m] and stiffness [N/m], over the time steps dt [s]."""

    def __init__(self, damping, stiffness, dts):
        self.damping, self.stiffness, self.dts, self.noted = damping, stiffness, dts, {}

    def outcome(self, dt):
        """Return one letter of OUTCOMES for the drop, watched until it should have settled.

        For eight times the slowest of: two decays of the damped spring, and the end of the bounces.
        """
        c, k = self.damping, self.stiffness
        decay = max(2.0, c * c / k, 0.1 * math.sqrt(k)) / c if c else 0.0
        steps = max(50, math.ceil((SECONDS + 8 * decay) / dt))
        scene, knobs = SCENE._replace(damping=c), contact.Settings(stiffness=k)
        found = run_twin("penalty", scene, dt, steps, knobs)
        if contact.blow_up_step(contact.energy(found.q, found.v, SCENE.mass)) is not None:
            return EXPLODES
        y, vy = found.q[:, 1, 0], found.v[:, 1, 0]
        tail = slice(-max(10, len(y) // 10), None)
        off = np.abs(y[tail] - (R - G / k)).max()
        if off < 0.01 * G / k and np.abs(vy[tail]).max() < 1e-3:
            return SETTLES
        return GAINS if (vy * vy / 2 + G * y > 1.01 * G * SCENE.q0[1, 0]).any() else RESTLESS


def penalty_settles_as_its_critical_dt_says(row):
    """penalty: above the critical step no dropped ball comes to rest."""
    critical = contact.critical_dt(1.0, row.stiffness, row.damping)
    outcomes = "".join(map(row.outcome, row.dts))
    found = {"damping": row.damping, "stiffness": row.stiffness, "critical": critical}
    row.noted["penalty"] = found | {"outcomes": outcomes}
    settled = np.array([outcome == SETTLES for outcome in outcomes])
    yield "settles above", settled & (np.array(row.dts) > critical), 0.0
