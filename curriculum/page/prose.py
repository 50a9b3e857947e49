"""chapter.md to parts of HTML.

Beside plain Markdown the chapter may hold
- an include, a fence with the one line [include-by-region: FILE#NAME]: becomes a code panel;
- references to numbers in double braces, filled before (curriculum/text/references.py);
- formulas between dollar signs: become MathML;
- slots, comments on a line of their own: <!-- figure: NAME -->, <!-- exercise: NAME -->,
  <!-- bench: NAME -->, <!-- stress: NAME -->, <!-- wallclock -->. Other comments vanish;
- <!-- show: scene=drop&models=penalty,lcp&from=0.3&to=1.2 -->: what the live figure shows
  from there on, by the store's quantities and `models`, `chart` (gap, push, energy), `from`, `to`;
  <!-- show: none --> lets it step back;
- links that set the same, [words](try:scene=drop&dt=0.03), and numbers to drag, [0.002](drag:dt).
"""

import re
from html import escape, unescape
from urllib.parse import parse_qsl

from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from markupsafe import Markup
from mdit_py_plugins.dollarmath import dollarmath_plugin

import contact
from curriculum.page import maths_font
from curriculum.text.references import INCLUDE

CHAPTER = "curriculum/prose/chapter.md"
SLOT = re.compile(r"<!--\s*(figure|exercise|bench|stress|wallclock|show)(?:\s*:\s*(\S+))?\s*-->\s*")
EVERY = ",".join(contact.MODELS)
SETTINGS = {  # beside the knobs: what each may be
    "scene": "drop|bounce|stack",
    "models": "({0})(,({0}))*".format("|".join(contact.MODELS)),
    "chart": "gap|push|energy",
    "from": r"[\d.]+",
    "to": r"[\d.]+",
}


def formula(text, options):
    """A formula as MathML. Raises ValueError where the page's font lacks one of its characters."""
    shown = convert(text, display="block" if options["display_mode"] else "inline")
    lacking = maths_font.missing(unescape(re.sub(r"<[^>]+>", "", shown)))
    if lacking:
        raise ValueError(
            f"{CHAPTER}: the formula {text!r} has {' '.join(lacking)}, which the page's font "
            "lacks; see curriculum/page/maths_font.py"
        )
    return shown


def inline_code(self, tokens, index, options, env):
    """Inline code; a model's name gets the model's look, and a short piece is kept on one line."""
    text = tokens[index].content
    kind = f"model m-{text}" if text in contact.MODELS else "short" if len(text) <= 24 else ""
    return f'<code class="{kind}">{escape(text)}</code>' if kind else f"<code>{escape(text)}</code>"


def parser():
    """markdown-it with tables and formulas."""
    md = MarkdownIt("commonmark", {"html": True, "typographer": True})
    md.enable(["table", "smartquotes", "replacements"])
    md.use(dollarmath_plugin, renderer=formula)
    md.add_render_rule("code_inline", inline_code)
    return md


def markdown(text):
    """A short text of ours (objective, reason) as HTML."""
    return Markup(parser().render(text))


def inline(text):
    """The same without a paragraph around it."""
    return Markup(parser().renderInline(" ".join(text.split())))


# ---- what the text sets


def checked(query, ranges, line):
    """The query of a `try:` link or a `show:` comment. Raises ValueError at what can't be set."""
    query = re.sub(
        r"\bcontact=(\w+)", lambda m: f"models={EVERY if m[1] == 'all' else m[1]}", query
    )
    query = re.sub(r"solref=([^,&]+),([^&]+)", r"timeconst=\1&dampratio=\2", query)
    given = parse_qsl(query.replace("&amp;", "&"), keep_blank_values=True)
    for name, value in given:
        if name in ranges:
            in_range(name, value, ranges, line)
        elif not re.fullmatch(SETTINGS.get(name, "nothing"), value):
            allowed = SETTINGS.get(name, f"the names {', '.join((*SETTINGS, *ranges))}")
            raise ValueError(f"{CHAPTER}:{line}: {name}={value} sets nothing; allowed: {allowed}")
    if not given:
        raise ValueError(f"{CHAPTER}:{line}: {query!r} sets nothing; write NAME=VALUE&NAME=VALUE")
    return "&".join(f"{name}={value}" for name, value in given)


