"""chapter.md as HTML, its slots filled.

What the chapter holds beside plain Markdown, curriculum/prose/chapter.py says.
"""

import re
from collections import Counter
from html import escape
from urllib.parse import parse_qsl

from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from markdown_it.tree import SyntaxTreeNode
from markupsafe import Markup
from mdit_py_plugins.anchors import anchors_plugin
from mdit_py_plugins.dollarmath import dollarmath_plugin

import contact
from curriculum.prose.chapter import read

FOLDED = ("references", "the-rest-of-the-file", "colophon")  # sections, on a phone
# the blanks within a number and between it and its unit
UNIT = re.compile(
    r"(?:(?<=[\d⁰¹²³⁴-⁹])|^) (?=(?:r|s|m|mm|kg|J|N|N/m|m/s)\b)|(?<=\bN) (?=s\b)| (?=×)|(?<=×) "
)


# ---- Markdown


def formula(text, options):
    """A formula as MathML."""
    return convert(text, display="block" if options["display_mode"] else "inline")


def text(self, tokens, index, options, env):
    """Plain words; no line ends between a number and its unit, and v_n is a formula, and a_n."""
    words = UNIT.sub("\u00a0", escape(tokens[index].content))
    return re.sub(r"\b([av])_n\b", r"<i>\1<sub>n</sub></i>", words)


def code_inline(self, tokens, index, options, env):
    """Inline code; a model's name gets the model's look, and a short piece is kept on one line."""
    text = tokens[index].content
    kind = f"model m-{text}" if text in contact.MODELS else "short" if len(text) <= 24 else ""
    return f'<code class="{kind}">{escape(text)}</code>'


def asked(slot):
    """(name, {quantity: value}) of NAME?quantity=value&..., as in a slot."""
    name, _, query = slot.partition("?")
    number = re.compile(r"-?[\d.]+(e[+-]?\d+)?")
    values = parse_qsl(query, keep_blank_values=True)
    return name, {k: float(v) if number.fullmatch(v) else v for k, v in values}


def slug(title):
    """The id of a heading."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def parser():
    """markdown-it with tables and formulas."""
    md = MarkdownIt("commonmark", {"html": False, "typographer": True})
    md.enable(["table", "smartquotes", "replacements"])
    md.use(dollarmath_plugin, renderer=formula).use(anchors_plugin, max_level=4, slug_func=slug)
    for rule in (text, code_inline):
        md.add_render_rule(rule.__name__, rule)
    return md


def markdown(text):
    """A short text of ours (objective, reason) as HTML."""
    return Markup(parser().render(text))


def inline(text):
    """The same without a paragraph around it."""
    return Markup(parser().renderInline(" ".join(text.split())))


# ---- the parts of the chapter


def blocks(text):
    """The chapter as a list of (kind, values), what the macros of that name are given. A figure's
    values are its id and what asked() gives of its slot."""
    md, env, out, seen = parser(), {}, [], Counter()
    md.parse(text, env)  # for the addresses of links, which stand at its end
    for kind, name, _, written, _ in read(text):
        if kind in ("text", "heading"):
            out += rendered(md, written, env)
        elif kind == "code":
            code = f'<pre class="shell"><code>{escape(name)}</code></pre>'
            out.append(("html", (Markup(code),)))
        elif kind == "region":
            out.append((kind, (name.partition("#")[2],)))
        elif kind == "figure":
            figure, given = asked(name)
            seen[figure] += 1
            out.append((kind, (f"{figure}-{seen[figure]}".removesuffix("-1"), figure, given)))
        elif kind in ("exercise", "bench", "stress", "wallclock", "puzzle"):
            out.append((kind, (name,) if name else ()))
    return out


def rendered(md, text, env):
    """Markdown as a list of ("html", (text,)) and ("heading", (level, id, text))."""
    out = []
    for node in SyntaxTreeNode(md.parse(text, env)).children:
        for number, item in enumerate(node.children if node.type == "ordered_list" else (), 1):
            item.attrs["id"] = f"{env.get('under')}-{number}"
        shown = md.renderer.render(node.to_tokens(), md.options, env)
        if node.type == "heading":
            inner = re.sub(r"^<h\d[^>]*>|</h\d>\s*$", "", shown)
            env["under"] = node.attrs["id"]
            out.append(("heading", (int(node.tag[1]), env["under"], Markup(inner))))
        elif node.type == "table":
            held = shown.replace("<th></th>", "<td></td>")
            out.append(("html", (Markup(f'<div class="scroll">{held}</div>'),)))
        else:
            shown = re.sub(r'(?<="#references)">\[(\d+)\]', r'-\1">[\1]', shown)
            out.append(("html", (Markup(shown),)))
    return out


# ---- the whole


def assemble(parts, macros, titles):
    """(HTML, [(level, id, text)] of its headings, and of its figures, which have these titles).

    The macro of a part's kind gives its HTML.
    """
    contents = []
    for kind, values in parts:
        if kind == "heading":
            plain = re.sub(r"</?(code|a|math)[^>]*>", "", values[2])
            contents.append((*values[:2], Markup(plain)))
        elif kind == "figure":
            contents.append((3, f"fig-{values[0]}", f"Figure: {titles[values[0]]}"))
    html, until = [], ()  # until: the kinds at which what is folded ends
    for kind, values in [*parts, ("heading", (0, "", ""))]:
        if kind in until:
            html.append("</details>")
            until = ()
        if kind == "puzzle" or (kind == "heading" and values[1] in FOLDED):
            until = ("heading", "exercise") if kind == "puzzle" else ("heading",)
        html.append(getattr(macros, kind)(*values))
    return Markup("\n".join(html)), contents
