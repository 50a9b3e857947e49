"""The exercises: untouched they wait, right answers pass in every form, wrong ones are named.

Needs numpy and pytest and nothing else, as a learner has them.
"""

import inspect
import json
import math
import re
import subprocess
import sys
from textwrap import indent
from types import SimpleNamespace

import pytest

from curriculum.tests.helpers import NO_PLUGINS, ROOT, clone, python

sys.path.insert(0, str(ROOT / "exercises"))

from kit import FACTS, judge, load, script, stack, trials  # noqa: E402
from kit.script import FILES  # noqa: E402

import contact  # noqa: E402
from curriculum.show import remarks  # noqa: E402

GIVEN = {name: load(ROOT / file) for name, file in FILES.items()}  # with blanks
SOLUTIONS = {name: (ROOT / f"exercises/solutions/{name}.py").read_text("utf-8") for name in FILES}
ASKED = {name: trials.asked(GIVEN[name].__doc__) for name in ("ex1", "ex2")}
OF = {blank: name for name, each in FACTS.items() for blank in each.get("blanks", ())}
CALL = "script.main(__name__)"


def run(folder, *words):
    return python(*words, cwd=folder, **NO_PLUGINS)


def test_a_script_prints_its_task_a_hint_or_a_solution_anywhere_and_without_docstrings(tmp_path):
    task = GIVEN["ex1"].__doc__.strip()
    for flags, status, printed in (
        (["ex1"], 2, task),
        (["ex4", "--hint", 3], 0, f"hint 3 of 4: {FACTS['ex4']['hints'][2]}\n"),
        (["ex10", "--solution"], 0, SOLUTIONS["ex10"]),
    ):
        result = run(tmp_path, "-OO", ROOT / FILES[flags[0]], *flags[1:])
        assert (result.returncode, result.stderr) == (status, "")
        assert result.stdout.startswith(printed)
    assert "rests 0.04905 r deep" in result.stdout


@pytest.mark.parametrize("name", FILES)
def test_an_exercise_gives_nothing_away_and_has_its_place(name):
    text = (ROOT / FILES[name]).read_text("utf-8")
    for giveaway in ("m g / k", "max(", "clamp", "sqrt", "0.00288", "0.582", "0.0490", "r = 0.1"):
        assert giveaway not in text
    for hint in FACTS[name]["hints"]:
        assert "?" in hint and not re.search(r"[=*/]|max\(", hint)
    for reason in FACTS[name].get("reasons", {}).values():  # its numbers are measured
        assert not re.search(r"\d", re.sub(r"\{[^}]*\}|`[^`]*`|d0", "", reason))
    number = 1 + [*FILES].index(name)
    assert name == f"ex{number}" and f'"""Exercise {number}, ' in text


def test_a_learners_way_through_all_of_them_where_balls_are_larger(tmp_path, monkeypatch):
    """Each script prints what is next, by a command that works as it is printed, in an odd folder
    that an ASCII terminal cannot spell, in which pytest cannot keep its cache."""
    for name in ("LC_ALL", "PYTHONUTF8", "PYTHONCOERCECLOCALE"):
        monkeypatch.setenv(name, "C" if name == "LC_ALL" else "0")
    copy = tmp_path / "my robot's \N{LATIN CAPITAL LETTER U WITH DIAERESIS}bung"
    clone(copy, "tests", "bench", "page", "compiled")
    (copy / ".pytest_cache").touch()
    text = (copy / "contact.py").read_text("utf-8")
    (copy / "contact.py").write_text(text.replace("RADIUS = 0.1 ", "RADIUS = 0.12 "), "utf-8")
    assert "write one of 'A', 'B', 'C', 'D' in " in run(tmp_path, copy / FILES["ex1"]).stdout
    printed = run(copy, "contact.py", "--steps", 5, "--no-rerun", "--out", tmp_path).stdout
    assert "\nnext, read the chapter: " in printed and "-m curriculum.page\n" in printed
    for name, file in FILES.items():
        command = printed.splitlines()[-1].removeprefix("next, an exercise: ")
        assert file in command
        task = (copy / file).read_text("utf-8").split(CALL)[0]
        (copy / file).write_text(f"{task}{CALL}\n\n{SOLUTIONS[name]}", "utf-8")
        printed = subprocess.run(command, shell=True, cwd=copy, capture_output=True, text=True)
        assert printed.returncode == 0 and not printed.stderr, printed
        printed = printed.stdout
        assert f"solutions/{name}.py" in printed
    assert printed.splitlines()[-1].startswith("all exercises are done")
    with (copy / FILES["ex4"]).open("a") as file:
        file.write("\n\ndef project_impulse(lam, dlam):\n    return lam + dlam\n")
    for command in [FILES["ex4"]], ["checks.py", "-k", "ex1 or ex4"]:
        result = run(copy, *command)
        assert result.returncode == 1 and "likely: nothing keeps the table from p" in result.stdout
        assert "Traceback" not in result.stdout and not result.stderr
    assert "1 failed, 1 passed, 9 deselected" in result.stdout


