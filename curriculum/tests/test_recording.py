"""The recording, opened again: paths, rows, values, colours, layout, and which way is up."""

import re
import subprocess
import sys

import numpy as np
import pytest

import contact

pytest.importorskip("rerun", reason="rerun is not installed")

DT, STEPS = 0.002, 600
CURVES = ("height", "penetration", "energy")


def runs_of(name, **made):
    scene = contact.build_scene(name, **made)
    return scene, {model: contact.run_model(model, scene, DT, STEPS) for model in contact.MODELS}


@pytest.fixture
def stack(tmp_path, read_recording):
    """A recording of the stack of three, opened again, with the scene and the runs it is of."""
    scene, runs = runs_of("stack")
    path = tmp_path / "contact.rrd"
    contact.log_rerun(path, runs, scene)
    return read_recording(path), scene, runs


def positions(recording, model):
    """Logged positions (steps + 1, N, 2) of a model's balls."""
    return np.array(recording.series[f"/world/{model}/balls"]["Points2D:positions"])


def test_it_holds_balls_table_and_three_curves_of_every_model_and_nothing_else(stack):
    recording = stack[0]
    moving = {f"/world/{model}/balls" for model in contact.MODELS}
    curves = {f"/{curve}/{model}" for curve in CURVES for model in contact.MODELS}
    tables = {f"/world/{model}/table" for model in contact.MODELS}
    assert set(recording.series) == moving | curves
    assert set(recording.static) == moving | curves | tables
    assert re.fullmatch("[a-z0-9_]+", recording.application)  # others are renamed with a warning


def test_every_moving_thing_has_one_row_a_step_on_both_timelines(stack):
    recording = stack[0]
    for entity, columns in recording.series.items():
        assert columns["step"] == list(range(STEPS + 1)), entity
        nanoseconds = [2_000_000 * k for k in range(STEPS + 1)]
        assert columns["sim_time"] == nanoseconds, entity  # float seconds would be 1 ns off


def test_the_balls_are_where_the_run_had_them_and_up_is_up(stack):
    """Rerun's 2-D views have y down, so a height y above the table is logged as -y."""
    recording, scene, runs = stack
    for model, run in runs.items():
        shown = positions(recording, model)
        assert shown.shape == (STEPS + 1, 3, 2)
        assert np.array_equal(shown[..., 1], (-run.q[:, 1]).astype(np.float32))
        shift = shown[0, 0, 0] - run.q[0, 0, 0]
        assert np.abs(shown[..., 0] - shift - run.q[:, 0]).max() < 1e-6
        assert (shown[:, 0, 1] > shown[:, 2, 1]).all(), "the lowest ball is not drawn lowest"


def test_the_models_stand_side_by_side_over_their_own_tables(stack):
    recording, scene, runs = stack
    right = -np.inf
    for model in runs:
        ((left_end, right_end),) = recording.static[f"/world/{model}/table"]["LineStrips2D:strips"]
        assert left_end[1] == right_end[1] == 0.0
        across = positions(recording, model)[..., 0]
        assert right < left_end[0] < across.min() - 0.1 and across.max() + 0.1 < right_end[0]
        right = right_end[0]
        assert recording.static[f"/world/{model}/table"]["LineStrips2D:labels"] == [model]
        drawn = recording.static[f"/world/{model}/balls"]["Points2D:radii"]
        assert np.allclose(drawn, scene.radius, rtol=1e-7)


def test_curves_hold_the_runs_own_numbers_bit_for_bit(stack):
    recording, scene, runs = stack
    for model, run in runs.items():
        total = contact.energy(run.q, run.v, scene.mass)
        expected = {
            "height": run.q[:, 1, 0],
            "penetration": contact.max_penetration(run.q, scene.radius) / 0.1,
            "energy": total - total[0],
        }
        for curve, values in expected.items():
            logged = recording.series[f"/{curve}/{model}"]["Scalars:scalars"]
            assert logged == [[value] for value in values.tolist()], f"{curve} of {model}"


def test_a_model_has_its_one_colour_everywhere(stack):
    recording = stack[0]
    for model, color in contact.COLORS.items():
        rgba = int(color[1:] + "ff", 16)
        for curve in CURVES:
            series = recording.static[f"/{curve}/{model}"]
            assert series["SeriesLines:colors"] == [rgba]
            assert series["SeriesLines:names"] == [model]
        assert set(recording.static[f"/world/{model}/balls"]["Points2D:colors"]) == {rgba}
        assert recording.static[f"/world/{model}/table"]["LineStrips2D:colors"] == [rgba]


