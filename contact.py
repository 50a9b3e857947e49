"""Contact between bodies, built three times and measured honestly (robotics course, chapter 3.5).

A table pushes a ball up while they touch and never pulls it down. Three models of that push:
    penalty   a stiff spring and a damper: simple; sinks, rings, explodes past a critical dt
    lcp       impulses from a complementarity problem, by projected Gauss-Seidel, step by step
    exact     event to event: every impact at its own time, impulses and forces by a pivot
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

q and v are two rows of N numbers, (2, N). Inside a step a row is a list of floats for a few balls
and an array for many: the same lines compute both, to the same bits.
    python contact.py --scene drop                      # then: bounce, stack, pile
    python contact.py --contact penalty --dt 0.03       # past the critical time step
    python contact.py --smoke --no-rerun                # fixed length, the same bytes every time
"""

# --- region: setup ---
import argparse
import itertools
import math
import os
import sys
from typing import NamedTuple

import numpy as np

from curriculum.common import arguments, balls, device, memory, progress, results, roots

GRAVITY = -9.81         # m/s^2, along y
RADIUS = 0.1            # m, of every ball in the scenes; penetration is told in units of it
CONTACT_MARGIN = 1e-3   # m: lcp lists a contact this far before it touches, so resting ones stay
SLIDING = 24            # balls: a larger pile slides for long, and exact with it: only when asked
EXPLODED = 10.0         # gaining more than this times the start energy is an explosion
DT_GRID = (1, 2, 4, 8, 16, 32)      # multiples of --dt that the stability line tries
SCENES = ("drop", "bounce", "stack", "pile")
MODELS = ("penalty", "lcp", "exact")
COLORS = {"penalty": "#d55e00", "lcp": "#0072b2", "exact": "#009e73"}   # told apart by all eyes

