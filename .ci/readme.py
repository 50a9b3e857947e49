"""The commands that README.md has its readers type, word for word.

python3 .ci/readme.py SYSTEM    # the first set-up line of pip, windows or uv
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STARTS = r"(?:python3?|py|pip|uv|pytest|ruff|mypy|mutmut|pre-commit|\.venv/bin/\w+|\.ci/\w+) "
NOT_RUN = {  # how it starts: why CI does not run it
    "py -m venv": "for Windows, where the workflow ci.yml runs the first of the two",
    ".venv/bin/rerun ": "opens a window; CI reads the recording with `rerun rrd verify`",
    "uv run rerun ": "opens a window; CI reads the recording with `rerun rrd verify`",
    "uv run python contact.py --scene drop && uv run rerun": "its second half opens a window",
    "python -m curriculum.text --accept": "says that a person has read what changed",
    "python -m curriculum.bench": "long; CI runs it with --quick",
    "python -m curriculum.stress": "long; CI runs it with --quick",
    "python -m curriculum.page --pictures": "writes the README's picture into the tree",
    "python -m curriculum.tests.test_golden": "pins anew what the tests compare with",
    "python3 -m venv .venv && .venv/bin/pip install -e '.[dev]' && .venv/bin/pre-commit": (
        "CI runs its first half by the README's line, and then its second"
    ),
    ".venv/bin/python -m ...": "a form of commands",
    "uv run --extra dev ...": "a form of commands",
    "python contact.py --scene NAME": "NAME is yours",
    "python contact.py --help": "test_packaging runs it",
    "pytest checks.py -k exN_": "N is yours",
    "pytest curriculum/tests/": "a part of the tests",
    "mutmut ": "an hour, before a release",
    "uv lock": "changes the lock; the workflow ci.yml runs `uv lock --check`",
}


def section(text, heading):
    """What stands below a heading of the second level."""
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def set_up(text):
    """{"pip", "windows", "uv": the two lines each} of the block below "Run it"."""
    found = {}
    for name, heading in {"pip": "Linux", "windows": "Windows", "uv": "anywhere with uv"}.items():
        lines = re.search(rf"^# {heading}.*\n(.+)\n(.+)\n(?=#|```)", section(text, "Run it"), re.M)
        if not lines:
            raise SystemExit(f"README.md, Run it: two lines are expected below # {heading}")
        found[name] = lines.groups()
    return found


def rows(text):
    """[(what, the pip command, the uv command)] of the table below "What to do next"."""
    table = section(text, "What to do next").partition("\n| --- | --- | --- |\n")[2]
    lines = table.split("\n\n")[0].splitlines()
    found = [re.fullmatch(r"\| (.+?) \| `(.+?)` \| `(.+?)` \|", line) for line in lines]
    if len(found) < 5 or not all(found):
        raise SystemExit(f"README.md, What to do next: five rows or more of two commands; {lines}")
    return [each.groups() for each in found]


def why_not(command):
    """Why CI does not run a command; None where it does."""
    return next((why for start, why in NOT_RUN.items() if command.startswith(start)), None)


def others(text):
    """All other commands of a text, in backticks or in a block."""
    lines = [
        line.strip()
        for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
        for line in block.splitlines()
    ]
    inline = re.findall(r"(?<!`)`([^`\n]+)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL))
    return [each for each in (*lines, *inline) if re.match(STARTS, each + " ")]


def left_out(run):
    """(text, command, why) of README's and CONTRIBUTING's commands that are in no line of `run`."""
    lines = [line.replace(".venv/bin/", "") for line in (*run, ".ci/run")]
    for name in ("README.md", "CONTRIBUTING.md"):
        for command in others((ROOT / name).read_text("utf-8")):
            if not any(command.replace(".venv/bin/", "") in line for line in lines):
                yield name, command, why_not(command)


if __name__ == "__main__":
    print(set_up((ROOT / "README.md").read_text("utf-8"))[sys.argv[1]][0])
