"""The named regions of contact.py: find them, hash them, print them.

    python -m curriculum.regions            # every region: name, lines, sha256
    python -m curriculum.regions NAME       # the text of one, as the chapter shows it

A region is what stands between `# --- region: NAME ---` and the next `# --- endregion ---`, both
at the left margin; flat, closed, each name once, and every line of code inside one (the module's
docstring and comments may stand outside).

The hash rule: sha256 of the text a reader sees, that is the lines between the two markers, markers
left out, each line ended by one "\\n", encoded as UTF-8. Nothing else is trimmed or normalised.
"""

import ast
import hashlib
import re
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
CHECK = "python -m curriculum.regions"
BEGIN = re.compile(r"# --- region: ([a-z][a-z0-9_-]*) ---")
END = "# --- endregion ---"
LOOKS_LIKE_ONE = re.compile(r"\s*#\s*(-+\s*(end)?\s*region\b.*|(end)?region\b:?\s*\w*\s*)", re.I)


class Region(NamedTuple):
    """One region: `first` is the line number of its first line of text (the marker is above it)."""

    name: str
    first: int
    text: str

    @property
    def last(self):
        return self.first + self.text.count("\n") - 1

    @property
    def sha256(self):
        return hashlib.sha256(self.text.encode("utf-8")).hexdigest()


def scan(path):
    """(regions by name in reading order, problems as `file:line: what; repair: command`)."""
    problems = []

    def problem(line, what, repair=f"edit it, then {CHECK}"):
        problems.append(f"{Path(path).name}:{line}: {what}; repair: {repair}")

    data = Path(path).read_bytes()
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        problem(line, f"byte {data[error.start]:#x} is not UTF-8",
                f"save it as UTF-8, then {CHECK}")
        return {}, problems
    if "\r" in text:
        line = text.count("\n", 0, text.index("\r")) + 1
        problem(line, "a carriage return: lines must end in \\n alone", f"sed -i 's/\\r//g' {path}")
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    regions, name, first, lines = {}, None, 0, text.split("\n")
    outside = []                                      # (line number, line), 1-based
    for number, line in enumerate(lines, 1):
        begin = BEGIN.fullmatch(line)
        if begin and name is not None:
            problem(number, f"region {begin[1]} begins inside region {name}, begun in line "
                            f"{first - 1}")
        if begin:
            name, first = begin[1], number + 1
            if name in regions:
                problem(number, f"a second region {name}; the other begins in line "
                                f"{regions[name].first - 1}")
        elif line == END and name is None:
            problem(number, "endregion, but no region is open")
        elif line == END:
            body = "".join(f"{each}\n" for each in lines[first - 1:number - 1])
            if not body.strip():
                problem(first - 1, f"region {name} is empty")
            regions.setdefault(name, Region(name, first, body))
            name = None
        elif LOOKS_LIKE_ONE.fullmatch(line):
            problem(number, f"unknown marker {line.strip()!r}; allowed: '# --- region: NAME ---', "
                            f"'{END}'")
        elif name is None:
            outside.append((number, line))
    if name is not None:
        problem(first - 1, f"region {name} is never closed")
    try:
        docstring = _docstring_lines(text)
    except SyntaxError as error:
        problem(error.lineno, f"not Python: {error.msg}", f"python {path}")
    else:
        for number, line in outside:
            if line.strip() and not line.lstrip().startswith("#") and number not in docstring:
                problem(number, f"code outside any region: {line.strip()[:60]!r}")
    return regions, problems


def _docstring_lines(text):
    """The line numbers of the module's docstring."""
    first = next(iter(ast.parse(text).body), None)
    if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
        return range(first.lineno, first.end_lineno + 1)
    return range(0)


def find(path=ROOT / "contact.py"):
    """The regions by name, in reading order. Raises ValueError, one problem a line."""
    regions, problems = scan(path)
    if problems:
        raise ValueError("\n".join(problems))
    return regions


def main(argv=None):
    """List the regions, or print one. Returns the exit status: 1 malformed, 2 no such region."""
    names = sys.argv[1:] if argv is None else argv
    try:
        regions = find()
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    if not names:
        for region in regions.values():
            print(f"{region.name:<10} lines {region.first:>3} to {region.last:>3}  {region.sha256}")
    elif len(names) == 1 and names[0] in regions:
        print(regions[names[0]].text, end="")
    else:
        print(f"given {' '.join(names)!r}, allowed: nothing or one of {', '.join(regions)}",
              file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
