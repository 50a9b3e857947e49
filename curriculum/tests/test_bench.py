"""The benchmark measures what it says, prints only what its data bear out, and asserts no time."""

import json
import math
import os
import re
import sys

import numpy as np
import pytest

import contact
from curriculum import measured, readme
from curriculum.bench import __main__ as command
from curriculum.bench import (
    accuracy,
    closed_form,
    contestants,
    cradle,
    engines,
    piles,
    problems,
    skips,
    soft,
    solvers,
    tables,
    timing,
)
from curriculum.bench.reports import accuracy as accuracy_report
from curriculum.bench.reports import piles as piles_report

SETTINGS = [
    pytest.param(
        s,
        id=f"{s.engine} {s.words}",
        marks=pytest.mark.skipif(
            engines.missing(s.engine) is not None, reason=f"{s.engine}: {engines.missing(s.engine)}"
        ),
    )
    for s in engines.SETTINGS
]
BOUNCE, DROP, STACK = (problems.BY_NAME[name] for name in ("bounce", "drop", "stack"))
OURS = (
    "penalty: k 1e4",
    "lcp: 20 sweeps",
    "soft: as shipped by MuJoCo, or direct where e > 0",
    "exact: event to event",
    f"lcp: {contestants.FLYING}",
)


def run_of(problem, scene, t):
    """A Run made of the problem's known answer alone."""
    return contact.Run(t, *problem.truth(scene, t))


@pytest.fixture(scope="module")
def section():
    """A tiny real measurement of our own models, as it would be read back from the results."""
    points = []
    for problem in (DROP, BOUNCE):
        for name in OURS:
            for dt in (0.002, 0.016):
                key = (problem.name, name, dt, 1)
                points.append(
                    accuracy.point(
                        key,
                        accuracy.error_cell(key),
                        {
                            way: timing.spread([value])
                            for way, value in accuracy.time_cell(key).items()
                        },
                    )
                )
    made = dict(
        quick=True,
        processes=1,
        seeds=1,
        left_out=[],
        points=tables.pack(points),
        problems={
            p.name: dict(title=p.title, stresses=p.stresses, duration=p.duration)
            for p in (DROP, BOUNCE)
        },
        orders=[],
        headline=accuracy.headline(points),
    )
    about = {"command": accuracy.COMMAND, **measured.provenance(accuracy.CODE)}
    return json.loads(measured.text({"measured": about, **made}))


# the problems


@pytest.mark.parametrize("problem", problems.PROBLEMS, ids=lambda p: p.name)
def test_the_known_answer_itself_has_no_error_and_starts_where_the_scene_does(problem):
    scene = problem.build(1)
    t = np.linspace(0.0, problem.duration, 801)
    told = problems.quality(problem, scene, 0.002, run_of(problem, scene, t))
    assert told["position_error"] == 0.0 and told["energy_error"] == 0.0
    assert told["max_penetration"] < 1e-12 and told["blew_up_step"] is None
    q, v = problem.truth(scene, np.array([0.0]))
    assert q[0] == pytest.approx(scene.q0, abs=1e-15) and v[0] == pytest.approx(scene.v0, abs=1e-15)


@pytest.mark.parametrize(
    "name", ["drop", "bounce", "stack", "tower", "elastic", "slide", "pyramid"]
)
def test_exact_meets_every_known_answer_within_1e_10_r(name):
    problem = problems.BY_NAME[name]
    scene, dt = problem.build(2), 0.008
    run = contact.run_model("exact", scene, dt, problem.steps(dt))
    assert problems.quality(problem, scene, dt, run)["position_error"] < 1e-10


def test_position_error_is_in_radii_and_counts_both_directions():
    scene = DROP.build(0)
    run = run_of(DROP, scene, np.arange(1001) * 0.002)
    run.q[700, :, 0] += (0.03, 0.04)
    told = problems.quality(DROP, scene, 0.002, run)
    assert told["position_error"] == pytest.approx(0.5) and told["final_error"] == 0.0


