"""The characters of the formulas' font, maths.woff.

A browser sets sub- and superscripts, fraction bars and roots by the MATH table of the font, and
misplaces them where no font with such a table is installed. So the page holds one: a cut of STIX
Math 1.1.1 (Debian's package fonts-stix). It was made with fontTools: pyftsubset with the characters
below, without layout features and hinting, as woff; the line's height set to 900 and its depth to
300 thousandths in hhea and OS/2; and another name, Chapter Maths, in the tables name and CFF, since
the license (SIL Open Font License 1.1, maths.LICENSE) reserves the original's.
"""

from pathlib import Path

FILE = Path(__file__).with_name("maths.woff")
NAME = "Chapter Maths"
LATIN = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
GREEK = "ΓΔΘΛΞΠΣΦΨΩαβγδεζηθικλμνξοπρστυφχψωϑϕϵ"
SIGNS = "0123456789+-−±×·/=≠<>≤≥≈∼→⇒∞∂∑√∥⊥∈…⋯⋅,.;:!|()[]{}'′″*∗%⟨⟩∇∫"
# letters of which the italic stands elsewhere than in its row of Unicode
ITALIC = {"h": 0x210E, "ϵ": 0x1D716, "ϑ": 0x1D717, "ϕ": 0x1D719}


def italic(letter):
    """What a browser shows for a variable of one letter: the mathematical italic of it."""
    if letter in ITALIC:
        return chr(ITALIC[letter])
    for first, italic_first in (("A", 0x1D434), ("a", 0x1D44E), ("Α", 0x1D6E2), ("α", 0x1D6FC)):
        if 0 <= ord(letter) - ord(first) < 26:
            return chr(italic_first + ord(letter) - ord(first))
    raise ValueError(f"{letter!r} has no mathematical italic here")


CHARACTERS = frozenset(LATIN + GREEK + SIGNS + " \xa0") | {italic(each) for each in LATIN + GREEK}


def missing(text):
    """The characters of a text that the font does not have."""
    return sorted(set(text) - CHARACTERS)
