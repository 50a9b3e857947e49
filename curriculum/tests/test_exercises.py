"""The exercises: untouched they wait, right fills pass in every form, wrong ones are named.

Needs numpy and pytest and nothing else, as a learner has them.
"""

import math
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

import ex1_predict_contact as ex1  # noqa: E402
import ex3_dt_stability as ex3  # noqa: E402
import ex4_predict_soft as ex4  # noqa: E402
from kit import blanks, predict, trials  # noqa: E402
from kit.progress import FILES as PLACES  # noqa: E402

import contact  # noqa: E402

ALL_DONE = "all exercises are done"
BETS = {"ex1": ex1, "ex3": ex3, "ex4": ex4}
FILES = {name: place.partition("/")[2] for name, place in PLACES.items()}
FILLED = {      # name: [(a line of the file, what a learner writes there)]
    "ex1": [("PREDICTION = None ", "PREDICTION = ' c) ' "), ('WHY = ""', 'WHY = "so it must be"')],
    "ex2": [("f_n = ...", "f_n = max(0, stiffness * depth - damping * v_n)"),
            ("new_lam = ...", "new_lam = lam + max(-lam, dlam)")],
    "ex3": [("PREDICTION = None ", "PREDICTION = 'A' "), ('WHY = ""', 'WHY = "a bet is a bet"')],
    "ex4": [("PREDICTION = None ", "PREDICTION = 'A' "), ('WHY = ""', 'WHY = "so it has to be"')],
    "ex5": [("return ...", """for _ in range(iters):
        for c in contacts:
            lam = max(0.0, c.lam + (c.target - c.v_n()) * c.m_eff)
            c.push(lam - c.lam)
            c.lam = lam""")],
    "ex6": [("return ...  # TODO: blank 1", """a = 1 - dt * damping / mass
    b = dt * stiffness / mass
    return [[1 - dt * b, -dt * a], [b, a]]"""),
            ("return ...  # TODO: blank 2", """low, high = 0.0, 10.0
    while high - low > 1e-6:
        mid = 0.5 * (low + high)
        size = abs(np.linalg.eigvals(step_matrix(mass, stiffness, damping, mid))).max()
        low, high = (mid, high) if size <= 1 else (low, mid)
    return low""")],
    "ex7": [("softness = ...", "softness = 1 / (dt * (stiffness * dt + damping))"),
            ("target = ...", "target = softness * dt * stiffness * depth")],
    "ex8": [("MODEL = None", 'MODEL = "soft"'), ("SOLREF = (0.02, 1.0)", "SOLREF = (0.004, 1.0)"),
            ("SOLIMP = (0.9, 0.95,", "SOLIMP = (0.99, 0.99,")],
}  # fmt: skip


def exercise(**functions):
    return SimpleNamespace(__file__="exercises/exN.py", **functions)


@pytest.fixture
def copy(tmp_path):
    """A learner's copy, in a folder with a space and a quote, and a function that fills it in."""
    folder = tmp_path / "my robot's course"
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "exercises", folder / "exercises", ignore=leave)
    (folder / "curriculum").mkdir()
    for name in ("contact.py", "checks.py", "curriculum/commands.py", "curriculum/implicit.py"):
        shutil.copy(ROOT / name, folder / name)

    def fill(*names):
        for name in names:
            path = folder / "exercises" / FILES[name]
            text = path.read_text("utf-8")
            for old, new in FILLED[name]:
                assert text.count(old) == 1, (name, old)
                text = text.replace(old, new)
            path.write_text(text, "utf-8")

    return folder, fill


def run(folder, *command, missing="yaml"):
    """The command in that folder, by a Python in which a package cannot be imported."""
    start = (
        f"import sys, runpy; sys.modules[{missing!r}] = None; sys.argv = sys.argv[1:]; "
        "sys.path[0] = sys.argv[0].rpartition('/')[0] or '.'; "
        "runpy.run_path(sys.argv[0], run_name='__main__')"
    )
    return subprocess.run(
        [sys.executable, "-B", "-c", start, *command], cwd=folder, capture_output=True, text=True
    )


def test_untouched_every_exercise_is_skipped_and_says_what_to_do(copy):
    folder, _ = copy
    result = run(folder, "checks.py")
    assert result.returncode == 0 and "8 skipped" in result.stdout, result.stdout + result.stderr
    for name, file in FILES.items():
        assert f"{name}: " in result.stdout and f"exercises/{file}" in result.stdout


