"""Command lines: parsing, printing, missing packages; and atomic writes of files."""

import argparse
import contextlib
import json
import math
import os
import shlex
import sys
from pathlib import Path

from curriculum import HOME

ROOT = Path(HOME)


class Parser(argparse.ArgumentParser):
    """An argument parser without abbreviations, whose errors are one line."""

    def __init__(self, **how):
        raw = argparse.RawDescriptionHelpFormatter
        super().__init__(allow_abbrev=False, formatter_class=raw, **how)

    def parse_known_args(self, args=None, namespace=None):
        for word in sys.argv[1:] if args is None else args:
            if word.endswith("=--"):  # which argparse takes for the end of the flags
                self.error(f"argument {word[:-3]}: given '--', which is no value")
        return super().parse_known_args(args, namespace)

    def error(self, message):
        self.exit(2, f"{self.prog}: error: {message}\n")


def number(kind, low, high, text):
    """Return the number of that kind, from low to high, that a flag gives."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high or (kind is int and value % 1 > 0):
        words = f"given {text[:40]!r}; allowed: {kind.__name__} from {low:g} to {high:g}"
        raise argparse.ArgumentTypeError(words)
    return kind(value)


def near(word):
    """Return a path relative to this folder if it is below it; other words unchanged."""
    below = os.path.isabs(word) and Path(word).is_relative_to(Path.cwd())
    return os.path.relpath(word) if below else word


def command(*words, bring=()):
    """Return a command for the Python that is running, quoted for this system's shell.

    bring: uv's words for further packages, such as ("--extra", "page").
    """
    uv = ("uv", "run", *bring, "python")
    return quoted(*(uv if "UV" in os.environ else (sys.executable,)), *words)  # uv run sets it


def quoted(*words):
    """Return the words as one line for this system's shell, with short paths."""
    words = [near(str(word)) for word in words]
    if os.name != "nt":
        return shlex.join(words)
    import subprocess  # slow, so only where it is needed

    return subprocess.list2cmdline(words)


def to_install(package, extra=None):
    """Return a line that tells how to install a missing package, or the extra that has it."""
    wanted = ("-e", f"{near(str(ROOT))}[{extra}]") if extra else (package,)
    bring = ("--extra", extra) if extra else ("--with", package)
    words = sys.orig_argv[1:] if "UV" in os.environ else ("-m", "pip", "install", *wanted)
    return f"{package} is missing; install it: {command(*words, bring=bring)}"


@contextlib.contextmanager
def needs(extra):
    """Exit with a line on how to install it where a package is missing within."""
    try:
        import numpy  # noqa: F401  # first, or contact.py names it without the extra

        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if not package or (ROOT / package).exists() or (ROOT / f"{package}.py").exists():
            raise  # a slip of our own
        print(to_install(package, extra), file=sys.stderr)
        sys.exit(2)


def one_thread():
    """A context in which BLAS takes one thread, where threadpoolctl is installed; then as before.

    A second thread gains nothing on matrices of our sizes. Commands limit it before numpy loads
    (curriculum/__init__.py); this is for an interactive Python, a notebook, a test.
    """
    if os.environ.get("OPENBLAS_NUM_THREADS") == "1":
        return contextlib.nullcontext()
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return contextlib.nullcontext()
    return threadpool_limits(1, "blas")


def write_atomic(path, content):
    """Replace the file at `path`, whole or not at all; make missing folders.

    content: str or bytes. What is no regular file (/dev/null, a pipe) is written into. Raises
    OSError that names the file. contact.py has its own, since it runs without this folder.
    """
    data = content.encode() if isinstance(content, str) else content
    path = Path(os.path.realpath(path))
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not path.is_file():
            path.write_bytes(data)
        else:
            temporary.write_bytes(data)
            temporary.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, near(str(path))) from None
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def write_json(path, data):
    """Write strict JSON, whole or not at all. Raises ValueError on NaN and infinity."""
    write_atomic(path, json.dumps(data, indent=1, sort_keys=True, allow_nan=False) + "\n")
