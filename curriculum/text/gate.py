"""The gate's checks: each adds problems, `file:line: what is wrong; repair: what to do`."""

import json
import re

from curriculum.text import ledger, readme, results
from curriculum.text.references import HOLDS, INCLUDE, REFERENCE, Numbers, load_meta
from curriculum.text.regions import read_text, split_all
from curriculum.text.sections import FENCE, TEXTS, blank, line_at, sections

GATE = "python -m curriculum.text"
CHAPTER = TEXTS["chapter"]
VERSIONED = "chapters?|phase|version|tag|python|numpy"  # words that a typed number may follow
SHOWN_ALONE = re.compile(rf"^```\n{INCLUDE.pattern}\n```$", re.MULTILINE)


class Gate:
    """One pass over the project: `problems` are lines, `unread` the sections that changed."""

    def __init__(self):
        self.problems, self.unread = [], []
        self.chapter, self.meta = read_text(CHAPTER) or "", load_meta()
        self.regions, wrong = split_all()
        self.problems += wrong

    def say(self, file, line, what, repair):
        """Note a problem."""
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")

    def check(self):
        """All checks. Returns the problems."""
        self.check_includes()
        self.check_sections()
        self.check_typed()
        self.check_numbers()
        self.check_results()
        self.check_readme()
        return self.problems

    def check_includes(self):
        """Every include exists and stands alone in its fence, every region is included once."""
        shown = []
        for match in SHOWN_ALONE.finditer(self.chapter):
            name, line = match["name"], line_at(self.chapter, match.start()) + 1
            region = self.regions.get(name)
            if region is None or region.file != match["file"]:
                known = ", ".join(n for n, r in self.regions.items() if r.file == match["file"])
                what = f"includes {name}, and {match['file']} has no such region"
                self.say(CHAPTER, line, what, f"name one of {known or 'a literate file'}")
            elif name in shown:
                self.say(CHAPTER, line, f"includes {name} a second time", "delete one of the two")
            shown.append(name)
        whole = [line_at(self.chapter, m.start()) + 1 for m in SHOWN_ALONE.finditer(self.chapter)]
        for line, text in enumerate(self.chapter.split("\n"), 1):
            if "include-by-region" in text and line not in whole:
                what = "an include that is not alone in its fence, or not well formed"
                self.say(CHAPTER, line, what, "write [include-by-region: FILE#NAME] in a fence")
        for region in self.regions.values():
            if region.name not in shown:
                what = f"region {region.name} is never shown"
                include = f"[include-by-region: {region.file}#{region.name}]"
                self.say(region.file, region.line - 1, what, f"put {include} into {CHAPTER}")

    def check_sections(self):
        """Section and region hashes of meta.yaml are those of today."""
        found = sections()
        recorded = self.meta.get("section_hashes") or {}
        for section in found.values():
            if recorded.get(section.name) != section.sha:
                self.unread.append(section)
                what = f"section {section.name} {why_unread(section, self.meta)}"
                repair = f"read it, then {GATE} --accept {section.name}"
                self.say(section.file, section.line, what, repair)
        stray = recorded.keys() - found.keys()
        hashes = {name: region.sha for name, region in self.regions.items()}
        if stray or (not self.unread and hashes != (self.meta.get("region_hashes") or {})):
            what = f"hashes of what is not there: {', '.join(stray) or 'a region'}"
            self.say("meta.yaml", 1, what, f"{GATE} --accept, with no name")

    def check_typed(self):
        """No number is typed into the chapter's prose: it would stay when the code changes."""
        for index, token in typed_numbers(self.chapter):
            repair = f"write {{{{KEY|FORMAT}}}} ({GATE} --list) or {{{{= {token} | REASON}}}}"
            self.say(CHAPTER, line_at(self.chapter, index), f"a typed number, {token}", repair)

    def check_numbers(self):
        """Every reference of chapter and README can be made, every `holds:` is true."""
        numbers = Numbers()
        texts = {file: read_text(file) or "" for file in TEXTS.values()}
        numbers.run_all("".join(texts.values()))
        for file, text in texts.items():
            for pattern, call in ((REFERENCE, numbers.text), (HOLDS, numbers.holds)):
                for match in pattern.finditer(text):
                    line = line_at(text, match.start())
                    try:
                        if call(match[1]) is False:
                            self.say(file, line, f"{match[1]!r} does not hold", "correct the text")
                    except ValueError as error:
                        self.say(file, line, f"{match[1]!r}: {error}", f"{GATE} --list names all")

    def check_results(self):
        """Every section of results, and every row of the ledger, is of today's code."""
        for name, folder in results.FOLDERS.items():
            for section, found in results.load(name).items():
                files = results.stale(found)
                if files:
                    again = (found.get("measured") or {}).get("command", f"curriculum.{name}")
                    what = f"section {section} was measured on other code ({', '.join(files)})"
                    self.say(f"{folder}/{results.NAME}", 1, what, again)
        try:
            tiers = ledger.stale_tiers()
        except ValueError as error:
            self.problems.append(f"{error}; repair: correct the row")
            return
        for line, row in enumerate(ledger.rows(), 2):
            if row["tier"] in tiers:
                what = f"{row['tier']} was measured on other code"
                self.say("wallclock.csv", line, what, ledger.COMMAND)

    def check_readme(self):
        """The README's generated blocks are what their commands make now."""
        text = read_text("README.md")
        for block in readme.BLOCK.finditer(text):
            line, name = line_at(text, block.start()), block["name"]
            try:
                same = block["head"] + readme.make(name, block["command"]) == block[0]
            except ValueError as error:
                self.say("README.md", line, str(error), "correct its name, or measure again")
                continue
            if not same:
                self.say("README.md", line, f"block {name} is out of date", f"{GATE} --write")


