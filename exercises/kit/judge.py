"""Tries what a learner wrote, in a process of its own; values beside the right ones, and balls."""

import contextlib
import faulthandler
import io
import json
import math
import os
import sys
from functools import cache, partial
from pathlib import Path
from unittest import mock

import numpy as np

import contact
from curriculum.commands import near
from curriculum.implicit import implicit_step

from . import FACTS, bets, columns, load
from .script import LIMIT, own_lines, unreadable
from .slips import BLANKS, RIGHT, labels, run, solver

MOST_MEMORY = 2**32  # bytes, chosen


def child():
    """The other process: try, write what was found into the report, and be gone."""
    name, file, path = sys.argv[2:]
    leave, os._exit = os._exit, sys.exit  # which has its line
    with open(path, "w", encoding="utf-8") as report, open(os.devnull, "w") as nowhere:
        faulthandler.enable(report, all_threads=False)
        faulthandler.dump_traceback_later(LIMIT, exit=True, file=report)
        with contextlib.suppress(ImportError, ValueError, OSError):
            import resource  # where there is one

            resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            try:
                found = judged(name, load(file), report)
            except BaseException as error:
                found = "wrong", [[name, "wrong", unreadable(file, error), ""]]
        print(json.dumps(found), file=report)
    leave(0)  # whatever threads are left


def judged(name, exercise, report=None):
    """The state of an exercise, and [what, state, words, shown] of everything that it asks for."""
    found, states = [], {"": "right"}
    for blank in (each for each in BLANKS if BLANKS[each].exercise == name):
        print(f"trying {blank}", file=report, flush=True)
        found.append(judge_blank(exercise, blank, states))
    if set(states.values()) == {"right"}:
        found += [part(name, exercise) for part in PARTS.get(name, ())]
    return min((part[1] for part in found), key=("wrong", "blank", "right").index), found


def judge_blank(exercise, blank, states):
    """[what, state, words, shown] of a function; `states` of those before it, and it is added."""
    state, words = judge(exercise, blank)
    after, shown = BLANKS[blank].after, ""
    if state == "wrong" and states[after] != "right":
        state, words = "blank", f"{blank} is tried once {after} is right"
    states[blank] = state
    if blank in SHOWN and "blank" not in states.values():
        try:  # also a wrong one: to see is to know why
            shown = SHOWN[blank](exercise, blank)
        except (Exception, SystemExit) as error:
            if state == "right":
                words = f"a trial of {blank} stopped: {said_of(error)}"
            states[blank] = "wrong"
    return [blank, states[blank], words, shown]


# Values beside the right ones


def tried(function, name, case):
    """What comes out, as numbers in their rows, None of a blank; and the lines that it printed.

    Raises ValueError, in words, for what raises and for what is no number.
    """
    said, got = io.StringIO(), None
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            got = run(name, function, case)
        words = f"{name} returned {got!r:.60}, and not numbers"
        words += "; does it end with `return`?" if got is None else ""
    except BaseException as error:
        words = f"{name} raised {said_of(error)}"
    lines = [] if said.closed else said.getvalue().splitlines()
    printed = [f"  printed   {line:.80}" for line in lines[:8]]
    printed += [f"  and {len(lines) - 8} lines more"] if len(lines) > 8 else []
    if got is ...:
        return None, printed
    try:
        if got is None or isinstance(got, str):  # which numpy would take for a number
            raise TypeError
        return np.atleast_1d(np.asarray(got, float).squeeze()), printed
    except Exception:
        raise ValueError("\n".join((words, *printed))) from None


def said_of(error):
    """An error in words, with the last line of the learner's own code that it came through."""
    lines = [f"\n  line {each.lineno}: {each.line}" for each in own_lines(error)[-1:]]
    return "".join((f"{type(error).__name__}: {error}", *lines))


def agree(got, right, within):
    """Whether two rows of numbers, NaN among them, agree within that share of their size."""
    allowed = within * np.abs(right[np.isfinite(right)]).max(initial=0.0) + 1e-14
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


TRIALS = {  # what is seen: blanks, model, scene, what is taken of the heights
    "A ball is pressed into the table and let go: how high it jumps.": (
        "penalty_normal_force", "penalty", contact.scene_of(0.0, 0.07, damping=60.0), np.max),
    "A ball is thrown up from the table: how high it is, in the mean.": (
        "project_impulse solve_contacts", "lcp", contact.scene_of(0.0, 0.1, vy=2.0), np.mean),
    "A ball drops into the groove of two that are held: how high it lies at the end.": (
        "project_impulse solve_contacts", "lcp", contact.scene_of(
            [0.0, -0.105, 0.105], [0.8, 0.1, 0.1], [1.0, math.inf, math.inf]), lambda y: y[-1]),
    "A ball bounces from one impact to the next: how high it is, in the mean.": (
        "time_to_impact", "exact", contact.scene_of(0.0, 1.0, restitution=0.7), np.mean),
}  # fmt: skip


