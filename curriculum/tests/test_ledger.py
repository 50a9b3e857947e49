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
    """What the gate finds wrong with the ledger at `root`, and which rows it calls stale."""
    project = SimpleNamespace(root=root, problems=[])
    project.say = lambda file, line, what, repair: project.problems.append(
        f"{file}:{line}: {what}; repair: {repair}"
    )
    return project.problems, gate.check_ledger(project, numbers)


def test_the_ledger_shows_every_tier_of_the_course_and_claims_only_what_was_measured():
    rows = {row["tier"]: row for row in wallclock.read() if row["chapter"] == wallclock.CHAPTER}
    assert set(wallclock.SHOWN) <= set(rows)
    assert [tier for tier, row in rows.items() if row["status"] == "MEASURED"], (
        "no row is measured yet"
    )
    for row in rows.values():
        if row["status"] == "MEASURED":
            assert re.fullmatch(r"[0-9a-f]{7,40}", row["commit"]) and re.fullmatch(
                r"\d{4}-\d\d-\d\d", row["date"]
            )


def test_every_measured_row_has_its_times_beside_it():
    assert ledger_problems(ROOT, Numbers())[0] == []


@pytest.fixture
def ledger(tmp_path, measured_row):
    """A ledger with one row, the numbers of a run with that hash, and what the gate says."""
    shutil.copy(ROOT / "meta.yaml", tmp_path)
    (tmp_path / "contact.py").write_text("x = 1  # a comment\n")
    measured_row(tmp_path, [0.3, 0.2, 0.25])

    def check(printed="c0ffee"):
        numbers = Numbers(tmp_path, runs={"drop": {}})
        numbers.config_hash["drop"] = printed
        return ledger_problems(tmp_path, numbers)

    return check


def test_a_row_is_the_median_of_its_times_and_fresh(ledger, tmp_path):
    assert wallclock.lookup(wallclock.CHAPTER, "cpu-vm", tmp_path / "wallclock.csv") == 0.00417
    assert ledger() == ([], {})


def test_a_row_of_other_flags_or_of_other_code_is_stale(ledger, tmp_path):
    stale = {"wallclock:cpu-vm": "python -m curriculum.common.wallclock --measure"}
    assert ledger(printed="decaff") == ([], stale)
    (tmp_path / "contact.py").write_text("x = 1  # another comment\n")
    assert ledger() == ([], {})
    (tmp_path / "contact.py").write_text("x = 2\n")
    assert ledger() == ([], stale)


@pytest.mark.parametrize(
    "old, new, said",
    [
        (
            "0.00417",
            "0.00317",
            "wallclock_min is 0.00317, but curriculum/wallclock_runs.json has 0.00417",
        ),
        ("1234567", "7654321", "commit is 7654321, but curriculum/wallclock_runs.json has 1234567"),
        (
            "2026-01-02",
            "2026-01-03",
            "date is 2026-01-03, but curriculum/wallclock_runs.json has 2026-01-02",
        ),
        ("mps,,,,,PENDING", "mps,1,c0ffee,1234567,2026-01-02,MEASURED", "no times of mps"),
    ],
)
def test_what_is_typed_into_the_ledger_is_refused(ledger, tmp_path, old, new, said):
    path = tmp_path / "wallclock.csv"
    path.write_text(path.read_text().replace(old, new))
    (problem,), _ = ledger()
    assert said in problem and problem.startswith("wallclock.csv:")


def test_times_that_were_edited_are_refused_even_if_the_median_stays(ledger, tmp_path):
    path = tmp_path / wallclock.RUNS
    path.write_text(path.read_text().replace("0.3,", "0.9,"))
    (problem,), _ = ledger()
    assert "curriculum/wallclock_runs.json was edited: its digest no longer fits" in problem


def test_a_tier_that_the_course_does_not_show_is_refused(ledger, tmp_path):
    path = tmp_path / "wallclock.csv"
    path.write_text(path.read_text().replace(",4090,", ",4097,"))
    problems, _ = ledger()
    assert len(problems) == 2 and "tier 4090 has" in problems[0] and "tier 4097" in problems[1]


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
        wallclock.run_hash("c0ffee"),
        "1234567",
    )
    times = wallclock.read_runs()[row["tier"]]["seconds"]
    assert len(times) == 3 and row["wallclock_min"] == f"{sorted(times)[1] / 60:.3g}"
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
