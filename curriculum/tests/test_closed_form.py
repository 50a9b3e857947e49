"""The benchmark's reference, held to a slower and far more precise computation of the same motion.

The reference here goes from impact to impact with 60 decimal digits; closed_form.py uses doubles
and the geometric series. Neither knows of contact.py.
"""

import math
from decimal import Decimal, getcontext

import numpy as np
import pytest

from curriculum.bench import closed_form

getcontext().prec = 60
G = Decimal("9.81")
RADIUS = 0.1
GAPS = [0.8801, 0.9, 0.9055, 0.9199]


def gap_by_events(gap, restitution, t):
    """Gap after time t, by taking one flight after the other; all arguments and the result Decimal."""
    start, speed = (2 * gap / G).sqrt(), (2 * gap * G).sqrt()
    if t < start:
        return gap - G * t * t / 2
    for _ in range(5000):
        speed *= restitution
        duration = 2 * speed / G
        if t < start + duration:
            return speed * (t - start) - G * (t - start) ** 2 / 2
        start += duration
    return Decimal(0)


@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.7, 0.9, 0.99, 1.0])
@pytest.mark.parametrize("gap", GAPS)
def test_gap_agrees_with_sixty_digits_flight_by_flight(gap, restitution):
    times = np.arange(0.0, 4.0, 0.0137)
    expected = [float(gap_by_events(Decimal(gap), Decimal(restitution), Decimal(t))) for t in times]
    error = np.abs(closed_form.bounce_gap(gap, restitution, times) - expected).max()
    assert error < 2e-14, f"worst gap error {error} m, with at most 2e-14 allowed"


@pytest.mark.parametrize("restitution", [0.3, 0.7, 0.9, 0.99])
def test_height_is_continuous_at_every_impact_and_zero_after_the_last(restitution):
    gap = 0.9
    impacts = closed_form.impact_time(gap, restitution, np.arange(60.0))
    around = np.concatenate([np.nextafter(impacts, 0), impacts, np.nextafter(impacts, 9e9)])
    assert np.abs(closed_form.bounce_gap(gap, restitution, around)).max() < 5e-14
    end = closed_form.rest_time(gap, restitution)
    assert (
        closed_form.bounce_gap(gap, restitution, end * np.array([1.0, 1.1, 100.0])) == 0.0
    ).all()


def test_first_impact_after_a_fall_of_one_g_half_is_at_one_second():
    assert closed_form.first_impact_time(9.81 / 2) == 1.0


def test_rest_time_is_the_limit_of_the_impact_times():
    for e in (0.3, 0.7, 0.9):
        limit = closed_form.impact_time(0.9, e, 2000.0)
        assert closed_form.rest_time(0.9, e) == pytest.approx(limit, rel=1e-14)
    assert closed_form.rest_time(9.81 / 2, 0.5) == pytest.approx(3.0, rel=1e-15)  # 1 s (1.5 / 0.5)
    assert closed_form.rest_time(0.9, 0.0) == closed_form.first_impact_time(0.9)
    assert closed_form.rest_time(0.9, 1.0) == math.inf


def test_elastic_ball_is_back_at_its_height_after_100_bounces():
    t1 = closed_form.first_impact_time(0.9)
    assert closed_form.bounce_gap(0.9, 1.0, 200 * t1) == pytest.approx(0.9, abs=1e-12)


def test_peak_after_each_impact_is_e_squared_of_the_one_before():
    e, gap = 0.7, 0.9
    for k in (1, 2, 5):
        peak = (closed_form.impact_time(gap, e, k - 1) + closed_form.impact_time(gap, e, k)) / 2
        expected = closed_form.rebound_gap(gap, e, k)
        assert closed_form.bounce_gap(gap, e, peak) == pytest.approx(expected, abs=1e-14)
        assert expected == pytest.approx(gap * 0.49**k)


def test_one_kilogram_on_ten_kilonewtons_a_metre_sinks_by_0_981_mm():
    assert closed_form.rest_depth(1.0, 1e4) == pytest.approx(0.000981, rel=1e-15)


def test_semi_implicit_euler_lags_the_parabola_by_half_g_t_dt():
    dt, y, v = 0.002, 1.0, 0.0
    for _ in range(200):
        v -= 9.81 * dt
        y += dt * v
    parabola = 1.0 - 0.5 * 9.81 * 0.4**2
    assert parabola - y == pytest.approx(closed_form.flight_lag(0.4, dt), rel=1e-12)


