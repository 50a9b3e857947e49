"""The figures: the values that each draws are those of contact.py, and no hand loses anything.

They are drawn without a page, as the stills are; hands are tried in browsers, in test_page.py."""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from py_mini_racer import MiniRacer

import contact
from curriculum.page.build import page_data
from curriculum.page.bundle import bundle
from curriculum.page.chapter import asked
from curriculum.prose import facts
from curriculum.prose.chapter import CHAPTER, read
from curriculum.source import ROOT

R, G = contact.RADIUS, -contact.GRAVITY
START = contact.build_scene("drop").q0[1, 0]
SLOTS = [part.name for part in read((ROOT / CHAPTER).read_text("utf-8")) if part.kind == "figure"]


@pytest.fixture(scope="module")
def v8():
    """What a JavaScript expression gives that knows page_view.js."""
    engine = MiniRacer()
    view = Path(__file__).with_name("page_view.js").read_text("utf-8")
    engine.eval(f"const MADE = {bundle('still.js', page_data(), 'text.js')};\n{view}")
    yield lambda call: json.loads(engine.eval(f"JSON.stringify({call})"))
    engine.close()


@pytest.fixture
def draw(v8):
    """draw(name, {quantity: value}, {name: value of its own}): what it draws: values, words, ..."""
    return lambda *told: v8(f"drawn({json.dumps(told)[1:-1]})")


@pytest.mark.parametrize("slot", sorted(set(SLOTS)))
def test_no_hand_and_no_knob_loses_a_handle_or_a_number(v8, slot):
    name, given = map(json.dumps, asked(slot))
    for width in (640, 358):
        assert v8(f"lost({name}, {given}, {width})") == []


def test_a_slider_takes_the_value_of_the_text_where_that_lies(v8):
    for off in (0, 1):
        place = f"MADE.toSlider(MADE.QUANTITIES.dt, 0.03) + {off}"
        assert (v8(f"MADE.fromPlace(MADE.QUANTITIES.dt, 0.03, {place})") == 0.03) == (off == 0)


# ---- what is drawn is what contact.py computes


@pytest.mark.parametrize("name, e", [("drop", 0.7), ("stack", 0.0)])
def test_falls_shows_the_gaps_of_contact_py_in_one_scale(draw, name, e):
    scene = contact.build_scene(name, restitution=e)
    own = {"models": ",".join(contact.MODELS), "dt": 0.004, "from": 0.0, "restitution": e}
    times = (0.0, 0.3, 0.44, 1.1)  # s
    seen = [draw("falls", {"scene": name} | own, {"time": time})["values"] for time in times]
    for model in contact.MODELS:
        run = contact.run_model(model, scene, 0.004, 300)
        rows = [round(time / 0.004) for time in times]
        gaps = contact.smallest_gap(run.q[rows], scene.radius) / R
        assert [each["gaps"][model] for each in seen] == pytest.approx(gaps, abs=1e-9), model
    assert len({each["top"] for each in seen}) == 1


def test_falls_until_the_landing_tells_nothing_of_it(draw):
    given = {"models": "penalty,lcp", "until": "landing", "dt": 0.002}
    gaps = draw("falls", given, {"time": 99.0})["values"]["gaps"]
    assert all(0 < gap < 0.1 for gap in gaps.values())


@pytest.mark.parametrize(
    "dt, late, does",
    [(0.001, 0, "holds still"), (0.004, 0, "trembles"), (0.007, 0, "flies apart")]
    + [(0.007, 1, "holds still")],  # with the force from the step's end
)
def test_the_gripper_holds_what_presses_its_springs_by_20_N_or_trembles(draw, dt, late, does):
    values = draw("gripper", {"dt": dt, "stiffness": 1e4, "late": late})["values"]
    assert values["does"] == does
    if does != "flies apart":
        assert (values["trembling"] < 1e-5) == (does == "holds still")
        assert values["deepest"] - values["trembling"] / 2 == pytest.approx(20 / 1e4 / R, rel=1e-4)


