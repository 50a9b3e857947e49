"""Contact between bodies, built three times and measured honestly (robotics course, chapter 3.5).

A table pushes a ball up while they touch and never pulls it down. Three models of that push:
    penalty   a stiff spring and a damper: simple; it sinks, rings, and explodes past a critical dt
    lcp       impulses from a complementarity problem, by projected Gauss-Seidel, step by step
    exact     event to event: each impact at its own time, impulses and resting forces by a pivot
Left out: friction, rotation, and all shapes but balls over the line y = 0.

    symbol    meaning                              unit    sign
    q, v      positions, velocities; x, y = q      m, m/s  y is up
    gap       distance of two surfaces             m       > 0 apart
    depth     -gap                                 m       > 0 overlapping
    n         normal of a contact, a unit vector   -       from j to i; the floor is j = -1
    v_n       n . (v_i - v_j)                      m/s     > 0 separating
    f_n, lam  contact force, contact impulse       N, N s  >= 0: a contact only pushes
    k, c      penalty stiffness, damping           N/m, N s/m
    e, beta   restitution, Baumgarte gain          -       0 to 1

q and v are two rows of N numbers, shape (2, N). Inside a step a row is a list of floats for a few
balls, an array for many: the same lines compute both, to the same bits.

    python contact.py --scene drop                      # then: bounce, stack, pile
    python contact.py --contact penalty --dt 0.03       # past the critical time step
    python contact.py --smoke --no-rerun                # fixed length, the same bytes every time
"""

# --- region: setup ---
import argparse
import functools
import math
import operator
import os
import sys
from typing import NamedTuple

import numpy as np

from curriculum.common import arguments, device, memory, neighbours, progress, results

GRAVITY = -9.81         # m/s^2, along y
RADIUS = 0.1            # m, of every ball in the scenes; penetration is told in units of it
CONTACT_MARGIN = 1e-3   # m: lcp lists a contact this far before it touches, so resting ones stay
FEW = 12                # balls: up to here floats over all pairs are faster than arrays over near ones
EXPLODED = 10.0         # gaining more than this times the start energy is an explosion
DT_GRID = (1, 2, 4, 8, 16, 32)      # multiples of --dt that the stability line tries
SCENES = ("drop", "bounce", "stack", "pile")
MODELS = ("penalty", "lcp", "exact")
COLORS = {"penalty": "#d55e00", "lcp": "#0072b2", "exact": "#009e73"}   # told apart by all eyes


def parse_flags(argv):
    """The checked command line. Bad input: one line on stderr, exit status 2, nothing written."""
    parser = arguments.Parser(prog="contact.py", description=__doc__.split("\n")[0])
    flag, number, switch = parser.add_argument, arguments.number, argparse.BooleanOptionalAction
    flag("--seed", type=number(int, low=0), default=0, help="draws the start height (0)")
    flag("--scene", choices=SCENES, default="drop")
    flag("--contact", choices=("all", *MODELS), default="all")
    flag("--stiffness", type=number(float, low=0), default=1e4, help="k of penalty [N/m] (1e4)")
    flag("--damping", type=number(float, low=0), help="c of penalty [N s/m] (80; bounce 0)")
    flag("--restitution", type=number(float, low=0, high=1), help="e, lcp and exact (0; bounce 0.7)")
    flag("--baumgarte", type=number(float, low=0, high=1), default=0.2, help="beta of lcp (0.2)")
    flag("--iters", type=number(int, low=1), default=20, help="Gauss-Seidel sweeps a step (20)")
    flag("--dt", type=number(float, above=0), default=0.002, help="time step [s] (0.002)")
    flag("--steps", type=number(int, low=0), default=2000, help="how many (2000)")
    flag("--bodies", type=number(int, low=1), help="balls of stack (3) and pile (200)")
    flag("--smoke", action="store_true", help="a fixed 800 steps, for CI")
    flag("--device", choices=("cpu",), default="cpu")
    flag("--out", type=arguments.writable_folder, default="outputs/ch3.5-contact", help="a folder")
    flag("--rerun", action=switch, default=True, help="write contact.rrd")
    flag("--skip", action=switch, default=True, help="leave out work that changes no bit")
    args = parser.parse_args(argv)
    if args.bodies and args.scene in ("drop", "bounce"):
        parser.error(f"argument --bodies: given {args.bodies}; allowed: --scene stack or pile only, "
                     f"{args.scene} has one ball")
    args.steps = 800 if args.smoke else args.steps
    count = args.bodies or {"stack": 3, "pile": 200}.get(args.scene, 1)
    need = 200 * (args.steps + 1) * count * (3 if args.contact == "all" else 1)     # bytes, about
    if need > 1e8 and need > memory.available():
        parser.error(f"{count} balls over --steps {args.steps} need {need / 1e9:.3g} GB of memory; "
                     f"allowed: {memory.available() / 1e9:.3g} GB, what is free here")
    return args
# --- endregion ---


