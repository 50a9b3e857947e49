"""The fonts of the page: that of its formulas, maths.woff, and that of its text, text-*.woff2.

A browser sets sub- and superscripts, fraction bars and roots by the MATH table of the font, and
misplaces them where no font with such a table is installed, so the page brings one. How the fonts
were cut, and under which license they are, maths.LICENSE and text.LICENSE say.
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
