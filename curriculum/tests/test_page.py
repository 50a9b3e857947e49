"""The page in real browsers: what a reader sees and does."""

import itertools
import re
from pathlib import Path

import pytest

from curriculum.page.browser import visiting
from curriculum.page.build import build
from curriculum.tests.page_browser import FIGURES, MIDDLE, SEE, STATE, drag, swipe

DESK = {"width": 1280, "height": 800}
PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The address of the chapter's page, built once."""
    file = tmp_path_factory.mktemp("page") / "contact.html"
    file.write_text(build(), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def visit(browser, url):
    """A function that opens the page in a fresh profile of Chromium, behind # at a place of it."""

    def opened(place="", **options):
        return visiting(browser, f"{url}#{place}" if place else url, **DESK | options)

    return opened


@pytest.fixture(scope="module")
def tab(browser, url):
    """One page for all tests that leave it as good as they found it."""
    with visiting(browser, url, **DESK) as page:
        yield page


@pytest.fixture(scope="module")
def phone(browser, url):
    """One page on a phone."""
    with visiting(browser, url, **PHONE) as page:
        yield page


@pytest.fixture(scope="module")
def fox(firefox, url):
    """One page in Firefox."""
    with visiting(firefox, url, **DESK) as page:
        yield page


def test_page_is_below_900_kb_and_the_same_bytes_twice(url):
    held = Path(url.removeprefix("file://")).read_bytes()
    assert len(held) < 900_000
    assert held == build().encode()


@pytest.mark.parametrize(
    "text, named",
    [
        ("<!-- figure: nowhere -->", "no figure nowhere; known: .*cliff"),
        ("<!-- figure: cliff?speed=3 -->", "speed sets nothing; known: .*stiffness"),
        ("<!-- figure: cliff?dt=3 -->", "dt=3; allowed: from 0.0005 to 0.064"),
        ("<!-- exercise: ex99 -->", "no exercise ex99"),
        ("$\\clubsuit$", "font lacks"),
    ],
)
def test_what_the_page_cannot_show_is_refused(text, named):
    with pytest.raises(ValueError, match=named):
        build(f"# Title\n\n{text}\n")


# ---- figures under hands


@pytest.mark.parametrize("where, hand", [("tab", drag), ("phone", swipe), ("fox", drag)])
def test_whatever_hand_or_key_moves_a_figure_tells_and_nothing_below_it_moves(where, hand, request):
    page = request.getfixturevalue(where)
    names = page.evaluate(FIGURES)[:: 3 if where == "fox" else 1]
    still = "document.getElementById('{}').offsetHeight"
    heights = {name: page.evaluate(still.format(name)) for name in names}  # of the pictures
    for name in names:
        place = page.evaluate(MIDDLE, name)
        first, height, *top = page.evaluate(STATE, name)
        assert height == heights[name], name
        told = [page.evaluate(STATE, name) for _ in (hand(page, *place) if place else ())]
        assert not place or {words for words, *_ in told} != {first}, name
        assert {(*rest,) for _, *rest in told} <= {(height, *top)}, name
        for part in page.locator(f"#{name} :is([role=slider], input, .buttons button)").all():
            before = part.get_attribute("aria-valuetext")
            for key in ("ArrowUp", "Shift+ArrowLeft", "Enter"):
                part.press(key)
                told.append(page.evaluate(STATE, name))
                if part.get_attribute("aria-valuetext") != before:
                    break  # it stood at its end, or is a button
            else:
                assert part.evaluate("(node) => node.tagName") == "BUTTON", name
        assert {(high, at) for _, high, at, _ in told} <= {(height, top[0])}, name
        back = page.locator(f"#{name} .back")
        if back.is_enabled():
            back.click()
            assert page.evaluate(STATE, name)[0] == first or "gripper" in name, name
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_every_slider_says_its_range_and_what_came_of_it_and_few_are_on_the_way(visit):
    sliders = """(id) => [...document.querySelectorAll(`#${id} [role=slider], #${id} input`)].map(
      (node) => [...["min", "max", "now"].map((key) => Number(node.getAttribute(`aria-value${key}`)
        ?? (key === "now" ? node.value : node[key]))), node.getAttribute("aria-valuetext"),
        node.getAttribute("aria-label") ?? node.closest("label").textContent])"""
    stops = """[...document.querySelectorAll("a[href], button, input, summary, [tabindex]")]
      .filter((node) => node.tabIndex >= 0 && !node.disabled && node.checkVisibility())
      .map((node) => node.closest(".fig")?.id ?? "")"""
    with visit() as page:
        for name in page.evaluate(FIGURES):
            page.evaluate(SEE, name)
            words = page.evaluate(STATE, name)[0].replace("\xa0", " ")
            for low, high, now, text, label in page.evaluate(sliders, name):
                assert low <= now <= high and label.strip(), (name, label)
                assert text.replace("\xa0", " ").endswith(f": {words}"), (name, label)
        found = page.evaluate(stops)
    assert len(found) <= 210
    for name, run in itertools.groupby(found):
        assert not name or len([*run]) == found.count(name) <= 12


def middle(shape):
    """Where the middle of a shape is seen [px]."""
    box = shape.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("name, dx, dy", [("signs", -40, 30), ("falls", 0, 20), ("corner", 0, -9)])
def test_a_ball_that_is_seized_stays_under_the_mouse(visit, name, dx, dy):
    with visit() as page:
        page.evaluate(SEE, f"fig-{name}")
        ball = page.locator(f"#fig-{name} .handle circle").first
        x, y = middle(ball)
        for _ in drag(page, x, y, [(dx, dy)]):
            page.evaluate(STATE, f"fig-{name}")
            assert middle(ball) == pytest.approx((x + dx, y + dy), abs=2)


def moves(page, shape):
    """By how much a shape, once its figure is in sight, is elsewhere within half a second [px]."""
    page.evaluate(SEE, shape.split()[0].removeprefix("#"))
    seen = []
    for _ in range(8):
        page.wait_for_timeout(60)
        seen.append(sum(middle(page.locator(shape).first)))
    return max(seen) - min(seen)


def test_the_first_figure_alone_moves_unasked_and_where_motion_is_not_wanted_when_asked(visit):
    finger, falling = "#fig-gripper .m-fixed", "#fig-falls .ball"
    with visit() as page:
        assert moves(page, finger) == 0
        page.locator("#fig-gripper .buttons button").first.click()
        assert moves(page, finger) > 5
    with visit(reduced_motion="no-preference") as page:
        assert moves(page, finger) > 5  # one sees it
        page.locator("#fig-gripper .buttons button").first.click()
        assert moves(page, finger) == moves(page, falling) == moves(page, finger) == 0
        page.locator("#fig-falls .buttons button").first.click()
        assert moves(page, falling) > 10


@pytest.mark.parametrize("screen", [DESK, PHONE])
def test_the_first_screen_has_the_whole_first_figure_and_its_handle(visit, screen):
    with visit(**screen) as page:
        page.wait_for_selector("#fig-gripper .back", state="attached")
        for part in (".plot", ".handle", ".words", ".buttons button"):
            box = page.locator(f"#fig-gripper {part}").first.bounding_box()
            assert box["y"] >= 0 and box["y"] + box["height"] <= screen["height"], part


def test_a_link_sets_numbers_in_their_range_a_reload_keeps_all_and_the_address_is_a_link(visit):
    said = "(id) => document.querySelector(`#${id} .words`).textContent.replaceAll('\\xa0', ' ')"
    with visit("fig-cliff?dt=0.0123&damping=-3&stiffness=<b>&start=1&__proto__=2") as page:
        page.wait_for_selector("#fig-cliff .back")
        assert page.evaluate(said, "fig-cliff").startswith("12.3 ms")
        shown = page.locator("#fig-cliff output").all_inner_texts()
        assert [text.replace("\xa0", " ") for text in shown] == ["10,000 N/m", "80 N s/m"]
        assert (
            page.evaluate("document.getElementById('fig-cliff').getBoundingClientRect().top") < 800
        )
        page.evaluate("location.hash = '#fig-sag?iters=7'")
        page.evaluate(SEE, "fig-sag")
        page.locator("#fig-sag input").first.press("ArrowRight")
        page.evaluate(SEE, "fig-corner")
        page.locator("#fig-corner .buttons button").last.click()
        page.wait_for_url(re.compile(r"#fig-corner\?model=soft$"))
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        for name in ("fig-sag", "fig-corner"):
            page.evaluate(SEE, name)
        assert page.locator("#fig-sag output").first.inner_text().strip() == "8"
        assert page.locator("#fig-corner [aria-pressed=true]").inner_text() == "soft"
        page.locator("#fig-corner .back").click()
        page.wait_for_url(re.compile("#fig-corner$"))
        contents = page.locator(".contents a").all_text_contents()
        assert len([each for each in contents if each.startswith("Figure: ")]) == len(
            page.evaluate(FIGURES)
        )


# ---- bets, paper, screens


def test_a_bet_stands_until_it_is_taken_back_and_its_answer_opens_after_it_or_by_a_second_press(
    visit,
):
    with visit() as page:
        box = page.locator("#ex1")
        answer, choices = box.locator(".answer"), box.locator("[data-choice]")
        right = answer.get_attribute("data-right")
        assert not answer.locator("table, p").filter(visible=True).count()
        assert not box.locator(".take-back").is_visible()
        answer.locator("summary").click()
        assert "not bet" in answer.inner_text() and not answer.locator("table").is_visible()
        answer.locator("summary").click()
        assert answer.locator("table").is_visible() and "otherwise" not in answer.inner_text()
        wrong = box.locator(f"[data-choice]:not([data-choice={right}])").first
        wrong.click()
        assert "otherwise" in answer.inner_text()
        assert box.locator("[data-choice]:disabled").count() == choices.count() - 1
        box.locator(".take-back").click()
        assert not answer.locator("table").is_visible()
        box.locator(f"[data-choice={right}]").click()
        assert "it is so" in answer.inner_text() and answer.locator("table").is_visible()
        page.locator("#ex1-why").fill("the spring must be pressed")
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        assert page.locator("#ex1-why").input_value() == "the spring must be pressed"
        assert box.locator("[aria-pressed=true]").get_attribute("data-choice") == right
        assert not answer.locator("table").is_visible()  # the next reader bets, too
        with page.expect_navigation():
            page.locator(".forget").click()
        page.wait_for_selector("[data-ready]", state="attached")
        assert not box.locator("[aria-pressed=true]").count()


def test_print_has_figures_and_answers_on_few_pages_and_nothing_to_press(visit):
    with visit() as page:
        page.emulate_media(media="print")
        assert not page.locator("button:not([data-choice]), input").filter(visible=True).count()
        for part in ("#fig-falls .whole", "#ex1 .answer table", "#references-7"):
            shown = page.locator(part).first.evaluate("(node) => node.checkVisibility()")
            assert shown, part
        sides = ("top", "bottom", "left", "right")
        paper = page.pdf(format="A4", margin=dict.fromkeys(sides, "1.5cm"))
        assert len(re.findall(rb"/Type\s*/Page\b", paper)) <= 26


def test_without_scripts_text_figures_bets_and_answers_are_there(visit):
    with visit(java_script_enabled=False) as page:
        assert not page.locator(".needs-js, .controls").filter(visible=True).count()
        for part in ("#fig-corner svg path", "#fig-falls .whole", "#fig-rod svg path"):
            assert page.locator(part).first.is_visible(), part
        assert page.locator("#ex1 [data-choice]").filter(visible=True).count() >= 3
        page.locator("#ex1 .answer summary").click()
        assert page.locator("#ex1 .answer table").is_visible()


def test_a_phone_has_targets_of_44_px_formulas_of_16_and_no_figure_higher_than_itself(phone):
    sizes = "[...document.querySelectorAll('math')].map((it) => getComputedStyle(it).fontSize)"
    assert min(float(size.removesuffix("px")) for size in phone.evaluate(sizes)) >= 16
    heights = "[...document.querySelectorAll('.fig')].map((fig) => fig.offsetHeight)"
    assert max(phone.evaluate(heights)) <= PHONE["height"]
    wide = """[...document.querySelectorAll(".scroll, .math.block, .generated img")]
      .filter((box) => box.scrollWidth > box.clientWidth || box.offsetWidth > 390)
      .map((box) => box.textContent || box.alt)"""
    assert phone.evaluate(wide) == []
    assert phone.evaluate("document.documentElement.scrollHeight") < 42 * PHONE["height"]
    for name in phone.evaluate(FIGURES):
        phone.evaluate(SEE, name)
    small = """[...document.querySelectorAll(".handle, button, summary, input, .contents a")]
      .filter((node) => node.checkVisibility() && !node.disabled)
      .map((node) => [node.getBoundingClientRect(), node])
      .filter(([{ width, height }]) => width < 43.5 || height < 43.5)
      .map(([{ width, height }, node]) => `${node.textContent || node.outerHTML.slice(0, 80)} ${
        width} ${height} ${node.closest("[id]").id}`)"""
    assert phone.evaluate(small) == []


def test_at_the_desk_code_has_one_width_and_no_2700_pixels_are_without_a_picture(tab):
    edges = "[...document.querySelectorAll('.code')].map((box) => box.getBoundingClientRect())"
    assert len({(box["left"], box["width"]) for box in tab.evaluate(edges)}) == 1
    places = """[...document.querySelectorAll(".fig, .generated")].map((each) => {
      const { top, bottom } = each.getBoundingClientRect();
      return [each.id, top, bottom];
    })"""
    pairs = itertools.pairwise(tab.evaluate(places))
    far = [(b[0], round(b[1] - a[2])) for a, b in pairs if b[1] - a[2] > 2700]
    assert far == []


@pytest.mark.parametrize("where", ["phone", "fox"])
def test_a_citation_leads_to_its_reference_folded_or_not(where, request):
    page = request.getfixturevalue(where)
    page.evaluate("document.querySelector('a[href=\"#references-7\"]').click()")
    entry = "document.getElementById('references-7')"
    assert page.evaluate(f"{entry}.checkVisibility() && {entry}.textContent.length") > 20


def test_axe_finds_no_violation(tab):
    from axe_playwright_python.base import AXE_SCRIPT

    run = """([parts, rules]) => axe.run(parts, {resultTypes: ["violations"], ...rules}).then(
      ({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].target}`))"""
    contrast = [["header", "#fig-falls", "#ex1", "#code-sweep"], {"runOnly": ["color-contrast"]}]
    code = ".code:not(#code-sweep) pre"  # they are all made alike
    others = [{"exclude": [[code]]}, {"rules": {"color-contrast": {"enabled": False}}}]
    tab.evaluate(AXE_SCRIPT)
    assert tab.evaluate(run, others) == []
    for scheme in ("dark", "light"):
        tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        assert tab.evaluate(run, contrast) == [], scheme
