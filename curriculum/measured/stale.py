"""Who decides that a result is stale: fingerprints of the code that made it.

A result keeps {name: fingerprint} of the steps and measures, and of every module of bench/ and
stress/ that its own modules import. A fingerprint is taken of the syntax tree: comments,
docstrings and formatting do not count, and neither do the words of contact.py's region `flags`,
which are help and errors. A name is a file, or a file "without" some regions.
"""

import ast
import hashlib
import json
import re
from functools import lru_cache

from curriculum.lesson.regions import CODE, REGION, read_text

COMMAND_LINE = ("flags", "report", "files", "main")  # regions that no step or measure stands in
LESSON = f"contact.py without {' '.join(COMMAND_LINE)}"
STEPS = (LESSON, *CODE[1:])
STRING = re.compile(r'"[^"\n]*"')
OF_PYTHON = re.compile(r"\w+=\[\], |(, )?\w+=\[\]|, (ctx=\w+\(\)|kind='u')")  # which one dumps it


def made_by(*files) -> list:
    """The names to fingerprint: STEPS, these files, and what they import of bench/ and stress/."""
    names, waiting = set(STEPS), list(files)
    while waiting:
        if (file := waiting.pop()) not in names:
            names.add(file)
            for room, words in re.findall(r"from curriculum\.(bench|stress)(.*)", read_text(file)):
                paths = (f"curriculum/{room}/{word}.py" for word in re.findall(r"\w+", words))
                waiting += [path for path in paths if read_text(path)]
    return sorted(names)


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

    def counted(region):
        if region[1] in without.split():
            return ""
        code, words = region[0], region[1] == "flags"
        return STRING.sub(lambda s: '""' if " " in s[0] else s[0], code) if words else code

    tree = ast.parse(REGION.sub(counted, text), file)
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            node.body = node.body[ast.get_docstring(node) is not None :]
    return digest(OF_PYTHON.sub("", ast.dump(tree)))


def changed(code: dict) -> list:
    """The names whose fingerprint is no longer that of a result's {name: fingerprint}."""
    now = fingerprint(*code)
    return [name for name, was in code.items() if now[name] != was]
