"""chapter.md as HTML: its slots filled, and its answers veiled.

Beside plain Markdown the chapter may hold
- an include, a fence with the one line [include-by-region: FILE#NAME]: becomes a code panel;
- references to numbers in double braces, filled before (curriculum/text/references.py);
- formulas between dollar signs: become MathML;
- slots, comments on a line of their own: <!-- figure: NAME -->, <!-- exercise: NAME -->,
  <!-- bench: NAME -->, <!-- stress: NAME -->, <!-- wallclock -->. Other comments vanish;
- <!-- show: scene=drop&models=penalty,lcp&from=0.3&to=1.2 -->: what the live figure shows
  from there on, by the store's quantities and `models`, `chart` (gap, push, energy), `from`, `to`;
  <!-- show: none --> lets it step back, and may set quantities, too: <!-- show: none&dt=0.014 -->.
  A passage goes from a heading or such a mark to the next. Its quantities are those that its mark
  sets, and else contact.py's own; what the reader changes in one stays there;
- links that set the same, [words](try:scene=drop&dt=0.03), and numbers to drag, [0.002](drag:dt).

Nothing on the page tells the answer of a bet before the reader has bet or has asked to be shown. A
segment, from a heading or an exercise to the next, that tells the answer of a bet above is put into
a veil, and a run of such segments behind one bar; the first heading of the run is seen. What tells
an answer is found by its words, in text, code and figures.
"""

import itertools
import re
from html import escape, unescape
from urllib.parse import parse_qsl

from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from markdown_it.tree import SyntaxTreeNode
from markupsafe import Markup
from mdit_py_plugins.anchors import anchors_plugin
from mdit_py_plugins.dollarmath import dollarmath_plugin

import contact
from curriculum.page import fonts
from curriculum.text.references import INCLUDE

CHAPTER = "curriculum/prose/chapter.md"
SLOT = re.compile(r"<!--\s*(figure|exercise|bench|stress|wallclock|show)(?:\s*:\s*(\S+))?\s*-->")
UNIT = re.compile(r"(\d|^) (?=(?:r|s|m|mm|kg|J|N|N/m|m/s)\b)")  # the blank between number and unit
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
SETTINGS = {  # beside the quantities: what each may be
    "scene": "drop|bounce|stack",
    "models": "({0})(,({0}))*".format("|".join(contact.MODELS)),
    "chart": "gap|push|energy",
    "from": r"[\d.]+",
    "to": r"[\d.]+",
}
# what would tell the answer of a bet, in the words of the text, the code and the figures
TELLS = {
    "ex1": re.compile(
        r"\bsinks\b|\bdives\b|m g ?/ ?k|inside the table|gap at rest|at rest / r|rest depth",
        re.IGNORECASE,
    ),
    "ex3": re.compile(
        r"\bexplodes\b|blows up|stays? bounded|\bgains .{0,40}times (its|the) energy"
        r"|the largest step",
        re.IGNORECASE,
    ),
    "ex4": re.compile(
        r"mass cancels|no mass in|\(1 . d\) \\?,? ?g\b|equally deep|per unit of mass",
        re.IGNORECASE,
    ),
}
HIDES = {"ex1": "How they land", "ex3": "What happens then", "ex4": "Where it rests"}
END = "what-you-built-and-what-comes-next"  # from here on answers are named, and none is told


# ---- Markdown


def formula(text, options):
    """A formula as MathML. Raises ValueError where the page's font lacks one of its characters."""
    shown = convert(text, display="block" if options["display_mode"] else "inline")
    lacking = fonts.lacking(unescape(re.sub(r"<[^>]+>", "", shown)))
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
        check(asked(rest), env["line"], env["ranges"])
        token.attrs = {"class": "try", "href": f"?{rest}"}
    elif scheme == "drag":
        held = tokens[index + 1].content
        check([(rest, held)], env["line"], env["ranges"], others={})
        if float(held.replace(",", "")) != env["home"].get(rest, float("nan")):
            raise ValueError(
                f"{CHAPTER}:{env['line']}: {held} is to be dragged, and here {rest} is "
                f"{env['home'].get(rest)}; set it before: <!-- show: none&{rest}={held} -->"
            )
        token.attrs = {"class": "drag", "data-knob": rest}
    return self.renderToken(tokens, index, options, env)


def asked(query):
    """The (name, value) pairs of a query, also those without a value; at least one."""
    return parse_qsl(query, keep_blank_values=True) or [(query, "")]


def check(pairs, line, ranges, others=SETTINGS):
    """Raise ValueError at the first (name, value) that cannot be set."""
    for name, value in pairs:
        low, high = ranges.get(name, (1.0, 0.0))
        number = re.fullmatch(r"[\d.]+(e[+-]?\d+)?", value.replace(",", ""))
        fits = number and low <= float(number[0]) <= high
        if not fits and not re.fullmatch(others.get(name, r"\b\B"), value):
            known = others.get(name, f"the names {', '.join((*others, *ranges))}")
            allowed = f"{low:g} to {high:g}" if name in ranges else known
            raise ValueError(f"{CHAPTER}:{line}: {name}={value} sets nothing; allowed: {allowed}")


