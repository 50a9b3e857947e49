"""The chapter's own page: what it shows before a bet, its formulas, its way around, the whole file."""

import ast
import io
import json
import os
import re
import statistics
from html import unescape
from pathlib import Path

import pytest

pytest.importorskip(
    "markdown_it", reason="the page's libraries are missing: pip install -e '.[page]'"
)
pytest.importorskip(
    "py_mini_racer", reason="the page's libraries are missing: pip install -e '.[page]'"
)

import contact  # noqa: E402
from curriculum.page import body, build, maths_font, prose  # noqa: E402
from curriculum.page.__main__ import main as build_main  # noqa: E402
from curriculum.page.browser import FLAGS  # noqa: E402
from curriculum.tests.page_browser import (  # noqa: E402
    CHROMIUM,
    needs_chromium,
    running,
    visiting,
)  # noqa: E402
from curriculum.tests.test_bets import ANSWERS, told  # noqa: E402

ROOT = build.regions.ROOT
ORDER = ("ex1", "ex4", "ex3")  # of the bets in the chapter
# everything that a reader can see, unfold or have read out, but for choices, hints and reasons
READ = """() => {
  for (const d of document.querySelectorAll("details")) d.open = true;
  const named = ["aria-label", "aria-valuetext", "alt", "title"];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT | NodeFilter.SHOW_ELEMENT);
  const out = [];
  for (let node; (node = walk.nextNode());) {
    const e = node.nodeType === 3 ? node.parentElement : node;
    if (e.closest("script, style, template, form.bet, .hints, .terminal")) continue;
    if (!e.checkVisibility({visibilityProperty: true})) continue;
    if (node.nodeType === 3) out.push(node.textContent);
    else for (const name of named) if (e.hasAttribute(name)) out.push(` ${e.getAttribute(name)}. `);
    if (node.nodeType === 1 && getComputedStyle(e).display !== "inline") out.push("\\n");
  }
  return out.join("");
}"""
DRAW = """async () => {
  for (const figure of document.querySelectorAll(".small")) {
    figure.scrollIntoView();
    await new Promise((done) => setTimeout(done, 30));
  }
}"""


@pytest.fixture(scope="module")
def html():
    return build.build()


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


# ---- nothing tells before the bet


@pytest.fixture(scope="module")
def measured():
    """The numbers that are the answer of each bet, from runs made here."""
    scene = contact.build_scene("drop")

    def quality(model, dt, steps):
        return contact.contact_quality(contact.run_model(model, scene, dt, steps), scene, dt)

    short = quality("penalty", 0.002, 800)
    long = quality("penalty", 0.03, 2000)
    soft = quality("soft", 0.002, 2000)
    depths = [short["max_penetration_frac"], short["rest_penetration_frac"]]
    limit = contact.critical_dt(1.0, 1e4, scene.damping)
    return {
        "ex1": depths,
        "ex3": [long["energy_excess"], limit],
        "ex4": [soft["rest_penetration_frac"]],
    }


def quoting(text, value, least=2):
    """The numbers in a text that give a value, rounded, with at least so many of its digits."""
    found = []
    for number in re.findall(r"\d[\d,]*(?:\.\d+)?", text):
        places = len(number.partition(".")[2])
        digits = number.replace(",", "").replace(".", "").lstrip("0")
        near = abs(float(number.replace(",", "")) - value) <= 0.5 * 10.0**-places
        if len(digits) >= least and near:
            found.append(number)
    return found


def test_a_quoted_answer_is_noticed():
    assert quoting("it is 0.0098 r, and 9.81 m/s", 0.00981) == ["0.0098"]
    assert quoting("1,409 times", 1409.1) == ["1,409"]
    assert quoting("0.25 or 0.24 r", 0.2513) == ["0.25"]


