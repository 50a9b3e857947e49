"""The stress test sees nothing where nothing is, has tight bounds, and counts."""

import numpy as np
import pytest
import scipy  # noqa: F401  # which the stress test loads late: skip by its name

import contact
from curriculum.stress import __main__ as command
from curriculum.stress import heaps, jobs, maps, mujoco_match, scenes
from curriculum.stress.properties import PROPERTIES, unlike
from curriculum.stress.trial import Trial


@pytest.fixture(scope="module")
def judged():
    """What judging small scenes, maps, matches and a heap comes to."""
    todo = jobs.scene_jobs(range(250), small=True)
    todo += [*maps.map_jobs(True)][::3] + [*mujoco_match.match_jobs(True)][::2]
    todo.append(("heap 0", heaps.Heap(0), [heaps.leapfrog_is_of_second_order]))
    return jobs.added_up(map(jobs.run, todo))


def test_no_claim_is_violated_by_the_code_as_it_stands(judged):
    assert judged["violations"] == []


YES_OR_NO = {"finite_or_said_to_have_exploded", "a_skip_changes_no_bit",
             "a_far_ball_changes_nothing", "penalty_settles_as_its_critical_dt_says"}  # fmt: skip
CHOSEN = {"leapfrog_adds_no_energy_once_its_sweeps_are_done"}


def test_bounds_are_as_tight_as_what_is_found(judged):
    """What is off comes to at least 3e-4 of each bound: one that is far too wide is seen here."""
    shares = {name: share for name, (_, _, share) in judged["properties"].items()}
    assert {name for name, share in shares.items() if share < 3e-4} == YES_OR_NO | CHOSEN, shares


def test_runs_that_differ_in_the_last_bit_are_unlike():
    run = Trial(scenes.numbered_spec(3, small=True)).run("lcp")
    other = run._replace(q=np.nextafter(run.q, 9.0))
    assert unlike(run, other)[0].any() and not unlike(run, run)[0].any()


def test_scenes_have_all_that_is_hard():
    specs = [scenes.numbered_spec(number) for number in range(400)]
    assert {spec["layout"] for spec in specs} == {layout.__name__ for layout in scenes.LAYOUTS}
    finite = [[m for m in spec["mass"] if m < float("inf")] for spec in specs]
    assert any(len(mass) < len(spec["mass"]) for mass, spec in zip(finite, specs)), "fixed balls"
    assert max(max(mass) / min(mass) for mass in finite if mass) > 500
    assert max(max(spec["radius"]) / min(spec["radius"]) for spec in specs) > 50
    assert max(abs(v) for spec in specs for v in spec["vx"]) > 10, "thrown"
    assert {1, 30} <= {len(spec["x"]) for spec in specs}
    assert scenes.numbered_spec(17) == scenes.numbered_spec(17)
    assert all(len(scenes.numbered_spec(k, small=True)["x"]) <= 4 for k in range(50))


def test_counts_add_up_and_what_could_not_fail_is_not_counted():
    found = [jobs.run(job) for job in jobs.scene_jobs(range(12), small=True)]
    whole, *parts = (jobs.added_up(found[part]) for part in (slice(12), slice(5), slice(5, 12)))
    assert whole["judgements"] == sum(part["judgements"] for part in parts) < 12 * len(PROPERTIES)
    assert whole["violations"] == [] and set(whole["properties"]) == set(PROPERTIES)
    for name, (judged, count, share) in whole["properties"].items():
        rows = [part["properties"][name] for part in parts]
        assert [judged, count] == [sum(row[k] for row in rows) for k in (0, 1)]
        assert share == max(row[2] for row in rows)


def test_a_number_that_is_off_is_a_violation_and_a_flight_says_nothing_of_springs():
    ball = {"x": [0.0], "y": [9.0], "vx": [0.0], "vy": [0.0], "mass": [1.0], "radius": [0.1]}
    flight = Trial(scenes.numbered_spec(0, small=True) | ball | {"steps": 5})
    found = jobs.judge(flight, *PROPERTIES.values())
    assert found["springs_push_as_hooke_and_the_damper_say"] == [0, 0.0, None]
    assert found["what_nothing_touches_falls"][0] > 0
    flight.run("lcp").v[3, 1, 0] += 1e-9
    del flight.motions
    assert (
        "lcp, fall: off by 1e-09"
        in jobs.judge(flight, *PROPERTIES.values())["what_nothing_touches_falls"][2]
    )


def test_what_judges_nothing_is_a_violation():
    section = {"ran": {"lcp": 3, "leapfrog": 0}, "properties": {"a": [1, 9, 0.0], "b": [0, 0, 0.0]}}
    assert [words[1] for words in jobs.idle(section)] == ["leapfrog", "b"]


def test_at_the_critical_dt_the_map_turns_from_settling_to_not():
    row = maps.PenaltyRow(80.0, 1e4, np.geomspace(1e-3, 0.1, 20))
    settles = [dt for dt in row.dts if row.outcome(dt) == maps.SETTLES]
    assert settles == [dt for dt in row.dts if dt < contact.critical_dt(1.0, 1e4, 80.0)]


@pytest.mark.parametrize("flags, words", [
    ("--workers 0", "allowed"), ("--scene big:3", "allowed"), ("--scene 5-3", "from 5"),
    ("--warp", "--warp"),
])  # fmt: skip
def test_bad_flags_are_refused_in_one_line(flags, words, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(flags.split())
    said = capsys.readouterr().err
    assert stop.value.code == 2 and said.count("\n") == 1 and words in said


def test_scenes_are_judged_and_said_again(capsys):
    assert command.main(["--scene", "small:3-4"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}: " in said for name in PROPERTIES) and "comparisons" in said


def test_a_run_writes_its_report_and_says_what_was_judged(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from curriculum.measured import results
    from curriculum.stress import report

    found = {
        name: [jobs.run(job) for job in todo[:: len(todo) // 10 or 1]]
        for name, todo in jobs.all_jobs(quick=True).items()
    }
    origins = dict.fromkeys(found, results.origin("stress", kept=False))
    assert report.write(found, origins, tmp_path) == []
    page = (tmp_path / "README.md").read_text("utf-8")
    assert ", no violations." in page and "](penalty-map.svg)" in page
    assert "settles at m g / k" in (tmp_path / "penalty-map.svg").read_text("utf-8")
    for function in PROPERTIES.values():
        assert " ".join(function.__doc__.split("\n\n")[0].split()) in page
