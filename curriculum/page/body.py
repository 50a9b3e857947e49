"""The chapter's HTML as the page holds it: its slots filled, and its answers veiled.

Nothing on the page tells the answer of a bet before the reader has bet or has asked to be shown. The
chapter is cut into segments, each from a heading or an exercise to the next. A segment behind a bet
that tells its answer is put into a veil, but not its heading, so that a link to it still leads to it.
What tells an answer is found by its words (TELLS), in the text, the code and the figures alike; a
test reads what a browser then shows, words and numbers. The puzzle has a veil of the same kind, which
ends at the map that shows its answer.
"""

import re
from typing import NamedTuple

from markupsafe import Markup

from curriculum.check_prose_code_drift import CHAPTER

MACHINERY = "the rest of the file"  # the section whose excerpts are all folded
# what would tell the answer of a bet, in the words of the text, the code and the figures
TELLS = {
    "ex1": re.compile(
        r"\bsinks?\b|\bsank\b|\bdives?\b|\brings?\b|\bringing\b|\bhops?\b|pops? up|m g ?/ ?k|\bsag"
        r"|inside the table|rests? (a little )?inside|deeper|gap at rest|at rest / r|lets? (it )?in\b"
        r"|sandbox|rest depth",
        re.IGNORECASE,
    ),
    "ex3": re.compile(
        r"\bexplodes?\b|explosion|blows? up|critical|\b(un)?stable\b|stability|stays? bounded|\bcliff"
        r"|\bgains? .{0,60}energy|energy from nowhere|energy above the start|a multiple of"
        r"|at which time steps|the largest step|gives up|bursts",
        re.IGNORECASE,
    ),
    "ex4": re.compile(
        r"mass cancels|no mass in|\(1 . d\) \\?,? ?g\b|equally deep|whatever the mass|per unit of mass"
        r"|gap at rest|rests? (a little )?inside|rest depth|soft.{0,60}\bdeep\b|sandbox",
        re.IGNORECASE,
    ),
}


class Segment(NamedTuple):
    """A heading or an exercise (None before the first), and the parts that follow it."""

    opening: tuple
    parts: list


def segments(parts):
    """The chapter's parts (kind, value) as Segments."""
    found = [Segment(None, [])]
    for kind, value in parts:
        if kind == "heading" or (kind == "slot" and value.startswith("exercise:")):
            found.append(Segment((kind, value), []))
        else:
            found[-1].parts.append((kind, value))
    return found


def plain(html):
    """What HTML says, in words: text, and the names of pictures."""
    named = re.sub(r'<[^>]*\b(?:alt|aria-label)="([^"]*)"[^>]*>', r" \1 ", html)
    return " ".join(re.sub(r"<[^>]+>", "", named).split())


class Body:
    """The chapter's HTML as it grows, and (level, id, text) of its headings."""

    def __init__(self, slots, code, macros, bets):
        self.slots, self.code, self.macros, self.bets = slots, code, macros, bets
        self.html, self.contents = [], []
        self.met = []  # the bets above
        self.veils, self.puzzle_depth, self.machinery = 0, 0, False

    def add(self, segment):
        """A segment: its heading or exercise, and the rest behind the veils that it needs."""
        self.lift()
        bet = None
        if segment.opening:
            kind, value = segment.opening
            if kind == "heading":
                self.heading(*value)
            else:
                bet = self.exercise(value)
        for name in self.telling(segment, bet):
            self.veil(name)
        for kind, value in segment.parts:
            if kind == "include":
                self.include(*value)
            elif kind == "slot":
                self.slot(value)
            else:
                self.html.append(value)

    def telling(self, segment, bet):
        """The bets above whose answer a segment tells; what follows a bet tells its answer."""
        if not segment.parts:
            return []
        said = plain(" ".join(self.shown(*part) for part in segment.parts))
        return [name for name in self.met if name == bet or TELLS[name].search(said)]

    def shown(self, kind, value):
        """The HTML of a part."""
        if kind == "include":
            return self.code[value]["html"] if value in self.code else ""
        return self.slots.get(value, "") if kind == "slot" else value

    def lift(self, keep=0):
        """Close the veils that are open, but for `keep` of them."""
        self.html += ["</div></div>"] * (self.veils - keep)
        self.veils = min(self.veils, keep)

    def veil(self, name):
        """Open a veil."""
        self.html.append(str(self.macros.veil(name)))
        self.veils += 1

    def heading(self, level, name, inner):
        """A heading, and its line of the contents."""
        if level <= 2:
            self.machinery = MACHINERY in inner.lower()
        if level > 1:
            self.html.append(str(self.macros.heading(level, name, Markup(inner))))
            self.contents.append((level, name, Markup(re.sub(r"</?(code|a)[^>]*>", "", inner))))

    def exercise(self, slot):
        """An exercise; its name if it is a bet."""
        self.slot(slot)
        name = slot.removeprefix("exercise:")
        if name not in self.bets:
            return None
        self.met.append(name)
        return name

    def include(self, file, name):
        """An excerpt of code."""
        if (file, name) not in self.code:
            raise ValueError(f"{CHAPTER}: includes {file}#{name}, and there is no such region")
        panel = self.code[file, name]
        panel = panel | {"folded": self.machinery or panel["folded"]}
        self.html.append(str(self.macros.panel(panel)))

    def slot(self, name):
        """A figure, a table or an exercise; the puzzle opens a veil, and a map of stress ends it."""
        if name not in self.slots and not name.startswith(("bench:", "stress:")):
            raise ValueError(
                f"{CHAPTER}: a slot for {name!r}; allowed: {', '.join(sorted(self.slots))}"
            )
        self.html.append(self.slots.get(name, ""))
        if name == "figure:puzzle":
            self.puzzle_depth = self.veils
            self.veil("puzzle")
        elif name.startswith("stress:") and self.veils > self.puzzle_depth:
            self.lift(keep=self.puzzle_depth)

    def whole_file(self, whole):
        """The last section: all of contact.py, folded, behind the veils of the answers it tells."""
        part = ("html", str(self.macros.panel(whole)))
        heading = ("heading", (2, "whole-file", "The whole file"))
        self.add(Segment(heading, [part]))


def assemble(parts, slots, code, macros, bets, whole):
    """(body, contents): the chapter's HTML, and (level, id, text) of its headings."""
    body = Body(slots, code, macros, bets)
    for segment in segments(parts):
        body.add(segment)
    body.whole_file(whole)
    body.lift()
    return "\n".join(body.html), body.contents
