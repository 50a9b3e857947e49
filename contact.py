# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0"]
# ///
"""Contact between bodies, built five times and measured honestly (robotics course, chapter 3.5).

A table keeps a ball from falling through it: it pushes up, and it never pulls down. Five models:
    penalty   a stiff spring and a damper: one more force, and no other change
    lcp       impulses, found by sweeps: each contact pushes, or its bodies part (a linear
              complementarity problem, solved by projected Gauss-Seidel)
    soft      the contact of MuJoCo, a robot simulator: lcp's sweeps, but each contact gives way
    leapfrog  impacts at their own moments; a contact that lasts is asked twice: where, and how fast
    exact     goes from one impact to the next: no time step
Left out: friction, rotation, and all shapes but balls over the line y = 0.

    symbol    meaning                              unit    sign
    x, y      centre of a ball; q is both          m       y is up
    vx, vy    its velocity; v is both              m/s
    gap       distance of two surfaces             m       > 0 apart
    depth     -gap                                 m       > 0 overlapping
    n         normal of a contact, a unit vector   -       from body b to body a; from the floor up
    v_n       n . (v_a - v_b)                      m/s     > 0 separating
    f_n       contact force of penalty             N       >= 0: a contact only pushes
    lam       contact impulse over one step        N s     >= 0: a contact only pushes
    target    the least v_n after the solve        m/s     > 0 separating
    softness  R: v_n stays R lam below its target  1/kg    0 is hard
    m_eff     effective mass, what a push moves    kg      1 / (1 / m_a + 1 / m_b + R)
    e         restitution: share of the speed that a bounce gives back, 0 to 1

Run it:
    python contact.py --contact exact               # what should happen; what will the others do?
    python contact.py --scene drop                  # all models; then: bounce, stack, pile
    python contact.py --contact penalty --dt 0.03   # one model, a longer step
    python contact.py --smoke --no-rerun            # fixed length, the same bytes every time
It needs numpy and nothing else. The course's folder beside it adds the recording, pictures, many
seeds at once, compiled loops for many balls, and exact for more than one column of balls.
"""

# --- region: setup ---
import os
import signal
import sys

if __name__ == "__main__":  # a stop is heard at any time, also while modules load
    for sign in (signal.SIGINT, signal.SIGTERM):
        signal.signal(sign, lambda sign, _: (os.write(2, b"stopped\n"), os._exit(128 + sign)))

import argparse
import importlib
import itertools
import json
import math
import re
from collections.abc import Callable
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


# --- region: ball ---
class Ball:
    """A ball: position [m], velocity [m/s], mass [kg], radius [m], and the force on it [N]."""

    __slots__ = "x y vx vy fx fy mass inv_mass radius pushed".split()  # no other name can be set
    __slots__ += "ax ay since held vx_before vy_before".split()  # used by leapfrog

    def __init__(self, x, y, vx, vy, mass, radius):
        self.x, self.y, self.vx, self.vy = x, y, vx, vy
        self.fx = self.fy = 0.0
        self.mass, self.radius = mass, radius
        self.inv_mass = 1.0 / mass  # 0 for infinite mass: no push changes its velocity
        self.pushed = {}  # {other ball: impulse of the last step}; see warm_start
        self.ax = self.ay = self.since = self.held = 0.0  # see hold and find_held


FLOOR = Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)  # shared by all runs; nothing moves it


class Contact:
    """Balls a and b, how deep they overlap [m], and the unit normal (nx, ny) from b to a."""

    __slots__ = "a b nx ny depth m_eff target softness lam".split()
    __slots__ += "start before".split()  # used by solve_with_momentum
    __slots__ += "reach gap speed when struck least".split()  # used by leapfrog

    def __init__(self, a, b, nx, ny, depth):
        self.a, self.b = a, b
        self.nx, self.ny, self.depth = nx, ny, depth
        inv_m_eff = a.inv_mass + b.inv_mass
        self.m_eff = 1.0 / inv_m_eff if inv_m_eff > 0.0 else 0.0
        self.target = self.softness = 0.0  # soft sets the softness, and m_eff with it
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
CONTACT_MARGIN = 1e-3  # m: lcp lists smaller gaps, too, so that a ball at rest stays on the list


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
    """The force f_n [N] of spring and damper at `depth` > 0 [m]; not below 0: it never pulls."""
    return max(0.0, stiffness * depth - damping * v_n)


def penalty_force(contacts, dt, stiffness, damping):
    """Add the force of a spring and a damper to the two balls of every contact."""
    for c in contacts:
        f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)
        c.a.fx += f_n * c.nx
        c.a.fy += f_n * c.ny
        c.b.fx -= f_n * c.nx  # equal and opposite
        c.b.fy -= f_n * c.ny
        c.lam = dt * f_n


def penalty_step(balls, dt: float, stiffness: float, damping: float) -> list[Contact]:
    """One step [s] in which contact is one more force, and the integrator stays what it was."""
    contacts = detect_contacts(balls, margin=0.0)
    penalty_force(contacts, dt, stiffness, damping)
    accelerate(balls, dt)
    move(balls, dt)
    for ball in balls:
        ball.fx = ball.fy = 0.0  # for the next step; FLOOR's sum stays: nobody reads it
    return contacts


# --- region: critical-dt ---
def critical_dt(mass: float, stiffness: float, damping: float, count: int = 1) -> float:
    """The largest stable step [s] of penalty for a ball kept in contact, or a stack of them.

    In contact a step is a 2 x 2 matrix of m, k, c. Its eigenvalues stay within 1 (Jury's test)
    while c >= 0 and k dt^2 + 2 c dt < 4 m. Solve that for dt; c = 0 gives 2 sqrt(m / k).
    """
    if damping < 0.0:
        return 0.0  # a negative damper adds energy to every swing
    if mass == math.inf:
        return math.inf
    if count > 1:  # in its stiffest swing, a stack feels `more` times the spring and the damper
        more = 4.0 * math.cos(math.pi / (2 * count + 1)) ** 2
        stiffness, damping = more * stiffness, more * damping
    root = math.sqrt(damping * damping + 4.0 * mass * stiffness)
    return 4.0 * mass / (root + damping) if root + damping > 0.0 else math.inf


# --- region: scenes ---
RADIUS = 0.1  # m, of every ball in the scenes
SCENES = {"drop": 1, "bounce": 1, "stack": 3, "pile": 24}  # scene: how many balls it usually has


class Scene(NamedTuple):
    """Balls over the floor: q0, v0 (2, N) [m, m/s]; mass [kg] and radius [m], both (N,)."""

    name: str
    q0: np.ndarray
    v0: np.ndarray
    mass: np.ndarray  # nothing changes the velocity of a ball of infinite mass
    radius: np.ndarray
    restitution: float  # e; penalty has no such knob
    damping: float  # c of penalty [N s/m]


def scene_of(x, y, mass=1, radius=RADIUS, vx=0, vy=0, restitution=0.0, damping=80.0, name="own"):
    """The Scene of balls at x, y: a list of numbers each, or one number for all of them."""
    rows = np.array(np.broadcast_arrays(np.atleast_1d(x), y, vx, vy, mass, radius), float)
    return Scene(name, rows[:2], rows[2:4], rows[4], rows[5], restitution, damping)