def parse_flags(argv):
    """The checked command line. Bad input: one line on stderr, exit status 2, nothing written."""
    parser = arguments.Parser(prog="contact.py", description="Contact, built three times.")
    flag, number, switch = parser.add_argument, arguments.number, argparse.BooleanOptionalAction
    flag("--seed", type=number(int, low=0), default=0, help="draws the start height (0)")
    flag("--scene", choices=SCENES, default="drop")
    flag("--contact", choices=("all", *MODELS), default="all")
    flag("--stiffness", type=number(float, low=0), default=1e4, help="k, penalty [N/m] (1e4)")
    flag("--damping", type=number(float, low=0), help="c, penalty [N s/m] (80; bounce 0)")
    flag("--restitution", type=number(float, 0, 1), help="e, lcp and exact (0; bounce 0.7)")
    flag("--baumgarte", type=number(float, 0, 1), default=0.2, help="beta, lcp (0.2)")
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
        parser.error(f"argument --bodies: given {args.bodies}; allowed: stack and pile only")
    args.steps = 800 if args.smoke else args.steps
    count = args.bodies or {"stack": 3, "pile": 200}.get(args.scene, 1)
    memory.need(parser, 600 * (args.steps + 1) * count, f"--steps {args.steps} of {count} balls")
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

    The seed draws once, uniform in +-0.02 m: it shifts the drop height, or lifts stack and pile by
    the draw's size, never into the floor; in the pile it also numbers and nudges the balls.
    """
    rng = np.random.default_rng(seed)
    draw = rng.uniform(-0.02, 0.02)
    if name in ("drop", "bounce"):
        x, y = [0.0], [1.0 + draw]
    elif name == "stack":
        y = [(2 * i + 1) * RADIUS + abs(draw) for i in range(bodies or 3)]
        x = [0.0] * len(y)
    elif name == "pile":
        x, y = pile_lattice(bodies or 200, abs(draw), rng)
    else:
        raise ValueError(f"scene {name!r}; allowed: {', '.join(SCENES)}")
    e, c = (0.7, 0.0) if name == "bounce" else (0.0, 80.0)
    return Scene(name, np.array((x, y)), np.zeros((2, len(x))), np.ones(len(x)),
                 np.full(len(x), RADIUS), e if restitution is None else restitution,
                 c if damping is None else damping)

def pile_lattice(count, lift, rng):
    """x, y (count,) on a lattice 2.5 r wide, nudged by up to 0.1 r, gaps > 0. Numbered at random:
    numbers along the lattice would chain contacts, each waiting for the one before."""
    place, width = rng.permutation(count), math.ceil(math.sqrt(2 * count))
    nudge = rng.uniform(-0.1 * RADIUS, 0.1 * RADIUS, (2, count))
    return (2.5 * RADIUS * (place % width - 0.5 * (width - 1)) + nudge[0],
            2.5 * RADIUS * (place // width + 0.5) + lift + nudge[1])
# --- endregion ---

# --- region: contacts ---
def detect_contacts(q, radius, margin=CONTACT_MARGIN):
    """Where balls touch the floor or each other, or are within `margin` [m] of it.

    Returns [(i, j, nx, ny, depth), ...]: the floor's by body (j = -1), then pairs i < j in order;
    the order is part of the result. From rows of floats: one contact a tuple. From arrays (N,): a
    tuple may hold arrays, a group of contacts that share no body. Coinciding centres part along y.
    """
    x, y = q
    if isinstance(y, np.ndarray):
        return balls.group_contacts(*balls.contact_arrays(np.array(q), radius, margin), len(y))
    contacts = [(i, -1, 0.0, 1.0, radius[i] - y[i])
                for i in range(len(y)) if radius[i] - y[i] > -margin]
    for i, j in itertools.combinations(range(len(y)), 2):
        dx, dy = x[i] - x[j], y[i] - y[j]
        distance = math.sqrt(dx * dx + dy * dy)
        depth = radius[i] + radius[j] - distance
        if depth > -margin:
            n = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
            contacts.append((i, j, *n, depth))
    return contacts
# --- endregion ---

# --- region: penalty ---
def penalty_normal_force(depth, v_n, stiffness, damping, larger=max):
    """f_n >= 0 [N] of spring and damper at `depth` > 0 [m]; the clamp is the one-sidedness."""
    return larger(0.0, stiffness * depth - damping * v_n)

def penalty_force(q, v, mass, radius, stiffness, damping):
    """Contact forces fx, fy (N,) [N]; a spring pushes only while it is compressed."""
    contacts = detect_contacts(q, radius, margin=0.0)
    larger, _, _, row = balls.operations(contacts)
    vx, vy, fx, fy = map(row, (*v, [0.0] * len(mass), [0.0] * len(mass)))
    for i, j, nx, ny, depth in contacts:
        v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
        f_n = penalty_normal_force(depth, v_n, stiffness, damping, larger)
        fx[i] += f_n * nx
        fy[i] += f_n * ny
        fx[j] -= f_n * nx           # equal and opposite; what the floor gets is never read
        fy[j] -= f_n * ny
    return fx[:-1], fy[:-1]

def semi_implicit_step(q, v, mass, force, dt):
    """Semi-implicit Euler under gravity and force(q, v): new velocity first, then q with it."""
    v = balls.accelerate(v, GRAVITY, force(q, v), mass, dt)
    return balls.advance(q, v, dt), v

def critical_dt(mass, stiffness, damping):
    """The largest stable dt [s] of that step for a ball kept in contact; inf without a spring.

    Jury's test of the step matrix: k dt^2 + 2 c dt < 4 m. c = 0 is the textbook's 2 sqrt(m/k): a
    damper makes the limit smaller, not larger."""
    root = math.sqrt(damping * damping + 4.0 * mass * stiffness)
    return 4.0 * mass / (root + damping) if root + damping > 0.0 else math.inf
# --- endregion ---

# --- region: lcp ---
def contact_targets(v, contacts, restitution, baumgarte, dt):
    """The normal velocity [m/s] each contact must leave with at least; v from before gravity acts:
    the bounce -e v_n, of parting bodies too, or energy could rise (Moreau 1988); in an overlap the
    correction (beta / dt) depth (Baumgarte 1972) if larger; never their sum, a higher bounce."""
    larger, choose, _, row = balls.operations(contacts)
    (vx, vy), target = map(row, v), []
    for i, j, nx, ny, depth in contacts:
        push = baumgarte / dt * depth
        if restitution > 0.0:
            v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
            push = choose(push > 0.0, larger(push, -restitution * v_n), -restitution * v_n)
        target.append(push)
    return target

def project_impulse(lam, dlam, larger=max):
    """The accumulated impulse [N s] after a change: the total never pulls; a change may."""
    return larger(0.0, lam + dlam)

def solve_contacts(v, inv_mass, contacts, target, iters):
    """Projected Gauss-Seidel for lam >= 0, v_n >= target, lam (v_n - target) = 0.

    v (2, N) [m/s]; inv_mass (N,) [1/kg], 0 for a body nothing moves. Returns the new v, and lam of
    each contact [N s]. At velocity level: Moreau; Stewart, Trinkle 1996; Anitescu, Potra 1997.
    A sweep that changes no impulse is the last: no later one would.
    """
    larger, choose, moves, row = balls.operations(contacts)
    vx, vy, w = map(row, (*v, inv_mass))
    lam, rows = [0.0] * len(contacts), []
    for (i, j, nx, ny, _), goal in zip(contacts, target):
        m_eff = 1.0 / choose(w[i] + w[j] > 0.0, w[i] + w[j], math.inf)      # effective mass
        rows.append((i, j, nx, ny, w[i] * nx, w[i] * ny, w[j] * nx, w[j] * ny, m_eff, goal))
    for _ in range(iters):
        settled = True
        for c, (i, j, nx, ny, ix, iy, jx, jy, m_eff, goal) in enumerate(rows):
            v_n = nx * (vx[i] - vx[j]) + ny * (vy[i] - vy[j])
            total = project_impulse(lam[c], (goal - v_n) * m_eff, larger)
            dlam = total - lam[c]
            if moves(dlam):
                lam[c], settled = total, False
                vx[i] += dlam * ix
                vy[i] += dlam * iy
                vx[j] -= dlam * jx
                vy[j] -= dlam * jy
        if settled:
            break
    return [vx[:-1], vy[:-1]], lam

def lcp_step(q, v, inv_mass, radius, dt, restitution, baumgarte, iters):
    """Predict v under gravity, solve the contacts for impulses, move with what comes out."""
    contacts = detect_contacts(q, radius)
    target = contact_targets(v, contacts, restitution, baumgarte, dt)
    v = balls.fall(v, GRAVITY, dt)
    if contacts:
        v, _ = solve_contacts(v, inv_mass, contacts, target, iters)
    return balls.advance(q, v, dt), v
# --- endregion ---

# --- region: exact ---
def solve_lcp(W, b):
    """lam >= 0 with w = W lam + b >= 0 and lam w = 0. W (K, K) is the Delassus matrix, b (K,).

    Pivoting as Lawson and Hanson (1974), from all contacts active, as at rest: one more contact
    pushes, or one less, so that lam'W lam / 2 + b'lam falls and no active set comes twice. The
    table is made afresh until it needs no more, at most nine times.
    """
    if len(b) < 2:                                          # one contact is one clamp
        return np.maximum(-b / W.diagonal(), 0.0)
    scale = np.ldexp(1.0, -np.frexp(W.diagonal())[1] // 2)  # diagonal near 1: one tolerance for all
    fresh = np.column_stack((W * scale * scale[:, None], b * scale))
    least, active, lam = -1e-13 * np.abs(b * scale).max(initial=0.0), scale > 0.0, np.zeros(len(b))
    def exchange(k):
        row, column, pivot = table[k] / -table[k, k], table[:, k].copy(), table[k, k]
        table[...] += column[:, None] * row
        table[:, k], table[k], table[k, k] = column / pivot, row, 1.0 / pivot
        active[k] = ~active[k]
    for _ in range(9):
        table, left, active, last = fresh.copy(), active, np.zeros(len(b), bool), None
        while (diagonal := table[:, :-1].diagonal() * left).max() > 1e-12:
            left[k := diagonal.argmax()] = False            # what stays left hangs on the others
            exchange(k)
        while True:
            trial = np.where(active, table[:, -1], 0.0)
            bad = np.flatnonzero(trial < least)
            if len(bad):                                    # towards trial until one would pull
                share = lam[bad] / (lam[bad] - trial[bad])
                lam = np.where(active, lam + share.min() * (trial - lam), 0.0)
                last = bad[share.argmin()]
            else:                                           # let the one push that closes fastest
                lam, w = trial, np.where(active, 0.0, table[:, -1])
                if w.min() >= least:
                    break
                last = w.argmin()
                if table[last, last] < 1e-12:               # it hangs on others: one of them stops
                    column = np.where(active, table[:, last], 0.0)
                    fall = np.flatnonzero(column < -1e-9)
                    share = lam[fall] / -column[fall]
                    lam = lam + share.min() * column
                    lam[last] = share.min()
                    exchange(fall[share.argmin()])
            exchange(last)
        if last is None:
            break
    return np.maximum(lam, 0.0) * scale

def react(rows, i, j, n, w, b):
    """rows + M^-1 J' lam with lam = solve_lcp(J M^-1 J', b), and lam; what is noise becomes 0."""
    lam = solve_lcp(balls.delassus(i, j, n, w), b)
    return balls.pushed(rows, lam, i, j, n, w), lam

def settle(q, v, w, radius, restitution, held, touch):
    """At an instant: overlaps moved out, impulses, forces. Returns q, v, a, gap, rests, slides.
    Within `touch` r, and the last bits of q, is touching. A bounce below touch / 1000 r is the last
    of its series: all that would follow add less. Contacts `held` until now do not bounce."""
    every_i, every_j = balls.every_contact(len(w) - 1)
    a, last = np.array([[0.0], [GRAVITY]]) * (w > 0.0), np.spacing(np.abs(q).max(0))
    small = touch * radius[every_i] + 4.0 * np.maximum(last[every_i], last[every_j])
    for _ in range(50):
        n, depth = balls.geometry(q, radius, every_i, every_j)
        near = np.flatnonzero(depth >= -small)
        i, j, n = every_i[near], every_j[near], n[:, near]
        if not (depth > small).any():
            break
        q, _ = react(q, i, j, n, w, -depth[near])
    v_n, still = balls.along(v, i, j, n), np.zeros(len(every_i), bool)
    slow = np.sqrt(-2.0 * GRAVITY * 1e-3 * touch * radius[i])
    if (v_n < -0.1 * touch).any():                          # m/s; what impulses round is less
        bounce = np.where(held[near], 0.0, -restitution * v_n)
        v, _ = react(v, i, j, n, w, v_n - np.where(np.abs(bounce) < slow, 0.0, bounce))
        v_n = balls.along(v, i, j, n)
    rest = np.abs(v_n) < slow                               # what closes again is the next event
    if not rest.any():
        return q, v, a, -depth, still, False
    still[near[rest]] = True
    i, j, n = i[rest], j[rest], n[:, rest]
    tangent = np.array((-n[1], n[0])) * (j >= 0)            # the floor's normal never turns
    slip = balls.along(v, i, j, tangent)
    turn = slip * slip / (radius[i] + radius[j])            # what keeps a turning normal in touch
    a, _ = react(a, i, j, n, w, balls.along(a, i, j, n) + turn)
    slides = np.abs(slip) + np.abs(balls.along(a, i, j, tangent)) > 1e-9    # pushed, or turning off
    return q, v, a, -depth, still, slides.any()

def next_impact(q, v, a, gap, radius, still, horizon, slow):
    """Time until a contact not `still`, with v_n <= `slow`, closes; inf: not by `horizon`. Roots
    of floor gaps, parabolas in t, and of |d + u t + c t^2 / 2|^2 - R^2 of pairs, quartics."""
    count, p = q.shape[1] - 1, np.zeros((5, len(gap)))
    i, j = (index[count:] for index in balls.every_contact(count))
    p[0], p[1, :count], p[2, :count] = np.maximum(gap, 0.0), v[1, :-1], 0.5 * a[1, :-1]
    reach = p[0, count:] + radius[i] + radius[j]
    if count > 1:
        d, u, c = (rows[:, i] - rows[:, j] for rows in (q, v, a))
        p[0, count:] *= reach + radius[i] + radius[j]
        p[1:, count:] = (2.0 * (d * u).sum(0), (u * u + d * c).sum(0), (u * c).sum(0),
                         0.25 * (c * c).sum(0))
    due = ~still & (p[1] <= slow * np.append(np.ones(count), 2.0 * reach))
    return roots.first_fall(p[:, due], horizon).min(initial=np.inf)

@np.errstate(all="ignore")
def simulate_exact(scene, dt, steps, report=lambda k: None):
    """The Run from event to event, sampled at k dt: no step error; the cost follows the events.

    Parabolas between events. Touching bodies that close get impulses from the LCP of Newton's
    restitution, all at once; resting ones forces from the LCP of accelerations. Not exact where
    balls slide over one another in contact: forces hold for a sample, contacts closing slower than
    g dt wait for its end, the overlap (of order dt^2) is moved out. Nor after 2000 events in a
    sample: touching is ten times looser then, and so on, up to 1e-6 r.
    """
    q, v, w, radius = map(balls.with_floor, (scene.q0, scene.v0, 1.0 / scene.mass, scene.radius))
    held, now, k, events, touch = balls.every_contact(len(w) - 1)[0] < 0, 0.0, 0, 0, 1e-12
    run = Run(np.arange(steps + 1) * dt, *np.empty((2, steps + 1, *q.shape)))
    while k <= steps:
        q, v, a, gap, held, slides = settle(q, v, w, radius, scene.restitution, held, touch)
        end = run.t[min(k + (run.t[k] <= now), steps)] if slides else run.t[-1]
        span = min(end - now, next_impact(q, v, a, gap, radius, held, end - now,
                                          dt * GRAVITY if slides else np.inf))
        upto = int(np.searchsorted(run.t, now + span, "right"))
        s = (run.t[k:upto] - now)[:, None, None]
        run.q[k:upto], run.v[k:upto] = q + s * (v + 0.5 * s * a), v + s * a
        q, v, now = q + span * (v + 0.5 * span * a), v + span * a, now + span
        k, events = upto, events + 1 if upto == k else 0
        touch, events = (min(10.0 * touch, 1e-6), 0) if events > 2000 else (touch, events)
        report(k)
    return Run(run.t, run.q[:, :, :-1], run.v[:, :, :-1])
# --- endregion ---

# --- region: simulate ---
class Run(NamedTuple):
    """A recording: t (steps + 1,) [s]; q, v (steps + 1, 2, N) [m, m/s]."""
    t: np.ndarray
    q: np.ndarray
    v: np.ndarray

@np.errstate(all="ignore")
def simulate(step, scene, dt, steps, skip=True, report=lambda k: None):
    """`steps` times q, v = step(q, v), as a Run. Rows are lists for few balls, and without skips.

    With `skip` two kinds of steps are not taken, and no bit changes: a flight without contact is
    summed in one go, and when a state comes back (rest, any cycle) the rest of the run is a copy,
    since a step depends on the state alone. `report(k)` hears how far it is."""
    rows, lists = np.empty((steps + 1, 4, len(scene.mass))), balls.few(scene.mass) or not skip
    rows[0] = *scene.q0, *scene.v0
    state, radius, seen = rows[0].tolist() if lists else list(rows[0]), scene.radius.tolist(), {}
    k = ask = 0
    while k < steps:
        first = seen.setdefault(hash(rows[k].tobytes()), k) if skip else k
        if first < k and rows[first].tobytes() == rows[k].tobytes():
            rows[k:] = rows[first + np.arange(steps + 1 - k) % (k - first)]
            break
        if skip and lists and k >= ask:
            free, flight = fly(state, radius, dt, steps - k)
            ask = k + free
            if len(flight):
                rows[k + 1:k + 1 + len(flight)], k = flight, k + len(flight)
                state = rows[k].tolist()
                continue
        q, v = step(state[:2], state[2:])
        rows[k + 1] = state = [*q, *v]
        k += 1
        report(k)
    rows += 0.0                                             # -0.0 becomes 0.0
    return Run(np.arange(steps + 1) * dt, rows[:, :2], rows[:, 2:])

def fly(row, radius, dt, most):
    """Steps to wait before asking again, and the next states (n, 4, N), n <= most, of a flight:
    near a parabola that starts slower by half a step of gravity, to the first contact listed. Its
    bits are the steps', since np.add.accumulate adds in their order."""
    for _, y, _, vy, r in zip(*row, radius):
        gap, speed = y - r - CONTACT_MARGIN, vy + 0.5 * dt * GRAVITY
        if not gap > 0.0:
            return 0, ()
        most = min(most, (speed + math.sqrt(speed * speed - 2.0 * GRAVITY * gap)) / -GRAVITY / dt)
    if not most > 16.0:
        return int(most), ()                                # a short flight is stepped
    block = np.empty((int(most) + 1, 4, len(radius)))
    block[0], block[1:, 2], block[1:, 3] = row, 0.0, dt * GRAVITY
    np.add.accumulate(block[:, 2:], out=block[:, 2:])
    block[1:, :2] = dt * block[1:, 2:]
    np.add.accumulate(block[:, :2], out=block[:, :2])
    contact = balls.deepest(block[:, :2], np.array(radius), CONTACT_MARGIN) > -CONTACT_MARGIN
    return 16, block[1:contact.argmax() + 1 if contact.any() else None]

