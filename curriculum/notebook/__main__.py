"""The chapter as a notebook that runs from top to bottom, wherever it is.

    python -m curriculum.notebook [--out FILE]

Prose with its numbers; the regions of contact.py and the exercises as cells; some runs with their
curves, where the chapter has a figure. Its first cell (start.py) carries the course's folder with
it and needs numpy and matplotlib. Same inputs, same bytes.
"""

import base64
import io
import sys
import zipfile
from pathlib import Path

from curriculum.commands import Parser, command, needs, write_atomic

with needs("notebook"):
    import nbformat
    from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

    from curriculum.prose.chapter import CHAPTER, read
    from curriculum.prose.references import fill
    from curriculum.source import ROOT, read_all
    from exercises.kit.script import FILES

CARRIED = """contact.py checks.py exercises/*.py exercises/*/*.py exercises/kit/answers.json
curriculum/__init__.py curriculum/commands.py curriculum/exact.py curriculum/predict.py
curriculum/variants.py curriculum/show/__init__.py curriculum/show/picture.py
curriculum/show/figures.mplstyle""".split()
RUNS = {  # after the exercise or the figure of that name
    "ex1": 'show_run("--scene", "drop")',
    "cliff": 'show_run("--dt", "0.03")',
    "sag": 'show_run("--scene", "stack", "--bodies", "10")',
}
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}
METADATA = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
FOLDED = {"jupyter": {"source_hidden": True}, "cellView": "form"}
INTRODUCTION = """\
*This is the chapter as a notebook. Run the cells from the top. The first one puts contact.py and
the exercises into the folder `contact_chapter` beside this notebook. Every cell below a cell
of contact.py uses what you change there, exercises too. An exercise is a cell to edit: run it, and
it is tried; with `--hint 1` at the end of its first line it asks a question that helps. No cell has
been run for you: you are to bet first.*"""
REST = "The rest of the file"  # of the chapter: the notebook's first cell has it


def start():
    """The first cell: what the notebook carries, a zip in base64, then start.py."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as packed:
        for path in (path for each in CARRIED for path in sorted(ROOT.glob(each))):
            name = zipfile.ZipInfo(path.relative_to(ROOT).as_posix())  # dated 1980: same bytes
            packed.writestr(name, path.read_bytes(), zipfile.ZIP_DEFLATED)
    folder = base64.encodebytes(made.getvalue()).decode()
    _, _, code = Path(__file__).with_name("start.py").read_text("utf-8").split("\n", 2)
    return new_code_cell(f'FOLDER = """\n{folder}"""\n{code.strip()}', metadata=FOLDED)


def region(source):
    """A region. Those of contact.py run; others are shown, since their names are their own."""
    file, name = source.split("#")
    code = read_all()[name].code.strip()
    if file == "contact.py":
        return new_code_cell(f"# contact.py, region {name}\n{code}")
    return new_markdown_cell(f"{file}, region {name}:\n\n```python\n{code}\n```\n\n")


def exercise(name):
    """An exercise's file, without its header for uv, as a cell that tries it."""
    source = (ROOT / FILES[name]).read_text("utf-8").split("# ///\n")[-1]
    return new_code_cell(f"%%exercise {FILES[name]}\n{source.strip()}")


def cells_of(text):
    """The chapter's cells, in order: title, introduction and start, then all the others."""
    cells = []
    for kind, name, _, written, _ in read(text):
        if kind == "heading" and name == REST:
            break
        if kind in ("region", "exercise"):
            cells.append(region(name) if kind == "region" else exercise(name))
        if (slot := name.partition("?")[0]) in RUNS:
            cells.append(new_code_cell(RUNS[slot]))
        if kind == "heading" or kind in ("text", "code") and cells[-1].cell_type == "code":
            cells.append(new_markdown_cell())
        if kind in ("heading", "text", "code"):
            cells[-1].source += written
    cells[1:1] = [new_markdown_cell(INTRODUCTION), start()]
    for number, cell in enumerate(cells):
        cell.id, cell.source = f"cell-{number}", cell.source.strip()
    return cells


def build():
    """The notebook as text. Raises ValueError where the chapter cannot be shown as it is."""
    text = fill((ROOT / CHAPTER).read_text("utf-8"))
    return nbformat.writes(new_notebook(cells=cells_of(text), metadata=METADATA)) + "\n"


def main():
    """Build and write. A chapter that cannot be shown ends it with a line and status 1."""
    parser = Parser(prog="python -m curriculum.notebook", description=__doc__.split("\n")[0])
    parser.add_argument("--out", default="outputs/contact.ipynb", metavar="FILE")
    out = parser.parse_args().out
    try:
        text = build()
    except ValueError as error:
        sys.exit(str(error))
    write_atomic(out, text)
    print(f"{out}: {len(text.encode()) / 1000:.0f} kB")
    start = command("-m", "jupyterlab", out, bring=("--extra", "notebook"))
    print(f"open it: {start}\nor upload it to colab.research.google.com")


if __name__ == "__main__":
    main()