@needs_chromium
@pytest.mark.parametrize("made", [0, 1, 2, 3])
def test_no_answer_is_seen_anywhere_on_the_page_before_its_bet(browser, url, measured, made):
    """All visible text, numbers and names, folded parts unfolded, at each stage of the reading."""
    with visiting(browser, url, shown=False) as page:
        for name in ORDER[:made]:
            page.evaluate(f"Bets.show('{name}')")
        page.evaluate(DRAW)
        text = page.evaluate(READ)
        for name in ORDER[made:]:
            assert told(text, name) == []
            for value in measured[name]:
                assert quoting(text, value) == []
                assert quoting(text, 1000 * contact.RADIUS * value, least=3) == [], "in mm"
        for name in ORDER[:made]:
            assert told(text, name), "and behind the bet it is told"
            assert all(quoting(text, value) for value in measured[name][:1])
        bars = page.locator(".veil-bar:visible").all_inner_texts()
        assert made < 3 or ["exercise" in each for each in bars] == [False], "the puzzle's is left"


THROWN = (
    "dt=0.03",
    "scene=bounce&dt=0.03",
    "scene=stack&dt=0.02",
    "stiffness=1e6",
    "damping=300&dt=0.0125",
)
CALM = ("", "t=3.9", "scene=stack&t=2", "scene=bounce&t=4")


@needs_chromium
@pytest.mark.parametrize("made", [(), ("ex1",), ("ex1", "ex4")], ids=["none", "first", "two"])
def test_figures_and_tables_keep_an_answer_however_they_are_set(browser, url, made):
    """A long step, a stiff spring, another scene, any time, the tables unfolded."""
    with visiting(browser, url, shown=False) as page:
        for name in made:
            page.evaluate(f"Bets.show('{name}')")
        page.locator("#inside").evaluate("(e) => (e.open = true)")
        for query in (*THROWN, *CALM):
            page.evaluate("(query) => Figure.follow(`?${query}`)", query)
            figure = page.locator("#figure").inner_text()
            assert page.locator("#veil").is_visible() == (not made or query in THROWN), query
            assert "EXPLODED" not in figure and "gone" not in figure
            if "ex4" not in made:
                assert page.evaluate("Figure.now.series.soft.gap.some((gap) => gap < -0.001)")
                soft = page.locator("#now-soft").inner_text()
                assert " in" not in soft and "soft" not in page.inner_text("#results"), query
                assert page.locator("#chart .mark.m-soft").count() == 0, (
                    "no point on the line either"
                )


@needs_chromium
def test_what_the_text_links_to_before_a_bet_is_not_kept_back(browser, url):
    with visiting(browser, url, shown=False) as page:
        for name in ORDER[:2]:
            page.evaluate(f"Bets.show('{name}')")
        kept = page.evaluate("""() => {
          const bet = document.getElementById("ex3");
          const links = [...document.querySelectorAll("a.try")].filter(
            (link) => bet.compareDocumentPosition(link) & Node.DOCUMENT_POSITION_PRECEDING);
          return links.map((link) => {
            Figure.follow(new URL(link.href).search);
            return Figure.hiddenBy();
          });
        }""")
        assert len(kept) >= 8 and set(kept) == {None}


@needs_chromium
def test_a_link_to_a_veiled_section_leads_to_its_heading_and_to_the_bet(browser, url):
    with visiting(browser, url, query="#way-one-penalty", shown=False) as page:
        assert page.locator("#way-one-penalty").is_visible()
        bar = page.locator(".veil-bar:visible").first
        assert "exercise 1" in bar.inner_text()
        bar.get_by_role("link").click()
        assert page.locator("#ex1 form").is_visible() and page.url.endswith("#ex1")
        for name in ORDER:
            assert page.locator(f"#{name} form").is_visible(), "a bet can be made in any order"


