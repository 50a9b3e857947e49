"""The page in real browsers: what a reader sees and does."""

import itertools
import re
from functools import partial

import pytest

from curriculum.page.build import build
from curriculum.tests.page_browser import visiting

DESK = {"width": 1280, "height": 800}
PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}
FRAME = "await new Promise(requestAnimationFrame);"
# a figure in the middle of the window, alive
SEE = f"""async (id) => {{
  const fig = document.getElementById(id);
  fig.scrollIntoView({{ block: "center" }});
  for (let k = 0; k < 99 && !fig.querySelector(".back"); k++)
    await new Promise(requestAnimationFrame);
  {FRAME}
}}"""
# what a figure says, how high it is, and where it and the window stand
STATE = f"""async (id) => {{
  {FRAME}
  const fig = document.getElementById(id);
  return [fig.querySelector(".words").textContent.replaceAll("\\xa0", " "),
    fig.offsetHeight, fig.offsetTop, scrollY];
}}"""
# of all sliders: their range and value, their name, what they tell behind the figure's words
SLIDERS = """(fig) => [...fig.querySelectorAll("[role=slider], input")].map((node) => {
  const said = fig.querySelector(".words").textContent;
  const [told, words] = [node.getAttribute("aria-valuetext"), said].map((text) =>
    text.replaceAll("\xa0", " "));
  return [["min", "min"], ["max", "max"], ["now", "value"]].map(([key, own]) =>
    Number(node.getAttribute(`aria-value${key}`) ?? node[own])).concat(
    node.getAttribute("aria-label") ?? node.closest("label").textContent, told.split(words)[1]);
})"""
WIDE = """[...document.querySelectorAll(".scroll, .math.block, .generated img")]
  .filter((box) => box.scrollWidth > box.clientWidth || box.offsetWidth > 390)
  .map((box) => box.textContent || box.alt)"""
SMALL = """[...document.querySelectorAll(".handle, button, summary, input, .contents a")]
  .filter((node) => node.checkVisibility() && !node.disabled)
  .map((node) => [node.getBoundingClientRect(), node.closest("[id]").id])
  .filter(([{ width, height }]) => Math.min(width, height) < 43.5)"""
MOVES = ((70, -60), (-70, 60))  # px: to and fro, for what stands at an end


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The address of the chapter's page, built once."""
    file = tmp_path_factory.mktemp("page") / "contact.html"
    assert file.write_text(build(), encoding="utf-8") < 900_000
    return file.as_uri()


@pytest.fixture(scope="module")
def desk(start, url):
    """The page in Chromium at a desk, which tests share that leave it as they found it."""
    with visiting(start("chromium"), url, **DESK) as page:
        yield page


@pytest.fixture
def visit(start, url):
    """A function that opens the page in a fresh profile of Chromium, behind # at a place of it."""

    def opened(place="", kind="chromium", **options):
        return visiting(start(kind), f"{url}#{place}" if place else url, **DESK | options)

    return opened


# ---- figures under hands


def middle(shape):
    """Where the middle of a shape is seen [px]."""
    box = shape.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page, x, y, moves=MOVES):
    """Press at a place, and draw what lies there to and fro; a move at a time."""
    page.mouse.move(x, y)
    page.mouse.down()
    for dx, dy in moves:
        page.mouse.move(x + dx, y + dy)
        yield
    page.mouse.up()


def swipe(page, x, y):
    """The same with a finger, since Playwright's own can only tap."""
    session = page.context.new_cdp_session(page)
    kinds = ["touchStart", *["touchMove"] * len(MOVES), "touchEnd"]
    for kind, (dx, dy) in zip(kinds, [(0, 0), *MOVES, (0, 0)]):
        points = [{"x": x + dx, "y": y + dy}] if kind != "touchEnd" else []
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        page.wait_for_timeout(30)
        yield


def wake_all(page):
    """Bring every figure into sight: none is higher or lower than its still was."""
    figures = page.locator(".fig")
    before = figures.evaluate_all("(all) => all.map(({ id, offsetHeight }) => [id, offsetHeight])")
    for name, _ in before:
        page.evaluate(SEE, name)
    after = figures.evaluate_all("(all) => all.map(({ id, offsetHeight }) => [id, offsetHeight])")
    assert before == after and max(height for _, height in after) <= page.viewport_size["height"]


def by_hand(page, fig, hand):
    """A figure tells what its last handle does under the mouse, or a finger; no part moves away."""
    name = fig.get_attribute("id")
    first, *place = page.evaluate(STATE, name)
    for circle in fig.locator(".handle circle").all()[-1:]:
        told = [page.evaluate(STATE, name) for _ in hand(page, *middle(circle))]
        assert {words for words, *_ in told} != {first}, name
        assert all(at == place for _, *at in told), name


