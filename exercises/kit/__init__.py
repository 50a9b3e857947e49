"""What the exercises stand on. Nothing to fill in here, and much that gives an answer away.

script.py starts an exercise, judge.py tries it in a process of its own, trials.py has all that is
run: bets, marks, numbers, answers at work; answers.json, in the chapter's order, all facts.
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
    """Return contacts between balls of these masses [kg] and velocities (vx, vy) [m/s].

    Each: the upper ball, the lower or -1 (floor), the normal's angle from up [rad], target [m/s].
    """
    from contact import FLOOR, Contact, make_balls, scene_of

    balls, made = [*make_balls(scene_of(0.0, 0.0, masses, 1.0, *zip(*speeds))), FLOOR], []
    for upper, lower, angle, target in contacts:
        made.append(Contact(balls[upper], balls[lower], math.sin(angle), math.cos(angle), 0.0))
        made[-1].target = target
    return made
