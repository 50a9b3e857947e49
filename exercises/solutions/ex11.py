import math

import contact

BETS = """
              k x 4    dt / 4    sweeps x 4    beta x 4    d0 = 0
    sink        -        =           .            .           .
    dive        .        -           =            =           .
    hop         .        -           =            +           .
    sag         .        -           -            -           .
    tremble     +        -           .            .           .
    flicker     .        =           .            .           -
"""
# v dt less the margin is the dive; it opens at beta depth / dt, and climbs out first
dive = math.sqrt(2 * 9.81 * 0.9) * 0.004 - contact.CONTACT_MARGIN
HOP = ((0.3 * dive / 0.004) ** 2 / (2 * 9.81) - (1 - 0.3 / 2) * dive) / contact.RADIUS
# the right contact sends the cup back with 20 N dt, while beta depth / dt opens
SAG = 20 * 0.003**2 / (0.25 * 2.5) / contact.RADIUS
# 3 cos a - 2 cos a0 < d0 cos a: from there on the hill asks for less than soft gives
FLICKER = math.degrees(math.acos(2 * math.cos(0.2) / (3 - 0.8)))
