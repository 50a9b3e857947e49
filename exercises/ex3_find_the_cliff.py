# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Exercise 3, find out (25 minutes): where is the cliff?

A ball deep in the table of penalty, away from its balance by `depth` [m] and moving with `v_n`
[m/s], has another depth and velocity after one step. Both are sums of the old ones, so a step is a
matrix. The motion stays bounded as long as no eigenvalue is larger than 1. Write the matrix, then
find the longest step by a search that tries at most 20,000; a formula stands beside your answer.

The step is semi-implicit Euler: first the velocity, from force k depth - c v_n, then the depth, by
the new velocity. Gravity only moves the place of balance, so leave it out.
"""

import numpy as np  # noqa: F401  np.linalg.eigvals(matrix) is what you need
from kit import script

script.main(__name__)


def step_matrix(mass, stiffness, damping, dt):
    """Return the matrix, two rows of two numbers, of (depth, v_n) over a step `dt` [s].

    v_n > 0 is upwards, out of the table, so it makes the depth smaller.
    """
    return ...  # TODO: blank 1


def longest_step(mass, stiffness, damping):
    """Return the longest dt [s], to a thousandth of it, whose matrix has no eigenvalue above 1.

    Above 1 in size, that is: eigenvalues may be negative or complex. damping > 0.
    """
    return ...  # TODO: blank 2
