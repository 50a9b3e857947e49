"""The page's engine in real browsers, against contact.py."""

import base64
import functools
import json

import numpy as np
import pytest

import contact
from curriculum.page.build import page_data
from curriculum.page.bundle import bundle

TO_LAST_BIT = ("penalty", "lcp", "soft")


def random_case(pick):
    """A scene of up to six balls and knobs for it, as contact.py takes them."""
    name = pick.choice(["drop", "bounce", "stack", "pile"])
    e = float(pick.choice([0.0, 1.0, pick.random()]))
    c = float(pick.choice([0.0, 300 * pick.random()]))
    scene = contact.build_scene(name, int(pick.integers(100)), 6 if name == "pile" else None, e, c)
    v0 = pick.uniform(-1, 1, scene.v0.shape) if name == "pile" else scene.v0
    solref = (float(pick.uniform(0.002, 0.1)), float(pick.uniform(0.2, 2)))
    solimp = (*pick.random(2), 10 ** pick.uniform(-4, -1), pick.random(), pick.integers(1, 6))
    settings = contact.Settings(
        stiffness=float(10 ** pick.uniform(2, 6)),
        baumgarte=float(pick.choice([0.0, 1.0, pick.random()])),
        iters=int(pick.integers(1, 60)),
        warm=float(pick.choice([0.0, 0.8, 1.0])),
        solref=solref if pick.random() < 0.5 else None,
        solimp=tuple(map(float, solimp)) if pick.random() < 0.5 else None,
        ahead=bool(pick.random() < 0.5),
    )
    return scene._replace(v0=v0), float(10 ** pick.uniform(-3.3, -1.2)), settings


def as_told(scene, dt, settings, steps, model):
    """The same as engine.js takes it."""
    columns = dict(zip(("x", "y", "vx", "vy"), np.concatenate((scene.q0, scene.v0)).tolist()))
    mass = [value if np.isfinite(value) else None for value in scene.mass.tolist()]
    columns |= {"mass": mass, "radius": scene.radius.tolist()}
    material = {"restitution": scene.restitution, "damping": scene.damping}
    knobs = {k: v for k, v in settings._asdict().items() if v is not None} | material | {"dt": dt}
    return [model, columns | material, knobs, steps]


@functools.cache
def cases():
    """[(what engine.js is told, the run of contact.py)] of random scenes."""
    pick, found = np.random.default_rng(26), []
    for _ in range(24):
        scene, dt, settings = random_case(pick)
        for model in TO_LAST_BIT:
            run = contact.run_model(model, scene, dt, 120, settings)
            found.append((as_told(scene, dt, settings, 120, model), run))
    named = [(name, e) for name in ("drop", "bounce", "stack") for e in (0.0, 0.7)]
    for scene in (contact.build_scene(name, 3, restitution=e) for name, e in named):
        run = contact.run_model("exact", scene, 0.002, 600)
        found.append((as_told(scene, 0.002, contact.Settings(), 600, "exact"), run))
    return found


def runs_in(evaluate):
    """x, y, vx, vy by engine.js of all cases; `evaluate` gives the value of an expression."""
    script = f"""(() => {{
      const engine = {bundle("engine.js", page_data([]))};
      const letters = (a) => Array.from(new Uint8Array(a.buffer), (b) => String.fromCharCode(b));
      const coded = (a) => btoa(letters(a).join(""));
      return {json.dumps([told for told, _ in cases()])}.map(([model, scene, knobs, steps]) => {{
        scene.mass = scene.mass.map((mass) => mass ?? Infinity);
        const run = engine.runModel(model, scene, knobs, steps);
        return [run.x, run.y, run.vx, run.vy].map(coded);
      }});
    }})()"""
    return [[np.frombuffer(base64.b64decode(text)) for text in run] for run in evaluate(script)]


def judge(found):
    """Every run has contact.py's bits; exact is within 1e-10 r."""
    for ((model, *told), run), mine in zip(cases(), found):
        theirs = [run.q[:, 0], run.q[:, 1], run.v[:, 0], run.v[:, 1]]
        for a, b in zip(mine, theirs):
            if model == "exact":
                assert np.abs(a - b.ravel()).max() <= 1e-10 * contact.RADIUS, told
            else:
                same = (a.view(np.uint64) == b.ravel().view(np.uint64)) | (
                    np.isnan(a) & np.isnan(b.ravel())
                )
                assert same.all(), (model, told)


@pytest.fixture(scope="module")
def tabs(browser, gecko):
    """An empty tab of Chromium, and one of Firefox."""
    gecko.visit("about:blank")
    return browser.new_page(), gecko


@pytest.mark.parametrize("which", (0, 1), ids=("chromium", "firefox"))
def test_a_browser_computes_penalty_lcp_and_soft_to_the_last_bit_and_exact_to_1e_10_r(which, tabs):
    judge(runs_in(tabs[which].evaluate))


@pytest.mark.parametrize("lean", (0.1, 0.35, 0.9))
def test_ball_slides_off_a_held_ball_as_exact_has_it_within_1e_10_r(tabs, lean):
    r, dt, steps = contact.RADIUS, 2e-4, 3000
    q0 = np.array([[0.0, 2 * r * np.sin(lean)], [5.0, 5.0 + 2 * r * np.cos(lean)]])
    mass = np.array([np.inf, 1.0])
    scene = contact.Scene("slide", q0, 0 * q0, mass, np.full(2, r), 0.0, 0.0)
    run = contact.run_model("exact", scene, dt, steps)
    call = f".slideOff({lean}, {2 * r}, {-contact.GRAVITY}, {dt}, {steps})"
    for real in tabs:
        found = real.evaluate(bundle("sliding.js", {}) + call)
        assert np.abs(found["path"] - (run.q[:, :, 1] - q0[:, 0])).max() < 1e-10 * r
        assert np.cos(found["leaves"]) == pytest.approx(2 / 3 * np.cos(lean), rel=1e-12)
