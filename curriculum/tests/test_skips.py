"""A skip never changes a bit, and is really taken."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contact

DT = 0.002


def same(a, b):
    """Whether two recordings hold the same bytes."""
    return all(x.tobytes() == y.tobytes() for x, y in zip(a, b))


def both_ways(model, scene, dt, steps, **knobs):
    skipped, stepped = (
        contact.run_model(model, scene, dt, steps, skip=skip, **knobs) for skip in (True, False)
    )
    if not same(skipped, stepped):
        differ = (skipped.q != stepped.q).any((1, 2)) | (skipped.v != stepped.v).any((1, 2))
        pytest.fail(f"{model} of {scene.name} at dt {dt}: first differs at step {differ.argmax()}")
    return skipped


@pytest.mark.parametrize("dt", [DT * factor for factor in contact.DT_GRID])
@pytest.mark.parametrize("model", ["penalty", "lcp"])
@pytest.mark.parametrize("name", ["drop", "bounce", "stack"])
def test_same_bytes_with_and_without_skips(name, model, dt):
    for seed in (0, 3, 8):
        both_ways(model, contact.build_scene(name, seed), dt, 600)


@pytest.mark.parametrize("e, model", [*product((0.3, 0.8, 1.0), ("penalty", "lcp"))])
def test_same_bytes_of_a_stack_that_bounces(e, model):
    for bodies in (2, 3, 5):
        scene = contact.build_scene("stack", 1, bodies, restitution=e, damping=0.0)
        both_ways(model, scene, DT, 500)


@pytest.mark.parametrize("knobs", [
    {"baumgarte": 0.0}, {"baumgarte": 1.0}, {"iters": 1}, {"iters": 200},
    {"stiffness": 0.0}, {"stiffness": 1e300}, {"stiffness": 7.0},
])  # fmt: skip
def test_same_bytes_at_the_ends_of_every_knob(knobs):
    model = "penalty" if "stiffness" in knobs else "lcp"
    for name in ("drop", "bounce", "stack"):
        both_ways(model, contact.build_scene(name), DT, 500, **knobs)


@pytest.mark.parametrize("model", ["penalty", "lcp"])
@pytest.mark.parametrize("dt", [1e-9, 1e-4, 10.0, 1e154, 1e308])
def test_same_bytes_for_steps_that_are_tiny_or_overflow(model, dt):
    both_ways(model, contact.build_scene("drop"), dt, 300)


@pytest.mark.parametrize("model", ["penalty", "lcp"])
def test_same_bytes_for_thrown_balls_of_mixed_size_and_mass(model):
    """Rising, falling, meeting in flight: a flight must stop for each."""
    rng = np.random.default_rng(11)
    for count in (1, 2, 5, 9, 16):
        radius = rng.uniform(0.03, 0.2, count)
        q0 = np.array((rng.uniform(-0.7, 0.7, count), rng.uniform(0.1, 2.0, count) + radius))
        v0 = rng.uniform(-6.0, 6.0, (2, count))
        mass = 10.0 ** rng.uniform(-2.0, 2.0, count)
        both_ways(model, contact.Scene("thrown", q0, v0, mass, radius, 0.6, 5.0), DT, 400)


@pytest.mark.parametrize("model", ["penalty", "lcp"])
@pytest.mark.parametrize("bodies, steps", [(12, 200), (13, 200), (50, 150)])
def test_same_bytes_of_a_pile(model, bodies, steps):
    """12 balls are stepped as floats, 13 as arrays with contacts one by one."""
    both_ways(model, contact.build_scene("pile", 2, bodies), 0.004, steps)


@pytest.mark.parametrize("model", ["penalty", "lcp"])
def test_same_bytes_of_a_pile_of_300_while_it_lands(model):
    """Started low and falling, so that few steps hold many contacts."""
    scene = contact.build_scene("pile", 0, 300)
    scene = scene._replace(v0=np.array((np.zeros(300), np.full(300, -3.0))))
    run = both_ways(model, scene, 0.004, 14)
    assert len(contact.detect_contacts(run.q[-1].tolist(), scene.radius.tolist())) > 60


@pytest.mark.parametrize("model", ["penalty", "lcp"])
def test_same_bytes_of_a_tower_that_stands(model):
    both_ways(model, contact.build_scene("stack", 0, 30), DT, 120)


@settings(max_examples=40, deadline=None)
@given(
    name=st.sampled_from(["drop", "bounce", "stack"]),
    model=st.sampled_from(["penalty", "lcp"]),
    seed=st.integers(0, 10**6),
    dt=st.floats(1e-5, 0.1),
    e=st.floats(0.0, 1.0),
    knob=st.floats(0.0, 1.0),
)
def test_same_bytes_for_any_knobs(name, model, seed, dt, e, knob):
    scene = contact.build_scene(name, seed, restitution=e, damping=100.0 * knob)
    both_ways(model, scene, dt, 200, baumgarte=knob, stiffness=10.0 ** (5.0 * knob))


# The skip is taken


def steps_taken(model, scene, dt, steps, skip, monkeypatch):
    taken = []
    name = {"penalty": "semi_implicit_step", "lcp": "lcp_step"}[model]
    step = getattr(contact, name)
    with monkeypatch.context() as patch:
        patch.setattr(contact, name, lambda *state: (taken.append(1), step(*state))[1])
        contact.run_model(model, scene, dt, steps, skip=skip)
    return len(taken)


@pytest.mark.parametrize(
    "name, model, most",
    [
        ("drop", "penalty", 700),
        ("drop", "lcp", 200),
        ("bounce", "lcp", 1000),
        ("stack", "lcp", 200),
    ],
)
def test_flights_and_rest_are_not_stepped(name, model, most, monkeypatch):
    scene = contact.build_scene(name)
    assert steps_taken(model, scene, DT, 2000, False, monkeypatch) == 2000
    taken = steps_taken(model, scene, DT, 2000, True, monkeypatch)
    print(f"{name} {model}: {taken} of 2000 steps taken")
    assert taken <= most


def test_a_run_that_rests_costs_no_more_steps_when_it_is_longer(monkeypatch):
    scene = contact.build_scene("stack")
    short, long = (
        steps_taken("lcp", scene, DT, steps, True, monkeypatch) for steps in (2000, 50000)
    )
    assert short == long


@pytest.mark.parametrize("period, start", [(1, 5), (2, 0), (3, 17), (7, 1), (30, 100)])
def test_a_cycle_of_any_period_is_recognised_and_copied(period, start):
    """A made-up step with a known answer: up by one until `start`, then round and round."""
    calls = []

    def step(q, v):
        calls.append(1)
        k = int(v[0][0]) + 1
        return [[0.0], [0.05]], [[float(k if k < start + period else start)], [0.0]]

    scene = contact.build_scene("drop")._replace(q0=np.array([[0.0], [0.05]]))
    run = contact.simulate(step, scene, DT, 500)
    expected = [k if k < start else start + (k - start) % period for k in range(501)]
    assert run.v[:, 0, 0].tolist() == expected
    assert len(calls) <= start + period + 1
    calls.clear()
    assert same(run, contact.simulate(step, scene, DT, 500, skip=False)) and len(calls) == 500


def test_a_sweep_that_changes_nothing_is_the_last(monkeypatch):
    """One ball is solved by the first sweep; the second finds nothing; 18 more are not made."""
    calls = []
    project = contact.project_impulse
    monkeypatch.setattr(contact, "project_impulse", lambda *a: (calls.append(1), project(*a))[1])
    contacts = contact.detect_contacts([[0.0], [0.1]], [0.1])
    v, lam = contact.solve_contacts([[0.0], [-1.0]], [1.0], contacts, [0.0], 20)
    assert (v[1], lam) == ([0.0], [1.0]) and len(calls) == 2


def test_what_can_be_swept_further_is_swept_further():
    """Only a fixed point stops the sweeps: 1000 go on from where 20 were."""
    contacts = [(0, -1, 0.0, 1.0, 0.0), *[(k, k - 1, 0.0, 1.0, 0.0) for k in range(1, 8)]]
    v, w = [[0.0] * 8, [-1.0] * 8], [1.0] * 8
    twenty, thousand = (
        contact.solve_contacts(v, w, contacts, [0.0] * 8, iters) for iters in (20, 1000)
    )
    assert twenty != thousand
    assert max(map(abs, thousand[0][1])) < 1e-12
    assert thousand[1] == pytest.approx([8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0])


# Groups of arrays give the bits of one by one


def flat(contacts, values):
    """Values of groups as {(i, j, depth): value}, a group's common one too; of floats likewise."""
    pairs = {}
    for (i, j, _, _, depth), value in zip(contacts, values):
        columns = map(np.ravel, np.broadcast_arrays(i, j, depth, value))
        pairs |= {
            (a, b, d): repr(c + 0.0) for a, b, d, c in zip(*(column.tolist() for column in columns))
        }
    return pairs


