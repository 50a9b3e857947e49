"""The gate: what chapter and README say, against what the code is and does.

    python -m curriculum.gate                   # check, write nothing; exit 1 and a line a problem
    python -m curriculum.gate --read "HEADING"  # you have read these, as they are now

Regions are included once; slots, flags and names in `code` are of what is there; numbers are quoted
by reference, what holds a sentence is true, and results are of today's code. Whether a sentence is
true of the code only a reader can say. meta.yaml keeps what each passage spoke of when it was last
read: the hashes of its regions, its numbers. Where one of them is another today, or new, the gate
asks to read the passage again. region_hashes are those of regions whose passages are all read.
"""

import re
import shlex
import sys
from collections import Counter
from pathlib import Path

from curriculum.commands import Parser, needs, write_whole

with needs("dev"):
    import yaml

    import contact
    from curriculum import stored
    from curriculum.gate.chapter import CHAPTER, faults, split
    from curriculum.gate.passages import FIGURES, SPAN, TEXTS, files, passages
    from curriculum.gate.references import REFERENCE, Numbers, TextError, load_meta
    from curriculum.lesson.regions import ROOT, blank, line_at, read_text, split_all

GATE = "python -m curriculum.gate"
KEY = re.compile(r"^  \"?([\w-]+)\"?:", re.MULTILINE)  # of a table with a line each
# Where numbers may be typed in text: formulas, references, links, code, numbers of headings and
# lists, versions with two dots, and what follows some words.
NOT_PROSE = re.compile(
    r"""
    \$\$.+?\$\$|\$[^$\n]+\$
    |\{\{\?.*?\}\}|\{\{[^\n]*?\}\}
    |\[[^]]*\]\(try:[^)]*\)|\]\([^)]*\)|https?://\S+
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


class Gate:
    """One pass over the project: `problems` are lines, `now` the sources of each passage."""

    def __init__(self):
        self.chapter, self.meta = split(read_text(CHAPTER)), load_meta()
        self.regions, self.problems = split_all()
        self.passages: dict = {}
        for each in passages():
            if each.name in self.passages:
                self.say(each.file, each.line, f"a second heading {each.name}", "rename one")
            self.passages[each.name] = each
        self.now = {p.name: p.regions(self.regions.values()) for p in self.passages.values()}

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check_marks(self):
        """What the chapter includes, and its slots name, is there, and nothing lacks a place."""
        known, shown = self.known(), Counter()
        for kind, name, line, _ in self.chapter:
            name = name.partition("?")[0]  # behind it a figure's settings
            shown[kind, name] += 1
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
        regions = {r.source: (r.file, r.line - 1) for r in self.regions.values()}
        exercises = {Path(f).name.split("_")[0]: (f, 1) for f in files("exercises/ex*.py")}
        figures: dict = {}
        for file in files(FIGURES):
            several = read_text(file).partition("export const figures = {")[2]
            names = KEY.findall(several) or re.findall(r"[\w-]+", several.partition("}")[0])
            figures |= dict.fromkeys(names or [Path(file).stem], (file, 1))
        known = {"region": regions, "exercise": exercises, "figure": figures}
        for kind, folder in stored.FOLDERS.items():
            drawn = files(f"{folder}/*.svg")
            known[kind] = {Path(f).stem.removeprefix("error-"): (f, 1) for f in drawn}
        return known

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
        numbers, text = Numbers(), "".join(each.text for each in quoting)
        numbers.prepare(text)
        for each in quoting:
            for match in REFERENCE.finditer(each.text):
                self.check_number(numbers, each, *match.groups(), match.start(match.lastindex))
        for name in [*self.meta["runs"]][1:]:
            if f"{name}:" not in text:
                self.say("meta.yaml", 1, f"run {name} is quoted nowhere", "take it out")

    def check_number(self, numbers, passage, claim, asked, index):
        """One reference of a passage."""
        try:
            if claim and (false := numbers.broken(claim)):
                what = f"{claim!r} does not hold: {false}"
                self.say(passage.file, passage.line_of(index), what, "correct the text")
            elif asked and (shown := numbers.text(asked)) and not asked.startswith("="):
                self.now[passage.name][asked] = shown
        except TextError as error:
            what = f"{claim or asked!r}: {error}"
            self.say(passage.file, passage.line_of(index), what, "name what is known")

    def moved(self, passage) -> list:
        """What is not as it was when somebody read a passage, in words."""
        was, words = self.meta["read"].get(passage.name), []
        for source, now in self.now[passage.name].items():
            if was is None:
                return ["nobody has read it"]
            if source not in was:
                words.append(f"nobody has read {source} there")
            elif was[source] != now:
                number = f"{{{{{source}}}}}" in passage.text
                words.append(
                    f"{source} " + (f"was {was[source]} and is {now}" if number else "changed")
                )
        return words

    def unread(self) -> dict:
        """{name: what moved} of the passages that somebody must read."""
        return {p.name: moved for p in self.passages.values() if (moved := self.moved(p))}

    def hashes(self) -> dict:
        """region_hashes as they ought to be: today's, or as they were while a passage waits."""
        waiting = {source for name in self.unread() for source in self.now[name]}
        was, regions = self.meta["region_hashes"], self.regions.values()
        shas = {r.name: was.get(r.name) if r.source in waiting else r.sha for r in regions}
        return {name: sha for name, sha in shas.items() if sha}

    def check_read(self):
        """All passages are read as they are, and nothing is kept of what is gone."""
        for name, moved in self.unread().items():
            each = self.passages[name]
            what = f"read {name!r} again: {', '.join(moved)}"
            self.say(each.file, each.line, what, f"{GATE} --read {shlex.quote(name)}")
        kept, right = self.meta["region_hashes"], self.hashes()
        wrong = {name for name in kept | right if kept.get(name) != right.get(name)}
        if wrong := sorted(wrong | (self.meta["read"].keys() - self.passages)):
            what = f"it keeps what is gone, or other, of {', '.join(wrong)}"
            self.say("meta.yaml", 1, what, f"{GATE} --read")

    def check_results(self):
        """Results and rows of the ledger are of today's code; all that are not make one problem."""
        sources, parts, commands = {}, {}, {}
        for name, folder in stored.FOLDERS.items():
            for part, about in stored.load(folder)[1].items():
                if moved := stored.changed(about["code"]):
                    sources |= dict.fromkeys(moved)
                    parts[f"{name} {part}"] = f"{folder}/made.json"
                    commands[about["command"]] = None
        for row in filter(stored.stale, stored.ledger()):
            parts[f"the wall-clock of {row['tier']}"] = "wallclock.csv"
            commands[f"{stored.COMMAND} {row['tier']}"] = None
        if parts:
            moved = ", ".join([*sources][:6]) + ", ..." * (len(sources) > 6) or "the code"
            what = f"{moved} changed since these were measured: {', '.join(parts)}"
            where = next(iter(parts.values()))
            self.say(where, 1, what, f"whoever merges types {'; '.join(commands)}")


def check() -> int:
    """Print every problem, and the command that says that all is read."""
    gate = Gate()
    checks = gate.check_marks, gate.check_names, gate.check_numbers, gate.check_read
    for each in (*checks, gate.check_results):
        each()
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(unread := gate.unread()) > 1:
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
    stamps = gate.meta["read"] | {name: gate.now[name] for name in names}
    gate.meta["read"] = {p: stamps[p] for p in gate.passages if stamps.get(p)}
    head = re.split("^region_hashes:", read_text("meta.yaml"), maxsplit=1, flags=re.MULTILINE)[0]
    form = {"sort_keys": False, "allow_unicode": True, "width": 10**6}
    hashes = yaml.safe_dump({"region_hashes": gate.hashes()}, **form)
    stamps = yaml.safe_dump({"read": gate.meta["read"]}, default_flow_style=None, **form)
    write_whole(ROOT / "meta.yaml", f"{head.rstrip()}\n\n{hashes}{stamps}")
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
