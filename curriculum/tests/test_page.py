"""The page in real browsers: what a reader sees and does."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from curriculum.page.build import build, check_lines
from curriculum.page.chapter import blocks
from curriculum.page.exercises import all_exercises, measured
from curriculum.tests import page_browser, page_measure
from curriculum.tests.page_browser import SHOWN, call, middle, mouse, visiting

BETS = {  # a number of each that tells its answer, as the page writes it
    "ex1": ("penalty_deepest", ".3f"),
    "ex3": ("limit", ".4f"),
}
MOST = 900_000  # bytes of the page
HALF = "Invalid markup: Incorrect number of children"
WHOLE = """[["msup, msub, mfrac, mover, munder, mroot", 2], ["msubsup, munderover", 3]].every(
  ([kinds, count]) => [...document.querySelectorAll(kinds)].every(
    (node) => node.children.length === count))"""


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The address of the chapter's page, built once."""
    file = tmp_path_factory.mktemp("page") / "contact.html"
    file.write_text(build(), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def visit(browser, url):
    """A function that opens the page in a fresh profile of Chromium."""
    return lambda query="", **options: visiting(browser, url + query, **options)


@pytest.fixture(scope="module")
def opened(browser, url):
    """One page for all tests that leave it as good as they found it."""
    with visiting(browser, url) as page:
        yield page


@pytest.fixture
def tab(opened):
    """The same, as large as a desktop."""
    opened.set_viewport_size({"width": 1280, "height": 900})
    return opened


@pytest.fixture(scope="module")
def unread(browser, url):
    """One page of a reader who has not bet."""
    with visiting(browser, url, shown=False) as page:
        yield page


@pytest.fixture(scope="module")
def phone(browser, url):
    """One page on a phone."""
    options = {"width": 390, "height": 800, "has_touch": True, "is_mobile": True}
    with visiting(browser, url, **options) as page:
        yield page


@pytest.fixture(scope="module")
def opened_in_firefox(gecko, url):
    """The page in Firefox, for a reader who has asked to see the answers."""
    gecko.visit(url)
    gecko.evaluate(f"(() => {{ {SHOWN} }})()")
    gecko.visit(url)
    yield gecko
    # Firefox says HALF of a formula that has not all arrived yet, too
    assert gecko.evaluate(WHOLE)
    assert [each for each in gecko.trouble if HALF not in each] == []


@pytest.fixture
def fox(opened_in_firefox):
    """The same, as large as a desktop."""
    opened_in_firefox.resize(1280)
    return opened_in_firefox


def test_page_is_below_900_kb_and_the_same_bytes_twice(url):
    held = Path(url.removeprefix("file://")).read_bytes()
    assert len(held) < MOST
    assert held == build().encode()


@pytest.mark.parametrize(
    "text, named",
    [
        ("[words](try:scene=moon)", "moon"),
        ("[words](try:scene=drop&dt=)", "dt= "),
        ("[3](drag:dt)", "0.0005 to 0.064"),
        ("[drop](drag:scene)", "scene"),
        ("<div>bold</div>", "raw HTML"),
        ("<!-- show: models=penalty,magic -->", "magic"),
        ("$\\clubsuit$", "font lacks"),
    ],
)
def test_what_the_page_cannot_show_is_refused_in_one_line(text, named):
    with pytest.raises(ValueError, match=named):
        blocks(text, {"dt": (0.0005, 0.064)}, {"drop": {}})


def test_a_chapter_with_a_figure_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="nowhere"):
        build("# Title\n\n<!-- figure: nowhere -->\n")


# what a reader sees of a section: its numbers in sentences and fields, its chips, the address
SEEN = """() => ({
  number: document.querySelector(".drag[data-knob=dt]").textContent,
  field: document.querySelector("#fig-cliff [data-knob=dt] [inputmode]").value,
  elsewhere: document.querySelector("#fig-twice [data-knob=dt] [inputmode]").value,
  chips: document.querySelector("#fig-cliff .chips").textContent,
  asked: location.href.split(".html")[1], entries: history.length})"""


