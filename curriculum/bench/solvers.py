"""Twenty contact solves a step, spent in many ways: the known solvers as rows of one table.

All take the same step: look, aim, accelerate, solve, move, mend. They differ in the numbers of a
row (Solver), and stand on contact.py's own Ball, Contact and solve_contacts. `exact` judges them.
With steps of 1/64 s each may solve every contact twenty times a step; `direct` solves to the end.

The section "solvers" of the results, as the chapter quotes it ({{bench:solvers.ROW.PROBLEM.KEY}}):

    ROW       lcp warm ahead jacobi split pgs_ngs tgs_ngs tgs_soft_30 tgs_soft xpbd small_steps
              small_steps_warm direct
    PROBLEM   stack_3 stack_10 stack_30 heavy_10 heavy_100 heavy_1000 slide pile_8; heavy_M is a
              ball of M kg on one of 1 kg
    KEY       error    worst distance from where exact has a ball, of heights [r]
              deepest  the deepest overlap [r]
              rest     the overlap under the lowest ball at the end [r]; null where balls have not
                       come to rest: one is faster than a step of gravity, and in slide and pile_8
              law      what the law of unfinished sweeps gives for `rest`; null where it is silent
              energy   what the run gained over its start, in start energies
              solves   of a contact in a step, on average

and {{bench:solvers.ROW.words}}, the row in words.
"""

import math
from functools import partial
from typing import NamedTuple

import numpy as np

import contact
from contact import FLOOR, GRAVITY, accelerate, move, remember
from curriculum import parallel
from curriculum.bench import problems

DT = 1.0 / 64.0  # s


class Solver(NamedTuple):
    """How a step spends its solves. Stiffness in hertz: at most a quarter of the substep's rate."""

    words: str
    substeps: int = 1
    sweeps: int = 20  # towards the aim, before the balls move
    gain: float = 0.2  # the share of an overlap that the aim takes out in a substep
    warm: float = 0.0  # the share of the last impulses that a substep begins with
    ahead: bool = True  # look as far as a step travels, and let a gap close wholly
    hertz: float = 0.0  # of a soft aim, damping ratio 10, in place of the gain
    relax: int = 0  # sweeps after the move that aim at no speed: the next warm start is lower
    split: int = 0  # sweeps for velocities that open overlaps, move the balls, and are forgotten
    positions: int = 0  # sweeps after the move that push the balls themselves
    how: str = "sweep"  # or jacobi, direct


SOLVERS = {
    "lcp": Solver("lcp as it is", ahead=False),
    "warm": Solver("lcp, warm", warm=1.0, ahead=False),
    "ahead": Solver("lcp, looking ahead, gain 1", gain=1.0),
    "jacobi": Solver("Jacobi", how="jacobi"),
    "split": Solver("split impulse (Bullet)", sweeps=10, gain=0.0, warm=0.85, split=10),
    "pgs_ngs": Solver("PGS-NGS (Box2D 2)", sweeps=10, gain=0.0, warm=1.0, positions=10),
    "tgs_ngs": Solver("TGS-NGS", 10, 1, gain=0.0, warm=1.0, positions=1),
    "tgs_soft_30": Solver("TGS-soft, 30 Hz (Box2D 3)", 10, 1, warm=1.0, hertz=30.0, relax=1),
    "tgs_soft": Solver("TGS-soft, stiffest", 10, 1, warm=1.0, hertz=math.inf, relax=1),
    "xpbd": Solver("XPBD", 20, 1, gain=1.0),
    "small_steps": Solver("small steps, gain 0.2", 20, 1),
    "small_steps_warm": Solver("small steps, gain 0.2, warm", 20, 1, warm=1.0),
    "direct": Solver("solved directly", how="direct"),
}


