"""Near pairs, groups of contacts and first roots, each held to the slow way of finding them."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import contact
from curriculum.common import balls, roots

ODD = [math.nan, math.inf, -math.inf, 1e200, -1e200, 1e-200, -0.0]
NUMBER = st.one_of(
    st.integers(-5, 5).map(lambda k: 0.1 * k),  # equal coordinates, exactly touching, coincident
    st.floats(-1.0, 1.0),
    st.sampled_from(ODD),
)
OFFSET = st.sampled_from([0.0, 0.0, 1.0, -37.3, 1e5, -1e9, 1e15])
RADIUS = st.sampled_from([0.1, 0.1, 0.05, 0.3, 0.1 + 1e-16])


@st.composite
def states(draw, most=30):
    """q (2, N), radius (N,) and a margin: balls in a small box, somewhere, some of them nowhere."""
    spots = draw(st.lists(st.tuples(NUMBER, NUMBER, RADIUS), min_size=1, max_size=most))
    x, y, radius = np.array(spots).T
    q = np.array((x + draw(OFFSET), y + draw(OFFSET)))
    return q, radius, draw(st.sampled_from([0.0, 1e-3, 0.5]))


def as_list(state):
    """The contacts of detect_contacts on lists: the all-pairs loop."""
    q, radius, margin = state
    return contact.detect_contacts(q.tolist(), radius.tolist(), margin)


def touching(distance):
    """Two balls of radius 0.1 one above the other at that distance, and a third below them."""
    return np.array(((0.0, 0.0, 0.0), (0.1, 0.3, 0.3 + distance))), np.full(3, 0.1), 0.0


@settings(max_examples=400, deadline=None)
@given(states())
@example(touching(0.2))
@example(touching(np.nextafter(0.2, 0)))
@example((np.zeros((2, 5)), np.full(5, 0.1), 0.0))
def test_contacts_from_cells_are_those_of_all_pairs_in_the_same_order_to_the_bit(state):
    q, radius, margin = state
    with np.errstate(all="ignore"):
        i, j, n, depth = balls.contact_arrays(q, radius, margin)
    got = list(zip(i.tolist(), j.tolist(), *n.tolist(), depth.tolist()))
    assert repr(got) == repr(as_list(state))


@settings(max_examples=100, deadline=None)
@given(states())
def test_groups_hold_the_contacts_of_the_list_each_once_in_order(state):
    """One group a tuple of arrays: whichever form detect_contacts answers in, nothing is lost."""
    q, radius, margin = state
    with np.errstate(all="ignore"):
        i, j, n, depth = balls.contact_arrays(q, radius, margin)
    groups = [
        np.stack((i, j, *n, depth))[:, g] for g in balls.independent_groups(i, j, len(radius))
    ]
    got = np.hstack(groups).T.tolist() if groups else []
    assert sorted(map(repr, got)) == sorted(repr([float(c) for c in row]) for row in as_list(state))
    for group in groups:
        rows = [tuple(column) for column in group[:2].T]
        assert rows == sorted(rows, key=[(float(a), float(b)) for a, b, *_ in as_list(state)].index)


@pytest.mark.parametrize("seed", range(12))
def test_a_ball_at_the_very_reach_is_found_wherever_the_cells_lie(seed):
    """Distances that round to one bit under 2 r: a cell's border may fall anywhere between them."""
    rng = np.random.default_rng(seed)
    y = 0.1 + np.arange(400) * np.nextafter(0.2, 0) * (1.0 + (seed % 3) * 1e-16)
    x = np.zeros(400) + rng.uniform(-1e3, 1e3)
    state = np.array((x, y + rng.uniform(0.0, 0.3))), np.full(400, 0.1), 0.0
    i, j, _, _ = balls.contact_arrays(*state)
    assert list(zip(i.tolist(), j.tolist())) == [row[:2] for row in as_list(state)]


def test_near_pairs_do_not_grow_with_the_square_of_the_balls():
    """A lattice 2.5 r wide has few balls in the cells around a ball, however many there are."""
    for count in (1000, 4000):
        scene = contact.build_scene("pile", bodies=count)
        i, j = balls.near_pairs(*scene.q0, 0.2)
        assert len(i) < 8 * count and (i < j).all()
        assert len(set(zip(i.tolist(), j.tolist()))) == len(i), "a pair is listed twice"


def test_balls_with_one_centre_part_along_y():
    """Published fault: below a distance of 1e-12 there was no contact, so they never parted."""
    ((i, j, nx, ny, depth),) = [c for c in as_list((np.ones((2, 2)), np.full(2, 0.1), 0.0))]
    assert (i, j, nx, ny, depth) == (0, 1, 0.0, 1.0, 0.2)


# Groups

LISTS = st.lists(
    st.tuples(st.integers(0, 9), st.integers(-1, 9)).filter(lambda c: c[0] != c[1]), max_size=60
)


def grouped(contacts, bodies=10):
    i, j = (np.array(column, int) for column in (zip(*contacts) if contacts else ((), ())))
    return balls.independent_groups(i, j, bodies)


@settings(max_examples=300, deadline=None)
@given(LISTS)
def test_groups_share_no_body_and_are_one_more_than_the_largest_earlier_that_does(contacts):
    groups = grouped(contacts)
    number = {int(c): g for g, group in enumerate(groups, 1) for c in group}
    assert sorted(number) == list(range(len(contacts)))
    for group in groups:
        assert list(group) == sorted(group)
        bodies = [b for c in group for b in contacts[c] if b >= 0]
        assert len(bodies) == len(set(bodies))
    for c, pair in enumerate(contacts):
        earlier = [number[e] for e in range(c) if (set(contacts[e]) & set(pair)) - {-1}]
        assert number[c] == 1 + max(earlier, default=0)


