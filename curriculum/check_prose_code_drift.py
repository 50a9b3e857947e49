"""The gate: what the chapter says, against what the code is and does. Check writes nothing.

    python -m curriculum.check_prose_code_drift                 # exit 1, one line a problem
    python -m curriculum.check_prose_code_drift --accept NAME   # the prose of NAME has been re-read
    python -m curriculum.check_prose_code_drift --fuzz 200      # change things, list what passes

It holds together, each failing with `file:line: what; repair: command`:

regions   the markers of the literate files are well formed (curriculum/regions.py has the hash
          rule), and their regions = `region_hashes` of meta.yaml, in their order, = regions that
          the chapter includes or `not_shown` of meta.yaml names (piles-* stands for many). An
          include is a fence that holds one line: [include-by-region: FILE#NAME]
passages  what only a reader can judge (order of the chapter, formulas, numbers in words, claims,
          exercises, promises) has the hash that was accepted: curriculum/drift/passages.py
numbers   every {{reference}} of the chapter and of meta.yaml resolves on a fresh run
          (curriculum/quoted.py has the syntax), every `holds:` comment is true, and
          `reference_run` is what the fresh run gives.
exercises the answers stand in their bands, a band is narrow, every choice has its `true_if`, and
          those of the answer, and of no other choice, are true. Each has one slot in the chapter.
typed     no number is typed into the prose, nor into what an exercise tells the learner. A typed
          number is a token that begins with a digit (or is a fraction in one sign), except: after
          "chapter", "phase", "version", "tag", "Python" or "numpy"; a version with two dots; the
          number of a heading or list item; inside a link's target, a tag or a comment; in a try:
          or drag: link. Symbols such as ex2 begin with a letter. In code and $math$ one digit is
          an index or a formula's, and a flag's value (--dt 0.03) is an input; any other number
          there is typed too. The way out carries its reason: {{= 1972 | year of the paper}}.
names     code, flags, commands, files and images that chapter, README, exercises and docstrings
          name are there (curriculum/drift/names.py has the rule).
readme    the README's generated blocks are what their commands make now.
measured  results of bench and stress, and every MEASURED row of wallclock.csv, are of the code as
          it is now, or `stale` of meta.yaml names them; the text then says "stale". A row is the
          median of the times in curriculum/wallclock_runs.json.
scope     what this chapter leaves to others is said in one place: the words of `scope.words` in
          meta.yaml occur in the section `scope.section` of the chapter and nowhere else.

Accepting goes by name: it shows what changed since the accepted text (from git, where there is
one), the section of the chapter that shows a region and every other paragraph that names what the
region defines, then records the hash. CONTRIBUTING.md says what no gate can catch.
"""

import re
import sys
from fnmatch import fnmatchcase
from pathlib import Path

from curriculum import measured, regions
from curriculum.common import wallclock
from curriculum.common.stoppable import stoppable
from curriculum.drift import names as naming
from curriculum.drift import passages, texts
from curriculum.drift.passages import GATE, accept
from curriculum.drift.texts import CHAPTER, INCLUDE, line_at, typed_numbers
from curriculum.quoted import (
    HOLDS,
    REFERENCE,
    RESULTS,
    Numbers,
    command_of,
    is_number,
    leaves,
    load_meta,
)

__all__ = ["CHAPTER", "GATE", "INCLUDE", "accept", "check", "main", "typed_numbers"]
ROOT = regions.ROOT
NUMBERS = "python -m curriculum.quoted"
TOLERANCE = 1e-9  # of the reference run: one machine repeats its bytes, another may round
NARROW = 0.01, 1e-6  # a band is at most so wide, as a share of its upper end, or so wide at all
TEXTS = (CHAPTER, "README.md", "CONTRIBUTING.md", "CHANGELOG.md")


