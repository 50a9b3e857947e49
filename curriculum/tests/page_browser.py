"""Real browsers for the page: Debian's Chromium and Firefox."""

import contextlib
import itertools
import json
import os
import re
import shutil
import subprocess

import pytest

WAIT = 60  # s: longer than a busy machine needs for any command


def program(*names):
    """The path of a browser; one that lacks is a fault where all is tested, else a test less."""
    found = next(filter(None, map(shutil.which, names)), None)
    if not found:
        lack = pytest.fail if os.environ.get("CI") else pytest.skip
        lack(f"{names[0]} is missing here: apt-get install {names[0]}")
    return found


@contextlib.contextmanager
def running():
    """A Chromium, driven by Playwright, closed at the end."""
    from playwright.sync_api import sync_playwright

    path = program("chromium", "chromium-browser", "google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def browser():
    """A Chromium."""
    with running() as found:
        yield found


@contextlib.contextmanager
def visiting(browser, url, width=1280, height=900, **options):
    """A fresh profile on the page. Fails if it complains, throws, or asks for more than itself."""
    options = {"viewport": {"width": width, "height": height}, "reduced_motion": "reduce"} | options
    context = browser.new_context(**options)
    page = context.new_page()
    page.set_default_timeout(1000 * WAIT)
    trouble, own = [], ("data:", "blob:", re.split("[?#]", url)[0])
    page.on("console", lambda told: told.type in ("error", "warning") and trouble.append(told.text))
    page.on("pageerror", lambda error: trouble.append(f"error: {error}"))
    page.on("request", lambda asked: asked.url.startswith(own) or trouble.append(asked.url[:100]))
    page.goto(url)
    if options.get("java_script_enabled", True):
        page.wait_for_selector("[data-ready]", state="attached")
    yield page
    context.close()
    assert not trouble, trouble


class Tab:
    """One tab of a running Firefox, over WebDriver BiDi, with the methods of a Playwright page:
    Playwright drives a Firefox of its own, and no other."""

    def __init__(self, socket):
        self.socket, self.numbers, self.trouble, self.mouse = socket, itertools.count(), [], self
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded"])
        self.context = self.call("browsingContext.create", type="tab")["context"]

    def call(self, method, **params):
        """A command's result; what the page logs meanwhile is kept."""
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while (answer := json.loads(self.socket.recv(timeout=WAIT))).get("id") != number:
            entry = answer.get("params", {})
            if entry.get("level") in ("error", "warn"):
                self.trouble.append(entry["text"])
        assert answer["type"] != "error", f"{method}: {answer.get('message')}"
        return answer["result"]

    def set_viewport_size(self, size):
        self.call("browsingContext.setViewport", context=self.context, viewport=size)

    def goto(self, url):
        self.call("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def evaluate(self, script, given=None):
        """The value of a JavaScript expression, or of such a function, as JSON carries it."""
        value = f"(it instanceof Function ? it({json.dumps(given)}) : it)"
        told = f"(async (it) => JSON.stringify(await {value}) ?? 'null')({script})"
        where = {"target": {"context": self.context}, "awaitPromise": True}
        answer = self.call("script.evaluate", expression=told, **where)
        assert answer["type"] != "exception", answer.get("exceptionDetails", {}).get("text")
        return json.loads(answer["result"]["value"])

    def act(self, kind, **more):
        source = {"type": "pointer", "id": "mouse", "actions": [{"type": kind, **more}]}
        self.call("input.performActions", context=self.context, actions=[source])

    def move(self, x, y, **_):
        self.act("pointerMove", x=round(x), y=round(y))

    def down(self):
        self.act("pointerDown", button=0)

    def up(self):
        self.act("pointerUp", button=0)


@pytest.fixture(scope="session")
def gecko(tmp_path_factory):
    """A tab of a Firefox with a fresh profile."""
    from websockets.sync.client import connect

    profile = tmp_path_factory.mktemp("firefox")
    (profile / "user.js").write_text('user_pref("ui.prefersReducedMotion", 1);', "utf-8")
    command = [program("firefox-esr", "firefox"), "--headless", "--no-remote"]
    command += ["--profile", profile, "--remote-debugging-port", "0"]
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.DEVNULL, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        try:
            found = (re.search(r"ws://[\d.:]+", line) for line in process.stderr)
            with connect(f"{next(filter(None, found))[0]}/session", max_size=None) as socket:
                yield Tab(socket)
        finally:
            process.terminate()


# ---- what tests do in either browser

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
FIGURES = "[...document.querySelectorAll('.fig')].map(({ id }) => id)"
# the middle of a figure's last handle, once it is in sight
MIDDLE = f"""async (id) => {{
  const handle = [...(await ({SEE})(id)).querySelectorAll(".handle")].pop();
  if (!handle) return null;
  const {{ x, y, width, height }} = handle.querySelector("circle").getBoundingClientRect();
  return [x + width / 2, y + height / 2];
}}"""
WORDS = f"""async (id) => {{
  {FRAMES}
  return document.querySelector(`#${{id}} .words`).textContent;
}}"""
MOVES = ((-12, 12), (24, -24), (70, -60), (-70, 60))  # px: to and fro, for what stands at an end


def drag(page, x, y, moves=MOVES):
    """Press at a place, and draw what lies there to and fro; a move at a time."""
    page.mouse.move(x, y)
    page.mouse.down()
    for dx, dy in moves:
        page.mouse.move(x + dx, y + dy, steps=2)
        yield
    page.mouse.up()


def swipe(page, x, y, moves=MOVES):
    """The same with a finger, since Playwright's own can only tap."""
    session = page.context.new_cdp_session(page)
    kinds = ["touchStart", *["touchMove"] * len(moves), "touchEnd"]
    for kind, (dx, dy) in zip(kinds, [(0, 0), *moves, (0, 0)]):
        points = [{"x": x + dx, "y": y + dy}] if kind != "touchEnd" else []
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        page.wait_for_timeout(30)
        yield
