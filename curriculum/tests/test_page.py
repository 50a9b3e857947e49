"""The page: every promise of its controls and its text, in a real Chromium."""

import base64
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

pytest.importorskip(
    "markdown_it", reason="the page's libraries are missing: pip install -e '.[page]'"
)
pytest.importorskip(
    "py_mini_racer", reason="the page's libraries are missing: pip install -e '.[page]'"
)

import contact  # noqa: E402
from curriculum import terminal  # noqa: E402
from curriculum.page import build as page_build  # noqa: E402
from curriculum.page import prose  # noqa: E402
from curriculum.tests.page_browser import (  # noqa: E402
    CHROMIUM,
    needs_chromium,
    running,
    small_page,
    visiting,
)

ROOT = page_build.regions.ROOT
FLAGS = {
    "dt": "--dt",
    "stiffness": "--stiffness",
    "damping": "--damping",
    "baumgarte": "--baumgarte",
    "iters": "--iters",
    "impedance": "--solimp",
    "restitution": "--restitution",
}
OWNER = {
    "stiffness": "penalty",
    "damping": "penalty",
    "baumgarte": "lcp",
    "iters": "lcp",
    "restitution": "exact",
    "impedance": "soft",
}
FIGURES = (
    "balance",
    "dive",
    "long-step",
    "corner",
    "sweeps",
    "clamp",
    "larger",
    "hop",
    "bounces",
    "cradle",
    "slide",
    "impedance",
    "one-line",
    "cliff",
)


@pytest.fixture(scope="module", autouse=True)
def runs_made_once():
    """Every build of this file quotes the same runs: they are made once."""
    numbers = page_build.Numbers(ROOT)
    with patch.object(page_build, "Numbers", lambda root: numbers):
        yield


@pytest.fixture(scope="module")
def html():
    return small_page()


