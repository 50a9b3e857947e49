"""The stress test sees every fault that is put in, sees none where there is none, and counts."""

import json
import shutil
import subprocess
import sys

import pytest
import scipy  # noqa: F401  # which the stress test loads late: skip by its name

import contact
from curriculum.stress import __main__ as command
from curriculum.stress import extremes, heaps, jobs, maps, mujoco_match, properties, scenes
from curriculum.stress.properties import PROPERTIES
from curriculum.stress.trial import Trial
from curriculum.tests import stress_claims
from curriculum.tests.helpers import ROOT

FORCE = "f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)"
BACK, TARGET = "back = -restitution * c.v_n()", "target = -self.e * v_n"
SPRING, DAMPED = "        timeconst, dampratio = solref\n        K", "4.0 * mass / (root + damping)"
SWEEP = "settled = True\n        for c in contacts:"
SUM, SETTLED = "max(0.0, c.lam + missing * c.m_eff)", "LAST_BITS = 2.0**-42"
SOFT = "MOST_SWEEPS, LAST_BITS * max(map(abs, speeds)))"
AFTER = "c.after = min(-restitution * hit + left * a_n, back)"
# What is wrong: (what stands in contact.py or exact.py, what takes its place, the property that
# must see it, and those of its claims that must name it). Many are little larger than what the
# property allows, so that a looser bound is seen as well.
FAULTS = {
    "NaN is no explosion": ("~(total - total[0] < EXP", "(total - total[0] >= EXP",
        "finite_or_said_to_have_exploded", "a model is not finite, and that is not said"),
    "exact is no number after a short flight": ("array((evaluate(Q, times),",
        "array((evaluate(Q, times) / (times < 1e-2),",
        "finite_or_said_to_have_exploded", "exact is not finite"),
    "a flight moves with the old velocity": ("q[1:] = dt * fine[1::", "q[1:] = dt * fine[:-1:",
        "a_skip_changes_no_bit", "skips: a model"),
    "a flight goes on beside a NaN": ("~(gap >= reach)", "gap < reach",
        "a_skip_changes_no_bit", "skips beside NaN: a model"),
    "a flight ends a centimetre late": ("~(gap >= reach)", "~(gap >= reach - 1e-2)",
        "a_skip_changes_no_bit", "skips from afar: a model"),
    "a distance depends on the sign of x": ("dx = a.x - b.x\n", "dx = a.x - b.x + 1e-15\n",
        "what_nothing_touches_falls", "a model, fall"),
    "forces are kept": ("ball.fx = ball.fy = 0.0  # the", "pass  # the",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "a target depends on how many contacts there are":
        ("c.target = contact_target(c", "c.target = (1 + 1e-15 * len(contacts)) * contact_target(c",
        "a_far_ball_changes_nothing", "a model"),
    "of three contacts the third is missed":
        ("depth))\n    return contacts", "depth))\n    return contacts[:2] + contacts[3:]",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the first ball of a contact of exact.py feels 1e-7 more":
        ("1.0 * (pairs[0] == balls)", "(1.0 + 1e-7) * (pairs[0] == balls)",
        "momentum_along_x_is_kept", "exact"),
    "the reaction is short by 1e-11":
        ("b.vx -= impulse * (b.inv", "b.vx -= (1.0 - 1e-11) * impulse * (b.inv",
        "momentum_along_x_is_kept", "a model"),
    "the reaction of exact.py is short by 1e-9":
        ("return (self.n * lam) @ self.sign.T", "return (self.n * lam) @ (self.sign + 1e-9).T",
        "momentum_along_x_is_kept", "exact"),
    "gravity is short by 1e-14": ("GRAVITY = -9.81 ", "GRAVITY = -9.81 * (1 - 1e-14) ",
        "what_nothing_touches_falls", "a model, fall"),
    "balls move 1e-12 too far": ("ball.x += dt * ball.vx", "ball.x += (1 + 1e-12) * dt * ball.vx",
        "what_nothing_touches_falls", "a model, move"),
    "penalty pulls between balls":
        (FORCE, f"{FORCE} if c.b is FLOOR else stiffness * c.depth - damping * c.v_n()",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the damping is short by 1e-10": (FORCE, FORCE.replace("damping", "damping * (1 - 1e-10)"),
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "a length has its own unit": ("distance = math.sqrt(dx * dx + dy * dy)\n        depth",
        "distance = math.sqrt(dx * dx + dy * dy) + 1e-9\n        depth",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the Baumgarte gain of pairs is halved":
        ("bias = baumgarte / dt", "bias = (1.0 if c.b is FLOOR else 0.5) * baumgarte / dt",
        "a_contact_alone_leaves_at_its_target", "v_n [m/s]"),
    "a contact of lcp pulls a little": (SUM, SUM.replace("0.0", "-1e-7"),
        "lcp_never_pulls_and_enough_sweeps_solve_it", "pulled [N s], step #"),
    "a push is not along the normal":
        ("a.vx += impulse * (a.inv_mass * self.nx)",
        "a.vx += impulse * a.inv_mass * (self.nx + 1e-9 * self.ny)",
        "lcp_never_pulls_and_enough_sweeps_solve_it", "not explained [N s], step #"),
    "a push is never taken back": (SUM, SUM.replace("0.0", "c.lam"),
        "lcp_never_pulls_and_enough_sweeps_solve_it", "solved [m/s], step #"),
    "the third contact is never swept":
        (SWEEP, SWEEP.replace("contacts", "contacts[:2]"),
        "lcp_never_pulls_and_enough_sweeps_solve_it", "solved [m/s], step #"),
    "lcp bounces with 1.01 e": ("bounce = -restitution", "bounce = -1.01 * restitution",
        "lcp_gains_energy_by_unfinished_sweeps_alone", "rise [J] with # sweeps"),
    "lcp bounces with e less 1e-9": ("bounce = -restitution", "bounce = 1e-9 - restitution",
        "an_impact_alone_returns_e_of_the_speed", "lcp, v_n [m/s]"),
    "soft bounces with e less 2e-3": ("-(1.0 + restitution) / dt",
        "(2e-3 - 1.0 - restitution) / dt",
        "an_impact_alone_returns_e_of_the_speed", "soft, v_n [m/s]"),
    "the time constant of soft is 10 % longer for pairs":
        (SPRING, SPRING.replace("solref", "(1.0 if c.b is FLOOR else 1.1) * solref[0], solref[1]"),
        "soft_is_mujoco", "[m], step #"),
    "the sweeps of soft end too early": (SETTLED, SETTLED.replace("42", "32"),
        "soft_is_mujoco", "[m/s], step #"),
    "exact bounces with e less 1e-8 at the start":
        (TARGET, TARGET.replace("-self.e", "(1e-8 - self.e)"),
        "exact_pushes_and_never_pulls", "velocity after the impacts [m/s]"),
    "what begins to slide falls 1e-4 too slowly":
        ("a[1] -= self.g * (held", "a[1] -= (1 - 1e-4) * self.g * (held",
        "exact_pushes_and_never_pulls", "acceleration [m/s^2]"),
    "what rests rises at 1e-3 m/s^2":
        ("held.match(a, -turn[pushes])", "held.match(a, 1e-3 - turn[pushes])",
        "exact_pushes_and_never_pulls", "acceleration [m/s^2]"),
    "exact.py leaves 1e-12 m of an overlap":
        ("resting.along(self.q) - self.found[touching])",
        "resting.along(self.q) - self.found[touching] - 1e-12)",
        "exact_never_overlaps", "overlap [m]"),
    "exact comes 1e-9 s late": ("span = min(roots)", "span = min(roots) + 1e-9",
        "exact_never_overlaps", "overlap [m]"),
    "exact loses 1e-9 of v at an event":
        ("ball.vy += span * a[k]", "ball.vy += span * a[k] - 1e-9 * ball.vy",
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "exact.py gains 1e-9 of v at an event":
        ("sample(Q, span), now", "sample(Q, span) * [[[1.0]], [[1 + 1e-9]]], now",
        "exact_keeps_its_energy", "gained since the start [J]", "gained in a step [J]"),
    "exact flies 1e-7 too high":
        ("(ball.vy + 0.5 * t * a[k])", "(ball.vy + (0.5 - 1e-7) * t * a[k])",
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "exact falls 1e-7 too slowly":
        ("ball.vy + t * a[k]\n", "ball.vy + (1 - 1e-7) * t * a[k]\n",
        "exact_keeps_its_energy", "gained in a step [J]"),
    "exact bounces with e less 1e-6": (BACK, BACK.replace("-rest", "1e-6 - rest"),
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "leapfrog forgets what it gave on the way":
        ("c.target = c.after\n", "c.target = c.after\n        c.lam = 0.0\n",
        "leapfrog_throws_nobody_out_of_another", "speed [m/s]"),
    "leapfrog opens an overlap at once":
        ("min(-gap, OPENS * (c.a.radius + c.b.radius))", "-gap",
        "leapfrog_throws_nobody_out_of_another", "speed [m/s]"),
    "leapfrog's first half of gravity is whole":
        ("accelerate(balls, 0.5 * dt)\n    before", "accelerate(balls, dt)\n    before",
        "what_nothing_touches_falls", "a model, fall", "a model, move"),
    "a bounce of leapfrog begins at the end of its step":
        ("c.target = max(c.target, (end - max(gap, 0.0)) / dt)", "pass",
        "two_free_balls_pass_or_bounce_in_closed_form", "bounce, q [m]"),
    "leapfrog bounces with 1.01 e":
        (AFTER, "c.after = -1.01 * restitution * hit",
        "two_free_balls_pass_or_bounce_in_closed_form", "bounce, v [m/s]"),
    "leapfrog asks along the normal of now": ("    turn(c, dt)\n", "",
        "two_free_balls_pass_or_bounce_in_closed_form", "pass, q [m]", "pass, v [m/s]"),
    "leapfrog ends a step along the normal of its start": ("turn(c, 0.0)  # to", "pass  # to",
        "leapfrog_is_of_second_order",
        "slide, an eighth of the step", "spread, an eighth of the step"),
    "a bounce on the table keeps the speed that gravity adds":
        (AFTER, "c.after = min(-restitution * hit, back)",
        "leapfrog_adds_no_energy_once_its_sweeps_are_done", "gained since the start [J]"),
    "the critical step is 1 % too long": (DAMPED, f"1.01 * {DAMPED}",
        "penalty_leaves_above_its_critical_dt", "critical dt [s]"),
    "the critical step is four times too long": (DAMPED, f"4 * {DAMPED}",
        "penalty_leaves_above_its_critical_dt", "critical dt [s]"),
    "lcp looks twice as far": ("contacts = detect_contacts(balls)\n",
        "contacts = detect_contacts(balls, 2e-3)\n",
        "lcp_sinks_as_deep_as_its_landing_step", "depth [m], seed #"),
    "the spring of soft is 1e-5 weaker":
        (SPRING, SPRING.replace("K", "dampratio *= 1.00001\n        K"),
        "soft_rests_where_its_spring_bears_the_ball", "spring [m/s^2] at dt # s"),
    "soft is softer by 1e-9":
        ("(1.0 - d) / d * c.inv_mass)", "(1.0 - d) / d * (1 + 1e-9) * c.inv_mass)",
        "soft_is_mujoco", "[m], step #"),
    "a step of soft ends 1e-11 m/s too fast": ("move(balls, dt)\n    return settled",
        "move(balls, dt)\n    balls[0].vy += 1e-11\n    return settled",
        "soft_is_mujoco", "[m/s], step #"),
    "the steps of a run of soft are 1e-9 longer": ("soft_step(balls, dt, *soft)",
        "soft_step(balls, (1 + 1e-9) * dt, *soft)",
        "soft_is_mujoco", "[m], run"),
}  # fmt: skip


@pytest.fixture(scope="module")
def planted(request, tmp_path_factory):
    """{fault: the claims that had to name it, and did not}, of the faults that are asked for.

    Each fault is planted into a copy of the code, without the compiled twin, which has the right
    lines still.
    """
    folder = tmp_path_factory.mktemp("faults")
    leave = shutil.ignore_patterns("results", "__pycache__", "fast.py")
    for room in ("stress", "run", "bench"):
        shutil.copytree(ROOT / "curriculum" / room, folder / "curriculum" / room, ignore=leave)
    for path in [ROOT / "contact.py", *(ROOT / "curriculum").glob("*.py")]:
        if path.name != "fast.py":
            shutil.copy(path, folder / path.relative_to(ROOT))
    asked = {getattr(item, "callspec", None) and item.callspec.params.get("fault")
             for item in request.session.items}  # fmt: skip
    todo = {fault: row for fault, row in FAULTS.items() if fault in asked}
    done = subprocess.run(
        [sys.executable, "-B", ROOT / "curriculum" / "tests" / "stress_claims.py"],
        input=json.dumps(todo), cwd=folder, capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return dict(map(json.loads, done.stdout.splitlines()))


@pytest.mark.parametrize("fault", FAULTS)
def test_the_claim_that_must_see_it_names_the_fault_that(fault, planted):
    if FAULTS[fault][2] == "soft_is_mujoco":
        pytest.importorskip("mujoco")
    assert planted[fault] == []


@pytest.fixture(scope="module")
def claimed():
    """[(claim, whether it holds)] of the code as it stands, on some of the same subjects."""
    return list(stress_claims.claimed((properties, jobs, maps, mujoco_match, heaps), 100))


def test_no_claim_is_violated_by_the_code_as_it_stands(claimed):
    assert {kind for kind, holds in claimed if not holds} == set()


def test_every_claim_of_every_property_has_a_fault_that_it_must_name(claimed):
    """So a claim that is switched off is seen. The twin is compiled: test_fast."""
    kinds = {kind for kind, _ in claimed if ": twin" not in kind}
    named = {f"{wanted}: {kind}" for _, _, wanted, *said in FAULTS.values() for kind in said}
    assert kinds <= named
    assert set(PROPERTIES) <= {wanted for _, _, wanted, *_ in FAULTS.values()}


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
    found = jobs.judge(flight, *PROPERTIES.values())
    assert found["springs_push_as_hooke_and_the_damper_say"] == [0, 0.0, None]
    assert found["what_nothing_touches_falls"][0] > 0
    flight.run("lcp").v[3, 1, 0] += 1e-9
    del flight.motions
    assert (
        "lcp, fall: off by 1e-09"
        in jobs.judge(flight, *PROPERTIES.values())["what_nothing_touches_falls"][2]
    )


def test_what_judges_nothing_is_a_violation():
    section = {"ran": {"lcp": 3, "leapfrog": 0}, "properties": {"a": [1, 9, 0.0], "b": [0, 0, 0.0]}}
    assert [words[1] for words in jobs.idle(section)] == ["leapfrog", "b"]


def test_at_the_critical_dt_the_map_turns_from_settling_to_not():
    row = maps.PenaltyRow(80.0, 1e4, maps.grid(1e-3, 0.1, 20))
    settles = [dt for dt in row.dts if row.outcome(dt) == maps.SETTLES]
    assert settles == [dt for dt in row.dts if dt < contact.critical_dt(1.0, 1e4, 80.0)]


@pytest.mark.parametrize("flag", extremes.FLAGS)
def test_the_ends_of_every_flag_give_a_right_report_or_one_line(flag):
    todo = [job for job in extremes.extreme_jobs(quick=True) if f" {flag} " in job[0]]
    added = jobs.added_up(map(jobs.run, todo))
    assert added["violations"] == [] and added["judgements"] == len(todo)


def test_a_wrong_word_and_a_traceback_would_be_seen(tmp_path):
    path = tmp_path / "metrics.json"
    right = dict.fromkeys((key for key, _ in contact.COLUMNS.values()), 0.5)
    right |= {"blew_up": False, "through": None, "contact_error_frac": None}
    for wrong in ({}, {"through": "the floor"}, {"blew_up": True}, {"rest_jitter": None}):
        path.write_text(json.dumps({"quality": {"lcp": right | wrong}}), "utf-8")
        trouble = extremes.complaint(0, "state: soft, lcp ok\n", "", path)
        assert "called ok" in trouble if wrong else trouble is None
    path.write_text('{"quality": {"lcp": {"depth": Infinity}}}', "utf-8")
    with pytest.raises(ValueError, match="Infinity"):
        extremes.complaint(0, "state: lcp ok\n", "", path)
    assert "refuses" in extremes.complaint(2, "", "Traceback\nValueError: dt\n", path)
    assert extremes.complaint(2, "", "contact.py: error: given 0; allowed: more\n", path) is None


@pytest.mark.parametrize(
    "flags, words",
    [
        (["--workers", "0"], "allowed"),
        (["--scene", "big:3"], "allowed"),
        (["--scene", "5-3"], "from 5"),
        (["--warp"], "--warp"),
    ],
)
def test_bad_flags_are_refused_in_one_line(flags, words, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main(flags)
    said = capsys.readouterr().err
    assert stop.value.code == 2 and said.count("\n") == 1 and words in said


def test_scenes_are_judged_and_said_again(capsys):
    assert command.main(["--scene", "small:3-4"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}: " in said for name in PROPERTIES) and "comparisons" in said


def test_a_run_writes_its_report_and_says_what_was_judged(tmp_path):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    from curriculum.measured import results
    from curriculum.stress import report

    sections = {
        "scenes": jobs.scene_jobs(range(4)) + jobs.scene_jobs(range(4), small=True),
        "maps": maps.map_jobs(quick=True),
        "extremes": list(extremes.extreme_jobs(quick=True))[:1],
        "mujoco": [],
        "heaps": heaps.heap_jobs(2),
    }
    found = {name: [jobs.run(job) for job in todo] for name, todo in sections.items()}
    origins = dict.fromkeys(found, results.origin("stress", kept=False))
    assert report.write(found, origins, tmp_path) == []
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "no violation" in page and "](penalty-map.svg)" in page
    assert "settles at m g / k" in (tmp_path / "penalty-map.svg").read_text("utf-8")
    for function in PROPERTIES.values():
        assert " ".join(function.__doc__.split("\n\n")[0].split()) in page
