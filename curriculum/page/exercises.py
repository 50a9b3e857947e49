"""The exercises as the page shows them: their docstrings, and the facts of answers.json."""

import ast
import re

from curriculum.lesson.regions import ROOT
from curriculum.page.chapter import inline, markdown
from exercises.kit import FACTS, bets

FOLDER = ROOT / "exercises"
TITLE = re.compile(r"Exercise (\d+), .+? \((\d+) minutes\): (.+?)\.?")
COMMAND = re.compile(r"^    ((?:python|pytest)\b.*?)(?:\s{2,}#.*)?$", re.MULTILINE)
measured = bets.measure  # the numbers of a bet


def task_of(text):
    """A docstring without its commands, as HTML: indented lines stay as they are."""
    prose = [block for block in re.split(r"\n\s*\n", text.strip()) if not COMMAND.match(block)]
    return markdown("\n\n".join(re.sub(r"(?m)(^[^ ].*\n)(?=    )", r"\1\n", b) for b in prose))


def exercise(path):
    """An exercise as the template wants it. Raises ValueError where its docstring has no title."""
    words = ast.get_docstring(ast.parse(path.read_text("utf-8")), clean=False)
    title, _, text = words.partition("\n")
    parts = TITLE.fullmatch(title.strip())
    if not parts:
        raise ValueError(f"{path.name}: it must begin 'Exercise N, KIND (M minutes): TITLE'")
    number, minutes, told = parts.groups()
    name, task, bet = f"ex{number}", text, {"choices": {}}
    facts = FACTS[name]
    if "key" in facts:
        numbers, bet = measured(name), bets.asked(words)
        task = bet["task"]
        bet["answer"] = bets.answer(name, numbers)
        bet["reasons"] = {k: inline(why.format(**numbers)) for k, why in facts["reasons"].items()}
        bet["table"] = [re.split(r"\s{2,}", x) for x in bets.table(name, numbers).splitlines()]
    return bet | {
        "id": name,
        "title": f"Exercise {number}: {told}",
        "minutes": minutes,
        "command": "\n".join(COMMAND.findall(text)),
        "hints": [inline(hint) for hint in facts["hints"]],
        "task": task_of(task),
    }


def all_exercises():
    """{name: exercise} in order."""
    return {each["id"]: each for each in map(exercise, sorted(FOLDER.glob("ex*_*.py")))}
