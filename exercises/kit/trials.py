"""All that is run: bets, marks, numbers from paper, the gripper, and answers beside a model."""

import contextlib
import io
import math
import re
import statistics
import textwrap
from functools import cache, partial

import contact
from curriculum import predict
from curriculum.commands import near
from curriculum.variants import implicit_step, turn

from . import FACTS, ROOT, load
from .script import ask, task_of

USUAL, MODELS = contact.Settings(), ("penalty", "lcp")  # the models of which one bets
SOLVED = {name: load(ROOT / f"exercises/solutions/{name}.py") for name in FACTS}
RIGHT = {what: right for each in SOLVED.values() for what, right in vars(each).items()}  # by name


def columns(corner, heads, rows, form):
    """Return a small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r"."""
    lines = [(corner, *heads), *((name, *map(form.format, row)) for name, row in rows.items())]
    return "\n".join(f"{first:<16}" + "".join(f"{x:>15}" for x in rest) for first, *rest in lines)


@cache
def measure(name):
    """Return the numbers of a bet {MODEL_LABEL: number}, and the critical steps beside them."""
    numbers = {}
    for label, row in FACTS[name]["measured"].items():
        scene = contact.scene_of(0.0, contact.RADIUS + row["fall"], row["mass"])
        numbers[f"limit_{label}"] = contact.critical_dt(row["mass"], USUAL.stiffness, scene.damping)
        for model in MODELS:
            found = predict.quality(model, scene, row["dt"], 2000 * row["dt"])
            numbers[f"{model}_{label}"] = found[row["key"]]
    return numbers


def table(name, numbers):
    """Return the measurement of a bet as text."""
    facts = FACTS[name]
    heads = [row["head"] for row in facts["measured"].values()]
    rows = {model: [numbers[f"{model}_{label}"] for label in facts["measured"]] for model in MODELS}
    return columns(facts["corner"], heads, rows, facts["form"])


def asked(text):
    """Return what the docstring of a bet says: {task, question, choices {letter: choice}, why}."""
    _title, *task, question, choices, why, _then = text.strip().split("\n\n")
    found = re.findall(r"^    ([A-Z])  (.*(?:\n     .*)*)", choices, re.MULTILINE)
    choices = {letter: " ".join(words.split()) for letter, words in found}
    flat = {"question": " ".join(question.split()), "why": " ".join(why.split())}
    return {"task": "\n\n".join(task), "choices": choices} | flat


def judge_bet(name, exercise):
    """Return (state, words) of a bet: its numbers, and a word on every choice."""
    bet, file = asked(task_of(name)), near(exercise.__file__)
    given, why = getattr(exercise, "PREDICTION", None), str(getattr(exercise, "WHY", ""))
    choices, mine = bet["choices"], str(given).strip(" \t\n.)(").upper()
    if mine not in choices:
        made = "no prediction yet" if given is None else f"PREDICTION: given {given!r}"
        letters = f"write one of {', '.join(map(repr, choices))} in {file}"
        return "blank", f"{made}; {letters}{ask(exercise.__file__, 1)}"
    if len(why.split()) < 4:
        wanted = f"write a sentence of four words or more in {file}. {bet['why']}"
        return "blank", f"no reason yet, WHY is {why!r}; {wanted}"
    numbers, facts, right = measure(name), FACTS[name], SOLVED[name].PREDICTION
    so = "That is what happens." if mine == right else f"What happens is {right}: {choices[right]}"
    lines = [f"You predicted {mine}: {choices[mine]}", f"Because: {why.strip()}", "", so]
    for choice in (right, *(choice for choice in choices if choice != right)):
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {facts['reasons'][choice].format(**numbers)}"]
    verdict = "\n".join(textwrap.fill(line, 96) for line in lines)
    return "right", f"{table(name, numbers)}\n\n{verdict}"


