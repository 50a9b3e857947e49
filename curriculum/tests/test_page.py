"""The page: the same bits as contact.py, and every promise of its controls, in a real Chromium."""

import base64
import math
import os
import random
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("markdown_it", reason="the page's libraries are missing: pip install -e '.[page]'")

import contact  # noqa: E402
from curriculum.page import build as page_build  # noqa: E402
from curriculum.page import drawing, prose  # noqa: E402
from curriculum.page.__main__ import main as build_main  # noqa: E402
from curriculum.tests.page_browser import CHROMIUM, needs_chromium, running, visiting  # noqa: E402

ROOT = page_build.regions.ROOT
SMALL = Path(__file__).with_name("page_chapter.md").read_text(encoding="utf-8")
KNOBS = ("dt", "stiffness", "damping", "restitution", "sweeps", "baumgarte")


@pytest.fixture(scope="module")
def html():
    """The page of the chapter as it is."""
    return page_build.build() if (ROOT / page_build.CHAPTER).exists() else page_build.build(chapter=SMALL)


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


# ---- the engine against contact.py


def engine_cases():
    """Every scene on the dt grid with its own knobs, and random knobs."""
    pick = random.Random(35)
    for scene in ("drop", "bounce", "stack"):
        for factor in contact.DT_GRID:
            yield dict(
                scene=scene,
                seed=0,
                dt=0.002 * factor,
                stiffness=1e4,
                damping=None,
                restitution=None,
                sweeps=20,
                baumgarte=0.2,
                steps=2000 if scene == "drop" else 1000,
            )
        for _ in range(20):
            yield dict(
                scene=scene,
                seed=pick.randrange(100),
                dt=10 ** pick.uniform(-3.3, -1.2),
                stiffness=10 ** pick.uniform(2, 6),
                damping=pick.choice((0.0, pick.uniform(0, 300))),
                restitution=pick.choice((0.0, 1.0, pick.random(), pick.random())),
                sweeps=pick.randint(1, 60),
                baumgarte=pick.choice((0.0, 1.0, pick.random())),
                steps=500,
            )


def in_python(case):
    """The scene of a case and its runs by contact.py."""
    scene = contact.build_scene(case["scene"], case["seed"], None, case["restitution"], case["damping"])
    return scene, {
        model: contact.run_model(
            model, scene, case["dt"], case["steps"], case["stiffness"], case["baumgarte"], case["sweeps"]
        )
        for model in contact.MODELS
    }


RUN_ALL = """cases => {
  const packed = (array) => {
    const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    let text = "";
    for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
    return btoa(text);
  };
  return cases.map((c) => {
    const zero = c.y.map(() => 0);
    const scene = {x: zero, y: c.y, vx: zero, vy: zero, mass: c.y.map(() => 1), radius: c.y.map(() => PAGE.radius),
                   restitution: c.restitution, damping: c.damping};
    const runs = {}, out = {};
    for (const model of ContactEngine.MODELS) runs[model] = ContactEngine.runModel(model, scene, c, c.steps);
    for (const model of ContactEngine.MODELS) {
      out[model] = {quality: ContactEngine.quality(runs[model], scene, runs.exact)};
      for (const key of ["x", "y", "vx", "vy"]) out[model][key] = packed(runs[model][key]);
    }
    return out;
  });
}"""


@needs_chromium
def test_penalty_and_lcp_have_the_bits_of_contact_py_and_exact_agrees(browser, url):
    cases = list(engine_cases())
    wanted = []
    for case in cases:
        scene, runs = in_python(case)
        case.update(restitution=scene.restitution, damping=scene.damping, y=scene.q0[1].tolist())
        wanted.append((scene, runs))
    with visiting(browser, url) as page:
        results = page.evaluate(RUN_ALL, cases)
    assert len(results) == len(cases) == 78
    for case, (scene, runs), got in zip(cases, wanted, results):
        for model, run in runs.items():
            told = {key: value for key, value in case.items() if key != "y"}
            for key, array in (
                ("x", run.q[:, 0]),
                ("y", run.q[:, 1]),
                ("vx", run.v[:, 0]),
                ("vy", run.v[:, 1]),
            ):
                mine = np.frombuffer(base64.b64decode(got[model][key])).reshape(array.shape)
                if model == "exact":
                    assert np.abs(mine - array).max() <= 1e-12, (model, key, told)
                else:
                    same = np.ascontiguousarray(array).view(np.uint64) == mine.view(np.uint64)
                    same |= np.isnan(array) & np.isnan(mine)  # the bits of a NaN mean nothing
                    assert same.all(), (model, key, int(np.argmin(same.all(axis=1))), told)
            quality = contact.contact_quality(run, scene, case["dt"], runs["exact"])
            for name, value in quality.items():
                other = got[model]["quality"][name]
                if isinstance(value, float) and math.isfinite(value):
                    assert other == pytest.approx(value, rel=1e-9, abs=1e-11), (model, name, told)
                elif not isinstance(value, float):
                    assert other == value, (model, name, told)


