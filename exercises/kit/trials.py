"""What judges the exercises that are filled in: values beside the right ones, and balls that fall.

Nothing to fill in here, and much that gives an answer away.
"""

import contextlib
import io
import math
import re
import sys
import traceback
from functools import cache, partial
from pathlib import Path
from unittest import mock

import numpy as np

import contact
from curriculum.commands import near
from curriculum.implicit import implicit_step

from . import FACTS, columns
from .blanks import BLANKS, labels, run, solver


def tried(function, name, case):
    """What comes out, as numbers in their rows, None of a blank; and the lines that it printed.

    Raises ValueError, in words, for what raises and for what is no number.
    """
    said, got = io.StringIO(), None
    try:
        with contextlib.redirect_stdout(said):
            got = run(name, function, case)
        words = f"{name} returned {got!r:.60}, and not numbers"
        words += "; does it end with `return`?" if got is None else ""
    except (Exception, SystemExit) as error:
        words = f"{name} raised {said_of(error)}"
    lines = said.getvalue().splitlines()
    more = [f"  and {len(lines) - 8} lines more"] if len(lines) > 8 else []
    printed = [*(f"  printed   {line:.80}" for line in lines[:8]), *more]
    if got is ...:
        return None, printed
    try:
        if got is None or isinstance(got, str):  # which numpy would take for a number
            raise TypeError
        return np.atleast_1d(np.asarray(got, float).squeeze()), printed
    except (TypeError, ValueError):
        raise ValueError("\n".join((words, *printed))) from None


def said_of(error):
    """An error in words, with the last line of the learner's own code that it came through."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if re.fullmatch(r"ex\d+_\w+\.py", Path(frame.filename).name)]
    lines = [f"\n  line {frame.lineno}: {frame.line}" for frame in own[-1:]]
    return "".join((f"{type(error).__name__}: {error}", *lines))


def agree(got, right, within):
    """Whether two rows of numbers, NaN among them, agree within that share of their size."""
    allowed = within * np.abs(np.nan_to_num(right)).max() + 1e-14
    return got.shape == right.shape and np.allclose(got, right, 0.0, allowed, equal_nan=True)


@cache
def on_all_inputs(function, name):
    """What one of the kit's own functions gives on all inputs."""
    return [tried(function, name, case)[0] for case in BLANKS[name].inputs]


def slip(name, found, expected):
    """What probably went wrong, from the wrong values on all inputs; "" where nobody knows."""
    for function, meaning in BLANKS[name].slips:
        if all(map(partial(agree, within=1e-3), found, on_all_inputs(function, name))):
            return meaning
    if name == "longest_step":  # by a search of any kind
        if sum(agree(got, max(found), 1e-4) for got in found) > len(found) / 2:
            return FACTS["ex6"]["searches"]["same"]
        if all(0.45 < got / right < 2.1 for got, right in zip(found, expected)):
            return FACTS["ex6"]["searches"]["coarse"]
    return ""


@np.errstate(all="ignore")
def judge(exercise, name):
    """("blank", "wrong" or "right", why in words): a learner's function on all inputs."""
    blank, function, file = BLANKS[name], getattr(exercise, name, None), near(exercise.__file__)
    if not callable(function):
        return "wrong", f"{name} is no longer a function in {file}"
    try:
        found, prints = zip(*(tried(function, name, case) for case in blank.inputs))
    except ValueError as error:
        return "wrong", str(error)
    if any(got is None for got in found):
        lines = Path(exercise.__file__).read_text("utf-8").splitlines()
        first = function.__code__.co_firstlineno
        k = next((k for k in range(first, len(lines)) if "return ..." in lines[k]), first)
        return "blank", (
            f"{name} is still a blank: write what line {k + 1} of {file} returns. "
            f"The task stands at its top; --hint {blank.hint} asks a question"
        )
    expected = on_all_inputs(blank.right, name)
    cases = list(zip(blank.inputs, found, expected, prints))
    wrong = [case for case in cases if not agree(*case[1:3], blank.within)]
    if not wrong:
        said = f"{name} is right; on the first of its inputs it", *prints[0]
        return "right", "\n".join(said) if prints[0] else ""
    case, got, right, printed = min(wrong, key=lambda case: len(str(case[0])))
    ask = f"  where to look: {file} --hint {blank.hint} asks a question"
    known = slip(name, found, expected)
    return "wrong", "\n".join((
        f"{name} is wrong on {len(wrong)} of {len(found)} inputs, of which this is the smallest:",
        *failing(name, case, got, right),
        *printed,
        f"  likely: {known}" if known else ask,
    ))  # fmt: skip


