"""The same work on many inputs: on all cores, or on the machines of a dask scheduler; and a bar."""

import logging
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import count, islice
from multiprocessing import parent_process
from queue import Empty, SimpleQueue

from curriculum import commands

AHEAD, PATIENCE = 1000, 15.0  # jobs that are asked for at a time; s without a result


def run_jobs(function: Callable, jobs: Iterable, label: str, workers: int | None = None) -> list:
    """[function(job) for job in jobs], worked out on all cores, in the order of the jobs."""
    jobs = list(jobs)
    workers = min(len(jobs), workers or os.cpu_count() or 1)
    found = as_they_come(function, jobs, len(jobs), label, workers)
    return [result for _, result in sorted(found, key=lambda each: each[0])]


def as_they_come(
    function: Callable, jobs: Iterable, total: int, label: str, workers=None, scheduler=None
) -> Iterator[tuple]:
    """(place of a job, function(job)) of each, as they are done, with a bar; AHEAD at a time.

    function: one that another process can import. workers: how many processes, all cores if None;
    one needs no process. scheduler: "host:port" of a running dask scheduler; its workers do the
    work instead; the code must be on their PYTHONPATH. Raises what the function raises; ImportError
    where dask is missing; and OSError, in one line, where scheduler, workers or processes are gone.
    """
    progress, done = bar(total, label), count(1)
    workers = min(total, workers or os.cpu_count() or 1)
    if workers < 2 and not scheduler:
        for place, job in enumerate(jobs):
            yield place, function(job)
            progress(next(done))
        return
    function = carried(function) if scheduler else function
    with machines(scheduler) if scheduler else processes(workers) as (submit, look):
        for found in spread(submit, look, function, enumerate(jobs)):
            yield found
            progress(next(done))


def spread(submit, look, function, numbered) -> Iterator[tuple]:
    """(place, function(job)) of each (place, job), as they are done; look() where nothing comes."""
    done: SimpleQueue = SimpleQueue()
    waiting = {}

    def ask(most):
        for place, job in islice(numbered, most):
            with unheard():  # or a process that is started now would speak at Ctrl-C
                future = submit(function, job)
            waiting[future] = place
            future.add_done_callback(done.put)

    ask(AHEAD)
    while waiting:
        try:
            future = done.get(timeout=PATIENCE)
        except Empty:
            look()
            continue
        yield waiting.pop(future), fetched(future, look)
        ask(1)


def fetched(future, look):
    """The result of a future that is done. A cluster may lose it on the way, and work it out again;
    look() where that takes long."""
    while True:
        try:
            return future.result(PATIENCE)
        except Exception as error:
            if type(error).__name__ != "TimeoutError":  # Python 3.10 has three of that name
                raise
            look()


def carried(function):
    """function, for a machine of a cluster: its scheduler need not have the code, and an error of
    importing it names the machine."""
    data = pickle.dumps(function)

    def there(job):  # dask sends a function within a function as it is, not by its name
        import os
        import pickle
        import platform

        try:
            return pickle.loads(data)(job)
        except ImportError as error:
            raise ImportError(f"{platform.node()}, process {os.getpid()}: {error}") from None

    return there


def bar(total: int, label: str) -> Callable[[int], None]:
    """progress(done), to be called with how many of `total` are done: how far it is, on stderr.

    On a terminal after a second, in a line that is wiped at the end; elsewhere a line a minute.
    Nothing in a process of the pool, since lines would mix.
    """
    if parent_process() is not None or not sys.stderr:
        return lambda done: None
    start = last = time.monotonic()
    shown, (every, end) = False, (0.2, "\r") if sys.stderr.isatty() else (60.0, "\n")

    def progress(done):
        nonlocal last, shown
        now = time.monotonic()
        if shown and end == "\r" and done >= total:
            print(" " * 78, end=end, file=sys.stderr, flush=True)
        elif now - last > every and now - start > 1.0 and done < total:
            last, shown, left = now, True, (now - start) * (total / max(done, 1) - 1.0)
            text = f"{label}: {done:,} of {total:,}, about {left:,.0f} s to go"
            print(f"{text:<78}", end=end, file=sys.stderr, flush=True)

    return progress


@contextmanager
def unheard():
    """Within it, Ctrl-C waits; a process that is started here never hears of it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def follow_parent():
    """End this process as soon as the one that started it is gone, however that ended."""

    def follow():
        parent_process().join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def processes(workers):
    """How to ask a pool of so many processes, and what to do where nothing comes: wait on."""
    pool = ProcessPoolExecutor(workers, initializer=follow_parent)
    try:
        yield pool.submit, lambda: None
    except BrokenExecutor:
        raise ConnectionError("a process of the pool is gone") from None
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def machines(scheduler: str) -> Iterator:
    """How to ask a dask scheduler, and what to do where nothing comes; see as_they_come."""
    try:
        from dask.distributed import Client, KilledWorker
    except ImportError:
        raise ImportError(commands.to_install("dask[distributed]")) from None
    logging.disable()  # dask's tracebacks of what is lost: we say it in a line
    given = f"given the scheduler {scheduler!r}, which"
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        allowed = "allowed: host:port, as `dask scheduler` prints it"
        raise OSError(f"{given} does not answer ({error}); {allowed}") from None

    def look():
        if not client.nthreads():
            raise OSError(f"{given} has no workers; start some: dask worker {scheduler}")

    with client:
        try:
            yield partial(client.submit, pure=False), look
        except CancelledError:
            raise ConnectionError(f"{given} is gone") from None
        except KilledWorker as error:
            raise ConnectionError(f"{given} lost four workers at one job ({error})") from None
