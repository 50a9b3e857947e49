"""Which exercises are done. It needs nothing but Python, so that any command can ask."""

import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DONE = ROOT / "outputs" / "ch3.5-contact" / "exercises.json"    # {name: the bet, or "done"}
FILES = sorted(path.stem for path in Path(__file__).parent.glob("ex[0-9]_*.py"))


def done():
    """{exercise: its bet, or "done"}, as far as it was noted."""
    try:
        return json.loads(DONE.read_text("utf-8"))
    except (OSError, ValueError):
        return {}


def next_exercise():
    """The first exercise that is not done, "exercises/ex1_predict_contact.py"; None if all are."""
    noted = done()
    return next((f"exercises/{file}.py" for file in FILES if file[:3] not in noted), None)
