"""Collect chapter, code, numbers, runs and figures, and write the page. Same inputs, same bytes."""

import ast
import base64
import hashlib
import json
import re
from html import escape
from pathlib import Path

import jinja2
from markupsafe import Markup
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

import contact
from curriculum import regions
from curriculum.check_prose_code_drift import CHAPTER
from curriculum.common import wallclock
from curriculum.quoted import Numbers, load_meta
from curriculum.page import drawing, prose

HERE = Path(__file__).resolve().parent
SCRIPTS = ("engine.js", "draw.js", "figure.js", "figures.js", "reader.js")
SEEDS = 10  # start heights that the live figure offers
PRESETS = (
    ("", "the chapter’s run"),
    ("dt=0.03", "dt past penalty’s limit"),
    ("stiffness=1000000", "a spring a hundred times stiffer"),
    ("scene=bounce&dt=0.005", "a bounce that gains height"),
    ("scene=stack", "a stack of three"),
    ("scene=stack&sweeps=1", "a stack and a single sweep"),
    ("scene=stack&zoom=500", "the stack under the strong lens"),
)
# what an exercise measures on the page: its run, and which numbers it shows
EXERCISES = {
    "ex1": {
        "dt": 0.002,
        "steps": 800,
        "shows": [["max_penetration_frac", "deepest / r"], ["rest_penetration_frac", "at the end / r"]],
    },
    "ex3": {
        "dt": 0.03,
        "steps": 2000,
        "shows": [
            ["energy_excess", "energy gained / start"],
            ["max_penetration_frac", "deepest / r"],
            ["blew_up", "verdict"],
        ],
    },
}


def markdown(text):
    """A short text of ours (objective, reveal) as HTML."""
    return Markup(prose.parser().render(text))


def inline(text):
    return Markup(prose.parser().renderInline(text))


def panels(root):
    """Every region with its highlighted code, in reading order."""
    found = []
    for region in regions.find(root / "contact.py").values():
        code = highlight(region.text, PythonLexer(stripnl=False), HtmlFormatter(nowrap=True)).rstrip("\n")
        found.append(
            {
                "name": region.name,
                "first": region.first,
                "last": region.last,
                "sha256": region.sha256,
                "html": Markup(code),
            }
        )
    return found


def scenes():
    """What the live figure must know of the scenes: start heights by seed, and their own knobs."""
    known = {}
    for name in ("drop", "bounce", "stack"):
        starts = [contact.build_scene(name, seed) for seed in range(SEEDS)]
        known[name] = {
            "starts": [scene.q0[1].tolist() for scene in starts],
            "damping": starts[0].damping,
            "restitution": starts[0].restitution,
        }
    return known


def page_data():
    """Everything the scripts read: one object, PAGE."""
    flags = drawing.FLAGS
    defaults = {
        "dt": flags.dt,
        "stiffness": flags.stiffness,
        "sweeps": flags.iters,
        "baumgarte": flags.baumgarte,
    }
    return {
        "scenes": scenes(),
        "radius": contact.RADIUS,
        "defaults": defaults,
        "lane": drawing.LANE,
        "exercises": EXERCISES,
    }


