"""Every flag of contact.py at its ends: no traceback, no warning, no wrong word, strict JSON.

The command line runs in this process, with warnings as errors, in a folder of its own.
"""

import contextlib
import io
import json
import math
import tempfile
import warnings
from pathlib import Path

import contact
from curriculum.stress.jobs import row

REALS = "0 5e-324 1e-300 1e-100 1e-9 0.5 1 7.3 1e9 1e100 1e308 -1 nan inf".split()
WHOLE = "0 1 2 17 99999999999999999999 -3 2.5".split()
ENDS = ("0.02", "1e-300", "1e308", "-1e308", "0"), ("1", "1e-162", "1e308", "0", "-50")
FLAGS = {
    **dict.fromkeys(["--dt", "--stiffness", "--damping", "--mass"], REALS),
    **dict.fromkeys(["--baumgarte", "--restitution", "--warm"], REALS),
    **dict.fromkeys(["--iters", "--steps", "--bodies", "--seed"], WHOLE),
    "--solref": [f"{first} {second}" for first in ENDS[0] for second in ENDS[1]],
    "--solimp": ["0 0 0 0 1", "1 1 1e308 1 1e308", "0.9 0.95 1e-320 0.5 2", "0.1 0.9 0 1e-300 99"],
}
TOGETHER = (
    "--dt 1e200 --stiffness 1e300",
    "--dt 1e-300 --stiffness 1e308 --damping 1e308",
    "--dt 0.03 --stiffness 1e9 --mass 1e-9",
    "--mass 1e9 --stiffness 1e-9 --dt 1",
    "--restitution 1 --baumgarte 1 --dt 1 --iters 1",
)


def extreme_jobs(quick):
    """A job for every flag and scene; quick: the drop alone, every third value."""
    for scene in ("drop",) if quick else ("drop", "bounce", "stack", "pile --bodies 5"):
        for flag, values in FLAGS.items():
            tried = list(values)[:: 3 if quick else 1]
            yield "extremes:run", [f"--scene {scene} {flag} {value}" for value in tried]
        yield "extremes:run", [f"--scene {scene} {flags}" for flags in TOGETHER]


def run(lines):
    """What each of these command lines did, as judgements."""
    return {"rows": [judged(line) for line in lines]}


def judged(line):
    """One command line, for 100 steps unless it says otherwise, and what is wrong with it."""
    argv = [*line.split(), "--no-rerun", *([] if "--steps" in line else ["--steps", "100"])]
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                status = contact.main([*argv, "--out", folder])
        except SystemExit as stop:
            status = stop.code
        except Exception as error:
            return row(line, "no traceback, no warning", f"{type(error).__name__}: {error}", False)
        trouble = complaint(status, out.getvalue(), err.getvalue(), Path(folder) / "metrics.json")
    return row(
        line, "a report that is right, or one line that refuses", trouble or "so", not trouble
    )


def complaint(status, said, refused, path):
    """What is wrong, or None."""
    if status == 2:
        lines = refused.strip().splitlines()
        return None if len(lines) == 1 else f"refuses so: {lines[-3:]}"
    if status != 0 or refused.strip():
        return f"exit status {status}, stderr {refused.strip()[-100:]!r}"
    try:
        metrics = json.loads(path.read_text("utf-8"), parse_constant=not_json)
    except (OSError, ValueError) as error:
        return f"metrics.json: {error}"
    for model, quality in metrics["quality"].items():
        (line,) = [line for line in said.splitlines() if line.split()[:1] == [model]][:1]
        if line.endswith(" ok") and not sound(quality):
            return f"{model} is called ok: {line}"
    return None


def sound(quality):
    """Whether a run may be called ok: every number is one, and no ball went through anything."""
    numbers = [value for value in quality.values() if isinstance(value, float)]
    return all(map(math.isfinite, numbers)) and not quality["blew_up"] and not quality["through"]


def not_json(word):
    raise ValueError(f"{word} is not JSON")
