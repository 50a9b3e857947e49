"""One random scene under test: its runs by each model, and what was done in their steps.

What a step did is read from the states before and after it, never asked of the code: the impulse
that contacts gave a ball is its change of momentum that gravity does not explain.
"""

import re
from functools import cached_property

import numpy as np

import contact
from curriculum.stress import scenes

run_twin = (contact.beside("fast") or contact).run_model  # the same bits, as a property says
G = 9.81  # m/s^2, what every model must have, so it is not asked of contact.py
U = 2.0**-53  # the largest relative rounding error of one operation
STEPPED = contact.STEPPED
EVENTS = 100  # of a run of exact; the rest is not waited for
TOUCHING = 1e-12  # m: a deeper overlap at the start, and exact promises nothing
ASTRAY = 1e6  # m, m/s: a run is judged until a ball is farther off, or faster


class Trial:
    """A spec, the runs of it that were asked for, and words for what cannot be judged."""

    def __init__(self, spec):
        self.spec, self.scene, self.dt = spec, scenes.to_scene(spec), spec["dt"]
        self.fixed = ~np.isfinite(self.scene.mass)
        self.mass = np.where(self.fixed, 0.0, self.scene.mass)
        self.made, self.noted = {}, {}

    def note(self, what, **numbers):
        """Remember what cannot be judged, or a limit that was met."""
        self.noted[what] = numbers

    def run(self, model, way="twin", **changes):
        """The run of a stepped model, with entries of the spec changed.

        way: by the compiled "twin", by contact.py with "skips", or by its "plain" steps.
        """
        key = model, way, repr(changes)
        if key not in self.made:
            spec, take = self.spec | changes, run_twin if way == "twin" else contact.run_model
            knobs = {name: spec[name] for name in scenes.KNOBS} | {"skip": way != "plain"}
            given = model, scenes.to_scene(spec), spec["dt"], spec["steps"]
            self.made[key] = take(*given, contact.Settings(**knobs))
        return self.made[key]

    def ran(self):
        """The models whose run could be judged."""
        runs = self.motions | {"exact": self.exact}
        return [model for model, motion in runs.items() if motion and len(motion.push)]

    @cached_property
    def motions(self):
        """{model: Trajectory} of the stepped models."""
        return {model: Trajectory(self, self.run(model), model) for model in STEPPED}

    @cached_property
    def exact(self):
        """Its Trajectory; None, and a note, where it promises nothing."""
        if contact.smallest_gap(self.scene.q0[None], self.scene.radius)[0] < -TOUCHING:
            self.note("exact: starts in an overlap")
            return None
        run = self.run_exact(self.dt, self.spec["steps"])
        return run and Trajectory(self, run)

    def run_exact(self, dt, steps):
        """A run of exact, as far as EVENTS go; None, and a note, where it refuses."""
        case, done = ("exact", self.scene, dt), []

        def report(samples):
            done.append(samples)
            if len(done) > EVENTS:
                raise TimeoutError

        try:
            return contact.run_model(*case, steps, progress=report)
        except TimeoutError:
            self.note(f"exact: cut after {EVENTS} events")
            # what was done by then is made again, and judged
            return contact.run_model(*case, done[-1] - 1) if done[-1] > 1 else None
        except RuntimeError as error:
            sentence = re.split("; |\\. ", str(error).removeprefix("exact: "))[0]
            self.note("exact refuses: " + re.sub(r"\d[\d.,]*", "…", sentence))
            return None


