"""The benchmark judges rightly: references, engines, cells worked out by hand, invented rows."""

import functools
import gc
import math
import re
import sys
import time

import numpy as np
import pytest

import contact

pytest.importorskip("scipy", reason="scipy is missing: the extra `bench`")
fast = pytest.importorskip("curriculum.fast", reason="numba is missing", exc_type=ImportError)

from curriculum.bench import __main__ as bench  # noqa: E402
from curriculum.bench import (  # noqa: E402
    accuracy,
    engines,
    piles,
    problems,
    report,
    settings,
    skips,
    timing,
)
from curriculum.measured import results  # noqa: E402

R, g = contact.RADIUS, 9.81
ALL = [s for s in settings.EVERYBODY if not engines.not_installed(s.engine)]
HERE = [s for s in ALL if s in settings.SETTINGS]
RESTING = [s for s in HERE if not s.only or "drop" in s.only]
each_setting = pytest.mark.parametrize("setting", RESTING, ids=lambda s: s.name)


# references


def test_closed_forms_are_what_paper_and_pencil_give():
    height, speed = problems.bounce_motion(g / 2, 0.5, [0.5, 1.5, 3.5])  # falls for 1 s
    assert height == pytest.approx([g * 3 / 8, g / 8, 0.0])
    assert speed == pytest.approx([-g / 2, 0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("problem", problems.PROBLEMS, ids=lambda p: p.name)
def test_exact_has_no_error_and_penalty_has_one(problem):
    scene, dt = problem.build(1), 0.004
    steps = min(problem.steps(dt), 300)
    found = {
        model: problems.quality(problem, scene, contact.run_model(model, scene, dt, steps))
        for model in ("exact", "penalty")
    }
    assert found["exact"]["error"] < 1e-10 and found["exact"]["energy_error"] < 1e-10
    assert found["penalty"]["error"] > 1e-4
    assert float(re.search(r"([\d.]+) s$", problem.title)[1]) == problem.duration


def test_the_errors_of_an_invented_run_are_those_worked_out_by_hand():
    problem, t = problems.BY_NAME["drop"], np.arange(0.0, 4.001, 0.002)
    scene = problem.build(0)
    q, v = problem.truth(scene, t)
    q[100, 1] += 0.3 * R  # too high while it falls, and too deep at the end
    q[-1, 1] -= 0.2 * R
    found = problems.quality(problem, scene, contact.Run(t, q, v))
    one = dict(error=0.3, final_error=0.2, energy_error=0.3 * R / scene.q0[1, 0], depth=0.2)
    assert found == pytest.approx(one | {"diverged": None})


# engines


# beyond 16 substeps the lag drowns in the rounding of float32
@pytest.mark.parametrize(
    "setting, substeps",
    [(each, n) for n in (1, 4) for each in ALL if each.inner * n <= 16],
    ids=lambda value: getattr(value, "name", value),
)
def test_a_falling_ball_lags_by_half_a_substep_as_semi_implicit_euler_does(setting, substeps):
    scene, dt, t = contact.build_scene("drop"), 0.002, 0.4
    heights = np.array(setting.build(scene, dt, substeps).trace(200))
    assert heights.shape == (201, 1)
    lag = heights[-1, 0] - (scene.q0[1, 0] - g * t * t / 2)
    late = 1.0 if setting.engine == "pymunk" else -1.0  # it moves first, then accelerates
    exact = setting.adaptive or setting.engine == "leapfrog" or setting.half
    known = 0.0 if exact else late * g * t * dt / (substeps * setting.inner) / 2
    within = 0.7 * math.sqrt(setting.options.get("accuracy", 0.0))  # of CENIC, measured
    assert lag == pytest.approx(known, rel=0.01, abs=max(2e-5, within))


@each_setting
def test_an_engine_comes_to_rest_on_the_floor(setting):
    session = setting.build(contact.scene_of(0.0, 1.0, vx=1e-5), 0.002)
    session.go(1000)
    q, v = session.state()
    slow = setting.engine == "drake" or "no push" in setting.words  # to push an overlap out
    assert abs(q[1, 0] - R) < (0.2 if slow else 0.02) * R
    assert abs(v).max() < 1e-2
    assert v[0, 0] == pytest.approx(1e-5, rel=1e-3), "awake, it slides on for ever"


@each_setting
def test_two_balls_of_unequal_mass_and_size_that_collide_go_on_with_their_momentum(setting):
    scene = contact.scene_of([-0.2, 0.2], 5.0, [3.0, 1.0], [0.1, 0.05], vx=[1.0, -1.0])
    q, v = setting.build(scene, 0.001).states(250)
    assert scene.mass @ v[-1, 0] == pytest.approx(2.0, abs=1e-3)
    if setting.words != "as shipped":  # of MuJoCo, which takes a tenth of a second for it
        loose = setting.options.get("accuracy") == 1e-3 or "dissipation" in setting.options
        assert v[-1, 0] == pytest.approx([0.5, 0.5], abs=2e-2 if loose else 1e-3)
        assert q[-1, 0, 1] - q[-1, 0, 0] == pytest.approx(0.15, abs=2e-3 if loose else 1e-3)


@pytest.mark.parametrize("setting", [s for s in HERE if s.engine in ("mujoco", "pymunk")],
                         ids=lambda s: s.name)  # fmt: skip
def test_an_engine_begins_with_its_last_impulses_as_shipped_and_pushes_alike_at_any_step(setting):
    session = setting.build(contact.build_scene("drop"), 0.002, 16)
    if setting.engine == "pymunk":
        space = session.space
        push = setting.options.get("push", 1.0 - type(space)().collision_bias ** 0.002)
        assert 1.0 - space.collision_bias**0.002 == pytest.approx(push)
        assert f"{space.iterations} iterations" in setting.words
        assert space.collision_persistence == type(space)().collision_persistence
    else:
        autoreset = session.mujoco.mjtDisableBit.mjDSBL_AUTORESET
        assert session.model.opt.disableflags == autoreset


@each_setting
def test_an_engine_holds_the_fixed_ball_and_lets_the_other_slide_off(setting):
    problem = problems.BY_NAME["slide"]
    scene, dt = problem.build(4), 0.001
    q, v = setting.build(scene, dt).states(300)
    assert np.allclose(q[:, :, 0], scene.q0[:, 0], atol=1e-7) and not v[:, :, 0].any()
    run = contact.Run(np.arange(301) * dt, q, v)
    assert problems.quality(problem, scene, run)["error"] < 0.2


BOUNCING = [s for s in HERE if s.engine in ("pymunk", "box2d3") or "no push, d" in s.words]
BOUNCING = [(s, 0.7, 0.15) for s in BOUNCING]
BOUNCING += [
    (s, 1.0, 0.03 if s.only else 4.0)  # Drake's convex solver gains or loses much
    for s in HERE
    if s.engine == "drake" and (not s.only or "elastic" in s.only)
    if s.options.get("accuracy") != 1e-3
]


@pytest.mark.parametrize("setting, e, within", BOUNCING, ids=lambda s: getattr(s, "name", s))
def test_an_engine_bounces_with_the_restitution_of_the_scene(setting, e, within):
    _, v = setting.build(contact.build_scene("bounce", restitution=e), 0.001).states(700)
    impact = int(np.argmax(np.diff(v[:, 1, 0]) > 1.0))
    assert v[impact + 3, 1, 0] == pytest.approx(-e * v[impact, 1, 0], abs=within)


@pytest.mark.skipif(bool(engines.not_installed("drake")), reason="needs Drake")
def test_a_ball_sinks_by_m_g_over_k_into_drakes_floor():
    scene = contact.scene_of(0.0, 0.13, 0.7, 0.13)
    height = settings.BY_NAME["drake: discrete, k 1e+08"].build(scene, 0.002).trace(500)[-1][0]
    assert 0.13 - height == pytest.approx(0.7 * g / 1e8, rel=0.02)


@pytest.mark.parametrize(
    "stiff, soft",
    [
        ("box2d3: 4 substeps, hardest", "box2d3: 4 substeps, as shipped"),
        ("mujoco: direct, push 0.2, d 0.999", "mujoco: as shipped"),
    ],
)
def test_stiffer_knobs_of_an_engine_sink_less(stiff, soft):
    sunk = []
    for name in (stiff, soft):
        if why := engines.not_installed(settings.BY_NAME[name].engine):
            pytest.skip(why)
        session = settings.BY_NAME[name].build(contact.build_scene("stack"), 0.002)
        session.go(1500)
        sunk.append(R - session.state()[0][1, 0])
    assert sunk[0] < 0.1 * sunk[1]


# cells

LANDS = "lcp: 20 sweeps"


def test_the_cell_of_the_drop_is_what_one_works_out_by_hand():
    drop, job = problems.BY_NAME["drop"], ("drop", LANDS, 0.002, 4, 5)
    falls = [math.sqrt(2 * (drop.build(k).q0[1, 0] - R) / g) for k in range(5)]
    found = accuracy.errors_of(job)
    for fall, about in zip(falls, found):  # by half a substep at the landing, then by a dive
        assert 0.98 * g * 0.0005 * fall / 2 <= about["error"] * R <= 4 * g * 0.0005 * fall
        assert about["work"] == 4 and about["diverged"] is None
    assert len({about["error"] for about in found}) == 5, "every start has a scene of its own"
    (about,) = accuracy.errors_of(("bounce", "lcp: 20 sweeps", 0.002, 1, 1))
    assert about["final_error"] < 1e-6, "4 s are enough to come to rest"


def test_times_are_medians_of_runs_after_a_short_one():
    looks = []

    def clock(call):
        looks.extend(call.args)
        return [99.0, 9.0, 1.0, 2.0][len(looks) - 1] / 1e3, call()

    assert accuracy.time_of(("drop", LANDS, 0.002, 1, 5), clock) == 2e-3
    assert looks == [50, 2000, 2000, 2000]
    start = time.process_time()
    taken = accuracy.time_of(("slide", LANDS, 0.002, 1, 1))  # by the real clock
    assert 0.0 < taken < time.process_time() - start


def test_substeps_reach_ours_and_no_step_is_skipped():
    scene = contact.build_scene("stack")
    run = contact.run_model("lcp", scene, 0.0005, 800, contact.Settings(skip=False))
    session = settings.BY_NAME[LANDS].build(scene, 0.002, 4)
    q, v = session.states(200)
    assert q.tobytes() == run.q[::4].tobytes() and v.tobytes() == run.v[::4].tobytes()
    assert not session.settings.skip


@pytest.mark.skipif(bool(engines.not_installed("pymunk")), reason="pymunk is missing")
def test_the_engine_of_pymunk_alone_goes_where_a_users_step_goes():
    setting, scene = settings.BY_NAME["pymunk: 10 iterations"], problems.BY_NAME["pile"].build(0)
    bare, users = (setting.build(scene, 0.002) for _ in range(2))
    users.step = functools.partial(users.space.step, 0.002)
    assert np.array_equal(bare.states(400), users.states(400))


def test_all_engines_get_the_same_substeps_and_leapfrogs_two_solves_count_twice():
    found = {}
    for job in accuracy.cells([problems.BY_NAME["slide"]], False):
        if job[2] == 0.002 and not settings.BY_NAME[job[1]].adaptive:
            session = settings.BY_NAME[job[1]].build(problems.BY_NAME["slide"].build(0), *job[2:4])
            work = accuracy.work_of(settings.BY_NAME[job[1]], session, 1)
            found.setdefault(settings.BY_NAME[job[1]].engine, set()).add(work)
    assert found.pop("leapfrog") == {2, 8, 16, 32}
    assert all({1, 4, 16} <= work and max(work) in (16, 64) for work in found.values())


def point(family, error, ms, dt=0.002, work=16, problem="drop", **more):
    about = dict(problem=problem, family=family, words=f"{family} {error}", dt=dt, work=work)
    about |= dict(balls=1, diverged=0, error=error, final_error=0.0, energy_error=0.0, depth=0.0)
    return about | dict(errors=timing.spread([error or 0.0]), ms=timing.spread([ms])) | more


def test_a_point_has_medians_over_starts_and_over_processes():
    errors = [
        dict(error=e, final_error=e, energy_error=e, depth=e, diverged=None, work=4)
        for e in (9.0, 1.0, 2.0)
    ]
    errors[0]["diverged"] = 7
    p = accuracy.point(("drop", LANDS, 0.002, 4, 3), errors, (0.009, 0.001, 0.002))
    assert (p["error"], p["errors"]) == (2.0, dict(median=2.0, min=1.0, max=9.0))
    assert p["ms"] == dict(median=2.0, min=1.0, max=9.0)
    assert (p["diverged"], p["work"], p["words"], p["balls"]) == (1, 4, "20 sweeps, 4 x", 1)


def test_the_best_is_the_most_accurate_that_may_compete():
    points = [
        point("lcp", 0.03, 1.0),
        point("lcp", 0.01, 30.0),
        point("lcp", 0.0100001, 25.0),
        point("lcp", 0.001, 9.0, work=64),
        point("lcp", 0.0001, 9.0, diverged=1),
        point("lcp", None, 9.0),
        point("lcp", 0.02, 9.0, dt=0.004),
    ]
    assert accuracy.headline(points)["drop"]["lcp"] == points[2]
    assert accuracy.headline(points, 10)["drop"]["lcp"]["error"] == 0.001  # 20 ms, any work
    assert accuracy.headline(points[:3], 10)["drop"]["lcp"]["error"] == 0.03
    assert accuracy.headline(points, work=1) == {}


@pytest.mark.skipif(bool(engines.not_installed("drake")), reason="needs Drake")
@pytest.mark.parametrize(
    "accuracy_, least, most", [(1e-3, 0.01, 1.1), (1e-7, 4, 16), (1e-9, 30, 99)]
)
def test_the_steps_of_an_engine_that_chooses_them_are_counted(accuracy_, least, most):
    names = [c.name for c in ALL if c.options.get("accuracy") == accuracy_ and "CENIC" in c.words]
    (found,) = accuracy.errors_of(("slide", names[-1], 0.002, 1, 1))
    assert least <= found["work"] <= most


def section_of(points):
    about = dict(title="A", stresses="b", duration=4.0)
    found = {p["problem"]: about for p in points}
    return dict(problems=found, points=accuracy.packed(points), left_out={})


@pytest.mark.parametrize("mine, rival", [(0.1, 0.2), (0.2, 0.1)])
def test_who_wins_and_loses_is_as_the_numbers_say(mine, rival):
    rows = [point("exact", 1e-12, 1.0), point("leapfrog", mine, 5.0), point("pymunk", rival, 5.0)]
    section = section_of(rows)
    (cells,) = report.contest_rows(section)
    assert [cell.startswith("**") for cell in cells[2:]] == [mine < rival, rival < mine] * 2
    assert ("is never beaten" in report.losses({"accuracy": section})) == (mine < rival)


def test_the_readme_says_what_to_take_with_the_worst_of_its_problems():
    rows = [
        point("leapfrog", 1e-3, 5.0, words="20 sweeps"),
        point("leapfrog", 0.2, 5.0, problem="bounce", words="20 sweeps"),
        point("pymunk", 0.7, 3.0, problem="bounce"),
    ]
    (row,) = report.choices(section_of(rows))
    assert row[1:] == ["leapfrog, 20 sweeps", "0.2 r, 5 ms (bounce)", "pymunk 0.7 r, 3 ms"]


# piles


@pytest.mark.parametrize("count", [12, 100, 1000, 10_000])
def test_a_shaft_starts_without_contact_between_walls_that_nothing_moves(count):
    scene = piles.shaft(count)
    assert fast.smallest_gap(scene.q0[None], scene.radius)[0] > 0.04 * R
    walls = np.isinf(scene.mass)
    (x, y), (wall_x, wall_y) = scene.q0[:, ~walls], scene.q0[:, walls]
    assert len(x) == count and wall_y.max() > y.max()
    assert wall_x.min() < x.min() - R and wall_x.max() > x.max() + R
    assert wall_x.min() + wall_x.max() == pytest.approx(0.0), "as near to 0 as float32 wants it"


def test_depths_are_those_of_the_contacts():
    q = np.array(((0, 0, 9), (0.9, 2.7, 1.0005))) * R  # the last hovers
    found = piles.depths(q, contact.build_scene("stack"))
    assert found["contacts"] == 2
    assert (found["mean_depth"], found["worst_depth"]) == pytest.approx((0.15, 0.2))


@pytest.mark.parametrize("number", range(len(settings.PILES)), ids=piles.words)
def test_a_pile_of_twelve_settles_between_walls_in_every_engine(number):
    if why := engines.not_installed(settings.PILES[number][0].engine):
        pytest.skip(why)
    q, v, row = piles.settle((12, number, None))
    assert row["at_rest"] and row["speed"] < 1e-3
    assert abs(q[0, :12]).max() < 6.0 * R, "no ball left the shaft"
    assert row["contacts"] > 11 and row["mean_depth"] < 0.02


def test_a_pile_rests_if_no_ball_is_faster_than_a_millimetre_a_second_at_any_look():
    assert [piles.rests([0.0, v, 0.0]) for v in (9e-4, 2e-3, math.nan)] == [True, False, False]


def test_a_pile_is_timed_a_step_from_the_lattice_and_from_its_settled_state():
    number = next(k for k, (s, n) in enumerate(settings.PILES) if (s.engine, n) == ("lcp", 4))
    lattice, state, sessions = piles.shaft(12).q0, piles.shaft(12).q0 + 1.0, []

    def clock(call):
        sessions.append(call.func.__self__)
        assert call.args == (50,)
        return [3.0, 1.0, 2.0][len(sessions) % 3], call()

    found = piles.time_of((12, number, (state, 0.0 * state)), clock)
    assert found == {"falling": 2e6 / 50, "resting": 2e6 / 50} and len(sessions) == 6
    assert all(session.substeps == 4 and not session.settings.skip for session in sessions)
    starts = [session.given[1].q0 for session in sessions]
    assert np.array_equal(starts, [lattice] * 3 + [state] * 3)


def pile_row(family, us, depth, words="", at_rest=True):
    spread = timing.spread([us])
    about = dict(bodies=12, family=family, words=words, at_rest=at_rest, mean_depth=depth)
    return about | dict(speed=0.0, worst_depth=depth, resting=spread, falling=spread)


ROWS = [
    pile_row("lcp", 30.0, 5e-5),
    pile_row("lcp", 5.0, 5e-4),
    pile_row("lcp", 1.0, 5e-5, at_rest=False),
    pile_row("leapfrog", 20.0, 5e-4),
    pile_row("box2d3", 40.0, 9e-5),
    pile_row("pymunk", 3.0, 2e-3),
]


def test_only_what_rests_awake_within_the_depth_is_compared():
    assert list(report.races({"rows": ROWS})) == [
        (12, 1e-3, ROWS[1], ROWS[4], ROWS[3]),
        (12, 1e-4, ROWS[0], ROWS[4], None),
    ]


def test_what_wins_with_a_thousand_balls_runs_with_ten_thousand():
    number = next(k for k, (s, _) in enumerate(settings.PILES) if s.engine == "box2d3")
    row = pile_row("box2d3", 9.0, 0.99e-3, piles.words(number)) | {"bodies": 1000}
    assert piles.winners([row]) == [number]


# skips, pages

SKIPS = dict(processes={"drop": dict(timing.spread([3.0]), base="numpy", ratio=3.0, least=3.0)})


def test_each_process_is_fresh_and_what_is_rare_runs_in_one():
    jobs, rare = ["1", "__import__('os').getpid()", "3"], ["3"]
    one, (first, second), rare = timing.in_fresh_processes(eval, jobs, 2, "test", rare)
    assert one == [1, 1] and rare == [3] and first != second


def test_time_is_that_of_the_processor_and_a_process_that_fails_is_not_timed(tmp_path):
    assert timing.timed(lambda: time.sleep(0.2))[0] < 0.1, "waiting costs nothing"
    assert timing.timed(gc.isenabled)[1] is False and gc.isenabled()
    with pytest.raises(RuntimeError, match="fails: [^$]*no_such"):
        timing.whole_process([sys.executable, "-c", "import no_such"], str(tmp_path))
    assert timing.spread([4, 1, 2]) == dict(median=2, min=1, max=4)
    found = skips.over_bases({"drop": [99, 4, 2, 9], "numpy": [99, 2, 1, 8]}, {"drop": "numpy"})
    assert found["drop"] == dict(median=4, min=2, max=9, base="numpy", ratio=2.0, least=2.0)


def test_the_pages_show_every_point_and_what_is_missed(tmp_path):
    rows = [point("exact", 1e-9, 1.0), point("leapfrog", 0.2, 5.0), point("pymunk", 0.1, 5.0)]
    made, saved = dict(accuracy=section_of(rows), pile=dict(rows=ROWS, compile={}), skip=SKIPS), {}
    for name, section in made.items():
        origin = results.origin("measure", *bench.made_by(name), kept=False)
        saved[name] = results.save(tmp_path, name, section, origin)
    report.write(tmp_path, saved)
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "| pymunk | - | - | 0.1 (pymunk 0.1, 2 ms) |" in page
    readme = report.readme(saved)
    assert "beaten in 1 of 1: drop (0.2 r, pymunk 0.1 r)" in readme and readme.count("\n") < 30
    assert "our fastest model 0.125 to 0.75 of" in readme and "leapfrog 0.5 to 0.5" in readme
    figure = (tmp_path / "error-drop.svg").read_text("utf-8")
    assert "worst position error [r]" in figure and "leapfrog: leapfrog 0.2" in figure
    assert (tmp_path / "settled.svg").exists()


def test_pages_and_readme_are_as_they_are_drawn_of_the_results_that_are_kept():
    from curriculum.stress import report as stress

    readme = (results.ROOT / "README.md").read_text("utf-8")
    blocks = {match[2]: match[3].strip() for match in results.BLOCK.finditer(readme)}
    for name, room in (("bench", report), ("stress", stress)):
        kept = (results.ROOT / results.FOLDERS[name] / "README.md").read_text("utf-8")
        assert kept == room.page(results.load(name))
        assert blocks[name] == room.readme(results.load(name)).strip()
