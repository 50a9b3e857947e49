# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 10, write it (40 minutes): ask twice.

An impact has its own moment. Between two impacts a gap is gap + v_n t + a_n t^2 / 2, and the next
one is where it closes: write time_to_impact first. What lasts has no such moment, and lcp asks one
question for two things: where a ball may go, and how fast it may be afterwards. So ask twice.
Around your other two functions is lcp_step, taken apart:

    list all contacts that a step may bring together
    kick, least = before_the_move(gap, dt)          for each contact, its gap
    that share of gravity's kick, sweeps for these least speeds; lam is what they gave
    move
    the rest of the kick
    asked, least, lam, normal = after_the_move(...) for each contact again
    sweeps once more, for those that are asked, each beginning with its lam

exact judges it. Then read off the order of your step: the error of the slide, off/r, falls like dt
to which power? Write it as ORDER.
"""

import math  # noqa: F401  you will want it

from kit import script

script.main(__name__)


def time_to_impact(gap, v_n, a_n):
    """When a gap [m] >= 0 closes [s]; math.inf if it never does.

    Its speed is v_n [m/s], > 0 opening; its acceleration a_n [m/s^2] stays, -9.81 under gravity.
    A gap of 0 that opens has just bounced: asked is when it closes again.
    """
    return ...  # TODO: blank 1


def before_the_move(gap, dt):
    """(the share of gravity's kick that comes first, the least normal velocity [m/s] to move with).

    The step ends with gap + dt v_n [m]; it may not be negative. gap < 0 is an overlap.
    """
    return ...  # TODO: blank 2


def after_the_move(lam, then, now):
    """(whether this contact is asked, its least speed [m/s], lam to begin with, its normal).

    `lam` [N s] is what it gave on the way; `then` and `now` are the angles [rad] of its normal
    before and after the move. The balls stay where they are now: only their speeds are left.
    """
    return ...  # TODO: blank 3


ORDER = None  # of your slide's error, as a power of dt
