"""The gate: what the chapter says, against what contact.py is and does. Check writes nothing.

    python -m curriculum.check_prose_code_drift                 # exit 1, one line a problem
    python -m curriculum.check_prose_code_drift --accept NAME   # the prose of NAME has been re-read

It holds together, each failing with `file:line: what; repair: command`:

regions   the markers of contact.py are well formed (curriculum/regions.py has the hash rule), and
          regions in contact.py = `region_hashes` of meta.yaml = regions the chapter includes. An
          include is a fence that holds one line: [include-by-region: contact.py#NAME]
numbers   every {{reference}} of the chapter and of meta.yaml resolves on a fresh run
          (curriculum/quoted.py has the syntax), every `holds:` comment is true, `reference_run` is
          what the fresh run gives, and the exercises' answers stand in their bands.
typed     no number is typed into the prose, nor into what an exercise tells the learner. A typed
          number is a token that begins with a digit (or is a fraction in one sign), except: after
          "chapter", "phase", "version", "tag", "Python" or "numpy"; a version with two dots; the
          number of a heading or list item; inside a link's target, a tag or a comment. Symbols such
          as ex2 begin with a letter. In code and $math$ one digit is an index or a formula's, and a
          flag's value (--dt 0.03) is an input; any other number there is typed too. The way out
          carries its reason: {{= 1972 | year of the paper}}. Numbers in words ("twice") are beyond
          the rule: hold such a sentence to the run by a `holds:` comment.
ledger    every MEASURED row of wallclock.csv has the config hash of the script's default run; the
          chapter can only quote the ledger, since a typed number is refused.
scope     what this chapter leaves to others is said in one place: the words of `scope.words` in
          meta.yaml occur in the section `scope.section` of the chapter and nowhere else.

Accepting goes by one name: it shows the region's change since the accepted text (from git, where
there is one) and the section of the chapter that shows it, then records that one hash.
"""

import difflib
import re
import subprocess
import sys
from pathlib import Path

from curriculum import regions
from curriculum.common import wallclock
from curriculum.common.files import write_whole
from curriculum.quoted import HOLDS, REFERENCE, Numbers, leaves, load_meta

ROOT = regions.ROOT
CHAPTER = "curriculum/prose/chapter.md"
GATE = "python -m curriculum.check_prose_code_drift"
NUMBERS = "python -m curriculum.quoted"
INCLUDE = re.compile(r"\[include-by-region: contact\.py#(\w+)\]")
FENCE = re.compile(r"^(```|~~~).*?^\1[ ]*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+)[^`]+\1|\$[^$\n]+\$")
TOLERANCE = 1e-9        # of the reference run: one machine repeats its bytes, another may round


class Project:
    """The texts of one copy of the project, read once, and the problems found in them."""

    def __init__(self, root):
        """Raises ValueError when meta.yaml is not YAML."""
        self.root, self.problems = Path(root), []
        self.chapter, self.meta = self.read(CHAPTER), self.read("meta.yaml")
        self.facts = load_meta(root)
        self.exercises = self.facts.get("exercises") or {}
        self.includes = list(find_includes(self.chapter))

    def read(self, file):
        """A file's text. What is not UTF-8 or has carriage returns is a problem, and replaced."""
        data = (self.root / file).read_bytes()
        text = data.decode("utf-8", errors="replace")
        for wrong, what in (("\ufffd", "a byte that is not UTF-8"), ("\r", "a carriage return")):
            if wrong in text:
                line = line_at(text, text.index(wrong))
                self.say(file, line, what, f"save it as UTF-8 with \\n at line ends, then {GATE}")
        return text.replace("\r\n", "\n")

    def say(self, file, line, what, repair):
        """Note a problem; `line` may be a pattern, the first line of meta.yaml that it matches."""
        if isinstance(line, str):
            found = re.search(line, self.meta, re.MULTILINE)
            line = line_at(self.meta, found.start()) if found else 1
        self.problems.append(f"{file}:{line}: {what}; repair: {repair}")


def line_at(text, index):
    """The number of the line that holds text[index]."""
    return text.count("\n", 0, index) + 1


def find_includes(chapter):
    """(line, region) of every well-formed include."""
    for fence in FENCE.finditer(chapter):
        lines = fence[0].split("\n")
        found = INCLUDE.fullmatch(lines[1]) if len(lines) == 3 else None
        if found:
            yield line_at(chapter, fence.start()) + 1, found[1]


