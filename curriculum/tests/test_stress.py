"""The stress test finds what is wrong, survives what dies, and says the same however it is run."""

import json
import math
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import contact
from curriculum.stress import (
    __main__ as command,
    engine,
    extremes,
    figures,
    invariants,
    jobs,
    maps,
    report,
    runner,
    samebytes,
    scenes,
)

FAST_CASES = (
    "mass_ratio_sweeps",
    "mass_ratio_lcp",
    "tower_sweeps_are_gauss_seidel",
    "tower_rest_lcp",
    "tower_rest_exact",
    "radii",
    "margin_of_lcp",
    "mixed_radii",
    "stiffness_from_1_to_1e12",
    "restitution_0_and_1",
    "start_overlap",
    "denormal_speeds",
)
LITTLE = [
    *(
        jobs.job("extreme", name, name=name, quick=True)
        for name in ("tower_rest_exact", "margin_of_lcp")
    ),
    jobs.job("scenes", "scenes 5 to 7", start=5, stop=8),
    jobs.job(
        "penalty-map", "penalty k=1e+04 c=80", stiffness=1e4, damping=80.0, dt=[0.002, 0.03, 3]
    ),
    jobs.job(
        "lcp-map",
        "lcp e=0 beta=0.2",
        restitution=0.0,
        baumgarte=0.2,
        dt=[0.002, 0.04, 2],
        heights=2,
    ),
    jobs.job("exact-map", "exact e=0.7", restitution=0.7, dt=[0.002, 0.04, 2]),
    jobs.job("seeds", "drop, seeds 0 to 1", scene="drop", start=0, stop=2),
]


@pytest.fixture
def little(monkeypatch, tmp_path):
    """The command with a handful of jobs, in this process, and its work folder in tmp_path."""
    monkeypatch.setattr(command, "all_jobs", lambda quick, count: LITTLE)
    monkeypatch.setattr(command, "WORK", tmp_path / "work")
    return lambda *flags: command.main(["--workers", "0", "--out", str(tmp_path / "out"), *flags])


def statuses(result):
    return [row["status"] for row in result["rows"]]


def strict(path):
    return json.loads(
        path.read_text(), parse_constant=lambda word: pytest.fail(f"{word} in {path.name}")
    )


# --- the command ------------------------------------------------------------------------------


def test_a_clean_run_exits_0_and_writes_report_results_and_figures(little, tmp_path, capsys):
    assert little() == 0
    data = strict(tmp_path / "out" / "results.json")
    assert data["counts"]["violations"] == data["counts"]["died"] == 0
    assert data["counts"]["cells"] > 15 and len(data["jobs"]) == len(LITTLE)
    page = (tmp_path / "out" / "report.md").read_text()
    for name in ("penalty-map", "lcp-depth", "lcp-error", "lcp-energy", "exact-error"):
        assert f"({name}.svg)" in page
        ElementTree.parse(tmp_path / "out" / f"{name}.svg")
    assert "No violation." in page and "turns 10 r above" in page
    assert "0 violations" in capsys.readouterr().out


