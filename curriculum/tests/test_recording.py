"""The recording, opened again: paths, rows, values, colours, layout, and which way is up."""

import re
import subprocess
import sys

import numpy as np
import pytest

import contact

rr = pytest.importorskip("rerun", reason="rerun is not installed")

DT, STEPS = 0.002, 600
CURVES = ("height", "penetration", "impulse", "energy", "rises")


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


def test_it_holds_balls_pushes_table_and_curves_of_every_model_and_nothing_else(stack):
    recording = stack[0]
    moving = {f"/world/{model}/{kind}" for model in contact.MODELS for kind in ("balls", "pushes")}
    curves = {f"/{curve}/{model}" for curve in CURVES for model in contact.MODELS}
    tables = {f"/world/{model}/{kind}" for model in contact.MODELS for kind in ("table", "ground")}
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


def test_every_model_has_its_own_view_in_which_the_table_is_a_line_over_the_balls(stack):
    """The line is thin and above the balls, the ground below them: a sink of 1 mm is seen."""
    recording, scene, runs = stack
    for model, run in runs.items():
        static = recording.static
        order = [
            static[f"/world/{model}/{kind}"][f"{shape}:draw_order"][0]
            for kind, shape in (
                ("ground", "LineStrips2D"), ("balls", "Points2D"),
                ("pushes", "Arrows2D"), ("table", "LineStrips2D"),
            )
        ]  # fmt: skip
        assert order == sorted(order)
        ((left, right),) = static[f"/world/{model}/table"]["LineStrips2D:strips"]
        assert left[1] == right[1] == 0.0
        (thick,) = static[f"/world/{model}/table"]["LineStrips2D:radii"]
        assert -1.0 < thick < 0.0, "below 0 it is in points of the screen, not in metres"
        ground = static[f"/world/{model}/ground"]
        depths = ground["LineStrips2D:radii"]
        for ((_, left), (_, right)), deep in zip(ground["LineStrips2D:strips"], depths):
            assert left == right == deep, "the ground ends at the table"
        for thin, thick in zip(depths, depths[1:]):
            assert thick / 100 < 2 * thin, "no gap where a thick line is drawn a hundredth thinner"
        assert np.array_equal(positions(recording, model)[..., 0], run.q[:, 0].astype(np.float32))
        drawn = static[f"/world/{model}/balls"]["Points2D:radii"]
        assert np.allclose(drawn, scene.radius, rtol=1e-7)


def test_an_arrow_starts_at_its_ball_points_along_the_push_and_has_the_stated_length(stack):
    recording, scene, runs = stack
    for model, run in runs.items():
        rows = recording.series[f"/world/{model}/pushes"]
        vectors = np.array(rows["Arrows2D:vectors"])
        assert np.array_equal(np.array(rows["Arrows2D:origins"]), positions(recording, model))
        weight = 9.81 * scene.mass
        force = np.diff(run.v[:, 1], axis=0) / DT * scene.mass + weight
        length = 0.1 * np.log2(1.0 + np.abs(force) / weight) * np.sign(force)
        assert np.abs(-vectors[1:, :, 1] - length).max() < 1e-5
        assert np.abs(-vectors[-1, :, 1] - 0.1).max() < 0.02, "a ball at rest: one radius"