WRITTEN = """() => location.search.slice(4) ===
  document.querySelector(".drag[data-knob=dt]").textContent"""


def keys(page, node):
    """Turn a number by a run of keys."""
    node.focus()
    for _ in range(15):
        page.keyboard.press("ArrowRight")


def drawn(page, node):
    """The same by the mouse."""
    for _ in mouse(page, *middle(node), ((12, 0), (30, 0))):
        pass


def test_a_section_keeps_its_own_values_and_one_act_is_one_entry_of_the_history(visit):
    with visit() as page:
        number = ".drag[data-knob=dt]"
        page.locator("#fig-cliff").scroll_into_view_if_needed()
        slider = page.locator("#fig-cliff [data-knob=dt] [type=range]")
        written, chip = (page.locator(each).first for each in (number, f"{number} + .chip"))
        for hand, node in ((drawn, slider), (keys, written), (drawn, written)):
            node.scroll_into_view_if_needed()
            page.wait_for_function("location.search === ''")  # no act is still to be written
            before = page.evaluate(SEEN)
            assert before["number"] == "0.03" and before["chips"] == ""
            assert re.fullmatch("(#in-a-hurry[.\\d]*)?", before["asked"])
            hand(page, node)
            page.wait_for_function(WRITTEN)  # the address of an act is written in its pauses
            now = page.evaluate(SEEN)
            assert now["entries"] == before["entries"] + 1
            value = now["number"]
            assert float(value) > 0.03 and now["field"] == value and now["elsewhere"] == "0.002"
            assert now["chips"] == f"Time step dt = {value}, text: 0.03"
            assert re.fullmatch(rf"\?dt={value}#in-a-hurry[.\d]*", now["asked"])
            if hand is keys:
                page.reload()
                page.wait_for_selector("[data-ready]", state="attached")
                assert written.inner_text() == now["number"]
            chip.click()
            assert written.inner_text() == "0.03" and not chip.is_visible()
        page.go_back()
        page.wait_for_function(
            f"(text) => document.querySelector({number!r}).textContent === text", arg=now["number"]
        )


def test_an_address_opens_a_section_as_it_stands_and_scrolling_never_writes_it(visit):
    with visit("?dt=0.02&k=3&stiffness=5#in-a-hurry") as page:
        page.wait_for_selector("#fig-cliff .words:text('dt = 20.0 ms')", state="attached")
        assert page.locator("#fig-cliff .chips").inner_text() == "Time step dt = 0.02, text: 0.03"
        asked = page.evaluate("location.href")
        assert "dt = 4.0 ms" in page.locator("#fig-gripper .words").inner_text()  # its section's
        page.mouse.wheel(0, 3000)
        page.wait_for_timeout(500)
        assert page.evaluate("location.href") == asked


def test_a_link_of_the_text_sets_its_section_and_the_live_figure_follows_the_text(visit):
    with visit() as page:
        link = page.locator("a.try[href*='stiffness=100&']").first
        link.click()
        assert "lcp" not in page.locator("#fig-lanes .words").inner_text()
        assert "text: 10,000" in page.locator("#fig-lanes .chips").inner_text()
        assert page.locator(".drag[data-knob=stiffness]").first.inner_text() == "100"
        for mark in page.locator(".show[data-show*=models]").all()[:4]:
            mark.evaluate(
                "(node) => window.scrollTo(0, node.getBoundingClientRect().top + scrollY - 300)"
            )
            asked = mark.get_attribute("data-show")
            models = re.search(r"models=([\w,]+)", asked)[1].split(",")
            shown = "".join(f":has(.line.m-{model})" for model in models)
            page.wait_for_selector(f"#fig-lanes svg{shown}", state="attached")
            assert page.locator("#fig-lanes .line").count() == len(models)
        page.locator("[data-show=none]").last.evaluate(
            "(node) => node.scrollIntoView({ block: 'center' })"
        )
        page.wait_for_selector("#figure.back", state="attached")


