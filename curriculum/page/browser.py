"""A real browser for picture, measuring and tests: Debian's Chromium, driven by Playwright."""

import contextlib
import shutil

NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
FLAGS = (  # no request of its own
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
SHOWN = """for (const id of ["ex1", "ex3", "ex4"])
  localStorage.setItem(`contact-chapter:${id}`, '{"shown": true}');"""
PICTURE = "page-live.png"  # of the README
# the live figure stands also where the text has no use for it, and no other one in its place
STANDING = """.centred { visibility: hidden }
.live { opacity: 1 !important; visibility: visible !important }"""
# what a knob costs: set a quantity by its slider, and wait until the next frame is painted
KNOB = """([name, figure]) => new Promise((done) => {
  const box = document.getElementById(`fig-${figure}`);
  const range = box.querySelector(`[data-knob="${name}"] input[type=range]`);
  const times = [];
  range.dispatchEvent(new Event("pointerdown")); // a drag: figures may draw coarsely
  const once = () => {
    const start = performance.now();
    range.value = Number(range.value) + (times.length % 2 ? -20 : 20);
    range.dispatchEvent(new Event("input", { bubbles: true }));
    requestAnimationFrame(() => setTimeout(() => {
      times.push(performance.now() - start);
      if (times.length < 9) return setTimeout(once, 300);
      range.dispatchEvent(new Event("pointerup"));
      done(times.sort((a, b) => a - b)[4]);
    }));
  };
  once();
})"""
WHICH = "(node) => [node.dataset.knob, node.closest('.fig').dataset.figure]"
PAINT = """() => new Promise((done) => {
  let shift = 0;
  new PerformanceObserver((list) => {
    for (const each of list.getEntries()) if (!each.hadRecentInput) shift += each.value;
  }).observe({ type: "layout-shift", buffered: true });
  const [first] = performance.getEntriesByName("first-contentful-paint");
  setTimeout(() => done([first ? first.startTime : NaN, shift]), 500);
})"""

# pictures, and passages beside which the live figure stands, from top to bottom
STRETCH = """() => {
  const end = document.getElementById("honest-limits-measured").getBoundingClientRect().top;
  const kinds = ".fig .drawing, .generated img, .beside";
  const places = [...document.querySelectorAll(kinds)].filter((node) => node.checkVisibility() &&
    !(node.matches(".beside") && innerWidth < 1200) && !node.closest("#figure"));
  let [bottom, most, last, above] = [0, 0, "the top", ""];
  const boxes = places.map((node) => [node.getBoundingClientRect(), node.closest("[id]")?.id]);
  for (const [box, id] of boxes.sort(([a], [b]) => a.top - b.top)) {
    if (!box.height || box.top > end) continue;
    if (box.top - bottom > most) [most, above] = [box.top - bottom, last];
    if (box.bottom > bottom) [bottom, last] = [box.bottom, id];
  }
  return [most / innerHeight, above];
}"""


@contextlib.contextmanager
def running():
    """A Chromium, closed at the end."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@contextlib.contextmanager
def opened(page, query="", **options):
    """A tab with the HTML file `page`, 1280 x 900, as for a reader who has made the bets."""
    with running() as browser:
        tab = browser.new_page(viewport={"width": 1280, "height": 900}, **options)
        tab.add_init_script(SHOWN)
        show(tab, page, query)
        yield tab


def show(tab, page, query=""):
    """Go to the page and wait until it is ready."""
    tab.goto(page.resolve().as_uri() + query)
    tab.wait_for_selector("[data-ready]", state="attached")


def photograph(page, folder):
    """Save PICTURE in a folder, the four balls just after the landing; its path."""
    with opened(page, query="?scene=drop", reduced_motion="reduce", device_scale_factor=2) as tab:
        tab.add_style_tag(content=STANDING)
        tab.locator("#figure").scroll_into_view_if_needed()
        tab.locator("#fig-lanes .handle[data-handle=time]").focus()
        for _ in range(8):  # from 0.3 s on, ten steps each
            tab.keyboard.press("Shift+ArrowRight")
        tab.wait_for_timeout(300)
        box = tab.locator("#fig-lanes .drawing").bounding_box()
        # without the air above the balls, and the chart, which tells the answer of a bet
        box |= {"y": box["y"] + 0.35 * box["height"], "height": 0.33 * box["height"]}
        tab.screenshot(path=folder / PICTURE, clip=box)
    return folder / PICTURE


def measure(page):
    """How quickly the page answers in Chromium: lines to print."""
    with opened(page) as tab:
        paint, shift = tab.evaluate(PAINT)
        yield f"first paint {paint:.0f} ms (below 500), layout shift {shift:.3f} (below 0.1)"
        yield pacing(tab)
        for scene, wanted in {"drop": 50, "bounce": 50, "stack": 100}.items():
            show(tab, page, f"?scene={scene}")
            tab.locator("a.try").first.scroll_into_view_if_needed()
            for name in ("dt", "stiffness", "baumgarte", "restitution"):
                time = tab.evaluate(KNOB, [name, "lanes"])
                yield f"lanes, {scene}: {name:<11} answers in {time:4.0f} ms (below {wanted})"
        for knob in tab.locator(".fig:not(#fig-lanes) .knob").all():
            knob.scroll_into_view_if_needed()
            tab.wait_for_timeout(500)
            name, figure = knob.evaluate(WHICH)
            time = tab.evaluate(KNOB, [name, figure])
            yield f"{figure}: {name} answers in {time:.0f} ms (below 100)"


def pacing(tab):
    """The longest stretch without a picture before "Honest limits", in screens: a line."""
    screens, above = tab.evaluate(STRETCH)
    return f"longest stretch without a picture: {screens:.1f} screens, below {above} (at most 2)"