def test_curves_hold_the_runs_own_numbers_bit_for_bit(stack):
    recording, scene, runs = stack
    for model, run in runs.items():
        total = contact.energy(run.q, run.v, scene.mass)
        rises = [max(0.0, after - before) for before, after in zip(total, total[1:])]
        expected = {
            "height": run.q[:, 1].mean(-1),
            "penetration": contact.max_penetration(run.q, scene.radius) / 0.1,
            "energy": total - total[0],
            "rises": np.cumsum([0.0, *rises]),
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


def blueprint_facts(recording):
    """{column: [value, ...]} of all rows of the blueprint."""
    facts = {}
    for _, row in recording.blueprint:
        for column, value in row.items():
            facts.setdefault(column, []).append(value)
    return facts


def test_a_blueprint_inside_shows_the_balls_the_table_magnified_and_five_plots_from_t_0(stack):
    recording = stack[0]
    facts = blueprint_facts(recording)
    origins = [origin.strip("/") for origin in sum(facts["ViewBlueprint:space_origin"], [])]
    worlds = [f"world/{model}" for model in contact.MODELS] * 2
    assert sorted(origins) == sorted((*worlds, *CURVES))
    names = sum(facts["ViewBlueprint:display_name"], [])
    for unit in ("[m]", "[r]", "[N s]", "[J]"):
        assert any(unit in name for name in names), unit
    assert set(contact.MODELS) < set(names)
    assert facts["TimePanelBlueprint:timeline"] == [["sim_time"]]
    assert "TimePanelBlueprint:play_state" in facts
    bounds = [seen[0] for seen in facts["VisualBounds2D:range"]]
    assert len(bounds) == 8
    large = max(bounds, key=lambda view: view["y_range"][1] - view["y_range"][0])
    (left, right), (top, bottom) = large["x_range"], large["y_range"]
    for model in contact.MODELS:
        x, y = np.moveaxis(positions(recording, model), -1, 0)
        assert left < x.min() - 0.1 and x.max() + 0.1 < right, f"{model} not in view"
        assert top < y.min() - 0.1 and y.max() < bottom, f"{model} not in view"


def test_curves_are_drawn_with_their_peaks_and_wide_beneath_thin(stack):
    """rerun averages many samples a pixel unless told otherwise, which hid half of a peak."""
    recording = stack[0]
    for curve in CURVES:
        wide = []
        for model in sorted(contact.MODELS):
            series = recording.static[f"/{curve}/{model}"]
            ((policy),) = series["SeriesLines:aggregation_policy"]
            assert policy == rr.components.AggregationPolicy.MinMax.value
            wide += series["SeriesLines:widths"]
        assert wide == sorted(wide, reverse=True) and len(set(wide)) == len(wide)


def views(recording):
    """The (x_range, y_range) of the views of balls, the widest first."""
    seen = [view[0] for view in blueprint_facts(recording)["VisualBounds2D:range"]]
    return sorted(
        ((view["x_range"], view["y_range"]) for view in seen), key=lambda v: np.ptp(v[0])
    )[::-1]


def test_balls_that_roll_far_stay_in_view_to_the_end(tmp_path, read_recording):
    """There is no friction: at the end of the pile of 12, eight balls had left their views."""
    scene = contact.build_scene("pile", bodies=12)
    runs = {model: contact.run_model(model, scene, 0.002, 2000) for model in ("penalty", "lcp")}
    contact.log_rerun(tmp_path / "pile.rrd", runs, scene)
    (left, right), (top, bottom) = views(read_recording(tmp_path / "pile.rrd"))[0]
    for run in runs.values():
        assert run.q[:, 0].max() > 3.0 * scene.q0[0].max(), "they roll far"
        assert left < run.q[:, 0].min() - 0.1 and run.q[:, 0].max() + 0.1 < right
        assert top < -run.q[:, 1].max() - 0.1 and bottom > 0.0


def test_a_run_that_explodes_or_a_ball_that_is_far_off_leaves_the_view_as_it_is(
    tmp_path, read_recording
):
    """Or the balls of the other runs would be dots."""
    scene = contact.build_scene("pile", bodies=4)
    calm = contact.run_model("lcp", scene, 0.002, 400)
    far = calm._replace(q=calm.q + 1e4 * (np.arange(401) > 300)[:, None, None])
    made = []
    for runs in (
        {"lcp": calm},
        {"lcp": calm, "penalty": contact.run_model("penalty", scene, 0.05, 400)},
        {"lcp": far},
    ):
        contact.log_rerun(tmp_path / "a.rrd", runs, scene)
        made.append(views(read_recording(tmp_path / "a.rrd"))[0])
    alone, beside, off = made
    assert alone == beside
    assert np.ptp(off[0]) <= 2 * 155 * 0.1, "at most 150 radii to each side, and a margin"


def test_a_rest_that_is_a_hundredth_of_a_radius_deep_is_several_points_of_the_magnified_view(
    tmp_path, read_recording
):
    """The view is about 140 points high; the line of the table is 1.2 points thick."""
    scene, runs = runs_of("drop")
    contact.log_rerun(tmp_path / "drop.rrd", runs, scene)
    recording = read_recording(tmp_path / "drop.rrd")
    (left, right), (top, bottom) = views(recording)[-1]
    assert left < 0.0 < right and top < 0.0 < bottom
    sunk = 1.0 * 9.81 / 1e4  # m g / k
    assert 140 * sunk / (bottom - top) > 5 * 1.2
    assert bottom > 3 * sunk, "also below a stack of three"


@pytest.mark.parametrize("name", ["drop", "bounce", "stack"])
def test_one_plot_has_the_legend_and_it_hides_no_curve_there(name, tmp_path, read_recording):
    """A legend in every plot hid a quarter of each."""
    scene, runs = runs_of(name)
    contact.log_rerun(tmp_path / "a.rrd", runs, scene)
    recording = read_recording(tmp_path / "a.rrd")
    shown, titles = {}, {}
    for entity, row in recording.blueprint:
        view = entity.split("/")[2] if entity.startswith("/view/") else None
        for visible in row.get("PlotLegend:visible", []):
            shown[view] = visible
            assert row["PlotLegend:corner"] == [rr.blueprint.Corner2D.RightTop.value]
        for title in row.get("ViewBlueprint:display_name", []):
            titles[view] = title
    (legend,) = [titles[view] for view in shown if shown[view]]
    assert len(shown) == len(CURVES)
    curves = contact.curves(runs, scene)
    lines = np.array(list(curves[legend].values()))
    late = lines[:, int(0.6 * STEPS) :]
    assert late.max() <= lines.min() + 0.55 * np.ptp(lines), "the upper right is empty"


def test_an_exploded_ball_is_said_so_in_the_name_of_its_view(tmp_path, read_recording):
    scene = contact.build_scene("drop")
    runs = {model: contact.run_model(model, scene, 0.03, 200) for model in ("penalty", "lcp")}
    contact.log_rerun(tmp_path / "burst.rrd", runs, scene)
    names = sum(blueprint_facts(read_recording(tmp_path / "burst.rrd"))[
        "ViewBlueprint:display_name"], [])  # fmt: skip
    step = contact.contact_quality(runs["penalty"], scene, 0.03)["blew_up_step"]
    assert f"penalty: EXPLODED at step {step}" in names and "lcp" in names


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
    (alone,) = recording.static["/height/lcp"]["SeriesLines:widths"]
    assert alone < 2.0, "nothing lies beneath that must be seen"
    moving = {"/world/lcp/balls", "/world/lcp/pushes"}
    assert set(recording.series) == {*moving, *(f"/{curve}/lcp" for curve in CURVES)}


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
    with pytest.raises(ValueError):
        contact.log_rerun(path, {"lcp": broken}, scene)
    assert path.read_bytes() == b"old" and [file.name for file in tmp_path.iterdir()] == [path.name]


PIN = "0.26.2"  # what the course pins


@pytest.mark.skipif(rr.__version__ != PIN, reason=f"rerun-sdk {PIN}, the course's pin, is not here")
def test_the_courses_pin_of_rerun_records_the_same_values(tmp_path):
    """Its time panel has no play_state, on which the first edition ended in a TypeError."""
    import rerun.dataframe

    scene, runs = runs_of("stack")
    contact.log_rerun(tmp_path / "pin.rrd", runs, scene)
    recording = rerun.dataframe.load_recording(str(tmp_path / "pin.rrd"))
    for model, run in runs.items():
        view = recording.view(index="step", contents=f"/penetration/{model}")
        rows = view.select("/penetration/" + model + ":Scalars:scalars").read_all().column(0)
        depth = contact.max_penetration(run.q, scene.radius) / scene.radius[0]
        assert [value[0] for value in rows.to_pylist()] == depth.tolist()


@pytest.mark.parametrize("known", [True, False])
def test_a_time_panel_without_play_state_is_no_error(known):
    """What rerun-sdk 0.26.2 does, played here where it is not installed."""
    from types import SimpleNamespace

    from curriculum.common import recording

    def panel(**given):
        if "play_state" in given and not known:
            raise TypeError("unexpected keyword argument 'play_state'")
        return given

    made = recording.time_panel(SimpleNamespace(TimePanel=panel))
    assert made["timeline"] == "sim_time" and ("play_state" in made) == known