@needs_chromium
def test_the_figure_shows_the_chapters_numbers_and_both_critical_steps(browser, url):
    scene = contact.build_scene("drop")
    quality = contact.contact_quality(contact.run_model("penalty", scene, 0.002, 2000), scene, 0.002)
    with visiting(browser, url) as page:
        rows = page.locator("#results-body tr").all_inner_texts()
        assert rows[0].split("\t")[:2] == ["deepest / r", drawing.number(quality["max_penetration_frac"])]
        assert rows[1].split("\t")[:2] == ["at the end / r", "0.00981"]
        axis = page.locator("#dt-axis").inner_html()
        assert drawing.number(contact.critical_dt(1.0, 1e4, 80.0)) in axis and "2√(m/k) 0.0200" in axis
        assert "m g / k = 0.981 mm" in page.locator("#sink-note").inner_text()
        # the axis is true to scale: each doubling of dt is as wide as the next
        ticks = page.evaluate(
            "[...document.querySelectorAll('#dt-axis line.axis')].slice(1).map(l => +l.getAttribute('x1'))"
        )
        assert np.ptp(np.diff(ticks)) < 0.01
        assert page.evaluate("ContactEngine.criticalDt(1, 1e4, 80).damped") == contact.critical_dt(
            1.0, 1e4, 80.0
        )


# ---- controls


def state(page):
    return page.evaluate(
        "({...Figure.state, time: Figure.time, playing: Figure.playing, steps: Figure.now.steps})"
    )


@needs_chromium
def test_every_knob_moves_the_run_the_address_and_the_command(browser, url):
    flags = {
        "dt": "--dt",
        "stiffness": "--stiffness",
        "damping": "--damping",
        "restitution": "--restitution",
        "sweeps": "--iters",
        "baumgarte": "--baumgarte",
    }
    with visiting(browser, url) as page:
        for name in KNOBS:
            before = state(page)[name]
            page.locator(f"#{name}-range").focus()
            for _ in range(3):
                page.keyboard.press("ArrowRight")
            moved = state(page)[name]
            assert moved > before, name
            assert float(page.input_value(f"#{name}-number")) == moved
            assert f"{flags[name]} " in page.inner_text("#command")
            page.fill(
                f"#{name}-number",
                (
                    "3"
                    if name == "sweeps"
                    else (
                        "0.5"
                        if name in ("restitution", "baumgarte")
                        else "0.01" if name == "dt" else "123.5"
                    )
                ),
            )
            page.keyboard.press("Tab")
            assert state(page)[name] == float(page.input_value(f"#{name}-number"))
        wanted = state(page)
        page.wait_for_timeout(400)  # the address is written a moment after the last change
        link = page.url
    with visiting(browser, link) as page:
        assert {name: state(page)[name] for name in KNOBS} == {name: wanted[name] for name in KNOBS}


@needs_chromium
def test_a_number_that_is_not_allowed_is_refused_in_words(browser, url):
    with visiting(browser, url) as page:
        for name, bad in (
            ("dt", "0"),
            ("dt", "7"),
            ("sweeps", "2.5"),
            ("restitution", "-1"),
            ("stiffness", ""),
        ):
            page.fill(f"#{name}-number", "")
            page.fill(f"#{name}-number", bad)
            page.dispatch_event(f"#{name}-number", "change")
            assert "is not allowed" in page.inner_text(f"#{name}-error")
            assert page.get_attribute(f"#{name}-number", "aria-invalid") == "true"
        assert state(page)["dt"] == 0.002
        page.fill("#dt-number", "0.004")
        page.keyboard.press("Tab")
        assert page.inner_text("#dt-error") == "" and state(page)["dt"] == 0.004


