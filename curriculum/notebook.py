"""The chapter as a notebook that runs from top to bottom, wherever it is.

    python -m curriculum.notebook [--out FILE]          # outputs/contact.ipynb

Prose with its numbers; the regions of contact.py and curriculum/exact.py as code cells; pictures where
the chapter has its figures (curriculum/notebook_cells.py); the bets with their answers folded away.
The cells of exact.py begin with %%exact and run in a module of their own, as in the course's folder.
It needs numpy and matplotlib, which its first code cell installs where they are missing. Regions
that the chapter shows at its end or not at all come as folded cells before their first use; those of
the command line are left out. The first picture is there before anything has run. Same inputs and
versions, same bytes; the id of a cell comes from its content.
"""

import ast
import base64
import hashlib
import io
import re
import sys
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

from curriculum import regions
from curriculum.common.arguments import Parser
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable
from curriculum.drift.texts import CHAPTER, FENCE, INCLUDE
from curriculum.quoted import Numbers, load_meta

CELLS = "curriculum/notebook_cells.py"
SLOT = re.compile(r"<!-- (figure|exercise): ([\w-]+) -->")
LIVE = re.compile(r"\[([^\]]*)\]\((?:try|drag):[^)]*\)")
REST = "## The rest of the file"  # of the chapter; a notebook has it in folded cells
SCRIPTS = ("contact.py", "curriculum/exact.py")
SIGNS, SIGNS_HERE = "the table at the top of contact.py", "Two bodies, one contact"
HIDDEN = {"jupyter": {"source_hidden": True}, "cellView": "form"}
AFTER = {"first": "3.5: Contact", "mujoco": "Way three: soft"}  # a cell behind a section, no figure

INSTALL = """\
#@title Install numpy and matplotlib where they are missing; the colours of the models
import importlib.util, subprocess, sys
tested = {"numpy": "2.4.6", "matplotlib": "3.11.2"}
missing = [f"{name}=={tested[name]}" for name in tested if importlib.util.find_spec(name) is None]
if missing:
    subprocess.check_call([sys.executable, "-m", "pip", "install", "--quiet", *missing])
COLORS = {colors}"""

# exact.py is a file of its own and may use contact.py's names for its own things, so its cells run there
START = """\
#@title exact.py is a file of its own: a cell that begins with %%exact is lines of it
import sys, types
from IPython.core.magic import register_cell_magic

exact = sys.modules["exact"] = types.ModuleType("exact")

@register_cell_magic("exact")
def lines_of_exact(line, cell):
    exec(compile(cell, "exact.py", "exec"), vars(exact))"""

EXACT = """\
#@title run_model looks for exact.py in the folder of the course; here it finds it in this notebook
sys.modules["curriculum"] = types.ModuleType("curriculum")
sys.modules["curriculum"].exact = exact"""

EX2 = """\
def my_penalty_normal_force(depth, v_n, stiffness, damping):
    return ...          # yours

def my_project_impulse(lam, dlam):
    return ...          # yours

for mine, reference, tries in (
        (my_penalty_normal_force, penalty_normal_force,
         ((0.01, 0.0, 1e4, 80.0), (0.01, -0.5, 3e3, 80.0), (0.001, 2.0, 1e4, 80.0))),
        (my_project_impulse, project_impulse, ((0.0, 0.3), (0.2, -0.1), (0.2, -0.5)))):
    for inputs in tries:
        got, expected = mine(*inputs), reference(*inputs)
        print(f"{mine.__name__}{inputs}:", "still a blank" if got is ... else "right"
              if abs(got - expected) <= 1e-12 else f"got {got!r}, expected {expected!r}")"""


class Cell(NamedTuple):
    """A cell: kind markdown or code, its source, whether it is folded, what it defines and uses."""

    kind: str
    source: str
    folded: bool = False
    defines: frozenset = frozenset()
    uses: frozenset = frozenset()


MAGIC = "%%exact"
OPEN = Cell("code", START, True, frozenset({MAGIC}))
JOIN = Cell("code", EXACT, True, frozenset({"exact"}), frozenset({f"{MAGIC} simulate_exact"}))


def code_cell(source, folded=False):
    """A code Cell that knows its names."""
    return Cell("code", source, folded, *names_of(source))


def region_cell(script, names, source, folded=False):
    """The code Cell of regions of a script; those of exact.py are lines of that file."""
    title = f"#@title {script}: {', '.join(names)}" if folded else f"# {script}, region {names[0]}"
    cell = code_cell(f"{title}\n{source}", folded)
    if script == SCRIPTS[0]:
        return cell
    defines, uses = (
        frozenset(f"{MAGIC} {name}" for name in found) for found in (cell.defines, cell.uses)
    )
    return Cell("code", f"{MAGIC}\n{cell.source}", folded, defines, uses | {MAGIC})


def names_of(source):
    """(names that the top level of the source defines, all names that it uses)."""
    tree, defined = ast.parse(source), set()
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            defined.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            defined |= {name.asname or name.name for name in node.names}
        elif isinstance(node, ast.Assign):
            defined |= {
                name.id
                for target in node.targets
                for name in ast.walk(target)
                if isinstance(name, ast.Name)
            }
    used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return frozenset(defined), frozenset(used)


