"""What a user installs, and what the README tells him to type."""

import ast
import importlib.metadata
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text("utf-8")
TEXTS = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
PROJECT = (ROOT / "pyproject.toml").read_text("utf-8")
DECLARED = PROJECT.split("[tool.")[0]  # dependencies and extras


def run(*words, cwd=ROOT, **environment):
    """A finished process of this Python, its output as text."""
    return subprocess.run(
        [sys.executable, *map(str, words)],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.fixture(scope="module")
def only(tmp_path_factory):
    """A function: a folder of links to exactly these distributions and what they require."""

    def make(*names):
        folder, wanted = tmp_path_factory.mktemp("only"), list(names)
        for name in wanted:
            found = importlib.metadata.distribution(name)
            for part in {file.parts[0] for file in found.files} - {".."}:
                if not (folder / part).exists() and not part.startswith("__"):
                    (folder / part).symlink_to(Path(found.locate_file(part)))
            needs = [each for each in found.requires or [] if ";" not in each]
            wanted += [re.match(r"[\w.-]+", each)[0] for each in needs]
        return folder

    return make


@pytest.mark.parametrize("scene", ["drop", "bounce", "stack"])
def test_contact_alone_in_an_empty_folder_runs_all_models_with_numpy_and_nothing_else(
    only, tmp_path, scene
):
    (tmp_path / "contact.py").write_bytes((ROOT / "contact.py").read_bytes())
    flags = ("-S", "contact.py", "--scene", scene)
    done = run(*flags, cwd=tmp_path, PYTHONPATH=str(only("numpy")))
    assert done.returncode == 0, done.stderr
    printed = [line.split()[0] for line in done.stdout.splitlines() if line.strip()]
    assert [word for word in printed if word in ("penalty", "lcp", "soft", "exact")] == [
        *("penalty", "lcp", "soft", "exact")
    ]
    (written,) = tmp_path.rglob("metrics.json")
    assert '"exact"' in written.read_text("utf-8")


def test_exercises_and_checks_work_with_numpy_and_pytest_alone(only):
    packages = str(only("numpy", "pytest"))
    words = ("-S", "-m", "pytest", "-p", "no:cacheprovider", "checks.py")
    checked = run(*words, PYTHONPATH=packages)
    assert checked.returncode == 0, checked.stdout
    bet = run("-S", "exercises/ex1_predict_contact.py", PYTHONPATH=packages)
    assert "Traceback" not in bet.stderr and "A" in bet.stdout + bet.stderr


def test_readme_is_short_and_shows_the_balls_first():
    lines = README.splitlines()
    assert len(lines) <= 130
    picture = re.search(r"!\[[^]]+\]\(([^)]+)\)", "\n".join(lines[:20]))
    assert picture and (ROOT / picture[1]).stat().st_size > 1000


@pytest.mark.parametrize("file", TEXTS)
def test_links_of_the_texts_lead_somewhere(file):
    text = (ROOT / file).read_text("utf-8")
    headings = [
        "-".join(line[3:].lower().split()) for line in text.splitlines() if line[:3] == "## "
    ]
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = target.partition("#")
        if "://" not in target:
            assert not path or (ROOT / path).exists(), target
            assert path or anchor in headings, target


def test_commands_of_the_texts_exist_with_their_flags():
    text = "".join((ROOT / file).read_text("utf-8") for file in TEXTS[:2])
    modules = set(re.findall(r"python -m (curriculum[\w.]*)", text))
    for module in sorted(modules):
        flags = set(re.findall(rf"python -m {module}((?: --[a-z]+)*)", text))
        helped = run("-m", module, "--help")
        assert helped.returncode == 0, module
        for flag in {word for each in flags for word in each.split()}:
            assert flag in helped.stdout, (module, flag)
    helped = run("contact.py", "--help").stdout
    for flag in set(re.findall(r"contact\.py[^`\n]*?(--[a-z]+)", text)) - {"--help"}:
        assert flag in helped, flag


def test_extras_of_the_texts_are_those_of_the_package():
    named = set(re.findall(r"\.\[(\w+)\]", README)) | set(
        re.findall(r"^\| `(\w+)` \|", README, re.M)
    )
    declared = re.findall(r"^(\w+) = \[", DECLARED.split("[project.optional-")[1], re.M)
    assert named == set(declared) == {"learn", "page", "notebook", "bench", "dev"}


def plain(name):
    """A distribution's name as PyPI compares it."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", name)[0]).lower()


def test_every_import_is_of_a_package_that_an_extra_brings():
    declared = re.findall(r'[\["]([\w-]+)[\[\]>]', DECLARED)  # "dask[distributed]>=1" brings both
    installed = {plain(each.name): each for each in importlib.metadata.distributions()}
    known = {plain(name) for name in declared} | {"contact-chapter"}
    for name in known & installed.keys():  # and what those require: Jinja2 brings MarkupSafe
        known = known | {plain(each) for each in installed[name].requires or []}
    owners = importlib.metadata.packages_distributions()
    places = ("*.py", "exercises/**/*.py", "curriculum/**/*.py")
    for path in (path for place in places for path in ROOT.glob(place)):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module]
            for name in {each.split(".")[0] for each in names} & set(owners):
                assert {plain(owner) for owner in owners[name]} & known, (path, name)
