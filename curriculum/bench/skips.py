"""What skipping costs and saves: same bytes with and without, and the time of runs and processes."""

import contextlib
import io
import statistics
import sys
import tempfile
from pathlib import Path

import contact
from curriculum.bench import methods, timing

ROOT = Path(contact.__file__).resolve().parent
SCENES = ("drop", "bounce", "stack")
SMOKE, FULL, DT = 800, 2000, 0.002
RECORDED, BARE_PEER = "drop, recorded", "pymunk, nothing read"
# whole processes, as multiples of importing numpy (RECORDED: rerun): to reach, and the published script's
LIMITS = {"drop": 1.8, "bounce": 2.0, "stack": 2.5, RECORDED: 1.5}
PUBLISHED = {"drop": 20.0, "bounce": 12.0, "stack": 61.0, RECORDED: 11.0}
MEMORY_LIMIT = 1.5


def measure(quick=False):
    """All parts; returns a JSON-ready dict: same_bytes, processes, in_process, speed_up."""
    return dict(quick=quick, same_bytes=same_bytes(quick), processes=processes(quick),
                in_process=in_process(quick), speed_up=speed_up(quick))


def bytes_cases(quick):
    """(scene, seed, bodies, model, dt, steps) of every pair of runs to compare."""
    seeds = range(2) if quick else range(10)
    grid = (1, 8, 32) if quick else contact.DT_GRID
    for scene in SCENES:
        for seed in seeds:
            for model in contact.MODELS:
                for factor in grid:
                    for steps in (SMOKE,) if quick else (SMOKE, FULL):
                        yield scene, seed, None, model, factor * DT, steps
    for seed, bodies in ((0, 50),) if quick else ((0, 50), (1, 50), (0, 300)):
        for model in ("penalty", "lcp"):
            for factor in (1, 8) if quick else contact.DT_GRID:
                yield "pile", seed, bodies, model, factor * DT, 100 if quick else 500


def same_bytes(quick):
    """Every run with and without skips: how many pairs, and which of them differ in any bit.

    Arrays first (every position and velocity of every step), then whole runs of the command line:
    standard output and metrics.json.
    """
    cases, differing = list(bytes_cases(quick)), []
    lines = [["--scene", scene, "--seed", str(seed), *length]
             for scene in SCENES for seed in (range(1) if quick else range(10))
             for length in ((["--smoke"],) if quick else (["--smoke"], []))]
    bar = timing.Progress(len(cases) + len(lines), "same bytes")
    for scene, seed, bodies, model, dt, steps in cases:
        built = contact.build_scene(scene, seed, bodies)
        one, other = (contact.run_model(model, built, dt, steps, skip=skip) for skip in (True, False))
        if any(getattr(one, part).tobytes() != getattr(other, part).tobytes() for part in "tqv"):
            differing.append(f"{scene}{' ' + str(bodies) if bodies else ''} {model} dt {dt:g} "
                             f"seed {seed} steps {steps}")
        bar(scene)
    for flags in lines:
        if _command_line(flags) != _command_line([*flags, "--no-skip"]):
            differing.append("contact.py " + " ".join(flags))
        bar("contact.py")
    bar.close()
    return dict(runs=len(cases), command_lines=len(lines), differing=differing)


def _command_line(flags):
    """What contact.main prints, and its metrics.json; the output folder's name left out."""
    with tempfile.TemporaryDirectory() as out:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            contact.main([*flags, "--no-rerun", "--out", out])
        return printed.getvalue().replace(out, "OUT"), (Path(out) / "metrics.json").read_bytes()


def processes(quick):
    """Whole processes, interleaved: {name: {seconds: [...], memory: [...]}}, and ratios of medians."""
    python = sys.executable
    with tempfile.TemporaryDirectory() as out:
        run = [python, "contact.py", "--out", out]
        commands = {"numpy": [python, "-c", "import numpy"],
                    **{scene: [*run, "--no-rerun", "--scene", scene] for scene in SCENES}}
        if _has_rerun():
            commands["rerun"] = [python, "-c", "import rerun"]
            commands[RECORDED] = [*run, "--rerun", "--scene", "drop"]
        rounds = 3 if quick else 15
        measured = {name: dict(seconds=[], memory=[]) for name in commands}
        bar = timing.Progress((rounds + 1) * len(commands), "whole processes")
        for round_ in range(rounds + 1):                    # the first one warms the disk cache
            for name, command in commands.items():
                seconds, memory = timing.whole_process(command, ROOT)
                if round_:
                    measured[name]["seconds"].append(seconds)
                    measured[name]["memory"].append(memory)
                bar(name)
        bar.close()
    median = {name: {part: statistics.median(values) for part, values in parts.items()}
              for name, parts in measured.items()}
    ratios = {name: dict(base=base, time=median[name]["seconds"] / median[base]["seconds"],
                         memory=median[name]["memory"] / median[base]["memory"])
              for name, base in [(s, "numpy") for s in SCENES] + [(RECORDED, "rerun")]
              if name in median}
    return dict(measured=measured, ratios=ratios)


def _has_rerun():
    from importlib.util import find_spec
    return find_spec("rerun") is not None


def in_process(quick):
    """2000 steps of the drop in this process: lcp with skips, against pymunk stepping the same ball."""
    scene, lcp = contact.build_scene("drop"), methods.BY_NAME["lcp"]
    tasks = {"lcp": lambda: lcp.prepare(scene, DT, FULL)[methods.READ]}
    pymunk = methods.BY_NAME["pymunk"]
    if not pymunk.missing:
        for way, name in ((methods.READ, "pymunk"), (methods.BARE, BARE_PEER)):
            tasks[name] = lambda way=way: pymunk.prepare(scene, DT, FULL)[way]
    seconds = timing.interleave(tasks, 5 if quick else 31, 60.0)
    return dict(missing=pymunk.missing, times={name: timing.spread(v) for name, v in seconds.items()})


def speed_up(quick):
    """Times of run_model with and without skips, per scene and model, and the ratio of the medians."""
    cases = [(scene, None, FULL) for scene in SCENES] + [("pile", 50, 50 if quick else 300)]
    rows, tasks = [], {}
    for scene, bodies, steps in cases:
        built = contact.build_scene(scene, 0, bodies)
        for model in ("penalty", "lcp"):
            for skip in (True, False):
                tasks[scene, model, skip] = (
                    lambda built=built, model=model, steps=steps, skip=skip:
                    lambda: contact.run_model(model, built, DT, steps, skip=skip))
    seconds = timing.interleave(tasks, 3 if quick else 11, 10.0)
    for scene, bodies, steps in cases:
        for model in ("penalty", "lcp"):
            skipped, taken = (timing.spread(seconds[scene, model, skip]) for skip in (True, False))
            rows.append(dict(scene=scene, bodies=bodies or len(contact.build_scene(scene).mass),
                             model=model, steps=steps, skip=skipped, no_skip=taken,
                             ratio=taken["median"] / skipped["median"]))
    return rows
