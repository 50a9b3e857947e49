"""The exact model for balls that slide or lie beside one another (robotics course, chapter 3.5).

contact.py goes from event to event while all balls lie over one another. Here they lie anywhere.
Between two events the same contacts push and the motion is smooth: a parabola in time, or a Taylor
series where a ball slides over another. An event is a gap that closes, a force that falls to zero,
or a series that comes to its end. At each:

    touch        picks the contacts that touch,
    strike       gives impulses to those that close: an LCP in velocities,
    support      gives forces to those that rest: the same LCP in accelerations,
    slide        makes a series of the motion, only where a contact that pushes also slips,
    next_event   finds the first gap that closes or force that ends.

The promise. Over some seconds and metres it is within 1e-10 r of every closed form: drop, bounce,
stack, the slide to its release, the pyramid, the blocks that count pi (3, 31, 314, 3141 impacts).
Rounding grows with both: 2.4e-9 r from 1e6 m up. Piles of 3 to 24 balls with e from 0 to 0.9 are
within 1e-8 r of an independent solver for as long as a start shifted by 1e-15 m stays within 1e-9
r; so long plain and compiled, one code whose sums are rounded otherwise, are within 1e-12 r of one
another. No overlap is above 1e-12 r. No energy is gained above 1e-12 of the start, and none is lost
at e = 1. The answer is the same whenever it is sampled. Masses are within a ratio of 100 where
0 < e < 1. Beyond that it stops with one clear error.

    q, v, a      positions, velocities, accelerations: (2, N), a column a ball     m, m/s, m/s^2
    w            1 / mass; 0 for a ball that nothing moves                         1/kg
    a, b, n      a contact's two balls (b may be the floor) and its unit normal, from b to a
    gap, v_n     distance of the surfaces, and its rate: > 0 separating            m, m/s
    lam          impulse or force of a contact, >= 0                               N s or N
"""

import inspect
import math
import sys
from functools import cache

import numpy as np

from contact import MAX_IMPACTS  # of events, the limit of contact.py's own exact_run

try:
    from curriculum.compiled.cache import Loops
except ImportError:  # no numba
    Loops = None  # type: ignore[assignment, misc]

ORDER = 20  # of the series of balls that slide; a longer one lasts longer and costs more
TOUCH = 1e-12  # of a radius: a smaller gap is none. Rounding is 1e-15, the promise 1e-10
LAST = 1e-13  # of a radius: a bounce that would rise less is the last of its series
MANY = 400  # pairs: of more, 50 are asked first, then who can meet by the time that these tell
NOISE = 1e-12  # of g, of sqrt(g r), of the largest: less is rounding, which leaves 1e-15
GRAZE = 3e-8  # of the slip: a ball between two others may close as slowly as that
RATIO = 100.0  # of masses: above it, where 0 < e < 1, light balls rattle under heavy ones


# --- region: slide-lcp ---
def inverse(W):
    """W^-1 of a Delassus matrix (K, K), and the projector on pushes with W lam = 0: no v_n changes.

    Contacts that depend on one another, as under a slab, have such pushes, and W has no inverse.
    Of the many lam that fit, the first matrix then gives the least.
    """
    unit = 1.0 / np.sqrt(np.diag(W))
    unit = unit * unit.reshape(-1, 1)  # makes the diagonal 1, whatever the masses
    scaled = W * unit
    found, linked = np.eye(len(W)), np.flatnonzero((W != 0.0).sum(0) > 1)
    try:
        part = np.linalg.inv(scaled[linked][:, linked])
        for k in range(len(linked)):
            found[linked[k], linked] = part[k]
        if not (np.abs(np.diag(found)) >= 1e10).any():  # no contact depends on others
            return found * unit, np.zeros_like(W)
    except Exception:
        pass
    size, axes = np.linalg.eigh(scaled)
    stays = size <= NOISE * size[-1]
    size[stays], idle = math.inf, axes * stays
    return axes / size @ axes.T.copy() * unit, idle @ idle.T.copy() * unit


