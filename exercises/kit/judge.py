"""Tries what a learner wrote, in a process of its own, beside what is right."""

import contextlib
import faulthandler
import inspect
import io
import json
import math
import os
import random
import sys
from functools import cache
from unittest import mock

import numpy as np

import contact
from curriculum.commands import near

from . import FACTS, load, stack
from .script import LIMIT, ask, said_of
from .trials import RIGHT, SHOWN, judge_bet, judge_gripper, judge_marks, judge_number

MAX_MEMORY = 2**32  # bytes, chosen
MAX_STEPS = 20_000  # matrices that a search may try on one input, chosen: halving takes 20
SWEEPS = 200  # that solve_contacts gets on each input, chosen: right to 1e-9
BLANKS = {name: facts for each in FACTS.values() for name, facts in each.get("blanks", {}).items()}
SEARCHES = BLANKS["longest_step"]["searches"]
PARTS = {"measured": judge_bet, "advice": judge_gripper, "errors": judge_marks}  # by their facts


def child():
    """Try in this process what was written, and write what was found to its standard output."""
    report = os.fdopen(os.dup(1), "w")  # past all that is printed, by whatever prints it
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource  # where there is one

        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))
    faulthandler.dump_traceback_later(LIMIT, exit=True, file=report)
    print(json.dumps(attempt(*sys.argv[2:], report)), file=report, flush=True)


def attempt(name, file, report=io.StringIO()):
    """Load an exercise and judge it; return (state, words), whatever it raises."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            exercise = load(file)
        state, words = judged(name, exercise, report)
    except BaseException as error:  # while the file is read, or in a trial
        letter = type(error) is NameError and "blanks" not in FACTS[name]
        quotes = f", {error.name} needs quotes around it" if letter else ""
        state, words = "wrong", f"{near(file)} cannot be run{quotes}: {said_of(error)}"
    return state, "\n".join((words, *printed(said)))


def judged(name, exercise, report):
    """Return the state of an exercise, and what is said of all that it asks for.

    The report says which function is tried, in case it does not come back.
    """
    states, said, file = {}, [], exercise.__file__
    for blank in FACTS[name].get("blanks", ()):
        function, after = getattr(exercise, blank, None), BLANKS[blank].get("after")
        if not hasattr(inspect.unwrap(function), "__code__"):
            return "wrong", f"{blank} must be a function, in {near(file)}"
        print(blank, file=report, flush=True)
        states[blank], words = judge(function, blank, file)
        if states[blank] == "wrong" and states.get(after, "right") != "right":
            states[blank], words = "blank", f"{blank} is tried once {after} is right"
        said.append(words)
    if set(states.values()) <= {"right"}:
        said += [f"\n{SHOWN[name](exercise)}"] if name in SHOWN else []
        parts = [PARTS[part](name, exercise) for part in PARTS if part in FACTS[name]]
        for what, facts in FACTS[name].get("numbers", {}).items():
            parts.append(judge_number(exercise, what, **facts))
        states |= {words: state for state, words in parts}
        said += [words for _, words in parts]
    return min(states.values(), key=("wrong", "blank", "right").index), "\n".join(said)


@cache
def inputs(name):
    """Return the inputs of a function, [{argument: value}]: those given, then random ones."""
    facts, draw = BLANKS[name]["inputs"], random.Random(35)
    if name == "solve_contacts":
        return facts

    def one(low, high):
        return low * (high / low) ** draw.random() if low > 0.0 else draw.uniform(low, high)

    ranges, most = facts["ranges"], range(facts.get("most", 60))
    rows = [[float(f"{one(*ends):.2g}") for ends in ranges.values()] for _ in most]
    return [dict(zip(ranges, row)) for row in [*facts.get("first", ()), *rows]]


def call_of(name, case):
    """Return the call of a function on an input, as one can type it into the exercise's file."""
    if name == "solve_contacts":
        return f"{name}(stack({', '.join(map(str, case.values()))}), {SWEEPS})"
    return f"{name}({', '.join(f'{key}={value}' for key, value in case.items())})"


def run_stack(function, case):
    """Return the impulses and velocities that a solver leaves in a stack; ... of a blank.

    The last number is 1 where a stack of four or more has converged after one sweep: none does.
    """
    lams = []
    for iters in (1, SWEEPS):
        made = stack(**case)
        if function(made, iters) is ...:
            return ...
        lams.append([c.lam for c in made])
    soon = len(made) > 3 and np.allclose(*lams, 1e-5, 1e-9)
    balls = dict.fromkeys(c.a for c in made)
    return [*lams[-1], *(v for ball in balls for v in (ball.vx, ball.vy)), float(soon)]


def run_search(function, case):
    """Return the step that a search finds. Raises TimeoutError, in words, after MAX_STEPS."""
    names, steps = inspect.unwrap(function).__globals__, []
    matrix, cliff = names["step_matrix"], contact.critical_dt(*case.values())

    def counted(*values):
        steps.append(values[-1])  # dt
        if len(steps) > MAX_STEPS:
            beyond = steps[0] < steps[-1] > 3.0 * cliff
            raise TimeoutError(SEARCHES["endless" if beyond else "slow"])
        return matrix(*values)

    with mock.patch.dict(names, step_matrix=counted):
        return function(*case.values())


