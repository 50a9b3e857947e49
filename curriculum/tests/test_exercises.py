"""The exercises: untouched they wait, right answers pass in every form, wrong ones are named.

Needs numpy and pytest and nothing else, as a learner has them.
"""

import json
import math
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from textwrap import indent
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from curriculum.tests.helpers import NO_PLUGINS, ROOT, python

sys.path.insert(0, str(ROOT / "exercises"))

from kit import FACTS, bets, judge, load, script, slips  # noqa: E402
from kit.script import FILES  # noqa: E402

import contact  # noqa: E402

GIVEN = {name: load(ROOT / file) for name, file in FILES.items()}  # with blanks
ASKED = {name: bets.asked(GIVEN[name].__doc__) for name in bets.BETS}
SOLUTIONS = {path.stem: path for path in (ROOT / "exercises/solutions").iterdir() if path.is_file()}
MARKS = {row.split()[0]: row.split()[1:] for row in slips.RIGHT["ex9"].BETS.splitlines()[2:]}
BET = ("PREDICTION = None ", "PREDICTION = ' c) ' "), ('WHY = ""', 'WHY = "so it must be"')


def exercise(name="ex2", **written):
    return SimpleNamespace(__file__=str(ROOT / FILES[name]), **written)


def typed(blank, body):
    """An exercise in whose blank a learner has written this."""
    name = slips.BLANKS[blank].exercise
    before, after = (ROOT / FILES[name]).read_text("utf-8").split(f"def {blank}(")
    after = re.sub("    return .*", lambda _: indent(body, "    "), after, count=1)
    return f"{before}def {blank}({after}"


@pytest.fixture
def copy(tmp_path):
    """A learner's copy, in a folder with a space and a quote, and a function that fills it in."""
    folder = tmp_path / "my robot's course"
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "exercises", folder / "exercises", ignore=leave)
    (folder / "curriculum/show").mkdir(parents=True)
    for name in ("contact.py", "checks.py", *(f"curriculum/{name}.py" for name in (
            "__init__", "commands", "implicit", "exact", "show/remarks"))):  # fmt: skip
        shutil.copy(ROOT / name, folder / name)

    def fill(name, *changes):
        """The right answer, or (old, new) of the file."""
        path = folder / FILES[name]
        text = path.read_text("utf-8")
        for old, new in changes or (BET if name in bets.BETS else ()):
            assert text.count(old) == 1, (name, old)
            text = text.replace(old, new)
        if name in SOLUTIONS and not changes:
            head, end = text.split("from kit import script\n")[0], "script.main(__name__)\n"
            text = f"{head}{SOLUTIONS[name].read_text('utf-8')}\nfrom kit import script\n{end}"
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
        assert "?" in hint and not re.search(r"[=*/]|max\(", hint), "a hint asks"
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
        assert (f"solutions/{name}.py" in done.stdout) == (name in SOLUTIONS)
        last = done.stdout.splitlines()[-1]
        assert following.get(name, "all exercises are done") in last
    result = run(folder, "checks.py")
    assert result.returncode == 0 and "10 passed" in result.stdout
    asked = run(folder, "contact.py", "--steps", 5, "--no-rerun")
    for text in (done.stdout, result.stdout, asked.stdout):
        assert text.splitlines()[-1].startswith("all exercises are done")


