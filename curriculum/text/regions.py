"""The named regions of the literate files: the pieces of code that the chapter shows.

A region stands between `# --- region: NAME ---` and `# --- endregion ---`, at the left margin or,
within a class, further in. Regions are flat and closed, and a name belongs to one region of all
files.

Its hash is the sha256 of the text that a reader sees: the lines between the two markers, less the
indentation that all of them share, each ended by one "\\n", as UTF-8.
"""

import hashlib
import re
from functools import lru_cache
from pathlib import Path
from textwrap import dedent
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
CODE = ("contact.py", "curriculum/exact.py", "curriculum/fast.py")  # what a run runs
LITERATE = ("contact.py", "curriculum/exact.py", "curriculum/text/facts.py")  # what has regions
WHOLE = ("contact.py",)  # shown from top to bottom: no code stands outside its regions
NAME = r"[a-z][a-z0-9_-]*"
BEGIN = re.compile(rf" *# --- region: ({NAME}) ---")
END = "# --- endregion ---"
MARKER = re.compile(r"^\s*#\s*-+\s*(end)?\s*region\b.*$", re.MULTILINE | re.IGNORECASE)


class Region(NamedTuple):
    """One region; `line` is the number of its first line of code (the marker stands above it)."""

    name: str
    code: str
    line: int
    file: str = "contact.py"

    @property
    def sha(self) -> str:
        """64 hexadecimal digits."""
        return hashlib.sha256(self.code.encode("utf-8")).hexdigest()

    @property
    def lines(self) -> range:
        """The numbers of its lines in the file."""
        return range(self.line, self.line + self.code.count("\n"))

    @property
    def defines(self) -> frozenset:
        """The functions, methods, classes and constants that the region defines."""
        return defined(self.code)


# What a piece of code defines: functions, classes, and constants by their capitals.
DEFINITION = re.compile(r"^\s*(?:(?:def|class)\s+(\w+)|([A-Z][A-Z0-9_]*)\s*=(?!=))", re.MULTILINE)
DOCSTRING = re.compile(r'(?:#[^\n]*\n|\s)*(?:""".*?""")?', re.DOTALL)


@lru_cache(maxsize=256)
def defined(code: str) -> frozenset:
    """The names of functions, methods, classes and constants that a piece of code defines."""
    names = {name or constant for name, constant in DEFINITION.findall(code)}
    return frozenset(name for name in names if not name.startswith("__"))


def split(text: str, file: str) -> tuple:
    """({name: Region} in reading order, problems) of one file's text; each problem is one line."""
    found, problems = {}, []
    name, first = None, 0

    def say(line, what):
        problems.append(f"{file}:{line}: {what}; repair: edit the markers of the region")

    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        begin = BEGIN.fullmatch(line)
        if begin and name is None:
            name, first = begin[1], number + 1
        elif line.strip() == END and name is not None:
            if name in found:
                say(first - 1, f"a second region {name}")
            code = dedent("\n".join([*lines[first - 1 : number - 1], ""]))
            found[name] = Region(name, code, first, file)
            name = None
        elif MARKER.fullmatch(line):
            where = f"inside region {name}" if name else "outside any region"
            say(number, f"{line.strip()!r} {where}, where it does not belong")
    if name is not None:
        say(first - 1, f"region {name} is never closed")
    inside = {line for each in found.values() for line in each.lines}
    start = DOCSTRING.match(text).end() if file in WHOLE else len(text)
    for number in range(text.count("\n", 0, start) + 2, len(lines) + 1):
        line = lines[number - 1]
        if number not in inside and line[:1].strip("# "):       # a statement begins at column 0
            say(number, f"code outside any region: {line[:60]!r}")
    return found, problems


def split_all(read=None) -> tuple:
    """({name: Region}, problems) over all literate files; `read(file)` gives a text or None."""
    found, problems = {}, []
    for file in LITERATE:
        text = (read or read_text)(file)
        regions, wrong = split(text or "", file)
        problems += wrong
        for region in regions.values():
            if region.name in found:
                problems.append(
                    f"{file}:{region.line - 1}: a second region {region.name}, the other"
                    f" is in {found[region.name].file}; repair: rename one"
                )
            found.setdefault(region.name, region)
    return found, problems


def read_text(file, root=ROOT):
    """A file's text with "\\n" at its line ends; None where there is no such file."""
    path = Path(root) / file
    return path.read_text("utf-8") if path.is_file() else None


def read(path) -> dict:
    """{name: Region} of one file, in reading order. Raises ValueError, one problem a line."""
    path = Path(path).resolve()
    file = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name
    found, problems = split(path.read_text("utf-8"), file)
    if problems:
        raise ValueError("\n".join(problems))
    return found


def read_all() -> dict:
    """{name: Region} of all literate files. Raises ValueError, one problem a line."""
    found, problems = split_all()
    if problems:
        raise ValueError("\n".join(problems))
    return found
