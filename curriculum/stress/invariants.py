"""What must hold on any scene, checked on random ones; how each bound follows stands beside it.

A check is a function of a Trial. It returns None where its statement holds, SKIPPED where the
statement says nothing about the scene, words for a violation, or {name: number} where the
statement holds and something was counted. No check has an exception: what a model cannot keep is
either counted, and the count stands in the report, or it is a violation.

U = 2^-53 is the largest relative rounding error of one operation. A bound "to rounding" is U times
the number of operations times the size of what is added, never a number that was found to do.
"""

import math

import numpy as np

from curriculum import exact
from curriculum.stress import jobs, scenes
from curriculum.stress.trial import STEPPED, Step, Trial, U
from curriculum.stress.under_test import contact

SKIPPED = object()
CHECKS = {}
COUNTS = ("exact_rises_among_pegs", "exact_ends")  # these judge nothing
MOST = 2**20  # sweeps a step, by which every gain of energy must have ended
NOTABLE = 1e-9  # a gain of energy below this share has ended


def check(function):
    """Register a check under its name."""
    CHECKS[function.__name__] = function
    return function


# --- all models ---------------------------------------------------------------------------------


@check
def finite_unless_reported(trial):
    """Every number of a run is finite, or contact_quality reports blew_up and the step.

    No bound: finite or not.
    """
    for model in trial.models():
        run, quality = trial.run(model), trial.quality(model)
        finite = bool(np.isfinite(run.q).all() and np.isfinite(run.v).all())
        if not finite and not quality["blew_up"]:
            return f"{model}: not finite, yet not reported"
        if quality["blew_up"] != (quality["blew_up_step"] is not None):
            return f"{model}: blew_up {quality['blew_up']} at step {quality['blew_up_step']}"
    return None


@check
def momentum_along_x_is_kept(trial):
    """The floor pushes upwards only, so sum m v_x stays, in every model.

    A push is given to one ball and taken from another, with three roundings each: 6 U of it. And
    the new speed of each is rounded. Nothing else touches v_x, so a step without a pair keeps its
    bits. Bound for the steps of lcp and soft that are taken again: these roundings, of the pushes
    that were made, counted. For every step of every run: as many pushes as there can be (a pair
    gets one in penalty, one a sweep in lcp and soft; in exact, for each of the run's events, its
    impulse and the terms of its force). Each is at most the change between two momenta, so 16 U
    of the largest. A fixed ball takes momentum up, so of scenes with one nothing is said.
    """
    if trial.fixed.any():
        return SKIPPED
    for model in trial.models():
        if not trial.calm(model):
            continue
        drift = np.abs(np.diff((trial.run(model).v[:, 0] * trial.mass).sum(axis=1)))
        momentum = largest_momentum(trial, model)
        allowed = most_pushes(trial, model) * 16 * U * momentum
        over = drift > allowed + 2 * len(trial.mass) * U * momentum  # that of the two sums
        if over.any():
            k = int(over.argmax())
            return f"{model}, step {k}: drifts by {drift[k]:.3g}, allowed {allowed[k]:.3g} kg m/s"
    return momentum_of_steps(trial)


def most_pushes(trial, model):
    """How many pushes along x there can be in each step (steps,).

    One for every pair that is listed: of penalty; in each sweep of lcp, and in MOST_SWEEPS of soft.
    exact: pairs that touch are edges of a planar graph, at most 3 N, and an event sets off an
    impulse for each and the forces until the next, ORDER terms; any step may have all events.
    """
    run = trial.run(model)
    steps = len(run.t) - 1
    if model == "exact":
        events = trial.exact[1].sum() + len(trial.mass)  # those at the start come before sample 0
        return np.full(steps, events * 3 * len(trial.mass) * (1 + exact.ORDER))
    sweeps = {"penalty": 1, "lcp": trial.spec["iters"], "soft": contact.MOST_SWEEPS}[model]
    margin = contact.CONTACT_MARGIN if model == "lcp" else 0.0
    margin += 8 * U * float(np.abs(run.q).max() + trial.scene.radius.max())
    pairs = gaps(run.q[:-1], trial.scene.radius)[:, len(trial.mass) :] < margin
    return sweeps * pairs.sum(axis=1)