@pytest.fixture(scope="module")
def url(html, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "contact.html"
    path.write_text(html, encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def browser():
    if CHROMIUM is None:
        pytest.skip("no Chromium here: apt-get install chromium")
    with running() as chromium:
        yield chromium


def state(page):
    return page.evaluate(
        "({...Figure.state, time: Figure.time, view: Figure.view, "
        "playing: Figure.playing, steps: Figure.now.steps})"
    )


def eventually(page, question, seconds=5.0):
    """What the page answers as soon as that is true; the page's policy forbids Playwright's own wait."""
    for _ in range(int(seconds / 0.02)):
        answer = page.evaluate(question)
        if answer:
            return answer
        page.wait_for_timeout(20)
    raise AssertionError(f"not within {seconds} s: {question}")


def numbers_in(text):
    return [
        float(each.replace("−", "-").replace(",", ""))
        for each in re.findall(r"−?\d[\d,]*\.?\d*(?:e[+−-]?\d+)?", text)
    ]


# ---- the live figure


@needs_chromium
def test_the_engine_in_the_browser_has_the_bits_of_contact_py(browser, url):
    with visiting(browser, url) as page:
        for scene, dt in (("drop", 0.002), ("bounce", 0.008), ("stack", 0.004)):
            built = contact.build_scene(scene)
            got = page.evaluate(
                """([scene, dt]) => {
              Figure.take({...State.read(`?scene=${scene}&dt=${dt}`).state});
              const text = (a) => btoa(String.fromCharCode(...new Uint8Array(a.buffer, 0, 8 * Math.min(900, a.length))));
              return ContactEngine.MODELS.map((m) => text(Figure.now.runs[m].vy));
            }""",
                [scene, dt],
            )
            for model, packed in zip(contact.MODELS, got):
                run = contact.run_model(model, built, dt, 1000)
                mine = np.frombuffer(base64.b64decode(packed))
                theirs = np.ascontiguousarray(run.v[:, 1]).ravel()[: min(900, len(mine))]
                if model == "exact":
                    assert np.abs(mine - theirs).max() < 1e-10
                else:
                    assert (mine.view(np.uint64) == theirs.view(np.uint64)).all(), (scene, model)


@needs_chromium
def test_every_knob_moves_the_run_the_address_and_the_command(browser, url):
    typed = {
        "iters": "3",
        "restitution": "0.5",
        "baumgarte": "0.5",
        "dt": "0.01",
        "impedance": "0.99",
    }
    with visiting(browser, url) as page:
        page.click("#inside summary")
        for name, flag in FLAGS.items():
            if name in OWNER:
                page.check(f'input[name="contact"][value="{OWNER[name]}"]', force=True)
            before = float(page.input_value(f"#{name}-number"))
            page.locator(f"#{name}-range").focus()
            for _ in range(3):
                page.keyboard.press("ArrowRight")
            moved = state(page)[name]
            assert moved > before, name
            assert float(page.input_value(f"#{name}-number")) == pytest.approx(moved, abs=1e-11)
            assert f"{flag} " in page.inner_text("#command")
            page.fill(f"#{name}-number", typed.get(name, "123.5"))
            page.keyboard.press("Tab")
            assert state(page)[name] == float(typed.get(name, "123.5"))
        wanted = state(page)
        page.wait_for_timeout(400)  # the address is written a moment after the last change
        link = page.url
        command = page.inner_text("#command")
    with visiting(browser, link) as page:
        assert {name: state(page)[name] for name in FLAGS} == {name: wanted[name] for name in FLAGS}
    terminal.parse_flags(command.split()[2:])  # the command is one that contact.py takes


@needs_chromium
def test_a_number_that_is_not_allowed_is_refused_in_words(browser, url):
    with visiting(browser, url) as page:
        for name, bad in (
            ("dt", "0"),
            ("dt", "7"),
            ("iters", "2.5"),
            ("restitution", "-1"),
            ("stiffness", ""),
        ):
            page.evaluate(f"document.getElementById('{name}-number').value = ''")
            page.evaluate(f"document.getElementById('{name}-number').value = '{bad}'")
            page.dispatch_event(f"#{name}-number", "change")
            assert "is not allowed" in page.text_content(f"#{name}-error")
            assert page.get_attribute(f"#{name}-number", "aria-invalid") == "true"
        assert state(page)["dt"] == 0.002


@needs_chromium
@pytest.mark.parametrize(
    "query",
    [
        "?scene=constructor",
        "?scene=__proto__&contact=toString",
        "?damping=&dt=",
        "?dt=NaN&seed=1e9",
        "?solref=1&t=-1",
        "?seed=&lens=5",
    ],
)
def test_an_address_that_makes_no_sense_shows_the_default(browser, url, query):
    with visiting(browser, url, query=query) as page:
        found = state(page)
        assert found["scene"] == "drop" and found["dt"] == 0.002 and found["seed"] == 0
        assert found["damping"] == contact.build_scene("drop").damping
        assert page.evaluate("document.documentElement.classList.contains('js')")


@needs_chromium
def test_it_opens_on_the_contact_and_zooms(browser, url):
    with visiting(browser, url) as page:
        landing = math.sqrt(2 * (contact.build_scene("drop").q0[1, 0] - 0.1) / 9.81)
        low, high = state(page)["view"]
        assert landing - 0.1 < low < landing < high < landing + 1.0
        page.click("#zoom-in")
        assert state(page)["view"][1] - state(page)["view"][0] == pytest.approx((high - low) / 2)
        box = page.locator("#chart").bounding_box()
        page.mouse.move(box["x"] + 200, box["y"] + 60)
        zoomed = state(page)["view"]
        page.keyboard.down("Shift")
        page.mouse.wheel(0, 100)
        page.keyboard.up("Shift")
        assert eventually(page, f"() => Figure.view[0] > {zoomed[0]}")
        assert np.ptp(state(page)["view"]) == pytest.approx(np.ptp(zoomed)), "moved, not stretched"
        page.click("#view-all")
        assert state(page)["view"] == [0, 4]
        page.click("#view-contact")
        assert state(page)["view"] == [low, high]
        box = page.locator("#chart").bounding_box()
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 60)
        assert numbers_in(page.inner_text("#readout"))[0] == pytest.approx(
            (low + high) / 2, abs=0.1
        )
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 60)
        assert state(page)["time"] == pytest.approx((low + high) / 2, abs=0.1)


@needs_chromium
def test_run_pause_and_step(browser, url):
    with visiting(browser, url, motion="no-preference") as page:
        assert not state(page)["playing"]
        page.click("#run")
        page.wait_for_timeout(300)
        page.click("#run")
        stopped = state(page)
        assert stopped["view"][0] < stopped["time"] < stopped["view"][1] and not stopped["playing"]
        row = int(page.input_value("#scrub"))
        page.click("#step")
        page.click("#step")
        page.click("#back")
        assert int(page.input_value("#scrub")) == row + 1
        page.locator("#scrub").focus()
        page.keyboard.press("ArrowRight")
        assert f"step {row + 2} of" in page.get_attribute("#scrub", "aria-valuetext")


@needs_chromium
def test_the_force_is_drawn_weight_against_push(browser, url):
    with visiting(browser, url) as page:
        for lane, weights in (("penalty", 0.96), ("lcp", 1.0), ("exact", 1.0)):
            assert page.locator(f"#lane-{lane} .arrow.weight").count() == 1
            assert page.locator(f"#lane-{lane} .arrow.push").count() == 1
            shown = numbers_in(page.inner_text(f"#push-{lane}"))[0]
            assert shown == pytest.approx(weights, abs=0.1), "at rest the push is the weight"


