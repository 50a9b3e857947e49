"""What the exercises stand on. Nothing to fill in here, and much that gives an answer away.

    script.py   an exercise's command line, what checks.py calls, which exercise comes next
    judge.py    tries what was written, in a process of its own, beside what is right
    trials.py   shows it at work, on balls
    bets.py     bets, and numbers from paper

answers.json has, in the chapter's order, hints, reasons, inputs and common mistakes ("slips") of
each exercise; ../solutions/ has a right answer of each.
"""

import json
import math
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parents[2]  # where contact.py and curriculum/ are
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
FACTS = json.loads(Path(__file__).with_name("answers.json").read_text("utf-8"))


def load(file):
    """Return what a file defines, as attributes."""
    return SimpleNamespace(**runpy.run_path(str(file), run_name=Path(file).stem))


def stack(masses, speeds, contacts):
    """Return a list of contacts between balls of these masses [kg] and velocities (vx, vy) [m/s].

    Each of `contacts` is (upper ball, lower ball or -1 for the floor, angle of its normal from the
    vertical [rad], target [m/s]).
    """
    from contact import Ball, Contact

    balls, made = [Ball(0.0, 0.0, *v, mass, 1.0) for v, mass in zip(speeds, masses)], []
    balls.append(Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0))  # the floor, which -1 finds
    for upper, lower, angle, target in contacts:
        made.append(Contact(balls[upper], balls[lower], math.sin(angle), math.cos(angle), 0.0))
        made[-1].target = target
    return made
