"""The fonts of the page: that of its formulas, maths.woff, and that of its text, text-*.woff2.

A browser sets sub- and superscripts, fraction bars and roots by the MATH table of the font, and
misplaces them where no font with such a table is installed. So the page holds one: a cut of STIX
Math 1.1.1 (Debian's package fonts-stix). It was made with fontTools: pyftsubset with the characters
below and the mathematical italics of their letters, which a browser shows for variables, without
layout features and hinting, as woff; the line's height set to 900 and its depth to 300 thousandths
in hhea and OS/2; and another name, Chapter Maths, in the tables name and CFF, since the license
(SIL Open Font License 1.1, maths.LICENSE) reserves the original's.

The text is set in a cut of Charis SIL 6.101 (Debian's package fonts-sil-charis), made in the same
way from CharisSIL-Regular, -Italic and -Bold: the characters U+20 to 7E, the fixed blank, and
© ° ± ² ³ · ¹ ½ Ä Ö Ü × ß ä è é ö ÷ ü – — ‘ ’ “ ” … ′ ⅔ → − ≈ ≠ ≤ ≥ ⁰ ⁴ to ⁻ ₀; the layout features
kern and liga; no hinting and no tables of Graphite; as woff2 (with the package brotli); named
Chapter Text, since its license (the same, text.LICENSE) reserves the original's names, too.
"""

FACES = (  # name, file, kind, style, weight
    ("Chapter Maths", "maths.woff", "woff", "normal", 400),
    ("Chapter Text", "text-regular.woff2", "woff2", "normal", 400),
    ("Chapter Text", "text-italic.woff2", "woff2", "italic", 400),
    ("Chapter Text", "text-bold.woff2", "woff2", "normal", 700),
)
LATIN = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
GREEK = "ΓΔΘΛΞΠΣΦΨΩαβγδεζηθικλμνξοπρστυφχψωϑϕϵ"
SIGNS = "0123456789+-−±×·/=≠<>≤≥≈∼→⇒∞∂∑√∥⊥∈…⋯⋅,.;:!|()[]{}'′″*∗%⟨⟩∇∫"


def lacking(text):
    """The characters of a text that the font of the formulas does not have."""
    return sorted(set(text) - set(LATIN + GREEK + SIGNS + " \xa0"))
