"""What whole processes take, skips and all, beside importing what they need."""

import importlib.util
import random
import sys
import tempfile

from curriculum.bench import timing

RECORDED = "drop, recorded"


def measure(quick=False):
    """processes: {name: median, min, max [s], base, ratio, least: ratio of the least times}."""
    python, rounds = sys.executable, 2 if quick else 15
    with tempfile.TemporaryDirectory() as out:
        run = [python, "contact.py", "--out", out]
        scenes = "drop", "bounce", "stack"
        commands = {scene: [*run, "--no-rerun", "--scene", scene] for scene in scenes}
        bases = dict.fromkeys(scenes, "numpy")
        if importlib.util.find_spec("rerun") is not None:
            commands[RECORDED], bases[RECORDED] = [*run, "--rerun", "--scene", "drop"], "rerun"
        commands |= {name: [python, "-c", f"import {name}"] for name in bases.values()}
        seconds = {name: [] for name in commands}
        for number in range(rounds + 1):
            for name in random.Random(number).sample(list(commands), len(commands)):
                seconds[name].append(timing.whole_process(commands[name], out))
    return dict(processes=over_bases(seconds, bases))


def over_bases(seconds, bases):
    """The spreads of {name: seconds}, some as ratios to their base; the first warms the caches."""
    found = {name: timing.spread(values[1:]) for name, values in seconds.items()}
    for name, base in bases.items():
        ratio, least = (found[name][which] / found[base][which] for which in ("median", "min"))
        found[name] |= dict(base=base, ratio=ratio, least=least)
    return found
