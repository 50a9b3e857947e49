"""The explaining figures answer to a drag and to arrow keys, and show what contact.py finds."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import contact
from curriculum.page.build import build, page_data
from curriculum.page.bundle import evaluate
from curriculum.page.chapter import CHAPTER
from curriculum.regions import ROOT
from curriculum.tests.page_browser import middle, mouse, visiting
from exercises.kit import trials

SLOT = re.compile(r"<!-- figure: ([\w-]+) -->")
SLOTS = sorted(set(SLOT.findall((ROOT / CHAPTER).read_text("utf-8"))))
# the other figures of the page are tested with the page itself
OTHERS = {"grab", "two", "lanes"}
# what follows the puzzle stands behind a veil
SHOWN = [*sorted(set(SLOTS) - OTHERS - {"puzzle"}), "puzzle"]
PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")  # how print sets minus and powers
DT, RADIUS, WEIGHT = 0.002, contact.RADIUS, -contact.GRAVITY


def test_every_figure_has_a_slot_in_the_chapter_and_every_slot_a_figure():
    assert sorted(evaluate("still.js", page_data([]), "settable()")["names"]) == SLOTS


@pytest.fixture(scope="module")
def tab(tmp_path_factory, browser):
    """A browser tab on a page whose first section holds every explaining figure."""
    file = tmp_path_factory.mktemp("figures") / "figures.html"
    slots = "\n\n".join(f"The {name}.\n\n<!-- figure: {name} -->" for name in SHOWN)
    apart = "## Apart\n\n<!-- figure: sponge -->"
    file.write_text(build(f"# Figures\n\n## All\n\n{slots}\n\n{apart}\n"), encoding="utf-8")
    with visiting(browser, file.as_uri()) as page:
        yield page


touched = set()  # figures that a test has had in its hands since the page was loaded


def figure(tab, name, query=None):
    """A figure by its name, in sight; with a query, untouched on a page that has this query."""
    page, *asked = re.split(r"(?=\?)", tab.url.partition("#")[0])
    if query is not None and (name in touched or asked != [query] * bool(query)):
        tab.goto(page + query)
        tab.wait_for_selector("[data-ready]", state="attached")
        touched.clear()
    touched.add(name)
    box = tab.locator(f"#fig-{name}")
    box.scroll_into_view_if_needed()
    box.locator(".handle").first.wait_for(state="attached")
    settle(tab)  # it is drawn anew when it comes near
    return box


def said(box):
    """What the figure says in words, its numbers as Python writes them."""
    text = box.locator(".words").inner_text().replace(" × 10", "e").translate(PLAIN)
    return re.sub(r"(?<=\d),(?=\d{3}\b)", "", text)


def numbers(box):
    return [float(each) for each in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", said(box))]


def handle(box, name):
    return box.locator(f'.handle[data-handle="{name}"]')


def drag(tab, grip, by):
    """Drag a handle by (x, y) px with the mouse."""
    for _ in mouse(tab, *middle(grip), [by]):
        settle(tab)
    settle(tab)


def settle(tab):
    """Wait for two frames."""
    frame = "new Promise(requestAnimationFrame)"
    tab.evaluate(f"async () => {{ await {frame}; await {frame}; }}")


def press(tab, grip, key, times=1):
    grip.focus()
    for _ in range(times):
        tab.keyboard.press(key)
    settle(tab)


@pytest.mark.parametrize("name", SHOWN)
def test_a_figure_is_told_in_words_and_every_handle_answers_to_arrow_keys_and_to_a_drag(tab, name):
    """Held where it is dragged: what a handle tells changes, and keyboard focus stays on it."""
    box = figure(tab, name)
    told = box.locator(".drawing > svg").get_attribute("aria-label")
    assert box.locator(".words").inner_text() in told
    caption = re.sub(r"\d\.\d", "", box.locator("figcaption").inner_text())
    assert caption.count(".") == 1 and caption[-1] == ".", caption
    names = [grip.get_attribute("data-handle") for grip in box.locator(".handle").all()]
    assert names
    for label in names:
        grip = handle(box, label)
        assert grip.get_attribute("aria-label")
        told = []
        for key in ("ArrowUp", "ArrowDown"):
            press(tab, grip, key, 2)
            told.append(grip.get_attribute("aria-valuetext"))
        assert told[0] != told[1], f"{label}: arrow keys change nothing"
        assert tab.evaluate("() => document.activeElement.dataset.handle") == label
        before = box.locator(".drawing").inner_html()
        drag(tab, grip, (48, -24))
        assert box.locator(".drawing").inner_html() != before, f"{label}: a drag changes nothing"


def test_a_quantity_dragged_in_one_figure_is_the_same_in_its_section_and_stays_in_others(tab):
    drag(tab, handle(figure(tab, "sponge", ""), "stiffness"), (60, 0))
    shown = handle(figure(tab, "sponge"), "stiffness").get_attribute("aria-valuenow")
    assert float(shown) < 5000
    tab.wait_for_function("end => location.href.endsWith(end)", arg=f"?stiffness={shown}#all")
    values = {"corner-penalty": shown, "stack": shown, "cliff": shown, "sponge-2": "10000"}
    for name, value in values.items():
        knob = figure(tab, name).locator('[data-knob="stiffness"] input[type="text"]')
        assert knob.input_value() == value


def depths(model, dt=DT, **knobs):
    """How deep [r] contact.py's dropped ball is, step by step."""
    scene, settings = contact.build_scene("drop"), contact.Settings(**knobs)
    return 1 - contact.run_model(model, scene, dt, 4000, settings).q[:, 1, 0] / RADIUS


