"""Find ratios in words, "a quarter" or "eight times", without a claim beside them."""

import math
import re

from curriculum.prose.chapter import INLINE
from curriculum.prose.references import OPERAND, REFERENCE
from curriculum.source import blank

COUNTS = "two three four five six seven eight nine ten eleven twelve".split()
COUNTS = {word: n for n, word in enumerate(COUNTS, 2)} | {"fifteen": 15, "twenty": 20, "thirty": 30}
COUNTS |= {"a": 1, "one": 1, "forty": 40, "fifty": 50, "hundred": 100, "thousand": 1000}
PARTS = "third quarter fifth sixth seventh eighth ninth tenth".split()
PARTS = {word: n for n, word in enumerate(PARTS, 3)} | {"hundredth": 100, "thousandth": 1000}
PARTS |= {"millionth": 1e6}
RATIO = re.compile(
    rf"""\b(?:(?P<count>{"|".join(COUNTS)})\s(?P<part>{"|".join(PARTS)})s?|(?P<half>half)
    |(?P<times>{"|".join(COUNTS)})\stimes|(?:twice|double)(?=\s(?:as|the)\b))\b""",
    re.VERBOSE | re.IGNORECASE,
)
SENTENCE = re.compile(r"\S(?s:.)*?(?:[.?!](?=\s)\s*|\n\s*\n\s*|\|\s*|\Z)")
NUMBER = re.compile(r"(?<![\w.-])\d[\d.]*(?:e-?\d+)?(?![\w.:])")


def loose_ratios(text):
    """Yield (match, number) of each ratio in words that no claim of its sentence holds.

    Only sentences that quote a number or have a claim count: others are theory. The claims that
    follow a sentence are its own.
    """
    found = [*REFERENCE.finditer(text)]
    claims = [match for match in found if match[1].startswith("?")]
    plain = blank(REFERENCE, blank(INLINE, text))
    for match in found:
        if match not in claims:  # a word like others, so that its sentence goes on
            plain = plain[: match.start()] + "_" * len(match[0]) + plain[match.end() :]
    for sentence in SENTENCE.finditer(plain):
        start, end = sentence.span()
        own = [match[1] for match in claims if start < match.end() <= end]
        for ratio in RATIO.finditer(plain, start, end) if own or "_" in sentence[0] else ():
            count, part, half, times = (word and word.lower() for word in ratio.groups())
            value = 0.5 if half else COUNTS[count] / PARTS[part] if part else COUNTS.get(times, 2)
            if not any(holds(claim, x) for claim in own for x in (value, 1.0 / value)):
                yield ratio, value


def holds(claim, number):
    """Return whether a claim types this number, or two numbers around it: "? 0.2 < a / b < 0.3"."""
    sides = re.split("[<>=]+", claim[1:])
    bounds = [eval(side) for side in sides if not OPERAND.search(side)]  # our own arithmetic
    typed = [float(each) for side in sides for each in NUMBER.findall(OPERAND.sub("", side))]
    between = bool(bounds) and min(bounds) <= number <= max(bounds)
    return between or any(math.isclose(number, each) for each in typed)
