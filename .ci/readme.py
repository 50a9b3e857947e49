"""The commands that README.md has its readers type, word for word.

python3 .ci/readme.py SYSTEM    # the first set-up line of pip, windows or uv
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OPENS_A_WINDOW = (".venv/bin/rerun ", "uv run rerun ")  # so CI reads the recording instead


def section(text, heading):
    """What stands below a heading of the second level."""
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def set_up(text):
    """{"pip", "windows", "uv": the two lines each} of the block below "Run it"."""
    lines_of = {}
    for name, heading in {"pip": "Linux", "windows": "Windows", "uv": "anywhere with uv"}.items():
        lines = re.search(rf"^# {heading}.*\n(.+)\n(.+)\n(?=#|```)", section(text, "Run it"), re.M)
        if not lines:
            raise SystemExit(f"README.md, Run it: two lines are expected below # {heading}")
        lines_of[name] = lines.groups()
    return lines_of


def rows(text):
    """[(what, the pip command, the uv command)] of the table below "What to do next"."""
    table = section(text, "What to do next").partition("\n| --- | --- | --- |\n")[2]
    lines = table.split("\n\n")[0].splitlines()
    cells = [re.fullmatch(r"\| (.+?) \| `(.+?)` \| `(.+?)` \|", line) for line in lines]
    if len(cells) < 5 or not all(cells):
        raise SystemExit(f"README.md, What to do next: five rows or more of two commands; {lines}")
    return [each.groups() for each in cells]


if __name__ == "__main__":
    print(set_up((ROOT / "README.md").read_text("utf-8"))[sys.argv[1]][0])