def test_an_explosion_is_drawn_with_a_scale_of_heights(visit):
    with visit("?dt=0.04#in-a-hurry.2") as page:
        page.wait_for_selector("#fig-lanes .line.m-penalty")
        page.wait_for_function(
            "[...document.querySelectorAll('#fig-lanes text')].some(({ textContent }) => "
            "/ m$/.test(textContent))"
        )
        assert page.locator("#fig-lanes circle.ball").count() == 2  # none is lost


def test_a_line_of_code_is_lit_while_it_runs(tab):
    tab.locator("#fig-sponge").scroll_into_view_if_needed()
    sponge = tab.locator("#fig-sponge .handle[data-handle=hand]")
    sponge.press("ArrowDown")
    tab.wait_for_selector("#code-penalty .ln.lit:text('return max(0.0')", state="attached")
    for _ in range(2):
        sponge.press("Shift+ArrowUp")
    tab.wait_for_selector("#code-penalty:not(:has(.ln.lit))", state="attached")


# ---- bets, veils, the blank


def answers(name):
    """The number that tells the answer of a bet."""
    key, form = BETS[name]
    return format(measured(name)[key], form)


def test_no_answer_of_a_bet_is_seen_before_one_click_and_then_it_stays_open(visit):
    with visit(shown=False) as page:
        for name in BETS:
            assert answers(name) not in page.locator("article").inner_text(), name
            after = page.locator(f".part:has(> #{name}) + .veiled")  # what follows the bet
            assert after.locator(".veil-bar").first.is_visible()
            assert not after.locator(".answer").first.is_visible()
        page.locator("#fig-two button").click()
        assert "inside" not in page.locator("#fig-two .words").inner_text()
        for name in BETS:
            right = all_exercises()[name]["answer"]
            other = next(letter for letter in "ABC" if letter != right)
            page.locator(f"#{name} [data-choice={other}]").click()
            result = page.locator(f"#{name}-result")
            assert "otherwise" in result.inner_text() and answers(name)[:5] in result.inner_text()
        page.locator("[data-show=puzzle]").click()
        assert not page.locator(".veil-bar").filter(visible=True).count()
        page.locator("#ex1-why").fill("the spring must be pressed")
        page.reload()
        page.wait_for_selector("[data-ready]", state="attached")
        assert page.locator("#ex1-why").input_value() == "the spring must be pressed"
        assert not page.locator(".veil-bar").filter(visible=True).count()


def test_print_has_figures_and_answers_and_nothing_to_press(unread):
    unread.emulate_media(media="print", reduced_motion="reduce")
    assert not unread.locator("button, input, .live").filter(visible=True).count()
    for drawn in ("#fig-corner .plot", ".printed .line.m-penalty"):
        assert unread.locator(drawn).first.is_visible()
    assert answers("ex1") in unread.locator("article").inner_text()
    unread.emulate_media(media="screen")


def test_show_me_lifts_a_veil_where_its_bar_was_and_focus_goes_there(unread):
    """Of the last bar of a bet, above which all the others open, too; pressed by a mouse."""
    button = unread.locator("[data-show=ex1]").filter(visible=True).last
    at = middle(button)
    veil = ".closest('.veiled').getBoundingClientRect().top"
    top = call(unread, f"(x, y) => document.elementFromPoint(x, y){veil}", *at)
    unread.mouse.click(*at)
    assert not unread.locator(".veiled-ex1 > .veil-bar").filter(visible=True).count()
    assert unread.evaluate("document.activeElement.className") == "answer"
    assert unread.evaluate(f"document.activeElement{veil}") == pytest.approx(top, abs=2)


