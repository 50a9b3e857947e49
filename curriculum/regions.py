"""The named regions of the literate files: find them, hash them, print them.

    python -m curriculum.regions            # every region: file, name, lines, sha256
    python -m curriculum.regions NAME       # the text of one, as the chapter shows it

The literate files are the scripts that the chapter shows piece by piece (LITERATE). A region is
what stands between `# --- region: NAME ---` and the next `# --- endregion ---`, both at the left
margin. Regions are flat and closed, and every line of code stands in one. A name is in small
letters, digits, hyphens and underscores, and no two regions of all the files share one.

What stands outside the regions (the module's docstring, with the signs and symbols, and comments)
has a name too: contact-docstring in contact.py, exact-docstring in curriculum/exact.py. It is
hashed like a region, and no chapter needs to show it.

The hash rule: sha256 of the text a reader sees, that is the lines between the two markers, markers
left out, each line ended by one "\\n", encoded as UTF-8. Nothing else is trimmed or normalised.
Outside the regions, the lines that are not blank are taken together.
"""

import ast
import hashlib
import re
import sys
from pathlib import Path
from typing import NamedTuple

from curriculum.common.stoppable import stoppable
from curriculum.measured import LITERATE

ROOT = Path(__file__).resolve().parents[1]
CHECK = "python -m curriculum.regions"
NAME = r"[a-z][a-z0-9_-]*"
BEGIN = re.compile(rf"# --- region: ({NAME}) ---")
END = "# --- endregion ---"
MARKED = re.compile(rb"^\s*#\s*-+\s*region\b", re.MULTILINE)
LOOKS_LIKE_ONE = re.compile(r"\s*#\s*(-+\s*(end)?\s*region\b.*|(end)?region\b:?\s*[\w-]*\s*)", re.I)


class Region(NamedTuple):
    """One region: `first` is the line number of its first line of text (the marker is above it)."""

    name: str
    first: int
    text: str
    file: str = "contact.py"

    @property
    def last(self):
        return self.first + self.text.count("\n") - 1

    @property
    def sha256(self):
        return hashlib.sha256(self.text.encode("utf-8")).hexdigest()


class Scan:
    """One literate file, read: its regions by name in reading order, what stands outside, problems.

    A problem is one line, `file:line: what; repair: command`.
    """

    def __init__(self, data, file):
        """`data` is the file's bytes; `file` is its path from the root, for the problems."""
        self.file, self.problems, self.regions = file, [], {}
        self.outside = []  # (line number, line), 1-based
        text = self._decode(data)
        if text is not None:
            self._split(text.split("\n"))
            self._check_outside(text)

    @property
    def docstring(self):
        """What stands outside the regions, as a Region named after the file."""
        lines = [line for _, line in self.outside if line.strip()]
        text = "".join(f"{line}\n" for line in lines)
        return Region(docstring_name(self.file), 2, text, self.file)

    def problem(self, line, what, repair=f"edit it, then {CHECK}"):
        self.problems.append(f"{self.file}:{line}: {what}; repair: {repair}")

    def _decode(self, data):
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            self.problem(
                line, f"byte {data[error.start]:#x} is not UTF-8", f"save it as UTF-8, then {CHECK}"
            )
            return None
        if "\r" in text:
            line = text.count("\n", 0, text.index("\r")) + 1
            self.problem(
                line,
                "a carriage return: lines must end in \\n alone",
                f"sed -i 's/\\r//g' {self.file}",
            )
        return text.replace("\r\n", "\n").replace("\r", "\n")

    def _split(self, lines):
        name, first = None, 0
        for number, line in enumerate(lines, 1):
            begin = BEGIN.fullmatch(line)
            if begin:
                if name is not None:
                    self.problem(
                        number,
                        f"region {begin[1]} begins inside region {name}, begun in line {first - 1}",
                    )
                name, first = begin[1], number + 1
                if name in self.regions:
                    self.problem(
                        number,
                        f"a second region {name}; the other begins in line "
                        f"{self.regions[name].first - 1}",
                    )
            elif line == END:
                self._close(name, first, number, lines)
                name = None
            elif LOOKS_LIKE_ONE.fullmatch(line):
                self.problem(
                    number,
                    f"unknown marker {line.strip()!r}; allowed: '# --- region: NAME ---', '{END}'",
                )
            elif name is None:
                self.outside.append((number, line))
        if name is not None:
            self.problem(first - 1, f"region {name} is never closed")

    def _close(self, name, first, number, lines):
        if name is None:
            self.problem(number, "endregion, but no region is open")
            return
        body = "".join(f"{each}\n" for each in lines[first - 1 : number - 1])
        if not body.strip():
            self.problem(first - 1, f"region {name} is empty")
        self.regions.setdefault(name, Region(name, first, body, self.file))

    def _check_outside(self, text):
        try:
            docstring = _docstring_lines(text)
        except SyntaxError as error:
            self.problem(error.lineno, f"not Python: {error.msg}", f"python {self.file}")
            return
        for number, line in self.outside:
            if line.strip() and not line.lstrip().startswith("#") and number not in docstring:
                self.problem(number, f"code outside any region: {line.strip()[:60]!r}")