def test_commands_and_their_order_are_those_of_the_readme_and_the_chapter(
    tmp_path, monkeypatch, capsys
):
    """And how to watch a run."""
    readme = (ROOT / "README.md").read_text("utf-8")
    chapter = (ROOT / "curriculum/prose/chapter.md").read_text("utf-8")
    assert re.findall(r"<!-- exercise: (\w+) -->", chapter) == [*FILES] == [*FACTS]
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "executable", str(ROOT / ".venv/bin/python"))
    (tmp_path / "contact.rrd").touch()
    for uv, start in (False, r"\S*python -m rerun"), (True, "uv run python -m rerun"):
        monkeypatch.setenv("UV", "uv") if uv else monkeypatch.delenv("UV", raising=False)
        command = script.practise().removeprefix("next, an exercise: ").replace("\\", "/")
        assert f"`{command}`" in readme and ("uv run exercises" in command) == uv
        remarks.print_next(contact.parse_flags(["--out", str(tmp_path)]), [])
        assert re.search(rf"watch it: {start} \S*contact\.rrd\n", capsys.readouterr().out)


def test_an_exercise_without_an_entry_is_told_so(monkeypatch, capsys):
    monkeypatch.setattr(sys.modules["__main__"], "__file__", "ex12_mine.py", raising=False)
    with pytest.raises(SystemExit):
        script.main("__main__")
    assert "ex12 has no entry in exercises/kit/answers.json" in capsys.readouterr().err