def test_the_blank_names_a_slip_and_takes_the_right_lines(tab):
    force = tab.locator("#blank-penalty_normal_force")
    impulse = tab.locator("#blank-project_impulse")
    force.fill("stiffness * depth - damping * v_n")
    impulse.fill("lam + max(0, dlam)")
    tab.locator("#blank button").click()
    told = tab.locator("#blank-penalty_normal_force-said").inner_text()
    assert "nothing keeps the table from pulling" in told
    told = tab.locator("#blank-project_impulse-said").inner_text()
    assert "the clamp is on the change" in told
    impulse.fill("max(0, lam + alert(1))")
    tab.locator("#blank button").click()
    assert "alert" in tab.locator("#blank-project_impulse-said").inner_text()
    force.fill("max(0, k*depth - c*v_n)")
    impulse.fill("max(lam + dlam, 0)")
    tab.locator("#blank button").click()
    assert "Both clamps hold" in tab.locator("#blank .tried").inner_text()


# ---- grabbing, keyboard, screens


WIDER = """(width) => document.documentElement.scrollWidth <= width ? [] :
  [...document.querySelectorAll("article *")].filter((each) =>
    each.getBoundingClientRect().right > width && !each.closest(".scroll, .math, svg"))
    .map((each) => each.outerHTML.slice(0, 120))"""


# where text, code and drawings begin, and how far the text is from the middle of the window [px]
EDGES = """() => {
  const parts = "h1, .part > :is(p, ul, ol, h2, h3, .code, .shell, .exercise, .generated, .scroll)";
  const seen = [...document.querySelectorAll(`${parts}, .part > .fig:not(#fig-promise) > .drawing`)]
    .filter((node) => node.checkVisibility() && !node.closest("#figure"));
  const column = document.querySelector(".part > p").getBoundingClientRect();
  const off = column.left + column.right - document.documentElement.clientWidth;
  return [seen.map((node) => Math.round(node.getBoundingClientRect().left)), off / 2];
}"""


@pytest.mark.parametrize("width", [1920, 1280, 1024])
def test_all_begins_at_one_edge_and_the_text_is_in_the_middle(tab, width):
    page_browser.resize(tab, width)
    lefts, off = call(tab, EDGES)
    assert len(lefts) > 240 and len(set(lefts)) == 1
    assert abs(off) < 10  # half a scroll bar


@pytest.mark.parametrize("where", ["tab", "fox"])
@pytest.mark.parametrize("width", [1280, 1024, 390, 320])
def test_at_the_middle_of_every_button_knob_handle_and_ball_is_that_thing(where, width, request):
    """And nothing is wider than the screen."""
    page = request.getfixturevalue(where)
    page_browser.resize(page, width)
    assert call(page, WIDER, width) == []
    assert page.evaluate(page_browser.HITS) == []


@pytest.mark.parametrize(
    "where, gesture",
    [("tab", mouse), ("fox", page_browser.mouse_of_firefox), ("phone", page_browser.finger)],
)
def test_whatever_a_hand_presses_and_moves_changes_the_words_of_its_figure(where, gesture, request):
    page = request.getfixturevalue(where)
    for name in call(page, page_browser.FIGURES):
        x, y, on_top = call(page, page_browser.MIDDLE, name)
        assert on_top, name
        before = call(page, page_browser.WORDS, name)
        moves = gesture(page, x, y)
        assert any(call(page, page_browser.WORDS, name) != before for _ in moves), name
        moves.close()


def test_no_formula_is_smaller_than_16_px_on_a_phone(phone):
    sizes = """() => [...document.querySelectorAll("math")].map((node) =>
      [parseFloat(getComputedStyle(node).fontSize), node.textContent])"""
    assert [each for each in phone.evaluate(sizes) if each[0] < 16] == []


