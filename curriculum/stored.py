"""What was measured and is kept: tables, the machine, and a stamp of the code that made them.

A folder of results holds tables, NAME.csv, and made.json: {part: how it came to be}, as origin()
says. A stamp is {source: hash}; a source is a file, or a region of contact.py, contact.py#sweep. It
is taken of the syntax: comments, docstrings and form do not count. The ledger, wallclock.csv, has
the time of a whole default run by machine; its config_hash is that of a stamp.
"""

import ast
import csv
import hashlib
import io
import json
import os
import platform
import re
import subprocess
from datetime import date
from functools import cache
from importlib import metadata
from modulefinder import ModuleFinder
from pathlib import Path

from curriculum.commands import write_atomic
from curriculum.source import ROOT, read_text, split

FOLDERS = {"bench": "curriculum/bench/results", "stress": "curriculum/stress/results"}
PACKAGES = "numpy numba rerun-sdk mujoco-core pymunk pyb2d3 drake dartpy scipy".split()
ALWAYS = (
    "curriculum/exact.py",
    "curriculum/compiled/run.py",
)  # contact.py's optional
MAKES = re.compile(r"curriculum/(bench|stress|compiled|exact|variants|page/to_js)\b")  # numbers
USES = re.compile(r"\bcontact\.(\w+)|from contact import (.*)")
OF_PYTHON = re.compile(r"\w+=\[\], |(, )?\w+=\[\]|, (ctx=\w+\(\)|kind='u')")  # which one dumps it
LEDGER = ROOT / "wallclock.csv"
TIMES = "python -m curriculum.bench processes --tier"  # and what the ledger calls the machine
TIMED = ("contact.py", "curriculum/show/picture.py", "curriculum/show/recording.py")


def stamp(*sources) -> dict:
    """{source: 12 hexadecimal digits} as they are today; what is not there is empty."""
    code = {r.source: r.code for r in split(read_text("contact.py"), "contact.py")[0]}
    return {each: digits(each, code.get(each) or read_text(each)) for each in sources}


def changed(kept: dict) -> list:
    """The sources of a stamp that are not what they were."""
    now = stamp(*kept)
    return [source for source, was in kept.items() if now[source] != was]


def digest(value) -> str:
    """12 hexadecimal digits of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(value).encode()).hexdigest()[:12]


@cache
def digits(source, text) -> str:
    """The hash of a source's text. In LIMITS of contact.py, words are help and do not count."""
    if source.endswith(".csv"):
        return digest(text)
    tree = ast.parse(text, source)
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            node.body = node.body[ast.get_docstring(node) is not None :]
        if isinstance(node, ast.Constant) and source == "contact.py#limits":
            node.value = None if " " in str(node.value) else node.value
    return digest(OF_PYTHON.sub("", ast.dump(tree)))


def made_by(*files) -> list:
    """The sources of what these files measure: they, what makes numbers of what they import, and
    the regions of contact.py that define what these use, or what those regions use."""
    regions, _ = split(read_text("contact.py"), "contact.py")
    finder = ModuleFinder([str(ROOT)], excludes=["curriculum.stored"])
    sources = {file for file in (*files, *ALWAYS) if read_text(file)}
    for file in (file for file in sources if file.endswith(".py")):
        finder.run_script(str(ROOT / file))  # which runs nothing
    for module in map(vars, finder.modules.values()):
        if module["__file__"] and not module["__path__"]:  # no package
            sources.add(Path(module["__file__"]).relative_to(ROOT).as_posix())
    sources -= {each for each in sources - {*files} if not MAKES.match(each)}
    uses = USES.findall("".join(map(read_text, sources)))
    used = set(re.findall(r"\w+", " ".join(map(" ".join, uses))))
    while more := [r for r in regions if r.defines & used]:
        regions = [region for region in regions if region not in more]
        sources |= {region.source for region in more}
        trees = (ast.parse(region.code) for region in more)
        used |= {n.id for tree in trees for n in ast.walk(tree) if isinstance(n, ast.Name)}
    return sorted(sources)