def solve_lcp(W, b, slack=0.0):
    """lam (K,) >= 0 with s = W lam + b >= 0 and lam s = 0, W (K, K), b (K,), by pivots.

    A are the active contacts, those that may push; all of them at first, as at rest. Solve
    W_AA trial_A = -b_A, so that s_A = 0. If some trial_k < 0, k would have to pull: go from lam
    towards trial until the first are at 0, and take them out of A. Else lam = trial, and those with
    s_k < 0, whose gap still closes, join A. Each time that no contact pulls, lam'W lam / 2 + b'lam
    is lower than before, so no A comes twice (Lawson and Hanson 1974).

    Where contacts of A depend on one another, there may be no such trial. Then some pushes change
    no s, and lower that sum without end: go their way until the first contact is at 0. If none gets
    there, a ball is crushed, unless all that closes is within slack sqrt(W_kk), which is forgiven.
    """
    if len(b) < 2:
        return np.maximum(-b / np.diag(W), 0.0)
    unit = np.sqrt(np.diag(W))
    small = NOISE * np.abs(b / unit).max()
    lam, active = np.zeros(len(b)), np.ones(len(b), np.bool_)
    for _ in range(50 + 10 * len(b)):
        trial, endless = push_all(W, b, np.flatnonzero(active), 1e3 * small / unit)
        pulls = np.flatnonzero(trial * unit < -small)
        if len(pulls):
            way = trial if endless else trial - lam
            share = lam[pulls] / -way[pulls]
            lam = (lam + share.min() * way) * active
            active[pulls[share == share.min()]] = False
        elif endless and (trial * unit).max() > (slack * (trial > 0.0)).max():
            raise RuntimeError("exact: a ball is crushed between two that nothing moves")
        elif endless:
            b = b + trial * np.diag(W)
        else:
            lam = np.maximum(trial, 0.0)
            closes = ~active & ((W @ lam + b) / unit < -small)
            if not closes.any():
                return lam
            active |= closes
    raise RuntimeError("exact: contacts at one moment: their masses are too unequal")


def push_all(W, b, on, small):
    """trial (K,) of solve_lcp, by the contacts `on`, and whether it is pushes without end."""
    solve, idle = inverse(W[on][:, on])
    trial, way = np.zeros(len(b)), idle @ -b[on]
    endless = (np.abs(way) > small[on]).any()
    for k, push in zip(on, way if endless else solve @ -b[on]):
        trial[k] = push
    return trial, endless


# --- endregion ---


