"""The benchmark measures what it says, prints only what its data bear out, and asserts no time."""

import json
import math
import re
import sys

import numpy as np
import pytest

import contact
from curriculum.bench import (accuracy, accuracy_page, closed_form, methods, peers, piles, problems,
                              readme, report, skips, store, timing)
from curriculum.bench.__main__ import PAGES, main, pages, pictures

PEERS = [pytest.param(p, id=p.name, marks=pytest.mark.skipif(
    p.version() is None, reason=f"{p.label} is not installed: pip install {p.package}"))
    for p in peers.PEERS]
BOUNCE, DROP = (next(p for p in problems.PROBLEMS if p.name == name) for name in ("bounce", "drop"))


def closed_form_run(problem, scene, dt):
    """A Run made of the closed form alone, velocities by its own parabolas' differences."""
    t = np.arange(problem.steps(dt) + 1) * dt
    y, ahead = problem.reference(scene, t), problem.reference(scene, t + 1e-7)
    return contact.Run(t, np.stack((0 * y, y), 1), np.stack((0 * y, (ahead - y) / 1e-7), 1))


@pytest.fixture(scope="module")
def sections():
    """A tiny real measurement of our own models, as it would be read back from results.json."""
    ours = tuple(m for m in methods.METHODS if m.name in methods.OURS)
    gone = methods.BY_NAME["pymunk"]._replace(missing="not installed: pip install pymunk")
    settings = accuracy.Settings(
        problems=tuple(p._replace(duration=2.4) for p in (DROP, BOUNCE)), methods=(*ours, gone),
        dts=(0.002, 0.004, 0.016), seeds=(0, 1), rounds=2)
    error = dict(quick=True, machine=store.machine(), **accuracy.run(settings))
    return {"error": json.loads(store.text(error))}


# what is measured

def test_closed_form_itself_has_no_error_and_the_material_s_restitution():
    scene = BOUNCE.build(3)
    told = problems.quality(BOUNCE, scene, 0.002, closed_form_run(BOUNCE, scene, 0.002))
    assert told["height_error"] == 0.0
    assert told["restitution"] == pytest.approx(0.7, abs=1e-4)
    assert told["impact_time_error"] < 1e-6
    assert told["blew_up_step"] is None and told["blew_up_reason"] is None


@pytest.mark.parametrize("problem", problems.PROBLEMS, ids=lambda p: p.name)
@pytest.mark.parametrize("dt", [0.0005, 0.032])
def test_exact_meets_the_closed_form_within_1e_10_r_and_times_the_impact(problem, dt):
    scene = problem.build(1)
    told = problems.quality(problem, scene, dt, contact.run_model("exact", scene, dt, problem.steps(dt)))
    assert told["height_error"] < 1e-10
    assert told["impact_time_error"] < 1e-10


def test_height_error_is_in_radii_and_the_worst_of_the_run():
    scene = DROP.build(0)
    run = closed_form_run(DROP, scene, 0.002)
    run.q[700, 1, 0] += 0.03
    assert problems.quality(DROP, scene, 0.002, run)["height_error"] == pytest.approx(0.3)


def test_semi_implicit_flight_shows_its_lag_of_half_g_t_dt():
    scene = DROP.build(0)
    run = contact.run_model("lcp", scene, 0.002, 200)          # still falling at the end
    told = problems.quality(DROP, scene, 0.002, run)
    assert told["height_error"] == pytest.approx(closed_form.flight_lag(0.4, 0.002) / 0.1, rel=1e-9)


def test_divergence_is_a_value_with_step_and_reason():
    scene = DROP.build(0)
    run = contact.run_model("penalty", scene, 0.032, DROP.steps(0.032))
    told = problems.quality(DROP, scene, 0.032, run)
    assert isinstance(told["blew_up_step"], int)
    assert told["blew_up_reason"] in ("energy above 10 x the start", "not finite")


def test_order_of_a_first_order_method_is_fitted_as_one():
    made = [dict(problem="p", method="m", dt=dt, diverged=None, height_error=dict(median=3.0 * dt))
            for dt in problems.DTS]
    assert accuracy.fit("p", "m", made)["order"] == pytest.approx(1.0)
    rounding = [{**p, "height_error": dict(median=1e-15)} for p in made]
    assert accuracy.fit("p", "m", rounding)["order"] is None


def test_pile_gives_the_same_bits_over_all_pairs_and_over_near_ones():
    scene = contact.build_scene("pile", 0, 60)
    near, every = piles.Pile(scene, 0.002), piles.Pile(scene, 0.002, all_pairs=True)
    near.advance(150)
    every.advance(150)
    for a, b in zip(near.state(), every.state()):
        assert a.tobytes() == b.tobytes()