def test_a_ball_stays_under_the_mouse_where_a_figure_is_drawn_smaller_than_on_a_phone(tab):
    page_browser.resize(tab, 320)
    ball = tab.locator("#fig-grab .handle")
    x, y = middle(ball)
    frame = tab.locator("#fig-grab .drawing").bounding_box()
    # towards the middle: at a wall, where another test may have thrown it, it would be kept
    dx = 40 if x < frame["x"] + frame["width"] / 2 else -40
    dy = 30 if y < frame["y"] + frame["height"] / 2 else -30
    for _ in mouse(tab, x, y, ((dx, dy),)):
        call(tab, page_browser.WORDS, "fig-grab")  # once it is drawn
        box = ball.bounding_box()
        place = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        assert place == pytest.approx((x + dx, y + dy), abs=2)


@pytest.mark.parametrize("held", ["#fig-grab .handle", ".drag[data-knob=stiffness]"])
def test_the_right_button_moves_nothing(tab, held):
    node = tab.locator(held).first
    before = node.get_attribute("aria-valuetext")
    for _ in mouse(tab, *middle(node), ((40, -30),), button="right"):
        call(tab, page_browser.WORDS, "fig-grab")
    assert before and node.get_attribute("aria-valuetext") == before


HEIGHT = "Number(document.querySelector('#fig-grab .handle').getAttribute('aria-valuenow'))"


def test_the_first_ball_falls_when_dropped_and_when_thrown(visit):
    with visit(motion="no-preference") as page:
        grip = page.locator("#fig-grab .handle")
        assert grip.evaluate("(node) => getComputedStyle(node).touchAction") == "none"  # a finger
        for _ in mouse(page, *middle(grip), ((-40, -40), (-90, -70))):
            lifted = float(grip.get_attribute("aria-valuenow"))
        page.wait_for_function(f"() => {HEIGHT} < {lifted - 0.1}")


def test_keys_lift_and_drop_the_ball_and_move_the_time_of_the_live_figure(tab):
    grip = tab.locator("#fig-grab .handle")
    before = float(grip.get_attribute("aria-valuenow"))
    grip.focus()
    tab.keyboard.press("ArrowUp")
    tab.wait_for_function(f"() => {HEIGHT} > {before}")
    tab.keyboard.press("Enter")
    tab.wait_for_selector("#fig-grab .words:text('rests')")
    assert tab.evaluate("document.activeElement.dataset.handle") == "ball"  # focus stays


def test_axe_finds_no_violation(tab):
    from axe_playwright_python.base import AXE_SCRIPT

    run = """([parts, rules]) => axe.run(parts, {resultTypes: ["violations"], ...rules}).then(
      ({ violations }) => violations.map(({ id, nodes }) => `${id}: ${nodes[0].target}`))"""
    contrast = [
        ["header", "#fig-grab", "#ex1", "#ex2", "#code-sweep"],
        {"runOnly": ["color-contrast"]},
    ]
    code = ".code:not(#code-sweep) pre"  # they are all made alike
    others = [{"exclude": [[code]]}, {"rules": {"color-contrast": {"enabled": False}}}]
    tab.evaluate(AXE_SCRIPT)
    assert tab.evaluate(run, others) == []
    for scheme in ("dark", "light"):
        tab.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        assert tab.evaluate(run, contrast) == [], scheme


def test_on_a_phone_a_link_opens_half_a_screen_that_closes_as_one_reads_on(visit):
    with visit(width=390, height=800, has_touch=True) as page:
        link = page.locator("a.try").first
        link.evaluate("(node) => node.scrollIntoView({ block: 'end' })")
        link.tap()
        dock = page.locator("#figure.docked").bounding_box()
        assert dock["height"] <= 401 and dock["y"] >= 399
        assert link.bounding_box()["y"] < dock["y"]
        page.evaluate("window.scrollBy(0, 500)")
        page.wait_for_selector("#figure:not(.docked)", state="attached")


@pytest.mark.parametrize(("width", "height", "most"), [(390, 844, 2.0), (1280, 900, 2.0)])
def test_no_long_stretch_is_without_a_picture(visit, width, height, most):
    with visit(width=width, height=height) as page:
        screens, above = page_measure.pacing(page)
        assert 1.0 < screens < most, above


