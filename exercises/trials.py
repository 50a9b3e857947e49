"""What exercises 2, 5, 6, 7 and 8 try: inputs, the right values, and trials with balls.

Nothing to fill in here, and much that gives an answer away.
"""

import itertools
import math
import random
import textwrap
from collections.abc import Callable
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
import predict
from predict import contact
from slips import SLIPS


class Blank(NamedTuple):
    """A function that a learner writes, and how it is judged."""

    exercise: str
    cases: Callable         # () -> [{argument: value}]
    run: Callable           # (function, case) -> what comes out
    right: Callable         # (case) -> what should come out
    within: float           # of the size of what should come out
    hint: int               # the first hint that helps
    legend: tuple = ()      # how to read what went in and came out


def called(function, case):
    """The function with these arguments, in their order."""
    return function(*case.values())


def force_cases():
    """Exercise 2: any spring, damper, depth > 0 and speed; a slow and a fast way out first."""
    draw = random.Random(35)
    first = [(0.01, 0.5, 5e3, 80.0), (0.001, 2.0, 5e3, 80.0), (0.01, 0.625, 5e3, 80.0)]
    more = [(draw.uniform(1e-4, 0.05), draw.uniform(-3.0, 3.0), 10.0**draw.uniform(2.0, 5.0),
             draw.uniform(0.0, 300.0)) for _ in range(60)]
    return [dict(zip(("depth", "v_n", "stiffness", "damping"), case)) for case in first + more]


def impulse_cases():
    """Exercise 2: impulses so far, and corrections of either sign; the borders first."""
    draw = random.Random(35)
    first = [(0.0, 0.0), (0.0, 0.3), (0.2, 0.3), (0.0, -0.3), (0.2, -0.5), (0.2, -0.2)]
    more = [(draw.uniform(0.0, 2.0), draw.uniform(-3.0, 3.0)) for _ in range(60)]
    return [dict(zip(("lam", "dlam"), case)) for case in first + more]


def stack_cases():
    """Exercise 5: stacks of 1 to 5 balls, the lowest in a groove or on a floor.

    Masses [kg], velocities (x, y) [m/s]; of each contact the upper ball, the lower one (-1: the
    floor), the normal's angle from the vertical [rad] and the target [m/s].
    """
    draw, cases = random.Random(35), []
    for count in (1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5):
        pairs = [(k, k - 1, draw.uniform(-0.5, 0.5)) for k in range(count)]
        pairs += [(0, -1, draw.uniform(0.6, 0.9))] if len(cases) % 3 else []
        cases.append({"masses": [draw.uniform(0.6, 1.6) for _ in range(count)],
                      "speeds": [(draw.uniform(-0.5, 0.5), draw.uniform(-1.0, 0.5))
                                 for _ in range(count)],
                      "contacts": [(*pair, draw.uniform(-0.3, 0.4)) for pair in pairs]})
    return cases


def run_stack(function, case):
    """The impulses and the velocities that a solver leaves in a stack; ... where it is a blank."""
    floor = contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)     # one of its own
    balls = [contact.Ball(0.0, 0.1, *speed, mass, 0.1)
             for mass, speed in zip(case["masses"], case["speeds"])]
    contacts = []
    for a, b, angle, target in case["contacts"]:
        c = contact.Contact(balls[a], ([*balls, floor])[b], math.sin(angle), math.cos(angle), 0.0)
        c.target = target
        contacts.append(c)
    if function(contacts, 600) is ...:
        return ...
    return [c.lam for c in contacts] + [speed for ball in balls for speed in (ball.vx, ball.vy)]


def enumerated(case):
    """What run_stack should give, by trying all 2^n answers to: which contacts push?"""
    masses, speeds = np.repeat(case["masses"], 2), np.ravel(case["speeds"])
    targets = np.array([target for *_, target in case["contacts"]])
    jacobian = np.zeros((len(targets), len(masses)))                # v_n = jacobian @ v
    for row, (a, b, angle, _) in zip(jacobian, case["contacts"]):
        row[2 * a:2 * a + 2] = math.sin(angle), math.cos(angle)
        if b >= 0:
            row[2 * b:2 * b + 2] = -math.sin(angle), -math.cos(angle)
    delassus = jacobian / masses @ jacobian.T
    for pushing in itertools.product((True, False), repeat=len(targets)):
        rows, lam = np.flatnonzero(pushing), np.zeros(len(targets))
        missing = (targets - jacobian @ speeds)[rows]
        lam[rows] = np.linalg.solve(delassus[np.ix_(rows, rows)], missing)
        after = speeds + jacobian.T @ lam / masses
        if (lam >= 0.0).all() and (jacobian @ after >= targets - 1e-12).all():
            return [*lam, *after]
    raise ValueError(f"no answer for {case}")