ERRORS = FACTS["ex11"]["errors"]
KNOBS = {"k x 4": {"stiffness": 4.0 * USUAL.stiffness}, "dt / 4": {},
         "sweeps x 4": {"iters": 4 * USUAL.iters}, "beta x 4": {"baumgarte": 4.0 * USUAL.baumgarte},
         "d0 = 0": {"solimp": (0.0, *contact.SOLIMP[1:])}}  # fmt: skip


def error_of(name, knob=None):
    """Return how large an error is, with that knob turned."""
    model, scene, bodies, dt, steps, key, seeds = ERRORS[name]["run"]
    how = {"beside_exact": key == "force_error"} | KNOBS.get(knob, {})
    scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
    small = dt / 4 if knob == "dt / 4" else dt
    runs = (predict.quality(model, each, small, dt * steps, **how) for each in scenes)
    return statistics.fmean(run[key] for run in runs)


@cache
def measure_knobs():
    """Return {error: {knob: what it makes of it, as a share}}, and what the reasons quote."""
    quoted, shares = {name: error_of(name) for name in ERRORS}, {}
    for name, facts in ERRORS.items():
        shares[name] = {knob: error_of(name, knob) / quoted[name] for knob in facts["knobs"]}
        quoted |= {f"{name}_{knob.split()[0]}": x for knob, x in shares[name].items()}
    limit = contact.critical_dt(1.0, USUAL.stiffness, contact.build_scene("stack").damping, 3)
    return shares, quoted | {"step": ERRORS["tremble"]["run"][3], "limit": limit}


def judge_marks(name, exercise):
    """Return (state, words) of the marks, one for each knob that an error's model has."""
    lines = str(getattr(exercise, "BETS", "")).replace("\N{MINUS SIGN}", "-").splitlines()
    mine = {words[0]: [x for x in words[1:] if x != "."] for x in lines if (words := x.split())}
    for error, facts in ERRORS.items():
        given, count = mine.get(error, ["nothing"]), len(facts["knobs"])
        if len(given) != count or set(given) - set("-=+"):
            row = f"BETS in {near(exercise.__file__)}, row {error}: given {' '.join(given)}"
            allowed = f"expected {count} marks, each - (less), = or + (more)"
            return "blank", f"{row}; {allowed}{ask(exercise.__file__, 1)}"
    rows, hits, words = {}, [], ""
    shares, quoted = measure_knobs()
    for error, row in shares.items():
        rows[error] = dict.fromkeys(KNOBS, ".")
        for (knob, share), bet in zip(row.items(), mine[error]):
            mark = "-" if share <= 0.5 else "+" if share >= 2.0 else "="
            rows[error][knob] = f"{share:.3g} {mark}" + ("" if bet == mark else f" ({bet})")
            hits.append(bet == mark)
        reason = FACTS[name]["reasons"][error].format(**quoted)
        words += "\n" + textwrap.fill(f"{error}: {reason}", 96) + "\n"
    said = f"Your bet holds in {sum(hits)} of {len(hits)}; another one stands in brackets."
    rows = {error: row.values() for error, row in rows.items()}
    return "right", f"{columns('times as much', KNOBS, rows, '{}')}\n{said}\n{words}"


FINGER, CUP, FORCE = 0.2, 1.0, 20.0  # kg, kg, N


def gripper(cup=CUP, damping=0.0):
    """Return the scene of two fingers beside a cup of that mass [kg], balls on the floor."""
    x, mass = 2.05 * contact.RADIUS, [FINGER, cup, FINGER]
    return contact.scene_of([-x, 0.0, x], contact.RADIUS, mass, damping=damping)


def squeeze(step, scene, dt):
    """Return the run of a second in which motors press the fingers on the cup, and its quality."""

    def squeezed(balls):
        for ball, force in zip(balls, (FORCE, 0.0, -FORCE)):
            ball.fx, ball.fy = force, 0.0
        return step(balls)

    run = contact.simulate(squeezed, scene, dt, math.ceil(1.0 / dt - 1e-9))
    return run, contact.contact_quality(run, scene, dt)


