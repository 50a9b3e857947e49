"""The figures: what is drawn is read as a reader sees it, and is what the words beside it say.

They are drawn without a page, as the stills are; hands are tried in browsers, in test_page.py.
That a run is contact.py's to the last bit is test_page_engine.py's to prove."""

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


def of_model(model, words):
    """What a sentence says of a model: the number behind its name; of what is gone, no number."""
    found = re.search(rf"{model} (touches|{NUMBER})", words)
    if not found:
        return math.nan
    return 0.0 if found[1] == "touches" else value(found[1])


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


def off_line(point, line):
    """How far a point is from a line, in shares of the line's own extent."""
    size = np.ptp(line, axis=0) + 1e-12
    p, q = np.asarray(point) / size, line / size
    a, d = q[:-1], np.diff(q, axis=0)
    share = ((p - a) * d).sum(1) / np.maximum((d * d).sum(1), 1e-30)
    return float(np.hypot(*(a + share.clip(0, 1)[:, None] * d - p).T).min())


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

    def upright(self):
        """What x the one upright line means."""
        (line,) = [each for each in self.all("line", "rule") if each["x1"] == each["x2"]]
        return float(self.axes[0](line["x1"]))

    def gap(self, *kinds):
        """How far the first circle of these classes is drawn above the table, in its radii."""
        ball, ground = self.all("circle", *kinds)[0], self.all("line", "table-top")[0]
        return (ground["y1"] - ball["cy"]) / ball["r"] - 1

    def larger(self):
        """How many times larger the picture says that it is."""
        ticks = [t["text"] for t in self.all("text", "tick")]
        return next((said(text)[0] for text in ticks if re.match("gaps|overlaps", text)), 1)


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
    assert [v8(f"lost({name}, {given}, {width})") for width in (640, 358)] == [[], []]
    assert len(v8(f"drawn({name}, {given}).knobs")) <= 2


def test_every_figure_has_a_picture_that_is_read_and_few_are_kinds():
    kinds = {file.stem for file in (HERE / "figures").glob("*.js")}
    tests = "\n".join(name for name in globals() if name.startswith("test_picture_"))
    assert {k for k in kinds if f"test_picture_{k.replace('-', '_')}_" not in tests} == set()
    assert len(kinds) <= 14 and {asked(slot)[0] for slot in SLOTS} == kinds


# ---- what is drawn


FATES = ["holds still", "trembles", "flies apart"]


@pytest.mark.parametrize(  # with late=1 by the force from the step's end
    "dt, late, fate", [(0.003, 0, 0), (0.004, 0, 1), (0.0046, 0, 1), (0.006, 0, 2), (0.006, 1, 0)]
)
def test_picture_gripper_moves_as_it_says_and_its_knob_is_in_that_part(draw, dt, late, fate):
    seen = [draw("gripper", {"dt": dt, "late": late}, {"time": k * dt}) for k in range(64)]
    words, (strong,) = seen[0].words, seen[0].all("text", "strong")
    (part,), (knob,) = seen[0].all("rect", f"fate-{fate}"), seen[0].all("circle", "knob-dot")
    assert FATES[fate] in words and strong["text"] == FATES[fate]
    assert part["x"] <= knob["cx"] <= part["x"] + part["width"]
    left = [each.all("circle", "m-fixed")[0] for each in seen]
    cup = [each.all("circle", "m-penalty")[0]["cx"] for each in seen]
    moves = np.ptp([c - each["cx"] for c, each in zip(cup, left)]) / left[0]["r"]
    if fate == 1:
        trembling, larger = (*said(words)[1:], 1.0)[:2]
        assert moves == pytest.approx(trembling * larger, rel=0.05) and 0.1 < moves < 2
    else:
        assert moves > 1.0 if fate else moves < 1e-3
        assert "larger" not in words
    apart = (cup[0] - left[0]["cx"]) / left[0]["r"]  # before it is played one sees where it ends
    assert (apart > 3) == (fate == 2)


