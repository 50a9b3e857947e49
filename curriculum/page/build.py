"""Collect chapter, code, numbers, runs and figures, and write the page. Same inputs, same bytes."""

import base64
import hashlib
import json
import re
from html import escape
from pathlib import Path

import jinja2
from markupsafe import Markup

import contact
from curriculum import regions, terminal
from curriculum.check_prose_code_drift import CHAPTER
from curriculum.common import wallclock
from curriculum.page import maths_font, prose
from curriculum.page.body import assemble
from curriculum.page.exercises import EXERCISES, blank_cases, exercise_facts, inline
from curriculum.page.panels import panels, whole_file
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
SCALE = 1.6  # of the pictures of bench and stress: their text of 10 px shall be read beside ours
# what stands over the live figure while it would tell the answer of a bet
VEILS = {
    "ex1": "The same ball, four ways for the table to push. How deep will each let it in, and where "
    "will it rest? Bet before you see it: exercise 1.",
    "ex3": "What settings like these do is the question of exercise 3. Bet before you see it.",
}
# the public course that this chapter belongs to, and what stands around it there
COURSE = "https://zero2robot.com"
SOURCE = "https://github.com/kaushikb11/zero2robot"
NEIGHBOURS = (
    ("3.3", "a physics engine", f"{COURSE}/ch3.3-engine/"),
    ("3.4", "joints", f"{COURSE}/ch3.4-constraints/"),
    ("3.6", "the engine put to use", f"{COURSE}/ch3.6-compare/"),
)
# files of this repository, as seen from outputs/, where the README's commands put page and notebook
FILES = (
    ("contact.py", "../contact.py"),
    ("the whole folder", "../README.md"),
    ("the same as a notebook", "contact.ipynb"),
)


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


# ---- generated figures and tables


def thinned(svg):
    """An SVG whose paths are rounded to a hundredth of a pixel, without blanks between elements."""
    paths = re.sub(r'(?<= d=")[^"]+', lambda d: re.sub(r"(\.\d\d)\d+", r"\1", d[0]), svg)
    return re.sub(r">\s+<", "><", re.sub(r"\s+", " ", paths))


def data_address(svg):
    """An SVG as an address that holds it, readable and a quarter shorter than base64."""
    named = svg.replace("'", "&apos;").replace('"', "'")
    escaped = named.replace("%", "%25").replace("#", "%23")
    return Markup("data:image/svg+xml," + escaped.replace("&", "&amp;"))


def generated_figure(kind, path):
    """A picture that bench or stress has drawn, for the page: its name, and what the template wants."""
    text = path.read_text(encoding="utf-8")
    box = re.search(r'<svg\b[^>]*?\bviewBox="\S+ \S+ ([\d.]+) ([\d.]+)"', text, re.DOTALL)
    title = re.search(r"<title[^>]*>(.*?)</title>", text, re.DOTALL)
    name = re.sub("^(error|map)-", "", path.stem.replace("_", "-"))  # error-drop: bench:drop
    what = title[1].strip() if title else name.replace("-", " ")
    told = ("Run time against error" if kind == "bench" else "Stability") + f": {what}"
    measured = f"Measured by <code>python -m curriculum.{kind}</code>."
    width, height = (round(SCALE * float(side)) for side in box.groups()) if box else (None, None)
    return f"{kind}:{name}", {
        "id": f"{kind}-{name}",
        "alt": told,
        "caption": Markup(f"{escape(told)}. {measured}"),
        "src": data_address(thinned(text)),
        "width": width,
        "height": height,
    }


def generated_figures(root):
    """SVGs that bench and stress keep in the repository, by slot name; none where they have not run."""
    return dict(
        generated_figure(kind, path)
        for kind in ("bench", "stress")
        for path in sorted((root / "curriculum" / kind).rglob("*.svg"))
    )


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