@needs_chromium
def test_the_lens_never_hides_the_ball_it_looks_at(browser, url):
    """Whatever the step, the ball's lower edge is inside its lens when it is less than 2.7 r deep."""
    with visiting(browser, url) as page:
        for query in (
            "?dt=0.064&contact=lcp",
            "?stiffness=1000",
            "",
            "?scene=stack&stiffness=1000",
        ):
            found = page.evaluate(
                """(query) => {
              Figure.take(State.read(query).state);
              const seen = [];
              for (const row of [0.2, 0.4, 0.6, 0.8, 1].map((s) => Math.floor(s * Figure.now.steps))) {
                const gaps = ContactEngine.MODELS.map((m) => Figure.now.series[m].gap[row]);
                const reach = Lane.fittingLens(gaps);
                seen.push(...gaps.filter((g) => g < 2.7 && g > -2.7).map((g) => Math.abs(g) <= reach));
              }
              return seen;
            }""",
                query,
            )
            assert found and all(found), query


@needs_chromium
def test_inside_one_step_shows_gaps_and_lam_after_each_sweep(browser, url):
    with visiting(browser, url, query="?scene=stack&iters=7&t=0.1") as page:
        page.click("#inside summary")
        scene = contact.build_scene("stack")
        run = contact.run_model("lcp", scene, 0.002, 50, iters=7)
        balls = [
            contact.Ball(*each)
            for each in zip(*run.q[50].tolist(), *run.v[50].tolist(), [1.0] * 3, [0.1] * 3)
        ]
        contacts = contact.detect_contacts(balls)
        for c in contacts:
            c.target = contact.contact_target(c, 0.0, 0.2, 0.002)
        contact.fall(balls, 0.002)
        contact.solve_contacts(contacts, 7)
        last = page.locator("#inside-lcp table").nth(1).locator("tbody tr").last
        shown = [float(text.replace("−", "-")) for text in last.locator("td").all_inner_texts()]
        assert shown == pytest.approx([c.lam for c in contacts], rel=1e-5)
        rows = page.locator("#results tbody tr").all_inner_texts()
        assert rows[0].split("\t")[0] == "deepest / r" and len(rows[0].split("\t")) == 5


# ---- the text drives the figure


@needs_chromium
def test_links_of_the_text_set_the_figure_and_back_returns(browser, url):
    with visiting(browser, url) as page:
        links = page.locator("a.try").all()
        assert len(links) >= 4
        before = state(page)["scene"], state(page)["dt"]
        for link in links:
            link.click()
            wanted = dict(part.split("=") for part in link.get_attribute("href")[1:].split("&"))
            for name, value in wanted.items():
                found = state(page)["time" if name == "t" else name]
                assert found == value or found == pytest.approx(float(value)), (wanted, name)
        for _ in links:
            page.go_back()
        assert (state(page)["scene"], state(page)["dt"]) == before
        page.go_forward()
        assert page.url.split("?")[1] and state(page)["contact"] == "penalty"


@needs_chromium
def test_numbers_in_sentences_can_be_dragged_and_turned_by_keys(browser, url):
    with visiting(browser, url) as page:
        for number in page.locator("span.drag").all():
            name = number.get_attribute("data-knob")
            number.scroll_into_view_if_needed()
            before = float(number.get_attribute("data-value"))
            box = number.bounding_box()
            page.mouse.move(box["x"] + 3, box["y"] + 5)
            page.mouse.down()
            page.mouse.move(box["x"] + 43, box["y"] + 5, steps=3)
            page.mouse.up()
            dragged = float(number.inner_text())
            assert dragged > before and state(page)[name] == pytest.approx(dragged, abs=1e-11), name
            page.keyboard.press("ArrowLeft")
            assert float(number.inner_text()) < dragged
            assert number.get_attribute("aria-valuenow") == number.inner_text()


@needs_chromium
def test_the_figure_stays_beside_the_text_on_a_wide_screen_and_docks_on_a_phone(browser, url):
    with visiting(browser, url, width=1024, height=700) as page:
        page.locator("#fig-slide").scroll_into_view_if_needed()
        assert page.evaluate("""() => {
          const box = document.getElementById("lanes-box").getBoundingClientRect();
          return box.top >= 0 && box.bottom <= innerHeight;
        }""")
    with visiting(browser, url, width=375, height=740, is_mobile=True, has_touch=True) as page:
        link = page.locator("a.try").nth(1)
        link.scroll_into_view_if_needed()
        link.tap()
        box = page.locator("#lanes-box").bounding_box()
        assert 0 <= box["y"] and box["y"] + box["height"] <= 740, "lanes in sight beside the link"
        for knob in ("#dt-range", "#baumgarte-range"):
            box = page.locator(knob).bounding_box()
            assert box["y"] + box["height"] <= 740, "and the knobs in use"
        page.locator("#undock").tap()
        assert page.locator(".docked").count() == 0


@needs_chromium
def test_scene_dt_own_knob_lanes_and_chart_fit_one_screen(browser, url):
    parts = ("#figure .choice-row", "#run", "#lanes-box", "#dt-range", "#stiffness-range", "#chart")
    for width, height in ((1024, 700), (1280, 800), (1440, 900)):
        with visiting(browser, url, width=width, height=height) as page:
            for part in parts:
                box = page.locator(part).first.bounding_box()
                assert box["y"] + box["height"] <= height, (part, width, box)


