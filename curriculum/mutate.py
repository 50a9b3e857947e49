"""How strong the tests are: small faults put into the code, one at a time, and what notices them.

    python -m curriculum.mutate                             contact.py and three of curriculum/
    python -m curriculum.mutate contact.py                  one file
    python -m curriculum.mutate contact.py --sample 200     so many of its mutants, drawn by --seed
    python -m curriculum.mutate contact.py --only lcp_step  those in functions of that name
    python -m curriculum.mutate contact.py --trust          all but those that have a reason
    python -m curriculum.mutate contact.py --named          those that have a reason
    python -m curriculum.mutate contact.py --list           the mutants, without running any

A mutant is the file with one operator, number, condition or call changed. It is killed when a test
fails or does not end, of those that run the changed function. Tests that compare hashes of the
text, or look at pages, are left out, since they would notice any change. A survivor is either named
in curriculum/equivalent_mutants.txt, with the reason why nothing can notice it, or it is a hole in
the tests. A mutant that has a reason and is killed refutes it. The report is
curriculum/stress/results/mutation.md, and the numbers are the section "mutation" of the results
there; --only and --named write none. What was found is kept in outputs, to go on from.

Each mutant runs in a forked process in a copy of the repository. Forking needs Linux or macOS.
mutmut 3 changes neither constants of a module nor decorated functions, and the twin is made of
these; cosmic-ray starts Python and pytest anew for each mutant, which takes several times as long.
Exit status 0: every survivor has a reason, every reason is of a survivor, and at least 95 % of the
others are killed; else 1.
"""

import argparse
import ast
import contextlib
import hashlib
import importlib
import itertools
import json
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import NamedTuple

from curriculum import measured, reporting
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable

ROOT = Path(__file__).resolve().parents[1]
TARGETS = ("contact.py", "curriculum/terminal.py", "curriculum/piles.py", "curriculum/exact.py")
EQUIVALENT = ROOT / "curriculum" / "equivalent_mutants.txt"
RESULTS = ROOT / "curriculum" / "stress" / "results"
WORK = ROOT / "outputs" / "mutate"
WANTED = 0.95
GRACE = 5.0  # processor's seconds that a test may take beyond ten times what it did before
BUDGET = 8.0  # processor's seconds of tests that one mutant is worth
TESTS = {
    "contact.py": "lcp figures faults closed_form measures skips soft next_chapter stress "
    "invariants mutants command_line recording piles soft_mujoco",
    "curriculum/terminal.py": "terminal command_line faults",
    "curriculum/piles.py": "piles",
    "curriculum/exact.py": "exact exact_parts exact_sliding closed_form mutants stress",
}
PRELOADED = (
    "numpy",
    "hypothesis",
    "pytest",
    "numba",
    "matplotlib",
    "rerun",
)  # shared by all that is forked
LEFT_OUT = (
    "test_11_every_region",
    "dask",
    "processes",
    "killed",
    "never_ends",
    "interrupted",
    "clean_run",
)
SWAPS = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"), ast.NotIn: ("not in", "in"),
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "*"), ast.Mod: ("%", "*"), ast.Pow: ("**", "*"),
    ast.And: ("and", "or"), ast.Or: ("or", "and"),
}  # fmt: skip
CALLS = {"min": "max", "max": "min", "all": "any", "any": "all", "ceil": "floor", "floor": "ceil",
         "minimum": "maximum", "maximum": "minimum"}  # fmt: skip


class Mutant(NamedTuple):
    """One change: bytes start to stop of the file become `new`. `where` is the function it is in."""

    file: str
    where: str
    line: int
    start: int
    stop: int
    new: str
    said: str  # old line -> new line, without the blanks around


# --- making mutants -------------------------------------------------------------------------------


def mutants_of(file, text):
    """Every mutant of a file, in the order of its lines."""
    return sorted(Maker(file, text).made, key=lambda m: (m.start, m.stop, m.new))


