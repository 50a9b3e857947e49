"""The explaining figures: what each draws is what contact.py computes, and no ball of one is lost.

They are drawn without a page, as the stills are; hands are tried in browsers, in test_page.py."""

import json
import re

import numpy as np
import pytest

import contact
from curriculum.gate.chapter import CHAPTER, read
from curriculum.implicit import implicit_step
from curriculum.lesson.regions import ROOT
from curriculum.page.build import page_data
from curriculum.page.bundle import evaluate
from curriculum.tests.page_drawing import Drawing, arrow, figures, numbers, place, power

PARTS = read((ROOT / CHAPTER).read_text("utf-8"))
SLOTS = sorted({part.name for part in PARTS if part.kind == "figure"})
R, G = contact.RADIUS, -contact.GRAVITY
START = contact.build_scene("drop").q0[1, 0]


@pytest.fixture(scope="module")
def v8():
    """The figures in an engine without a page."""
    evaluated, engine = figures()
    yield evaluated
    engine.close()


@pytest.fixture
def draw(v8):
    """draw(name, {quantity: value}, {own: value}): the Drawing."""

    def drawing(name, changes=None, own=None, width=640):
        given = ", ".join(json.dumps(each) for each in (name, changes or {}, own or {}, width))
        return Drawing(v8(f"drawn(viewOf({given}))"))

    return drawing


def test_every_figure_has_a_slot_in_the_chapter_and_every_slot_a_figure():
    assert sorted(evaluate("still.js", page_data([]), "settable()")["names"]) == SLOTS


@pytest.mark.parametrize("name", SLOTS)
def test_nothing_that_can_be_held_leaves_the_picture_whatever_hand_and_knobs_do(v8, name):
    """Also where a knob changes while it is held, and after it was let go."""
    assert v8(f"lost({json.dumps(name)}, 358)") == []


@pytest.mark.parametrize("name", SLOTS)
def test_arrow_keys_change_what_each_handle_tells_and_a_caption_is_a_sentence(v8, name):
    assert v8(f"still({json.dumps(name)})") == []
    caption = re.sub(r"\d\.\d", "", v8(f"figures[{json.dumps(name)}].caption ?? 'None.'"))
    assert caption.count(".") <= 2 and caption[-1] == ".", caption


# ---- what is drawn, beside contact.py


def dropped(model, dt=0.002, steps=2000, **knobs):
    """Gaps [r] of contact.py's dropped ball, step by step."""
    scene, settings = contact.build_scene("drop"), contact.Settings(**knobs)
    return contact.run_model(model, scene, dt, steps, settings).q[:, 1, 0] / R - 1


def test_the_live_figure_and_the_first_bet_write_the_gaps_of_contact_py(draw):
    own = {"from": 0.3, "to": 1.2, "time": 0.45}
    live = draw("lanes", {"dt": 0.003}, own).labels(r" r (in|up)$|touching")
    asked = draw("two", own={"time": 0.45}).labels(" r (inside|above)$|on the table")
    for dt, texts, models in ((0.003, live, contact.MODELS), (0.002, asked, ("penalty", "lcp"))):
        for model, text in zip(models, texts, strict=True):
            gap = dropped(model, dt, round(0.45 / dt))[-1]
            told = -numbers(text)[0] if " r in" in text else (numbers(text) or [0.0])[0]
            assert told == pytest.approx(gap, rel=0.06, abs=1e-9), (model, text)


def test_the_first_ball_flies_as_exact_does(v8):
    own = {"place": [0.7, 0.61], "velocity": [0, 0.4], "free": True}
    view = f"viewOf('grab', {{}}, {json.dumps(own)}, 640)"
    seen = v8(f"((view) => view.figure.tick(view, 0.53) && drawn(view))({view})")
    ball = place(Drawing(seen).shapes("ball")[0])
    scene = contact.scene_of(0.0, 0.61, vy=0.4, restitution=0.6)
    high = contact.run_model("exact", scene, 0.53, 1).q[1, 1, 0]
    floor, scale = 360 - 46, (360 - 46) / 0.8
    assert (floor - ball[1]) / scale == pytest.approx(high, abs=1e-4)


