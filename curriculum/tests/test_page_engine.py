"""The page's engine against contact.py, in the V8 that also draws the page's stills: no browser."""

import json
import math
import random
import re

import numpy as np
import pytest

pytest.importorskip(
    "py_mini_racer", reason="the page's libraries are missing: pip install -e '.[page]'"
)

import contact  # noqa: E402
from curriculum import exact  # noqa: E402
from curriculum.page.still import HERE, engine  # noqa: E402

RUN = """
const sceneOf = (c) => {
  const same = (value) => c.y.map(() => value);
  const mass = c.mass ? c.mass.map((m) => m ?? Infinity) : same(1);
  return { x: c.x, y: c.y, vx: same(0), vy: same(0), mass, radius: same(0.1), restitution: c.restitution,
           damping: c.damping };
};
const arrays = (run) => [run.x, run.y, run.vx, run.vy].map((a) => a.buffer);
const runCase = (c, model) => arrays(ContactEngine.runModel(model, sceneOf(c), c, c.steps));
const qualities = (c) => {
  const runs = ContactEngine.MODELS.map((m) => ContactEngine.runModel(m, sceneOf(c), c, c.steps));
  const told = runs.map((run) => ContactEngine.quality(run, sceneOf(c), runs[3]));
  return JSON.stringify(Object.fromEntries(ContactEngine.MODELS.map((m, k) => [m, told[k]])));
};
"""


@pytest.fixture(scope="module")
def v8():
    v8 = engine(scripts=("exact.js", "engine.js", "plot.js"))
    v8.eval(RUN)
    return v8


def cases():
    """(scene, case): every scene on the dt grid with its own knobs, then random knobs and piles."""
    pick = random.Random(35)
    own = dict(stiffness=1e4, iters=20, baumgarte=0.2, seed=0)
    for name in ("drop", "bounce", "stack"):
        for factor in contact.DT_GRID:
            yield name, dict(own, dt=0.002 * factor, steps=1000, restitution=None, damping=None)
    for name in ("drop", "bounce", "stack", "pile") * 6:
        yield (
            name,
            dict(
                seed=pick.randrange(100),
                steps=300,
                dt=10 ** pick.uniform(-3.3, -1.2),
                stiffness=10 ** pick.uniform(2, 6),
                damping=pick.choice((0.0, pick.uniform(0, 300))),
                restitution=pick.choice((0.0, 1.0, pick.random())),
                iters=pick.randint(1, 60),
                baumgarte=pick.choice((0.0, 1.0, pick.random())),
                solref=pick.choice(
                    (
                        None,
                        (pick.uniform(0.002, 0.1), pick.uniform(0.2, 2.0)),
                        (-pick.uniform(0, 1e4), -pick.uniform(0, 400)),
                    )
                ),
                solimp=pick.choice(
                    (
                        None,
                        (
                            pick.random(),
                            pick.random(),
                            10 ** pick.uniform(-4, -1),
                            pick.random(),
                            float(pick.randint(1, 5)),
                        ),
                    )
                ),
            ),
        )


def built(name, case):
    """The scene of a case, and the case as the page's engine takes it."""
    scene = contact.build_scene(
        name, case["seed"], 6 if name == "pile" else None, case["restitution"], case["damping"]
    )
    told = {key: value for key, value in case.items() if value is not None}
    return scene, told | dict(
        x=scene.q0[0].tolist(),
        y=scene.q0[1].tolist(),
        restitution=scene.restitution,
        damping=scene.damping,
    )


def same_bits(mine, theirs):
    """Whether two arrays hold the same bits; the bits of a NaN mean nothing."""
    theirs = np.ascontiguousarray(theirs)
    return (
        (mine.view(np.uint64) == theirs.view(np.uint64)) | (np.isnan(mine) & np.isnan(theirs))
    ).all()


def columns(run):
    return run.q[:, 0], run.q[:, 1], run.v[:, 0], run.v[:, 1]


