"""Cases far from the defaults; what must happen is written before the run, from closed forms.

Each case is a generator of rows (jobs.row). Lengths in m, masses in kg, times in s; `quick` leaves
out the longest settings. A row of status "limit" misses what one would wish for, names the limit
of the model that is why, and meets what that limit's derivation allows.
"""

import itertools
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from curriculum import exact
from curriculum.bench import closed_form
from curriculum.stress import invariants, jobs, scenes
from curriculum.stress.trial import Trial, U
from curriculum.stress.under_test import ROOT, contact, run_model

CASES = {}
G, R = closed_form.g, contact.RADIUS
POWERS = (-6, -4, -2, -1, 0, 1, 2, 4, 6)
EACH = 8 * U  # what a step's few roundings of a number are at most, as a share of it


def case(function):
    """Register a case under its name."""
    CASES[function.__name__] = function
    return function


def extreme_jobs(quick):
    return [jobs.job("extreme", name, name=name, quick=quick) for name in CASES]


def run(name, quick):
    """Result of one case."""
    with np.errstate(all="ignore"):
        rows = list(CASES[name](quick))
    return {"cells": len(rows), "rows": rows}


def scene(x, y, vx=0.0, vy=0.0, mass=1.0, radius=R, restitution=0.0, damping=0.0):
    """A contact.Scene from rows or numbers; everything is stretched to the length of x or y."""
    n = max(len(np.atleast_1d(row)) for row in (x, y))

    def stretch(value):
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), n))

    return contact.Scene(
        "stress",
        np.array([stretch(x), stretch(y)]),
        np.array([stretch(vx), stretch(vy)]),
        stretch(mass),
        stretch(radius),
        float(restitution),
        float(damping),
    )


def column(mass, radius=R, **options):
    """A tower at rest: every ball touches the one below, the lowest the table."""
    n = max(len(np.atleast_1d(mass)), len(np.atleast_1d(radius)))
    r = np.broadcast_to(np.asarray(radius, dtype=float), n)
    return scene(0.0, np.cumsum(2 * r) - r, mass=mass, radius=r, **options)


def load(mass):
    """Force [N] that each contact of a tower carries: the weight of everything above it."""
    return G * np.cumsum(np.asarray(mass)[::-1])[::-1]


def delassus(mass):
    """W = J M^-1 J^T of a tower's contacts (table and ball 0, balls 0 and 1, ...), tridiagonal."""
    w = 1.0 / np.asarray(mass, dtype=float)
    return np.diag(w + np.append(0.0, w[:-1])) - np.diag(w[:-1], 1) - np.diag(w[:-1], -1)


def sweep_matrix(W):
    """G of one Gauss-Seidel sweep, error -> G error: I - L^-1 W with L the lower triangle of W."""
    return np.eye(len(W)) - np.linalg.solve(np.tril(W), W)


def swept(mass, sweeps, dt=0.01):
    """Impulses [N s] of a tower at rest after so many sweeps of one step."""
    balls = [contact.Ball(0.0, 0.0, 0.0, 0.0, float(m), R) for m in mass]
    below = [contact.FLOOR, *balls]
    contacts = [contact.Contact(ball, b, 0.0, 1.0, 0.0) for ball, b in zip(balls, below)]
    contact.fall(balls, dt)
    contact.solve_contacts(contacts, sweeps)
    return np.array([c.lam for c in contacts])


def quality(run_, scene_, dt):
    return contact.contact_quality(run_, scene_, dt)


def last_bits(height, terms=1):
    """How far [r] rounding moves what rests: EACH of its height for every term of the balance."""
    return EACH * terms * height / R


def added_up(steps, height, speed, seconds):
    """How far [r] a flight of so many steps can get: each rounds the height, and the speed for good."""
    return U * steps * (height + speed * seconds) / R


def ends(run_):
    """Words for how a run ended."""
    return "stays finite" if np.isfinite(run_.q).all() else "not finite"


# --- towers -----------------------------------------------------------------------------------


@case
def mass_ratio_penalty(quick):
    """A ball on another, kept in contact: stable up to the critical dt of the fastest mode.

    Springs and dampers act on the same gaps, so modes decouple: eigenvalues mu of M^-1 A, with A the
    incidence matrix, each a ball of mass 1 / mu on one spring. How late a mode that grows is seen,
    maps.late says; as far below the critical dt it shrinks by as much.
    """
    from curriculum.stress import maps

    for power in POWERS:
        mass = np.array([1.0, 10.0**power])
        A = np.array([[2.0, -1.0], [-1.0, 1.0]])
        half = np.diag(mass**-0.5)
        mu, modes = np.linalg.eigh(half @ A @ half)
        k = 100.0 * load(mass)[0] / R
        c = 0.3 * math.sqrt(k / mu[-1])
        theory = contact.critical_dt(1.0 / mu[-1], k, c)
        depth = load(mass) / k
        rest = column(mass, damping=c)
        rest.q0[1] -= np.cumsum(depth)
        mode = half @ modes[:, -1]
        start = mode / np.abs(mode).max() * 0.005 * min(depth.min(), G * theory**2)
        late, moved = maps.late(c * theory * mu[-1]), []
        for share in (1.0 - late, 1.0 + late):
            off = rest._replace(q0=rest.q0 + [[0.0], [1.0]] * start)
            run_ = run_model("penalty", off, share * theory, maps.WATCHED, stiffness=k)
            moved.append(float(np.abs(run_.q[-200:, 1] - rest.q0[1]).max() / np.abs(start).max()))
        yield jobs.row(
            f"upper / lower mass 1e{power}",
            f"comes to rest {late:.2%} below {theory:.4g} s, and leaves as far above",
            f"{moved[0]:.2g} and {moved[1]:.2g} times its start",
            moved[0] < 1.0 < maps.AMPLIFIED <= moved[1],
        )


