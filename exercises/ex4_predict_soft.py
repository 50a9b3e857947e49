# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 4, predict then run (10 minutes): where does a ball rest in MuJoCo's contact?

Two balls of one size drop onto the table and come to rest, one of them ten times as heavy as the
other. The contact is soft, MuJoCo's, as MuJoCo sets it when nobody says otherwise: it asks for an
acceleration, as a damped spring would, and it gets only a part of what it asks for. Measured is how
deep each ball lies in the table at the end, in ball radii r, and the same for penalty.

A ball and one ten times as heavy come to rest in MuJoCo's contact. Where does each of them lie?

    A  Both lie a little way inside the table, equally deep.
    B  Both lie inside the table, the heavy one ten times as deep.
    C  Both lie on the surface, since the sweeps go on until nothing changes any more.

One sentence: at rest nothing accelerates. In which term does the mass stand?

Write your letter as PREDICTION and this sentence as WHY, and only then run

    python exercises/ex4_predict_soft.py        # add --hint 1 (2, 3) for a question that helps
    python checks.py -k ex4
"""

from kit import script

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence


if __name__ == "__main__":
    script.main()