def largest_momentum(trial, model):
    """Bound on sum m |v_x| in the course of each step [kg m/s], (steps,).

    sum m |v_x| is at most sqrt(sum m) |v|, |v| in the norm of the masses: of two states, and of what
    gravity makes of the first. Sweeps come nearer to their solution with every correction, so what
    is between is at most that far beyond it. exact: all its energy in motion.
    """
    run, mass = trial.run(model), float(trial.mass.sum())
    if model == "exact":
        start = float(contact.energy(run.q[:1], run.v[:1], trial.mass)[0])
        return np.full(len(run.t) - 1, np.sqrt(2 * mass * start))
    speed = np.sqrt(2 * kinetic(run.v, trial.mass))
    falling = speed[:-1] - trial.dt * contact.GRAVITY * np.sqrt(mass)
    return np.sqrt(mass) * (falling + 2 * speed[1:])


def momentum_of_steps(trial):
    """Words when a step of lcp or soft, taken again, drifts by more than its own pushes round."""
    for model in ("lcp", "soft"):
        for k in trial.samples(model):
            step = trial.step(model, k)
            after = trial.mass * step.state()[2]
            drift = abs(math.fsum(after) - math.fsum(trial.mass * trial.run(model).v[k, 0]))
            if drift > step.push_rounding + 2 * U * step.peak * len(after):
                return (
                    f"{model}, step {k}: drifts by {drift:.3g} kg m/s, its pushes round by "
                    f"{step.push_rounding:.3g}"
                )
    return None


@check
def mirrored_in_x_runs_mirrored(trial):
    """x -> -x gives the mirrored run, the same bits: no operation depends on the sign of x."""
    flipped = {name: [-value for value in trial.spec[name]] for name in ("x", "vx")}
    mirror = np.array([[-1.0], [1.0]])
    for model in trial.again():
        run, other = trial.run(model), trial.run(model, **flipped)
        trouble = unlike(model, run, contact.Run(other.t, other.q * mirror, other.v * mirror))
        if trouble:
            return trouble
    return None


@check
def a_run_can_be_taken_up_anywhere(trial):
    """A step depends on the state alone: from the middle on, the second half has the same bits."""
    steps = trial.spec["steps"]
    half = steps // 2
    for model in STEPPED:
        run = trial.run(model)
        if not np.isfinite(run.q[half]).all():
            continue
        start = dict(zip(("x", "y", "vx", "vy"), (*run.q[half].tolist(), *run.v[half].tolist())))
        again = trial.run(model, **start, steps=steps - half)
        trouble = unlike(model, contact.Run(run.t[half:], run.q[half:], run.v[half:]), again)
        if trouble:
            return trouble
    return None


@check
def a_far_ball_changes_nothing(trial):
    """One more ball, on the floor a kilometre away, leaves the bits of the others alone.

    soft stops on the scale of all speeds, so a ball that falls might stop it later: this one rests.
    """
    spec = trial.spec
    extra = {
        "x": max(spec["x"]) + 1000.0,
        "y": 0.1,
        "vx": 0.0,
        "vy": 0.0,
        "mass": 1.0,
        "radius": 0.1,
    }
    more = {name: [*spec[name], value] for name, value in extra.items()}
    for model in ("penalty", "lcp"):
        if not trial.calm(model):
            continue
        run, other = trial.run(model), trial.run(model, **more)
        trouble = unlike(model, run, contact.Run(other.t, other.q[..., :-1], other.v[..., :-1]))
        if trouble:
            return trouble
    return None


# --- penalty ------------------------------------------------------------------------------------


