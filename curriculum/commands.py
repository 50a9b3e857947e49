"""Commands as one types them here: how to run a file, how to install what is missing."""

import os
import shlex
import sys
from argparse import ArgumentTypeError
from pathlib import Path


def command(*words):
    """A command for the Python that is running, quoted for this system's shell."""
    words = [near(str(word)) for word in (sys.executable, *words)]
    if os.name != "nt":
        return shlex.join(words)
    import subprocess  # slow, so only where it is needed

    return subprocess.list2cmdline(words)


def missing(package):
    """One line that says how to install a package that is not there."""
    return f"{package} is missing; install it: {command('-m', 'pip', 'install', package)}"


def near(word):
    """A path as one would type it here: relative below this folder; other words as they are."""
    below = os.path.isabs(word) and Path(word).is_relative_to(Path.cwd())
    return os.path.relpath(word) if below else word


def number(kind, low, high):
    """An argparse type: a number of that kind, int or float, from low to high."""

    def read(text):
        try:
            value = kind(text)
        except (ValueError, OverflowError):
            value = None
        if value is None or not low <= value <= high:
            raise ArgumentTypeError(f"given {text[:40]!r}; allowed: {low:g} to {high:g}")
        return value

    return read
