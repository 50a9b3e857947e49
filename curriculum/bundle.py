"""The chapter as the public course zero2robot keeps it, made from this repository.

    python -m curriculum.bundle --out FOLDER      # FOLDER is, or becomes, the course's `curriculum`

It writes, below FOLDER,

    phase3_advanced/ch3.5_contact/contact.py      one self-contained script of at most 450 lines
                                  meta.yaml       what the course's gates and its grader read
                                  prose/chapter.md            the text, all numbers resolved
                                  exercises/suggested/        three exercises and their checks
    common/wallclock.csv          the course's ledger, with this chapter's rows

The course allows a chapter one script and 450 lines. So the script holds the regions of penalty and
lcp as they are, and the course's own short command line. LEFT_OUT says what it does not hold, and
why. Its rows in the ledger say "not yet measured": the script timed here is another one.
"""

import ast
import builtins
import contextlib
import csv
import io
import json
import re
import shlex
import symtable
import sys
import textwrap
from pathlib import Path

from curriculum import regions
from curriculum.common import wallclock
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable
from curriculum.drift import texts
from curriculum.drift.passages import exercise_words
from curriculum.quoted import Numbers, load_meta

ROOT = regions.ROOT
PARTS = Path(__file__).resolve().parent / "course"
CHAPTER = "phase3_advanced/ch3.5_contact"
CAP = 450  # lines of a chapter's script
KEPT = (
    "scenes",
    "ball",
    "contacts",
    "penalty",
    "integrator",
    "critical-dt",
    "lcp-target",
    "lcp-sweep",
    "lcp",
    "simulate",
    "measure",
    "quality",
    "quality-parts",
    "report",
)
CONSTANTS = ("GRAVITY", "RADIUS", "CONTACT_MARGIN", "EXPLODED")
LEFT_OUT = {
    "soft-impedance": "MuJoCo's contact, for which the cap leaves no room",
    "soft": "MuJoCo's contact, for which the cap leaves no room",
    "flight": "a speed-up that changes no bit",
    "pairs": "a speed-up for many balls that changes no bit",
    "lattice": "the scene pile belongs to many balls",
    "shapes": "a check of arrays for those who bring their own",
    "curriculum/exact.py": "the reference is a script of its own, almost as long as the cap",
    "curriculum/piles.py": "the compiled twin is for many balls",
    "exercises/ex4_predict_soft.py": "a bet on soft",
}
# What differs where a region speaks of what is left out: (region, text here, text there)
EDITS = (
    (
        "scenes",
        """    elif name == "pile":
        x, y = pile_lattice(bodies or 200, abs(draw), rng)
""",
        "",
    ),
    ("contacts", "possible_pairs(balls, margin)", "itertools.combinations(balls, 2)"),
    (
        "measure",
        """    if len(radius) > FEW and (piles := compiled_piles()):
        return piles.smallest_gap(q, radius)
""",
        "",
    ),
    (
        "quality",
        "    return quality | height_errors(run, scene, dt, reference)\n",
        "    return quality\n",
    ),
    (
        "quality",
        """    height_error_frac: the worst height error against the run `reference`, which is the sum of
    flight_error_frac, the worst before the first contact, and contact_error_frac, what is added
""",
        "",
    ),
    ("quality", ", reference: Run | None = None)", ")"),
    ("quality", "deviation(", "np.std("),
    (
        "quality",
        "    check_shapes(scene, *[each for each in (run, reference) if each is not None])\n",
        "",
    ),
)
# Functions of a region that are left out: errors against exact, and a guard against overflow
DROPPED = ("quality-parts", ("height_errors", "deviation"))
NOTE = """> The script beside this text, `contact.py`, holds `penalty` and `lcp`: this course keeps a
> chapter in one script of at most {cap} lines. What the text says of `soft`, of `exact` and of piles
> of many balls runs in the chapter's own repository, as do commands that begin with `python -m curriculum`.
> {left_out}
"""
ELSEWHERE = "*In the chapter's own repository, {file}, region {name}: {why}.*"


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
        if made[name].count(here) != 1:
            raise ValueError(
                f"contact.py:{found[name].first}: region {name} no longer has the "
                f"lines that the course's script changes, {here.strip()[:60]!r}; "
                "correct EDITS in curriculum/bundle.py"
            )
        made[name] = made[name].replace(here, there)
    name, functions = DROPPED
    for function in functions:
        made[name] = without(made[name], function)
    return {name: re.sub(r"\n{3,}", "\n\n", text).rstrip() + "\n" for name, text in made.items()}


def without(text, function):
    """Python source without one of its functions. Raises ValueError where there is none such."""
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef) and node.name == function:
            lines = text.split("\n")
            del lines[node.lineno - 1 : node.end_lineno]
            return "\n".join(lines)
    raise ValueError(f"contact.py: no function {function}; correct DROPPED in curriculum/bundle.py")


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
    return "\n".join(line.rstrip() for line in table[1].split("\n") if " of soft" not in line)


