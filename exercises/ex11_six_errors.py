# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 11, predict then run (40 minutes): six errors, on paper.

Each error has the knobs of its model, and a knob is turned alone, from its usual value. d0 is the
impedance at the surface, the first number of solimp.

    sink      penalty's drop: how deep the ball lies at rest
    dive      lcp's drop: how deep it is at worst, the mean of nine seeds
    hop       lcp's drop: how high it comes again, the mean of nine seeds
    sag       lcp's stack of ten: how deep the deepest contact is at rest
    tremble   penalty's stack of three at 0.006 s: how much its overlap varies
    flicker   soft's ball on a hill: how unsteady its force is beside exact's

In BETS put for every ? one of: - it becomes less, at most half; + more, at least double; = neither.
Then three numbers, on paper, to three digits; r is RADIUS of contact.py.

HOP: a ball drops 0.9 m under lcp, in steps of 0.004 s, with beta = 0.3. At worst its contact is
detected as late as can be. How high does it hop then, in r? One start comes near:

    --contact lcp --dt 0.004 --baumgarte 0.3 --seed 20

SAG: the gripper of exercise 9, with a cup of 2.5 kg, under lcp with steps of 0.003 s, one sweep
each, and beta = 0.25; the left contact is solved first. How deep is it at rest, in r?

FLICKER: a ball starts at rest 0.2 rad from the top of a fixed ball, soft with d0 = 0.8. From which
angle on, in degrees from the top, does its force come and go?
"""

from kit import script

script.main(__name__)

BETS = """
              k x 4    dt / 4    sweeps x 4    beta x 4    d0 = 0
    sink        ?        ?           .            .           .
    dive        .        ?           ?            ?           .
    hop         .        ?           ?            ?           .
    sag         .        ?           ?            ?           .
    tremble     ?        ?           .            .           .
    flicker     .        ?           .            .           ?
"""
HOP = None  # r
SAG = None  # r
FLICKER = None  # degrees