def spring_cases(*names):
    """Exercise 6: springs, and steps that fit them."""
    draw = random.Random(35)
    cases = [{"mass": m, "stiffness": k, "damping": c, "dt": draw.uniform(0.1, 1.5) * (m / k)**0.5}
             for m in (1.0, 0.2, 3.0) for k in (1e4, 700.0) for c in (80.0, 5.0)]
    return [{name: case[name] for name in names or case} for case in cases]


def measured_matrix(case):
    """The matrix of contact.py's own penalty step, from two small pushes off the balance."""
    mass, stiffness, damping, dt = case.values()
    balance = -contact.GRAVITY * mass / stiffness

    def after(depth, v_n):
        ball = contact.Ball(0.0, 0.1 - balance - depth, 0.0, v_n, mass, 0.1)
        contact.penalty_step([ball], dt, stiffness, damping)
        return np.array([0.1 - balance - ball.y, ball.vy])

    depth, speed = 0.1 * balance, 0.005 * balance * math.sqrt(stiffness / mass)
    return np.column_stack([after(depth, 0.0) / depth, after(0.0, speed) / speed])


def implicit_cases():
    """Exercise 7: depths, springs, dampers and steps."""
    draw = random.Random(35)
    return [{"depth": draw.uniform(1e-4, 0.05), "stiffness": 10.0**draw.uniform(2.0, 6.0),
             "damping": draw.uniform(1.0, 300.0), "dt": 10.0**draw.uniform(-3.5, -1.0)}
            for _ in range(30)]


def implicit_right(case):
    """Softness and target, from lam = dt (k (depth - dt v_n) - c v_n), divided by what v_n has."""
    depth, stiffness, damping, dt = case.values()
    softness = 1.0 / (stiffness * dt * dt + damping * dt)
    return softness, dt * stiffness * depth * softness


BLANKS = {
    "penalty_normal_force": Blank("ex2", force_cases, called, lambda case: max(
        0.0, case["stiffness"] * case["depth"] - case["damping"] * case["v_n"]), 1e-9, 1),
    "project_impulse": Blank("ex2", impulse_cases, called,
                             lambda case: max(0.0, case["lam"] + case["dlam"]), 1e-9, 3),
    "solve_contacts": Blank("ex5", stack_cases, run_stack, enumerated, 1e-5, 1, (
        "  these are lam of every contact, then vx and vy of every ball; of a contact you see the",
        "  upper ball, the lower one (-1: the floor), the angle of its normal, and its target")),
    "step_matrix": Blank("ex6", spring_cases, called, measured_matrix, 1e-6, 1),
    "longest_step": Blank("ex6", lambda: spring_cases("mass", "stiffness", "damping"), called,
                          lambda case: contact.critical_dt(**case), 2e-3, 3),
    "implicit_spring": Blank("ex7", implicit_cases, called, implicit_right, 1e-9, 1),
}


def inputs(blank):
    """The inputs on which a blank is tried."""
    return BLANKS[blank].cases()


# Judging


def outcome(function, blank, case):
    """What comes out, as a row of numbers; None of a blank. Raises ValueError, in words."""
    try:
        with np.errstate(all="ignore"):
            got = BLANKS[blank].run(function, case)
    except Exception as error:
        raise ValueError(f"{blank} raised {type(error).__name__}: {error}") from None
    if got is ... or (isinstance(got, tuple) and any(part is ... for part in got)):
        return None
    try:
        if got is None or isinstance(got, str):     # which numpy would take for a number
            raise TypeError
        return np.asarray(got, float).ravel()
    except (TypeError, ValueError):
        raise ValueError(f"{blank} returned {got!r:.60}, and not numbers") from None


def agree(got, right, within):
    """Whether two rows of numbers agree within that share of their size."""
    with np.errstate(all="ignore"):
        allowed = within * np.abs(right).max() + 1e-14
        return got.shape == right.shape and bool((np.abs(got - right) <= allowed).all())


def slip(blank, found):
    """What probably went wrong, from the wrong values at all inputs."""
    for function, meaning in SLIPS[blank]:
        values = [outcome(function, blank, case) for case in inputs(blank)]
        if all(agree(np.nan_to_num(got), np.nan_to_num(value), 1e-3)
               for got, value in zip(found, values)):
            return meaning
    return "a slip that this list does not know"


