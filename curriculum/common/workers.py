"""The same work on many inputs, on all cores: results in order, a progress bar on a terminal."""

import os

from curriculum.common import progress
from curriculum.common.stoppable import end_at_ctrl_c


def spread(function, inputs, label):
    """[function(*each) for each in inputs], by as many processes as there are cores.

    One input, or one core, needs no process. The results do not depend on the number of cores.
    """
    tick = progress.steps(len(inputs), label, unit=label)
    count = min(len(inputs), os.cpu_count() or 1)
    if count < 2:
        return [function(*each) for each, _ in zip(inputs, tick)]
    found = []
    for result in in_order(function, inputs, count):
        found.append(result)
        tick(len(found))
    return found


def in_order(function, inputs, count, context=None):
    """Yield function(*each) for each in inputs, by `count` processes. Ctrl-C ends them too."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(count, context, end_at_ctrl_c) as pool:
        futures = [pool.submit(function, *each) for each in inputs]
        try:
            for future in futures:
                yield future.result()
        except (KeyboardInterrupt, GeneratorExit):
            for process in multiprocessing.active_children():
                process.terminate()  # or leaving the pool would wait for all that was asked for
            raise