@needs_chromium
def test_scenes_start_heights_lens_and_speed(browser, url):
    with visiting(browser, url) as page:
        for scene, balls in (("bounce", 1), ("stack", 3), ("drop", 1)):
            page.check(f'input[name="scene"][value="{scene}"]', force=True)
            assert page.locator("#lane-lcp .moving > g .ball").count() - 1 == balls
            assert state(page)["restitution"] == contact.build_scene(scene).restitution
        page.select_option("#seed", "3")
        assert page.evaluate("Figure.now.scene.y[0]") == contact.build_scene("drop", 3).q0[1, 0]
        before = page.locator("#lane-penalty .moving").inner_html()
        page.check('input[name="zoom"][value="500"]', force=True)
        assert page.locator("#lane-penalty .moving").inner_html() != before
        page.check('input[name="speed"][value="20"]', force=True)
        assert "1/20 of real speed" in page.inner_text("#speed-note")
        page.click("#reset")
        assert state(page)["seed"] == 0 and state(page)["zoom"] == 50


@needs_chromium
def test_run_pause_step_restart_and_the_scrubber(browser, url):
    with visiting(browser, url) as page:
        assert (
            state(page)["time"] == 4 and not state(page)["playing"]
        ), "reduced motion: the end, standing still"
        page.click("#restart")
        assert state(page)["time"] == 0
        page.click("#step")
        page.click("#step")
        page.click("#back")
        assert "step 1 of 2000" in page.inner_text("#clock")
        page.click("#run")
        page.wait_for_timeout(300)
        page.click("#run")
        stopped = state(page)
        assert 0.002 < stopped["time"] < 1 and not stopped["playing"]
        page.wait_for_timeout(100)
        assert state(page)["time"] == stopped["time"]
        page.click("#to-contact")
        row = int(page.input_value("#scrub"))
        run = contact.run_model("penalty", contact.build_scene("drop"), 0.002, 400)
        assert row == int(np.argmax(run.q[:, 1, 0] < contact.RADIUS))
        page.locator("#scrub").focus()
        page.keyboard.press("ArrowRight")
        assert int(page.input_value("#scrub")) == row + 1
        assert f"step {row + 1} of" in page.get_attribute("#scrub", "aria-valuetext")
        box = page.locator("#chart-depth").bounding_box()
        page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 80)
        assert 1.5 < state(page)["time"] < 2.5


@needs_chromium
def test_it_runs_by_itself_once_unless_motion_is_unwanted(browser, url):
    with visiting(browser, url, motion="no-preference") as page:
        page.locator('#run[data-state="running"]').wait_for()
        page.click("#run")
        assert not state(page)["playing"] and page.inner_text("#run") == "Run"
    with visiting(browser, url, motion="reduce") as page:
        page.wait_for_timeout(200)
        assert not state(page)["playing"]


@needs_chromium
def test_inside_one_step_shows_gaps_and_lam_after_each_sweep(browser, url):
    with visiting(browser, url, query="?scene=stack&sweeps=7&t=0.1") as page:
        page.click("#inside summary")
        tables = page.locator("#inside-lcp table")
        assert tables.count() == 2 and tables.nth(1).locator("tbody tr").count() <= 7
        scene = contact.build_scene("stack")
        run = contact.run_model("lcp", scene, 0.002, 50, iters=7)
        q, v = run.q[50].tolist(), run.v[50].tolist()
        contacts = contact.detect_contacts(q, [0.1] * 3)
        fall = v[0], [vy + 0.002 * contact.GRAVITY for vy in v[1]]
        _, lam = contact.solve_contacts(
            fall, [1.0] * 3, contacts, contact.contact_targets(v, contacts, 0.0, 0.2, 0.002), 7
        )
        shown = [
            float(text.replace("−", "-"))
            for text in tables.nth(1).locator("tbody tr").last.locator("td").all_inner_texts()
        ]
        assert shown == pytest.approx(lam, rel=1e-5)
        page.click('label:has(input[name="scene"][value="bounce"])')
        page.evaluate("document.querySelector('#scrub').value = 0")
        page.click("#to-contact")
        page.click("#back")
        assert "ball 1 meets the table" in page.inner_text("#inside-exact")