def test_springs_show_the_depths_of_contact_py(tab):
    sponge = figure(tab, "sponge", "?stiffness=5000")
    assert numbers(sponge)[0] == pytest.approx(depths("penalty", stiffness=5e3)[-1], rel=5e-3)
    drag(tab, handle(sponge, "press"), (0, 30))  # nothing may move: it is at rest at once
    assert "It rests" in said(sponge)
    stack = figure(tab, "stack")
    assert numbers(stack)[:2] == pytest.approx([3, 3 * WEIGHT / 5e3 / RADIUS], rel=5e-3)
    press(tab, handle(stack, "ball-1"), "ArrowUp", 3)
    assert numbers(stack)[:2] == pytest.approx([1, WEIGHT / 5e3 / RADIUS], rel=5e-3)


def test_signs_are_those_of_contact_py(tab):
    box = figure(tab, "signs", "")
    press(tab, handle(box, "ball"), "ArrowLeft", 5)
    press(tab, handle(box, "velocity"), "ArrowUp", 12)
    a = contact.Ball(0.19, 0.3, 0.3, 0.0, 1.0, RADIUS)
    b = contact.Ball(0.0, RADIUS, 0.0, 0.0, 1.0, RADIUS)
    found = [c for c in contact.detect_contacts([a, b], margin=1.0) if c.a is a]
    wanted = [number for c in found for number in (c.depth / RADIUS, c.v_n())]
    assert numbers(box) == pytest.approx(wanted, rel=5e-3)


def pressed(tab, name):
    """Gap [r] and force [m g] in a figure of the corner, its ball pressed as hard as it goes."""
    box = figure(tab, name)
    drag(tab, handle(box, "hand"), (0, 200))
    text = said(box)
    return float(re.search(r"gap (\S+) r", text)[1]), float(re.search(r"force (\S+) m g", text)[1])


def test_each_model_keeps_to_its_own_law_on_the_corner(tab):
    """Pressed: no gap with a wall; on a ramp F / k; in soft K d^2 depth = (1 - d) F."""
    figure(tab, "corner", "?stiffness=20000")
    for name in ("corner", "corner-lcp"):
        gap, force = pressed(tab, name)
        assert gap == 0 and force == 30
    gap, force = pressed(tab, "corner-penalty")
    assert -gap * RADIUS == pytest.approx(force * WEIGHT / 20000, rel=0.05)
    gap, force = pressed(tab, "corner-soft")
    (timeconst, ratio), solimp = contact.soft_defaults(0.0, DT)
    stiff = 1 / (solimp[1] * timeconst * ratio) ** 2
    d = contact.impedance(-gap * RADIUS, solimp)
    assert stiff * d**2 * -gap * RADIUS == pytest.approx((1 - d) * force * WEIGHT, rel=0.05)


