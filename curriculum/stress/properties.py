"""What must hold on any scene: stated once, for the tests and for ten thousand numbered scenes.

A property is a generator of claims (words, off, allowed, where). off, allowed: arrays of what was
found to be off, and of what rounding explains; where: which of them are judged, all if it is left
out. It claims nothing where nothing could fail.

The laws stand here in the chapter's formulas, and are held against what the steps did (trial.py).
Bounds are U times the number of operations times the size of what is added; where a bound is not
derived so, it says so. Those of exact are its promises, and it is judged where it gives any.
"""

import inspect
import itertools
import math

import numpy as np

import contact
from curriculum.stress import laws, scenes
from curriculum.stress.trial import STEPPED, G, Trial, U

WAYS = "plain", "skips", "twin"  # of taking the same steps
NOTABLE = 1e-9  # share of the energy; what unfinished sweeps add ends below it
MOST = 2**17  # sweeps, by which it must have ended
PROMISE = 1e-12  # of exact: of a radius, and of the energy at the start
NEAR = 1e-9  # share of the sizes that a flight or an impact in closed form may be off
AT_ONCE, SOON = 1e-12, 1e-8  # s after the start, by when contacts gave impulses, and forces
LOOSE = 1e-6  # share of what forces give that may be off, beside what normals turn by then
SLOW = 1e-6  # of sqrt(a r), a what brings it back: exact may take a slower bounce for the last
UNFINISHED = "lcp: unfinished sweeps add energy, without any push of Baumgarte's"


def judge(subject, *properties):
    """{property: [comparisons, off as a share of what is allowed at worst, words or None]}.

    comparisons: how many numbers could have failed; 0 where the property says nothing of the
    subject. words: the first claim that does not hold. An error of the code under test is a
    violation too.
    """
    found = {}
    for function in properties:
        found[function.__name__] = row = [0, 0.0, None]
        try:
            with np.errstate(all="ignore"):
                for claim in function(subject):
                    compare(row, *claim)
        except Exception as error:
            row[0], row[2] = row[0] + 1, f"{type(error).__name__}: {error}"
    return found


def compare(row, words, off, allowed, where=True):
    """Add a claim to the row of its property. What is not a number does not hold."""
    off, allowed, where = np.broadcast_arrays(np.asarray(off, float), allowed, where)
    row[0] += int(where.sum())
    share = np.where(off == 0.0, 0.0, off / allowed)[where]
    row[1] = float(np.nan_to_num(share, nan=np.inf).max(initial=row[1]))
    wrong = where & ~(off <= allowed)
    if wrong.any() and row[2] is None:
        place = tuple(np.argwhere(wrong)[0].tolist())
        row[2] = f"{words}: off by {off[place]:.3g}, allowed {allowed[place]:.3g} at {place}"


def unlike(run, other):
    """The claim that two runs have the same bits: (1 for each number that differs, 0)."""
    a, b = (np.concatenate((each.q, each.v), axis=1) for each in (run, other))
    return ~((a == b) | (a != a) & (b != b)), 0.0


def beside_one_that_overflows(trial):
    """The changes that add a ball which overflows at once, and is NaN from then on."""
    odd = {"x": 3.0, "y": -1e307, "vx": 0.0, "vy": 0.0, "mass": 1.0, "radius": 0.1}
    return {name: [*trial.spec[name], value] for name, value in odd.items()}


def finite_or_said_to_have_exploded(trial):
    """Every number of a run is finite, or contact_quality says that it blew up, and when."""
    odd = [beside_one_that_overflows(trial)] if len(trial.mass) <= 2 else []
    for model, more in itertools.product(STEPPED, ({}, *odd)):
        run = trial.run(model, **more)
        scene = scenes.to_scene(trial.spec | more)
        quality = contact.contact_quality(run, scene, trial.dt)
        finite = np.isfinite(run.q).all() and np.isfinite(run.v).all()
        told = quality["blew_up"] and quality["blew_up_step"] is not None
        yield f"{model} is not finite, and that is not said", not (finite or told), 0.0
    if trial.exact:
        yield "exact is not finite", trial.exact.astray, 0.0


