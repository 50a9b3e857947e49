"""Checks of the exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex2`.

    python checks.py                # the same, and writes results.json, for programs that ask
    python checks.py --watch        # again whenever an exercise is saved

What is not done yet is skipped by name; what is wrong fails with input, got, expected and where to
look. The answers are contact.py (imported) and meta.yaml, which also holds the bands.
"""

import importlib
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

import predict  # noqa: E402
import trials  # noqa: E402
from predict import contact, stoppable  # noqa: E402

FILES = {"ex1": "ex1_predict_contact", "ex2": "ex2_completion_contact", "ex3": "ex3_dt_stability",
         "ex4": "ex4_predict_soft"}
HINTS = {"penalty_normal_force": "1 or 2", "project_impulse": "3 or 4"}


def load(name):
    """The module of an exercise; a file that is no Python fails its own check and no other."""
    try:
        return importlib.import_module(FILES[name])
    except (NameError, SyntaxError) as error:
        trouble = predict.unreadable(f"exercises/{FILES[name]}.py", error)
    pytest.fail(f"{name}: {trouble}", pytrace=False)


def check_prediction(name):
    """Skip before a prediction; then measure again, hold the bands, and compare."""
    from curriculum.quoted import Numbers
    exercise, facts = load(name), predict.meta(name)
    todo = predict.missing(exercise)
    if todo:
        pytest.skip(f"{name}: {todo}")
    runs = exercise.measure()
    numbers = Numbers(runs=runs)
    for key, (low, high) in facts["bands"].items():
        value = numbers.value(key)
        assert low <= value <= high, f"{key} is {value}, outside {low} to {high}"
    for claim in facts["holds"]:
        assert numbers.holds(claim), f"{claim} does not hold"
    if predict.chosen(exercise) != facts["answer"]:
        said = f"{exercise.table(runs)}\n\n{predict.verdict(name, exercise, runs)}"
        pytest.fail(said, pytrace=False)


def test_ex1_prediction():
    check_prediction("ex1")


def test_ex3_prediction():
    check_prediction("ex3")


def test_ex4_prediction():
    check_prediction("ex4")


def values(blank):
    """(inputs, what the learner's function gives for each); skips a blank, fails one that raises."""
    function, cases, found = getattr(load("ex2"), blank), trials.inputs(blank), []
    for case in cases:
        got, trouble = trials.called(function, blank, case)
        if trouble:
            pytest.fail(trouble, pytrace=False)
        if got is ...:
            pytest.skip(f"ex2: {blank} is still a blank")
        found.append(got)
    return cases, found


def check_blank(blank):
    """Hold the learner's function to contact.py's on every input; say the first that is wrong."""
    cases, found = values(blank)
    within = predict.meta("ex2")["within"]
    expected = [getattr(contact, blank)(**case) for case in cases]
    wrong = [place for place, (got, right) in enumerate(zip(found, expected))
             if not abs(got - right) <= within * max(1.0, abs(right))]
    if wrong:
        first = wrong[0]
        fail(f"{blank}({', '.join(f'{key}={value!r}' for key, value in cases[first].items())})",
             found[first], expected[first], blank, trials.slip(blank, found),
             f"wrong on {len(wrong)} of {len(cases)} inputs, of which this is the first")


def fail(call, got, expected, blank, likely, note=None):
    """Fail with what a learner needs, and no traceback."""
    lines = [call, f"  got       {got!r}", f"  expected  {expected!r}"]
    lines += [f"  {note}"] if note else []
    lines += [f"  likely: {likely}"] if likely else []
    script = predict.shell.python(str(ROOT / "exercises" / f"{FILES['ex2']}.py"), extra="learn")
    lines += [f"  where to look: {blank} in exercises/{FILES['ex2']}.py, the sign table at the top "
              f"of contact.py, or {script} --hint {HINTS[blank]}"]
    pytest.fail("\n".join(lines), pytrace=False)


@pytest.mark.parametrize("blank", trials.BLANKS)
def test_ex2_one_input_at_a_time(blank):
    check_blank(blank)


@pytest.mark.parametrize("trial", [trial.__name__ for trial in sum(trials.TRIALS.values(), ())])
def test_ex2_trial(trial):
    """The trial must go as with contact.py's own line: see the script of exercise 2."""
    blank = next(name for name, found in trials.TRIALS.items()
                 if trial in [each.__name__ for each in found])
    likely = trials.slip(blank, values(blank)[1])
    run = getattr(trials, trial)
    expected = run()[1]
    with trials.yours(load("ex2")):
        got = run()[1]
    for name, value in expected.items():
        if not abs(got[name] - value) <= 1e-4 * max(1.0, abs(value)):
            fail(f"the trial {trial!r}: {name}", got[name], value, blank, likely)


class Results:
    """Collects what pytest finds, in the shape that exercism's test runners write."""

    def __init__(self):
        self.tests = []

    def pytest_runtest_logreport(self, report):
        """Keep one entry a test: what it said in its call, or that it was skipped."""
        if report.when != "call" and not report.skipped and report.passed:
            return
        name = report.nodeid.rpartition("::")[2]
        status = {"passed": "pass", "skipped": "fail"}.get(
            report.outcome, "fail" if report.when == "call" else "error")
        message = None
        if report.skipped:
            message = f"not done yet: {report.longrepr[2].removeprefix('Skipped: ')}"
        elif report.failed:
            message = str(report.longrepr)
        self.tests.append({"name": name, "status": status, "message": message, "output": None,
                           "task_id": int(name.removeprefix("test_ex")[0])})

    def as_dict(self):
        """version 3: status, message, and the tests, each with the exercise it belongs to."""
        states = {test["status"] for test in self.tests}
        status = "pass" if states == {"pass"} else "fail"
        return {"version": 3, "status": status, "message": None, "tests": self.tests}


def run_once(selected, path):
    """Run the checks, print what is skipped and why, write results.json. Returns pytest's status."""
    from curriculum.common.results import write_json
    results = Results()
    words = ["-q", "-rs", *(["-k", selected] if selected else [])]
    status = pytest.main([str(ROOT / "checks.py"), *words], plugins=[results])
    if status == pytest.ExitCode.INTERRUPTED:
        raise KeyboardInterrupt
    try:
        write_json(path, results.as_dict())
    except OSError as error:
        print(f"checks.py: error: cannot write {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    print("results:", path)
    return int(status)


def watch(argv):
    """Run the checks again, each time in a new process, whenever an exercise is saved."""
    import subprocess
    import time
    before = None
    while True:
        now = {file: file.stat().st_mtime_ns for file in ROOT.glob("exercises/*.py")}
        if now != before:
            before = now
            subprocess.run([sys.executable, str(ROOT / "checks.py"), *argv], check=False)
            print("\nwaiting for an exercise to be saved; Ctrl-C ends\n", flush=True)
        time.sleep(0.2)


@stoppable
def main(argv=None):
    """Run the checks once, or again and again. Returns the exit status."""
    from curriculum.common.arguments import Parser
    parser = Parser(prog="checks.py", description="Check the exercises.")
    parser.add_argument("-k", default="", metavar="WORDS", help="only those, as pytest's -k")
    parser.add_argument("--watch", action="store_true", help="again whenever an exercise is saved")
    parser.add_argument("--json", default="outputs/ch3.5-contact/results.json", metavar="FILE",
                        help="where the results go (%(default)s)")
    args = parser.parse_args(argv)
    if not args.watch:
        return run_once(args.k, args.json)
    try:
        watch(["--json", args.json, *(["-k", args.k] if args.k else [])])
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
