"""The code that the page shows: each region a panel, each definition in it a piece of a few lines.

A docstring shows its first line, the rest is folded behind it. A definition with more than LONG
lines of code is folded behind its head, and so are constants and what is no idea of the chapter.
"""

import ast
import re

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from curriculum.text import regions

LONG = 15  # lines of code
BOOKKEEPING = set(  # regions, and definitions of others, that are no idea of the chapter
    "setup scenes ball flight flags report files main quality stability "
    "warm_start remember raised make_balls state_of recorded".split()
)
OPEN = {"exact_run", "slide"}  # long, and the heart of their sections
# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "kd", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


def code_lines(text):
    """Highlighted code, (source, HTML) a line; a line too long for its column goes on below."""
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    shown = re.sub(
        r'<span class="(\w+)">([^<]*)</span>', lambda m: m[0] if m[1] in STYLED else m[2], shown
    )
    lines = []
    for line, source in zip(shown.rstrip("\n").split("\n"), text.rstrip("\n").split("\n")):
        indent = len(source) - len(source.lstrip(" "))
        lines.append((source, f'<span class="ln" style="--i:{indent}">{line}\n</span>'))
    return lines


def docstring_lines(node):
    """(first, last) line of a definition's docstring, counted from 0; (0, -1) without one."""
    first = node.body[0] if hasattr(node, "body") else None
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
        return first.lineno - 1, first.end_lineno - 1
    return 0, -1


def pieces(text, bookkeeping):
    """A region as pieces {head, lines, folded}, one for each definition and what stands between."""
    lines, found, at = code_lines(text), [], 0
    for node in ast.parse(text).body:
        if not isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            continue
        start = min([node.lineno, *(each.lineno for each in node.decorator_list)]) - 1
        if any(source.strip() for source, _ in lines[at:start]):
            found.append(piece(lines[at:start], bookkeeping))
        found.append(piece(lines[start : node.end_lineno], bookkeeping, node, start))
        at = node.end_lineno
    if any(source.strip() for source, _ in lines[at:]):
        found.append(piece(lines[at:], bookkeeping))
    return found


def piece(lines, bookkeeping, node=None, start=0):
    """One piece; its docstring, but for the first line, is folded."""
    first, last = (line - start for line in docstring_lines(node)) if node else (0, -1)
    html = [line for _, line in lines]
    if last > first:
        rest = "".join(html[first + 1 : last + 1])
        html[first : last + 1] = [f"<details><summary>{html[first]}</summary>{rest}</details>"]
    name = node.name if node else None
    while not lines[-1][0].strip():
        lines, html = lines[:-1], html[:-1]
    long = len(lines) - max(last - first + 1, 0) > LONG and name not in OPEN
    head = next(source for source, _ in lines if source.strip() and source[0] != "@")
    return {
        "html": Markup("".join(html)),
        "head": head,
        "lines": len(lines),
        "folded": bookkeeping or long or name is None or name in BOOKKEEPING,
    }


def panel(file, region):
    """A region as the template wants it."""
    return {
        "name": region.name,
        "file": file,
        "first": region.line,
        "last": region.line + region.code.count("\n") - 1,
        "sha256": region.sha,
        "pieces": pieces(region.code, region.name in BOOKKEEPING),
    }


def panels():
    """Every region of the literate files by (file, name)."""
    return {(each.file, name): panel(each.file, each) for name, each in regions.read_all().items()}
