"""The exact model: from event to event, with no time step (robotics course, chapter 3.5).

Balls over the line y = 0, frictionless. Between two events the set of pushing contacts stays the
same, and the motion is smooth. Where no ball slides along another it is a parabola in time; where
one does, the pushing contacts are equations, gap = 0, and the motion is a Taylor series in time.
An event is a gap that closes, a force that falls to zero, or a series that comes to its end. It
concerns the balls that touch one another there, an island; all other balls go on as they were.

    gather     finds the island, and which of its contacts touch,
    separate   closes what rounding has left of overlaps,
    collide    gives impulses to the contacts that close: an LCP of velocities,
    support    gives forces to the contacts that rest: an LCP of accelerations,
    expand     gives the motion under these forces: a parabola, or a series where balls slide,
    predict    finds the next event of every contact of the island.

Samples are read from the series, so when they are taken does not enter the motion.

    symbol   meaning                                          unit
    q, v, a  positions, velocities, accelerations             m, m/s, m/s^2; rows x, y: (2, N + 1)
    w        1 / mass; 0 for the floor and for a fixed ball   1/kg
    i, j     the balls of a contact; the floor is ball -1, the last column
    n        unit normal of a contact, from j to i
    gap      distance of the surfaces; depth = -gap           m
    v_n      n . (v_i - v_j), > 0 separating                  m/s
    lam      impulse or force of a contact, >= 0              N s or N
    J, M     J v is v_n of every contact, M the masses, so W = J M^-1 J' (Delassus)
    s        in an LCP, s = W lam + b >= 0: the normal speed or acceleration that is left

Why every loop ends. The pivot (solve_lcp), the separation of overlaps and the search for a root
(first_fall) count their steps and stop. Events have no such bound of their own, since bounces can
follow one another ever faster. A bounce that rises less than LAST radii is the last of its series,
and so is one of a contact that opened less than TOUCH radii since the bounce before: a light ball
between a heavy one and the floor is struck infinitely often in finite time, and the limit is rest.
The clock ends what is left: after EVENTS events per ball (and 20 times EVENTS at least) within a
tick of motion, events come at most once in a hundredth of a tick, so a hundred more take the clock
to the next tick. That is a limit of run time: what closes in the meantime overlaps, and is moved
apart when its turn comes.
"""

# --- region: exact-setup ---
import math
from typing import NamedTuple

import numpy as np

ORDER = 14      # of the Taylor series in time
TOUCH = 1e-12   # of a radius: a smaller gap is none
LAST = 1e-13    # of a radius: a bounce that rises less is the last of its series
NOISE = 1e-13   # of sqrt(g r): a smaller speed is round-off
GRAZE = 1e-12   # of g: a contact that pushes its bodies apart with less does not push
EVENTS = 100    # per ball and tick, and of 20 balls at least, before the clock waits
TICK = 0.1      # of sqrt(r / g), r the smallest radius
BINOMIAL = np.array([[math.comb(m, k) for m in range(ORDER + 1)] for k in range(ORDER + 1)])


class System(NamedTuple):
    """What stays the same during a run; the floor is the last of N + 1 bodies."""

    w: np.ndarray       # (N + 1,) 1 / mass [1/kg]
    radius: np.ndarray  # (N + 1,) [m]
    restitution: float
    gravity: float      # [m/s^2] along y, negative
    i: np.ndarray       # (K,) of all contacts that can be: the floor's first, then pairs i < j
    j: np.ndarray

    def contacts(self, q, which=slice(None)):
        """The Contacts `which` (an index array or a mask) in the positions q (2, N + 1)."""
        i, j = self.i[which], self.j[which]
        d = q[:, i] - q[:, j]
        distance = np.where(j < 0, d[1], np.sqrt(d[0] * d[0] + d[1] * d[1]))
        up = (j < 0) | ~(distance > 0.0)        # two balls with one centre: some normal is needed
        d /= np.where(up, 1.0, distance)
        d[:, up] = [[0.0], [1.0]]
        speed = np.sqrt(-self.gravity * self.radius[i])
        return Contacts(self.w, i, j, d, self.radius[i] + self.radius[j] - distance, speed)


