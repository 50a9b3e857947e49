"""The gate: check the chapter against the code and its numbers.

    python -m curriculum.gate                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --read "HEADING"  # you have reviewed these, as they are now

It checks that every region is included once; that slots, their settings, flags and names in `code`
exist; that numbers are quoted by reference, ratios in words held by a claim; that results are of
today's code. Whether a sentence is true only a reader can say: meta.yaml keeps what
each passage depended on at its last review, its numbers and the hashes of its code: of the text of
what it shows, of the syntax of what it names. When one has changed, is new or gone, the gate asks
for a review.
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
    from curriculum.page.build import slot_errors
    from curriculum.prose.chapter import CHAPTER, INCLUDE, INLINE, PROSE, Part, faults, split
    from curriculum.prose.ratios import loose_ratios
    from curriculum.prose.references import REFERENCE, TextError, load_meta, prepare, shown
    from curriculum.source import DOCSTRING, ROOT, blank, read_text, split_all

GATE = "python -m curriculum.gate"
EXERCISES, FIGURES = "exercises/ex*.py", "curriculum/page/figures/*.js"
META, TEXTS = "meta.yaml", ("README.md", "CONTRIBUTING.md")
CAPTION = re.compile(r"^( *)(?:title|caption):.*\n(?:\1 +.*\n)*", re.MULTILINE)
STRING = re.compile(r"\"[^\"]*\"|`[^`]*`")
COMPUTED = re.compile(r"\$\{[^{}]*\}")
SPAN = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
NAMED = re.compile(r"--[a-z][\w-]*|(?<![\w/.-])[A-Za-z]\w*_\w+|\b[a-z]\w+(?=\()")
WORD = re.compile(r"^[A-Za-z_]\w+$")  # alone it is a name in a passage, and elsewhere may be none
NO_CODE = re.compile(r'"""(?s:.*?)"""|#.*')
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


def passages():
    """Yield what a reader reads in one go: a heading of the chapter with its text, an exercise, the
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
    for file in files(EXERCISES):
        yield Part("exercise", Path(file).stem.split("_")[0], 1, read_text(file), file)
    for file in ("contact.py", "curriculum/exact.py"):
        yield Part("opening", Path(file).name, 1, DOCSTRING.match(read_text(file))[0], file)
    for file in files(FIGURES):
        captions = "\n".join(caption[0] for caption in CAPTION.finditer(read_text(file)))
        captions = STRING.sub(lambda m: m[0] if m[0][0] == '"' else f'"{m[0][1:-1]}"', captions)
        yield Part("figure", f"figures/{Path(file).stem}", 1, captions, file)


def files(*patterns) -> list:
    """Return the project's files of these patterns, as they are named in git."""
    paths = sorted(path for pattern in patterns for path in ROOT.glob(pattern))
    return [path.relative_to(ROOT).as_posix() for path in paths]


