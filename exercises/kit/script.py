"""An exercise's command line, what checks.py calls, and which exercise comes next."""

import json
import linecache
import os
import re
import sys
import traceback
from pathlib import Path

from curriculum.commands import Parser, near, quoted

from . import FACTS, ROOT

FOLDER = ROOT / "exercises"
FILES = {ex: f"exercises/{path.name}" for ex in FACTS for path in FOLDER.glob(f"{ex}_*.py")}
STATES = "right", "wrong", "blank"  # in this order they are exit statuses
LIMIT = 20  # s, chosen: right answers take about one
START = "import sys; sys.path.insert(0, sys.argv[1]); from kit import judge; judge.child()"
BLANK = re.compile(r"^    return \.\.\.|^[A-Z]+ = None|  \?  ", re.MULTILINE)


def main(started):
    """Run the command line of an exercise and exit, above what the learner wrote: that runs in a
    process of its own, and nowhere else."""
    if started != "__main__":
        return
    if hasattr(sys.stdout, "reconfigure"):  # a path may not fit the terminal's encoding
        sys.stdout.reconfigure(errors="backslashreplace")
    file = Path(sys.modules[started].__file__)
    name = file.stem.partition("_")[0]  # ex1 of ex1_predict_contact.py
    parser = Parser(description=f"Exercise {name}.")
    if name not in FACTS:
        parser.error(f"{name} has no entry in exercises/kit/answers.json")
    hints, solution = FACTS[name]["hints"], ROOT / f"exercises/solutions/{name}.py"
    flag, numbers = parser.add_argument, range(1, len(hints) + 1)
    flag("--hint", type=int, choices=numbers, metavar="N", help=f"print hint N of {len(hints)}")
    flag("--solution", action="store_true", help="print a right answer, and try it")
    args = parser.parse_args()
    if args.hint:
        print(f"hint {args.hint} of {len(hints)}: {hints[args.hint - 1]}")
        sys.exit(0)
    if args.solution:
        print(solution.read_text("utf-8"))
    state, words = judged(name, solution if args.solution else file)
    if state == "blank" and "IN_A_NOTEBOOK" not in os.environ:  # a bet whole; of a task, its title
        task = task_of(name).strip()
        print(task if "measured" in FACTS[name] else task.split("\n")[0], end="\n\n")
    print(words)
    if state == "right" and not args.solution:
        print(f"\na solution to compare with: {near(str(solution))}\n\n{practise()}")
    sys.exit(STATES.index(state))


def task_of(name):
    """Return the docstring of an exercise, read from its file: Python may leave it out (-OO)."""
    _, _, text = (ROOT / FILES[name]).read_text("utf-8").partition('"""')
    return text.partition('"""')[0]


def said_of(error):
    """Return an error in words, with the last line of the learner's file that it came through."""
    words, line = f"{type(error).__name__}: {error}", ""
    if isinstance(error, TypeError) and "'method'" in words:
        words += "; a function is called with ()"
    for frame, number in traceback.walk_tb(error.__traceback__):
        file = frame.f_code.co_filename
        if re.fullmatch(r"ex\d+\w*\.py", Path(file).name):
            line = f"\n  line {number}: {linecache.getline(file, number).strip()}"
    return words + line


def judged(name, file):
    """Return ("blank", "wrong" or "right", words): the learner's code has a process of its own."""
    import contact  # noqa: F401, I001  # which says it where numpy is missing
    import subprocess

    words = [sys.executable, "-B", "-c", START, FOLDER, name, file]
    how = {"stdin": subprocess.DEVNULL, "capture_output": True, "text": True, "errors": "replace"}
    done = subprocess.run(words, **how)
    if done.stdout.endswith("]\n"):
        return json.loads(done.stdout.splitlines()[-1])
    tried, too_long, stack = done.stdout.partition("Timeout")
    ended = f"ended its process (exit status {done.returncode})"
    if too_long:
        ended = f"takes too long, or does not end: stopped after {LIMIT} s"
    lines = re.findall(rf'{re.escape(Path(file).name)}", (line \d+)', stack)  # innermost first
    what, where = [name, *tried.split()][-1], ", ".join((near(str(file)), *lines[:1]))
    return "wrong", "\n".join((f"{what} {ended}, in {where}", *done.stderr.splitlines()[-1:]))


def start(file):
    """Return the line that starts an exercise here, as README has it; in a notebook a cell's."""
    by = ("uv", "run") if "UV" in os.environ else (sys.executable,)
    return quoted(*(("%%exercise",) if "IN_A_NOTEBOOK" in os.environ else by), ROOT / file)


def ask(file, hint):
    """Return the line that sends a learner to a hint."""
    return f"\n  a question that helps: {start(file)} --hint {hint}"


def practise():
    """Return the line that names the next exercise that is not begun, or what follows them."""
    for file in FILES.values():
        if BLANK.search((ROOT / file).read_text("utf-8", "replace")):
            return f"next, an exercise: {start(file)}"
    return f"all exercises are done; next, the next chapter: {start('exercises/next_chapter.py')}"
