"""Contact between bodies, built four times and measured honestly (robotics course, chapter 3.5).

A table pushes a ball up while they touch, and it never pulls it down. Four models of that push:
    penalty   a stiff spring and a damper: one more force under an unchanged integrator
    lcp       impulses that solve a complementarity problem, by projected Gauss-Seidel sweeps
    soft      MuJoCo's contact: lcp's sweeps, but each contact aims like a spring and gives way
    exact     event to event, every impact at its own time (curriculum/exact.py)
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
    target    the least v_n to leave a step with   m/s     > 0 separating
    m_eff     effective mass, what a push moves    kg      1 / (1 / m_a + 1 / m_b)
    k, c      stiffness and damping of penalty     N/m, N s/m
    e         restitution: share of the speed that a bounce gives back, 0 to 1
    beta      Baumgarte gain: share of an overlap that a step of lcp removes, 0 to 1
    d         impedance of soft: 0 gives way, 1 is hard

Run it:
    python contact.py --contact exact               # what should happen; then make your bets
    python contact.py --scene drop                  # all models; then: bounce, stack, pile
    python contact.py --contact penalty --dt 0.03   # one model, a longer step
    python contact.py --smoke --no-rerun            # fixed length, the same bytes every time
"""

# --- region: setup ---
import itertools
import math
import sys
from typing import NamedTuple

import numpy as np

GRAVITY = -9.81         # m/s^2, along y
RADIUS = 0.1            # m, of every ball in the scenes; lengths are reported in units of it
CONTACT_MARGIN = 1e-3   # m: lcp treats a smaller gap as contact, so a resting ball stays listed
FEW = 12                # balls: up to so many, looking at every pair is the fastest way
EXPLODED = 10.0         # a run that gains more than this many times its start energy has exploded
SOLREF = (0.02, 1.0)    # of soft, MuJoCo's default: time constant [s], damping ratio
SOLIMP = (0.9, 0.95, 0.001, 0.5, 2.0)   # of soft, MuJoCo's default: see impedance
HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)    # of soft, the hardest contact that MuJoCo allows
MOST_SWEEPS = 10_000    # soft stops here in one step, if its impulses have not settled
LAST_BITS = 2.0**-48    # of soft: a correction below this share of the speeds is rounding
SCENES = ("drop", "bounce", "stack", "pile")
MODELS = ("penalty", "lcp", "soft", "exact")
# --- endregion ---


# --- region: scenes ---
class Scene(NamedTuple):
    """Balls over the floor: q0, v0 (2, N) [m, m/s]; mass [kg] and radius [m], both (N,)."""

    name: str
    q0: np.ndarray
    v0: np.ndarray
    mass: np.ndarray        # nothing changes the velocity of a ball of infinite mass
    radius: np.ndarray
    restitution: float      # e, of lcp, soft and exact; penalty has no such knob
    damping: float          # c of penalty [N s/m]


