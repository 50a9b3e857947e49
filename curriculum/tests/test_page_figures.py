"""The explaining figures: what each draws is what contact.py computes, and no ball of one is lost.

They are drawn without a page, as the stills are; hands are tried in browsers, in test_page.py."""

import json
import re
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from py_mini_racer import MiniRacer

import contact
from curriculum.implicit import implicit_step
from curriculum.page.build import page_data
from curriculum.page.bundle import bundle, evaluate
from curriculum.page.chapter import CHAPTER
from curriculum.regions import ROOT

SLOT = re.compile(r"<!-- figure: ([\w-]+) -->")
SLOTS = sorted(set(SLOT.findall((ROOT / CHAPTER).read_text("utf-8"))))
PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")  # how print sets minus and powers
R, G = contact.RADIUS, -contact.GRAVITY
START = contact.build_scene("drop").q0[1, 0]
# a view as stage.js gives it, of a figure that a hand holds; moved(): as a hand leaves it
VIEW = """
const Section = STORE.Section, figures = FIGURES.figures;
const viewOf = (name, changes, own, width) => {
  const figure = figures[name], section = new Section("any", changes);
  const view = {
    own: { ...(figure.start ? figure.start() : {}), ...own }, width, figure, near: true,
    height: (width < 480 && figure.narrow) || figure.height, still: true, grabbed: null,
    get values() { return section.values; }, get: section.get, set: section.set,
    open: () => true, flick: () => [9999, -9999], stop() {}, run() {}, box: null,
    play() { const { from = 0, end } = figure.clock(view); view.own.time = (from + end) / 2; },
  };
  return view;
};
const drawn = (view) => {
  const { svg, words, handles } = view.figure.draw(view);
  return { svg, words, handles: handles.map(({ name, x, y }) => ({ name, x, y })) };
};
const lost = (name, width) => {
  const found = new Set(), view = viewOf(name, {}, {}, width);
  const look = (after) => {
    for (const { name, x, y } of view.figure.draw(view).handles)
      if (!(x >= 0 && x <= width && y >= 0 && y <= view.height)) found.add(`${name} ${after}`);
  };
  const hold = (handle, x, y) => {
    view.from = view.figure.draw(view).handles.find((each) => each.name === handle);
    view.grabbed = handle;
    if (view.from) view.from.drag(x, y);
  };
  const uses = new Set(view.figure.knobs), { get } = view;
  view.get = (knob) => get(uses.add(knob) && knob);
  const { handles } = view.figure.draw(view);
  const extremes = { dt: [0.0005, 0.064], stiffness: [100, 1e6], restitution: [0, 1],
    damping: [0, 300], baumgarte: [0, 1], iters: [1, 100], warm: [0, 1] };
  const used = Object.entries(extremes).filter(([knob]) => uses.has(knob));
  for (const handle of [...handles.slice(0, 2), handles[handles.length - 1]])
    for (const [x, y] of [[-900, -900], [1900, 1900]])
      for (const [knob, values] of [...used, ["dt", []]])
        for (const value of values.length ? values : [view.values[knob]]) {
          hold(handle.name, x, y);
          look(`held at ${x}, ${y}`);
          view.set({ [knob]: value });
          look(`held at ${x}, ${y} while ${knob} becomes ${value}`);
          view.figure.draw(view).handles.find((each) => each.name === view.grabbed)?.release?.();
          view.grabbed = null;
          look(`let go at ${x}, ${y} with ${knob} = ${value}`);
          if (values.length) view.set({ [knob]: values[0] });
          look(`let go at ${x}, ${y}, then ${knob} less`);
        }
  return [...found];
};
"""


@pytest.fixture(scope="module")
def v8():
    """The figures in an engine without a page."""
    engine, data = MiniRacer(), page_data([])
    parts = {name: bundle(f"{name.lower()}.js", data) for name in ("STORE", "FIGURES")}
    engine.eval("".join(f"const {name} = {text};\n" for name, text in parts.items()) + VIEW)
    yield lambda call: json.loads(engine.eval(f"JSON.stringify({call})"))
    engine.close()


