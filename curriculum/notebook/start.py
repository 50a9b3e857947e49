# ruff: noqa: E401, E402, F401, F821, I001
# fmt: off
#@title Run me first: the course's folder is unpacked beside the notebook, and contact.py is read
import base64, io, os, pathlib, re, subprocess, sys, zipfile

COURSE = os.path.abspath("contact_chapter")
zipfile.ZipFile(io.BytesIO(base64.b64decode(FOLDER))).extractall(COURSE)
sys.path.insert(0, COURSE)
sys.modules["contact"] = sys.modules["__main__"]    # whatever you change below is used everywhere
__file__ = os.path.join(COURSE, "contact.py")
LESSON = pathlib.Path(__file__).read_text("utf-8")
exec(LESSON.replace('__name__ == "__main__"', "False"))
from IPython.core.magic import register_cell_magic
from IPython.display import SVG


def show_run(*flags):
    """Run contact.py with these flags, print its report and show its curves."""
    main([*flags, "--no-rerun", "--plot", "--out", os.path.join(COURSE, "outputs")])
    return SVG(filename=os.path.join(COURSE, "outputs", "contact.svg"))


def write_lesson():
    """Write contact.py with each region as its cell was last run, for other processes."""
    text = LESSON
    for cell in In:
        if found := re.match(r"# contact\.py, region (.+)\n", cell):
            code = cell[found.end():].rstrip().replace("\\", r"\\") + "\n\n\n"
            start = rf"(?ms)(?<=^# --- region: {found[1]} ---\n)"
            text = re.sub(rf"{start}.*?(?=^# --- region: |\Z)", code, text)
    pathlib.Path(__file__).write_text(text, "utf-8")


@register_cell_magic
def exercise(words, text):
    """Try what the cell says, and print what came of it."""
    write_lesson()
    file, *flags = words.split()
    pathlib.Path(COURSE, file).write_text(f"\n{text}", "utf-8")    # numbered as in the cell
    here = {"cwd": COURSE, "env": os.environ | {"IN_A_NOTEBOOK": "1"}, "stdin": subprocess.DEVNULL}
    done = subprocess.run([sys.executable, file, *flags], capture_output=True, text=True, **here)
    print(done.stdout + done.stderr)
