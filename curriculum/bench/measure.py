"""What is measured: run time against error, piles between walls, whole processes.

How stands in page.md. A point is one problem and setting, looked at every dt, after so many
substeps. Errors are medians over the starts; times are CPU times, medians over fresh processes,
every height read at each look. Piles fall from the same lattice and settle untimed. Then they are
timed in fresh processes: from the lattice, and from their own settled state.
"""

import math
import random
import statistics
import sys
import tempfile
from functools import cache, partial

import numpy as np
from scipy.spatial import cKDTree

import contact
from curriculum import parallel
from curriculum.bench import engines, problems, settings, timing

WORK, BUDGETS = (1, 4, 16), (3, 10, 100)  # substeps in 2 ms; us a ball in 2 ms
PROCESSES = 3
ENOUGH = 0.03  # s: once the runs of a point have taken so long, it is not timed again
STEPS = tuple((problems.REFERENCE_DT, substeps) for substeps in (1, 2, 4, 8, 16))
STEPS += tuple((dt, 1) for dt in problems.COARSER)
DT = 0.002  # s, of the piles
WATCHED, TURN, TURNS = 250, 50, 3  # steps at the end; timed steps in one go; how many goes
AT_REST, DEPTHS = 1e-3, (1e-3, 1e-4)  # m/s, r
SIZES, SETTLE = {12: 4, 100: 10, 1000: 25}, 6000  # balls: side by side; steps to settle
MANY, COPIES, AGAIN = 10_000, 10, 1500  # made of settled copies; steps to settle again


# run time against error


def points(quick, wanted, known):
    """A row a point, of the settings that are wanted."""
    jobs = list(cells(quick, wanted))
    print(f"{len(jobs)} points, their errors first, then their times", flush=True)
    errors = parallel.run_jobs(errors_of, jobs, "errors")
    rare = {job for job in jobs if settings.BY_NAME[job[1]].rare}
    times = timing.in_fresh_processes(time_of, jobs, 1 if quick else PROCESSES, "run times", rare)
    return [point(*each) for each in zip(jobs, errors, times)]


def cells(quick, wanted):
    """(problem, setting, dt, substeps, starts) of every point, by names."""
    steps = ((0.002, 1), (0.002, 4)) if quick else STEPS
    for name in ("drop", "slide") if quick else problems.BY_NAME:
        for c in settings.BY_NAME.values():
            here = c.runs(name) and wanted(c) and not engines.missing(c.engine)
            starts = 1 if c.rare or quick else problems.BY_NAME[name].starts
            if here and not (quick and c.engine in ("drake", "siconos")):
                taken = [each for each in steps if takes(c, *each)]
                yield from ((name, c.name, *each, starts) for each in taken)


def takes(c, dt, substeps):
    """Whether a setting runs so: whoever is adaptive once; 2 and 8 only who counts twice."""
    if c.adaptive or substeps == 1:
        return (dt, substeps) == STEPS[0] or not c.adaptive
    if substeps in (2, 8) and c.engine != "leapfrog":
        return False
    slow = c.rare and substeps > 4 or c.knobs.get("iters", 0) * substeps > 8000  # and never best
    return substeps * c.inner <= WORK[-1] and not slow


def errors_of(job):
    """What problems.quality says of each start, and the work."""
    name, contestant, dt, substeps, starts = job
    problem, c, found = problems.BY_NAME[name], settings.BY_NAME[contestant], []
    for start in range(starts):
        scene = problem.build(start)
        session = c.build(scene, dt, substeps)
        states = session.states(problem.steps(dt))
        error = problems.quality(problems.answer(name, start, dt), *states, scene.mass)
        found.append(error | dict(work=work_of(c, session, problem.steps(dt))))
    return found


def work_of(c, session, looks):
    """Substeps a look; of Drake under error control those that it took, in the mean."""
    if "scheme" in c.knobs:
        return session.simulator.get_integrator().get_num_steps_taken() / looks
    return session.substeps * c.inner * (2 if c.engine == "leapfrog" else 1)


def time_of(job, timed=timing.timed):
    """CPU seconds of a point: the median of up to three runs, after a short one as a warm-up."""
    problem, name, dt, substeps, _ = job
    scene, steps = problems.BY_NAME[problem].build(0), problems.BY_NAME[problem].steps(dt)
    found = []
    for looks in (min(50, steps), steps, steps, steps):
        session = settings.BY_NAME[name].build(scene, dt, substeps)
        seconds, _ = timed(partial(session.trace, looks))
        found.append(session.took or seconds)
        if sum(found[1:]) > ENOUGH:
            break
    return statistics.median(found[1:])


