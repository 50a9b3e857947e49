"""The fast twin of contact.py: its own steps for many balls, as loops that numba compiles.

The steps are contact.py's own source, turned from objects to rows of tables (to_loops.py), so a
run has the same bits. What is written by hand is what many balls need beside (rows.py, pairs.py):
near balls are found by their shadows on one axis, and listed for as long as no ball has moved far.
Nothing may be rounded differently: no fast-math, no fused multiply-add.
"""

import math
import re
import sys
from functools import cache
from pathlib import Path

import numpy as np

import contact
from curriculum.compiled import pairs as near
from curriculum.compiled import rows, to_loops
from curriculum.compiled.cache import Loops

STATES = 200_000  # positions of balls that are filled in one go, before progress() hears of it
_, _, BY_HAND = Path(rows.__file__).read_text("utf-8").partition("\n# What is compiled")
BY_HAND = f"import math\nimport numpy as np\nfrom {rows.__name__} import World\n{BY_HAND}"
NEAR = Loops("near", Path(near.__file__).read_text("utf-8"))


def loops_of(step: str) -> Loops:
    """The loops of a step of contact.py, with its constants of now."""
    return made(step, *(each for each in vars(contact).items() if type(each[1]) in (int, float)))


@cache
def made(step, *constants) -> Loops:
    """loops_of, made once for the same constants."""
    text = to_loops.loops(step)
    if "def detection_distance(" not in text:  # it looks as far as the margin
        text += (
            f"\n\ndef detection_distance(W, balls, dt):\n    return {contact.CONTACT_MARGIN!r}\n"
        )
    return Loops(step, f"{BY_HAND}\n\n{text}\n\ntake_step = {step}\n")


def table(names, source) -> np.dtype:
    """A row of those of the names that the loops use."""
    used = [name for name in names if re.search(rf"\.{name}\b", source)]
    return np.dtype([(name, np.uint32 if name in "ab" else float) for name in used])


def make_balls(scene, source) -> np.ndarray:
    """The balls of a scene, for these loops; then the floor."""
    balls = np.zeros(len(scene.mass) + 1, table((*to_loops.BALL, "listed_x", "listed_y"), source))
    columns = dict(zip(("x", "y", "vx", "vy"), (*scene.q0, *scene.v0)))
    columns |= {"mass": scene.mass, "radius": scene.radius, "inv_mass": 1.0 / scene.mass}
    for name in {*columns} & {*balls.dtype.names}:
        balls[name][:-1] = columns[name]
    return balls


class Stepper:
    """A run by a model that steps, which can be taken on by some steps at a time."""

    def __init__(self, model, scene, dt, settings):
        step = contact.step_of(model, scene, dt, settings)
        self.knobs = tuple(step.keywords.values())
        self.skip = settings.skip
        self.spreads = model == "lcp" and step.keywords["warm"] == 0.0  # any order does
        self.loops, self.listed = loops_of(step.func.__name__), -math.inf
        self.radius, self.skin = 1.0 * scene.radius, float(np.median(scene.radius))
        source = self.loops.source
        contacts, pairs = np.empty(0, table(to_loops.CONTACT, source)), np.empty((2, 0), np.uint32)
        tables = make_balls(scene, source), contacts, pairs, np.empty((0, 2)), np.zeros(2, np.int64)
        self.world = rows.World(*tables)

    def take(self, states) -> None:
        """Take len(states) - 1 steps from states[0], that of now, and write them to states[1:].

        Once state and impulses are those of an earlier step, what follows is a copy, as in
        simulate. A step is compared with one other, the last mark; marks grow rarer (Brent 1980).
        """
        last, k, mark, marked, fresh = len(states) - 1, 0, 0, self.pushed(), False
        take_steps = None
        while k < last:
            knobs = self.listed, fresh, self.skip, self.knobs
            given = states, self.world, k, mark, marked, *knobs
            take_steps = take_steps or self.loops.load({"take_steps": given}).take_steps
            k, reach, again = take_steps(*given)
            fresh = reach > 0.0
            if fresh:
                self.list_pairs(reach + self.skin)
            elif again:
                period = k - mark
                for later in range(k + 1, last + 1):
                    states[later] = states[later - period]
                k += (last - k) // period * period  # then the world is in this state again
            else:
                mark, marked = k, self.pushed()

    def pushed(self) -> np.ndarray:
        """The impulses of the last step."""
        return self.world.pushed[: self.world.count[1]].copy()

    def list_pairs(self, reach) -> None:
        """The tables with the pairs that are near now, and with room for their contacts."""
        balls, contacts, _, pushed, count = self.world
        q = np.array((balls["x"][:-1], balls["y"][:-1]))
        balls["listed_x"][:-1], balls["listed_y"][:-1] = q
        pairs = near_loops().list_pairs(q, self.radius, reach)
        if self.spreads:
            pairs = near_loops().spread_out(pairs, len(self.radius))
        most = len(balls) + pairs.shape[1]
        if most > len(contacts):
            contacts, old = np.empty(most, contacts.dtype), pushed
            pushed = np.empty((most, 2))
            pushed[: count[1]] = old[: count[1]]
        self.world, self.listed = rows.World(balls, contacts, pairs, pushed, count), reach


@cache
def near_loops():
    """The loops that find what is near, compiled."""
    q, radius = np.ones((1, 2, 1)), np.ones(1)
    given = {"list_pairs": (q[0], radius, 1.0), "find_gaps": (q, radius, 1.0)}
    return NEAR.load(given | {"spread_out": (np.empty((2, 1), np.uint32), 1)})


def run_model(model, scene, dt, steps, settings, progress=None) -> contact.Run:
    """The run by a model that steps: what contact.run_model gives, bit for bit.

    `progress(k)` is called with the steps done, now and then.
    """
    stepper = Stepper(model, scene, dt, settings)
    states = np.empty((steps + 1, 4, len(scene.mass)))
    states[0, :2], states[0, 2:] = scene.q0, scene.v0
    for k in range(0, steps, part := 1 + STATES // len(scene.mass)):
        stepper.take(states[k : k + part + 1])
        if progress:
            progress(min(k + part, steps))
    states += 0.0  # turns -0.0 into 0.0
    states[np.isnan(states)] = math.nan  # which has a sign too, left to chance
    return contact.Run(np.arange(steps + 1) * dt, states[:, :2], states[:, 2:])


def run_if_it_pays(model, scene, dt, steps, settings, progress=None) -> contact.Run | None:
    """The run, or None where the plain loops are as soon done, or must do it."""
    count = len(scene.mass)
    seconds = steps * (1.5e-7 * count * count + 4e-5 * count)  # of plain loops, measured
    try:
        if not loops_of(contact.MODELS[model].step.__name__).pays(seconds):  # type: ignore
            return None
        return run_model(model, scene, dt, steps, settings, progress)
    except to_loops.Refused as error:
        print(f"{model} runs in plain loops: {error}", file=sys.stderr)
    except ImportError:
        pass  # numba does not work here
    return None


def smallest_gap(q, radius) -> np.ndarray:
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N)."""
    skin = float(np.median(radius))
    return near_loops().find_gaps(np.array(q, float), np.array(radius, float), skin)


def gap_if_it_pays(q, radius) -> np.ndarray | None:
    """The smallest gaps, or None where numpy is as soon done."""
    seconds = 4e-9 * q.size * len(radius)  # of numpy, measured
    return smallest_gap(q, radius) if NEAR.pays(seconds) else None
