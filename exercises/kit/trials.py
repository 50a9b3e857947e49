"""Shows what a learner wrote at work: runs under it, in contact.py's own table."""

import contextlib
import inspect
import io
import math
from functools import partial
from unittest import mock

import contact
from curriculum.commands import near
from curriculum.implicit import implicit_step

from . import FACTS
from .bets import RIGHT
from .script import ask

DROP, STACK = contact.build_scene("drop"), contact.build_scene("stack")
GROOVE = contact.scene_of([0.0, -0.105, 0.105], [0.8, 0.1, 0.1], [1.0, math.inf, math.inf])
SLIDE = contact.scene_of([0.0, 0.06], [0.1, 0.1 + math.sqrt(0.04 - 0.0036)], [math.inf, 1.0])
INSIDE = contact.scene_of(0.0, [0.1, 0.25])  # one ball begins in the other


def table(runs):
    """contact.py's table of {name: (run, scene)}, as text."""
    rows = {}
    for name, (run, scene) in runs.items():
        exact = contact.run_model("exact", scene, run.t[1], len(run.t) - 1)
        rows[name] = contact.contact_quality(run, scene, run.t[1], exact)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        contact.print_table(rows, contact.ending)
    return said.getvalue()


def compare(name, model, scene, exercise):
    """A run under the learner's function in the place of contact.py's, beside its own."""
    where, mine = name, getattr(exercise, name)
    if name == "project_impulse":  # which contact.py writes out in its sweep
        where, mine = "solve_contacts", solver("max(0.0, c.lam + add)", "f(c.lam, add)", f=mine)
    own = contact.run_model(model, scene, 0.002, 1000)
    with mock.patch.object(contact, where, mine):
        yours = contact.run_model(model, scene, 0.002, 1000)
    return table({"yours": (yours, scene), "contact.py": (own, scene)})


def solver(*changes, **names):
    """The right solve_contacts, with (old, new) exchanged; `names` are what it may use."""
    text = inspect.getsource(RIGHT["solve_contacts"])
    for old, new in zip(changes[::2], changes[1::2]):
        text = text.replace(old, new)
    exec(text, names)
    return names["solve_contacts"]


def cliffs(exercise):
    """The longest steps that the learner found, beside two formulas."""
    lines = ["longest step [s]        yours  critical_dt  2 sqrt(m / k)"]
    for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0)):
        mine, formula = exercise.longest_step(1.0, k, c), contact.critical_dt(1.0, k, c)
        lines += [f"k {k:<7g} c {c:<5g}{mine:>13.5f}{formula:>13.5f}{2.0 / math.sqrt(k):>15.5f}"]
    lines += ["critical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer.\n"]
    return "\n".join(lines)


def drops(exercise):
    """The drop under the learner's spring and under penalty, at longer steps."""
    runs = {}
    for dt in (0.002, 0.008, 0.016):
        spring = partial(exercise.implicit_spring, stiffness=1e4, damping=80.0, dt=dt)
        step, count = partial(implicit_step, dt=dt, spring=spring), int(8.0 / dt)
        runs[f"yours, {dt:g} s"] = contact.simulate(step, DROP, dt, count), DROP
        runs[f"penalty, {dt:g} s"] = contact.run_model("penalty", DROP, dt, count), DROP
    return table(runs)


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


def ask_twice(exercise):
    """The learner's step and lcp's, beside exact."""
    runs = {}
    for name, scene, dt, seconds in (
        ("drop", DROP, 0.002, 1.0),
        ("stack", STACK, 0.002, 1.0),
        ("slide", SLIDE, 0.002, 0.4),
        ("slide, dt / 4", SLIDE, 0.0005, 0.4),
        ("inside", INSIDE, 0.002, 0.6),
    ):
        step, count = partial(asking_twice, exercise, dt=dt), round(seconds / dt)
        runs[f"yours, {name}"] = contact.simulate(step, scene, dt, count), scene
        runs[f"lcp, {name}"] = contact.run_model("lcp", scene, dt, count), scene
    return table(runs)


SHOWN = {  # blank: what shows it at work; of two that work together, the second
    "penalty_normal_force": partial(compare, "penalty_normal_force", "penalty", DROP),
    "project_impulse": partial(compare, "project_impulse", "lcp", GROOVE),
    "solve_contacts": partial(compare, "solve_contacts", "lcp", GROOVE),
    "longest_step": cliffs,
    "implicit_spring": drops,
    "after_the_move": ask_twice,
}


# The gripper of exercise 8


def gripper(exercise):
    """(scene, step) by the model and the numbers chosen. ValueError for what is not allowed."""
    cup = contact.scene_of([-0.205, 0.0, 0.205], 0.1, [0.2, 1, 0.2], damping=exercise.DAMPING)
    settings = contact.Settings(exercise.STIFFNESS, solref=exercise.SOLREF, solimp=exercise.SOLIMP)
    model, dt, k = exercise.MODEL, exercise.DT, exercise.STIFFNESS
    contact.checked("soft", cup, dt, 1, settings)
    if not 0.0005 <= dt <= 0.02 or not k >= 1.0:
        allowed = "DT from 0.0005 to 0.02 s, STIFFNESS from 1 N/m"
        raise ValueError(f"given DT = {dt:g}, STIFFNESS = {k:g}; allowed: {allowed}")
    if model == "implicit":
        spring = partial(RIGHT["implicit_spring"], stiffness=k, damping=cup.damping, dt=dt)
        return cup, partial(implicit_step, dt=dt, spring=spring)
    if model not in ("penalty", "soft"):
        rigid = f". {FACTS['ex8']['rigid']}" if model in [*contact.MODELS] else ""
        raise ValueError(f"MODEL: given {model!r}; allowed: penalty, implicit, soft{rigid}")
    return cup, contact.step_of(model, cup, dt, settings)


def judge_gripper(name, exercise):
    """(state, words) of what is chosen in exercise 8, by what the gripper does."""
    if exercise.MODEL is None:
        file = exercise.__file__
        return "blank", f"no choice yet: set MODEL in {near(file)}{ask(file, 1)}"
    try:
        cup, step = gripper(exercise)
    except ValueError as error:
        return "wrong", str(error)

    def squeezed(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):  # the motors [N]
            ball.fx, ball.fy = force, 0.0
        return step(balls)

    dt, k, c = exercise.DT, exercise.STIFFNESS, exercise.DAMPING
    run = contact.simulate(squeezed, cup, dt, math.ceil(1.0 / dt - 1e-9))
    found = contact.contact_quality(run, cup, dt)
    deepest, trembling = found["rest_penetration_frac"], found["rest_jitter"]
    faults = ["it trembles"] if not trembling < 1e-5 else []
    faults += ["it overlaps too much"] if not deepest < 1.001e-3 else []
    if not (abs(run.q[-1, 0]) < 0.3).all():
        faults = ["the cup is gone: the fingers flew off or went through it"]
    shown = f"overlap {deepest:.2g} r, trembling {trembling:.2g} r"
    if not faults:
        return "right", f"{shown}: it holds still"
    longest, advice = contact.critical_dt(0.1, k, c), FACTS[name]["advice"][exercise.MODEL]
    advice = advice.format(k=k, pressed=200.0 / k, longest=longest, settles=c / k)
    return "wrong", f"{shown}\n{', and '.join(faults)}; {advice}"