def test_a_learners_way_through_all_eight(copy):
    """Each script says what is next, in an odd folder too; a bet counts once it was read."""
    folder, fill = copy
    for name, file in FILES.items():
        fill(name)
        command = [sys.executable, "-B", folder / "exercises" / file]
        if name == "ex1":  # the command that is printed works as it is printed
            printed = run(folder, "checks.py", "-k", name).stdout.split("now read what happens: ")
            command = printed[1].splitlines()[0]
        script = subprocess.run(
            command, shell=isinstance(command, str), cwd=folder, capture_output=True, text=True
        )
        assert script.returncode == 0, script.stdout + script.stderr
        last = script.stdout.splitlines()[-1]
        following = dict(zip(FILES, [*FILES.values()][1:])).get(name)
        assert last.startswith(ALL_DONE) if following is None else last.endswith(following)
        assert following is None or sys.executable in last
    result = run(folder, "checks.py")
    assert result.returncode == 0 and "8 passed" in result.stdout
    assert result.stdout.splitlines()[-1].startswith(ALL_DONE)


def test_a_wrong_fill_and_a_file_that_is_no_python_fail_their_own_checks_and_say_why(copy):
    folder, _ = copy
    for name, old, new in (
        ("ex1", "PREDICTION = None", "PREDICTION = C"),
        ("ex2", "new_lam = ...", "new_lam = lam + dlam"),
        ("ex4", "measure():", "measure(:"),
    ):
        path = folder / "exercises" / FILES[name]
        path.write_text(path.read_text().replace(old, new, 1))
    result = run(folder, "checks.py")
    assert result.returncode == 1 and "3 failed, 5 skipped" in result.stdout
    assert "C needs quotes around it" in result.stdout and "SyntaxError" in result.stdout
    assert "likely: nothing keeps the table from pulling" in result.stdout
    assert "Traceback" not in result.stdout


def test_without_pytest_or_numpy_one_line_says_how_to_get_it(copy):
    folder, _ = copy
    for missing, file in (("pytest", "checks.py"), ("numpy", f"exercises/{FILES['ex1']}")):
        result = run(folder, file, missing=missing)
        assert result.returncode in (1, 2) and result.stderr.count("\n") == 1, result.stderr
        assert re.search(rf"{missing}.*: .*(pip install|uv run --with) {missing}", result.stderr)


