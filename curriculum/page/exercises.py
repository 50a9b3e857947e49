"""The exercises as the page shows them: words of exercises/*.py, facts of answers.json."""

import functools
import importlib
import json
import re
import sys

from curriculum.page.prose import inline, markdown
from curriculum.text.regions import ROOT

FOLDER = ROOT / "exercises"
TITLE = re.compile(r"Exercise (\d+), (.+?) \((\d+) minutes\): (.+?)\.?")
BLANKS = ("penalty_normal_force", "project_impulse")  # of exercise 2, filled in the page


def module(name):
    """A module of the folder exercises/."""
    if str(FOLDER) not in sys.path:
        sys.path.insert(0, str(FOLDER))
    return importlib.import_module(name)


def blank_cases():
    """The inputs on which checks.py tries the blanks of exercise 2."""
    blanks = module("blanks").BLANKS
    return {blank: blanks[blank].inputs for blank in BLANKS}


def text_of(name, exercise):
    """The parts of an exercise's docstring: title, minutes, task (HTML) and commands."""
    title, _, text = exercise.__doc__.partition("\n")
    parts = TITLE.fullmatch(title.strip())
    if not parts:
        raise ValueError(
            f"exercises/{name}: the docstring must begin 'Exercise N, KIND (M minutes): TITLE'"
        )
    number, _, minutes, told = parts.groups()
    blocks = [each for each in re.split(r"\n\s*\n", text.strip())]
    commands = re.findall(r"^    ((?:python|pytest)\b.*?)(?:\s{2,}#.*)?$", text, re.MULTILINE)
    prose = [each for each in blocks if not re.match(r" *(python|pytest)\b", each)]
    if hasattr(exercise, "CHOICES"):  # without how to bet in a file
        prose = [re.sub(r"\s*Read CHOICES.*", "", each, flags=re.DOTALL) for each in prose]
    return {
        "id": name,
        "title": f"Exercise {number}: {told}",
        "minutes": minutes,
        "task": markdown("\n\n".join(map(laid_out, prose))),
        "command": "\n".join(commands),
    }


def laid_out(block):
    """A block of a docstring as Markdown: indented lines stay as they are."""
    return re.sub(r"(?m)(^[^ ].*\n)(?=    )", r"\1\n", block)


@functools.cache
def measured(name):
    """The numbers that a bet's own module measures."""
    return module(name).measure()


def facts_of(name, path, facts):
    """An exercise as the template wants it."""
    exercise = module(path.stem)
    shown = text_of(path.name, exercise) | {"id": name, "choices": []}
    shown["hints"] = [inline(hint) for hint in facts.get("hints", [])]
    if hasattr(exercise, "CHOICES"):
        numbers = measured(path.stem)
        shown |= {
            "choices": list(exercise.CHOICES.items()),
            "question": exercise.QUESTION,
            "why": exercise.WHY_PROMPT,
            "answer": facts["answer"],
            "reasons": {k: inline(text.format(**numbers)) for k, text in facts["reasons"].items()},
            "table": module("predict").table(exercise, numbers),
        }
    return shown


def all_exercises():
    """{name: exercise} in order."""
    facts = json.loads((FOLDER / "answers.json").read_text("utf-8"))
    paths = sorted(FOLDER.glob("ex*_*.py"))
    return {
        name: facts_of(name, path, facts.get(name, {}))
        for path in paths
        for name in [path.stem.split("_")[0]]
    }
