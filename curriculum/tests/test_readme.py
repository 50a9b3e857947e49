"""The README is true: what it shows is what is printed, what it names is there, what it calls answers."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from curriculum import readme

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_table_in_the_readme_is_what_contact_py_prints():
    shown = re.search(r"by python contact.py --scene drop -->\n(.*?)<!-- end -->", TEXT, re.DOTALL)[
        1
    ]
    assert shown == readme.printed(["--scene", "drop"])


def test_a_changed_digit_in_the_table_is_noticed():
    wrong = TEXT.replace("-0.00981", "-0.00982", 1)
    assert wrong != TEXT and readme.fill(wrong) != wrong


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#:]+)\)", TEXT))
def test_every_file_that_the_readme_links_is_there(target):
    assert (ROOT / target).exists(), f"README.md links {target}, which is not there"


@pytest.mark.parametrize("module", sorted(set(re.findall(r"-m (curriculum[\w.]*)", TEXT))))
def test_every_command_that_the_readme_names_answers_help(module):
    run = subprocess.run(
        [sys.executable, "-m", module, "--help"], cwd=ROOT, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
