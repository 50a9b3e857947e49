"""A real browser for the page's tests: Debian's Chromium, driven by Playwright, offline."""

import contextlib
import functools
from pathlib import Path

import pytest

from curriculum.page.browser import CHROMIUM, FLAGS

needs_chromium = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium here: apt-get install chromium"
)
SHOWN = """for (const id of ["ex1", "ex3", "ex4"])
  localStorage.setItem(`contact-chapter:${id}`, '{"shown": true}');"""


@functools.cache
def small_page():
    """The page of a short chapter that holds every kind of slot, link and number; built once."""
    from curriculum.page.build import build

    return build(chapter=Path(__file__).with_name("page_chapter.md").read_text("utf-8"))


@contextlib.contextmanager
def running():
    """A browser, closed at the end."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        yield browser
        browser.close()


@contextlib.contextmanager
def visiting(
    browser,
    url,
    width=1280,
    height=900,
    query="",
    motion="reduce",
    javascript=True,
    shown=True,
    **options,
):
    """A fresh profile on the page. Fails if the page complains, throws, or asks for anything but itself.

    `shown`: as for a reader who has asked to see the answers of the bets.
    """
    context = browser.new_context(
        viewport={"width": width, "height": height},
        reduced_motion=motion,
        java_script_enabled=javascript,
        **options,
    )
    if shown:
        context.add_init_script(f"if (!sessionStorage.seen) {{ sessionStorage.seen = 1; {SHOWN} }}")
    page = context.new_page()
    page.set_default_timeout(10_000)
    trouble = []
    page.on(
        "console",
        lambda message: (
            trouble.append(f"console: {message.text}")
            if message.type in ("error", "warning")
            else None
        ),
    )
    page.on("pageerror", lambda error: trouble.append(f"error: {error}"))
    page.on(
        "request",
        lambda request: (
            trouble.append(f"request: {request.url[:100]}")
            if not request.url.startswith(("data:", url))
            else None
        ),
    )
    page.goto(url + query)
    yield page
    context.close()
    assert not trouble, trouble
