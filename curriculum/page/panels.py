"""The code that the page shows: regions of the literate files, and the whole of contact.py."""

import functools
import re

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from curriculum import regions

FOLDED = 45  # lines: a longer excerpt is folded
WHOLE = "contact.py"
# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "kd", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


@functools.cache
def code_lines(text):
    """Highlighted code, a block a line; a line too long for its column goes on further in."""
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    shown = re.sub(
        r'<span class="(\w+)">([^<]*)</span>', lambda m: m[0] if m[1] in STYLED else m[2], shown
    )
    lines = shown.rstrip("\n").split("\n")
    indents = [len(line) - len(line.lstrip(" ")) for line in text.rstrip("\n").split("\n")]
    out = []
    for line, indent in zip(lines, indents):
        kind = "ln doc" if '<span class="sd">' in line else "ln"
        out.append(f'<span class="{kind}" style="--i:{indent}">{line}\n</span>')
    return Markup("".join(out))


def panels(root):
    """Every region of the literate files by (file, name), with its highlighted code."""
    found = {}
    for region in regions.find_all(root).values():
        count = region.last - region.first + 1
        found[region.file, region.name] = {
            "name": region.name,
            "title": None,
            "file": region.file,
            "first": region.first,
            "last": region.last,
            "sha256": region.sha256,
            "folded": count > FOLDED,
            "html": code_lines(region.text),
        }
    return found


def whole_file(root):
    """A panel with the whole of contact.py, folded."""
    text = (root / WHOLE).read_text(encoding="utf-8")
    return {
        "name": "contact-whole",
        "title": WHOLE,
        "file": WHOLE,
        "first": 1,
        "last": text.count("\n"),
        "folded": True,
        "html": code_lines(text),
    }
