import math

from contact import CONTACT_MARGIN, RADIUS

BETS = """
    sink        -        =           .            .           .
    dive        .        -           =            =           .
    hop         .        -           =            +           .
    sag         .        -           -            -           .
    tremble     +        -           .            .           .
    flicker     .        =           .            .           -
"""
depth = math.sqrt(2 * 9.81 * 0.9) * 0.004 - CONTACT_MARGIN  # it opens at beta depth / dt
HOP = ((0.3 * depth / 0.004) ** 2 / (2 * 9.81) - (1 - 0.3 / 2) * depth) / RADIUS
SAG = 20 * 0.003**2 / (0.25 * 2.5) / RADIUS  # the right contact sends the cup back with 20 N dt
# 3 cos a - 2 cos a0 < d0 cos a: from there on the hill asks for less than soft gives
FLICKER = math.degrees(math.acos(2 * math.cos(0.2) / (3 - 0.8)))
