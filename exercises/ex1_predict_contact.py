# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 1, predict then run (10 minutes): how deep does a heavy ball lie?

Two balls, one of 1 kg and one of 4 kg, fall 0.6 m onto a table and are followed for 4 s.
What force does the table apply? In penalty the table is a very stiff spring with a damper beside
it. In lcp it gives the impulse after which ball and table no longer approach each other. Measured
is how deep each ball is in the table at the worst moment and at the end, in ball radii r.

How deep does the heavy ball lie when it has come to rest?

    A  As deep as the light one, in both models: a table is a table.
    B  Deeper than the light one, in both models: what is heavier presses harder on the same table.
    C  Under penalty four times as deep as the light one; under lcp no deeper.
    D  Under penalty twice as deep, since it brings four times the energy and a spring's energy
       grows with the depth squared; under lcp no deeper.

One sentence: when the ball lies still, how does each model arrive at a push of m g?

Write your letter as PREDICTION and this sentence as WHY, and only then run this file.
"""

from kit import script

script.main(__name__)

PREDICTION = None  # "A", "B", "C" or "D"
WHY = ""  # your sentence
