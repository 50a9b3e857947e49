"""A tower of balls on the floor in many digits: what `exact` is held to where masses are unequal.

Nothing is taken from exact.py. Contact k is between ball k and the one below it (k = 0: the floor),
and its gap is a number of its own, so that it keeps its digits however small it is. Impulses and
forces are linear complementarity problems, solved by enumeration of active sets in Murty's order
(least index first), which ends for the positive definite matrices of a tower. The law is Newton's
for all touching contacts at once. Two cuts are left: a bounce slower than SLOW, or of a contact that
opened less than THIN since it last closed, is none. They have to be so small because a tower
remembers: two balls that part at 1e-22 m/s and two that do not are struck one after the other, or at
once, and that is not the same (with SLOW 1e-22 and THIN 1e-80 one tower of 120 came out otherwise).
"""

import itertools

import numpy as np
from mpmath import mp, mpf, sqrt

DIGITS = 120
SLOW = mpf(10) ** -40  # m/s
OF_DOUBLES = mpf(10) ** -12  # m/s: slower than this is round-off to a double
THIN = mpf(10) ** -80  # m
WIDE = mpf(10) ** -76  # m: THIN for a contact that was open while another was found to be THIN
SAME = mpf(10) ** -100  # m, m/s: round-off


def complementary(diagonal, beside, b):
    """lam >= 0 with w = W lam + b >= 0, lam w = 0; W tridiagonal, `beside` its off-diagonal.

    Murty (1974): exchange the least index that is wrong; each active set is met at most once.
    """
    active = [True] * len(b)
    size = max((abs(x) for x in b), default=mpf(0)) * SAME
    for _ in itertools.count():
        lam = restricted(diagonal, beside, b, active)
        wrong = None
        for k in range(len(b)):
            w = b[k] + diagonal[k] * lam[k]
            w += beside[k] * lam[k + 1] if k + 1 < len(b) else 0
            w += beside[k - 1] * lam[k - 1] if k else 0
            if (lam[k] < -size / diagonal[k]) if active[k] else (w < -size):
                wrong = k
                break
        if wrong is None:
            return [max(value, mpf(0)) for value in lam]
        active[wrong] = not active[wrong]


def restricted(diagonal, beside, b, active):
    """lam with W lam + b = 0 at the active contacts and lam = 0 at the others: elimination."""
    lam, pivot, right = [mpf(0)] * len(b), [None] * len(b), [None] * len(b)
    for k in range(len(b)):
        if active[k]:
            pivot[k], right[k] = diagonal[k], -b[k]
            if k and active[k - 1]:
                factor = beside[k - 1] / pivot[k - 1]
                pivot[k] -= factor * beside[k - 1]
                right[k] -= factor * right[k - 1]
    for k in reversed(range(len(b))):
        if active[k]:
            above = beside[k] * lam[k + 1] if k + 1 < len(b) and active[k + 1] else 0
            lam[k] = (right[k] - above) / pivot[k]
    return lam