@check
def springs_only_push(trial):
    """Penalty: f_n >= 0 at every contact, and the forces on the balls along x add up to nothing.

    Bound: the force of a contact is added to one ball and taken from another, so 4 U sum |f_x| for
    every contact.
    """
    run, spec = trial.run("penalty"), trial.spec
    for k in trial.samples("penalty"):
        balls = contact.make_balls(trial.scene._replace(q0=run.q[k], v0=run.v[k]))
        contacts = contact.detect_contacts(balls, 0.0)
        pushes = [
            contact.penalty_normal_force(c.depth, c.v_n(), spec["stiffness"], spec["damping"])
            for c in contacts
        ]
        if min(pushes, default=0.0) < 0.0:
            return f"step {k}: a contact pulls with {min(pushes):g} N"
        contact.penalty_force(contacts, spec["stiffness"], spec["damping"])
        total, size = sum(ball.fx for ball in balls), sum(pushes)
        if abs(total) > 4 * U * (len(contacts) + len(balls)) * size:
            return f"step {k}: forces along x add up to {total:.3g} of {size:.3g} N"
    return None


@check
def other_units_give_the_same_run(trial):
    """Penalty: lengths x 4, times x 2, masses x 8 (gravity stays) scale the run, the same bits.

    Powers of two are exact. The other models know lengths of their own: the margin of lcp, the
    width of soft's impedance.
    """
    if not trial.calm("penalty"):
        return SKIPPED
    spec, length, time, mass = trial.spec, 4.0, 2.0, 8.0
    scale = {
        "x": length,
        "y": length,
        "vx": length / time,
        "vy": length / time,
        "mass": mass,
        "radius": length,
    }
    other = {name: [value * factor for value in spec[name]] for name, factor in scale.items()}
    other |= {
        "dt": spec["dt"] * time,
        "stiffness": spec["stiffness"] * mass / time**2,
        "damping": spec["damping"] * mass / time,
    }
    run, scaled = trial.run("penalty"), trial.run("penalty", **other)
    return unlike("penalty", run, contact.Run(run.t, scaled.q / length, scaled.v * (time / length)))


# --- lcp and soft, step by step -----------------------------------------------------------------


@check
def plain_steps_give_the_same_bits(trial):
    """A step taken again by contact.py's plain loops gives the recorded bits (lcp and soft).

    The run itself was compiled, where that can be had, and had skipped what changes no bit.
    """
    for model in ("lcp", "soft"):
        run = trial.run(model)
        for k in trial.samples(model):
            state = trial.step(model, k).state()
            for got, name in ((state[:2], "q"), (state[2:], "v")):
                want = getattr(run, name)[k + 1]
                if not same(got, want):
                    return f"{model}, step {k}: {name} off by {np.abs(got - want).max():.3g}"
    return None


@check
def every_contact_is_listed(trial):
    """detect_contacts lists the pairs within the margin, and no others, by distances reckoned apart.

    Bound: a distance that is within rounding of the margin, 8 U of the coordinates, may be either.
    """
    for model in ("lcp", "soft"):
        margin = contact.CONTACT_MARGIN if model == "lcp" else 0.0
        for k in trial.samples(model):
            step, q = trial.step(model, k), trial.run(model).q[k]
            gap, listed = gaps(q[None], trial.scene.radius), len(step.contacts)
            either = 8 * U * float(np.abs(q).max() + trial.scene.radius.max())
            least, most = (int((gap < margin + s * either).sum()) for s in (-1, 1))
            if not least <= listed <= most:
                return f"{model}, step {k}: {listed} contacts listed of {least} to {most}"
    return None


@check
def impulses_only_push(trial):
    """Every impulse of lcp and soft is >= 0. No bound: the projection is exact."""
    for model in ("lcp", "soft"):
        for k in trial.samples(model):
            lam = trial.step(model, k).lam
            if not lam.min() >= 0.0:
                return f"{model}, step {k}: a contact pulls with {lam.min():g} N s"
    return None


@check
def complementary_up_to_the_last_sweep(trial):
    """lam > 0 means w = 0, lam = 0 means w >= 0, to within what the last sweep still moved.

    Bound: at its turn a contact is solved. Afterwards only the others' changes of that last sweep
    move its v_n, by at most sum |W| |dlam|. Rounding: 8 U of the speeds for every contact.
    """
    for model in ("lcp", "soft"):
        for k in trial.samples(model):
            step = trial.step(model, k)
            off = np.where(step.lam > 0.0, np.abs(step.residual), -step.residual)
            allowed = step.unsettled() + rounding(step)
            worst = int((off - allowed).argmax())
            if off[worst] > allowed[worst]:
                return (
                    f"{model}, step {k}: w off by {off[worst]:.3g}, "
                    f"allowed {allowed[worst]:.3g} m/s"
                )
    return None


