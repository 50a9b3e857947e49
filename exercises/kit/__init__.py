"""What the exercises stand on. Nothing to fill in here, and much that gives an answer away.

    script.py   an exercise's command line, what checks.py asks, which exercise comes next
    judge.py    tries what was written, in a process of its own, and shows it at work
    bets.py     bets                slips.py    inputs, and slips by what they give

answers.json has hints, keys, reasons, inputs and slips; ../solutions/ a right answer of each.
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]  # where contact.py and curriculum/ are
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))


def columns(corner, heads, rows, form):
    """A small table as text. rows {name: values}; `form` writes a value, as "{:.3f} r" does."""
    wide = max(16, *map(len, rows))
    lines = [f"{corner:<{wide}}" + "".join(f"{head:>15}" for head in heads)]
    for name, values in rows.items():
        cells = ("-" if value is None else form.format(value) for value in values)
        lines.append(f"{name:<{wide}}" + "".join(f"{cell:>15}" for cell in cells))
    return "\n".join(lines)


def task_of(exercise):
    """The docstring of an exercise, read from its file: Python may leave it out (-OO)."""
    import ast  # slow, so only where it is needed

    return ast.get_docstring(ast.parse(Path(exercise.__file__).read_text("utf-8")), clean=False)


def load(file):
    """The module of an exercise."""
    import importlib.util

    spec = importlib.util.spec_from_file_location(Path(file).stem, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