class Maker(ast.NodeVisitor):
    """Walks a file and collects its mutants in `made`."""

    def __init__(self, file, text):
        self.file, self.data, self.made, self.path = file, text.encode(), [], []
        self.starts = [0]
        for line in self.data.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.visit(ast.parse(text))

    def offset(self, node, end=False):
        """Where a node begins or ends, in bytes."""
        line, column = (
            (node.end_lineno, node.end_col_offset) if end else (node.lineno, node.col_offset)
        )
        return self.starts[line - 1] + column

    def add(self, start, stop, new):
        """A mutant that puts `new` in place of bytes start to stop."""
        line = self.data.count(b"\n", 0, start) + 1
        low = self.starts[line - 1]
        high = max(self.data.find(b"\n", stop), stop)
        old = self.data[low:high].decode()
        now = (self.data[low:start] + new.encode() + self.data[stop:high]).decode()
        said = " -> ".join(" ".join(part.split("  #")[0].split()) for part in (old, now))
        where = ".".join(self.path) or "module"
        self.made.append(Mutant(self.file, where, line, start, stop, new, said))

    def between(self, left, right, operator):
        """Change the operator between two nodes."""
        if type(operator) not in SWAPS:
            return
        old, new = SWAPS[type(operator)]
        low, high = self.offset(left, end=True), self.offset(right)
        at = self.data.find(old.encode(), low, high)
        if at >= 0:
            self.add(at, at + len(old), new)

    def inside(self, node):
        self.path.append(node.name)
        self.generic_visit(node)
        self.path.pop()

    visit_FunctionDef = visit_ClassDef = inside

    def visit_Compare(self, node):
        for left, operator, right in zip(
            [node.left, *node.comparators], node.ops, node.comparators
        ):
            self.between(left, right, operator)
        self.generic_visit(node)

    def visit_BinOp(self, node):
        if not is_text(node.left):
            self.between(node.left, node.right, node.op)
        self.generic_visit(node)

    def visit_BoolOp(self, node):
        for left, right in zip(node.values, node.values[1:]):
            self.between(left, right, node.op)
        self.generic_visit(node)

    def visit_AugAssign(self, node):
        self.between(node.target, node.value, node.op)
        self.generic_visit(node)

    def visit_AnnAssign(self, node):
        if node.value is not None:
            self.visit(node.value)

    def visit_arguments(self, node):
        for default in [*node.defaults, *filter(None, node.kw_defaults)]:
            self.visit(default)

    def visit_UnaryOp(self, node):
        if isinstance(node.op, (ast.USub, ast.Not)):
            low = self.offset(node)
            self.add(low, low + (1 if isinstance(node.op, ast.USub) else len("not ")), "")
        self.generic_visit(node)

    def visit_Constant(self, node):
        if isinstance(node.value, bool):
            self.add(self.offset(node), self.offset(node, end=True), str(not node.value))
        elif isinstance(node.value, (int, float)) and math.isfinite(node.value):
            new = node.value + 1 if isinstance(node.value, int) or node.value == 0.0 else None
            new = repr(new if new is not None else 1.1 * node.value)
            self.add(self.offset(node), self.offset(node, end=True), new)

    def visit_Call(self, node):
        name = node.func
        word = name.id if isinstance(name, ast.Name) else getattr(name, "attr", "")
        if word in CALLS:
            stop = self.offset(name, end=True)
            self.add(stop - len(word), stop, CALLS[word])
        self.generic_visit(node)

    def visit_Expr(self, node):
        if isinstance(node.value, ast.Call):
            self.add(self.offset(node), self.offset(node, end=True), "pass")
        self.generic_visit(node)

    def visit_JoinedStr(self, node):
        pass  # what is printed is not mutated

    def visit_Break(self, node):
        self.add(self.offset(node), self.offset(node, end=True), "pass")

    visit_Continue = visit_Break

    def negate(self, node):
        if not isinstance(node.test, (ast.Compare, ast.UnaryOp, ast.Constant)):
            low, high = self.offset(node.test), self.offset(node.test, end=True)
            self.add(low, high, f"not ({self.data[low:high].decode()})")
        self.generic_visit(node)

    visit_If = visit_IfExp = visit_While = negate


def is_text(node):
    """Whether + or % on this node makes a text."""
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def names_of_module_line(text, line):
    """Names that the module-level statement on this line defines, and the functions using them."""
    tree = ast.parse(text)
    defined = {
        name.id
        for statement in tree.body
        if statement.lineno <= line <= statement.end_lineno
        for name in ast.walk(statement)
        if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
    }
    return {
        function.name
        for function in ast.walk(tree)
        if isinstance(function, (ast.FunctionDef, ast.ClassDef))
        and any(isinstance(n, ast.Name) and n.id in defined for n in ast.walk(function))
    }


# --- which tests run what -------------------------------------------------------------------------


NOTE = "getattr(__import__('sys'), 'noted', set()).add('{}')"


def noting(text):
    """The file with a first statement in each function that notes in sys.noted that it runs."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            at = 0 if ast.get_docstring(node) is None else 1
            node.body[at:at] = ast.parse(NOTE.format(node.name)).body
    return ast.unparse(tree)


class Watcher:
    """A pytest plugin: for each test its seconds, its outcome, and the functions that it ran.

    A test that runs contact.py as a process of its own is taken to run main.
    """

    def __init__(self):
        self.found = {}

    def pytest_collection_modifyitems(self, items):
        items[:] = [item for item in items if not any(word in item.nodeid for word in LEFT_OUT)]

    def pytest_runtest_setup(self, item):
        sys.noted = {"main"} if "run_script" in item.fixturenames else set()
        self.found[item.nodeid] = {"seconds": -time.process_time(), "passed": True}

    def pytest_runtest_logreport(self, report):
        entry = self.found[report.nodeid]
        entry["passed"] &= not report.failed
        if report.when == "teardown":
            entry["seconds"] += time.process_time()
            entry["ran"] = sorted(sys.noted)


class Limiter:
    """A pytest plugin: ends the process when a test takes too long, and notes which test runs.

    It is the processor's time that is limited, so a busy machine ends nothing.
    """

    def __init__(self, found, path):
        self.found, self.path = found, path

    def pytest_runtest_setup(self, item):
        allowed = time.process_time() + GRACE + 10 * self.found[item.nodeid]["seconds"]
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(allowed), resource.RLIM_INFINITY))
        self.path.write_text(item.nodeid)


def run_tests(folder, arguments, plugin):
    """pytest's exit status in `folder`, in this process."""
    import pytest

    os.chdir(folder)
    sys.path[:] = [str(folder), *(entry for entry in sys.path if entry not in ("", str(ROOT)))]
    os.environ |= {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "Agg"}
    sys.dont_write_bytecode = True
    for name in [n for n in sys.modules if n.split(".")[0] in ("contact", "curriculum", "checks")]:
        del sys.modules[name]
    options = ["-q", "-p", "no:cacheprovider", "--assert=plain"]
    if os.environ.get("NUMBA_DISABLE_JIT") == "1":
        import numba

        numba.config.DISABLE_JIT = 1  # it may have been imported before
        options += ["-W", "ignore::RuntimeWarning"]  # of numpy's scalars, which numba does not have
    return int(pytest.main([*options, *arguments], plugins=[plugin]))


def watch_tests(file, tests, folder):
    """{test: what Watcher found} of the tests in one file of tests that pass before any change."""

    def watched():
        sys.noted = set()
        watcher = Watcher()
        run_tests(folder, [tests], watcher)
        write_whole(str(path), json.dumps(watcher.found))
        return 0

    path = folder / "watched.json"
    path.unlink(missing_ok=True)
    text = (folder / file).read_text("utf-8")
    (folder / file).write_text(noting(text), "utf-8")
    finish(start(watched, folder / "log.txt"), 1800)
    (folder / file).write_text(text, "utf-8")
    if not path.exists():
        raise SystemExit(f"{tests} does not run: {(folder / 'log.txt').read_text()}")
    found = json.loads(path.read_text("utf-8"))
    failing = [test for test, entry in found.items() if not entry["passed"]]
    if failing:
        print(f"left out, since they fail before any change: {', '.join(failing)}", file=sys.stderr)
    return {test: entry for test, entry in found.items() if entry["passed"]}


def test_files(file, folder):
    """The test files of a target that are there."""
    names = [f"curriculum/tests/test_{name}.py" for name in TESTS[file].split()]
    return [name for name in names if (folder / name).exists()]


def tests_for(mutant, text, found):
    """The tests to try on a mutant: those that run its function, until they add up to BUDGET.

    The quick ones come first, and those that run few functions beside it.
    """
    functions = set(mutant.where.split("."))
    if mutant.where == "module":
        functions = names_of_module_line(text, mutant.line) or {"main"}
    ran = [test for test, entry in found.items() if functions & set(entry["ran"])]
    ran.sort(key=lambda test: found[test]["seconds"] * len(found[test]["ran"]))
    spent = itertools.accumulate(found[test]["seconds"] for test in ran)
    return [test for test, seconds in zip(ran, spent) if seconds < BUDGET]


# --- processes ------------------------------------------------------------------------------------