@case
def mass_ratio_sweeps(quick):
    """Each sweep of lcp shrinks the error of two stacked balls by M / (M + m), M above.

    Bound: an error is a difference of impulses, each rounded by EACH of itself.
    """
    for power in POWERS:
        mass = np.array([1.0, 10.0**power])
        rate = mass[1] / mass.sum()
        right = load(mass) * 0.01
        error = [abs(float((swept(mass, sweeps) - right)[1])) for sweeps in (1, 2)]
        got = error[1] / error[0] if error[0] else 0.0
        bound = 2 * EACH * float(right[1]) / error[0] if error[0] else math.inf
        yield jobs.row(
            f"upper / lower mass 1e{power}",
            f"error times {rate:.7g} a sweep, within {bound:.1g}",
            f"{got:.7g}",
            abs(got - rate) <= bound,
        )


@case
def mass_ratio_lcp(quick):
    """lcp, 20 sweeps, laid down touching: as deep after 4 s as its linear law says (settled).

    Limit: heavy on light, 20 sweeps leave most of the impulse undone, and the fixed point lies
    deeper than a radius: the lower ball is pressed through the table.
    """
    for power in POWERS:
        mass = np.array([1.0, 10.0**power])
        predicted = float(resting_depth(mass, 20).max()) / R
        tower = column(mass)
        run_ = run_model("lcp", tower, 0.002, 2000)
        expected, bound = settled(mass, 20, 2000)
        found = quality(run_, tower, 0.002)
        got, at = found["rest_penetration_frac"], f"upper / lower mass 1e{power}"
        words = f"{got:.4g} r deep, {ends(run_)}"
        if predicted < 0.05:
            yield jobs.row(
                at,
                f"{expected:.6g} r deep within {bound:.1g}",
                f"{got:.6g} r deep, {ends(run_)}",
                abs(got - expected) <= bound,
            )
        else:
            calm = not found["blew_up"] and bool(np.isfinite(run_.q).all())
            yield jobs.row(
                at,
                "holds to 0.05 r",
                words,
                got < 0.05,
                limit=calm and (f"20 sweeps: the fixed point lies {predicted:.3g} r deep"),
            )


def resting_depth(mass, sweeps, dt=0.002, baumgarte=0.2, order=None):
    """Depth (N,) [m] of a tower at rest under lcp: what the pushes must make up for unfinished sweeps.

    From lam = 0, s sweeps reach (I - G^s) W^-1 b. At rest that is the load times dt, so with
    b = W load dt + (beta / dt) depth:  depth = (dt / beta) W G^s (I - G^s)^-1 load dt.
    order: that of the contacts in a sweep, and in the result, where it is not from the table up.
    """
    order = np.arange(len(mass)) if order is None else order
    W, weights = delassus(mass)[np.ix_(order, order)], load(mass)[order]
    left = np.linalg.matrix_power(sweep_matrix(W), sweeps)
    return dt / baumgarte * W @ left @ np.linalg.solve(np.eye(len(W)) - left, weights * dt)


def settled(mass, sweeps, steps, dt=0.002, baumgarte=0.2, start=0.0, order=None):
    """(depth [r] of a tower after so many steps, how far rounding may be off from it).

    While all contacts push, a step is linear. With the gaps' speeds u, their acceleration a = W
    load by gravity, and b = (beta / dt) depth - u + dt a to make up for, s sweeps give the impulses
    W^-1 (b - H b), H = W G^s W^-1. So u becomes (beta / dt) depth - H b, and depth - dt u follows.
    A step rounds each height, so each gap, by EACH of the tower's height; what later steps make of
    that is at most the sum of the norms of the powers of the step's matrix.
    """
    order = np.arange(len(mass)) if order is None else order
    W, weights = delassus(mass)[np.ix_(order, order)], load(mass)[order]
    n, push, one = len(W), baumgarte / dt, np.eye(len(W))
    H = W @ np.linalg.matrix_power(sweep_matrix(W), sweeps) @ np.linalg.inv(W)
    to_u = np.hstack((push * (one - H), H))
    step = np.vstack((np.hstack((one, 0 * one)) - dt * to_u, to_u))
    pull = -dt * H @ (W @ weights)
    state, power = np.append(np.full(n, start), np.zeros(n)), np.eye(2 * n)
    grown = 0.0
    for _ in range(steps):
        state = step @ state + np.append(-dt * pull, pull)
        grown += float(np.abs(power[:n, :n]).sum(axis=1).max())
        power = step @ power
    return float(state[:n].max()) / R, grown * last_bits(2 * n * R)


