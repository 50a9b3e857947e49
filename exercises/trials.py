"""Exercise 2's three trials, and what can be wrong with a fill. Nothing to fill in here.

In each trial one border of a contact decides what is seen: whether the table pulls, and whether a
push that was too large can be taken back.
"""

import contextlib
import math
import random
import sys
from unittest.mock import patch

import numpy as np
import predict
from predict import contact, stoppable

BLANKS = ("penalty_normal_force", "project_impulse")
WITHIN = 1e-6       # m; trials that differ by less are the same


# What goes in


def inputs(blank):
    """Inputs of a blank: its borders by hand, then any stiffness, damping, speed and sign."""
    draw = random.Random(35)
    if blank == "project_impulse":
        edges = ((0.0, 0.0), (0.0, 0.3), (0.2, 0.3), (0.0, -0.3), (0.2, -0.5), (0.2, -0.2),
                 (0.2, -0.1))
        more = [(draw.uniform(0.0, 2.0), draw.uniform(-3.0, 3.0)) for _ in range(60)]
        return [dict(zip(("lam", "dlam"), case)) for case in (*edges, *more)]
    edges = [(depth, v_n, 5e3, damping) for damping in (0.0, 80.0) for depth, v_n in (
        (0.0, 0.0), (0.01, 0.0), (0.01, -0.5), (0.01, 0.5), (0.0, -1.0), (0.0, 1.0),
        (0.001, 2.0), (0.01, 0.625))]
    more = [(draw.uniform(0.0, 0.05), draw.uniform(-3.0, 3.0), 10.0**draw.uniform(2.0, 5.0),
             draw.uniform(0.0, 300.0)) for _ in range(60)]
    return [dict(zip(("depth", "v_n", "stiffness", "damping"), case))
            for case in (*edges, *more)]


@contextlib.contextmanager
def guarded():
    """While it lasts, contact.py's own functions of these names refuse to be called, however."""
    def refuse(*given, **named):
        raise PermissionError

    functions = [getattr(contact, blank) for blank in BLANKS]
    codes = [function.__code__ for function in functions]
    try:
        for function in functions:
            function.__code__ = refuse.__code__
        yield
    finally:
        for function, code in zip(functions, codes):
            function.__code__ = code


def called(function, blank, case):
    """(what the fill gives, None), or (None, why it gives nothing that can be used)."""
    try:
        with guarded():
            got = function(*case.values())
    except PermissionError:
        return None, f"{blank} calls contact.{blank}: write the line yourself"
    except NameError as error:
        return None, (f"{blank} raised NameError: {error}. These are plain numbers: Python's own "
                      "max, min and abs need no import")
    except Exception as error:
        return None, f"{blank} raised {type(error).__name__}: {error}"
    if got is ... or (isinstance(got, (int, float)) and not isinstance(got, bool)):
        return got, None
    return None, f"{blank} returned {got!r}, and not a number"


# What comes out: the slips that are seen most

