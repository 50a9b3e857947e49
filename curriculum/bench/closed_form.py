"""What the right answer is, in closed form: the reference that every method is measured against.

Nothing here is stepped, and nothing is taken from contact.py. For a ball that starts at rest with
a gap h0 under it:

    free fall            gap(t) = h0 - g t^2 / 2: first impact at t1 = sqrt(2 h0 / g), speed g t1
    Newton's impact law  each impact multiplies the speed by -e, so flight k lasts 2 e^k t1
    geometric series     impact k (k = 0, 1, 2, ...) is at  t1 (1 + 2 e (1 - e^k) / (1 - e))

For e < 1 the impacts have a limit, t1 (1 + e) / (1 - e): infinitely many of them in finite time,
then rest. A ball that slides off a fixed one moves along one angle, and the energy gives its
speed; it leaves where cos(theta) = 2/3 cos(theta0), theta from the vertical.
Units: metres, seconds.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

g = 9.81  # m/s^2, the magnitude of gravity
FLIGHTS = 10_000  # after so many a bounce is over in the last bit, or the run


def bounce_motion(gap, e, t):
    """Gap [m] and vertical speed [m/s], like t [s], of a ball released `gap` [m] over the floor."""
    t, t1 = np.asarray(t, dtype=float), math.sqrt(2.0 * gap / g)
    falling = t < t1
    still, speed = np.zeros_like(t), np.zeros_like(t)
    if e > 0.0:
        rest = t1 * (1.0 + e) / (1.0 - e) if e < 1.0 else math.inf
        flying = (t >= t1) & (t < rest)
        after = np.where(flying, t, t1)  # any harmless time where the answer is not a flight
        k = np.arange(FLIGHTS)  # -expm1(k log e) is 1 - e^k, and keeps its digits near e = 1
        series = -e * np.expm1(k * math.log(e)) / (1.0 - e) if e < 1.0 else k
        impacts = t1 * (1.0 + 2.0 * series)
        k = np.searchsorted(impacts, after, side="right") - 1
        leaving = g * t1 * e ** (k + 1)
        s = after - impacts[k]
        flight = np.maximum(leaving * s - 0.5 * g * s * s, 0.0)  # s may round to just outside
        still = np.where(flying, flight, 0.0)
        speed = np.where(flying, leaving - g * s, 0.0)
    return np.where(falling, gap - 0.5 * g * t * t, still), np.where(falling, -g * t, speed)


def slide_motion(theta0, length, radius, height, t):
    """q, v, (len(t), 2), of a ball that starts at rest on a fixed one and slides off it.

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
    found = solve_ivp(
        slope,
        (0.0, 1e3),
        (theta0, 0.0),
        "DOP853",
        dense_output=True,
        events=leaves,
        rtol=3e-14,
        atol=1e-16,
    )
    release = found.t_events[0][0]
    theta, speed = found.sol(np.minimum(t, release))
    sine, cosine = np.sin(theta), np.cos(theta)
    q = np.stack([length * sine, height + length * cosine], axis=1)
    v = np.stack([length * cosine * speed, -length * sine * speed], axis=1)
    return thrown(q, v, np.maximum(t - release, 0.0), radius)


def thrown(q, v, free, radius):
    """q, v of a ball that has flown for the time `free` [s], lands without rebound, slides on."""
    fall = q[:, 1] - radius  # constant once it is free, as q and v are held
    land = (v[:, 1] + np.sqrt(np.maximum(v[:, 1] ** 2 + 2.0 * g * fall, 0.0))) / g
    down = free >= land
    x = q[:, 0] + v[:, 0] * free
    y = np.where(down, radius, q[:, 1] + v[:, 1] * free - 0.5 * g * free * free)
    speed = np.where(down, 0.0, v[:, 1] - g * free)
    return np.stack([x, y], axis=1), np.stack([v[:, 0], speed], axis=1)
