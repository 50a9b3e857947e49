"""The chapter's laws in formulas of their own, and a solver that is not contact.py's.

motion: a Trajectory, whose S steps, N balls and C contacts the arrays are of.
"""

import numpy as np

import contact
from curriculum.stress.trial import G, U, inverse

HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # the impedance of soft where it bounces
MUJOCO = (0.9, 0.95, 0.001, 0.5, 2.0), (0.02, 1.0)  # and where it does not, with its spring
STEEP = 0.05  # least share of the speed that goes into an impact which is judged: others graze
SETTLED, SWEEPS = 2.0**-42, 10_000  # soft: what its last sweep may still change; sweeps at most


def spring_force(trial, motion):
    """The force of every contact (S, C) [N]; what rounding leaves in momenta (S, 2, N) [kg m/s]."""
    k, c = trial.spec["stiffness"], trial.spec["damping"]
    force = np.where(motion.listed, np.maximum(0.0, k * motion.depth - c * motion.before), 0.0)
    size = motion.listed * motion.dt * (k * motion.lengths + c * motion.speeds + 2 * force)
    return force, 8 * U * (motion.on_balls(size) + (motion.count + 2) * motion.size)


def lcp_target(motion, spec):
    """The v_n that each contact may leave with at least: the chapter's rule, in its own words."""
    e, beta, ahead = spec["restitution"], spec["baumgarte"], spec["ahead"]
    close, bounce = motion.depth / motion.dt, -e * motion.before
    bias = beta * close
    if e == 0.0:
        return np.where(ahead & (close < 0.0), close, bias)
    arrives = motion.dt * motion.before <= motion.depth
    across = np.where(arrives, bounce, np.minimum(bounce, close))
    return np.where(bias > 0.0, np.maximum(bias, bounce), across)


def directions(motion, k, on):
    """What a push of 1 N s at each contact `on` adds to the momenta in step k (2 N, contacts)."""
    given = motion.sides[on] * (motion.mass > 0.0)
    each = motion.normal[k][:, on, None] * given
    return each.transpose(0, 2, 1).reshape(2 * len(motion.mass), on.sum())


def far_from_singular(n, mass):
    """Whether W of these contacts, scaled to a diagonal of 1, has no eigenvalue below 1e-3."""
    weighted = n * np.tile(np.sqrt(inverse(mass)), 2)[:, None]
    W = weighted.T @ weighted
    scale = np.sqrt(W.diagonal())
    return np.linalg.eigvalsh(W / scale / scale[:, None])[0] > 1e-3


def nearest(n, least, v, mass):
    """The velocities (2 N,) with n . v >= least (K,) that are nearest to v in the norm of the
    masses: what impulses do, of which none pulls (Moreau 1988). By least squares, as Lawson and
    Hanson's LDP: with A = M^(-1/2) n, the lam >= 0 that best brings A lam to 0 and missing . lam
    to 1, tells who pushes. These reach their least by the smallest change, to the last digits.
    """
    from scipy.optimize import nnls  # slow, so only where it is needed

    weight = np.tile(np.sqrt(inverse(mass)), 2)
    A, missing = n * weight[:, None], least - n.T @ v
    unit = np.sqrt((A * A).sum(0))
    most = np.abs(missing / unit).max(initial=0.0)
    if (missing <= 0.0).all():
        return v
    rows, ends = np.vstack((A, missing / most)) / unit, np.append(0.0 * v, 1.0)
    pushes = nnls(rows, ends)[0] > 0.0
    return v + weight * np.linalg.lstsq(A[:, pushes].T, missing[pushes], rcond=None)[0]


