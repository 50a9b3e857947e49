"""The fast twin of contact.py: the same steps for many balls, as loops that numba compiles.

A function here that is named as one of contact.py does the same operations in the same order, so
a run has the same bits. What is new is how near balls are found: by their shadows on one axis, and
from a list that is good until some ball has moved, and in which neighbours share no ball. Balls and
contacts are rows of a table; the last ball is the floor. Nothing may be rounded differently: no
fast-math, no fused multiply-add.
"""

import math
from typing import NamedTuple

import numpy as np

import contact
from curriculum import commands

try:
    import numba
except ModuleNotFoundError:
    raise ImportError(commands.to_install("numba")) from None

if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]  # contact.py's own loops are faster
    raise ImportError("numba is told not to compile (NUMBA_DISABLE_JIT)")

MODELS = ["penalty", "lcp", "leapfrog", "soft"]
PENALTY, LCP, LEAPFROG, SOFT = range(4)
STATES = 200_000  # positions of balls that are filled in one go, before progress() hears of it
STATE = "vx vy inv_mass radius x y listed_x listed_y fx fy mass"  # listed: when pairs were
BALL = np.dtype([(name, float) for name in STATE.split()])
PAIR = "nx ny depth m_eff target softness lam".split()
CONTACT = np.dtype(  # uint32: no index can be negative, and a row has 64 bytes
    [(name, np.uint32) for name in "ab"] + [(name, float) for name in PAIR]
)


class Knobs(NamedTuple):
    """What a step needs to know, in numbers: contact.Settings, and what contact.py fixes."""

    model: int  # of MODELS
    iters: int
    most_sweeps: int  # of soft
    solref: tuple
    solimp: tuple
    dt: float
    gravity: float
    margin: float  # of lcp and leapfrog
    opens: float  # of leapfrog: contact.OPENS
    skin: float  # m: how much farther the list of pairs looks than it must
    stiffness: float
    damping: float
    restitution: float
    baumgarte: float
    warm: float  # share of the last step's impulses that the sweeps start from
    last_bits: float


def compiled(function):
    """The function compiled, and kept on disk for the next process if there is a place for it."""
    try:
        return numba.njit(function, cache=True)
    except RuntimeError:  # none of the folders that numba tries is writable
        return numba.njit(function)


@compiled
def larger(first, second):
    """Python's max of two floats: the first unless the second is larger, so never NaN for 0."""
    return second if second > first else first


