"""Random scenes, and scenes as JSON: what a violation is reproduced from.

A spec is a dict of plain values: x, y [m], vx, vy [m/s], mass [kg], radius [m] (lists),
restitution, damping [N s/m], dt [s], steps, stiffness [N/m], baumgarte, iters, and of soft solref
(None, or a time constant [s] and a damping ratio). A mass of inf is a fixed ball. JSON keeps every
bit of a double (Python writes the shortest text that reads back the same).
"""

import numpy as np

from curriculum.stress import under_test
from curriculum.stress.under_test import contact

BODY = ("x", "y", "vx", "vy", "mass", "radius")
KNOBS = {"penalty": ("stiffness",), "lcp": ("baumgarte", "iters"), "soft": ("solref",), "exact": ()}


def to_scene(spec):
    """The contact.Scene of a spec."""
    rows = {name: np.array(spec[name], dtype=float) for name in BODY}
    return contact.Scene(
        "random",
        np.array([rows["x"], rows["y"]]),
        np.array([rows["vx"], rows["vy"]]),
        rows["mass"],
        rows["radius"],
        spec["restitution"],
        spec["damping"],
    )


def run(model, spec, **changes):
    """under_test.run_model on a spec; `changes` override its entries, or are its flags (skip)."""
    flags = {name: changes.pop(name) for name in ("skip",) if name in changes}
    spec = {**spec, **changes}
    knobs = {name: spec.get(name) for name in KNOBS[model]}
    return under_test.run_model(model, to_scene(spec), spec["dt"], spec["steps"], **knobs, **flags)


def scattered(rng, n, radius):
    """n centres over the line, no two balls nearer than a tenth of a radius: a thinned lattice."""
    side = int(np.ceil(np.sqrt(n))) + 1
    r = radius.max()
    cells = rng.permutation(side * side)[:n]
    wobble = rng.uniform(-0.1, 0.1, (2, n)) * r
    return 2.3 * r * (cells % side) + wobble[0], 1.2 * r + 2.3 * r * (cells // side) + wobble[1]


def pegged(rng, n, radius):
    """As scattered. Some will be pegs, on which others come to rest (random_spec)."""
    return scattered(rng, n, radius)


def touching(rng, n, radius):
    """A pyramid of equal balls that touch one another and the line (exactly, for dyadic radii)."""
    radius[:] = 2.0 ** rng.integers(-5, -1)
    r = radius[0]
    x, y, row, width = [], [], 0, int(np.ceil(np.sqrt(2 * n)))
    while len(x) < n:
        for k in range(max(1, width - row)):
            x.append(r * (2 * k + row))
            y.append(r * (1 + np.sqrt(3.0) * row))
        row += 1
    return np.array(x[:n]), np.array(y[:n])


def tower(rng, n, radius):
    """A column of balls, each on the one below, from unequal radii."""
    top = np.concatenate([[0.0], np.cumsum(2 * radius)[:-1]])
    return np.zeros(n), top + radius


def overlapping(rng, n, radius):
    """Centres anywhere in a narrow box: some balls start inside others or inside the table."""
    width = 2.0 * radius.max() * np.sqrt(n)
    return rng.uniform(0, width, n), rng.uniform(0, width, n)


LAYOUTS = (scattered, pegged, touching, tower, overlapping)


def random_spec(rng, layout=None):
    """A spec drawn from `rng`: 1 to 30 balls, every layout, knobs at their ends and between."""
    n = int(rng.integers(1, 31))

    def pick(*values):
        value = values[rng.integers(len(values))]
        return float(rng.uniform(*value)) if isinstance(value, tuple) else value

    radius = np.full(n, 0.1) if rng.random() < 0.5 else rng.uniform(0.03, 0.2, n)
    mass = np.ones(n) if rng.random() < 0.5 else 10.0 ** rng.uniform(-1, 1, n)
    layout = layout or LAYOUTS[rng.integers(len(LAYOUTS))]
    x, y = layout(rng, n, radius)
    speed = pick(0.0, (0.0, 3.0))
    vx, vy = speed * rng.standard_normal((2, n))
    if layout is pegged:
        fixed = rng.random(n) < rng.uniform(0.1, 0.5)
        mass[fixed], vx[fixed], vy[fixed] = np.inf, 0.0, 0.0
    spec = {"layout": layout.__name__}
    spec |= zip(BODY, (row.tolist() for row in (x, y, vx, vy, mass, radius)))
    spec["restitution"] = pick(0.0, 0.0, 1.0, (0.0, 1.0))
    spec["damping"] = pick(0.0, 80.0, (0.0, 150.0))
    spec["dt"] = float(10.0 ** rng.uniform(-3.3, -1.7))
    spec["steps"] = int(rng.integers(20, 81))
    spec["stiffness"] = float(10.0 ** rng.uniform(2, 5))
    spec["baumgarte"] = pick(0.0, 0.2, 1.0, (0.0, 1.0))
    spec["iters"] = int(pick(1, 5, 20, 100))
    spring = [float(10.0 ** rng.uniform(-2.5, -1.0)), float(rng.uniform(0.2, 2.0))]
    spec["solref"] = pick(None, spring)
    return spec


def numbered_spec(number):
    """The random spec with this number: the same on every machine and numpy that keeps PCG64."""
    return random_spec(np.random.default_rng([20240501, number]))


def board_spec(number):
    """Balls that fall through pegs for three seconds (Galton's board), one with each number.

    Long enough for some to lie at rest, beside others that still slide, when more fall on them.
    """
    spec = random_spec(np.random.default_rng([20261122, number]), pegged)
    return spec | {"dt": 0.01, "steps": 300}
