"""What contact.py reaches for: the recording, the picture, many seeds, what to do next."""

import json
import math
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from collections import defaultdict
from xml.etree import ElementTree

import numpy as np
import pytest

import contact
from curriculum import parallel, seeds
from curriculum.show import picture
from curriculum.tests.helpers import ROOT, clone, stopped

DT, STEPS = 0.004, 300
MASS, RADIUS = np.array([2.0, 1.3, 0.5]), np.array([0.12, 0.09, 0.08])  # from the lowest ball up
CURVES = ("height", "gap", "force", "energy", "rises")


def runs_of(scene, steps=STEPS, dt=DT, models=contact.MODELS):
    """The scene, its runs {model: Run} and their qualities {model: {key: value}}."""
    runs = {model: contact.run_model(model, scene, dt, steps) for model in models}
    return scene, runs, {m: contact.contact_quality(run, scene, dt) for m, run in runs.items()}


def recorded(folder, scene, runs, quality):
    """What a recording holds, {entity: {column: [value, ...]}}; its views are one entity."""
    chunk = pytest.importorskip("rerun.chunk", reason="this rerun cannot read recordings")
    recording = pytest.importorskip("curriculum.show.recording", reason="rerun is not installed")
    recording.write(str(folder / "contact.rrd"), runs, scene, quality, "a title")
    assert [path.name for path in folder.iterdir()] == ["contact.rrd"], "nothing else is left"
    reader, found = chunk.RrdReader(str(folder / "contact.rrd")), defaultdict(dict)
    (main,) = reader.recordings()
    for store in (main, *reader.blueprints()):
        for part in reader.stream(store=store):
            batch, name = part.to_record_batch(), part.entity_path if store is main else "views"
            for column, values in zip(batch.schema.names, batch.columns):
                values = values.cast("int64") if "[ns" in str(values.type) else values
                found[name].setdefault(column, []).extend(values.to_pylist())
    return found


@pytest.fixture(scope="module")
def stack(tmp_path_factory):
    """The recording of a stack of three unequal balls, and its runs."""
    made = runs_of(contact.scene_of([0.0] * 3, [0.131, 0.36, 0.55], MASS, RADIUS))
    return recorded(tmp_path_factory.mktemp("stack"), *made), made[1]


def expected_of(run, model):
    """What a recording of the stack must hold of a run: {entity: {column: values}}."""
    total = (MASS * (0.5 * (run.v**2).sum(1) + 9.81 * run.q[:, 1])).sum(-1)
    pushed = np.diff(run.v[:, 1], axis=0, prepend=np.nan) / DT + 9.81  # by contacts, upwards [N/kg]
    pushed[0] = 0.0
    weights = pushed / 9.81  # at rest it is 1, and the arrow a radius long
    arrow = RADIUS * np.log2(1.0 + np.abs(weights)) * np.sign(weights)
    color = int(picture.COLORS[model][1:] + "ff", 16)
    at = np.stack((run.q[:, 0], -run.q[:, 1]), -1).astype(np.float32)  # y is down in 2-D views
    curves = {
        "height": run.q[:, 1].mean(-1),
        "gap": contact.smallest_gap(run.q, RADIUS) / RADIUS.min(),
        "force": (MASS * pushed).sum(1),  # pushes between balls cancel: the floor's
        "energy": total - total[0],
        "rises": np.cumsum([0.0, *np.maximum(0.0, np.diff(total))]),
    }
    look = {"Points2D:radii": [RADIUS.astype(np.float32)], "Points2D:colors": [[color] * 3]}
    pushes = {"Arrows2D:origins": at, "Arrows2D:vectors": np.stack((0.0 * arrow, -arrow), -1)}
    peaks = pytest.importorskip("rerun").components.AggregationPolicy.MinMax.value
    line = {"SeriesLines:colors": [[color]], "SeriesLines:aggregation_policy": [[peaks]]}
    rows = {f"/{key}/{model}": {"Scalars:scalars": y[:, None]} | line for key, y in curves.items()}
    balls = {"Points2D:positions": at, **look}
    return rows | {f"/world/{model}/balls": balls, f"/world/{model}/pushes": pushes}


