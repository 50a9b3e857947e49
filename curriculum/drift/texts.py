"""What can be read off a Markdown text: includes, slots, typed numbers, formulas, number words."""

import re
from typing import NamedTuple

from curriculum.quoted import HOLDS, REFERENCE, TYPED

CHAPTER = "curriculum/prose/chapter.md"
INCLUDE = re.compile(r"\[include-by-region: (?P<file>[\w./-]+\.py)#(?P<name>[a-z][a-z0-9_-]*)\]")
FENCE = re.compile(r"^(```|~~~).*?^\1[ ]*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+)[^`]+\1|\$[^$\n]+\$")
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
SLOT = re.compile(r"<!--\s*([a-z]+)(?::\s*([\w-]+))?\s*-->")
MATH = re.compile(r"\$\$(.+?)\$\$|\$([^$\n]+)\$", re.DOTALL)
DRAGGED = re.compile(r"\[([^\]]*)\]\((try|drag):([^)]*)\)")
HEADING = re.compile(r"^#+ .*", re.MULTILINE)

TENS = "twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety"
NUMERAL = (
    "zero|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|fifteen|"
    f"{TENS}|hundreds?|thousands?|thousandths?|hundredths?|tenths?|millions?|millionths?|"
    "once|twice|thrice|half|halves|thirds?|fourth|fifth|quarters?|double|triple|dozens?"
)
NUMBER_WORD = re.compile(rf"(?<![\w-])({NUMERAL})(?![\w-])", re.IGNORECASE)
TURNING = (  # words that say which way, or whether at all
    "not|no|none|never|always|cannot|nothing|nobody|neither|nor|without|only|more|most|less|least|"
    "fewer|up|down|upwards?|downwards?|above|below|inside|outside|deeper|deepest|shallower|larger|"
    "largest|smaller|smallest|greater|greatest|higher|highest|lower|lowest|longer|longest|shorter|"
    "shortest|stiffer|softer|harder|faster|fastest|slower|slowest|cheaper|dearer|better|best|worse|"
    "worst|nearer|nearest|farther|earlier|later|heavier|lighter|positive|negative|gains?|loses?|"
    "rises?|falls?|grows?|shrinks?"
)
TURNING_WORD = re.compile(rf"(?<![\w-])({TURNING}|\w+n't)(?![\w-])", re.IGNORECASE)
GENERATED = re.compile(r"<!-- generated: .*?<!-- end -->", re.DOTALL)


class Include(NamedTuple):
    """An include-by-region directive that stands alone in its fence."""

    line: int
    file: str
    name: str


def line_at(text, index):
    """The number of the line that holds text[index]."""
    return text.count("\n", 0, index) + 1


def blank(pattern, text, flags=re.MULTILINE):
    """The text with every match replaced by spaces; lines and places stay."""
    return re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=flags)


def section(text, line):
    """(first, last) line of the section (heading to next heading) around a line."""
    lines = text.rstrip("\n").split("\n")
    headings = [k for k, each in enumerate(lines, 1) if re.match(r"#+ ", each)]
    first = max([k for k in headings if k <= line], default=1)
    return first, min([k - 1 for k in headings if k > line], default=len(lines))


def find_includes(chapter):
    """Every well-formed Include, in order."""
    for fence in FENCE.finditer(chapter):
        lines = fence[0].split("\n")
        found = INCLUDE.fullmatch(lines[1]) if len(lines) == 3 else None
        if found:
            yield Include(line_at(chapter, fence.start()) + 1, found["file"], found["name"])


