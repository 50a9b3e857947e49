"""The named regions of the literate files: the pieces of code that the chapter shows.

A region begins at `# --- region: NAME ---`, at the left margin or, within a class, further in. It
ends at `# --- endregion ---`; in a file that is shown from top to bottom, at the next region.
Regions are flat, and a name belongs to one region of all files.

Its hash is the sha256 of the text that a reader sees: the lines between the two markers, less the
indentation that they share and blank lines at the end, each ended by one "\\n", as UTF-8.
"""

import ast
import hashlib
import re
from textwrap import dedent
from typing import NamedTuple

from curriculum.commands import ROOT

WHOLE = ("contact.py",)  # shown from top to bottom: no code stands outside its regions
LITERATE = (*WHOLE, "curriculum/exact.py", "curriculum/variants.py")
NAME = r"[a-z][a-z0-9_-]*"
REGION = re.compile(
    rf"^ *# --- region: ({NAME}) ---\n(.*?)(^ *# --- endregion --- *$|(?=^# --- region: )|\Z)",
    re.DOTALL | re.MULTILINE,
)
# What a piece of code defines: functions, classes, and constants by their capitals.
DEFINITION = re.compile(
    r"^\s*(?:(?:def|class)\s+(?!__)(\w+)|([A-Z][A-Z0-9_]*)(?:, \w+)*\s*=(?!=))", re.MULTILINE
)
DOCSTRING = re.compile(r'(?:#[^\n]*\n|\s)*(?:""".*?""")?', re.DOTALL)
CODE_LINE = re.compile(r"^[^\s#].*", re.MULTILINE)


class Region(NamedTuple):
    """One region; `line` is the number of its first line of code (the marker stands above it)."""

    name: str
    code: str
    line: int
    file: str

    @property
    def source(self) -> str:
        """Return its name in includes and stamps, FILE#NAME."""
        return f"{self.file}#{self.name}"

    @property
    def sha(self) -> str:
        """Return the hash of its text, 64 hexadecimal digits."""
        return hashlib.sha256(self.code.encode("utf-8")).hexdigest()

    @property
    def defines(self) -> set:
        """Return the functions, methods, classes and constants that the region defines."""
        return {name or constant for name, constant in DEFINITION.findall(self.code)}


def blank(pattern, text):
    """Return the text with every match replaced by blanks, so that positions stay."""
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def replace_once(text, old, new, place):
    """Return the text with `old` replaced. Raises ValueError unless it stands there exactly once.

    place: what the text is called in the error, as in "contact.py: '...' stands there 2 times".
    """
    if (count := text.count(old)) != 1:
        raise ValueError(f"{place}: {old!r} stands there {count} times; allowed: once")
    return text.replace(old, new)


def line_at(text, index) -> int:
    """Return the number of the line that holds text[index]."""
    return text.count("\n", 0, index) + 1


def split(text: str, file: str) -> tuple:
    """Return ([Region] in reading order, problems) of a file's text; each problem is a line."""
    regions, wrong = [], []
    for match in REGION.finditer(text):
        name, code, end = match.groups()
        code = dedent(code).rstrip("\n") + "\n"
        regions.append(Region(name, code, line_at(text, match.start(2)), file))
        if not end and file not in WHOLE:
            wrong.append((match.start(), f"region {name} is never closed"))
    opening = next(DOCSTRING.finditer(text)).end() if file in WHOLE else len(text)
    for line in CODE_LINE.finditer(blank(REGION, text), opening):
        wrong.append((line.start(), f"code outside any region: {line[0][:60]!r}"))
    repair = "edit the markers of the region"
    return regions, [f"{file}:{line_at(text, k)}: {what}; repair: {repair}" for k, what in wrong]


def read_text(file):
    """Return the text of a file of the project; "" where there is none."""
    path = ROOT / file
    return path.read_text("utf-8") if path.is_file() else ""


def split_all() -> tuple:
    """Return ({name: Region}, problems) over all literate files."""
    by_name: dict = {}
    problems = []
    for file in LITERATE:
        regions, wrong = split(read_text(file), file)
        problems += wrong
        for region in regions:
            other = by_name.setdefault(region.name, region)
            if other is not region:
                what = f"a second region {region.name}, the other is in {other.file}"
                problems.append(f"{file}:{region.line - 1}: {what}; repair: rename one")
    return by_name, problems


def read_all() -> dict:
    """Return {name: Region} of all literate files. Raises ValueError, a line a problem."""
    by_name, problems = split_all()
    if problems:
        raise ValueError("\n".join(problems))
    return by_name


def stored(node):
    """Return the names that a definition assigns."""
    names = [each for each in ast.walk(node) if isinstance(each, ast.Name)]
    return {each.id for each in names if isinstance(each.ctx, ast.Store)}


def uses(name, node):
    """Return the names that a definition uses and does not assign, and NAME of contact.NAME."""
    own = stored(node) - {name} | {each.arg for each in ast.walk(node) if isinstance(each, ast.arg)}
    used = {each.id for each in ast.walk(node) if isinstance(each, ast.Name)} - own
    others = [each for each in ast.walk(node) if isinstance(each, ast.Attribute)]
    return used | {each.attr for each in others if ast.unparse(each.value) == "contact"}


def needed(roots, *files):
    """Return {name: (file, node)} of all that `roots` reach at the top of these files, in order."""
    known = {}
    for file in files:
        for node in ast.parse(file.read_text("utf-8")).body:
            target = node.targets[0] if isinstance(node, ast.Assign) else node
            name = getattr(target, "name", getattr(target, "id", None))
            known |= {name: (file.name, node)} if name else {}
    wanted = list(roots)
    for name in wanted:  # grows while it is read
        wanted += sorted(uses(name, known[name][1]) & set(known) - set(wanted))
    return {name: known[name] for name in known if name in wanted}
