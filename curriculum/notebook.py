"""The chapter as a notebook that runs from top to bottom, wherever it is.

    python -m curriculum.notebook [--out FILE]          # outputs/contact.ipynb

Prose with its numbers, the regions as code cells in their order, the bets with their answers folded
away. It needs numpy and rerun-sdk, which its first cell installs where they are missing, and carries
curriculum/common itself: its second cell writes those files to a folder of its own and imports from
there, never from the working directory. Same inputs, same bytes; the id of a cell comes from its content.
"""

import ast
import hashlib
import re
import shlex
import sys
from pathlib import Path

from curriculum import regions
from curriculum.check_prose_code_drift import CHAPTER, INCLUDE
from curriculum.common.arguments import Parser
from curriculum.common.files import write_whole
from curriculum.quoted import Numbers, load_meta

SLOT = re.compile(r"<!-- exercise: (\w+) -->")
COMMAND = re.compile(r"python contact\.py(.*)")
BLOCK = re.compile(r"^```\n(.*)\n```$", re.MULTILINE)
ENTRY = 'if __name__ == "__main__":\n    sys.exit(main())\n'
HIDDEN = {"jupyter": {"source_hidden": True}, "cellView": "form"}

INSTALL = '''\
#@title Install what is missing
import importlib.util, subprocess, sys
missing = [package for module, package in (("numpy", "numpy"), ("rerun", "rerun-sdk"))
           if importlib.util.find_spec(module) is None]
if missing:
    subprocess.check_call([sys.executable, "-m", "pip", "install", "--quiet", *missing])'''

SHARED = '''\
#@title What the chapters of the course share: curriculum/common, written to a folder and imported
import pathlib, sys, tempfile
FILES = {{
{files}
}}
folder = pathlib.Path(tempfile.mkdtemp(prefix="contact-"))
for name, text in FILES.items():
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
for name in [name for name in sys.modules if name.split(".")[0] == "curriculum"]:
    del sys.modules[name]
sys.path.insert(0, str(folder))'''

EX2 = '''\
def my_penalty_normal_force(depth, v_n, stiffness, damping):
    return ...          # yours

def my_project_impulse(lam, dlam):
    return ...          # yours

for mine, reference, tries in (
        (my_penalty_normal_force, penalty_normal_force,
         ((0.01, 0.0, 1e4, 80.0), (0.01, -0.5, 1e4, 80.0), (0.001, 2.0, 1e4, 80.0))),
        (my_project_impulse, project_impulse, ((0.0, 0.3), (0.2, -0.1), (0.2, -0.5)))):
    for inputs in tries:
        got, expected = mine(*inputs), reference(*inputs)
        print(f"{mine.__name__}{inputs}:", "still a blank" if got is ... else "right"
              if abs(got - expected) <= 1e-12 else f"got {got!r}, expected {expected!r}")'''

LAST = "## Run it\n\nThe default run, as `python contact.py` makes it: the table, `metrics.json`, and a recording."
TABLE = '''\
import json
from IPython.display import Markdown
with open("outputs/ch3.5-contact/metrics.json", encoding="utf-8") as file:
    quality = json.load(file)["quality"]
rows = ["| | " + " | ".join(quality) + " |", "| --- " * (len(quality) + 1) + "|"]
rows += [f"| {title} | " + " | ".join("-" if row[key] is None else f"{row[key]:.4f}"
                                      for row in quality.values()) + " |"
         for title, key in COLUMNS.items()]
Markdown("\\n".join(rows))'''


def literal(text):
    """The text as a Python literal, readable where it can be."""
    plain = "'''" not in text and "\\" not in text and not text.endswith("'")
    return f"'''\\\n{text}'''" if plain and text else repr(text)


def shared_files(root):
    """The cell that makes curriculum.common importable: its sources, and the ledger it reads."""
    paths = [root / "curriculum/__init__.py", *sorted((root / "curriculum/common").glob("*.py")),
             root / "wallclock.csv"]
    return SHARED.format(files=",\n".join(
        f'"{path.relative_to(root).as_posix()}": {literal(path.read_text("utf-8"))}'
        for path in paths))