def own_cells(root):
    """The cells of notebook_cells.py by name."""
    parts = re.split(r"^# %% ([\w-]+)\n", (root / CELLS).read_text("utf-8"), flags=re.MULTILINE)
    return {name: code_cell(source.strip()) for name, source in zip(parts[1::2], parts[2::2])}


def command_line(root):
    """The regions of contact.py that neither chapter nor notebook shows: `not_shown` of meta.yaml."""
    hidden = load_meta(root).get("not_shown") or []
    return [
        name
        for name in regions.find(root / "contact.py")
        if any(fnmatchcase(name, pattern) for pattern in hidden)
    ]


class Builder:
    """Takes the chapter from top to bottom and collects the cells."""

    def __init__(self, root):
        self.root, self.out = root, []
        self.regions = {
            script: {
                name: region_cell(script, [name], region.text.strip())
                for name, region in regions.find(root / script).items()
            }
            for script in SCRIPTS
        }
        for name in command_line(root):
            del self.regions["contact.py"][name]
        self.late, self.done, self.waiting = set(), set(), []
        self.own = own_cells(root)

    def all_regions(self):
        """Every region's cell, of both scripts, and the one that joins them."""
        return [cell for found in self.regions.values() for cell in found.values()] + [JOIN]

    def add(self, cell):
        """Add a cell, and after it the pictures that waited for what it defines."""
        if MAGIC in cell.uses - self.done:
            self.add(OPEN)
        self.out.append(cell)
        self.done |= cell.defines
        for each in list(self.waiting):
            if each in self.waiting and self.can_come(each):
                self.waiting.remove(each)
                self.bring(each)

    def lacks(self, cell):
        """The names of regions that a cell needs, also through others, and that are not there yet."""
        homes = {name: each for each in reversed(self.all_regions()) for name in each.defines}
        needed, todo = set(), list(cell.uses)
        while todo:
            name = todo.pop()
            if name in homes and name not in needed:
                needed.add(name)
                todo.extend(homes[name].uses)
        return needed - self.done

    def can_come(self, cell):
        """Whether all that a cell still lacks are regions that the chapter shows late."""
        late = [
            found[name].defines
            for found in self.regions.values()
            for name in found
            if name in self.late
        ]
        return self.lacks(cell) <= set().union(*late)

    def bring(self, cell):
        """Add a cell, and before it, folded, the late regions that it needs."""
        for script, found in self.regions.items():
            lacking = self.lacks(cell)
            names = [name for name in found if name in self.late and found[name].defines & lacking]
            self.late -= set(names)
            if names:
                sources = (found[name].source.removeprefix(f"{MAGIC}\n") for name in names)
                self.add(region_cell(script, names, "\n\n\n".join(sources), folded=True))
        self.add(cell)

    def include(self, script, name):
        """The cell of a region; after the last of exact.py the one that lets run_model find it."""
        self.bring(self.regions[script][name])
        exact = self.regions[SCRIPTS[1]]
        shown = [cell for each, cell in exact.items() if each not in self.late]
        if script == SCRIPTS[1] and all(cell.defines <= self.done for cell in shown):
            self.bring(JOIN)

    def figure(self, name):
        """The picture of a slot, now or as soon as all that it uses is there. The page has more."""
        cell = self.own.pop(name, None)
        if cell and self.can_come(cell):
            self.bring(cell)
        elif cell:
            self.waiting.append(cell)

    def prose(self, text):
        """Markdown, a cell a section; comments and live links are for the page."""
        text = LIVE.sub(r"\1", re.sub(r"<!--.*?-->\n*", "", text, flags=re.DOTALL))
        for piece in re.split(r"^(?=#{1,3} )", text, flags=re.MULTILINE):
            if piece.strip():
                self.add(Cell("markdown", piece.strip()))

    def chapter(self, text, numbers):
        """All cells of the chapter."""
        shown = text.partition(REST)[0]
        visible = {match["name"] for match in INCLUDE.finditer(shown)}
        self.late = {name for found in self.regions.values() for name in found} - visible
        if REST not in text:
            raise ValueError(f"{CHAPTER}: no section {REST!r}")
        marks = re.compile(f"{FENCE.pattern}|{SLOT.pattern}|^(?=#{{1,3}} )", FENCE.flags)
        done, heading = 0, ""
        for found in marks.finditer(shown):
            include = INCLUDE.search(found[0])
            if not (include or found[3] or found[0] == ""):
                continue
            self.prose(shown[done : found.start()])
            done = found.end()
            if include:
                self.include(include["file"], include["name"])
            elif found[2] == "figure":
                self.figure(found[3])
            elif found[2] == "exercise":
                for cell in exercise_cells(self.root, found[3], numbers):
                    self.add(cell)
            else:
                for name, title in AFTER.items():
                    if heading.endswith(title):
                        self.figure(name)
                heading = shown[done:].split("\n", 1)[0]
        self.prose(shown[done:])
        return self.out