def test_a_column_falls_together_and_stands_touching():
    heights = RADIUS * np.array([1.0, 3.0, 5.0]) + 0.02
    t1 = math.sqrt(2 * 0.02 / 9.81)
    path = closed_form.column_heights(heights, RADIUS, np.array([0.0, 0.5 * t1, t1, 2.0]))
    assert path.shape == (4, 3)
    assert np.diff(path, axis=1) == pytest.approx(np.full((4, 2), 0.2), abs=1e-15)
    assert path[:, 0] == pytest.approx([0.12, 0.115, 0.1, 0.1], abs=1e-15)


def test_one_ball_is_a_column_of_one():
    t = np.linspace(0.0, 1.0, 101)
    column = closed_form.column_heights(np.array([1.0055]), RADIUS, t)[:, 0]
    assert (column == closed_form.ball_height(1.0055, RADIUS, 0.0, t)).all()


def runge_kutta(slope, state, duration, steps):
    """The classical method of order four; state and slope(state) are arrays."""
    h = duration / steps
    for _ in range(steps):
        a = slope(state)
        b = slope(state + 0.5 * h * a)
        c = slope(state + 0.5 * h * b)
        state = state + h / 6.0 * (a + 2.0 * b + 2.0 * c + slope(state + h * c))
    return state


def test_a_ball_on_a_ball_turns_as_the_pendulum_equation_says():
    theta, length = 0.1, 0.2
    end = runge_kutta(
        lambda s: np.array([s[1], 9.81 / length * math.sin(s[0])]),
        np.array([theta, 0.0]),
        0.3,
        2000,
    )
    q, v = closed_form.slide_motion(theta, length, RADIUS, RADIUS, np.array([0.3]))
    assert q[0] == pytest.approx(
        [length * math.sin(end[0]), RADIUS + length * math.cos(end[0])], abs=1e-12
    )
    assert v[0, 0] == pytest.approx(length * math.cos(end[0]) * end[1], abs=1e-11)


def test_a_ball_leaves_a_fixed_one_where_gravity_alone_just_turns_it():
    """At the release the centripetal part of gravity is all that bends the path: g cos = speed^2 / l."""
    theta, length = 0.1, 0.2
    end = closed_form.slide_release(theta)
    assert math.cos(end) == pytest.approx(2.0 / 3.0 * math.cos(theta), rel=1e-15)
    speed_squared = 2.0 * 9.81 * length * (math.cos(theta) - math.cos(end))
    assert 9.81 * math.cos(end) == pytest.approx(speed_squared / length, rel=1e-14)


def test_pyramid_of_three_releases_at_31_885_degrees_and_lands_at_0_32161_s():
    theta = math.radians(60.0)
    assert math.degrees(closed_form.pyramid_release(theta)) == pytest.approx(31.885, abs=5e-4)
    t = np.linspace(0.3, 0.34, 40001)
    q, _ = closed_form.pyramid_motion(theta, 0.2, RADIUS, t)
    assert t[np.argmax(q[:, 1, 2] <= RADIUS)] == pytest.approx(0.32161, abs=5e-6)


def test_sliding_balls_keep_energy_and_the_touch_until_they_let_go():
    theta, t = math.radians(55.0), np.linspace(0.0, 0.15, 151)
    q, v = closed_form.pyramid_motion(theta, 0.2, RADIUS, t)
    total = 0.5 * (v**2).sum((1, 2)) + 9.81 * q[:, 1].sum(1)
    assert np.ptp(total) < 1e-14
    assert np.hypot(*(q[:, :, 2] - q[:, :, 0]).T) == pytest.approx(np.full(151, 0.2), abs=1e-14)


def test_velocity_is_the_slope_of_the_path():
    t, h = np.linspace(0.05, 0.65, 200), 1e-6
    for motion in (
        lambda t: closed_form.bounce_motion(0.9, 0.7, t),
        lambda t: closed_form.slide_motion(0.2, 0.2, RADIUS, RADIUS, t),
        lambda t: closed_form.pyramid_motion(1.0, 0.2, RADIUS, t),
    ):
        slope = (motion(t + h)[0] - motion(t - h)[0]) / (2.0 * h)
        off = np.abs(slope - motion(t)[1]).reshape(len(t), -1).max(1)
        assert np.median(off) < 1e-8 and (off > 1e-6).sum() <= 2  # impacts apart


def test_the_floor_carries_a_whole_tower_and_each_ball_those_above_it():
    forces = closed_form.tower_forces(4, 2.0)
    assert forces == pytest.approx(2.0 * 9.81 * np.array([4, 3, 2, 1]))
    assert np.diff(forces) == pytest.approx(-2.0 * 9.81 * np.ones(3))


def test_a_cradle_keeps_momentum_and_energy():
    speeds = closed_form.cradle_speeds(5, 3.0)
    assert speeds.sum() == 3.0 and (speeds**2).sum() == 9.0 and speeds[-1] == 3.0
