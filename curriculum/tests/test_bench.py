"""The benchmark judges rightly: its references, every engine's adapter, its piles and its page."""

import json

import numpy as np
import pytest

import contact

pytest.importorskip("scipy", reason="scipy is missing: the extra `bench`")
fast = pytest.importorskip("curriculum.fast", reason="numba is missing", exc_type=ImportError)

from curriculum.bench import __main__ as bench  # noqa: E402
from curriculum.bench import accuracy, closed_form, engines, piles, problems, report, skips, timing  # noqa: E402
from curriculum.measured import results  # noqa: E402

R = contact.RADIUS
HERE = [s for s in engines.SETTINGS if not engines.missing(s.engine)]
each_setting = pytest.mark.parametrize("setting", HERE, ids=lambda s: f"{s.engine}: {s.words}")


# references


@pytest.mark.parametrize("problem", problems.PROBLEMS, ids=lambda p: p.name)
def test_exact_has_no_error_and_penalty_has_one(problem):
    scene, dt = problem.build(1), 0.004
    steps = min(problem.steps(dt), 300)
    found = {
        model: problems.quality(problem, scene, contact.run_model(model, scene, dt, steps))
        for model in ("exact", "penalty")
    }
    assert found["exact"]["error"] < 1e-10
    assert found["exact"]["energy_error"] < 1e-10
    assert found["penalty"]["error"] > 1e-4


# engines


@each_setting
def test_an_engine_falls_as_a_ball_does_and_comes_to_rest_on_the_floor(setting):
    scene = contact.build_scene("drop")
    dt, gap = 0.002, float(scene.q0[1, 0]) - R
    session = setting.build(scene, dt)
    heights = np.array(session.trace(200))[:, 0]
    parabola, _ = closed_form.bounce_motion(gap, 0.0, np.arange(201) * dt)
    assert np.abs(heights - R - parabola).max() < 0.5 * closed_form.g * 0.4 * dt + 1e-5
    session = setting.build(scene, dt)
    session.advance(1000)
    q, v = session.state()
    assert q.shape == v.shape == (2, 1)
    slow = setting.engine == "drake" or "no push" in setting.words  # to push an overlap out
    assert abs(q[1, 0] - R) < (0.2 if slow else 0.02) * R
    assert abs(v).max() < 1e-2


@each_setting
def test_an_engine_holds_the_fixed_ball_and_lets_the_other_slide_off(setting):
    problem = problems.BY_NAME["slide"]
    scene, dt = problem.build(4), 0.001
    if setting.refuses(scene):
        pytest.skip(setting.refuses(scene))
    q, v = setting.build(scene, dt).states(300)
    assert np.allclose(q[:, :, 0], scene.q0[:, 0], atol=1e-7) and not v[:, :, 0].any()
    run = contact.Run(np.arange(301) * dt, q, v)
    assert problems.quality(problem, scene, run)["error"] < 0.2


@pytest.mark.parametrize(
    "setting",
    [
        s
        for s in HERE
        if s.engine in ("pymunk", "box2d3") or s.words.startswith("direct, no push, d 0")
    ],
)
def test_an_engine_bounces_with_the_restitution_of_the_scene(setting):
    _, v = setting.build(contact.build_scene("bounce"), 0.001).states(700)
    impact = int(np.argmax(np.diff(v[:, 1, 0]) > 1.0))
    assert v[impact + 3, 1, 0] == pytest.approx(-0.7 * v[impact, 1, 0], abs=0.15)


# contestants and cells


@pytest.mark.parametrize("name", [c.name for c in accuracy.CONTESTANTS if c.engine == "lcp"])
def test_every_lcp_is_within_its_error_on_the_stack_and_substeps_keep_the_times(name):
    problem, c = problems.BY_NAME["stack"], accuracy.BY_NAME[name]
    scene = problem.build(2)
    q, v = c.build(scene, 0.004).states(200)
    assert q.shape == v.shape == (201, 2, 3)
    run = contact.Run(np.arange(201) * 0.004, q, v)
    assert problems.quality(problem, scene, run)["error"] < (0.02 if "substeps" in name else 0.2)


# piles


