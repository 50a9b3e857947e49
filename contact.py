# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Contact between bodies, built five times and measured honestly (robotics course, chapter 3.5).

A table keeps a ball from falling through it: it pushes up, and it never pulls down. Five models:
    penalty   a stiff spring and a damper: one more force, and no other change
    lcp       impulses, found by sweeps: each contact pushes, or its bodies part (a linear
              complementarity problem, solved by projected Gauss-Seidel)
    leapfrog  the same sweeps twice a step: for the way, then for the speed
    exact     from one impact to the next, each at its own time: no time step
    soft      the contact of MuJoCo, a simulator of robots: lcp's sweeps, but each contact gives way
Left out: friction, rotation, and all shapes but balls over the line y = 0.

    symbol    meaning                              unit    sign
    x, y      position of a ball's centre; q both  m       y is up
    vx, vy    its velocity; v both                 m/s
    gap       distance of two surfaces             m       > 0 apart
    depth     -gap                                 m       > 0 overlapping
    n         normal of a contact, a unit vector   -       from body b to body a; from the floor up
    v_n       n . (v_a - v_b)                      m/s     > 0 separating
    f_n       contact force of penalty             N       >= 0: a contact only pushes
    lam       contact impulse over one step        N s     >= 0: a contact only pushes
    target    the least v_n after the step         m/s     > 0 separating
    softness  R: v_n stays R lam below its target  1/kg    0 is hard
    m_eff     effective mass, what a push moves    kg      1 / (1 / m_a + 1 / m_b + R)
    e         restitution: share of the speed that a bounce gives back, 0 to 1

Run it:
    python contact.py --contact exact               # what should happen; what will the others do?
    python contact.py --scene drop                  # all models; then: bounce, stack, pile
    python contact.py --contact penalty --dt 0.03   # one model, a longer step
    python contact.py --smoke --no-rerun            # fixed length, the same bytes every time
It needs numpy and nothing else. The course's folder beside it adds the recording, pictures, many
seeds at once, compiled loops for many balls, and exact where balls slide over one another.
"""

# --- region: setup ---
import argparse
import importlib
import itertools
import json
import math
import os
import re
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

try:
    import numpy as np
except ModuleNotFoundError:
    pip = f'"{sys.executable}" -m pip install numpy'
    print(f"contact.py needs numpy: {pip}, or: uv run contact.py", file=sys.stderr)
    sys.exit(2)

GRAVITY = -9.81  # m/s^2, along y
RADIUS = 0.1  # m, of every ball in the scenes; lengths are reported in units of it
CONTACT_MARGIN = 1e-3  # m: lcp also lists smaller gaps, so that they cannot close too fast
MOST_SWEEPS = 10_000  # of a step: exact then gives up, soft goes on and counts it as unsettled
LAST_BITS = 2.0**-42  # of the speeds, chosen: soft sweeps until no correction is above it
SCENES = ("drop", "bounce", "stack", "pile")


# --- region: scenes ---
class Scene(NamedTuple):
    """Balls over the floor: q0, v0 (2, N) [m, m/s]; mass [kg] and radius [m], both (N,)."""

    name: str
    q0: np.ndarray
    v0: np.ndarray
    mass: np.ndarray  # nothing changes the velocity of a ball of infinite mass
    radius: np.ndarray
    restitution: float  # e, of lcp, soft and exact; penalty has no such knob
    damping: float  # c of penalty [N s/m]


def scene_of(x, y, mass=1, radius=RADIUS, vx=0, vy=0, restitution=0.0, damping=80.0, name="own"):
    """The Scene of balls at x, y: a list of numbers each, or one number for all of them."""
    rows = np.array(np.broadcast_arrays(np.atleast_1d(x), y, vx, vy, mass, radius), float)
    return Scene(name, rows[:2], rows[2:4], rows[4], rows[5], restitution, damping)


def build_scene(name: str, seed=0, bodies=None, restitution=None, damping=None) -> Scene:
    """The scene of that name, its balls at rest; each None stands for the scene's own value."""
    rng = np.random.default_rng(seed)
    draw = rng.uniform(-0.02, 0.02)  # m: the seed moves the start height a little
    lift = abs(draw)  # m: stack and pile never start inside the floor
    if name in ("drop", "bounce"):
        x, y = 0.0, [1.0 + draw]
    elif name == "stack":
        x, y = 0.0, [(2 * i + 1) * RADIUS + lift for i in range(bodies or 3)]
    elif name == "pile":  # a lattice, twice as wide as high, numbered at random and nudged
        count = bodies or 24
        width = math.ceil(math.sqrt(2 * count))
        row, column = np.divmod(rng.permutation(count), width)
        nudge = rng.uniform(-0.1 * RADIUS, 0.1 * RADIUS, (2, count))
        x = 2.5 * RADIUS * (column - 0.5 * (width - 1)) + nudge[0]
        y = 2.5 * RADIUS * (row + 0.5) + lift + nudge[1]
    else:
        raise ValueError(f"scene {name!r}; allowed: {', '.join(SCENES)}")
    e, c = (0.7, 0.0) if name == "bounce" else (0.0, 80.0)
    e = e if restitution is None else restitution
    c = c if damping is None else damping
    return scene_of(x, y, restitution=e, damping=c, name=name)


# --- region: ball ---
class Ball:
    """A ball: position [m], velocity [m/s], mass [kg], radius [m], and the force on it [N]."""

    __slots__ = "x y vx vy fx fy mass inv_mass radius pushed".split()  # no other name can be set

    def __init__(self, x, y, vx, vy, mass, radius):
        self.x, self.y = x, y
        self.vx, self.vy = vx, vy
        self.fx, self.fy = 0.0, 0.0
        self.mass = mass
        self.inv_mass = 1.0 / mass  # 0 for infinite mass: no push changes its velocity
        self.radius = radius
        self.pushed = {}  # {other ball: impulse of the last step}; see warm_start


FLOOR = Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)  # shared by all runs; nothing moves it


def make_balls(scene: Scene) -> list[Ball]:
    """The scene's balls, for the steps to move."""
    columns = np.stack((*scene.q0, *scene.v0, scene.mass, scene.radius), axis=1)
    return [Ball(*values) for values in columns.tolist()]


class Contact:
    """Balls a and b, how deep they overlap [m], and the unit normal (nx, ny) from b to a."""

    __slots__ = (
        "a b nx ny depth inv_mass m_eff target softness lam before start impact after".split()
    )

    def __init__(self, a, b, nx, ny, depth):
        self.a, self.b = a, b
        self.nx, self.ny = nx, ny
        self.depth = depth
        self.inv_mass = a.inv_mass + b.inv_mass
        self.m_eff = 1.0 / self.inv_mass if self.inv_mass > 0.0 else 0.0  # effective mass [kg]
        self.target = 0.0  # m/s
        self.softness = 0.0  # R [1/kg] of soft, which then sets m_eff, too
        self.lam = 0.0  # the impulse [N s] of this step so far

    def v_n(self) -> float:
        """Normal velocity [m/s], positive when the balls separate."""
        a, b = self.a, self.b
        return self.nx * (a.vx - b.vx) + self.ny * (a.vy - b.vy)

    def push(self, impulse: float) -> None:
        """Give ball a this impulse [N s] along the normal, and ball b the opposite one."""
        a, b = self.a, self.b
        a.vx += impulse * (a.inv_mass * self.nx)
        a.vy += impulse * (a.inv_mass * self.ny)
        if b is not FLOOR:  # 0 times NaN is NaN, and even that must not move the floor
            b.vx -= impulse * (b.inv_mass * self.nx)
            b.vy -= impulse * (b.inv_mass * self.ny)


