"""Bets, what is measured, and a word on every choice; and numbers that were worked out on paper."""

import math
import re
import statistics
import textwrap
from functools import cache

import contact
from curriculum.commands import near

from . import FACTS, columns, task_of

USUAL = contact.Settings()
README = 1.0, 1.0, 0.002  # of its first line: ball [kg], height [m], step [s]
BETS = {  # exercise: corner of its table, how a number is written, steps, {label: (head of its
    # column, key of contact_quality, ball [kg], height [m], dt [s])}
    "ex1": ("depth", "{:.5f} r", 2000, {
        "deepest": ("deepest", "max_penetration_frac", 4.0, 0.65, 0.002),
        "at_rest": ("at rest", "rest_penetration_frac", 4.0, 0.65, 0.002),
        "shown_deepest": ("", "max_penetration_frac", *README),
        "shown_at_rest": ("", "rest_penetration_frac", *README)}),
    "ex3": ("energy gained", "{:.4g}", 2000, {
        "light": ("0.1 kg", "energy_excess", 0.1, 0.65, 0.03),
        "heavy": ("10 kg", "energy_excess", 10.0, 0.65, 0.03),
        "light_depth": ("", "max_penetration_frac", 0.1, 0.65, 0.03),
        "shown": ("", "energy_excess", 1.0, 1.0, 0.03)}),
}  # fmt: skip
MODELS = "penalty", "lcp"  # of which one bets


def quality(model, scene, dt, steps, settings=USUAL):
    """The measures of a run."""
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt)


@cache
def measure(name):
    """The numbers of a bet, {MODEL_LABEL: number}, and what its reasons quote beside them."""
    *_, steps, parts = BETS[name]
    numbers = {
        f"{model}_{label}": quality(model, contact.scene_of(0.0, y, mass), dt, steps)[key]
        for label, (_, key, mass, y, dt) in parts.items()
        for model in MODELS
    }
    known = numbers | {"critical_dt": contact.critical_dt}
    return numbers | {key: eval(text, known.copy()) for key, text in FACTS[name]["also"].items()}


def table(name, numbers):
    """The measurement of a bet as text."""
    corner, form, _, parts = BETS[name]
    heads = {label: head for label, (head, *_) in parts.items() if head}
    rows = {model: [numbers[f"{model}_{label}"] for label in heads] for model in MODELS}
    return columns(corner, heads.values(), rows, form)


def answer(name, numbers):
    """The one letter whose claim holds for what was measured."""
    claims = FACTS[name]["key"].items()
    (right,) = [letter for letter, claim in claims if eval(claim, {"abs": abs}, numbers)]
    return right


def asked(text):
    """What the docstring of a bet says: {task, question, choices {letter: choice}, why}."""
    _title, *task, question, choices, why, _then, _commands = text.strip().split("\n\n")
    found = re.findall(r"^    ([A-Z])  (.*(?:\n     .*)*)", choices, re.MULTILINE)
    return {
        "task": "\n\n".join(task),
        "question": " ".join(question.split()),
        "choices": {letter: " ".join(words.split()) for letter, words in found},
        "why": " ".join(why.split()),  # what the sentence should say
    }


def judge_bet(name, exercise):
    """[what, state, words, shown] of a bet: its numbers, and a word on every choice."""
    bet, file = asked(task_of(exercise)), near(exercise.__file__)
    given, why = getattr(exercise, "PREDICTION", None), str(getattr(exercise, "WHY", ""))
    choices, mine = bet["choices"], str(given).strip(" \t\n.)(").upper()
    if mine not in choices:
        made = "no prediction yet" if given is None else f"PREDICTION is {given!r}"
        words = f"{made}; write one of {', '.join(map(repr, choices))} in {file}"
        return [name, "blank", words, ""]
    if len(why.split()) < 4:
        wanted = f"write a sentence of four words or more in {file}. {bet['why']}"
        return [name, "blank", f"no reason yet: WHY is {why!r}; {wanted}", ""]
    numbers = measure(name)
    right, facts = answer(name, numbers), FACTS[name]
    lines = [
        f"You predicted {mine}: {choices[mine]}",
        f"Because: {why.strip()}",
        "",
        "That is what happens." if mine == right else f"What happens is {right}: {choices[right]}",
    ]
    for choice in sorted(choices, key=lambda choice: choice != right):  # the right one first
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {facts['reasons'][choice].format(**numbers)}"]
    lines += ["", facts["shown"].format(**numbers)]
    verdict = "\n".join(textwrap.fill(line, 96) for line in lines)
    return [name, "right", verdict, f"{table(name, numbers)}\n"]


# Exercise 9: five troubles against four knobs