def as_groups(contacts, bodies):
    """The same contacts as groups of arrays, whatever their number."""
    i, j, nx, ny, depth = (np.array(column) for column in zip(*contacts))
    groups = contact.balls.independent_groups(i, j, bodies)
    return [tuple(column[g] for column in (i, j, nx, ny, depth)) for g in groups]


def hold_equal(v, w, contacts, groups, e, iters):
    one, many = v.tolist(), list(v)
    target = contact.contact_targets(one, contacts, e, 0.2, DT)
    targets = contact.contact_targets(many, groups, e, 0.2, DT)
    assert flat(contacts, target) == flat(groups, targets)
    swept, lam = contact.solve_contacts(one, w.tolist(), contacts, target, iters)
    grouped, lams = contact.solve_contacts(many, w, groups, targets, iters)
    assert (np.array(swept) + 0.0).tobytes() == (np.array(grouped) + 0.0).tobytes()
    assert flat(contacts, lam) == flat(groups, lams)


CONTACTS = st.lists(
    st.tuples(
        st.integers(0, 11), st.integers(-1, 11), st.floats(0.0, 6.3), st.floats(-1e-3, 0.02)
    ).filter(lambda c: c[0] != c[1]),
    min_size=1,
    max_size=60,
    unique_by=lambda c: (c[0], c[1], c[3]),
)


