"""The exact model for balls that slide or lie beside one another (robotics course, chapter 3.5).

contact.py goes from event to event while all balls lie over one another. Here they lie anywhere.
Between two events the same contacts push and the motion is smooth: a parabola in time, or a Taylor
series where a ball slides over another. An event is a gap that closes, a force that falls to zero,
or a series that comes to its end. At each:

    touch        picks the contacts that touch,
    bounce       gives impulses to those that close: an LCP in velocities,
    support      gives forces to those that rest: the same LCP in accelerations,
    slide        makes a series of the motion, only where a contact that pushes also slips,
    next_event   finds the first gap that closes or force that ends.

The promise. Over some seconds and metres it is within 1e-10 r of every closed form: drop, bounce,
elastic, stack, the slide to its release at two thirds, the pyramid, the blocks that count pi (3,
31, 314, 3141 impacts). Rounding grows with both: 5.3e-10 r over 20,000 s, 2.4e-9 r from 1e6 m up.
Piles of 3 to 24 balls with e from 0 to 0.9 are within 1e-8 r of an independent solver for as long
as a start shifted by 1e-15 m stays within 1e-9 r. No overlap is above 1e-12 r. No energy is gained
above 1e-12 of the start, and none is lost at e = 1. The answer is the same whenever it is sampled.
Masses are within a ratio of 100 where 0 < e < 1. Beyond that it stops with one clear error.

    q, v, a      positions, velocities, accelerations: (2, N), a column a ball     m, m/s, m/s^2
    w            1 / mass; 0 for a ball that nothing moves                         1/kg
    a, b, n      a contact's two balls (b may be the floor) and its unit normal, from b to a
    gap, v_n     distance of the surfaces, and its rate: > 0 separating            m, m/s
    lam          impulse or force of a contact, >= 0                               N s or N
"""

import math
from functools import cached_property

import numpy as np

from contact import MOST_IMPACTS  # of events, the limit of contact.py's own exact_run

ORDER = 20  # of the series of balls that slide; a longer one lasts longer and costs more
TOUCH = 1e-12  # of a radius: a smaller gap is none. Rounding is 1e-15, the promise 1e-10
LAST = 1e-13  # of a radius: a bounce that would rise less is the last of its series
NOISE = 1e-12  # of g, of sqrt(g r), of the largest: less is rounding, which leaves 1e-15
RATIO = 100.0  # of masses: above it, where 0 < e < 1, light balls rattle under heavy ones


# --- region: slide-lcp ---
def inverse(W):
    """W^-1 of a Delassus matrix (K, K), and the projector on pushes with W lam = 0: no v_n changes.

    Contacts that depend on one another, as under a slab, have such pushes, and W has no inverse.
    Of the many lam that fit, the first matrix then gives the least.
    """
    unit = 1.0 / np.sqrt(W.diagonal())
    unit = unit * unit[:, None]  # makes the diagonal 1, whatever the masses
    try:
        found = np.linalg.inv(W * unit)
        if np.abs(found.diagonal()).max(initial=0.0) < 1e10:  # no contact depends on others
            return found * unit, np.zeros_like(W)
    except np.linalg.LinAlgError:
        pass
    size, axes = np.linalg.eigh(W * unit)
    moves = size > NOISE * size.max(initial=0.0)
    size, idle = np.where(moves, size, math.inf), axes * ~moves
    return axes / size @ axes.T * unit, idle @ idle.T * unit


