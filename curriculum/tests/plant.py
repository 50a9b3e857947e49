"""Plant the faults of the tables, one at a time in a copy, and see that their tests name them.

    python -m curriculum.tests.plant                    every fault of every room
    python -m curriculum.tests.plant contact gate       those of two rooms
    python -m curriculum.tests.plant --most 10          ten of them, chosen by the date

A table is a module of curriculum/tests/faults/: FAULTS, rows of (file, what stands there, what is
planted, the tests that must fail: a file of curriculum/tests and pytest's words). Exit status 1
where a fault survives, where what it replaces does not stand there exactly once, or where its tests
fail without it.
"""

import ast
import datetime
import importlib
import os
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from curriculum.commands import ROOT, Parser, number

TABLES = {path.stem: path for path in sorted(Path(__file__).with_name("faults").glob("*.py"))}
own = threading.local()  # a copy of the tree for each thread


def begin(home):
    """Copy the files that git tracks, for this thread."""
    own.folder = Path(tempfile.mkdtemp(dir=home))
    for name in subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).splitlines():
        (own.folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, own.folder / name)


def ended(tests):
    """How these tests end here: pytest's status, its last lines."""
    file, *words = shlex.split(tests)
    pytest = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command = [*pytest, f"curriculum/tests/{file}", *words]
    done = subprocess.run(command, cwd=own.folder, capture_output=True, text=True)
    return done.returncode, done.stdout[-1500:]


def sound(tests):
    """ "" if these tests pass without a fault, else in words."""
    status, last = ended(tests)
    return f"{tests} ends with {status} without any fault:\n{last}" if status else ""


def plant(row):
    """ "" if its tests name a fault, else in words."""
    room, file, old, new, tests = row
    path, fault = own.folder / file, f"{room}: {file}: {old!r} -> {new!r}"
    text = path.read_text("utf-8") if path.exists() else ""
    if text.count(old) != 1:
        return f"{fault}: stands {text.count(old)} times there"
    planted = text.replace(old, new)
    if path.suffix == ".py":
        ast.parse(planted)  # what is no Python is seen by any test
    path.write_text(planted, "utf-8")
    try:
        return "" if ended(tests)[0] in (1, 2) else f"{fault}: not seen by {tests}"
    finally:
        path.write_text(text, "utf-8")


def main(argv=None):
    """Print every survivor as it is found, then how many were planted. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.tests.plant", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of {', '.join(TABLES)} (all)")
    parser.add_argument("--most", type=partial(number, int, 1, 1e4), help="so many, by the date")
    args = parser.parse_args(argv)
    if unknown := set(args.rooms) - set(TABLES):
        parser.error(f"given {', '.join(unknown)}; allowed: {', '.join(TABLES)}")
    tables = {r: importlib.import_module(f"curriculum.tests.faults.{r}") for r in TABLES}
    rows = [(r, *row) for r in args.rooms or TABLES for row in tables[r].FAULTS]
    if args.most:
        today = random.Random(str(datetime.date.today()))
        rows = today.sample(rows, min(args.most, len(rows)))
    checks = [partial(sound, tests) for tests in dict.fromkeys(row[-1] for row in rows)]
    checks += [partial(plant, row) for row in rows]
    wrong = 0
    with tempfile.TemporaryDirectory() as home:
        with ThreadPoolExecutor(os.cpu_count(), initializer=begin, initargs=(home,)) as pool:
            for words in filter(None, pool.map(lambda check: check(), checks)):
                print(words, flush=True)
                wrong += 1
    print(f"{len(rows)} planted, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
