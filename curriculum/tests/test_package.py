"""What is installed: contact.py alone, which imports anywhere; and what is kept out of the way."""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
USE = """
import contact
run = contact.run_model("lcp", contact.build_scene("drop"), 0.002, 2000)
print(contact.__file__)
radius = contact.build_scene("drop").radius
print(round(float(contact.max_penetration(run.q, radius).max() / 0.1), 12))
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder that holds what the wheel holds, as pip would unpack it."""
    pytest.importorskip("setuptools", minversion="77", reason="setuptools 77 is not installed")
    source, made = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("made")
    for name in ("contact.py", "checks.py", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    shutil.copytree(ROOT / "curriculum/common", source / "curriculum/common")
    build = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"
    subprocess.run(
        [sys.executable, "-c", build, str(made)], cwd=source, check=True, capture_output=True
    )
    (wheel,) = made.glob("*.whl")
    zipfile.ZipFile(wheel).extractall(made / "site")
    return made / "site"


def run(site, folder, *words):
    """Python in a folder of its own, which finds the installed files and not this repository."""
    return subprocess.run(
        [sys.executable, "-P", *words] if sys.version_info >= (3, 11) else [sys.executable, *words],
        cwd=folder,
        env={"PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
    )


def test_the_wheel_puts_contact_py_and_nothing_else_into_site_packages(site):
    names = {path.name for path in site.iterdir() if not path.name.endswith(".dist-info")}
    assert names == {"contact.py"}


def test_installed_it_imports_from_anywhere_and_gives_the_published_figure(site, tmp_path):
    done = run(site, tmp_path, "-c", USE)
    assert done.stdout.split() == [str(site / "contact.py"), "0.056743325071"], done.stderr


def test_installed_the_command_line_says_in_one_line_what_it_needs(site, tmp_path):
    done = run(site, tmp_path, "-m", "contact", "--scene", "drop")
    assert done.returncode == 2 and done.stdout == "" and list(tmp_path.iterdir()) == []
    assert re.fullmatch(r"contact\.py: .*needs the course's folder.*\n", done.stderr), done.stderr


def test_the_lock_names_no_registry_but_pypi():
    hosts = set(re.findall(r"https?://([^/\"]+)", (ROOT / "uv.lock").read_text("utf-8")))
    assert hosts == {"pypi.org", "files.pythonhosted.org"}
