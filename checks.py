"""Checks of the exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex2`.

    python checks.py                # the same, and says what comes next
    python checks.py --watch        # again whenever an exercise is saved
    python checks.py --junit-xml results.xml    # for programs that ask

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

from kit import predict, trials  # noqa: E402
from kit.progress import FILES, done, practise  # noqa: E402

from curriculum.commands import command, missing  # noqa: E402

try:
    import pytest
except ModuleNotFoundError:
    sys.exit(f"checks.py: {missing('pytest')}")


def load(file):
    """The module of an exercise; a file that is no Python fails its own checks and no others."""
    try:
        return importlib.import_module(Path(file).stem)
    except (NameError, SyntaxError) as error:
        hint = f" ({error.name} needs quotes around it)" if type(error) is NameError else ""
        trouble = f"{type(error).__name__}: {error}{hint}"
    pytest.fail(f"{file} cannot be read: {trouble}", pytrace=False)


@pytest.mark.parametrize("name", FILES)
def test_exercise(name):
    """Skip what is still to be done, and fail what is wrong. A bet is done once it was read."""
    exercise = load(FILES[name])
    if name in predict.ANSWERS:
        words = predict.missing(exercise)
        if words is None and name not in done():
            words = f"the bet is made; now read what happens: {command(exercise.__file__)}"
        state = "blank" if words else "right"
    else:
        state, found = trials.judged(name, exercise)
        words = "\n\n".join(why for _, each, why in found if each == state)
    if state == "blank":
        pytest.skip(f"{name}: {words}")
    if state == "wrong":
        pytest.fail(words, pytrace=False)


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


def main():
    """Run the checks once, or again and again. Returns the exit status."""
    parser = argparse.ArgumentParser(
        description="Check the exercises.",
        allow_abbrev=False,
        epilog="All other flags are pytest's: -k ex2, --junit-xml.",
    )
    parser.add_argument("--watch", action="store_true", help="again whenever an exercise is saved")
    args, words = parser.parse_known_args()
    try:
        if args.watch:
            watch(words)
        status = pytest.main([str(ROOT / "checks.py"), "-q", "-rs", *words])
        print(practise())
        return status
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
