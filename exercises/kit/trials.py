"""What judges the exercises that are filled in: values beside the right ones, and balls that fall.

Nothing to fill in here, and much that gives an answer away.
"""

import math
import textwrap
from functools import partial
from unittest.mock import patch

import numpy as np

from curriculum.commands import command, near

from . import predict
from .blanks import BLANKS, solver
from .predict import contact
from .progress import practise


def row(name, function, case):
    """What comes out, as a row of numbers; None of a blank. Raises ValueError, in words."""
    try:
        got = BLANKS[name].run(function, case)
    except Exception as error:
        raise ValueError(f"{name} raised {type(error).__name__}: {error}") from None
    if got is ... or (isinstance(got, tuple) and any(part is ... for part in got)):
        return None
    try:
        if got is None or isinstance(got, str):  # which numpy would take for a number
            raise TypeError
        return np.asarray(got, float).ravel()
    except (TypeError, ValueError):
        raise ValueError(f"{name} returned {got!r:.60}, and not numbers") from None


def agree(got, right, within):
    """Whether two rows of numbers agree within that share of their size."""
    allowed = within * np.abs(right).max() + 1e-14
    return got.shape == right.shape and bool((np.abs(got - right) <= allowed).all())


def slip(name, found):
    """What probably went wrong, from the wrong values on all inputs."""
    for function, meaning in BLANKS[name].slips:
        values = [row(name, function, case) for case in BLANKS[name].inputs]
        if all(
            agree(np.nan_to_num(got), np.nan_to_num(value), 1e-3)
            for got, value in zip(found, values)
        ):
            return meaning
    return "a slip that this list does not know"


@np.errstate(all="ignore")
def judge(exercise, name):
    """("blank", "wrong" or "right", why in words): a learner's function on all inputs."""
    blank, function = BLANKS[name], getattr(exercise, name)
    try:
        found = [row(name, function, case) for case in blank.inputs]
    except ValueError as error:
        return "wrong", str(error)
    if any(got is None for got in found):
        return "blank", (
            f"{name} is still a blank: fill it in {near(exercise.__file__)}; "
            f"--hint {blank.hint} asks a question that helps"
        )
    expected = [row(name, blank.right, case) for case in blank.inputs]
    wrong = [
        each for each in zip(blank.inputs, found, expected) if not agree(*each[1:], blank.within)
    ]
    if not wrong:
        return "right", ""
    case, *rows = wrong[0]
    given = ", ".join(f"{key}={np.round(value, 6).tolist()}" for key, value in case.items())
    got, right = (" ".join(f"{value:.6g}" for value in each) for each in rows)
    script = command(exercise.__file__, "--hint", blank.hint)
    return "wrong", "\n".join(
        [
            f"{name}({given})",
            f"  got       {got}",
            f"  expected  {right}",
            *blank.legend,
            f"  wrong on {len(wrong)} of {len(found)} inputs, of which this is the first",
            f"  likely: {slip(name, found)}",
            f"  where to look: the signs at the top of contact.py, or {script}",
        ]
    )


# What the fills do to balls


def pressed():
    """A ball is pressed into the table and let go: how high it jumps."""
    of = contact.build_scene("drop", damping=60.0)._replace(q0=np.array([[0.0], [0.07]]))
    run = contact.run_model("penalty", of, 0.001, 1000, contact.Settings(stiffness=8e3))
    return run.q[:, 1].max() / 0.1 - 1.0


def thrown():
    """A ball is thrown up from the table: how high it comes."""
    of = contact.build_scene("drop")._replace(q0=np.array([[0.0], [0.1]]))
    of.v0[1] = 2.0
    return contact.run_model("lcp", of, 0.002, 600).q[:, 1].max() / 0.1 - 1.0


def groove():
    """A ball drops into the groove of two balls that are held: how far off it ends."""
    of = contact.Scene(
        "groove",
        np.array([[0.0, -0.07, 0.07], [0.6, 0.1, 0.1]]),
        np.zeros((2, 3)),
        np.array([1.0, np.inf, np.inf]),
        np.full(3, 0.1),
        0.0,
        0.0,
    )
    return abs(contact.run_model("lcp", of, 0.002, 600).q[-1, 0, 0]) / 0.1


TRIALS = {
    "penalty_normal_force": (pressed,),
    "project_impulse": (thrown, groove),
    "solve_contacts": (thrown, groove),
}


def in_place(function, name):
    """contact.py with the learner's function in place of its own, while the context lasts."""
    if name == "project_impulse":  # which contact.py writes out in its sweep
        name, function = "solve_contacts", solver(total="project(c.lam, add)", project=function)
    return patch.object(contact, name, function)


def compare(function, name):
    """The trials of a blank, the learner's beside contact.py's."""
    rows = {}
    for trial in TRIALS[name]:
        with in_place(function, name):
            rows[trial.__doc__] = [trial()]
        rows[trial.__doc__].append(trial())
    return predict.columns("lengths in ball radii", ("yours", "contact.py"), rows, "{:.3f}")


def cliffs(longest_step, _):
    """The longest steps that the learner found, beside two formulas."""
    rows = {
        f"k {k:g}, c {c:g}": (
            longest_step(1.0, k, c),
            contact.critical_dt(1.0, k, c),
            2.0 / math.sqrt(k),
        )
        for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0))
    }
    heads = "yours", "critical_dt", "2 sqrt(m / k)"
    return (
        predict.columns("longest step", heads, rows, "{:.5f} s") + "\ncritical_dt solves "
        "k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer."
    )