@compiled
def list_pairs(balls, reach):
    """The pairs (2, M) of balls whose gap is at most `reach` [m] now: first < second, in order.

    Near balls are found by their shadows on the axis of the wider spread. A shadow is as long as
    its own ball is wide, so one large ball costs no more than itself; above is room for `reach` and
    for rounding. A ball that is nowhere is in no pair: it touches nothing for ever.
    """
    for ball in balls:
        ball.listed_x, ball.listed_y = ball.x, ball.y
    x, y, radius = balls["x"][:-1], balls["y"][:-1], balls["radius"][:-1]
    place = y if np.ptp(y) > np.ptp(x) else x
    low = place - radius
    high = place + (1.0 + 1e-9) * (radius + reach) + 1e-15 * np.abs(place)
    order, count, size = np.argsort(low), len(balls), 0
    keys = np.empty(4 * count, np.int64)  # a number for each pair, which grows as pairs do
    for k in range(len(order)):
        i = order[k]
        for j in order[k + 1 :]:
            if low[j] > high[i]:
                break
            dx, dy = balls[i].x - balls[j].x, balls[i].y - balls[j].y
            limit = (balls[i].radius + balls[j].radius + reach) * (1.0 + 1e-9)
            if dx * dx + dy * dy <= limit * limit:
                if size == len(keys):
                    keys = np.concatenate((keys, keys))
                keys[size] = min(i, j) * count + max(i, j)
                size += 1
    keys = np.sort(keys[:size])
    return np.stack((keys // count, keys % count))


@compiled
def spread_out(pairs, count):
    """The pairs (2, M) reordered so that neighbours share no ball: a processor overlaps their work.

    Pairs that share a ball keep their order, and what others do to each other's balls is nothing,
    so no bit changes.
    """
    size = pairs.shape[1]
    rounds = np.empty(size, np.int64)
    next_round = np.zeros(count, np.int64)  # of each ball
    for k in range(size):
        i, j = pairs[0, k], pairs[1, k]
        rounds[k] = max(next_round[i], next_round[j])
        next_round[i] = next_round[j] = rounds[k] + 1
    return pairs[:, np.sort(rounds * size + np.arange(size)) % size]


@compiled
def farthest_move(balls):
    """How far [m] the farthest ball has moved since the pairs were listed; 0 for one nowhere."""
    farthest = 0.0
    for ball in balls:
        dx, dy = ball.x - ball.listed_x, ball.y - ball.listed_y
        farthest = larger(farthest, dx * dx + dy * dy)
    return math.sqrt(farthest)


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
        dx, dy = a.x - b.x, a.y - b.y
        distance = math.sqrt(dx * dx + dy * dy)
        depth = a.radius + b.radius - distance
        if depth > -margin:
            nx, ny = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
            set_contact(contacts[count], balls, i, j, nx, ny, depth)
            count += 1
    return contacts[:count]


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


@compiled
def penalty_step(balls, contacts, knobs):
    """One step with the force of a spring and a damper."""
    for ball in balls:
        ball.fx = ball.fy = 0.0
    for c in contacts:
        a, b = balls[c.a], balls[c.b]
        f_n = larger(0.0, knobs.stiffness * c.depth - knobs.damping * normal_velocity(c, balls))
        a.fx += f_n * c.nx
        a.fy += f_n * c.ny
        b.fx -= f_n * c.nx
        b.fy -= f_n * c.ny
    accelerate(balls, knobs.dt, knobs.gravity)
    move(balls, knobs.dt)


@compiled
def accelerate(balls, dt, gravity):
    """The velocity that gravity and the forces add to every ball that can move."""
    for ball in balls[:-1]:
        if ball.inv_mass > 0.0:
            ball.vx += dt * (ball.fx / ball.mass)
            ball.vy += dt * (gravity + ball.fy / ball.mass)


@compiled
def move(balls, dt):
    """Move every ball with its velocity for one step."""
    for ball in balls:
        ball.x += dt * ball.vx
        ball.y += dt * ball.vy


@compiled
def step_reach(balls, knobs):
    """How far [m] a step looks: by a margin, or as far as two of the fastest balls travel in it."""
    if knobs.model != LEAPFROG:
        return knobs.margin
    fastest = 0.0
    for ball in balls[:-1]:
        fastest = larger(fastest, ball.vx * ball.vx + ball.vy * ball.vy)
    return larger(knobs.margin, 2.0 * knobs.dt * (math.sqrt(fastest) - knobs.dt * knobs.gravity))


@compiled
def contact_target(c, balls, restitution, baumgarte, dt):
    """The normal velocity [m/s] with which contact c must leave at least."""
    bias = baumgarte / dt * c.depth
    if restitution == 0.0:
        return bias
    v_n = normal_velocity(c, balls)
    bounce = -restitution * v_n
    if bias > 0.0:
        return larger(bias, bounce)
    close = c.depth / dt
    return bounce if dt * v_n <= c.depth or not close < bounce else close


@compiled
def warm_start(balls, contacts, last, share):
    """Start from a share of the last step's impulses: both tables are in the same order."""
    count, k = len(balls), 0
    for c in contacts:
        while k < len(last) and rank(last[k], count) < rank(c, count):
            k += 1
        if k < len(last) and rank(last[k], count) == rank(c, count):
            c.lam = share * last[k].lam
        push(c, balls, c.lam)


@compiled
def rank(c, count):
    """A number that grows along a table of contacts: those with the floor come first."""
    return c.a if c.b == count - 1 else (c.a + 1) * count + c.b


@compiled
def solve_contacts(balls, contacts, iters, tolerance):
    """Projected Gauss-Seidel; whether a sweep came with no correction above `tolerance` [m/s]."""
    for _ in range(iters):
        settled = True
        for c in contacts:
            missing = c.target - normal_velocity(c, balls) - c.softness * c.lam
            lam = larger(0.0, c.lam + missing * c.m_eff)
            change = lam - c.lam
            push(c, balls, change)
            c.lam = lam
            settled = settled and abs(change) <= tolerance * c.m_eff
        if settled:
            return True
    return False


@compiled
def lcp_step(balls, contacts, last, knobs):
    """One step: gravity predicts the velocities, impulses correct them, the balls move."""
    for c in contacts:
        c.target = contact_target(c, balls, knobs.restitution, knobs.baumgarte, knobs.dt)
    accelerate(balls, knobs.dt, knobs.gravity)
    if knobs.warm > 0.0:
        warm_start(balls, contacts, last, knobs.warm)
    solve_contacts(balls, contacts, knobs.iters, 0.0)
    move(balls, knobs.dt)


@compiled
def solve_with_momentum(balls, contacts, iters):
    """The sweeps, each carried on by a share of its change, until nothing changes."""
    t = 1.0
    start, before = contacts["lam"].copy(), contacts["lam"].copy()
    for _ in range(iters):
        if solve_contacts(balls, contacts, 1, 0.0):
            return
        onward = 0.0
        for k, c in enumerate(contacts):
            onward += (c.lam - start[k]) * (c.lam - before[k])
        if onward < 0.0:
            t = 1.0
        longer = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * t * t))
        share, t = (t - 1.0) / longer, longer
        for k, c in enumerate(contacts):
            start[k] = larger(0.0, c.lam + share * (c.lam - before[k]))
            before[k] = c.lam
            push(c, balls, start[k] - c.lam)
            c.lam = start[k]


