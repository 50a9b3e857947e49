"""Shows what a learner wrote at work, beside a model and exact; and judges the gripper."""

import contextlib
import io
import math
from functools import partial

import contact
from curriculum.commands import near
from curriculum.variants import implicit_step

from . import FACTS
from .bets import FORCE, RIGHT, gripper, squeeze
from .script import ask

R, DAMPING = contact.RADIUS, contact.build_scene("drop").damping
DROP, STACK = contact.build_scene("drop"), contact.build_scene("stack")
SLIDE = contact.scene_of([0.0, 0.6 * R], [R, R + math.sqrt(4.0 - 0.36) * R], [math.inf, 1.0])
INSIDE = contact.scene_of(0.0, [R, 2.5 * R])  # one ball begins in the other


def table(model, cases, step):
    """Return contact.py's table of the learner's step(balls, dt=dt) beside a model's, as text.

    cases: (name, scene, time step [s], time [s]).
    """
    rows = {}
    for case, scene, dt, seconds in cases:
        count = round(seconds / dt)
        exact, own = (contact.run_model(each, scene, dt, count) for each in ("exact", model))
        yours = contact.simulate(partial(step, dt=dt), scene, dt, count)
        for name, run in ("yours", yours), (model, own):
            rows[f"{name} {case}"] = contact.contact_quality(run, scene, dt, exact)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        contact.print_table(rows, contact.final_state)
    return said.getvalue()


def cliffs(exercise):
    """Return the longest steps that the learner found, beside two formulas."""
    lines = ["longest step [s]        yours  critical_dt  2 sqrt(m / k)"]
    for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0)):
        mine, formula = exercise.longest_step(1.0, k, c), contact.critical_dt(1.0, k, c)
        lines += [f"k {k:<7g} c {c:<5g}{mine:>13.5f}{formula:>13.5f}{2.0 / math.sqrt(k):>15.5f}"]
    lines += ["critical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer.\n"]
    return "\n".join(lines)


def drops(exercise):
    """Return the drop under the learner's spring and under penalty, at longer steps."""
    constants = {"stiffness": contact.Settings().stiffness, "damping": DAMPING}

    def step(balls, dt):
        implicit_step(balls, dt, partial(exercise.implicit_spring, **constants, dt=dt))

    return table("penalty", [(f"at {dt:g} s", DROP, dt, 8.0) for dt in (0.002, 0.008, 0.016)], step)


def two_solves(exercise, balls, dt, iters=20):
    """Take one step of leapfrog's resting contacts, by the functions of exercise 6."""
    kick, _ = exercise.position_level(0.0, dt)
    contacts = contact.detect_contacts(balls, contact.detection_distance(balls, dt))
    for c in contacts:
        c.target = exercise.position_level(-c.depth, dt)[1]
    contact.accelerate(balls, kick * dt)
    contact.solve_contacts(contacts, iters)
    contact.move(balls, dt)
    contact.accelerate(balls, (1.0 - kick) * dt)
    active = []
    for c in contacts:
        x, y = (0.0, 1.0) if c.b is contact.FLOOR else (c.a.x - c.b.x, c.a.y - c.b.y)
        then, now = math.atan2(c.nx, c.ny), math.atan2(x, y)
        taken, c.target, c.lam, angle = exercise.velocity_level(c.lam, then, now)
        c.nx, c.ny = math.sin(angle), math.cos(angle)
        active += [c] if taken else []
    contact.solve_contacts(active, iters)


def compare_solves(exercise):
    """Return the learner's step and lcp's, beside exact."""
    cases = (
        ("on drop", DROP, 0.002, 1.0),
        ("on stack", STACK, 0.002, 1.0),
        ("on slide", SLIDE, 0.002, 0.4),
        ("on slide at dt / 4", SLIDE, 0.0005, 0.4),
        ("on overlap", INSIDE, 0.002, 0.6),
    )
    return table("lcp", cases, partial(two_solves, exercise))


SHOWN = {"ex3": cliffs, "ex6": compare_solves, "ex8": drops}


# The gripper of exercise 9


def chosen_step(exercise, cup):
    """Return the step that is chosen in exercise 9. ValueError for what is not allowed."""
    settings = contact.Settings(exercise.STIFFNESS, solref=exercise.SOLREF, solimp=exercise.SOLIMP)
    model, dt, k = exercise.MODEL, exercise.DT, exercise.STIFFNESS
    contact.validate("soft", cup, dt, 1, settings)
    if not 0.0005 <= dt <= 0.02 or not k >= 1.0:
        allowed = "DT from 0.0005 to 0.02 s, STIFFNESS from 1 N/m"
        raise ValueError(f"given DT = {dt:g}, STIFFNESS = {k:g}; allowed: {allowed}")
    if model == "implicit":
        spring = partial(RIGHT["implicit_spring"], stiffness=k, damping=cup.damping, dt=dt)
        return partial(implicit_step, dt=dt, spring=spring)
    if model not in ("penalty", "soft"):
        rigid = f". {FACTS['ex9']['rigid']}" if model in [*contact.MODELS] else ""
        raise ValueError(f"MODEL: given {model!r}; allowed: penalty, implicit, soft{rigid}")
    return contact.step_of(model, cup, dt, settings)


def judge_gripper(name, exercise):
    """Return (state, words) of what is chosen in exercise 9, by what the gripper does."""
    if exercise.MODEL is None:
        file = exercise.__file__
        return "blank", f"no choice yet: set MODEL in {near(file)}{ask(file, 1)}"
    dt, k, c = exercise.DT, exercise.STIFFNESS, exercise.DAMPING
    cup = gripper(damping=c)
    try:
        run = squeeze(chosen_step(exercise, cup), cup, dt)
    except ValueError as error:
        return "wrong", str(error)
    found = contact.contact_quality(run, cup, dt)
    deepest, trembling = found["rest_penetration_frac"], found["rest_jitter"]
    faults = ["it trembles"] if not trembling < 1e-5 else []
    faults += ["it overlaps too much"] if not deepest < 1.001e-3 else []
    faults += ["it gives way too little for a fingertip"] if deepest < 0.499e-3 else []
    if not (abs(run.q[-1, 0]) < 3.0 * R).all():
        faults = ["the cup is gone: the fingers flew off or went through it"]
    shown = f"overlap {deepest:.2g} r, trembling {trembling:.2g} r"
    if not faults:
        return "right", f"{shown}: it holds still"
    values = {"k": k, "force": FORCE, "pressed": FORCE / k / R, "settles": c / k}
    advice = FACTS[name]["advice"][exercise.MODEL]
    advice = advice.format(**values, longest=contact.critical_dt(0.1, k, c))
    return "wrong", f"{shown}\n{', and '.join(faults)}; {advice}"
