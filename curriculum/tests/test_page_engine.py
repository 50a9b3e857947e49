"""The steps of contact.py as JavaScript: the same bits, in V8 and in Firefox."""

import itertools
import json
from functools import cache, partial

import numpy as np
import pytest
from py_mini_racer import MiniRacer

import contact
from curriculum.page.build import page_data
from curriculum.page.bundle import bundle
from curriculum.page.to_js import to_js
from curriculum.stress import scenes
from curriculum.variants import implicit_step

SOLIMPS = ((0.2, 0.9, 0.005, 0.4, 3.0), (0.0, 1.0, 0.01, 0.3, 2.0), None)


def run_of(model, scene, dt, settings, steps):
    """The run of contact.py, or of the implicit spring."""
    if model == "exact":
        return contact.run_model(model, scene, dt, steps)
    if model != "implicit":
        return contact.simulate(contact.step_of(model, scene, dt, settings), scene, dt, steps)
    k, c = settings.stiffness, scene.damping
    softness = 1.0 / (k * dt * dt + c * dt)
    spring = {"spring": lambda depth: (softness, dt * k * depth * softness)}
    return contact.simulate(partial(implicit_step, dt=dt, **spring), scene, dt, steps)


def as_told(model, scene, dt, settings, steps):
    """The same as runs.js takes it."""
    columns = dict(zip(("x", "y", "vx", "vy"), np.concatenate((scene.q0, scene.v0)).tolist()))
    columns |= {"mass": scene.mass.tolist(), "radius": scene.radius.tolist()}
    knobs = settings._asdict() | {"restitution": scene.restitution, "damping": scene.damping}
    return [model, columns, knobs | {"dt": dt}, steps]


@cache
def cases():
    """[(what runs.js is told, the run of contact.py)] of random scenes, some in one another."""
    found, usual = [], contact.Settings()
    for number in range(40):
        spec = scenes.numbered_spec(number, small=True)
        knobs = {name: spec[name] for name in scenes.KNOBS} | {"solimp": SOLIMPS[number % 3]}
        drawn = scenes.to_scene(spec), spec["dt"], contact.Settings(**knobs)
        found += [(model, *drawn, 120) for model in (*contact.STEPPED, "implicit")]
    for vy in (2.0, [-1.7e308, 1e308]):  # they end in infinities and in no number
        fast = contact.scene_of([-0.1, 0.12], 0.3, [3, 0.2], [0.2, 0.17], [1e308, -1e308], vy)
        found += [(model, fast, 0.03, usual, 120) for model in contact.STEPPED]
    for name, e in itertools.product(("drop", "bounce", "stack"), (0.0, 0.7)):
        found.append(("exact", contact.build_scene(name, 3, restitution=e), 0.002, usual, 600))
    return [(as_told(*case), run_of(*case)) for case in found]


def judge(evaluate):
    """Every run has contact.py's bytes, where it is no number, too; exact is within 1e-10 r."""
    found = evaluate(f"""(() => {{
      const {{ column, record }} = {bundle("runs.js", page_data())};
      const hex = (numbers) => Array.from(new Uint8Array(new Float64Array(numbers).buffer),
        (byte) => byte.toString(16).padStart(2, "0")).join("");
      return {json.dumps([told for told, _ in cases()])}.map(([model, all, knobs, steps]) => {{
        const run = record(model, column(all.y, all), knobs, steps);
        return [run.x, run.y, run.vx, run.vy].map(hex);
      }});
    }})()""")
    ends = {told[0] for told, run in cases() if np.isnan(run.q).any()}
    assert len(found) == len(cases()) and ends == set(contact.STEPPED)
    for ((model, *told), run), mine in zip(cases(), found):
        for text, right in zip(mine, (run.q[:, 0], run.q[:, 1], run.v[:, 0], run.v[:, 1])):
            held = bytes.fromhex(text)
            if model == "exact":
                off = np.frombuffer(held) - right.ravel()
                assert np.abs(off).max() <= 1e-10 * contact.RADIUS, told
            else:
                assert held == right.tobytes(), (model, told)


def test_v8_computes_what_steps_to_the_last_bit_and_exact_to_1e_10_r():
    engine = MiniRacer()
    judge(lambda script: json.loads(engine.eval(f"JSON.stringify({script})")))
    engine.close()


def test_firefox_does_so_too(start):
    judge(start("firefox").new_page().evaluate)


def test_what_has_no_javascript_is_refused_by_its_line(tmp_path):
    file = tmp_path / "steps.py"
    file.write_text("def step(a):\n    x = a // 2\n    return x\n", "utf-8")
    with pytest.raises(ValueError, match=r"steps\.py:2: .*FloorDiv"):
        to_js(["step"], file)