class Tower:
    """gap, v_n (N,) of the contacts; w = 1 / mass, with the floor's 0 below."""

    def __init__(self, y, v, mass, radius, restitution, gravity, slow):
        y, v, r = ([mpf(float(x)) for x in row] for row in (y, v, radius))
        self.w = [mpf(0)] + [1 / mpf(float(m)) for m in mass]
        self.e, self.g, self.r = mpf(float(restitution)), mpf(float(gravity)), r
        under = [mpf(0)] + [a + b for a, b in zip(y, r)]
        self.gap = [a - b - c for a, b, c in zip(y, r, under)]
        self.gap = [mpf(0) if x < mpf(10) ** -13 else x for x in self.gap]
        self.v, self.slow = v, slow
        self.opened = [mp.inf] * len(y)
        self.left = [-mp.inf] * len(y)  # when it touched last
        self.stopped = -mp.inf  # when a contact that had hardly opened closed last
        self.events, self.now = 0, mpf(0)

    def solve(self, contacts, b):
        """lam of the touching `contacts` (rising), and its change of the balls' rates."""
        w, change = self.w, [mpf(0)] * len(self.v)
        lam = []
        for run in runs(contacts):
            part = [b[contacts.index(k)] for k in run]
            lam += complementary([w[k + 1] + w[k] for k in run], [-w[k + 1] for k in run], part)
        for k, push in zip(contacts, lam):
            change[k] += w[k + 1] * push
            if k:
                change[k - 1] -= w[k] * push
        return lam, change

    def closing(self):
        """v_n (N,)"""
        return [a - b for a, b in zip(self.v, [mpf(0)] + self.v)]

    def settle(self):
        """Impulses until nothing closes, then the accelerations; returns a_n (N,) and a (N,)."""
        touching = [k for k, gap in enumerate(self.gap) if gap == 0]
        while min((self.closing()[k] for k in touching), default=0) < -SAME:
            v_n, bounce = self.closing(), []
            for k in touching:
                wide = WIDE if self.stopped > self.left[k] else THIN
                thin = self.opened[k] < wide
                if thin and v_n[k] < -SAME:
                    self.stopped = self.now
                stops = self.e * abs(v_n[k]) < self.slow or thin
                bounce.append(mpf(0) if stops else -self.e * v_n[k])
            _, change = self.solve(touching, [v_n[k] - x for k, x in zip(touching, bounce)])
            self.v = [a + b for a, b in zip(self.v, change)]
            for k in touching:
                self.opened[k] = mp.inf if self.closing()[k] < -SAME else mpf(0)
        for k in touching:
            self.opened[k] = mpf(0) if self.opened[k] != mp.inf else mp.inf
            self.left[k] = self.now
        v_n = self.closing()
        rests = [k for k in touching if abs(v_n[k]) <= self.slow]
        free = [self.g if k == 0 else mpf(0) for k in rests]
        lam, change = self.solve(rests, free)
        a = [self.g + x for x in change]
        return [x - y for x, y in zip(a, [mpf(0)] + a)], a, rests

    def advance(self, times):
        """Heights (S, N) at `times`, as doubles."""
        now, out = mpf(0), []
        for goal in map(mpf, map(float, times)):
            while True:
                a_n, a, rests = self.settle()
                v_n = self.closing()
                held = [k for k in rests if abs(a_n[k]) <= SAME]
                due = [
                    mp.inf if k in held else first_root(self.gap[k], v_n[k], a_n[k] / 2)
                    for k in range(len(self.v))
                ]
                soonest = min(due)
                span = min(soonest, goal - now)
                for k in range(len(self.v)):
                    if k in held:
                        self.opened[k] = mpf(0)
                        continue
                    self.opened[k] += abs(v_n[k]) * span + abs(a_n[k]) * span * span
                    self.gap[k] += v_n[k] * span + a_n[k] * span * span / 2
                    if due[k] <= span * (1 + SAME) or self.gap[k] < SAME:
                        self.gap[k] = mpf(0)
                self.v = [x + span * y for x, y in zip(self.v, a)]
                now += span
                self.now = now
                self.events += 1
                if soonest > span or now >= goal:
                    break
            out.append(self.heights())
        return np.array(out)

    def heights(self):
        """The centres [m] as doubles."""
        y, under = [], mpf(0)
        for gap, r in zip(self.gap, self.r):
            y.append(under + gap + r)
            under = y[-1] + r
        return [float(x) for x in y]


def runs(contacts):
    """Rising numbers split into runs of neighbours: only these act on each other."""
    out = []
    for k in contacts:
        if out and out[-1][-1] == k - 1:
            out[-1].append(k)
        else:
            out.append([k])
    return out


def first_root(c, b, a):
    """The first t > 0 at which a t^2 + b t + c falls through zero; c >= 0."""
    if c == 0 and (b > 0 or (b == 0 and a >= 0)):
        return -b / a if a < 0 else mp.inf
    root = b * b - 4 * a * c
    if root < 0:
        return mp.inf
    if b < 0:
        return 2 * c / (-b + sqrt(root))
    return (-b - sqrt(root)) / (2 * a) if a < 0 else mp.inf


def heights(y, v, mass, radius, restitution, gravity, times, slow=SLOW):
    """Heights (S, N) [m] of a tower at `times`, right to the last digit of a double."""
    with mp.workdps(DIGITS):
        return Tower(y, v, mass, radius, restitution, gravity, slow).advance(times)