def build_scene(name, seed=0, bodies=None, restitution=None, damping=None, mass=1) -> Scene:
    """The scene of that name, its balls at rest; each None stands for the scene's own value."""
    if name not in SCENES:
        raise ValueError(f"scene {name!r}; allowed: {', '.join(SCENES)}")
    rng = np.random.default_rng(seed)
    draw = rng.uniform(-0.02, 0.02)  # m: the seed moves the start height a little
    lift = abs(draw)  # m: stack and pile never start inside the floor
    count = bodies or SCENES[name]
    x, y = 0.0, [1.0 + draw]  # drop, bounce
    if name == "stack":
        y = [(2 * i + 1) * RADIUS + lift for i in range(count)]
    if name == "pile":  # a lattice, about twice as wide as high, numbered at random and nudged
        width = math.ceil(math.sqrt(2 * count))
        row, column = np.divmod(rng.permutation(count), width)
        nudge = rng.uniform(-0.1 * RADIUS, 0.1 * RADIUS, (2, count))
        x = 2.5 * RADIUS * (column - 0.5 * (width - 1)) + nudge[0]
        y = 2.5 * RADIUS * (row + 0.5) + lift + nudge[1]
    e, c = (0.7, 0.0) if name == "bounce" else (0.0, 80.0)
    e = e if restitution is None else restitution
    c = c if damping is None else damping
    return scene_of(x, y, mass, restitution=e, damping=c, name=name)


def make_balls(scene: Scene) -> list[Ball]:
    """The scene's balls, for the steps to move."""
    columns = np.stack((*scene.q0, *scene.v0, scene.mass, scene.radius), axis=1)
    return [Ball(*values) for values in columns.tolist()]


# --- region: simulate ---
class Run(NamedTuple):
    """A recording: t (steps + 1,) [s]; q and v (steps + 1, 2, N) [m, m/s]."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray


@np.errstate(all="ignore")
def simulate(step, scene, dt, steps, skip=False, progress=None, kicks=0, see=None) -> Run:
    """Take that many steps, `step(balls)` each, and record every state.

    see(k, contacts) gets the contacts that step k returns; progress(k), how many steps are done.
    With `skip`, and without `see`, steps whose result is known are left out, and no bit changes. Up
    to 250 steps of flight are one sum, with gravity added `kicks` times a step (0: nobody flies).
    And a step depends only on the state and the impulses of the last step: when both come back (at
    rest, or in a cycle), what follows is a copy.
    """
    balls = make_balls(scene)
    rows = np.zeros((steps + 1, len(balls), 4))
    skip = skip and see is None
    k, seen = 0, dict[tuple, int]()  # seen: at which step a state came first
    while True:
        rows[k] = [(ball.x, ball.y, ball.vx, ball.vy) for ball in balls]
        if k == steps:
            break
        pushed = [(a, b, lam) for a in balls for b, lam in a.pushed.items()]
        first = seen.setdefault((rows[k].tobytes(), *pushed), k) if skip else k
        if first < k:  # what came then comes again and again
            rows[k + 1 :] = rows[first + 1 + np.arange(steps - k) % (k - first)]
            break
        flown = fly(balls, dt, rows[k : k + 251], kicks) if skip and kicks > 0 else 0
        if flown == 0:
            contacts = step(balls)
            if see:
                see(k, contacts)
        k += flown or 1
        if progress:
            progress(k)
    rows += 0.0  # -0 becomes 0, and every NaN the same one: their signs mean nothing
    rows[np.isnan(rows)] = math.nan
    q, v = rows.reshape(len(rows), -1, 2, 2).transpose(2, 0, 3, 1).copy()  # kind, state, axis, ball
    return Run(np.arange(len(rows)) * dt, q, v)


# --- region: flight ---
def fly(balls, dt, rows, kicks):
    """Take steps until one may see a contact; rows[0] is the state now. Returns how many."""
    if any(ball.y - ball.radius < CONTACT_MARGIN for ball in balls):  # cheap, so it is asked first
        return 0
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
    safe = (gap >= reach_of(fastest, dt)) & (gap >= CONTACT_MARGIN)
    near = np.flatnonzero(~safe)  # not `gap < reach`: NaN must count as near
    flown = int(near[0]) if len(near) > 0 else len(rows) - 1
    for ball, values in zip(balls, rows[flown].tolist()):
        ball.x, ball.y, ball.vx, ball.vy = values
        ball.pushed = ball.pushed if flown == 0 else {}
    return flown


def step_reach(balls, dt: float) -> float:
    """The widest gap [m] that balls may close in a step: leapfrog looks this far."""
    fastest = 0.0
    for ball in balls:
        fastest = max(fastest, ball.vx * ball.vx + ball.vy * ball.vy)
    return max(reach_of(math.sqrt(fastest), dt), CONTACT_MARGIN)


def reach_of(fastest, dt):
    """Four times the way of the fastest ball [m]: two meet, and a hit may speed them up."""
    return 4.0 * dt * (fastest - dt * GRAVITY)


# --- region: lcp ---
def lcp_step(balls, dt, restitution, baumgarte, iters, warm=0.0) -> list[Contact]:
    """One step [s]: list contacts, set targets, then gravity, then impulses, then the move."""
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
    return contacts


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


# --- region: sweep ---
def solve_contacts(contacts, iters: int, tolerance: float = 0.0) -> int:
    """Find impulses with lam >= 0, w >= 0 and lam w = 0, where w = v_n + R lam - target.

    Projected Gauss-Seidel: a sweep brings one contact after the other to its target, and each
    disturbs its neighbours; the next sweep mends those. Returns the number of the first sweep in
    which no correction was above `tolerance` [m/s]; 0 if there was none. The problem is that of
    Moreau (1988), Stewart and Trinkle (1996), and Anitescu and Potra (1997).
    """
    for sweep in range(1, iters + 1):
        settled = True
        for c in contacts:
            missing = c.target - c.v_n() - c.softness * c.lam  # -w, the velocity that is missing
            lam = max(0.0, c.lam + missing * c.m_eff)  # clamp the sum: it may shrink, never pull
            change = lam - c.lam
            c.push(change)
            c.lam = lam
            settled = settled and abs(change) <= tolerance * c.m_eff
        if settled:  # with a tolerance of 0 no further sweep would change a bit
            return sweep
    return 0


# --- region: lcp-target ---
def contact_target(c, restitution, baumgarte, dt):
    """The least normal velocity [m/s] that contact c may have after the step.

    The step ends with gap + dt v_n, which must not be negative. So v_n has to be at least
    -gap / dt = depth / dt: a gap may close, and an overlap must open. To open it in one step would
    throw the balls apart, so a step opens only the share beta of it (Baumgarte 1972): that v_n is
    the bias. By the same formula only that share of a gap may close.

    With e > 0, balls that touch or would meet within this step bounce: the target is -e v_n, or
    the bias of an overlap if that is larger. Balls that would not meet may close their gap, but
    their target is at most -e v_n. So the impulses add no energy on the floor (Moreau 1988); a
    bias, unfinished sweeps, and the move after a bounce can.
    """
    # A landing of drop, seed 0: at a gap of 2.76 mm no contact is listed. v_n is -4.22 m/s, so the
    # ball moves by 8.44 mm, to a depth of 5.67 mm. The bias is 0.2 / 0.002 s * 5.67 mm = 0.57 m/s,
    # and the step ends at 4.54 mm. The next bias is 0.45 m/s, below v_n = 0.55: the ball hops.
    closing = c.depth / dt  # this v_n ends the step with a gap of 0
    bias = baumgarte / dt * c.depth  # < 0 across a gap
    if restitution == 0.0:
        return bias
    v_n = c.v_n()
    bounce = -restitution * v_n
    if bias > 0.0:  # an overlap, and beta > 0
        return max(bias, bounce)
    meets = -dt * v_n >= -c.depth  # v_n < 0 closes -dt v_n of the gap -depth in this step
    return bounce if meets else min(bounce, closing)


# --- region: soft ---
MOST_SWEEPS = 10_000  # in a solve; after them soft goes on with what it has, and exact gives up
LAST_BITS = 2.0**-42  # of the fastest speed (a choice): soft sweeps until no correction is above
SOLREF = (0.02, 1.0)  # MuJoCo's default: time constant [s], damping ratio
SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)  # MuJoCo's default: d0, d1, width [m], mid, power
HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)  # the hardest contact that MuJoCo allows


def soft_step(balls, dt: float, solref: tuple, solimp: tuple) -> list[Contact]:
    """One step [s] like lcp's, but softened, and swept until only LAST_BITS would change."""
    contacts = detect_contacts(balls, margin=0.0)
    for c in contacts:
        soften(c, dt, solref, solimp)
    accelerate(balls, dt)
    fastest = 0.0
    for c in contacts:
        fastest = max(fastest, abs(c.target))
    for ball in balls:
        fastest = max(fastest, abs(ball.vx), abs(ball.vy))
    warm_start(contacts, 1.0)  # with R > 0 there is one answer, wherever the sweeps begin
    solve_contacts(contacts, MOST_SWEEPS, LAST_BITS * fastest)
    remember(balls, contacts)
    move(balls, dt)
    return contacts


