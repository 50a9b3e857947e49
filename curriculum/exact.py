"""The exact model: from event to event, with no time step (robotics course, chapter 3.5).

Balls over the line y = 0, frictionless. Between two events the set of pushing contacts stays the
same, and the motion is smooth. Where no ball slides along another it is a parabola in time; where
one does, the pushing contacts are equations, gap = 0, and the motion is a Taylor series of order 14.
An event is a gap that closes or a force that falls to zero. At an event

    separate   closes what rounding has left of overlaps,
    collide    gives impulses to the contacts that close: an LCP of velocities,
    support    gives forces to the contacts that rest: an LCP of accelerations.

Samples are read from the series, so when they are taken does not enter the motion.

    symbol   meaning                                       unit
    q, v, a  positions, velocities, accelerations          m, m/s, m/s^2   rows x, y: (2, N + 1)
    w        1 / mass; 0 for the floor and for a fixed ball  1/kg
    i, j     balls of a contact; the floor is the last column, j = -1
    n        unit normal of a contact, from j to i         -
    depth    -gap, > 0 overlapping                         m
    lam      impulse or force of a contact, >= 0           N s or N

Why every loop ends. The pivot (solve_lcp) and the search for a root (first_fall) count their steps
and stop. The events have no such bound of their own: bounces can follow one another ever faster.
A bounce that would rise less than LAST r is the last of its series, which ends the usual ones. The
clock ends the others: after EVENTS events per ball within TICK seconds of motion every further
event of that tick waits until the hundredth part of a tick has passed. That is a limit of run time:
what closes in the meantime overlaps and is moved apart again.
"""

# --- region: exact-setup ---
import math
from typing import NamedTuple

import numpy as np

ORDER = 14      # of the Taylor series in time
TOUCH = 1e-12   # of a radius: a smaller gap is none
LAST = 1e-15    # of a radius: a bounce that rises less is the last of its series
GRAZE = 1e-12   # of the weight of a contact's effective mass: a smaller force is none
EVENTS = 1000   # per ball and tick, before the clock waits
TICK = 0.1      # of sqrt(r / g), r the smallest radius


class System(NamedTuple):
    """What stays the same during a run; the floor is the last column."""

    w: np.ndarray       # (N + 1,) 1 / mass [1/kg]
    radius: np.ndarray  # (N + 1,) [m]
    restitution: float
    gravity: float      # [m/s^2] along y, negative
    i: np.ndarray       # (K,) of all contacts that can be: the floor's first, then pairs i < j
    j: np.ndarray

    def contacts(self, q, which):
        """The Contacts `which` (an index array or mask) of all in the positions q (2, N + 1)."""
        i, j = self.i[which], self.j[which]
        d = q[:, i] - q[:, j]
        distance = np.where(j < 0, d[1], np.sqrt(d[0] * d[0] + d[1] * d[1]))
        up = (j < 0) | ~(distance > 0.0)        # two balls with one centre: some normal is needed
        d /= np.where(up, 1.0, distance)
        d[:, up] = [[0.0], [1.0]]
        return Contacts(self.w, i, j, d, self.radius[i] + self.radius[j] - distance)


def build_system(scene, gravity):
    """The System of a scene. Two bodies that nothing moves have no contact."""
    w, radius = np.append(1.0 / scene.mass, 0.0), np.append(scene.radius, 0.0)
    i, j = np.triu_indices(len(scene.mass), 1)
    i, j = np.append(np.arange(len(scene.mass)), i), np.append(np.full(len(scene.mass), -1), j)
    moves = w[i] + w[j] > 0.0
    return System(w, radius, scene.restitution, gravity, i[moves], j[moves])
# --- endregion ---


# --- region: exact-contacts ---
class Contacts(NamedTuple):
    """Some contacts in the same positions: i, j (K,), normals n (2, K), depth (K,) [m]."""

    w: np.ndarray
    i: np.ndarray
    j: np.ndarray
    n: np.ndarray
    depth: np.ndarray

    def only(self, which):
        """These of the contacts."""
        return Contacts(self.w, self.i[which], self.j[which], self.n[:, which], self.depth[which])

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
# --- endregion ---


