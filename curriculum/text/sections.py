"""The sections of chapter and README, each bound to the regions of which it speaks; other texts.

Whether a sentence is true of the code only a reader can say. So meta.yaml holds one hash for each
section: of its text, and of the code of every region that the section includes or names (a name in
`code span` that the region defines). When either side changes, somebody reads the section again.
So it is with the opening words of contact.py and exact.py (the signs, the promise), the exercises,
the captions of figures, and what meta.yaml promises, reads and runs; these have no regions. What a
command writes into the README needs no reader: it has a seal (measured/stale.py).
"""

import hashlib
import json
import re
from difflib import unified_diff
from functools import cache
from pathlib import Path
from typing import NamedTuple

from curriculum.measured.results import git
from curriculum.measured.stale import BLOCK
from curriculum.regions import ROOT, blank, line_at, read_text, split_all
from curriculum.text.references import INCLUDE

TEXTS = {"chapter": "curriculum/prose/chapter.md", "README": "README.md"}
FENCE = re.compile(r"^(```|~~~).*?^\1[ ]*$", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#{1,6} +(.*)$", re.MULTILINE)
OPENING = re.compile(r'\A(?:#[^\n]*\n|\s)*""".*?"""', re.DOTALL)  # of a Python file
CAPTION = re.compile(r"\b(?:title|caption):\s*(?:[\"`](?:[^\"`\\]|\\.)*[\"`][\s+]*)+")
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")


class Section(NamedTuple):
    """A heading with what follows it, up to the next heading; `line` is the heading's."""

    name: str
    file: str
    line: int
    text: str
    regions: tuple

    @property
    def sha(self) -> str:
        """16 hexadecimal digits of the text and of the code that it speaks of."""
        about = [self.text, [(region.name, region.sha) for region in self.regions]]
        return hashlib.sha256(json.dumps(about).encode("utf-8")).hexdigest()[:16]

    def parts(self) -> dict:
        """{what: lines}: the text, and the code of each region, for a diff."""
        code = {f"region {region.name}": region.code for region in self.regions}
        return {name: text.splitlines() for name, text in {self.file: self.text, **code}.items()}


def bound(text, regions) -> tuple:
    """The regions that a text includes, or of which it names what they define."""
    included = {match["name"] for match in INCLUDE.finditer(text)}
    words = {word for span in SPAN.findall(text) for word in re.findall(r"\w+", span)}
    return tuple(
        region for region in regions.values() if region.name in included or region.defines & words
    )


def sections(read=read_text) -> dict:
    """{name: Section} of chapter and README; `read(file)` gives a file's text."""
    regions, _ = split_all(read)
    found = {}
    for stem, file in TEXTS.items():
        text = BLOCK.sub(r"\1\n", read(file))
        prose = blank(FENCE, text)
        starts = [match.start() for match in HEADING.finditer(prose)]
        for first, last in zip(starts, [*starts[1:], len(text)]):
            heading = HEADING.match(text, first)
            slug = "-".join(re.findall(r"[a-z0-9]+", heading[1].lower())) or "untitled"
            name = f"{stem}/{slug}"
            while name in found:
                name += "-again"
            part = text[first:last].rstrip() + "\n"
            found[name] = Section(name, file, line_at(text, first), part, bound(part, regions))
    for name, file, text in others(read):
        if text:
            found[name] = Section(name, file, 1, text, ())
    return found


def others(read):
    """(name, file, text) of all that has words for a reader and stands elsewhere."""
    for file in ("contact.py", "curriculum/exact.py"):
        opening = OPENING.match(read(file))
        yield f"{Path(file).stem}/opening", file, opening[0] if opening else ""
    for part in re.split(r"^(?=[a-z])", read("meta.yaml"), flags=re.MULTILINE)[1:]:
        key = part.split(":")[0]
        if key in ("objectives", "reading", "runs"):
            yield f"meta/{key}", "meta.yaml", part.rstrip() + "\n"
    for file in files("exercises/ex*.py", "exercises/kit/*.json"):
        yield f"exercises/{Path(file).stem}", file, read(file)
    for file in files("curriculum/page/figures/*.js"):
        yield f"figures/{Path(file).stem}", file, "\n".join(CAPTION.findall(read(file)))


def files(*patterns):
    """The project's files of these patterns, as they are named in git."""
    found = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in found]


def changes(unread, recorded) -> str:
    """Diffs of the sections, from what was accepted (in git) to what is now, each part once."""
    found = {}
    for section in unread:
        for diff in differences(section, recorded.get(section.name)):
            found.setdefault(diff, []).append(section.name)
    return "".join(f"{' '.join(names)}\n{diff}\n\n" for diff, names in found.items())


def differences(section: Section, accepted) -> list:
    """The diffs of a section's text, and of the regions of which it speaks, since it was read."""
    if accepted is None:
        return ["(never read)"]
    commit = git("log", "-n1", "--format=%h", f"-S{accepted}", "--", "meta.yaml").strip() or "HEAD"
    was = accepted_in(commit).get(section.name)
    old, new = was.parts() if was else {}, section.parts()
    found = []
    for part in new | old:
        names = f"{part}, accepted", f"{part}, now"
        lines = unified_diff(old.get(part, []), new.get(part, []), *names, n=1, lineterm="")
        found.append("\n".join(lines))
    return [diff for diff in found if diff] or ["(what was accepted is not in git)"]


@cache
def accepted_in(commit) -> dict:
    """The sections as they were in a commit."""
    return sections(lambda file: git("show", f"{commit}:{file}"))