def test_puzzle_tells_how_deep_a_spring_sinks_and_whether_it_comes_to_rest(tab):
    for k, told in ((1e4, "comes to rest"), (1e6, "explodes")):
        puzzle = figure(tab, "puzzle", f"?stiffness={k:.0f}&damping=80&dt=0.01")
        assert numbers(puzzle)[-1] == pytest.approx(WEIGHT / k / RADIUS, rel=5e-3)
        late = depths("penalty", dt=0.01, stiffness=k)[-200:]
        assert told in said(puzzle) and (np.ptp(late) < 1e-3) == (told == "comes to rest")


def test_drops_that_a_figure_looks_at_in_one_loop_have_the_bits_of_contact_py():
    for dt, k, c in ((0.002, 1e4, 80.0), (0.0141, 1e4, 80.0), (0.01, 300.0, 0.0)):
        shown = evaluate("kit.js", page_data([]), f"drops({dt}, {k}, {c}, 2000).join()")
        scene = contact.build_scene("drop", damping=c)
        run = contact.run_model("penalty", scene, dt, 2000, contact.Settings(stiffness=k))
        assert [float(each) for each in shown.split(",")] == run.q[:, 1, 0].tolist()


def test_one_long_step_has_the_eigenvalues_of_its_matrix_and_the_cliff_explodes(tab):
    k, c, dt = 1e4, 80.0, 0.012
    step = np.array([[1 - k * dt * dt, -dt * (1 - c * dt)], [k * dt, 1 - c * dt]])
    shown = numbers(figure(tab, "long-step", "?dt=0.012"))
    assert shown[1] == pytest.approx(np.abs(np.linalg.eigvals(step)).max(), rel=5e-3)
    assert shown[2] == pytest.approx(1000 * contact.critical_dt(1.0, k, c), rel=5e-3)
    assert "comes to rest" in said(figure(tab, "cliff"))
    scene = contact.build_scene("drop")
    run = contact.run_model("penalty", scene, 0.03, 2000)
    gained = contact.contact_quality(run, scene, 0.03)["energy_excess"]
    assert numbers(figure(tab, "cliff", "?dt=0.03"))[1] == pytest.approx(gained, rel=1e-3)
    assert "explodes" in said(figure(tab, "cliff"))


def test_sweeps_carry_what_contact_py_finds_contact_by_contact(tab):
    heights = [RADIUS, 3 * RADIUS, 5 * RADIUS]
    balls = contact.make_balls(contact.scene_of([0.0] * 3, heights))
    contacts = contact.detect_contacts(balls, margin=1e-9)
    contact.accelerate(balls, DT)
    contact.solve_contacts(contacts, 3)
    box = figure(tab, "sweeps", "")
    press(tab, handle(box, "time"), "ArrowRight", 6)
    assert numbers(box)[-3:] == pytest.approx([c.lam / (WEIGHT * DT) for c in contacts], rel=5e-3)
    press(tab, handle(box, "top"), "ArrowUp", 15)
    press(tab, handle(box, "time"), "ArrowRight", 6)
    assert "clamped at 0" in said(box) and numbers(box)[-1] == 0


def test_blocks_count_the_digits_of_pi_and_lcp_loses_count(tab):
    blocks = figure(tab, "blocks", "")
    for n, impacts in enumerate((3, 31, 314, 3141)):
        press(tab, handle(blocks, "n"), "ArrowDown", 4)
        press(tab, handle(blocks, "n"), "ArrowUp", n)
        assert f"exact counts {impacts} impacts" in said(blocks)
        counted = int(re.search(r"lcp at dt = 2 ms counts (\d+)", said(blocks))[1])
        assert n < 3 or counted < impacts  # they come faster than its steps
    blocks.locator("button:text('Play')").click()
    kept_in_sight(tab, blocks)


def kept_in_sight(tab, box):
    """Whatever can be grabbed has its middle within the drawing."""
    settle(tab)
    frame = box.locator(".drawing").bounding_box()
    for grip in box.locator(".handle").all():
        place = grip.bounding_box()
        middle = place["x"] + place["width"] / 2
        assert frame["x"] <= middle <= frame["x"] + frame["width"], grip


def test_the_sum_of_bounce_and_bias_throws_the_ball_higher_than_the_larger_of_them(tab):
    bounce, bias, larger, both = numbers(figure(tab, "landing", "?restitution=0.7"))[2:]
    heights = [v * v / (2 * WEIGHT * RADIUS) for v in (max(bounce, bias), bounce + bias)]
    assert [larger, both] == pytest.approx(heights, rel=0.02) and both > larger + 0.1


