"""A model more by the recipe of CONTRIBUTING: a step and a row of MODELS; then all else has it."""

import json
import shutil
import subprocess

import pytest

from curriculum.tests.helpers import ROOT, python

STEP = '''# --- region: sixth ---
def sixth_step(balls, dt, iters):
    """One step [s] that stops at the surface and knows no bounce."""
    contacts = detect_contacts(balls)
    for c in contacts:
        c.target = {target}
    accelerate(balls, dt)
    solve_accelerated(contacts, iters)
    move(balls, dt)
    return contacts


'''
ROW = '    "sixth": Model(sixth_step, ("iters",), 1, ("#666666", "x", "-")),\n'


@pytest.fixture(scope="module")
def course(tmp_path_factory):
    """A copy of the course whose contact.py has the sixth model; of a step that loops can say."""
    folder = tmp_path_factory.mktemp("course")
    names = subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).splitlines()
    for name in names:
        if name.startswith(("contact.py", "curriculum/", "exercises/")) and "/results/" not in name:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


def with_target(course, target):
    """contact.py with the sixth model, whose contacts have this target."""
    text = (ROOT / "contact.py").read_text("utf-8")
    text = text.replace(
        "# --- region: run ---\n", STEP.format(target=target) + "# --- region: run ---\n"
    )
    text = text.replace('    "exact": Model(', f'{ROW}    "exact": Model(')
    (course / "contact.py").write_text(text, "utf-8")


def test_a_sixth_model_is_run_recorded_drawn_compiled_and_on_the_page(course):
    for package in ("rerun", "matplotlib", "numba", "py_mini_racer"):
        pytest.importorskip(package, reason=f"{package} is not installed")
    with_target(course, "c.depth / dt")
    out = course / "out"
    done = python("contact.py", "--smoke", "--scene", "stack", "--plot", "--out", out, cwd=course)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    quality = json.loads((out / "metrics.json").read_text("utf-8"))["quality"]["sixth"]
    assert quality["rests"] and quality["max_penetration_frac"] < 0.01
    assert (out / "contact.rrd").exists() and "sixth" in (out / "contact.svg").read_text("utf-8")
    same = (
        "import contact; from curriculum.compiled import run as fast; "
        "scene = contact.build_scene('pile', 1, 9); "
        "step = contact.step_of('sixth', scene, 0.002, contact.Settings()); "
        "plain = contact.simulate(step, scene, 0.002, 200); "
        "twin = fast.run_model('sixth', scene, 0.002, 200, contact.Settings()); "
        "print(plain.q.tobytes() == twin.q.tobytes(), plain.v.tobytes() == twin.v.tobytes())"
    )
    assert python("-c", same, cwd=course, PYTHONPATH="").stdout == "True True\n"
    engine = "from curriculum.page.bundle import contact_js; print('sixth_step' in contact_js())"
    assert python("-c", engine, cwd=course, PYTHONPATH="").stdout == "True\n"
    words = "-m curriculum.seeds 0:3 --contact sixth --steps 50 --out".split()
    assert "sixth" in python(*words, course / "seeds", cwd=course, PYTHONPATH="").stdout


@pytest.mark.parametrize("target, words", [
    ("max(0.0, *[c.depth / dt])", "*[c.depth / dt]"),
    ("c.depth / dt + 0 * balls.count(c)", "balls.count(c)"),
])  # fmt: skip
def test_a_step_that_no_loop_can_say_runs_plain_and_says_so(course, target, words):
    pytest.importorskip("numba", reason="numba is not installed")
    with_target(course, target)
    flags = "--scene pile --bodies 60 --steps 290 --contact sixth --no-rerun --out".split()
    done = python("contact.py", *flags, course / "plain", cwd=course)
    assert done.returncode == 0 and "sixth" in done.stdout
    assert done.stderr.startswith("sixth runs in plain loops: contact.py:")
    assert f"{words}: no loop can say it; write loops" in done.stderr