@case
def mass_ratio_exact(quick):
    """exact: two balls, and ten with every second one light, stay at rest for a second.

    Bound: a force is the sum of N terms, off by N U of itself, and accelerates its ball by that
    much for t: N U max(load / m) t^2 / 2; and the last bits of the height.
    """
    for power, mass in itertools.product(POWERS, ([1.0, None], [1.0, None] * 5)):
        mass = np.array([m or 10.0**power for m in mass])
        tower = column(mass)
        run_ = run_model("exact", tower, 0.01, 100)
        off = float(np.abs(run_.q - tower.q0).max() / R)
        bound = len(mass) * U * float((load(mass) / mass).max()) / 2 / R
        bound += last_bits(2 * len(mass) * R, len(mass))
        yield jobs.row(
            f"{len(mass)} balls, upper / lower mass 1e{power}",
            f"moves at most {bound:.1e} r in 1 s",
            f"{off:.2g} r",
            off <= bound,
        )


@case
def tower_sweeps_are_gauss_seidel(quick):
    """20 sweeps on a tower of N leave G^20 of the error, G with the known rate cos^2(pi / 2N).

    Bounds: each sweep rounds an impulse by EACH of the largest, for every contact. An eigenvalue is
    off by the rounding of G, N EACH, over the cosine of its left and right vectors (Wilkinson).
    """
    for n in (3, 10, 30, 100) if quick else (3, 10, 30, 100, 300):
        mass = np.ones(n)
        G_, right = sweep_matrix(delassus(mass)), load(mass) * 0.01
        lam = swept(mass, 20)
        off = np.abs(right - lam - np.linalg.matrix_power(G_, 20) @ right).max() / right[0]
        rate, cosine = largest_eigenvalue(G_)
        theory = math.cos(math.pi / (2 * n)) ** 2
        needed = math.log(1e3) / -math.log(theory)
        yield jobs.row(
            f"{n} balls",
            f"rate {theory:.8f}: {needed:.4g} sweeps for a factor 1000",
            f"rate {rate:.8f}, impulses off by {off:.1g}",
            off <= 20 * n * EACH and abs(rate - theory) <= n * EACH / cosine,
        )


def largest_eigenvalue(A):
    """The largest eigenvalue of A, and the cosine of the angle between its left and right vectors."""
    (right, x), (left, y) = (np.linalg.eig(B) for B in (A, A.T))
    i, j = np.abs(right).argmax(), np.abs(left).argmax()
    return float(np.abs(right[i])), float(abs(np.vdot(y[:, j], x[:, i])))


@case
def tower_sweeps_law(quick):
    """Sweeps that hold N balls to 1e-3 r at rest: the least by the fixed point, and not one less.

    A push of depth makes up for what sweeps leave undone (resting_depth), so it takes about N g dt^2
    / (beta tolerance), 2 N at dt 0.002, although convergence needs N^2 sweeps. A tower that starts
    at the fixed point moved by a tenth goes where its linear law says (settled).
    """
    tolerance = 1e-3 * R
    for n in (3, 10, 30) if quick else (3, 10, 30, 100, 300):
        mass = np.ones(n)
        low, high = 1, 4 * n + 8  # least sweeps by the fixed point
        while low < high:
            middle = (low + high) // 2
            low, high = (
                (low, middle)
                if resting_depth(mass, middle).max() <= tolerance
                else (middle + 1, high)
            )
        law = n * G * 0.002**2 / (0.2 * tolerance)
        steps = 400 if n < 100 else 150
        for sweeps in (low - 1, low):
            start = 1.1 * resting_depth(mass, sweeps)
            expected, bound = settled(mass, sweeps, steps, start=start)
            tower = column(mass)
            tower.q0[1] -= np.cumsum(start)
            run_ = run_model("lcp", tower, 0.002, steps, iters=sweeps)
            got = float(np.max(contact.max_penetration(run_.q[-1], tower.radius)) / R)
            holds = "holds" if sweeps == low else "does not hold"
            yield jobs.row(
                f"{n} balls, {sweeps} sweeps (about {law:.0f})",
                f"{holds} in the end; {expected:.6g} r after {steps} steps, within {bound:.1g}",
                f"{got:.6g} r",
                abs(got - expected) <= bound,
            )


@case
def tower_rest_lcp(quick):
    """A tower laid down touching, 20 sweeps: as deep after 4 s as its linear law says (settled)."""
    for n in (3, 10) if quick else (3, 10, 30, 100):
        expected, bound = settled(np.ones(n), 20, 2000)
        tower = column(np.ones(n))
        run_ = run_model("lcp", tower, 0.002, 2000)
        got = quality(run_, tower, 0.002)["rest_penetration_frac"]
        yield jobs.row(
            f"{n} balls",
            f"{expected:.6g} r within {bound:.1g}",
            f"{got:.6g} r",
            abs(got - expected) <= bound,
        )