@needs_chromium
def test_presets_set_the_figure_without_leaving_the_page(browser, url):
    with visiting(browser, url) as page:
        for link in page.locator("a[data-preset]").all():
            query = dict(
                part.split("=") for part in link.get_attribute("href")[1:].split("#")[0].split("&") if part
            )
            link.click()
            for name, value in query.items():
                assert str(state(page)[name]) == value
        page.goto(url + "?dt=0.03")
        assert "EXPLODED" in page.inner_text("#verdict-penalty") and page.inner_text("#verdict-lcp") == "ok"


@needs_chromium
def test_copying_code_command_and_link(browser, url):
    with visiting(browser, url, permissions=["clipboard-read", "clipboard-write"]) as page:
        button = page.locator("#code-penalty button[data-copy]")
        button.click()
        button.get_by_text("Copied").wait_for()
        region = page_build.regions.find()["penalty"]
        assert page.evaluate("navigator.clipboard.readText()").strip() == region.text.strip()
        page.click("#copy-link")
        page.locator("#copy-link").get_by_text("Copied").wait_for()
        assert page.evaluate("navigator.clipboard.readText()").startswith(url)
        page.locator("#code-penalty summary").click()
        assert page.locator("#code-penalty .whole").inner_text() == region.sha256


@needs_chromium
def test_small_figures_answer_their_sliders(browser, url):
    with visiting(browser, url) as page:
        for name in ("sink", "cliff", "sweeps", "bounces"):
            figure = page.locator(f"#fig-{name}")
            figure.scroll_into_view_if_needed()
            page.locator(f"#{name}-output:not(:empty)").wait_for()
            before = figure.inner_html()
            page.locator(f"#{name}-slider").focus()
            page.keyboard.press("Home")
            assert figure.inner_html() != before, name


@needs_chromium
def test_the_puzzle_has_no_answer_and_says_why(browser, url):
    with visiting(browser, url) as page:
        stiffness, damping = page.locator("#puzzle-k"), page.locator("#puzzle-c")
        stiffness.focus()
        page.keyboard.press("End")  # stiff enough: and it explodes
        page.locator("#goal-sink[data-met]").wait_for()
        assert page.get_attribute("#goal-rest", "data-met") is None and "Explodes" in page.inner_text(
            "#goal-rest"
        )
        stiffness.focus()
        page.keyboard.press("Home")
        page.locator("#goal-rest[data-met]").wait_for()
        assert page.get_attribute("#goal-sink", "data-met") is None
        damping.focus()
        page.keyboard.press("ArrowRight")
        page.click("#puzzle-give")
        why = page.locator("#puzzle-why")
        why.wait_for(timeout=30_000)
        assert page.evaluate("document.activeElement.id") == "puzzle-why"
        text = why.inner_text()
        assert "There is none" in text and "98,100 N/m" in text and "40,000 N/m" in text
        depth = float(re.search(r"least depth at rest was ([\d.]+) r", text)[1])
        assert 0.0025 < depth < 0.005  # 40,000 N/m would sink 0.00245 r
        # the browser's outcome of a try is that of contact.py
        for k, c in ((2e4, 80.0), (98101.0, 0.0), (98101.0, 100.0), (1e6, 200.0), (3.9e4, 40.0)):
            run = contact.run_model(
                "penalty", contact.build_scene("drop", damping=c), 0.01, 4000, stiffness=k
            )
            blew = contact.contact_quality(run, contact.build_scene("drop"), 0.01)["blew_up"]
            assert (
                page.evaluate("([k, c]) => Figures.attempt(k, c).outcome", [k, c]) == "explodes"
            ) == blew


# ---- exercises