def rounding(step):
    """8 U of the speeds that a v_n is made of, for every contact of the step [m/s]."""
    speeds = np.abs(step.jacobian) @ step.fastest
    size = (
        speeds + np.abs(step.target) + np.abs(step.delassus) @ step.lam + step.softness * step.lam
    )
    return 8 * U * (len(step.contacts) + 1) * float(size.max())


@check
def more_sweeps_solve_better(trial):
    """lcp: no sweep raises 1/2 lam W lam + lam (p - target), whose minimum is the solution.

    A correction minimises it along one impulse with the others held (coordinate descent).
    Bound: rounding, 8 U of lam times the speeds for every contact.
    """
    for k in trial.samples("lcp"):
        step = trial.step("lcp", k)
        rise = float(np.diff(step.objectives).max(initial=0.0))
        if rise > float(step.lam.max()) * rounding(step) * len(step.contacts):
            return f"step {k}: the objective rises by {rise:.3g} J"
    return None


@check
def overlaps_stay_within_their_bound(trial):
    """lcp: after a step, gap >= gap before + dt (target - residual) at every listed contact.

    The new distance is at least its part along the old normal: |d + dt u| >= n.(d + dt u) =
    gap + r + dt v_n'. And v_n' >= target - residual (see complementarity). So a listed overlap
    shrinks by the share beta, and a listed gap stays one. Rounding: 8 U of the coordinates.
    """
    radius = trial.scene.radius
    for k in trial.samples("lcp"):
        step = trial.step("lcp", k)
        size = 8 * U * float(np.abs(trial.run("lcp").q[k : k + 2]).max() + radius.max())
        for c, gap, target, left in zip(step.contacts, step.gap, step.target, step.unsettled()):
            least = gap + step.dt * (target - left - rounding(step)) - size
            now = c.a.y - c.a.radius
            if c.b is not contact.FLOOR:
                now = np.hypot(c.a.x - c.b.x, c.a.y - c.b.y) - c.a.radius - c.b.radius
            if now < least:
                return f"step {k}: a gap becomes {now:.6g}, at least {least:.6g} m"
    return None


@check
def energy_rises_by_unfinished_sweeps_alone(trial):
    """lcp without bias velocity: F = E + e/(1+e) dt sum m g v_y (g < 0) rises by what is unsolved.

    In the norm of the masses, with D = v' - v: E' - E = lam.J v' - |D|^2 / 2, from D = dt g +
    M^-1 J^T lam and q' - q = dt v'. With w = J v' - target and target <= -e J v this becomes
    F' - F <= lam.w / (1+e) - (1-e)/(1+e) |D|^2 / 2, and lam.w = 0 once the sweeps have finished.
    Any rise of F must be that lam.w, to rounding; it is counted, with the sweeps that end it.
    """
    if not trial.calm("lcp", baumgarte=0.0):
        return SKIPPED
    rise, size = rises(trial, trial.spec["iters"])
    worst = int((rise - size * slack(trial)).argmax())
    if rise[worst] <= size[worst] * slack(trial):
        return None
    trouble = unexplained(trial, worst, rise[worst], size[worst])
    sweeps = sweeps_that_end_it(trial)
    if trouble or sweeps is None:
        return trouble or f"F still rises with {MOST} sweeps a step"
    run = trial.run("lcp", baumgarte=0.0)
    total = contact.energy(run.q, run.v, trial.mass)
    scale = float(size.max())
    return {
        "rise": float(rise.max()) / scale,
        "sweeps": sweeps,
        "above_start": max(0.0, float((total - total[0]).max())) / scale,
    }


def rises(trial, iters):
    """(rises of F beyond the law's loss, size of the energies), step by step, without bias."""
    e, dt, mass = trial.spec["restitution"], trial.dt, trial.mass
    run = trial.run("lcp", baumgarte=0.0, iters=iters)
    total = contact.energy(run.q, run.v, mass)
    lead = e / (1 + e) * dt * contact.GRAVITY * (mass * run.v[:, 1]).sum(-1)
    loss = (1 - e) / (1 + e) * kinetic(np.diff(run.v, axis=0), mass)
    size = kinetic(run.v, mass) + (mass * -contact.GRAVITY * np.abs(run.q[:, 1])).sum(-1)
    return np.diff(total + lead) + loss, np.maximum(size[1:], size[:-1])


