"""Balls over a floor by arrays: which contacts there are, and which can be solved side by side.

What contact.py says of one contact after another, for all at once and to the same bits. Needs numpy.
States are rows x, y with the floor's zeros in the last column, where index j = -1 finds them.
"""

import operator
from functools import cache

import numpy as np


def few(row):
    """Whether balls are so few that plain floats over all pairs beat arrays over near pairs."""
    return len(row) <= 12


def with_floor(rows):
    """Rows (..., N) with a column of zeros added for the floor, (..., N + 1)."""
    return np.append(rows, np.zeros(rows.shape[:-1] + (1,)), -1)


@cache
def every_contact(count):
    """i, j (K,) of all contacts that `count` balls can have: the floor's (j = -1), then pairs i < j."""
    i, j = np.triu_indices(count, 1)
    return np.append(np.arange(count), i), np.append(np.full(count, -1), j)


def geometry(q, radius, i, j):
    """Normals n (..., 2, K) and depths (..., K) [m] of contacts i, j (K,).

    q (..., 2, N + 1), radius (N + 1,) [m]. The floor's normal is (0, 1), and so is that of two
    balls whose centres coincide.
    """
    d = q[..., i] - q[..., j]
    dx, dy = d[..., 0, :], d[..., 1, :]
    distance = np.where(j < 0, dy, np.sqrt(dx * dx + dy * dy))
    up = (j < 0) | ~(distance > 0.0)
    d /= np.where(up, 1.0, distance)[..., None, :]
    dx[up], dy[up] = 0.0, 1.0
    return d, radius[i] + radius[j] - distance


def along(rows, i, j, n):
    """n . (rows_i - rows_j) (K,) of rows (2, N + 1)."""
    return (n * (rows[:, i] - rows[:, j])).sum(0)


def delassus(i, j, n, w):
    """The Delassus matrix J M^-1 J' (K, K) of contacts i, j (K,), n (2, K); w (N + 1,) = 1 / mass.

    Two contacts act on each other through the bodies that they share; the floor's w is 0.
    """
    shared = [np.equal.outer(a, b) * w[a][:, None] for a, b in ((i, i), (j, j), (i, j), (j, i))]
    normals = np.multiply.outer(n[0], n[0]) + np.multiply.outer(n[1], n[1])
    return normals * (shared[0] + shared[1] - shared[2] - shared[3])


def pushed(rows, lam, i, j, n, w):
    """rows (2, N + 1) + M^-1 J' lam; what is left of rounding, 1e-13 of a body's share, becomes 0."""
    rows, size = rows.copy(), np.abs(rows).max(0)
    for body, push in ((i, lam * w[i]), (j, -lam * w[j])):
        np.add.at(size, body, np.abs(push))
        for row, part in zip(rows, n):
            np.add.at(row, body, push * part)
    return np.where(np.abs(rows) > 1e-13 * size, rows, 0.0)


def contact_arrays(q, radius, margin):
    """i, j (K,), n (2, K), depth (K,) of the contacts with depth > -margin [m]; q (2, N), radius (N,).

    The floor's by body, then pairs i < j in order. Pairs that cannot touch are not looked at.
    """
    i, j = near_pairs(*q, 2.0 * radius.max() + margin)
    i, j = np.append(np.arange(len(radius)), i), np.append(np.full(len(radius), -1), j)
    n, depth = geometry(with_floor(q), with_floor(radius), i, j)
    listed = np.flatnonzero(depth > -margin)
    place = np.where(j < 0, i - len(radius), i * len(radius) + j)[listed]   # floor's first, < 0
    listed = listed[np.argsort(place)]
    return i[listed], j[listed], n[:, listed], depth[listed]


def near_pairs(x, y, reach):
    """Index arrays i < j of all pairs closer than `reach` [m] and some others, in no set order.

    Balls are sorted into square cells of side `reach`, numbered along the rows. Partners are then in
    the same or the next cell, one run of the sorted list, or in three cells of the next row, another.
    Balls that are nowhere (NaN, infinity) touch nothing.
    """
    known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    x, y = x[known] - x[known].min(initial=np.inf), y[known] - y[known].min(initial=np.inf)
    side = max(reach, x.max(initial=0.0) / 2**30, y.max(initial=0.0) / 2**30)   # ids fit 64 bits
    side *= 1.0 + 1e-6                                      # room for the rounding of x, y and reach
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


def group_contacts(i, j, n, depth, bodies):
    """Contacts as tuples (i, j, nx, ny, depth) of arrays, groups that share no body.

    Solved group by group they give the bits of one by one in the order of the list. Where groups
    would be small (a tower is one long chain) single contacts are faster: those, then.
    """
    columns = i, j, *n, depth
    groups = independent_groups(i, j, bodies)
    if len(i) < 50 * len(groups):
        return list(zip(*(column.tolist() for column in columns)))
    return [tuple(column[group] for column in columns) for group in groups]


