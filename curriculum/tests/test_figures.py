"""The published chapter's figures, to all the digits it gives, and the formulas behind them."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import contact
from curriculum.bench import closed_form

DT = 0.002


@cache
def measured(name, model, dt=DT, steps=2000, seed=0, **scene):
    made = contact.build_scene(name, seed, **scene)
    return SimpleNamespace(
        **contact.contact_quality(contact.run_model(model, made, dt, steps), made, dt)
    )


@cache
def stability(name):
    """The stability figures as main computes them."""
    scene = contact.build_scene(name)

    def run(model, dt):
        return contact.run_model(model, scene, dt, 2000)

    first = {model: run(model, DT) for model in ("penalty", "lcp", "soft")}
    return contact.measure_stability(run, scene, DT, 1e4, first)


def test_seed_0_drops_from_1_0055_m():
    assert round(float(contact.build_scene("drop").q0[1, 0]), 4) == 1.0055


def test_drop_bounce_and_stack_stand_over_the_origin_at_rest():
    for name in ("drop", "bounce", "stack"):
        scene = contact.build_scene(name, 5)
        assert not scene.q0[0].any() and not scene.v0.any()
    assert scene.q0.shape == (2, 3) and contact.build_scene("pile").q0.shape == (2, 200)


@pytest.mark.parametrize("count, columns", [(50, 10), (30, 8), (1, 2)])
def test_a_pile_fills_a_lattice_of_5_r_over_2_twice_as_wide_as_high(count, columns):
    """Each ball has a place of its own, nudged by up to r / 10; the seed draws in this order."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        lift = abs(rng.uniform(-0.02, 0.02))
        place = rng.permutation(count)
        nudge = rng.uniform(-0.01, 0.01, (2, count))
        x, y = contact.build_scene("pile", seed, count).q0
        # columns about x = 0, the lowest row half a place over the floor, lifted
        column, row = (x - nudge[0]) / 0.25 + (columns - 1) / 2, (y - lift - nudge[1]) / 0.25 - 0.5
        assert np.abs(column - place % columns).max() < 1e-13
        assert np.abs(row - place // columns).max() < 1e-13
        assert lift == pytest.approx(abs(contact.build_scene("drop", seed).q0[1, 0] - 1.0))


# Published values are shares of r; as many decimals are compared as were published.
PUBLISHED = [
    ("drop", "penalty", 2000, "max_penetration_frac", "0.251329183485"),
    ("drop", "penalty", 2000, "rest_penetration_frac", "0.009810000000"),
    ("drop", "lcp", 2000, "max_penetration_frac", "0.056743325071"),
    ("drop", "lcp", 2000, "rest_penetration_frac", "0.000000000000"),
    ("drop", "penalty", 800, "max_penetration_frac", "0.251329183485"),
    ("drop", "penalty", 800, "rest_penetration_frac", "0.00981"),
    ("drop", "lcp", 800, "max_penetration_frac", "0.056743325071"),
    ("drop", "lcp", 800, "rest_penetration_frac", "0.000000000000"),
    ("bounce", "penalty", 2000, "energy_excess", "0.00576"),
    ("bounce", "lcp", 2000, "energy_excess", "0.000000000000"),
    ("bounce", "penalty", 2000, "rest_jitter", "0.0557"),
    ("stack", "penalty", 2000, "max_penetration_frac", "0.059486"),
    ("stack", "penalty", 2000, "rest_penetration_frac", "0.02943"),
    ("stack", "lcp", 2000, "max_penetration_frac", "0.0000050095"),
    ("stack", "lcp", 2000, "rest_penetration_frac", "0.0000041611"),
]


@pytest.mark.parametrize("name, model, steps, key, published", PUBLISHED)
def test_published_figure_comes_out_to_every_digit(name, model, steps, key, published):
    got = getattr(measured(name, model, steps=steps), key)
    decimals = len(published.partition(".")[2])
    print(f"{name} {model} {steps} {key}: got {got!r}, published {published}")
    assert f"{got:.{decimals}f}" == published


@pytest.mark.parametrize(
    "name, model, dt, form, published",
    [
        ("drop", "penalty", 0.03, ".3e", "1.409e+03"),
        ("drop", "lcp", 0.03, "g", "0"),
        ("bounce", "penalty", 0.005, ".3f", "0.148"),
        ("bounce", "lcp", 0.005, "g", "0"),
    ],
)
def test_published_energy_excess_at_a_longer_step(name, model, dt, form, published):
    assert format(measured(name, model, dt=dt).energy_excess, form) == published


@pytest.mark.parametrize("seed, published", [(1, "0.022433"), (2, "0.038544")])
def test_published_lcp_penetration_of_other_seeds(seed, published):
    assert f"{measured('drop', 'lcp', seed=seed).max_penetration_frac:.6f}" == published


@pytest.mark.parametrize("name, penalty, lcp", [("drop", 0.008, 0.064), ("bounce", 0.016, 0.064)])
def test_largest_stable_dt_of_the_grid(name, penalty, lcp):
    assert (stability(name)["penalty"], stability(name)["lcp"]) == (penalty, lcp)


def test_critical_dt_of_the_default_spring_is_20_ms_and_13_54_with_its_damper():
    grid = stability("drop")
    assert grid["dt_crit_penalty"] == pytest.approx(0.02, rel=1e-15)
    assert round(grid["dt_crit_damped"], 5) == 0.01354


@pytest.mark.parametrize("gap, tried", [(0.001, False), (np.nextafter(0.001, 0.0), True)])
def test_a_model_that_comes_no_nearer_than_the_margin_has_not_been_tried(gap, tried):
    """The margin is where a contact is listed from, so a gap of exactly that is none yet."""
    radius = 2.0**-11  # so that radius + margin, less the radius, is the margin to the last bit
    scene = contact.build_scene("drop")._replace(radius=np.array([radius]))
    q = np.array([[[0.0], [radius + gap]]] * 2)
    assert contact.smallest_gap(q, scene.radius)[0] == gap
    hangs = contact.Run(np.array([0.0, DT]), q, np.zeros_like(q))
    grid = contact.measure_stability(
        lambda model, dt: hangs, scene, DT, 1e4, dict.fromkeys(("penalty", "lcp"), hangs)
    )
    assert grid["penalty"] == grid["lcp"] == (32 * DT if tried else None)
    assert grid["lcp_penetration_frac"] == (0.0 if tried else None)


def test_the_grid_halves_the_step_from_32_times_down_to_the_runs_own():
    """A model that explodes at every step is tried at every one, and 0 is reported."""
    scene = contact.build_scene("drop")
    q = np.array([[[0.0], [1.0]], [[0.0], [50.0]]])
    burst = contact.Run(np.array([0.0, DT]), q, np.zeros_like(q))
    tried = []

    def run(model, dt):
        tried.append(dt / DT)
        return burst

    grid = contact.measure_stability(run, scene, DT, 1e4, {"penalty": burst, "lcp": burst})
    assert tried == [32.0, 16.0, 8.0, 4.0, 2.0] * 2
    assert grid["penalty"] == grid["lcp"] == 0.0


# Formulas


@pytest.mark.parametrize("mass, stiffness", [(1.0, 1e4), (1.0, 2e3), (3.0, 1e4), (0.2, 5e4)])
def test_ball_at_rest_sinks_mg_over_k(mass, stiffness):
    scene = contact.build_scene("drop")._replace(mass=np.array([mass]))
    scene = scene._replace(q0=np.array([[0.0], [0.1]]))
    run = contact.run_model("penalty", scene, 0.001, 4000, stiffness=stiffness)
    depth = float(contact.max_penetration(run.q[-1], scene.radius))
    assert depth == pytest.approx(closed_form.rest_depth(mass, stiffness), rel=1e-9)


def test_spring_under_three_balls_carries_three_weights():
    rest = measured("stack", "penalty").rest_penetration_frac
    assert rest == pytest.approx(3 * closed_form.rest_depth(1.0, 1e4) / 0.1, rel=1e-9)


def settles(dt, stiffness, damping):
    """Whether a ball pressed a little into its spring comes to rest in it at this dt."""
    scene = contact.build_scene("drop", damping=damping)
    deep = closed_form.rest_depth(1.0, stiffness)
    scene = scene._replace(q0=np.array([[0.0], [0.1 - 1.01 * deep]]))
    run = contact.run_model("penalty", scene, dt, 4000, stiffness=stiffness)
    late = 0.1 - run.q[-100:, 1, 0]
    return bool(np.abs(late - deep).max() < 0.01 * deep)


def test_default_drop_settles_at_dt_0_0135_and_never_at_0_0140():
    assert measured("drop", "penalty", dt=0.0135, steps=8000).rest_jitter < 1e-9
    assert measured("drop", "penalty", dt=0.0140, steps=8000).rest_jitter > 1e-3


@pytest.mark.parametrize(
    "stiffness, damping", [(1e4, 80.0), (1e4, 10.0), (1e4, 250.0), (500.0, 40.0)]
)
def test_critical_dt_is_where_bisected_simulations_stop_settling(stiffness, damping):
    low, high = 1e-4, 0.3
    assert settles(low, stiffness, damping) and not settles(high, stiffness, damping)
    while high - low > 1e-3 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if settles(middle, stiffness, damping) else (low, middle)
    assert contact.critical_dt(1.0, stiffness, damping) == pytest.approx(low, rel=3e-3)


def test_without_a_spring_a_damper_alone_has_a_critical_dt_and_nothing_has_none():
    """v+ = (1 - c dt / m) v grows from c dt = 2 m on."""
    assert contact.critical_dt(3.0, 0.0, 80.0) == pytest.approx(2.0 * 3.0 / 80.0, rel=1e-15)
    assert contact.critical_dt(3.0, 0.0, 0.0) == np.inf
    assert contact.critical_dt(3.0, 0.1, 0.0) == pytest.approx(2.0 * np.sqrt(30.0), rel=1e-15)


@pytest.mark.parametrize("mass, stiffness, damping", [(1.0, 1e4, 80.0), (2.0, 300.0, 7.0)])
def test_step_matrix_has_an_eigenvalue_minus_one_at_the_critical_dt(mass, stiffness, damping):
    """v+ = v - dt (c v + k x) / m, x+ = x + dt v+: its spectral radius passes 1 there."""

    def radius(dt):
        a, b = dt * stiffness / mass, 1.0 - dt * damping / mass
        return np.abs(np.linalg.eigvals([[1.0 - dt * a, dt * b], [-a, b]])).max()

    dt = contact.critical_dt(mass, stiffness, damping)
    assert radius(0.999 * dt) < 1.0 < radius(1.001 * dt)
    assert radius(dt) == pytest.approx(1.0, abs=1e-9)


def test_a_new_ball_feels_no_force_but_gravity():
    ball = contact.Ball(0.0, 1.0, 0.5, 0.0, 2.0, 0.1)
    contact.semi_implicit_step([ball], DT)
    assert (ball.vx, ball.vy) == (0.5, -9.81 * DT)


@pytest.mark.parametrize("model", ["penalty", "lcp"])
def test_free_fall_lags_the_parabola_by_half_g_t_dt(model):
    scene = contact.build_scene("drop")
    run = contact.run_model(model, scene, DT, 200)
    lag = closed_form.ball_height(scene.q0[1, 0], 0.1, 0.0, run.t) - run.q[:, 1, 0]
    assert np.abs(lag - closed_form.flight_lag(run.t, DT)).max() < 1e-14


# Convergence and order


@cache
def bounces(dt):
    """Runs of the lcp bounce for 4 s, seeds 0 to 8, with their scenes."""
    scenes = [contact.build_scene("bounce", seed) for seed in range(9)]
    return [(contact.run_model("lcp", scene, dt, round(4 / dt)), scene) for scene in scenes]


@pytest.mark.parametrize("dt, allowed", [(0.001, 0.03), (0.002, 0.08), (0.004, 0.13)])
def test_lcp_bounce_is_close_to_the_closed_form(dt, allowed):
    errors = [
        np.abs(run.q[:, 1, 0] - closed_form.ball_height(scene.q0[1, 0], 0.1, 0.7, run.t)).max()
        for run, scene in bounces(dt)
    ]
    print(
        f"dt {dt}: median {np.median(errors) / 0.1:.4f} r of {np.round(np.array(errors) / 0.1, 3)}"
    )
    assert np.median(errors) / 0.1 <= allowed


def test_first_lcp_bounce_has_the_materials_restitution():
    for run, scene in bounces(DT):
        vy = run.v[:, 1, 0]
        up = int((vy > 0.0).argmax())
        print(f"restitution {-vy[up] / vy[up - 1]:.5f}")
        assert -vy[up] / vy[up - 1] == pytest.approx(0.7, abs=0.005)
        # and from the heights alone: closed_form's rebound is e^2 of the gap, first order in dt
        fallen = scene.q0[1, 0] - 0.1
        low = int(run.q[: up + 1, 1, 0].argmin())
        peak = run.q[low : low + 400, 1, 0].max() - 0.1
        assert peak == pytest.approx(closed_form.rebound_gap(fallen, 0.7), abs=0.02 * fallen)


@pytest.mark.parametrize("name", ["drop", "stack"])
def test_penalty_is_the_deeper_for_seeds_0_to_99(name):
    for seed in range(100):
        spring, solve = (
            measured(name, model, seed=seed, steps=800) for model in ("penalty", "lcp")
        )
        assert spring.max_penetration_frac > solve.max_penetration_frac, f"seed {seed}: at worst"
        assert spring.rest_penetration_frac > solve.rest_penetration_frac, f"seed {seed}: at rest"
        assert solve.energy_excess < 1e-12, f"seed {seed}: lcp gained energy"
