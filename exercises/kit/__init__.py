"""What the exercises stand on: bets, blanks and how they are judged. Nothing to fill in here.

    script.py     an exercise's command line, and what checks.py asks
    predict.py    exercises 1, 3, 4: bets     knobs.py        exercise 9: four knobs
    blanks.py     what belongs in a blank     time_limit.py   tries a fill in its own process
    trials.py     judges it, shows it at work progress.py     which exercises are done

answers.json has hints, keys, reasons, inputs and slips. contact.py and curriculum/ are found above
the folder of the exercises, from wherever one starts.
"""

import ast
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))


def task_of(exercise):
    """The docstring of an exercise, read from its file: Python may leave it out (-OO)."""
    return ast.get_docstring(ast.parse(Path(exercise.__file__).read_text("utf-8")), clean=False)


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    wide = max(16, *map(len, rows))
    lines = [f"{corner:<{wide}}" + "".join(f"{head:>15}" for head in heads)]
    for name, values in rows.items():
        cells = ("-" if value is None else form.format(value) for value in values)
        lines.append(f"{name:<{wide}}" + "".join(f"{cell:>15}" for cell in cells))
    return "\n".join(lines)
