"""The compiled twin of contact.py gives the bytes of the plain loops, whatever it is given."""

import math
import os
import re
import shutil

import numpy as np
import pytest

import contact
from curriculum.bench.measure import shaft
from curriculum.lesson import to_loops
from curriculum.stress import scenes
from curriculum.tests.helpers import ROOT, python

fast = pytest.importorskip("curriculum.fast", reason="numba is missing", exc_type=ImportError)
MODELS = contact.STEPPED
WILD = (math.nan, math.inf, -math.inf, 1e200, -1e308, 1e-200, -0.0)


def check_same(model, scene, dt, steps, **knobs):
    """Both ways give the same bytes, or both stop at the same error. Returns what the twin gave."""
    chosen, found = contact.Settings(**knobs), []
    for way in (plainly, fast.run_model):
        try:
            found.append(way(model, scene, dt, steps, chosen))
        except ArithmeticError as error:
            found.append(type(error))
    one, other = found
    if isinstance(one, type) or isinstance(other, type):
        assert one is other
        return None
    for name, left, right in zip("tqv", one, other):
        differ = (left.view(np.int64) != right.view(np.int64)).reshape(len(left), -1).any(1)
        assert not differ.any(), f"{name} of {model} first differs at step {differ.argmax()}"
    gaps = [way(other.q, scene.radius) for way in (fast.smallest_gap, contact.smallest_gap)]
    np.testing.assert_array_equal(*gaps)
    return other


def plainly(model, scene, dt, steps, chosen):
    """The run by contact.py's own loops, no step left out."""
    return contact.simulate(contact.step_of(model, scene, dt, chosen), scene, dt, steps)


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_has_the_bytes_of_the_plain_loops(model):
    """On the stress run's scenes, some far from 0, some with a number that is none."""
    for number in range(80):
        rng, spec = np.random.default_rng(number), scenes.numbered_spec(number, number % 2 > 0)
        if model == "soft":  # whose sweeps take long where many hard contacts share balls
            spec |= {name: spec[name][:6] for name in scenes.BODY} | {"restitution": 0.0}
        scene = scenes.to_scene(spec)
        if number % 4 == 0:
            state = (scene.q0, scene.v0)[rng.integers(2)]
            state[rng.integers(2), rng.integers(state.shape[1])] = rng.choice(WILD)
        scene.q0[0] += rng.choice((0.0, 0.0, 1e5, -1e9, 1e15))
        knobs = {name: spec[name] for name in scenes.KNOBS}
        solimp = (None, (0.0, 0.99, 0.02, 0.4, 2.5), (0.5, 0.9, 0.0, 0.5, 1.0))[number % 3]
        check_same(model, scene, rng.choice((0.002, 1e-4, 0.03, 1e154)), 12, **knobs, solimp=solimp)


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_has_the_bytes_of_the_plain_loops_until_all_balls_rest(model):
    for name in ("drop", "bounce", "stack"):
        check_same(model, contact.build_scene(name, 3), 0.002, 1200, warm=0.8)
        check_same(model, contact.build_scene(name, 3), 0.002, 1200, baumgarte=1.0)
    check_same(model, contact.build_scene("pile", 1, 24, restitution=0.4), 0.004, 150)


@pytest.mark.parametrize("model, mass, y, dt, iters, baumgarte, warm", [
    ("lcp", [6.2, 3.6, 0.3], [0.1, 0.299, 0.498], 0.002, 5, 1.0, 0.5),
    ("lcp", [0.7, 0.2], [0.1, 0.299], 0.01, 2, 0.5, 0.5),
    ("soft", [1.5, 5.8, 2.7], [0.1, 0.299, 0.498], 0.01, 2, 0.5, 0.8),
])  # fmt: skip
def test_balls_that_stand_still_go_on_while_their_impulses_change(
    model, mass, y, dt, iters, baumgarte, warm
):
    scene = contact.scene_of(0.0, y, mass)
    chosen = contact.Settings(iters=iters, baumgarte=baumgarte, warm=warm)
    twin = fast.run_model(model, scene, dt, 400, chosen)
    plain = contact.run_model(model, scene, dt, 400, chosen)  # with skips
    assert plain.q.tobytes() == twin.q.tobytes() and plain.v.tobytes() == twin.v.tobytes()


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_sees_two_balls_meet_that_were_as_far_apart_as_its_list_looks(model):
    """From the end of the list and just beyond, so slowly that it lasts as long as it may."""
    reach = contact.CONTACT_MARGIN if model == "lcp" else 0.0  # the list looks a radius farther
    for gap in (0.0985 + reach, 0.10001 + reach):
        slow = contact.scene_of([0.0, 0.2 + gap], 0.1, vx=[0.025, -0.025])
        run = check_same(model, slow, 0.002, 1040)
        assert run.v[-1, 0, 0] < 0.02, "they met"


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_has_the_bytes_of_the_plain_loops_between_walls_and_under_a_large_ball(model):
    walls = shaft(12)
    added = ((walls.q0[0], 0.3), (walls.q0[1], 11.5), (walls.mass, 1e3), (walls.radius, 10.0))
    crushed = contact.scene_of(*(np.append(row, of_it) for row, of_it in added))
    crushed.v0[1, -1] = -5.0
    mass, radius = [math.inf, math.inf, 0.7], [0.17, 0.17, 0.13]
    gap = contact.scene_of([-0.3, 0.3, 0], [0.5, 0.5, 0.51], mass, radius, [0, 0, 9], 0, 0.9)
    for scene in (walls, crushed, gap):
        check_same(model, scene, 0.004, 120)