def solve_lcp(W, b):
    """lam (K,) >= 0 with s = W lam + b >= 0 and lam s = 0, W (K, K), b (K,). One pivot at a time.

    Let A be the active contacts, those that may push; all of them at first, as at rest. Solve
    W_AA trial_A = -b_A, so that s_A = 0. If some trial_k < 0, k would have to pull: go from lam
    towards trial until the first of them is at 0, and take it out of A. Else lam = trial, and if
    some s_k < 0, its gap still closes: the fastest one joins A. Each time that no contact pulls,
    lam'W lam / 2 + b'lam is lower than before, so no A comes twice (Lawson and Hanson 1974).

    Where contacts of A depend on one another, there may be no such trial. Then some pushes change
    no s, and lower that sum without end: go their way until the first contact is at 0.
    """
    if len(b) < 2:
        return np.maximum(-b / W.diagonal(), 0.0)
    unit = np.sqrt(W.diagonal())
    size = np.abs(b / unit).max(initial=0.0)
    lam, active = np.zeros(len(b)), np.ones(len(b), bool)
    for _ in range(50 + 10 * len(b)):
        trial, on = np.zeros(len(b)), np.flatnonzero(active)
        solve, idle = inverse(W[on[:, None], on])
        trial[on] = idle @ -b[on]
        endless = np.abs(trial * unit).max() > 1e3 * NOISE * size
        if not endless:
            trial[on] = solve @ -b[on]
        pulls = np.flatnonzero(trial * unit < -NOISE * size)
        if len(pulls):
            way = trial if endless else trial - lam
            share = lam[pulls] / -way[pulls]
            lam = np.where(active, lam + share.min() * way, 0.0)
            active[pulls[share.argmin()]] = False
            continue
        if endless:
            raise RuntimeError("exact: a ball is crushed between two that nothing moves")
        lam = np.maximum(trial, 0.0)
        s = np.where(active, 0.0, (W @ lam + b) / unit)
        if s.min(initial=0.0) >= -NOISE * size:
            return lam
        active[s.argmin()] = True
    raise RuntimeError(f"exact: {len(b)} contacts at one moment: their masses are too unequal")


# --- endregion ---


class Contacts:
    """K contacts as columns: sign (N, K) is 1 in the row of ball a and -1 in that of ball b."""

    def __init__(self, scene):
        """All that the balls of a scene can ever make; two that nothing moves make none."""
        count = len(scene.mass)
        w, radius = np.pad([1.0 / scene.mass, scene.radius], ((0, 0), (0, 1)))  # last: the floor
        pairs = np.array(np.triu_indices(count + 1, 1))
        pairs = pairs[:, w[pairs].sum(0) > 0.0]
        balls = np.arange(count)[:, None]
        self.w, self.sign = w[:-1], 1.0 * (pairs[0] == balls) - (pairs[1] == balls)
        self.reach, self.share = radius[pairs].sum(0), w[pairs].sum(0)  # r_a + r_b; 1 / m_eff
        self.radius, self.floor = radius[pairs[0]], pairs[1] == count
        self.n = np.zeros((2, len(self.reach)))

    def pick(self, chosen):
        """The chosen contacts, as a new Contacts."""
        part = object.__new__(Contacts)
        part.w = self.w
        for name in ("sign", "n", "reach", "floor", "radius", "share"):
            setattr(part, name, getattr(self, name)[..., chosen])
        return part

    def locate(self, q):
        """Take the normals from positions q (2, N). Returns the gaps (K,)."""
        d = q @ self.sign
        distance = np.where(self.floor, d[1], np.sqrt((d * d).sum(0)))
        self.n = np.where(self.floor | (distance == 0.0), [[0.0], [1.0]], d / distance)
        return distance - self.reach

    def along(self, rows):
        """n . (rows_a - rows_b): of velocities, v_n."""
        return (self.n * (rows @ self.sign)).sum(0)

    def across(self, rows):
        """The part along the surface, of velocities the slip; 0 at the floor, which never turns."""
        d = rows @ self.sign
        return np.where(self.floor, 0.0, self.n[0] * d[1] - self.n[1] * d[0])

    def push(self, lam):
        """M^-1 J' lam (2, N): what pushes lam (K,) add to the velocities."""
        return (self.n * lam) @ self.sign.T * self.w

    def delassus(self):
        """W = J M^-1 J' (K, K): column k is what a unit push at contact k adds to all v_n."""
        return self.sign.T * self.w @ self.sign * (self.n.T @ self.n)

    @cached_property
    def inverse(self):
        """W^-1, made once: while the contacts push, their normals turn by no more than rounding."""
        return inverse(self.delassus())[0]

    def match(self, rows, target):
        """Rows changed by the pushes that make `along` the target; twice, for the last digits."""
        for _ in range(2):
            rows = rows + self.push(self.inverse @ (target - self.along(rows)))
        return rows