def start(work, log):
    """Fork a process group that does work() and exits with what it returns; its id."""
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child:
        return child
    try:
        os.setsid()
        out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(out, 1)
        os.dup2(out, 2)
        status = work()
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def finish(child, seconds):
    """The exit status of a child, None when it did not end in time and was ended."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            code = os.waitstatus_to_exitcode(status)
            return None if code == -signal.SIGXCPU else code
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def copy_of_the_repository(folder):
    """The files that git knows, and new ones, in `folder`."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\n")
    for name in filter(None, listed):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)


def try_mutant(mutant, data, tests, found, folder):
    """("killed", "late" or "survived", the last test that ran); late: it did not end."""
    path, last = folder / mutant.file, folder / "last.txt"
    last.unlink(missing_ok=True)
    path.write_bytes(data[: mutant.start] + mutant.new.encode() + data[mutant.stop :])
    seconds = 120 + 20 * sum(found[test]["seconds"] for test in tests)
    try:
        limiter = Limiter(found, last)
        child = start(lambda: run_tests(folder, ["-x", *tests], limiter), folder / "log.txt")
        status = finish(child, seconds)
    finally:
        path.write_bytes(data)
    outcome = "late" if status is None else "killed" if status else "survived"
    return outcome, last.read_text() if last.exists() else None


# --- a run ----------------------------------------------------------------------------------------


class Trials:
    """Tries the mutants of one file. What was found is kept in outputs.

    A mutant stays killed while the code and the test that killed it are the same; of one that
    survived only tests in files that have changed since are tried. Which test killed a mutant is
    remembered beyond that: it is the first to be tried on it again, and on its neighbours.
    """

    def __init__(self, file, folder):
        self.folder, self.data = folder, (folder / file).read_bytes()
        name = WORK / file.replace("/", "-")
        self.kept = measured.Cells(f"{name}.jsonl", code=(file,))
        self.killers = measured.Cells(f"{name}-killers.jsonl", code=())
        self.found, self.digests = {}, {}
        for tests in test_files(file, folder):
            self.digests[tests] = digest_of(folder, tests)
            key = f"{tests} {self.digests[tests]}"
            if key not in self.kept:
                self.kept[key] = watch_tests(file, tests, folder)
            watched = self.kept[key].items()
            self.found |= {test: one for test, one in watched if one["seconds"] < BUDGET}
        self.check_unchanged(Mutant(file, "module", 1, 0, 0, "", "nothing"))

    def check_unchanged(self, nothing):
        """Without any change every test passes, or nothing could be said of a mutant."""
        no_hurry = {test: {"seconds": 60.0} for test in self.found}  # numba may have to compile
        outcome, failed = try_mutant(nothing, self.data, list(no_hurry), no_hurry, self.folder)
        if outcome != "survived":
            log = (self.folder / "log.txt").read_text()[-3000:]
            raise SystemExit(f"{nothing.file} without any change: {outcome} by {failed}\n{log}")

    def likely(self, mutant, tests):
        """The test that killed this mutant before, and the last ones that killed its neighbours."""
        near = [
            test
            for words, test in self.killers.found.items()
            if words.startswith(f"{mutant.where}: ")
        ]
        near.append(self.killers.found.get(words_of(mutant)))
        last_first = dict.fromkeys(reversed(near))
        return [test for test in last_first if test in tests][:4]

    def outcome(self, mutant):
        """ "killed", "late", "survived" or "untested"."""
        key = f"{mutant.start}-{mutant.stop} {mutant.new}"
        outcome, killer, seen = self.kept[key] if key in self.kept else ("untested", None, [])
        if killer in self.digests.values():
            return outcome
        tests = tests_for(mutant, self.data.decode(), self.found)
        new = [test for test in tests if self.digest_at(test) not in seen]
        outcome, killer = "survived" if tests else "untested", None
        for some in (self.likely(mutant, new), new):
            if some and outcome == "survived":
                outcome, last = try_mutant(mutant, self.data, some, self.found, self.folder)
                if last and outcome != "survived":
                    killer = self.digest_at(last)
                    self.killers[words_of(mutant)] = last
        alive = outcome in ("survived", "untested")
        self.kept[key] = [outcome, killer, list(self.digests.values()) if alive else []]
        return outcome

    def digest_at(self, test):
        """The digest of the file that a test is in."""
        return self.digests[test.split("::")[0]]


def words_of(mutant):
    """What a mutant is called in the files."""
    return f"{mutant.where}: {mutant.said}"


