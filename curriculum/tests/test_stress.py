"""The stress test finds what is wrong, survives what dies, and says the same however it is run."""

import json
import math
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import contact
from curriculum import measured, plotting
from curriculum.stress import (
    __main__ as command,
)
from curriculum.stress import (
    extremes,
    invariants,
    jobs,
    maps,
    report,
    runner,
    samebytes,
    scenes,
    trial,
    under_test,
)

FAST_CASES = [
    name
    for name in extremes.CASES
    if name not in ("a_million_steps_at_rest", "overflow_on_purpose", "thousands_of_contacts")
]
LITTLE = [
    *(
        jobs.job("extreme", name, name=name, quick=True)
        for name in ("tower_rest_exact", "lcp_bounces_on_the_table")
    ),
    jobs.job("scenes", "scenes 5 to 7", start=5, stop=8),
    jobs.job("boards", "boards 0 to 1", start=0, stop=2),
    jobs.job(
        "penalty-map", "penalty k=1e+04 c=80", stiffness=1e4, damping=80.0, dt=[0.002, 0.03, 3]
    ),
    jobs.job(
        "penalty-map", "penalty k=1e+05 c=80", stiffness=1e5, damping=80.0, dt=[0.002, 0.03, 3]
    ),
    *(
        jobs.job("lcp-map", f"lcp e=0 beta={b:g}", restitution=0.0, baumgarte=b, dt=[0.01, 0.04, 2])
        for b in (0.2, 0.5)
    ),
    jobs.job("lcp-depth", "depth e=0 beta=0.2", restitution=0.0, baumgarte=0.2, dt=[0.01, 0.04, 2]),
    *(jobs.job("lcp-converges", f"bounce dt={dt:g}", dt=dt) for dt in (0.008, 0.004)),
    *(jobs.job("soft-map", f"soft T={T:g}", timeconst=T, dt=[0.01, 0.04, 2]) for T in (0.02, 0.1)),
    jobs.job("exact-map", "exact e=0.7", restitution=0.7, dt=[0.002, 0.04, 2]),
    jobs.job("seeds", "drop, seeds 0 to 1", scene="drop", start=0, stop=2),
]


@pytest.fixture
def command_with(monkeypatch, tmp_path):
    """The command with a few jobs of ours, in this process, and its work folder in tmp_path."""
    monkeypatch.setattr(command, "WORK", tmp_path / "work")

    def run(todo, *flags):
        monkeypatch.setattr(command, "all_jobs", lambda quick, count: todo)
        return command.main(["--workers", "0", "--out", str(tmp_path / "out"), *flags])

    return run


@pytest.fixture
def plain(monkeypatch):
    """Runs by contact.py's own loops, so that what a test breaks there is felt."""
    monkeypatch.setattr(contact, "compiled_piles", lambda: None)


def statuses(result):
    return [row["status"] for row in result["rows"]]


def strict(path):
    return json.loads(
        path.read_text(), parse_constant=lambda word: pytest.fail(f"{word} in {path.name}")
    )


# --- the command --------------------------------------------------------------------------------


