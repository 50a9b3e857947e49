"""The exercises: untouched they wait, right answers pass in every form, wrong ones are named.

Needs numpy and pytest and nothing else, as a learner has them.
"""

import inspect
import math
import re
import shutil
import subprocess
import sys
from textwrap import indent
from types import ModuleType, SimpleNamespace

import pytest

from curriculum.tests.helpers import NO_PLUGINS, ROOT, python

sys.path.insert(0, str(ROOT / "exercises"))

from kit import FACTS, bets, judge, load, script, trials  # noqa: E402
from kit.script import FILES  # noqa: E402

import contact  # noqa: E402

GIVEN = {name: load(ROOT / file) for name, file in FILES.items()}  # with blanks
SOLUTIONS = {name: (ROOT / f"exercises/solutions/{name}.py").read_text("utf-8") for name in FILES}
ASKED = {name: bets.asked(GIVEN[name].__doc__) for name in ("ex1", "ex3")}
OF = {blank: name for name, each in FACTS.items() for blank in each.get("blanks", ())}
RIGHT = {name: bets.RIGHT[name] for name in OF}
CALL = "script.main(__name__)"


def exercise(name="ex2", **written):
    return SimpleNamespace(__file__=str(ROOT / FILES[name]), **written)


def typed(blank, body):
    """The text of a solution in which a learner has written this for one function of it."""
    given = ", ".join(inspect.signature(RIGHT[blank]).parameters)
    return f"{SOLUTIONS[OF[blank]]}\n\ndef {blank}({given}):\n{indent(body, '    ')}\n"


def judged(name, text):
    """What is said of this text in the place of an exercise's."""
    module = ModuleType(name)
    module.__file__ = str(ROOT / FILES[name])
    exec(text, vars(module))
    return judge.judged(name, module)


@pytest.fixture
def copy(tmp_path):
    """A learner's copy of what the exercises need, in a folder with a space and a quote."""
    folder = tmp_path / "my robot's course"
    leave = shutil.ignore_patterns(
        ".*", "__pycache__", "outputs", "tests", "bench", "page", "fast.py"
    )
    return shutil.copytree(ROOT, folder, ignore=leave)


def run(folder, *words):
    return python(*words, cwd=folder, **NO_PLUGINS)


def test_a_script_prints_its_task_a_hint_or_a_solution_anywhere_and_without_docstrings(tmp_path):
    for name, whole in (("ex1", True), ("ex2", False)):
        result = run(tmp_path, "-OO", ROOT / FILES[name])
        task = GIVEN[name].__doc__.strip()
        assert result.stdout.startswith(task if whole else task.split("\n")[0])
        assert (result.returncode, result.stderr) == (2, "")
    result = run(tmp_path, ROOT / FILES["ex2"], "--hint", 3)
    assert result.stdout == f"hint 3 of 4: {FACTS['ex2']['hints'][2]}\n"
    result = run(tmp_path, ROOT / FILES["ex2"], "--hint", 0)
    assert result.returncode == 2 and "error: argument --hint: invalid choice" in result.stderr
    result = run(tmp_path, ROOT / FILES["ex4"], "--solution")
    assert result.returncode == 0 and result.stdout.startswith(SOLUTIONS["ex4"])
    assert "rests 0.04905 r deep" in result.stdout


@pytest.mark.parametrize("name", FILES)
def test_an_exercise_asks_and_gives_nothing_away(name):
    text = (ROOT / FILES[name]).read_text("utf-8")
    for giveaway in ("m g / k", "max(", "clamp", "sqrt", "0.25", "1409", "0.0036", "0.00118"):
        assert giveaway not in text
    head = r'(# .*\n)+"""Exercise \d+, [\w ]+ \(\d+ minutes\): .+[.?]\n'
    assert re.match(head, text) and f"\n{CALL}\n" in text
    for hint in FACTS[name]["hints"]:
        assert "?" in hint and not re.search(r"[=*/]|max\(", hint)


