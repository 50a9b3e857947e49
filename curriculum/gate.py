"""The gate: what the chapter says, against what the code is and does.

    python -m curriculum.gate                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --read "HEADING"  # you have read these, as they are now

Regions are included once; slots, flags and names in `code` are of what is there; numbers are quoted
by reference, what holds a sentence is true, and results are of today's code. Whether a sentence is
true of the code only a reader can say. meta.yaml keeps what each passage spoke of when it was last
read: the hashes of its regions, its numbers. Where one of them is another today, or new, the gate
asks to read the passage again. region_hashes are those of the code when that was last written.
"""

import hashlib
import re
import shlex
import sys
from itertools import chain
from pathlib import Path

from curriculum.commands import Parser, needs, write_atomic

with needs("dev"):
    import yaml

    import contact
    from curriculum import stored
    from curriculum.prose.chapter import CHAPTER, INCLUDE, INLINE, PLAIN, PROSE, Part, faults, split
    from curriculum.prose.references import REFERENCE, TextError, load_meta, prepare, shown
    from curriculum.source import DOCSTRING, ROOT, blank, read_text, split_all

GATE = "python -m curriculum.gate"
FIGURES = "curriculum/page/figures/*.js"
KEY = re.compile(r"^  \"?([\w-]+)\"?:", re.MULTILINE)  # of a table with a line each
CAPTION = re.compile(
    r"""\b(?:title|caption):\s*(?:("|`)(?:(?!\1)[^\\]|\\.)*\1[\s+]*)+""", re.DOTALL
)
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
# Where numbers may be typed in text: code and formulas, references, links, numbers of headings and
# lists, and what follows some words.
NOT_PROSE = re.compile(
    rf"""
    {INLINE.pattern}|{REFERENCE.pattern}|\]\([^)]*\)|https?://\S+|\[\[\d+\]\](?=\(\#references\))
    |\b(?:chapter|version|tag|python)[ ]\d+(?:\.\d+)+|^\#+[ ]+[\d.]+|^\d+\.[ ]
    """,
    re.DOTALL | re.MULTILINE | re.IGNORECASE | re.VERBOSE,
)
TYPED = re.compile(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*")  # a token that begins with a digit


def sources(passage, regions) -> dict:
    """{source: hash}: the regions that it includes or names, and its own words in code."""
    included, named = INCLUDE.findall(passage.text), " ".join(SPAN.findall(passage.text))
    words = set(re.findall(r"\w+", named))
    own = not passage.file.startswith(("exercises/", CHAPTER))
    found = {"its words": hashlib.sha256(passage.text.encode()).hexdigest()} if own else {}
    found |= {r.source: r.sha for r in regions if r.source in included or r.defines & words}
    return {source: sha[:12] for source, sha in found.items()}


def passages():
    """What a reader reads in one go: a heading of the chapter with its text, an exercise, the
    captions of a figure, or the opening words of contact.py (the signs) and exact.py (the promise).

    Each has the name that one types when one has read it.
    """
    headings = []
    for part in split(read_text(CHAPTER)):
        if part.kind == "heading":
            headings.append(part._replace(text=""))
        if headings:
            headings[-1] = headings[-1]._replace(text=headings[-1].text + part.text)
    yield from headings
    for file in files("exercises/ex*.py"):
        yield Part("exercise", Path(file).stem.split("_")[0], 1, read_text(file), file)
    for file in ("contact.py", "curriculum/exact.py"):
        yield Part("opening", Path(file).name, 1, DOCSTRING.match(read_text(file))[0], file)
    for file in files(FIGURES):
        captions = "\n".join(caption[0] for caption in CAPTION.finditer(read_text(file)))
        yield Part("figure", f"figures/{Path(file).stem}", 1, captions, file)


def files(*patterns) -> list:
    """The project's files of these patterns, as they are named in git."""
    paths = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in paths]


