"""Whether the names, flags, commands and links that a text mentions are there.

A text names code in `code spans` and in fences. Of these are checked

    names      every word of a span must occur in the code of the literate files (curriculum/
               regions.py), in what a run writes, or in meta.yaml, where `foreign_names` lists the
               names of other people's code. Comments and docstrings do not count as code.
    commands   a line that begins with python, pytest, pip, uv or rerun must name a file, module
               or extra that is there, and flags and choices that its own --help lists
    flags      a --flag that stands alone must be one of contact.py or of another command here
    links      a relative link or image must lead to a file; try: and drag: to flags of contact.py
"""

import ast
import builtins
import io
import keyword
import os
import re
import shlex
import subprocess
import sys
import tokenize
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path

from curriculum import regions
from curriculum.drift.texts import CODE, COMMENT, DRAGGED, FENCE, blank, line_at
from curriculum.quoted import REFERENCE, leaves

WORD = re.compile(r"[A-Za-z_]\w*")
FLAG = re.compile(r"(?<![\w-])--[a-z][\w-]*")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)|<img[^>]*\bsrc=\"([^\"]+)\"")
PYTHON = re.compile(r"(\S*/)?(python[\d.]*|pytest|pip|uv|rerun)")
GENERATED = re.compile(r"<!-- generated: [\w-]+ by ([^>]*?) -->")
PLACEHOLDER = re.compile(r"[A-Z][A-Z_:]*|\.\.\.|\[.*\]|<.*>|'?[A-Z]+\|?[A-Z]*'?")
HELP = {}  # (target, its text): what --help prints
OTHERS = ("pytest", "pip", "uv", "rerun", "git", "venv", "http")  # commands with flags of their own
# flags of programs that are not ours, as far as our texts use them: others are taken for slips
OF_UV = ("--extra", "--with", "--python")
OF_PYTEST = ("-k", "-m", "-n", "-q", "-r", "-rs", "-v", "-x", "--dist", "--durations")


class Names:
    """What may be named in the texts of one copy of the project."""

    def __init__(self, root, facts, metrics=()):
        """`facts` is meta.yaml as a dict; `metrics` are runs, whose keys may be named."""
        self.root, self.facts = Path(root), facts
        self.words = set(keyword.kwlist) | set(dir(builtins)) | {"self", "numpy", "np", "JSON"}
        for file in regions.LITERATE:
            data = regions.read_bytes(self.root / file)
            self.words |= code_words(data.decode("utf-8", "replace")) if data else set()
        for tree in [facts, *metrics]:
            for key, value in leaves(tree):
                self.words |= set(WORD.findall(key))
                if isinstance(value, str) and len(value) < 60:
                    self.words |= set(WORD.findall(value))
        for name in facts.get("foreign_names") or []:
            self.words |= set(WORD.findall(name))

    def unknown(self, span):
        """The words of a code span that nothing here defines; none where it is a file or folder."""
        if (self.root / span.strip("/")).exists() or PYTHON.match(span):
            return []
        text = re.sub(r"\{\{.*?\}\}|\"[^\"]*\"|'[^']*'|--[a-z][\w-]*([ =][^\s`]+)?", " ", span)
        text = re.sub(
            r"[\w./-]+\.(py|md|json|yaml|csv|rrd|toml|c|h|html|ipynb|lock)\b"
            r"|\b[0-9a-f]{7,64}\b",
            self._file,
            text,
        )
        return [
            word
            for word in WORD.findall(re.sub(r"(?<=\d)e[-+]?\d+", "", text))
            if word not in self.words and len(word) > 1
        ]

    def _file(self, match):
        """Blank when the file is there or is one that a run writes, else its name as it stands."""
        name = match[0]
        there = (
            (self.root / name).exists()
            or name in self.words
            or not name[-1].isalpha()
            or any((self.root / folder / name).exists() for folder in ("curriculum", "exercises"))
        )
        hexadecimal = re.fullmatch(r"[0-9a-f]{7,64}", name)
        made = Path(name).suffix in (".rrd", ".json", ".html", ".ipynb") or "outputs" in name
        foreign = any(name in key for key, _ in leaves(self.facts.get("reading") or {}))
        return " " if there or hexadecimal or made or foreign else f" {name.replace('.', '_')} "


@lru_cache(maxsize=32)
def code_words(text):
    """Every name in Python source, and every short string that is one (a dict key, a choice)."""
    found = set()
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.NAME:
                found.add(token.string)
        for node in ast.walk(ast.parse(text)):
            if (
                isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and len(node.value) < 40
                and "\n" not in node.value
            ):
                found |= set(WORD.findall(node.value))
    except (SyntaxError, tokenize.TokenError):
        found |= set(WORD.findall(text))
    return frozenset(found)


