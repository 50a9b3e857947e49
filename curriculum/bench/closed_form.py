"""What the right answer is, in closed form: the reference that every method is measured against.

Nothing here is stepped, and nothing is taken from contact.py: the functions follow from three
textbook facts about a ball of radius r that starts at rest with a gap h0 under it.

    free fall            gap(t) = h0 - g t^2 / 2: first impact at t1 = sqrt(2 h0 / g), speed g t1
    Newton's impact law  each impact multiplies the speed by -e, so flight k lasts 2 e^k t1
    geometric series     impact k (k = 0, 1, 2, ...) is at  t1 (1 + 2 e (1 - e^k) / (1 - e))

For e < 1 the impacts have a limit, t1 (1 + e) / (1 - e): infinitely many of them in finite time,
then rest. For e = 1 they go on for ever, one every 2 t1.

Units: metres, seconds, kilograms. `g` is a magnitude, 9.81 m/s^2, downwards.
"""

import numpy as np

g = 9.81  # m/s^2, the magnitude of gravity


def first_impact_time(gap):
    """Time [s] until a ball released at rest `gap` [m] above the floor touches it."""
    return np.sqrt(2.0 * gap / g)


def impact_time(gap, restitution, k):
    """Time [s] of impact number k (0 is the first): the partial sum of the geometric series."""
    return first_impact_time(gap) * (1.0 + 2.0 * _series(restitution, k))


def _series(e, k):
    """e + e^2 + ... + e^k, with 1 - e^k taken as -expm1(k log e), which keeps its digits near e = 1."""
    return k if e == 1.0 else -e * np.expm1(k * np.log(e)) / (1.0 - e)


def rest_time(gap, restitution):
    """Time [s] after which the ball lies still: t1 (1 + e) / (1 - e); infinite for e = 1."""
    if restitution == 1.0:
        return np.inf
    return first_impact_time(gap) * (1.0 + restitution) / (1.0 - restitution)


def rest_depth(mass, stiffness):
    """Depth [m] at which a spring k [N/m] holds a mass m [kg] up against gravity: m g / k."""
    return mass * g / stiffness


def flight_lag(t, dt):
    """How far [m] semi-implicit Euler is below the parabola after a free fall of t [s]: g t dt / 2.

    v_n = -g n dt and y_n = y_0 - g dt^2 n (n + 1) / 2, where the parabola has n^2.
    """
    return 0.5 * g * t * dt


def bounce_gap(gap, restitution, t):
    """Gap [m] (array like t) under a ball released at rest `gap` [m] above the floor, t [s] later.

    The number k of the flight under way comes from the series solved for k, not from a loop:
    t = impact_time(k) gives e^k = 1 - (t / t1 - 1) (1 - e) / (2 e).
    """
    t = np.asarray(t, dtype=float)
    e = restitution
    fall = gap - 0.5 * g * t * t
    t1 = first_impact_time(gap)
    if e == 0.0:
        return np.where(t < t1, fall, 0.0)
    flying = (t >= t1) & (t < rest_time(gap, e))
    after = np.where(flying, t, t1)  # any harmless time where the answer is not a flight
    k = _flight_number(after, t1, e)
    speed = g * t1 * e ** (k + 1)  # leaving impact k
    s = after - impact_time(gap, e, k)
    flight = np.maximum(speed * s - 0.5 * g * s * s, 0.0)  # rounding can put s just outside it
    return np.where(t < t1, fall, np.where(flying, flight, 0.0))


def _flight_number(t, t1, e):
    """Largest k with impact_time(k) <= t, for t1 <= t: a logarithm, one step on where it rounded."""
    if e == 1.0:
        return np.floor((t / t1 - 1.0) / 2.0)
    left = 1.0 - (t / t1 - 1.0) * (1.0 - e) / (2.0 * e)  # e^k at an impact, less in flight
    k = np.floor(np.log(np.maximum(left, np.finfo(float).tiny)) / np.log(e))
    start, end = (t1 * (1.0 + 2.0 * _series(e, n)) for n in (k, k + 1))
    return np.maximum(np.where(t < start, k - 1, np.where(t >= end, k + 1, k)), 0.0)


def ball_height(height, radius, restitution, t):
    """Height [m] of the centre of a ball released at rest at `height` [m]: drop and bounce."""
    return radius + bounce_gap(height - radius, restitution, t)


def column_heights(heights, radius, t):
    """Heights [m], shape (len(t), N), of N equal balls that start stacked, at rest, with e = 0.

    They fall together by the gap under the lowest one, and its impact stops all of them at once:
    every ball pushes the one above, and none of the pushes can pull.
    """
    lift = heights[0] - radius
    rest = radius * (2.0 * np.arange(len(heights)) + 1.0)
    return rest + bounce_gap(lift, 0.0, t)[:, None]


def rebound_gap(gap, restitution, k=1):
    """Highest gap [m] after k impacts: e^(2 k) times the first, as energy is speed squared."""
    return gap * restitution ** (2 * k)