def judge(exercise, blank):
    """("blank" or "wrong", why in words) or ("right", None): a learner's function on all inputs."""
    what, cases = BLANKS[blank], inputs(blank)
    try:
        found = [outcome(getattr(exercise, blank), blank, case) for case in cases]
    except ValueError as error:
        return "wrong", str(error)
    if any(got is None for got in found):
        return "blank", (f"{blank} is still a blank: fill it in {predict.file_of(exercise)}; "
                         f"--hint {what.hint} asks a question that helps")
    expected = [np.asarray(what.right(case), float).ravel() for case in cases]
    wrong = [k for k, pair in enumerate(zip(found, expected)) if not agree(*pair, what.within)]
    if not wrong:
        return "right", None
    first = wrong[0]
    given = ", ".join(f"{key}={np.round(value, 6).tolist()}" for key, value in cases[first].items())
    got, right = (" ".join(f"{value:.6g}" for value in row[first]) for row in (found, expected))
    script = predict.command(predict.file_of(exercise), "--hint", what.hint)
    return "wrong", "\n".join([
        f"{blank}({given})", f"  got       {got}", f"  expected  {right}", *what.legend,
        f"  wrong on {len(wrong)} of {len(found)} inputs, of which this is the first",
        f"  likely: {slip(blank, found)}",
        f"  where to look: the signs at the top of contact.py, or {script}"])


# Trials: what the fills do to balls


def lcp_heights(*centres, held=0, speed=0.0):
    """x, y over 600 steps of lcp, in radii, of balls of 1 kg at these centres [m].

    The last `held` of them stay there; the first starts upwards with that speed [m/s].
    """
    count = len(centres)
    mass = np.array([1.0] * (count - held) + [np.inf] * held)
    v0 = np.zeros((2, count))
    v0[1, 0] = speed
    of = contact.Scene("trial", np.array(centres).T, v0, mass, np.full(count, 0.1), 0.0, 0.0)
    return contact.simulate(lambda balls: contact.lcp_step(balls, 0.002, 0.0, 0.2, 40),
                            of, 0.002, 600).q / 0.1


def pressed():
    """A ball is pressed into the table and let go: how high it jumps."""
    drop = contact.build_scene("drop")
    return contact.simulate(lambda balls: contact.penalty_step(balls, 0.001, 8e3, 60.0),
                            drop._replace(q0=np.array([[0.0], [0.07]])), 0.001,
                            1000).q[:, 1].max() / 0.1 - 1.0


def thrown():
    """A ball is thrown up from the table: how high it comes."""
    return lcp_heights((0.0, 0.1), speed=2.0)[:, 1].max() - 1.0


def groove():
    """A ball drops into the groove of two balls that are held: how far off it ends."""
    return abs(lcp_heights((0.0, 0.6), (-0.07, 0.1), (0.07, 0.1), held=2)[-1, 0, 0])


TRIALS = {"penalty_normal_force": (pressed,), "project_impulse": (thrown, groove),
          "solve_contacts": (thrown, groove)}


def in_place(function, blank):
    """contact.py with the learner's function in place of its own line, while the context lasts."""
    def solve(contacts, iters, tolerance=0.0):
        if blank == "solve_contacts":
            return function(contacts, iters)
        for c in contacts * iters:
            lam = function(c.lam, (c.target - c.v_n()) * c.m_eff)
            c.push(lam - c.lam)
            c.lam = lam

    if blank == "penalty_normal_force":
        return patch.object(contact, blank, function)
    return patch.object(contact, "solve_contacts", solve)


def show_trials(function, blank):
    """Print every trial of a blank, yours beside contact.py's."""
    print(f"{'lengths in ball radii':<82}{'yours':>9}{'contact.py':>12}")
    for trial in TRIALS[blank]:
        expected = trial()
        with in_place(function, blank), np.errstate(all="ignore"):
            got = trial()
        print(f"{trial.__doc__:<82}{abs(got):>9.3f}{abs(expected):>12.3f}")


def show_cliff(longest_step):
    """Print the longest steps that the learner found beside two formulas."""
    rows = {f"k {k:g}, c {c:g}": (longest_step(1.0, k, c), contact.critical_dt(1.0, k, c),
                                  2.0 / math.sqrt(k))
            for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0))}
    print(predict.columns("longest step", ("yours", "critical_dt", "2 sqrt(m / k)"), rows,
                          "{:.5f} s"))
    print("critical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer.")


def show_spring(spring):
    """Print what the drop does under the learner's spring and under penalty, at longer steps."""
    from curriculum.text.facts import implicit_step
    of, rows = contact.build_scene("drop"), {}
    for dt in (0.002, 0.008, 0.016, 0.064):
        def step(balls, dt=dt):
            implicit_step(balls, dt, lambda depth: spring(depth, 1e4, 80.0, dt))

        found = [contact.contact_quality(run, of, dt) for run in (
            contact.simulate(step, of, dt, int(8.0 / dt)),
            contact.run_model("penalty", of, dt, int(8.0 / dt)))]
        rows[f"dt {dt:.3f} s"] = [quality[key] for key in ("energy_excess", "rest_penetration_frac")
                                  for quality in found]
    print(predict.columns("energy, depth", ("gain, yours", "gain, penalty", "rests, yours",
                                            "rests, penalty"), rows, "{:.5g}"))


