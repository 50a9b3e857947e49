"""The exercises: untouched they wait, right fills pass in every form, wrong ones are named.

Needs numpy and pytest and nothing else, as a learner has them.
"""

import math
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from functools import partial
from textwrap import indent
from types import SimpleNamespace

import numpy as np
import pytest

from curriculum.tests.helpers import NO_PLUGINS, ROOT, python

sys.path.insert(0, str(ROOT / "exercises"))

from kit import FACTS, blanks, knobs, predict, time_limit, trials  # noqa: E402
from kit.progress import FILES  # noqa: E402

import contact  # noqa: E402

GIVEN = {name: time_limit.load(ROOT / file) for name, file in FILES.items()}  # with blanks
BETS = {name: predict.asked(GIVEN[name].__doc__) for name in predict.BETS}
ASKED = "?        ?           ?            ?"
MARKS = {  # what physics says of k, dt, sweeps and beta
    "sink": "-===",  # k depth = m g
    "dive": "=-==",  # up to a step's fall
    "hop": "=-=+",  # beta depth / dt throws
    "sag": "=---",  # an unfinished sweep is a spring of stiffness beta K m / dt^2
    "trembling": "+-==",  # past the critical step of penalty
}
SWEEP = blanks.SWEEP.strip()
SEARCH = """low, high = 0, 2
while high - low > 1e-7:
    mid = (low + high) / 2
    size = max(abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, mid))))
    low, high = (mid, high) if size <= 1 else (low, mid)
return low"""
FILLED = {      # name: [(a part of the file, what a learner writes there)]
    "ex1": [("PREDICTION = None ", "PREDICTION = ' c) ' "), ('WHY = ""', 'WHY = "so it must be"')],
    "ex2": [("return ...  # TODO: blank 1", "return max(0, stiffness * depth - damping * v_n)"),
            ("return ...  # TODO: blank 2", "return lam + max(-lam, dlam)")],
    "ex3": [("PREDICTION = None ", "PREDICTION = 'A' "), ('WHY = ""', 'WHY = "a bet is a bet"')],
    "ex4": [("PREDICTION = None ", "PREDICTION = 'A' "), ('WHY = ""', 'WHY = "so it has to be"')],
    "ex5": [("    return ...", indent(SWEEP.replace("c.push", "print('hi'); c.push"), "    "))],
    "ex6": [("return ...  # TODO: blank 1", "return np.array([[1, -dt], [0, 1]]) @ [[1, 0], "
             "[dt * stiffness / mass, 1 - dt * damping / mass]]"),
            ("    return ...  # TODO: blank 2", indent(SEARCH, "    "))],
    "ex7": [("return ...", "r = 1 / (dt * (stiffness * dt + damping)); "
             "return r, r * dt * stiffness * depth")],
    "ex8": [("MODEL = None", 'MODEL = "soft"'), ("SOLREF = (0.02, 1.0)", "SOLREF = (0.008, 1.0)"),
            ("SOLIMP = (0.9, 0.95,", "SOLIMP = (0.999, 0.999,")],
    "ex9": [*((f"    {trouble:<12}{ASKED}", f"  {trouble} {' '.join(marks)}")
              for trouble, marks in MARKS.items()), ("SAG = None", "SAG = 1.18e-3")],
    "ex10": [("return ...  # TODO: blank 1", "return 1 / 2, -gap / dt"),
             ("return ...  # TODO: blank 2", "return lam > 0, 0.0, lam, now")],
}  # fmt: skip


def exercise(name="ex2", **written):
    return SimpleNamespace(__file__=str(ROOT / FILES[name]), **written)


@pytest.fixture
def copy(tmp_path):
    """A learner's copy, in a folder with a space and a quote, and a function that fills it in."""
    folder = tmp_path / "my robot's course"
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "exercises", folder / "exercises", ignore=leave)
    (folder / "curriculum/show").mkdir(parents=True)
    for name in ("contact.py", "checks.py", *(f"curriculum/{name}.py" for name in (
            "commands", "implicit", "exact", "show/remarks"))):  # fmt: skip
        shutil.copy(ROOT / name, folder / name)

    def fill(name, *changes):
        path = folder / FILES[name]
        text = path.read_text("utf-8")
        for old, new in changes or FILLED[name]:
            assert text.count(old) == 1, (name, old)
            text = text.replace(old, new)
        path.write_text(text, "utf-8")

    return folder, fill