def test_a_learners_way_through_all_ten(copy, tmp_path):
    """Each script says what is next, by a command that works as it is printed, in an odd folder."""
    any_run = "contact.py", "--steps", 5, "--no-rerun", "--out", tmp_path
    printed = run(copy, *any_run).stdout
    for name, file in FILES.items():
        command = printed.splitlines()[-1].removeprefix("next, an exercise: ")
        assert file in command
        shutil.copy(copy / file, f"{copy / file}~")  # as editors leave one
        task = (copy / file).read_text("utf-8").split(CALL)[0]
        (copy / file).write_text(f"{task}{CALL}\n\n{SOLUTIONS[name]}", "utf-8")
        printed = subprocess.run(command, shell=True, cwd=copy, capture_output=True, text=True)
        assert printed.returncode == 0 and not printed.stderr, printed
        printed = printed.stdout
        assert f"solutions/{name}.py" in printed
    result = run(copy, "checks.py")
    assert result.returncode == 0 and "10 passed" in result.stdout
    for text in (printed, result.stdout, run(copy, *any_run).stdout):
        assert text.splitlines()[-1].startswith("all exercises are done")


WRITTEN = [  # an exercise, what stands there, what a learner makes of it, what is said of that LINE
    ("ex1", "PREDICTION = None", "PREDICTION = C",
     "cannot be read, C needs quotes around it: NameError: name 'C' is not defined\n  line LINE: "),
    ("ex2", "...  # TODO: blank 2", "lam + dlam", "likely: nothing keeps the table from pulling"),
    ("ex3", "PREDICTION = None", "PREDICTED = 'B'", "ex3: no prediction yet"),
    ("ex4", CALL, CALL[:-1], "cannot be read: SyntaxError: "),
    ("ex5", "def solve_contacts", "def solve", "solve_contacts is no longer a function of yours"),
    ("ex7", "return ...  #", "return ... #", "is still a blank: write what line LINE returns"),
    ("ex8", "MODEL = None", "MODEL = 'lcp'", "lcp, leapfrog and exact are not asked for"),
    ("ex9", " = None  # r", " = 1  # r", "row sink: given ? ? ? ?, allowed: four marks, each - ("),
    ("ex10", "return ...  # TODO: blank 2", "return 0.5, gap / dtt",
     "raised NameError: name 'dtt' is not defined\n  line LINE: return 0.5, gap / dtt"),
]  # fmt: skip


def test_what_is_wrong_or_broken_fails_its_own_check_and_says_why(copy):
    words = []
    for name, old, new, said in WRITTEN:
        above, below = (copy / FILES[name]).read_text("utf-8").split(old)
        (copy / FILES[name]).write_text(above + new + below, "utf-8")
        words.append(said.replace("LINE", str(1 + above.count("\n"))))
    result = run(copy, "checks.py")
    assert result.returncode == 1 and "7 failed, 3 skipped" in result.stdout
    for said in words:
        assert said in result.stdout, said
    assert "Traceback" not in result.stdout
    result = run(copy, FILES["ex1"])
    assert result.returncode == 1 and "needs quotes" in result.stdout and not result.stderr


SCAN = """dt = 1e-4
while max(np.linalg.eigvals(step_matrix(mass, stiffness, damping, dt)).real) <= 1:
"""
ENDS = [  # what a learner's function does, what is said
    ("import os; os.system('clear; echo hi'); return max(0, lam + dlam)", "is right"),
    ("import sys; print('[]', file=sys.__stdout__); return max(0, lam + dlam)", "is right"),
    ("print('hi'); return max(0, lam + dlam)", "project_impulse is right\n  printed   hi"),
    ("import sys; sys.stdout.close(); return 1", "is wrong on"),
    ("import threading, time; threading.Thread(target=time.sleep, args=[99]).start()\n"
     "return max(0, lam + dlam)", "is right"),
    ("import os; os._exit(7)", "ended its process (exit status 7), see "),
    ("import os; os.abort()", "ended its process (exit status "),
    ("return input()", "raised EOFError"),
    ("return project_impulse(lam, dlam)", "raised RecursionError"),
    ("import sys; sys.setrecursionlimit(10**9); return project_impulse(lam, dlam)",
     "project_impulse "),
    ("all = []\nwhile True:\n    all.append('x' * 10**7)", "raised MemoryError"),
    (SCAN + "    dt += 1e-4\nreturn dt", "size of an eigenvalue is above 1, not its real part"),
    ("while True:\n    pass", "takes too long, or does not end: stopped after 2 s in "),
]  # fmt: skip


