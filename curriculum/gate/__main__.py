"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.gate                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --read "HEADING"  # you have read these, as they are now

Regions are included once; slots, flags and names in `code` are of what is there; numbers are quoted
by reference, what holds a sentence is true, and results are of today's code. Whether a sentence is
true of the code only a reader can say. meta.yaml keeps what each passage spoke of when it was last
read: the hashes of its regions, its numbers. Where one of them is another today, or new, the gate
asks to read the passage again. region_hashes are of the code when all passages were last read.
"""

import hashlib
import re
import shlex
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from curriculum.commands import Parser, needs, write_whole

with needs("dev"):
    import yaml

    import contact
    from curriculum import stored
    from curriculum.gate.chapter import CHAPTER, INCLUDE, INLINE, faults, split
    from curriculum.gate.references import REFERENCE, TextError, hold, load_meta, prepare, shown
    from curriculum.lesson.regions import DOCSTRING, ROOT, blank, line_at, read_text, split_all

GATE = "python -m curriculum.gate"
TEXTS = (CHAPTER, "README.md")
FIGURES = "curriculum/page/figures/*.js"
KEY = re.compile(r"^  \"?([\w-]+)\"?:", re.MULTILINE)  # of a table with a line each
CAPTION = re.compile(
    r"""\b(?:title|caption):\s*(?:("|`)(?:(?!\1)[^\\]|\\.)*\1[\s+]*)+""", re.DOTALL
)
MADE = re.compile(r"<!-- generated: .*?<!-- end -->", re.DOTALL)  # by a command
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
# Where numbers may be typed in text: code and formulas, references, links, numbers of headings and
# lists, versions with two dots, and what follows some words.
NOT_PROSE = re.compile(
    rf"""
    {INLINE.pattern}
    |\{{\{{\?(?s:.*?)\}}\}}|\{{\{{[^\n]*?\}}\}}
    |\]\([^)]*\)|https?://\S+
    |^\[[^]]*\]:[^\n]*|\[\[\d+\]\](?=\(\#references\))
    |\b(?:chapters?|phase|version|tag|python|numpy)[ ]
        \d+(?:\.\d+)*(?:(?:,|,?[ ]and|[ ]to)[ ]\d+\.\d+)*
    |(?<![\w.])\d+(?:\.\d+){{2,}}
    |^\#+[ ]+\d[\d.]*|^[ >]*\d+[.)][ ]
    """,
    re.DOTALL | re.MULTILINE | re.IGNORECASE | re.VERBOSE,
)
TYPED = re.compile(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*")  # a token that begins with a digit


class Passage(NamedTuple):
    """What a reader reads in one go: a heading of chapter or README with its text, an exercise, the
    captions of a figure, or the opening words of contact.py (the signs) and exact.py (the promise).

    `name` is what one types when one has read it; `line` the one on which it begins.
    """

    name: str
    file: str
    line: int
    text: str

    def line_of(self, index) -> int:
        """The line of its file that holds text[index]."""
        return self.line + line_at(self.text, index) - 1

    def sources(self, regions) -> dict:
        """{source: hash}: the regions that it includes or names, and its own words in code."""
        included, named = INCLUDE.findall(self.text), " ".join(SPAN.findall(self.text))
        words = set(re.findall(r"\w+", named))
        own = not self.file.startswith(("exercises/", *TEXTS))
        found = {"its words": hashlib.sha256(self.text.encode()).hexdigest()} if own else {}
        found |= {r.source: r.sha for r in regions if r.source in included or r.defines & words}
        return {source: sha[:12] for source, sha in found.items()}


def passages():
    """All of them, in the order of their files."""
    for file in TEXTS:
        yield from sections(file)
    for file in files("exercises/ex*.py"):
        yield Passage(Path(file).stem.split("_")[0], file, 1, read_text(file))
    for file in ("contact.py", "curriculum/exact.py"):
        yield Passage(Path(file).name, file, 1, DOCSTRING.match(read_text(file))[0])
    for file in files(FIGURES):
        captions = "\n".join(caption[0] for caption in CAPTION.finditer(read_text(file)))
        yield Passage(f"figures/{Path(file).stem}", file, 1, captions)


def sections(file) -> list:
    """The headings of a text, each with what stands under it; what a command wrote is left out."""
    found = []
    for part in split(blank(MADE, read_text(file))):
        if part.kind == "heading":
            name = part.name if file == CHAPTER else f"{file}: {part.name}"
            found.append(Passage(name, file, part.line, ""))
        if found:
            found[-1] = found[-1]._replace(text=found[-1].text + part.text)
    return found


def files(*patterns) -> list:
    """The project's files of these patterns, as they are named in git."""
    paths = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in paths]


class Gate:
    """One pass over the project: `problems` are lines, `now` the sources of each passage."""

    def __init__(self):
        self.chapter, self.meta = split(read_text(CHAPTER)), load_meta()
        self.regions, self.problems = split_all()
        self.passages: dict = {}
        for each in filter(lambda each: each.text, passages()):
            if each.name in self.passages:
                self.say(each.file, each.line, f"a second heading {each.name}", "rename one")
            self.passages[each.name] = each
        self.now = {p.name: p.sources(self.regions.values()) for p in self.passages.values()}

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check_marks(self):
        """What the chapter includes, and its slots name, is there, and nothing lacks a place."""
        known: dict = {("region", r.source): (r.file, r.line - 1) for r in self.regions.values()}
        for file in files("exercises/ex*.py"):
            known["exercise", Path(file).stem.split("_")[0]] = file, 1
        for file in files(FIGURES):
            several = KEY.findall(read_text(file).partition("export const figures = {")[2])
            known |= {("figure", name): (file, 1) for name in several or [Path(file).stem]}
        for kind, folder in stored.FOLDERS.items():
            drawn = files(f"{folder}/*.svg")  # some of them have a place, others have none
            known |= {(kind, Path(file).stem.removeprefix("error-")): None for file in drawn}
        shown = Counter()
        for kind, name, line, _ in self.chapter:
            mark = kind, name.partition("?")[0]  # behind it a figure's settings
            shown[mark] += 1
            if kind in ("region", "figure", "exercise", *stored.FOLDERS) and mark not in known:
                names = ", ".join(name for each, name in known if each == kind)
                self.say(CHAPTER, line, f"there is no {kind} {mark[1]}", f"name one of {names}")
            elif shown[mark] > 1 and mark in known and kind != "figure":
                self.say(CHAPTER, line, f"{kind} {name} stands here again", "delete one of the two")
        for line, what, repair in faults(self.chapter):
            self.say(CHAPTER, line, what, repair)
        for mark, place in known.items():
            if place and not shown[mark]:
                self.say(*place, f"{' '.join(mark)} has no place in {CHAPTER}", "give it one")

    def check_names(self):
        """Names in `code` and flags, of chapter and captions, are in some code or in meta.yaml."""
        code = files("*.py", "exercises/**/*.py", "curriculum/*.py", "curriculum/[!t]*/*.py")
        known = set(re.findall(r"--[a-z]\w*|\w+", "".join(map(read_text, [*code, "meta.yaml"]))))
        contact.add_flags(lambda flag, **_: known.add(flag))
        for each in self.passages.values():
            for match in SPAN.finditer(each.text) if each.file.startswith("curriculum") else ():
                for name in {*re.findall(r"^[A-Za-z_]\w+$|--[a-z]\w*", match[1])} - known:
                    what = f"`{name}` is in no code"
                    self.say(each.file, each.line_of(match.start()), what, "name what is there")

    def check_numbers(self):
        """None is typed into the chapter's prose, every reference can be made, what holds a
        sentence is true, and each run is quoted. What numbers are goes into `now`."""
        for _, _, first, text in (p for p in self.chapter if p.kind in ("text", "heading")):
            for token in TYPED.finditer(blank(NOT_PROSE, text)):
                line, number = first + line_at(text, token.start()) - 1, token[0].rstrip(".,")
                repair = f"write {{{{KEY|FORMAT}}}} or {{{{= {number} | REASON}}}}"
                self.say(CHAPTER, line, f"a typed number, {number}", repair)
        quoting = [each for each in self.passages.values() if each.file in TEXTS]
        prepare(text := "".join(each.text for each in quoting))
        found = [(each, match) for each in quoting for match in REFERENCE.finditer(each.text)]
        for passage, match in found:
            claim, asked = match.groups()
            try:
                number = shown(asked) if asked else hold(claim)
                if asked and not asked.startswith("="):
                    self.now[passage.name][asked] = number
            except TextError as error:
                line = passage.line_of(match.start(match.lastindex))
                self.say(passage.file, line, error, "correct the text, or name what is known")
        for name in [*self.meta["runs"]][1:]:
            if f"{name}:" not in text:
                self.say("meta.yaml", 1, f"run {name} is quoted nowhere", "take it out")

    def unread(self, read) -> dict:
        """{name of a passage: what is not as somebody has read it, in words}."""
        unread: dict = {}
        for name, sources in self.now.items():
            was = read.get(name, {})
            for source, now in sources.items():
                if source not in was:
                    unread.setdefault(name, []).append(f"nobody has read {source} there")
                elif was[source] != now:
                    number = f"{{{{{source}}}}}" in self.passages[name].text
                    words = f"was {was[source]} and is {now}" if number else "changed"
                    unread.setdefault(name, []).append(f"{source} {words}")
        return unread

    def record(self, names=()) -> dict:
        """What meta.yaml ought to keep when somebody has read these passages, too."""
        read = self.meta["read"] | {name: self.now[name] for name in names}
        hashes = {region.name: region.sha for region in self.regions.values()}
        return {
            "region_hashes": self.meta["region_hashes"] if self.unread(read) else hashes,
            "read": {name: read[name] for name in self.passages if read.get(name)},
        }

    def check_read(self):
        """All passages are read as they are, and nothing is kept of what is gone."""
        for name, moved in self.unread(self.meta["read"]).items():
            each = self.passages[name]
            what = f"read {name!r} again: {', '.join(moved)}"
            self.say(each.file, each.line, what, f"{GATE} --read {shlex.quote(name)}")
        for key, right in self.record().items():
            kept = self.meta[key]
            if wrong := [n for n in {**kept, **right} if kept.get(n) != right.get(n)]:
                what = f"its {key} keeps what is gone, or other, of {', '.join(wrong)}"
                self.say("meta.yaml", 1, what, f"{GATE} --read")

    def check_results(self):
        """Results and rows of the ledger are of today's code; all that are not make one problem."""
        stale = [  # what, its file, the command that measures it again, what changed
            (f"{name} {part}", f"{folder}/made.json", about["command"], moved)
            for name, folder in stored.FOLDERS.items()
            for part, about in stored.load(folder)[1].items()
            if (moved := stored.changed(about["code"]))
        ]
        for row in filter(stored.stale, stored.ledger()):
            tier = row["tier"]
            stale.append(
                (f"the wall-clock of {tier}", "wallclock.csv", f"{stored.COMMAND} {tier}", [])
            )
        if stale:
            parts, places, commands, moved = zip(*stale)
            sources = ", ".join([*dict.fromkeys(sum(moved, []))][:6]) or "the code"
            what = f"{sources} changed since these were measured: {', '.join(parts)}"
            again = "; ".join(dict.fromkeys(commands))
            self.say(places[0], 1, what, f"whoever merges types {again}")


def check() -> int:
    """Print every problem, and the command that says that all is read."""
    gate = Gate()
    gate.check_marks()
    gate.check_names()
    gate.check_numbers()
    gate.check_read()
    gate.check_results()
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(unread := gate.unread(gate.meta["read"])) > 1:
        print(f"\nwhen all of them are read: {GATE} --read {shlex.join(unread)}")
    return 1 if gate.problems else 0


def read(names) -> int:
    """Record that somebody has read these passages, as they are now."""
    gate = Gate()
    unknown = [name for name in names if name not in gate.passages]
    if gate.problems or unknown:
        wrong = f"given {', '.join(unknown)}; allowed: {', '.join(gate.passages)}"
        raise TextError("\n".join(gate.problems) or wrong)
    gate.check_numbers()
    text = read_text("meta.yaml").partition("\nregion_hashes:")[0].rstrip() + "\n\n"
    for key, kept in gate.record(names).items():
        flow = None if key == "read" else False  # a line each
        form = {"sort_keys": False, "allow_unicode": True, "width": 10**6}
        text += yaml.safe_dump({key: kept}, default_flow_style=flow, **form)
    write_whole(ROOT / "meta.yaml", text)
    print(f"recorded in meta.yaml as read: {', '.join(names) or 'nothing more'}")
    return 0


def main(argv=None) -> int:
    """Check or record. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog=GATE, description=__doc__)
    parser.add_argument("--read", metavar="HEADING", nargs="*", help="what you have read")
    names = parser.parse_args(argv).read
    try:
        return check() if names is None else read(names)
    except SyntaxError as error:
        print(f"{error.filename}:{error.lineno}: not Python: {error.msg}", file=sys.stderr)
    except (OSError, TextError) as error:
        print(error, file=sys.stderr)
    return 2


if __name__ == "__main__":
    raise SystemExit(main())