def test_a_ball_let_go_on_a_spring_is_as_deep_as_that_of_contact_py(draw):
    k = 3000.0
    sponge = draw("sponge", {"stiffness": k}, {"hand": 0.7, "time": 0.31})
    settings = contact.Settings(stiffness=k)
    run = contact.run_model("penalty", contact.scene_of(0, 1.7 * R), 0.0005, 620, settings)
    floor, ball = sponge.shapes("table-top")[0]["y1"], sponge.shapes("ball")[0]
    gap = run.q[-1, 1, 0] / R - 1
    assert (floor - ball["cy"]) / ball["r"] - 1 == pytest.approx(gap, abs=2e-4)
    _, force, deep = numbers(sponge.words)
    assert force == pytest.approx(max(0.0, -gap) * k * R / G, rel=0.06)
    assert deep == pytest.approx(G / k / R, rel=5e-3)


def test_normals_are_drawn_as_detect_contacts_has_them(draw):
    signs = draw("signs", own={"x": 0.17, "y": 0.29, "vx": 0.4, "vy": -0.9})
    a, b = contact.Ball(0.17, 0.29, 0.4, -0.9, 1, R), contact.Ball(0, R, 0, 0, 1, R)
    wanted = [c for c in contact.detect_contacts([a, b], margin=1.0) if c.a is a]
    for c, shape in zip(wanted, signs.shapes("arrow push"), strict=True):
        start, tip = arrow(shape)
        way = (tip - start) / np.hypot(*(tip - start))
        assert way == pytest.approx([c.nx, -c.ny], abs=2e-3)
    assert numbers(signs.words) == pytest.approx(
        [x for c in wanted for x in (c.depth / R, c.v_n())], rel=5e-3
    )


def point(drawing, model, log="", top=0):
    """What the last marker of a model marks on the axes."""
    x, y = drawing.axes(log, top)
    px, py = place(drawing.shapes(f"mark m-{model}")[-1])
    return x(px), y(py)


def test_each_model_keeps_to_its_own_law_on_the_corner(draw):
    """No gap with a wall; on a ramp F / k; in soft K d^2 depth = (1 - d) F."""
    assert point(draw("corner", own={"hand": -0.6}), "exact") == pytest.approx((0, 18), abs=0.02)
    gap, force = point(draw("sponge", {"stiffness": 7000}, {"hand": -0.4}), "penalty")
    f_n = contact.penalty_normal_force(-gap * R, 0.0, 7000, 80)
    assert f_n == pytest.approx(force * G, rel=0.02)
    gap, force = point(draw("corner-soft", own={"hand": -0.7}), "soft")
    (timeconst, ratio), solimp = contact.soft_defaults(0.0, 0.002)
    stiff = 1 / (solimp[1] * timeconst * ratio) ** 2
    d = contact.impedance(-gap * R, solimp)
    assert stiff * d**2 * -gap * R == pytest.approx((1 - d) * force * G, rel=0.03)


def test_the_cliff_draws_how_far_the_ball_still_moves_and_its_critical_steps(draw):
    for name, dt, k, c in (
        ("cliff", 0.0137, 1e4, 80.0),
        ("cliff", 0.009, 2.5e4, 110.0),
        ("cliff", 0.001, 8e3, 25.0),
    ):
        figure = draw(name, {"dt": dt, "stiffness": k, "damping": c})
        gaps = dropped_with(dt, k, c)
        _, moves = point(figure, "penalty", log="xy")
        assert moves == pytest.approx(max(np.ptp(gaps[-501:]), 1e-6), rel=0.05)
        told = [numbers(figure.labels(words)[0])[-1] for words in ("with its damper", "2√")]
        steps = [1000 * contact.critical_dt(1.0, k, each) for each in (c, 0.0)]
        assert told == pytest.approx(steps, rel=5e-3)
    scene = contact.build_scene("drop")
    run = contact.run_model("penalty", scene, 0.03, 2000)
    gained = contact.contact_quality(run, scene, 0.03)["energy_excess"]
    words = draw("cliff", {"dt": 0.03}).words
    assert numbers(words)[1] == pytest.approx(gained, rel=1e-3) and "explodes" in words
    scene = contact.build_scene("drop", damping=0.0)  # it gains 65 times its energy: an explosion
    words = draw("cliff", {"dt": 0.017, "damping": 0}).words
    blew = contact.contact_quality(contact.run_model("penalty", scene, 0.017, 2000), scene, 0.017)
    assert "explodes" in words and blew["blew_up"]