def templates(data, drawn):
    """The templates' environment."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    environment.globals.update(
        models=contact.MODELS,
        radius=contact.RADIUS,
        scenes=SCENES,
        size=drawn["size"],
        keys={model: Markup(key) for model, key in drawn["keys"].items()},
        starts=[start[0] for start in data["scenes"]["drop"]["starts"]],
        course={"site": COURSE, "source": SOURCE, "neighbours": NEIGHBOURS, "files": FILES},
    )
    return environment


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
        "default-src 'none'; img-src data:; font-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src 'unsafe-inline'; script-src {allowed}"
    )


def minified(css):
    """CSS without comments and indentation."""
    return re.sub(r"\n\s+", "\n", re.sub(r"/\*.*?\*/\s*", "", css, flags=re.DOTALL))


def font_face():
    """The font of the formulas, in the page itself."""
    held = base64.b64encode(maths_font.FILE.read_bytes()).decode()
    return (
        f'@font-face {{ font-family: "{maths_font.NAME}"; '
        f'src: url("data:font/woff;base64,{held}") format("woff"); }}\n'
    )


def stylesheet():
    """The page's style, with the models' colours from contact.py, and what veils each bet."""
    colors = "".join(f"--{model}: {color}; " for model, color in contact.COLORS.items())
    veils = "".join(
        f".js:not(.open-{name}) .veiled-{name} > .answer, .open-{name} .veiled-{name} > "
        f".veil-bar {{ display: none; }}\n"
        for name in (*EXERCISES, "puzzle")
    )
    style = minified((HERE / "style.css").read_text("utf-8"))
    return f":root {{ {colors}}}\n{font_face()}{style}{veils}"


def favicon():
    """A ball on a table, as a data address."""
    return data_address(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16">'
        '<path d="M0 11h16v5H0z" fill="#888"/>'
        f'<circle cx="8" cy="7.5" r="5" fill="{contact.COLORS["penalty"]}"/></svg>'
    )


def head(data, bets):
    """What stands in the page's head and at its foot: style, scripts, and what may run."""
    scripts, early = script_texts(data), early_script(bets)
    return {
        "policy": policy([early, *(source for _, source in scripts)]),
        "icon": favicon(),
        "style": Markup(stylesheet()),
        "early": Markup(early),
        "scripts": [(name, Markup(source)) for name, source in scripts],
    }


def titles(parts, meta):
    """The chapter's heading without its number, and the title of the page."""
    title = next((value for kind, value in parts if kind == "heading" and value[0] == 1), None)
    heading = re.sub(r"^\d+(\.\d+)*[:.]?\s*", "", title[2]) if title else escape(meta["title"])
    return {
        "heading": Markup(heading),
        "title": f"{re.sub('<[^>]+>', '', heading)} (chapter 3.5)",
    }


def fingerprints(text):
    """(name, sha256) of the files that the colophon names beside the regions."""
    files = [(name, (HERE / name).read_text("utf-8")) for name in ("exact.js", "engine.js")]
    return [(name, sha256(held)) for name, held in [("chapter.md", text), *files]]


def build(root=regions.ROOT, chapter=None):
    """The page as text. Raises ValueError (file:line: what) where the chapter can't be shown as it is."""
    root = Path(root)
    text = (root / CHAPTER).read_text(encoding="utf-8") if chapter is None else chapter
    meta, numbers = load_meta(root), Numbers(root)
    numbers.run_all(text + json.dumps(meta.get("exercises") or {}))
    data = page_data(root)
    drawn = stills(data)
    environment = templates(data, drawn)
    macros = environment.get_template("parts.html.j2").module
    exercises, code = exercise_facts(root, numbers), panels(root)
    bets = [name for name, each in exercises.items() if each["choices"]]
    parts = prose.blocks(numbers.render(text), drawn["knobs"])
    slots = fill_slots(root, macros, drawn, exercises)
    body, contents = assemble(parts, slots, code, macros, bets, whole_file(root))
    return environment.get_template("page.html.j2").render(
        **head(data, bets),
        **titles(parts, meta),
        lanes=drawn,
        contents=contents,
        body=Markup(body),
        objectives=[inline(" ".join(item.split())) for item in meta["objectives"]],
        bets=[(name, exercises[name]["title"].partition(":")[0]) for name in bets],
        regions=list(code.values()),
        hashes=fingerprints(text),
    )