def test_what_is_wrong_or_broken_fails_its_own_check_and_says_why(copy):
    folder, fill = copy
    fill("ex1", ("PREDICTION = None", "PREDICTION = C"))
    fill("ex2", ("return ...  # TODO: blank 2", 'print("sum", lam + dlam); return lam + dlam'))
    fill("ex3", ("PREDICTION = None", "PREDICTED = 'B'"))
    fill("ex4", ("script.main(__name__)", "script.main("))
    rows = ((f"    {key:<12}?        ?           ?            ?", f"{key} {' '.join(marks)}")
            for key, marks in MARKS.items())  # fmt: skip
    fill("ex9", *rows, ("SAG = None", "SAG = 1.373e-3"))
    fill("ex10", ("return ...  # TODO: blank 2", "return 0.5, gap / dtt"))
    result = run(folder, "checks.py")
    assert result.returncode == 1 and "5 failed, 5 skipped" in result.stdout
    assert all(f"{name}: " in result.stdout for name in ("ex3", "ex5", "ex6", "ex7", "ex8"))
    for words in (
        "ex1_predict_contact.py, line 30, cannot be read: NameError: name 'C' is not defined; "
        "C needs quotes around it", "ex3: no prediction yet", "SyntaxError",
        "likely: nothing keeps the table from pulling", "printed   sum -0.3",
        "blank: write what line 30 of exercises/ex5_solve_contacts.py returns. The task stands",
        "likely: the lowest ball carries those above it",
        "raised NameError: name 'dtt' is not defined\n  line 49: return 0.5, gap / dtt",
    ):  # fmt: skip
        assert words in result.stdout, words
    assert "Traceback" not in result.stdout
    assert not (folder / "outputs/ch3.5-contact/exercises.json").exists(), "none is done"
    words = [sys.executable, folder / FILES["ex1"]]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode and done.stderr.count("\n") == 1 and "needs quotes" in done.stderr


ENDS = [  # what a learner's function does, the state that it comes to, what is said
    ("import os; os.system('clear; echo hi'); return max(0, lam + dlam)", "right", ""),
    ("import sys; print('[]', file=sys.__stdout__); return max(0, lam + dlam)", "right", ""),
    ("print('hi'); return max(0, lam + dlam)", "right", "first of its inputs it\n  printed   hi"),
    ("import sys; sys.stdout.close(); return 1", "wrong", "is wrong on"),
    ("import threading; threading.Thread(target=print, args=[1]).start(); return lam", "wrong",
     "the correction is not used"),
    ("import threading, time; threading.Thread(target=time.sleep, args=[99]).start()\n"
     "return max(0, lam + dlam)", "right", ""),
    ("import subprocess as s, sys; s.Popen([sys.executable, '-c', 'import time; time.sleep(9)'])"
     "\nreturn max(0, lam + dlam)", "right", ""),
    ("import os; os._exit(7)", "wrong", "raised SystemExit: 7\n  line 35: import os; os._exit(7)"),
    ("import os; os.abort()", "wrong", "ended its process (exit status "),
    ("import os, signal; os.kill(os.getpid(), 9)", "wrong", "ended its process (exit status "),
    ("raise KeyboardInterrupt", "wrong", "raised KeyboardInterrupt"),
    ("return input()", "wrong", "raised EOFError"),
    ("return project_impulse(lam, dlam)", "wrong", "raised RecursionError"),
    ("import sys; sys.setrecursionlimit(10**9); return project_impulse(lam, dlam)", "wrong",
     "project_impulse "),
    ("all = []\nwhile True:\n    all.append('x' * 10**7)", "wrong", "raised MemoryError"),
    ("while True:\n    pass", "wrong", "takes too long, or does not end: stopped after 1 s in "),
    ("while max(np.linalg.eigvals(-np.eye(2)).real) <= 1:\n    pass", "wrong", "not its real part"),
]  # fmt: skip


@pytest.mark.parametrize("body, state, words", ENDS)
def test_however_a_learners_code_ends_it_is_said_in_words(
    body, state, words, tmp_path, monkeypatch, capfd
):
    if "append" in body and sys.platform != "linux":
        pytest.skip("only here memory can be limited")
    limit = 1 if body.endswith("pass") else 60
    smaller = f"judge; judge.MOST_MEMORY, judge.LIMIT = 2**31, {limit}; judge."
    monkeypatch.setattr(script, "START", script.START.replace("judge.", smaller))
    monkeypatch.setattr(script, "LIMIT", limit)
    name, blank = ("ex6", "longest_step") if "eigvals" in body else ("ex2", "project_impulse")
    file = tmp_path / Path(FILES[name]).name
    file.write_text(typed(blank, body), "utf-8")
    *_, (_, found, said, _) = script.judged(name, file)[1]
    assert found == state and words in said and "Traceback" not in said, said
    assert capfd.readouterr() == ("", "")
    if state == "wrong" and "kill" not in body:
        assert re.search(r"line \d\d|wrong on", said), "it has its line"