def test_a_recording_has_every_models_balls_pushes_and_curves_a_row_a_step(stack):
    recording, runs = stack
    found = {f"/world/{model}/table" for model in runs} | {"/about", "/__properties", "views"}
    for model, run in runs.items():
        for entity, columns in expected_of(run, model).items():
            found.add(entity)
            assert recording[entity]["step"] == list(range(STEPS + 1))
            assert recording[entity]["sim_time"] == [4_000_000 * k for k in range(STEPS + 1)]  # ns
            for name, values in columns.items():
                bound = {"Scalars:scalars": 1e-9, "Arrows2D:vectors": 1e-5}.get(name, 0.0)
                close = np.allclose(recording[entity][name], values, rtol=bound, atol=bound)
                assert close, (entity, name)
        assert recording[f"/height/{model}"]["SeriesLines:names"] == [[model]]
    assert set(recording) == found and runs.keys() == contact.MODELS.keys()
    assert "a title" in recording["/about"]["TextDocument:text"][0][0]


def test_it_opens_slowed_down_on_the_landing_and_plots_end_where_all_rest(stack):
    recording, runs = stack
    fall = np.sqrt(2.0 * (0.131 - RADIUS[0]) / 9.81)  # s, of a ball that starts at rest
    landing = recording["/world/lcp/balls"]["landing"]
    first = landing[0] / 1e9  # where a viewer's cursor starts
    assert 0.0 < first - fall < 2 * DT
    assert landing == [max(t, landing[0]) for t in recording["/world/lcp/balls"]["sim_time"]]
    panel = {key[19:]: each for key, each in recording["views"].items() if "TimePanel" in key}
    assert (panel["playback_speed"], panel["timeline"]) == ([[0.25]], [["landing"]])
    (ranges,) = {str(each) for each in recording["views"]["VisibleTimeRanges:ranges"]}
    start, *_, end = sorted({int(n) / 1e9 for n in re.findall(r"\d{8,}", ranges)})
    ways = [np.abs(np.diff(run.q, axis=0)).max((1, 2)) for run in runs.values()]
    moves = DT * max(np.flatnonzero(way >= 0.01 * DT)[-1] for way in ways)
    assert fall < first < start < moves and abs(end - 1.1 * moves) < 2 * DT


def test_views_say_how_a_run_ended_show_the_table_magnified_and_no_explosion_widens_one(tmp_path):
    drop = runs_of(contact.build_scene("drop"), 200, 0.064, ("penalty", "lcp", "exact"))
    views = recorded(tmp_path, *drop)["views"]
    origins = [origin.strip("/") for (origin,) in filter(None, views["ViewBlueprint:space_origin"])]
    worlds = [f"world/{model}" for model in drop[1]] * 2
    assert sorted(origins) == sorted((*worlds, *CURVES, "about"))
    names = {name for (name,) in filter(None, views["ViewBlueprint:display_name"])}
    exploded = f"penalty: EXPLODED at step {drop[2]['penalty']['blew_up_step']}"
    assert {exploded, "lcp: through the floor", "exact: rests", "0.16 r"} < names
    bounds = [view[0] for view in views["VisualBounds2D:range"]]
    ranges = sorted((*view["y_range"], *view["x_range"]) for view in bounds)
    high, low, left, right = ranges[0]
    assert -2.0 < high < -1.12 and low > 0.0 and left < -0.1 and right > 0.1  # it starts at 1 m
    assert np.ptp(ranges[-1][:2]) < 0.02
    light = runs_of(contact.scene_of(0.0, 1.0, mass=1e-300), 300, 1e3, ["penalty"])
    assert not np.isfinite(light[1]["penalty"].q).all(), "what overflows is recorded, too"
    assert len(recorded(tmp_path, *light)["/height/penalty"]["step"]) == 301


