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
from curriculum.lesson.regions import ROOT

REFERENCE = re.compile(r"\s*\{\{\?\s*((?s:.*?))\s*\}\}|\{\{(.*?)\}\}")  # a claim, or what is shown
OPERAND = re.compile(r"(?<![\w.])[A-Za-z][^\s()]*")  # begins with a letter: 1e-9 is none
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
FORMULA = re.compile(r"[\d.e+\-*/()\s]+")  # of numbers and signs alone
CLAIM = re.compile(rf"{FORMULA.pattern}( (<=?|>=?|==) {FORMULA.pattern})+")
MADE_BY = ("contact.py", "curriculum/*.py", "curriculum/lesson/*.py", "curriculum/gate/facts.py")
KEPT = ROOT / ".cache"  # what the code gave; git ignores it, and it may be deleted at any time


class TextError(ValueError):
    """What somebody wrote and can mend, in one line. Any other error is our own."""


@cache
def load_meta() -> dict:
    """meta.yaml. Raises TextError, which says where, when it is not YAML."""
    try:
        with open(ROOT / "meta.yaml", encoding="utf-8") as file:
            return {"region_hashes": {}, "read": {}} | yaml.safe_load(file)
    except yaml.YAMLError as error:
        raise TextError(f"meta.yaml is not YAML: {' '.join(str(error).split())}") from None


@cache
def made_by() -> dict:
    """The stamp of the code that makes numbers."""
    files = sorted(str(path.relative_to(ROOT)) for each in MADE_BY for path in ROOT.glob(each))
    return stored.stamp(*files)


def cached(name: str, inputs, make):
    """make()'s result (JSON), made anew where `inputs` or the code changed since the last time."""
    about = [inputs, made_by(), version("numpy"), sys.version]
    path = KEPT / f"{name}.json"
    with suppress(OSError, ValueError):
        known, made = json.loads(path.read_text("utf-8"))
        if known == about:
            return made
    made = make()
    with suppress(OSError):  # a folder that cannot be written costs time, and no number
        write_whole(path, json.dumps([about, made]))
    return made


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


class Numbers:
    """Everything that a text can quote. What is asked for is run or read, once; nothing else is."""

    def __init__(self, runs=None):
        """`runs` by name (dicts like metrics.json) stand in for fresh ones, as in an exercise."""
        self.runs = dict(runs or {})

    def run(self, name) -> dict:
        """metrics.json of one run that meta.yaml names."""
        if name not in self.runs:
            runs = load_meta()["runs"]
            if name not in runs:
                raise TextError(f"no run {name!r} in meta.yaml; known there: {known(runs)}")
            self.runs[name] = cached(f"run-{name}", runs[name], lambda: run_contact(runs[name]))
        return self.runs[name]

    def prepare(self, text):
        """Make the runs that a text names, on all cores."""
        wanted = [name for name in load_meta()["runs"] if f"{name}:" in text]
        made_by()  # and kept: Python 3.11 cannot parse in two threads at once
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(self.run, wanted))

    def operand(self, text):
        """What one name stands for: a number, a text, or a dict of them."""
        name, _, key = text.rpartition(":")
        if text.startswith("contact."):
            name, key = "contact", text.removeprefix("contact.")
            tree = {name: value for name, value in vars(contact).items() if name.isupper()}
            tree["Settings"] = contact.Settings()._asdict()
        elif name == "fact":
            fact, _, key = key.partition(".")
            tree = cached(f"fact-{fact}", None, dig(FACTS, fact, f"fact:{fact}"))
        elif name in stored.FOLDERS:
            tables, made = stored.load(stored.FOLDERS[name])
            rows = {k: {str([*row.values()][0]): row for row in t} for k, t in tables.items()}
            tree = {"made": made} | rows
        else:
            tree = self.run(name or next(iter(load_meta()["runs"])))
        return dig(tree, key, text)

    def value(self, formula):
        """The value of one name, or of a formula of names and numbers, as Python reckons."""
        if OPERAND.fullmatch(formula):
            return self.operand(formula)

        return self.reckoned(formula, FORMULA, "has other signs than + - * / ( )")[0]

    def reckoned(self, formula, form, wrong):
        """What Python makes of a formula, and the formula in numbers."""

        def number(match):
            value = self.operand(match[0])
            if not is_number(value):
                raise TextError(f"{match[0]!r} is {str(value)[:40]!r}, no number")
            return f"({value!r})"

        numbers = OPERAND.sub(number, " ".join(formula.split()))
        if not form.fullmatch(numbers):
            raise TextError(f"{formula!r} {wrong}")
        try:
            return eval(numbers), numbers
        except (NameError, SyntaxError, TypeError, ZeroDivisionError) as error:
            raise TextError(f"{formula!r} cannot be reckoned: {error}") from None

    def text(self, reference) -> str:
        """What a reader sees in place of {{reference}}."""
        formula, _, form = (part.strip() for part in reference.partition("|"))
        if formula.startswith("="):
            if not form:
                raise TextError("a typed number needs a reason: {{= NUMBER | REASON}}")
            return formula[1:].strip()
        value = self.value(formula)
        if not (is_number(value) or isinstance(value, str)):
            raise TextError(f"{formula!r} is no number; known there: {known(value)}")
        if isinstance(value, float) and not form:
            raise TextError(f"{formula!r} is a fraction and needs a format, such as |.3f")
        try:
            text = format(value, form)
        except ValueError as error:
            raise TextError(f"{form!r} is no format of {formula!r}: {error}") from None
        return typeset(text) if is_number(value) else text

    def broken(self, claim) -> str:
        """A claim in numbers, where it is not true. It may have several signs: 1 < a < 2."""
        true, numbers = self.reckoned(claim, CLAIM, "is not 'FORMULA < FORMULA'")
        return "" if true else numbers

    def fill(self, text) -> str:
        """The text with every reference replaced."""
        self.prepare(text)
        return REFERENCE.sub(lambda match: self.text(match[2]) if match[2] else "", text)


def typeset(number: str) -> str:
    """A number as print has it: -7e-05 as −7 × 10⁻⁵."""
    mantissa, _, power = number.partition("e")
    raised = f"\u00a0×\u00a010{str(int(power)).translate(RAISED)}" if power else ""
    return mantissa.replace("-", "−") + raised


def is_number(value) -> bool:
    """Whether it is an int or a float; True and False are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def known(tree) -> str:
    """The names of what is in a tree, for a message."""
    return ", ".join(inside(tree)) or "nothing"


def inside(tree) -> dict:
    """{name: value} of what is in a dict, a list or a tuple; nothing is in anything else."""
    if isinstance(tree, (list, tuple)):
        return {str(k): each for k, each in enumerate(tree)}
    return tree if isinstance(tree, dict) else {}


def dig(tree, key: str, whole: str):
    """tree["a"]["b.c"][3] for the key "a.b.c.3"; `whole` is the reference, for the error."""
    if not key:
        return tree
    for name, value in inside(tree).items():
        if f"{key}.".startswith(f"{name}."):
            return dig(value, key[len(name) + 1 :], whole)
    raise TextError(f"{whole!r} is not there: no {key!r}; known there: {known(tree)}")
