"""The next chapter begins here: a finger pushes three balls along, each against 2 N of drag."""

import math

from kit import ROOT  # noqa: F401  which finds contact.py

import contact

DT, MASS, X = 0.002, [math.inf, 1.0, 1.0, 1.0], [-0.5, -0.2, 0.1, 0.4]
SCENE = contact.scene_of(X, contact.RADIUS, MASS, vx=[0.3, 0.0, 0.0, 0.0])


def push(model):
    """Print where all are in the end, x [m], and the force on the finger [N], by that model."""
    step, force = contact.step_of(model, SCENE, DT, contact.Settings()), []

    def driven(balls):
        for ball in balls[1:]:
            ball.fx = -2.0 if ball.vx > 0.0 else 0.0  # drag, set anew in each step
        contacts = step(balls)  # lam is the impulse on ball a along n; the finger touches no floor
        force.append(sum(c.lam * c.nx for c in contacts if c.a.mass == math.inf) / DT)
        return contacts

    run = contact.simulate(driven, SCENE, DT, 2500)
    print(f"{model:<9} {run.q[-1, 0].round(3)}  {sum(force[-500:]) / 500:.4f} N")


for model in contact.STEPPED:
    push(model)