def slack(trial):
    """Rounding of F in one step, as a share: 8 U for every ball and every push there can be."""
    run = trial.run("lcp", baumgarte=0.0)
    pushes = trial.spec["iters"] * int(contact_count(trial, run).max())
    return 8 * U * (len(trial.mass) + pushes)


def unexplained(trial, k, rise, size):
    """Words when the rise of F in step k is not what its sweeps left unsolved, else None."""
    e = trial.spec["restitution"]
    still = Trial({**trial.spec, "baumgarte": 0.0})
    step = Step(still, "lcp", k)
    above = float((step.target + e * step.before).max())
    if above > rounding(step):
        return f"step {k}: a target is {above:.3g} m/s above -e v_n"
    unsolved = float(step.lam @ (step.after + e * step.before)) / (1 + e)
    if abs(rise - unsolved) > size * slack(trial):
        return f"step {k}: F rises by {rise:.6g} J, unsolved are {unsolved:.6g} J"
    return None


def sweeps_that_end_it(trial):
    """The first doubling of the sweeps at which F rises by under NOTABLE; None beyond MOST."""
    sweeps = trial.spec["iters"]
    while sweeps <= MOST:
        rise, size = rises(trial, sweeps)
        if (rise <= NOTABLE * size).all():
            return sweeps
        sweeps *= 2
    return None


@check
def soft_has_one_answer(trial):
    """soft: sweeps in the other order give the same velocities, and the convex problem's optimum.

    W + R is positive definite, so the problem has one solution z* (impulses scaled by
    sqrt(m_eff)), and |z - z*| <= (1 + |A|) / mu |min(z, A z + b)|, A = W + R scaled, mu its least
    eigenvalue (Mathias and Pang 1990). Two answers are apart by at most the sum of their bounds.
    """
    for k in trial.samples("soft"):
        first, other = trial.step("soft", k), Step(trial, "soft", k, backwards=True)
        v = [step.state()[2:].ravel() for step in (first, other)]
        apart = float(np.sqrt(np.tile(trial.mass, 2) @ (v[0] - v[1]) ** 2))
        allowed = distance_to_optimum(first) + distance_to_optimum(other)
        allowed += (
            8
            * U
            * len(first.contacts)
            * np.sqrt(2 * kinetic(v[0].reshape(1, 2, -1), trial.mass)[0])
        )
        if apart > allowed:
            return f"step {k}: answers {apart:.3g} apart, allowed {allowed:.3g} sqrt(J)"
    return None


def impulses_off(step):
    """Bound on how far the scaled impulses z are from the optimum's [sqrt(J)]."""
    A, scale = scaled(step)
    mu, largest = np.linalg.eigvalsh(A)[[0, -1]]
    natural = np.minimum(step.lam / scale, scale * step.residual)
    left = float(np.linalg.norm(natural)) + float(np.linalg.norm(scale)) * rounding(step)
    return float((1 + largest) / mu) * left


def distance_to_optimum(step):
    """Bound on how far the velocities are from the optimum's, in the norm of the masses."""
    return float(np.sqrt(np.linalg.eigvalsh(scaled(step)[0])[-1])) * impulses_off(step)


def scaled(step):
    """(W + R scaled to a diagonal of 1, the scale: square roots of the effective masses)."""
    scale = np.sqrt([c.m_eff for c in step.contacts])
    return scale[:, None] * (step.delassus + np.diag(step.softness)) * scale, scale


# --- exact --------------------------------------------------------------------------------------