def a_skip_changes_no_bit(trial):
    """The compiled twin and the skips of contact.py give the bits of its plain steps; also beside a
    ball that is NaN, and where two balls that start far from each other meet.
    """
    scenes_of = {"": {"steps": 8}}
    if len(trial.mass) <= 2:
        scenes_of |= {" beside NaN": beside_one_that_overflows(trial), " from afar": afar(trial)}
    for (where, changes), model in itertools.product(scenes_of.items(), STEPPED):
        plain, *others = (trial.run(model, way, **changes) for way in WAYS)
        for way, other in zip(WAYS[1:], others):
            off = unlike(plain, other)[0]
            yield f"{way}{where}: {model}", off, 0.0


def afar(trial):
    """The changes that make a scene of two balls, no neighbours, that fly into each other."""
    r, steps = 0.1, trial.spec["steps"]
    half, speed = r + r * steps / 80, r / 40 / trial.dt
    pair = {"x": [-half, half], "y": [50.0, 50.0], "vx": [speed, -speed], "vy": [0.0, 0.0]}
    return pair | {"mass": [1.0, 1.0], "radius": [r, r], "steps": 90}


def a_far_ball_changes_nothing(trial):
    """One more ball, at rest on the table a kilometre away, leaves the bits of the others alone.

    For soft, whose sweeps stop on the scale of all speeds, and for leapfrog, whose momentum is that
    of all impulses, that ball is a fixed one.
    """
    extra = {"x": max(trial.spec["x"]) + 1e3, "y": 0.1, "vx": 0.0, "vy": 0.0, "radius": 0.1}
    for model in STEPPED:
        motion = trial.motions[model]
        if motion.listed.any() and len(motion.push) == trial.spec["steps"]:
            one = extra | {"mass": np.inf if model in ("soft", "leapfrog") else 1.0}
            more = {name: [*trial.spec[name], value] for name, value in one.items()}
            other = trial.run(model, **more)
            other = other._replace(q=other.q[..., :-1], v=other.v[..., :-1])
            yield model, *unlike(trial.run(model), other)


def what_nothing_touches_falls(trial):
    """Stepped models: v + dt g without a contact; q + dt v always, of leapfrog without a contact,
    and with the mean of v before and after. Bound: 4 U of what is added.
    """
    for model, motion in trial.motions.items():
        free = (motion.count == 0) & ~trial.fixed
        speed = np.abs(motion.v[1:]) + np.abs(motion.v[:-1]) + trial.dt * G
        yield f"{model}, fall", np.abs(motion.v[1:] - motion.falling), 4 * U * speed, free
        way, moves = trial.dt * motion.v[1:], True
        if model == "leapfrog":
            way, moves = 0.5 * trial.dt * (motion.v[1:] + motion.v[:-1]), free
        off = np.abs(motion.q[1:] - motion.q[:-1] - way)
        size = np.abs(motion.q[1:]) + np.abs(motion.q[:-1]) + trial.dt * speed
        yield f"{model}, move", off, 4 * U * size, moves


def springs_push_as_hooke_and_the_damper_say(trial):
    """Penalty: each contact gives max(0, k depth - c v_n) dt, at equal and opposite, and no more.

    Bound: 8 U of the lengths that make a depth, of the speeds that make a v_n, and of the sums.
    """
    motion = trial.motions["penalty"]
    force, allowed = laws.spring_force(trial, motion)
    off = np.abs(motion.push - motion.total(motion.dt * force))
    yield "impulse [N s]", off, allowed, motion.pushed


def contacts_push_along_their_normals_and_never_pull(trial):
    """Stepped models: what contacts did in a step is a sum of pushes along their normals, equal and
    opposite, and of no pull. Bound: 8 U a push.

    leapfrog has two normals for a contact: first lam along that of when they meet, then what is
    missing to the last lam along that of now; neither lam is below 0.
    """
    sweeps = {"penalty": 1, "lcp": trial.spec["iters"], "soft": laws.SWEEPS}
    sweeps["leapfrog"] = 4 * trial.spec["iters"]  # two solves, in which a sweep is carried on
    for model, motion in trial.motions.items():
        for k in sampled(motion):
            on = motion.listed[k]
            n = laws.directions(motion, motion.normals[k], on)
            if model == "leapfrog":
                now = laws.directions(motion, motion.normals[k + 1], on)
                n = np.hstack((laws.directions(motion, laws.meeting(motion, k), on) - now, now))
            allowed = 8 * U * (sweeps[model] + 2) * on.sum()
            off = laws.unexplained(motion.push[k], n, motion.size[k, 0])
            yield f"{model}, not explained, step {k}", off, allowed


