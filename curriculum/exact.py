"""exact in the plane, event-driven: all scenes that contact.exact_run leaves (chapter 3.5).

Between two events the same contacts push and the motion is smooth: a parabola in time, or a power
series where balls slide over one another. An event is a time of impact, a force that falls to zero,
or the end of a series. At each event an LCP at velocity level gives the impulses, and the same LCP
at acceleration level the forces of the contacts that rest (Motion.solve_contacts).

Accuracy: over some seconds and metres within 1e-10 r of every closed form, and within 1e-8 r of an
independent solver for as long as a start shifted by 1e-15 m stays within 1e-9 r (see the tests). No
overlap is above 1e-12 r (one of 5,088 random scenes: 1.2e-12 r), no gain of energy above 1e-12.
Limits, each a RuntimeError: mass ratios above 100 where 0 < e < 1; MAX_EVENTS events, which a crowd
with e > 0 may use up within a second (Zeno behaviour); a ball that is crushed between two fixed
ones, or just passes between them; pivots that do not converge.

    q, v, a      positions, velocities, accelerations: (2 N,), all x, then all y   m, m/s, m/s^2
                 N: the bodies of the scene and, the last of them, the floor
    w            1 / mass; 0 for a fixed body                                      1/kg
    a, b, n      a contact's two bodies and its unit normal, from b to a
    gap, v_n     distance of the surfaces, and its rate: > 0 separating            m, m/s
    lam          impulse or force of a contact, >= 0                               N s or N
    J, W         J v is v_n (J: a row a contact); W = J M^-1 J', Delassus matrix   1, 1/kg
    held, solve  indices of the active contacts; W^-1 of these                     -, kg
"""

import math

import numpy as np

from contact import time_to_impact
from curriculum.commands import one_thread

ORDER = 20  # of the power series at most; a longer one lasts longer and costs more
MAX_EVENTS = 50_000  # in a run: about a minute with 40 balls
TOUCH_TOLERANCE = 1e-12  # of a radius: a smaller gap is closed. Rounding is 1e-15, the goal 1e-10
MIN_BOUNCE = 1e-13  # of a radius: the restitution threshold, as a height: less is no bounce
ROUNDING = 1e-12  # of g, of sqrt(g r), of the largest entry: less is rounding (1e-15)
DEPENDENT = 1e-10  # of a contact's 1 / m_eff: with a smaller pivot it depends linearly on others
MAX_MASS_RATIO = 100.0  # where 0 < e < 1; above it light balls bounce ever faster under heavy ones


# --- region: slide-lcp ---
# A contact is active, s = 0, or it parts, lam = 0. x holds lam of the active contacts and s of the
# others (the basic variables), z their partners, all 0; the table gives x = table z + what b adds,
# and is W where none is active. A pivot on a contact exchanges its lam and s. Solved is x >= 0.
def solve_lcp(W, b):
    """Solve the LCP of K contacts: lam >= 0, s = W lam + b >= 0, and lam s = 0 (Signorini).

    Return lam (K,), the active contacts, and the inverse of their part of W.

    Principal pivoting, from all contacts active, as at rest; if they are dependent, from none:
    first on all x < 0 together (Kostreva 1978), as long as they become fewer; then on one at a
    time, lam >= 0 throughout (Dantzig; for contacts Baraff 1994). Raises RuntimeError if no push
    keeps a contact from closing, and if the pivots do not converge.
    """
    unit = np.sqrt(W.diagonal())
    scale = unit * unit[:, None]  # makes the diagonal 1, whatever the masses
    W, b, fewest = W / scale, b / unit, len(b) + 1
    inverse = invert(W)
    table, active = W if inverse is None else inverse, np.full(len(b), inverse is not None)
    well_scaled = np.abs(table.diagonal()).max(initial=0.0) < 1e4
    small = ROUNDING * np.abs(b).max(initial=0.0)
    for _ in range(50 + 10 * len(b)):
        x = np.where(active, 0.0, b) - table @ np.where(active, b, 0.0)
        wrong = (x < -small).nonzero()[0]
        if not len(wrong):
            on = active.nonzero()[0]
            block, lam = (on[:, None], on), 0.0 * b
            inverse = table[block] if well_scaled else np.linalg.inv(W[block])
            lam[on] = np.maximum(-inverse @ b[on], 0.0)
            return lam / unit, on, inverse / scale[block]
        chosen = wrong if len(wrong) < fewest else wrong[active[wrong]]
        fewest = min(fewest, len(wrong))
        if len(chosen):
            table = pivot(table, active, chosen)
            continue
        table, free = activate(table, active, x, x.argmin())
        if free is not None:  # pushes in the null space of W: s_k falls without end
            way = free * (free @ b / (free @ free))
            if (-way).max() > 1e3 * small:
                raise RuntimeError(
                    "exact: a ball is crushed between two fixed bodies, or just fits"
                )
            b = b - way
    raise RuntimeError("exact: the pivots did not converge: the masses differ too much")