def test_on_a_phone_a_passage_shows_what_the_live_figure_would_and_calls_it_up(visit):
    with visit(width=390, height=844, has_touch=True, shown=False) as page:

        def drawn(section):
            glance = page.locator(f"#{section} button")
            glance.scroll_into_view_if_needed()
            done = "(node) => node.querySelector('.table, text')"
            page.wait_for_function(done, arg=glance.element_handle())
            return glance, set(glance.locator("text").all_text_contents())

        _, words = drawn("in-a-hurry\\.2")
        assert "bet first" in words, "it tells no answer"
        glance, words = drawn("asked-twice\\.2")
        assert {"lcp", "leapfrog"} <= words and "penalty" not in words
        glance.tap()
        page.wait_for_selector("#figure.docked #fig-lanes .handle")
        assert re.search("lcp .*leapfrog", page.locator("#fig-lanes .words").inner_text())


def test_a_finger_holds_the_ball_and_drags_a_number_and_the_page_does_not_scroll(phone):
    ball, number = phone.locator("#fig-grab .handle"), phone.locator(".drag[data-knob=stiffness]")
    seen = []
    for node, told in ((ball, phone.locator("#fig-grab .words")), (number.first, number.first)):
        x, y = middle(node)
        before = phone.evaluate("scrollY")
        for _ in page_browser.finger(phone, x, y, ((10, -12), (20, -24), (30, -40), (50, -60))):
            seen.append(told.inner_text())
        assert node is not ball or phone.evaluate("scrollY") == before
    first, last = (float(re.search(r"A hand holds it ([\d.]+)", seen[k])[1]) for k in (0, 3))
    assert last > first + 0.05 and seen[-1] == "17,800"


def test_a_second_finger_neither_moves_the_ball_that_the_first_holds_nor_lets_it_go(phone):
    ball, told = phone.locator("#fig-grab .handle"), phone.locator("#fig-grab .words")
    frame = phone.locator("#fig-grab .drawing")
    x, y = middle(ball)
    box = frame.bounding_box()
    corner = box["x"] + 20, box["y"] + 20
    seen = []
    for _ in page_browser.finger(phone, x, y, ((9, -30),), (corner,)):
        call(phone, page_browser.WORDS, "fig-grab")
        seen.append((told.inner_text(), ball.bounding_box()))
    assert "A hand holds it" in seen[0][0] and seen[1] == seen[0]


def test_without_scripts_text_figures_and_exercises_are_there(visit):
    with visit(javascript=False, shown=False) as page:
        assert not page.locator(".needs-js").filter(visible=True).count()
        for drawn in ("#fig-grab svg .ball", ".printed .line.m-penalty"):
            assert page.locator(drawn).first.is_visible()
        assert answers("ex1") in page.locator("article").inner_text()  # no veil without a script
        assert page.locator("#ex1 .no-js-only").is_visible()


def test_in_firefox_a_key_drops_the_ball(fox):
    x, y, _ = call(fox, page_browser.MIDDLE, "fig-grab", "ball")
    fox.pointer((x, y), "Down", (x, y - 20), "Up")
    fox.press("\ue013", "\ue007")  # arrow up, Enter
    words = "document.querySelector('#fig-grab .words').textContent"
    rests = f"new Promise((done) => setTimeout(() => done({words}), 400))"
    assert "rests" in fox.evaluate(rests)


def test_a_lit_line_that_is_not_exactly_one_line_of_the_code_stops_the_build():
    regions = {
        "sweep": SimpleNamespace(code="for c in contacts:\n    c.push(1.0)\n    c.push(2.0)\n")
    }
    check_lines({"found": ["sweep", "for c in"]}, regions)
    for region, text, count in (("sweep", "c.push", 2), ("sweep", "lam", 0), ("gone", "for c", 0)):
        with pytest.raises(ValueError, match=f"in {count} lines"):
            check_lines({"lost": [region, text]}, regions)