SLIPS = {
    "penalty_normal_force": (
        (lambda depth, v, k, c: k * depth - c * v,
         "nothing keeps the table from pulling: on the way out the damper can outweigh the spring"),
        (lambda depth, v, k, c: max(0.0, k * depth + c * v),
         "the damper pushes along with the motion: look up the sign of v_n"),
        (lambda depth, v, k, c: k * depth + c * v,
         "the damper pushes along with the motion, and nothing keeps the table from pulling"),
        (lambda depth, v, k, c: max(0.0, k * depth - c * abs(v)),
         "the damper takes from the push on the way in too, where it should add to it"),
        (lambda depth, v, k, c: max(0.0, k * depth + c * abs(v)),
         "the damper adds to the push on the way out too, where it should take from it"),
        (lambda depth, v, k, c: max(0.0, k * depth),
         "the damper is missing"),
        (lambda depth, v, k, c: max(0.0, -c * v),
         "the spring is missing"),
        (lambda depth, v, k, c: max(0.0, k * depth - c * min(0.0, v)),
         "the damper works on the way in only"),
        (lambda depth, v, k, c: max(0.0, k * depth - c * max(0.0, v)),
         "the damper works on the way out only"),
        (lambda depth, v, k, c: max(0.0, k * depth) - max(0.0, c * v),
         "the damper works on the way out only, and there it can pull"),
        (lambda depth, v, k, c: min(0.0, k * depth - c * v),
         "this lets the table pull and never push"),
        (lambda depth, v, k, c: abs(k * depth - c * v),
         "a pull has been turned round into a push: what should be left of it?"),
        (lambda depth, v, k, c: max(0.0, -k * depth - c * v),
         "the spring pulls: depth is positive in an overlap"),
        (lambda depth, v, k, c: max(0.0, 1e4 * depth - c * v),
         "a number stands where `stiffness` should: this one fits a single spring"),
        (lambda depth, v, k, c: max(0.0, k * depth - 80.0 * v),
         "a number stands where `damping` should: this one fits a single damper"),
        (lambda depth, v, k, c: max(0.0, 1e4 * depth - 80.0 * v),
         "numbers stand where `stiffness` and `damping` should: they fit a single contact"),
        (lambda depth, v, k, c: max(0.0, 0.5 * k * depth * depth - c * v),
         "that is the energy of the spring, not its force"),
    ),
    "project_impulse": (
        (lambda lam, dlam: lam + dlam,
         "nothing keeps the sum from becoming negative: the table holds back what leaves it"),
        (lambda lam, dlam: lam + max(0.0, dlam),
         "no correction can be negative: a push that was too large stays for good"),
        (lambda lam, dlam: max(0.0, dlam),
         "only the last correction comes out: what was pushed before it is forgotten"),
        (lambda lam, dlam: max(0.0, lam - dlam),
         "the correction is taken off: dlam is to be added"),
        (lambda lam, dlam: abs(lam + dlam),
         "a negative sum has been turned round into a push: what should be left of it?"),
        (lambda lam, dlam: max(lam, dlam),
         "this is the larger of the two: an impulse so far and its correction make a sum"),
        (lambda lam, dlam: min(0.0, lam + dlam),
         "this lets the table pull and never push"),
        (lambda lam, dlam: lam,
         "the correction is not used"),
        (lambda lam, dlam: dlam,
         "only the last correction comes out, and it may be negative"),
        (lambda lam, dlam: 0.0,
         "the table never pushes"),
    ),
}


def slip(blank, got):
    """What probably went wrong, from the wrong values `got` at all inputs; None if it is new."""
    for function, meaning in SLIPS[blank]:
        values = [function(*case.values()) for case in inputs(blank)]
        if all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in zip(got, values)):
            return meaning
    return None


# The trials


def balls(name, *centres, held=0, speed=0.0):
    """A scene of balls at these centres (x, y) [m]; the last `held` of them cannot be moved.

    The first ball starts upwards with that speed [m/s].
    """
    count = len(centres)
    mass = np.array([1.0] * (count - held) + [np.inf] * held)
    v0 = np.zeros((2, count))
    v0[1, 0] = speed
    return contact.Scene(name, np.array(centres).T.copy(), v0, mass, np.full(count, 0.1), 0.0, 60.0)


def pressed():
    """A ball is pressed into the table and let go: how high it jumps, how hard it is held back."""
    scene = balls("pressed", (0.0, 0.07))
    run = contact.run_model("penalty", scene, 0.001, 1000, stiffness=8e3)
    pull = max(0.0, -float(contact.contact_impulses(run, scene)[:, 1].min()) / 0.001)
    jump = float(run.q[:, 1, 0].max() - 0.1) / 0.1
    return run, {"it jumps": jump, "the table pulls [N]": pull if pull > 1e-6 else 0.0}, scene


def thrown():
    """A ball is thrown up from the table: how high it comes."""
    scene = balls("thrown", (0.0, 0.1), speed=2.0)
    run = contact.run_model("lcp", scene, 0.002, 500)
    return run, {"it rises": float(run.q[:, 1, 0].max() - 0.1) / 0.1}, scene


