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
WIDEST = 92  # characters of the docstrings' lines, which are broken by hand: about that
# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "kd", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


@functools.cache
def code_lines(text):
    """Highlighted code, a block a line; a line too long for its column goes on further in.

    Lines of a docstring that were broken for their length alone are one block, which the browser
    breaks anew, and the blanks before a comment at a line's end shrink to one. What is copied are the
    characters of the file.
    """
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    shown = re.sub(
        r'<span class="(\w+)">([^<]*)</span>', lambda m: m[0] if m[1] in STYLED else m[2], shown
    )
    lines, sources = shown.rstrip("\n").split("\n"), text.rstrip("\n").split("\n")
    out, before = [], None
    for line, source in zip(lines, sources):
        line = re.sub(r'(\S)( {2,})(<span class="c1">)', r'\1<span class="gap">\2</span>\3', line)
        doc = '<span class="sd">' in line
        if doc and before is not None and broken_for_length(before, source):
            start = out[-1].replace('class="ln doc"', 'class="ln flow"', 1)
            out[-1] = start.removesuffix("</span>") + f"{line}\n</span>"
        else:
            kind = "ln doc" if doc else "ln"
            indent = len(source) - len(source.lstrip(" "))
            out.append(f'<span class="{kind}" style="--i:{indent}">{line}\n</span>')
        before = source if doc else None
    return Markup("".join(out))


def broken_for_length(line, following):
    """Whether a docstring's line goes on in the next only because that one's first word did not fit."""
    words = following.split()
    same = len(line) - len(line.lstrip(" ")) == len(following) - len(following.lstrip(" "))
    flowing = words and same and "   " not in (line.strip() + following.strip())
    starts = words and (words[0] == '"""' or re.match(r"\w*_\w*(, \w+)*:", following.strip()))
    return bool(flowing and not starts and len(line) + 1 + len(words[0]) > WIDEST)


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
