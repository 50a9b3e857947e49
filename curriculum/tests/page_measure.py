"""What `python -m curriculum.page` does in a browser: the README's picture, and measuring."""

import statistics

from curriculum.tests.page_browser import opened

PICTURE = "page-live.png"  # of the README
# the live figure stands also where the text has no use for it, and no other one in its place
STANDING = """.centred { visibility: hidden }
.live { opacity: 1 !important; visibility: visible !important }"""
# what the browser itself notes of the page, `seen`; an event lasts until its frame is shown
LEAST = 16  # ms, of an event that is noted
OBSERVED = f"""globalThis.seen = {{ event: [], paint: [], "layout-shift": [] }};
for (const type in seen)
  new PerformanceObserver((list) => seen[type].push(...list.getEntries().map((e) => e.toJSON())))
    .observe({{ type, buffered: true, durationThreshold: {LEAST} }});"""
KNOBS = ".drag, .knob input[type=range]"
PLACE = """(node) => `${node.closest(".fig")?.id ?? "text"}: ` +
  node.closest("[data-knob]").dataset.knob"""
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


def measure(page):
    """How quickly the page answers in Chromium, with the largest scene: lines to print."""
    with opened(page, "?scene=stack", motion="no-preference") as tab:
        tab.evaluate(OBSERVED)
        tab.wait_for_timeout(500)
        seen = tab.evaluate("seen")
        paint = seen["paint"][-1]["startTime"]
        shift = sum(each["value"] for each in seen["layout-shift"] if not each["hadRecentInput"])
        yield f"first paint {paint:.0f} ms (below 500), layout shift {shift:.3f} (below 0.1)"
        screens, above = pacing(tab)
        yield f"longest stretch without a picture: {screens:.1f} screens, below {above} (at most 2)"
        tab.locator("a.try").first.scroll_into_view_if_needed()  # beside it is the live figure
        tab.wait_for_timeout(500)
        for knob in tab.locator(KNOBS).element_handles():
            knob.focus()
            if not knob.is_visible():
                continue
            tab.evaluate("seen.event.length = 0")
            for _ in range(5):
                tab.keyboard.press("ArrowRight")
                tab.wait_for_timeout(100)
            events = tab.evaluate("seen.event")
            times = [each["duration"] for each in events if each["name"] == "keydown"]
            answer = statistics.median(times or [LEAST])
            yield f"{knob.evaluate(PLACE)} answers in {answer:.0f} ms (below 50)"


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
