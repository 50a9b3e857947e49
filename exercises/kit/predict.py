"""Exercises 1, 3 and 4: a bet, what is measured, and a word on every choice."""

import re
import textwrap
from functools import cache

import contact
from curriculum.commands import near

from . import FACTS, columns, task_of

# fmt: off
BETS = {  # exercise: corner of its table, models, how a number is written, and of each part the
    # head of its column, if any, the key of contact_quality, dt [s], steps, mass [kg]
    "ex1": ("depth", ("penalty", "lcp"), "{:.5f} r", {
        "deepest": ("deepest", "max_penetration_frac", 0.002, 800, 1.0),
        "at_rest": ("at rest", "rest_penetration_frac", 0.002, 800, 1.0)}),
    "ex3": ("energy gained", ("penalty", "lcp"), "{:.4g}", {
        "usual": ("dt = 0.002 s", "energy_excess", 0.002, 2000, 1.0),
        "long": ("dt = 0.03 s", "energy_excess", 0.03, 2000, 1.0),
        "long_depth": ("", "max_penetration_frac", 0.03, 2000, 1.0)}),
    "ex4": ("depth at rest", ("soft", "penalty"), "{:.5f} r", {
        "light": ("1 kg", "rest_penetration_frac", 0.002, 2000, 1.0),
        "heavy": ("10 kg", "rest_penetration_frac", 0.002, 2000, 10.0)}),
}
# fmt: on


def quality(model, scene, dt, steps, settings=contact.Settings()):
    """The measures of a run."""
    run = contact.run_model(model, scene, dt, steps, settings)
    return contact.contact_quality(run, scene, dt)


@cache
def measure(name):
    """The numbers of a bet, {MODEL_PART: number}, and what its reasons quote beside them."""
    _, models, _, parts = BETS[name]
    numbers = {
        f"{model}_{label}": quality(model, contact.build_scene("drop", mass=mass), dt, steps)[key]
        for label, (_, key, dt, steps, mass) in parts.items()
        for model in models
    }
    also = FACTS[name].get("also", {}).items()
    known = numbers | {"critical_dt": contact.critical_dt}
    return numbers | {label: eval(formula, known.copy()) for label, formula in also}


def table(name, numbers):
    """The measurement of a bet as text."""
    corner, models, form, parts = BETS[name]
    shown = {label: head for label, (head, *_) in parts.items() if head}
    rows = {model: [numbers[f"{model}_{label}"] for label in shown] for model in models}
    return columns(corner, shown.values(), rows, form)


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


def chosen(exercise):
    """The learner's letter, however it was typed."""
    return str(getattr(exercise, "PREDICTION", None)).strip(" \t\n.)(").upper()


def state(exercise):
    """("blank" or "right", what is still to be done before the run)."""
    file, bet = near(exercise.__file__), asked(task_of(exercise))
    given, why = getattr(exercise, "PREDICTION", None), getattr(exercise, "WHY", "")
    if chosen(exercise) not in bet["choices"]:
        made = "no prediction yet" if given is None else f"PREDICTION is {given!r}"
        return "blank", f"{made}; write one of {', '.join(map(repr, bet['choices']))} in {file}"
    if len(str(why).split()) < 4:
        wanted = f"write a sentence of four words or more in {file}. {bet['why']}"
        return "blank", f"no reason yet: WHY is {why!r}; {wanted}"
    return "right", ""


def judged(name, exercise):
    """The state of a bet, and [what, state, words, shown]: its numbers, a word on every choice."""
    what, words = state(exercise)
    if what == "blank":
        return what, [[name, what, words, ""]]
    numbers, choices, mine = measure(name), asked(task_of(exercise))["choices"], chosen(exercise)
    right = answer(name, numbers)
    lines = [
        f"You predicted {mine}: {choices[mine]}",
        f"Because: {str(exercise.WHY).strip()}",
        "",
        "That is what happens." if mine == right else f"What happens is {right}: {choices[right]}",
    ]
    for choice in sorted(choices, key=lambda choice: choice != right):  # the right one first
        word = "Why" if choice == right else "Why not"
        lines += ["", f"{word} {choice}: {FACTS[name]['reasons'][choice].format(**numbers)}"]
    verdict = "\n".join(textwrap.fill(line, 96) for line in lines)
    return what, [[name, what, verdict, f"{table(name, numbers)}\n"]]