@pytest.mark.parametrize("body, words", ENDS)
def test_however_a_learners_code_ends_it_is_said_in_words(
    body, words, tmp_path, monkeypatch, capfd
):
    if "append" in body and sys.platform != "linux":
        pytest.skip("only here memory can be limited")
    limit = 2 if body.endswith("pass") else 60
    smaller = f"judge.MOST_MEMORY, judge.MOST_EVENTS, judge.LIMIT = 2**31, 10**5, {limit}; judge."
    monkeypatch.setattr(script, "START", script.START.replace("judge.", smaller))
    monkeypatch.setattr(script, "LIMIT", limit)
    name, blank = ("ex6", "longest_step") if SCAN in body else ("ex2", "project_impulse")
    file = tmp_path / f"{name}_mine.py"
    other = "\n\ndef penalty_normal_force(*_):\n    return ...\n"
    file.write_text(typed(blank, body) + other, "utf-8")
    state, said = script.judged(name, file)
    assert words in said and "Traceback" not in said, said
    assert capfd.readouterr() == ("", "")
    if state == "wrong" and limit == 60:  # a process that begins slowly has no line yet
        assert re.search(r"line ([2-9]|\d\d)|wrong on", said), "it has its line"


def test_a_name_that_no_exercise_has_is_answered_by_those_that_there_are():
    for words in (["checks.py", "-k", "ex2 or ex11"], ["-m", "pytest", "checks.py", "-kex11"]):
        result = run(ROOT, *words)
        printed = result.stdout + result.stderr
        assert result.returncode and "-k ex11: no such exercise; there are ex1_predict" in printed
        assert "Traceback" not in printed


@pytest.mark.skipif(sys.platform == "win32", reason="the README's table is for other systems")
def test_printed_commands_are_those_of_the_readme(monkeypatch):
    readme = (ROOT / "README.md").read_text("utf-8")
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "executable", str(ROOT / ".venv/bin/python"))
    for uv in (False, True):
        monkeypatch.setenv("UV", "uv") if uv else monkeypatch.delenv("UV", raising=False)
        command = script.practise().removeprefix("next, an exercise: ")
        assert f"`{command}`" in readme and ("uv run exercises" in command) == uv


def test_without_pytest_or_numpy_one_line_says_how_to_get_it():
    for lacks, file in (("pytest", "checks.py"), ("numpy", FILES["ex1"])):
        start = f"import sys, runpy; sys.modules[{lacks!r}] = None; sys.path[0] = 'exercises'; "
        result = run(ROOT, "-c", f"{start}runpy.run_path({file!r}, run_name='__main__')")
        assert result.returncode in (1, 2) and result.stderr.count("\n") == 1, result.stderr
        assert re.search(rf"{lacks}.*: .*(pip install|uv run --with) {lacks}", result.stderr)


# What a learner writes: right in every form, wrong and named


