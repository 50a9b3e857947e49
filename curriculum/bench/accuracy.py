"""Run time against error: every problem, contestant and time step, over nine starts.

A point is one problem, contestant and dt. Its errors are medians over the starts. Its time in one
process is the median over the starts too; the point has the median over the processes. Two times
are kept:

    read    whole run with every height read after every step: the same sampling for all, plotted
    bare    the engines' stepping loop alone, nothing read. contact.py's models have no such form:
            they always record, so where a bare time is compared with, theirs is still the read one
"""

import numpy as np

from curriculum import measured
from curriculum.bench import contestants, problems, tables, timing

COMMAND = "python -m curriculum.bench accuracy"
CODE = ("contact.py", "curriculum/exact.py")
ERRORS = (
    "position_error",
    "final_error",
    "energy_error",
    "final_energy_error",
    "max_penetration",
    "rest_gap",
    "contact_energy",
    "impact_time_error",
    "restitution",
    "phase_error",
)
BUDGET = 1.0  # s: once the runs of a cell have taken so long, no further start is timed
TIMED_SEEDS = 3  # starts that are timed
FIT_DTS = (0.0, 0.008)  # s, the steps whose errors the order of convergence is fitted to
QUICK_PROBLEMS, QUICK_DTS = ("drop", "bounce", "pyramid"), (0.002, 0.008)


def measure(quick=False, cells=None, only=None):
    """The whole benchmark as one section.

    only: measure this problem alone; of the others the section has those that `cells` hold whole.
    """
    processes, seeds = (1, 2) if quick else (3, 9)
    cells = {} if cells is None else cells
    chosen = [p for p in problems.PROBLEMS if not quick or p.name in QUICK_PROBLEMS]
    keys = {p.name: list(_keys(p, seeds, quick)) for p in chosen}
    work = [key for name, some in keys.items() if only in (None, name) for key in some]
    timing.beside(error_cell, work, cells, "error", "errors")
    timing.in_fresh_processes(time_cell, work, processes, cells, "run times")
    whole = [
        p for p in chosen if all(timing.place("time", 0, key) in cells for key in keys[p.name])
    ]
    done = [key for p in whole for key in keys[p.name]]
    times = timing.merged(cells, done, processes)
    points = [point(key, cells[timing.place("error", 0, key)], times[key]) for key in done]
    return dict(
        quick=quick,
        processes=processes,
        seeds=seeds,
        problems={
            p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration) for p in whole
        },
        left_out=left_out(whole),
        points=tables.pack(points),
        headline=headline(points),
        orders=[order for order in fits(points) if order["order"] is not None],
    )


def _keys(problem, seeds, quick):
    """(problem, contestant, dt, starts) of every cell of one problem."""
    scene = problem.build(0)
    for c in contestants.CONTESTANTS:
        if c.takes(problem) and not c.refuses(scene) and not (quick and c.family == "drake"):
            for dt in c.dts(problem):
                if not quick or dt in QUICK_DTS:
                    yield problem.name, c.name, dt, min(seeds, len(problem.seeds))


def headline(points):
    """{problem: {family: {words, error, ms}}}: the best setting of each at the reference step."""
    result = {}
    for p in sorted(points, key=lambda p: p["position_error"] or 0.0, reverse=True):
        if (
            p["dt"] == problems.REFERENCE_DT
            and not p["diverged"]
            and p["words"] != contestants.FLYING
        ):
            result.setdefault(p["problem"], {})[p["family"]] = dict(
                words=p["words"], error=p["position_error"], ms=1e3 * p["read_median"]
            )
    return result


def error_cell(key):
    """The errors of a cell: a list of problems.quality's dicts, one a start."""
    problem, contestant, dt, seeds = _parts(key)
    found = []
    for seed in problem.seeds[:seeds]:
        scene = problem.build(seed)
        run = contestant.record(scene, dt, problem.steps(dt))
        found.append(measured.plain(problems.quality(problem, scene, dt, run)))
    return found


def time_cell(key):
    """{way: seconds, median over the starts} of a cell, after a short run as a warm-up."""
    problem, contestant, dt, seeds = _parts(key)
    scene, seconds = problem.build(0), {}
    for call in contestant.prepare(scene, dt, min(50, problem.steps(dt))).values():
        call()
    for seed in problem.seeds[: min(seeds, TIMED_SEEDS)]:
        for way, call in contestant.prepare(problem.build(seed), dt, problem.steps(dt)).items():
            seconds.setdefault(way, []).append(timing.timed(call))
        if sum(map(sum, seconds.values())) > BUDGET:
            break
    return {way: float(np.median(values)) for way, values in seconds.items()}


def _parts(key):
    problem, contestant, dt, seeds = key
    return problems.BY_NAME[problem], contestants.BY_NAME[contestant], dt, seeds


def point(key, errors, times):
    """One point as a flat dict; an error that does not apply or is not finite is None.

    diverged is None, or "step K: why (so many of so many starts)", of the first start that did.
    """
    problem, contestant, dt, _ = key
    found = contestants.BY_NAME[contestant]
    blown = [e for e in errors if e["blew_up_step"] is not None]
    result = dict(
        problem=problem,
        family=found.family,
        words=found.words,
        dt=dt,
        diverged=None
        if not blown
        else (
            f"step {blown[0]['blew_up_step']}: {blown[0]['blew_up_reason']} "
            f"({len(blown)} of {len(errors)} starts)"
        ),
    )
    for name in ERRORS:
        values = [e.get(name) for e in errors]
        values = [value for value in values if value is not None]
        result[name] = float(np.median(values)) if len(values) == len(errors) else None
    worst = [e["position_error"] for e in errors if e["position_error"] is not None]
    result["least_error"], result["greatest_error"] = (
        min(worst, default=None),
        max(worst, default=None),
    )
    for way in (contestants.READ, contestants.BARE):
        about = times.get(way) or {}
        for which in ("median", "min", "max"):
            result[f"{way}_{which}"] = about.get(which)
    return result


def left_out(chosen):
    """[(problem, family, why)] of whoever does not run a problem."""
    found = {}
    for p in chosen:
        for c in contestants.CONTESTANTS:
            why = c.takes(p) and c.refuses(p.build(0))
            if why:
                found.setdefault((c.family, why), []).append(p.name)
    return [
        dict(family=family, why=why, problems=sorted(set(names), key=names.index))
        for (family, why), names in found.items()
    ]


def fits(points):
    """Observed order of convergence of every contestant on every problem: {problem, ..., order}.

    The slope of log(median worst error) over log(dt) by least squares, for steps in FIT_DTS that
    did not diverge. None where fewer than three are left, or where all errors are rounding
    (under 1e-9 r): then there is nothing left to converge.
    """
    names = dict.fromkeys((p["problem"], p["family"], p["words"]) for p in points)
    for problem, family, words in names:
        used = [
            (p["dt"], p["position_error"])
            for p in points
            if (p["problem"], p["family"], p["words"]) == (problem, family, words)
            and not p["diverged"]
            and FIT_DTS[0] <= p["dt"] <= FIT_DTS[1]
        ]
        slope = None
        if len(used) >= 3 and max(e for _, e in used) > 1e-9:
            slope = float(np.polyfit(*np.log(np.array(used)).T, 1)[0])
        yield dict(problem=problem, family=family, words=words, order=slope)
