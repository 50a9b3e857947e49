"""The page in real browsers: what a reader sees and does."""

import re
from pathlib import Path

import pytest

from curriculum.page.build import build
from curriculum.tests import page_browser
from curriculum.tests.page_browser import SEE, WORDS, call, drag, visiting

MOST = 900_000  # bytes of the page
SIDES = "top bottom left right".split()
HALF = "Invalid markup: Incorrect number of children"


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
    options = {"width": 390, "height": 844, "has_touch": True, "is_mobile": True}
    with visiting(browser, url, **options) as page:
        yield page


@pytest.fixture(scope="module")
def fox(gecko, url):
    """The page in Firefox."""
    gecko.visit(url)
    yield gecko
    # Firefox says HALF of a formula that has not all arrived yet, too
    assert [each for each in gecko.trouble if HALF not in each] == []


def test_page_is_below_900_kb_and_the_same_bytes_twice(url):
    held = Path(url.removeprefix("file://")).read_bytes()
    assert len(held) < MOST
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


@pytest.mark.parametrize("where", ["tab", "fox"])
@pytest.mark.parametrize("width", [1280, 1024, 390])
def test_at_every_button_knob_and_handle_is_that_thing_and_nothing_is_wider(where, width, request):
    page = request.getfixturevalue(where)
    page_browser.resize(page, width)
    assert call(page, "() => document.documentElement.scrollWidth") <= width
    assert page.evaluate(page_browser.HITS) == []


@pytest.mark.parametrize("where", ["tab", "fox", "phone"])
def test_whatever_a_hand_presses_and_moves_changes_the_words_of_its_figure(where, request):
    page = request.getfixturevalue(where)
    if where != "phone":
        page_browser.resize(page, 1280)
    for name in call(page, page_browser.FIGURES):
        place = call(page, page_browser.MIDDLE, name)
        if not place:  # it is looked at, or has sliders alone
            assert not call(page, "(id) => document.querySelector(`#${id} .handle`)", name), name
            continue
        before, top = call(page, WORDS, name), call(page, "() => scrollY")
        moves = drag(page, *place, touch=where == "phone")
        assert any(call(page, WORDS, name) != before for _ in moves), name
        moves.close()
        assert call(page, "() => scrollY") == top, name


@pytest.mark.parametrize("width", [1280, 560, 390])
def test_no_figure_moves_what_is_below_it_when_it_comes_alive_or_is_used(visit, width):
    height = "(id) => document.getElementById(id).offsetHeight"
    with visit(width=width) as page:
        names = call(page, page_browser.FIGURES)
        before = {name: call(page, height, name) for name in names}
        for name in names:
            call(page, SEE, name)
            heights = [call(page, height, name)]
            for button in page.locator(f"#{name} .buttons button").all()[-1:]:
                button.click()
                call(page, WORDS, name)
                heights.append(call(page, height, name))
            for handle in page.locator(f"#{name} .handle").all():
                for key in ("ArrowUp", "ArrowLeft", "ArrowDown", "ArrowDown"):
                    handle.press(f"Shift+{key}")
                    call(page, WORDS, name)
                    heights.append(call(page, height, name))
            assert {*heights} == {before[name]}, name


def test_a_ball_stays_under_the_mouse(tab):
    page_browser.resize(tab, 1280)
    x, y = call(tab, page_browser.MIDDLE, "fig-signs", True)
    for _ in drag(tab, x, y, ((-40, 30),)):
        call(tab, WORDS, "fig-signs")
        box = tab.locator("#fig-signs .handle circle").first.bounding_box()
        place = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        assert place == pytest.approx((x - 40, y + 30), abs=2)


@pytest.mark.parametrize("name, moves", [("fig-falls-2", 20), ("fig-sponge", 0)])
def test_who_seizes_a_ball_in_its_flight_holds_it_where_it_is_seen(visit, name, moves):
    with visit() as page:
        call(page, SEE, name)
        if name == "fig-sponge":
            page.locator(f"#{name} .buttons button").click()  # it lies at the end of its fall
        x, y = call(page, page_browser.MIDDLE, name, True)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x, y + moves)
        call(page, WORDS, name)
        box = page.locator(f"#{name} .handle circle").first.bounding_box()
        assert box["y"] + box["height"] / 2 == pytest.approx(y + moves, abs=2)
        page.mouse.up()


def test_keys_move_a_handle_and_a_slider_and_a_button_takes_both_back_to_the_text(visit):
    with visit() as page:
        call(page, SEE, "fig-cliff")
        seen = [call(page, WORDS, "fig-cliff")]
        for part in (".handle", "input"):
            page.locator(f"#fig-cliff {part}").first.focus()
            for _ in range(2):
                page.keyboard.press("ArrowRight")
                seen.append(call(page, WORDS, "fig-cliff"))
        assert len(set(seen)) == 5
        back = page.locator("#fig-cliff .back")
        back.click()
        assert call(page, WORDS, "fig-cliff") == seen[0] and back.is_disabled()


def places(page, shape):
    """Where a shape, once its figure is in sight, is within a second: how far apart, px."""
    call(page, SEE, shape.split()[0].removeprefix("#"))
    seen = []
    for _ in range(10):
        page.wait_for_timeout(100)
        box = page.locator(shape).first.bounding_box()
        seen.append(box["x"] + box["y"])
    return max(seen) - min(seen)


