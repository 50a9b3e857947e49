"""Tries what a learner wrote, in a process of its own, beside what is right."""

import contextlib
import faulthandler
import inspect
import io
import itertools
import json
import math
import os
import random
import sys
from functools import cache

import numpy as np

import contact
from curriculum.commands import near

from . import FACTS, load
from .bets import RIGHT, judge_bet, judge_knobs, judge_number
from .script import LIMIT, ask, said_of
from .trials import SHOWN, judge_gripper

MOST_MEMORY = 2**32  # bytes, chosen
MOST_EVENTS = 3_000_000  # calls and returns on one input, chosen: about a second
BLANKS = {name: facts for each in FACTS.values() for name, facts in each.get("blanks", {}).items()}
PARTS = {  # what an exercise may ask for beside functions, by the facts that it has for that
    "measured": judge_bet,
    "advice": judge_gripper,
    "troubles": judge_knobs,
    "number": judge_number,
}


def child():
    """The other process: try, write what was found into the report, and be gone."""
    name, file, path = sys.argv[2:]
    with open(path, "w", encoding="utf-8") as report:
        print(f'trying {name}: "{file}", line 1', file=report, flush=True)
        faulthandler.enable(report, all_threads=False)
        faulthandler.dump_traceback_later(LIMIT, exit=True, file=report)
        with contextlib.suppress(ImportError, ValueError, OSError):
            import resource  # where there is one

            resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        try:
            found = judged(name, load(file), report)
        except BaseException as error:  # while the file is read, or in a trial
            letter = type(error) is NameError and "blanks" not in FACTS[name]
            quotes = f", {error.name} needs quotes around it" if letter else ""
            found = "wrong", f"{near(file)} cannot be run{quotes}: {said_of(error)}"
        print(json.dumps(found), file=report)
    os._exit(0)  # whatever threads are left


def judged(name, exercise, report=None):
    """The state of an exercise, and what is said of all that it asks for."""
    states, said, file = {}, [], exercise.__file__
    for blank in FACTS[name].get("blanks", ()):
        function, after = getattr(exercise, blank, None), BLANKS[blank].get("after")
        code = getattr(inspect.unwrap(function), "__code__", None)
        if not code:
            return "wrong", f"{blank} is no longer a function of yours in {near(file)}"
        place = f'"{code.co_filename}", line {code.co_firstlineno}'
        print(f"trying {blank}: {place}", file=report, flush=True)
        states[blank], words = judge(function, blank, file)
        if states[blank] == "wrong" and states.get(after, "right") != "right":
            states[blank], words = "blank", f"{blank} is tried once {after} is right"
        said.append(words)
    if set(states.values()) <= {"right"}:
        said += [f"\n{SHOWN[name](exercise)}"] if name in SHOWN else []
        for part in (part for part in PARTS if part in FACTS[name]):
            states[part], words = PARTS[part](name, exercise)
            said.append(words)
    return min(states.values(), key=("wrong", "blank", "right").index), "\n".join(said)


# What goes in


@cache
def inputs(name):
    """The inputs of a function, [{argument: value}].

    The first as given, then random ones of two digits, by powers in a range above 0.
    """
    facts, draw = BLANKS[name]["inputs"], random.Random(35)
    if name == "solve_contacts":
        return facts

    def one(low, high):
        return low * (high / low) ** draw.random() if low > 0.0 else draw.uniform(low, high)

    ranges, most = facts["ranges"], facts.get("most", 60)
    rows = [[float(f"{one(*ends):.2g}") for ends in ranges.values()] for _ in range(most)]
    return [dict(zip(ranges, row)) for row in [*facts.get("first", ()), *rows]]


def run_stack(function, masses, speeds, upper_lower_angle_target):
    """The impulses and velocities that a solver leaves in a stack; ... where it is a blank.

    Masses [kg], velocities (x, y) [m/s]; of each contact the upper ball, the lower one (-1: the
    floor), the normal's angle from the vertical [rad] and the target [m/s]. The last number is 1
    where a stack of four or more is done by `iters` = 1: so soon is none.
    """
    lams = []
    for iters in (1, 600):
        balls = [contact.Ball(0.0, 0.1, *speed, mass, 0.1) for mass, speed in zip(masses, speeds)]
        bodies, made = [*balls, contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)], []
        for a, b, angle, target in upper_lower_angle_target:  # -1 is the last of bodies, the floor
            made.append(contact.Contact(bodies[a], bodies[b], math.sin(angle), math.cos(angle), 0))
            made[-1].target = target
        if function(made, iters) is ...:
            return ...
        lams.append([c.lam for c in made])
    soon = len(made) > 3 and np.allclose(*lams, 1e-5, 1e-9)
    return [*lams[-1], *(speed for ball in balls for speed in (ball.vx, ball.vy)), float(soon)]


# What comes out, beside what is right