# --- region: contacts ---
def detect_contacts(balls, margin: float = CONTACT_MARGIN) -> list[Contact]:
    """The contacts of balls with the floor and with each other whose gap is below `margin` [m]."""
    contacts = []  # the sweeps take them in this order, so it is part of the result
    for ball in balls:
        depth = ball.radius - ball.y
        if depth > -margin:
            contacts.append(Contact(ball, FLOOR, 0.0, 1.0, depth))
    for a, b in itertools.combinations(balls, 2):  # every pair once, a before b in the list
        dx = a.x - b.x
        dy = a.y - b.y
        distance = math.sqrt(dx * dx + dy * dy)
        depth = a.radius + b.radius - distance
        if depth > -margin:
            # two balls with the same centre have no direction: they get "up"
            nx, ny = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
            contacts.append(Contact(a, b, nx, ny, depth))
    return contacts


# --- region: integrator ---
def accelerate(balls, dt: float) -> None:
    """The first half of semi-implicit Euler: gravity and forces change the velocities."""
    for ball in balls:
        if ball.inv_mass > 0.0:
            ball.vx += dt * (ball.fx / ball.mass)
            ball.vy += dt * (GRAVITY + ball.fy / ball.mass)


def move(balls, dt: float) -> None:
    """The second half: the new velocities, not the old ones, move the balls."""
    for ball in balls:
        ball.x += dt * ball.vx
        ball.y += dt * ball.vy


# --- region: penalty ---
def penalty_normal_force(depth, v_n, stiffness, damping):
    """f_n [N] of a spring and a damper at `depth` > 0 [m]: max(0, ...), since it never pulls."""
    return max(0.0, stiffness * depth - damping * v_n)


def penalty_force(contacts, stiffness, damping):
    """Add the force of a spring and a damper to the two balls of every contact."""
    for c in contacts:
        f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)
        c.a.fx += f_n * c.nx
        c.a.fy += f_n * c.ny
        c.b.fx -= f_n * c.nx  # equal and opposite
        c.b.fy -= f_n * c.ny


def penalty_step(balls, dt: float, stiffness: float, damping: float) -> None:
    """One step [s] in which contact is one more force, and the integrator stays what it was."""
    for ball in balls:
        ball.fx = ball.fy = 0.0  # the floor's may add up: nobody reads it
    penalty_force(detect_contacts(balls, margin=0.0), stiffness, damping)
    accelerate(balls, dt)
    move(balls, dt)


# --- region: lcp-target ---
def contact_target(c, restitution, baumgarte, dt):
    """The least normal velocity [m/s] that contact c may have after the step.

    The step ends with gap + dt v_n, which must not be negative. So v_n has to be at least
    -gap / dt = depth / dt: a gap may close, and an overlap must open. To open it in one step would
    throw the balls apart, so only the share beta of it opens (Baumgarte 1972): that v_n is the
    bias. The same formula lets only that share of a gap close.

    With e > 0 balls that touch or would meet within this step bounce, at -e v_n; an overlap with a
    bias takes the larger of the two. Others may close their gap, but no target is above -e v_n.
    So solved impulses add no energy (Moreau 1988); a bias can, and so can unfinished sweeps.
    """
    closing = c.depth / dt  # this v_n ends the step with a gap of 0
    bias = baumgarte / dt * c.depth  # < 0 across a gap
    if restitution == 0.0:
        return bias
    v_n = c.v_n()
    bounce = -restitution * v_n
    if bias > 0.0:
        return max(bias, bounce)
    meets = -dt * v_n >= -c.depth  # v_n < 0 closes -dt v_n of the gap -depth in this step
    return bounce if meets else min(bounce, closing)


# --- region: sweep ---
def solve_contacts(contacts, iters: int, tolerance: float = 0.0) -> int:
    """Find impulses with lam >= 0, w >= 0 and lam w = 0, where w = v_n + R lam - target.

    Projected Gauss-Seidel: each sweep mends one contact after the other, by the impulse that
    brings it to its target, and disturbs its neighbours; the next sweep mends those. Returns the
    number of the sweep in which no correction changed a velocity by more than `tolerance` [m/s],
    0 if each did. The problem is Moreau's (1988), Stewart and Trinkle's (1996), and Anitescu and
    Potra's (1997).
    """
    for sweep in range(1, iters + 1):
        settled = True
        for c in contacts:
            missing = c.target - c.v_n() - c.softness * c.lam  # -w, the velocity that is missing
            lam = max(0.0, c.lam + missing * c.m_eff)  # the sum is clamped: only a push
            change = lam - c.lam
            c.push(change)
            c.lam = lam
            settled = settled and abs(change) <= tolerance * c.m_eff  # NaN never settles
        if settled:  # with a tolerance of 0 no further sweep would change a bit
            return sweep
    return 0


# --- region: lcp ---
def lcp_step(balls, dt, restitution, baumgarte, iters, warm=0.0) -> None:
    """One step [s]: gravity predicts the velocities, impulses correct them, the balls move."""
    contacts = detect_contacts(balls)
    for c in contacts:  # before gravity: else e would also return the g dt just added
        c.target = contact_target(c, restitution, baumgarte, dt)
    accelerate(balls, dt)
    if warm > 0.0:
        warm_start(contacts, warm)
    solve_contacts(contacts, iters)
    if warm > 0.0:
        remember(balls, contacts)
    move(balls, dt)


def step_reach(balls, dt: float) -> float:
    """How far [m] two balls come towards each other in a step, both as fast as the fastest gets."""
    fastest = max(0.0, *(math.sqrt(ball.vx * ball.vx + ball.vy * ball.vy) for ball in balls))
    return max(CONTACT_MARGIN, 2.0 * dt * (fastest - dt * GRAVITY))


def warm_start(contacts, share=1.0):
    """Begin with a share of the impulses that the same balls gave each other in the last step."""
    for c in contacts:
        c.lam = share * c.a.pushed.get(c.b, 0.0)
        c.push(c.lam)


def remember(balls, contacts):
    """Keep the impulses for the next step."""
    for ball in balls:
        ball.pushed = {}
    for c in contacts:
        c.a.pushed[c.b] = c.lam  # a pair always comes in this order, so a's side is enough


# --- region: momentum ---
def solve_with_momentum(contacts, iters: int, tolerance: float = 0.0) -> int:
    """What solve_contacts finds, in fewer sweeps: each is carried on by a share of its change.

    The share grows from 0 towards 1 (Nesterov 1983) until a sweep turns back; then it begins anew
    (O'Donoghue and Candes 2015). Returns as solve_contacts does.
    """
    t = 1.0
    for c in contacts:
        c.start = c.before = c.lam
    for sweep in range(1, iters + 1):
        if solve_contacts(contacts, 1, tolerance):
            return sweep
        onward = 0.0  # below 0: on the whole, the sweep went back on what had been carried on
        for c in contacts:
            onward += (c.lam - c.start) * (c.lam - c.before)
        if onward < 0.0:
            t = 1.0
        longer = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * t * t))
        share, t = (t - 1.0) / longer, longer
        for c in contacts:
            c.start = max(0.0, c.lam + share * (c.lam - c.before))
            c.before = c.lam
            c.push(c.start - c.lam)
            c.lam = c.start
    return 0