@compiled
def leapfrog_step(balls, contacts, knobs):
    """One step: half of gravity, ask for the way, move, half of gravity, ask for the speed."""
    half = 0.5 * knobs.dt
    after, stays = np.empty(len(contacts)), np.empty(len(contacts))
    hits, free = np.empty(len(contacts), np.bool_), np.empty(len(contacts), np.bool_)
    for k, c in enumerate(contacts):
        after[k], stays[k], hits[k], free[k] = ask(c, balls, knobs)
    accelerate(balls, half, knobs.gravity)
    vx, vy = balls["vx"].copy(), balls["vy"].copy()
    solve_with_momentum(balls, contacts, knobs.iters)
    if no_room(balls, contacts, stays, free):
        balls["vx"][:], balls["vy"][:] = vx, vy
        contacts["lam"][:] = 0.0
        solve_with_momentum(balls, contacts, knobs.iters)
    move(balls, knobs.dt)
    accelerate(balls, half, knobs.gravity)
    struck = np.zeros(len(balls), np.bool_)
    for k, c in enumerate(contacts):
        if c.lam > 0.0 and hits[k] and knobs.restitution > 0.0:
            struck[c.a] = struck[c.b] = True
    closed = 0  # those that pushed become the first rows
    for k, c in enumerate(contacts):
        if c.lam > 0.0:
            if not (hits[k] or struck[c.a] or struck[c.b]):
                turn(c, balls, 0.0)
            c.target = after[k]
            contacts[closed] = c
            closed += 1
    solve_with_momentum(balls, contacts[:closed], knobs.iters)