def region_cells(root):
    """The source of a code cell by region; the script's last lines start main, here a cell does."""
    path = root / "contact.py"
    found = {name: f"# contact.py, region {name}\n{region.text.strip()}"
             for name, region in regions.find(path).items()}
    last = list(found)[-1]
    if not found[last].endswith(ENTRY.strip()):
        raise ValueError(f"contact.py: region {last} does not end in {ENTRY!r}")
    found[last] = found[last][:-len(ENTRY)].rstrip()
    return found


def exercise_cells(root, name, numbers):
    """(kind, source) of an exercise: question and choices, then the answer folded away."""
    path = next((root / "exercises").glob(f"{name}_*.py"))
    tree = ast.parse(path.read_text("utf-8"))
    words = {node.targets[0].id: ast.literal_eval(node.value) for node in tree.body
             if isinstance(node, ast.Assign) and node.targets[0].id.isupper()}
    title, _, text = ast.get_docstring(tree).partition("\n")
    if "CHOICES" not in words:
        return [("markdown", f"**{title}** {text.strip().split(chr(10) * 2)[0]}"), ("code", EX2)]
    facts = load_meta(root)["exercises"][name]
    reasons = "\n\n".join(f"**{letter}.** {' '.join(numbers.render(reason).split())}"
                          for letter, reason in facts["reveal"].items())
    choices = "\n".join(f"- **{letter}.** {choice}" for letter, choice in words["CHOICES"].items())
    return [("markdown", f"**{title}** {words['QUESTION']}\n\n{choices}\n\n{words['WHY_PROMPT']} Write "
             "your letter and your sentence into this cell before you unfold the next."),
            ("markdown", f"<details><summary>What happens: unfold when you have chosen</summary>\n\n"
             f"The answer is {facts['answer']}.\n\n{reasons}\n\n</details>")]


def cells(root):
    """(kind, source) of every cell, in order."""
    numbers, code = Numbers(root), region_cells(root)
    text = (root / CHAPTER).read_text("utf-8")
    numbers.run_all(text + str(load_meta(root).get("exercises")))
    text, runs, out = numbers.render(text), False, [("code", INSTALL), ("code", shared_files(root))]

    def prose(piece):
        """Markdown, a cell a section; comments are for the page."""
        plain = re.sub(r"<!--.*?-->\n*", "", piece, flags=re.DOTALL).strip()
        out.extend(("markdown", each.strip()) for each in re.split(r"^(?=#{1,3} )", plain, flags=re.M)
                   if each.strip())

    done = 0
    for found in re.finditer(f"{BLOCK.pattern}|{SLOT.pattern}", text, re.MULTILINE):
        region, command = (pattern.fullmatch(found[1] or "") for pattern in (INCLUDE, COMMAND))
        if not (region or (command and runs) or found[2]):
            continue
        prose(text[done:found.start()])
        done = found.end()
        if region:
            out.append(("code", code.pop(region["name"])))
            runs = not code                         # main is the last region's
        elif command:
            out.append(("code", f"main({shlex.split(command[1])!r})".replace("'", '"')))
        else:
            out.extend(exercise_cells(root, found[2], numbers))
    prose(text[done:])
    if code:
        raise ValueError(f"{CHAPTER}: never shows {', '.join(code)}, so the notebook can't run")
    title = next(k for k, (kind, _) in enumerate(out) if kind == "markdown")
    return [out.pop(title), *out, ("markdown", LAST), ("code", "main([])"), ("code", TABLE)]


def build(root=regions.ROOT):
    """The notebook as text. Raises ValueError where the chapter can't be shown as it is."""
    from nbformat import v4, validate, writes
    made, ids = [], set()
    for kind, source in cells(Path(root)):
        base = name = hashlib.sha256(f"{kind}\n{source}".encode()).hexdigest()[:16]
        while name in ids:
            name = f"{base}-{len(ids)}"
        ids.add(name)
        new = v4.new_markdown_cell if kind == "markdown" else v4.new_code_cell
        made.append(new(source, id=name, metadata=HIDDEN if source.startswith("#@title") else {}))
    notebook = v4.new_notebook(cells=made, metadata={
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"}})
    validate(notebook)
    return writes(notebook) + "\n"


def main(argv=None):
    """Build and write. Returns the exit status: 0 written, 1 the notebook can't be built."""
    parser = Parser(prog="python -m curriculum.notebook", description="The chapter as a notebook.")
    parser.add_argument("--out", type=Path, default=Path("outputs/contact.ipynb"), metavar="FILE",
                        help="the file to write (outputs/contact.ipynb)")
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