def docstring_name(file):
    """The name of what stands outside the regions of a file."""
    return f"{Path(file).stem}-docstring"


def _docstring_lines(text):
    """The line numbers of the module's docstring."""
    first = next(iter(ast.parse(text).body), None)
    if isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str):
        return range(first.lineno, first.end_lineno + 1)
    return range(0)


def scan_all(root=ROOT, read=None):
    """(regions by name over all literate files, docstrings included; problems).

    `read(file)` gives a file's bytes, None where there is no such file; without it they are read
    from `root`. A file without a single marker is no literate file yet, and is left out.
    """
    read = read or (lambda file: read_bytes(Path(root) / file))
    found, problems = {}, []
    for file in LITERATE:
        data = read(file)
        if data is None or not MARKED.search(data):
            continue
        scan = Scan(data, file)
        problems += scan.problems
        for region in (scan.docstring, *scan.regions.values()):
            if region.name in found:
                problems.append(
                    f"{file}:{region.first - 1}: a second region {region.name}; the "
                    f"other is in {found[region.name].file}; repair: rename one, then "
                    f"{CHECK}"
                )
            found.setdefault(region.name, region)
    return found, problems


def read_bytes(path):
    """A file's bytes, None where there is no such file."""
    return path.read_bytes() if path.exists() else None


def find(path=ROOT / "contact.py"):
    """The regions of one file by name, in reading order. Raises ValueError, one problem a line."""
    path = Path(path)
    inside = path.resolve().is_relative_to(ROOT)
    file = path.resolve().relative_to(ROOT).as_posix() if inside else path.name
    scan = Scan(path.read_bytes(), file)
    if scan.problems:
        raise ValueError("\n".join(scan.problems))
    return scan.regions


def find_all(root=ROOT):
    """The regions of all literate files by name, in reading order. Raises ValueError as `find`."""
    found, problems = scan_all(root)
    if problems:
        raise ValueError("\n".join(problems))
    return {name: region for name, region in found.items() if name != docstring_name(region.file)}


@stoppable
def main(argv=None):
    """List the regions, or print one. Returns the exit status: 1 malformed, 2 no such region."""
    from curriculum.common.arguments import Parser

    parser = Parser(prog=CHECK, description="The regions of the literate files.")
    parser.add_argument("name", nargs="?", metavar="NAME", help="print this one")
    name = parser.parse_args(argv).name
    found, problems = scan_all()
    if problems:
        print(*problems, sep="\n", file=sys.stderr)
        return 1
    if name is None:
        for region in found.values():
            lines = f"lines {region.first:>3} to {region.last:>3}"
            if region.name == docstring_name(region.file):
                lines = "outside the regions"
            print(f"{region.file:<20} {region.name:<18} {lines:<20} {region.sha256}")
    elif name in found:
        print(found[name].text, end="")
    else:
        print(f"given {name!r}, allowed: nothing or one of {', '.join(found)}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
