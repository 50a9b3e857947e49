"""What the five models promise: published figures, formulas, the engine; see test_stress, too."""

import cProfile
import math
from itertools import product

import numpy as np
import pytest

import contact
from contact import FLOOR, STEPPED, Ball, Settings, build_scene, contact_quality, run_model
from curriculum.bench import engines, measure, problems
from curriculum.stress import heaps
from curriculum.stress.trial import run_twin

R, G, DT = contact.RADIUS, 9.81, 0.002


@pytest.mark.parametrize("damping, count", [(0.0, 1), (80.0, 1), (0.0, 5), (80.0, 5)])
def test_at_the_critical_dt_an_eigenvalue_of_the_step_leaves_the_unit_circle(damping, count):
    """Of a stack kept in contact: v += dt (-k A x - c A v) / m, x += dt v."""
    A = 2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1)
    A[-1, -1] = 1.0
    for stiffness, share in product((1e2, 1e4, 1e6), (0.999, 1.001)):
        dt = share * contact.critical_dt(1.0, stiffness, damping, count)
        speed = np.hstack((-dt * stiffness * A, np.eye(count) - dt * damping * A))
        step = np.vstack((np.hstack((np.eye(count), 0 * A)) + dt * speed, speed))
        assert (np.abs(np.linalg.eigvals(step)).max() < 1.0 + 1e-9) == (share < 1.0)


def test_critical_dt_also_without_a_spring_with_a_damper_that_feeds_and_of_what_nothing_moves():
    given = (1.0, 0.0, 80.0), (1.0, 0.0, 0.0), (1.0, 1e4, -1.0), (math.inf, 1e4, 80.0)
    assert [contact.critical_dt(*each) for each in given] == [0.025, math.inf, 0.0, math.inf]


def test_a_normal_lies_along_the_centres_and_points_up_where_they_coincide():
    for x, normal in (1e-15, (1.0, 0.0)), (0.0, (0.0, 1.0)):
        (c,) = contact.detect_contacts([Ball(each, 5.0, 0.0, 0.0, 1.0, R) for each in (x, 0.0)])
        assert (c.nx, c.ny) == normal


@pytest.mark.parametrize("name, iters, most", [
    ("drop", 20, 1e-12), ("bounce", 20, 5e-5), ("elastic", 20, 1e-11), ("stack", 20, 1e-8),
    ("slide", 20, 3e-4), ("spread", 20, 2e-4), ("glance", 20, 3e-4), ("cradle", 20, 1e-12),
    ("heavy_100", 20, 4e-4), ("heavy_1000", 20, 8e-3), ("tower", 20, 4e-3),
    ("heavy_100", 100, 1e-8), ("heavy_1000", 100, 1e-3), ("tower", 100, 1e-5),
])  # fmt: skip
def test_leapfrog_with_one_step_in_2_ms_is_this_near_to_the_known_answer(name, iters, most):
    problem, errors = problems.BY_NAME[name], []
    for scene in map(problem.build, range(3)):
        run = run_twin("leapfrog", scene, DT, problem.steps(DT), Settings(iters=iters))
        off = np.hypot(*(run.q - problem.truth(scene, run.t)).swapaxes(0, 1))
        errors.append(off.max() / R)
    assert np.median(errors) < most


@pytest.mark.parametrize("e", [0.0, 0.3])
def test_leapfrog_is_of_second_order_where_balls_slide(e):
    """A ball slides off a fixed one: quarter the step, and a sixteenth of the error is left."""
    scene = problems.BY_NAME["slide"].build(0)._replace(restitution=e)
    times = np.arange(problems.BY_NAME["slide"].steps(DT) + 1) * DT
    truth = problems.judged(scene, times)
    errors = []
    for substeps in (1, 4):
        run = run_model("leapfrog", scene, DT / substeps, (len(times) - 1) * substeps)
        errors.append(np.abs(run.q[::substeps] - truth).max())
    assert math.log(errors[0] / errors[1], 4) > 1.9


