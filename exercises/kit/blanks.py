"""The blanks: how each is tried, and what belongs in it. Much here gives an answer away.

A fill is judged by what it gives on all inputs, beside what the right one gives; a wrong one is
named by the slip of answers.json that gives the same.
"""

import math
import random
from collections.abc import Callable
from math import inf, sqrt  # noqa: F401  expressions of answers.json use them
from typing import NamedTuple

from .predict import FACTS, contact


class Blank(NamedTuple):
    """A function that a learner writes."""

    exercise: str
    hint: int  # the first that helps
    inputs: list  # [{argument: value}]
    right: Callable
    slips: list  # [(a function that makes it, what it means)]
    within: float = 1e-9  # what counts as equal, as a share of the size of what is right
    run: Callable = lambda function, case: function(*case.values())
    labels: Callable = lambda case: ("",)  # of the numbers that come out
    after: str = ""  # the blank that this one is built on


def drawn(*first, **ranges):
    """Inputs: the first ones as given, then random ones of two digits. A range that begins above 0
    is drawn by powers."""
    draw, inputs = random.Random(35), [dict(zip(ranges, values)) for values in first]
    for _ in range(60):
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
    most=10**9,
    kept="lam",
    **names,
):
    """A solve_contacts with one of its parts exchanged; `names` are what the parts may use."""
    lines = (
        f"for _ in range(min({most}, iters)):",
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


def run_stack(function, case):
    """The impulses and the velocities that a solver leaves in a stack; ... where it is a blank."""
    balls = [
        contact.Ball(0.0, 0.1, *speed, mass, 0.1)
        for mass, speed in zip(case["masses"], case["speeds"])
    ]
    floor, contacts = contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0), []  # one of its own
    for a, b, angle, target in case["contacts"]:
        c = contact.Contact(balls[a], [*balls, floor][b], math.sin(angle), math.cos(angle), 0.0)
        c.target = target
        contacts.append(c)
    if function(contacts, 600) is ...:
        return ...
    return [c.lam for c in contacts] + [speed for ball in balls for speed in (ball.vx, ball.vy)]


def label_stack(case):
    """What the numbers of run_stack are."""
    lam = [f"lam, {a} on {'floor' if b < 0 else b}" for a, b, _, _ in case["contacts"]]
    return [*lam, *(f"{v} of {ball}" for ball in range(len(case["masses"])) for v in ("vx", "vy"))]


def run_reach(function, case):
    """What exercise 10 calls far enough: any reach that misses nothing and is not much longer."""
    got, (v, dt) = function(*case.values()), case.values()
    usual, least = 2 * dt * (v + 9.81 * dt), max(2 * dt * v, dt * (v + 9.81 * dt))
    try:
        return usual if 0.999999 * least <= got <= max(4.0 * usual, 2e-3) else got
    except TypeError:
        return got  # no number: said elsewhere


def fills(exercise, blank, names, right):
    """The right function and the slips of a blank with these arguments, from expressions."""
    head = f"lambda {names}: " if names else ""
    slips = FACTS[exercise]["slips"][blank]
    made = [eval(head + text, globals()) for text in (right, *slips)]  # our own text
    return {"right": made[0], "slips": list(zip(made[1:], slips.values()))}


# fmt: off
STEEL = {"mass": (0.1, 5.0), "stiffness": (500.0, 2e4), "damping": (2.0, 100.0)}
SPRING = "1 / (k * dt * dt + c * dt)"
BLANKS = {
    "penalty_normal_force": Blank("ex2", 1, drawn(
        (0.01, 0.5, 5e3, 80.0), (0.001, 2.0, 5e3, 80.0), (0.01, 0.625, 5e3, 80.0),
        depth=(1e-4, 0.05), v_n=(-3.0, 3.0), stiffness=(1e2, 1e5), damping=(0.0, 300.0)),
        **fills("ex2", "penalty_normal_force", "x, v, k, c", "max(0, k * x - c * v)"),
        labels=lambda case: ("force [N]",)),
    "project_impulse": Blank("ex2", 3, drawn(
        (0.0, 0.0), (0.0, 0.3), (0.2, 0.3), (0.0, -0.3), (0.2, -0.5), (0.2, -0.2),
        lam=(0.0, 2.0), dlam=(-3.0, 3.0)),
        **fills("ex2", "project_impulse", "lam, dlam", "max(0, lam + dlam)"),
        labels=lambda case: ("impulse [N s]",)),
    "solve_contacts": Blank("ex5", 1, stacks(),
        **fills("ex5", "solve_contacts", "", "contact.solve_contacts"),
        within=1e-5, run=run_stack, labels=label_stack),
    "step_matrix": Blank("ex6", 1, drawn(**STEEL, dt=(0.001, 0.03)),
        **fills("ex6", "step_matrix", "m, k, c, dt", "matrix(m, k, c, dt)"),
        labels=lambda case: ("row 1, depth", "row 1, v_n", "row 2, depth", "row 2, v_n")),
    "longest_step": Blank("ex6", 3, drawn(**STEEL)[:12], within=2e-3, after="step_matrix",
        **fills("ex6", "longest_step", "m, k, c", "contact.critical_dt(m, k, c)"),
        labels=lambda case: ("step [s]",)),
    "implicit_spring": Blank("ex7", 1, drawn(
        depth=(1e-4, 0.05), stiffness=(1e2, 1e6), damping=(1.0, 300.0), dt=(3e-4, 0.1)),
        **fills("ex7", "implicit_spring", "x, k, c, dt", f"({SPRING}, dt * k * x * {SPRING})"),
        labels=lambda case: ("softness", "target")),
    "how_far": Blank("ex10", 1, drawn(
        (0.0, 0.002), (0.01, 0.002), (5.0, 0.002), fastest=(1e-3, 10.0), dt=(5e-4, 0.02)),
        **fills("ex10", "how_far", "v, dt", "2 * dt * (v + dt * 9.81)"),
        run=run_reach, labels=lambda case: ("distance [m]",)),
    "least_speed": Blank("ex10", 3, drawn(
        (0.01, 0.2, 0.002), (-0.01, 0.2, 0.002), (0.0, 0.2, 0.002),
        depth=(-0.05, 0.05), baumgarte=(0.05, 0.9), dt=(5e-4, 0.02)),
        **fills("ex10", "least_speed", "x, b, dt", "(b if x > 0 else 1) * x / dt"),
        labels=lambda case: ("v_n [m/s]",)),
    "applies": Blank("ex10", 5, [{"restitution": e} for e in (0.0, 0.5, 0.7, 1.0)],
        **fills("ex10", "applies", "e", "e == 0"), labels=lambda case: ("1 yes, 0 no",)),
}
# fmt: on
