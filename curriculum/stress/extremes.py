"""Every flag of contact.py at its ends.

The command line runs in this process, with warnings as errors, in a folder of its own.
"""

import contextlib
import io
import json
import re
import tempfile
import warnings
from pathlib import Path

import numpy as np

import contact

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
    """A job for every flag, value and scene; quick: the drop alone, every third value."""
    said = [f"{flag} {value}" for flag, tried in FLAGS.items() for value in tried[:: 1 + 2 * quick]]
    for scene in ("drop",) if quick else ("drop", "bounce", "stack", "pile --bodies 5"):
        for line in (f"--scene {scene} {flags}" for flags in (*said, *TOGETHER)):
            yield line, line, [a_right_report_or_one_line_that_refuses]


def a_right_report_or_one_line_that_refuses(line):
    """A command line gives a report that is right, or one line that refuses: no traceback, no
    warning, no wrong word, strict JSON.
    """
    argv = [*line.split(), "--no-rerun", *([] if "--steps" in line else ["--steps", "100"])]
    out, err = io.StringIO(), io.StringIO()
    usual = np.errstate(all="warn", under="ignore")  # which judge() silences
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(), usual:
        warnings.simplefilter("error")
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                status = contact.main([*argv, "--out", folder])
        except SystemExit as stop:
            status = stop.code
        trouble = complaint(status, out.getvalue(), err.getvalue(), Path(folder) / "metrics.json")
    yield trouble, trouble is not None, False


def complaint(status, said, refused, path):
    """What is wrong, or None. Raises OSError and ValueError where metrics.json cannot be read."""
    if status == 2:
        lines = refused.strip().splitlines()
        return None if len(lines) == 1 else f"refuses so: {lines[-3:]}"
    if status != 0 or refused.strip():
        return f"exit status {status}, stderr {refused.strip()[-100:]!r}"
    metrics = json.loads(path.read_text("utf-8"), parse_constant=int)  # so NaN is refused
    every = "exact" in metrics["quality"]  # else there is nothing to take errors against
    known = [key for key, _ in contact.COLUMNS.values() if every or not key.endswith("error_frac")]
    for model, quality in metrics["quality"].items():
        states = [line for line in said.splitlines() if line.startswith("state: ")]
        (line,) = [line for line in states if re.search(rf"[ ,]{model}[ ,]", line)]
        unknown = None in map(quality.get, known)  # as metrics.json has what is not finite
        if line.endswith(" ok") and (quality["blew_up"] or quality["through"] or unknown):
            return f"{model} is called ok: {line}"
    return None
