"""Collect chapter, code, numbers and figures, and write the page. Same inputs, same bytes."""

import base64
import hashlib
import os
import re
from html import escape
from pathlib import Path

import jinja2
from markupsafe import Markup

import contact
from curriculum import curves, exact
from curriculum.page import maths_font, prose
from curriculum.page.body import assemble
from curriculum.page.bundle import bundle
from curriculum.page.exercises import all_exercises, blank_cases
from curriculum.page.panels import panels
from curriculum.page.still import stills
from curriculum.text import ledger
from curriculum.text.references import REFERENCE, Numbers, load_meta
from curriculum.text.regions import ROOT

HERE = Path(__file__).resolve().parent
SCENES = ("drop", "bounce", "stack")  # of the live figure: balls in one column
ENGINE = (
    "GRAVITY CONTACT_MARGIN SOLREF SOLIMP HARD MOST_SWEEPS LAST_BITS EXPLODED".split()
)  # constants of contact.py that engine.js takes
SCALE = 1.6  # of the pictures of bench and stress: their text of 10 px shall be read beside ours
# the public course that this chapter belongs to, and what stands around it there
COURSE = {
    "site": "https://zero2robot.com",
    "source": "https://github.com/kaushikb11/zero2robot",
    "neighbours": [
        ("3.3", "a physics engine", "https://zero2robot.com/ch3.3-engine/"),
        ("3.4", "joints", "https://zero2robot.com/ch3.4-constraints/"),
        ("3.6", "the engine put to use", "https://zero2robot.com/ch3.6-compare/"),
    ],
}
COLAB = "https://colab.research.google.com/github/{}/blob/gh-pages/contact.ipynb"


def scene_facts(name):
    """What the page must know of a scene: its start heights, and its own knobs."""
    scene = contact.build_scene(name)
    start = scene.q0[1].tolist()
    return {"start": start, "damping": scene.damping, "restitution": scene.restitution}


def page_data(bets):
    """What the scripts know from the Python files, the module data.js."""
    settings = contact.Settings()
    dt = contact.parse_flags([]).dt
    return {
        "scenes": {name: scene_facts(name) for name in SCENES},
        "radius": contact.RADIUS,
        "defaults": {
            "dt": dt,
            "stiffness": settings.stiffness,
            "iters": settings.iters,
            "baumgarte": settings.baumgarte,
            "warm": settings.warm,
        },
        "engine": {name: getattr(contact, name) for name in ENGINE},
        "exact": {name: getattr(contact, name) for name in ("TOUCH", "SLOW", "STILL")}
        | {"ORDER": exact.ORDER},
        "blank": blank_cases(),
        "bets": bets,
    }


# ---- what stands in the slots


def data_address(svg):
    """An SVG as an address that holds it, its paths rounded to a hundredth of a pixel."""
    drawn = re.sub(
        r"<\?xml.*?\?>|<!DOCTYPE.*?>|<!--.*?-->|<metadata>.*?</metadata>", "", svg, flags=re.DOTALL
    )
    paths = re.sub(r'(?<= d=")[^"]+', lambda d: re.sub(r"(\.\d)\d+", r"\1", d[0]), drawn)
    short = re.sub(r">\s+<", "><", re.sub(r"\s+", " ", paths))
    named = short.replace("'", "&apos;").replace('"', "'")
    escaped = named.replace("%", "%25").replace("#", "%23").replace("&", "&amp;")
    return Markup("data:image/svg+xml," + escaped)


def generated_figure(kind, path):
    """A picture that bench or stress has drawn: its slot, and what the template wants."""
    text = path.read_text(encoding="utf-8")
    box = re.search(r'<svg\b[^>]*?\bviewBox="\S+ \S+ ([\d.]+) ([\d.]+)"', text, re.DOTALL)
    title = re.search(r"<title[^>]*>(.*?)</title>", text, re.DOTALL)
    name = re.sub("^(error|map)-", "", path.stem.replace("_", "-"))  # error-drop: bench:drop
    what = title[1].strip() if title else name.replace("-", " ")
    told = ("Run time against error" if kind == "bench" else "Stability") + f": {what}"
    width, height = (round(SCALE * float(side)) for side in box.groups())
    caption = Markup(f"{escape(told)}. Measured by <code>python -m curriculum.{kind}</code>.")
    return f"{kind}:{name}", {
        "alt": told,
        "caption": caption,
        "src": data_address(text),
        "width": width,
        "height": height,
    }


def ledger_rows():
    """The wall-clock table, measured or not."""
    return [row | {"time": ledger.show(ledger.lookup(row["tier"]))} for row in ledger.rows()]