def groove():
    """A ball drops into the groove of two balls that are held: where it ends."""
    scene = balls("groove", (0.0, 0.6), (-0.07, 0.1), (0.07, 0.1), held=2)
    run = contact.run_model("lcp", scene, 0.002, 600)
    return run, {"it ends off the groove by": abs(float(run.q[-1, 0, 0])) / 0.1}, scene


TRIALS = {"penalty_normal_force": (pressed,), "project_impulse": (thrown, groove)}


def yours(exercise):
    """contact.py with the exercise's functions in place of its own, while the context lasts."""
    return patch.multiple(
        contact,
        penalty_normal_force=lambda *given: exercise.penalty_normal_force(*given[:4]),
        project_impulse=lambda *given: exercise.project_impulse(*given[:2]))


@stoppable
def play(exercise, argv=None):
    """The three trials with the two fills. Exit status: 0 right, 1 wrong, 2 not filled yet."""
    args = predict.parse("ex2", argv, record="write a recording of every trial, for rerun")
    if args.hint:
        return 0
    status = max([tried(exercise, blank, args.record) for blank in BLANKS])
    if not status:
        print(f"\nnext: {predict.follow_up('ex2')}")
    return status


def unfilled(exercise, blank):
    """What a blank asks for, printed, and the line that says where it is."""
    function, number = getattr(exercise, blank), 1 + BLANKS.index(blank)
    file = predict.os.path.relpath(exercise.__file__)
    asked = " ".join((function.__doc__ or "").split())
    print(predict.textwrap.fill(f"{number}  {blank}: {asked}", 96, subsequent_indent="   "),
          flush=True)
    return (f"{blank} is still a blank: in {file} fill the line marked \"TODO: blank {number}\"; "
            f"--hint {2 * number - 1} asks a question that helps")


def record(name, runs, scene):
    """Write outputs/ch3.5-contact/ex2-NAME.rrd: yours beside contact.py's, called reference."""
    path = f"outputs/ch3.5-contact/ex2-{name}.rrd"
    try:
        with patch.dict(contact.COLORS, yours="#e69f00", reference="#56b4e9"):
            contact.log_rerun(path, runs, scene)
    except ImportError:
        print(f"    no recording: {predict.shell.install('rerun-sdk')}")
    except OSError as error:
        print(f"    no recording: cannot write {error.filename}: {error.strerror}")
    else:
        print(f"    watch it: {predict.shell.tool('rerun')} {path}")


def tried(exercise, blank, recorded=False):
    """The trials of one blank, and a word on each. Returns the exit status."""
    function = getattr(exercise, blank)
    got, trouble = called(function, blank, inputs(blank)[2])
    if got is ... or trouble:
        print(trouble or unfilled(exercise, blank), file=sys.stderr)
        return 2
    status = 0
    print(f"{'lengths in ball radii':<52}{'yours':>10}{'contact.py':>12}")
    for trial in TRIALS[blank]:
        theirs, expected, scene = trial()
        try:
            with yours(exercise), np.errstate(all="ignore"):
                mine, seen, _ = trial()
        except Exception as error:
            print(f"{blank} raised {type(error).__name__}: {error}", file=sys.stderr)
            return 2
        same = np.allclose(mine.q, theirs.q, rtol=0.0, atol=WITHIN)
        print(trial.__doc__.partition(":")[0])
        for name, value in expected.items():
            print(f"    {name:<48}{round(seen[name], 6):>10.3g}{round(value, 6):>12.3g}")
        print("    " + ("the same run" if same else f"another run: look at {blank}"))
        status = max(status, 0 if same else 1)
        if recorded:
            record(trial.__name__, {"yours": mine, "reference": theirs}, scene)
    if status:
        values = [called(function, blank, case)[0] for case in inputs(blank)]
        likely = None if None in values else slip(blank, values)
        if likely:
            print(f"{blank}: {likely}")
    return status