def failing(name, case, got, right):
    """The lines that show what went in, and what came out beside what was expected."""
    lines = [f"  {name}({', '.join(f'{key}={value}' for key, value in case.items())})"]
    if name == "solve_contacts":
        lines.append("  (a contact: upper ball, lower ball, angle of its normal, target)")
    if got.shape != right.shape:
        there, due = (" rows of ".join(map(str, each.shape)) for each in (got, right))
        return [*lines, f"  how many numbers: got {there}, expected {due}"]
    lines.append(f"  {'':<16}{'got':>12}{'expected':>14}")
    for label, mine, other in zip(labels(name, case), got.ravel(), right.ravel()):
        mark = "" if agree(np.array([mine]), np.array([other]), 1e-3) else "   <"
        if mark or label != "1 sweep does it":
            lines.append(f"  {label:<16}{mine + 0.0:>12.5g}{other + 0.0:>14.5g}{mark}")
    return lines


# What the fills do to balls


TRIALS = {  # what is seen: model, scene, dt [s], steps, k [N/m], what is taken of the heights
    "A ball is pressed into the table and let go: how high it jumps.": (
        "penalty", contact.scene_of(0.0, 0.07, damping=60.0), 0.001, 1000, 8e3, np.max),
    "A ball is thrown up from the table: how high it is, in the mean.": (
        "lcp", contact.scene_of(0.0, 0.1, vy=2.0), 0.002, 600, 1e4, np.mean),
    "A ball drops into the groove of two that are held: how high it lies at the end.": (
        "lcp", contact.scene_of([0.0, -0.105, 0.105], [0.8, 0.1, 0.1], [1.0, math.inf, math.inf]),
        0.002, 600, 1e4, lambda heights: heights[-1]),
}  # fmt: skip


def height(trial):
    """The height of the first ball in a trial, above the table [r]."""
    model, of, dt, steps, k, of_all = TRIALS[trial]
    run = contact.run_model(model, of, dt, steps, contact.Settings(stiffness=k))
    return round(of_all(run.q[:, 1, 0]) / 0.1 - 1.0, 3) + 0.0  # and no -0.000


def compare(exercise, name):
    """Balls under the learner's function in the place of contact.py's, beside its own."""
    where, mine, (pressed, *trials) = name, getattr(exercise, name), TRIALS
    if name == "penalty_normal_force":
        trials = [pressed]
    if name == "project_impulse":  # which contact.py writes out in its sweep
        where, mine = "solve_contacts", solver("max(0.0, c.lam + add)", "f(c.lam, add)", f=mine)
    with mock.patch.object(contact, where, mine):
        yours = [height(trial) for trial in trials]
    rows = {trial: (mine, height(trial)) for trial, mine in zip(trials, yours)}
    return columns("lengths in ball radii", ("yours", "contact.py"), rows, "{:.3f}")


def cliffs(exercise, _):
    """The longest steps that the learner found, beside two formulas."""
    rows = {}
    for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0)):
        mine, formula = exercise.longest_step(1.0, k, c), contact.critical_dt(1.0, k, c)
        rows[f"k {k:g}, c {c:g}"] = mine, formula, 2.0 / math.sqrt(k)
    table = columns("longest step", ("yours", "critical_dt", "2 sqrt(m / k)"), rows, "{:.5f} s")
    return f"{table}\ncritical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer."


def drops(exercise, _):
    """What the drop does under the learner's spring and under penalty, at longer steps."""
    of, rows = contact.build_scene("drop"), {}
    for dt in (0.002, 0.008, 0.016, 0.064):
        spring = partial(exercise.implicit_spring, stiffness=1e4, damping=80.0, dt=dt)
        step, steps = partial(implicit_step, dt=dt, spring=spring), int(8.0 / dt)
        mine = contact.simulate(step, of, dt, steps, skip=True)
        runs = mine, contact.run_model("penalty", of, dt, steps)
        found = [contact.contact_quality(run, of, dt) for run in runs]
        rest = [None if q["blew_up"] else q["rest_penetration_frac"] for q in found]
        rows[f"dt {dt:.3f} s"] = [*(q["energy_excess"] for q in found), *rest]
    heads = "gain, yours", "gain, penalty", "deep, yours", "deep, penalty"
    table = columns("", heads, rows, "{:.5g}")
    said = "gain: the highest energy above the start's, as its share; deep: at the end, in r"
    return f"{table}\n{said}, and - where it flew to pieces."