def build_system(scene, gravity):
    """The System of a scene. Two bodies that nothing moves have no contact."""
    count = len(scene.mass)
    w, radius = np.append(1.0 / scene.mass, 0.0), np.append(scene.radius, 0.0)
    i, j = np.triu_indices(count, 1)
    i, j = np.append(np.arange(count), i), np.append(np.full(count, -1), j)
    moves = w[i] + w[j] > 0.0
    return System(w, radius, scene.restitution, gravity, i[moves], j[moves])
# --- endregion ---


# --- region: exact-contacts ---
class Contacts(NamedTuple):
    """Some contacts in one set of positions: i, j, depth (K,), normals n (2, K)."""

    w: np.ndarray
    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    depth: np.ndarray
    speed: np.ndarray   # sqrt(g r) (K,) [m/s]: what a ball gains as it falls half a radius

    def only(self, which):
        """These of the contacts."""
        return Contacts(self.w, self.i[which], self.j[which], self.n[:, which], self.depth[which],
                        self.speed[which])

    def along(self, rows, n=None):
        """n . (rows_i - rows_j) (K,) of rows (2, N + 1): with v, the normal velocity v_n."""
        return ((self.n if n is None else n) * (rows[:, self.i] - rows[:, self.j])).sum(0)

    def tangents(self):
        """Unit tangents (2, K); 0 for the floor, whose normal never turns."""
        return np.array((-self.n[1], self.n[0])) * (self.j >= 0)

    def delassus(self):
        """J M^-1 J' (K, K): how far a unit impulse at one contact changes v_n at another."""
        i, j, w = self.i, self.j, self.w
        shared = [np.equal.outer(a, b) * w[a][:, None] for a, b in ((i, i), (j, j), (i, j), (j, i))]
        normals = np.multiply.outer(self.n[0], self.n[0]) + np.multiply.outer(self.n[1], self.n[1])
        return normals * (shared[0] + shared[1] - shared[2] - shared[3])

    def pushed(self, rows, lam):
        """rows + M^-1 J' lam; round-off below 1e-13 of a body's share is set to zero."""
        rows, size = rows.copy(), np.abs(rows).max(0)
        for body, push in ((self.i, lam * self.w[self.i]), (self.j, -lam * self.w[self.j])):
            np.add.at(size, body, np.abs(push))
            for row, part in zip(rows, self.n):
                np.add.at(row, body, push * part)
        return np.where(np.abs(rows) > 1e-13 * size, rows, 0.0)

    def spread(self, force):
        """M^-1 (2, N + 1) of forces (2, K) on the bodies i, and their opposites on j."""
        body, count = np.append(self.i, self.j % len(self.w)), len(self.w)
        return np.array([np.bincount(body, np.append(f, -f), count) for f in force]) * self.w

    def corrected(self, rows, error):
        """rows changed by the one set of pushes that takes `error` (K,) from n . rows."""
        if not error.any():
            return rows
        return rows - self.spread(self.n * applied(inverted(self.delassus()), error))
# --- endregion ---


# --- region: exact-pivot ---
class Table:
    """s = W lam + b, solved for lam of the active contacts and for s of the others.

    rows (K, K + 1): column K is what the left-hand sides are while the right-hand ones are 0.
    """

    def __init__(self, problem, wanted):
        """Activate those of `wanted`, largest diagonal first, but none that depends on others."""
        self.rows, self.active, left = problem.copy(), np.zeros(len(problem), bool), wanted.copy()
        while (diagonal := self.rows[:, :-1].diagonal() * left).max() > 1e-12:
            left[k := diagonal.argmax()] = False
            self.exchange(k)

    def exchange(self, k):
        """Let lam_k and s_k change sides."""
        rows = self.rows
        row, column, pivot = rows[k] / -rows[k, k], rows[:, k].copy(), rows[k, k]
        rows += column[:, None] * row
        rows[:, k], rows[k], rows[k, k] = column / pivot, row, 1.0 / pivot
        self.active[k] = ~self.active[k]

    def step(self, lam, least):
        """Exchange one contact: the next lam, and whether it is the answer (nothing exchanged)."""
        trial = np.where(self.active, self.rows[:, -1], 0.0)
        bad = np.flatnonzero(trial < least)
        if len(bad):                            # towards trial until the first would pull
            share = lam[bad] / (lam[bad] - trial[bad])
            lam = np.where(self.active, lam + share.min() * (trial - lam), 0.0)
            self.exchange(bad[share.argmin()])
            return lam, False
        s = np.where(self.active, 0.0, self.rows[:, -1])
        k = s.argmin()                          # closes fastest: it is to push
        if s[k] >= least:
            return trial, True
        if self.rows[k, k] < 1e-12:             # it depends on others: one of those stops
            column = np.where(self.active, self.rows[:, k], 0.0)
            fall = np.flatnonzero(column < -1e-9)
            if not len(fall):
                return trial, True              # s_k < 0 is round-off
            share = trial[fall] / -column[fall]
            trial = trial + share.min() * column
            trial[k] = share.min()
            self.exchange(fall[share.argmin()])
        self.exchange(k)
        return trial, False
