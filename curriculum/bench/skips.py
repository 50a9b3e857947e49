"""What whole processes take, skips and all; and the readable loops of lcp beside pymunk.

What skipping saves within a process stands in the section "accuracy": awake, and as a user gets it.
"""

import importlib.util
import sys
import tempfile
from functools import partial

import contact
from curriculum.bench import engines, timing

SCENES = "drop", "bounce", "stack"
DT, STEPS = 0.002, 2000
RECORDED = "drop, recorded"
# to reach: whole processes, in times of importing numpy (RECORDED: rerun)
RATIOS = {"ratio": "median", "least": "min"}
IN_PROCESS = {"drop": 1.0, "bounce": 1.0, "stack": 1.2}  # lcp, in times of pymunk
LIMITS = {"drop": 1.5, "bounce": 1.6, "stack": 2.2, RECORDED: 1.3}


def measure(quick=False):
    """processes: {name: spread [s], base, ratio, least}; in_process: {scene: spread of ratios}."""
    return {part.__name__: part(quick) for part in (processes, in_process)}


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