class Motion:
    """Where all balls are at an event, and what each of the K contacts they can make did so far."""

    def __init__(self, scene, gravity):
        self.q, self.v = np.array((scene.q0, scene.v0), float)
        self.w = 1.0 / scene.mass
        self.radius, self.e, self.g = scene.radius, scene.restitution, -gravity
        self.all = Contacts(scene)
        self.gap = self.all.locate(self.q)  # [m]
        self.rests = np.zeros(len(self.gap), bool)  # it touched at the last event and did not part
        self.since = np.full(len(self.gap), math.inf)  # the time [s] since it touched,
        self.parting = np.ones(len(self.gap))  # and |v_n| [m/s] then
        self.speed = np.sqrt(self.g * self.all.radius)  # [m/s], the measure of a slow v_n

    def touch(self):
        """Which contacts touch now.

        A light ball between two others bounces until its gaps fall below the rounding of q. So
        next_event tracks gaps, and a tiny one touches only if it was wider.
        """
        self.bits = np.spacing(np.abs(self.q).max())
        self.small = TOUCH * self.all.radius + 4.0 * self.bits
        self.found = self.all.locate(self.q)
        self.gap = np.where(np.abs(self.found) < 1e4 * self.small, self.gap, self.found)
        self.separate()
        v_n = self.all.along(self.v)
        opened = (self.parting + np.abs(v_n)) * self.since  # about how wide it has been
        still = self.rests & (v_n <= NOISE * self.speed)
        least = np.where(still, self.small, np.minimum(self.small, 1e-4 * opened))
        return np.flatnonzero(self.gap <= least)

    def separate(self):
        """Move apart what overlaps, as at a start, by pushes that heavy balls feel less."""
        for _ in range(50):  # what a push closes is for the next round
            if not (self.found < -self.small).any():
                break
            near = self.found <= -2.0 * self.found.min()
            part = self.all.pick(near)
            self.q = self.q + part.push(solve_lcp(part.delassus(), self.found[near]))
            self.found = self.gap = self.all.locate(self.q)

    def strike(self, touching):
        """Impulses: where a contact pushes, v_n becomes -e v_n, at all contacts at once.

        That is an LCP in s = v_n after - target with target = -e v_n, as in contact.py; the target
        is 0 where the bounce would rise less than LAST radii.
        """
        contacts, speed = self.all.pick(touching), self.speed[touching]
        v_n = contacts.along(self.v)
        if (v_n < -NOISE * speed).any():
            target = -self.e * v_n
            target[(v_n < 0.0) & (target < math.sqrt(2.0 * LAST) * speed)] = 0.0
            struck = solve_lcp(contacts.delassus(), v_n - target) > 0.0
            self.v = contacts.pick(struck).match(self.v, target[struck])

    def support(self, touching):
        """Forces for what rests: which contacts push, these Contacts, and all accelerations.

        A resting gap may open and may not close: its second derivative n . a + slip^2 / reach is
        >= 0, with 0 where it pushes. The second term is there because the normal turns. A contact
        that parts rests all the same if its force brings it back before it rises LAST radii.
        """
        contacts = self.all.pick(touching)
        v_n = contacts.along(self.v)
        self.gap[touching], self.since[touching], self.parting[touching] = 0.0, 0.0, np.abs(v_n)
        a = np.zeros_like(self.q)
        a[1] = np.where(self.w > 0.0, -self.g, 0.0)
        rises = v_n**2 / (2.0 * LAST * contacts.radius)  # LAST radii under this acceleration
        needs = np.where(np.abs(v_n) > NOISE * self.speed[touching], rises, 0.0)
        still = needs <= self.g
        while True:
            resting = contacts.pick(still)
            turn = resting.across(self.v) ** 2 / resting.reach
            lam = solve_lcp(resting.delassus(), resting.along(a) + turn)
            stays = needs[still] <= lam * resting.share
            if stays.all():
                break
            still[still] = stays
        touching = touching[still]
        self.rests = np.bincount(touching, minlength=len(self.gap)) > 0
        if (np.abs(self.found[touching]) > self.bits).any():  # close what counts as closed
            self.q = resting.match(self.q, resting.along(self.q) - self.found[touching])
        pushes = lam * resting.share > NOISE * self.g
        held = resting.pick(pushes)
        if pushes.any():
            beside = held.sign.any(1)
            a, self.v = held.match(a, -turn[pushes]), held.match(self.v, 0.0)
            a[:, beside] *= np.abs(a[:, beside]) > NOISE * self.g  # else a heap at rest creeps
            slow = NOISE * np.sqrt(self.g * self.radius[beside])
            self.v[:, beside] *= np.abs(self.v[:, beside]) > slow
        return touching[pushes], held, a

    # --- region: slide-series ---
    def slide(self, held):
        """While the held contacts push: q as a series Q (ORDER + 1, 2, N) in time, their forces
        lam (ORDER + 1, K), the last two 0, and how long [s] both last.

        Q_k, n_k, lam_k are the factors of t^k. While a contact is closed its normal is
        (q_a - q_b) / reach, so n_k = (Q_k,a - Q_k,b) / reach. Newton's law at order k is

            (k + 1) (k + 2) Q_{k+2} = a_k + M^-1 n_0 lam_k,   a_k = g + M^-1 sum_{m<k} n_{k-m} lam_m

        (g only in a_0). And n . n = 1, so sum_m n_m . n_{k+2-m} = 0, which holds Q_{k+2} twice.
        Times (k + 1) (k + 2) reach / 2 it is linear in lam_k, at every order with the same matrix:

            W lam_k + n_0 . (a_k,a - a_k,b) + turn_k = 0,
            turn_k = (k + 1) (k + 2) reach / 2 sum_{m=1}^{k+1} n_m . n_{k+2-m}
        """
        self.q = held.match(self.q, held.along(self.q) - held.locate(self.q))
        held.locate(self.q)
        self.v = held.match(self.v, 0.0)
        Q, lam = np.zeros((ORDER + 1, *self.q.shape)), np.zeros((ORDER + 1, len(held.reach)))
        n = np.zeros((ORDER + 1, *held.n.shape))
        Q[0], Q[1], n[0] = self.q, self.v, held.n
        turns, pushes = held.sign / held.reach * ~held.floor, held.sign.T * held.w
        a = np.array((0.0, -self.g))[:, None] * (held.w > 0.0)
        W, solve, half = held.delassus(), -held.inverse, 0.5 * held.reach
        for k in range(ORDER - 1):
            n[k + 1] = Q[k + 1] @ turns
            if k > 0:
                a = np.einsum("mk,mxk->xk", lam[:k], n[k:0:-1]) @ pushes
            factor = (k + 1) * (k + 2)
            turn = factor * half * np.einsum("mxk,mxk->k", n[1 : k + 2], n[k + 1 : 0 : -1])
            misses = held.along(a) + turn
            force = solve @ misses
            force += solve @ (W @ force + misses)  # once more, for the last digits
            lam[k], Q[k + 2] = force, (a + held.n * force @ pushes) / factor
        lam[0] = np.maximum(lam[0], 0.0) + NOISE * self.g / held.share
        size = np.abs(Q[-2:] / self.radius).max((1, 2))  # the last two terms stay below 1e-16 r
        return Q, lam, min((1e-16 / size) ** (1.0 / np.array((ORDER - 1, ORDER))))

    # --- endregion ---

    def next_event(self, Q, which, lam, horizon):
        """How long [s] the series Q holds: until a gap closes, a force lam ends, or the horizon.

        Rounding is no event: a gap at rest counts as half of TOUCH open, another as wider by its
        last digits.
        """
        free = np.ones(len(self.gap), bool)
        free[which] = False
        if horizon < math.inf:  # who is out of reach until then
            moves = (np.abs(Q[1:]).sum(1) * horizon ** np.arange(1, len(Q))[:, None]).sum(0)
            free &= self.gap <= moves @ np.abs(self.all.sign)
        near = np.flatnonzero(free)
        part, gap, rests = self.all.pick(near), np.maximum(self.gap[near], 0.0), self.rests[near]
        P = gap_series(part, gap, Q)
        wider = np.where(rests, 0.5 * self.small[near], np.minimum(4.0 * self.bits, 1e-9 * gap))
        falls = np.hstack((P, lam))
        falls[0, : len(near)] += np.where(part.floor, wider, wider * (wider + 2.0 * part.reach))
        span, first = first_fall(falls, horizon)
        value = evaluate(P, span)
        root = value / (part.reach + np.sqrt(part.reach**2 + value))
        self.gap[near] = np.where(part.floor, value, root)
        self.gap[near[first : first + 1]] = 0.0
        self.since += span
        return span


