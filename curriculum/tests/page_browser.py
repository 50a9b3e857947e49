"""Real browsers for the tests of the page: Debian's Chromium and Firefox, by Playwright."""

import contextlib
import functools
import os
import re
import shutil

import pytest

WAIT = 60  # s: longer than a busy machine needs for any command
PROGRAMS = {
    "chromium": ("chromium", "chromium-browser", "google-chrome"),
    "firefox": ("firefox-esr", "firefox"),
}
# what Firefox says of a formula that has not all arrived yet
HALF = "Incorrect number of children"


@pytest.fixture(scope="session")
def start():
    """start("chromium") or "firefox", once: a lacking one is a fault in CI, else a test less."""
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
            how = {
                "channel": "moz-firefox"
            }  # Mozilla's; of Playwright's own it takes reduced_motion
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
