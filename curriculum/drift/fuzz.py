"""Random changes, one at a time, and which of them the gate lets pass.

    python -m curriculum.check_prose_code_drift --fuzz 200 --seed 1

A change is one that an author could make by accident: a digit, a sign, a letter, a name, a line
that goes or changes place. Each is made in a copy of the project, where all runs are reused. It is
of a kind that the gate must catch, or of an open kind (plain words), which is only counted and
listed. The same N and seed give the same changes to the same project.
"""

import random
import re
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from curriculum import check_prose_code_drift as gate
from curriculum import regions
from curriculum.drift import texts
from curriculum.drift.texts import CHAPTER
from curriculum.quoted import HOLDS, Numbers

IGNORED = shutil.ignore_patterns(
    ".git",
    "__pycache__",
    "outputs",
    ".venv",
    "*.png",
    "*.rrd",
    "build",
    ".hypothesis",
    ".pytest_cache",
    ".ruff_cache",
    "*.egg-info",
    "tests",
)
TURNED = {
    "deeper": "shallower",
    "more": "less",
    "larger": "smaller",
    "never": "always",
    "up": "down",
    "above": "below",
    "longer": "shorter",
    "stiffer": "softer",
    "faster": "slower",
    "is": "is not",
    "does": "does not",
    "can": "cannot",
    "positive": "negative",
}
COMPARED = {">": "<", "<": ">", ">=": "<", "<=": ">", "==": ">"}
NUMERALS = ("two", "three", "four", "five", "ten", "hundred", "twice", "half", "third")


class Kind(NamedTuple):
    """A kind of change: to which files, how, and whether the gate may let it pass."""

    name: str
    files: tuple
    change: object  # (rng, text) -> another text, or None where there is nothing to change
    open: bool = False


def pick(rng, pattern, text, flags=re.MULTILINE):
    """A match of the pattern, drawn at random; None without one."""
    found = list(re.finditer(pattern, text, flags))
    return rng.choice(found) if found else None


def put(text, match, new, group=0):
    """The text with one match, or a group of it, replaced."""
    return text[: match.start(group)] + new + text[match.end(group) :]


def another_digit(rng, token):
    """A number with one of its digits changed; the first stays above zero."""
    place = rng.choice([k for k, letter in enumerate(token) if letter.isdigit()])
    return (
        token[:place]
        + rng.choice([d for d in "123456789" if d != token[place]])
        + token[place + 1 :]
    )


def typo(rng, word):
    """A word with a letter left out, doubled, or changed with its neighbour."""
    place = rng.randrange(len(word) - 1)
    slips = [
        word[:place] + word[place + 1 :],
        word[:place] + word[place] + word[place:],
        word[:place] + word[place + 1] + word[place] + word[place + 2 :],
    ]
    slips = [slip for slip in slips if slip != word]
    return rng.choice(slips)


def digit_of(pattern, group=0):
    """Change one digit within a match."""

    def change(rng, text):
        found = pick(rng, pattern, text)
        if not found or not any(map(str.isdigit, found[group])):
            return None
        return put(text, found, another_digit(rng, found[group]), group)

    return change


def typo_in(pattern, group=0):
    """Slip in a word that a match holds."""

    def change(rng, text):
        found = pick(rng, pattern, text)
        return put(text, found, typo(rng, found[group]), group) if found else None

    return change


def leave_out(pattern):
    """Delete a match."""

    def change(rng, text):
        found = pick(rng, pattern, text)
        return put(text, found, "") if found else None

    return change


def swap_two(pattern, group=0):
    """Let two matches change places."""

    def change(rng, text):
        found = list(re.finditer(pattern, text, re.MULTILINE))
        if len({match[group] for match in found}) < 2:
            return None
        one, two = sorted(rng.sample(found, 2), key=lambda match: match.start())
        return put(put(text, two, one[group], group), one, two[group], group)

    return change


def number_word(rng, text):
    """Another number in words."""
    found = pick(rng, texts.NUMBER_WORD.pattern, texts.plain_prose(text), re.IGNORECASE)
    if not found:
        return None
    return put(text, found, rng.choice([word for word in NUMERALS if word != found[0].lower()]))


