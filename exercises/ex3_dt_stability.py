# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 3, predict then run (10 minutes): what does a longer step do?

Two balls, one of 0.1 kg and one of 10 kg, each drop half a metre onto the table. The spring is the
usual one, and the time step is raised from 0.002 s to 0.03 s: somebody is in a hurry. penalty is
the table as a spring; lcp asks for the impulse after which ball and table no longer approach.
Measured is the highest energy of the run above that at the start, in units of that at the start.

At dt = 0.03 s, which of them gain energy many times over?

    A  All four: no contact survives a step that long.
    B  Both balls under penalty, since the step is too long for that spring; none under lcp.
    C  Under penalty the light ball, and the heavy one gains none; none under lcp.

One sentence: in each model, what happens between two looks at the depth?

Write your letter as PREDICTION and this sentence as WHY, and only then run this file.
"""

from kit import script

script.main(__name__)

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence
