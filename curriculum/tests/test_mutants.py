"""The mutants: how they are made, and the edges of the code that they showed to be untested."""

import ast
import sys

import numpy as np
import pytest

import contact
from curriculum import mutate


def ball_over_floor(v_n, depth):
    """A contact of a ball with the floor, as detect_contacts lists it."""
    ball = contact.Ball(0.0, 0.1 - depth, 0.0, v_n, 1.0, 0.1)
    return contact.Contact(ball, contact.FLOOR, 0.0, 1.0, depth)


def mutants(text):
    return {mutant.said for mutant in mutate.mutants_of("f.py", text)}


# --- making them --------------------------------------------------------------------------------


def test_operators_numbers_calls_and_conditions_are_changed():
    text = "def f(a, b=2):\n    if a and b < 1:\n        a += min(b, 3.0)\n    return -a * b\n"
    assert mutants(text) == {
        "def f(a, b=2): -> def f(a, b=3):",
        "if a and b < 1: -> if a or b < 1:",
        "if a and b < 1: -> if a and b <= 1:",
        "if a and b < 1: -> if a and b < 2:",
        "if a and b < 1: -> if not (a and b < 1):",
        "a += min(b, 3.0) -> a -= min(b, 3.0)",
        "a += min(b, 3.0) -> a += max(b, 3.0)",
        "a += min(b, 3.0) -> a += min(b, 3.3000000000000003)",
        "return -a * b -> return a * b",
        "return -a * b -> return -a / b",
    }


def test_texts_annotations_and_what_is_printed_are_left_alone():
    assert not mutants('"""Two < three."""\n\n\ndef f(a: int | None):\n    return f"{a + 1}"\n')


@pytest.mark.parametrize("file", mutate.TARGETS)
def test_every_mutant_of_the_code_is_python_and_another_program(file):
    text = (mutate.ROOT / file).read_text()
    data, before = text.encode(), ast.dump(ast.parse(text))
    made = mutate.mutants_of(file, text)
    assert len(made) > 150 and len(set(made)) == len(made)
    for mutant in made[::21]:
        new = (data[: mutant.start] + mutant.new.encode() + data[mutant.stop :]).decode()
        assert ast.dump(ast.parse(new)) != before, mutant.said


def test_a_constant_is_tried_by_the_tests_of_the_functions_that_use_it():
    text = "LIMIT = 2\n\n\ndef f():\n    return LIMIT\n\n\ndef g():\n    return 1\n"
    found = {
        "uses it": {"seconds": 3.0, "ran": ["f"]},
        "quick": {"seconds": 1.0, "ran": ["f", "g"]},
        "does not": {"seconds": 0.1, "ran": ["g"]},
    }
    (constant, *_) = mutate.mutants_of("f.py", text)
    assert mutate.tests_for(constant, text, found) == ["quick", "uses it"]


def test_functions_note_that_they_run_and_nothing_else_changes(monkeypatch):
    text = 'def f():\n    """Calls g."""\n    return g() + 1\n\n\ndef g():\n    return 1\n'
    room = {}
    exec(mutate.noting(text), room)
    monkeypatch.setattr(sys, "noted", set(), raising=False)
    assert room["g"]() == 1 and sys.noted == {"g"}
    assert room["f"]() == 2 and sys.noted == {"f", "g"} and room["f"].__doc__ == "Calls g."
    monkeypatch.delattr(sys, "noted")  # as in a process that a test starts
    assert room["f"]() == 2


def test_a_fault_is_killed_by_a_test_that_fails_or_does_not_end(tmp_path, monkeypatch):
    text = "def up(n):\n    while n < 3:\n        n += 1\n    return max(n, 3)\n"
    tests = "from contact import up\n\n\ndef test_up():\n    assert up(0) == 3\n"
    (tmp_path / "contact.py").write_text(text)
    (tmp_path / "test_up.py").write_text(tests)
    monkeypatch.setattr(mutate, "GRACE", 1.0)
    found = {"test_up.py::test_up": {"seconds": 0.0}}
    made = {mutant.said: mutant for mutant in mutate.mutants_of("contact.py", text)}
    for said, outcome in {
        "while n < 3: -> while n <= 3:": ("killed", "test_up.py::test_up"),
        "n += 1 -> n -= 1": ("late", "test_up.py::test_up"),
        "return max(n, 3) -> return min(n, 3)": ("survived", "test_up.py::test_up"),
    }.items():
        tried = mutate.try_mutant(made[said], text.encode(), list(found), found, tmp_path)
        assert tried == outcome, said
        assert (tmp_path / "contact.py").read_text() == text


def test_what_has_a_reason_is_not_tried_where_reasons_are_trusted(monkeypatch, tmp_path):
    tried = []

    class Noting:
        def __init__(self, file, folder):
            pass

        def outcome(self, mutant):
            tried.append(mutant.said)
            return "killed"

    monkeypatch.setattr(mutate, "Trials", Noting)
    monkeypatch.setattr(mutate, "reasons", lambda: {"f.py: f: a -> b": "It makes no difference."})
    both = [
        mutate.Mutant("f.py", "f", line, 0, 1, "", said)
        for line, said in ((1, "a -> b"), (2, "c -> d"))
    ]
    rows = mutate.run_file("f.py", both, tmp_path, trust=True)
    assert tried == ["c -> d"] and [row[3] for row in rows] == ["survived", "killed"]
    rows = mutate.run_file("f.py", both, tmp_path, trust=False)
    assert tried == ["c -> d", "c -> d", "a -> b"] and [row[3] for row in rows] == ["killed"] * 2


def test_the_interval_of_a_sample_has_the_ends_that_wilson_gives_it():
    """Where all n are killed it begins at n / (n + z^2), where none is it ends at z^2 / (n + z^2)."""
    n, z2 = 100, 1.96**2
    assert mutate.wilson(n, n) == pytest.approx([n / (n + z2), 1.0], rel=1e-12)
    assert mutate.wilson(0, n) == pytest.approx([0.0, z2 / (n + z2)], rel=1e-12, abs=1e-15)
    assert mutate.wilson(50, n) == pytest.approx([0.4038, 0.5962], abs=5e-5)


def test_a_survivor_without_a_reason_fails_and_a_named_one_does_not(capsys):
    rows = {"f.py": [["f", 1, "a -> b", "killed"]] * 19 + [["g", 2, "c -> d", "survived"]]}
    section = mutate.section_of(rows, {}, {"f.py": 20})
    assert mutate.show(section["files"]) == 1
    section = mutate.section_of(rows, {"f.py: g: c -> d": "no difference"}, {"f.py": 20})
    assert mutate.show(section["files"]) == 0
    assert "1 equivalent" in capsys.readouterr().out
    assert section["files"]["f.py"]["named"] == [["g", 2, "c -> d", "no difference"]]


def test_a_reason_of_a_mutant_that_is_killed_is_refuted(capsys):
    rows = {"f.py": [["f", 1, "a -> b", "killed"]] * 19 + [["g", 2, "c -> d", "late"]]}
    section = mutate.section_of(rows, {"f.py: g: c -> d": "no difference"}, {"f.py": 20})
    assert mutate.show(section["files"]) == 1
    assert "f.py:2: g: late, though it has a reason: c -> d" in capsys.readouterr().out
    del section["files"]["f.py"]["refuted"]
    assert mutate.show(section["files"]) == 0, "results from before reasons were refuted"


def test_only_those_that_have_a_reason_are_chosen_where_that_is_asked_for():
    file = "curriculum/terminal.py"
    every, chosen = mutate.choose(file, mutate.parse([file, "--named"]))
    found = {f"{file}: {mutate.words_of(mutant)}" for mutant in chosen}
    assert 0 < len(chosen) < len(every)
    assert found == {change for change in mutate.reasons() if change.startswith(file)}


def test_a_reason_for_a_line_that_has_changed_is_named(monkeypatch, tmp_path):
    (tmp_path / "f.py").write_text("def f(a):\n    return a + 1\n")
    monkeypatch.setattr(mutate, "ROOT", tmp_path)
    kept = "f.py: f: return a + 1 -> return a - 1"
    known = {kept: "Yes.", "f.py: f: return a + 2 -> return a - 2": "No.", "g.py: g: a -> b": "?"}
    monkeypatch.setattr(mutate, "reasons", lambda: known)
    assert mutate.outdated(["f.py"]) == ["f.py: f: return a + 2 -> return a - 2"]


def test_every_reason_is_of_a_file_and_a_function_and_a_sentence():
    for change, why in mutate.reasons().items():
        file, where, what = change.split(": ", 2)
        assert file in mutate.TARGETS and " -> " in what, change
        function = where.split(".")[-1]
        text = (mutate.ROOT / file).read_text("utf-8")
        assert where == "module" or f"def {function}(" in text, change
        assert why.endswith(".") and len(why.split()) > 5


# --- edges that they showed ---------------------------------------------------------------------


def test_a_ball_that_just_reaches_the_floor_within_the_step_bounces():
    """gap + dt v_n = 0 exactly: that is meeting."""
    assert contact.contact_target(ball_over_floor(-1.0, -0.5), 0.5, 0.2, 0.5) == 0.5
    near = np.nextafter(-0.5, -1.0)
    assert contact.contact_target(ball_over_floor(-1.0, near), 0.5, 0.2, 0.5) == near / 0.5


