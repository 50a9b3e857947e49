# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 8, find out (25 minutes): the implicit spring.

penalty takes the force that belongs to the depth *before* the step. Take the one that belongs to
the depth and the speed *after* it instead, with the same spring and the same damper:

    lam = dt (stiffness depth_after - damping v_n),   depth_after = depth - dt v_n

where v_n is the speed after the step. You do not know it yet, but you have a sweep that finds v_n
and lam together: solve_contacts looks for lam >= 0 such that v_n + softness lam - target is zero
where it pushes. Which softness and which target make that the equation above?
"""

from kit import script

script.main(__name__)


def implicit_spring(depth, stiffness, damping, dt):
    """Return (softness [1/kg], target [m/s]) for an overlap `depth` [m] before the step."""
    return ...  # TODO: softness and target