class Project:
    """The texts of one copy of the project, read once, and the problems found in them."""

    def __init__(self, root):
        """Raises ValueError when meta.yaml is not YAML."""
        self.root, self.problems = Path(root), []
        self.chapter, self.meta = self.read(CHAPTER), self.read("meta.yaml")
        self.facts = load_meta(root)
        self.exercises = self.facts.get("exercises") or {}
        self.includes = list(texts.find_includes(self.chapter))

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

    def scripts(self):
        """(path from the root, text) of the exercises' scripts."""
        for path in sorted(self.root.glob("exercises/*.py")):
            yield path.relative_to(self.root).as_posix(), path.read_text("utf-8", "replace")


def check_regions(project):
    """Regions = hashes = includes, in order, and all markers and includes well formed."""
    found, problems = regions.scan_all(project.root)
    project.problems += problems
    by_file = {
        file: each if isinstance(each, dict) else {}
        for file, each in (project.facts.get("region_hashes") or {}).items()
    }
    hashes = {name: (file, sha) for file, each in by_file.items() for name, sha in each.items()}
    for name, region in found.items():
        _, sha = hashes.get(name, (None, None))
        what = (
            None
            if sha == region.sha256
            else "has no hash in meta.yaml"
            if sha is None
            else "has changed since its prose was last read"
        )
        if what:
            project.say(
                region.file, region.first - 1, f"region {name} {what}", f"{GATE} --accept {name}"
            )
    for name, (file, _) in hashes.items():
        if name not in found or found[name].file != file:
            project.say(
                "meta.yaml",
                rf"^ +{name}:",
                f"a hash of {name}, and {file} has no such region",
                f"{GATE} --accept {name}",
            )
    for file, each in by_file.items():
        order = [name for name in found if found[name].file == file]
        if set(order) == set(each) and order != list(each):
            project.say(
                "meta.yaml",
                rf"^  {file}:",
                f"the regions of {file} are no longer in the order in which they were read",
                "put them back, or their hashes in order",
            )
    check_includes(project, found)


def check_includes(project, found):
    """Every region is included once, or a name or pattern in `not_shown` covers it."""
    hidden = project.facts.get("not_shown") or []
    shown = [include.name for include in project.includes]
    for name, region in found.items():
        covered = any(fnmatchcase(name, pattern) for pattern in hidden)
        if name not in shown and not covered and name != regions.docstring_name(region.file):
            include = f"[include-by-region: {region.file}#{name}]"
            repair = f"add a fence with {include}, or name it in `not_shown` of meta.yaml"
            project.say(CHAPTER, 1, f"region {name} is never shown", f"{repair}, then {GATE}")
    for pattern in hidden:
        covered = [name for name in found if fnmatchcase(name, pattern)]
        both = [name for name in covered if name in shown]
        if both or not covered:
            what = f"{both[0]}, which is shown" if both else f"{pattern}, which is no region"
            what = f"not_shown names {what}"
            project.say("meta.yaml", "^not_shown:", what, f"take it out, then {GATE}")
    for k, (line, file, name) in enumerate(project.includes):
        if name not in found or found[name].file != file:
            allowed = ", ".join(each for each in found if found[each].file == file)
            what = f"includes {name}, and {file} has no such region"
            project.say(CHAPTER, line, what, f"name one of {allowed or 'a literate file'}")
        if name in shown[:k]:
            project.say(CHAPTER, line, f"includes {name} a second time", f"delete one, then {GATE}")
    check_stray_includes(project)


def check_stray_includes(project):
    """No include stands where it would not be shown."""
    lines = {include.line for include in project.includes}
    for line, text in enumerate(project.chapter.split("\n"), 1):
        if "include-by-region" in text and line not in lines:
            what = (
                "an include that is not alone in its fence or not of the form "
                "[include-by-region: FILE#NAME]"
            )
            project.say(CHAPTER, line, what, f"edit it, then {GATE}")