class Gate:
    """One pass over the project.

    problems: lines. depends: {passage: {source: hash, or reference: number}}; of a region that it
    includes the hash is one of the text, of other code one of the syntax.
    """

    def __init__(self):
        self.chapter, self.meta = split(read_text(CHAPTER)), load_meta()
        (self.regions, self.problems), self.passages, self.depends = split_all(), {}, {}
        for each in filter(lambda each: each.text, passages()):
            if each.name in self.passages:
                self.say(each.file, each.line, f"a second heading {each.name}", "rename one")
            self.passages[each.name] = each
            self.depend(each)

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def depend(self, each):
        """Note the code that a passage shows or names, and its own words where it is in code."""
        words = set(re.findall(r"\w+", " ".join(SPAN.findall(each.text))))
        included, depends = INCLUDE.findall(each.text), self.depends.setdefault(each.name, {})
        if not each.file.startswith(("exercises/", CHAPTER)):
            depends["its words"] = hashlib.sha256(each.text.encode()).hexdigest()[:12]
        for region in self.regions.values():
            if region.source in included:
                depends[region.source] = region.sha[:12]
            elif region.defines & words:
                depends[region.source] = stored.digits(region.source, region.code)

    def check_marks(self):
        """Includes and slots are well formed; each region, exercise and figure has its place."""
        self.problems += faults(self.chapter)
        places = {("region", r.source): (r.file, r.line - 1) for r in self.regions.values()}
        for kind, pattern in (("exercise", EXERCISES), ("figure", FIGURES)):
            places |= {(kind, Path(file).stem.split("_")[0]): (file, 1) for file in files(pattern)}
        placed = set()
        for part in self.chapter:
            mark = kind, name = part.kind, part.name.partition("?")[0]  # behind it are settings
            if kind in ("region", "exercise") and mark not in places:
                names = ", ".join(name for each, name in places if each == kind)
                self.say(CHAPTER, part.line, f"there is no {kind} {name}", f"name one of {names}")
            elif kind in ("region", "exercise") and mark in placed:
                self.say(CHAPTER, part.line, f"a second {kind} {name}", "delete one of the two")
            placed.add(mark)
        for mark, place in places.items():
            if mark not in placed:
                self.say(*place, f"{' '.join(mark)} has no place in {CHAPTER}", "give it one")

    def check_slots(self):
        """Every figure can be drawn as its slot sets it: the page's own code tries it."""
        slots = [part for part in self.chapter if part.kind == "figure"]
        for part, error in zip(slots, slot_errors([part.name for part in slots])):
            if error:
                self.say(CHAPTER, part.line, error, "set what is allowed")

    def check_names(self):
        """Names and flags in `code` are in code (comments and docstrings are none), or in the list
        of MuJoCo's names in meta.yaml."""
        code = files("*.py", "exercises/**/*.py", "curriculum/*.py", "curriculum/[!t]*/*.py")
        known = {Path(file).stem for file in files("curriculum/**/*.py")}
        known |= {flag for each in contact.make_parser()._actions for flag in each.option_strings}
        for file in code:
            known.update(re.findall(r"--[a-z]\w*|\w+", NO_CODE.sub("", read_text(file))))
        reading = self.meta.get("reading", {})
        known |= {*reading.get("names", ()), *chain(*reading.get("files", {}).values())}
        texts = [part._replace(file=file) for file in TEXTS for part in split(read_text(file))]
        for each in (*self.passages.values(), *(part for part in texts if part.kind in PROSE)):
            for match in SPAN.finditer(each.text):
                named = NAMED.findall(match[1]) + WORD.findall(match[1]) * (
                    each.name in self.depends
                )
                for name in {*named} - known:
                    repair = f"name what exists, or list it in {META}, reading"
                    self.say(each.file, each.line_of(match), f"`{name}` is in no code", repair)

    def check_typed(self):
        """Prose and captions type no number, and claims hold the ratios in words beside them."""
        for part in (part for part in self.chapter if part.kind in PROSE):
            for token in TYPED.finditer(blank(NOT_PROSE, part.text)):
                number = token[0].rstrip(".,")
                repair = f"write {{{{KEY|FORMAT}}}} or {{{{= {number} | REASON}}}}"
                self.say(CHAPTER, part.line_of(token), f"a typed number, {number}", repair)
            for match, number in loose_ratios(part.text):
                what = f"no claim of its sentence holds {match[0]!r}"
                repair = f"add {{{{? LOW < FORMULA < HIGH}}}} around {number:.4g}"
                repair += f", or write {{{{= {match[0]} | REASON}}}}"
                self.say(CHAPTER, part.line_of(match), what, repair)
        for each in (each for each in self.passages.values() if each.kind == "figure"):
            text = each.text
            while COMPUTED.search(text):  # from the innermost out
                text = blank(COMPUTED, text)
            for token in TYPED.finditer(" ".join(STRING.findall(text))):
                what = f"a typed number in a caption, {token[0]}"
                self.say(each.file, each.line, what, "compute it: `${...}`")

    def check_numbers(self):
        """References can be made, claims are true. Notes the numbers."""
        prepare(read_text(CHAPTER))
        for each in self.passages.values():
            for match in REFERENCE.finditer(each.text) if each.file == CHAPTER else ():
                try:
                    number = shown(match[1])
                    if not match[1].startswith(("?", "=")):
                        self.depends[each.name][match[1]] = number
                except TextError as error:
                    repair = "correct the text, or name what is known"
                    self.say(CHAPTER, each.line_of(match, 1), error, repair)

    def check_read(self) -> list:
        """Return the names of the passages that somebody has to review."""
        unread = []
        for name, now in self.depends.items():
            was, each = self.meta["read"].get(name, {}), self.passages[name]
            moved = ", ".join(
                f"{source} was {was.get(source, 'never read')} and is {now.get(source, 'gone')}"
                for source in now | was
                if was.get(source) != now.get(source)
            )
            if moved:
                unread.append(name)
                what = f"read {name!r} again: {moved}"
                self.say(each.file, each.line, what, f"{GATE} --read {shlex.quote(name)}")
        return unread

    def check_results(self):
        """Results and rows of the ledger are of today's code."""
        measured = [  # where it is kept, what measures it again, what changed since then
            (f"{folder}/made.json", about["command"], stored.changed(about["code"]))
            for folder in stored.FOLDERS.values()
            for about in stored.load(folder)[1].values()
        ]
        for row in filter(stored.stale, stored.ledger()):
            measured.append(("wallclock.csv", f"{stored.TIMES} {row['tier']}", stored.TIMED))
        for place, command, moved in (each for each in measured if each[2]):
            what = f"measured on other code; since then these changed: {', '.join(moved[:6])}"
            self.say(place, 1, what, f"the maintainer runs {command}")