def script(root):
    """The course's contact.py. Raises ValueError when it is longer than the course allows."""
    pieces = [part("docstring").replace("{signs}", signs(root)) + "\n"]
    for name, text in region_texts(root).items():
        pieces.append(f"# --- region: {course_name(name)} ---\n{text}{regions.END}\n")
    made = "".join(pieces)
    if made.count("\n") > CAP:
        raise ValueError(
            f"the course's contact.py has {made.count(chr(10))} lines, allowed: {CAP}; "
            "leave a region out in curriculum/bundle.py"
        )
    missing = undefined_names(made)
    if missing:
        raise ValueError(
            f"the course's contact.py uses {', '.join(missing)}, which no region that it keeps "
            "defines; correct EDITS or KEPT in curriculum/bundle.py"
        )
    return made


def undefined_names(text):
    """The global names that the functions of a script use and that it does not define."""
    table = symtable.symtable(text, "contact.py", "exec")
    defined = set(table.get_identifiers()) | set(dir(builtins)) | {"__file__"}
    found, tables = set(), table.get_children()
    while tables:
        each = tables.pop()
        tables += each.get_children()
        found |= {symbol.get_name() for symbol in each.get_symbols() if symbol.is_global()}
    return sorted(found - defined)


def chapter(root, numbers):
    """The text with every number in place, as the course's renderer takes it."""
    text = (Path(root) / texts.CHAPTER).read_text("utf-8")
    numbers.run_all(text)
    text = numbers.render(text)

    def include(match):
        found = texts.INCLUDE.search(match[0])
        if not found:
            return match[0]
        file, name = found["file"], found["name"]
        if file == "contact.py" and name in ("setup", *KEPT):
            return f"```python\n[include-by-region: contact.py#{course_name(name)}]\n```"
        why = LEFT_OUT.get(name) or LEFT_OUT.get(file) or "not part of the course's one script"
        return ELSEWHERE.format(file=file, name=name, why=why)

    text = texts.FENCE.sub(include, text)
    text = mark_commands(texts.COMMENT.sub("", text), script(root))
    text = texts.DRAGGED.sub(lambda match: match[1], text)
    text = re.sub(r"(?<![\w/])exercises/(?=ex[123]_)", "exercises/suggested/", text)
    text = re.sub(r"(?<![\w/])checks\.py", "exercises/suggested/checks.py", text)
    title, _, rest = text.partition("\n")
    return re.sub(
        r"\n{3,}",
        "\n\n",
        f"{title}\n\n{NOTE.format(cap=CAP, left_out=left_out())}\n{rest.lstrip()}",
    )


def left_out():
    """What the course's script and exercises do not hold, and why, as words of the text."""
    reasons = {}
    for name, why in LEFT_OUT.items():
        reasons.setdefault(why, []).append(f"`{name}`")
    said = "; ".join(f"{' and '.join(names)} ({why})" for why, names in reasons.items())
    return textwrap.fill(f"Left out, with the reason: {said}.", 100).replace("\n", "\n> ")


def mark_commands(text, made):
    """The text with a word beside every fenced command that the course's script does not take."""
    course = {"__name__": "the course's contact.py"}
    exec(compile(made, "contact.py", "exec"), course)

    def mark(match):
        with contextlib.redirect_stderr(io.StringIO()):
            try:
                course["parse_flags"](shlex.split(match[0], comments=True)[2:])
            except SystemExit:
                return f"{match[0].rstrip()}     # in the chapter's own repository"
        return match[0]

    command = re.compile(r"^python contact\.py\b.*", re.MULTILINE)
    return texts.FENCE.sub(lambda fence: command.sub(mark, fence[0]), text)


def course_bands(exercise):
    """The bands of an exercise that the course's two models can be held to."""
    return {
        key: band
        for key, band in (exercise.get("bands") or {}).items()
        if re.search(r"quality\.(penalty|lcp)\.", key)
    }


def meta(root, made, numbers):
    """The course's meta.yaml: what its gates, its page and its grader read."""
    import yaml

    facts = load_meta(root)
    reading = facts["reading"]
    focus = [
        f"{name}: {what}"
        for functions in reading["files"].values()
        for name, what in functions.items()
    ]
    told = {
        "id": facts["id"],
        "title": "Build a Physics Engine III: Contact",
        "track": "elective",
        "artifact": "contact.py",
        "task": "bodies-on-a-table",
        "objectives": facts["objectives"],
        "scale_lab": False,
        "read_the_real_thing": True,
        "rtrt": {"repo": reading["repo"], "commit": reading["commit"], "focus": focus},
        "demo": "contact_quality",
        "reference_run": reference_run(facts, numbers),
        "exercise_checks": exercise_checks(facts),
        "region_hashes": {
            course_name(name): regions.Region(name, 0, text).sha256 for name, text in made.items()
        },
    }
    head = "# Made by `python -m curriculum.bundle`; do not edit it here.\n"
    return head + yaml.safe_dump(told, sort_keys=False, allow_unicode=True, width=100)


