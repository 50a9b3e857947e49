"""The contact.py under test: the one beside the curriculum folder, wherever it is run from."""

import hashlib
import importlib
import sys
import threading
import time
from functools import cache
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
contact = importlib.import_module("contact")

MEASURING = ("under_test", "jobs", "scenes", "trial", "maps", "extremes", "invariants", "samebytes")


ONE_AT_A_TIME = threading.Lock()  # threads of one process share contact.FEW


class OutOfTime(Exception):
    """exact took longer than the caller wanted to wait; `samples` were done by then."""

    def __init__(self, samples):
        super().__init__(f"{samples} samples done")
        self.samples = samples


def run_model(model, scene, dt, steps, **knobs):
    """contact.run_model, by the compiled twin for any number of balls where it can be had.

    The twin has the reference's bits; invariants.plain_steps_give_the_same_bits looks.
    """
    with ONE_AT_A_TIME:
        few, contact.FEW = contact.FEW, 0
        try:
            return contact.run_model(model, scene, dt, steps, **knobs)
        finally:
            contact.FEW = few


def run_exact(scene, dt, steps, seconds):
    """(run of exact, its events from each sample to the next). Raises OutOfTime after so many
    seconds of CPU time.

    A time and not a count of events, since one event of a dense heap costs as much as a hundred in
    the air. So a slower machine cuts more runs; what is judged of them is the same.
    """
    events, end = np.zeros(steps + 2, np.int64), time.process_time() + seconds

    def count(samples):
        events[samples] += 1  # samples were passed before this event
        if samples <= steps and time.process_time() > end:
            raise OutOfTime(samples)

    return run_model("exact", scene, dt, steps, report=count), events[1:-1]


@cache
def code_hash():
    """sha256 (16 digits) of everything that makes numbers here, and of Python's and numpy's version.

    What is kept under it is valid as long as none of them changes.
    """
    import numpy

    digest = hashlib.sha256(f"{sys.version} numpy {numpy.__version__}".encode())
    folder = Path(__file__).parent
    measured = [ROOT / "contact.py", *sorted((ROOT / "curriculum").glob("[ep]*.py"))]
    for path in [*measured, *(folder / f"{name}.py" for name in MEASURING)]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