def check_passages(project):
    """Every passage has the hash that was accepted, and meta.yaml has no hash of anything else."""
    found = passages.of(*passages.reader(project.root))
    hashes = project.facts.get("passage_hashes") or {}
    for name, passage in found.items():
        if passage.file is None and hashes.get(name) != passage.sha256:
            file = {
                **dict.fromkeys(passages.CHAPTER_PASSAGES, CHAPTER),
                **dict.fromkeys(passages.README_PASSAGES, passages.README),
            }.get(name, "meta.yaml")
            what = "has changed since it was last read" if name in hashes else "was never accepted"
            project.say(
                file,
                rf"^  {name}:" if file == "meta.yaml" else 1,
                f"passage {name} {what}",
                f"{GATE} --accept {name}",
            )
    for name in hashes.keys() - found.keys():
        project.say(
            "meta.yaml",
            rf"^  {name}:",
            f"a hash of {name}, and there is no such passage",
            f"{GATE} --accept {name}",
        )


def check_typed(project):
    """No number is typed into the chapter, nor into what an exercise tells the learner."""
    told = [(CHAPTER, None, project.chapter)]
    for name, exercise in project.exercises.items():
        said = {key: exercise.get(key) for key in ("reveal", "hints")}
        told += [("meta.yaml", rf"^  {name}:", text or "") for _, text in leaves(said)]
    for file, line, text in told:
        for index, token in typed_numbers(text):
            project.say(
                file,
                line or line_at(text, index),
                f"a typed number, {token}",
                f"write {{{{KEY|FORMAT}}}} (the keys: {NUMBERS}) or {{{{= {token} | REASON}}}}",
            )


def check_exercises(project):
    """Slots, choices, letters and bands fit together; nothing is run for it."""
    slots = re.findall(r"<!--\s*exercise:\s*([\w-]+)\s*-->", project.chapter)
    scripts = {Path(file).name.split("_")[0]: (file, text) for file, text in project.scripts()}
    for name, exercise in project.exercises.items():

        def say(what, name=name):
            project.say("meta.yaml", rf"^  {name}:", f"{name}: {what}", f"correct it, then {GATE}")

        if slots.count(name) != 1:
            say(f"{CHAPTER} has {slots.count(name)} slots <!-- exercise: {name} -->, not one")
        for key, (low, high) in (exercise.get("bands") or {}).items():
            if not 0 <= high - low <= max(NARROW[0] * abs(high), NARROW[1]):
                say(f"the band [{low}, {high}] of {key} is wider than {NARROW[0]:.0%} of its end")
        if "answer" in exercise:
            told = passages.exercise_words(scripts[name][1]) if name in scripts else {}
            letters = [*(told.get("CHOICES") or exercise.get("true_if") or {})]
            for key in ("true_if", "reveal"):
                if sorted(exercise.get(key) or {}) != sorted(letters):
                    say(f"{key} has {sorted(exercise.get(key) or {})}, the choices are {letters}")
            if exercise["answer"] not in letters:
                say(f"the answer {exercise['answer']!r} is none of the choices {letters}")
    for name in set(slots) - set(project.exercises):
        project.say(
            CHAPTER,
            1,
            f"a slot of {name}, and meta.yaml has no such exercise",
            f"correct it, then {GATE}",
        )


def check_names(project):
    """What texts, exercises and docstrings name is there."""
    known = naming.Names(project.root, project.facts, project.metrics)
    mentioned = {
        file: (project.root / file).read_text("utf-8", "replace")
        for file in TEXTS
        if (project.root / file).exists()
    }
    flags = naming.all_flags(project.root, mentioned.values())
    for file, text in mentioned.items():
        check_commands(project, file, naming.commands(text))
        for line, flag in naming.loose_flags(text):
            if flag not in flags:
                correct(project, file, line, f"no command here has a flag {flag}")
        for line, target in naming.links(text):
            if not ((project.root / file).parent / target.split("#")[0]).exists():
                correct(project, file, line, f"a link to {target}, and there is no such file")
    for line, span in naming.spans(project.chapter):
        for word in known.unknown(span):
            what = f"`{span}` names {word}, which no code here defines"
            correct(
                project, CHAPTER, line, f"{what} (other people's: `foreign_names` of meta.yaml)"
            )
    literate = [file for file in regions.LITERATE if (project.root / file).exists()]
    for file in (*dict(project.scripts()), *literate):
        text = (project.root / file).read_text("utf-8", "replace")
        check_commands(project, file, naming.docstring_commands(text))
    check_live_links(project, flags)
    check_reading(project)