def test_semi_implicit_flight_shows_its_lag_of_half_g_t_dt_and_flying_exactly_does_not():
    scene = DROP.build(0)
    for name, lag in (
        ("lcp: 20 sweeps", closed_form.flight_lag(0.4, 0.002) / 0.1),
        (f"lcp: {contestants.FLYING}", 0.0),
    ):
        run = contestants.BY_NAME[name].record(scene, 0.002, 200)  # still falling at the end
        told = problems.quality(DROP, scene, 0.002, run)
        assert told["position_error"] == pytest.approx(lag, rel=1e-9, abs=1e-12)


def test_phase_of_an_elastic_ball_is_the_time_by_which_its_last_apex_is_late():
    problem = problems.BY_NAME["elastic"]
    scene = problem.build(0)
    t = np.arange(0.0, 20.0, 0.002)
    q, v = problem.truth(scene, t * 0.999)  # a clock that runs slow
    told = problems.quality(problem, scene, 0.002, contact.Run(t, q, 0.999 * v))
    last = closed_form.apex_time(scene.q0[1, 0] - 0.1, 1.0, told["apexes"] - 1)
    assert told["apexes"] >= 22
    assert told["phase_error"] == pytest.approx(last * (1 / 0.999 - 1), rel=1e-2)


def test_divergence_is_a_value_with_step_and_reason():
    scene = DROP.build(0)
    run = contact.run_model("penalty", scene, 0.032, DROP.steps(0.032))
    told = problems.quality(DROP, scene, 0.032, run)
    assert isinstance(told["blew_up_step"], int)
    assert told["blew_up_reason"] in ("energy above 10 x the start", "not finite")


def test_order_of_a_first_order_method_is_fitted_as_one():
    made = [
        dict(problem="p", family="f", words="w", dt=dt, diverged=None, position_error=3.0 * dt)
        for dt in problems.DTS
    ]
    assert next(accuracy.fits(made))["order"] == pytest.approx(1.0)
    assert next(accuracy.fits([{**p, "position_error": 1e-15} for p in made]))["order"] is None


# how it is timed


def double(key):
    """What the worker processes of the test below do."""
    return {"read": 2.0 * key[2], "process": os.getpid()}


def test_cells_are_timed_in_fresh_processes_and_a_stopped_run_goes_on():
    keys = [("p", "c", float(k)) for k in range(3)]
    cells = {timing.place("time", 0, keys[0]): {"read": -1.0}}
    timing.in_fresh_processes(double, keys, 2, cells, "test")
    assert cells[timing.place("time", 0, keys[0])] == {"read": -1.0}, "done already"
    first, second = (
        {cells[timing.place("time", k, key)].get("process") for key in keys} - {None}
        for k in (0, 1)
    )
    assert len(first) == len(second) == 1 and first != second and os.getpid() not in first | second


def test_a_time_is_the_median_over_processes_with_its_spread():
    cells = {
        timing.place("time", k, "key"): {"read": value} for k, value in enumerate((3.0, 1.0, 9.0))
    }
    assert timing.merged(cells, ["key"], 3)["key"]["read"] == dict(median=3.0, min=1.0, max=9.0)


def test_rounds_are_shuffled_and_preparation_is_not_timed():
    seen = []

    def task(name):
        def prepare():
            seen.append(f"prepare {name}")
            return lambda: seen.append(name)

        return prepare

    seconds = timing.interleave({name: task(name) for name in "abc"}, 4)
    assert all(seen[k] == f"prepare {seen[k + 1]}" for k in range(0, len(seen), 2))
    assert len({tuple(seen[k : k + 6]) for k in range(0, len(seen), 6)}) > 1
    assert [len(values) for values in seconds.values()] == [4, 4, 4]


def test_whole_process_reports_time_and_memory_and_a_failure(tmp_path):
    command = [sys.executable, "-c", "b = bytearray(50_000_000)"]
    seconds, memory = timing.whole_process(command, ".", tmp_path)
    assert seconds > 0 and 50e6 < memory < 500e6
    with pytest.raises(RuntimeError, match="(?s)fails.*ValueError: so it goes"):
        timing.whole_process(
            [sys.executable, "-c", "raise ValueError('so it goes')"], ".", tmp_path
        )


