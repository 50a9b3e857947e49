"""A skip never changes a bit, and is really taken."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contact

DT = 0.002
MODELS = ("penalty", "lcp", "soft")


def same(a, b):
    """Whether two recordings hold the same bytes."""
    return all(x.tobytes() == y.tobytes() for x, y in zip(a, b))


def both_ways(model, scene, dt, steps, **knobs):
    """The run with skips, which has the bytes of the run without."""
    skipped, stepped = (
        contact.run_model(model, scene, dt, steps, skip=skip, **knobs) for skip in (True, False)
    )
    if not same(skipped, stepped):
        differ = (skipped.q != stepped.q).any((1, 2)) | (skipped.v != stepped.v).any((1, 2))
        pytest.fail(f"{model} of {scene.name} at dt {dt}: first differs at step {differ.argmax()}")
    return skipped


@pytest.mark.parametrize("dt", [DT * factor for factor in contact.DT_GRID])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", ["drop", "bounce", "stack"])
def test_same_bytes_with_and_without_skips(name, model, dt):
    for seed in (0, 3):
        both_ways(model, contact.build_scene(name, seed), dt, 600)


@pytest.mark.parametrize("e, model", itertools.product((0.3, 1.0), MODELS))
def test_same_bytes_of_a_stack_that_bounces(e, model):
    for bodies in (2, 3, 5):
        scene = contact.build_scene("stack", 1, bodies, restitution=e, damping=0.0)
        both_ways(model, scene, DT, 400)


@pytest.mark.parametrize(
    "model, knobs",
    [
        ("lcp", {"baumgarte": 0.0}),
        ("lcp", {"baumgarte": 1.0}),
        ("lcp", {"iters": 1}),
        ("lcp", {"iters": 200}),
        ("penalty", {"stiffness": 0.0}),
        ("penalty", {"stiffness": 1e300}),
        ("penalty", {"stiffness": 7.0}),
        ("soft", {"solref": (0.05, 0.3)}),
        ("soft", {"solref": (-1e4, -50.0)}),
        ("soft", {"solimp": (0.0, 0.99, 0.01, 0.3, 3.5)}),
    ],
)
def test_same_bytes_at_the_ends_of_every_knob(model, knobs):
    for name in ("drop", "bounce", "stack"):
        both_ways(model, contact.build_scene(name), DT, 500, **knobs)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("dt", [1e-9, 1e-4, 10.0, 1e154, 1e308])
def test_same_bytes_for_steps_that_are_tiny_or_overflow(model, dt):
    both_ways(model, contact.build_scene("drop"), dt, 300)


@pytest.mark.parametrize("model", MODELS)
def test_a_flight_ends_at_a_contact_that_one_state_alone_shows(model):
    """So fast that without the contact the balls would be past each other a step later."""
    q0, v0 = np.array([[-2.0, 2.31], [50.0, 50.0]]), np.array([[150.0, -150.0], [0.0, 0.0]])
    one = np.ones(2)
    scene = contact.Scene("crossing", q0, v0, one, 0.1 * one, 0.5, 0.0)
    run = both_ways(model, scene, DT, 40)
    assert run.v[-1, 0, 0] != 150.0, "they met"


@pytest.mark.parametrize("model", MODELS)
def test_same_bytes_for_thrown_balls_of_mixed_size_and_mass(model):
    """Rising, falling, meeting in flight: a flight must stop for each."""
    rng = np.random.default_rng(11)
    for count in (1, 2, 5, 9):
        radius = rng.uniform(0.03, 0.2, count)
        q0 = np.array((rng.uniform(-0.7, 0.7, count), rng.uniform(0.1, 2.0, count) + radius))
        v0 = rng.uniform(-6.0, 6.0, (2, count))
        mass = 10.0 ** rng.uniform(-2.0, 2.0, count)
        both_ways(model, contact.Scene("thrown", q0, v0, mass, radius, 0.6, 5.0), DT, 400)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    name=st.sampled_from(["drop", "bounce", "stack"]),
    model=st.sampled_from(MODELS),
    seed=st.integers(0, 10**6),
    dt=st.floats(1e-5, 0.1),
    e=st.floats(0.0, 1.0),
    knob=st.floats(0.0, 1.0),
)
def test_same_bytes_for_any_knobs(name, model, seed, dt, e, knob):
    scene = contact.build_scene(name, seed, restitution=e, damping=100.0 * knob)
    both_ways(model, scene, dt, 200, baumgarte=knob, stiffness=10.0 ** (5.0 * knob))


# The skip is taken


def steps_taken(model, scene, dt, steps, skip):
    """How many of the steps are really computed."""
    taken = []
    name = f"{model}_step"
    step = getattr(contact, name)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contact, name, lambda *given: (taken.append(1), step(*given))[1])
        contact.run_model(model, scene, dt, steps, skip=skip)
    return len(taken)


@pytest.mark.parametrize(
    "name, model, most",
    [
        ("drop", "penalty", 500),
        ("drop", "lcp", 200),
        ("drop", "soft", 500),
        ("bounce", "lcp", 300),
        ("stack", "lcp", 200),
    ],
)
def test_flights_and_rest_are_not_stepped(name, model, most):
    """Measured 442, 145, 370, 235 and 158, where 2000 are asked for."""
    scene = contact.build_scene(name)
    assert steps_taken(model, scene, DT, 2000, False) == 2000
    assert steps_taken(model, scene, DT, 2000, True) <= most


def test_a_run_that_rests_costs_no_more_steps_when_it_is_longer():
    scene = contact.build_scene("stack")
    short, long = (steps_taken("lcp", scene, DT, steps, True) for steps in (2000, 50000))
    assert short == long


@pytest.mark.parametrize("period, start", [(1, 5), (2, 0), (3, 17), (7, 1), (30, 100)])
def test_a_cycle_of_any_period_is_recognised_and_copied(period, start):
    """A made-up step with a known answer: up by one until `start`, then round and round."""
    calls = []

    def step(balls):
        calls.append(1)
        k = int(balls[0].vx) + 1
        balls[0].vx = float(k if k < start + period else start)

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
    ball = contact.Ball(0.0, 0.1, 0.0, -1.0, 1.0, 0.1)
    (c,) = contact.detect_contacts([ball])
    contact.solve_contacts([c], 20)
    assert (ball.vy, c.lam) == (0.0, 1.0) and len(calls) == 2


def falling_tower(count):
    """Balls in touch, one above the other, each falling at 1 m/s, and their contacts."""
    balls = [contact.Ball(0.0, 0.1 + 0.2 * i, 0.0, -1.0, 1.0, 0.1) for i in range(count)]
    return balls, contact.detect_contacts(balls)


def test_what_can_be_swept_further_is_swept_further():
    """Only a fixed point stops the sweeps: 1000 go on from where 20 were.

    Eight balls that fall at 1 m/s and stop at once: the floor takes the impulse of all eight.
    """
    (rough, first), (stopped, contacts) = falling_tower(8), falling_tower(8)
    contact.solve_contacts(first, 20)
    contact.solve_contacts(contacts, 1000)
    assert [c.lam for c in first] != [c.lam for c in contacts]
    assert max(abs(ball.vy) for ball in rough) > 1e-3
    assert max(abs(ball.vy) for ball in stopped) < 1e-12
    assert [c.lam for c in contacts] == pytest.approx([8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0])


@pytest.mark.parametrize("y, vy", [(1.0, 0.0), (0.4, 3.0), (2.0, -5.0), (0.1011, -0.1)])
def test_the_steps_to_the_floor_are_those_of_the_parabola(y, vy):
    """Until gap + vy t - g t^2 / 2 is the margin; a ball nearer than that has none left."""
    for dt in (DT, 0.5):
        t = dt * contact.steps_to_floor(contact.Ball(0.0, y, 0.0, vy, 1.0, 0.1), dt)
        assert y - 0.1 + vy * t - 9.81 * t * t / 2.0 == pytest.approx(0.001, abs=1e-12)
    assert contact.steps_to_floor(contact.Ball(0.0, 0.1, 0.0, vy, 1.0, 0.1), DT) == 0
    assert contact.steps_to_floor(contact.Ball(0.0, y, 0.0, vy, np.inf, 0.1), DT) == np.inf


def test_flights_of_sixteen_states_are_summed_up_and_shorter_ones_are_not():
    ball = contact.Ball(0.0, 9.0, 1.0, 0.0, 1.0, 0.1)
    assert [len(contact.fly([ball], DT, most)) for most in (15, 16, 17)] == [0, 16, 17]


def test_every_step_that_is_taken_is_reported():
    heard = []
    contact.run_model("lcp", contact.build_scene("stack"), DT, 5, skip=False, report=heard.append)
    assert heard == [1, 2, 3, 4, 5]
