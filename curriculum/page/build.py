"""Collect chapter, code, numbers and figures, and write the page. Same inputs, same bytes."""

import base64
import hashlib
import json
import os
import re
from urllib.parse import quote
from xml.etree import ElementTree

import jinja2
from markupsafe import Markup

import contact
from curriculum import stored
from curriculum.page import chapter
from curriculum.page.bundle import HERE, bundle, evaluate
from curriculum.page.exercises import all_exercises
from curriculum.page.panels import IDEAS, panel
from curriculum.prose.chapter import CHAPTER
from curriculum.prose.references import fill
from curriculum.show import picture
from curriculum.source import ROOT, read_all

SCENES = ("drop", "bounce", "stack")  # of the figures: balls in one column
OWN = ("damping", "restitution")  # of a scene
EARLY = 'document.documentElement.className = "js"'  # before the first paint
FACES = (  # name, file, kind, style, weight: how they were cut, their licenses say
    ("Chapter Maths", "maths.woff", "woff", "normal", 400),
    ("Chapter Text", "text-regular.woff2", "woff2", "normal", 400),
    ("Chapter Text", "text-italic.woff2", "woff2", "italic", 400),
    ("Chapter Text", "text-bold.woff2", "woff2", "normal", 700),
)
COLAB = "https://colab.research.google.com/github/{}/blob/gh-pages/contact.ipynb"


def page_data():
    """What the scripts know from the Python files, the module data.js."""
    usual, scenes = contact.Settings(), {name: contact.build_scene(name) for name in SCENES}
    knobs = {name: value for name, value in usual._asdict().items() if type(value) in (int, float)}
    return {
        "models": list(contact.MODELS),
        "taken": {model: contact.MODELS[model].knobs for model in contact.STEPPED},
        "scenes": {
            name: {"start": scene.q0[1].tolist(), "own": {key: getattr(scene, key) for key in OWN}}
            for name, scene in scenes.items()
        },
        "radius": contact.RADIUS,
        "solimp": contact.SOLIMP,
        "defaults": knobs
        | {"dt": contact.parse_flags([]).dt, "impedance": contact.SOLIMP[1]}
        | {name: getattr(scenes["drop"], name) for name in OWN},
    }


def draw_slots(slots):
    """Return what the figure of each slot (name, {quantity: value}) shows first, or its error."""
    return evaluate("still.js", page_data(), f"stills({json.dumps(slots)})")


def slot_errors(slots):
    """Return what is wrong with each slot NAME?quantity=value of a figure, or ""."""
    return [shown.get("error", "") for shown in draw_slots([*map(chapter.asked, slots)])]


# ---- what stands in the slots


def base64_of(content):
    """Bytes as text."""
    return base64.b64encode(content).decode()


def drawn_by(kind, name):
    """The picture NAME that bench or stress has drawn, as the template wants it."""
    [path] = (ROOT / "curriculum" / kind / "results").glob(f"*{name}.svg")
    text = path.read_text("utf-8")
    root = ElementTree.fromstring(text)
    _, _, width, height = root.get("viewBox").split()
    held = quote(" ".join(text.split()), safe=" <>=/:;,'()")  # a quarter shorter than base64
    source = Markup(f"data:image/svg+xml,{held}")
    return {"alt": root.findtext("{*}title"), "src": source, "width": width, "height": height}


# ---- the page


def named(script):
    """A script as the page's policy allows it, which allows no other."""
    return f"'sha256-{base64_of(hashlib.sha256(script.encode()).digest())}'"


def environment(**held):
    """The templates' environment; its macros know what is held."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    repository = os.environ.get("GITHUB_REPOSITORY")
    colab = COLAB.format(repository) if repository else None
    faces = [
        (name, Markup(f"data:font/{kind};base64,{base64_of((HERE / file).read_bytes())}"), *rest)
        for name, file, kind, *rest in FACES
    ]
    made.globals.update(colab=colab, faces=faces, models=[*contact.MODELS])
    made.globals.update(stored=stored, picture=picture, drawn_by=drawn_by, **held)
    made.globals.update(panel=panel, ideas=IDEAS, folded=chapter.FOLDED)
    return made


def build():
    """The page of the chapter, of which curriculum.gate tells all that can't be shown. Raises
    ValueError at a figure that can't be drawn."""
    text = (ROOT / CHAPTER).read_text("utf-8")
    end = ("heading", (2, "colophon", "Colophon")), ("colophon", ())
    parts = [*chapter.blocks(fill(text)), *end]
    slots = [values for kind, values in parts if kind == "figure"]
    figures = dict(zip([id for id, *_ in slots], draw_slots([slot for _, *slot in slots])))
    for error in (shown["error"] for shown in figures.values() if "error" in shown):
        raise ValueError(f"{CHAPTER}: {error}")
    templates = environment(figures=figures, exercises=all_exercises(), regions=read_all())
    macros = templates.get_template("parts.html.j2").module
    titles = {id: figure["title"] for id, figure in figures.items()}
    body, ((_, _, title), *contents) = chapter.assemble(parts, macros, titles)
    script = bundle("main.js", page_data())
    return templates.get_template("page.html.j2").render(
        allowed=[named(EARLY), named(script)],
        style=Markup((HERE / "style.css").read_text("utf-8")),
        early=Markup(EARLY),
        script=Markup(script),
        heading=Markup(re.sub(r"^\d+(\.\d+)*[:.]?\s*", "", title)),
        contents=contents,
        body=body,
    )
