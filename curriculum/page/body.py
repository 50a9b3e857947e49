"""The chapter's HTML: its slots filled, and its answers veiled.

Nothing on the page tells the answer of a bet before the reader has bet or has asked to be shown. A
segment, from a heading or an exercise to the next, that tells the answer of a bet above is put into
a veil, but not its heading. What tells an answer is found by its words, in text, code and figures.
"""

import re

from markupsafe import Markup

from curriculum.page.prose import CHAPTER

MACHINERY = "the rest of the file"  # the section whose excerpts are all folded
# what would tell the answer of a bet, in the words of the text, the code and the figures
TELLS = {
    "ex1": re.compile(
        r"\bsinks?\b|\bsank\b|\bdives?\b|\brings?\b|\bringing\b|\bhops?\b|pops? up|m g ?/ ?k|\bsag"
        r"|inside the table|rests? (a little )?inside|deeper|gap at rest|at rest / r|rest depth",
        re.IGNORECASE,
    ),
    "ex3": re.compile(
        r"\bexplodes?\b|explosion|blows? up|critical|\b(un)?stable\b|stability|stays? bounded"
        r"|\bcliff|\bgains? .{0,60}energy|energy from nowhere|energy above the start|bursts"
        r"|the largest step",
        re.IGNORECASE,
    ),
    "ex4": re.compile(
        r"mass cancels|no mass in|\(1 . d\) \\?,? ?g\b|equally deep|whatever the mass"
        r"|per unit of mass|gap at rest|rests? (a little )?inside|rest depth|soft.{0,60}\bdeep\b",
        re.IGNORECASE,
    ),
}


class Body:
    """The chapter's HTML as it grows, and (level, id, text) of its headings."""

    def __init__(self, slots, code, macros, bets, draft):
        self.slots, self.code, self.macros, self.bets, self.draft = slots, code, macros, bets, draft
        self.html, self.contents, self.met, self.missing = [], [], [], []
        self.machinery = False

    def add(self, opening, parts):
        """A segment: its heading or exercise, and the rest behind the veils that it needs."""
        self.html.append(self.shown(*opening))
        rest = [self.shown(*part) for part in parts]
        puzzle = ("slot", "figure:puzzle")
        if puzzle in parts:  # what follows it is its answer
            rest.insert(parts.index(puzzle) + 1, str(self.macros.veil("puzzle")))
            rest.append("</div></div>")
        said = plain(" ".join(rest))
        last = opening[1].removeprefix("exercise:") if opening[0] == "slot" else None
        if last in self.bets:
            self.met.append(last)
        veils = (
            [name for name in self.met if name == last or TELLS[name].search(said)] if said else []
        )
        self.html += [str(self.macros.veil(name)) for name in veils]
        self.html += [*rest, *["</div></div>"] * len(veils)]

    def shown(self, kind, value):
        """The HTML of a part."""
        if kind == "heading":
            return self.heading(*value)
        if kind == "include":
            return self.include(*value)
        if kind == "show":
            return f'<i class="show" data-show="{value.replace("&", "&amp;")}"></i>'
        return self.slot(value) if kind == "slot" else value

    def heading(self, level, name, inner):
        """A heading, and its line of the contents."""
        if level <= 2:
            self.machinery = MACHINERY in inner.lower()
        if level == 1:
            return ""
        self.contents.append((level, name, Markup(re.sub(r"</?(code|a|math)[^>]*>", "", inner))))
        return str(self.macros.heading(level, name, Markup(inner)))

    def include(self, file, name):
        """An excerpt of code."""
        if (file, name) not in self.code:
            return self.lack(f"includes {file}#{name}, and there is no such region")
        return str(self.macros.panel(self.code[file, name] | {"machinery": self.machinery}))

    def slot(self, name):
        """A figure, a table or an exercise."""
        if name not in self.slots:
            return self.lack(f"has a slot for {name}; known are {', '.join(sorted(self.slots))}")
        return self.slots[name]

    def lack(self, what):
        """What to show in place of something that is not there; not allowed but in a draft."""
        if not self.draft:
            raise ValueError(f"{CHAPTER}: {what}")
        self.missing.append(what)
        return f'<p class="note">The chapter {what.partition("; known")[0]}.</p>'


def plain(html):
    """What HTML says, in words: text, and the names of pictures."""
    named = re.sub(r'<[^>]*\b(?:alt|aria-label)="([^"]*)"[^>]*>', r" \1 ", html)
    return " ".join(re.sub(r"<[^>]+>", "", named).split())


def assemble(parts, slots, code, macros, bets, draft=False):
    """The chapter's Body."""
    body = Body(slots, code, macros, bets, draft)
    opening, held = ("html", ""), []
    for kind, value in [*parts, ("heading", None)]:
        if kind == "heading" or (kind == "slot" and value.startswith("exercise:")):
            body.add(opening, held)
            opening, held = (kind, value), []
        else:
            held.append((kind, value))
    return body
