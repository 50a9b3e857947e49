"""The notebook: same bytes each time, runs in full on its own, and finds what the script finds."""

import json
import subprocess
import sys

import pytest

nbformat = pytest.importorskip("nbformat", reason="nbformat is missing: pip install -e '.[test]'")
nbclient = pytest.importorskip("nbclient", reason="nbclient is missing: pip install -e '.[test]'")
pytest.importorskip("yaml", reason="PyYAML is missing: pip install -e '.[page]'")

from curriculum import notebook, regions  # noqa: E402

ROOT = regions.ROOT
if not (ROOT / notebook.CHAPTER).exists():
    pytest.skip("the chapter is not written yet", allow_module_level=True)


@pytest.fixture(scope="module")
def text():
    return notebook.build()


@pytest.fixture(scope="module")
def executed(text, tmp_path_factory):
    """(the notebook with its outputs, the folder it ran in): a folder with nothing else in it."""
    folder = tmp_path_factory.mktemp("notebook")
    book = nbformat.reads(text, as_version=4)
    book.cells.append(nbformat.v4.new_code_cell("import curriculum; print(curriculum.__file__)"))
    nbclient.NotebookClient(book, timeout=300, kernel_name="python3",
                            resources={"metadata": {"path": str(folder)}}).execute()
    return book, folder


def printed(cell):
    return "".join(output.get("text", "") for output in cell.outputs)


def test_two_builds_are_the_same_bytes(text, tmp_path):
    assert notebook.main(["--out", str(tmp_path / "again.ipynb")]) == 0
    assert (tmp_path / "again.ipynb").read_bytes() == text.encode()


def test_every_region_is_a_code_cell_in_order(text):
    code = [cell.source for cell in nbformat.reads(text, as_version=4).cells
            if cell.cell_type == "code"]
    places = [next(k for k, source in enumerate(code)
                   if source.endswith(region.text.replace(notebook.ENTRY, "").strip()))
              for region in regions.find().values()]
    assert places == sorted(places)


def test_prose_has_its_numbers_and_no_page_marks(text):
    prose = "\n".join(cell.source for cell in nbformat.reads(text, as_version=4).cells
                      if cell.cell_type == "markdown")
    for mark in ("{{", "<!--", "include-by-region"):
        assert mark not in prose, mark
    assert "## Break it" in prose and "<details>" in prose


def test_it_runs_from_top_to_bottom_beside_no_project(executed):
    book, _ = executed
    assert all(cell.execution_count for cell in book.cells if cell.cell_type == "code")
    assert str(ROOT) not in printed(book.cells[-1])


def test_it_shows_the_table_and_writes_the_recording(executed):
    book, folder = executed
    ran = next(cell for cell in book.cells if cell.source == "main([])")
    assert "exact" in printed(ran) and "config_hash" in printed(ran)
    pytest.importorskip("rerun", reason="rerun is missing: pip install rerun-sdk")
    assert (folder / "outputs/ch3.5-contact/contact.rrd").stat().st_size > 10_000


def test_its_metrics_are_those_of_the_script_byte_for_byte(executed, tmp_path):
    _, folder = executed
    subprocess.run([sys.executable, ROOT / "contact.py", "--no-rerun", "--out", tmp_path],
                   check=True, capture_output=True)
    script = (tmp_path / "metrics.json").read_bytes()
    assert (folder / "outputs/ch3.5-contact/metrics.json").read_bytes() == script
    assert json.loads(script)["scene"] == "drop"


def test_a_chapter_that_hides_a_region_is_refused(tmp_path):
    for name in ("contact.py", "meta.yaml", "wallclock.csv", "curriculum", "exercises"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "curriculum").unlink()
    (tmp_path / "curriculum/prose").mkdir(parents=True)
    for name in ("__init__.py", "common"):
        (tmp_path / "curriculum" / name).symlink_to(ROOT / "curriculum" / name)
    (tmp_path / notebook.CHAPTER).write_text("# Contact\n", encoding="utf-8")
    with pytest.raises(ValueError, match="never shows setup"):
        notebook.build(tmp_path)