# --- region: scenes ---
class Scene(NamedTuple):
    """Balls at rest over the floor: q0, v0 (2, N) [m, m/s]; mass [kg], radius [m] (N,)."""
    name: str
    q0: np.ndarray
    v0: np.ndarray
    mass: np.ndarray
    radius: np.ndarray
    restitution: float      # e: lcp and exact use it as it is; penalty has no such knob
    damping: float          # c of penalty [N s/m]


def build_scene(name, seed=0, bodies=None, restitution=None, damping=None):
    """The Scene of that name (ValueError: no such scene); None means the scene's own value.

    The seed makes one draw, uniform in +-0.02 m. It shifts the drop height, or lifts stack and pile
    by its size, never down into the floor; in the pile it also numbers and nudges the balls.
    """
    rng = np.random.default_rng(seed)
    draw = rng.uniform(-0.02, 0.02)
    if name in ("drop", "bounce"):
        x, y = [0.0], [1.0 + draw]
    elif name == "stack":
        x = [0.0] * (bodies or 3)
        y = [(2 * i + 1) * RADIUS + abs(draw) for i in range(len(x))]
    elif name == "pile":
        x, y = pile_lattice(bodies or 200, abs(draw), rng)
    else:
        raise ValueError(f"scene {name!r}; allowed: {', '.join(SCENES)}")
    e, c = (0.7, 0.0) if name == "bounce" else (0.0, 80.0)
    return Scene(name, np.array((x, y)), np.zeros((2, len(x))), np.ones(len(x)),
                 np.full(len(x), RADIUS), e if restitution is None else restitution,
                 c if damping is None else damping)


