"""What contact_quality measures: on recordings made by hand, whose answers are plain."""

import numpy as np
import pytest

import contact
from curriculum.common import recording as recording_files

R = contact.RADIUS
SCENE = contact.build_scene("drop")


DT = 0.01


def recording(heights, landing=1):
    """A Run of one ball at these heights [m], in free fall to step `landing`, at rest from there."""
    t = np.arange(len(heights)) * DT
    q = np.zeros((len(heights), 2, 1))
    v = np.zeros_like(q)
    q[:, 1, 0] = heights
    v[:landing, 1, 0] = contact.GRAVITY * t[:landing]
    return contact.Run(t, q, v)


def test_the_rest_gap_tells_hanging_from_sinking():
    for gap in (0.3 * R, 0.0, -0.2 * R):
        quality = contact.contact_quality(recording([1.0, R + gap]), SCENE, DT)
        assert quality["rest_gap_frac"] == pytest.approx(gap / R, abs=1e-15)
        assert quality["rest_penetration_frac"] == pytest.approx(max(0.0, -gap / R), abs=1e-15)


def test_the_rebound_is_the_highest_gap_after_the_first_contact():
    quality = contact.contact_quality(recording([1.0, R, R + 0.05, R + 0.02, R]), SCENE, DT)
    assert quality["rebound_frac"] == pytest.approx(0.5)


def test_a_run_has_exploded_when_it_has_gained_ten_times_its_start():
    assert contact.blow_up_step(np.array([2.0, np.nextafter(22.0, 0.0), 22.0])) == 2
    assert contact.blow_up_step(np.array([2.0, 21.9])) is None


def test_held_balls_have_no_energy():
    q, v = np.array([[0.0, 9.0], [2.0, 3.0]]), np.array([[0.0, 1.0], [4.0, 1.0]])
    held = contact.energy(q, v, np.array([0.5, np.inf]))
    assert held == pytest.approx(0.5 * 0.5 * 16.0 + 0.5 * 9.81 * 2.0, rel=1e-15)


def test_nothing_pushes_a_held_ball_in_the_recording():
    scene = contact.build_scene("stack", bodies=2)._replace(mass=np.array([1.0, np.inf]))
    pushes = contact.contact_impulses(contact.run_model("lcp", scene, DT, 5), scene)
    assert not pushes[:, :, 1].any()


def test_a_ball_at_rest_is_recorded_with_a_push_of_its_own_weight_whatever_its_mass(monkeypatch):
    """An arrow's length is the push over the weight, so that heavy and light balls can be compared."""
    written = []
    monkeypatch.setattr(recording_files, "write", lambda *given: written.append(given))
    for mass in (1.0, 4.0):
        scene = SCENE._replace(q0=np.array([[0.0], [R]]), mass=np.array([mass]))
        contact.log_rerun("a.rrd", {"exact": contact.run_model("exact", scene, DT, 5)}, scene)
        pushes = written[-1][6]["exact"]
        assert np.abs(pushes[1:, 1, 0] - 1.0).max() < 4 * 2.0**-53 and not pushes[:, 0].any()


def test_energy_in_is_the_sum_of_its_rises():
    heights = [1.0, 0.4, 0.5, 0.3, 0.35]  # rises of 0.1 and 0.05 m, start at 1 m
    quality = contact.contact_quality(recording(heights), SCENE, DT)
    assert quality["contact_energy"] == pytest.approx(0.15)
    assert quality["energy_excess"] == 0.0


def test_energy_in_is_zero_for_exact_and_sees_an_elastic_gain():
    scene = contact.build_scene("pile", bodies=6, restitution=0.9)
    quality = contact.contact_quality(contact.run_model("exact", scene, 0.002, 600), scene, 0.002)
    assert quality["contact_energy"] < 1e-12
    scene = contact.build_scene("drop", restitution=1.0)
    quality = contact.contact_quality(contact.run_model("lcp", scene, 0.002, 2000), scene, 0.002)
    assert quality["contact_energy"] >= quality["energy_excess"] > 1e-3