def load(folder) -> tuple:
    """({NAME: [row]} of the tables of a folder, made.json). Numbers are numbers, "" is None."""
    tables = {}
    for path in sorted(Path(ROOT, folder).glob("*.csv")):
        rows = csv.DictReader(path.read_text("utf-8").splitlines(True))
        tables[path.stem] = [{name: value(cell) for name, cell in row.items()} for row in rows]
    return tables, made(folder)


def made(folder) -> dict:
    """{part: how it came to be} of a folder of results, its made.json."""
    return json.loads(read_text(f"{folder}/made.json") or "{}")


@cache
def value(cell):
    """What a cell of a table holds."""
    try:
        return ast.literal_eval(cell)
    except (SyntaxError, ValueError):
        return cell or None


def save(path, rows) -> None:
    """Write rows, dicts with the same names, as a table; None and what is not finite is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0])
    for row in rows:
        cells = [f"{x:.6g}" if isinstance(x, float) else x for x in row.values()]
        writer.writerow(["" if cell in ("nan", "inf", "-inf") else cell for cell in cells])
    write_atomic(path, text.getvalue())


def origin(command: str, *files, kept=True) -> dict:
    """How results come to be; to be asked before they are measured, and kept in made.json.

    command: what measures them again, as one types it. files: the modules that measure. Raises
    ValueError where the results are to be kept, and the code is not that of a commit.
    """
    info = re.search(r"model name\s*: (.+)", read_text("/proc/cpuinfo"))
    if kept and (dirty := git("status", "--porcelain", "--", "*.py", ":(glob)curriculum/*/*.csv")):
        raise ValueError(f"{command} is kept with its commit; commit these first: {dirty}")
    return {
        "command": command,
        "date": date.today().isoformat(),
        "commit": git("describe", "--always", "--abbrev=10", "--exclude=*") or "unknown",
        "cpu": info[1] if info else platform.processor() or "unknown processor",
        "cores": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {
            name: each.version for name in PACKAGES for each in metadata.distributions(name=name)
        },
        "code": stamp(*made_by(*files)),
    }


def git(*words) -> str:
    """What a git command prints; nothing where it fails or there is no git."""
    try:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    except OSError:
        return ""
    return done.stdout.strip()


def lines(rows) -> str:
    """The rows of a Markdown table."""
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def footer(about: dict) -> str:
    """One paragraph for the end of a page: when and on what it was measured."""
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    return (
        f"Measured by `{about['command']}` on {about['date']} at commit {about['commit']}, on "
        f"{about['cores']} cores of {about['cpu']} ({about['os']}), with Python {about['python']}, "
        f"{versions}."
    )


def write_block(name: str, markdown: str) -> None:
    """Put the Markdown of "bench" or "stress" into the project's README, between its markers."""
    block = re.compile(rf"(<!-- generated: {name} by .*? -->\n).*?(?=<!-- end -->)", re.DOTALL)
    text = block.sub(lambda match: f"{match[1]}{markdown.strip()}\n", read_text("README.md"))
    write_atomic(ROOT / "README.md", text)


def ledger() -> list:
    """The rows of the ledger, dicts of str."""
    return list(csv.DictReader(LEDGER.read_text("utf-8").splitlines()))


def taken(row) -> str:
    """A row's time as text, with two digits: in seconds below a minute."""
    minutes = float(row["wallclock_min"])
    return f"{minutes:.2g} min" if minutes >= 1 else f"{60 * minutes:.2g} s"


def stale(row) -> bool:
    """Whether a row was measured on other code than today's."""
    return row["config_hash"] not in ("", digest(stamp(*TIMED)))


def enter(tier: str, about: dict, seconds: float) -> None:
    """Write a row of the ledger: what a whole run takes on the machine that it calls `tier`."""
    rows = {row["tier"]: row for row in ledger()}
    facts = "ch3.5-contact", tier, f"{seconds / 60:.3g}", digest(stamp(*TIMED))
    rows[tier] = dict(zip(ledger()[0], (*facts, about["commit"], about["date"], "MEASURED")))
    save(LEDGER, list(rows.values()))