RUNS = {"solve_contacts": run_stack, "longest_step": run_search}


def tried(function, name, case):
    """Return what comes out, as numbers in their rows, None of a blank; and the printed lines.

    Raises ValueError, in words, for what raises and for what is no number.
    """
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            got = RUNS[name](function, case) if name in RUNS else function(*case.values())
        words = f"{call_of(name, case)} returned {got!r:.60}, expected numbers"
        if got is None:
            never = "never" in BLANKS[name] and math.isinf(RIGHT[name](**case))
            words += BLANKS[name]["never"] if never else ": does every way end with `return`?"
    except TimeoutError as error:
        got, words = None, f"{name} takes {error}"
    except BaseException as error:
        got, words = None, f"{call_of(name, case)} raised {said_of(error)}"
        if name == "longest_step" and isinstance(error, np.linalg.LinAlgError):
            words += f"\n  likely: it takes {SEARCHES['endless']}"
    if got is ...:
        return None, printed(said)
    with contextlib.suppress(Exception):
        numbers = np.atleast_1d(np.squeeze(np.asarray(got)))
        if numbers.dtype.kind in "biuf":
            return numbers.astype(float), printed(said)
    raise ValueError("\n".join((words, *printed(said))))


def printed(said):
    """Return the first lines that a learner's code printed, marked as such."""
    lines = said.getvalue().splitlines()
    more = [f"  and {len(lines) - 8} lines more"] if len(lines) > 8 else []
    return [f"  printed   {line:.80}" for line in lines[:8]] + more


def agree(got, right, within=1e-3):
    """Return whether two rows of numbers agree within that share of their size, NaN with NaN."""
    allowed = within * np.abs(right[np.isfinite(right)]).max(initial=0.0) + 1e-14
    return got.shape == right.shape and np.allclose(got, right, 0.0, allowed, equal_nan=True)


def solver(*changes):
    """Return the right solve_contacts, with (old, new) exchanged."""
    text, names = inspect.getsource(RIGHT["solve_contacts"]), {}
    for old, new in zip(changes[::2], changes[1::2]):
        text = text.replace(old, new)
    exec(text, names)
    return names["solve_contacts"]


def slipped(name, slip):
    """Return a function with a common mistake of answers.json, an expression of its arguments."""
    given = ", ".join(inspect.signature(RIGHT[name]).parameters)
    return eval(f"lambda {given}: {slip}", RIGHT | {"solver": solver})  # our own text


@cache
def on_all_inputs(name, slip=""):
    """Return what the right function gives on all inputs, or one with that mistake."""
    function = slipped(name, slip) if slip else RIGHT[name]
    return [tried(function, name, case)[0] for case in inputs(name)]


def likely(function, name, found, expected):
    """Return the likely mistake, from the wrong values on all inputs; "" if it is not known."""
    for slip, meaning in BLANKS[name]["slips"].items():
        if all(map(agree, found, on_all_inputs(name, slip))):
            return meaning
    searches = "step_matrix" in inspect.unwrap(function).__code__.co_names
    if name != "longest_step" or not searches or found[0].shape != (1,):
        return ""
    shares = [x / y for x, y in zip(found, expected)]
    if sum(agree(got, max(found), 1e-4) for got in found) > 2:
        return SEARCHES["same"]
    far = SEARCHES["coarse"] if max(shares) < 2.1 else f"it takes {SEARCHES['endless']}"
    return far if min(shares) > 0.45 else ""


@np.errstate(all="ignore")
def judge(function, name, file):
    """Return ("blank", "wrong" or "right", why in words) of a function, from all its inputs."""
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
    case, got, right, lines = min(wrong, key=lambda case: len(str(case[0])))
    known = likely(function, name, found, expected)
    return "wrong", "\n".join((
        f"{name} is wrong on {len(wrong)} of {len(found)} inputs, of which this is the smallest:",
        f"  {call_of(name, case)}",
        *compared(BLANKS[name].get("labels") or labels(**case), got, right),
        *lines,
    )) + (f"\n  likely: {known}" if known else hint)  # fmt: skip


def compared(labels, got, right):
    """Return the lines that show what came out beside what was expected."""
    if got.shape != right.shape:
        there, due = (" rows of ".join(map(str, each.shape)) for each in (got, right))
        return [f"  how many numbers: got {there}, expected {due}"]
    lines = [f"  {'':<16}{'got':>12}{'expected':>14}"]
    for label, *pair in zip(labels, got.ravel(), right.ravel()):
        mark = "" if agree(*map(np.atleast_1d, pair)) else "   <"
        lines.append(f"  {label:<16}{pair[0] + 0.0:>12.5g}{pair[1] + 0.0:>14.5g}{mark}")
    return lines


def labels(masses, speeds, contacts):
    """Return what the numbers are that come out of a stack."""
    lam = [f"lam of {a} on {'floor' if b < 0 else b}" for a, b, _, _ in contacts]
    speeds = [f"{v} of {ball}" for ball in range(len(masses)) for v in ("vx", "vy")]
    return [*lam, *speeds, "1 sweep does it"]
