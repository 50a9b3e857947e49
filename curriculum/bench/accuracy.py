"""Run time against error: every problem, contestant and time step, over several starts.

A point is one problem, contestant and dt. Its errors are medians over the starts; its times are
medians over fresh processes, with least and greatest:

    read    the whole run with every height read after every step: the same for all, and plotted
    bare    the engines' stepping loop alone, nothing read. contact.py's models have no such form:
            they always record
"""

import statistics
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

import contact
from curriculum import pool
from curriculum.bench import engines, problems, timing

COMMAND = "python -m curriculum.bench accuracy"
CODE = ("contact.py", "curriculum/exact.py", "curriculum/fast.py")
ERRORS = ("error", "final_error", "energy_error", "depth")
PROCESSES = 3
ENOUGH = 0.1        # s: once the runs of a cell have taken so long, it is not timed again
QUICK = dict(names=("drop", "stack", "slide"), dts=(0.002, 0.008), starts=2, processes=1)


class Contestant(NamedTuple):
    """One way of stepping a scene: a model of contact.py, or a setting of an engine."""

    family: str             # gives colour and marker
    words: str              # its setting, for a reader
    prepare: Callable       # (scene, dt, steps) -> {"read": call, "bare": call}; they step, no more
    record: Callable        # (scene, dt, steps) -> contact.Run, not timed
    refuses: Callable       # scene -> why it does not run it, or None
    adaptive: bool = False  # chooses its own steps: dt is only how often it is looked at
    only: tuple = ()        # the problems it is for; none means all

    @property
    def name(self):
        return f"{self.family}: {self.words}"

    def dts(self, problem):
        return (problems.REFERENCE_DT,) if self.adaptive else problem.dts


def nothing(scene):
    """What refuses a scene that anybody can run."""


def ours(family, words, compiled=False, substeps=1, only=(), adaptive=False, **knobs):
    """A model of contact.py: as run_model runs it, or by the compiled twin; steps cut in parts."""

    def record(scene, dt, steps):
        chosen, many = contact.Settings(**knobs), substeps * steps
        if compiled:
            from curriculum import fast
            found = fast.simulate(family, scene, dt / substeps, many, chosen)[:2]
        else:
            found = contact.run_model(family, scene, dt / substeps, many, chosen)[1:3]
        return contact.Run(np.arange(steps + 1) * dt, *(part[::substeps] for part in found))

    def prepare(scene, dt, steps):
        return {"read": partial(record, scene, dt, steps)}

    return Contestant(family, words, prepare, record, nothing, adaptive, only)


def theirs(setting):
    """A setting of another engine."""

    def prepare(scene, dt, steps):
        read, bare = setting.build(scene, dt), setting.build(scene, dt)
        return {"read": partial(read.trace, steps), "bare": partial(bare.advance, steps)}

    def record(scene, dt, steps):
        return contact.Run(np.arange(steps + 1) * dt, *setting.build(scene, dt).states(steps))

    missing = engines.missing(setting.engine)
    return Contestant(setting.engine, setting.words, prepare, record,
                      lambda scene: missing or setting.refuses(scene), setting.adaptive)


MANY = ("stack", "pile")        # where contacts share balls, and the number of sweeps matters
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
    ours("lcp", "compiled, 5 sweeps, 16 substeps, warm", True, 16, MANY, iters=5, warm=0.8),
    ours("soft", "as MuJoCo ships it, or direct where e > 0"),
    ours("soft", "time constant 2 dt, ratio 5, d 0.9999", only=("drop", "slide", *MANY), **STIFF),
    ours("exact", "event to event", adaptive=True),
    *map(theirs, engines.SETTINGS))
BY_NAME = {contestant.name: contestant for contestant in CONTESTANTS}
LABELS = {name: name for name in contact.MODELS} | {
    name: about[0] for name, about in engines.ENGINES.items()}


