"""Invariants of contact.py on scenes that hypothesis draws, and shrinks to the simplest that fails."""

import json

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from curriculum.common.files import write_whole
from curriculum.stress import invariants, jobs, under_test

FOLDER = under_test.ROOT / "outputs" / "stress-work" / "cases"
PLACES = st.integers(-16, 16).map(lambda k: k / 16)  # short numbers shrink well


def no_dust(low, high):
    """Floats, with 0 for what is so small that other units would underflow (a case of its own)."""
    return st.floats(low, high).map(lambda value: value if abs(value) > 1e-100 else 0.0)


SPEEDS = st.one_of(st.just(0.0), st.integers(-8, 8).map(lambda k: k / 4), no_dust(-3.0, 3.0))


@st.composite
def specs(draw):
    """A spec (see scenes.py) of one to five balls over the table, touching and overlapping included."""
    n = draw(st.integers(1, 5))

    def some(strategy):
        return [draw(strategy) for _ in range(n)]

    radius = some(st.sampled_from([0.125, 0.1, 0.0625]))
    heights = some(
        st.one_of(st.just(0.0), st.integers(0, 16).map(lambda k: k / 16), no_dust(0.0, 1.0))
    )
    return {
        "x": some(st.one_of(PLACES, no_dust(-1.0, 1.0))),
        "y": [r + h for r, h in zip(radius, heights)],
        "vx": some(SPEEDS),
        "vy": some(SPEEDS),
        "mass": some(st.sampled_from([1.0, 0.25, 10.0])),
        "radius": radius,
        "restitution": draw(st.sampled_from([0.0, 0.5, 1.0])),
        "damping": draw(st.sampled_from([0.0, 80.0])),
        "dt": draw(st.sampled_from([0.002, 0.001, 0.01, 1 / 64])),
        "steps": draw(st.integers(2, 60)),
        "stiffness": draw(st.sampled_from([1e4, 100.0])),
        "baumgarte": draw(st.sampled_from([0.2, 0.0, 1.0])),
        "iters": draw(st.sampled_from([20, 1, 100])),
        "solref": draw(st.sampled_from([None, [0.02, 1.0]])),
    }


@pytest.mark.parametrize("name", invariants.CHECKS)
@settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(spec=specs())
def test_invariant(name, spec):
    found = invariants.outcomes(spec, only=[name])[name]
    if isinstance(found, str):
        path = FOLDER / f"hypothesis-{name}.json"
        write_whole(str(path), json.dumps(jobs.job("scene", name, spec=spec), indent=1) + "\n")
        note(f"python -m curriculum.stress --case {path.relative_to(under_test.ROOT)}")
    assert not isinstance(found, str), found
