"""What is measured: run time against error, piles between walls, a heap that collapses, processes.

page.md says how. A point is one problem and setting, sampled every dt, after so many substeps.
Errors are medians over the starts; times are CPU times, medians over fresh processes, with every
height read at each sample. Piles fall from the same lattice and settle untimed. Then they are
timed in fresh processes, from their own settled state.
"""

import math
import statistics
import tempfile
from functools import partial
from operator import itemgetter

import numpy as np
from scipy.spatial import cKDTree

import contact
from curriculum import parallel, stored
from curriculum.bench import engines, problems, timing

WORK, BUDGETS = (4, 16), (3, 10, 100)  # substeps in 2 ms; us a ball in 2 ms
PROCESSES = 3
ENOUGH = 0.03  # s: once the runs of a point have taken so long, it is not timed again
DT = 0.002  # s, the step of contact.py's own default run
LONGER = 0.004  # s: a step that is looked at once
MOVING = {p.name: int(np.isfinite(p.build(0).mass).sum()) for p in problems.PROBLEMS}  # balls
HEAP, COLLAPSE = (18, 12), 2000  # balls side by side and over one another; steps
WATCHED, LOOK = 250, 50  # steps at the end, and from one look to the next
TIMED = 100, 50, 3  # steps of a settled pile before it is timed, in one go; how many goes
AT_REST, DEPTHS = 1e-3, (1e-3, 1e-4)  # m/s, r
SIZES, SETTLE = {12: 4, 100: 10, 1000: 25}, 6000  # balls: side by side; steps to settle
MANY, COPIES, AGAIN = 10_000, 10, 1500  # made of settled copies; steps to settle again


def points(quick):
    """Measure a row for each point."""
    jobs = list(cells(quick))
    rows = parallel.run_jobs(errors_of, jobs, "errors")
    times = timing.in_fresh_processes(time_of, jobs, 1 if quick else PROCESSES, "run times")
    return [row | timing.spread("ms", each) for row, each in zip(rows, times)]


def cells(quick):
    """Yield (problem, setting, dt, substeps, starts) of every point, by names."""
    for name in ("drop", "slide") if quick else problems.BY_NAME:
        starts = 1 if quick else problems.BY_NAME[name].starts
        for c in engines.BY_NAME.values():
            if c.runs(name) and not (quick and c.engine == "drake"):
                steps = [(DT, n) for n in c.substeps or (1,) if n in (1, 4) or not quick]
                steps += [(LONGER, 1)] * bool(c.substeps and not quick)
                yield from ((name, c.name, *each, starts) for each in steps)


def errors_of(job):
    """Return a point's row without times: the median error of its starts, None of the reference;
    the greatest one; the work."""
    name, contestant, dt, substeps, starts = job
    problem, c, found, work = problems.BY_NAME[name], engines.BY_NAME[contestant], [], []
    for start in range(starts):
        session = c.build(problem.build(start), dt, substeps)
        q, _ = session.states(problem.steps(dt))
        found.append(problems.worst_error(problems.answer(name, start, dt), q))
        work.append(work_of(c, session, problem.steps(dt)))
    row = dict(problem=name, engine=c.engine, setting=c.options, substeps=substeps, dt=dt)
    row |= dict(work=statistics.median(work))
    spread = timing.spread("error", found)
    itself = problem.truth is problems.judged and c.engine == "exact"
    return row | {key: None if itself else spread[key] for key in ("error", "error_max")}


def work_of(c, session, looks):
    """Return substeps a look; of Drake under error control those that it took, in the mean."""
    if "scheme" in c.knobs:
        return session.simulator.get_integrator().get_num_steps_taken() / looks
    return session.substeps * c.inner


def time_of(job, timed=timing.timed):
    """Return CPU ms of a point: the median of up to three runs, after a short one as a warm-up."""
    problem, name, dt, substeps, _ = job
    scene, steps = problems.BY_NAME[problem].build(0), problems.BY_NAME[problem].steps(dt)
    found = []
    for looks in (min(50, steps), steps, steps, steps):
        session = engines.BY_NAME[name].build(scene, dt, substeps)
        found.append(timed(partial(session.trace, looks)))
        if sum(found[1:]) > ENOUGH:
            break
    return 1e3 * statistics.median(found[1:])