@compiled
def ask(c, balls, knobs):
    """Set what leapfrog asks of the way of c; returns c.after, c.stays, c.hits and c.free."""
    restitution, dt, gravity = knobs.restitution, knobs.dt, knobs.gravity
    turn(c, balls, dt)
    a, b = balls[c.a], balls[c.b]
    gap, v_n = -c.depth, normal_velocity(c, balls)
    a_n = gravity * c.ny * ((a.inv_mass > 0.0) - (b.inv_mass > 0.0))
    when = time_to_impact(gap, v_n, a_n) if gap > 0.0 else 0.0
    hit = v_n + when * a_n if when < dt else 0.0
    back = -restitution * (v_n + dt * a_n)
    opens = knobs.opens * (a.radius + b.radius)
    stays = (opens if opens < -gap else -gap) / dt
    hits = hit < dt * gravity
    c.target = stays
    after = back if back < 0.0 or (v_n < dt * gravity and not hits) else 0.0
    left = dt - when
    end = left * (-restitution * hit + 0.5 * left * a_n)
    if hits and end > 0.0:
        c.target = larger(c.target, (end - larger(gap, 0.0)) / dt)
        bounce = -restitution * hit + left * a_n
        after = back if back < bounce else bounce
    return after, stays, hits, not hits and stays < v_n + dt * gravity


@compiled
def no_room(balls, contacts, stays, free):
    """Take back the way of each bounce that drove a ball into one that it would not have met."""
    crowd = np.zeros(len(balls), np.bool_)
    for k, c in enumerate(contacts):
        if free[k] and c.lam > 0.0:
            crowd[c.a], crowd[c.b] = balls[c.a].inv_mass > 0.0, balls[c.b].inv_mass > 0.0
    grows = crowd.any()
    while grows:
        grows = False
        for c in contacts:
            if c.lam > 0.0 and crowd[c.a] != crowd[c.b]:
                other = c.b if crowd[c.a] else c.a
                if balls[other].inv_mass > 0.0:
                    crowd[other] = grows = True
    found = False
    for k, c in enumerate(contacts):
        if c.target > stays[k] and (crowd[c.a] or crowd[c.b]):
            c.target = stays[k]
            found = True
    return found


@compiled
def turn(c, balls, dt):
    """Turn the normal of c to when its balls meet in free flight, or are nearest, within dt [s]."""
    a, b = balls[c.a], balls[c.b]
    dx, dy = a.x - b.x, a.y - b.y
    vx, vy = a.vx - b.vx, a.vy - b.vy
    reach = a.radius + b.radius
    along = dx * vx + dy * vy
    fast = vx * vx + vy * vy
    apart = dx * dx + dy * dy - reach * reach
    t = 0.0
    if apart > 0.0 and along < 0.0:
        t = dt
        if fast > 0.0:
            t = (-along - math.sqrt(larger(0.0, along * along - fast * apart))) / fast
            t = t if t < dt else dt
    x, y = dx + t * vx, dy + t * vy
    distance = math.sqrt(x * x + y * y)
    if c.b < len(balls) - 1 and distance > 0.0:
        c.nx, c.ny = x / distance, y / distance
        c.depth = reach - (c.nx * dx + c.ny * dy)


@compiled
def time_to_impact(gap, v_n, a_n):
    """When a gap closes [s]; inf if it does not."""
    square = v_n * v_n - 2.0 * gap * a_n
    if square < 0.0 or not (v_n < 0.0 or a_n < 0.0):
        return math.inf
    root = math.sqrt(square)
    return 2.0 * gap / (root - v_n) if v_n < 0.0 else -(v_n + root) / a_n


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
def soft_step(balls, contacts, last, knobs):
    """One step of MuJoCo's contact: lcp's step with another target, and softness.

    Returns whether its sweeps settled.
    """
    for c in contacts:
        soften(c, balls, knobs.dt, knobs.solref, knobs.solimp)
    accelerate(balls, knobs.dt, knobs.gravity)
    fastest = abs(contacts[0].target) if len(contacts) > 0 else 0.0  # NaN if that is NaN
    for c in contacts:
        fastest = larger(fastest, abs(c.target))
    for ball in balls[:-1]:
        fastest = larger(larger(fastest, abs(ball.vx)), abs(ball.vy))
    warm_start(balls, contacts, last, knobs.warm)
    settled = solve_contacts(balls, contacts, knobs.most_sweeps, knobs.last_bits * fastest)
    move(balls, knobs.dt)
    return settled


