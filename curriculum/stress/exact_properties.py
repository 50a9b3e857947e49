"""What exact promises: no overlap, no energy gained, every impact at its own time.

The bounds are its promises, not derived. Nothing is claimed where it promises nothing.
"""

import numpy as np

import contact
from curriculum.stress.claims import stated
from curriculum.stress.trial import G, inverse

PROMISE = 1e-12  # of a radius, and of the energy at the start
NEAR = 1e-9  # share of the sizes that a flight or an impact in closed form may be off
STEEP = 0.05  # least share of the speed that goes into an impact which is judged: others graze


@stated
def exact_never_overlaps(trial):
    """exact: no overlap at any sample above 1e-12 of the largest radius."""
    if trial.exact and struck(trial.exact).any():
        gap = contact.smallest_gap(trial.exact.q[1:], trial.scene.radius)
        yield "overlap [m]", np.maximum(-gap, 0.0), PROMISE * trial.scene.radius.max()


def struck(motion):
    """In which steps some velocity shows more than gravity (S,)."""
    return (np.abs(motion.v[1:] - motion.falling) > 1e-9).any((1, 2))


@stated
def exact_keeps_its_energy(trial):
    """exact: no energy above 1e-12 of the start's is ever gained, and with e = 1 none is lost."""
    if trial.exact and not trial.fixed.all():
        total = contact.energy(trial.exact.q, trial.exact.v, trial.scene.mass)
        size, on = PROMISE * start_energy(trial), struck(trial.exact)
        yield "gained since the start [J]", np.maximum(total[1:] - total[0], 0.0), size, on
        yield "gained in a step [J]", np.maximum(np.diff(total), 0.0), size, on
        if trial.spec["restitution"] == 1.0:
            yield "lost with e = 1 [J]", np.abs(total[1:] - total[0]), size, on


@stated
def exact_keeps_momentum_along_x(trial):
    """exact: sum m v_x stays where nothing is fixed, to 1e-12 of what the energy allows."""
    if trial.exact and not trial.fixed.any() and len(trial.mass) > 1:
        momentum = (trial.mass * trial.exact.v[:, 0]).sum(1)
        pushed = np.abs(np.diff(trial.exact.v[:, 0], axis=0)).max(1) > 0.0
        size = np.sqrt(2.0 * trial.mass.sum() * start_energy(trial))
        yield "momentum [kg m/s]", np.abs(momentum[1:] - momentum[0]), PROMISE * size, pushed


def start_energy(trial):
    """The energy [J] of the start, and at least what lifts every ball by its radius."""
    total = float(contact.energy(trial.exact.q[0], trial.exact.v[0], trial.scene.mass))
    return max(total, float((trial.mass * G * trial.scene.radius).sum()))


@stated
def exact_flies_and_bounces_in_closed_form(trial):
    """exact: a ball that nothing reaches within a step flies its parabola; one that only the table,
    or only one other ball, can reach bounces once, with e, at its own time. Impacts that graze, and
    a second one in the same step, are left out. Bound: 1e-9 of the lengths and speeds, not derived.
    """
    if not trial.exact:
        return
    motion, dt, moves = trial.exact, trial.dt, ~trial.fixed
    fast = np.sqrt((motion.v[:-1] ** 2).sum(1)) + G * dt * moves  # while nothing strikes a ball
    most = np.sqrt(2.0 * start_energy(trial) * inverse(trial.mass))  # with all the energy there is
    pairs = np.maximum(fast[:, motion.a] + most[motion.b], most[motion.a] + fast[:, motion.b])
    meets = -motion.depth <= dt * np.concatenate((fast, pairs), axis=1)
    later = -motion.depth <= dt * motion.on_contacts(most)  # when its balls have been struck
    free = (motion.on_balls(meets) == 0) & moves
    off = np.abs(motion.v[1:] - motion.falling)
    yield "flight, v [m/s]", off, NEAR * fast[:, None], free
    q = motion.q[:-1] + dt / 2.0 * (motion.v[:-1] + motion.falling)
    size = np.abs(motion.q[1:]) + dt * fast[:, None]
    yield "flight, q [m]", np.abs(motion.q[1:] - q), NEAR * size, free
    floor = meets[:, : len(moves)] & (motion.on_balls(meets)[:, 0] == 1) & moves
    yield floor_bounces(trial, motion, fast, floor)
    alone = meets & later & (motion.on_contacts(motion.on_balls(later)[:, 0]) == 2)
    alone &= motion.on_contacts(1.0 * moves) == 2
    yield from pair_bounces(trial, motion, fast, alone[:, len(moves) :])


def floor_bounces(trial, motion, fast, floor):
    """The claim on balls that bounce off the table alone, and once in a step."""
    vx, vy = motion.v[:-1].swapaxes(0, 1)
    height = -motion.depth[:, : len(trial.mass)]
    speed = np.sqrt(vy * vy + 2.0 * G * np.maximum(height, 0.0))  # at the impact
    s, back = (vy + speed) / G, trial.spec["restitution"] * speed
    steep = within(s, trial.dt) & (speed > STEEP * fast)
    once = floor & steep & (s + 2.0 * back / G > trial.dt)
    off = np.abs(motion.v[1:] - np.stack((vx, back - G * (trial.dt - s)), axis=1))
    return "bounce off the table [m/s]", off, NEAR / STEEP * fast[:, None], once[:, None]


def pair_bounces(trial, motion, fast, alone):
    """The claims on either of two balls that strike each other alone."""
    a, b, weight = motion.a, motion.b, inverse(trial.mass)
    reach = trial.scene.radius[a] + trial.scene.radius[b]
    d, u = (each[:-1, :, a] - each[:-1, :, b] for each in (motion.q, motion.v))
    uu, du, dd = (u * u).sum(1), (d * u).sum(1), (d * d).sum(1) - reach**2
    square = du * du - uu * dd
    s = dd / (-du + np.sqrt(square))
    steep = (du < 0.0) & (square > STEEP * STEEP * uu * reach**2) & within(s, trial.dt)
    n = (d + s[:, None] * u) / reach
    change = -(1 + trial.spec["restitution"]) * (u * n).sum(1) / (weight[a] + weight[b])
    allowed = NEAR / STEEP * np.maximum(fast[:, a], fast[:, b])
    for ball, side in ((a, 1.0), (b, -1.0)):
        v = motion.falling[:, :, ball] + side * weight[ball] * change[:, None] * n
        off = np.abs(motion.v[1:, :, ball] - v)
        yield "impact of two [m/s]", off, allowed[:, None], (alone & steep)[:, None]


def within(s, dt):
    """Whether a moment s [s] is clearly inside of a step."""
    return (1e-6 * dt < s) & (s < (1 - 1e-6) * dt)
