"""The exercises as the page shows them: words from exercises/, answers and reasons from meta.yaml."""

import ast
import importlib
import re
import sys
from unittest.mock import patch

from markupsafe import Markup

from curriculum.page import prose
from curriculum.quoted import load_meta

# what a bet measures on the page: its drop, the columns (title, model, mass) and the rows shown
EXERCISES = {
    "ex1": {
        "dt": 0.002,
        "steps": 800,
        "columns": [["penalty", "penalty", 1], ["lcp", "lcp", 1]],
        "shows": [
            ["max_penetration_frac", "deepest / r"],
            ["rest_penetration_frac", "at the end / r"],
        ],
    },
    "ex3": {
        "dt": 0.03,
        "steps": 2000,
        "columns": [["penalty", "penalty", 1], ["lcp", "lcp", 1]],
        "shows": [
            ["energy_excess", "energy gained / start"],
            ["max_penetration_frac", "deepest / r"],
            ["blew_up", "verdict"],
        ],
    },
    "ex4": {
        "dt": 0.002,
        "steps": 2000,
        "columns": [
            ["soft, 1 kg", "soft", 1],
            ["soft, 10 kg", "soft", 10],
            ["penalty, 1 kg", "penalty", 1],
            ["penalty, 10 kg", "penalty", 10],
        ],
        "shows": [["rest_penetration_frac", "at the end / r"]],
    },
}
BLANKS = ("penalty_normal_force", "project_impulse")  # of exercise 2


def markdown(text):
    """A short text of ours (objective, reveal) as HTML."""
    return Markup(prose.parser().render(text))


def inline(text):
    return Markup(prose.parser().renderInline(text))


def blank_cases(root):
    """The inputs on which checks.py tries the blanks of exercise 2, from exercises/trials.py."""
    with patch.object(sys, "path", [str(root / "exercises"), *sys.path]):
        trials = importlib.import_module("trials")
    return {
        blank: [{key: float(value) for key, value in case.items()} for case in trials.inputs(blank)]
        for blank in BLANKS
    }


def exercise_words(path):
    """(docstring, {QUESTION, CHOICES, WHY_PROMPT}) of an exercise's file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    words = {
        target.id: ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name) and target.id in ("QUESTION", "CHOICES", "WHY_PROMPT")
    }
    return ast.get_docstring(tree), words


def reveals(name, facts, choices, numbers):
    """The reasons by choice, as HTML. Raises ValueError where they are not for the choices."""
    reveal = {
        letter: markdown(numbers.render(reason))
        for letter, reason in (facts.get("reveal") or {}).items()
    }
    if set(reveal) != set(choices):
        raise ValueError(
            f"meta.yaml:1: the reveals of {name} are for {sorted(reveal)}, "
            f"its choices are {sorted(choices)}"
        )
    return reveal


def exercise_text(path):
    """(docstring's parts {title, kind, minutes, task, command}, words) of an exercise's file."""
    docstring, words = exercise_words(path)
    title, _, text = docstring.partition("\n")
    parts = re.fullmatch(r"Exercise (\d+), (.+?) \((\d+) minutes\): (.+?)\.?", title.strip())
    if not parts:
        raise ValueError(
            f"{path.name}:1: the docstring's first line must read "
            "'Exercise N, KIND (M minutes): TITLE'"
        )
    # the docstring's prose, without how to run it in the terminal
    told = [each for each in re.split(r"\n\s*\n", text.strip()) if not each.startswith("    ")]
    if words.get("CHOICES"):
        told = [re.sub(r"\s*Read CHOICES.*", "", each, flags=re.DOTALL) for each in told]
        told.append(words["QUESTION"])
    commands = re.findall(r"^    (\S.*?)(?:\s{2,}#.*)?$", text, re.MULTILINE)
    shown = {
        "title": f"Exercise {parts[1]}: {parts[4]}",
        "kind": parts[2],
        "minutes": parts[3],
        "task": Markup("").join(markdown(each) for each in told if each.strip()),
        "command": "\n".join(commands),
    }
    return shown, words


def exercise_facts(root, numbers):
    """The exercises as the template wants them: words from exercises/, answers from meta.yaml."""
    found = {}
    for name, facts in (load_meta(root).get("exercises") or {}).items():
        shown, words = exercise_text(next((root / "exercises").glob(f"{name}_*.py")))
        choices = words.get("CHOICES") or {}
        if choices and name not in EXERCISES:
            raise ValueError(
                f"meta.yaml:1: the page cannot measure {name}; "
                f"it knows the bets {', '.join(EXERCISES)}"
            )
        found[name] = shown | {
            "id": name,
            "blank": not choices,
            "choices": list(choices.items()),
            "why_label": words.get("WHY_PROMPT", ""),
            "answer": facts["answer"] if choices else None,
            "reveal": reveals(name, facts, choices, numbers),
            "hints": [inline(" ".join(hint.split())) for hint in facts.get("hints") or []],
        }
    return found
