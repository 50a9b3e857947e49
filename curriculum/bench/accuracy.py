"""Run time against error: every problem, method and time step, over nine start heights.

A point is one problem, method and dt. Its error is the median over the start heights; its time, in
each round, is the median over the start heights too, and of the rounds the least is plotted and the
rest drawn as spread. Rounds are interleaved over all points. Two times are kept:

    read    whole run with every height read after every step: the same sampling for all, plotted
    bare    the engines' stepping loop alone, nothing read. contact.py's models have no such form:
            they always record, so where a bare time is compared with, theirs is still the read one
"""

import math
import statistics
from typing import NamedTuple

import numpy as np

from curriculum.bench import timing
from curriculum.bench.methods import BARE, METHODS, OURS, READ
from curriculum.bench.problems import DTS, PROBLEMS, REFERENCE_DT, SEEDS, quality

BUDGET = 3.0            # s that the runs of one point may use up before it sits out further rounds
FIT_DTS = (0.0, 0.008)  # s, the steps whose errors the order of convergence is fitted to
ERRORS = ("height_error", "max_penetration", "rest_penetration", "contact_energy", "energy_excess",
          "restitution", "impact_time_error")


class Settings(NamedTuple):
    """How much to measure."""
    problems: tuple = PROBLEMS
    methods: tuple = METHODS
    dts: tuple = DTS
    seeds: tuple = SEEDS
    rounds: int = 9


QUICK = Settings(problems=tuple(p._replace(duration=0.25) if p.name == "tower" else p for p in PROBLEMS),
                 dts=(0.002, 0.008), seeds=SEEDS[:3], rounds=2)


def measure(quick=False):
    """The whole benchmark; returns a JSON-ready dict, whose points are described in `point` below."""
    return dict(quick=quick, **run(QUICK if quick else Settings()))


def run(settings):
    """Errors first, then the interleaved rounds of timing."""
    chosen, _, dts, seeds, rounds = settings
    present = [m for m in settings.methods if not m.missing]
    keys = [(p, m, dt) for p in chosen for m in present for dt in dts]
    bar = timing.Progress(len(keys) * len(seeds) * (1 + rounds), "run time against error")
    try:
        errors = {key: [_errors(*key, seed, bar) for seed in seeds] for key in keys}
        for p, m, dt in keys[::len(dts)]:                       # warm-up: first calls cost more
            for call in m.prepare(p.build(0), dts[-1], 10).values():
                call()
        seconds = _times(keys, seeds, rounds, bar)
    finally:
        bar.close()
    points = [point(p, m, dt, errors[p, m, dt], seconds[p, m, dt], seeds) for p, m, dt in keys]
    return dict(
        seeds=list(seeds), rounds=rounds, dts=list(dts),
        problems={p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration) for p in chosen},
        methods={m.name: dict(label=m.label, theory=m.order, why=m.why, missing=m.missing)
                 for m in settings.methods},
        headline=headline(points), points=points,
        orders=[fit(p.name, m.name, points) for p in chosen for m in present])


def _errors(problem, method, dt, seed, bar):
    scene = problem.build(seed)
    run = method.record(scene, dt, problem.steps(dt))
    bar(f"{problem.name} {method.label} dt {dt} errors")
    return quality(problem, scene, dt, run)


def _times(keys, seeds, rounds, bar):
    """{key: {way: [seconds, median over the start heights, one a round]}}"""
    result = {key: {} for key in keys}
    for _ in range(rounds):
        tasks = {}
        for p, m, dt in keys:
            spent = sum(sum(times) for times in result[p, m, dt].values()) * len(seeds)
            if spent > BUDGET:
                continue
            ways = (READ,) if m.name in OURS else (READ, BARE)
            for seed in seeds:
                for way in ways:
                    tasks[p, m, dt, way, seed] = _task(p, m, dt, way, seed)
        one = timing.interleave(tasks, 1, math.inf, lambda key: key[3] == READ and bar(
            f"{key[0].name} {key[1].label} dt {key[2]}"))
        for p, m, dt in keys:
            for way in (READ, BARE):
                values = [one[p, m, dt, way, s][0] for s in seeds if (p, m, dt, way, s) in one]
                if values:
                    result[p, m, dt].setdefault(way, []).append(statistics.median(values))
    return result


def _task(problem, method, dt, way, seed):
    return lambda: method.prepare(problem.build(seed), dt, problem.steps(dt))[way]


def point(problem, method, dt, errors, seconds, seeds):
    """One point as a dict: for each error its values over the start heights and their median.

    diverged is None, or the first start height that did: {seed, step, reason, count, of}.
    times: {way: {min, median, max, rounds, all}} of a whole run [s].
    """
    blown = [(seed, e) for seed, e in zip(seeds, errors) if e["blew_up_step"] is not None]
    first = blown[0] if blown else None
    result = dict(
        problem=problem.name, method=method.name, dt=dt, steps=problem.steps(dt),
        diverged=first and dict(seed=first[0], step=first[1]["blew_up_step"],
                                reason=first[1]["blew_up_reason"], count=len(blown), of=len(errors)),
        times={way: dict(timing.spread(values), all=values) for way, values in seconds.items()})
    for name in ERRORS:
        values = [e[name] for e in errors]
        result[name] = dict(median=float(np.median(values)), min=min(values), max=max(values), all=values)
    return result


def headline(points):
    """{problem: {method: {error, ms, bare_ms}}} at the reference step, for texts that quote a number.

    error is None where the method diverged; bare_ms is None for contact.py's models.
    """
    result = {}
    for p in points:
        if p["dt"] == REFERENCE_DT:
            bare = p["times"].get(BARE)
            result.setdefault(p["problem"], {})[p["method"]] = dict(
                error=None if p["diverged"] else p["height_error"]["median"],
                ms=1e3 * p["times"][READ]["min"], bare_ms=bare and 1e3 * bare["min"])
    return result


def fit(problem, method, points):
    """Observed order of convergence: slope of log(median height error) over log(dt) by least squares.

    Only steps in FIT_DTS that did not diverge count. None where fewer than three are left, or where
    all errors are rounding (under 1e-9 r): then there is nothing left to converge.
    """
    used = [(p["dt"], p["height_error"]["median"]) for p in points
            if (p["problem"], p["method"]) == (problem, method) and not p["diverged"]
            and FIT_DTS[0] <= p["dt"] <= FIT_DTS[1]]
    slope = None
    if len(used) >= 3 and max(e for _, e in used) > 1e-9:
        slope = float(np.polyfit(*np.log(np.array(used)).T, 1)[0])
    return dict(problem=problem, method=method, order=slope, points=len(used))