def test_whole_processes_keep_their_bytecode_whatever_the_environment_says(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    (tmp_path / "lesson.py").write_text("x = 1\n")
    command = [sys.executable, "-c", "import lesson"]
    timing.whole_process(command, tmp_path, tmp_path / "bytecode")
    assert list((tmp_path / "bytecode").rglob("lesson.*.pyc"))


# the engines


@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("name", ["stack", "bounce"])
def test_an_engine_runs_the_same_scene_and_reading_changes_nothing(setting, name):
    scene = problems.BY_NAME[name].build(2)
    if setting.refuses(scene):
        pytest.skip(setting.refuses(scene))
    steps, dt = 60, 0.002
    rows = np.array(setting.build(scene, dt).trace(steps))
    q, v = setting.build(scene, dt).states(steps)
    assert q[0] == pytest.approx(scene.q0, abs=1e-6) and (v[0] == 0).all()
    assert rows.shape == (steps + 1, len(scene.mass))
    assert q[:, 1] == pytest.approx(rows, abs=2e-6)
    truth = problems.BY_NAME[name].truth(scene, np.arange(steps + 1) * dt)[0]
    assert np.abs(q - truth).max() < 0.03  # within 0.3 r: the same motion


@pytest.mark.parametrize("engine", engines.ENGINES)
def test_a_held_ball_stays_and_the_other_slides_off_it_as_it_should(engine):
    setting = next(s for s in engines.SETTINGS if s.engine == engine)
    if engines.missing(engine):
        pytest.skip(engines.missing(engine))
    problem = problems.BY_NAME["slide"]
    scene = problem.build(8)
    q, _ = setting.build(scene, 0.002).states(150)
    truth, _ = problem.truth(scene, np.arange(151) * 0.002)
    assert np.abs(q[:, :, 0] - scene.q0[:, 0]).max() < 1e-6
    assert np.abs(q - truth).max() < 0.02


def test_mujoco_has_restitution_when_its_solref_is_given_directly():
    pytest.importorskip("mujoco", reason="not installed: pip install mujoco")
    scene = BOUNCE.build(0)
    for words, low, high in (("direct, no push, d 0.9999", 0.69, 0.71), ("as shipped", -0.01, 0.2)):
        run = contestants.BY_NAME[f"mujoco: {words}"].record(scene, 0.002, 2000)
        assert low < problems.quality(BOUNCE, scene, 0.002, run)["restitution"] < high


def test_damping_ratio_for_a_rebound_gives_that_rebound():
    """A spring and damper stepped finely, cut off where it would pull."""
    ratio = engines.rebound_ratio(0.7)
    x, v, dt = 0.0, -1.0, 1e-5
    while True:
        force = -x - 2.0 * ratio * v
        if x > -1e-12 and v > 0 or force < 0:
            break
        v += dt * force
        x += dt * v
    assert v == pytest.approx(0.7, abs=2e-3)


# the complementarity problem alone


@pytest.mark.parametrize("name", ["pivot of exact", "quadprog", "nnls", "Lemke (Drake)"])
def test_a_solver_meets_the_forces_of_a_tower_and_the_residual_says_so(name):
    solver = next(s for s in solvers.solvers() if s.name == name)
    if solver.missing:
        pytest.skip(solver.missing)
    case = solvers.case("tower of 10")
    lam = np.array(solver.prepare(case)())
    assert lam / solvers.DT == pytest.approx(closed_form.tower_forces(10, 1.0), rel=1e-9)
    assert case.residual(lam) < 1e-11
    assert case.residual(lam * 1.01) > 1e-4 and case.residual(lam - 0.1) > 1e-2


def test_sweeps_come_closer_the_more_there_are_and_the_compiled_ones_agree():
    case = solvers.case("tower of 10")
    few, many = (case.residual(np.array(solvers.sweeps(n)(case)())) for n in (10, 300))
    assert many < 1e-2 * few
    pytest.importorskip("numba", reason="not installed: pip install numba")
    assert (
        np.array(solvers.compiled_sweeps(10)(case)()) == np.array(solvers.sweeps(10)(case)())
    ).all()


def test_a_solver_that_fails_is_a_result_with_its_reason():
    def give_up(case):
        raise ValueError("cycles")

    found = [solvers.Solver("gives up", give_up)]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solvers, "solvers", lambda: found)
        told = solvers.solve(("tower of 10", "gives up", 1))
    assert told["residual"] is None and told["failed"] == "ValueError: cycles"


