"""Checks of the exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex2`.

    python checks.py                # the same, and writes results.json, for programs that ask
    python checks.py --watch        # again whenever an exercise is saved

What is not done yet is skipped by name. A bet is done once it was made and its script was read. A
fill that is wrong fails with what went in, what came out, what was expected, and the likely slip.
"""

import argparse
import importlib
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

from progress import FILES, done  # noqa: E402


def load(name):
    """The module of an exercise; a file that is no Python fails its own checks and no others."""
    import pytest
    file = next(each for each in FILES if each.startswith(name))
    try:
        return importlib.import_module(file)
    except (NameError, SyntaxError) as error:
        hint = f" ({error.name} needs quotes around it)" if type(error) is NameError else ""
        trouble = f"{type(error).__name__}: {error}{hint}"
    pytest.fail(f"{name}: exercises/{file}.py cannot be read: {trouble}", pytrace=False)


def state_of(name, exercise):
    """("blank", "wrong" or "right", why in words): a bet is done once it was made and read."""
    import predict
    import trials
    if name in predict.ANSWERS:
        todo = predict.missing(exercise)
        if todo is None and name not in done():
            todo = f"the bet is made; now read what happens: {predict.command(exercise.__file__)}"
        return ("blank", todo) if todo else ("right", None)
    found = trials.judged(name, exercise)
    state = next((each for each in ("wrong", "blank") if each in [part[1] for part in found]),
                 "right")
    predict.note(name, "done" if state == "right" else None)
    return state, "\n\n".join(words for _, each, words in found if each == state and words)


def pytest_generate_tests(metafunc):
    """One test for each exercise, test_exercise[ex1] and so on."""
    metafunc.parametrize("name", [file[:3] for file in FILES])


def test_exercise(name):
    """Skip what is still to be done, and fail what is wrong."""
    import pytest
    state, words = state_of(name, load(name))
    if state == "blank":
        pytest.skip(f"{name}: {words}")
    if state == "wrong":
        pytest.fail(words, pytrace=False)


class Results:
    """Collects what pytest finds, in the shape that exercism's test runners write (version 3)."""

    def __init__(self):
        self.tests = []

    def pytest_runtest_logreport(self, report):
        """Keep one entry a test: what it says in its call, or that it was skipped."""
        if report.when != "call" and not report.skipped and report.passed:
            return
        status = {"passed": "pass", "skipped": "fail"}.get(
            report.outcome, "fail" if report.when == "call" else "error")
        message = str(report.longrepr) if report.failed else None
        if report.skipped:
            message = f"not done yet: {report.longrepr[2].removeprefix('Skipped: ')}"
        name = report.nodeid.rpartition("::")[2]
        self.tests.append({"name": name, "status": status, "message": message, "output": None,
                           "task_id": int(name.partition("[ex")[2][0])})


def run_once(selected, path):
    """Run the checks, write results.json, say what is next. Returns pytest's exit status."""
    try:
        import pytest
    except ModuleNotFoundError:
        print(f"checks.py needs pytest: {sys.executable} -m pip install pytest", file=sys.stderr)
        return 2
    import predict
    results = Results()
    words = ["-q", "-rs", *(["-k", selected] if selected else [])]
    status = pytest.main([str(ROOT / "checks.py"), *words], plugins=[results])
    passed = {test["status"] for test in results.tests} == {"pass"}
    whole = {"version": 3, "status": "pass" if passed else "fail", "message": None,
             "tests": results.tests}
    try:
        predict.contact.write_json(path, whole)
    except OSError as error:
        print(f"checks.py: error: cannot write {path}: {error.strerror}", file=sys.stderr)
        return 2
    print(f"results: {path}\n{predict.follow_up()}")
    return int(status)


def watch(argv):
    """Run the checks again, each time in a new process, whenever an exercise is saved."""
    before = None
    while True:
        now = {file: file.stat().st_mtime_ns for file in ROOT.glob("exercises/*.py")}
        if now != before:
            before = now
            subprocess.run([sys.executable, str(ROOT / "checks.py"), *argv], check=False)
            print("\nwaiting for an exercise to be saved; Ctrl-C ends\n", flush=True)
        time.sleep(0.2)


def main(argv=None):
    """Run the checks once, or again and again. Returns the exit status."""
    parser = argparse.ArgumentParser(prog="checks.py", description="Check the exercises.",
                                     allow_abbrev=False)
    parser.add_argument("-k", default="", metavar="WORDS", help="only those, as pytest's -k")
    parser.add_argument("--watch", action="store_true", help="again whenever an exercise is saved")
    parser.add_argument("--json", default="outputs/ch3.5-contact/results.json", metavar="FILE",
                        type=Path, help="where the results go (%(default)s)")
    args = parser.parse_args(argv)
    try:
        if args.watch:
            watch(["--json", str(args.json), *(["-k", args.k] if args.k else [])])
        return run_once(args.k, args.json)
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
