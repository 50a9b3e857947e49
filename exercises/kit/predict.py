"""What the exercises share: the command line, bets, and what is done. Nothing to fill in here."""

import argparse
import json
import sys
import textwrap
from pathlib import Path

import contact
from curriculum.commands import near
from curriculum.files import write_json

from .progress import DONE, done, practise

FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))
ANSWERS = {name: facts["answer"] for name, facts in FACTS.items() if "answer" in facts}


def main():
    """The command line of the exercise that was started. Ends with its exit status."""
    exercise = sys.modules["__main__"]
    name = Path(exercise.__file__).stem.split("_")[0]
    hints = FACTS[name]["hints"]
    parser = argparse.ArgumentParser(description=f"Exercise {name}.", allow_abbrev=False)
    parser.add_argument(
        "--hint",
        type=int,
        choices=range(1, len(hints) + 1),
        metavar="N",
        help=f"print hint N, 1 to {len(hints)}, and do nothing else",
    )
    hint = parser.parse_args().hint
    try:
        if hint:
            print(f"hint {hint} of {len(hints)}: {hints[hint - 1]}")
        elif name in ANSWERS:
            sys.exit(bet(name, exercise))
        else:
            from . import trials

            sys.exit(trials.fill(name, exercise))
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        sys.exit(130)


def note(name, value):
    """Note an exercise as done, or as not done where value is None."""
    noted = {key: found for key, found in (done() | {name: value}).items() if found}
    try:
        if noted != done():
            write_json(DONE, noted)
    except OSError as error:
        print(f"cannot note that {name} is done: {error}", file=sys.stderr)


# Bets


def measured(scene, dt, steps, models=("penalty", "lcp"), **parts):
    """{MODEL_PART: number} of each model's run; parts {name: key of contact_quality}."""
    numbers = {}
    for model in models:
        quality = contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)
        numbers |= {f"{model}_{part}": quality[key] for part, key in parts.items()}
    return numbers


def table(exercise, numbers):
    """The measurement of a bet as text: its rows are models, its columns parts of the names."""
    corner, models, heads, form = exercise.TABLE
    rows = {model: [numbers[f"{model}_{part}"] for part in heads] for model in models}
    return columns(corner, heads.values(), rows, form)


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    wide = max(16, *map(len, rows))
    lines = [f"{corner:<{wide}}" + "".join(f"{head:>15}" for head in heads)]
    lines += [
        f"{name:<{wide}}" + "".join(f"{form.format(value):>15}" for value in values)
        for name, values in rows.items()
    ]
    return "\n".join(lines)


def chosen(exercise):
    """The learner's letter, however it was typed."""
    return str(exercise.PREDICTION).strip(" \t\n.)(").upper()


def missing(exercise):
    """What is still to be done before the run, or None."""
    file, choices = near(exercise.__file__), ", ".join(map(repr, exercise.CHOICES))
    if exercise.PREDICTION is None:
        return f"no prediction yet: in {file} set PREDICTION to one of {choices} and say WHY"
    if chosen(exercise) not in exercise.CHOICES:
        return f"PREDICTION in {file}: given {exercise.PREDICTION!r}, allowed: {choices}"
    if len(str(exercise.WHY).split()) < 4:
        return (
            f"no reason yet: WHY in {file} is {exercise.WHY!r}; write a sentence of four words "
            f"or more. {exercise.WHY_PROMPT}"
        )
    return None


def asked(exercise):
    """The question and the choices, as text."""
    lines = [textwrap.fill(exercise.QUESTION, 96), ""]
    for letter, choice in exercise.CHOICES.items():
        lines.append(textwrap.fill(f"  {letter}  {choice}", 96, subsequent_indent="     "))
    return "\n".join(lines)


def verdict(name, exercise, numbers):
    """What the learner reads after the run: the bet first, then a word on every choice."""
    answer, mine, choices = ANSWERS[name], chosen(exercise), exercise.CHOICES
    wrong = f"What happens is {answer}: {choices[answer]}"
    lines = [
        f"You predicted {mine}: {choices[mine]}",
        f"Because: {str(exercise.WHY).strip()}",
        "",
        "That is what happens." if mine == answer else wrong,
    ]
    for choice in sorted(choices, key=lambda choice: choice != answer):  # the right one first
        word = "Why" if choice == answer else "Why not"
        lines += ["", f"{word} {choice}: {FACTS[name]['reasons'][choice].format(**numbers)}"]
    return "\n".join(textwrap.fill(line, 96) for line in lines)


def bet(name, exercise):
    """Ask; refuse before a choice; then measure, show, explain. Returns the exit status."""
    todo = missing(exercise)
    if todo:
        print(asked(exercise), flush=True)
        print(f"\n{todo}", file=sys.stderr)
        return 2
    numbers = exercise.measure()
    print(table(exercise, numbers), verdict(name, exercise, numbers), sep="\n\n")
    note(name, chosen(exercise))
    print(f"\n{practise()}")
    return 0
