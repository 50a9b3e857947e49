"""soft, MuJoCo's contact: what its formulas promise, found again in runs."""

import numpy as np
import pytest

import contact

DT = 0.002


def rest_depth(scene, **knobs):
    """Depth [m] of the first ball at the end of a run of soft."""
    run = contact.run_model("soft", scene, DT, 3000, **knobs)
    return float(scene.radius[0] - run.q[-1, 1, 0])


@pytest.mark.parametrize("mass", [0.1, 1.0, 10.0])
def test_a_ball_rests_where_its_spring_carries_it_whatever_its_mass(mass):
    """(1 - d) g = d^2 K depth, with d the impedance at that depth: the mass cancels."""
    scene = contact.build_scene("drop")._replace(mass=np.array([mass]))
    depth = rest_depth(scene)
    assert depth / 0.1 == pytest.approx(3.6718184e-3, rel=1e-7)
    d = contact.impedance(depth, contact.SOLIMP)
    stiffness = 1.0 / (0.95 * 0.02) ** 2
    assert (1.0 - d) * 9.81 == pytest.approx(d * d * stiffness * depth, rel=1e-12)


def test_impedance_is_an_s_from_d0_to_d1():
    solimp = (0.1, 0.9, 0.01, 0.3, 3.0)
    ends = [contact.impedance(depth, solimp) for depth in (0.0, 0.01, 1.0)]
    assert ends == pytest.approx([0.1, 0.9, 0.9], abs=1e-15)
    assert contact.impedance(0.003, solimp) == pytest.approx(0.1 + 0.8 * 0.3, rel=1e-14)
    depths = np.linspace(0.0, 0.01, 200)
    values = [contact.impedance(depth, solimp) for depth in depths]
    assert (np.diff(values) > 0.0).all()
    slopes = np.diff(values)
    assert slopes.argmax() == pytest.approx(0.3 * 199, abs=2)  # steepest where the parts meet


def test_a_width_of_zero_takes_the_mean_as_mujoco_does():
    assert contact.impedance(0.001, (0.2, 0.8, 0.0, 0.5, 2.0)) == 0.5


def test_a_time_constant_below_two_steps_is_raised_to_them():
    assert contact.soft_defaults(0.0, 0.02)[0] == (0.04, 1.0)
    assert contact.soft_defaults(0.0, 0.002)[0] == (0.02, 1.0)
    assert contact.soft_defaults(0.0, 0.02, solref=(0.03, 0.5))[0] == (0.04, 0.5)
    assert contact.soft_defaults(0.0, 0.02, solref=(-5e3, -100.0))[0] == (-5e3, -100.0)


def test_restitution_takes_the_direct_form_and_a_hard_contact_unless_one_is_given():
    """The damping (1 + e) / dt; a stiffness of 0 is direct too; shares stay in 0.0001 to 0.9999."""
    assert contact.soft_defaults(0.7, 0.002) == ((0.0, -1.7 / 0.002), contact.HARD)
    given = (0.5, 0.6, 0.01, 0.3, 1.0)
    assert contact.soft_defaults(0.7, 0.002, solimp=given) == ((0.0, -1.7 / 0.002), given)
    assert contact.soft_defaults(0.7, 0.002, (0.03, 0.5)) == ((0.03, 0.5), contact.SOLIMP)
    assert contact.soft_defaults(0.0, 0.02, (0.0, -100.0))[0] == (0.0, -100.0)
    clamped = contact.soft_defaults(0.0, 0.002, None, (0.0, 1.0, 0.01, 0.0, 2.0))[1]
    assert clamped == (0.0001, 0.9999, 0.01, 0.0001, 2.0)


def test_with_restitution_soft_bounces_by_the_direct_form():
    scene = contact.build_scene("bounce")
    run = contact.run_model("soft", scene, DT, 600)
    vy = run.v[:, 1, 0]
    impact = int(np.flatnonzero(np.diff(vy) > 1.0)[0])
    assert -vy[impact + 1] / vy[impact] == pytest.approx(0.7, abs=0.005)