# --- region: leapfrog-ask ---
OPENS = 0.05  # of the two radii, chosen: the most that leapfrog opens an overlap in a step


def ask(c, restitution, dt):
    """What leapfrog asks of contact c: of the way (target), and then of the speed (after) [m/s]."""
    face(c, dt)
    gap, v_n = -c.depth, c.v_n()
    a_n = GRAVITY * c.ny * ((c.a.inv_mass > 0.0) - (c.b.inv_mass > 0.0))  # 0 where both fall
    c.target = min(-gap, OPENS * (c.a.radius + c.b.radius)) / dt
    back = -restitution * (v_n + dt * a_n)  # no speed above it: solved impulses then add no energy
    c.after = min(0.0, back)
    when = time_to_impact(gap, v_n, a_n) if gap > 0.0 else 0.0
    arrives = v_n + when * a_n if when < dt else 0.0
    c.impact = arrives < dt * GRAVITY  # slower is this step's gravity alone: it stays
    left = dt - when
    end = left * (-restitution * arrives + 0.5 * left * a_n)  # the gap to which it has bounced
    if c.impact and end > 0.0:
        c.target = max(c.target, (end - max(gap, 0.0)) / dt)
        c.after = min(-restitution * arrives + left * a_n, back)


def face(c, dt):
    """Take the normal of when the balls of c meet in free flight, or are nearest, within dt [s]."""
    a, b = c.a, c.b
    dx, dy, vx, vy = a.x - b.x, a.y - b.y, a.vx - b.vx, a.vy - b.vy
    reach = a.radius + b.radius
    along = dx * vx + dy * vy  # < 0: they come nearer
    fast = vx * vx + vy * vy
    apart = dx * dx + dy * dy - reach * reach
    t = 0.0
    if apart > 0.0 > along:
        square = max(0.0, along * along - fast * apart)
        t = min(dt, (-along - math.sqrt(square)) / fast)
    x, y = dx + t * vx, dy + t * vy
    distance = math.sqrt(x * x + y * y)
    if b is not FLOOR and distance > 0.0:
        c.nx, c.ny = x / distance, y / distance
        c.depth = reach - (c.nx * dx + c.ny * dy)  # of now, along the normal of then


def time_to_impact(gap, v_n, a_n):
    """When a gap closes [s]: the first root of gap + v_n t + a_n t^2 / 2; inf if it does not."""
    if a_n is None or (v_n >= 0.0 and a_n >= 0.0):
        return math.inf
    square = v_n * v_n - 2.0 * gap * a_n
    if square < 0.0:
        return math.inf
    root = math.sqrt(square)
    # each form is a sum: a difference of near numbers would lose digits
    return 2.0 * gap / (root - v_n) if v_n < 0.0 else -(v_n + root) / a_n


# --- region: leapfrog ---
def leapfrog_step(balls, dt, restitution, iters) -> None:
    """One step [s]: half a kick, ask for the way, move, half a kick, ask for the speed."""
    contacts = detect_contacts(balls, step_reach(balls, dt))
    for c in contacts:
        ask(c, restitution, dt)
    accelerate(balls, 0.5 * dt)
    solve_with_momentum(contacts, iters)  # the way: gap + dt v_n >= 0
    move(balls, dt)
    accelerate(balls, 0.5 * dt)
    closed = [c for c in contacts if c.lam > 0.0]
    for c in closed:
        if not c.impact:
            face(c, 0.0)  # the normal of now; an impact keeps that of its moment
        c.target = c.after
    solve_with_momentum(closed, iters)  # the speed; lam stays, so a push can be taken back


# --- region: exact ---
TOUCH = 1e-13  # m: balls that start no farther apart, or in one another, start in touch
SLOW = 1e-7  # m/s: a slower bounce would be 5e-16 m high, and is left out
TOGETHER = 1.0 + 1e-12  # times the shortest time to an impact: what comes by then comes with it
STILL = 1e-12  # m/s, or m/s^2: less than this is rounding, so the contact rests, or stays closed
ROUNDING = 2.0**-50  # of the speeds: exact sweeps until no correction is above it
MOST_IMPACTS = 20_000  # a run with more is given up


def exact_run(scene: Scene, times, progress=None):
    """q, v (S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, of balls over one another.

    Between two impacts every acceleration stays the same, so a gap is a parabola in time, and the
    next impact is the first root of all: no time step, no error but rounding (1e-10 r over seconds
    and metres). Raises RuntimeError after MOST_IMPACTS; ArithmeticError if sweeps do not settle.
    """
    balls = make_balls(scene)
    pairs = detect_contacts(balls, margin=math.inf)  # all of them: who may ever touch
    touching = [c for c in pairs if -c.depth <= TOUCH]
    start = np.array((scene.q0, scene.v0), float)
    q, v = np.tile(start[:, None], (1, len(times), 1, 1))
    now, done = 0.0, 0
    for _ in range(MOST_IMPACTS):
        strike(touching, scene.restitution)
        a, gap_a = accelerations(balls, touching, pairs)
        span, touching = next_impact(pairs, gap_a)
        last = int(np.searchsorted(times, now + span))
        t = times[done:last] - now
        for k, ball in enumerate(balls):
            q[done:last, 1, k] = place(t, ball.y, ball.vy, a[k])
            v[done:last, 1, k] = speed(t, ball.vy, a[k])
            ball.y, ball.vy = place(span, ball.y, ball.vy, a[k]), speed(span, ball.vy, a[k])
        now, done = now + span, last
        if done == len(times):
            return q, v
        if progress:
            progress(done)
    raise RuntimeError(f"more than {MOST_IMPACTS:,} impacts by {now:.6g} s: the balls rattle")


def place(t, start, v, a):
    """Where something is after t [s] of constant acceleration: a ball [m], or how wide a gap."""
    return start + t * (v + 0.5 * t * a)


def speed(t, v, a):
    """How fast it is then [m/s]."""
    return v + t * a


# --- region: exact-impact ---
def strike(touching, restitution):
    """All impacts of one moment: v_n becomes -e v_n where a contact pushes."""
    for c in touching:
        c.depth = 0.0  # set: rounding never decides who touches
        back = -restitution * c.v_n()  # < 0: they part already, and need no push
        c.target = 0.0 if 0.0 <= back < SLOW else back
    settle(touching)


def accelerations(balls, touching, pairs):
    """The acceleration [m/s^2] of every ball, and of every gap: None of one that stays closed."""
    resting = [c for c in touching if abs(c.v_n()) < STILL]
    before = [ball.vy for ball in balls]
    for ball in balls:  # the same sweep: from here to the end vy holds accelerations, lam forces
        ball.vy = GRAVITY if ball.inv_mass > 0.0 else 0.0
    for c in resting:
        c.target = 0.0  # m/s^2: it may open and may not close
    settle(resting)
    a = [ball.vy for ball in balls]
    gap_a = [None if c in resting and c.v_n() < STILL else c.v_n() for c in pairs]
    for ball, vy in zip(balls, before):
        ball.vy = vy
    return a, gap_a


