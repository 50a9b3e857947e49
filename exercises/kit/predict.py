"""What the exercises share: the command line, bets, and what is done. Nothing to fill in here."""

import argparse
import json
import sys
import textwrap
from pathlib import Path

import contact
from curriculum.commands import command, near, unread
from curriculum.files import write_json

from . import alone
from .progress import DONE, done, practise

FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))
BETS = [name for name, facts in FACTS.items() if "reasons" in facts]


def unquoted(kind, error, trace):
    """A letter without quotes is an error of Python's; say it in one line."""
    if kind is not NameError or not hasattr(sys.modules["__main__"], "WHY_PROMPT"):
        return sys.__excepthook__(kind, error, trace)
    print(alone.unreadable(trace.tb_frame.f_code.co_filename, error), file=sys.stderr)


sys.excepthook = unquoted  # PREDICTION = A


@unread()
def main():
    """The command line of the exercise that was started. Ends with its exit status."""
    exercise = sys.modules["__main__"]
    name = Path(exercise.__file__).stem.split("_")[0]
    hints = FACTS[name]["hints"]
    parser = argparse.ArgumentParser(description=f"Exercise {name}.", allow_abbrev=False)
    most = f"print hint N, 1 to {len(hints)}, and do nothing else"
    parser.add_argument(
        "--hint", type=int, choices=range(1, len(hints) + 1), metavar="N", help=most
    )
    hint = parser.parse_args().hint
    try:
        if hint:
            print(f"hint {hint} of {len(hints)}: {hints[hint - 1]}")
        else:
            sys.exit((bet if name in BETS else fill)(name, exercise))
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


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    wide = max(16, *map(len, rows))
    lines = [f"{corner:<{wide}}" + "".join(f"{head:>15}" for head in heads)]
    for name, values in rows.items():
        cells = ("-" if value is None else form.format(value) for value in values)
        lines.append(f"{name:<{wide}}" + "".join(f"{cell:>15}" for cell in cells))
    return "\n".join(lines)


def checked(name, file):
    """("blank", "wrong" or "right", why in words), as checks.py asks."""
    if name not in BETS:
        state, found = judged(name, file)
        return state, "\n\n".join(words for _, each, words, _ in found if each == state)
    try:
        exercise = alone.load(file)
    except Exception as error:
        return "wrong", alone.unreadable(file, error)
    if name == "ex9":
        from . import knobs

        state, words = knobs.state(exercise)
    else:
        words = missing(exercise)
        state = "blank" if words else "right"
    if state == "right" and name not in done():
        return "blank", f"the bet is made; now read what happens: {command(file)}"
    return state, words


# Fills


def judged(name, file):
    """What alone.judged finds; notes whether the exercise is done."""
    state, found = alone.judged(name, file)
    note(name, "done" if state == "right" else None)
    return state, found


def fill(name, exercise):
    """Judge what is filled and try it. Exit status: 0 right, 1 wrong, 2 not filled yet."""
    state, found = judged(name, exercise.__file__)
    task = (exercise.__doc__ or "").split("\n    python")[0].strip()
    if state == "blank":
        print(task, end="\n\n")
    for what, _, words, shown in found:
        print(*filter(None, (shown, words or f"{what} is right")), sep="\n", flush=True)
    if state == "right":
        print(f"\n{practise()}")
    return ("right", "wrong", "blank").index(state)


# Bets


def measured(scene, dt, steps, models=("penalty", "lcp"), **parts):
    """{MODEL_PART: number} of each model's run; parts {name: key of contact_quality}."""
    numbers = {}
    for model in models:
        quality = contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)
        numbers |= {f"{model}_{part}": quality[key] for part, key in parts.items()}
    return numbers


def answer(name, numbers):
    """The letter whose claim holds for what was measured; ValueError unless exactly one does."""
    claims = FACTS[name]["holds"]
    true = [letter for letter, claim in claims.items() if eval(claim, {"abs": abs}, numbers)]
    if len(true) != 1:
        raise ValueError(f"{name}: of its choices {true} hold, and not one, for {numbers}")
    return true[0]


def table(exercise, numbers):
    """The measurement of a bet as text: its rows are models, its columns parts of the names."""
    corner, models, heads, form = exercise.TABLE
    rows = {model: [numbers[f"{model}_{part}"] for part in heads] for model in models}
    return columns(corner, heads.values(), rows, form)


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
    right, mine, choices = answer(name, numbers), chosen(exercise), exercise.CHOICES
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


def bet(name, exercise):
    """Ask; refuse before a choice; then measure, show, explain. Returns the exit status."""
    if name == "ex9":
        from . import knobs

        return knobs.bet(exercise)
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