def drops(spring, _):
    """What the drop does under the learner's spring and under penalty, at longer steps."""
    from curriculum.implicit import implicit_step

    of, rows = contact.build_scene("drop"), {}
    for dt in (0.002, 0.008, 0.016, 0.064):
        step = partial(
            implicit_step, dt=dt, spring=lambda depth, dt=dt: spring(depth, 1e4, 80.0, dt)
        )
        found = [
            contact.contact_quality(run, of, dt)
            for run in (
                contact.simulate_faster(step, of, dt, int(8.0 / dt)),
                contact.run_model("penalty", of, dt, int(8.0 / dt)),
            )
        ]
        rows[f"dt {dt:.3f} s"] = [
            quality[key] for key in ("energy_excess", "rest_penetration_frac") for quality in found
        ]
    heads = "gain, yours", "gain, penalty", "rests, yours", "rests, penalty"
    return predict.columns("energy, depth", heads, rows, "{:.5g}")


SHOWN = {**dict.fromkeys(TRIALS, compare), "longest_step": cliffs, "implicit_spring": drops}


# Exercise 8


def fingers(exercise):
    """What the choice of exercise 8 does to the cup: {name: number}, lengths in r."""
    dt, radius = exercise.DT, np.full(3, 0.1)
    of = contact.Scene(
        "fingers",
        np.array([[-0.205, 0.0, 0.205], [0.1, 0.1, 0.1]]),
        np.zeros((2, 3)),
        np.array([0.2, 1.0, 0.2]),
        radius,
        0.0,
        0.0,
    )
    solref, solimp = contact.soft_defaults(0.0, dt, exercise.SOLREF, exercise.SOLIMP)

    def step(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):  # the motors [N]
            ball.fx, ball.fy = force, 0.0
        if exercise.MODEL == "soft":
            return contact.soft_step(balls, dt, solref, solimp)
        contacts = contact.detect_contacts(balls, margin=0.0)
        contact.penalty_force(contacts, exercise.STIFFNESS, exercise.DAMPING)
        contact.accelerate(balls, dt)
        contact.move(balls, dt)

    run = contact.simulate(step, of, dt, math.ceil(1.0 / dt - 1e-9))
    with np.errstate(all="ignore"):
        depth = np.maximum(-contact.smallest_gap(run.q, radius) / 0.1, 0.0)[3 * len(run.q) // 4 :]
        return {
            "deepest": depth.max(),
            "trembling": np.ptp(depth),
            "steps": len(run.q) - 1,
            "held": bool((np.abs(run.q[-1, 0]) < 0.3).all()),
        }


def judge_fingers(exercise):
    """("blank", "wrong" or "right", why in words): the choice of exercise 8."""
    model, k = exercise.MODEL, exercise.STIFFNESS
    if model is None:
        return "blank", (
            f'no choice yet: set MODEL in {near(exercise.__file__)} to "penalty" '
            'or "soft", and then its numbers; --hint 1 asks a question that helps'
        )
    try:
        if model not in ("penalty", "soft") or not 1e-5 <= exercise.DT <= 0.1 or not k > 0.0:
            raise ValueError(
                "allowed: MODEL 'penalty' or 'soft', DT from 0.00001 to 0.1 s, STIFFNESS above 0"
            )
        seen = fingers(exercise)
    except Exception as error:
        return "wrong", f"the fingers cannot be run with {model!r}, {exercise.DT!r} s: {error}"
    print("overlap {deepest:.2g} r, trembling {trembling:.2g} r, {steps} steps".format(**seen))
    faults = [
        words
        for words, wrong in (
            ("it takes more than 2,000 steps", seen["steps"] > 2000),
            ("the cup is gone: the fingers flew off or went through it", not seen["held"]),
            ("it trembles", seen["held"] and not seen["trembling"] < 1e-5),
            ("it overlaps too much", seen["held"] and not seen["deepest"] < 1e-3),
        )
        if wrong
    ]
    if not faults:
        return "right", ""
    advice = (
        "a shorter time constant (at least two steps) stiffens soft, and a higher impedance "
        "lets less of the squeeze through"
    )
    if model == "penalty":
        advice = (
            f"20 N press a spring of {k:g} N/m in by {200.0 / k:.2g} r, and a finger on it "
            f"wants steps below {contact.critical_dt(0.1, k, exercise.DAMPING):.1g} s"
        )
    return "wrong", f"{', and '.join(faults)}; {advice}"


# A whole exercise


def judged(name, exercise):
    """The state of an exercise, and (what, state, words) of everything that it asks for."""
    found = [(blank, *judge(exercise, blank)) for blank in BLANKS if BLANKS[blank].exercise == name]
    if name == "ex8":
        found = [("two_fingers", *judge_fingers(exercise))]
    states = [state for _, state, _ in found]
    state = next((each for each in ("wrong", "blank") if each in states), "right")
    predict.note(name, "done" if state == "right" else None)
    return state, found


def show(function, name):
    """Print what a fill does to balls, also one that is wrong: to see is to know why."""
    try:
        if name in SHOWN:
            print(SHOWN[name](function, name))
    except Exception as error:
        print(f"the trial stopped: {type(error).__name__}: {error}")


def fill(name, exercise):
    """Judge what is filled and try it. Exit status: 0 right, 1 wrong, 2 not filled yet."""
    state, found = judged(name, exercise)
    for what, each, words in found:
        function = getattr(exercise, what, None)
        if each == "blank" and function:
            print(textwrap.fill(f"{what}: {' '.join(function.__doc__.split())}", 96))
        elif function:
            show(function, what)
        print(words or f"{what} is right", flush=True)
    if state == "right":
        print(f"\n{practise()}")
    return ("right", "wrong", "blank").index(state)
