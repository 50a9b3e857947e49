"""The page's engine in real browsers, against contact.py."""

import base64
import functools
import json

import numpy as np
import pytest

import contact
from curriculum.implicit import implicit_step
from curriculum.page.build import page_data
from curriculum.page.bundle import bundle

STEPS = 120


def random_case(pick):
    """A scene of up to six balls and knobs for it, as contact.py takes them."""
    name = pick.choice(["drop", "bounce", "stack", "pile", "own"])
    e = float(pick.choice([0.0, 1.0, pick.random()]))
    c = float(pick.choice([0.0, 300 * pick.random()]))
    if name == "own":  # a heap that begins in one another, one of its balls held
        mass, radius = 10 ** pick.uniform(-2, 2, 5), pick.uniform(0.03, 0.3, 5)
        mass[int(pick.integers(5))] = np.inf
        x, y, vx, vy = pick.uniform(-0.4, 0.4, 5), pick.uniform(0, 1, 5), *pick.normal(0, 3, (2, 5))
        scene = contact.scene_of(x, y, mass, radius, vx, vy, e, c)
    else:
        bodies = 6 if name == "pile" else None
        scene = contact.build_scene(name, int(pick.integers(100)), bodies, e, c)
        size = len(scene.mass)
        unequal = {"mass": 10 ** pick.uniform(-1, 1, size)}
        unequal |= {"v0": pick.uniform(-1, 1, scene.v0.shape)} if name == "pile" else {}
        scene = scene._replace(**unequal)
    solref = (float(pick.uniform(0.002, 0.1)), float(pick.uniform(0.2, 2)))
    solimp = (*pick.random(2), 10 ** pick.uniform(-4, -1), pick.random(), pick.integers(1, 6))
    settings = contact.Settings(
        stiffness=float(10 ** pick.uniform(2, 6)),
        baumgarte=float(pick.choice([0.0, 1.0, pick.random()])),
        iters=int(pick.integers(1, 60)),
        warm=float(pick.choice([0.0, 0.8, 1.0])),
        solref=solref if pick.random() < 0.5 else None,
        solimp=tuple(map(float, solimp)) if pick.random() < 0.5 else None,
    )
    return scene, float(10 ** pick.uniform(-3.3, -1.2)), settings


def as_told(scene, dt, settings, steps, model):
    """The same as engine.js takes it."""
    columns = dict(zip(("x", "y", "vx", "vy"), np.concatenate((scene.q0, scene.v0)).tolist()))
    mass = [value if np.isfinite(value) else None for value in scene.mass.tolist()]
    columns |= {"mass": mass, "radius": scene.radius.tolist()}
    material = {"restitution": scene.restitution, "damping": scene.damping}
    knobs = {k: v for k, v in settings._asdict().items() if v is not None} | material | {"dt": dt}
    return [model, columns | material, knobs, steps]


def run_implicit(scene, dt, settings):
    """The run of the implicit spring."""
    k, c = settings.stiffness, scene.damping
    softness = 1.0 / (k * dt * dt + c * dt)

    def step(balls):
        implicit_step(balls, dt, lambda depth: (softness, dt * k * depth * softness))

    return contact.simulate(step, scene, dt, STEPS)


@functools.cache
def cases():
    """[(what engine.js is told, the run of contact.py)] of random scenes."""
    pick, found = np.random.default_rng(26), []
    for _ in range(30):
        scene, dt, settings = random_case(pick)
        for model in contact.STEPPED:
            run = contact.run_model(model, scene, dt, STEPS, settings)
            found.append((as_told(scene, dt, settings, STEPS, model), run))
        run = run_implicit(scene, dt, settings)
        found.append((as_told(scene, dt, settings, STEPS, "implicit"), run))
    for vy in (2.0, [-1.7e308, 1e308]):  # they end in infinities and in no number
        fast = contact.scene_of([-0.1, 0.12], 0.3, [3, 0.2], [0.2, 0.17], [1e308, -1e308], vy)
        for model in contact.STEPPED:
            run = contact.run_model(model, fast, 0.03, STEPS)
            found.append((as_told(fast, 0.03, contact.Settings(), STEPS, model), run))
    settings = contact.Settings(iters=50)
    x, y, r = [-0.3, 0.3, 0.0], [0.5, 0.5, 0.51], [0.17, 0.17, 0.13]
    gap = contact.scene_of(x, y, [np.inf, np.inf, 0.7], r, [0, 0, 9], restitution=0.9)
    run = contact.run_model("leapfrog", gap, 0.003, STEPS, settings)
    found.append((as_told(gap, 0.003, settings, STEPS, "leapfrog"), run))
    named = [(name, e) for name in ("drop", "bounce", "stack") for e in (0.0, 0.7)]
    for scene in (contact.build_scene(name, 3, restitution=e) for name, e in named):
        run = contact.run_model("exact", scene, 0.002, 600)
        found.append((as_told(scene, 0.002, contact.Settings(), 600, "exact"), run))
    return found


def script():
    """A script whose value is x, y, vx, vy by engine.js of all cases."""
    return f"""(() => {{
      const engine = {bundle("engine.js", page_data([]))};
      const letters = (a) => Array.from(new Uint8Array(a.buffer), (b) => String.fromCharCode(b));
      const coded = (numbers) => btoa(letters(numbers).join(""));
      return {json.dumps([told for told, _ in cases()])}.map(([model, scene, knobs, steps]) => {{
        scene.mass = scene.mass.map((mass) => mass ?? Infinity);
        const run = engine.runModel(model, scene, knobs, steps);
        return [run.x, run.y, run.vx, run.vy].map(coded);
      }});
    }})()"""


def judge(found):
    """Every run has contact.py's bytes, where it is no number, too; exact is within 1e-10 r."""
    ends = {told[0] for told, run in cases() if np.isnan(run.q).any()}
    assert len(found) == len(cases()) and ends == set(contact.STEPPED)
    for ((model, *told), run), mine in zip(cases(), found):
        theirs = [run.q[:, 0], run.q[:, 1], run.v[:, 0], run.v[:, 1]]
        for text, column in zip(mine, theirs):
            held = base64.b64decode(text)
            if model == "exact":
                off = np.frombuffer(held) - column.ravel()
                assert np.abs(off).max() <= 1e-10 * contact.RADIUS, told
            else:
                assert held == column.tobytes(), (model, told)


@pytest.mark.parametrize("which", ("chromium", "firefox"))
def test_a_browser_computes_what_steps_to_the_last_bit_and_exact_to_1e_10_r(which, request):
    if which == "chromium":
        judge(request.getfixturevalue("browser").new_page().evaluate(script()))
    else:
        gecko = request.getfixturevalue("gecko")
        gecko.visit("about:blank")
        judge(gecko.evaluate(script()))