@pytest.mark.parametrize("name", ANSWERS)
def test_words_that_tell_in_the_text_open_a_veil(name):
    """What a person may not say before a bet (test_bets.py) is veiled after it as well."""
    for sentence in (
        "The ball rests inside the table.",
        "It explodes.",
        "Both lie equally deep, since no mass in it is left.",
    ):
        if told(sentence, name):
            assert body.TELLS[name].search(sentence)


# ---- formulas


BARE = """<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig>{dirs}<cachedir>{cache}</cachedir></fontconfig>"""
# of every script in a visible formula: sizes, and how far its baseline is above that of what it belongs to
PLACES = """(ascent) => {
  const text = (e) => document.createTreeWalker(e, NodeFilter.SHOW_TEXT).nextNode();
  const size = (e) => parseFloat(getComputedStyle(text(e).parentElement).fontSize);
  const baseline = (e) => {
    const range = document.createRange();
    range.selectNodeContents(text(e));
    return range.getBoundingClientRect().top + ascent * size(e);
  };
  return [...document.querySelectorAll("math :is(msub, msup, msubsup)")].filter(
    (e) => e.checkVisibility() && e.firstElementChild.localName === "mi").map((e) => {
      const [base, ...scripts] = e.children;
      return {kind: e.localName, text: e.textContent, size: size(base), script: size(scripts[0]),
              raised: scripts.map((script) => baseline(base) - baseline(script))};
    });
}"""


@pytest.fixture(scope="module")
def without_maths(browser, tmp_path_factory):
    """A Chromium to which the machine has no font with a MATH table."""
    folder = tmp_path_factory.mktemp("fonts")
    plain = [each for each in ("/usr/share/fonts/truetype/liberation",) if Path(each).is_dir()]
    config = folder / "fonts.conf"
    dirs = "".join(f"<dir>{each}</dir>" for each in plain)
    config.write_text(BARE.format(dirs=dirs, cache=folder / "cache"), encoding="utf-8")
    surroundings = {**os.environ, "FONTCONFIG_FILE": str(config)}
    chromium = browser.browser_type.launch(
        executable_path=CHROMIUM, args=list(FLAGS), env=surroundings
    )
    yield chromium
    chromium.close()


@needs_chromium
def test_scripts_of_formulas_sit_where_the_font_wants_them_without_any_maths_font(
    without_maths, url
):
    """Sub- and superscripts are shifted and scaled as the MATH table of the embedded font says."""
    pytest.importorskip("fontTools", reason="fonttools is missing: pip install -e '.[test]'")
    from fontTools.ttLib import TTFont

    font = TTFont(maths_font.FILE)
    constants, em = font["MATH"].table.MathConstants, font["head"].unitsPerEm
    with visiting(without_maths, url) as page:
        assert page.evaluate(f"document.fonts.check('16px \"{maths_font.NAME}\"')")
        found = page.evaluate(PLACES, maths_font.ASCENT / em)
    assert len(found) > 20
    down, up, gap = (
        constants.SubscriptShiftDown.Value,
        constants.SuperscriptShiftUp.Value,
        constants.SubSuperscriptGapMin.Value,  # by which two scripts are moved apart at most
    )
    for each in found:
        scale = each["size"] / em
        assert each["script"] / each["size"] == pytest.approx(
            constants.ScriptPercentScaleDown / 100, abs=0.01
        ), each
        if each["kind"] != "msup":
            assert down * scale - 1 <= -each["raised"][0] <= (down + gap) * scale + 1, each
        if each["kind"] != "msub":
            assert up * scale - 1 <= each["raised"][-1] <= (up + gap) * scale + 1, each


@pytest.mark.parametrize("face", ["with the font", "without"])
def test_all_formulas_can_be_set(html, face):
    """Every character of every formula, and the italic of every variable, is in the cut."""
    pytest.importorskip("fontTools", reason="fonttools is missing: pip install -e '.[test]'")
    from fontTools.ttLib import TTFont

    has = set(TTFont(maths_font.FILE).getBestCmap())
    assert {ord(each) for each in maths_font.CHARACTERS} <= has
    if face == "without":
        with pytest.raises(ValueError, match="ℵ, which the page's font lacks"):
            prose.blocks(r"$\aleph$")
        return
    for formula in re.findall(r"<math.*?</math>", html, re.DOTALL):
        for name in re.findall(r"<mi>([^<]+)</mi>", formula):
            name = unescape(name)
            assert len(name) > 1 or ord(maths_font.italic(name)) in has, name