@check
def exact_never_penetrates(trial):
    """exact: no overlap at any sample, but by what it takes for touching, TOUCH of a radius a ball.

    Bound: a gap of under TOUCH, and 8 U of the coordinates, counts as none. Setting one contact right
    moves its balls by no more than that, so along a chain of N balls a gap is off by at most N of it.
    Not derived: in a narrow wedge a ball moves by more to close a gap; the same is allowed.
    """
    if trial.overlaps:
        return SKIPPED
    run, r = trial.run("exact"), float(trial.scene.radius.max())
    deepest = float(np.max(contact.max_penetration(run.q, trial.scene.radius)))
    allowed = len(trial.mass) * (exact.TOUCH * r + 8 * U * float(np.abs(run.q).max()))
    return None if deepest <= allowed else f"{deepest:.3g} m deep, allowed {allowed:.3g} m"


@check
def exact_never_gains_energy(trial):
    """exact: from sample to sample E rises by no more than rounding, and what exact takes for nothing.

    To blow a scene up about a point o of the table by a metre per smallest radius r opens every gap
    by a metre at least. B = sqrt(sum m |q - o|^2) / r is the size of that, in the norm of the masses.
    So the smallest move that opens gaps by TOUCH radii is at most B times as large, and lifts by B g
    sqrt(sum m) times TOUCH radii. Impulses that change v by dv add up to at most B |dv|, where |dv| <=
    2 sqrt(2 E); an impact whose v_n is off by NOISE sqrt(g r) gives that times their sum. An event may
    do both. A force below GRAZE g m counts as none, at up to 3 N contacts; over a step their work is
    at most 3 N GRAZE g sqrt(2 E sum m) dt. The others add up to at most B^2 g, since the acceleration
    differs from gravity by the least that keeps gaps from closing (Gauss), which is at most B g.
    Rounding: N + 2 operations on each impulse and force of a ball, twice; two for each of a series'
    ORDER + 1 terms, which add up to at most 9 E in the height and 6 E in the speed of a flight. A
    series is cut where the rates of its last terms are CUT sqrt(g r): that times the momentum, as if
    what follows were as large. Not derived: where balls slide, gaps are made 0 instead of >= 0; the
    same is allowed, though contacts that almost depend on one another could need more. A fixed ball
    cannot be blown away, so of scenes with one nothing is said.
    """
    if trial.overlaps or trial.fixed.any():
        return SKIPPED
    run = trial.run("exact")
    rise = np.diff(contact.energy(run.q, run.v, trial.mass))
    each, still, size = energy_of_nothing(trial, run)
    allowed = trial.exact[1] * each + still
    over = rise > allowed
    if over.any():
        k = int(over.argmax())
        return f"step {k}: E rises by {rise[k]:.3g} of {size:.3g} J, allowed {allowed[k]:.3g} J"
    return {"rise": float(rise.max(initial=0.0)) / size}


@check
def exact_rises_among_pegs(trial):
    """exact: by how much E rises where balls are fixed. A count: no bound is derived there."""
    if trial.overlaps or not trial.fixed.any() or trial.fixed.all():
        return SKIPPED
    run = trial.run("exact")
    total = contact.energy(run.q, run.v, trial.mass)
    return {"rise": float(np.diff(total).max(initial=0.0) / total[0])}


@check
def exact_keeps_its_energy_from_event_to_event(trial):
    """exact: in a step without an event E neither rises nor falls: contacts do no work.

    Bound: that of a rise, without what events add.
    """
    if trial.overlaps or trial.fixed.any():
        return SKIPPED
    run = trial.run("exact")
    change = np.abs(np.diff(contact.energy(run.q, run.v, trial.mass)))
    _, still, size = energy_of_nothing(trial, run)
    over = (change > still) & (trial.exact[1] == 0)
    if over.any():
        k = int(over.argmax())
        return f"step {k}: E changes by {change[k]:.3g} of {size:.3g} J without an event"
    return None