@pytest.mark.parametrize("count", [12, 100, 1000, 10_000])
def test_a_shaft_starts_without_contact_between_walls_that_nothing_moves(count):
    scene = piles.shaft(count)
    assert fast.smallest_gap(scene.q0[None], scene.radius)[0] > 0.04 * R
    walls = np.isinf(scene.mass)
    assert (~walls).sum() == count
    assert scene.q0[0, walls].min() < scene.q0[0, ~walls].min() - R
    assert scene.q0[0, walls].max() > scene.q0[0, ~walls].max() + R
    assert scene.q0[1, walls].max() > scene.q0[1, ~walls].max()


def test_depths_are_those_of_the_contacts():
    scene = contact.build_scene("stack")
    q = scene.q0.copy()
    q[1] = np.array((0.9, 2.7, 5.0)) * R
    found = piles.depths(q, scene)
    assert found["contacts"] == 2
    assert found["mean_depth"] == pytest.approx(0.15)
    assert found["worst_depth"] == pytest.approx(0.2)


@pytest.mark.parametrize(
    "number",
    [k for k, s in enumerate(piles.SETTINGS) if s.engine == "lcp" or not engines.missing(s.engine)],
)
def test_a_pile_of_twelve_settles_between_walls_in_every_engine(number):
    q, v, row = piles.settle((12, number, None))
    assert row["at_rest"] and row["speed"] < 1e-3
    assert abs(q[0, :12]).max() < 6.0 * R, "no ball left the shaft"
    assert row["contacts"] > 11 and row["mean_depth"] < 0.02


def row(engine, us, depth, words="", at_rest=True):
    return dict(
        bodies=12,
        engine=engine,
        words=words,
        at_rest=at_rest,
        mean_depth=depth,
        resting=timing.spread([us]),
    )


def test_only_what_rests_awake_within_the_depth_is_compared():
    rows = [
        row("lcp", 30.0, 5e-5),
        row("lcp", 5.0, 5e-4),
        row("lcp", 1.0, 5e-5, at_rest=False),
        row("box2d3", 40.0, 9e-5),
        row("box2d3", 0.1, 9e-5, piles.ASLEEP),
        row("pymunk", 3.0, 2e-3),
    ]
    found = piles.best(rows)["12"]
    assert found["0.001"]["engines"]["lcp"]["us"] == 5.0
    assert found["0.001"]["ratio"] == 5.0 / 40.0
    assert found["0.0001"]["ratio"] == 30.0 / 40.0
    missed = [met for _, _, met in report.pile_goals({"best": {"12": found}})]
    assert missed == [True, False]


# skips, pages


def test_skips_change_no_bit_of_the_cases_that_are_compared():
    assert all(map(skips.is_same, list(skips.cases(True))[::5]))


def test_the_page_shows_every_point_and_marks_what_is_missed(tmp_path):
    jobs = [
        ("drop", name, dt, 2)
        for name in (
            "penalty: k 1e4",
            "lcp: 20 sweeps",
            "lcp: compiled, 20 sweeps",
            "exact: event to event",
        )
        for dt in (0.002, 0.008)
    ]
    points = [
        accuracy.point(job, accuracy.errors_of(job), [accuracy.times_of(job)]) for job in jobs
    ]
    about = dict(
        problems={"drop": dict(title="Drop", stresses="much", duration=4.0)},
        points=accuracy.packed(points),
        headline=accuracy.headline(points),
        left_out={},
    )
    saved = results.save(tmp_path, "accuracy", about, results.origin("measure", kept=False))
    report.write(tmp_path, {"accuracy": saved})
    page = (tmp_path / "README.md").read_text("utf-8")
    assert page.count("| penalty: k 1e4 |") == 2 and "met |" in page
    figure = (tmp_path / "error-drop.svg").read_text("utf-8")
    assert "worst position error [r]" in figure and "lcp: compiled, 20 sweeps" in figure
    spoiled = json.loads(
        json.dumps(saved).replace('"exact"', '"soft"').replace('"penalty"', '"exact"')
    )
    assert "**missed**" in report.page({"accuracy": spoiled})


def test_a_part_that_does_not_exist_is_refused_in_one_line(capsys):
    with pytest.raises(SystemExit) as stopped:
        bench.main(["speed"])
    assert stopped.value.code == 2
    assert "accuracy" in capsys.readouterr().err