def pile_lattice(count, lift, rng):
    """x, y (count,) on a lattice 2.5 r wide, each ball nudged by up to 0.1 r, so that gaps are > 0.

    Numbered at random: contacts are swept in the order of the numbers, and numbers that run along
    the lattice would chain hundreds of contacts, each waiting for the one before.
    """
    width = math.ceil(math.sqrt(2 * count))
    place = rng.permutation(count)
    nudge = rng.uniform(-0.1 * RADIUS, 0.1 * RADIUS, (2, count))
    return (2.5 * RADIUS * (place % width - 0.5 * (width - 1)) + nudge[0],
            2.5 * RADIUS * (place // width + 0.5) + lift + nudge[1])
# --- endregion ---


# --- region: contacts ---
def detect_contacts(q, radius, margin=CONTACT_MARGIN):
    """Where balls touch the floor or each other, or are within `margin` [m] of it.

    Returns [(i, j, nx, ny, depth), ...]: floor contacts by body (j = -1), then pairs i < j in order;
    the order is part of the result. From rows of floats: one contact a tuple. From arrays (N,): a
    tuple may hold arrays, a group of contacts that share no body. Centres that coincide part along y.
    """
    x, y = q
    if isinstance(y, np.ndarray):
        return group_contacts(*contact_arrays(q, radius, margin), len(y))
    contacts = [(i, -1, 0.0, 1.0, radius[i] - y[i])
                for i in range(len(y)) if radius[i] - y[i] > -margin]
    for i in range(len(y)):
        for j in range(i + 1, len(y)):
            dx, dy = x[i] - x[j], y[i] - y[j]
            distance = math.sqrt(dx * dx + dy * dy)
            depth = radius[i] + radius[j] - distance
            if depth > -margin:
                n = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
                contacts.append((i, j, *n, depth))
    return contacts


def geometry(q, radius, i, j):
    """nx, ny, depth (..., K) of contacts i, j (K,) in states q (..., 2, N): the same bits, by arrays."""
    zero = np.zeros(q.shape[:-1] + (1,))
    (x, y), radius = np.moveaxis(np.append(q, zero, -1), -2, 0), np.append(radius, 0.0)
    dx, dy = np.where(j < 0, 0.0, x[..., i] - x[..., j]), y[..., i] - y[..., j]
    distance = np.where(j < 0, dy, np.sqrt(dx * dx + dy * dy))
    up = (j < 0) | ~(distance > 0.0)
    scale = np.where(up, 1.0, distance)
    return dx / scale, np.where(up, 1.0, dy / scale), radius[i] + radius[j] - distance


@functools.cache
def every_pair(count):
    """i, j of all contacts that `count` balls can have: the floor's (j = -1), then all pairs i < j."""
    i, j = np.triu_indices(count, 1)
    return np.append(np.arange(count), i), np.append(np.full(count, -1), j)


def contact_arrays(q, radius, margin):
    """i, j, nx, ny, depth as arrays (K,), in detect_contacts' order; only near pairs are looked at."""
    i, j = neighbours.near_pairs(*q, 2.0 * radius.max() + margin)
    i, j = np.append(np.arange(len(radius)), i), np.append(np.full(len(radius), -1), j)
    with np.errstate(all="ignore"):
        nx, ny, depth = geometry(np.array(q), radius, i, j)
    listed = np.flatnonzero(depth > -margin)
    listed = listed[np.lexsort((j[listed], i[listed], j[listed] >= 0))]
    return tuple(a[listed] for a in (i, j, nx, ny, depth))


def group_contacts(i, j, nx, ny, depth, bodies):
    """Contacts as tuples of arrays, groups that share no body, in an order that gives the same bits.

    Where groups would be small (a tower is one long chain) single contacts are faster: those, then.
    """
    groups = neighbours.independent_groups(i, j, bodies)
    if len(i) < 50 * len(groups):
        return list(zip(*(a.tolist() for a in (i, j, nx, ny, depth))))
    return [tuple(a[group] for a in (i, j, nx, ny, depth)) for group in groups]


def grouped(contacts):
    """Whether the contacts are groups of arrays."""
    return bool(contacts) and isinstance(contacts[0][0], np.ndarray)


def operations(contacts):
    """larger(a, b), choose(condition, yes, no), equal(lists): all that differs for floats and arrays."""
    if grouped(contacts):       # fmax passes over a NaN as Python's max(0.0, NaN) does
        return np.fmax, np.where, lambda a, b: all(map(np.array_equal, a, b))
    return max, lambda condition, yes, no: yes if condition else no, operator.eq


def with_floor(rows, contacts):
    """Rows with a 0 for the floor, which index -1 then finds: it never moves. Lists or arrays to suit."""
    if grouped(contacts):
        return [np.append(row, 0.0) for row in rows]
    return [(row if isinstance(row, list) else np.asarray(row).tolist()) + [0.0] for row in rows]


def advance(row, rate, dt):
    """row + dt * rate."""
    if isinstance(row, list):
        return [a + dt * b for a, b in zip(row, rate)]
    return row + dt * np.asarray(rate)
# --- endregion ---


# --- region: penalty ---
def penalty_normal_force(depth, v_n, stiffness, damping, larger=max):
    """f_n >= 0 [N] of spring and damper at `depth` > 0 [m]; the clamp is the one-sidedness."""
    return larger(0.0, stiffness * depth - damping * v_n)


def penalty_force(q, v, mass, radius, stiffness, damping):
    """Contact forces fx, fy (N,) [N]; a spring pushes only while it is compressed."""
    contacts = detect_contacts(q, radius, margin=0.0)
    larger, _, _ = operations(contacts)
    vx, vy = with_floor(v, contacts)
    fx, fy = with_floor(([0.0] * len(mass),) * 2, contacts)
    for i, j, nx, ny, depth in contacts:
        v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
        f_n = penalty_normal_force(depth, v_n, stiffness, damping, larger)
        fx[i] += f_n * nx
        fy[i] += f_n * ny
        fx[j] -= f_n * nx           # equal and opposite; what the floor gets is never read
        fy[j] -= f_n * ny
    return fx[:-1], fy[:-1]


def semi_implicit_step(q, v, mass, force, dt):
    """Semi-implicit Euler under gravity and force(q, v): new velocity first, then position with it."""
    fx, fy = force(q, v)
    if isinstance(q[0], list):
        ax, ay = [f / m for f, m in zip(fx, mass)], [GRAVITY + f / m for f, m in zip(fy, mass)]
    else:
        ax, ay = np.asarray(fx) / mass, GRAVITY + np.asarray(fy) / mass
    v = advance(v[0], ax, dt), advance(v[1], ay, dt)
    return (advance(q[0], v[0], dt), advance(q[1], v[1], dt)), v


def critical_dt(mass, stiffness, damping):
    """The largest stable dt [s] of that step for a ball that stays in contact; inf without a spring.

    Jury's test on the trace and determinant of the 2x2 step matrix: k dt^2 + 2 c dt < 4 m. The
    textbook's 2 sqrt(m / k) is c = 0: a damper makes the limit smaller, not larger.
    """
    root = math.sqrt(damping * damping + 4.0 * mass * stiffness)
    return 4.0 * mass / (root + damping) if root + damping > 0.0 else math.inf
# --- endregion ---


# --- region: lcp ---
def contact_targets(v, contacts, restitution, baumgarte, dt):
    """The normal velocity [m/s] each contact must at least leave with; v is from before gravity acts.

    The correction (beta / dt) depth (Baumgarte 1972) or, where the bodies arrive closing, the bounce
    -e v_n if that is larger; never their sum, which bounces higher than the material does.
    """
    larger, choose, _ = operations(contacts)
    vx, vy = with_floor(v, contacts)
    target = []
    for i, j, nx, ny, depth in contacts:
        push = baumgarte / dt * depth
        if restitution > 0.0:
            v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
            push = choose(v_n < 0.0, larger(push, -restitution * v_n), push)
        target.append(push)
    return target


def project_impulse(lam, dlam, larger=max):
    """The accumulated impulse [N s] after a change: the total never pulls; a change may take back."""
    return larger(0.0, lam + dlam)


def solve_contacts(v, inv_mass, contacts, target, iters):
    """Projected Gauss-Seidel for lam >= 0, v_n >= target, lam (v_n - target) = 0, contact by contact.

    v (2, N) [m/s]; inv_mass (N,) [1/kg], 0 for a body nothing moves. Returns the new v, and lam [N s]
    a contact. Velocity-level time stepping: Moreau; Stewart and Trinkle 1996; Anitescu and Potra 1997.
    Ends before `iters` sweeps when a sweep changes no impulse: no later one would.
    """
    larger, choose, equal = operations(contacts)
    vx, vy, w = with_floor((*v, inv_mass), contacts)
    lam, rows = [0.0] * len(contacts), []
    for (i, j, nx, ny, _), goal in zip(contacts, target):
        total = w[i] + w[j]
        effective_mass = 1.0 / choose(total > 0.0, total, math.inf)
        rows.append((i, j, nx, ny, goal, effective_mass, w[i] * nx, w[i] * ny, w[j] * nx, w[j] * ny))
    for _ in range(iters):
        before = lam.copy()
        for c, (i, j, nx, ny, goal, effective_mass, ix, iy, jx, jy) in enumerate(rows):
            v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
            total = project_impulse(lam[c], (goal - v_n) * effective_mass, larger)
            dlam, lam[c] = total - lam[c], total
            vx[i] += dlam * ix
            vy[i] += dlam * iy
            vx[j] -= dlam * jx
            vy[j] -= dlam * jy
        if equal(lam, before):
            break
    return (vx[:-1], vy[:-1]), lam


def lcp_step(q, v, inv_mass, radius, dt, restitution, baumgarte, iters):
    """Predict v under gravity, solve the contacts for impulses, move with what comes out."""
    contacts = detect_contacts(q, radius)
    target = contact_targets(v, contacts, restitution, baumgarte, dt)
    v = v[0], advance(v[1], [GRAVITY] * len(v[1]), dt)
    if contacts:
        v, _ = solve_contacts(v, inv_mass, contacts, target, iters)
    return (advance(q[0], v[0], dt), advance(q[1], v[1], dt)), v
# --- endregion ---


# --- region: exact ---
TOUCH = 1e-12       # of the mean radius: surfaces closer than this touch
STILL = 1e-13       # m/s: contacts closing slower than this rest; rounding of impulses stays below


def solve_lcp(W, b):
    """lam >= 0 with w = W lam + b >= 0 and lam w = 0. W (K, K) is the Delassus matrix, b (K,).

    Active sets by the rule of Lawson and Hanson, from all contacts active, which is right for things
    at rest. Every pass ends at the minimum of lam'W lam / 2 + b'lam on its active set, lower than the
    pass before, so no set comes twice. A contact that enters and changes nothing is refused.
    """
    lam, active, refused = np.zeros(len(b)), np.ones(len(b), bool), np.zeros(len(b), bool)
    while True:
        before, trial = lam, solve_active(W, -b, active)
        while (bad := np.flatnonzero(active & (trial < 0.0))).size:
            share = lam[bad] / (lam[bad] - trial[bad])      # of the way from lam to trial
            lam = np.where(active, lam + share.min() * (trial - lam), 0.0)
            active[bad[share == share.min()]] = False
            trial = solve_active(W, -b, active)
        lam = trial
        w = np.add.reduce(W * lam[:, None]) + b             # column sums: W is symmetric
        refused &= np.array_equal(lam, before)
        w[active | refused] = 0.0
        if w.min(initial=0.0) >= -1e-14 * np.abs(b).max(initial=0.0):
            return lam
        active[w.argmin()] = refused[w.argmin()] = True


def solve_active(W, b, active):
    """lam with (W lam)[active] = b[active], else 0. Redundant contacts leave `active`, in place."""
    index = np.flatnonzero(active)
    rows = np.column_stack((W[index][:, index], b[index]))
    for p, c in enumerate(index):                           # Gauss-Jordan on a semidefinite matrix
        if rows[p, p] > 1e-13 * W[c, c]:
            rows[p] /= rows[p, p]
            factor = rows[:, p].copy()
            factor[p] = 0.0
            rows -= factor[:, None] * rows[p]
        else:                                               # those before it carry this one already
            active[c], rows[p], rows[:, p] = False, 0.0, 0.0
    lam = np.zeros(len(b))
    lam[index] = rows[:, -1]
    return lam


def pushed(rows, inv_mass, i, j, n, b):
    """rows (2, N) + M^-1 J' lam, and lam = solve_lcp(J M^-1 J', b), for contacts i, j, n (K,)."""
    w, rows, noise = np.append(inv_mass, 0.0), np.append(rows, [[0.0]] * 2, 1), 1e-13 * np.abs(rows).max()
    shared = [(a[:, None] == c) * w[a][:, None] for a, c in ((i, i), (j, j), (i, j), (j, i))]
    lam = solve_lcp((n[0][:, None] * n[0] + n[1][:, None] * n[1])
                    * (shared[0] + shared[1] - shared[2] - shared[3]), b)
    for row, part in zip(rows, n):
        np.add.at(row, i, lam * w[i] * part)
        np.subtract.at(row, j, lam * w[j] * part)
    return np.where(np.abs(rows) > noise, rows, 0.0)[:, :-1], lam     # what rounding leaves is 0


def across(rows, i, j, n):
    """n . (rows_i - rows_j) (..., K) for directions n = nx, ny (..., K), rows (..., 2, N)."""
    rows = np.append(rows, np.zeros(rows.shape[:-1] + (1,)), -1)
    x, y = rows[..., 0, :], rows[..., 1, :]
    return n[0] * (x[..., i] - x[..., j]) + n[1] * (y[..., i] - y[..., j])


def simulate_exact(scene, dt, steps, report=None):
    """The Run from event to event, sampled at k dt: no step error; the cost follows the events.

    Between events bodies fly parabolas. Touching bodies that close get impulses from the LCP of
    Newton's restitution, all contacts at once; resting ones get forces from the LCP of accelerations.
    A bounce lower than 1e-15 r is the last: all that would follow add less. Not exact where balls
    slide over one another in contact: the normal turns, so forces hold for one sample, and the
    overlap left, of order dt^2, is moved out.
    """
    i, j = every_pair(len(scene.mass))
    gravity = np.array([[0.0], [GRAVITY]]) + np.zeros_like(scene.q0)
    q, v, now, k, held = scene.q0, scene.v0, 0.0, 0, np.zeros(len(i), bool)
    t = np.arange(steps + 1) * dt
    run = Run(t, np.empty((steps + 1, *q.shape)), np.empty((steps + 1, *q.shape)))
    with np.errstate(all="ignore"):
        while True:
            q, v, a, held, slides = settle(scene, q, v, gravity, held)
            horizon = (t[min(k + (t[k] <= now), steps)] if slides else t[-1]) - now
            span = min(next_impact(scene, q, v, a, held, horizon), horizon)
            upto = int(np.searchsorted(t, now + span, "right"))
            s = (t[k:upto] - now)[:, None, None]
            run.q[k:upto], run.v[k:upto] = q + s * (v + 0.5 * s * a), v + s * a
            q, v, now, k = q + span * (v + 0.5 * span * a), v + span * a, now + span, upto
            if report:
                report(k)
            if k > steps:
                return run


def settle(scene, q, v, gravity, held):
    """At one instant: overlaps moved out, impulses, forces. Returns q, v, a, who rests, who slides."""
    i, j = every_pair(len(scene.mass))
    w, touch = 1.0 / scene.mass, TOUCH * scene.radius.mean()
    for _ in range(50):
        *n, depth = geometry(q, scene.radius, i, j)
        near = np.flatnonzero(depth >= -touch)
        i_n, j_n, n = i[near], j[near], np.array(n)[:, near]
        if not (depth > touch).any():
            break
        q, _ = pushed(q, w, i_n, j_n, n, -depth[near])
    v_n = across(v, i_n, j_n, n)
    if (v_n < -STILL).any():
        bounce = np.where(held[near], 0.0, scene.restitution * np.maximum(-v_n, 0.0))
        bounce[bounce * bounce < -2.0 * GRAVITY * 1e-15 * RADIUS] = 0.0
        v, _ = pushed(v, w, i_n, j_n, n, v_n - bounce)
        v_n = across(v, i_n, j_n, n)
    rest = v_n <= STILL
    i_n, j_n, n, still = i_n[rest], j_n[rest], n[:, rest], np.zeros(len(i), bool)
    still[near[rest]] = True
    slip = across(v, i_n, j_n, (-n[1], n[0])) * (j_n >= 0)
    reach = np.append(scene.radius, 0.0)
    turn = slip * slip / (reach[i_n] + reach[j_n])          # the normal turns with the pair
    a, f = pushed(gravity, w, i_n, j_n, n, across(gravity, i_n, j_n, n) + turn)
    slip = np.abs(slip) + np.abs(across(a, i_n, j_n, (-n[1], n[0]))) * (j_n >= 0)
    return q, v, a, still, bool(((f > 0.0) & (slip > 1e-9)).any())


def next_impact(scene, q, v, a, held, horizon):
    """Time [s] until the first contact that does not rest closes; inf when none does by `horizon`.

    |d + w t + c t^2 / 2|^2 - R^2 is a quartic; the floor's gap a parabola. Newton's method made safe:
    with the least curvature up to the horizon a step never passes a root, and a parabola takes one.
    """
    i, j = (index[~held] for index in every_pair(len(scene.mass)))
    _, _, depth = geometry(q, scene.radius, i, j)
    floor, radius = j < 0, np.append(scene.radius, 0.0)
    d, w, c = (rows[:, i] - rows[:, j] for rows in np.append((q, v, a), np.zeros((3, 2, 1)), 2))
    p0 = np.maximum(-depth, 0.0) * np.where(floor, 1.0, 2.0 * (radius[i] + radius[j]) - depth)
    p1 = np.where(floor, w[1], 2.0 * (d * w).sum(0))
    p2 = np.where(floor, 0.5 * c[1], (w * w + d * c).sum(0))
    p3, p4 = np.where(floor, 0.0, (w * c).sum(0)), np.where(floor, 0.0, 0.25 * (c * c).sum(0))
    t = np.zeros(len(i))
    for _ in range(100):
        low = np.clip(-p3 / (4.0 * p4), t, horizon)         # where the curvature is least
        bend = [p2 + (3.0 * p3 + 6.0 * p4 * s) * s for s in (t, horizon, np.where(p4 > 0.0, low, t))]
        bend = np.minimum.reduce(bend)
        value = np.maximum((((p4 * t + p3) * t + p2) * t + p1) * t + p0, 0.0)
        slope = ((4.0 * p4 * t + 3.0 * p3) * t + 2.0 * p2) * t + p1
        root = np.sqrt(slope * slope - 4.0 * value * bend)  # NaN: never
        step = np.where(slope < 0.0, 2.0 * value / (root - slope),
                        np.where(bend < 0.0, (slope + root) / (-2.0 * bend), np.inf))
        t = np.where(t + step <= horizon, t + step, np.inf)
        if not (step > 1e-15 * t).any():
            break
    return t.min(initial=np.inf)
# --- endregion ---


# --- region: simulate ---
class Run(NamedTuple):
    """A recording: t (steps + 1,) [s]; q, v (steps + 1, 2, N) [m, m/s]."""
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray


def simulate(step, scene, dt, steps, skip=True, report=None):
    """`steps` times q, v = step(q, v), recorded as a Run; rows are lists where `takes_lists` says so.

    With `skip`, two kinds of steps are not taken, and no bit changes: a flight that meets no contact
    is summed in one go; and when a state comes back (rest, or any cycle) the rest of the run is
    copied, since a step depends on the state alone. `report(k)` hears how far it is.
    """
    rows, lists = np.empty((steps + 1, 4, len(scene.mass))), takes_lists(len(scene.mass), skip)
    rows[0] = *scene.q0, *scene.v0
    state, seen, k, ask = (rows[0].tolist() if lists else list(rows[0])), {}, 0, 0
    with np.errstate(all="ignore"):                         # an explosion overflows on purpose
        while k < steps:
            if skip:
                first = seen.setdefault(hash(rows[k].tobytes()), k)
                if first < k and rows[first].tobytes() == rows[k].tobytes():
                    rows[k:] = rows[first + np.arange(steps + 1 - k) % (k - first)]
                    break
                if lists and k >= ask:
                    free = free_steps(state, scene.radius, dt, steps - k)
                    flight = fly(rows[k], scene.radius, dt, free) if free > 16 else ()
                    ask = k + min(free, 16)                 # short flights are stepped
                    if len(flight):
                        rows[k + 1:k + 1 + len(flight)] = flight
                        k += len(flight)
                        state = rows[k].tolist()
                        continue
            (x, y), (vx, vy) = step(state[:2], state[2:])
            rows[k + 1] = state = [x, y, vx, vy]
            k += 1
            if report:
                report(k)
    rows += 0.0                                             # -0.0 becomes 0.0
    return Run(np.arange(steps + 1) * dt, rows[:, :2], rows[:, 2:])


def takes_lists(count, skip):
    """Few balls step as lists of floats; without skips all do: every pair, contact by contact."""
    return count <= FEW or not skip


def free_steps(state, radius, dt, most):
    """About how many steps, up to `most`, until the first ball is at the floor; 0 when in doubt.

    Semi-implicit flight is the parabola that starts slower by half a step of gravity.
    """
    for _, y, _, vy, r in zip(*state, radius.tolist()):
        gap, speed = y - r - CONTACT_MARGIN, vy + 0.5 * dt * GRAVITY
        if not gap > 0.0:
            return 0
        most = min(most, (speed + math.sqrt(speed * speed - 2.0 * GRAVITY * gap)) / -GRAVITY / dt)
    return int(most)


def fly(row, radius, dt, most):
    """The next states (n, 4, N), n <= most, of a flight, up to the first with a contact listed.

    np.add.accumulate adds in the order of the steps, so the bits are theirs.
    """
    block = np.empty((most + 1, 4, len(radius)))
    block[0], block[1:, 2], block[1:, 3] = row, 0.0, dt * GRAVITY
    np.add.accumulate(block[:, 2:], out=block[:, 2:])
    block[1:, :2] = dt * block[1:, 2:]
    np.add.accumulate(block[:, :2], out=block[:, :2])
    _, _, depth = geometry(block[:, :2], radius, *every_pair(len(radius)))
    contact = np.flatnonzero(depth.max(-1) > -CONTACT_MARGIN)
    return block[1:contact[0] + 1 if len(contact) else None]


def run_model(model, scene, dt, steps, stiffness=1e4, baumgarte=0.2, iters=20, skip=True, report=None):
    """One model's Run of a scene. Raises ValueError for an unknown model."""
    if model == "exact":
        return simulate_exact(scene, dt, steps, report)
    mass, radius, inv_mass = scene.mass, scene.radius, 1.0 / scene.mass
    if takes_lists(len(mass), skip):
        mass, radius, inv_mass = mass.tolist(), radius.tolist(), inv_mass.tolist()

    def force(q, v):
        return penalty_force(q, v, mass, radius, stiffness, scene.damping)

    def penalty(q, v):
        return semi_implicit_step(q, v, mass, force, dt)

    def lcp(q, v):
        return lcp_step(q, v, inv_mass, radius, dt, scene.restitution, baumgarte, iters)

    if model not in MODELS:
        raise ValueError(f"model {model!r}; allowed: {', '.join(MODELS)}")
    return simulate(penalty if model == "penalty" else lcp, scene, dt, steps, skip, report)


def energy(q, v, mass):
    """Kinetic plus potential energy [J] of states (..., 2, N); zero at the floor."""
    return (0.5 * mass * (v * v).sum(-2) - mass * GRAVITY * q[..., 1, :]).sum(-1)


def max_penetration(q, radius):
    """Deepest overlap [m], 0 if there is none, with the floor or a ball, in states (..., 2, N)."""
    if len(radius) <= FEW:
        return np.maximum(geometry(q, radius, *every_pair(len(radius)))[2].max(-1), 0.0)
    if q.ndim > 2:
        return np.array([max_penetration(state, radius) for state in q])
    return contact_arrays(q, radius, 0.0)[4].max(initial=0.0)


def contact_history(q, v, i, j, scene, dt):
    """Deepest overlap [m] (S,), and the energy [J] (S - 1,) contacts i, j put INTO the bodies a step.

    A contact may leave with e times the speed it closed with, or with the speed it parts at, plus
    what falling through its gap adds. More than that is put in: m_eff / 2 times the excess of v_n^2.
    """
    nx, ny, depth = geometry(q, scene.radius, i, j)
    v_n, left = (across(rows, i, j, (nx[:-1], ny[:-1])) for rows in (v[:-1], v[1:]))
    closing = np.maximum(-(v_n + dt * GRAVITY * (j < 0)), 0.0)
    allowed = np.maximum(scene.restitution * closing, v_n) ** 2
    allowed -= 2.0 * GRAVITY * np.maximum(-depth[:-1], 0.0)
    w = np.append(1.0 / scene.mass, 0.0)
    excess = np.where((depth[:-1] > -CONTACT_MARGIN) & (left > 0.0), left * left - allowed, 0.0)
    return depth.max(-1, initial=0.0), (np.maximum(excess, 0.0) * 0.5 / (w[i] + w[j])).sum(-1)


def contact_quality(run, scene, dt, reference=None):
    """The honesty numbers of a Run, as shares of the first ball's radius or of the start energy.

    max_, rest_penetration_frac: deepest and last overlap. energy_excess: most energy above the start.
    contact_energy: all that contacts put into the bodies, see contact_history. height_error_frac:
    most |y - y of the Run `reference`|, None without one. rest_jitter: standard deviation of the
    overlap over the last quarter. blew_up_step: the first with EXPLODED times the start energy
    gained, or not finite; None, and blew_up False, if there is none.
    """
    with np.errstate(all="ignore"):
        if len(scene.mass) <= FEW:
            depth, work = contact_history(run.q, run.v, *every_pair(len(scene.mass)), scene, dt)
        else:
            near = (contact_arrays(q, scene.radius, CONTACT_MARGIN)[:2] for q in run.q)
            parts = [contact_history(run.q[k:k + 2], run.v[k:k + 2], *pair, scene, dt)
                     for k, pair in enumerate(near)]
            depth = np.array([part[0][0] for part in parts])
            work = np.array([part[1][0] for part in parts[:-1]])
        total, radius = energy(run.q, run.v, scene.mass), float(scene.radius[0])
        scale = abs(float(total[0])) or 1.0
        excess = (total - total[0]) / scale
        bad = np.flatnonzero(~(excess < EXPLODED))
        error = reference and float(np.abs(run.q[:, 1] - reference.q[:, 1]).max()) / radius
        return {"max_penetration_frac": float(depth.max()) / radius,
                "rest_penetration_frac": float(depth[-1]) / radius,
                "energy_excess": float(excess.max()),
                "contact_energy": float(work.sum()) / scale,
                "height_error_frac": error,
                "rest_jitter": float(np.std(depth[3 * len(depth) // 4:])) / radius,
                "blew_up": len(bad) > 0,
                "blew_up_step": int(bad[0]) if len(bad) else None}
# --- endregion ---


# --- region: report ---
def log_rerun(path, runs, scene):
    """Write the Runs {model: Run} to a recording, whole; ImportError where rerun is missing.

    One 2-D view of every model's balls on the table, side by side, y up; plots of the first ball's
    height [m], the deepest penetration [r] and the energy above the start [J]; a colour a model.
    """
    from curriculum.common import recording
    curves = {"height": {}, "penetration": {}, "energy": {}}
    for model, run in runs.items():
        total = energy(run.q, run.v, scene.mass)
        curves["height"][model] = run.q[:, 1, 0]
        curves["penetration"][model] = max_penetration(run.q, scene.radius) / scene.radius[0]
        curves["energy"][model] = total - total[0]
    recording.write(path, "contact", next(iter(runs.values())).t, scene.radius,
                    {model: run.q for model, run in runs.items()}, curves, COLORS)


def measure_stability(args, scene, first):
    """Largest stable dt of the grid and the penetration there, for penalty and lcp; both critical dt.

    `first` holds the qualities at dt itself, which are not run again.
    """
    grid = {"dt_crit_penalty": critical_dt(float(scene.mass[0]), args.stiffness, 0.0),
            "dt_crit_damped": critical_dt(float(scene.mass[0]), args.stiffness, scene.damping)}
    for model in ("penalty", "lcp"):
        grid[model], grid[f"{model}_penetration_frac"] = 0.0, None
        for dt in (args.dt * factor for factor in DT_GRID):
            quality = first[model] if dt == args.dt else contact_quality(
                run_flags(model, scene, dt, args), scene, dt)
            if not quality["blew_up"]:
                grid[model] = dt
                grid[f"{model}_penetration_frac"] = quality["max_penetration_frac"]
    return grid


def run_flags(model, scene, dt, args, report=None):
    """run_model with the knobs of the command line."""
    return run_model(model, scene, dt, args.steps, args.stiffness, args.baumgarte, args.iters,
                     args.skip, report)


def print_report(args, scene, metrics):
    """The table, the verdict and the stability line."""
    def show(value, form):
        return format("-" if value is None else format(value, form), ">12")

    print(f"scene {args.scene}: {len(scene.mass)} x r = {RADIUS} m, {args.steps} steps of {args.dt:g} s")
    print("contact       max pen/r  rest pen/r     energy+   energy in  height err    jitter/r  state")
    quality, grid = metrics["quality"], metrics["stability"]
    for model, row in quality.items():
        state = f"EXPLODED at step {row['blew_up_step']}" if row["blew_up"] else "ok"
        print(f"{model:<10}", *(show(row[key], ".4e") for key in (
            "max_penetration_frac", "rest_penetration_frac", "energy_excess", "contact_energy",
            "height_error_frac", "rest_jitter")), "", state)
    if not grid:
        return
    deeper = all((quality["penalty"][key] is None) or quality["penalty"][key] >= quality["lcp"][key]
                 for key in ("max_penetration_frac", "rest_penetration_frac"))
    print("verdict: penalty goes deeper than lcp, at most and at rest:", "yes" if deeper else "NO")
    print(f"stability: energy stays below {EXPLODED:g}x up to dt = {grid['penalty']:g} s for penalty "
          f"(critical dt of one ball {grid['dt_crit_damped'] or math.inf:.4g} s, undamped "
          f"{grid['dt_crit_penalty'] or math.inf:.4g} s), {grid['lcp']:g} s for lcp; deepest there: "
          f"{show(grid['penalty_penetration_frac'], '.3g').strip()} r and "
          f"{show(grid['lcp_penetration_frac'], '.3g').strip()} r")


def main(argv=None):
    """Run the command line: print the report, write metrics.json and contact.rrd. Returns 0."""
    args = parse_flags(argv)
    device.banner("ch3.5-contact", args.device)
    scene = build_scene(args.scene, args.seed, args.bodies, args.restitution, args.damping)
    runs = {model: run_flags(model, scene, args.dt, args, progress.steps(args.steps, model))
            for model in (MODELS if args.contact == "all" else (args.contact,))}
    quality = {model: contact_quality(run, scene, args.dt, runs.get("exact"))
               for model, run in runs.items()}
    metrics = results.rounded({
        "scene": args.scene, "contact": args.contact, "dt": args.dt, "steps": args.steps,
        "seed": args.seed, "stiffness": args.stiffness, "restitution": scene.restitution,
        "quality": quality, "stability": {}
        if args.contact != "all" else measure_stability(args, scene, quality)})
    print_report(args, scene, metrics)
    path = os.path.join(args.out, "metrics.json")
    results.write_json(path, metrics)
    print(f"metrics: {path}")
    if args.rerun:
        try:
            path = os.path.join(args.out, "contact.rrd")
            log_rerun(path, runs, scene)
            print(f"recording: {path}, open it with: rerun {path}")
        except ImportError:
            print("no recording: rerun is missing, install it with: pip install rerun-sdk")
    knobs = {key: value for key, value in vars(args).items() if key not in ("out", "rerun", "skip")}
    print(f"config_hash: {results.fingerprint(knobs)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
# --- endregion ---