@case
def tower_rest_penalty(quick):
    """A tower at its static depths (m g / k times the balls above) stays, while those are under r.

    Bound: the last bits of its height, of every contact. Limit: from r on, balls two apart overlap
    as well, and the tower bursts: over 101 balls at k = 1e4, where N m g / k = r.
    """
    k = 1e4
    for n in (3, 30, 100) if quick else (3, 30, 100, 200, 300):
        tower = column(np.ones(n), damping=80.0)
        depth = load(np.ones(n)) / k
        tower.q0[1] -= np.cumsum(depth)
        run_ = run_model("penalty", tower, 0.002, 300, stiffness=k)
        off, deepest = float(np.abs(run_.q[-1] - tower.q0).max() / R), depth[0] / R
        bound = last_bits(2 * n * R, n)
        yield jobs.row(
            f"{n} balls, {deepest:.3g} r deep at the table",
            f"stays within {bound:.1g} r",
            f"{off:.2g} r",
            off <= bound,
            limit=deepest > 1.0 and "springs: balls two apart overlap from r on",
        )


@case
def tower_rest_soft(quick):
    """soft: a tower stays where every contact carries its load: d^2 K depth = (1 - d) sum w f.

    Bound: the last bits of its height, of every contact.
    """
    K = 1.0 / (contact.SOLIMP[1] * contact.SOLREF[0]) ** 2
    for n in (3, 10) if quick else (3, 10, 30):
        depth = np.array(
            [soft_depth(K, f * (1 if i == 0 else 2)) for i, f in enumerate(load(np.ones(n)))]
        )
        tower = column(np.ones(n))
        tower.q0[1] -= np.cumsum(depth)
        run_ = run_model("soft", tower, 0.002, 300)
        off, bound = float(np.abs(run_.q[-1] - tower.q0).max() / R), last_bits(2 * n * R, n)
        yield jobs.row(
            f"{n} balls, {depth[0] / R:.3g} r deep at the table",
            f"stays within {bound:.1g} r",
            f"{off:.2g} r",
            off <= bound,
        )


def soft_depth(K, pressed):
    """The depth [m] at which d^2 K depth = (1 - d) pressed, by bisection; pressed [m/s^2]."""
    low, high = 0.0, 10.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        d = contact.impedance(middle, contact.SOLIMP)
        low, high = (middle, high) if d * d * K * middle < (1 - d) * pressed else (low, middle)
    return high


@case
def tower_rest_exact(quick):
    """exact: a tower of N at rest stays at rest, to the last bits of its height, of every contact."""
    for n in (3, 30) if quick else (3, 30, 100, 300):
        tower = column(np.ones(n))
        run_ = run_model("exact", tower, 0.01, 100)
        off = float(np.abs(run_.q - tower.q0).max() / R)
        bound = last_bits(2 * n * R, n)
        yield jobs.row(
            f"{n} balls", f"moves at most {bound:.1g} r in 1 s", f"{off:.2g} r", off <= bound
        )


# --- scales -----------------------------------------------------------------------------------


@case
def radii(quick):
    """One ball of radius 1e-6 to 1e3 m, laid down or dropped from 0.1 r: where each model rests.

    penalty at m g / k for k = 100 m g / r; lcp and exact touching, to the last bits of r. soft is
    left out: the width of its impedance is a length.
    """
    for power in (-6, -4, -2, 0, 2, 3):
        r = 10.0**power
        k, dt = 100.0 * G / r, 0.02 * math.sqrt(r / G)
        ball = scene(0.0, 1.1 * r, radius=r, damping=0.8 * math.sqrt(k))
        for model, want in (("penalty", 0.01), ("lcp", 0.0), ("exact", 0.0)):
            run_ = run_model(model, ball, dt, 3000, stiffness=k)
            off = float(abs((r - run_.q[-1, 1, 0]) / r - want))
            yield jobs.row(
                f"{model}, r = 1e{power} m",
                f"rests {want:g} r deep within {EACH:.1g}",
                f"off by {off:.2g} r",
                off <= EACH,
            )


@case
def lcp_bounces_on_the_table(quick):
    """e = 0.5, dropped from 10 r: lcp turns the ball around at most one step before the table.

    A ball that would meet the table within the step bounces where it is, so at most v dt early,
    for any radius: the margin of 1 mm does not enter. Rounding: that of a flight of 600 steps.
    """
    for power in (-5, -3, -1, 1):
        r = 10.0**power
        dt = 0.002 * math.sqrt(r / R)
        run_ = run_model("lcp", scene(0.0, 11.0 * r, radius=r, restitution=0.5), dt, 600)
        turned = int(np.argmax(run_.v[:, 1, 0] > 0))
        early = float((run_.q[turned - 1, 1, 0] - r) / r)
        step = float(-run_.v[turned - 1, 1, 0]) * dt / r
        yield jobs.row(
            f"r = 1e{power} m",
            f"turns within v dt = {step:.3g} r of the table",
            f"turns {early:.3g} r above",
            abs(early) <= step + U * 600 * (11.0 + 600 * step),
        )