def test_floor_contacts_are_one_group_and_a_column_is_a_chain():
    assert len(grouped([(k, -1) for k in range(10)])) == 1
    assert len(grouped([(k, k + 1) for k in range(9)])) == 9
    assert len(grouped([(k, k + 1) for k in range(0, 10, 2)])) == 1
    assert grouped([]) == []


# Roots


def first_fall(*p, horizon=np.inf):
    """One polynomial p0 + p1 t + ... + p4 t^4."""
    p = np.array([*p, *[0.0] * (5 - len(p))])[:, None]
    with np.errstate(all="ignore"):
        return float(roots.first_fall(p, horizon)[0])


@pytest.mark.parametrize(
    "height, speed", [(0.9, 0.0), (0.9, 3.0), (0.9, -3.0), (0.0, 2.0), (1e-9, 1.0)]
)
def test_a_thrown_ball_lands_when_the_quadratic_formula_says(height, speed):
    expected = (speed + math.sqrt(speed * speed + 2 * 9.81 * height)) / 9.81
    assert first_fall(height, speed, -4.905) == pytest.approx(expected, rel=4e-16)


def test_a_ball_that_touches_and_closes_falls_at_once_and_one_that_rests_or_parts_does_not():
    assert first_fall(0.0, -1.0, -4.905) == 0.0
    assert first_fall(0.0, 0.0, 0.0) == math.inf
    assert first_fall(0.0, 1.0, 0.0) == math.inf
    assert first_fall(0.5, 0.0, 0.0) == math.inf


def test_two_balls_that_fly_apart_or_miss_never_touch_and_a_graze_is_told_to_the_bit():
    """d = (-1, b), u = (1, 0), R = 0.2: t^2 - 2 t + 1 + b^2 - R^2 has 1 +- sqrt(R^2 - b^2)."""
    for b in (0.2000001, 0.3):
        assert first_fall(1.0 + b * b - 0.04, -2.0, 1.0) == math.inf
    for b in (0.0, 0.1, 0.19999, 0.1999999):
        expected = 1.0 - math.sqrt(0.04 - b * b)
        assert first_fall(1.0 + b * b - 0.04, -2.0, 1.0) == pytest.approx(expected, abs=1e-12)
    assert first_fall(1.0 - 0.04, 2.0, 1.0) == math.inf
    assert first_fall(1.0, -2.0, 1.0) in (1.0, math.inf)  # exactly grazing: either is an answer


def test_nothing_is_found_after_the_horizon():
    time = math.sqrt(0.9 / 4.905)
    assert first_fall(0.9, 0.0, -4.905, horizon=0.999 * time) == math.inf
    assert first_fall(0.9, 0.0, -4.905, horizon=1.001 * time) == pytest.approx(time, rel=1e-15)


ROOT = st.floats(0.05, 3.0)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(ROOT, min_size=1, max_size=4),
    st.lists(st.tuples(st.floats(-3.0, 3.0), st.floats(0.1, 2.0)), max_size=1),
    st.floats(0.01, 100.0),
)
def test_first_root_of_a_quartic_is_the_least_of_the_roots_it_was_made_of(real, pairs, size):
    """(r1 - t)(r2 - t).. ((t - a)^2 + b^2): the first fall is at the least root, if simple."""
    real = sorted(real)[: 4 - 2 * len(pairs)]
    if any(b - a < 1e-3 for a, b in zip(real, real[1:])):
        return
    p = np.polynomial.Polynomial([size])
    for root in real:
        p = p * np.polynomial.Polynomial([root, -1.0])
    for a, b in pairs:
        p = p * np.polynomial.Polynomial([a * a + b * b, -2.0 * a, 1.0])
    got = first_fall(*p.coef, horizon=4.0)
    blur = 1e-14 * np.abs(p.coef * real[0] ** np.arange(len(p.coef))).sum()
    assert got == pytest.approx(real[0], abs=1e-15 + blur / abs(p.deriv()(real[0])))


def thousandths(low, high):
    return st.integers(1000 * low, 1000 * high).map(lambda k: k / 1000)


@settings(max_examples=200, deadline=None)
@given(st.tuples(*[thousandths(low, 10) for low in (0, -10, -10, -10, 0)]))
def test_no_earlier_fall_is_passed_over_and_the_answer_is_a_root(coef):
    """p4 >= 0: it is a quarter of a relative acceleration, squared."""
    coef = np.array(coef)
    horizon = 3.0
    got = first_fall(*coef, horizon=horizon)
    p = np.polynomial.Polynomial(coef)
    times = np.linspace(0.0, min(got, horizon), 400)
    size = np.polynomial.Polynomial(np.abs(coef))
    assert (p(times) >= -1e-13 * size(times)).all(), f"below zero before {got}"
    if got < math.inf:
        assert 0.0 <= got <= horizon and abs(p(got)) <= 1e-13 * size(got)
        assert p.deriv()(got) <= 1e-6 * size(got)


def test_columns_do_not_disturb_each_other():
    """Each polynomial has its answer to the bit, whichever others are asked beside it."""
    rng = np.random.default_rng(5)
    p = rng.uniform(-1.0, 1.0, (5, 200))
    p[0] = np.abs(p[0])
    with np.errstate(all="ignore"):
        together = roots.first_fall(p, 3.0)
        alone = [roots.first_fall(p[:, k : k + 1], 3.0)[0] for k in range(200)]
    assert together.tolist() == alone
    assert np.isfinite(together).sum() > 50 < np.isinf(together).sum()