class Motion:
    """Where all balls are at an event, and what each of the K contacts they can make did so far.

    q, v, a are flat here, (2 N,): all x, then all y. J (C, 2 N) has n of each of C contacts at ball
    a and -n at ball b: J v is v_n, and w J' lam is what pushes lam add to v. sides (K, N): 1, -1.
    """

    def __init__(self, scene, gravity):
        """All contacts that the balls can ever make; two that nothing moves make none."""
        count, w = len(scene.mass), 1.0 / np.append(scene.mass, math.inf)  # last: the floor
        radius = np.append(scene.radius, 0.0)
        pairs = np.array(np.triu_indices(count + 1, 1))
        pairs = pairs[:, w[pairs].sum(0) > 0.0]
        self.pairs, (a, b) = pairs, np.eye(count + 1)[pairs, :-1]
        self.sides = a - b
        self.reach, self.share = radius[pairs].sum(0), w[pairs].sum(0)  # r_a + r_b; 1 / m_eff
        self.radius, self.floor = radius[pairs[0]], pairs[1] == count
        self.q, self.v = np.array((scene.q0, scene.v0), float).reshape(2, -1)
        self.w, self.radii = np.tile((w[:-1], radius[:-1]), 2)
        self.e, self.g, self.gap = scene.restitution, -gravity, 0.0
        self.fall = np.where(self.w > 0.0, np.repeat((0.0, gravity), count), 0.0)
        self.locate(track=0.0)
        self.rests = np.zeros(len(self.gap), bool)  # it touched at the last event and did not part
        self.since, self.parting = self.rests + math.inf, self.rests + 1.0  # [s]; |v_n| then [m/s]
        self.speed = np.sqrt(self.g * self.radius)  # [m/s], the measure of a slow v_n
        kept = loops() and loops().pays(0.0)  # on disk; no run knows how many events it will have
        self.by = compile_loops() if kept else sys.modules[__name__]

    def locate(self, track=1e4):
        """Take gaps (K,) from q, but keep those below `track` times the smallest.

        A light ball between two others bounces until its gaps fall below the rounding of q. So
        next_event tracks gaps, and a tiny one touches only if it was wider.
        """
        q = np.append(self.q.reshape(2, -1), ((0.0,), (0.0,)), 1)
        x, y = q[:, self.pairs[0]] - q[:, self.pairs[1]]
        self.found = np.where(self.floor, y, np.sqrt(x * x + y * y)) - self.reach
        self.bits = np.spacing(np.abs(self.q).max())
        self.small = TOUCH * self.radius + 4.0 * self.bits
        tracked = (np.abs(self.found) < track * self.small) & (self.gap < math.inf)
        self.gap = np.where(tracked, self.gap, self.found)

    def rows(self, chosen):
        """J of the chosen contacts; the normal is up at the floor, and where centres are one."""
        sides = self.sides[chosen]
        n = np.where(self.floor[chosen], ((0.0,), (1.0,)), self.q.reshape(2, -1) @ sides.T)
        n[1] += ~n.any(0)
        n /= np.sqrt((n * n).sum(0))
        return (n.T[:, :, None] * sides[:, None]).reshape(len(chosen), len(self.q))

    def slip(self, chosen, rows):
        """The part of flat rows along the surface; 0 at the floor, which never turns."""
        x, y, along_x, along_y = np.array((self.q, rows)).reshape(4, -1) @ self.sides[chosen].T
        return np.where(self.floor[chosen], 0.0, (x * along_y - y * along_x) / self.reach[chosen])

    def match(self, rows, J, solve, target):
        """Rows changed by the pushes that make J rows the target; twice, for the last digits."""
        for _ in range(2):
            rows = rows + self.w * ((solve @ (target - J @ rows)) @ J)
        return rows

    def touch(self):
        """Which contacts touch now, and their J."""
        for _ in range(50):  # move apart what overlaps, as at a start; what a push closes is next
            if not (self.found < -self.small).any():
                break
            near = np.flatnonzero(self.found <= -2.0 * self.found.min())
            J = self.rows(near)
            slack = 4.0 * self.bits / np.sqrt(self.share[near])
            self.q += self.w * (self.by.solve_lcp(J * self.w @ J.T, self.found[near], slack) @ J)
            self.locate(track=0.0)
        near = np.flatnonzero(self.gap <= self.small)
        J = self.rows(near)
        v_n = J @ self.v
        opened = (self.parting[near] + np.abs(v_n)) * self.since[near]  # about how wide it has been
        still = self.rests[near] & (v_n <= NOISE * self.speed[near])
        on = still | (self.gap[near] <= 1e-4 * opened)
        return near[on], J[on]

    def strike(self, touching, J):
        """Impulses: where a contact pushes, v_n becomes -e v_n, at all contacts at once.

        That is an LCP in s = v_n after - target, target = -e v_n as in contact.py, or 0 where the
        bounce would rise less than LAST radii. A ball that passes between two that nothing moves,
        and touches both, closes until its normals have turned, by GRAZE^2 radii at most: that is
        forgiven. Returns v_n after.
        """
        v_n, speed = J @ self.v, self.speed[touching]
        if (v_n < -NOISE * speed).any():
            target = -self.e * v_n
            target[(v_n < 0.0) & (target < math.sqrt(2.0 * LAST) * speed)] = 0.0
            W = J * self.w @ J.T
            turns = GRAZE * np.abs(self.slip(touching, self.v)) / np.sqrt(self.share[touching])
            on = np.flatnonzero(self.by.solve_lcp(W, v_n - target, turns))
            self.v = self.match(self.v, J[on], self.by.inverse(W[on[:, None], on])[0], target[on])
            v_n = np.maximum(J @ self.v, np.minimum(target, 0.0))  # what was forgiven is 0
        return v_n

    def support(self, touching, J, v_n):
        """Forces for what rests: which contacts push, and all accelerations.

        A resting gap may open and may not close: its second derivative n . a + slip^2 / reach is
        >= 0, with 0 where it pushes. The second term is there because the normal turns. A contact
        that parts rests all the same if its force brings it back before it rises LAST radii.
        """
        self.gap[touching], self.since[touching], self.parting[touching] = 0.0, 0.0, np.abs(v_n)
        rises = v_n**2 / (2.0 * LAST * self.radius[touching])  # LAST radii under this acceleration
        needs = np.where(np.abs(v_n) > NOISE * self.speed[touching], rises, 0.0)
        stays = needs <= self.g
        while True:
            touching, J, needs = touching[stays], J[stays], needs[stays]
            turn = self.slip(touching, self.v) ** 2 / self.reach[touching]
            W = J * self.w @ J.T
            pushes = self.by.solve_lcp(W, J @ self.fall + turn, 0.0 * turn) * self.share[touching]
            stays = needs <= pushes
            if stays.all():
                break
        self.rests[:] = False
        self.rests[touching] = True
        on = np.flatnonzero(pushes > NOISE * self.g)
        J, turn = J[on], turn[on]
        solve = self.by.inverse(W[on[:, None], on])[0]
        a, self.v = self.match(self.fall, J, solve, -turn), self.match(self.v, J, solve, 0.0)
        beside = np.tile(self.sides[touching[on]].any(0), 2)  # else a heap at rest creeps
        a[beside & (np.abs(a) <= NOISE * self.g)] = 0.0
        self.v[beside & (np.abs(self.v) <= NOISE * np.sqrt(self.g * self.radii))] = 0.0
        return touching[on], a

    def slide(self, held):
        """While the held contacts push: q as a series, their forces, and how long [s] both last."""
        J = self.rows(held)
        solve = self.by.inverse(J * self.w @ J.T)[0]
        self.q = self.match(self.q, J, solve, J @ self.q - self.found[held])
        J = self.rows(held)
        self.v = self.match(self.v, J, solve, 0.0)
        Q = np.zeros((ORDER + 1, len(self.q)))
        Q[0], Q[1] = self.q, self.v
        given = self.fall, self.w, J, self.sides[held], self.reach[held], self.floor[held], solve
        lam = self.by.slide_series(Q, *given)
        lam[0] = np.maximum(lam[0], 0.0) + NOISE * self.g / self.share[held]
        size = np.abs(Q[-2:] / self.radii).max(1)  # the last two terms stay below 1e-16 r
        return Q, lam, min((1e-16 / size) ** (1.0 / np.array((ORDER - 1, ORDER))))

    def next_event(self, Q, which, lam, horizon):
        """How long [s] the series Q holds: until a gap closes, a force lam ends, or the horizon.

        Rounding is no event: a gap at rest counts as half of TOUCH open, another as wider by its
        last digits.
        """

        def within(time):  # pairs that can meet until then
            far, rates = time < math.inf, np.abs(Q[1:])
            ways = time ** np.arange(1, len(Q)) @ rates if far else rates[0]
            ways = np.append(ways.reshape(2, -1).sum(0), 0.0)
            ways = ways[self.pairs[0]] + ways[self.pairs[1]]
            reach = np.maximum(ways, 1e4 * self.small) if far else math.inf
            return np.flatnonzero(free & (self.gap <= reach)), ways

        def ask(near):
            gap, reach, floor = np.maximum(self.gap[near], 0.0), self.reach[near], self.floor[near]
            rounds = np.minimum(4.0 * self.bits, 1e-9 * gap)
            wider = np.where(self.rests[near], 0.5 * self.small[near], rounds)
            d = Q.reshape(len(Q), 2, -1) @ self.sides[near].T
            return self.by.next_fall(d, gap, reach, floor, wider, lam, horizon)

        free = np.ones(len(self.gap), bool)
        free[which] = False
        near, ways = within(horizon)
        if len(near) > MANY:
            near, _ = within(ask(near[np.argsort((self.gap / ways)[near])[:50]])[0])
        span, gap = ask(near)
        self.gap = np.full(len(self.gap), math.inf)  # what nobody asked is found anew
        self.gap[which], self.gap[near] = 0.0, gap
        self.since += span
        return span


