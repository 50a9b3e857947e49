"""The passages whose hashes meta.yaml holds: a person has read each as it is now.

Code can be run and a number can be measured, but whether a sentence is true of a function only a
reader can say. So what no program can judge is entered twice: in its file, and as a hash in
meta.yaml. A passage is one of

    a region, or what stands outside the regions of a literate file     region_hashes, by file
    outline         headings, includes, slots and live links of the chapter, in order
    claims          its references to numbers and its `holds:` comments, in order
    formulas        its formulas, in order
    number-words    its numbers in words, each with two words on both sides
    turning-words   its words that say which way or whether ("deeper", "never"), with their neighbours
    readme-words    the same of the README, but for its generated blocks
    typed-numbers   the typed numbers that a reason excuses
    ex1, ex2, ...   what an exercise tells, asks, offers, answers and allows
    promises        the rest of meta.yaml: objectives, reading, runs, scope

All but the regions are in passage_hashes. `accept` shows the change of one of them, where it is told,
and records its hash; it works on names, since each means that somebody has read that passage.
"""

import ast
import difflib
import hashlib
import json
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

from curriculum import regions
from curriculum.common.files import write_whole
from curriculum.drift import texts
from curriculum.drift.texts import CHAPTER

META, README = "meta.yaml", "README.md"
CHAPTER_PASSAGES = {
    "outline": texts.outline,
    "claims": texts.claims,
    "formulas": texts.formulas,
    "number-words": texts.number_words,
    "turning-words": texts.turning_words,
    "typed-numbers": texts.typed_by_reason,
}
README_PASSAGES = {"readme-words": texts.turning_words}
NOT_PROMISES = ("exercises", "reference_run", "region_hashes", "passage_hashes", "stale")
GATE = "python -m curriculum.check_prose_code_drift"


class Passage(NamedTuple):
    """A passage: the file whose hashes it stands among (None: passage_hashes), and its text."""

    name: str
    file: str | None
    text: str

    @property
    def sha256(self):
        return hashlib.sha256(self.text.encode("utf-8")).hexdigest()


def of(read, files):
    """{name: Passage} of one copy of the project.

    `read(file)` gives a file's text, None where there is none; `files` are all paths there.
    """

    def data(file):
        text = read(file)
        return None if text is None else text.encode("utf-8", "surrogateescape")

    found, _ = regions.scan_all(read=data)
    made = [Passage(name, region.file, region.text) for name, region in found.items()]
    chapter, meta = read(CHAPTER) or "", load(read(META))
    made += [
        Passage(name, None, "".join(f"{line}\n" for line in make(text)))
        for makers, text in ((CHAPTER_PASSAGES, chapter), (README_PASSAGES, read(README) or ""))
        for name, make in makers.items()
    ]
    for name, facts in (meta.get("exercises") or {}).items():
        script = next(
            (file for file in files if re.fullmatch(rf"exercises/{name}_\w+\.py", file)), ""
        )
        told = exercise_words(read(script) or "") if script else {}
        made.append(Passage(name, None, show({"script": told, META: facts})))
    rest = {key: value for key, value in meta.items() if key not in NOT_PROMISES}
    made.append(Passage("promises", None, show(rest)))
    return {passage.name: passage for passage in made}


def load(text):
    """meta.yaml's text as a dict; {} where it is none."""
    import yaml

    try:
        found = yaml.load(text or "", getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        return found if isinstance(found, dict) else {}
    except yaml.YAMLError:
        return {}


def show(value):
    """A nested value as text, the same for equal values."""
    return json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False, default=str) + "\n"


def exercise_words(text):
    """{name: value} of what an exercise's script tells the learner: docstring and constants.

    PREDICTION and WHY are the learner's own.
    """
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return {"not Python": text}
    said = {"docstring": ast.get_docstring(tree)}
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            try:
                said[name] = ast.literal_eval(node.value)
            except ValueError:
                continue
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and ast.get_docstring(node):
            said[node.name] = ast.get_docstring(node)
    return {name: value for name, value in said.items() if name not in ("PREDICTION", "WHY")}


def recorded(meta):
    """{name: hash} of all passages that meta.yaml has accepted."""
    found = {}
    for hashes in (meta.get("region_hashes") or {}).values():
        found.update(hashes if isinstance(hashes, dict) else {})
    return found | (meta.get("passage_hashes") or {})


def reader(root):
    """A `read` for the files below `root` as they are now, and all their paths."""
    root = Path(root)

    def read(file):
        path = root / file
        return path.read_bytes().decode("utf-8", "surrogateescape") if path.is_file() else None

    return read, sorted(f"exercises/{path.name}" for path in root.glob("exercises/*.py"))


def accepted_text(root, name, sha256, where):
    """The passage's text when it had that hash, from git; or None and why there is none.

    `where` are the files whose commits are looked at.
    """

    def git(*words):
        command = ["git", "-C", str(root), *words]
        return subprocess.run(command, capture_output=True, check=True).stdout

    def read(file):
        try:
            return git("show", f"{commit}:./{file}").decode("utf-8", "surrogateescape")
        except subprocess.CalledProcessError:
            return None

    try:
        for commit in git("log", "-n", "300", "--format=%H", "--", *where).decode().split():
            listed = git("ls-tree", "-r", "--name-only", commit, "./").decode().split()
            found = of(read, listed).get(name)
            if found and found.sha256 == sha256:
                return found.text, None
    except (OSError, subprocess.CalledProcessError, UnicodeDecodeError):
        return None, "no git history here"
    return None, "the accepted text is in none of the last commits"


def defined_names(text):
    """What a region's code defines: functions, classes and constants, and methods by their name."""
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return set()
    names = {
        node.name
        for node in ast.walk(tree)
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("__")
    }
    return names | {
        target.id
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def naming(names):
    """A pattern that finds any of these names where it is meant as a name.

    One that could be a plain word counts in a code span, in a call or after its module alone.
    """
    plain = [re.escape(name) for name in sorted(names) if re.fullmatch(r"[a-z]+", name)]
    other = [re.escape(name) for name in sorted(names) if not re.fullmatch(r"[a-z]+", name)]
    modules = "|".join(Path(file).stem for file in regions.LITERATE)
    found = [rf"(?<![\w.-])({'|'.join(other)})(?!\w)"] if other else []
    if plain:
        word = rf"({'|'.join(plain)})"
        found += [rf"`[^`\n]*\b{word}\b[^`\n]*`", rf"\b{word}\(", rf"\b({modules})\.{word}\b"]
    return re.compile("|".join(found))


def passages_naming(root, names):
    """(file, line, text) of every paragraph of chapter, README and exercises that names any."""
    read, exercises = reader(root)
    for file in [CHAPTER, README, META, *exercises] if names else []:
        text = read(file) or ""
        for found in re.finditer(r"(?:^.*\S.*\n?)+", text, re.MULTILINE):
            if naming(names).search(found[0]):
                yield file, texts.line_at(text, found.start()), found[0].rstrip("\n")


def accept(root, name):
    """Show what changed and where it is told, then record the one hash. Raises ValueError."""
    root = Path(root)
    _, problems = regions.scan_all(root)
    if problems:
        raise ValueError("\n".join(problems))
    read, files = reader(root)
    found, meta = of(read, files), load(read(META))
    hashes = recorded(meta)
    if name not in found and name not in hashes:
        raise ValueError(f"given {name!r}, allowed: {', '.join(found)}")
    new = found.get(name)
    if new and new.sha256 == hashes.get(name):
        print(f"{name}: nothing to accept, the hash is already recorded")
        return
    old, why = None, "there was no hash before"
    if name in hashes:
        where = (
            [new.file]
            if new and new.file
            else [*regions.LITERATE, CHAPTER, README, META, "exercises"]
        )
        old, why = accepted_text(root, name, hashes[name], where)
    if old is None:
        print(f"{name}: {why}, so the whole passage is shown instead of a change")
    print(
        *difflib.unified_diff(
            (old or "").splitlines(),
            (new.text if new else "").splitlines(),
            f"{name}, accepted",
            f"{name}, now",
            lineterm="",
            n=2,
        ),
        sep="\n",
    )
    if new and new.file:
        show_where_told(root, new, old)
    record(root, found, name, new)
    before = hashes.get(name, "none")
    print(
        f"\n{name}: {f'recorded {new.sha256}' if new else 'its hash is removed'} (before: {before})"
    )


def show_where_told(root, region, old):
    """Print the section that shows a region, and all other paragraphs that name what it defines."""
    chapter = reader(root)[0](CHAPTER) or ""
    shown = range(0)
    for include in texts.find_includes(chapter):
        if include.name == region.name:
            first, last = texts.section(chapter, include.line)
            shown = range(first, last + 1)
            print(
                f"\n{CHAPTER}:{include.line} shows it; the section, lines {first} to {last}, "
                "says:\n"
            )
            for number in shown:
                print(f"{number:>5}  {chapter.splitlines()[number - 1]}")
    names = defined_names(region.text) | defined_names(old or "")
    for file, line, text in passages_naming(root, names):
        if file == CHAPTER and line in shown:
            continue
        print(f"\n{file}:{line} names what it defines:\n")
        print("\n".join(f"       {each}" for each in text.split("\n")))


def record(root, found, name, new):
    """Write the one hash into meta.yaml, in the order of the files; the rest stays as it is."""
    path = Path(root) / META
    text = path.read_text("utf-8")
    meta = load(text)
    by_file = {file: dict(each or {}) for file, each in (meta.get("region_hashes") or {}).items()}
    plain = dict(meta.get("passage_hashes") or {})
    for hashes in (*by_file.values(), plain):
        hashes.pop(name, None)
    if new:
        (by_file.setdefault(new.file, {}) if new.file else plain)[name] = new.sha256
    order = {each: place for place, each in enumerate(found)}
    lines = ["region_hashes:\n"]
    for file in sorted(
        by_file,
        key=lambda file: (
            regions.LITERATE.index(file) if file in regions.LITERATE else len(regions.LITERATE)
        ),
    ):
        if by_file[file]:
            lines += [f"  {file}:\n"] + [
                f"    {each}: {by_file[file][each]}\n"
                for each in sorted(by_file[file], key=lambda each: order.get(each, len(order)))
            ]
    text = put_block(text, "region_hashes", "".join(lines))
    lines = ["passage_hashes:\n"] + [
        f"  {each}: {plain[each]}\n"
        for each in sorted(plain, key=lambda each: order.get(each, len(order)))
    ]
    write_whole(path, put_block(text, "passage_hashes", "".join(lines)))


def put_block(text, key, block):
    """meta.yaml's text with the block of a top-level key replaced, or put at the end."""
    text, count = re.subn(rf"^{key}:.*\n?(?: .*(\n|$))*", lambda _: block, text, flags=re.M)
    return text if count else f"{text.rstrip()}\n\n{block}"