# cradle and tower, soft, skips, piles


def test_exact_passes_the_speed_on_at_any_gap_and_a_long_step_of_lcp_shares_it_out():
    exact, lcp = (contestants.BY_NAME[name] for name in ("exact: event to event", "lcp: 20 sweeps"))
    assert cradle.outcome(exact, 1e-6)["error"] < 1e-12
    assert cradle.outcome(lcp, 0.1)["error"] < 1e-12 < 0.1 < cradle.outcome(lcp, 1e-6)["error"]


@pytest.mark.parametrize(
    "name",
    [
        "exact: event to event",
        "lcp: 20 sweeps",
        "pymunk: 10 iterations",
        "box2d: 8 and 3 iterations",
        "mujoco: as shipped",
    ],
)
def test_the_forces_of_a_tower_are_read_where_they_are_told(name):
    contestant = contestants.BY_NAME[name]
    if contestant.refuses(DROP.build(0)):
        pytest.skip(contestant.refuses(DROP.build(0)))
    assert cradle.tower(contestant)["worst"] < 1e-5


def test_the_line_begins_at_penalty_and_ends_at_lcp():
    scene = contact.build_scene("drop")
    penalty = contact.run_model("penalty", scene, soft.DT, soft.STEPS)
    lcp = contact.run_model("lcp", scene, soft.DT, soft.STEPS, baumgarte=0.0)
    near = [soft.distance(soft.run_soft(soft.PENALTY_END, d, scene), penalty) for d in (1e-3, 1e-4)]
    far = [
        soft.distance(soft.run_soft(soft.LCP_END, d, scene, beta=0.0), lcp) for d in (0.999, 0.9999)
    ]
    assert near[1] == pytest.approx(0.1 * near[0], rel=0.05) and near[1] < 1e-4
    assert far[1] == pytest.approx(0.1 * far[0], rel=0.05) and far[1] < 1e-4


def test_the_critical_step_along_the_line_is_that_of_the_spring():
    scene = contact.build_scene("drop")
    theory = contact.critical_dt(1.0, soft.STIFFNESS, scene.damping)
    assert soft.critical_step(soft.PENALTY_END, 0.5, scene) == pytest.approx(theory, rel=2e-3)


def test_soft_has_one_answer_in_any_order_and_lcp_has_not_where_contacts_are_redundant():
    told = {row["name"]: row for row in soft.orders(count=4)}
    assert told["soft, as shipped"]["impulses"] < 1e-12
    assert (
        told["lcp, 10,000 sweeps"]["impulses"] > 0.01 > 1e-12 > told["lcp, 10,000 sweeps"]["speeds"]
    )


def test_skipping_changes_no_byte_in_the_short_form():
    """The long form is `python -m curriculum.bench skip`; this is the part that CI keeps."""
    cases = [case for case in skips.bytes_cases(quick=True) if case[1] == 0]
    for scene, seed, bodies, model, dt, steps in cases:
        built = contact.build_scene(scene, seed, bodies)
        one, other = (
            contact.run_model(model, built, dt, steps, skip=skip) for skip in (True, False)
        )
        assert all(getattr(one, part).tobytes() == getattr(other, part).tobytes() for part in "tqv")


