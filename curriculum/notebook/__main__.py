"""The chapter as a notebook that runs from top to bottom, wherever it is.

    python -m curriculum.notebook [--out FILE]

Prose with its numbers; the regions of contact.py as cells, so that a change is felt in every cell
below; runs with their curves (cells.py) where the chapter has its figures; the exercises as cells
to edit. Its first cell carries the course's folder with it and needs numpy and matplotlib, which it
installs where they are missing. Same inputs, same bytes.
"""

import base64
import hashlib
import io
import re
import sys
import textwrap
import zipfile
from collections import Counter
from pathlib import Path

from curriculum.commands import Parser, command, needs, write_whole

with needs("notebook"):
    import nbformat
    from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

    from curriculum.gate.chapter import CHAPTER, read
    from curriculum.gate.references import fill
    from curriculum.lesson.regions import ROOT, read_all

CARRIED = """contact.py checks.py exercises/*.py exercises/kit/* exercises/solutions/*
    curriculum/__init__.py
curriculum/show/__init__.py curriculum/show/picture.py curriculum/show/figures.mplstyle
curriculum/exact.py curriculum/commands.py curriculum/implicit.py
curriculum/bench/results/error-slide.svg curriculum/stress/results/penalty-map.svg""".split()
SAID = {  # what only the page can do: what to do here
    r"Take it, lift it,\s+throw it\.": "Run the cell below.",
    r"\b[Dd]rag the (\w+)": r"change the \1 in a cell",
}
OWN = re.split(
    r"^# %% (\S+)\n", Path(__file__).with_name("cells.py").read_text("utf-8"), flags=re.M
)
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}
METADATA = {"kernelspec": KERNEL, "language_info": {"name": "python"}}
FOLDED = {"jupyter": {"source_hidden": True}, "cellView": "form"}
INTRODUCTION = """\
*This is the chapter as a notebook. Run the cells from the top. The first one puts contact.py and
the exercises into the folder `contact_chapter` beside this notebook. What you change in a cell of
contact.py is felt in every cell below it; an exercise is a cell to edit and one that tries it. No
cell has been run for you: you are to bet first.*"""
REST = "The rest of the file"  # of the chapter: the notebook's first cell has it


def folder():
    """The files that the notebook carries, as a zip in base64, 76 characters a line."""
    made = io.BytesIO()
    paths = [path for each in CARRIED for path in sorted(ROOT.glob(each)) if path.is_file()]
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in paths:
            name = zipfile.ZipInfo(path.relative_to(ROOT).as_posix())  # dated 1980: same bytes
            packed.writestr(name, path.read_bytes(), zipfile.ZIP_DEFLATED)
    return base64.encodebytes(made.getvalue()).decode()


def said(text):
    """Markdown as a cell, if there is any."""
    for page, here in SAID.items():
        text = re.sub(page, here, text)
    return [new_markdown_cell(text.strip())] if text.strip() else []


def region(source):
    """A region. Those of contact.py run; others are shown, since their names are their own."""
    file, name = source.split("#")
    code = textwrap.dedent(read_all()[name].code).strip()
    if file == "contact.py":
        return [new_code_cell(f"# contact.py, region {name}\n{code}")]
    return [new_markdown_cell(f"{file}, region {name}:\n\n```python\n{code}\n```")]


def exercise(name):
    """The exercise's file as a cell that writes it, and one that runs it."""
    (path,) = (ROOT / "exercises").glob(f"{name}_*.py")
    file, source = path.relative_to(ROOT).as_posix(), path.read_text("utf-8").strip()
    source = source.split("# ///\n")[-1]  # what the file needs, the first cell installed
    source = re.sub(r"^(    python .*\n)+", "    the next cell\n", source, flags=re.MULTILINE)
    hint = f'exercise("{file}", "--hint", "1")'
    return [
        new_markdown_cell("Edit the next cell and run it; the one after it tries it."),
        new_code_cell(f"%%writefile contact_chapter/{file}\n{source}"),
        new_code_cell(f'exercise("{file}")\n# a question that helps: {hint}'),
    ]


def picture(name):
    """A picture of a report."""
    (path,) = ROOT.glob(f"curriculum/*/results/*{name}.svg")
    file = path.relative_to(ROOT).as_posix()
    return [new_code_cell(f'SVG(filename=os.path.join(COURSE, "{file}"))')]


PLACES = {"region": region, "exercise": exercise, "bench": picture, "stress": picture}


def cells_of(text):
    """The chapter's cells, in order. An id comes from the content and the place among equals."""
    own = {name: source.strip() for name, source in zip(OWN[1::2], OWN[2::2])}
    cells, prose, same = [], "", Counter()
    carry = f'FOLDER = """\n{folder()}"""\n{own.pop("start")}'
    for kind, name, _, written, _ in read(text):
        if kind == "heading" and name == REST:
            break
        made = PLACES[kind](name) if kind in PLACES else []
        if kind in ("exercise", "figure") and (run := own.pop(name.partition("?")[0], "")):
            made.append(new_code_cell(run))
        if made or re.match("#{1,3} ", written):
            cells, prose = cells + said(prose), ""
            if len(cells) == 1:
                cells += [*said(INTRODUCTION), new_code_cell(carry, metadata=FOLDED)]
        cells += made
        if kind in ("text", "heading", "code"):
            prose += written
    for cell in [*cells, *said(prose)]:
        about = f"{cell.cell_type} {same[cell.source]}\n{cell.source}"
        cell.id = hashlib.sha256(about.encode()).hexdigest()[:16]
        same[cell.source] += 1
        yield cell


def build():
    """The notebook as text. Raises ValueError where the chapter cannot be shown as it is."""
    text = fill((ROOT / CHAPTER).read_text("utf-8"))
    made = new_notebook(cells=list(cells_of(text)), metadata=METADATA)
    nbformat.validate(made)
    return nbformat.writes(made) + "\n"


def main():
    """Build and write. Returns the exit status: 0 written, 1 the notebook can't be built."""
    parser = Parser(prog="python -m curriculum.notebook", description=__doc__.split("\n")[0])
    parser.add_argument("--out", default="outputs/contact.ipynb", metavar="FILE")
    out = parser.parse_args().out
    try:
        text = build()
        write_whole(out, text)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{out}: {len(text.encode()) / 1000:.0f} kB")
    start = command("-m", "jupyterlab", out, bring=("--extra", "notebook"))
    print(f"open it: {start}\nor upload it to colab.research.google.com")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