# ---- the small figures


class Clock:
    """How long the page's own thread works [ms], not how long a busy machine lets it wait."""

    def __init__(self, page):
        self.page, self.session = page, page.context.new_cdp_session(page)
        self.session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def read(self):
        metrics = self.session.send("Performance.getMetrics")["metrics"]
        return 1000 * next(each["value"] for each in metrics if each["name"] == "TaskDuration")

    def time(self, script, argument):
        """(result, ms) of a script, with the layout and paint that follow it."""
        before = self.read()
        result = self.page.evaluate(script, argument)
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
        return result, self.read() - before


MOVE = """([name, share]) => {
  const slider = document.getElementById(`${name}-slider`);
  slider.value = String(Math.round(slider.max * share));
  slider.dispatchEvent(new Event("input"));
  const figure = document.getElementById(`fig-${name}`);
  return {look: figure.querySelector(".drawing").innerHTML, words: figure.innerText,
          balls: figure.querySelectorAll("circle").length};
}"""


@needs_chromium
def test_small_figures_answer_their_sliders_within_fifty_milliseconds(browser, url):
    with visiting(browser, url) as page:
        clock = Clock(page)
        for name in FIGURES:
            page.evaluate(MOVE, [name, 0.5])  # what is computed once is computed
            found = [clock.time(MOVE, [name, share]) for share in (0, 0.3, 0.7, 1)]
            assert len({each["look"] for each, _ in found}) == 4, name
            assert min(ms for _, ms in found) < 50, (name, found)
            for each, _ in found:
                assert each["balls"] > 0 or name == "cliff", name
                assert "NaN" not in each["words"] and "not a number" not in each["words"], name


@needs_chromium
def test_a_knob_of_the_live_figure_answers_within_fifty_milliseconds(browser, url):
    with visiting(browser, url) as page:
        clock = Clock(page)
        for scene in ("drop", "bounce", "stack"):
            page.evaluate("(scene) => Figure.take(State.read(`?scene=${scene}`).state)", scene)
            times = [
                clock.time("(stiffness) => { Figure.set({stiffness}); }", k)[1]
                for k in (9000, 9500, 11000, 12000)
            ]
            assert min(times) < 50, (scene, times)


def last_push(model):
    """The angles [deg] at which contact.py's last step with a push begins and ends, on the ball of slide.

    And what the chapter says of the way there: lcp's ball is a hair apart after every step.
    """
    q0 = np.array([[0.0, 0.2 * math.sin(0.35)], [5.0, 5.0 + 0.2 * math.cos(0.35)]])
    radius, mass = np.full(2, contact.RADIUS), np.array([math.inf, 1.0])
    scene = contact.Scene("slide", q0, np.zeros((2, 2)), mass, radius, 0.0, 80.0)
    run = contact.run_model(model, scene, 0.002, 500, iters=50)
    x, y = run.q[:, 0, 1], run.q[:, 1, 1] - 5.0
    kick = np.diff(run.v[:, :, 1], axis=0) - [0.0, 0.002 * contact.GRAVITY]
    last = np.flatnonzero(np.hypot(*kick.T) > 1e-6)[-1]
    if model == "lcp":
        assert (np.hypot(x, y)[1 : last + 1] > 0.2).all()
        assert (np.hypot(x, y)[1 : last + 1] < 0.2 + contact.CONTACT_MARGIN).all()
    return tuple(np.degrees(np.arctan2(x, y))[[last, last + 1]])


@needs_chromium
def test_small_figures_say_what_is_true(browser, url):
    with visiting(browser, url) as page:

        def words(name, value):
            return page.evaluate(
                "([name, value]) => SmallFigures.render(name, value, 500, () => true).words",
                [name, value],
            )

        assert "0.00981 r" in words("balance", 1e4) and "0.0981 r" in words("balance", 1e3)
        assert numbers_in(words("hop", 0.2))[1:3] == pytest.approx([0, 0.113], abs=0.001)
        assert numbers_in(words("clamp", 12))[1] < 1e-6 < 0.1 < numbers_in(words("clamp", 12))[2]
        e = numbers_in(words("larger", 0.002))
        assert abs(e[1] - 0.7) < 0.01 < abs(e[2] - 0.7)
        release = numbers_in(words("slide", 0.3))[0]
        assert release == pytest.approx(math.degrees(math.acos(2 / 3 * math.cos(0.35))), abs=0.01)
        told = re.findall(r"(\w+):? ([\d.]+)°(?: to ([\d.]+)°)?", words("slide", 0.3))
        leaves = {model: (float(low), float(high or low)) for model, low, high in told[1:]}
        assert leaves["exact"][0] == pytest.approx(release, abs=0.011)
        for model in ("penalty", "lcp", "soft"):
            assert leaves[model] == pytest.approx(last_push(model), abs=0.051), model
        assert leaves["soft"][1] < release < leaves["penalty"][0]
        assert leaves["lcp"][0] - 0.051 < release < leaves["lcp"][1]
        soft = contact.run_model(
            "soft",
            contact.Scene(
                "rest",
                np.array([[0.0], [0.1]]),
                np.zeros((2, 1)),
                np.ones(1),
                np.full(1, 0.1),
                0.0,
                0.0,
            ),
            0.002,
            1000,
            solimp=(0.99, 0.99, 0.001, 0.5, 2.0),
        )
        depth = 1 - soft.q[-1, 1, 0] / 0.1
        assert numbers_in(words("one-line", 0.01))[0] == pytest.approx(depth, rel=0.01)
        touching, apart = words("cradle", 0), words("cradle", 0.1)
        assert numbers_in(touching)[:4] == pytest.approx([-1.0, 1.0, 1.0, 1.0], abs=0.01)
        assert numbers_in(apart)[:4] == pytest.approx([0, 0, 0, 2], abs=0.01)