def evaluate(P, t):
    """sum P[k] t^k by Horner's rule."""
    total = P[-1]
    for row in P[-2::-1]:
        total = total * t + row
    return total


def gap_series(contacts, gap, Q):
    """Series (terms, K) with the signs of the gaps, from `gap` on: y - r, or d . d - reach^2."""
    d = Q @ contacts.sign
    P = np.zeros((max(len(d), 5), d.shape[2]))  # 5: a parabola's square is whole
    for k, row in enumerate(d):
        P[k : k + len(d)] += (row * d[: len(P) - k]).sum(1)
    P[:, contacts.floor] = 0.0
    P[: len(d), contacts.floor] = d[:, 1, contacts.floor]
    P[0] = np.where(contacts.floor, gap, gap * (gap + 2.0 * contacts.reach))
    return P


def first_fall(P, horizon):
    """The first t <= horizon at which a column of P (terms, K), all >= 0 at 0, falls through 0,
    and which column; horizon and K if none does.

    Newton's method with the least curvature on the way to `end`, so that no step passes a root.
    It is the horizon at first, then nearer, and twice as far each time: a short way curves less.
    """
    first, column, k = horizon, P.shape[1], np.arange(len(P))[:, None]
    slopes = k[1:] * P[1:]
    bends, live = 0.5 * k[1:-1] * slopes[1:], np.arange(column)
    t, end = np.zeros(column), np.full(column, horizon)
    for _ in range(200):
        bend, power = least(bends, t, end), np.vander(t, len(P), True).T
        value, slope = np.maximum((P * power).sum(0), 0.0), (slopes * power[:-1]).sum(0)
        root = np.sqrt(slope * slope - 4.0 * value * bend)  # NaN: it never falls
        step = np.where(slope < 0.0, 2.0 * value / (root - slope), (slope + root) / (-2.0 * bend))
        step = np.where((step >= 0.0) & ((slope < 0.0) | (bend < 0.0)), step, math.inf)
        found = step <= 1e-15 * t
        if found.any() and t[found].min() <= first:
            first, column = t[found].min(), live[found][t[found].argmin()]
        far = t + step > end
        on = ~found & (t <= first) & ~(far & (end >= horizon))
        live, t = live[on], np.where(far, end, t + step)[on]
        if not len(live):
            return first, column
        P, slopes, bends = P[:, on], slopes[:, on], bends[:, on]
        end = np.minimum(np.maximum(2.0 * t, horizon / 8.0), horizon)
    near = t.argmin()  # next to no curvature: it is as good as there
    return (t[near], live[near]) if t[near] <= first else (first, column)