def enough_sweeps_solve_lcp(trial):
    """lcp: 2^14 sweeps lead to the velocities of another solver.

    Judged where W is far from singular: where contacts depend on one another, impulses may wander
    for long before a velocity shows it. Bound: a hundred times what the latter half of these sweeps
    still moves, which is not derived; 1e-11 of the speeds, chosen, is for the rounding of both.
    """
    motion = trial.motions["lcp"]
    target = laws.lcp_target(motion, trial.spec)
    for k in sampled(motion):
        on, top = motion.listed[k], motion.top[k].max()
        n = laws.directions(motion, motion.normals[k], on)
        if not laws.far_from_singular(n, motion.mass):
            continue
        start = scenes.state(motion.q[k], motion.v[k])
        less, more = (trial.run("lcp", **start, steps=1, iters=2**m).v[1] for m in (13, 14))
        moved = 100 * np.abs(more - less).max()
        if moved > NOTABLE * top:
            trial.note("lcp: a step that 16,384 sweeps do not solve")
            continue
        solved = laws.nearest(n, target[k, on], motion.falling[k].ravel(), motion.mass)
        off = np.abs(more.ravel() - solved)
        yield f"solved [m/s], step {k}", off, moved + 1e-11 * top


def sampled(motion):
    """Up to two steps with contacts: that of the deepest overlap, and the last."""
    touching = np.flatnonzero(motion.listed.any(1))
    if not len(touching):
        return []
    deepest = np.where(motion.listed, motion.depth, -np.inf).max(1).argmax()
    return sorted({int(deepest), int(touching[-1])})


def lcp_gains_energy_by_unfinished_sweeps_alone(trial):
    """lcp without gain, cold: F = E + e/(1+e) dt sum m g v_y rises by what the sweeps leave undone.

    In the norm of the masses, with D = v' - v: E' - E = lam.J v' - |D|^2 / 2. With targets of at
    most -e J v this gives F' - F <= lam.w / (1+e) - (1-e)/(1+e) |D|^2 / 2, and lam.w = 0 once the
    sweeps are done. So the step with the largest rise is taken again with more sweeps, until it is
    below NOTABLE: a limit of the model, noted with its size; an overdue end is a violation.
    """
    free = Trial(trial.spec | {"baumgarte": 0.0, "warm": 0.0})
    motion, e = free.motions["lcp"], trial.spec["restitution"]
    rise, size = laws.rises(motion, motion, e)
    if not motion.listed.any():
        return
    k = int((rise - NOTABLE * size).argmax())
    sweeps, left, start = trial.spec["iters"], rise[k], scenes.state(motion.q[k], motion.v[k])
    while left > NOTABLE * size[k] and sweeps < MOST:
        sweeps *= 2
        left = laws.rises(free.run("lcp", **start, steps=1, iters=sweeps), motion, e)[0][0]
    if sweeps > trial.spec["iters"]:
        total = contact.energy(motion.q, motion.v, motion.mass)
        trial.note(UNFINISHED, sweeps=sweeps, start=total[0], most=total.max())
    yield f"rise [J] with {sweeps} sweeps", left, NOTABLE * size[k]


def an_impact_alone_returns_e_of_the_speed(trial):
    """lcp, and soft where it bounces: alone and closing, v_n' is -e v_n, and gravity adds nothing.
    leapfrog on the table: -e of the speed at the impact, and then gravity until the step's end.

    Judged where the bounce is faster than gravity and Baumgarte's push. 8 U a sweep; soft: its
    hardest contact gives way by R lam, at most 2e-4 of the speeds.
    """
    e, solref, beta = (trial.spec[name] for name in ("restitution", "solref", "baumgarte"))
    exact_to = {"lcp": 8 * U * (trial.spec["iters"] + 4)}
    exact_to |= {"leapfrog": 4 * exact_to["lcp"]} | ({"soft": 2.1e-4} if solref is None else {})
    for model, share in exact_to.items() if e > 0.0 else ():
        motion = trial.motions[model]
        back, depth, dt = -e * motion.before, motion.depth, motion.dt
        fair = motion.alone & (motion.before < 0.0) & (back > motion.along(motion.falling))
        if model == "lcp":
            fair &= (back > beta / dt * depth) & (dt * motion.before < depth)
        elif model == "leapfrog":
            hit = np.sqrt(motion.before**2 - 2.0 * G * depth)
            left = dt - (hit + motion.before) / G
            back = e * hit - left * G
            fair &= (depth < 0.0) & (left > 0.0) & (hit > dt * G) & (e * hit > left * G / 2)
            fair[:, len(motion.mass) :] = False
        size = motion.speeds + dt * G
        yield f"{model}, v_n [m/s]", np.abs(motion.after - back), share * size, fair


