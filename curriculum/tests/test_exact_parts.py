"""exact, function by function: each is held to arithmetic without rounding, to numpy or to a law.

Coefficients of a series are small whole numbers where a test compares with ==, so that doubles do
not round; where they are not, the answer is computed with fractions.
"""

import math
from fractions import Fraction
from itertools import combinations, product
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.polynomial import polynomial

from curriculum import exact
from curriculum.tests.test_exact_sliding import heap_of_five, on_a_movable_ball

R, G = 0.1, -9.81


def whole_numbers(rng, count):
    """So many numbers from -9 to 9, as floats."""
    return rng.integers(-9, 10, count).astype(float).tolist()


def value(p, t):
    """The sum of p[k] t^k as a fraction."""
    return sum(Fraction(part) * Fraction(t) ** k for k, part in enumerate(p))


# Time


def test_times_are_added_without_rounding():
    """A double of 1e-40 s beside one of 1e6 s: 2^300 units in a second hold both to the last bit."""
    spans, now, total = [1e6, 0.1, 1 / 3, 1e-40, math.pi], 0, Fraction(0)
    for span in spans:
        before, now = now, exact.later(now, span)
        total += Fraction(span)
        assert Fraction(now, exact.SECOND) == total
        assert exact.seconds(before, now) == span
    assert exact.seconds(now, 0) == -float(total)


def test_never_is_later_than_any_time():
    assert exact.later(7, math.inf) == math.inf


# Bodies


def test_a_body_keeps_its_velocity_until_its_first_event():
    body = exact.Body(1.0, R, [0.0, 2.0], [3.0, -4.0])
    assert body.at(0) == ((0.0, 2.0), (3.0, -4.0))
    assert body.at(exact.later(0, 0.5)) == ((1.5, 0.0), (3.0, -4.0))


def a_path(pieces):
    """A body that moved by these pieces (count, start, x, y), each for `count` samples."""
    body, done = exact.Body(1.0, R, [0.0, 0.0], [0.0, 0.0]), 0
    for count, start, x, y in pieces:
        body.start, body.x, body.y = exact.later(0, start), x, y
        done += count
        body.remember(done)
    return body


def test_samples_are_those_of_the_series_that_held_then():
    """Pieces of 3 and of ORDER + 1 numbers, and one that no sample falls into."""
    rng = np.random.default_rng(0)
    counts, starts = [1, 3, 0, 2], [0.0, 0.25, 1.0, 1.5]
    orders = [3, exact.ORDER + 1, 3, 3]
    series = [[whole_numbers(rng, n) for n in (order, order)] for order in orders]
    series[0][0][0] = series[0][1][0] = 0.0
    body = a_path((k, s, *rows) for k, s, rows in zip(counts, starts, series))
    times = np.array([0.0, 0.25, 0.5, 0.75, 1.5, 2.0])
    places, slopes = zip(*body.read(times))
    piece = np.repeat(range(4), counts)
    for row, (place, slope) in enumerate(zip(places, slopes)):
        for k, time in zip(piece, times):
            p = np.array(series[k][row])
            now = time - starts[k]
            at = int(np.flatnonzero(times == time)[0])
            assert place[at] == pytest.approx(float(value(p, now)), rel=1e-15, abs=0.0)
            rate = float(value(polynomial.polyder(p), now))
            assert slope[at] == pytest.approx(rate, rel=1e-15, abs=0.0)


def test_a_body_keeps_no_more_series_than_samples_need():
    body = a_path([(2, 0.0, [1.0] * 3, [1.0] * 3), (0, 0.5, [2.0] * 3, [2.0] * 3)])
    assert [count for count, *_ in body.path] == [2] and body.done == 2


# Pairs


def pair_at(place, other, radius=1.0, other_radius=2.0, w=1.0):
    """A located Pair of two balls, and its bodies."""
    i, j = (exact.Body(w, r, q, [0.0, 0.0]) for r, q in ((radius, place), (other_radius, other)))
    pair = exact.Pair(i, j)
    pair.locate({i: place, j: other})
    return pair, i, j


def over_the_floor(height, x=5.0, radius=1.0):
    """A located Pair of a ball and the floor."""
    return pair_at((x, height), (0.0, 0.0), radius, 0.0)


def test_two_balls_have_the_normal_and_the_gap_of_a_3_4_5_triangle():
    pair, *_ = pair_at((7.0, 5.0), (4.0, 1.0))
    assert (pair.nx, pair.ny, pair.depth) == (0.6, 0.8, -2.0) and not pair.wall
    pair, *_ = pair_at((4.0, 1.0), (7.0, 5.0))
    assert (pair.nx, pair.ny, pair.depth) == (-0.6, -0.8, -2.0)


def test_the_normal_between_balls_over_one_another_is_up_or_down_and_up_for_one_centre():
    for height, ny, depth in ((1.5, 1.0, 1.5), (-0.5, -1.0, 2.5), (0.0, 1.0, 3.0)):
        pair, *_ = pair_at((2.0, 3.0 + height), (2.0, 3.0))
        assert (pair.nx, pair.ny, pair.depth) == (0.0, ny, depth)


@pytest.mark.parametrize("height", [3.0, 1.0, 0.5, 0.0, -2.0])
def test_the_floor_is_flat_and_pushes_up_wherever_a_ball_is(height):
    pair, *_ = over_the_floor(height)
    assert (pair.nx, pair.ny, pair.depth) == (0.0, 1.0, 1.0 - height) and pair.wall


@pytest.mark.parametrize("where", [0.0, 1.0, 1e3, 1e9])
def test_balls_placed_in_touch_have_a_gap_that_counts_as_none(where):
    """Rounded coordinates are off by half a last bit; a gap that is none grows with these alone."""
    for angle in np.linspace(0.1, 3.0, 40):
        other = (where, 0.0)
        place = (where + 3.0 * math.cos(angle), 3.0 * math.sin(angle))
        pair, *_ = pair_at(place, other)
        assert abs(pair.depth) <= pair.small
        assert exact.TOUCH <= pair.small <= exact.TOUCH + 8.0 * math.ulp(where + 3.0)
        pair, *_ = pair_at(place[::-1], other[::-1])
        assert abs(pair.depth) <= pair.small


def test_a_gap_below_TOUCH_radii_of_the_first_ball_is_none():
    for radius in (2.0**-10, 2.0**10):
        gap = exact.TOUCH * radius
        small = over_the_floor(0.0, x=0.0, radius=radius)[0].small
        assert gap <= small <= 1.01 * gap


def test_normal_and_tangential_velocity_are_the_two_parts_of_the_difference():
    rng = np.random.default_rng(1)
    for _ in range(10):
        pair, i, j = pair_at(tuple(whole_numbers(rng, 2)), (0.5, 0.5))
        a, b = rng.normal(size=(2, 2))
        rows, n = {i: tuple(a), j: tuple(b)}, np.array((pair.nx, pair.ny))
        assert pair.along(rows) == pytest.approx(n @ (a - b), rel=1e-14)
        assert pair.across(rows) == pytest.approx(n[0] * (a - b)[1] - n[1] * (a - b)[0], rel=1e-14)
        assert pair.along(rows) ** 2 + pair.across(rows) ** 2 == pytest.approx(
            (a - b) @ (a - b), rel=1e-13
        )


