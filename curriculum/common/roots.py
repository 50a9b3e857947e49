"""The first time at which a polynomial falls through zero. Needs numpy."""

import numpy as np


def first_fall(p, horizon):
    """First t in [0, horizon] at which each quartic sum p[k] t^k falls through zero; inf if it does not.

    p (5, K) with p[0] >= 0. Newton's method made safe: with the least curvature up to the horizon no
    step passes a root, and a parabola takes one step. An answer is good to 1e-15 of itself, or early
    where 200 steps of next to no curvature did not get there.
    """
    p0, p1, p2, p3, p4 = p
    t, curved, bend = np.zeros(p.shape[1]), (p3 != 0.0) | (p4 != 0.0), p2
    value, slope, left, moving = p0, p1, 200, np.ones(p.shape[1], bool)
    while left:
        if curved.any():
            vertex = np.where(p4 > 0.0, np.clip(-p3 / (4.0 * p4), t, horizon), t)
            bend = np.minimum.reduce([p2 + (3.0 * p3 + 6.0 * p4 * s) * s for s in (t, horizon, vertex)])
            value = np.maximum((((p4 * t + p3) * t + p2) * t + p1) * t + p0, 0.0)
            slope = ((4.0 * p4 * t + 3.0 * p3) * t + 2.0 * p2) * t + p1
        root = np.sqrt(slope * slope - 4.0 * value * bend)              # NaN: no root
        step = np.where(slope < 0.0, 2.0 * value / (root - slope),
                        np.where(bend < 0.0, (slope + root) / (-2.0 * bend), np.inf))
        t = np.where(moving, np.where(t + step <= horizon, t + step, np.inf), t)
        moving &= curved & (step > 1e-15 * t)                           # the others have arrived
        left = left - 1 if moving.any() else 0
    return t
