"""The generated numbers that the chapter quotes, and the text of a reference to one.

    python -m curriculum.quoted                    # every number that can be quoted, with its name
    python -m curriculum.quoted 'EXPRESSION|FORMAT'   # one reference, as the chapter would show it
    python -m curriculum.quoted --record           # run, and put the reference run into meta.yaml

A reference stands in the text in double braces and is replaced by a number of a fresh run:

    {{quality.penalty.rest_penetration_frac|.5f}}   metrics.json of the reference run
    {{drop-dt-0.03:quality.penalty.energy_excess|,.0f}}     of another run that meta.yaml names
    {{contact.CONTACT_MARGIN}}       a constant of contact.py; exact. and piles. are the other files
    {{contact.run_model.iters}}      the default of a function's argument
    {{bench:skip.cases}}  {{stress:maps.cells}}      results of the benchmark, of the stress report
    {{wallclock.cpu-laptop}}         the ledger: minutes, or "not yet measured"
    {{quality.penalty.max_penetration_frac / quality.lcp.max_penetration_frac|.1f}}
    {{= 1972 | year of the paper}}   a typed number, allowed for the reason given

FORMAT is Python's; a fraction needs one, a whole number or a text does not. Two more put a number
that is whole, or nearly, into words: |words says "three", |times says "three times" or "twice".
Operands are numbers or references, joined by + - * / with spaces around, taken from left to right.
A key that itself holds dots is found too. What was measured on other code than today's is followed
by "(stale: COMMAND)", the command that measures it again. And a sentence in words can be held to
the numbers by a comment that nobody sees:

    <!-- holds: quality.penalty.max_penetration_frac > 4 * quality.lcp.max_penetration_frac -->
"""

import ast
import json
import operator
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from curriculum import measured
from curriculum.common import wallclock
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = re.compile(r"\{\{(.*?)\}\}")
TYPED = re.compile(r"=\s*(.+?)\s*\|\s*(.*?)\s*")
HOLDS = re.compile(r"<!--\s*holds:\s*(.*?)\s*-->")
COMPARE = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
}
COMBINE = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
RESULTS = ("bench", "stress")  # curriculum/NAME/results/results.json
WORDS = (
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
)
NEARLY = 0.05  # a number this close to a whole one, relatively, may be put into words


def load_meta(root=ROOT):
    """meta.yaml as a dict. Raises ValueError `file:line: what` when it is not YAML."""
    import yaml

    try:
        text = (Path(root) / "meta.yaml").read_text("utf-8", "replace")
        return yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader)) or {}
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise ValueError(
            f"meta.yaml:{mark.line + 1 if mark else 1}: not YAML: {error}".replace("\n", " ")
        ) from None


def fresh_run(root, flags):
    """metrics.json and config hash of `contact.py FLAGS`, run now, in a folder of its own."""
    flags = [str(flag) for flag in flags]
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-B", "contact.py", "--no-rerun", "--out", out, *flags]
        run = subprocess.run(command, cwd=root, capture_output=True, text=True)
        if run.returncode:
            raise ValueError(f"contact.py {' '.join(flags)} fails: {run.stderr.strip()[-300:]}")
        metrics = json.loads((Path(out) / "metrics.json").read_text("utf-8"))
    return metrics, wallclock.printed_hash(run.stdout)