def help_for(root, target):
    """What the --help of a script or module below `root` prints; None without one, or if it fails.

    Kept by the text of the file, so that copies of a project need not ask again.
    """
    path = module_path(root, target)
    if path is None:
        return None
    key = target, path.read_bytes()
    if key not in HELP:
        words = [target] if target.endswith(".py") else ["-m", target]
        run = subprocess.run(
            [sys.executable, "-B", *words, "--help"],
            cwd=root,
            text=True,
            capture_output=True,
            env=os.environ | {"COLUMNS": "400"},
        )
        HELP[key] = run.stdout if run.returncode == 0 else None
    return HELP[key]


def module_path(root, target):
    """The file of a script (a path) or of a module (dotted) below `root`; None without one."""
    path = Path(root, *([target] if target.endswith(".py") else target.split(".")))
    for each in (path, path.with_suffix(".py"), path / "__main__.py"):
        if each.is_file():
            return each
    return None


def command_problem(root, line, facts=None):
    """What is wrong with a command as printed, or None."""
    try:
        words = shlex.split(line, comments=True)
    except ValueError as error:
        return f"cannot be read: {error}"
    for cut in [k for k, word in enumerate(words) if word in ("&&", "||", ";", "|", ">")][:1]:
        return command_problem(root, shlex.join(words[:cut])) or (
            command_problem(root, shlex.join(words[cut + 1 :]))
            if words[cut] in ("&&", "||", ";")
            else None
        )
    while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
        words = words[1:]
    program = Path(words[0]).name if words else ""
    if program == "uv" and "run" in words[1:2]:
        return _uv_problem(root, words[2:])
    if re.fullmatch(r"python[\d.]*", program):
        return _python_problem(root, words[1:])
    if program == "pytest":
        return _pytest_problem(root, words[1:])
    if program == "pip":
        return _extras_problem(root, words)
    return None


def _uv_problem(root, words):
    while words and words[0].startswith("-"):
        if words[0].partition("=")[0] not in OF_UV:
            return f"uv run: {words[0]} is none of the flags that are known here: {' '.join(OF_UV)}"
        if words[0] == "--extra":
            problem = _extras_problem(root, [f".[{words[1]}]"])
            if problem:
                return problem
        words = words[2:]
    script = words and words[0].endswith(".py")
    return command_problem(root, shlex.join((["python"] if script else []) + words))


def _python_problem(root, words):
    while words and re.fullmatch(r"-[BEIOPu]+|-[WX]", words[0]):
        words = words[2:] if words[0] in ("-W", "-X") else words[1:]
    if words[:1] == ["-m"] and words[1:]:
        if words[1] == "pip":
            return _extras_problem(root, words)
        if words[1] == "pytest":
            return _pytest_problem(root, words[2:])
        if not words[1].startswith("curriculum"):
            return None
        words = words[1:]
    if not words or words[0].startswith("-") or PLACEHOLDER.fullmatch(words[0]):
        return None
    target, rest = words[0], words[1:]
    if module_path(root, target) is None:
        return f"there is no {target}"
    text = help_for(root, target)
    if text is None:
        return f"python {target} --help fails"
    return _flags_problem(target, rest, text)


def _flags_problem(target, words, text):
    """Whether the flags, and the values of flags with choices, are in the help text."""
    flags = set(FLAG.findall(text))
    for k, word in enumerate(words):
        flag, _, value = word.partition("=")
        if not FLAG.fullmatch(flag):
            continue
        if flag not in flags:
            return f"{target} has no {flag}; it has {' '.join(sorted(flags))}"
        choices = re.search(rf"{flag} \{{([^}}]*)\}}", text)
        value = value or next(iter(words[k + 1 : k + 2]), "")
        if choices and value not in choices[1].split(",") and not PLACEHOLDER.fullmatch(value):
            return f"{target} {flag} takes {choices[1]}, not {value!r}"
    first = re.search(r"^usage:.*? \{([^}]*)\}( |$)", re.sub(r"\[[^\]]*\]", "", text), re.M)
    if (
        first
        and words
        and not words[0].startswith("-")
        and words[0] not in first[1].split(",")
        and not PLACEHOLDER.fullmatch(words[0])
    ):
        return f"{target} takes {first[1]}, not {words[0]!r}"
    return None


