"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.gate                 # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --accept NAME   # what speaks of this region has been read, and every
                                              # sentence whose number moved (without a name: these)

Regions are included once; slots, flags and names in `code` are of what is there; numbers are quoted
by reference, what holds a sentence is true, and results are of today's code. Whether a sentence is
true of the code only a reader can say, and he is asked when the code changes. meta.yaml holds a
hash of every region, of the opening words of contact.py and exact.py (the signs, the promise) and
of each figure's captions; and every number as the texts last quoted it. Where one of them is
another today, the gate names the passages that show or name the region, or the sentence that quotes
the number.
"""

import re
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from curriculum.commands import Parser, needs, write_whole

with needs("dev"):
    import yaml

    import contact
    from curriculum.gate.chapter import CHAPTER, Part, faults, split
    from curriculum.gate.references import REFERENCE, Numbers, TextError, load_meta
    from curriculum.measured import ledger, results, stale
    from curriculum.measured.results import BLOCK
    from curriculum.regions import ROOT, Region, blank, line_at, read_text, split_all

GATE = "python -m curriculum.gate"
TEXTS = (CHAPTER, "README.md")
FIGURES = "curriculum/page/figures/*.js"
KEY = re.compile(r"^  \"?([\w-]+)\"?:", re.MULTILINE)  # of a table with a line each
OPENING = re.compile(r'\A(?:#[^\n]*\n|\s)*""".*?"""', re.DOTALL)  # of a Python file
CAPTION = re.compile(
    r"""\b(?:title|caption):\s*(?:("|`)(?:(?!\1)[^\\]|\\.)*\1[\s+]*)+""", re.DOTALL
)
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
# Where numbers may be typed in text: formulas, references, links, code, numbers of headings and
# lists, versions with two dots, and what follows some words.
NOT_PROSE = re.compile(
    r"""
    \$\$.+?\$\$|\$[^$\n]+\$
    |\{\{\?.*?\}\}|\{\{[^\n]*?\}\}
    |\[[^]]*\]\((?:try|drag):[^)]*\)|\]\([^)]*\)|https?://\S+
    |^\[[^]]*\]:[^\n]*|\[\[\d+\]\](?=\(\#references\))
    |(`+)[^`]+\1
    |\b(?:chapters?|phase|version|tag|python|numpy)[ ]
        \d+(?:\.\d+)*(?:(?:,|,?[ ]and|[ ]to)[ ]\d+\.\d+)*
    |(?<![\w.])\d+(?:\.\d+){2,}
    |^\#+[ ]+\d[\d.]*|^[ >]*\d+[.)][ ]
    """,
    re.DOTALL | re.MULTILINE | re.IGNORECASE | re.VERBOSE,
)
TYPED = re.compile(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*")  # a token that begins with a digit


class Passage(NamedTuple):
    """What a reader reads in one go: a heading with its text, an exercise, a figure's captions."""

    file: str
    line: int
    text: str

    def speaks_of(self, region: Region) -> bool:
        """Whether it includes the region, or has a name in `code` that the region defines."""
        includes = {part.name for part in split(self.text) if part.kind == "region"}
        words = {word for span in SPAN.findall(self.text) for word in re.findall(r"\w+", span)}
        return f"{region.file}#{region.name}" in includes or bool(region.defines & words)


class Gate:
    """One pass over the project: `problems` are lines, `changed` what waits for a reader."""

    def __init__(self):
        self.chapter, self.meta, self.quoted = split(read_text(CHAPTER)), load_meta(), {}
        self.regions, self.problems = split_all()
        self.passages = list(passages())
        self.read = self.regions | {each.name: each for each in openings_and_captions()}
        recorded = self.meta["region_hashes"]
        self.changed = [each for each in self.read.values() if recorded.get(each.name) != each.sha]

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check_marks(self):
        """What the chapter includes, and its slots name, is there, and nothing lacks a place."""
        known, shown = self.known(), Counter()
        for kind, name, line, _ in self.chapter:
            shown[kind, name] += 1
            told = name.split(",") if kind == "tells" else []
            if wrong := [n for n in told if n not in known["bet"] or not shown["exercise", n]]:
                what = f"{', '.join(wrong)} is no bet above, so nobody has bet yet"
                self.say(CHAPTER, line, what, "name an exercise above that has a PREDICTION")
            if name not in known.get(kind, (name,)):
                names = ", ".join(known[kind])
                self.say(CHAPTER, line, f"there is no {kind} {name}", f"name one of {names}")
            elif shown[kind, name] > 1 and kind in ("region", "exercise", "bench", "stress"):
                self.say(CHAPTER, line, f"{kind} {name} stands here again", "delete one of the two")
        for line, what, repair in faults(self.chapter):
            self.say(CHAPTER, line, what, repair)
        for kind in ("region", "figure", "exercise"):
            for name, place in known[kind].items():
                if not shown[kind, name]:
                    self.say(*place, f"{kind} {name} has no place in {CHAPTER}", "give it one")

    def known(self) -> dict:
        """{kind: {name: (file, line)}} of all that a mark of the chapter may name."""
        regions = {f"{r.file}#{r.name}": (r.file, r.line - 1) for r in self.regions.values()}
        exercises = {Path(f).name.split("_")[0]: (f, 1) for f in files("exercises/ex*.py")}
        figures: dict = {}
        for file in files(FIGURES):
            several = read_text(file).partition("export const figures = {")[2]
            names = KEY.findall(several) or re.findall(r"[\w-]+", several.partition("}")[0])
            figures |= dict.fromkeys(names or [Path(file).stem], (file, 1))
        bets = {name: at for name, at in exercises.items() if "PREDICTION =" in read_text(at[0])}
        known = {"bet": bets, "region": regions, "exercise": exercises, "figure": figures}
        for kind, folder in results.FOLDERS.items():
            drawn = files(f"{folder}/*.svg")
            known[kind] = {Path(f).stem.removeprefix("error-"): (f, 1) for f in drawn}
        return known

    def check_read(self):
        """What readers have read is what it was, and nothing is kept of what is gone."""
        for each in self.changed:
            speak = [f"{p.file}:{p.line}" for p in self.passages if p.speaks_of(each)]
            what = f"{each.name} changed" + f", and {', '.join(speak)} speak of it" * bool(speak)
            self.say(each.file, each.line, what, f"read these, then {GATE} --accept {each.name}")
        if gone := ", ".join(self.meta["region_hashes"].keys() - self.read):
            self.say("meta.yaml", 1, f"hashes of what is gone: {gone}", f"{GATE} --accept")

    def check_names(self):
        """Names in `code` and flags, of chapter and captions, are in some code or in meta.yaml."""
        code = files("*.py", "exercises/**/*.py", "curriculum/*.py", "curriculum/[!t]*/*.py")
        known = set(re.findall(r"--[a-z]\w*|\w+", "".join(map(read_text, [*code, "meta.yaml"]))))
        contact.add_flags(lambda flag, **_: known.add(flag))
        for file, first, text in self.passages:
            for match in SPAN.finditer(text) if file.startswith("curriculum") else ():
                for name in {*re.findall(r"^[A-Za-z_]\w+$|--[a-z]\w*", match[1])} - known:
                    line = first + line_at(text, match.start()) - 1
                    self.say(file, line, f"`{name}` is in no code", "name what is there")

    def check_numbers(self):
        """None is typed into the chapter's prose, every reference can be made and gives what it
        gave, what holds a sentence is true, and each run is quoted."""
        for _, _, first, text in (p for p in self.chapter if p.kind in ("text", "heading")):
            for token in TYPED.finditer(blank(NOT_PROSE, text)):
                line, number = first + line_at(text, token.start()) - 1, token[0].rstrip(".,")
                repair = f"write {{{{KEY|FORMAT}}}} or {{{{= {number} | REASON}}}}"
                self.say(CHAPTER, line, f"a typed number, {number}", repair)
        numbers, texts = Numbers(), {file: read_text(file) for file in TEXTS}
        numbers.prepare("".join(texts.values()))
        for file, text in texts.items():
            for match in REFERENCE.finditer(text):
                (claim, asked), line = match.groups(), line_at(text, match.start(match.lastindex))
                try:
                    shown = numbers.text(asked) if asked else ""
                    if claim and (false := numbers.broken(claim)):
                        self.say(
                            file, line, f"{claim!r} does not hold: {false}", "correct the text"
                        )
                    elif asked and not asked.startswith("="):
                        self.check_number(file, line, asked, shown)
                except TextError as error:
                    self.say(file, line, f"{asked or claim!r}: {error}", "name what is known")
        for name in [*self.meta["runs"]][1:]:
            if not any(f"{name}:" in text for text in texts.values()):
                self.say("meta.yaml", 1, f"run {name} is quoted nowhere", "take it out")

    def check_number(self, file, line, asked, shown):
        """A reference gives what it gave when its sentence was read."""
        self.quoted[asked] = now = shown
        was = self.meta["numbers"].get(asked, now)
        if was != now:
            repair = f"read its sentence, then {GATE} --accept"
            self.say(file, line, f"{asked} was {was} and is {now}", repair)

    def check_measured(self):
        """Results and rows of the ledger are of today's code."""
        for name, folder in results.FOLDERS.items():
            for section, content in results.load(name).items():
                if names := stale.changed(content["measured"]["code"]):
                    what = f"section {section} was measured on other code ({', '.join(names)})"
                    file = f"{folder}/{results.NAMES[name]}"
                    self.say(file, 1, what, content["measured"]["command"])
        for line, row in enumerate(ledger.rows(), 2):
            if ledger.stale(row):
                what = f"{row['tier']} was measured on other code"
                self.say("wallclock.csv", line, what, f"{ledger.COMMAND} {row['tier']}")


def passages():
    """The sections of chapter and README, the exercises, and the captions of figures."""
    for file in TEXTS:
        parts, read = split(blank(BLOCK, read_text(file))), []
        for part in [*parts, Part("heading", "", 0, "")]:
            if part.kind == "heading" and read and read[0].kind == "heading":
                yield Passage(file, read[0].line, "".join(each.text for each in read))
            read = [part] if part.kind == "heading" else [*read, part]
    for file in files("exercises/ex*.py"):
        yield Passage(file, 1, read_text(file))
    for each in openings_and_captions():
        if each.name.startswith("figures/"):
            yield Passage(each.file, each.line, each.code)


def openings_and_captions():
    """What is read like a region and is none, as Regions: contact.py, exact.py, figures/NAME."""
    for file in ("contact.py", "curriculum/exact.py"):
        if opening := OPENING.match(read_text(file)):
            yield Region(file.split("/")[-1], opening[0], 1, file)
    for file in files(FIGURES):
        if captions := "\n".join(caption[0] for caption in CAPTION.finditer(read_text(file))):
            yield Region(f"figures/{Path(file).stem}", captions, 1, file)


def files(*patterns):
    """The project's files of these patterns, as they are named in git."""
    paths = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in paths]


def check() -> int:
    """Print every problem, and the command that accepts what was read."""
    gate = Gate()
    checks = gate.check_marks, gate.check_read, gate.check_names, gate.check_numbers
    for each in (*checks, gate.check_measured):
        each()
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(gate.changed) > 1:
        names = " ".join(each.name for each in gate.changed)
        print(f"\nwhen all of them are read: {GATE} --accept {names}")
    return 1 if gate.problems else 0


def accept(names) -> int:
    """Record these as they are now, and all numbers as they are quoted now."""
    gate = Gate()
    unknown = [name for name in names if name not in gate.read]
    if gate.problems or unknown:
        wrong = f"given {', '.join(unknown)}, allowed: {', '.join(gate.read)}"
        raise TextError("\n".join(gate.problems) or wrong)
    gate.check_numbers()
    hashes = gate.meta["region_hashes"] | {name: gate.read[name].sha for name in names}
    hashes = {name: hashes[name] for name in gate.read if name in hashes}
    head = re.split("^region_hashes:", read_text("meta.yaml"), maxsplit=1, flags=re.MULTILINE)[0]
    kept = {"region_hashes": hashes, "numbers": gate.quoted}
    tail = yaml.safe_dump(kept, sort_keys=False, allow_unicode=True, width=1000)
    write_whole(ROOT / "meta.yaml", f"{head.rstrip()}\n\n{tail}")
    print(f"recorded in meta.yaml: all numbers, and {', '.join(names) or 'nothing else'}")
    return 0


def main(argv=None) -> int:
    """Check or accept. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog=GATE, description=__doc__)
    parser.add_argument("--accept", metavar="NAME", nargs="*", help="what was read")
    names = parser.parse_args(argv).accept
    try:
        return check() if names is None else accept(names)
    except SyntaxError as error:
        print(f"{error.filename}:{error.lineno}: not Python: {error.msg}", file=sys.stderr)
    except (OSError, TextError) as error:
        print(error, file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main())