# --- endregion ---


# --- region: exact-lcp ---
def solve_lcp(W, b):
    """lam (K,) >= 0 with s = W lam + b >= 0 and lam s = 0; W (K, K) the Delassus matrix, b (K,).

    Pivoting after Lawson and Hanson (1974), from all contacts active, as at rest. With each
    exchange lam'W lam / 2 + b'lam falls, so no active set comes twice. Rounding can break that, so
    exchanges are counted; and the table is made afresh until it needs no more, at most nine times.
    """
    if len(b) < 2:
        return np.maximum(-b / W.diagonal(), 0.0)
    scale = np.ldexp(1.0, -np.frexp(W.diagonal())[1] // 2)  # diagonal near 1: one tolerance for all
    problem = np.column_stack((W * scale * scale[:, None], b * scale))
    least = -1e-13 * np.abs(problem[:, -1]).max()
    active, lam = scale > 0.0, np.zeros(len(b))
    for _ in range(9):
        table = Table(problem, active)
        for exchanges in range(50 + 10 * len(b)):
            lam, done = table.step(lam, least)
            if done:
                break
        active = table.active
        if exchanges == 0 or not done:
            break
    return np.maximum(lam, 0.0) * scale


def react(contacts, rows, b):
    """rows + M^-1 J' lam and lam, for the least pushes after which n . rows + b >= 0."""
    lam = solve_lcp(contacts.delassus(), b)
    return contacts.pushed(rows, lam), lam


def inverted(W):
    """The inverse of a positive definite W. Blocks that do not act on each other stay apart."""
    W = W.copy()
    for k in range(len(W)):
        row, column, pivot = W[k] / -W[k, k], W[:, k].copy(), W[k, k]
        W += column[:, None] * row
        W[:, k], W[k], W[k, k] = column / pivot, row, 1.0 / pivot
    return W


def applied(matrix, b):
    """matrix b, summed by numpy itself: `@` adds up in another order on another machine."""
    return (matrix * b).sum(1)
# --- endregion ---


# --- region: exact-island ---
def island(system, i, j, woken):
    """The balls that hang together with those `woken` through contacts i, j: masks (N + 1,).

    What nothing moves, as the floor, passes nothing on and belongs to no island.
    """
    partners = [[] for _ in woken]
    passes = (system.w[i] > 0.0) & (system.w[j] > 0.0)
    for a, b in zip(i[passes].tolist(), j[passes].tolist()):
        partners[a].append(b)
        partners[b].append(a)
    found, left = np.zeros(len(woken), bool), np.flatnonzero(woken & (system.w > 0.0)).tolist()
    while left:
        ball = left.pop()
        if not found[ball]:
            found[ball] = True
            left += partners[ball]
    return found


def separate(system, q, which, small):
    """q without overlaps of more than `small` (K,) [m] at the contacts `which`, a mask.

    Overlaps close as velocities do in an impact: by pushes, so that heavy balls move less. A gap
    twice as wide as the deepest overlap may close on the way, but not more.
    """
    for _ in range(50):
        contacts = system.contacts(q, which)
        if not (contacts.depth > small).any():
            break
        contacts = contacts.only(contacts.depth >= -2.0 * contacts.depth.max())
        q, _ = react(contacts, q, -contacts.depth)
    return q
# --- endregion ---


# --- region: exact-collide ---
def collide(system, contacts, v, thin):
    """v after the impulses of the contacts that close: v_n becomes -e v_n where they push.

    The contacts touch. Those `thin` (K,), and those whose bounce is slow, end their series here.
    """
    v_n, noise = contacts.along(v), NOISE * contacts.speed
    if not (v_n < -noise).any():
        return v
    bounce = -system.restitution * v_n
    bounce = np.where((np.abs(bounce) < slow(contacts)) | thin, 0.0, bounce)
    v, lam = react(contacts, v, v_n - bounce)
    struck, bounce, noise = contacts.only(lam > 0.0), bounce[lam > 0.0], noise[lam > 0.0]
    for _ in range(3):                          # unequal masses: once more, for the last digits
        error = struck.along(v) - bounce
        if not (np.abs(error) > noise).any():
            break
        v = struck.corrected(v, error)
    return v


def slow(contacts):
    """The speed [m/s] (K,) of a bounce that rises LAST radii."""
    return math.sqrt(2.0 * LAST) * contacts.speed
# --- endregion ---


# --- region: exact-support ---
def support(system, contacts, v):
    """v and accelerations a (2, N + 1); which of the contacts rest, and which of those push (K,).

    The bodies of a resting contact do not part: n . a plus what the turning normal asks, slip^2
    over the distance of the centres, is at least 0.
    """
    a = np.array([[0.0], [system.gravity]]) * (system.w > 0.0)
    rests = np.abs(contacts.along(v)) < slow(contacts)
    pushes = rests.copy()
    if not rests.any():
        return v, a, rests, pushes
    contacts = contacts.only(rests)
    slip = contacts.along(v, contacts.tangents())
    turn = slip * slip / (system.radius[contacts.i] + system.radius[contacts.j])
    a, lam = react(contacts, a, contacts.along(a) + turn)
    loaded = lam * (system.w[contacts.i] + system.w[contacts.j]) > grazing(system)
    pushes[rests] = loaded
    held = contacts.only(loaded)
    v = held.corrected(v, held.along(v))        # round-off, or the last of a series of bounces
    return v, held.corrected(a, held.along(a) + turn[loaded]), rests, pushes


def grazing(system):
    """The acceleration [m/s^2] that a contact gives to its bodies at least if it pushes."""
    return -GRAZE * system.gravity
# --- endregion ---


# --- region: exact-slide ---
def slide(system, held, q, v):
    """While the K contacts push: the series Q (ORDER + 1, 2, N + 1) of q and lam (ORDER - 1, K).

    q'' = g + M^-1 J' lam with n = (q_i - q_j) / (r_i + r_j), a series too. n . n = 1 gives for each
    order of lam a linear system, always with the Delassus matrix.
    """
    inverse, pair = inverted(held.delassus()), held.j >= 0
    reach = system.radius[held.i] + system.radius[held.j]
    Q, lam = np.zeros((ORDER + 1, *q.shape)), np.zeros((ORDER - 1, len(pair)))
    n = np.zeros((ORDER + 1, *held.n.shape))
    Q[0] = q + held.spread(held.n * applied(inverse, held.depth))   # gap = 0; below, v_n = 0
    n[0] = np.where(pair, (Q[0][:, held.i] - Q[0][:, held.j]) / reach, held.n)
    Q[1] = v - held.spread(n[0] * applied(inverse, held.along(v, n[0])))
    for k in range(ORDER - 1):
        n[k + 1] = (Q[k + 1][:, held.i] - Q[k + 1][:, held.j]) / reach * pair
        a = held.spread((lam[:k, None] * n[k:0:-1]).sum(0))     # of the orders that are known
        a[1] += system.gravity * (system.w > 0.0) * (k == 0)
        turn = 0.5 * reach * (n[1:k + 2] * n[k + 1:0:-1]).sum((0, 1))
        lam[k] = -applied(inverse, held.along(a, n[0]) + (k + 1) * (k + 2) * turn)
        Q[k + 2] = (a + held.spread(lam[k] * n[0])) / ((k + 1) * (k + 2))
    return Q, lam


def expand(system, held, q, v, a):
    """The series Q (M, 2, N + 1) of q, those of the forces (5 or more, K), and how long they last.

    A parabola, forces that do not change, and for ever, where no held contact slides. Elsewhere a
    power of 2 [s], in which the last two terms of Q stay below 2^-54 r.
    """
    tangents = held.tangents()
    if not (held.along(v, tangents).any() or held.along(a, tangents).any()):
        return np.array((q, v, 0.5 * a)), np.ones((5, len(held.i))), np.inf
    Q, lam = slide(system, held, q, v)
    # first_fall needs a start above 0: a force that begins at 0 ends once it has fallen by a graze
    lam[0] = np.maximum(lam[0], 0.0) + grazing(system) / (system.w[held.i] + system.w[held.j])
    size = (np.abs(Q[-2:, :, :-1]) / system.radius[:-1]).max((1, 2))
    power = ((-54 - np.frexp(size)[1]) // (ORDER - 1, ORDER)).min()     # size t^order < 2^-54
    return Q, lam, math.ldexp(1.0, int(power))
# --- endregion ---


# --- region: exact-series ---
def evaluate(p, t):
    """sum p[k] t^k by Horner's rule."""
    total = p[-1]
    for row in p[-2::-1]:
        total = total * t + row
    return total


def rate(p):
    """The series of the derivative."""
    return np.arange(1, len(p)).reshape(-1, *[1] * (p.ndim - 1)) * p[1:]


def shifted(Q, s):
    """The series Q (M, 2, N + 1) written about a time s (N + 1,) later, by the binomial theorem."""
    if len(Q) == 3:
        return np.array((Q[0] + s * (Q[1] + s * Q[2]), Q[1] + 2.0 * s * Q[2], Q[2]))
    k = np.arange(len(Q))
    power = s ** np.maximum(k - k[:, None], 0)[..., None]       # s^(m - k)
    return np.einsum("kmb,mcb->kcb", BINOMIAL[..., None] * power, Q)


def gap_series(system, Q, gap, which):
    """Series (5 or more, K) with the signs of the gaps `which`, which are gap (K,) at t = 0:
    y_i - r_i for the floor's, and |q_i - q_j|^2 - (r_i + r_j)^2 for pairs."""
    i, j = system.i[which], system.j[which]
    d, pair = Q[:, :, i] - Q[:, :, j], j >= 0
    p = np.concatenate((d[:, 1], np.zeros((max(0, 5 - len(Q)), len(i)))))
    d = d[:, :, pair]
    for k in range(1, len(p)):
        low, half = max(0, k - len(d) + 1), (k + 1) // 2
        square = 2.0 * (d[low:half] * d[k - half + 1:k - low + 1][::-1]).sum(0)
        p[k, pair] = (square + d[half] * d[half] if k % 2 == 0 else square).sum(0)
    p[0] = gap * np.where(pair, gap + 2.0 * (system.radius[i] + system.radius[j]), 1.0)
    return p
# --- endregion ---


# --- region: exact-next ---
def first_fall(p, horizon):
    """First t in [0, horizon] at which each sum p[k] t^k falls through zero; inf if it does not.

    p (5 or more, K) with p[0] >= 0, horizon (K,). Newton's method made safe: with the least
    curvature up to the horizon no step passes a root, and a parabola takes one step. An answer is
    good to 1e-15 of itself, or early where 200 steps of next to no curvature did not get there.
    """
    slopes, bends = rate(p), 0.5 * rate(rate(p))
    t, curved, bend = np.zeros(p.shape[1]), (p[3:] != 0.0).any(0), p[2]
    value, slope, left, moving = p[0], p[1], 200, np.ones(p.shape[1], bool)
    while left:
        if curved.any():
            bend = lower_bound(bends, t, horizon)
            value, slope = np.maximum(evaluate(p, t), 0.0), evaluate(slopes, t)
        root = np.sqrt(slope * slope - 4.0 * value * bend)      # NaN: no root
        step = np.where(slope < 0.0, 2.0 * value / (root - slope),
                        np.where(bend < 0.0, (slope + root) / (-2.0 * bend), np.inf))
        t = np.where(moving, np.where(t + step <= horizon, t + step, np.inf), t)
        moving &= curved & (step > 1e-15 * t)                   # the others have arrived
        left = left - 1 if moving.any() else 0
    return t


def lower_bound(p, t, horizon):
    """No sum p[k] s^k is less while t <= s <= horizon; exact for parabolas, p (3 or more, K)."""
    vertex = np.where(p[2] > 0.0, np.clip(-p[1] / (2.0 * p[2]), t, horizon), t)
    least = np.fmin.reduce([evaluate(p[:3], s) for s in (t, vertex, horizon)])
    curved = (p[3:] != 0.0).any(0)
    if not curved.any():
        return least
    return np.where(curved, least - evaluate(np.abs(p[3:]), horizon) * horizon**3, least)
# --- endregion ---


# --- region: exact-motion ---
class Motion:
    """What the balls do until their next events: (N + 1,) of bodies and (K,) of contacts."""

    def __init__(self, system, scene):
        bodies, contacts = len(system.w), len(system.i)
        self.system = system
        self.series = np.zeros((ORDER + 1, 2, bodies))          # of every body's position
        self.series[0, :, :-1], self.series[1, :, :-1] = scene.q0, scene.v0
        self.start = np.zeros(bodies)                           # the time [s] it starts from
        self.until = np.where(system.w > 0.0, 0.0, np.inf)      # the time [s] it holds until
        self.due = np.full(contacts, np.inf)                    # when it closes, or stops pushing
        self.pushes = np.zeros(contacts, bool)
        self.rests = np.ones(contacts, bool)                    # it did not part when it touched
        self.last_touch = np.full(contacts, -np.inf)            # when it touched last [s]
        self.parting = np.zeros(contacts)                       # |v_n| it parted with then [m/s]
        self.thin = np.full(contacts, -np.inf)                  # when it closed, hardly opened

    def rows(self):
        """The series, without the orders that are 0 while no ball slides."""
        return self.series if np.isfinite(self.until).any() else self.series[:3]

    def at(self, time):
        """q, v (..., 2, N + 1) at a time [s] or at times (S, 1, 1)."""
        s, rows = time - self.start, self.rows()
        return evaluate(rows, s), evaluate(rate(rows), s)

    def next(self):
        """The time [s] of the next event."""
        return min(self.due.min(initial=np.inf), self.until.min())

    def opened(self, now, which, v_n):
        """A bound [m] (K,) of how far the contacts were open since they touched last."""
        return (self.parting[which] + np.abs(v_n)) * (now - self.last_touch[which])

    def go_on(self, now, balls, Q, until):
        """From now on the balls (a mask) move by the series Q, trusted until that time."""
        self.series[:, :, balls] = 0.0
        self.series[:len(Q), :, balls] = Q[:, :, balls]
        self.start[balls], self.until[balls] = now, until

    def concerns(self, balls):
        """The contacts (K,) that have one of the balls: masks."""
        return balls[self.system.i] | balls[self.system.j]

    def remember(self, now, balls, touch, contacts, v_n, rests, pushes):
        """How the contacts of the balls (a mask) are left; those of index `touch` touch."""
        mine = self.concerns(balls)
        self.rests[mine] = self.pushes[mine] = False
        self.due[mine] = np.inf
        struck = v_n < -NOISE * contacts.speed      # closing still: it is due again at once
        self.last_touch[touch], self.parting[touch] = now, np.where(struck, np.inf, np.abs(v_n))
        self.rests[touch], self.pushes[touch] = rests, pushes
# --- endregion ---


# --- region: exact-touch ---
def gather(motion, now, q, v):
    """q without overlaps, the mask of the island's balls, what touches in it: index and Contacts.

    A gap below TOUCH radii touches. But where a contact has hardly been wider open since it
    touched last, as under a light ball that rattles between two others, only a gap below a ten
    thousandth of that does.
    """
    system = motion.system
    bits = 4.0 * np.spacing(np.abs(q).max(0))
    bits = np.maximum(bits[system.i], bits[system.j])
    small = bits + TOUCH * system.radius[system.i]
    contacts, late = system.contacts(q), motion.due <= now
    near = np.flatnonzero((contacts.depth >= -small) | late)
    woken = motion.until <= now
    woken[system.i[late]] = woken[system.j[late]] = True
    balls = island(system, system.i[near], system.j[near], woken)
    mine = motion.concerns(balls)
    if (contacts.depth[mine] > small[mine]).any():
        q = separate(system, q, mine, small[mine])
        contacts = system.contacts(q)
    near = np.flatnonzero(mine & ((contacts.depth >= -small) | late))
    opened = motion.opened(now, near, contacts.only(near).along(v))
    tie = bits[near] + np.fmin(TOUCH * system.radius[system.i[near]], 1e-4 * opened)
    touch = near[motion.rests[near] | late[near] | (-contacts.depth[near] <= tie)]
    return q, balls, touch, contacts.only(touch)


def hardly_opened(motion, now, touch, contacts, v):
    """Which of the contacts `touch` close although they have opened less than TOUCH radii.

    Bounces so small come from a cascade that is infinite: the limit is rest. Once it has stopped at
    one contact, it stops at all that were open just then, if by less than 1000 TOUCH radii.
    """
    v_n = contacts.along(v)
    cascade = motion.thin[touch].max(initial=-np.inf) > motion.last_touch[touch]
    widest = np.where(cascade, 1000.0 * TOUCH, TOUCH) * motion.system.radius[contacts.i]
    thin = (v_n < -NOISE * contacts.speed) & (motion.opened(now, touch, v_n) < widest)
    motion.thin[touch[thin]] = now
    return thin
# --- endregion ---


# --- region: exact-event ---
def event(motion, now):
    """Settle the island in which something falls due by the time `now`, and send it on its way."""
    system, (q, v) = motion.system, motion.at(now)
    q, balls, touch, contacts = gather(motion, now, q, v)
    v = collide(system, contacts, v, hardly_opened(motion, now, touch, contacts, v))
    v, a, rests, pushes = support(system, contacts, v)
    motion.remember(now, balls, touch, contacts, contacts.along(v), rests, pushes)
    held = contacts.only(pushes)
    Q, force, span = expand(system, held, q, v, a)
    motion.go_on(now, balls, Q, now + span)
    if span < np.inf:
        motion.due[touch[pushes]] = now + first_fall(force, np.full(len(held.i), span))
    predict(motion, now, balls)


def predict(motion, now, balls):
    """Find when the contacts of the balls (a mask), which have new series, will close.

    Those at rest count as 3 TOUCH radii open, so that round-off is no event. Those too far apart
    to meet before the series of the island ends are left out.
    """
    system, Q = motion.system, shifted(motion.rows(), now - motion.start)
    which = np.flatnonzero(motion.concerns(balls) & ~motion.pushes)
    contacts = system.contacts(Q[0], which)
    gap = np.maximum(-contacts.depth, 0.0)
    gap += 3.0 * TOUCH * system.radius[contacts.i] * motion.rests[which]
    span = motion.until[balls].min(initial=np.inf) - now
    if span < np.inf:
        travel = span * evaluate(np.abs(Q[1:]), span).sum(0)
        meets = gap <= travel[contacts.i] + travel[contacts.j]
        which, gap = which[meets], gap[meets]
    horizon = np.minimum(motion.until[system.i[which]], motion.until[system.j[which]]) - now
    motion.due[which] = now + first_fall(gap_series(system, Q, gap, which), horizon)
# --- endregion ---


# --- region: exact-run ---
@np.errstate(all="ignore")
def simulate_exact(scene, times, gravity, report=lambda k: None):
    """q, v (S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, from event to event.

    The scene has q0, v0 (2, N), mass (inf: a fixed ball), radius (N,) and restitution; gravity
    [m/s^2] is along y, negative. report(k) is called after each event with the samples done.
    """
    motion = Motion(build_system(scene, gravity), scene)
    out = np.empty((2, len(times), 2, len(scene.mass) + 1))
    tick = TICK * math.sqrt(scene.radius.min() / -gravity)
    now, done, events, until = 0.0, 0, 0, tick
    event(motion, now)
    while done < len(times):
        soon = max(now, motion.next())
        if events > EVENTS * max(20, len(scene.mass)):
            soon = max(soon, now + 0.01 * tick)
        upto = int(np.searchsorted(times, soon, "right"))
        if upto > done:
            out[:, done:upto] = motion.at(times[done:upto, None, None])
        now, done, events = soon, upto, events + 1
        if done < len(times):
            event(motion, now)
        if now >= until:
            events, until = 0, now + tick
        report(done)
    return out[0, ..., :-1], out[1, ..., :-1]
# --- endregion ---
