"""Stored results: tables, the machine that measured them, and hashes of the code that made them.

A folder of results holds tables, NAME.csv, and made.json, {part: origin()}. A stamp is {source:
hash}; a source is a file, or a region of contact.py, contact.py#sweep. The hash is one of the
syntax: comments, docstrings and layout do not count. The ledger, wallclock.csv, has the time of a
default run by machine; its config_hash is that of a stamp.
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
PACKAGES = "numpy numba rerun-sdk mujoco-core pymunk pyb2d3 drake dartpy rapier3d scipy".split()
ALWAYS = "curriculum/exact.py", "curriculum/compiled/run.py"  # optional modules of contact.py
MAKES = re.compile(r"curriculum/(bench|stress|compiled|exact|variants|page/to_js)\b")  # numbers
USES = re.compile(r"\bcontact\.(\w+)|from contact import (.*)")
OF_PYTHON = re.compile(r"\w+=\[\], |(, )?\w+=\[\]|, (ctx=\w+\(\)|kind='u')")  # which one dumps it
LEDGER = ROOT / "wallclock.csv"
TIMES = "python -m curriculum.bench processes --tier"  # and the name of the machine
TIMED = ("contact.py", "curriculum/show/picture.py", "curriculum/show/recording.py")


def stamp(*sources) -> dict:
    """Return {source: 12 hexadecimal digits} of today's code; a missing file counts as empty."""
    code = {r.source: r.code for r in split(read_text("contact.py"), "contact.py")[0]}
    return {each: digits(each, code.get(each) or read_text(each)) for each in sources}


def changed(kept: dict) -> list:
    """Return the sources of a stamp whose code has changed since."""
    now = stamp(*kept)
    return [source for source, was in kept.items() if now[source] != was]


def digest(value) -> str:
    """Return 12 hexadecimal digits of any value that JSON can hold."""
    return hashlib.sha256(json.dumps(value).encode()).hexdigest()[:12]


@cache
def digits(source, text) -> str:
    """Return the hash of a source's text. Help texts in LIMITS of contact.py do not count."""
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
    """Return the sources of what these files measure: the files, the modules that they import and
    that make numbers, and the regions of contact.py that all these use, directly or not."""
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
    """Return ({NAME: [row]} of the tables of a folder, made.json). An empty cell is None."""
    tables = {}
    for path in sorted(Path(ROOT, folder).glob("*.csv")):
        rows = csv.DictReader(path.read_text("utf-8").splitlines(True))
        tables[path.stem] = [{name: value(cell) for name, cell in row.items()} for row in rows]
    return tables, json.loads(read_text(f"{folder}/made.json") or "{}")


@cache
def value(cell):
    """Return the number or text of a cell."""
    try:
        return ast.literal_eval(cell)
    except (SyntaxError, ValueError):
        return cell or None


def save(path, rows) -> None:
    """Write rows, dicts with the same keys, as a table; None and NaN or inf become empty cells."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0])
    for row in rows:
        cells = [f"{x:.6g}" if isinstance(x, float) else x for x in row.values()]
        writer.writerow(["" if cell in ("nan", "inf", "-inf") else cell for cell in cells])
    write_atomic(path, text.getvalue())


def origin(command: str, *files, kept=True) -> dict:
    """Return the origin of results: command, date, commit, machine, versions and stamp.

    Call it before measuring. files: the modules that measure. Raises ValueError for results that
    are to be stored (`kept`) while code is not committed.
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
    """Return the output of a git command, or nothing where it fails or git is missing."""
    try:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
    except OSError:
        return ""
    return done.stdout.strip()


def lines(rows) -> str:
    """Return the rows of a Markdown table."""
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in rows)


def footer(about: dict) -> str:
    """Return a paragraph for the end of a page: command, date, commit, machine, versions."""
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    return (
        f"Measured by `{about['command']}` on {about['date']} at commit {about['commit']}, on "
        f"{about['cores']} cores of {about['cpu']} ({about['os']}), with Python {about['python']}, "
        f"{versions}."
    )


def write_block(name: str, markdown: str) -> None:
    """Write the Markdown of "bench" or "stress" into the README, between its markers."""
    block = re.compile(rf"(<!-- generated: {name} by .*? -->\n).*?(?=<!-- end -->)", re.DOTALL)
    text = block.sub(lambda match: f"{match[1]}{markdown.strip()}\n", read_text("README.md"))
    write_atomic(ROOT / "README.md", text)


def ledger() -> list:
    """Return the rows of the ledger, dicts of str."""
    return list(csv.DictReader(LEDGER.read_text("utf-8").splitlines()))


def taken(row) -> str:
    """Return a row's time as text with two digits, in seconds below a minute."""
    minutes = float(row["wallclock_min"])
    return f"{minutes:.2g} min" if minutes >= 1 else f"{60 * minutes:.2g} s"


def stale(row) -> bool:
    """Return whether a row was measured on other code than today's."""
    return row["config_hash"] not in ("", digest(stamp(*TIMED)))


def enter(tier: str, about: dict, seconds: float) -> None:
    """Write a row of the ledger: the time of a default run on the machine named `tier`."""
    rows = {row["tier"]: row for row in ledger()}
    facts = "ch3.5-contact", tier, f"{seconds / 60:.3g}", digest(stamp(*TIMED))
    rows[tier] = dict(zip(ledger()[0], (*facts, about["commit"], about["date"], "MEASURED")))
    save(LEDGER, list(rows.values()))