def run(folder, *command, lacks="yaml", options=()):
    """The command there, by a learner's Python, in which a package cannot be imported."""
    start = (
        f"import sys, runpy; sys.modules[{lacks!r}] = None; sys.argv = sys.argv[1:]; "
        "sys.path[0] = sys.argv[0].rpartition('/')[0] or '.'; "
        "runpy.run_path(sys.argv[0], run_name='__main__')"
    )
    return python(*options, "-c", start, *command, cwd=folder, **NO_PLUGINS)


def test_a_script_that_is_not_filled_in_prints_its_task_anywhere_and_without_docstrings(tmp_path):
    for name, whole in (("ex1", True), ("ex2", False)):
        result = run(tmp_path, ROOT / FILES[name], options=["-OO"])
        task = GIVEN[name].__doc__.strip()
        assert result.stdout.startswith(task if whole else task.split("\n")[0])
        assert (result.returncode, result.stderr) == (2, "")


@pytest.mark.parametrize("name", FILES)
def test_every_script_prints_the_hint_that_is_asked_for_and_no_other(name, capsys, monkeypatch):
    hints = FACTS[name]["hints"]
    for number, hint in enumerate(hints, 1):
        monkeypatch.setattr(sys, "argv", [FILES[name], "--hint", str(number)])
        runpy.run_path(str(ROOT / FILES[name]), run_name="__main__")
        assert capsys.readouterr().out == f"hint {number} of {len(hints)}: {hint}\n"
    monkeypatch.setattr(sys, "argv", [FILES[name], "--hint", "0"])
    with pytest.raises(SystemExit, match="2"):
        runpy.run_path(str(ROOT / FILES[name]), run_name="__main__")
    assert re.fullmatch(r"ex\w+\.py: error: argument --hint: .*\n", capsys.readouterr().err)


