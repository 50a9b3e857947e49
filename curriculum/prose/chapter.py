"""Split the chapter's Markdown into parts, for the gate, the page, the notebook and the tests.

Beside plain Markdown it may hold
- an include, a fence with the one line [include-by-region: FILE#NAME]: the code of a region;
- references to numbers in double braces (references.py), and formulas between dollar signs;
- slots, comments on a line of their own: <!-- figure: NAME -->, <!-- exercise: NAME -->,
  <!-- bench: NAME -->, <!-- stress: NAME -->, <!-- wallclock -->, and <!-- puzzle -->, behind
  which the rest of a section is its answer. What a figure begins with stands behind its name:
  cliff?dt=0.03.

Other comments, on lines of their own, vanish. HTML is shown as it is typed.
"""

import re
from typing import NamedTuple

from curriculum.source import NAME, line_at

CHAPTER = "curriculum/prose/chapter.md"
INCLUDE = re.compile(rf"\[include-by-region: ([\w./-]+\.py#{NAME})\]")
MARKS = "figure|exercise|bench|stress|wallclock|puzzle"
PART = re.compile(
    rf"""
    (?:^(?P<fence>```|~~~)[^\n]*\n(?P<code>(?s:.*?))^(?P=fence)[ ]*
    |^\#{{1,6}}[ ]+(?P<heading>.*)
    |^<!--[ ](?P<kind>{MARKS})(?::[ ](?P<slot>\S+))?[ ]-->
    |^<!--(?P<comment>(?s:.*?))-->[ ]*
    )(?:\n+|\Z)
    """,
    re.MULTILINE | re.VERBOSE,
)
LIKE_A_MARK = re.compile(rf"include-by-region|<!--\s*(?:(?:{MARKS})\b|[\w-]+(?::\s*\S+)?\s*-->)")
INLINE = re.compile(r"(`+)[^`]+\1|\$\$.+?\$\$|\$[^$\n]+\$|<https?://[^>\s]+>", re.DOTALL)
PROSE = ("text", "heading")
PLAIN = (*PROSE, "code", "comment")
AS_IT_IS = "write [include-by-region: FILE#NAME] alone in a fence, or <!-- figure: NAME -->"


class Part(NamedTuple):
    """A piece of the chapter, or of another file; those of a file together are the file.

    kind: one of PLAIN ("code" is a fence), "region", what a slot is called, or "opening".
    name: of a region FILE#NAME, of a slot what stands behind its colon, else the words within.
    """

    kind: str
    name: str
    line: int
    text: str
    file: str = CHAPTER

    def line_of(self, match, group=0) -> int:
        """Return the line of its file on which a match in its text, or a group of it, begins."""
        return self.line + line_at(self.text, match.start(group)) - 1


def split(text) -> list:
    """Return the parts of a text, in order."""
    parts, done = [], 0
    for match in PART.finditer(text):
        if before := text[done : match.start()]:
            parts.append(Part("text", "", line_at(text, done), before))
        kind, name = match["kind"] or match.lastgroup, match["slot"] or ""
        if kind in PLAIN:
            name = match[kind].rstrip()
        if kind == "code" and (include := INCLUDE.fullmatch(name.strip())):
            kind, name = "region", include[1]
        parts.append(Part(kind, name, line_at(text, match.start()), match[0]))
        done = match.end()
    return [*parts, Part("text", "", line_at(text, done), text[done:])]


def faults(parts):
    """Yield a line for each malformed mark."""
    for part in (part for part in parts if part.kind in PLAIN):
        for match in LIKE_A_MARK.finditer(part.text):
            place = f"{CHAPTER}:{part.line_of(match)}"
            yield f"{place}: no include or slot that is well formed; repair: {AS_IT_IS}"


def read(text) -> list:
    """Return the parts of the chapter. Raises ValueError, a line a fault."""
    parts = split(text)
    if wrong := "\n".join(faults(parts)):
        raise ValueError(wrong)
    return parts