def test_the_font_is_the_cut_that_its_command_makes(tmp_path):
    """Table by table, where the original is installed (Debian: fonts-stix)."""
    pytest.importorskip("fontTools", reason="fonttools is missing: pip install -e '.[test]'")
    original = Path("/usr/share/fonts/opentype/stix-word/STIXMath-Regular.otf")
    if not original.exists():
        pytest.skip("the original font is not installed: apt-get install fonts-stix")
    from fontTools.ttLib import TTFont

    assert maths_font.main([str(original), "--out", str(tmp_path / "again.woff")]) == 0
    made, held = TTFont(tmp_path / "again.woff"), TTFont(maths_font.FILE)
    assert made.getGlyphOrder() == held.getGlyphOrder()
    for table in ("MATH", "cmap", "hmtx", "name"):
        assert made.reader[table] == held.reader[table], table


def test_a_font_that_cannot_be_cut_is_said_in_a_line_and_nothing_is_written(tmp_path, capsys):
    pytest.importorskip("fontTools", reason="fonttools is missing: pip install -e '.[test]'")
    (tmp_path / "text.otf").write_text("no font")
    for name in ("none.otf", "text.otf"):
        with pytest.raises(SystemExit) as left:
            maths_font.main([str(tmp_path / name), "--out", str(tmp_path / "out.woff")])
        said = capsys.readouterr().err
        assert left.value.code == 2 and said.count("\n") == 1 and "fonts-stix" in said
    assert not (tmp_path / "out.woff").exists()


def test_the_font_keeps_its_license_and_not_its_reserved_name():
    pytest.importorskip("fontTools", reason="fonttools is missing: pip install -e '.[test]'")
    from fontTools.ttLib import TTFont

    names = {each.nameID: str(each) for each in TTFont(maths_font.FILE)["name"].names}
    assert names[1] == maths_font.NAME and "STI Pub Companies" in names[0]
    assert "STIX" not in names[1] + names[4] + names[6]
    license = (ROOT / "curriculum/page/maths.license.txt").read_text("utf-8")
    assert "SIL OPEN FONT LICENSE Version 1.1" in license and "STI Pub Companies" in license


# ---- pictures


@needs_chromium
def test_every_picture_can_be_decoded(browser, url):
    """Also one whose text names a font in quotes, as matplotlib's do."""
    with visiting(browser, url) as page:
        widths = page.evaluate("""() => Promise.all([...document.images].map(
          (image) => image.decode().then(() => image.naturalWidth, () => 0)))""")
    assert len(widths) >= 2 and all(widths), widths


@needs_chromium
@pytest.mark.parametrize("width", [375, 1440])
def test_text_in_pictures_is_as_large_as_the_least_of_the_page(browser, url, width):
    """Their labels are of 10 px; on a phone a picture keeps its size and is moved sideways."""
    with visiting(browser, url, width=width, height=800) as page:
        shown = page.evaluate(
            "[...document.images].filter((i) => i.checkVisibility()).map((i) => i.clientWidth / i.naturalWidth)"
        )
        drawn = page.evaluate("""[...document.images].map((i) => {
          const text = decodeURIComponent(i.src.split(",", 2)[1]);
          return i.naturalWidth / Number(text.match(/viewBox='\\S+ \\S+ ([\\d.]+)/)[1]);
        })""")
        assert all(10 * a * b >= 13.9 for a, b in zip(shown, drawn)), (shown, drawn)


