"""exact, held to its promise: closed forms and another integrator."""

import numpy as np
import pytest

import contact
from contact import GRAVITY, build_scene, exact_run, run_model, scene_of
from curriculum.bench import events
from curriculum.bench.problems import bounce_motion, slide_motion
from curriculum.exact import simulate_exact, solve_lcp

G, R, INF = -GRAVITY, 0.1, np.inf
PILE = build_scene("pile", 1, 7, 0.3)


def run(scene, times):
    return simulate_exact(scene, np.asarray(times, float), GRAVITY)


@pytest.mark.parametrize("turns", [0.0, 1.0])
@pytest.mark.parametrize("contacts, rank, decades", [(1, 1, 0), (4, 4, 2), (6, 6, 6), (9, 4, 0)])
def test_pivots_end_where_each_contact_pushes_or_parts(contacts, rank, decades, turns):
    """s is the only one that does (W = J w J'), also where contacts depend on one another, and no
    pushes hold all of them (turns)."""
    rng = np.random.default_rng(contacts + decades)
    for _ in range(20):
        J = rng.normal(size=(contacts, rank))
        w = 10.0 ** rng.uniform(-decades, 0.0, rank)
        W, b = J * w @ J.T, J @ rng.normal(size=rank) + turns * rng.random(contacts)
        lam, *_ = solve_lcp(W, b)
        either = np.minimum(lam / (lam.max() or 1.0), (W @ lam + b) / np.abs(b).max())
        assert (lam >= 0.0).all() and np.abs(either).max() <= 1e-9  # one of the two is 0


@pytest.mark.parametrize("e, end", [(0.0, 4), (0.3, 4), (0.7, 4), (0.9, 4), (1.0, 4), (1.0, 400)])
def test_a_dropped_ball_follows_its_parabolas(e, end):
    """In contact.py, too, whose own exact is for balls over one another."""
    t = np.linspace(0.0, end, 801)
    for h in (0.9, 0.13):
        scene = scene_of(0.0, R + h, 0.7, restitution=e)
        for q in (run(scene, t)[0], exact_run(scene, t)[0]):
            off = np.abs(q[:, 1, 0] - R - bounce_motion(h, e, t)).max()
            assert off < (2e-13 if end < 5 else 1e-11)


def thrown(seed):
    """Three balls over one another, of unequal mass, thrown up and down."""
    rng = np.random.default_rng(seed)
    y = R + np.cumsum(rng.uniform(0.25, 0.5, 3)) - 0.2
    scene = scene_of([0.0] * 3, y, rng.uniform(0.5, 2.0, 3), restitution=(0.0, 0.5, 1.0)[seed % 3])
    scene.v0[1] = rng.uniform(-2.0, 1.0, 3)
    return scene


UNEQUAL = build_scene("stack", 2, 6)._replace(mass=np.array((0.01, 9.0, 0.02, 8.0, 0.01, 9.0)))
# the floor strikes the lower one 0.1 ms after the other has
AT_ONCE = scene_of(0.0, [1.0, 1.25], vy=[0.0, -0.05 / 0.42825], restitution=1.0)
HEAVY = {e: scene_of(0.0, [R, 0.5], [1.0, 100.0 + (e != 0.5)], restitution=e) for e in (0, 0.5, 1)}


@pytest.mark.parametrize("scene", [*map(thrown, range(6)), UNEQUAL, AT_ONCE, *HEAVY.values()])
def test_balls_over_one_another_run_as_in_contact_py(scene):
    """They share time_to_impact alone; of UNEQUAL masses contact.py's takes over 1,000 sweeps."""
    t = np.linspace(0.0, 1.0, 101)
    for here, there in zip(run(scene, t), exact_run(scene, t)):
        assert here == pytest.approx(there, abs=1e-10)