def energy_of_nothing(trial, run):
    """(what exact may gain in an event [J], and in each step without one (steps,), the energies)."""
    mass, g, dt, n = trial.mass, -contact.GRAVITY, trial.dt, len(trial.mass)
    total = float(mass.sum())
    size = float(contact.energy(run.q[0], run.v[0], mass))  # nothing has more later
    momentum, fastest = np.sqrt(2 * size), np.sqrt(2 * size / mass.min())  # of all; of one ball
    blow = blown_up(trial, run.q[:-1]) + dt * momentum / trial.scene.radius.min()
    widest = float(trial.scene.radius.max())
    gap = exact.TOUCH * widest + 8 * U * float(np.abs(run.q).max())
    lifted = g * np.sqrt(total) * gap * blow
    struck = 2 * momentum * blow * (exact.NOISE * np.sqrt(g * widest) + 4 * (n + 2) * U * fastest)
    dropped = 3 * n * exact.GRAZE * g * np.sqrt(total) * momentum * dt
    pressed = 4 * (n + 2) * U * g * blow**2 * fastest * dt
    read = (30 * (exact.ORDER + 1) + 4 * (n + 2)) * U * size
    cut = exact.CUT * np.sqrt(g * widest * total) * momentum
    return lifted + struck + read + cut, dropped + pressed + 2 * read + cut, size


def blown_up(trial, q):
    """The norm of the masses of blowing up the states q (S, 2, N) by 1 / r about the table."""
    middle = (trial.mass * q[:, 0]).sum(-1, keepdims=True) / trial.mass.sum()
    away = (q[:, 0] - middle) ** 2 + q[:, 1] ** 2
    return np.sqrt((trial.mass * away).sum(-1)) / trial.scene.radius.min()


@check
def exact_flies_where_nothing_touches(trial):
    """exact: a ball that nothing can reach within a step follows its parabola through that step.

    It moves by |v| dt + g dt^2 / 2 at most, another ball by dt times the speed that all the energy
    there is would give it. Bound: a sample is read from a parabola that started at some time of the
    run, by Horner's rule, so four times 5 U of the largest it can add up to, and of the rates.
    """
    if trial.overlaps or trial.fixed.all():
        return SKIPPED
    run, dt, g, moves = trial.run("exact"), trial.dt, -contact.GRAVITY, ~trial.fixed
    alone = untouched(trial, run)
    if not alone[:, moves].any():
        return SKIPPED
    q, v = run.q[:-1] + dt * run.v[:-1], run.v[:-1].copy()
    q[:, 1] -= 0.5 * g * dt * dt
    v[:, 1] -= g * dt
    fastest, span = top_speed(trial, run), float(run.t[-1])
    size = np.abs(run.q).max() + fastest * span + 0.5 * g * span * span
    for name, want, got, most in (("q", q, run.q, size), ("v", v, run.v, fastest + g * span)):
        off = (np.abs(got[1:] - want).max(1) - 20 * U * most)[:, moves]
        if (off[alone[:, moves]] > 0.0).any():
            k, ball = np.argwhere((off > 0.0) & alone[:, moves])[0]
            return f"step {k}: {name} of ball {np.flatnonzero(moves)[ball]} leaves its parabola"
    return None


def top_speed(trial, run):
    """How fast each ball can be with all the energy of the start [m/s] (N,); 0 if it is fixed."""
    most = float(contact.energy(run.q[0], run.v[0], trial.mass))
    return np.where(trial.fixed, 0.0, np.sqrt(2 * most / np.where(trial.fixed, 1.0, trial.mass)))


def untouched(trial, run):
    """Whether nothing can reach a ball in a step (steps, N)."""
    q, r, dt = run.q[:-1], trial.scene.radius, trial.dt
    far = np.linalg.norm(run.v[:-1], axis=1) * dt - 0.5 * contact.GRAVITY * dt * dt
    alone = q[:, 1] - r > far
    for lag in range(1, len(r)):
        other = np.roll(np.arange(len(r)), lag)
        apart = np.linalg.norm(q - q[:, :, other], axis=1) - r - r[other]
        alone &= apart > far + dt * top_speed(trial, run)[other]
    return alone


@check
def exact_does_not_know_dt(trial):
    """exact: half as many samples are the same bits. A sample is read out, it changes nothing.

    Looked at where the run has at most FEW_EVENTS events.
    """
    if "exact" not in trial.again():
        return SKIPPED
    half = trial.judged // 2
    run, other = trial.run("exact"), trial.run("exact", dt=2 * trial.dt, steps=half)
    return unlike("exact", contact.Run(*(row[: 2 * half + 1 : 2] for row in run)), other)


