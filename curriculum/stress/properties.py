"""What must hold on any scene: stated once, for the tests and for thousands of numbered scenes.

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
from curriculum.stress import scenes
from curriculum.stress.trial import STEPPED, G, Trajectory, U

NOTABLE = 1e-9  # share of the speeds: if sweeps still move more, they are not done
MOST = contact.MAX_SWEEPS
PROMISE = 1e-12  # of exact: of a radius, and of the energy at the start
NEAR = 1e-11  # share of the sizes that leapfrog's bounces may be off


def judge(subject, *properties):
    """Return {property: [comparisons, off as a share of what is allowed at worst, words or None]}.

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
        where = f", at {place}" if place else ""
        row[2] = f"{words}: {off[place]:.3g}, bound {allowed[place]:.3g}{where}"


def unlike(run, other):
    """Return the claim that two runs have the same bits: (1 for each number that differs, 0)."""
    a, b = (np.concatenate((each.q, each.v), axis=1) for each in (run, other))
    return ~((a == b) | (a != a) & (b != b)), 0.0


def alone_and_beside_one_that_overflows(trial, **alone):
    """Return lists of changes: of one or two balls also to add one that overflows, then is NaN."""
    odd = {"x": 3.0, "y": -1e300, "vx": 0.0, "vy": 0.0, "mass": 1e-12, "radius": 0.1}
    beside = {name: [*trial.spec[name], value] for name, value in odd.items()}
    return [alone, beside] if len(trial.scene.mass) <= 2 else [alone]


def finite_or_said_to_have_exploded(trial):
    """Every number of a run is finite, or contact_quality says that it blew up, and when."""
    for model, more in itertools.product(STEPPED, alone_and_beside_one_that_overflows(trial)):
        run = trial.run(model, **more)
        quality = contact.contact_quality(run, scenes.to_scene(trial.spec | more), trial.dt)
        finite = np.isfinite(run.q).all() and np.isfinite(run.v).all()
        told = quality["blew_up"] and quality["blew_up_step"] is not None
        yield f"{model} is not finite, and that is not said", not (finite or told), 0.0
    if trial.exact:
        yield "exact is not finite", trial.exact.astray, 0.0


def a_skip_changes_no_bit(trial):
    """Compiled loops are bitwise identical to contact.py's plain steps. With one or two balls so is
    step skipping, also beside a ball whose position is NaN.
    """
    cases = alone_and_beside_one_that_overflows(trial, steps=8)
    for model, changes in itertools.product(STEPPED, cases):
        plain = trial.run(model, "plain", **changes)
        for way in ("twin", "skips")[: len(cases)]:
            yield f"{way}: {model}", *unlike(plain, trial.run(model, way, **changes))


def a_run_goes_on_from_any_of_its_states(trial):
    """penalty, leapfrog, and lcp without warm starting: a run that is restarted from its state at
    half time is bitwise identical. A step depends on nothing but the state.
    """
    half = trial.spec["steps"] // 2
    for model in ("penalty", "leapfrog", "lcp")[: 2 + (trial.spec["warm"] == 0.0)]:
        run = trial.run(model)
        if np.isfinite(run.q[half]).all() and np.abs(run.v[half]).max() < 1e300:
            start = scenes.state(run.q[half], run.v[half])
            late = trial.run(model, **start, steps=trial.spec["steps"] - half)
            yield model, *unlike(run._replace(q=run.q[half:], v=run.v[half:]), late)


