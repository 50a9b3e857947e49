# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0", "pytest"]
# ///
"""Checks of the ten exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex1_`.

    python checks.py -k ex2     # the same, and says what comes next; all flags are pytest's

What is not done yet is skipped. What is wrong fails, with what was expected and the likely slip.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

from kit.script import FILES, judged, practise  # noqa: E402

from curriculum.commands import to_install  # noqa: E402

try:
    import pytest
except ModuleNotFoundError:
    sys.exit(f"checks.py: {to_install('pytest')}")

KNOWN = ", ".join(Path(file).stem for file in FILES.values())
WRONG = [name for name in re.findall(r"ex\d+\w*", " ".join(sys.argv[1:])) if name not in KNOWN]
if WRONG and __name__ != "__main__":
    words = f"-k {' '.join(WRONG)}: no such exercise; there are {KNOWN}"
    raise pytest.Collector.CollectError(words)


@pytest.mark.parametrize("name", FILES, ids=lambda name: Path(FILES[name]).stem)
def test_exercise(name):
    """A bet is right once it is made."""
    state, words = judged(name, ROOT / FILES[name])
    if state == "blank":
        pytest.skip(f"{name}: {words}")
    if state == "wrong":
        pytest.fail(words, pytrace=False)


if __name__ == "__main__":
    how = "-o", "addopts=-q -rs -s"  # in a folder of one's own, too
    status = pytest.main([str(ROOT / "checks.py"), *how, *sys.argv[1:]])
    print(practise())
    sys.exit(status)