def test_soft_becomes_lcp_as_d_goes_to_one():
    """With K = 0 and B = 1 / dt the target is 0, as lcp's without push; only R is left."""
    scene = contact.build_scene("drop")
    hard = contact.run_model("lcp", scene, DT, 400, baumgarte=0.0)
    apart = []
    for d in (0.9, 0.99, 0.999, 0.9999):
        run = contact.run_model(
            "soft", scene, DT, 400, solref=(0.0, -d / DT), solimp=(d, d, 0.001, 0.5, 2.0)
        )
        apart.append(np.abs(run.q - hard.q).max() / 0.1)
    assert all(later < 0.15 * earlier for earlier, later in zip(apart, apart[1:])), apart
    assert apart[-1] < 2e-4


def test_the_order_of_the_sweep_does_not_matter_to_rounding():
    """A softness makes the problem strictly convex, so any order ends in the same impulses."""
    results = []
    for order in (1, -1):
        scene = contact.build_scene("pile", bodies=10)
        balls = contact.make_balls(scene)
        for _ in range(250):
            contact.soft_step(balls, DT, contact.SOLREF, contact.SOLIMP)
        contacts = contact.detect_contacts(balls, margin=0.0)
        for c in contacts:
            contact.soften(c, DT, contact.SOLREF, contact.SOLIMP)
        contact.fall(balls, DT)
        contact.solve_contacts(contacts[::order], 100_000, tolerance=1e-15)
        results.append([c.lam for c in contacts])
    assert len(results[0]) >= 10
    assert results[0] == pytest.approx(results[1], abs=1e-13)


def sweeps_of_a_step(heavy, monkeypatch):
    """How many sweeps soft takes on a ball of that mass [kg] that lands on one of 1 kg, at 1 m/s.

    With the damper 1 / dt and no spring, each contact wants to stop what closes it in one step.
    """
    pushes = []
    push = contact.Contact.push
    monkeypatch.setattr(contact.Contact, "push", lambda c, dp: (pushes.append(c), push(c, dp)))
    fall = -1.0 - DT * contact.GRAVITY  # 1 m/s after gravity has acted
    balls = [contact.Ball(0.0, y, 0.0, fall, m, 0.1) for y, m in ((0.0999, 1.0), (0.2998, heavy))]
    balls.append(contact.Ball(9.0, 9.0, 1.5, fall, 1.0, 0.1))  # the fastest: it touches nothing
    contact.soft_step(balls, DT, (0.0, -0.9999 / DT), contact.HARD)
    return pushes.count(pushes[0])


def test_sweeps_of_soft_end_where_their_corrections_are_below_2_to_the_minus_48_of_the_speeds(
    monkeypatch,
):
    """Between two equal balls each sweep halves the corrections, which begin at 1 m/s.

    The fastest ball has 1.5 m/s: 2^(1-k) <= 1.5 2^-48 from k = 49 on.
    """
    assert sweeps_of_a_step(1.0, monkeypatch) == 49


def test_soft_stops_after_ten_thousand_sweeps_that_have_not_settled(monkeypatch):
    """A million kg on 1 kg: a sweep takes about 2e-4 of the error away, the softness's share."""
    assert sweeps_of_a_step(1e6, monkeypatch) == 10_000


def test_sweeps_of_soft_end_long_before_the_cap():
    calls = []

    class Counted(contact.Contact):
        def push(self, impulse):
            calls.append(impulse)
            super().push(impulse)

    scene = contact.build_scene("stack", bodies=10)
    balls = contact.make_balls(scene)
    for ball in balls:
        ball.y -= 0.01
    contacts = [
        Counted(c.a, c.b, c.nx, c.ny, c.depth + 1e-4) for c in contact.detect_contacts(balls)
    ]
    for c in contacts:
        contact.soften(c, DT, contact.SOLREF, contact.SOLIMP)
    contact.fall(balls, DT)
    contact.solve_contacts(contacts, contact.MOST_SWEEPS, contact.LAST_BITS * 0.1)
    assert len(calls) < 1000 * len(contacts)
