"""Bets: what is measured, and a word on every choice; and numbers from paper."""

import math
import re
import statistics
import textwrap
from functools import cache

import contact
from curriculum.commands import near

from . import FACTS, ROOT, load
from .script import ask, task_of

USUAL, MODELS = contact.Settings(), ("penalty", "lcp")  # the models of which one bets
SOLVED = {name: load(ROOT / f"exercises/solutions/{name}.py") for name in FACTS}
RIGHT = {what: right for each in SOLVED.values() for what, right in vars(each).items()}  # by name


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    lines = [(corner, *heads), *((name, *map(form.format, row)) for name, row in rows.items())]
    return "\n".join(f"{first:<16}" + "".join(f"{x:>15}" for x in rest) for first, *rest in lines)


def quality(key, model, scene, dt, steps=2000, settings=USUAL):
    """A measure of a run."""
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt)[key]


@cache
def measure(name):
    """The numbers of a bet, {MODEL_LABEL: number}, and what its reasons quote beside them."""
    facts = FACTS[name]
    numbers = {key: eval(text, vars(contact)) for key, text in facts["also"].items()}
    for label, row in facts["measured"].items():
        scene = contact.scene_of(0.0, row["y"], row["mass"])
        for model in MODELS:
            numbers[f"{model}_{label}"] = quality(row["key"], model, scene, row["dt"])
    return numbers


def table(name, numbers):
    """The measurement of a bet as text."""
    facts = FACTS[name]
    heads = {label: row["head"] for label, row in facts["measured"].items() if row["head"]}
    rows = {model: [numbers[f"{model}_{label}"] for label in heads] for model in MODELS}
    return columns(facts["corner"], heads.values(), rows, facts["form"])


def asked(text):
    """What the docstring of a bet says: {task, question, choices {letter: choice}, why}."""
    _title, *task, question, choices, why, _then = text.strip().split("\n\n")
    found = re.findall(r"^    ([A-Z])  (.*(?:\n     .*)*)", choices, re.MULTILINE)
    return {
        "task": "\n\n".join(task),
        "question": " ".join(question.split()),  # which the page asks
        "choices": {letter: " ".join(words.split()) for letter, words in found},
        "why": " ".join(why.split()),  # what the sentence should say
    }


def judge_bet(name, exercise):
    """(state, words) of a bet: its numbers, and a word on every choice."""
    bet, file = asked(task_of(name)), near(exercise.__file__)
    given, why = getattr(exercise, "PREDICTION", None), str(getattr(exercise, "WHY", ""))
    choices, mine = bet["choices"], str(given).strip(" \t\n.)(").upper()
    if mine not in choices:
        made = "no prediction yet" if given is None else f"PREDICTION is {given!r}"
        write = f"write one of {', '.join(map(repr, choices))} in {file}"
        return "blank", f"{made}; {write}{ask(exercise.__file__, 1)}"
    if len(why.split()) < 4:
        wanted = f"write a sentence of four words or more in {file}. {bet['why']}"
        return "blank", f"no reason yet: WHY is {why!r}; {wanted}"
    numbers, facts, right = measure(name), FACTS[name], SOLVED[name].PREDICTION
    so = "That is what happens." if mine == right else f"What happens is {right}: {choices[right]}"
    lines = [f"You predicted {mine}: {choices[mine]}", f"Because: {why.strip()}", "", so]
    for choice in (right, *(choice for choice in choices if choice != right)):
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {facts['reasons'][choice].format(**numbers)}"]
    lines += ["", facts["shown"].format(**numbers)]
    verdict = "\n".join(textwrap.fill(line, 96) for line in lines)
    return "right", f"{table(name, numbers)}\n\n{verdict}"


# Exercise 9: five troubles against four knobs


KNOBS = {"k x 4": "stiffness", "dt / 4": "dt", "sweeps x 4": "iters", "beta x 4": "baumgarte"}
TROUBLES = FACTS["ex9"]["troubles"]  # model, scene, balls, dt [s], steps, measure, seeds


