"""The notebook runs in full beside no project, finds what contact.py finds, feels every change."""

import json
import os
import re
import subprocess
import sys

import ipykernel  # noqa: F401  # which runs it
import matplotlib  # noqa: F401
import nbclient
import nbformat
import pytest

import contact
from curriculum.gate.chapter import CHAPTER, read
from curriculum.lesson import regions
from curriculum.notebook import __main__ as notebook

SOFTER = "def penalty_normal_force(depth, v_n, stiffness, damping):\n    return 0.0\n"
ASKED = f"""\
import json
with open(os.path.join(COURSE, "outputs/metrics.json")) as file:
    found = json.load(file)
{SOFTER}
fallen = run_model("penalty", build_scene("drop"), 0.002, 2000)
found["fallen"] = contact_quality(fallen, build_scene("drop"), 0.002)["through"]
print(json.dumps(found))
"""
BET = 'exercise("exercises/ex1_predict_contact.py")\n'


@pytest.fixture(scope="module")
def text():
    return notebook.build()


@pytest.fixture
def book(text):
    return nbformat.reads(text, as_version=4)


@pytest.fixture(scope="module")
def executed(text, tmp_path_factory):
    """The notebook with its outputs, run in an empty folder, with a bet made in its cell."""
    book = nbformat.reads(text, as_version=4)
    book.cells.append(nbformat.v4.new_code_cell(ASKED))
    for cell in book.cells:
        if cell.source.startswith("%%writefile contact_chapter/exercises/ex1_"):
            made = cell.source.replace("PREDICTION = None", 'PREDICTION = "A"')
            cell.source = made.replace('WHY = ""', 'WHY = "a table is a table, I think"')
    folder = tmp_path_factory.mktemp("notebook")
    with pytest.MonkeyPatch.context() as shell:
        shell.delenv("MPLBACKEND", raising=False)  # a kernel shows pictures unless told otherwise
        where = {"metadata": {"path": str(folder)}}
        nbclient.NotebookClient(book, timeout=120, kernel_name="python3", resources=where).execute()
    return book


def printed(cell):
    return "".join(output.get("text", "") for output in cell.outputs)


def code_of(book):
    return "\n".join(cell.source for cell in book.cells if cell.cell_type == "code")


def test_two_builds_are_the_same_bytes_whatever_the_hash_seed(text, tmp_path):
    words = [sys.executable, "-m", "curriculum.notebook", "--out", tmp_path / "contact.ipynb"]
    environment = os.environ | {"PYTHONHASHSEED": "7"}
    subprocess.run(words, cwd=regions.ROOT, env=environment, check=True, capture_output=True)
    assert (tmp_path / "contact.ipynb").read_text("utf-8") == text


def test_what_the_chapter_shows_of_contact_is_a_cell_and_no_mark_of_the_page_is_left(book):
    code, known = code_of(book), regions.read_all()
    parts = read((regions.ROOT / CHAPTER).read_text("utf-8"))
    rest = [part.name for part in parts].index(notebook.REST)
    for name in (part.name for part in parts[:rest] if part.name.startswith("contact.py#")):
        assert known[name.partition("#")[2]].code.split("\n\n\n")[0].strip() in code, name
    prose = "\n".join(cell.source for cell in book.cells if cell.cell_type == "markdown")
    assert not re.search(r"\{\{|<!--|include-by-region|\]\(try:|\]\(drag:", prose)
    said = r"[Tt]ake it, lift|throw it\.|\b[Dd]rag (it|the (?!ball back))|[Cc]lick"
    assert not re.search(said, prose), "only the page can do that"


def test_runs_and_the_benchmark_are_pictures(executed):
    for part in ('show_run("--scene", "drop")', 'show_run("--dt"', "error-slide.svg"):
        (cell,) = [each for each in executed.cells if part in each.source]
        assert "image/svg+xml" in cell.outputs[-1].data, part


def test_cells_of_its_own_are_all_used(book):
    own, code = notebook.Book().own, code_of(book)
    assert [name for name in own if own[name] not in code] == []


def test_it_runs_beside_no_project_and_finds_what_contact_finds(executed, tmp_path):
    assert all(cell.execution_count for cell in executed.cells if cell.cell_type == "code")
    found = json.loads(printed(executed.cells[-1]))
    words = ["--scene", "stack", "--bodies", "10", "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(words) == 0  # the last run that the notebook shows
    assert found["quality"] == json.loads((tmp_path / "metrics.json").read_text())["quality"]
    assert found["fallen"] == "the floor", "a region changed in its cell is not felt below"


def test_it_speaks_as_a_notebook(executed):
    for cell in executed.cells:
        if cell.source.startswith(("exercise(", "%%writefile")):
            text = cell.source + (printed(cell) if cell.cell_type == "code" else "")
            assert not re.search(r"^ *(next, .*)?python |exercises/ex\d+\w*\.py:", text, re.M), text


def test_each_exercise_can_be_tried_and_shows_how_to_ask(executed):
    cells = [cell for cell in executed.cells if cell.source.startswith("exercise(")]
    assert len(cells) == 10 and all('"--hint", "1")' in cell.source for cell in cells)
    waits = ("is still a blank: write what line", "no prediction yet", "given ? ?", "no choice yet")
    waits += ("yet; write a number",)
    said = [printed(cell) for cell in cells if BET not in cell.source]
    assert all(any(words in text for words in waits) for text in said), said


def test_a_bet_made_in_its_cell_is_judged_by_the_next(executed):
    (cell,) = [cell for cell in executed.cells if cell.source.startswith(BET)]
    assert "no prediction" not in printed(cell) and "Traceback" not in printed(cell)
    assert "0.51" in printed(cell), "how deep penalty dives"