def _pytest_problem(root, words):
    for k, word in enumerate(words):
        if word.startswith("-") and word.partition("=")[0] not in OF_PYTEST:
            return f"pytest: {word} is none of the flags that are known here: {' '.join(OF_PYTEST)}"
        if word.endswith(".py") and not (Path(root) / word).exists():
            return f"there is no {word}"
        if word == "-k" and words[:k] and words[k - 1].endswith(".py"):
            tests = re.findall(r"def (test_\w+)", (Path(root) / words[k - 1]).read_text("utf-8"))
            if not any(words[k + 1] in each for each in tests):
                return f"{words[k - 1]} has no test named {words[k + 1]!r}"
    return None


def _extras_problem(root, words):
    project = Path(root) / "pyproject.toml"
    named = {
        name
        for word in words
        for name in (re.search(r"\.\[([\w,-]+)\]", word) or ["", ""])[1].split(",")
        if name
    }
    if not named:
        return None
    text = project.read_text("utf-8") if project.exists() else ""
    block = re.search(r"^\[project\.optional-dependencies\]\n(.*?)(?=^\[|\Z)", text, re.M | re.S)
    known = set(re.findall(r"^([\w-]+) *=", block[1] if block else "", re.M))
    missing = sorted(named - known)
    return (
        f"pyproject.toml has no extra {missing[0]!r}; it has {' '.join(sorted(known))}"
        if missing
        else None
    )


def commands(text):
    """(line number, command) of every one in fences, code spans and heads of generated blocks."""
    found = [(line_at(text, match.start()), match[1]) for match in GENERATED.finditer(text)]
    for fence in FENCE.finditer(text):
        first = line_at(text, fence.start())
        lines = re.sub(r"\\\n", "  ", fence[0]).split("\n")
        for k, line in enumerate(lines):
            if PYTHON.match(line.strip().removeprefix("$ ")):
                found.append((first + k, line.strip().removeprefix("$ ")))
    for span in CODE.finditer(blank(FENCE.pattern, text, FENCE.flags)):
        inside = " ".join(span[0].strip("`").split())
        if span[1] and PYTHON.match(inside) and " " in inside:
            found.append((line_at(text, span.start()), inside))
    return found


def docstring_commands(text):
    """(line number, command) of every indented example in a Python file's docstring."""
    found = re.match(r'\s*"""(.*?)"""', text, re.DOTALL)
    lines = found[1].split("\n") if found else []
    return [
        (number, line.strip())
        for number, line in enumerate(lines, 1)
        if re.match(r" {4,}(python|pytest)\b", line)
    ]


def all_flags(root, texts):
    """Every flag of contact.py and of what commands in the texts run, from their help."""
    targets = {"contact.py"} | {
        word
        for text in texts
        for _, line in commands(text)
        for word in re.findall(r"-m (curriculum[\w.]*)|(\S+\.py)", line)
        for word in word
        if word and word != "checks.py"
    }
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        texts = pool.map(lambda target: help_for(root, target) or "", targets)
        return {flag for text in texts for flag in FLAG.findall(text)}


def loose_flags(text):
    """(line number, flag) of every flag in a code span or fence outside of a command."""
    shown = blank(COMMENT.pattern, text, re.DOTALL)
    for _, command in commands(text):
        shown = shown.replace(command, " " * len(command))
    spans = [*FENCE.finditer(shown), *CODE.finditer(blank(FENCE.pattern, shown, FENCE.flags))]
    return [
        (line_at(shown, span.start() + flag.start()), flag[0])
        for span in spans
        for flag in FLAG.finditer(span[0])
        if not any(re.search(rf"(^|[\s`/]){other}\b", span[0]) for other in OTHERS)
    ]


def spans(text):
    """(line number, inside) of every code span of the prose."""
    prose = blank(FENCE.pattern, blank(COMMENT.pattern, text, re.DOTALL), FENCE.flags)
    prose = blank(REFERENCE.pattern, prose)
    return [
        (line_at(prose, span.start()), " ".join(span[0].strip("`").split()))
        for span in CODE.finditer(prose)
        if span[1]
    ]


def links(text):
    """(line number, target) of every relative link and image."""
    shown = blank(FENCE.pattern, text, FENCE.flags)
    return [
        (line_at(shown, match.start()), match[1] or match[2])
        for match in LINK.finditer(shown)
        if not re.match(r"(https?|mailto|try|drag):|#", match[1] or match[2])
    ]


def live_links(text):
    """(line number, kind, value) of every try: and drag: link."""
    return [(line_at(text, match.start()), match[2], match[3]) for match in DRAGGED.finditer(text)]
