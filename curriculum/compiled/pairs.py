"""The broad phase: loops that list near pairs, compiled for all models.

Positions q (2, N) and a cutoff are in m, radius is (N,), pairs (3, M): first ball < second, and a
row for the keys of a sort. No model stands here, so these loops are compiled once.
"""

import math

import numpy as np


def list_pairs(q, radius, cutoff, order):
    """Return the pairs of balls whose gap is at most the cutoff, by first, then by second ball.

    Sort and sweep (Baraff 1992): each ball covers an interval on the axis of the wider spread, and
    only balls whose intervals overlap are compared. An interval is as long as its own ball is wide,
    so one large ball costs no more than itself; above is room for the cutoff and for rounding.
    order (N,): that of the last call is nearly right, so it is soon sorted, in place. A ball whose
    position is not finite is in no pair.
    """
    count, axis = len(radius), 1 if np.ptp(q[1]) > np.ptp(q[0]) else 0
    low, room, size = np.empty(count), 0, 4 * count
    for k in range(count):
        place = q[axis, order[k]]
        low[k] = place - radius[order[k]] if abs(place) < math.inf else math.inf
    sort_balls(low, order)
    pairs = np.empty((3, 0), np.uint32)
    while size > room:  # once, and again where there are more than expected
        room, size, pairs = size, 0, np.empty((3, size), np.uint32)
        for k in range(count):
            i = order[k]
            x, y, reach = q[0, i], q[1, i], (1.0 + 1e-9) * (radius[i] + cutoff)
            high = q[axis, i] + reach + 1e-15 * abs(q[axis, i])
            for at in range(k + 1, count):
                if low[at] > high:
                    break
                j = order[at]
                dx, dy, limit = x - q[0, j], y - q[1, j], reach + (1.0 + 1e-9) * radius[j]
                if dx * dx + dy * dy <= limit * limit:
                    if size < room:
                        pairs[0, size], pairs[1, size] = (i, j) if i < j else (j, i)
                    size += 1
    pairs = sort_pairs(pairs, pairs[1], size, count)
    return sort_pairs(pairs, pairs[0], size, count)


def sort_balls(keys, order):
    """Sort keys (N,), none of them NaN, and the order (N,) along with them (Shell 1959)."""
    step = len(keys)
    while step > 1:
        step = (4 * step + 5) // 9
        for k in range(step, len(keys)):
            key, ball, at = keys[k], order[k], k
            while at >= step and keys[at - step] > key:
                keys[at], order[at] = keys[at - step], order[at - step]
                at -= step
            keys[at], order[at] = key, ball


def sort_pairs(pairs, keys, size, most):
    """Return the first `size` pairs, sorted by their keys, whole numbers below `most` (stable)."""
    place, found = np.zeros(most + 1, np.int64), np.empty((3, size), np.uint32)
    for k in range(size):
        place[keys[k] + 1] += 1
    for k in range(most):
        place[k + 1] += place[k]
    for k in range(size):
        at = place[keys[k]]
        place[keys[k]] = at + 1
        found[0, at], found[1, at] = pairs[0, k], pairs[1, k]
    return found


def spread_out(pairs, count):
    """Reorder the pairs so that neighbours share no ball: a processor overlaps their work.

    Pairs that share a ball keep their order, and other pairs do not change each other's balls, so
    no bit changes where only sweeps read the contacts.
    """
    next_round = np.zeros(count + 1, np.int64)  # of each ball
    for k in range(pairs.shape[1]):
        i, j = pairs[0, k], pairs[1, k]
        pairs[2, k] = next_round[i] if next_round[i] > next_round[j] else next_round[j]
        next_round[i] = next_round[j] = pairs[2, k] + 1
    return sort_pairs(pairs, pairs[2], pairs.shape[1], pairs.shape[1])


def largest_approach(q, listed):
    """Return by how much [m] a gap may have shrunk since the balls were at `listed`.

    It is the diagonal of the smallest box that holds all displacements: 0 where all fall alike. A
    ball whose position is or was not finite has no displacement.
    """
    left, right, down, up = math.inf, -math.inf, math.inf, -math.inf
    for i in range(listed.shape[1]):
        dx, dy = q[0, i] - listed[0, i], q[1, i] - listed[1, i]
        left, right = (dx if dx < left else left), (dx if dx > right else right)
        down, up = (dy if dy < down else down), (dy if dy > up else up)
    width, height = (right - left if left < right else 0.0), (up - down if down < up else 0.0)
    return math.sqrt(width * width + height * height)