def test_the_gap_of_two_free_balls_in_touch_widens_by_what_the_normal_turns():
    """The second derivative of |d + u t| at t = 0, by a difference of large numbers of digits."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        angle = rng.uniform(0.0, 6.0)
        pair, i, j = pair_at((3.0 * math.cos(angle), 3.0 * math.sin(angle)), (0.0, 0.0))
        u = rng.normal(size=2)
        rows, h = {i: tuple(u), j: (0.0, 0.0)}, 1e-4
        d = np.array((pair.nx, pair.ny)) * 3.0
        apart = [math.hypot(*(d + t * u)) for t in (-h, 0.0, h)]
        second = (apart[0] - 2.0 * apart[1] + apart[2]) / h**2
        assert pair.turning(rows) == pytest.approx(second, abs=3e-6)


def test_the_floors_normal_never_turns():
    pair, i, j = over_the_floor(1.0)
    rows = {i: (3.0, -4.0), j: (0.0, 0.0)}
    assert pair.along(rows) == -4.0 and pair.across(rows) == 0.0 == pair.turning(rows)


# Series in time


def test_a_series_is_evaluated_as_its_sum():
    rng = np.random.default_rng(3)
    for order in (1, 2, 3, 6, exact.ORDER + 1):
        p = whole_numbers(rng, order)
        for t in (0.0, 0.5, -1.0, 2.0):
            assert exact.evaluate(p, t) == value(p, t)
    times = np.array([0.5, 2.0])
    assert exact.evaluate([1.0, 2.0, 3.0], times).tolist() == [2.75, 17.0]


def test_the_rate_is_the_derivative():
    p = whole_numbers(np.random.default_rng(4), 9)
    assert exact.rate(p) == polynomial.polyder(p).tolist()


@pytest.mark.parametrize("order", [2, 3, 7])
def test_a_shifted_series_has_the_same_values_a_time_later(order):
    p = whole_numbers(np.random.default_rng(5), order)
    for s in (0.0, 1.0, -0.5, 2.0):
        moved = exact.shifted(p, s)
        assert len(moved) == order
        assert all(value(moved, t) == value(p, t + s) for t in range(order + 1))
    assert p is not exact.shifted(p, 0.0)


def test_the_difference_of_series_of_any_length():
    assert exact.difference([5.0, 4.0, 3.0], [1.0, 2.0]) == [4.0, 2.0, 3.0]
    assert exact.difference([5.0], [1.0, 2.0, 7.0]) == [4.0, -2.0, -7.0]


def test_a_parabola_has_the_position_the_velocity_and_the_acceleration():
    for row, series in enumerate(exact.parabola((1.0, 2.0), (3.0, 4.0), (5.0, 6.0))):
        rate = exact.rate(series)
        told = [exact.evaluate(p, 0.0) for p in (series, rate, exact.rate(rate))]
        assert told == [1.0 + row, 3.0 + row, 5.0 + row]


def test_nothing_goes_further_than_it_reaches():
    """|x(t) - x(0)| + |y(t) - y(0)| <= speed t + bend t^2, with = at the end where all goes up."""
    rng = np.random.default_rng(6)
    for order, span in ((3, 2.0), (6, 0.5), (6, 2.0)):
        x, y = rng.normal(size=(2, order))
        speed, bend = exact.reaches(x.tolist(), y.tolist(), span)
        for t in np.linspace(0.0, span, 50):
            far = sum(abs(float(value(p, t) - Fraction(p[0]))) for p in (x, y))
            assert far <= (speed * t + bend * t * t) * (1.0 + 1e-14)
        up, down = np.abs(x).tolist(), (-np.abs(y)).tolist()
        speed, bend = exact.reaches(up, down, span)
        far = float(value(up, span) - Fraction(up[0]) - value(down, span) + Fraction(down[0]))
        assert speed * span + bend * span * span == pytest.approx(far, rel=1e-14)


# The first root


def test_a_parabola_falls_through_zero_at_its_first_root():
    for value_, slope, bend, expected in (
        (0.0, 0.0, -1.0, 0.0),  # rests on zero and accelerates downwards
        (0.0, -1.0, 0.0, 0.0),
        (0.0, 2.0, -1.0, 2.0),  # leaves zero and comes back
        (3.0, -4.0, 1.0, 1.0),
        (3.0, 2.0, -1.0, 3.0),
        (4.0, -4.0, 1.0, 2.0),  # touches zero
        (0.01, -0.2, 0.75, 1.0 / 15.0),
        (6.0, -2.0, 0.0, 3.0),
        (1.0, 0.0, -0.25, 2.0),
    ):
        assert exact.fall(value_, slope, bend) == pytest.approx(expected, rel=1e-15, abs=0.0)


def test_a_parabola_that_stays_above_zero_never_falls():
    for value_, slope, bend in (
        (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 0.25), (0.0, 1.0, 0.5), (1.0, -1.0, 1.0),
        (1.0, -0.5, 0.1), (0.0, 0.0, 0.0),
    ):  # fmt: skip
        assert exact.fall(value_, slope, bend) == math.inf


def test_a_falling_root_keeps_its_digits_where_the_bend_is_small():
    """2 value / (root - slope) for slope < 0: the other form would lose all digits here."""
    assert exact.fall(1.0, -1.0, 1e-20) == 1.0
    assert exact.fall(1e-20, -1.0, -1.0) == pytest.approx(1e-20, rel=1e-15)


@pytest.mark.parametrize("order", [3, 5])
def test_the_lower_bound_of_a_parabola_is_its_least_value(order):
    """At an end or at the vertex; also where a series is longer and has zeros from there."""
    rng = np.random.default_rng(7)
    for _ in range(200):
        p = [*(rng.normal(size=3) * [1.0, 1.0, 0.5]).tolist(), *[0.0] * (order - 3)]
        t, horizon = np.sort(rng.uniform(-2.0, 3.0, 2)).tolist()
        values = polynomial.polyval(np.linspace(t, horizon, 2001), p)
        within = abs(p[2]) * ((horizon - t) / 2000.0) ** 2 + 1e-14
        assert values.min() - within <= exact.lower_bound(p, t, horizon) <= values.min() + 1e-14
    assert exact.lower_bound([1.0, -1.0, 0.0], 0.0, 2.0) == -1.0


def test_the_lower_bound_of_a_longer_series_is_one():
    rng = np.random.default_rng(8)
    for _ in range(50):
        p = rng.normal(size=6).tolist()
        t, horizon = np.sort(rng.uniform(0.0, 2.0, 2)).tolist()
        values = polynomial.polyval(np.linspace(t, horizon, 500), p)
        assert exact.lower_bound(p, t, horizon) <= values.min() + 1e-12


def test_the_lower_bound_is_reached_where_all_falls_to_the_end():
    for p, least in (
        ([0.0, 0.0, 0.0, -1.0], -8.0),
        ([0.0, 0.0, 0.0, -1.0, 0.0], -8.0),
        ([5.0, -1.0, -2.0, 0.0, -3.0], 5.0 - 2.0 - 8.0 - 48.0),
        ([0.0, -4.0, 1.0, -1.0], -12.0),
    ):
        assert exact.lower_bound(p, 1.0, 2.0) == least == value(p, 2.0)


def falling_through(roots, rise=1.0):
    """A series above 0 at t = 0 with these roots: 3 numbers for a parabola, or 5 at least."""
    p = polynomial.polyfromroots(roots) * rise
    p = np.append(p, np.zeros(max(0, (3 if len(p) < 4 else 5) - len(p))))
    return (p if p[0] > 0.0 else -p).tolist()


@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e6])
@pytest.mark.parametrize(
    "roots",
    [[1.0], [1.0, 2.0], [1.0, 1.05], [1.0, 1.05, 40.0], [1.0, 1.3, 1.6], [1.0, 3.0, -2.0, -5.0]],
)
def test_the_first_root_is_found_at_any_scale(roots, scale):
    """Pairs of roots close together lie where the curvature turns the series back: a step that is a
    little too long would miss both."""
    p = falling_through([scale * root for root in roots], scale ** -len(roots))
    t = exact.first_fall(p, 1.5 * scale)
    assert t == pytest.approx(scale, rel=1e-13 / min([1.0, *np.diff(sorted(map(abs, roots)))]))
    assert exact.first_fall(p, 0.9 * scale) == math.inf


def test_the_first_of_many_roots_of_random_series_is_found():
    rng = np.random.default_rng(9)
    found = 0
    for _ in range(200):
        p = rng.normal(size=int(rng.integers(5, 9)))
        p[0] = abs(p[0])
        every = polynomial.polyroots(p)
        real = [z.real for z in every if abs(z.imag) < 1e-9 and 0.0 <= z.real <= 1.0]
        close = [z for z in every if 0.0 < abs(z.imag) < 1e-3]
        if close or np.min(np.diff(sorted(real)), initial=1.0) < 1e-3:
            continue  # a double root: rounding decides
        expected = min(real, default=math.inf)
        found += bool(real)
        assert exact.first_fall(p.tolist(), 1.0) == pytest.approx(expected, rel=1e-9)
    assert found > 50


def test_a_root_at_the_horizon_counts():
    for p in ([1.0, -1.0, 0.0], [1.0, -1.0, 0.0, 0.0], [1.0, -1.0, 0.0, 1e-300, 0.0]):
        assert exact.first_fall(p, 1.0) == 1.0
        assert exact.first_fall(p, np.nextafter(1.0, 0.0)) == math.inf


def test_only_one_of_the_higher_orders_is_enough_to_matter():
    """1 - t^3 and 1 - t^4 fall at 1; without their last orders they never would."""
    for p in ([1.0, 0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0, -1.0]):
        assert exact.first_fall(p, 2.0) == pytest.approx(1.0, rel=1e-14)


def test_a_series_that_starts_at_zero_and_falls_has_its_root_there():
    assert exact.first_fall([0.0, -1.0, 0.0, 2.0, 0.0], 1.0) == 0.0


# The calendar


class Due:
    """Something that can be planned, and the bodies it concerns."""

    def __init__(self, *bodies):
        self.due, self.bodies = math.inf, bodies


def body(w=1.0):
    return exact.Body(w, R, [0.0, 1.0], [0.0, 0.0])


def test_what_is_due_comes_in_the_order_of_time_and_ties_in_that_of_planning():
    calendar, balls = exact.Calendar(), [body() for _ in range(6)]
    for time, ball in zip((5, 3, 5, 9, 3, 5), balls):
        calendar.plan(time, Due(ball))
    assert calendar.next() == 3
    assert calendar.woken(4) == [balls[1], balls[4]]
    assert calendar.woken(5) == [balls[0], balls[2], balls[5]]
    assert calendar.next() == 9 and calendar.woken(8) == []


def test_a_change_of_plan_leaves_nothing_of_the_old_one():
    calendar, ball, other = exact.Calendar(), body(), body()
    first, second = Due(ball), Due(other)
    calendar.plan(1, first)
    calendar.plan(2, second)
    calendar.plan(7, first)
    assert calendar.next() == 2 and calendar.woken(2) == [other]
    calendar.plan(math.inf, first)
    assert calendar.next() == math.inf and calendar.woken(math.inf) == []
    assert not calendar.heap


def test_what_never_happens_takes_no_room():
    calendar = exact.Calendar()
    for _ in range(5):
        calendar.plan(math.inf, Due(body()))
    assert not calendar.heap


def test_an_event_wakes_the_balls_it_concerns_that_can_move():
    calendar, light, heavy, fixed = exact.Calendar(), body(2.0), body(1e-3), body(0.0)
    calendar.plan(1, Due(light, fixed))
    calendar.plan(2, Due(heavy, light))
    assert calendar.woken(2) == [light, heavy, light]


# Homes


def random_motion(seed, count=40):
    """A Motion of balls of different sizes, every fifth fixed, and its scene."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.02, 0.1, count)
    mass = np.where(np.arange(count) % 5 == 4, np.inf, rng.uniform(0.1, 10.0, count))
    q0 = rng.uniform(0.0, 1.5, (2, count))
    scene = heap_of_five()[0]._replace(q0=q0, v0=np.zeros_like(q0), mass=mass, radius=radius)
    return exact.Motion(scene, G), scene


def hold_neighbours(motion):
    """Two balls are neighbours if they can meet while both stay within their room, at least one of
    which can move; and of the floor is neighbour who can reach it. The lower number is first."""
    balls = motion.balls
    room = [ball.radius + ball.room for ball in balls]
    for (k, one), (m, other) in combinations(enumerate(balls), 2):
        apart = math.dist(one.home, other.home)
        meets = apart <= room[k] + room[m] and (one.w > 0.0 or other.w > 0.0)
        assert (other in one.near) == meets == (one in other.near)
        if meets:
            pair = one.near[other]
            assert pair is other.near[one] and (pair.i, pair.j) == (one, other)
    for k, ball in enumerate(balls):
        reaches = ball.w > 0.0 and ball.home[1] <= room[k]
        assert (motion.floor in ball.near) == reaches == (ball in motion.floor.near)
        if reaches:
            assert (ball.near[motion.floor].i, ball.near[motion.floor].j) == (ball, motion.floor)


@pytest.mark.parametrize("seed", range(3))
def test_neighbours_are_all_that_can_meet_and_no_others(seed):
    motion, scene = random_motion(seed)
    assert [ball.w for ball in motion.balls] == (1.0 / scene.mass).tolist()
    assert all(ball.room == (exact.ROOM * ball.radius if ball.w else 0.0) for ball in motion.balls)
    hold_neighbours(motion)
    rng = np.random.default_rng(seed)
    for k in rng.permutation(len(motion.balls)):
        if motion.balls[k].w > 0.0:
            motion.move_home(motion.balls[k], tuple(rng.uniform(0.0, 1.5, 2).tolist()))
    hold_neighbours(motion)


def test_a_contact_that_is_out_of_reach_is_due_no_more():
    motion, _ = random_motion(0)
    ball = next(ball for ball in motion.balls if ball.w > 0.0 and len(ball.near) > 1)
    kept = list(ball.near.values())
    for contact in kept:
        motion.calendar.plan(1, contact)
    motion.move_home(ball, (100.0, 100.0))
    assert not ball.near and all(contact.due == math.inf for contact in kept)
    assert motion.calendar.woken(2) == []