@pytest.mark.parametrize("start, end", [(0.3, 0.8), (1e-9, 1.0)])
def test_a_ball_that_slides_off_another_leaves_it_at_two_thirds(start, end):
    """Where cos theta = 2/3 cos theta0, as in the benchmark's reference, which integrates theta."""
    reach, floor, t = 2.0 * R, 2.0, np.linspace(0.0, end, 81)
    x, y = [0.0, reach * np.sin(start)], [floor, floor + reach * np.cos(start)]
    q, _ = run(scene_of(x, y, [INF, 1.0]), t)
    assert np.abs(q[:, :, 1] - slide_motion(start, reach, R, floor, t)).max() < 1e-10 * R


@pytest.mark.parametrize(
    "digits, hits, room", [(0, 3, 0.3), (1, 31, 1e-12), (2, 314, 1e-12), (3, 3141, 0.3)]
)  # room: of 1e-12 m gaps get ten times smaller than what would touch at rest
def test_blocks_count_the_digits_of_pi(digits, hits, room):
    """A ball of 100^digits comes, one of 1 waits, a fixed one is the wall (Galperin 2003)."""
    seen, x = [], [0.0, 2.0 * R + room, 4.0 * R + 2.0 * room]
    scene = scene_of(x, R, [INF, 1.0, 100.0**digits], vx=[0.0, 0.0, -1.0], restitution=1.0)
    simulate_exact(scene, np.array((0.0, 13.0 * room)), GRAVITY, seen.append)
    assert len(seen) == hits + 1  # an event for each, and the start


def test_the_answer_does_not_depend_on_when_it_is_sampled():
    scene, t = build_scene("pile", 1, 7, 0.3), np.linspace(0.0, 1.0, 701)
    fine, coarse, last = (run(scene, times) for times in (t, t[::7], t[[0, -1]]))
    assert np.array_equal(fine[0][::7], coarse[0]) and np.array_equal(fine[1][::7], coarse[1])
    assert np.array_equal(fine[0][-1], last[0][-1]) and np.array_equal(fine[1][-1], last[1][-1])


def test_a_ball_that_comes_down_beside_the_one_that_it_touched_grazes_it_without_a_blow():
    """At e = 0 it is at rest along the normal; rounding of the last digit would strike at 1e-8."""
    scene = scene_of([0.0, 2.0 * R], R, vy=[0.0, 1.9])
    q, v = run(scene, np.linspace(0.0, 1.0, 51))
    assert np.abs(q[:, 0] - scene.q0[0]).max() < 1e-12 and not v[:, 0].any()


def test_at_the_moment_of_an_impact_the_velocities_are_those_after_all_its_rounds():
    """The floor throws a ball up into another one that leaves too slowly: they change speeds."""
    pair = scene_of([0.0, 0.0], [R, 3.0 * R], restitution=1.0, vy=[-1.0, 0.5])
    assert run(pair, [0.0])[1][0, 1] == pytest.approx([0.5, 1.0], abs=1e-15)


@pytest.mark.parametrize("seed", [11, 15, 84])
def test_a_pyramid_of_unequal_balls_that_touch_neither_rattles_nor_sinks(seed):
    """Some are fixed. Forces with an error of 1e-10 let it sink by 1e-11 r, and then bounce."""
    rng, rows, events = np.random.default_rng(seed), enumerate((6, 5, 2)), []
    places = [(R * (k + 2.0 * np.arange(n)), np.full(n, R + k * R * 3**0.5)) for k, n in rows]
    x, y = np.hstack(places)
    mass = 10.0 ** rng.uniform(-1.0, 1.0, len(x))
    mass[rng.random(len(x)) < 0.2] = INF
    scene, t = scene_of(x, y, mass, restitution=1.0), np.linspace(0.0, 0.15, 70)
    q, _ = simulate_exact(scene, t, GRAVITY, events.append)
    assert len(events) < 10 and contact.smallest_gap(q, scene.radius).min() > -1e-13 * R