def at_rest(masses, dt, **knobs):
    """How deep [r] the lowest of touching balls lies in the table after two seconds of lcp."""
    heights = (2 * np.arange(len(masses)) + 1) * RADIUS
    scene = contact.scene_of(0 * heights, heights, masses)
    run = contact.run_model("lcp", scene, dt, round(2 / dt), contact.Settings(**knobs))
    return 1 - run.q[-1, 1, 0] / RADIUS


def test_sag_is_that_of_contact_py_and_its_law_holds_for_one_sweep(tab):
    """At one sweep within 1 %; later the law is above it. Also for substeps, and heavy on light."""
    box = figure(tab, "sag", "")
    deep, law = numbers(box)[-2:]
    assert deep == pytest.approx(at_rest([1] * 8, dt=DT), rel=0.02) and deep < law
    press(tab, handle(box, "parts"), "ArrowRight", 9)  # as many substeps as there are sweeps
    deep, law = numbers(box)[-2:]
    assert deep == pytest.approx(at_rest([1] * 8, dt=DT / 20, iters=1), rel=0.02)
    assert law == pytest.approx(7 * WEIGHT * (DT / 20) ** 2 / 0.2 / RADIUS, rel=0.01)
    assert deep == pytest.approx(law, rel=0.01)
    press(tab, handle(box, "parts"), "ArrowLeft", 9)
    for _ in range(6):
        box.locator("button:text('less')").click()
    settle(tab)
    drag(tab, handle(box, "ball-1"), (0, -60))  # ten times as heavy
    assert numbers(box)[-2] == pytest.approx(at_rest([1, 10], dt=DT), rel=0.02)


def test_gripper_trembles_as_exercise_8_has_it_holds_at_half_the_step_and_is_gone_beyond(tab):
    chosen = {"MODEL": "penalty", "STIFFNESS": 1e4, "DAMPING": 80.0, "SOLREF": None, "SOLIMP": None}
    seen = trials.fingers(SimpleNamespace(DT=0.004, **chosen))
    for name in ("promise", "gripper"):
        box = figure(tab, name, "")
        told = [4, 1e4, seen["deepest"], seen["trembling"]]
        assert numbers(box)[: len(told)] == pytest.approx(told, rel=0.03)
    width = box.locator(".drawing").bounding_box()["width"]
    drag(tab, handle(box, "x0"), (-width, 0))
    kept_in_sight(tab, box)
    handle(box, "x0").focus()
    for _ in range(15):  # back from the end of its way, two millimetres a key
        tab.keyboard.press("ArrowRight")
    drag(tab, handle(box, "choice"), (-0.25 * width, 0))  # half the step
    assert "holds still" in said(box) and numbers(box)[0] == pytest.approx(2, abs=0.3)
    drag(tab, handle(box, "choice"), (0.33 * width, 0))
    assert "fly apart" in said(box) and box.locator(".scale").count()
    assert not trials.fingers(SimpleNamespace(DT=numbers(box)[0] / 1000, **chosen))["held"]


def test_inequality_ends_where_a_step_of_contact_py_ends(tab):
    box = figure(tab, "inequality", "")
    gap, moves, end = numbers(box)
    ball = contact.Ball(0.0, (1 + gap) * RADIUS, 0.0, -4.0, 1.0, RADIUS)
    contact.lcp_step([ball], DT, 0.0, 0.2, 20)
    assert [gap + moves, end] == pytest.approx(2 * [ball.y / RADIUS - 1], abs=2e-3)
    assert "does not push" in said(box) and end < 0


def test_bowl_ends_at_the_direct_solution_inside_the_quadrant_and_on_its_wall(tab):
    """Inside both contacts push: a linear system. On the wall the upper one does not."""
    box = figure(tab, "bowl", "")
    inside = np.linalg.solve([[1, -1], [-1, 2]], [1, 0])
    assert numbers(box)[2:4] == pytest.approx(inside.tolist(), rel=5e-3)
    for name, by in (("v2", (0, -66)), ("start", (60, 40))):  # the upper ball flies up
        drag(tab, handle(box, name), by)
        assert numbers(box)[2:4] == pytest.approx([1, 0], abs=5e-3)