def test_a_neighbour_that_stays_one_keeps_its_contact_and_what_happened_to_it():
    motion, _ = random_motion(1)
    ball = next(ball for ball in motion.balls if ball.w > 0.0 and len(ball.near) > 1)
    before = dict(ball.near)
    motion.move_home(ball, ball.home)
    assert ball.near == before


def test_few_balls_look_at_all_others_and_one_more_than_FEW_only_near_home():
    for count, room in ((exact.FEW, math.inf), (exact.FEW + 1, exact.ROOM * R)):
        q0 = np.array((np.arange(count) * 9.0, np.full(count, 50.0)))
        scene = heap_of_five()[0]._replace(
            q0=q0, v0=np.zeros_like(q0), mass=np.ones(count), radius=np.full(count, R)
        )
        motion = exact.Motion(scene, G)
        assert {ball.room for ball in motion.balls} == {room}
        assert {len(ball.near) for ball in motion.balls} == {count if room == math.inf else 0}


def test_a_ball_is_due_when_it_may_leave_home():
    """Straight up at 3 m/s it is its room from home after room / 3 s, and with an acceleration
    along its way after the root of 3 t + 5 t^2 = room."""
    room = exact.ROOM * R
    bent = (math.sqrt(9.0 + 20.0 * room) - 3.0) / 10.0
    for x, y, span in (
        ([0.0, 0.0, 0.0], [5.0, 3.0, 0.0], room / 3.0),
        ([0.0, -3.0, -5.0], [5.0, 0.0, 0.0], bent),
        ([0.4 * room, 0.0, 0.0], [5.0, 3.0, 0.0], 0.6 * room / 3.0),  # 0.4 of it are used up
        ([0.6 * room, 3.0, 0.0], [5.0, 0.0, 0.0], room / 3.0),  # over half of it: a new home
    ):
        ball, motion = one_of_many()
        motion.go_on(ball, exact.later(0, 1.0), x, y, math.inf)
        assert exact.seconds(exact.later(0, 1.0), ball.due) == pytest.approx(span, rel=1e-12)
        assert motion.calendar.next() == ball.due and ball.start == exact.later(0, 1.0)
        assert tuple(ball.home) == ((x[0], 5.0) if x[0] > 0.5 * room else (0.0, 5.0))
        motion.go_on(ball, 0, x, y, 0.001)
        assert ball.due == exact.later(0, 0.001)


def one_of_many():
    """A ball with its home at (0, 5), and the Motion of it and of others far away."""
    count = exact.FEW + 1
    q0 = np.array((np.arange(count) * 9.0, np.full(count, 5.0)))
    scene = heap_of_five()[0]._replace(
        q0=q0, v0=np.zeros_like(q0), mass=np.ones(count), radius=np.full(count, R)
    )
    motion = exact.Motion(scene, G)
    return motion.balls[0], motion


def test_a_ball_among_few_is_due_only_when_its_series_ends():
    motion = exact.Motion(heap_of_five()[0], G)
    ball = motion.balls[0]
    motion.go_on(ball, 0, [0.0, 3.0, 0.0], [9.0, 0.0, 0.0], math.inf)
    assert ball.due == math.inf and motion.calendar.next() == math.inf
    motion.samples = 4
    motion.go_on(ball, 5, [1.0, 3.0, 0.0], [9.0, 0.0, 0.0], 2.0)
    assert ball.due == 5 + 2 * exact.SECOND
    assert ball.path == [(4, 0, [0.0, 3.0, 0.0], [9.0, 0.0, 0.0])]


# Contacts: what happened to them


def contact_over_the_floor(radius=R):
    """A Contact of a ball that lies on the floor."""
    ball = exact.Body(1.0, radius, [0.0, radius], [0.0, 0.0])
    floor = exact.Body(0.0, 0.0, [0.0, 0.0], [0.0, 0.0])
    contact = exact.Contact(ball, floor, G)
    contact.locate({ball: (0.0, radius), floor: (0.0, 0.0)})
    return contact


@pytest.mark.parametrize("radius", [1e-3, 0.1, 20.0])
def test_a_bounce_is_slow_when_it_rises_less_than_LAST_radii(radius):
    """With v it rises v^2 / (2 g)."""
    contact = contact_over_the_floor(radius)
    for rise, slow in ((0.99 * exact.LAST, True), (1.01 * exact.LAST, False)):
        v_n = math.sqrt(-2.0 * G * rise * radius)
        assert contact.is_slow(v_n) == contact.is_slow(-v_n) == slow


@pytest.mark.parametrize("radius", [1e-3, 0.1, 20.0])
def test_bodies_approach_when_their_speed_is_above_round_off(radius):
    """Round-off is measured by the speed after a fall of half a radius."""
    contact, fallen = contact_over_the_floor(radius), math.sqrt(-2.0 * G * 0.5 * radius)
    assert contact.closes(-1.01 * exact.NOISE * fallen) and contact.closes(-1.0)
    assert not contact.closes(-0.99 * exact.NOISE * fallen) and not contact.closes(0.0)
    assert not contact.closes(1.0)


@pytest.mark.parametrize("radius", [1e-3, 0.1, 20.0])
def test_bodies_part_when_their_speed_is_above_round_off(radius):
    contact, fallen = contact_over_the_floor(radius), math.sqrt(-2.0 * G * 0.5 * radius)
    assert contact.parts(1.01 * exact.NOISE * fallen) and contact.parts(1.0)
    assert not contact.parts(0.99 * exact.NOISE * fallen) and not contact.parts(-1.0)


def test_a_bound_of_how_far_a_contact_was_open_is_one_and_no_more_than_8_times_too_much():
    """Parting with v it is v^2 / (2 g) open at most, and closes with v after 2 v / g."""
    for v in (1e-8, 0.3, 20.0):
        contact = contact_over_the_floor()
        contact.touched(5, v)
        widest = contact.opened(exact.later(5, -2.0 * v / G), -v)
        assert -0.5 * v * v / G <= widest <= -4.01 * v * v / G
    assert contact_over_the_floor().opened(0, -1.0) == math.inf  # it has never touched


def test_a_contact_that_still_closes_when_it_touched_has_not_hardly_opened():
    contact = contact_over_the_floor()
    contact.touched(5, -1.0)
    assert contact.last_touch == 5 and contact.opened(6, -1.0) == math.inf


def test_a_contact_at_rest_has_no_gap_whatever_its_place_says():
    for rests, gap in ((True, 0.0), (False, 1e-12)):
        contact = contact_over_the_floor()
        contact.rests = rests
        contact.touched(5, 0.0)
        contact.look({contact.i: (0.0, R + 1e-12), contact.j: (0.0, 0.0)}, exact.later(5, 1.0))
        assert -contact.depth == pytest.approx(gap, abs=1e-16)


@pytest.mark.parametrize("height", [R, 100.0 * R])
def test_a_contact_that_rests_and_does_not_push_is_followed_from_no_gap(height):
    """Two balls stand, or fall, beside one another, 0.4 TOUCH radii apart: after their event that
    is none."""
    scene = row_of_balls([0.0, 2.0 + 0.4 * exact.TOUCH], [1.0, 2.0], height)
    motion = exact.Motion(scene, G)
    first, second = motion.balls
    contact = first.near[second]
    exact.event(motion, 0, first)
    assert contact.rests and not contact.pushes
    now = exact.later(0, 2.0**-6)
    contact.look({ball: ball.at(now)[0] for ball in motion.balls}, now)
    assert contact.depth == 0.0


def opened(contact, share, now):
    """Let it have parted so that, closing at `now`, it has opened this many THIN radii at most."""
    span = share * exact.THIN * contact.i.radius / 2e-3
    contact.touched(now - int(span * exact.SECOND), 1e-3)
    return contact


def thin(now, *contacts, v_n=-1e-3):
    return exact.hardly_opened(SimpleNamespace(now=now), contacts, [v_n] * len(contacts))


def test_a_contact_that_closes_and_has_opened_less_than_THIN_radii_has_hardly_opened():
    now = exact.later(0, 1.0)
    for radius in (0.01, 3.0):
        little, more = (
            opened(contact_over_the_floor(radius), share, now) for share in (0.99, 1.01)
        )
        assert thin(now, little, more) == [True, False]
        assert (little.thin, more.thin) == (now, -math.inf)
        assert thin(now, opened(contact_over_the_floor(), 0.5, now), v_n=1e-3) == [False]


@pytest.mark.parametrize("share, stops", [(9.9e3, True), (10.1e3, False)])
def test_once_one_has_hardly_opened_so_have_those_open_just_then_by_1e4_times_more(share, stops):
    """The one that stopped touched at that time, so it was not open: for it THIN stays THIN."""
    now = exact.later(0, 1.0)
    other, stopped = opened(contact_over_the_floor(), share, now), contact_over_the_floor()
    before = (other.last_touch + now) // 2
    assert thin(before, opened(stopped, 0.5, before)) == [True] and stopped.thin == before
    stopped.touched(before, 0.0)
    assert thin(now, stopped, other) == [False, stops]


# Islands


def scattered_balls(seed):
    """A Motion of balls on a lattice with a step of 2 r, some of which are fixed and some missing:
    neighbours touch, or are 0.4 or 2.5 times TOUCH radii apart, as its row says."""
    rng = np.random.default_rng(seed)
    places = [(k, m) for k in range(6) for m in range(5) if rng.random() < 0.75]
    x, y = np.transpose(places) * 2.0 * R
    y += rng.choice([0.0, 0.4, 2.5], 5).cumsum()[np.array(places)[:, 1]] * exact.TOUCH * R
    mass = np.where(rng.random(len(x)) < 0.15, np.inf, 10.0 ** rng.uniform(-2.0, 2.0, len(x)))
    q0 = np.array((x, y + R + rng.choice([0.0, 1.0])))
    scene = heap_of_five()[0]._replace(
        q0=q0, v0=rng.normal(size=q0.shape), mass=mass, radius=np.full(len(x), R)
    )
    return exact.Motion(scene, G)


def hangs_together(motion, ball, due):
    """The balls that can be reached from one through balls that move, by touch or what is due."""
    found, new = set(), {ball}
    while new:
        found |= new
        new = {
            other
            for one in found
            for other, contact in one.near.items()
            if other.w > 0.0
            and (contact in due or math.dist(one.home, other.home) < 2.0 * R * (1.0 + exact.TOUCH))
        } - found
    return found


