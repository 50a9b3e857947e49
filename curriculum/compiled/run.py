"""Run many balls by the compiled loops of contact.py's own steps.

Nothing may be rounded differently: no fast-math, no fused multiply-add.
"""

import math
import re
import sys
from functools import cache
from inspect import getsource
from pathlib import Path

import numpy as np

import contact
from curriculum.compiled import pairs, rows, to_loops
from curriculum.compiled.cache import Loops

STATES = 200_000  # positions of balls that are filled in one go: between two Ctrl-C is heard
PLAIN_SECONDS = {"penalty": 4e-6, "lcp": 1.5e-5, "soft": 3e-5, "leapfrog": 6e-5}  # measured
_, _, BY_HAND = Path(rows.__file__).read_text("utf-8").partition("\n# What is compiled")
IMPORTS = f"import math\nimport numpy as np\nfrom {rows.__name__} import World\n"
PAIRS = Loops("pairs", Path(pairs.__file__).read_text("utf-8"))


def loops_of(step: str) -> Loops:
    """Return the loops of a step of contact.py, with the values that its constants have now."""
    constants = [each for each in vars(contact).items() if type(each[1]) in (int, float)]
    return loops_with(step, *constants)


@cache
def loops_with(step, *constants) -> Loops:
    """Return loops_of(step), made once for the same constants."""
    text = to_loops.loops(step)
    if "def detection_distance(" not in text:  # it detects gaps up to the margin
        text += f"\n\ndef detection_distance(W, balls, dt):\n    return {contact.CONTACT_MARGIN}\n"
    parts = IMPORTS, BY_HAND, getsource(pairs.largest_approach), text, f"take_step = {step}\n"
    return Loops(step, "\n\n".join(parts))


def table(names, source) -> np.dtype:
    """Return the type of a row with those of the names that the loops use."""
    used = [name for name in names if re.search(rf"\.{name}\b", source)]
    return np.dtype([(name, np.uint32 if name in "ab" else float) for name in used])


def make_balls(scene, source) -> np.ndarray:
    """Return a table of a scene's balls, and last the floor, for these loops."""
    balls = np.zeros(len(scene.mass) + 1, table(to_loops.BALL, source))
    columns = dict(zip(("x", "y", "vx", "vy"), (*scene.q0, *scene.v0)))
    columns |= {"mass": scene.mass, "radius": scene.radius, "inv_mass": 1.0 / scene.mass}
    for name in {*columns} & {*balls.dtype.names}:
        balls[name][:-1] = columns[name]
    return balls


class Stepper:
    """A run by a model that steps, which can be continued by some steps at a time."""

    def __init__(self, model, scene, dt, settings):
        step = contact.step_of(model, scene, dt, settings)
        self.knobs = tuple(same_type(name, value) for name, value in step.keywords.items())
        self.spreads = model == "lcp" and step.keywords["warm"] == 0.0  # any order does
        self.loops = loops_of(step.func.__name__)
        source, self.radius = self.loops.source, np.array(scene.radius, float, order="C")
        contacts, pairs = np.empty(0, table(to_loops.CONTACT, source)), np.empty((3, 0), np.uint32)
        tables = make_balls(scene, source), contacts, pairs, np.empty((0, 2)), np.zeros(2, np.int64)
        self.world = rows.World(*tables, np.zeros(1))
        self.balls = np.arange(len(self.radius), dtype=np.uint32)
        self.cutoff, self.skin = -math.inf, float(np.median(self.radius))
        self.listed, self.order = np.empty((2, len(self.radius))), np.arange(len(self.radius))

    def take(self, states) -> None:
        """Take len(states) - 1 steps from states[0], that of now, and write them to states[1:]."""
        k, take_steps = 0, None
        while k < len(states) - 1:
            given = states, self.world, self.balls, k, self.listed, self.cutoff, self.knobs
            take_steps = take_steps or self.loops.load({"take_steps": given}).take_steps
            k, distance = take_steps(*given)
            if k < len(states) - 1:
                self.list_pairs(states[k, :2].copy(), distance + self.skin)

    def list_pairs(self, q, cutoff) -> None:
        """List the pairs anew, with room for their contacts."""
        balls, contacts, _, impulses, count, _ = self.world
        self.listed, self.cutoff = q, cutoff
        pairs = pair_loops().list_pairs(q, self.radius, cutoff, self.order)
        if self.spreads:
            pairs = pair_loops().spread_out(pairs, len(self.radius))
        most = max(len(balls) + pairs.shape[1], count[0])  # more, where a step had too many
        if most > len(contacts):
            contacts = np.empty(most + most // 4, contacts.dtype)
            impulses = np.resize(impulses, (len(contacts), 2))
        self.world = self.world._replace(contacts=contacts, pairs=pairs, impulses=impulses)


def same_type(name, value):
    """Return the value of a setting in the type that it always has: others are compiled anew."""
    kind = contact.LIMITS[name][0]
    return tuple(map(kind, value)) if name in contact.SEVERAL else kind(value)


@cache
def pair_loops():
    """Return the module of pairs.py, compiled."""
    given = np.ones((2, 1)), np.ones(1), 1.0, np.arange(1)
    return PAIRS.load({"list_pairs": given, "spread_out": (np.empty((3, 1), np.uint32), 1)})


def run_model(model, scene, dt, steps, settings) -> contact.Run:
    """The run by a model that steps: what contact.run_model gives, bit for bit."""
    stepper = Stepper(model, scene, dt, settings)
    states = np.empty((steps + 1, 4, len(scene.mass)))
    states[0, :2], states[0, 2:] = scene.q0, scene.v0
    for k in range(0, steps, part := 1 + STATES // len(scene.mass)):
        stepper.take(states[k : k + part + 1])
    states += 0.0  # turns -0.0 into 0.0
    states[np.isnan(states)] = math.nan  # which has a sign too, left to chance
    return contact.Run(np.arange(steps + 1) * dt, states[:, :2], states[:, 2:])


def run_if_it_pays(model, scene, dt, steps, settings) -> contact.Run | None:
    """Return the Run, or None where plain loops are as soon done, or must do it."""
    count = len(scene.mass)  # a ball costs PLAIN_SECONDS a step, a pair 0.12 microseconds
    seconds = steps * count * (6e-8 * count + PLAIN_SECONDS.get(model, 4e-5))
    try:
        if not loops_of(contact.MODELS[model].step.__name__).pays(seconds):  # type: ignore
            return None
        return run_model(model, scene, dt, steps, settings)
    except to_loops.Refused as error:
        print(f"{model} runs in plain loops: {error}", file=sys.stderr)
    except ImportError:
        pass  # numba does not work here
    return None