def settle(contacts):
    """Sweep until only rounding is left. Raises ArithmeticError if the sweeps do not get there."""
    sizes = [size for c in contacts for size in (c.a.vy, c.b.vy, c.target)]
    for c in contacts:
        c.lam = 0.0
    if not solve_with_momentum(contacts, MOST_SWEEPS, ROUNDING * max(map(abs, sizes), default=0.0)):
        raise ArithmeticError("the masses are too unequal: the sweeps do not settle")


# --- region: exact-when ---
def next_impact(pairs, gap_a):
    """How long until the next gap closes [s], and who touches then; moves all depths on to it."""
    roots = [time_to_impact(-c.depth, c.v_n(), a_n) for c, a_n in zip(pairs, gap_a)]
    span = min(roots)
    for c, root, a_n in zip(pairs, roots, gap_a):
        if a_n is None or root <= span * TOGETHER:
            c.depth = 0.0
        else:
            c.depth = -place(span, -c.depth, c.v_n(), a_n)
    return span, [c for c in pairs if c.depth >= 0.0]


# --- region: soft-impedance ---
def impedance(depth: float, solimp: tuple) -> float:
    """How hard the contact is at that depth [m], from 0 to 1: MuJoCo's d (its getimpedance)."""
    d0, d1, width, mid, power = solimp  # d0 at the surface, d1 from a depth of `width` [m] on
    if width <= 1e-15:  # m; MuJoCo takes the mean then
        return 0.5 * (d0 + d1)
    if depth >= width:
        return d1
    share = depth / width  # between: an S of two powers, which meet where share is mid
    if share <= mid:
        rise = raised(share, power) / raised(mid, power - 1.0)
    else:
        rise = 1.0 - raised(1.0 - share, power) / raised(1.0 - mid, power - 1.0)
    return d0 + rise * (d1 - d0)


def raised(x, power):
    """x to that power; a whole power by products: the page's JavaScript gets the same bits."""
    return math.prod([x] * int(power)) if power == int(power) else x**power


# --- region: soft ---
def soften(c, dt, solref, solimp):
    """Give contact c the target and the softness that MuJoCo's contact has.

    A spring K [1/s^2] and a damper B [1/s] ask for the acceleration K d depth - B v_n, whatever
    the mass (MuJoCo's mj_makeImpedance, mj_referenceConstraint). The softness R [1/kg] lets the
    contact miss it: the less, the nearer d is to 1.
    """
    d = impedance(c.depth, solimp)
    d1 = solimp[1]
    if solref[0] > 0.0:  # time constant [s] and damping ratio
        timeconst, dampratio = solref
        K = 1.0 / (d1 * d1 * timeconst * timeconst * dampratio * dampratio)
        B = 2.0 / (d1 * timeconst)
    else:  # direct: minus stiffness, minus damping
        K = -solref[0] / (d1 * d1)
        B = -solref[1] / d1
    v_n = c.v_n()  # before gravity acts
    c.target = v_n + dt * (K * d * c.depth - B * v_n)
    c.softness = max(1e-15, (1.0 - d) / d * c.inv_mass)  # no less: MuJoCo's mjMINVAL
    c.m_eff = 1.0 / (c.inv_mass + c.softness)


def soft_step(balls, dt: float, solref: tuple, solimp: tuple) -> bool:
    """One step [s] like lcp's, but softened. False if the sweeps did not come down to LAST_BITS."""
    contacts = detect_contacts(balls, margin=0.0)
    for c in contacts:
        soften(c, dt, solref, solimp)
    accelerate(balls, dt)
    speeds = [c.target for c in contacts] + [v for ball in balls for v in (ball.vx, ball.vy)]
    warm_start(contacts)  # with R > 0 there is one answer, wherever the sweeps begin
    settled = solve_contacts(contacts, MOST_SWEEPS, LAST_BITS * max(map(abs, speeds)))
    remember(balls, contacts)
    move(balls, dt)
    return settled > 0


# --- region: simulate ---
class Run(NamedTuple):
    """A recording: t (steps + 1,) [s]; q and v (steps + 1, 2, N) [m, m/s]."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    unsettled: int = 0  # steps whose sweeps did not settle


@np.errstate(all="ignore")
def simulate(step, scene: Scene, dt: float, steps: int) -> Run:
    """Take that many steps, `step(balls)` each, and record every state."""
    balls = make_balls(scene)
    rows, settled = np.zeros((steps + 1, len(balls), 4)), np.ones(steps + 1, bool)
    rows[0] = state_of(balls)
    for k in range(steps):
        settled[k + 1] = step(balls) is not False  # False: sweeps of soft that did not settle
        rows[k + 1] = state_of(balls)
    return as_run(rows, settled, dt)


def state_of(balls) -> list[tuple]:
    """A row of simulate."""
    return [(ball.x, ball.y, ball.vx, ball.vy) for ball in balls]


def as_run(rows, settled, dt) -> Run:
    """The Run of rows, x y vx vy by state and ball; settled: whether each step's sweeps did."""
    rows += 0.0  # one zero and one NaN: chance decides their signs
    rows[np.isnan(rows)] = math.nan
    q, v = rows.reshape(len(rows), -1, 2, 2).transpose(2, 0, 3, 1).copy()  # kind, state, axis, ball
    return Run(np.arange(len(rows)) * dt, q, v, int((~settled).sum()))


# --- region: skips ---
@np.errstate(all="ignore")
def simulate_faster(
    step, scene: Scene, dt: float, steps: int, progress=None, kicks: int = 1
) -> Run:
    """What simulate gives, bit for bit, without the steps whose result is known.

    Up to 250 steps of flight are one sum; kicks says in how many parts a step takes gravity's. And
    a step depends on nothing but the state and the impulses of the last step: when both come back
    (rest, or any cycle), the rest is a copy.
    """
    balls = make_balls(scene)
    rows, settled = np.zeros((steps + 1, len(balls), 4)), np.ones(steps + 1, bool)
    rows[0] = state_of(balls)
    k, seen = 0, dict[tuple, int]()  # seen: at which step a state came first
    while k < steps:
        pushed = [(a, b, lam) for a in balls for b, lam in a.pushed.items()]
        first = seen.setdefault((rows[k].tobytes(), *pushed), k)
        if first < k:  # what came then comes again and again
            again = first + 1 + np.arange(steps - k) % (k - first)
            rows[k + 1 :], settled[k + 1 :] = rows[again], settled[again]
            break
        flown = fly(balls, dt, rows[k : k + 251], kicks)
        if flown == 0:
            settled[k + 1] = step(balls) is not False
            rows[k + 1] = state_of(balls)
        k += flown or 1
        if progress:
            progress(k)
    return as_run(rows, settled, dt)