def formula(rng, text):
    """Another digit, sign or letter in a formula."""
    found = [
        match
        for match in texts.MATH.finditer(texts.blank(texts.FENCE.pattern, text, texts.FENCE.flags))
        if len(match[0]) > 8
    ]
    if not found:
        return None
    whole = rng.choice(found)
    part = pick(rng, r"[0-9+\-<>]|\\(ge|le)\b|\b[a-z]\b", whole[0])
    if not part:
        return None
    new = {"+": "-", "-": "+", "<": ">", ">": "<", r"\ge": r"\le", r"\le": r"\ge"}.get(part[0])
    new = new or (
        another_digit(rng, part[0])
        if part[0].isdigit()
        else rng.choice([letter for letter in "abcdkmxv" if letter != part[0]])
    )
    return put(text, whole, put(whole[0], part, new))


def claim(rng, text):
    """A claim turned round or left out."""
    found = pick(rng, HOLDS.pattern, text)
    if not found:
        return None
    sign = re.search(r" (<=|>=|==|<|>) ", found[0])
    return put(text, found, rng.choice(["", put(found[0], sign, COMPARED[sign[1]], 1)]))


def any_word(rng, text):
    """A word in the place of another, as an author's wrong word would be."""
    words = list(re.finditer(r"\b[a-z]{5,}\b", texts.plain_prose(text)))
    if len(words) < 2:
        return None
    found, other = rng.sample(words, 2)
    return put(text, found, other[0])


def plain_word(rng, text):
    """A plain word turned round."""
    found = pick(rng, rf"\b({'|'.join(TURNED)})\b", texts.plain_prose(text))
    return put(text, found, TURNED[found[0]]) if found else None


def code_name(rng, text):
    """A slip in a name of a code span of the prose."""
    prose = texts.blank(
        texts.FENCE.pattern, texts.blank(texts.COMMENT.pattern, text, re.DOTALL), texts.FENCE.flags
    )
    found = pick(rng, r"(?<!`)`([a-z]\w{4,})(\(\))?`(?!`)", prose)
    return put(text, found, typo(rng, found[1]), 1) if found else None


def command(rng, text):
    """A slip in the file, module or flag of a command in a fence."""
    found = pick(
        rng,
        r"^(?:\S*/)?python\S* (?:-m )?(?:curriculum\.)?(\w+)|^[^#\n]*?python[^\n]* --([a-z]\w+)",
        text,
    )
    group = next((k for k in (1, 2) if found and found[k]), None)
    if not group or found[group] in ("m", "venv", "pip", "pytest"):
        return None
    return put(text, found, typo(rng, found[group]), group)


def letter(rng, text):
    """Another answer."""
    found = pick(rng, r"^ +answer: ([A-Z])", text)
    return (
        put(text, found, rng.choice([each for each in "ABC" if each != found[1]]), 1)
        if found
        else None
    )


def band(rng, text):
    """A band opened wide."""
    found = pick(rng, r"\.\w+: (\[[-\d.e]+, [-\d.e]+\])", text)
    return put(text, found, rng.choice(["[0, 99999]", "[-1, 1.0e+9]"]), 1) if found else None


def measured_row(rng, text):
    """A tier that was not measured, with a row."""
    found = pick(rng, r"^([\w.-]+,[\w-]+),,,,,PENDING$", text)
    return (
        put(text, found, f"{found[1]},0.01,007f6310bb5b,a771e72,2026-01-02,MEASURED")
        if found
        else None
    )


def code(rng, text):
    """Another digit, sign or word in code, outside docstring and markers."""
    found = pick(
        rng,
        r"^(?! *#)(?=.*[=(]).*?([0-9]|[<>]| [+-] |\b(?:and|or|min|max|all|any|True|False)\b)",
        text,
    )
    if not found:
        return None
    old = found[1]
    turned = {
        "<": ">",
        ">": "<",
        " + ": " - ",
        " - ": " + ",
        "and": "or",
        "or": "and",
        "min": "max",
        "max": "min",
        "all": "any",
        "any": "all",
        "True": "False",
        "False": "True",
    }
    return put(text, found, turned.get(old) or another_digit(rng, old), 1)