@needs_chromium
def test_pictures_are_dark_where_the_page_is(browser, url):
    """Each brings its dark colours itself, and nothing turns them over once more."""
    with visiting(browser, url, color_scheme="dark") as page:
        pixels = page.evaluate("""() => Promise.all([...document.images].map(async (image) => {
          await image.decode();
          return [getComputedStyle(image).filter, getComputedStyle(image).backgroundColor];
        }))""")
        assert pixels == [["none", "rgba(0, 0, 0, 0)"]] * len(pixels)
        image = pytest.importorskip("PIL.Image", reason="pillow is missing: pip install matplotlib")
        for each in page.locator(".generated img:visible").all():
            shot = image.open(io.BytesIO(each.screenshot())).convert("L")
            assert statistics.mean(shot.getdata()) < 110


# ---- the way around


def test_contents_name_every_section_and_every_heading_has_a_permalink(html):
    text = html.split("<script>const PAGE")[0]
    headings = re.findall(r"<h([23]) id=\"([\w-]+)\">", text)
    contents = re.search(r'<nav aria-label="Contents">(.*?)</nav>', text, re.DOTALL)[1]
    chapter = (ROOT / build.CHAPTER).read_text("utf-8")
    wanted = re.findall(r"^#{2,3} (.+)$", re.sub(r"```.*?```", "", chapter, flags=re.DOTALL), re.M)
    listed = [
        unescape(re.sub("<[^>]+>", "", each)) for each in re.findall(r"<li.*?</li>", contents)
    ]
    assert [each.replace("’", "'") for each in listed[1:-2]] == [
        each.replace("`", "") for each in wanted
    ]
    assert listed[-2:] == ["The whole file", "Colophon"]
    for _, name in headings:
        if f'href="#{name}"' in contents:
            assert f'class="permalink" href="#{name}"' in text


def test_the_page_leads_to_course_repository_notebook_and_neighbours(html):
    links = dict(re.findall(r'<a href="(https?:[^"]+|[^"#?:]+)">(.*?)</a>', html))
    for number in ("3.3", "3.4", "3.6"):
        assert any(number in re.sub("<[^>]+>", "", text) for text in links.values())
    assert "https://zero2robot.com" in links and "https://github.com/kaushikb11/zero2robot" in links
    here = {each for each in links if not each.startswith("http")}
    assert here == {"../contact.py", "../README.md", "contact.ipynb"}
    for each in here - {"contact.ipynb"}:
        assert (ROOT / "outputs" / each).resolve().is_file(), "as seen from the folder outputs"
    readme = (ROOT / "README.md").read_text("utf-8")
    assert "--out outputs/contact.html" in readme and "--out outputs/contact.ipynb" in readme


def test_the_whole_file_stands_at_the_end_folded_and_line_by_line(html):
    panel = re.search(
        r'<figure class="code" id="code-contact-whole">.*?</figure>', html, re.DOTALL
    )[0]
    assert "<details><summary>" in panel
    code = re.search(r'<code id="source-contact-whole">(.*)</code>', panel, re.DOTALL)[1]
    assert unescape(re.sub(r"<[^>]+>", "", code)) == (ROOT / "contact.py").read_text("utf-8")
    assert html.index('id="code-contact-whole"') > html.index('id="the-rest-of-the-file"')


# ---- the file, and the code of the page


def test_the_chapters_page_is_written_and_no_larger_than_900_kb(
    html, tmp_path, capsys, monkeypatch
):
    real = build.build
    monkeypatch.setattr(build, "build", lambda *root: real(*root) if root else html)
    out = tmp_path / "new" / "page.html"
    assert build_main(["--out", str(out)]) == 0, capsys.readouterr().err
    assert "one file" in capsys.readouterr().out and out.read_text("utf-8") == html
    assert 100_000 < out.stat().st_size <= 900_000
    assert build_main(["--root", str(tmp_path), "--out", str(tmp_path / "x.html")]) == 1
    assert "chapter.md" in capsys.readouterr().err and not (tmp_path / "x.html").exists()