def run_model(model, scene, dt, steps, stiffness=1e4, baumgarte=0.2, iters=20, skip=True,
              report=lambda k: None):
    """The Run of a scene by one of MODELS; ValueError for any other."""
    mass, radius, w = (row.tolist() if balls.few(row) or not skip else row
                       for row in (scene.mass, scene.radius, 1.0 / scene.mass))
    steps_by = {
        "penalty": lambda q, v: semi_implicit_step(q, v, mass, lambda q, v: penalty_force(
            q, v, mass, radius, stiffness, scene.damping), dt),
        "lcp": lambda q, v: lcp_step(q, v, w, radius, dt, scene.restitution, baumgarte, iters)}
    if model not in MODELS:
        raise ValueError(f"model {model!r}; allowed: {', '.join(MODELS)}")
    if model == "exact":
        return simulate_exact(scene, dt, steps, report)
    return simulate(steps_by[model], scene, dt, steps, skip, report)

@np.errstate(all="ignore")
def energy(q, v, mass):
    """Kinetic plus potential energy [J] of states (..., 2, N); zero at the floor."""
    return (0.5 * mass * (v * v).sum(-2) - mass * GRAVITY * q[..., 1, :]).sum(-1)

def max_penetration(q, radius):
    """Deepest overlap [m] with the floor or a ball, 0 without one, in states (..., 2, N)."""
    return np.maximum(balls.deepest(q, radius, CONTACT_MARGIN), 0.0)