@needs_chromium
def test_the_puzzle_has_no_answer_and_says_why_after_a_try(browser, url):
    with visiting(browser, url) as page:
        assert page.locator("#puzzle-give").is_disabled()
        stiffness = page.locator("#puzzle-k")
        stiffness.focus()
        page.keyboard.press("End")  # stiff enough: and it explodes
        page.locator("#goal-sink[data-met]").wait_for()
        assert page.get_attribute("#goal-rest", "data-met") is None
        stiffness.focus()
        page.keyboard.press("Home")
        page.locator("#goal-rest[data-met]").wait_for()
        assert page.get_attribute("#goal-sink", "data-met") is None
        assert page.locator(".veiled-puzzle > .answer").is_hidden()
        page.click("#puzzle-give")
        why = page.locator("#puzzle-why")
        why.wait_for(timeout=30_000)
        assert page.locator(".veiled-puzzle > .answer").is_visible()
        text = why.inner_text()
        assert "There is none" in text and "98,100 N/m" in text and "40,000 N/m" in text
        depth = float(re.search(r"least depth at rest was ([\d.]+) r", text)[1])
        assert 0.0025 < depth < 0.005  # 40,000 N/m would sink 0.00245 r


@needs_chromium
def test_balls_of_the_sandbox_come_to_rest_and_can_be_added(browser, url):
    with visiting(browser, url) as page:
        page.locator("#sandbox").scroll_into_view_if_needed()
        page.click("#sandbox-clear")
        page.click("#sandbox-add")
        page.evaluate("Sandbox.advance(3)")
        assert page.evaluate("Sandbox.state.y[0]") == pytest.approx(0.1, abs=1e-3)
        box = page.locator("#sandbox-picture").bounding_box()
        page.mouse.click(box["x"] + 60, box["y"] + 60)
        assert page.evaluate("Sandbox.state.y.length") == 2


# ---- exercises


@needs_chromium
def test_nothing_shows_a_bets_answer_before_the_bet(browser, url):
    with visiting(browser, url, shown=False) as page:
        assert page.locator("#veil").is_visible()
        page.wait_for_timeout(200)
        shown = page.inner_text("body")
        for told in (
            "0.251",
            "0.25 r",
            "0.00981",
            "0.0098",
            "0.0096",
            "1,409",
            "0.0135",
            "EXPLODED",
        ):
            assert told not in shown.split("\nBuild")[0], told
        assert page.locator("#chart path.line").count() == 0
        page.click("#run")
        assert not state(page)["playing"]
        page.locator("#veil-show").click()
        assert page.locator("#veil").is_hidden() and page.locator("#chart path.line").count() == 4
        page.evaluate("Figure.set({dt: 0.03})")
        assert page.locator("#veil").is_visible(), "a long step is exercise 3's answer"
        assert page.locator(".veiled-ex3 > .answer").first.is_hidden()
        page.locator("button[data-show=ex3]").first.click()
        assert (
            page.locator("#veil").is_hidden()
            and page.locator(".veiled-ex3 > .answer").first.is_visible()
        )


@needs_chromium
def test_predict_commit_reveal_by_keyboard_alone(browser, url):
    with visiting(browser, url, shown=False) as page:
        form = page.locator("#ex3 form")
        form.locator("input").first.focus()
        assert page.locator("#ex3-result").is_hidden()
        page.keyboard.press("Tab")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")  # nothing chosen
        assert "Choose one first" in page.inner_text("#ex3-error")
        page.keyboard.press("Space")
        page.keyboard.press("Tab")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")  # no reason
        assert "in a sentence" in page.inner_text("#ex3-error")
        page.keyboard.type("A longer step is longer for both of them.")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")
        assert page.evaluate("document.activeElement.id") == "ex3-result", (
            "focus goes to the result"
        )
        result = page.inner_text("#ex3-result")
        assert "You predicted A. The measurement says B." in result and "A longer step is" in result
        assert "1,409" in result and "EXPLODED" in result and "Why not what you chose" in result
        page.reload()
        assert "The measurement says B." in page.inner_text("#ex3-result")
        page.get_by_role("button", name="Clear my answer").click()
        assert (
            page.locator("#ex3-result").is_hidden() and form.locator("input:enabled").count() == 3
        )