def test_a_heap_in_a_box_comes_to_rest_and_stays_for_hours():
    """What rounding leaves of v and a at rest is 0: else the heap creeps, by 1e-6 r in hours."""
    rng, k = np.random.default_rng(0), np.arange(6)
    x, y = k % 4 * 0.21 + 0.12 + rng.uniform(-0.005, 0.005, 6), 0.15 + 0.25 * (k // 4)
    x, y = [-R, -R, 0.95, 0.95, *x], [R, 3.0 * R, R, 3.0 * R, *(y + rng.uniform(0, 0.02, 6))]
    q, v = run(scene_of(x, y, [INF] * 4 + [1.0] * 6), [0.0, 60.0, 1e4])
    assert np.array_equal(q[1], q[2]) and not v[1:].any()


def test_blas_has_one_thread_while_exact_runs_and_then_those_it_had(monkeypatch):
    pools = pytest.importorskip("threadpoolctl")
    seen = []
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)

    def threads():
        return [
            each["num_threads"] for each in pools.threadpool_info() if each["user_api"] == "blas"
        ]

    with pools.threadpool_limits(2, "blas"):
        before = threads()
        simulate_exact(PILE, np.zeros(1), GRAVITY, lambda k: seen.extend(threads()))
        assert set(seen) == {1} and threads() == before


def test_balls_that_overlap_at_the_start_move_apart_and_their_centre_stays():
    """Also where they fly apart, so that nothing else would ever part them."""
    mass, radius = np.array((0.4, 3.7, 1.3)), np.array((0.07, 0.13, 0.09))
    scene = scene_of([0.0, 0.12, 0.27], [2.0, 2.1, 2.05], mass, radius, [-0.5, 0.0, 0.7])
    q, _ = run(scene, [0.0])
    before, after = (contact.smallest_gap(each, radius)[0] for each in (scene.q0[None], q))
    assert before < -0.05 and after >= -1e-12 * R
    assert q[0] @ mass == pytest.approx(scene.q0 @ mass, abs=1e-14)


# Five unequal balls, two of which fall between and onto three, and press them apart.
X, Y = [0.0, 0.27, 0.6, 0.12, 0.45], [0.1, 0.08, 0.12, 0.30, 0.33]
HEAP = scene_of(X, Y, [1.0, 0.7, 1.5, 0.8, 1.2], [0.1, 0.08, 0.12, 0.09, 0.1])
PILES = [(0, 3, 0.0, 2.0), (1, 6, 0.7, 1.0), (1, 8, 0.0, 1.0), (2, 7, 0.9, 1.0),
         (0, 12, 0.0, 1.0), (1, 12, 0.9, 0.6), (0, 24, 0.9, 0.45)]  # fmt: skip


@pytest.mark.parametrize("scene, end", [
    (HEAP, 0.3), *((build_scene("pile", *drawn), end) for *drawn, end in PILES),
])  # fmt: skip
def test_what_falls_and_slides_does_so_by_another_integrator(scene, end):
    """The benchmark's rival: DOP853 from event to event, who pushes by non-negative least squares.

    Until times at which a start shifted by 1e-15 m is still within 1e-9 r.
    """
    times = np.linspace(0.0, end, 5)
    off = run(scene, times)[0] - events.run(scene, times, G)[0]
    assert np.abs(off).max() < 1e-8 * R


TOO_HEAVY = HEAVY[1]._replace(restitution=0.5)
PRESS = scene_of(0.0, [R, 0.5], [1.0, INF], vy=[0.0, -1.0])
RATTLING = scene_of(0.0, R + 1e-8, restitution=0.999999)


@pytest.mark.parametrize("scene, most, words", [
    (TOO_HEAVY, 20_000, "101 : 1 at restitution 0.5; at most 100 : 1"),
    (PRESS, 20_000, "a ball is crushed between two fixed bodies"),
    (RATTLING, 300, "300 events by .*Zeno behaviour.*Take a shorter run"),
])  # fmt: skip
def test_beyond_the_promise_it_stops_with_one_clear_error(scene, most, words):
    with pytest.raises(RuntimeError, match=words):
        simulate_exact(scene, np.array((0.0, 4.0)), GRAVITY, most=most)


def test_the_reason_is_that_of_the_one_that_got_further():
    scene = build_scene("bounce", restitution=1.0 - 1e-12)
    with pytest.raises(RuntimeError, match="more than 20,000 impacts by 1[0-9]{4}"):
        run_model("exact", scene, 1.0, 20_000)
