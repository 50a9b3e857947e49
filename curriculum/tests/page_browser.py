"""Real browsers for the tests of the page: Debian's Chromium and Firefox, by Playwright.

python -m curriculum.tests.page_browser      # make the README's picture anew
"""

import contextlib
import functools
import os
import re
import shutil
import tempfile
from pathlib import Path

import pytest

from curriculum.commands import Parser, needs
from curriculum.source import ROOT

PICTURE = ROOT / "curriculum/page/page-live.png"
WAIT = 60  # s: longer than a busy machine needs for any command
PROGRAMS = {
    "chromium": ("chromium", "chromium-browser", "google-chrome"),
    "firefox": ("firefox-esr", "firefox"),
}
# what Firefox says of a formula that has not all arrived yet
HALF = "Incorrect number of children"


@contextlib.contextmanager
def running():
    """Give start("chromium") or "firefox", once each; a lacking one fails in CI, else it skips."""
    from playwright.sync_api import sync_playwright  # here, so that other tests do without it

    with sync_playwright() as playwright:

        @functools.cache
        def started(kind):
            path = next(filter(None, map(shutil.which, PROGRAMS[kind])), None)
            if not path:
                lacks = pytest.fail if os.environ.get("CI") else pytest.skip
                lacks(f"no {kind} here: apt-get install {PROGRAMS[kind][0]}")
            if kind == "chromium":
                return playwright.chromium.launch(executable_path=path)
            how = {"channel": "moz-firefox"}  # Mozilla's, with Playwright's own reduced_motion
            still = {"ui.prefersReducedMotion": 1}
            return playwright.firefox.launch(executable_path=path, firefox_user_prefs=still, **how)

        yield started


@contextlib.contextmanager
def visiting(browser, url, **options):
    """Open the page in a fresh profile. Fails if it complains, throws, or asks for more."""
    width, height = options.pop("width", 1280), options.pop("height", 800)
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
    told = [each for each in trouble if HALF not in each]
    assert not told, told


def photograph(page):
    """Save the README's picture: the figure with all models, just after the landing."""
    shown = page.locator("[data-figure=falls][data-given*=soft][data-given*=exact]").last
    shown.scroll_into_view_if_needed()
    time = shown.get_by_label("the time shown")
    for key in ("End", *["Shift+ArrowLeft"] * 15):
        time.press(key)
    time.blur()
    page.wait_for_timeout(300)
    page.screenshot(path=PICTURE, clip=shown.locator("svg.plot").bounding_box())


if __name__ == "__main__":
    Parser(prog="python -m curriculum.tests.page_browser", description=__doc__).parse_args()
    with needs("dev"), tempfile.TemporaryDirectory() as folder, running() as start:
        from curriculum.page.build import build

        file = Path(folder, "contact.html")
        file.write_text(build(), "utf-8")
        with visiting(start("chromium"), file.as_uri(), width=720, device_scale_factor=2) as page:
            photograph(page)