@pytest.mark.parametrize("text", ["5", "null", '[["ex1"]]', "{", "\xff"])
def test_a_file_of_progress_that_lists_nothing_counts_as_none(text, tmp_path, monkeypatch):
    monkeypatch.setattr(script, "DONE", tmp_path / "exercises.json")
    script.DONE.write_text(text, "latin-1")
    assert script.done() == {} and "ex1_" in script.practise()
    script.note("ex1", True)
    assert json.loads(script.DONE.read_text()) == {"ex1": "done"}


def test_a_name_that_no_exercise_has_is_answered_by_those_that_there_are(copy):
    for words in (["checks.py", "-k", "ex2 or ex11"], ["-m", "pytest", "checks.py", "-kex11"]):
        result = python(*words, cwd=copy[0], **NO_PLUGINS)
        printed = result.stdout + result.stderr
        assert result.returncode and "-k ex11: no such exercise; there are ex1_predict" in printed
        assert "Traceback" not in printed


@pytest.mark.skipif(sys.platform == "win32", reason="the README's table is for other systems")
def test_printed_commands_are_those_of_the_readme(monkeypatch):
    readme = (ROOT / "README.md").read_text("utf-8")
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(script, "done", dict)
    monkeypatch.setattr(sys, "executable", str(ROOT / ".venv/bin/python"))
    for uv in (False, True):
        monkeypatch.setenv("UV", "uv") if uv else monkeypatch.delenv("UV", raising=False)
        command = script.practise().removeprefix("next, an exercise: ")
        assert f"`{command}`" in readme and ("uv run exercises" in command) == uv


def test_without_pytest_or_numpy_one_line_says_how_to_get_it(copy):
    folder, _ = copy
    for lacks, file in (("pytest", "checks.py"), ("numpy", FILES["ex1"])):
        result = run(folder, file, lacks=lacks)
        assert result.returncode in (1, 2) and result.stderr.count("\n") == 1, result.stderr
        assert re.search(rf"{lacks}.*: .*(pip install|uv run --with) {lacks}", result.stderr)


# Fills: right ones and every slip


@pytest.mark.parametrize("name", SOLUTIONS)
def test_a_solution_is_right_and_shown_at_work_by_its_flag(name):
    result = python(FILES[name], "--solution")
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.startswith(SOLUTIONS[name].read_text("utf-8"))
    assert f"`python {FILES[name]} --solution`" in result.stdout.splitlines()[0]


RIGHT = [
    ("penalty_normal_force", lambda depth, v_n, stiffness, damping: (
        (depth * stiffness - v_n * damping) * (depth * stiffness > v_n * damping))),
    ("project_impulse", lambda lam, dlam: 0.5 * (lam + dlam + abs(lam + dlam))),
    ("project_impulse", lambda lam, dlam: np.float32(0) if lam < -dlam else lam + dlam),
    ("solve_contacts", contact.solve_contacts),
    ("solve_contacts", lambda contacts, iters: contact.solve_contacts(contacts[::-1], iters)),
    ("time_to_impact", contact.time_to_impact),
    ("time_to_impact", lambda gap, v_n, a_n: min(
        [t for t in np.roots([0.5 * a_n, v_n, gap]) if t.imag == 0 and t.real > 0],
        default=math.inf).real),
    ("longest_step", contact.critical_dt),
    ("step_matrix", lambda m, k, c, dt: (
        np.array([[1, -dt], [0, 1]]) @ np.array([[1, 0], [dt * k / m, 1 - dt * c / m]]))),
    ("implicit_spring", lambda depth, k, c, dt: (
        dt**-2 / (k + c / dt), depth / dt / (1 + c / (k * dt)))),
    ("before_the_move", lambda gap, dt: [np.float64(0.5), 0 - gap / dt]),
    ("after_the_move", lambda lam, then, now: [lam, 0, max(lam, 0.0), now]),
]  # fmt: skip


