"""An exercise's command line, what checks.py asks of it, and what comes next."""

import json
import os
import re
import sys
import traceback
from importlib.util import find_spec
from pathlib import Path

from curriculum.commands import Parser, command, near, quoted, write_json

from . import FACTS, ROOT, task_of

BETS = "ex1", "ex3", "ex9"  # done once they were read
ORDER = ("ex1", "ex3", "ex6", "ex2", "ex5", "ex9", "ex10", "ex7", "ex8", "ex4")  # the chapter's
PATHS = [path for name in ORDER for path in (ROOT / "exercises").glob(f"{name}_*.py")]
FILES = {path.stem.partition("_")[0]: f"exercises/{path.name}" for path in PATHS}
DONE = ROOT / "outputs/ch3.5-contact/exercises.json"
LIMIT = 15  # s, chosen: right answers take about one
START = "import sys; sys.path.insert(0, sys.argv[1]); from kit import judge; judge.child()"


def main(started):
    """The command line of an exercise that is started, not imported. Ends with its exit status."""
    if started != "__main__":
        return
    exercise = sys.modules[started]
    name = Path(exercise.__file__).stem.partition("_")[0]  # ex1 of ex1_predict_contact.py
    hints, solution = FACTS[name]["hints"], ROOT / f"exercises/solutions/{name}.py"
    parser = Parser(description=f"Exercise {name}.")
    most = f"print hint N, 1 to {len(hints)}, and do nothing else"
    numbers = range(1, len(hints) + 1)
    parser.add_argument("--hint", type=int, choices=numbers, metavar="N", help=most)
    if solution.exists():
        words = "print a right answer, and show it at work"
        parser.add_argument("--solution", action="store_true", help=words)
    args = parser.parse_args()
    if args.hint:
        print(f"hint {args.hint} of {len(hints)}: {hints[args.hint - 1]}")
    elif "solution" in args and args.solution:
        print(solution.read_text("utf-8"))
        sys.exit(show(judged(name, solution)))
    else:
        sys.exit(run(name, exercise, solution.exists()))


def own_lines(error):
    """The lines of a learner's own code that an error came through."""
    frames = traceback.extract_tb(error.__traceback__)
    return [each for each in frames if re.fullmatch(r"ex\d+\w*\.py", Path(each.filename).name)]


def unreadable(file, error):
    """One line on a file that is no Python, or stops while it is read."""
    hint = f"; {error.name} needs quotes around it" if type(error) is NameError else ""
    lines = [getattr(error, "lineno", None), *(each.lineno for each in own_lines(error))]
    place = near(str(file)) + "".join(f", line {line}" for line in lines[-1:] if line)
    return f"{place}, cannot be read: {type(error).__name__}: {error}{hint}"


def unquoted(kind, error, trace):
    """PREDICTION = A, a letter without quotes: say it in one line."""
    if kind is not NameError:
        return otherwise(kind, error, trace)
    print(unreadable(trace.tb_frame.f_code.co_filename, error), file=sys.stderr)


otherwise, sys.excepthook = sys.excepthook, unquoted


def run(name, exercise, solved):
    """Judge what was written and show it at work. Exit status: 0 right, 1 wrong, 2 not done."""
    state, found = judged(name, exercise.__file__)
    note(name, state == "right")
    if state == "blank" and "IN_A_NOTEBOOK" not in os.environ:  # a bet whole; of a task, its title
        task = task_of(exercise).strip()
        print(task if name in BETS else task.split("\n")[0], end="\n\n")
    status = show((state, found))
    if state == "right":
        if solved:
            print(f"\nanother right answer: exercises/solutions/{name}.py")
        print(f"\n{practise()}")
    return status


def show(verdict):
    """Print what was found of each part. Returns the exit status."""
    state, found = verdict
    for what, _, words, shown in found:
        print(*filter(None, (shown, words or f"{what} is right")), sep="\n", flush=True)
    return ("right", "wrong", "blank").index(state)


def checked(name, file):
    """("blank", "wrong" or "right", why in words), as checks.py asks."""
    state, found = judged(name, file)
    if name in BETS and state == "right" and name not in done():
        return "blank", f"the bet is made; now read what happens: {typed(file)}"
    note(name, state == "right")
    return state, "\n".join(words for _, each, words, _ in found if each == state)


def judged(name, file):
    """The state of an exercise, and [what, state, words, shown] of all that it asks for.

    Whatever the learner's code does, it does it in another process, which writes a report.
    """
    import contact  # noqa: F401, I001  # which says it where numpy is missing
    import subprocess
    import tempfile

    silent = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "report")
        report.touch()
        words = [sys.executable, "-B", "-c", START, ROOT / "exercises", name, file, report]
        try:
            status = subprocess.run(words, timeout=LIMIT + 15, **silent).returncode
        except subprocess.TimeoutExpired:
            status = "Timeout ("
        text = report.read_text("utf-8", "replace")
    if status == 0 and text.endswith("\n"):
        return json.loads(text.splitlines()[-1])
    what = (re.findall(r"^trying (\w+)$", text, re.MULTILINE) or [name])[-1]
    line = re.search(rf'File ".*{re.escape(Path(file).name)}", line (\d+)', text)
    place = near(str(file)) + (f", line {line[1]}" if line else "")
    words = f"{what} ended its process (exit status {status}), see {place}"
    if "Timeout (" in f"{text}{status}":
        words = f"{what} takes too long, or does not end: stopped after {LIMIT} s in {place}"
        if what == "longest_step":
            words += f"\n  likely: {FACTS['ex6']['searches']['endless']}"
    return "wrong", [[what, "wrong", words, ""]]


# What is done, and what comes next: any command may ask, and it needs no numpy


def done():
    """{exercise: "done"}, as far as it was noted."""
    try:
        noted = json.loads(DONE.read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        noted = {}
    return noted if isinstance(noted, dict) else {}


def note(name, right):
    """Note whether an exercise is done."""
    before = done()
    noted = {key: "done" for key in {*before, name} if key != name or right}
    try:
        if noted != before:
            write_json(DONE, noted)
    except OSError as error:
        print(f"cannot note that {name} is done: {error}", file=sys.stderr)


def typed(file):
    """The command that runs an exercise, as the README says it: with uv it asks for numpy alone."""
    return quoted("uv", "run", file) if "UV" in os.environ else command(file)


def practise():
    """The line that names the next exercise that is not done, or what comes after them."""
    noted = done()
    for name, file in FILES.items():
        if name not in noted:
            return f"next, an exercise: {typed(ROOT / file)}"
    return "all exercises are done; next, the questions at the end of the chapter"


def print_next(args, argv: list[str]) -> None:
    """Print the last lines of a run: how to see it, and the next exercise that is not done.

    args: the flags as contact.parse_flags gives them; argv: the words they were read from.
    """
    recording = os.path.join(args.out, "contact.rrd")
    if args.rerun and os.path.exists(recording):
        viewer = Path(sys.executable).with_name("rerun.exe" if os.name == "nt" else "rerun")
        by = ("uv", "run", "rerun") if "UV" in os.environ else (viewer,)
        there = quoted(*by, recording) if by[0] == "uv" or viewer.exists() else None
        print(f"next, watch it: {there or command('-m', 'rerun', recording)}")
    elif not args.plot and find_spec("matplotlib"):
        print(f"next, see it: {command(ROOT / 'contact.py', *argv, '--plot')}")
    print(practise())