def check_commands(project, file, commands):
    """Every command (line, text) would run as it is printed."""
    for line, command in commands:
        what = naming.command_problem(project.root, command)
        if what:
            correct(project, file, line, f"the command `{command}`: {what}")


def correct(project, file, line, what):
    """Note a problem that only an author can mend."""
    project.say(file, line, what, f"correct it, then {GATE}")


def check_live_links(project, flags):
    """try: links set flags of contact.py to what they take; drag: links name flags."""
    help_text = naming.help_for(project.root, "contact.py") or ""
    for line, kind, value in naming.live_links(project.chapter):
        pairs = value.split("&") if kind == "try" else [value]
        for pair in pairs:
            key, _, given = pair.partition("=")
            words = [f"--{key}"] + ([given] if kind == "try" else [])
            what = (
                naming._flags_problem("contact.py", words, help_text)
                if kind == "try" or f"--{key}" not in flags | {"--impedance"}
                else None
            )
            if what:
                project.say(
                    CHAPTER, line, f"a {kind}: link to {value}: {what}", f"correct it, then {GATE}"
                )


def check_reading(project):
    """The chapter names what `reading` of meta.yaml promises: repository, tag, commit, files."""
    reading = project.facts.get("reading") or {}
    wanted = [str(reading[key]) for key in ("repo", "tag", "commit") if key in reading]
    for file, functions in (reading.get("files") or {}).items():
        wanted += [Path(file).name, *(functions or {})]
    for each in wanted:
        if each not in project.chapter:
            project.say(
                "meta.yaml",
                "^reading:",
                f"reading promises {each}, and {CHAPTER} does not name it",
                f"correct either, then {GATE}",
            )


def check_numbers(project, numbers):
    """References, claims, the reference run and the exercises' answers, against fresh runs."""
    numbers.run_all(project.chapter + str(project.exercises))
    for file, text in ((CHAPTER, project.chapter), ("meta.yaml", project.meta)):
        for match in REFERENCE.finditer(text):
            attempt(project, file, line_at(text, match.start()), match[0], numbers.text, match[1])
    for match in HOLDS.finditer(project.chapter):
        line = line_at(project.chapter, match.start())
        attempt(project, CHAPTER, line, match[1], hold, numbers, match[1])
    for name, exercise in project.exercises.items():
        line, answer = rf"^  {name}:", exercise.get("answer")
        for key, band in (exercise.get("bands") or {}).items():
            attempt(project, "meta.yaml", line, f"{name}, {key}", stay, numbers, key, band)
        for claim in exercise.get("holds") or []:
            attempt(project, "meta.yaml", line, f"{name}, {claim}", hold, numbers, claim)
        for letter, claims in (exercise.get("true_if") or {}).items():
            said = f"{name}, {'; '.join(claims)}"
            attempt(project, "meta.yaml", line, said, choose, numbers, letter, claims, answer)
    name = numbers.reference()
    check_reference_run(project, dict(leaves(numbers.run(name))), numbers.config_hash.get(name))


def attempt(project, file, line, claim, call, *inputs):
    """Note the ValueError that `call(*inputs)` raises."""
    try:
        call(*inputs)
    except (ValueError, ZeroDivisionError) as error:
        project.say(
            file,
            line,
            f"{claim}: {error} (the keys: {NUMBERS})",
            f"correct what is wrong, then {GATE}",
        )


def hold(numbers, claim):
    """Raise ValueError unless the claim is true."""
    if not numbers.holds(claim):
        raise ValueError("does not hold")


def stay(numbers, key, band):
    """Raise ValueError unless the number is in the band."""
    value, (low, high) = numbers.value(key), band
    if not (is_number(value) and low <= value <= high):
        raise ValueError(f"{value} is outside {low} to {high}")


def choose(numbers, letter, claims, answer):
    """Raise ValueError unless a choice's claims are all true just when it is the answer."""
    true = all([numbers.holds(claim) for claim in claims])
    if true and letter != answer:
        raise ValueError(f"choice {letter} is true, and the answer is said to be {answer}")
    if letter == answer and not true:
        raise ValueError(f"choice {letter}, the answer, is not true")


