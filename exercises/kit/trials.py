"""What judges the exercises that are filled in: values beside the right ones, and balls that fall.

Nothing to fill in here, and much that gives an answer away.
"""

import contextlib
import io
import math
import sys
import traceback
from functools import cache, partial
from pathlib import Path

import numpy as np

import contact
from curriculum.commands import near

from . import columns
from .blanks import BLANKS, labels, run, solver


def row(name, function, case):
    """What comes out, as numbers in their rows; None of a blank. Raises ValueError, in words."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            got = run(name, function, case)
    except (Exception, SystemExit) as error:
        words = f"{name} raised {type(error).__name__}: {error}{where(error, function)}"
        raise ValueError("\n".join((words, *printed(said)))) from None
    if got is ... or (isinstance(got, tuple) and any(part is ... for part in got)):
        return None
    try:
        if got is None or isinstance(got, str):  # which numpy would take for a number
            raise TypeError
        return np.atleast_1d(np.asarray(got, float).squeeze())
    except (TypeError, ValueError):
        end = "; does it end with `return`?" if got is None else ""
        raise ValueError(f"{name} returned {got!r:.60}, and not numbers{end}") from None


def where(error, function):
    """The line of the learner's own code that an error came from, with its text."""
    frames = traceback.extract_tb(error.__traceback__)
    file = function.__code__.co_filename if hasattr(function, "__code__") else None
    lines = [f"\n  line {each.lineno}: {each.line}" for each in frames if each.filename == file]
    return "".join(lines[-1:])


def printed(said):
    """What a learner's code printed, as lines of a report."""
    lines = said.getvalue().splitlines()
    more = [f"  and {len(lines) - 8} lines more"] if len(lines) > 8 else []
    return [*(f"  printed   {line:.80}" for line in lines[:8]), *more]


def agree(got, right, within):
    """Whether two rows of numbers agree within that share of their size."""
    allowed = within * np.abs(right).max() + 1e-14
    return got.shape == right.shape and bool((np.abs(got - right) <= allowed).all())


@cache
def slips(name):
    """[(what a known slip gives on all inputs, what it means)]."""
    inputs = BLANKS[name].inputs
    return [([row(name, each, case) for case in inputs], why) for each, why in BLANKS[name].slips]


def slip(name, found, expected):
    """What probably went wrong, from the wrong values on all inputs; "" where nobody knows."""
    for values, meaning in slips(name):
        if all(
            np.array_equal(np.isnan(got), np.isnan(value))
            and agree(np.nan_to_num(got), np.nan_to_num(value), 1e-3)
            for got, value in zip(found, values)
        ):
            return meaning
    if name == "longest_step":  # by a search of any kind
        if all(agree(got, found[0], 0.0) for got in found):
            return (
                "every spring gets the same step, an end of the search: does the test ask whether "
                "the size (abs) of each eigenvalue is at most 1, and which half is kept then?"
            )
        if all(0.45 < got / right < 2.1 for got, right in zip(found, expected)):
            return "the search is too coarse, or returns the step after the last good one"
    return ""


def blank_line(file, name):
    """The number of the first line of that function that waits to be written."""
    lines = Path(file).read_text("utf-8").splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith(f"def {name}("))
    waits = (k for k in range(start, len(lines)) if "= ..." in lines[k] or "return ..." in lines[k])
    return 1 + next(waits, start)


@np.errstate(all="ignore")
def judge(exercise, name):
    """("blank", "wrong" or "right", why in words): a learner's function on all inputs."""
    blank, function = BLANKS[name], getattr(exercise, name, None)
    if not callable(function):
        return "wrong", f"{name} is no longer a function in {near(exercise.__file__)}"
    try:
        found = [row(name, function, case) for case in blank.inputs]
    except ValueError as error:
        return "wrong", str(error)
    if any(got is None for got in found):
        line = blank_line(exercise.__file__, name)
        return "blank", (
            f"{name} is still a blank: {near(exercise.__file__)}, line {line}. "
            f"The task stands at the top of that file; --hint {blank.hint} asks a question"
        )
    expected = [row(name, blank.right, case) for case in blank.inputs]
    wrong = [
        each for each in zip(blank.inputs, found, expected) if not agree(*each[1:], blank.within)
    ]
    shown = min(wrong, key=lambda each: len(str(each[0]))) if wrong else (blank.inputs[0],)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        run(name, function, shown[0])
    if not wrong:
        words = f"{name} is right; on the first of its inputs it"
        return "right", "\n".join((words, *printed(said))) if said.getvalue() else ""
    known = slip(name, found, expected)
    ask = f"  where to look: {near(exercise.__file__)} --hint {blank.hint} asks a question"
    lines = [
        f"{name} is wrong on {len(wrong)} of {len(found)} inputs, of which this is the smallest:",
        *failing(name, *shown),
        *printed(said),
        f"  likely: {known}" if known else ask,
    ]
    return "wrong", "\n".join(lines)


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
        lines.append(f"  {label:<16}{mine + 0.0:>12.5g}{other + 0.0:>14.5g}{mark}")
    return lines