@needs_chromium
def test_a_right_prediction_is_told_so_with_the_measurement(browser, url):
    with visiting(browser, url, shown=False) as page:
        page.check('#ex1 input[value="C"]')
        page.fill("#ex1-why", "A spring must be <b>pressed</b> before it pushes.")
        page.click("#ex1 button[type=submit]")
        result = page.inner_text("#ex1-result")
        assert "The measurement agrees." in result and "0.251" in result and "0.00981" in result
        assert "<b>pressed</b>" in result, "what a reader types is text"
        assert "Why not what you chose" not in result and result.count("Why not the others") == 1
        assert page.locator("#veil").is_hidden()


@needs_chromium
def test_what_a_bet_measures_in_the_page_is_what_its_exercise_measures(browser, url):
    """Exercise 4's own measure() in Python, and the page's table."""
    scene = contact.build_scene("drop")
    depths = []
    for model in ("soft", "penalty"):
        for mass in (1.0, 10.0):
            heavy = scene._replace(mass=mass * scene.mass)
            run = contact.run_model(model, heavy, 0.002, 2000)
            depths.append(contact.contact_quality(run, heavy, 0.002)["rest_penetration_frac"])
    with visiting(browser, url, shown=False) as page:
        page.check('#ex4 input[value="A"]')
        page.fill("#ex4-why", "The mass cancels in both terms.")
        page.click("#ex4 button[type=submit]")
        cells = page.locator("#ex4-result td").all_inner_texts()
        assert [float(each) for each in cells] == pytest.approx(depths, rel=0.005)
        assert depths[0] == pytest.approx(depths[1]) and depths[3] > 9 * depths[2]


@needs_chromium
def test_the_blank_is_filled_in_the_page_and_each_clamp_matters(browser, url):
    f_n, lam = "#blank-penalty_normal_force", "#blank-project_impulse"
    wrong = {
        f_n: (
            "stiffness * depth - damping * v_n",
            "max(0, stiffness * depth + damping * v_n)",
            "max(0, stiffness * depth)",
            "stiffness",
            "depth.constructor",
        ),
        lam: ("lam + dlam", "lam + max(0, dlam)", "max(0, dlam)", "max(0, lam", "alert(1)"),
    }
    with visiting(browser, url) as page:

        def attempt(first, second):
            page.fill(f_n, first)
            page.fill(lam, second)
            page.locator("#blank button").click()
            return [page.inner_text(f"{name}-said") for name in (f_n, lam)]

        for first, second in zip(*wrong.values()):
            said = attempt(first, second)
            assert all(each and "Right" not in each for each in said), said
        unclamped = attempt("stiffness * depth - damping * v_n", "lam + max(0, dlam)")
        pictures = [page.inner_html(f"{name}-drawing") for name in (f_n, lam)]
        widths = [
            page.locator(f"{name}-drawing svg").bounding_box()["width"] for name in (f_n, lam)
        ]
        assert min(widths) >= 400, "as wide as the column, also the first time"
        said = attempt("max(0, stiffness * depth - damping * v_n)", "max(0.0, lam + dlam)")
        assert all("Right in all" in each for each in said) and unclamped != said
        assert "Both clamps hold" in page.inner_text("#blank-said")
        for name, before in zip((f_n, lam), pictures):
            assert page.inner_html(f"{name}-drawing") != before, "the scene shows the difference"


def test_the_cases_of_the_blank_are_those_of_checks_py():
    cases = page_build.blank_cases(ROOT)
    assert set(cases) == {"penalty_normal_force", "project_impulse"}
    for name, inputs in cases.items():
        assert len(inputs) > 50
        for case in inputs:
            assert isinstance(getattr(contact, name)(**case), float)


# ---- without scripts, on a phone, in print, for everyone


@needs_chromium
def test_without_javascript_true_stills_and_no_dead_control(browser, url):
    with visiting(browser, url, javascript=False) as page:
        for kind in ("button", "input", "select", "textarea", "output"):
            assert page.locator(f"{kind}:visible").count() == 0, kind
        assert page.locator(".small svg:visible").count() == len(FIGURES)
        page.locator("summary", has_text="Show how it ends").click()
        assert "0.0098 r in" in page.locator("details .lane").first.inner_text()
        assert "touching" in page.locator("details .lane").nth(1).inner_text()
        page.locator("#contents summary").click()
        page.locator(".contents a").nth(3).click()
        assert "#" in page.url


