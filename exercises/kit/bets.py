"""Bets: what is measured, and a word on every choice; marks; and numbers from paper."""

import math
import re
import statistics
import textwrap
from functools import cache

import contact
from curriculum import predict
from curriculum.commands import near

from . import FACTS, ROOT, load
from .script import ask, task_of

USUAL, MODELS = contact.Settings(), ("penalty", "lcp")  # the models of which one bets
SOLVED = {name: load(ROOT / f"exercises/solutions/{name}.py") for name in FACTS}
RIGHT = {what: right for each in SOLVED.values() for what, right in vars(each).items()}  # by name


def columns(corner, heads, rows, form):
    """Return a small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r"."""
    lines = [(corner, *heads), *((name, *map(form.format, row)) for name, row in rows.items())]
    return "\n".join(f"{first:<16}" + "".join(f"{x:>15}" for x in rest) for first, *rest in lines)


def quality(key, model, scene, dt, steps=2000, settings=USUAL):
    """Return a measure of a run, beside exact if it needs that."""
    exact = contact.run_model("exact", scene, dt, steps) if key == "force_error" else None
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt, exact)[key]


@cache
def measure(name):
    """Return the numbers of a bet {MODEL_LABEL: number}, and what its reasons quote beside them."""
    facts = FACTS[name]
    numbers = {key: eval(text, vars(contact)) for key, text in facts["also"].items()}
    for label, row in facts["measured"].items():
        scene = contact.scene_of(0.0, contact.RADIUS + row["fall"], row["mass"])
        for model in MODELS:
            numbers[f"{model}_{label}"] = quality(row["key"], model, scene, row["dt"])
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
    return {
        "task": "\n\n".join(task),
        "question": " ".join(question.split()),  # which the page asks
        "choices": {letter: " ".join(words.split()) for letter, words in found},
        "why": " ".join(why.split()),  # what the sentence should say
    }


def judge_bet(name, exercise):
    """Return (state, words) of a bet: its numbers, and a word on every choice."""
    bet, file = asked(task_of(name)), near(exercise.__file__)
    given, why = getattr(exercise, "PREDICTION", None), str(getattr(exercise, "WHY", ""))
    choices, mine = bet["choices"], str(given).strip(" \t\n.)(").upper()
    if mine not in choices:
        made = "no prediction yet" if given is None else f"PREDICTION: given {given!r}"
        write = f"write one of {', '.join(map(repr, choices))} in {file}"
        return "blank", f"{made}; {write}{ask(exercise.__file__, 1)}"
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


# Exercise 11: six errors against the knobs of their models


KNOBS = {"k x 4": "stiffness", "dt / 4": "dt", "sweeps x 4": "iters", "beta x 4": "baumgarte",
         "d0 = 0": "solimp"}  # fmt: skip
ERRORS = FACTS["ex11"]["errors"]


def error_of(name, knob=None):
    """Return how large an error is, with that knob turned."""
    model, scene, bodies, dt, steps, key, seeds = ERRORS[name]["run"]
    settings, by = USUAL, 4 if knob == "dt" else 1
    if knob == "solimp":
        settings = USUAL._replace(solimp=(0.0, *contact.SOLIMP[1:]))
    elif knob in USUAL._fields:
        settings = USUAL._replace(**{knob: 4 * getattr(USUAL, knob)})
    scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
    return statistics.fmean(quality(key, model, s, dt / by, by * steps, settings) for s in scenes)


@cache
def measure_knobs():
    """Return {error: {knob: what it makes of it, as a share}}, and what the reasons quote."""
    quoted = {name: error_of(name) for name in ERRORS}
    shares = {
        name: {knob: error_of(name, KNOBS[knob]) / quoted[name] for knob in facts["knobs"]}
        for name, facts in ERRORS.items()
    }
    quoted |= {f"{name}_{k.split()[0]}": x for name in shares for k, x in shares[name].items()}
    limit = contact.critical_dt(1.0, USUAL.stiffness, contact.build_scene("stack").damping, 3)
    return shares, quoted | {"step": ERRORS["tremble"]["run"][3], "limit": limit}


def mark(share):
    """Return -, = or +: what became of an error, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


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
        guesses = dict(zip(row, mine[error]))
        hits += [mark(share) == guesses[knob] for knob, share in row.items()]
        rows[error] = [
            f"{row[k]:.3g} {mark(row[k])}" + f" ({guesses[k]})" * (guesses[k] != mark(row[k]))
            if k in row
            else "."
            for k in KNOBS
        ]
        reason = FACTS[name]["reasons"][error].format(**quoted)
        words += "\n" + textwrap.fill(f"{error}: {reason}", 96) + "\n"
    said = f"Your bet holds in {sum(hits)} of {len(hits)}; another one stands in brackets."
    return "right", f"{columns('times as much', KNOBS, rows, '{}')}\n{said}\n{words}"


# Numbers from paper, and the gripper


FINGER, CUP, FORCE = 0.2, 1.0, 20.0  # kg, kg, N


def gripper(cup=CUP, damping=0.0):
    """Return the scene of two fingers beside a cup of that mass [kg], balls on the floor."""
    x, mass = 2.05 * contact.RADIUS, [FINGER, cup, FINGER]
    return contact.scene_of([-x, 0.0, x], contact.RADIUS, mass, damping=damping)


def squeeze(step, scene, dt):
    """Return the run of a second in which motors press the fingers against the cup."""

    def squeezed(balls):
        for ball, force in zip(balls, (FORCE, 0.0, -FORCE)):
            ball.fx, ball.fy = force, 0.0
        return step(balls)

    return contact.simulate(squeezed, scene, dt, math.ceil(1.0 / dt - 1e-9))


def sag_of_gripper(dt, beta, cup):
    """Return how deep [r] the fingers lie in the cup, by lcp with a single sweep."""
    step = contact.step_of("lcp", gripper(cup), dt, USUAL._replace(iters=1, baumgarte=beta))
    run = squeeze(step, gripper(cup), dt)
    return contact.contact_quality(run, gripper(cup), dt)["rest_penetration_frac"]


NAMES = vars(math) | vars(contact) | vars(predict) | {"sag_of_gripper": sag_of_gripper}
NAMES |= {"g": -contact.GRAVITY, "r": contact.RADIUS, "F": FORCE, "finger": FINGER}


def judge_numbers(name, exercise):
    """Return (state, words) of the numbers from paper; common mistakes are other formulas."""
    found = [judge_number(exercise, what, **each) for what, each in FACTS[name]["numbers"].items()]
    states, words = zip(*found)
    return min(states, key=("wrong", "blank", "right").index), "\n".join(words)


def judge_number(exercise, what, true, unit, hint, within, right, slips, given=(), run="0", sign=1):
    """Return (state, words) of one number; with sign 0 it may also be negative, as a gap is."""
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