def least(P, t, end):
    """No sum P[k] s^k is less for s in [t, end]; exact for parabolas, whose end may be inf."""
    c, b, a = P[:3]
    vertex = np.where(a > 0.0, np.minimum(np.maximum(-0.5 * b / a, t), end), t)
    s = np.array((t, vertex, end))
    rest = np.abs(P[3:]) * np.vander(end, len(P), True).T[3:]
    return np.fmin.reduce(c + s * (b + s * a)) - rest.sum(0)


class Cycle:
    """What happened since a saved state: once that comes again, to the last bit, all of it does.

    A later state is saved after 1, 2, 4, ... events, so that any cycle is found (Brent 1980).
    """

    def __init__(self):
        self.saved, self.flights, self.length = None, [], 1

    def repeats(self, motion):
        """Whether this state is the saved one; perhaps save it."""
        state = b"".join(part.tobytes() for part in (motion.q, motion.v, motion.gap, motion.rests))
        if state == self.saved and any(span for span, _ in self.flights):
            return True
        if len(self.flights) == self.length or self.saved is None:
            self.saved, self.flights = state, []
            self.length = min(2 * self.length, 1000)  # a bound of memory
        return False

    def read(self, times):
        """q, v (2, S, 2, N) at times (S,) since the saved state, round and round."""
        starts = np.cumsum([0.0] + [span for span, _ in self.flights])
        times, out = times % starts[-1], np.empty((2, len(times), *self.flights[0][1].shape[1:]))
        number = np.searchsorted(starts, times, "right") - 1
        for k in np.unique(number):
            here = number == k
            out[:, here] = sample(self.flights[k][1], times[here] - starts[k])
        return out


