"""What many balls need beside contact.py's steps: near pairs, the last impulses, the smallest gap.

This text stands before the loops that to_loops makes, and both are compiled together; see fast.py.
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
    pushed: np.ndarray  # the impulses of the last step, in the order of its contacts
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
        while k < known and W.pushed[k].rank < here:
            k += 1
        found = k < known and W.pushed[k].rank == here
        W.contacts[c].lam = share * (W.pushed[k].lam if found else 0.0)
        contact_push(W, c, W.contacts[c].lam)


def rank(W, c):
    """A number of the two balls that grows along a list of contacts: the floor's come first."""
    a, b, count = np.int64(W.contacts[c].a), np.int64(W.contacts[c].b), len(W.balls)
    return a if b == count - 1 else (a + 1) * count + b


def remember(W, balls, contacts):
    """Keep the impulses for the next step."""
    W.count[1] = len(contacts)
    for k, c in enumerate(contacts):
        W.pushed[k].rank, W.pushed[k].lam = rank(W, c), W.contacts[c].lam


def shadows(x, y, radius):
    """Where the balls' shadows on the axis of the wider spread begin, and where they end.

    A shadow is as long as its own ball is wide, so one large ball costs no more than itself; above
    is room for rounding.
    """
    place = y if np.ptp(y) > np.ptp(x) else x
    low, high = place - radius, place + (1.0 + 1e-9) * radius + 1e-15 * np.abs(place)
    return low, high


def list_pairs(balls, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    A ball with a position that is not finite is in no pair: it touches nothing.
    """
    for ball in balls:
        ball.listed_x, ball.listed_y = ball.x, ball.y
    x, y, radius = balls.x[:-1], balls.y[:-1], balls.radius[:-1]
    low, high = shadows(x, y, radius)
    order = np.argsort(low)
    reach, count, keys = (1.0 + 1e-9) * reach, len(balls), []
    for k in range(len(order)):
        i = order[k]
        for j in order[k + 1 :]:
            if low[j] > high[i] + reach:
                break
            dx, dy = x[i] - x[j], y[i] - y[j]
            limit = (1.0 + 1e-9) * (radius[i] + radius[j]) + reach
            if dx * dx + dy * dy <= limit * limit:
                keys.append(min(i, j) * count + max(i, j))
    keys = np.sort(np.array(keys))
    return np.stack((keys // count, keys % count)).astype(np.uint32)  # no row is negative


def spread_out(pairs, count):
    """The pairs (2, M) reordered so that neighbours share no ball: a processor overlaps their work.

    Pairs that share a ball keep their order, and what others do to each other's balls is nothing,
    so no bit changes where sweeps alone read the contacts.
    """
    size = pairs.shape[1]
    rounds = np.empty(size, np.int64)
    next_round = np.zeros(count, np.int64)  # of each ball
    for k in range(size):
        i, j = pairs[0, k], pairs[1, k]
        rounds[k] = max(next_round[i], next_round[j])
        next_round[i] = next_round[j] = rounds[k] + 1
    return pairs[:, np.sort(rounds * size + np.arange(size)) % size]


def farthest_move(balls):
    """How far [m] the farthest ball has moved since the pairs were listed; 0 for one nowhere."""
    farthest = 0.0
    for ball in balls:
        dx, dy = ball.x - ball.listed_x, ball.y - ball.listed_y
        farthest = larger(farthest, dx * dx + dy * dy)
    return math.sqrt(farthest)


def with_pairs(W, reach, spreads):
    """The tables with the pairs that are near now, and with room for their contacts."""
    pairs = list_pairs(W.balls, reach)
    if spreads:
        pairs = spread_out(pairs, len(W.balls))
    most = max(len(W.contacts), len(W.balls) + pairs.shape[1])
    pushed = np.empty(most, W.pushed.dtype)
    pushed[: W.count[1]] = W.pushed[: W.count[1]]
    return World(W.balls, np.empty(most, W.contacts.dtype), pairs, pushed, W.count)


def take_steps(states, W, listed, spreads, knobs):
    """Take len(states) - 1 steps, and write the states to states[1:].

    The world's pairs had gaps of at most `listed` [m]. Returns these two at the end.
    """
    balls, skin = np.arange(len(W.balls) - 1).astype(np.uint32), np.median(W.balls.radius[:-1])
    for k in range(1, len(states)):
        reach = step_reach(W, balls, knobs[0])  # no model looks farther
        if not farthest_move(W.balls) <= 0.499 * (listed - reach):  # two may have come so near
            listed = reach + skin
            W = with_pairs(W, listed, spreads)
        W.count[0] = 0
        take_step(W, balls, *knobs)
        for i in balls:
            ball = W.balls[i]
            states[k, 0, i], states[k, 1, i] = ball.x, ball.y
            states[k, 2, i], states[k, 3, i] = ball.vx, ball.vy
    return W, listed


def find_gaps(q, radius):
    """The smallest gap to the floor or between two balls in each state q (S, 2, N).

    Balls whose shadows are farther apart than the smallest gap so far need no look, unless a
    position is not finite: a gap of two may be no number then, and so is the smallest.
    """
    gaps, order = np.empty(len(q)), np.arange(len(radius))
    for k in range(len(q)):
        x, y = q[k, 0], q[k, 1]
        finite, gap = np.isfinite(q[k]).all(), (y - radius).min()
        low, high = shadows(x, y, radius)
        order = order[np.argsort(low[order])]  # fast, since few balls change places
        for n in range(len(order)):
            i = order[n]
            for j in order[n + 1 :]:
                if finite and low[j] > high[i] + gap + 1e-9 * abs(gap):
                    break
                dx, dy, radii = x[i] - x[j], y[i] - y[j], radius[i] + radius[j]
                gap = np.minimum(gap, math.sqrt(dx * dx + dy * dy) - radii)
        gaps[k] = gap
    return gaps