def test_a_learners_way_through_all_ten(copy, tmp_path):
    """Each script says what is next, in an odd folder too; a bet counts once it was read."""
    folder, fill = copy
    following = dict(zip(FILES, [*FILES.values()][1:]))
    for name, file in FILES.items():
        shutil.copy(folder / file, f"{folder / file}~")  # as editors leave one
        fill(name)
        command = shlex.join([sys.executable, str(folder / file)])
        if name == "ex1":  # untouched ones wait; the command that is printed works as it is printed
            printed = run(folder, "checks.py").stdout
            assert "10 skipped" in printed and all(f"{each}: " in printed for each in FILES)
            assert all(FILES[each] in printed for each in FILES)
            assert "row sink: given ? ? ? ?, allowed: four" in printed
            command = printed.split("now read what happens: ")[1].splitlines()[0]
        where = tmp_path if name == "ex2" else folder
        done = subprocess.run(command, shell=True, cwd=where, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        assert ("  printed   hi\n" in done.stdout) == (name == "ex5")
        last = done.stdout.splitlines()[-1]
        assert following.get(name, "") in last and (name == "ex8") != (sys.executable in last)
    result = run(folder, "checks.py")
    assert result.returncode == 0 and "10 passed" in result.stdout
    asked = run(folder, "contact.py", "--steps", 5, "--no-rerun")
    for text in (done.stdout, result.stdout, asked.stdout):
        assert text.splitlines()[-1].startswith("all exercises are done")


def test_what_is_wrong_broken_or_without_end_fails_its_own_check_and_says_why(copy):
    folder, fill = copy
    fill("ex1", ("PREDICTION = None", "PREDICTION = C"))
    fill("ex2", ("return ...  # TODO: blank 2", 'print("sum", lam + dlam); return lam + dlam'))
    fill("ex3", ("PREDICTION = None", "PREDICTED = 'B'"))
    fill("ex4", ("script.main()", "script.main("))
    fill("ex6", *FILLED["ex6"][:1], ("return ...  # TODO: blank 2", "while True:\n        pass"))
    fill("ex7", ("return ...", "import os; os._exit(7)"))
    fill("ex9", *FILLED["ex9"][:-1], ("SAG = None", "SAG = 1.373e-3"))
    fill("ex10", ("return ...  # TODO: blank 1", "return 0.5, gap / dtt"))
    limit = folder / "exercises/kit/time_limit.py"
    limit.write_text(limit.read_text().replace("LIMIT = 20", "LIMIT = 4"))
    result = run(folder, "checks.py")
    assert result.returncode == 1 and "7 failed, 3 skipped" in result.stdout
    assert all(f"{name}: " in result.stdout for name in ("ex3", "ex5", "ex8"))
    for words in (
        "C needs quotes around it", "ex3: no prediction yet", "SyntaxError",
        "implicit_spring ended its process (exit sta",
        "likely: nothing keeps the table from pulling", "printed   sum -0.3",
        "longest_step takes too long, or does not end: stopped after 4 s in exercises/ex6_find_the",
        "blank: write what line 31 of exercises/ex5_solve_contacts.py returns. The task stands",
        "likely: the lowest ball carries those above it",
        "raised NameError: name 'dtt' is not defined\n  line 34: return 0.5, gap / dtt",
    ):  # fmt: skip
        assert words in result.stdout, words
    assert "Traceback" not in result.stdout
    assert not (folder / "outputs/ch3.5-contact/exercises.json").exists(), "none is done"
    words = [sys.executable, folder / FILES["ex1"]]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode and done.stderr.count("\n") == 1 and "needs quotes" in done.stderr


def test_without_pytest_or_numpy_one_line_says_how_to_get_it(copy):
    folder, _ = copy
    for lacks, file in (("pytest", "checks.py"), ("numpy", FILES["ex1"])):
        result = run(folder, file, lacks=lacks)
        assert result.returncode in (1, 2) and result.stderr.count("\n") == 1, result.stderr
        assert re.search(rf"{lacks}.*: .*(pip install|uv run --with) {lacks}", result.stderr)


# Fills: right ones and every slip


RIGHT = [
    ("penalty_normal_force", lambda depth, v_n, stiffness, damping: (
        (depth * stiffness - v_n * damping) * (depth * stiffness > v_n * damping))),
    ("project_impulse", lambda lam, dlam: 0.5 * (lam + dlam + abs(lam + dlam))),
    ("project_impulse", lambda lam, dlam: np.float32(0) if lam < -dlam else lam + dlam),
    ("solve_contacts", blanks.solver()),
    ("solve_contacts", blanks.solver("max(0.0, c.lam + add)", "c.lam + max(-c.lam, add)")),
    ("step_matrix", lambda m, k, c, dt: (
        np.array([[1, -dt], [0, 1]]) @ np.array([[1, 0], [dt * k / m, 1 - dt * c / m]]))),
    ("longest_step", lambda m, k, c: next(
        dt for dt in 0.2 * 0.999 ** np.arange(9000)
        if max(abs(np.linalg.eigvals(blanks.matrix(m, k, c, dt)))) <= 1)),
    ("longest_step", lambda m, k, c: (math.sqrt(c * c + 4 * k * m) - c) / k),
    ("implicit_spring", lambda depth, k, c, dt: (
        dt**-2 / (k + c / dt), depth / dt / (1 + c / (k * dt)))),
    ("before_the_move", lambda gap, dt: [np.float64(0.5), 0 - gap / dt]),
    ("after_the_move", lambda lam, then, now: [lam, 0, max(lam, 0.0), now]),
]  # fmt: skip


@pytest.mark.parametrize("blank, function", RIGHT)
def test_a_right_fill_passes_in_every_form(blank, function):
    assert trials.judge(exercise(**{blank: function}), blank) == ("right", "")


@pytest.mark.parametrize("blank", blanks.BLANKS)
def test_a_wrong_fill_fails_and_is_named_from_its_values(blank):
    for function, meaning in blanks.BLANKS[blank].slips:
        state, words = trials.judge(exercise(**{blank: function}), blank)
        assert state == "wrong" and words.splitlines()[-1] == f"  likely: {meaning}"
        parts = f"{blank} is wrong on ", "the smallest", f"  {blank}(", "got", "expected"
        assert all(part in words for part in parts)


MATRIX = "a, b = dt * stiffness / mass, 1 - dt * damping / mass\nreturn "
SPRING = "r = 1 / (stiffness * dt**2 + damping * dt)\nreturn "
TYPED = [  # what a learner writes in a blank, and what he is told
    ("penalty_normal_force", "return max(0, stiffness * depth) - damping * v_n", "goes round both"),
    ("penalty_normal_force", "return stiffness * depth + max(0, -damping * v_n)", "way in only"),
    ("penalty_normal_force", "return float('nan')", "where to look: "),
    ("project_impulse", "return max(0, lam) + dlam", "nothing keeps the table from pulling"),
    ("project_impulse", "return max(0, lam + dlam) - lam", "asked for is the new sum"),
    ("solve_contacts", SWEEP.replace("(lam -", "(add +").replace("add + c.lam", "add"), "before"),
    ("solve_contacts", SWEEP.replace("* c.m", "/ c.m"), "divided by m_eff"),
    ("solve_contacts", SWEEP.replace("max(0.0, c.lam + add)", "c.lam + add"), "no clamp"),
    ("solve_contacts", SWEEP.replace("iters", "2000"), "sweeps of its own"),
    ("solve_contacts", SWEEP + "\n        return", "`return` stands within the loop"),
    ("solve_contacts", SWEEP.replace("    c.push", "c.push").replace("    c.lam =", "c.lam ="),
     "only the last contact"),
    ("solve_contacts", "for c in contacts:\n    for _ in range(iters):"
     + SWEEP.partition("contacts:")[2], "gone through once"),
    ("step_matrix", MATRIX + "[[1 - dt * a, -dt], [a, b]]", "that velocity moves the depth"),
    ("step_matrix", MATRIX + "[1 - dt * a, -dt * b, a, b]", "two rows of two"),
    ("step_matrix", MATRIX + "[[1 - dt * a, dt * b], [a, b]]", "a sign in the first row"),
    ("longest_step", SEARCH.replace("abs", "np.real"), "the same step, an end of the search"),
    ("longest_step", SEARCH.replace("<=", ">"), "the same step, an end of the search"),
    ("longest_step", SEARCH.replace("1e-7", "1e-3"), "the search is too coarse"),
    ("longest_step", "return (mass / stiffness) ** 0.5", "half the limit without the damper"),
    ("implicit_spring", SPRING + "r, dt * stiffness * depth", "divided as a whole"),
    ("implicit_spring", SPRING.replace("+", "-") + "r, r * dt * stiffness * depth", "damper's"),
    ("implicit_spring", "return 1 / (damping * dt), stiffness * depth / damping", "adds k dt^2"),
    ("implicit_spring", SPRING + "-r, r * dt * stiffness * depth", "the sign of the softness"),
    ("before_the_move", "return 1, -gap / dt", "the whole kick"),
    ("before_the_move", "return 0.5, 0", "of the way, ask where it ends"),
    ("before_the_move", "return 0.5, -gap / dt - 0.5 * 9.81 * dt", "gravity is in v_n by then"),
    ("before_the_move", "return -gap / dt", "got 1, expected 2"),
    ("after_the_move", "return False, 0, lam, now", "no contact is asked"),
    ("after_the_move", "return lam > 0, 0, 0, now", "lam is forgotten"),
    ("after_the_move", "return lam > 0, 0, -lam, now", "takes back from it"),
]  # fmt: skip


@pytest.mark.parametrize("blank, body, told", TYPED)
def test_what_a_learner_types_is_named(blank, body, told):
    name, typed = blanks.BLANKS[blank].exercise, {"__name__": "typed"}
    before, after = (ROOT / FILES[name]).read_text("utf-8").split(f"def {blank}(")
    after = re.sub("    return .*", indent(body, "    "), after, count=1)
    exec(f"{before}def {blank}({after}", typed)
    if blank == "longest_step":
        typed["step_matrix"] = blanks.matrix
    state, words = trials.judge(exercise(name, **{blank: typed[blank]}), blank)
    assert state == "wrong" and told in words, words


@pytest.mark.parametrize("case", blanks.stacks())
def test_the_stacks_are_solved_contact_by_contact(case):
    """lam >= 0, v_n >= target, and one of the two holds as an equation; pushes keep momentum."""
    *found, soon = blanks.run_stack(blanks.BLANKS["solve_contacts"].right, **case)
    *_, turned = blanks.run_stack(lambda made, n: contact.solve_contacts(made[::-1], n), **case)
    assert soon == turned == 0.0, "four contacts want more than a sweep, in either order"
    count, mass = len(case["contacts"]), np.array(case["masses"])
    lam, v = np.array(found[:count]), np.reshape(found[count:], (-1, 2))
    gained, rest = np.zeros_like(v), np.append(v, [[0.0, 0.0]], axis=0)
    for push, (a, b, angle, target) in zip(lam, case["contacts"]):
        normal = np.array((math.sin(angle), math.cos(angle)))
        spare = normal @ (rest[a] - rest[b]) - target
        assert push >= 0.0 and spare > -1e-9 and abs(push * spare) < 1e-9
        gained[a] += push * normal
        gained[b] -= (b >= 0) * push * normal
    assert gained == pytest.approx(mass[:, None] * (v - case["speeds"]), abs=1e-12)


def test_what_raises_or_gives_no_number_fails_in_one_line():
    for function, part in (
        (lambda lam, dlam: lamda, "raised NameError"),  # noqa: F821
        (lambda lam, dlam: None, "returned None, and not numbers"),
        (lambda lam, dlam: "3", "returned '3', and not numbers"),
        (lambda lam: lam, "raised TypeError"),
        (lambda lam, dlam: sys.exit(3), "raised SystemExit"),
        (3, "is no longer a function"),
    ):
        state, words = trials.judge(exercise(project_impulse=function), "project_impulse")
        assert state == "wrong" and part in words and words.count("\n") <= 1


def test_a_wrong_matrix_does_not_blame_the_search():
    """It waits for the matrix, and a right search passes whatever became of the matrix."""
    right = {name: blanks.BLANKS[name].right for name in ("step_matrix", "longest_step")}
    wrong = {name: blanks.BLANKS[name].slips[0][0] for name in right}
    state, (first, second) = trials.judged("ex6", exercise(**wrong))
    assert (state, first[1], second[1]) == ("wrong", "wrong", "blank")
    assert second[2] == "longest_step is tried once step_matrix is right"
    _, found = trials.judged("ex6", exercise(**right | {"longest_step": wrong["longest_step"]}))
    assert [state for _, state, *_ in found] == ["right", "wrong"]


def test_a_fill_that_stops_in_a_trial_is_not_right():
    right = blanks.BLANKS["implicit_spring"].right

    def spring(depth, stiffness, damping, dt, most=math.inf):
        return right(depth, stiffness, damping, dt) if depth < most else 1 / 0

    stops = exercise(implicit_spring=partial(spring, most=0.051))
    state, ((_, _, words, _),) = trials.judged("ex7", stops)
    assert state == "wrong" and "a trial of implicit_spring stopped: ZeroDivisionError" in words
    _, ((_, state, _, shown),) = trials.judged("ex7", exercise(implicit_spring=spring))
    assert state == "right" and "nan" not in shown
    assert shown.splitlines()[-2].split()[-1] == "-", "penalty has exploded, so it rests nowhere"


def test_yours_stands_beside_what_it_is_compared_with():
    """Wrong clamps, a limit of 7 ms, a spring that is none, a bet with one off."""
    own = [trials.height(trial) for trial in [*trials.TRIALS][1:]]
    assert own[0] == pytest.approx(2 / 3 * 2.04 * 0.408 / 1.2, abs=0.01)  # a parabola, then at rest
    for clamp in (lambda lam, dlam: 0, lambda lam, dlam: lam + dlam, lambda lam, dlam: abs(dlam)):
        shown = trials.compare(exercise(project_impulse=clamp), "project_impulse")
        heads, *rows = (line.split()[-2:] for line in shown.splitlines())
        mine, other = ([float(cell) for cell in column] for column in zip(*rows))
        assert heads == ["yours", "contact.py"] and mine != other == own
    shown = trials.cliffs(exercise(longest_step=lambda mass, stiffness, damping: 0.007), None)
    assert shown.splitlines()[2].split()[4:] == ["0.00700", "s", "0.01354", "s", "0.02000", "s"]
    none = exercise(implicit_spring=lambda depth, stiffness, damping, dt: (1e300, 0.0))
    drop = contact.build_scene("drop")
    run = contact.run_model("penalty", drop, 0.016, 500)
    gained = contact.contact_quality(run, drop, 0.016)["energy_excess"]
    assert trials.drops(none, None).splitlines()[3].split()[3:5] == ["0", f"{gained:.5g}"]
    lines = [f"{trouble} {' '.join(marks)}" for trouble, marks in MARKS.items()]
    for off, count in ((lines[0], 20), (lines[0].replace("=", "-", 1), 19)):
        _, ((*_, shown),) = knobs.judged("ex9", exercise(BETS="\n".join([off, *lines[1:]]), SAG=1))
        assert f"holds in {count} of 20;" in shown


def test_asking_twice_is_leapfrogs_step_and_a_slip_of_it_is_seen_beside_exact():
    """The second solve in plain sweeps, e = 0; errors in r, and the height of what is thrown."""
    right = {name: blanks.BLANKS[name].right for name in ("before_the_move", "after_the_move")}

    def seen(**fills):
        shown = trials.ask_twice(exercise("ex10", **right | fills), None)
        order = re.search(r"slide is ([\d.]+), lcp's is 1\.0\.$", shown)[1]
        return [*(float(line.split()[-2]) for line in shown.splitlines()[1:6]), float(order)]

    drop, stack, slide, shorter, height, order = seen()
    assert drop < 1e-12 and stack < 1e-5 and slide < 1e-3 and shorter < 1e-4
    assert height < 3.1 and order > 1.9, "half a radius in one another, and not thrown"
    assert seen(before_the_move=lambda gap, dt: (1, -gap / dt))[5] < 1.1
    assert seen(after_the_move=lambda lam, then, now: (lam > 0, 0, lam, then))[5] < 1.5
    assert seen(after_the_move=lambda lam, then, now: (lam > 0, 0, 0, now))[4] > 100


FINGERS = {name: value for name, value in vars(GIVEN["ex8"]).items() if name.isupper()}
HARD = (0.9999, 0.9999, 0.001, 0.5, 2.0)


@pytest.mark.parametrize("choice, part", [
    ({"SOLREF": (0.003, 1.0), "SOLIMP": (0.99, 0.99, 0.001, 0.5, 2.0), "DT": 0.002}, None),
    ({"SOLREF": (0.004, 1.0), "DT": 0.002}, "overlaps too much"),
    ({"SOLREF": (0.02, 0.05), "SOLIMP": HARD, "DT": 0.001}, "it trembles;"),
    ({"MODEL": "penalty"}, "it trembles, and it overlaps too much"),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 2e5}, None),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 3e5, "DAMPING": 0.0}, "trembles"),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 3e5, "DAMPING": 400.0}, "the cup is gone"),
    ({"MODEL": "penalty", "DT": 0.002, "STIFFNESS": 1e6}, "wants steps below 0.0006 s"),
    ({"MODEL": "implicit", "STIFFNESS": 3e5}, None),
    ({"MODEL": "implicit", "STIFFNESS": 3e4}, "overlaps too much; 20 N press a spring"),
    ({"MODEL": "implicit", "STIFFNESS": 3e5, "DT": 0.05}, "motor carries a finger 2.5 r"),
    ({"MODEL": "implicit", "DAMPING": 8e3}, "it settles in about c / k = 0.8 s"),
    ({"MODEL": "hard"}, "allowed: MODEL 'penalty', 'implicit' or 'soft'"),
    ({"DT": 0.0001}, "0.0005 s (2,000 steps)"),
    ({"DT": "fast"}, "cannot be run: given MODEL 'soft', DT 'fast'"),
    ({"SOLREF": 0.005}, "SOLREF two numbers"),
])  # fmt: skip
def test_the_gripper_is_judged_by_what_it_does(choice, part):
    made = exercise(**FINGERS | {"MODEL": "soft"} | choice)
    state, words, _ = trials.judge_fingers(made)
    assert state == ("wrong" if part else "right") and (part is None or part in words), words