def asking_twice(exercise, balls, dt, iters=20):
    """leapfrog's step for e = 0, by the two functions of exercise 10."""
    kick, _ = exercise.before_the_move(0.0, dt)
    contacts = contact.detect_contacts(balls, contact.step_reach(balls, dt))
    for c in contacts:
        c.target = exercise.before_the_move(-c.depth, dt)[1]
    contact.accelerate(balls, kick * dt)
    contact.solve_contacts(contacts, iters)
    contact.move(balls, dt)
    contact.accelerate(balls, (1.0 - kick) * dt)
    closed = []
    for c in contacts:
        x, y = (0.0, 1.0) if c.b is contact.FLOOR else (c.a.x - c.b.x, c.a.y - c.b.y)
        then, now = math.atan2(c.nx, c.ny), math.atan2(x, y)
        asked, c.target, c.lam, angle = exercise.after_the_move(c.lam, then, now)
        c.nx, c.ny = math.sin(angle), math.cos(angle)
        closed += [c] if asked else []
    contact.solve_contacts(closed, iters)


SLIDE = contact.scene_of([0.0, 0.06], [0.1, 0.1 + math.sqrt(0.04 - 0.0036)], [math.inf, 1.0])
PROBLEMS = {  # scene, dt [s], seconds
    "drop, error": (contact.build_scene("drop"), 0.002, 1.0),
    "stack, error": (contact.build_scene("stack"), 0.002, 1.0),
    "slide, error": (SLIDE, 0.002, 0.4),
    "slide, dt / 4": (SLIDE, 0.0005, 0.4),
}
INSIDE = contact.scene_of([0.0, 0.0], [0.1, 0.25])  # half a radius in one another


def ask_twice(exercise, _):
    """Errors beside exact, how high a ball comes that begins in another, the order of the slide."""

    def steps(dt):
        lcp = partial(contact.lcp_step, dt=dt, restitution=0.0, baumgarte=0.2, iters=20)
        return partial(asking_twice, exercise, dt=dt), lcp

    rows = {}
    for name, (of, dt, seconds) in PROBLEMS.items():
        count = round(seconds / dt)
        true = contact.run_model("exact", of, dt, count).q
        off = (contact.simulate(step, of, dt, count).q - true for step in steps(dt))
        rows[name] = [np.hypot(x, y).max() / 0.1 for x, y in (each.swapaxes(0, 1) for each in off)]
    orders = [math.log(max(a, 1e-16) / max(b, 1e-16), 4) for a, b in zip(*list(rows.values())[2:])]
    high = (contact.simulate(step, INSIDE, 0.002, 300).q[:, 1].max() for step in steps(0.002))
    rows["inside, height"] = [y / 0.1 for y in high]
    table = columns("in r, beside exact", ("yours", "lcp"), rows, "{:.3g}")
    order = f"The order of your slide is {orders[0]:.1f}, lcp's is {orders[1]:.1f}."
    inside = "inside: how high a ball rises that begins in another; at 3 r they only touch."
    return f"{table}\n{inside}\n{order}"


SHOWN = {  # blank: what shows it at work; of two that work together, the second
    **dict.fromkeys(("penalty_normal_force", "project_impulse", "solve_contacts"), compare),
    "longest_step": cliffs,
    "implicit_spring": drops,
    "after_the_move": ask_twice,
}


# Exercise 8