def run_file(file, chosen, folder, trust):
    """[[where, line, said, outcome]] of the chosen mutants of a file, in the order of its lines.

    trust: those that have a reason are not tried, and taken to survive.
    """
    trials, named, rows = Trials(file, folder), reasons(), []
    chosen = sorted(chosen, key=lambda m: f"{file}: {words_of(m)}" in named)  # these take longest
    with measured.progress(len(chosen), f"mutants of {file}") as tick:
        for mutant in chosen:
            untried = trust and f"{file}: {words_of(mutant)}" in named
            outcome = "survived" if untried else trials.outcome(mutant)
            rows.append([mutant.where, mutant.line, mutant.said, outcome])
            tick(mutant.where)
    return sorted(rows, key=lambda row: row[1])


def digest_of(folder, tests):
    """Digits that change when this file of tests does: what was killed may then not be."""
    data = (folder / "curriculum/tests/conftest.py").read_bytes() + (folder / tests).read_bytes()
    return hashlib.sha256(data).hexdigest()[:6]


def reasons():
    """{"file: where: old -> new": why nothing can notice it}, from equivalent_mutants.txt."""
    found = {}
    if EQUIVALENT.exists():
        lines = EQUIVALENT.read_text("utf-8").splitlines()
        entries = [line for line in lines if line.strip() and not line.startswith("#")]
        for change, why in zip(entries[::2], entries[1::2]):
            found[change.strip()] = why.strip()
    return found


def outdated(files):
    """The changes that have a reason and are no mutants of these files any more."""
    made = {
        f"{file}: {words_of(mutant)}"
        for file in files
        for mutant in mutants_of(file, (ROOT / file).read_text("utf-8"))
    }
    return [change for change in reasons() if change.split(":")[0] in files and change not in made]


def section_of(rows_by_file, known, sizes):
    """The section "mutation" of results.json."""

    def why(file, row):
        return known.get(f"{file}: {row[0]}: {row[2]}")

    found = {}
    for file, rows in rows_by_file.items():
        alive = [row for row in rows if row[3] in ("survived", "untested")]
        named = [row for row in alive if why(file, row)]
        killed = len(rows) - len(alive)
        found[file] = {
            "mutants": sizes[file],
            "tried": len(rows),
            "killed": killed,
            "late": sum(row[3] == "late" for row in rows),
            "equivalent": len(named),
            "share": killed / max(1, len(rows) - len(named)),
            "between": wilson(killed, len(rows) - len(named)),
            "code": measured.code_hash(file),
            "named": [[*row[:3], why(file, row)] for row in named],
            "refuted": [row for row in rows if why(file, row) and row not in named],
            "survivors": [row for row in alive if row not in named],
        }
    return {"files": found}


def wilson(killed, tried):
    """Where the share of all mutants lies, to 95 %, when so many of a sample are killed (Wilson)."""
    tried, z2 = max(1, tried), 1.96**2
    share = killed / tried
    middle = (share + z2 / (2 * tried)) / (1 + z2 / tried)
    half = math.sqrt(z2 * (share * (1 - share) + z2 / (4 * tried)) / tried) / (1 + z2 / tried)
    return [middle - half, min(1.0, middle + half)]


def page(section):
    """mutation.md."""
    files = section["files"]
    rows = [
        [
            file,
            f"{one['tried']:,} of {one['mutants']:,}",
            f"{one['killed']:,}",
            one["equivalent"],
            len(one["survivors"]),
            share_of(one),
        ]
        for file, one in files.items()
    ]
    parts = [
        "A mutant is the code with one operator, number, condition or call changed. Tests of hashes "
        f"and pages are left out, and of a mutant's tests those beyond {BUDGET:g} s. The share is of "
        "the mutants that are not equivalent; for a sample, in parentheses, where that of all lies "
        "(95 %).",
        reporting.table(["file", "tried", "killed", "equivalent", "survivors", "share"], rows),
    ]
    for file, one in files.items():
        if one["survivors"]:
            parts.append(
                f"## Survivors in {file}\n\n"
                + reporting.table(
                    ["function", "line", "change"],
                    [[where, line, f"`{said}`"] for where, line, said, _ in one["survivors"]],
                )
            )
        if one["named"]:
            parts.append(
                f"## Equivalent in {file}\n\n"
                + reporting.table(
                    ["function", "change", "why nothing can notice it"],
                    [[where, f"`{said}`", why] for where, _, said, why in one["named"]],
                )
            )
    return reporting.page("Mutants: how strong the tests are", section, *parts)


