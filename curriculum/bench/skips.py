"""What skipping costs and saves: same bytes with and without, and the time of runs and processes."""

import contextlib
import importlib.util
import io
import random
import statistics
import sys
import tempfile
from pathlib import Path

import contact
from curriculum import measured
from curriculum.bench import contestants, timing

SCENES = ("drop", "bounce", "stack")
STEPPED = ("penalty", "lcp", "soft")  # the models that step, and so can skip
SMOKE, FULL, DT, STEPS_AT_REST = 800, 2000, 0.002, 1000
COMMAND = "python -m curriculum.bench skip"
CODE = ("contact.py", "curriculum/exact.py", "curriculum/piles.py")
RECORDED, BARE_PEER = "drop, recorded", "pymunk, nothing read"
# whole processes, as multiples of importing numpy (RECORDED: rerun): to reach, and the published script's
LIMITS = {"drop": 1.5, "bounce": 1.6, "stack": 2.2, RECORDED: 1.5}
PUBLISHED = {"drop": 20.0, "bounce": 12.0, "stack": 61.0, RECORDED: 11.0}
MEMORY_LIMIT = 1.5
REST_LIMIT = 2e-6  # s a step of one resting ball, every step taken


def measure(quick=False, cells=None):
    """All parts; returns a JSON-ready dict: same_bytes, processes, in_process, resting, speed_up."""
    cells = {} if cells is None else cells
    parts = dict(
        same_bytes=same_bytes,
        processes=processes,
        in_process=in_process,
        resting=resting,
        speed_up=speed_up,
    )
    for name, part in parts.items():
        if name not in cells:
            cells[name] = measured.plain(part(quick))
    return dict(quick=quick, **{name: cells[name] for name in parts})


def bytes_cases(quick):
    """(scene, seed, bodies, model, dt, steps) of every pair of runs to compare."""
    seeds, grid = (2, (1, 8, 32)) if quick else (5, contact.DT_GRID)
    for scene in SCENES:
        for seed in range(seeds):
            for model in STEPPED:
                for factor in grid:
                    yield scene, seed, None, model, factor * DT, SMOKE if quick else FULL
    for seed, bodies in ((0, 50),) if quick else ((0, 50), (1, 50), (0, 300)):
        for model in ("penalty", "lcp"):
            for factor in (1, 8) if quick else contact.DT_GRID:
                yield "pile", seed, bodies, model, factor * DT, 50 if quick else 300


def same_bytes(quick):
    """Every run with and without skips: how many pairs, and which of them differ in any bit.

    Arrays first (every position and velocity of every step; of a pile, by the compiled twin and by
    the plain loops), then whole runs of the command line: standard output and metrics.json.
    """
    cases, differing = list(bytes_cases(quick)), []
    lines = [
        ["--scene", scene, "--seed", str(seed), *length]
        for scene in SCENES
        for seed in (range(1) if quick else range(3))
        for length in ((["--smoke"],) if quick else (["--smoke"], []))
    ]
    with measured.progress(len(cases) + len(lines), "same bytes") as tick:
        for scene, seed, bodies, model, dt, steps in cases:
            built = contact.build_scene(scene, seed, bodies)
            one, other = (
                contact.run_model(model, built, dt, steps, skip=skip) for skip in (True, False)
            )
            if any(
                getattr(one, part).tobytes() != getattr(other, part).tobytes() for part in "tqv"
            ):
                differing.append(
                    f"{scene}{' ' + str(bodies) if bodies else ''} {model} dt {dt:g} "
                    f"seed {seed} steps {steps}"
                )
            tick(scene)
        for flags in lines:
            if _command_line(flags) != _command_line([*flags, "--no-skip"]):
                differing.append("contact.py " + " ".join(flags))
            tick("contact.py")
    return dict(runs=len(cases), command_lines=len(lines), differing=differing)


def _command_line(flags):
    """What contact.main prints, and its metrics.json; the output folder's name left out."""
    with tempfile.TemporaryDirectory() as out:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            contact.main([*flags, "--no-rerun", "--out", out])
        return printed.getvalue().replace(out, "OUT"), (Path(out) / "metrics.json").read_bytes()