@pytest.fixture
def draw(v8):
    """draw(name, {quantity: value}, {own: value}): the Drawing."""

    def drawing(name, changes=None, own=None, width=640):
        given = ", ".join(json.dumps(each) for each in (name, changes or {}, own or {}, width))
        return Drawing(v8(f"drawn(viewOf({given}))"))

    return drawing


def numbers(text):
    """The numbers in a text as a figure writes them."""
    plain = text.replace(" × 10", "e").translate(PLAIN)
    plain = re.sub(r"(?<=\d),(?=\d{3}\b)", "", plain)
    return [float(each) for each in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", plain)]


class Drawing:
    """A figure's drawing, to be read: its shapes by class, its labels, and its axes."""

    def __init__(self, made):
        self.words, self.handles = made["words"], made["handles"]
        self.root = ElementTree.fromstring(f"<svg>{made['svg']}</svg>")

    def shapes(self, kind):
        """The shapes with these classes, each as {attribute: number or text}."""
        wanted = set(kind.split())
        found = [node for node in self.root.iter() if wanted <= set(node.get("class", "").split())]
        return [{k: number(v) for k, v in node.items()} for node in found]

    def labels(self, pattern=""):
        """The texts that hold a pattern, in order."""
        texts = ["".join(node.itertext()).replace("\u200b", "") for node in self.root.iter("text")]
        return [text for text in texts if re.search(pattern, text)]

    def axes(self, log="", top=0):
        """Two functions, from px to what the axes say, by their ticks below `top`."""
        ticks = [node for node in self.root.iter("text") if node.get("class") == "tick"]
        ticks = [node for node in ticks if float(node.get("y")) > top]
        low = max(float(node.get("y")) for node in ticks if node.get("text-anchor") == "middle")
        found = []
        for key, anchor, away in (("x", "middle", 0), ("y", "end", 5)):
            own = [node for node in ticks if node.get("text-anchor") == anchor]
            own = [n for n in own if n.text and (key == "y" or float(n.get("y")) == low)]
            told = [power(node.text) for node in own]
            pairs = [(v, float(n.get(key)) - away) for v, n in zip(told, own) if v is not None]
            pairs = [pair for pair in pairs if pair[0] > 0 or key not in log]
            values, places = zip(*pairs)
            values = np.log(values) if key in log else np.array(values)
            slope, start = np.polyfit(places, values, 1)
            fit = lambda px, a=slope, b=start, k=key: (np.exp if k in log else float)(a * px + b)  # noqa: E731
            found.append(fit)
        return found


def number(text):
    """A number, or a text that is none."""
    try:
        return float(text)
    except ValueError:
        return text


def power(text):
    """The number of a tick, 10⁻³ included."""
    raised = re.fullmatch(r"10([⁻⁰-⁹¹²³]+)", text)
    return 10.0 ** int(raised[1].translate(PLAIN)) if raised else number(text.translate(PLAIN))


def place(shape):
    """The middle of a marker: of the corners of its path."""
    if "cx" in shape:
        return np.array([shape["cx"], shape["cy"]])
    if "a" in shape["d"]:  # lcp's disc begins at its left
        x, y, r = map(float, re.match(r"M([-\d.]+) ([-\d.]+)a([\d.]+)", shape["d"]).groups())
        return np.array([x + r, y])
    corners = re.findall(r"([-\d.]+) ([-\d.]+)", shape["d"].partition("Z")[0])
    return np.array(corners, float).mean(0)


def arrow(shape):
    """(from, to) of an arrow."""
    points = np.array(re.findall(r"([-\d.]+) ([-\d.]+)", shape["d"]), float)
    return points[0], points[2]


def test_every_figure_has_a_slot_in_the_chapter_and_every_slot_a_figure():
    assert sorted(evaluate("still.js", page_data([]), "settable()")["names"]) == SLOTS


@pytest.mark.parametrize("name", SLOTS)
def test_nothing_that_can_be_held_leaves_the_picture_whatever_hand_and_knobs_do(v8, name):
    """Also where a knob changes while it is held, and after it was let go."""
    assert v8(f"lost({json.dumps(name)}, 358)") == []
