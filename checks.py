"""Checks of the exercises: `pytest checks.py`, or one of them, `pytest checks.py -k ex2`.

What is not done yet is skipped by name; what is wrong fails with input, got, expected and where to
look. The answers are contact.py (imported) and meta.yaml, which also holds the bands.
"""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT / "exercises")]

import contact  # noqa: E402
import ex1_predict_contact as ex1  # noqa: E402
import ex2_completion_contact as ex2  # noqa: E402
import ex3_dt_stability as ex3  # noqa: E402
import predict  # noqa: E402
from curriculum.quoted import Numbers, load_meta  # noqa: E402

FACTS = load_meta()["exercises"]
HINT = "python exercises/ex2_completion_contact.py --hint"


def check_prediction(name, exercise):
    """Skip before a prediction; then measure again, hold the bands, and compare."""
    todo = predict.missing(exercise)
    if todo:
        pytest.skip(f"{name}: {todo}")
    runs = exercise.measure()
    numbers = Numbers(runs=runs)
    for key, (low, high) in FACTS[name]["bands"].items():
        value = numbers.value(key)
        assert low <= value <= high, f"{key} is {value}, outside {low} to {high}"
    for claim in FACTS[name]["holds"]:
        assert numbers.holds(claim), f"{claim} does not hold"
    if exercise.PREDICTION != FACTS[name]["answer"]:
        said = f"{exercise.table(runs)}\n\n{predict.verdict(name, exercise, runs)}"
        pytest.fail(said, pytrace=False)


def test_ex1_prediction():
    check_prediction("ex1", ex1)


def test_ex3_prediction():
    check_prediction("ex3", ex3)


def compare(blank, hint, **inputs):
    """Skip while blank, else hold the learner's function to contact.py's on one input."""
    call = f"{blank}({', '.join(f'{key}={value!r}' for key, value in inputs.items())})"
    got, expected = getattr(ex2, blank)(**inputs), getattr(contact, blank)(**inputs)
    if got is ...:
        pytest.skip(f"ex2: {blank} is still a blank")
    if not equal(got, expected):
        fail(call, got, expected, f"{blank} in exercises/ex2_completion_contact.py, the sign table "
             f"at the top of contact.py, or {HINT} {hint}")


def equal(got, expected):
    """Whether it is a number, and that number but for the last bits."""
    return isinstance(got, (int, float)) and abs(got - expected) <= FACTS["ex2"]["within"]


def fail(call, got, expected, where):
    """Fail with what a learner needs, and no traceback."""
    pytest.fail(f"{call}\n  got       {got!r}\n  expected  {expected!r}\n  where to look: {where}",
                pytrace=False)


@pytest.mark.parametrize("depth, v_n, hint", [
    (0.0, 0.0, 1), (0.01, 0.0, 1), (0.01, -0.5, 1), (0.01, 0.5, 1), (0.0, -1.0, 1),
    (0.0, 1.0, 2), (0.001, 2.0, 2), (0.01, 1.25, 2)])
@pytest.mark.parametrize("damping", [0.0, 80.0])
def test_ex2_penalty_normal_force(depth, v_n, damping, hint):
    compare("penalty_normal_force", hint, depth=depth, v_n=v_n, stiffness=1e4, damping=damping)


@pytest.mark.parametrize("lam, dlam, hint", [
    (0.0, 0.0, 3), (0.0, 0.3, 3), (0.2, 0.3, 3), (0.0, -0.3, 3), (0.2, -0.5, 3),
    (0.2, -0.2, 4), (0.2, -0.1, 4)])
def test_ex2_project_impulse(lam, dlam, hint):
    compare("project_impulse", hint, lam=lam, dlam=dlam)


@pytest.mark.parametrize("v", [(0.0, -1.0), (0.4, -1.0), (5.0, -1.0), (0.0, 0.0), (0.0, 1.0)])
def test_ex2_two_contacts_at_once(v):
    """A ball (0) in the groove of two that nothing moves (1, 2): they share the push."""
    compare("project_impulse", 3, lam=0.1, dlam=0.1)
    groove = [(0, 1, 0.3, 0.91 ** 0.5, 0.0), (0, 2, -0.3, 0.91 ** 0.5, 0.0)]
    problem = ([v[0], 0.0, 0.0], [v[1], 0.0, 0.0]), [1.0, 0.0, 0.0], groove, [0.0, 0.0], 50
    _, expected = contact.solve_contacts(*problem)
    with ex2.yours():
        _, got = contact.solve_contacts(*problem)
    if not all(map(equal, got, expected)):
        fail(f"solve_contacts with your project_impulse (a ball in a groove of two, v = {v})",
             got, expected, f"project_impulse in exercises/ex2_completion_contact.py, or {HINT} 4")
