"""Exercises 1, 3 and 4: a bet, what is measured, and a word on every choice."""

import re
import textwrap
from typing import NamedTuple

import contact
from curriculum.commands import near

from . import FACTS, columns, task_of


class Part(NamedTuple):
    """A number of the drop by each model: the head of its column, if any, and how it comes."""

    head: str
    key: str  # of contact_quality
    dt: float = 0.002  # s
    steps: int = 2000
    mass: float = 1.0  # kg


# fmt: off
BETS = {  # exercise: corner of its table, models, how a number is written, parts
    "ex1": ("depth", ("penalty", "lcp"), "{:.5f} r", {
        "deepest": Part("deepest", "max_penetration_frac", steps=800),
        "at_rest": Part("at rest", "rest_penetration_frac", steps=800)}),
    "ex3": ("energy gained", ("penalty", "lcp"), "{:.4g}", {
        "usual": Part("dt = 0.002 s", "energy_excess", dt=0.002),
        "long": Part("dt = 0.03 s", "energy_excess", dt=0.03),
        "long_depth": Part("", "max_penetration_frac", dt=0.03)}),
    "ex4": ("depth at rest", ("soft", "penalty"), "{:.5f} r", {
        "light": Part("1 kg", "rest_penetration_frac", mass=1.0),
        "heavy": Part("10 kg", "rest_penetration_frac", mass=10.0)}),
}
# fmt: on


def quality(model, scene, dt, steps, settings=contact.Settings()):
    """The measures of a run."""
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt)


def measure(name):
    """The numbers of a bet, {MODEL_PART: number}, and what its reasons quote beside them."""
    _, models, _, parts = BETS[name]
    numbers, drop = {}, contact.build_scene("drop")
    for label, part in parts.items():
        scene = drop._replace(mass=part.mass * drop.mass)
        for model in models:
            measured = quality(model, scene, part.dt, part.steps)
            numbers[f"{model}_{label}"] = measured[part.key]
    also = FACTS[name].get("also", {}).items()
    known = numbers | {"critical_dt": contact.critical_dt}
    return numbers | {label: eval(formula, known.copy()) for label, formula in also}


def table(name, numbers):
    """The measurement of a bet as text."""
    corner, models, form, parts = BETS[name]
    shown = {label: part.head for label, part in parts.items() if part.head}
    rows = {model: [numbers[f"{model}_{label}"] for label in shown] for model in models}
    return columns(corner, shown.values(), rows, form)


def answer(name, numbers):
    """The letter whose claim holds for what was measured; ValueError unless exactly one does."""
    claims = FACTS[name]["key"]
    true = [letter for letter, claim in claims.items() if eval(claim, {"abs": abs}, numbers)]
    if len(true) != 1:
        raise ValueError(f"{name}: of its choices {true} hold, and not one, for {numbers}")
    return true[0]


class Bet(NamedTuple):
    """What the docstring of a bet says: what happens, and what is asked of it."""

    task: str
    question: str
    choices: dict  # {letter: choice}
    why: str  # what the sentence should say


def asked(text):
    """The Bet of a docstring: question, choices (an indented paragraph), what WHY should say."""
    _title, *task, question, choices, why, _then, _commands = text.strip().split("\n\n")
    found = re.findall(r"^    ([A-Z])  (.*(?:\n     .*)*)", choices, re.MULTILINE)
    choices = {letter: line_of(words) for letter, words in found}
    return Bet("\n\n".join(task), line_of(question), choices, line_of(why))


def line_of(text):
    """A paragraph as one line."""
    return " ".join(text.split())


def chosen(exercise):
    """The learner's letter, however it was typed."""
    return str(exercise.PREDICTION).strip(" \t\n.)(").upper()


def state(exercise):
    """("blank" or "right", what is still to be done before the run)."""
    file, bet = near(exercise.__file__), asked(task_of(exercise))
    letters, why = ", ".join(map(repr, bet.choices)), exercise.WHY
    if exercise.PREDICTION is None:
        asks = f"set PREDICTION to one of {letters} and say WHY"
        return "blank", f"no prediction yet: in {file} {asks}"
    if chosen(exercise) not in bet.choices:
        given = f"given {exercise.PREDICTION!r}, allowed: {letters}"
        return "blank", f"PREDICTION in {file}: {given}"
    if len(str(why).split()) < 4:
        wanted = f"write a sentence of four words or more. {bet.why}"
        return "blank", f"no reason yet: WHY in {file} is {why!r}; {wanted}"
    return "right", ""


def verdict(name, exercise, numbers):
    """What the learner reads after the run: the bet first, then a word on every choice."""
    right, mine, choices = answer(name, numbers), chosen(exercise), asked(task_of(exercise)).choices
    wrong = f"What happens is {right}: {choices[right]}"
    lines = [
        f"You predicted {mine}: {choices[mine]}",
        f"Because: {str(exercise.WHY).strip()}",
        "",
        "That is what happens." if mine == right else wrong,
    ]
    for choice in sorted(choices, key=lambda choice: choice != right):  # the right one first
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {FACTS[name]['reasons'][choice].format(**numbers)}"]
    return "\n".join(textwrap.fill(line, 96) for line in lines)


def judged(name, exercise):
    """The state of a bet, and [what, state, words, shown]: what was measured, and the verdict."""
    what, words = state(exercise)
    if what == "blank":
        return what, [[name, what, words, ""]]
    numbers = measure(name)
    return what, [[name, what, verdict(name, exercise, numbers), f"{table(name, numbers)}\n"]]
