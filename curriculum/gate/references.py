"""Numbers by reference: {{FORMULA|FORMAT}} becomes a number of a fresh run.

    {{quality.penalty.rest_penetration_frac|.5f}}   metrics.json of the reference run
    {{drop-dt-0.03:quality.lcp.energy_excess|.2g}}  of another run that meta.yaml names
    {{contact.CONTACT_MARGIN}}  {{contact.Settings.iters}}    a constant, a default
    {{stress:TABLE.FIRST_CELL.COLUMN}}  {{bench:made.piles.date}}     results, by row and column
    {{fact:jump.before}}                            a small measured fact, curriculum/gate/facts.py
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
from functools import cache
from importlib.metadata import version
from pathlib import Path

import yaml

import contact
from curriculum import stored
from curriculum.commands import write_whole
from curriculum.gate.facts import FACTS
from curriculum.lesson.regions import ROOT, read_text

REFERENCE = re.compile(r"\s*\{\{\?\s*((?s:.*?))\s*\}\}|\{\{(.*?)\}\}")  # a claim, or what is shown
OPERAND = re.compile(r"(?<![\w.])[A-Za-z][^\s()]*")  # begins with a letter: 1e-9 is none
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
FORMULA = re.compile(r"[\d.e+\-*/()<=>\s]+")  # of numbers and signs alone
MADE_BY = "contact.py", "curriculum/seeds.py", "curriculum/gate/facts.py"  # and what they import
KEPT = ROOT / ".cache"  # what the code gave; git ignores it, and it may be deleted at any time


class TextError(ValueError):
    """What somebody wrote and can mend, in one line. Any other error is our own."""


@cache
def load_meta() -> dict:
    """meta.yaml. Raises TextError, which says where, when it is not YAML."""
    try:
        return {"region_hashes": {}, "read": {}} | yaml.safe_load(read_text("meta.yaml"))
    except yaml.YAMLError as error:
        raise TextError(f"meta.yaml is not YAML: {' '.join(str(error).split())}") from None


@cache
def made_by() -> dict:
    """The stamp of the code that makes numbers."""
    return stored.stamp(*stored.made_by(*MADE_BY))


def cached(name: str, inputs, make):
    """make()'s result (JSON), made anew where `inputs` or the code changed since the last time."""
    about = [inputs, made_by(), version("numpy"), sys.version]
    path = KEPT / f"{name}.json"
    with suppress(OSError, ValueError):
        known, made = json.loads(path.read_text("utf-8"))
        if known == about:
            return made
    text = json.dumps([about, make()])
    with suppress(OSError):  # a folder that cannot be written costs time, and no number
        write_whole(path, text)
    return json.loads(text)[1]


def run_contact(flags) -> dict:
    """What `python contact.py FLAGS` measures, or many seeds where the first flag is A:B."""
    words = [str(flag) for flag in flags]
    many = ":" in "".join(words[:1])
    start, file = (["-m", "curriculum.seeds"], "seeds") if many else (["contact.py"], "metrics")
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-B", *start, *words, "--no-rerun", "--out", out]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if run.returncode:
            raise TextError(f"{' '.join(start + words)} fails: {run.stderr.strip()[-300:]}")
        return json.loads((Path(out) / f"{file}.json").read_text("utf-8"))


@cache
def known(source, fact="") -> dict:
    """{"a.b.3": number or text} of what a source holds: a run, a fact, contact.py, results."""
    if source == "contact":
        tree = vars(contact) | {"Settings": contact.Settings()._asdict()}
    elif source == "fact":
        tree = {fact: cached(f"fact-{fact}", None, pick(FACTS, fact, f"fact:{fact}"))}
    elif source in stored.FOLDERS:
        tables, made = stored.load(stored.FOLDERS[source])
        rows = {k: {str([*row.values()][0]): row for row in t} for k, t in tables.items()}
        tree = {"made": made} | rows
    else:
        flags = pick(load_meta()["runs"], source, source)
        tree = cached(f"run-{source}", flags, lambda: run_contact(flags))
    return dict(leaves(tree))


