"""The README's picture of the page."""

from curriculum.page.browser import running, visiting

PICTURE = "page-live.png"  # of the README


def photograph(file, folder):
    """Save PICTURE in a folder: the figure with all models, just after the landing; its path."""
    address, more = file.resolve().as_uri(), {"width": 720, "device_scale_factor": 2}
    with running() as start, visiting(start("chromium"), address, **more) as page:
        shown = page.locator("[data-figure=falls][data-given*=soft][data-given*=exact]").last
        shown.scroll_into_view_if_needed()
        time = shown.get_by_label("the time shown")
        for key in ("End", *["Shift+ArrowLeft"] * 15):
            time.press(key)
        time.blur()
        page.wait_for_timeout(300)
        page.screenshot(path=folder / PICTURE, clip=shown.locator("svg.plot").bounding_box())
    return folder / PICTURE