@needs_chromium
def test_predict_commit_reveal_by_keyboard_alone(browser, url):
    with visiting(browser, url) as page:
        form = page.locator("#ex3 form")
        page.locator("#ex3").scroll_into_view_if_needed()
        page.evaluate(
            "document.querySelector('#ex3-title').setAttribute('tabindex', '-1');"
            "document.querySelector('#ex3-title').focus()"
        )
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.name") == "ex3-choice"
        assert page.locator("#ex3-result").is_hidden()
        assert (
            "times its start energy" not in page.locator("#ex3").inner_text()
        ), "the answer shows before the bet"
        page.keyboard.press("Tab")
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.type") == "submit"
        page.keyboard.press("Enter")  # nothing chosen
        assert "Choose one first" in page.inner_text("#ex3-error")
        page.keyboard.press("Space")
        page.keyboard.press("Tab")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")  # no reason
        assert "in a sentence" in page.inner_text("#ex3-error")
        assert page.evaluate("document.activeElement.id") == "ex3-why"
        page.keyboard.type("A longer step is longer for both of them.")
        page.keyboard.press("Tab")
        page.keyboard.press("Enter")
        assert page.evaluate("document.activeElement.id") == "ex3-result", "focus goes to the result"
        result = page.inner_text("#ex3-result")
        assert "You predicted A. The measurement says B." in result and "A longer step is longer" in result
        assert "1,409" in result and "EXPLODED" in result and "Why not what you chose" in result
        assert form.locator("input:enabled").count() == 0
        page.reload()
        assert "The measurement says B." in page.inner_text("#ex3-result")
        assert page.evaluate("document.activeElement.tagName") == "BODY", "a reload does not take the focus"
        page.get_by_role("button", name="Clear my answer").click()
        assert page.locator("#ex3-result").is_hidden() and form.locator("input:enabled").count() == 3
        page.reload()
        assert page.locator("#ex3-result").is_hidden()


@needs_chromium
def test_a_right_prediction_is_told_so_with_the_measurement(browser, url):
    with visiting(browser, url) as page:
        page.check('#ex1 input[value="C"]')
        page.fill("#ex1-why", "A spring must be pressed before it pushes.")
        page.click("#ex1 button[type=submit]")
        result = page.inner_text("#ex1-result")
        assert "The measurement agrees." in result and "0.251" in result and "0.00981" in result
        assert "Why not what you chose" not in result and result.count("Why not the others") == 1


# ---- without JavaScript, on a phone, for everyone

INTERACTIVE = "a[href], button, input, select, textarea, summary, [tabindex='0'][role='button']"


@needs_chromium
def test_without_javascript_a_true_poster_and_no_dead_control(browser, url):
    with visiting(browser, url, javascript=False) as page:
        for kind in ("button", "input", "select", "textarea", "output"):
            assert page.locator(f"{kind}:visible").count() == 0, kind
        assert page.locator(".lane svg:visible").count() >= 3
        assert "rests 0.00981 r deep" in page.inner_text("#now-penalty")
        assert "on the table" in page.inner_text("#now-lcp")
        assert page.locator(".small:visible").count() == 5
        assert page.locator("#results-body tr").first.inner_text().split() == [
            "deepest",
            "/",
            "r",
            "0.251",
            "0.0567",
            "0",
        ]
        assert page.locator(".contents a").count() == page.locator("article h2").count()
        page.locator(".contents a").nth(3).click()
        assert "#" in page.url
        page.locator("#code-lcp summary").click()
        assert page.locator("#code-lcp .whole").is_visible()


def test_the_table_is_drawn_before_the_ball_so_that_the_sink_shows():
    scene = contact.build_scene("drop")
    run = contact.run_model("penalty", scene, 0.002, 2000)
    svg = drawing.lane_picture("penalty", run)
    assert svg.index('class="table"') < svg.index('class="ball m-penalty"')
    lens = svg[svg.index("lens-glass") :]
    assert lens.index('class="table"') < lens.index('class="ball m-penalty"')
    centre, radius = map(float, re.search(r'cy="([-\d.]+)" r="([\d.]+)" class="ball', lens).groups())
    sink = float(re.search(r'y1="([\d.]+)" y2="[\d.]+" class="sink-line"', lens)[1])
    table = drawing.LANE["lens_y"]
    assert (
        centre + radius == pytest.approx(sink, abs=0.05) and sink > table + 10
    )  # mg/k, plainly below the surface