# Bets


@pytest.mark.parametrize("name", BETS)
def test_a_bet_waits_for_a_choice_and_a_reason(name):
    for prediction, why, part in (
        (None, "", "no prediction yet"),
        ("D", "so it has to be", "PREDICTION is 'D'; write one of 'A', 'B', 'C' in "),
        ("A", "because", "WHY is 'because'; write a sentence of four words or more in "),
    ):
        made = exercise(name, PREDICTION=prediction, WHY=why)
        state, ((_, _, words, shown),) = predict.judged(name, made)
        assert state == "blank" and part in words and shown == ""
    assert words.endswith(f". {BETS[name]['why']}") and "?" in BETS[name]["why"]


@pytest.mark.parametrize("name", BETS)
def test_after_the_run_there_is_a_word_on_every_choice(name):
    choices, right = BETS[name]["choices"], predict.answer(name, predict.measure(name))
    for mine in "ABC":
        made = exercise(name, PREDICTION=mine, WHY="so it has to be")
        _, ((_, state, text, _),) = predict.judged(name, made)
        text = " ".join(text.split())
        assert state == "right" and ("That is what happens." in text) == (mine == right)
        assert text.index(f"Why {right}:") < text.index("Why not"), "the right one first"
        assert all(f"Why {c}:" in text if c == right else f"Why not {c}:" in text for c in choices)
        assert "{" not in text and choices[right] in text and [*choices] == ["A", "B", "C"]