@pytest.mark.parametrize(
    "scene, e, dt", [("drop", 0.7, 0.004), ("drop", 0.0, 0.064), ("stack", 0.0, 0.004)]
)
def test_picture_falls_shows_the_gaps_at_the_time_that_it_says(draw, scene, e, dt):
    given = {"scene": scene, "models": ",".join(contact.MODELS), "from": 0.3, "restitution": e}
    for time in (0.0, 0.1, 0.14, 0.7):  # s, of the hand
        seen = draw("falls", given, {"time": time, "dt": dt})
        at, (begins, _, step) = said(seen.words)[0], said(seen.caption)[-3:]
        assert seen.upright() == pytest.approx(max(at, 0.3), abs=2e-3)
        assert round(at / dt) * dt == pytest.approx(at, abs=6e-4)
        assert abs(at - 0.3 - time) <= 0.5 * dt + 1e-3
        assert step == 1000 * dt and begins == 0.3
        for model in contact.MODELS:
            told, line = of_model(model, seen.words), seen.curve(f"m-{model}")
            near = line[np.abs(line[:, 0] - at).argmin()]
            if abs(told) < 1:  # elsewhere the chart may end
                assert near == pytest.approx([at, told], abs=0.02), model
                if scene == "drop":
                    assert seen.gap("ball", f"m-{model}") == pytest.approx(told, abs=0.02), model


def test_picture_falls_tells_what_comes_only_once_it_was_played_and_enlarges_a_stacks_overlap(draw):
    given = {"from": 0.4, "to": 1.4}
    before, after = (draw("falls", given, {"time": time}) for time in (0.0, 0.5))
    assert {shape["class"].split()[-1] for shape in before.all("path", "line")} <= {"whole"}
    for seen in (after, draw("falls", given | {"time": 0.1})):  # or where the text shows some of it
        assert len(seen.all("path", "coming")) == 2
    stack = draw("falls", {"scene": "stack", "from": 0.0, "models": "penalty"}, {"time": 1.0})
    larger, overlap = stack.larger(), said(stack.words)[1]
    assert larger > 1 and stack.gap("ball") == pytest.approx(larger * overlap, rel=0.02)
    assert "ball 1 on the table" in stack.words
    for slot in SLOTS:
        if slot.startswith("falls"):  # no ball covers its name
            for seen in (draw(*asked(slot)), draw(*asked(slot), {"time": 0.0})):
                balls = seen.all("circle", "ball")
                assert seen.all("text", "strong")[0]["y"] < min(b["cy"] - b["r"] for b in balls)


@pytest.mark.parametrize("model", ["exact", "penalty", "soft"])
@pytest.mark.parametrize("hand", [0.4, -0.6])
def test_picture_corner_has_its_mark_on_the_thick_line_where_the_words_say(draw, model, hand):
    seen = draw("corner", {"model": model}, {"hand": hand})
    gap, load = seen.mark(model)
    assert [gap, load] == pytest.approx(said(seen.words)[-2:], rel=0.05, abs=0.02)
    assert off_line((gap, load), seen.curve("law")) < 0.01
    assert seen.gap("ball") == pytest.approx(seen.larger() * gap, abs=0.02)
    if model == "soft" and hand < 0:  # under its own weight it lies where contact.py has it
        told = said(draw("corner", {"model": "soft"}, {"hand": -1 / 12}).words)[-2:]
        rest = contact.run_model("soft", contact.build_scene("drop"), 0.002, 2000).q[-1, 1, 0]
        assert told == pytest.approx([rest / R - 1, 1.0], rel=0.02)


@pytest.mark.parametrize("gap, free", [(-0.02, -0.07), (-0.05, 0.02), (0.03, -0.05)])
def test_picture_corner_line_ends_where_a_models_line_crosses_that_of_the_step(draw, gap, free):
    models = ("penalty", "lcp", "implicit")
    seen = draw("corner-line", {"models": ",".join(models)}, {"gap": gap, "free": free})
    step = seen.curve("step-line")
    assert step[0] == pytest.approx([free, 0.0], abs=0.01)
    for model in models:
        end, lam = seen.mark(model)
        assert off_line((end, lam), seen.curve(f"m-{model}")) < 0.01
        assert off_line((end, lam), step) < 0.01
        assert of_model(model, seen.words) == pytest.approx(end, abs=1e-3)


