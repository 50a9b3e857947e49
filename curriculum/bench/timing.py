"""Timing: several processes, each in an order of its own; and whole processes with their memory.

One process can be lucky with its memory layout, and one order can favour whoever runs after a
pause. So every cell is timed in several fresh processes, each of which shuffles the cells anew;
the figure is the median over the processes, its spread reaches from the least to the greatest.

Calls are timed by the CPU time of the process: all contestants run on one thread, so on a quiet
machine that is the time that passes, and on a busy one it is still the work that was done. Whole
processes are timed by the clock on the wall.
"""

import gc
import multiprocessing
import os
import random
import statistics
import subprocess
import sys
import time

from curriculum import measured
from curriculum.common.stoppable import end_at_ctrl_c
from curriculum.common.workers import in_order

SLOW = 2.0  # s: a cell that took longer in a process is not timed in more than TWO of them
TWO = 2


def timed(call) -> float:
    """CPU seconds of this process that call() takes, with the garbage collector held back."""
    gc.disable()
    try:
        start = time.process_time()
        call()
        return time.process_time() - start
    finally:
        gc.enable()


def spread(values) -> dict:
    """Median, least and greatest of a list."""
    return dict(median=statistics.median(values), min=min(values), max=max(values))


def in_fresh_processes(work, keys, processes, cells, title):
    """work(key) in every one of so many fresh processes, one after the other, into `cells`.

    Each process takes the keys in its own random order. cells["time K KEY"] holds what work gave
    in process K; what is there already is not done again.
    """
    spawn = multiprocessing.get_context("spawn")
    with measured.progress(processes * len(keys), title) as tick:
        for number in range(processes):
            order = list(keys)
            random.Random(number).shuffle(order)
            todo = [
                key
                for key in order
                if place("time", number, key) not in cells
                and not (number >= TWO and _slow(cells, key))
            ]
            tick(done=len(keys) - len(todo))
            if not todo:
                continue
            with spawn.Pool(1, end_at_ctrl_c) as pool:
                for key, value in zip(todo, pool.imap(work, todo)):
                    cells[place("time", number, key)] = value
                    tick(key[1])


def _slow(cells, key):
    return sum(cells[place("time", 0, key)].values()) > SLOW


def place(kind, number, key) -> str:
    """Under which name a cell is kept."""
    return f"{kind} {number} {key}"


def merged(cells, keys, processes) -> dict:
    """{key: {way: {median, min, max}}} over the processes."""
    result = {}
    for key in keys:
        found = [
            cells[name]
            for name in (place("time", k, key) for k in range(processes))
            if name in cells
        ]
        result[key] = {way: spread([one[way] for one in found]) for way in found[0]}
    return result


def beside(work, keys, cells, kind, title, workers=2):
    """work(key) for every key, in `workers` processes at once: for what is not timed."""
    todo = [key for key in keys if place(kind, 0, key) not in cells]
    spawn = multiprocessing.get_context("spawn")
    with measured.progress(len(keys), title) as tick:
        tick(done=len(keys) - len(todo))
        for key, value in zip(todo, in_order(work, [(key,) for key in todo], workers, spawn)):
            cells[place(kind, 0, key)] = value
            tick(key[1])
    return {key: cells[place(kind, 0, key)] for key in keys}


def interleave(tasks, rounds, tick=lambda label: None) -> dict:
    """Time every task once a round: {key: [seconds, one a round]}. tasks: {key: prepare}.

    prepare() makes what one timed call needs and returns that call; it is not timed. The order
    changes from round to round.
    """
    seconds = {key: [] for key in tasks}
    for number in range(rounds):
        order = list(tasks)
        random.Random(number).shuffle(order)
        for key in order:
            seconds[key].append(timed(tasks[key]()))
            tick(key)
    return seconds


LAUNCH = """
import os, subprocess, sys, time
start = time.perf_counter()
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(time.perf_counter() - start, usage.ru_maxrss, os.waitstatus_to_exitcode(status))
"""


def whole_process(command, cwd, bytecode):
    """Run a command to its end: (seconds, peak memory in bytes). Raises RuntimeError when it fails.

    It is started from a bare interpreter, since a process is charged with the memory of the one that
    forked it until it becomes its own program, and this one is large. bytecode: the folder where
    Python keeps its compiled modules. An environment that forbids it to keep any would have each
    process compile the course's modules again, but not numpy's, which pip has compiled.
    """
    environment = dict(os.environ, PYTHONPYCACHEPREFIX=str(bytecode))
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    run = subprocess.run(
        [sys.executable, "-I", "-S", "-c", LAUNCH, *command],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
    )
    seconds, memory, status = run.stdout.split() if run.returncode == 0 else (0, 0, run.returncode)
    if int(status):
        raise RuntimeError(f"{' '.join(command)} fails: {run.stderr.strip()[-300:]}")
    return float(seconds), int(memory) * (1 if sys.platform == "darwin" else 1024)
