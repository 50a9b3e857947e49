"""Shows what a learner wrote at work, beside a model and exact; and judges the gripper."""

import contextlib
import io
import math
from functools import partial

import contact
from curriculum.commands import near
from curriculum.variants import implicit_step, turn

from . import FACTS
from .bets import FORCE, RIGHT, columns, gripper, squeeze
from .script import ask

R = contact.RADIUS
DROP, STACK = contact.build_scene("drop"), contact.build_scene("stack")
SLIDE = contact.scene_of([0.0, 0.6 * R], [R, R + math.sqrt(4.0 - 0.36) * R], [math.inf, 1.0])
OVERLAP = contact.scene_of(0.0, [R, 2.5 * R])  # one ball begins in the other


def table(model, cases, step):
    """Return contact.py's table of a step and a model; cases: (name, scene, dt [s], time [s])."""
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
    rows, heads = {}, ("yours", "critical_dt", "2 sqrt(m / k)")
    for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0)):
        two = contact.critical_dt(1.0, k, c), contact.critical_dt(1.0, k, 0.0)
        rows[f"k {k:g} c {c:g}"] = exercise.longest_step(1.0, k, c), *two
    words = "critical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer.\n"
    return f"{columns('longest step [s]', heads, rows, '{:.5f}')}\n{words}"


def drops(exercise):
    """Return the drop under the learner's spring and under penalty, at longer steps."""

    def step(balls, dt):
        knobs = {"stiffness": contact.Settings().stiffness, "damping": DROP.damping, "dt": dt}
        implicit_step(balls, dt, partial(exercise.implicit_spring, **knobs))

    return table("penalty", [(f"at {dt:g} s", DROP, dt, 8.0) for dt in (0.002, 0.008, 0.016)], step)


def two_solves(exercise, balls, dt, iters=20):
    """Take one step of leapfrog's resting contacts, by the functions of exercise 6."""
    kick, _ = exercise.position_level(0.0, dt)
    contacts = contact.detect_contacts(balls, contact.detection_distance(balls, dt))
    for c in contacts:
        _, c.target = exercise.position_level(-c.depth, dt)
    contact.accelerate(balls, kick * dt)
    contact.solve_contacts(contacts, iters)
    contact.move(balls, dt)
    contact.accelerate(balls, (1.0 - kick) * dt)
    active = []
    for c in contacts:
        then = math.atan2(c.nx, c.ny)
        turn(c)
        now = math.atan2(c.nx, c.ny)
        taken, c.target, c.lam, angle = exercise.velocity_level(c.lam, then, now)
        c.nx, c.ny = math.sin(angle), math.cos(angle)
        active += [c] if taken else []
    contact.solve_contacts(active, iters)


def compare_solves(exercise):
    """Return the learner's step and lcp's, beside exact."""
    dt, step = 0.002, partial(two_solves, exercise)
    cases = [("on drop", DROP, dt, 1.0), ("on stack", STACK, dt, 1.0), ("on slide", SLIDE, dt, 0.4)]
    cases += [("on slide at dt / 4", SLIDE, dt / 4, 0.4), ("on overlap", OVERLAP, dt, 0.6)]
    return table("lcp", cases, step)


SHOWN = {"ex3": cliffs, "ex6": compare_solves, "ex8": drops}


def chosen_step(exercise, cup, model, dt, k):
    """Return the step that is chosen in exercise 9. ValueError for what is not allowed."""
    settings = contact.Settings(k, solref=exercise.SOLREF, solimp=exercise.SOLIMP)
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
    model, dt, k, c = exercise.MODEL, exercise.DT, exercise.STIFFNESS, exercise.DAMPING
    cup, file = gripper(damping=c), exercise.__file__
    if model is None:
        return "blank", f"no choice yet: set MODEL in {near(file)}{ask(file, 1)}"
    try:
        run, found = squeeze(chosen_step(exercise, cup, model, dt, k), cup, dt)
    except ValueError as error:
        return "wrong", str(error)
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
    values["longest"] = contact.critical_dt(0.1, k, c)
    advice = FACTS[name]["advice"][model].format(**values)
    return "wrong", f"{shown}\n{', and '.join(faults)}; {advice}"
