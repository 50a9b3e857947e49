"""Collect chapter, code, numbers, runs and figures, and write the page. Same inputs, same bytes."""

import ast
import base64
import functools
import hashlib
import importlib
import json
import re
import sys
from html import escape
from pathlib import Path
from unittest.mock import patch

import jinja2
from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

import contact
from curriculum import regions, terminal
from curriculum.check_prose_code_drift import CHAPTER
from curriculum.common import wallclock
from curriculum.page import prose
from curriculum.page.still import DRAWING, stills
from curriculum.quoted import Numbers, load_meta

HERE = Path(__file__).resolve().parent
SCRIPTS = (
    *DRAWING,
    "bets.js",
    "controls.js",
    "live_figure.js",
    "links.js",
    "live_small.js",
    "puzzle.js",
    "arithmetic.js",
    "blank.js",
    "sandbox.js",
    "reader.js",
)
SCENES = ("drop", "bounce", "stack")  # of the live figure: balls in one column
SEEDS = 10  # start heights that it offers
FOLDED = 45  # lines: a longer excerpt is folded
MACHINERY = "the rest of the file"  # the section whose excerpts are all folded
# what a bet measures on the page: its drop, the columns (title, model, mass) and the rows shown
EXERCISES = {
    "ex1": {
        "dt": 0.002,
        "steps": 800,
        "columns": [["penalty", "penalty", 1], ["lcp", "lcp", 1]],
        "shows": [
            ["max_penetration_frac", "deepest / r"],
            ["rest_penetration_frac", "at the end / r"],
        ],
    },
    "ex3": {
        "dt": 0.03,
        "steps": 2000,
        "columns": [["penalty", "penalty", 1], ["lcp", "lcp", 1]],
        "shows": [
            ["energy_excess", "energy gained / start"],
            ["max_penetration_frac", "deepest / r"],
            ["blew_up", "verdict"],
        ],
    },
    "ex4": {
        "dt": 0.002,
        "steps": 2000,
        "columns": [
            ["soft, 1 kg", "soft", 1],
            ["soft, 10 kg", "soft", 10],
            ["penalty, 1 kg", "penalty", 1],
            ["penalty, 10 kg", "penalty", 10],
        ],
        "shows": [["rest_penetration_frac", "at the end / r"]],
    },
}
# what stands over the live figure while it would tell the answer of a bet
VEILS = {
    "ex1": "The same ball, four ways for the table to push. How deep will each let it in, and where "
    "will it rest? Bet before you see it: exercise 1.",
    "ex3": "A time step this long is what exercise 3 is about. Bet before you see it.",
}
BLANKS = ("penalty_normal_force", "project_impulse")  # of exercise 2


def markdown(text):
    """A short text of ours (objective, reveal) as HTML."""
    return Markup(prose.parser().render(text))


def inline(text):
    return Markup(prose.parser().renderInline(text))


# ---- code


# of Pygments' classes those that the style tells apart; the others would only make the page heavy
STYLED = {"k", "kn", "kc", "kd", "ow", "c1", "sd", "s1", "s2", "sa", "si", "nf", "nc"}


@functools.cache
def code_lines(text):
    """Highlighted code, a block a line; a line too long for its column goes on further in."""
    shown = highlight(text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True))
    shown = re.sub(
        r'<span class="(\w+)">([^<]*)</span>', lambda m: m[0] if m[1] in STYLED else m[2], shown
    )
    lines = shown.rstrip("\n").split("\n")
    indents = [len(line) - len(line.lstrip(" ")) for line in text.rstrip("\n").split("\n")]
    out = []
    for line, indent in zip(lines, indents):
        kind = "ln doc" if '<span class="sd">' in line else "ln"
        out.append(f'<span class="{kind}" style="--i:{indent}">{line}\n</span>')
    return Markup("".join(out))


def panels(root):
    """Every region of the literate files by (file, name), with its highlighted code."""
    found = {}
    for region in regions.find_all(root).values():
        count = region.last - region.first + 1
        found[region.file, region.name] = {
            "name": region.name,
            "file": region.file,
            "first": region.first,
            "last": region.last,
            "sha256": region.sha256,
            "folded": count > FOLDED,
            "html": code_lines(region.text),
        }
    return found


# ---- data for the scripts


def scenes():
    """What the live figure must know of the scenes: start heights by seed, and their own knobs."""
    known = {}
    for name in SCENES:
        starts = [contact.build_scene(name, seed) for seed in range(SEEDS)]
        known[name] = {
            "starts": [scene.q0[1].tolist() for scene in starts],
            "damping": starts[0].damping,
            "restitution": starts[0].restitution,
        }
    return known


