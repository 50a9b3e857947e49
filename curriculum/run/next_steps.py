"""What to do next, printed at the end of a run as commands that can be pasted."""

import os
from importlib.util import find_spec

from curriculum.commands import ROOT, command
from exercises.kit.progress import practise


def print_next(args, argv: list[str]) -> None:
    """Print the last lines of a run: how to see it, and the next exercise that is not done.

    args: the flags as contact.parse_flags gives them; argv: the words they were read from.
    """
    lines = [see(args, argv), practise()]
    print(*filter(None, lines), sep="\n")


def see(args, argv: list[str]) -> str | None:
    """The line that says how to see the run; None where it has drawn all that can be drawn here."""
    recording = os.path.join(args.out, "contact.rrd")
    if args.rerun and os.path.exists(recording):
        return f"next, watch it: {command('-m', 'rerun', recording)}"
    if args.plot or find_spec("matplotlib") is None:
        return None
    return f"next, see it: {command(ROOT / 'contact.py', *argv, '--plot')}"