def activate(table, active, x, k):
    """Raise lam_k until s_k = 0; each contact whose lam falls to 0 on the way parts.

    Return the table, and None; or, if nothing stops lam_k, the pushes that grow with it.
    """
    while not active[k]:
        column = table[:, k]
        way = np.where(active & (column < 0.0), x / np.maximum(-column, 1e-300), math.inf)
        j = way.argmin()
        if column[k] > DEPENDENT and -x[k] / column[k] <= way[j]:
            j = k
        elif way[j] < math.inf:
            x += way[j] * column
            x[j] = 0.0
        else:
            return table, np.where(np.arange(len(x)) == k, 1.0, active * column)
        table = pivot(table, active, np.array((j,)))
    return table, None


def pivot(table, active, chosen):
    """Exchange lam and s of the chosen: return the table, flip `active`; unless dependent."""
    inverse = invert(table[chosen[:, None], chosen])
    if inverse is None:
        return table
    rows, left = table[chosen], table[:, chosen] @ inverse
    table = table - left @ rows
    table[:, chosen], table[chosen] = left, -inverse @ rows
    table[chosen[:, None], chosen] = inverse
    active[chosen] = ~active[chosen]
    return table


def invert(W):
    """Return W^-1, or None where a contact depends on others."""
    inverse, block = np.zeros_like(W), slice(None)
    if len(W) > 40:  # balls alone on the floor have one contact each, with 0 beside its diagonal
        linked = (W != 0.0).sum(0) > 1
        inverse, block = np.diag(1.0 / W.diagonal()), np.ix_(linked, linked)
    try:
        inverse[block] = np.linalg.inv(W[block])
    except np.linalg.LinAlgError:
        return None
    return inverse if np.abs(inverse.diagonal()).max(initial=0.0) < 1.0 / DEPENDENT else None


# --- endregion ---


# --- region: slide-series ---
def slide_series(q, v, a, w, J, sides, reach, floor, solve, size, enough):
    """Expand q while K contacts are active. Return the series Q (terms, 2 N) of q in time [s], lam
    (terms, K) of the forces, the last two 0, and how long the last two terms of Q stay below
    1e-16 of size (m, m/s); they do so for `enough`, or there are ORDER + 1 terms.

    Q_k, n_k, lam_k are the factors of t^k. While a contact is closed its normal is
    (q_a - q_b) / reach, so n_k = (Q_k,a - Q_k,b) / reach. Newton's law at order k is

        (k + 1) (k + 2) Q_{k+2} = a_k + M^-1 n_0 lam_k,   a_k = g + M^-1 sum_{m<k} n_{k-m} lam_m

    (g only in a_0). And n . n = 1, so sum_m n_m . n_{k+2-m} = 0, which holds Q_{k+2} twice.
    Times (k + 1) (k + 2) reach / 2 it is linear in lam_k, at every order with the same matrix:

        W lam_k + n_0 . (a_k,a - a_k,b) + turn_k = 0,
        turn_k = (k + 1) (k + 2) reach / 2 sum_{m=1}^{k+1} n_m . n_{k+2-m}
    """
    Q, n = np.zeros((ORDER + 1, len(q))), np.zeros((ORDER + 1, 2, len(J)))
    lam, lasts = np.zeros((ORDER + 1, len(J))), [0.0, 0.0]
    turns, push, pushes = sides.T * (~floor / reach), J * w, sides * w[: sides.shape[1]]
    Q[0], Q[1], W = q, v, push @ J.T
    n[0] = q.reshape(2, -1) @ turns
    n[0, 1] += floor
    for k in range(ORDER - 1):
        n[k + 1] = Q[k + 1].reshape(2, -1) @ turns
        if k > 0:
            a = (np.einsum("mic,mc->ic", n[k:0:-1], lam[:k]) @ pushes).ravel()
        factor = (k + 1.0) * (k + 2.0)
        turn = 0.5 * factor * reach * np.einsum("mic,mic->c", n[1 : k + 2], n[k + 1 : 0 : -1])
        force = solve @ -(J @ a + turn)
        lam[k] = force - solve @ (J @ a + turn + W @ force)  # once more, for the last digits
        Q[k + 2] = (a + lam[k] @ push) / factor
        change = max(math.sqrt(Q[k + 2] @ Q[k + 2]), 1e-300)
        length, speed = 1e-16 * size[0] / change, 1e-16 * size[1] / change / (k + 2)
        lasts.append(min(length ** (1.0 / (k + 2)), speed ** (1.0 / (k + 1))))
        if min(lasts[-2:]) > enough:
            break
    return Q[: k + 3], lam[: k + 3], min(lasts[-2:])


