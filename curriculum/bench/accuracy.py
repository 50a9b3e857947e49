"""Run time against error: every problem, contestant and step, over several starts.

A point is one problem and contestant, looked at every dt, after so many substeps. At 2 ms all take
1, 4 and 16, their own inner substeps counted: equal work. leapfrog solves twice in each, and its
substeps count twice. An engine that chooses its steps is asked how many it took. Errors are medians
over the starts; times are CPU times, medians over fresh processes, with least and greatest, every
height read at each look.

The best of a family at equal work takes at most 16 substeps in 2 ms; at equal time it is any
setting at any step that stays within so many microseconds a ball for each 2 ms of motion.
"""

import statistics
from functools import partial

import numpy as np

import contact
from curriculum import parallel
from curriculum.bench import problems, settings, timing

ERRORS = ("error", "final_error", "energy_error", "depth")
WORK, BUDGETS, BUDGET = 16, (1, 10, 100), 10  # substeps in 2 ms; us a ball in 2 ms
PROCESSES = 3
ENOUGH = 0.03  # s: once the runs of a point have taken so long, it is not timed again
QUICK = dict(names=("drop", "slide"), steps=((0.002, 1), (0.002, 4)), starts=1, processes=1)
STEPS = tuple((problems.REFERENCE_DT, substeps) for substeps in (1, 4, 8, 16))
STEPS += tuple((dt, 1) for dt in problems.COARSER)


def measure(quick=False):
    """The whole benchmark as one section: problems, points, what is left out."""
    chosen = [p for p in problems.PROBLEMS if not quick or p.name in QUICK["names"]]
    jobs = list(cells(chosen, quick))
    print(f"accuracy: {len(jobs)} points, their errors first, then their times", flush=True)
    errors = parallel.run_jobs(errors_of, jobs, "errors")
    processes = QUICK["processes"] if quick else PROCESSES
    slow = {job for job in jobs if settings.BY_NAME[job[1]].slow}  # one process has to be enough
    times = timing.in_fresh_processes(time_of, jobs, processes, "run times", slow)
    points = [point(*each) for each in zip(jobs, errors, times)]
    about = {p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration) for p in chosen}
    return dict(problems=about, points=packed(points), left_out=left_out(chosen))


def cells(chosen, quick):
    """(problem, contestant, dt, substeps, starts) of every point, by names."""
    for problem in chosen:
        for c in settings.EVERYBODY:
            kept_out = c.only and problem.name not in c.only or quick and c.engine == "drake"
            if kept_out or c.refuses(problem.build(0)):
                continue
            starts = 1 if c.slow or quick else problem.starts
            for dt, substeps in QUICK["steps"] if quick else STEPS:
                if takes(c, dt, substeps):
                    yield problem.name, c.name, dt, substeps, starts


def takes(c, dt, substeps):
    """Whether a contestant runs so: whoever is adaptive once, loops in Python without substeps."""
    if c.adaptive:
        return (dt, substeps) == STEPS[0]
    if c.options.get("python"):
        return substeps == 1
    half = c.engine == "leapfrog"  # which may take half as many at equal work, and all in time
    return substeps == 1 or substeps * c.inner <= WORK and (half or substeps != WORK // 2)


def errors_of(job):
    """The errors of a point: a list of problems.quality's dicts, one a start, and the work."""
    name, contestant, dt, substeps, starts = job
    problem, found = problems.BY_NAME[name], []
    for start in range(starts):
        scene = problem.build(start)
        session = settings.BY_NAME[contestant].build(scene, dt, substeps)
        states = session.states(problem.steps(dt))
        run = contact.Run(np.arange(len(states[0])) * dt, *states)
        work = work_of(settings.BY_NAME[contestant], session, problem.steps(dt))
        found.append(problems.quality(problem, scene, run) | dict(work=work))
    return found


def work_of(c, session, looks):
    """Substeps a look; of Drake under error control those that it took, in the mean."""
    if "scheme" in c.options:
        return session.simulator.get_integrator().get_num_steps_taken() / looks
    return session.substeps * c.inner * (2 if c.engine == "leapfrog" else 1)


def time_of(job, timed=timing.timed):
    """CPU seconds of a point: the median of up to three runs, after a short one as a warm-up."""
    problem, name, dt, substeps, _ = job
    scene, steps = problems.BY_NAME[problem].build(0), problems.BY_NAME[problem].steps(dt)
    found = []
    for looks in (min(50, steps), steps, steps, steps):
        session = settings.BY_NAME[name].build(scene, dt, substeps)
        seconds, heights = timed(partial(session.trace, looks))
        if len(heights) != looks + 1:
            raise RuntimeError(f"{name} was looked at {len(heights)} times, not {looks + 1}")
        found.append(seconds)
        if sum(found[1:]) > ENOUGH:
            break
    return statistics.median(found[1:])


def point(job, errors, times):
    """One point as a flat dict. diverged: of how many starts. An error that is none is None."""
    problem, name, dt, substeps, _ = job
    c = settings.BY_NAME[name]
    found = dict(
        problem=problem,
        family=c.engine,
        words=c.cut(substeps),
        dt=dt,
        work=statistics.median(e["work"] for e in errors),
        balls=int(np.isfinite(problems.BY_NAME[problem].build(0).mass).sum()),
        diverged=sum(e["diverged"] is not None for e in errors),
    )
    judge = problems.BY_NAME[problem].truth is problems.judged
    itself = judge and c.engine == "exact"  # the reference has no error of its own
    for key in ERRORS:
        found[key] = None if itself else statistics.median(e[key] for e in errors)
    found["errors"] = timing.spread([e["error"] for e in errors])
    return found | {"ms": timing.spread([1e3 * seconds for seconds in times])}


def allowed(p, budget=None, work=WORK):
    """Whether a point competes: at equal work, or within so many us a ball in 2 ms."""
    if p["error"] is None or p["diverged"]:
        return False
    if budget is None:
        return p["dt"] == problems.REFERENCE_DT and p["work"] <= work
    looks = problems.BY_NAME[p["problem"]].duration / problems.REFERENCE_DT
    return p["ms"]["median"] <= 1e-3 * budget * p["balls"] * looks


def headline(points, *limits, **limit):
    """{problem: {family: its best point}} of those that are allowed to compete."""
    return best((p for p in points if allowed(p, *limits, **limit)), "problem", rank)


def best(rows, group, rank):
    """{row[group]: {family: its best row}}, by what rank(row) makes least."""
    found = {}
    for row in rows:
        rivals = found.setdefault(row[group], {})
        rivals[row["family"]] = min(rivals.get(row["family"], row), row, key=rank)
    return found


def rank(p):
    """What decides between two settings: the error in three digits, then the time."""
    return float(f"{p['error']:.3g}"), p["ms"]["median"]


def left_out(chosen):
    """{label: why} of whoever does not run every problem."""
    return {
        settings.engines.LABELS[c.engine]: why
        for problem in chosen
        for c in settings.EVERYBODY
        if (why := c.refuses(problem.build(0)))
    }


def packed(rows):
    """{"columns": [...], "rows": [[...]]} of dicts with the same keys."""
    return {"columns": list(rows[0]), "rows": [list(row.values()) for row in rows]}


def unpacked(table):
    """Rows of a packed table, as dicts."""
    return [dict(zip(table["columns"], row)) for row in table["rows"]]
