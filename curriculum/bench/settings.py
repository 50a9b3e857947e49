"""Who competes: settings.csv, a line for every setting of every model and engine.

**To send a better setting, add one line to settings.csv**: the engine, its options as they are
typed, and the problems that it is for (names, "all", "-name" for all but this one, or a group of
GROUPS; piles/4: the piles, with four substeps in a step of 2 ms). The benchmark runs every line and
names the best. Options are those of the session in engines.py, or contact.py's own flags. `ahead`
is a way to start: a step that first accelerates and then moves is exact in free flight if its first
speed stands half a step earlier.
"""

import csv
from ast import literal_eval
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import engines

GROUPS = {
    "shared": "stack pile heavy_100 heavy_1000 tower spread pile_bounce cradle",
    "resting": "drop slide stack heavy_100 heavy_1000 tower spread glance",  # e = 0, no lottery
}


class Setting(NamedTuple):
    """One engine, or one of our models, with one set of choices."""

    engine: str  # a key of ENGINES, or a model
    options: str  # as they stand in the file
    problems: str

    @property
    def name(self):
        return f"{self.engine} {self.options}".strip()

    @property
    def knobs(self):
        """The options as a dict of numbers, tuples and words."""
        pairs = (word.split("=", 1) for word in self.options.split())
        return {key: text if text.isidentifier() else literal_eval(text) for key, text in pairs}

    @property
    def inner(self):
        """Substeps that the engine takes by itself in each step."""
        return self.knobs.get("inner", 1)

    @property
    def adaptive(self):
        """Whether it chooses its own steps: dt is only how often it is looked at."""
        return self.engine in ("exact", "events") or "scheme" in self.knobs

    @property
    def rare(self):
        """Whether one start and one process have to be enough."""
        slow = not self.adaptive or "radau3" in self.options
        return self.engine == "siconos" or self.engine == "drake" and slow

    def runs(self, problem):
        """Whether it is for a problem, or for the piles (any of piles/1, piles/4, ...)."""
        words = " ".join(GROUPS.get(word, word) for word in self.problems.split()).split()
        listed = problem in (word.partition("/")[0] for word in words)
        return listed or problem != "piles" and "all" in words and f"-{problem}" not in words

    @property
    def cuts(self):
        """Substeps that it takes for a step of the piles."""
        return int(self.problems.partition("piles/")[2].split(" ")[0] or 1)

    def build(self, scene, dt, substeps=1):
        """A session that is looked at every dt [s], after so many steps."""
        knobs, dt, engine = self.knobs, dt / substeps, self.engine
        ahead = knobs.pop("ahead", 0) * contact.GRAVITY * dt / self.inner / 2
        v0 = np.where(np.isfinite(scene.mass), scene.v0 + np.array([[0.0], [ahead]]), scene.v0)
        ours = partial(engines.Ours, model=engine)
        make = engines.ENGINES[engine][-1] if engine in engines.ENGINES else ours
        session = make(scene._replace(v0=v0), dt, **knobs)
        session.substeps = substeps
        return session


with Path(__file__).with_suffix(".csv").open(encoding="utf-8", newline="") as _file:
    EVERYBODY = [Setting(**row) for row in csv.DictReader(_file)]
BY_NAME = {setting.name: setting for setting in EVERYBODY if setting.problems[:5] != "piles"}
PILES = [setting for setting in EVERYBODY if setting.runs("piles")]