def soften(c, dt, solref, solimp):
    """Give contact c the target and the softness that MuJoCo's contact has.

    A spring K [1/s^2] and a damper B [1/s] ask for the acceleration K d depth - B v_n, whatever
    the mass (MuJoCo's mj_makeImpedance, mj_referenceConstraint). The softness R [1/kg] lets the
    contact miss it. The nearer d is to 1, the smaller R is.
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
    inv_m_eff = c.a.inv_mass + c.b.inv_mass
    c.softness = max(1e-15, (1.0 - d) / d * inv_m_eff)  # no less: MuJoCo's mjMINVAL
    c.m_eff = 1.0 / (inv_m_eff + c.softness)


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


# --- region: soft-impedance ---
def impedance(depth: float, solimp: tuple) -> float:
    """How hard the contact is at that depth [m], from 0 to 1: MuJoCo's d (its getimpedance)."""
    d0, d1, width, mid, power = solimp  # d0 at the surface, d1 from a depth of `width` [m] on
    if width <= 1e-15:  # m; MuJoCo takes the mean then
        return 0.5 * (d0 + d1)
    if depth >= width:
        return d1
    share = depth / width  # in between: an S of two powers, which meet where share is mid
    if share <= mid:
        rise = raised(share, power) / raised(mid, power - 1.0)
    else:
        rise = 1.0 - raised(1.0 - share, power) / raised(1.0 - mid, power - 1.0)
    return d0 + rise * (d1 - d0)


def raised(x, power):
    """x to that power; a whole one by products, which round alike in every language."""
    if power != int(power):
        return x**power
    product = 1.0
    for _ in range(int(power)):
        product *= x
    return product


# --- region: momentum ---
def solve_with_momentum(contacts, iters: int, tolerance: float = 0.0) -> int:
    """Like solve_contacts, but after each sweep every lam goes on a little.

    Towers and piles then need far fewer sweeps. lam goes on by a share of its last change. The
    share grows from 0 towards 1 (Nesterov 1983), and starts again at 0 when a sweep turns back
    (O'Donoghue and Candes 2015).
    """
    t = 1.0
    for c in contacts:
        c.start = c.before = c.lam  # lam before this sweep; lam after the last sweep
    for sweep in range(1, iters + 1):
        if solve_contacts(contacts, 1, tolerance):
            return sweep
        onward = 0.0  # below 0: on the whole, the sweep turned against the way lam was going
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


# --- region: leapfrog ---
OPENS = 0.03  # of the two radii (a choice): the most of an overlap that a step opens


def leapfrog_step(balls, dt, restitution, iters) -> list[Contact]:
    """One step [s]: impacts; half of gravity, where, move; half of gravity, how fast.

    An impact is asked once, at its own moment; what lasts, twice: where, gap + dt v_n >= 0; and
    after the move, if it pushed, how fast, v_n >= 0. lam is kept between: what opened an overlap is
    taken back. Without contacts this is leapfrog; with lasting ones, RATTLE (Andersen 1983).

    Not mended: unfinished sweeps let a stack sag; an impact slower than what gravity adds in a step
    does not bounce; after as many moments as MOST_PUSHES allows, the last takes the rest of a step.
    """
    for ball in balls:
        ball.ax = ball.ay = 0.0  # what hold set in the last step is gone
    contacts = detect_contacts(balls, step_reach(balls, dt))
    for c in contacts:
        radii = c.a.radius + c.b.radius
        c.reach = radii - max(0.0, c.depth - OPENS * radii)  # a deep overlap counts as a small one
        c.struck = 0.0
        c.least = 1e-6 if restitution > 0.0 else -GRAVITY  # m/s^2; see lasts
        look(c, 0.0)
    if restitution > 0.0:  # with e = 0 nobody asks who is held; see lasts
        find_held(balls, contacts, dt)
    if may_strike(contacts, dt, restitution):
        take_impacts(balls, contacts, dt, restitution, iters)
    for c in contacts:
        if lasts(c, dt) or (restitution == 0.0 and c.struck == 0.0):
            look(c, nearest(c, dt))
        c.target = c.depth / dt
        c.lam = 0.0
    accelerate(balls, 0.5 * dt)
    solve_with_momentum(contacts, iters)  # where
    move(balls, dt)
    accelerate(balls, 0.5 * dt)
    closed = [c for c in contacts if c.lam > 0.0]
    for c in closed:
        look(c, 0.0)  # the normal of now
        c.target = 0.0
    solve_with_momentum(closed, iters)  # how fast
    for c in contacts:
        c.lam += c.struck
    return contacts


# --- region: leapfrog-lasts ---
def look(c, t):
    """Set contact c to time t [s] of this step: its normal, its gap [m], and its speed, v_n then.

    Its depth is that at the start of the step, along this normal.
    """
    a, b = c.a, c.b
    x, y, ax, ay = a.x - b.x, a.y - b.y, a.ax - b.ax, a.ay - b.ay
    vx, vy = a.vx - b.vx + t * ax, a.vy - b.vy + t * ay
    dx, dy = x + t * (vx - 0.5 * t * ax), y + t * (vy - 0.5 * t * ay)
    distance = math.sqrt(dx * dx + dy * dy)
    if b is not FLOOR and distance > 0.0:
        c.nx, c.ny = dx / distance, dy / distance
    c.gap = c.nx * dx + c.ny * dy - c.reach
    c.speed = c.nx * vx + c.ny * vy
    c.depth = c.reach - (c.nx * x + c.ny * y)


def find_held(balls, contacts, dt):
    """Find which balls are held: 2 if fixed or on the floor, 1 if only on balls that are held."""
    for ball in balls:
        ball.held = 0.0 if ball.inv_mass > 0.0 else 2.0
    more = True
    while more:
        more = False
        for c in contacts:
            upper = c.a if c.ny > 0.0 else c.b
            if upper.held == 0.0 and gravity_on(c) > 0.0 and lasts(c, dt):
                upper.held = 2.0 if c.b is FLOOR else 1.0
                more = True


def gravity_on(c):
    """How gravity closes c [m/s^2]: 0 for balls unless the lower is held and the upper can fall."""
    upper, lower = (c.a, c.b) if c.ny > 0.0 else (c.b, c.a)
    presses = lower is FLOOR or (lower.held > 0.0 and upper.held < 2.0)
    return -GRAVITY * abs(c.ny) if presses else 0.0


