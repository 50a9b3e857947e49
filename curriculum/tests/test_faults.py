"""The published chapter's faults 1 to 14, in its numbering: ours has none of them.

Number 15 is of the page, see test_page. Some have a whole file of tests, which is named.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import contact
from curriculum import terminal
from curriculum.bench import closed_form

ROOT = Path(__file__).resolve().parents[2]
DT = 0.002


def quality(name, model, dt=DT, steps=2000, **scene):
    made = contact.build_scene(name, **scene)
    return contact.contact_quality(contact.run_model(model, made, dt, steps), made, dt)


def test_1_the_recording_holds_curves_and_moving_balls(tmp_path, read_recording):
    """More in test_recording."""
    assert contact.main(["--steps", "300", "--out", str(tmp_path)]) == 0
    series = read_recording(tmp_path / "contact.rrd").series
    for model in contact.MODELS:
        spots = np.array(series[f"/world/{model}/balls"]["Points2D:positions"])
        assert np.ptp(spots[:, 0, 1]) > 0.8, f"the ball of {model} does not move"
        for curve in ("height", "penetration", "energy"):
            assert len(series[f"/{curve}/{model}"]["Scalars:scalars"]) == 301


def test_2_the_lcp_bounce_converges_at_first_order():
    """Median over nine heights of the worst error in 4 s: half the step, about half the error."""
    medians = []
    for dt in (0.008, 0.004, 0.002, 0.001, 0.0005):
        errors = []
        for seed in range(9):
            scene = contact.build_scene("bounce", seed)
            run = contact.run_model("lcp", scene, dt, round(4 / dt))
            truth = closed_form.ball_height(scene.q0[1, 0], 0.1, 0.7, run.t)
            errors.append(np.abs(run.q[:, 1, 0] - truth).max() / 0.1)
        medians.append(np.median(errors))
    order = np.polyfit(np.log([16, 8, 4, 2, 1]), np.log(medians), 1)[0]
    print(f"medians {np.round(medians, 4)}, order {order:.2f}")
    assert medians == sorted(medians, reverse=True) and 0.8 < order < 1.3
    assert medians[2] < 0.08, "published: 2.71"


@pytest.mark.parametrize(
    "v_n, bias, expected", [(-2.0, 1.0, 1.4), (-1.0, 1.0, 1.0), (-2.0, 0.0, 1.4), (2.0, 1.0, 1.0)]
)
def test_2_bounce_and_bias_velocity_are_never_added(v_n, bias, expected):
    """In an overlap of 0.01 m, e = 0.7: the larger of the two is the target."""
    ball = contact.Ball(0.0, 0.09, 0.0, v_n, 1.0, 0.1)
    c = contact.Contact(ball, contact.FLOOR, 0.0, 1.0, 0.01)
    got = contact.contact_target(c, 0.7, bias * DT / 0.01, DT)
    assert got == pytest.approx(expected)


def test_3_the_bias_velocity_that_pops_the_ball_off_the_table_is_reported():
    """With e = 0 it leaves with L = beta depth / dt, and a column says how high that carries it.

    That is L^2 / 2 g less the depth, 0.107 r, and at most L dt / 2 + g dt^2 / 8 more in such steps.
    """
    row = quality("drop", "lcp")
    depth = row["max_penetration_frac"] * 0.1
    leaving = 0.2 * depth / DT
    apex = leaving**2 / (2 * 9.81) - depth
    assert round(apex / 0.1, 3) == 0.107
    assert apex < row["rebound_frac"] * 0.1 < apex + leaving * DT / 2 + 9.81 * DT**2 / 8
    assert row["energy_excess"] == 0.0, "compared with the start it does not show"


def test_3_exact_does_not_pop():
    """No rebound, and no energy but the rounding of two sums at each of 2,000 samples."""
    row = quality("drop", "exact")
    assert row["rebound_frac"] == 0.0
    assert row["contact_energy"] <= 2000 * 4 * 2.0**-53


def test_4_no_seed_starts_a_stack_or_pile_inside_the_floor():
    for seed in range(100):
        for name, bodies in (("stack", 3), ("pile", 30)):
            scene = contact.build_scene(name, seed, bodies)
            assert contact.max_penetration(scene.q0, scene.radius) < 1e-15, f"{name}, seed {seed}"
    for seed in (2, 3):
        assert quality("stack", "lcp", seed=seed)["energy_excess"] < 1e-12, "published: 16, 50 %"


def test_5_gaining_1409_times_the_energy_is_not_ok(tmp_path, capsys):
    row = quality("drop", "penalty", dt=0.03)
    assert round(row["energy_excess"]) == 1409 and row["blew_up"] and row["blew_up_step"] > 0
    flags = ["--contact", "penalty", "--dt", "0.03", "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(flags) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("penalty")]
    assert f"EXPLODED at step {row['blew_up_step']}" in line and not line.endswith("ok")


def test_6_the_printed_critical_dt_knows_the_damper(tmp_path, capsys):
    """0.02 without it; with c = 80 0.01354, between 0.0135, which settles, and 0.0140, not."""
    assert contact.main(["--steps", "50", "--no-rerun", "--out", str(tmp_path)]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "critical dt" in line]
    assert "0.01354" in line and "0.02" in line
    stability = json.loads((tmp_path / "metrics.json").read_text())["stability"]
    assert 0.0135 < stability["dt_crit_damped"] < 0.0140


def test_7_importing_runs_nothing_so_that_the_solver_can_be_reused(tmp_path):
    """More in test_command_line and test_next_chapter."""
    run = subprocess.run(
        [sys.executable, "-c", "from contact import detect_contacts, solve_contacts"],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    assert os.listdir(tmp_path) == []


def test_8_the_damper_resists_closing_and_no_answer_stands_in_the_exercise():
    """v_n > 0 separates. Closing, the damper adds to the spring; parting, it takes away."""
    force = contact.penalty_normal_force
    assert force(0.01, -1.0, 1e4, 80.0) == 180.0
    assert force(0.01, 0.0, 1e4, 80.0) == 100.0
    assert force(0.01, 1.0, 1e4, 80.0) == 20.0
    assert force(0.01, 2.0, 1e4, 80.0) == 0.0
    text = re.sub(r"\s", "", (ROOT / "exercises" / "ex2_completion_contact.py").read_text())
    for answer in ("max(0", "max(lam", "stiffness*depth", "depth*stiffness", "lam+dlam", "k*depth"):
        assert answer not in text, f"{answer} stands in exercise 2"


def test_9_no_rerun_does_not_import_it_and_columns_are_whole(tmp_path, monkeypatch, capsys):
    code = "import sys, contact; contact.main(sys.argv[1:]); assert 'rerun' not in sys.modules"
    flags = ["--steps", "20", "--no-rerun", "--out", str(tmp_path)]
    subprocess.run([sys.executable, "-c", code, *flags], cwd=ROOT, check=True, capture_output=True)
    rr = pytest.importorskip("rerun", reason="rerun is not installed")
    calls, log = [], rr.RecordingStream.log
    monkeypatch.setattr(
        rr.RecordingStream, "log", lambda *a, **k: (calls.append(a), log(*a, **k))[1]
    )
    counts = []
    for steps in ("100", "300"):
        assert contact.main(["--steps", steps, "--out", str(tmp_path)]) == 0
        counts.append(len(calls))
        calls.clear()
    assert counts[0] == counts[1] > 0, "something is logged step by step"


def test_10_metrics_are_json_after_an_overflow(tmp_path, capsys):
    """More in test_command_line."""
    flags = ["--contact", "penalty", "--stiffness", "1e300", "--no-rerun", "--out", str(tmp_path)]
    assert contact.main(flags) == 0

    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    metrics = json.loads((tmp_path / "metrics.json").read_text(), parse_constant=refuse)
    assert metrics["quality"]["penalty"]["energy_excess"] is None


def test_11_every_region_has_its_hash_in_meta_yaml():
    """A hash removed, an unknown include, a false number each fail: test_drift tries them all."""
    text = (ROOT / "meta.yaml").read_text()
    names = re.findall(r"^# --- region: ([\w-]+) ---$", (ROOT / "contact.py").read_text(), re.M)
    assert {"setup", "scenes", "contacts", "penalty", "lcp", "simulate", "report"} <= set(names)
    for name in names:
        assert re.search(rf"^ +{name}: \W?[0-9a-f]{{64}}", text, re.M), f"no hash of {name}"


@pytest.mark.parametrize("model", contact.MODELS)
def test_12_balls_with_one_centre_part(model):
    """Two balls at one point, in the air and over the floor."""
    scene = contact.build_scene("stack", 0, 2)
    scene = scene._replace(q0=np.array(((0.0, 0.0), (0.5, 0.5))))
    run = contact.run_model(model, scene, DT, 1000)
    assert np.abs(run.q[-1, :, 0] - run.q[-1, :, 1]).max() > 0.19
    if model == "lcp":
        assert contact.max_penetration(run.q[-1], scene.radius) < 0.01 * 0.1


@pytest.mark.parametrize("swap, said", [({}, "yes"), ({"penalty": "lcp", "lcp": "penalty"}, "no")])
def test_13_the_verdict_claims_only_the_depths_it_tests(swap, said, capsys):
    rows = {
        model: quality("drop", swap.get(model, model), steps=800) for model in ("penalty", "lcp")
    }
    grid = dict.fromkeys(("penalty", "lcp", "soft", "dt_crit_penalty", "dt_crit_damped"), 0.01)
    grid |= dict.fromkeys(("penalty_penetration_frac", "lcp_penetration_frac"), 0.1)
    grid["soft_penetration_frac"] = 0.1
    terminal.print_report(SimpleNamespace(scene="drop", seed=0, steps=800, dt=DT), rows, grid)
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "verdict" in line]
    assert line.endswith(said) and "jitter" not in line and "sink" not in line


def test_14_where_lcp_is_called_stable_the_depth_stands_beside_it(tmp_path, capsys):
    assert contact.main(["--no-rerun", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    stability = json.loads((tmp_path / "metrics.json").read_text())["stability"]
    assert stability["lcp"] == 0.064 and round(stability["lcp_penetration_frac"], 1) == 2.2
    (line,) = [line for line in out.splitlines() if line.startswith("stability: lcp")]
    assert "0.064" in line and "2.2 r deep" in line
    assert round(quality("drop", "lcp", dt=0.04)["max_penetration_frac"], 1) == 1.3