def test_leapfrog_opens_an_overlap_and_throws_nobody():
    pair = contact.scene_of([0.0, 0.02], [0.13, 0.27], [1.0, 3.0], [0.13, 0.08])
    run = run_model("leapfrog", pair, 0.003, 500)
    assert run.q[:, 1].max() < 0.36 and contact.smallest_gap(run.q[-1:], pair.radius)[0] > -1e-6
    rng = np.random.default_rng(4)
    heap = contact.scene_of(*rng.uniform(0.0, 0.2, (2, 10)))
    run = run_model("leapfrog", heap, DT, 500)
    assert np.hypot(*run.v.swapaxes(0, 1)).max() < 8.0


@pytest.mark.parametrize("e, iters", [(0.0, 4), (0.5, 2), (0.5, 4)])
def test_a_pile_of_a_hundred_settles_though_sweeps_do_not_converge(e, iters):
    scene = measure.shaft(100)._replace(restitution=e)
    run = run_twin("leapfrog", scene, DT, 3000, Settings(iters=iters))
    assert np.abs(run.q[-250:] - run.q[-1]).max() < 1e-4  # m, in half a second


def test_a_resting_contact_that_becomes_an_impact_within_a_step_lifts_nothing():
    """Of 60,000 runs of the stress test the one that gained, 2e-3, where such an overlap opens."""
    energies = heaps.Heap(74).run("leapfrog", 0.016, "column of 3", "1")[2]
    assert energies.max() < 1e-9


IMPACTS = {  # what a ball strikes; at restitution 1, if no other is given
    "a slow ball": dict(x=[0, 0.21], y=0.1, vx=[0.1, 0]),
    "a slow ball, in the air": dict(x=[0, 0.21], y=9.0, vx=[0.1, 0]),
    "a wall that comes": dict(x=[0, 0.21], y=0.1, mass=[1, math.inf], vx=[0, -0.1]),
    "a row with gaps of a millimetre":
        dict(x=[0, 0.201, 0.402, 0.603, 0.804], y=0.1, vx=[2, 0, 0, 0, 0]),
    "a fixed ball overhead": dict(x=0, y=[0.5, 1.2], mass=[1, math.inf], vy=[5, 0]),
    "a ball that falls, too": dict(x=0, y=[1.0, 1.2001], vy=[0, -0.01]),
    "a ball that it nears too slowly for a square":
        dict(x=[0, 0.20001], y=0.1, vx=[1e-170, 0], restitution=0.0),
    "the floor, as another does in that step": dict(x=[0, 5], y=[0.4, 0.403], restitution=0.5),
    "a ball at rest, which the floor holds":
        dict(x=0, y=[0.11, 0.352], mass=[0.7, 2], radius=[0.11, 0.12], vy=[0, -1], restitution=0.9),
}  # fmt: skip


@pytest.mark.parametrize("dt", [0.001, 0.002, 0.003, 0.016])
@pytest.mark.parametrize("struck", IMPACTS)
def test_every_impact_of_leapfrog_has_its_own_moment(struck, dt):
    """However slow it is, and whenever in a step it comes: all go where exact has them."""
    scene, steps = contact.scene_of(**{"restitution": 1.0} | IMPACTS[struck]), int(0.3 / dt)
    run = run_model("leapfrog", scene, dt, steps, Settings(iters=1000))
    assert np.abs(run.q - run_model("exact", scene, dt, steps).q).max() < 1e-11


def calls_later(scene, steps):
    """{function: how often five steps of leapfrog call it}, so many steps after the start."""
    run, profile = run_model("leapfrog", scene, DT, steps), cProfile.Profile()
    later = scene._replace(q0=run.q[-1], v0=run.v[-1])
    profile.runcall(run_model, "leapfrog", later, DT, 5, Settings(skip=False))
    return {getattr(each.code, "co_name", ""): each.callcount for each in profile.getstats()}


