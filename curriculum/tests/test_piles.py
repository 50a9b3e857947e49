"""The compiled twin of contact.py gives the bytes of the plain reference, and is really taken."""

import itertools
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import contact

numba = pytest.importorskip("numba", reason="numba is not installed: the extra `fast`")
piles = pytest.importorskip(
    "curriculum.piles", reason="numba is not installed: the extra `fast`", exc_type=ImportError
)
ROOT = Path(__file__).resolve().parents[2]
MODELS = ("penalty", "lcp", "soft")
WILD = (math.nan, math.inf, -math.inf, 1e200, -1e308, 1e-200, -0.0)


def examples(count):
    """So many examples where the loops are compiled, a fifth of it where they are not."""
    return count // 5 if numba.config.DISABLE_JIT else count


def reference(*arguments, **knobs):
    """The run by contact.py's own steps, none left out, looking at every pair."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact, "FEW", 10**9)
        patch.setattr(contact, "MOST_SWEEPS", 60)
        return contact.run_model(*arguments, skip=False, **knobs)


def compiled(*arguments, **knobs):
    """The run by the twin, whatever the number of balls."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact, "FEW", 0)
        patch.setattr(contact, "MOST_SWEEPS", 60)
        return contact.run_model(*arguments, **knobs)


def check_same(model, scene, dt, steps, **knobs):
    """Both give the same bytes, or both stop at the same error. Returns the run."""
    runs = []
    for way in (reference, compiled):
        try:
            runs.append(way(model, scene, dt, steps, **knobs))
        except ArithmeticError as error:
            runs.append(type(error))
    plain, fast = runs
    if isinstance(plain, type) or isinstance(fast, type):
        assert plain is fast
        return None
    for name in ("q", "v"):
        one, other = getattr(plain, name), getattr(fast, name)
        differ = (one.view(np.int64) != other.view(np.int64)).any((1, 2))
        assert not differ.any(), f"{name} of {model} first differs at step {differ.argmax()}"
    assert fast.t.tobytes() == plain.t.tobytes()
    return fast


# Scenes of every kind

PLACE = st.one_of(st.integers(-6, 6).map(lambda k: 0.1 * k), st.floats(-0.7, 0.7))
SPEED = st.one_of(st.just(0.0), st.floats(-5.0, 5.0))
MASS = st.one_of(
    st.just(1.0), st.floats(-6.0, 6.0).map(lambda power: 10.0**power), st.just(math.inf)
)
RADIUS = st.sampled_from((0.1, 0.1, 0.1, 0.05, 0.3, 0.0123, 2.0))
OFFSET = st.sampled_from((0.0, 0.0, 0.0, 1e5, -1e9, 1e15))


