"""The gate: what the chapter says, against what contact.py is and does. Check writes nothing.

    python -m curriculum.check_prose_code_drift                 # exit 1 and one line a problem
    python -m curriculum.check_prose_code_drift --accept NAME   # a person has re-read the prose of NAME

It holds together, each failing with `file:line: what; repair: command`:

regions   the markers of contact.py are well formed (curriculum/regions.py has the hash rule), and
          regions in contact.py = `region_hashes` of meta.yaml = regions the chapter includes. An
          include is a fence that holds one line: [include-by-region: contact.py#NAME]
numbers   every {{reference}} of the chapter and of the exercises in meta.yaml resolves on a fresh
          run (curriculum/numbers.py has the syntax), every `holds:` comment is true, `reference_run`
          is what the fresh run gives, and the exercises' answers stand in their bands.
typed     no number is typed into the prose. A typed number is a token that begins with a digit (or
          is a fraction such as 1/2 in one sign), except: after "chapter", "phase", "version", "tag",
          "Python" or "numpy"; a version with two dots; the number of a heading or list item; inside
          a link's target, a tag or a comment. Symbols such as ex2 begin with a letter. In code and
          $math$ one digit is an index or a formula's, and a flag's value (--dt 0.03) is an input;
          any other number there is typed too. The way out carries its reason: {{= 1972 | year}}.
          Numbers in words ("twice") are beyond it: hold such a sentence by a `holds:` comment.
ledger    every MEASURED row of wallclock.csv has the config hash of the script's default run.
scope     what this chapter leaves to others is said in one place: the words of `scope.words` in
          meta.yaml occur in the section `scope.section` of the chapter and nowhere else.

Accepting goes by one name: it shows the region's change since the accepted text (from git, where
there is one) and the chapter's section that shows it, then records that one hash.
"""

import difflib
import re
import subprocess
import sys
from pathlib import Path

from curriculum import regions
from curriculum.common import wallclock
from curriculum.common.files import write_whole
from curriculum.numbers import HOLDS, REFERENCE, Numbers, leaves, load_meta

ROOT = regions.ROOT
CHAPTER = "curriculum/prose/chapter.md"
GATE = "python -m curriculum.check_prose_code_drift"
NUMBERS = "python -m curriculum.numbers"
INCLUDE = re.compile(r"\[include-by-region: contact\.py#(\w+)\]")
FENCE = re.compile(r"^(```|~~~).*?^\1[ ]*$", re.MULTILINE | re.DOTALL)
TOLERANCE = 1e-9                # of the reference run: the same bytes on one machine, rounding elsewhere


def line_at(text, index):
    """The number of the line that holds text[index]."""
    return text.count("\n", 0, index) + 1


def line_of(text, pattern):
    """The number of the first line that matches, or 1."""
    found = re.search(pattern, text, re.MULTILINE)
    return line_at(text, found.start()) if found else 1


def includes(chapter):
    """(line, region) of every well-formed include of the chapter."""
    for fence in FENCE.finditer(chapter):
        lines = fence[0].split("\n")
        found = INCLUDE.fullmatch(lines[1]) if len(lines) == 3 else None
        if found:
            yield line_at(chapter, fence.start()) + 1, found[1]


def check_regions(root):
    """Regions = hashes = includes, and all markers and includes well formed."""
    found, problems = regions.scan(root / "contact.py")
    meta = (root / "meta.yaml").read_text(encoding="utf-8")
    hashes = load_meta(root).get("region_hashes") or {}
    chapter = (root / CHAPTER).read_text(encoding="utf-8")
    shown = list(includes(chapter))
    for name, region in found.items():
        at = f"contact.py:{region.first - 1}"
        if name not in hashes:
            problems.append(f"{at}: region {name} has no hash in meta.yaml; repair: {GATE} --accept {name}")
        elif hashes[name] != region.sha256:
            problems.append(f"{at}: region {name} has changed since its prose was last read; "
                            f"repair: {GATE} --accept {name}")
        if name not in {each for _, each in shown}:
            problems.append(f"{CHAPTER}:1: region {name} is never shown; repair: add a fence with "
                            f"[include-by-region: contact.py#{name}], then {GATE}")
    for name in hashes.keys() - found.keys():
        problems.append(f"meta.yaml:{line_of(meta, rf'^  {name}:')}: a hash of {name}, and contact.py has no such "
                        f"region; repair: {GATE} --accept {name}")
    for k, (line, name) in enumerate(shown):
        if name not in found:
            problems.append(f"{CHAPTER}:{line}: includes {name}, and contact.py has no such region; "
                            f"repair: name one of {', '.join(found)}, then {GATE}")
        if name in {each for _, each in shown[:k]}:
            problems.append(f"{CHAPTER}:{line}: includes {name} a second time; repair: delete one, then {GATE}")
    for line, text in enumerate(chapter.split("\n"), 1):
        if "include-by-region" in text and line not in {each for each, _ in shown}:
            problems.append(f"{CHAPTER}:{line}: an include that is not alone in its fence or not of the form "
                            f"[include-by-region: contact.py#NAME]; repair: edit it, then {GATE}")
    return problems


