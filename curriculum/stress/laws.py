"""The chapter's laws in formulas of their own, and a solver that is not contact.py's.

motion: a Trajectory, whose S steps, N balls and C contacts the arrays are of.
"""

import numpy as np

import contact
from curriculum.stress.trial import G, U, inverse

SWEEPS = 10_000  # of soft, at most


def spring_force(trial, motion):
    """The force of every contact (S, C) [N]; what rounding leaves in momenta (S, 2, N) [kg m/s]."""
    k, c = trial.spec["stiffness"], trial.spec["damping"]
    force = np.where(motion.listed, np.maximum(0.0, k * motion.depth - c * motion.before), 0.0)
    size = motion.listed * motion.dt * (k * motion.lengths + c * motion.speeds + 2 * force)
    return force, 8 * U * (motion.on_balls(size) + (motion.count + 2) * motion.size)


def lcp_target(motion, spec):
    """The v_n that each contact may leave with at least: the chapter's rule, in its own words."""
    e, beta = spec["restitution"], spec["baumgarte"]
    close, bounce = motion.depth / motion.dt, -e * motion.before
    bias = beta * close
    if e == 0.0:
        return bias
    arrives = motion.dt * motion.before <= motion.depth
    across = np.where(arrives, bounce, np.minimum(bounce, close))
    return np.where(bias > 0.0, np.maximum(bias, bounce), across)


def directions(motion, normal, on):
    """What a push of 1 N s at each contact `on` along its normal (2, C) adds to all momenta
    (2 N, contacts)."""
    each = normal[:, on, None] * motion.sides[on] * (motion.mass > 0.0)
    return each.transpose(0, 2, 1).reshape(2 * len(motion.mass), on.sum())


def meeting(motion, k):
    """The normals (2, C) of when two balls meet in flight after state k or, if they miss, are
    nearest: leapfrog's, in the same operations, since a root may lose half of its digits."""
    a, b, normal = motion.a, motion.b, motion.normals[k].copy()
    (dx, dy), (vx, vy) = (row[k][:, a] - row[k][:, b] for row in (motion.q, motion.v))
    reach = motion.reach[-len(a) :] if len(a) else 0.0
    along, fast = dx * vx + dy * vy, vx * vx + vy * vy
    apart = dx * dx + dy * dy - reach * reach
    t = (-along - np.sqrt(np.maximum(0.0, along * along - fast * apart))) / fast
    t = np.where((apart > 0.0) & (along < 0.0), np.minimum(motion.dt, t), 0.0)
    x, y = dx + t * vx, dy + t * vy
    of_pairs, distance = normal[:, len(motion.mass) :], np.sqrt(x * x + y * y)
    np.copyto(of_pairs, np.array((x, y)) / distance, where=distance > 0.0)
    return normal


def unexplained(given, n, size):
    """How far momenta (2, N) are from any sum of the columns of n (2 N, .) that takes none less
    than 0 times; size (N,): of each ball, in which that is counted."""
    from scipy.optimize import nnls  # slow, so only where it is needed

    weight = np.tile(inverse(size), 2)
    rows = n * weight[:, None]
    unit = np.sqrt((rows * rows).sum(0))
    rows = rows[:, unit > 0.0] / unit[unit > 0.0]
    return nnls(rows, given.ravel() * weight, maxiter=100 * len(weight))[1]


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


def start_energy(trial):
    """The energy [J] of the start, and at least what lifts every ball by its radius."""
    total = float(contact.energy(trial.exact.q[0], trial.exact.v[0], trial.scene.mass))
    return max(total, float((trial.mass * G * trial.scene.radius).sum()))