def check(release=False) -> int:
    """Print every problem, and the command that says that all is reviewed.

    Results of other code are a problem of a release alone: a change need not measure them again.
    """
    gate = Gate()
    for each in (gate.check_marks, gate.check_slots, gate.check_names, gate.check_typed):
        each()
    gate.check_numbers()
    unread, wrong = gate.check_read(), len(gate.problems)
    gate.check_results()
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(unread) > 1:
        print(f"\nwhen all of them are read: {GATE} --read {shlex.join(unread)}")
    return 1 if wrong or (release and gate.problems) else 0


def read(names) -> int:
    """Record that somebody has reviewed these passages, as they are now."""
    gate = Gate()
    unknown = [name for name in names if name not in gate.passages]
    if gate.problems or unknown:
        wrong = f"given {', '.join(unknown)}; allowed: {', '.join(gate.passages)}"
        raise TextError("\n".join(gate.problems) or wrong)
    gate.check_numbers()
    was, hashes = gate.meta["read"], {r.name: r.sha for r in gate.regions.values()}
    kept = {name: now if name in names else was.get(name) for name, now in gate.depends.items()}
    text = read_text(META).partition("\nregion_hashes:")[0].rstrip() + "\n\n"
    form = {"sort_keys": False, "allow_unicode": True, "width": 10**6}
    text += yaml.safe_dump({"region_hashes": hashes}, default_flow_style=False, **form)
    kept = {name: read for name, read in kept.items() if read}
    text += yaml.safe_dump({"read": kept}, default_flow_style=None, **form)  # a line each
    write_atomic(ROOT / META, text)
    print(f"recorded in {META} as read: {', '.join(names) or 'nothing more'}")
    return 0


def main(argv=None) -> int:
    """Check or record. Returns the exit status: 0 in order, 1 not, 2 could not be done."""
    parser = Parser(prog=GATE, description=__doc__)
    parser.add_argument("--read", metavar="HEADING", nargs="*", help="what you have reviewed")
    parser.add_argument("--release", action="store_true", help="results must be of today's code")
    args = parser.parse_args(argv)
    try:
        return check(args.release) if args.read is None else read(args.read)
    except (OSError, ValueError) as error:  # what names a place and a repair
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