def rises(run, motion, e):
    """(rise of F beyond the law, the energies) of every step of a run, by the motion's masses."""
    first, last, D = run.v[:-1], run.v[1:], np.diff(run.v, axis=0)
    before, after, D2 = (0.5 * (motion.mass * v * v).sum((1, 2)) for v in (first, last, D))
    lead = e / (1 + e) * motion.dt * -G * (motion.mass * D[:, 1]).sum(1)
    moved = motion.dt * G * (motion.mass * last[:, 1]).sum(1)
    rise = after - before + moved + lead + (1 - e) / (1 + e) * D2
    size = before + (motion.mass * G * np.abs(run.q[:-1, 1])).sum(1)
    return rise, np.maximum(size, after)


def soft_law(motion, e, solref):
    """(target [m/s], softness R [1/kg]) of every contact, by MuJoCo's formulas."""
    bounces = e > 0.0 and solref is None
    d0, d1, width, mid, power = HARD if bounces else MUJOCO[0]
    T, damping = solref or MUJOCO[1]
    x = np.clip(motion.depth / width, 0.0, 1.0)
    low, high = x**power / mid ** (power - 1), 1 - (1 - x) ** power / (1 - mid) ** (power - 1)
    y = np.where(x <= mid, low, high)
    d = d0 + y * (d1 - d0)
    T = max(T, 2 * motion.dt)
    K, B = (0.0, (1 + e) / motion.dt / d1) if bounces else ((d1 * T * damping) ** -2, 2 / (d1 * T))
    a_ref = K * d * motion.depth - B * motion.before
    return motion.before + motion.dt * a_ref, (1 - d) / d * motion.inv_mass


def soft_force(trial, motion):
    """The impulse of every contact (S, C) [N s], and what settled sweeps and rounding may leave in
    the momenta (S, 2, N) [kg m/s].
    """
    target, R = soft_law(motion, trial.spec["restitution"], trial.spec["solref"])
    lam = np.where(motion.listed, np.maximum(0.0, (target - motion.after) / R), 0.0)
    size = np.where(motion.listed, np.abs(target) + motion.speeds, 0.0).max(1, keepdims=True)
    left = (SETTLED + 16 * U) * (motion.listed.sum(1, keepdims=True) + 1) * size
    own = motion.on_balls(np.where(motion.listed, left / R, 0.0))
    return lam, own + 8 * U * (motion.count * SWEEPS + 4) * motion.size


def start_energy(trial):
    """The energy [J] of the start, and at least what lifts every ball by its radius."""
    total = float(contact.energy(trial.exact.q[0], trial.exact.v[0], trial.scene.mass))
    return max(total, float((trial.mass * G * trial.scene.radius).sum()))


def only_impacts(trial, fast, alone):
    """The impulses (S, C) [N s] of contacts that close alone, 0 of those that graze or that are not
    clearly once in the step, and their normals (S, 2, C).

    A ball falls on the table; two balls fall alike, so one comes to the other on a straight line.
    """
    motion, dt, e = trial.exact, trial.dt, trial.spec["restitution"]
    d, u = (each[:-1] @ motion.sides.T for each in (motion.q, motion.v))
    uu, du = (u * u).sum(1), (d * u).sum(1)
    gap = (d * d).sum(1) - motion.reach**2
    closing = np.sqrt(du * du - uu * gap) / motion.reach
    s = gap / (motion.reach * closing - du)
    landing = np.sqrt(u[:, 1] ** 2 - 2.0 * G * np.minimum(motion.depth, 0.0))
    table = np.arange(alone.shape[1]) < len(trial.mass)
    closing, s = np.where(table, (landing, (u[:, 1] + landing) / G), (closing, s))
    n = np.where(table, [[0.0], [1.0]], (d + s[:, None] * u) / motion.reach)
    once = alone & (1e-6 * dt < s) & (s < (1 - 1e-6) * dt)
    once &= ~table | (s + 2.0 * e * closing / G > dt)
    once &= closing > STEEP * np.where(table, motion.on_contacts(fast), np.sqrt(uu))
    pushes = (1 + e) * closing / motion.inv_mass
    return np.where(once, pushes, 0.0), np.where(once[:, None], n, 0.0)