@case
def mixed_radii(quick):
    """A column of balls from 1 mm to 1 km, either end up: rests to the last bits of its height."""
    for label, power in (("growing", (-3, -1, 1, 3)), ("shrinking", (3, 1, -1, -3))):
        r = 10.0 ** np.array(power, dtype=float)
        for model in ("lcp", "exact"):
            tower = column(np.ones(4), radius=r)
            run_ = run_model(model, tower, 0.002, 500, iters=200)
            off = float(np.abs(run_.q - tower.q0).max())
            bound = R * last_bits(2 * float(r.sum()), len(r))
            yield jobs.row(
                f"{model}, {label}",
                f"moves at most {bound:.1g} m in 1 s",
                f"{off:.2g} m",
                off <= bound,
            )


@case
def far_from_the_origin(quick):
    """Shifted by X along x: y keeps its bits; x is as good as its last bit, ulp(X) / 2 a step.

    Two balls on the table meet head on. lcp and exact: the same velocities after it, since no
    length enters them. penalty: a depth that is off by ulp(X) twice over is a force, k times it,
    which acts for less than a second.
    """
    for power in (3, 5, 7, 9):
        X = 10.0**power
        for model in ("penalty", "lcp", "exact"):
            pair = dict(y=[R, R], vx=[1.0, -1.0], restitution=0.5, damping=20.0)
            near, far = scene([0.0, 0.501234], **pair), scene([X, X + 0.501234], **pair)
            a, b = (run_model(model, s, 0.002, 300) for s in (near, far))
            same_y = np.array_equal(a.q[:, 1], b.q[:, 1])
            speed = float(np.abs(a.v[-1, 0] - b.v[-1, 0]).max())
            off = float(np.abs(b.q[:, 0] - X - a.q[:, 0]).max())
            # the start 0.5 apart is itself off by an ulp, and so is each step's sum
            allowed = 302 * float(np.spacing(X)) * (1.0 if model != "exact" else 0.1)
            slow = 2 * 2e4 * float(np.spacing(X)) if model == "penalty" else 0.0
            ok = same_y and speed <= slow and off <= allowed + slow * 0.6
            yield jobs.row(
                f"{model}, X = 1e{power} m",
                f"y the same bits, x within {allowed:.1e} m, speeds within {slow:.0e} m/s",
                f"y {'the same' if same_y else 'differs'}, x off by {off:.1e} m, speeds by {speed:.1e} m/s",
                ok,
            )


@case
def dt_from_microseconds_to_a_second(quick):
    """The drop for two seconds or ten steps: landing depth of lcp in closed form, penalty by its critical dt.

    lcp: the rounding of a flight of so many steps. exact: the last bits of its height and of the
    height it has fallen, in the run and in the closed form.
    """
    from curriculum.stress import maps

    drop = contact.build_scene("drop")
    limit_dt = contact.critical_dt(1.0, 1e4, 80.0)
    for dt in (1e-4, 0.04, 1.0) if quick else (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.04, 0.064, 0.1, 1.0):
        steps = max(10, round(2.0 / dt))
        for model in ("penalty", "lcp", "exact"):
            run_ = run_model(model, drop, dt, steps)
            q = quality(run_, drop, dt)
            if model == "lcp":
                first = maps.landing_depth(maps.GAP, dt) / R
                bound = added_up(steps, 1.0, G * dt * steps, dt * steps)
                yield jobs.row(
                    f"lcp, dt {dt:g}",
                    f"deepest {first:.6g} r within {bound:.1g}",
                    f"{q['max_penetration_frac']:.6g} r",
                    abs(q["max_penetration_frac"] - first) <= bound,
                )
            elif model == "penalty":
                calm = abs(q["rest_penetration_frac"] - 0.00981) < 1e-4
                ok = calm and not q["blew_up"] if dt < limit_dt else not calm
                want = (
                    "rests 0.00981 r deep"
                    if dt < limit_dt
                    else f"does not rest (critical dt {limit_dt:.4g} s)"
                )
                yield jobs.row(
                    f"penalty, dt {dt:g}",
                    want,
                    f"{q['rest_penetration_frac']:.5g} r at the end, "
                    + (f"EXPLODED at step {q['blew_up_step']}" if q["blew_up"] else "bounded"),
                    ok,
                )
            else:
                truth = closed_form.ball_height(float(drop.q0[1, 0]), R, 0.0, run_.t)
                off = float(np.abs(run_.q[:, 1, 0] - truth).max() / R)
                bound = 2 * last_bits(float(drop.q0[1, 0]), 2)
                yield jobs.row(
                    f"exact, dt {dt:g}",
                    f"height error at most {bound:.1g} r",
                    f"{off:.2g} r",
                    off <= bound,
                )


@case
def stiffness_from_1_to_1e12(quick):
    """A ball laid on the table sinks to m g / k, to the last bits that its height has."""
    for power in range(0, 13, 2):
        k = 10.0**power
        c = 0.8 * math.sqrt(k)
        dt = 0.2 * contact.critical_dt(1.0, k, c)
        run_ = run_model("penalty", scene(0.0, R, damping=c), dt, 2000, stiffness=k)
        depth, got = closed_form.rest_depth(1.0, k), R - float(run_.q[-1, 1, 0])
        bits = 4.0 * float(np.spacing(max(R, depth)))
        yield jobs.row(
            f"k = 1e{power} N/m",
            f"{depth:.6g} m within {bits:.1g} m",
            f"off by {abs(got - depth):.2g} m",
            abs(got - depth) <= bits,
        )


