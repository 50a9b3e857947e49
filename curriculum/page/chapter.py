"""chapter.md as HTML: its slots filled, and its answers veiled.

What the chapter holds beside plain Markdown, curriculum/gate/chapter.py says. A passage goes from a
heading or a `show` to the next. Its quantities are those that its mark sets, and else contact.py's
own; what the reader changes in one stays there.

Nothing on the page tells the answer of a bet before the reader has bet or has asked to be shown. A
segment, from a heading or an exercise to the next, is put into a veil where it follows the bet at
once, or says so by <!-- tells: ex1 -->. A run of such segments is behind one bar; the first heading
of the run is seen.
"""

import itertools
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
from curriculum.gate.chapter import CHAPTER, read
from curriculum.page import fonts

UNIT = re.compile(r"(\d|^) (?=(?:r|s|m|mm|kg|J|N|N/m|m/s)\b)")  # the blank between number and unit
SETTINGS = {  # beside the quantities: what each may be
    "scene": "drop|bounce|stack",
    "models": "({0})(,({0}))*".format("|".join(contact.MODELS)),
    "from": r"[\d.]+",
    "to": r"[\d.]+",
}
HIDES = {"ex1": "How they land", "ex3": "What happens then"}


# ---- Markdown


def formula(text, options):
    """A formula as MathML. Raises ValueError where the page's font lacks one of its characters."""
    shown = convert(text, display="block" if options["display_mode"] else "inline")
    lacking = fonts.lacking(Markup(shown).striptags())
    if lacking:
        raise ValueError(
            f"{CHAPTER}: the formula {text!r} has {' '.join(lacking)}, which the page's font "
            "lacks; see curriculum/page/fonts.py"
        )
    return shown


def text(self, tokens, index, options, env):
    """Plain words; no line ends between a number and its unit."""
    return UNIT.sub("\\1\u00a0", escape(tokens[index].content))


def code_inline(self, tokens, index, options, env):
    """Inline code; a model's name gets the model's look, and a short piece is kept on one line."""
    text = tokens[index].content
    kind = f"model m-{text}" if text in contact.MODELS else "short" if len(text) <= 24 else ""
    return f'<code class="{kind}">{escape(text)}</code>'


def link_open(self, tokens, index, options, env):
    """A link; one that sets something in the page says what."""
    token = tokens[index]
    scheme, _, rest = token.attrGet("href").partition(":")
    if scheme == "try":
        asked(rest, env)
        token.attrs = {"class": "try", "href": f"?{rest}"}
    elif scheme == "drag":
        held = tokens[index + 1].content
        if asked(f"{rest}={held}", env, others={})[rest] != env["home"].get(rest):
            raise ValueError(
                f"{CHAPTER}:{env['line']}: {held} is to be dragged, and here {rest} is "
                f"{env['home'].get(rest)}; set it before: <!-- show: none&{rest}={held} -->"
            )
        token.attrs = {"class": "drag", "data-knob": rest}
    return self.renderToken(tokens, index, options, env)


def asked(query, env, others=SETTINGS):
    """What a query sets, {name: value}. Raises ValueError at the first that cannot be set."""
    values, ranges = {}, env["ranges"]
    for name, value in parse_qsl(query, keep_blank_values=True) or [(query, "")]:
        low, high = ranges.get(name, (1.0, 0.0))
        number = re.fullmatch(r"[\d.]+(e[+-]?\d+)?", value.replace(",", ""))
        if number and low <= float(number[0]) <= high:
            values[name] = float(number[0])
        elif re.fullmatch(others.get(name, r"\b\B"), value):
            values[name] = value
        else:
            known = others.get(name, f"the names {', '.join((*others, *ranges))}")
            allowed = f"{low:g} to {high:g}" if name in ranges else known
            what = f"{name}={value} sets nothing; allowed: {allowed}"
            raise ValueError(f"{CHAPTER}:{env['line']}: {what}")
    return values