def leapfrog_adds_no_energy_once_its_sweeps_are_done(trial):
    """leapfrog, e < 1, at 2 ms: balls that start apart never have more energy than at the start."""
    apart = contact.smallest_gap(trial.scene.q0[None], trial.scene.radius)[0] > 0.0
    if trial.spec["restitution"] == 1.0 or not apart or trial.fixed.any():
        return
    run = trial.run("leapfrog", dt=0.002, steps=300, iters=1000)
    total = contact.energy(run.q, run.v, trial.scene.mass)
    size = np.maximum(total[0], (trial.mass * G * trial.scene.radius).sum())
    yield "gained since the start [J]", np.maximum(total - total[0], 0.0), NOTABLE * size


def leapfrog_throws_nobody_out_of_another(trial):
    """leapfrog, e = 0: what starts in another is never faster than what it had, gravity, and for
    each ball the speed at which an overlap opens. That bound is chosen.
    """
    gap = contact.smallest_gap(trial.scene.q0[None], trial.scene.radius)[0]
    if gap < 0.0 and not trial.fixed.any():
        run = trial.run("leapfrog", dt=0.002, restitution=0.0, iters=200)
        opens = 2.0 * contact.OPENS * trial.scene.radius.max() / 0.002 * len(trial.mass)
        own = np.hypot(*trial.scene.v0).max() * math.sqrt(trial.mass.max() / trial.mass.min())
        fastest = np.hypot(run.v[:, 0], run.v[:, 1]).max(1)
        yield "speed [m/s]", fastest, own + opens + G * run.t + 1e-9


def two_free_balls_pass_or_bounce_in_closed_form(trial):
    """leapfrog: two balls in the air that miss fly on, and two that meet at any angle bounce with e
    at their own time. Left out: what grazes, and what meets slower than dt g. Bound: 1e-9 of the
    lengths and speeds, chosen.
    """
    rng = np.random.default_rng([len(trial.mass), trial.spec["steps"], int(1e9 * trial.dt)])
    radius, mass, steps, dt = rng.uniform(0.05, 0.2, 2), 10.0 ** rng.uniform(-1, 1, 2), 30, trial.dt
    n, e, reach = rng.standard_normal(2), trial.spec["restitution"], radius.sum()
    n /= np.hypot(*n)
    misses = rng.uniform(1.01, 1.4) if rng.random() < 0.5 else rng.uniform(0.0, 0.95)
    speed, s = rng.uniform(0.5, 10.0) + 5.0 * G * dt, rng.uniform(0.2, 0.8) * steps * dt
    v = np.array([-speed * n, 0.0 * n]) + rng.standard_normal(2)
    aside = misses * reach * np.array([-n[1], n[0]])  # of the two lines that they fly on
    along = math.sqrt(max(0.0, 1.0 - misses * misses)) * reach
    met = along * n + aside  # between the centres, when they meet or are nearest
    start = np.array([met, 0.0 * n]) - s * v + [0.0, 50.0]
    run = trial.run("leapfrog", steps=steps, restitution=e, **scenes.state(start.T, v.T),
                    mass=mass.tolist(), radius=radius.tolist())  # fmt: skip
    normal, v_n = met / reach, (v[0] - v[1]) @ met / reach
    if misses < 1.0 and -v_n < 2.0 * G * dt:
        return
    push = -(1.0 + e) * v_n / (1.0 / mass).sum() if misses < 1.0 else 0.0
    after, t = v + push * np.outer([1.0 / mass[0], -1.0 / mass[1]], normal), run.t[-1]
    q = start + s * v + (t - s) * after + [0.0, -0.5 * G * t * t]
    words = "bounce" if misses < 1.0 else "pass"
    yield f"{words}, q [m]", np.abs(run.q[-1].T - q), NEAR * (50.0 + speed * t)
    yield f"{words}, v [m/s]", np.abs(run.v[-1].T - after - [0.0, -G * t]), NEAR * (speed + G * t)


