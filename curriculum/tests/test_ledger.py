"""The ledger: measured rows are of the script as it is; a failed measurement writes nothing."""

import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from curriculum import check_prose_code_drift as gate
from curriculum.common import device, wallclock
from curriculum.quoted import Numbers

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = """import sys, pathlib
out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
{action}
print("config_hash: c0ffee")
"""


def ledger_problems(root, numbers):
    project = SimpleNamespace(root=root, problems=[])
    project.say = lambda file, line, what, repair: project.problems.append(
        f"{file}:{line}: {what}; repair: {repair}"
    )
    gate.check_ledger(project, numbers)
    return project.problems


def test_the_ledger_shows_every_tier_of_the_course_and_claims_only_what_was_measured():
    rows = {row["tier"]: row for row in wallclock.read() if row["chapter"] == wallclock.CHAPTER}
    assert set(wallclock.SHOWN) <= set(rows)
    assert [
        tier for tier, row in rows.items() if row["status"] == "MEASURED"
    ], "no row is measured yet"
    for row in rows.values():
        if row["status"] == "MEASURED":
            assert re.fullmatch(r"[0-9a-f]{7,40}", row["commit"]) and re.fullmatch(
                r"\d{4}-\d\d-\d\d", row["date"]
            )


def test_every_measured_row_is_of_the_scripts_default_run_as_it_is_now():
    assert ledger_problems(ROOT, Numbers()) == []


def test_a_row_whose_config_hash_no_longer_matches_is_refused(tmp_path):
    shutil.copy(ROOT / "meta.yaml", tmp_path)
    wallclock.write_row(
        "cpu-vm", 0.004, "0ldc0nf19", "1234567", "2026-01-02", tmp_path / "wallclock.csv"
    )
    numbers = Numbers(tmp_path, runs={"drop": {}})
    numbers.config_hash["drop"] = "c0ffee"
    (problem,) = ledger_problems(tmp_path, numbers)
    assert problem.startswith(
        "wallclock.csv:6: cpu-vm was measured at config 0ldc0nf19, the default run is now c0ffee"
    )


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A project whose contact.py is a stand-in: what it does, and what git finds changed."""
    changed = [""]
    monkeypatch.setattr(wallclock, "ROOT", str(tmp_path))
    monkeypatch.setattr(wallclock, "LEDGER", str(tmp_path / "wallclock.csv"))
    monkeypatch.setattr(
        "subprocess.check_output",
        lambda words, **_: changed[0] if "status" in words else "1234567\n",
    )

    def make(action, git_status=""):
        changed[0] = git_status
        (tmp_path / "contact.py").write_text(SCRIPT.format(action=action))
        return tmp_path

    return make


def test_measuring_writes_this_machines_row_with_the_hash_that_the_script_prints(project, capsys):
    folder = project('(out / "contact.rrd").write_text("x")')
    assert wallclock.main(["--measure", "--runs", "3"]) == 0
    (row,) = [row for row in wallclock.read() if row["status"] == "MEASURED"]
    assert (row["tier"], row["config_hash"], row["commit"]) == (
        device.cpu_tier(),
        "c0ffee",
        "1234567",
    )
    assert 0 < float(row["wallclock_min"]) < 0.1
    assert re.search(rf"^{row['tier']} +[\d.e-]+ min \(.* s\)$", capsys.readouterr().out, re.M)
    assert len((folder / "wallclock.csv").read_text().splitlines()) == 6


@pytest.mark.parametrize(
    "action, said",
    [("pass", "rerun is missing"), ("sys.exit('broken')", "contact.py failed: broken")],
)
def test_a_run_that_fails_or_records_nothing_writes_nothing(project, capsys, action, said):
    folder = project(action)
    assert wallclock.main(["--measure", "--runs", "3"]) == 1
    assert said in capsys.readouterr().err and not (folder / "wallclock.csv").exists()


def test_a_script_that_is_not_committed_as_it_is_is_not_measured(project, capsys):
    folder = project('(out / "contact.rrd").write_text("x")', " M contact.py\n")
    assert wallclock.main(["--measure", "--runs", "3"]) == 1
    assert "commit it first" in capsys.readouterr().err and not (folder / "wallclock.csv").exists()


def test_too_few_runs_for_a_median_are_refused(capsys):
    with pytest.raises(SystemExit) as caught:
        wallclock.main(["--measure", "--runs", "2"])
    assert (
        caught.value.code == 2
        and "given '2', allowed: a whole number >= 3" in capsys.readouterr().err
    )
