"""chapter.md to HTML.

Beside plain Markdown the chapter may hold
- an include, a fence with the one line [include-by-region: FILE#NAME]: becomes a code panel;
- references to numbers in double braces (curriculum/quoted.py): become the numbers of fresh runs;
- formulas between dollar signs: become MathML;
- slots, comments on a line of their own: <!-- figure: NAME -->, <!-- exercise: NAME -->,
  <!-- bench: NAME -->, <!-- stress: NAME -->, <!-- wallclock -->. Other comments vanish;
- links that set the live figure, [words](try:scene=drop&dt=0.03), and numbers that can be dragged,
  [0.002](drag:dt). Their names are those of contact.py's flags.
"""

import re
from html import escape, unescape
from pathlib import Path
from urllib.parse import parse_qsl

from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from mdit_py_plugins.dollarmath import dollarmath_plugin

import contact
from curriculum.check_prose_code_drift import CHAPTER, INCLUDE
from curriculum.page import maths_font

SLOT = re.compile(r"<!--\s*(figure|exercise|bench|stress|wallclock)(?:\s*:\s*([\w-]+))?\s*-->\s*")
SETTINGS = ("scene", "contact", "seed", "solref", "t")  # of a try link, beside the knobs


def slug(text):
    """A heading's id."""
    return re.sub(r"[^a-z0-9]+", "-", re.sub(r"<[^>]+>", "", text).lower()).strip("-") or "section"


def reserved_ids():
    """Ids that the templates use; a heading of the same name gets another."""
    texts = (
        path.read_text(encoding="utf-8")
        for path in (Path(__file__).parent / "templates").glob("*.j2")
    )
    return {name for text in texts for name in re.findall(r'\bid="([\w-]+)"', text)}


def parser():
    """markdown-it with tables and formulas; raw HTML other than comments is refused by `blocks`."""
    md = MarkdownIt("commonmark", {"html": True, "typographer": True}).enable(
        ["table", "smartquotes", "replacements"]
    )
    md.use(dollarmath_plugin, renderer=formula)
    md.add_render_rule("code_inline", inline_code)
    return md


def formula(text, options):
    """A formula as MathML. Raises ValueError where the page's font lacks one of its characters."""
    shown = convert(text, display="block" if options["display_mode"] else "inline")
    lacking = maths_font.missing(unescape(re.sub(r"<[^>]+>", "", shown)))
    if lacking:
        raise ValueError(
            f"{CHAPTER}: the formula {text!r} has {' '.join(lacking)}, which the page's font lacks; "
            "add it to CHARACTERS in curriculum/page/maths_font.py and run that file's command"
        )
    return shown


def inline_code(self, tokens, index, options, env):
    """Inline code; a model's name gets the model's look, and a short piece is kept on one line."""
    text = tokens[index].content
    kind = ' class="short"' if len(text) <= 24 else ""
    if text in contact.MODELS:
        kind = f' class="model m-{text}"'
    return f"<code{kind}>{escape(text)}</code>"


# ---- links that steer the live figure


def steer(tokens, knobs):
    """Give try links and draggable numbers their markup. Raises ValueError at an unknown name."""
    for token in tokens:
        opened = []
        line = token.map[0] + 1 if token.map else 1
        for k, child in enumerate(token.children or []):
            if child.type == "link_open":
                opened.append(child)
                scheme, _, rest = child.attrGet("href").partition(":")
                if scheme == "try":
                    follow(child, rest, knobs, line)
                elif scheme == "drag":
                    drag(child, token.children[k + 1].content, rest, knobs, line)
            elif child.type == "link_close":
                child.tag = opened.pop().tag


