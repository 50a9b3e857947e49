"""What to do next, printed at the end of a run as commands that can be pasted."""

import os
import shlex
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def print_next(args, argv):
    """Print the last lines of a run: how to see it, and the next exercise that is not done.

    args: the flags as contact.parse_flags gives them; argv: the words they were read from.
    """
    lines = [None if args.seeds else see(args, argv), practise()]
    print(*filter(None, lines), sep="\n")


def see(args, argv):
    """The line that says how to see the run; None where it has drawn all that can be drawn here."""
    recording = os.path.join(args.out, "contact.rrd")
    if args.rerun and os.path.exists(recording):
        return f"next, watch it: {command('-m', 'rerun', recording)}"
    if args.plot or find_spec("matplotlib") is None:
        return None
    return f"next, see it: {command(ROOT / 'contact.py', *argv, '--plot')}"


def practise():
    """The line that names the next exercise that is not done, or what comes after them."""
    from exercises.progress import next_exercise

    file = next_exercise()
    if file is None:
        return "all exercises are done; next, the questions at the end of the chapter"
    return f"next, an exercise: {command(ROOT / file)}"


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
