"""Real browsers for the page: Debian's Chromium and Firefox."""

import contextlib
import os
import re
import shutil

import pytest

WAIT = 60  # s: longer than a busy machine needs for any command
# what Firefox says of a formula that has not all arrived yet
HALF = "Invalid markup: Incorrect number of children"


def program(*names):
    """The path of a browser; one that lacks is a fault where all is tested, else a test less."""
    found = next(filter(None, map(shutil.which, names)), None)
    if not found:
        lack = pytest.fail if os.environ.get("CI") else pytest.skip
        lack(f"{names[0]} is missing here: apt-get install {names[0]}")
    return found


PROGRAMS = {
    "chromium": ("chromium", "chromium-browser", "google-chrome"),
    "firefox": ("firefox-esr", "firefox"),
}


@contextlib.contextmanager
def running():
    """A function that starts a "chromium" or a "firefox", driven by Playwright until the end."""
    from playwright.sync_api import sync_playwright

    def start(kind):
        path = program(*PROGRAMS[kind])
        if kind == "chromium":
            return playwright.chromium.launch(executable_path=path)
        how = {"channel": "moz-firefox"}  # Mozilla's; of Playwright's own it takes reduced_motion
        still = {"ui.prefersReducedMotion": 1}
        return playwright.firefox.launch(executable_path=path, firefox_user_prefs=still, **how)

    with sync_playwright() as playwright:
        yield start


@pytest.fixture(scope="session")
def start():
    """The function that starts a browser."""
    with running() as found:
        yield found


@pytest.fixture(scope="session")
def browser(start):
    """A Chromium."""
    return start("chromium")


@pytest.fixture(scope="session")
def firefox(start):
    """A Firefox."""
    return start("firefox")


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
    assert [each for each in trouble if HALF not in each] == []


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
