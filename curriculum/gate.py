"""The gate: check the chapter against the code and its numbers.

    python -m curriculum.gate                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --read "HEADING"  # you have reviewed these, as they are now

It checks that every region is included once; that slots, their settings, flags and names in `code`
exist; that numbers are quoted by reference, ratios in words held by a claim; that results are of
today's code. Whether a sentence is true only a reader can say: meta.yaml keeps what each passage
depended on at its last review, its numbers and the hashes of its code: of the text of what it
shows, of the syntax of what it names. When one has changed, or is new, the gate asks for a review.
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
    from curriculum.prose.chapter import CHAPTER, INCLUDE, INLINE, PLAIN, PROSE, Part, faults, split
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

    problems: lines. shows, names: {passage: {source: hash, or reference: number}}, of the text of
    the regions that it includes; of the rest that it depends on, code by its syntax.
    """

    def __init__(self):
        self.chapter, self.meta = split(read_text(CHAPTER)), load_meta()
        (self.regions, self.problems), self.passages = split_all(), {}
        self.shows, self.names = {}, {}
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
        included = INCLUDE.findall(each.text)
        shows, names = self.shows.setdefault(each.name, {}), self.names.setdefault(each.name, {})
        if not each.file.startswith(("exercises/", CHAPTER)):
            names["its words"] = hashlib.sha256(each.text.encode()).hexdigest()[:12]
        for region in self.regions.values():
            if region.source in included:
                shows[region.source] = region.sha
            elif region.defines & words:
                names[region.source] = stored.digits(region.source, region.code)

    def check_marks(self):
        """Includes and slots name what exists, once, and all that exists has a place."""
        known: dict = {("puzzle", ""): None, ("wallclock", ""): None}  # they need no place
        known |= {("region", r.source): (r.file, r.line - 1) for r in self.regions.values()}
        for kind, pattern in (("exercise", EXERCISES), ("figure", FIGURES)):
            known |= {(kind, Path(file).stem.split("_")[0]): (file, 1) for file in files(pattern)}
        for kind, folder in stored.FOLDERS.items():
            drawn = files(f"{folder}/*.svg")  # some of them have a place, others have none
            known |= {(kind, Path(file).stem.removeprefix("error-")): None for file in drawn}
        placed = set()
        for part in (part for part in self.chapter if part.kind not in PLAIN):
            mark = kind, name = part.kind, part.name.partition("?")[0]  # behind it are settings
            if mark not in known and kind != "figure":  # check_slots tries those
                names = ", ".join(name for each, name in known if each == kind)
                self.say(CHAPTER, part.line, f"there is no {kind} {name}", f"name one of {names}")
            elif mark in placed and kind not in ("figure", "puzzle"):
                self.say(CHAPTER, part.line, f"a second {kind} {name}", "delete one of the two")
            placed.add(mark)
        self.problems += faults(self.chapter)
        for mark, place in known.items():
            if place and mark not in placed:
                self.say(*place, f"{' '.join(mark)} has no place in {CHAPTER}", "give it one")

    def check_slots(self):
        """Every figure can be drawn as its slot sets it: the page's own code tries it."""
        slots = [part for part in self.chapter if part.kind == "figure"]
        try:
            for part, error in zip(slots, slot_errors([part.name for part in slots])):
                if error:
                    self.say(CHAPTER, part.line, error, "set what is allowed")
        except ValueError as error:  # of a step that has no JavaScript, or a slip in a module
            self.problems.append(f"{error}; repair: python -m curriculum.page must build")

    def check_names(self):
        """Names and flags in `code` are in code (comments and docstrings are none), or in the list
        of MuJoCo's names in meta.yaml; and each of that list is in the chapter."""
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
                named = NAMED.findall(match[1]) + WORD.findall(match[1]) * (each.name in self.names)
                for name in {*named} - known:
                    repair = f"name what exists, or list it in {META}, reading"
                    self.say(each.file, each.line_of(match), f"`{name}` is in no code", repair)
        for name in reading.get("names", ()):
            if not re.search(rf"\b{name}\b", read_text(CHAPTER)):
                self.say(META, 1, f"reading: {name} is not in the chapter", "take it out")

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
        """References can be made, claims are true, each run is quoted. Notes the numbers."""
        prepare(text := read_text(CHAPTER))
        for each in self.passages.values():
            for match in REFERENCE.finditer(each.text) if each.file == CHAPTER else ():
                try:
                    number = shown(match[1])
                    if not match[1].startswith(("?", "=")):
                        self.names[each.name][match[1]] = number
                except TextError as error:
                    repair = "correct the text, or name what is known"
                    self.say(CHAPTER, each.line_of(match, 1), error, repair)
        for name in [*self.meta["runs"]][1:]:
            if f"{name}:" not in text:
                self.say(META, 1, f"run {name} is quoted nowhere", "take it out")

    def record(self, names=()) -> tuple:
        """Return region_hashes and read, as meta.yaml keeps them once these passages are reviewed.

        A region's hash is the one that the passage which includes it was reviewed with.
        """
        hashes, read = {}, {}
        for name, shows in self.shows.items():
            for source, now in shows.items():
                region = source.partition("#")[2]
                was = self.meta["region_hashes"].get(region)
                hashes[region] = now if name in names else was
            now, was = self.names[name], self.meta["read"].get(name, {})
            read[name] = now if name in names else {k: was[k] for k in was if k in now}
        in_order = {name: hashes[name] for name in self.regions if hashes.get(name)}
        return in_order, {name: kept for name, kept in read.items() if kept}

    def check_read(self) -> list:
        """Return the names of the passages that somebody has to review."""
        unread, (hashes, read) = [], self.record()
        for name, each in self.passages.items():
            was = {source: hashes.get(source.partition("#")[2]) for source in self.shows[name]}
            was |= read.get(name, {})
            moved = ", ".join(
                f"{source} was {(was.get(source) or 'never read')[:12]} and is {now[:12]}"
                for source, now in (self.shows[name] | self.names[name]).items()
                if was.get(source) != now
            )
            if moved:
                unread.append(name)
                what = f"read {name!r} again: {moved}"
                self.say(each.file, each.line, what, f"{GATE} --read {shlex.quote(name)}")
        for key, right in (("region_hashes", hashes), ("read", read)):
            if gone := [name for name, kept in self.meta[key].items() if right.get(name) != kept]:
                what = f"its {key} keeps what is gone of {', '.join(gone)}"
                self.say(META, 1, what, f"{GATE} --read")
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
            self.say(places[0], 1, what, f"the maintainer runs {again}")


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
    text = read_text(META).partition("\nregion_hashes:")[0].rstrip() + "\n\n"
    form = {"sort_keys": False, "allow_unicode": True, "width": 10**6}
    for key, kept, flow in zip(("region_hashes", "read"), gate.record(names), (False, None)):
        text += yaml.safe_dump({key: kept}, default_flow_style=flow, **form)  # a line each
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
    except (OSError, TextError) as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