def lasts(c, dt):
    """Whether c lasts: it would touch no faster than gravity alone makes it in a step.

    With e = 0 that is all, since nothing would bounce. With e > 0 gravity must press it, or it
    touches at rest.
    """
    g_n = max(c.least, gravity_on(c))  # m/s^2
    slow = dt * g_n + 1e-9  # m/s
    return c.speed * c.speed + 2.0 * g_n * max(0.0, c.gap) <= slow * slow


def nearest(c, dt):
    """When the balls of c touch in free flight, or are nearest [s]: so they may pass each other."""
    a, b = c.a, c.b
    dx, dy = a.x - b.x, a.y - b.y
    vx, vy = a.vx - b.vx, a.vy - b.vy  # gravity cancels where both fall
    along = dx * vx + dy * vy  # < 0: they come nearer
    fast = vx * vx + vy * vy
    apart = dx * dx + dy * dy - c.reach * c.reach
    if b is FLOOR or apart <= 0.0 or along >= 0.0 or fast == 0.0:
        return 0.0
    root = math.sqrt(max(0.0, along * along - fast * apart))  # 0 if they miss
    return min(dt, (-along - root) / fast)


# --- region: leapfrog-impacts ---
MOST_PUSHES = 2000.0  # at contacts, times iters: what the impacts of a step may cost (a choice)


def may_strike(contacts, dt, restitution):
    """Whether what does not last could close within this step; with e = 0, if it is fast."""
    for c in contacts:
        slow = restitution == 0.0 and c.speed > dt * GRAVITY
        if c.gap + dt * (c.speed + dt * GRAVITY) < 0.0 and not slow and not lasts(c, dt):
            return True
    return False


def take_impacts(balls, contacts, dt, restitution, iters):
    """The impacts of this step, one moment after the other."""
    hold(balls, contacts, dt, iters)
    left = MOST_PUSHES * iters / len(contacts)  # sweeps
    last = False
    when = next_meeting(contacts, dt)
    while when < math.inf and not last:
        last = left < iters
        until = dt if last else when
        most = int(max(iters, min(10 * iters, left)))  # unfinished sweeps may add energy
        left -= 1 + strike_at(balls, contacts, when, until, dt, restitution, most)
        when = next_meeting(contacts, dt)


def hold(balls, contacts, dt, iters):
    """Give every ball its acceleration [m/s^2]: gravity, and pushes of contacts that last."""
    lasting = [c for c in contacts if lasts(c, dt)]
    for c in lasting:
        c.target = min(0.0, c.depth / dt)
    keep_velocities(balls)
    accelerate(balls, 0.5 * dt)
    solve_with_momentum(lasting, iters)
    for ball in balls:
        ball.ax = 2.0 / dt * (ball.vx - ball.vx_before)
        ball.ay = 2.0 / dt * (ball.vy - ball.vy_before)
        ball.vx, ball.vy = ball.vx_before, ball.vy_before
        ball.since = 0.0  # s: when it was struck last


def keep_velocities(balls):
    """Remember the velocities of now."""
    for ball in balls:
        ball.vx_before, ball.vy_before = ball.vx, ball.vy


def next_meeting(contacts, dt):
    """When the next balls strike one another [s]; inf if none do in this step."""
    when = math.inf
    for c in contacts:
        meet(c, dt)
        when = min(when, c.when)
    return when


def meet(c, dt):
    """Set when the balls of c strike one another [s], by Newton's method; inf if not in this step.

    c stays at that moment, or at one when they have passed each other, so that they may.
    """
    c.when = math.inf
    first = max(c.a.since, c.b.since)
    t, before = first, -1.0
    for _ in range(40):  # a few will do, but balls that only graze halve the way each time
        if t == before:
            break
        look(c, t)
        if c.speed >= 0.0 or lasts(c, dt) or c.m_eff == 0.0 or (t == dt and c.gap > 0.0):
            return
        before, t = t, min(dt, max(first, t - c.gap / c.speed))
    c.when = t


def strike_at(balls, contacts, when, until, dt, restitution, most):
    """v_n becomes -e v_n where balls meet from `when` to `until`; what lasts closes no faster.

    A struck ball is set back to where it would have begun with its new velocity: so all balls
    stay at the start of the step. Returns how many sweeps it took, `most` at most.
    """
    for c in contacts:
        look(c, when)
    touching = [c for c in contacts if c.when <= until or lasts(c, dt)]
    for c in touching:
        # what lasts and opens may close as fast: a push up to a target of 0 would add energy
        after = -restitution * c.speed if c.when <= until else -abs(c.speed)
        c.target = c.v_n() + after - c.speed  # at the start of the step
        c.lam = 0.0
    keep_velocities(balls)
    sweeps = solve_with_momentum(touching, most, 1e-11)  # m/s
    for c in touching:
        c.struck += c.lam
    for ball in balls:
        if ball.vx != ball.vx_before or ball.vy != ball.vy_before:
            ball.x -= when * (ball.vx - ball.vx_before)
            ball.y -= when * (ball.vy - ball.vy_before)
            ball.since = when
    return sweeps if sweeps > 0 else most


# --- region: exact ---
TOUCH = 1e-13  # m: balls that start no farther apart, or in one another, start in touch
SLOW = 1e-7  # m/s: a slower bounce would be 5e-16 m high, and is left out
TOGETHER = 1.0 + 1e-12  # times the shortest time to an impact: what comes by then comes with it
STILL = 1e-12  # m/s, or m/s^2: less than this is rounding, so the contact rests, or stays closed
MOST_IMPACTS = 20_000  # a run with more is given up


def exact_run(scene: Scene, times, progress=None):
    """q, v (S, 2, N) [m, m/s] at `times` (S,) [s], rising from 0, of balls over one another.

    Between two impacts every acceleration stays the same, so a gap is a parabola in time. The next
    impact is the earliest root: no time step, no error but rounding (1e-10 radii over seconds and
    metres). Raises RuntimeError after MOST_IMPACTS; ArithmeticError if sweeps do not settle.
    """
    balls = make_balls(scene)
    pairs = detect_contacts(balls, margin=math.inf)  # every pair: any two may touch later
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
        for k, ball in enumerate(balls):  # constant acceleration: y + t (v + a t / 2), v + t a
            q[done:last, 1, k] = ball.y + t * (ball.vy + 0.5 * t * a[k])
            v[done:last, 1, k] = ball.vy + t * a[k]
            ball.y += span * (ball.vy + 0.5 * span * a[k])
            ball.vy += span * a[k]
        now, done = now + span, last
        if done == len(times):
            return q, v
        if progress:
            progress(done)
    raise RuntimeError(f"more than {MOST_IMPACTS:,} impacts by {now:.6g} s: the balls rattle")


# --- region: exact-impact ---
def strike(touching, restitution):
    """All impacts of one moment: v_n becomes -e v_n where a contact pushes."""
    for c in touching:
        c.depth = 0.0  # set: rounding never decides who touches
        back = -restitution * c.v_n()  # < 0: they part already, and need no push
        c.target = 0.0 if 0.0 <= back < SLOW else back
    settle(touching)


