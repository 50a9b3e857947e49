"""The same work on many inputs, on all cores: results in order, a progress bar on a terminal."""

import os

from curriculum.common import progress


def spread(function, inputs, label):
    """[function(*each) for each in inputs], by as many processes as there are cores.

    One input, or one core, needs no process. The results do not depend on the number of cores.
    """
    tick = progress.steps(len(inputs), label, unit=label)
    count = min(len(inputs), os.cpu_count() or 1)
    if count < 2:
        return [function(*each) for each, _ in zip(inputs, tick)]
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(count) as pool:
        found = []
        for result in pool.map(function, *zip(*inputs)):
            found.append(result)
            tick(len(found))
    return found