@pytest.mark.parametrize("blank, function", RIGHT)
def test_a_right_fill_passes_in_every_form(blank, function):
    assert judge.judge(exercise(**{blank: function}), blank) == ("right", "")


@pytest.mark.parametrize("blank", slips.BLANKS)
def test_a_wrong_fill_fails_and_is_named_from_its_values(blank):
    for function, meaning in slips.BLANKS[blank].slips:
        state, words = judge.judge(exercise(**{blank: function}), blank)
        assert state == "wrong" and words.splitlines()[-1] == f"  likely: {meaning}"
        parts = f"{blank} is wrong on ", "the smallest", f"  {blank}(", "got", "expected"
        assert all(part in words for part in parts)
    assert "is no longer a function" in judge.judge(exercise(**{blank: 3}), blank)[1]


SEARCH = """low, high = 0, 2
while high - low > 1e-7:
    mid = (low + high) / 2
    size = max(abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, mid))))
    low, high = (mid, high) if size <= 1 else (low, mid)
return low"""
SWEEP = "for _ in range(iters):\n    for c in contacts:\n        "
VISIT = "add = (c.target - c.v_n()) * c.m_eff; p = max(-c.lam, add); c.lam += p; c.push(p)"
TYPED = [  # what a learner writes in a blank, in a form that no slip of answers.json has
    ("penalty_normal_force", "return float('nan')", "where to look: "),
    ("project_impulse", "lam + dlam", "returned None, and not numbers; does it end with `return`?"),
    ("project_impulse", "return '3'", "returned '3', and not numbers"),
    ("project_impulse", "return type('', (), {'__array__': 3})()", "and not numbers"),
    ("solve_contacts", SWEEP + VISIT, ""),
    ("solve_contacts", "for c in contacts:\n    for _ in range(iters):\n        " + VISIT,
     "each contact is finished before the next one is begun"),
    ("step_matrix", "return [1, 2, 3]", "how many numbers: got 3, expected 2 rows of 2"),
    ("longest_step", SEARCH, ""),
    ("longest_step", SEARCH.replace("abs", "np.real"), "the same step, an end of the search"),
    ("longest_step", SEARCH.replace("<=", ">"), "the same step, an end of the search"),
    ("longest_step", SEARCH.replace("1e-7", "1e-3"), "the search is too coarse"),
    ("before_the_move", "return -gap / dt", "got 1, expected 2"),
    ("time_to_impact", "return (-v_n - math.sqrt(v_n**2 - 2 * gap * a_n)) / a_n", "raised "),
]  # fmt: skip


@pytest.mark.parametrize("blank, body, words", TYPED)
def test_what_a_learner_types_is_named(blank, body, words):
    module = ModuleType("typed")
    module.__file__ = str(ROOT / FILES[slips.BLANKS[blank].exercise])
    exec(typed(blank, body), vars(module))
    if blank == "longest_step":
        module.step_matrix = slips.matrix
    state, said = judge.judge(module, blank)
    assert state == ("wrong" if words else "right") and words in said, said


def test_a_wrong_matrix_does_not_blame_the_search():
    """It waits for the matrix, and a right search passes whatever became of the matrix."""
    right = {name: slips.BLANKS[name].right for name in ("step_matrix", "longest_step")}
    wrong = {name: slips.BLANKS[name].slips[0][0] for name in right}
    state, (first, second) = judge.judged("ex6", exercise(**wrong))
    assert (state, first[1], second[1]) == ("wrong", "wrong", "blank")
    assert second[2] == "longest_step is tried once step_matrix is right"
    _, found = judge.judged("ex6", exercise(**right | {"longest_step": wrong["longest_step"]}))
    assert [state for _, state, *_ in found] == ["right", "wrong"]