def independent_groups(i, j, bodies):
    """Contacts i, j (K,) in groups that share no body: sweeping group by group is sweeping in order.

    The group of a contact is one more than the largest group of an earlier contact that shares a
    body with it. The floor (j = -1) moves for no contact, so sharing it does not count. Returns one
    index array a group, each in the order of the list.
    """
    left, groups, first = np.arange(len(i)), [], np.empty(bodies + 1, int)
    while len(left):
        a, b = i[left], j[left]
        backwards = np.stack((a, b), 1)[::-1].ravel()       # of entries that repeat, the last stays:
        first[backwards] = np.repeat(left[::-1], 2)         # the earliest contact of every body
        ready = (first[a] == left) & ((b < 0) | (first[b] == left))
        groups.append(left[ready])
        left = left[~ready]
    return groups


def operations(contacts):
    """The four operations in which contacts of floats and groups of arrays differ.

    larger(a, b), choose(which, yes, no), moves(dlam): whether any of it is not 0, and row(values): a
    copy with a 0 for the floor at its end, where index -1 finds it.
    """
    return MANY if contacts and isinstance(contacts[0][0], np.ndarray) else ONE


def choose(which, yes, no):
    """np.where for floats."""
    return yes if which else no


def list_row(row):
    """with_floor as a list of floats."""
    return row + [0.0] if isinstance(row, list) else [*np.asarray(row).tolist(), 0.0]


def array_row(row):
    """with_floor as an array."""
    return with_floor(np.asarray(row))


ONE, MANY = (max, choose, operator.truth, list_row), (np.fmax, np.where, np.any, array_row)
# fmax meets NaN as Python's max(0.0, NaN) does: 0.0 stays


def advance(q, v, dt):
    """q + dt v, for pairs of rows: lists or arrays (N,)."""
    if isinstance(q[0], list):
        return [[a + dt * b for a, b in zip(q[0], v[0])], [a + dt * b for a, b in zip(q[1], v[1])]]
    return [row + dt * np.asarray(rate) for row, rate in zip(q, v)]


def fall(v, gravity, dt):
    """v after dt of gravity alone."""
    vx, vy = v
    if isinstance(vy, list):
        return [vx, [b + dt * gravity for b in vy]]
    return [vx, vy + dt * gravity]


def accelerate(v, gravity, force, mass, dt):
    """v + dt (gravity + force / mass), for pairs of rows."""
    (vx, vy), (fx, fy) = v, force
    if isinstance(vx, list):
        return [[a + dt * (f / m) for a, f, m in zip(vx, fx, mass)],
                [a + dt * (gravity + f / m) for a, f, m in zip(vy, fy, mass)]]
    return [vx + dt * (np.asarray(fx) / mass), vy + dt * (gravity + np.asarray(fy) / mass)]


def deepest(q, radius, margin):
    """The largest depth (...) [m] of states q (..., 2, N); -margin where no contact is within it."""
    if few(radius):
        n, depth = geometry(with_floor(q), with_floor(radius), *every_contact(len(radius)))
        return depth.max(-1, initial=-margin)
    if q.ndim > 2:
        return np.array([deepest(state, radius, margin) for state in q])
    return contact_arrays(q, radius, margin)[3].max(initial=-margin)


def energy_put_in(q, v, scene, dt_gravity, margin):
    """Energy [J] that contacts put INTO the bodies over the steps of states q, v (S, 2, N).

    In a step, a contact within `margin` [m] may leave with the scene's restitution times the speed it
    closed with (gravity's dt_gravity [m/s] included), or with the speed it parted at. Parting faster
    puts in m_eff / 2 times the excess of v_n^2, less what falling through the gap gives.
    """
    if few(scene.mass):
        i, j = every_contact(len(scene.mass))
    elif len(q) == 2:
        i, j = contact_arrays(q[0], scene.radius, margin)[:2]
    else:
        return sum(energy_put_in(q[k:k + 2], v[k:k + 2], scene, dt_gravity, margin)
                   for k in range(len(q) - 1))
    w, v = with_floor(1.0 / scene.mass), with_floor(v)
    n, depth = geometry(with_floor(q[:-1]), with_floor(scene.radius), i, j)
    v_n, parting = ((n * (rows[..., i] - rows[..., j])).sum(-2) for rows in (v[:-1], v[1:]))
    allowed = np.maximum(scene.restitution * (-v_n - dt_gravity * (j < 0)), v_n) ** 2
    fall = 2.0 * 9.81 * np.maximum(-depth, 0.0)
    excess = np.where((depth > -margin) & (parting > 0.0), parting ** 2 - allowed - fall, 0.0)
    return float((0.5 / (w[i] + w[j]) * np.maximum(excess, 0.0)).sum())