def point(job, errors, times):
    """A row: medians with least and greatest; diverged: of how many starts. No error is None."""
    problem, name, dt, substeps, _ = job
    c = settings.BY_NAME[name]
    row = dict(problem=problem, engine=c.engine, setting=c.options, substeps=substeps, dt=dt)
    row["work"] = statistics.median(e["work"] for e in errors)
    row["diverged"] = sum(e["diverged"] is not None for e in errors)
    itself = problems.BY_NAME[problem].truth is problems.judged and c.engine == "exact"
    spread = timing.spread("error", [e["error"] for e in errors])
    row |= {key: None if itself else spread[key] for key in ("error", "error_max")}
    return row | timing.spread("ms", [1e3 * seconds for seconds in times])


@cache
def looks_of_balls(problem):
    """In how many looks of 2 ms, added up over the balls that move, a problem is run."""
    moving = np.isfinite(problems.BY_NAME[problem].build(0).mass).sum()
    return moving * problems.BY_NAME[problem].steps(problems.REFERENCE_DT)


def allowed(p, budget=None, work=WORK[-1]):
    """Whether a point competes: at equal work, or within so many us a ball in 2 ms. exact does,
    also as the reference, which has no error."""
    if p["engine"] == "exact" or p["error"] is None or p["diverged"]:
        return p["engine"] == "exact"
    if budget is None:
        return p["dt"] == problems.REFERENCE_DT and p["work"] <= work
    return p["ms"] <= 1e-3 * budget * looks_of_balls(p["problem"])


def contest(rows, **limit):
    """{problem: {engine: its most accurate point}} of those that are allowed to compete."""
    return best((p for p in rows if allowed(p, **limit)), "problem", rank)


def rank(p):
    """What decides between two settings: the error in three digits, then the time."""
    return float(f"{p['error'] or 0.0:.3g}"), p["ms"]


def best(rows, group, rank):
    """{row[group]: {engine: its best row}}, by what rank(row) makes least."""
    found = {}
    for row in rows:
        rivals = found.setdefault(row[group], {})
        rivals[row["engine"]] = min(rivals.get(row["engine"], row), row, key=rank)
    return found


# piles


