"""Real browsers for the page: Debian's Chromium and Firefox."""

import contextlib
import json
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

QUIET = {  # of Firefox: no request of its own
    "remote.active-protocols": 1,
    "datareporting.policy.dataSubmissionEnabled": False,
    "app.update.enabled": False,
    "app.normandy.enabled": False,
    "browser.aboutwelcome.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "ui.prefersReducedMotion": 1,
}
WAIT = 60  # s: longer than a busy machine needs for any command


def program(*names):
    """The path of the first program of these names that is installed, or None."""
    return next(filter(None, map(shutil.which, names)), None)


CHROMIUM = program("chromium", "chromium-browser", "google-chrome")


def lack(what, package):
    """What a missing browser is: a fault where everything shall be tested, else a test less."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(
        f"no {what} here: apt-get install {package}"
    )


@contextlib.contextmanager
def running():
    """A Chromium, driven by Playwright, closed at the end."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def browser():
    """A Chromium."""
    if not CHROMIUM:
        lack("Chromium", "chromium")
    with running() as found:
        yield found


@contextlib.contextmanager
def visiting(browser, url, width=1280, height=900, motion="reduce", javascript=True, **options):
    """A fresh profile on the page. Fails if it complains, throws, or asks for more than itself."""
    context = browser.new_context(
        viewport={"width": width, "height": height},
        reduced_motion=motion,
        java_script_enabled=javascript,
        **options,
    )
    page = context.new_page()
    page.set_default_timeout(60_000)  # ms: a busy machine takes long to load a page
    trouble, own = [], ("data:", "blob:", re.split("[?#]", url)[0])

    def listen(message):
        if message.type in ("error", "warning"):
            trouble.append(f"console: {message.text}")

    page.on("console", listen)
    page.on("pageerror", lambda error: trouble.append(f"error: {error}"))
    page.on("request", lambda asked: asked.url.startswith(own) or trouble.append(asked.url[:100]))
    page.goto(url)
    if javascript:
        page.wait_for_selector("[data-ready]", state="attached")
    yield page
    context.close()
    assert not trouble, trouble


@contextlib.contextmanager
def opened(file, query="", **options):
    """An HTML file in a Chromium of its own, for those who are no tests."""
    with running() as chromium:
        with visiting(chromium, file.resolve().as_uri() + query, **options) as page:
            yield page


FRAMES = "for (let k = 0; k < 3; k++) await new Promise(requestAnimationFrame);"
# a figure in the middle of the window, alive
SEE = f"""async (id) => {{
  const fig = document.getElementById(id);
  fig.scrollIntoView({{ block: "center" }});
  for (let k = 0; k < 99 && !fig.querySelector(".back"); k++)
    await new Promise(requestAnimationFrame);
  {FRAMES}
  return fig;
}}"""
# in every figure: what lies at the middle of each button, knob and handle, if not that
HITS = f"""(async () => {{
  const [wrong, see] = [[], {SEE}];
  for (const {{ id }} of document.querySelectorAll(".fig")) {{
    const fig = await see(id);
    for (const node of fig.querySelectorAll(".handle, button:not(:disabled), input")) {{
      const part = node.querySelector(".knob-dot, circle") ?? node;
      part.scrollIntoView({{ block: "center" }});
      const box = part.getBoundingClientRect();
      const at = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
      const other = node.matches(".handle") && at?.closest(".handle");
      if (!node.contains(at) && !(other && fig.contains(other)))
        wrong.push([id, node.outerHTML.slice(0, 90), at?.outerHTML.slice(0, 90)]);
    }}
  }}
  return wrong;
}})()"""
FIGURES = "() => [...document.querySelectorAll('.fig')].map(({ id }) => id)"
# the middle of a figure's last handle that can be grabbed there, or first, once it is in sight
MIDDLE = f"""async (id, first) => {{
  const fig = await ({SEE})(id);
  const handles = [...fig.querySelectorAll(".handle")];
  const all = (first ? handles : handles.reverse()).map((handle) => {{
    const part = handle.querySelector(".knob-dot, circle");
    const {{ x, y, width, height }} = part.getBoundingClientRect();
    const middle = [x + width / 2, y + height / 2];
    return handle.contains(document.elementFromPoint(...middle)) && middle;
  }});
  return all.find(Boolean) ?? null;
}}"""
WORDS = f"""async (id) => {{
  {FRAMES}
  return document.querySelector(`#${{id}} .words`).textContent;
}}"""
MOVES = ((-12, 12), (24, -24), (70, -60), (-70, 60))  # px: to and fro, for what stands at an end


