"""What must hold on any scene: stated once, for the tests and for ten thousand numbered scenes.

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
from curriculum.stress.claims import unlike
from curriculum.stress.trial import STEPPED, G, Trial, U, inverse

WAYS = "plain", "skips", "twin"  # of taking the same steps
NOTABLE = 1e-9  # share of the energy; what unfinished sweeps add ends below it
MOST = 2**17  # sweeps, by which it must have ended
PROMISE = 1e-12  # of exact: of a radius, and of the energy at the start
NEAR = 1e-9  # share of the sizes that a flight or an impact in closed form may be off
TINY = 1e-6  # s: forces are read from what they do in so short a time
LOOSE = 1e-5  # share of the accelerations that are read so
SLOW = 1e-6  # of sqrt(a r), a what brings it back: exact may take a slower bounce for the last
AHEAD = {"ahead": True, "baumgarte": 1.0, "restitution": 0.0, "warm": 0.0}
PUBLISHED = AHEAD | {"ahead": False, "baumgarte": 0.2}
DEPTHS = "lcp: deepest overlap of balls that start apart"
UNFINISHED = "lcp: unfinished sweeps add energy, without any push of Baumgarte's"


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
    models = *((model, {}) for model in STEPPED), ("lcp", AHEAD)
    for (where, changes), (model, more) in itertools.product(scenes_of.items(), models):
        plain, *others = (trial.run(model, way, **changes | more) for way in WAYS)
        for way, other in zip(WAYS[1:], others):
            off = np.append(unlike(plain, other)[0], plain.unsettled != other.unsettled)
            yield f"{way}{where}: {model}{' ahead' * bool(more)}", off, 0.0


def afar(trial):
    """The changes that make a scene of two balls, no neighbours, that fly into each other."""
    r, steps = 0.1, trial.spec["steps"]
    half, speed = r + r * steps / 80, r / 40 / trial.dt
    pair = {"x": [-half, half], "y": [50.0, 50.0], "vx": [speed, -speed], "vy": [0.0, 0.0]}
    return pair | {"mass": [1.0, 1.0], "radius": [r, r], "steps": 90}


def a_mirrored_scene_runs_mirrored(trial):
    """x -> -x gives the mirrored run, the same bits: no operation depends on the sign of x."""
    flipped = {name: [-value for value in trial.spec[name]] for name in ("x", "vx")}
    mirror = np.array([[-1.0], [1.0]])
    for model in STEPPED:
        run, other = trial.run(model), trial.run(model, **flipped)
        if trial.motions[model].listed.any():
            yield model, *unlike(run, other._replace(q=other.q * mirror, v=other.v * mirror))


def a_run_can_be_taken_up_anywhere(trial):
    """A step of penalty, and of lcp cold, depends on the state alone: again the same bits."""
    half = trial.spec["steps"] // 2
    for model in ("penalty", "lcp") if trial.spec["warm"] == 0.0 else ("penalty",):
        run = trial.run(model)
        if trial.motions[model].listed[half:].any():
            start = scenes.state(run.q[half], run.v[half])
            again = trial.run(model, **start, steps=trial.spec["steps"] - half)
            yield model, *unlike(contact.Run(again.t, run.q[half:], run.v[half:]), again)


def a_far_ball_changes_nothing(trial):
    """One more ball, at rest on the table a kilometre away, leaves the bits of the others alone.

    For soft, whose sweeps stop on the scale of all speeds, that ball is a fixed one.
    """
    extra = {"x": max(trial.spec["x"]) + 1e3, "y": 0.1, "vx": 0.0, "vy": 0.0, "radius": 0.1}
    for model in STEPPED:
        motion = trial.motions[model]
        if motion.listed.any() and len(motion.push) == trial.spec["steps"]:
            one = extra | {"mass": np.inf if model == "soft" else 1.0}
            more = {name: [*trial.spec[name], value] for name, value in one.items()}
            other = trial.run(model, **more)
            other = other._replace(q=other.q[..., :-1], v=other.v[..., :-1])
            yield model, *unlike(trial.run(model), other)


def renumbering_the_balls_renumbers_the_run(trial):
    """Balls in the opposite order do the same in a step of penalty, soft and exact.

    The sweeps of lcp have an order, which is part of its answer. Bounds: those of the pushes; for
    exact 1e-9 of the speeds, not derived.
    """
    turned = {name: trial.spec[name][::-1] for name in scenes.BODY}
    for model, law in (("penalty", laws.spring_force), ("soft", laws.soft_force)):
        motion = trial.motions[model]
        if motion.listed[:1].any() and not motion.unsettled:
            other = trial.run(model, **turned, steps=1)
            off = np.abs(other.v[1][:, ::-1] - motion.v[1])
            yield f"{model}, v [m/s]", off, 2.0 * law(trial, motion)[1][0] * inverse(motion.mass)
    other = trial.exact and struck(trial.exact)[:1].any() and trial.brief(trial.dt, 1, **turned)
    if other:
        off = np.abs(other.v[1][:, ::-1] - trial.exact.v[1])
        yield "exact, v [m/s]", off, NEAR * trial.exact.top[0]


def momentum_along_x_is_kept(trial):
    """The floor pushes up only, so sum m v_x stays where nothing is fixed. Bound: 8 U a push; for
    exact 1e-12 of what the energy allows.

    A step of lcp or soft has a push for each pair in every sweep.
    """
    if trial.fixed.any() or len(trial.mass) == 1:
        return
    sweeps = {"penalty": 1, "lcp": trial.spec["iters"], "soft": laws.SWEEPS}
    for model, motion in trial.motions.items():
        pairs = motion.listed[:, len(trial.mass) :].sum(1)
        off = np.abs((motion.mass * np.diff(motion.v[:, 0], axis=0)).sum(1))
        allowed = 8 * U * (sweeps[model] * pairs + 2) * motion.size[:, 0].sum(1)
        yield model, off, allowed, pairs > 0
    if trial.exact:
        momentum = (trial.mass * trial.exact.v[:, 0]).sum(1)
        pushed = np.abs(np.diff(trial.exact.v[:, 0], axis=0)).max(1) > 0.0
        size = np.sqrt(2.0 * trial.mass.sum() * laws.start_energy(trial))
        yield "exact", np.abs(momentum[1:] - momentum[0]), PROMISE * size, pushed


def what_nothing_touches_falls(trial):
    """Stepped models: v + dt g without a contact, q + dt v always. Bound: 4 U of what is added."""
    for model, motion in trial.motions.items():
        free = (motion.count == 0) & ~trial.fixed
        speed = np.abs(motion.v[1:]) + np.abs(motion.v[:-1]) + trial.dt * G
        yield f"{model}, fall", np.abs(motion.v[1:] - motion.falling), 4 * U * speed, free
        moved = np.abs(motion.q[1:] - motion.q[:-1] - trial.dt * motion.v[1:])
        yield f"{model}, move", moved, 4 * U * (np.abs(motion.q[1:]) + np.abs(motion.q[:-1]))


def springs_push_as_hooke_and_the_damper_say(trial):
    """Penalty: each contact gives max(0, k depth - c v_n) dt, at equal and opposite, and no more.

    Bound: 8 U of the lengths that make a depth, of the speeds that make a v_n, and of the sums.
    """
    motion = trial.motions["penalty"]
    force, allowed = laws.spring_force(trial, motion)
    off = np.abs(motion.push - motion.total(motion.dt * force))
    yield "impulse [N s]", off, allowed, motion.pushed


def other_units_give_the_same_run(trial):
    """Penalty: lengths x 4, times x 2, masses x 8 (gravity stays) scale the run, the same bits."""
    factors = {"x": 4.0, "y": 4.0, "radius": 4.0, "vx": 2.0, "vy": 2.0, "mass": 8.0}
    other = {name: [f * value for value in trial.spec[name]] for name, f in factors.items()}
    other |= {"dt": 2.0 * trial.dt, "stiffness": 2.0 * trial.spec["stiffness"]}
    other |= {"damping": 4.0 * trial.spec["damping"]}
    run, motion = trial.run("penalty"), trial.motions["penalty"]
    if motion.listed.any() and len(motion.push) == trial.spec["steps"]:
        scaled = trial.run("penalty", **other)
        yield "penalty", *unlike(run, contact.Run(run.t, scaled.q / 4.0, scaled.v / 2.0))


def a_contact_alone_leaves_at_its_target(trial):
    """lcp: a contact with no neighbour leaves at max(v_n after gravity, target).

    Bound: 8 U a sweep of the speeds, and of the lengths that make the target.
    """
    motion = trial.motions["lcp"]
    target, predicted = laws.lcp_target(motion, trial.spec), motion.along(motion.falling)
    off = np.abs(motion.after - np.maximum(predicted, target))
    lengths = motion.lengths / motion.dt
    speeds = (trial.spec["iters"] + 4) * motion.speeds + np.abs(target)
    clear = motion.alone & (np.abs(motion.depth) > 8 * U * motion.reach)
    yield "v_n [m/s]", off, 8 * U * (speeds + lengths), clear


def lcp_never_pulls_and_enough_sweeps_solve_it(trial):
    """lcp: the impulses that explain what was done are >= 0, whatever the sweeps; and 2^14 of them
    lead to the velocities of another solver.

    Judged where one set of impulses explains it, and W is far from singular: where contacts depend
    on one another, impulses may wander for long before a velocity shows it. Bound: 8 U a push, and
    a hundred times what the latter half of these sweeps still moves, which is not derived; 1e-11 of
    the speeds, chosen, is for the rounding of both solvers.
    """
    motion, sweeps = trial.motions["lcp"], trial.spec["iters"]
    target = laws.lcp_target(motion, trial.spec)
    for k in sampled(motion):
        on, top = motion.listed[k], motion.top[k].max()
        n = laws.directions(motion, k, on)
        if not laws.far_from_singular(n, motion.mass):
            continue
        lam, rest = np.linalg.lstsq(n, motion.push[k].ravel(), rcond=None)[:2]
        rounded = 8 * U * on.sum() * motion.size[k].sum() / np.linalg.svd(n)[1][-1]
        yield f"pulled [N s], step {k}", np.maximum(-lam, 0.0), (sweeps + 2) * rounded
        yield f"not explained [N s], step {k}", np.sqrt(rest), (sweeps + 2) * rounded
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


def soft_pushes_as_mujoco_says(trial):
    """soft: lam = max(0, (target - v_n') / R) at each contact, and these give the whole push.

    v_n' + R lam = target where a contact pushes, so lam is read from what was done, and every step
    is judged. Bound: what a settled sweep may leave (LAST_BITS of the speeds, from each neighbour),
    over R; and 8 U a push. Steps said to be unsettled may be off, but not more of them than said.
    """
    motion = trial.motions["soft"]
    if not motion.listed.any():
        return
    lam, allowed = laws.soft_force(trial, motion)
    off = np.abs(motion.push - motion.total(lam)) * (motion.mass > 0.0)
    if motion.unsettled:
        trial.note("soft: steps whose sweeps did not settle", steps=motion.unsettled)
        beyond = (~(off <= allowed)).any((1, 2)).sum()
        yield "steps off beyond those unsettled", beyond, motion.unsettled
    else:
        yield "impulse [N s]", off, allowed, motion.pushed


def an_impact_alone_returns_e_of_the_speed(trial):
    """lcp, and soft where it bounces: alone and closing, v_n' is -e v_n, and gravity adds nothing.

    Judged where the bounce is faster than gravity and Baumgarte's push. lcp: 8 U a sweep. soft: its
    hardest contact gives way by R lam, at most 2e-4 of the speeds.
    """
    e, solref = trial.spec["restitution"], trial.spec["solref"]
    for model, share in (("lcp", 8 * U * (trial.spec["iters"] + 4)), ("soft", 2.1e-4)):
        motion = trial.motions[model]
        back, bias = -e * motion.before, trial.spec["baumgarte"] / motion.dt * motion.depth
        fair = motion.alone & (back > motion.along(motion.falling)) & (motion.before < 0.0)
        if model == "lcp":
            fair &= (back > bias) & (motion.dt * motion.before < motion.depth)
        if e > 0.0 and (model == "lcp" or solref is None):
            size = motion.speeds + motion.dt * G
            yield f"{model}, v_n [m/s]", np.abs(motion.after - back), share * size, fair


def looking_ahead_adds_no_energy_where_balls_start_apart(trial):
    """lcp ahead, gain 1, e = 0: balls that start apart never have more energy than at the start."""
    if contact.smallest_gap(trial.scene.q0[None], trial.scene.radius)[0] < 0.0:
        return
    ahead, today = (trial.run("lcp", **knobs, steps=300) for knobs in (AHEAD, PUBLISHED))
    total = contact.energy(ahead.q, ahead.v, trial.scene.mass)
    size = np.maximum(total[0], (trial.mass * G * trial.scene.radius).sum())
    yield "gained since the start [J]", np.maximum(total - total[0], 0.0), NOTABLE * size
    gaps = (contact.smallest_gap(run.q, trial.scene.radius).min() for run in (ahead, today))
    trial.note(DEPTHS, **{name: max(0.0, -gap) for name, gap in zip(("ahead", "today"), gaps)})


def exact_pushes_and_never_pulls(trial):
    """exact, where balls start in touch: the velocities after the impacts, and the accelerations
    then, are those of another solver. Bound: 1e-9 of the speeds, 1e-5 of the accelerations, chosen.

    Both have one answer, also where impulses and forces do not. Judged where no bounce is so slow
    that exact may take it for the last, since the forces bring it back at once, and no other impact
    follows at once. For these forces the turns of all contacts are added up.
    """
    motion, e = trial.exact, trial.spec["restitution"]
    on = motion and (np.abs(motion.depth[0]) < 1e-13) & (motion.inv_mass > 0.0)
    run = motion and on.any() and trial.brief(TINY, 4)
    if not run or np.abs(np.diff(run.v[1:], 3, axis=0)).max() > 1e-11:
        return
    n, (v1, v2, v3) = laws.directions(motion, 0, on), run.v[1:4]
    v, a = 3 * v1 - 3 * v2 + v3, (8 * v2 - 5 * v1 - 3 * v3) / (2 * TINY)  # extrapolated to t = 0
    bounced, still = trial.scene.v0.ravel(), 1e-12 * motion.top.max()
    for _ in range(1000):  # rounds of impacts
        v_n = n.T @ bounced
        if (v_n >= -still).all():
            break
        bounced = laws.nearest(n, -e * v_n, bounced, motion.mass)
    rests = np.abs(v_n) <= still
    across = np.array((-motion.normal[0, 1], motion.normal[0, 0]))
    turn = (v @ motion.sides.T * across).sum(0) ** 2 / motion.reach
    turn[: len(motion.mass)] = 0.0  # the floor's normal stays
    pressed = on.sum() * G + turn[on].sum()  # about the largest acceleration
    if (~rests & (v_n < SLOW * math.sqrt(pressed * motion.reach[on].max()))).any():
        return
    yield "velocity after the impacts [m/s]", np.abs(v.ravel() - bounced), NEAR * motion.top.max()
    fall = np.outer((0.0, -G), ~trial.fixed).ravel()
    found = laws.nearest(n[:, rests], -turn[on][rests], fall, motion.mass)  # Gauss 1829
    yield "acceleration [m/s^2]", np.abs(a.ravel() - found), LOOSE * (G + turn[on].max())


def exact_never_overlaps(trial):
    """exact: no overlap at any sample above 1e-12 of the largest radius."""
    if trial.exact and struck(trial.exact).any():
        gap = contact.smallest_gap(trial.exact.q[1:], trial.scene.radius)
        yield "overlap [m]", np.maximum(-gap, 0.0), PROMISE * trial.scene.radius.max()


def struck(motion):
    """In which steps some velocity shows more than gravity (S,)."""
    return (np.abs(motion.v[1:] - motion.falling) > 1e-9).any((1, 2))


def exact_keeps_its_energy(trial):
    """exact: no energy above 1e-12 of the start's is ever gained, and with e = 1 none is lost."""
    if trial.exact and not trial.fixed.all():
        total = contact.energy(trial.exact.q, trial.exact.v, trial.scene.mass)
        size, on = PROMISE * laws.start_energy(trial), struck(trial.exact)
        yield "gained since the start [J]", np.maximum(total[1:] - total[0], 0.0), size, on
        yield "gained in a step [J]", np.maximum(np.diff(total), 0.0), size, on
        if trial.spec["restitution"] == 1.0:
            yield "lost with e = 1 [J]", np.abs(total[1:] - total[0]), size, on


def exact_flies_and_bounces_in_closed_form(trial):
    """exact: a ball that nothing reaches within a step flies its parabola; one that only the table,
    or only one other ball, can reach bounces once, with e, at its own time. Impacts that graze, and
    a second one in the same step, are left out. Bound: 1e-9 of the lengths and speeds, not derived.
    """
    if not trial.exact:
        return
    motion, dt, moves = trial.exact, trial.dt, ~trial.fixed
    fast = np.sqrt((motion.v[:-1] ** 2).sum(1)) + G * dt * moves  # while nothing strikes a ball
    most = np.sqrt(2.0 * laws.start_energy(trial) * inverse(trial.mass))  # with all the energy
    pairs = np.maximum(fast[:, motion.a] + most[motion.b], most[motion.a] + fast[:, motion.b])
    meets = -motion.depth <= dt * np.concatenate((fast, pairs), axis=1)
    later = -motion.depth <= dt * motion.on_contacts(most)  # when its balls have been struck
    free = (motion.on_balls(meets) == 0) & moves
    off = np.abs(motion.v[1:] - motion.falling)
    yield "flight, v [m/s]", off, NEAR * fast[:, None], free
    q = motion.q[:-1] + dt / 2.0 * (motion.v[:-1] + motion.falling)
    size = np.abs(motion.q[1:]) + dt * fast[:, None]
    yield "flight, q [m]", np.abs(motion.q[1:] - q), NEAR * size, free
    table = meets[:, : len(moves)] & (motion.on_balls(meets)[:, 0] == 1) & moves
    pair = meets & later & (motion.on_contacts(motion.on_balls(later)[:, 0]) == 2)
    pair &= motion.on_contacts(1.0 * moves) == 2
    alone = np.concatenate((table, pair[:, len(moves) :]), axis=1)
    impulses, n = laws.only_impacts(trial, fast, alone)
    v = motion.falling + inverse(trial.mass) * ((impulses[:, None] * n) @ motion.sides)
    size = motion.on_balls((impulses > 0.0) * motion.on_contacts(fast))
    yield "impact [m/s]", np.abs(motion.v[1:] - v), NEAR / laws.STEEP * size, (size > 0.0) & moves


# every generator of this file
PROPERTIES = {name: each for name, each in vars().items() if inspect.isgeneratorfunction(each)}
