"""The fast twin of contact.py: the same steps for many balls, as loops compiled by numba.

A function here that is named as one of contact.py does the same operations in the same order, so
a run has the same bits. What is new is how near balls are found: by cells, and from a list that
is good until some ball has moved. Balls and contacts are rows of a table; the last ball is the
floor. Nothing may be rounded differently: no fast-math, no fused multiply-add.
"""

# --- region: piles-setup ---
import math
from typing import NamedTuple

import numba
import numpy as np

MODELS = ("penalty", "lcp", "soft")
PENALTY, LCP, SOFT = range(3)
SKIN = 1.0      # of the largest radius: how much farther the list of pairs looks than it must
# np.record, so that the loops also run without being compiled (NUMBA_DISABLE_JIT=1)
BALL = np.dtype((np.record, [(name, float) for name in (
    "vx", "vy", "inv_mass", "radius", "x", "y",
    "listed_x", "listed_y",                     # where it was when the pairs were listed
    "fx", "fy", "mass")]))
CONTACT = np.dtype((np.record, [("a", np.int64), ("b", np.int64), *[(name, float) for name in (
    "nx", "ny", "depth", "m_eff", "target", "softness", "lam")]]))


class Knobs(NamedTuple):
    """The settings of a run, as contact.run_model has them."""

    model: int
    dt: float
    gravity: float
    margin: float           # of lcp
    stiffness: float
    damping: float
    restitution: float
    baumgarte: float
    iters: int
    most_sweeps: int        # of soft
    last_bits: float
    solref: tuple
    solimp: tuple


def compiled(function):
    """The function compiled, and kept on disk for the next process if there is a place for it."""
    try:
        return numba.njit(function, cache=True)
    except RuntimeError:                        # none of the folders that numba tries is writable
        return numba.njit(function)


@compiled
def larger(first, second):
    """Python's max of two floats: the first unless the second is larger, so never NaN for 0."""
    return second if second > first else first
# --- endregion ---


# --- region: piles-cells ---
@compiled
def finite(ball):
    """Whether the ball is somewhere. One that is not touches nothing, now and for ever."""
    return math.isfinite(ball.x) and math.isfinite(ball.y)


@compiled
def largest_radius(balls):
    """The radius [m] of the largest ball."""
    largest = 0.0
    for ball in balls[:-1]:
        largest = larger(largest, ball.radius)
    return largest


@compiled
def cell_at(distance, side):
    """The number of a cell. Where cells would be finer than floats, all are one."""
    number = distance / side
    return int(number) if number < 2.0**44 else 2**44


@compiled
def find_cells(balls, side):
    """Column and row of the cell of every ball, counted from the lowest ball."""
    left = low = math.inf
    for ball in balls[:-1]:
        if finite(ball):
            left = min(left, ball.x)
            low = min(low, ball.y)
    cells = np.empty((len(balls) - 1, 2), np.int64)
    for i in range(len(cells)):
        if finite(balls[i]):
            cells[i, 0] = cell_at(balls[i].x - left, side)
            cells[i, 1] = cell_at(balls[i].y - low, side)
    return cells
# --- endregion ---


# --- region: piles-buckets ---
@compiled
def bucket_of(column, row, buckets):
    """The bucket of a cell, one of a power of two. Several cells may share it."""
    return (column + row * 19349663) & (buckets - 1)


@compiled
def look_around(cell, cells, newest, older, found):
    """Write to `found` the balls in the nine cells around this one, and return how many."""
    count = 0
    for column in range(cell[0] - 1, cell[0] + 2):
        for row in range(cell[1] - 1, cell[1] + 2):
            j = newest[bucket_of(column, row, len(newest))]
            while j >= 0:
                if cells[j, 0] == column and cells[j, 1] == row:
                    found[count] = j
                    count += 1
                j = older[j]
    return count
# --- endregion ---