# --- region: slide-series ---
def slide_series(Q, a, w, J, sides, reach, floor, solve):
    """While K contacts push: fill in the series Q (terms, 2 N) of q in time. Returns that of the
    forces lam (terms, K), the last two 0.

    Q_k, n_k, lam_k are the factors of t^k. While a contact is closed its normal is
    (q_a - q_b) / reach, so n_k = (Q_k,a - Q_k,b) / reach. Newton's law at order k is

        (k + 1) (k + 2) Q_{k+2} = a_k + M^-1 n_0 lam_k,   a_k = g + M^-1 sum_{m<k} n_{k-m} lam_m

    (g only in a_0). And n . n = 1, so sum_m n_m . n_{k+2-m} = 0, which holds Q_{k+2} twice.
    Times (k + 1) (k + 2) reach / 2 it is linear in lam_k, at every order with the same matrix:

        W lam_k + n_0 . (a_k,a - a_k,b) + turn_k = 0,
        turn_k = (k + 1) (k + 2) reach / 2 sum_{m=1}^{k+1} n_m . n_{k+2-m}
    """
    lam, n = np.zeros((len(Q), len(J))), np.zeros((len(Q), 2, len(J)))
    turns = sides.T * (~floor / reach)
    np.dot(Q[0].reshape(2, -1), turns, n[0])
    np.add(n[0, 1], floor, n[0, 1])
    away, push, pushes = -solve, J * w, sides * w[: sides.shape[1]]
    for k in range(len(Q) - 2):
        np.dot(Q[k + 1].reshape(2, -1), turns, n[k + 1])
        if k > 0:
            pull = n[1] * lam[k - 1]
            for m in range(k - 1):
                pull += n[k - m] * lam[m]
            a = (pull @ pushes).reshape(-1)
        turn = np.zeros(len(J))
        for m in range(1, k + 2):
            turn += n[m, 0] * n[k + 2 - m, 0] + n[m, 1] * n[k + 2 - m, 1]
        factor = (k + 1.0) * (k + 2.0)
        turn *= 0.5 * factor * reach
        for _ in range(2):  # once more, for the last digits
            force = away @ (J @ a + turn)
            np.add(lam[k], force, lam[k])
            a = a + force @ push
        np.divide(a, factor, Q[k + 2])
    return lam