@needs_chromium
def test_a_phone_shows_everything_large_enough(browser, url):
    with visiting(browser, url, width=375, height=812, is_mobile=True, has_touch=True) as page:
        page.click("#inside summary")
        page.check('#ex1 input[value="A"]')
        page.fill("#ex1-why", "One contact is as good as another.")
        page.click("#ex1 button[type=submit]")
        page.evaluate("for (const f of document.querySelectorAll('.small')) f.scrollIntoView()")
        assert page.evaluate("document.documentElement.scrollWidth") <= 375
        wide = page.evaluate("""() => [...document.querySelectorAll('body *')].filter((e) => {
            const box = e.getBoundingClientRect();
            if (!box.width || e.closest('.hidden, .skip, .scroll, .shell, defs, clipPath, .moving')) return false;
            return box.right > 376 || box.left < -1;
        }).map((e) => e.outerHTML.slice(0, 90))""")
        assert not wide
        small = page.evaluate(
            """(kinds) => [...document.querySelectorAll(kinds)].filter((e) => {
            if (!e.checkVisibility({visibilityProperty: true}) || e.closest('.skip')) return false;
            if (e.tagName === 'A' && e.closest('p, td') && !e.closest('.presets, .contents')) return false;   // in a sentence
            const label = e.matches('input[type=radio]') ? e.closest('label') : e;
            const box = label.getBoundingClientRect();
            return box.height < 43.9 || box.width < 43.9;
        }).map((e) => e.outerHTML.slice(0, 90))""",
            INTERACTIVE,
        )
        assert not small
        tiny = page.evaluate("""() => {
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
                if (size < 13.99) found.add(`${size.toFixed(2)} ${e.outerHTML.slice(0, 80)}`);
            }
            return [...found];
        }""")
        assert not tiny


AXE = """([part, rules]) => axe.run(part, {resultTypes: ["violations"], ...rules}).then((result) => result.violations.map(
    (each) => `${each.id}: ${each.nodes.slice(0, 3).map((node) => node.html.slice(0, 120)).join(" | ")}`))"""
# code is long and plain: two panels stand for all
MOST = {
    "include": [["html"]],
    "exclude": [
        [f"#source-{name}"] for name in page_build.regions.find() if name not in ("penalty", "report")
    ],
}


@needs_chromium
@pytest.mark.parametrize(
    "part, rules, options",
    [
        (MOST, {}, {}),
        (MOST, {"runOnly": ["color-contrast"]}, {"color_scheme": "dark"}),
        (MOST, {}, {"width": 375, "height": 812}),
        (MOST, {}, {"as_without_javascript": True}),
    ],
    ids=["light", "dark", "phone", "no-javascript"],
)
def test_axe_finds_no_violation(browser, url, part, rules, options):
    axe = pytest.importorskip(
        "axe_playwright_python.base", reason="axe is missing: pip install -e '.[test]'"
    )
    plain = options.pop("as_without_javascript", False)
    with visiting(browser, url, **options) as page:
        if plain:  # axe is a script itself; this is what the page's own script undoes first
            page.evaluate("document.documentElement.className = 'no-js'")
        else:
            page.click("#inside summary")
            page.check('#ex1 input[value="A"]')
            page.fill("#ex1-why", "One contact is as good as another.")
            page.click("#ex1 button[type=submit]")
        page.evaluate(axe.AXE_SCRIPT)
        found = page.evaluate(AXE, [part, rules])
        assert not found, "\n".join(found)


# ---- the text and the file