def accelerations(balls, touching, pairs):
    """The acceleration [m/s^2] of every ball, and of every gap: None of one that stays closed.

    The same sweep, one derivative higher: while it runs, vy holds accelerations, lam forces, and
    target is the least acceleration of a gap. The velocities are put back at the end.
    """
    resting = [c for c in touching if abs(c.v_n()) < STILL]
    before = [ball.vy for ball in balls]
    for ball in balls:
        ball.vy = GRAVITY if ball.inv_mass > 0.0 else 0.0
    for c in resting:
        c.target = 0.0  # it may open and may not close
    settle(resting)
    a = [ball.vy if abs(ball.vy) > STILL else 0.0 for ball in balls]
    gap_a = [None if c in resting and c.v_n() < STILL else c.v_n() for c in pairs]
    for ball, vy in zip(balls, before):
        ball.vy = vy
    return a, gap_a


def settle(contacts):
    """Sweep until only rounding is left. Raises ArithmeticError if the sweeps do not get there."""
    sizes = [size for c in contacts for size in (c.a.vy, c.b.vy, c.target)]
    tolerance = 2.0**-8 * LAST_BITS * max(map(abs, sizes), default=0.0)  # finer than soft's
    for c in contacts:
        c.lam = 0.0
    if not solve_with_momentum(contacts, MOST_SWEEPS, tolerance):
        raise ArithmeticError("the masses are too unequal: the sweeps do not settle")


# --- region: exact-when ---
def time_to_impact(gap, v_n, a_n):
    """When a gap closes [s]: the first root of gap + v_n t + a_n t^2 / 2; inf if it does not."""
    if a_n is None or not (v_n < 0.0 or a_n < 0.0):  # None: it stays closed
        return math.inf
    square = v_n * v_n - 2.0 * gap * a_n
    if square < 0.0:
        return math.inf
    root = math.sqrt(square)
    # each form is a sum: a difference of near numbers would lose digits
    return 2.0 * gap / (root - v_n) if v_n < 0.0 else -(v_n + root) / a_n


def next_impact(pairs, gap_a):
    """How long until the next gap closes [s], and who touches then; depths become those of then."""
    roots = [time_to_impact(-c.depth, c.v_n(), a_n) for c, a_n in zip(pairs, gap_a)]
    span = min(roots)
    for c, root, a_n in zip(pairs, roots, gap_a):
        closed = a_n is None or root <= span * TOGETHER
        c.depth = 0.0 if closed else -(-c.depth + span * (c.v_n() + 0.5 * span * a_n))
    return span, [c for c in pairs if c.depth >= 0.0]


# --- region: run ---
class Model(NamedTuple):
    """All there is to know of a model: whoever runs, records or draws it asks nothing else."""

    step: Callable | None  # step(balls, dt, ...) returns the contacts; None: it takes no steps
    knobs: tuple[str, ...]  # settings that change its runs: first its step's, in the step's order
    kicks: int  # how often a step adds gravity where nothing touches; 0: it is not flown
    look: tuple  # colour, marker and dash of its curves


MODELS = {  # in the order of the printed table
    "penalty": Model(penalty_step, ("stiffness", "damping"), 1, ("#d55e00", "v", (0, (1, 1)))),
    "lcp": Model(lcp_step, ("restitution", "baumgarte", "iters", "warm"), 1, ("#0072b2", "o", "-")),
    "soft": Model(soft_step, ("solref", "solimp", "restitution"), 1, ("#cc79a7", "d", (0, (5, 1)))),
    "leapfrog": Model(
        leapfrog_step, ("restitution", "iters"), 2, ("#e69f00", "P", (0, (7, 1, 1, 1)))
    ),
    "exact": Model(None, ("restitution",), 0, ("#009e73", "*", (0, (2, 2)))),
}
STEPPED = [model for model in MODELS if MODELS[model].step]
MANY = 1e6  # steps times balls squared, about: from here on, compiled loops pay
FEW = 4  # balls in a column; curriculum/exact.py was measured to be faster for more


class Settings(NamedTuple):
    """The knobs of the models. What belongs to a material, e and damping, is in the scene."""

    stiffness: float = 1e4  # k of penalty [N/m]
    baumgarte: float = 0.2  # beta of lcp: the share of an overlap that one step removes
    iters: int = 20  # of lcp and leapfrog: sweeps a solve, at most; of an impact up to 10 x
    warm: float = 0.0  # of lcp: the share of a step's impulses that the next begins with
    solref: tuple | None = None  # of soft: time constant [s], damping ratio; see soft_defaults
    solimp: tuple | None = None  # of soft: how hard, at which depth; see impedance
    skip: bool = True  # leave out steps whose result is known; no bit changes


def run_model(model, scene, dt, steps, settings=Settings(), progress=None, see=None) -> Run:
    """The run of a scene by one of MODELS; progress and see as simulate has them.

    Raises ValueError for what no model can run, RuntimeError where exact cannot be exact.
    """
    scene, settings = checked(model, scene, dt, steps, settings)
    if see and model not in STEPPED:
        raise ValueError(f"see: {model} takes no steps; allowed: {', '.join(STEPPED)}")
    if model not in STEPPED:
        return choose_exact(scene, dt, steps, progress)
    many = settings.skip and not see and steps * len(scene.mass) ** 2 > MANY
    if many and (twin := beside("fast")):  # compiled loops, the same bits
        run = twin.run_if_it_pays(model, scene, dt, steps, settings, progress)
        if run:
            return run
    step, kicks = step_of(model, scene, dt, settings), MODELS[model].kicks
    return simulate(step, scene, dt, steps, settings.skip, progress, kicks, see)


def step_of(model: str, scene: Scene, dt: float, settings: Settings) -> partial:
    """step(balls) of a model that steps; its knobs are in its keywords."""
    step, knobs = MODELS[model].step, MODELS[model].knobs
    assert step, f"{model} takes no steps"
    e = scene.restitution
    values = settings._asdict() | {"restitution": e, "damping": scene.damping}
    values["solref"], values["solimp"] = soft_defaults(e, dt, settings.solref, settings.solimp)
    taken = step.__code__.co_argcount - 2  # not counting balls and dt
    return partial(step, dt=dt, **{knob: values[knob] for knob in knobs[:taken]})


@np.errstate(over="ignore")
def choose_exact(scene, dt, steps, progress=None):
    """The Run by exact_run for a few balls over one another, else by curriculum/exact.py."""
    times = np.arange(steps + 1) * dt
    apart = smallest_gap(scene.q0[None], scene.radius)[0] >= -TOUCH
    column = apart and (scene.q0[0] == scene.q0[0, 0]).all() and not scene.v0[0].any()
    reason = "balls that lie beside one another need curriculum/exact.py"
    if column and (len(scene.mass) <= FEW or not beside("exact")):
        try:
            return Run(times, *exact_run(scene, times, progress))
        except ArithmeticError as error:
            reason = str(error)
    if not (wider := beside("exact")):
        raise RuntimeError(reason)
    return Run(times, *wider.simulate_exact(scene, times, GRAVITY, progress or (lambda k: None)))


def beside(name: str, needed=False):
    """A module of curriculum/ beside this file; None if it, or what it needs, is not there.

    ImportError, in words, instead of None if it is `needed`.
    """
    home = Path(__file__).resolve().parent
    try:
        if not Path(home, "curriculum", *name.split(".")).with_suffix(".py").exists():
            raise ImportError("it needs the folder curriculum beside contact.py")
        if str(home) not in sys.path:
            sys.path.append(str(home))
        return importlib.import_module(f"curriculum.{name}")
    except ImportError as error:
        if needed or error.name:  # a name: a fault; none: the module says what it needs
            raise
        return None


