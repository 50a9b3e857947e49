# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0", "pytest"]
# ///
"""Checks of the exercises: `pytest checks.py`, or of one of them, `pytest checks.py -k ex1`.

`python checks.py -k ex1` prints what comes next, too. What is not done yet is skipped, what is
wrong fails, with what was expected and the likely mistake.
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


def pytest_generate_tests(metafunc):
    """Make a test of each exercise; -k ex1 is then exercise 1 alone, and not 10 as well."""
    option, stems = metafunc.config.option, [Path(file).stem for file in FILES.values()]
    for name in re.findall(r"\bex\d+\w*", option.keyword):
        if not any(re.match(rf"{name}(?!\d)", stem) for stem in stems):
            words = f"-k {name}: no such exercise; there are {', '.join(stems)}"
            raise pytest.Collector.CollectError(words)
    option.keyword = re.sub(r"\bex\d+\b", r"\g<0>_", option.keyword)
    metafunc.parametrize("name", FILES, ids=stems)


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