def test_the_recording_of_the_slide_goes_with_the_ball_and_of_many_balls_arrows_are_left_out(
    tmp_path,
):
    scene, runs, quality = runs_of(contact.build_scene("slide"), 300, models=("soft", "exact"))
    recording = recorded(tmp_path, scene, runs, quality)
    (hill, ball), (large, small) = runs["soft"].q.transpose(2, 0, 1), scene.radius
    foot = np.array(recording["/world/soft/foot"]["Transform3D:translation"], float)[:, 0]
    foot = foot[:, :2] * [1.0, -1.0]
    assert np.hypot(*(foot - ball).T) == pytest.approx(small, abs=1e-5)
    assert np.abs(np.hypot(*(foot - hill).T) - large).max() < 0.02 * small, "and on the hill"
    views = [each[0] for each in recording["views"]["VisualBounds2D:range"]]
    assert max(np.ptp(view["y_range"]) for view in views) < 20 * small, "the ball is seen"
    assert recording["/world/soft/balls"]["Points2D:colors"][0][0] != int("cc79a7ff", 16)
    pile = recorded(tmp_path, *runs_of(contact.build_scene("pile", bodies=40), 20, DT, ["lcp"]))
    assert "/world/lcp/balls" in pile and "/world/lcp/pushes" not in pile


