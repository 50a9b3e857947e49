"""Run jobs in this process, in many, or on a Dask cluster; finished ones are kept.

A job whose process dies, or that raises, becomes a result with one row of status DIED, and the
rest goes on. Finished jobs are kept as they come, so that an interrupted run takes up where it
stopped; dead ones are tried again. The processes are kept by hand: a pool of concurrent.futures
breaks as a whole when one of its processes dies, and cannot end one that hangs.
"""

import multiprocessing
import os
import traceback
from multiprocessing.connection import wait
from time import monotonic

from curriculum import measured
from curriculum.stress import jobs, under_test

PATIENCE = 1800.0  # s a job may take on processes


def dead(reason):
    """The result that stands in for that of a job which did not end by itself."""
    return {
        "cells": 0,
        "rows": [
            {"at": "the job itself", "expected": "a result", "got": reason, "status": jobs.DIED}
        ],
    }


def attempt(job):
    """(job's result, True), or (why there is none, False) when it raised."""
    try:
        return jobs.run(job), True
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{os.path.basename(where.filename)}:{where.lineno}"
        return dead(f"{type(error).__name__} at {place}: {error}"[:500]), False


def here(todo):
    """Jobs one after the other in this process (a job that kills its process kills the run)."""
    for job in todo:
        yield (job, *attempt(job))


def serve(pipe):
    """A worker process: take a job, send its result, until the other end is closed."""
    try:
        while True:
            pipe.send(attempt(pipe.recv()))
    except (EOFError, KeyboardInterrupt, BrokenPipeError):
        pass


class Worker:
    """A process and the pipe to it."""

    def __init__(self, context):
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()
        self.job, self.overdue = None, False

    def give(self, job):
        self.job, self.given = job, monotonic()
        self.pipe.send(job)

    def take(self):
        """(job, result, finished); a closed pipe means that the process has died."""
        try:
            result, finished = self.pipe.recv()
        except (EOFError, ConnectionError):
            self.process.join()
            reason = (
                f"no end after {PATIENCE:g} s"
                if self.overdue
                else f"its process ended with exit code {self.process.exitcode}"
            )
            result, finished = dead(reason), False
        job, self.job = self.job, None
        return job, result, finished

    def check_patience(self):
        if monotonic() - self.given > PATIENCE:
            self.overdue = True
            self.process.kill()

    def stop(self):
        self.pipe.close()
        self.process.join(1)
        if self.process.is_alive():
            self.process.terminate()
            self.process.join()


def on_processes(todo, workers):
    """Jobs on `workers` processes; one that dies is replaced. Yields as they finish."""
    context = multiprocessing.get_context("spawn")
    queue = iter(todo)
    pool = [Worker(context) for _ in range(max(1, min(workers, len(todo))))]
    try:
        busy = []
        for worker, job in zip(pool, queue):
            worker.give(job)
            busy.append(worker)
        while busy:
            for worker in busy:
                worker.check_patience()
            for pipe in wait([worker.pipe for worker in busy], timeout=1.0):
                worker = next(w for w in busy if w.pipe is pipe)
                yield worker.take()
                if worker.process.exitcode is not None:
                    worker.stop()
                    busy.remove(worker)
                    pool[pool.index(worker)] = worker = Worker(context)
                    busy.append(worker)
                job = next(queue, None)
                if job is None:
                    busy.remove(worker)
                else:
                    worker.give(job)
    finally:
        for worker in pool:
            worker.stop()


def on_dask(todo, address):
    """Jobs on the Dask cluster at `address`; its workers run in a checkout of the same code.

    A worker with other code, Python or numpy refuses its jobs: its cells would not be the same. One
    that dies takes the jobs it held with it, once each (retries are off).
    """
    from dask.distributed import Client, as_completed

    here = under_test.code_hash()

    def there(job):  # pickled whole: the scheduler imports nothing
        from curriculum.stress import runner as its_runner
        from curriculum.stress import under_test as its_under_test

        if its_under_test.code_hash() != here:
            return its_runner.dead("other code, Python or numpy on the worker than here"), False
        return its_runner.attempt(job)

    with Client(address) as client:
        futures = {client.submit(there, job, pure=False, retries=0): job for job in todo}
        try:
            for future in as_completed(futures):
                if future.status == "finished":
                    yield (futures[future], *future.result())
                else:
                    error = future.exception()
                    yield futures[future], dead(f"{type(error).__name__}: {error}"[:500]), False
        finally:
            client.cancel(list(futures))


def source_of(todo, workers, dask):
    """The jobs as they finish: (job, result, finished)."""
    if dask:
        return on_dask(todo, dask)
    workers = (os.cpu_count() or 1) if workers is None else workers
    return on_processes(todo, workers) if workers else here(todo)


def run_all(todo, workers=None, dask=None, kept=None):
    """Results of all jobs, in the order of `todo`: a list of (job, result).

    workers: processes (default: one a core; 0: none, run in this process). dask: a scheduler's
    address, then workers is not used. kept: the measured.Cells to resume from and to add to.
    """
    kept = {} if kept is None else kept
    results = {jobs.key(job): kept[jobs.key(job)] for job in todo if jobs.key(job) in kept}
    left = [job for job in todo if jobs.key(job) not in results]
    with measured.progress(len(todo), "stress") as tick:
        tick("kept from before", len(results))
        for job, result, finished in source_of(left, workers, dask) if left else ():
            results[jobs.key(job)] = result
            if finished:
                kept[jobs.key(job)] = result
            tick(job["name"])
    return [(job, results[jobs.key(job)]) for job in todo]