def test_a_pulling_penalty_is_found_and_the_printed_case_reproduces_it(
    little, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(
        contact, "penalty_normal_force", lambda depth, v_n, k, c, larger=max: k * depth - c * v_n
    )
    assert little() == 1
    page = (tmp_path / "out" / "report.md").read_text()
    assert "## Violations" in page and "forces_only_push" in page
    case = next(
        path
        for path in sorted((tmp_path / "work" / "cases").iterdir())
        if "forces_only_push" in path.read_text()
    )
    assert f"--case {case}" in page
    capsys.readouterr()
    assert command.main(["--case", str(case)]) == 1
    assert "a contact pulls with -" in capsys.readouterr().out
    monkeypatch.undo()
    assert command.main(["--case", str(case)]) == 0


def test_a_numbered_scene_is_a_case_of_its_own(capsys):
    assert command.main(["--case", "scene:1"]) == 0
    assert "1 cells" in capsys.readouterr().out


@pytest.mark.parametrize(
    "flags, words",
    [
        (["--case", "nowhere.json"], "nowhere.json"),
        (["--case", "scene:x"], "scene:NUMBER"),
        (["--only", "nothing*"], "no job's name matches"),
        (["--workers", "-1"], ">= 0"),
    ],
)
def test_bad_command_lines_are_one_line_and_status_2(flags, words, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(["--quick", *flags])
    error = capsys.readouterr().err
    assert stop.value.code == 2 and error.count("\n") == 1 and words in error


def test_job_names_are_unique_and_only_selects_by_them(monkeypatch):
    monkeypatch.setattr(samebytes, "pythons_at_hand", lambda: {"3.11.7": "a", "3.12.1": "b"})
    for quick in (True, False):
        names = [job["name"] for job in command.all_jobs(quick, 100)]
        assert len(set(names)) == len(names)
    grid = maps.FULL["penalty"]
    assert grid["dt"][2] >= 60 and len(grid["stiffness"]) >= 60 and len(grid["damping"]) >= 4
    assert sum(job["kind"] == "penalty-map" for job in maps.map_jobs(maps.FULL)) >= 240


# --- every check can fail ---------------------------------------------------------------------


def spoil(monkeypatch, name, change):
    """Replace contact.NAME by what `change` makes of its result."""
    right = getattr(contact, name)
    monkeypatch.setattr(
        contact, name, lambda *args, **options: change(right(*args, **options), args, options)
    )


def shifted(model, dx=0.0, dy=0.0, vx=0.0, vy=0.0, when=lambda options: True):
    """A change of run_model: from sample 1 on, the runs of one model are off by so much."""

    def change(run, args, options):
        if args[0] == model and when(options):
            run.q[1:] += np.array([dx, dy])[:, None]
            run.v[1:] += np.array([vx, vy])[:, None]
        return run

    return change


BROKEN = {
    "finite_unless_reported": (
        "contact_quality",
        lambda q, args, options: {**q, "blew_up": True, "blew_up_step": None},
    ),
    "forces_only_push": (
        "solve_contacts",
        lambda found, args, options: (found[0], [-l - 1.0 for l in found[1]]),
    ),
    "momentum_along_x_is_kept": ("run_model", shifted("exact", vx=1e-6)),
    "more_sweeps_solve_better": (
        "solve_contacts",
        lambda found, args, options: (found[0], [l / args[4] for l in found[1]]),
    ),
    "complementary_up_to_the_last_sweep": (
        "solve_contacts",
        lambda found, args, options: ([found[0][0], [vy - 0.1 for vy in found[0][1]]], found[1]),
    ),
    "lcp_without_push_never_gains_energy": (
        "contact_targets",
        lambda goals, args, options: [goal + 2.0 for goal in goals],
    ),
    "exact_never_gains_energy": ("run_model", shifted("exact", dy=0.5)),
    "exact_never_penetrates": ("run_model", shifted("exact", dy=-0.5)),
    "mirrored_in_x_runs_mirrored": ("run_model", shifted("lcp", dx=1e-9)),
    "a_run_can_be_taken_up_anywhere": ("run_model", shifted("penalty", dy=1e-12)),
    "a_far_ball_changes_nothing": (
        "run_model",
        lambda run, args, options: run._replace(q=run.q + 1e-9 * len(args[1].mass)),
    ),
    "skipping_changes_no_bit": (
        "run_model",
        shifted("lcp", dy=1e-12, when=lambda options: options.get("skip")),
    ),
    "other_units_give_the_same_run": ("run_model", shifted("penalty", dy=1e-9)),
}
PAIR = {
    "x": [0.0, 0.15, 0.6],
    "y": [0.1, 0.35, 0.1],
    "vx": [0.0, 0.5, -1.0],
    "vy": [0.0, -2.0, 0.0],
    "mass": [1.0, 2.0, 1.0],
    "radius": [0.1, 0.1, 0.1],
    "restitution": 0.5,
    "damping": 20.0,
    "dt": 0.004,
    "steps": 60,
    "stiffness": 1e4,
    "baumgarte": 0.2,
    "iters": 20,
}


def test_the_scene_that_broken_models_meet_is_fine_by_itself():
    assert not [name for name, found in invariants.outcomes(PAIR).items() if isinstance(found, str)]


@pytest.mark.parametrize("name", BROKEN)
def test_each_invariant_catches_a_model_broken_for_it(name, monkeypatch):
    spoil(monkeypatch, *BROKEN[name])
    found = invariants.outcomes(PAIR, only=[name])[name]
    assert isinstance(found, str), found


def test_every_invariant_is_known_to_fail_or_is_a_count_of_events():
    assert set(invariants.CHECKS) - set(BROKEN) == {"exact_ends"}


def test_events_that_pile_up_are_a_limit_and_end(monkeypatch):
    run_model = engine.run_model
    monkeypatch.setattr(
        engine, "run_model", lambda *args, **knobs: run_model(*args, events=2, **knobs)
    )
    found = invariants.outcomes(PAIR)
    assert (
        isinstance(found["exact_ends"], invariants.Limit)
        and "more than 2 events" in found["exact_ends"].words
    )
    assert found["exact_never_penetrates"] is invariants.SKIPPED


def test_the_textbook_critical_dt_is_refuted_where_there_is_a_damper(monkeypatch):
    monkeypatch.setattr(contact, "critical_dt", lambda mass, k, c: 2.0 * math.sqrt(mass / k))
    row, *_ = maps.penalty_row(1e4, 80.0, [0.002, 0.003, 2])["rows"]
    assert row["status"] == jobs.VIOLATION and "0.0135" in row["got"]


def test_a_push_five_times_too_strong_shows_in_the_lcp_map(monkeypatch):
    spoil(
        monkeypatch, "contact_targets", lambda goals, args, options: [5.0 * goal for goal in goals]
    )
    assert jobs.VIOLATION in statuses(maps.lcp_row(0.0, 0.6, [0.01, 0.02, 2], 1))


def test_a_drop_off_by_a_nanometre_shows_in_the_exact_map(monkeypatch):
    spoil(monkeypatch, "run_model", shifted("exact", dy=1e-9))
    assert jobs.VIOLATION in statuses(maps.exact_row(0.7, [0.002, 0.004, 2]))


def test_a_seed_with_the_wrong_order_is_named(monkeypatch):
    spoil(monkeypatch, "run_model", shifted("lcp", dy=-0.05))
    (row,) = invariants.run_seeds("drop", 3, 4)["rows"]
    assert row["status"] == jobs.VIOLATION and "seed 3" in row["got"]


def test_a_cell_with_other_bytes_is_named(monkeypatch):
    monkeypatch.setattr(
        samebytes,
        "digest",
        lambda python, scene, env=None, cwd=None: str(sorted((env or {}).items())),
    )
    rows = samebytes.run(quick=True)["rows"]
    assert [row["status"] for row in rows] == [jobs.VIOLATION] * 3
    monkeypatch.setattr(samebytes, "digest", lambda *args, **options: "0")
    assert statuses(samebytes.run(quick=True)) == [jobs.HOLDS] * 3


def test_this_python_is_among_those_at_hand(monkeypatch, tmp_path):
    import platform

    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    monkeypatch.setattr(samebytes.shutil, "which", lambda name: None)
    assert platform.python_version() in samebytes.pythons_at_hand((3, 0))


# --- what must happen in the extremes ---------------------------------------------------------


@pytest.mark.parametrize("name", FAST_CASES)
def test_extreme_as_stated(name):
    wrong = [
        row for row in extremes.run(name, quick=True)["rows"] if row["status"] == jobs.VIOLATION
    ]
    assert not wrong, wrong


def test_a_run_that_overflows_is_no_extreme_case_met(monkeypatch):
    spoil(monkeypatch, "run_model", lambda run, args, options: run._replace(q=run.q * np.nan))
    for name in ("tower_rest_exact", "radii", "restitution_0_and_1", "tower_rest_lcp"):
        assert set(statuses(extremes.run(name, quick=True))) & {jobs.VIOLATION}


def test_landing_depth_closed_form_is_the_stepped_one():
    for dt in (0.0007, 0.002, 0.04, 0.3):
        y, v = maps.HEIGHT, 0.0
        while y - maps.RADIUS >= contact.CONTACT_MARGIN:
            v -= 9.81 * dt
            y += v * dt
        assert maps.landing_depth(maps.GAP, dt) == pytest.approx(
            max(0.0, maps.RADIUS - y), abs=1e-12
        )


# --- running ----------------------------------------------------------------------------------


def test_processes_give_the_same_results_as_this_process():
    assert runner.run_all(LITTLE, workers=2) == runner.run_all(LITTLE, workers=0)


def test_a_dask_cluster_gives_the_same_report_cell_for_cell(tmp_path):
    distributed = pytest.importorskip(
        "distributed", reason="Dask is optional: pip install -e '.[stress]'"
    )
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        there = runner.run_all(LITTLE, dask=cluster.scheduler_address)
    here = runner.run_all(LITTLE, workers=0)
    assert there == here
    place = report.machine("test")
    assert report.page(there, place, {}, {}) == report.page(here, place, {}, {})
    assert report.results_json(there, place) == report.results_json(here, place)


def test_a_process_that_is_killed_is_reported_and_the_rest_goes_on(monkeypatch):
    victim, give = LITTLE[2]["name"], runner.Worker.give

    def give_and_kill(worker, job):
        give(worker, job)
        if job["name"] == victim:
            worker.process.kill()

    monkeypatch.setattr(runner.Worker, "give", give_and_kill)
    results = runner.run_all(LITTLE[:5], workers=2)
    dead = [job["name"] for job, result in results if jobs.DIED in statuses(result)]
    assert dead == [victim] and "exit code -9" in results[2][1]["rows"][0]["got"]
    assert report.summary(results)["died"] == 1 and len(results) == 5


def test_a_job_that_never_ends_is_ended(monkeypatch):
    monkeypatch.setattr(runner, "PATIENCE", 0.05)
    job = jobs.job("extreme", "long", name="a_million_steps_at_rest", quick=False)
    ((_, result),) = runner.run_all([job], workers=1)
    assert "no end after 0.05 s" in result["rows"][0]["got"]


def test_a_job_that_raises_is_reported_with_the_place(little, monkeypatch, tmp_path):
    bad = jobs.job("scene", "bad", spec={"x": [0.0]})
    monkeypatch.setattr(command, "all_jobs", lambda quick, count: [bad, LITTLE[0]])
    assert little() == 1
    row, *_ = [
        row
        for job in strict(tmp_path / "out" / "results.json")["jobs"]
        for row in job["result"]["rows"]
    ]
    assert row["status"] == jobs.DIED and "KeyError" in row["got"] and "scenes.py" in row["got"]


def test_an_interrupted_run_goes_on_where_it_stopped(little, monkeypatch, tmp_path):
    ran, attempt = [], runner.attempt

    def interrupted(job):
        if len(ran) == 3:
            raise KeyboardInterrupt
        ran.append(job["name"])
        return attempt(job)

    monkeypatch.setattr(runner, "attempt", interrupted)
    with pytest.raises(KeyboardInterrupt):
        little()
    (kept,) = (tmp_path / "work").glob("finished-*.jsonl")
    with open(kept, "a") as file:
        file.write('{"job": {"kind": "cut off wh')
    monkeypatch.setattr(runner, "attempt", lambda job: (ran.append(job["name"]), attempt(job))[1])
    assert little() == 0
    assert ran == [job["name"] for job in LITTLE]
    assert little() == 0 and len(ran) == len(LITTLE)
    assert little("--fresh") == 0 and len(ran) == 2 * len(LITTLE)


def test_a_dead_job_is_tried_again(tmp_path, monkeypatch):
    memory = runner.Memory(tmp_path, "x")
    monkeypatch.setattr(jobs, "run", lambda job: 1 / 0)
    ((_, result),) = runner.run_all(LITTLE[:1], workers=0, memory=memory)
    assert statuses(result) == [jobs.DIED]
    monkeypatch.undo()
    ((_, result),) = runner.run_all(LITTLE[:1], workers=0, memory=runner.Memory(tmp_path, "x"))
    assert jobs.DIED not in statuses(result)


# --- figures ----------------------------------------------------------------------------------


def lightness(colour):
    """Relative luminance of #rrggbb (WCAG 2)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("colours", [figures.RAMP, figures.CLASSES])
def test_colours_are_told_apart_by_lightness_alone(colours):
    values = [lightness(colour) + 0.05 for colour in colours]
    assert all(a / b >= 1.25 for a, b in zip(values, values[1:])), values


def test_a_figure_is_the_same_bytes_each_time_and_draws_every_cell_once():
    x, y = figures.Axis("x [s]", [1.0, 10.0, 100.0]), figures.Axis("y", [0.0, 0.5, 1.0], log=False)
    panel = figures.Panel(
        "p",
        [[0, 0, 1], [1, 1, 1], [0, 1, None]],
        [figures.Line([(1.0, 0.0), (100.0, 1.0)], "theory")],
    )
    first, second = (
        figures.heat_map("t", "s", [panel], x, y, ["a", "b"], figures.RAMP) for _ in range(2)
    )
    assert first == second
    cells = [
        rect
        for rect in ElementTree.fromstring(first).iter("{http://www.w3.org/2000/svg}g")
        if rect.get("shape-rendering")
    ][0]
    area = sum(float(rect.get("width")) * float(rect.get("height")) for rect in cells)
    assert len(cells) == 6 and area == pytest.approx(figures.WIDTH * figures.HEIGHT, rel=1e-3)


def test_numbers_that_are_not_finite_become_words_in_json():
    assert jobs.plain({"a": [math.nan, np.float64(math.inf), np.int64(3)]}) == {
        "a": ["nan", "inf", 3]
    }