def blank_cases(root):
    """The inputs on which checks.py tries the blanks of exercise 2, from exercises/trials.py."""
    with patch.object(sys, "path", [str(root / "exercises"), *sys.path]):
        trials = importlib.import_module("trials")
    return {
        blank: [{key: float(value) for key, value in case.items()} for case in trials.inputs(blank)]
        for blank in BLANKS
    }


def page_data(root):
    """Everything the scripts read: one object, PAGE."""
    flags = terminal.parse_flags([])
    defaults = {name: getattr(flags, name) for name in ("dt", "stiffness", "iters", "baumgarte")}
    return {
        "scenes": scenes(),
        "radius": contact.RADIUS,
        "defaults": defaults,
        "exercises": EXERCISES,
        "veils": VEILS,
        "blank": blank_cases(root),
    }


# ---- exercises


def exercise_words(path):
    """(docstring, {QUESTION, CHOICES, WHY_PROMPT}) of an exercise's file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    words = {
        target.id: ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name) and target.id in ("QUESTION", "CHOICES", "WHY_PROMPT")
    }
    return ast.get_docstring(tree), words


def reveals(name, facts, choices, numbers):
    """The reasons by choice, as HTML. Raises ValueError where they are not for the choices."""
    reveal = {
        letter: markdown(numbers.render(reason))
        for letter, reason in (facts.get("reveal") or {}).items()
    }
    if set(reveal) != set(choices):
        raise ValueError(
            f"meta.yaml:1: the reveals of {name} are for {sorted(reveal)}, "
            f"its choices are {sorted(choices)}"
        )
    return reveal


def exercise_facts(root, numbers):
    """The exercises as the template wants them: words from exercises/, answers from meta.yaml."""
    found = {}
    for name, facts in (load_meta(root).get("exercises") or {}).items():
        path = next((root / "exercises").glob(f"{name}_*.py"))
        docstring, words = exercise_words(path)
        title, _, text = docstring.partition("\n")
        parts = re.fullmatch(r"Exercise \d+, (.+?) \((\d+) minutes\): (.+?)\.?", title.strip())
        if not parts:
            raise ValueError(
                f"{path.name}:1: the docstring's first line must read "
                "'Exercise N, KIND (M minutes): TITLE'"
            )
        # the docstring's prose, without how to run it in the terminal
        paragraphs = [
            each for each in re.split(r"\n\s*\n", text.strip()) if not each.startswith("    ")
        ]
        choices = words.get("CHOICES") or {}
        if choices and name not in EXERCISES:
            raise ValueError(
                f"meta.yaml:1: the page cannot measure {name}; "
                f"it knows the bets {', '.join(EXERCISES)}"
            )
        if choices:
            paragraphs = [
                re.sub(r"\s*Read CHOICES.*", "", each, flags=re.DOTALL) for each in paragraphs
            ] + [words["QUESTION"]]
        commands = re.findall(r"^    (\S.*?)(?:\s{2,}#.*)?$", text, re.MULTILINE)
        found[name] = {
            "id": name,
            "title": f"Exercise {name[2:]}: {parts[3]}",
            "kind": parts[1],
            "minutes": parts[2],
            "blank": not choices,
            "task": Markup("").join(markdown(each) for each in paragraphs if each.strip()),
            "choices": list(choices.items()),
            "why_label": words.get("WHY_PROMPT", ""),
            "answer": facts["answer"] if choices else None,
            "reveal": reveals(name, facts, choices, numbers),
            "hints": [inline(" ".join(hint.split())) for hint in facts.get("hints") or []],
            "command": "\n".join(commands),
        }
    return found


# ---- generated figures and tables


def thinned(svg):
    """An SVG whose paths are rounded to a hundredth of a pixel, without blanks between elements."""
    paths = re.sub(r'(?<= d=")[^"]+', lambda d: re.sub(r"(\.\d\d)\d+", r"\1", d[0]), svg)
    return re.sub(r">\s+<", "><", re.sub(r"\s+", " ", paths))


def data_address(svg):
    """An SVG as an address that holds it, readable and a quarter shorter than base64."""
    escaped = svg.replace("%", "%25").replace("#", "%23").replace("'", "%27").replace('"', "'")
    return Markup("data:image/svg+xml," + escaped.replace("&", "&amp;"))


def generated_figures(root):
    """SVGs that bench and stress keep in the repository, by slot name; none where they have not run."""
    found = {}
    for kind in ("bench", "stress"):
        for path in sorted((root / "curriculum" / kind).rglob("*.svg")):
            text = path.read_text(encoding="utf-8")
            size = re.search(
                r"<svg\b[^>]*?\bviewBox=\"[\d.eE+-]+ [\d.eE+-]+ ([\d.]+) ([\d.]+)\"",
                text,
                re.DOTALL,
            )
            title = re.search(r"<title[^>]*>(.*?)</title>", text, re.DOTALL)
            name = re.sub(
                "^(error|map)-", "", path.stem.replace("_", "-")
            )  # error-drop: bench:drop
            what = title[1].strip() if title else name.replace("-", " ")
            told = ("Run time against error" if kind == "bench" else "Stability") + f": {what}"
            found[f"{kind}:{name}"] = {
                "id": f"{kind}-{name}",
                "alt": told,
                "caption": Markup(
                    f"{escape(told)}. Measured by <code>python -m curriculum.{kind}</code>."
                ),
                "src": data_address(thinned(text)),
                "width": round(float(size[1])) if size else None,
                "height": round(float(size[2])) if size else None,
            }
    return found


def ledger(root):
    """The wall-clock table: every tier the course shows, measured or not."""
    rows = {
        row["tier"]: row
        for row in wallclock.read(root / "wallclock.csv")
        if row["chapter"] == wallclock.CHAPTER
    }
    shown = [*wallclock.SHOWN, *sorted(rows.keys() - set(wallclock.SHOWN))]
    return [
        {
            "tier": tier,
            "time": wallclock.show(
                wallclock.lookup(wallclock.CHAPTER, tier, root / "wallclock.csv")
            ),
            "config_hash": rows.get(tier, {}).get("config_hash"),
            "date": rows.get(tier, {}).get("date"),
        }
        for tier in shown
    ]


# ---- the page


def templates():
    """The templates' environment."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )


def fill_slots(root, macros, drawn, exercises):
    """What stands in each slot that a chapter may hold, as HTML by name."""
    slots = {
        "wallclock": macros.wallclock(ledger(root)),
        "figure:puzzle": macros.puzzle(),
        "figure:sandbox": macros.sandbox(),
        "figure:lanes": macros.recall(),
    }
    for name, figure in drawn["small"].items():
        slots[f"figure:{name}"] = macros.small(figure | {"svg": Markup(figure["svg"])})
    for name, exercise in exercises.items():
        slots[f"exercise:{name}"] = macros.exercise(exercise)
    for name, figure in generated_figures(root).items():
        slots[name] = macros.generated(figure)
    return {name: str(html) for name, html in slots.items()}


class Body:
    """The chapter's HTML as it grows, and (level, id, text) of its headings.

    What follows a bet, up to the next heading, is its answer: it is put into a veil. What follows the
    puzzle is veiled as well, up to the map that shows its answer.
    """

    def __init__(self, slots, code, macros, bets):
        self.slots, self.code, self.macros, self.bets = slots, code, macros, bets
        self.html, self.contents = [], []
        self.veils, self.puzzle_depth, self.machinery = 0, 0, False

    def lift(self, keep=0):
        """Close the veils that are open, but for `keep` of them."""
        self.html += ["</div></div>"] * (self.veils - keep)
        self.veils = min(self.veils, keep)

    def veil(self, name):
        self.html.append(str(self.macros.veil(name)))
        self.veils += 1

    def heading(self, level, name, inner):
        self.lift()
        if level <= 2:
            self.machinery = MACHINERY in inner.lower()
        if level > 1:
            self.html.append(str(self.macros.heading(level, name, Markup(inner))))
            self.contents.append((level, name, Markup(re.sub(r"</?(code|a)[^>]*>", "", inner))))

    def include(self, file, name):
        if (file, name) not in self.code:
            raise ValueError(f"{CHAPTER}: includes {file}#{name}, and there is no such region")
        panel = self.code[file, name]
        panel = panel | {"folded": self.machinery or panel["folded"]}
        self.html.append(str(self.macros.panel(panel)))

    def slot(self, name):
        if name not in self.slots and not name.startswith(("bench:", "stress:")):
            raise ValueError(
                f"{CHAPTER}: a slot for {name!r}; allowed: {', '.join(sorted(self.slots))}"
            )
        self.html.append(self.slots.get(name, ""))
        exercise = name.removeprefix("exercise:")
        if exercise in self.bets and self.veils == 0:
            self.veil(exercise)
        elif name == "figure:puzzle":
            self.veil("puzzle")
            self.puzzle_depth = self.veils - 1
        elif name.startswith("stress:") and self.veils > self.puzzle_depth:
            self.lift(keep=self.puzzle_depth)