def exercise_facts(root, numbers):
    """The exercises as the template wants them: words from exercises/, answers and reasons from meta.yaml."""
    found = {}
    for name, facts in (load_meta(root).get("exercises") or {}).items():
        path = next((root / "exercises").glob(f"{name}_*.py"))
        tree = ast.parse(path.read_text(encoding="utf-8"))
        words = {
            target.id: ast.literal_eval(node.value)
            for node in tree.body
            if isinstance(node, ast.Assign)
            for target in node.targets
            if target.id in ("QUESTION", "CHOICES", "WHY_PROMPT")
        }
        title, _, text = ast.get_docstring(tree).partition("\n")
        parts = re.fullmatch(r"Exercise \d+, (.+?) \((\d+) minutes\): (.+?)\.?", title.strip())
        if not parts:
            raise ValueError(
                f"{path.name}:1: the docstring's first line must read "
                "'Exercise N, KIND (M minutes): TITLE'"
            )
        # the docstring's prose, without how to run it in the terminal
        paragraphs = [each for each in re.split(r"\n\s*\n", text.strip()) if not each.startswith("    ")]
        if words.get("CHOICES"):
            paragraphs = [re.sub(r"\s*Read CHOICES.*", "", each, flags=re.DOTALL) for each in paragraphs]
            paragraphs.append(words["QUESTION"])
        commands = re.findall(r"^    (\S.*?)(?:\s{2,}#.*)?$", text, re.MULTILINE)
        choices = words.get("CHOICES") or {}
        reveal = {
            letter: markdown(numbers.render(reason))
            for letter, reason in (facts.get("reveal") or {}).items()
        }
        if set(reveal) != set(choices):
            raise ValueError(
                f"meta.yaml:1: the reveals of {name} are for {sorted(reveal)}, its choices are {sorted(choices)}"
            )
        found[name] = {
            "id": name,
            "title": f"Exercise {name[2:]}: {parts[3]}",
            "kind": parts[1],
            "minutes": parts[2],
            "task": Markup("").join(markdown(each) for each in paragraphs if each.strip()),
            "choices": list(choices.items()),
            "why_label": words.get("WHY_PROMPT", ""),
            "answer": facts["answer"] if choices else None,
            "reveal": reveal,
            "command": "\n".join(commands),
        }
    return found


