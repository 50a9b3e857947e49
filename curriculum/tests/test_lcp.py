"""lcp's targets: where a bounce ends, and what an impulse may do to the energy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import contact

RADIUS = contact.RADIUS


@pytest.mark.parametrize("baumgarte", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("dt", [0.0005, 0.001, 0.002, 0.004, 0.008])
def test_a_bounce_ends_on_the_table_not_above_it(dt, baumgarte):
    for seed in range(20 if dt > 0.001 else 4):
        scene = contact.build_scene("bounce", seed)
        run = contact.run_model("lcp", scene, dt, int(5.0 / dt), baumgarte=baumgarte)
        quality = contact.contact_quality(run, scene, dt)
        assert abs(quality["rest_gap_frac"]) < 1e-3, (seed, quality["rest_gap_frac"])
        assert quality["energy_excess"] <= 0.0


def test_a_listed_contact_across_a_gap_does_not_bounce_on_air():
    ball = contact.Ball(0.0, RADIUS + 5e-4, 0.0, -0.1, 1.0, RADIUS)
    (listed,) = contact.detect_contacts([ball])
    target = contact.contact_target(listed, 0.7, 0.2, dt=0.002)
    assert target == pytest.approx(-5e-4 / 0.002)  # it may close the gap, and no more
    ball.vy = -1.0  # now it would meet the floor in the step
    assert contact.contact_target(listed, 0.7, 0.2, dt=0.002) == 0.7


@given(gap=st.floats(-1e-2, 1e-3), v_n=st.floats(-10.0, 10.0), e=st.floats(0.01, 1.0))
def test_without_push_no_target_is_above_minus_e_v_n(gap, v_n, e):
    ball = contact.Ball(0.0, RADIUS + gap, 0.0, v_n, 1.0, RADIUS)
    near = contact.Contact(ball, contact.FLOOR, 0.0, 1.0, -gap)
    assert contact.contact_target(near, e, 0.0, 0.002) <= -e * v_n


@settings(max_examples=60, derandomize=True, deadline=None)
@given(seed=st.integers(0, 10**6), e=st.sampled_from([0.1, 0.5, 0.9, 1.0]))
def test_solved_impulses_without_push_never_add_kinetic_energy(seed, e):
    """Moreau: with targets of at most -e v_n, and sweeps that finish, |v'| <= |v| in the mass norm."""
    rng = np.random.default_rng(seed)
    balls = [
        contact.Ball(
            *rng.uniform(0.1, 0.25, 2), *rng.normal(0.0, 2.0, 2), 10.0 ** rng.uniform(-1, 1), RADIUS
        )
        for _ in range(int(rng.integers(2, 6)))
    ]
    contacts = contact.detect_contacts(balls, margin=0.02)
    for c in contacts:
        c.target = contact.contact_target(c, e, 0.0, 0.002)

    def kinetic():
        return sum(0.5 * b.mass * (b.vx * b.vx + b.vy * b.vy) for b in balls)

    before = kinetic()
    contact.solve_contacts(contacts, 200_000, tolerance=1e-13)
    assert kinetic() <= before * (1.0 + 1e-9)
    assert all(c.lam >= 0.0 and c.v_n() >= c.target - 1e-9 for c in contacts)


@pytest.mark.parametrize("sweeps", [1, 2, 3, 10])
def test_corrections_of_exactly_the_tolerance_end_the_sweeps(sweeps):
    """Two balls of 1 kg, one on the other, shall leave the floor at 1 m/s.

    Sweep k corrects both normal velocities by 2^(1-k) m/s, exactly, and ends at 2 (1 - 2^-k) and
    1 - 2^-k N s: at last two balls of 1 kg move at 1 m/s.
    """

    def solved(iters, tolerance):
        low, high = (contact.Ball(0.0, y, 0.0, 0.0, 1.0, RADIUS) for y in (0.1, 0.3))
        ground = contact.Contact(low, contact.FLOOR, 0.0, 1.0, 0.0)
        pair = contact.Contact(high, low, 0.0, 1.0, 0.0)
        ground.target = 1.0
        contact.solve_contacts([ground, pair], iters, tolerance)
        return ground.lam, pair.lam

    share = 1.0 - 2.0**-sweeps
    assert solved(1000, 2.0 ** (1 - sweeps)) == solved(sweeps, 0.0) == (2.0 * share, share)
    assert solved(1000, 0.0) == (2.0, 1.0)


def test_the_error_of_the_bounce_falls_with_the_step_down_to_a_sixteenth_of_a_millisecond():
    def error(dt):
        worst = []
        for seed in range(3):
            scene = contact.build_scene("bounce", seed)
            run = contact.run_model("lcp", scene, dt, int(4.0 / dt))
            exact = bounce(scene.q0[1, 0] - RADIUS, 0.7, run.t) + RADIUS
            worst.append(np.abs(run.q[:, 1, 0] - exact).max() / RADIUS)
        return max(worst)

    errors = [error(dt) for dt in (0.002, 0.0005, 0.000125)]
    assert errors[0] < 0.2 and errors[1] < errors[0] / 2.0 and errors[2] < errors[1] / 2.0, errors


def bounce(height, e, t):
    """The gap of a ball dropped from `height` at times t, flight by flight."""
    gap = np.maximum(height - 4.905 * t * t, 0.0)
    start, speed = math.sqrt(2.0 * height / 9.81), e * math.sqrt(2.0 * height * 9.81)
    while speed > 1e-9:
        s = t - start
        gap = np.where((s >= 0.0) & (s < speed / 4.905), speed * s - 4.905 * s * s, gap)
        start += speed / 4.905
        speed *= e
    return np.where(t < start, gap, 0.0)