def test_watch_checks_again_when_an_exercise_is_saved(copy):
    folder, fill = copy
    command = [sys.executable, "-B", "checks.py", "--watch", "-k", "ex7"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
    try:
        seen = ""
        for line in process.stdout:
            seen += line
            if "waiting for an exercise" in line and "1 passed" not in seen:
                fill("ex7")
            elif "1 passed" in seen:
                break
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
    assert "implicit_spring is still a blank" in seen


# Fills: right ones and every slip


RIGHT = [
    ("penalty_normal_force", lambda depth, v_n, stiffness, damping: (
        max(stiffness * depth + damping * -v_n, 0) if depth > 0 else 0.0)),
    ("penalty_normal_force", lambda depth, v_n, stiffness, damping: (
        (depth * stiffness - v_n * damping) * (depth * stiffness > v_n * damping))),
    ("penalty_normal_force", lambda depth, v_n, stiffness, damping: np.maximum(
        0, np.array([stiffness * depth - damping * v_n]))),
    ("project_impulse", lambda lam, dlam: 0.5 * (lam + dlam + abs(lam + dlam))),
    ("project_impulse", lambda lam, dlam: np.float32(0) if lam < -dlam else lam + dlam),
    ("solve_contacts", blanks.solver()),
    ("solve_contacts", blanks.solver(total="c.lam + max(-c.lam, add)", most=500)),
    ("step_matrix", lambda m, k, c, dt: (
        np.array([[1, -dt], [0, 1]]) @ np.array([[1, 0], [dt * k / m, 1 - dt * c / m]]))),
    ("longest_step", lambda m, k, c: next(
        dt for dt in 0.2 * 0.999 ** np.arange(9000)
        if max(abs(np.linalg.eigvals(blanks.matrix(m, k, c, dt)))) <= 1)),
    ("longest_step", lambda m, k, c: (math.sqrt(c * c + 4 * k * m) - c) / k),
    ("implicit_spring", lambda depth, k, c, dt: (
        dt**-2 / (k + c / dt), depth / dt / (1 + c / (k * dt)))),
]  # fmt: skip


@pytest.mark.parametrize("blank, function", RIGHT)
def test_a_right_fill_passes_in_every_form(blank, function):
    assert trials.judge(exercise(**{blank: function}), blank) == ("right", "")


def test_the_answers_of_exercise_5_fulfil_what_a_contact_is():
    """No pull, no v_n below its target, and no push where v_n is above it: only one answer does."""
    for case in blanks.stacks():
        count, found = len(case["contacts"]), blanks.run_stack(contact.solve_contacts, case)
        lam, v = found[:count], np.reshape([*found[count:], 0.0, 0.0], (-1, 2))  # -1: the floor
        for push, (a, b, angle, target) in zip(lam, case["contacts"]):
            above = (v[a] - v[b]) @ (math.sin(angle), math.cos(angle)) - target
            assert push >= 0.0 and above >= -1e-9 and push * above <= 1e-9


def test_the_matrix_of_exercise_6_is_the_step_of_penalty():
    for case in blanks.BLANKS["step_matrix"].inputs:
        mass, stiffness, damping, dt = case.values()
        rest = contact.GRAVITY * mass / stiffness
        for column, (depth, v_n) in enumerate([(-0.1 * rest, 0.0), (0.0, 1e-5)]):
            ball = contact.Ball(0.0, 0.1 + rest - depth, 0.0, v_n, mass, 0.1)
            contact.penalty_step([ball], dt, stiffness, damping)
            after = np.array([0.1 + rest - ball.y, ball.vy]) / (depth or v_n)
            expected = np.array(blanks.matrix(*case.values()))[:, column]
            assert after == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    "blank, number",
    [(name, k) for name, blank in blanks.BLANKS.items() for k in range(len(blank.slips))],
)
def test_a_wrong_fill_fails_and_is_named_from_its_values(blank, number):
    function, meaning = blanks.BLANKS[blank].slips[number]
    state, words = trials.judge(exercise(**{blank: function}), blank)
    assert state == "wrong" and f"likely: {meaning}" in words
    assert all(part in words for part in (f"{blank}(", "got ", "expected ", "where to look: "))


@pytest.mark.parametrize("case", blanks.stacks())
def test_the_stacks_are_solved_contact_by_contact(case):
    """lam >= 0, v_n >= target, and one of the two holds as an equation; pushes keep momentum."""
    count, mass = len(case["contacts"]), np.array(case["masses"])
    found = blanks.run_stack(blanks.BLANKS["solve_contacts"].right, case)
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
    ):
        state, words = trials.judge(exercise(project_impulse=function), "project_impulse")
        assert state == "wrong" and part in words and "\n" not in words


def test_each_slip_of_the_clamp_is_seen_in_a_trial():
    """Without a clamp a table holds back what leaves it; with it on the change, a groove throws."""
    unclamped, clamped_change = (blanks.BLANKS["project_impulse"].slips[k][0] for k in (0, 1))
    assert trials.thrown() > 1.9 and trials.groove() < 1e-3
    with trials.in_place(unclamped, "project_impulse"):
        assert trials.thrown() < 1e-3
    with trials.in_place(clamped_change, "project_impulse"):
        assert trials.groove() > 1.0


FINGERS = {
    "MODEL": "soft",
    "DT": 0.002,
    "STIFFNESS": 1e4,
    "DAMPING": 80.0,
    "SOLREF": (0.02, 1.0),
    "SOLIMP": (0.9, 0.95, 0.001, 0.5, 2.0),
}


