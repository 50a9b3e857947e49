"""Timing: several fresh processes, each in an order of its own; and whole processes.

One process can be lucky with its memory, and one order can favour whoever runs after a pause.
Calls are timed by CPU time: all run on one thread, so on a quiet machine that is the time that
passes. Whole processes are timed by the clock on the wall.
"""

import multiprocessing
import os
import random
import statistics
import subprocess
import sys
import time
import timeit
from concurrent.futures import ProcessPoolExecutor

from curriculum.commands import ROOT
from curriculum.parallel import bar


def timed(call) -> float:
    """Return the CPU seconds that call() takes, without garbage collector."""
    return timeit.timeit(call, timer=time.process_time, number=1)


def spread(name, values) -> dict:
    """Return median, least and greatest of a list, as the columns of a row."""
    return {name: statistics.median(values), f"{name}_min": min(values), f"{name}_max": max(values)}


def in_fresh_processes(work, jobs, processes, label):
    """Return [[work(job) in each process] for job in jobs], in a random order each."""
    found, report = [[] for _ in jobs], bar(processes * len(jobs), label)
    for number in range(processes):
        order = random.Random(number).sample(range(len(jobs)), len(jobs))
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            results = pool.map(work, [jobs[k] for k in order])
            for done, (k, result) in enumerate(zip(order, results), number * len(jobs) + 1):
                found[k].append(result)
                report(done)
    return found


def whole_process(job) -> float:
    """Return the wall time [s] of a Python process. Raises RuntimeError if it fails.

    job: its words, joined by " | ", and {out}, a folder where Python keeps what it compiles. An
    environment that forbids to keep any would have each process compile the course's modules
    again, but not numpy's.
    """
    words, folder = job
    command = [sys.executable, *words.format(out=folder).split(" | ")]
    environment = dict(os.environ, PYTHONPYCACHEPREFIX=folder)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    start = time.perf_counter()
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(f"{' '.join(command)} fails: {run.stderr.strip()[-300:]}")
    return time.perf_counter() - start
