"""The notebook: same bytes each time, opens on a picture, runs in full on its own beside no project,
and finds what the script finds."""

import base64
import json
import os
import subprocess
import sys

import pytest

nbformat = pytest.importorskip("nbformat", reason="nbformat is missing: pip install -e '.[test]'")
nbclient = pytest.importorskip("nbclient", reason="nbclient is missing: pip install -e '.[test]'")
pytest.importorskip("ipykernel", reason="ipykernel is missing: pip install -e '.[test]'")
pytest.importorskip("matplotlib", reason="matplotlib is missing: pip install -e '.[test]'")
pytest.importorskip("yaml", reason="PyYAML is missing: pip install -e '.[page]'")

from curriculum import notebook, regions  # noqa: E402

ROOT = regions.ROOT
ASKED = """\
import json
def plainly(quality):
    return {key: round(value, 12) if isinstance(value, float) else value
            for key, value in quality.items()}
print(json.dumps({model: plainly(quality) for model, quality in qualities.items()}))
"""
HOMES = """\
import json
print(json.dumps([Contact.__module__, exact.simulate_exact.__module__,
                  hasattr(exact, "heapq") and "heapq" not in globals()]))
"""
GROOVE = """\
path = {clamp: fall_into_groove(rule) for clamp, rule in
        (("sum", lambda lam, dlam: max(0.0, lam + dlam)),
         ("change", lambda lam, dlam: lam + max(0.0, dlam)))}
print(json.dumps({clamp: float(abs(found[0]).max()) for clamp, found in path.items()}))
"""


@pytest.fixture(scope="module")
def numbers():
    """The runs that the text quotes, made once."""
    return notebook.Numbers(ROOT)


@pytest.fixture(scope="module")
def text(numbers):
    return notebook.build(numbers=numbers)


@pytest.fixture(scope="module")
def book(text):
    return nbformat.reads(text, as_version=4)


@pytest.fixture(scope="module")
def executed(text, tmp_path_factory):
    """The notebook with its outputs, run in an empty folder, and what was asked of it at the end."""
    book = nbformat.reads(text, as_version=4)
    for question in (HOMES, ASKED, GROOVE):
        book.cells.append(nbformat.v4.new_code_cell(question))
    folder = tmp_path_factory.mktemp("notebook")
    with pytest.MonkeyPatch.context() as shell:
        shell.delenv("MPLBACKEND", raising=False)  # a kernel shows pictures unless told otherwise
        nbclient.NotebookClient(
            book, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}}
        ).execute()
    return book


def printed(cell):
    return "".join(output.get("text", "") for output in cell.outputs)


def code_of(book):
    return [cell.source for cell in book.cells if cell.cell_type == "code"]


def pictures(cell):
    return [
        output.data["image/png"] for output in cell.outputs if "image/png" in output.get("data", {})
    ]


def test_two_builds_are_the_same_bytes_whatever_the_hash_seed(text, numbers, tmp_path):
    """The runs are handed over: that they repeat is tested with the script."""
    made = json.dumps([numbers.runs, numbers.config_hash])
    (tmp_path / "runs.json").write_text(made, encoding="utf-8")
    again = (
        "import json, sys; from curriculum import notebook; "
        "runs, hashes = json.load(open(sys.argv[1], encoding='utf-8')); "
        "numbers = notebook.Numbers(notebook.regions.ROOT, runs); "
        "numbers.config_hash = hashes; "
        "sys.stdout.buffer.write(notebook.build(numbers=numbers).encode())"
    )
    run = subprocess.run(
        [sys.executable, "-B", "-c", again, tmp_path / "runs.json"],
        cwd=ROOT,
        env=os.environ | {"PYTHONHASHSEED": "7"},
        capture_output=True,
        check=True,
    )
    assert run.stdout == text.encode()


def test_the_command_writes_it(monkeypatch, text, tmp_path, capsys):
    monkeypatch.setattr(notebook, "build", lambda: text)
    assert notebook.main(["--out", str(tmp_path / "contact.ipynb")]) == 0
    assert (tmp_path / "contact.ipynb").read_bytes() == text.encode()
    assert "contact.ipynb" in capsys.readouterr().out


def test_it_opens_on_a_picture_and_simulates_within_five_cells(book):
    """The picture is there before anything has run, in a cell that steps a ball."""
    early = [cell for cell in book.cells[:5] if cell.cell_type == "code" and pictures(cell)]
    assert len(early) == 1 and "dt * gravity" in early[0].source
    assert base64.b64decode(pictures(early[0])[0]).startswith(b"\x89PNG")


def test_every_region_but_the_command_line_is_code_once(book):
    """In an order in which every figure finds what it uses: that it runs is the test below."""
    code = "\n".join(code_of(book))
    for script in notebook.SCRIPTS:
        for name, region in regions.find(ROOT / script).items():
            hidden = script == "contact.py" and name in notebook.command_line(ROOT)
            assert code.count(region.text.strip()) == (0 if hidden else 1), name