def dropped_with(dt, k, c):
    """Gaps [r] of a ball dropped on a spring."""
    scene = contact.build_scene("drop", damping=c)
    return (
        contact.run_model("penalty", scene, dt, 2000, contact.Settings(stiffness=k)).q[:, 1, 0] / R
        - 1
    )


def test_drops_that_a_figure_looks_at_in_one_loop_have_the_bits_of_contact_py():
    for dt, k, c in ((0.002, 1e4, 80.0), (0.0141, 1e4, 80.0), (0.01, 300.0, 0.0)):
        shown = evaluate("kit.js", page_data([]), f"drops({dt}, {k}, {c}, 2000).join()")
        scene = contact.build_scene("drop", damping=c)
        run = contact.run_model("penalty", scene, dt, 2000, contact.Settings(stiffness=k))
        assert [float(each) for each in shown.split(",")] == run.q[:, 1, 0].tolist()


def test_one_long_step_marks_the_eigenvalues_of_its_matrix(draw):
    k, c, dt = 9000.0, 70.0, 0.012
    step = np.array([[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]])
    figure = draw("long-step", {"dt": dt, "stiffness": k, "damping": c})
    unit = next(each for each in figure.shapes("rule") if "r" in each)
    marks = [
        (place(each) - place(unit)) / unit["r"] for each in figure.shapes("mark m-penalty")[-2:]
    ]
    found = (
        sorted(complex(x, -y) for x, y in marks if True)
        if False
        else sorted((complex(x, -y) for x, y in marks), key=lambda z: (z.real, z.imag))
    )
    wanted = sorted(np.linalg.eigvals(step), key=lambda z: (z.real, z.imag))
    assert np.abs(np.array(found) - wanted).max() < 5e-3
    assert numbers(figure.words)[2] == pytest.approx(1000 * contact.critical_dt(1, k, c), rel=5e-3)