def test_penalty_lcp_and_soft_have_the_bits_of_contact_py(v8):
    compared = 0
    for name, case in cases():
        scene, told = built(name, case)
        for model in ("penalty", "lcp", "soft"):
            run = contact.run_model(
                model,
                scene,
                case["dt"],
                case["steps"],
                case["stiffness"],
                case["baumgarte"],
                case["iters"],
                solref=case.get("solref"),
                solimp=case.get("solimp"),
            )
            got = list(v8.eval(f"runCase({json.dumps(told)}, {json.dumps(model)})"))
            for mine, theirs in zip(got, columns(run)):
                mine = np.frombuffer(mine).reshape(theirs.shape)
                assert same_bits(mine, theirs), (model, name, case)
                compared += 1
    assert compared == 4 * 3 * 42


def test_exact_agrees_on_columns_and_on_a_ball_that_slides_off_a_ball(v8):
    scenes = [
        contact.build_scene(name, seed, None, e)
        for name in ("drop", "bounce", "stack")
        for seed, e in ((0, None), (3, 0.5), (4, 1.0))
    ]
    for angle in (0.05, 0.2, 0.35, 0.6):
        q0 = np.array([[0.0, 0.2 * math.sin(angle)], [5.0, 5.0 + 0.2 * math.cos(angle)]])
        scenes.append(
            contact.Scene(
                "slide", q0, np.zeros((2, 2)), np.array([math.inf, 1.0]), np.full(2, 0.1), 0.0, 0.0
            )
        )
    for scene in scenes:
        for dt in (0.0005, 0.016):
            steps = min(500, int((0.9 if scene.name == "slide" else 4.0) / dt))
            times = np.arange(steps + 1) * dt
            q, v = exact.simulate_exact(scene, times, contact.GRAVITY)
            case = dict(
                x=scene.q0[0].tolist(),
                y=scene.q0[1].tolist(),
                dt=dt,
                steps=steps,
                damping=0,
                mass=[m if math.isfinite(m) else None for m in scene.mass.tolist()],
                restitution=scene.restitution,
            )
            got = list(v8.eval(f"runCase({json.dumps(case)}, 'exact')"))
            for mine, theirs in zip(got[:2], (q[:, 0], q[:, 1])):
                error = np.abs(np.frombuffer(mine).reshape(theirs.shape) - theirs).max()
                assert error <= 1e-10 * 0.1, (scene.name, dt, error)


def test_a_ball_leaves_a_ball_that_is_held_at_two_thirds_of_the_height(v8):
    """cos(theta) = 2/3 cos(theta0), from energy and the balance of forces."""
    for angle in (0.1, 0.35, 0.8):
        case = dict(
            x=[0, 0.2 * math.sin(angle)],
            y=[5, 5 + 0.2 * math.cos(angle)],
            mass=[None, 1],
            dt=1e-5,
            steps=120_000,
            restitution=0,
            damping=0,
        )
        x, y = (
            np.frombuffer(a).reshape(-1, 2)
            for a in list(v8.eval(f"runCase({json.dumps(case)}, 'exact')"))[:2]
        )
        held = np.hypot(x[:, 1], y[:, 1] - 5) <= 0.2 * (1 + 1e-12)
        last = int(np.flatnonzero(held)[-1])
        # within one sample, over which the angle changes by at most dt v / (2 r)
        speed = math.sqrt(2 * 9.81 * 0.2)
        found = math.atan2(x[last, 1], y[last, 1] - 5)
        assert found == pytest.approx(math.acos(2 / 3 * math.cos(angle)), abs=2e-5 * speed / 0.2)


def test_the_measures_are_those_of_contact_quality(v8):
    for name, dt in (("drop", 0.002), ("bounce", 0.004), ("stack", 0.002), ("drop", 0.03)):
        scene, told = built(
            name,
            dict(
                seed=0,
                restitution=None,
                damping=None,
                dt=dt,
                steps=800,
                stiffness=1e4,
                iters=20,
                baumgarte=0.2,
            ),
        )
        found = json.loads(v8.eval(f"qualities({json.dumps(told)})"))
        reference = contact.run_model("exact", scene, dt, 800)
        for model in contact.MODELS:
            run = contact.run_model(model, scene, dt, 800)
            for key, value in contact.contact_quality(run, scene, dt, reference).items():
                wanted = (
                    pytest.approx(value, rel=1e-9, abs=1e-10) if isinstance(value, float) else value
                )
                assert found[model][key] == wanted, (name, model, key)