def slug(title):
    """The id of a heading."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def parser():
    """markdown-it with tables and formulas."""
    md = MarkdownIt("commonmark", {"html": True, "typographer": True})
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


def blocks(text, ranges, starts=None):
    """The chapter as a list of (kind, value): html, heading (level, id, html), show, slot, or
    include (region). `ranges` are those of what the text may set, {name: (low, high)}; `starts`
    all values of a section, by the scene that it shows."""
    md, out, starts = parser(), [], starts or {"drop": {}}
    home = starts["drop"]
    for node in SyntaxTreeNode(md.parse(text)).children:
        env = {"line": node.map[0] + 1, "ranges": ranges, "home": home}
        shown = COMMENT.sub("", md.renderer.render(node.to_tokens(), md.options, env))
        include = node.type == "fence" and INCLUDE.fullmatch(node.content.strip())
        if include:
            out.append(("include", include["name"]))
        elif node.type == "fence":
            code = escape(node.content)
            out.append(("html", f'<pre class="shell" tabindex="0"><code>{code}</code></pre>'))
        elif node.type == "heading":
            home = starts["drop"]
            inner = re.sub(r"^<h\d[^>]*>|</h\d>\s*$", "", shown)
            out.append(("heading", (int(node.tag[1]), node.attrs["id"], inner)))
        elif node.type == "table":
            held = shown.replace("<th></th>", "<td></td>")
            around = '<div class="scroll" tabindex="0" role="group" aria-label="Table">'
            out.append(("html", f"{around}{held}</div>"))
        elif node.type == "html_block":
            for part in slots(node.content, env["line"], ranges):
                home = home_of(part[1], starts) if part[0] == "show" else home
                out.append(part)
        else:
            out.append(("html", shown))
    return out


def changes_of(show):
    """What a mark of what the text shows sets, {name: value}."""
    pairs = parse_qsl(show)
    return {name: float(v) if re.fullmatch(r"[\d.e+-]+", v) else v for name, v in pairs}


def home_of(show, starts):
    """The values of a passage that shows this."""
    changes = changes_of(show)
    return starts[changes.get("scene", "drop")] | changes


def slots(text, line, ranges):
    """The slots in a block of comments, as parts. Raises ValueError at other HTML."""
    if COMMENT.sub("", text).strip():
        raise ValueError(
            f"{CHAPTER}:{line}: raw HTML, {text.strip()[:50]!r}; allowed: Markdown, and slots"
        )
    for kind, name in SLOT.findall(text):
        if kind == "show":
            check([pair for pair in asked(name) if pair[0] != "none"], line, ranges)
            yield "show", name
        else:
            yield "slot", f"{kind}:{name}" if name else kind


# ---- the whole


def assemble(parts, fill, macros, bets):
    """(HTML, [(level, id, text)] of its headings). fill(kind, value) gives the HTML of a part;
    `bets` are the exercises whose answers are veiled."""
    contents, met, found, kinds = [], [], [], kinds_of(parts)
    for ((kind, value), *rest), columns in zip(segments_of(parts), kinds):
        if kind == "heading":
            contents.append((*value[:2], Markup(re.sub(r"</?(code|a|math)[^>]*>", "", value[2]))))
        head = fill(kind, value)
        inner = [fill(*part) for part in rest]
        if ("slot", "figure:puzzle") in rest:  # what follows it is its answer
            at = rest.index(("slot", "figure:puzzle")) + 1
            inner[at:] = [macros.veil("puzzle"), *inner[at:], "</div></div>"]
        last = value.removeprefix("exercise:") if kind == "slot" else None
        met += [last] if last in bets else []
        met = [] if kind == "heading" and value[1] == END else met
        said = words(" ".join(inner))
        veils = [name for name in met if said and (name == last or TELLS[name].search(said))]
        head, inner = (
            f'<div class="part {column}">{each}</div>'
            for column, each in zip(columns, (head, "\n".join(inner)))
        )
        if kind == "slot" or value[0] <= 2:  # exercises, and what begins a part, are always seen
            found.append((head, "", ()))
            head = ""
        found.append((head, inner, veils))
    return Markup("\n".join(veiled(found, bets, macros))), contents


def segments_of(parts):
    """The parts from each heading or exercise to the next."""
    found = []
    for kind, value in parts:
        if kind == "heading" or value.startswith("exercise:"):
            found.append([])
        found[-1].append((kind, value))
    return found


def kinds_of(parts):
    """Of each segment whether the live figure stands beside its head, and beside the rest."""
    found, shown = [], False
    for segment in segments_of(parts):
        marks = [not value.startswith("none") for kind, value in segment if kind == "show"]
        heading = segment[0][0] == "heading"
        rest = (shown and not heading) or any(marks)
        found.append([rest if heading else shown, rest] if segment[1:] or not heading else None)
        shown = marks[-1] if marks else rest
    for k in reversed(range(len(found))):  # a heading alone stands where the next one does
        found[k] = found[k] or found[k + 1]
    return [["beside" if each else "centred" for each in both] for both in found]


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


def words(html):
    """What HTML says, in words: text, and the names of pictures."""
    named = re.sub(r'<[^>]*\b(?:alt|aria-label)="([^"]*)"[^>]*>', r" \1 ", html)
    return " ".join(re.sub(r"<[^>]+>", "", named).split())
