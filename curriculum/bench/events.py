"""The rival that goes from event to event: scipy's solve_ivp over a loop of contacts.

As a scientist would write it, and independent of contact.py and exact.py: between two events some
contacts hold, and the accelerations follow from one linear system, which DOP853 integrates. A gap
that closes or a force that falls to zero is an event, found on the dense output. There, a
non-negative least squares gives the impulses of all that touch (Newton's law), and another one
tells which contacts hold from there on. It is the witness of every reference of the contest.
Beyond PHASES events, or where the integrator stops, it gives up: the balls stay where they are.
"""

import itertools

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import nnls

TOUCH, NUDGE = 1e-10, 1e-14  # m: closed; what a gap begins with, since an event starts above 0
SLOW, STILL, WEAK = 3e-6, 1e-7, 1e-9  # m/s, m/s, m/s^2: bounces no more, holds, needs no push
PHASES = 2000


class World:
    """Balls as flat arrays (x0, y0, x1, y1, ...), the floor as the last one, at (0, 0) for ever."""

    def __init__(self, scene, gravity):
        mass = np.append(scene.mass, np.inf)
        pairs = itertools.combinations(range(len(mass)), 2)
        self.a, self.b = np.array([(a, b) for a, b in pairs if np.isfinite(mass[[a, b]]).any()]).T
        self.floor = self.b == len(scene.mass)
        self.w, self.e = np.repeat(1.0 / mass, 2), scene.restitution
        self.reach = scene.radius[self.a] + np.append(scene.radius, 0.0)[self.b]
        self.g = np.where(np.arange(2 * len(mass)) % 2, -gravity, 0.0) * (self.w > 0.0)

    def apart(self, x, which):
        """Return x of ball a less x of ball b (K, 2); of the floor only what is vertical counts."""
        x = x.reshape(-1, 2)
        d = x[self.a[which]] - x[self.b[which]]
        d[self.floor[which], 0] = 0.0
        return d

    def length(self, d, which):
        """Return the length of d; of contacts with the floor signed, negative below it."""
        return np.where(self.floor[which], d[:, 1], np.hypot(d[:, 0], d[:, 1]))

    def gaps(self, q, which=slice(None)):
        return self.length(self.apart(q, which), which) - self.reach[which]

    def system(self, q, v, which):
        """Return J, W, and the accelerations of the gaps of these contacts without any push."""
        d, dv = self.apart(q, which), self.apart(v, which)
        length, k = self.length(d, which), np.arange(len(d))
        n = d / length[:, None]
        J = np.zeros((len(d), len(self.w) // 2, 2))
        J[k, self.a[which]], J[k, self.b[which]] = n, -n
        J = J.reshape(len(d), -1)
        turn = ((dv**2).sum(1) - (J @ v) ** 2) / length * ~self.floor[which]
        return J, (J * self.w) @ J.T, J @ self.g + turn

    def phase(self, t, end, y, holding, rtol, longest):
        """Return the motion while these contacts hold, until an event or the end."""
        half, others = len(y) // 2, np.setdiff1d(np.arange(len(self.a)), holding)
        start = np.minimum(self.gaps(y[:half], others), 0.0) - NUDGE

        def pushed(y):
            if not len(holding):
                return np.ones(1), self.g
            J, W, free = self.system(y[:half], y[half:], holding)
            lam = -np.linalg.solve(W, free)
            return lam, self.g + self.w * (lam @ J)

        def slope(t, y):
            return np.append(y[half:], pushed(y)[1])

        def closes(t, y):
            return (self.gaps(y[:half], others) - start).min(initial=1.0)

        def parts(t, y):
            return pushed(y)[0].min(initial=1.0)

        closes.terminal = parts.terminal = True
        closes.direction = parts.direction = -1.0
        how = dict(rtol=rtol, atol=1e-2 * rtol, max_step=longest, dense_output=True)
        return solve_ivp(slope, (t, end), y, "DOP853", events=(closes, parts), **how)

    def strike(self, q, v):
        """Return the velocities after all simultaneous impacts, and the contacts that hold then."""
        touching = np.flatnonzero(self.gaps(q) < TOUCH)
        if not len(touching):
            return v, touching
        J, W, free = self.system(q, v, touching)
        before = J @ v
        if before.min() < 0.0:
            back = np.where((before < 0.0) & (before > -SLOW), 0.0, self.e * before)
            v = v + self.w * (pushes(W, before + back) @ J)
        still = np.flatnonzero(np.abs(J @ v) < STILL)
        needed = pushes(W[np.ix_(still, still)], free[still]) * W.diagonal()[still] > WEAK
        hold = still[needed]
        if len(hold):  # they open and close no more: a ball between two would rattle for ever
            v = v - self.w * (np.linalg.solve(W[np.ix_(hold, hold)], J[hold] @ v) @ J[hold])
        return v, touching[hold]


def pushes(W, free):
    """Return lam >= 0 with W lam + free >= 0, one of the two 0 for each contact."""
    if not len(free):
        return free
    root = np.linalg.cholesky(W + 1e-15 * np.trace(W) * np.eye(len(W)))
    return nnls(root.T, -np.linalg.solve(root, free))[0]


def run(scene, times, gravity, rtol=1e-12, longest=0.01):
    """Return q and v (T, 2, N) at these times. longest [s]: of a step, so that no gap is missed."""
    world, rows, t = World(scene, gravity), [], 0.0
    y = np.concatenate([np.append(part.T.ravel(), (0.0, 0.0)) for part in (scene.q0, scene.v0)])
    for _ in range(PHASES):
        q, v = np.split(y, 2)
        v, holding = world.strike(q, v)
        found = world.phase(t, times[-1], np.append(q, v), holding, rtol, longest)
        inside = times[len(rows) :][times[len(rows) :] <= found.t[-1]]
        rows += list(found.sol(inside).T) if len(inside) else []
        t, y = found.t[-1], found.y[:, -1]
        if t >= times[-1] or found.status < 0:
            break
    rows += [y] * (len(times) - len(rows))
    return np.array(rows).reshape(len(times), 2, -1, 2).transpose(1, 0, 3, 2)[..., :-1]
