"""Which balls are near, and the smallest gap: loops that know no model, so compiled once for all.

q (2, N) are positions [m], radius (N,), pairs (2, M).
"""

import math

import numpy as np


def in_order(keys):
    """The rows of keys (N,), none of them NaN, by size (Shell 1959)."""
    order, step = np.arange(len(keys)), len(keys)
    while step > 1:
        step = max(1, step * 4 // 9)
        for k in range(step, len(keys)):
            row, at = order[k], k
            while at >= step and keys[order[at - step]] > keys[row]:
                order[at] = order[at - step]
                at -= step
            order[at] = row
    return order


def sort_pairs(pairs, keys, most):
    """The pairs by keys (M,), whole numbers below `most`; those of one key stay as they stand."""
    place, found = np.zeros(most + 1, np.int64), np.empty((2, len(keys)), np.uint32)
    for key in keys:
        place[key + 1] += 1
    for k in range(most):
        place[k + 1] += place[k]
    for k in range(len(keys)):
        found[0, place[keys[k]]], found[1, place[keys[k]]] = pairs[0, k], pairs[1, k]
        place[keys[k]] += 1
    return found


def list_pairs(q, radius, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    Near balls are found by their shadows on the axis of the wider spread. A shadow is as long as
    its own ball is wide, so one large ball costs no more than itself; above is room for `reach` and
    for rounding. A ball with a position that is not finite is in no pair: it touches nothing.
    """
    x, y, count, size, reach = q[0], q[1], len(radius), 0, (1.0 + 1e-9) * reach
    place = y if spread(y) > spread(x) else x
    low, high, pairs = np.empty(count), np.empty(count), np.empty((2, 4 * count), np.uint32)
    for k in range(count):
        low[k] = place[k] - radius[k] if abs(place[k]) < math.inf else math.inf
        high[k] = place[k] + (1.0 + 1e-9) * radius[k] + 1e-15 * abs(place[k]) + reach
    order = in_order(low)
    for k in range(count):
        i = order[k]
        for at in range(k + 1, count):
            j = order[at]
            if low[j] > high[i]:
                break
            dx, dy = x[i] - x[j], y[i] - y[j]
            limit = (1.0 + 1e-9) * (radius[i] + radius[j]) + reach
            if dx * dx + dy * dy <= limit * limit:
                if size == pairs.shape[1]:
                    few, pairs = pairs, np.empty((2, 2 * size), np.uint32)
                    for old in range(size):
                        pairs[0, old], pairs[1, old] = few[0, old], few[1, old]
                pairs[0, size], pairs[1, size] = min(i, j), max(i, j)
                size += 1
    pairs = sort_pairs(pairs, pairs[1, :size], count)
    return sort_pairs(pairs, pairs[0], count)


def spread(x):
    """How far apart the outermost are."""
    least = most = x[0]
    for each in x:
        least, most = min(least, each), max(most, each)
    return most - least


def spread_out(pairs, count):
    """The pairs reordered so that neighbours share no ball: a processor overlaps their work.

    Pairs that share a ball keep their order, and what others do to each other's balls is nothing,
    so no bit changes where sweeps alone read the contacts.
    """
    size = pairs.shape[1]
    rounds = np.empty(size, np.uint32)
    next_round = np.zeros(count, np.uint32)  # of each ball
    for k in range(size):
        i, j = pairs[0, k], pairs[1, k]
        rounds[k] = max(next_round[i], next_round[j])
        next_round[i] = next_round[j] = rounds[k] + 1
    return sort_pairs(pairs, rounds, size)


def find_gaps(q, radius, skin):
    """The smallest gap to the floor or between two balls in each state q (S, 2, N).

    Pairs that are not listed were farther apart than `reach`, and may have come nearer by what two
    balls have moved. Where that leaves it open which pair is nearest, they are listed anew, by
    `skin` [m] farther.
    """
    gaps, reach, listed = np.empty(len(q)), -math.inf, q[0]
    order = in_order(q[0, 0])
    pairs = np.empty((2, len(radius) - 1), np.uint32)
    for k in range(len(radius) - 1):  # some, for a first bound
        pairs[0, k], pairs[1, k] = order[k + 1], order[k]
    for k in range(len(q)):
        gap, moved = gap_of(q[k], radius, pairs), farthest_move(q[k], listed)
        if not moved < math.inf:  # a gap may be no number, and then the smallest is none
            for i in range(len(radius)):
                for j in range(i):
                    gap = least(gap, gap_between(q[k], radius, i, j))
        elif not gap < 0.999 * reach - 2.0 * moved:
            reach, listed = max(gap, 0.0) + skin, q[k]
            pairs = list_pairs(q[k], radius, reach)
            gap = gap_of(q[k], radius, pairs)
        gaps[k] = gap
    return gaps


def farthest_move(q, listed):
    """How far [m] the farthest ball has moved; inf or NaN where one was or is nowhere."""
    farthest = 0.0
    for k in range(q.shape[1]):
        dx, dy = q[0, k] - listed[0, k], q[1, k] - listed[1, k]
        farthest = -least(-farthest, -(dx * dx + dy * dy))
    return math.sqrt(farthest)


def gap_of(q, radius, pairs):
    """The smallest gap to the floor or between two balls of `pairs` (2, M)."""
    gap = math.inf
    for k in range(len(radius)):
        gap = least(gap, q[1, k] - radius[k])
    for k in range(pairs.shape[1]):
        gap = least(gap, gap_between(q, radius, pairs[0, k], pairs[1, k]))
    return gap


def gap_between(q, radius, i, j):
    """The gap between two balls."""
    dx, dy = q[0, i] - q[0, j], q[1, i] - q[1, j]
    return math.sqrt(dx * dx + dy * dy) - (radius[i] + radius[j])


def least(first, second):
    """The smaller of two numbers; NaN if one is."""
    return second if second < first or second != second else first