@case
def restitution_0_and_1(quick):
    """lcp with e = 1 retraces its steps: back at the drop height after every bounce, at any dt.

    The step with -v_n takes back the one before it, so only rounding adds up, that of a flight of
    as many steps. With e = 0 and baumgarte 0 the ball never rises again. exact, e = 1: back after
    each of 100 bounces. A bounce rounds its time by EACH of it, and its speed by EACH of it.
    """
    for dt in (0.0005, 0.002, 0.008, 0.032):
        ball = contact.build_scene("bounce", restitution=1.0)
        run_ = run_model("lcp", ball, dt, round(9.0 / dt))
        y = run_.q[:, 1, 0]
        tops = y[1:-1][(y[1:-1] >= y[:-2]) & (y[1:-1] >= y[2:])]
        off = float(np.abs(tops - y[0]).max() / R) if len(tops) else math.inf
        bound = added_up(len(run_.t), float(y[0]), float(np.abs(run_.v).max()), 9.0)
        yield jobs.row(
            f"lcp, e = 1, dt {dt:g}",
            f"every top within {bound:.1g} r of the start",
            f"{len(tops)} tops, off by {off:.2g} r",
            off <= bound,
        )
        ball = contact.build_scene("bounce", restitution=0.0)
        run_ = run_model("lcp", ball, dt, round(2.0 / dt), baumgarte=0.0)
        rise = float(np.diff(run_.q[:, 1, 0]).max())
        yield jobs.row(
            f"lcp, e = 0, baumgarte 0, dt {dt:g}",
            "never rises",
            f"rises by {rise:.2g} m a step",
            rise <= 0.0,
        )
    ball = contact.build_scene("bounce", restitution=1.0)
    gap = float(ball.q0[1, 0]) - R
    period = 2.0 * float(closed_form.first_impact_time(gap))
    run_ = run_model("exact", ball, period, 100)
    off = float(np.abs(run_.q[:, 1, 0] - ball.q0[1, 0]).max())
    bound = 100 * 2 * EACH * 0.5 * G * period * 100 * period
    yield jobs.row(
        "exact, e = 1",
        f"after each of 100 bounces within {bound:.1g} m of the start",
        f"{off:.2g} m",
        off <= bound,
    )


# --- overlaps ---------------------------------------------------------------------------------


@case
def start_overlap(quick):
    """Two balls in the air, 1 to 100 % inside one another: how fast they part.

    penalty: the spring's energy k d^2 / 2 becomes motion, so a relative speed of d sqrt(2 k / m)
    less what ends with the spring, up to dt sqrt(2 k / m) of it. exact: moved apart, no speed. A
    depth is rounded by EACH of the height, 60 m, and so is what is made of it; so is each step's speed.
    Limit of lcp: the bias velocity, beta d / dt, stays with the balls, however small dt is.
    """
    for share in (0.01, 0.1, 0.5, 0.9, 1.0):
        d, dt = 2 * R * share, 0.001
        pair = scene([0.0, 2 * R - d], 60.0)
        wanted = {"penalty": d * math.sqrt(2e4), "lcp": 0.0, "exact": 0.0}
        for model, want in wanted.items():
            run_ = run_model(model, pair, dt, 300)
            apart = run_.q[-1, :, 1] - run_.q[-1, :, 0]
            gap = float(np.hypot(*apart) - 2 * R)
            speed = float(np.hypot(*(run_.v[-1, :, 1] - run_.v[-1, :, 0])))
            rough, bias = EACH * 60.0, 0.2 * d / dt
            parted = gap >= -rough and abs(float(run_.v[-1, 0].sum())) <= 300 * EACH * speed
            spring = want * dt * math.sqrt(2e4) if model == "penalty" else rough
            yield jobs.row(
                f"{model}, overlap {share:.0%}",
                f"parts, relative speed {want:.4g} m/s",
                f"gap {gap / R:.2g} r, {speed:.4g} m/s",
                parted and abs(speed - want) <= spring,
                limit=model == "lcp"
                and parted
                and abs(speed - bias) <= rough * 0.2 / dt
                and f"bias velocity: beta d / dt = {bias:.4g} m/s stays",
            )


