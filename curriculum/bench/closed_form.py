"""What the right answer is, in closed form: the reference that every method is measured against.

Nothing here is stepped, and nothing is taken from contact.py: the functions follow from three
textbook facts about a ball of radius r that starts at rest with a gap h0 under it.

    free fall            gap(t) = h0 - g t^2 / 2: first impact at t1 = sqrt(2 h0 / g), speed g t1
    Newton's impact law  each impact multiplies the speed by -e, so flight k lasts 2 e^k t1
    geometric series     impact k (k = 0, 1, 2, ...) is at  t1 (1 + 2 e (1 - e^k) / (1 - e))

For e < 1 the impacts have a limit, t1 (1 + e) / (1 - e): infinitely many of them in finite time,
then rest. For e = 1 they go on for ever, one every 2 t1.

Balls that slide off one another move along one angle, and the energy gives its speed:

    off a fixed ball     leaves it where cos(theta) = 2/3 cos(theta0), theta from the vertical
    pyramid of three     the upper ball leaves where s = sin(theta) solves s^3 + 3 s = 2 s0
    tower of N           the floor under ball k (1 is the lowest) carries (N - k + 1) m g
    cradle               with gaps, only two balls ever touch: the last one takes the whole speed

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


def bounce_motion(gap, restitution, t):
    """Gap [m] and vertical speed [m/s] (arrays like t) of a ball released `gap` [m] over the floor.

    The number k of the flight under way comes from the series solved for k, not from a loop:
    t = impact_time(k) gives e^k = 1 - (t / t1 - 1) (1 - e) / (2 e).
    """
    t, e = np.asarray(t, dtype=float), restitution
    t1 = first_impact_time(gap)
    falling = t < t1
    if e == 0.0:
        return np.where(falling, gap - 0.5 * g * t * t, 0.0), np.where(falling, -g * t, 0.0)
    flying = (t >= t1) & (t < rest_time(gap, e))
    after = np.where(flying, t, t1)  # any harmless time where the answer is not a flight
    k = _flight_number(after, t1, e)
    speed = g * t1 * e ** (k + 1)  # leaving impact k
    s = after - impact_time(gap, e, k)
    flight = np.maximum(speed * s - 0.5 * g * s * s, 0.0)  # rounding can put s just outside it
    return (
        np.where(falling, gap - 0.5 * g * t * t, np.where(flying, flight, 0.0)),
        np.where(falling, -g * t, np.where(flying, speed - g * s, 0.0)),
    )


def bounce_gap(gap, restitution, t):
    """Gap [m] (array like t) under a ball released at rest `gap` [m] above the floor, t [s] later."""
    return bounce_motion(gap, restitution, t)[0]


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


def apex_time(gap, restitution, k):
    """Time [s] of the highest point after impact number k (0 is the first)."""
    return 0.5 * (impact_time(gap, restitution, k) + impact_time(gap, restitution, k + 1))


# balls that slide off one another


def slide_release(theta0):
    """Angle from the vertical [rad] at which a ball leaves a fixed one: cos = 2/3 cos(theta0)."""
    return np.arccos(2.0 / 3.0 * np.cos(theta0))


def slide_motion(theta0, length, radius, height, t):
    """q, v, shape (len(t), 2), of a ball that starts at rest on a fixed one and slides off it.

    theta0: its angle from the vertical at the start; length: distance of the centres while they
    touch; height: of the fixed centre, which stands at x = 0. On the floor it loses its vertical
    speed and slides on. Sliding: theta'^2 = 2 g / length (cos theta0 - cos theta).
    """

    def rate(theta):
        """theta' / sqrt(theta - theta0), which has no root at the start."""
        half = 0.5 * (theta - theta0)
        return np.sqrt(2.0 * g / length * np.sin(0.5 * (theta + theta0)) * np.sinc(half / np.pi))

    end = slide_release(theta0)
    release, theta = _angle_at(theta0, end, rate, t)
    speed = rate(theta) * np.sqrt(theta - theta0)
    sine, cosine = np.sin(theta), np.cos(theta)
    q = np.stack([length * sine, height + length * cosine], axis=1)
    v = np.stack([length * cosine * speed, -length * sine * speed], axis=1)
    return _thrown(q, v, t, release, radius)