def reference_run(facts, numbers):
    """The figures of the reference run that the course's two models have, and where they are from."""
    quality = numbers.run(numbers.reference())["quality"]
    keys = ("max_penetration_frac", "rest_penetration_frac", "energy_excess")
    found = {f"{model}_{key}": quality[model][key] for model in ("penalty", "lcp") for key in keys}
    return {"provenance": facts["reference_run"]["provenance"], **found}


def exercise_checks(facts):
    """What the course's checks.py and its grader read: answers, tolerances, bands."""
    checks = {}
    for name in ("ex1", "ex2", "ex3"):
        exercise = facts["exercises"][name]
        kept = [key for key in ("provenance", "answer", "within") if key in exercise]
        checks[name] = {key: exercise[key] for key in kept}
        if course_bands(exercise):
            checks[name]["bands"] = course_bands(exercise)
    return checks


def exercises(root):
    """{file name: text} of exercises/suggested."""
    from curriculum import terminal

    folder, facts, made = Path(root) / "exercises", load_meta(root), {"checks.py": part("checks")}
    for path in sorted(folder.glob("ex[123]_*.py")):
        name, text = path.name.split("_")[0], path.read_text("utf-8")
        words = exercise_words(text)
        title = words["docstring"].split("\n")[0].partition(": ")[2]
        if "CHOICES" not in words:
            functions = [
                ast.get_source_segment(text, node)
                for node in ast.parse(text).body
                if isinstance(node, ast.FunctionDef)
                and node.name in ("penalty_normal_force", "project_impulse")
            ]
            if len(functions) != 2:
                raise ValueError(f"exercises/{path.name}: the two blanks are no longer there")
            made["ex2_completion_contact.py"] = part("blanks").format(
                title=title, functions="\n\n\n".join(functions)
            )
            continue
        bands = course_bands(facts["exercises"][name])
        runs = {}
        for run in dict.fromkeys(key.partition(":")[0] for key in bands):
            args = terminal.parse_flags([str(flag) for flag in facts["runs"][run]])
            runs[run] = (args.scene, args.dt, args.steps)
        choices = "\n".join(f"  {letter}) {each}" for letter, each in words["CHOICES"].items())
        made[path.name] = part("predict").format(
            title=title,
            question=words["QUESTION"],
            choices=choices,
            why=words["WHY_PROMPT"],
            letters=json.dumps([*words["CHOICES"]]),
            dictionary=listed(words["CHOICES"]),
            runs=listed(runs),
            keys=sorted({key.split(".")[-1] for key in bands}),
        )
    return made


def listed(values):
    """A dict as Python source, an item a line."""
    return (
        "{\n"
        + "".join(f"    {json.dumps(key)}: {value!r},\n" for key, value in values.items())
        + "}"
    )


def ledger(path):
    """The course's ledger at `path`: this chapter's rows not yet measured, all others kept."""
    rows = list(csv.reader(io.StringIO(path.read_text("utf-8")))) if path.exists() else []
    header, *rows = rows or [list(wallclock.COLUMNS)]
    ours = dict.fromkeys(
        [row[1] for row in rows if row and row[0] == wallclock.CHAPTER] + list(wallclock.SHOWN)
    )
    rows = [row for row in rows if row and row[0] != wallclock.CHAPTER]
    rows += [[wallclock.CHAPTER, tier, "", "", "", "", "PENDING"] for tier in ours]
    return "".join(",".join(row) + "\n" for row in [header, *rows])


def files(root, out, runs=None):
    """{path below the folder: text} of the whole bundle. Raises ValueError where it can't be made.

    `runs` may hold runs of meta.yaml that have been made already.
    """
    numbers, made = CourseNumbers(root, runs), region_texts(root)
    written = {
        f"{CHAPTER}/contact.py": script(root),
        f"{CHAPTER}/meta.yaml": meta(root, made, numbers),
        f"{CHAPTER}/prose/chapter.md": chapter(root, numbers),
        "common/wallclock.csv": ledger(Path(out) / "common/wallclock.csv"),
    }
    return written | {
        f"{CHAPTER}/exercises/suggested/{name}": text for name, text in exercises(root).items()
    }


@stoppable
def main(argv=None):
    """Write the bundle. Returns the exit status: 0 written, 1 it can't be made, 2 bad usage."""
    from curriculum.common.arguments import Parser, writable_folder

    parser = Parser(
        prog="python -m curriculum.bundle",
        description="The chapter as the course zero2robot keeps it.",
    )
    parser.add_argument(
        "--out",
        type=writable_folder,
        required=True,
        metavar="FOLDER",
        help="the course's folder `curriculum`, or an empty one",
    )
    args = parser.parse_args(argv)
    try:
        written = files(ROOT, args.out)
        for name, text in written.items():
            write_whole(str(Path(args.out) / name), text)
    except (ImportError, OSError, ValueError) as error:
        print(f"nothing more is written: {error}", file=sys.stderr)
        return 1
    lines = written[f"{CHAPTER}/contact.py"].count("\n")
    print(f"{args.out}: {len(written)} files; contact.py has {lines} of {CAP} lines")
    for name, why in LEFT_OUT.items():
        print(f"left out: {name}, {why}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
