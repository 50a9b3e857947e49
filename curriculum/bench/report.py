"""What the pages share: checked sentences, goals met or missed, tables and numbers in Markdown.

A sentence of reading is a Claim: it carries the condition it stands on, and where the data do not
bear it out, the other sentence is printed instead. Pages are made from results.json alone.
"""

import math
from typing import NamedTuple, Optional

from curriculum.bench import store


class Claim(NamedTuple):
    """`said` where it holds, `instead` where it does not: never `said` without its condition."""
    holds: bool
    said: str
    instead: str

    def __str__(self):
        return self.said if self.holds else self.instead


class Goal(NamedTuple):
    """A number to reach, what was measured, and whether that reaches it (None: not measured)."""
    wanted: str
    measured: str
    met: Optional[bool]

    def verdict(self):
        return {None: "not measured", True: "met", False: "**missed**"}[self.met]


def goal_table(goals):
    return table(["goal", "measured", ""], [[g.wanted, g.measured, g.verdict()] for g in goals])


def page(title, command, section, *parts):
    """A generated page: its parts, with what made it above and the machine below."""
    return "\n\n".join([f"# {title}", f"Written by `{command}`; do not edit.",
                        *(str(part).rstrip() for part in parts if part), "---",
                        store.footer(section)]) + "\n"


def sentences(claims):
    return " ".join(map(str, claims))


def table(head, rows):
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def number(value, digits=3):
    """A number with so many significant digits, never in a form like 1e+03; "-" for None."""
    if value is None:
        return "-"
    if value == 0 or math.isinf(value):
        return f"{value:g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if -3 <= int(exponent) < 5:
        return f"{value:.{max(0, digits - 1 - int(exponent))}f}"
    return f"{mantissa}e{int(exponent)}"


def ms(seconds, digits=3):
    """A time in milliseconds, without the unit."""
    return number(None if seconds is None else 1e3 * seconds, digits)


def spread(times, digits=2):
    """(least to greatest), in milliseconds."""
    return f"({ms(times['min'], digits)} to {ms(times['max'], digits)})"


def listed(items):
    """a, b and c."""
    items = list(items)
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))