# Keys, reasons and captions come from measurements


RIGHT_WORDS = {"ex1": "much deeper", "ex3": "lcp ball stays bounded", "ex4": "equally deep"}
PHYSICS = {"k": 1e4, "m": 1.0, "g": 9.81, "K": 1.0 / (0.95 * 0.02) ** 2}


@pytest.mark.parametrize("name", [*BETS, "ex9"])
def test_keys_formulas_and_numbers_are_those_measured(name):
    measured = predict.measure(name) if name in BETS else knobs.numbers()
    if name in BETS:
        assert RIGHT_WORDS[name] in BETS[name]["choices"][predict.answer(name, measured)]
    else:  # no share lies near the borders of what a mark means
        shares = knobs.measure()[1]
        assert {trouble: "".join(map(knobs.mark, row)) for trouble, row in shares.items()} == MARKS
        assert all(x < 0.4 or 0.95 < x < 1.05 or x > 4.0 for row in shares.values() for x in row)
    deep = {"ex1": "penalty_at_rest", "ex4": "soft_light", "ex9": "sink"}
    depth = 0.1 * measured[deep.get(name, "limit")]
    values = PHYSICS | {"depth": depth, "d": contact.impedance(depth, contact.SOLIMP)}
    for text in FACTS[name]["reasons"].values():
        for formula in re.findall(r"`([^`]+=[^`]+)`", text):
            code = re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", formula.replace("^", "**"))
            left, right = (eval(side, {}, values) for side in code.split("="))
            assert left == pytest.approx(right, rel=1e-4), formula
        typed = re.findall(r"\d+", re.sub(r"\{[^}]*\}|`[^`]*`", "", text))
        assert not typed, f"a number that nobody measured in: {text}"
        text.format(**measured)