def test_exact_keeps_its_names_to_itself(book, executed):
    """contact.py and exact.py may use a name for two things: each finds its own."""
    cells = [cell.source for cell in book.cells if cell.cell_type == "code"]
    for name in regions.find(ROOT / notebook.SCRIPTS[1]):
        text = regions.find(ROOT / notebook.SCRIPTS[1])[name].text.strip()
        assert next(each for each in cells if text in each).startswith(notebook.MAGIC + "\n")
    assert sum(each == notebook.START for each in cells) == 1
    first = next(k for k, each in enumerate(cells) if each.startswith(notebook.MAGIC))
    assert notebook.START in cells[:first] and notebook.EXACT in cells[first:]
    assert json.loads(printed(executed.cells[-3])) == ["__main__", "exact", True]


def test_no_cell_is_a_dump(book):
    """The longest cell is the bookkeeping of exact, which is folded; no visible one is over 60."""
    for cell in book.cells:
        folded = bool(cell.metadata)
        assert folded or cell.cell_type != "code" or cell.source.count("\n") <= 60, cell.source[:60]
    assert "import curriculum" not in "\n".join(code_of(book))


def test_prose_has_its_numbers_and_no_page_marks(book):
    prose = "\n".join(cell.source for cell in book.cells if cell.cell_type == "markdown")
    for mark in ("{{", "<!--", "include-by-region", "](try:", "](drag:"):
        assert mark not in prose, mark
    assert "## Break it" in prose and "<details>" in prose


def test_it_cites_nothing_that_it_does_not_hold(book):
    """The signs stand in a section of the text; a table at the top of a file is not here."""
    prose = "\n".join(cell.source for cell in book.cells if cell.cell_type == "markdown")
    assert "at the top of" not in prose
    assert f"### {notebook.SIGNS_HERE}\n" in prose and prose.count(repr(notebook.SIGNS_HERE)) == 1


def test_all_cells_of_the_pictures_are_used(book):
    code = code_of(book)
    assert all(cell.source in code for cell in notebook.own_cells(ROOT).values())


def test_it_runs_from_top_to_bottom_beside_no_project_and_shows_its_pictures(executed):
    assert all(cell.execution_count for cell in executed.cells if cell.cell_type == "code")
    shown = [cell for cell in executed.cells if cell.cell_type == "code" and pictures(cell)]
    drawn = [cell for cell in notebook.own_cells(ROOT).values() if "plt.subplots" in cell.source]
    assert len(shown) == len(drawn)


def test_its_numbers_are_those_of_the_script(executed, tmp_path):
    subprocess.run(
        [sys.executable, ROOT / "contact.py", "--no-rerun", "--out", tmp_path],
        check=True,
        capture_output=True,
    )
    script = json.loads((tmp_path / "metrics.json").read_text("utf-8"))["quality"]
    assert json.loads(printed(executed.cells[-2])) == script


def test_the_clamp_on_the_change_throws_the_ball_out_of_the_groove(executed):
    """The chapter says so; the ball of the right clamp stays in the middle to rounding."""
    farthest = json.loads(printed(executed.cells[-1]))
    assert farthest["sum"] < 1e-3 and farthest["change"] > 1.0


def test_its_soft_ball_is_mujocos_where_that_is_installed(executed):
    cell = next(cell for cell in executed.cells if cell.source.startswith("# soft beside"))
    if "is not installed" in printed(cell):
        pytest.skip("mujoco is missing: pip install mujoco")
    assert float(printed(cell).split("at most ")[1].split(" m")[0]) < 1e-12


def changed(tmp_path, change):
    """A copy of the project whose chapter is changed by `change(text)`."""
    for path in ROOT.iterdir():
        if path.name not in ("curriculum", ".git"):
            (tmp_path / path.name).symlink_to(path)
    (tmp_path / "curriculum/prose").mkdir(parents=True)
    for path in (ROOT / "curriculum").iterdir():
        if path.name != "prose":
            (tmp_path / "curriculum" / path.name).symlink_to(path)
    chapter = (ROOT / notebook.CHAPTER).read_text("utf-8")
    (tmp_path / notebook.CHAPTER).write_text(change(chapter), encoding="utf-8")
    return tmp_path


def test_a_chapter_whose_pictures_lack_their_code_is_refused(tmp_path, numbers):
    cut = changed(tmp_path, lambda text: text.split("### Way four")[0] + notebook.REST)
    with pytest.raises(ValueError, match="uses what no cell before it defines"):
        notebook.build(cut, numbers)


def test_a_chapter_without_its_last_section_is_refused(tmp_path, numbers):
    cut = changed(tmp_path, lambda text: text.split(notebook.REST)[0])
    with pytest.raises(ValueError, match="no section"):
        notebook.build(cut, numbers)