@pytest.mark.parametrize("seed", range(8))
def test_an_island_is_what_hangs_together_by_touch_or_by_what_is_due(seed):
    motion, rng = scattered_balls(seed), np.random.default_rng(seed)
    now = exact.later(0, 1e-16)  # in which nothing moves that could be seen
    every = list(dict.fromkeys(contact for b in motion.balls for contact in b.near.values()))
    due = [every[k] for k in rng.integers(0, len(every), 3)]
    for contact, time in zip(due, (now, now, now - 5)):
        motion.calendar.plan(time, contact)
    motion.calendar.plan(now + 1, next(contact for contact in every if contact not in due))
    for ball in motion.balls:
        if ball.w > 0.0:
            island = exact.Island(now, ball)
            assert set(island.balls) == hangs_together(motion, ball, due)
            near = {contact for b in island.balls for contact in b.near.values()}
            assert set(island.contacts) == near
            bodies = {body for contact in near for body in contact.bodies} | {ball}
            assert set(island.q) == set(island.v) == bodies
            assert all((island.q[b], island.v[b]) == b.at(now) for b in bodies)


def island_of(scene):
    """The island of the first ball that moves, at the start, and its Motion."""
    motion = exact.Motion(scene, G)
    return exact.Island(0, next(ball for ball in motion.balls if ball.w > 0.0)), motion


def row_of_balls(x, mass, height=10.0):
    """Balls at rest beside one another, high above the floor; x in radii."""
    q0 = np.array((np.array(x) * R, np.full(len(x), height)))
    return heap_of_five()[0]._replace(
        q0=q0, v0=np.zeros_like(q0), mass=np.array(mass, float), radius=np.full(len(x), R)
    )


def test_what_counts_as_a_gap_is_as_small_as_the_balls_are():
    """Over the floor, too, which is no place with digits of its own."""
    scene = row_of_balls([0.0, 2.0], [1.0, 2.0], height=R)
    scene = scene._replace(q0=scene.q0 * 2.0**-30, radius=scene.radius * 2.0**-30)
    island, _ = island_of(scene)
    assert len(island.contacts) == 3
    for contact in island.contacts:
        assert contact.small <= 1.01 * exact.TOUCH * R * 2.0**-30


def test_an_island_is_quiet_for_as_long_as_nothing_has_happened_to_any_of_its_balls():
    motion = exact.Motion(row_of_balls([0.0, 2.0, 4.0], [1.0, 2.0, 3.0]), G)
    for ball, start in zip(motion.balls, (0.25, 0.5, 0.0)):
        ball.start = exact.later(0, start)
    assert exact.Island(exact.later(0, 1.0), motion.balls[0]).quiet() == 0.5


def test_an_overlap_is_closed_by_moving_the_heavy_ball_less():
    """0.6 r: 1 kg moves by three quarters of it and 3 kg by one, so that their centre stays."""
    island, motion = island_of(row_of_balls([0.0, 1.4], [1.0, 3.0]))
    exact.separate(island)
    (contact,) = (c for c in island.contacts if not c.wall)
    assert abs(contact.depth) <= contact.small
    x = [island.q[ball][0] / R for ball in motion.balls]
    assert x == pytest.approx([-0.45, 1.55], abs=1e-12)
    assert all(island.q[ball][1] == 10.0 for ball in motion.balls)


def test_an_overlap_with_what_is_fixed_is_closed_by_the_other_ball_alone():
    island, motion = island_of(row_of_balls([0.0, 1.4], [np.inf, 3.0]))
    exact.separate(island)
    assert [island.q[ball][0] / R for ball in motion.balls] == pytest.approx([0.0, 2.0], abs=1e-12)
    assert list(island.balls) == [motion.balls[1]]
    island, motion = island_of(row_of_balls([0.0], [3.0], height=0.5 * R))
    exact.separate(island)
    assert island.q[motion.balls[0]] == pytest.approx((0.0, R), abs=1e-15)
    assert list(island.balls) == motion.balls


@pytest.mark.parametrize("gap, balls", [(0.5, 2), (0.45, 2), (0.35, 3), (0.1, 3)])
def test_balls_are_moved_with_an_overlap_when_they_are_nearer_than_twice_its_depth(gap, balls):
    """An overlap of 0.2 r, and a heavy ball behind a gap: each ball of the overlap moves by 0.1 r,
    so that the third is pushed only when it is nearer than that."""
    island, motion = island_of(row_of_balls([0.0, 1.8, 3.8 + gap], [2.0, 2.0, 50.0]))
    exact.separate(island)
    assert set(island.balls) == set(motion.balls[:balls])
    assert motion.floor not in island.balls
    third = island.q.get(motion.balls[2])
    if gap > 0.1:
        assert third is None or third[0] / R == pytest.approx(3.8 + gap, abs=1e-13)
    x = [island.q[ball][0] / R for ball in motion.balls[:2]]
    assert x == pytest.approx([-0.1, 1.9], abs=1e-12)


def test_where_nothing_overlaps_nothing_is_moved_and_no_digit_of_a_gap_is_lost():
    island, motion = island_of(row_of_balls([0.0, 2.0, 4.0], [1.0, 2.0, 3.0], height=R))
    before = dict(island.q)
    touching = [contact for contact in island.contacts if abs(contact.depth) <= contact.small]
    for contact in touching:
        contact.depth = -1e-20
        contact.follow(0, [contact.nx * contact.reach], [contact.ny * contact.reach])
    exact.separate(island)
    for contact in touching:
        contact.look(island.q, 0)
        assert -contact.depth == pytest.approx(1e-20, rel=1e-12, abs=0.0)
    assert len(touching) == 5
    assert island.q == before


def test_of_small_gaps_only_those_touch_that_hardly_were_wider():
    """A gap is none below TOUCH radii, and below a ten thousandth of what it was open before."""
    for parting, gap, touches in (
        (None, 0.5, True), (None, 2.5, False), (1e-9, 0.5, True), (1e-9, 2.5, False),
        (0.9e-9, 0.5, True), (1e-10, 0.5, False), (1e-10, 0.04, True), (1e-10, -0.5, True),
    ):  # fmt: skip
        island, _ = island_of(row_of_balls([0.0], [1.0], height=R + gap * exact.TOUCH * R))
        (contact,) = island.contacts
        if parting is not None:  # one second ago, so open by as many metres at most
            contact.last_touch, contact.parting = -exact.SECOND, parting
        assert (contact in exact.touching(island)) == touches, (parting, gap)


def test_a_contact_that_rests_or_is_due_touches_whatever_its_gap():
    for gap in (0.9, 2.5):
        for note, touches in (("rests", gap < 1.0), ("due", True), ("none", False)):
            island, motion = island_of(row_of_balls([0.0], [1.0], height=R + gap * exact.TOUCH * R))
            (contact,) = island.contacts
            contact.last_touch = 0  # opened by nothing since
            contact.rests = note == "rests"
            motion.calendar.plan(0 if note == "due" else 1, contact)
            assert (contact in exact.touching(island)) == touches, (gap, note)


@pytest.mark.parametrize("v_n, pushes, touches", [
    (0.0, False, True), (0.5, False, True), (2.0, False, False), (2.0, True, True),
])  # fmt: skip
def test_a_contact_at_rest_that_does_not_push_has_let_go_once_it_parts(v_n, pushes, touches):
    """v_n in units of round-off; it rested a second ago, and is open by less than TOUCH radii."""
    scene = row_of_balls([0.0], [1.0], height=R + 0.5 * exact.TOUCH * R)
    speed = v_n * exact.NOISE * math.sqrt(-G * R)
    island, _ = island_of(scene._replace(v0=np.array([[0.0], [speed]])))
    (contact,) = island.contacts
    contact.last_touch, contact.rests, contact.pushes = -exact.SECOND, True, pushes
    assert (contact in exact.touching(island)) == touches


def test_a_ball_at_rest_that_stays_at_rest_keeps_its_series_and_what_is_due():
    """A tower of three, of which the last is let fall: the impact lifts it, and moves no other."""
    scene = row_of_balls([0.0, 0.0, 0.0], [1.0, 1.0, 1.0])
    scene = scene._replace(
        q0=np.array((np.zeros(3), R * np.array([1.0, 3.0, 5.2]))), restitution=0.5
    )
    motion = exact.Motion(scene, G)
    for ball in motion.balls:
        exact.event(motion, 0, ball)
    now = motion.calendar.next()
    exact.event(motion, now, motion.balls[2])
    assert [ball.start for ball in motion.balls] == [0, 0, now]
    assert motion.balls[2].y[1] > 0.0 and all(ball.y[1:] == [0.0, 0.0] for ball in motion.balls[:2])


def test_series_that_are_needed_for_a_shorter_time_have_fewer_terms_and_lead_to_the_same_place():
    scene, contacts, _ = next(sliding_scenes())
    _, held, q, v = held_group(scene, contacts)
    bodies, full, forces, span = exact.slide(held, q, v, G, math.inf)
    assert len(full) == exact.ORDER + 1
    for enough in 1e-6, 1e-5, 1e-4:
        _, Q, lam, lasts = exact.slide(held, q, v, G, enough)
        assert enough < lasts < span and len(lam) == len(Q) - 2 < len(forces)
        assert np.array_equal(Q, full[: len(Q)]) and np.array_equal(lam, forces[: len(lam)])
        for short, long in ((Q, full), (exact.rate(Q), exact.rate(full))):
            error = np.abs(exact.evaluate(short, lasts) - exact.evaluate(long, lasts)).max()
            assert error < exact.CUT * math.sqrt(-G * R)


def test_the_rates_of_the_last_two_terms_stay_below_CUT_and_twice_as_long_one_would_not():
    """Of bodies of different sizes, of which the fixed one does not count."""
    bodies = [
        exact.Body(w, r, [0.0, 0.0], [0.0, 0.0]) for w, r in ((0.5, 0.1), (9.0, 3.0), (0.0, R))
    ]
    limit = exact.CUT * np.sqrt(-G * np.array([0.1, 3.0, math.inf]))
    rng = np.random.default_rng(17)
    for k in rng.integers(5, 14, 300).tolist():
        last = rng.normal(size=(2, 2, 3)) * 10.0 ** rng.uniform(-6.0, 6.0, (2, 1, 1))
        lasts = exact.lasting(bodies, last, k, G)
        shares = [
            max(
                (np.abs(term) * n * t ** (n - 1) / limit).max() for term, n in zip(last, (k, k + 1))
            )
            for t in (lasts, 2.0 * lasts)
        ]
        assert math.frexp(lasts)[0] == 0.5 and shares[0] < 1.0 <= shares[1]


def test_a_series_is_full_at_the_start_and_short_where_something_has_just_happened():
    motion = exact.Motion(heap_of_five()[0], G)
    first = motion.balls[0]
    exact.event(motion, 0, first)
    assert len(first.x) == exact.ORDER + 1
    exact.event(motion, exact.later(0, 1e-6), first)
    assert len(first.x) < 10 and first.start == exact.later(0, 1e-6)