def squeezed(dt, k, late):
    """The deepest overlap [r] at the end, and in the last quarter how much it varies."""
    scene = contact.scene_of([-0.205, 0.0, 0.205], R, [0.2, 1.0, 0.2])
    softness = 1.0 / (k * dt * dt + 80.0 * dt)

    def step(balls):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):
            ball.fx, ball.fy = force, 0.0
        if late:
            implicit_step(balls, dt, lambda depth: (softness, dt * k * depth * softness))
            return
        contact.penalty_force(contact.detect_contacts(balls, margin=0.0), k, 80.0)
        contact.accelerate(balls, dt)
        contact.move(balls, dt)

    run = contact.simulate(step, scene, dt, int(np.ceil(1 / dt - 1e-9)))
    depth = np.maximum(0.0, -contact.smallest_gap(run.q, scene.radius) / R)
    return depth[-1], np.ptp(depth[3 * len(depth) // 4 :])


@pytest.mark.parametrize(
    "dt, k, late", [(0.004, 1e4, False), (0.004, 1e6, True), (0.0035, 1.5e4, False)]
)
def test_the_gripper_overlaps_as_three_balls_of_contact_py_do(draw, dt, k, late):
    deep, varies = squeezed(dt, k, late)
    for name in ("promise", "gripper"):
        figure = draw(name, {"dt": dt, "stiffness": k}, {"late": late})
        left, right = (each["cx"] for each in figure.shapes("magnified"))
        r = figure.shapes("magnified")[0]["r"]
        assert (2 * r - (right - left)) / r == pytest.approx(deep, abs=2e-5)
        assert ("holds still" in figure.words) == (varies < 1e-5)
        assert varies < 1e-5 or numbers(figure.words)[3] == pytest.approx(varies, rel=0.06)
    assert "fly apart" in draw("gripper", {"dt": 0.006}).words


def test_inequality_and_landing_end_where_steps_of_contact_py_end(draw):
    figure, dt = draw("inequality", {"dt": 0.003, "baumgarte": 0.4}, {"gap": 0.2, "v": -3.0}), 0.003
    ball = contact.Ball(0.0, R + 0.2 * dt, 0.0, -3.0, 1.0, R)
    contact.lcp_step([ball], dt, 0.0, 0.4, 20)
    assert lowest_gap(figure, "ghost") == pytest.approx(ball.y / R - 1, rel=0.035)
    falls = np.sqrt(2 * G * (START - R))
    figure = draw("landing", {"dt": 0.003, "restitution": 0.4}, {"share": 0.61})
    scene = contact.scene_of(0, R + 0.61 * falls * dt, vy=-falls, restitution=0.4)
    depth = 1 - contact.run_model("lcp", scene, dt, 3).q[:, 1, 0].min() / R
    assert lowest_gap(figure, "ball") == pytest.approx(-depth, rel=0.035)
    bounce, bias, *highs = numbers(figure.words)[2:]
    assert [bounce, bias] == pytest.approx([0.4 * falls, 0.2 / dt * depth * R], rel=5e-3)
    heights = [v * v / (2 * G * R) for v in (max(bounce, bias), bounce + bias)]
    assert highs == pytest.approx(heights, rel=0.05)


def lowest_gap(figure, kind):
    """The gap [r] of a ball in a picture that says how many times its gaps are enlarged."""
    times = numbers(figure.labels("gaps ×")[0])[0]
    ball, floor = figure.shapes(f"{kind} m-lcp")[-1], figure.shapes("table-top")[0]["y1"]
    return (floor - ball["cy"] - ball["r"]) / ball["r"] / times


def column(masses, speeds, sweeps, solve=contact.solve_contacts):
    """Impulses [m g dt] of touching balls over one another after sweeps; speeds in g dt."""
    heights = (2 * np.arange(len(masses)) + 1) * R
    balls = contact.make_balls(contact.scene_of(0 * heights, heights, masses, vy=speeds))
    contacts = sorted(contact.detect_contacts(balls, margin=1e-9), key=lambda c: c.a.y + c.b.y)
    solve(contacts, sweeps)
    return [c.lam for c in contacts]


def test_sweeps_are_bars_as_long_as_the_impulses_of_contact_py(draw):
    own = {"time": 9, "top": 0.7}
    figure = draw("sweeps", own=own)
    ticks = [node for node in figure.root.iter("text") if node.text in ("1", "2")]
    one, two = (float(node.get("x")) for node in ticks if node.get("text-anchor") == "middle")
    bars = [bar["width"] / (two - one) for bar in figure.shapes("bar-fill")]
    assert bars == pytest.approx(column([1, 1, 1], [-1, -1, -0.3], 3), abs=0.01)
    clamped = draw("sweeps", own={"time": 6, "top": 1.6})
    assert clamped.labels("clamped at 0") and clamped.shapes("bar-fill")[2]["width"] == 0


def test_the_walk_down_the_bowl_is_that_of_the_sweeps_and_ends_at_its_lowest_point(draw):
    figure = draw("bowl", own={"v1": -0.6, "v2": -1.3, "heavy": 10, "begin1": 0, "begin2": 0})
    assert point(figure, "lcp") == pytest.approx(column([1, 10], [-0.6, -1.3], 100), rel=0.01)
    quick = draw("momentum", own={"v1": -0.6, "v2": -1.3, "begin2": 0})
    assert point(quick, "lcp") == pytest.approx(column([1, 10], [-0.6, -1.3], 100), rel=0.01)
    rings = [place(ring) for ring in quick.shapes("look m-leapfrog")]
    x, y = quick.axes()
    third = column([1, 10], [-0.6, -1.3], 3, contact.solve_with_momentum)
    assert (x(rings[2][0]), y(rings[2][1])) == pytest.approx(third, rel=0.01)
    figure = draw("bowl", own={"v1": -0.6, "v2": -1.3})
    inside = np.linalg.solve([[1, -1], [-1, 2]], [0.6, 0.7])
    assert point(figure, "lcp") == pytest.approx(inside, abs=0.02)


def test_the_groove_is_left_as_twenty_sweeps_leave_it(draw):
    figure = draw("clamp", own={"vx": 0.4, "vy": -0.9})
    ball = contact.Ball(0.0, 0.0, 0.4, -0.9, 1.0, R)
    held = [contact.Ball(0.0, 0.0, 0.0, 0.0, np.inf, R) for _ in range(2)]
    contacts = [contact.Contact(ball, b, nx, 0.8, 0.0) for b, nx in zip(held, (0.6, -0.6))]
    contact.solve_contacts(contacts, 20)
    lengths = [
        np.hypot(*(tip - start)) for start, tip in map(arrow, figure.shapes("arrow push")[:2])
    ]
    assert np.array(lengths) / (1.7 * 52) == pytest.approx([c.lam for c in contacts], abs=2e-3)
    lam = np.zeros(2)  # with a clamp on each change
    v = np.array([0.4, -0.9])
    for _ in range(20):
        for k, n in enumerate(([0.6, 0.8], [-0.6, 0.8])):
            change = max(0.0, -v @ n)
            lam[k], v = lam[k] + change, v + change * np.array(n)
    assert numbers(figure.labels("leaves")[-1]) == [pytest.approx(np.hypot(*v), abs=5e-3)]


def at_rest(masses, dt, **knobs):
    """How deep [r] each ball lies in what is below it after two seconds of lcp."""
    heights = (2 * np.arange(len(masses)) + 1) * R
    scene = contact.scene_of(0 * heights, heights, masses)
    y = contact.run_model("lcp", scene, dt, round(2 / dt), contact.Settings(**knobs)).q[-1, 1]
    return 2 - np.diff(y, prepend=-R) / R


def test_each_sag_is_that_of_contact_py_and_its_law_holds_for_one_sweep(draw):
    masses = [1, 3, 1, 1]
    figure = draw("sag", {"dt": 0.003, "iters": 4}, {"masses": masses, "count": 4})
    unit = power(figure.labels(r"^in 10")[0].split()[1])
    told = np.array([numbers(text)[0] * unit for text in figure.labels(r"^\d\.\d\d$")])
    assert told == pytest.approx(at_rest(masses, 0.003, iters=4), abs=0.006 * unit)
    small = draw("sag", width=358).labels(r"^\d\.\d\d$")  # on a phone they still differ
    assert len(small) == len(set(small)) == 8
    figure = draw("sag", {"dt": 0.002, "iters": 6}, {"count": 5, "parts": 6})
    deep, law = numbers(figure.words)[-2:]
    assert law == pytest.approx(4 * G * (0.002 / 6) ** 2 / 0.2 / R, rel=0.01)
    assert deep == pytest.approx(law, rel=0.01)


def test_the_cradle_leaves_as_strike_has_it_and_one_after_another_passes_the_blow_on(draw):
    figure = draw("cradle", own={"pulled": 0.5, "time": np.pi / np.sqrt(G / 0.5)})
    balls = [contact.Ball(2 * R * k, 1.0, float(k == 0), 0.0, 1.0, R) for k in range(4)]
    contact.strike(
        [c for c in contact.detect_contacts(balls, 1e-9) if c.b is not contact.FLOOR], 1.0
    )
    shapes = [place(each) for each in figure.shapes("m-exact")]
    tops = np.array([[each["x1"], each["y1"]] for each in figure.shapes("axis")])
    swung = [np.arctan2(x - a, y - b) / 0.5 for (x, y), (a, b) in zip(shapes, tops)]
    assert swung[:4] == pytest.approx([ball.vx for ball in balls], abs=0.01)
    assert swung[4:] == pytest.approx([0, 0, 0, 1], abs=0.01)


def test_blocks_count_the_digits_of_pi_and_lcp_counts_its_steps_with_an_impact(draw):
    scene = contact.scene_of([0, 0.6, 1.15], R, [np.inf, 1, 1e4], vx=[0, 0, -1], restitution=1.0)
    v = contact.run_model("lcp", scene, 0.003, 1334).v[:, 0, 1]
    impacts = np.count_nonzero(np.abs(np.diff(v)) > 1e-9)
    counted = [
        numbers(text)[1] for text in draw("blocks", {"dt": 0.003}, {"n": 2}).labels("impact")
    ]
    assert counted == [314, impacts] and impacts < 314
    for n, digits in enumerate((3, 31, 314, 3141)):
        assert numbers(draw("blocks", own={"n": n, "time": 4}).labels("exact")[0]) == [
            digits,
            digits,
        ]


def test_impedance_and_softness_are_those_of_contact_py(draw):
    figure = draw("impedance", {"impedance": 0.9}, {"depth": 0.3})
    d = contact.impedance(0.3 * 0.001, (0.8, 0.9, 0.001, 0.5, 2.0))
    assert numbers(figure.labels("%")[0]) == [pytest.approx(100 * d, rel=5e-3)]
    ball = contact.Ball(0.0, R - 0.0003, 0.0, 0.0, 1.0, R)
    (c,) = contact.detect_contacts([ball], 0.0)
    contact.soften(c, 0.002, *contact.soft_defaults(0.0, 0.002, None, (0.8, 0.9, 0.001, 0.5, 2.0)))
    assert numbers(figure.words)[-1] == pytest.approx(c.softness, rel=5e-3)


def test_twice_ends_its_steps_as_contact_py_does_and_draws_both_orders(draw):
    dt, gap, v = 0.0065, 2.5, -3.2
    figure = draw("twice", {"dt": dt}, {"gap": gap, "v": v, "lean": 0.3})
    for model in ("lcp", "leapfrog"):
        before, after = (place(each)[1] for each in figure.shapes(f"ball m-{model}")[:2])
        foot = figure.shapes("table-top")[0]["y1"] - 13  # px, of a ball that touches
        run = contact.run_model(model, contact.scene_of(0, R + gap * dt, vy=v), dt, 1)
        ends = (foot - after) / (foot - before) * gap * dt / R
        assert ends == pytest.approx(run.q[1, 1, 0] / R - 1, abs=2e-3)
    x, y = 2 * R * np.sin(0.3), 2 * R * np.cos(0.3)
    scene = contact.scene_of([0, x], [5, 5 + y], [np.inf, 1])
    truth = contact.run_model("exact", scene, dt, 76).q
    chart_x, chart_y = figure.axes(log="xy", top=280)
    for model in ("lcp", "leapfrog"):
        off = np.hypot(*(contact.run_model(model, scene, dt, 76).q - truth)[:, :, 1].T).max() / R
        px, py = place(figure.shapes(f"mark m-{model}")[-1])
        assert (chart_x(px), chart_y(py)) == pytest.approx((6.5, off), rel=0.05)


def test_the_landing_of_a_series_is_the_first_contact_of_contact_py_and_its_push_stops_the_fall(v8):
    scene = contact.scene_of(0, [0.37, 0.9], [2.0, 0.3], vy=[-0.2, 0.0])
    given = {"x": [0, 0], "y": [0.37, 0.9], "vx": [0, 0], "vy": [-0.2, 0], "mass": [2, 0.3]}
    given |= {"radius": [R, R]}
    knobs = {"dt": 0.003, "stiffness": 1e4, "damping": 80, "restitution": 0, "iters": 20}
    knobs |= {"baumgarte": 0.2, "warm": 0}
    for model in contact.STEPPED:
        run = contact.run_model(model, scene, 0.003, 200)
        gap = contact.smallest_gap(run.q, scene.radius)
        landing = contact.first_contact(run, scene, 0.003, gap)
        call = f"ENGINE.runModel('{model}', scene, {json.dumps(knobs)}, 200)"
        call = f"((scene) => ENGINE.series({call}, scene))({json.dumps(given)})"
        landed, push = v8(f"(({{ landing, push }}) => [landing, push[{landing}]])({call})")
        faster = np.diff(run.v[landing - 1 : landing + 1, 1], axis=0)[0] / 0.003 + G
        assert landed == landing < 200
        assert push == pytest.approx(scene.mass @ faster / (2.3 * G), abs=1e-6)


def test_a_section_keeps_what_is_set_and_says_what_differs_from_its_text(v8):
    acts = "s.set({ stiffness: 3000 }); s.set({ damping: 9, dt: 7 }); s.set({ scene: 'bounce' });"
    section = f"((s) => {{ {acts} return s; }})(new STORE.Section('any', {{ dt: 0.01 }}))"
    e = contact.build_scene("bounce").restitution
    changed = {"stiffness": 3000, "damping": 0, "scene": "bounce", "restitution": e}
    assert (
        v8(f"{section}.changes()") == changed
    )  # dt = 7 s is not allowed; a scene has its own c, e
    assert ["stiffness", "Stiffness k = 3,000, text: 10,000"] in v8(f"{section}.inWords()")
    assert sorted(v8(f"{section}.query()").split("&"))[-1] == "stiffness=3000"