@st.composite
def scenes(draw):
    """1 to 60 balls in a small box, so that many touch; some are placed or thrown anywhere."""
    count = draw(st.one_of(st.integers(1, 6), st.integers(1, 60)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    few = min(count, 8)
    columns = [
        st.lists(kind, min_size=few, max_size=few)
        for kind in (PLACE, PLACE, SPEED, SPEED, MASS, RADIUS)
    ]
    x, y, vx, vy, mass, radius = (
        np.resize(np.array(draw(column), float), count) for column in columns
    )
    side = 0.1 * math.sqrt(count)
    q0 = np.array((x, abs(y))) + (rng.uniform(-side, side, (2, count)) if count > few else 0.0)
    v0 = np.array((vx, vy))
    if draw(st.integers(0, 3)) == 0:
        state = draw(st.sampled_from((q0, v0)))
        state[draw(st.integers(0, 1)), draw(st.integers(0, count - 1))] = draw(
            st.sampled_from(WILD)
        )
    q0[0] += draw(OFFSET)
    e = draw(st.sampled_from((0.0, 0.0, 0.5, 1.0)))
    return contact.Scene("drawn", q0, v0, mass, radius, e, draw(st.sampled_from((0.0, 80.0))))


@settings(
    max_examples=examples(100),
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
@given(
    scene=scenes(),
    model=st.sampled_from(MODELS),
    dt=st.sampled_from((0.002, 0.002, 1e-4, 0.03, 1e154)),
    stiffness=st.sampled_from((1e4, 0.0, 1e300)),
    baumgarte=st.floats(0.0, 1.0),
    iters=st.integers(1, 20),
)
def test_the_twin_has_the_bytes_of_the_reference(scene, model, dt, stiffness, baumgarte, iters):
    check_same(model, scene, dt, 25, stiffness=stiffness, baumgarte=baumgarte, iters=iters)


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_has_the_bytes_of_the_reference_on_the_scenes_of_the_book(model):
    """Long enough that every ball comes to rest, or bounces on."""
    for name in ("drop", "bounce", "stack"):
        check_same(model, contact.build_scene(name, 3), 0.002, 1200)
    check_same(model, contact.build_scene("pile", 1, 40, restitution=0.4), 0.004, 150)


def handful(seed):
    """Five balls of mixed size and mass near the floor, all touching something; the last is held."""
    rng = np.random.default_rng(seed)
    radius = np.array((0.1, 0.05, 0.1, 0.3, 0.1))
    q0 = np.array(((0.0, 0.14, 0.2, 0.5, 0.05), (0.099, 0.05, 0.27, 0.31, 0.26)))
    q0 += rng.uniform(-0.004, 0.004, q0.shape)
    mass = np.array((1.0, 0.01, 30.0, 2.0, math.inf))
    v0 = rng.normal(size=(2, 5))
    return contact.Scene("handful", q0, v0, mass, radius, rng.choice((0.0, 0.5)), 80.0)


@pytest.mark.parametrize(
    "knobs",
    [
        {},
        {"solref": (0.05, 0.3), "solimp": (0.2, 0.9, 0.03, 0.7, 1.5), "baumgarte": 1.0},
        {"solref": (-3000.0, -100.0), "solimp": (0.5, 0.8, 0.0, 0.5, 2.0), "iters": 1},
        {"solref": (0.0, -400.0), "solimp": (0.9, 0.3, 0.003, 0.2, 3.0), "stiffness": 70.0},
    ],
)
@pytest.mark.parametrize("model", MODELS)
def test_a_handful_of_unequal_balls_has_the_bytes_of_the_reference(model, knobs):
    for seed in range(3):
        scene = handful(seed)
        assert len(contact.detect_contacts(contact.make_balls(scene))) >= 5
        check_same(model, scene, 0.002, 6, **knobs)


def crowd(count, seed):
    """Balls packed closely in rows of 20 and numbered at random: nearly all neighbours overlap."""
    rng = np.random.default_rng(seed)
    place = rng.permutation(count)
    q0 = np.array((0.196 * (place % 20), 0.097 + 0.196 * (place // 20)))
    q0 += rng.uniform(-0.003, 0.003, q0.shape)
    return contact.Scene(
        "crowd",
        q0,
        rng.normal(size=(2, count)),
        10.0 ** rng.uniform(-3, 3, count),
        np.full(count, 0.1),
        0.4,
        80.0,
    )


@pytest.mark.parametrize("model", MODELS)
def test_the_twin_has_the_bytes_of_the_reference_in_a_crowd(model):
    scene = crowd(300, 4)
    assert len(contact.detect_contacts(contact.make_balls(scene))) > 500
    check_same(model, scene, 0.002, 4)


# Function by function, at the edges that a run seldom meets


def test_the_larger_of_two_is_pythons_max_to_the_sign_of_zero():
    values = (0.0, -0.0, 1.0, -math.inf, math.nan)
    for first, second in itertools.product(values, values):
        assert repr(piles.larger(first, second)) == repr(max(first, second))


def test_targets_have_the_bits_of_the_reference_on_every_edge():
    """dt is 1/2 s: the ball just meets the floor in the step, or just not; the bias is just 0."""
    dt = 0.5
    near = [np.nextafter(-0.5, end) for end in (-1.0, 0.0)]
    for depth, v_n, e, beta in itertools.product(
        (-0.5, *near, -0.25, -0.0, 0.0, 0.25),
        (-1.0, 0.0, 0.5, 1.0),
        (0.0, 0.5, 1.0),
        (0.0, 0.2, 1.0),
    ):
        ball = contact.Ball(0.0, 0.0, 0.0, v_n, 1.0, 0.1)
        above = contact.Contact(ball, contact.FLOOR, 0.0, 1.0, depth)
        expected = contact.contact_target(above, e, beta, dt)
        assert repr(float(piles.contact_target(depth, v_n, e, beta, dt))) == repr(float(expected))


@pytest.mark.parametrize("mid, power", [(0.45, 2.0), (0.65, 3.0), (0.79, 2.5)])
def test_the_impedance_has_the_bits_of_the_reference_where_its_parts_meet(mid, power):
    """At mid the two powers agree but for rounding, at the width the end is d1 itself."""
    d0, d1 = 0.3, 0.9  # d0 + (d1 - d0) is not d1, to the last bit
    for width in (0.125, 1e-15, 1.05e-15):
        for depth in (0.0, 0.5 * width, mid * width, np.nextafter(width, 0.0), width):
            solimp = (d0, d1, width, mid, power)
            assert piles.impedance(depth, solimp) == contact.impedance(depth, solimp)
    assert contact.impedance(0.125, (d0, d1, 0.125, mid, power)) == d1


def test_a_contact_of_two_held_balls_moves_nothing():
    """Its effective mass is 0, as in the reference, and so is its impulse, however they close."""
    balls = piles.make_balls(np.zeros((4, 3)), np.array((math.inf, math.inf, 4.0)), np.ones(3))
    contacts = np.zeros(2, piles.CONTACT)
    piles.set_contact(contacts[0], balls, 0, 1, 0.0, 1.0, 0.5)
    piles.set_contact(contacts[1], balls, 2, 0, 0.0, 1.0, 0.5)
    held = contact.Ball(0.0, 0.0, 0.0, 0.0, math.inf, 1.0)
    assert contact.Contact(held, contact.FLOOR, 0.0, 1.0, 0.5).m_eff == 0.0
    assert contacts["m_eff"].tolist() == [0.0, 4.0]
    contacts["target"] = 1.0
    piles.solve_contacts(balls, contacts, 5, 0.0)
    assert contacts["lam"].tolist() == [0.0, 4.0] and balls["vy"].tolist() == [0.0, 0.0, 1.0, 0.0]


@pytest.mark.parametrize("sweeps", [1, 2, 3, 10])
def test_corrections_of_exactly_the_tolerance_end_the_sweeps_of_the_twin(sweeps):
    """Two balls of 1 kg, one on the other, shall leave the floor at 1 m/s, as in test_lcp."""
    balls = piles.make_balls(np.zeros((4, 2)), np.ones(2), np.full(2, 0.1))
    contacts = np.zeros(2, piles.CONTACT)
    piles.set_contact(contacts[0], balls, 0, 2, 0.0, 1.0, 0.0)
    piles.set_contact(contacts[1], balls, 1, 0, 0.0, 1.0, 0.0)
    contacts["target"][0] = 1.0
    piles.solve_contacts(balls, contacts, 1000, 2.0 ** (1 - sweeps))
    share = 1.0 - 2.0**-sweeps
    assert contacts["lam"].tolist() == [2.0 * share, share]


@pytest.mark.parametrize("power", [1.0, 2.0, 2.5, 3.7, 6.0])
def test_powers_of_the_impedance_have_the_bits_of_python(power):
    """numba and Python may take x**p from different places."""
    rng = np.random.default_rng(1)
    for x in rng.uniform(0.0, 1.0, 300).tolist():
        solimp = (0.3, 0.95, 1.0, 0.37, power)
        assert piles.impedance(x, solimp) == contact.impedance(x, solimp)


def test_a_state_that_comes_back_ends_the_steps_and_changes_no_bit():
    """After 838 steps the drop rests: a long run costs no more than a short one, and ends alike."""
    scene = contact.build_scene("drop")
    ask = (contact.GRAVITY, contact.CONTACT_MARGIN, 1e4, 0.2, 20, 60, 0.0, (0.0, 0.0), (0.9,) * 5)
    heard = []
    q, v = piles.simulate("penalty", scene, 0.002, 500_000, heard.append, *ask)
    assert heard == [500_000]
    plain = contact.run_model("penalty", scene, 0.002, 2000, skip=False)
    assert q[:2001].tobytes() == plain.q.tobytes()
    assert (q[2000:] == q[2000]).all() and (v[2000:] == v[2000]).all()


def test_what_is_not_a_number_has_one_sign():
    """The sign that a processor gives inf - inf is its own affair, and is not recorded."""
    scene = contact.build_scene("pile", 0, 13)
    scene.q0[0, 4], scene.v0[0, 4] = math.inf, -math.inf  # whose sum is not a number
    scene.q0[0, 5] = math.copysign(math.nan, -1.0)
    for model in MODELS:
        run = check_same(model, scene, 0.002, 4)
        bits = run.q[np.isnan(run.q)].view(np.uint64)
        assert len(bits) == 9 and (bits == np.array(math.nan).view(np.uint64)).all()


@pytest.mark.parametrize("model", MODELS)
def test_a_zero_has_one_sign(model):
    """x and vx of a ball that is dropped stay -0.0 in the steps, and are recorded as 0.0."""
    scene = contact.build_scene("drop")
    scene.q0[0] = scene.v0[0] = -0.0
    run = check_same(model, scene, 0.002, 20)
    assert not np.signbit(run.q).any() and not np.signbit(run.v[:, 0]).any()


def test_a_radius_that_is_no_number_hides_no_other_contact():
    """Neither from the cells nor from the sorted shadows of contact.py."""
    for place in (0, 7):
        scene = crowd(30, 2)
        scene.radius[place] = math.nan
        run = check_same("lcp", scene, 0.002, 3)
        sorted_shadows = contact.run_model("lcp", scene, 0.002, 3, skip=False)
        assert sorted_shadows.q.tobytes() == run.q.tobytes()
        assert contact.max_penetration(run.q[:, :, place + 1 :], scene.radius[place + 1 :])[0] > 0


def test_balls_exactly_in_touch_are_no_contact_of_penalty_yet():
    """A depth of exactly 0: a damper that closed would push, and the spring begins behind it."""
    q0 = np.array(((0.0, 0.25, 0.25), (0.125, 0.125, 0.375)))
    v0 = np.array(((1.0, -1.0, 0.0), (-1.0, -1.0, -2.0)))
    scene = contact.Scene("touch", q0, v0, np.ones(3), np.full(3, 0.125), 0.5, 80.0)
    for model in MODELS:
        check_same(model, scene, 0.002, 20)
    run = compiled("penalty", scene, 0.002, 1)
    assert run.v[1].tolist() == [v0[0].tolist(), (v0[1] - 0.002 * 9.81).tolist()]


@pytest.mark.parametrize("model", MODELS)
def test_two_balls_that_were_out_of_reach_meet_in_the_next_step(model):
    """Pairs are listed as far as 0.101 m. Each ball moves 0.0545 m a step, and they overlap.

    The balls before them rest on the floor, so that only the last one or two have moved.
    """
    for fast in ((27.25, -27.25), (0.0, -54.5)):
        q0 = np.array(((-1.0, -2.0, 0.0, 0.3015), (0.1, 0.1, 1.0, 1.0)))
        v0 = np.array(((0.0, 0.0, *fast), np.zeros(4)))
        scene = contact.Scene("meet", q0, v0, np.ones(4), np.full(4, 0.1), 0.5, 80.0)
        run = check_same(model, scene, 0.002, 4)
        assert np.abs(run.v[4, 0, 2:] - fast).max() > 1.0  # they have pushed each other


@pytest.mark.parametrize("model", MODELS)
def test_points_have_the_bytes_of_the_reference(model):
    """Their radius is 0: a list of pairs reaches no farther than it must."""
    q0 = np.array(((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0005, -0.001)))
    scene = contact.Scene("points", q0, np.zeros((2, 4)), np.ones(4), np.zeros(4), 0.5, 80.0)
    check_same(model, scene, 0.002, 10)


def test_a_run_that_rests_from_its_first_step_keeps_its_start():
    """The states from 1 on are one and the same; the one before them is another."""
    scene = contact.build_scene("drop")._replace(q0=np.array([[0.0], [0.1]]))
    scene.v0[1] = -1.0
    run = check_same("lcp", scene, 0.002, 8, baumgarte=0.0)
    assert run.v[0, 1, 0] == -1.0 and (run.q[1:] == run.q[1]).all()


@pytest.mark.parametrize("model", MODELS)
def test_balls_with_one_centre_part_upwards(model):
    q0 = np.array(((0.3, 0.3, 0.3), (0.5, 0.5, 0.5)))
    scene = contact.Scene("one", q0, np.zeros((2, 3)), np.ones(3), np.full(3, 0.1), 0.0, 80.0)
    run = check_same(model, scene, 0.002, 5)
    assert run.q[-1, 1, 0] > run.q[-1, 1, 2] and (run.q[:, 0] == 0.3).all()


def test_an_impulse_that_overflows_does_not_move_the_floor():
    """Half of infinity is infinity, and 0 times it is no number; the ball beside is at rest."""
    q0, v0 = np.array(((0.0, 5.0), (0.1, 0.1))), np.array(((0.0, 0.0), (-1e300, 0.0)))
    scene = contact.Scene("far", q0, v0, np.array((1e20, 1.0)), np.full(2, 0.1), 0.0, 80.0)
    run = check_same("lcp", scene, 0.002, 3)
    assert not np.isfinite(run.v[-1, 1, 0]) and run.v[-1, 1, 1] == 0.0


# Near balls


def all_pairs(scene, reach):
    """The pairs whose gap is at most `reach`, found by looking at all."""
    (x, y), r = scene.q0.tolist(), scene.radius.tolist()
    count = len(r)
    return [
        (i, j)
        for i in range(count)
        for j in range(i + 1, count)
        if math.sqrt((x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2) - (r[i] + r[j]) <= reach
    ]


def tabled(scene):
    """The scene's balls as rows of the twin's table."""
    return piles.make_balls(np.vstack((scene.q0, scene.v0)), scene.mass, scene.radius)


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(scenes(), st.sampled_from((0.0, 1e-3, 0.5)))
def test_cells_find_every_near_pair_once_and_in_order(scene, reach):
    q0 = np.where(np.abs(scene.q0) > 1e100, math.nan, scene.q0)  # whose squares overflow above
    scene = scene._replace(q0=q0)
    pairs = list(zip(*piles.list_pairs(tabled(scene), reach).tolist()))
    assert pairs == sorted(set(pairs)) and all(i < j for i, j in pairs)
    assert set(pairs) >= set(all_pairs(scene, reach))
    assert set(pairs) <= set(all_pairs(scene, 1.01 * (reach + scene.radius.max())))


@pytest.mark.parametrize("seed", range(5))
def test_cells_of_equal_balls_miss_no_pair_across_their_borders(seed):
    """Each cell is hardly wider than a pair can be apart, so a narrower one would miss some."""
    rng = np.random.default_rng(seed)
    scene = crowd(300, seed)._replace(q0=rng.uniform(0.0, 3.0, (2, 300)))
    for reach in (0.0, 0.07):
        pairs = set(zip(*piles.list_pairs(tabled(scene), reach).tolist()))
        assert pairs == set(all_pairs(scene, reach)) and len(pairs) > 500


def test_balls_that_just_touch_are_near_to_the_last_bit():
    """Twenty-five in a square, 1/4 m apart, of 1/8 m: all gaps are 0 exactly."""
    places = np.arange(25)
    scene = crowd(25, 0)._replace(q0=0.25 * np.array((places % 5, places // 5)))
    scene.radius[:] = 0.125
    pairs = list(zip(*piles.list_pairs(tabled(scene), 0.0).tolist()))
    assert pairs == all_pairs(scene, 0.0) and len(pairs) == 2 * 4 * 5


def test_the_farthest_move_is_counted_from_where_the_pairs_were_listed():
    balls = tabled(crowd(3, 0))
    piles.list_pairs(balls, 0.1)
    assert piles.farthest_move(balls) == 0.0
    for i in range(3):
        balls["x"][i] += 0.3 * (i + 1)
        balls["y"][i] -= 0.4 * (i + 1)
        assert piles.farthest_move(balls) == pytest.approx(0.5 * (i + 1), rel=1e-12)
    balls["x"][1] = math.nan
    assert piles.farthest_move(balls) == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize("large", [0, 19])
def test_a_large_ball_among_small_ones_is_found_by_all_of_them(large):
    rng = np.random.default_rng(5)
    scene = crowd(20, 0)._replace(q0=rng.uniform(0.0, 5.0, (2, 20)))
    scene.radius[large] = 2.0
    pairs = set(zip(*piles.list_pairs(tabled(scene), 0.0).tolist()))
    assert pairs == set(all_pairs(scene, 0.0)) and len(pairs) > 3


@pytest.mark.parametrize("far", [-1e300, 1e300, -1e17, 1e17])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_ball_as_far_away_as_floats_go_hides_no_pair(axis, far):
    scene = crowd(40, 1)
    near = set(all_pairs(scene, 0.0))
    scene.q0[axis, 7] = far
    pairs = set(zip(*piles.list_pairs(tabled(scene), 0.0).tolist()))
    assert pairs == {pair for pair in near if 7 not in pair} and len(pairs) > 30


def test_no_pair_is_missed_where_the_cells_end():
    """From 2^44 cells of 1.02 (2 r + reach) on, all are one: floats are hardly finer there."""
    beyond = (2.0**44, 2.0**44 + 9.0, 1e15, 1e300, math.inf, math.nan)
    assert {piles.cell_at(place, 1.0) for place in beyond} == {2**44}
    assert piles.cell_at(2.0**44 - 1.0, 1.0) == 2**44 - 1
    rng = np.random.default_rng(3)
    end = 2.0**44 * 1.02 * 0.25
    for axis in (0, 1):
        q0 = rng.uniform(0.0, 0.5, (2, 20))
        q0[axis] = end + rng.uniform(-0.6, 0.6, 20)
        q0[:, 0] = 0.0  # cells are counted from here
        scene = crowd(20, 0)._replace(q0=q0)
        found = set(zip(*piles.list_pairs(tabled(scene), 0.05).tolist()))
        assert found == set(all_pairs(scene, 0.05)) and len(found) > 20


def test_the_list_of_pairs_does_not_grow_with_the_square_of_the_balls():
    for count in (1000, 4000):
        pairs = piles.list_pairs(tabled(contact.build_scene("pile", bodies=count)), 0.1)
        assert pairs.shape[1] < 4 * count


def test_many_balls_in_one_place_fit():
    """Far more contacts than a ball can have neighbours: the tables grow."""
    scene = crowd(150, 0)._replace(q0=np.full((2, 150), 0.3))
    assert piles.list_pairs(tabled(scene), 0.0).shape == (2, 150 * 149 // 2)
    check_same("lcp", scene, 0.002, 3, iters=3)


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(scenes(), st.floats(1e-3, 0.5))
def test_the_smallest_gap_has_the_bits_of_the_reference(scene, dt):
    """Of balls that fly apart, so that pairs are listed anew, or stay."""
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        patch.setattr(contact, "FEW", 10**9)
        q = scene.q0 + np.arange(12)[:, None, None] * dt * scene.v0
        plain = contact.smallest_gap(q, scene.radius)
    assert repr(piles.smallest_gap(q, scene.radius).tolist()) == repr(plain.tolist())


def gaps_of(states, radius):
    """The smallest gap [m] of each state by the twin and by the reference, which are the same."""
    q, radius = np.array(states, float), np.array(radius, float)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact, "FEW", 10**9)
        plain = contact.smallest_gap(q, radius)
    assert repr(piles.smallest_gap(q, radius).tolist()) == repr(plain.tolist())
    return plain


def test_a_pair_just_out_of_reach_can_be_nearer_than_the_floor():
    """Pairs are listed as far as a radius, 0.1 m: this one is 0.102 m apart, the floor 0.105 m."""
    gap = gaps_of([[[0.0, 0.302], [0.205, 0.205]]], [0.1, 0.1])
    assert gap == pytest.approx([0.102], rel=1e-12)


def test_a_pair_that_was_out_of_reach_may_have_come_nearer_than_the_floor():
    """0.101 m apart when the pairs are listed, then 0.061 m; the floor stays at 0.08 m."""
    gap = gaps_of([[[0.0, 0.301], [0.18, 0.18]], [[0.02, 0.281], [0.18, 0.18]]], [0.1, 0.1])
    assert gap == pytest.approx([0.08, 0.061], rel=1e-12)


def test_a_pair_that_was_just_out_of_reach_may_be_the_nearest_after_a_small_move():
    """0.1005 m apart, then 0.0985 m, while the floor's gap grows from 0.0998 m to 0.1013 m."""
    lists = [[[0.0, 0.3005], [0.1998, 0.1998]], [[0.001, 0.2995], [0.2013, 0.2013]]]
    assert gaps_of(lists, [0.1, 0.1]) == pytest.approx([0.0998, 0.0985], rel=1e-12)


def test_a_ball_that_is_infinitely_far_away_hides_no_gap_of_the_others():
    for far in (0, 1, 2):
        x = np.insert([0.0, 0.15], far, math.inf)
        assert gaps_of([[x, [1.0, 1.0, 1.0]]], [0.1] * 3) == pytest.approx([-0.05], rel=1e-12)


def test_a_radius_that_is_no_number_makes_the_gap_no_number():
    for place in (0, 1, 2):
        gap = gaps_of([[[0.0, 3.0, 6.0], [1.0, 1.0, 1.0]]], np.insert([0.1, 0.1], place, math.nan))
        assert np.isnan(gap).all()


def test_points_have_gaps_too():
    """Their radius is 0, so there is no length to begin the search with."""
    gap = gaps_of(
        [[[0.0, 3.0, 3.0], [7.0, 7.0, 9.0]], [[0.0, 3.0, 3.0], [0.5, 7.0, 9.0]]], [0.0] * 3
    )
    assert gap.tolist() == [2.0, 0.5]


def test_a_run_reports_each_200_000_steps_of_a_ball(monkeypatch):
    """So that a progress bar moves: 500 balls report after 401 steps. No step is taken here."""
    monkeypatch.setattr(piles, "take_steps", lambda rows, first, last, *rest: last)
    heard = []
    compiled("lcp", crowd(500, 0), 0.002, 1000, report=heard.append)
    assert heard == [401, 802, 1000]


# Where it is installed, and where not


def python(code, *arguments, cwd=ROOT, **environment):
    """A finished process that ran this code."""
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        cwd=cwd,
        text=True,
        env=os.environ | environment,
        capture_output=True,
        timeout=60,
    )


def test_the_command_line_takes_the_twin_and_says_when_it_cannot(tmp_path):
    """The same numbers either way; the extra is named on stderr, in one line."""
    block = "import sys; sys.modules['numba'] = None; "
    ask = "import contact, sys; sys.exit(contact.main(sys.argv[1:]))"
    flags = (
        "--scene",
        "pile",
        "--bodies",
        13,
        "--steps",
        40,
        "--contact",
        "lcp",
        "--no-rerun",
        "--out",
    )
    fast = python(ask, *flags, tmp_path / "fast")
    slow = python(block + ask, *flags, tmp_path / "slow")
    assert (fast.returncode, fast.stderr, slow.returncode) == (0, "", 0), slow.stderr
    assert slow.stderr.count("\n") == 1 and "numba" in slow.stderr
    one, other = ((tmp_path / way / "metrics.json").read_bytes() for way in ("fast", "slow"))
    assert one == other and json.loads(one)["scene"] == "pile"


def test_run_model_takes_the_twin_for_many_balls_only(monkeypatch):
    asked = []
    simulate = piles.simulate
    monkeypatch.setattr(
        piles,
        "simulate",
        lambda model, *rest, **knobs: asked.append(model) or simulate(model, *rest, **knobs),
    )
    for model in MODELS:
        for bodies in (contact.FEW, contact.FEW + 1):
            contact.run_model(model, contact.build_scene("pile", 0, bodies), 0.002, 2)
    contact.run_model("lcp", contact.build_scene("pile", 0, 13), 0.002, 2, skip=False)
    assert asked == list(MODELS)


def test_where_nothing_can_be_written_the_compiled_code_is_not_kept(tmp_path):
    """A file stands where the folder of the cache would be, and there is no home."""
    (tmp_path / "curriculum").mkdir()
    for name in ("__init__.py", "piles.py"):
        shutil.copy(ROOT / "curriculum" / name, tmp_path / "curriculum")
    (tmp_path / "curriculum" / "__pycache__").touch()
    nowhere = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"), "/dev/null/nothing")
    done = python(
        "from curriculum import piles\n"
        "print(piles.larger(0.0, float('nan')), piles.larger.stats.cache_path)",
        cwd=tmp_path,
        **nowhere,
    )
    assert (done.stdout, done.returncode) == ("0.0 None\n", 0), done.stderr
