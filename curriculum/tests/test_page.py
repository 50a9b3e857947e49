"""The page in real browsers: what a reader sees and does."""

import itertools
import re
from pathlib import Path

import pytest

from curriculum.page.browser import visiting
from curriculum.page.build import build
from curriculum.tests.page_browser import FIGURES, MIDDLE, SEE, WORDS, drag, swipe

PHONE = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The address of the chapter's page, built once."""
    file = tmp_path_factory.mktemp("page") / "contact.html"
    file.write_text(build(), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def visit(browser, url):
    """A function that opens the page in a fresh profile of Chromium."""
    return lambda **options: visiting(browser, url, **options)


@pytest.fixture(scope="module")
def tab(browser, url):
    """One page for all tests that leave it as good as they found it."""
    with visiting(browser, url) as page:
        yield page


@pytest.fixture(scope="module")
def phone(browser, url):
    """One page on a phone."""
    with visiting(browser, url, **PHONE) as page:
        yield page


@pytest.fixture(scope="module")
def fox(firefox, url):
    """One page in Firefox."""
    with visiting(firefox, url) as page:
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


@pytest.mark.parametrize("where", ["tab", "fox", "phone"])
def test_whatever_a_hand_presses_and_moves_changes_the_words_of_its_figure(where, request):
    page = request.getfixturevalue(where)
    if where != "phone":
        page.set_viewport_size({"width": 1280, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    for name in page.evaluate(FIGURES):
        if place := page.evaluate(MIDDLE, name):
            before, top = page.evaluate(WORDS, name), page.evaluate("scrollY")
            moves = (swipe if where == "phone" else drag)(page, *place)
            assert {page.evaluate(WORDS, name) for _ in moves} != {before}, name
            assert page.evaluate("scrollY") == top, name


@pytest.mark.parametrize("width", [1024, 390])
def test_all_can_be_reached_is_told_when_moved_and_moves_nothing_below_it(visit, width):
    height = "(id) => document.getElementById(id).offsetHeight"
    with visit(width=width) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        names = page.evaluate(FIGURES)
        before = {name: page.evaluate(height, name) for name in names}
        for name in names:
            page.evaluate(SEE, name)
            assert page.evaluate(height, name) == before[name], name
            for part in page.locator(f"#{name} :is(.handle, input, .buttons button)").all():
                part.click(trial=True)  # a click would reach it
                words, said = page.evaluate(WORDS, name), None
                for key in ("Shift+ArrowUp", "Shift+ArrowLeft", "Enter"):
                    if said in (None, words):  # it stood at its end, or is a button
                        part.press(key)
                        said = page.evaluate(WORDS, name)
                        assert page.evaluate(height, name) == before[name], name
                assert said != words or part.get_attribute("role") != "slider", name


def middle(shape):
    """Where the middle of a shape is seen [px]."""
    box = shape.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize(
    "name, dx, dy", [("fig-signs", -40, 30), ("fig-falls-2", 0, 20), ("fig-sponge", 0, 0)]
)
def test_a_ball_seized_at_rest_or_in_its_flight_stays_under_the_mouse(visit, name, dx, dy):
    with visit() as page:
        page.evaluate(SEE, name)
        if name == "fig-sponge":
            page.locator(f"#{name} .buttons button").click()  # it lies at the end of its fall
        x, y = middle(page.locator(f"#{name} .handle circle").first)
        for _ in drag(page, x, y, [(dx, dy)]):
            page.evaluate(WORDS, name)
            seen = middle(page.locator(f"#{name} .handle circle").first)
            assert seen == pytest.approx((x + dx, y + dy), abs=2)


def test_keys_move_a_handle_and_a_slider_and_a_button_takes_both_back_to_the_text(visit):
    with visit() as page:
        page.evaluate(SEE, "fig-cliff")
        seen = [page.evaluate(WORDS, "fig-cliff")]
        for part in (".handle", "input") * 2:
            page.locator(f"#fig-cliff {part}").first.press("ArrowRight")
            seen.append(page.evaluate(WORDS, "fig-cliff"))
        assert len(set(seen)) == 5
        back = page.locator("#fig-cliff .back")
        back.click()
        assert page.evaluate(WORDS, "fig-cliff") == seen[0] and back.is_disabled()


def moves(page, shape):
    """By how much a shape, once its figure is in sight, is elsewhere within a second [px]."""
    page.evaluate(SEE, shape.split()[0].removeprefix("#"))
    seen = []
    for _ in range(10):
        page.wait_for_timeout(100)
        seen.append(sum(middle(page.locator(shape).first)))
    return max(seen) - min(seen)


def test_the_hero_alone_moves_unasked_stops_and_is_still_where_motion_is_not_wanted(visit):
    finger, falling = "#fig-gripper .magnified.m-fixed", "#fig-falls-2 .ball"
    with visit() as page:
        assert moves(page, finger) == 0
    with visit(reduced_motion="no-preference") as page:
        assert moves(page, finger) > 10  # one sees it
        page.locator("#fig-gripper .buttons button").first.click()
        assert moves(page, finger) == moves(page, falling) == moves(page, finger) == 0
        page.locator("#fig-falls-2 .buttons button").first.click()
        assert moves(page, falling) > 10


# ---- bets, paper, screens


def test_a_bet_hides_its_answer_in_its_own_box_and_a_click_opens_it_for_good(visit):
    with visit() as page:
        for name in ("ex1", "ex2"):
            answer = page.locator(f"#{name} .answer")
            assert not answer.locator("table, p").filter(visible=True).count()
            right = answer.get_attribute("data-right")
            page.locator(f"#{name} [data-choice]:not([data-choice={right}])").first.click()
            assert "otherwise" in answer.inner_text() and answer.locator("table").is_visible()
        page.locator("#ex1-why").fill("the spring must be pressed")
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        assert page.locator("#ex1-why").input_value() == "the spring must be pressed"
        assert page.locator("#ex2 .answer table").is_visible()


def test_print_has_figures_and_answers_and_nothing_to_press(visit):
    with visit() as page:
        page.emulate_media(media="print")
        assert not page.locator("button:not([data-choice]), input").filter(visible=True).count()
        for part in ("#fig-corner .plot", "#ex1 .answer table", "#references-7"):
            assert page.locator(part).evaluate("(node) => node.checkVisibility()"), part
        sides = ("top", "bottom", "left", "right")
        paper = page.pdf(format="A4", margin=dict.fromkeys(sides, "1.5cm"))
        assert len(re.findall(rb"/Type\s*/Page\b", paper)) < 30


def test_without_scripts_text_figures_and_answers_are_there(visit):
    with visit(java_script_enabled=False) as page:
        assert not page.locator(".needs-js, .controls").filter(visible=True).count()
        for name in ("corner", "falls", "rod"):
            assert page.locator(f"#fig-{name} svg path").first.is_visible()
        page.locator("#ex1 .answer summary").click()
        assert page.locator("#ex1 .answer table").is_visible()


def test_a_phone_shows_no_formula_below_16_px_and_no_figure_higher_than_itself(phone):
    sizes = "[...document.querySelectorAll('math')].map((it) => getComputedStyle(it).fontSize)"
    assert min(float(size.removesuffix("px")) for size in phone.evaluate(sizes)) >= 16
    heights = "[...document.querySelectorAll('.fig')].map((fig) => fig.offsetHeight)"
    assert max(phone.evaluate(heights)) <= PHONE["height"]
    wide = """[...document.querySelectorAll(".scroll, .math.block, .generated img")]
      .filter((box) => box.scrollWidth > box.clientWidth || box.offsetWidth > 390)
      .map((box) => box.textContent || box.alt)"""
    assert phone.evaluate(wide) == []
    assert phone.evaluate("document.documentElement.scrollHeight") < 41 * PHONE["height"]


@pytest.mark.parametrize("where", ["phone", "fox"])
def test_a_citation_leads_to_its_reference_folded_or_not(where, request):
    page = request.getfixturevalue(where)
    page.evaluate("document.querySelector('a[href=\"#references-7\"]').click()")
    entry = "document.getElementById('references-7')"
    assert page.evaluate(f"{entry}.checkVisibility() && {entry}.textContent").find("Rattle") > 0


def test_a_figures_stops_by_keyboard_are_together_and_few(visit):
    stops = """[...document.querySelectorAll("a[href], button, input, summary, [tabindex]")]
      .filter((node) => node.tabIndex >= 0 && !node.disabled && node.checkVisibility())
      .map((node) => node.closest(".fig")?.id ?? "")"""
    with visit() as page:
        for name in page.evaluate(FIGURES):
            page.evaluate(SEE, name)
        found = page.evaluate(stops)
    assert len(found) <= 200
    for name, run in itertools.groupby(found):
        assert not name or len([*run]) == found.count(name) <= 12


def test_axe_finds_no_violation(tab):
    from axe_playwright_python.base import AXE_SCRIPT

    run = """([parts, rules]) => axe.run(parts, {resultTypes: ["violations"], ...rules}).then(
      ({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].target}`))"""
    contrast = [["header", "#fig-falls", "#ex1", "#code-sweep"], {"runOnly": ["color-contrast"]}]
    code = ".code:not(#code-sweep) pre"  # they are all made alike
    others = [{"exclude": [[code]]}, {"rules": {"color-contrast": {"enabled": False}}}]
    tab.set_viewport_size({"width": 1280, "height": 800})
    tab.evaluate(AXE_SCRIPT)
    assert tab.evaluate(run, others) == []
    for scheme in ("dark", "light"):
        tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        assert tab.evaluate(run, contrast) == [], scheme