def typed_numbers(text):
    """(index, token) of every number typed into the prose; the rule stands at the top of this file."""
    def blank(pattern, text, flags=re.MULTILINE):
        return re.sub(pattern, lambda match: re.sub(r"[^\n]", " ", match[0]), text, flags=flags)

    text = blank(r"<!--.*?-->", text, re.DOTALL)
    text = blank(REFERENCE.pattern, text)
    text = blank(r"\[include-by-region:.*", text)
    text = blank(r"\]\([^)]*\)|^\[[^]]*\]:.*|https?://\S+|</?[a-zA-Z][^>]*>", text)
    text = blank(r"\b(chapters?|phase|version|tag|python|numpy) \d+(\.\d+)*((, | and |, and | to )\d+\.\d+)*",
                 text, re.IGNORECASE)
    text = blank(r"(?<![\w.])\d+(\.\d+){2,}", text)
    found = []
    for code in [*FENCE.finditer(text), *re.finditer(r"(`+)[^`]+\1|\$[^$\n]+\$", FENCE.sub(
            lambda match: re.sub(r"[^\n]", " ", match[0]), text))]:
        inside = blank(r"--[a-z][a-z-]*[ =][^\s`]+|\b[0-9a-f]{7,64}\b", code[0])
        found += [(code.start() + token.start(), token[0]) for token in re.finditer(r"(?<![\w.])\.?\d[\w.]*", inside)
                  if not re.fullmatch(r"\d\.?", token[0])]
    prose = blank(r"(`+)[^`]+\1|\$[^$\n]+\$", blank(FENCE, text, 0))
    prose = blank(r"^#+ +\d[\d.]*|^[ >]*\d+[.)] ", prose)
    found += [(token.start(), token[0].rstrip(".,")) for token in
              re.finditer(r"(?<![\w.])\.?[\d¼½¾⅓⅔⅛][\w.,]*", prose)]
    return sorted(found)


def check_typed(root):
    """No number is typed into the chapter, nor into what an exercise tells the learner."""
    chapter, meta = ((root / file).read_text(encoding="utf-8") for file in (CHAPTER, "meta.yaml"))
    found = [(CHAPTER, line_at(chapter, index), token) for index, token in typed_numbers(chapter)]
    for name, exercise in (load_meta(root).get("exercises") or {}).items():
        for key, text in leaves({key: exercise.get(key) for key in ("reveal", "hints")}):
            found += [("meta.yaml", line_of(meta, rf"^  {name}:"), f"{token} (in {key})")
                      for _, token in typed_numbers(text or "")]
    return [f"{file}:{line}: a typed number, {token}; repair: write {{{{KEY|FORMAT}}}} (the keys: {NUMBERS}) or "
            f"{{{{= {token.split()[0]} | REASON}}}}" for file, line, token in found]