@check
def exact_ends(trial):
    """exact: how many runs are cut short, since they take longer than SECONDS of CPU time.

    A limit of time: balls of a heap that rattle against one another have many events, and one event
    of many balls takes long. What comes before is judged as any run is.
    """
    if trial.overlaps:
        return SKIPPED
    left = trial.judged / trial.spec["steps"]
    return None if left == 1.0 else {"cut": 1.0 - left}


# --- what the checks share ----------------------------------------------------------------------


def gaps(q, radius):
    """Every gap [m] in states (S, 2, N): to the floor and between pairs, (S, N + pairs)."""
    i, j = np.triu_indices(len(radius), 1)
    apart = np.hypot(q[:, 0, i] - q[:, 0, j], q[:, 1, i] - q[:, 1, j])
    return np.concatenate((q[:, 1] - radius, apart - (radius[i] + radius[j])), axis=1)


def contact_count(trial, run):
    """Contacts within the margin at every state."""
    return (gaps(run.q, trial.scene.radius) < contact.CONTACT_MARGIN).sum(axis=1)


def kinetic(v, mass):
    """Kinetic energy [J] of velocities (S, 2, N)."""
    return 0.5 * (mass * (v[:, 0] ** 2 + v[:, 1] ** 2)).sum(axis=1)


def same(a, b):
    """Two arrays hold equal numbers (NaN equals NaN, 0 equals -0)."""
    return np.array_equal(a, b, equal_nan=True)


def unlike(model, run, other):
    """None when two runs are the same numbers, else where they part."""
    for name in ("q", "v"):
        a, b = getattr(run, name), getattr(other, name)
        if not same(a, b):
            step, axis, ball = (int(k[0]) for k in np.nonzero(~((a == b) | (a != a) & (b != b))))
            pair = f"{float(a[step, axis, ball])!r} and {float(b[step, axis, ball])!r}"
            return f"{model}, {name}, step {step}, {'xy'[axis]} of ball {ball}: {pair}"
    return None


# --- jobs ---------------------------------------------------------------------------------------


def outcomes(spec, only=None):
    """{check: None, SKIPPED, what was counted, or words for a violation} on this spec."""
    trial, found = Trial(spec), {}
    for name, function in CHECKS.items():
        if only and name not in only:
            continue
        try:
            with np.errstate(all="ignore"):
                found[name] = function(trial)
        except Exception as error:
            found[name] = f"{type(error).__name__}: {error}"
    return found


def violations(found, label, spec):
    """Rows for the checks that failed, each with the job that reproduces it."""
    return [
        jobs.row(f"{name}, {label}", CHECKS[name].__doc__.splitlines()[0], words, ok=False)
        | {"case": jobs.job("scene", name, spec=spec)}
        for name, words in found.items()
        if isinstance(words, str)
    ]


def run_scene(spec):
    """Result of a job on one scene."""
    return {"cells": len(contact.MODELS), "rows": violations(outcomes(spec), "this scene", spec)}


def run_batch(start, stop):
    """Result of a job on the random scenes numbered start to stop - 1 (`batch`)."""
    return batch("scene", scenes.numbered_spec, start, stop, CHECKS, len(contact.MODELS))


def run_boards(start, stop):
    """Result of a job on the boards numbered start to stop - 1, of exact alone (`batch`)."""
    only = [name for name in CHECKS if name.startswith("exact")]
    return batch("board", scenes.board_spec, start, stop, only, 1)


def batch(word, numbered, start, stop, only, runs):
    """What these checks say of the specs that numbered(start) to numbered(stop - 1) are.

    applied: {check: number of scenes it says something about}; counted: {check: [[scene, what]]}.
    """
    rows, applied = [], dict.fromkeys(only, 0)
    counted = {}
    for number in range(start, stop):
        spec = numbered(number)
        found = outcomes(spec, only)
        rows += violations(found, f"{word} {number}", spec)
        for name, outcome in found.items():
            applied[name] += outcome is not SKIPPED
            if isinstance(outcome, dict):
                counted.setdefault(name, []).append([number, outcome])
    return {
        "cells": runs * (stop - start),
        "rows": rows,
        "applied": applied,
        "counted": counted,
    }
