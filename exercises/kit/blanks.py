"""The blanks: how each is tried, what belongs in it, and the slips that are seen most.

A fill is judged by what it gives on all inputs, beside what the right one gives; a wrong one is
named by the slip that gives the same. Nothing to fill in here, and much that gives an answer away.
"""

import math
import random
from collections.abc import Callable
from math import sqrt  # noqa: F401  expressions below use it
from typing import NamedTuple

from .predict import contact


class Blank(NamedTuple):
    """A function that a learner writes."""

    exercise: str
    hint: int  # the first that helps
    inputs: list  # [{argument: value}]
    right: Callable
    slips: list  # [(a function that makes it, what it means)]
    within: float = 1e-9  # what counts as equal, as a share of the size of what is right
    run: Callable = lambda function, case: function(*case.values())
    legend: tuple = ()  # how to read what goes in and comes out


def drawn(*first, **ranges):
    """Inputs: the first ones as given, then random ones. A range that begins above 0 is drawn by
    powers."""
    draw, inputs = random.Random(35), [dict(zip(ranges, values)) for values in first]
    for _ in range(60):
        inputs.append(
            {
                name: low * (high / low) ** draw.random() if low > 0.0 else draw.uniform(low, high)
                for name, (low, high) in ranges.items()
            }
        )
    return inputs


def table(names, right, slips):
    """The right function and the slips of a blank with these arguments, from expressions."""
    made = [
        eval(f"lambda {names}: {text}", globals())  # noqa: S307  our own text
        for text in (right, *slips)
    ]
    return {"right": made[0], "slips": list(zip(made[1:], slips.values()))}


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
    return lambda contacts, iters: exec(  # noqa: S102
        code, names | {"contacts": contacts, "iters": iters}
    )


def stacks():
    """Inputs of exercise 5: stacks of 1 to 5 balls, the lowest in a groove or on a floor.

    Masses [kg], velocities (x, y) [m/s]; of each contact the upper ball, the lower one (-1: the
    floor), the normal's angle from the vertical [rad] and the target [m/s].
    """
    draw, inputs = random.Random(35), []
    for count in (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5):
        pairs = [(k, k - 1, draw.uniform(-0.5, 0.5)) for k in range(count)]
        pairs += [(0, -1, draw.uniform(0.6, 0.9))] if len(inputs) % 3 else []
        inputs.append(
            {
                "masses": [draw.uniform(0.6, 1.6) for _ in range(count)],
                "speeds": [
                    (draw.uniform(-0.5, 0.5), draw.uniform(-1.0, 0.5)) for _ in range(count)
                ],
                "contacts": [(*pair, draw.uniform(-0.3, 0.4)) for pair in pairs],
            }
        )
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