def test_skipping_changes_no_byte_in_the_short_form():
    """The long form is `python -m curriculum.bench skip`; this is the part that CI keeps."""
    told = skips.same_bytes(quick=True)
    assert told["runs"] > 50 and told["command_lines"] == 3
    assert told["differing"] == []


# how it is timed

def test_rounds_are_interleaved_and_preparation_is_not_timed():
    seen = []

    def task(name):
        def prepare():
            seen.append(f"prepare {name}")
            return lambda: seen.append(name)
        return prepare

    seconds = timing.interleave({"a": task("a"), "b": task("b")}, 2, 60.0)
    assert seen == ["prepare a", "a", "prepare b", "b"] * 2
    assert [len(values) for values in seconds.values()] == [2, 2]


def test_a_task_over_its_budget_sits_out_but_never_the_first_round():
    assert len(timing.interleave({"a": lambda: lambda: None}, 5, -1.0)["a"]) == 1


def test_whole_process_reports_time_and_memory_and_a_failure():
    seconds, memory = timing.whole_process([sys.executable, "-c", "b = bytearray(50_000_000)"], ".")
    assert seconds > 0 and 50e6 < memory < 500e6
    with pytest.raises(RuntimeError, match="(?s)fails.*ValueError: so it goes"):
        timing.whole_process([sys.executable, "-c", "raise ValueError('so it goes')"], ".")


# the peers

@pytest.mark.parametrize("peer", PEERS)
@pytest.mark.parametrize("scene", [contact.build_scene("drop", 2), contact.build_scene("bounce", 2),
                                   contact.build_scene("stack", 2)], ids=lambda s: s.name)
def test_peer_runs_the_same_scene_and_reading_changes_nothing(peer, scene):
    reading, stepping = peer.build(scene, 0.002), peer.build(scene, 0.002)
    q, v = reading.state()
    assert q == pytest.approx(scene.q0, abs=1e-6) and (v == 0).all()
    rows = np.array(reading.trace(300))
    assert rows.shape == (301, len(scene.mass))
    stepping.advance(300)
    assert stepping.state()[0][1] == pytest.approx(rows[-1], abs=2e-6)
    told = methods.BY_NAME[peer.name].record(scene, 0.002, 300)
    assert told.q[:, 1] == pytest.approx(rows, abs=2e-6)
    reference = contact.run_model("exact", scene, 0.002, 300)
    assert np.abs(told.q[:, 1] - reference.q[:, 1]).max() < 0.05      # half a radius: the same motion
    assert np.abs(told.q[:, 0] - scene.q0[0]).max() < 1e-3            # and straight down


def test_damping_ratio_for_a_rebound_gives_that_rebound():
    """A spring and damper stepped finely, cut off where it would pull."""
    ratio = peers.rebound_ratio(0.7)
    x, v, dt = 0.0, -1.0, 1e-5
    while True:
        force = -x - 2.0 * ratio * v
        if x > -1e-12 and v > 0 or force < 0:
            break
        v += dt * force
        x += dt * v
    assert v == pytest.approx(0.7, abs=2e-3)


def test_a_missing_peer_is_a_row_that_says_so(sections):
    page = pages(sections)["error.md"]
    assert "| pymunk | not installed: pip install pymunk |" in page


# what is printed

def test_page_shows_divergence_with_step_and_reason(sections):
    page = pages(sections)["error.md"]
    assert re.search(r"\| penalty \|.*diverged, step \d+ \|", page)
    assert "Diverged: penalty at 16 ms" in page


def test_a_sentence_whose_condition_fails_is_not_printed_as_true(sections):
    said = " ".join(map(str, accuracy_page.claims(sections["error"], "bounce")))
    assert "exact is off by rounding alone" in said and "Smaller steps do not help penalty" in said
    changed = json.loads(json.dumps(sections["error"]))
    for point in changed["points"]:
        if point["method"] == "exact":
            point["height_error"]["median"] = 0.5
        if point["method"] == "penalty" and point["dt"] == 0.002:
            point["height_error"]["median"] = 1e-3
    said = " ".join(map(str, accuracy_page.claims(changed, "bounce")))
    assert "rounding alone" not in said and "do not help" not in said
    assert "exact is off by up to 0.500 r" in said


def test_a_goal_that_is_missed_says_missed():
    assert report.Goal("x at most 1", "2", False).verdict() == "**missed**"
    assert report.Goal("x at most 1", "1", True).verdict() == "met"
    assert report.Goal("x at most 1", "no peer", None).verdict() == "not measured"


