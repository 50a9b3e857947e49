# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 2, predict then run (10 minutes): what does a longer step do?

Two balls, one of 0.1 kg and one of 10 kg, each drop half a metre onto the table. The spring is the
usual one, and somebody is in a hurry: the time step is raised to 0.03 s. lcp, which asks for the
impulse after which ball and table no longer approach, takes that. penalty is the table as a spring.
Measured is the highest energy of the run above that at the start, in units of that at the start.

At dt = 0.03 s, which ball gains energy many times over under penalty?

    A  Both: the step is too long for that spring, whatever lies on it.
    B  The heavy one alone: it presses the spring in farther, so more comes back.
    C  The light one alone: the same push throws it farther within a step.

One sentence: in each model, what becomes of the push between one step and the next?

Write your letter as PREDICTION and this sentence as WHY, and only then run this file.
"""

from kit import script

script.main(__name__)

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence
