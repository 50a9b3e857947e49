"""Exercise 1, predict then run (10 minutes): where does the ball end up?

You will compare two contact models by what they do to the surface they are there to keep.

A ball falls about a metre onto the table and is followed for 1.6 s, once with each model, from the
same height. Measured is how deep it is in the table at the worst moment and at the end, in ball
radii r.
Read CHOICES, write your PREDICTION and one sentence of WHY, and only then run

    python exercises/ex1_predict_contact.py     # add --hint 1 (2, 3) for a question that helps
    pytest checks.py -k ex1
"""

import sys

import predict
from predict import contact

QUESTION = "A ball drops onto the table. What do the two contact models do differently?"
CHOICES = {
    "A": "Nothing that matters: both stop the ball at the surface. A contact is a contact.",
    "B": "The penalty ball never gets into the table but bounces for ever; "
         "the lcp ball gets in and settles.",
    "C": "The penalty ball gets much deeper into the table on landing and also comes to rest "
         "inside it; the lcp ball ends on the surface.",
}
WHY_PROMPT = "One sentence: when the ball lies still, how does each model arrive at a push of m g?"

PREDICTION = None       # "A", "B" or "C"
WHY = ""                # your sentence, see WHY_PROMPT


def measure():
    """The drop at the length of --smoke, both models."""
    return {"smoke": {"quality": predict.quality(contact.build_scene("drop"), dt=0.002, steps=800)}}


def table(runs):
    """The measurement as text."""
    rows = {model: (q["max_penetration_frac"], q["rest_penetration_frac"])
            for model, q in runs["smoke"]["quality"].items()}
    return predict.columns("depth", ("deepest", "at rest"), rows, "{:.5f} r")


if __name__ == "__main__":
    sys.exit(predict.play("ex1", sys.modules[__name__]))