def step(balls, dt, s, count):
    """One step [s] of solver s. count[0] grows by every solve of a contact."""
    contacts, h = look(balls, dt, s.ahead), dt / s.substeps
    for c in contacts:
        c.lam = c.a.pushed.get(c.b, 0.0)
    for _ in range(s.substeps):
        contacts = list(map(renewed, contacts))
        for c in contacts:
            aim(c, h, s)
        accelerate(balls, h)
        for c in contacts:
            c.lam *= s.warm
            c.push(c.lam)
        HOW[s.how](contacts, s.sweeps, count)
        if s.split:
            open_overlaps(balls, contacts, h, s.split, count)
        move(balls, h)
        if s.relax:
            contacts = list(map(renewed, contacts))
            for c in contacts:
                aim(c, h, Solver("", gain=0.0))
            sweep(contacts, s.relax, count)
        for _ in range(s.positions):
            push_positions(contacts, count)
    remember(balls, contacts)


def look(balls, dt, ahead):
    """The contacts of a step: within the margin, or as far as the balls travel in it."""
    reach = contact.step_reach(balls, dt) if ahead else contact.CONTACT_MARGIN
    return contact.detect_contacts(balls, reach)


def renewed(c):
    """Contact c where its balls are now, with the impulse it has."""
    balls = (c.a,) if c.b is FLOOR else (c.a, c.b)
    new = contact.detect_contacts(balls, math.inf)[-1]  # after those with the floor
    new.lam = c.lam
    return new


def aim(c, h, s):
    """What contact c wants of a substep [s]: its target, and its softness."""
    c.target = contact.contact_target(c, 0.0, s.gain, h, s.ahead)
    if s.hertz and c.depth > 0.0:  # twice as stiff against what does not move, as Box2D has it
        held = c.a.inv_mass == 0.0 or c.b.inv_mass == 0.0
        omega = 2.0 * math.pi * min(s.hertz, 0.25 / h) * (1.0 + held)
        damping = 20.0 + h * omega
        c.target = omega / damping * c.depth
        c.softness = c.inv_mass / (h * omega * damping)
        c.m_eff = 1.0 / (c.inv_mass + c.softness)


def sweep(contacts, sweeps, count):
    for _ in range(sweeps):
        count[0] += len(contacts)
        contact.solve_contacts(contacts, 1)


def jacobi(contacts, sweeps, count):
    """All contacts see the same velocities, and each takes its share of the balls' masses."""
    touches = {}
    for c in contacts:
        for ball in (c.a, c.b):
            touches[ball] = touches.get(ball, 0) + (ball.inv_mass > 0.0)
    for _ in range(sweeps):
        count[0] += len(contacts)
        missing = [c.target - c.v_n() - c.softness * c.lam for c in contacts]
        for c, speed in zip(contacts, missing):
            change = max(-c.lam, speed * c.m_eff / max(1, touches[c.a], touches[c.b]))
            c.push(change)
            c.lam += change


def direct(contacts, sweeps, count):
    """Guess which contacts push, solve for these, correct the guess; one by one if it cycles."""
    if not contacts:
        return
    A, b = system(contacts)
    on, fewest, patience = np.ones(len(b), bool), len(b) + 1, 10
    for _ in range(50 * len(b)):
        count[0] += len(contacts)
        lam = np.zeros(len(b))
        lam[on] = np.linalg.lstsq(A[np.ix_(on, on)], b[on], rcond=1e-13)[0]
        wrong = np.where(on, lam, A @ lam - b) < -1e-13 * np.abs(b).max()
        if not wrong.any():
            break
        patience = 10 if wrong.sum() < fewest else patience - 1
        fewest = min(fewest, wrong.sum())
        on ^= wrong if patience > 0 else np.arange(len(b)) == np.flatnonzero(wrong)[-1]
    for c, value in zip(contacts, np.maximum(lam, 0.0).tolist()):
        c.push(value - c.lam)
        c.lam = value


def system(contacts):
    """A, b of w = A lam - b: what impulses do to the normal velocities beyond their targets."""
    balls = list({ball for c in contacts for ball in (c.a, c.b)})
    J = np.zeros((len(contacts), len(balls), 2))
    for row, c in zip(J, contacts):
        row[balls.index(c.a)] += c.nx, c.ny
        row[balls.index(c.b)] -= c.nx, c.ny
    J = J.reshape(len(contacts), -1)
    inverse = np.repeat([ball.inv_mass for ball in balls], 2)
    A = J * inverse @ J.T + np.diag([c.softness for c in contacts])
    lam = np.array([c.lam for c in contacts])
    return A, A @ lam + [c.target - c.v_n() - c.softness * c.lam for c in contacts]


