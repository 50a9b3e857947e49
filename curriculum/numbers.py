"""The generated numbers that the chapter quotes, and the text of a reference to one.

    python -m curriculum.numbers                    # every number that can be quoted, with its name
    python -m curriculum.numbers 'EXPRESSION|FORMAT'   # one reference, as the chapter would show it
    python -m curriculum.numbers --record           # run, and put the reference run into meta.yaml

A reference stands in the text in double braces and is replaced by a number of a fresh run:

    {{quality.penalty.rest_penetration_frac|.5f}}   metrics.json of the reference run
    {{drop-dt-0.03:quality.penalty.energy_excess|,.0f}}     of another run that meta.yaml names
    {{bench.drop.exact.median|.2e}}  {{stress.cases|d}}     results.json of the benchmark, the report
    {{wallclock.cpu-laptop}}         the ledger: minutes, or "not yet measured"
    {{quality.penalty.max_penetration_frac / quality.lcp.max_penetration_frac|.1f}}
    {{= 1972 | year of the paper}}   a typed number, allowed for the reason given

FORMAT is Python's; a fraction needs one, a whole number or a text does not. Operands are numbers or
references, joined by + - * / with spaces around, taken from left to right. A key that itself holds
dots is found too. And a sentence in words can be held to the numbers by a comment that nobody sees:

    <!-- holds: quality.penalty.max_penetration_frac > 4 * quality.lcp.max_penetration_frac -->
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from curriculum.common import wallclock
from curriculum.common.files import write_whole

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = re.compile(r"\{\{(.*?)\}\}")
TYPED = re.compile(r"=\s*(.+?)\s*\|\s*(.*?)\s*")
HOLDS = re.compile(r"<!--\s*holds:\s*(.*?)\s*-->")
COMPARE = {"<": float.__lt__, "<=": float.__le__, ">": float.__gt__, ">=": float.__ge__, "==": float.__eq__}
GENERATED = {"bench": ("curriculum/bench/results.json", "python -m curriculum.bench"),
             "stress": ("curriculum/stress/results.json", "python -m curriculum.stress")}


def load_meta(root=ROOT):
    """meta.yaml as a dict. Raises ValueError `file:line: what` when it is not YAML."""
    import yaml
    try:
        return yaml.safe_load((Path(root) / "meta.yaml").read_text(encoding="utf-8")) or {}
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        raise ValueError(f"meta.yaml:{mark.line + 1 if mark else 1}: not YAML: {error.problem}") from None


def fresh_run(root, flags):
    """metrics.json and config hash of `contact.py FLAGS`, run now, in a folder of its own."""
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-B", "contact.py", "--no-rerun", "--out", out, *map(str, flags)]
        run = subprocess.run(command, cwd=root, capture_output=True, text=True)
        if run.returncode:
            raise ValueError(f"contact.py {' '.join(map(str, flags))} fails: {run.stderr.strip()[-300:]}")
        metrics = json.loads((Path(out) / "metrics.json").read_text(encoding="utf-8"))
    return metrics, run.stdout.split()[-1]


class Numbers:
    """Everything a text can quote. Runs what is asked for, once; nothing else is run or read."""

    def __init__(self, root=ROOT, runs=None):
        """`runs` by name (each a dict like metrics.json) stand in for fresh ones, as in an exercise."""
        self.root, self.runs, self.config_hash = Path(root), dict(runs or {}), {}

    def known_runs(self):
        """Flags by name: the runs of meta.yaml. The first one is the reference run."""
        self._known = getattr(self, "_known", None) or load_meta(self.root)["runs"]
        return self._known

    def run(self, name):
        """metrics.json of one named run."""
        if name not in self.runs:
            if name not in self.known_runs():
                raise ValueError(f"no run {name!r} in meta.yaml; known: {', '.join(self.known_runs())}")
            self.runs[name], self.config_hash[name] = fresh_run(self.root, self.known_runs()[name])
        return self.runs[name]

    def run_all(self, text=None):
        """Make the runs that `text` (or, without one, meta.yaml) names, as many at once as there are cores."""
        names = [n for n in self.known_runs() if text is None or re.search(rf"\b{re.escape(n)}:", text)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(self.run, names))

    def value(self, expression):
        """The value of a reference or of operands joined by + - * /. Raises ValueError saying what is unknown."""
        operands = re.split(r" ([-+*/]) ", expression.strip())
        value = self._operand(operands[0])
        for sign, operand in zip(operands[1::2], operands[2::2]):
            other = self._operand(operand)
            if None in (value, other):
                raise ValueError(f"{expression!r} meets a null")
            value = {"+": value + other, "-": value - other, "*": value * other}[sign] if sign != "/" else value / other
        return value

    def _operand(self, text):
        text = text.strip()
        if re.fullmatch(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", text):
            return float(text)
        space, _, key = text.partition(".")
        if space == "wallclock":
            return wallclock.show(wallclock.lookup(wallclock.CHAPTER, key, self.root / "wallclock.csv"))
        if space in GENERATED:
            file, command = GENERATED[space]
            if not (self.root / file).exists():
                raise ValueError(f"{file} is missing: {command}")
            return _dig(json.loads((self.root / file).read_text(encoding="utf-8")), key, text)
        name, colon, key = text.partition(":")
        return _dig(self.run(name), key, text) if colon else _dig(self.run(next(iter(self.known_runs()))), text, text)

    def text(self, reference):
        """What a reader sees in place of `{{reference}}`. Raises ValueError when it can't be made."""
        typed = TYPED.fullmatch(reference.strip())
        if typed and typed[2]:
            return typed[1]
        if typed or reference.strip().startswith("="):
            raise ValueError("a typed number needs a reason: {{= NUMBER | REASON}}")
        expression, _, form = reference.partition("|")
        value = self.value(expression)
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise ValueError(f"{expression.strip()!r} is {str(value)[:40]}, no number")
        if isinstance(value, float) and not form:
            raise ValueError(f"{expression.strip()!r} is a fraction and needs a format, such as |.3f")
        return format(value, form.strip())

    def holds(self, claim):
        """Whether `EXPRESSION < EXPRESSION` (or <= > >= ==) is true. Raises ValueError when it can't be read."""
        parts = re.split(r" (<=|>=|==|<|>) ", claim)
        if len(parts) != 3:
            raise ValueError(f"{claim!r} is not 'EXPRESSION < EXPRESSION'")
        left, right = self.value(parts[0]), self.value(parts[2])
        if not all(isinstance(side, (int, float)) for side in (left, right)):
            raise ValueError(f"{claim!r} compares what is no number: {left!r}, {right!r}")
        return COMPARE[parts[1]](float(left), float(right))

    def render(self, text):
        """The text with every reference replaced. Raises ValueError at the first that can't be."""
        return REFERENCE.sub(lambda match: self.text(match[1]), text)


