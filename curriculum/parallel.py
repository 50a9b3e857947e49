"""The same work on many inputs: on all cores, or on the machines of a dask scheduler; and a bar."""

import os
import pickle
import signal
import sys
import threading
import time
from concurrent import futures
from contextlib import contextmanager, nullcontext
from multiprocessing import parent_process

from curriculum import commands


def run_jobs(function, jobs, label) -> list:
    """Return [function(job) for job in jobs], computed on all cores."""
    return list(one_by_one(function, list(jobs), label))


def one_by_one(function, jobs: list, label, scheduler=None):
    """Yield function(job) of each job, in their order, with a bar.

    function: one that another process can import. scheduler: "host:port" of a running dask
    scheduler, whose workers do the work; the code must be on their PYTHONPATH. Raises what the
    function raises; ImportError where dask is missing; and OSError where scheduler, workers or
    processes are gone.
    """
    workers, progress = min(len(jobs), os.cpu_count() or 1), bar(len(jobs), label)
    cores = on_cores(workers) if workers > 1 else nullcontext(map)
    with cores if scheduler is None else on_machines(scheduler) as spread:
        for done, result in enumerate(spread(function, jobs), 1):
            yield result
            progress(done)


def bar(total, label):
    """Return progress(done), which prints on stderr how many of `total` are done.

    On a terminal every second, in a line that is wiped at the end; elsewhere a line a minute.
    Nothing in a process of the pool, since lines would mix.
    """
    if parent_process() is not None or not sys.stderr:
        return lambda done: None
    start = last = time.monotonic()
    every, end = (1.0, "\r") if sys.stderr.isatty() else (60.0, "\n")

    def progress(done):
        nonlocal last
        now, text = time.monotonic(), ""
        if done < total and now - last > every:
            last, left = now, (now - start) * (total / max(done, 1) - 1.0)
            text = f"{label}: {done:,} of {total:,}, about {left:,.0f} s to go"
        elif done < total or last == start or end == "\n":
            return
        print(f"{text:<78}", end=end, file=sys.stderr, flush=True)

    return progress


def follow_parent():
    """Ignore Ctrl-C in this process, and end it as soon as the one that started it is gone."""

    def follow():
        parent_process().join()
        os._exit(1)

    signal.signal(signal.SIGINT, lambda *_: None)  # SIG_IGN would go on to what it starts
    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def on_cores(workers):
    """Give a map over so many processes."""
    pool = futures.ProcessPoolExecutor(workers, initializer=follow_parent)
    try:
        yield pool.map
    except futures.BrokenExecutor:
        raise ConnectionError("a process of the pool is gone") from None
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def on_machines(scheduler):
    """Give a map over the workers of a dask scheduler."""
    try:
        from dask.distributed import Client, KilledWorker
    except ImportError:
        raise ImportError(commands.to_install("dask[distributed]")) from None

    def spread(function, jobs):  # by its content, since the scheduler need not have our code
        data = pickle.dumps(function)
        return client.get_executor(pure=False).map(lambda job: pickle.loads(data)(job), jobs)

    try:
        with Client(scheduler, timeout=10) as client:
            client.wait_for_workers(1, timeout=10)
            yield spread
    except ModuleNotFoundError as error:
        lacks = "a worker's PYTHONPATH lacks the folder of contact.py"
        raise ImportError(f"{lacks}: {error}") from None
    except (OSError, ValueError, futures.CancelledError, KilledWorker) as error:
        raise OSError(f"given --scheduler {scheduler!r}, of dask: {error}") from None