# --- region: flight ---
def fly(balls, dt, rows, kicks):
    """Take steps, up to one that may see a contact; rows[0] is the state now. Returns how many."""
    if detect_contacts(balls, step_reach(balls, dt)):  # no model looks farther
        return 0
    q, v = rows[..., :2], rows[..., 2:]  # views of the rows
    kick = [dt / kicks * GRAVITY if ball.inv_mass > 0.0 else 0.0 for ball in balls]
    fine = np.zeros((kicks * (len(rows) - 1) + 1, len(balls), 2))  # velocities after each kick
    fine[0] = v[0]
    fine[1:, :, 1] = kick
    np.add.accumulate(fine, out=fine)  # v, v + dt g, v + dt g + dt g, ...
    v[:] = fine[::kicks]
    q[1:] = dt * fine[1::kicks]  # the first kick of a step comes before its move
    np.add.accumulate(q, out=q)  # in the order of the steps: the same bits
    gap = smallest_gap(q.transpose(0, 2, 1), np.array([ball.radius for ball in balls]))
    fastest = np.sqrt(v[..., 0] * v[..., 0] + v[..., 1] * v[..., 1]).max(-1)
    reach = np.maximum(CONTACT_MARGIN, 2.0 * dt * (fastest - dt * GRAVITY))  # as step_reach has it
    near = np.flatnonzero(~(gap >= reach))  # and not gap < reach: NaN is not far away
    flown = int(near[0]) if len(near) > 0 else len(rows) - 1
    rows[flown + 1 :] = 0.0
    for ball, values in zip(balls, rows[flown].tolist()):
        ball.x, ball.y, ball.vx, ball.vy = values
        ball.pushed = ball.pushed if flown == 0 else {}
    return flown


# --- region: run ---
MODELS = {  # in the order of the table: the knobs that change its runs
    "penalty": ("stiffness", "damping"),
    "lcp": ("restitution", "baumgarte", "iters", "warm"),
    "leapfrog": ("restitution", "iters"),
    "soft": ("restitution", "solref", "solimp"),
    "exact": ("restitution",),
}
STEPPED = [model for model in MODELS if model != "exact"]
MANY = 5e6  # of about steps times balls squared: from here on, compiled loops pay
MOST_BALLS = 300  # of exact, chosen: curriculum/exact.py needs memory as their cube, 0.1 GB here
SOLREF = (0.02, 1.0)  # MuJoCo's default: time constant [s], damping ratio
SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)  # MuJoCo's default: d0, d1, width [m], mid, power
HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # the hardest contact that MuJoCo allows


class Settings(NamedTuple):
    """The knobs of the models. What belongs to a material, e and damping, is in the scene."""

    stiffness: float = 1e4  # k of penalty [N/m]
    baumgarte: float = 0.2  # beta of lcp: the share of an overlap that one step removes
    iters: int = 20  # of lcp: Gauss-Seidel sweeps a step, at most
    warm: float = 0.0  # of lcp: the share of a step's impulses that the next begins with
    solref: tuple | None = None  # of soft: time constant [s], damping ratio; see soft_defaults
    solimp: tuple | None = None  # of soft: how hard, at which depth; see impedance
    skip: bool = True  # leave out steps whose result is known; no bit changes


def run_model(
    model: str, scene: Scene, dt: float, steps: int, settings: Settings = Settings(), progress=None
) -> Run:
    """The run of a scene by one of MODELS; RuntimeError where exact cannot be exact."""
    check(model, scene, dt, steps)
    if model == "exact":
        return run_exact(scene, dt, steps, progress)
    many = settings.skip and steps * len(scene.mass) ** 2 > MANY
    if many and (fast := beside("fast")) and model in fast.MODELS:  # compiled, the same bits
        return fast.run_model(model, scene, dt, steps, settings, progress)
    step = step_of(model, scene, dt, settings)
    if settings.skip:
        kicks = 2 if model == "leapfrog" else 1
        return simulate_faster(step, scene, dt, steps, progress, kicks)
    return simulate(step, scene, dt, steps)


def check(model, scene, dt, steps):
    """Raise ValueError, with the name of the field, for what no model can run."""
    mass, radius, e = scene.mass, scene.radius, scene.restitution
    for field, given, fine, allowed in (
        ("model", model, model in MODELS, ", ".join(MODELS)),
        ("dt", dt, 0.0 < dt < math.inf, "above 0 and finite"),
        ("steps", steps, steps >= 0, "0 or more"),
        ("q0", scene.q0, np.isfinite(scene.q0), "finite"),
        ("v0", scene.v0, np.isfinite(scene.v0), "finite"),
        ("mass", mass, mass > 0.0, "above 0; infinite for a ball that no push moves"),
        ("radius", radius, (radius > 0.0) & (radius < math.inf), "above 0 and finite"),
        ("restitution", e, 0.0 <= e <= 1.0, "from 0 to 1"),
        ("damping", scene.damping, math.isfinite(scene.damping), "finite"),
    ):
        if not np.all(fine):
            wrong = np.asarray(given)[~np.asarray(fine)].tolist()[0]
            raise ValueError(f"{field}: given {wrong!r}; allowed: {allowed}")


def step_of(model: str, scene: Scene, dt: float, settings: Settings):
    """step(balls) of penalty, lcp or soft."""
    s, e = settings, scene.restitution
    soft = soft_defaults(e, dt, s.solref, s.solimp)
    return {
        "penalty": lambda balls: penalty_step(balls, dt, s.stiffness, scene.damping),
        "lcp": lambda balls: lcp_step(balls, dt, e, s.baumgarte, s.iters, s.warm),
        "leapfrog": lambda balls: leapfrog_step(balls, dt, e, s.iters),
        "soft": lambda balls: soft_step(balls, dt, *soft),
    }[model]


def soft_defaults(restitution, dt, solref=None, solimp=None) -> tuple[tuple, tuple]:
    """The solref and solimp a run uses, within MuJoCo's bounds. None stands for the default."""
    if solref is None and restitution > 0.0:
        # minus stiffness and minus damping: this damping, in a hard contact, turns v_n into -e v_n
        # within one step; there is no spring then, so a ball at rest sinks on, slowly
        solref, solimp = (0.0, -(1.0 + restitution) / dt), solimp or HARD
    elif solref is None or solref[0] > 0.0:
        timeconst, dampratio = solref or SOLREF
        solref = max(timeconst, 2.0 * dt), dampratio  # MuJoCo's refsafe: no faster than two steps
    d0, d1, width, mid, power = solimp or SOLIMP
    d0, d1, mid = (min(max(share, 0.0001), 0.9999) for share in (d0, d1, mid))
    return solref, (d0, d1, width, mid, max(power, 1.0))


@np.errstate(over="ignore")
def run_exact(scene, dt, steps, progress=None):
    """The Run of balls over one another by exact_run, of others by curriculum/exact.py."""
    if len(scene.mass) > MOST_BALLS:
        raise RuntimeError(f"given {len(scene.mass):,} balls; allowed: {MOST_BALLS} at most")
    times = np.arange(steps + 1) * dt
    reason = "balls that lie beside one another need curriculum/exact.py"
    apart = smallest_gap(scene.q0[None], scene.radius)[0] >= -TOUCH
    if apart and (scene.q0[0] == scene.q0[0, 0]).all() and not scene.v0[0].any():
        try:
            return Run(times, *exact_run(scene, times, progress))
        except ArithmeticError as error:
            reason = str(error)
    if not (exact := beside("exact")):
        raise RuntimeError(reason)
    return Run(times, *exact.simulate_exact(scene, times, GRAVITY, progress or (lambda k: None)))