def pyramid_release(theta0):
    """Angle over the horizontal [rad] at which the upper ball of three leaves the lower two."""
    p, s0 = 1.0, np.sin(theta0)  # s^3 + 3 p s - 2 s0 = 0, by Cardano's formula
    root = np.sqrt(s0 * s0 + p)
    return np.arcsin(np.cbrt(s0 + root) + np.cbrt(s0 - root))


def pyramid_motion(theta0, length, radius, t):
    """q, v, shape (len(t), 2, 3), of two equal balls on the floor and one that rests on both.

    Balls: lower left, lower right, upper. theta0: angle of the line of centres over the horizontal
    at the start, at rest; length: distance of the centres while they touch.
    theta'^2 = 2 g (sin theta0 - sin theta) / (length (1 + sin^2 theta)), theta falling.
    """

    def rate(fall):
        """theta' / sqrt(fall), fall = theta0 - theta."""
        theta, half = theta0 - fall, 0.5 * fall
        share = np.cos(theta0 - half) * np.sinc(half / np.pi)  # (s0 - s) / fall
        return np.sqrt(2.0 * g / length * share / (1.0 + np.sin(theta) ** 2))

    release, fall = _angle_at(0.0, theta0 - pyramid_release(theta0), rate, t)
    theta, speed = theta0 - fall, rate(fall) * np.sqrt(fall)
    sine, cosine, none = np.sin(theta), np.cos(theta), np.zeros_like(theta)
    side, drift = length * cosine, length * sine * speed
    free = np.maximum(t - release, 0.0)
    upper, upper_v = _thrown(
        np.stack([none, radius + length * sine], axis=1),
        np.stack([none, -length * cosine * speed], axis=1),
        t,
        release,
        radius,
    )
    x, vx = side + drift * free, drift
    floor = np.full_like(x, radius)
    q = np.stack([np.stack([-x, floor], 1), np.stack([x, floor], 1), upper], axis=2)
    v = np.stack([np.stack([-vx, none], 1), np.stack([vx, none], 1), upper_v], axis=2)
    return q, v


def _angle_at(start, end, rate, t):
    """Time at which an angle arrives at `end`, and the angle at times t, held there afterwards.

    angle' = rate(angle) sqrt(angle - start): with angle = start + s^2 the time is the integral of
    2 / rate over s, which is smooth, so Gauss's rule has all digits; Newton's method inverts it.
    """
    nodes, weights = np.polynomial.legendre.leggauss(80)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights

    def time(s):
        return 2.0 * s * (weights / rate(start + (s[:, None] * nodes) ** 2)).sum(axis=1)

    last = np.sqrt(end - start)
    release = float(time(np.array([last]))[0])
    wanted = np.minimum(np.asarray(t, dtype=float), release)
    s = last * wanted / release
    for _ in range(30):
        s = np.clip(s - 0.5 * (time(s) - wanted) * rate(start + s * s), 0.0, last)
    return release, start + s * s


def _thrown(q, v, t, release, radius):
    """The motion of a ball that flies from `release` on, lands without a rebound, and slides on."""
    free = np.maximum(np.asarray(t, dtype=float) - release, 0.0)
    fall = q[:, 1] - radius  # constant from the release on, as q and v are held
    land = (v[:, 1] + np.sqrt(np.maximum(v[:, 1] ** 2 + 2.0 * g * fall, 0.0))) / g
    down = free >= land
    x = q[:, 0] + v[:, 0] * free
    y = np.where(down, radius, q[:, 1] + v[:, 1] * free - 0.5 * g * free * free)
    speed = np.where(down, 0.0, v[:, 1] - g * free)
    return np.stack([x, y], axis=1), np.stack([v[:, 0], speed], axis=1)


# forces at rest, and a row of balls


def tower_forces(count, mass):
    """Normal force [N] under each of `count` equal balls, the lowest first: (N - k + 1) m g."""
    return mass * g * np.arange(count, 0.0, -1.0)


def cradle_speeds(count, speed):
    """Speeds [m/s] after a ball hits a row of others with gaps between them, e = 1, equal masses."""
    return np.append(np.zeros(count - 1), speed)
