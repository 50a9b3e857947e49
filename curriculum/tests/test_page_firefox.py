"""The page in Firefox: the same bits, the same controls, no overflow, print, dark, forced colours."""

import base64
import io

import numpy as np
import pytest

pytest.importorskip(
    "markdown_it", reason="the page's libraries are missing: pip install -e '.[page]'"
)
pytest.importorskip(
    "py_mini_racer", reason="the page's libraries are missing: pip install -e '.[page]'"
)

import contact  # noqa: E402
from curriculum.tests.page_browser import small_page  # noqa: E402
from curriculum.tests.page_firefox import firefox, needs_firefox  # noqa: E402

SHOWN = (
    "['ex1', 'ex3', 'ex4', 'puzzle'].forEach((id) => "
    "localStorage.setItem(`contact-chapter:${id}`, '{\"shown\": true}'))"
)
pytestmark = needs_firefox


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "contact.html"
    path.write_text(small_page(), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def tab(url):
    with firefox() as tab:
        tab.visit(url)
        tab.evaluate(SHOWN)
        tab.visit(f"{url}?seed=0")
        yield tab
        assert not tab.trouble, tab.trouble


def test_the_engine_has_the_bits_of_contact_py(tab):
    for scene, dt in (("drop", 0.002), ("bounce", 0.008), ("stack", 0.004)):
        got = tab.evaluate(f"""(() => {{
          Figure.take(State.read("?scene={scene}&dt={dt}").state);
          const text = (a) => btoa(Array.from(new Uint8Array(a.buffer), (b) => String.fromCharCode(b)).join(""));
          return ContactEngine.MODELS.map((m) => text(Figure.now.runs[m].vy));
        }})()""")
        steps = int(4 / dt + 1e-9)
        for model, packed in zip(contact.MODELS, got):
            run = contact.run_model(model, contact.build_scene(scene), dt, steps)
            mine = np.frombuffer(base64.b64decode(packed))
            theirs = np.ascontiguousarray(run.v[:, 1]).ravel()
            if model == "exact":
                assert np.abs(mine - theirs).max() < 1e-10
            else:
                assert (mine.view(np.uint64) == theirs.view(np.uint64)).all(), (scene, model)


def test_knobs_links_and_numbers_work_by_keyboard(tab, url):
    tab.visit(f"{url}?scene=drop")
    right = "\ue014"
    tab.evaluate("document.getElementById('dt-range').focus()")
    tab.press(right, right, right)
    assert tab.evaluate("Figure.state.dt") > 0.002
    tab.evaluate("document.querySelector('span.drag[data-knob=stiffness]').focus()")
    tab.press(right)
    assert tab.evaluate("Figure.state.stiffness") > 1e4
    tab.evaluate("document.querySelector('a.try[href*=stack]').focus()")
    tab.press("\ue007")
    assert tab.evaluate("Figure.state.scene") == "stack"
    tab.evaluate("history.back()")
    tab.evaluate("new Promise((done) => setTimeout(done, 300))")
    assert tab.evaluate("Figure.state.scene") == "drop"


def test_every_small_figure_draws(tab, url):
    tab.visit(url)
    looks = tab.evaluate("""Object.keys(SmallFigures.FIGURES).map((name) => {
      const slider = document.getElementById(`${name}-slider`);
      slider.value = slider.max;
      slider.dispatchEvent(new Event("input"));
      return document.querySelector(`#fig-${name} .drawing`).innerHTML.length
        * !document.getElementById(`fig-${name}`).innerText.includes("NaN");
    })""")
    assert len(looks) == 14 and min(looks) > 500


@pytest.mark.parametrize("width", [320, 375, 390, 1024])
def test_nothing_is_wider_than_the_window(tab, url, width):
    tab.visit(url, width=width, height=740)
    tab.evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    tab.evaluate("document.querySelectorAll('.small').forEach((f) => f.scrollIntoView())")
    tab.evaluate("new Promise((done) => setTimeout(done, 200))")
    assert tab.evaluate("document.documentElement.scrollWidth") <= width


def test_formulas_are_set_in_the_font_that_the_page_brings(tab, url):
    """Their width is another than in the browser's own serif."""
    tab.visit(url)
    loaded, widths = tab.evaluate("""document.fonts.ready.then(() => {
      const formula = document.querySelector(".math.block math");
      const width = () => formula.querySelector("mi").getBoundingClientRect().width;
      const brought = width();
      formula.style.fontFamily = "serif";
      return [[...document.fonts].map((face) => face.status), [brought, width()]];
    })""")
    assert loaded == ["loaded"] and widths[0] != widths[1], (loaded, widths)


def test_it_prints(tab, url):
    tab.visit(url)
    assert tab.printed()[:5] == b"%PDF-"


def brightness(picture):
    """The mean brightness of a PNG, 0 to 255."""
    image = pytest.importorskip("PIL.Image", reason="pillow is missing: pip install matplotlib")
    return float(np.asarray(image.open(io.BytesIO(picture)).convert("L")).mean())


def test_dark_is_dark_and_light_is_light(tab, url):
    tab.visit(url)
    assert brightness(tab.photograph()) > 180
    with firefox({"layout.css.prefers-color-scheme.content-override": 0}) as dark:
        dark.visit(url)
        assert brightness(dark.photograph()) < 70
        assert not dark.trouble


def test_forced_colours_and_no_scripts(url):
    with firefox({"browser.display.document_color_use": 2}) as forced:
        forced.visit(url)
        look = forced.evaluate("""(() => {
          const style = (q) => getComputedStyle(document.querySelector(q));
          return [matchMedia("(forced-colors: active)").matches,
                  style("#lane-penalty .ball").fill, style("#lane-lcp .ball").fill,
                  style("#figure input[name=scene]:checked + span").backgroundColor,
                  style("#figure input[name=scene]:not(:checked) + span").backgroundColor];
        })()""")
        assert look[0] and look[1] != look[2] and look[3] != look[4]
    with firefox({"javascript.enabled": False}) as plain:
        plain.visit(url)
        assert brightness(plain.photograph()) > 180
        assert not plain.trouble