@pytest.mark.parametrize("choice, part", [
    ({"SOLREF": (0.003, 1.0), "SOLIMP": (0.99, 0.99, 0.001, 0.5, 2.0)}, None),
    ({"SOLREF": (0.004, 1.0)}, "overlaps too much"),
    ({"DT": 0.001, "SOLREF": (0.001, 1.0), "SOLIMP": (0.9999, 0.9999, 0.001, 0.5, 2.0)}, None),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 3e5}, None),
    ({"MODEL": "penalty"}, "overlaps too much"),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 3e5, "DAMPING": 0.0}, "trembles"),
    ({"MODEL": "penalty", "DT": 0.001, "STIFFNESS": 3e5, "DAMPING": 400.0}, "the cup is gone"),
    ({"MODEL": "penalty", "DT": 0.002, "STIFFNESS": 1e6}, "the cup is gone"),
    ({"MODEL": "penalty", "DT": 0.0001, "STIFFNESS": 1e6}, "more than 2,000 steps"),
    ({"MODEL": "hard"}, "allowed: MODEL 'penalty' or 'soft'"),
    ({"DT": 0.0}, "DT from 0.00001 to 0.1 s"),
    ({"DT": "fast"}, "cannot be run with 'soft', 'fast' s"),
])  # fmt: skip
def test_the_gripper_is_judged_by_what_it_does(choice, part):
    state, words = trials.judge_fingers(exercise(**FINGERS | choice))
    assert state == ("wrong" if part else "right") and (part is None or part in words), words


# Bets


@pytest.mark.parametrize("name", BETS)
def test_a_bet_waits_for_a_choice_and_a_reason(name, monkeypatch, capsys):
    module = BETS[name]
    monkeypatch.setattr(module, "measure", lambda: pytest.fail("it ran"))
    for prediction, why, part in (
        (None, "", "no prediction yet"),
        ("D", "so it has to be", "given 'D', allowed: 'A', 'B', 'C'"),
        ("A", "because", "no reason yet"),
    ):
        monkeypatch.setattr(module, "PREDICTION", prediction)
        monkeypatch.setattr(module, "WHY", why)
        assert predict.bet(name, module) == 2
        out, err = capsys.readouterr()
        assert part in err and module.QUESTION in " ".join(out.split())


@pytest.mark.parametrize("name", BETS)
def test_after_the_run_there_is_a_word_on_every_choice(name, monkeypatch):
    module, answer = BETS[name], predict.ANSWERS[name]
    numbers = module.measure()
    for mine in "ABC":
        monkeypatch.setattr(module, "PREDICTION", mine)
        text = " ".join(predict.verdict(name, module, numbers).split())
        assert ("That is what happens." in text) == (mine == answer)
        assert all(f"Why {c}:" in text if c == answer else f"Why not {c}:" in text for c in "ABC")
        assert "{" not in text and module.CHOICES[answer] in text


def test_the_measurements_are_the_published_ones_and_make_the_answers_true():
    first, third, fourth = (module.measure() for module in BETS.values())
    assert first["penalty_deepest"] == pytest.approx(0.251329183485, abs=1e-11)
    assert first["lcp_deepest"] == pytest.approx(0.056743325071, abs=1e-11)
    assert first["penalty_at_rest"] == pytest.approx(0.00981, abs=1e-9)
    assert first["lcp_at_rest"] < 1e-9
    assert third["penalty_long"] == pytest.approx(1409, abs=1) and third["lcp_long"] == 0.0
    assert third["penalty_usual"] == 0.0 and third["limit"] < 0.03
    assert fourth["soft_light"] == pytest.approx(fourth["soft_heavy"], rel=1e-9)
    assert fourth["soft_light"] == pytest.approx(0.0036718, abs=1e-7)
    assert fourth["penalty_heavy"] == pytest.approx(10 * fourth["penalty_light"], rel=2e-3)


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
    before = re.sub(r"jitter, sink into the floor|<!--.*?-->|`--?[\w-]+`", " ", before, flags=re.S)
    found = re.search(GIVEAWAYS[name], " ".join(before.split()), re.IGNORECASE)
    assert found is None, found
    assert re.search(GIVEAWAYS[name], " ".join(after.split()), re.IGNORECASE)


@pytest.mark.parametrize("name, file", FILES.items())
def test_an_exercise_gives_nothing_away_and_hints_ask(name, file):
    text = (ROOT / "exercises" / file).read_text("utf-8")
    for giveaway in ("m g / k", "max(", "clamp", "sqrt", "0.25", "1409", "0.0036", "ANSWERS"):
        assert giveaway not in text
    assert re.match(r'"""Exercise \d, [\w ]+ \(\d+ minutes\): .+[.?]\n', text) and "--hint" in text
    assert all("?" in hint for hint in predict.FACTS[name]["hints"])
    shown = subprocess.run(
        [sys.executable, ROOT / "exercises" / file, "--hint", "1"], capture_output=True, text=True
    )
    assert shown.returncode == 0 and predict.FACTS[name]["hints"][0] in shown.stdout