def test_the_impedance_without_a_width_is_the_mean_of_its_ends():
    assert contact.impedance(0.001, (0.2, 0.6, 0.0, 0.5, 2.0)) == pytest.approx(0.4, rel=1e-15)


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0, 3.0, 4.7])
def test_the_impedance_is_made_of_two_powers_that_meet(power):
    """x^p / mid^(p-1) up to mid, 1 - (1-x)^p / (1-mid)^(p-1) from there (MuJoCo's getimpedance)."""
    d0, d1, width, mid = 0.3, 0.9, 0.01, 0.4
    for x in (0.0, 0.1, 0.39, 0.41, 0.8, 0.999):
        y = (
            x**power / mid ** (power - 1)
            if x <= mid
            else 1 - (1 - x) ** power / (1 - mid) ** (power - 1)
        )
        got = contact.impedance(x * width, (d0, d1, width, mid, power))
        assert got == pytest.approx(d0 + y * (d1 - d0), rel=1e-13)
    assert contact.raised(3.0, 2.0) == 9.0 and contact.raised(9.0, 0.5) == 3.0


def test_the_direct_form_of_solref_has_the_stiffness_that_it_says():
    """At rest (1 - d) g = d^2 K depth with K = k / d1^2."""
    scene = contact.build_scene("drop")._replace(q0=np.array([[0.0], [0.1]]))
    run = contact.run_model("soft", scene, 0.002, 4000, solref=(-3000.0, -100.0))
    depth = 0.1 - float(run.q[-1, 1, 0])
    d = contact.impedance(depth, contact.SOLIMP)
    spring = 3000.0 / contact.SOLIMP[1] ** 2
    assert depth > 1e-5
    assert d * d * spring * depth == pytest.approx((1 - d) * 9.81, rel=1e-9)


# The measures, on recordings made by hand


def recording(*heights):
    """(run, scene) of balls of 1 kg beside one another that are at these heights, without speed."""
    y = np.array(heights, dtype=float).T
    scene = contact.build_scene("stack", bodies=y.shape[1])
    x = np.broadcast_to(np.arange(y.shape[1]), y.shape)
    q = np.stack((x, y), axis=1)
    scene = scene._replace(q0=q[0])
    return contact.Run(np.arange(len(y)) * 0.1, q, np.zeros_like(q)), scene


def test_a_start_energy_of_zero_is_measured_in_joules():
    run, scene = recording([0.0, 0.1])
    quality = contact.contact_quality(run, scene, 0.1)
    assert quality["energy_excess"] == quality["contact_energy"] == pytest.approx(0.981)
    assert contact.blow_up_step(np.array([0.0, 9.9])) is None
    assert contact.blow_up_step(np.array([0.0, 9.9, 10.5])) == 2


def test_one_touch_is_a_landing():
    run, scene = recording([0.3, 0.1, 0.35])
    quality = contact.contact_quality(run, scene, 0.1)
    assert quality["rebound_frac"] == pytest.approx(2.5)


def test_the_height_error_is_that_of_the_worst_ball():
    run, scene = recording([0.5, 0.5], [0.5, 0.45])
    reference, _ = recording([0.5, 0.49], [0.5, 0.48])
    quality = contact.contact_quality(run, scene, 0.1, reference)
    assert quality["height_error_frac"] == pytest.approx(0.3)


def test_a_deviation_of_large_values_does_not_overflow():
    assert contact.deviation(np.array([0.0, 1e200])) == pytest.approx(5e199)


def test_a_held_ball_stays_while_others_fly():
    scene = contact.build_scene("stack", bodies=2)._replace(
        q0=np.array([[0.0, 1.0], [2.0, 1.5]]), mass=np.array([1.0, np.inf])
    )
    for model in ("penalty", "lcp", "soft"):
        run = contact.run_model(model, scene, 0.002, 200)
        assert (run.q[:, :, 1] == (1.0, 1.5)).all() and (run.v[:, :, 1] == 0.0).all()
        assert run.q[-1, 1, 0] < 1.3


def test_jitter_is_that_of_the_last_quarter():
    """Twenty samples that lie still but for the fifteenth (index 14), just before the last five."""
    heights = [0.09] * 20
    heights[14] = 0.05
    assert contact.contact_quality(*recording(heights), 0.1)["rest_jitter"] == 0.0
    heights[15] = 0.05
    expected = np.std([0.5, 0.1, 0.1, 0.1, 0.1])
    assert contact.contact_quality(*recording(heights), 0.1)["rest_jitter"] == pytest.approx(
        expected
    )