def prepare(text):
    """Make the runs that a text names, on all cores. What is asked for is made once."""
    wanted = [name for name in load_meta()["runs"] if f"{name}:" in text]
    made_by()  # and kept: Python 3.11 cannot parse in two threads at once
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(known, wanted))


def operand(name):
    """What one name stands for: a number or a text."""
    source, _, key = name.rpartition(":")
    if name.startswith("contact."):
        source, _, key = name.partition(".")
    fact = key.partition(".")[0] if source == "fact" else ""
    return pick(known(source or next(iter(load_meta()["runs"])), fact), key, name)


def reckon(formula) -> tuple:
    """What a formula is, as Python reckons, and the formula in numbers."""

    def number(match):
        value = operand(match[0])
        if type(value) not in (int, float):
            raise TextError(f"{match[0]!r} is {str(value)[:40]!r}, no number")
        return f"({value!r})"

    if OPERAND.fullmatch(formula):
        return operand(formula), formula  # which may be a text
    numbers = OPERAND.sub(number, " ".join(formula.split()))
    if not FORMULA.fullmatch(numbers):
        raise TextError(f"{formula!r} has other signs than + - * / ( ) < <= > >= ==")
    try:
        return eval(numbers), numbers
    except (NameError, SyntaxError, TypeError, ZeroDivisionError) as error:
        raise TextError(f"{formula!r} cannot be reckoned: {error}") from None


def shown(reference) -> str:
    """What a reader sees in place of {{reference}}. Raises TextError."""
    formula, _, form = (part.strip() for part in reference.partition("|"))
    if formula.startswith("=") and form:
        return formula[1:].strip()
    if formula.startswith("="):
        raise TextError(f"{formula!r}: a typed number needs a reason: {{{{= NUMBER | REASON}}}}")
    value, _ = reckon(formula)
    if type(value) not in (int, float, str):
        raise TextError(f"{formula!r} is {value}, no number")
    if isinstance(value, float) and not form:
        raise TextError(f"{formula!r} is a fraction and needs a format, such as |.3f")
    try:
        text = format(value, form)
    except ValueError as error:
        raise TextError(f"{form!r} is no format of {formula!r}: {error}") from None
    return text if isinstance(value, str) else typeset(text)


def hold(claim) -> None:
    """Raise TextError where a claim is not true. It may have several signs: 1 < a < 2."""
    true, numbers = reckon(claim)
    if true is not True:
        what = "does not hold" if true is False else "is not 'FORMULA < FORMULA'"
        raise TextError(f"{claim!r} {what}: {numbers}")


def fill(text) -> str:
    """The text with every reference replaced."""
    prepare(text)
    return REFERENCE.sub(lambda match: shown(match[2]) if match[2] else "", text)


def typeset(number: str) -> str:
    """A number as print has it: -7e-05 as −7 × 10⁻⁵."""
    mantissa, _, power = number.partition("e")
    raised = f"\u00a0×\u00a010{str(int(power)).translate(RAISED)}" if power else ""
    return mantissa.replace("-", "−") + raised


def leaves(tree, path=""):
    """Pairs ("a.b.3", value) of all that stands in dicts, lists and tuples."""
    tree = dict(enumerate(tree)) if isinstance(tree, (list, tuple)) else tree
    if not isinstance(tree, dict):
        yield path[1:], tree
    for name, each in tree.items() if isinstance(tree, dict) else ():
        yield from leaves(each, f"{path}.{name}")


def pick(table, name, asked):
    """What a table has under a name. Raises TextError, which says what is like it there."""
    if name not in table:
        near = difflib.get_close_matches(name, table, n=5, cutoff=0.0)
        raise TextError(f"{asked!r} is not there: no {name!r}; known there: {', '.join(near)}")
    return table[name]
