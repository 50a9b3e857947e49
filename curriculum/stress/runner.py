"""Run jobs in this process, in many, or on a Dask cluster; remember what is finished.

A job whose process dies, or that raises, becomes a result with one row of status DIED and the
rest goes on. Finished jobs are appended to a file as they come, so that an interrupted run takes
up where it stopped; dead ones are not remembered and are tried again.
"""

import json
import multiprocessing
import os
import traceback
from multiprocessing.connection import wait
from time import monotonic

from curriculum.common.files import write_whole
from curriculum.stress import engine, jobs

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

    here = engine.code_hash()

    def there(job):  # pickled whole: the scheduler imports nothing
        from curriculum.stress import engine as its_engine, runner as its_runner

        if its_engine.code_hash() != here:
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


class Memory:
    """Finished jobs on disk: one JSON line each, in a file named after the code's hash."""

    def __init__(self, folder, code_hash):
        self.path = os.path.join(folder, f"finished-{code_hash}.jsonl")
        self.known = {}
        if os.path.exists(self.path):
            with open(self.path, encoding="utf-8") as file:
                text = file.read()
            whole = text[: text.rfind("\n") + 1]  # the last line may be cut off
            if whole != text:
                write_whole(self.path, whole)
            for entry in map(json.loads, whole.splitlines()):
                self.known[jobs.key(entry["job"])] = entry["result"]

    def forget(self):
        self.known.clear()
        if os.path.exists(self.path):
            os.unlink(self.path)

    def keep(self, job, result):
        os.makedirs(os.path.dirname(self.path), exist_ok=True)
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps({"job": job, "result": result}, allow_nan=False) + "\n")


def bar(todo, finished):
    """tqdm's bar with the time left, on a terminal only; None where tqdm is not installed."""
    try:
        from tqdm import tqdm
    except ImportError:
        return None
    return tqdm(total=todo, initial=finished, unit="job", disable=None, dynamic_ncols=True)


def run_all(todo, workers=None, dask=None, memory=None):
    """Results of all jobs, in the order of `todo`: a list of (job, result).

    workers: processes (default: one a core; 0: none, run in this process). dask: a scheduler's
    address, then workers is not used. memory: a Memory to resume from and to add to.
    """
    known = memory.known if memory else {}
    results = {jobs.key(job): known[jobs.key(job)] for job in todo if jobs.key(job) in known}
    left = [job for job in todo if jobs.key(job) not in results]
    workers = (os.cpu_count() or 1) if workers is None else workers
    if dask:
        source = on_dask(left, dask)
    elif workers == 0:
        source = here(left)
    else:
        source = on_processes(left, workers)
    progress = bar(len(todo), len(results))
    try:
        for job, result, finished in source if left else ():
            results[jobs.key(job)] = result
            if memory and finished:
                memory.keep(job, result)
            if progress is not None:
                progress.update()
    finally:
        if progress is not None:
            progress.close()
    return [(job, results[jobs.key(job)]) for job in todo]