def allowed(p, budget=None, work=WORK[-1]):
    """Return whether a point competes: at equal work, or within us a ball. exact does,
    also as the reference, which has no error."""
    if p["engine"] == "exact" or p["error"] is None:
        return p["engine"] == "exact"
    if budget is None:
        return p["dt"] == DT and p["work"] <= work
    looks = problems.BY_NAME[p["problem"]].steps(DT)
    return p["ms"] <= 1e-3 * budget * MOVING[p["problem"]] * looks


def contest(rows, who, **limit):
    """Return {problem: the most accurate point} of those of these engines that may compete."""
    may = (p for p in rows if p["engine"] in who and allowed(p, **limit))
    return best(may, "problem", rank)


def rank(p):
    """Return the key by which settings are compared: error in three digits, then time."""
    return float(f"{p['error'] or 0.0:.3g}"), p["ms"]


def best(rows, group, rank):
    """Return {row[group]: the row of it for which rank(row) is least}."""
    found = {}
    for row in rows:
        found[row[group]] = min(found.get(row[group], row), row, key=rank)
    return found


def shaft(count, one=None):
    """Return balls on a lattice between two walls of fixed balls, and the floor. The seed is fixed.

    Of 10,000: ten copies of a thousand, `one`, each with its own walls; centred, for engines in
    float32.
    """
    r, rng = contact.RADIUS, np.random.default_rng(0)
    if count == MANY:
        one = one or shaft(MANY // COPIES)
        x, y = one.q0
        places = (np.arange(COPIES) - 0.5 * (COPIES - 1)) * (np.ptp(x) + 3.0 * r)
        x, mass = np.add.outer(places, x).ravel(), np.tile(one.mass, COPIES)
        return contact.scene_of(x, np.tile(y, COPIES), mass)
    wide, place = SIZES[count], rng.permutation(count)
    nudge = rng.uniform(-0.1 * r, 0.1 * r, (2, count))
    x = 2.5 * r * (place % wide - 0.5 * (wide - 1)) + nudge[0]
    y = 2.5 * r * (place // wide + 0.5) + nudge[1]
    wall = np.arange(1.05 * r, y.max() + 2.0 * r, 2.05 * r)  # no wall ball touches another
    sides = np.repeat((-1.25 * r * wide - r, 1.25 * r * wide + r), len(wall))
    mass = np.repeat((1.0, math.inf), (count, 2 * len(wall)))
    return contact.scene_of(np.append(x, sides), np.concatenate((y, wall, wall)), mass)


def piles(quick):
    """Measure a row for each setting and size."""
    rows, settled = [], {}
    for count in (12,) if quick else (*SIZES, MANY):
        chosen, label = fitting(count)[:: 4 if quick else 1], f"{count} balls"
        jobs = [(count, *each, settled.get(each)) for each in chosen]
        ends, found = zip(*parallel.run_jobs(settle, jobs, f"{label} settle"))
        settled = dict(zip(chosen, ends))
        jobs = [(end, *each, *TIMED) for each, end in settled.items()]
        often = 1 if quick else PROCESSES - (count == MANY)
        times = timing.in_fresh_processes(time_of_step, jobs, often, label)
        rows += [row | timing.spread("us", each) for row, each in zip(found, times)]
    return rows


def fitting(count):
    """Return the (setting, substeps) that run so many balls."""
    return [(c, n) for c, n in engines.PILES if count <= (c.most or count)]


def settle(job):
    """Return a settled pile, and its row without times; one: of a thousand, or None."""
    count, c, substeps, one = job
    scene = shaft(count, one)
    session = c.build(scene, DT, substeps)
    session.go((AGAIN if count == MANY else SETTLE) - WATCHED)
    speeds, (before, _) = [], session.state()
    for _ in range(WATCHED // LOOK):
        session.go(LOOK)
        q, v = session.state()
        speeds.append(np.hypot(*(q - before)).max() / (LOOK * DT))
        before = q.copy()
    speed = float(np.max(speeds))  # the longest way of a ball from look to look; NaN is no rest
    row = dict(bodies=count, engine=c.engine, setting=c.options, substeps=substeps, speed=speed)
    row |= dict(at_rest=int(speed < AT_REST)) | depths(q)
    return scene._replace(q0=q, v0=v), row


def depths(q):
    """Return mean and worst overlap [r] of the overlapping contacts of a state q (2, N), or NaN."""
    if not np.isfinite(q).all():
        return dict(mean_depth=math.nan, worst_depth=math.nan)
    r = contact.RADIUS
    a, b = cKDTree(q.T).query_pairs(2.0 * r, output_type="ndarray").T
    found = np.append(r - q[1], 2.0 * r - np.hypot(*(q[:, a] - q[:, b]))) / r
    found = np.append(found[found > 0.0], 0.0)
    mean = float(found.sum() / max(1, len(found) - 1))
    return dict(mean_depth=mean, worst_depth=float(found.max()))


def time_of_step(job, timed=timing.timed):
    """Return microseconds a step: the median of so many goes, after the first steps."""
    scene, c, substeps, first, steps, goes = job
    session = c.build(scene, DT, substeps)
    session.go(first)
    seconds = [timed(partial(session.go, steps)) for _ in range(goes)]
    return 1e6 * statistics.median(seconds) / steps


def heap():
    """Return SimBenchmark's 666 in the plane: 216 balls of 10 kg that fall 1 m and collapse.

    There they are 6 x 6 x 6; here 18 x 12, with its spacing, height and nudge. No friction, e = 0.
    """
    wide, high = HEAP
    x, y = np.meshgrid(0.21 * (np.arange(wide) - 0.5 * (wide - 1)), 1.101 + 0.21 * np.arange(high))
    nudge = np.random.default_rng(42).uniform(-1e-3, 1e-3, (2, wide * high))
    return contact.scene_of(x.ravel() + nudge[0], y.ravel() + nudge[1], 10.0)


def collapse(quick):
    """Measure a row for each setting of the piles: the heap's overlaps, and the time of a step."""
    count, steps = math.prod(HEAP), COLLAPSE // 20 if quick else COLLAPSE
    chosen, often = fitting(count)[:: 8 if quick else 1], 1 if quick else PROCESSES
    jobs = [(*each, steps) for each in chosen]
    rows = parallel.run_jobs(sink_of, jobs, f"{count} balls collapse")
    jobs = [(heap(), *each, 1, steps - 1, 1) for each in chosen]
    times = timing.in_fresh_processes(time_of_step, jobs, often, "their times")
    return [row | timing.spread("us", each) for row, each in zip(rows, times)]


def sink_of(job):
    """Return a heap's row without times: the mean overlap, averaged over samples, and the worst."""
    (c, substeps, steps), found = job, []
    session = c.build(heap(), DT, substeps)
    for _ in range(steps // 10):
        session.go(10)
        found.append(depths(session.state()[0]))
    row = dict(bodies=math.prod(HEAP), engine=c.engine, setting=c.options, substeps=substeps)
    mean, worst = np.array([list(each.values()) for each in found]).T
    return row | dict(mean_depth=float(mean.mean()), worst_depth=float(worst.max()))


def fastest(rows, depth, who):
    """Return {balls: the fastest row} of these engines, of piles at rest within a mean depth [r],
    or of a heap in motion."""
    may = (row for row in rows if row["engine"] in who and row.get("at_rest", 1))
    deep = (row for row in may if row["mean_depth"] is not None and row["mean_depth"] <= depth)
    return best(deep, "bodies", itemgetter("us"))


def processes(quick):
    """Measure the seconds of whole processes, those of commands.csv: contact.py, imports, a step
    that is compiled. The first of each finds empty caches, and fills them."""
    commands = stored.load(engines.HERE)[0]["commands"]
    with tempfile.TemporaryDirectory() as folder:
        jobs = [(row["words"], f"{folder}/{k}") for k, row in enumerate(commands)]
        often, label = 3 if quick else 16, "processes"
        found = timing.in_fresh_processes(timing.whole_process, jobs, often, label)
    return [dict(process=row["process"]) | timing.spread("seconds", seconds) | dict(first=first)
            for row, (first, *seconds) in zip(commands, found)]  # fmt: skip


PARTS = {"points": points, "piles": piles, "collapse": collapse, "processes": processes}