def exact_pushes_and_never_pulls(trial):
    """exact, where balls start in touch: the velocities after the impacts are those of another
    solver, and what forces give right afterwards is a sum of pushes along the normals, and of no
    pull. Bound: 1e-9 of the speeds, 1e-6 of what forces give, 1e-12 of the speeds a contact, all
    chosen, and what normals turn. Judged where no bounce is so slow that exact may take it for the
    last, since the forces bring it back at once.

    Forces that never pull, and with which nothing overlaps or gains energy, are the right ones.
    """
    motion, e = trial.exact, trial.spec["restitution"]
    on = motion and (np.abs(motion.depth[0]) < 1e-13) & (motion.inv_mass > 0.0)
    if not motion or not on.any():
        return
    n, bounced = laws.directions(motion, motion.normals[0], on), trial.scene.v0.ravel()
    for _ in range(1000):  # rounds of impacts
        v_n = n.T @ bounced
        if (v_n >= -1e-12 * motion.top.max()).all():
            break
        bounced = laws.nearest(n, -e * v_n, bounced, motion.mass)
    across = np.array((-motion.normal[0, 1], motion.normal[0, 0]))
    turn = ((bounced.reshape(2, -1) @ motion.sides.T) * across).sum(0) ** 2 / motion.reach
    turn[: len(motion.mass)] = 0.0  # the floor's normal stays
    back = on.sum() * G + turn[on].sum()  # about the largest acceleration
    slow = v_n < SLOW * math.sqrt(back * motion.reach[on].max())
    if (slow & (v_n > 1e-12 * motion.top.max())).any():
        return
    after, later = (trial.run_exact(t, 1) for t in (AT_ONCE, SOON))
    if after and len(after.t) > 1:
        off = np.abs(after.v[1].ravel() - bounced)
        yield "velocity after the impacts [m/s]", off, NEAR * motion.top.max()
    if later and len(later.t) > 1:
        near = (motion.depth[0] > -2.0 * SOON * motion.top.max()) & (motion.inv_mass > 0.0)
        n = laws.directions(motion, motion.normals[0], near)
        gained = later.v[1] - bounced.reshape(2, -1) - np.outer((0.0, -G * SOON), ~trial.fixed)
        turned = SOON * motion.top.max() / motion.reach.min()
        off = laws.unexplained(motion.mass * gained, n, motion.mass)
        allowed = (LOOSE + turned) * np.abs(gained).max() + PROMISE * on.sum() * motion.top.max()
        yield "not explained [m/s]", off, allowed


def exact_never_overlaps(trial):
    """exact: no overlap at any sample above 1e-12 of the largest radius."""
    if trial.exact and struck(trial.exact).any():
        gap = contact.smallest_gap(trial.exact.q[1:], trial.scene.radius)
        yield "overlap [m]", np.maximum(-gap, 0.0), PROMISE * trial.scene.radius.max()


def struck(motion):
    """In which steps some velocity shows more than gravity (S,)."""
    return (np.abs(motion.v[1:] - motion.falling) > 1e-9).any((1, 2))


def exact_keeps_its_energy(trial):
    """exact: no energy above 1e-12 of the start's is ever gained, with e = 1 none is lost, and
    where nothing is fixed sum m v_x stays, to 1e-12 of what the energy allows.
    """
    if trial.exact and not trial.fixed.all():
        v, mass = trial.exact.v, trial.mass
        total = contact.energy(trial.exact.q, v, trial.scene.mass)
        size, on = PROMISE * laws.start_energy(trial), struck(trial.exact)
        yield "gained since the start [J]", np.maximum(total[1:] - total[0], 0.0), size, on
        yield "gained in a step [J]", np.maximum(np.diff(total), 0.0), size, on
        if trial.spec["restitution"] == 1.0:
            yield "lost with e = 1 [J]", np.abs(total[1:] - total[0]), size, on
        if not trial.fixed.any():
            momentum = (mass * v[:, 0]).sum(1)
            most = np.sqrt(2.0 * mass.sum() * laws.start_energy(trial))
            yield "momentum [kg m/s]", np.abs(momentum[1:] - momentum[0]), PROMISE * most, on


# every generator of this file
PROPERTIES = {name: each for name, each in vars().items() if inspect.isgeneratorfunction(each)}
