"""Run time against error: every problem, contestant and time step, over several starts.

A point is one problem, contestant and dt. Its errors are medians over the starts; its times are
medians over fresh processes, with least and greatest:

    read    the whole run with every height read after every step: the same for all, and plotted
    bare    the engines' stepping loop alone, nothing read. contact.py's models have no such form:
            they always record
"""

import statistics
from functools import partial

import numpy as np

import contact
from curriculum.bench import engines, problems, timing
from curriculum.bench.engines import Setting
from curriculum.run import pool

ERRORS = ("error", "final_error", "energy_error", "depth")
PROCESSES = 3
ENOUGH = 0.1  # s: once the runs of a cell have taken so long, it is not timed again
QUICK = dict(names=("drop", "stack", "slide"), dts=(0.002, 0.008), starts=2, processes=1)


class Model(engines.Session):
    """A model of contact.py: as run_model runs it, or by the compiled twin; steps cut in parts.

    It always records, so it has no bare form.
    """

    def __init__(self, scene, dt, model, compiled=False, substeps=1, **knobs):
        self.given, self.substeps = (model, scene, dt / substeps), substeps
        self.compiled, self.settings = compiled, contact.Settings(**knobs)

    def states(self, n):
        if self.compiled:
            from curriculum import fast

            _, q, v, _ = fast.simulate(*self.given, n * self.substeps, self.settings)
        else:
            _, q, v, _ = contact.run_model(*self.given, n * self.substeps, self.settings)
        return q[:: self.substeps], v[:: self.substeps]

    trace = states


def ours(model, words, *cut, only=(), adaptive=False, **knobs):
    """A setting of a model of contact.py."""

    def build(scene, dt):
        return Model(scene, dt, model, *cut, **knobs)

    return Setting(model, words, build, adaptive, only=only)


ANSWERED = ("drop", "bounce", "stack", "slide", "elastic")  # not by exact itself
MANY = ("stack", "pile")  # where contacts share balls, and the number of sweeps matters
STIFF = dict(solref=(1e-9, 5.0), solimp=contact.HARD)
CONTESTANTS = (
    ours("penalty", "k 1e4"),
    ours("lcp", "20 sweeps"),
    ours("lcp", "10 sweeps", only=MANY, iters=10),
    ours("lcp", "100 sweeps", only=MANY, iters=100),
    ours("lcp", "20 sweeps, warm", only=MANY, warm=0.8),
    ours("lcp", "20 sweeps, 4 substeps", substeps=4),
    ours("lcp", "compiled, 20 sweeps", True),
    ours("lcp", "compiled, 20 sweeps, warm", True, only=MANY, warm=0.8),
    ours("lcp", "compiled, 20 sweeps, 4 substeps", True, 4),
    ours("lcp", "compiled, 20 sweeps, 16 substeps", True, 16),
    ours("lcp", "compiled, 5 sweeps, 16 substeps, warm", True, 16, only=MANY, iters=5, warm=0.8),
    ours("soft", "as MuJoCo ships it, or direct where e > 0"),
    ours("soft", "time constant 2 dt, ratio 5, d 0.9999", only=("drop", "slide", *MANY), **STIFF),
    ours("exact", "event to event", only=ANSWERED, adaptive=True),
    *engines.SETTINGS,
)
BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS}
LABELS = {name: name for name in contact.MODELS} | {
    name: about[0] for name, about in engines.ENGINES.items()
}


def measure(quick=False):
    """The whole benchmark as one section: problems, points, headline, what is left out."""
    chosen = [p for p in problems.PROBLEMS if not quick or p.name in QUICK["names"]]
    jobs = list(cells(chosen, quick))
    print(f"accuracy: {len(jobs)} points, their errors first, then their times", flush=True)
    errors = pool.spread(errors_of, jobs, "errors")
    times = timing.in_fresh_processes(
        times_of, jobs, QUICK["processes"] if quick else PROCESSES, "run times"
    )
    points = [point(*each) for each in zip(jobs, errors, times)]
    return dict(
        problems={
            p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration) for p in chosen
        },
        points=packed(points),
        headline=headline(points),
        left_out=left_out(chosen),
    )


def cells(chosen, quick):
    """(problem, contestant, dt, starts) of every point, by names."""
    for problem in chosen:
        for c in CONTESTANTS:
            kept_out = c.only and problem.name not in c.only or quick and c.engine == "drake"
            if kept_out or c.refuses(problem.build(0)):
                continue
            for dt in (problems.REFERENCE_DT,) if c.adaptive else problem.dts:
                if not quick or dt in QUICK["dts"]:
                    yield (problem.name, c.name, dt, QUICK["starts"] if quick else problem.starts)


def errors_of(job):
    """The errors of a cell: a list of problems.quality's dicts, one a start."""
    problem, contestant, dt, starts = job
    problem, found = problems.BY_NAME[problem], []
    for start in range(starts):
        scene = problem.build(start)
        states = BY_NAME[contestant].build(scene, dt).states(problem.steps(dt))
        run = contact.Run(np.arange(len(states[0])) * dt, *states)
        found.append(problems.quality(problem, scene, run))
    return found


def seconds_of(name, way, scene, dt, steps):
    """CPU seconds that a contestant takes for these steps, without its preparation."""
    session = BY_NAME[name].build(scene, dt)
    return timing.timed(partial(session.trace if way == "read" else session.advance, steps))


def times_of(job):
    """{way: seconds} of a cell: the median of up to three runs, after a short one as a warm-up."""
    problem, name, dt, _ = job
    scene, steps = problems.BY_NAME[problem].build(0), problems.BY_NAME[problem].steps(dt)
    ways = ("read", "bare") if BY_NAME[name].engine in engines.ENGINES else ("read",)
    seconds = {way: [] for way in ways}
    for way in ways:
        seconds_of(name, way, scene, dt, min(50, steps))
    for _ in range(3):
        for way in ways:
            seconds[way].append(seconds_of(name, way, scene, dt, steps))
        if sum(map(sum, seconds.values())) > ENOUGH:
            break
    return {way: statistics.median(values) for way, values in seconds.items()}


def point(job, errors, times):
    """One point as a flat dict. diverged: of how many starts. An error that is none is None."""
    problem, name, dt, _ = job
    c = BY_NAME[name]
    found = dict(
        problem=problem,
        family=c.engine,
        words=c.words,
        dt=dt,
        diverged=sum(e["diverged"] is not None for e in errors),
    )
    for key in ERRORS:
        found[key] = statistics.median(e[key] for e in errors)
    found["least"] = min(e["error"] for e in errors)
    found["greatest"] = max(e["error"] for e in errors)
    for way in ("read", "bare"):
        about = timing.spread([1e3 * each[way] for each in times]) if way in times[0] else {}
        for which in ("median", "min", "max"):
            found[f"{way}_{which}"] = about.get(which)
    return found


def headline(points):
    """{problem: {family: {words, error, ms}}}: the setting with the least error at 2 ms."""
    found = {}
    for p in sorted(points, key=lambda p: p["error"], reverse=True):
        if p["dt"] == problems.REFERENCE_DT and not p["diverged"]:
            found.setdefault(p["problem"], {})[p["family"]] = dict(
                words=p["words"], error=p["error"], ms=p["read_median"]
            )
    return found


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
    """The dicts again."""
    return [dict(zip(table["columns"], row)) for row in table["rows"]]