KNOBS = {  # head: (what dt is divided by, settings)
    "k x 4": (1, USUAL._replace(stiffness=4 * USUAL.stiffness)),
    "dt / 4": (4, USUAL),
    "sweeps x 4": (1, USUAL._replace(iters=4 * USUAL.iters)),
    "beta x 4": (1, USUAL._replace(baumgarte=4 * USUAL.baumgarte)),
}
TROUBLES = {  # model, scene, balls, dt [s], steps, measure, seeds
    "sink": ("penalty", "drop", 1, 0.002, 2000, "rest_penetration_frac", 1),
    "dive": ("lcp", "drop", 1, 0.002, 600, "max_penetration_frac", 9),
    "hop": ("lcp", "drop", 1, 0.002, 600, "rebound_frac", 9),
    "sag": ("lcp", "stack", 10, 0.002, 1000, "rest_penetration_frac", 1),
    "trembling": ("penalty", "stack", 3, 0.006, 2000, "rest_jitter", 1),
}


@cache
def measure_knobs():
    """{trouble: [what each knob makes of it, as a share]}, and what the reasons quote."""
    quoted, shares = {}, {}
    for trouble, (model, scene, bodies, dt, steps, key, seeds) in TROUBLES.items():
        scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
        quoted[trouble], *turned = (
            statistics.fmean(quality(model, of, dt / by, by * steps, knobs)[key] for of in scenes)
            for by, knobs in ((1, USUAL), *KNOBS.values())
        )
        shares[trouble] = [number / quoted[trouble] for number in turned]
        quoted |= {f"{trouble}_{k.split()[0]}": x for k, x in zip(KNOBS, shares[trouble])}
    limit = contact.critical_dt(1.0, USUAL.stiffness, contact.build_scene("stack").damping, 3)
    return shares, quoted | {"step": TROUBLES["trembling"][3], "limit": limit}


def mark(share):
    """-, = or +: what became of a trouble, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


def judge_knobs(name, exercise):
    """[what, state, words, shown] of the twenty bets."""
    lines = str(getattr(exercise, "BETS", "")).replace("\N{MINUS SIGN}", "-").splitlines()
    mine = {words[0]: words[1:] for line in lines if (words := line.split())}
    for trouble in TROUBLES:
        given = mine.get(trouble, ["nothing"])
        if len(given) != len(KNOBS) or set(given) - set("-=+"):
            row = f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}"
            words = f"{row}, allowed: four marks, each - (less), = or + (more)"
            return [name, "blank", words, ""]
    rows, hits = {}, 0
    shares, quoted = measure_knobs()
    for trouble, row in shares.items():
        pairs = [(mark(share), guess) for share, guess in zip(row, mine[trouble])]
        hits += sum(true == guess for true, guess in pairs)
        rows[trouble] = [
            f"{share:.3g} {true}" + ("" if true == guess else f" ({guess})")
            for share, (true, guess) in zip(row, pairs)
        ]
    words = f"Your bet holds in {hits} of 20; where it was another, it stands in brackets.\n"
    for trouble, reason in FACTS[name]["reasons"].items():
        words += "\n" + textwrap.fill(f"{trouble}: {reason.format(**quoted)}", 96) + "\n"
    return [name, "right", words, columns("times as much", KNOBS, rows, "{}")]


# Numbers


SOFT = 3.0, (0.05, 1.0), (0.8, 0.8, 0.001, 0.5, 2.0)  # exercise 4: mass [kg], solref, solimp
TOWER = {"bodies": 7, "dt": 0.001, "beta": 0.5}  # exercise 9: one sweep a step


@cache
def soft_depth():
    """How deep the ball of exercise 4 rests [r]."""
    settings = USUAL._replace(solref=SOFT[1], solimp=SOFT[2])
    ball = contact.build_scene("drop", mass=SOFT[0])
    return quality("soft", ball, 0.002, 2000, settings)["rest_penetration_frac"]


@cache
def sag():
    """How deep the lowest ball of exercise 9's tower lies [r]."""
    tower = contact.build_scene("stack", 0, TOWER["bodies"])
    settings = USUAL._replace(iters=1, baumgarte=TOWER["beta"])
    return quality("lcp", tower, TOWER["dt"], 2000, settings)["rest_penetration_frac"]


def judge_number(name, exercise, true, **known):
    """[what, state, words, shown] of a number; its slips are formulas of what is `known`."""
    facts, file = FACTS[name]["number"], near(exercise.__file__)
    what, within = facts["name"], facts["within"]
    given = getattr(exercise, what, None)
    try:
        mine = abs(float(given))  # the table says an overlap with a minus
    except (TypeError, ValueError, OverflowError):
        said = f"no {what} yet" if given is None else f"{what}: given {given!r}"
        return [what, "blank", f"{said}; write a number in {file}, {facts['unit']}", ""]
    if math.isclose(mine, true, rel_tol=within):
        return [what, "right", facts["right"].format(true), ""]
    for text, meaning in facts["slips"].items():
        if math.isclose(mine, eval(text, {}, known), rel_tol=within):
            return [what, "wrong", f"{what}: given {given}; likely: {meaning}", ""]
    words = f"{what}: given {given}, and it is another; --hint {facts['hint']} asks a question"
    return [what, "wrong", words, ""]
