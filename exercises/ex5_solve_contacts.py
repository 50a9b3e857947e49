# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 5, write it (30 minutes): solve_contacts, from its docstring.

The heart of lcp, of soft and of many engines is a loop of a few lines: projected Gauss-Seidel. You
have read it; now write it without looking. A contact c gives you

    c.target    the least normal velocity [m/s] to leave with
    c.v_n()     the normal velocity [m/s] that it has right now, positive when the two bodies part
    c.m_eff     the mass [kg] that a push has to move
    c.lam       the impulse [N s] given so far, 0 at first; keep it up to date
    c.apply_impulse(p)   gives body a the impulse p [N s] along the normal, body b the opposite
"""

from kit import script, stack  # noqa: F401  stack makes contacts to try yours on

script.main(__name__)


def solve_contacts(contacts, iters):
    """Find impulses so that every contact has lam >= 0, v_n >= target, and lam (v_n - target) = 0.

    Sweeps over the list `iters` times. A visit to a contact brings that one to its target, by a
    push that changes its lam, and so disturbs its neighbours; the next sweep mends those. Changes
    lam of the contacts and the velocities of their bodies. Returns nothing.
    """
    return ...  # TODO: your loop, in place of this line
