"""Figures of the page drawn without a browser, and how to read such a drawing."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from py_mini_racer import MiniRacer

from curriculum.page.build import page_data
from curriculum.page.bundle import bundle

PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")  # how print sets minus and powers


def figures():
    """(a function that evaluates JavaScript with page_view.js, the engine, to be closed)."""
    engine, data = MiniRacer(), page_data([])
    parts = {name: bundle(f"{name.lower()}.js", data) for name in ("STORE", "ENGINE", "FIGURES")}
    view = Path(__file__).with_name("page_view.js").read_text("utf-8")
    engine.eval("".join(f"const {name} = {text};\n" for name, text in parts.items()) + view)
    return (lambda call: json.loads(engine.eval(f"JSON.stringify({call})"))), engine


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
    if "h" in shape["d"]:  # leapfrog's cross at the left of its upper arm
        x, y, h, v = map(float, re.match(r"M(\S+) ([\d.]+)h([\d.]+)v([\d.]+)", shape["d"]).groups())
        return np.array([x + h / 2, y + v + h / 2])
    corners = re.findall(r"([-\d.]+) ([-\d.]+)", shape["d"].partition("Z")[0])
    return np.array(corners, float).mean(0)


def arrow(shape):
    """(from, to) of an arrow."""
    points = np.array(re.findall(r"([-\d.]+) ([-\d.]+)", shape["d"]), float)
    return points[0], points[2]