def test_a_series_lasts_for_more_than_is_enough_and_has_5_terms_of_each_force_at_least():
    scene, contacts, _ = next(sliding_scenes())
    _, held, q, v = held_group(scene, contacts)
    _, _, lam, lasts = exact.slide(held, q, v, G, 0.0)
    assert len(lam) == 5
    for _ in range(4):
        *_, longer = exact.slide(held, q, v, G, lasts)
        assert longer > lasts
        lasts = longer


# Elimination


@pytest.mark.parametrize("seed", range(10))
def test_elimination_solves_a_system_of_few_entries(seed):
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(8, 12)) * (rng.random((8, 12)) < 0.3) + np.eye(8, 12)
    W, b = J @ J.T, rng.normal(size=8)
    rows = [{m: entry for m, entry in enumerate(row) if entry} for row in W.tolist()]
    x = exact.eliminated(rows, b.tolist())
    assert x == pytest.approx(np.linalg.solve(W, b), rel=1e-9)
    assert rows == [{m: entry for m, entry in enumerate(row) if entry} for row in W.tolist()]


def test_elimination_says_none_of_contacts_that_depend_on_one_another():
    J = np.random.default_rng(16).normal(size=(5, 3))
    for units in (1.0, 1e-20, 1e20):
        W = units * (J @ J.T)
        assert exact.eliminated([dict(enumerate(row)) for row in W.tolist()], [1.0] * 5) is None


@pytest.mark.parametrize("case", range(3))
def test_a_group_solves_its_lcp_whether_all_push_or_not(case, monkeypatch):
    scene, contacts, rng = list(sliding_scenes())[case]
    _, held, _, _ = held_group(scene, contacts)
    for _ in range(8):
        b = rng.normal(size=len(held))
        assert held.solve(b.tolist()) == pytest.approx(enumerated(held.delassus, b), abs=1e-9)
    monkeypatch.setattr(exact, "solve_lcp", None)  # where all push the pivot is not needed
    push = rng.uniform(0.1, 1.0, len(held))
    assert held.solve((-held.delassus @ push).tolist()) == pytest.approx(push, rel=1e-9)


def test_a_ball_rests_where_it_was_and_has_no_rate():
    ball = exact.Body(1.0, R, [1.0, 2.0], [0.0, 0.0])
    assert ball.rests([1.0, 0.0, 0.0], [2.0, 0.0, 0.0])
    for x, y in (
        ([1.0, 0.0, 0.0], [2.5, 0.0, 0.0]), ([1.5, 0.0, 0.0], [2.0, 0.0, 0.0]),
        ([1.0, 0.0, 0.0], [2.0, 0.0, -1.0]), ([1.0, 3.0, 0.0], [2.0, 0.0, 0.0]),
        ([1.0, 0.0, 0.0], [2.0, 3.0, 0.0]), ([1.0, 0.0, 3.0], [2.0, 0.0, 0.0]),
    ):  # fmt: skip
        assert not ball.rests(x, y)
        ball.x, ball.y = x, y
        assert ball.rests(x, y) == (not any(x[1:] + y[1:]))
        ball.x, ball.y = [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]


# Units, and left and right