SIZE = "max(abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, dt))))"
HALVES = "low, high = 0, 2\nwhile high - low > 1e-7:\n dt = (low + high) / 2\n"
HALVES += f" low, high = (dt, high) if {SIZE} <= 1 else (low, dt)\nreturn low"
SCAN = f"dt = 3e-3\nwhile {SIZE} <= 1:\n    dt *= 1.0018\nreturn dt"
VISIT = "add = (c.target - c.v_n()) * c.m_eff; p = max(-c.lam, add); c.lam += p; c.apply_impulse(p)"
BACK = "for _ in range(iters):\n    for c in contacts[::-1]:\n        "
HARD = "SOLIMP = 0.9999, 0.9999, 0.001, 0.5, 2.0"
CLEAR = "import atexit, os; os.system('clear; echo hi'); atexit.register(print, 1); print('hi')\n"
THEIRS = "import contact; return contact.time_to_impact(gap, v_n, a_n)"
NEVER = "import contact; t = contact.time_to_impact(gap, v_n, a_n)\nif t < math.inf: return t"
TYPED = [  # an exercise or a function of it, what a learner writes, what is said of its last LINE
    ("ex1", "PREDICTION = C", "wrong: cannot be run, C needs quotes around it: NameError: name '"),
    ("ex10", "DEPTH = (", "wrong: cannot be run: SyntaxError: "),
    ("ex5", "del solve_contacts", "wrong: solve_contacts must be a function, in "),
    ("position_level", "return dtt", "wrong: 'dtt' is not defined\n  line LINE: return dtt"),
    ("time_to_impact", CLEAR + THEIRS, "right: time_to_impact is right\n  printed   hi"),
    ("time_to_impact", NEVER, "wrong: returned None, expected numbers, here math.inf: this gap ne"),
    ("project_impulse", "import os; os._exit(7)", "wrong: project_impulse ended its process"),
    ("project_impulse", "while True: pass", "wrong: stopped after 2 s, in FILE, line LINE"),
    ("project_impulse", "a = []\nwhile True: a.append(bytes(10**7))",
     "wrong: raised MemoryErr"),
    ("project_impulse", "lam + dlam", "wrong: None, expected numbers: does every way end with `r"),
    ("penalty_normal_force", "return float('nan')", "wrong: a question that helps: "),
    ("penalty_normal_force", "f = stiffness * depth - damping * v_n; return f * (f > 0)", "right"),
    ("solve_contacts", BACK + VISIT, "right"),
    ("solve_contacts", BACK + "c.v_n - 1", "wrong: 'int'; a function is called with ()"),
    ("step_matrix", "return [1, 2, 3]", "wrong: how many numbers: got 3, expected 2 rows of 2"),
    ("step_matrix", "return [[1, -dt], [dt * stiffness / mass, 1]]",  # the search is not blamed
     "wrong: longest_step is tried once step_matrix is right"),
    ("longest_step", SCAN, "right"),
    ("longest_step", SCAN.replace("1.0018", "1.00001"), "wrong: steps for one spring. A long way"),
    ("longest_step", SCAN.replace("abs", "np.real"), "wrong: an eigenvalue is above 1, not its re"),
    ("longest_step", HALVES.replace("abs", "np.real"), "wrong: the same step, an end of the sear"),
    ("longest_step", HALVES.replace("1e-7", "1e-3"), "wrong: the search is too coarse"),
    ("ex2", "PREDICTION = 'D'", "blank: PREDICTION: given 'D'; write one of 'A', 'B', 'C' in FILE"),
    ("ex2", "WHY = 'because'", "blank: WHY is 'because'; write a sentence of four words or more "),
    ("ex1", "PREDICTION = ' c) '\nprint(6 * 7)", "right: That is what happens.\n\nWhy C: A spr"),
    ("ex1", "PREDICTION = 'B'", "right: \n\nWhy not A: The same table, but not the same push"),
    ("ex2", "PREDICTION = 'A'", "right: What happens is C: The light one alone: the same push"),
    ("ex11", "BETS = BETS.replace('sink', '?')", "blank: row sink: given nothing; expected 2 mark"),
    ("ex11", "BETS = BETS.replace('-', '\N{MINUS SIGN}')", "right: holds in 15 of 15;"),
    ("ex11", "BETS = BETS.replace('=   ', '-   ', 1)", "right: holds in 14 of 15;"),
    ("ex9", "MODEL = 'lcp'", "wrong: lcp, leapfrog and exact are not allowed here: their contacts"),
    ("ex9", "DT = 1e-4", "wrong: given DT = 0.0001, STIFFNESS = 300000; allowed: DT from 0.0005"),
    ("ex9", "STIFFNESS = 3e4", "wrong: it overlaps too much; 20 N press a spring of 30000 N/m in"),
    ("ex9", "STIFFNESS = 1e9", "wrong: too little for a fingertip; 20 N press a spring of 1e+09 N"),
    ("ex9", "MODEL, DT, STIFFNESS = 'penalty', 0.001, 2e5", "right"),
    ("ex9", "MODEL, DT, DAMPING = 'penalty', 0.001, 400.0", "wrong: the cup is gone"),
    ("ex9", "MODEL, DT, STIFFNESS = 'penalty', 0.002, 1e6", "wrong: wants steps below 0.0006 s"),
    ("ex9", f"MODEL, DT, SOLREF = 'soft', 0.001, (0.02, 0.05)\n{HARD}", "wrong: it trembles"),
    ("ex10", "DEPTH = f' {-DEPTH:.3g} '", "right"),  # the table has an overlap with a minus
    ("ex10", "DEPTH = 'deep'", "blank: given 'deep'; write a number in FILE"),
    ("ex10", "DEPTH = 0.5432", "wrong: expected another number\n  a question that helps: "),
]  # fmt: skip


