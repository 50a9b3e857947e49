"""The same work on many inputs: on all cores, or on the machines of a dask scheduler; and a bar."""

import logging
import os
import pickle
import platform
import signal
import socket
import sys
import threading
import time
from concurrent import futures
from contextlib import contextmanager
from itertools import islice
from multiprocessing import parent_process

from curriculum import commands

AHEAD, PATIENCE = 1000, 15.0  # jobs that are asked for at a time; s without a result


def run_jobs(function, jobs, label, workers=None) -> list:
    """Return [function(job) for job in jobs], computed on all cores, in the order of the jobs."""
    jobs = list(jobs)
    found = as_they_come(function, jobs, len(jobs), label, workers)
    return [result for _, result in sorted(found, key=lambda each: each[0])]


def as_they_come(function, jobs, total, label, workers=None, scheduler=None):
    """Yield (place of a job, function(job)) of each, as they finish, with a bar; AHEAD at a time.

    function: one that another process can import. workers: how many processes, all cores if None;
    one needs no process. scheduler: "host:port" of a running dask scheduler; its workers do the
    work instead; the code must be on their PYTHONPATH. Raises what the function raises; ImportError
    where dask is missing; and OSError, in one line, where scheduler, workers or processes are gone.
    """
    progress, numbered = bar(total, label), enumerate(jobs)
    workers = min(total, workers or os.cpu_count() or 1)
    if scheduler is not None:
        found = on_machines(scheduler, function, numbered)
    elif workers > 1:
        found = on_cores(workers, function, numbered)
    else:
        found = ((place, function(job)) for place, job in numbered)
    for done, each in enumerate(found, 1):
        yield each
        progress(done)


def spread(pool, look, function, numbered):
    """Yield (place, function(job)) of each (place, job), as they finish; look() after a wait."""
    waiting: dict = {}
    while True:
        for place, job in islice(numbered, AHEAD - len(waiting)):
            with unheard():  # or a process that is started now would speak at Ctrl-C
                waiting[pool.submit(function, job)] = place
        if not waiting:
            return
        done, _ = futures.wait(waiting, PATIENCE, futures.FIRST_COMPLETED)
        if not done:
            look()
        for future in done:
            yield waiting.pop(future), future.result()


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


@contextmanager
def unheard():
    """Delay Ctrl-C within it; a process that is started here never receives it."""
    mask = getattr(signal, "pthread_sigmask", lambda how, signals: signals)  # Windows has none
    before = mask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        mask(signal.SIG_SETMASK, before)


def follow_parent():
    """End this process as soon as the one that started it is gone, however that ended."""

    def follow():
        parent_process().join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


def on_cores(workers, function, numbered):
    """Spread the jobs over so many processes."""
    pool = futures.ProcessPoolExecutor(workers, initializer=follow_parent)
    try:
        yield from spread(pool, lambda: None, function, numbered)
    except futures.BrokenExecutor:
        raise ConnectionError("a process of the pool is gone") from None
    finally:
        pool.shutdown(cancel_futures=True)


def on_machines(scheduler, function, numbered):
    """Spread the jobs over the workers of a dask scheduler; see as_they_come."""
    try:
        from dask.distributed import Client, KilledWorker
        from distributed.comm import CommClosedError, get_address_host_port
    except ImportError:
        raise ImportError(commands.to_install("dask[distributed]")) from None
    logging.disable()  # dask's tracebacks of what is lost: we say it in a line
    given, data = f"given --scheduler {scheduler!r}, which", pickle.dumps(function)
    try:
        with socket.create_connection(get_address_host_port(scheduler), 10) as first:
            first.recv(1)  # a scheduler speaks first; with its dashboard a client waits for ever
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        allowed = "allowed: host:port, as `dask scheduler` prints it"
        raise OSError(f"{given} does not answer ({error}); {allowed}") from None

    def look():
        if not client.nthreads():
            raise OSError(f"{given} has no workers; start some: dask worker {scheduler}")

    def there(job):  # dask sends it as it is, not by its name: the scheduler needs no code of ours
        try:
            return pickle.loads(data)(job)
        except ImportError as error:
            lacks = "; its PYTHONPATH must have the folder of contact.py" * bool(error.name)
            raise ImportError(f"{platform.node()}, process {os.getpid()}: {error}{lacks}") from None

    with client:
        try:
            yield from spread(client.get_executor(pure=False), look, there, numbered)
        except (futures.CancelledError, CommClosedError):
            raise ConnectionError(f"{given} is gone") from None
        except KilledWorker as error:
            raise ConnectionError(f"{given} lost four workers at one job ({error})") from None
