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


def room(W):
    """An array for the rows of contacts, as many as there can be."""
    return np.empty(len(W.contacts), np.uint32)


def next_row(W):
    """The row of a new contact."""
    W.count[0] += 1
    return np.uint32(W.count[0] - 1)


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


def list_pairs(balls, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    Near balls are found by their shadows on the axis of the wider spread. A shadow is as long as
    its own ball is wide, so one large ball costs no more than itself; above is room for `reach` and
    for rounding. A ball with a position that is not finite is in no pair: it touches nothing.
    """
    for ball in balls:
        ball.listed_x, ball.listed_y = ball.x, ball.y
    x, y, radius = balls["x"][:-1], balls["y"][:-1], balls["radius"][:-1]
    place = y if np.ptp(y) > np.ptp(x) else x
    low = place - radius
    high = place + (1.0 + 1e-9) * (radius + reach) + 1e-15 * np.abs(place)
    order, count, size = np.argsort(low), len(balls), 0
    keys = np.empty(4 * count, np.int64)  # a number for each pair, which grows as pairs do
    for k in range(len(order)):
        i = order[k]
        for j in order[k + 1 :]:
            if low[j] > high[i]:
                break
            dx, dy = balls[i].x - balls[j].x, balls[i].y - balls[j].y
            limit = (balls[i].radius + balls[j].radius + reach) * (1.0 + 1e-9)
            if dx * dx + dy * dy <= limit * limit:
                if size == len(keys):
                    keys = np.concatenate((keys, keys))
                keys[size] = min(i, j) * count + max(i, j)
                size += 1
    keys = np.sort(keys[:size])
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
    contacts, pushed = W.contacts, W.pushed
    if len(contacts) < len(W.balls) + pairs.shape[1]:
        contacts = np.empty(len(W.balls) + 2 * pairs.shape[1], contacts.dtype)
        pushed = np.empty(len(contacts), pushed.dtype)
        pushed[: W.count[1]] = W.pushed[: W.count[1]]
    return World(W.balls, contacts, pairs, pushed, W.count)


def same(state, other, pushed, others):
    """Whether states and impulses are equal. Then their futures are, but for signs of zeros."""
    for one, two in zip(state.flat, other.flat):
        if one != two:
            return False
    for c, d in zip(pushed, others):
        if c.rank != d.rank or c.lam != d.lam:
            return False
    return len(pushed) == len(others)


def take_steps(states, W, listed, cycles, spreads, knobs):
    """Take len(states) - 1 steps, and write the states to states[1:].

    The world's pairs had gaps of at most `listed` [m]. Returns these two at the end, the steps
    taken, and 0. With `cycles` a state that has come before ends the steps, and in place of 0
    stands how many steps ago it was. A state is compared with one other, that of the largest power
    of two (Brent 1980).
    """
    balls, skin = np.arange(len(W.balls) - 1).astype(np.uint32), np.median(W.balls["radius"][:-1])
    mark, marked = 1, W.pushed[:0]
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
        pushed = W.pushed[: W.count[1]]
        if cycles and k > mark and same(states[k], states[mark], pushed, marked):
            return W, listed, k, k - mark
        if k == 2 * mark or k == 1:
            mark, marked = k, pushed.copy()
    return W, listed, len(states) - 1, 0


def find_gaps(q, balls, skin):
    """The smallest gap to the floor or between two balls in each state q (S, 2, N).

    A pair that is not listed was farther apart than `reach`, and may have come nearer by what two
    balls have moved. Where that does not decide, the pairs are listed anew, as far as it takes.
    """
    gaps = np.empty(len(q))
    pairs = list_pairs(balls, 0.0)
    reach = -math.inf
    for k in range(len(q)):
        balls["x"][:-1], balls["y"][:-1] = q[k, 0], q[k, 1]
        if not np.isfinite(q[k]).all():
            gaps[k] = gap_of_all(balls)
            continue
        gaps[k] = gap_of_listed(balls, pairs)
        if not gaps[k] < 0.999 * reach - 2.0 * farthest_move(balls):
            reach, gaps[k] = 0.5 * skin + 1e-150, math.inf
            while not gaps[k] < 0.999 * reach:
                reach *= 2.0
                pairs = list_pairs(balls, reach)
                gaps[k] = gap_of_listed(balls, pairs)
    return gaps


def gap_between(a, b):
    """The gap [m] between two balls."""
    dx, dy = b.x - a.x, b.y - a.y
    return math.sqrt(dx * dx + dy * dy) - (b.radius + a.radius)


def gap_of_listed(balls, pairs):
    """The smallest gap to the floor or between listed balls."""
    gap = (balls["y"][:-1] - balls["radius"][:-1]).min()
    for k in range(pairs.shape[1]):
        gap = min(gap, gap_between(balls[pairs[0, k]], balls[pairs[1, k]]))
    return gap


def gap_of_all(balls):
    """The smallest gap of all; NaN if any gap is."""
    gap = (balls["y"][:-1] - balls["radius"][:-1]).min()
    for i in range(len(balls) - 1):
        for j in range(i):
            gap = np.minimum(gap, gap_between(balls[i], balls[j]))
    return gap