def processes(quick):
    """Whole processes, in rounds of random order: {name: {seconds: [...], memory: [...]}}, ratios."""
    python = sys.executable
    with tempfile.TemporaryDirectory() as out:
        run = [python, "contact.py", "--out", out]
        commands = {
            "numpy": [python, "-c", "import numpy"],
            **{scene: [*run, "--no-rerun", "--scene", scene] for scene in SCENES},
        }
        if importlib.util.find_spec("rerun") is not None:
            commands["rerun"] = [python, "-c", "import rerun"]
            commands[RECORDED] = [*run, "--rerun", "--scene", "drop"]
        rounds = 3 if quick else 15
        found = {name: dict(seconds=[], memory=[]) for name in commands}
        with measured.progress((rounds + 1) * len(commands), "whole processes") as tick:
            for number in range(rounds + 1):  # the first warms the disk cache and the bytecode
                for name in random.Random(number).sample(list(commands), len(commands)):
                    seconds, memory = timing.whole_process(
                        commands[name], measured.ROOT, Path(out) / "bytecode"
                    )
                    if number:
                        found[name]["seconds"].append(seconds)
                        found[name]["memory"].append(memory)
                    tick(name)
    median = {
        name: {part: statistics.median(values) for part, values in parts.items()}
        for name, parts in found.items()
    }
    ratios = {
        name: dict(
            base=base,
            time=median[name]["seconds"] / median[base]["seconds"],
            memory=median[name]["memory"] / median[base]["memory"],
        )
        for name, base in [(s, "numpy") for s in SCENES] + [(RECORDED, "rerun")]
        if name in median
    }
    return dict(measured=found, ratios=ratios)


def in_process(quick):
    """2000 steps of the drop in this process: lcp with skips, against pymunk stepping the same ball."""
    scene = contact.build_scene("drop")
    lcp = contestants.BY_NAME["lcp: 20 sweeps"]
    pymunk = contestants.BY_NAME["pymunk: 10 iterations"]
    tasks = {"lcp": lambda: lcp.prepare(scene, DT, FULL)[contestants.READ]}
    missing = pymunk.refuses(scene)
    if not missing:
        for way, name in ((contestants.READ, "pymunk"), (contestants.BARE, BARE_PEER)):
            tasks[name] = lambda way=way: pymunk.prepare(scene, DT, FULL)[way]
    seconds = timing.interleave(tasks, 5 if quick else 31)
    return dict(missing=missing, times={name: timing.spread(v) for name, v in seconds.items()})


def resting(quick):
    """Seconds a step of one ball that rests on the table, by model: every step taken, none recorded."""
    rest = contact.build_scene("drop")
    rest.q0[1] = contact.RADIUS
    solref, solimp = contact.soft_defaults(0.0, DT)
    steps = {
        "penalty": lambda balls: contact.penalty_step(balls, DT, 1e4, rest.damping),
        "lcp": lambda balls: contact.lcp_step(balls, DT, 0.0, 0.2, 20),
        "soft": lambda balls: contact.soft_step(balls, DT, solref, solimp),
    }

    def task(step):
        balls = contact.make_balls(rest)
        for _ in range(500):
            step(balls)

        def call():
            for _ in range(STEPS_AT_REST):
                step(balls)

        return call

    seconds = timing.interleave(
        {name: lambda step=step: task(step) for name, step in steps.items()}, 3 if quick else 15
    )
    return {
        name: timing.spread([value / STEPS_AT_REST for value in values])
        for name, values in seconds.items()
    }


def speed_up(quick):
    """Times of run_model with and without skips, per scene and model, and the ratio of the medians."""
    cases = [(scene, None, FULL) for scene in SCENES] + [("pile", 50, 50 if quick else 300)]
    rows, tasks = [], {}
    for scene, bodies, steps in cases:
        built = contact.build_scene(scene, 0, bodies)
        for model in ("penalty", "lcp"):
            for skip in (True, False):
                tasks[scene, model, skip] = (
                    lambda built=built, model=model, steps=steps, skip=skip: (
                        lambda: contact.run_model(model, built, DT, steps, skip=skip)
                    )
                )
    seconds = timing.interleave(tasks, 3 if quick else 11)
    for scene, bodies, steps in cases:
        for model in ("penalty", "lcp"):
            skipped, taken = (timing.spread(seconds[scene, model, skip]) for skip in (True, False))
            rows.append(
                dict(
                    scene=scene,
                    bodies=bodies or len(contact.build_scene(scene).mass),
                    model=model,
                    steps=steps,
                    skip=skipped,
                    no_skip=taken,
                    ratio=taken["median"] / skipped["median"],
                )
            )
    return rows
