"""Which exercises are done, and which comes next. It needs no numpy: any command can ask."""

import json
import sys

from curriculum.commands import command, write_json

from . import ROOT

DONE = ROOT / "outputs/ch3.5-contact/exercises.json"
ORDER = ("ex1", "ex3", "ex6", "ex2", "ex5", "ex9", "ex10", "ex7", "ex4", "ex8")  # the chapter's
PATHS = [path for name in ORDER for path in (ROOT / "exercises").glob(f"{name}_*.py")]
FILES = {path.stem.partition("_")[0]: f"exercises/{path.name}" for path in PATHS}


def done():
    """{exercise: "done"}, as far as it was noted."""
    try:
        return json.loads(DONE.read_text("utf-8"))
    except (OSError, ValueError):
        return {}


def note(name, right):
    """Note whether an exercise is done."""
    noted = {key: "done" for key in {*done(), name} if key != name or right}
    try:
        if noted != done():
            write_json(DONE, noted)
    except OSError as error:
        print(f"cannot note that {name} is done: {error}", file=sys.stderr)


def practise():
    """The line that names the next exercise that is not done, or what comes after them."""
    noted = done()
    for name, file in FILES.items():
        if name not in noted:
            return f"next, an exercise: {command(ROOT / file)}"
    return "all exercises are done; next, the questions at the end of the chapter"
