"""The contact.py under test: the one beside the curriculum folder, wherever it is run from."""

import hashlib
import importlib
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))
contact = importlib.import_module("contact")


class PileUp(Exception):
    """exact met more events than the caller wanted to wait for."""


def run_model(model, scene, dt, steps, events=20_000, **knobs):
    """contact.run_model, which must end: PileUp when exact's events exceed `events`.

    A count, not a time, so that what comes out is the same on every machine. Events of exact can
    pile up without bound (a ball rattling in a closing gap), which no number of samples tells.
    """
    if model != "exact":
        return contact.run_model(model, scene, dt, steps, **knobs)
    left = iter(range(events))

    def count(sample):
        if next(left, None) is None:
            raise PileUp(f"more than {events} events before t = {sample * dt:.6g} s")

    return contact.run_model(model, scene, dt, steps, **knobs, report=count)


MEASURING = ("engine", "jobs", "scenes", "maps", "extremes", "invariants", "samebytes")


@cache
def code_hash():
    """sha256 (16 digits) of contact.py, what it imports, and every module here that makes numbers.

    What is cached under it is valid as long as none of them, nor Python, nor numpy changes.
    """
    import numpy

    digest = hashlib.sha256(f"{sys.version} numpy {numpy.__version__}".encode())
    folder = Path(__file__).parent
    for path in [
        Path(contact.__file__),
        *sorted((folder.parent / "common").glob("*.py")),
        *(folder / f"{name}.py" for name in MEASURING),
    ]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