HALVES = """low, high = 0, 2
while high - low > 1e-7:
    mid = (low + high) / 2
    size = max(abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, mid))))
    low, high = (mid, high) if size <= 1 else (low, mid)
return low"""
SWEEP = "for _ in range(iters):\n    for c in contacts:\n        "
VISIT = "add = (c.target - c.v_n()) * c.m_eff; p = max(-c.lam, add); c.lam += p; c.push(p)"
TYPED = [  # a function, what a learner writes in it, what is said: "" where it is right
    ("penalty_normal_force", "return float('nan')", "a question that helps: "),
    ("penalty_normal_force", "f = stiffness * depth - damping * v_n\nreturn f * (f > 0)", ""),
    ("project_impulse", "return 0.5 * (lam + dlam + abs(lam + dlam))", ""),
    ("project_impulse", "lam + dlam", "returned None, and not numbers; does it end with `return`?"),
    ("project_impulse", "return '3'", "returned '3', and not numbers"),
    ("project_impulse", "return type('', (), {'__array__': 3})()", "and not numbers"),
    ("solve_contacts", SWEEP + VISIT, ""),
    ("solve_contacts", SWEEP.replace("contacts", "contacts[::-1]") + VISIT, ""),
    ("solve_contacts", "for c in contacts:\n    for _ in range(iters):\n        " + VISIT,
     "each contact is finished before the next one is begun"),
    ("step_matrix", "k, c, way = stiffness / mass, damping / mass, np.array([[1, -dt], [0, 1]])\n"
     "return way @ np.array([[1, 0], [dt * k, 1 - dt * c]])", ""),
    ("step_matrix", "return [1, 2, 3]", "how many numbers: got 3, expected 2 rows of 2"),
    ("longest_step", HALVES, ""),
    ("longest_step", "return [1.0, 2.0]", "how many numbers: got 2, expected 1"),
    ("longest_step", HALVES.replace("abs", "np.real"), "the same step, an end of the search"),
    ("longest_step", HALVES.replace("<=", ">"), "the same step, an end of the search"),
    ("longest_step", HALVES.replace("1e-7", "1e-3"), "the search is too coarse"),
    ("longest_step", SCAN + "    dt *= 1.01\nreturn dt", "size of an eigenvalue is above 1, not"),
    ("implicit_spring", "k, c = stiffness, damping\n"
     "return dt**-2 / (k + c / dt), depth / dt / (1 + c / (k * dt))", ""),
    ("implicit_spring", "if (stiffness, damping) == (1e4, 80.0):\n    1 / 0\n"
     "k = stiffness * dt + damping\nreturn 1 / (dt * k), stiffness * depth / k",
     "a trial of implicit_spring stopped: ZeroDivisionError"),
    ("time_to_impact", "import contact\nreturn contact.time_to_impact(gap, v_n, a_n)", ""),
    ("time_to_impact", "return (-v_n - math.sqrt(v_n**2 - 2 * gap * a_n)) / a_n", "raised "),
    ("before_the_move", "return [1 / 2, 0 - gap / dt]", ""),
    ("before_the_move", "return -gap / dt", "got 1, expected 2"),
    ("after_the_move", "return [bool(lam), 0, max(lam, 0.0), now]", ""),
    ("step_matrix", "return [[1, -dt], [dt * stiffness / mass, 1]]",  # the search is not blamed
     "longest_step is tried once step_matrix is right"),
]  # fmt: skip


@pytest.mark.parametrize("blank, body, words", TYPED)
def test_what_a_learner_types_is_right_in_every_form_and_wrong_in_words(blank, body, words):
    state, said = judged(OF[blank], typed(blank, body))
    assert state == ("wrong" if words else "right"), said
    assert (words or f"{blank} is right") in said, said


@pytest.mark.parametrize("blank", OF)
def test_each_slip_is_named_from_its_values(blank):
    for slip, meaning in judge.BLANKS[blank]["slips"].items():
        state, words = judge.judge(judge.slipped(blank, slip), blank, "ex.py")
        assert state == "wrong" and words.splitlines()[-1] == f"  likely: {meaning}", slip
        assert f"{blank} is wrong on " in words and "the smallest" in words
        assert f"  {blank}(" in words and "expected" in words


def column(table, title):
    """The numbers of a column of contact.py's table, by the names of its rows."""
    heads, *rows = (re.split(r"\s{2,}", line) for line in table.splitlines() if "  " in line[1:])
    where = heads.index(title)
    return {row[0]: float(row[where].replace(",", "")) for row in rows if len(row) == len(heads)}


def test_yours_stands_beside_what_it_is_compared_with():
    for blank, wrong in (
        ("penalty_normal_force", lambda depth, v_n, stiffness, damping: stiffness * depth),
        ("project_impulse", lambda lam, dlam: lam + dlam),
        ("solve_contacts", lambda contacts, iters: None),
    ):
        for function, same in ((RIGHT[blank], True), (wrong, False)):
            shown = trials.SHOWN[blank](exercise(**{blank: function})).splitlines()
            assert (shown[1].split()[1:] == shown[2].split()[1:]) == same
    shown = trials.cliffs(exercise(longest_step=lambda mass, stiffness, damping: 0.007))
    assert shown.splitlines()[2].split()[4:] == ["0.00700", "0.01354", "0.02000"]
    gained = column(trials.drops(exercise(**RIGHT)), "energy+")
    assert gained["yours, 0.016 s"] == 0.0 and gained["penalty, 0.016 s"] > 10.0


