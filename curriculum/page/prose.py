"""chapter.md to HTML.

Beside plain Markdown the chapter may hold
- an include, a fence with the one line [include-by-region: contact.py#NAME]: becomes a code panel;
- references to numbers in double braces (curriculum/quoted.py): become the numbers of fresh runs;
- formulas between dollar signs: become MathML;
- slots, comments on a line of their own: <!-- figure: NAME -->, <!-- exercise: NAME -->,
  <!-- bench: NAME -->, <!-- stress: NAME -->, <!-- wallclock -->. A slot that the chapter does not
  place goes where DEFAULTS says. Other comments vanish.
"""

import re
from html import escape
from pathlib import Path

from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from mdit_py_plugins.dollarmath import dollarmath_plugin

import contact
from curriculum.check_prose_code_drift import INCLUDE

SLOT = re.compile(r"<!--\s*(figure|exercise|bench|stress|wallclock)(?:\s*:\s*([\w-]+))?\s*-->\s*")
# where a slot goes that the chapter does not place: before the panel of a region, or at a section's end
BEFORE_REGION = {
    "figure:sink": "penalty",
    "figure:sweeps": "lcp",
    "figure:bounces": "exact",
    "figure:complementarity": "contacts",
}
AT_END_OF = {
    "figure:cliff": "break it",
    "figure:puzzle": "break it",
    "exercise:ex1": "practice",
    "exercise:ex2": "practice",
    "exercise:ex3": "practice",
    "bench:bounce": "the measurement",
    "wallclock": "the measurement",
}


def slug(text):
    """A heading's id."""
    return re.sub(r"[^a-z0-9]+", "-", re.sub(r"<[^>]+>", "", text).lower()).strip("-") or "section"


def reserved_ids():
    """Ids that the templates use; a heading of the same name gets another."""
    texts = (path.read_text(encoding="utf-8") for path in (Path(__file__).parent / "templates").glob("*.j2"))
    return {name for text in texts for name in re.findall(r'\bid="([\w-]+)"', text)}


def parser():
    """markdown-it with tables and formulas; raw HTML other than comments is refused by `blocks`."""
    md = MarkdownIt("commonmark", {"html": True, "typographer": True}).enable(
        ["table", "smartquotes", "replacements"]
    )
    md.use(
        dollarmath_plugin,
        renderer=lambda text, options: convert(
            text, display="block" if options["display_mode"] else "inline"
        ),
    )
    md.add_render_rule("code_inline", inline_code)
    return md


def inline_code(self, tokens, index, options, env):
    """Inline code; a model's name gets the model's look, and a short piece is kept on one line."""
    text = tokens[index].content
    kind = ' class="short"' if len(text) <= 24 else ""
    if text in contact.MODELS:
        kind = f' class="model m-{text}"'
    return f"<code{kind}>{escape(text)}</code>"


def blocks(text):
    """The chapter as a list of (kind, value): kind html, heading (level, id, html), include or slot."""
    md = parser()
    tokens, env = md.parse(text), {}
    out, used, index = [], reserved_ids(), 0
    while index < len(tokens):
        token = tokens[index]
        if token.type == "heading_open":
            inner = md.renderer.render(tokens[index + 1 : index + 2], md.options, env)
            name = base = slug(inner)
            count = 1
            while name in used:
                count += 1
                name = f"{base}-{count}"
            used.add(name)
            out.append(("heading", (int(token.tag[1]), name, inner)))
            index += 3
            continue
        if token.type == "fence" and INCLUDE.fullmatch(token.content.strip()):
            out.append(("include", INCLUDE.fullmatch(token.content.strip())["name"]))
        elif token.type == "html_block":
            rest = token.content
            while slot := SLOT.match(rest):
                out.append(("slot", slot[1] + (f":{slot[2]}" if slot[2] else "")))
                rest = rest[slot.end() :]
            if re.sub(r"<!--.*?-->", "", rest, flags=re.DOTALL).strip():
                raise ValueError(
                    f"chapter.md:{token.map[0] + 1}: raw HTML, {rest.strip()[:50]!r}; "
                    "allowed: Markdown, and comments that are slots"
                )
        elif token.type == "table_open":
            end = next(k for k in range(index, len(tokens)) if tokens[k].type == "table_close")
            table = md.renderer.render(tokens[index : end + 1], md.options, env).replace(
                "<th></th>", "<td></td>"
            )
            out.append(
                ("html", f'<div class="scroll" tabindex="0" role="group" aria-label="Table">{table}</div>')
            )
            index = end
        elif token.type == "fence":
            out.append(
                ("html", f'<pre class="shell" tabindex="0"><code>{escape(token.content)}</code></pre>')
            )
        else:
            depth, end = token.nesting, index
            while depth > 0:
                end += 1
                depth += tokens[end].nesting
            out.append(
                (
                    "html",
                    re.sub(
                        r"<!--.*?-->",
                        "",
                        md.renderer.render(tokens[index : end + 1], md.options, env),
                        flags=re.DOTALL,
                    ),
                )
            )
            index = end
        index += 1
    return out


def place(parts, known):
    """Add the slots that the chapter does not place, if the page knows them (`known`)."""
    present = {value for kind, value in parts if kind == "slot"}
    for slot, region in BEFORE_REGION.items():
        if slot in known and slot not in present:
            at = next((k for k, part in enumerate(parts) if part == ("include", region)), None)
            if at is not None:
                head = max((k for k in range(at) if parts[k][0] == "heading"), default=at)
                parts.insert(min(head + 2, at) if at - head > 2 else min(head + 1, at), ("slot", slot))
    for slot, title in AT_END_OF.items():
        if slot in known and slot not in present:
            heads = [k for k, (kind, value) in enumerate(parts) if kind == "heading" and value[0] == 2]
            here = next((k for k in heads if title in parts[k][1][2].lower()), None)
            end = len(parts) if here is None else next((k for k in heads if k > here), len(parts))
            if slot == "figure:cliff" and here is not None:
                # a small figure stands beside the section's first paragraphs
                end = here + 1 + (sum(kind == "html" for kind, _ in parts[here:end]) > 1)
            parts.insert(end, ("slot", slot))
    return parts
