"""A real browser, for the page's picture and its tests: Debian's Chromium, driven by Playwright."""

import shutil

CHROMIUM = next(
    (path for path in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if path),
    None,
)
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def photograph(page, picture):
    """Save the first screen of the HTML file `page` (1280 x 900, nothing moving) as a PNG."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        tab = browser.new_page(viewport={"width": 1280, "height": 900}, reduced_motion="reduce")
        tab.goto(page.resolve().as_uri())
        tab.wait_for_timeout(1500)  # ms: the figure draws itself
        tab.screenshot(path=picture)
        browser.close()
