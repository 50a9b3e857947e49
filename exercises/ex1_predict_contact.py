# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 1, predict then run (10 minutes): where does the ball end up?

A ball falls about a metre onto a table and is followed for 1.6 s, twice, from the same height. The
two runs differ in one thing, the answer to: what force does the table apply? In penalty the table
is a very stiff spring with a damper beside it. In lcp it gives the impulse after which ball and
table no longer approach each other. Measured is how deep the ball is in the table at the worst
moment and at the end, in ball radii r.

A ball drops onto the table. What do the two contact models do differently?

    A  Nothing that matters: both stop the ball at the surface. A contact is a contact.
    B  The penalty ball never gets into the table but bounces for ever; the lcp ball gets in and
       settles.
    C  The penalty ball gets much deeper into the table on landing and also comes to rest inside it;
       the lcp ball ends on the surface.

One sentence: when the ball lies still, how does each model arrive at a push of m g?

Write your letter as PREDICTION and this sentence as WHY, and only then run

    python exercises/ex1_predict_contact.py     # add --hint 1 (2, 3) for a question that helps
    python checks.py -k ex1_
"""

from kit import script

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence


if __name__ == "__main__":
    script.main()