# Exercise 8


def fingers(exercise):
    """What the choice of exercise 8 does to the cup: {name: number}, lengths in r."""
    dt, radius = exercise.DT, np.full(3, 0.1)
    of = contact.Scene("fingers", np.array([[-0.205, 0.0, 0.205], [0.1, 0.1, 0.1]]),
                       np.zeros((2, 3)), np.array([0.2, 1.0, 0.2]), radius, 0.0, 0.0)
    solref, solimp = contact.soft_defaults(0.0, dt, exercise.SOLREF, exercise.SOLIMP)

    def step(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):      # the motors [N]
            ball.fx, ball.fy = force, 0.0
        if exercise.MODEL == "soft":
            return contact.soft_step(balls, dt, solref, solimp)
        contacts = contact.detect_contacts(balls, margin=0.0)
        contact.penalty_force(contacts, exercise.STIFFNESS, exercise.DAMPING)
        contact.accelerate(balls, dt)
        contact.move(balls, dt)

    run = contact.simulate(step, of, dt, math.ceil(1.0 / dt - 1e-9), skip=False)
    with np.errstate(all="ignore"):
        depth = np.maximum(-contact.smallest_gap(run.q, radius) / 0.1, 0.0)[3 * len(run.q) // 4:]
        return {"deepest": depth.max(), "trembling": np.ptp(depth), "steps": len(run.q) - 1,
                "held": bool((np.abs(run.q[-1, 0]) < 0.3).all())}


def judge_fingers(exercise):
    """("blank" or "wrong", why in words) or ("right", None): the choice of exercise 8."""
    model, k = exercise.MODEL, exercise.STIFFNESS
    if model is None:
        return "blank", (f"no choice yet: set MODEL in {predict.file_of(exercise)} to \"penalty\" "
                         "or \"soft\", and then its numbers; --hint 1 asks a question that helps")
    try:
        if model not in ("penalty", "soft") or not 1e-5 <= exercise.DT <= 0.1 or not k > 0.0:
            raise ValueError("allowed: MODEL 'penalty' or 'soft', DT from 0.00001 to 0.1 s, "
                             "STIFFNESS above 0")
        seen = fingers(exercise)
    except Exception as error:
        return "wrong", f"the fingers cannot be run with {model!r}, {exercise.DT!r} s: {error}"
    print("overlap {deepest:.2g} r, trembling {trembling:.2g} r, {steps} steps".format(**seen))
    faults = [words for words, wrong in (
        ("it takes more than 2,000 steps", seen["steps"] > 2000),
        ("the cup is gone: the fingers flew off or went through it", not seen["held"]),
        ("it trembles", seen["held"] and not seen["trembling"] < 1e-5),
        ("it overlaps too much", seen["held"] and not seen["deepest"] < 1e-3)) if wrong]
    if not faults:
        return "right", None
    advice = ("a shorter time constant (at least two steps) stiffens soft, and a higher impedance "
              "lets less of the squeeze through")
    if model == "penalty":
        advice = (f"20 N press a spring of {k:g} N/m in by {200.0 / k:.2g} r, and a finger on it "
                  f"wants steps below {contact.critical_dt(0.1, k, exercise.DAMPING):.1g} s")
    return "wrong", f"{', and '.join(faults)}; {advice}"


# The scripts


def judged(name, exercise):
    """[(what, state, words)] of everything that the exercise asks for."""
    if name == "ex8":
        return [("two_fingers", *judge_fingers(exercise))]
    return [(blank, *judge(exercise, blank)) for blank in BLANKS if BLANKS[blank].exercise == name]


def show(function, blank):
    """Print the trials of what is filled, also of what is wrong: to see is to know why."""
    try:
        if blank in TRIALS:
            show_trials(function, blank)
        elif blank == "longest_step":
            show_cliff(function)
        elif blank == "implicit_spring":
            show_spring(function)
    except Exception as error:
        print(f"the trial stopped: {type(error).__name__}: {error}")


def fill(name, exercise):
    """Judge what is filled and try it. Exit status: 0 right, 1 wrong, 2 not filled yet."""
    found = judged(name, exercise)
    for what, state, words in found:
        function = getattr(exercise, what, None)
        if state == "blank" and function:
            print(textwrap.fill(f"{what}: {' '.join(function.__doc__.split())}", 96))
        elif function:
            show(function, what)
        print(f"{what} is right" if state == "right" else words, flush=True)
    states = {state for _, state, _ in found}
    predict.note(name, "done" if states == {"right"} else None)
    if states == {"right"}:
        print(f"\n{predict.follow_up()}")
    return 0 if states == {"right"} else 1 if "wrong" in states else 2
