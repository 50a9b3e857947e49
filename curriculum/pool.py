"""The same work on many inputs: on all cores, or on the machines of a dask scheduler; and a bar."""

import os
import sys
from contextlib import contextmanager

from curriculum import hints


def spread(function, jobs, label, workers=None, scheduler=None):
    """[function(job) for job in jobs], worked out in parallel, in the order of the jobs.

    function: one that another process can import. workers: how many processes, all cores if None;
    one worker or one job needs no process. scheduler: "host:port" of a running dask scheduler; its
    workers do the work instead; the code must be on their PYTHONPATH. The results are the same
    wherever they come from. Raises what the function raises; ImportError where dask is
    missing, and OSError, in one line, where the scheduler does not answer.
    """
    jobs = list(jobs)
    count = min(len(jobs), workers or os.cpu_count() or 1)
    if scheduler:
        with machines(scheduler) as pool:
            return gathered(submitted(pool, function, jobs), len(jobs), label)
    if count < 2:
        return gathered(map(function, jobs), len(jobs), label)
    with processes(count) as pool:
        return gathered(submitted(pool, function, jobs), len(jobs), label)


def submitted(pool, function, jobs):
    """An iterator over the results. pool.map would cancel at Ctrl-C what the pool then ends too."""
    futures = [pool.submit(function, job) for job in jobs]
    return (future.result() for future in futures)


def gathered(results, total, label):
    """The list of the results, as they come, with a bar."""
    report = bar(total, label)
    found = []
    for result in results:
        found.append(result)
        report(len(found))
    return found


@contextmanager
def processes(count):
    """A pool of so many processes. Ctrl-C ends them too, and they say nothing."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(count, initializer=leave_ctrl_c_to_the_parent) as pool:
        try:
            yield pool
        except BaseException:
            for process in multiprocessing.active_children():
                process.terminate()  # or leaving the pool would wait for all that was asked for
            raise


def leave_ctrl_c_to_the_parent():
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def machines(scheduler):
    """The executor of a dask scheduler; see spread."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise ImportError(hints.missing("dask[distributed]")) from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise OSError(
            f"given the scheduler {scheduler!r}, which does not answer ({error}); allowed: "
            "host:port, as `dask scheduler` prints it"
        ) from None
    with client:
        pool = client.get_executor(pure=False)
        try:
            yield pool
        finally:
            pool.shutdown(wait=False)


def bar(total, label):
    """report(done), to be called with how many of `total` are done; it draws a bar with tqdm.

    The bar comes after a second and is wiped at the end. report does nothing where stderr is no
    terminal, where tqdm is not installed, and in a process of the pool, since bars would mix.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        return nothing
    try:
        from multiprocessing import parent_process

        from tqdm import tqdm
    except ImportError:
        return nothing
    if parent_process() is not None:
        return nothing
    shown = tqdm(total=total, desc=label, leave=False, delay=1.0)

    def report(done):
        shown.update(done - shown.n)
        if done >= total:
            shown.close()

    return report


def nothing(done):
    """The report of a bar that nobody would see."""