def check_regions(project):
    """Regions = hashes = includes, and all markers and includes well formed."""
    found, problems = regions.scan(project.root / "contact.py")
    project.problems += problems
    hashes, shown = project.facts.get("region_hashes") or {}, project.includes
    for name, region in found.items():
        what = None if hashes.get(name) == region.sha256 else "has no hash in meta.yaml" \
            if name not in hashes else "has changed since its prose was last read"
        if what:
            project.say("contact.py", region.first - 1, f"region {name} {what}",
                        f"{GATE} --accept {name}")
        if name not in {each for _, each in shown}:
            project.say(CHAPTER, 1, f"region {name} is never shown",
                        f"add a fence with [include-by-region: contact.py#{name}], then {GATE}")
    for name in hashes.keys() - found.keys():
        project.say("meta.yaml", rf"^  {name}:", f"a hash of {name}, and contact.py has no such "
                    "region", f"{GATE} --accept {name}")
    for k, (line, name) in enumerate(shown):
        if name not in found:
            project.say(CHAPTER, line, f"includes {name}, and contact.py has no such region",
                        f"name one of {', '.join(found)}, then {GATE}")
        if name in {each for _, each in shown[:k]}:
            project.say(CHAPTER, line, f"includes {name} a second time", f"delete one, then {GATE}")
    for line, text in enumerate(project.chapter.split("\n"), 1):
        if "include-by-region" in text and line not in {each for each, _ in shown}:
            project.say(CHAPTER, line, "an include that is not alone in its fence or not of the "
                        "form [include-by-region: contact.py#NAME]", f"edit it, then {GATE}")


def blank(pattern, text, flags=re.MULTILINE):
    """The text with every match replaced by spaces; lines and places stay."""
    return re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=flags)