def typed_numbers(text):
    """(index, token) of every number typed into a text; check_prose_code_drift has the rule."""
    names = "chapters?|phase|version|tag|python|numpy"
    text = blank(COMMENT.pattern, text, re.DOTALL)
    text = blank(r"\]\(try:[^)]*\)", text)
    text = blank(DRAGGED.pattern, text)
    text = blank(rf"{REFERENCE.pattern}|^\[include-by-region:.*", text)
    text = blank(r"\]\([^)]*\)|^\[[^]]*\]:.*|https?://\S+|</?[a-zA-Z][^>]*>", text)
    text = blank(rf"\b({names}) \d+(\.\d+)*((, | and |, and | to )\d+\.\d+)*", text, re.IGNORECASE)
    text = blank(r"(?<![\w.])\d+(\.\d+){2,}", text)
    unfenced = blank(FENCE.pattern, text, FENCE.flags)
    found = []
    for code in [*FENCE.finditer(text), *CODE.finditer(unfenced)]:
        inside = blank(r"--[a-z][a-z-]*[ =][^\s`]+|\b[0-9a-f]{7,64}\b", code[0])
        found += [
            (code.start() + token.start(), token[0])
            for token in re.finditer(r"(?<![\w.])\.?\d[\w.]*", inside)
            if not re.fullmatch(r"\d\.?", token[0])
        ]
    prose = blank(r"^#+ +\d[\d.]*|^[ >]*\d+[.)] ", blank(CODE.pattern, unfenced))
    found += [
        (token.start(), token[0].rstrip(".,"))
        for token in re.finditer(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*", prose)
    ]
    return sorted(found)


def plain_prose(text):
    """The text with code, formulas, comments and references blanked out."""
    for pattern, flags in (
        (COMMENT.pattern, re.DOTALL),
        (FENCE.pattern, FENCE.flags),
        (REFERENCE.pattern, 0),
        (MATH.pattern, MATH.flags),
        (CODE.pattern, 0),
    ):
        text = blank(pattern, text, flags)
    return text


def formulas(text):
    """Every formula, one a line; a lone symbol such as $x$ or $v_n$ is none."""
    found = (
        " ".join((match[1] or match[2]).split())
        for match in MATH.finditer(blank(FENCE.pattern, text, FENCE.flags))
    )
    return [each for each in found if not re.fullmatch(r"\\?\w+(_\\?\w)?", each)]


def words_around(text, pattern, beside):
    """Every word of the prose that fits, with so many words on each side, one a line."""
    words = re.findall(r"[\w'{}-]+", plain_prose(text))
    return [
        " ".join(words[max(k - beside, 0) : k + beside + 1])
        for k, word in enumerate(words)
        if pattern.fullmatch(word)
    ]


def number_words(text):
    """Every number in words, with two words on each side, one a line."""
    return words_around(text, NUMBER_WORD, beside=2)


def turning_words(text):
    """Every word that says which way or whether, with its neighbours; no generated blocks."""
    return words_around(blank(GENERATED.pattern, text, re.DOTALL), TURNING_WORD, beside=1)


def typed_by_reason(text):
    """Every typed number that a reason excuses, {{= NUMBER | REASON}}, one a line."""
    found = (TYPED.fullmatch(match[1].strip()) for match in REFERENCE.finditer(text))
    return [f"{each[1]} | {each[2]}" for each in found if each]


def outline(text):
    """Headings, includes, slots and live links in their order, one a line; claims are no slots."""
    found = [
        (match.start(), match[0].strip())
        for match in HEADING.finditer(blank(FENCE.pattern, text, FENCE.flags))
    ]
    found += [(match.start(), match[0]) for match in INCLUDE.finditer(text)]
    found += [(match.start(), match[0]) for match in SLOT.finditer(text)]
    found += [(match.start(), match[0]) for match in DRAGGED.finditer(text)]
    return [each for _, each in sorted(found)]


def claims(text):
    """Every `holds:` comment and every reference, under its heading, one a line.

    A claim that is loosened or left out still holds, so the claims themselves are accepted.
    """
    marks = re.compile(f"{HEADING.pattern}|{HOLDS.pattern}|{REFERENCE.pattern}", re.MULTILINE)
    return [
        " ".join(match[0].split())
        for match in marks.finditer(blank(FENCE.pattern, text, FENCE.flags))
    ]
