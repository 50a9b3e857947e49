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
        contact_push(W, c, W.contacts[c].lam)


def rank(W, c):
    """A number of the two balls that grows along a list of contacts: the floor's come first."""
    a, b, count = np.int64(W.contacts[c].a), np.int64(W.contacts[c].b), len(W.balls)
    return a if b == count - 1 else (a + 1) * count + b


def remember(W, balls, contacts):
    """Keep the impulses for the next step."""
    W.count[1] = len(contacts)
    for k, c in enumerate(contacts):
        W.pushed[k, 0], W.pushed[k, 1] = rank(W, c), W.contacts[c].lam


def list_pairs(x, y, radius, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    Near balls are found by their shadows on the axis of the wider spread. A shadow is as long as
    its own ball is wide, so one large ball costs no more than itself; above is room for `reach` and
    for rounding. A ball with a position that is not finite is in no pair: it touches nothing.
    """
    place, reach = y if np.ptp(y) > np.ptp(x) else x, (1.0 + 1e-9) * reach
    low, high = place - radius, place + (1.0 + 1e-9) * radius + 1e-15 * np.abs(place) + reach
    order, count, keys = np.argsort(low), len(x), []
    for k in range(count):
        i = order[k]
        for j in order[k + 1 :]:
            if low[j] > high[i]:
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


def farthest_move(x, y, old_x, old_y):
    """How far [m] the farthest ball has moved; 0 for one nowhere."""
    farthest = 0.0
    for k in range(len(x)):
        dx, dy = x[k] - old_x[k], y[k] - old_y[k]
        farthest = larger(farthest, dx * dx + dy * dy)
    return math.sqrt(farthest)


def with_pairs(W, reach, spreads):
    """The tables with the pairs that are near now, and with room for their contacts."""
    balls = W.balls[:-1]
    balls.listed_x[:], balls.listed_y[:] = balls.x, balls.y
    pairs = list_pairs(balls.x, balls.y, balls.radius, reach)
    if spreads:
        pairs = spread_out(pairs, len(W.balls))
    most = max(len(W.contacts), len(W.balls) + pairs.shape[1])
    pushed = np.empty((most, 2))
    pushed[: W.count[1]] = W.pushed[: W.count[1]]
    return World(W.balls, np.empty(most, W.contacts.dtype), pairs, pushed, W.count)


def take_steps(states, W, listed, spreads, skip, knobs):
    """Take len(states) - 1 steps, and write the states to states[1:].

    The world's pairs had gaps of at most `listed` [m]. Returns these two at the end. With `skip`,
    once state and impulses are those of an earlier step, what follows is a copy, as in simulate. A
    step is compared with one other, the last mark; marks grow rarer (Brent 1980).
    """
    balls, table = np.arange(len(W.balls) - 1).astype(np.uint32), W.balls
    skin, marked = np.median(table.radius[:-1]), W.pushed[: W.count[1]].copy()
    k, mark, steps = 0, 0, len(states) - 1
    while k < steps:
        k += 1
        reach = step_reach(W, balls, knobs[0])  # no model looks farther
        moved = farthest_move(table.x, table.y, table.listed_x, table.listed_y)
        if not moved <= 0.499 * (listed - reach):  # two may have come so near
            listed = reach + skin
            W = with_pairs(W, listed, spreads)
        W.count[0] = 0
        take_step(W, balls, *knobs)
        for i in balls:
            ball = table[i]
            states[k, 0, i], states[k, 1, i] = ball.x, ball.y
            states[k, 2, i], states[k, 3, i] = ball.vx, ball.vy
        pushed = W.pushed[: W.count[1]]
        if skip and same(states[k], states[mark]) and same(pushed, marked):
            period = k - mark
            for later in range(k + 1, steps + 1):
                states[later] = states[later - period]
            k += (steps - k) // period * period  # then the world is in this state again
        elif k > 64 + 1.25 * mark:
            mark, marked = k, pushed.copy()
    return W, listed


def same(numbers, others):
    """Whether two arrays hold the same bits."""
    if len(numbers) != len(others):
        return False
    for one, other in zip(numbers.view(np.int64).flat, others.view(np.int64).flat):
        if one != other:
            return False
    return True


def find_gaps(q, radius):
    """The smallest gap to the floor or between two balls in each state q (S, 2, N).

    Pairs that are not listed were farther apart than `reach`, and may have come nearer by what two
    balls have moved. Where that leaves it open which pair is nearest, they are listed anew.
    """
    gaps, reach, listed = np.empty(len(q)), -math.inf, q[0]
    order = np.argsort(q[0, 0])
    pairs = np.stack((order[1:], order[:-1])).astype(np.uint32)  # some, for a first bound
    for k in range(len(q)):
        x, y = q[k]
        gap = gap_of(x, y, radius, pairs)
        if not np.isfinite(q[k]).all():  # a gap may be no number, and then the smallest is none
            for lag in range(1, len(x)):
                some = np.stack((np.arange(lag, len(x)), np.arange(len(x) - lag)))
                gap = np.minimum(gap, gap_of(x, y, radius, some))
        elif not gap < 0.999 * reach - 2.0 * farthest_move(x, y, listed[0], listed[1]):
            reach, listed = max(gap, 0.0) + np.median(radius), q[k]
            pairs = list_pairs(x, y, radius, reach)
            gap = gap_of(x, y, radius, pairs)
        gaps[k] = gap
    return gaps


def gap_of(x, y, radius, pairs):
    """The smallest gap to the floor or between two balls of `pairs` (2, M)."""
    gap = (y - radius).min()
    for k in range(pairs.shape[1]):
        i, j = pairs[0, k], pairs[1, k]
        dx, dy = x[i] - x[j], y[i] - y[j]
        gap = np.minimum(gap, math.sqrt(dx * dx + dy * dy) - (radius[i] + radius[j]))
    return gap