def test_a_blueprint_inside_shows_the_balls_and_three_plots_from_t_0(stack):
    recording = stack[0]
    facts = {}
    for _, row in recording.blueprint:
        for column, value in row.items():
            facts.setdefault(column, []).append(value)
    origins = sum(facts["ViewBlueprint:space_origin"], [])
    assert sorted(origin.strip("/") for origin in origins) == sorted(("world", *CURVES))
    names = sum(facts["ViewBlueprint:display_name"], [])
    assert any("[r]" in name for name in names) and any("[J]" in name for name in names)
    assert facts["TimePanelBlueprint:timeline"] == [["sim_time"]]
    assert "TimePanelBlueprint:play_state" in facts
    (((x, y),),) = (
        [(bounds["x_range"], bounds["y_range"]) for bounds in seen]
        for seen in facts["VisualBounds2D:range"]
    )
    for model in contact.MODELS:
        spots = positions(recording, model).reshape(-1, 2)
        assert (spots > [x[0], y[0]]).all() and (spots < [x[1], y[1]]).all(), f"{model} not in view"


def test_two_recordings_of_a_run_hold_equal_content(tmp_path, read_recording):
    content = []
    for name in ("a.rrd", "b.rrd"):
        scene, runs = runs_of("drop")
        contact.log_rerun(tmp_path / name, runs, scene)
        content.append(read_recording(tmp_path / name)[:2])
    assert content[0] == content[1]
    scene, runs = runs_of("drop", seed=1)
    contact.log_rerun(tmp_path / "c.rrd", runs, scene)
    assert read_recording(tmp_path / "c.rrd")[:2] != content[0], "the comparison sees nothing"


def test_one_model_alone_is_recorded_alone(tmp_path, read_recording):
    scene, runs = runs_of("drop")
    contact.log_rerun(tmp_path / "one.rrd", {"lcp": runs["lcp"]}, scene)
    recording = read_recording(tmp_path / "one.rrd")
    assert set(recording.series) == {"/world/lcp/balls", *(f"/{curve}/lcp" for curve in CURVES)}


def test_a_pile_is_recorded_with_all_its_balls(tmp_path, read_recording):
    scene = contact.build_scene("pile", bodies=40)
    run = contact.run_model("lcp", scene, DT, 20)
    contact.log_rerun(tmp_path / "pile.rrd", {"lcp": run}, scene)
    shown = positions(read_recording(tmp_path / "pile.rrd"), "lcp")
    assert np.array_equal(shown[..., 1], (-run.q[:, 1]).astype(np.float32))


def test_a_run_that_overflows_is_recorded_too(tmp_path, read_recording):
    scene = contact.build_scene("drop")
    run = contact.run_model("penalty", scene, 1e5, 300, stiffness=1e300)
    assert not np.isfinite(run.q).all()
    contact.log_rerun(tmp_path / "burst.rrd", {"penalty": run}, scene)
    assert len(read_recording(tmp_path / "burst.rrd").series["/height/penalty"]["step"]) == 301


def test_a_run_longer_than_64_bit_nanoseconds_is_recorded_by_step(tmp_path, read_recording):
    scene = contact.build_scene("drop")
    run = contact.run_model("exact", scene, 1e200, 20)
    contact.log_rerun(tmp_path / "long.rrd", {"exact": run}, scene)
    series = read_recording(tmp_path / "long.rrd").series
    assert series["/height/exact"]["step"] == list(range(21))


def test_a_wrong_call_raises_instead_of_warning(tmp_path):
    """Strict mode is on: what lost the published recording its curves would now stop the run."""
    code = (
        "import sys, contact, rerun as rr\n"
        "scene = contact.build_scene('drop')\n"
        "runs = {'lcp': contact.run_model('lcp', scene, 0.002, 3)}\n"
        "contact.log_rerun(sys.argv[1], runs, scene)\n"
        "try: rr.log('x', rr.Points2D([[0, 0]]), colours=3)\n"
        "except TypeError: print('raised')\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "a.rrd")],
        text=True,
        capture_output=True,
        cwd=contact.__file__.rpartition("/")[0],
    )
    assert run.stdout == "raised\n", run.stderr


def test_a_failure_while_recording_keeps_the_old_file(tmp_path):
    scene, runs = runs_of("drop")
    path = tmp_path / "contact.rrd"
    path.write_bytes(b"old")
    broken = runs["lcp"]._replace(q=runs["lcp"].q[:-1])
    with pytest.raises(Exception):
        contact.log_rerun(path, {"lcp": broken}, scene)
    assert path.read_bytes() == b"old" and [file.name for file in tmp_path.iterdir()] == [path.name]
