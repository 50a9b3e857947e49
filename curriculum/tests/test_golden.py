"""What users see, pinned: the README's commands and the trajectories of four scenes.

python -m curriculum.tests.test_golden      # pin it anew, and say why in CHANGELOG.md
"""

import contextlib
import hashlib
import io
import json
import tempfile
from pathlib import Path

import numpy as np
import pytest

import contact
from curriculum.commands import Parser, write_atomic

PINNED = Path(__file__).with_name("golden.json")
COMMANDS = (
    "--scene drop", "--scene bounce", "--scene stack", "--scene pile --steps 200",
    "--contact exact", "--contact penalty --dt 0.03",
    "--smoke", "--smoke --scene bounce", "--smoke --scene stack",
)  # fmt: skip
SAMPLES = (0, 150, 300, 600)  # of the recorded states, the last one at 1.2 s


def run_command(flags):
    """The standard output and metrics.json of a command, without the lines that name files."""
    printed = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(printed):
        status = contact.main([*flags.split(), "--no-rerun", "--out", folder])
        metrics = json.loads((Path(folder) / "metrics.json").read_text("utf-8"))
    passing = ("metrics:", "next", "  try: ")
    lines = [line for line in printed.getvalue().splitlines() if not line.startswith(passing)]
    return {"status": status, "stdout": lines, "metrics": metrics}


def run_trajectory(case):
    """A hash of all bits where the steps fix them; sampled heights of soft and exact."""
    model, name, seed = case.split()
    scene = contact.build_scene(name, int(seed), 8 if name == "pile" else None)
    run = contact.run_model(model, scene, 0.002, SAMPLES[-1])
    if model not in ("soft", "exact"):
        return hashlib.sha256(run.q.tobytes() + run.v.tobytes()).hexdigest()[:16]
    return run.q[list(SAMPLES)].tolist()


def case_names(models):
    """The pinned trajectories of these models."""
    scenes = [f"{scene} {seed}" for scene in contact.SCENES for seed in range(3)]
    return [f"{model} {scene}" for model in models for scene in scenes]


PINS = json.loads(PINNED.read_text("utf-8"))
NEW = [model for model in contact.MODELS if f"{model} drop 0" not in PINS["trajectories"]]


def test_every_model_is_pinned():
    assert not NEW, f"not pinned: {NEW}; python -m curriculum.tests.test_golden, and CHANGELOG.md"


@pytest.mark.parametrize("flags", COMMANDS)
def test_command_prints_and_writes_what_is_pinned(flags):
    found, known = run_command(flags), PINS["commands"][flags]
    for model in NEW:
        found["metrics"]["quality"].pop(model, None)
    assert found["metrics"]["quality"] == known["metrics"]["quality"]
    assert found == known or NEW, "the rest is compared once every model is pinned"


@pytest.mark.parametrize("case", PINS["trajectories"])
def test_trajectory_is_the_pinned_one(case):
    """Bits where steps fix them; 1e-9 m for soft and exact, whose sums may be ordered otherwise.

    A pile is chaotic: what differs in the last bit grows there, by 1e-6 m within these 1.2 s.
    """
    found, known = run_trajectory(case), PINS["trajectories"][case]
    if isinstance(known, str):
        assert found == known
    else:
        limit = 1e-6 if "pile" in case else 1e-9
        assert np.abs(np.array(found) - known).max() <= limit


if __name__ == "__main__":
    Parser(prog="python -m curriculum.tests.test_golden", description=__doc__).parse_args()
    commands = {flags: run_command(flags) for flags in COMMANDS}
    trajectories = {case: run_trajectory(case) for case in case_names(contact.MODELS)}
    parts = {"commands": commands, "trajectories": trajectories}
    rows = (
        f'"{part}": {{\n' + ",\n".join(f'"{key}": {json.dumps(pin)}' for key, pin in pins.items())
        for part, pins in parts.items()
    )  # a line a pin
    write_atomic(PINNED, "{\n" + "\n},\n".join(rows) + "\n}\n}\n")