# --- endregion ---


class Motion:
    """The state of all bodies at an event, and what each of the C possible contacts did so far."""

    def __init__(self, scene, gravity):
        """List the pairs with a body that can move. RuntimeError: the mass ratio is too large."""
        e, mass = scene.restitution, 1.0 * scene.mass[np.isfinite(scene.mass)]
        ratio = mass.max(initial=0.0) / mass.min(initial=math.inf)
        if 0.0 < e < 1.0 and ratio > MAX_MASS_RATIO:
            why = f"masses {ratio:.4g} : 1 at restitution {e:g}; at most {MAX_MASS_RATIO:g} : 1"
            raise RuntimeError(f"exact: {why} where 0 < e < 1. Take closer masses, or e = 0 or 1")
        count = len(scene.mass) + 1
        w, radius = 1.0 / np.append(scene.mass, math.inf), np.append(scene.radius, 0.0)
        pairs = np.array(np.triu_indices(count, 1))
        self.pairs = pairs[:, w[pairs].sum(0) > 0.0]
        self.floor = self.pairs[1] == count - 1
        self.touch_distance, self.inv_m_eff = radius[self.pairs].sum(0), w[self.pairs].sum(0)
        a, b = np.eye(count)[self.pairs]
        self.sides, self.curves = a - b, 1.0 - self.floor  # 1 at body a, -1 at b; the floor is flat
        self.q, self.v = 1.0 * np.pad((scene.q0, scene.v0), ((0, 0), (0, 0), (0, 1))).reshape(2, -1)
        self.w, self.e, self.g = np.tile(w, 2), e, -gravity
        self.fall = np.where(self.w > 0.0, np.repeat((0.0, gravity), count), 0.0)
        self.radius, small = radius[self.pairs[0]], scene.radius.min()
        self.size = small, math.sqrt(self.g * small)  # m, m/s
        self.slow = ROUNDING * np.sqrt(self.g * self.radius)  # m/s
        self.rests = np.zeros(len(self.floor), bool)  # closed at the last event, and did not part
        self.active = self.rests.copy()  # rests and pushes
        self.tracked = self.rests + math.inf  # m, see next_event
        self.since, self.parting = self.rests + math.inf, self.rests + 1.0  # s; |v_n| then, m/s

    def apart(self, rows):
        """Rows (R, 2 N) at body a minus those at body b: (R, 2, C); at the floor only along y."""
        each = rows.reshape(len(rows), 2, -1).take(self.pairs, 2)
        d = each[:, :, 0] - each[:, :, 1]
        d[:, 0] *= self.curves
        return d

    def update_gaps(self):
        """Compute normals and gaps from q; a gap tracked as below 1e4 `closed` stays as tracked.

        A light ball between two others bounces until its gaps fall below the rounding of q. found:
        the gap from q; bits: rounding of q; closed: the largest gap that counts as closed [m].
        """
        d = self.apart(self.q[None])[0]
        self.length = np.where(self.floor, d[1], np.hypot(d[0], d[1]))
        self.n, self.found = d / self.length, self.length - self.touch_distance
        self.bits = np.spacing(np.abs(self.q).max())
        self.closed = TOUCH_TOLERANCE * self.radius + 4.0 * self.bits
        self.gap = np.where(self.tracked < 1e4 * self.closed, self.tracked, self.found)

    def jacobian(self, chosen):
        """J (K, 2 N) of the chosen contacts."""
        return np.concatenate((*self.n[:, chosen, None] * self.sides[chosen],), 1)

    def slip(self, chosen, J, row):
        """The tangential part of row, relative velocities or accelerations; 0 at the floor."""
        x, y = row.reshape(2, -1)
        return J @ np.concatenate((y, -x)) * self.curves[chosen]

    def project(self, row, J, solve, target):
        """Return row + M^-1 J' lam with J row = target; twice, for the last digits."""
        push = J * self.w
        row = row + solve @ (target - J @ row) @ push
        return row + solve @ (target - J @ row) @ push

    def separate(self):
        """Move overlapping bodies apart, as at a start; new overlaps of this, in the next round."""
        for _ in range(50):
            if not (self.found < -self.closed).any():
                return
            self.n[:, self.length == 0.0] = (0.0,), (1.0,)  # one centre: up
            near = np.flatnonzero(self.found <= -2.0 * self.found.min())
            J = self.jacobian(near)
            self.q = self.q + solve_lcp(J * self.w @ J.T, self.found[near])[0] @ J * self.w
            self.update_gaps()

    def solve_impacts(self, touching, J, W):
        """Apply impulses: v_n of an active contact becomes -e v_n, all at once. Return v_n after.

        An LCP in s = v_n after - target, 0 for a bounce that would rise less than MIN_BOUNCE.
        """
        v_n, slow = J @ self.v, self.slow[touching]
        if not (v_n < -slow).any():
            return v_n
        target = -self.e * v_n
        target[(v_n < 0.0) & (target < math.sqrt(2.0 * MIN_BOUNCE) / ROUNDING * slow)] = 0.0
        _, on, solve = solve_lcp(W, v_n - target)
        self.v = self.project(self.v, J[on], solve, target[on])
        return J @ self.v

    def solve_resting(self, touching, J, W, v_n):
        """Find the resting contacts and their forces. Return the active ones, J, their W^-1.

        The gap of a resting contact may open and may not close: its acceleration n . a + turn is
        >= 0, and 0 where it pushes; turn = slip^2 / touch_distance, since the normal turns. A
        contact that parts rests all the same if it would close again before it rises MIN_BOUNCE.
        """
        speed = np.abs(v_n)
        self.gap[touching], self.since[touching], self.parting[touching] = 0.0, 0.0, speed
        needed = speed**2 / (2.0 * MIN_BOUNCE * self.radius[touching])  # to rise no higher
        needed[speed <= self.slow[touching]] = 0.0
        stays, on = needed <= self.g, None
        while on is None or not stays.all():
            touching, J, needed = touching[stays], J[stays], needed[stays]
            W = W[stays][:, stays]
            turn = self.slip(touching, J, self.v) ** 2 / self.touch_distance[touching]
            lam, on, solve = solve_lcp(W, J @ self.fall + turn)
            pushes = lam * self.inv_m_eff[touching]  # m/s^2
            stays = needed <= pushes
        if (pushes[on] <= ROUNDING * self.g).any():
            on = np.flatnonzero(pushes > ROUNDING * self.g)
            solve = np.linalg.inv(W[on[:, None], on])
        self.rests[:] = self.active[:] = False
        self.rests[touching] = self.active[touching[on]] = True
        return touching[on], J[on], solve

    def solve_contacts(self):
        """Resolve all impacts of this moment. Return the active contacts, J, and their W^-1."""
        self.separate()
        near = (self.gap <= self.closed).nonzero()[0]
        J = self.jacobian(near)
        v_n = J @ self.v
        opened = (self.parting[near] + np.abs(v_n)) * self.since[near]  # m, about the widest
        # a tiny gap is closed only if it was wider
        on = self.rests[near] & (v_n <= self.slow[near]) | (self.gap[near] <= 1e-4 * opened)
        touching, J = near[on], J[on]
        W = J * self.w @ J.T
        return self.solve_resting(touching, J, W, self.solve_impacts(touching, J, W))

    def accelerate(self, held, J, solve):
        """Return a, and whether an active contact slips; take drift out of q and v."""
        if (np.abs(self.found[held]) > 2.0 * self.bits).any():
            self.q = self.project(self.q, J, solve, J @ self.q - self.found[held])
        if (np.abs(J @ self.v) > 1e-3 * self.slow[held]).any():
            self.v = self.project(self.v, J, solve, 0.0)
        beside = J.any(0)  # what rounding leaves of v and a at rest becomes 0, or a heap creeps
        self.v[beside & (np.abs(self.v) <= ROUNDING * self.size[1])] = 0.0
        turn = self.slip(held, J, self.v) ** 2 / self.touch_distance[held]
        a = self.project(self.fall, J, solve, -turn)
        a[beside & (np.abs(a) <= ROUNDING * self.g)] = 0.0
        return a, turn.any() or self.slip(held, J, a).any()

    def expand(self, held, J, solve):
        """Return the motion from here on as a series Q in time, forces lam, how long [s] it holds,
        and of each gap: value, with its rounding, rate, bend (half the acceleration), and about
        when it closes [s].
        """
        a, slides = self.accelerate(held, J, solve)
        gap = np.maximum(self.gap, 0.0)
        rounds = np.where(self.rests, 0.5 * self.closed, np.minimum(4.0 * self.bits, 1e-9 * gap))
        d = self.apart(np.array((self.v, 0.5 * a)))
        rate, bend = (d * self.n).sum(1)
        turn = (self.n[0] * d[0, 1] - self.n[1] * d[0, 0]) ** 2 / (2.0 * self.length)
        c, curve = gap + rounds, bend + turn  # c + rate t + curve t^2 falls through 0 at soon
        square = rate * rate - 4.0 * curve * c
        root = np.sqrt(square)
        soon = np.where(rate < 0.0, 2.0 * c / (root - rate), (rate + root) / (-2.0 * curve))
        closes = (square >= 0.0) & ((rate < 0.0) | (curve < 0.0)) & ~self.active
        soon[~closes] = math.inf
        gaps = gap, rounds, rate, bend, soon
        if not slides:
            return np.array((self.q, self.v, 0.5 * a)), np.zeros((3, 0)), math.inf, gaps
        bodies = self.sides[held], self.touch_distance[held], self.floor[held]
        given, enough = (self.q, self.v, self.fall, self.w, J), 1.2 * soon.min(initial=math.inf)
        Q, lam, horizon = slide_series(*given, *bodies, solve, self.size, enough)
        lam[0] = np.maximum(lam[0], 0.0) + ROUNDING * self.g / self.inv_m_eff[held]
        return Q, lam, horizon, gaps

    def next_event(self, Q, lam, horizon, gaps):
        """Return when [s] the first gap closes or force ends, at most the horizon.

        Rounding is no event: a resting gap counts as half of TOUCH_TOLERANCE wider, another by its
        last digits. A gap falls no faster than along the normal of now; terms of Q above t^2 bend
        it by `margin` at most. So few pairs need a search. Gaps that may become tiny are tracked.
        """
        gap, rounds, rate, bend, soon = gaps
        margin = 3.0 * (horizon ** np.arange(3, len(Q)) @ np.abs(Q[3:])).max(initial=0.0)
        span, first = horizon, -1
        while first < 0 and len(soon) and soon[k := soon.argmin()] < horizon:
            t, soon[k] = first_root(self.polynomial(k, Q, gap[k], rounds[k]), span), math.inf
            span, first = (t, k) if t < span else (span, first)
        far = min(span, 1e15)
        lowest = gap + rounds - margin
        lowest += far * (np.minimum(rate, 0.0) + far * np.minimum(bend, 0.0))
        lowest[self.active] = math.inf
        near = (lowest <= 1e4 * self.closed).nonzero()[0]
        least = lam[0] + far ** np.arange(1, len(lam)) @ np.minimum(lam[1:], 0.0)
        may = near[(lowest[near] <= 0.0) & (near != first)]
        falls = [(k, self.polynomial(k, Q, gap[k], rounds[k])) for k in may]
        for k, p in falls + [(-1, lam[:, k].tolist()) for k in (least <= 0.0).nonzero()[0]]:
            t = first_root(p, span)
            span, first = (t, k) if t < span else (span, first)
        self.tracked[:] = math.inf
        self.tracked[near] = [self.track(k, Q, gap[k], span) for k in near]
        self.tracked[self.active] = 0.0
        if first >= 0:
            self.tracked[first] = 0.0
        self.since += span
        return span

    def polynomial(self, k, Q, gap, rounds):
        """A series that falls through 0 with the gap of pair k: y or d . d, less that at touch."""
        (a, b), reach = self.pairs[:, k], 2.0 * self.touch_distance[k]
        half = Q.shape[1] // 2
        y = Q[:, half + a] - Q[:, half + b]
        if self.floor[k]:
            return [float(gap + rounds), *y[1:].tolist()]
        x = Q[:, a] - Q[:, b]
        square = (np.convolve(x, x) + np.convolve(y, y))[1 : max(len(Q), 5)]
        return [float(gap * (gap + reach) + rounds * (rounds + reach)), *square.tolist()]

    def track(self, k, Q, gap, span):
        """The gap of pair k after span, without cancellation: relative to what it was."""
        rise = sum(c * span**k for k, c in enumerate(self.polynomial(k, Q, gap, 0.0)))
        reach = self.touch_distance[k]
        return rise if self.floor[k] else rise / (reach + np.sqrt(reach**2 + rise))