# --- region: exact-pivot ---
class Table:
    """w = W lam + b, solved for lam of the active contacts and for w of the others.

    rows (K, K + 1): column K is what the left-hand sides are while the right-hand ones are 0.
    """

    def __init__(self, problem, wanted):
        """The active ones of `wanted`, largest diagonal first; what hangs on the others is not."""
        self.rows, self.active, left = problem.copy(), np.zeros(len(problem), bool), wanted.copy()
        while (diagonal := self.rows[:, :-1].diagonal() * left).max() > 1e-12:
            left[k := diagonal.argmax()] = False
            self.exchange(k)

    def exchange(self, k):
        """lam_k and w_k change sides."""
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
        w = np.where(self.active, 0.0, self.rows[:, -1])
        k = w.argmin()                          # closes fastest: it is to push
        if w[k] >= least:
            return trial, True
        if self.rows[k, k] < 1e-12:             # it hangs on the others: one of them stops
            column = np.where(self.active, self.rows[:, k], 0.0)
            fall = np.flatnonzero(column < -1e-9)
            if not len(fall):
                return trial, True              # w_k < 0 is round-off
            share = trial[fall] / -column[fall]
            trial = trial + share.min() * column
            trial[k] = share.min()
            self.exchange(fall[share.argmin()])
        self.exchange(k)
        return trial, False
# --- endregion ---


# --- region: exact-lcp ---
def solve_lcp(W, b):
    """lam (K,) >= 0 with w = W lam + b >= 0 and lam w = 0; W (K, K) the Delassus matrix, b (K,).

    Pivoting after Lawson and Hanson (1974), from all contacts active, as at rest. With each exchange
    lam'W lam / 2 + b'lam falls, so no active set comes twice. Rounding can break that, so the
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
        if exchanges == 0:
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
# --- endregion ---


# --- region: exact-settle ---
class Instant(NamedTuple):
    """After an event: q, v, a (2, N + 1); gap (K,) [m]; which contacts push; whether they slide."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    gap: np.ndarray
    pushes: np.ndarray
    slides: bool


def settle(system, q, v):
    """The Instant after an event in the positions q and velocities v."""
    q, near, contacts, gap = separate(system, q)
    v = collide(system, contacts, v)
    a, rests, pushes, slides = support(system, contacts, v)
    gap[near[rests]] += 3.0 * TOUCH * system.radius[contacts.i[rests]]  # round-off makes no event
    active = np.zeros(len(gap), bool)
    active[near[pushes]] = True
    return Instant(q, v, a, gap, active, slides)


def separate(system, q):
    """q without overlaps; the index and the Contacts of those that touch; all gaps (K,) [m].

    A gap within TOUCH radii, or within the last bits of the positions, touches.
    """
    last = np.spacing(np.abs(q).max(0))
    small = TOUCH * system.radius[system.i] + 4.0 * np.maximum(last[system.i], last[system.j])
    for _ in range(50):
        depth = system.contacts(q, slice(None)).depth
        near = np.flatnonzero(depth >= -small)
        contacts = system.contacts(q, near)
        if not (depth > small).any():
            break
        q, _ = react(contacts, q, -contacts.depth)
    return q, near, contacts, np.maximum(-depth, 0.0)


def slow(system, contacts):
    """The speed [m/s] (K,) whose bounce rises LAST radii."""
    return np.sqrt(-2.0 * system.gravity * LAST * system.radius[contacts.i])


def collide(system, contacts, v):
    """v after the impulses of the contacts that close: v_n becomes -e v_n where they push."""
    v_n = contacts.along(v)
    if not (v_n < -0.1 * TOUCH).any():          # [m/s] round-off of earlier impulses
        return v
    bounce = -system.restitution * v_n
    bounce = np.where(np.abs(bounce) < slow(system, contacts), 0.0, bounce)
    return react(contacts, v, v_n - bounce)[0]
# --- endregion ---


