"""exact in piles and towers, beside 80 bits, 120 digits and the first edition: results/exact.md.

    python -m curriculum.stress.exact_sweep            minutes; writes curriculum/stress/results
    python -m curriculum.stress.exact_sweep --quick    seconds, for CI; into outputs/exact-quick

A run that was interrupted goes on where it stopped (--fresh: from the beginning); what is finished
is kept in outputs/stress-work for as long as the code stays the same.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from shutil import unpack_archive

import numpy as np

from curriculum import exact, measured
from curriculum.common.arguments import Parser, number, writable_folder
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable
from curriculum.stress import exact_report, jobs, precise_exact, precise_tower, runner
from curriculum.stress.under_test import contact

R, G = contact.RADIUS, contact.GRAVITY
COMMAND = "python -m curriculum.stress.exact_sweep"
RESULTS = measured.ROOT / "curriculum" / "stress" / "results"
QUICK = measured.ROOT / "outputs" / "exact-quick"
WORK = measured.ROOT / "outputs" / "stress-work" / "exact.jsonl"
CODE = ("contact.py", "curriculum/exact.py", "curriculum/stress/precise_exact.py")
TOOLS = ("curriculum/stress/exact_sweep.py", "curriculum/stress/precise_tower.py")
FIRST_EDITION = "9713605"  # the commit
TIME = 4.0  # s of a pile's motion
AWAY = 1e-8  # of a radius: two runs that are farther apart have parted
MOST = 40_000  # events of a run in 80 bits
DEAR = 3  # seeds
LOOK = 100  # samples
FULL = {"counts": (3, 6, 8, 12, 24), "seeds": 10, "towers": 60, "tall": 100, "wide": 60.0}
SHORT = {"counts": (3, 8), "seeds": 2, "towers": 4, "tall": 10, "wide": 1.0}


class Enough(Exception):
    """A run was ended before its time: the samples done at its events, and seconds of CPU time."""


def all_jobs(settings):
    """Every job, longest first: each gives plain numbers."""
    piles = [
        {"count": count, "restitution": e, "seed": seed}
        for count in sorted(settings["counts"], reverse=True)
        for e in (0.5, 0.0)
        for seed in range(settings["seeds"])
    ]
    first = [each for each in piles if each["count"] >= 8 and each["seed"] < 3]
    return [
        jobs.job("exact-wide", "pile of 200", seconds=settings["wide"]),
        *(jobs.job("exact-pile", f"pile {each}", **each) for each in piles),
        *(jobs.job("exact-first", f"first edition {each}", **each) for each in first),
        *(
            jobs.job("exact-tall", f"tall tower e={e}", count=settings["tall"], restitution=e)
            for e in (0.5, 0.9)
        ),
        *(
            jobs.job("exact-towers", f"towers {spread} {seed}", spread=spread, seed=seed)
            for spread in (1.5, 3.0)
            for seed in range(settings["towers"])
        ),
    ]


# piles


def run(scene, times, simulate=exact.simulate_exact, enough=lambda events: False):
    """q, v, the samples done at each event, and the seconds of CPU time. Raises Enough."""
    events, start = [], time.process_time()

    def report(done):
        events.append(min(done, len(times)))
        if enough(events):
            raise Enough(events, time.process_time() - start)

    q, v = simulate(scene, times, G, report)
    return q, v, events, time.process_time() - start


def pile(count, restitution, seed):
    """A pile in doubles, sampled every 1 ms and every 8 ms, and in 80 bits where there are any.

    Of the dearest, 24 balls that bounce, only the first DEAR seeds are run in 80 bits.
    """
    scene = contact.build_scene("pile", seed, count, restitution)
    times = np.linspace(0.0, TIME, 4001)
    q, v, events, seconds = run(scene, times)
    coarse = run(scene, times[::8])[0]
    total = contact.energy(q, v, scene.mass)
    beside = count < 24 or restitution == 0.0 or seed < DEAR
    return {
        "cells": 3,
        "rows": [],
        "events": len(events),
        "seconds": seconds,
        "overlap": max(0.0, contact.max_penetration(q, scene.radius).max() / R),
        "rise": max(0.0, np.diff(total).max() / total[0]),
        "same_bits": coarse.tobytes() == q[::8].tobytes(),
        "waits": first_wait(events, count, times),
        **(beside_80_bits(scene, times, q) if beside and not precise_exact.lacking() else {}),
    }


def beside_80_bits(scene, times, q):
    """When the doubles q are AWAY from the run in 80 bits, and how far they are apart [r].

    The run ends when they are, or after MOST events; LOOK samples are compared at a time.
    """
    looked = 0

    def enough(events):
        nonlocal looked
        if events[-1] < looked + LOOK:
            return len(events) > MOST
        looked = events[-1]
        return np.abs(q[:looked] - precise_exact.so_far(times)[0]).max() > AWAY * R

    try:
        precise, v, events, seconds = run(scene, times, precise_exact.simulate_exact, enough)
    except Enough as stopped:
        (events, seconds), (precise, v) = stopped.args, precise_exact.so_far(times)
    apart = np.abs(q[: len(precise)] - precise).max((1, 2)) / R
    total = contact.energy(precise, v, scene.mass)
    over = apart > AWAY
    k = int(over.argmax())
    return {
        "precise_until": times[len(precise) - 1],
        "precise_events": len(events),
        "precise_seconds": seconds,
        "precise_rise": max(0.0, float(np.diff(total).max() / total[0])),
        "parts": times[k] if over.any() else None,
        "before": float(apart[max(0, k - 1)]) if over.any() else None,
        "apart": float(apart[k] if over.any() else apart[-1]),
    }


def first_wait(events, count, times):
    """When exact's clock may have made events wait first [s]; None where it surely did not.

    It does after EVENTS per ball in a tick, and a tick is less than twelve samples of 1 ms.
    """
    tick = exact.TICK * np.sqrt(R / -G)
    width = int(np.ceil(tick / (times[1] - times[0]))) + 1
    in_a_tick = np.convolve(np.bincount(events), np.ones(width))
    over = in_a_tick > exact.EVENTS * max(20, count)
    return times[max(0, over.argmax() - width)] if over.any() else None


def wide(seconds):
    """How many of 300 steps of 2 ms a pile of 200 does in so many seconds of CPU time."""
    end = time.process_time() + seconds
    scene, times = contact.build_scene("pile", 0, 200), np.arange(301) * 0.002
    try:
        events, spent = run(scene, times, enough=lambda events: time.process_time() > end)[2:]
    except Enough as stopped:
        events, spent = stopped.args
    return {
        "cells": 1,
        "rows": [],
        "steps": events[-1] - 1,
        "events": len(events),
        "spent": spent,
    }


# towers


def random_tower(seed, spread):
    """A Scene of 2 to 10 balls, with and without gaps, masses up to 10^spread from 1 either way."""
    rng = np.random.default_rng([77, seed])
    count = int(rng.integers(2, 11))
    mass = 10.0 ** rng.uniform(-spread, spread, count)
    e = float(rng.choice([0.0, rng.uniform(0.0, 0.8), rng.uniform(0.0, 0.8)]))
    gaps = rng.uniform(0.0, 0.3, count) * (rng.random(count) < rng.choice([0.0, 0.5, 1.0]))
    gaps[0] += rng.uniform(0.0, 0.5)
    return tower(gaps, mass, e)


def tower(gaps, mass, e):
    """The Scene of balls above one another, each at a gap from what is below it."""
    y = R * (2 * np.arange(len(mass)) + 1) + np.cumsum(gaps)
    q0 = np.array((np.zeros(len(mass)), y))
    return contact.Scene("tower", q0, 0.0 * q0, mass, np.full(len(mass), R), e, 0.0)


def towers(spread, seed):
    """The worst height error [r] of a tower over a second, against 120 digits."""
    scene, times = random_tower(seed, spread), np.linspace(0.0, 1.0, 21)
    rows = (scene.q0[1], scene.v0[1], scene.mass, scene.radius)
    right = precise_tower.heights(*rows, scene.restitution, G, times)
    error = np.abs(run(scene, times)[0][:, 1] - right).max() / R
    found = {"cells": 1, "rows": [], "error": error}
    if error > exact_report.TOWER and not precise_exact.lacking():
        q = run(scene, times, precise_exact.simulate_exact)[0]
        found["precise_error"] = float(np.abs(q[:, 1] - right).max() / R)
    if error > exact_report.TOWER:
        slow = precise_tower.OF_DOUBLES
        without = precise_tower.heights(*rows, scene.restitution, G, times, slow)
        found["hangs_on"] = float(np.abs(without - right).max() / R)
    return found


def tall(count, restitution):
    """A second of a tower of equal balls with gaps of 0.1 r: events, and seconds of CPU time."""
    scene = tower(np.full(count, 0.1 * R), np.ones(count), restitution)
    events, seconds = run(scene, np.linspace(0.0, 1.0, 501))[2:]
    return {"cells": 1, "rows": [], "events": len(events), "seconds": seconds}


# the first edition

PROGRAM = """
import json, sys, time
import contact
count, restitution, seed, steps = json.loads(sys.argv[1])
scene, events = contact.build_scene("pile", seed, count, restitution), []
start = time.process_time()
contact.run_model("exact", scene, 0.002, steps, report=events.append)
print(json.dumps({"events": len(events), "seconds": time.process_time() - start}))
"""


def first(count, restitution, seed):
    """The same pile by the first edition's code, from git: {} where its commit is not at hand."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "first.zip")
        what = [FIRST_EDITION, "contact.py", "curriculum/common", "curriculum/__init__.py"]
        words = ["git", "archive", "--format=zip", "-o", file, *what]
        try:
            subprocess.run(words, cwd=measured.ROOT, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            return {"cells": 0, "rows": []}
        unpack_archive(file, folder)
        given = json.dumps([count, restitution, seed, round(TIME / 0.002)])
        words = [sys.executable, "-c", PROGRAM, given]
        done = subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True)
    return {"cells": 1, "rows": [], **json.loads(done.stdout)}