def test_the_timed_pile_has_the_bits_of_a_recorded_run():
    pytest.importorskip("numba", reason="not installed: pip install numba")
    scene = contact.build_scene("pile", 0, 30)
    timed = piles.Twin(scene, piles.DT)
    timed.advance(100)
    timed.advance(100)
    run = contact.run_model("lcp", scene, piles.DT, 200, iters=piles.SWEEPS)
    assert timed.state()[0].tobytes() == run.q[-1].tobytes()


# what is printed


@pytest.mark.parametrize("label", piles.ENGINES)
def test_an_engine_of_the_pile_lets_it_fall_freely_at_first(label):
    """Each is built as the benchmark builds it; ten steps of 2 ms, before any ball touches."""
    if label in piles.missing():
        pytest.skip(piles.missing()[label])
    scene = contact.build_scene("pile", 0, 12)
    q, _ = piles.ENGINES[label][1](scene, piles.DT).states(10)
    fallen = 0.5 * -contact.GRAVITY * (10 * piles.DT) ** 2
    assert scene.q0[1] - q[-1, 1] == pytest.approx(fallen, rel=0.11)  # semi-implicit: a tenth more


def test_page_shows_divergence_with_step_and_reason(section):
    page = accuracy_report.page(section)
    assert re.search(r"\| penalty: k 1e4 \|.*\| diverged \|", page)
    assert "Diverged: penalty: k 1e4 at 16 ms" in page


def test_a_sentence_whose_condition_fails_is_not_printed_as_true(section):
    said = " ".join(map(str, accuracy_report.claims(section, "bounce")))
    assert "exact is off by rounding alone" in said
    changed = json.loads(json.dumps(section))
    points = tables.unpack(changed["points"])
    for point in points:
        if point["family"] == "exact":
            point["position_error"] = 0.5
    changed["points"] = tables.pack(points)
    said = " ".join(map(str, accuracy_report.claims(changed, "bounce")))
    assert "rounding alone" not in said and "exact is off by 0.500 r" in said


def test_goals_without_an_engine_are_not_claimed(section):
    goals = {goal.wanted: goal for goal in accuracy_report.goals(section)}
    assert goals["exact, drop: its error at most 1e-10 r"].met is True
    assert next(g for w, g in goals.items() if "the peer reading nothing" in w).met is None


def test_the_second_reading_holds_a_substep_against_a_step_of_its_length():
    """4 substeps of 2 ms are better than a step of 2 ms, those of 8 ms worse."""
    found = [("lcp", "20 sweeps", 0.002, 0.04), ("box2d3", "4 substeps", 0.002, 0.01),
             ("box2d3", "4 substeps", 0.008, 0.05)]  # fmt: skip
    keys = ("family", "words", "dt", "position_error")
    points = [dict(zip(keys, row), problem="drop", diverged=None) for row in found]
    data = accuracy_report.Points({"points": tables.pack(points)})
    by_step, by_substep = (accuracy_report._small_goal(data, "drop", way) for way in (False, True))
    assert not by_step.met and "4 substeps at 2 ms (0.01" in by_step.measured
    assert by_substep.met


def test_a_pile_that_nothing_here_could_step_is_a_page_that_says_so(tmp_path):
    """Without numba and without an engine the page ended in an IndexError."""
    section = {
        "rows": [], "exponents": {}, "dt": 0.002, "sweeps": 10, "missing": {"pymunk": "no"},
    }  # fmt: skip
    assert list(piles_report.claims(section)) == list(piles_report.goals(section)) == []
    saved = measured.save(tmp_path, "pile", section, piles.COMMAND, piles.CODE)
    assert "Left out: pymunk: no." in piles_report.page(saved)


def test_the_front_holds_what_nothing_beats_in_both():
    points = [dict(x=1, y=5), dict(x=2, y=6), dict(x=3, y=1), dict(x=1, y=7)]
    assert tables.front(points, "x", "y") == [dict(x=1, y=5), dict(x=3, y=1)]


def test_packed_rows_come_back():
    rows = [dict(a="x", b=0.123456), dict(a=None, b=math.pi)]
    assert tables.unpack(tables.pack(rows)) == [dict(a="x", b=0.1235), dict(a=None, b=3.142)]