def test_each_model_keeps_to_its_own_law_on_the_corner(draw):
    assert draw("corner", {}, {"hand": 0.3})["values"] == {"gap": 0.3, "load": 0}
    pressed = draw("corner", {}, {"hand": -0.5})["values"]
    assert pressed == {"gap": 0, "load": 15}
    values = draw("sponge", {"stiffness": 5e3}, {"hand": -0.1})["values"]
    assert values["gap"] == pytest.approx(-values["load"] * G / 5e3 / R)
    scene = contact.build_scene("drop", damping=80.0)._replace(q0=np.array([[0.0], [1.2 * R]]))
    y = contact.run_model("penalty", scene, 0.0005, 600).q[:, 1, 0]
    free = draw("sponge", {}, {"hand": 0.2, "time": 0.3})["values"]
    assert free["gap"] == pytest.approx(y[600] / R - 1, abs=1e-9)
    soft = draw("corner-soft", {}, {"hand": -1 / 12})["values"]  # under its own weight
    rest = contact.run_model("soft", contact.build_scene("drop"), 0.002, 2000).q[-1, 1, 0] / R - 1
    assert soft["load"] == pytest.approx(1.0) and soft["gap"] == pytest.approx(rest, rel=1e-6)


def test_normals_depths_and_speeds_are_those_of_detect_contacts(draw):
    own = {"x": 0.12, "y": 0.13, "vx": -0.7, "vy": 0.4}
    a = contact.Ball(*own.values(), 1.0, R)
    b = contact.Ball(0.0, R, 0.0, 0.0, 1.0, R)
    floor, _, other = contact.detect_contacts([a, b], math.inf)
    for c, seen in zip((floor, other), draw("signs", {}, own)["values"]["contacts"]):
        assert [seen["nx"], seen["ny"]] == [c.nx, c.ny]
        assert [seen["depth"], seen["v_n"]] == pytest.approx([c.depth / R, c.v_n()])


def test_the_cliff_judges_as_contact_py_does_and_a_short_step_rests(draw):
    for dt, c in ((0.03, 80.0), (0.0137, 80.0), (0.017, 0.0), (0.01, 80.0), (0.0005, 80.0)):
        scene = contact.build_scene("drop", damping=c)
        run = contact.run_model("penalty", scene, dt, max(2000, round(4 / dt)))
        quality = contact.contact_quality(run, scene, dt)
        values = draw("cliff", {"dt": dt, "damping": c})["values"]
        assert values["explodes"] == quality["blew_up"]
        assert values["gained"] == pytest.approx(quality["energy_excess"], rel=1e-6, abs=1e-12)
        assert values["rests"] == (c > 0 and dt < contact.critical_dt(1.0, 1e4, c))
        assert values["critical"] == contact.critical_dt(1.0, 1e4, c)
    assert "rest" not in draw("cliff", {"dt": 0.03})["words"]


def test_the_eigenvalues_of_a_step_are_those_of_its_matrix(draw):
    for dt in (0.002, 0.012, 0.02):
        step = np.array([[1 - 9e3 * dt * dt, -dt * (1 - 70.0 * dt)], [9e3 * dt, 1 - 70.0 * dt]])
        values = draw("long-step", {"dt": dt, "stiffness": 9e3, "damping": 70.0})["values"]
        found = sorted((complex(*each) for each in values["pairs"]), key=lambda z: (z.real, z.imag))
        wanted = sorted(np.linalg.eigvals(step), key=lambda z: (z.real, z.imag))
        assert found == pytest.approx(wanted)


def test_one_step_ends_where_that_of_contact_py_ends_and_its_share_changes_it(draw):
    for model, dt in itertools.product(("lcp", "leapfrog"), (0.002, 0.004)):
        own = {"model": model, "gap": 0.4 * dt / R}
        values = draw("inequality", {"dt": dt, "baumgarte": 0.4}, own)["values"]
        scene = contact.scene_of(0.0, R + 0.4 * dt, vy=-2.0)
        run = contact.run_model(model, scene, dt, 1, contact.Settings(baumgarte=0.4))
        assert values["end"]["gap"] == pytest.approx(run.q[1, 1, 0] / R - 1, abs=1e-12)
        assert values["end"]["v"] == pytest.approx(run.v[1, 1, 0])
        assert values["pushed"] == (model == "leapfrog" or dt == 0.002)  # else beyond its margin
    ends = [draw("inequality", {"baumgarte": beta})["values"]["end"] for beta in (0.1, 0.9)]
    assert ends[0] != ends[1]


def test_sweeps_are_those_of_contact_py_and_the_clamp_holds(draw):
    heights = R * np.array([1.0, 3.0, 5.0])
    balls = contact.make_balls(contact.scene_of(0.0, heights, vy=[-1.0, -1.0, -0.3]))
    under = [contact.FLOOR, *balls]
    contacts = [contact.Contact(a, b, 0.0, 1.0, 0.0) for a, b in zip(balls, under)]
    contact.solve_contacts(contacts, 3)
    values = draw("sweeps", {}, {"time": 9, "top": 0.7})["values"]
    assert values["lam"] == pytest.approx([c.lam for c in contacts])
    clamped = draw("sweeps", {}, {"time": 6, "top": 1.6})["values"]
    assert clamped["clamped"] and clamped["lam"][2] == 0


