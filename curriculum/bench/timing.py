"""Timing: interleaved rounds of calls in this process, and whole processes with their peak memory."""

import gc
import statistics
import subprocess
import sys
import time


def timed(call):
    """Seconds that call() takes, with the garbage collector held back."""
    gc.disable()
    try:
        start = time.perf_counter()
        call()
        return time.perf_counter() - start
    finally:
        gc.enable()


def interleave(tasks, rounds, budget, tick=lambda label: None):
    """Time every task once a round, `rounds` times: {key: [seconds, one a round]}.

    tasks: {key: prepare}, where prepare() makes what one timed call needs and returns that call; it
    is not timed. A slow spell of the machine then falls on all tasks alike. A task that has used up
    `budget` seconds sits out the further rounds (but never the first), so its list is shorter.
    """
    seconds = {key: [] for key in tasks}
    for _ in range(rounds):
        for key, prepare in tasks.items():
            if not seconds[key] or sum(seconds[key]) <= budget:
                seconds[key].append(timed(prepare()))
            tick(key)
    return seconds


def spread(values):
    """Least, median and greatest of a list, and how many there are."""
    return dict(min=min(values), median=statistics.median(values), max=max(values), rounds=len(values))


LAUNCH = """
import os, subprocess, sys, time
start = time.perf_counter()
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(time.perf_counter() - start, usage.ru_maxrss, os.waitstatus_to_exitcode(status))
"""


def whole_process(command, cwd):
    """Run a command to its end: (seconds, peak memory in bytes). Raises RuntimeError when it fails.

    It is started from a bare interpreter, since a process is charged with the memory of the one that
    forked it until it becomes its own program, and this one is large.
    """
    run = subprocess.run([sys.executable, "-I", "-S", "-c", LAUNCH, *command], cwd=cwd,
                         capture_output=True, text=True)
    seconds, memory, status = run.stdout.split() if run.returncode == 0 else (0, 0, run.returncode)
    if int(status):
        raise RuntimeError(f"{' '.join(command)} fails: {run.stderr.strip()[-300:]}")
    return float(seconds), int(memory) * (1 if sys.platform == "darwin" else 1024)


class Progress:
    """A progress bar on a terminal (tqdm, where it is installed), nothing when piped."""

    def __init__(self, total, title):
        self.bar = None
        if sys.stderr.isatty():
            try:
                from tqdm import tqdm
                self.bar = tqdm(total=total, desc=title, leave=False)
            except ImportError:
                print(f"{title} ... (a progress bar needs tqdm)", file=sys.stderr)

    def __call__(self, label=""):
        if self.bar is not None:
            self.bar.set_postfix_str(str(label), refresh=False)
            self.bar.update()

    def close(self):
        if self.bar is not None:
            self.bar.close()
