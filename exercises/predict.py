"""What the exercises share: the command line, bets, and what is done. Nothing to fill in here."""

import argparse
import json
import os
import shlex
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

try:
    import contact
except ModuleNotFoundError as error:
    sys.exit(f"{error}: {sys.executable} -m pip install numpy")
from progress import DONE, done, next_exercise

FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))
HINTS = {name: facts["hints"] for name, facts in FACTS.items()}
ANSWERS = {name: facts["answer"] for name, facts in FACTS.items() if "answer" in facts}
REASONS = {name: FACTS[name]["reasons"] for name in ANSWERS}


def command(*words):
    """A command for the Python that is running, quoted for this system's shell."""
    words = [sys.executable, *map(str, words)]
    return subprocess.list2cmdline(words) if os.name == "nt" else shlex.join(words)


def file_of(exercise):
    """The exercise's file, as one would type it here."""
    return os.path.relpath(exercise.__file__)


def run(name, main, exercise, argv=None):
    """The command line of an exercise: a hint, or main(name, exercise). Returns the exit status."""
    hints = HINTS[name]
    parser = argparse.ArgumentParser(description=f"Exercise {name}.", allow_abbrev=False)
    parser.add_argument("--hint", type=int, choices=range(1, len(hints) + 1), metavar="N",
                        help=f"print hint N, 1 to {len(hints)}, and do nothing else")
    hint = parser.parse_args(argv).hint
    if hint:
        print(f"hint {hint} of {len(hints)}: {hints[hint - 1]}")
        return 0
    try:
        return main(name, exercise)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130


# What is done


def note(name, value):
    """Note an exercise as done, or as not done where value is None."""
    noted = done()
    if noted.get(name) == value:
        return
    noted = {key: found for key, found in (noted | {name: value}).items() if found}
    try:
        contact.write_json(DONE, noted)
    except OSError as error:
        print(f"cannot note that {name} is done: {error}", file=sys.stderr)


def follow_up():
    """The last line of an exercise: the next one that is not done, or that all are."""
    file = next_exercise()
    if file is not None:
        return f"next: {command(os.path.relpath(ROOT / file))}"
    return ("done: these were all eight. What next? The questions at the end of the chapter have "
            "no answer key; after them comes chapter 3.6")


# Bets


def quality(scene, dt, steps, models=("penalty", "lcp")):
    """{model: contact_quality} of each model's run of the scene."""
    return {model: contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)
            for model in models}


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    lines = [f"{corner:<16}" + "".join(f"{head:>15}" for head in heads)]
    lines += [f"{name:<16}" + "".join(f"{form.format(value):>15}" for value in values)
              for name, values in rows.items()]
    return "\n".join(lines)


def chosen(exercise):
    """The learner's letter, however it was typed; None before a choice."""
    given = exercise.PREDICTION
    return given.strip(" \t\n.)(").upper() if isinstance(given, str) else given


def missing(exercise):
    """What is still to be done before the run, or None."""
    file, choices = file_of(exercise), ", ".join(map(repr, exercise.CHOICES))
    if exercise.PREDICTION is None:
        return f"no prediction yet: in {file} set PREDICTION to one of {choices} and say WHY"
    if chosen(exercise) not in exercise.CHOICES:
        return f"PREDICTION in {file}: given {exercise.PREDICTION!r}, allowed: {choices}"
    if len(str(exercise.WHY).split()) < 4:
        return (f"no reason yet: WHY in {file} is {exercise.WHY!r}; write a sentence of four words "
                f"or more. {exercise.WHY_PROMPT}")
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
    right = "That is what happens."
    if mine != answer:
        right = textwrap.fill(f"What happens is {answer}: {choices[answer]}", 96)
    lines = [textwrap.fill(f"You predicted {mine}: {choices[mine]}", 96),
             textwrap.fill(f"Because: {str(exercise.WHY).strip()}", 96), "", right]
    for choice in [answer] + [each for each in choices if each != answer]:
        word = "Why" if choice == answer else "Why not"
        reason = REASONS[name][choice].format(**numbers)
        lines += ["", textwrap.fill(f"{word} {choice}: {reason}", 96)]
    return "\n".join(lines)


def bet(name, exercise):
    """Ask; refuse before a choice; then measure, show, explain. Returns the exit status."""
    todo = missing(exercise)
    if todo:
        print(asked(exercise), flush=True)
        print(f"\n{todo}", file=sys.stderr)
        return 2
    numbers = exercise.measure()
    print(exercise.table(numbers), verdict(name, exercise, numbers), sep="\n\n")
    note(name, chosen(exercise))
    print(f"\n{follow_up()}")
    return 0
