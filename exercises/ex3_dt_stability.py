"""Exercise 3, predict then run (12 minutes): what does a longer step do?

You will turn one knob, the time step, and watch the energy of both contact models.

The drop again, same ball, same spring, with the step raised from 0.002 s to 0.03 s. Measured is the
highest energy of the run above the energy at the start, in units of the energy at the start.
Read CHOICES, write your PREDICTION and one sentence of WHY, and only then run

    python exercises/ex3_dt_stability.py        # add --hint 1 (2, 3) for a question that helps
    pytest checks.py -k ex3
"""

import sys

import predict
from predict import contact

QUESTION = "The drop with dt = 0.03 s. How much energy does each contact model gain?"
CHOICES = {
    "A": "Both blow up: no contact survives a step that long.",
    "B": "The penalty ball gains energy many times over; the lcp ball stays bounded.",
    "C": "Neither blows up: a longer step costs accuracy, the ball only sinks in a little more.",
}
WHY_PROMPT = "One sentence: in each model, what happens between two looks at the depth?"

PREDICTION = None       # "A", "B" or "C"
WHY = ""                # your sentence, see WHY_PROMPT


def measure():
    """The drop at both steps, both models, at the default length, and the two critical steps."""
    scene = contact.build_scene("drop")
    runs = {name: {"quality": predict.quality(scene, dt, steps=2000)}
            for name, dt in (("drop", 0.002), ("drop-dt-0.03", 0.03))}
    for name, damping in (("dt_crit_damped", scene.damping), ("dt_crit_penalty", 0.0)):
        limit = contact.critical_dt(float(scene.mass[0]), 1e4, damping)
        runs["drop"].setdefault("stability", {})[name] = limit
    return runs


def table(runs):
    """The measurement as text."""
    rows = {model: [run["quality"][model]["energy_excess"] for run in runs.values()]
            for model in ("penalty", "lcp")}
    return predict.columns("energy gained", ("dt = 0.002 s", "dt = 0.03 s"), rows, "{:.4g}")


if __name__ == "__main__":
    sys.exit(predict.play("ex3", sys.modules[__name__]))
