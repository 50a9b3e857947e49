"""Exercise 3, predict then run (10 minutes): what does a longer step do?

The drop again, same ball, same spring, with the time step raised from 0.002 s to 0.03 s: somebody
is in a hurry. penalty is the table as a spring; lcp asks for the impulse after which ball and table
no longer approach. Measured is the highest energy of the run above the energy at the start, in
units of the energy at the start.
Read CHOICES, write your PREDICTION and one sentence of WHY, and only then run

    python exercises/ex3_dt_stability.py        # add --hint 1 (2, 3) for a question that helps
    python checks.py -k ex3
"""

from kit import predict
from kit.predict import contact

QUESTION = "The drop with dt = 0.03 s. How much energy does each contact model gain?"
CHOICES = {
    "A": "Both blow up: no contact survives a step that long.",
    "B": "The penalty ball gains energy many times over; the lcp ball stays bounded.",
    "C": "Neither blows up: a longer step costs accuracy, the ball only sinks in a little more.",
}
WHY_PROMPT = "One sentence: in each model, what happens between two looks at the depth?"

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence, see WHY_PROMPT


SHORT, LONG = 0.002, 0.03  # s


def measure():
    """The drop at both steps, by both models, and the critical step: {name: a number}."""
    scene = contact.build_scene("drop")
    usual = predict.measured(scene, dt=SHORT, steps=2000, usual="energy_excess")
    longer = predict.measured(
        scene, dt=LONG, steps=2000, long="energy_excess", long_depth="max_penetration_frac"
    )
    return usual | longer | {"limit": contact.critical_dt(1.0, 1e4, scene.damping)}


TABLE = (
    "energy gained",
    ("penalty", "lcp"),
    {"usual": f"dt = {SHORT} s", "long": f"dt = {LONG} s"},
    "{:.4g}",
)


if __name__ == "__main__":
    predict.main()
