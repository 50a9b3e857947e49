"""What is done with the page in a browser: the README's picture, and where pictures stand."""

from curriculum.tests.page_browser import opened

PICTURE = "page-live.png"  # of the README
# the live figure stands also where the text has no use for it, and no other one in its place
STANDING = """.centred { visibility: hidden }
.live { opacity: 1 !important; visibility: visible !important }"""
# pictures, and passages beside which the live figure stands: [top, bottom, where]
PICTURES = ".fig:not(#fig-lanes) .drawing, .generated img, .show svg"
BESIDE = ", .beside"  # in a window that has room for it
BOXES = """(nodes) => nodes.map((node) => {
  const { top, bottom } = node.getBoundingClientRect();
  return [top, bottom, node.closest("[id]").id];
})"""


def photograph(page, folder):
    """Save PICTURE in a folder, the balls just after the landing; its path."""
    with opened(page, "?scene=drop", device_scale_factor=2) as tab:
        tab.add_style_tag(content=STANDING)
        tab.locator("#figure").scroll_into_view_if_needed()
        tab.locator("#fig-lanes .handle[data-handle=time]").focus()
        for _ in range(8):  # from 0.3 s on, ten steps each
            tab.keyboard.press("Shift+ArrowRight")
        tab.wait_for_timeout(300)
        box = tab.locator("#fig-lanes .drawing").bounding_box()
        # without the air above the balls, and the chart, which tells the answer of a bet
        box |= {"y": box["y"] + 0.46 * box["height"], "height": 0.22 * box["height"]}
        tab.screenshot(path=folder / PICTURE, clip=box)
    return folder / PICTURE


def pacing(tab):
    """The longest stretch without a picture before "Read the real thing": screens, its start."""
    width, height = tab.viewport_size.values()
    pictures = PICTURES + BESIDE * (width >= 1248)
    boxes = tab.locator(pictures).filter(visible=True).evaluate_all(BOXES)
    end = tab.locator("#read-the-real-thing").bounding_box()["y"]
    last, longest = (0, "the top"), (0, "")
    for top, bottom, place in sorted(box for box in [*boxes, [end, end, ""]] if box[0] <= end):
        longest = max(longest, ((top - last[0]) / height, last[1]))
        last = max(last, (bottom, place))
    return longest
