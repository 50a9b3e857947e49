"""The notebook runs in full beside no project, finds what contact.py finds, feels every change."""

import ast
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
from curriculum import regions
from curriculum.notebook import build as notebook

SOFTER = "def penalty_normal_force(depth, v_n, stiffness, damping):\n    return 0.0\n"
ASKED = f"""\
import json
found = {{"quality": rounded(qualities), "groove": float(abs(grooves["on the sum"][0]).max()),
         "thrown": float(abs(grooves["on the change"][0]).max())}}
{SOFTER}
fallen = run_model("penalty", build_scene("drop"), 0.002, 2000)
found["fallen"] = contact_quality(fallen, build_scene("drop"), 0.002)["through"]
box = knobs(try_soft, timeconst=(0.002, 0.02, 0.2), dt=(0.0005, 0.002, 0.064),
            impedance_at_surface=(0.0, 0.9, 0.9999))
slider, shown = box.children[0], [picture.value for picture in box.children[-1].children]
slider.value = 0.1
turned = [picture.value for picture in box.children[-1].children]
found["pictures"] = [(a[:4] == b"\\x89PNG", a == b) for a, b in zip(shown, turned)]
print(json.dumps(found))
"""
BET = 'course("exercises/ex1_predict_contact.py")\n'
JUDGED = """\
sys.path.insert(0, os.path.join(COURSE, "exercises"))
from kit import alone, script, trials
exercise = alone.load(os.path.join(COURSE, "{file}"))
state = script.BETS["{name}"].state if "{name}" in script.BETS else partial(trials.judged, "{name}")
print("state:", state(exercise)[0])
"""


@pytest.fixture(scope="module")
def text():
    return notebook.build()


@pytest.fixture
def book(text):
    return nbformat.reads(text, as_version=4)


@pytest.fixture(scope="module")
def executed(text, tmp_path_factory):
    """The notebook with its outputs, run in an empty folder, with a bet made in its cell.

    The other exercises, which are as they were written, are judged without a process of their own.
    """
    book = nbformat.reads(text, as_version=4)
    book.cells.append(nbformat.v4.new_code_cell(ASKED))
    for cell in book.cells:
        run = re.match(r'course\("(exercises/(ex\d+)_\w+\.py)"\)', cell.source)
        if run and run[2] != "ex1":
            cell.source = JUDGED.format(file=run[1], name=run[2])
        if cell.source.startswith("%%writefile contact_chapter/exercises/ex1"):
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


def test_it_opens_on_a_ball_that_falls_before_anything_has_run(book):
    shown = [cell for cell in book.cells[:8] if cell.get("outputs")]
    (picture,) = [output.data["image/svg+xml"] for cell in shown for output in cell.outputs]
    assert "@keyframes" in picture and "exact</text>" in picture


def test_what_the_chapter_shows_of_contact_is_a_cell_and_no_mark_of_the_page_is_left(book):
    code, known = code_of(book), regions.read_all()
    chapter = notebook.CHAPTER.read_text("utf-8").partition(notebook.REST)[0]
    for name in re.findall(r"include-by-region: contact\.py#([\w-]+)", chapter):
        assert known[name].code.split("\n\n\n")[0].strip() in code, name
    prose = "\n".join(cell.source for cell in book.cells if cell.cell_type == "markdown")
    assert not re.search(r"\{\{|<!--|include-by-region|\]\(try:|\]\(drag:", prose)
    said = r"[Tt]ake it, lift|throw it\.|\b[Dd]rag (it|the (?!ball back))|[Cc]lick"
    assert not re.search(said, prose), "only the page can do that"


def test_corner_signs_and_benchmark_are_pictures(executed):
    for part in ("the corner: where", "blue: n, from b to a", "error-bounce.svg"):
        (cell,) = [cell for cell in executed.cells if part in cell.source and cell.outputs]
        assert {*("image/png", "image/svg+xml")} & set(cell.outputs[-1].data), part


def test_cells_of_pictures_and_knobs_are_all_used_and_take_no_name_of_contacts(book):
    own, code = notebook.own_cells(), code_of(book)
    assert [name for name in own if own[name] not in code] == []
    for name, source in own.items():
        nodes = list(ast.walk(ast.parse(source)))
        stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        stored |= {n.name for n in nodes if isinstance(n, ast.FunctionDef)}
        own_names = {"solve_contacts", "__file__"}  # the first is put back after its use
        assert stored & set(vars(contact)) <= own_names, name


def test_it_runs_beside_no_project_and_finds_what_contact_finds(executed, tmp_path):
    assert all(cell.execution_count for cell in executed.cells if cell.cell_type == "code")
    found = json.loads(printed(executed.cells[-1]))
    assert contact.main(["--no-rerun", "--out", str(tmp_path)]) == 0
    assert found["quality"] == json.loads((tmp_path / "metrics.json").read_text())["quality"]
    assert found["groove"] < 1e-3 and found["thrown"] > 1.0
    assert found["fallen"] == "the floor", "a region changed in its cell is not felt below"
    impedance, gaps = found["pictures"]  # a time constant changes the second
    assert impedance == [True, True] and gaps == [True, False], "turning a knob draws anew"


def test_each_exercise_can_be_judged_and_shows_how_to_ask(executed, book):
    judged = [printed(cell) for cell in executed.cells if "trials.judged" in cell.source]
    assert [said.splitlines()[-1] for said in judged] == ["state: blank"] * 9
    runs = re.findall(r"^course\(.*\n.*$", code_of(book), re.MULTILINE)
    assert len(runs) == 10 and all('"--hint", "1")' in source for source in runs)


def test_a_bet_made_in_its_cell_is_judged_by_the_next(executed):
    (cell,) = [cell for cell in executed.cells if cell.source.startswith(BET)]
    assert "no prediction" not in printed(cell) and "Traceback" not in printed(cell)
    assert "0.25" in printed(cell), "how deep penalty dives"
