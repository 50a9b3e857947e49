"""The font of the formulas: python -m curriculum.page.maths_font STIXMath-Regular.otf

A browser sets sub- and superscripts, fraction bars and roots by the MATH table of the font, and
misplaces them where no font with such a table is installed. So the page holds one: maths.woff, cut
from STIX Math 1.1.1 (Debian's package fonts-stix, /usr/share/fonts/opentype/stix-word). This command
makes it again, with the same tables each time. A formula with a character that is not in CHARACTERS
is refused when the page is built: add it here and run the command.

STIX Math is licensed under the SIL Open Font License 1.1 (maths.license.txt), and so is the cut. The
license reserves the original's name, so the cut has another one.
"""

import io
import sys
from pathlib import Path

FILE = Path(__file__).with_name("maths.woff")
NAME = "Chapter Maths"
LATIN = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
GREEK = "ΓΔΘΛΞΠΣΦΨΩαβγδεζηθικλμνξοπρστυφχψωϑϕϵ"
SIGNS = "0123456789+-−±×·/=≠<>≤≥≈∼→⇒∞∂∑√∥⊥∈…⋯⋅,.;:!|()[]{}'′″*∗%⟨⟩∇∫"
# letters of which the italic stands elsewhere than in its row of Unicode
ITALIC = {"h": 0x210E, "ϵ": 0x1D716, "ϑ": 0x1D717, "ϕ": 0x1D719}
# height and depth of a line, in thousandths of the font size; the original's are 2566 and 524, for
# its tallest roots, and would tear the lines of a paragraph apart
ASCENT, DESCENT = 900, 300
NEEDED = "STIXMath-Regular.otf, of Debian's fonts-stix"
KEPT_NAMES = (0, 13, 14)  # copyright, license, where the license is told


def italic(letter):
    """What a browser shows for a variable of one letter: the mathematical italic of it."""
    if letter in ITALIC:
        return chr(ITALIC[letter])
    for first, italic_first in (("A", 0x1D434), ("a", 0x1D44E), ("Α", 0x1D6E2), ("α", 0x1D6FC)):
        if 0 <= ord(letter) - ord(first) < 26:
            return chr(italic_first + ord(letter) - ord(first))
    raise ValueError(f"{letter!r} has no mathematical italic here")


CHARACTERS = frozenset(LATIN + GREEK + SIGNS + " \xa0") | {italic(each) for each in LATIN + GREEK}


def cut(path):
    """A TTFont with the glyphs of CHARACTERS, their taller variants and the MATH table."""
    from fontTools.subset import Options, Subsetter
    from fontTools.ttLib import TTFont

    font = TTFont(path, recalcTimestamp=False)
    options = Options(
        layout_features=[],
        hinting=False,
        glyph_names=False,
        desubroutinize=True,
        notdef_outline=True,
    )
    options.name_IDs = list(KEPT_NAMES)
    options.drop_tables += ["FFTM", "GPOS", "GSUB", "GDEF"]
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=map(ord, CHARACTERS))
    subsetter.subset(font)
    for table in (font["hhea"], font["OS/2"]):
        for name, value in (
            ("ascent", ASCENT), ("descent", -DESCENT), ("sTypoAscender", ASCENT),
            ("sTypoDescender", -DESCENT), ("usWinAscent", ASCENT), ("usWinDescent", DESCENT),
        ):  # fmt: skip
            if hasattr(table, name):
                setattr(table, name, value)
    rename(font)
    return font


def rename(font):
    """Give the cut a name of its own; copyright and license stay."""
    for number, text in ((1, NAME), (2, "Regular"), (4, NAME), (6, NAME.replace(" ", ""))):
        font["name"].setName(text, number, 3, 1, 0x409)
    top = font["CFF "].cff
    top.fontNames[0] = NAME.replace(" ", "")
    top[0].FullName = top[0].FamilyName = NAME


def missing(text):
    """The characters of a text that the font does not have."""
    return sorted(set(text) - CHARACTERS)


def main(argv=None):
    """Cut the font given on the command line. Returns the exit status: 0 written, 2 no such font."""
    from contact import write_whole

    given = sys.argv[1:] if argv is None else argv
    try:
        font = cut(*given)
    except (OSError, TypeError) as error:
        print(f"{given} is not to be cut ({error}); give {NEEDED}", file=sys.stderr)
        return 2
    font.flavor = "woff"
    out = io.BytesIO()
    font.save(out)
    write_whole(FILE, out.getvalue())
    print(f"{FILE}: {len(out.getvalue()):,} bytes")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
