# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 7, write it (15 minutes): time of impact.

exact takes no steps. Between two impacts all accelerations stay the same, so a gap changes as
gap + v_n t + a_n t^2 / 2, and the next impact is where the first gap closes. When does one close?
Mind the cases: a gap may never close, and it may be closed now and on its way to open.
"""

import math  # noqa: F401  you will want it

from kit import script

script.main(__name__)


def time_to_impact(gap, v_n, a_n):
    """Return when a gap [m] >= 0 closes [s]; math.inf if it never does.

    Its speed is v_n [m/s], > 0 opening; its acceleration a_n [m/s^2] is constant, < 0 under
    gravity. A gap of 0 that opens has just bounced: return when it closes again.
    """
    return ...  # TODO
