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


# the README's pictures: a bounce and its energy beside the text, and one small figure; no bet is told
PICTURES = ("page-live.png", "page-small.png")
SHOWN = """for (const id of ["ex1", "ex3", "ex4"])
  localStorage.setItem(`contact-chapter:${id}`, '{"shown": true}');"""


def photograph(page, folder):
    """Save PICTURES of the HTML file `page` (1280 x 800, nothing moving) in a folder; their paths."""
    from playwright.sync_api import sync_playwright

    live, small = (folder / name for name in PICTURES)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        tab = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
        tab.add_init_script(SHOWN)
        tab.goto(page.resolve().as_uri() + "?scene=bounce&contact=lcp&t=0.84")
        tab.check('input[name="chart"][value="energy"]', force=True)
        tab.locator("#see-it-work").evaluate("(node) => node.scrollIntoView({block: 'center'})")
        tab.wait_for_timeout(1000)  # ms: the figures draw themselves
        tab.screenshot(path=live)
        tab.locator("#fig-slide").scroll_into_view_if_needed()
        tab.wait_for_timeout(1000)
        tab.locator("#fig-slide").screenshot(path=small)
        browser.close()
    return [live, small]
