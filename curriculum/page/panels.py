"""The code that the page shows: of a docstring the first line, with the rest folded behind it.

Regions that are no idea of the chapter stand there folded as a whole.
"""

import ast
import re

from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

IDEAS = set(
    "contacts penalty sweep lcp-target lcp accelerated leapfrog-core exact-toi exact "
    "implicit-spring".split()
)
# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


def highlighted(text):
    """Code as lines of HTML."""
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    plain = re.compile(r'<span class="(\w+)">([^<]*)</span>')
    return plain.sub(lambda m: m[0] if m[1] in STYLED else m[2], shown).rstrip("\n").split("\n")


def panel(region):
    """A region's code as HTML. A folded docstring is a block, so that no line ends behind it."""
    lines = [f"{line}\n" for line in highlighted(region.code.rstrip("\n"))]
    for node in ast.walk(ast.parse(region.code)):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
            first, last = node.body[0].lineno - 1, node.body[0].end_lineno
            if last - first > 4:
                head, rest = lines[first].rstrip("\n"), "".join(lines[first + 1 : last])
                block = f"<details><summary>{head}</summary>{rest}</details>"
                lines[first:last] = [block, *[""] * (last - first - 1)]
    return Markup("".join(lines))