def test_the_page_is_one_file_and_the_same_bytes_each_time(tmp_path):
    chapter = ROOT / page_build.CHAPTER
    chapter = chapter if chapter.exists() else Path(__file__).with_name("page_chapter.md")
    pages = []
    for seed in ("0", "1"):
        out = tmp_path / f"{seed}.html"
        code = (
            "import sys; from curriculum.page import build; "
            "chapter = open(sys.argv[2], encoding='utf-8').read(); "
            "open(sys.argv[1], 'w', encoding='utf-8').write(build.build(chapter=chapter))"
        )
        subprocess.run(
            [sys.executable, "-c", code, str(out), str(chapter)],
            check=True,
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        pages.append(out.read_bytes())
    assert pages[0] == pages[1]
    text = pages[0].decode()
    assert not re.search(
        r"""<(?:link|script|img|iframe|object|source)[^>]+(?:src|href)=["'](?!data:)""", text
    )
    assert not re.search(r"@import|url\((?!#)", text.split("</style>")[0])
    assert "default-src &#39;none&#39;" in text


def test_writing_the_page_says_where_and_reports_what_it_cannot_do(tmp_path, capsys):
    if (ROOT / page_build.CHAPTER).exists():
        assert build_main(["--out", str(tmp_path / "new" / "page.html")]) == 0
        assert (
            "one file" in capsys.readouterr().out
            and (tmp_path / "new" / "page.html").stat().st_size > 100_000
        )
    assert build_main(["--root", str(tmp_path), "--out", str(tmp_path / "x.html")]) == 1
    assert "chapter.md" in capsys.readouterr().err and not (tmp_path / "x.html").exists()


@pytest.mark.parametrize(
    "extra, what",
    [
        ("```\n[include-by-region: contact.py#friction]\n```", "no such region"),
        ("<!-- figure: sinks -->", "a slot for 'figure:sinks'"),
        ("<div>hand-made</div>", "raw HTML"),
        ("{{quality.penalty.nonsense|.2f}}", "nonsense"),
    ],
)
def test_a_chapter_that_cannot_be_shown_is_refused(extra, what):
    with pytest.raises(ValueError, match=re.escape(what)):
        page_build.build(chapter=f"{SMALL}\n\n{extra}\n")


def test_slots_stand_where_the_chapter_puts_them_and_nowhere_else():
    known = {"figure:sink", "figure:cliff", "exercise:ex1", "figure:puzzle"}
    fence = "```\n[include-by-region: contact.py#penalty]\n```"
    text = "\n\n".join(
        ("# T", "## Penalty", "First.", "Second.", fence, "## Break it", "So.\n", "## Practice", "Do.", "## End\n")
    )
    order = [value for kind, value in prose.place(prose.blocks(text), known) if kind in ("slot", "include")]
    assert order == ["figure:sink", "penalty", "figure:cliff", "figure:puzzle", "exercise:ex1"]
    placed = text.replace("So.\n", "So.\n\n<!-- figure: sink -->\n")
    order = [
        value for kind, value in prose.place(prose.blocks(placed), known) if kind in ("slot", "include")
    ]
    assert order.count("figure:sink") == 1 and order.index("figure:sink") > order.index("penalty")


def test_no_id_stands_twice_and_every_link_inside_the_page_has_its_target():
    html = page_build.build(chapter=f"{SMALL}\n\n## Run\n\nOn.\n\n## Run\n\n## Figure\n")
    ids = re.findall(r'\sid="([^"]+)"', html.split("<script>")[0])
    assert sorted(ids) == sorted(set(ids))
    assert {"run-2", "run-3", "figure-2"} <= set(ids)
    assert set(re.findall(r'href="#([^"]+)"', html)) <= set(ids)


def test_models_keep_their_look_and_comments_vanish():
    ((_, shown),) = prose.blocks("The `penalty` ball <!-- unseen --> and `other`.")
    assert (
        '<code class="model m-penalty">penalty</code>' in shown
        and '<code class="short">other</code>' in shown
        and "unseen" not in shown
    )
    assert "<math" in prose.blocks("Then $a < b$ holds.")[0][1]


def test_captions_of_the_small_figures_are_true():
    """cliff: past the damped limit penalty never rests and lcp always does; sink: the marks lie on mg/k."""
    scene, limit = contact.build_scene("drop"), contact.critical_dt(1.0, 1e4, 80.0)
    for dt in np.geomspace(0.004, 0.064, 80):
        steps = int(20 / dt)
        late = slice(int(0.75 * steps), None)
        rests = {
            model: np.ptp(contact.run_model(model, scene, dt, steps).q[late, 1, 0]) < 1e-6
            for model in ("penalty", "lcp")
        }
        assert rests["lcp"] and (dt < limit or not rests["penalty"]), dt
        assert rests["penalty"] or dt > 0.9 * limit, dt
    dt, k = 0.5 * contact.critical_dt(1.0, 1.5e3, 80.0), 1.5e3
    run = contact.run_model("penalty", drawing.one_ball(0.1), dt, math.ceil(4 / dt), stiffness=k)
    assert 0.1 - run.q[-1, 1, 0] == pytest.approx(9.81 / k, rel=1e-6)


def test_generated_figures_are_put_in_whole(tmp_path):
    folder = tmp_path / "curriculum" / "bench"
    folder.mkdir(parents=True)
    (folder / "error-drop.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 432.5"><title>drop</title></svg>'
    )
    found = page_build.generated_figures(tmp_path)
    figure = found["bench:drop"]
    assert figure["src"].startswith("data:image/svg+xml;base64,") and (
        figure["width"],
        figure["height"],
    ) == (720, 432)