def momenta_are_gravitys_and_what_contacts_report(trial):
    """penalty, lcp, soft: momentum balance. The impulses of a step have lam >= 0; equal and
    opposite along the normals, they and gravity are the whole change of momentum; penalty's lam is
    max(0, k depth - c v_n) dt; and balls move by dt v. Bound: 8 U per impulse, of the momenta that
    the energies allow, and of lam.
    """
    sweeps = {"penalty": 1, "lcp": trial.spec["iters"], "soft": 1000}
    for model, many in sweeps.items():
        motion = trial.motions[model]
        for k in sampled(motion):
            v, rows, lam = one_step(trial, motion, model, k)
            ends, sides = np.abs(motion.sides[rows]), motion.sides[rows]
            gained = motion.mass * (v - motion.falling[k])
            given = np.einsum("c,dc,cn->dn", lam, motion.normals[k][:, rows], sides)
            size = (1 + ends.sum(0)) * np.sqrt(motion.mass) * norm(motion, k, v) + lam @ ends
            off, allowed = np.abs(gained - given), 8 * U * (many + 2) * size
            yield f"{model} [N s], step {k}", off, allowed, ~motion.fixed
            yield f"{model} pulls, step {k}", lam < 0.0, 0.0
            if model == "penalty":
                stiffness, damping = trial.spec["stiffness"], trial.spec["damping"]
                spring, damper = stiffness * -motion.gaps[k, rows], damping * motion.speeds[k, rows]
                size = stiffness * np.abs(motion.q[k]).max() + np.abs(damper) + np.abs(spring)
                off = np.abs(lam - motion.dt * np.maximum(0.0, spring - damper))
                yield f"penalty, spring [N s], step {k}", off, 8 * U * motion.dt * size
        q, way = motion.q, motion.dt * motion.v[1:]
        size = np.abs(q[1:]) + np.abs(q[:-1]) + np.abs(way)
        yield f"{model}, moves [m]", np.abs(q[1:] - q[:-1] - way), 4 * U * size


def sampled(motion):
    """Return up to two steps: that of the deepest overlap, and the last with contacts."""
    if not len(motion.listed):
        return []
    deepest = int(motion.gaps[:-1].min(1).argmin())
    return sorted({deepest, int(np.append(0, np.flatnonzero(motion.listed.any(1)))[-1])})


def one_step(trial, motion, model, k, **changes):
    """Take step k of a model alone. Returns v (2, N) after it, and the rows of its contacts in the
    motion with their lam [N s].
    """
    spec = trial.spec | scenes.state(motion.q[k], motion.v[k]) | changes
    scene = scenes.to_scene(spec)
    balls = contact.make_balls(scene)
    contacts = contact.step_of(model, scene, trial.dt, scenes.to_settings(spec))(balls)
    place = {ball: number for number, ball in enumerate(balls)}
    sides = {tuple(np.flatnonzero(side)): row for row, side in enumerate(motion.sides)}
    rows = [sides[tuple(place[ball] for ball in (c.a, c.b) if ball in place)] for c in contacts]
    v = np.array([(ball.vx, ball.vy) for ball in balls]).T
    return v, np.array(rows, int), np.array([c.lam for c in contacts])


def norm(motion, k, v):
    """Return a bound on sqrt(m) v of every ball in step k, which ends with v: every push brings a
    solver nearer to its answer, so the energies bound the speeds.
    """
    size = [math.sqrt((motion.mass * each * each).sum()) for each in (motion.v[k], v)]
    return size[0] + 2.0 * size[1] + motion.dt * G * math.sqrt(motion.mass.sum())


