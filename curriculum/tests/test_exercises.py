"""The exercises: untouched skips, the reference passes, every tempting wrong fill fails."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

import ex1_predict_contact as ex1  # noqa: E402
import ex2_completion_contact as ex2  # noqa: E402
import ex3_dt_stability as ex3  # noqa: E402
import ex4_predict_soft as ex4  # noqa: E402
import predict  # noqa: E402
import trials  # noqa: E402

import contact  # noqa: E402
from curriculum.check_prose_code_drift import typed_numbers  # noqa: E402
from curriculum.quoted import Numbers, load_meta  # noqa: E402

FACTS = load_meta()["exercises"]
PREDICTED = {"ex1": ex1, "ex3": ex3, "ex4": ex4}
FILES = {
    "ex1": "ex1_predict_contact.py",
    "ex2": "ex2_completion_contact.py",
    "ex3": "ex3_dt_stability.py",
    "ex4": "ex4_predict_soft.py",
}
BLANKS = {"f_n": "f_n = ...", "new_lam": "new_lam = ..."}
RIGHT = {
    "f_n": "f_n = max(0.0, stiffness * depth - damping * v_n)",
    "new_lam": "new_lam = max(0.0, lam + dlam)",
}
# right as well, though not to the last bit
ALSO_RIGHT = {
    "penalty_normal_force": (
        lambda depth, v_n, stiffness, damping: max(stiffness * depth + damping * -v_n, 0),
        lambda depth, v_n, stiffness, damping: (
            (depth * stiffness - v_n * damping) * (depth * stiffness > v_n * damping)
        ),
    ),
    "project_impulse": (
        lambda lam, dlam: lam + max(-lam, dlam),
        lambda lam, dlam: 0.5 * (lam + dlam + abs(lam + dlam)),
    ),
}
SLIPS = [(blank, number) for blank, slips in trials.SLIPS.items() for number in range(len(slips))]


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
                "__pycache__", "tests", "bench", "stress", "page", "drift", "*.html"
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


def test_untouched_every_check_skips_and_pytest_says_why_even_when_quiet():
    result = run(ROOT, "-m", "pytest", "checks.py", "-q", "-p", "no:cacheprovider")
    out = result.stdout
    assert result.returncode == 0 and " passed" not in out and " failed" not in out, out
    for said in (
        "ex1: no prediction yet: in exercises/ex1_predict_contact.py set PREDICTION to one of",
        "ex2: penalty_normal_force is still a blank",
        "ex2: project_impulse is still a blank",
        "ex3: no prediction yet",
        "ex4: no prediction yet",
    ):
        assert said in out


def finish(edit):
    """Do every exercise right."""
    for name, blank in BLANKS.items():
        edit(FILES["ex2"], blank, RIGHT[name])
    for name in PREDICTED:
        edit(FILES[name], "PREDICTION = None ", f"PREDICTION = {FACTS[name]['answer']!r} ")
        edit(FILES[name], 'WHY = ""', 'WHY = "because"')


def test_the_reference_passes_every_check_and_results_json_says_so(copy):
    folder, edit = copy
    finish(edit)
    result = run(folder, "checks.py", "--json", "results.json")
    assert result.returncode == 0 and "8 passed" in result.stdout, result.stdout
    results = json.loads((folder / "results.json").read_text())
    assert results["version"] == 3 and results["status"] == "pass"
    assert {test["status"] for test in results["tests"]} == {"pass"}
    assert {test["task_id"] for test in results["tests"]} == {1, 2, 3, 4}


def test_results_json_tells_what_is_wrong_and_what_is_not_done(copy):
    folder, edit = copy
    edit(FILES["ex2"], BLANKS["new_lam"], "new_lam = lam + dlam")
    assert run(folder, "checks.py", "--json", "new/results.json").returncode == 1
    results = json.loads((folder / "new/results.json").read_text())
    assert set(results) == {"version", "status", "message", "tests"}
    assert results["status"] == "fail"
    said = {test["name"]: test["message"] for test in results["tests"]}
    state = {test["name"]: test["status"] for test in results["tests"]}
    assert state["test_ex1_prediction"] == state["test_ex2_trial[thrown]"] == "fail"
    assert said["test_ex1_prediction"].startswith("not done yet: ex1: no prediction yet")
    assert "likely: nothing keeps the sum" in said["test_ex2_one_input_at_a_time[project_impulse]"]


def test_watch_runs_the_checks_again_when_an_exercise_is_saved(copy):
    folder, edit = copy
    process = subprocess.Popen(
        [sys.executable, "-B", "checks.py", "--watch", "-k", "ex2 and one_input"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        seen = []
        for line in process.stdout:
            seen.append(line)
            if "waiting for an exercise" in line:
                if len(seen) > 1 and "passed" in "".join(seen):
                    break
                edit(FILES["ex2"], BLANKS["f_n"], RIGHT["f_n"])
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
    first, second = "".join(seen).split("waiting for an exercise")[:2]
    assert "penalty_normal_force is still a blank" in first
    assert "1 passed" in second and "penalty_normal_force" not in second


def test_one_file_that_is_no_python_fails_its_own_check_in_one_line_and_no_other(copy):
    folder, edit = copy
    finish(edit)
    right = f"PREDICTION = {FACTS['ex1']['answer']!r} "
    edit(FILES["ex1"], right, "PREDICTION = C ")
    edit(FILES["ex4"], "def measure():", "def measure(:")
    status, out = checks(folder)
    assert status == 1 and "2 failed" in out and "6 passed" in out, out
    assert 'C needs quotes around it: "C"' in out and "SyntaxError: " in out
    assert "Traceback" not in out and "not defined" not in out
    script = run(folder, f"exercises/{FILES['ex1']}")
    assert script.returncode == 2 and script.stdout == "" and script.stderr.count("\n") == 1
    assert "ex1_predict_contact.py, line " in script.stderr and "quotes" in script.stderr


def test_without_yaml_an_exercise_says_in_one_line_what_to_install(copy):
    folder, _ = copy
    code = "import sys; sys.modules['yaml'] = None; sys.path.insert(0, 'exercises')\n"
    code += "import predict, ex1_predict_contact as ex1; sys.exit(predict.play('ex1', ex1, []))"
    result = run(folder, "-c", code)
    assert result.returncode == 2 and result.stderr.count("\n") == 1, result.stderr
    assert "PyYAML" in result.stderr and "pip install" in result.stderr


# exercise 2


@pytest.fixture
def filled(monkeypatch):
    """A function that puts a fill into ex2 and runs its checks: [(test, outcome, text)]."""
    import checks as module

    def attempt(test, argument):
        try:
            test(argument)
            return "passed", ""
        except pytest.skip.Exception as skipped:
            return "skipped", str(skipped)
        except pytest.fail.Exception as failed:
            return "failed", str(failed)

    def fill(blank, function):
        monkeypatch.setattr(ex2, blank, function)
        of = [("one input", module.test_ex2_one_input_at_a_time, blank) for blank in trials.BLANKS]
        of += [("trial", module.test_ex2_trial, each.__name__)
               for each in sum(trials.TRIALS.values(), ())]  # fmt: skip
        return [(kind, argument, *attempt(test, argument)) for kind, test, argument in of]

    return fill


@pytest.mark.parametrize("blank, number", SLIPS)
def test_a_tempting_wrong_fill_fails_with_input_got_expected_and_its_slip_by_name(
    filled, blank, number
):
    function, meaning = trials.SLIPS[blank][number]
    found = {(kind, name): (outcome, text) for kind, name, outcome, text in filled(blank, function)}
    outcome, text = found["one input", blank]
    assert outcome == "failed" and f"likely: {meaning}" in text
    assert all(part in text for part in ("got ", "expected ", "where to look: "))
    assert text.startswith(f"{blank}(")
    other = next(name for name in trials.BLANKS if name != blank)
    assert found["one input", other][0] == "skipped"


@pytest.mark.parametrize("blank, number", SLIPS)
def test_the_script_tells_a_wrong_fill_from_the_right_one_and_names_it(
    blank, number, monkeypatch, capsys
):
    function, meaning = trials.SLIPS[blank][number]
    monkeypatch.setattr(ex2, blank, function)
    assert trials.tried(ex2, blank) == 1
    out = capsys.readouterr().out
    assert "another run" in out and f"{blank}: {meaning}\n" in out


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("blank", trials.BLANKS)
def test_any_way_to_write_the_right_line_passes_script_and_checks(
    filled, blank, number, monkeypatch, capsys
):
    function = ALSO_RIGHT[blank][number]
    for kind, name, outcome, text in filled(blank, function):
        mine = name == blank or name in [trial.__name__ for trial in trials.TRIALS[blank]]
        assert outcome == ("passed" if mine else "skipped"), (kind, name, text)
    assert trials.tried(ex2, blank) == 0
    out = capsys.readouterr().out
    assert "the same run" in out and "another" not in out


def test_each_clamp_is_seen_in_a_trial():
    """A damper holds back a ball that leaves; a table holds back; a groove throws out."""
    exercise = SimpleNamespace(
        penalty_normal_force=trials.SLIPS["penalty_normal_force"][0][0],
        project_impulse=trials.SLIPS["project_impulse"][0][0],
    )
    right = {trial.__name__: trial()[1] for trial in sum(trials.TRIALS.values(), ())}
    with trials.yours(exercise):
        pressed, thrown = trials.pressed()[1], trials.thrown()[1]
    assert right["pressed"]["the table pulls [N]"] == 0.0 and pressed["the table pulls [N]"] > 50
    assert right["pressed"]["it jumps"] > 1.5 * pressed["it jumps"]
    assert right["thrown"]["it rises"] > 1.9 and thrown["it rises"] == 0.0
    exercise.project_impulse = trials.SLIPS["project_impulse"][1][0]
    with trials.yours(exercise):
        thrown_out = trials.groove()[1]["it ends off the groove by"]
    assert right["groove"]["it ends off the groove by"] < 1e-3 and thrown_out > 1.0


@pytest.mark.parametrize("stiffness", [10.0, 1e3, 5e3, 1e4, 1e5])
def test_a_number_in_place_of_stiffness_passes_at_no_stiffness(filled, stiffness):
    def function(depth, v_n, stiffness_, damping):
        return max(0.0, stiffness * depth - damping * v_n)

    assert filled("penalty_normal_force", function)[0][2] == "failed"


def test_contact_pys_own_functions_are_refused_by_name_however_they_are_called(filled, capsys):
    kept = contact.penalty_normal_force
    for function in (
        lambda depth, v_n, stiffness, damping: contact.penalty_normal_force(
            depth, v_n, stiffness, damping
        ),
        lambda *given, **named: kept(*given, **named),
    ):
        outcomes = filled("penalty_normal_force", function)
        assert outcomes[0][2:] == (
            "failed",
            "penalty_normal_force calls contact.penalty_normal_force: write the line yourself",
        )
        assert trials.tried(ex2, "penalty_normal_force") == 2
        assert "write the line yourself" in capsys.readouterr().err
    assert contact.penalty_normal_force(0.01, 0.0, 1e4, 0.0) == 100.0, "it works again"


def test_a_fill_that_raises_or_returns_no_number_gives_one_line(filled):
    def numpy(lam, dlam):
        return np.maximum(0.0, lam + dlam)  # noqa: F821

    for function, said in (
        (numpy, "NameError: name 'np' is not defined. These are plain numbers"),
        (lambda lam, dlam: None, "returned None, and not a number"),
        (lambda lam, dlam: lam > 0.0, "returned False, and not a number"),
        (lambda lam: lam, "raised TypeError"),
    ):
        text = filled("project_impulse", function)[1][3]
        assert said in text and "\n" not in text


def test_ex2_as_a_script_names_the_blanks_and_runs_its_trials_once_filled(copy):
    folder, edit = copy
    untouched = run(folder, f"exercises/{FILES['ex2']}")
    assert untouched.returncode == 2
    asked, waits = untouched.stdout, untouched.stderr.splitlines()
    for number, name in enumerate(trials.BLANKS):
        assert f"{number + 1}  {name}: The " in asked, "what the blank is to give"
        assert waits[number].startswith(f"{name} is still a blank: in exercises/{FILES['ex2']} ")
        assert f"TODO: blank {number + 1}" in waits[number]
        assert f"TODO: blank {number + 1}" in (folder / "exercises" / FILES["ex2"]).read_text()
        assert f"--hint {2 * number + 1} " in waits[number]
    for name, blank in BLANKS.items():
        edit(FILES["ex2"], blank, RIGHT[name])
    done = run(folder, f"exercises/{FILES['ex2']}")
    assert done.returncode == 0 and done.stdout.count("the same run") == 3, done.stderr
    assert FILES["ex3"] in done.stdout.splitlines()[-1], "what comes next"
    assert "e-0" not in done.stdout, "what is 0 but for rounding is printed as 0"


def test_each_trial_can_be_recorded_yours_beside_the_reference(monkeypatch, tmp_path, capsys):
    pytest.importorskip("rerun", reason="rerun is not installed")
    monkeypatch.chdir(tmp_path)
    wrong = trials.SLIPS["project_impulse"][1][0]
    monkeypatch.setattr(ex2, "project_impulse", wrong)
    assert trials.tried(ex2, "project_impulse", recorded=True) == 1
    assert capsys.readouterr().out.count("watch it: ") == 2
    made = sorted(path.name for path in (tmp_path / "outputs/ch3.5-contact").iterdir())
    assert made == ["ex2-groove.rrd", "ex2-thrown.rrd"]
    assert "yours" not in contact.COLORS


def test_the_learners_functions_are_the_ones_that_step_the_ball():
    """A spring twice as stiff sinks half as deep."""
    stiff = SimpleNamespace(
        penalty_normal_force=lambda depth, v_n, stiffness, damping: max(
            0.0, 2.0 * stiffness * depth - damping * v_n
        )
    )
    scene = contact.build_scene("drop")
    with trials.yours(stiff):
        half = contact.run_model("penalty", scene, 0.002, 800)
    whole = contact.run_model("penalty", scene, 0.002, 800)
    sink = contact.max_penetration(whole.q, scene.radius)[-1]
    assert abs(contact.max_penetration(half.q, scene.radius)[-1] - sink / 2) < 1e-9


# exercises 1, 3 and 4


@pytest.mark.parametrize("name", PREDICTED)
def test_a_predict_exercise_asks_and_refuses_to_run_before_choice_and_reason(
    name, monkeypatch, capsys
):
    exercise = PREDICTED[name]
    monkeypatch.setattr(exercise, "measure", lambda: pytest.fail("it ran"))
    for prediction, why, said in (
        (None, "", "no prediction yet"),
        ("D", "x", "given 'D', allowed: 'A', 'B', 'C'"),
        (3, "x", "given 3, allowed: 'A', 'B', 'C'"),
        ("A", " ", "no reason yet"),
    ):
        monkeypatch.setattr(exercise, "PREDICTION", prediction)
        monkeypatch.setattr(exercise, "WHY", why)
        assert predict.play(name, exercise, []) == 2
        out, err = capsys.readouterr()
        assert said in err and err.strip().count("\n") == 0
        plain = " ".join(out.split())
        assert exercise.QUESTION in plain
        assert all(f"{letter} {text}" in plain for letter, text in exercise.CHOICES.items())


@pytest.mark.parametrize("typed", ["c", " C ", "c)", "C."])
def test_a_letter_is_taken_as_a_person_types_it(typed, monkeypatch, capsys):
    monkeypatch.setattr(ex1, "PREDICTION", typed)
    monkeypatch.setattr(ex1, "WHY", "so it is")
    assert predict.play("ex1", ex1, []) == 0
    assert "You predicted C: The penalty ball" in capsys.readouterr().out


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
    plain = " ".join(out.split())
    assert f"You predicted {mine}: {exercise.CHOICES[mine]} Because: a reason of mine" in plain
    told = f"What happens is {answer}: {exercise.CHOICES[answer]}"
    assert ("That is what happens." if mine == answer else told) in plain
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


@pytest.mark.parametrize("name, file", FILES.items())
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
        "0.0036",
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
