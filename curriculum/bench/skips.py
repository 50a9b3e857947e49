"""What skipping costs and saves: the same bits with and without, and the time of whole processes.

The readable loops of lcp, skips and all, also race pymunk within this process.

What it saves within a process stands in the section "accuracy": awake, and as a user gets it.
"""

import importlib.util
import itertools
import sys
import tempfile
from functools import partial

import contact
from curriculum import parallel
from curriculum.bench import engines, timing

SCENES, STEPPED = ("drop", "bounce", "stack"), ("penalty", "lcp", "soft")
DT, STEPS = 0.002, 2000
RECORDED = "drop, recorded"
# to reach: whole processes, in times of importing numpy (RECORDED: rerun)
RATIOS = {"ratio": "median", "least": "min"}
IN_PROCESS = {"drop": 1.0, "bounce": 1.0, "stack": 1.2}  # lcp, in times of pymunk
LIMITS = {"drop": 1.5, "bounce": 1.6, "stack": 2.2, RECORDED: 1.3}


def measure(quick=False):
    """same_bits: {runs, differing}; processes: {name: spread [s], base, ratio, least},
    in_process: {scene: spread of ratios}."""
    parts = (same_bits, processes, in_process)
    return {part.__name__: part(quick) for part in parts}


def cases(quick):
    """(scene, seed, balls, model, dt, steps) of every pair of runs to compare."""
    seeds, grid = (1, (1, 8)) if quick else (5, contact.DT_GRID)
    steps = 800 if quick else STEPS
    for scene, seed, model, factor in itertools.product(SCENES, range(seeds), STEPPED, grid):
        yield scene, seed, None, model, factor * DT, steps
    for balls, model in itertools.product((24,) if quick else (24, 60), STEPPED):
        yield "pile", 0, balls, model, DT, 100 if quick else 1500


def same_bits(quick):
    """How many pairs of runs, with and without skips, and which of them differ in any bit."""
    jobs = list(cases(quick))
    same = parallel.run_jobs(is_same, jobs, "same bits")
    names = [" ".join(map(str, job)) for job, fine in zip(jobs, same) if not fine]
    return dict(runs=len(jobs), differing=names)


def is_same(case, run=contact.run_model):
    """Whether a run has the same bits with and without skips: every state, and what unsettled.

    Of larger piles by the compiled twin and by the plain loops.
    """
    scene, seed, balls, model, dt, steps = case
    given = model, contact.build_scene(scene, seed, balls), dt, steps
    one, other = (run(*given, contact.Settings(skip=skip)) for skip in (True, False))
    same = all(a.tobytes() == b.tobytes() for a, b in zip(one[:3], other[:3]))
    return same and one.unsettled == other.unsettled


def processes(quick):
    """{name: median, min, max [s], base, ratio, least: ratio of the least times} of processes."""
    python, rounds = sys.executable, 2 if quick else 15
    with tempfile.TemporaryDirectory() as out:
        run = [python, "contact.py", "--out", out]
        commands = {scene: [*run, "--no-rerun", "--scene", scene] for scene in SCENES}
        bases = dict.fromkeys(SCENES, "numpy")
        if importlib.util.find_spec("rerun") is not None:
            commands[RECORDED], bases[RECORDED] = [*run, "--rerun", "--scene", "drop"], "rerun"
        commands |= {name: [python, "-c", f"import {name}"] for name in bases.values()}
        tasks = {name: partial(timing.whole_process, each, out) for name, each in commands.items()}
        return over_bases(timing.interleave(tasks, rounds + 1), bases)


def over_bases(seconds, bases):
    """The spreads of {name: seconds}, some as ratios to their base; the first warms the caches."""
    found = {name: timing.spread(values[1:]) for name, values in seconds.items()}
    for name, base in bases.items():
        ratios = {how: found[name][which] / found[base][which] for how, which in RATIOS.items()}
        found[name] |= dict(base=base, **ratios)
    return found


def in_process(quick):
    """{scene: spread of lcp's CPU time over that of pymunk, 10 iterations and nothing read}."""
    found, rounds = {}, 3 if quick else 15
    for name in () if engines.not_installed("pymunk") else SCENES:
        runs = [partial(run, contact.build_scene(name)) for run in (by_lcp, by_pymunk)]
        tasks = {run.func: partial(timing.timed, run) for run in runs}
        seconds = timing.interleave(tasks, rounds + 1).values()  # the first imports and warms
        found[name] = timing.spread([mine[0] / other[0] for mine, other in zip(*seconds)][1:])
    return found


def by_lcp(scene):
    return contact.run_model("lcp", scene, DT, STEPS)


def by_pymunk(scene):
    session = engines.Pymunk(scene, DT, iterations=10)
    session.step = partial(session.space.step, DT)  # Python beside Python
    return session.go(STEPS)