# What the fills do to balls


def pressed():
    """A ball is pressed into the table and let go: how high it jumps."""
    of = contact.scene_of(0.0, 0.07, damping=60.0)
    run = contact.run_model("penalty", of, 0.001, 1000, contact.Settings(stiffness=8e3))
    return run.q[:, 1].max() / 0.1 - 1.0


def thrown():
    """A ball is thrown up from the table: how high it lies at the end."""
    of = contact.scene_of(0.0, 0.1, vy=2.0)
    return contact.run_model("lcp", of, 0.002, 600).q[-1, 1, 0] / 0.1 - 1.0


def groove():
    """A ball drops into the groove of two that are held: how high it lies at the end."""
    of = contact.scene_of([0.0, -0.105, 0.105], [0.8, 0.1, 0.1], [1.0, math.inf, math.inf])
    return contact.run_model("lcp", of, 0.002, 600).q[-1, 1, 0] / 0.1 - 1.0


TRIALS = {
    "penalty_normal_force": (pressed,),
    "project_impulse": (thrown, groove),
    "solve_contacts": (thrown, groove),
}


@contextlib.contextmanager
def in_place(function, name):
    """contact.py with the learner's function in place of its own, while the context lasts."""

    def number(*values):  # also where it is an array that holds a single one
        return float(np.squeeze(function(*values)))

    where, mine = name, number
    if name == "solve_contacts":
        mine = function
    if name == "project_impulse":  # which contact.py writes out in its sweep
        where, mine = "solve_contacts", solver(total="project(c.lam, add)", project=number)
    own = getattr(contact, where)
    setattr(contact, where, mine)
    try:
        yield
    finally:
        setattr(contact, where, own)


def compare(exercise, name):
    """The trials of a blank, the learner's beside contact.py's."""
    rows = {}
    for trial in TRIALS[name]:
        with in_place(getattr(exercise, name), name):
            mine = trial()
        rows[trial.__doc__] = [round(each, 3) + 0.0 for each in (mine, trial())]  # and no -0.000
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
    from curriculum.implicit import implicit_step

    of, rows = contact.build_scene("drop"), {}
    for dt in (0.002, 0.008, 0.016, 0.064):
        spring = partial(exercise.implicit_spring, stiffness=1e4, damping=80.0, dt=dt)
        step, steps = partial(implicit_step, dt=dt, spring=spring), int(8.0 / dt)
        runs = (
            contact.simulate(step, of, dt, steps, skip=True),
            contact.run_model("penalty", of, dt, steps),
        )
        mine, other = (contact.contact_quality(run, of, dt) for run in runs)
        rest = [None if q["blew_up"] else q["rest_penetration_frac"] for q in (mine, other)]
        rows[f"dt {dt:.3f} s"] = mine["energy_excess"], other["energy_excess"], *rest
    heads = "gain, yours", "gain, penalty", "rests, yours", "rests, penalty"
    return columns("energy, depth", heads, rows, "{:.5g}")


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
        c.nx, c.ny = (0.0, 1.0) if c.b is contact.FLOOR else (math.sin(angle), math.cos(angle))
        closed += [c] if asked else []
    contact.solve_contacts(closed, iters)


GROOVE = contact.scene_of([0.0, 0.06], [0.1, 0.1 + math.sqrt(0.04 - 0.0036)], [math.inf, 1.0])
SCENES = {  # name: (scene, seconds)
    "drop": (contact.build_scene("drop"), 1.0),
    "stack": (contact.build_scene("stack"), 1.0),
    "slide": (GROOVE, 0.4),
}
INSIDE = contact.scene_of([0.0, 0.0], [0.1, 0.25])  # half a radius in one another


def worst(step, of, seconds, dt):
    """The worst distance of a ball from where exact has it [r]."""
    steps = round(seconds / dt)
    runs = contact.simulate(step, of, dt, steps), contact.run_model("exact", of, dt, steps)
    return float(np.hypot(*(runs[0].q - runs[1].q).swapaxes(0, 1)).max()) / contact.RADIUS


