"""Numbers by reference: {{FORMULA|FORMAT}} becomes a number of a fresh run.

    {{quality.penalty.rest_penetration_frac|.5f}}   metrics.json of the reference run
    {{contact.CONTACT_MARGIN}}  {{contact.Settings.iters}}    a constant, a default
    {{drop-dt-0.03:quality.lcp.energy_excess|.2g}}  of another run that meta.yaml names
    {{jump:before}}                                 a small measured fact, curriculum/prose/facts.py
    {{stress:made.all.date}}  {{bench:piles.0.engine}}    of stored results, tables by row
    {{(a.b - c.d) / e.f|.1f}}                       + - * / and brackets, with blanks around signs
    {{= 1972 | year of the paper}}                  a typed number, with the reason why

    {{? 0.24 < quality.penalty.max_penetration_frac < 0.26}}    what its sentence says in words

FORMAT is Python's; a fraction needs one. A reference of the last kind shows nothing, and the blanks
before it go; with < <= > >= == it holds its sentence to the numbers. What cannot be made raises
TextError, which says in one line what is known instead.
"""

import difflib
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import yaml

import contact
from curriculum import stored
from curriculum.commands import write_atomic
from curriculum.prose.facts import FACTS
from curriculum.source import ROOT, read_text

# A claim may go over several lines, and the blanks before it belong to it.
REFERENCE = re.compile(r"(?:\s*(?=\{\{\?))?\{\{(\?(?s:.*?)|(?-s:.*?))\}\}")
OPERAND = re.compile(r"(?<![\w.])[A-Za-z][^\s()]*")  # begins with a letter: 1e-9 is none
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
MADE_BY = "contact.py", "curriculum/seeds.py", "curriculum/prose/facts.py"  # and what they import
KEPT = ROOT / ".cache"  # what the code gave; git ignores it, and it may be deleted at any time


class TextError(ValueError):
    """An error of the text, in one line. Any other error is one of the code."""


@cache
def load_meta() -> dict:
    """Return meta.yaml. Raises TextError, with the place, if it is not YAML."""
    try:
        return yaml.safe_load(read_text("meta.yaml"))
    except yaml.YAMLError as error:
        raise TextError(f"meta.yaml is not YAML: {' '.join(str(error).split())}") from None


@cache
def made_by() -> dict:
    """Return the hashes of the code that computes numbers."""
    return stored.stamp(*stored.made_by(*MADE_BY))


def cached(name: str, inputs, make):
    """Return make()'s result (JSON), computed again only if `inputs` or the code changed."""
    about = [inputs, made_by(), version("numpy"), sys.version]
    path = KEPT / f"{name}.json"
    with suppress(OSError, ValueError):
        known, made = json.loads(path.read_text("utf-8"))
        if known == about:
            return made
    text = json.dumps([about, make()])
    with suppress(OSError):  # a folder that cannot be written costs time, and no number
        write_atomic(path, text)
    return json.loads(text)[1]


def run_contact(flags) -> dict:
    """Return what `python contact.py FLAGS` measures, or many seeds if the first flag is A:B."""
    start = ["-m", "curriculum.seeds"] if ":" in str(flags[:1]) else ["contact.py"]
    words = [*start, *map(str, flags)]
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-B", *words, "--no-rerun", "--out", out]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if run.returncode:
            raise TextError(f"{' '.join(words)} fails: {run.stderr.strip()[-300:]}")
        return json.loads(next(Path(out).glob("*.json")).read_text("utf-8"))


@cache
def known(source) -> dict:
    """Return {"a.b.3": number or text} of a source, the word before a colon; of "", the reference
    run and contact.py."""
    runs = load_meta()["runs"]
    if source in stored.FOLDERS:
        tables, made = stored.load(stored.FOLDERS[source])
        tree = tables | {"made": made}
    elif source:
        makers = FACTS | {name: partial(run_contact, flags) for name, flags in runs.items()}
        tree = cached(source, runs.get(source), pick(makers, source, source))
    else:
        constants = vars(contact) | {"Settings": contact.Settings()._asdict()}
        tree = known(next(iter(runs))) | {"contact": constants}
    return dict(leaves(tree))


def prepare(text):
    """Run what a text names, each run once, on all cores."""
    wanted = [name for name in load_meta()["runs"] if f"{name}:" in text]
    made_by()  # and kept: Python 3.11 cannot parse in two threads at once
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(known, wanted))


def operand(match) -> str:
    """Return the value of a name in a formula, as Python writes it."""
    source, _, key = match[0].rpartition(":")
    return f"({pick(known(source), key, match[0])!r})"


def shown(reference) -> str:
    """Return the text of {{reference}} on the page, "" for a claim. Raises TextError."""
    formula, _, form = (part.strip() for part in " ".join(reference.split()).partition("|"))
    if formula.startswith("="):
        if not form:
            raise TextError(f"{formula!r} needs a reason: {{{{= NUMBER | REASON}}}}")
        return formula[1:].strip()
    numbers = OPERAND.sub(operand, formula.lstrip("? "))
    try:
        value = eval(numbers, {"__builtins__": {}})
        text = format(value, form)
    except Exception as error:  # Python's own eval may raise any
        raise TextError(f"{reference!r} cannot be made of {numbers}: {error}") from None
    if formula.startswith("?"):  # it may have several signs: 1 < a < 2
        if value is not True:
            raise TextError(f"{formula!r} does not hold: {numbers}")
        return ""
    if isinstance(value, float) and not form:
        raise TextError(f"{formula!r} is a fraction and needs a format, such as |.3f")
    if isinstance(value, str):
        return text
    mantissa, _, power = text.partition("e")  # as it is printed: -7e-05 is −7 × 10⁻⁵
    raised = f"\u00a0×\u00a010{str(int(power)).translate(RAISED)}" if power else ""
    return mantissa.replace("-", "−") + raised


def fill(text) -> str:
    """Return the text with every reference replaced."""
    prepare(text)
    return REFERENCE.sub(lambda match: shown(match[1]), text)


def leaves(tree, path=""):
    """Yield ("a.b.3", value) of every value in nested dicts, lists and tuples."""
    if isinstance(tree, (list, tuple)):
        tree = dict(enumerate(tree))
    if isinstance(tree, dict):
        for name, each in tree.items():
            yield from leaves(each, f"{path}{name}.")
    else:
        yield path[:-1], tree


def pick(table, name, asked):
    """Return table[name]. Raises TextError with similar names if there is none."""
    if name not in table:
        near = difflib.get_close_matches(name, table, n=5, cutoff=0.0)
        raise TextError(f"{asked!r} is not there: no {name!r}; known there: {', '.join(near)}")
    return table[name]