@pytest.mark.parametrize("k, c", [(1e4, 80.0), (1e6, 80.0), (1e4, 0.0), (2000.0, 300.0)])
def test_picture_cliff_stands_at_its_limit_and_there_an_eigenvalue_leaves_the_circle(draw, k, c):
    critical = contact.critical_dt(1.0, k, c)
    for dt in (0.9 * critical, 1.1 * critical):
        seen = draw("cliff", {"dt": dt, "stiffness": k, "damping": c})
        assert seen.upright() == pytest.approx(1000 * critical, rel=0.01)
        label = next(t["text"] for t in seen.all("text", "strong") if "critical" in t["text"])
        assert said(label)[0] == pytest.approx(1000 * critical, rel=6e-3)
        line = seen.curve("m-penalty")
        before, beyond = (line[:, 0] < 990 * critical), (line[:, 0] > 1010 * critical)
        assert (line[before, 1] < 1e-5).all() or c == 0  # without a damper it swings on
        assert (line[beyond, 1] > (1e-5 if k < 1e6 else 2e-6)).all()
        (ring,) = seen.all("circle", "region")
        pair = seen.all("circle", "mark")[:2]
        far = max(math.hypot(m["cx"] - ring["cx"], m["cy"] - ring["cy"]) for m in pair)
        assert (far > ring["r"] + 0.5) == (dt > critical)
        step = [[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]]
        sizes = np.abs(np.linalg.eigvals(step))
        assert said(seen.words)[1] == pytest.approx(sizes.max(), rel=6e-3)


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
    assert seen.mark("lcp") == pytest.approx(walk[-1], abs=0.01)
    assert said(seen.words)[-2:] == pytest.approx(walk[-1], abs=0.06)


def test_picture_sweeps_walks_down_the_bowl_to_where_the_balls_are_stopped_one_way_sooner(draw):
    stopped = [1 + 10 * 1.3, 10 * 1.3]  # m g dt, for 1 and 10 kg
    seen, half = (draw("sweeps", {"momentum": 1}, {"v2": -1.3, "time": t}) for t in (160, 44))
    assert seen.mark("lcp") == pytest.approx(stopped, rel=0.02)
    for each in seen.all("path", "contour"):
        bowl = seen.seen(points(each["d"]))
        assert 0.5 * (bowl.min(0) + bowl.max(0)) == pytest.approx(stopped, rel=0.02)
    off = [np.hypot(*(half.mark(model) - stopped)) for model in ("lcp", "leapfrog")]
    told = said(half.words)
    assert told[0] == 22 and told[1] == pytest.approx(off[0], rel=0.1) and told[2] < 0.2 * told[1]
    assert off[1] < 0.3 * off[0]


def test_picture_sag_opens_where_its_law_holds_and_its_bars_are_what_it_says(draw):
    for own in ({}, {"iters": 4, "dt": 0.003}):
        seen = draw("sag", {}, own)
        bars = [seen.axes[0](bar["x"] + bar["width"]) for bar in seen.all("rect", "bar-fill")]
        deep, law = said(seen.words)[1:]
        assert len(bars) == said(seen.words)[0] and bars == sorted(bars, reverse=True)
        assert bars[0] / 1000 == pytest.approx(deep, rel=0.05)
        assert deep == pytest.approx(law, rel=0.1)  # as the text says