def height(trial):
    """The height of the first ball in a trial, above the table [r]."""
    _, model, scene, of_all = TRIALS[trial]
    q = contact.run_model(model, scene, 0.002, 600).q
    return round(of_all(q[:, 1, 0]) / 0.1 - 1.0, 3) + 0.0  # and no -0.000


def compare(exercise, name):
    """Balls under the learner's function in the place of contact.py's, beside its own."""
    where, mine = name, getattr(exercise, name)
    if name == "project_impulse":  # which contact.py writes out in its sweep
        where, mine = "solve_contacts", solver("max(0.0, c.lam + add)", "f(c.lam, add)", f=mine)
    if name == "time_to_impact":  # a_n is None where a gap stays closed

        def mine(*of, theirs=mine):
            return math.inf if of[2] is None else theirs(*of)

    trials = [trial for trial, (blanks, *_) in TRIALS.items() if name in blanks]
    with mock.patch.object(contact, where, mine):
        yours = [height(trial) for trial in trials]
    rows = dict(zip(trials, zip(yours, map(height, trials))))
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
        runs = contact.simulate(step, of, dt, steps), contact.run_model("penalty", of, dt, steps)
        found = [contact.contact_quality(run, of, dt) for run in runs]
        rest = [None if q["blew_up"] else q["rest_penetration_frac"] for q in found]
        rows[f"dt {dt:.3f} s"] = [*(q["energy_excess"] for q in found), *rest]
    heads = "gain, yours", "gain, penalty", "deep, yours", "deep, penalty"
    table = columns("", heads, rows, "{:.5g}")
    said = "gain: the highest energy above the start's, as its share; deep: at the end, in r"
    return f"{table}\n{said}, and - where it flew to pieces."


def asking_twice(exercise, balls, dt, iters=20):
    """What lasts in leapfrog's step, by two functions of exercise 10."""
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
    "inside, height": (contact.scene_of(0.0, [0.1, 0.25]), 0.002, 0.6),
}


def ask_twice(exercise, _):
    """Errors beside exact, and how high a ball comes that begins in another."""
    rows = {}
    for name, (of, dt, seconds) in PROBLEMS.items():
        count, step = round(seconds / dt), partial(asking_twice, exercise, dt=dt)
        runs = contact.simulate(step, of, dt, count), contact.run_model("lcp", of, dt, count)
        rows[name] = [run.q[:, 1].max() / 0.1 for run in runs]
        if "inside" not in name:
            off = [run.q - contact.run_model("exact", of, dt, count).q for run in runs]
            rows[name] = [np.hypot(each[:, 0], each[:, 1]).max() / 0.1 for each in off]
    table = columns("in r, beside exact", ("yours", "lcp"), rows, "{:.3g}")
    return f"{table}\ninside: how high a ball rises that begins in another; at 3 r they only touch."


SHOWN = {  # blank: what shows it at work; of two that work together, the second
    **dict.fromkeys("penalty_normal_force project_impulse solve_contacts".split(), compare),
    "longest_step": cliffs,
    "implicit_spring": drops,
    "time_to_impact": compare,
    "after_the_move": ask_twice,
}


# The gripper of exercise 8, and numbers from paper


