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
    assert (closed_form.bounce_gap(gap, restitution, end * np.array([1.0, 1.1, 100.0])) == 0.0).all()


def test_first_impact_after_a_fall_of_one_g_half_is_at_one_second():
    assert closed_form.first_impact_time(9.81 / 2) == 1.0


def test_rest_time_is_the_limit_of_the_impact_times():
    for e in (0.3, 0.7, 0.9):
        limit = closed_form.impact_time(0.9, e, 2000.0)
        assert closed_form.rest_time(0.9, e) == pytest.approx(limit, rel=1e-14)
    assert closed_form.rest_time(9.81 / 2, 0.5) == pytest.approx(3.0, rel=1e-15)    # 1 s (1.5 / 0.5)
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
