"""On what a result was measured: the machine, and the code."""

import ast
import hashlib
import io
import os
import platform
import subprocess
import tokenize
from datetime import date
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from curriculum.regions import ROOT

PACKAGES = ("numpy", "numba", "rerun-sdk", "mujoco", "pymunk", "pyb2d3", "drake", "scipy")
COMMIT = "describe --always --abbrev=10 --exclude=* --dirty=+".split()


def machine() -> dict:
    """Date, commit, processor, system and versions: texts, but for versions, {package: text}.

    Packages that are not installed are left out. The commit ends in "+" where tracked files differ
    from it, and is "unknown" without git.
    """
    return {
        "date": date.today().isoformat(),
        "commit": git(*COMMIT).strip() or "unknown",
        "cpu": processor(),
        "cores": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {
            name: found.version for name in PACKAGES for found in metadata.distributions(name=name)
        },
    }


def fingerprint(*paths) -> dict:
    """{path: 12 hexadecimal digits of its code}, of Python files; one that is not there is empty.

    `paths` are relative to the project's folder. Only what runs counts, not comments, docstrings
    and blank lines: a better word in a comment shall not make a day of measuring stale.
    """
    found = {}
    for path in paths:
        file = ROOT / path
        code = code_of(file.read_text("utf-8") if file.is_file() else "")
        found[path] = hashlib.sha256(code.encode()).hexdigest()[:12]
    return found


@lru_cache
def code_of(text: str) -> str:
    """Python source without comments, docstrings, blank lines and blanks at the ends of lines."""
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        documented = isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
        if documented and ast.get_docstring(node):
            first, last = node.body[0].lineno, node.body[0].end_lineno
            lines[first - 1 : last] = [""] * (last - first + 1)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        row, column = token.start
        if token.type == tokenize.COMMENT and lines[row - 1]:
            lines[row - 1] = lines[row - 1][:column]
    return "\n".join(line.rstrip() for line in lines if line.strip())


def git(*words) -> str:
    """What a git command prints; nothing where it fails or there is no git."""
    try:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True).stdout
    except OSError:
        return ""


def processor() -> str:
    """The name of the processor, as the system gives it."""
    try:
        info = Path("/proc/cpuinfo").read_text("utf-8")
        return info.split("model name")[1].split(":", 1)[1].split("\n")[0].strip()
    except (OSError, IndexError):
        return platform.processor() or "unknown processor"
