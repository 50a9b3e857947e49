"""The exercises: untouched skips, the reference passes, every tempting wrong fill fails."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

import contact  # noqa: E402
import ex1_predict_contact as ex1  # noqa: E402
import ex3_dt_stability as ex3  # noqa: E402
import predict  # noqa: E402
from curriculum.check_prose_code_drift import typed_numbers  # noqa: E402
from curriculum.quoted import Numbers, load_meta  # noqa: E402

FACTS = load_meta()["exercises"]
PREDICTED = {"ex1": ex1, "ex3": ex3}
BLANKS = {"f_n": "f_n = ...", "new_lam": "new_lam = ..."}
RIGHT = {
    "f_n": "f_n = max(0.0, stiffness * depth - damping * v_n)",
    "new_lam": "new_lam = max(0.0, lam + dlam)",
}
WRONG = {
    "penalty without the clamp": ("f_n", "f_n = stiffness * depth - damping * v_n"),
    "penalty with the damper reversed": (
        "f_n",
        "f_n = max(0.0, stiffness * depth + damping * v_n)",
    ),
    "penalty with the damper's size only": (
        "f_n",
        "f_n = max(0.0, stiffness * depth - damping * abs(v_n))",
    ),
    "penalty clamping the spring alone": (
        "f_n",
        "f_n = max(0.0, stiffness * depth) - damping * v_n",
    ),
    "penalty without the damper": ("f_n", "f_n = max(0.0, stiffness * depth)"),
    "impulse without the clamp": ("new_lam", "new_lam = lam + dlam"),
    "impulse clamping the change": ("new_lam", "new_lam = lam + max(0.0, dlam)"),
    "impulse returning the change": ("new_lam", "new_lam = max(0.0, dlam)"),
    "impulse clamped at its old value": ("new_lam", "new_lam = max(lam, lam + dlam)"),
    "nothing returned": ("new_lam", "new_lam = None"),
}


@pytest.fixture
def copy(tmp_path):
    """A learner's copy of what the exercises need, and a function that edits it."""
    for name in ("contact.py", "checks.py", "meta.yaml"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("exercises", "curriculum"):
        shutil.copytree(
            ROOT / name,
            tmp_path / name,
            ignore=shutil.ignore_patterns(
                "__pycache__", "tests", "bench", "stress", "page", "*.html"
            ),
        )

    def edit(file, old, new):
        path = tmp_path / "exercises" / file
        assert path.read_text().count(old) == 1, (file, old)
        path.write_text(path.read_text().replace(old, new))

    return tmp_path, edit


def run(folder, *command):
    return subprocess.run(
        [sys.executable, "-B", *command], cwd=folder, capture_output=True, text=True
    )


def checks(folder, *options):
    result = run(
        folder,
        "-m",
        "pytest",
        "checks.py",
        "-q",
        "-rs",
        "-p",
        "no:cacheprovider",
        "-c",
        "/dev/null",
        "--rootdir",
        str(folder),
        *options,
    )
    return result.returncode, result.stdout


def test_untouched_every_check_skips_by_name_and_none_passes(copy):
    status, out = checks(copy[0])
    assert status == 0 and " passed" not in out and " failed" not in out, out
    for said in (
        "ex1: no prediction yet",
        "ex2: penalty_normal_force is still a blank",
        "ex2: project_impulse is still a blank",
        "ex3: no prediction yet",
    ):
        assert said in out


def test_the_reference_passes_every_check(copy):
    folder, edit = copy
    for name, blank in BLANKS.items():
        edit("ex2_completion_contact.py", blank, RIGHT[name])
    for file, name in (("ex1_predict_contact.py", "ex1"), ("ex3_dt_stability.py", "ex3")):
        edit(file, "PREDICTION = None ", f"PREDICTION = {FACTS[name]['answer']!r} ")
        edit(file, 'WHY = ""', 'WHY = "because"')
    status, out = checks(folder)
    assert status == 0 and "skipped" not in out, out


@pytest.fixture
def ex2_checks(monkeypatch):
    """checks.py imported, and a function that fills a blank of its ex2 and runs one check on it."""
    import checks as module

    def fill(name, line):
        source = (ROOT / "exercises" / "ex2_completion_contact.py").read_text()
        space = {"__name__": "filled"}
        exec(source.replace(BLANKS[name], line), space)
        for function in ("penalty_normal_force", "project_impulse"):
            monkeypatch.setattr(module.ex2, function, space[function])
        results = []
        for test in (
            module.test_ex2_penalty_normal_force,
            module.test_ex2_project_impulse,
            module.test_ex2_two_contacts_at_once,
        ):
            for case in cases(test):
                try:
                    test(**case)
                    results.append((test.__name__, "passed", ""))
                except pytest.skip.Exception as skipped:
                    results.append((test.__name__, "skipped", str(skipped)))
                except pytest.fail.Exception as failed:
                    results.append((test.__name__, "failed", str(failed)))
        return results

    return fill


def cases(test):
    """The parametrised inputs of a test, as pytest would make them."""
    made = [{}]
    for mark in test.pytestmark:
        names = [name.strip() for name in mark.args[0].split(",")]
        values = [value if len(names) > 1 else (value,) for value in mark.args[1]]
        made = [old | dict(zip(names, value)) for old in made for value in values]
    return made


@pytest.mark.parametrize("name, line", WRONG.values(), ids=WRONG)
def test_a_tempting_wrong_fill_fails_with_input_got_expected_and_where_to_look(
    ex2_checks, name, line
):
    failed = [text for _, outcome, text in ex2_checks(name, line) if outcome == "failed"]
    assert failed
    for text in failed:
        assert (
            all(part in text for part in ("got ", "expected ", "where to look: "))
            and "(" in text.split("\n")[0]
        )


@pytest.mark.parametrize("line", ["new_lam = lam + dlam", "new_lam = lam + max(0.0, dlam)"])
def test_two_contacts_at_once_tell_the_clamp_on_the_total_from_the_others(ex2_checks, line):
    assert "failed" in [
        outcome for test, outcome, _ in ex2_checks("new_lam", line) if "two_contacts" in test
    ]


def test_one_blank_filled_is_checked_while_the_other_still_skips(ex2_checks):
    outcomes = {(test, outcome) for test, outcome, _ in ex2_checks("f_n", RIGHT["f_n"])}
    assert outcomes == {
        ("test_ex2_penalty_normal_force", "passed"),
        ("test_ex2_project_impulse", "skipped"),
        ("test_ex2_two_contacts_at_once", "skipped"),
    }


@pytest.mark.parametrize("name", PREDICTED)
def test_a_predict_exercise_refuses_to_run_before_choice_and_reason(name, monkeypatch, capsys):
    exercise = PREDICTED[name]
    monkeypatch.setattr(exercise, "measure", lambda: pytest.fail("it ran"))
    for prediction, why, said in (
        (None, "", "no prediction yet"),
        ("D", "x", "given 'D', allowed: 'A', 'B', 'C'"),
        ("A", " ", "no reason yet"),
    ):
        monkeypatch.setattr(exercise, "PREDICTION", prediction)
        monkeypatch.setattr(exercise, "WHY", why)
        assert predict.play(name, exercise, []) == 2
        out, err = capsys.readouterr()
        assert out == "" and said in err and err.count("\n") == 1


@pytest.mark.parametrize("mine", "ABC")
@pytest.mark.parametrize("name", PREDICTED)
def test_after_the_run_the_learner_sees_the_measurement_and_a_word_on_every_choice(
    name, mine, monkeypatch, capsys
):
    exercise, answer = PREDICTED[name], FACTS[name]["answer"]
    monkeypatch.setattr(exercise, "PREDICTION", mine)
    monkeypatch.setattr(exercise, "WHY", "a reason of mine")
    assert predict.play(name, exercise, []) == 0
    out = capsys.readouterr().out
    assert f"You predicted {mine}, because: a reason of mine" in out
    assert ("That is what happens." if mine == answer else f"What happens is {answer}.") in out
    for choice in "ABC":
        assert f"Why {choice}:" in out if choice == answer else f"Why not {choice}:" in out
    assert out.index("penalty") < out.index("You predicted") and "{{" not in out


@pytest.mark.parametrize("name", PREDICTED)
def test_the_measurement_is_the_scripts_own_and_stands_in_its_bands(name):
    measured, fresh = Numbers(runs=PREDICTED[name].measure()), Numbers()
    for key, (low, high) in FACTS[name]["bands"].items():
        assert low <= measured.value(key) <= high, key
        assert abs(measured.value(key) - fresh.value(key)) <= 1e-9, key
    assert all(measured.holds(claim) for claim in FACTS[name]["holds"])
    if name == "ex3":
        for key in ("stability.dt_crit_damped", "stability.dt_crit_penalty"):
            assert abs(measured.value(f"drop:{key}") - fresh.value(f"drop:{key}")) <= 1e-9


@pytest.mark.parametrize(
    "name, file",
    [
        ("ex1", "ex1_predict_contact.py"),
        ("ex2", "ex2_completion_contact.py"),
        ("ex3", "ex3_dt_stability.py"),
    ],
)
def test_nothing_before_the_run_gives_the_answer_away(name, file):
    """No measured figure and no formula of the answer stands in an exercise file; the hints ask."""
    text = (ROOT / "exercises" / file).read_text()
    for giveaway in (
        "mg/k",
        "m g / k",
        "max(",
        "clamp",
        "sqrt",
        "0.25",
        "0.0098",
        "0.0567",
        "1409",
        "answer",
    ):
        assert giveaway not in text.replace("load_meta", ""), giveaway
    assert re.search(r"\(\d+ minutes\)", text) and "--hint" in text
    assert all("?" in hint for hint in FACTS[name]["hints"])
    assert not any(typed_numbers(hint) for hint in FACTS[name]["hints"])


def test_hints_are_printed_one_at_a_time_and_only_those_that_exist(copy):
    folder, _ = copy
    for file, name in (("ex1_predict_contact.py", "ex1"), ("ex2_completion_contact.py", "ex2")):
        first = run(folder, f"exercises/{file}", "--hint", "1")
        assert first.returncode == 0 and FACTS[name]["hints"][0] in first.stdout
        none = run(folder, f"exercises/{file}", "--hint", "99")
        assert none.returncode == 2 and "given '99', allowed" in none.stderr


def test_ex2_as_a_script_names_the_blank_and_runs_the_drop_once_filled(copy):
    folder, edit = copy
    untouched = run(folder, "exercises/ex2_completion_contact.py")
    assert (
        untouched.returncode == 2 and untouched.stderr == "penalty_normal_force is still a blank\n"
    )
    for name, blank in BLANKS.items():
        edit("ex2_completion_contact.py", blank, RIGHT[name])
    filled = run(folder, "exercises/ex2_completion_contact.py")
    rest = Numbers(runs=ex1.measure()).value("smoke:quality.penalty.rest_penetration_frac")
    assert filled.returncode == 0 and f"at rest {rest:.5f} r" in filled.stdout, filled.stderr


def test_the_learners_functions_are_the_ones_that_step_the_ball(ex2_checks):
    ex2_checks("f_n", "f_n = 2.0 * stiffness * depth - damping * v_n")
    import checks as module

    scene = contact.build_scene("drop")
    with module.ex2.yours():
        half = contact.run_model("penalty", scene, 0.002, 800)
    whole = contact.run_model("penalty", scene, 0.002, 800)
    sink = contact.max_penetration(whole.q, scene.radius)[-1]
    assert abs(contact.max_penetration(half.q, scene.radius)[-1] - sink / 2) < 1e-9