class Trajectory:
    """What a run did: S steps, N balls, C possible contacts, the floor's first.

    sides (C, N): 1 at the upper ball of a contact, -1 at the other. At the start of each step
    depth (S, C) [m] and normal (S, 2, C); listed (S, C): whether the model looks at the contact.
    before, after (S, C): v_n along that normal before and after the step [m/s]. push (S, 2, N):
    what contacts added to the momentum of each ball [kg m/s]; top (S, N): a bound on its speed
    in the course of the step, from the energies. Distances are taken in the operations that IEEE
    arithmetic rounds correctly, so they have one answer.
    """

    def __init__(self, trial, run, model="exact"):
        near = (np.abs(np.concatenate((run.q, run.v), axis=1)) < ASTRAY).all((1, 2))
        states = max(1, int(np.append(near, False).argmin()))  # those before it goes astray
        self.dt, self.mass = trial.dt, trial.mass
        self.q, self.v, self.astray = run.q[:states], run.v[:states], states < len(run.q)
        self.a, self.b = np.triu_indices(len(trial.mass), 1)
        eye = np.eye(len(trial.mass))
        self.sides = np.concatenate((eye, eye[self.a] - eye[self.b]))
        self.measure(trial.scene.radius)
        self.listed = self.depth > -looks(model, trial.spec, self.v[:-1])[:, None]
        self.inv_mass = np.abs(self.sides) @ inverse(self.mass)  # 1 / m_a + 1 / m_b of a contact
        self.listed &= self.inv_mass > 0.0
        self.before, self.after = (self.along(v) for v in (self.v[:-1], self.v[1:]))
        self.falling = self.v[:-1] + trial.dt * np.outer((0.0, -G), ~trial.fixed)
        self.push = self.mass * (self.v[1:] - self.falling)
        opens = 2.0 * contact.OPENS * trial.scene.radius.max() / trial.dt  # leapfrog takes it back
        self.top = self.fastest(opens if model == "leapfrog" else 0.0)
        self.count = self.on_balls(self.listed)  # of contacts of a ball (S, 1, N)
        self.pushed = self.count * self.mass > 0.0  # what contacts may move
        self.lengths = 2 * self.reach + np.abs(self.depth)  # that make a depth (S, C)
        self.speeds = self.on_contacts(self.top)  # that make a v_n (S, C)
        self.size = (self.mass * self.top)[:, None]  # of each momentum (S, 1, N)

    def measure(self, radius):
        """Set depth, normal and reach: the distance of the centres at which two balls touch."""
        q = self.q
        apart = q[:, :, self.a] - q[:, :, self.b]
        distance = np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1])
        self.reach = np.concatenate((radius, radius[self.a] + radius[self.b]))
        self.depth = self.reach - np.concatenate((q[:-1, 1], distance[:-1]), axis=1)
        self.normals = np.zeros((len(q), 2, len(self.sides)))
        self.normals[:, 1] = 1.0  # up, at the floor and where two centres are one
        of_pairs, distance = self.normals[:, :, len(radius) :], distance[:, None]
        np.divide(apart, distance, out=of_pairs, where=distance > 0.0)
        self.normal = self.normals[:-1]

    def along(self, v):
        """The normal velocity [m/s] of every contact (S, C)."""
        return ((v @ self.sides.T) * self.normal).sum(1)

    def fastest(self, opens):
        """A solver comes nearer to its answer with every push, so energies bound the speeds; opens:
        the speed [m/s] that it may ask for on the way.
        """
        norms = np.sqrt((self.mass * self.v * self.v).sum((1, 2)))
        norms = norms[:-1] + 2.0 * norms[1:] + (self.dt * G + opens) * np.sqrt(self.mass.sum())
        own = np.abs(self.v).max(1)
        return np.maximum(norms[:, None] * np.sqrt(inverse(self.mass)), own[:-1] + own[1:])

    def total(self, impulses):
        """What impulses (S, C) [N s] along the normals add to each momentum (S, 2, N)."""
        return (impulses[:, None] * self.normal) @ self.sides

    def on_balls(self, values):
        """The sum of values (S, C) over the contacts of each ball (S, 1, N)."""
        return (values @ np.abs(self.sides))[:, None]

    def on_contacts(self, values):
        """The sum of values (S, N) over the balls of each contact (S, C)."""
        return values @ np.abs(self.sides).T

    @cached_property
    def alone(self):
        """Listed contacts whose moving balls have no other listed contact (S, C)."""
        moves = self.mass > 0.0
        return self.listed & (self.on_contacts(self.count[:, 0] * moves) <= self.on_contacts(moves))


def looks(model, spec, v):
    """How wide a gap [m] the model still calls a contact, in each state v (S, 2, N)."""
    margin = np.full(len(v), contact.CONTACT_MARGIN if model in ("lcp", "leapfrog") else 0.0)
    if model == "leapfrog":  # as far as a step goes
        fastest = np.sqrt(v[:, 0] * v[:, 0] + v[:, 1] * v[:, 1]).max(1)
        return np.maximum(margin, 2.0 * spec["dt"] * (fastest + spec["dt"] * G))
    return margin


def inverse(mass):
    """1 / mass, and 0 for the fixed ones, whose mass here is 0."""
    return np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > 0.0)