def trouble_of(trouble, knob=None):
    """How large a trouble is, with that knob turned."""
    model, scene, bodies, dt, steps, key, seeds = TROUBLES[trouble]
    settings, by = USUAL, 4 if knob == "dt" else 1
    if knob in USUAL._fields:
        settings = USUAL._replace(**{knob: 4 * getattr(USUAL, knob)})
    scenes = [contact.build_scene(scene, seed, bodies) for seed in range(seeds)]
    return statistics.fmean(quality(key, model, s, dt / by, by * steps, settings) for s in scenes)


@cache
def measure_knobs():
    """{trouble: [what each knob makes of it, as a share]}, and what the reasons quote."""
    quoted, shares = {}, {}
    for trouble in TROUBLES:
        quoted[trouble] = trouble_of(trouble)
        shares[trouble] = [trouble_of(trouble, k) / quoted[trouble] for k in KNOBS.values()]
        quoted |= {f"{trouble}_{k.split()[0]}": x for k, x in zip(KNOBS, shares[trouble])}
    limit = contact.critical_dt(1.0, USUAL.stiffness, contact.build_scene("stack").damping, 3)
    return shares, quoted | {"step": TROUBLES["trembling"][3], "limit": limit}


def mark(share):
    """-, = or +: what became of a trouble, as a share of what it was."""
    return "-" if share <= 0.5 else "+" if share >= 2.0 else "="


def judge_knobs(name, exercise):
    """(state, words) of the twenty bets."""
    lines = str(getattr(exercise, "BETS", "")).replace("\N{MINUS SIGN}", "-").splitlines()
    mine = {words[0]: words[1:] for line in lines if (words := line.split())}
    for trouble in TROUBLES:
        given = mine.get(trouble, ["nothing"])
        if len(given) != len(KNOBS) or set(given) - set("-=+"):
            hint = ask(exercise.__file__, 1)
            row = f"BETS in {near(exercise.__file__)}, row {trouble}: given {' '.join(given)}"
            return "blank", f"{row}, allowed: four marks, each - (less), = or + (more){hint}"
    rows, hits, words = {}, 0, ""
    shares, quoted = measure_knobs()
    for trouble, row in shares.items():
        true, guessed = [*map(mark, row)], mine[trouble]
        rows[trouble] = [
            f"{share:.3g} {sign}" + ("" if sign == guess else f" ({guess})")
            for share, sign, guess in zip(row, true, guessed)
        ]
        hits += sum(map(str.__eq__, true, guessed))
        reason = FACTS[name]["reasons"][trouble].format(**quoted)
        words += "\n" + textwrap.fill(f"{trouble}: {reason}", 96) + "\n"
    said = f"Your bet holds in {hits} of 20; where it was another, it stands in brackets."
    return "right", f"{columns('times as much', KNOBS, rows, '{}')}\n{said}\n{words}"


def judge_number(name, exercise):
    """(state, words) of a number from paper; its slips are other formulas."""
    facts = FACTS[name]["number"]
    what, within, hint = facts["name"], facts["within"], ask(exercise.__file__, facts["hint"])
    given, true = getattr(exercise, what, None), RIGHT[what]
    try:
        mine = abs(float(given))  # the table says an overlap with a minus
    except (TypeError, ValueError, OverflowError):
        said = f"no {what} yet" if given is None else f"{what}: given {given!r}"
        file = near(exercise.__file__)
        return "blank", f"{said}; write a number in {file}, {facts['unit']}{hint}"
    if math.isclose(mine, true, rel_tol=within):
        return "right", facts["right"].format(true)
    for text, meaning in facts["slips"].items():
        if math.isclose(mine, eval(text), rel_tol=within):  # our own text
            return "wrong", f"{what}: given {given}; likely: {meaning}"
    return "wrong", f"{what}: given {given}, and it is another{hint}"