def check_reference_run(project, fresh_run, config_hash):
    """`reference_run` of meta.yaml says what a fresh run gives, number by number."""
    reference = project.facts.get("reference_run") or {}
    fresh_run = {**fresh_run, "config_hash": config_hash}
    stated = {**(reference.get("values") or {}), "config_hash": reference.get("config_hash")}
    for key in sorted(fresh_run.keys() | stated.keys()):
        fresh, said = fresh_run.get(key, "missing"), stated.get(key, "missing")
        numeric = isinstance(fresh, float) and isinstance(said, (int, float))
        if fresh != said and not (numeric and abs(fresh - said) <= TOLERANCE):
            project.say(
                "meta.yaml",
                rf"^ +{re.escape(key)}:",
                f"reference_run says {key} is {said}, a fresh run gives {fresh}",
                f"{NUMBERS} --record",
            )


def check_ledger(project, numbers):
    """Every measured wall-clock has its times beside it; {name: command} of the stale ones."""
    ledger = project.root / "wallclock.csv"
    try:
        rows = wallclock.read(ledger)
        stale = numbers.stale_tiers()
    except ValueError as error:
        where, line, what = str(error).split(":", 2)
        project.say(Path(where).name, int(line), what.strip(), f"correct it, then {GATE}")
        return {}
    runs = wallclock.read_runs(ledger)
    ours = {row["tier"] for row in rows if row["chapter"] == wallclock.CHAPTER}
    for tier in sorted(ours ^ {*wallclock.SHOWN, *runs} if rows else ()):
        project.say(
            "wallclock.csv",
            1,
            f"tier {tier} has a row and nothing measured, or no row; the "
            f"course shows {', '.join(wallclock.SHOWN)}",
            f"correct it, then {GATE}",
        )
    for line, row in enumerate(rows, 2):
        if row["chapter"] == wallclock.CHAPTER and row["status"] == "MEASURED":
            what = wallclock.unfounded(row, runs)
            if what:
                project.say(
                    "wallclock.csv",
                    line,
                    f"{row['tier']}: {what}",
                    f"{wallclock.COMMAND} (on that tier)",
                )
    return {f"wallclock:{tier}": wallclock.COMMAND for tier in stale}


def check_measured(project, numbers):
    """What was measured on other code is named in `stale` of meta.yaml, and nothing else is."""
    stale = check_ledger(project, numbers)
    for name in RESULTS:
        sections = measured.load(project.root / "curriculum" / name / "results")
        for section, said in sections.items():
            if isinstance(said, dict) and measured.is_stale(said, project.root):
                stale[f"{name}:{section}"] = command_of(said, name)
    named = project.facts.get("stale") or []
    for name, command in stale.items():
        if name not in named:
            project.say(
                "meta.yaml",
                "^stale:",
                f"{name} was measured on other code than today's",
                f"{command}, or name {name} in `stale` of meta.yaml and the text says so",
            )
    for name in named:
        if name not in stale:
            project.say(
                "meta.yaml",
                "^stale:",
                f"stale names {name}, which is not",
                f"take it out, then {GATE}",
            )


def check_readme(project):
    """The README's generated blocks are what their commands make now."""
    path = project.root / "README.md"
    text = path.read_text("utf-8", "replace") if path.exists() else ""
    if "<!-- generated:" not in text or not (project.root / "curriculum/readme.py").exists():
        return
    from curriculum import readme

    for block in readme.BLOCK.finditer(text):
        if block[0] != made_again(readme, block[0]):
            project.say(
                "README.md",
                line_at(text, block.start()),
                f"the generated block {block['name']} is not what `{block['command']}` makes",
                readme.COMMAND,
            )


BLOCKS = {}  # the text of a generated block: what its command makes of it


def made_again(readme, block):
    """A generated block of the README, made anew; each one once."""
    head = block.split("\n")[0]
    if head not in BLOCKS:
        end = "<!-- end -->"
        try:
            BLOCKS[head] = readme.fill(f"{head}\n{end}").removesuffix(end)
        except ValueError as error:
            BLOCKS[head] = str(error)
    return BLOCKS[head]


