# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""The next chapter begins here, with contact.py as a library: a finger pushes three balls along.

    python exercises/next_chapter.py

By every model that steps: where they are at the end [m], and the force on the finger [N], its mean
over the last second. By then it pushes all three, each against 2 N: right is -6 N.
"""

import math

from kit import ROOT  # noqa: F401  which finds contact.py

import contact

DT, STEPS, DRAG = 0.002, 2500, 2.0  # s; N on each ball that moves
SCENE = contact.scene_of([-0.5, -0.2, 0.1, 0.4], 0.1, [math.inf, 1.0, 1.0, 1.0])


def push(model):
    """The run of a model, and the force on the finger in each of its steps [N]."""
    step, force = contact.step_of(model, SCENE, DT, contact.Settings()), [0.0] * STEPS

    def driven(balls):
        finger, *rest = balls
        finger.vx = min(0.3, finger.vx + 0.2 * DT)  # nothing pushes it: it goes as it is told
        for ball in rest:
            ball.fx = -DRAG if ball.vx > 0.0 else 0.0  # drag, set anew in each step
        return step(balls)

    def see(k, contacts):  # lam is the impulse on ball a along n
        touches = [c for c in contacts if c.a.mass == math.inf and c.b is not contact.FLOOR]
        force[k] = sum(c.lam * c.nx for c in touches) / DT

    return contact.simulate(driven, SCENE, DT, STEPS, see=see), force


if __name__ == "__main__":
    for model in contact.STEPPED:
        run, force = push(model)
        print(f"{model:<9} {run.q[-1, 0].round(3)}  {sum(force[-500:]) / 500:.4f} N")
