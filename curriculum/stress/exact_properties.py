"""What exact promises: no overlap, no energy gained, every impact at its own time.

The bounds are its promises, not derived. Nothing is claimed where it promises nothing.
"""

import numpy as np

import contact
from curriculum.stress.claims import chosen, stated
from curriculum.stress.trial import G, inverse

PROMISE = 1e-12  # of a radius, and of the energy at the start
NEAR = 1e-9  # share of the sizes that a flight or an impact in closed form may be off
STEEP = 0.05  # least share of the speed that goes into an impact which is judged: others graze


@stated
def exact_never_overlaps(trial):
    """exact: no overlap at any sample above 1e-12 of the largest radius."""
    if trial.exact and struck(trial).any():
        gap = contact.smallest_gap(trial.exact.q[1:], trial.scene.radius)
        yield "overlap [m]", np.maximum(-gap, 0.0), PROMISE * trial.scene.radius.max()


def struck(trial):
    """In which steps of exact some velocity shows more than gravity (S,)."""
    unexplained = np.diff(trial.exact.v, axis=0) + trial.dt * gravity(trial)
    return (np.abs(unexplained) > 1e-9).any((1, 2))


@stated
def exact_keeps_its_energy(trial):
    """exact: no energy above 1e-12 of the start's is ever gained, and with e = 1 none is lost."""
    if not trial.exact or trial.fixed.all():
        return
    run, e = trial.exact, trial.spec["restitution"]
    total = contact.energy(run.q, run.v, trial.scene.mass)
    size = PROMISE * start_energy(trial)
    on = struck(trial)
    yield "gained since the start [J]", np.maximum(total[1:] - total[0], 0.0)[on], size
    yield "gained in a step [J]", np.maximum(np.diff(total), 0.0)[on], size
    if e == 1.0:
        yield "lost with e = 1 [J]", np.abs(total[1:] - total[0])[on], size


@stated
def exact_keeps_momentum_along_x(trial):
    """exact: sum m v_x stays where nothing is fixed, to 1e-12 of what the energy allows."""
    if trial.exact and not trial.fixed.any() and len(trial.mass) > 1:
        momentum = (trial.mass * trial.exact.v[:, 0]).sum(1)
        pushed = np.abs(np.diff(trial.exact.v[:, 0], axis=0)).max(1) > 0.0
        size = np.sqrt(2.0 * trial.mass.sum() * start_energy(trial))
        yield "momentum [kg m/s]", np.abs(momentum[1:] - momentum[0])[pushed], PROMISE * size


@stated
def exact_flies_and_bounces_in_closed_form(trial):
    """exact: a ball that nothing reaches within a step flies its parabola; one that only the table,
    or only one other ball, can reach bounces once, with e, at its own time. Impacts that graze, and
    a second one in the same step, are left out. Bound: 1e-9 of the lengths and speeds, not derived.
    """
    if not trial.exact:
        return
    run, near = trial.exact, Neighbours(trial)
    size = near.fast[:, None] + np.zeros_like(run.v[1:])
    q, v = near.flown(trial.dt)
    free = np.broadcast_to(near.free[:, None], v.shape)
    yield "flight, v [m/s]", *chosen(free, np.abs(run.v[1:] - v), NEAR * size)
    lengths = np.abs(run.q[1:]) + trial.dt * size
    yield "flight, q [m]", *chosen(free, np.abs(run.q[1:] - q), NEAR * lengths)
    for words, k, balls, v in [*floor_bounces(trial, near), *pair_bounces(trial, near)]:
        allowed = NEAR * near.fast[k].max() / STEEP
        yield f"{words}, step {k} [m/s]", np.abs(run.v[k + 1][:, balls] - v), allowed