def by_keys(page, fig):
    """Handles, sliders and buttons tell what came of a key, and their range; no part moves away."""
    name = fig.get_attribute("id")
    place = page.evaluate(STATE, name)[1:3]
    for kind in ("[tabindex='0']", "input", ".buttons button"):
        for part in fig.locator(kind).all()[:1]:
            before = part.get_attribute("aria-valuetext")
            for key in ("ArrowUp", "Shift+ArrowLeft", "Enter"):
                part.press(key)
                assert page.evaluate(STATE, name)[1:3] == place, (name, kind)
                if part.get_attribute("aria-valuetext") != before:  # it stood not at its end
                    break
            else:
                assert "button" in kind, f"{name}: no key moves its {kind}"
            for low, high, now, label, behind in fig.evaluate(SLIDERS):
                assert low <= now <= high and label.strip() and behind == "", (name, label)


def move_all(page, *ways, every=1):
    """Move the last figure of each kind, or every third kind, in these ways, and take it back."""
    figures = page.locator(".fig").evaluate_all("(all) => all.map((f) => [f.dataset.figure, f.id])")
    for name in list(dict(figures).values())[::every]:
        fig = page.locator(f"#{name}")
        page.evaluate(SEE, name)
        first = page.evaluate(STATE, name)[0]
        for way in ways:
            way(page, fig)
        if fig.locator(".back").is_enabled():
            fig.locator(".back").click()
            assert page.evaluate(STATE, name)[0] == first or "gripper" in name, name
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def see_first(page, height):
    """The first figure, its handle, words and button are on the first screen."""
    page.wait_for_selector("#fig-gripper .back", state="attached")
    for part in (".plot", ".handle", ".words", ".buttons button"):
        box = page.locator(f"#fig-gripper {part}").first.bounding_box()
        assert box["y"] >= 0 and box["y"] + box["height"] <= height, part


def test_a_learners_way_at_the_desk(desk, url):
    desk.goto(url)  # in whatever order tests are run
    desk.wait_for_selector("[data-ready]", state="attached")
    see_first(desk, DESK["height"])
    edges = "[...document.querySelectorAll('.code')].map((box) => box.getBoundingClientRect())"
    assert len({(box["left"], box["width"]) for box in desk.evaluate(edges)}) == 1
    pictures = desk.locator(".fig, .generated").filter(visible=True).all()
    boxes = [each.bounding_box() for each in pictures]
    for above, below in itertools.pairwise(boxes):
        assert below["y"] - above["y"] - above["height"] <= 1600, below
    wake_all(desk)
    move_all(desk, partial(by_hand, hand=drag), by_keys)


def test_a_learners_way_on_a_phone(visit):
    with visit(**PHONE) as page:
        see_first(page, PHONE["height"])
        assert page.evaluate(WIDE) == []
        assert page.evaluate("document.documentElement.scrollHeight") < 42 * PHONE["height"]
        wake_all(page)
        assert page.evaluate(SMALL) == []
        move_all(page, partial(by_hand, hand=swipe))


def test_a_third_of_it_in_firefox(visit):
    with visit(kind="firefox") as page:
        move_all(page, partial(by_hand, hand=drag), every=3)


@pytest.mark.parametrize("name, dy", [("fig-set-back", 20), ("fig-corner", -9)])
def test_a_ball_that_is_seized_stays_under_the_mouse(desk, name, dy):
    desk.evaluate(SEE, name)
    ball = desk.locator(f"#{name} .handle .ball")
    x, y = middle(ball)
    for _ in drag(desk, x, y, [(0, dy)]):
        desk.evaluate(STATE, name)
        assert middle(ball) == pytest.approx((x, y + dy), abs=2)


def test_the_first_figure_alone_moves_unasked_and_where_motion_is_not_wanted_when_asked(visit):
    def moves(page, name, looks=99):
        """Whether the first ball of a figure moves by more than 5 px, in so many looks."""
        page.evaluate(SEE, name)
        ball, seen = page.locator(f"#{name} :is(.m-fixed, .ball)").first, []
        while len(seen) < looks and (not seen or max(seen) - min(seen) <= 5):
            page.wait_for_timeout(80)
            seen.append(sum(middle(ball)))
        return max(seen) - min(seen) > 5

    with visit() as page:
        gripper = page.locator("#fig-gripper .buttons button")
        assert not moves(page, "fig-gripper", 6)
        gripper.click()
        assert moves(page, "fig-gripper")
        page.emulate_media(reduced_motion="no-preference")
        page.reload()
        assert moves(page, "fig-gripper")  # one sees it
        gripper.click()
        assert not moves(page, "fig-gripper", 6) and not moves(page, "fig-falls", 6)
        page.locator("#fig-falls .buttons button").click()
        assert moves(page, "fig-falls")