def first_root(p, horizon):
    """The first t <= horizon at which p[0] + p[1] t + ..., >= 0 at 0, falls through 0; else inf.

    Newton's method with the least curvature on the way to `end`, so that no step passes a root.
    It is the horizon at first, then nearer, and twice as far each time: a short way curves less.
    """
    t, end, p = 0.0, horizon, p + [0.0] * (5 - len(p))
    c, b, a = p[2], 3.0 * p[3], 6.0 * p[4]
    high, bends = p[::-1], [0.5 * k * (k - 1) * abs(p[k]) for k in range(len(p) - 1, 4, -1)]
    for _ in range(200):
        value = slope = far = 0.0
        for term in high:
            slope = slope * t + value
            value = value * t + term
        for term in bends:
            far = (far + term) * end
        bend = c + t * (b + t * a)  # half the curvature: exact for parabolas, whose end may be inf
        if a > 0.0 and t < -0.5 * b / a < end:
            bend = c - 0.25 * b * b / a
        if end < math.inf:
            bend = min(bend, c + end * (b + end * a)) - far * end * end
        step = time_to_impact(max(value, 0.0), slope, 2.0 * bend)
        if step <= 1e-15 * t:
            return t
        if t + step > end >= horizon:
            return math.inf
        t = min(t + step, end)
        end = min(max(2.0 * t, horizon / 8.0), horizon)
    return t  # next to no curvature: it is as good as there