def check_scope(project):
    """What is left to other chapters is said in one section of the chapter alone."""
    scope = project.facts.get("scope") or {}
    title, words = scope.get("section", ""), scope.get("words") or []
    heading = re.search(rf"^#+ .*{re.escape(title)}.*", project.chapter, re.MULTILINE)
    if not title or not heading:
        project.say(
            "meta.yaml",
            "^scope:",
            f"scope.section {title!r} is no heading of {CHAPTER}",
            f"name the heading, then {GATE}",
        )
        return
    first, last = texts.section(project.chapter, line_at(project.chapter, heading.start()))
    paths = [project.root / file for file in (CHAPTER, *regions.LITERATE, "checks.py", "README.md")]
    for path in paths + sorted(project.root.glob("exercises/*.py")):
        file = path.relative_to(project.root).as_posix()
        text = path.read_text("utf-8", "replace").lower() if path.exists() else ""
        for line, here in enumerate(text.split("\n"), 1):
            said = next((word for word in words if word.lower() in here), None)
            if said and not (file == CHAPTER and first <= line <= last):
                project.say(
                    file,
                    line,
                    f"{said!r} is said outside {CHAPTER}, section {title!r}",
                    f"move it there or point there, then {GATE}",
                )


STATIC = (check_regions, check_passages, check_typed, check_exercises, check_scope)
RUNNING = (check_numbers, check_measured)


def check(root=ROOT, numbers=None, first=False):
    """Every problem of the project at `root`, one line each. Writes nothing.

    `numbers` may hold runs already made. With `first`, the parts after the first problem are left
    out, and so are the runs when reading alone finds one.
    """
    missing = [f for f in ("contact.py", "meta.yaml", CHAPTER) if not (Path(root) / f).exists()]
    if missing:
        return [f"{file}:1: missing; repair: git checkout {file}" for file in missing]
    problems, numbers = [], numbers or Numbers(root)
    try:
        project = Project(root)
        problems = project.problems
        for part in STATIC:
            if not (first and problems):
                part(project)
        for part in RUNNING:
            if not (first and problems):
                part(project, numbers)
        project.metrics = list(numbers.runs.values())
        for part in (check_names, check_readme):
            if not (first and problems):
                part(project)
    except ValueError as error:  # not YAML, no runs, or the script fails
        at = "" if re.match(r"[\w./]+:\d+: ", str(error)) else "contact.py:1: "
        problems.append(f"{at}{error}; repair: correct it, then {GATE}")
    return problems


@stoppable
def main(argv=None):
    """Check, accept, or fuzz. Returns the exit status: 0 in order, 1 drift, 2 bad usage."""
    from curriculum.common.arguments import Parser, number

    parser = Parser(prog=GATE, description="Hold chapter, code, numbers and ledger together.")
    parser.add_argument(
        "--accept",
        metavar="NAME",
        nargs="+",
        help="record the hash of these, showing what changed and where it is told",
    )
    parser.add_argument(
        "--fuzz",
        metavar="N",
        type=number(int, low=1),
        help="make N random mutations, one at a time, and list those that pass",
    )
    parser.add_argument("--seed", type=number(int, low=0), default=0, help="of --fuzz (0)")
    parser.add_argument("--root", default=ROOT, type=Path, help="another copy of the project")
    args = parser.parse_args(argv)
    if args.accept:
        try:
            for name in args.accept:
                accept(args.root, name)
        except BrokenPipeError:
            raise  # of the reader of what is shown, and nothing is accepted
        except (OSError, ValueError) as error:
            print(error, file=sys.stderr)
            return 2
        return 0
    if args.fuzz:
        from curriculum.drift import fuzz

        return fuzz.main(args.root, args.fuzz, args.seed)
    problems = check(args.root)
    print(
        *(problems or ["chapter, code, numbers and ledger agree"]),
        sep="\n",
        file=sys.stderr if problems else sys.stdout,
    )
    return 1 if problems else 0


if __name__ == "__main__":
    raise SystemExit(main())