@pytest.mark.parametrize("what, words, said", TYPED)
def test_what_a_learner_types_is_right_in_every_form_and_else_is_answered(
    what, words, said, tmp_path, monkeypatch, capfd
):
    if "bytes" in words and sys.platform != "linux":
        pytest.skip("only here memory can be limited")
    name = OF.get(what, what)
    if what in OF:
        given = ", ".join(inspect.signature(trials.RIGHT[what]).parameters)
        words = f"def {what}({given}):\n{indent(words, '    ')}"
    file, text = tmp_path / f"{name}_mine.py", f"{SOLUTIONS[name]}\n\n{words}"
    file.write_text(text, "utf-8")
    if re.search("os[.]|while True", words):  # what needs a process of its own
        if "pass" in words:
            short = script.START.replace("judge.", "judge.LIMIT = 2; judge.")
            monkeypatch.setattr(script, "START", short)
            monkeypatch.setattr(script, "LIMIT", 2)
        state, answer = script.judged(name, file)
    else:
        state, answer = judge.attempt(name, str(file))
    expected, _, part = said.partition(": ")
    part = part.replace("LINE", str(1 + text.count("\n"))).replace("FILE", str(file))
    assert state == expected and part in answer, answer
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", FACTS)
def test_each_slip_is_named_from_its_values_and_its_case_is_a_call(name):
    for blank in FACTS[name].get("blanks", ()):
        for slip, meaning in judge.BLANKS[blank]["slips"].items():
            state, words = judge.judge(judge.slipped(blank, slip), blank, "ex.py")
            assert state == "wrong" and words.splitlines()[-1] == f"  likely: {meaning}", slip
            assert f"{blank} is wrong on " in words
        eval(words.splitlines()[1], {"stack": stack, blank: trials.RIGHT[blank]})
    for what, facts in FACTS[name].get("numbers", {}).items():
        for slip, meaning in facts["slips"].items():
            given = eval(slip, trials.NAMES | facts.get("given", {}))
            exercise = SimpleNamespace(__file__="ex.py", **{what: given})
            state, words = trials.judge_number(exercise, what, **facts)
            assert state == "wrong" and words.endswith(f"; likely: {meaning}"), slip


def test_yours_stands_beside_what_it_is_compared_with():
    shown = trials.cliffs(SimpleNamespace(longest_step=lambda mass, stiffness, damping: 0.007))
    assert shown.splitlines()[2].split()[4:] == ["0.00700", "0.01354", "0.02000"]


def errors_shown(**written):
    """The column off/r of the table that exercise 6 shows, by the names of its rows."""
    table = trials.compare_solves(SimpleNamespace(**trials.RIGHT | written))
    heads, *rows = (re.split(r"\s{2,}", line) for line in table.splitlines() if "  " in line[1:])
    where = heads.index("off/r")
    return {row[0]: float(row[where].replace(",", "")) for row in rows if len(row) == len(heads)}


def test_two_solves_are_leapfrogs_step_and_a_slip_of_them_is_seen_beside_exact():
    """off/r: errors in r, what an overlap throws, the order of the slide."""
    off = errors_shown()
    assert off["yours on drop"] < 1e-12 and off["yours on stack"] < 1e-5
    assert off["yours on overlap"] < 0.6
    order = math.log(off["yours on slide"] / off["yours on slide at dt / 4"], 4)
    assert order == pytest.approx(2.0, rel=FACTS["ex6"]["numbers"]["ORDER"]["within"])
    off = errors_shown(velocity_level=lambda lam, then, now: (lam, 0, 0, now))
    assert off["yours on overlap"] > 100


