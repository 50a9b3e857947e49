"""Many bodies: which pairs are near, and which contacts can be solved side by side. Needs numpy."""

import numpy as np


def near_pairs(x, y, reach):
    """Index arrays i < j of all pairs closer than `reach` [m] and some others, in no set order.

    Balls are sorted into square cells of side `reach`, numbered along the rows. Partners are then in
    the same or the next cell, one run of the sorted list, or in three cells of the next row, another.
    """
    known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    x, y = x[known] - x[known].min(initial=0.0), y[known] - y[known].min(initial=0.0)
    side = max(reach, x.max(initial=0.0) / 2**30, y.max(initial=0.0) / 2**30)   # ids fit 64 bits
    column, row = (x / side).astype(int), (y / side).astype(int)
    width = column.max(initial=0) + 2                       # an empty cell ends every row
    cell = row * width + column
    order = np.argsort(cell, kind="stable")
    cell = cell[order]
    first = np.append(np.arange(1, len(cell) + 1), np.searchsorted(cell, cell + width - 1, "left"))
    last = np.searchsorted(cell, np.append(cell + 1, cell + width + 1), "right")
    count = last - first
    a = np.repeat(np.tile(known[order], 2), count)
    run = np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)        # 0, 1, ... in each
    b = known[order][np.repeat(first, count) + run]
    return np.minimum(a, b), np.maximum(a, b)


def independent_groups(i, j, bodies):
    """Contacts i, j (K,) in groups that share no body: sweeping group by group is sweeping in order.

    The group of a contact is one more than the largest group of an earlier contact that shares a
    body with it. The floor (j = -1) moves for no contact, so sharing it does not count. Returns one
    index array a group, each in the order of the list.
    """
    last, group = [0] * (bodies + 1), []
    for a, b in zip(i.tolist(), j.tolist()):
        last[a] = last[b] = max(last[a], last[b]) + 1
        last[-1] = 0
        group.append(last[a])
    order = np.argsort(group, kind="stable")
    cuts = np.flatnonzero(np.diff(np.array(group, int)[order])) + 1
    return np.split(order, cuts) if group else []
