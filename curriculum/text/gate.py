"""The gate's checks: each adds problems, `file:line: what is wrong; repair: what to do`."""

import json
import re
from collections import Counter

from curriculum.commands import write_whole
from curriculum.measured import ledger, results, stale
from curriculum.measured.stale import BLOCK, changed
from curriculum.regions import ROOT, read_text, split_all
from curriculum.text.references import HOLDS, INCLUDE, REFERENCE, Numbers, load_meta
from curriculum.text.sections import FENCE, TEXTS, blank, changes, files, line_at, sections

GATE = "python -m curriculum.text"
CHAPTER = TEXTS["chapter"]
INCLUDED = re.compile(rf"^```\n{INCLUDE.pattern}\n```$", re.MULTILINE)
# Where numbers may be typed: code, comments, formulas, references, links, tags, numbers of headings
# and lists, versions with two dots, and what follows some words.
NOT_PROSE = re.compile(
    FENCE.pattern
    + r"""
    |<!--.*?-->
    |\$\$.+?\$\$|\$[^$\n]+\$
    |\{\{[^\n]*?\}\}
    |\[[^]]*\]\((?:try|drag):[^)]*\)|\]\([^)]*\)|https?://\S+|</?[a-z][^>]*>
    |^\[[^]]*\]:[^\n]*|\[\[\d+\]\](?=\(\#references\))
    |(`+)[^`]+\2
    |\b(?:chapters?|phase|version|tag|python|numpy)[ ]
        \d+(?:\.\d+)*(?:(?:,|,?[ ]and|[ ]to)[ ]\d+\.\d+)*
    |(?<![\w.])\d+(?:\.\d+){2,}
    |^\#+[ ]+\d[\d.]*|^[ >]*\d+[.)][ ]
    """,
    re.DOTALL | re.MULTILINE | re.IGNORECASE | re.VERBOSE,
)
TYPED = re.compile(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*")  # a token that begins with a digit


class Gate:
    """One pass over the project: `problems` are lines, `unread` the sections that changed."""

    def __init__(self):
        self.chapter, self.meta, self.sections = read_text(CHAPTER), load_meta(), sections()
        self.regions, self.problems = split_all()
        recorded = self.meta["section_hashes"]
        self.unread = [s for s in self.sections.values() if recorded.get(s.name) != s.sha]

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check_includes(self):
        """Every include exists and stands alone in its fence, every region is included once."""
        shown = Counter()
        known = {(region.file, region.name): region for region in self.regions.values()}
        for match in INCLUDED.finditer(self.chapter):
            line, (file, name) = line_at(self.chapter, match.end()) - 1, match.groups()
            shown[file, name] += 1
            if (file, name) not in known:
                what = f"includes {name}, and {file} has no such region"
                names = ", ".join(name for other, name in known if other == file)
                self.say(CHAPTER, line, what, f"name one of {names}")
            elif shown[file, name] > 1:
                self.say(CHAPTER, line, f"includes {name} a second time", "delete one of the two")
        for match in re.finditer("include-by-region", blank(INCLUDED, self.chapter)):
            what = "an include that is not alone in its fence, or not well formed"
            line = line_at(self.chapter, match.start())
            self.say(CHAPTER, line, what, "write [include-by-region: FILE#NAME] in a fence")
        for (file, name), region in known.items():
            if not shown[file, name]:
                repair = f"put [include-by-region: {file}#{name}] into {CHAPTER}"
                self.say(file, region.line - 1, f"region {name} is never shown", repair)

    def check_sections(self):
        """Section and region hashes of meta.yaml are those of today."""
        was = self.meta["region_hashes"]
        for section in self.unread:
            changed = [each.name for each in section.regions if was.get(each.name) != each.sha]
            why = f"speaks of {', '.join(changed)}, which changed" if changed else "changed"
            if section.name not in self.meta["section_hashes"]:
                why = "was never read"
            repair = f"read it, then {GATE} --accept {section.name}"
            self.say(section.file, section.line, f"section {section.name} {why}", repair)
        for key, hashes in self.hashes().items():
            wrong = hashes.items() ^ self.meta[key].items()
            if wrong and not self.unread:
                what = f"{key} that are not those of today: {', '.join(sorted(dict(wrong)))}"
                self.say("meta.yaml", 1, what, f"{GATE} --accept, with no name")

    def hashes(self, accepted=()) -> dict:
        """What meta.yaml holds once these sections have been read; those that are gone are not.

        A region's hash moves when all sections that speak of the region have been read.
        """
        read = self.meta["section_hashes"] | {name: self.sections[name].sha for name in accepted}
        regions = {name: region.sha for name, region in self.regions.items()}
        for section in self.unread:
            if section.name not in accepted:
                waiting = {region.name for region in section.regions}
                regions |= {n: self.meta["region_hashes"].get(n, "") for n in waiting}
        return {
            "region_hashes": regions,
            "section_hashes": {name: read[name] for name in self.sections if name in read},
        }

    def check_numbers(self):
        """None is typed into the chapter's prose, every reference can be made, `holds:` is true."""
        for token in TYPED.finditer(blank(NOT_PROSE, self.chapter)):
            line, number = line_at(self.chapter, token.start()), token[0].rstrip(".,")
            repair = f"write {{{{KEY|FORMAT}}}} or {{{{= {number} | REASON}}}}"
            self.say(CHAPTER, line, f"a typed number, {number}", repair)
        numbers, texts = Numbers(), {file: read_text(file) for file in TEXTS.values()}
        numbers.prepare("".join(texts.values()))
        for file, text in texts.items():
            for pattern, call in ((REFERENCE, numbers.text), (HOLDS, numbers.broken)):
                for match in pattern.finditer(text):
                    line = line_at(text, match.start())
                    try:
                        found = call(match[1])
                        if found and pattern is HOLDS:
                            what = f"{match[1]!r} does not hold: {found}"
                            self.say(file, line, what, "correct the text")
                    except ValueError as error:
                        self.say(file, line, f"{match[1]!r}: {error}", "name what is known")

    def check_written(self):
        """Pages, figures and blocks that a command wrote are as it wrote them."""
        blocks = list(BLOCK.finditer(read_text("README.md")))
        written = [("README.md", block[4], block[3]) for block in blocks]
        again = {block[2]: block[3] for block in blocks}
        for name, folder in results.FOLDERS.items():
            for file in files(f"{folder}/*.md", f"{folder}/*.svg"):
                written.append((file, read_text(file), again.get(name, "write it again")))
        for file, text, command in written:
            if not stale.holds(text):
                self.say(file, 1, "is not what was written of today's results", command)

    def check_measured(self):
        """Results and rows of the ledger are of today's code, and the rows well formed."""
        for name, folder in results.FOLDERS.items():
            for section, found in results.load(name).items():
                if names := changed(found["measured"]["code"]):
                    what = f"section {section} was measured on other code ({', '.join(names)})"
                    self.say(f"{folder}/{results.NAME}", 1, what, found["measured"]["command"])
        try:
            for line, row in enumerate(ledger.rows(), 2):
                if ledger.stale(row):
                    what = f"{row['tier']} was measured on other code"
                    self.say("wallclock.csv", line, what, f"{ledger.COMMAND} {row['tier']}")
        except ValueError as error:
            self.problems.append(f"{error}; repair: correct the row")


def check() -> int:
    """Print every problem, and what changed in the sections that wait for a reader."""
    gate = Gate()
    checks = gate.check_includes, gate.check_sections, gate.check_numbers
    for each in (*checks, gate.check_measured, gate.check_written):
        each()
    recorded = gate.meta["section_hashes"]
    print(changes([s for s in gate.unread if s.name in recorded], recorded), end="")
    print(*gate.problems or ["text, code, numbers and results agree"], sep="\n")
    if len(gate.unread) > 1:
        names = " ".join(section.name for section in gate.unread)
        print(f"\nwhen all of them are read: {GATE} --accept {names}")
    return 1 if gate.problems else 0


def accept(names) -> int:
    """Show what changed in these sections, and record that they were read as they are now."""
    gate = Gate()
    unknown = [name for name in names if name not in gate.sections]
    if gate.problems or unknown:
        wrong = f"given {', '.join(unknown)}, allowed: {', '.join(gate.sections)}"
        raise ValueError("\n".join(gate.problems) or wrong)
    print(changes([gate.sections[name] for name in names], gate.meta["section_hashes"]), end="")
    old = r"^(region|section)_hashes:.*\n(?: .*\n)*"
    text = re.sub(old, "", read_text("meta.yaml"), flags=re.MULTILINE).rstrip("\n")
    for key, hashes in gate.hashes(names).items():
        text += f"\n\n{key}:\n" + "\n".join(f"  {n}: {json.dumps(v)}" for n, v in hashes.items())
    write_whole(ROOT / "meta.yaml", text + "\n")
    print(f"recorded in meta.yaml: {', '.join(names) or 'what is no longer there is taken out'}")
    return 0
