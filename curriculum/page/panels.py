"""The code that the page shows: each region a panel, each definition in it a piece of a few lines.

A docstring shows its first line, the rest is folded behind it. A definition with more than LONG
lines of code is folded behind its head, but for the steps, and so are constants and what is no
idea of the chapter.
"""

import ast
import re

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

import contact

LONG = 20  # lines of code
BOOKKEEPING = set(  # regions, and definitions of others, that are no idea of the chapter
    "setup scenes ball flight run measure flags report files main quality stability "
    "step_reach reach_of warm_start remember raised inverse make_balls".split()
)
OPEN = {row.step.__name__ for row in contact.MODELS.values() if row.step} | {
    "exact_run",
    "simulate",
}
# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


def code_lines(text):
    """Highlighted code, a piece of HTML a line."""
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    shown = re.sub(
        r'<span class="(\w+)">([^<]*)</span>', lambda m: m[0] if m[1] in STYLED else m[2], shown
    )
    return [f'<span class="ln">{line}\n</span>' for line in shown.rstrip("\n").split("\n")]


def pieces(region):
    """A region as [{html, head, lines, folded}], of its definitions and what stands between."""
    text, html = region.code.rstrip("\n").split("\n"), code_lines(region.code.rstrip("\n"))
    nodes = {  # line, from 0: the definition that begins there
        min([node.lineno, *(each.lineno for each in node.decorator_list)]) - 1: node
        for node in ast.parse(region.code).body
        if isinstance(node, (ast.FunctionDef, ast.ClassDef))
    }
    cuts = sorted({0, len(text), *nodes, *(node.end_lineno for node in nodes.values())})
    made = []
    for a, b in zip(cuts, cuts[1:]):
        if not "".join(text[a:b]).strip():
            continue
        new = piece(text[a:b], html[a:b], nodes.get(a), a, region.name)
        if made and made[-1]["folded"] and new["folded"]:  # behind one head
            last = made.pop()
            new |= {
                "html": last["html"] + "\n\n" + new["html"],
                "lines": last["lines"] + new["lines"],
            }
            new["head"] = f"{last['head']}, {new['head']}"
        made.append(new)
    return made


def piece(text, html, node, start, region):
    """One piece; its docstring, but for the first line, is folded."""
    said = 0  # lines of the docstring
    if node and ast.get_docstring(node):
        first, last = (line - 1 - start for line in (node.body[0].lineno, node.body[0].end_lineno))
        said = last - first + 1
    if said > 1:
        rest = "".join(html[first + 1 : last + 1])
        summary = f"<details><summary>{html[first]}</summary>{rest}</details>"
        html = [*html[:first], summary, *html[last + 1 :]]
    while not text[-1].strip():
        text, html = text[:-1], html[:-1]
    name = node.name if node else None
    return {
        "html": Markup("".join(html)),
        "head": name or " ".join(re.findall(r"^(\w+)[ :].*=", "\n".join(text), re.M)) or "imports",
        "lines": len(text),
        "folded": name not in OPEN
        and (len(text) - said > LONG or node is None or bool({name, region} & BOOKKEEPING)),
    }