# --- region: limits ---
USUAL = Settings()
NUMBERS = {  # kind, lowest, highest; of a flag also its usual value and its meaning
    "seed": (int, 0, 10**18, 0, "draws the start height"),
    "dt": (float, 1e-9, 1e3, 0.002, "time step [s]"),
    "steps": (int, 0, 10**8, None, "how many (2000)"),
    "bodies": (int, 1, 10**4, None, "balls of stack (3) and pile (24)"),
    "mass": (float, 1e-300, 1e300, 1.0, "of every ball [kg]"),  # in a scene also infinite
    "stiffness": (float, 0, 1e15, USUAL.stiffness, "k of penalty [N/m]"),
    "damping": (float, 0, 1e9, -1.0, "c of penalty [N s/m]; below 0: the scene's, 80 or 0"),
    "restitution": (float, 0, 1, -1.0, "e of the others; below 0: the scene's, 0 or 0.7"),
    "baumgarte": (float, 0, 1, USUAL.baumgarte, "beta of lcp: share of an overlap to remove"),
    "warm": (float, 0, 1, USUAL.warm, "of lcp: share of the last impulses to begin with"),
    "iters": (int, 1, MOST_SWEEPS, USUAL.iters, "of lcp and leapfrog: sweeps a solve, at most"),
    "solref": (float, -1e12, 1e6, None, "of soft: time constant [s], damping ratio (0.02 1); or "
               "minus a stiffness, a damping"),
    "solimp": (float, 0, 100, None, "of soft: d0 d1 width mid power (0.9 0.95 0.001 0.5 2)"),
    "radius": (float, 1e-300, 1e300),
    "q0": (float, -1e300, 1e300),
    "v0": (float, -1e300, 1e300),
}  # fmt: skip


def checked(model, scene, dt, steps, settings):
    """Scene and Settings in the right types. ValueError names the field that nothing can run."""
    if model not in MODELS:
        raise ValueError(f"model: given {model!r}; allowed: {', '.join(MODELS)}")
    count = max(1, np.size(scene.mass))
    shapes = dict(q0=(2, count), v0=(2, count), mass=(count,), radius=(count,))
    shapes |= dict(solref=(2,), solimp=(5,))
    within("dt", dt)
    within("steps", steps)
    fields = scene._asdict() | settings._asdict()
    for name, given in fields.items():
        if name in NUMBERS and not (name in ("solref", "solimp") and given is None):
            fields[name] = within(name, given, shapes.get(name, ()))
    return Scene(*map(fields.get, Scene._fields)), Settings(*map(fields.get, Settings._fields))


@np.errstate(invalid="ignore")
def within(name, given, shape=()):
    """`given` as an array of that shape, or one number. ValueError if NUMBERS do not allow it."""
    kind, low, high = NUMBERS[name][:3]
    try:
        values = np.array(given)
    except ValueError:  # rows of different lengths
        values = np.array("")
    if values.dtype.kind not in "iuf" or values.shape != shape:
        form = f"numbers in the shape {shape}" if shape else "one number"
        raise ValueError(f"{name}: given {str(given).split()}"[:80] + f"; allowed: {form}")
    fine = (values >= low) & (values <= high) & ((values % 1 == 0) | (kind is float))
    fine |= (values == math.inf) & (name == "mass")  # a ball that nothing moves
    if name == "solref":
        fine &= (values >= 1e-6).all() or (values <= 0.0).all()
    if not fine.all():
        wrong = np.atleast_1d(values)[~np.atleast_1d(fine)].tolist()
        allowed = SPRINGS if name == "solref" else span(kind, low, high)
        raise ValueError(f"{name}: given {wrong[0]!r}; allowed: {allowed}")
    if name in ("solref", "solimp"):
        return tuple(values.tolist())
    return values.astype(kind) if shape else kind(values)


SPRINGS = "two numbers from 1e-06 up, or two up to 0"  # of solref


def span(kind, low, high):
    """The numbers of that kind from low to high, in words."""
    return f"{'a whole number' if kind is int else 'a number'} from {low:g} to {high:g}"


# --- region: measure ---
EXPLODED = 10.0  # a run that gains this many times its start energy, or more, has exploded


@np.errstate(all="ignore")
def energy(q, v, mass):
    """Kinetic plus potential energy [J] of states (..., 2, N), zero at the floor."""
    mass = np.where(np.isfinite(mass), mass, 0.0)  # infinite: left out, since no push changes it
    return (0.5 * mass * (v * v).sum(-2) - mass * GRAVITY * q[..., 1, :]).sum(-1)


