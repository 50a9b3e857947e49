"""Seals: a written file says what it was made of, so that a change of it by hand is seen.

The last line of a page, a figure, or a block of the README that a command wrote is a comment: the
files it was made of, and a hash of these and of the text. Who edits the text, or changes what made
it and does not write it again, breaks the seal; no reader need accept a digit of it.
"""

import re

from curriculum.measured import stale
from curriculum.regions import read_text

SEAL = re.compile(r"<!-- sealed ([0-9a-f]{12}) from (.*) -->\n\Z")
BLOCK = re.compile(r"(<!-- generated: (\w+) by (.*?) -->)\n(.*?)(?=<!-- end -->)", re.DOTALL)


def seal_of(text: str, sources) -> str:
    """12 hexadecimal digits of a text and of the files that it was made of."""
    code = stale.fingerprint(*(name for name in sources if name.endswith(".py")))
    data = [read_text(name) for name in sources if not name.endswith(".py")]
    return stale.digest([text, code, data])


def sealed(text: str, *sources) -> str:
    """The text with its seal; sources are files of the project."""
    text = text.rstrip("\n") + "\n"
    return f"{text}<!-- sealed {seal_of(text, sources)} from {' '.join(sources)} -->\n"


def holds(text: str) -> bool:
    """Whether a text has its seal and is what was written, of what is there today."""
    seal = SEAL.search(text)
    return seal is not None and seal[1] == seal_of(text[: seal.start()], seal[2].split())