class Numbers:
    """Everything a text can quote. What is asked for is run or read, once; nothing else is."""

    def __init__(self, root=ROOT, runs=None):
        """`runs` by name (dicts like metrics.json) stand in for fresh ones, as in an exercise."""
        self.root, self.runs, self.config_hash = Path(root), dict(runs or {}), {}
        self.flags, self.constants, self.results = None, {}, {}

    def known_runs(self):
        """Flags by name: the runs of meta.yaml. Raises ValueError when there are none."""
        self.flags = self.flags or load_meta(self.root).get("runs")
        if not self.flags:
            raise ValueError("meta.yaml:1: no `runs`, so there is no reference run")
        return self.flags

    def reference(self):
        """The name of the reference run, the first of meta.yaml."""
        return next(iter(self.known_runs()))

    def run(self, name):
        """metrics.json of one named run."""
        if name not in self.runs:
            if name not in self.known_runs():
                raise ValueError(f"no run {name!r} in meta.yaml; known: {', '.join(self.flags)}")
            self.runs[name], self.config_hash[name] = fresh_run(self.root, self.flags[name])
        return self.runs[name]

    def run_all(self, text=None):
        """Make the runs that `text` names (without one: all), side by side on the cores."""
        wanted = [
            name
            for name in self.known_runs()
            if text is None or re.search(rf"(?<![\w-]){re.escape(name)}:", text)
        ]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(self.run, wanted))

    def value(self, expression):
        """The value of operands joined by + - * /. Raises ValueError saying what is unknown."""
        first, *rest = re.split(r" ([-+*/]) ", expression.strip())
        value = self._operand(first)
        for sign, text in zip(rest[::2], rest[1::2]):
            other = self._operand(text)
            if not (is_number(value) and is_number(other)):
                raise ValueError(f"{expression!r} reckons with what is no number: {value}, {other}")
            value = COMBINE[sign](value, other)
        return value

    def _operand(self, text):
        text = text.strip()
        space, _, key = text.partition(".")
        name, colon, in_run = text.partition(":")
        if re.fullmatch(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", text):
            return float(text)
        if space == "wallclock":
            ledger = self.root / "wallclock.csv"
            return wallclock.show(wallclock.lookup(wallclock.CHAPTER, key, ledger))
        if colon and name in RESULTS:
            return dig(self.sections(name), in_run, text)
        for file in measured.LITERATE:
            if space == Path(file).stem and (self.root / file).exists():
                return dig(self._constants(file), key, text)
        return dig(self.run(name if colon else self.reference()), in_run if colon else text, text)

    def _constants(self, file):
        """The constants of a literate file, and the defaults of its functions' arguments."""
        if file not in self.constants:
            self.constants[file] = constants((self.root / file).read_text("utf-8"))
        return self.constants[file]

    def sections(self, name):
        """The sections of one results file. Raises ValueError when there are none."""
        if name not in self.results:
            self.results[name] = measured.load(self.root / "curriculum" / name / "results")
        if not self.results[name]:
            raise ValueError(f"curriculum/{name} has no results yet: python -m curriculum.{name}")
        return self.results[name]

    def stale(self, expression):
        """{name: command} of what an expression quotes that was measured on other code."""
        found = {}
        for text in re.split(r" [-+*/] ", expression.strip()):
            name, colon, key = text.strip().partition(":")
            if colon and name in RESULTS:
                section = key.split(".")[0]
                said = self.sections(name).get(section)
                if isinstance(said, dict) and measured.is_stale(said, self.root):
                    found[f"{name}:{section}"] = command_of(said, name)
            tier = text.strip().partition("wallclock.")[2]
            if tier and tier in self.stale_tiers():
                found[f"wallclock:{tier}"] = wallclock.COMMAND
        return found

    def stale_tiers(self):
        """The tiers whose ledger row was measured on another default run, or on other code."""
        rows = [
            row
            for row in wallclock.read(self.root / "wallclock.csv")
            if row["chapter"] == wallclock.CHAPTER and row["status"] == "MEASURED"
        ]
        if not rows:
            return {}
        self.run(self.reference())
        now = wallclock.run_hash(self.config_hash.get(self.reference(), ""), self.root)
        return {row["tier"]: row for row in rows if row["config_hash"] != now}

    def text(self, reference):
        """What a reader sees in place of {{reference}}. Raises ValueError when it can't be made."""
        typed = TYPED.fullmatch(reference.strip())
        if typed and typed[2]:
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
        again = list(self.stale(expression).values())
        return f"{shown} (stale: `{again[0]}`)" if again else shown

    def holds(self, claim):
        """Whether EXPRESSION < EXPRESSION (or <= > >= ==). Raises ValueError on nonsense."""
        parts = re.split(r" (<=|>=|==|<|>) ", claim)
        if len(parts) != 3:
            raise ValueError(f"{claim!r} is not 'EXPRESSION < EXPRESSION'")
        left, right = self.value(parts[0]), self.value(parts[2])
        if not (is_number(left) and is_number(right)):
            raise ValueError(f"{claim!r} compares what is no number: {left}, {right}")
        return COMPARE[parts[1]](left, right)

    def render(self, text):
        """The text with every reference replaced. Raises ValueError at the first that can't be."""
        return REFERENCE.sub(lambda match: self.text(match[1]), text)


def is_number(value):
    """Whether it is an int or a float; True and False are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def in_words(value, form):
    """A whole number in words, "three", or as a multiple, "three times". Raises ValueError."""
    whole = round(value) if is_number(value) else -1
    if not 0 <= whole < len(WORDS) or abs(value - whole) > NEARLY * max(whole, NEARLY):
        raise ValueError(f"{value} is no whole number from 0 to {len(WORDS) - 1}, or nearly one")
    if form == "words":
        return WORDS[whole]
    return {1: "once", 2: "twice"}.get(whole, f"{WORDS[whole]} times")


def constants(text):
    """{name: value} of a module's constants, and {function: {argument: default}}, from its text.

    Values that are not literals are left out; nothing is run.
    """
    found = {}
    for node in ast.parse(text).body:
        if isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            pairs = [(target.id, node.value) for target in targets if isinstance(target, ast.Name)]
            where = found
        elif isinstance(node, ast.FunctionDef):
            last = node.args.args[len(node.args.args) - len(node.args.defaults) :]
            pairs = [(argument.arg, value) for argument, value in zip(last, node.args.defaults)]
            where = found.setdefault(node.name, {})
        else:
            continue
        for name, value in pairs:
            try:
                where[name] = ast.literal_eval(value)
            except ValueError:
                if isinstance(value, ast.Name) and value.id in found:
                    where[name] = found[value.id]
    return found


def command_of(section, name):
    """What measures a section of results again."""
    return section.get("measured", {}).get("command") or f"python -m curriculum.{name}"


def dig(value, key, whole):
    """value["a"]["b.c"][3] for the key "a.b.c.3". Raises ValueError saying what is known there."""
    parts = key.split(".") if key else []
    for cut in range(len(parts), 0, -1):
        head, rest = ".".join(parts[:cut]), ".".join(parts[cut:])
        if isinstance(value, dict) and head in value:
            return dig(value[head], rest, whole)
        if isinstance(value, (list, tuple)) and head.isdigit() and int(head) < len(value):
            return dig(value[int(head)], rest, whole)
    if parts:
        known = list(value) if isinstance(value, dict) else []
        known = range(len(value)) if isinstance(value, (list, tuple)) else known
        raise ValueError(
            f"{whole!r} is not among the generated numbers: no {key!r}; "
            f"known there: {', '.join(map(str, known)) or 'nothing'}"
        )
    return value


def leaves(tree, prefix=""):
    """(name, value) of every value in a nested dict or list."""
    if isinstance(tree, (dict, list)):
        for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            yield from leaves(value, f"{prefix}.{key}" if prefix else str(key))
    else:
        yield prefix, tree


def record(root=ROOT):
    """Put a fresh reference run into meta.yaml's block `reference_run`. Returns what changed."""
    import datetime
    import difflib
    import platform

    import numpy

    numbers = Numbers(root)
    metrics = numbers.run(numbers.reference())
    block = [
        "reference_run:",
        "  provenance: measured by `python -m curriculum.quoted --record`,",
        f"    {datetime.date.today()}, numpy {numpy.__version__}, "
        f"Python {platform.python_version()}",
        f'  config_hash: "{numbers.config_hash[numbers.reference()]}"',
        "  values:",
    ]
    block += [f"    {key}: {json.dumps(value)}" for key, value in leaves(metrics)]
    path = Path(root) / "meta.yaml"
    old = path.read_text("utf-8")
    new, found = re.subn(
        r"^reference_run:.*\n(?: .*\n)*", lambda _: "\n".join(block) + "\n", old, flags=re.MULTILINE
    )
    if found != 1:
        raise ValueError("meta.yaml:1: no block `reference_run`")
    write_whole(path, new)
    return list(
        difflib.unified_diff(
            old.splitlines(), new.splitlines(), "before", "after", n=0, lineterm=""
        )
    )


@stoppable
def main(argv=None):
    """List the numbers, show one, or record the reference run. Returns the exit status."""
    from curriculum.common.arguments import Parser

    parser = Parser(
        prog="python -m curriculum.quoted", description="The numbers that the chapter quotes."
    )
    parser.add_argument("reference", nargs="?", help="an expression; a fraction needs |FORMAT")
    parser.add_argument(
        "--record", action="store_true", help="write the reference run into meta.yaml"
    )
    args = parser.parse_args(argv)
    try:
        if args.record:
            print("\n".join(record()) or "meta.yaml already says so")
        elif args.reference:
            print(Numbers().text(args.reference))
        else:
            numbers = Numbers()
            numbers.run_all()
            for name in numbers.known_runs():
                for key, value in leaves(numbers.run(name)):
                    print(f"{name}:{key} = {json.dumps(value)}")
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