def check_numbers(root, numbers):
    """References, claims, the reference run and the exercises' bands, against fresh runs."""
    chapter, meta = ((root / file).read_text(encoding="utf-8") for file in (CHAPTER, "meta.yaml"))
    facts, problems = load_meta(root), []
    exercises = facts.get("exercises") or {}
    numbers.run_all(chapter + str(exercises))

    def attempt(at, claim, try_it, repair=f"correct it; the keys: {NUMBERS}"):
        try:
            what = try_it()
        except (ValueError, ZeroDivisionError) as error:
            what = str(error)
        if what:
            problems.append(f"{at}: {claim}: {what}; repair: {repair}")

    for file, text in ((CHAPTER, chapter), ("meta.yaml", meta)):
        for match in REFERENCE.finditer(text):
            attempt(f"{file}:{line_at(text, match.start())}", match[0], lambda: numbers.text(match[1]) and None)
    for match in HOLDS.finditer(chapter):
        attempt(f"{CHAPTER}:{line_at(chapter, match.start())}", match[1],
                lambda: None if numbers.holds(match[1]) else "does not hold", f"correct the sentence, then {GATE}")
    reference = facts.get("reference_run") or {}
    first = next(iter(numbers.known_runs()))
    measured = dict(leaves(numbers.run(first)))
    stated = reference.get("values") or {}
    for key in measured.keys() | stated.keys():
        a, b = measured.get(key, "missing"), stated.get(key, "missing")
        close = a == b or (isinstance(a, float) and isinstance(b, (int, float)) and abs(a - b) <= TOLERANCE)
        if not close:
            problems.append(f"meta.yaml:{line_of(meta, rf'^    {re.escape(key)}:')}: reference_run says {key} is {b}, "
                            f"a fresh run gives {a}; repair: {NUMBERS} --record")
    for name, exercise in exercises.items():
        at = f"meta.yaml:{line_of(meta, rf'^  {name}:')}"
        for key, (low, high) in (exercise.get("bands") or {}).items():
            attempt(at, f"{name}, {key}", lambda: None if low <= numbers.value(key) <= high else
                    f"{numbers.value(key)} is outside {low} to {high}", f"find out why, then {GATE}")
        for claim in exercise.get("holds") or []:
            attempt(at, f"{name}, {claim}", lambda: None if numbers.holds(claim) else "does not hold",
                    f"find out why, then {GATE}")
    return problems


def check_ledger(root, numbers):
    """Every measured wall-clock is of the script as it is now."""
    try:
        rows = wallclock.read(root / "wallclock.csv")
    except ValueError as error:
        return [f"{str(error).replace(str(root) + '/', '')}; repair: correct it, then {GATE}"]
    first = next(iter(numbers.known_runs()))
    numbers.run(first)
    return [f"wallclock.csv:{line}: {row['tier']} was measured at config {row['config_hash']}, the default run is now "
            f"{numbers.config_hash[first]}; repair: python -m curriculum.common.wallclock --measure (on that tier)"
            for line, row in enumerate(rows, 2)
            if row["chapter"] == wallclock.CHAPTER and row["status"] == "MEASURED"
            and row["config_hash"] != numbers.config_hash[first]]


def section(text, line):
    """(first, last) line of the section (heading to next heading) around a line."""
    headings = [1] + [k for k, each in enumerate(text.split("\n"), 1) if re.match(r"#+ ", each)]
    first = max(k for k in headings if k <= line)
    return first, min([k for k in headings if k > line], default=text.count("\n") + 2) - 1


def check_scope(root):
    """What is left to other chapters is said in one section of the chapter alone."""
    scope = load_meta(root).get("scope") or {}
    title, words = scope.get("section", ""), scope.get("words") or []
    chapter = (root / CHAPTER).read_text(encoding="utf-8")
    heading = line_of(chapter, rf"^#+ .*{re.escape(title)}")
    if not title or not re.search(rf"^#+ .*{re.escape(title)}", chapter, re.MULTILINE):
        return [f"meta.yaml:{line_of((root / 'meta.yaml').read_text(encoding='utf-8'), '^scope:')}: scope.section "
                f"{title!r} is no heading of {CHAPTER}; repair: name the heading, then {GATE}"]
    first, last = section(chapter, heading)
    problems = []
    for path in [root / CHAPTER, root / "contact.py", root / "checks.py", root / "README.md",
                 *sorted((root / "exercises").glob("*.py"))]:
        for line, text in enumerate(path.read_text(encoding="utf-8", errors="replace").split("\n") if path.exists()
                                    else [], 1):
            said = next((word for word in words if word.lower() in text.lower()), None)
            if said and not (path == root / CHAPTER and first <= line <= last):
                problems.append(f"{path.relative_to(root)}:{line}: {said!r} is said outside {CHAPTER}, section "
                                f"{title!r}; repair: move it there or point there, then {GATE}")
    return problems