@settings(max_examples=150, deadline=None)
@given(CONTACTS, st.integers(0, 10**6), st.sampled_from([0.0, 0.5, 1.0]), st.integers(1, 12))
def test_grouped_sweep_has_the_bits_of_the_sequential_one(made, seed, e, iters):
    """Any contact list, a physical one or not; some bodies that nothing moves."""
    rng = np.random.default_rng(seed)
    contacts = [(i, j, float(np.cos(a)), float(np.sin(a)), d) for i, j, a, d in made]
    w = rng.choice([0.0, 0.5, 1.0, 1e6], 12)
    hold_equal(rng.normal(size=(2, 12)), w, contacts, as_groups(contacts, 12), e, iters)


def crowd(count, seed, wide=1.96):
    """Balls close packed in rows and shuffled, so that nearly all neighbours overlap."""
    rng = np.random.default_rng(seed)
    place, width = rng.permutation(count), 40
    q = np.array((wide * 0.1 * (place % width), 0.097 + wide * 0.1 * (place // width)))
    return q + rng.uniform(-0.003, 0.003, q.shape), np.full(count, 0.1), rng


def test_arrays_of_a_big_crowd_sweep_to_the_bits_of_one_by_one():
    q, radius, rng = crowd(900, 4)
    contacts = contact.detect_contacts(q.tolist(), radius.tolist())
    groups = contact.detect_contacts(list(q), radius)
    assert len(contacts) > 1500 and isinstance(groups[0][0], np.ndarray), "not the array path"
    assert sum(len(group[0]) for group in groups) == len(contacts)
    v, w = rng.normal(size=(2, 900)), 10.0 ** rng.uniform(-3.0, 3.0, 900)
    hold_equal(v, w, contacts, groups, 0.4, 8)


def test_arrays_of_a_big_crowd_push_with_the_bits_of_one_by_one():
    q, radius, rng = crowd(900, 5, wide=1.94)
    v, mass = rng.normal(size=(2, 900)), np.ones(900)
    groups = contact.detect_contacts(list(q), radius, margin=0.0)
    assert isinstance(groups[0][0], np.ndarray), "not the array path"
    many = contact.penalty_force(list(q), list(v), mass, radius, 1e4, 80.0)
    one = contact.penalty_force(q.tolist(), v.tolist(), mass.tolist(), radius.tolist(), 1e4, 80.0)
    assert (np.array(many) + 0.0).tobytes() == (np.array(one) + 0.0).tobytes()
    assert np.abs(many).max() > 1.0


@pytest.mark.parametrize("model", ["penalty", "lcp"])
def test_arrays_of_a_big_crowd_step_with_the_bits_of_one_by_one(model):
    q, radius, rng = crowd(900, 6)
    v = rng.normal(scale=0.1, size=q.shape)
    both_ways(model, contact.Scene("crowd", q, v, np.ones(900), radius, 0.3, 80.0), DT, 2, iters=5)


def test_memory_of_contacts_grows_with_the_balls_not_their_pairs():
    """20,000 balls have 200 million pairs, which would take gigabytes."""
    import tracemalloc

    scene = contact.build_scene("pile", 0, 20_000)
    tracemalloc.start()
    contact.detect_contacts(list(scene.q0), scene.radius)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(f"{peak / 20_000:.0f} bytes a ball")
    assert peak < 3000 * 20_000