@pytest.mark.parametrize("gap", [0.0, 0.05, 0.07, 0.2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_impacts_that_make_a_light_ball_much_faster_let_it_hit_what_was_far(side, gap):
    squirted = contact.scene_of(  # two heavy balls close on a light one, over the floor
        [-0.16, 0.16, 0.0], [0.4 + gap, 0.4 + gap, 0.39 + gap], [100, 100, 1], [R, R, R / 2],
        [5, -5, 0], restitution=1.0,
    )  # fmt: skip
    row = [0.0, 0.201, 0.402, 0.603, 1.43 + gap]  # each a tenth of the last, and then a wall
    chain = contact.scene_of(
        np.array(row) * side, 50.0, [1000, 100, 10, 1, np.inf], R, [10 * side, 0, 0, 0, 0],
        restitution=1.0,
    )  # fmt: skip
    for scene, steps in ((squirted, 2), (chain, 1)):
        run, exact = (run_model(model, scene, 0.016, steps) for model in ("leapfrog", "exact"))
        assert run.q == pytest.approx(exact.q, abs=1e-3)
        twin = run_twin("leapfrog", scene, 0.016, steps, Settings())
        assert np.array_equal(twin.q, run.q)


def test_impacts_cost_a_bounded_number_of_pushes_and_at_rest_none():
    falls = calls_later(build_scene("pile", bodies=150, restitution=0.5), 300)
    assert 100_000 < falls["apply_impulse"] < 220_000
    rests = calls_later(measure.shaft(12), 3000)
    assert 5_000 < rests["apply_impulse"] < 12_000, "20 sweeps, twice a step"
    crushed = contact.scene_of(0, [0.1, 0.301], [1, math.inf], vy=[0, -0.2], restitution=0.5)
    assert 5_000 < calls_later(crushed, 20)["apply_impulse"] < 30_000


def test_momentum_finds_what_plain_sweeps_find_in_a_tenth_of_them():
    """A tower at rest asks: how hard does each ball press on the one below?"""
    counts = []
    for solve in (contact.solve_contacts, contact.solve_accelerated):
        balls = [Ball(0.0, (2 * i + 1) * R, 0.0, -G * DT, 1.0, R) for i in range(20)]
        contacts = contact.detect_contacts(balls)
        counts.append(solve(contacts, 9999, 1e-9 * G * DT))
        assert [c.lam for c in contacts][0] == pytest.approx(20 * G * DT, rel=1e-4)
    assert 0 < 10 * counts[1] < counts[0]


def scenes_for_mujoco():
    """Yield scene, dt and settings: every kind of scene, step, mass and setting.

    Balls that start exactly in touch are left out: they fall as one, the last bit of a gap decides
    whether there is a contact, and with d0 > 0 a contact begins with a jump of its force.
    """
    drop, bounce, stack = map(build_scene, ("drop", "bounce", "stack"))
    pile = build_scene("pile", bodies=8)
    stack.q0[1] += 0.005 * np.arange(3)  # m between the balls
    for dt in (0.0005, 0.002, 0.008, 0.016):
        yield from ((scene, dt, Settings()) for scene in (drop, bounce, stack, pile))
    for mass in ((10.0, 1.0, 0.1), (0.1, 1.0, 10.0)):
        yield stack._replace(mass=np.array(mass)), DT, Settings()
    for solref in ((-5000.0, -100.0), (0.05, 0.5), (0.001, 1.0)):  # the last: two steps at least
        yield stack, DT, Settings(solref=solref)
    for d0, *more in (
        (0.0, 0.95, 0.001, 0.5, 2.0), (0.9, 0.95, 0.0, 0.5, 2.0), (0.2, 0.95, 0.005, 0.4, 2.5),
        (0.5, 1.0, 0.01, 0.0, 2.0), (0.5, 0.95, 0.01, 0.5, 0.3),  # beyond its bounds
    ):  # fmt: skip
        yield stack, DT, Settings(solimp=(d0, *more))


@pytest.mark.parametrize("scene, dt, settings", scenes_for_mujoco())
def test_soft_is_mujoco_in_each_step_and_in_a_whole_run(scene, dt, settings):
    """By default MuJoCo stops up to 7e-4 m from its own answer; here its tolerance is 0."""
    pytest.importorskip("mujoco", reason="mujoco is not installed: pip install mujoco")
    options = 'tolerance="0" iterations="1000" ls_iterations="200"'
    knobs = contact.soft_defaults(scene.restitution, dt, settings.solref, settings.solimp)
    texts = [" ".join(map(repr, values)) for values in knobs]
    q, v = engines.Mujoco(scene, dt, texts, xml=options).states(300)
    assert run_model("soft", scene, dt, 300, settings).q == pytest.approx(q, rel=0, abs=1e-11)
    for k in range(0, 300, 20):
        balls = contact.make_balls(scene._replace(q0=q[k], v0=v[k]))
        contact.soft_step(balls, dt, *knobs)
        ends = np.array([(ball.x, ball.y, ball.vx, ball.vy) for ball in balls]).T
        assert ends[:2] == pytest.approx(q[k + 1], rel=0, abs=1e-14)
        assert ends[2:] == pytest.approx(v[k + 1], rel=0, abs=1e-12)


def same_bytes_both_ways(model, scene, dt, steps, **knobs):
    """Whether the run with skips has the bytes of the run without."""
    step, kicks = contact.step_of(model, scene, dt, Settings(**knobs)), contact.MODELS[model].kicks
    runs = (contact.simulate(step, scene, dt, steps, skip, kicks) for skip in (0, 1))
    return all(a.tobytes() == b.tobytes() for a, b in zip(*runs))


@pytest.mark.parametrize("model", STEPPED)
def test_a_skip_never_changes_a_bit(model):
    """Of one and two balls the stress test says so."""
    scene = build_scene("stack", 3)
    for dt in (1e-9, 1e-4, *(DT * factor for factor in contact.DT_GRID), 10.0, 1e3):
        assert same_bytes_both_ways(model, scene, dt, 300 if dt < 1.0 else 9), dt
    for knobs in ({"baumgarte": 1.0, "stiffness": 0.0, "iters": 1}, {"solref": (-1e4, -50.0)}):
        assert same_bytes_both_ways(model, scene, DT, 400, **knobs), knobs


@pytest.mark.parametrize("x, y, vx", [
    ([-2.0, 2.31], 50.0, [150.0, -150.0]),  # a step later they would be past each other
    ([0.0, 1.0], [0.5, math.nan], 0.0),
])  # fmt: skip
@pytest.mark.parametrize("model", STEPPED)
def test_a_flight_ends_at_a_contact_also_beside_a_ball_that_is_nowhere(model, x, y, vx):
    scene = contact.scene_of(x, y, vx=vx, restitution=0.5)
    assert same_bytes_both_ways(model, scene, DT, 400)


def test_flight_and_rest_cost_no_steps():
    scene, taken = build_scene("drop"), []
    step = contact.step_of("lcp", scene, DT, Settings())
    contact.simulate(lambda balls: taken.append(step(balls)), scene, DT, 2000, skip=True, kicks=1)
    assert len(taken) < 200


@pytest.mark.parametrize("field, values", {
    "q0": ([[0.0], [math.inf]], np.zeros((2, 2)), [[0.0], [1.0, 2.0]]),
    "v0": ([[math.nan], [0.0]], "still"), "radius": ([-0.1], None), "damping": (math.nan, -1.0),
    "mass": ([0.0], [math.nan], [1j], []), "restitution": (-1.0, 1.1, [0.5, 0.5]),
    "stiffness": (-1.0, math.nan, math.inf), "baumgarte": (-0.1, 2.0, math.nan),
    "iters": (0, -3, 20.5, "20"), "warm": (-1.0, 2.0, math.nan),
    "dt": (0.0, -1.0, math.nan, math.inf), "steps": (-1,),
    "solref": ((0.02, 0.0), (-1.0, 1.0), (math.nan, 1.0), (0.02,), 1),
    "solimp": ((0.9, 0.95, math.nan, 0.5, 2.0), (0.9, 0.95, -1.0, 0.5, 2.0), (1e6,) * 5),
}.items())  # fmt: skip
def test_what_makes_no_sense_is_refused_by_its_name(field, values):
    for model, value in product(contact.MODELS, values):
        given = {"dt": DT, "steps": 5} | {field: value}
        dt, steps = given.pop("dt"), given.pop("steps")
        knob = field in Settings._fields
        scene = build_scene("drop")._replace(**{} if knob else given)
        with pytest.raises(ValueError, match=f"{field}: given .*; allowed: "):
            run_model(model, scene, dt, steps, Settings(**given if knob else {}))


@pytest.mark.parametrize("model", STEPPED)
def test_contacts_have_the_impulses_that_changed_the_momenta(model):
    """Those of the floor, and g dt."""
    scene, pushes = build_scene("stack", bodies=2, restitution=0.5), []
    push = contact.step_of(model, scene, DT, Settings())
    step = lambda balls: pushes.append(sum(c.lam for c in push(balls) if c.b is FLOOR))  # noqa: E731
    gained = np.diff(contact.simulate(step, scene, DT, 300).v[:, 1].sum(1)) + 2 * G * DT
    assert np.abs(pushes - gained).max() < 1e-12


@pytest.mark.parametrize("model", STEPPED)
def test_a_force_acts_for_one_step(model):
    (ball,) = balls = contact.make_balls(build_scene("drop", mass=2))
    step = contact.step_of(model, build_scene("drop"), DT, Settings())
    ball.fx = 3.0
    step(balls)
    step(balls)
    assert ball.vx == pytest.approx(3.0 * DT / 2.0) and ball.fx == ball.fy == 0.0


def recording(heights, landing=1):
    """A Run of one ball at these heights [m], falling to step `landing`, at rest from there."""
    t = 0.01 * np.arange(len(heights))
    q, v = np.zeros((2, len(heights), 2, 1))
    q[:, 1, 0] = heights
    v[:landing, 1, 0] = -G * t[:landing]
    return contact.Run(t, q, v)


def test_measures_of_recordings_made_by_hand():
    scene = build_scene("drop")
    row = contact_quality(recording([1.0, R, R + 0.05, R + 0.02, R - 0.03]), scene, 0.01)
    assert row["rest_gap_frac"] == pytest.approx(-0.3) and row["rebound_frac"] == pytest.approx(0.5)
    assert row["max_penetration_frac"] == row["rest_penetration_frac"] == pytest.approx(0.3)
    rises = contact_quality(recording([1.0, 0.4, 0.5, 0.3, 0.35]), scene, 0.01)
    assert rises["contact_energy"] == pytest.approx(0.15) and rises["energy_excess"] == 0.0
    assert contact_quality(recording([1.0, -0.01]), scene, 0.01)["through"] == "the floor"


def test_the_smallest_gap_is_that_of_all_pairs_and_of_the_floor():
    rng = np.random.default_rng(0)
    q, radius = rng.normal((0.0, 9.0), 1.0, (50, 40, 2)).swapaxes(1, 2), rng.uniform(0.1, 0.5, 40)
    a, b = np.triu_indices(40, 1)
    pairs = np.hypot(*(q[:, :, a] - q[:, :, b]).swapaxes(0, 1)) - radius[a] - radius[b]
    least = np.minimum(pairs.min(-1), (q[:, 1] - radius).min(-1))
    assert contact.smallest_gap(q, radius) == pytest.approx(least, abs=1e-12)


def test_measures_are_in_radii_of_the_smallest_ball():
    scene = contact.scene_of([2.0, 0.0], [0.5, 0.05], radius=[0.2, 0.06])
    row = contact_quality(run_model("lcp", scene, DT, 0), scene, DT)
    assert row["rest_penetration_frac"] == pytest.approx(0.01 / 0.06)


@pytest.mark.parametrize("places, radius, through", [
    ([0.0, 0.6, 0.7], [0.02, 0.1], "a ball"),  # it jumps over the other between two states
    ([0.0, 0.1, 0.17], [0.02, 0.1], None),  # it touches, and by less than a centre
    ([0.0, 0.1, 0.21], [0.02, 0.1], "a ball"),
    ([0.0, 0.24, 0.25], [0.03, 0.03], None),
    ([0.0, 0.25, 0.28], [0.03, 0.03], "a ball"),  # two small ones pass, beside a large one
])  # fmt: skip
def test_who_went_through_is_judged_pair_by_pair_and_also_between_two_states(
    places, radius, through
):
    """Two fixed balls in one another, which start so, went through nothing."""
    mass, radius = [1.0, 1.0, math.inf, math.inf], [*radius, 0.5, 0.5]
    scene = contact.scene_of([0.0, 0.3, 3.0, 3.1], 1.0, mass, radius)
    q = np.array([[[x, 0.3, 3.0, 3.1], [1.0] * 4] for x in places])
    run = contact.Run(0.01 * np.arange(3), q, np.zeros_like(q))
    assert contact_quality(run, scene, 0.01)["through"] == through


def test_the_first_contact_is_seen_in_a_velocity_that_changes_by_a_millionth():
    t = 0.01 * np.arange(5)
    q, v = np.full((5, 2, 1), 3.0), np.zeros((5, 2, 1))
    v[:, 1, 0] = 2.0 - G * t + [0.0, 0.0, 2e-6, 2e-6, 2e-6]
    scene = contact.scene_of(3.0, 3.0)
    assert contact_quality(contact.Run(t, q, v), scene, 0.01)["first_contact_step"] == 2


def test_at_rest_is_what_creeps_or_trembles_by_g_dt_and_nothing_that_turns_or_comes_round():
    """A ball that turns round in the middle of its last step seems not to have moved; one that
    comes round once a step is where it was at every state."""
    scene, t = build_scene("drop"), 0.004 * np.arange(5)
    flies = recording(1.0 - 0.5 * G * (t - 0.014) ** 2)._replace(t=t)
    flies.v[:, 1, 0] = -G * (t - 0.014)
    lies = recording([R, R + 1e-7, R + 2e-7])._replace(t=t[:3])
    assert not contact.at_rest(flies, scene) and contact.at_rest(lies, scene)
    for vx, vy, rests in (1.25, 0.0, False), (0.0, 1.25, False), (0.0, -G * 0.008, True):
        stays = recording([R] * 4)._replace(t=0.016 * np.arange(4))
        stays.v[:] = [[vx], [vy]]
        assert contact.at_rest(stays, scene) == rests


def test_the_height_error_is_split_at_the_first_contact_of_either_run():
    truth = recording([1.0, 0.62, R, R, R], landing=2)
    row = contact_quality(recording([1.0, 0.6, 0.5, R, R], 4), build_scene("drop"), 0.01, truth)
    assert row["flight_error_frac"] == pytest.approx(0.2)
    assert row["height_error_frac"] == pytest.approx(4.0)


def test_a_run_explodes_when_it_gains_ten_times_its_start_also_from_below_zero():
    assert contact.blow_up_step(np.array([2.0, np.nextafter(22.0, 0.0), 22.0])) == 2
    assert contact.blow_up_step(np.array([-2.0, 17.9, 18.0])) == 2
    assert contact.blow_up_step(np.array([2.0, 21.9])) is None
    assert contact.blow_up_step(np.array([2.0, math.nan])) == 1