def tried(function, name, case):
    """What comes out, as numbers in their rows, None of a blank; and the lines that it printed.

    Raises ValueError, in words, for what raises and for what is no number.
    """
    said, events = io.StringIO(), itertools.count()

    def patience(frame, event, arg):
        if next(events) > MOST_EVENTS:
            raise TimeoutError("so many calls, and no end")

    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            sys.setprofile(patience)
            got = run_stack(function, **case) if "masses" in case else function(*case.values())
        words = f"{name} returned {got!r:.60}, and not numbers"
        words += "; does it end with `return`?" if got is None else ""
    except BaseException as error:
        got, words = None, f"{name} raised {said_of(error)}"
        if name == "longest_step" and isinstance(error, (TimeoutError, np.linalg.LinAlgError)):
            words += f"\n  likely: {FACTS['ex6']['searches']['endless']}"
    finally:
        sys.setprofile(None)
    lines = [] if said.closed else said.getvalue().splitlines()
    printed = [f"  printed   {line:.80}" for line in lines[:8]]
    printed += [f"  and {len(lines) - 8} lines more"] if len(lines) > 8 else []
    if got is ...:
        return None, printed
    with contextlib.suppress(Exception):
        numbers = np.atleast_1d(np.squeeze(got))
        if numbers.dtype.kind in "biuf":
            return numbers.astype(float), printed
    raise ValueError("\n".join((words, *printed)))


def agree(got, right, within=1e-3):
    """Whether two rows of numbers, NaN among them, agree within that share of their size."""
    allowed = within * np.abs(right[np.isfinite(right)]).max(initial=0.0) + 1e-14
    return got.shape == right.shape and np.allclose(got, right, 0.0, allowed, equal_nan=True)


def solver(*changes):
    """The right solve_contacts, with (old, new) exchanged."""
    text, names = inspect.getsource(RIGHT["solve_contacts"]), {}
    for old, new in zip(changes[::2], changes[1::2]):
        text = text.replace(old, new)
    exec(text, names)
    return names["solve_contacts"]


def slipped(name, slip):
    """A function with a slip of answers.json, an expression of its arguments."""
    given = ", ".join(inspect.signature(RIGHT[name]).parameters)
    return eval(f"lambda {given}: {slip}", RIGHT | {"solver": solver})  # our own text


@cache
def on_all_inputs(name, slip=""):
    """What the right function gives on all inputs, or one with that slip."""
    function = slipped(name, slip) if slip else RIGHT[name]
    return [tried(function, name, case)[0] for case in inputs(name)]


def likely(name, found, expected):
    """What probably went wrong, from the wrong values on all inputs; "" where nobody knows."""
    for slip, meaning in BLANKS[name]["slips"].items():
        if all(map(agree, found, on_all_inputs(name, slip))):
            return meaning
    if name != "longest_step" or found[0].shape != (1,):
        return ""
    meanings, shares = FACTS["ex6"]["searches"], [x / y for x, y in zip(found, expected)]
    if sum(agree(got, max(found), 1e-4) for got in found) > len(found) / 2:
        return meanings["same"]
    return meanings["coarse" if max(shares) < 2.1 else "endless"] if min(shares) > 0.45 else ""


@np.errstate(all="ignore")
def judge(function, name, file):
    """("blank", "wrong" or "right", why in words): a learner's function on all inputs."""
    hint = ask(file, BLANKS[name]["hint"])
    try:
        found, prints = zip(*(tried(function, name, case) for case in inputs(name)))
    except ValueError as error:
        return "wrong", str(error)
    if any(got is None for got in found):
        line = max(line for *_, line in inspect.unwrap(function).__code__.co_lines() if line)
        return "blank", f"{name} is still a blank: write what line {line} returns{hint}"
    expected, within = on_all_inputs(name), BLANKS[name].get("within", 1e-9)
    cases = list(zip(inputs(name), found, expected, prints))
    wrong = [case for case in cases if not agree(*case[1:3], within)]
    if not wrong:
        return "right", "\n".join((f"{name} is right", *prints[0]))
    case, got, right, printed = min(wrong, key=lambda case: len(str(case[0])))
    known = likely(name, found, expected)
    return "wrong", "\n".join((
        f"{name} is wrong on {len(wrong)} of {len(found)} inputs, of which this is the smallest:",
        f"  {name}({', '.join(f'{key}={value}' for key, value in case.items())})",
        *compared(BLANKS[name].get("labels") or labels(**case), got, right),
        *printed,
    )) + (f"\n  likely: {known}" if known else hint)  # fmt: skip


def compared(labels, got, right):
    """The lines that show what came out beside what was expected."""
    if got.shape != right.shape:
        there, due = (" rows of ".join(map(str, each.shape)) for each in (got, right))
        return [f"  how many numbers: got {there}, expected {due}"]
    lines = [f"  {'':<16}{'got':>12}{'expected':>14}"]
    for label, *pair in zip(labels, got.ravel(), right.ravel()):
        mark = "" if agree(*map(np.atleast_1d, pair)) else "   <"
        lines.append(f"  {label:<16}{pair[0] + 0.0:>12.5g}{pair[1] + 0.0:>14.5g}{mark}")
    return lines


def labels(masses, speeds, upper_lower_angle_target):
    """What the numbers are that come out of a stack."""
    lam = [f"lam, {a} on {'floor' if b < 0 else b}" for a, b, _, _ in upper_lower_angle_target]
    speeds = [f"{v} of {ball}" for ball in range(len(masses)) for v in ("vx", "vy")]
    return [*lam, *speeds, "1 sweep does it"]
