"""The stress test sees every fault that is put in, sees none where there is none, and counts."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import contact
from curriculum.stress import __main__ as command
from curriculum.stress import extremes, jobs, maps, scenes
from curriculum.stress.claims import PROPERTIES
from curriculum.stress.trial import Trial

ROOT = Path(__file__).resolve().parents[2]
HALF = "(1.0 if c.b is FLOOR else 0.5)"  # of pairs of balls
FORCE = "f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)"
BIAS, BACK = "bias = baumgarte / dt * c.depth", "back = -restitution * c.v_n()"
SPRING, TARGET = "        timeconst, dampratio = solref\n        K", "target = -self.e * v_n"
GRAVITY = "GRAVITY = -9.81 "
FAULTS = {  # what is wrong: (what stands in contact.py or exact.py, what is put in its place)
    "penalty pulls between balls":
        (FORCE, f"{FORCE} if c.b is FLOOR else stiffness * c.depth - damping * c.v_n()"),
    "the stiffness of pairs is halved": (FORCE, FORCE.replace("stiffness", f"stiffness * {HALF}")),
    "the damping of pairs is halved": (FORCE, FORCE.replace("damping", f"damping * {HALF}")),
    "the Baumgarte gain of pairs is halved": (BIAS, BIAS.replace("baum", f"{HALF} * baum")),
    "pairs have no Baumgarte gain":
        (BIAS, BIAS.replace("baum", "(1.0 if c.b is FLOOR else 0.0) * baum")),
    "the time constant of soft is 10 % longer for pairs":
        (SPRING, SPRING.replace("solref", "(1.0 if c.b is FLOOR else 1.1) * solref[0], solref[1]")),
    "exact bounces with 0.9 e": (BACK, BACK.replace("-rest", "-0.9 * rest")),
    "exact bounces pairs with half of e": (BACK, BACK.replace("-rest", f"-{HALF} * rest")),
    "exact loses a thousandth of v at an event":
        ("a[k]), speed(span, ball.vy, a[k])", "a[k]), 0.999 * speed(span, ball.vy, a[k])"),
    "the reaction is short by 1e-9":
        ("b.vx -= impulse * self.bx", "b.vx -= (1.0 - 1e-9) * impulse * self.bx"),
    "gravity is short by a thousandth": (GRAVITY, f"{GRAVITY} * 0.999 "),
    "of three contacts the third is missed":
        ("depth))\n    return contacts", "depth))\n    return contacts[:2] + contacts[3:]"),
    "exact.py bounces with 0.9 e": (TARGET, TARGET.replace("-self", "-0.9 * self")),
    "exact.py bounces pairs with half of e":
        (TARGET, f"{TARGET} * np.where(contacts.floor, 1.0, 0.5)"),
    "exact.py loses a thousandth of v at an event":
        ("evaluate(rate(Q), span), now", "0.999 * evaluate(rate(Q), span), now"),
}  # fmt: skip


def judge_a_copy(folder, count, old, new):
    """The stress test of so many small scenes on a copy of the code with one place of it replaced.

    Without the compiled twin, which has the right lines still.
    """
    leave = shutil.ignore_patterns("results", "__pycache__")
    for room in ("curriculum/stress", "curriculum/run"):
        shutil.copytree(ROOT / room, folder / room, ignore=leave)
    for path in [ROOT / "contact.py", *(ROOT / "curriculum").glob("*.py")]:
        if path.name != "fast.py":
            shutil.copy(path, folder / path.relative_to(ROOT))
    texts = {
        path: path.read_text("utf-8")
        for path in (folder / "contact.py", folder / "curriculum/exact.py")
    }
    assert sum(text.count(old) for text in texts.values()) == 1, f"not in one place: {old!r}"
    for path, text in texts.items():
        path.write_text(text.replace(old, new), "utf-8")
    return subprocess.run(
        [sys.executable, "-m", "curriculum.stress", "--small", str(count)],
        cwd=folder, capture_output=True, text=True, timeout=300,
    )  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_small_scenes_show_the_fault_that(fault, tmp_path):
    done = judge_a_copy(tmp_path, 30, *FAULTS[fault])
    assert done.returncode == 1, done.stderr
    assert re.search(r"^VIOLATION: small scene \d+: \w+: ", done.stdout, re.MULTILINE)


def test_the_code_as_it_stands_has_no_violation_on_the_same_scenes(tmp_path):
    done = judge_a_copy(tmp_path, 300, GRAVITY, GRAVITY)  # nothing is replaced
    assert done.returncode == 0 and "VIOLATION" not in done.stdout, done.stderr


def test_scenes_have_all_that_is_hard():
    specs = [scenes.numbered_spec(number) for number in range(400)]
    assert {spec["layout"] for spec in specs} == {layout.__name__ for layout in scenes.LAYOUTS}
    finite = [[m for m in spec["mass"] if m < float("inf")] for spec in specs]
    assert any(len(mass) < len(spec["mass"]) for mass, spec in zip(finite, specs)), "fixed balls"
    assert max(max(mass) / min(mass) for mass in finite if mass) > 500
    assert max(max(spec["radius"]) / min(spec["radius"]) for spec in specs) > 50
    assert max(abs(v) for spec in specs for v in spec["vx"]) > 10, "thrown"
    assert {1, 30} <= {len(spec["x"]) for spec in specs}
    assert scenes.numbered_spec(17) == scenes.numbered_spec(17)
    assert all(len(scenes.numbered_spec(k, small=True)["x"]) <= 4 for k in range(50))


def test_counts_add_up_and_what_could_not_fail_is_not_counted():
    found = [jobs.run(job) for job in jobs.scene_jobs(range(12), small=True)]
    whole, *parts = (jobs.added_up(found[part]) for part in (slice(12), slice(5), slice(5, 12)))
    assert whole["judgements"] == sum(part["judgements"] for part in parts) < 12 * len(PROPERTIES)
    assert whole["violations"] == [] and set(whole["properties"]) == set(PROPERTIES)
    for name, (judged, count, share) in whole["properties"].items():
        rows = [part["properties"][name] for part in parts]
        assert [judged, count] == [sum(row[k] for row in rows) for k in (0, 1)]
        assert share == max(row[2] for row in rows)


def test_a_number_that_is_off_is_a_violation_and_a_flight_says_nothing_of_springs():
    ball = {"x": [0.0], "y": [9.0], "vx": [0.0], "vy": [0.0], "mass": [1.0], "radius": [0.1]}
    flight = Trial(scenes.numbered_spec(0, small=True) | ball | {"steps": 5})
    found = jobs.judge(flight)
    assert found["springs_push_as_hooke_and_the_damper_say"] == [0, 0.0, None]
    assert found["what_nothing_touches_falls"][0] > 0
    flight.run("lcp").v[3, 1, 0] += 1e-9
    del flight.motions
    assert "lcp, fall: off by 1e-09" in jobs.judge(flight)["what_nothing_touches_falls"][2]


def assert_no_violation(todo):
    """Nothing that these jobs judge is violated, and each of them judges something."""
    added = jobs.added_up([jobs.run(job) for job in todo])
    assert added["violations"] == [] and added["judgements"] >= len(todo)


def test_maps_meet_the_theory_on_a_coarse_grid():
    assert_no_violation(list(maps.map_jobs(quick=True))[::3])


def test_at_the_critical_dt_the_map_turns_from_settling_to_not():
    row = maps.PenaltyRow(80.0, 1e4, maps.grid(1e-3, 0.1, 20))
    settles = [dt for dt in row.dts if row.outcome(dt) == maps.SETTLES]
    assert settles == [dt for dt in row.dts if dt < contact.critical_dt(1.0, 1e4, 80.0)]


@pytest.mark.parametrize("flag", extremes.FLAGS)
def test_the_ends_of_every_flag_give_a_right_report_or_one_line(flag):
    todo = [job for job in extremes.extreme_jobs(quick=True) if f" {flag} " in job[0]]
    assert_no_violation(todo)


def test_a_wrong_word_and_a_traceback_would_be_seen(tmp_path):
    path = tmp_path / "metrics.json"
    right = dict.fromkeys((key for key, _ in contact.COLUMNS.values()), 0.5)
    right |= {"blew_up": False, "through": None, "contact_error_frac": None}
    for wrong in ({}, {"through": "the floor"}, {"blew_up": True}, {"rest_jitter": None}):
        path.write_text(json.dumps({"quality": {"lcp": right | wrong}}), "utf-8")
        trouble = extremes.complaint(0, "lcp  0.1 ok\n", "", path)
        assert "called ok" in trouble if wrong else trouble is None
    path.write_text('{"quality": {"lcp": {"depth": Infinity}}}', "utf-8")
    with pytest.raises(ValueError, match="Infinity"):
        extremes.complaint(0, "lcp ok\n", "", path)
    assert "refuses" in extremes.complaint(2, "", "Traceback\nValueError: dt\n", path)
    assert extremes.complaint(2, "", "contact.py: error: given 0; allowed: more\n", path) is None


@pytest.mark.parametrize(
    "flags, words",
    [(["--workers", "0"], "allowed"), (["--scene", "big:3"], "allowed"), (["--warp"], "--warp")],
)
def test_bad_flags_are_refused_in_one_line(flags, words, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(flags)
    said = capsys.readouterr().err
    assert stop.value.code == 2 and said.count("\n") == 1 and words in said


def test_one_scene_is_judged_and_said_again(capsys):
    assert command.main(["--scene", "small:3"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}: " in said for name in PROPERTIES) and "comparisons" in said


def test_a_run_writes_its_report_and_says_what_was_judged(tmp_path):
    from curriculum.measured import results
    from curriculum.stress import report

    sections = {
        "scenes": jobs.scene_jobs(range(4)) + jobs.scene_jobs(range(4), small=True),
        "maps": maps.map_jobs(quick=True),
        "extremes": list(extremes.extreme_jobs(quick=True))[:1],
        "mujoco": [],
    }
    found = {name: [jobs.run(job) for job in todo] for name, todo in sections.items()}
    origins = dict.fromkeys(found, results.origin("stress", kept=False))
    assert report.write(found, origins, tmp_path) == []
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "no violation" in page and "](penalty-map.svg)" in page
    assert "settles at m g / k" in (tmp_path / "penalty-map.svg").read_text("utf-8")
    for function in PROPERTIES.values():
        assert " ".join(function.__doc__.split("\n\n")[0].split()) in page
