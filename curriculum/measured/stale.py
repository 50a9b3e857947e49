"""Who decides that a result is stale: fingerprints of the code that made it.

A result keeps {name: fingerprint} of the steps and measures, and of every module of bench/ and
stress/ that its own modules import. A fingerprint is taken of the syntax tree: comments,
docstrings and formatting do not count, and neither do the words of contact.py's region `flags`,
which are help and errors. A name is a file, or a file "without" some regions.

A seal is the last line of a page, a figure, or a block of the README that a command wrote. It
is a comment: the files it was made of, and a hash of these and of the text. Who edits the text, or
changes what made it and does not write it again, breaks the seal.
"""

import ast
import hashlib
import json
import re
from collections.abc import Iterator
from functools import lru_cache

from curriculum.regions import CODE, REGION, line_at, read_text

COMMAND_LINE = ("flags", "report", "files", "main")  # regions that no step or measure stands in
LESSON = f"contact.py without {' '.join(COMMAND_LINE)}"
STEPS = (LESSON, *CODE[1:])
ROOMS = ("curriculum/bench/", "curriculum/stress/")  # of the modules that measure
SEAL = re.compile(r"<!-- sealed ([0-9a-f]{12}) from (.*) -->\n\Z")
BLOCK = re.compile(r"(<!-- generated: (\w+) by (.*?) -->)\n(.*?)(?=<!-- end -->)", re.DOTALL)
UNSEEN = ("ctx", "kind", "type_comment", "type_params")  # of a node; these differ between Pythons


def made_by(*files) -> list:
    """The names to fingerprint of a result: STEPS, these files, and what they import of ROOMS."""
    found, waiting = set(STEPS), list(files)
    while waiting:
        file = waiting.pop()
        if file not in found:
            found.add(file)
            waiting += [each for each in imported(file) if each.startswith(ROOMS)]
    return sorted(found)


def imported(file: str) -> Iterator[str]:
    """The files of this project that a file imports, at its top or within functions."""
    for node in ast.walk(ast.parse(read_text(file))):
        names = [alias.name for alias in getattr(node, "names", ()) if hasattr(alias, "name")]
        if isinstance(node, ast.ImportFrom):
            names = [node.module, *(f"{node.module}.{name}" for name in names)]
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            paths = [name.replace(".", "/") + ".py" for name in names]
            yield from (path for path in paths if read_text(path))


def fingerprint(*names) -> dict:
    """{name: 12 hexadecimal digits} of each; a file that is not there is empty."""
    return {name: digits(name, read_text(name.split(" without ")[0])) for name in names}


def digest(value) -> str:
    """12 hexadecimal digits of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(value).encode()).hexdigest()[:12]


@lru_cache
def digits(name, text) -> str:
    """The fingerprint of a file's text under that name."""
    file, _, without = name.partition(" without ")
    left_out: list = []
    words: list = []
    for region in REGION.finditer(text):
        lines = range(line_at(text, region.start()), line_at(text, region.end()) + 1)
        left_out += lines if region[1] in without.split() else ()
        words += lines if region[1] == "flags" else ()
    tree = ast.parse(text, file)
    tree.body = [node for node in tree.body if node.lineno not in left_out]
    return digest(plain(tree, set(words)))


def plain(node, words: set) -> list | str:
    """A syntax tree as lists, without docstrings, and without sentences in these lines."""
    if isinstance(node, list):
        return [plain(each, words) for each in node]
    if not isinstance(node, ast.AST):
        return repr(node)
    if isinstance(node, ast.Constant) and node.lineno in words and " " in str(node.value):
        return "words"
    fields = {name: each for name, each in ast.iter_fields(node) if name not in UNSEEN}
    if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
        fields["body"] = node.body[1:]
    kept = {name: plain(each, words) for name, each in fields.items() if each not in (None, [])}
    return [type(node).__name__, kept]


def changed(code: dict) -> list:
    """The names whose fingerprint is no longer that of a result's {name: fingerprint}."""
    now = fingerprint(*code)
    return [name for name, was in code.items() if now[name] != was]


def seal_of(text: str, sources) -> str:
    """12 hexadecimal digits of a text and of the files that it was made of."""
    code = fingerprint(*(name for name in sources if name.endswith(".py")))
    data = [read_text(name) for name in sources if not name.endswith(".py")]
    return digest([text, code, data])


def sealed(text: str, *sources) -> str:
    """The text with its seal; sources are files of the project."""
    text = text.rstrip("\n") + "\n"
    return f"{text}<!-- sealed {seal_of(text, sources)} from {' '.join(sources)} -->\n"


def holds(text: str) -> bool:
    """Whether a text has its seal and is what was written, of what is there today."""
    seal = SEAL.search(text)
    return seal is not None and seal[1] == seal_of(text[: seal.start()], seal[2].split())