def fingers(exercise):
    """What a gripper does: its deepest overlap, how that varies [r], whether the cup is held."""
    dt, of = exercise.DT, contact.scene_of([-0.205, 0.0, 0.205], 0.1, [0.2, 1.0, 0.2])
    solref, solimp = contact.soft_defaults(0.0, dt, exercise.SOLREF, exercise.SOLIMP)
    k, c = exercise.STIFFNESS, exercise.DAMPING
    softness = 1.0 / (k * dt * dt + c * dt)

    def step(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):  # the motors [N]
            ball.fx, ball.fy = force, 0.0
        if exercise.MODEL == "soft":
            return contact.soft_step(balls, dt, solref, solimp)
        if exercise.MODEL == "implicit":
            return implicit_step(balls, dt, lambda depth: (softness, dt * k * depth * softness))
        contact.penalty_force(contact.detect_contacts(balls, margin=0.0), k, c)
        contact.accelerate(balls, dt)
        contact.move(balls, dt)

    run = contact.simulate(step, of, dt, math.ceil(1.0 / dt - 1e-9))
    with np.errstate(all="ignore"):
        depth = np.maximum(-contact.smallest_gap(run.q, of.radius) / 0.1, 0.0)
        last = depth[3 * len(depth) // 4 :]
        return last.max(), np.ptp(last), bool((np.abs(run.q[-1, 0]) < 0.3).all())


def judge_fingers(exercise):
    """("blank", "wrong" or "right", why in words, what was seen): the choice of exercise 8."""
    model, dt, k, c = exercise.MODEL, exercise.DT, exercise.STIFFNESS, exercise.DAMPING
    if model is None:
        return "blank", f"no choice yet: set MODEL in {near(exercise.__file__)}", ""
    try:
        knobs = model in ("penalty", "implicit", "soft"), 0.0005 <= dt <= 0.1, k > 0.0 <= c
        if not all(knobs) or (len(exercise.SOLREF), len(exercise.SOLIMP)) != (2, 5):
            raise ValueError
        deepest, trembling, held = fingers(exercise)
    except (TypeError, ValueError, ArithmeticError):
        given = (f"{knob} {value!r}" for knob, value in vars(exercise).items() if knob.isupper())
        allowed = "MODEL 'penalty', 'implicit' or 'soft', DT from 0.0005 s (2,000 steps) to 0.1 s, "
        allowed += "STIFFNESS above 0, DAMPING 0 or more, SOLREF two numbers, SOLIMP five"
        return "wrong", f"it cannot be run: given {', '.join(given)}; allowed: {allowed}", ""
    shown = f"overlap {deepest:.2g} r, trembling {trembling:.2g} r"
    faults = [] if trembling < 1e-5 else ["it trembles"]
    faults += [] if deepest < 1.001e-3 else ["it overlaps too much"]
    if not held:
        faults = ["the cup is gone: the fingers flew off or went through it"]
    if not faults:
        return "right", "", shown
    way = 1e3 * dt * dt  # of a finger in a step: 20 N on 0.2 kg, in r
    advice = f"20 N press a spring of {k:g} N/m in by {200.0 / k:.2g} r, and "
    if not held and way > 0.5:
        advice = f"in one step of {dt:g} s its motor carries a finger {way:.2g} r"
    elif model == "penalty":
        longest = contact.critical_dt(0.1, k, c)
        advice += f"a finger on it wants steps below {longest:.1g} s"
    elif model == "implicit":
        advice += f"it settles in about c / k = {c / k:.1g} s"
    else:
        advice = "a shorter time constant, of two steps or more, stiffens soft, so does impedance"
    return "wrong", f"{', and '.join(faults)}; {advice}", shown


# A whole exercise


def judged(name, exercise):
    """The state of an exercise, and [what, state, words, shown] of everything that it asks for."""
    if name == "ex8":
        state, *seen = judge_fingers(exercise)
        return state, [["two_fingers", state, *seen]]
    found, states = [], {"": "right"}
    for blank in (each for each in BLANKS if BLANKS[each].exercise == name):
        print(f"trying {blank}", file=sys.stderr, flush=True)
        state, words = judge(exercise, blank)
        after = BLANKS[blank].after
        if state == "wrong" and states[after] != "right":
            state, words = "blank", f"{blank} is tried once {after} is right"
        states[blank], shown = state, ""
        if "blank" not in states.values() and blank in SHOWN:
            try:  # also a wrong one: to see is to know why
                shown = SHOWN[blank](exercise, blank)
            except (Exception, SystemExit) as error:
                if state == "right":
                    words = f"a trial of {blank} stopped: {said_of(error)}"
                states[blank] = "wrong"
        found.append([blank, states[blank], words, shown])
    return min(states.values(), key=("wrong", "blank", "right").index), found