def typed_numbers(text):
    """(index, token) of every number typed into a text; the rule stands at the top of this file."""
    names = "chapters?|phase|version|tag|python|numpy"
    text = blank(r"<!--.*?-->", text, re.DOTALL)
    text = blank(rf"{REFERENCE.pattern}|^\[include-by-region:.*", text)
    text = blank(r"\]\([^)]*\)|^\[[^]]*\]:.*|https?://\S+|</?[a-zA-Z][^>]*>", text)
    text = blank(rf"\b({names}) \d+(\.\d+)*((, | and |, and | to )\d+\.\d+)*", text, re.IGNORECASE)
    text = blank(r"(?<![\w.])\d+(\.\d+){2,}", text)
    unfenced = blank(FENCE.pattern, text, FENCE.flags)
    found = []
    for code in [*FENCE.finditer(text), *CODE.finditer(unfenced)]:
        inside = blank(r"--[a-z][a-z-]*[ =][^\s`]+|\b[0-9a-f]{7,64}\b", code[0])
        found += [(code.start() + token.start(), token[0])
                  for token in re.finditer(r"(?<![\w.])\.?\d[\w.]*", inside)
                  if not re.fullmatch(r"\d\.?", token[0])]
    prose = blank(r"^#+ +\d[\d.]*|^[ >]*\d+[.)] ", blank(CODE.pattern, unfenced))
    found += [(token.start(), token[0].rstrip(".,"))
              for token in re.finditer(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*", prose)]
    return sorted(found)


def check_typed(project):
    """No number is typed into the chapter, nor into what an exercise tells the learner."""
    texts = [(CHAPTER, None, project.chapter)]
    for name, exercise in project.exercises.items():
        said = {key: exercise.get(key) for key in ("reveal", "hints")}
        texts += [("meta.yaml", rf"^  {name}:", text or "") for _, text in leaves(said)]
    for file, line, text in texts:
        for index, token in typed_numbers(text):
            project.say(file, line or line_at(text, index), f"a typed number, {token}",
                        f"write {{{{KEY|FORMAT}}}} (the keys: {NUMBERS}) or "
                        f"{{{{= {token} | REASON}}}}")


def check_numbers(project, numbers):
    """References, claims, the reference run and the exercises' bands, against fresh runs."""
    numbers.run_all(project.chapter + str(project.exercises))

    def attempt(file, line, claim, wrong, *inputs):
        """Note what `wrong(*inputs)` returns or raises."""
        try:
            what = wrong(*inputs)
        except (ValueError, ZeroDivisionError) as error:
            what = f"{error} (the keys: {NUMBERS})"
        if what:
            project.say(file, line, f"{claim}: {what}", f"correct what is wrong, then {GATE}")

    def unquotable(reference):
        return numbers.text(reference) and None

    def false(claim):
        return None if numbers.holds(claim) else "does not hold"

    def outside(key, low, high):
        value = numbers.value(key)
        return None if low <= value <= high else f"{value} is outside {low} to {high}"

    for file, text in ((CHAPTER, project.chapter), ("meta.yaml", project.meta)):
        for match in REFERENCE.finditer(text):
            attempt(file, line_at(text, match.start()), match[0], unquotable, match[1])
    for match in HOLDS.finditer(project.chapter):
        attempt(CHAPTER, line_at(project.chapter, match.start()), match[1], false, match[1])
    for name, exercise in project.exercises.items():
        for key, (low, high) in (exercise.get("bands") or {}).items():
            attempt("meta.yaml", rf"^  {name}:", f"{name}, {key}", outside, key, low, high)
        for claim in exercise.get("holds") or []:
            attempt("meta.yaml", rf"^  {name}:", f"{name}, {claim}", false, claim)
    name = numbers.reference()
    check_reference_run(project, dict(leaves(numbers.run(name))), numbers.config_hash[name])


def check_reference_run(project, measured, config_hash):
    """`reference_run` of meta.yaml says what a fresh run gives, number by number."""
    reference = project.facts.get("reference_run") or {}
    measured = {**measured, "config_hash": config_hash}
    stated = {**(reference.get("values") or {}), "config_hash": reference.get("config_hash")}
    for key in sorted(measured.keys() | stated.keys()):
        fresh, said = measured.get(key, "missing"), stated.get(key, "missing")
        numeric = isinstance(fresh, float) and isinstance(said, (int, float))
        if fresh != said and not (numeric and abs(fresh - said) <= TOLERANCE):
            project.say("meta.yaml", rf"^ +{re.escape(key)}:", f"reference_run says {key} is "
                        f"{said}, a fresh run gives {fresh}", f"{NUMBERS} --record")


def check_ledger(project, numbers):
    """Every measured wall-clock is of the script as it is now."""
    try:
        rows = wallclock.read(project.root / "wallclock.csv")
    except ValueError as error:
        where, line, what = str(error).split(":", 2)
        return project.say(Path(where).name, line, what.strip(), f"correct it, then {GATE}")
    numbers.run(numbers.reference())
    now = numbers.config_hash[numbers.reference()]
    for line, row in enumerate(rows, 2):
        ours = row["chapter"] == wallclock.CHAPTER and row["status"] == "MEASURED"
        if ours and row["config_hash"] != now:
            project.say("wallclock.csv", line, f"{row['tier']} was measured at config "
                        f"{row['config_hash']}, the default run is now {now}",
                        "python -m curriculum.common.wallclock --measure (on that tier)")


def section(text, line):
    """(first, last) line of the section (heading to next heading) around a line."""
    lines = text.rstrip("\n").split("\n")
    headings = [k for k, each in enumerate(lines, 1) if re.match(r"#+ ", each)]
    first = max([k for k in headings if k <= line], default=1)
    return first, min([k - 1 for k in headings if k > line], default=len(lines))


def check_scope(project):
    """What is left to other chapters is said in one section of the chapter alone."""
    scope = project.facts.get("scope") or {}
    title, words = scope.get("section", ""), scope.get("words") or []
    heading = re.search(rf"^#+ .*{re.escape(title)}.*", project.chapter, re.MULTILINE)
    if not title or not heading:
        return project.say("meta.yaml", "^scope:", f"scope.section {title!r} is no heading of "
                           f"{CHAPTER}", f"name the heading, then {GATE}")
    first, last = section(project.chapter, line_at(project.chapter, heading.start()))
    paths = [project.root / file for file in (CHAPTER, "contact.py", "checks.py", "README.md")]
    for path in paths + sorted(project.root.glob("exercises/*.py")):
        file = path.relative_to(project.root).as_posix()
        text = path.read_text("utf-8", "replace").lower() if path.exists() else ""
        for line, here in enumerate(text.split("\n"), 1):
            said = next((word for word in words if word.lower() in here), None)
            if said and not (file == CHAPTER and first <= line <= last):
                project.say(file, line, f"{said!r} is said outside {CHAPTER}, section {title!r}",
                            f"move it there or point there, then {GATE}")


def check(root=ROOT):
    """Every problem of the project at `root`, one line each. Writes nothing."""
    missing = [f for f in ("contact.py", "meta.yaml", CHAPTER) if not (Path(root) / f).exists()]
    if missing:
        return [f"{file}:1: missing; repair: git checkout {file}" for file in missing]
    problems, numbers = [], Numbers(root)
    try:
        project = Project(root)
        problems = project.problems
        for part in (check_regions, check_typed, check_scope):
            part(project)
        for part in (check_numbers, check_ledger):
            part(project, numbers)
    except ValueError as error:         # not YAML, no runs, or the script fails
        at = "" if re.match(r"[\w./]+:\d+: ", str(error)) else "contact.py:1: "
        problems.append(f"{at}{error}; repair: correct it, then {GATE}")
    return problems


def accepted_text(root, name, sha256):
    """The text of the region when it had that hash, from git; or None and why there is none."""
    def git(*words):
        command = ["git", "-C", str(root), *words]
        return subprocess.run(command, capture_output=True, check=True).stdout.decode("utf-8")

    marked = re.compile(rf"^# --- region: {name} ---\n(.*?)^{regions.END}$", re.M | re.S)
    try:
        for commit in git("log", "--format=%H", "--", "contact.py").split():
            found = marked.search(git("show", f"{commit}:./contact.py"))
            if found and regions.Region(name, 0, found[1]).sha256 == sha256:
                return found[1], None
    except (OSError, subprocess.CalledProcessError, UnicodeDecodeError):
        return None, "no git history here"
    return None, "the accepted text is in no commit"


def accept(root, name):
    """Show what changed and what quotes it, then record the one hash. Raises ValueError."""
    root = Path(root)
    found, hashes = regions.find(root / "contact.py"), load_meta(root).get("region_hashes") or {}
    if name not in found and name not in hashes:
        raise ValueError(f"given {name!r}, allowed: {', '.join(found)}")
    new = found.get(name)
    if new and new.sha256 == hashes.get(name):
        return print(f"{name}: nothing to accept, the hash is already recorded")
    old, why = None, "there was no hash before"
    if name in hashes:
        old, why = accepted_text(root, name, hashes[name])
    if old is None:
        print(f"{name}: {why}, so the whole region is shown instead of a change")
    print(*difflib.unified_diff((old or "").splitlines(), (new.text if new else "").splitlines(),
                                f"{name}, accepted", f"{name}, now", lineterm=""), sep="\n")
    chapter = (root / CHAPTER).read_text("utf-8") if (root / CHAPTER).exists() else ""
    for line in [line for line, each in find_includes(chapter) if each == name]:
        first, last = section(chapter, line)
        print(f"\n{CHAPTER}:{line} shows it; the section, lines {first} to {last}, says:\n")
        for number, text in enumerate(chapter.split("\n")[first - 1:last], first):
            print(f"{number:>5}  {text}")
    hashes[name] = new.sha256 if new else None
    order = [*found, *(each for each in hashes if each not in found)]
    lines = [f"  {each}: {hashes[each]}\n" for each in order if hashes.get(each)]
    block = "".join(["region_hashes:\n", *lines])
    text = (root / "meta.yaml").read_text("utf-8")
    text, count = re.subn(r"^region_hashes:.*\n(?: .*(\n|$))*", lambda _: block, text, flags=re.M)
    write_whole(root / "meta.yaml", text if count else f"{text.rstrip()}\n\n{block}")
    print(f"\n{name}: {'recorded ' + new.sha256 if new else 'its hash is removed'}")


def main(argv=None):
    """Check, or accept one region. Returns the exit status: 0 in order, 1 drift, 2 bad usage."""
    from curriculum.common.arguments import Parser
    parser = Parser(prog=GATE, description="Hold chapter, code, numbers and ledger together.")
    parser.add_argument("--accept", metavar="NAME",
                        help="record one region's hash, showing what changed")
    parser.add_argument("--root", default=ROOT, type=Path, help="another copy of the project")
    args = parser.parse_args(argv)
    if args.accept:
        try:
            accept(args.root, args.accept)
        except (OSError, ValueError) as error:
            print(error, file=sys.stderr)
            return 2
        return 0
    problems = check(args.root)
    print(*(problems or ["chapter, code, numbers and ledger agree"]), sep="\n",
          file=sys.stderr if problems else sys.stdout)
    return 1 if problems else 0


if __name__ == "__main__":
    raise SystemExit(main())