def simulate_exact(scene, times, gravity, progress=lambda k: None, most=MAX_EVENTS) -> np.ndarray:
    """Return q, v (2, S, 2, N) [m, m/s] of a contact.Scene at `times` (S,) [s], rising from 0.

    Gravity [m/s^2] is along y, negative. At the time of an event v is that after all impacts; an
    overlap at the start is opened first, so that q at 0 may differ from the scene's.
    progress(k) is called after each event with the samples done. Raises RuntimeError beyond the
    limits, and after `most` events.
    """
    motion, times = Motion(scene, gravity), np.asarray(times)
    out = np.empty((2, len(times), len(motion.w)))
    now, done = 0.0, 0
    with np.errstate(all="ignore"), one_thread():
        for _ in range(most):
            motion.update_gaps()
            held, J, solve = motion.solve_contacts()
            Q, lam, horizon, gaps = motion.expand(held, J, solve)
            span = motion.next_event(Q, lam, horizon, gaps)
            last = int(np.searchsorted(times, now + span))
            if last > done:
                powers = np.vander(times[done:last] - now, len(Q))  # small terms first
                rates = np.arange(len(Q) - 1.0, 0.0, -1.0)[:, None] * Q[:0:-1]
                out[0, done:last] = np.einsum("sk,kn->sn", powers, Q[::-1])  # same bits at any S
                out[1, done:last] = np.einsum("sk,kn->sn", powers[:, 1:], rates)
            progress(done := last)
            if done == len(times):
                return out.reshape(2, done, 2, -1)[..., :-1]
            powers = span ** np.arange(len(Q))
            rates = powers[1:-1] * np.arange(2, len(Q))
            motion.q, motion.v = Q[0] + powers[1:] @ Q[1:], Q[1] + rates @ Q[2:]
            now += span
    why = f"{most:,} events by {now:.6g} s, as contacts close again ever sooner (Zeno behaviour)"
    raise RuntimeError(f"exact: {why}. Take a shorter run, fewer balls, or another restitution")
