# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 3, predict then run (10 minutes): what does a longer step do?

The drop again, same ball, same spring, with the time step raised from 0.002 s to 0.03 s: somebody
is in a hurry. penalty is the table as a spring; lcp asks for the impulse after which ball and table
no longer approach. Measured is the highest energy of the run above the energy at the start, in
units of the energy at the start.

The drop with dt = 0.03 s. How much energy does each contact model gain?

    A  Both blow up: no contact survives a step that long.
    B  The penalty ball gains energy many times over; the lcp ball stays bounded.
    C  Neither blows up: a longer step costs accuracy, the ball only sinks in a little more.

One sentence: in each model, what happens between two looks at the depth?

Write your letter as PREDICTION and this sentence as WHY, and only then run

    python exercises/ex3_dt_stability.py        # add --hint 1 (2, 3) for a question that helps
    python checks.py -k ex3
"""

from kit import script

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence


if __name__ == "__main__":
    script.main()
