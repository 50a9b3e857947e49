"""Numbers by reference: {{EXPRESSION|FORMAT}} becomes a number of a fresh run.

    {{quality.penalty.rest_penetration_frac|.5f}}   metrics.json of the reference run
    {{drop-dt-0.03:quality.lcp.energy_excess|.2g}}  of another run that meta.yaml names
    {{contact.CONTACT_MARGIN}}  {{contact.Settings.iters}}    a constant, the default of an argument
    {{bench:skip.cases}}  {{stress:maps.cells}}     results of the benchmark, of the stress report
    {{fact:tower_sweeps.20}}                        a small measured fact, curriculum/text/facts.py
    {{wallclock.cpu-laptop}}                        the ledger: minutes, or "not yet measured"
    {{a.b / c.d|.1f}}                               + - * / with blanks around, left to right
    {{= 1972 | year of the paper}}                  a typed number, with the reason why

FORMAT is Python's; a fraction needs one. |words says "three", |times "three times", of a number
that is whole or nearly. Results that were measured on other code are followed by "(stale)". A
sentence is held to the numbers by a comment: <!-- holds: quality.lcp.energy_excess < 1e-9 -->.
What cannot be made raises ValueError, which says in one line what is known instead.
"""

import importlib
import inspect
import json
import operator
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path

from curriculum.text import ledger, results
from curriculum.text.cache import cached
from curriculum.text.regions import CODE, NAME, ROOT

INCLUDE = re.compile(rf"\[include-by-region: (?P<file>[\w./-]+\.py)#(?P<name>{NAME})\]")
REFERENCE = re.compile(r"\{\{(.*?)\}\}")
TYPED = re.compile(r"=\s*(.+?)\s*\|\s*(.+?)\s*")
HOLDS = re.compile(r"<!--\s*holds:\s*(.*?)\s*-->", re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")
COMPARE = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
}
COMBINE = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
MODULES = {Path(file).stem: file.removesuffix(".py").replace("/", ".") for file in CODE}
WORDS = "zero one two three four five six seven eight nine ten eleven twelve".split()
NEARLY = 0.05  # a number this close to a whole one, relatively, may be put into words


@lru_cache(maxsize=4)
def load_meta(path=ROOT / "meta.yaml") -> dict:
    """meta.yaml. Raises ValueError `file:line: what` when it is not YAML."""
    import yaml

    try:
        return yaml.safe_load(Path(path).read_text("utf-8"))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = mark.line + 1 if mark else 1
        what = " ".join(str(error).split())
        raise ValueError(f"{Path(path).name}:{line}: not YAML: {what}") from None


