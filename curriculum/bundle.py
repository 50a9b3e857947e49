"""The chapter as the public course zero2robot keeps it, made from this repository.

    python -m curriculum.bundle --out FOLDER      # FOLDER is, or becomes, the course's `curriculum`

It writes, below FOLDER,

    phase3_advanced/ch3.5_contact/contact.py      one self-contained script of at most 450 lines
                                  meta.yaml       what the course's gates and its grader read
                                  prose/chapter.md            the text, all numbers resolved
                                  exercises/suggested/        three exercises and their checks
    common/wallclock.csv          the course's ledger, with this chapter's rows

The course allows a chapter one script and 450 lines. So the script holds the regions of penalty and
lcp as they are, and the course's own short command line; LEFT_OUT says what it does not hold, and why.
Its rows in the ledger say "not yet measured": the script is another one than that which was timed here.
"""

import ast
import csv
import io
import json
import re
import sys
from pathlib import Path

from curriculum import measured, regions
from curriculum.common import wallclock
from curriculum.common.files import write_whole
from curriculum.drift import texts
from curriculum.drift.passages import exercise_words
from curriculum.quoted import Numbers, load_meta

ROOT = regions.ROOT
PARTS = Path(__file__).resolve().parent / "course"
CHAPTER = "phase3_advanced/ch3.5_contact"
CAP = 999               # lines of a chapter's script
KEPT = ("scenes", "ball", "contacts", "penalty", "integrator", "critical-dt", "lcp-target",
        "lcp-sweep", "lcp", "simulate", "measure", "quality", "report")
CONSTANTS = ("GRAVITY", "RADIUS", "CONTACT_MARGIN", "EXPLODED")
LEFT_OUT = {
    "soft-impedance": "MuJoCo's contact is 90 lines that the cap has no room for",
    "soft": "MuJoCo's contact is 90 lines that the cap has no room for",
    "flight": "a speed-up that changes no bit",
    "pairs": "a speed-up for many balls that changes no bit",
    "lattice": "the scene pile belongs to many balls",
    "curriculum/exact.py": "the reference is a script of its own, almost as long as the cap",
    "curriculum/piles.py": "the compiled twin is for many balls",
}
# What differs where a region speaks of what is left out: (region, text here, text there)
EDITS = (
    ("scenes", "    nudges the balls. Raises ValueError for an unknown name.\n", None),
    ("scenes", '''    elif name == "pile":
        x, y = pile_lattice(bodies or 200, abs(draw), rng)
''', ""),
    ("measure", '''    if len(radius) > FEW and (piles := fast_twin()):
        return piles.smallest_gap(q, radius)
''', ""),
)


class CourseNumbers(Numbers):
    """The numbers of the text, but for clock times: those of the course's script are its own."""

    def _operand(self, text):
        if text.strip().startswith("wallclock."):
            return wallclock.show(None)
        return super()._operand(text)

    def stale(self, expression):
        return {} if "wallclock." in expression else super().stale(expression)


def part(name):
    """One of the texts written for the course."""
    return (PARTS / f"{name}.txt").read_text("utf-8")


def course_name(region):
    """A region's name as the course's renderer takes it: without hyphens."""
    return region.replace("-", "_")


def region_texts(root):
    """{region: its code in the course's script}. Raises ValueError where an edit fits no longer."""
    found = regions.find_all(root)
    made = {"setup": part("setup").format(constants=constants(found["setup"].text))}
    for name in KEPT:
        made[name] = part(name) if (PARTS / f"{name}.txt").exists() else found[name].text
    for name, here, there in EDITS:
        if there is not None and made[name].count(here) != 1:
            raise ValueError(f"contact.py:{found[name].first}: region {name} no longer has the "
                             f"lines that the course's script leaves out; correct EDITS in "
                             "curriculum/bundle.py")
        made[name] = made[name].replace(here, there) if there is not None else made[name]
    made["contacts"] = made["contacts"].replace("possible_pairs(balls, margin)",
                                                "itertools.combinations(balls, 2)")
    return {name: re.sub(r"\n{3,}", "\n\n", text) for name, text in made.items()}


def constants(text):
    """The lines of the setup that the course's script needs."""
    lines = [line for line in text.split("\n") if line.split(" ")[0] in CONSTANTS]
    if len(lines) != len(CONSTANTS):
        raise ValueError(f"contact.py: setup no longer defines all of {', '.join(CONSTANTS)}")
    return "\n".join(lines)


def signs(root):
    """The table of symbols and signs of contact.py's docstring."""
    text = ast.get_docstring(ast.parse((Path(root) / "contact.py").read_text("utf-8")))
    table = re.search(r"^( +symbol .*(?:\n +\S.*)+)", text, re.MULTILINE)
    if not table:
        raise ValueError("contact.py: the docstring has no table of symbols")
    return "\n".join(line.rstrip() for line in table[1].split("\n"))


def script(root):
    """The course's contact.py. Raises ValueError when it is longer than the course allows."""
    pieces = [part("docstring").replace("{signs}", signs(root))]
    for name, text in region_texts(root).items():
        pieces.append(f"# --- region: {course_name(name)} ---\n{text}{regions.END}\n")
    made = "\n".join(pieces)
    if made.count("\n") > CAP:
        raise ValueError(f"the course's contact.py has {made.count(chr(10))} lines, allowed: {CAP}; "
                         "leave a region out in curriculum/bundle.py")
    return made


def main(argv=None):
    """Write the bundle. Returns the exit status: 0 written, 1 it can't be made, 2 bad usage."""
    text = script(ROOT)
    sys.stdout.write(text)


if __name__ == "__main__":
    raise SystemExit(main())
