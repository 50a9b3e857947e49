"""Browsers as fixtures, and what tests do in them."""

import os

import pytest

from curriculum.page.browser import running


@pytest.fixture(scope="session")
def start():
    """The function that starts a browser; one that lacks is a fault in CI, else a test less."""
    with running() as found:

        def start_or_skip(kind):
            try:
                return found(kind)
            except OSError as error:
                (pytest.fail if os.environ.get("CI") else pytest.skip)(str(error))

        yield start_or_skip


@pytest.fixture(scope="session")
def browser(start):
    """A Chromium."""
    return start("chromium")


@pytest.fixture(scope="session")
def firefox(start):
    """A Firefox."""
    return start("firefox")


# ---- what tests do in either browser

FRAMES = "for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame);"
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
# what a figure says, and how high it and all before it are
STATE = f"""async (id) => {{
  {FRAMES}
  const fig = document.getElementById(id);
  return [fig.querySelector(".words").textContent, fig.offsetHeight, fig.offsetTop, scrollY];
}}"""
MOVES = ((24, -24), (70, -60), (-70, 60))  # px: to and fro, for what stands at an end


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