class Neighbours:
    """Who can reach whom between two samples of exact.

    fast (S, N): the fastest a ball can be while nothing strikes it; with all the energy there is it
    has `most`. free: nothing reaches it. floor (S, N): only the floor can. pair (S, P): of the
    pairs (a, b), those two that can meet each other and nothing else.
    """

    def __init__(self, trial):
        run, r, dt, moves = trial.exact, trial.scene.radius, trial.dt, ~trial.fixed
        self.run, self.fall = run, gravity(trial)
        self.a, self.b = a, b = np.triu_indices(len(r), 1)
        self.fast = fast = np.sqrt((run.v[:-1] ** 2).sum(1)) + G * dt * moves
        most = np.sqrt(2.0 * start_energy(trial) * inverse(trial.mass))
        apart = run.q[:-1][:, :, a] - run.q[:-1][:, :, b]
        gap, height = np.hypot(apart[:, 0], apart[:, 1]) - r[a] - r[b], run.q[:-1, 1] - r
        ends = np.eye(len(r))[a] + np.eye(len(r))[b]  # which balls make a pair (P, N)
        meets = gap <= dt * np.maximum(fast[:, a] + most[b], most[a] + fast[:, b])
        struck = gap <= dt * (most[a] + most[b])  # when both have been struck
        self.free = (meets @ ends == 0) & (height > dt * fast) & moves
        self.floor = (meets @ ends == 0) & (height <= dt * fast) & moves
        airborne = (height > dt * most) & moves
        self.pair = meets & airborne[:, a] & airborne[:, b] & (struck @ ends @ ends.T == 2)

    def flown(self, s):
        """q, v (S, 2, N) after `s` seconds of free flight from each sample."""
        q, v = self.run.q[:-1], self.run.v[:-1]
        return q + s * v - 0.5 * s * s * self.fall, v - s * self.fall


def floor_bounces(trial, near):
    """(words, step, ball, v (2,) after it) where a ball bounces off the table once and alone."""
    e, dt, r = trial.spec["restitution"], trial.dt, trial.scene.radius
    for k, ball in np.argwhere(near.floor):
        gap = near.run.q[k, 1, ball] - r[ball]
        vx, vy = near.run.v[k, :, ball]
        speed = np.sqrt(vy * vy + 2.0 * G * max(gap, 0.0))  # at the impact
        s = (vy + speed) / G
        back = e * speed
        rests = s + 2.0 * back / G  # comes down again
        if 1e-6 * dt < s < (1 - 1e-6) * dt and rests > dt and speed > STEEP * near.fast[k, ball]:
            yield "bounce off the table", k, ball, np.array((vx, back - G * (dt - s)))


def pair_bounces(trial, near):
    """(words, step, balls, v (2, 2) after it) where two balls strike each other alone."""
    e, dt, r = trial.spec["restitution"], trial.dt, trial.scene.radius
    weight = inverse(trial.mass)
    for k, pair in np.argwhere(near.pair):
        a, b = balls = [near.a[pair], near.b[pair]]
        (d, u) = (each[k][:, a] - each[k][:, b] for each in (near.run.q, near.run.v))
        uu, du, dd = u @ u, d @ u, d @ d - (r[a] + r[b]) ** 2
        square = du * du - uu * dd
        if du >= 0.0 or square <= (STEEP * STEEP) * uu * (r[a] + r[b]) ** 2:
            continue
        s = dd / (-du + np.sqrt(square))
        if 1e-6 * dt < s < (1 - 1e-6) * dt:
            n = (d + s * u) / (r[a] + r[b])
            impulse = -(1 + e) * (u @ n) / (weight[a] + weight[b])
            change = impulse * np.outer(n, (weight[a], -weight[b]))
            yield "impact of two", k, balls, near.flown(dt)[1][k][:, balls] + change


def gravity(trial):
    """What gravity takes from each velocity in a second (2, N); nothing from a fixed ball."""
    return np.outer((0.0, G), ~trial.fixed)


def start_energy(trial):
    """The energy [J] of the start, and at least what lifts every ball by its radius."""
    total = float(contact.energy(trial.exact.q[0], trial.exact.v[0], trial.scene.mass))
    return max(total, float((trial.mass * G * trial.scene.radius).sum()))