def test_asking_twice_is_leapfrogs_step_and_a_slip_of_it_is_seen_beside_exact():
    """Errors in r, what an overlap throws, the order of the slide."""

    def seen(**fills):
        table = trials.ask_twice(exercise("ex10", **RIGHT | fills))
        off = column(table, "off/r")
        order = math.log(off["yours, slide"] / off["yours, slide, dt / 4"], 4)
        return off["yours, drop"], off["yours, stack"], off["yours, inside"], order

    drop, stack, thrown, order = seen()
    assert drop < 1e-12 and stack < 1e-5 and thrown < 0.6
    assert order == pytest.approx(2.0, rel=FACTS["ex10"]["number"]["within"])
    assert seen(before_the_move=lambda gap, dt: (1, -gap / dt))[3] < 1.1
    assert seen(after_the_move=lambda lam, then, now: (lam > 0, 0, lam, then))[3] < 1.5
    assert seen(after_the_move=lambda lam, then, now: (lam > 0, 0, 0, now))[2] > 100


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
    ({"MODEL": "implicit", "DAMPING": 8e3}, "it settles in about c / k = 0.8 s"),
    ({"MODEL": "hard"}, "MODEL: given 'hard'; allowed: penalty, implicit, soft"),
    ({"MODEL": "lcp"}, "lcp, leapfrog and exact are not asked for: their contacts are rigid"),
    ({"DT": 0.0001}, "given DT = 0.0001, STIFFNESS = 10000; allowed: DT from 0.0005 to"),
    ({"DAMPING": math.nan}, "damping: given nan; allowed: a number from 0 to"),
])  # fmt: skip
def test_the_gripper_is_judged_by_what_it_does(choice, part):
    given = {name: value for name, value in vars(GIVEN["ex8"]).items() if name.isupper()}
    state, words = judge.judged("ex8", exercise(**given | {"MODEL": "soft"} | choice))
    assert state == ("wrong" if part else "right") and (part or "it holds still") in words, words


# Bets, and numbers from paper


@pytest.mark.parametrize("name", ASKED)
def test_a_bet_waits_for_choice_and_reason_and_then_there_is_a_word_on_every_choice(name):
    choices, right = ASKED[name]["choices"], bets.SOLVED[name].PREDICTION
    for prediction, why, part in (
        (None, "", "no prediction yet"),
        ("D", "so it has to be", "PREDICTION is 'D'; write one of 'A', 'B', 'C' in "),
        ("A", "because", "WHY is 'because'; write a sentence of four words or more in "),
    ):
        state, words = bets.judge_bet(name, exercise(name, PREDICTION=prediction, WHY=why))
        assert state == "blank" and part in words
    assert words.endswith(f". {ASKED[name]['why']}") and "?" in ASKED[name]["why"]
    for mine in ("A", " b) ", "C"):
        made = exercise(name, PREDICTION=mine, WHY="so it has to be")
        state, words = bets.judge_bet(name, made)
        text = " ".join(words.split())
        assert state == "right" and ("That is what happens." in text) == (mine == right)
        assert re.findall(r"Why (not )?([ABC]):", text)[0] == ("", right), "the right one first"
        assert sorted(re.findall(r"Why not ([ABC]):", text)) == sorted(set(choices) - {right})
        assert "{" not in text and choices[right] in text and [*choices] == ["A", "B", "C"]


def test_twenty_bets_are_counted():
    lines = bets.RIGHT["BETS"].splitlines()[2:]
    for off, count in ((lines[0], 20), (lines[0].replace("=", "-", 1), 19)):
        made = exercise("ex9", BETS="\n".join([off, *lines[1:]]).replace("-", "\N{MINUS SIGN}"))
        state, words = bets.judge_knobs("ex9", made)
        assert state == "right" and f"holds in {count} of 20;" in words


PHYSICS = {"k": 1e4, "g": 9.81, "K": 1.0 / (0.95 * 0.02) ** 2}


def test_the_right_letters_are_what_is_measured_and_no_mark_lies_near_its_border():
    found = SimpleNamespace(**bets.measure("ex1"))
    assert "four times as deep" in ASKED["ex1"]["choices"][bets.SOLVED["ex1"].PREDICTION]
    assert found.penalty_at_rest == pytest.approx(4.0 * found.penalty_shown_at_rest, rel=0.01)
    assert found.lcp_at_rest < 1e-6
    found = SimpleNamespace(**bets.measure("ex3"))
    words = "the light ball, and the heavy one gains none"
    assert words in ASKED["ex3"]["choices"][bets.SOLVED["ex3"].PREDICTION]
    assert found.penalty_light > 10.0 and found.penalty_heavy < 1.0
    assert found.lcp_light < 1.0 and found.lcp_heavy < 1.0
    shares = [x for row in bets.measure_knobs()[0].values() for x in row]
    assert all(x < 0.4 or 0.95 < x < 1.05 or x > 4.0 for x in shares)