def measure(quick=False):
    """The whole benchmark as one section: problems, points, headline, what is left out."""
    chosen = [p for p in problems.PROBLEMS if not quick or p.name in QUICK["names"]]
    jobs = list(cells(chosen, quick))
    print(f"accuracy: {len(jobs)} points, their errors first, then their times", flush=True)
    errors = pool.spread(errors_of, jobs, "errors")
    times = timing.in_fresh_processes(times_of, jobs, QUICK["processes"] if quick else PROCESSES,
                                      "run times")
    points = [point(*each) for each in zip(jobs, errors, times)]
    return dict(
        problems={p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration)
                  for p in chosen},
        points=packed(points), headline=headline(points), left_out=left_out(chosen))


def cells(chosen, quick):
    """(problem, contestant, dt, starts) of every point, by names."""
    for problem in chosen:
        scene = problem.build(0)
        for c in CONTESTANTS:
            if not runs(c, problem, scene) or (quick and c.family == "drake"):
                continue
            for dt in c.dts(problem):
                if not quick or dt in QUICK["dts"]:
                    yield (problem.name, c.name, dt, QUICK["starts"] if quick else problem.starts)


def runs(contestant, problem, scene):
    """Whether a contestant takes part in a problem."""
    if contestant.family == "exact" and problem.exact_is_the_truth:
        return False
    for_it = not contestant.only or problem.name in contestant.only
    return for_it and not contestant.refuses(scene)


def errors_of(job):
    """The errors of a cell: a list of problems.quality's dicts, one a start."""
    problem, contestant, dt, starts = job
    problem, found = problems.BY_NAME[problem], []
    for start in range(starts):
        scene = problem.build(start)
        run = BY_NAME[contestant].record(scene, dt, problem.steps(dt))
        found.append(problems.quality(problem, scene, run))
    return found


def times_of(job):
    """{way: seconds} of a cell: the median of up to three runs, after a short one as a warm-up."""
    problem, contestant, dt, _ = job
    problem, contestant = problems.BY_NAME[problem], BY_NAME[contestant]
    scene, steps, seconds = problem.build(0), problem.steps(dt), {}
    for call in contestant.prepare(scene, dt, min(50, steps)).values():
        call()
    for _ in range(3):
        for way, call in contestant.prepare(scene, dt, steps).items():
            seconds.setdefault(way, []).append(timing.timed(call))
        if sum(map(sum, seconds.values())) > ENOUGH:
            break
    return {way: statistics.median(values) for way, values in seconds.items()}


def point(job, errors, times):
    """One point as a flat dict. diverged: of how many starts. An error that is none is None."""
    problem, contestant, dt, _ = job
    c = BY_NAME[contestant]
    found = dict(problem=problem, family=c.family, words=c.words, dt=dt,
                 diverged=sum(e["diverged"] is not None for e in errors))
    for name in ERRORS:
        found[name] = statistics.median(e[name] for e in errors)
    found["least"] = min(e["error"] for e in errors)
    found["greatest"] = max(e["error"] for e in errors)
    for way in ("read", "bare"):
        values = [1e3 * each[way] for each in times if way in each]
        about = timing.spread(values) if values else {}
        for which in ("median", "min", "max"):
            found[f"{way}_{which}"] = about.get(which)
    return found


def headline(points):
    """{problem: {family: {words, error, ms}}}: the setting with the least error at 2 ms."""
    found = {}
    for p in sorted(points, key=lambda p: p["error"], reverse=True):
        if p["dt"] == problems.REFERENCE_DT and not p["diverged"]:
            found.setdefault(p["problem"], {})[p["family"]] = dict(
                words=p["words"], error=p["error"], ms=p["read_median"])
    return found


def left_out(chosen):
    """{label: why} of whoever does not run every problem."""
    return {LABELS[c.family]: why for problem in chosen for c in CONTESTANTS
            if (why := c.refuses(problem.build(0)))}


def packed(rows):
    """{"columns": [...], "rows": [[...]]} of dicts with the same keys."""
    return {"columns": list(rows[0]), "rows": [list(row.values()) for row in rows]}


def unpacked(table):
    """The dicts again."""
    return [dict(zip(table["columns"], row)) for row in table["rows"]]