def test_a_fill_that_stops_in_a_trial_is_not_right():
    right = slips.BLANKS["implicit_spring"].right

    def spring(depth, stiffness, damping, dt, most=math.inf):
        return right(depth, stiffness, damping, dt) if depth < most else 1 / 0

    stops = exercise(implicit_spring=partial(spring, most=0.051))
    state, ((_, _, words, _),) = judge.judged("ex7", stops)
    assert state == "wrong" and "a trial of implicit_spring stopped: ZeroDivisionError" in words
    _, ((_, state, _, shown),) = judge.judged("ex7", exercise(implicit_spring=spring))
    assert state == "right" and "nan" not in shown
    assert shown.splitlines()[-2].split()[-1] == "-", "penalty has exploded, so it rests nowhere"


def test_yours_stands_beside_what_it_is_compared_with():
    """Wrong clamps, a limit of 7 ms, a spring that is none, a bet with one off."""
    own = [judge.height(trial) for trial in [*judge.TRIALS][1:3]]
    assert own[0] == pytest.approx(2 / 3 * 2.04 * 0.408 / 1.2, abs=0.01)  # a parabola, then at rest
    for clamp in (lambda lam, dlam: 0, lambda lam, dlam: lam + dlam, lambda lam, dlam: abs(dlam)):
        shown = judge.compare(exercise(project_impulse=clamp), "project_impulse")
        heads, *rows = (line.split()[-2:] for line in shown.splitlines())
        mine, other = ([float(cell) for cell in column] for column in zip(*rows))
        assert heads == ["yours", "contact.py"] and mine != other == own
    shown = judge.cliffs(exercise(longest_step=lambda mass, stiffness, damping: 0.007), None)
    assert shown.splitlines()[2].split()[4:] == ["0.00700", "s", "0.01354", "s", "0.02000", "s"]
    none = exercise(implicit_spring=lambda depth, stiffness, damping, dt: (1e300, 0.0))
    drop = contact.build_scene("drop")
    run = contact.run_model("penalty", drop, 0.016, 500)
    gained = contact.contact_quality(run, drop, 0.016)["energy_excess"]
    assert judge.drops(none, None).splitlines()[3].split()[3:5] == ["0", f"{gained:.5g}"]
    lines = [f"{trouble} {' '.join(marks)}" for trouble, marks in MARKS.items()]
    for off, count in ((lines[0], 20), (lines[0].replace("=", "-", 1), 19)):
        made = exercise("ex9", BETS="\n".join([off, *lines[1:]]).replace("-", "\N{MINUS SIGN}"))
        _, state, words, _ = bets.judge_knobs("ex9", made)
        assert state == "right" and f"holds in {count} of 20;" in words


def test_asking_twice_is_leapfrogs_step_and_a_slip_of_it_is_seen_beside_exact():
    """What lasts, in plain sweeps; errors in r, the height of what is thrown, the order."""
    right = {name: slips.BLANKS[name].right for name in ("before_the_move", "after_the_move")}

    def seen(**fills):
        made = exercise("ex10", **right | fills)
        shown = judge.ask_twice(made, None).splitlines()[1:6]
        numbers = [float(line.split()[-2]) for line in shown]
        return [*numbers, math.log(max(numbers[2], 1e-16) / max(numbers[3], 1e-16), 4)]

    drop, stack, slide, shorter, height, order = seen()
    assert drop < 1e-12 and stack < 1e-5 and slide < 1e-3 and shorter < 1e-4
    assert height < 3.1 and order == pytest.approx(2.0, rel=FACTS["ex10"]["number"]["within"])
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
    ({"MODEL": "hard"}, "MODEL: given 'hard'; allowed: 'penalty', 'implicit' or 'soft'"),
    ({"MODEL": "lcp"}, "lcp, leapfrog and exact are not asked for: their contacts are rigid"),
    ({"DT": 0.0001}, "DT: given 0.0001; allowed: from 0.0005 s (2,000 steps)"),
    ({"DT": "fast"}, "DT: given 'fast'; allowed: from"),
    ({"STIFFNESS": -1, "DAMPING": math.nan}, "above 0\nDAMPING: given nan; allowed: "),
    ({"SOLREF": 0.005}, "SOLREF: given 0.005; allowed: two numbers"),
    ({"SOLIMP": (0.9, 0.95)}, "SOLIMP: given (0.9, 0.95); allowed: five numbers"),
])  # fmt: skip
def test_the_gripper_is_judged_by_what_it_does(choice, part):
    made = exercise(**FINGERS | {"MODEL": "soft"} | choice)
    _, state, words, _ = judge.judge_fingers("ex8", made)
    assert state == ("wrong" if part else "right") and (part is None or part in words), words


