"""The figures: what is drawn is read as a reader sees it, and is what words and contact.py say.

They are drawn without a page, as the stills are; hands are tried in browsers, in test_page.py."""

import functools
import itertools
import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from py_mini_racer import MiniRacer

import contact
from curriculum.page.build import page_data
from curriculum.page.bundle import HERE, bundle
from curriculum.page.chapter import asked
from curriculum.prose import facts
from curriculum.prose.chapter import CHAPTER, read
from curriculum.source import ROOT

R, G = contact.RADIUS, -contact.GRAVITY
SLOTS = [part.name for part in read((ROOT / CHAPTER).read_text("utf-8")) if part.kind == "figure"]
RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
NUMBER = r"[−-]?[\d,]*\.?\d+(?: × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"


def value(text):
    """The number that a text of the page says, or None."""
    if power := re.fullmatch(r"<?10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", text):
        return 10.0 ** int(power[1].translate(RAISED))
    if not re.fullmatch(NUMBER, text):
        return None
    return float(text.translate(RAISED).replace(",", "").replace(" × 10", "e"))


def said(words):
    """All numbers of a sentence."""
    return [value(text) for text in re.findall(NUMBER, words)]


def points(d):
    """The points of a path's `d` [px]."""
    return np.array([each.split() for each in re.findall(r"[-\d.]+ [-\d.]+", d)], float)


def scale(ticks):
    """From px to values, straight or by powers of ten, through ticks (px, value)."""
    at, values = np.array(ticks).T
    line = np.polyfit(at, values, 1)
    if np.abs(np.polyval(line, at) - values).max() < 2e-3 * np.ptp(values):
        return lambda px: np.polyval(line, px)
    powers = np.polyfit(at, np.log10(values), 1)
    return lambda px: 10.0 ** np.polyval(powers, px)


class Picture:
    """A drawn figure: its shapes, and what its chart means by the ticks of its axes."""

    def __init__(self, drawn):
        self.__dict__.update(drawn)
        self.shapes = [*ElementTree.fromstring(f"<svg>{self.svg}</svg>").iter()]

    def all(self, tag, *kinds):
        """[{attribute: number or text}] of the shapes of this tag that have these classes."""
        number = re.compile(r"-?[\d.]+")
        return [
            {k: float(v) if number.fullmatch(v) else v for k, v in shape.items()}
            | {"text": shape.text}
            for shape in self.shapes
            if shape.tag == tag and {*kinds} <= {*shape.get("class", "").split()}
        ]

    @functools.cached_property
    def axes(self):
        """For x and for y the function from px to values."""
        ticks = [(t["x"], t["y"], value(t["text"])) for t in self.all("text", "tick")]
        along = {(line["x1"], line["y1"] + 21) for line in self.all("line", "axis")}
        across = {line["y1"] + 5 for line in self.all("line", "grid") if line["y1"] == line["y2"]}
        xs = [(x, v) for x, y, v in ticks if v is not None and (x, y) in along]
        ys = [(y - 5, v) for x, y, v in ticks if v is not None and y in across]
        return [scale(each) if len(each) > 1 else None for each in (xs, ys)]

    def seen(self, places):
        """What places on the chart mean, (..., 2)."""
        x, y = np.moveaxis(np.asarray(places), -1, 0)
        return np.stack((self.axes[0](x), self.axes[1](y)), -1)

    def curve(self, *kinds):
        """What the points of the one line of these classes mean."""
        lines = self.all("path", "line", *kinds)
        (shape,) = {line["d"] for line in lines if "way" not in line["class"]}
        return self.seen(points(shape))

    def mark(self, model):
        """What the mark of a model means."""
        (shape,) = self.all("circle", "mark", f"m-{model}")
        return self.seen((shape["cx"], shape["cy"]))


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
    """draw(name, {quantity: value}, {name: value of its own}): the Picture."""
    return lambda *told: Picture(v8(f"drawn({json.dumps(told)[1:-1]})"))