# --- endregion ---


def next_fall(d, gap, reach, floor, wider, lam, horizon):
    """When [s] the first of K gaps or of some forces lam (terms, L) falls through 0, and the gaps
    then. `wider` [m] is added to the gaps while we look for it.

    d (terms, 2, K) are the series of q_a - q_b; gaps are known better. P falls: y - r, or d . d -
    reach^2. What is likely to be soon comes first: most others cannot, even if nothing lifted them.
    """
    count, P, free = len(gap), np.zeros((max(len(d), 5), len(gap))), 1.0 - floor  # a square has 5
    for k in range(len(d)):
        np.add(P[k], floor * d[k, 1], P[k])
        for m in range(min(len(d), len(P) - k)):
            np.add(P[k + m], free * (d[k, 0] * d[m, 0] + d[k, 1] * d[m, 1]), P[k + m])
    np.multiply(gap, floor + free * (gap + 2.0 * reach), P[0])
    falls = np.concatenate((P.T, lam.T))
    if len(falls) == 0:
        return horizon, gap
    more = wider * (floor + free * (wider + 2.0 * reach))
    np.add(falls[:count, 0], more, falls[:count, 0])
    when = falls[:, 0] / np.maximum(-falls[:, 1], 1e-9)
    span, first, soon = horizon, len(falls), np.flatnonzero(when == when.min())
    for _ in range(2):
        for k in soon:
            t = first_fall(falls[k], span)
            if t < span:
                span, first = t, k
        sunk = falls[:, 0]
        for k in range(1, falls.shape[1]):
            sunk = sunk + np.minimum(falls[:, k], 0.0) * min(span, 1e15) ** k
        soon = np.flatnonzero(sunk <= 0.0)
    gap = P[-1]
    for row in P[-2::-1]:
        gap = gap * span + row
    gap = gap / (floor + free * (reach + np.sqrt(reach**2 + free * gap)))
    gap[first : first + 1] = 0.0
    return span, gap