def test_a_pile_comes_to_rest_from_a_warm_start_and_lies_less_deep():
    speed, depth = {}, {}
    scene = shaft(100)
    for warm in (0.0, 0.8):
        _, q, v = fast.run_model("lcp", scene, 0.002, 6000, contact.Settings(warm=warm))
        speed[warm] = np.sqrt((v[-1] ** 2).sum(0)).max()
        depth[warm] = -fast.smallest_gap(q[-1:], scene.radius)[0]
    assert max(speed.values()) < 1e-3
    assert 0.0 < depth[0.8] < 0.6 * depth[0.0]


def test_a_run_taken_on_in_parts_has_the_bytes_of_the_whole():
    scene, chosen = contact.build_scene("pile", 2, 30), contact.Settings(warm=0.8)
    whole = fast.run_model("lcp", scene, 0.002, 300, chosen)
    stepper = fast.Stepper("lcp", scene, 0.002, chosen)
    rows = np.empty((301, 4, 30))
    for first, last in ((0, 1), (1, 120), (120, 300)):
        stepper.take(rows[first : last + 1])
    assert np.array_equal(rows[1:, :2], whole.q[1:])
    assert np.array_equal(rows[1:, 2:], whole.v[1:])


def test_run_model_gives_many_balls_to_the_twin_and_says_how_far_it_is():
    scene, heard = contact.build_scene("pile", 0, 200), []
    fast.run_model("lcp", scene, 0.002, 1, contact.Settings())  # now its loops are kept
    run = contact.run_model("lcp", scene, 0.002, 130, progress=heard.append)
    assert heard == [130], "the plain loops report every step"
    assert run.q.tobytes() == plainly("lcp", scene, 0.002, 130, contact.Settings()).q.tobytes()


PLAIN = (
    "import contact; "
    "print(contact.run_model('lcp', contact.build_scene('pile', 0, 40), 0.002, 700).q.sum())"
)
TWICE = "def twice(x):\n    return 2.0 * x\n"
TINY = (
    "from curriculum.lesson import compiled; "
    f"print(compiled.Loops('tiny', {TWICE!r}).load({{'twice': (1.0,)}}).twice(3.0))"
)


def run_in(folder, code, **environment):
    """The number that a copy of the course in a folder prints."""
    if not (folder / "contact.py").exists():
        shutil.copy(ROOT / "contact.py", folder)
        shutil.copytree(ROOT / "curriculum/lesson", folder / "curriculum/lesson")
        for name in ("__init__.py", "commands.py", "fast.py"):
            shutil.copy(ROOT / "curriculum" / name, folder / "curriculum")
    done = python("-c", code, cwd=folder, PYTHONPATH="", **environment)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr[-2000:]
    return float(done.stdout)


def test_nothing_is_compiled_for_a_short_run_or_where_numba_must_not(tmp_path):
    scene = contact.build_scene("pile", 0, 40)
    right = plainly("lcp", scene, 0.002, 700, contact.Settings()).q.sum()
    assert run_in(tmp_path, PLAIN) == run_in(tmp_path, PLAIN, NUMBA_DISABLE_JIT="1") == right
    assert not (tmp_path / ".cache").exists()


def test_whatever_stands_in_the_way_of_the_kept_loops_they_give_the_same(tmp_path):
    """Cut, random, a file in place of the folder, no home."""
    cache = tmp_path / ".cache/loops"
    assert run_in(tmp_path, TINY) == 6.0 and list(cache.glob("tiny_*/kept"))
    for content in (b"cut", os.urandom(3000)):
        kept = [*cache.rglob("*.nb?")]
        assert kept, "compiled anew and kept"
        for path in kept:
            path.write_bytes(content)
        assert run_in(tmp_path, TINY, HOME="/nowhere") == run_in(tmp_path, TINY) == 6.0
    shutil.rmtree(tmp_path / ".cache")
    (tmp_path / ".cache").write_text("no folder")
    assert run_in(tmp_path, TINY) == 6.0


def test_other_source_and_other_constants_are_other_loops(monkeypatch):
    names = {fast.loops_of("lcp_step").name}
    monkeypatch.setattr(contact, "GRAVITY", -1.62)
    assert "GRAVITY = -1.62" in fast.loops_of("lcp_step").source
    assert len(names | {fast.loops_of("lcp_step").name, fast.loops_of("soft_step").name}) == 3


SIXTH = (
    "def sixth_step(balls, dt):\n    contacts = detect_contacts(balls)\n    {}\n    return contacts"
)


@pytest.mark.parametrize("line, words", [
    ("top = max(ball.y for ball in balls)", "(ball.y for ball in balls)"),
    ("struck = {c.a for c in contacts}", "{c.a for c in contacts}"),
    ("balls.sort()", "balls.sort()"),
    ("balls[0].colour = 1.0", "balls[0].colour"),
])  # fmt: skip
def test_what_no_loop_can_say_is_refused_with_its_line_and_what_to_write_instead(
    line, words, tmp_path
):
    lesson, file = (ROOT / "contact.py").read_text("utf-8"), tmp_path / "contact.py"
    file.write_text(lesson + SIXTH.format(line), "utf-8")
    place = f"contact.py:{lesson.count(chr(10)) + 3}: {words}: no loop can say it; write loops"
    with pytest.raises(to_loops.Refused, match=re.escape(place)):
        to_loops.loops("sixth_step", file)