def _dig(value, key, whole):
    """value["a"]["b.c"][3] for key "a.b.c.3"."""
    if not key:
        return value
    parts = key.split(".")
    for cut in range(len(parts), 0, -1):
        head, rest = ".".join(parts[:cut]), ".".join(parts[cut:])
        if isinstance(value, dict) and head in value:
            return _dig(value[head], rest, whole)
        if isinstance(value, list) and head.isdigit() and int(head) < len(value):
            return _dig(value[int(head)], rest, whole)
    known = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else []
    raise ValueError(f"{whole!r} is not among the generated numbers: no {key!r}; "
                     f"known there: {', '.join(map(str, known)) or 'nothing'}")


def leaves(tree, prefix=""):
    """(name, value) of every value in a nested dict or list."""
    if isinstance(tree, (dict, list)):
        for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
            yield from leaves(value, f"{prefix}.{key}" if prefix else str(key))
    else:
        yield prefix, tree


def record(root=ROOT):
    """Put a fresh reference run into meta.yaml's block `reference_run`. Returns the lines that changed."""
    import datetime
    import difflib
    import platform
    import numpy
    numbers = Numbers(root)
    name = next(iter(numbers.known_runs()))
    metrics = numbers.run(name)
    block = ["reference_run:",
             "  provenance: measured by `python -m curriculum.numbers --record`, "
             f"{datetime.date.today()}, numpy {numpy.__version__}, Python {platform.python_version()}",
             f"  config_hash: {numbers.config_hash[name]}", "  values:"]
    block += [f"    {key}: {json.dumps(value)}" for key, value in leaves(metrics)]
    path = Path(root) / "meta.yaml"
    old = path.read_text(encoding="utf-8")
    new, found = re.subn(r"^reference_run:.*\n(?:[ #].*\n|\n(?=[ ]))*", lambda _: "\n".join(block) + "\n", old, flags=re.M)
    if found != 1:
        raise ValueError("meta.yaml has no block reference_run")
    write_whole(path, new)
    return list(difflib.unified_diff(old.splitlines(), new.splitlines(), "before", "after", n=0, lineterm=""))


def main(argv=None):
    """List the numbers, show one, or record the reference run. Returns the exit status."""
    from curriculum.common.arguments import Parser
    parser = Parser(prog="python -m curriculum.numbers", description="The numbers that the chapter quotes.")
    parser.add_argument("reference", nargs="?", help="an expression, with |FORMAT if it is a fraction")
    parser.add_argument("--record", action="store_true", help="write the reference run into meta.yaml")
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