def blow_up_step(total):
    """First of the energies [J] that gained EXPLODED times the first, or is not finite; or None."""
    bad = ~(total - total[0] < EXPLODED * (abs(total[0]) or 1.0))
    return int(bad.argmax()) if bad.any() else None

@np.errstate(all="ignore")
def contact_quality(run, scene, dt, reference=None):
    """The honesty numbers of a Run, as shares of the first ball's radius or of the start energy.

    max_, rest_penetration_frac: deepest, last overlap; rest_jitter: its deviation, last quarter.
    energy_excess: most energy above the start; contact_energy: what contacts put INTO the bodies
    beyond their law. height_error_frac: most |y - y of Run `reference`|.
    """
    total, radius = energy(run.q, run.v, scene.mass), float(scene.radius[0])
    scale, depth = abs(float(total[0])) or 1.0, max_penetration(run.q, scene.radius) / radius
    error = reference and float(np.abs(run.q[:, 1] - reference.q[:, 1]).max()) / radius
    put_in = balls.energy_put_in(run.q, run.v, scene, dt * GRAVITY, CONTACT_MARGIN) / scale
    step = blow_up_step(total)
    jitter = float(np.std(depth[3 * len(depth) // 4:]))
    return {"max_penetration_frac": float(depth.max()), "blew_up": step is not None,
            "rest_penetration_frac": float(depth[-1]), "blew_up_step": step,
            "energy_excess": float((total - total[0]).max()) / scale, "rest_jitter": jitter,
            "contact_energy": put_in, "height_error_frac": error}
# --- endregion ---

# --- region: report ---
COLUMNS = {"max pen/r": "max_penetration_frac", "rest pen/r": "rest_penetration_frac",
           "energy+": "energy_excess", "energy in": "contact_energy",
           "height err/r": "height_error_frac", "jitter/r": "rest_jitter"}

def log_rerun(path, runs, scene):
    """Write the Runs {model: Run} to a recording, whole; ImportError where rerun is missing."""
    from curriculum.common import recording
    total = {model: energy(run.q, run.v, scene.mass) for model, run in runs.items()}
    recording.write(path, "contact", runs, scene.radius, {
        "height [m]": {model: run.q[:, 1, 0] for model, run in runs.items()},
        "penetration [r]": {model: max_penetration(run.q, scene.radius) / scene.radius[0]
                            for model, run in runs.items()},
        "energy above the start [J]": {model: e - e[0] for model, e in total.items()}}, COLORS)

def measure_stability(run, scene, dt, stiffness, first):
    """Largest dt of the grid without explosion; run(model, dt) runs, `first` has the Runs at dt."""
    grid = {"dt_crit_penalty": critical_dt(float(scene.mass[0]), stiffness, 0.0),
            "dt_crit_damped": critical_dt(float(scene.mass[0]), stiffness, scene.damping)}
    for model in ("penalty", "lcp"):
        grid[model], grid[f"{model}_penetration_frac"] = 0.0, None
        for step in [dt * factor for factor in DT_GRID]:
            found = first[model] if step == dt else run(model, step)
            if blow_up_step(energy(found.q, found.v, scene.mass)) is None:
                deepest = float(max_penetration(found.q, scene.radius).max() / scene.radius[0])
                grid |= {model: step, f"{model}_penetration_frac": deepest}
    return grid

def print_report(args, quality, grid):
    """The table, a row a model; the verdict, which claims what it tests; the stability lines."""
    show = results.show
    print(f"scene {args.scene}, seed {args.seed}: {args.steps} steps of {args.dt:g} s")
    results.print_table("contact", COLUMNS, quality, lambda row: (
        f"EXPLODED at step {row['blew_up_step']}" if row["blew_up"] else "ok"))
    if grid:
        spring, solve = quality["penalty"], quality["lcp"]
        verdict = "a run exploded" if spring["blew_up"] or solve["blew_up"] else "yes" if all(
            spring[key] > solve[key] for key in list(COLUMNS.values())[:2]) else "no"
        print("verdict: penalty is the deeper, at most and at the end:", verdict)
        for model in ("penalty", "lcp"):
            depth = show(grid[f"{model}_penetration_frac"], ".3g")
            print(f"stability: {model} does not explode up to dt = {grid[model]:g} s of the grid, "
                  f"where it goes {depth} r deep" if grid[model] else
                  f"stability: {model} explodes at every dt of the grid")
        print(f"critical dt of penalty, one ball: {show(grid['dt_crit_damped'], '.4g')} s; "
              f"without the damper, 2 sqrt(m/k), {show(grid['dt_crit_penalty'], '.4g')} s")

def main(argv=None):
    """Run the command line: print the report, write metrics.json and contact.rrd. Returns 0."""
    args = parse_flags(argv)
    device.banner("ch3.5-contact", args.device)
    scene = build_scene(args.scene, args.seed, args.bodies, args.restitution, args.damping)

    def run(model, dt):
        return run_model(model, scene, dt, args.steps, args.stiffness, args.baumgarte, args.iters,
                         args.skip, progress.steps(args.steps, f"{model}, dt = {dt:g} s"))

    names = [model for model in MODELS if args.contact in ("all", model)]
    if len(names) > 1 and args.scene == "pile" and len(scene.mass) > SLIDING:
        names.remove("exact")
        print(f"exact is left out of piles of more than {SLIDING}; ask for it by --contact exact")
    runs = {model: run(model, args.dt) for model in names}
    quality = {model: contact_quality(found, scene, args.dt, runs.get("exact"))
               for model, found in runs.items()}
    grid = {} if args.contact != "all" else measure_stability(
        run, scene, args.dt, args.stiffness, runs)
    metrics = results.rounded({
        "scene": args.scene, "contact": args.contact, "dt": args.dt, "steps": args.steps,
        "seed": args.seed, "stiffness": args.stiffness, "restitution": scene.restitution,
        "quality": quality, "stability": grid})
    print_report(args, metrics["quality"], metrics["stability"])
    paths = [os.path.join(args.out, name) for name in ("metrics.json", "contact.rrd")]
    results.write_json(paths[0], metrics)
    print("metrics:", paths[0])
    if args.rerun:
        try:
            log_rerun(paths[1], runs, scene)
            print(f"recording: {paths[1]}, open it with: rerun {paths[1]}")
        except ImportError:
            print("no recording: rerun is not installed, pip install rerun-sdk")
    print("config_hash:", results.fingerprint(vars(args), but=("out", "rerun", "skip")))
    return 0

if __name__ == "__main__":
    sys.exit(main())
# --- endregion ---