def build_scene(name: str, seed: int = 0, bodies: int | None = None,
                restitution: float | None = None, damping: float | None = None) -> Scene:
    """The scene of that name, all balls at rest. None stands for the scene's own value.

    The seed draws one height, uniform in +-0.02 m. It shifts the start of drop and bounce. It only
    lifts stack and pile, so that they never start inside the floor. In a pile it also numbers and
    nudges the balls. Raises ValueError for an unknown name.
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
    own_restitution, own_damping = (0.7, 0.0) if name == "bounce" else (0.0, 80.0)
    return Scene(name, np.array((x, y)), np.zeros((2, len(x))), np.ones(len(x)),
                 np.full(len(x), RADIUS),
                 own_restitution if restitution is None else restitution,
                 own_damping if damping is None else damping)
# --- endregion ---


# --- region: lattice ---
def pile_lattice(count, lift, rng):
    """x and y (count,) [m] on a lattice of pitch 2.5 r, each nudged by up to 0.1 r, all gaps open.

    The balls are numbered at random, so that the order of the contacts has no pattern.
    """
    place = rng.permutation(count)
    width = math.ceil(math.sqrt(2 * count))
    nudge = rng.uniform(-0.1 * RADIUS, 0.1 * RADIUS, (2, count))
    x = 2.5 * RADIUS * (place % width - 0.5 * (width - 1)) + nudge[0]
    y = 2.5 * RADIUS * (place // width + 0.5) + lift + nudge[1]
    return x, y
# --- endregion ---


# --- region: ball ---
class Ball:
    """A ball: position [m], velocity [m/s], mass [kg], radius [m], and the force on it [N]."""

    def __init__(self, x, y, vx, vy, mass, radius):
        self.x, self.y = x, y
        self.vx, self.vy = vx, vy
        self.fx, self.fy = 0.0, 0.0
        self.mass = mass
        self.inv_mass = 1.0 / mass      # 0 for infinite mass: nothing moves that ball
        self.radius = radius


FLOOR = Ball(0.0, 0.0, 0.0, 0.0, math.inf, 0.0)


class Contact:
    """Balls a and b, how deep they overlap [m], and the unit normal (nx, ny) from b to a."""

    def __init__(self, a, b, nx, ny, depth):
        self.a, self.b = a, b
        self.nx, self.ny = nx, ny
        self.depth = depth
        self.ax, self.ay = a.inv_mass * nx, a.inv_mass * ny     # what 1 N s adds to a's velocity
        self.bx, self.by = b.inv_mass * nx, b.inv_mass * ny     # and takes from b's
        inv_mass = a.inv_mass + b.inv_mass
        self.m_eff = 1.0 / inv_mass if inv_mass > 0.0 else 0.0      # effective mass [kg]
        self.target = 0.0       # the v_n [m/s] to leave with at least; of soft, v_n + R lam
        self.softness = 0.0     # R [1/kg] of soft; 0 is hard
        self.lam = 0.0          # the impulse [N s] so far; a new step starts again from 0

    def v_n(self):
        """Normal velocity [m/s], positive when the balls separate."""
        return self.nx * (self.a.vx - self.b.vx) + self.ny * (self.a.vy - self.b.vy)

    def push(self, impulse):
        """Give ball a this impulse [N s] along the normal, and ball b the opposite one."""
        a, b = self.a, self.b
        a.vx += impulse * self.ax
        a.vy += impulse * self.ay
        if b is not FLOOR:      # all contacts share the floor, and it never moves
            b.vx -= impulse * self.bx
            b.vy -= impulse * self.by
# --- endregion ---


# --- region: contacts ---
def detect_contacts(balls, margin: float = CONTACT_MARGIN) -> list[Contact]:
    """The contacts of balls with the floor and with each other whose gap is below `margin` [m].

    The floor's contacts come first, by ball, then those of pairs, by the first ball and then the
    second: a solver takes them in this order, so the order is part of the result. Two balls with
    the same centre get the normal (0, 1), since some direction must be chosen. For another floor
    or a wall, add its contacts here and its gap to smallest_gap, where a flight looks for it.
    """
    contacts = []
    for ball in balls:
        depth = ball.radius - ball.y
        if depth > -margin:
            contacts.append(Contact(ball, FLOOR, 0.0, 1.0, depth))
    for a, b in possible_pairs(balls, margin):
        dx = a.x - b.x
        dy = a.y - b.y
        distance = math.sqrt(dx * dx + dy * dy)
        depth = a.radius + b.radius - distance
        if depth > -margin:
            nx, ny = (dx / distance, dy / distance) if distance > 0.0 else (0.0, 1.0)
            contacts.append(Contact(a, b, nx, ny, depth))
    return contacts
# --- endregion ---


# --- region: pairs ---
def possible_pairs(balls, margin):
    """The pairs of balls that are worth a look, in order: all of them while the balls are few.

    Of many balls only those pairs are looked at whose shadows on the x axis come within `margin`
    [m] of each other. The others cannot touch, so the list of contacts stays the same.
    """
    if len(balls) <= FEW:
        return itertools.combinations(balls, 2)
    known = [i for i, ball in enumerate(balls) if math.isfinite(ball.x)]
    known.sort(key=lambda i: balls[i].x)
    reach = 1.000001 * (2.0 * max(ball.radius for ball in balls) + margin)  # room for rounding
    pairs = []
    for place, i in enumerate(known):
        for j in itertools.islice(known, place + 1, None):
            if balls[j].x - balls[i].x > reach:
                break
            if not abs(balls[j].y - balls[i].y) > reach:
                pairs.append((min(i, j), max(i, j)))
    return [(balls[i], balls[j]) for i, j in sorted(pairs)]
# --- endregion ---


# --- region: penalty ---
def penalty_normal_force(depth, v_n, stiffness, damping):
    """f_n [N] of a spring and a damper at `depth` > 0 [m]. The clamp makes it one-sided."""
    return max(0.0, stiffness * depth - damping * v_n)


def penalty_force(contacts, stiffness, damping):
    """Add the force of a spring and a damper to the two balls of every contact."""
    for c in contacts:
        f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)
        c.a.fx += f_n * c.nx
        c.a.fy += f_n * c.ny
        c.b.fx -= f_n * c.nx        # equal and opposite
        c.b.fy -= f_n * c.ny


def penalty_step(balls, dt, stiffness, damping):
    """One step [s] in which contact is one more force, and the integrator stays what it was."""
    for ball in balls:
        ball.fx = ball.fy = 0.0     # not the floor's: nobody reads what it adds up
    penalty_force(detect_contacts(balls, margin=0.0), stiffness, damping)
    semi_implicit_step(balls, dt)
# --- endregion ---


# --- region: integrator ---
def semi_implicit_step(balls, dt):
    """Semi-implicit Euler under gravity and the forces: the new velocity first, then x and y."""
    for ball in balls:
        if ball.inv_mass > 0.0:
            ball.vx += dt * (ball.fx / ball.mass)
            ball.vy += dt * (GRAVITY + ball.fy / ball.mass)
    move(balls, dt)


def fall(balls, dt):
    """Give every ball that can move the velocity that gravity adds in one step."""
    for ball in balls:
        if ball.inv_mass > 0.0:
            ball.vy += dt * GRAVITY


def move(balls, dt):
    """Move every ball with its velocity for one step."""
    for ball in balls:
        ball.x += dt * ball.vx
        ball.y += dt * ball.vy
# --- endregion ---


# --- region: critical-dt ---
def critical_dt(mass: float, stiffness: float, damping: float) -> float:
    """The largest stable step [s] of penalty for a ball kept in contact; inf without a spring.

    In contact a step is a 2 x 2 matrix. Its eigenvalues stay within 1 (Jury's test) while
    k dt^2 + 2 c dt < 4 m. Without a damper that is the textbook's dt < 2 sqrt(m / k).
    """
    root = math.sqrt(damping * damping + 4.0 * mass * stiffness)
    return 4.0 * mass / (root + damping) if root + damping > 0.0 else math.inf
# --- endregion ---


# --- region: lcp-target ---
def contact_target(c, restitution, baumgarte, dt):
    """The least normal velocity [m/s] with which contact c may leave the step.

    Call it before gravity acts. With e = 0 it is the bias velocity (Baumgarte 1972): an overlap
    opens by the share beta in a step, and a gap may close by that share. With e > 0 bodies that
    touch, or would meet within this step, get the bounce -e v_n. Across a wider gap they may
    come as close as touching, so that nothing bounces on air. In an overlap the larger of bias
    and bounce counts, since their sum would bounce too high. Where the bias does not win, no
    target is above -e v_n, also between bodies that part, so impulses add no energy (Moreau 1988).
    """
    bias = baumgarte / dt * c.depth     # < 0 across a gap
    if restitution == 0.0:
        return bias
    v_n = c.v_n()
    bounce = -restitution * v_n
    if bias > 0.0:
        return max(bias, bounce)
    meets = dt * v_n <= c.depth         # what the step closes, -dt v_n, is at least the gap
    return bounce if meets else min(bounce, c.depth / dt)
# --- endregion ---


# --- region: lcp-sweep ---
def project_impulse(lam, dlam):
    """The impulse after a correction: the sum may not become negative, a correction may."""
    total = lam + dlam
    return total if total > 0.0 else 0.0        # max(0, total), at half the time


def solve_contacts(contacts, iters: int, tolerance: float = 0.0) -> None:
    """Find impulses with lam >= 0, w >= 0 and lam w = 0, where w = v_n + softness lam - target.

    Projected Gauss-Seidel: each sweep mends one contact after the other, by the impulse that
    brings it to its target, and disturbs its neighbours; the next sweep mends those. Changes lam
    of the contacts and the velocities of their balls. Stops after a sweep in which no correction
    changed a velocity by more than `tolerance` [m/s]. After a sweep without any change, every
    further sweep would repeat it. In velocities and impulses: Moreau (1988); Stewart and Trinkle
    (1996); Anitescu and Potra (1997).
    """
    for _ in range(iters):
        settled = True
        for c in contacts:
            missing = c.target - c.v_n() - c.softness * c.lam
            lam = project_impulse(c.lam, missing * c.m_eff)
            if lam != c.lam:
                change = lam - c.lam
                c.push(change)
                c.lam = lam
                settled = settled and abs(change) <= tolerance * c.m_eff    # NaN never settles
        if settled:
            break
# --- endregion ---


# --- region: lcp ---
def lcp_step(balls, dt, restitution, baumgarte, iters):
    """One step [s]: gravity predicts the velocities, impulses correct them, the balls move."""
    contacts = detect_contacts(balls)
    for c in contacts:
        c.target = contact_target(c, restitution, baumgarte, dt)
    fall(balls, dt)
    solve_contacts(contacts, iters)
    move(balls, dt)
# --- endregion ---


# --- region: soft-impedance ---
def impedance(depth, solimp):
    """How hard the contact is at that depth [m]: d between 0 and 1 (MuJoCo's getimpedance).

    It grows from d0 at the surface to d1 at the depth `width` [m], along an S made of two powers
    that meet at the share `mid` of the width.
    """
    d0, d1, width, mid, power = solimp
    if width <= 1e-15:                                  # m; MuJoCo takes the mean then
        return 0.5 * (d0 + d1)
    if depth >= width:
        return d1
    share = depth / width
    if share <= mid:
        rise = raised(share, power) / raised(mid, power - 1.0)
    else:
        rise = 1.0 - raised(1.0 - share, power) / raised(1.0 - mid, power - 1.0)
    return d0 + rise * (d1 - d0)


def raised(x, power):
    """x to that power; a whole power by products, whose bits are the same in every language."""
    if power != int(power):
        return x**power
    product = 1.0
    for _ in range(int(power)):
        product *= x
    return product


def soft_defaults(restitution, dt, solref=None, solimp=None):
    """The solref and solimp that a run uses, within MuJoCo's bounds. None stands for the default.

    Restitution needs the direct form of solref, minus stiffness and minus damping, and a hard
    contact: the damping (1 + e) / dt turns v_n into -e v_n within one step.
    """
    if solref is None and restitution > 0.0:
        solref, solimp = (0.0, -(1.0 + restitution) / dt), solimp or HARD
    elif solref is None or solref[0] > 0.0:
        timeconst, dampratio = solref or SOLREF
        solref = max(timeconst, 2.0 * dt), dampratio    # MuJoCo's refsafe: no faster than two steps
    d0, d1, width, mid, power = solimp or SOLIMP
    d0, d1, mid = (min(max(share, 0.0001), 0.9999) for share in (d0, d1, mid))
    return solref, (d0, d1, width, mid, power)
# --- endregion ---


# --- region: soft ---
def soften(c, dt, solref, solimp):
    """Give contact c the target and the softness that MuJoCo's contact has.

    A spring K [1/s^2] and a damper B [1/s] ask for the acceleration a_ref = K d depth - B v_n
    (mj_makeImpedance, mj_referenceConstraint). They act per unit of mass, so any ball follows
    them alike. The softness R [1/kg] lets the contact give way: the harder, the less.
    """
    d = impedance(c.depth, solimp)
    d1 = solimp[1]
    if solref[0] > 0.0:                                 # time constant [s] and damping ratio
        timeconst, dampratio = solref
        K = 1.0 / (d1 * d1 * timeconst * timeconst * dampratio * dampratio)
        B = 2.0 / (d1 * timeconst)
    else:                                               # direct: minus stiffness, minus damping
        K = -solref[0] / (d1 * d1)
        B = -solref[1] / d1
    v_n = c.v_n()                                       # before gravity acts
    inv_mass = c.a.inv_mass + c.b.inv_mass
    c.target = v_n + dt * (K * d * c.depth - B * v_n)
    c.softness = max(1e-15, (1.0 - d) / d * inv_mass)
    c.m_eff = 1.0 / (inv_mass + c.softness)


def soft_step(balls, dt, solref, solimp):
    """One step [s] of MuJoCo's contact: lcp's step with another target, and softness.

    The softness makes the problem strictly convex: it has one answer. So the sweeps go on until
    their corrections drown in the rounding of the velocities, which takes the longer, the harder
    the contacts are.
    """
    contacts = detect_contacts(balls, margin=0.0)
    for c in contacts:
        soften(c, dt, solref, solimp)
    fall(balls, dt)
    fastest = max([abs(c.target) for c in contacts], default=0.0)
    for ball in balls:
        fastest = max(fastest, abs(ball.vx), abs(ball.vy))
    solve_contacts(contacts, MOST_SWEEPS, LAST_BITS * fastest)
    move(balls, dt)
# --- endregion ---


# --- region: state ---
class Run(NamedTuple):
    """A recording: t (steps + 1,) [s]; q and v (steps + 1, 2, N) [m, m/s]."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray


def make_balls(scene):
    """The scene's balls, as the steps move them."""
    check_shapes(scene)
    columns = (*scene.q0, *scene.v0, scene.mass, scene.radius)
    return [Ball(*values) for values in np.transpose(columns).tolist()]


def state_of(balls):
    """A flat list: x, y, vx, vy of one ball after the other."""
    return [value for ball in balls for value in (ball.x, ball.y, ball.vx, ball.vy)]


def set_state(balls, state):
    """Put the balls where such a state, as an array, says."""
    for ball, values in zip(balls, state.reshape(-1, 4).tolist()):
        ball.x, ball.y, ball.vx, ball.vy = values
# --- endregion ---


# --- region: simulate ---
@np.errstate(all="ignore")
def simulate(step, scene: Scene, dt: float, steps: int, skip: bool = True,
             report=lambda k: None) -> Run:
    """Take that many steps, `step(balls)` each, and record every state.

    With `skip` two kinds of steps are not taken, and no bit changes. A flight without contact is
    summed up in one go. And when a state comes back (rest, or any cycle), the rest of the run is
    a copy, since a step depends on the state alone. `report(k)` is called with the steps done.
    """
    balls = make_balls(scene)
    rows = np.empty((steps + 1, 4 * len(balls)))
    rows[0] = state_of(balls)
    seen = {}                                           # hash of a state: the step it came at
    k = 0
    while k < steps:
        if skip:
            first = seen.setdefault(hash(rows[k].tobytes()), k)
            if first < k and rows[first].tobytes() == rows[k].tobytes():
                period = k - first
                for past in range(first, k):            # these states come again and again
                    rows[past + period::period] = rows[past]
                break
            flight = fly(balls, dt, steps - k)
            if len(flight) > 0:
                rows[k + 1:k + 1 + len(flight)] = flight
                k += len(flight)
                set_state(balls, rows[k])
                continue
        step(balls)
        k += 1
        rows[k] = state_of(balls)
        report(k)
    rows += 0.0                                         # turns -0.0 into 0.0
    rows[np.isnan(rows)] = math.nan                     # which has a sign too, left to chance
    rows = rows.reshape(steps + 1, len(balls), 4).transpose(0, 2, 1).copy()
    return Run(np.arange(steps + 1) * dt, rows[:, :2], rows[:, 2:])
# --- endregion ---


# --- region: flight ---
def fly(balls, dt, most):
    """The next states (n, 4 N), n <= most, of balls that touch nothing.

    Short flights are left to the steps, and n is 0. np.add.accumulate adds in the same order as
    the steps do, so the bits agree.
    """
    count = most
    for ball in balls:
        count = min(count, steps_to_floor(ball, dt))
        if count < 16:
            return ()
    if detect_contacts(balls):
        return ()
    rows = np.empty((int(count) + 1, 4 * len(balls)))
    rows[0] = state_of(balls)
    states = rows.reshape(len(rows), len(balls), 4)     # a view: what it gets, rows has
    q, v = states[:, :, :2], states[:, :, 2:]
    v[1:, :, 0] = 0.0
    v[1:, :, 1] = [dt * GRAVITY if ball.inv_mass > 0.0 else 0.0 for ball in balls]
    np.add.accumulate(v, out=v)                         # v, v + dt g, v + dt g + dt g, ...
    q[1:] = dt * v[1:]
    np.add.accumulate(q, out=q)
    gap = smallest_gap(q.transpose(0, 2, 1), np.array([ball.radius for ball in balls]))
    contact = np.flatnonzero(gap < CONTACT_MARGIN)
    return rows[1:contact[0] + 1] if len(contact) > 0 else rows[1:]


def steps_to_floor(ball, dt):
    """About how many steps the ball falls freely until it is within the margin of the floor."""
    gap = ball.y - ball.radius - CONTACT_MARGIN
    if not gap > 0.0:
        return 0
    if ball.inv_mass == 0.0:
        return math.inf
    return (ball.vy + math.sqrt(ball.vy * ball.vy - 2.0 * GRAVITY * gap)) / -GRAVITY / dt
# --- endregion ---


# --- region: shapes ---
def check_shapes(scene, *runs):
    """Raise ValueError, in one line, where the arrays of a scene and its runs do not fit."""
    count = np.size(scene.mass)
    if count == 0:
        raise ValueError("the scene has no ball; allowed: one or more")
    checked = [("q0", scene.q0, (2, count)), ("v0", scene.v0, (2, count)),
               ("mass", scene.mass, (count,)), ("radius", scene.radius, (count,))]
    for run in runs:
        shape = (np.size(runs[0].t), 2, count)
        checked += [("q of a run", run.q, shape), ("v of a run", run.v, shape)]
    for name, array, allowed in checked:
        if np.shape(array) != allowed:
            raise ValueError(f"{name}: given an array of shape {np.shape(array)}; allowed for "
                             f"{count} balls: {allowed}")
# --- endregion ---


# --- region: run ---
def compiled_piles():
    """curriculum/piles.py, the compiled steps for many balls; None where it or numba is missing."""
    try:
        from curriculum import piles
    except ImportError:
        return None
    return piles


def run_model(model: str, scene: Scene, dt: float, steps: int, stiffness: float = 1e4,
              baumgarte: float = 0.2, iters: int = 20, skip: bool = True,
              report=lambda k: None, solref=None, solimp=None) -> Run:
    """The run of a scene by one of MODELS. Raises ValueError for any other name.

    Many balls are stepped by curriculum/piles.py where it can be had, to the same bits.
    """
    if model not in MODELS:
        raise ValueError(f"model {model!r}; allowed: {', '.join(MODELS)}")
    check_shapes(scene)
    if model == "exact":
        from curriculum import exact
        with np.errstate(over="ignore"):
            times = np.arange(steps + 1) * dt
        return Run(times, *exact.simulate_exact(scene, times, GRAVITY, report))
    e = scene.restitution
    solref, solimp = soft_defaults(e, dt, solref, solimp)
    if skip and len(scene.mass) > FEW and (piles := compiled_piles()):
        return Run(np.arange(steps + 1) * dt, *piles.simulate(
            model, scene, dt, steps, report, gravity=GRAVITY, margin=CONTACT_MARGIN,
            stiffness=stiffness, baumgarte=baumgarte, iters=iters, most_sweeps=MOST_SWEEPS,
            last_bits=LAST_BITS, solref=solref, solimp=solimp))
    steps_by = {
        "penalty": lambda balls: penalty_step(balls, dt, stiffness, scene.damping),
        "lcp": lambda balls: lcp_step(balls, dt, e, baumgarte, iters),
        "soft": lambda balls: soft_step(balls, dt, solref, solimp)}
    return simulate(steps_by[model], scene, dt, steps, skip, report)
# --- endregion ---


# --- region: measure ---
@np.errstate(all="ignore")
def energy(q, v, mass):
    """Kinetic plus potential energy [J] of states (..., 2, N), zero at the floor.

    Balls of infinite mass are held, so they do not count.
    """
    mass = np.where(np.isfinite(mass), mass, 0.0)
    return (0.5 * mass * (v * v).sum(-2) - mass * GRAVITY * q[..., 1, :]).sum(-1)


@np.errstate(all="ignore")
def smallest_gap(q, radius):
    """The smallest gap [m] to the floor or between two balls, in each state (S, 2, N).

    Ball i is compared with ball i + lag, for all i and all states at once, and for every lag.
    """
    if len(radius) > FEW and (piles := compiled_piles()):
        return piles.smallest_gap(q, radius)
    gap = (q[:, 1] - radius).min(-1)
    for lag in range(1, len(radius)):
        dx = q[:, 0, lag:] - q[:, 0, :-lag]
        dy = q[:, 1, lag:] - q[:, 1, :-lag]
        reach = radius[lag:] + radius[:-lag]
        gap = np.minimum(gap, (np.sqrt(dx * dx + dy * dy) - reach).min(-1))
    return gap


def max_penetration(q, radius):
    """The deepest overlap [m] with the floor or a ball, 0 without one, in states (..., 2, N)."""
    states = q.reshape(-1, *q.shape[-2:])
    return np.maximum(-smallest_gap(states, radius), 0.0).reshape(q.shape[:-2])


def blow_up_step(total):
    """The first step at which the energy [J] has gained EXPLODED times its start, or None.

    An energy that is not a number counts as exploded.
    """
    bad = ~(total - total[0] < EXPLODED * (abs(total[0]) or 1.0))
    return int(bad.argmax()) if bad.any() else None
# --- endregion ---


# --- region: quality ---
@np.errstate(all="ignore")
def contact_quality(run: Run, scene: Scene, dt: float, reference: Run | None = None) -> dict:
    """The error measures of a run: lengths in radii of the first ball, energies in start energies.

    max_penetration_frac, rest_penetration_frac: the deepest overlap, and the one at the end
    rest_gap_frac: the smallest gap at the end; below 0 sunk in, above 0 hanging in the air
    rebound_frac: the largest value of the smallest gap after the first contact
    rest_jitter: standard deviation of the overlap over the last quarter
    energy_excess: the most energy above the start; blew_up, blew_up_step: whether, when it exploded
    contact_energy: the energy that contacts put into the bodies: all its rises, step by step
    height_error_frac: the worst height error against the run `reference`, which is the sum of
    flight_error_frac, the worst before the first contact, and contact_error_frac, what is added
    """
    check_shapes(scene, *[each for each in (run, reference) if each is not None])
    total = energy(run.q, run.v, scene.mass)
    scale = abs(float(total[0])) or 1.0
    radius = float(scene.radius[0])
    gap = smallest_gap(run.q, scene.radius) / radius
    depth = np.maximum(-gap, 0.0)
    landing = first_contact(run, scene, dt)
    step = blow_up_step(total)
    quality = {
        "max_penetration_frac": float(depth.max()),
        "rest_penetration_frac": float(depth[-1]),
        "rest_gap_frac": float(gap[-1]),
        "rebound_frac": float(gap[landing:].max(initial=0.0)),
        "rest_jitter": deviation(depth[3 * len(depth) // 4:]),
        "energy_excess": float((total - total[0]).max()) / scale,
        "contact_energy": float(np.maximum(np.diff(total), 0.0).sum()) / scale,
        "blew_up": step is not None,
        "blew_up_step": step}
    return quality | height_errors(run, scene, dt, reference)
# --- endregion ---


# --- region: quality-parts ---
def deviation(values):
    """The standard deviation; a power of two is taken out, lest squares of large values overflow.

    That changes no other bit.
    """
    power = math.frexp(float(values.max()))[1]
    return float(np.ldexp(np.std(np.ldexp(values, -power)), power))


def first_contact(run, scene, dt):
    """The first step after which surfaces touch, or a velocity shows more than gravity's change."""
    gained = np.zeros((2, len(scene.mass)))             # from gravity, in one step
    gained[1] = dt * GRAVITY * np.isfinite(scene.mass)
    rounding = 1e-9 * (np.abs(run.v[:-1]) + np.abs(gained))
    touched = smallest_gap(run.q, scene.radius) <= 0.0
    touched[1:] |= (np.abs(np.diff(run.v, axis=0) - gained) > rounding).any((1, 2))
    return int(touched.argmax()) if touched.any() else len(touched)


def height_errors(run, scene, dt, reference):
    """The worst height error [radius]; its part before the first contact, and what is added."""
    worst = flight = added = None
    if reference is not None:
        error = np.abs(run.q[:, 1] - reference.q[:, 1]).max(-1) / float(scene.radius[0])
        landing = min(first_contact(run, scene, dt), first_contact(reference, scene, dt))
        worst = float(error.max())
        flight = float(error[:landing].max(initial=0.0))
        added = worst - flight
    return {"height_error_frac": worst, "flight_error_frac": flight, "contact_error_frac": added}
# --- endregion ---


# --- region: stability ---
DT_GRID = (1, 2, 4, 8, 16, 32)      # multiples of --dt that the stability lines try


def measure_stability(run, scene, dt, stiffness, first):
    """The largest step of the grid without an explosion, by model, and the depth reached there.

    0.0 stands for a model that explodes at every step, None for one that never comes to a
    contact, so that nothing was tried. `run(model, dt)` makes a run; `first` holds the runs at dt
    itself, by model. The largest step comes first, and no run is made that cannot be the answer.
    soft is left out: its time constant is never below two steps, so it stays bounded at any step.
    """
    mass = float(scene.mass[0])
    grid = {"dt_crit_penalty": critical_dt(mass, stiffness, 0.0),
            "dt_crit_damped": critical_dt(mass, stiffness, scene.damping)}
    for model in ("penalty", "lcp"):
        grid[model], grid[f"{model}_penetration_frac"] = None, None
        for step in sorted((dt * factor for factor in DT_GRID), reverse=True):
            found = first[model] if step == dt else run(model, step)
            exploded = blow_up_step(energy(found.q, found.v, scene.mass)) is not None
            gap = smallest_gap(found.q, scene.radius)
            if exploded:
                grid[model] = 0.0
            elif (gap < CONTACT_MARGIN).any():
                depth = float(max(-gap.min(), 0.0) / scene.radius[0])
                grid[model], grid[f"{model}_penetration_frac"] = step, depth
                break
    return grid
# --- endregion ---


# --- region: record ---
COLORS = {"penalty": "#d55e00", "lcp": "#0072b2", "soft": "#cc79a7",
          "exact": "#009e73"}       # safe for colour-blind readers (Okabe and Ito)


@np.errstate(all="ignore")
def contact_impulses(run, scene):
    """The impulse [N s] that all contacts of a ball give it in each step, (steps + 1, 2, N).

    It is the change of momentum that gravity does not explain, so it is there for every model.
    """
    gained = np.diff(run.t[:2]).sum() * np.array([[0.0], [GRAVITY]])
    mass = np.where(np.isfinite(scene.mass), scene.mass, 0.0)
    return np.concatenate((np.zeros_like(run.v[:1]), mass * (np.diff(run.v, axis=0) - gained)))


@np.errstate(all="ignore")
def curves(runs, scene):
    """What is plotted of the runs, {title: {model: values (steps + 1,)}}."""
    titles = ("height [m], mean", "penetration [r]", "impulse of floor [N s]",
              "energy above start [J]", "rises of energy [J]")
    made = {title: {} for title in titles}
    for model, run in runs.items():
        total = energy(run.q, run.v, scene.mass)
        values = (run.q[:, 1].mean(-1), max_penetration(run.q, scene.radius) / scene.radius[0],
                  contact_impulses(run, scene)[:, 1].sum(-1), total - total[0],
                  np.maximum(np.diff(total, prepend=total[0]), 0.0).cumsum())
        for title, line in zip(titles, values):
            made[title][model] = line
    return made


def log_rerun(path, runs: dict[str, Run], scene: Scene) -> None:
    """Write the runs {model: Run} to a recording, whole or not at all.

    Raises ImportError where rerun is missing.
    """
    from curriculum.common import recording
    weight = -GRAVITY * scene.mass * np.diff(next(iter(runs.values())).t[:2]).sum()
    pushes = {model: contact_impulses(run, scene) / weight for model, run in runs.items()}
    bursts = {model: blow_up_step(energy(run.q, run.v, scene.mass)) for model, run in runs.items()}
    recording.write(path, "contact", runs, scene.radius, curves(runs, scene), COLORS,
                    pushes, bursts)
# --- endregion ---


# --- region: report ---
def main(argv=None):
    """Run the command line, which stands in curriculum/terminal.py. Returns the exit status."""
    sys.modules.setdefault("contact", sys.modules[__name__])    # run as a script: no second copy
    try:
        from curriculum import terminal
    except ModuleNotFoundError as error:
        print(f"contact.py: the command line needs the course's folder beside it ({error}); "
              "as a module, import contact works without", file=sys.stderr)
        return 2
    return terminal.main(argv)


if __name__ == "__main__":
    sys.exit(main())
# --- endregion ---
