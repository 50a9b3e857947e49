"""Run the mutants of the tables, one at a time in a clone: their tests must detect them.

    python -m curriculum.tests.plant                    every mutant of every table
    python -m curriculum.tests.plant contact gate       those of two tables
    python -m curriculum.tests.plant --most 10          ten of them, chosen by the date

A table is a module of curriculum/tests/faults/: FAULTS, rows of (file, original text, mutant text,
the tests that must fail: a file of curriculum/tests and pytest's words). Exit status 1 where a
mutant survives, its original text does not stand there exactly once, or its tests fail without it.
"""

import ast
import datetime
import importlib
import random
import shlex
import subprocess
import sys
import tempfile
from functools import cache, partial
from pathlib import Path

from curriculum.commands import Parser, number
from curriculum.parallel import run_jobs
from curriculum.source import replace_once
from curriculum.tests.helpers import clone

TABLES = {path.stem: path for path in sorted(Path(__file__).with_name("faults").glob("*.py"))}


@cache
def course(home):
    """Return a clone for this process."""
    return clone(Path(tempfile.mkdtemp(dir=home)))


def ended(home, file, *words):
    """Run these tests in the clone; return pytest's status and its last lines."""
    pytest = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command = [*pytest, f"curriculum/tests/{file}", *words]
    done = subprocess.run(command, cwd=course(home), capture_output=True, text=True)
    return done.returncode, done.stdout[-1500:]


def plant(home, row):
    """Return what is wrong: it is not detected, or tests fail without a mutant (file ""); or ""."""
    room, file, old, new, tests = row
    if not file:
        status, last = ended(home, *shlex.split(tests))
        return f"{tests} ends with {status} without any fault:\n{last}" if status else ""
    path, fault = course(home) / file, f"{room}: {file}: {old!r} -> {new!r}"
    text = path.read_text("utf-8") if path.exists() else ""
    try:
        planted = replace_once(text, old, new, f"{room}: {file}")
    except ValueError as error:
        return str(error)
    if path.suffix == ".py":
        ast.parse(planted)  # any test would detect what is no Python
    path.write_text(planted, "utf-8")
    try:
        detected = ended(home, *shlex.split(tests))[0] in (1, 2)
        return "" if detected else f"{fault}: not detected by {tests}"
    finally:
        path.write_text(text, "utf-8")


def main(argv=None):
    """Print every survivor, then the number of mutants. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.tests.plant", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="TABLE", help=f"of {', '.join(TABLES)} (all)")
    parser.add_argument("--most", type=partial(number, int, 1, 1e4), help="so many, by the date")
    args = parser.parse_args(argv)
    if unknown := set(args.rooms) - set(TABLES):
        parser.error(f"given {', '.join(unknown)}; allowed: {', '.join(TABLES)}")
    tables = {r: importlib.import_module(f"curriculum.tests.faults.{r}") for r in TABLES}
    rows = [(r, *row) for r in args.rooms or TABLES for row in tables[r].FAULTS]
    if args.most:
        today = random.Random(str(datetime.date.today()))
        rows = today.sample(rows, min(args.most, len(rows)))
    jobs, files = rows, {}
    for file, _, words in (row[-1].partition(" -k ") for row in rows):
        files.setdefault(file, set()).add(words.replace("'", ""))
    for file, words in files.items():  # without a mutant
        some = f" -k '{' or '.join(words)}'" if all(words) else ""
        jobs = [("", "", "", "", file + some), *jobs]
    with tempfile.TemporaryDirectory() as home:
        wrong = [words for words in run_jobs(partial(plant, home), jobs, "mutants") if words]
    print(*wrong, f"{len(rows)} planted, {len(wrong)} wrong", sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