def why_unread(section, meta) -> str:
    """Why a section waits for a reader."""
    if section.name not in (meta.get("section_hashes") or {}):
        return "was never read"
    was = meta.get("region_hashes") or {}
    changed = [region.name for region in section.regions if was.get(region.name) != region.sha]
    if changed:
        return f"speaks of {', '.join(changed)}, which changed"
    return "changed since it was read"


def typed_numbers(text) -> list:
    """(index, token) of every number typed into prose.

    A token that begins with a digit is one, but for those in code, formulas, comments, references,
    links, tags, headings' and lists' numbers, versions with two dots, and after VERSIONED words.
    """
    for pattern, flags in (
        (FENCE.pattern, FENCE.flags),
        (r"<!--.*?-->", re.DOTALL),
        (r"\$\$.+?\$\$|\$[^$\n]+\$", re.DOTALL),
        (REFERENCE.pattern, 0),
        (r"\[[^\]]*\]\((try|drag):[^)]*\)|\]\([^)]*\)|https?://\S+|</?[a-z][^>]*>", 0),
        (r"^\[[^]]*\]:.*", re.MULTILINE),
        (r"(`+)[^`]+\1", 0),
        (rf"\b({VERSIONED}) \d+(\.\d+)*((, | and |, and | to )\d+\.\d+)*", re.IGNORECASE),
        (r"(?<![\w.])\d+(\.\d+){2,}|^#+ +\d[\d.]*|^[ >]*\d+[.)] ", re.MULTILINE),
    ):
        text = blank(pattern, text, flags)
    tokens = re.finditer(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*", text)
    return [(token.start(), token[0].rstrip(".,")) for token in tokens]


def record(text, accepted, found, regions) -> str:
    """meta.yaml's text with the hashes of accepted sections, and of regions that nobody waits for.

    Sections that are gone are taken out. A region's hash moves once every section that speaks of it
    has been read.
    """
    old = load_meta()
    was = old.get("section_hashes") or {}
    hashes = {}
    for name, section in found.items():
        if name in accepted:
            hashes[name] = section.sha
        elif name in was:
            hashes[name] = was[name]
    waiting = {r.name for name, s in found.items() if hashes.get(name) != s.sha for r in s.regions}
    before = old.get("region_hashes") or {}
    codes = {n: before.get(n, "") if n in waiting else r.sha for n, r in regions.items()}
    for key, values in (("region_hashes", codes), ("section_hashes", hashes)):
        block = f"{key}:\n" + "".join(f"  {n}: {json.dumps(v)}\n" for n, v in values.items())
        rest = re.sub(rf"^{key}:.*\n(?: .*\n)*", "", text, flags=re.MULTILINE)
        text = rest.rstrip("\n") + "\n\n" + block
    return text
