"""The same work on many inputs: on all cores, or on the machines of a dask scheduler; and a bar."""

import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, parent_process

from curriculum import commands


def run_jobs(
    function: Callable, jobs: Iterable, label: str, workers: int | None = None, scheduler=None
) -> list:
    """[function(job) for job in jobs], worked out in parallel, in the order of the jobs.

    function: one that another process can import. workers: how many processes, all cores if None;
    one worker or one job needs no process. scheduler: "host:port" of a running dask scheduler; its
    workers do the work instead; the code must be on their PYTHONPATH. The results are the same
    wherever they come from. Raises what the function raises; ImportError where dask is
    missing, and OSError, in one line, where the scheduler does not answer.
    """
    jobs = list(jobs)
    count = min(len(jobs), workers or os.cpu_count() or 1)
    if count < 2 and not scheduler:
        return gathered(map(function, jobs), len(jobs), label)
    with machines(scheduler) if scheduler else processes(count) as pool:
        # pool.map would cancel at Ctrl-C what the pool then ends too
        futures = [pool.submit(function, job) for job in jobs]
        return gathered((future.result() for future in futures), len(jobs), label)


def gathered(results: Iterable, total: int, label: str) -> list:
    """The list of the results, as they come, with a bar."""
    done: list = []
    progress = bar(total, label)
    for result in results:
        done.append(result)
        progress(len(done))
    return done


def bar(total: int, label: str) -> Callable[[int], None]:
    """progress(done), to be called with how many of `total` are done; it draws a bar with tqdm.

    The bar comes after a second and is wiped at the end. There is none where stderr is no
    terminal, where tqdm is not installed, and in a process of the pool, since bars would mix.
    """
    try:
        from tqdm import tqdm
    except ImportError:
        return lambda done: None
    unseen = parent_process() is not None or None  # None: where stderr is no terminal
    shown = tqdm(total=total, desc=label, leave=False, delay=1.0, disable=unseen)

    def progress(done):
        shown.update(done - shown.n)
        if done >= total:
            shown.close()

    return progress


@contextmanager
def processes(count):
    """A pool of so many processes. Ctrl-C ends them too, and they say nothing."""
    quiet = {"initializer": signal.signal, "initargs": (signal.SIGINT, signal.SIG_IGN)}
    with ProcessPoolExecutor(count, **quiet) as pool:
        try:
            yield pool
        except BaseException:
            for process in active_children():
                process.terminate()  # or leaving the pool would wait for all that was asked for
            raise


@contextmanager
def machines(scheduler: str) -> Iterator:
    """The executor of a dask scheduler; see run_jobs."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise ImportError(commands.to_install("dask[distributed]")) from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise OSError(
            f"given the scheduler {scheduler!r}, which does not answer ({error}); allowed: "
            "host:port, as `dask scheduler` prints it"
        ) from None
    with client:
        yield client.get_executor(pure=False)  # leaving the client cancels what is still asked for