def test_a_clean_run_exits_0_and_writes_report_results_and_figures(command_with, tmp_path, capsys):
    assert command_with(LITTLE) == 0
    found = strict(tmp_path / "out" / "results.json")
    assert found["counts"]["violations"] == found["counts"]["died"] == 0
    assert found["counts"]["jobs"] == len(LITTLE) and found["scenes"]["count"] == 3
    assert found["boards"]["count"] == 2 and set(found["boards"]["checks"]) < set(invariants.CHECKS)
    assert all(section["measured"]["code"]["contact.py"] for section in found.values())
    page = (tmp_path / "out" / "report.md").read_text()
    for name in ("penalty-map", "lcp-depth", "lcp-error", "lcp-converges", "soft-map"):
        assert f"({name}.svg)" in page
        assert (tmp_path / "out" / f"{name}.svg").stat().st_size < 100_000
        ElementTree.parse(tmp_path / "out" / f"{name}.svg")
    assert "No violation." in page and "How each bound follows" in page
    assert "0 violations" in capsys.readouterr().out
    assert "3 |" in report.readme_block(measured.load(tmp_path / "out"))
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    for name in set(before) - {"results.json"}:
        (tmp_path / "out" / name).unlink()
    assert command_with(LITTLE, "--draw") == 0, "the same again from the results alone"
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def test_without_matplotlib_the_report_is_written_and_one_line_says_what_draws_the_figures(
    command_with, tmp_path, monkeypatch, capsys
):
    """A run ended in a traceback after all its work."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert command_with(LITTLE) == 0
    assert "No violation." in (tmp_path / "out" / "report.md").read_text()
    said = [line for line in capsys.readouterr().err.splitlines() if "figures" in line]
    assert len(said) == 1 and "pip install" in said[0]


def test_a_pulling_contact_is_found_and_the_printed_case_reproduces_it(
    command_with, tmp_path, monkeypatch, capsys, plain
):
    monkeypatch.setattr(contact, "project_impulse", lambda lam, dlam: lam + dlam)
    assert command_with(LITTLE[2:3]) == 1
    page = (tmp_path / "out" / "report.md").read_text()
    assert "## Violations" in page and "impulses_only_push" in page
    case = next(
        path
        for path in sorted((tmp_path / "work" / "cases").iterdir())
        if "impulses_only_push" in path.read_text()
    )
    assert f"--case {case}" in page
    capsys.readouterr()
    assert command.main(["--case", str(case)]) == 1
    assert "a contact pulls with -" in capsys.readouterr().out
    monkeypatch.undo()
    assert command.main(["--case", str(case)]) == 0


def test_a_numbered_scene_is_a_case_of_its_own(capsys):
    for name in ("scene:1", "board:1"):
        assert command.main(["--case", name]) == 0
        assert "4 cells" in capsys.readouterr().out


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


def test_job_names_are_unique_and_the_full_run_has_what_the_report_promises(monkeypatch):
    monkeypatch.setattr(samebytes, "pythons_at_hand", lambda: {"3.11.7": "a", "3.12.1": "b"})
    for quick in (True, False):
        names = [job["name"] for job in command.all_jobs(quick, 100)]
        assert len(set(names)) == len(names)
    todo = command.all_jobs(False, command.SCENES)
    for kind, count in (("scenes", 10_000), ("boards", 1000)):
        spans = [job["params"] for job in todo if job["kind"] == kind]
        assert sum(params["stop"] - params["start"] for params in spans) == count
    cells = [job["params"] for job in todo if job["kind"] == "bytes" and "python" in job["params"]]
    assert {(cell["which"], cell["numba"]) for cell in cells} == {
        (which, numba) for which in ("oldest", "newest") for numba in (False, True)
    }


# --- every check can fail -----------------------------------------------------------------------


def spoil(monkeypatch, name, change):
    """Replace contact.NAME by what `change` makes of its result."""
    right = getattr(contact, name)
    monkeypatch.setattr(
        contact, name, lambda *args, **options: change(right(*args, **options), args, options)
    )


def shifted(model, dx=0.0, dy=0.0, vx=0.0, vy=0.0, when=lambda scene, dt: True):
    """A change of run_model: from sample 1 on, the runs of one model are off by so much."""

    def change(run, args, options):
        if args[0] == model and when(args[1], args[2]):
            run.q[1:] += np.array([dx, dy])[:, None]
            run.v[1:] += np.array([vx, vy])[:, None]
        return run

    return change


def cooling(run, args, options):
    """A change of run_model: exact loses a billionth of its speed with every sample."""
    if args[0] == "exact":
        run.v[:] *= (1.0 - 1e-9) ** np.arange(len(run.t))[:, None, None]
    return run


def never_last(contacts, iters, tolerance=0.0):
    """A sweep that forgets the last contact."""
    SOLVE(contacts[:-1] or contacts, iters, tolerance)


def backwards(contacts, iters, tolerance=0.0):
    """Each correction is made twice over and more: no descent."""
    for c in contacts:
        lam = max(0.0, c.lam + 2.05 * (c.target - c.v_n()) * c.m_eff)
        c.push(lam - c.lam)
        c.lam = lam


def sidled(self, impulse):
    """A push that also moves the ball aside, by how much depends on the way to the answer."""
    PUSH(self, impulse)
    self.a.vx += 1e-3 * impulse**2


def unequal(self, impulse):
    """A push whose reaction is short by 1e-13 of it."""
    PUSH(self, impulse)
    self.b.vx += 1e-13 * impulse * self.nx * self.b.inv_mass


SOLVE, PUSH = contact.solve_contacts, contact.Contact.push
PAIR = {
    "x": [0.0, 0.2, 0.6, 0.0],
    "y": [0.1, 0.35, 0.1, 0.3],
    "vx": [0.0, 0.5, -1.0, 0.0],
    "vy": [0.0, -2.0, 0.0, 0.0],
    "mass": [1.0, 2.0, 1.0, 4.0],
    "radius": [0.1] * 4,
    "restitution": 0.5,
    "damping": 20.0,
    "dt": 0.004,
    "steps": 60,
    "stiffness": 1e4,
    "baumgarte": 0.2,
    "iters": 20,
    "solref": [0.02, 1.0],
}
EARLY = {**PAIR, "iters": 1}


def result_of(name, change):
    return lambda monkeypatch: spoil(monkeypatch, name, change)


def instead(name, function):
    return lambda monkeypatch: monkeypatch.setattr(contact, name, function)


BROKEN = {
    "finite_unless_reported": result_of(
        "contact_quality", lambda q, args, options: {**q, "blew_up": True, "blew_up_step": None}
    ),
    "momentum_along_x_is_kept": result_of("run_model", shifted("exact", vx=1e-6)),
    "mirrored_in_x_runs_mirrored": result_of("run_model", shifted("lcp", dx=1e-9)),
    "a_run_can_be_taken_up_anywhere": result_of("run_model", shifted("soft", dy=1e-12)),
    "a_far_ball_changes_nothing": result_of(
        "run_model", lambda run, args, options: run._replace(q=run.q + 1e-9 * len(args[1].mass))
    ),
    "springs_only_push": instead(
        "penalty_normal_force", lambda depth, v_n, k, c: k * depth - 20 * c * v_n - 50
    ),
    "other_units_give_the_same_run": result_of("run_model", shifted("penalty", dy=1e-9)),
    "plain_steps_give_the_same_bits": result_of("run_model", shifted("lcp", vx=1e-15)),
    "every_contact_is_listed": result_of("detect_contacts", lambda found, args, options: found[1:]),
    "impulses_only_push": instead("project_impulse", lambda lam, dlam: lam + dlam),
    "complementary_up_to_the_last_sweep": instead("solve_contacts", never_last),
    "more_sweeps_solve_better": instead("solve_contacts", backwards),
    "overlaps_stay_within_their_bound": result_of(
        "move", lambda _, args, options: [setattr(ball, "y", ball.y - 1e-9) for ball in args[0]]
    ),
    "energy_rises_by_unfinished_sweeps_alone": result_of(
        "contact_target", lambda goal, args, options: goal + 2.0
    ),
    "soft_has_one_answer": lambda monkeypatch: monkeypatch.setattr(contact.Contact, "push", sidled),
    "exact_never_gains_energy": result_of("run_model", shifted("exact", dy=1e-9)),
    "exact_never_penetrates": result_of("run_model", shifted("exact", dy=-1e-9)),
    "exact_keeps_its_energy_from_event_to_event": result_of("run_model", cooling),
    "exact_flies_where_nothing_touches": result_of("run_model", shifted("exact", vx=1e-11)),
    "exact_does_not_know_dt": result_of(
        "run_model", shifted("exact", dy=1e-15, when=lambda scene, dt: dt > 0.005)
    ),
}


def test_the_scene_that_broken_models_meet_is_fine_by_itself(plain):
    for spec in (PAIR, EARLY):
        found = invariants.outcomes(spec)
        assert not [name for name, words in found.items() if isinstance(words, str)], found


@pytest.mark.parametrize("name", BROKEN)
def test_each_invariant_catches_a_model_broken_for_it(name, monkeypatch, plain):
    BROKEN[name](monkeypatch)
    found = invariants.outcomes(PAIR, only=[name])[name]
    assert isinstance(found, str), found


def test_a_reaction_that_is_hardly_short_shows_in_the_steps_taken_again(monkeypatch, plain):
    monkeypatch.setattr(contact.Contact, "push", unequal)
    name = "momentum_along_x_is_kept"
    assert "its pushes round by" in invariants.outcomes(PAIR, only=[name])[name]


def test_every_invariant_is_known_to_fail_or_is_a_count_of_events():
    assert set(invariants.CHECKS) - set(BROKEN) == set(invariants.COUNTS)


def test_a_twin_off_by_one_bit_is_caught_by_the_plain_steps(monkeypatch):
    piles = pytest.importorskip("curriculum.piles", reason="numba is not installed")
    right = piles.simulate

    def off(*args, **options):
        q, v = right(*args, **options)
        return q, np.nextafter(v, 1.0)

    monkeypatch.setattr(piles, "simulate", off)
    name = "plain_steps_give_the_same_bits"
    assert isinstance(invariants.outcomes(PAIR, only=[name])[name], str)


def test_a_rise_of_energy_that_no_number_of_sweeps_ends_is_a_violation(monkeypatch):
    monkeypatch.setattr(invariants, "MOST", 1)
    name = "energy_rises_by_unfinished_sweeps_alone"
    found = invariants.outcomes(scenes.numbered_spec(651), only=[name])[name]
    assert "still rises" in found


def test_energy_of_unfinished_sweeps_is_counted_and_enough_sweeps_end_it():
    """Scene 651 with one sweep a step goes from 247.8 to 272.0 J."""
    spec = scenes.numbered_spec(651)
    name = "energy_rises_by_unfinished_sweeps_alone"
    found = invariants.outcomes(spec, only=[name])[name]
    run = scenes.run("lcp", spec, baumgarte=0.0)
    total = contact.energy(run.q, run.v, np.array(spec["mass"]))
    assert (round(total[0], 1), round(total.max(), 1)) == (247.8, 272.0)
    assert found["above_start"] > 0.05 and found["sweeps"] > spec["iters"]
    enough = scenes.run("lcp", spec, baumgarte=0.0, iters=found["sweeps"])
    total = contact.energy(enough.q, enough.v, np.array(spec["mass"]))
    assert total.max() - total[0] < 1e-9 * total[0]


def test_a_bounce_of_exact_that_gives_back_a_ten_billionth_more_is_a_violation(monkeypatch):
    """One ball bounces for ever at e = 1, and E rises by nothing but rounding."""
    alone = {name: PAIR[name][:1] for name in scenes.BODY}
    spec = {**PAIR, **alone, "y": [0.5], "restitution": 1.0, "steps": 300}
    name = "exact_never_gains_energy"
    assert invariants.outcomes(spec, only=[name])[name]["rise"] < 4 * trial.U
    right = contact.run_model

    def generous(model, scene, *rest, **options):
        return right(model, scene._replace(restitution=1.0 + 1e-10), *rest, **options)

    monkeypatch.setattr(contact, "run_model", generous)
    assert "E rises by" in invariants.outcomes(spec, only=[name])[name]


def test_to_blow_a_scene_up_opens_every_gap_by_as_much_as_its_bound_takes_for_granted():
    """The move (q - o) / r changes each gap by 1 or more, and has the size `blown_up`."""
    for number in range(20):
        one = trial.Trial(scenes.numbered_spec(number))
        q, r, m = one.scene.q0, one.scene.radius, one.mass
        if one.overlaps:
            continue
        move = (q - [[np.average(q[0], weights=m)], [0.0]]) / r.min()
        opened = invariants.gaps(q[None] + 1e-6 * move, r) - invariants.gaps(q[None], r)
        assert opened.min() > 1e-6 * (1 - 1e-6)
        size = math.sqrt(float((m * move**2).sum()))
        assert invariants.blown_up(one, q[None])[0] == pytest.approx(size, rel=1e-12)


def test_a_run_of_exact_that_piles_up_is_cut_counted_and_judged_up_to_there(monkeypatch):
    whole = trial.Trial(PAIR).run("exact")
    calls = iter(range(1000))  # the clock of the first run: a second for every event
    monkeypatch.setattr(under_test.time, "process_time", lambda: float(next(calls)))
    monkeypatch.setattr(trial, "SECONDS", len(PAIR["x"]) + 0.5)  # each ball's start is an event
    cut = trial.Trial(PAIR)
    assert 0 < cut.judged < PAIR["steps"]
    assert np.array_equal(cut.run("exact").q, whole.q[: cut.judged + 1])
    found = invariants.outcomes(PAIR, only=["exact_ends"])["exact_ends"]
    assert found == {"cut": 1 - cut.judged / PAIR["steps"]}


def test_the_textbook_critical_dt_is_refuted_where_there_is_a_damper(monkeypatch):
    monkeypatch.setattr(contact, "critical_dt", lambda mass, k, c: 2.0 * math.sqrt(mass / k))
    row, *_ = maps.penalty_row(1e4, 80.0, [0.002, 0.003, 2])["rows"]
    assert row["status"] == jobs.VIOLATION and "0.0135" in row["got"]


def test_a_bias_velocity_added_to_the_bounce_shows_in_the_lcp_maps(monkeypatch, plain):
    def added(c, restitution, baumgarte, dt):
        return baumgarte / dt * max(c.depth, 0.0) - restitution * c.v_n()

    assert set(statuses(maps.lcp_row(0.7, 1.0, [0.005, 0.02, 2]))) == {jobs.HOLDS}
    monkeypatch.setattr(contact, "contact_target", added)
    assert jobs.VIOLATION in statuses(maps.lcp_row(0.7, 1.0, [0.005, 0.02, 2]))


def test_a_ball_that_hangs_in_the_air_shows_where_the_bounce_rests(monkeypatch, plain):
    monkeypatch.setattr(
        contact, "contact_target", lambda c, e, beta, dt: max(beta / dt * c.depth, -e * c.v_n())
    )
    assert statuses(maps.converges_row(0.004)) == [jobs.VIOLATION]


def test_a_spring_of_another_stiffness_shows_in_the_soft_map(monkeypatch, plain):
    assert statuses(maps.soft_row(0.02, [0.002, 0.004, 2])) == [jobs.HOLDS]
    spoil(
        monkeypatch,
        "soften",
        lambda _, args, options: setattr(args[0], "softness", 1.01 * args[0].softness),
    )
    assert statuses(maps.soft_row(0.02, [0.002, 0.004, 2])) == [jobs.VIOLATION]


def test_a_drop_off_by_a_nanometre_shows_in_the_exact_map(monkeypatch):
    spoil(monkeypatch, "run_model", shifted("exact", dy=1e-9))
    assert jobs.VIOLATION in statuses(maps.exact_row(0.7, [0.002, 0.004, 2]))


def test_a_seed_with_the_wrong_order_is_named(monkeypatch):
    spoil(monkeypatch, "run_model", shifted("lcp", dy=-0.05))
    (row,) = maps.run_seeds("drop", 3, 4)["rows"]
    assert row["status"] == jobs.VIOLATION and "seed 3" in row["got"]


def test_a_cell_with_other_bytes_is_named(monkeypatch):
    monkeypatch.setattr(
        samebytes,
        "digest",
        lambda python, scene, env=None, cwd=None: str(sorted((env or {}).items())),
    )
    assert statuses(samebytes.run(quick=True)) == [jobs.VIOLATION] * 2
    monkeypatch.setattr(samebytes, "digest", lambda *args, **options: "0")
    assert statuses(samebytes.run(quick=True)) == [jobs.HOLDS] * 2


def test_an_environment_that_does_not_install_is_named(monkeypatch):
    monkeypatch.setattr(samebytes, "digest", lambda *args, **options: "0")
    monkeypatch.setattr(samebytes, "pythons_at_hand", lambda least=None: {"3.99.0": "python"})
    monkeypatch.setattr(samebytes, "environment", lambda *args: (None, "no such wheel"))
    (row,) = samebytes.run(False, "3.99.0", "oldest", True)["rows"]
    assert row["status"] == jobs.LIMIT and "no such wheel" in row["got"]


def test_this_python_is_among_those_at_hand(monkeypatch, tmp_path):
    import platform

    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    monkeypatch.setattr(samebytes.shutil, "which", lambda name: None)
    assert list(samebytes.pythons_at_hand((3, 0))) == [platform.python_version()]


# --- what must happen in the extremes -----------------------------------------------------------


@pytest.mark.parametrize("name", FAST_CASES)
def test_extreme_as_stated(name):
    rows = extremes.run(name, quick=True)["rows"]
    assert not [row for row in rows if row["status"] == jobs.VIOLATION]


def test_a_run_that_overflows_is_no_extreme_case_met(monkeypatch):
    spoil(monkeypatch, "run_model", lambda run, args, options: run._replace(q=run.q * np.nan))
    for name in ("tower_rest_exact", "radii", "restitution_0_and_1", "tower_rest_lcp"):
        assert set(statuses(extremes.run(name, quick=True))) & {jobs.VIOLATION}


@pytest.mark.parametrize(
    "times, status", [(0.0, jobs.HOLDS), (0.5, jobs.HOLDS), (1.5, jobs.VIOLATION)]
)
def test_a_tower_that_is_deeper_than_its_bound_is_none_that_coinciding_balls_end_as(
    times, status, monkeypatch
):
    """A run is replaced by the tower of the closed forms, with one depth off by so many bounds."""

    def made(model, scene, dt, steps):
        n = len(scene.mass)
        depth, bound = extremes.resting_tower(model, n, np.arange(n), dt)
        depth = depth + times * bound * extremes.R * (np.arange(n) == n - 1)
        y = np.cumsum(2 * extremes.R - depth) - extremes.R
        q = np.array([np.zeros(n), y])[None]
        return contact.Run(np.zeros(1), q, 0 * q)

    monkeypatch.setattr(extremes, "run_model", made)
    assert set(statuses(extremes.run("coincident_centres", quick=True))) == {status}


def test_balls_side_by_side_are_no_tower(monkeypatch):
    def made(model, scene, dt, steps):
        q = np.array([3.0 * extremes.R * np.arange(len(scene.mass)), scene.radius])[None]
        return contact.Run(np.zeros(1), q, 0 * q)

    monkeypatch.setattr(extremes, "run_model", made)
    assert set(statuses(extremes.run("coincident_centres", quick=True))) == {jobs.VIOLATION}


def test_landing_depth_closed_form_is_the_stepped_one():
    for dt in (0.0007, 0.002, 0.04, 0.3):
        y, v = maps.HEIGHT, 0.0
        while y - maps.RADIUS >= contact.CONTACT_MARGIN:
            v -= 9.81 * dt
            y += v * dt
        assert maps.landing_depth(maps.GAP, dt) == pytest.approx(
            max(0.0, maps.RADIUS - y), abs=1e-12
        )


# --- running ------------------------------------------------------------------------------------


def test_processes_give_the_same_results_as_this_process():
    assert runner.run_all(LITTLE[:4], workers=2) == runner.run_all(LITTLE[:4], workers=0)


def test_a_dask_scheduler_that_is_running_gives_the_same_results(tmp_path):
    distributed = pytest.importorskip(
        "distributed", reason="Dask is optional: pip install 'dask[distributed]'"
    )
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster:
        there = runner.run_all(LITTLE, dask=cluster.scheduler_address)
    here = runner.run_all(LITTLE, workers=0)
    assert there == here and report.sections(there) == report.sections(here)


def test_a_process_that_is_killed_is_reported_and_the_rest_goes_on(monkeypatch):
    victim, give = LITTLE[2]["name"], runner.Worker.give

    def give_and_kill(worker, job):
        give(worker, job)
        if job["name"] == victim:
            worker.process.kill()

    monkeypatch.setattr(runner.Worker, "give", give_and_kill)
    results = runner.run_all(LITTLE[:4], workers=2)
    dead = [job["name"] for job, result in results if jobs.DIED in statuses(result)]
    assert dead == [victim] and "exit code -9" in results[2][1]["rows"][0]["got"]
    assert report.summary(results)["died"] == 1 and len(results) == 4


def test_a_job_that_never_ends_is_ended(monkeypatch):
    monkeypatch.setattr(runner, "PATIENCE", 0.05)
    job = jobs.job("extreme", "long", name="a_million_steps_at_rest", quick=False)
    ((_, result),) = runner.run_all([job], workers=1)
    assert "no end after 0.05 s" in result["rows"][0]["got"]


def test_a_job_that_raises_is_reported_with_the_place(command_with, tmp_path):
    bad = jobs.job("scene", "bad", spec={"x": [0.0]})
    assert command_with([bad, LITTLE[0]]) == 1
    (failure,) = strict(tmp_path / "out" / "results.json")["counts"]["failed"]
    assert "KeyError" in failure[3] and "scenes.py" in failure[3]


def test_an_interrupted_run_goes_on_where_it_stopped(command_with, monkeypatch, capsys):
    ran, attempt, todo = [], runner.attempt, [*LITTLE[:2], LITTLE[-2]]

    def interrupted(job):
        if len(ran) == 2:
            raise KeyboardInterrupt
        ran.append(job["name"])
        return attempt(job)

    monkeypatch.setattr(runner, "attempt", interrupted)
    assert command_with(todo) == 130
    assert capsys.readouterr().err.strip() == "stopped; the same command goes on from here"
    monkeypatch.setattr(runner, "attempt", lambda job: (ran.append(job["name"]), attempt(job))[1])
    assert command_with(todo) == 0
    assert ran == [job["name"] for job in todo]
    assert command_with(todo) == 0 and len(ran) == len(todo)
    assert command_with(todo, "--fresh") == 0 and len(ran) == 2 * len(todo)


def test_a_dead_job_is_tried_again(tmp_path, monkeypatch):
    kept = measured.Cells(tmp_path / "kept")
    monkeypatch.setattr(jobs, "run", lambda job: 1 / 0)
    ((_, result),) = runner.run_all(LITTLE[:1], workers=0, kept=kept)
    assert statuses(result) == [jobs.DIED]
    monkeypatch.undo()
    kept = measured.Cells(tmp_path / "kept")
    ((_, result),) = runner.run_all(LITTLE[:1], workers=0, kept=kept)
    assert jobs.DIED not in statuses(result)


# --- figures and numbers ------------------------------------------------------------------------


def test_cells_of_one_colour_in_a_row_become_one_tile_so_that_maps_stay_small():
    x, rows = [1.0, 2.0, 4.0, 8.0], [[0, 0, 1, 1], [2, 2, 2, None]]

    def drawn(cells):
        figure, (axis,) = plotting.figure(title="t")
        plotting.heat(axis, x, [1.0, 2.0], cells, (0.5, 1.5), "")
        corners = [patch.get_path().vertices for patch in axis.patches]
        plotting.svg(figure)
        return sorted(len(points) // 5 for points in corners), np.concatenate(corners)

    tiles, points = drawn(rows)
    assert tiles == [1, 1, 1]
    assert points.max() > 8.0 and points.min() < 1.0
    assert drawn([[0, 1, 0, 1], [1, 1, 1, 1]])[0] == [2, 3]


def test_numbers_that_are_not_finite_become_words_in_json():
    assert jobs.plain({"a": [math.nan, np.float64(math.inf), np.int64(3)]}) == {
        "a": ["nan", "inf", 3]
    }


def test_an_unknown_kind_of_job_is_refused():
    with pytest.raises(ValueError, match="nonsense.*allowed: .*penalty-map"):
        jobs.job("nonsense", "x")
    assert under_test.contact is contact


def test_threads_that_run_models_at_once_leave_contact_py_as_it_was():
    """Workers of a scheduler may be threads. Here the second begins before the first has ended."""
    import threading
    import time

    few = under_test.contact.FEW
    scene = under_test.contact.build_scene("drop")
    begun = threading.Event()

    def first(samples):
        begun.set()
        time.sleep(0.02)

    def second(samples):
        time.sleep(0.04)

    threads = [
        threading.Thread(
            target=under_test.run_model,
            args=("exact", scene, 0.01, 60),
            kwargs={"report": report},
        )
        for report in (first, second)
    ]
    threads[0].start()
    begun.wait(5.0)
    threads[1].start()
    for thread in threads:
        thread.join()
    assert under_test.contact.FEW == few
