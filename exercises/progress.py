"""Which exercises are done, and which comes next. It needs no numpy: any command can ask."""

import json
import os

from curriculum.commands import command

HERE = os.path.dirname(os.path.abspath(__file__))
DONE = os.path.join(os.path.dirname(HERE), "outputs", "ch3.5-contact", "exercises.json")
FILES = sorted(name[:-3] for name in os.listdir(HERE) if name[:2] == "ex" and name[2:3].isdigit())


def done():
    """{exercise: its bet, or "done"}, as far as it was noted."""
    try:
        with open(DONE, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}


def next_exercise():
    """The first exercise that is not done, "exercises/ex1_predict_contact.py"; None if all are."""
    noted = done()
    return next((f"exercises/{file}.py" for file in FILES if file[:3] not in noted), None)


def practise():
    """The line that names the next exercise that is not done, or what comes after them."""
    file = next_exercise()
    if file is None:
        return "all exercises are done; next, the questions at the end of the chapter"
    return f"next, an exercise: {command(os.path.join(os.path.dirname(HERE), file))}"