def test_numbers_keep_three_digits_and_no_clumsy_exponents():
    shown = {0.25: "0.250", 1.5: "1.50", 123.4: "123", 9.996: "10.0", 4.44e-15: "4.44e-15", 0: "0",
             None: "-", 1409.4: "1409", 2.5e7: "2.50e7", math.inf: "inf"}
    assert {value: report.number(value) for value in shown} == shown


def test_results_are_strict_json_with_six_digits_and_null_for_what_is_not_finite(tmp_path):
    value = {"b": {"deep": [{"x": [1.23456789, math.nan]}]}, "a": math.inf}
    read = json.loads(store.text(value), parse_constant=pytest.fail)
    assert read == {"b": {"deep": [{"x": [1.23457, None]}]}, "a": None}
    store.save(tmp_path, "error", {"x": 1})
    assert store.save(tmp_path, "skip", {"y": 2})["error"]["x"] == 1


def test_footer_names_machine_versions_and_commit(sections):
    said = store.footer(sections["error"])
    assert f"Python {sys.version.split()[0]}" in said and f"numpy {np.__version__}" in said
    assert "cores of" in said and ("commit" in said)


def test_figures_are_the_same_bytes_for_the_same_results(sections):
    pytest.importorskip("matplotlib", reason="figures need matplotlib: pip install -e '.[bench]'")
    made, again = pictures(sections), pictures(sections)
    assert made == again
    picture = made["error-drop.svg"]
    assert picture.startswith("<?xml") and "<dc:date>" not in picture


def test_lines_are_told_apart_without_colour():
    for names in ([m.name for m in methods.METHODS],):
        looks = [(methods.BY_NAME[name].marker, str(methods.BY_NAME[name].dash)) for name in names]
        assert len(set(marker for marker, _ in looks)) == len(looks)


# the README's blocks and the committed results

TEXT = "# x\n<!-- generated: {} by {} -->\nold\n<!-- end -->\nlast\n"


def test_readme_block_is_filled_and_others_are_left_alone(sections):
    new = readme.fill(TEXT.format("bench-headline", readme.COMMAND), sections)
    assert "old" not in new and "| exact |" in new and new.endswith("<!-- end -->\nlast\n")
    assert readme.fill(new, sections) == new
    other = TEXT.format("tree", "python -m something.else")
    assert readme.fill(other, sections) == other


def test_readme_block_not_measured_yet_names_its_command():
    new = readme.fill(TEXT.format("bench-pile", readme.COMMAND), {})
    assert "Not measured yet: `python -m curriculum.bench pile`." in new


def test_readme_block_with_an_unknown_name_fails_with_its_line():
    with pytest.raises(ValueError, match=r"README.md:2: no generated block 'bench-nothing'"):
        readme.fill(TEXT.format("bench-nothing", readme.COMMAND), {})


def test_stale_readme_fails_the_check_and_names_the_repair(sections, tmp_path, monkeypatch, capsys):
    (tmp_path / store.NAME).write_text(store.text(sections))
    monkeypatch.setattr(readme, "README", tmp_path / "README.md")
    (tmp_path / "README.md").write_text(TEXT.format("bench-headline", readme.COMMAND))
    assert main(["readme", "--check", "--out", str(tmp_path)]) == 1
    assert "README.md:3:" in (said := capsys.readouterr().err) and readme.COMMAND in said
    assert main(["readme", "--out", str(tmp_path)]) == 0
    assert main(["readme", "--check", "--out", str(tmp_path)]) == 0


@pytest.mark.skipif(not readme.README.exists(), reason="there is no README.md yet")
def test_readme_is_up_to_date():
    assert readme.main(store.RESULTS, check=True) == 0, f"to repair: {readme.COMMAND}"


@pytest.mark.skipif(not (store.RESULTS / store.NAME).exists(),
                    reason="the full benchmark has not been run yet")
def test_committed_pages_are_those_of_the_committed_results():
    for name, section in store.load(store.RESULTS).items():
        assert not section["quick"], f"{name}: a quick run was kept"
        written = (store.RESULTS / f"{name}.md").read_text(encoding="utf-8")
        assert written == PAGES[name].page(section), "to repair: python -m curriculum.bench draw"


# the command line

@pytest.mark.parametrize("flags", [["everything"], ["--chekc"], ["skip", "--check"],
                                   ["draw", "--out", "/dev/null/x"]])
def test_bad_flags_are_one_line_and_status_2(flags, capsys):
    with pytest.raises(SystemExit) as stop:
        main(flags)
    assert stop.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_draw_without_results_says_what_to_run(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["draw", "--out", str(tmp_path)])
    assert stop.value.code == 2
    assert "run python -m curriculum.bench" in capsys.readouterr().err