def assemble(parts, slots, code, macros, bets):
    """(body, contents): the chapter's HTML, and (level, id, text) of its headings."""
    body = Body(slots, code, macros, bets)
    for kind, value in parts:
        if kind == "heading":
            body.heading(*value)
        elif kind == "include":
            body.include(*value)
        elif kind == "slot":
            body.slot(value)
        else:
            body.html.append(value)
    body.lift()
    return "\n".join(body.html), body.contents


def script_texts(data):
    """(name, text) of the page's scripts, the data before the first."""
    found = []
    for name in SCRIPTS:
        source = (HERE / name).read_text(encoding="utf-8")
        if not found:
            source = f"const PAGE = {json.dumps(data, sort_keys=True)};\n{source}"
        if "</script" in source.lower():
            raise ValueError(f"curriculum/page/{name}: the text '</script' would end the script")
        found.append((name, source))
    return found


def early_script(bets):
    """What must run before the first paint, so that nothing moves after it."""
    return (
        'document.documentElement.className = "js";\n'
        f"for (const id of {json.dumps([*bets, 'puzzle'])})\n"
        '  try { if (localStorage.getItem("contact-chapter:" + id)) '
        'document.documentElement.classList.add("open-" + id); } catch {}\n'
    )


def sha256(text):
    """A text's fingerprint."""
    return hashlib.sha256(text.encode()).hexdigest()


def policy(scripts):
    """The page may run these scripts and nothing else, and ask the network for nothing."""
    allowed = " ".join(
        "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"
        for text in scripts
    )
    return (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src 'unsafe-inline'; script-src {allowed}"
    )


def minified(css):
    """CSS without comments and indentation."""
    return re.sub(r"\n\s+", "\n", re.sub(r"/\*.*?\*/\s*", "", css, flags=re.DOTALL))


def stylesheet():
    """The page's style, with the models' colours from contact.py, and what veils each bet."""
    colors = "".join(f"--{model}: {color}; " for model, color in contact.COLORS.items())
    veils = "".join(
        f".js:not(.open-{name}) .veiled-{name} > .answer, .open-{name} .veiled-{name} > "
        f".veil-bar {{ display: none; }}\n"
        for name in (*EXERCISES, "puzzle")
    )
    return f":root {{ {colors}}}\n" + minified((HERE / "style.css").read_text("utf-8")) + veils


def favicon():
    """A ball on a table, as a data address."""
    svg = (
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'>"
        "<path d='M0 11h16v5H0z' fill='#888'/>"
        f"<circle cx='8' cy='7.5' r='5' fill='{contact.COLORS['penalty']}'/></svg>"
    )
    return data_address(svg)


def build(root=regions.ROOT, chapter=None):
    """The page as text. Raises ValueError (file:line: what) where the chapter can't be shown as it is."""
    root = Path(root)
    text = (root / CHAPTER).read_text(encoding="utf-8") if chapter is None else chapter
    meta, numbers = load_meta(root), Numbers(root)
    numbers.run_all(text + json.dumps(meta.get("exercises") or {}))
    data = page_data(root)
    drawn = stills(data)
    environment = templates()
    environment.globals.update(
        models=contact.MODELS,
        radius=contact.RADIUS,
        scenes=SCENES,
        size=drawn["size"],
        keys={model: Markup(key) for model, key in drawn["keys"].items()},
        starts=[start[0] for start in data["scenes"]["drop"]["starts"]],
    )
    macros = environment.get_template("parts.html.j2").module
    exercises, code = exercise_facts(root, numbers), panels(root)
    bets = [name for name, each in exercises.items() if each["choices"]]
    parts = prose.blocks(numbers.render(text), drawn["knobs"])
    body, contents = assemble(parts, fill_slots(root, macros, drawn, exercises), code, macros, bets)
    title = next((value for kind, value in parts if kind == "heading" and value[0] == 1), None)
    heading = re.sub(r"^\d+(\.\d+)*[:.]?\s*", "", title[2]) if title else escape(meta["title"])
    scripts, early = script_texts(data), early_script(bets)
    return environment.get_template("page.html.j2").render(
        title=f"{re.sub('<[^>]+>', '', heading)} (chapter 3.5)",
        heading=Markup(heading),
        policy=policy([early, *(source for _, source in scripts)]),
        icon=favicon(),
        style=Markup(stylesheet()),
        early=Markup(early),
        scripts=[(name, Markup(source)) for name, source in scripts],
        lanes=drawn,
        contents=contents,
        body=Markup(body),
        objectives=[inline(" ".join(item.split())) for item in meta["objectives"]],
        bets=[(name, exercises[name]["title"].partition(":")[0]) for name in bets],
        regions=list(code.values()),
        hashes=[("chapter.md", sha256(text))]
        + [(name, sha256((HERE / name).read_text("utf-8"))) for name in ("exact.js", "engine.js")],
    )