def test_captions_of_the_tables_say_what_is_run():
    seconds = float(re.search(r"followed for ([\d.]+) s", GIVEN["ex1"].__doc__)[1])
    first, third, fourth = (predict.BETS[name][3].values() for name in BETS)
    assert all(dt * steps == pytest.approx(seconds) for _, _, dt, steps, _ in first)
    assert all(head in ("", f"dt = {dt:g} s") for head, _, dt, _, _ in third)
    assert all(head == f"{mass:g} kg" for head, *_, mass in fourth)


def test_the_sag_is_what_its_command_prints_and_each_slip_of_it_is_named(tmp_path):
    (command,) = re.findall(r"^    python (contact.py .*)$", GIVEN["ex9"].__doc__, re.MULTILINE)
    words = [sys.executable, ROOT / "contact.py", *shlex.split(command)[1:], "--no-rerun"]
    printed = subprocess.run([*words, "--out", tmp_path], capture_output=True, text=True).stdout
    (row,) = (line.split() for line in printed.splitlines() if line.startswith("lcp "))
    law = 6 * 9.81 * 0.001**2 / 0.5 / 0.1  # six balls on top, a half opens, one sweep; in r
    assert float(row[2]) == pytest.approx(-law, rel=5e-3)
    assert knobs.measure_sag() == pytest.approx(law, rel=1e-3)
    bets = "".join(f"{trouble} {' '.join(marks)}\n" for trouble, marks in MARKS.items())
    for sag, state, words in (
        (law, "right", ""), (None, "blank", "no SAG yet"),
        ("deep", "blank", "given 'deep'; write a number"), (0.5, "wrong", "sags otherwise"),
        *((eval(text, {}, knobs.TOWER), "wrong", f"likely: {meaning}")
          for text, meaning in FACTS["ex9"]["slips"].items()),
    ):  # fmt: skip
        found = knobs.state(exercise(BETS=bets.replace("-", "\N{MINUS SIGN}"), SAG=sag))
        assert found[0] == state and words in found[1], (sag, found)


