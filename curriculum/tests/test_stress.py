"""The stress test sees nothing where nothing is, has tight bounds, and counts."""

import itertools
from importlib import import_module

import numpy as np
import pytest

from curriculum import stored
from curriculum.stress import jobs, report, scenes
from curriculum.stress.properties import PROPERTIES, compare, unlike
from curriculum.stress.trial import Trial

command = import_module("curriculum.stress.__main__")  # after these: what they lack is said by name


@pytest.fixture(scope="module")
def found():
    """{section: what its jobs give} of the quick run, with 120 small scenes that are not in it."""
    todo = jobs.all_jobs(quick=True) | {"scenes": jobs.scene_jobs(range(100, 220), small=True)}
    return {section: [jobs.run(job) for job in each] for section, each in todo.items()}


@pytest.fixture(scope="module")
def judged(found):
    """What they come to: {property: its row}."""
    rows = jobs.added_up(itertools.chain(*found.values()))[0]
    return {row["property"]: row for row in rows}


def test_no_claim_is_violated_by_the_code_as_it_stands(judged):
    assert [row for row in judged.values() if row["violations"]] == []


LOOSE = {"finite_or_said_to_have_exploded", "a_skip_changes_no_bit",  # yes or no
         "penalty_settles_as_its_critical_dt_says", "a_run_goes_on_from_any_of_its_states",
         "leapfrog_gains_no_energy", "leapfrog_loses_none_where_all_bounces",
         "leapfrog_stays_symmetric"}  # chosen  # fmt: skip


def test_bounds_are_as_tight_as_what_is_found(judged):
    """What is off comes to at least 3e-4 of each bound: one that is far too wide is seen here."""
    assert {name for name, row in judged.items() if row["share"] < 3e-4} == LOOSE, judged


def test_runs_that_differ_in_the_last_bit_are_unlike():
    run = Trial(scenes.numbered_spec(3, small=True)).run("lcp")
    other = run._replace(q=np.nextafter(run.q, 9.0))
    assert unlike(run, other)[0].any() and not unlike(run, run)[0].any()


def test_what_is_off_and_where_is_counted_and_said():
    row = [0, 0.0, None]
    compare(row, "x", np.array([1.0, 3.0, np.nan, 9.0]), 2.0, np.array([True, True, True, False]))
    assert row == [3, np.inf, "x: 3, bound 2, at (1,)"]


def test_counts_add_up_and_what_judges_nothing_is_a_violation():
    found = [("a", {"p": [2, 0.1, None], "q": [0, 0.0, None]}, {"met": {"n": 1}}),
             ("b", {"p": [3, 0.4, "off"], "q": [0, 0.0, None]}, {"met": {"n": 2}})]  # fmt: skip
    rows, notes = jobs.added_up(found)
    assert [list(row.values()) for row in rows] == [
        ["p", 2, 5, 0.4, 1, "b: off"], ["q", 0, 0, 0.0, 1, "judged 0 times"]]  # fmt: skip
    assert notes == {"met": {"a": {"n": 1}, "b": {"n": 2}}}


def test_a_number_that_is_off_is_a_violation_and_a_flight_says_nothing_of_contacts():
    ball = {"x": [0.0], "y": [9.0], "vx": [0.0], "vy": [0.0], "mass": [1.0], "radius": [0.1]}
    flight = Trial(scenes.numbered_spec(0, small=True) | ball | {"steps": 5})
    found = jobs.properties.judge(flight, *PROPERTIES.values())
    assert found["enough_sweeps_solve_lcp"] == [0, 0.0, None]
    assert not any(words for _, _, words in found.values())
    flight.run("lcp").q[3, 1, 0] += 1e-9
    del flight.motions
    found = jobs.properties.judge(flight, *PROPERTIES.values())
    said = found["momenta_are_gravitys_and_what_contacts_report"][2]
    assert said.startswith("lcp, moves [m]: 1e-09, bound ")


def test_a_place_is_judged_alone_and_what_is_none_is_refused(capsys):
    assert command.main(["small scene 3"]) == 0
    assert "'a_skip_changes_no_bit', 'judged': 1, " in capsys.readouterr().out
    with pytest.raises(SystemExit):
        command.main(["scene -1"])
    assert "given 'scene -1'; allowed: scene 0, " in capsys.readouterr().err


def test_a_run_writes_tables_a_page_and_a_map(found, tmp_path):
    assert report.write(found, stored.origin("stress", kept=False), tmp_path) == 0
    page = (tmp_path / "README.md").read_text("utf-8")
    assert " checks none failed." in page and "| 2 ms | heap | leapfrog | 0 |" in page
    assert all(" ".join(f.__doc__.split("\n\n")[0].split()) in page for f in PROPERTIES.values())
    assert "settles at m g / k" in (tmp_path / "penalty-map.svg").read_text("utf-8")


def test_page_and_block_are_made_of_the_tables_that_are_kept():
    tables, made = stored.load(report.FOLDER)
    page = (report.RESULTS / "README.md").read_text("utf-8")
    assert page == report.page(tables, made) and page.count("\n") <= 150
    assert report.readme(tables) in (stored.ROOT / "README.md").read_text("utf-8")