def exercise_cells(root, name, numbers):
    """The cells of an exercise: question and choices, then the answer folded away."""
    path = next((root / "exercises").glob(f"{name}_*.py"), None)
    facts = (load_meta(root).get("exercises") or {}).get(name)
    if path is None or facts is None:
        return []
    words, title, text = exercise_words(path)
    if "CHOICES" not in words:
        told = text.split("\n\n")[0].replace(SIGNS, f"the section {SIGNS_HERE!r}")
        return [Cell("markdown", f"**{title}** {told}"), code_cell(EX2)]
    reasons = "\n\n".join(
        f"**{letter}.** {' '.join(numbers.render(reason).split())}"
        for letter, reason in facts["reveal"].items()
    )
    choices = "\n".join(f"- **{letter}.** {choice}" for letter, choice in words["CHOICES"].items())
    return [
        Cell(
            "markdown",
            f"**{title}** {words['QUESTION']}\n\n{choices}\n\n{words['WHY_PROMPT']} "
            "Write your letter and your sentence into this cell before you unfold the next.",
        ),
        Cell(
            "markdown",
            "<details><summary>What happens: unfold when you have chosen</summary>"
            f"\n\nThe answer is {facts['answer']}.\n\n{reasons}\n\n</details>",
        ),
    ]


def exercise_words(path):
    """(constants in capitals, title, the rest of the docstring) of an exercise's script."""
    tree = ast.parse(path.read_text("utf-8"))
    words = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and node.targets[0].id.isupper():
            try:
                words[node.targets[0].id] = ast.literal_eval(node.value)
            except ValueError:
                continue  # reckoned, so no words
    title, _, text = ast.get_docstring(tree).partition("\n")
    return words, title, text.strip()


def cells(root, numbers):
    """Every cell, in order."""
    text = (root / CHAPTER).read_text("utf-8")
    numbers.run_all(text + str(load_meta(root).get("exercises")))
    builder = Builder(root)
    out = builder.chapter(numbers.render(text), numbers)
    if builder.waiting:
        raise ValueError(
            f"{CELLS}: a cell uses what no cell before it defines: "
            f"{sorted(builder.lacks(builder.waiting[0]))}"
        )
    colors = repr(model_colors(root))
    return [*out[:1], code_cell(INSTALL.replace("{colors}", colors), folded=True), *out[1:]]


def model_colors(root):
    """COLORS of contact.py, whose region is left out."""
    for node in ast.parse((root / "contact.py").read_text("utf-8")).body:
        if isinstance(node, ast.Assign) and node.targets[0].id == "COLORS":
            return ast.literal_eval(node.value)
    raise ValueError("contact.py: no COLORS")


def first_picture(source):
    """What the first picture's cell shows when it runs, as the output of a code cell."""
    import matplotlib
    from matplotlib import pyplot
    from nbformat import v4

    matplotlib.use("Agg")
    pyplot.close("all")
    file = io.BytesIO()
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # whatever else this process has drawn
        exec(compile(source, CELLS, "exec"), {})
        pyplot.savefig(file, format="png", metadata={"Software": None})
        pyplot.close("all")
    data = {
        "image/png": base64.b64encode(file.getvalue()).decode() + "\n",
        "text/plain": "<Figure: the drop, without a table>",
    }
    return v4.new_output("display_data", data)


def build(root=regions.ROOT, numbers=None):
    """The notebook as text. Raises ValueError where the chapter can't be shown as it is.

    `numbers` are the generated numbers that the text quotes; without them they are made.
    """
    from nbformat import v4, validate, writes

    made, ids, first = [], set(), own_cells(Path(root))["first"].source
    for cell in cells(Path(root), numbers or Numbers(root)):
        base = name = hashlib.sha256(f"{cell.kind}\n{cell.source}".encode()).hexdigest()[:16]
        while name in ids:
            name = f"{base}-{len(ids)}"
        ids.add(name)
        new = v4.new_markdown_cell if cell.kind == "markdown" else v4.new_code_cell
        made.append(new(cell.source, id=name, metadata=HIDDEN if cell.folded else {}))
        if cell.source == first:
            made[-1].outputs = [first_picture(first)]
    notebook = v4.new_notebook(
        cells=made,
        metadata={
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
    )
    validate(notebook)
    return writes(notebook) + "\n"


@stoppable
def main(argv=None):
    """Build and write. Returns the exit status: 0 written, 1 the notebook can't be built."""
    parser = Parser(prog="python -m curriculum.notebook", description="The chapter as a notebook.")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("outputs/contact.ipynb"),
        metavar="FILE",
        help="the file to write (outputs/contact.ipynb)",
    )
    args = parser.parse_args(argv)
    try:
        text = build()
        write_whole(args.out, text)
    except ImportError as error:
        print(f"the notebook needs {error.name}: pip install -e '.[test]'", file=sys.stderr)
        return 1
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    print(f"{args.out}: {len(text.encode()) / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
