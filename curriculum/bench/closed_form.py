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


def first_impact_time(gap):
    """Time [s] until a ball released at rest `gap` [m] above the floor touches it."""
    return np.sqrt(2.0 * gap / g)


def impact_time(gap, restitution, k):
    """Time [s] of impact number k (0 is the first): the partial sum of the geometric series."""
    e = restitution  # 1 - e^k is taken as -expm1(k log e), which keeps its digits near e = 1
    series = k if e == 1.0 else -e * np.expm1(k * np.log(e)) / (1.0 - e)
    return first_impact_time(gap) * (1.0 + 2.0 * series)


def rest_time(gap, restitution):
    """Time [s] after which the ball lies still: t1 (1 + e) / (1 - e); infinite for e = 1."""
    if restitution == 1.0:
        return np.inf
    return first_impact_time(gap) * (1.0 + restitution) / (1.0 - restitution)


def bounce_motion(gap, restitution, t):
    """Gap [m] and vertical speed [m/s], like t [s], of a ball released `gap` [m] over the floor."""
    t, e = np.asarray(t, dtype=float), restitution
    t1 = first_impact_time(gap)
    falling = t < t1
    still, speed = np.zeros_like(t), np.zeros_like(t)
    if e > 0.0:
        flying = (t >= t1) & (t < rest_time(gap, e))
        after = np.where(flying, t, t1)  # any harmless time where the answer is not a flight
        impacts = impact_time(gap, e, np.arange(FLIGHTS))
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