def test_the_critical_step_is_that_of_contact_py(v8):
    assert v8.eval("ContactEngine.criticalDt(1, 1e4, 80).damped") == contact.critical_dt(
        1.0, 1e4, 80.0
    )


def test_numbers_are_written_for_readers(v8):
    shown = json.loads(
        v8.eval(
            "JSON.stringify([0.00981, 1409.2, 98100, 4e-14, 2.5e-5, -0.25, NaN, Infinity]"
            ".map((v) => Plot.number(v)))"
        )
    )
    assert shown == ["0.00981", "1,409", "98,100", "0", "2.50e−5", "−0.250", "not a number", "∞"]


# ---- what a reader types


@pytest.fixture(scope="module")
def arithmetic():
    v8 = engine(scripts=("arithmetic.js",))
    v8.eval("""const tried = (text, inputs) => {
      try { return JSON.stringify([Arithmetic.parse(text, Object.keys(inputs))(inputs)]); }
      catch (error) { return JSON.stringify({ said: error.message }); }
    };""")
    return lambda text, **inputs: json.loads(
        v8.eval(f"tried({json.dumps(text)}, {json.dumps(inputs)})")
    )


@pytest.mark.parametrize(
    "text",
    [
        "1 + 2 * 3",
        "(1 + 2) * 3",
        "-a - -b",
        "a - b - 1",
        "8 / 2 / 2",
        "max(0, a - b)",
        "min(a, b, -3)",
        "max(0.0, 1e4 * a - 80 * b)",
        "+a",
        "2 * (a + max(b, 1)) / .5",
    ],
)
def test_arithmetic_is_pythons(arithmetic, text):
    inputs = {"a": 1.25, "b": -0.5}
    assert arithmetic(text, **inputs) == [eval(text, {"max": max, "min": min}, inputs)]


@pytest.mark.parametrize(
    "text, said",
    [
        ("", "empty"),
        ("1 +", "missing"),
        ("(1", "a ) is missing"),
        ("c + 1", "c is not known"),
        ("max(1)", "two or more"),
        ("a b", "does not belong"),
        ("constructor", "not known"),
        ("a.b", "does not belong"),
        ("alert(1)", "not known"),
        ("a = 1", "does not belong"),
        ("a" * 300, "longer than 200"),
        ("max", "a ( is missing"),
        ("2 ** 3", "missing"),
    ],
)
def test_what_is_no_arithmetic_is_refused_in_words(arithmetic, text, said):
    assert said in arithmetic(text, a=1.0)["said"]


# ---- the sources


def functions_of(text):
    """(first line, length) of every function that begins and ends on lines of its own."""
    lines = text.split("\n")
    for start, line in enumerate(lines):
        opened = re.match(
            r"( *)(?:async )?(?:function \w+\(|(?:const|let) \w+ = .*=> [({\[]$|const \w+ = \(.*\) => \{)",
            line,
        )
        if opened:
            end = next(
                k
                for k in range(start + 1, len(lines))
                if re.match(rf"{opened[1]}[)}}\]]", lines[k])
            )
            yield start + 1, end - start + 1


def test_every_script_can_be_read():
    v8 = engine(scripts=())
    for path in sorted(HERE.glob("*.js")):
        v8.eval(f"new Function({json.dumps(path.read_text('utf-8'))})")


def test_no_function_is_longer_than_sixty_lines():
    seen = 0
    for path in sorted(HERE.glob("*.js")):
        for first, length in functions_of(path.read_text("utf-8")):
            inside_module = not re.match(
                r"const \w+ = \(\(\) =>", path.read_text("utf-8").split("\n")[first - 1]
            )
            assert not inside_module or length <= 60, f"{path.name}:{first}: {length} lines"
            seen += inside_module
    assert seen > 150