def run_contact(flags) -> dict:
    """{"metrics": metrics.json, "stdout": text} of `python contact.py FLAGS`, in its own folder."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-B", "contact.py", "--no-rerun", "--out", out, *map(str, flags)]
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if run.returncode:
            words = " ".join(map(str, flags))
            raise ValueError(f"contact.py {words} fails: {run.stderr.strip()[-300:]}")
        metrics = json.loads((Path(out) / "metrics.json").read_text("utf-8"))
        return {"metrics": metrics, "stdout": run.stdout.replace(out, "OUT")}


def known_facts() -> dict:
    """{name: function} of curriculum/text/facts.py: all public ones that take nothing."""
    from curriculum.text import facts

    return {
        name: each
        for name, each in vars(facts).items()
        if inspect.isfunction(each) and each.__module__ == facts.__name__
        if name[0] != "_" and not inspect.signature(each).parameters
    }


def measure(name) -> dict:
    """One fact: what the function of this name in curriculum/text/facts.py returns."""
    known = known_facts()
    if name not in known:
        raise ValueError(f"no fact {name!r} in curriculum/text/facts.py; known: {', '.join(known)}")
    return cached(f"fact-{name}", None, known[name], (*CODE, "curriculum/text/facts.py"))


class Numbers:
    """Everything that a text can quote. What is asked for is run or read, once; nothing else is."""

    def __init__(self, runs=None):
        """`runs` by name (dicts like metrics.json) stand in for fresh ones, as in an exercise."""
        self.runs = dict(runs or {})

    def flags(self) -> dict:
        """The runs of meta.yaml, {name: flags}; the first is the reference run."""
        return load_meta()["runs"]

    def run(self, name) -> dict:
        """metrics.json of one named run."""
        if name not in self.runs:
            if name not in self.flags():
                raise ValueError(f"no run {name!r} in meta.yaml; known: {', '.join(self.flags())}")
            flags = self.flags()[name]
            made = cached(f"run-{name}", flags, lambda: run_contact(flags))
            self.runs[name] = made["metrics"]
        return self.runs[name]

    def run_all(self, text=None):
        """Make the runs and facts that `text` names (without one: all), on all cores."""
        wanted = [name for name in self.flags() if text is None or f"{name}:" in text]
        facts = set(known_facts()) if text is None else set(re.findall(r"\bfact:(\w+)", text))
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = [pool.submit(self.run, name) for name in wanted]
            for name in sorted(facts & known_facts().keys()):
                measure(name)  # one after the other, here: they share contact.py's FLOOR
            for job in jobs:
                job.result()

    def value(self, expression):
        """The value of operands joined by + - * /, from left to right."""
        first, *rest = re.split(r" ([-+*/]) ", expression.strip())
        value = self._operand(first.strip())
        for sign, text in zip(rest[::2], rest[1::2]):
            other = self._operand(text.strip())
            if not (is_number(value) and is_number(other)):
                raise ValueError(f"{expression!r} reckons with what is no number: {value}, {other}")
            if sign == "/" and other == 0:
                raise ValueError(f"{expression!r} divides by zero")
            value = COMBINE[sign](value, other)
        return value

    def _operand(self, text):
        space, _, key = text.partition(".")
        name, colon, inside = text.partition(":")
        if NUMBER.fullmatch(text):
            return float(text)
        if space == "wallclock":
            return ledger.show(ledger.lookup(key))
        if colon and name in results.FOLDERS:
            return dig(results.load(name), inside, text)
        if colon and name == "fact":
            fact, _, key = inside.partition(".")
            return dig(measure(fact), key, text)
        if space in MODULES:
            return constant(MODULES[space], key)
        run = name if colon else next(iter(self.flags()))
        return dig(self.run(run), inside if colon else text, text)

    def text(self, reference) -> str:
        """What a reader sees in place of {{reference}}."""
        typed = TYPED.fullmatch(reference.strip())
        if typed:
            return typed[1]
        if reference.strip().startswith("="):
            raise ValueError("a typed number needs a reason: {{= NUMBER | REASON}}")
        expression, _, form = (part.strip() for part in reference.partition("|"))
        value = self.value(expression)
        if not (is_number(value) or isinstance(value, str)):
            raise ValueError(f"{expression!r} is {str(value)[:40]}, no number")
        if isinstance(value, float) and not form:
            raise ValueError(f"{expression!r} is a fraction and needs a format, such as |.3f")
        shown = in_words(value, form) if form in ("words", "times") else format(value, form)
        return f"{shown} (stale)" if stale(expression) else shown

    def holds(self, claim) -> bool:
        """Whether EXPRESSION < EXPRESSION (or <= > >= ==) is true."""
        parts = re.split(r" (<=|>=|==|<|>) ", " ".join(claim.split()))
        if len(parts) != 3:
            raise ValueError(f"{claim!r} is not 'EXPRESSION < EXPRESSION'")
        left, right = self.value(parts[0]), self.value(parts[2])
        if not (is_number(left) and is_number(right)):
            raise ValueError(f"{claim!r} compares what is no number: {left}, {right}")
        return COMPARE[parts[1]](left, right)

    def fill(self, text) -> str:
        """The text with every reference replaced."""
        return REFERENCE.sub(lambda match: self.text(match[1]), text)


def fill(text: str) -> str:
    """The text with every reference replaced by a number of a fresh run."""
    return Numbers().fill(text)


def stale(expression: str) -> bool:
    """Whether an expression quotes a result, or a row of the ledger, of other code than today's."""
    for text in re.split(r" [-+*/] ", expression):
        name, _, key = text.strip().partition(":")
        if name in results.FOLDERS and results.stale(results.load(name).get(key.split(".")[0])):
            return True
        if name.startswith("wallclock.") and name.partition(".")[2] in ledger.stale_tiers():
            return True
    return False


def is_number(value) -> bool:
    """Whether it is an int or a float; True and False are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def in_words(value, form: str) -> str:
    """A whole number in words, "three", or as a multiple, "three times"."""
    whole = round(value) if is_number(value) else -1
    if not 0 <= whole < len(WORDS) or abs(value - whole) > NEARLY * max(whole, NEARLY):
        raise ValueError(f"{value} is no whole number from 0 to {len(WORDS) - 1}, or nearly one")
    if form == "words":
        return WORDS[whole]
    return {1: "once", 2: "twice"}.get(whole, f"{WORDS[whole]} times")


def constant(module: str, key: str):
    """A constant of a module, the default of an argument or of a field of a named tuple."""
    value = importlib.import_module(module)
    for part in key.split("."):
        if inspect.isfunction(value) and part in inspect.signature(value).parameters:
            value = inspect.signature(value).parameters[part].default
        elif part in getattr(value, "_field_defaults", ()):
            value = value._field_defaults[part]
        elif part.isdigit() and isinstance(value, (tuple, list)) and int(part) < len(value):
            value = value[int(part)]
        elif hasattr(value, part):
            value = getattr(value, part)
        else:
            raise ValueError(f"{module.rpartition('.')[2]}.{key}: there is no {part!r}")
    return value


def dig(value, key: str, whole: str):
    """value["a"]["b.c"][3] for the key "a.b.c.3"; `whole` is the reference, for the error."""
    parts = key.split(".") if key else []
    for cut in range(len(parts), 0, -1):
        head, rest = ".".join(parts[:cut]), ".".join(parts[cut:])
        if isinstance(value, dict) and head in value:
            return dig(value[head], rest, whole)
        if isinstance(value, list) and head.isdigit() and int(head) < len(value):
            return dig(value[int(head)], rest, whole)
    if parts:
        known = value if isinstance(value, dict) else []
        raise ValueError(
            f"{whole!r} is not among the generated numbers: no {key!r}; "
            f"known there: {', '.join(map(str, known)) or 'nothing'}"
        )
    return value