def test_a_link_sets_numbers_in_their_range_a_reload_keeps_all_and_the_address_is_a_link(visit):
    with visit("fig-cliff?dt=0.0123&damping=-3&stiffness=<b>&start=1&__proto__=2") as page:
        page.wait_for_selector("#fig-cliff .back")
        words, _, top, scrolled = page.evaluate(STATE, "fig-cliff")
        assert "12.3 ms" in words and 0 < top - scrolled < 800
        assert page.locator("#fig-cliff output").all_inner_texts() == [
            "10,000\xa0N/m",
            "80\xa0N s/m",
        ]
        page.evaluate("location.hash = '#fig-sag?iters=7'")
        page.evaluate(SEE, "fig-falls")
        page.locator("#fig-falls [role=slider]").press("End")
        fallen = page.evaluate(STATE, "fig-falls")[0]
        page.evaluate(SEE, "fig-corner")
        page.locator("#fig-corner .buttons button").last.click()
        page.wait_for_url(re.compile(r"#fig-corner\?model=soft$"))
        page.evaluate("location.hash = '#one-bowl'")
        page.wait_for_function("history.state")  # a new place of the history
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        for name in ("fig-cliff", "fig-sag", "fig-falls", "fig-corner"):
            page.evaluate(SEE, name)
        assert fallen.startswith("1.400 s") and page.evaluate(STATE, "fig-falls")[0] == fallen
        assert "12.3 ms" in page.evaluate(STATE, "fig-cliff")[0]
        assert page.locator("#fig-sag output").first.inner_text().strip() == "7"
        assert page.locator("#fig-corner [aria-pressed=true]").inner_text() == "soft"
        page.locator("#fig-corner .back").click()
        page.wait_for_url(re.compile("#fig-corner$"))
        contents = " ".join(page.locator(".contents a").all_text_contents())
        assert contents.count("Figure: ") == page.locator(".fig").count()


# ---- bets, paper, screens


def test_a_bet_stands_until_it_is_taken_back_and_its_answer_opens_after_it_or_by_a_second_press(
    desk,
):
    box, back = desk.locator("#ex1"), desk.locator("#ex1 .take-back")
    answer, table = box.locator(".answer"), box.locator(".answer table")
    right = answer.get_attribute("data-right")
    assert not table.is_visible() and not back.is_visible()
    answer.locator("summary").click()
    assert "not bet" in answer.inner_text() and not table.is_visible()
    answer.locator("summary").click()
    assert table.is_visible() and "otherwise" not in answer.inner_text()
    box.locator(f"[data-choice]:not([data-choice={right}])").first.click()
    assert "otherwise" in answer.inner_text()
    assert box.locator("[data-choice]:not(:disabled)").count() == 1
    back.click()
    assert not table.is_visible()
    box.locator(f"[data-choice={right}]").click()
    assert "it is so" in answer.inner_text() and table.is_visible()
    back.click()


def test_print_has_figures_and_answers_on_few_pages_and_nothing_to_press(desk):
    desk.emulate_media(media="print")
    assert not desk.locator("button:not([data-choice]), input").filter(visible=True).count()
    for part in ("#fig-falls .whole", "#ex1 .answer table", "#references-7"):
        assert desk.locator(part).first.evaluate("(node) => node.checkVisibility()"), part
    sides = ("top", "bottom", "left", "right")
    paper = desk.pdf(format="A4", margin=dict.fromkeys(sides, "1.5cm"))
    assert len(re.findall(rb"/Type\s*/Page\b", paper)) <= 26
    desk.emulate_media(media="screen")


def test_without_scripts_text_figures_bets_and_answers_are_there(visit):
    with visit(java_script_enabled=False) as page:
        assert not page.locator(".needs-js, .controls").filter(visible=True).count()
        for part in ("#fig-corner svg path", "#fig-falls .whole", "#fig-rod svg path"):
            assert page.locator(part).first.is_visible(), part
        assert page.locator("#ex1 [data-choice]").filter(visible=True).count() >= 3
        page.locator("#ex1 .answer summary").click()
        assert page.locator("#ex1 .answer table").is_visible()


def test_axe_finds_no_violation(desk):
    from axe_playwright_python.base import AXE_SCRIPT

    run = """([parts, rules]) => axe.run(parts, {resultTypes: ["violations"], ...rules}).then(
      ({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].target}`))"""
    contrast = [["header", "#fig-falls", "#ex1", "#code-sweep"], {"runOnly": ["color-contrast"]}]
    code = ".code:not(#code-sweep) pre"  # they are all made alike
    others = [{"exclude": [[code]]}, {"rules": {"color-contrast": {"enabled": False}}}]
    desk.evaluate(AXE_SCRIPT)
    assert desk.evaluate(run, others) == []
    for scheme in ("dark", "light"):
        desk.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        assert desk.evaluate(run, contrast) == [], scheme