def shaft(count):
    """Balls on a lattice between two walls of fixed balls, and the floor. The seed is fixed."""
    if count == MANY:
        return side_by_side(shaft(MANY // COPIES))
    wide, r, rng = SIZES[count], contact.RADIUS, np.random.default_rng(0)
    place = rng.permutation(count)
    nudge = rng.uniform(-0.1 * r, 0.1 * r, (2, count))
    x = 2.5 * r * (place % wide - 0.5 * (wide - 1)) + nudge[0]
    y = 2.5 * r * (place // wide + 0.5) + nudge[1]
    wall = np.arange(1.05 * r, y.max() + 2.0 * r, 2.05 * r)  # no wall ball touches another
    side = 1.25 * r * wide + r
    x = np.concatenate((x, np.full(len(wall), -side), np.full(len(wall), side)))
    mass = np.repeat((1.0, math.inf), (count, 2 * len(wall)))
    return contact.scene_of(x, np.concatenate((y, wall, wall)), mass)


def side_by_side(scene):
    """So many copies of a shaft, each with its own walls; centred, for engines in float32."""
    places = (np.arange(COPIES) - 0.5 * (COPIES - 1)) * (np.ptp(scene.q0[0]) + 3.0 * contact.RADIUS)
    x = np.add.outer(places, scene.q0[0]).ravel()
    return contact.scene_of(x, np.tile(scene.q0[1], COPIES), np.tile(scene.mass, COPIES))


def piles(quick, wanted, known):
    """A row a setting and size; known: the rows that stay, of whom some may have won."""
    rows, states = [], {}
    for count in (12,) if quick else (*SIZES, MANY):
        chosen = winners(known + rows) if count == MANY else range(len(settings.PILES))
        chosen = [k for k in chosen if wanted(settings.PILES[k])][:: 4 if quick else 1]
        rows += piles_of(count, chosen, states, 1 if quick else PROCESSES - (count == MANY))
    return rows


def piles_of(count, chosen, states, processes):
    """The rows of one size: settle all settings, then time them. states[k]: the last settled."""
    chosen = [k for k in chosen if not engines.missing(settings.PILES[k].engine)]
    print(f"pile of {count}: {len(chosen)} settings settle, then they are timed", flush=True)
    jobs = [(count, k, states.get(k)) for k in chosen]
    settled = parallel.run_jobs(settle, jobs, f"{count} balls settle")
    states.update((k, found[:2]) for k, found in zip(chosen, settled))
    work, rows = [(count, k, states[k]) for k in chosen], []
    times = timing.in_fresh_processes(falling_and_resting, work, processes, f"{count} balls")
    for k, (_, _, state), found in zip(chosen, settled, times):
        c = settings.PILES[k]
        row = dict(bodies=count, engine=c.engine, setting=c.options, substeps=c.cuts) | state
        for name, each in zip(("falling", "resting"), zip(*found)):
            row |= timing.spread(name, each)
        rows.append(row)
    return rows


def settle(job):
    """q, v of the settled pile, and the row's depths and speed; the speed is watched to the end."""
    count, k, start = job
    scene, steps = shaft(count), SETTLE
    if count == MANY:
        scene, steps = side_by_side(shaft(MANY // COPIES)._replace(q0=np.array(start[0]))), AGAIN
    session = settings.PILES[k].build(scene, DT, settings.PILES[k].cuts)
    session.go(steps - WATCHED)
    speeds, (before, _) = [], session.state()
    for _ in range(WATCHED // TURN):
        session.go(TURN)
        q, v = session.state()
        speeds.append(float(np.hypot(*(q - before)).max() / (TURN * DT)))
        before = q.copy()
    return q, v, dict(speed=float(np.max(speeds)), at_rest=rests(speeds), **depths(q, scene))


def rests(speeds):
    """Whether a pile rests, by the longest way of a ball from look to look, as a speed [m/s]."""
    return int(all(speed < AT_REST for speed in speeds))  # NaN is not


def depths(q, scene):
    """Mean and worst overlap [r] of the contacts that overlap in a state q (2, N)."""
    if not np.isfinite(q).all():
        return dict(mean_depth=None, worst_depth=None)
    a, b = cKDTree(q.T).query_pairs(2.0 * scene.radius.max(), output_type="ndarray").T
    pairs = scene.radius[a] + scene.radius[b] - np.hypot(*(q[:, a] - q[:, b]))
    found = np.concatenate((scene.radius - q[1], pairs)) / contact.RADIUS
    found = np.append(found[found > 0.0], 0.0)
    mean = float(found.sum() / max(1, len(found) - 1))
    return dict(mean_depth=mean, worst_depth=float(found.max()))


def falling_and_resting(job, timed=timing.timed):
    """Microseconds a step, from the lattice and from the settled state."""
    count, k, (q, v) = job
    scene, found = shaft(count), []
    for start in (scene, scene._replace(q0=np.array(q, float), v0=np.array(v, float))):
        session = settings.PILES[k].build(start, DT, settings.PILES[k].cuts)
        session.go(100)
        seconds = [timed(partial(session.go, TURN))[0] for _ in range(TURNS)]
        found.append(1e6 * statistics.median(seconds) / TURN)
    return found


def fastest(rows, depth):
    """{balls: {engine: its fastest row}} of what rests within a mean depth [r]."""
    may = (row for row in rows if row["at_rest"] and row["mean_depth"] <= depth)
    return best(may, "bodies", lambda row: row["resting"])


def winners(rows):
    """The numbers of the settings that are worth running with 10,000 balls."""
    found = [row for depth in DEPTHS for row in fastest(rows, depth).get(1000, {}).values()]
    chosen = {(row["engine"], row["setting"], row["substeps"]) for row in found}
    return [k for k, c in enumerate(settings.PILES) if (c.engine, c.options, c.cuts) in chosen]


# whole processes


def processes(quick, wanted, known):
    """Seconds of whole processes of contact.py, of importing what they need, and of compiling."""
    step = (  # with a folder of its own for what is compiled
        "import pathlib, sys; from curriculum.lesson import compiled; "
        "compiled.FOLDER = pathlib.Path(sys.argv[1]); import contact; from curriculum import fast; "
        "fast.run_model('lcp', contact.build_scene('drop'), 0.002, 1, contact.Settings())"
    )
    with tempfile.TemporaryDirectory() as out, tempfile.TemporaryDirectory() as cold:
        words = {f"import {name}": ["-c", f"import {name}"] for name in ("numpy", "rerun")}
        words["one compiled step"] = ["-c", step, out]
        for flags in ("", *(f" --scene {each} --no-rerun" for each in ("drop", "bounce", "stack"))):
            words[f"contact.py{flags}"] = ["contact.py", "--out", out, *flags.split()]

        def seconds(*words, folder=out):
            return timing.whole_process([sys.executable, *words], folder)

        first = [] if quick else [seconds("-c", step, cold, folder=cold)]
        found = {"one compiled step, the first ever": first}
        for number in range(3 if quick else 16):
            for name in random.Random(number).sample(list(words), len(words)):
                found.setdefault(name, []).append(seconds(*words[name]))
    rows = {name: each[len(each) > 1 :] for name, each in found.items() if each}  # the first warms
    return [dict(process=name) | timing.spread("seconds", rows[name]) for name in sorted(rows)]


PARTS = {"points": points, "piles": piles, "processes": processes}
