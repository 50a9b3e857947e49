"""The contestants: contact.py's models and the engines' settings behind one interface.

A contestant belongs to a family (lcp, mujoco, ...), which gives it its colour and marker, and has
words for its setting. Our own settings stand at the end of this file, those of the engines in
engines.py.
"""

import importlib.util
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import contact
from curriculum.bench import engines

READ, BARE = "read", "bare"  # the two ways to time: see Contestant.prepare


class Contestant(NamedTuple):
    """One way of stepping a scene."""

    family: str
    words: str  # its setting, for a reader
    prepare: Callable  # (scene, dt, steps) -> {READ: call, BARE: call}; the calls step, no more
    record: Callable  # (scene, dt, steps) -> contact.Run, not timed
    refuses: Callable  # scene -> why it does not run it, or None
    adaptive: bool = False  # chooses its own steps: dt is only how often it is looked at
    only: tuple = ()  # the problems it is for; none means all
    substeps: int = 1  # it takes for each step that is asked for

    @property
    def name(self):
        return f"{self.family}: {self.words}"

    def dts(self, problem):
        """The steps to measure: all, or the middle one where dt is only a sampling."""
        return (0.002,) if self.adaptive else problem.dts

    def takes(self, problem):
        return not self.only or problem.name in self.only


def ours(family, words, step=None, only=(), adaptive=False, **options):
    """A model of contact.py with these options, or a step of our own under its simulate."""

    def run(scene, dt, steps):
        if step is not None:
            return contact.simulate(step(scene, dt), scene, dt, steps, skip=False)
        return contact.run_model(family, scene, dt, steps, **options)

    def prepare(scene, dt, steps):
        return {READ: lambda: run(scene, dt, steps)}  # it always records: there is no bare form

    missing = None
    if family == "exact" and importlib.util.find_spec("curriculum.exact") is None:
        missing = "curriculum/exact.py is missing"
    return Contestant(family, words, prepare, run, lambda scene: missing, adaptive, only)


def theirs(setting):
    """A setting of another engine."""

    def prepare(scene, dt, steps):
        read, bare = setting.build(scene, dt), setting.build(scene, dt)
        return {READ: lambda: read.trace(steps), BARE: lambda: bare.advance(steps)}

    def record(scene, dt, steps):
        return contact.Run(np.arange(steps + 1) * dt, *setting.build(scene, dt).states(steps))

    missing = engines.missing(setting.engine)
    return Contestant(
        setting.engine,
        setting.words,
        prepare,
        record,
        lambda scene: missing or setting.refuses(scene),
        setting.adaptive,
        substeps=setting.substeps,
    )


def flying_exactly(scene, dt):
    """lcp's step, but a ball that nothing pushed flies along its parabola: q + dt v + dt^2 g / 2.

    It tells flight and contact apart: what error is left is the contact's.
    """

    def step(balls):
        before = [ball.vy for ball in balls]
        contact.lcp_step(balls, dt, scene.restitution, 0.2, 20)
        for ball, vy in zip(balls, before):
            if ball.vy == vy + dt * contact.GRAVITY:
                ball.y -= 0.5 * dt * dt * contact.GRAVITY

    return step


MANY_CONTACTS = ("stack", "tower", "pyramid")  # where the number of sweeps matters
ONE_BALL = ("drop", "bounce", "elastic")
BRIEF = ("drop", "bounce", "stack", "elastic", "slide", "pyramid")  # not the tower
FLYING = "20 sweeps, flying exactly"

CONTESTANTS = (
    ours("penalty", "k 1e4"),
    ours("lcp", "20 sweeps", iters=20),
    ours("lcp", "10 sweeps", iters=10, only=MANY_CONTACTS),
    ours("lcp", "100 sweeps", iters=100, only=MANY_CONTACTS),
    ours("lcp", "no push", baumgarte=0.0, only=BRIEF),
    ours("lcp", FLYING, step=flying_exactly, only=ONE_BALL),
    ours("soft", "as shipped by MuJoCo, or direct where e > 0", only=BRIEF),
    ours(
        "soft",
        "time constant 2 dt, ratio 5, d 0.9999",
        solref=(1e-9, 5.0),
        solimp=contact.HARD,
        only=("drop", "stack", "slide", "pyramid"),
    ),
    ours("exact", "event to event", adaptive=True),
    *map(theirs, engines.SETTINGS),
)
BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS}
OURS = ("penalty", "lcp", "soft", "exact")
LABELS = {name: name for name in OURS} | {name: about[0] for name, about in engines.ENGINES.items()}
