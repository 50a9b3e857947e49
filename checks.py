"""Checks of the ten exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex1_`.

    python checks.py                # the same, and says what comes next
    python checks.py --junit-xml results.xml    # for programs that ask; all flags are pytest's

What is not done yet is skipped by name. A bet is done once it was made and its script was read. A
fill that is wrong fails with what went in, what came out, what was expected, and the likely slip.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

from kit import script  # noqa: E402
from kit.progress import FILES, practise  # noqa: E402

from curriculum.commands import to_install  # noqa: E402

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


def main():
    """Run the checks. Returns the exit status."""
    how = "-o", "addopts=-q -rs"  # in a folder of one's own, too
    status = pytest.main([str(ROOT / "checks.py"), *how, *sys.argv[1:]])
    print(practise())
    return status


if __name__ == "__main__":
    sys.exit(main())