def fingers(exercise):
    """What a gripper does: its deepest overlap, how that varies [r], whether the cup is held."""
    dt, of = exercise.DT, contact.scene_of([-0.205, 0.0, 0.205], 0.1, [0.2, 1.0, 0.2])
    solref, solimp = contact.soft_defaults(0.0, dt, exercise.SOLREF, exercise.SOLIMP)
    k, c, spring = exercise.STIFFNESS, exercise.DAMPING, RIGHT["ex7"].implicit_spring
    steps = {
        "penalty": partial(contact.penalty_step, stiffness=k, damping=c),
        "implicit": partial(implicit_step, spring=partial(spring, stiffness=k, damping=c, dt=dt)),
        "soft": partial(contact.soft_step, solref=solref, solimp=solimp),
    }

    def step(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):  # the motors [N]
            ball.fx, ball.fy = force, 0.0
        return steps[exercise.MODEL](balls, dt)

    run = contact.simulate(step, of, dt, math.ceil(1.0 / dt - 1e-9))
    with np.errstate(all="ignore"):
        depth = np.maximum(-contact.smallest_gap(run.q, of.radius) / 0.1, 0.0)
        last = depth[3 * len(depth) // 4 :]
        return last.max(), np.ptp(last), bool((np.abs(run.q[-1, 0]) < 0.3).all())


CHOICES = {  # of exercise 8: what is allowed of each knob, in code and in words
    "MODEL": (lambda x: x in ("penalty", "implicit", "soft"), "'penalty', 'implicit' or 'soft'"),
    "DT": (lambda x: 0.0005 <= x <= 0.1, "from 0.0005 s (2,000 steps) to 0.1 s"),
    "STIFFNESS": (lambda x: 0.0 < x <= 1e15, "a number above 0"),
    "DAMPING": (lambda x: 0.0 <= x <= 1e9, "a number, 0 or more"),
    "SOLREF": (partial(contact.within, "solref", shape=(2,)), contact.SPRINGS),
    "SOLIMP": (partial(contact.within, "solimp", shape=(5,)), "five numbers from 0 to 100"),
}


def fits(allows, value):
    """Whether a knob may have that value; what cannot even be compared may not."""
    with contextlib.suppress(Exception):
        return bool(allows(value))
    return False


def judge_fingers(_, exercise):
    """[what, state, words, shown]: the choice of exercise 8, by what it does."""
    what, given = "two_fingers", {knob: getattr(exercise, knob, None) for knob in CHOICES}
    model, dt, k, c, *_ = given.values()
    if model is None:
        return [what, "blank", f"no choice yet: set MODEL in {near(exercise.__file__)}", ""]
    wrong = [
        f"{knob}: given {given[knob]!r:.60}; allowed: {words}"
        for knob, (allows, words) in CHOICES.items()
        if not fits(allows, given[knob])
    ]
    if wrong:
        wrong += [FACTS["ex8"]["rigid"]] if model in ("lcp", "leapfrog", "exact") else []
        return [what, "wrong", "\n".join(wrong), ""]
    deepest, trembling, held = fingers(exercise)
    shown = f"overlap {deepest:.2g} r, trembling {trembling:.2g} r"
    faults = [] if trembling < 1e-5 else ["it trembles"]
    faults += [] if deepest < 1.001e-3 else ["it overlaps too much"]
    if not held:
        faults = ["the cup is gone: the fingers flew off or went through it"]
    if not faults:
        return [what, "right", "", shown]
    pressed = f"20 N press a spring of {k:g} N/m in by {200.0 / k:.2g} r, and "
    longest, way = contact.critical_dt(0.1, k, c), 1e3 * dt * dt  # of 20 N on 0.2 kg, in r
    advice = {
        "penalty": f"{pressed}a finger on it wants steps below {longest:.1g} s",
        "implicit": f"{pressed}it settles in about c / k = {c / k:.1g} s",
        "soft": "a shorter time constant, of two steps or more, stiffens soft, so does impedance",
    }[model]
    if not held and way > 0.5:
        advice = f"in one step of {dt:g} s its motor carries a finger {way:.2g} r"
    return [what, "wrong", f"{', and '.join(faults)}; {advice}", shown]


def judge_number(name, exercise):
    """[what, state, words, shown] of a number; its slips are other formulas."""
    facts, file = FACTS[name]["number"], near(exercise.__file__)
    what, within = facts["name"], facts["within"]
    given, true = getattr(exercise, what, None), getattr(RIGHT[name], what)
    try:
        mine = abs(float(given))  # the table says an overlap with a minus
    except (TypeError, ValueError, OverflowError):
        said = f"no {what} yet" if given is None else f"{what}: given {given!r}"
        return [what, "blank", f"{said}; write a number in {file}, {facts['unit']}", ""]
    if math.isclose(mine, true, rel_tol=within):
        return [what, "right", facts["right"].format(true), ""]
    for text, meaning in facts["slips"].items():
        if math.isclose(mine, eval(text), rel_tol=within):  # our own text
            return [what, "wrong", f"{what}: given {given}; likely: {meaning}", ""]
    words = f"{what}: given {given}, and it is another; --hint {facts['hint']} asks a question"
    return [what, "wrong", words, ""]


PARTS = {  # exercise: what it asks for beside functions
    **dict.fromkeys(("ex1", "ex3"), [bets.judge_bet]),
    **dict.fromkeys(("ex4", "ex10"), [judge_number]),
    "ex8": [judge_fingers],
    "ex9": [bets.judge_knobs, judge_number],
}
