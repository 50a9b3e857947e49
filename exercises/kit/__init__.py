"""What the exercises stand on. Nothing to fill in here, and much that gives an answer away.

    script.py   an exercise's command line, what checks.py asks, which exercise comes next
    judge.py    tries what was written, in a process of its own, beside what is right
    trials.py   shows it at work, on balls
    bets.py     bets, and numbers from paper

answers.json has hints, keys, reasons, inputs and slips; ../solutions/ a right answer of each.
"""

import json
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parents[2]  # where contact.py and curriculum/ are
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))


def load(file):
    """What a file defines, as attributes."""
    return SimpleNamespace(**runpy.run_path(str(file), run_name=Path(file).stem))