def follow(link, query, knobs, line):
    """A try link: an address of the page itself."""
    query = query.replace("&amp;", "&")
    given = parse_qsl(query, keep_blank_values=True)
    for name, value in given:
        if name in knobs:
            in_range(name, value, knobs, line)
        elif name not in SETTINGS:
            raise ValueError(
                f"{CHAPTER}:{line}: try:{query} sets {name!r}; allowed: "
                f"{', '.join((*SETTINGS, *knobs))}"
            )
    if not given:
        raise ValueError(
            f"{CHAPTER}:{line}: try:{query} sets nothing; write try:NAME=VALUE&NAME=VALUE"
        )
    link.attrs = {"class": "try", "href": f"?{query}"}


def drag(link, text, name, knobs, line):
    """A number that can be dragged."""
    if name not in knobs:
        raise ValueError(f"{CHAPTER}:{line}: drag:{name} is no knob; allowed: {', '.join(knobs)}")
    value = in_range(name, text, knobs, line)
    link.tag, link.attrs = (
        "span",
        {"class": "drag", "data-knob": name, "data-value": f"{value:.12g}"},
    )


def in_range(name, text, knobs, line):
    """The number in `text`, which knob `name` must be able to take."""
    low, high = knobs[name]
    try:
        value = float(text.replace(",", ""))
    except ValueError:
        value = None
    if value is None or not low <= value <= high:
        raise ValueError(
            f"{CHAPTER}:{line}: {name} cannot be {text!r}; allowed: {low:g} to {high:g}"
        )
    return value


# ---- blocks


def heading_name(inner, used):
    """An id for a heading that no other has."""
    name = base = slug(inner)
    count = 1
    while name in used:
        count += 1
        name = f"{base}-{count}"
    used.add(name)
    return name


def slots_of(token):
    """The slots in a block of HTML, which may hold comments and nothing else."""
    found, rest = [], token.content
    while slot := SLOT.match(rest):
        found.append(("slot", slot[1] + (f":{slot[2]}" if slot[2] else "")))
        rest = rest[slot.end() :]
    if re.sub(r"<!--.*?-->", "", rest, flags=re.DOTALL).strip():
        raise ValueError(
            f"{CHAPTER}:{token.map[0] + 1}: raw HTML, {rest.strip()[:50]!r}; "
            "allowed: Markdown, and comments that are slots"
        )
    return found


def end_of(tokens, index):
    """The index of the token that closes the block which tokens[index] opens."""
    depth = tokens[index].nesting
    while depth > 0:
        index += 1
        depth += tokens[index].nesting
    return index


def table(shown):
    """A table in a box that scrolls by itself where it is narrow."""
    held = shown.replace("<th></th>", "<td></td>")
    return f'<div class="scroll" tabindex="0" role="group" aria-label="Table">{held}</div>'


def part(token, render, used):
    """What a block of the chapter becomes: a list of (kind, value). `render()` gives its HTML."""
    if token.type == "fence":
        include = INCLUDE.fullmatch(token.content.strip())
        if include:
            return [("include", (include["file"], include["name"]))]
        code = escape(token.content)
        return [("html", f'<pre class="shell" tabindex="0"><code>{code}</code></pre>')]
    if token.type == "html_block":
        return slots_of(token)
    if token.type == "heading_open":
        inner = render(inner=True)
        return [("heading", (int(token.tag[1]), heading_name(inner, used), inner))]
    return [("html", table(render()) if token.type == "table_open" else render())]


def blocks(text, knobs=None):
    """The chapter as a list of (kind, value): kind html, heading (level, id, html), slot, or include
    (file, region). `knobs` are the ranges of what links may set, {name: (low, high)}."""
    md = parser()
    tokens, env = md.parse(text), {}
    steer(tokens, knobs or {})
    out, used, index = [], reserved_ids(), 0

    def html(first, last):
        shown = md.renderer.render(tokens[first : last + 1], md.options, env)
        return re.sub(r"<!--.*?-->", "", shown, flags=re.DOTALL)

    while index < len(tokens):
        first, last = index, end_of(tokens, index)

        def render(inner=False, first=first, last=last):
            return html(first + 1, first + 1) if inner else html(first, last)

        out += part(tokens[first], render, used)
        index = last + 1
    return out
