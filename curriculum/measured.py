"""Measured results: where they are kept, on what they were measured, and whether they still hold.

    python -m curriculum.measured           # every results file, its date, and what is stale
    python -m curriculum.measured --check   # the same, with exit status 1 when anything is stale

Benchmark and stress report keep their results in a file `results.json` with one section per
command. Beside its numbers a section says how they came to be, under the key "measured":

    command     what measures it again
    date, commit, changed     when, at which commit, and whether the files differed from it
    code        {literate file: hash}, of every file whose behaviour was measured
    processor, cores, system, architecture, python, versions      on what

A section is stale when a file in `code` no longer has that hash. The hash is that of the code
alone: a comment, a docstring or a blank line may change without a day of measuring again.
"""

import argparse
import ast
import hashlib
import importlib.metadata
import io
import json
import math
import os
import platform
import subprocess
import sys
import tokenize
from contextlib import contextmanager
from datetime import date
from functools import lru_cache
from pathlib import Path

from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable

ROOT = Path(__file__).resolve().parents[1]
LITERATE = ("contact.py", "curriculum/exact.py", "curriculum/piles.py")
FOLDERS = ("curriculum/bench/results", "curriculum/stress/results")  # what the repository keeps
NAME = "results.json"
DIGITS = 6  # significant digits that a results file keeps


# the code that was measured


@lru_cache(maxsize=32)
def code_of(text: str) -> str:
    """Python source without what does not run: comments, docstrings, blank lines, trailing blanks."""
    lines = text.splitlines()
    for first, last in _docstrings(ast.parse(text)):
        lines[first - 1 : last] = [""] * (last - first + 1)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        row, column = token.start
        if token.type == tokenize.COMMENT and lines[row - 1]:
            lines[row - 1] = lines[row - 1][:column]
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _docstrings(tree):
    """First and last line of every docstring."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(
            node
        ):
            yield node.body[0].lineno, node.body[0].end_lineno


def code_hash(name: str, root: Path = ROOT):
    """12 hexadecimal digits of the code in one file of the repository, None where there is none."""
    path = Path(root) / name
    if not path.exists():
        return None
    return hashlib.sha256(code_of(path.read_text("utf-8")).encode()).hexdigest()[:12]


def stale_files(section: dict, root: Path = ROOT) -> list:
    """The files whose code is no longer what this section measured; ["unknown"] if it does not say."""
    code = section.get("measured", {}).get("code")
    if not code:
        return ["unknown"]
    return [name for name, was in code.items() if code_hash(name, root) != was]


def is_stale(section: dict, root: Path = ROOT) -> bool:
    """Whether any code that this section measured has changed since."""
    return bool(stale_files(section, root))


def stale_note(section: dict, root: Path = ROOT) -> str:
    """One sentence for a page when the section is stale, an empty text when it is not."""
    files = stale_files(section, root)
    if not files:
        return ""
    about = section.get("measured", {})
    when = f" on {about['date']}" if "date" in about else ""
    what = "the code" if files == ["unknown"] else listed(files)
    again = f"; to measure again: `{about['command']}`" if "command" in about else ""
    return f"**Stale**: {what} has changed since this was measured{when}{again}."


def listed(items) -> str:
    """a, b and c."""
    items = [str(item) for item in items]
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))


# results files


def load(folder) -> dict:
    """{section: results} of the file in `folder`, {} where there is none yet."""
    path = Path(folder) / NAME
    return json.loads(path.read_text("utf-8")) if path.exists() else {}


def save(folder, name: str, section: dict, command: str, code=LITERATE, packages=()) -> dict:
    """Put one section into the results file of `folder`, whole or not at all; returns it as read back.

    command: what measures this section again, as a reader types it. code: the literate files that
    were measured. packages: names on PyPI whose versions matter, beside numpy.
    """
    about = {"command": command, **provenance(code, packages)}
    sections = {**load(folder), name: {"measured": about, **section}}
    write_whole(str(Path(folder) / NAME), text(sections))
    return load(folder)[name]


def provenance(code=LITERATE, packages=()) -> dict:
    """When, from which code and on which machine: the part of "measured" that is no command."""
    versions = {}
    for package in ("numpy", *packages):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = None
    hashes = {name: code_hash(name) for name in code}
    return {
        "date": date.today().isoformat(),
        **_commit(code),
        "code": hashes,
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "architecture": platform.machine(),
        "python": platform.python_version(),
        "versions": versions,
    }


def footer(section: dict) -> str:
    """One paragraph for the end of a page: date, commit, machine and versions of a section."""
    about = section["measured"]
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items() if number)
    commit = f"commit {about['commit']}" if about["commit"] else "no commit known"
    changed = " with uncommitted changes" if about["changed"] else ""
    short = " A quick run, on reduced settings: not for quoting." if section.get("quick") else ""
    return (
        f"Measured on {about['date']} at {commit}{changed}, on {about['cores']} cores of "
        f"{about['processor']} ({about['system']}, {about['architecture']}), with Python "
        f"{about['python']}, {versions}. Code measured: "
        + ", ".join(f"{name} {digits}" for name, digits in about["code"].items() if digits)
        + f".{short}"
    )


def text(value, level: int = 0) -> str:
    """Strict JSON to be kept in git: several lines three levels deep, one line for what is below.

    Floats have six significant digits; what is not finite becomes null.
    """
    if not isinstance(value, (dict, list, tuple)) or level > 3 or _is_flat(value):
        line = json.dumps(plain(value), allow_nan=False)
    else:
        items = (
            [f"{json.dumps(str(key))}: {text(item, level + 1)}" for key, item in value.items()]
            if isinstance(value, dict)
            else [text(item, level + 1) for item in value]
        )
        indent = "\n" + " " * (level + 1)
        opening, closing = "{}" if isinstance(value, dict) else "[]"
        line = opening + indent + ("," + indent).join(items) + "\n" + " " * level + closing
    return line if level else line + "\n"


def _is_flat(value):
    items = value.values() if isinstance(value, dict) else value
    return not any(isinstance(item, (dict, list, tuple)) for item in items)


def plain(value):
    """`value` as strict JSON has it: numpy numbers unpacked, floats rounded, not finite as None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
    return value