@case
def coincident_centres(quick):
    """Two and ten balls in one place, in the air and on the table: they part, and rest as a tower.

    Between one centre and another the push is along y, so all stay over one point. When they have
    come down, every contact carries the balls above it, and its depth follows as in the towers
    above: m g / k times those balls (penalty), d^2 K depth = (1 - d) sum w f (soft), what unfinished
    sweeps leave (lcp), none (exact, to TOUCH of a radius for every ball). Bound of the springs: the
    last bits of the height, of every contact, and what the damper carries of a speed so small that
    a step of it is lost in rounding the height, U height / dt; of lcp: settled.
    """
    dt, seconds = 0.001, {"penalty": 60, "lcp": 240, "soft": 12, "exact": 12}
    for n, height, model in itertools.product((2, 10), (3.0, R), contact.MODELS):
        pile = scene(0.0, [height] * n, damping=80.0)
        run_ = run_model(model, pile, dt, round(seconds[model] / dt))
        got, order = tower_of(run_, pile)
        place = "in the air" if height > 1 else "on the table"
        apart, allowed = math.inf, math.nan
        if sorted(order) == list(range(n)):
            expected, allowed = resting_tower(model, n, order, dt)
            apart = float(np.abs(got - expected).max() / R)
        yield jobs.row(
            f"{model}, {n} balls, {place}",
            f"a tower, every depth within {allowed:.1g} r",
            f"off by {apart:.2g} r" if apart < math.inf else "no tower",
            bool(np.isfinite(run_.v).all()) and apart <= allowed,
        )


def tower_of(run_, scene_):
    """Depth [m] of each contact at the end, as listed, and which of a tower's it is: 0 the table's."""
    balls = contact.make_balls(scene_._replace(q0=run_.q[-1], v0=run_.v[-1]))
    contacts = contact.detect_contacts(balls)
    upper = [c.a.y if c.b is contact.FLOOR else max(c.a.y, c.b.y) for c in contacts]
    heights = sorted(ball.y for ball in balls)
    return np.array([c.depth for c in contacts]), [heights.index(y) for y in upper]


def resting_tower(model, n, order, dt):
    """(depth [m] of the contacts of a tower of n at rest, in this order, its bound [r])."""
    mass, top = np.ones(n), 2 * n * R
    weights = load(mass)[order]
    if model == "exact":
        return 0.0 * weights, n * exact.TOUCH
    if model == "lcp":
        bound = settled(mass, 20, 2000, dt, order=order)[1]
        return resting_depth(mass, 20, dt, order=order), bound
    lost = 2 * U * top / dt / R  # speed [r/s] between two balls that no height shows
    if model == "penalty":
        return weights / 1e4, last_bits(top, n) + 80.0 / 1e4 * lost
    (T, _), (d, most) = contact.SOLREF, contact.SOLIMP[:2]
    depth = [soft_depth(1.0 / (most * T) ** 2, f * (2 if k else 1)) for k, f in zip(order, weights)]
    return np.array(depth), last_bits(top, n) + 2 * most * T / d * lost  # b / (d K) of MuJoCo


# --- many, long, tiny, huge -------------------------------------------------------------------


@case
def thousands_of_contacts(quick):
    """A row of touching balls on the table stays to the bit; a pile of thousands stays finite, same bits."""
    n = 500 if quick else 5000
    line = scene(0.25 * np.arange(n), 0.125, radius=0.125)
    for model in ("penalty", "lcp"):
        run_ = run_model(model, line, 0.002, 50)
        moved = float(np.abs(run_.q[:, 0] - line.q0[0]).max())
        contacts = len(contact.detect_contacts(contact.make_balls(line)))
        yield jobs.row(
            f"{model}, a row of {n}: {contacts} contacts",
            "x does not move at all",
            f"{moved:.2g} m",
            moved == 0.0,
        )
    count = 200 if quick else 2000
    pile = contact.build_scene("pile", bodies=count)
    for model in ("penalty", "lcp"):
        run_ = run_model(model, pile, 0.004, 100 if quick else 400)
        q = quality(run_, pile, 0.004)
        touching = len(contact.detect_contacts(contact.make_balls(pile._replace(q0=run_.q[-1]))))
        ok = np.isfinite(run_.q).all() and not q["blew_up"]
        yield jobs.row(
            f"{model}, pile of {count}, {touching} contacts at the end",
            "finite, not exploded",
            f"worst {q['max_penetration_frac']:.3g} r, energy excess {q['energy_excess']:.2g}",
            ok,
        )
        middle = pile._replace(q0=run_.q[-1], v0=run_.v[-1])
        a, b = (run_model(model, middle, 0.004, 3, skip=skip) for skip in (True, False))
        yield jobs.row(
            f"{model}, pile of {count}, 3 steps on",
            "skip and no skip: the same bits",
            "the same" if np.array_equal(a.q, b.q) and np.array_equal(a.v, b.v) else "different",
            np.array_equal(a.q, b.q) and np.array_equal(a.v, b.v),
        )


