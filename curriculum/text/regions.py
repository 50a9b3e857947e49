"""The named regions of the literate files: the pieces of code that the chapter shows.

A region stands between `# --- region: NAME ---` and `# --- endregion ---`, at the left margin or,
within a class, further in. Regions are flat and closed, and a name belongs to one region of all
files.

Its hash is the sha256 of the text that a reader sees: the lines between the two markers, less the
indentation that all of them share, each ended by one "\\n", as UTF-8.
"""

import hashlib
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import dedent

ROOT = Path(__file__).resolve().parents[2]
CODE = ("contact.py", "curriculum/exact.py", "curriculum/fast.py")  # what a run runs
LITERATE = ("contact.py", "curriculum/exact.py", "curriculum/text/facts.py")  # what has regions
WHOLE = ("contact.py",)  # shown from top to bottom: no code stands outside its regions
NAME = r"[a-z][a-z0-9_-]*"
BEGIN = re.compile(rf" *# --- region: ({NAME}) ---")
END = "# --- endregion ---"
MARKER = re.compile(r"^\s*#\s*-+\s*(end)?\s*region\b.*$", re.IGNORECASE)
# What a piece of code defines: functions, classes, and constants by their capitals.
DEFINITION = re.compile(r"^\s*(?:(?:def|class)\s+(\w+)|([A-Z][A-Z0-9_]*)\s*=(?!=))", re.MULTILINE)
DOCSTRING = re.compile(r'(?:#[^\n]*\n|\s)*(?:""".*?""")?', re.DOTALL)


@dataclass(frozen=True)
class Region:
    """One region; `line` is the number of its first line of code (the marker stands above it)."""

    name: str
    code: str
    line: int
    file: str

    @property
    def sha(self) -> str:
        """64 hexadecimal digits."""
        return hashlib.sha256(self.code.encode("utf-8")).hexdigest()

    @cached_property
    def defines(self) -> frozenset:
        """The functions, methods, classes and constants that the region defines."""
        names = {name or constant for name, constant in DEFINITION.findall(self.code)}
        return frozenset(name for name in names if not name.startswith("__"))


def split(text: str, file: str) -> tuple:
    """([Region] in reading order, problems) of one file's text; each problem is one line."""
    found, problems = [], []
    name, first = None, 0

    def say(line, what):
        problems.append(f"{file}:{line}: {what}; repair: edit the markers of the region")

    lines = text.split("\n")
    head = text.count("\n", 0, DOCSTRING.match(text).end()) + 1 if file in WHOLE else len(lines)
    for number, line in enumerate(lines, 1):
        begin = BEGIN.fullmatch(line)
        if begin and name is None:
            name, first = begin[1], number + 1
        elif line.strip() == END and name is not None:
            code = dedent("\n".join([*lines[first - 1 : number - 1], ""]))
            found.append(Region(name, code, first, file))
            name = None
        elif MARKER.fullmatch(line):
            where = f"inside region {name}" if name else "outside any region"
            say(number, f"{line.strip()!r} {where}, where it does not belong")
        elif name is None and number > head and line[:1].strip("# "):
            say(number, f"code outside any region: {line[:60]!r}")
    if name is not None:
        say(first - 1, f"region {name} is never closed")
    return found, problems


def read_text(file):
    """The text of one of the project's files; empty where there is no such file."""
    path = ROOT / file
    return path.read_text("utf-8") if path.is_file() else ""


def split_all(read=read_text) -> tuple:
    """({name: Region}, problems) over all literate files; `read(file)` gives a file's text."""
    found, problems = {}, []
    for file in LITERATE:
        regions, wrong = split(read(file), file)
        problems += wrong
        for region in regions:
            other = found.setdefault(region.name, region)
            if other is not region:
                what = f"a second region {region.name}, the other is in {other.file}"
                problems.append(f"{file}:{region.line - 1}: {what}; repair: rename one")
    return found, problems


def read_all() -> dict:
    """{name: Region} of all literate files. Raises ValueError, one problem a line."""
    found, problems = split_all()
    if problems:
        raise ValueError("\n".join(problems))
    return found
