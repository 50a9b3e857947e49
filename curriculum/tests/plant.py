"""Plant the faults of the tables, one at a time in a copy, and see that their tests name them.

    python -m curriculum.tests.plant                    every fault of every room
    python -m curriculum.tests.plant contact page       those of two rooms
    python -m curriculum.tests.plant --most 10          ten of them, chosen by the date

A table is a module of curriculum/tests/faults/: FAULTS, rows of (file, what stands there, what is
planted, the tests that must fail: a file of curriculum/tests and pytest's words). Exit status 1
where a fault survives, where what it replaces does not stand there exactly once, or where its tests
fail without it.
"""

import datetime
import importlib
import os
import queue
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from contact import number
from curriculum.commands import Parser
from curriculum.regions import ROOT

TABLES = {path.stem: path for path in sorted(Path(__file__).with_name("faults").glob("*.py"))}


def rows_of(rooms):
    """[(room, file, old, new, tests)] of these rooms."""
    modules = {room: importlib.import_module(f"curriculum.tests.faults.{room}") for room in rooms}
    return [(room, *row) for room, module in modules.items() for row in module.FAULTS]


def copy_of_the_tree(folder):
    """The files that git tracks, copied into a folder."""
    names = subprocess.check_output(["git", "ls-files", "-z"], cwd=ROOT, text=True).split("\0")
    for name in filter(None, names):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)


def fails(folder, tests):
    """Whether these tests fail there; their last lines. Raises LookupError if there are none."""
    file, *words = shlex.split(tests)
    command = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    command += [f"curriculum/tests/{file}", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode not in (0, 1, 2):
        raise LookupError(f"no such tests: {tests}")
    return done.returncode > 0, done.stdout[-1500:]


def plant(copies, row):
    """What became of a fault: "" if its tests name it, else why not, in words."""
    room, file, old, new, tests = row
    folder = copies.get()
    try:
        text = (folder / file).read_text("utf-8")
        if text.count(old) != 1:
            return f"stands {text.count(old)} times in {file}: {old!r}"
        (folder / file).write_text(text.replace(old, new), "utf-8")
        try:
            return "" if fails(folder, tests)[0] else "survived"
        finally:
            (folder / file).write_text(text, "utf-8")
    except (OSError, LookupError) as error:
        return str(error)
    finally:
        copies.put(folder)


def sound(copies, tests):
    """ "" if these tests pass without a fault, else how they end."""
    folder = copies.get()
    try:
        failed, words = fails(folder, tests)
        return f"{tests} fails without any fault:\n{words}" if failed else ""
    except LookupError as error:
        return str(error)
    finally:
        copies.put(folder)


def main(argv=None):
    """Print what was planted and seen, by room, and every survivor. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.tests.plant", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"of {', '.join(TABLES)} (all)")
    parser.add_argument("--most", type=partial(number, int, 1, 1e4), help="so many, by the date")
    parser.add_argument("--date", default=str(datetime.date.today()), help="YYYY-MM-DD (today)")
    args = parser.parse_args(argv)
    if unknown := set(args.rooms) - set(TABLES):
        parser.error(f"given {', '.join(unknown)}; allowed: {', '.join(TABLES)}")
    rows = rows_of(args.rooms or TABLES)
    if args.most:
        rows = random.Random(args.date).sample(rows, min(args.most, len(rows)))
    with tempfile.TemporaryDirectory() as home, ThreadPoolExecutor(os.cpu_count()) as pool:
        copies = queue.SimpleQueue()
        for k in range(os.cpu_count()):
            copy_of_the_tree(Path(home, str(k)))
            copies.put(Path(home, str(k)))
        tests = list(dict.fromkeys(row[-1] for row in rows))
        wrong = [words for words in pool.map(partial(sound, copies), tests) if words]
        ends = list(pool.map(partial(plant, copies), rows))
    for room in dict.fromkeys(row[0] for row in rows):
        mine = [end for row, end in zip(rows, ends) if row[0] == room]
        print(f"{room}: {len(mine)} planted, {mine.count('')} seen")
    for (room, file, old, new, tests), end in zip(rows, ends):
        if end:
            wrong.append(f"{room}: {end}: {file}: {old!r} -> {new!r}; not seen by {tests}")
    print(*wrong, f"{ends.count('')} passed, {len(ends) - ends.count('')} failed", sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
