"""The page's JavaScript: modules joined into one script without globals, by their imports.

A module says `import { a, b } from "./file.js";` on one line, and `export` before a const, a
function or a class. Made here are data.js, what the scripts know from the Python files; contact.js,
the steps of contact.py (curriculum/page/to_js.py); and figures.js, {name: figure} of all files in
figures/. lit.js is lit-html, and in a script that makes text text.js.
"""

import functools
import json
import posixpath
import re
from graphlib import TopologicalSorter
from pathlib import Path

from py_mini_racer import JSEvalException, MiniRacer

import contact
from curriculum.page.to_js import to_js
from curriculum.source import ROOT

HERE = Path(__file__).resolve().parent
USED = (  # of contact.py, beside the steps
    "flights solve_impacts critical_dt "
    "soft_defaults implicit_step contact_target CONTACT_MARGIN time_to_impact"
).split()
IMPORT = re.compile(r'^import \{ ([^}]+) \} from "([./\w-]+)";$', re.MULTILINE)
EXPORT = re.compile(r"^export (const|function\*?|class) ([\w$]+)", re.MULTILINE)
LISTED = re.compile(r"\bexport\s*\{([^}]+)\};")  # as lit-html says what it exports


def source(path, data):
    """Return the text of the module at `path`, seen from this folder."""
    if path == "data.js":
        return f"export const data = {json.dumps(data, sort_keys=True)};\n"
    if path == "contact.js":
        return contact_js()
    if path != "figures.js":
        return (HERE / path).read_text("utf-8")
    names = sorted(file.stem for file in (HERE / "figures").glob("*.js"))
    imports = [
        f'import {{ figure as figure{k} }} from "./figures/{name}.js";\n'
        for k, name in enumerate(names)
    ]
    held = ", ".join(f'"{name}": figure{k}' for k, name in enumerate(names))
    return "".join(imports) + f"export const figures = {{ {held} }};\n"


@functools.cache
def contact_js():
    """The steps of contact.py, what exact and the figures use of it, and the implicit spring."""
    steps = {name: model.step.__name__ for name, model in contact.MODELS.items() if model.step}
    files = [ROOT / name for name in ("contact.py", "curriculum/variants.py")]
    table = ", ".join(f"{name}: {step}" for name, step in steps.items())
    made = to_js([*steps.values(), *USED], *files)
    table = f"export const STEP = {{ {table} }};\n"
    return f'import {{ $ }} from "./python.js";\n{made}{table}'


def target(path, address):
    """The module that `address` means in the module `path`."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), address))


def module(path, text):
    """A module as a function that is called once and keeps what it exports."""

    def imported(match):
        names = match[1].replace(" as ", ": ")
        return f'const {{ {names} }} = modules["{target(path, match[2])}"];'

    listed = LISTED.search(text)
    names = [name for _, name in EXPORT.findall(text)]
    for each in listed[1].split(",") if listed else []:
        own, _, called = each.strip().partition(" as ")
        names.append(f"{called}: {own}" if called else own)
    held = ", ".join(names)
    body = EXPORT.sub(r"\1 \2", IMPORT.sub(imported, LISTED.sub("", text)))
    return f'modules["{path}"] = (() => {{\n{body}return {{ {held} }};\n}})();\n'


def bundle(start, data, lit="lit-html.js"):
    """One script: `start` and all that it imports, each module before those that need it."""
    texts, needs, paths = {}, {}, [start]
    for path in paths:
        if path not in texts:
            text = source(path, data).replace("./lit.js", f"./{lit}")
            texts[path] = text
            needs[path] = [target(path, address) for _, address in IMPORT.findall(text)]
            paths += needs[path]
    order = TopologicalSorter(needs).static_order()
    joined = "".join(module(path, texts[path]) for path in order)
    head = '"use strict";\nconst modules = {};\n'
    return f'(() => {{\n{head}{joined}return modules["{start}"];\n}})()'


def evaluate(start, data, call):
    """What `call` of a module gives in an embedded V8: of the page's own code, without a page.

    Raises ValueError at what it throws, with the module where it does.
    """
    engine, script = MiniRacer(), bundle(start, data, "text.js")
    try:
        engine.eval(f"const made = {script};")
        return json.loads(engine.eval(f"JSON.stringify(made.{call})"))
    except JSEvalException as error:
        told = str(error).partition("\n")[0]
        place = re.match(r"<anonymous>:(\d+): |", told)
        above = "\n".join(script.split("\n")[: int(place[1] or 0)])
        path = ["", *re.findall(r'^modules\["(.*)"\] = ', above, re.MULTILINE)][-1]
        raise ValueError(f"curriculum/page/{path}: {told.removeprefix(place[0])}") from None
    finally:
        engine.close()  # its thread would keep Python from ending
