"""On what a result was measured: the machine, and the code."""

import ast
import hashlib
import importlib.metadata
import io
import os
import platform
import subprocess
import tokenize
from datetime import date
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("numpy", "numba", "rerun-sdk", "mujoco", "pymunk", "pyb2d3", "drake", "scipy")


def machine() -> dict:
    """Date, commit, processor, system and versions: texts, but for versions, {package: text}.

    Packages that are not installed are left out. The commit ends in "+" where tracked files differ
    from it, and is "unknown" without git.
    """
    return {
        "date": date.today().isoformat(),
        "commit": commit(),
        "cpu": processor(),
        "cores": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: text for name in PACKAGES if (text := version(name))},
    }


def fingerprint(*paths, root=ROOT) -> dict:
    """{path: 12 hexadecimal digits of its code}; a file that is not there has None.

    `paths` are relative to `root`. Of Python only what runs counts, not comments, docstrings and
    blank lines: a better word in a comment shall not make a day of measuring stale.
    """
    found = {}
    for path in map(str, paths):
        file = Path(root) / path
        text = file.read_text("utf-8") if file.is_file() else None
        code = code_of(text) if text and path.endswith(".py") else text
        found[path] = None if text is None else hashlib.sha256(code.encode()).hexdigest()[:12]
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


def version(package: str):
    """The installed version of a package, None where it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def commit() -> str:
    """The short hash of the commit, "+" behind it where tracked files differ from it."""
    words = "git describe --always --abbrev=10 --exclude=* --dirty=+".split()
    try:
        return subprocess.check_output(
            words, cwd=ROOT, text=True, stderr=subprocess.DEVNULL
        ).strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def processor() -> str:
    """The name of the processor, as the system gives it."""
    try:
        info = Path("/proc/cpuinfo").read_text("utf-8")
        return info.split("model name")[1].split(":", 1)[1].split("\n")[0].strip()
    except (OSError, IndexError):
        return platform.processor() or "unknown processor"