HOW = {"sweep": sweep, "jacobi": jacobi, "direct": direct}


def open_overlaps(balls, contacts, h, sweeps, count):
    """Move the balls by velocities that open overlaps by a share, and that nobody keeps."""
    kept = [(ball.vx, ball.vy) for ball in balls]
    for ball in balls:
        ball.vx = ball.vy = 0.0
    pushing = [renewed(c) for c in contacts if c.depth > 0.0]
    for c in pushing:
        c.lam, c.target = 0.0, 0.2 * c.depth / h
    sweep(pushing, sweeps, count)
    move(balls, h)
    for ball, (vx, vy) in zip(balls, kept):
        ball.vx, ball.vy = vx, vy


def push_positions(contacts, count):
    """One sweep over the balls' places: a share of every overlap is taken out at once."""
    for c in map(renewed, contacts):
        count[0] += 1
        if c.depth > 0.0:
            push = 0.2 * c.depth * c.m_eff
            for ball, share in ((c.a, push * c.a.inv_mass), (c.b, -push * c.b.inv_mass)):
                ball.x += share * c.nx  # 0 for the floor
                ball.y += share * c.ny


# what is measured


def column(*mass):
    """Balls of these masses over one another, from the floor up."""
    scene = contact.build_scene("stack", 0, len(mass))
    return scene._replace(mass=np.array(mass, float))


PROBLEMS = {  # title, seconds, scene
    **{f"stack_{n}": (f"stack of {n}", 3.0, partial(column, *[1.0] * n)) for n in (3, 10, 30)},
    **{f"heavy_{m}": (f"{m} : 1", 3.0, partial(column, 1.0, m)) for m in (10, 100, 1000)},
    "slide": ("slide", 0.6, partial(problems.slide_scene, 2)),
    "pile_8": ("pile of 8", 1.0, partial(contact.build_scene, "pile", 0, 8)),
}


def measure(quick=False):
    """{row: {words, problem: judged}}, see above."""
    names = list(PROBLEMS)[: 1 if quick else None]
    jobs = [(row, name) for name in reversed(names) for row in SOLVERS]
    found = {row: {"words": s.words} for row, s in SOLVERS.items()}
    for (row, name), about in zip(jobs, parallel.run_jobs(judged, jobs, "solvers")):
        found[row][name] = about
    return found


def judged(job):
    """What a solver makes of a problem; see KEY above."""
    row, name = job
    _, seconds, build = PROBLEMS[name]
    scene, s, steps, solves, listed = build(), SOLVERS[row], round(seconds / DT), [0], [0]

    def counted(balls):
        listed[0] += len(look(balls, DT, s.ahead))
        step(balls, DT, s, solves)

    run = contact.simulate(counted, scene, DT, steps)
    truth = contact.run_model("exact", scene, DT, steps)
    total, r = contact.energy(run.q, run.v, scene.mass), contact.RADIUS
    towers = name.startswith(("stack", "heavy"))
    rests = towers and np.abs(run.v[-32:]).max() < -DT * GRAVITY
    return dict(
        error=float(np.abs(run.q[:, 1] - truth.q[:, 1]).max() / r),
        deepest=float(max(0.0, -contact.smallest_gap(run.q, scene.radius).min()) / r),
        rest=float(max(0.0, r - run.q[-1, 1, 0]) / r) if rests else None,
        law=sag(s, scene.mass) if towers else None,
        energy=float((total - total[0]).max() / total[0]),
        solves=solves[0] / max(1, listed[0]),
    )


def sag(s, mass, dt=DT):
    """The overlap [r] under the lowest ball that unfinished sweeps leave, by the law of the sag.

    (1 - warm) / (gain K) (mass on top / its own mass) g h^2, with K sweeps in each substep of h.
    None for a solver that does more than sweep towards a gain.
    """
    if s.how != "sweep" or s.hertz or s.split or s.positions or s.warm > 0.5:
        return None
    h = dt / s.substeps
    return float(-GRAVITY * h * h / (s.gain * s.sweeps) * mass[1:].sum() / mass[0] / contact.RADIUS)
