# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 4, fill in (20 minutes): the two lines that make a contact one-sided.

penalty and lcp each have one line that lets a contact push and never pull. Detection, normals,
masses and time stepping are given, in contact.py, and your second line is called for one contact
after the other. The signs are those of the table at the top of contact.py.
"""

from kit import script

script.main(__name__)


def penalty_normal_force(depth, v_n, stiffness, damping):
    """Return the push [N] of a spring with a damper beside it, where bodies overlap by `depth`.

    depth [m] > 0. The spring has `stiffness` [N/m]; the damper has `damping` [N s/m] and works
    against the motion; v_n [m/s] is positive when the bodies separate.
    """
    return ...  # TODO: blank 1


def project_impulse(lam, dlam):
    """Return the new accumulated impulse [N s] of one contact within a sweep.

    `lam` has been accumulated so far; `dlam`, of either sign, is the change that would bring this
    contact to its target velocity right now.
    """
    return ...  # TODO: blank 2