@np.errstate(all="ignore")
def smallest_gap(q, radius):
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N)."""
    if q.size * len(radius) > 2.0 * MANY and (twin := beside("fast")):
        found = twin.gap_if_it_pays(q, radius)
        if found is not None:
            return found
    gap = (q[:, 1] - radius).min(-1)
    for lag in range(1, len(radius)):  # ball i and ball i + lag, for all i, all states at once
        dx, dy = (q[:, :, lag:] - q[:, :, :-lag]).swapaxes(0, 1)
        radii = radius[lag:] + radius[:-lag]
        gap = np.minimum(gap, (np.sqrt(dx * dx + dy * dy) - radii).min(-1))
    return gap


def blow_up_step(total):
    """The first step at which the energy [J] has gained EXPLODED times its start, or None."""
    bad = ~(total - total[0] < EXPLODED * (abs(total[0]) or 1.0))  # NaN counts as exploded
    return int(bad.argmax()) if bad.any() else None


def first_contact(run: Run, scene: Scene, dt: float, gap) -> int:
    """Which state is the first to touch, or to have a velocity that not only gravity changed."""
    gained = np.outer((0.0, dt * GRAVITY), np.isfinite(scene.mass))  # from gravity, in one step
    rounding = 1e-9 * (np.abs(run.v[:-1]) + np.abs(gained))
    touched = gap <= 0.0
    touched[1:] |= (np.abs(np.diff(run.v, axis=0) - gained) > rounding).any((1, 2))
    return int(touched.argmax()) if touched.any() else len(touched)  # none


def at_rest(run: Run, scene: Scene) -> bool:
    """Whether no ball that can move went faster than 1 mm/s in the last step, or is falling.

    It judges ways, not speeds: leapfrog's may hold half a step of gravity that moves nothing.
    """
    if len(run.t) < 3:
        return False
    first, last = np.diff(run.q[-3:][..., np.isfinite(scene.mass)], axis=0) / run.t[1]
    falling = np.abs(last[1] - first[1]).max(initial=0.0) >= -0.5 * GRAVITY * run.t[1]
    return bool(not falling and np.hypot(*last).max(initial=0.0) < 1e-3)


def went_through(q, scene: Scene, gap, radius) -> str | None:
    """What a ball went through in the states q (S, 2, N): "the floor", "a ball" or None.

    Its centre came below the floor; or nearer to another centre than the larger of their radii, in
    a state or on the straight way to the next one. gap: smallest_gap; radius: of the smallest ball.
    """
    free = np.isfinite(scene.mass)
    if (q[:, 1, free] < 0.0).any():
        return "the floor"
    way = np.diff(q, axis=0, append=q[-1:])
    near = gap - 2.0 * np.hypot(way[:, 0], way[:, 1]).max(-1) < -radius  # elsewhere no ball can be
    q, way = q[near], way[near]
    for lag in range(1, len(free) if near.any() else 1):
        d, w = q[:, :, lag:] - q[:, :, :-lag], way[:, :, lag:] - way[:, :, :-lag]
        nearest_at = np.nan_to_num(-(d * w).sum(1) / (w * w).sum(1)).clip(0.0, 1.0)
        closest = np.hypot(*(d + nearest_at[:, None] * w).swapaxes(0, 1))
        inside = closest < np.maximum(scene.radius[lag:], scene.radius[:-lag])
        if (inside & (free[lag:] | free[:-lag])).any():
            return "a ball"
    return None


# --- region: quality ---
@np.errstate(all="ignore")
def contact_quality(run: Run, scene: Scene, dt: float, reference: Run | None = None):
    """The measures of a run {key: value}, in radii of the smallest ball and in start energies.

    Errors of height are against `reference`.
    """
    total, radius = energy(run.q, run.v, scene.mass), float(scene.radius.min())
    scale = abs(float(total[0])) or 1.0  # J; 1 J for a run that starts with none
    gap = smallest_gap(run.q, scene.radius)
    landing = first_contact(run, scene, dt, gap)
    step = blow_up_step(total)
    end = len(gap) if step is None else step  # after an explosion, balls go through anything
    through = went_through(run.q[:end], scene, gap[:end], radius)
    gap = gap / radius
    depth = np.maximum(-gap, 0.0)
    late = slice(3 * len(depth) // 4, None)  # the last quarter
    height = (run.q[late, 1] - run.q[-1, 1]) / radius
    return {
        **height_errors(run, scene, dt, landing, reference),
        "first_contact_step": landing,  # without a contact: the number of states
        "max_penetration_frac": float(depth.max()),
        "rest_penetration_frac": float(depth[-1]),  # the overlap at the end
        "rest_gap_frac": float(gap[-1]),
        "rebound_frac": float(gap[landing:].max(initial=0.0)),
        "rest_jitter": float(np.std(depth[late])),
        "height_jitter_frac": float(np.std(height, axis=0).max()),  # of the ball that moves most
        "energy_excess": float((total - total[0]).max()) / scale,
        "contact_energy": float(np.maximum(np.diff(total), 0.0).sum()) / scale,
        "blew_up": step is not None,
        "blew_up_step": step,
        "rests": step is None and at_rest(run, scene),
        "through": through,
    }


def height_errors(run, scene, dt, landing, reference):
    """The worst error of height [r], and the worst before any contact; None without reference."""
    if reference is None:
        return {"height_error_frac": None, "flight_error_frac": None}
    landed = first_contact(reference, scene, dt, smallest_gap(reference.q, scene.radius))
    error = np.abs(run.q[:, 1] - reference.q[:, 1]).max(-1) / float(scene.radius.min())
    flight = error[: min(landing, landed)].max(initial=0.0)
    return {"height_error_frac": float(error.max()), "flight_error_frac": float(flight)}


# --- region: stability ---
DT_GRID = (1, 2, 4, 8, 16, 32)  # multiples of --dt that the stability lines try
GRID_MODELS = ("penalty", "lcp", "leapfrog")  # not soft: its time constant grows with the step


def measure_stability(args, scene: Scene, known: dict) -> dict:
    """By model, the largest step of DT_GRID at which it does not explode; smaller are not tried.

    known: {model: quality} at --dt itself.
    """
    mass, damping, count = float(scene.mass[0]), scene.damping, len(scene.mass)
    grid: dict = {
        "dt_crit_penalty": critical_dt(mass, args.stiffness, 0.0),
        "dt_crit_damped": critical_dt(mass, args.stiffness, damping),
        "dt_crit_stack": critical_dt(mass, args.stiffness, damping, count),
    }
    for model in GRID_MODELS:
        grid[model], there = None, {}  # what stays if no run comes to a contact
        for factor in reversed(DT_GRID):  # the answer comes first
            dt, quality = args.dt * factor, known[model]
            if factor > 1:
                quality = contact_quality(run_flags(args, scene, model, dt), scene, dt)
            if quality["blew_up"]:
                grid[model] = 0.0  # what stays if all others explode
            elif quality["first_contact_step"] <= args.steps:
                grid[model], there = dt, quality
                break
        grid[f"{model}_penetration_frac"] = there.get("max_penetration_frac")
        grid[f"{model}_through"] = there.get("through")
    return grid


# --- region: flags ---
def number(kind, low, high, text):
    """The number of that kind, from low to high, that `text` is; a whole one may be 1e3."""
    try:
        value = int(text) if text.isdecimal() else float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high or (kind is int and value % 1 > 0):
        given = f"given {text[:40]!r}; allowed: {span(kind, low, high)}"
        raise argparse.ArgumentTypeError(given)
    return kind(value) + 0  # -0.0 becomes 0.0


def add_flags(flag):
    """All flags, by argparse's add_argument."""
    flag("--scene", choices=SCENES, default="drop", help="one ball, drop or bounce; or many (drop)")
    flag("--contact", choices=("all", *MODELS), default="all", help="the model (all)")
    for name, (kind, low, high, *words) in NUMBERS.items():
        if words:
            usual, text = words
            own = usual == -1.0  # like any other below 0: the scene's own value
            text += "" if own or usual is None else f" ({usual:g})"
            value = partial(number, kind, -high if own else low, high)
            count = {"solref": 2, "solimp": 5}.get(name)
            flag(f"--{name}", type=value, nargs=count, default=usual, metavar="N", help=text)
    switch = argparse.BooleanOptionalAction
    flag("--smoke", action="store_true", help="a fixed 800 steps, for CI")
    flag("--device", choices=("cpu",), default="cpu", help="where it runs (cpu)")
    flag("--skip", action=switch, default=True, help="leave out work that changes no bit (yes)")
    flag("--rerun", action=switch, default=True, help="write the recording contact.rrd (yes)")
    flag("--plot", action="store_true", help="draw contact.svg, by matplotlib")
    flag("--out", default="outputs/ch3.5-contact", help="folder of the files (%(default)s)")


def parse_flags(argv):
    """The checked command line. Bad input ends with one line on stderr and exit status 2."""
    form = partial(argparse.RawDescriptionHelpFormatter, width=78)
    parser = argparse.ArgumentParser(
        "contact.py", argparse.SUPPRESS, __doc__, formatter_class=form, allow_abbrev=False
    )
    parser._negative_number_matcher = re.compile(r"(?i)-\.?(\d|inf|nan)")  # -1e4 is a value
    add_flags(parser.add_argument)
    for word in argv:
        if re.fullmatch("--[a-z]+=--", word):  # argparse would misread it
            parser.error(f"argument {word[:-3]}: given '--', which is no value")
    args, unknown = parser.parse_known_args(argv)
    hint = "".join(f"; a scene is chosen by --scene {w}" for w in unknown[:1] if w in SCENES)
    if unknown:
        parser.error(f"given {' '.join(unknown)}, which is no flag{hint}")
    if args.smoke and args.steps is not None:
        parser.error("--smoke has 800 steps: leave out --steps")
    if args.bodies and SCENES[args.scene] == 1:
        parser.error("--bodies is for stack and pile")
    if args.solref and max(args.solref) > 0.0 and min(args.solref) < 1e-6:
        parser.error(f"argument --solref: given {args.solref}; allowed: {SPRINGS}")
    if not args.out.strip():
        parser.error("argument --out: given ''; allowed: the name of a folder")
    args.out = os.path.expanduser(args.out)
    args.steps = 800 if args.smoke else 2000 if args.steps is None else args.steps
    return args


def chosen_scene(args, seed):
    """The scene that the flags ask for; a restitution or damping below 0 is the scene's own."""
    e, c = (None if value < 0.0 else value for value in (args.restitution, args.damping))
    return build_scene(args.scene, seed, args.bodies, e, c, args.mass)


