"""Still pictures for readers without scripts, drawn by the page's own figures while it is built."""

import json

from py_mini_racer import MiniRacer

from curriculum.page.bundle import bundle


def stills(data):
    """{figures, keys, ranges} of still.js, which runs the figures in an embedded V8."""
    engine = MiniRacer()
    try:
        engine.eval(f"const still = {bundle('still.js', data)};")
        return json.loads(engine.eval("JSON.stringify(still.stills())"))
    finally:
        engine.close()  # its thread would keep Python from ending