def test_the_right_letters_are_what_is_measured_and_no_mark_lies_near_its_border():
    found = SimpleNamespace(**trials.measure("ex1"), **trials.measure("ex2"))
    assert "four times as deep" in ASKED["ex1"]["choices"][trials.SOLVED["ex1"].PREDICTION]
    assert found.penalty_at_rest == pytest.approx(4.0 * found.penalty_light_at_rest, rel=0.01)
    assert max(found.lcp_at_rest, found.lcp_light_at_rest) < 1e-6
    assert "The light one alone" in ASKED["ex2"]["choices"][trials.SOLVED["ex2"].PREDICTION]
    assert found.penalty_light > 10.0
    assert max(found.penalty_heavy, found.lcp_light, found.lcp_heavy) < 1.0
    shares = [x for row in trials.measure_knobs()[0].values() for x in row.values()]
    assert all(x < 0.4 or 0.95 < x < 1.05 or x > 4.0 for x in shares)


def test_what_is_asked_is_what_is_run_and_what_no_command_has_shown():
    """The docstrings' numbers; README, docstrings and set-up drop 1 kg."""
    for name, words, balls in (
        ("ex1", "1 kg.*4 kg.*0.6 m.*4 s", {(1.0, 0.6, 0.002), (4.0, 0.6, 0.002)}),
        ("ex2", "0.1 kg.*10 kg.*half a metre.*0.03 s", {(0.1, 0.5, 0.03), (10.0, 0.5, 0.03)}),
    ):
        assert re.search(words, GIVEN[name].__doc__, re.DOTALL)
        rows = FACTS[name]["measured"].values()
        assert {(row["mass"], row["fall"], row["dt"]) for row in rows} == balls
    for file in ("README.md", "contact.py"):
        commands = re.findall(r"contact\.py (--[^`\n#]*)", (ROOT / file).read_text("utf-8"))
        assert commands and not any("--mass" in command for command in commands)
    for name in ("ex10", "ex11"):
        for facts in FACTS[name]["numbers"].values():
            for value in facts["given"].values():
                assert re.search(rf"\b{value:g}\b", GIVEN[name].__doc__)
    fingers = f"{trials.CUP:g} kg.*{trials.FINGER:g} kg.*{trials.FORCE:g} N"
    assert re.search(fingers, GIVEN["ex9"].__doc__, re.DOTALL)
    assert (GIVEN["ex9"].SOLREF, GIVEN["ex9"].SOLIMP) == (contact.SOLREF, contact.SOLIMP)
    assert f"at most {judge.MAX_STEPS:,}" in GIVEN["ex3"].__doc__
    assert f"than {judge.MAX_STEPS:,} steps" in judge.SEARCHES["slow"]


def test_a_number_is_what_its_command_measures(tmp_path):
    for name, model, what, key, within in (
        ("ex10", "soft", "DEPTH", "rest_penetration_frac", 5e-3),
        ("ex11", "lcp", "HOP", "rebound_frac", 0.02),
    ):
        (flags,) = re.findall(r"^ +(--.*)$", GIVEN[name].__doc__, re.MULTILINE)
        contact.main([*flags.split(), "--no-rerun", "--out", str(tmp_path)])
        quality = json.loads((tmp_path / "metrics.json").read_text("utf-8"))["quality"][model]
        assert quality[key] == pytest.approx(trials.RIGHT[what], rel=within)


@pytest.mark.parametrize("dt, beta, cup", [(0.003, 0.25, 2.5), (0.004, 0.3, 3.5)])
def test_the_sag_of_the_gripper_is_its_law(dt, beta, cup):
    law = trials.FORCE * dt * dt / (beta * cup) / contact.RADIUS
    run = FACTS["ex11"]["numbers"]["SAG"]["run"]
    assert eval(run, trials.NAMES, {"dt": dt, "beta": beta, "cup": cup}) == pytest.approx(law)


def test_the_finger_of_the_next_chapter_feels_what_it_pushes():
    """Three balls of 2 N drag each, by every model that steps."""
    printed = python("-W", "error", "exercises/next_chapter.py").stdout.splitlines()
    assert [line.split()[0] for line in printed] == contact.STEPPED
    for line in printed:
        *x, force = map(float, re.findall(r"-?\d+\.\d*", line))
        assert force == pytest.approx(-6.0, rel=1e-3)
        assert x == pytest.approx([1.0, 1.2, 1.4, 1.6], abs=0.01)