@needs_chromium
@pytest.mark.parametrize("width", [320, 375, 390])
def test_a_phone_shows_everything_large_enough(browser, url, width):
    with visiting(browser, url, width=width, height=740, is_mobile=True, has_touch=True) as page:
        page.click("#inside summary")
        page.evaluate("for (const d of document.querySelectorAll('details')) d.open = true")
        page.check('#ex1 input[value="A"]')
        page.fill("#ex1-why", "One contact is as good as another.")
        page.click("#ex1 button[type=submit]")
        for name in FIGURES:
            page.locator(f"#fig-{name}").scroll_into_view_if_needed()
        page.wait_for_timeout(100)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert not page.evaluate(WIDE), width
        assert not page.evaluate(SMALL_TARGETS), width
        assert not page.evaluate(TINY_TEXT), width


WIDE = """() => [...document.querySelectorAll('body *')].filter((e) => {
  const box = e.getBoundingClientRect();
  if (!box.width || e.closest('.hidden, .skip, .scroll, defs, clipPath, .air, .lens, g[clip-path], math')) return false;
  return box.right > innerWidth + 1 || box.left < -1;
}).map((e) => e.outerHTML.slice(0, 120))"""
SMALL_TARGETS = """() => [...document.querySelectorAll('a[href], button, input, select, textarea, summary')].filter((e) => {
  if (!e.checkVisibility({visibilityProperty: true}) || e.closest('.skip')) return false;
  if (e.tagName === 'A' && e.closest('p, td, li') && !e.closest('.contents')) return false;  // in a sentence
  const box = (e.matches('input[type=radio]') ? e.closest('label') : e).getBoundingClientRect();
  return box.height < 43.9 || box.width < 43.9;
}).map((e) => e.outerHTML.slice(0, 90))"""
TINY_TEXT = """() => {
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found = new Set();
  for (let node; (node = walk.nextNode());) {
    const e = node.parentElement;
    if (!node.textContent.trim() || e.closest('script, style, template, .hidden, title, annotation')
        || !e.checkVisibility()) continue;
    if (e.closest('math') && e.closest('msub, msup, mfrac, msubsup')) continue;
    let size = parseFloat(getComputedStyle(e).fontSize);
    const svg = e.closest('svg');
    if (svg) size *= svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
    if (size < 13.9) found.add(`${size.toFixed(2)} ${e.outerHTML.slice(0, 80)}`);
  }
  return [...found];
}"""
AXE = """([part, rules]) => axe.run(part, {resultTypes: ["violations"], ...rules}).then((result) => result.violations.map(
    (each) => `${each.id}: ${each.nodes.slice(0, 3).map((node) => node.html.slice(0, 120)).join(" | ")}`))"""
# code is long and plain: it is left to one panel
MOST = {
    "include": [["html"]],
    "exclude": [["#source-lcp-sweep"], ["#source-soft"], ["#source-contacts"]],
}


@needs_chromium
@pytest.mark.parametrize(
    "rules, options",
    [
        ({}, {}),
        ({"runOnly": ["color-contrast"]}, {"color_scheme": "dark"}),
        ({}, {"width": 375, "height": 812}),
        ({}, {"shown": False}),
    ],
    ids=["light", "dark", "phone", "before the bets"],
)
def test_axe_finds_no_violation(browser, url, rules, options):
    axe = pytest.importorskip(
        "axe_playwright_python.base", reason="axe is missing: pip install -e '.[test]'"
    )
    with visiting(browser, url, **options) as page:
        page.evaluate(axe.AXE_SCRIPT)
        found = page.evaluate(AXE, [MOST, rules])
        assert not found, "\n".join(found)


@needs_chromium
def test_nothing_moves_after_the_first_paint(browser, url):
    """The sum of layout shifts, as the browser measures them, while the page loads and is scrolled."""
    for width, height in ((1440, 900), (1280, 800), (375, 740)):
        with visiting(browser, url, width=width, height=height, motion="no-preference") as page:
            page.evaluate("""() => { window.shift = 0;
              new PerformanceObserver((list) => {
                for (const e of list.getEntries()) if (!e.hadRecentInput) window.shift += e.value;
              }).observe({type: "layout-shift", buffered: true}); }""")
            for share in (0, 0.3, 0.6, 0.9):
                page.evaluate(
                    "(s) => scrollTo(0, s * document.documentElement.scrollHeight)", share
                )
                page.wait_for_timeout(120)
            assert page.evaluate("window.shift") < 0.1, (width, page.evaluate("window.shift"))


@needs_chromium
def test_the_first_paint_comes_within_half_a_second(browser, url):
    """The least of three loads."""
    times = []
    for _ in range(3):
        with visiting(browser, url) as page:
            times.append(
                eventually(
                    page,
                    "() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime",
                )
            )
    assert min(times) < 500, times


