"""Checks of the ten exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex1_`.

    python checks.py                # the same, and says what comes next
    python checks.py --watch        # again whenever an exercise is saved
    python checks.py --junit-xml results.xml    # for programs that ask

What is not done yet is skipped by name. A bet is done once it was made and its script was read. A
fill that is wrong fails with what went in, what came out, what was expected, and the likely slip.
"""

import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

from kit import script  # noqa: E402
from kit.progress import FILES, practise  # noqa: E402

from curriculum.commands import Parser, stoppable, to_install  # noqa: E402

try:
    import pytest
except ModuleNotFoundError:
    sys.exit(f"checks.py: {to_install('pytest')}")


@pytest.mark.parametrize("name", FILES, ids=lambda name: Path(FILES[name]).stem)
def test_exercise(name):
    """Skip what is still to be done, and fail what is wrong. A bet is done once it was read."""
    state, words = script.checked(name, ROOT / FILES[name])
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


@stoppable()
def main():
    """Run the checks once, or again and again. Returns the exit status."""
    others = "All other flags are pytest's: -k ex1_, --junit-xml."
    parser = Parser(description="Check the exercises.", epilog=others)
    parser.add_argument("--watch", action="store_true", help="again whenever an exercise is saved")
    args, words = parser.parse_known_args()
    if args.watch:
        watch(words)
    status = pytest.main([str(ROOT / "checks.py"), "-q", "-rs", *words])
    print(practise())
    return status


if __name__ == "__main__":
    sys.exit(main())
