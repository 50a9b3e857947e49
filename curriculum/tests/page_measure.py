"""The README's picture of the page."""

from curriculum.tests.page_browser import call, opened

PICTURE = "page-live.png"  # of the README
# a drop just after the landing, by all models
MOMENT = """(id) => document.querySelector(`#${id} [aria-label="the time shown"]`).focus()"""


def photograph(page, folder):
    """Save PICTURE in a folder: the figure with all models, just after the landing; its path."""
    with opened(page, width=720, device_scale_factor=2) as tab:
        shown = tab.locator("[data-figure=falls][data-given*=soft][data-given*=exact]").last
        shown.scroll_into_view_if_needed()
        tab.wait_for_timeout(500)
        call(tab, MOMENT, shown.get_attribute("id"))
        for _ in range(3):  # ten steps each
            tab.keyboard.press("Shift+ArrowRight")
        tab.evaluate("document.activeElement.blur()")
        tab.wait_for_timeout(300)
        box = shown.locator("svg.plot").bounding_box()
        box |= {"y": box["y"] + 0.22 * box["height"], "height": 0.78 * box["height"]}
        tab.screenshot(path=folder / PICTURE, clip=box)
    return folder / PICTURE