def pile_with_all_sorts(count, seed=0, e=0.3):
    """Balls of different sizes and masses in motion over the floor: the second is fixed and
    overlaps the first, and two lie in touch."""
    rng = np.random.default_rng(seed)
    x = 0.25 * (np.arange(count) % 4) + rng.uniform(-0.01, 0.01, count)
    y = 0.13 + 0.25 * (np.arange(count) // 4) + rng.uniform(0.0, 0.01, count)
    radius, mass = rng.uniform(0.07, 0.1, count), 10.0 ** rng.uniform(-1.0, 1.0, count)
    v0 = 0.3 * rng.normal(size=(2, count))
    x[1], mass[1], v0[:, 1] = x[0] + 0.15, np.inf, 0.0
    x[-1], y[-1] = x[-2] + radius[-2] + radius[-1], y[-2]
    return heap_of_five()[0]._replace(
        q0=np.array((x, y)), v0=v0, mass=mass, radius=radius, restitution=e
    )


def light_below_heavy():
    """0.1 kg between the floor and 10 kg: struck ever faster until both rest."""
    q0 = np.array(([0.0, 0.0], [0.6, 1.3]))
    return pile_with_all_sorts(2)._replace(
        q0=q0,
        v0=np.zeros((2, 2)),
        mass=np.array([0.1, 10.0]),
        radius=np.full(2, R),
        restitution=0.4,
    )


SORTS = {
    "few": (pile_with_all_sorts(6), 0.6),
    "many": (pile_with_all_sorts(exact.FEW + 2), 0.15),
    "no bounce": (pile_with_all_sorts(7, 1, 0.0), 0.35),
    "light below heavy": (light_below_heavy(), 2.0),
}


@pytest.mark.parametrize("name", SORTS)
def test_the_motion_does_not_hang_on_the_units_or_on_left_and_right(name):
    """Units of length, time and mass that are powers of 2 (and of 4, where roots are taken) change
    no digit of the numbers, so not one bit of the motion may change but for the exponent; and to
    mirror it changes but the sign."""
    scene, span = SORTS[name]
    times = np.linspace(0.0, span, 9)
    q, v = exact.simulate_exact(scene, times, G)
    assert np.abs(np.diff(v[-3:], axis=0)).max() > 0.0 or name == "light below heavy"
    for metre, kilogram, faster in (
        (4.0**-6, 4.0**9, 1.0),
        (4.0**5, 4.0**-70, 1.0),
        (1.0, 1.0, 2.0),
    ):
        unit = faster * math.sqrt(metre)  # of speed
        other = scene._replace(
            q0=scene.q0 * metre,
            v0=scene.v0 * unit,
            mass=scene.mass * kilogram,
            radius=scene.radius * metre,
        )
        place, speed = exact.simulate_exact(other, times * metre / unit, G * faster**2)
        assert (place == q * metre).all() and (speed == v * unit).all()
    mirror = np.array([[-1.0], [1.0]])
    place, speed = exact.simulate_exact(
        scene._replace(q0=scene.q0 * mirror, v0=scene.v0 * mirror), times, G
    )
    assert (place == q * mirror).all() and (speed == v * mirror).all()


# The run


def test_a_report_is_made_after_each_event_and_at_the_end_with_the_samples_done():
    """A ball that falls from 0.5 m and keeps its energy bounces at (2 k - 1) sqrt(2 h / g)."""
    fall, h = 0.5, 0.4
    scene = row_of_balls([0.0], [1.0], fall)._replace(restitution=1.0)
    first = math.sqrt(2.0 * h / -G)
    times = np.linspace(0.0, 10.5 * first, 40)
    reports = []
    exact.simulate_exact(scene, times, G, reports.append)
    bounces = first * (2.0 * np.arange(5) + 1.0)
    assert reports == [0, *np.searchsorted(times, bounces).tolist(), 40]


def test_what_happens_far_away_changes_no_bit():
    """Two piles 64 m apart move as each would alone."""
    one = pile_with_all_sorts(5)
    two = pile_with_all_sorts(6, 1)
    two = two._replace(q0=two.q0 + [[64.0], [0.0]])
    both = one._replace(
        **{name: np.append(getattr(one, name), getattr(two, name), -1) for name in ("q0", "v0")},
        mass=np.append(one.mass, two.mass),
        radius=np.append(one.radius, two.radius),
    )
    times = np.linspace(0.0, 0.4, 9)
    alone = [exact.simulate_exact(scene, times, G) for scene in (one, two)]
    together = exact.simulate_exact(both, times, G)
    for first, second, got in zip(*alone, together):
        assert (got == np.append(first, second, 2)).all()


def test_the_sample_at_the_start_is_the_start_to_the_last_bit():
    scene = row_of_balls([0.0, 3.0, 5.5], [1.0, np.inf, 2.0])
    scene = scene._replace(v0=np.array([[0.5, 0.0, -0.1], [0.25, 0.0, 3.0]]))
    q, v = exact.simulate_exact(scene, np.array([0.0]), G)
    assert (q[0] == scene.q0).all() and (v[0] == scene.v0).all()


def test_the_sample_at_the_start_is_of_the_last_event_at_the_start(monkeypatch):
    """A ball that lies in a fixed one is pushed out of it, into a third that was too far from its
    home to be seen: that overlap is mended by one more event at the same time."""
    monkeypatch.setattr(exact, "FEW", 0)
    scene = row_of_balls([3.3, 0.0, 0.1], [2.0, np.inf, 1.0])
    q, _ = exact.simulate_exact(scene, np.array([0.0, 1e-9]), G)
    for sample in q:
        assert np.diff(np.sort(sample[0])).min() >= 2.0 * R * (1.0 - exact.TOUCH)


def test_balls_that_nothing_moves_stay_and_make_no_event():
    scene, reports = row_of_balls([0.0, 3.0], [np.inf, np.inf]), []
    q, v = exact.simulate_exact(scene, np.array([0.0, 1.0]), G, reports.append)
    assert (q == scene.q0).all() and not v.any() and q.shape == (2, 2, 2)
    assert reports == [2]


def test_the_clock_waits_after_20_EVENTS_events_in_a_tick_of_the_smallest_ball(monkeypatch):
    """Of fewer than 20 balls, one of them far away and large: 20 EVENTS at once, then at most one
    per ball in each hundredth of a tick, until the tick is over. A sample is taken every 0.05."""
    monkeypatch.setattr(exact, "EVENTS", 2)
    tick, samples = exact.TICK * math.sqrt(R / -G), []
    scene = light_below_heavy()._replace(
        q0=np.array([[0.0, 0.0, 500.0], [0.2, 0.6, 80.0]]),
        v0=np.zeros((2, 3)),
        mass=np.array([1e-9, 1e9, np.inf]),
        radius=np.array([R, R, 50.0]),
        restitution=0.5,
    )
    exact.simulate_exact(scene, np.arange(0.0, 0.265, 0.05 * tick), G, samples.append)
    events = np.bincount(samples[:-1])
    bursts = np.flatnonzero(events > 40)
    assert len(bursts) == 2 and events.max() <= 41 + 2 * 6
    assert 0.95 <= 0.05 * np.diff(bursts)[0] <= 1.05
    assert events[bursts[0] + 1 : bursts[1] - 1].max() <= 2 * 6


# The pivot


def enumerated(W, b):
    """lam of the LCP: the set of active contacts for which lam and s are at least 0."""
    for active in product((False, True), repeat=len(b)):
        k = np.flatnonzero(active)
        lam = np.zeros(len(b))
        lam[k] = np.linalg.solve(W[np.ix_(k, k)], -b[k])
        if lam.min() >= 0.0 and (W @ lam + b)[~np.array(active)].min(initial=0.0) >= 0.0:
            return lam
    raise AssertionError("a positive definite matrix has an answer for every b")


def problems(count):
    """Random W (positive definite, or of integers) and b of two to six contacts, in units that are
    as far apart as masses are."""
    for seed in range(count):
        rng = np.random.default_rng(seed)
        K = int(rng.integers(2, 7))
        J, units = rng.normal(size=(K, K + 1)), 10.0 ** rng.uniform(-5.0, 5.0, K)
        yield J @ J.T, rng.normal(size=K), np.ones(K)
        yield J @ J.T, rng.normal(size=K), units
        J = np.eye(K) + np.triu(rng.integers(-1, 2, (K, K)), 1)
        yield J @ J.T, J @ rng.integers(-2, 3, K), units


def test_the_pivot_finds_what_enumeration_finds():
    for W, b, units in problems(40):
        lam = exact.solve_lcp(W * units * units[:, None], b * units) * units
        assert lam == pytest.approx(enumerated(W, b), rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("w, b, lam", [(4.0, -2.0, 0.5), (0.5, -2.0, 4.0), (2.0, 3.0, 0.0)])
def test_one_contact_gets_what_stops_it(w, b, lam):
    assert exact.solve_lcp(np.array([[w]]), np.array([b])).tolist() == [lam]


def dependent_contacts(seed):
    """W, b of more contacts than ways to move, some of which may close a little: b = J u + c with
    c >= 0, as the turning of normals gives it. lam = J' (v - u) then exists for the feasible v that
    is nearest to u, since v = 0 is feasible."""
    rng = np.random.default_rng(seed)
    K = int(rng.integers(12, 36))
    rank = int(rng.integers(2, K))
    J, may = rng.normal(size=(K, rank)), rng.random(K) < 0.6
    return J @ J.T, J @ rng.normal(size=rank) + 0.3 * may * np.abs(rng.normal(size=K))


@pytest.mark.parametrize("seed", range(40))
def test_the_pivot_exchanges_a_contact_that_depends_on_others_for_one_of_them(seed):
    W, b = dependent_contacts(seed)
    lam = exact.solve_lcp(W, b)
    assert lam.min() >= 0.0
    assert np.abs(np.minimum(lam, W @ lam + b)).max() <= 1e-10 * np.abs(b).max()


def test_where_all_push_one_table_and_no_exchange_is_needed(monkeypatch):
    """And where some do not, one more table is made than exchanges end in another set."""
    made, steps = [], []

    class Noting(exact.Table):
        def __init__(self, *given):
            made.append(1)
            super().__init__(*given)

        def step(self, *given):
            steps.append(1)
            return super().step(*given)

    monkeypatch.setattr(exact, "Table", Noting)
    W, _ = unequal_tower(3)
    exact.solve_lcp(W, -W.sum(1))  # lam = 1 everywhere
    assert (len(made), len(steps)) == (1, 1)
    exact.solve_lcp(np.eye(3), np.array([-1.0, 2.0, -1.0]))
    assert (len(made), len(steps)) == (1 + 2, 1 + 3)


def unequal_tower(seed):
    """W and b of a tower of masses up to 1e8 apart that is struck somewhere."""
    rng = np.random.default_rng(seed)
    scene = tower(10.0 ** rng.uniform(-4.0, 4.0, int(rng.integers(3, 12))), 0.0)
    count = len(scene.mass)
    J, w = jacobian(scene, [(k, k - 1) for k in range(count)])
    return J * w @ J.T, J[:, count:] @ rng.normal(size=count)


def dependent_but_for_rounding(seed):
    """W and b = J u of more contacts than ways to move, less 1e-12: some close, and nothing that
    the others give up could stop them."""
    rng = np.random.default_rng(seed)
    K = int(rng.integers(12, 36))
    J = rng.normal(size=(K, int(rng.integers(2, K))))
    return J @ J.T, J @ rng.normal(size=J.shape[1]) - 1e-12 * np.abs(rng.normal(size=K))


@pytest.mark.parametrize("problem", [unequal_tower, dependent_contacts, dependent_but_for_rounding])
def test_what_does_not_push_has_no_part_in_the_answer_not_even_in_its_last_bits(problem):
    """The pivot leaves no trace: the answer is that of the contacts that push, solved alone."""
    for seed in range(12):
        W, b = problem(seed)
        lam = exact.solve_lcp(W, b)
        k = np.flatnonzero(lam)
        assert len(k) < 2 or (exact.solve_lcp(W[np.ix_(k, k)], b[k]) == lam[k]).all()


def test_the_pivot_does_not_hang_on_the_units():
    """Neither on that of velocities or forces, nor on that of mass, to the last bit."""
    for seed in range(10):
        W, b = dependent_contacts(seed)
        lam = exact.solve_lcp(W, b)
        for mass, speed in ((1.0, 2.0**-80), (1.0, 2.0**80), (4.0**-70, 1.0), (4.0**70, 2.0**-9)):
            assert (exact.solve_lcp(W / mass, b * speed) == lam * mass * speed).all()


@pytest.mark.parametrize("seed", range(0, 40, 3))
def test_no_step_of_the_pivot_pulls_or_lets_the_energy_rise(seed):
    """lam'W lam / 2 + b'lam falls from step to step, which is why no active set comes twice."""
    W, b = dependent_contacts(seed)
    table, lam, energy, done = (
        exact.Table(np.column_stack((W, b)), np.ones(len(b), bool)),
        0 * b,
        0.0,
        0,
    )
    for _ in range(50 + 10 * len(b)):
        lam, done = table.step(lam, -1e-13)
        now = 0.5 * lam @ W @ lam + b @ lam
        assert lam.min() >= -1e-12 and now <= energy + 1e-12 * (1.0 + abs(energy))
        energy = now
        if done:
            break
    assert done and energy < 0.0


def test_a_table_says_what_follows_from_what_is_given():
    """s = W lam + b, whichever of lam and s is given for each contact; an exchange and its reverse
    leave it as it was."""
    rng = np.random.default_rng(11)
    J = rng.normal(size=(5, 6))
    W, b = J @ J.T, rng.normal(size=5)
    wanted = np.array([True, False, True, True, False])
    table = exact.Table(np.column_stack((W, b)), wanted)
    assert table.active.tolist() == wanted.tolist()
    for k in (1, 3, 1):
        table.exchange(k)
    lam = rng.normal(size=5)
    s = W @ lam + b
    given, told = np.where(table.active, s, lam), np.where(table.active, lam, s)
    assert table.rows[:, :-1] @ given + table.rows[:, -1] == pytest.approx(told, abs=1e-12)
    wanted[3] = False
    assert table.active.tolist() == wanted.tolist()


def test_of_contacts_that_depend_on_one_another_only_as_many_are_activated_as_do_not():
    J = np.random.default_rng(12).normal(size=(9, 4))
    table = exact.Table(np.column_stack((J @ J.T, np.ones(9))), np.ones(9, bool))
    assert table.active.sum() == 4
    assert np.linalg.matrix_rank(J[table.active]) == 4


def test_the_inverse_is_numpys_and_blocks_stay_apart_to_the_last_bit():
    rng = np.random.default_rng(13)
    J = rng.normal(size=(7, 9))
    J[:4, 5:], J[4:, :5] = 0.0, 0.0
    W = J @ J.T
    before, inverse = W.copy(), exact.inverted(W)
    assert inverse == pytest.approx(np.linalg.inv(W), rel=1e-9, abs=1e-9)
    assert not inverse[:4, 4:].any() and not inverse[4:, :4].any() and (W == before).all()
    b = rng.normal(size=7)
    assert exact.applied(inverse, b) == pytest.approx(np.linalg.solve(W, b), rel=1e-9)


# What contacts do together


def jacobian(scene, contacts):
    """J (K, 2 N) of contacts (i, j), and 1 / mass (2 N,)."""
    count = len(scene.mass)
    J = np.zeros((len(contacts), 2, count + 1))
    q = np.append(scene.q0, np.zeros((2, 1)), 1)
    for row, (i, j) in zip(J, contacts):
        d = q[:, i] - q[:, j]
        n = np.array((0.0, 1.0)) if j < 0 else d / np.hypot(*d)
        row[:, i], row[:, j] = n, -n
    return J[:, :, :count].reshape(len(contacts), -1), np.tile(1.0 / scene.mass, 2)


def rows_of(motion, values):
    """{body: (x, y)} of values (2, N), and 0 for the floor."""
    rows = dict(zip(motion.balls, map(tuple, values.T.tolist())))
    return {**rows, motion.floor: (0.0, 0.0)}


def columns(motion, rows):
    """values (2, N) of {body: (x, y)}."""
    return np.transpose([rows[ball] for ball in motion.balls])


@pytest.mark.parametrize("case", range(3))
def test_a_group_has_the_delassus_matrix_and_moves_bodies_by_its_pushes(case):
    scene, contacts, rng = list(sliding_scenes())[case]
    motion, held, q, _ = held_group(scene, contacts)
    J, w = jacobian(scene, contacts)
    assert held.delassus == pytest.approx(J * w @ J.T, rel=1e-12, abs=1e-13)
    u = rng.normal(size=scene.q0.shape)
    rows, lam = rows_of(motion, u), rng.normal(size=len(held)).tolist()
    assert held.along(rows) == pytest.approx(J @ u.ravel(), abs=1e-13)
    lam[1] = 0.0
    size = held.push(lam, rows)
    moved = u.ravel() + w * (lam @ J)
    assert columns(motion, rows).ravel() == pytest.approx(moved, abs=1e-12)
    assert rows[motion.floor] == (0.0, 0.0)
    shares = np.array([np.abs(J[k].reshape(2, -1)).any(0) * abs(p) for k, p in enumerate(lam)])
    total = np.abs(u).max(0) + shares.sum(0) / scene.mass
    for ball, told in size.items():
        assert told == pytest.approx(total[motion.number[ball]], rel=1e-12)
    assert set(size) == {b for b in motion.balls if b.w and shares[:, motion.number[b]].any()}


@pytest.mark.parametrize("case", range(3))
def test_a_correction_takes_just_the_error_by_the_least_push(case):
    scene, contacts, rng = list(sliding_scenes())[case]
    motion, held, q, _ = held_group(scene, contacts)
    J, w = jacobian(scene, contacts)
    u, error = (
        rng.normal(size=scene.q0.shape),
        rng.normal(size=len(held)) * (np.arange(len(held)) > 0),
    )
    rows = rows_of(motion, u)
    held.correct(rows, [0.0] * len(held))
    assert (columns(motion, rows) == u).all()
    held.correct(rows, error.tolist())
    push = np.linalg.solve(J * w @ J.T, -error)
    assert columns(motion, rows).ravel() == pytest.approx(u.ravel() + w * (push @ J), abs=1e-11)


def test_a_reaction_solves_the_lcp_and_leaves_no_round_off():
    """A ball that falls on the floor at 0.1 m/s and drifts at 1e-17 m/s: both are 0 afterwards; at
    1e-9 m/s it still drifts."""
    for drift, left in ((1e-17, 0.0), (1e-9, 1e-9)):
        contact = contact_over_the_floor()
        group, rows = exact.Group([contact]), {contact.i: (drift, -0.1), contact.j: (0.0, 0.0)}
        assert group.react(rows, [-0.1]) == [0.1]
        assert rows == {contact.i: (left, 0.0), contact.j: (0.0, 0.0)}


# Small gaps, and their series


@pytest.mark.parametrize("orders", [(3, 3), (3, 5), (exact.ORDER + 1, exact.ORDER + 1)])
def test_the_series_of_a_gap_is_that_of_the_squared_distance_less_its_start(orders):
    """Of two balls (reach + gap)^2 - reach^2, which has the sign of the gap; of the floor y - r."""
    rng = np.random.default_rng(14)
    dx, dy = (whole_numbers(rng, order) for order in orders)
    pair, *_ = pair_at((3.0, 0.0), (0.0, 0.0))
    square = np.zeros(2 * max(orders) - 1)
    for row in (dx, dy):
        square[: 2 * len(row) - 1] += np.convolve(row, row)
    square[0] = (3.0 + 0.25) ** 2 - 3.0**2
    series = exact.gap_series(pair, 0.25, dx, dy)
    assert series == square[: exact.ORDER + 1].tolist()
    wall, *_ = over_the_floor(1.0)
    assert exact.gap_series(wall, 0.25, dx, dy) == [0.25, *dy[1:]]


@pytest.mark.parametrize("p", [[2.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0] * 3, [1.0, 0.0, 5.0, 0.0]])
def test_a_square_has_no_zeros_beyond_its_order_and_3_numbers_at_least(p):
    square, orders = np.convolve(p, p), max(1, int(np.flatnonzero([1.0, *p[1:]])[-1]))
    assert exact.squared(p) == square[: 2 * orders + 1].tolist()


def followed(wall, gap, speed, radius=0.25):
    """A Contact with this gap, followed from now on while it opens at this speed; its bodies."""
    ball = exact.Body(1.0, radius, [0.0, 0.0], [0.0, 0.0])
    other = exact.Body(0.0, 0.0 if wall else radius, [0.0, 0.0], [0.0, 0.0])
    contact = exact.Contact(ball, other, G)
    q = {ball: (0.0, contact.reach), other: (0.0, 0.0)}
    contact.look(q, 0)
    contact.depth = -gap
    contact.follow(0, [0.0, 0.0, 0.0], [contact.reach, speed, 0.0])
    return contact, ball, other


@pytest.mark.parametrize("wall", [True, False])
@pytest.mark.parametrize("gap", [1e-30, 1e-12, 0.9e-8 * 0.25])
def test_a_small_gap_keeps_all_its_digits_wherever_the_balls_are(gap, wall):
    """Places have 16 digits and say nothing of a gap of 1e-30 m; its own series does."""
    contact, ball, other = followed(wall, gap, 0.0)
    for place in (contact.reach, contact.reach + 1e-17, contact.reach * (1.0 + 1e-12)):
        contact.look({ball: (0.0, place), other: (0.0, 0.0)}, exact.later(0, 3.0))
        assert -contact.depth == pytest.approx(gap, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("wall", [True, False])
def test_a_followed_gap_opens_with_the_speed_of_its_bodies(wall):
    contact, ball, other = followed(wall, 1e-30, 1e-10)
    contact.look({ball: (0.0, contact.reach), other: (0.0, 0.0)}, exact.later(0, 2.0))
    assert -contact.depth == pytest.approx(2e-10, rel=1e-9, abs=0.0)
    contact, ball, other = followed(wall, -1e-17, 1e-25)  # an overlap of rounding is no gap
    contact.look({ball: (0.0, contact.reach), other: (0.0, 0.0)}, exact.later(0, 2.0))
    assert -contact.depth == pytest.approx(2e-25, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("wall", [True, False])
@pytest.mark.parametrize("share, gap", [(0.9, 1e-30), (1.1, None)])
def test_a_gap_above_FOLLOWED_radii_is_read_from_the_places(share, gap, wall):
    for radius in (2.0**-8, 2.0**8):
        contact, ball, other = followed(wall, 1e-30, 0.0, radius)
        place = contact.reach + share * exact.FOLLOWED * radius
        contact.look({ball: (0.0, place), other: (0.0, 0.0)}, 0)
        expected = place - contact.reach if gap is None else gap
        assert -contact.depth == pytest.approx(expected, rel=1e-9, abs=0.0)


# Impacts and rest


def struck(seed, e, scene=None):
    """An island of touching balls with random velocities, its contacts, J and the velocities."""
    rng = np.random.default_rng(seed)
    scene = heap_of_five()[0] if scene is None else scene
    scene = scene._replace(v0=rng.normal(size=scene.q0.shape))
    island, motion = island_of(scene)
    contacts, bodies = exact.touching(island), [*motion.balls, motion.floor]
    numbers = [(bodies.index(c.i), -1 if c.wall else bodies.index(c.j)) for c in contacts]
    return island, motion, contacts, numbers, scene


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_touching_balls_part_as_newtons_law_for_all_of_them_at_once(e):
    """lam >= 0, v_n+ + e v_n >= 0, and one of them 0 at each contact: by enumeration."""
    for seed in range(12):
        island, motion, contacts, numbers, scene = struck(seed, e)
        J, w = jacobian(scene, numbers)
        assert len(contacts) == 7
        exact.collide(island, contacts, e)
        lam = enumerated(J * w @ J.T, (1.0 + e) * (J @ scene.v0.ravel()))
        if not (J @ scene.v0.ravel() < 0.0).any():
            lam[:] = 0.0
        after = columns(motion, island.v).ravel()
        assert after == pytest.approx(scene.v0.ravel() + w * (lam @ J), abs=1e-12)


def test_where_no_contact_closes_no_velocity_changes():
    scene = on_a_movable_ball([1.0, 2.0], [0.1, 0.2])[0]
    scene = scene._replace(v0=np.array([[0.0, 0.0], [1e-15, 0.7]]))
    island, motion = island_of(scene)
    exact.collide(island, exact.touching(island), 0.5)
    assert (columns(motion, island.v) == scene.v0).all()


@pytest.mark.parametrize("e", [0.0, 0.5])
@pytest.mark.parametrize("rise, ends", [(0.9, True), (1.1, False)])
def test_a_bounce_that_would_rise_less_than_LAST_radii_ends_the_series(e, rise, ends):
    """Back up with e v it would rise (e v)^2 / (2 g)."""
    scene = row_of_balls([0.0], [3.0], height=R)
    back = math.sqrt(-2.0 * G * rise * exact.LAST * R)
    speed = back / e if e else 1.0
    island, motion = island_of(scene._replace(v0=np.array([[0.0], [-speed]])))
    exact.collide(island, exact.touching(island), e)
    expected = 0.0 if ends else e * speed
    assert island.v[motion.balls[0]][1] == pytest.approx(expected, rel=1e-12, abs=0.0)


def test_a_contact_that_has_hardly_opened_does_not_bounce():
    for share, e in ((0.5, 0.0), (2.0, 0.5)):
        scene = row_of_balls([0.0], [3.0], height=R)._replace(v0=np.array([[0.0], [-1e-3]]))
        island, motion = island_of(scene)
        contacts = exact.touching(island)
        opened(contacts[0], share, 0)
        exact.collide(island, contacts, 0.5)
        assert island.v[motion.balls[0]] == (0.0, e * 1e-3)


def tower(mass, speeds):
    """Balls over one another from the floor, with these speeds upwards."""
    count = len(mass)
    q0 = np.array((np.zeros(count), R * (2.0 * np.arange(count) + 1.0)))
    return row_of_balls(np.zeros(count), mass)._replace(
        q0=q0, v0=np.array((np.zeros(count), np.broadcast_to(speeds, count)))
    )


@pytest.mark.parametrize("seed", range(6))
def test_unequal_masses_part_with_e_times_their_closing_speed_to_the_last_digits(seed):
    """Masses up to 1e8 apart, where one solution of the LCP leaves 1e-9 of the speeds."""
    rng, e = np.random.default_rng(seed), 0.5
    scene = tower(10.0 ** rng.uniform(-4.0, 4.0, 5), -1.0 - np.arange(5.0))  # all close
    island, motion = island_of(scene)
    contacts = exact.touching(island)
    before = contacts.along(island.v)
    exact.collide(island, contacts, e)
    for contact, v_n, now in zip(contacts, before, contacts.along(island.v)):
        size = max(abs(island.v[body][1]) for body in contact.bodies)
        assert now >= -e * v_n - 4e-16 * (size + 1.0) - exact.NOISE * contact.speed


def normal_parts(scene, numbers, v):
    """(n . u)' less n . a of each contact: u^2 - (n . u)^2 over the distance, and 0 at the floor."""
    turn = []
    for i, j in numbers:
        if j < 0:
            turn.append(0.0)
            continue
        d, u = scene.q0[:, i] - scene.q0[:, j], v[:, i] - v[:, j]
        turn.append((u @ u - (d @ u) ** 2 / (d @ d)) / np.hypot(*d))
    return np.array(turn)


def test_resting_contacts_get_the_forces_that_keep_all_of_them_from_closing():
    """s = n . a + turn >= 0, force >= 0, one of them 0: by enumeration, for balls that slide along
    one another with random velocities, so that some are lifted off."""
    held_counts = set()
    for seed in range(12):
        rng = np.random.default_rng(seed)
        scene, numbers = heap_of_five()
        scene = scene._replace(v0=feasible(scene, numbers, 0.7 * rng.normal(size=scene.q0.shape)))
        island, motion = island_of(scene)
        contacts = exact.touching(island)
        held, a = exact.support(island, contacts, G)
        bodies = [*motion.balls, motion.floor]
        numbers = [(bodies.index(c.i), -1 if c.wall else bodies.index(c.j)) for c in contacts]
        J, w = jacobian(scene, numbers)
        fall = np.array((np.zeros(5), np.full(5, G))).ravel()
        lam = enumerated(J * w @ J.T, J @ fall + normal_parts(scene, numbers, scene.v0))
        assert columns(motion, a).ravel() == pytest.approx(fall + w * (lam @ J), abs=1e-11)
        assert a[motion.floor] == (0.0, 0.0)
        pushing = [contact for contact, force in zip(contacts, lam) if force > 0.0]
        assert list(held) == pushing == [contact for contact in contacts if contact.pushes]
        assert all(contact.rests for contact in contacts)
        told = exact.normal_accelerations(contacts, island.v, a)
        s = J @ (fall + w * (lam @ J)) + normal_parts(scene, numbers, scene.v0)
        assert told == pytest.approx(s, abs=1e-10)
        held_counts.add(len(held))
    assert len(held_counts) > 1


def test_a_contact_that_parts_bears_nothing_and_all_is_free_fall():
    scene = row_of_balls([0.0, 9.0], [2.0, np.inf], height=R)._replace(
        v0=np.array([[0.0, 0.0], [1.0, 0.0]])
    )
    island, motion = island_of(scene)
    held, a = exact.support(island, exact.touching(island), G)
    assert list(held) == [] and a[motion.balls[0]] == (0.0, G)
    assert not any(contact.rests or contact.pushes for contact in island.contacts)
    assert a.get(motion.balls[1], (0.0, 0.0)) == (0.0, 0.0)


@pytest.mark.parametrize("left, holds", [(0.3e-12, False), (0.7e-12, True)])
@pytest.mark.parametrize("mass", [0.01, 100.0])
def test_a_contact_pushes_when_it_parts_its_bodies_by_more_than_a_graze_of_g(mass, left, holds):
    """The upper of two equal balls slides over the lower one, which stands on the floor, with
    v^2 / (2 r) = (1 - left) g: the push bears `left` of its weight, and would part the two, were
    there no floor, with twice that."""
    scene = tower([mass, mass], [0.0, 0.0])
    v0 = np.array([[0.0, math.sqrt((1.0 - left) * -G * 2.0 * R)], [0.0, 0.0]])
    island, motion = island_of(scene._replace(v0=v0))
    held, _ = exact.support(island, exact.touching(island), G)
    assert len(held) == 1 + holds


def test_what_is_left_of_a_series_of_bounces_is_taken_from_contacts_that_push():
    """But for rounding, times the condition of masses that are 1e10 apart."""
    slow = 0.2 * math.sqrt(-2.0 * G * exact.LAST * R)  # a fifth of the fastest that rests
    scene = tower([1.0, 1e5, 1e-5], [slow, -slow, 2.0 * slow])
    island, motion = island_of(scene)
    held, a = exact.support(island, exact.touching(island), G)
    assert len(held) == 3 and np.abs(held.along(island.v)).max() <= 1e-6 * slow
    assert np.abs(exact.normal_accelerations(held, island.v, a)).max() <= 1e-14 * -G


# Sliding: what the series promise


def held_group(scene, contacts):
    """The Group of these contacts (i, j), j = -1 the floor, and q, v of all bodies."""
    motion = exact.Motion(scene, G)
    bodies = [*motion.balls, motion.floor]
    q, v = ({body: body.at(0)[k] for body in bodies} for k in (0, 1))
    group = exact.Group(bodies[i].near[bodies[j]] for i, j in contacts)
    for contact in group:
        contact.locate(q)
    return motion, group, q, v


def slid(held, q, v):
    """The bodies of slide, and its series in full."""
    return exact.slide(held, q, v, G, math.inf)[:3]


def sliding_scenes():
    rng = np.random.default_rng(10)
    for scene, contacts in (on_a_movable_ball([1.0, 2.0], [0.1, 0.2]), heap_of_five()):
        yield scene, contacts, rng
    scene, contacts = heap_of_five()
    mass = scene.mass.copy()
    mass[1] = np.inf
    yield scene._replace(mass=mass), [pair for pair in contacts if pair != (1, -1)], rng


def feasible(scene, contacts, v):
    """The velocities (2, N) nearest to v by kinetic energy at which no contact opens or closes."""
    J, w = jacobian(scene, contacts)
    return v - (w * (J.T @ np.linalg.solve(J * w @ J.T, J @ v.ravel()))).reshape(v.shape)


def in_its_own_time(Q, lam):
    """The series in a unit of time [s] in which no coefficient is above 1, and that unit."""
    orders = np.arange(1, len(Q))
    unit = (np.abs(Q[1:]).max((1, 2)) ** (-1.0 / orders)).min()
    powers = unit ** np.arange(len(Q))
    return Q * powers[:, None, None], lam * powers[2:, None], unit


@pytest.mark.parametrize("case", range(3))
def test_the_series_of_sliding_balls_keep_every_gap_and_obey_newton(case):
    """gap = 0 means |q_i - q_j|^2 = reach^2 order by order; and M (k + 1) (k + 2) Q[k + 2] is what
    the forces' series, times the normals' series, add up to."""
    scene, contacts, rng = list(sliding_scenes())[case]
    moves, order = np.isfinite(scene.mass), exact.ORDER
    scene = scene._replace(v0=feasible(scene, contacts, rng.normal(size=scene.q0.shape) * moves))
    _, held, q, v = held_group(scene, contacts)
    bodies, Q, lam = slid(held, q, v)
    for rows, given in ((Q[0], q), (Q[1], v)):
        assert rows.T == pytest.approx(np.array([given[body] for body in bodies]), abs=1e-14)
    assert Q.shape == (order + 1, 2, len(bodies)) and lam.shape == (order - 1, len(held))
    Q, lam, unit = in_its_own_time(Q, lam)
    one, force = np.eye(order + 1)[0], np.zeros((order - 1, 2, len(bodies)))
    for contact, row in zip(held, lam.T):
        i, j = bodies.index(contact.i), bodies.index(contact.j)
        d = Q[:, :, i] - Q[:, :, j]
        if contact.wall:
            assert d[:, 1] == pytest.approx(one * contact.reach, abs=1e-15)
            d = np.outer(one, (0.0, contact.reach))
        square = sum(np.convolve(part, part)[: order + 1] for part in d.T)
        assert square == pytest.approx(one * contact.reach**2, abs=1e-15)
        for axis in (0, 1):
            push = np.convolve(row, d[:, axis] / contact.reach)[: order - 1]
            force[:, axis, i] += push
            force[:, axis, j] -= push
    w = np.array([body.w for body in bodies])
    force *= w
    force[0, 1, w > 0.0] += G * unit**2
    k = np.arange(order - 1)[:, None, None]
    assert Q[2:] == pytest.approx(force / ((k + 1) * (k + 2)), abs=1e-14)
    assert (Q[2:, :, w == 0.0] == 0.0).all()


def test_a_slide_starts_where_no_gap_is_left_and_nothing_opens_or_closes():
    """From places that are off by 1e-6 r, and any velocities: what a least push, weighed by the
    masses, makes of them. Its remainder is of second order in the gaps, 1e-12 r."""
    scene, contacts, rng = list(sliding_scenes())[2]
    moves = np.isfinite(scene.mass)
    off = 1e-6 * R * rng.uniform(-1.0, 1.0, scene.q0.shape) * moves
    scene = scene._replace(q0=scene.q0 + off, v0=rng.normal(size=scene.q0.shape) * moves)
    _, held, q, v = held_group(scene, contacts)
    bodies, Q, _ = slid(held, q, v)
    order = [bodies.index(body) for body in list(q)[:-1]]
    gaps = []
    for contact in held:
        d = Q[0, :, bodies.index(contact.i)] - Q[0, :, bodies.index(contact.j)]
        gaps.append((d[1] if contact.wall else np.hypot(*d)) - contact.reach)
    assert np.abs(gaps).max() <= 1e-11 * R
    moved = scene._replace(q0=Q[0][:, order])
    assert Q[1][:, order] == pytest.approx(feasible(moved, contacts, scene.v0), abs=1e-5)
    push = Q[0][:, order] - scene.q0  # in the span of M^-1 J': nothing of it is feasible
    assert np.abs(feasible(scene, contacts, push)).max() <= 1e-11 * R
    assert (Q[:2, :, [k for k, b in enumerate(bodies) if b.w == 0.0]][1] == 0.0).all()


def expanded(scene, contacts):
    """What expand says of these contacts, and slide's series of them."""
    motion, held, q, v = held_group(scene, contacts)
    a = {body: (0.0, G if body.w else 0.0) for body in q}
    held.correct(a, exact.normal_accelerations(held, v, a))
    return motion, held, exact.expand(held, q, v, a, G, math.inf), slid(held, q, v)


def last_terms(Q, radius, span):
    """The larger of a series' last two terms at its end, as a share of what they may be."""
    orders = np.array([exact.ORDER - 1.0, exact.ORDER])[:, None, None]
    rates = np.abs(Q[-2:]) * orders * span ** (orders - 1.0)
    return (rates / np.sqrt(-G * radius)).max() / exact.CUT


@pytest.mark.parametrize("case", range(3))
def test_a_series_lasts_a_power_of_2_as_long_as_its_last_terms_are_small(case):
    """Twice as long, one of them would not be."""
    scene, contacts, rng = list(sliding_scenes())[case]
    moves = np.isfinite(scene.mass)
    for speed in np.linspace(0.0, 2.0, 20):
        v0 = feasible(scene, contacts, speed * rng.normal(size=scene.q0.shape) * moves)
        motion, held, found, (bodies, Q, _) = expanded(scene._replace(v0=v0), contacts)
        series, forces, span = found
        assert math.frexp(span)[0] == 0.5 and list(forces) == list(held)
        moving = [k for k, body in enumerate(bodies) if body.w > 0.0]
        assert list(series) == [bodies[k] for k in moving]
        for k in moving:
            assert np.array(series[bodies[k]]).T.tolist() == Q[:, :, k].tolist()
        radius = np.array([bodies[k].radius for k in moving])
        Q = Q[:, :, moving]
        assert last_terms(Q, radius, span) < 1.0 <= last_terms(Q, radius, 2.0 * span)


def test_a_force_ends_when_it_has_fallen_to_minus_a_graze_of_the_weight():
    """GRAZE of g, in acceleration along the contact: force (w_i + w_j) = -1e-12 g."""
    motion, held, (_, forces, _), (_, _, lam) = expanded(*heap_of_five())
    for contact, row, series in zip(held, lam.T, forces.values()):
        graze = -exact.GRAZE * G / (contact.i.w + contact.j.w)
        assert series[0] == row[0] + graze > row[0] and series[1:] == row[1:].tolist()


def test_where_nothing_slides_there_is_nothing_to_expand():
    """A column at rest, and one that moves together along x."""
    scene, contacts = on_a_movable_ball([1.0, 2.0], [0.1, 0.1], angle=0.0)
    for speeds, count in (([0.0, 0.0], 0), ([3.0, 3.0], 0), ([0.0, 3.0], 2)):
        moving = scene._replace(v0=np.array((speeds, [0.0, 0.0])))
        _, _, (series, forces, span), _ = expanded(moving, contacts)
        assert len(series) == len(forces) == count and (span == math.inf) == (count == 0)
