"""Random scenes with numbers, and scenes as plain values: what a violation is reproduced from.

A spec is a dict: x, y [m], vx, vy [m/s], mass [kg], radius [m] (lists, one value a ball),
restitution, damping [N s/m], dt [s], steps, stiffness [N/m], baumgarte, iters, and of soft solref
(None, or a time constant [s] and a damping ratio), warm. A mass of inf is a fixed ball.
heap, gap, ceiling and column are contact.Scenes, for heaps.py.
"""

import math

import numpy as np

import contact

BODY = ("x", "y", "vx", "vy", "mass", "radius")
KNOBS = ("stiffness", "baumgarte", "iters", "solref", "warm")  # fields of contact.Settings


def to_scene(spec):
    """Return the contact.Scene of a spec."""
    return contact.scene_of(**{name: spec[name] for name in (*BODY, "restitution", "damping")})


def to_settings(spec, **more):
    """Return the contact.Settings of a spec."""
    return contact.Settings(**{name: spec[name] for name in KNOBS}, **more)


def state(q, v):
    """Return the entries of a spec that begins in this state."""
    return dict(zip(BODY, [*q.tolist(), *v.tolist()]))


def scattered(rng, radius):
    """Return centres over the table, no two balls nearer than a tenth of the largest radius."""
    count, r = len(radius), radius.max()
    side = math.ceil(math.sqrt(count)) + 1
    cell = rng.permutation(side * side)[:count]
    nudge = rng.uniform(-0.1, 0.1, (2, count)) * r
    return 2.3 * r * (cell % side) + nudge[0], 1.2 * r + 2.3 * r * (cell // side) + nudge[1]


def touching(rng, radius):
    """Return a pyramid of equal balls that touch one another and the table."""
    count = len(radius)
    radius[:] = r = 2.0 ** rng.integers(-5, -1)  # a power of two, so that rows touch exactly
    places, row, width = [], 0, math.ceil(math.sqrt(2 * count))
    while len(places) < count:
        across = range(max(1, width - row))
        places += [(r * (2 * k + row), r * (1 + math.sqrt(3.0) * row)) for k in across]
        row += 1
    x, y = np.array(places[:count]).T
    return x, y


def tower(rng, radius):
    """Return a column of balls, each on the one below, or all of them some way above it."""
    gaps = rng.uniform(0.01, 0.1, len(radius)) * rng.choice([0.0, 1.0])
    return np.zeros(len(radius)), np.cumsum(2 * radius + gaps) - radius


def overlapping(rng, radius):
    """Return centres anywhere in a narrow box: some balls start in others, or in the table."""
    width = 2.0 * radius.max() * math.sqrt(len(radius))
    x, y = rng.uniform(0.0, width, (2, len(radius)))
    return x, y + rng.choice([0.0, width])  # half of them in the air


LAYOUTS = (scattered, scattered, touching, tower, overlapping)


def pick(rng, *values):
    """Return one of the values; a pair stands for any number between."""
    value = values[rng.integers(len(values))]
    return float(rng.uniform(*value)) if isinstance(value, tuple) else value


def bodies(rng, count):
    """Return masses [kg] and radii [m] of `count` balls: equal, or up to 1 : 1000 and 1 : 100."""
    wide = pick(rng, 0.0, 0.0, 1.0, 1.5)
    mass = 10.0 ** rng.uniform(-wide, wide, count) if wide else np.ones(count)
    small = pick(rng, 0.0, 0.0, 0.8, 2.0)
    radius = 10.0 ** rng.uniform(-0.5 - small, -0.5, count) if small else np.full(count, 0.1)
    return mass, radius


def numbered_spec(number, small=False):
    """Return the spec with this number, the same everywhere: up to thirty balls; small: four.

    Balls at rest and thrown, fixed ones among them, apart, in touch and overlapping.
    """
    rng = np.random.default_rng([20261122, number, small])
    count = int(rng.integers(1, 5)) if small else min(30, 1 + int(rng.exponential(7.0)))
    mass, radius = bodies(rng, count)
    layout = LAYOUTS[rng.integers(len(LAYOUTS))]
    x, y = layout(rng, radius)
    vx, vy = pick(rng, 0.0, (0.0, 3.0), (3.0, 10.0)) * rng.standard_normal((2, count))
    vx *= layout is not tower  # where balls move up and down alone
    fixed = rng.random(count) < pick(rng, 0.0, 0.0, (0.1, 0.5))
    mass[fixed], vx[fixed], vy[fixed] = math.inf, 0.0, 0.0
    spring = [10.0 ** rng.uniform(-2.5, -1.0), rng.uniform(0.2, 2.0)]
    rows = (x, y, vx, vy, mass, radius)
    return {name: row.tolist() for name, row in zip(BODY, rows)} | {
        "restitution": pick(rng, 0.0, 1.0, (0.0, 1.0)),
        "damping": pick(rng, 0.0, 80.0, (0.0, 150.0)),
        "dt": float(10.0 ** rng.uniform(-3.3, -1.7)),
        "steps": int(rng.integers(20, 81)),
        "stiffness": float(10.0 ** rng.uniform(2, 5)),
        "baumgarte": pick(rng, 0.0, 0.2, 1.0, (0.0, 1.0)),
        "iters": int(pick(rng, 1, 5, 20, 100)),
        "solref": pick(rng, None, spring),
        "warm": pick(rng, 0.0, 0.0, 0.8, 1.0),
    }


def heap(rng):
    """Return 2 to 12 balls over the table, at rest or thrown."""
    count = int(rng.integers(2, 13))
    radius, mass = 0.05 * 4.0 ** rng.random(count), 100.0 ** rng.random(count)
    wide, fast = rng.uniform(0.5, 2.0), rng.choice([0.0, 1.0, 3.0])
    x, y = rng.uniform(-wide, wide, count), rng.uniform(0.2, 3.0 * wide, count)
    return contact.scene_of(x, y, mass, radius, *(fast * rng.standard_normal((2, count))))


def gap(rng):
    """Return a ball of 1.3 kg that flies between two far heavier ones, in any direction."""
    radius, gap = rng.uniform(0.05, 0.3, 3), rng.uniform(0.001, 0.1)
    angle, pace = rng.uniform(0.0, np.pi), rng.uniform(-10.0, 10.0)
    along = np.array([np.cos(angle), np.sin(angle)])
    ends = -radius[0], 2.0 * radius[2] + gap + radius[1], radius[2] + gap * rng.random()
    x, y = np.outer(along, ends) + [[0.0], [2.0]]
    mass = [*rng.choice([np.inf, *10.0 ** rng.uniform(0.0, 6.0, 2)], 2), 1.3]
    vx, vy = np.outer(along, [0.0, 0.0, pace]) + rng.normal(0.0, 0.3, (2, 3)) * [0.0, 0.0, 1.0]
    return contact.scene_of(x, y, mass, radius, vx, vy)


def ceiling(rng):
    """Return a column of 1 to 4 balls, all at up to 20 m/s, between the floor and a fixed ball."""
    count = int(rng.integers(2, 6))
    radius, gap = rng.uniform(0.05, 0.12, count), 10.0 ** rng.uniform(-6.0, -2.0, count)
    y = np.cumsum(2.0 * radius + gap) - radius
    mass = [*10.0 ** rng.uniform(-2.0, 3.0, count - 1), np.inf]
    vy = [*rng.uniform(-20.0, 20.0, count - 1), 0.0]
    return contact.scene_of(rng.normal(0.0, 1e-3, count), y, mass, radius, 0.0, vy)


def column(rng, count):
    """Return that many balls over one another, which fall or were thrown; masses up to 100 : 1."""
    radius, gap = rng.uniform(0.05, 0.2, count), 10.0 ** rng.uniform(-4.0, -0.3, count)
    y, mass = np.cumsum(2.0 * radius + gap) - radius, 10.0 ** rng.uniform(-1.0, 1.0, count)
    vy = rng.choice([0.0, 2.0]) * rng.uniform(-1.0, 1.0, count)
    return contact.scene_of(np.zeros(count), y, mass, radius, 0.0, vy)


def mirror(rng):
    """Return balls, some fixed, and their images in x = 0, with one between: impacts tie."""
    count = int(rng.integers(1, 5))
    radius, mass = rng.uniform(0.05, 0.15, count), 10.0 ** rng.uniform(-1.0, 1.0, count)
    x, y = rng.uniform(0.0, 0.6, count), rng.uniform(0.1, 1.2, count)
    mass[rng.random(count) < 0.3] = np.inf
    vx, vy = rng.choice([0.0, 1.0, 3.0]) * np.isfinite(mass) * rng.standard_normal((2, count))
    axis = 0.0, rng.uniform(0.2, 1.5), 1.0, 0.1, 0.0, 0.0
    rows = zip((x, y, mass, radius, vx, vy), (-x, y, mass, radius, -vx, vy), axis)
    return contact.scene_of(*([*one, *image, middle] for one, image, middle in rows))