@pytest.mark.parametrize("mu", [2.0, 3.0, 0.0, 1.7])
def test_picture_rod_has_its_circles_where_the_line_crosses_zero(draw, mu):
    right = facts.friction()
    seen = draw("rod", {"mu": mu}, {"push": right["slides"] / 2})
    line = seen.curve("m-exact")
    pieces = [(a, b) for a, b in itertools.pairwise(line) if (a[1] > 0) != (b[1] > 0)]
    crossings = [a[0] + (b[0] - a[0]) * a[1] / (a[1] - b[1]) for a, b in pieces]
    circles = [seen.seen((c["cx"], c["cy"])) for c in seen.all("circle", "rule")][1:]
    assert [y for _, y in circles] == pytest.approx([0.0] * len(crossings), abs=0.01)
    assert [x for x, _ in circles] == pytest.approx(crossings, abs=0.01)
    assert off_line(seen.mark("exact"), line) < 0.01
    assert said(seen.words)[: len(crossings) + 1] == pytest.approx([0, *crossings], abs=0.01)
    if mu == 2.0:  # the text's
        answers = [0.0, right["slides"], right["jams"], right["jams"]]
        assert said(seen.words)[:4] == pytest.approx(answers, abs=0.01)
        assert seen.mark("exact")[1] == pytest.approx(right["rises"] / 2, abs=0.01)


@pytest.mark.parametrize("gap", [0.1, 0.35, 0.7])
def test_picture_set_back_has_paths_that_meet_at_the_impact_and_ends_where_it_says(draw, gap):
    seen = draw("set-back", {}, {"gap": gap})
    old, back = seen.curve("step-line"), seen.curve("drawn-back")
    new = seen.seen(points(seen.all("path", "m-leapfrog", "plainly")[0]["d"]))
    fallen = R * gap - 4.0 * 0.02 * old[-1, 0] - G / 2 * (0.02 * old[-1, 0]) ** 2
    assert [fallen, old[-1, 1]] == pytest.approx([0.0, 0.0], abs=0.01 * R)
    for line in (back[-1], new[0]):
        assert line == pytest.approx(old[-1], abs=0.01)
    ends = [(c["cx"], c["cy"]) for c in seen.all("circle", "mark", "m-leapfrog")]
    assert seen.seen(ends) == pytest.approx(np.array([back[0], new[-1]]), abs=0.01)
    assert said(seen.words) == pytest.approx([old[-1, 0], back[0, 1], new[-1, 1]], abs=0.01)
    assert seen.gap("ghost") == pytest.approx(back[0, 1], abs=0.02)


def test_picture_touching_row_flies_on_with_the_texts_velocities(draw):
    opens, early, late = (
        draw("touching-row", {}, own) for own in ({}, {"time": 0.6}, {"time": 0.8})
    )
    assert all(b["r"] <= b["cx"] <= 640 - b["r"] for b in opens.all("circle", "m-exact"))
    balls = zip(early.all("circle", "m-exact"), late.all("circle", "m-exact"))
    moved = [(b["cx"] - a["cx"]) * R / b["r"] / 0.2 for a, b in balls]
    right = [-1 / 3, 2 / 3, 2 / 3, 0.0, 0.0, 1.0]  # three that touch, and a micrometre apart
    assert moved == pytest.approx(right, abs=0.01)
    assert said(late.words) == pytest.approx(right, abs=0.01)


@pytest.mark.parametrize("d0", [0.9, 0.5, 0.0])
def test_picture_flicker_has_its_line_at_the_formula_and_no_force_only_beyond_it(draw, d0):
    seen = draw("flicker", {"d0": d0})
    formula = math.degrees(math.acos(2 * math.cos(0.1) / (3 - d0)))
    hill, force = seen.curve("step-line"), seen.curve("m-soft")
    below = hill[hill[:, 0] < 45]
    asks = 3 * np.cos(np.radians(below[:, 0])) - 2 * math.cos(0.1)
    assert below[:, 1] == pytest.approx(asks, abs=0.02)
    assert seen.upright() == pytest.approx(formula, abs=0.2)
    assert said(seen.words)[0] == pytest.approx(formula, abs=0.06)
    none = force[force[:, 1] < 0.005]
    assert (none[:, 0] > formula - 0.2).all()
    if d0:
        assert len(none) > 0.03 * len(force)
        assert said(seen.words)[1] == pytest.approx(none[0, 0], abs=0.2)
