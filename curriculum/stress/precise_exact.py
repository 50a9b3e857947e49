"""`exact` in 80 bits: the same source, run a second time with another kind of number.

The source of curriculum/exact.py becomes a module of its own in which `math` and `np` are stand-ins
on np.longdouble, x86's 80 bit numbers with 64 bits of mantissa, and in which tolerances are 2^-11
times as large, as a last bit is. What a double run differs by from it is rounding, grown by chaos,
and what the tolerances of exact let go.
"""

import ast
import math
import types
from functools import lru_cache
from pathlib import Path

import numpy as np

from curriculum import exact

Number = np.longdouble
MORE = 11  # bits of mantissa beyond a double's 53
TOLERANCE = 1e-8  # a literal below this is a tolerance for rounding; the others are choices
LONGER = 8  # times as many events before the clock waits: it is not to be what parts two runs


def lacking():
    """Why this machine cannot run it, in one line; an empty text where it can."""
    bits = np.finfo(Number).nmant
    if bits == 52 + MORE:
        return ""
    return f"no 80 bit numbers here: np.longdouble has {bits} bits after the first, not {52 + MORE}"


class Scaled(ast.NodeTransformer):
    """Tolerances of the source, made 2^-11 times as large."""

    def visit_Constant(self, node):
        if isinstance(node.value, float) and 0.0 < node.value < TOLERANCE:
            return ast.copy_location(ast.Constant(math.ldexp(node.value, -MORE)), node)
        return node


def precise_math():
    """What exact takes from `math`, of 80 bit numbers."""
    return types.SimpleNamespace(
        inf=math.inf,
        ldexp=math.ldexp,  # of 1 and a whole number: a power of 2, exact
        sqrt=lambda x: np.sqrt(Number(x)),
        ulp=lambda x: np.spacing(Number(x)),
        dist=lambda p, q: np.sqrt(sum((Number(a) - Number(b)) ** 2 for a, b in zip(p, q))),
    )


def precise_numpy():
    """numpy with 80 bit numbers where it would make doubles of what it is given."""
    names = types.SimpleNamespace(**vars(np))
    names.zeros = lambda shape, dtype=Number: np.zeros(shape, dtype)
    names.array = widened
    names.bincount = summed
    return names


def widened(values):
    """np.array, of 80 bit numbers where it would be of doubles."""
    made = np.array(values)
    return made.astype(Number) if made.dtype == np.float64 else made


def summed(places, weights, count):
    """np.bincount, whose weights are doubles, of 80 bit ones; it adds in the same order."""
    total = np.zeros(count, Number)
    np.add.at(total, places, weights)
    return total


def later(time, span):
    """exact.later for an 80 bit span, which is the sum of two doubles."""
    high = float(span)
    return exact.later(exact.later(time, high), float(span - high) if high < math.inf else 0.0)


def seconds(start, time):
    """exact.seconds, as an 80 bit number."""
    high = exact.seconds(start, time)
    rest = 0.0 if math.isinf(high) else exact.seconds(exact.later(start, high), time)
    return Number(high) + Number(rest)


@lru_cache(maxsize=1)
def module():
    """curriculum/exact.py with 80 bit numbers."""
    path = Path(exact.__file__)
    tree = Scaled().visit(ast.parse(path.read_text("utf-8")))
    made = types.ModuleType("curriculum.exact in 80 bits")
    exec(compile(ast.fix_missing_locations(tree), str(path), "exec"), vars(made))
    made.math, made.np = precise_math(), precise_numpy()
    made.later, made.seconds = later, seconds
    made.EVENTS *= LONGER

    class Motion(made.Motion):
        """The motion of a run, noted as `running`, so that it can be read before its end."""

        def __init__(self, *args):
            super().__init__(*args)
            made.running = self

    made.Motion = Motion
    return made


def so_far(times):
    """q and v of the last run at those of its samples `times` that it has passed."""
    motion = module().running
    done = min(motion.samples, len(times))
    for ball in motion.balls:
        ball.remember(done)
    x, y = zip(*(ball.read(np.asarray(times[:done], Number)) for ball in motion.balls))
    return tuple(np.moveaxis(np.array((x, y)), (0, 1, 2, 3), (2, 3, 0, 1)))


def simulate_exact(scene, times, gravity, report=lambda k: None):
    """As exact.simulate_exact; q and v are of np.longdouble."""
    names = ("q0", "v0", "mass", "radius")
    rows = {name: np.asarray(getattr(scene, name), Number) for name in names}
    wide = types.SimpleNamespace(**rows, restitution=Number(scene.restitution))
    times = np.asarray(times, Number)
    return module().simulate_exact(wide, times, Number(gravity), report)
