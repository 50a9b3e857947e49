"""The recipes of CONTRIBUTING, typed in a clone: each ends green, or an error names what lacks."""

import itertools
import json
import re

import pytest

from curriculum.prose.chapter import CHAPTER
from curriculum.source import read_text
from curriculum.tests.helpers import FIGURE, clone, edit, gate, python, review, shorten

STEP = '''# --- region: sixth ---
def sixth_step(balls, dt, iters, relax):
    """Take one step [s] that stops at the surface and knows no bounce."""
    contacts = detect_contacts(balls)
    for c in contacts:
        c.target = relax * c.depth / dt
    accelerate(balls, dt)
    solve_accelerated(contacts, iters)
    move(balls, dt)
    return contacts


# --- region: run ---
'''
MODEL = '    "sixth": Model(sixth_step, ("iters", "relax"), 1, ("#666666", "x", (0, (2, 4)))),\n'
PAIR = '    if name == "pair":\n        x, y = [-0.15, 0.15], [1.0 + draw, 1.0 + draw]\n'
EXERCISE = '''"""Exercise 12, write it (2 minutes): twice as fast."""

from kit import script

script.main(__name__)


def doubled(speed):
    """Return twice the speed [m/s]."""
    return ...  # TODO: blank 1
'''
ENTRY = {
    "hints": ["What is two times it?"],
    "blanks": {
        "doubled": {"hint": 1, "inputs": {"ranges": {"speed": [1.0, 9.0]}}, "labels": ["the speed"],
                    "slips": {"speed": "it is as fast as before"}}
    },
}  # fmt: skip
CONTACT, ANSWERS, EX = "contact.py", "exercises/kit/answers.json", "ex12_twice.py"
RECIPES = {  # by the words of CONTRIBUTING's table: file, what stands there, what is typed there
    "sentence": [(CHAPTER, "It stays there.", "It stays there, after steps of {{dt|.3f}} s.")],
    "region": [
        (CONTACT, "def main(", "# --- region: start ---\ndef main("),
        (CHAPTER, "## Code\n", "## Code\n\n```\n[include-by-region: contact.py#start]\n```\n"),
    ],
    "scene": [
        (CONTACT, '"pile": 24}', '"pile": 24, "pair": 2}'),
        (CONTACT, '    if name == "stack":\n', PAIR + '    if name == "stack":\n'),
    ],
    "flag, knob": [
        (CONTACT, "    skip: bool = ", "    relax: float = 0.5\n    skip: bool = "),
        (CONTACT, '    "iters": (', '    "relax": (float, 0, 1, 0.5, "a share"),\n    "iters": ('),
    ],
    "model": [
        (CONTACT, "# --- region: run ---\n", STEP),
        (CONTACT, '    "exact": Model(', MODEL + '    "exact": Model('),
        (CHAPTER, "## Code\n", "## Code\n\n```\n[include-by-region: contact.py#sixth]\n```\n"),
    ],
    "figure": [
        ("curriculum/page/figures/dot.js", "", FIGURE),
        (CHAPTER, "<!-- exercise: ex1 ", "<!-- figure: dot?dt=0.01 -->\n<!-- exercise: ex1 "),
    ],
    "exercise": [
        (f"exercises/{EX}", "", EXERCISE),
        ("exercises/solutions/ex12.py", "", "def doubled(speed):\n    return 2.0 * speed\n"),
        (ANSWERS, '{\n "ex1": ', f'{{\n "ex12": {json.dumps(ENTRY)},\n "ex1": '),
        (CHAPTER, "<!-- exercise: ex1 ", "<!-- exercise: ex12 -->\n<!-- exercise: ex1 "),
    ],
}
OTHERS = ["setting of an engine", "release"]


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """(A clone with a short chapter and all recipes typed, reviewed; what the gate said)."""
    for needed in "matplotlib numba py_mini_racer pymunk rerun".split():
        pytest.importorskip(needed, reason=f"{needed} is missing: the extra `dev`")
    folder = clone(tmp_path_factory.mktemp("course"), "results")
    slots = re.findall(r"^<!-- (?:figure|exercise): .*\n", read_text(CHAPTER), re.M)
    shorten(folder, "".join(slots))
    before = review(folder)
    for file, old, new in itertools.chain(*RECIPES.values()):
        if old:
            edit(folder / file, old, new)
        else:
            (folder / file).write_text(new, "utf-8")
    return folder, [line for line in review(folder) if line not in before]