def test_both_walks_down_the_bowl_end_where_the_balls_are_stopped_one_sooner(draw):
    own = {"v1": -0.6, "v2": -1.3, "begin1": 0.1, "begin2": 0.2}  # g dt, of 1 and 10 kg
    values = draw("momentum", {}, own)["values"]
    stopped = pytest.approx([0.6 + 10 * 1.3, 10 * 1.3], rel=1e-4)
    assert values["end"] == stopped and values["rolled"] == stopped
    assert values["sweeps"][1] < 0.5 * values["sweeps"][0]


def test_the_groove_is_left_as_twenty_sweeps_leave_it_with_the_clamp_and_the_wrong_one(draw):
    values = draw("clamp", {}, {"vx": 0.4, "vy": -0.9})["values"]
    assert values["sum"] < 1e-6
    v = np.array([0.4, -0.9])
    for _ in range(20):  # with a clamp on each change
        for n in ([0.6, 0.8], [-0.6, 0.8]):
            v = v + max(0.0, -v @ n) * np.array(n)
    assert values["each"] == pytest.approx(np.hypot(*v))


def test_a_landing_is_found_and_hops_as_in_contact_py_by_the_larger_of_both(draw):
    falls = math.sqrt(2 * G * (START - R))
    values = draw("landing", {"dt": 0.003, "restitution": 0.4}, {"share": 0.61})["values"]
    scene = contact.scene_of(0, R + 0.61 * falls * 0.003, vy=-falls, restitution=0.4)
    gap = contact.run_model("lcp", scene, 0.003, 300).q[:, 1, 0] / R - 1
    assert values["depth"] == pytest.approx(-gap.min(), abs=1e-9)
    assert values["larger"] == pytest.approx(gap[1:].max(), abs=1e-9)
    wanted = [0.4 * falls, 0.2 / 0.003 * values["depth"] * R]
    assert [values["bounce"], values["bias"]] == pytest.approx(wanted)
    assert values["sum"] > values["larger"]


def test_sags_are_those_of_contact_py_and_their_law_holds_for_one_sweep(draw):
    heights = (2 * np.arange(4) + 1) * R
    scene = contact.scene_of(0 * heights, heights)
    y = contact.run_model("lcp", scene, 0.003, 700, contact.Settings(iters=4)).q[-1, 1]
    values = draw("sag", {"dt": 0.003, "iters": 4, "balls": 4})["values"]
    assert values["depths"] == pytest.approx(2 - np.diff(y, prepend=-R) / R, rel=1e-3, abs=1e-9)
    values = draw("sag", {"dt": 0.0005, "iters": 1, "balls": 5})["values"]
    assert values["depths"][0] == pytest.approx(values["law"][0], rel=0.02)
    assert values["law"][0] == pytest.approx(4 * G * 0.0005**2 / 0.2 / R)
    sinks = draw("sag", {"baumgarte": 0})  # no law where nothing opens an overlap
    assert sinks["values"]["law"] is None and "nothing opens" in sinks["words"]


def test_where_a_ball_slides_lcp_is_of_first_order_and_leapfrog_of_second(draw):
    values = draw("sliding", {"dt": 0.002})["values"]
    for row, order in zip(values["all"], (1, 2)):
        dts, errors = np.array(row[1:5]).T
        assert np.polyfit(np.log(dts), np.log(errors), 1)[0] == pytest.approx(order, abs=0.25)


def test_the_impedance_is_that_of_contact_py(draw):
    values = draw("impedance", {"impedance": 0.9}, {"depth": 0.7})["values"]
    _, solimp = contact.soft_defaults(0.0, 0.002, None, (0.8, 0.9, 0.001, 0.5, 2.0))
    assert values["d"] == contact.impedance(0.0007, solimp)


def test_the_rod_has_the_three_answers_of_its_law_and_the_one_of_the_relaxed_law(draw):
    right = facts.friction()
    values = draw("rod", {"mu": 2}, {"push": right["slides"] / 2})["values"]
    assert values["coulomb"] == pytest.approx([0.0, right["slides"], right["jams"]])
    assert values["relaxed"] == pytest.approx(right["jams"])
    assert values["v_n"] == pytest.approx(right["rises"] / 2)
    assert len(draw("rod", {"mu": 1.7})["values"]["coulomb"]) == 1