def test_the_height_error_is_split_where_the_run_first_touches():
    run = recording([1.0, 0.6, R, R + 0.03, R], landing=3)
    truth = recording([1.0, 0.62, R, R, R], landing=2)
    quality = contact.contact_quality(run, SCENE, DT, truth)
    assert quality["flight_error_frac"] == pytest.approx(0.2)
    assert quality["height_error_frac"] == pytest.approx(0.3)
    assert quality["contact_error_frac"] == pytest.approx(0.1)


def test_flight_ends_with_the_first_of_both_contacts():
    """The reference lands while the run still flies: what they differ by then is contact's."""
    run = recording([1.0, 0.6, 0.5, R, R], landing=4)
    truth = recording([1.0, 0.62, R, R, R], landing=2)
    quality = contact.contact_quality(run, SCENE, DT, truth)
    assert quality["flight_error_frac"] == pytest.approx(0.2)
    assert quality["contact_error_frac"] == pytest.approx(4.0 - 0.2)


def test_a_ball_that_just_touches_has_made_contact():
    assert contact.first_contact(recording([1.0, 0.6, R], landing=3), SCENE, DT) == 2
    assert contact.first_contact(recording([1.0, 0.6, 0.5], landing=3), SCENE, DT) == 3


def test_a_bounce_between_two_samples_is_a_contact_too():
    """exact comes nowhere near the table at a sample, and yet it has bounced."""
    scene = contact.build_scene("bounce")
    height = scene.q0[1, 0] - R
    for dt in (0.002, 0.0005):
        run = contact.run_model("exact", scene, dt, int(4.0 / dt))
        quality = contact.contact_quality(run, scene, dt, run)
        assert quality["rebound_frac"] * R == pytest.approx(0.49 * height, rel=1e-4)
        impact = np.sqrt(2.0 * height / 9.81)
        assert contact.first_contact(run, scene, dt) == int(np.ceil(impact / dt))


def test_in_the_drop_the_whole_flight_error_is_the_lag_of_semi_implicit_euler():
    exact = contact.run_model("exact", SCENE, 0.002, 500)
    for model in ("penalty", "lcp", "soft"):
        run = contact.run_model(model, SCENE, 0.002, 500)
        quality = contact.contact_quality(run, SCENE, 0.002, exact)
        landing = contact.first_contact(exact, SCENE, 0.002)
        lag = 9.81 * 0.002 * run.t[landing - 1] / 2.0
        assert quality["flight_error_frac"] == pytest.approx(lag / R, rel=1e-9)


def test_the_smallest_gap_is_that_of_the_closest_pair_or_the_floor():
    rng = np.random.default_rng(1)
    q = rng.uniform(0.0, 2.0, (20, 2, 7))
    radius = rng.uniform(0.05, 0.3, 7)
    gaps = contact.smallest_gap(q, radius)
    for state, gap in zip(q, gaps):
        balls = [contact.Ball(*xy, 0.0, 0.0, 1.0, r) for *xy, r in zip(*state, radius)]
        depths = [c.depth for c in contact.detect_contacts(balls, margin=9.0)]
        assert gap == pytest.approx(-max(depths), abs=1e-15)


def test_near_pairs_of_many_balls_list_the_contacts_of_all_pairs(monkeypatch):
    rng = np.random.default_rng(2)
    for trial in range(24):
        q = rng.uniform(0.0, 1.5, (2, 40)) * 10.0 ** rng.integers(-1, 2)
        q[rng.random((2, 40)) < 0.05] = rng.choice([np.nan, np.inf, -np.inf, 1e300, 0.5])
        radius = rng.uniform(0, 0.3, 40) * rng.choice([1.0, 10.0])
        balls = [
            contact.Ball(*xy, 0.0, 0.0, 1.0, r) for *xy, r in zip(*q.tolist(), radius.tolist())
        ]
        margin, found = rng.choice([1e-3, 0.5]), []
        for few in (12, 100):
            monkeypatch.setattr(contact, "FEW", few)
            listed = contact.detect_contacts(balls, margin)
            found.append(
                [
                    (
                        balls.index(c.a),
                        -1 if c.b is contact.FLOOR else balls.index(c.b),
                        c.nx,
                        c.ny,
                        c.depth,
                    )
                    for c in listed
                ]
            )
        assert repr(found[0]) == repr(found[1]), trial