def ask_twice(exercise, _):
    """Errors beside exact, how high a ball comes that begins in another, the order of the slide."""

    def ways(dt):
        lcp = partial(contact.lcp_step, dt=dt, restitution=0.0, baumgarte=0.2, iters=20)
        return partial(asking_twice, exercise, dt=dt), lcp

    def errors(name, dt):
        return [worst(step, *SCENES[name], dt) for step in ways(dt)]

    rows = {f"{name}, error": errors(name, 0.002) for name in SCENES}
    high = (contact.simulate(step, INSIDE, 0.002, 300).q[:, 1].max() for step in ways(0.002))
    rows["inside, height"] = [y / contact.RADIUS for y in high]
    rows["slide, dt / 4"] = errors("slide", 0.0005)
    pairs = zip(rows["slide, error"], rows["slide, dt / 4"])
    orders = [math.log(max(a, 1e-16) / max(b, 1e-16), 4) for a, b in pairs]
    table = columns("in r, beside exact", ("yours", "lcp"), rows, "{:.3g}")
    return f"{table}\nThe order of your slide is {orders[0]:.1f}, lcp's is {orders[1]:.1f}."


SHOWN = {**dict.fromkeys(TRIALS, compare), "longest_step": cliffs, "implicit_spring": drops}
SHOWN["after_the_move"] = ask_twice  # the second of two


# Exercise 8


def fingers(exercise):
    """What the choice of exercise 8 does to the cup: {name: number}, lengths in r."""
    from curriculum.implicit import implicit_step

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
        held = bool((np.abs(run.q[-1, 0]) < 0.3).all())
        return {"deepest": last.max(), "trembling": np.ptp(last), "held": held}


def judge_fingers(exercise):
    """("blank", "wrong" or "right", why in words, what was seen): the choice of exercise 8."""
    model, dt, k, c = exercise.MODEL, exercise.DT, exercise.STIFFNESS, exercise.DAMPING
    if model is None:
        return "blank", f"no choice yet: set MODEL in {near(exercise.__file__)}", ""
    try:
        if model not in ("penalty", "implicit", "soft") or not 0.0005 <= dt <= 0.1:
            raise ValueError
        if not k > 0.0 <= c or (len(exercise.SOLREF), len(exercise.SOLIMP)) != (2, 5):
            raise ValueError
        seen = fingers(exercise)
    except (TypeError, ValueError, ArithmeticError):
        given = f"{model!r}, {dt!r} s, {k!r}, {c!r}, {exercise.SOLREF!r}, {exercise.SOLIMP!r}"
        allowed = "MODEL 'penalty', 'implicit' or 'soft', DT from 0.0005 s (2,000 steps) to 0.1 s, "
        allowed += "STIFFNESS above 0, DAMPING 0 or more, SOLREF two numbers, SOLIMP five"
        return "wrong", f"the fingers cannot be run: given {given}; allowed: {allowed}", ""
    shown = "overlap {deepest:.2g} r, trembling {trembling:.2g} r".format(**seen)
    faults = [] if seen["trembling"] < 1e-5 else ["it trembles"]
    faults += [] if seen["deepest"] < 1e-3 else ["it overlaps too much"]
    if not seen["held"]:
        faults = ["the cup is gone: the fingers flew off or went through it"]
    if not faults:
        return "right", "", shown
    advice = "a shorter time constant, of two steps or more, stiffens soft, and so does impedance"
    pressed_in = f"20 N press a spring of {k:g} N/m in by {200.0 / k:.2g} r, and "
    if not seen["held"] and 1e3 * dt * dt > 0.5:  # 20 N on 0.2 kg, in r
        advice = f"in one step of {dt:g} s its motor carries a finger {1e3 * dt * dt:.2g} r"
    elif model == "penalty":
        step = contact.critical_dt(0.1, k, c)
        advice = f"{pressed_in}a finger on it wants steps below {step:.1g} s"
    elif model == "implicit":
        advice = f"{pressed_in}it settles in about c / k = {c / k:.1g} s"
    return "wrong", f"{', and '.join(faults)}; {advice}", shown


# A whole exercise


def judged(name, exercise):
    """The state of an exercise, and [what, state, words, shown] of everything that it asks for."""
    found, states = [], {"": "right"}
    if name == "ex8":
        found.append(["two_fingers", *judge_fingers(exercise)])
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
                stopped = f"a trial of {blank} stopped: {type(error).__name__}: {error}"
                state, words = "wrong", words or stopped
        found.append([blank, state, words, shown])
    states = [state for _, state, *_ in found]
    return next((each for each in ("wrong", "blank") if each in states), "right"), found