def in_range(name, text, ranges, line):
    """The number in `text`, which quantity `name` must be able to take."""
    if name not in ranges:
        raise ValueError(f"{CHAPTER}:{line}: {name} is no quantity; allowed: {', '.join(ranges)}")
    low, high = ranges[name]
    if text == "?":  # of a draft, whose number is not known
        return low
    number = re.fullmatch(r"[\d.]+(e[+-]?\d+)?", text.replace(",", ""))
    if not number or not low <= float(number[0]) <= high:
        allowed = f"{low:g} to {high:g}"
        raise ValueError(f"{CHAPTER}:{line}: {name} cannot be {text!r}; allowed: {allowed}")
    return float(number[0])


def steer(token, ranges):
    """Give the try links and the numbers to drag in a block their markup."""
    line, opened = token.map[0] + 1 if token.map else 1, []
    for k, child in enumerate(token.children or []):
        if child.type == "link_close":
            child.tag = opened.pop().tag
        if child.type != "link_open":
            continue
        opened.append(child)
        scheme, _, rest = child.attrGet("href").partition(":")
        if scheme == "try":
            child.attrs = {"class": "try", "href": f"?{checked(rest, ranges, line)}"}
        elif scheme == "drag":
            value = in_range(rest, token.children[k + 1].content, ranges, line)
            child.tag = "span"
            child.attrs = {"class": "drag", "data-knob": rest, "data-value": f"{value:.12g}"}


# ---- blocks


def heading_name(inner, used):
    """An id for a heading that no other has."""
    base = re.sub(r"[^a-z0-9]+", "-", re.sub(r"<[^>]+>", "", inner).lower()).strip("-") or "section"
    name, count = base, 1
    while name in used:
        count += 1
        name = f"{base}-{count}"
    used.add(name)
    return name


def slots_of(token, ranges):
    """The slots in a block of HTML, which may hold comments and nothing else."""
    found, rest, line = [], token.content, token.map[0] + 1
    while slot := SLOT.match(rest):
        kind, name = slot.groups()
        if kind == "show":
            found.append(("show", name if name == "none" else checked(name or "", ranges, line)))
        else:
            found.append(("slot", f"{kind}:{name}" if name else kind))
        rest = rest[slot.end() :]
    if re.sub(r"<!--.*?-->", "", rest, flags=re.DOTALL).strip():
        raise ValueError(
            f"{CHAPTER}:{line}: raw HTML, {rest.strip()[:50]!r}; allowed: Markdown, and slots"
        )
    return found


def end_of(tokens, index):
    """The index of the token that closes the block which tokens[index] opens."""
    depth = tokens[index].nesting
    while depth > 0:
        index += 1
        depth += tokens[index].nesting
    return index


def blocks(text, ranges):
    """The chapter as a list of (kind, value): html, heading (level, id, html), slot, show, or
    include (file, region). `ranges` are those of what the text may set, {name: (low, high)}."""
    md = parser()
    tokens, env = md.parse(text), {}
    out, used, index = [], {"text", "figure", "contents", "colophon", "objectives"}, 0
    while index < len(tokens):
        first, last = tokens[index], end_of(tokens, index)
        for token in tokens[index : last + 1]:
            steer(token, ranges)
        shown = md.renderer.render(tokens[index : last + 1], md.options, env)
        out += part(first, re.sub(r"<!--.*?-->", "", shown, flags=re.DOTALL), used, ranges)
        index = last + 1
    return out


def part(token, shown, used, ranges):
    """What a block of the chapter becomes: a list of (kind, value)."""
    if token.type == "fence":
        include = INCLUDE.fullmatch(token.content.strip())
        if include:
            return [("include", (include["file"], include["name"]))]
        return [
            ("html", f'<pre class="shell" tabindex="0"><code>{escape(token.content)}</code></pre>')
        ]
    if token.type == "html_block":
        return slots_of(token, ranges)
    if token.type == "heading_open":
        inner = re.sub(r"^<h\d>|</h\d>\s*$", "", shown)
        return [("heading", (int(token.tag[1]), heading_name(inner, used), inner))]
    if token.type == "table_open":
        held = shown.replace("<th></th>", "<td></td>")
        return [
            (
                "html",
                f'<div class="scroll" tabindex="0" role="group" aria-label="Table">{held}</div>',
            )
        ]
    return [("html", shown)]