# --- region: exact-support ---
def support(system, contacts, v):
    """Accelerations a (2, N + 1), which of the contacts rest, which push, and whether any slides.

    The bodies of a resting contact do not part: n . a plus what the turning normal asks, slip^2 over
    the distance of the centres, is at least 0. A contact slides if its normal turns.
    """
    a = np.array([[0.0], [system.gravity]]) * (system.w > 0.0)
    rests = np.flatnonzero(np.abs(contacts.along(v)) < slow(system, contacts))
    if not len(rests):
        return a, rests, rests, False
    contacts = contacts.only(rests)
    i, j = contacts.i, contacts.j
    slip = contacts.along(v, contacts.tangents())
    turn = slip * slip / (system.radius[i] + system.radius[j])
    a, lam = react(contacts, a, contacts.along(a) + turn)
    pushes = lam * (system.w[i] + system.w[j]) > -GRAZE * system.gravity
    slides = (slip != 0.0) | (contacts.along(a, contacts.tangents()) != 0.0)
    return a, rests, rests[pushes], (pushes & slides).any()
# --- endregion ---


# --- region: exact-slide ---
def project(held, q, v, inverse):
    """q and v with gap = 0 and v_n = 0 at the contacts `held`: round-off of the step before."""
    q = q + spread(held, held.n * (inverse @ held.depth))
    return q, v - spread(held, held.n * (inverse @ held.along(v)))


def spread(held, force):
    """M^-1 (2, N + 1) of the forces (2, K) on the bodies i, and their opposites on j."""
    body, count = np.append(held.i, held.j % len(held.w)), len(held.w)
    return np.array([np.bincount(body, np.append(f, -f), count) for f in force]) * held.w


def slide(system, held, q, v):
    """The series Q (ORDER + 1, 2, N + 1) of q and lam (ORDER - 1, K) while the K contacts push.

    q'' = g + M^-1 J' lam with n = (q_i - q_j) / (r_i + r_j), a series too. n . n = 1 gives for each
    order of lam a linear system, always with the Delassus matrix.
    """
    inverse = inverted(held.delassus())
    reach, pair = system.radius[held.i] + system.radius[held.j], held.j >= 0
    Q, lam = np.zeros((ORDER + 1, *q.shape)), np.zeros((ORDER - 1, len(pair)))
    n = np.zeros((ORDER + 1, *held.n.shape))
    Q[0], Q[1] = project(held, q, v, inverse)
    n[0] = np.where(pair, (Q[0][:, held.i] - Q[0][:, held.j]) / reach, held.n)
    for k in range(ORDER - 1):
        n[k + 1] = (Q[k + 1][:, held.i] - Q[k + 1][:, held.j]) / reach * pair
        a = spread(held, (lam[:k, None] * n[k:0:-1]).sum(0))    # of the forces that are known
        a[1] += system.gravity * (system.w > 0.0) * (k == 0)
        turn = 0.5 * reach * (n[1:k + 2] * n[k + 1:0:-1]).sum((0, 1))
        lam[k] = -inverse @ (held.along(a, n[0]) + (k + 1) * (k + 2) * turn)
        Q[k + 2] = (a + spread(held, lam[k] * n[0])) / ((k + 1) * (k + 2))
    return Q, lam


