"""contact.py as a file: it is short-winded, works alone, and says so where it cannot."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from curriculum import regions

ROOT = Path(__file__).resolve().parents[2]
LITERATE = ["contact.py", "curriculum/exact.py", "curriculum/piles.py"]
LITERATE = [name for name in LITERATE if (ROOT / name).exists()]


def functions(name):
    """Every function of a file, nested ones too."""
    tree = ast.parse((ROOT / name).read_text("utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def names_of(function):
    """The names a reader has to keep in mind: arguments and what is assigned."""
    assigned = {
        node.id
        for node in ast.walk(function)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    return assigned | {argument.arg for argument in function.args.args}


@pytest.mark.parametrize("name", LITERATE)
def test_functions_have_at_most_40_lines_and_regions_that_are_shown_fit_a_screen(name):
    long = {
        f.name: f.end_lineno - f.lineno + 1
        for f in functions(name)
        if f.end_lineno - f.lineno + 1 > 40
    }
    assert not long, f"functions over 40 lines: {long}"
    chapter = (ROOT / "curriculum/prose/chapter.md").read_text("utf-8")
    for region in regions.find(ROOT / name).values():
        shown = f"[include-by-region: {name}#{region.name}]" in chapter
        lines = region.text.count("\n")
        assert lines <= (48 if shown else 60), f"region {region.name} has {lines} lines"
    wide = [line for line in (ROOT / name).read_text("utf-8").splitlines() if len(line) > 100]
    assert not wide, wide


def test_functions_of_contact_py_juggle_at_most_15_names():
    crowded = {f.name: len(names_of(f)) for f in functions("contact.py") if len(names_of(f)) > 15}
    assert not crowded, crowded


def test_contact_py_imports_the_course_inside_functions_only():
    tree = ast.parse((ROOT / "contact.py").read_text("utf-8"))
    modules = [
        alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names
    ]
    modules += [node.module for node in tree.body if isinstance(node, ast.ImportFrom)]
    assert sorted(modules) == ["itertools", "math", "numpy", "sys", "typing"]


@pytest.fixture
def alone(tmp_path):
    """A function that runs Python in a folder that holds nothing but a copy of contact.py."""
    shutil.copy(ROOT / "contact.py", tmp_path)

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=60
        )

    return run


def test_a_copy_alone_in_a_folder_gives_the_published_figures(alone):
    done = alone(
        "-c",
        "import contact as c\n"
        "scene = c.build_scene('drop')\n"
        "for model in ('penalty', 'lcp'):\n"
        "    run = c.run_model(model, scene, 0.002, 2000)\n"
        "    print(c.contact_quality(run, scene, 0.002)['max_penetration_frac'])\n",
    )
    assert done.returncode == 0, done.stderr
    assert [round(float(line), 12) for line in done.stdout.split()] == [
        0.251329183485,
        0.056743325071,
    ]


def test_a_copy_alone_steps_soft_and_a_pile(alone):
    done = alone(
        "-c",
        "import contact as c\n"
        "for name, model in (('drop', 'soft'), ('pile', 'lcp')):\n"
        "    scene = c.build_scene(name, bodies=20 if name == 'pile' else None)\n"
        "    run = c.run_model(model, scene, 0.002, 30)\n"
        "    print(c.contact_quality(run, scene, 0.002)['blew_up'])\n",
    )
    assert done.stdout.split() == ["False", "False"], done.stderr


def test_the_command_line_of_a_copy_alone_says_in_one_line_what_it_needs(alone):
    done = alone("contact.py", "--scene", "drop")
    assert done.returncode == 2 and done.stdout == ""
    assert "needs the course's folder" in done.stderr and done.stderr.count("\n") == 1