# fmt: off
PULLS = "nothing keeps the table from pulling"
SPRING = "1 / (k * dt * dt + c * dt)"
STEEL = {"mass": (0.1, 5.0), "stiffness": (500.0, 2e4), "damping": (2.0, 100.0)}
BLANKS = {
    "penalty_normal_force": Blank("ex2", 1, drawn(
        (0.01, 0.5, 5e3, 80.0), (0.001, 2.0, 5e3, 80.0), (0.01, 0.625, 5e3, 80.0),
        depth=(1e-4, 0.05), v_n=(-3.0, 3.0), stiffness=(1e2, 1e5), damping=(0.0, 300.0),
    ), **table("x, v, k, c", "max(0, k * x - c * v)", {
        "k * x - c * v": f"{PULLS}: the damper can outweigh the spring on the way out",
        "k * x + c * v": f"the damper pushes along with the motion, and {PULLS}",
        "max(0, k * x + c * v)": "the damper pushes along with the motion: look up the sign of v_n",
        "max(0, k * x - c * abs(v))": "the damper takes from the push on the way in too",
        "max(0, k * x + c * abs(v))": "the damper adds to the push on the way out too",
        "max(0, k * x - c * max(0, v))": "the damper works on the way out only",
        "k * x": "the damper is missing",
        "max(0, -c * v)": "the spring is missing",
        "abs(k * x - c * v)": "a pull has been turned round into a push",
        "max(0, -k * x - c * v)": "the spring pulls: depth > 0 is an overlap",
        "max(0, 1e4 * x - 80 * v)": "numbers stand where `stiffness` and `damping` should",
    })),
    "project_impulse": Blank("ex2", 3, drawn(
        (0.0, 0.0), (0.0, 0.3), (0.2, 0.3), (0.0, -0.3), (0.2, -0.5), (0.2, -0.2),
        lam=(0.0, 2.0), dlam=(-3.0, 3.0),
    ), **table("lam, dlam", "max(0, lam + dlam)", {
        "lam + dlam": f"{PULLS}: the sum may not become negative",
        "lam + max(0, dlam)": "the clamp is on the change: what is too much stays for good",
        "max(0, dlam)": "only the last correction comes out: what was pushed before is forgotten",
        "max(0, lam - dlam)": "the correction is taken off: dlam is to be added",
        "abs(lam + dlam)": "a negative sum has been turned round into a push",
        "lam": "the correction is not used",
    })),
    "solve_contacts": Blank("ex5", 1, stacks(), contact.solve_contacts, [
        (solver(total="c.lam + max(0.0, add)"), "the clamp is on the change, and it belongs on the "
         "sum: what was pushed too much must be taken back"),
        (solver(total="c.lam + add"), "no clamp: a contact never pulls, so lam is never negative"),
        (solver("c.v_n() - c.target"), "the sign of what is missing: it is target - v_n"),
        (solver("-c.target - c.v_n()"), "the sign of the target"),
        (solver(push="c.a.vx += (lam - c.lam) * c.ax; c.a.vy += (lam - c.lam) * c.ay"),
         "the other body is forgotten: push moves both"),
        (solver(most=1), "one sweep: the neighbours that it disturbs are never mended"),
        (solver(push="c.push(lam)"), "the whole lam is pushed at each visit, and not its change"),
        (solver(total="max(0.0, add)", kept="0.0"), "c.lam does not hold the sum of corrections"),
        (solver(push=""), "lam is worked out and never pushed"),
        (solver(mass="1.0"), "m_eff is missing: an impulse is a mass times a velocity"),
    ], 1e-5, run_stack, (
        "  these are lam of every contact, then vx and vy of every ball; of a contact you see the",
        "  upper ball, the lower one (-1: the floor), the angle of its normal, and its target")),
    "step_matrix": Blank("ex6", 1, drawn(**STEEL, dt=(0.001, 0.03)), **table(
        "m, k, c, dt", "matrix(m, k, c, dt)", {
            "[[1, -dt], [dt * k / m, 1 - dt * c / m]]":
                "the depth moves with the old velocity: that is explicit Euler",
            "matrix(m, k, -c, dt)": "the sign of the damper",
            "matrix(m, -k, c, dt)": "the sign of the spring: a depth pushes up",
            "matrix(m, k, 0, dt)": "the damper is missing",
            "list(zip(*matrix(m, k, c, dt)))": "rows and columns are exchanged",
            "[row[::-1] for row in matrix(m, k, c, dt)[::-1]]":
                "the order is (v_n, depth), asked for is (depth, v_n)",
            "[[1 + dt * dt * k / m, dt - dt * dt * c / m], [dt * k / m, 1 - dt * c / m]]":
                "v_n > 0 goes out of the table, so the depth becomes smaller",
        })),
    "longest_step": Blank("ex6", 3, drawn(**STEEL)[:12], within=2e-3, **table(
        "m, k, c", "contact.critical_dt(m, k, c)", {
            "2 * sqrt(m / k)": "that is the limit without the damper",
            "(c + sqrt(c * c + 4 * k * m)) / k":
                "the damper's sign: it should bring the limit nearer",
            "sqrt(m / k)": "that is half the limit without the damper",
        })),
    "implicit_spring": Blank("ex7", 1, drawn(
        depth=(1e-4, 0.05), stiffness=(1e2, 1e6), damping=(1.0, 300.0), dt=(3e-4, 0.1),
    ), **table("x, k, c, dt", f"({SPRING}, dt * k * x * {SPRING})", {
        "(1 / (k * dt * dt), x / dt)": "the damper is missing",
        "(1 / (k * dt + c), k * x / (k * dt + c))":
            "that softness is for a force; lam is an impulse, dt times as large",
        "(k * dt * dt + c * dt, dt * k * x / (k * dt * dt + c * dt))":
            "the softness is upside down: a stiff spring is not soft",
        f"({SPRING}, dt * k * x)":
            "the target is an impulse still: the equation has to be divided as a whole",
        f"({SPRING}, x / dt)": "the target asks for the whole depth, and the damper slows that",
        f"({SPRING}, -dt * k * x * {SPRING})": "the sign of the target: an overlap should open",
        f"(dt * k * x * {SPRING}, {SPRING})": "the order: softness first, then target",
    })),
}
# fmt: on
