"""What ex1 and ex3 share: commit to a choice, then measure, then compare. Nothing to fill in."""

import os
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import contact  # noqa: E402
from curriculum.common.arguments import Parser, number  # noqa: E402
from curriculum.quoted import Numbers, load_meta  # noqa: E402


def quality(scene, dt, steps, models=("penalty", "lcp")):
    """{model: contact_quality} of each model's run of the scene."""
    return {model: contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)
            for model in models}


def missing(exercise):
    """What is still to be done before the run, or None."""
    file, choices = os.path.relpath(exercise.__file__), ", ".join(map(repr, exercise.CHOICES))
    if exercise.PREDICTION is None:
        return f"no prediction yet: in {file} set PREDICTION to one of {choices} and say WHY"
    if exercise.PREDICTION not in exercise.CHOICES:
        return f"PREDICTION in {file}: given {exercise.PREDICTION!r}, allowed: {choices}"
    if not exercise.WHY.strip():
        return f"no reason yet: set WHY in {file}. {exercise.WHY_PROMPT}"
    return None


def verdict(name, exercise, runs):
    """What the learner reads after the run: the prediction first, then every other choice."""
    facts, numbers = load_meta()["exercises"][name], Numbers(runs=runs)
    answer, mine = facts["answer"], exercise.PREDICTION
    lines = [f"You predicted {mine}, because: {exercise.WHY.strip()}",
             "That is what happens." if mine == answer else f"What happens is {answer}."]
    for choice in [answer] + [each for each in exercise.CHOICES if each != answer]:
        reason = numbers.render(facts["reveal"][choice])
        word = "Why" if choice == answer else "Why not"
        lines += ["", textwrap.fill(f"{word} {choice}: {reason}", 96)]
    return "\n".join(lines)


def hint(name, argv=None):
    """Parse the command line of an exercise; with --hint print it and return True."""
    hints = load_meta()["exercises"][name]["hints"]
    parser = Parser(description=f"Exercise {name}.")
    parser.add_argument("--hint", type=number(int, low=1, high=len(hints)), metavar="N",
                        help=f"print hint N, 1 to {len(hints)}, and do nothing else")
    args = parser.parse_args(argv)
    if args.hint:
        print(f"hint {args.hint} of {len(hints)}: {hints[args.hint - 1]}")
    return bool(args.hint)


def play(name, exercise, argv=None):
    """Refuse before a choice; then measure, show, explain. Returns the exit status."""
    if hint(name, argv):
        return 0
    todo = missing(exercise)
    if todo:
        print(todo, file=sys.stderr)
        return 2
    runs = exercise.measure()
    print(exercise.table(runs), verdict(name, exercise, runs), sep="\n\n")
    return 0