def test_contributing_has_each_recipe_and_no_other():
    told = re.findall(r"^\| an? (.+?) \|", read_text("CONTRIBUTING.md"), re.M)
    assert told == [*RECIPES, *OTHERS]


def test_the_gate_asks_to_review_what_was_typed_and_then_is_green(course):
    folder, lines = course
    asked = [re.search(r": read '(.*?)' again: ", line) for line in lines]
    assert all(asked) and [each[1] for each in asked] == ["A sponge", "Code", "figures/dot"], lines
    assert not {*lines} & {*gate(folder).stdout.splitlines()}


def test_a_model_with_its_parameter_is_run_recorded_drawn_compiled_and_on_the_page(course):
    """In a scene that is new, too."""
    folder, _ = course
    flags = "--scene pair --relax 0.3 --plot --steps 500 --out out".split()
    done = python(CONTACT, *flags, cwd=folder)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    quality = json.loads((folder / "out/metrics.json").read_text("utf-8"))["quality"]
    assert quality["sixth"]["rests"] and quality["sixth"]["max_penetration_frac"] < 0.1
    assert "sixth" in (folder / "out/contact.svg").read_text("utf-8")
    assert (folder / "out/contact.rrd").exists()
    same = (
        "import contact; from curriculum.compiled import run as compiled; "
        "scene, more = contact.build_scene('pile', 1, 9), contact.Settings(relax=0.3); "
        "step = contact.step_of('sixth', scene, 0.002, more); "
        "plain = contact.simulate(step, scene, 0.002, 200); "
        "copy = compiled.run_model('sixth', scene, 0.002, 200, more); "
        "print(plain.q.tobytes() == copy.q.tobytes(), plain.v.tobytes() == copy.v.tobytes())"
    )
    assert python("-c", same, cwd=folder, PYTHONPATH="").stdout == "True True\n"
    refused = python(CONTACT, "--relax", "2", cwd=folder)
    assert refused.returncode == 2 and "--relax: given 2; allowed: " in refused.stderr


def test_a_figure_an_exercise_and_a_model_are_on_the_page(course):
    folder, _ = course
    done = python("-m", "curriculum.page", "--out", "page.html", cwd=folder)
    page = (folder / "page.html").read_text("utf-8")
    assert done.returncode == 0 and "It pushes by 10 px" in page and "sixth_step" in page
    assert "Exercise 12: twice as fast" in page and '"relax": 0.5' in page


def test_an_exercise_waits_and_is_solved(course):
    folder, _ = course
    waits, solved = (python(f"exercises/{EX}", *more, cwd=folder) for more in ((), ("--solution",)))
    assert waits.returncode == 2 and "doubled is still a blank" in waits.stdout
    assert solved.returncode == 0 and "doubled is right" in solved.stdout, solved.stdout


def test_a_step_that_cannot_be_compiled_runs_in_python_and_says_which_line_is_why(course):
    folder, _ = course
    edit(folder / CONTACT, "relax * c.depth / dt", "max(0.0, *[c.depth])")
    flags = "--scene pile --bodies 60 --steps 290 --contact sixth --no-rerun --out out".split()
    done = python(CONTACT, *flags, cwd=folder)
    edit(folder / CONTACT, "max(0.0, *[c.depth])", "relax * c.depth / dt")
    assert done.returncode == 0 and "sixth" in done.stdout
    assert re.match(r"sixth runs in plain loops: contact.py:\d+: \*\[c.depth\]: no", done.stderr)


def test_a_setting_of_an_engine_is_tried_at_once(course):
    folder, _ = course
    settings = folder / "curriculum/bench/settings.csv"
    settings.write_text(settings.read_text("utf-8") + "pymunk,iterations=7,drop,1,,\n", "utf-8")
    words = "-m", "curriculum.bench", "try", "drop", "pymunk iterations=7"
    assert re.search(r"iterations=7: error [\d.]+ r ", python(*words, cwd=folder).stdout)


def test_a_release_has_one_version():
    places = {"pyproject.toml": r'^version = "(.+)"', "CHANGELOG.md": r"^## ([\d.]+)",
              "uv.lock": r'^name = "contact-chapter"\nversion = "(.+)"'}  # fmt: skip
    found = {re.search(find, read_text(file), re.M)[1] for file, find in places.items()}
    assert len(found) == 1, found