NAMES = vars(math) | vars(contact) | vars(predict) | {"gripper": gripper, "squeeze": squeeze}
NAMES |= {"g": -contact.GRAVITY, "r": contact.RADIUS, "F": FORCE, "finger": FINGER}


def judge_number(exercise, what, true, unit, hint, within, right, slips, given=(), run="0", sign=1):
    """Return (state, words) of a number from paper; with sign 0 it may be negative, as a gap."""
    names, written, file = NAMES | dict(given), getattr(exercise, what, None), exercise.__file__
    true = eval(true, names)  # our own text
    try:
        mine = float(written) if sign else abs(float(written))
    except (TypeError, ValueError, OverflowError):
        said = f"no {what} yet" if written is None else f"{what}: given {written!r}"
        return "blank", f"{said}; write a number in {near(file)}, {unit}{ask(file, hint)}"
    if math.isclose(mine, true, rel_tol=within):
        return "right", right.format(true, eval(run, names))
    for text, meaning in slips.items():
        if math.isclose(mine, eval(text, names), rel_tol=within):
            return "wrong", f"{what}: given {written}; likely: {meaning}"
    return "wrong", f"{what}: given {written}, expected another number{ask(file, hint)}"


def cliffs(exercise):
    """Return the longest steps that the learner found, beside two formulas."""
    rows, heads = {}, ("yours", "critical_dt", "2 sqrt(m / k)")
    for k, c in ((1e4, 5.0), (1e4, 80.0), (1e6, 80.0), (1e3, 80.0)):
        two = contact.critical_dt(1.0, k, c), contact.critical_dt(1.0, k, 0.0)
        rows[f"k {k:g} c {c:g}"] = exercise.longest_step(1.0, k, c), *two
    words = "critical_dt solves k dt^2 + 2 c dt = 4 m: the damper brings the cliff nearer.\n"
    return f"{columns('longest step [s]', heads, rows, '{:.5f}')}\n{words}"


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
    """Return contact.py's table of the learner's step and lcp's, beside exact."""
    rows, r = {}, contact.RADIUS
    slide = contact.scene_of([0.0, 0.6 * r], [r, r + math.sqrt(3.64) * r], [math.inf, 1.0])
    for case, scene, dt, seconds in (
        ("drop", contact.build_scene("drop"), 0.002, 1.0),
        ("stack", contact.build_scene("stack"), 0.002, 1.0),
        ("slide", slide, 0.002, 0.4),
        ("slide at dt / 4", slide, 0.0005, 0.4),
        ("overlap", contact.scene_of(0.0, [r, 2.5 * r]), 0.002, 0.6),  # one begins in the other
    ):
        count = round(seconds / dt)
        exact, lcp = (contact.run_model(model, scene, dt, count) for model in ("exact", "lcp"))
        yours = contact.simulate(partial(two_solves, exercise, dt=dt), scene, dt, count)
        for name, run in ("yours", yours), ("lcp", lcp):
            rows[f"{name} on {case}"] = contact.contact_quality(run, scene, dt, exact)
    with contextlib.redirect_stdout(io.StringIO()) as said:
        contact.print_table(rows, contact.final_state)
    return said.getvalue()


SHOWN = {"ex3": cliffs, "ex6": compare_solves}


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
    if not (abs(run.q[-1, 0]) < 3.0 * contact.RADIUS).all():
        faults = ["the cup is gone: the fingers flew off or went through it"]
    shown = f"overlap {deepest:.2g} r, trembling {trembling:.2g} r"
    if not faults:
        return "right", f"{shown}: it holds still"
    values = {"k": k, "force": FORCE, "pressed": FORCE / k / contact.RADIUS, "settles": c / k}
    values["longest"] = contact.critical_dt(0.1, k, c)
    advice = FACTS[name]["advice"][model].format(**values)
    return "wrong", f"{shown}\n{', and '.join(faults)}; {advice}"
