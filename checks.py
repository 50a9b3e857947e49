# /// script
# requires-python = ">=3.10"
# dependencies = ["numpy>=2.0", "pytest"]
# ///
"""Checks of the exercises: `pytest checks.py`, or of one of them, `pytest checks.py -k ex1`.

What is not done yet is skipped, what is wrong fails, with what was expected and the likely mistake.
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "exercises"))

from kit.script import FILES, ROOT, judged

from curriculum.commands import needs

with needs("learn"):
    import pytest


def pytest_generate_tests(metafunc):
    """Make a test of each exercise; -k ex1 is then exercise 1 alone, and not 10 as well."""
    option = metafunc.config.option
    option.keyword = re.sub(r"\bex\d+\b", r"\g<0>_", option.keyword)
    metafunc.parametrize("name", FILES, ids=[Path(file).stem for file in FILES.values()])


def test_exercise(name):
    """A bet is right once it is made."""
    state, words = judged(name, ROOT / FILES[name])
    if state == "blank":
        pytest.skip(f"{name}: {words}")
    if state == "wrong":
        pytest.fail(words, pytrace=False)


if __name__ == "__main__":
    sys.exit(pytest.main([__file__, *sys.argv[1:]]))