def call(page, function, *given):
    """What a JavaScript function gives, in either browser."""
    return page.evaluate(f"({function})({', '.join(map(json.dumps, given))})")


def pointer_of(page, touch):
    """A function that does "Down", "Move" or "Up" at a place, with the mouse or with a finger."""
    if isinstance(page, Tab):
        return page.pointer
    if not touch:

        def mouse(kind, x, y):
            page.mouse.move(x, y, steps=2)
            if kind != "Move":
                getattr(page.mouse, kind.lower())()

        return mouse
    session = page.context.new_cdp_session(page)

    def finger(kind, x, y):
        kind = {"Down": "Start", "Up": "End"}.get(kind, kind)
        at = [] if kind == "End" else [{"x": x, "y": y}]
        session.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": at})
        page.wait_for_timeout(30)

    return finger


def drag(page, x, y, moves=MOVES, touch=False):
    """Press at a place of either browser, and draw what lies there to and fro; a move at a time."""
    does = pointer_of(page, touch)
    does("Down", x, y)
    to = x, y
    try:
        for dx, dy in moves:
            to = x + dx, y + dy
            does("Move", *to)
            yield
    finally:
        does("Up", *to)


class Tab:
    """One tab of a running Firefox, over WebDriver BiDi: no driver program is needed."""

    def __init__(self, socket):
        self.socket, self.last, self.trouble = socket, 0, []
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded"])
        self.context = self.call("browsingContext.create", type="tab")["context"]

    def call(self, method, **params):
        """A command's result; what the page logs meanwhile is kept."""
        self.last += 1
        self.socket.send(json.dumps({"id": self.last, "method": method, "params": params}))
        while True:
            answer = json.loads(self.socket.recv(timeout=WAIT))
            if answer.get("method") == "log.entryAdded":
                entry = answer["params"]
                if entry["level"] in ("error", "warn"):
                    self.trouble.append(entry["text"])
            elif answer.get("id") == self.last:
                assert answer["type"] != "error", f"{method}: {answer.get('message')}"
                return answer["result"]

    def resize(self, width, height=800):
        size = {"width": width, "height": height}
        self.call("browsingContext.setViewport", context=self.context, viewport=size)

    def visit(self, url):
        self.resize(1280)
        self.call("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def evaluate(self, script):
        """The value of a JavaScript expression, as JSON carries it."""
        told = f"Promise.resolve({script}).then((value) => JSON.stringify(value))"
        target = {"context": self.context}
        answer = self.call("script.evaluate", expression=told, target=target, awaitPromise=True)
        assert answer["type"] != "exception", answer.get("exceptionDetails", {}).get("text")
        return json.loads(answer["result"]["value"]) if "value" in answer["result"] else None

    def pointer(self, kind, x, y):
        """Move the mouse to a place, and there press it ("Down") or release it ("Up")."""
        actions = [{"type": "pointerMove", "x": round(x), "y": round(y)}]
        if kind != "Move":
            actions.append({"type": f"pointer{kind}", "button": 0})
        source = {"type": "pointer", "id": "mouse", "actions": actions}
        self.call("input.performActions", context=self.context, actions=[source])


def resize(page, width):
    """Make the window of either browser so wide."""
    if isinstance(page, Tab):
        page.resize(width)
    else:
        page.set_viewport_size({"width": width, "height": 800})


@pytest.fixture(scope="session")
def gecko():
    """A tab of a Firefox with a fresh profile."""
    from websockets.sync.client import connect

    firefox = program("firefox-esr", "firefox")
    if not firefox:
        lack("Firefox", "firefox-esr")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});" for k, v in QUIET.items()]
        Path(profile, "user.js").write_text("\n".join(lines), encoding="utf-8")
        command = [firefox, "--headless", "--no-remote", "--profile", profile]
        command += ["--remote-debugging-port", "0"]
        pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.DEVNULL, "text": True}
        process = subprocess.Popen(command, **pipes)
        try:
            found = (re.search(r"ws://[\d.:]+", line) for line in process.stderr)
            with connect(f"{next(filter(None, found))[0]}/session", max_size=None) as socket:
                yield Tab(socket)
        finally:
            process.terminate()
            process.wait(WAIT)
            process.stderr.close()
