"""Still pictures for readers without scripts, drawn by the page's own JavaScript while it is built.

The picture is written once, in JavaScript. Here the same files run in an embedded V8 (mini-racer):
the parts that compute and draw touch no document, so they need no browser.
"""

import functools
import json
from pathlib import Path

from py_mini_racer import MiniRacer

HERE = Path(__file__).resolve().parent
DRAWING = ("exact.js", "engine.js", "plot.js", "lane.js", "state.js", "small_figures.js")


def engine(data=None, scripts=DRAWING):
    """A V8 with the page's computing and drawing parts; `data` is the object PAGE."""
    v8 = MiniRacer()
    v8.eval(f"const PAGE = {json.dumps(data or {}, sort_keys=True)};")
    for name in scripts:
        v8.eval((HERE / name).read_text(encoding="utf-8"))
    return v8


def stills(data):
    """{start, end: the lanes; small: the small figures; keys; knobs: ranges; size} as still.js has them."""
    return json.loads(_drawn(json.dumps(data, sort_keys=True)))


@functools.cache
def _drawn(data):
    """The stills for some data, as text: drawn once however often the page is built."""
    v8 = engine(json.loads(data), (*DRAWING, "still.js"))
    return v8.eval("JSON.stringify(Stills.all())")