def docstring(rng, text):
    """Another word, digit or sign in the docstring at the head of a Python file."""
    head = re.match(r'"""(.*?)"""', text, re.DOTALL)
    found = pick(rng, r"\b[a-z]{4,}\b|\d|[<>]", head[1]) if head else None
    if not found:
        return None
    new = {"<": ">", ">": "<"}.get(found[0]) or (
        another_digit(rng, found[0]) if found[0].isdigit() else typo(rng, found[0])
    )
    return put(text, head, put(head[1], found, new), 1)


def block_digit(rng, text):
    """Another digit in a generated block of the README."""
    blocks = re.finditer(r"<!-- generated: .*?<!-- end -->", text, re.DOTALL)
    numbered = [block for block in blocks if re.search(r"\d\.\d", block[0])]
    if not numbered:
        return None
    block = rng.choice(numbered)
    found = pick(rng, r"\d+\.\d+", block[0])
    return put(text, block, put(block[0], found, another_digit(rng, found[0])))


META, README = ("meta.yaml",), ("README.md",)
PROSE = (CHAPTER,)
KINDS = (
    Kind("a typed number", PROSE, digit_of(r"\{\{= *([\d.,e-]+)", 1)),
    Kind("a number in words", PROSE, number_word),
    Kind("a formula", PROSE, formula),
    Kind("two includes", PROSE, swap_two(r"^\[include-by-region: ([^\]]+)\]", 1)),
    Kind("an include", PROSE, leave_out(r"^```\n\[include-by-region: [^\]]+\]\n```\n")),
    Kind("a slot", PROSE, leave_out(r"^<!-- *(figure|exercise|bench|stress|wallclock)[^>]*-->")),
    Kind("two slots", PROSE, swap_two(r"^<!-- *(?:figure|exercise): *([\w-]+) *-->", 1)),
    Kind("a heading", PROSE, typo_in(r"^#+ .*?(\w{4,})", 1)),
    Kind("a claim", PROSE, claim),
    Kind("two references", PROSE, swap_two(r"\{\{[^=}][^}]*\}\}")),
    Kind("a reference", PROSE, typo_in(r"\{\{[^=}]*?([a-z_]{5,})", 1)),
    Kind("a name in the text", PROSE, code_name),
    Kind("a flag in the text", PROSE, typo_in(r"`--([a-z]{4,})", 1)),
    Kind("a command", PROSE + README, command),
    Kind("a live link", PROSE, typo_in(r"\]\((?:try|drag):(\w{2,})", 1)),
    Kind(
        "an image or link",
        PROSE + README,
        typo_in(r"\]\((?!http|try|drag|#)[^)]*?(\w{4,})\.\w+\)", 1),
    ),
    Kind("a number of a README block", README, block_digit),
    Kind("an answer", META, letter),
    Kind("a band", META, band),
    Kind("a hint or reveal", META, typo_in(r"^ {6,}(?:- |[A-Z]: )?.*?\b([a-z]{4,})\b", 1)),
    Kind("an objective", META, typo_in(r"^  - .*?\b([a-z]{4,})\b", 1)),
    Kind("a reference number", META, digit_of(r"^    \S+: (-?\d+\.\d{1,8})", 1)),
    Kind("a run's flags", META, digit_of(r"^  [\w.-]+: \[.*\]$")),
    Kind("a hash", META, digit_of(r"^ +[\w-]+: ([0-9a-f]{64})$", 1)),
    Kind("what is read", META, digit_of(r"^  (?:tag|commit): (\S+)", 1)),
    Kind("measured minutes", ("wallclock.csv",), digit_of(r",(\d[\d.e-]*),", 1)),
    Kind("an invented row", ("wallclock.csv",), measured_row),
    Kind("a measured time", ("curriculum/wallclock_runs.json",), digit_of(r"^ +(\d+\.\d{2})", 1)),
    Kind("a choice", ("exercises/ex*.py",), typo_in(r'^ +"[A-Z]": .*?\b([a-z]{4,})\b', 1)),
    Kind("an exercise's docstring", ("exercises/ex*.py",), docstring),
    Kind("code", regions.LITERATE, code),
    Kind("a docstring", regions.LITERATE, docstring),
    Kind("a word turned round", PROSE, plain_word),
    Kind("a README word turned round", README, plain_word),
    Kind("any word of the text", PROSE, any_word, open=True),
    Kind("any word of the README", README, any_word, open=True),
)