def test_a_picture_is_the_same_bytes_twice_and_draws_every_curve_of_every_model(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    scene, runs, quality = runs_of(contact.build_scene("bounce"))
    for name in ("a.svg", "b.svg"):
        picture.write(str(tmp_path / name), runs, scene, quality, "a title")
    content = (tmp_path / "a.svg").read_text("utf-8")
    assert content == (tmp_path / "b.svg").read_text("utf-8")
    texts = {each.text for each in ElementTree.fromstring(content).iter() if each.text}
    assert {"a title", *contact.MODELS, *picture.curves(runs, scene)} <= texts
    looks = [re.findall(rf'd="M[^"]+"[^>]*style="([^"]*stroke: {picture.COLORS[model]}[^"]*)"',
                        content) for model in contact.MODELS]  # fmt: skip
    assert [len(each) for each in looks] == [len(CURVES) + 1] * len(looks), "and in the legend"
    grey = {re.sub("#[0-9a-f]+|stroke-width: [^;]+", "", each[0]) for each in looks}
    assert len(grey) == len(looks), "without colour the dashes differ"


def test_a_scene_of_ones_own_is_reported_recorded_and_drawn_by_one_call(tmp_path, capsys):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    pytest.importorskip("rerun", reason="rerun is not installed")
    masses, radii = [1, 5, 0.2], [0.1, 0.1, 0.05]
    scene = contact.scene_of([0, 0.05, 0.4], [0.1, 0.35, 0.6], masses, radii, [0, 0, -1], name="me")
    metrics = contact.report_scene(scene, steps=300, out=tmp_path, picture=True)
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == ["contact.rrd", "contact.svg", "metrics.json"]
    assert metrics == json.loads((tmp_path / "metrics.json").read_text("utf-8"))
    assert metrics["quality"].keys() == contact.MODELS.keys() and not metrics["stability"]
    assert capsys.readouterr().out.startswith("scene me: 300 steps of 0.002 s\n")
    contact.report_scene(scene, dt=0.1, steps=20, models=["penalty"])
    cure = re.search("try: (.*)", capsys.readouterr().out)[1]
    assert "EXPLODED" not in repr(eval(f"contact.report_scene(scene, **dict({cure}))"))


@pytest.mark.parametrize("wrong", [{"settings": {"iters": 3}}, {"scene": "drop"}])
def test_what_is_no_scene_or_no_settings_is_answered_in_words(wrong):
    (name, given), *_ = wrong.items()
    right = {"scene": contact.build_scene("drop"), "settings": contact.Settings()}
    words = f"{name} must be a contact.{name.title()}, given {given!r}"
    with pytest.raises(ValueError, match=re.escape(words)):
        contact.run_model("lcp", dt=0.002, steps=5, **right | wrong)


@pytest.mark.parametrize("model, scene, dt, steps, low, high", [
    ("lcp", "slide", 0.002, 2000, 0.0, 1e-4), ("leapfrog", "slide", 0.002, 2000, 0.0, 1e-4),
    ("penalty", "slide", 0.002, 2000, 0.0, 1e-4), ("penalty", "stack", 0.006, 2000, 1.0, 9.0),
    ("lcp", "drop", 0.002, 100, 0.0, 1e-12),
])  # fmt: skip
def test_force_is_right_unless_it_trembles_and_in_flight(model, scene, dt, steps, low, high):
    """That of soft flickers: README's symptoms have its values."""
    scene = contact.build_scene(scene, seed=3)
    run, exact = (contact.run_model(each, scene, dt, steps) for each in (model, "exact"))
    assert low <= contact.contact_quality(run, scene, dt, exact)["force_error"] <= high
    assert contact.contact_quality(run, scene, dt)["force_error"] is None


@pytest.mark.parametrize("flags", [
    "--scene drop", "--scene bounce --dt 0.004", "--solimp 0.5 0.9 0.002 0.4 3",
    "--solref -5000 -100", "--scene drop --restitution 0.5",
])  # fmt: skip
def test_what_soft_prints_for_mujoco_is_what_it_ran_with(flags, tmp_path, capsys):
    """With the same knobs MuJoCo makes the same run: test_soft_is_mujoco."""
    argv = *flags.split(), "--contact", "soft", "--no-rerun", "--out", str(tmp_path)
    assert contact.main(argv) == 0
    line = re.search(r"^in MJCF: (<option .*/>), (<geom .*/>)$", capsys.readouterr().out, re.M)
    option, geom = (ElementTree.fromstring(each).attrib for each in line.groups())
    scene, dt, _, _, settings = contact.asked_for(contact.parse_flags(argv), 0)
    knobs = contact.soft_defaults(scene.restitution, dt, settings.solref, settings.solimp)
    found = [tuple(map(float, geom[name].split())) for name in ("solref", "solimp")]
    assert float(option["timestep"]) == dt and found == [*knobs]


FIVE = "0:5", "--contact", "lcp", "--steps", "300", "--out"


def summed_up(out, *words):
    """The bytes of seeds.json that FIVE, or other words, write into a folder."""
    assert seeds.main([*(words or FIVE[:1]), *FIVE[1:], str(out)]) == 0
    return (out / "seeds.json").read_bytes()


def test_seeds_give_median_and_range_also_in_parts_with_cut_rows_and_others_between(tmp_path):
    whole = summed_up(tmp_path / "whole")
    rows = json.loads(whole)["rows"]["lcp"]
    drops = (contact.build_scene("drop", seed) for seed in range(5))
    each = [runs_of(drop, dt=0.002, models=["lcp"])[2] for drop in drops]
    depths = [quality["lcp"]["max_penetration_frac"] for quality in each]
    for name, depth in zip(("lowest", "median", "highest"), sorted(depths)[::2]):
        assert abs(rows[name]["max_penetration_frac"] - depth) < 1e-12
        if name != "median":
            assert rows[name]["seeds"]["max_penetration_frac"] == depths.index(depth)
    for name, words in zip("abc", (["3:5"], ["0:2"], ["0:3", "--dt", "0.004"])):
        summed_up(tmp_path / name, *words)
    files = [(tmp_path / name / "seeds.csv").read_bytes() for name in "cab"]
    merged = tmp_path / "d/seeds.csv"
    merged.parent.mkdir()
    merged.write_bytes(b"".join((files[0], b"a note,yes\n", *files[1:]))[:-2])  # a row is cut short
    there = merged.read_bytes()
    assert summed_up(merged.parent) == whole
    more = merged.read_bytes().removeprefix(there).decode().split()
    assert [row.split(",")[1] for row in more] == ["1", "2"], (
        "what was there stays, the rest is run"
    )


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_night_of_seeds_that_is_stopped_keeps_its_rows_and_leaves_no_process(number, tmp_path):
    words = "-m", "curriculum.seeds", "0:5000", "--no-skip", "--out", tmp_path
    rows, terminal = tmp_path / "seeds.csv", number == signal.SIGINT
    status, _, err = stopped(
        number, words, lambda _: rows.exists() and rows.read_bytes().count(b"\n") > 1, terminal
    )
    assert (status, err) == ((130, "stopped\n") if terminal else (-number, ""))
    assert [path.name for path in tmp_path.iterdir()] == ["seeds.csv"]


def test_seeds_count_what_exploded_went_through_or_could_not_be_run():
    ends = "EXPLODED at step 7", "through a ball", "rests", "no: crushed; at once"
    rows = {seed: dict.fromkeys(seeds.KEYS, "1.0") | {"ending": ends[seed]} for seed in range(4)}
    rows[0][seeds.KEYS[0]], rows[2][seeds.KEYS[1]] = "inf", ""
    ways = seeds.summary(rows)
    words = "1 of 4 EXPLODED, 1 of 4 went through, 1 of 4 could not be run"
    assert {seeds.ending(row, 4) for row in ways.values()} == {words}
    first, second = ([row[key] for row in ways.values()] for key in seeds.KEYS[:2])
    assert first == [1.0, 1.0, math.inf] and second == [None] * 3, "not of all runs, so of none"


@pytest.mark.parametrize("words", [
    "3", "4:4", "5:2", "0:1.5", "0:1000000", "0:5 --seed 3", "0:5 --dt 0", "0:5 --dt=--",
])  # fmt: skip
def test_seeds_refuses_bad_input_in_one_line(words, tmp_path, capsys):
    with pytest.raises(SystemExit, match="2"):
        seeds.main([*words.split(), "--out", str(tmp_path)])
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "error: " in err and re.split("[ =]", words)[min(1, words.count(" "))] in err


def test_a_dask_cluster_gives_the_same_and_workers_with_no_or_other_code_are_named(
    tmp_path, capsys
):
    distributed = pytest.importorskip("dask.distributed", reason="dask is not installed")
    fast = clone(tmp_path / "other", "tests") / "curriculum/compiled/run.py"
    fast.write_text(f"{fast.read_text('utf-8')}\n\nMORE = 1\n", "utf-8")
    start = [sys.executable, "-m", "distributed.cli.dask_worker", "--no-dashboard", "--no-nanny"]
    how = {"stderr": subprocess.DEVNULL, "env": os.environ | {"PYTHONPATH": ""}}
    with distributed.LocalCluster(n_workers=0, dashboard_address=":0") as cluster:
        start += [cluster.scheduler_address, "--nthreads", "1"]
        words = "--scheduler", cluster.scheduler_address
        for folder, why in (".", "PYTHONPATH lacks"), ("other", "has other code"), (ROOT, ""):
            worker = subprocess.Popen(start, cwd=tmp_path / folder, **how)
            try:
                if why:
                    with pytest.raises(SystemExit, match="2"):
                        summed_up(tmp_path / "there", "0:5", *words)
                    assert why in capsys.readouterr().err
                else:
                    assert summed_up(tmp_path / "there", "0:5", *words) == summed_up(tmp_path)
            finally:
                worker.kill(), worker.wait()
            while cluster.scheduler.workers:
                time.sleep(0.01)


def killed_at_3(job):
    if job == 3 and multiprocessing.parent_process():
        os._exit(9)
    return -job


def test_work_is_spread_over_processes_in_order_and_a_killed_one_is_a_line(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    assert parallel.run_jobs(abs, range(-50, 0), "jobs") == list(range(50, 0, -1))
    with pytest.raises(OSError, match="a process of the pool is gone"):
        parallel.run_jobs(killed_at_3, range(50), "jobs")


def test_the_last_lines_are_commands_that_work_as_printed(tmp_path, capsys, monkeypatch):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    folder = tmp_path / "a folder"
    monkeypatch.chdir(ROOT)
    contact.main(["--steps", "10", "--no-rerun", "--out", str(folder)])
    lines = capsys.readouterr().out.splitlines()
    (see,) = [line for line in lines if line.startswith("next, see it: ")]
    subprocess.run(see.split(": ", 1)[1], shell=True, check=True, capture_output=True)
    assert (folder / "contact.svg").exists()
    assert sum(str(sys.executable) in line or ".venv" in line for line in lines) == 3