def _processor():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown processor"


def _commit(code):
    """Short hash of the commit, and whether the measured files differed from it."""

    def git(*words):
        run = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
        return run.stdout.strip() if run.returncode == 0 else None

    try:
        commit = git("rev-parse", "--short=10", "HEAD")
        return {"commit": commit, "changed": bool(git("status", "--porcelain", "--", *code))}
    except OSError:  # no git
        return {"commit": None, "changed": None}


# raw cells, so that a long measurement can go on where it stopped


class Cells:
    """Finished cells of a long measurement, one JSON line each, in a file outside the repository.

    `cells[key] = value` writes a line at once, so that a run which is stopped loses one cell at
    most; `key in cells` and `cells[key]` find it again in the next run. A file that was written
    for other code, or for other settings (`about`, any JSON), is started anew.
    """

    def __init__(self, path, code=LITERATE, about=None):
        self.path = Path(path)
        head = {"code": {name: code_hash(name) for name in code}, "about": plain(about)}
        lines = self._read()
        self.found = dict(lines[1:]) if lines and lines[0] == head else {}
        kept = [head, *([key, value] for key, value in self.found.items())]
        write_whole(str(self.path), "".join(json.dumps(line) + "\n" for line in kept))

    def _read(self):
        """The lines that are whole; a torn end, of a run that was killed, is left out."""
        lines = []
        try:
            for line in self.path.read_text("utf-8").splitlines():
                lines.append(json.loads(line))
        except (OSError, ValueError):
            pass
        return lines

    def __contains__(self, key):
        return key in self.found

    def __getitem__(self, key):
        return self.found[key]

    def __setitem__(self, key, value):
        self.found[key] = json.loads(json.dumps(value))
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps([key, self.found[key]]) + "\n")

    def __len__(self):
        return len(self.found)


# how far it is


@contextmanager
def progress(total: int, title: str):
    """`with progress(n, "piles") as tick: ... tick("12 balls")`: a bar on a terminal, else nothing.

    `tick(label, done=1)` counts `done` finished cells. The bar is tqdm's; where that is not
    installed there is none.
    """
    try:
        from tqdm import tqdm
    except ImportError:
        yield lambda label="", done=1: None
        return
    with tqdm(total=total, desc=title, leave=False, disable=None) as bar:

        def tick(label="", done=1):
            bar.set_postfix_str(str(label), refresh=False)
            bar.update(done)

        yield tick


def all_sections(root: Path = ROOT):
    """(file, section name, section) of every results file that the repository keeps."""
    for folder in FOLDERS:
        for name, section in load(Path(root) / folder).items():
            yield f"{folder}/{NAME}", name, section


@stoppable
def main(argv=None) -> int:
    """List the results and say what is stale. Returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m curriculum.measured", description="Which measured results still hold."
    )
    parser.add_argument("--check", action="store_true", help="exit 1 when a section is stale")
    args = parser.parse_args(argv)
    stale = 0
    for file, name, section in all_sections():
        section = section if isinstance(section, dict) else {}
        files, about = stale_files(section), section.get("measured", {})
        stale += bool(files)
        state = (
            f"stale ({listed(files)}), measure again: {about.get('command')}" if files else "holds"
        )
        print(f"{file}: {name}, measured on {about.get('date', 'an unknown day')}: {state}")
    return 1 if args.check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