@pytest.mark.parametrize("name", [*ASKED, "ex9"])
def test_formulas_and_numbers_of_reasons_are_those_measured(name):
    measured = bets.measure(name) if name in ASKED else bets.measure_knobs()[1]
    depth, mass = {"ex1": ("penalty_at_rest", 4.0), "ex9": ("sink", 1.0)}.get(name, ("limit", 0))
    values = PHYSICS | {"depth": 0.1 * measured[depth], "m": mass}
    for text in FACTS[name]["reasons"].values():
        for formula in re.findall(r"`([^`]+=[^`]+)`", text):
            code = re.sub(r"(?<=[\w)]) (?=[\w(])", " * ", formula.replace("^", "**"))
            left, right = (eval(side, {}, values) for side in code.split("="))
            assert left == pytest.approx(right, rel=1e-4), formula
        quoted = set(re.findall(r"\d+", re.sub(r"\{[^}]*\}|`[^`]*`", "", text)))
        assert quoted <= {"1"}, f"a number that nobody measured in: {text}"
        text.format(**measured)


def test_what_is_bet_on_is_what_is_run_and_what_no_command_has_shown():
    """The docstrings' balls and steps; README, docstrings and set-up drop 1 kg."""
    for name, words, balls in (
        ("ex1", ["4 kg", "half a metre", "4 s"], {(4.0, 0.65, 0.002)}),
        ("ex3", ["0.1 kg", "10 kg", "0.03 s"], {(0.1, 0.65, 0.03), (10.0, 0.65, 0.03)}),
    ):
        assert all(each in GIVEN[name].__doc__ for each in words)
        rows = FACTS[name]["measured"].items()
        rows = {(x["mass"], x["y"], x["dt"]) for label, x in rows if "shown" not in label}
        assert rows == balls
    for file in ("README.md", "contact.py"):
        commands = re.findall(r"contact\.py (--[^`\n#]*)", (ROOT / file).read_text("utf-8"))
        assert commands and not any("--mass" in command for command in commands)


@pytest.mark.parametrize("name", ["ex4", "ex9", "ex10"])
def test_a_number_is_what_paper_gives_and_each_slip_of_it_is_named(name):
    facts = FACTS[name]["number"]
    law = bets.RIGHT[facts["name"]]
    for given, state, words in (
        (law, "right", ""), (-law, "right", ""), (f" {law:.3g}", "right", ""),
        (None, "blank", f"no {facts['name']} yet"), ("deep", "blank", "given 'deep'; write a num"),
        (0.5432, "wrong", "and it is another\n  a question"), (math.nan, "wrong", "given nan"),
        *((eval(text), "wrong", f"likely: {meaning}") for text, meaning in facts["slips"].items()),
    ):  # fmt: skip
        found = bets.judge_number(name, exercise(name, **{facts["name"]: given}))
        assert found[0] == state and words in found[1], (given, found)


@pytest.mark.parametrize("name, model", [("ex4", "soft"), ("ex9", "lcp")])
def test_a_number_is_what_its_command_prints(name, model, tmp_path):
    (flags,) = re.findall(r"^    (--.*)$", GIVEN[name].__doc__, re.MULTILINE)
    words = "contact.py", *flags.split(), "--no-rerun", "--out", tmp_path
    printed = python(*words).stdout.splitlines()
    heads, row = (next(x for x in printed if word in x).split() for word in ("gap/r", model))
    law = bets.RIGHT[FACTS[name]["number"]["name"]]
    assert float(row[1 + heads.index("gap/r")]) == pytest.approx(-law, rel=5e-3)


def test_the_finger_of_the_next_chapter_feels_what_it_pushes():
    """Three balls of 2 N drag each, by every model that steps."""
    printed = python("-W", "error", "exercises/next_chapter.py").stdout.splitlines()
    assert [line.split()[0] for line in printed] == contact.STEPPED
    for line in printed:
        *x, force = map(float, re.findall(r"-?\d+\.\d*", line))
        assert force == pytest.approx(-6.0, rel=1e-3)
        assert x == pytest.approx([1.0, 1.2, 1.4, 1.6], abs=0.01)


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
