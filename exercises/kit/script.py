"""An exercise's command line, and what checks.py asks of it. Nothing to fill in here."""

import os
import sys
from pathlib import Path

from curriculum.commands import Parser, command

from . import FACTS, knobs, predict, task_of, time_limit
from .progress import done, note, practise

BETS = dict.fromkeys(predict.BETS, predict) | {"ex9": knobs}  # exercise: the module that runs it


def unquoted(kind, error, trace):
    """PREDICTION = A, a letter without quotes: say it in one line."""
    if kind is not NameError:
        return said(kind, error, trace)
    print(time_limit.unreadable(trace.tb_frame.f_code.co_filename, error), file=sys.stderr)


said, sys.excepthook = sys.excepthook, unquoted


def main():
    """The command line of the exercise that was started. Ends with its exit status."""
    exercise = sys.modules["__main__"]
    name = Path(exercise.__file__).stem.split("_")[0]  # ex1 of exercises/ex1_predict_contact.py
    hints = FACTS[name]["hints"]
    parser = Parser(description=f"Exercise {name}.")
    most = f"print hint N, 1 to {len(hints)}, and do nothing else"
    numbers = range(1, len(hints) + 1)
    parser.add_argument("--hint", type=int, choices=numbers, metavar="N", help=most)
    hint = parser.parse_args().hint
    if hint:
        print(f"hint {hint} of {len(hints)}: {hints[hint - 1]}")
    else:
        sys.exit(run(name, exercise))


def run(name, exercise):
    """Judge what was written and show it at work. Exit status: 0 right, 1 wrong, 2 not done."""
    if name in BETS:
        state, found = BETS[name].judged(name, exercise)
    else:
        state, found = time_limit.judged(name, exercise.__file__)
    note(name, state == "right")
    if state == "blank" and "IN_A_NOTEBOOK" not in os.environ:  # a bet whole; of a task, its title
        task = task_of(exercise).strip()
        print(task if name in BETS else task.split("\n")[0], end="\n\n")
    for what, _, words, shown in found:
        print(*filter(None, (shown, words or f"{what} is right")), sep="\n", flush=True)
    if state == "right":
        print(f"\n{practise()}")
    return ("right", "wrong", "blank").index(state)


def checked(name, file):
    """("blank", "wrong" or "right", why in words), as checks.py asks."""
    if name not in BETS:
        state, found = time_limit.judged(name, file)
        note(name, state == "right")
        return state, "\n".join(words for _, each, words, _ in found if each == state)
    try:
        state, words = BETS[name].state(time_limit.load(file))
    except Exception as error:
        return "wrong", time_limit.unreadable(file, error)
    if state == "right" and name not in done():
        return "blank", f"the bet is made; now read what happens: {command(file)}"
    return state, words