def test_functions_of_the_page_have_at_most_forty_lines():
    for path in sorted((ROOT / "curriculum/page").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef):
                assert node.end_lineno - node.lineno < 40, f"{path.name}: {node.name}"


def test_the_data_of_the_page_is_json(html):
    data = re.search(r"const PAGE = (.*?);\n", html)[1]
    assert set(json.loads(data)["exercises"]) == set(ORDER)


# ---- the layout between a tablet and a desk, print, and colours


@needs_chromium
@pytest.mark.parametrize("width", [1024, 1150, 1311])
def test_beside_the_figure_text_is_wide_enough_and_no_code_is_cut(browser, url, width):
    with visiting(browser, url, width=width, height=800) as page:
        column = page.locator("article").bounding_box()
        figure = page.locator("#figure").bounding_box()
        assert column["width"] >= 450 and figure["width"] >= 400
        assert column["x"] + column["width"] <= figure["x"]
        assert (column["width"] + figure["width"]) >= 0.9 * width, "no strip is left empty"
        cut = """() => [...document.querySelectorAll(".ln, pre, .small, .exercise")].filter(
          (e) => e.checkVisibility() && e.scrollWidth > e.clientWidth + 1).length"""
        assert page.evaluate(cut) == 0


@needs_chromium
def test_what_is_printed_while_it_runs_is_the_end(browser, url):
    with visiting(browser, url, motion="no-preference") as page:
        page.click("#run")
        page.wait_for_timeout(200)
        assert page.evaluate("Figure.playing && Figure.time < Figure.view[1]")
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert page.evaluate("!Figure.playing && Figure.time === Figure.view[1]")


def contrast(one, other):
    """The contrast of two colours (r, g, b) by the rule of WCAG."""

    def light(color):
        parts = [each / 255 for each in color]
        linear = [
            each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in parts
        ]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    high, low = sorted((light(one), light(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@needs_chromium
@pytest.mark.parametrize("scheme, least", [("light", 3.0), ("dark", 4.5)])
def test_lines_of_every_model_stand_out_from_the_page(browser, url, scheme, least):
    """3 : 1 is WCAG's least for what is drawn; in the dark thin lines need more."""
    with visiting(browser, url, color_scheme=scheme) as page:
        found = page.evaluate("""() => {
          const rgb = (text) => text.match(/[\\d.]+/g).slice(0, 3).map(Number);
          const paper = rgb(getComputedStyle(document.getElementById("figure")).backgroundColor);
          return [...document.querySelectorAll("#chart path.line")].map(
            (line) => [line.getAttribute("class"), rgb(getComputedStyle(line).stroke), paper]);
        }""")
    assert len(found) == len(contact.MODELS)
    for name, stroke, paper in found:
        assert contrast(stroke, paper) >= least, (name, stroke, paper)


@needs_chromium
def test_the_whole_page_paints_within_half_a_second_and_then_nothing_moves(browser, url):
    """The least of three loads; layout shift while it is scrolled through, before any bet."""
    times, shifts = [], []
    for _ in range(3):
        with visiting(browser, url, shown=False, motion="no-preference") as page:
            page.evaluate("""() => { window.shift = 0;
              new PerformanceObserver((list) => {
                for (const e of list.getEntries()) if (!e.hadRecentInput) window.shift += e.value;
              }).observe({type: "layout-shift", buffered: true}); }""")
            for share in (0.1, 0.5, 0.9):
                page.evaluate("(s) => scrollTo(0, s * document.body.scrollHeight)", share)
                page.wait_for_timeout(100)
            paint = "performance.getEntriesByName('first-contentful-paint')[0].startTime"
            times.append(page.evaluate(paint))
            shifts.append(page.evaluate("window.shift"))
    assert min(times) < 500 and max(shifts) < 0.1, (times, shifts)