def make_balls(q, v, mass, radius) -> np.ndarray:
    """The balls of a state: q, v (2, N), mass, radius (N,). The floor comes last."""
    balls = np.zeros(len(mass) + 1, BALL)
    for name, values in zip(("x", "y", "vx", "vy", "mass", "radius"), (*q, *v, mass, radius)):
        balls[name][:-1] = values
    balls["inv_mass"][:-1] = 1.0 / balls["mass"][:-1]
    return balls


@compiled
def same(state, other, contacts, others):
    """Whether states and impulses are equal. Then their futures are, but for signs of zeros."""
    for one, two in zip(state.flat, other.flat):
        if one != two:
            return False
    for c, d in zip(contacts, others):
        if c.a != d.a or c.b != d.b or c.lam != d.lam:
            return False
    return len(contacts) == len(others)


@compiled
def take_steps(rows, settled, balls, pairs, listed, last, cycles, knobs):
    """Take len(rows) - 1 steps, and write the states to rows[1:].

    settled[k] becomes False where the sweeps of step k did not settle. `pairs` had gaps of at most
    `listed` [m]; `last` are the contacts of the step before. Returns these three at the end, the
    steps taken, and 0. With `cycles` a state that has come before ends the steps, and in place of
    0 stands how many steps ago it was. A state is compared with one other, that of the largest
    power of two (Brent 1980).
    """
    contacts = spare = np.empty(0, CONTACT)
    mark, marked = 1, last[:0]
    for k in range(1, len(rows)):
        reach = step_reach(balls, knobs)
        if not farthest_move(balls) <= 0.499 * (listed - reach):  # two balls may have come so near
            listed = reach + knobs.skin
            pairs = list_pairs(balls, listed)
            if knobs.warm == 0.0 and knobs.model != LEAPFROG:  # these need them in order
                pairs = spread_out(pairs, len(balls))
        if len(contacts) < len(balls) + pairs.shape[1]:
            contacts = np.empty(len(balls) + 2 * pairs.shape[1], CONTACT)
        found = detect_contacts(balls, pairs, reach, contacts)
        if knobs.model == PENALTY:
            penalty_step(balls, found, knobs)
        elif knobs.model == LCP:
            lcp_step(balls, found, last, knobs)
        elif knobs.model == LEAPFROG:
            leapfrog_step(balls, found, knobs)
        else:
            settled[k] = soft_step(balls, found, last, knobs)
        for i in range(rows.shape[2]):
            rows[k, 0, i], rows[k, 1, i] = balls[i].x, balls[i].y
            rows[k, 2, i], rows[k, 3, i] = balls[i].vx, balls[i].vy
        if knobs.warm > 0.0:
            last = found
            contacts, spare = spare, contacts
        if cycles and k > mark and same(rows[k], rows[mark], last, marked):
            return pairs, listed, last.copy(), k, k - mark
        if k == 2 * mark or k == 1:
            mark, marked = k, last.copy()
    return pairs, listed, last.copy(), len(rows) - 1, 0


class Stepper:
    """A run by a model that steps, which can be taken on by some steps at a time."""

    def __init__(self, model, scene, dt, settings):
        solref, solimp = contact.soft_defaults(
            scene.restitution, dt, settings.solref, settings.solimp
        )
        warm = {"lcp": settings.warm, "soft": 1.0}.get(model, 0.0)
        margin = contact.CONTACT_MARGIN if model in ("lcp", "leapfrog") else 0.0
        skin, stiffness, beta = np.median(scene.radius), settings.stiffness, settings.baumgarte
        numbers = dt, contact.GRAVITY, margin, contact.OPENS, skin, stiffness, scene.damping
        numbers += scene.restitution, beta, warm, contact.LAST_BITS
        self.knobs = Knobs(
            MODELS.index(model),
            int(settings.iters),
            contact.MOST_SWEEPS,
            tuple(map(float, solref)),
            tuple(map(float, solimp)),
            *map(float, numbers),
        )
        self.balls = make_balls(scene.q0, scene.v0, scene.mass, scene.radius)
        self.listed, self.pairs = -math.inf, np.empty((2, 0), int)
        self.last = np.empty(0, CONTACT)

    def take(self, rows, settled, cycles) -> tuple[int, int]:
        """Take len(rows) - 1 steps at most, as take_steps does; returns steps and period."""
        self.pairs, self.listed, self.last, steps, period = take_steps(
            rows, settled, self.balls, self.pairs, self.listed, self.last, cycles, self.knobs
        )
        return steps, period


