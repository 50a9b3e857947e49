"""Exercise 4, predict then run (10 minutes): where does a ball rest in MuJoCo's contact?

Two balls of one size drop onto the table and come to rest, one of them ten times as heavy as the
other. The contact is soft, MuJoCo's, as MuJoCo sets it when nobody says otherwise: it asks for an
acceleration, as a damped spring would, and it gets only a part of what it asks for. Measured is how
deep each ball lies in the table at the end, in ball radii r, and the same for penalty.
Read CHOICES, write your PREDICTION and one sentence of WHY, and only then run

    python exercises/ex4_predict_soft.py        # add --hint 1 (2, 3) for a question that helps
    python checks.py -k ex4
"""

from kit import predict
from kit.predict import contact

QUESTION = (
    "A ball and one ten times as heavy come to rest in MuJoCo's contact. "
    "Where does each of them lie?"
)
CHOICES = {
    "A": "Both lie a little way inside the table, equally deep.",
    "B": "Both lie inside the table, the heavy one ten times as deep.",
    "C": "Both lie on the surface, since the sweeps go on until nothing changes any more.",
}
WHY_PROMPT = "One sentence: at rest nothing accelerates. In which term does the mass stand?"

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence, see WHY_PROMPT


def measure():
    """The depth at rest of both balls, in both models: {name: a number}, in r."""
    light, models, depth = contact.build_scene("drop"), ("soft", "penalty"), "rest_penetration_frac"
    heavy = light._replace(mass=10.0 * light.mass)
    return predict.measured(light, 0.002, 2000, models, light=depth) | predict.measured(
        heavy, 0.002, 2000, models, heavy=depth
    )


TABLE = ("depth at rest", ("soft", "penalty"), {"light": "1 kg", "heavy": "10 kg"}, "{:.5f} r")


if __name__ == "__main__":
    predict.main()
