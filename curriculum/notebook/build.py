"""The chapter as a notebook that runs from top to bottom, wherever it is.

Prose with its numbers; the regions of contact.py as cells, so that a change is felt in every cell
below; knobs and pictures (curriculum/notebook/cells.py) where the chapter has its figures; the
exercises as files to write and run. Its first cell carries the course's folder with it and needs
numpy and matplotlib, which it installs where they are missing. Same inputs, same bytes.
"""

import base64
import hashlib
import io
import re
import textwrap
import zipfile
from pathlib import Path

import contact
from curriculum.regions import ROOT, read_all
from curriculum.text.references import INCLUDE, Numbers

CHAPTER = ROOT / "curriculum/prose/chapter.md"
CELLS = ROOT / "curriculum/notebook/cells.py"
CARRIED = (
    "contact.py",
    "checks.py",
    "exercises/*.py",
    "exercises/kit/*",
    "curriculum/__init__.py",
    "curriculum/run/__init__.py",
    "curriculum/run/curves.py",
    "curriculum/exact.py",
    "curriculum/commands.py",
    "curriculum/files.py",
    "curriculum/implicit.py",
)
MARK = re.compile(
    rf"^```\w*\n{INCLUDE.pattern}\n```$|^(?=#{{1,3}} )"
    r"|^<!-- (?P<kind>figure|exercise|bench|stress): (?P<slot>[\w-]+) -->$",
    re.MULTILINE,
)
COMMENT = re.compile(r"<!--.*?-->\n*", re.DOTALL)
STORED = {  # a picture of a report, by its slot in the chapter
    "bounce": "curriculum/bench/results/error-bounce.svg",
    "solvers": "curriculum/bench/results/solvers.svg",
    "penalty-map": "curriculum/stress/results/penalty-map.svg",
}
SAID = (  # what only the page can do, and what to do here
    (r"Take it, lift it,\s+throw it\.", "Hold the mouse on it, and it stops."),
    (r"\bDrag the (\w+)", r"Run the cell above, turn its \1"),
)
LIVE = re.compile(r"\[([^\]]*)\]\((?:try|drag):[^)]*\)")
MAIN = re.compile(r'^if __name__ == "__main__":.*', re.DOTALL | re.MULTILINE)
OPENING = "grab"  # the figure that the notebook opens on
INTRODUCTION = """\
*This is the chapter as a notebook. Its figures move, and some have knobs; on the page you can take
hold of them. Run the cells from the top. The first one puts the whole of contact.py and the
exercises into the folder `contact_chapter` beside this notebook.*"""
REST = "## The rest of the file"  # of the chapter: the notebook's first cell has it


def folder():
    """The files that the notebook carries, as a zip in base64, 76 characters a line."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as packed:
        for pattern in (*CARRIED, *STORED.values()):
            for path in sorted(filter(Path.is_file, ROOT.glob(pattern))):
                name = zipfile.ZipInfo(path.relative_to(ROOT).as_posix())  # dated 1980: same bytes
                packed.writestr(name, path.read_bytes(), zipfile.ZIP_DEFLATED)
    return base64.encodebytes(made.getvalue()).decode()


def own_cells():
    """{name: source} of cells.py."""
    parts = re.split(r"^# %% ([\w-]+)\n", CELLS.read_text("utf-8"), flags=re.MULTILINE)
    return {name: source.strip() for name, source in zip(parts[1::2], parts[2::2])}


class Book:
    """The cells, as they are added from the top of the chapter to its end."""

    def __init__(self):
        from nbformat import v4

        self.v4, self.cells, self.own = v4, [], own_cells()

    def add(self, kind, source, folded=False):
        """A markdown or code cell. Its id comes from its content and its place among its equals."""
        new = self.v4.new_markdown_cell if kind == "markdown" else self.v4.new_code_cell
        same = sum(cell.source == source for cell in self.cells)
        digest = hashlib.sha256(f"{kind} {same}\n{source}".encode()).hexdigest()[:16]
        look = {"jupyter": {"source_hidden": True}, "cellView": "form"} if folded else {}
        self.cells.append(new(source, id=digest, metadata=look))

    def prose(self, text):
        """Markdown; comments and live links are for the page."""
        text = LIVE.sub(r"\1", COMMENT.sub("", text)).strip()
        for page, here in SAID:
            text = re.sub(page, here, text)
        if text:
            self.add("markdown", text)

    def include(self, file, name):
        """A region. Those of contact.py run; others are shown, since their names are their own."""
        regions = read_all()
        if name not in regions:
            raise ValueError(f"{CHAPTER.name}: no region {file}#{name}; known: {[*regions]}")
        code = textwrap.dedent(MAIN.sub("", regions[name].code)).strip()
        if file == "contact.py":
            self.add("code", f"# contact.py, region {name}\n{code}")
        else:
            self.add("markdown", f"{file}, region {name}:\n\n```python\n{code}\n```")

    def figure(self, name):
        """The cell of this name; the page has figures that the notebook has not."""
        if name in self.own and self.own[name] not in {cell.source for cell in self.cells}:
            source = self.own[name]
            self.add("code", source, folded=source.startswith("#@title"))
        if name == OPENING:
            self.cells[-1].outputs = [self.drawn(source)]

    def drawn(self, source):
        """What a cell shows that ends in a moving picture, so that it moves before it has run."""
        names = dict(vars(contact))
        exec(compile(f"{self.own['tools']}\n{source}", str(CELLS), "exec"), names)
        data = {"image/svg+xml": names["moving"].data, "text/plain": "<a ball falls>"}
        return self.v4.new_output("display_data", data)

    def exercise(self, name):
        """The exercise's file as a cell that writes it, and one that runs it."""
        for path in sorted((ROOT / "exercises").glob(f"{name}_*.py")):
            file = path.relative_to(ROOT).as_posix()
            source = path.read_text("utf-8").strip()
            self.add("code", f"%%writefile contact_chapter/{file}\n{source}")
            hint = f'course("{file}", "--hint", "1")'
            self.add("code", f'course("{file}")\n# a question that helps: {hint}')

    def bench(self, name):
        """A picture of the benchmark."""
        self.add("code", f'SVG(filename=os.path.join(COURSE, "{STORED[name]}"))')

    stress = bench

    def start(self):
        """What the notebook is, the cell that carries the folder, and what the pictures share."""
        self.prose(INTRODUCTION)
        self.add("code", f'FOLDER = """\n{folder()}"""\n{self.own["start"]}', folded=True)
        self.add("code", self.own["tools"], folded=True)

    def chapter(self, text):
        """All cells, in order."""
        text, done = text.partition(f"\n{REST}")[0], 0
        for found in MARK.finditer(text):
            self.prose(text[done : found.start()])
            if len(self.cells) == 1:
                self.start()
            done = found.end()
            if found["name"]:
                self.include(found["file"], found["name"])
            elif found["kind"]:
                getattr(self, found["kind"])(found["slot"])
        self.prose(text[done:])


def build():
    """The notebook as text. Raises ValueError where the chapter cannot be shown as it is."""
    import nbformat

    text, numbers = CHAPTER.read_text("utf-8"), Numbers()
    book = Book()
    book.chapter(numbers.fill(text))
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    made = book.v4.new_notebook(cells=book.cells, metadata=metadata)
    nbformat.validate(made)
    return nbformat.writes(made) + "\n"