def beside(name: str):
    """A module of curriculum/ beside this file; None if it, or what it needs, is not there."""
    if (home := str(Path(__file__).resolve().parent)) not in sys.path:
        sys.path.append(home)
    try:
        return importlib.import_module(f"curriculum.{name}")
    except ImportError as error:
        absent = f"curriculum.{name}.".startswith(f"{error.name}.")  # this module or its folder
        if error.name is None or (isinstance(error, ModuleNotFoundError) and absent):
            return None  # no name: the module says so itself
        raise  # a fault in the module


# --- region: measure ---
EXPLODED = 10.0  # a run that gains this many times its start energy, or more, has exploded
RESTLESS = 1e-6  # r, chosen: an overlap that varies by less than this is at rest


@np.errstate(all="ignore")
def energy(q, v, mass):
    """Kinetic plus potential energy [J] of states (..., 2, N), zero at the floor."""
    mass = np.where(np.isfinite(mass), mass, 0.0)  # infinite: left out, since no push changes it
    return (0.5 * mass * (v * v).sum(-2) - mass * GRAVITY * q[..., 1, :]).sum(-1)


@np.errstate(all="ignore")
def smallest_gap(q, radius):
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N)."""
    if q.size * len(radius) > MANY and (fast := beside("fast")):
        return fast.smallest_gap(q, radius)
    gap = (q[:, 1] - radius).min(-1)
    for lag in range(1, len(radius)):  # ball i and ball i + lag, for all i, all states at once
        dx, dy = (q[:, :, lag:] - q[:, :, :-lag]).swapaxes(0, 1)
        reach = radius[lag:] + radius[:-lag]
        gap = np.minimum(gap, (np.sqrt(dx * dx + dy * dy) - reach).min(-1))
    return gap


def blow_up_step(total):
    """The first step at which the energy [J] has gained EXPLODED times its start, or None."""
    bad = ~(total - total[0] < EXPLODED * (abs(total[0]) or 1.0))  # NaN counts as exploded
    return int(bad.argmax()) if bad.any() else None


def first_contact(run: Run, scene: Scene, dt: float) -> int:
    """Which state is the first to touch, or to have a velocity that not only gravity changed."""
    gained = np.outer((0.0, dt * GRAVITY), np.isfinite(scene.mass))  # from gravity, in one step
    rounding = 1e-9 * (np.abs(run.v[:-1]) + np.abs(gained))
    touched = smallest_gap(run.q, scene.radius) <= 0.0
    touched[1:] |= (np.abs(np.diff(run.v, axis=0) - gained) > rounding).any((1, 2))
    return int(touched.argmax()) if touched.any() else len(touched)  # none


def trembles(depth) -> bool:
    """Whether the overlap [r] goes up and down every few steps to the end, and does not die out."""
    # that is penalty past its critical step: the clamp cuts a swing that would grow
    early, late = np.array_split(depth[3 * len(depth) // 4 :], 2)
    if len(early) < 50 or not early.std() > RESTLESS:  # 50: chosen, a shorter run is no evidence
        return False
    turns = np.count_nonzero(np.diff(np.sign(np.diff(late))))
    return bool(late.std() > 0.9 * early.std() and turns > len(late) / 8)


# --- region: quality ---
@np.errstate(all="ignore")
def contact_quality(run: Run, scene: Scene, dt: float, reference: Run | None = None) -> dict:
    """The measures of a run, in radii of the first ball and in start energies; see COLUMNS."""
    total = energy(run.q, run.v, scene.mass)
    scale = abs(float(total[0])) or 1.0  # J; 1 J for a run that starts with none
    radius = float(scene.radius[0])  # m
    gap = smallest_gap(run.q, scene.radius) / radius
    depth = np.maximum(-gap, 0.0)
    below = (run.q[:, 1, np.isfinite(scene.mass)] < 0.0).any()  # a centre, below the floor
    inside = depth.max() * radius > scene.radius.max()  # an overlap by a radius
    landing = first_contact(run, scene, dt)
    step = blow_up_step(total)
    return {
        **height_errors(run, scene, dt, reference),
        "max_penetration_frac": float(depth.max()),
        "rest_penetration_frac": float(depth[-1]),  # the overlap at the end
        "rest_gap_frac": float(gap[-1]),
        "rebound_frac": float(gap[landing:].max(initial=0.0)),
        "rest_jitter": float(np.std(depth[3 * len(depth) // 4 :])),
        "energy_excess": float((total - total[0]).max()) / scale,
        "contact_energy": float(np.maximum(np.diff(total), 0.0).sum()) / scale,
        "blew_up": step is not None,
        "blew_up_step": step,
        "trembles": trembles(depth),
        "rests": at_rest(run, scene),
        "through": "the floor" if below else "a ball" if inside else None,
        "unsettled_steps": run.unsettled,  # whose sweeps, of soft, did not settle
    }


def height_errors(run, scene, dt, reference):
    """The worst errors of height [r]: in all, before contact, and what contact adds."""
    keys = "height_error_frac", "flight_error_frac", "contact_error_frac"
    if reference is None:
        return dict.fromkeys(keys)
    error = np.abs(run.q[:, 1] - reference.q[:, 1]).max(-1) / float(scene.radius[0])
    both_fly = min(first_contact(each, scene, dt) for each in (run, reference))
    worst, flight = float(error.max()), float(error[:both_fly].max(initial=0.0))
    return dict(zip(keys, (worst, flight, worst - flight)))


def at_rest(run: Run, scene: Scene) -> bool:
    """Whether at the end all balls that can move are slower than 1 mm/s, and none is falling."""
    moving = np.isfinite(scene.mass)
    still = np.abs(run.v[-1][:, moving]).max(initial=0.0) < 1e-3
    falling = np.abs(np.diff(run.v[-2:, 1][:, moving], axis=0)).max(initial=0.0)
    return bool(still and (len(run.t) > 1) and falling < 0.5 * abs(GRAVITY) * run.t[1])


# --- region: critical-dt ---
def critical_dt(mass: float, stiffness: float, damping: float, count: int = 1) -> float:
    """The largest stable step [s] of penalty for a ball kept in contact, or a stack of them.

    In contact a step is a 2 x 2 matrix. Its eigenvalues stay within 1 (Jury's test) while c >= 0
    and k dt^2 + 2 c dt < 4 m; solved for dt. Without a damper that is 2 sqrt(m / k).
    """
    if damping < 0.0:
        return 0.0  # such a damper feeds every swing
    if count > 1:  # the stiffest swing of a stack sees so many times the spring and the damper
        more = 4.0 * math.cos(math.pi / (2 * count + 1)) ** 2
        stiffness, damping = more * stiffness, more * damping
    root = math.sqrt(damping * damping + 4.0 * mass * stiffness)
    return 4.0 * mass / (root + damping) if root + damping > 0.0 else math.inf


# --- region: stability ---
DT_GRID = (1, 2, 4, 8, 16, 32)  # multiples of --dt that the stability lines try


def measure_stability(run, scene: Scene, dt: float, stiffness: float) -> dict:
    """By model, the largest step of DT_GRID at which run(model, step) does not explode, and how."""
    mass, damping, count = float(scene.mass[0]), scene.damping, len(scene.mass)
    grid: dict = {
        "dt_crit_penalty": critical_dt(mass, stiffness, 0.0),
        "dt_crit_damped": critical_dt(mass, stiffness, damping),
        "dt_crit_stack": critical_dt(mass, stiffness, damping, count),
    }
    for model in ("penalty", "lcp"):  # soft's time constant grows with the step: it stays bounded
        largest, there = None, {}  # what stays if no run comes to a contact
        for step in (dt * factor for factor in reversed(DT_GRID)):  # the answer comes first
            found = run(model, step)
            quality = contact_quality(found, scene, step)
            if quality["blew_up"]:
                largest = 0.0  # what stays if all others explode
            elif first_contact(found, scene, step) < len(found.t):
                largest, there = step, quality
                break
        grid |= {model: largest, f"{model}_penetration_frac": there.get("max_penetration_frac")}
        grid |= {f"{model}_{key}": there.get(key) for key in ("through", "trembles")}
    return grid


# --- region: flags ---
USUAL = Settings()
NUMBERS = {  # flag: kind, lowest, highest, what it is when it is not given, meaning
    "--seed": (int, 0, 10**18, 0, "draws the start height"),
    "--dt": (float, 1e-6, 1e3, 0.002, "time step [s]"),
    "--steps": (int, 0, 10**6, None, "how many (2000)"),
    "--bodies": (int, 1, 10**4, None, "balls of stack (3) and pile (24)"),
    "--mass": (float, 1e-9, 1e9, 1.0, "of every ball [kg]"),
    "--stiffness": (float, 0, 1e15, USUAL.stiffness, "k of penalty [N/m]"),
    "--damping": (float, -1e9, 1e9, -1.0, "c of penalty [N s/m]; below 0: the scene's, 80 or 0"),
    "--restitution": (float, -1, 1, -1.0, "e of the others; below 0: the scene's, 0 or 0.7"),
    "--baumgarte": (float, 0, 1, USUAL.baumgarte, "beta of lcp: share of an overlap to remove"),
    "--warm": (float, 0, 1, USUAL.warm, "of lcp: share of the last impulses to begin with"),
    "--iters": (int, 1, MOST_SWEEPS, USUAL.iters, "of lcp and leapfrog: sweeps, at most"),
}


def number(kind, low, high, text):
    """The number of that kind, from low to high, that `text` is; a whole one may be 1e3."""
    try:
        value = int(text) if text.isdecimal() else float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high or (kind is int and value % 1 > 0):
        allowed = f"{'a whole number' if kind is int else 'a number'} from {low:g} to {high:g}"
        raise argparse.ArgumentTypeError(f"given {text[:40]!r}; allowed: {allowed}")
    return kind(value) + 0  # -0.0 becomes 0.0


def add_flags(flag):
    """All flags, by argparse's add_argument."""
    flag("--scene", choices=SCENES, default="drop", help="one ball, drop or bounce; or many (drop)")
    flag("--contact", choices=("all", *MODELS), default="all", help="the model (all)")
    for name, (kind, low, high, usual, text) in NUMBERS.items():
        text += "" if usual is None else f" ({usual:g})"
        flag(name, type=partial(number, kind, low, high), default=usual, metavar="N", help=text)
    switch = argparse.BooleanOptionalAction
    spring = "of soft: time constant [s], damping ratio (0.02 1); or minus a stiffness, a damping"
    flag("--solref", type=partial(number, float, -1e12, 1e6), nargs=2, metavar="N", help=spring)
    curve = "of soft: d0 d1 width mid power (0.9 0.95 0.001 0.5 2)"
    flag("--solimp", type=partial(number, float, 0, 100), nargs=5, metavar="N", help=curve)
    flag("--smoke", action="store_true", help="a fixed 800 steps, for CI")
    flag("--device", choices=("cpu",), default="cpu", help="where it runs (cpu)")
    flag("--skip", action=switch, default=True, help="leave out work that changes no bit (yes)")
    flag("--rerun", action=switch, default=True, help="write the recording contact.rrd (yes)")
    flag("--plot", action="store_true", help="draw contact.svg, by matplotlib")
    flag("--out", default="outputs/ch3.5-contact", help="folder of the files (%(default)s)")


def parse_flags(argv=None):
    """The checked command line. Bad input ends with one line on stderr and exit status 2."""
    parser = argparse.ArgumentParser("contact.py", argparse.SUPPRESS, __doc__, allow_abbrev=False)
    parser.formatter_class = partial(argparse.RawDescriptionHelpFormatter, width=78)
    parser._negative_number_matcher = re.compile(r"(?i)-\.?(\d|inf|nan)")  # -1e4 is a value
    add_flags(parser.add_argument)
    args = parser.parse_args(argv)
    memory, solref = beside("run.remarks"), args.solref or (0.0, 0.0)
    if args.smoke and args.steps is not None:
        parser.error("--smoke has 800 steps: leave out --steps")
    args.steps = 800 if args.smoke else 2000 if args.steps is None else args.steps
    if args.bodies and args.scene in SCENES[:2]:
        parser.error("--bodies is for stack and pile")
    if max(solref) > 0.0 and min(solref) < 1e-6:
        allowed = "two numbers from 1e-06 up, or two that are 0 or less"
        parser.error(f"argument --solref: allowed: {allowed}")
    if not args.out.strip():
        parser.error("argument --out: given ''; allowed: the name of a folder")
    if memory and (wrong := memory.too_much(args.steps, len(chosen_scene(args, 0).mass))):
        parser.error(wrong)
    return args


# --- region: main ---
def fail(message):
    """One line on stderr. Returns the exit status."""
    print(f"contact.py: error: {message}", file=sys.stderr)
    return 2


def main(argv=None):
    """The command line. Returns the exit status: 2 where nothing could be run, 130 after Ctrl-C."""
    argv = sys.argv[1:] if argv is None else argv
    try:
        status = report(parse_flags(argv), argv)
        print(end="", flush=True)  # an error at Python's end has no handler
        return status
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130
    except MemoryError:
        return fail("not enough memory; allowed: fewer --steps or --bodies")
    except OSError as error:  # nobody reads on, or the disk is full: Python's own flush would fail
        unread = isinstance(error, BrokenPipeError)
        os._exit(141 if unread else fail(f"cannot print the rest: {error.strerror}"))


# --- region: files ---
def chosen_scene(args, seed):
    """The scene that the flags ask for; a restitution or damping below 0 is the scene's own."""
    e, c = (None if value < 0.0 else value for value in (args.restitution, args.damping))
    scene = build_scene(args.scene, seed, args.bodies, e, c)
    return scene._replace(mass=args.mass * scene.mass)


def run_flags(args, scene, model, dt):
    """The run that the flags ask for, at that dt; a terminal shows how far it is."""
    settings = Settings(*(getattr(args, knob) for knob in Settings._fields))
    pool = beside("parallel") if sys.stderr and sys.stderr.isatty() else None
    bar = pool.bar(args.steps, f"{model}, dt = {dt:g} s") if pool else None
    return run_model(model, scene, dt, args.steps, settings, bar)


def run_all(args, scene):
    """The runs {model: Run} that the flags ask for, and {model: why it has none}."""
    runs, without = {}, {}
    for model in MODELS if args.contact == "all" else [args.contact]:
        try:
            if model == "exact" and args.contact == "all" and len(scene.mass) > 24:
                raise RuntimeError("more than 24 balls; ask for it by --contact exact")
            runs[model] = run_flags(args, scene, model, args.dt)
        except RuntimeError as error:
            without[model] = str(error)
    return runs, without


def collect(args, scene):
    """The runs {model: Run}, and what metrics.json holds: knobs, measures, the stability grid."""
    runs, without = run_all(args, scene)
    keys = "scene", "contact", "dt", "steps", "seed", "stiffness"
    metrics = {key: getattr(args, key) for key in keys} | {"restitution": scene.restitution}
    metrics |= {"quality": {}, "stability": {}, "without": without}
    for model, run in runs.items():
        metrics["quality"][model] = contact_quality(run, scene, args.dt, runs.get("exact"))
    if args.contact == "all" and args.scene != "pile":
        again = partial(run_flags, args, scene)  # at another step
        metrics["stability"] = measure_stability(again, scene, args.dt, args.stiffness)
    return runs, rounded(metrics)


def rounded(value):
    """`value` as JSON holds it, its floats rounded to 12 decimals; None where one is not finite."""
    return json.loads(
        json.dumps(value),
        parse_float=lambda text: round(float(text), 12) + 0.0,
        parse_constant=lambda name: None,
    )


def write_files(args, metrics, runs, scene):
    """Write metrics.json, and recording and picture if asked; a line on each. Raises OSError."""
    out, title = Path(args.out), f"{args.scene}, seed {args.seed}, dt = {args.dt:g} s"
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(metrics, indent=2, sort_keys=True, allow_nan=False)
    (out / "metrics.json").write_bytes(f"{text}\n".encode())
    yield f"metrics: {out / 'metrics.json'}"
    recording = args.rerun, "recording", "contact.rrd"
    for asked, name, file, *more in (recording, (args.plot, "picture", "contact.svg", title)):
        if asked and runs:
            try:
                maker = importlib.import_module(
                    f"curriculum.run.{name.replace('picture', 'plotting')}"
                )
                maker.write(str(out / file), runs, scene, *more)
                yield f"{name}: {out / file}"
            except ImportError as error:
                if error.name not in (None, "curriculum"):
                    raise
                absent = "it needs the folder curriculum beside contact.py"
                yield f"no {name}: {absent if error.name else error}"


# --- region: report ---
COLUMNS = {  # title: key of contact_quality, meaning
    "max pen/r": ("max_penetration_frac", "the deepest overlap; r is the radius of a ball"),
    "rest gap/r": ("rest_gap_frac", "the smallest gap at the end: below 0 it is an overlap"),
    "rebound/r": ("rebound_frac", "the most that all surfaces are apart after the first contact"),
    "energy+": ("energy_excess", "the most energy above the start, as a share of the start's"),
    "energy in": ("contact_energy", "all rises of it, added up; what a spring gives back counts"),
    "flight err/r": ("flight_error_frac", "the worst height error before the first contact"),
    "contact err/r": ("contact_error_frac", "what contact adds to it; both against exact"),
    "jitter/r": ("rest_jitter", "standard deviation of the overlap in the last quarter"),
}


def shown(value, digits=3) -> str:
    """A number as a person reads it, "-" for None: an exponent only where zeros would hide it."""
    if value is None:
        return "-"
    if value == 0.0 or 1e-4 <= abs(value) < 999.5:
        return f"{value:.{digits}g}"
    return f"{value:,.0f}" if 999.5 <= abs(value) < 1e6 else f"{value:.1e}"


def ending(row) -> str:
    """How a run ended, in words."""
    if row["blew_up"]:
        return f"EXPLODED at step {row['blew_up_step']}"
    calm = "trembles" if row["trembles"] else "ok"
    text = f"through {row['through']}" if row["through"] else calm
    steps = row["unsettled_steps"]
    return f"{text}, sweeps unsettled in {steps} steps" if steps else text


def print_table(rows, state):
    """A line per row {name: {key: value}} with state(row) behind it, then the columns' meaning."""
    wide = max(map(len, ["contact", *rows]))
    titles = [title.rpartition(" ") for title in COLUMNS]  # in two lines: "max" over "pen/r"
    print(" " * wide + "".join(f"{above:>10}" for above, _, _ in titles))
    print(f"{'contact':<{wide}}" + "".join(f"{below:>10}" for _, _, below in titles) + "  state")
    for name, row in rows.items():
        cells = "".join(f"{shown(row[key]):>10}" for key, _ in COLUMNS.values())
        print(f"{name:<{wide}}{cells}  {state(row)}")
    for title, (_, meaning) in COLUMNS.items():
        print(f"  {title:<15}{meaning}")


def print_verdict(quality):
    """Which model overlaps most and which least: at worst, and of those at rest at the end."""
    whole = [name for name, row in quality.items() if not row["blew_up"]]
    resting = [name for name in whole if quality[name]["rests"]]
    for when, key, names in (("worst", "max", whole), ("rest", "rest", resting)):
        depth = {name: quality[name][f"{key}_penetration_frac"] for name in names}
        groups = itertools.groupby(sorted(depth, key=depth.get, reverse=True), key=depth.get)
        text = " > ".join(" = ".join(group) for _, group in groups)
        print(f"verdict: depth at {when}:", text or "none is")
    if moving := [name for name in whole if name not in resting]:
        print("verdict: not at rest at the end:", ", ".join(moving))


def print_stability(grid, count):
    """The largest step that each model stood, and the critical steps of penalty."""
    print("stability: tried at", ", ".join(map(str, DT_GRID)), "times --dt")
    instead = {None: "comes to no contact within these steps"}
    instead[0.0] = "explodes at every dt tried that comes to a contact"
    for model in ("penalty", "lcp"):
        depth, through = grid[f"{model}_penetration_frac"], grid[f"{model}_through"]
        there = f"it goes {shown(depth)} r deep" + (f", through {through}" if through else "")
        there += ", and trembles" if grid[f"{model}_trembles"] else ""
        text = f"does not explode up to dt = {grid[model] or 0:g} s, where {there}"
        print(f"stability: {model} {instead.get(grid[model], text)}")
    stack = f"a stack of {count}: {shown(grid['dt_crit_stack'], 4)} s; " if count > 1 else ""
    print(
        f"critical dt of penalty, one ball: {shown(grid['dt_crit_damped'], 4)} s; {stack}"
        f"without the damper, 2 sqrt(m/k): {shown(grid['dt_crit_penalty'], 4)} s"
    )


def report(args, argv):
    """Run the models, print what was found, write the files. Returns the exit status."""
    scene = chosen_scene(args, args.seed)
    runs, metrics = collect(args, scene)
    print(f"scene {args.scene}, seed {args.seed}: {args.steps} steps of {args.dt:g} s")
    if remarks := beside("run.remarks"):
        remarks.print_remarks(args, runs, scene)
    print_table(metrics["quality"], ending)
    for model, reason in metrics["without"].items():
        print(f"no {model}: {reason}")
    if len(runs) > 1:
        print_verdict(metrics["quality"])
    if metrics["stability"]:
        print_stability(metrics["stability"], len(scene.mass))
    try:
        lines = list(write_files(args, metrics, runs, scene))
    except OSError as error:
        lost = f"cannot write to {args.out}: {error.strerror}"
        return fail(f"{lost}; the report is whole, give another --out to keep its files")
    print(*lines, sep="\n")
    if hints := beside("run.remarks"):
        hints.print_next(args, argv)
    return 0 if runs else 2


if __name__ == "__main__":
    sys.modules["contact"] = sys.modules[__name__]  # what the folder's "import contact" gets
    sys.exit(main())