def test_what_ex8_says_of_rigid_contacts_is_so():
    cup = contact.scene_of([-0.205, 0.0, 0.205], 0.1, [0.2, 1.0, 0.2])
    for model in ("lcp", "leapfrog"):

        def step(balls, step=contact.step_of(model, cup, 0.004, contact.Settings())):
            balls[0].fx, balls[2].fx = 20.0, -20.0
            return step(balls)

        q = contact.simulate(step, cup, 0.004, 250).q
        assert contact.smallest_gap(q, cup.radius).min() > -1e-12 and abs(q[-1]).max() < 0.21


# Bets


@pytest.mark.parametrize("name", ASKED)
def test_a_bet_waits_for_choice_and_reason_and_then_there_is_a_word_on_every_choice(name):
    choices, right = ASKED[name]["choices"], bets.answer(name, bets.measure(name))

    def judged(prediction, why):
        _, *found = bets.judge_bet(name, exercise(name, PREDICTION=prediction, WHY=why))
        return found

    for prediction, why, part in (
        (None, "", "no prediction yet"),
        ("D", "so it has to be", "PREDICTION is 'D'; write one of 'A', 'B', 'C' in "),
        ("A", "because", "WHY is 'because'; write a sentence of four words or more in "),
    ):
        state, words, shown = judged(prediction, why)
        assert state == "blank" and part in words and shown == ""
    assert words.endswith(f". {ASKED[name]['why']}") and "?" in ASKED[name]["why"]
    for mine in "ABC":
        state, text, _ = judged(mine, "so it has to be")
        text = " ".join(text.split())
        assert state == "right" and ("That is what happens." in text) == (mine == right)
        assert text.index(f"Why {right}:") < text.index("Why not"), "the right one first"
        assert all(f"Why {c}:" in text if c == right else f"Why not {c}:" in text for c in choices)
        assert "{" not in text and choices[right] in text and [*choices] == ["A", "B", "C"]


# Keys, reasons and captions come from measurements


RIGHT_WORDS = {"ex1": "four times as deep", "ex3": "the light ball, and the heavy one gains none"}
PHYSICS = {"k": 1e4, "g": 9.81, "K": 1.0 / (0.95 * 0.02) ** 2}


@pytest.mark.parametrize("name", [*ASKED, "ex9"])
def test_keys_formulas_and_numbers_are_those_measured(name):
    measured = bets.measure(name) if name in ASKED else bets.measure_knobs()[1]
    if name in ASKED:
        assert RIGHT_WORDS[name] in ASKED[name]["choices"][bets.answer(name, measured)]
        assert "README's first line" in FACTS[name]["shown"].format(**measured)
    else:  # no share lies near the borders of what a mark means
        shares = bets.measure_knobs()[0]
        assert {trouble: [*map(bets.mark, row)] for trouble, row in shares.items()} == MARKS
        assert all(x < 0.4 or 0.95 < x < 1.05 or x > 4.0 for row in shares.values() for x in row)
    depth, mass = {"ex1": ("penalty_at_rest", 4.0), "ex9": ("sink", 1.0)}.get(name, ("limit", 0))
    values = PHYSICS | {"depth": 0.1 * measured[depth], "m": mass}
    for text in FACTS[name]["reasons"].values():
        for formula in re.findall(r"`([^`]+=[^`]+)`", text):
            code = re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", formula.replace("^", "**"))
            left, right = (eval(side, {}, values) for side in code.split("="))
            assert left == pytest.approx(right, rel=1e-4), formula
        typed = set(re.findall(r"\d+", re.sub(r"\{[^}]*\}|`[^`]*`", "", text)))
        assert typed <= {"1"}, f"a number that nobody measured in: {text}"
        text.format(**measured)


