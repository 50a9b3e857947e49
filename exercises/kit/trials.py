"""Shows what a learner wrote at work, beside a model and exact; and judges the gripper."""

import contextlib
import io
import math
from functools import partial

import contact
from curriculum.commands import near
from curriculum.variants import implicit_step

from . import FACTS
from .bets import RIGHT
from .script import ask

DROP, STACK = contact.build_scene("drop"), contact.build_scene("stack")
SLIDE = contact.scene_of([0.0, 0.06], [0.1, 0.1 + math.sqrt(0.04 - 0.0036)], [math.inf, 1.0])
INSIDE = contact.scene_of(0.0, [0.1, 0.25])  # one ball begins in the other


def table(model, cases, step):
    """contact.py's table of the learner's step, step(balls, dt=dt), beside a model's, as text.

    cases: (name, scene, time step [s], time [s]).
    """
    rows = {}
    for case, scene, dt, seconds in cases:
        count = round(seconds / dt)
        exact, own = (contact.run_model(each, scene, dt, count) for each in ("exact", model))
        yours = contact.simulate(partial(step, dt=dt), scene, dt, count)
        for name, run in ("yours", yours), (model, own):
            rows[f"{name}, {case}"] = contact.contact_quality(run, scene, dt, exact)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        contact.print_table(rows, contact.final_state)
    return said.getvalue()


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

    def step(balls, dt):
        spring = partial(exercise.implicit_spring, stiffness=1e4, damping=80.0, dt=dt)
        implicit_step(balls, dt, spring)

    return table("penalty", [(f"{dt:g} s", DROP, dt, 8.0) for dt in (0.002, 0.008, 0.016)], step)


def asking_twice(exercise, balls, dt, iters=20):
    """What lasts in leapfrog's step, by two functions of exercise 10."""
    kick, _ = exercise.before_the_move(0.0, dt)
    contacts = contact.detect_contacts(balls, contact.detection_distance(balls, dt))
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
    cases = (
        ("drop", DROP, 0.002, 1.0),
        ("stack", STACK, 0.002, 1.0),
        ("slide", SLIDE, 0.002, 0.4),
        ("slide, dt / 4", SLIDE, 0.0005, 0.4),
        ("inside", INSIDE, 0.002, 0.6),
    )
    return table("lcp", cases, partial(asking_twice, exercise))


SHOWN = {"ex6": cliffs, "ex7": drops, "ex10": ask_twice}


# The gripper of exercise 8


def gripper(exercise):
    """(scene, step) by the model and the numbers chosen. ValueError for what is not allowed."""
    cup = contact.scene_of([-0.205, 0.0, 0.205], 0.1, [0.2, 1, 0.2], damping=exercise.DAMPING)
    settings = contact.Settings(exercise.STIFFNESS, solref=exercise.SOLREF, solimp=exercise.SOLIMP)
    model, dt, k = exercise.MODEL, exercise.DT, exercise.STIFFNESS
    contact.validate("soft", cup, dt, 1, settings)
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