def test_the_hero_trembles_by_itself_stops_and_stays_still_where_motion_is_not_wanted(visit):
    finger = "#fig-gripper .magnified.m-fixed"
    with visit(motion="reduce") as page:
        assert places(page, finger) == 0
    with visit(motion="no-preference") as page:
        assert places(page, finger) > 10  # one sees it
        page.locator("#fig-gripper .buttons button").first.click()
        assert places(page, finger) == 0
        call(page, SEE, "fig-rod")
        assert places(page, finger) == 0


def test_balls_fall_when_they_are_let_fall_and_no_sooner(visit):
    with visit(motion="no-preference") as page:
        assert places(page, "#fig-falls-2 .ball") == 0
        page.locator("#fig-falls-2 .buttons button").first.click()
        assert places(page, "#fig-falls-2 .ball") > 10


# ---- bets, paper, screens


def test_a_bet_hides_its_answer_in_its_own_box_and_a_click_opens_it_for_good(visit):
    with visit() as page:
        for name in ("ex1", "ex3"):
            answer = page.locator(f"#{name} .answer")
            assert not answer.locator("table, p").filter(visible=True).count()
            right = answer.get_attribute("data-right")
            page.locator(f"#{name} [data-choice]:not([data-choice={right}])").first.click()
            assert "otherwise" in answer.inner_text() and answer.locator("table").is_visible()
        page.locator("#ex1-why").fill("the spring must be pressed")
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        assert page.locator("#ex1-why").input_value() == "the spring must be pressed"
        assert page.locator("#ex3 .answer table").is_visible()


def test_print_has_figures_and_answers_and_nothing_to_press(visit):
    with visit() as page:
        page.emulate_media(media="print")
        assert not page.locator("button:not([data-choice]), input").filter(visible=True).count()
        assert page.locator("#fig-corner .plot").is_visible()
        paper = page.pdf(format="A4", margin=dict.fromkeys(SIDES, "1.5cm"))
        assert len(re.findall(rb"/Type\s*/Page\b", paper)) < 30


def test_without_scripts_text_figures_and_answers_are_there(visit):
    with visit(javascript=False) as page:
        assert not page.locator(".needs-js, .controls").filter(visible=True).count()
        for name in ("corner", "falls", "rod"):
            assert page.locator(f"#fig-{name} svg path").first.is_visible()
        page.locator("#ex1 .answer summary").click()
        assert page.locator("#ex1 .answer table").is_visible()


def test_a_phone_shows_no_formula_below_16_px_and_no_figure_higher_than_itself(phone):
    sizes = """() => [...document.querySelectorAll("math")].map((node) =>
      parseFloat(getComputedStyle(node).fontSize))"""
    assert min(phone.evaluate(sizes)) >= 16
    heights = """() => [...document.querySelectorAll(".fig")].map((fig) => fig.offsetHeight)"""
    assert max(phone.evaluate(heights)) <= 844
    wide = """() => [...document.querySelectorAll(".scroll, .math.block, .generated img")]
      .filter((box) => box.scrollWidth > box.clientWidth || box.offsetWidth > 390)
      .map((box) => box.textContent || box.alt)"""
    assert phone.evaluate(wide) == []
    assert phone.evaluate("document.documentElement.scrollHeight") < 41 * 844


@pytest.mark.parametrize("where", ["phone", "fox"])
def test_a_citation_leads_to_its_reference_folded_or_not(where, request):
    page = request.getfixturevalue(where)
    call(page, """() => document.querySelector("a[href='#references-7']").click()""")
    entry = """() => [...document.querySelectorAll("#references-7")]
      .map((entry) => entry.checkVisibility() && entry.textContent)"""
    assert "Rattle" in call(page, entry)[0]


def test_what_a_figure_can_be_told_stands_beside_its_text_by_keyboard(visit):
    """A figure's own stops are together, and few: no other stands between them."""
    stops = """() => [...document.querySelectorAll("a[href], button, input, summary, [tabindex]")]
      .filter((node) => node.tabIndex >= 0 && !node.disabled && node.checkVisibility())
      .map((node) => node.closest(".fig")?.id ?? "")"""
    with visit() as page:
        for name in call(page, page_browser.FIGURES):
            call(page, SEE, name)
        found = page.evaluate(stops)
    assert len(found) <= 200
    for name in set(found) - {""}:
        first, count = found.index(name), found.count(name)
        assert found[first : first + count] == [name] * count and count <= 12


def test_axe_finds_no_violation(tab):
    from axe_playwright_python.base import AXE_SCRIPT

    run = """([parts, rules]) => axe.run(parts, {resultTypes: ["violations"], ...rules}).then(
      ({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].target}`))"""
    contrast = [["header", "#fig-falls", "#ex1", "#code-sweep"], {"runOnly": ["color-contrast"]}]
    code = ".code:not(#code-sweep) pre"  # they are all made alike
    others = [{"exclude": [[code]]}, {"rules": {"color-contrast": {"enabled": False}}}]
    page_browser.resize(tab, 1280)
    tab.evaluate(AXE_SCRIPT)
    assert tab.evaluate(run, others) == []
    for scheme in ("dark", "light"):
        tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        assert tab.evaluate(run, contrast) == [], scheme