def test_what_is_bet_on_is_what_is_run_and_what_no_command_has_shown():
    """The docstrings' balls and steps; README, docstrings and set-up drop 1 kg."""
    for name, words, balls in (
        ("ex1", ["4 kg", "half a metre", "4 s"], {(4.0, 0.65, 0.002)}),
        ("ex3", ["0.1 kg", "10 kg", "0.03 s"], {(0.1, 0.65, 0.03), (10.0, 0.65, 0.03)}),
    ):
        assert all(each in GIVEN[name].__doc__ for each in words)
        rows = {row[2:] for label, row in bets.BETS[name][2].items() if "shown" not in label}
        assert rows == balls
    files = "README.md", "contact.py", *FILES.values()
    texts = "\n".join((ROOT / file).read_text("utf-8") for file in files)
    for command in re.findall(r"contact\.py (--[^`\n#]*)", texts):
        assert "--mass" not in command or "--contact soft" in command


@pytest.mark.parametrize("name", ["ex4", "ex9", "ex10"])
def test_a_number_is_what_paper_gives_and_each_slip_of_it_is_named(name):
    facts = FACTS[name]["number"]
    law = getattr(slips.RIGHT[name], facts["name"])
    for given, state, words in (
        (law, "right", ""), (-law, "right", ""), (f" {law:.3g}", "right", ""),
        (None, "blank", f"no {facts['name']} yet"), ("deep", "blank", "given 'deep'; write a num"),
        (0.5432, "wrong", "and it is another; --hint"), (math.nan, "wrong", "given nan"),
        *((eval(text), "wrong", f"likely: {meaning}") for text, meaning in facts["slips"].items()),
    ):  # fmt: skip
        found = judge.judge_number(name, exercise(name, **{facts["name"]: given}))
        assert found[1] == state and words in found[2], (given, found)


@pytest.mark.parametrize("name, model", [("ex4", "soft"), ("ex9", "lcp")])
def test_a_number_is_what_its_command_prints(name, model, tmp_path):
    (command,) = re.findall(r"^    python (contact.py .*)$", GIVEN[name].__doc__, re.MULTILINE)
    printed = python(*shlex.split(command), "--no-rerun", "--out", tmp_path).stdout.splitlines()
    heads, row = (next(x for x in printed if word in x).split() for word in ("gap/r", model))
    law = getattr(slips.RIGHT[name], FACTS[name]["number"]["name"])
    assert float(row[1 + heads.index("gap/r")]) == pytest.approx(-law, rel=5e-3)


# The next chapter


def test_the_finger_of_the_next_chapter_feels_what_it_pushes():
    """Three balls of 2 N drag each, and impulses that add up to what the balls gained."""
    example = load(ROOT / "exercises/next_chapter.py")
    for model in contact.STEPPED:
        run, force = example.push(model)
        assert sum(force[-500:]) / 500 == pytest.approx(-6.0, rel=1e-3), model
        assert run.v[-1, 0] == pytest.approx(0.3, abs=0.01) and force[0] == 0.0
    printed = python("exercises/next_chapter.py").stdout
    assert printed.count("-6.00") == len(contact.STEPPED)


# What the chapter says, and when


GIVEAWAYS = {
    "ex1": r"\bsinks?\b|rests? (a little )?inside|m g ?/ ?k|\brings?\b|\bhops?\b|\bdives?\b",
    "ex3": r"\b(penalty|spring)\b.{0,80}(explod|blows? up)|critical (time )?step|unstable|"
    r"stays bounded|\bcliff\b",
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


@pytest.mark.parametrize("file", FILES.values())
def test_an_exercise_gives_nothing_away(file):
    text = (ROOT / file).read_text("utf-8")
    for giveaway in ("m g / k", "max(", "clamp", "sqrt", "0.25", "1409", "0.0036", "0.00118"):
        assert giveaway not in text
    head = r'(# .*\n)+"""Exercise \d+, [\w ]+ \(\d+ minutes\): .+[.?]\n'
    assert re.match(head, text) and "--hint" in text
