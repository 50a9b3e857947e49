"""The commands that README.md has its readers type, word for word.

python3 .ci/readme.py SYSTEM    # the first set-up line of pip, windows or uv
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "README.md").read_text("utf-8")


def set_up(system):
    """The two lines of pip, windows or uv in the block below "Installation and first run"."""
    heading = {"pip": "Linux", "windows": "Windows", "uv": "anywhere with uv"}[system]
    lines = re.search(rf"^# {heading}.*\n(.+)\n(.+)\n(?=#|```)", TEXT, re.M)
    return lines.groups()


def rows():
    """[(what, the pip command, the uv command)] of the table below "Learning path"."""
    table = TEXT.partition("\n## Learning path\n")[2].partition("\n| --- | --- | --- |\n")[2]
    lines = table.split("\n\n")[0].splitlines()
    cells = re.findall(r"^\| (.+?) \| `(.+?)` \| `(.+?)` \|$", "\n".join(lines), re.M)
    assert len(cells) >= max(5, len(lines)), lines
    return cells


if __name__ == "__main__":
    print(set_up(sys.argv[1])[0])
