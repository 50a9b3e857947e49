"""What many balls need beside contact.py's steps: near pairs, the last impulses, the smallest gap.

This text stands before the loops that to_loops makes, and both are compiled together; see run.py.
Balls and contacts are rows of tables; the last ball is the floor.
"""

import math
from typing import NamedTuple

import numpy as np


class World(NamedTuple):
    """The tables that every loop is given."""

    balls: np.ndarray  # the last is the floor
    contacts: np.ndarray
    pairs: np.ndarray  # (2, M): balls that may touch in this step, in contact.py's order
    pushed: np.ndarray  # (M, 2): rank and impulse of the last step's contacts, in their order
    count: np.ndarray  # type: ignore[assignment]  # how many contacts, and how many impulses


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
        while k < known and W.pushed[k, 0] < here:
            k += 1
        found = k < known and W.pushed[k, 0] == here
        W.contacts[c].lam = share * (W.pushed[k, 1] if found else 0.0)
        contact_apply_impulse(W, c, W.contacts[c].lam)


def rank(W, c):
    """A number of the two balls that grows along a list of contacts: the floor's come first."""
    a, b, count = np.int64(W.contacts[c].a), np.int64(W.contacts[c].b), len(W.balls)
    return a if b == count - 1 else (a + 1) * count + b


def store_impulses(W, balls, contacts):
    """Keep the impulses for the next step."""
    W.count[1] = len(contacts)
    for k, c in enumerate(contacts):
        W.pushed[k, 0], W.pushed[k, 1] = rank(W, c), W.contacts[c].lam


def farthest_move(table):
    """How far [m] the farthest ball has moved since pairs were listed; 0 for one nowhere."""
    farthest = 0.0
    for ball in table[:-1]:
        dx, dy = ball.x - ball.listed_x, ball.y - ball.listed_y
        farthest = larger(farthest, dx * dx + dy * dy)
    return math.sqrt(farthest)


def take_steps(states, W, k, mark, marked, listed, fresh, skip, knobs):
    """Take steps from states[k] on, and write the states; returns k, reach, again. It stops

    before a step whose pairs are to be listed anew, to be seen from `reach` [m] > 0 (they had gaps
    of at most `listed`; `fresh`: just now), with `skip` after one that gives again the state and
    impulses at the mark, when the next mark is due, or at the end.
    """
    balls, table, pushed = np.arange(len(W.balls) - 1).astype(np.uint32), W.balls, W.pushed
    while k < len(states) - 1:
        reach = detection_distance(W, balls, knobs[0])  # no model looks farther
        if not (fresh or farthest_move(table) <= 0.499 * (listed - reach)):
            return k, reach, False  # two may have come so near
        k, fresh = k + 1, False
        W.count[0] = 0
        take_step(W, balls, *knobs)
        for i in balls:
            ball = table[i]
            states[k, 0, i], states[k, 1, i] = ball.x, ball.y
            states[k, 2, i], states[k, 3, i] = ball.vx, ball.vy
        if skip and W.count[1] == len(marked) and same(states[k], states[mark]):
            if same(pushed[: W.count[1]], marked):
                return k, 0.0, True
        if k > 64 + 1.25 * mark:
            break
    return k, 0.0, False


def same(numbers, others):
    """Whether two tables of as many rows hold the same bits."""
    numbers, others = numbers.view(np.int64), others.view(np.int64)
    for k in range(numbers.shape[0]):
        for i in range(numbers.shape[1]):
            if numbers[k, i] != others[k, i]:
                return False
    return True
