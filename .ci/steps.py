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
OPENS_A_WINDOW = (".venv/bin/rerun ", "uv run rerun ")  # so CI reads the recording instead
NOT_A_NEWCOMERS = "UV VIRTUAL_ENV PYTHONPATH CONDA_PREFIX PYTHONDONTWRITEBYTECODE".split()
SET = "CI=true RERUN_STRICT=1 RERUN_ANALYTICS=0 MPLBACKEND=Agg PIP_NO_COMPILE=1"
SHELL = {k: v for k, v in os.environ.items() if k not in NOT_A_NEWCOMERS}
SHELL |= dict(each.split("=") for each in SET.split()) | {"UV_PYTHON": sys.executable}
done, start = [], time.monotonic()  # (passed, failed) of each line that was run


def check(name, command, folder, expect=0, **more):
    """Run a line in bash, its input closed; print how it ended. Returns its output."""
    began = time.monotonic()
    words = ["bash", "-euo", "pipefail", "-c", command]
    ended = subprocess.run(
        words, cwd=WORK / folder, env=SHELL | more, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
    )  # fmt: skip
    good = ended.returncode == expect and "Traceback" not in ended.stdout
    lines = ended.stdout.rstrip().splitlines() or [""]
    now = time.monotonic()
    print(
        f"{'ok    ' if good else 'FAILED'} exit {ended.returncode}, {now - began:5.1f} s, "
        f"at {now - start:3.0f} s | {name}: {command}",
        *(f"       | {line}" for line in (lines[-1:] if good else lines[-60:])),
        sep="\n", flush=True,
    )  # fmt: skip
    done.append((1, 0) if good else (0, 1))
    return ended.stdout


def fresh(folder):
    """A fresh clone of what is committed; changes in this folder are not tested."""
    subprocess.run(["git", "clone", "--quiet", readme.ROOT, WORK / folder], check=True)
    (WORK / "numbers").mkdir(exist_ok=True)  # that the text quotes; kept by the hash of their code
    (WORK / folder / ".cache").symlink_to(WORK / "numbers")


def row(folder, what, command):
    """One row of "Learning path", with its expected exit status; page and notebook are kept."""
    for start in OPENS_A_WINDOW:
        command = command.replace(start, f"{start}rrd verify ")
    check(what, command, folder, 2 if "/ex1_" in command else 0)  # a bet that is not made yet
    for path in (WORK / folder / "outputs").glob("contact.*"):
        path.rename(WORK / f"{folder}-{path.name}")


def pip_column():
    """The first set-up line; then every row in the environment that it made, and nothing else."""
    folder = WORK / "pip"
    check("README, pip: run", readme.set_up("pip")[0], "pip")
    assert list(folder.glob("outputs/*/contact.rrd")), "the main job made no recording"
    (folder / ".venv").rename(WORK / "first")
    for what, command, _ in readme.rows():
        shutil.rmtree(folder / ".venv", ignore_errors=True)  # pip replaces files: links will do
        shutil.copytree(WORK / "first", folder / ".venv", symlinks=True, copy_function=os.link)
        row("pip", what, command)


def uv_column():
    """The same by uv, each time from no environment at all; of its tests, that they are found."""
    first, test = readme.set_up("uv")
    found = "uv: test, found", "", f"{test} --collect-only -q"
    for what, _, command in (("uv: run", "", first), *readme.rows(), found):
        shutil.rmtree(WORK / "uv/.venv", ignore_errors=True)
        row("uv", what, command)
    check("uv: page and notebook", "test -s ../uv-contact.html -a -s ../uv-contact.ipynb", "uv")


def authors():
    """What an author has, in the environment that the README's line makes; beside it, its tests."""
    fresh("dev")
    install, _, tests = readme.set_up("pip")[1].rpartition(" && ")
    check("README, pip: test, set-up", install, "dev")
    with ThreadPoolExecutor() as pool:  # side by side
        list(pool.map(lambda lane: lane(), (lambda: suite(tests), checks)))


def suite(command):
    """The tests, by the README's own line; none may be skipped."""
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
        "ten planted faults": "python -m curriculum.tests.plant --most 10",
        "quick benchmark": "python -m curriculum.bench --quick",
        "quick stress": "python -m curriculum.stress --quick",
    }.items():
        check(name, f".venv/bin/{command}", "dev")


def alone():
    """contact.py in an empty folder with numpy alone; and with rerun and pytest, the tests."""
    shutil.copy(readme.ROOT / "contact.py", WORK / "alone")
    run = "uv run --no-project --with numpy python contact.py --out $it --scene $it"
    line = f"for it in drop bounce stack; do {run}; test -s $it/metrics.json; done"
    check("contact.py alone in an empty folder", line, "alone")
    fresh("bare")
    check("numpy, rerun-sdk, pytest; --smoke twice", ".ci/python", "bare", PYTHON=sys.executable)


def main():
    """All steps. Returns the exit status."""
    (WORK / "alone").mkdir()
    fresh("pip"), fresh("uv")
    with ThreadPoolExecutor() as pool:  # where one raises, the others come to their end first
        list(pool.map(lambda lane: lane(), (pip_column, uv_column, alone, authors)))
    for name, file in {"page": "contact.html", "notebook": "contact.ipynb"}.items():
        again = f".venv/bin/python -m curriculum.{name} --out {file} && cmp {file} ../pip-{file}"
        check(f"the {name} is the one that the tests look at", again, "dev")
    passed, failed = (sum(each) for each in zip(*done))
    print(f"{time.monotonic() - start:.0f} s; lines of the README and of authors, and the tests:")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