@case
def a_million_steps_at_rest(quick):
    """Every step taken (no skip): the state at the end is the state after 10,000 steps, bit for bit.

    A cycle of short period counts as rest: then the state of one period earlier.
    """
    steps = 20_000 if quick else 1_000_000
    for name in ("drop", "stack"):
        for model in ("penalty", "lcp"):
            run_ = run_model(model, contact.build_scene(name), 0.002, steps, skip=False)
            state = np.concatenate((run_.q, run_.v), axis=1)
            period = next(
                (p for p in range(1, 65) if np.array_equal(state[-1], state[-1 - p])), None
            )
            early = max(10_000, steps // 100)
            ok = period is not None and np.array_equal(
                state[early:-period], state[early + period :]
            )
            yield jobs.row(
                f"{model}, {name}, {steps} steps",
                "the same bits again and again, no drift",
                f"period {period}" + ("" if ok else ", not kept"),
                ok,
            )


@case
def denormal_speeds(quick):
    """Speeds of 5e-324 and 1e-310 m/s along x: kept to the bit, and y as if they were not there."""
    for speed, model in itertools.product((5e-324, 1e-310), contact.MODELS):
        still, moving = (run_model(model, scene(0.0, R, vx=vx), 0.002, 200) for vx in (0.0, speed))
        ok = np.array_equal(still.q[:, 1], moving.q[:, 1]) and (moving.v[:, 0, 0] == speed).all()
        yield jobs.row(
            f"{model}, v_x = {speed:g} m/s",
            "v_x kept, y the same bits",
            f"v_x ends at {moving.v[-1, 0, 0]:g}",
            bool(ok),
        )


@case
def soft_is_the_convex_optimum(quick):
    """soft's impulses solve the strictly convex problem, found again by trying every active set.

    Of up to 8 contacts each subset is tried: pushing where W + R solves to the target, with lam >=
    0, and w >= 0 on the rest. Exactly one fits. Bound: see invariants.soft_has_one_answer.
    """
    number, found = 0, 0
    while found < (6 if quick else 30):
        trial = Trial({**scenes.numbered_spec(number), "solref": [0.02, 1.0]})
        number += 1
        steps = [trial.step("soft", k) for k in trial.samples("soft")[:1]]
        if not steps or not 1 < len(steps[0].contacts) <= 8:
            continue
        found += 1
        step, A = steps[0], steps[0].delassus + np.diag(steps[0].softness)
        b = step.predicted - step.target
        best = every_active_set(A, b)
        off = float(np.abs(step.lam - best).max())
        bound = (
            2 * invariants.impulses_off(step) * float(max(c.m_eff for c in step.contacts)) ** 0.5
        )
        yield jobs.row(
            f"scene {number - 1}, {len(b)} contacts",
            f"impulses within {bound:.1e} N s",
            f"off by {off:.1e} N s",
            off <= bound,
        )


def every_active_set(A, b):
    """The lam >= 0 with A lam + b >= 0 and lam (A lam + b) = 0; the subset that misses it least."""
    best, least = None, math.inf
    for pushing in itertools.product((False, True), repeat=len(b)):
        on = np.array(pushing)
        lam = np.zeros(len(b))
        if on.any():
            lam[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
        missed = float(max(np.maximum(-lam, 0).max(), np.maximum(-(A @ lam + b), 0).max()))
        if missed < least:
            best, least = lam, missed
    return best


OVERFLOWS = {
    "a stiffness of 1e308": ["--contact", "penalty", "--stiffness", "1e308"],
    "a stiffness of 1e300, dt 0.05": [
        "--contact",
        "penalty",
        "--stiffness",
        "1e300",
        "--dt",
        "0.05",
    ],
    "a damping of 1e308": ["--contact", "penalty", "--damping", "1e308"],
    "dt 1e200": ["--contact", "penalty", "--dt", "1e200"],
    "dt 1e308, all models": ["--dt", "1e308"],
    "dt 1e-320, all models": ["--dt", "1e-320"],
    "dt 0.03 for 5000 steps, undamped": [
        "--contact",
        "penalty",
        "--dt",
        "0.03",
        "--damping",
        "0",
        "--steps",
        "5000",
    ],
}


@case
def overflow_on_purpose(quick):
    """The command line on inputs that overflow: exit 0, strict JSON, blew_up with its step, no traceback."""
    for label, flags in OVERFLOWS.items():
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(
                [
                    sys.executable,
                    str(ROOT / "contact.py"),
                    "--no-rerun",
                    "--steps",
                    "100",
                    *flags,
                    "--out",
                    folder,
                ],
                capture_output=True,
                text=True,
                timeout=120,
                cwd=folder,
            )
            path = Path(folder) / "metrics.json"
            trouble = (
                ""
                if done.returncode == 0
                else f"exit {done.returncode}: {done.stderr.strip().splitlines()[-1:]}"
            )
            exploded, said = {}, False
            if path.exists():
                try:
                    metrics = json.loads(path.read_text(), parse_constant=lambda word: 1 / 0)
                    exploded = {
                        model: q["blew_up_step"]
                        for model, q in metrics["quality"].items()
                        if q["blew_up"]
                    }
                except (ValueError, ZeroDivisionError):
                    trouble += " metrics.json is not strict JSON"
            elif not trouble:
                trouble = "no metrics.json"
            said = "EXPLODED" in done.stdout
            trouble += (
                " stderr: " + done.stderr.strip()[-80:]
                if done.stderr.strip() and done.returncode == 0
                else ""
            )
            ok = (
                not trouble
                and said == bool(exploded)
                and all(step is not None for step in exploded.values())
            )
            got = (
                trouble.strip()
                or ", ".join(f"{model} EXPLODED at step {step}" for model, step in exploded.items())
                or "no explosion"
            )
            yield jobs.row(label, "ends, says EXPLODED at which step, writes valid JSON", got, ok)
