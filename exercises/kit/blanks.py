"""The blanks: how each is tried, and what belongs in it. Much here gives an answer away.

A fill is judged by what it gives on all inputs, beside what the right one gives; a wrong one is
named by the slip of answers.json that gives the same.
"""

import math
import random
from collections.abc import Callable
from math import sqrt  # noqa: F401  expressions of answers.json use it
from typing import NamedTuple

import numpy as np

import contact

from . import FACTS


class Blank(NamedTuple):
    """A function that a learner writes."""

    exercise: str
    inputs: list  # [{argument: value}]
    right: Callable
    slips: list  # [(a function that makes it, what it means)]
    hint: int  # the first that helps
    within: float = 1e-9  # what counts as equal, as a share of the size of what is right
    after: str = ""  # the blank that this one is built on
    labels: list = []  # of the numbers that come out


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


def matrix(m, k, c, dt):
    """The right matrix of exercise 6, which most slips of it change in one place."""
    slowed = 1.0 - dt * c / m
    return [[1.0 - dt * dt * k / m, -dt * slowed], [dt * k / m, slowed]]


def solver(
    missing="c.target - c.v_n()",
    total="max(0.0, c.lam + add)",
    mass="c.m_eff",
    push="c.push(lam - c.lam)",
    count="iters",
    kept="lam",
    **names,
):
    """A solve_contacts with one of its parts exchanged; `names` are what the parts may use."""
    lines = (
        f"for _ in range({count}):",
        " for c in contacts:",
        f"  add = ({missing}) * {mass}",
        f"  lam = {total}",
        f"  {push}",
        f"  c.lam = {kept}",
    )
    code = compile("\n".join(lines), "a solve_contacts", "exec")
    return lambda contacts, iters: exec(code, names | {"contacts": contacts, "iters": iters})


def jacobi(contacts, iters):
    """A solve_contacts that pushes nothing before it has looked at every contact."""
    for _ in range(iters):
        wanted = [max(0.0, c.lam + (c.target - c.v_n()) * c.m_eff) for c in contacts]
        for c, lam in zip(contacts, wanted):
            c.push(lam - c.lam)
            c.lam = lam


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


def stack(masses, speeds, contacts):
    """The balls and the contacts of a stack."""
    balls = [contact.Ball(0.0, 0.1, *speed, mass, 0.1) for mass, speed in zip(masses, speeds)]
    floor, made = contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0), []  # one of its own
    for a, b, angle, target in contacts:
        c = contact.Contact(balls[a], [*balls, floor][b], math.sin(angle), math.cos(angle), 0.0)
        c.target = target
        made.append(c)
    return balls, made


def run_stack(function, **case):
    """The impulses and the velocities that a solver leaves; ... where it is a blank.

    The last number is 1 where a stack of four or more is done by `iters` = 1: so soon is none.
    """
    (balls, made), (_, early) = stack(**case), stack(**case)
    if function(made, 600) is ...:
        return ...
    function(early, 1)
    found = [c.lam for c in made]
    soon = len(found) > 3 and np.allclose([c.lam for c in early], found, 1e-5, 1e-9)
    return [*found, *(speed for ball in balls for speed in (ball.vx, ball.vy)), float(soon)]


def run_after(function, **case):
    """What after_the_move gives; whether a contact is asked is what Python takes for a yes."""
    got = function(*case.values())
    return (bool(got[0]), *got[1:]) if isinstance(got, (tuple, list)) else got


# the others are called as they are
RUN = {"solve_contacts": run_stack, "after_the_move": run_after}


def run(name, function, case):
    """What a fill gives on one of its inputs."""
    return RUN[name](function, **case) if name in RUN else function(*case.values())


def labels(name, case):
    """What the numbers are that come out."""
    if name != "solve_contacts":
        return BLANKS[name].labels
    lam = [f"lam, {a} on {'floor' if b < 0 else b}" for a, b, _, _ in case["contacts"]]
    speeds = [f"{v} of {ball}" for ball in range(len(case["masses"])) for v in ("vx", "vy")]
    return [*lam, *speeds, "done by 1 sweep"]


def blank(exercise, right, slips, inputs=None, arguments="", **more):
    """A Blank from what answers.json says of it, where functions are expressions."""
    head = f"lambda {arguments}: " if arguments else ""
    right, *wrong = (eval(head + text, globals()) for text in (right, *slips))  # our own text
    cases = drawn(**inputs) if inputs else stacks()
    return Blank(exercise, cases, right, list(zip(wrong, slips.values())), **more)


BLANKS = {
    name: blank(exercise, **facts)
    for exercise, each in FACTS.items()
    for name, facts in each.get("blanks", {}).items()
}
