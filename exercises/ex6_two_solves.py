# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 6, write it (30 minutes): two solves, one for positions and one for velocities.

lcp solves once a step, so one velocity decides where a ball goes and how fast it is afterwards. To
get out of the table, it must move; to rest, it must not. So solve twice: at position level before
the move, where gap + dt v_n >= 0, and at velocity level after it, where v_n >= 0. The step around
your two functions, in the order of lcp_step:

    detect all contacts that a step may close
    kick, least = position_level(gap, dt)           for each contact, from its gap
    that share of gravity's kick, sweeps for these least speeds; lam is what they gave
    move, and the rest of the kick
    active, least, lam, normal = velocity_level(...)    for each contact again
    sweeps once more, over the active contacts, each starting from its lam

It is compared with exact. Then read off its order: the error of the slide, off/r, falls like dt to
which power? Write it as ORDER.
"""

from kit import script

script.main(__name__)


def position_level(gap, dt):
    """Return (the share of gravity's kick that comes first, the least v_n [m/s] to move with).

    The step ends with gap + dt v_n [m]; it may not be negative. gap < 0 is an overlap.
    """
    return ...  # TODO: blank 1


def velocity_level(lam, then, now):
    """Return (whether the contact is active, its least v_n [m/s], its first lam, its normal).

    `lam` [N s] is what it gave before the move; `then` and `now` are the angles [rad] of its normal
    before and after the move. The balls stay where they are now: only their speeds are left.
    """
    return ...  # TODO: blank 2


ORDER = None  # of your slide's error, as a power of dt