def sample(Q, times):
    """q, v (2, S, 2, N) at times (S,) of the series Q."""
    both = np.zeros((len(Q), 2, 1, *Q.shape[1:]))
    both[:, 0, 0] = Q
    both[:-1, 1, 0] = np.arange(1.0, len(Q))[:, None, None] * Q[1:]
    return evaluate(both, times[:, None, None])


def refuse(scene):
    """Raise RuntimeError for masses beyond the promise."""
    e, mass = scene.restitution, scene.mass[np.isfinite(scene.mass)]
    ratio = mass.max(initial=0.0) / mass.min(initial=math.inf)
    if 0.0 < e < 1.0 and ratio > RATIO:
        given = (
            f"masses {ratio:.4g} : 1 at restitution {e:g}; at most {RATIO:g} : 1 where 0 < e < 1"
        )
        raise RuntimeError(f"exact: {given}. Take closer masses, or restitution 0 or 1")


@np.errstate(all="ignore")
def simulate_exact(scene, times, gravity, progress=lambda k: None, most=MOST_IMPACTS) -> np.ndarray:
    """q, v (2, S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, from event to event.

    The scene has q0, v0 (2, N), mass (N,), inf for a ball that nothing moves, radius (N,) and
    restitution; gravity [m/s^2] is along y, negative. At the moment of an event v is that after
    all rounds of impacts of this moment. progress(k) is called after each event with the samples
    done. Raises RuntimeError beyond the promise, and after `most` events.
    """
    refuse(scene)
    motion, cycle, out = Motion(scene, gravity), Cycle(), np.empty((2, len(times), *scene.q0.shape))
    now, done = 0.0, 0
    for _ in range(most):
        touching = motion.touch()
        motion.strike(touching)
        which, held, a = motion.support(touching)
        if cycle.repeats(motion):
            out[:, done:] = cycle.read(times[done:] - now)
            return out
        Q, lam, horizon = np.array((motion.q, motion.v, 0.5 * a)), np.empty((5, 0)), math.inf
        if held.across(motion.v).any() or held.across(a).any():
            Q, lam, horizon = motion.slide(held)
        span = motion.next_event(Q, which, lam, horizon)
        last = int(np.searchsorted(times, now + span))
        states = sample(Q, np.append(times[done:last] - now, span))
        out[:, done:last] = states[:, :-1]
        cycle.flights.append((span, Q))
        done = last
        progress(done)
        if done == len(times):
            return out
        (motion.q, motion.v), now = states[:, -1], now + span
    raise RuntimeError(
        f"exact: more than {most:,} events by {now:.6g} s, balls rattle without end."
        " Take a shorter run, another restitution, or closer masses"
    )