# the command


def parse(argv):
    """The checked command line."""
    parser = Parser(prog=COMMAND, description="exact in many piles and towers.")
    parser.add_argument("--quick", action="store_true", help="reduced settings, seconds, for CI")
    parser.add_argument("--workers", type=number(int, low=0), default=2, help="processes (2)")
    parser.add_argument("--fresh", action="store_true", help="forget what earlier runs finished")
    parser.add_argument("--draw", action="store_true", help="only write the page again")
    parser.add_argument("--out", type=writable_folder, help="folder of exact.md and results.json")
    args = parser.parse_args(argv)
    args.out = args.out or str(QUICK if args.quick else RESULTS)
    if args.draw and "exact" not in measured.load(args.out):
        parser.error(f"argument --draw: {args.out} holds no results of exact; measure first")
    return args


def section_of(results, settings, lacking):
    """The section of results.json: the numbers of every job, by kind."""
    kinds = dict.fromkeys(job["kind"] for job, _ in results)
    return {
        "quick": settings is SHORT,
        "no_80_bits": lacking,
        "first_edition": FIRST_EDITION,
        "died": [job["name"] for job, found in results if found["rows"]],
        **{kind: [row(*each) for each in results if each[0]["kind"] == kind] for kind in kinds},
    }


def row(job, found):
    """What was asked for, and the numbers that came out."""
    return job["params"] | {k: value for k, value in found.items() if k not in ("cells", "rows")}


@stoppable(said="stopped; the same command goes on from here")
def main(argv=None):
    """Measure, write the section and its page. Returns the exit status."""
    args = parse(argv)
    if args.draw:
        section = measured.load(args.out)["exact"]
    else:
        settings = SHORT if args.quick else FULL
        if args.fresh:
            WORK.unlink(missing_ok=True)
        kept = measured.Cells(WORK, CODE + TOOLS, [sys.version, np.__version__])
        results = runner.run_all(all_jobs(settings), args.workers, kept=kept)
        section = section_of(results, settings, precise_exact.lacking())
        section = measured.save(args.out, "exact", section, COMMAND, CODE, ("mpmath",))
    write_whole(os.path.join(args.out, "exact.md"), exact_report.whole_page(section))
    print(os.path.join(args.out, "exact.md"))
    return 1 if section["died"] else 0


if __name__ == "__main__":
    sys.exit(main())
