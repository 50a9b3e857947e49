"""The steps of `.ci/run`: the README's lines as they stand there, then what authors run.

python3 .ci/steps.py FOLDER    # works in that folder; its last line is "N passed, N failed"
"""

import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import readme

WORK = Path(sys.argv[1])
NOT_A_NEWCOMERS = "UV VIRTUAL_ENV PYTHONPATH CONDA_PREFIX PYTHONDONTWRITEBYTECODE".split()
PLAIN = "curriculum/tests/test_golden.py curriculum/tests/test_exercises.py"
SET = "CI=true RERUN_STRICT=1 RERUN_ANALYTICS=0 MPLBACKEND=Agg PIP_NO_COMPILE=1"
SHELL = {k: v for k, v in os.environ.items() if k not in NOT_A_NEWCOMERS}
SHELL |= dict(each.split("=") for each in SET.split()) | {"UV_PYTHON": sys.executable}
done, start = [], time.monotonic()  # (passed, failed) of each line that was run


def check(name, command, folder, expect=0, **more):
    """Run a line in bash, its input closed; print how it ended. Returns its output."""
    began = time.monotonic()
    process = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", command], cwd=WORK / folder, env=SHELL | more,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors="replace",
    )  # fmt: skip
    printed, now = process.stdout, time.monotonic()
    good = process.returncode == expect and "Traceback" not in printed
    lines = printed.rstrip().splitlines() or [""]
    print(
        f"{'ok    ' if good else 'FAILED'} exit {process.returncode}, {now - began:5.1f} s, "
        f"at {now - start:3.0f} s | {name}: {command}",
        *(f"       | {line}" for line in (lines[-1:] if good else lines[-60:])),
        sep="\n", flush=True,
    )  # fmt: skip
    done.append((1, 0) if good else (0, 1))
    return printed


def side_by_side(*lanes):
    """Run functions at once; where one raises, the others come to their end first."""
    with ThreadPoolExecutor() as pool:
        list(pool.map(lambda lane: lane(), lanes))


def fresh(folder):
    """A fresh clone of what is committed; changes in this folder are not tested."""
    subprocess.run(["git", "clone", "--quiet", readme.ROOT, WORK / folder], check=True)
    (WORK / "kept").mkdir(exist_ok=True)  # numbers and loops, by the hash of their code
    (WORK / folder / ".cache").symlink_to(WORK / "kept")


def row(folder, what, command):
    """One row of "Learning path", with its expected exit status."""
    command = re.sub(r"(/bin/|uv run )rerun ", r"\g<0>rrd verify ", command)  # without a window
    check(what, command, folder, 2 if "/ex1_" in command else 0)  # a bet that is not made yet


def pip_column():
    """The rows of pip in their order, in one environment."""
    fresh("pip")
    check("README, pip: run", readme.set_up("pip")[0], "pip")
    for what, command, _ in readme.rows():
        row("pip", what, command)


def authors():
    """What pip's line for tests installs, in a clone of its own; then what an author runs there."""
    fresh("dev")
    install, _, tests = readme.set_up("pip")[1].rpartition(" && ")
    check("README, pip: test, set-up", install, "dev")
    side_by_side(lambda: suite(tests), checks)


def uv_column():
    """The same by uv, each line from no environment at all; of its tests, that they are found."""
    fresh("uv")
    first, test = readme.set_up("uv")
    found = "uv: test, found", "", f"{test} --collect-only -q"
    for what, _, command in (("uv: run", "", first), *readme.rows(), found):
        shutil.rmtree(WORK / "uv/.venv", ignore_errors=True)
        row("uv", what, command)


def alone():
    """contact.py in an empty folder with numpy alone; then what a learner installs."""
    (WORK / "alone").mkdir()
    shutil.copy(readme.ROOT / "contact.py", WORK / "alone")
    run = "uv run --no-project --with numpy python contact.py --out $it --scene $it"
    line = f"for it in drop bounce stack; do {run}; test -s $it/metrics.json; done"
    check("contact.py alone in an empty folder", line, "alone")
    fresh("bare")
    check("numpy, rerun-sdk, pytest; --smoke twice", ".ci/python", "bare", TESTS=PLAIN)


def suite(command):
    """The tests, by the README's own line, with what is compiled ahead; none may be skipped."""
    check("README, compiled ahead", ".venv/bin/python -m curriculum.compiled", "dev")
    printed = check("README, pip: test", command, "dev")
    counts = re.findall(r"(\d+) (passed|failed|errors?|skipped)\b", printed[-200:])
    passed = sum(int(number) for number, word in counts if word == "passed")
    done.append((passed, sum(int(number) for number, _ in counts) - passed))
    print(*re.findall(r"^(?:SKIPPED|FAILED|ERROR) .*", printed, re.M), sep="\n", flush=True)


def checks():
    """What an author runs beside the tests, and the quick measurements."""
    for name, command in {
        "the gate": "python -m curriculum.gate",
        "ruff": "ruff check . && .venv/bin/ruff format --check .",
        "types": "python -m mypy",
        "CONTRIBUTING": "pre-commit install && .venv/bin/pre-commit validate-config",
        "workflows": "zizmor --offline --quiet --min-severity medium .github",
        "six planted faults": "python -m curriculum.tests.plant --most 6",
        "quick benchmark": "python -m curriculum.bench --quick",
        "quick stress": "python -m curriculum.stress --quick",
    }.items():
        check(name, f".venv/bin/{command}", "dev")


def main():
    """All steps. Returns the exit status."""
    side_by_side(pip_column, lambda: (uv_column(), alone()), authors)
    passed, failed = (sum(each) for each in zip(*done))
    print(f"{time.monotonic() - start:.0f} s\n{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
