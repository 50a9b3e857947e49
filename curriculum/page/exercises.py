"""The exercises as the page shows them: their docstrings, and the facts of answers.json."""

import re

from curriculum.page.chapter import inline, markdown
from exercises.kit import FACTS, script, trials

TITLE = re.compile(r"Exercise (\d+), .+? \((\d+) minutes\): (.+?)\.?")


def exercise(name, file):
    """An exercise as the template wants it. Raises ValueError where its docstring has no title."""
    words = script.task_of(name)
    title, _, task = words.partition("\n")
    parts = TITLE.fullmatch(title.strip())
    if not parts:
        raise ValueError(f"{file}: it must begin 'Exercise N, KIND (M minutes): TITLE'")
    number, minutes, told = parts.groups()
    facts, bet = FACTS[name], {"choices": {}}
    if "measured" in facts:
        numbers, bet = trials.measure(name), trials.asked(words)
        task = bet["task"]
        bet["answer"] = trials.SOLVED[name].PREDICTION
        bet["reasons"] = {k: inline(why.format(**numbers)) for k, why in facts["reasons"].items()}
        bet["table"] = [re.split(r"\s{2,}", x) for x in trials.table(name, numbers).splitlines()]
    indented = re.sub(r"(?m)(^[^ \n].*\n)(?=    )", r"\1\n", task.strip())  # stays as it is
    return bet | {
        "id": name,
        "title": f"Exercise {number}: {told}",
        "minutes": minutes,
        "command": f"python {file}",
        "hints": [inline(hint) for hint in facts["hints"]],
        "task": markdown(indented),
    }


def all_exercises():
    """{name: exercise}."""
    return {name: exercise(name, file) for name, file in script.FILES.items()}