def run_model(model, scene, dt, steps, settings, progress=None) -> contact.Run:
    """The run by a model that steps: what contact.run_model gives, bit for bit.

    `progress(k)` is called with the steps done, now and then.
    """
    stepper = Stepper(model, scene, dt, settings)
    rows = np.empty((steps + 1, 4, len(scene.mass)))
    rows[0, :2], rows[0, 2:] = scene.q0, scene.v0
    settled = np.ones(steps + 1, bool)
    k, period = 0, 0
    while k < steps and not period:
        end = min(k + 1 + STATES // len(scene.mass), steps)
        taken, period = stepper.take(rows[k : end + 1], settled[k : end + 1], settings.skip)
        k += taken
        if progress:
            progress(k)
    for past in range(k - period + 1, k + 1):  # what comes again and again
        rows[past + period :: period] = rows[past]
        settled[past + period :: period] = settled[past]
    rows += 0.0  # turns -0.0 into 0.0
    rows[np.isnan(rows)] = math.nan  # which has a sign too, left to chance
    return contact.Run(np.arange(steps + 1) * dt, rows[:, :2], rows[:, 2:])


def smallest_gap(q, radius) -> np.ndarray:
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N)."""
    balls = make_balls(q[0], np.zeros_like(q[0]), np.ones(len(radius)), radius)
    return find_gaps(np.array(q, float), balls, float(np.median(radius)))


@compiled
def find_gaps(q, balls, skin):
    """The smallest gap in each state.

    A pair that is not listed was farther apart than `reach`, and may have come nearer by what two
    balls have moved. Where that does not decide, the pairs are listed anew, as far as it takes.
    """
    gaps = np.empty(len(q))
    pairs = list_pairs(balls, 0.0)
    reach = -math.inf
    for k in range(len(q)):
        balls["x"][:-1], balls["y"][:-1] = q[k, 0], q[k, 1]
        if not np.isfinite(q[k]).all():
            gaps[k] = gap_of_all(balls)
            continue
        gaps[k] = gap_of_listed(balls, pairs)
        if not gaps[k] < 0.999 * reach - 2.0 * farthest_move(balls):
            reach, gaps[k] = 0.5 * skin + 1e-150, math.inf
            while not gaps[k] < 0.999 * reach:
                reach *= 2.0
                pairs = list_pairs(balls, reach)
                gaps[k] = gap_of_listed(balls, pairs)
    return gaps


@compiled
def gap_between(a, b):
    """The gap [m] between two balls."""
    dx, dy = b.x - a.x, b.y - a.y
    return math.sqrt(dx * dx + dy * dy) - (b.radius + a.radius)


@compiled
def gap_of_listed(balls, pairs):
    """The smallest gap to the floor or between listed balls."""
    gap = (balls["y"][:-1] - balls["radius"][:-1]).min()
    for k in range(pairs.shape[1]):
        gap = min(gap, gap_between(balls[pairs[0, k]], balls[pairs[1, k]]))
    return gap


@compiled
def gap_of_all(balls):
    """The smallest gap of all; NaN if any gap is."""
    gap = (balls["y"][:-1] - balls["radius"][:-1]).min()
    for i in range(len(balls) - 1):
        for j in range(i):
            gap = np.minimum(gap, gap_between(balls[i], balls[j]))
    return gap