def trusted(system, Q):
    """A time [s], a power of 2, in which the last two terms of the series stay below 2^-54 r."""
    size = (np.abs(Q[-2:, :, :-1]) / system.radius[:-1]).max((1, 2))
    return math.ldexp(1.0, int(((-54 - np.frexp(size)[1]) // (ORDER - 1, ORDER)).min()))
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


def gap_series(system, Q, gap, which):
    """Series (5 or more, K) with the signs of the gaps `which`: y_i - r_i for the floor's, and
    |q_i - q_j|^2 - (r_i + r_j)^2 for pairs."""
    i, j = system.i[which], system.j[which]
    d, pair = Q[:, :, i] - Q[:, :, j], j >= 0
    p = np.concatenate((d[:, 1], np.zeros((max(0, 5 - len(Q)), len(i)))))
    d = d[:, :, pair]
    for k in range(1, len(p)):
        low, half = max(0, k - len(d) + 1), (k + 1) // 2
        square = 2.0 * (d[low:half] * d[k - half + 1:k - low + 1][::-1]).sum(0)
        p[k, pair] = (square + d[half] * d[half] if k % 2 == 0 else square).sum(0)
    p[0] = gap[which]
    p[0] *= np.where(pair, p[0] + 2.0 * (system.radius[i] + system.radius[j]), 1.0)
    return p
# --- endregion ---


# --- region: exact-next ---
def first_fall(p, horizon):
    """First t in [0, horizon] at which each sum p[k] t^k falls through zero; inf if it does not.

    p (5 or more, K) with p[0] >= 0. Newton's method made safe: with the least curvature up to the
    horizon (above t^4, a bound of it) no step passes a root, and a parabola takes one step. An
    answer is good to 1e-15 of itself, or early where 200 steps of next to no curvature did not get
    there.
    """
    slopes, bends = rate(p), 0.5 * rate(rate(p))
    rest = evaluate(np.abs(bends[3:]), horizon) * horizon**3 if len(p) > 5 else 0.0
    t, curved, bend = np.zeros(p.shape[1]), (p[3:] != 0.0).any(0), p[2]
    value, slope, left, moving = p[0], p[1], 200, np.ones(p.shape[1], bool)
    while left:
        if curved.any():
            vertex = np.where(p[4] > 0.0, np.clip(-p[3] / (4.0 * p[4]), t, horizon), t)
            bend = np.fmin.reduce([evaluate(bends[:3], s) for s in (t, horizon, vertex)]) - rest
            value, slope = np.maximum(evaluate(p, t), 0.0), evaluate(slopes, t)
        root = np.sqrt(slope * slope - 4.0 * value * bend)      # NaN: no root
        step = np.where(slope < 0.0, 2.0 * value / (root - slope),
                        np.where(bend < 0.0, (slope + root) / (-2.0 * bend), np.inf))
        t = np.where(moving, np.where(t + step <= horizon, t + step, np.inf), t)
        moving &= curved & (step > 1e-15 * t)                   # the others have arrived
        left = left - 1 if moving.any() else 0
    return t


def motion(system, now):
    """The series Q of the motion after the Instant `now`, and the time [s] until its next event."""
    due, lam, span = ~now.pushes, np.zeros((0, 0)), np.inf
    Q = np.array((now.q, now.v, 0.5 * now.a))
    if now.slides:
        held = system.contacts(now.q, now.pushes)
        Q, lam = slide(system, held, now.q, now.v)
        grazing = -GRAZE * system.gravity / (system.w[held.i] + system.w[held.j])
        lam[0] = np.maximum(lam[0], 0.0) + grazing              # it ends where support ends it
        span = trusted(system, Q)
        far = span * evaluate(np.abs(Q[1:]), span).sum(0)       # no ball gets farther
        due &= now.gap <= far[system.i] + far[system.j]
    p = gap_series(system, Q, now.gap, due)
    lam = np.concatenate((lam, np.zeros((len(p) - len(lam), lam.shape[1]))))
    return Q, first_fall(np.concatenate((p, lam), 1), span).min(initial=span)
# --- endregion ---


# --- region: exact-run ---
@np.errstate(all="ignore")
def simulate_exact(scene, times, gravity, report=lambda k: None):
    """q, v (S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, from event to event.

    The scene has q0, v0 (2, N), mass (inf: a fixed ball), radius (N,) and restitution; gravity
    [m/s^2] is along y, negative. report(k) is called after each event with the number of samples done.
    """
    system = build_system(scene, gravity)
    q, v = (np.append(rows, np.zeros((2, 1)), 1) for rows in (scene.q0, scene.v0))
    out = np.empty((2, len(times), *q.shape))
    tick = TICK * math.sqrt(scene.radius.min() / -gravity)
    now, done, events, until = 0.0, 0, 0, tick
    while done < len(times):
        Q, span = motion(system, settle(system, q, v))
        if events > EVENTS * len(system.w):
            span = max(span, 0.01 * tick)
        upto = int(np.searchsorted(times, now + span, "right"))
        s = (times[done:upto] - now)[:, None, None]
        out[0, done:upto], out[1, done:upto] = evaluate(Q, s), evaluate(rate(Q), s)
        q, v, now = evaluate(Q, span), evaluate(rate(Q), span), now + span
        done, events = upto, events + 1
        if now >= until:
            events, until = 0, now + tick
        report(done)
    return out[0, ..., :-1], out[1, ..., :-1]
# --- endregion ---
