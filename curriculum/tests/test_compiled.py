"""The compiled loops give the bytes of contact.py's own steps, whatever they are given."""

import itertools
import math
import shutil

import numpy as np
import pytest

import contact
from curriculum.bench.measure import shaft
from curriculum.compiled import cache
from curriculum.compiled import run as compiled
from curriculum.stress import scenes
from curriculum.tests.helpers import python

pytest.importorskip("numba", reason="numba is missing")
MODELS = contact.STEPPED
WILD = (math.nan, math.inf, -math.inf, 1e200, -1e308, 1e-200, -0.0)


def check_same(model, scene, dt, steps, **knobs):
    """Both ways give the same bytes, or both stop at the same error. Returns the compiled run."""
    chosen, found, run = contact.Settings(**knobs), [], None
    for take in plainly, compiled.run_model:
        try:
            run = take(model, scene, dt, steps, chosen)
            found.append([each.tobytes() for each in run])
        except ArithmeticError as error:
            found.append(type(error))
    assert found[0] == found[1]
    return run


def plainly(model, scene, dt, steps, chosen):
    """The run by contact.py's own loops, no step left out."""
    return contact.simulate(contact.step_of(model, scene, dt, chosen), scene, dt, steps)


@pytest.mark.parametrize("model", MODELS)
def test_compiled_loops_have_the_bytes_of_the_plain_loops(model):
    """On the stress run's scenes, some far from 0, some with a number that is none."""
    for number in range(40):
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
def test_compiled_loops_have_the_bytes_of_the_plain_loops_under_a_large_ball(model):
    pile, walls = contact.build_scene("pile", 1, 24, restitution=0.4), shaft(12)
    added = ((walls.q0[0], 0.3), (walls.q0[1], 11.5), (walls.mass, 1e3), (walls.radius, 10.0))
    crushed = contact.scene_of(*(np.append(row, of_it) for row, of_it in added))
    crushed.v0[1, -1] = -5.0
    for scene in (pile, crushed):
        check_same(model, scene, 0.004, 120)


def test_balls_that_stand_still_go_on_while_their_impulses_change():
    scene = contact.scene_of(0.0, [0.1, 0.299], [0.7, 0.2])
    chosen = contact.Settings(iters=2, baumgarte=0.5, warm=0.5)
    ways = plainly, compiled.run_model, contact.run_model  # the last two skip
    runs = [way("lcp", scene, 0.01, 400, chosen) for way in ways]
    assert len({run.q.tobytes() + run.v.tobytes() for run in runs}) == 1


@pytest.mark.parametrize("model", MODELS)
def test_compiled_loops_see_two_balls_meet_that_were_as_far_apart_as_its_list_looks(model):
    """From the end of the list and just beyond, so slowly that it lasts as long as it may."""
    reach = contact.CONTACT_MARGIN if model == "lcp" else 0.0  # the list looks a radius farther
    for gap in (0.0985 + reach, 0.10001 + reach):
        slow = contact.scene_of([0.0, 0.2 + gap], 0.1, vx=[0.025, -0.025])
        run = check_same(model, slow, 0.002, 1040)
        assert run.v[-1, 0, 0] < 0.02, "they met"


def test_run_model_gives_many_balls_to_compiled_loops(monkeypatch):
    scene = contact.build_scene("pile", 0, 200)
    compiled.run_model("lcp", scene, 0.002, 1, contact.Settings())  # now its loops are kept
    monkeypatch.setattr(contact, "simulate", pytest.fail)
    run = contact.run_model("lcp", scene, 0.002, 130)
    monkeypatch.undo()
    assert run.q.tobytes() == plainly("lcp", scene, 0.002, 130, contact.Settings()).q.tobytes()


def test_once_all_is_compiled_no_run_compiles_anything(tmp_path):
    """Of any model, size, type of a number, layout of an array, or command line."""
    done = python("-m", "curriculum.compiled")
    assert done.returncode == 0, done.stderr
    before = kept_files()
    settings = (
        {"warm": 1, "baumgarte": 0, "iters": 5.0, "stiffness": 1000, "solref": (0, -500)},
        {"warm": 0.5, "solref": [0.02, 1], "solimp": [0, 0.99, 0.02, 0, 2]},
    )
    for model, count, knobs in itertools.product(MODELS, (1, 12), settings):
        scene = contact.build_scene("pile", 1, count, restitution=knobs["warm"])
        scene.q0.flags.writeable = scene.mass.flags.writeable = False
        wide = scene._replace(q0=np.asfortranarray(scene.q0), radius=np.broadcast_to(0.1, count))
        for given, dt in ((scene, np.float32(0.002)), (wide, 1)):
            compiled.run_model(model, given, dt, 5, contact.Settings(**knobs))
    for line in (
        "--scene pile --bodies 30 --steps 1300 --restitution 1 --warm 1 --solref 0 -600",
        "--scene stack --bodies 40 --dt 1e-4 --steps 700 --iters 3 --solimp 0 1 0.01 0 1",
    ):
        assert contact.main([*line.split(), "--no-rerun", "--out", str(tmp_path)]) == 0
    assert kept_files() == before


def kept_files():
    """The files of the loops as contact.py is now; numba adds one a signature."""
    loops = [compiled.loops_of(contact.MODELS[model].step.__name__) for model in MODELS]
    found = [each.folder.rglob("*.nb?") for each in (*loops, compiled.PAIRS)]
    return {(path, path.stat().st_size) for files in found for path in files}


def test_nothing_is_compiled_for_a_short_run_or_where_numba_must_not(monkeypatch, tmp_path):
    """Of 700 steps, for which contact.py asks whether it pays."""
    pile = "import contact; pile = contact.build_scene('pile', 0, 40)"
    code = f"{pile}; print(contact.run_model('lcp', pile, 0.002, 700).q.sum())"
    scene = contact.build_scene("pile", 0, 40)
    assert 700 * 40**2 > contact.COMPILE_FROM
    right = plainly("lcp", scene, 0.002, 700, contact.Settings()).q.sum()
    assert float(python("-c", code, NUMBA_DISABLE_JIT="1").stdout) == right
    monkeypatch.setattr(cache, "FOLDER", tmp_path)
    monkeypatch.setattr(contact, "GRAVITY", -3.71)  # whose loops this process has not loaded
    contact.run_model("lcp", scene, 0.002, 700)
    loops = compiled.loops_of("lcp_step")
    assert "GRAVITY = -3.71" in loops.source and loops.folder.parent == tmp_path
    assert not any(tmp_path.iterdir())


def twice(number):
    """The number times two, by loops that are loaded as a new process would."""
    loops = cache.Loops("tiny", "def twice(x):\n    return 2.0 * x\n")
    return loops.load({"twice": (1.0,)}).twice(number)


def test_whatever_stands_in_the_way_of_the_kept_loops_they_give_the_same(tmp_path, monkeypatch):
    """Cut, a file in place of the folder, no home."""
    monkeypatch.setenv("HOME", "/nowhere")
    monkeypatch.setattr(cache, "FOLDER", tmp_path / "loops")
    assert twice(3.0) == 6.0
    for _ in range(2):
        kept = [*tmp_path.rglob("*.nb?")]
        assert kept, "compiled anew and kept"
        for path in kept:
            path.write_bytes(b"cut")
        assert twice(3.0) == twice(3.0) == 6.0
    shutil.rmtree(tmp_path / "loops")
    (tmp_path / "loops").write_text("no folder")
    assert twice(3.0) == 6.0
