"""The characters of the formulas' font, maths.woff.

A browser sets sub- and superscripts, fraction bars and roots by the MATH table of the font, and
misplaces them where no font with such a table is installed. So the page holds one: a cut of STIX
Math 1.1.1 (Debian's package fonts-stix). It was made with fontTools: pyftsubset with the characters
below and the mathematical italics of their letters, which a browser shows for variables, without
layout features and hinting, as woff; the line's height set to 900 and its depth to 300 thousandths
in hhea and OS/2; and another name, Chapter Maths, in the tables name and CFF, since the license
(SIL Open Font License 1.1, maths.LICENSE) reserves the original's.
"""

from pathlib import Path

FILE = Path(__file__).with_name("maths.woff")
NAME = "Chapter Maths"
LATIN = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
GREEK = "ΓΔΘΛΞΠΣΦΨΩαβγδεζηθικλμνξοπρστυφχψωϑϕϵ"
SIGNS = "0123456789+-−±×·/=≠<>≤≥≈∼→⇒∞∂∑√∥⊥∈…⋯⋅,.;:!|()[]{}'′″*∗%⟨⟩∇∫"


def missing(text):
    """The characters of a text that the font does not have."""
    return sorted(set(text) - set(LATIN + GREEK + SIGNS + " \xa0"))
