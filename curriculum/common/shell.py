"""Commands that work as printed: beside a virtual environment, in an activated one, and under uv."""

import os
import shlex
import sys


def short(path):
    """The path as one would type it here: relative below this folder, whole elsewhere."""
    near = os.path.relpath(path)
    return shlex.quote(path if near.startswith(os.pardir) else near)


def under_uv():
    """Whether `uv run` started this process: uv tells its children where it is."""
    return "UV" in os.environ or "UV_RUN_RECURSION_DEPTH" in os.environ


def first_on_path(name):
    """The program that this name starts in a shell, or None."""
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        if os.path.isfile(os.path.join(folder, name)):
            return os.path.join(folder, name)
    return None


def tool(name):
    """How to start a program that was installed beside this Python."""
    beside = os.path.join(os.path.dirname(sys.executable), name)
    if under_uv():
        return f"uv run {name}"
    if first_on_path(name) == beside or not os.path.isfile(beside):
        return name
    return short(beside)


def python(*words, extra=None):
    """How to run this Python with these words: the script comes first.

    extra: what the script needs of pyproject.toml's optional dependencies.
    """
    words = " ".join(short(word) if os.path.isabs(word) else shlex.quote(word) for word in words)
    if under_uv():
        run = f"uv run --extra {extra}" if extra else "uv run"
        return f"{run} python {words}"
    name = os.path.basename(sys.executable)
    return f"{tool(name)} {words}"


def install(package):
    """How to install packages that are missing."""
    if under_uv():
        return f"uv pip install {package}"
    return f"{python('-m', 'pip', 'install')} {package}"