def fill_slots(macros, drawn, exercises):
    """What stands in each slot that a chapter may hold, as HTML by name."""
    slots = {"wallclock": macros.wallclock(ledger_rows()), "figure:lanes": macros.recall()}
    slots["figure:grab"] = ""  # it stands at the top of the page
    for name, figure in drawn["figures"].items():
        if name not in ("lanes", "grab"):
            slots[f"figure:{name}"] = macros.figure(name, figure)
    for name, exercise in exercises.items():
        slots[f"exercise:{name}"] = macros.exercise(exercise)
    for kind in ("bench", "stress"):
        for path in sorted((ROOT / "curriculum" / kind).rglob("*.svg")):
            name, figure = generated_figure(kind, path)
            slots[name] = macros.generated(figure)
    return {name: str(html) for name, html in slots.items()}


# ---- the head


def early_script(bets):
    """What must run before the first paint, so that nothing moves after it."""
    return (
        'document.documentElement.className = "js";\n'
        f"for (const id of {bets})\n"
        '  try { if (localStorage.getItem("contact-chapter:" + id)) '
        'document.documentElement.classList.add("open-" + id); } catch {}\n'
    )


def policy(*scripts):
    """The page may run these scripts and nothing else, and ask the network for nothing."""
    hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
    allowed = " ".join(f"'sha256-{each}'" for each in hashes)
    return (
        "default-src 'none'; img-src data:; font-src data:; base-uri 'none'; form-action 'none'; "
        f"worker-src blob:; style-src 'unsafe-inline'; script-src {allowed}"
    )


def stylesheet(bets):
    """The page's style, with the models' colours, the formulas' font, and what veils each bet."""
    css = (HERE / "style.css").read_text("utf-8")
    css = re.sub(r"\n\s+", "\n", re.sub(r"/\*.*?\*/\s*", "", css, flags=re.DOTALL))
    colors = "".join(f"--{model}: {color}; " for model, color in curves.COLORS.items())
    font = base64.b64encode(maths_font.FILE.read_bytes()).decode()
    face = (
        f'font-family: "{maths_font.NAME}"; src: url("data:font/woff;base64,{font}") format("woff")'
    )
    veils = "".join(
        f".js:not(.open-{name}) .veiled-{name} > .answer, .open-{name} .veiled-{name} > .veil-bar "
        "{ display: none; }\n"
        for name in bets
    )
    return f":root {{ {colors}}}\n@font-face {{ {face}; }}\n{css}{veils}"


def favicon():
    """A ball on a table."""
    return data_address(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16">'
        '<path d="M0 11h16v5H0z" fill="#888"/>'
        f'<circle cx="8" cy="6" r="5" fill="{curves.COLORS["exact"]}"/></svg>'
    )


# ---- the page


def environment(keys):
    """The templates' environment."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    repository = os.environ.get("GITHUB_REPOSITORY")
    colab = COLAB.format(repository) if repository else None
    made.globals.update(course=COURSE, colab=colab, scenes=SCENES, models=contact.MODELS)
    made.globals["keys"] = {model: Markup(key) for model, key in keys.items()}
    return made


def fill_numbers(text, draft):
    """The chapter with its numbers, and what a draft lacks of them."""
    numbers, unknown = Numbers(), []

    def number(reference):
        try:
            return numbers.text(reference[1])
        except ValueError as error:
            if not draft:
                raise
            unknown.append(f"lacks {reference[0]}: {error}")
            return "?"

    return REFERENCE.sub(number, text), unknown


def build(chapter=None, draft=False):
    """(page, missing): the page as text, and what a draft lacks, a line each.

    Raises ValueError (file:line: what) where the chapter can't be shown as it is.
    """
    text = (ROOT / prose.CHAPTER).read_text("utf-8") if chapter is None else chapter
    exercises, code = all_exercises(), panels()
    bets = [name for name, each in exercises.items() if each["choices"]]
    veils = [*bets, "puzzle"]
    data = page_data(veils)
    drawn = stills(data)
    faults = [each["error"] for each in drawn["figures"].values() if "error" in each]
    if faults and not draft:
        raise ValueError(faults[0])
    drawn["figures"] = {k: each for k, each in drawn["figures"].items() if "error" not in each}
    templates = environment(drawn["keys"])
    macros = templates.get_template("parts.html.j2").module
    filled, unknown = fill_numbers(text, draft)
    parts = prose.blocks(filled, drawn["ranges"])
    body = assemble(parts, fill_slots(macros, drawn, exercises), code, macros, bets, draft)
    title = next(
        (value[2] for kind, value in parts if kind == "heading" and value[0] == 1), "Contact"
    )
    script, early = bundle("main.js", data), early_script(veils)
    page = templates.get_template("page.html.j2").render(
        policy=policy(early, script),
        icon=favicon(),
        style=Markup(stylesheet(veils)),
        early=Markup(early),
        script=Markup(script),
        heading=Markup(re.sub(r"^\d+(\.\d+)*[:.]?\s*", "", title)),
        figures=drawn["figures"],
        contents=body.contents,
        body=Markup("\n".join(body.html)),
        objectives=[prose.inline(item) for item in load_meta()["objectives"]],
        regions=list(code.values()),
    )
    return page, faults + unknown + body.missing