def slug(title):
    """The id of a heading."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def parser():
    """markdown-it with tables and formulas."""
    md = MarkdownIt("commonmark", {"html": False, "typographer": True})
    md.enable(["table", "smartquotes", "replacements"])
    md.use(dollarmath_plugin, renderer=formula).use(anchors_plugin, max_level=4, slug_func=slug)
    for rule in (text, code_inline, link_open):
        md.add_render_rule(rule.__name__, rule)
    return md


def markdown(text):
    """A short text of ours (objective, reason) as HTML."""
    return Markup(parser().render(text))


def inline(text):
    """The same without a paragraph around it."""
    return Markup(parser().renderInline(" ".join(text.split())))


# ---- the parts of the chapter


def blocks(text, ranges, starts):
    """The chapter as a list of (kind, values): what the macros of that name are given, and
    ("figure", (name, which of this name, what its passage sets)). `ranges` are those of what the
    text may set, {name: (low, high)}; `starts` all values of a section, by the scene it shows."""
    md, env, out, seen = parser(), {"ranges": ranges}, [], Counter()
    md.parse(text, env)  # for the addresses of links, which stand at its end
    changes, place, marks = {}, "", 0
    for kind, name, line, written in read(text):
        env |= {"home": starts[changes.get("scene", "drop")] | changes, "line": line}
        if kind in ("text", "heading"):
            shown = rendered(md, written, env)
            out += shown
            if kind == "heading":
                changes, place, marks = {}, shown[0][1][1], 1
        elif kind == "code":
            code = f'<pre class="shell" tabindex="0"><code>{escape(name)}</code></pre>'
            out.append(("html", (Markup(code),)))
        elif kind == "region":
            out.append((kind, (name.partition("#")[2],)))
        elif kind == "figure":
            seen[name] += 1
            out.append((kind, (name, f"-{seen[name]}" * (seen[name] > 1), changes)))
        elif kind == "show":
            changes = {} if name == "none" else asked(name.removeprefix("none&"), env)
            marks += 1
            out.append((kind, (f"{place}.{marks}", name)))
        elif kind == "tells":
            out.append((kind, name.split(",")))
        elif kind != "comment":
            out.append((kind, (name,) if name else ()))
    return out


def rendered(md, text, env):
    """Markdown as a list of ("html", (text,)) and ("heading", (level, id, text))."""
    out, first = [], env["line"]
    for node in SyntaxTreeNode(md.parse(text, env)).children:
        env["line"] = first + node.map[0]
        shown = md.renderer.render(node.to_tokens(), md.options, env)
        if node.type == "heading":
            inner = re.sub(r"^<h\d[^>]*>|</h\d>\s*$", "", shown)
            out.append(("heading", (int(node.tag[1]), node.attrs["id"], Markup(inner))))
        elif node.type == "table":
            held = shown.replace("<th></th>", "<td></td>")
            around = '<div class="scroll" tabindex="0" role="group" aria-label="Table">'
            out.append(("html", (Markup(f"{around}{held}</div>"),)))
        else:
            out.append(("html", (Markup(shown),)))
    return out


# ---- the whole


def assemble(parts, macros, bets):
    """(HTML, [(level, id, text)] of its headings). The macro of a part's kind gives its HTML;
    `bets` are the exercises whose answers are veiled."""
    contents, pieces = [], []
    cuts = [k for k, (kind, _) in enumerate(parts) if k and kind in ("heading", "exercise")]
    segments = [parts[a:b] for a, b in zip([0, *cuts], [*cuts, len(parts)])]
    for ((kind, values), *rest), columns in zip(segments, columns_of(segments)):
        if kind == "heading":
            *where, title = values
            contents.append((*where, Markup(re.sub(r"</?(code|a|math)[^>]*>", "", title))))
        head = getattr(macros, kind)(*values)
        told = {name for kind, names in rest if kind == "tells" for name in names}
        rest = [part for part in rest if part[0] != "tells"]
        inner = [getattr(macros, kind)(*values) for kind, values in rest]
        for at, part in enumerate(rest, 1):
            if part[0] == "puzzle":  # what follows it is its answer
                inner[at:] = [macros.veil("puzzle"), *inner[at:], "</div></div>"]
        last = values[0] if kind == "exercise" else None
        veils = [bet for bet in bets if bet in told or bet == last and rest]
        head, inner = (
            f'<div class="part {column}">{each}</div>'
            for column, each in zip(columns, (head, "\n".join(inner)))
        )
        if last or values[0] <= 2:  # exercises, and what begins a part, are always seen
            pieces.append((head, "", ()))
            head = ""
        pieces.append((head, inner, veils))
    return Markup("\n".join(veiled(pieces, bets, macros))), contents


def columns_of(segments):
    """Of each segment whether the live figure stands beside its head, and beside the rest."""
    columns, shown = [], False
    for (first, _), *rest in segments:
        marks = [not values[1].startswith("none") for kind, values in rest if kind == "show"]
        heading = first == "heading"
        beside = (shown and not heading) or any(marks)
        columns.append([beside if heading else shown, beside] if rest or not heading else None)
        shown = marks[-1] if marks else beside
    for k in reversed(range(len(columns))):  # a heading alone stands where the next one does
        columns[k] = columns[k] or columns[k + 1]
    return [["beside" if each else "centred" for each in both] for both in columns]


def veiled(segments, bets, macros):
    """The HTML of segments [(head, inner, veils)]: a run of them behind one veil has one bar."""
    if not bets:
        return [each for head, inner, _ in segments for each in (head, inner)]
    out, (bet, *others) = [], bets
    for behind, run in itertools.groupby(segments, key=lambda each: bet in each[2]):
        (head, inner, veils), *rest = run
        if behind:
            out += [head, macros.veil(bet)]
            head = ""
        out += veiled([(head, inner, veils), *rest], others, macros)
        out += ["</div></div>"] if behind else []
    return out
