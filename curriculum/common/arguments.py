"""Command lines whose errors are one line: what was given, what is allowed. Exit status 2."""

import argparse
import math
import re

from curriculum.common.files import why_unwritable


class Parser(argparse.ArgumentParser):
    """An ArgumentParser that answers bad input with one line on stderr and exit status 2.

    Options can't be abbreviated, so that a flag added later never changes what an old command
    means. "-1e-3", "-inf" and "-nan" are values, not options, so the range check sees them.
    """

    def __init__(self, *args, **kwargs):
        super().__init__(*args, allow_abbrev=False, formatter_class=help_format, **kwargs)
        self._negative_number_matcher = re.compile(r"^-\.?(\d|inf|nan)", re.IGNORECASE)

    def error(self, message):
        if message.startswith("unrecognized arguments"):
            flags = [flag for action in self._actions for flag in action.option_strings]
            message += f"; allowed: {' '.join(flags)}"
        self.exit(2, f"{self.prog}: error: {' '.join(message.split())}\n")


def help_format(prog):
    """argparse's help, 100 columns wide, so that asking the terminal costs no import.

    Lines of description and epilog stay as they were written.
    """
    return argparse.RawDescriptionHelpFormatter(prog, max_help_position=30, width=100)


def number(kind, low=None, high=None, above=None):
    """An argparse `type=` for an int or float (`kind`) with low <= value <= high, value > above.

    NaN and infinities are refused. The error says what was given and what is allowed.
    """
    limits = [
        f"{sign} {limit:g}"
        for sign, limit in ((">", above), (">=", low), ("<=", high))
        if limit is not None
    ]
    allowed = " ".join(["a whole number" if kind is int else "a number", " and ".join(limits)])

    def parse(text):
        try:
            value = kind(text)
            fits = math.isfinite(value) and not (
                (low is not None and value < low)
                or (high is not None and value > high)
                or (above is not None and value <= above)
            )
        except (ValueError, OverflowError):
            fits = False
        if not fits:
            given = text if len(text) <= 40 else text[:37] + "..."
            raise argparse.ArgumentTypeError(f"given {given!r}, allowed: {allowed.strip()}")
        return value + 0  # -0.0 becomes 0.0

    return parse


def whole_range(text):
    """An argparse `type=`: "A:B" as (A, B), whole numbers with 0 <= A < B, at most 10,000 of them."""
    first, _, last = text.partition(":")
    if not (first.isdecimal() and last.isdecimal() and 0 < int(last) - int(first) <= 10_000):
        raise argparse.ArgumentTypeError(
            f"given {text!r}, allowed: A:B, whole numbers with A < B, such as 0:20 for 0 to 19"
        )
    return int(first), int(last)


def writable_folder(text):
    """An argparse `type=`: the path of a folder that files can be written to. Makes nothing."""
    trouble = why_unwritable(text)
    if trouble:
        raise argparse.ArgumentTypeError(
            f"given {text!r}, but {trouble}; allowed: a folder that can be made and written to"
        )
    return text
