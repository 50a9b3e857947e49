"""One random scene under test: its runs by each model, and what the states of a run show.

What a step did is read from the states before and after it, never asked of the code.
"""

import re
from functools import cached_property

import numpy as np

import contact
from curriculum.stress import scenes

run_twin = (contact.optional_module("compiled.run") or contact).run_model  # bitwise identical
G = 9.81  # m/s^2, what every model must have, so it is not asked of contact.py
U = 2.0**-53  # the largest relative rounding error of one operation
STEPPED = contact.STEPPED
EVENTS = 300  # of a run of exact; one with more is not waited for
TOUCHING = 1e-12  # m: a deeper overlap at the start, and exact promises nothing
ASTRAY = 1e6  # m, m/s: a run is judged until a ball is farther off, or faster


class Trial:
    """A spec, the runs of it that were asked for, and words for what cannot be judged."""

    def __init__(self, spec):
        self.spec, self.scene, self.dt = spec, scenes.to_scene(spec), spec["dt"]
        self.start = contact.smallest_gap(self.scene.q0[None], self.scene.radius)[0]
        self.made, self.noted = {}, {}

    def run(self, model, way="twin", **changes):
        """Return the run of a stepped model, with entries of the spec changed.

        way: by the compiled "twin", by contact.py with "skips", or by its "plain" steps.
        """
        key = model, way, repr(changes)
        if key not in self.made:
            spec, take = self.spec | changes, run_twin if way == "twin" else contact.run_model
            given = model, scenes.to_scene(spec), spec["dt"], spec["steps"]
            self.made[key] = take(*given, scenes.to_settings(spec, skip=way != "plain"))
        return self.made[key]

    @cached_property
    def motions(self):
        """Return {model: Trajectory} of the stepped models."""
        return {m: Trajectory(self.scene, self.dt, self.run(m), m) for m in STEPPED}

    @cached_property
    def exact(self):
        """Return its Trajectory; None, and a note, where it has no promise, or too many EVENTS."""
        if self.start < -TOUCHING:
            self.noted["exact: starts in an overlap"] = {}
            return None
        left = iter(range(EVENTS))
        try:
            given = self.scene, self.dt, self.spec["steps"]
            run = contact.run_exact(*given, progress=lambda k: next(left))
        except StopIteration:
            self.noted[f"exact: more than {EVENTS} events"] = {}
            return None
        except RuntimeError as error:
            sentence = re.split("; |\\. ", str(error).removeprefix("exact: "))[0]
            self.noted["exact refuses: " + re.sub(r"\d[\d.,]*", "…", sentence)] = {}
            return None
        return Trajectory(self.scene, self.dt, run)


class Trajectory:
    """What the states of a run show: S steps, N balls, C possible contacts, the floor's first.

    sides (C, N): 1 at the upper ball of a contact, -1 at the other. gaps (S + 1, C) [m], normals
    (S + 1, 2, C) and speeds (S + 1, C): v_n [m/s] of every state. listed (S, C): whether penalty,
    lcp or soft looks at the contact in that step. falling (S, 2, N): the velocities with gravity
    alone. Distances are taken in the operations that IEEE arithmetic rounds correctly, so they
    have one answer.
    """

    def __init__(self, scene, dt, run, model="exact"):
        near = (np.abs(np.concatenate((run.q, run.v), axis=1)) < ASTRAY).all((1, 2))
        states = max(1, int(np.append(near, False).argmin()))  # those before it goes astray
        self.q, self.v, self.astray = run.q[:states], run.v[:states], states < len(run.q)
        self.dt, self.fixed = dt, ~np.isfinite(scene.mass)
        self.mass = np.where(self.fixed, 0.0, scene.mass)
        a, b = np.triu_indices(len(self.mass), 1)
        eye = np.eye(len(self.mass))
        self.sides = np.concatenate((eye, eye[a] - eye[b]))
        apart = self.q[:, :, a] - self.q[:, :, b]
        distance = np.sqrt(apart[:, 0] * apart[:, 0] + apart[:, 1] * apart[:, 1])
        reach = np.concatenate((scene.radius, scene.radius[a] + scene.radius[b]))
        self.gaps = np.concatenate((self.q[:, 1], distance), axis=1) - reach
        self.normals = np.zeros((states, 2, len(self.sides)))
        self.normals[:, 1] = 1.0  # up, at the floor and where two centres are one
        of_pairs, distance = self.normals[:, :, len(self.mass) :], distance[:, None]
        np.divide(apart, distance, out=of_pairs, where=distance > 0.0)
        self.speeds = self.along(self.v, self.normals)
        self.moves = np.abs(self.sides) @ (self.mass > 0.0) > 0.0  # contacts (C,) of any that move
        margin = contact.CONTACT_MARGIN if model == "lcp" else 0.0
        self.listed = (self.gaps[:-1] < margin) & self.moves
        self.falling = self.v[:-1] + dt * np.outer((0.0, -G), ~self.fixed)

    def along(self, v, normals):
        """Return the velocity [m/s] of every contact along these normals."""
        return ((v @ self.sides.T) * normals).sum(-2)

    def slowest(self):
        """Return how fast [m/s] the slowest contact of every state closes or has opened."""
        speed = self.speeds**2 + 2.0 * G * np.maximum(self.gaps, 0.0)
        return np.sqrt(np.where(self.moves, speed, np.inf).min(1))

    def struck(self):
        """Return in which steps some velocity changes by more than gravity (S,)."""
        return (np.abs(self.v[1:] - self.falling) > 1e-9).any((1, 2))