def run_flags(args, scene, model, dt):
    """The run that the flags ask for, at that dt; a terminal shows how far it is."""
    settings = Settings(*(getattr(args, knob) for knob in Settings._fields))
    parallel = beside("parallel") if sys.stderr and sys.stderr.isatty() else None
    bar = parallel.bar(args.steps, f"{model}, dt = {dt:g} s") if parallel else None
    return run_model(model, scene, dt, args.steps, settings, bar)


def run_all(args, scene):
    """{model: Run}, {model: why it has none}, and {model: contact_quality}, as the flags ask."""
    runs, without = {}, {}
    for model in MODELS if args.contact == "all" else [args.contact]:
        try:
            if model == "exact" and args.contact == "all" and len(scene.mass) > SCENES["pile"]:
                raise RuntimeError("too many balls to wait for it; ask by --contact exact")
            runs[model] = run_flags(args, scene, model, args.dt)
        except RuntimeError as error:
            without[model] = str(error)
    measure = partial(contact_quality, scene=scene, dt=args.dt, reference=runs.get("exact"))
    return runs, without, {model: measure(run) for model, run in runs.items()}


# --- region: table ---
COLUMNS = {  # title: key of contact_quality, meaning
    "depth/r": ("max_penetration_frac", "the deepest overlap; r: radius of the smallest ball"),
    "gap/r": ("rest_gap_frac", "the smallest gap at the end: below 0 it is an overlap"),
    "hop/r": ("rebound_frac", "how far all surfaces part again after the first contact"),
    "energy+": ("energy_excess", "the most energy above the start, as a share of the start's"),
    "rises": ("contact_energy", "all that the energy rises, added up; a spring gives back, too"),
    "flight/r": ("flight_error_frac", "the worst height error before the first contact"),
    "off/r": ("height_error_frac", "the worst height error of all; both against exact"),
    "jitter/r": ("height_jitter_frac", "how much a height varies in the last quarter (std)"),
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
    if row["through"]:
        return f"through {row['through']}"
    return "rests" if row["rests"] else "moves"


def print_table(rows, state):
    """A line per row {name: {key: value}}, then state(row) of each, then what a column means.

    A column in which all numbers are 0 or unknown is left out.
    """
    lines = [name.ljust(max(map(len, rows), default=0)) for name in ("", *rows)]
    meanings = {}
    for title, (key, meaning) in COLUMNS.items():
        cells = [shown(row[key]) for row in rows.values()]
        if not set(cells) <= {"0", "-"}:
            meanings[title] = meaning
            wide = max(map(len, (title, *cells)))
            lines = [f"{line}  {cell:>{wide}}" for line, cell in zip(lines, (title, *cells))]
    if meanings:
        print("\n".join(lines))
    for text, names in itertools.groupby(rows, key=lambda name: state(rows[name])):
        print(f"state: {text}: {', '.join(names)}")
    for title, meaning in meanings.items():
        print(f"  {title:<11}{meaning}")


# --- region: report ---
def print_stability(grid, count):
    """The largest step that each model stood, and the critical steps of penalty."""
    tried = ", ".join(map(str, DT_GRID))
    print(f"stability: the largest of {tried} times --dt without an explosion")
    for model in GRID_MODELS:
        depth, through = grid[f"{model}_penetration_frac"], grid[f"{model}_through"]
        text = "comes to no contact" if grid[model] is None else "none, wherever it touches"
        if grid[model]:
            text = f"{grid[model]:g} s, there {shown(depth)} r deep"
            text += f", through {through}" if through else ""
        print(f"stability: {model} {text}")
    stack = f"a stack of {count}: {shown(grid['dt_crit_stack'], 4)} s; " if count > 1 else ""
    one, undamped = shown(grid["dt_crit_damped"], 4), shown(grid["dt_crit_penalty"], 4)
    print(f"critical dt of penalty, one ball: {one} s; {stack}2 sqrt(m/k): {undamped} s")


def rounded(value):
    """`value` as JSON holds it, its floats rounded to 12 decimals; None where one is not finite."""
    return json.loads(
        json.dumps(value),
        parse_float=lambda text: round(float(text), 12) + 0.0,
        parse_constant=lambda name: None,
    )


def write_whole(path, text: str):
    """Write a file whole or not at all: a full disk leaves what stood there. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(text.encode())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_files(args, metrics, runs, scene):
    """Write metrics.json; if asked, recording, picture. Yields a line for each. Raises OSError."""
    out, title = Path(args.out), f"{args.scene}, seed {args.seed}, dt = {args.dt:g} s"
    text = json.dumps(metrics, indent=2, sort_keys=True, allow_nan=False)
    write_whole(out / "metrics.json", f"{text}\n")
    yield f"metrics: {out / 'metrics.json'}"
    recording = args.rerun, "recording", "show.recording", "contact.rrd"
    picture = args.plot, "picture", "show.picture", "contact.svg"
    for asked, name, module, file in (recording, picture):
        if asked:
            try:
                maker = beside(module, needed=True)
                maker.write(str(out / file), runs, scene, metrics["quality"], title)
                yield f"{name}: {out / file}"
            except ImportError as error:
                if error.name:
                    raise  # a fault in the module
                yield f"no {name}: {error}"


def report(args, argv):
    """Run the models, print what was found, write the files. Returns the exit status."""
    scene, remarks = chosen_scene(args, args.seed), beside("show.remarks")
    runs, without, quality = run_all(args, scene)
    if not runs:
        return fail("; ".join(f"no {model}: {reason}" for model, reason in without.items()))
    keys = "scene", "contact", "dt", "steps", "seed", "stiffness"
    metrics = {key: getattr(args, key) for key in keys} | {"restitution": scene.restitution}
    metrics |= {"quality": quality, "stability": {}, "without": without}
    if args.contact == "all" and args.scene != "pile":  # no formula gives a pile's critical step
        metrics["stability"] = measure_stability(args, scene, quality)
    metrics = rounded(metrics)
    print(f"scene {args.scene}, seed {args.seed}: {args.steps} steps of {args.dt:g} s")
    if remarks:
        remarks.print_remarks(args, runs, scene)
    print_table(metrics["quality"], ending)
    for model, reason in without.items():
        print(f"no {model}: {reason}")
    if metrics["stability"]:
        print_stability(metrics["stability"], len(scene.mass))
    lines, lost = [], None
    try:
        for line in write_files(args, metrics, runs, scene):
            lines.append(line)
    except OSError as error:
        lost = f"cannot write to {args.out}: {error.strerror}"
    print("\n".join(lines))
    if lost:
        return fail(f"{lost}; the report is whole, give another --out to keep its files")
    if remarks:
        remarks.print_next(args, argv)
    return 0


# --- region: main ---
def fail(message):
    """One line on stderr. Returns the exit status."""
    print(f"contact.py: error: {message}", file=sys.stderr)
    return 2


def main(argv=None):
    """The command line. Returns the exit status: 0, or 2 if something failed."""
    argv = sys.argv[1:] if argv is None else argv
    for stream in filter(None, (sys.stdout, sys.stderr)):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # for names that it cannot encode
    try:
        status = report(parse_flags(argv), argv)
        print(end="", flush=True)  # now: an error at Python's exit could not be handled
        return status
    except MemoryError:
        return fail("not enough memory; allowed: fewer --steps or --bodies")
    except OSError as error:  # nobody reads on, or the disk is full: Python's own flush would fail
        unread = isinstance(error, BrokenPipeError)
        os._exit(141 if unread else fail(f"cannot print the rest: {error.strerror}"))


if __name__ == "__main__":
    sys.modules["contact"] = sys.modules[__name__]  # what the folder's "import contact" gets
    sys.exit(main())
