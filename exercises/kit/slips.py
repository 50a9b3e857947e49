"""The functions that a learner writes: inputs, what is right, and slips by what they give."""

import inspect
import math
import random
from math import inf, sqrt  # noqa: F401  expressions of answers.json use them

import numpy as np

import contact

from . import FACTS, ROOT, load

RIGHT = {path.stem: load(path) for path in (ROOT / "exercises/solutions").glob("ex*.py")}
matrix = RIGHT["ex6"].step_matrix  # which most slips of it change in one place
hits = RIGHT["ex10"].time_to_impact


class Blank:
    """A function that a learner writes; slips are [(a function that makes it, what it means)].

    hint: the first that helps. within: what counts as equal, as a share of the size of what is
    right. after: the blank that this one is built on. labels: of the numbers that come out.
    """

    def __init__(self, exercise, name, slips, inputs=None, arguments="", **more):
        self.exercise, self.right = exercise, getattr(RIGHT[exercise], name)
        self.inputs = drawn(**inputs) if inputs else stacks()  # [{argument: value}]
        head = f"lambda {arguments}: " if arguments else ""
        self.slips = [(eval(head + text, globals()), why) for text, why in slips.items()]  # ours
        vars(self).update({"within": 1e-9, "after": "", "labels": []} | more)


def drawn(ranges, first=(), most=60):
    """Inputs: the first ones as given, then random ones of two digits. A range that begins above 0
    is drawn by powers."""
    draw, inputs = random.Random(35), [dict(zip(ranges, values)) for values in first]
    for _ in range(most):
        made = {
            name: low * (high / low) ** draw.random() if low > 0.0 else draw.uniform(low, high)
            for name, (low, high) in ranges.items()
        }
        inputs.append({name: float(f"{value:.2g}") for name, value in made.items()})
    return inputs


def solver(*changes, **names):
    """The right solve_contacts, with (old, new) exchanged; `names` are what it may use."""
    text = inspect.getsource(RIGHT["ex5"].solve_contacts)
    for old, new in zip(changes[::2], changes[1::2]):
        text = text.replace(old, new)
    exec(text, names)
    return names["solve_contacts"]


def stacks():
    """Inputs of exercise 5: stacks of 1 to 5 balls, the lowest in a groove or on a floor.

    Masses [kg], velocities (x, y) [m/s]; of each contact the upper ball, the lower one (-1: the
    floor), the normal's angle from the vertical [rad] and the target [m/s].
    """
    draw, inputs = random.Random(35), []

    def some(low, high):
        return round(draw.uniform(low, high), 2)

    for count in (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5):
        pairs = [(k, k - 1, some(-0.5, 0.5)) for k in range(count)]
        pairs += [(0, -1, some(0.6, 0.9))] if len(inputs) % 3 else []
        masses = [some(0.6, 1.6) for _ in range(count)]
        speeds = [(some(-0.5, 0.5), some(-1.0, 0.5)) for _ in range(count)]
        contacts = [(*pair, some(-0.3, 0.4)) for pair in pairs]
        inputs.append({"masses": masses, "speeds": speeds, "contacts": contacts})
    return inputs


def run_stack(function, masses, speeds, contacts):
    """The impulses and the velocities that a solver leaves; ... where it is a blank.

    The last number is 1 where a stack of four or more is done by `iters` = 1: so soon is none.
    """
    lams = []
    for iters in (1, 600):
        balls = [contact.Ball(0.0, 0.1, *speed, mass, 0.1) for mass, speed in zip(masses, speeds)]
        bodies, made = [*balls, contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)], []
        for a, b, angle, target in contacts:  # -1 is the last of bodies, the floor
            c = contact.Contact(bodies[a], bodies[b], math.sin(angle), math.cos(angle), 0.0)
            c.target = target
            made.append(c)
        if function(made, iters) is ...:
            return ...
        lams.append([c.lam for c in made])
    soon = len(made) > 3 and np.allclose(*lams, 1e-5, 1e-9)
    return [*lams[-1], *(speed for ball in balls for speed in (ball.vx, ball.vy)), float(soon)]


def run(name, function, case):
    """What a fill gives on one of its inputs; whether a contact is asked is Python's yes or no."""
    if name == "solve_contacts":
        return run_stack(function, **case)
    got = function(*case.values())
    if name == "after_the_move" and isinstance(got, (tuple, list)):
        return (bool(got[0]), *got[1:])
    return got


def labels(name, case):
    """What the numbers are that come out."""
    if name != "solve_contacts":
        return BLANKS[name].labels
    lam = [f"lam, {a} on {'floor' if b < 0 else b}" for a, b, _, _ in case["contacts"]]
    speeds = [f"{v} of {ball}" for ball in range(len(case["masses"])) for v in ("vx", "vy")]
    return [*lam, *speeds, "1 sweep does it"]


BLANKS = {
    name: Blank(exercise, name, **facts)
    for exercise, each in FACTS.items()
    for name, facts in each.get("blanks", {}).items()
}