def enough_sweeps_solve_lcp(trial):
    """lcp, few balls: 10,000 sweeps solve the complementarity problem, lam >= 0, v_n >= target and
    one of them an equality, whose velocities are unique (Moreau 1988). The target is implemented
    again from the chapter. Bound: a hundred times the change in the second half of the sweeps,
    which is not derived, and 1e-13 of the speeds for rounding (a choice).
    """
    motion = trial.motions["lcp"]
    for k in sampled(motion) if len(trial.scene.mass) <= 4 else ():
        less, _, given = one_step(trial, motion, "lcp", k, iters=MOST // 2, warm=0.0)
        v, rows, lam = one_step(trial, motion, "lcp", k, iters=MOST, warm=0.0)
        moved, fastest = 100 * np.abs(v - less).max(), np.abs([v, motion.v[k]]).max()
        target = lcp_target(motion.gaps[k, rows], motion.speeds[k, rows], trial.spec)
        # where no v meets all targets, as of a ball between two fixed ones, lam grows for ever
        grows = np.abs(lam - given).max(initial=0.0) > NOTABLE * lam.max(initial=0.0)
        if grows or moved > NOTABLE * fastest:
            trial.noted[f"lcp: a step that no {MOST:,} sweeps can solve"] = {}
            continue
        left = motion.along(v, motion.normals[k])[rows] - target
        # a gap is a distance less radii, rounded thrice by U of the places: gap / dt of two that
        # press a ball from two sides may exclude one another by six, and one of them is not reached
        places = np.abs(motion.q[k]).max() + trial.scene.radius.max()
        rounding = 1e-13 * (fastest + trial.dt * G + np.abs(target)) + 6 * U * places / trial.dt
        allowed = moved + rounding
        yield f"too slow [m/s], step {k}", np.maximum(-left, 0.0), allowed, motion.moves[rows]
        yield f"pushed too far [m/s], step {k}", left, allowed, lam > 0.0


def lcp_target(gap, v_n, spec):
    """Return the least v_n after the solve of each contact: the chapter's rule, written again."""
    e, beta, close = spec["restitution"], spec["baumgarte"], -gap / spec["dt"]
    bias, bounce = beta * close, -e * v_n
    if e == 0.0:
        return bias
    across = np.where(spec["dt"] * v_n <= -gap, bounce, np.minimum(bounce, close))
    return np.where(bias > 0.0, np.maximum(bias, bounce), across)


def leapfrog_is_exact_until_something_lasts(trial):
    """leapfrog, e > 0, few balls that start apart: positions and velocities are exact's until an
    approach speed falls below 4 g dt. Bound: 1e-11 of the lengths and speeds (a choice).
    """
    apart = trial.start > 0.0 and len(trial.scene.mass) <= 4
    if apart and trial.spec["restitution"] > 0.0 and trial.exact:
        run, exact = trial.run("leapfrog", iters=1000), trial.exact
        motion = Trajectory(trial.scene, trial.dt, run, "leapfrog")
        slow = np.append(motion.slowest() < 4.0 * G * trial.dt, True)
        fair = min(int(slow.argmax()), len(exact.q))
        struck = exact.struck()[: max(0, fair - 1)].cumsum() > 0
        for name, size in (("q", 1.0 + np.abs(exact.q[0]).max()), ("v", np.abs(exact.v).max())):
            off = np.abs(getattr(motion, name)[1:fair] - getattr(exact, name)[1:fair])
            yield name, off, NEAR * size, struck[:, None, None]


def exact_never_overlaps(trial):
    """exact: no sample has an overlap above 1e-12 of the largest radius."""
    if trial.exact and trial.exact.struck().any():
        gap = contact.smallest_gap(trial.exact.q[1:], trial.scene.radius)
        yield "overlap [m]", np.maximum(-gap, 0.0), PROMISE * trial.scene.radius.max()


def exact_keeps_its_energy(trial):
    """exact: no run gains more than 1e-12 of the start's energy, none loses as much at e = 1, and
    without fixed balls the horizontal momentum is constant to 1e-12 of what the energy allows.
    """
    motion = trial.exact
    if motion and not motion.fixed.all():
        mass, on = motion.mass, motion.struck()
        total = contact.energy(motion.q, motion.v, trial.scene.mass)
        most = max(float(total[0]), float((mass * G * trial.scene.radius).sum()))
        gained = total[1:] - total[0]
        yield "gained since the start [J]", np.maximum(gained, 0.0), PROMISE * most, on
        yield "gained in a step [J]", np.maximum(np.diff(total), 0.0), PROMISE * most, on
        if trial.spec["restitution"] == 1.0:
            yield "lost with e = 1 [J]", np.abs(gained), PROMISE * most, on
        if not motion.fixed.any():
            off = np.abs((mass * np.diff(motion.v[:, 0], axis=0)).sum(1).cumsum())
            yield "momentum [N s]", off, PROMISE * math.sqrt(2.0 * mass.sum() * most), on


# every generator of this file that takes a trial and claims of it
PROPERTIES = {name: each for name, each in vars().items() if inspect.isgeneratorfunction(each)}
