# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 1, predict then run (10 minutes): where does the ball end up?

A ball of 4 kg falls half a metre onto a table and is followed for 4 s, twice. The two runs differ
in one thing, the answer to: what force does the table apply? In penalty the table is a very stiff
spring with a damper beside it. In lcp it gives the impulse after which ball and table no longer
approach each other. Measured is how deep the ball is in the table at the worst moment and at the
end, in ball radii r.

Where does it lie when it has come to rest?

    A  Both times on the surface: a table is a table.
    B  Under penalty inside the table, as deep as a ball of 1 kg would lie there, since the table is
       the same; under lcp on the surface.
    C  Under penalty inside it, four times as deep as a ball of 1 kg; under lcp on the surface.

One sentence: when the ball lies still, how does each model arrive at a push of m g?

Write your letter as PREDICTION and this sentence as WHY, and only then run this file.
"""

from kit import script

script.main(__name__)

PREDICTION = None  # "A", "B" or "C"
WHY = ""  # your sentence
