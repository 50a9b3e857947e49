# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 9, predict then run (30 minutes): which knob cures it?

Five troubles that you have met, and four knobs. Each knob is turned alone, from its usual value:

    sink        penalty's drop: how deep the ball lies at rest
    dive        lcp's drop: how deep it is at the worst moment, the mean of nine seeds
    hop         lcp's drop: how high it comes again after it has landed, the mean of nine seeds
    sag         lcp's stack of ten: how deep the deepest contact is at rest
    trembling   penalty's stack of three at a step of 0.006 s: how much its overlap still varies

In BETS put for every ? one of: - it becomes less, at most half; + more, at least double; = neither.
Then a number, on paper. A tower of seven balls stands under lcp; a step has a single sweep, from
the floor upwards, and opens half of an overlap. How deep is the lowest ball in the floor at rest,
in radii r = 0.1 m? Write it as SAG, to three digits, then look at gap/r of contact.py with

    --scene stack --bodies 7 --contact lcp --dt 0.001 --iters 1 --baumgarte 0.5
"""

from kit import script

script.main(__name__)

BETS = """
              k x 4    dt / 4    sweeps x 4    beta x 4
    sink        ?        ?           ?            ?
    dive        ?        ?           ?            ?
    hop         ?        ?           ?            ?
    sag         ?        ?           ?            ?
    trembling   ?        ?           ?            ?
"""
SAG = None  # r, from your paper
