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


def build(given):
    """Return the simulation, its bodies, and objects that must stay alive."""
    model = kernel.NonSmoothDynamicalSystem(0.0, 1e9)
    law = kernel.NewtonImpactFrictionNSL(given["e"], 0.0, 0.0, 2)
    bodies, kept = [], [model, law]
    for q, v, mass, radius, fixed in given["balls"]:
        body = Disk(radius, 1e12 if fixed else mass, np.array([*q, 0.0]), np.array([*v, 0.0]))
        body.setFExtPtr(np.array([0.0, 0.0 if fixed else -given["gravity"] * mass, 0.0]))
        model.insertDynamicalSystem(body)
        pairs = [(DiskDiskR(radius, size), other) for other, size in bodies]
        floor = [] if fixed else [(DiskPlanR(radius, 0.0, 1.0, 0.0, 0.0, 0.0, 2000.0),)]
        for relation, *others in floor + pairs:
            kept.append(kernel.Interaction(law, relation))
            model.link(kept[-1], body, *others)
        bodies.append((body, radius))
    parts = kernel.TimeDiscretisation(0.0, given["dt"]), kernel.MoreauJeanOSI(0.5)
    solver = kernel.FrictionContact(2)
    solver.numericsSolverOptions().dparam[0] = 1e-10
    solver.numericsSolverOptions().iparam[0] = 10_000
    stepping = kernel.TimeStepping(model, *parts, solver)
    stepping.setNewtonTolerance(1e-10)
    return stepping, [body for body, _ in bodies], [*kept, *parts, solver]


def main():
    given = json.load(sys.stdin)
    stepping, bodies, kept = build(given)

    def state():
        return [[*body.q()[:2].tolist(), *body.velocity()[:2].tolist()] for body in bodies]

    start, rows = time.process_time(), [state()]
    for _ in range(given["looks"]):
        for _ in range(given["substeps"]):
            stepping.computeOneStep()
            stepping.nextStep()
        rows.append(state())
    seconds = time.process_time() - start
    print("\n" + json.dumps([seconds, rows]))  # after the words of the solver
