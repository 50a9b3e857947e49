"""Which exercises are done, and which comes next. It needs no numpy: any command can ask."""

import json
import os

from curriculum.commands import command

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DONE = os.path.join(ROOT, "outputs", "ch3.5-contact", "exercises.json")
ORDER = ("ex1", "ex3", "ex6", "ex2", "ex5", "ex9", "ex10", "ex7", "ex4", "ex8")  # the chapter's
FILES = {
    name.split("_")[0]: f"exercises/{name}"
    for name in os.listdir(os.path.join(ROOT, "exercises"))
    if name[:2] == "ex" and name[2:3].isdigit()
}
FILES = {name: FILES[name] for name in ORDER if name in FILES}  # "exercises/ex1_...py" by name


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
    return next((file for name, file in FILES.items() if name not in noted), None)


def practise():
    """The line that names the next exercise that is not done, or what comes after them."""
    file = next_exercise()
    if file is None:
        return "all exercises are done; next, the questions at the end of the chapter"
    return f"next, an exercise: {command(os.path.join(ROOT, file))}"
