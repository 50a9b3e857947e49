"""Run the mutants of the tables, one after the other in a clone: their tests must detect them.

    python -m curriculum.tests.plant                    every mutant of every table
    python -m curriculum.tests.plant contact gate       those of two tables
    python -m curriculum.tests.plant --most 10          ten of them, chosen by the date

A table is a module of curriculum/tests/faults/: FAULTS, rows of (file, original text, mutant text,
the tests that must fail: a file of curriculum/tests and pytest's words). Exit status 1 where a
mutant survives. All tests must pass without a mutant: run them first.
"""

import datetime
import importlib
import random
import shlex
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from curriculum.commands import Parser, number
from curriculum.source import replace_once
from curriculum.tests.helpers import clone

TABLES = [path.stem for path in sorted(Path(__file__).with_name("faults").glob("*.py"))]
PYTEST = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]


def survives(course, file, old, new, tests):
    """Plant a mutant in a clone, run its tests and return whether they pass."""
    text = (course / file).read_text("utf-8")
    (course / file).write_text(replace_once(text, old, new, file), "utf-8")
    command = [*PYTEST, *shlex.split(f"curriculum/tests/{tests}")]
    status = subprocess.run(command, cwd=course, capture_output=True).returncode
    (course / file).write_text(text, "utf-8")
    return status not in (1, 2)  # 5: there are no such tests


def main(argv=None):
    """Print every survivor, then the number of mutants. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.tests.plant", description=__doc__)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)} (all)")
    parser.add_argument("--most", type=partial(number, int, 1, 1e4), help="so many, by the date")
    args = parser.parse_args(argv)
    rows = []
    for table in args.tables or TABLES:
        rows += importlib.import_module(f"curriculum.tests.faults.{table}").FAULTS
    if args.most:
        today = random.Random(str(datetime.date.today()))
        rows = today.sample(rows, min(args.most, len(rows)))
    with tempfile.TemporaryDirectory() as home:
        course = clone(Path(home))
        alive = [row for row in rows if survives(course, *row)]
    print(*alive, f"{len(rows)} planted, {len(alive)} not detected", sep="\n")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