class Gate:
    """One pass over the project: `problems` are lines, `now` the sources of each passage."""

    def __init__(self):
        self.chapter, self.meta = split(read_text(CHAPTER)), load_meta()
        (self.regions, self.problems), self.passages, self.now = split_all(), {}, {}
        for each in filter(lambda each: each.text, passages()):
            if each.name in self.passages:
                self.say(each.file, each.line, f"a second heading {each.name}", "rename one")
            self.passages[each.name] = each
            self.now[each.name] = sources(each, self.regions.values())

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check_marks(self):
        """What the chapter includes, and its slots name, is there, and nothing lacks a place."""
        known: dict = {("puzzle", ""): None, ("wallclock", ""): None}  # they need no place
        known |= {("region", r.source): (r.file, r.line - 1) for r in self.regions.values()}
        for each in self.passages.values():
            if each.kind == "exercise":
                known["exercise", each.name] = each.file, 1
        for file in files(FIGURES):
            several = KEY.findall(read_text(file).partition("export const figures = {")[2])
            known |= {("figure", name): (file, 1) for name in several or [Path(file).stem]}
        for kind, folder in stored.FOLDERS.items():
            drawn = files(f"{folder}/*.svg")  # some of them have a place, others have none
            known |= {(kind, Path(file).stem.removeprefix("error-")): None for file in drawn}
        placed = set()
        for part in (part for part in self.chapter if part.kind not in PLAIN):
            mark = kind, name = part.kind, part.name.partition("?")[0]  # behind it are settings
            if mark not in known:
                names = ", ".join(name for each, name in known if each == kind)
                self.say(CHAPTER, part.line, f"there is no {kind} {name}", f"name one of {names}")
            elif mark in placed and kind not in ("figure", "puzzle"):
                self.say(CHAPTER, part.line, f"a second {kind} {name}", "delete one of the two")
            placed.add(mark)
        self.problems += faults(self.chapter)
        for mark, place in known.items():
            if place and mark not in placed:
                self.say(*place, f"{' '.join(mark)} has no place in {CHAPTER}", "give it one")

    def check_names(self):
        """Names in `code` and flags, of chapter and captions, are in some code or in meta.yaml."""
        code = files("*.py", "exercises/**/*.py", "curriculum/*.py", "curriculum/[!t]*/*.py")
        known = set(re.findall(r"--[a-z]\w*|\w+", "".join(map(read_text, [*code, "meta.yaml"]))))
        known |= {flag for each in contact.make_parser()._actions for flag in each.option_strings}
        for each in self.passages.values():
            for match in SPAN.finditer(each.text) if each.file.startswith("curriculum") else ():
                for name in {*re.findall(r"^[A-Za-z_]\w+$|--[a-z]\w*", match[1])} - known:
                    what = f"`{name}` is in no code"
                    self.say(each.file, each.line_of(match), what, "name what is there")

    def check_numbers(self):
        """None is typed into the chapter's prose, every reference can be made, what holds a
        sentence is true, and each run is quoted. What numbers are goes into `now`."""
        for part in (part for part in self.chapter if part.kind in PROSE):
            for token in TYPED.finditer(blank(NOT_PROSE, part.text)):
                number = token[0].rstrip(".,")
                repair = f"write {{{{KEY|FORMAT}}}} or {{{{= {number} | REASON}}}}"
                self.say(CHAPTER, part.line_of(token), f"a typed number, {number}", repair)
        prepare(text := read_text(CHAPTER))
        for each in self.passages.values():
            for match in REFERENCE.finditer(each.text) if each.file == CHAPTER else ():
                try:
                    number = shown(match[1])
                    if not match[1].startswith(("?", "=")):
                        self.now[each.name][match[1]] = number
                except TextError as error:
                    repair = "correct the text, or name what is known"
                    self.say(CHAPTER, each.line_of(match, 1), error, repair)
        for name in [*self.meta["runs"]][1:]:
            if f"{name}:" not in text:
                self.say("meta.yaml", 1, f"run {name} is quoted nowhere", "take it out")

    def record(self, names=()) -> dict:
        """What meta.yaml ought to keep when somebody has read these passages, too."""
        read = self.meta["read"] | {name: self.now[name] for name in names}
        spoken = {  # of what each passage still speaks of
            name: {source: was for source, was in read.get(name, {}).items() if source in now}
            for name, now in self.now.items()
        }
        return {
            "region_hashes": {region.name: region.sha for region in self.regions.values()},
            "read": {name: kept for name, kept in spoken.items() if kept},
        }

    def check_read(self) -> list:
        """All passages are read as they are, and nothing is kept of what is gone. Returns the
        names of those that somebody has to read."""
        unread = []
        for name, sources in self.now.items():
            was, each = self.meta["read"].get(name, {}), self.passages[name]
            moved = ", ".join(
                f"{source} was {was.get(source, 'never read')} and is {now}"
                for source, now in sources.items()
                if was.get(source) != now
            )
            if moved:
                unread.append(name)
                what = f"read {name!r} again: {moved}"
                self.say(each.file, each.line, what, f"{GATE} --read {shlex.quote(name)}")
        for key, right in self.record().items():
            kept = self.meta[key]
            if wrong := [n for n in {**kept, **right} if kept.get(n) != right.get(n)]:
                what = f"its {key} keeps what is gone, or other, of {', '.join(wrong)}"
                self.say("meta.yaml", 1, what, f"{GATE} --read")
        return unread

    def check_results(self):
        """Results and rows of the ledger are of today's code; all that are not make one problem."""
        measured = [  # where it is kept, what measures it again, what changed since then
            (f"{folder}/made.json", about["command"], stored.changed(about["code"]))
            for folder in stored.FOLDERS.values()
            for about in stored.load(folder)[1].values()
        ]
        for row in filter(stored.stale, stored.ledger()):
            measured.append(("wallclock.csv", f"{stored.TIMES} {row['tier']}", stored.TIMED))
        if stale := [each for each in measured if each[2]]:
            places, commands, moved = zip(*stale)
            changed = ", ".join([*dict.fromkeys(chain(*moved))][:6])
            what = f"measured on other code; since then these changed: {changed}"
            again = "; ".join(dict.fromkeys(commands))
            self.say(places[0], 1, what, f"whoever merges types {again}")


def check() -> int:
    """Print every problem, and the command that says that all is read."""
    gate = Gate()
    gate.check_marks()
    gate.check_names()
    gate.check_numbers()
    unread = gate.check_read()
    gate.check_results()
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(unread) > 1:
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
    write_atomic(ROOT / "meta.yaml", text)
    print(f"recorded in meta.yaml as read: {', '.join(names) or 'nothing more'}")
    return 0


def main(argv=None) -> int:
    """Check or record. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog=GATE, description=__doc__)
    parser.add_argument("--read", metavar="HEADING", nargs="*", help="what you have read")
    names = parser.parse_args(argv).read
    try:
        return check() if names is None else read(names)
    except (OSError, TextError) as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
