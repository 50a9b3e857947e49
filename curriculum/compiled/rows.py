"""What a model's loops need beside its step: impulses of the last step, and the loop over steps.

This text stands before the loops that to_loops makes, and both are compiled together; see run.py.
Balls and contacts are rows of tables; the last ball is the floor.
"""

from typing import NamedTuple

import numpy as np


class World(NamedTuple):
    """The tables that every loop is given."""

    balls: np.ndarray  # the last is the floor
    contacts: np.ndarray
    pairs: np.ndarray  # (3, M): balls that may touch in this step, in contact.py's order
    impulses: np.ndarray  # (M, 2): rank and impulse of the last step's contacts, in their order
    count: np.ndarray  # type: ignore[assignment]  # of rows that contacts need, and of impulses
    farthest: np.ndarray  # (1,): how far [m] this step looks, if farther than at its start


# What is compiled


def larger(first, second):
    """Python's max of two floats: the first unless the second is larger, so never NaN for 0."""
    return second if second > first else first


def smaller(first, second):
    """Python's min of two floats."""
    return second if second < first else first


def warm_start(W, contacts, share):
    """Begin with a share of the last step's impulses: both tables are in the same order."""
    k, known = 0, W.count[1]
    for c in contacts:
        here = rank(W, c)
        while k < known and W.impulses[k, 0] < here:
            k += 1
        found = k < known and W.impulses[k, 0] == here
        W.contacts[c].lam = share * (W.impulses[k, 1] if found else 0.0)
        contact_apply_impulse(W, c, W.contacts[c].lam)


def rank(W, c):
    """A number of the two balls that grows along a list of contacts: the floor's come first."""
    a, b, count = np.int64(W.contacts[c].a), np.int64(W.contacts[c].b), len(W.balls)
    return a if b == count - 1 else (a + 1) * count + b


def store_impulses(W, balls, contacts):
    """Keep the impulses for the next step."""
    W.count[1] = len(contacts)
    for k, c in enumerate(contacts):
        W.impulses[k, 0], W.impulses[k, 1] = rank(W, c), W.contacts[c].lam


def take_steps(states, W, balls, k, listed, cutoff, knobs):
    """Take steps from states[k] on, and write the states. Returns k at the end, or before a step

    that must detect gaps up to a distance [m] where the list of pairs may lack one (they had gaps
    up to the cutoff when the balls were at `listed`); and that distance.
    """
    distance = 0.0
    while k < len(states) - 1:
        distance = detection_distance(W, balls, knobs[0])  # no model looks farther
        if largest_approach(states[k], listed) > 0.998 * (cutoff - distance):
            break
        W.count[0], W.farthest[0] = 0, 0.0
        take_step(W, balls, *knobs)
        distance = W.farthest[0]
        far = distance > 0.0 and largest_approach(states[k], listed) > 0.998 * (cutoff - distance)
        if far or W.count[0] > len(W.contacts):
            for i in balls:  # take this step again
                ball = W.balls[i]
                ball.x, ball.y = states[k, 0, i], states[k, 1, i]
                ball.vx, ball.vy = states[k, 2, i], states[k, 3, i]
            break
        k += 1
        for i in balls:
            ball = W.balls[i]
            states[k, 0, i], states[k, 1, i] = ball.x, ball.y
            states[k, 2, i], states[k, 3, i] = ball.vx, ball.vy
    return k, distance
