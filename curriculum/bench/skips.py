"""What skipping costs and saves: same bits with and without, and the time of runs and processes."""

import importlib.util
import itertools
import statistics
import sys
import tempfile
from functools import partial

import contact
from curriculum.bench import accuracy, engines, timing
from curriculum.run import pool

SCENES, STEPPED = ("drop", "bounce", "stack"), ("penalty", "lcp", "soft")
DT, STEPS = 0.002, 2000
RECORDED = "drop, recorded"
# to reach: whole processes, in times of importing numpy (RECORDED: rerun); lcp, in times of pymunk
LIMITS = {"drop": 1.5, "bounce": 1.6, "stack": 2.2, RECORDED: 1.5}
LCP_LIMITS = {"drop": 1.0, "bounce": 1.0, "stack": 1.2}


def measure(quick=False):
    """same_bits, processes, lcp against pymunk, and the speed-up of every scene and model."""
    found = {}
    for part in (same_bits, processes, against_pymunk, speed_up):
        print(f"skip: {part.__name__}", flush=True)
        found[part.__name__] = part(quick)
    return found


def cases(quick):
    """(scene, seed, balls, model, dt, steps) of every pair of runs to compare."""
    seeds, grid = (1, (1, 8)) if quick else (5, contact.DT_GRID)
    steps = 800 if quick else STEPS
    for scene, seed, model, factor in itertools.product(SCENES, range(seeds), STEPPED, grid):
        yield scene, seed, None, model, factor * DT, steps
    for balls, model in itertools.product((24,) if quick else (24, 60), STEPPED):
        yield "pile", 0, balls, model, DT, 100 if quick else 1500


def same_bits(quick):
    """How many pairs of runs, with and without skips, and which of them differ in any bit.

    Every position and velocity of every step, and the count of unsettled steps; of larger piles by
    the compiled twin and by the plain loops.
    """
    jobs = list(cases(quick))
    same = pool.spread(is_same, jobs, "same bits")
    return dict(
        runs=len(jobs),
        differing=[" ".join(map(str, job)) for job, fine in zip(jobs, same) if not fine],
    )


def is_same(case):
    """Whether a run has the same bits with and without skips."""
    scene, seed, balls, model, dt, steps = case
    scene = contact.build_scene(scene, seed, balls)
    one, other = (
        contact.run_model(model, scene, dt, steps, contact.Settings(skip=skip))
        for skip in (True, False)
    )
    same = all(a.tobytes() == b.tobytes() for a, b in zip(one[:3], other[:3]))
    return same and one.unsettled == other.unsettled


def processes(quick):
    """{name: median, min, max [s], base, ratio, least: ratio of the least times} of processes."""
    python, rounds = sys.executable, 3 if quick else 15
    with tempfile.TemporaryDirectory() as out:
        run = [python, "contact.py", "--out", out]
        commands = {
            "numpy": [python, "-c", "import numpy"],
            **{scene: [*run, "--no-rerun", "--scene", scene] for scene in SCENES},
        }
        if importlib.util.find_spec("rerun") is not None:
            commands |= {
                "rerun": [python, "-c", "import rerun"],
                RECORDED: [*run, "--rerun", "--scene", "drop"],
            }
        seconds = timing.interleave(
            {
                name: partial(timing.whole_process, command, out)
                for name, command in commands.items()
            },
            rounds + 1,
        )
    # the first round warms the disk cache and the bytecode
    found = {name: timing.spread(values[1:]) for name, values in seconds.items()}
    for name in LIMITS:
        base = "rerun" if name == RECORDED else "numpy"
        if name in found:
            found[name] |= dict(
                base=base,
                ratio=found[name]["median"] / found[base]["median"],
                least=found[name]["min"] / found[base]["min"],
            )
    return found


def against_pymunk(quick):
    """{scene: {lcp, pymunk: spread [ms], ratio}}: 2000 steps in this process, pymunk unread."""
    found, ways = {}, {"lcp: 20 sweeps": "read", "pymunk: 10 iterations": "bare"}
    for name in SCENES if not engines.missing("pymunk") else ():
        given = contact.build_scene(name), DT, STEPS
        tasks = {
            setting.split(":")[0]: partial(accuracy.seconds_of, setting, way, *given)
            for setting, way in ways.items()
        }
        times = {
            key: timing.spread([1e3 * value for value in values])
            for key, values in timing.interleave(tasks, 5 if quick else 31).items()
        }
        found[name] = dict(times, ratio=times["lcp"]["median"] / times["pymunk"]["median"])
    return found


def speed_up(quick):
    """[{scene, model, skipped, taken [ms], ratio}]: medians of runs with and without skips."""
    rows = []
    for name, model in itertools.product(SCENES, STEPPED):
        given = model, contact.build_scene(name), DT, STEPS
        runs = {
            skip: partial(contact.run_model, *given, contact.Settings(skip=skip))
            for skip in (True, False)
        }
        times = timing.interleave(
            {skip: partial(timing.timed, run) for skip, run in runs.items()}, 2 if quick else 7
        )
        skipped, taken = (1e3 * statistics.median(times[skip]) for skip in (True, False))
        rows.append(
            dict(scene=name, model=model, skipped=skipped, taken=taken, ratio=taken / skipped)
        )
    return rows
