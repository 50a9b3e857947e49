"""How a generated page is written: numbers, tables, checked sentences, goals, in Markdown.

Benchmark and stress report use it alike. A page is made from its results section alone, so that
the same results always give the same text. A sentence about the results is a `Claim`, which
carries the condition it stands on; where that fails, the other sentence is printed instead.
"""

import math
from typing import NamedTuple

from curriculum import measured
from curriculum.measured import listed  # part of this vocabulary too

__all__ = [
    "Claim",
    "Goal",
    "goal_table",
    "listed",
    "ms",
    "number",
    "page",
    "sentences",
    "spread",
    "table",
]


class Claim(NamedTuple):
    """`said` where it holds, `instead` where it does not."""

    holds: bool
    said: str
    instead: str = ""

    def __str__(self):
        return self.said if self.holds else self.instead


class Goal(NamedTuple):
    """A number to reach, what was measured, and whether that reaches it (None: not measured)."""

    wanted: str
    measured: str
    met: bool | None

    def verdict(self) -> str:
        return {None: "not measured", True: "met", False: "**missed**"}[self.met]


def goal_table(goals) -> str:
    """A table of goals, one row each, with met or missed at the end."""
    return table(["goal", "measured", ""], [[g.wanted, g.measured, g.verdict()] for g in goals])


def page(title: str, section: dict, *parts) -> str:
    """A whole page: title, what made it, a note if it is stale, the parts, and the machine below."""
    made = f"Written by `{section['measured']['command']}`; do not edit."
    body = [str(part).rstrip() for part in parts if part]
    return "\n\n".join([f"# {title}", made, *body, "---", measured.footer(section)]) + "\n"


def sentences(claims) -> str:
    """Claims as one paragraph."""
    return " ".join(filter(None, map(str, claims)))


def table(head, rows) -> str:
    """A Markdown table. A cell may be anything that str() can show; | is escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return (
        "\n".join(
            "| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |"
            for line in lines
        )
        + "\n"
    )


def number(value, digits: int = 3) -> str:
    """A number with so many significant digits, never in a form like 1e+03; "-" for None."""
    if value is None:
        return "-"
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    if -3 <= int(exponent) < 5:
        return f"{value:.{max(0, digits - 1 - int(exponent))}f}"
    return f"{mantissa}e{int(exponent)}"


def ms(seconds, digits: int = 3) -> str:
    """A time in milliseconds, without the unit; "-" for None."""
    return number(None if seconds is None else 1e3 * seconds, digits)


def spread(times: dict, digits: int = 2) -> str:
    """(least to greatest) in milliseconds, of a dict with min and max."""
    return f"({ms(times['min'], digits)} to {ms(times['max'], digits)})"
