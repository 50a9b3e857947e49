"""What a reader reads in one go, and what it speaks of.

A passage is a heading of chapter or README with its text, an exercise, the captions of a figure, or
the opening words of contact.py (the signs) and exact.py (the promise). Its sources are the regions
that it includes or names in `code`, the numbers that it quotes, and its own words where they stand
in code.
"""

import hashlib
import re
from pathlib import Path
from typing import NamedTuple

from curriculum.gate.chapter import CHAPTER, split
from curriculum.lesson.regions import ROOT, blank, line_at, read_text
from curriculum.stored import BLOCK

TEXTS = (CHAPTER, "README.md")
FIGURES = "curriculum/page/figures/*.js"
OPENING = re.compile(r'\A(?:#[^\n]*\n|\s)*""".*?"""', re.DOTALL)  # of a Python file
CAPTION = re.compile(
    r"""\b(?:title|caption):\s*(?:("|`)(?:(?!\1)[^\\]|\\.)*\1[\s+]*)+""", re.DOTALL
)
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")


class Passage(NamedTuple):
    """`name` is what one types when one has read it; `line` the one on which it begins."""

    name: str
    file: str
    line: int
    text: str

    def line_of(self, index) -> int:
        """The line of its file that holds text[index]."""
        return self.line + line_at(self.text, index) - 1

    def regions(self, regions) -> dict:
        """{source: hash} of the regions that it speaks of, and of its own words in code."""
        included = {part.name for part in split(self.text) if part.kind == "region"}
        words = {word for span in SPAN.findall(self.text) for word in re.findall(r"\w+", span)}
        own = not self.file.startswith(("exercises/", *TEXTS))
        found = {"its words": hashlib.sha256(self.text.encode()).hexdigest()} if own else {}
        found |= {r.source: r.sha for r in regions if r.source in included or r.defines & words}
        return {source: sha[:12] for source, sha in found.items()}


def passages() -> list:
    """All of them, in the order of their files."""
    found = [each for file in TEXTS for each in sections(file)]
    for file in files("exercises/ex*.py"):
        found.append(Passage(Path(file).name.split("_")[0], file, 1, read_text(file)))
    for file in ("contact.py", "curriculum/exact.py"):
        if opening := OPENING.match(read_text(file)):
            found.append(Passage(Path(file).name, file, 1, opening[0]))
    for file in files(FIGURES):
        if captions := "\n".join(caption[0] for caption in CAPTION.finditer(read_text(file))):
            found.append(Passage(f"figures/{Path(file).stem}", file, 1, captions))
    return found


def sections(file):
    """The headings of a text, each with what stands under it; what a command wrote is left out."""
    begun = None
    for part in split(blank(BLOCK, read_text(file))):
        if part.kind == "heading":
            if begun:
                yield begun
            name = part.name if file == CHAPTER else f"{file}: {part.name}"
            begun = Passage(name, file, part.line, "")
        if begun:
            begun = begun._replace(text=begun.text + part.text)
    if begun:
        yield begun


def files(*patterns):
    """The project's files of these patterns, as they are named in git."""
    paths = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in paths]