def check(root=ROOT):
    """Every problem of the project at `root`, one line each. Writes nothing."""
    root = Path(root)
    missing = [file for file in ("contact.py", "meta.yaml", CHAPTER) if not (root / file).exists()]
    if missing:
        return [f"{file}:1: missing; repair: git checkout {file}" for file in missing]
    try:
        problems = check_regions(root) + check_typed(root) + check_scope(root)
        if not load_meta(root).get("runs"):
            return problems + [f"meta.yaml:1: no `runs`, so no reference run; repair: git diff meta.yaml, then {GATE}"]
        numbers = Numbers(root)
        return problems + check_numbers(root, numbers) + check_ledger(root, numbers)
    except ValueError as error:
        what = str(error)
        at = "" if re.match(r"[\w./]+:\d+: ", what) else "contact.py:1: "
        return (problems if "problems" in locals() else []) + [f"{at}{what}; repair: correct it, then {GATE}"]


def accepted_text(root, name, recorded):
    """The region's text that had the recorded hash, from git; or a sentence saying why there is none."""
    def git(*words):
        return subprocess.run(["git", "-C", str(root), *words], capture_output=True, check=True).stdout.decode("utf-8")
    try:
        for commit in git("log", "--format=%H", "--", "contact.py").split():
            text = git("show", f"{commit}:./contact.py")
            found = re.search(rf"^# --- region: {name} ---\n(.*?)^{regions.END}$", text, re.MULTILINE | re.DOTALL)
            if found and regions.Region(name, 0, found[1]).sha256 == recorded:
                return found[1], None
    except (OSError, subprocess.CalledProcessError, UnicodeDecodeError):
        return "", "no git history here, so the whole region is shown instead of a change"
    return "", "the accepted text is in no commit, so the whole region is shown instead of a change"


def accept(root, name):
    """Show what changed and what quotes it, then record the one hash. Raises ValueError when it can't."""
    root = Path(root)
    path = root / "meta.yaml"
    found, hashes = regions.find(root / "contact.py"), load_meta(root).get("region_hashes") or {}
    if name not in found and name not in hashes:
        raise ValueError(f"given {name!r}, allowed: {', '.join(found)}")
    new, recorded = found.get(name), hashes.get(name)
    if new and new.sha256 == recorded:
        print(f"{name}: nothing to accept, the hash is already recorded")
        return
    old, why_not = accepted_text(root, name, recorded) if recorded else ("", "this region had no hash before")
    if why_not:
        print(f"{name}: {why_not}")
    print("\n".join(difflib.unified_diff(old.splitlines(), (new.text if new else "").splitlines(),
                                         f"{name}, accepted", f"{name}, now", lineterm="")))
    chapter = (root / CHAPTER).read_text(encoding="utf-8") if (root / CHAPTER).exists() else ""
    for line in [line for line, each in includes(chapter) if each == name]:
        first, last = section(chapter, line)
        print(f"\n{CHAPTER}:{line} shows it; the section, lines {first} to {last}, says:\n")
        print("\n".join(f"{k:>5}  {chapter.split(chr(10))[k - 1]}" for k in range(first, last + 1)))
    kept = {each: region.sha256 if each == name else hashes[each] for each, region in found.items()
            if each == name or each in hashes}
    kept |= {each: value for each, value in hashes.items() if each not in found and each != name}
    block = "".join(["region_hashes:\n", *(f"  {each}: {value}\n" for each, value in kept.items())])
    text = path.read_text(encoding="utf-8")
    new_text, count = re.subn(r"^region_hashes:.*\n(?:[ ].*(?:\n|$))*", lambda _: block, text, flags=re.MULTILINE)
    write_whole(path, new_text if count else text.rstrip("\n") + "\n\n" + block)
    print(f"\n{name}: {'recorded ' + new.sha256 if new else 'its hash is removed'}")


def main(argv=None):
    """Check, or accept one region. Returns the exit status: 0 in order, 1 drift, 2 bad usage."""
    from curriculum.common.arguments import Parser
    parser = Parser(prog=GATE, description="Hold chapter, code, numbers and ledger together.")
    parser.add_argument("--accept", metavar="NAME", help="record one region's hash after showing what it changes")
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
    for problem in problems:
        print(problem, file=sys.stderr)
    if not problems:
        print("chapter, code, numbers and ledger agree")
    return 1 if problems else 0


if __name__ == "__main__":
    raise SystemExit(main())