class Fuzz:
    """A copy of a project in order, the runs its text quotes, and changes made to it."""

    def __init__(self, root, folder):
        """Raises ValueError when the project is not in order to begin with."""
        self.root = Path(folder) / "project"
        shutil.copytree(root, self.root, ignore=IGNORED)
        for image in Path(root).rglob("*.png"):
            if not {".git", "outputs", ".venv"} & set(image.relative_to(root).parts):
                (self.root / image.relative_to(root)).parent.mkdir(parents=True, exist_ok=True)
                (self.root / image.relative_to(root)).touch()
        self.made = Numbers(self.root)
        problems = gate.check(self.root, self.made)
        if problems:
            raise ValueError(
                "\n".join(["the project is not in order before any change:", *problems])
            )

    def caught(self, file, text):
        """The first problem that the gate finds once `file` has this text; None when it passes."""
        numbers = Numbers(self.root, self.made.runs)
        numbers.config_hash = dict(self.made.config_hash)
        path = self.root / file
        before = path.read_bytes()
        path.write_bytes(text.encode("utf-8"))
        try:
            return next(iter(gate.check(self.root, numbers, first=True)), None)
        finally:
            path.write_bytes(before)

    def change(self, rng, kind):
        """(file, before, after) of one change of that kind, or None where there is none to make."""
        files = [
            path.relative_to(self.root).as_posix()
            for pattern in kind.files
            for path in sorted(self.root.glob(pattern))
        ]
        for file in rng.sample(files, len(files)):
            before = (self.root / file).read_text("utf-8")
            after = kind.change(rng, before)
            if after is not None and after != before:
                return file, before, after
        return None


def first_difference(before, after):
    """(line number, line before, line after) of the first line that differs."""
    old, new = before.split("\n"), after.split("\n")
    number = next((k for k, pair in enumerate(zip(old, new)) if pair[0] != pair[1]), len(new))
    line = [part[number] if number < len(part) else "" for part in (old, new)]
    return number + 1, *line


def around(old, new, width=60):
    """The part of two lines where they differ."""
    start = next((k for k, pair in enumerate(zip(old, new)) if pair[0] != pair[1]), 0)
    start = max(start - width // 2, 0)
    return old[start : start + width].strip(), new[start : start + width].strip()


def run(root, count, seed):
    """(made by kind, passed as [(kind, file, line, before, after)]) of that many random changes."""
    rng, made, passed = random.Random(seed), Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        fuzz = Fuzz(root, folder)
        kinds = list(KINDS)
        while sum(made.values()) < count and kinds:
            kind = kinds[sum(made.values()) % len(kinds)]
            found = next(filter(None, (fuzz.change(rng, kind) for _ in range(5))), None)
            if found is None:
                kinds.remove(kind)
                continue
            made[kind] += 1
            if fuzz.caught(found[0], found[2]) is None:
                passed.append((kind, found[0], *first_difference(found[1], found[2])))
    return made, passed


def main(root, count, seed):
    """Print what was made, what was caught, and all that passed. Returns the exit status."""
    try:
        made, passed = run(root, count, seed)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    through = Counter(kind for kind, *_ in passed)
    print(f"{'change':<30}{'made':>6}{'caught':>8}")
    for kind, number in made.items():
        print(
            f"{kind.name:<30}{number:>6}{number - through[kind]:>8}{'  open' if kind.open else ''}"
        )
    for kind, file, line, old, new in passed:
        before, after = around(old, new)
        print(
            f"passed{' (open)' if kind.open else ''}: {file}:{line}: {kind.name}: "
            f"{before!r} became {after!r}"
        )
    missing = [kind.name for kind in KINDS if not made[kind]]
    if missing and count >= len(KINDS):
        print("nothing to change:", ", ".join(missing))
    closed = [each for each in passed if not each[0].open]
    print(
        f"{sum(made.values())} changes, seed {seed}: {len(passed)} passed, {len(closed)} of them of "
        "a kind that the gate must catch"
    )
    return 1 if closed else 0