# --- region: piles-pairs ---
@compiled
def list_pairs(balls, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    The balls enter the cells from the last to the first, so that each finds those after it. A
    cell is a little wider than two listed balls can be apart, because of rounding.
    """
    count = len(balls) - 1
    for ball in balls[:-1]:
        ball.listed_x = ball.x
        ball.listed_y = ball.y
    cells = find_cells(balls, max(1.02 * (2.0 * largest_radius(balls) + reach), 1e-150))
    buckets = 16
    while buckets < 2 * count:
        buckets *= 2
    newest = np.full(buckets, -1)
    older = np.empty(count, np.int64)
    found = np.empty(count, np.int64)
    pairs = np.empty((2, 4 * count), np.int64)
    size = 0
    for i in range(count - 1, -1, -1):
        if finite(balls[i]):
            near = found[:look_around(cells[i], cells, newest, older, found)]
            near = near[:keep_near(i, near, balls, reach)]
            pairs = make_room(pairs, size + len(near))
            pairs[0, size:size + len(near)] = i
            pairs[1, size:size + len(near)] = near
            size += len(near)
            bucket = bucket_of(cells[i, 0], cells[i, 1], buckets)
            older[i] = newest[bucket]
            newest[bucket] = i
    return pairs[:, :size][:, ::-1].copy()
# --- endregion ---


# --- region: piles-near ---
@compiled
def keep_near(i, found, balls, reach):
    """Keep the balls near ball i at the front of `found`, the largest first; return how many."""
    count = 0
    for j in found:
        dx = balls[i].x - balls[j].x
        dy = balls[i].y - balls[j].y
        limit = (balls[i].radius + balls[j].radius + reach) * (1.0 + 1e-9)
        if dx * dx + dy * dy <= limit * limit:
            place = count
            while place > 0 and found[place - 1] < j:
                found[place] = found[place - 1]
                place -= 1
            found[place] = j
            count += 1
    return count


@compiled
def make_room(pairs, size):
    """The pairs, copied to a table twice as wide if `size` of them do not fit."""
    if size <= pairs.shape[1]:
        return pairs
    wider = np.empty((2, 2 * size), np.int64)
    wider[:, :pairs.shape[1]] = pairs
    return wider
# --- endregion ---


# --- region: piles-moves ---
@compiled
def farthest_move(balls):
    """How far [m] the farthest ball has moved since the pairs were listed; 0 for one nowhere."""
    farthest = 0.0
    for ball in balls[:-1]:
        dx = ball.x - ball.listed_x
        dy = ball.y - ball.listed_y
        farthest = larger(farthest, dx * dx + dy * dy)
    return math.sqrt(farthest)
# --- endregion ---


# --- region: piles-contacts ---
@compiled
def set_contact(c, balls, a, b, nx, ny, depth):
    """Make row c the contact of balls a and b."""
    c.a, c.b = a, b
    c.nx, c.ny = nx, ny
    c.depth = depth
    inv_mass = balls[a].inv_mass + balls[b].inv_mass
    c.m_eff = 1.0 / inv_mass if inv_mass > 0.0 else 0.0
    c.target = c.softness = c.lam = 0.0


@compiled
def detect_contacts(balls, pairs, margin, contacts):
    """The contacts as the first rows of `contacts`: the floor's by ball, then those of pairs."""
    floor = len(balls) - 1
    count = 0
    for i in range(floor):
        depth = balls[i].radius - balls[i].y
        if depth > -margin:
            set_contact(contacts[count], balls, i, floor, 0.0, 1.0, depth)
            count += 1
    for k in range(pairs.shape[1]):
        i, j = pairs[0, k], pairs[1, k]
        a, b = balls[i], balls[j]
        dx = a.x - b.x
        dy = a.y - b.y
        distance = math.sqrt(dx * dx + dy * dy)
        depth = a.radius + b.radius - distance
        if depth > -margin:
            nx, ny = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
            set_contact(contacts[count], balls, i, j, nx, ny, depth)
            count += 1
    return contacts[:count]
# --- endregion ---


# --- region: piles-impulse ---
@compiled
def normal_velocity(c, balls):
    """v_n [m/s] of a contact."""
    a, b = balls[c.a], balls[c.b]
    return c.nx * (a.vx - b.vx) + c.ny * (a.vy - b.vy)


@compiled
def push(c, balls, impulse):
    """Give the first ball this impulse [N s] along the normal, the second the opposite one."""
    a, b = balls[c.a], balls[c.b]
    a.vx += impulse * (a.inv_mass * c.nx)
    a.vy += impulse * (a.inv_mass * c.ny)
    if c.b < len(balls) - 1:
        b.vx -= impulse * (b.inv_mass * c.nx)
        b.vy -= impulse * (b.inv_mass * c.ny)
# --- endregion ---


# --- region: piles-penalty ---
@compiled
def penalty_step(balls, contacts, knobs):
    """One step with the force of a spring and a damper."""
    for ball in balls:
        ball.fx = ball.fy = 0.0
    for c in contacts:
        v_n = normal_velocity(c, balls)
        f_n = larger(0.0, knobs.stiffness * c.depth - knobs.damping * v_n)
        balls[c.a].fx += f_n * c.nx
        balls[c.a].fy += f_n * c.ny
        balls[c.b].fx -= f_n * c.nx
        balls[c.b].fy -= f_n * c.ny
    for ball in balls[:-1]:
        if ball.inv_mass > 0.0:
            ball.vx += knobs.dt * (ball.fx / ball.mass)
            ball.vy += knobs.dt * (knobs.gravity + ball.fy / ball.mass)
    move(balls, knobs.dt)


@compiled
def fall(balls, speed):
    """Add `speed` [m/s] to vy of every ball that can move."""
    for ball in balls[:-1]:
        if ball.inv_mass > 0.0:
            ball.vy += speed


@compiled
def move(balls, dt):
    """Move every ball with its velocity for one step."""
    for ball in balls[:-1]:
        ball.x += dt * ball.vx
        ball.y += dt * ball.vy
# --- endregion ---


# --- region: piles-lcp ---
@compiled
def contact_target(depth, v_n, restitution, baumgarte, dt):
    """The normal velocity [m/s] with which a contact must leave at least."""
    bias = baumgarte / dt * depth
    if restitution == 0.0:
        return bias
    bounce = -restitution * v_n
    if bias > 0.0:
        return larger(bias, bounce)
    if dt * v_n <= depth or not depth / dt < bounce:
        return bounce
    return depth / dt


@compiled
def solve_contacts(balls, contacts, iters, tolerance):
    """Projected Gauss-Seidel until no correction of a sweep is above `tolerance` [m/s]."""
    for _ in range(iters):
        settled = True
        for c in contacts:
            missing = c.target - normal_velocity(c, balls) - c.softness * c.lam
            lam = larger(0.0, c.lam + missing * c.m_eff)
            if lam != c.lam:
                change = lam - c.lam
                push(c, balls, change)
                c.lam = lam
                if not abs(change) <= tolerance * c.m_eff:
                    settled = False
        if settled:
            break
# --- endregion ---


# --- region: piles-lcp-step ---
@compiled
def lcp_step(balls, contacts, knobs):
    """One step: gravity predicts the velocities, impulses correct them, the balls move."""
    for c in contacts:
        v_n = normal_velocity(c, balls)
        c.target = contact_target(c.depth, v_n, knobs.restitution, knobs.baumgarte, knobs.dt)
    fall(balls, knobs.dt * knobs.gravity)
    solve_contacts(balls, contacts, knobs.iters, 0.0)
    move(balls, knobs.dt)
# --- endregion ---


# --- region: piles-impedance ---
@compiled
def impedance(depth, solimp):
    """How hard a contact of MuJoCo is at that depth [m]."""
    d0, d1, width, mid, power = solimp
    if width <= 1e-15:
        return 0.5 * (d0 + d1)
    if depth >= width:
        return d1
    x = depth / width
    if x <= mid:
        y = raised(x, power) / raised(mid, power - 1.0)
    else:
        y = 1.0 - raised(1.0 - x, power) / raised(1.0 - mid, power - 1.0)
    return d0 + y * (d1 - d0)


@compiled
def raised(x, power):
    """x to that power; a whole power by products."""
    if power != int(power):
        return x**power
    product = 1.0
    for _ in range(int(power)):
        product *= x
    return product
# --- endregion ---


# --- region: piles-soft ---
@compiled
def soften(c, balls, dt, solref, solimp):
    """Give contact c the target and the softness that MuJoCo's contact has."""
    d = impedance(c.depth, solimp)
    d1 = solimp[1]
    if solref[0] > 0.0:
        timeconst, dampratio = solref
        K = 1.0 / (d1 * d1 * timeconst * timeconst * dampratio * dampratio)
        B = 2.0 / (d1 * timeconst)
    else:
        K = -solref[0] / (d1 * d1)
        B = -solref[1] / d1
    v_n = normal_velocity(c, balls)
    inv_mass = balls[c.a].inv_mass + balls[c.b].inv_mass
    c.target = v_n + dt * (K * d * c.depth - B * v_n)
    c.softness = larger(1e-15, (1.0 - d) / d * inv_mass)
    c.m_eff = 1.0 / (inv_mass + c.softness)


@compiled
def soft_step(balls, contacts, knobs):
    """One step of MuJoCo's contact: lcp's step with another target, and softness."""
    for c in contacts:
        soften(c, balls, knobs.dt, knobs.solref, knobs.solimp)
    fall(balls, knobs.dt * knobs.gravity)
    fastest = abs(contacts[0].target) if len(contacts) > 0 else 0.0
    for c in contacts:
        fastest = larger(fastest, abs(c.target))
    for ball in balls[:-1]:
        fastest = larger(larger(fastest, abs(ball.vx)), abs(ball.vy))
    solve_contacts(balls, contacts, knobs.most_sweeps, knobs.last_bits * fastest)
    move(balls, knobs.dt)
# --- endregion ---


# --- region: piles-states ---
@compiled
def make_balls(state, mass, radius):
    """The balls of a state (4, N): x, y, vx, vy. The floor comes last."""
    balls = np.zeros(len(mass) + 1, BALL)
    for i in range(len(mass)):
        balls[i].x, balls[i].y = state[0, i], state[1, i]
        balls[i].vx, balls[i].vy = state[2, i], state[3, i]
        balls[i].mass, balls[i].inv_mass = mass[i], 1.0 / mass[i]
        balls[i].radius = radius[i]
    return balls


@compiled
def write_state(balls, state):
    """Write x, y, vx, vy of all balls to a state (4, N)."""
    for i in range(len(balls) - 1):
        state[0, i], state[1, i] = balls[i].x, balls[i].y
        state[2, i], state[3, i] = balls[i].vx, balls[i].vy


@compiled
def same(state, other):
    """Whether two states are equal. Then their futures are, but for the signs of zeros."""
    for row in range(4):
        for i in range(state.shape[1]):
            if state[row, i] != other[row, i]:
                return False
    return True
# --- endregion ---


# --- region: piles-steps ---
@compiled
def take_steps(rows, first, last, mass, radius, knobs):
    """Fill rows[first + 1:last + 1] with the states (4, N) after rows[first].

    A state that has come before starts a cycle, and the rest is copied. Each is compared with
    one earlier state, that of the largest power of two (Brent 1980), so any cycle is found.
    """
    balls = make_balls(rows[first], mass, radius)
    contacts = np.empty(0, CONTACT)
    margin = knobs.margin if knobs.model == LCP else 0.0
    skin = SKIN * largest_radius(balls)
    pairs = list_pairs(balls, margin + skin)
    mark = 1
    for k in range(first + 1, last + 1):
        if farthest_move(balls) > 0.499 * skin:
            pairs = list_pairs(balls, margin + skin)
        if len(contacts) < len(balls) + pairs.shape[1]:
            contacts = np.empty(len(balls) + 2 * pairs.shape[1], CONTACT)
        found = detect_contacts(balls, pairs, margin, contacts)
        if knobs.model == PENALTY:
            penalty_step(balls, found, knobs)
        elif knobs.model == LCP:
            lcp_step(balls, found, knobs)
        else:
            soft_step(balls, found, knobs)
        write_state(balls, rows[k])
        while 2 * mark < k:
            mark *= 2
        if mark < k and same(rows[k], rows[mark]):
            for later in range(k + 1, len(rows)):
                rows[later] = rows[later - k + mark]
            return len(rows) - 1
    return last
# --- endregion ---


# --- region: piles-simulate ---
def simulate(model, scene, dt, steps, report, gravity, margin, stiffness, baumgarte, iters,
             most_sweeps, last_bits, solref, solimp):
    """q and v (steps + 1, 2, N) [m, m/s] of a run by penalty, lcp or soft.

    `report(k)` is called with the steps done, now and then.
    """
    knobs = Knobs(MODELS.index(model), float(dt), float(gravity), float(margin), float(stiffness),
                  float(scene.damping), float(scene.restitution), float(baumgarte), int(iters),
                  int(most_sweeps), float(last_bits), tuple(map(float, solref)),
                  tuple(map(float, solimp)))
    rows = np.empty((steps + 1, 4, len(scene.mass)))
    rows[0, :2] = scene.q0
    rows[0, 2:] = scene.v0
    mass, radius = np.array(scene.mass, float), np.array(scene.radius, float)
    chunk = 1 + 200_000 // len(mass)
    done = 0
    while done < steps:
        done = take_steps(rows, done, min(done + chunk, steps), mass, radius, knobs)
        report(done)
    rows += 0.0                                         # turns -0.0 into 0.0
    rows[np.isnan(rows)] = math.nan                     # which has a sign too, left to chance
    return rows[:, :2], rows[:, 2:]
# --- endregion ---


# --- region: piles-gap ---
def smallest_gap(q, radius):
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N)."""
    return find_gaps(np.array(q, float), np.array(radius, float))


@compiled
def find_gaps(q, radius):
    """The smallest gap in each state.

    A pair that is not listed was farther apart than `reach`, and may have come nearer by what two
    balls have moved. Where that does not decide, the pairs are listed anew, as far as it takes.
    """
    gaps = np.empty(len(q))
    nowhere = np.full((4, len(radius)), math.nan)
    balls = make_balls(nowhere, np.ones(len(radius)), radius)
    pairs = list_pairs(balls, 0.0)
    reach = -math.inf
    for k in range(len(q)):
        for i in range(len(radius)):
            balls[i].x, balls[i].y = q[k, 0, i], q[k, 1, i]
        if not (np.isfinite(q[k]).all() and np.isfinite(radius).all()):
            gaps[k] = gap_of_all(balls)
            continue
        gaps[k] = gap_of_listed(balls, pairs)
        if not gaps[k] < 0.999 * reach - 2.0 * farthest_move(balls):
            reach = SKIN * largest_radius(balls) + 1e-150
            pairs = list_pairs(balls, reach)
            gaps[k] = gap_of_listed(balls, pairs)
            while not gaps[k] < 0.999 * reach:
                reach *= 2.0
                pairs = list_pairs(balls, reach)
                gaps[k] = gap_of_listed(balls, pairs)
    return gaps
# --- endregion ---


# --- region: piles-gap-of ---
@compiled
def gap_between(a, b):
    """The gap [m] between two balls."""
    dx = b.x - a.x
    dy = b.y - a.y
    return math.sqrt(dx * dx + dy * dy) - (b.radius + a.radius)


@compiled
def gap_of_listed(balls, pairs):
    """The smallest gap to the floor or between listed balls."""
    gap = math.inf
    for ball in balls[:-1]:
        gap = min(gap, ball.y - ball.radius)
    for k in range(pairs.shape[1]):
        gap = min(gap, gap_between(balls[pairs[0, k]], balls[pairs[1, k]]))
    return gap


@compiled
def gap_of_all(balls):
    """The smallest gap of all; NaN if any gap is."""
    count = len(balls) - 1
    gap = math.inf
    for i in range(count):
        gap = np.minimum(gap, balls[i].y - balls[i].radius)
        for j in range(i + 1, count):
            gap = np.minimum(gap, gap_between(balls[i], balls[j]))
    return gap
# --- endregion ---