def first_fall(p, horizon):
    """The first t <= horizon at which p[0] + p[1] t + ..., >= 0 at 0, falls through 0; else inf.

    Newton's method with the least curvature on the way to `end`, so that no step passes a root.
    It is the horizon at first, then nearer, and twice as far each time: a short way curves less.
    """
    t, end = 0.0, horizon
    c, b, a = p[2], 3.0 * p[3], 6.0 * p[4]
    for _ in range(200):
        value = slope = far = 0.0
        for k in range(len(p) - 1, -1, -1):
            slope = slope * t + value
            value = value * t + p[k]
        for k in range(len(p) - 1, 4, -1):
            far = (far + 0.5 * k * (k - 1) * abs(p[k])) * end
        bend = c + t * (b + t * a)  # half the curvature: exact for parabolas, whose end may be inf
        if a > 0.0 and t < -0.5 * b / a < end:
            bend = c - 0.25 * b * b / a
        if end < math.inf:
            bend = min(bend, c + end * (b + end * a)) - far * end * end
        square, step = slope * slope - 4.0 * max(value, 0.0) * bend, math.inf
        if square >= 0.0 and slope < 0.0:
            step = 2.0 * max(value, 0.0) / (math.sqrt(square) - slope)
        elif square >= 0.0 and bend < 0.0:
            step = (slope + math.sqrt(square)) / (-2.0 * bend)
        if step <= 1e-15 * t:
            return t
        if t + step > end >= horizon:
            return math.inf
        t = min(t + step, end)
        end = min(max(2.0 * t, horizon / 8.0), horizon)
    return t  # next to no curvature: it is as good as there


@cache
def loops():
    """The functions above as numba compiles them, or None without numba."""
    these = inverse, solve_lcp, push_all, slide_series, next_fall, first_fall
    head = f"import math\nimport numpy as np\nNOISE = {NOISE!r}\n"
    source = "\n\n".join((head, *(inspect.getsource(each) for each in these)))
    return Loops and Loops("exact", source, error_model="numpy")  # type: ignore[truthy-function]


def compile_loops():
    """Compile them and keep them on disk: about 20 s, the first time. Returns the module."""
    flags, row, table = np.ones(1, bool), np.ones(1), np.ones((1, 1))
    slide = table, row, row, table, table, row, flags, table
    gaps = np.ones((1, 2, 1)), row, row, flags, row, table, math.inf
    calls = {"inverse": (table,), "solve_lcp": (table, row, row)}
    return loops().load(calls | {"slide_series": slide, "next_fall": gaps})


def sample(Q, times):
    """q, v (2, S, 2 N) at times (S,) of the series Q, with the same bits at any S."""
    powers = np.vander(times, len(Q))  # small terms first
    rates = np.arange(len(Q) - 1.0, 0.0, -1.0)[:, None] * Q[:0:-1]
    both = (powers, Q[::-1]), (powers[:, 1:], rates)
    return np.array([np.einsum("sk,kn->sn", *each) for each in both])


@np.errstate(all="ignore")
def simulate_exact(scene, times, gravity, progress=lambda k: None, most=MAX_IMPACTS) -> np.ndarray:
    """q, v (2, S, 2, N) [m, m/s] of a contact.Scene at `times` (S,) [s], rising from 0.

    Gravity [m/s^2] is along y, negative. At the moment of an event v is that after all rounds of
    impacts. progress(k) is called after each event with the samples done. Raises RuntimeError
    beyond the promise, and after `most` events.
    """
    e, mass = scene.restitution, 1.0 * scene.mass[np.isfinite(scene.mass)]
    ratio = mass.max(initial=0.0) / mass.min(initial=math.inf)
    if 0.0 < e < 1.0 and ratio > RATIO:
        why = f"masses {ratio:.4g} : 1 at restitution {e:g}; at most {RATIO:g} : 1 where 0 < e < 1"
        raise RuntimeError(f"exact: {why}. Take closer masses, or restitution 0 or 1")
    motion, out = Motion(scene, gravity), np.empty((2, len(times), scene.q0.size))
    now, done, event = 0.0, 0, True
    for _ in range(most):
        motion.locate()
        if event:
            touching, J = motion.touch()
            held, a = motion.support(touching, J, motion.strike(touching, J))
            slides = motion.slip(held, motion.v).any() or motion.slip(held, a).any()
        Q, lam, horizon = np.array((motion.q, motion.v, 0.5 * a)), np.empty((5, 0)), math.inf
        if slides:
            Q, lam, horizon = motion.slide(held)
        span = motion.next_event(Q, held, lam, horizon)
        event = span < horizon
        last = int(np.searchsorted(times, now + span))
        states = sample(Q, np.append(times[done:last] - now, span))
        out[:, done:last] = states[:, :-1]
        progress(done := last)
        if done == len(times):
            return out.reshape(2, len(times), *scene.q0.shape)
        (motion.q, motion.v), now = states[:, -1], now + span
    why = f"more than {most:,} events by {now:.6g} s, balls rattle without end"
    raise RuntimeError(f"exact: {why}. Take a shorter run, another restitution, or closer masses")