def share_of(one):
    """The share that was killed, with its interval when not all mutants were tried."""
    said = f"{100 * one['share']:.1f} %"
    if one["tried"] == one["mutants"]:
        return said
    low, high = (100 * end for end in one["between"])
    return f"{said} ({low:.1f} to {high:.1f} %)"


def parse(argv):
    """The checked command line."""
    from curriculum.common.arguments import Parser, number

    parser = Parser(prog="python -m curriculum.mutate", description="How strong the tests are.")
    parser.add_argument("files", nargs="*", metavar="FILE", help=", ".join(TARGETS))
    parser.add_argument("--sample", type=number(int, low=1), help="try so many of each file")
    parser.add_argument("--seed", type=number(int, low=0), default=0, help="draws the sample (0)")
    parser.add_argument("--only", metavar="NAME", help="only mutants in functions of this name")
    parser.add_argument("--trust", action="store_true", help="do not try those with a reason")
    parser.add_argument("--named", action="store_true", help="only those with a reason")
    parser.add_argument("--list", action="store_true", help="list the mutants, run none")
    parser.add_argument("--out", type=Path, default=RESULTS, help=argparse.SUPPRESS)
    args = parser.parse_args(argv)
    args.files = args.files or list(TARGETS)
    unknown = [file for file in args.files if file not in TARGETS]
    if unknown:
        parser.error(f"argument FILE: given {unknown[0]!r}; allowed: {', '.join(TARGETS)}")
    return args


def choose(file, args):
    """(all mutants of a file, those to try)."""
    every = mutants_of(file, (ROOT / file).read_text("utf-8"))
    chosen = [m for m in every if args.only is None or args.only in m.where.split(".")]
    if args.named:
        named = reasons()
        chosen = [m for m in chosen if f"{file}: {words_of(m)}" in named]
    if args.sample is not None and args.sample < len(chosen):
        chosen = random.Random(args.seed).sample(chosen, args.sample)
    return every, sorted(chosen, key=lambda m: (m.start, m.new))


@stoppable
def main(argv=None):
    """Returns the exit status."""
    args = parse(argv)
    chosen, sizes = {}, {}
    for file in args.files:
        every, chosen[file] = choose(file, args)
        sizes[file] = len(every)
    if args.list:
        for file, mutants in chosen.items():
            for m in mutants:
                print(f"{file}:{m.line}: {m.where}: {m.said}")
        return 0
    for name in PRELOADED:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    rows = {}
    with tempfile.TemporaryDirectory(prefix="mutate-") as folder:
        copy_of_the_repository(Path(folder))
        for file in args.files:
            # A mutant of the compiled loops need not be compiled to be wrong.
            os.environ["NUMBA_DISABLE_JIT"] = str(int(file == "curriculum/piles.py"))
            rows[file] = run_file(file, chosen[file], Path(folder), args.trust)
    section = section_of(rows, reasons(), sizes)
    if args.only is None and not args.named:
        command = ["python -m curriculum.mutate", *(sys.argv[1:] if argv is None else argv)]
        save(args.out, section, " ".join(command))
    old = outdated(args.files)
    for change in old:
        print(f"equivalent_mutants.txt: the code has changed, there is no such mutant: {change}")
    return 1 if old else show(section["files"])


def save(out, section, command):
    """Write the results and the report; other files' results stay while their code is the same."""
    before = measured.load(out).get("mutation", {}).get("files", {})
    kept = {f: one for f, one in before.items() if one["code"] == measured.code_hash(f)}
    section["files"] = {**kept, **section["files"]}
    saved = measured.save(out, "mutation", section, command, code=tuple(section["files"]))
    write_whole(str(out / "mutation.md"), page(saved))


def show(files):
    """Print survivors, refuted reasons and shares; 1 when there are any or too few are killed."""
    bad = False
    for file, one in files.items():
        refuted = one.get("refuted", [])  # results kept from before may lack it
        for where, line, said, outcome in refuted:
            print(f"{file}:{line}: {where}: {outcome}, though it has a reason: {said}")
        for where, line, said, outcome in one["survivors"]:
            print(f"{file}:{line}: {where}: {outcome}: {said}")
        print(
            f"{file}: {one['killed']} of {one['tried']} killed, {one['equivalent']} equivalent, "
            f"{len(one['survivors'])} survivors: {share_of(one)}"
        )
        few = one["tried"] > one["equivalent"] and one["share"] < WANTED
        bad |= few or bool(one["survivors"]) or bool(refuted)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