def test_figures_of_the_problems_are_small_and_the_same_for_the_same_results(section):
    pytest.importorskip("matplotlib", reason="figures need matplotlib: pip install -e '.[bench]'")
    made = accuracy_report.figures(section)
    assert set(made) == {"error-drop.svg", "error-bounce.svg"}
    assert made == accuracy_report.figures(section)


# the README's blocks and the committed results

TEXT = "# x\n<!-- generated: {} by {} -->\nold\n<!-- end -->\nlast\n"


@pytest.fixture
def results(section, tmp_path, monkeypatch):
    """A results folder of the benchmark that holds the tiny measurement, and a README."""
    (tmp_path / measured.NAME).write_text(measured.text({"accuracy": section}))
    monkeypatch.setattr(readme, "BENCH", tmp_path)
    monkeypatch.setattr(readme, "README", tmp_path / "README.md")
    (tmp_path / "README.md").write_text(TEXT.format("bench-headline", readme.COMMAND))
    return tmp_path


def test_readme_block_is_filled_and_others_are_left_alone(results):
    new = readme.fill(TEXT.format("bench-headline", readme.COMMAND))
    assert "old" not in new and "| exact |" in new and new.endswith("<!-- end -->\nlast\n")
    assert "Stale" not in new and readme.fill(new) == new
    other = TEXT.format("tree", "python -m something.else")
    assert readme.fill(other) == other


def test_a_block_of_results_older_than_the_code_says_stale_and_names_the_command(results, section):
    old = json.loads(json.dumps(section))
    old["measured"]["code"]["contact.py"] = "0" * 12
    (results / measured.NAME).write_text(measured.text({"accuracy": old}))
    new = readme.fill(TEXT.format("bench-headline", readme.COMMAND))
    assert "**Stale**: contact.py has changed" in new and accuracy.COMMAND in new


def test_readme_block_not_measured_yet_names_its_command(results):
    new = readme.fill(TEXT.format("bench-pile", readme.COMMAND))
    assert "Not measured yet: `python -m curriculum.bench pile`." in new


def test_readme_block_with_an_unknown_name_fails_with_its_line():
    with pytest.raises(ValueError, match=r"README.md:2: no generated block 'bench-nothing'"):
        readme.fill(TEXT.format("bench-nothing", readme.COMMAND))


def test_a_block_that_differs_fails_the_check_and_names_the_repair(results, capsys):
    assert readme.main(["--check"]) == 1
    assert "README.md:3:" in (said := capsys.readouterr().err) and readme.COMMAND in said
    assert readme.main([]) == 0
    assert readme.main(["--check"]) == 0


@pytest.mark.parametrize("what", sorted(measured.load(command.RESULTS)))
def test_committed_pages_are_those_of_the_committed_results(what):
    section = measured.load(command.RESULTS)[what]
    assert not section["quick"], f"{what}: a quick run was kept"
    written = (command.RESULTS / f"{what}.md").read_text(encoding="utf-8")
    assert written == command.report(what).page(section), (
        "to repair: python -m curriculum.bench draw"
    )


# the command line


@pytest.mark.parametrize(
    "flags",
    [
        ["everything"],
        ["--chekc"],
        ["skip", "--only", "drop"],
        ["accuracy", "--only", "nothing"],
        ["draw", "--out", "/dev/null/x"],
    ],
)
def test_bad_flags_are_one_line_and_status_2(flags, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(flags)
    assert stop.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_code_that_changes_while_it_is_measured_is_not_written(tmp_path, monkeypatch, capsys):
    rising = iter(range(100))
    monkeypatch.setattr(measured, "code_hash", lambda name, root=None: str(next(rising)))
    monkeypatch.setattr(cradle, "measure", lambda quick, cells: {})
    assert command.main(["cradle", "--quick", "--out", str(tmp_path)]) == 1
    assert "changed while cradle was measured" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_draw_without_results_says_what_to_run(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(["draw", "--out", str(tmp_path)])
    assert stop.value.code == 2
    assert "run python -m curriculum.bench" in capsys.readouterr().err