@needs_chromium
def test_print_shows_stills_whole_code_and_no_controls(browser, url):
    with visiting(browser, url) as page:
        page.emulate_media(media="print")
        for kind in ("button", "input", "select", "textarea"):
            assert page.locator(f"{kind}:visible").count() == 0, kind
        cut = page.evaluate("""() => [...document.querySelectorAll('.ln, pre')].filter(
          (e) => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1).length""")
        assert cut == 0
        assert page.locator(".terminal code:visible").count() == 0
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert page.locator(".terminal code:visible").count() == 4, "on paper nothing unfolds"
        page.evaluate("dispatchEvent(new Event('afterprint'))")
        assert page.locator(".terminal code:visible").count() == 0
        assert page.pdf()[:5] == b"%PDF-"


@needs_chromium
def test_forced_colours_keep_controls_and_models_apart(browser, url):
    with visiting(browser, url, forced_colors="active") as page:
        assert page.evaluate("matchMedia('(forced-colors: active)').matches")
        look = page.evaluate("""() => {
          const style = (q) => getComputedStyle(document.querySelector(q));
          return {chosen: style('#figure input[name=scene]:checked + span').backgroundColor,
                  other: style('#figure input[name=scene]:not(:checked) + span').backgroundColor,
                  slider: style('#dt-range').forcedColorAdjust, ball: style('#lane-penalty .ball').fill,
                  lcp: style('#lane-lcp .ball').fill};
        }""")
        assert look["chosen"] != look["other"] and look["slider"] == "none"
        assert look["ball"] != look["lcp"]


# ---- the text and the file


def test_the_page_is_one_small_file_and_the_same_bytes_each_time(html, tmp_path):
    chapter = Path(__file__).with_name("page_chapter.md")
    code = (
        "import sys; from curriculum.page import build; "
        "open(sys.argv[1], 'w', encoding='utf-8').write("
        "build.build(chapter=open(sys.argv[2], encoding='utf-8').read()))"
    )
    out = tmp_path / "again.html"
    subprocess.run(
        [sys.executable, "-c", code, str(out), str(chapter)],
        check=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONHASHSEED": "1"},
    )
    assert out.read_text("utf-8") == html
    assert not re.search(
        r"""<(?:link|script|img|iframe|object|source)[^>]+(?:src|href)=["'](?!data:)""", html
    )
    assert not re.search(r"@import|url\((?!#|\"data:font)", html.split("</style>")[0])
    assert "default-src &#39;none&#39;" in html


@pytest.mark.parametrize(
    "extra, what",
    [
        ("```\n[include-by-region: contact.py#friction]\n```", "no such region"),
        ("<!-- figure: sinks -->", "a slot for 'figure:sinks'"),
        ("<!-- exercise: ex9 -->", "a slot for 'exercise:ex9'"),
        ("<div>hand-made</div>", "raw HTML"),
        ("[this](try:scene=drop&stifness=3)", "sets 'stifness'"),
        ("[this](try:dt=3)", "dt cannot be '3'"),
        ("[this](try:)", "sets nothing"),
        ("[0.1](drag:gravity)", "drag:gravity is no knob"),
        ("[much](drag:dt)", "dt cannot be 'much'"),
        ("{{quality.penalty.nonsense|.2f}}", "nonsense"),
    ],
)
def test_a_chapter_that_cannot_be_shown_is_refused(extra, what):
    with pytest.raises(ValueError, match=re.escape(what)):
        page_build.build(chapter=f"# T\n\nText.\n\n{extra}\n")


def test_ids_are_unique_links_have_targets_and_headings_have_permalinks(html):
    body = html.split("<script>const PAGE")[0]
    ids = re.findall(r'\sid="([^"]+)"', body)
    assert sorted(ids) == sorted(set(ids))
    assert set(re.findall(r'href="#([^"]+)"', html)) <= set(ids)
    headings = re.findall(r'<h[23] id="([^"]+)">', body)
    assert all(
        f'class="permalink" href="#{name}"' in body
        for name in headings
        if "figure" not in name and not name.endswith("-title")
    )


def test_models_keep_their_look_and_comments_vanish():
    ((_, shown),) = prose.blocks("The `penalty` ball <!-- unseen --> and `other`.")
    assert '<code class="model m-penalty">penalty</code>' in shown
    assert '<code class="short">other</code>' in shown and "unseen" not in shown
    assert "<math" in prose.blocks("Then $a < b$ holds.")[0][1]


def test_generated_figures_are_put_in_whole(tmp_path):
    folder = tmp_path / "curriculum" / "bench"
    folder.mkdir(parents=True)
    (folder / "error-drop.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 432.5"><title>drop &amp; 100 %</title>'
        '<path d="M1.23456 2.5"/></svg>'
    )
    figure = page_build.generated_figures(tmp_path)["bench:drop"]
    assert figure["src"].startswith("data:image/svg+xml,") and "M1.23 2.5" in figure["src"]
    assert '"' not in figure["src"] and "%25" in figure["src"]
    scale = page_build.SCALE
    assert (figure["width"], figure["height"]) == (720 * scale, round(432.5 * scale))