def generated_figures(root):
    """SVGs that bench and stress keep in the repository, by slot name; none where they have not run."""
    found = {}
    for kind in ("bench", "stress"):
        for path in sorted((root / "curriculum" / kind).rglob("*.svg")):
            text = path.read_text(encoding="utf-8")
            size = re.search(
                r"<svg\b[^>]*?\bviewBox=\"[\d.eE+-]+ [\d.eE+-]+ ([\d.]+) ([\d.]+)\"", text, re.DOTALL
            )
            title = re.search(r"<title[^>]*>(.*?)</title>", text, re.DOTALL)
            name = re.sub("^(error|map)-", "", path.stem.replace("_", "-"))  # error-drop.svg is bench:drop
            what = title[1].strip() if title else name.replace("-", " ")
            told = ("Run time against error" if kind == "bench" else "Stability") + f": {what}"
            found[f"{kind}:{name}"] = {
                "id": f"{kind}-{name}",
                "alt": told,
                "caption": Markup(
                    f"{escape(told)}. Measured by <code>python -m " f"curriculum.{kind}</code>."
                ),
                "src": "data:image/svg+xml;base64," + base64.b64encode(text.encode()).decode(),
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
    return [
        {
            "tier": tier,
            "time": wallclock.show(wallclock.lookup(wallclock.CHAPTER, tier, root / "wallclock.csv")),
            "config_hash": rows.get(tier, {}).get("config_hash"),
            "date": rows.get(tier, {}).get("date"),
        }
        for tier in [*wallclock.SHOWN, *sorted(rows.keys() - set(wallclock.SHOWN))]
    ]


def minified(css):
    """CSS without comments and indentation."""
    return re.sub(r"\n\s+", "\n", re.sub(r"/\*.*?\*/\s*", "", css, flags=re.DOTALL))


def build(root=regions.ROOT, chapter=None):
    """The page as text. Raises ValueError (file:line: what) where the chapter can't be shown as it is."""
    root = Path(root)
    text = (root / CHAPTER).read_text(encoding="utf-8") if chapter is None else chapter
    meta, numbers = load_meta(root), Numbers(root)
    numbers.run_all(text + json.dumps(meta.get("exercises") or {}))
    scene, dt, steps = contact.build_scene("drop"), drawing.FLAGS.dt, drawing.FLAGS.steps
    runs = {model: contact.run_model(model, scene, dt, steps) for model in contact.MODELS}
    qualities = {
        model: contact.contact_quality(run, scene, dt, runs["exact"]) for model, run in runs.items()
    }

    shown = panels(root)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    environment.globals.update(
        models=contact.MODELS,
        marker=drawing.marker,
        radius=contact.RADIUS,
        presets=PRESETS,
        starts=[start[0] for start in scenes()["drop"]["starts"]],
    )
    poster = drawing.poster(runs, qualities)
    for lane in poster["lanes"]:
        lane["svg"] = Markup(lane["svg"])
    macros = environment.get_template("parts.html.j2").module

    slots = {"wallclock": Markup(macros.wallclock(ledger(root))), "figure:puzzle": Markup(macros.puzzle())}
    for name, figure in drawing.small_figures(runs).items():
        slots[f"figure:{name}"] = Markup(
            macros.small({"kind": "", "slider": None, **figure, "svg": Markup(figure["svg"])})
        )
    exercises = exercise_facts(root, numbers)
    bets = [
        (name, each["title"][0].lower() + each["title"][1:].partition(":")[0])
        for name, each in exercises.items()
        if each["choices"]
    ]
    for name, exercise in exercises.items():
        slots[f"exercise:{name}"] = Markup(macros.exercise(exercise))
    for name, figure in generated_figures(root).items():
        slots[name] = Markup(macros.generated(figure))
    by_name = {region["name"]: region for region in shown}

    parts = prose.place(prose.blocks(numbers.render(text)), slots)
    title = next((value for kind, value in parts if kind == "heading" and value[0] == 1), None)
    heading = re.sub(r"^\d+(\.\d+)*[:.]?\s*", "", title[2]) if title else escape(meta["title"])
    body, contents = [], [("objectives", "What you will be able to do")]
    for kind, value in parts:
        if kind == "html":
            body.append(value)
        elif kind == "include":
            if value not in by_name:
                raise ValueError(f"{CHAPTER}: includes {value}, and contact.py has no such region")
            body.append(str(macros.panel(by_name[value])))
        elif kind == "slot":
            if value not in slots and not value.startswith(("bench:", "stress:")):
                raise ValueError(f"{CHAPTER}: a slot for {value!r}; allowed: {', '.join(sorted(slots))}")
            body.append(str(slots.get(value, "")))
        elif value[0] > 1:
            level, name, inner = value
            body.append(f'<h{level} id="{name}">{inner}</h{level}>')
            if level == 2:
                contents.append((name, Markup(re.sub(r"</?code[^>]*>", "", inner))))
    contents.append(("colophon", "Colophon"))

    scripts = []
    for name in SCRIPTS:
        source = (HERE / name).read_text(encoding="utf-8")
        if name == "draw.js":
            source = f"const PAGE = {json.dumps(page_data(), sort_keys=True)};\n{source}"
        if "</script" in source.lower():
            raise ValueError(f"curriculum/page/{name}: the text '</script' would end the script")
        scripts.append((name, Markup(source)))
    colors = "".join(f"--{model}: {color}; " for model, color in contact.COLORS.items())
    style = f":root {{ {colors}}}\n" + minified((HERE / "style.css").read_text(encoding="utf-8"))

    def allowed(text):
        return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"

    policy = (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; style-src 'unsafe-inline'; "
        "script-src " + " ".join(allowed(text) for _, text in scripts)
    )
    hashes = [
        ("contact.py", hashlib.sha256((root / "contact.py").read_bytes()).hexdigest()),
        ("chapter.md", hashlib.sha256(text.encode()).hexdigest()),
        ("engine.js", hashlib.sha256((HERE / "engine.js").read_bytes()).hexdigest()),
    ]
    icon = (
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'><path d='M0 11h16v5H0z' fill='#888'/>"
        f"<circle cx='8' cy='7.5' r='5' fill='{contact.COLORS['penalty']}'/></svg>"
    )
    page = environment.get_template("page.html.j2").render(
        title=f"{re.sub('<[^>]+>', '', heading)} (chapter 3.5)",
        heading=Markup(heading),
        kicker="Phase 3, chapter 3.5: build a physics engine",
        lead="A ball, a table, and one question with three answers: what force does the table apply?",
        description="Contact between bodies, built three times and measured: penalty, lcp and exact, live in the page.",
        policy=policy,
        icon="data:image/svg+xml," + re.sub(r"[<>#\"%]", lambda m: f"%{ord(m[0]):02x}", icon),
        style=Markup(style),
        scripts=scripts,
        poster=poster,
        contents=contents,
        body=Markup("\n".join(body)),
        objectives=[inline(" ".join(item.split())) for item in meta["objectives"]],
        regions=shown,
        hashes=hashes,
        bets=bets,
    )
    return page