@pytest.mark.parametrize("slot", sorted(set(SLOTS)))
def test_no_hand_and_no_knob_loses_a_handle_or_a_number(v8, slot):
    name, given = map(json.dumps, asked(slot))
    for width in (640, 358):
        assert v8(f"lost({name}, {given}, {width})") == []


def test_every_figure_has_a_picture_that_is_read_few_are_kinds_and_no_slot_has_three_sliders(v8):
    kinds = {file.stem for file in (HERE / "figures").glob("*.js")}
    tests = "\n".join(name for name in globals() if name.startswith("test_picture_"))
    assert {k for k in kinds if f"test_picture_{k.replace('-', '_')}_" not in tests} == set()
    assert len(kinds) <= 14 and {asked(slot)[0] for slot in SLOTS} == kinds
    for slot in SLOTS:
        name, given = map(json.dumps, asked(slot))
        assert len(v8(f"drawn({name}, {given}).knobs")) <= 2, slot


# ---- what is drawn


def squeezed(dt):
    """How deep finger and cup overlap [r], in the last quarter of a second, by contact.py."""
    balls = contact.make_balls(contact.scene_of([-0.205, 0.0, 0.205], R, [0.2, 1.0, 0.2]))
    depths = []
    for _ in range(round(1 / dt)):
        for ball, force in zip(balls, (20.0, 0.0, -20.0)):
            ball.fx = force
        contact.penalty_step(balls, dt, 1e4, 80.0)
        depths.append(2 - np.hypot(balls[1].x - balls[0].x, balls[1].y - balls[0].y) / R)
    return np.array(depths[3 * len(depths) // 4 :])


@pytest.mark.parametrize(
    "dt, late, does",
    [(0.003, 0, "holds still"), (0.004, 0, "trembles"), (0.006, 0, "flies apart")]
    + [(0.006, 1, "holds still")],  # with the force from the step's end
)
def test_picture_gripper_moves_as_it_says_as_much_larger_and_its_knob_is_in_that_part(
    draw, dt, late, does
):
    seen = [draw("gripper", {"dt": dt, "late": late}, {"time": k * dt}) for k in range(64)]
    words, (strong,) = seen[0].words, seen[0].all("text", "strong")
    part = seen[0].all("rect", f"fate-{['holds still', 'trembles', 'flies apart'].index(does)}")[0]
    (knob,) = seen[0].all("circle", "knob-dot")
    assert does in words and strong["text"] == does
    assert part["x"] <= knob["cx"] <= part["x"] + part["width"]
    left = [each.all("circle", "m-fixed")[0] for each in seen]
    cup = [each.all("circle", "m-penalty")[0]["cx"] for each in seen]
    widths = np.array([c - each["cx"] for c, each in zip(cup, left)]) / left[0]["r"]
    if does == "flies apart":
        assert np.ptp(widths) > 1.0
    elif does == "trembles":
        trembling, larger = said(words)[1:3]
        assert np.ptp(widths) == pytest.approx(trembling * larger, rel=0.05)
        assert np.ptp(widths) > 0.1  # one sees it
        assert trembling == pytest.approx(np.ptp(squeezed(dt)), rel=0.05)
    else:
        assert np.ptp(widths) < 1e-3 and "larger" not in words
        assert late or np.ptp(squeezed(dt)) < 1e-5


@pytest.mark.parametrize(
    "name, e, dt", [("drop", 0.7, 0.004), ("drop", 0.0, 0.064), ("stack", 0.0, 0.004)]
)
def test_picture_falls_shows_the_gaps_of_contact_py_at_the_time_it_says(draw, name, e, dt):
    scene = contact.build_scene(name, restitution=e)
    given = {"scene": name, "models": ",".join(contact.MODELS), "from": 0.3, "restitution": e}
    tops = set()
    for time in (0.0, 0.1, 0.14, 0.7):  # s, of the hand
        seen = draw("falls", given, {"time": time, "dt": dt})
        at, (begins, ends, step) = said(seen.words)[0], said(seen.caption)[-3:]
        row = round(at / dt)
        (cursor,) = [each for each in seen.all("line", "rule") if each["x1"] == each["x2"]]
        assert seen.axes[0](cursor["x1"]) == pytest.approx(max(at, 0.3), abs=2e-3)
        assert row * dt == pytest.approx(at, abs=6e-4) and abs(at - 0.3 - time) <= 0.5 * dt + 1e-3
        assert step == 1000 * dt and begins == 0.3
        tops.add(seen.all("line", "table-top")[0]["y1"] - seen.all("circle", "ball")[0]["r"])
        for model in contact.MODELS:
            run = contact.run_model(model, scene, dt, math.ceil(ends / dt))
            gaps = contact.smallest_gap(run.q, scene.radius) / R
            line = seen.curve(f"m-{model}")
            assert line[-1, 0] <= ends + dt and line[0, 0] >= 0.3 - dt
            near = int(np.abs(line[:, 0] - at).argmin())
            if abs(gaps[row]) < 1.0:  # elsewhere the chart may end
                assert line[near, 1] == pytest.approx(gaps[row], abs=0.02), model
            told = re.search(rf"{model} (touches|gone|{NUMBER})", seen.words)[1]
            told = 0.0 if told == "touches" else value(told)
            assert told == pytest.approx(gaps[row], rel=0.06, abs=6e-5), model
    assert len(tops) == 1


def test_picture_falls_tells_what_comes_only_once_it_was_played_and_enlarges_a_stacks_overlap(draw):
    given = {"from": 0.4, "to": 1.4}
    before, after = (draw("falls", given, {"time": time}) for time in (0.0, 0.5))
    assert {shape["class"].split()[-1] for shape in before.all("path", "line")} <= {"whole"}
    assert len(after.all("path", "coming")) == 2
    stack = draw("falls", {"scene": "stack", "from": 0.0, "models": "penalty"}, {"time": 1.0})
    (lowest, *_), (ground,) = stack.all("circle", "ball"), stack.all("line", "table-top")
    drawn = (lowest["cy"] + lowest["r"] - ground["y1"]) / lowest["r"]
    times = said(next(t["text"] for t in stack.all("text", "tick") if "overlaps" in t["text"]))[0]
    assert drawn == pytest.approx(-times * said(stack.words)[1], rel=0.02)
    assert "ball 1 on the table" in stack.words


@pytest.mark.parametrize(
    "model, hand", itertools.product(("exact", "penalty", "soft"), (0.4, -0.6))
)
def test_picture_corner_has_its_mark_on_the_thick_line_where_the_words_say(draw, model, hand):
    seen = draw("corner", {"model": model}, {"hand": hand})
    gap, load = seen.mark(model)
    told = said(seen.words)[-2:]
    assert [gap, load] == pytest.approx(told, rel=0.05, abs=0.02)
    assert off_line((gap, load), seen.curve("law")) < 0.01
    ball, ground = seen.all("circle", "ball")[0], seen.all("line", "table-top")[0]
    larger = next((said(t["text"])[0] for t in seen.all("text", "tick") if "gaps" in t["text"]), 1)
    drawn = (ground["y1"] - ball["cy"]) / ball["r"] - 1
    assert drawn == pytest.approx(larger * gap, abs=0.02)
    if model == "soft" and hand < 0:  # under its own weight it lies where contact.py has it
        told = said(draw("corner", {"model": "soft"}, {"hand": -1 / 12}).words)[-2:]
        rest = contact.run_model("soft", contact.build_scene("drop"), 0.002, 2000).q[-1, 1, 0]
        assert told == pytest.approx([rest / R - 1, 1.0], rel=0.02)


def off_line(point, line):
    """How far a point is from a line, in shares of the line's own extent."""
    size = np.ptp(line, axis=0) + 1e-12
    p, q = np.asarray(point) / size, line / size
    a, d = q[:-1], np.diff(q, axis=0)
    share = ((p - a) * d).sum(1) / np.maximum((d * d).sum(1), 1e-30)
    return float(np.hypot(*(a + share.clip(0, 1)[:, None] * d - p).T).min())


@pytest.mark.parametrize("gap, free", [(-0.02, -0.07), (-0.05, 0.02), (0.03, -0.05)])
def test_picture_corner_line_ends_where_a_models_line_crosses_that_of_the_step(draw, gap, free):
    seen = draw("corner-line", {}, {"gap": gap, "free": free})
    vy = (free - gap) * R / 0.002 + 0.002 * G
    scene = contact.scene_of(0.0, (1 + gap) * R, vy=vy)
    for model in ("penalty", "lcp", "soft"):
        run = contact.run_model(model, scene, 0.002, 1, contact.Settings(baumgarte=1.0))
        end, lam = seen.mark(model)
        assert end == pytest.approx(run.q[1, 1, 0] / R - 1, abs=1e-3)
        assert lam == pytest.approx(run.v[1, 1, 0] - vy + 0.002 * G, abs=0.02)
        assert off_line((end, lam), seen.curve(f"m-{model}")) < 0.01
        assert off_line((end, lam), seen.curve("step-line")) < 0.01
        told = value(re.search(rf"{model} ({NUMBER})", seen.words)[1])
        assert told == pytest.approx(end, abs=1e-3)


def test_picture_signs_has_its_normals_from_b_to_a_and_the_depths_and_speeds_it_says(draw):
    own = {"x": 0.2, "y": 0.15, "vx": -0.7, "vy": 0.4}
    seen = draw("signs", {}, own)
    (ground,) = seen.all("line", "table-top")
    a = seen.all("circle", "m-exact")[0]
    b = seen.all("circle", "m-fixed")[0]
    apart = np.array([a["cx"] - b["cx"], a["cy"] - b["cy"]])
    to_table, speed, between, v_n = said(seen.words)
    assert to_table == pytest.approx(1 - (ground["y1"] - a["cy"]) / a["r"], abs=0.06)
    assert between == pytest.approx(2 - np.hypot(*apart) / a["r"], abs=0.06)
    normal, weight = apart / np.hypot(*apart), [own["vx"], -own["vy"]]
    assert v_n == pytest.approx(normal @ weight, abs=0.06) and speed == pytest.approx(0.4)
    turns = [
        float(re.search(r"rotate\((\S+)\)", each["transform"])[1])
        for each in seen.all("path", "push")
    ]
    assert turns == pytest.approx([-90.0, math.degrees(math.atan2(apart[1], apart[0]))], abs=1.0)
    floor, _, other = contact.detect_contacts(
        [contact.Ball(*own.values(), 1.0, R), contact.Ball(0.0, R, 0.0, 0.0, 1.0, R)], math.inf
    )
    right = [each for c in (floor, other) for each in (c.depth / R, c.v_n())]
    assert said(seen.words) == pytest.approx(right, rel=0.05)


@pytest.mark.parametrize("k, c", [(1e4, 80.0), (1e6, 80.0), (1e4, 0.0), (2000.0, 300.0)])
def test_picture_cliff_stands_at_its_limit_and_there_an_eigenvalue_leaves_the_circle(draw, k, c):
    critical = contact.critical_dt(1.0, k, c)
    for dt in (0.9 * critical, 1.1 * critical):
        seen = draw("cliff", {"dt": dt, "stiffness": k, "damping": c})
        (limit,) = [each for each in seen.all("line", "rule") if each["x1"] == each["x2"]]
        at = float(seen.axes[0](limit["x1"])) / 1000
        assert at == pytest.approx(critical, rel=0.01)
        label = next(t["text"] for t in seen.all("text", "strong") if "critical" in t["text"])
        assert said(label)[0] == pytest.approx(1000 * critical, rel=6e-3)
        line = seen.curve("m-penalty")
        before, beyond = (line[:, 0] < 990 * critical), (line[:, 0] > 1010 * critical)
        assert (line[before, 1] < 1e-5).all() or c == 0  # without a damper it swings on
        assert (line[beyond, 1] > (1e-5 if k < 1e6 else 2e-6)).all()
        (ring,) = seen.all("circle", "region-ring")
        pair = [m for m in seen.all("circle", "mark") if m["cy"] < 200]
        far = max(math.hypot(m["cx"] - ring["cx"], m["cy"] - ring["cy"]) for m in pair)
        assert (far > ring["r"] + 0.05) == (dt > critical)
        step = [[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]]
        sizes = np.abs(np.linalg.eigvals(step))
        assert said(seen.words)[1] == pytest.approx(sizes.max(), rel=6e-3)


def test_picture_cliff_says_what_the_text_says_of_the_drop(draw):
    for dt in (0.03, 0.014, 0.01):
        scene = contact.build_scene("drop")
        run = contact.run_model("penalty", scene, dt, 2000)
        excess = contact.contact_quality(run, scene, dt)["energy_excess"]
        seen = draw("cliff", {"dt": dt})
        assert (
            said(seen.words)[-1] == pytest.approx(excess, rel=6e-3)
            if excess
            else "no energy" in seen.words
        )


@pytest.mark.parametrize("v2", [-1.0, 1.6])
def test_picture_sweeps_is_a_staircase_along_its_axes_and_between_its_lines(draw, v2):
    seen = draw("sweeps", {}, {"time": 9, "v2": v2})
    walk = seen.curve("m-lcp")
    legs = np.diff(walk, axis=0)
    assert len(legs) == 9 and (np.abs(legs).min(1) < 0.01).all()
    assert (walk > -0.01).all() and np.abs(legs[0::2, 1]).max() < 0.01  # the table first
    lines = [seen.seen(points(each["d"])) for each in seen.all("path", "rule")]
    for visit, place in enumerate(walk[1:]):
        clamped = place[visit % 2] < 0.01
        assert clamped or off_line(place, lines[visit % 2]) < 0.01
    heights = R * np.array([1.0, 3.0])
    balls = contact.make_balls(contact.scene_of(0.0, heights, vy=[-1.0, v2]))
    contacts = [
        contact.Contact(a, b, 0.0, 1.0, 0.0) for a, b in zip(balls, [contact.FLOOR, *balls])
    ]
    contact.solve_contacts(contacts, 4)
    contact.solve_contacts(contacts[:1], 1)
    right = [c.lam for c in contacts]
    assert seen.mark("lcp") == pytest.approx(right, abs=0.02)
    assert said(seen.words)[-2:] == pytest.approx(right, abs=0.06)


def test_picture_sweeps_walks_down_the_bowl_to_where_the_balls_are_stopped_one_way_sooner(draw):
    own = {"v2": -1.3, "begin1": 0.1, "begin2": 0.2, "time": 160}  # g dt, of 1 and 10 kg
    seen = draw("sweeps", {"momentum": 1}, own)
    stopped = [1 + 10 * 1.3, 10 * 1.3]
    assert seen.mark("lcp") == pytest.approx(stopped, rel=0.02)
    bowls = [seen.seen(points(each["d"])) for each in seen.all("path", "contour")]
    for bowl in bowls:
        assert 0.5 * (bowl.min(0) + bowl.max(0)) == pytest.approx(stopped, rel=0.02)
    half = draw("sweeps", {"momentum": 1}, own | {"time": 44})
    off = [np.hypot(*(half.mark(model) - stopped)) for model in ("lcp", "leapfrog")]
    told = said(half.words)
    assert told[0] == 22 and told[1] == pytest.approx(off[0], rel=0.1) and told[2] < 0.2 * told[1]
    assert off[1] < 0.3 * off[0]


def test_picture_clamp_has_arrows_as_long_as_the_speeds_it_says(draw):
    seen = draw("clamp", {}, {"vx": 0.4, "vy": -0.9})
    v = np.array([0.4, -0.9])
    for _ in range(20):  # with a clamp on each change
        for n in ([0.6, 0.8], [-0.6, 0.8]):
            v = v + max(0.0, -v @ n) * np.array(n)
    (left,) = seen.all("path", "weight")  # only one ball leaves
    r = seen.all("circle", "m-lcp")[0]["r"]
    length = float(re.match(r"M0 0H([\d.]+)", left["d"])[1]) + 9
    assert length / (1.7 * r) == pytest.approx(np.hypot(*v), rel=0.02)
    assert said(seen.words)[-2:] == pytest.approx([0.0, np.hypot(*v)], rel=0.05)


def test_picture_sag_opens_where_its_law_holds_and_its_bars_are_contact_pys(draw):
    opens = draw("sag")
    bar = opens.all("rect", "bar-fill")[0]
    deep, law = said(opens.words)[1:]
    assert opens.axes[0](bar["x"] + bar["width"]) / 1000 == pytest.approx(deep, rel=0.05)
    assert deep == pytest.approx(law, rel=0.1)  # as the text says
    for iters, dt, balls in ((4, 0.003, 4), (1, 0.0005, 5)):
        heights = (2 * np.arange(balls) + 1) * R
        settings = contact.Settings(iters=iters)
        y = contact.run_model("lcp", contact.scene_of(0 * heights, heights), dt, 900, settings).q[
            -1, 1
        ]
        right = 1000 * (2 - np.diff(y, prepend=-R) / R)
        seen = draw("sag", {"balls": balls}, {"dt": dt, "iters": iters})
        bars = [each["x"] + each["width"] for each in seen.all("rect", "bar-fill")]
        assert seen.axes[0](np.array(bars)) == pytest.approx(right, rel=0.02, abs=0.01 * right[0])
    told = said(draw("sag", {"balls": 5}, {"dt": 0.0005, "iters": 1}).words)[-1]
    assert told == pytest.approx(4 * G * 0.0005**2 / 0.2 / R, rel=0.05)


def test_picture_sliding_has_slopes_of_one_and_two_and_opens_with_the_texts_errors(draw):
    seen = draw("sliding", {"dt": 0.002})
    right = facts.slide()
    for model, order in (("lcp", 1), ("leapfrog", 2)):
        line = np.log(seen.curve(f"m-{model}")[:5])
        assert np.polyfit(*line.T, 1)[0] == pytest.approx(order, abs=0.25)
        at, error = seen.mark(model)
        assert at == pytest.approx(2.0, rel=0.01)
        assert error == pytest.approx(right[f"{model}.0.002"], rel=0.1)
        told = value(re.search(rf"({NUMBER}) r", seen.words.split(model)[1])[1])
        assert told == pytest.approx(right[f"{model}.0.002"], rel=0.05)


def test_picture_rod_has_its_circles_where_the_line_crosses_zero(draw):
    right = facts.friction()
    for mu in (2.0, 3.0, 0.0, 1.7):
        seen = draw("rod", {"mu": mu}, {"push": right["slides"] / 2})
        line = seen.curve("m-exact")
        crossings = [
            x1 + (x2 - x1) * y1 / (y1 - y2)
            for (x1, y1), (x2, y2) in itertools.pairwise(line)
            if (y1 > 0) != (y2 > 0)
        ]
        circles = [seen.seen((c["cx"], c["cy"])) for c in seen.all("circle", "answer")]
        shown = [x for x in crossings if x < 1.3]
        assert [x for x, _ in circles[1:] if x < 1.3] == pytest.approx(shown, abs=0.01)
        assert [y for _, y in circles[1:]] == pytest.approx([0.0] * len(crossings), abs=0.01)
        assert off_line(seen.mark("exact"), line) < 0.01
        assert said(seen.words)[: len(crossings) + 1] == pytest.approx([0, *crossings], abs=0.01)
    seen = draw("rod", {"mu": 2}, {"push": right["slides"] / 2})
    answers = [0.0, right["slides"], right["jams"]]
    assert said(seen.words)[:4] == pytest.approx([*answers, right["jams"]], abs=0.01)
    assert seen.mark("exact")[1] == pytest.approx(right["rises"] / 2, abs=0.01)


@pytest.mark.parametrize("gap", [0.1, 0.35, 0.7])
def test_picture_set_back_has_paths_that_meet_at_the_impact_and_ends_as_leapfrog_does(draw, gap):
    seen = draw("set-back", {}, {"gap": gap})
    dt, e = 0.02, 0.7
    scene = contact.scene_of(0.0, (1 + gap) * R, vy=-4.0, restitution=e)
    run = contact.run_model("leapfrog", scene, dt, 1)
    old, back = seen.curve("step-line"), seen.curve("drawn-back")
    new = seen.seen(points(next(each["d"] for each in seen.all("path", "m-leapfrog", "plainly"))))
    when = old[-1]
    for line in (back[-1], new[0]):
        assert line == pytest.approx(when, abs=0.01)
    assert when[1] == pytest.approx(0.0, abs=0.01)
    assert new[-1, 1] == pytest.approx(run.q[1, 1, 0] / R - 1, abs=0.01)
    assert said(seen.words) == pytest.approx([when[0], back[0, 1], new[-1, 1]], abs=0.01)
    ground, ghost = seen.all("line", "table-top")[0], seen.all("circle", "ghost")[0]
    drawn = (ground["y1"] - ghost["cy"]) / ghost["r"] - 1
    assert drawn == pytest.approx(back[0, 1], abs=0.02)


def test_picture_touching_row_flies_on_with_the_velocities_of_exact(draw):
    opens = draw("touching-row")
    assert all(b["r"] <= b["cx"] <= 640 - b["r"] for b in opens.all("circle", "m-exact"))
    early, late = (draw("touching-row", {}, {"time": time}) for time in (0.6, 0.8))
    for k, gap in enumerate((0.0, 1e-6)):
        x = [0.0, 0.4, 0.6 + gap]
        scene = contact.scene_of(x, 0.1, vx=[1.0, 0.0, 0.0], restitution=1.0)
        right = contact.run_model("exact", scene, 0.01, 40).v[-1, 0]
        row = [seen.all("circle", "m-exact")[3 * k : 3 * k + 3] for seen in (early, late)]
        scale = row[0][0]["r"] / R  # px for 1 m
        moved = [(b["cx"] - a["cx"]) / scale / 0.2 for a, b in zip(*row)]
        assert moved == pytest.approx(right, abs=0.01)
        assert said(late.words)[3 * k : 3 * k + 3] == pytest.approx(right, abs=0.01)


@pytest.mark.parametrize("d0", [0.9, 0.5, 0.0])
def test_picture_flicker_has_its_line_at_the_formula_and_no_force_only_beyond_it(draw, d0):
    seen = draw("flicker", {"d0": d0})
    formula = math.degrees(math.acos(2 * math.cos(0.1) / (3 - d0)))
    hill = seen.curve("step-line")
    below = hill[hill[:, 0] < 45]
    assert below[:, 1] == pytest.approx(
        3 * np.cos(np.radians(below[:, 0])) - 2 * math.cos(0.1), abs=0.02
    )
    (line,) = [each for each in seen.all("line", "rule") if each["x1"] == each["x2"]]
    assert seen.axes[0](line["x1"]) == pytest.approx(formula, abs=0.2)
    assert said(seen.words)[0] == pytest.approx(formula, abs=0.06)
    force = seen.curve("m-soft")
    none = force[force[:, 1] < 0.005]
    assert (none[:, 0] > formula - 0.2).all()
    scene = contact.scene_of(
        [0.0, 1.1 * math.sin(0.1)], [1.0, 1.0 + 1.1 * math.cos(0.1)], [math.inf, 1.0], [1.0, R]
    )
    lam, settings = [], contact.Settings(solimp=(d0, *contact.SOLIMP[1:]))
    contact.run_model(
        "soft",
        scene,
        0.002,
        500,
        settings,
        on_step=lambda k, held: lam.append(sum(c.lam for c in held)),
    )
    right = np.array(lam) / 0.002 / G
    assert force[:300, 1] == pytest.approx(right[50:350], abs=0.02)
    if d0:
        assert len(none) > 0.03 * len(force) and said(seen.words)[1] == pytest.approx(
            none[0, 0], abs=0.2
        )
