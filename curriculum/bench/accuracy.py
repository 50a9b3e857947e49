"""Run time against error: every problem, contestant and step, over several starts.

A point is one problem and contestant, looked at every dt, after so many substeps. At 2 ms all take
1, 4 and 16, their own inner substeps counted: equal work. An engine that chooses its steps is asked
how many it took. Errors are medians over the starts, times medians over fresh processes, with least
and greatest, every height read at each look:

    awake   every step is taken, by everyone; this is what is plotted, and compared
    user    as a user gets it: balls may sleep where an engine has that, contact.py skips steps

The best of a family at equal work takes at most 16 substeps in 2 ms; at equal time it is any
setting at any step that stays, awake, within so many microseconds a ball for each 2 ms of motion.
"""

import statistics
from functools import partial

import numpy as np

import contact
from curriculum import parallel
from curriculum.bench import engines, problems, timing

ERRORS = ("error", "user_error", "final_error", "energy_error", "depth")
WAYS = {"awake": False, "user": True}  # whether balls may sleep
WORK, BUDGETS, BUDGET = 16, (1, 10, 100), 10  # substeps in 2 ms; us a ball in 2 ms
PROCESSES = 3
ENOUGH = 0.03  # s: once the runs of a point have taken so long, it is not timed again
QUICK = dict(names=("drop", "slide"), steps=((0.002, 1), (0.002, 4)), starts=1, processes=1)
STEPS = tuple((problems.REFERENCE_DT, substeps) for substeps in problems.SUBSTEPS)
STEPS += tuple((dt, 1) for dt in problems.COARSER)
CONTESTANTS = engines.OURS + engines.SETTINGS
BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS}
LABELS = {name: name for name in contact.MODELS} | {
    name: about[0] for name, about in engines.ENGINES.items()
}


def measure(quick=False):
    """The whole benchmark as one section: problems, points, the best, what is left out."""
    chosen = [p for p in problems.PROBLEMS if not quick or p.name in QUICK["names"]]
    jobs = list(cells(chosen, quick))
    print(f"accuracy: {len(jobs)} points, their errors first, then their times", flush=True)
    errors = parallel.run_jobs(errors_of, jobs, "errors")
    processes = QUICK["processes"] if quick else PROCESSES
    slow = {job for job in jobs if BY_NAME[job[1]].slow}  # one process has to be enough
    times = timing.in_fresh_processes(times_of, jobs, processes, "run times", slow)
    points = [point(*each) for each in zip(jobs, errors, times)]
    return dict(
        problems={
            p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration) for p in chosen
        },
        points=packed(points),
        headline=headline(points),
        in_time=headline(points, BUDGET),
        left_out=left_out(chosen),
    )


def cells(chosen, quick):
    """(problem, contestant, dt, substeps, starts) of every point, by names."""
    for problem in chosen:
        for c in CONTESTANTS:
            kept_out = not c.is_for(problem.name) or quick and c.engine == "drake"
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
    return substeps == 1 or substeps * c.inner <= WORK


def ways(job):
    """The WAYS in which a point is measured: as a user gets it only at the usual step."""
    asleep = BY_NAME[job[1]].sleeps and job[2] == problems.REFERENCE_DT
    return list(WAYS) if asleep else ["awake"]


def errors_of(job):
    """The errors of a point: a list of problems.quality's dicts, one a start."""
    name, contestant, dt, substeps, starts = job
    problem, found = problems.BY_NAME[name], []
    for start in range(starts):
        scene, quality = problem.build(start), {}
        for way in ways(job):
            session = BY_NAME[contestant].build(scene, dt, substeps, WAYS[way])
            states = session.states(problem.steps(dt))
            run = contact.Run(np.arange(len(states[0])) * dt, *states)
            quality[way] = problems.quality(problem, scene, run)
            quality[way]["work"] = work_of(BY_NAME[contestant], session, problem.steps(dt))
        user = quality.get("user", quality["awake"])
        found.append(quality["awake"] | {"user_error": user["error"]})
    return found


def work_of(c, session, looks):
    """Substeps a look; of Drake under error control those that it took, in the mean."""
    if "scheme" in c.options:
        return session.simulator.get_integrator().get_num_steps_taken() / looks
    return session.substeps * c.inner


def seconds_of(job, way, steps, timed=timing.timed):
    """CPU seconds that a point takes for these looks, without its preparation."""
    problem, name, dt, substeps, _ = job
    scene = problems.BY_NAME[problem].build(0)
    session = BY_NAME[name].build(scene, dt, substeps, WAYS[way])
    seconds, heights = timed(partial(session.trace, steps))
    if len(heights) != steps + 1:
        raise RuntimeError(f"{name} was looked at {len(heights)} times instead of {steps + 1}")
    return seconds


def times_of(job, timed=timing.timed):
    """{way: seconds} of a point: the median of up to three runs, after a short one as a warm-up."""
    steps = problems.BY_NAME[job[0]].steps(job[2])
    seconds = {way: [] for way in ways(job)}
    for way in seconds:
        seconds_of(job, way, min(50, steps))
    for _ in range(3):
        for way in seconds:
            seconds[way].append(seconds_of(job, way, steps, timed))
        if sum(map(sum, seconds.values())) > ENOUGH:
            break
    return {way: statistics.median(values) for way, values in seconds.items()}


def point(job, errors, times):
    """One point as a flat dict. diverged: of how many starts. An error that is none is None."""
    problem, name, dt, substeps, _ = job
    c = BY_NAME[name]
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
    found["least"] = min(e["error"] for e in errors)
    found["greatest"] = max(e["error"] for e in errors)
    for way in WAYS:
        about = timing.spread([1e3 * each.get(way, each["awake"]) for each in times])
        found |= {f"{way}_{which}": value for which, value in about.items()}
    return found


def allowed(p, budget=None, work=WORK):
    """Whether a point competes: at equal work, or within so many us a ball in 2 ms, awake."""
    if p["error"] is None or p["diverged"]:
        return False
    if budget is None:
        return p["dt"] == problems.REFERENCE_DT and p["work"] <= work
    looks = problems.BY_NAME[p["problem"]].duration / problems.REFERENCE_DT
    return p["awake_median"] <= 1e-3 * budget * p["balls"] * looks


def headline(points, *limits, **limit):
    """{problem: {family: {words, dt, error, ms, user_ms}}}: the setting with the least error.

    Of those that are allowed to compete; of equal errors, in three digits, the fastest. ms awake.
    """
    found = {}
    for p in points:
        if allowed(p, *limits, **limit):
            about = {key: p[key] for key in ("words", "dt", "error")}
            about |= dict(ms=p["awake_median"], user_ms=p["user_median"])
            rivals = found.setdefault(p["problem"], {})
            best = rivals.setdefault(p["family"], about)
            rivals[p["family"]] = min(best, about, key=rank)
    return found


def rank(about):
    """What decides between two settings: the error in three digits, then the time."""
    return float(f"{about['error']:.3g}"), about["ms"]


def left_out(chosen):
    """{label: why} of whoever does not run every problem."""
    return {
        LABELS[c.engine]: why
        for problem in chosen
        for c in CONTESTANTS
        if (why := c.refuses(problem.build(0)))
    }


def packed(rows):
    """{"columns": [...], "rows": [[...]]} of dicts with the same keys."""
    return {"columns": list(rows[0]), "rows": [list(row.values()) for row in rows]}


def unpacked(table):
    """Rows of a packed table, as dicts."""
    return [dict(zip(table["columns"], row)) for row in table["rows"]]
