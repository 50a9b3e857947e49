"""Siconos's Moreau-Jean step, run by Debian's own Python: a scene in on stdin, states out, as JSON.

Restitution is Newton's law, at the end of the step in which an impact falls. Its friction law comes
with a tangent, so friction is 0. What cannot move has a mass of 1e12 kg and no weight.
"""

import json
import sys
import time

import numpy as np
import siconos.kernel as kernel
from siconos.mechanics.collision.bodies import Disk, DiskDiskR, DiskPlanR

FIXED = 1e12  # kg


def build(given):
    """The simulation, its bodies, and what has to be kept alive beside them."""
    model, law = (
        kernel.NonSmoothDynamicalSystem(0.0, 1e9),
        kernel.NewtonImpactFrictionNSL(given["e"], 0.0, 0.0, 2),
    )
    bodies, kept = [], [law]
    for q, v, mass, radius in zip(*(given[part] for part in ("q", "v", "mass", "radius"))):
        body = Disk(radius, mass, np.array([*q, 0.0]), np.array([*v, 0.0]))
        weight = 0.0 if mass >= FIXED else -given["gravity"] * mass
        body.setFExtPtr(np.array([0.0, weight, 0.0]))
        model.insertDynamicalSystem(body)
        pairs = [(DiskDiskR(radius, size), other) for other, size in bodies]
        floor = [(DiskPlanR(radius, 0.0, 1.0, 0.0, 0.0, 0.0, 2000.0),)] * (mass < FIXED)
        for relation, *others in floor + pairs:
            kept.append(kernel.Interaction(law, relation))
            model.link(kept[-1], body, *others)
        bodies.append((body, radius))
    kept += [kernel.MoreauJeanOSI(given["theta"]), kernel.FrictionContact(2)]
    kept[-1].numericsSolverOptions().dparam[0] = 1e-10
    kept[-1].numericsSolverOptions().iparam[0] = 10_000
    kept.append(kernel.TimeDiscretisation(0.0, given["dt"]))
    stepping = kernel.TimeStepping(model, kept[-1], *kept[-3:-1])
    stepping.setNewtonTolerance(1e-10)
    return stepping, [body for body, _ in bodies], [model, *kept]


def main():
    given = json.load(sys.stdin)
    stepping, bodies, kept = build(given)

    def state():
        return [[body.q()[:2].tolist(), body.velocity()[:2].tolist()] for body in bodies]

    start, rows = time.process_time(), [state()]
    for _ in range(given["looks"]):
        for _ in range(given["substeps"]):
            stepping.computeOneStep()
            stepping.nextStep()
        rows.append(state())
    seconds = time.process_time() - start
    q, v = ([[ball[k] for ball in row] for row in rows] for k in (0, 1))
    print("\n" + json.dumps(dict(seconds=seconds, q=q, v=v)))  # after the words of the solver
