"""What a user installs, and what the README tells him to type."""

import ast
import importlib
import os
import re
from pathlib import Path

import pytest

import contact
from curriculum.commands import write_atomic
from curriculum.source import read_text, replace_once
from curriculum.tests import plant
from curriculum.tests.helpers import ROOT, python

TEXTS = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
README, CONTRIBUTING, _ = ((ROOT / file).read_text("utf-8") for file in TEXTS)
BOTH = README + CONTRIBUTING
COMMANDS = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__main__"): text
    for path in sorted(ROOT.glob("curriculum/**/*.py"))
    if '\nif __name__ == "__main__":' in (text := path.read_text("utf-8"))
}
SCRIPTS = "contact.py", "checks.py", "exercises/ex1_predict_contact.py"
TYPED = [*SCRIPTS, *(f"-m {each}" for each in COMMANDS if ".tests." not in each)]


@pytest.mark.parametrize("command", TYPED)
def test_without_its_packages_a_command_says_what_to_install(numpy_alone, tmp_path, command):
    """With no package at all; and those that need more than numpy, with numpy alone."""
    runs = [(str(tmp_path), ()), (str(tmp_path), ("--help",)), (numpy_alone, ("--help",))]
    if re.search("checks|bench|notebook|page|gate", command):
        runs.append((numpy_alone, ()))
    for packages, flags in runs:
        done = python("-S", *command.split(), *flags, PYTHONPATH=packages)
        one = (done.stderr.count("\n"), done.returncode) == (1, 2)
        says = re.search(
            "missing; install it: |pip install numpy, |error: .* are required", done.stderr
        )
        assert one and says or done.returncode == 0 and flags, done.stderr


def test_what_to_install_is_said_for_the_program_that_runs_here():
    code = "from curriculum.commands import to_install; print(to_install('yaml', 'page'), end='')"
    uv, pip = (python("-S", "-c", code, **shell).stdout for shell in ({"UV": "uv"}, {}))
    assert uv.startswith("yaml is missing; install it: uv run --extra page python -S -c ")
    assert pip.endswith("-m pip install -e '.[page]'")
    broken = (
        "from curriculum.commands import needs\nwith needs('page'):\n    import curriculum.pgae"
    )
    assert "ModuleNotFoundError: No module named 'curriculum.pgae'" in python("-c", broken).stderr


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with a name")
def test_what_is_no_file_is_written_into_and_stays_what_it_is(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    write_atomic(path, "some words")
    assert os.read(reader, 99) == b"some words" and path.is_fifo()
    os.close(reader)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("table", plant.TABLES)
def test_what_a_mutant_replaces_stands_there_once_and_it_is_python(table):
    for file, old, new, _ in importlib.import_module(f"curriculum.tests.faults.{table}").FAULTS:
        planted = replace_once(read_text(file), old, new, f"{table}: {file}")
        if file.endswith(".py"):
            ast.parse(planted)  # any test would detect what is no Python


def test_links_of_the_texts_lead_somewhere():
    for file in TEXTS:
        text = (ROOT / file).read_text("utf-8")
        headings = ["-".join(each.lower().split()) for each in re.findall(r"^## (.+)", text, re.M)]
        for path, anchor in re.findall(r"\]\((?!https?:)([^)\s#]*)#?([^)\s]*)\)", text):
            assert (ROOT / path).exists() and (path or anchor in headings), (file, path, anchor)


def test_commands_of_the_texts_exist_with_their_flags():
    for module, flags in re.findall(r"python -m (curriculum[\w.]*)((?: --[a-z]+)*)", BOTH):
        assert all(f'"{flag}"' in COMMANDS[module] for flag in flags.split()), (module, flags)
    helped = contact.make_parser().format_help()
    for flag in set(re.findall(r"contact\.py[^`\n]*?(--[a-z]+)", BOTH)) - {"--help"}:
        assert flag in helped, flag


def test_modules_of_the_table_exist_and_import_only_those_above_them():
    _, _, section = CONTRIBUTING.partition("\n## Modules\n")
    lines = re.findall(r"^\| (.+?) \| .+? \| (.+?) \| .*\|$", section, re.M)[2:]
    tests = {name for _, names in lines for name in names.split(", ")} | {"test_packaging.py"}
    assert tests == {path.name for path in (ROOT / "curriculum/tests").glob("test_*.py")}
    above = {"commands", "parallel", "said"}  # which any room may use
    for room in ", ".join(rooms for rooms, _ in lines).split(", "):
        above.add(Path(room).stem)
        (place,) = {each for each in (ROOT / room, ROOT / "curriculum" / room) if each.exists()}
        for file in [place] if place.is_file() else set(place.rglob("*.py")):
            text = file.read_text("utf-8")
            found = re.findall(r"^ *from curriculum(?: import ([\w, ]+)|\.(\w+))", text, re.M)
            used = {name for names in found for name in re.findall(r"\w+", " ".join(names))}
            assert used <= above, (file, used - above)