# What the chapter says, and when


GIVEAWAYS = {
    "ex1": r"\bsinks?\b|rests? (a little )?inside|m g ?/ ?k|\brings?\b|\bhops?\b|\bdives?\b",
    "ex3": r"\b(penalty|spring)\b.{0,80}(explod|blows? up)|critical (time )?step|unstable|"
    r"stays bounded|\bcliff\b",
    "ex4": r"mass cancels|no mass in|\(1 - d\) \\?,? ?g|equally deep|whatever the mass",
}


@pytest.mark.parametrize("name", GIVEAWAYS)
def test_the_chapter_tells_the_answer_of_a_bet_after_its_bet_and_not_before(name):
    text = (ROOT / "curriculum/prose/chapter.md").read_text("utf-8")
    before, after = text.split(f"<!-- exercise: {name} -->")
    before = re.sub(
        r"tremble, sink or fly to pieces|<!--.*?-->|`--?[\w-]+`", " ", before, flags=re.S
    )
    found = re.search(GIVEAWAYS[name], " ".join(before.split()), re.IGNORECASE)
    assert found is None, found
    assert re.search(GIVEAWAYS[name], " ".join(after.split()), re.IGNORECASE)


def test_exercises_are_offered_in_the_chapters_order():
    text = (ROOT / "curriculum/prose/chapter.md").read_text("utf-8")
    assert re.findall(r"<!-- exercise: (\w+) -->", text) == [*FILES]
    readme = " ".join((ROOT / "README.md").read_text("utf-8").split())
    assert f"do them in the order {', '.join(FILES)}, which is the chapter's" in readme


@pytest.mark.parametrize("name, file", FILES.items())
def test_an_exercise_gives_nothing_away_and_hints_ask(name, file):
    text = (ROOT / file).read_text("utf-8")
    for giveaway in ("m g / k", "max(", "clamp", "sqrt", "0.25", "1409", "0.0036", "0.00118"):
        assert giveaway not in text
    head = r'(# .*\n)+"""Exercise \d+, [\w ]+ \(\d+ minutes\): .+[.?]\n'
    assert re.match(head, text) and "--hint" in text
    hints = FACTS[name]["hints"]
    assert all("?" in hint and not re.search(r"[=*/]|max\(", hint) for hint in hints)
