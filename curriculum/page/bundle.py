"""The page's JavaScript: modules joined into one script without globals, by their imports.

A module says `import { a, b } from "./file.js";` on one line, and `export` before a const, a
function or a class. Two modules are made here: data.js, what the scripts know from the Python
files, and figures.js, {name: figure} of every file in figures/.
"""

import json
import re
from pathlib import Path

HERE = Path(__file__).resolve().parent
IMPORT = re.compile(r'^import \{ ([^}]+) \} from "([./\w-]+)";$', re.MULTILINE)
# comments on lines of their own, and the blanks before a line of code
PLAIN = re.compile(r"^[ ]*//[^\n]*\n|^/\*.*?\*/\n|^[ ]+(?=[^ ])", re.M | re.S)
EXPORT = re.compile(r"^export (const|function|class) ([\w$]+)", re.MULTILINE)


def figure_names():
    """The names of the figures, sorted."""
    return sorted(path.stem for path in (HERE / "figures").glob("*.js"))


def sources(data):
    """{path: text} of all modules, by their path from this folder."""
    names = figure_names()
    imports = [f'import {{ figure as f{k} }} from "./figures/{n}.js";' for k, n in enumerate(names)]
    held = ", ".join(f"{json.dumps(name)}: f{k}" for k, name in enumerate(names))
    made = {
        "data.js": f"export const data = {json.dumps(data, sort_keys=True)};\n",
        "figures.js": "\n".join([*imports, f"export const figures = {{ {held} }};\n"]),
    }
    files = [*HERE.glob("*.js"), *(HERE / "figures").glob("*.js")]
    return made | {str(path.relative_to(HERE)): path.read_text("utf-8") for path in files}


def target(path, address):
    """The module that `address` means in the module `path`."""
    folder = "" if "/" not in path else path.rsplit("/", 1)[0]
    parts = folder.split("/") if folder else []
    for part in address.split("/"):
        if part == "..":
            parts.pop()
        elif part != ".":
            parts.append(part)
    return "/".join(parts)


def module(path, text):
    """A module as a function that is called once and keeps what it exports."""

    def imported(match):
        names = match[1].replace(" as ", ": ")
        return f'const {{ {names} }} = modules["{target(path, match[2])}"];'

    body = EXPORT.sub(r"\1 \2", IMPORT.sub(imported, PLAIN.sub("", text)))
    names = ", ".join(name for _, name in EXPORT.findall(text))
    if re.search(r"^(import|export)\b", body, re.MULTILINE):
        raise ValueError(f"curriculum/page/{path}: an import or export that is not on one line")
    return f'modules["{path}"] = (() => {{\n{body}return {{ {names} }};\n}})();\n'


def bundle(start, data):
    """One script: `start` and all that it imports, each module before those that need it."""
    texts, order = sources(data), []

    def add(path, by):
        if path in by:
            raise ValueError(f"curriculum/page/{path}: imports itself, by {' and '.join(by)}")
        if path in order:
            return
        if path not in texts:
            raise ValueError(f"curriculum/page/{by[-1]}: imports {path}, and there is no such file")
        for _, address in IMPORT.findall(texts[path]):
            add(target(path, address), (*by, path))
        order.append(path)

    add(start, ())
    joined = "".join(module(path, texts[path]) for path in order)
    if "</script" in joined.lower():
        raise ValueError("curriculum/page: the text '</script' in a module would end the script")
    head = '"use strict";\nconst modules = {};\n'
    return f'(() => {{\n{head}{joined}return modules["{start}"];\n}})()'
