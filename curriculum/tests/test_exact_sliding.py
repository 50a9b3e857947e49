"""exact where balls slide over one another, held to independent integrations and to what is kept.

References: the pendulum upside down in 30 digits, and Lagrange's equations with multipliers for a
set of contacts that is written down by hand, integrated by the classical Runge-Kutta method.
"""

from typing import NamedTuple

import numpy as np
import pytest
from mpmath import mp

import contact
from curriculum import exact
from curriculum.stress import precise_tower, scenes

R, G = 0.1, -9.81


class Scene(NamedTuple):
    q0: np.ndarray
    v0: np.ndarray
    mass: np.ndarray
    radius: np.ndarray
    restitution: float = 0.0


def scene(x, y, mass, radius=R, restitution=0.0):
    """Balls at rest with centres x, y."""
    q0 = np.array((x, y), dtype=float)
    size = np.full(q0.shape[1], radius) if np.isscalar(radius) else np.array(radius, float)
    return Scene(q0, np.zeros_like(q0), np.array(mass, float), size, restitution)


def energy(scn, q, v):
    """Kinetic and potential energy (S,) [J] of the balls that move."""
    moves = np.isfinite(scn.mass)
    m = scn.mass[moves]
    return (0.5 * m * (v[..., moves] ** 2).sum(-2) - m * G * q[..., 1, moves]).sum(-1)


def hold_motion(scn, q, v, kept=1e-12):
    """No overlap, no energy gained, and momentum along x kept."""
    for k in range(len(scn.mass)):
        assert (q[:, 1, k] - scn.radius[k] >= -1e-10 * R).all()
        for j in range(k):
            apart = np.hypot(*(q[:, :, k] - q[:, :, j]).T) - scn.radius[k] - scn.radius[j]
            assert (apart >= -1e-10 * R).all(), f"balls {j} and {k} overlap"
    total = energy(scn, q, v)
    assert (np.diff(total) <= kept * abs(total[0])).all()
    if np.isfinite(scn.mass).all():
        assert np.abs(v[:, 0] @ scn.mass).max() <= kept * scn.mass.sum()


# A ball off a ball


@pytest.mark.parametrize("theta0", [0.01, 0.1, 0.5])
def test_a_ball_slides_off_a_fixed_ball_as_the_pendulum_upside_down(theta0):
    """theta'' = (g / L) sin theta, until the force is 0 at cos theta = 2/3 cos theta0."""
    length = 2 * R
    x, y = [0.0, length * np.sin(theta0)], [1.0, 1.0 + length * np.cos(theta0)]
    scn = scene(x, y, [np.inf, 1.0])
    with mp.workdps(30):
        k, start = mp.mpf(-G) / mp.mpf(length), mp.mpf(theta0)
        end = mp.acos(2 * mp.cos(start) / 3)

        def rest(s):
            """2 s / theta' at theta = start + s^2, where the integral for the time is smooth;
            theta'^2 = 2 k (cos start - cos theta), as a product that keeps its digits."""
            return 2 * s / mp.sqrt(4 * k * mp.sin(start + s * s / 2) * mp.sin(s * s / 2))

        leaves = mp.quad(rest, [0, mp.sqrt(end - start)])
        path = mp.odefun(lambda t, y: [y[1], k * mp.sin(y[0])], 0, [start, 0])
        angle, late = float(path(leaves / 2)[0]), float(leaves)
    times = np.array([0.0, late / 2, late * (1 - 1e-9), late + 0.01])
    q, v = exact.simulate_exact(scn, times, G)
    assert q[1, :, 1] / R == pytest.approx([2 * np.sin(angle), 10.0 + 2 * np.cos(angle)], abs=1e-11)
    cosine = (q[2, 1, 1] - 1.0) / length
    assert cosine == pytest.approx(2 / 3 * np.cos(theta0), abs=1e-8)
    fall = v[3, 1, 1] - v[2, 1, 1]  # after that it flies: gravity alone changes its velocity
    assert fall == pytest.approx(G * (times[3] - late), abs=1e-7)
    assert v[3, 0, 1] == pytest.approx(np.sqrt(-G * length * cosine) * cosine, abs=1e-8)
    assert (q[:, :, 0] == scn.q0[:, 0]).all()


def test_the_ball_leaves_at_two_thirds_to_1e_10():
    """The flight after the release tells where it was: v_x = sqrt(g L) (2/3 cos theta0)^(3/2)."""
    theta0, length = 0.3, 2 * R
    scn = scene([0.0, length * np.sin(theta0)], [1.0, 1.0 + length * np.cos(theta0)], [np.inf, 1.0])
    _, v = exact.simulate_exact(scn, np.array([0.0, 0.3]), G)
    cosine = (v[1, 0, 1] ** 2 / (-G * length)) ** (1 / 3)
    assert cosine == pytest.approx(2 / 3 * np.cos(theta0), abs=1e-10)


# Against Lagrange's equations for contacts written down by hand


def acceleration(scn, contacts, q, v):
    """a (2, N), lam of contacts (i, j), j = -1 the floor: J M^-1 J' lam = -(J g + J' v)."""
    n = np.zeros((len(contacts), 2, len(scn.mass)))
    turn = np.zeros(len(contacts))
    for k, (i, j) in enumerate(contacts):
        if j < 0:
            n[k, 1, i] = 1.0
            continue
        d, u = q[:, i] - q[:, j], v[:, i] - v[:, j]
        distance = np.hypot(*d)
        n[k, :, i], n[k, :, j] = d / distance, -d / distance
        turn[k] = (u @ u - (d @ u / distance) ** 2) / distance
    J = n.reshape(len(contacts), -1)
    inverse = np.tile(1.0 / scn.mass, 2)
    fall = np.zeros_like(q)
    fall[1] = G
    lam = np.linalg.solve((J * inverse) @ J.T, -(J @ fall.ravel() + turn))
    return fall + (inverse * (lam @ J)).reshape(q.shape), lam


def integrated(scn, contacts, time, steps):
    """q, v at `time` by Runge-Kutta's method; the contacts must push all the way."""
    q, v, h = scn.q0.copy(), scn.v0.copy(), time / steps
    for _ in range(steps):
        a1, lam = acceleration(scn, contacts, q, v)
        assert (lam > 0.0).all(), "the set of contacts does not hold so long"
        a2, _ = acceleration(scn, contacts, q + h / 2 * v, v + h / 2 * a1)
        a3, _ = acceleration(scn, contacts, q + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
        a4, _ = acceleration(scn, contacts, q + h * (v + h / 2 * a2), v + h * a3)
        q, v = q + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return q, v


def on_top(x, y, r, i, j, radius):
    """The centre of a ball of `radius` that lies on balls i and j."""
    a, b = np.array((x[i], y[i])), np.array((x[j], y[j]))
    da, db, d = r[i] + radius, r[j] + radius, np.hypot(*(b - a))
    along = (da * da - db * db + d * d) / (2 * d)
    up = np.sqrt(da * da - along * along)
    e = (b - a) / d
    return a + along * e + up * np.array((-e[1], e[0]))


def on_a_movable_ball(mass, radius, angle=0.4):
    reach = sum(radius)
    x = [0.0, reach * np.sin(angle)]
    return scene(x, [radius[0], radius[0] + reach * np.cos(angle)], mass, radius), [(0, -1), (1, 0)]


def pyramid_of_three():
    return scene([0.0, 2 * R, R], [R, R, R + np.sqrt(3) * R], [1.0] * 3), [
        (0, -1),
        (1, -1),
        (2, 0),
        (2, 1),
    ]


def heap_of_five():
    """Three balls of different sizes on the floor, two in the gaps."""
    r = [0.1, 0.08, 0.12, 0.09, 0.1]
    x = [0.0, 0.26, 0.58]
    y = r[:3]
    for i, j, size in ((0, 1, r[3]), (1, 2, r[4])):
        cx, cy = on_top(x, y, r, i, j, size)
        x, y = [*x, cx], [*y, cy]
    return scene(x, y, [1.0, 0.7, 1.5, 0.8, 1.2], r), [
        (0, -1),
        (1, -1),
        (2, -1),
        (3, 0),
        (3, 1),
        (4, 1),
        (4, 2),
    ]


def hexagonal():
    """3-2-1: the balls of a row touch and do not push, since the rows above part them."""
    x = [0.0, 2 * R, 4 * R, R, 3 * R, 2 * R]
    y = [R + R * np.sqrt(3) * row for row in (0, 0, 0, 1, 1, 2)]
    return scene(x, y, [1.0] * 6), [
        (0, -1),
        (1, -1),
        (2, -1),
        (3, 0),
        (3, 1),
        (4, 1),
        (4, 2),
        (5, 3),
        (5, 4),
    ]


CASES = {
    "equal balls": (on_a_movable_ball([1.0, 1.0], [0.1, 0.1]), 0.08),
    "light on heavy": (on_a_movable_ball([5.0, 0.2], [0.2, 0.05]), 0.08),
    "heavy on light": (on_a_movable_ball([0.3, 4.0], [0.08, 0.15]), 0.06),
    "pyramid of three": (pyramid_of_three(), 0.15),
    "heap of five": (heap_of_five(), 0.04),
    "hexagonal 3-2-1": (hexagonal(), 0.05),
}


@pytest.mark.parametrize("name", CASES)
def test_sliding_is_within_1e_10_r_of_the_constrained_motion(name):
    (scn, contacts), time = CASES[name]
    q, v = exact.simulate_exact(scn, np.linspace(0.0, time, 6), G)
    for k in (3, 5):
        place, speed = integrated(scn, contacts, time * k / 5, 400)
        assert np.abs(q[k] - place).max() <= 1e-10 * R
        assert np.abs(v[k] - speed).max() <= 1e-9
    hold_motion(scn, q, v)
    total = energy(scn, q, v)
    assert np.abs(total - total[0]).max() <= 1e-12 * total[0]


def test_the_pyramid_of_three_lets_go_at_31_885_degrees_and_lands():
    """The lower balls are fastest where the force ends: the maximum over the angle of what energy
    and momentum give, u^2 = 2 r g (sin 60 - sin phi) / (1 + cot^2 phi / 2)."""
    scn, _ = pyramid_of_three()
    times = np.linspace(0.0, 0.33, 3301)
    q, v = exact.simulate_exact(scn, times, G)
    phi = np.radians(np.linspace(31.0, 33.0, 200_001))
    u = np.sqrt(-2 * R * G * (np.sin(np.pi / 3) - np.sin(phi)) / (1 + 0.5 / np.tan(phi) ** 2))
    assert np.degrees(phi[u.argmax()]) == pytest.approx(31.885, abs=1e-3)
    assert v[-1, 0, 1] == pytest.approx(u.max(), rel=1e-10)
    landed = times[np.argmax(q[:, 1, 2] <= R * (1 + 1e-9))]
    assert landed == pytest.approx(0.32161, abs=1e-4)
    hold_motion(scn, q, v)


# Impacts, piles, samples


@pytest.mark.parametrize("e", [0.0, 0.5])
def test_impacts_join_contacts_that_slide(e):
    """Balls fall on a heap that slides: nothing overlaps, no energy is gained, x-momentum stays."""
    scn, _ = pyramid_of_three()
    q0 = np.append(scn.q0, [[0.13, -0.1], [0.6, 0.75]], 1)
    scn = Scene(q0, np.zeros_like(q0), np.array([1.0, 1.0, 1.0, 0.5, 2.0]), np.full(5, R), e)
    q, v = exact.simulate_exact(scn, np.linspace(0.0, 1.0, 1001), G)
    assert np.abs(v[:, 0, 0]).max() > 0.5
    hold_motion(scn, q, v)


@pytest.mark.parametrize("seed, e", [(0, 0.0), (1, 0.0), (0, 0.5)])
def test_a_pile_of_eight_is_the_same_bits_from_any_sampling(seed, e):
    rng = np.random.default_rng(seed)
    x = 0.25 * (np.arange(8) % 4) + rng.uniform(-0.01, 0.01, 8)
    y = 0.13 + 0.25 * (np.arange(8) // 4) + rng.uniform(0.0, 0.01, 8)
    scn = scene(x, y, np.ones(8), restitution=e)
    fine = exact.simulate_exact(scn, np.arange(1025) / 1024, G)
    for coarse in (np.arange(33) / 32, np.array([0.0, 0.25, 0.3125])):
        rows = np.round(coarse * 1024).astype(int)
        for got, all_of in zip(exact.simulate_exact(scn, coarse, G), fine):
            assert got.tobytes() == all_of[rows].tobytes()
    hold_motion(scn, *fine)


# Unequal masses, against many digits


def tower_error(y, mass, e, time):
    """Worst height error in radii against the simulation in 120 digits; and whether that comes out
    the same without the speeds below 1e-12 m/s, which doubles cannot keep beside others."""
    count = len(y)
    scn = Scene(
        np.array((np.zeros(count), y)), np.zeros((2, count)), np.array(mass), np.full(count, R), e
    )
    times = np.linspace(0.0, time, 21)
    q, _ = exact.simulate_exact(scn, times, G)
    given = (y, np.zeros(count), mass, scn.radius, e, G, times)
    right = precise_tower.heights(*given)
    without = precise_tower.heights(*given, slow=precise_tower.OF_DOUBLES)
    return np.abs(q[:, 1] - right).max() / R, np.abs(without - right).max() <= 1e-9 * R


def test_a_light_ball_between_a_heavy_one_and_the_floor_comes_to_rest_with_it():
    """The light ball is struck infinitely often in finite time: the limit is rest, no rebound."""
    y, mass = np.array([0.6, 1.3]), np.array([0.1, 10.0])
    assert tower_error(y, mass, 0.4, 2.0)[0] <= 1e-9
    scn = Scene(np.array((np.zeros(2), y)), np.zeros((2, 2)), mass, np.full(2, R), 0.4)
    q, v = exact.simulate_exact(scn, np.array([0.0, 2.0]), G)
    assert q[1, 1] == pytest.approx([0.1, 0.3], abs=1e-12) and np.abs(v[1]).max() < 1e-9


def test_touching_contacts_are_not_lost_by_a_last_bit():
    y, mass = np.array([0.6, 0.8, 1.0]), np.array([0.01, 100.0, 100.0])
    assert tower_error(y, mass, 0.7, 1.0)[0] <= 1e-9


@pytest.mark.parametrize("spread", [1.5, 3.0])
def test_towers_of_unequal_masses_are_those_of_120_digits(spread):
    """Where the answer hangs on speeds of 1e-12 m/s and less, two balls that a double sees touch
    are struck one after the other: that is one tower in ten at most."""
    left = 0
    for seed in range(8):
        rng = np.random.default_rng([7, seed])
        count = int(rng.integers(2, 8))
        gaps = rng.uniform(0.0, 0.3, count) * (rng.random(count) < 0.5)
        y = R * (2 * np.arange(count) + 1) + np.cumsum(gaps) + rng.uniform(0.0, 0.4)
        mass = 10.0 ** rng.uniform(-spread, spread, count)
        error, told_by_doubles = tower_error(y, mass, float(rng.choice([0.0, 0.3, 0.6])), 1.0)
        left += not told_by_doubles
        assert error <= 1e-9 or not told_by_doubles, f"seed {seed}: {error:.1e} r"
    assert left <= 1


# Ends


def test_starts_and_speeds_out_of_the_ordinary_end():
    """Overlapping starts are moved apart at once; 1e100 m/s ends; a tower of 30 at rest rests."""
    times = np.linspace(0.0, 0.5, 6)
    deep = scene([0.0, 0.01, 0.02], [-0.3, 0.05, 0.1], [1.0, 2.0, 0.5], restitution=0.4)
    q, v = exact.simulate_exact(deep, times, G)
    hold_motion(deep, q, v)
    fast = scene([0.0], [1.0], [1.0], restitution=0.5)._replace(v0=np.array([[0.0], [-1e100]]))
    assert np.isfinite(exact.simulate_exact(fast, times, G)[0]).all()
    mass = 10.0 ** np.random.default_rng(0).uniform(-3, 3, 30)
    tower = scene(np.zeros(30), R * (2 * np.arange(30) + 1), mass)
    q, _ = exact.simulate_exact(tower, times, G)
    assert np.abs(q - tower.q0).max() <= 1e-9 * R


def test_the_clock_ends_what_no_double_can_decide(monkeypatch):
    """A mass ratio of 1e18: the pushes that carry the heavy ball are lost in round-off."""
    monkeypatch.setattr(exact, "EVENTS", 2)
    events = []
    scn = scene([0.0, 0.0], [0.2, 0.6], [1e-9, 1e9], restitution=0.5)
    q, _ = exact.simulate_exact(scn, np.linspace(0.0, 0.27, 4), G, events.append)
    assert np.isfinite(q).all()
    ticks = 1 + 0.27 / (exact.TICK * np.sqrt(R / -G))
    assert 100 < len(events) < ticks * (2 * 20 + 101)


@pytest.mark.parametrize("number", [8602])
def test_a_slowly_opening_contact_that_is_struck_gains_no_energy(number):
    """Pyramids at e = 1: a contact that opens at 1e-8 m/s while its neighbour is struck. Lifting
    its target from -e v_n to 0, as for a closing contact at the end of its bounces, gains that
    much times the impulse (1e-9 J)."""
    spec = scenes.numbered_spec(number)
    scn, times = scenes.to_scene(spec), np.arange(spec["steps"] + 1) * spec["dt"]
    total = contact.energy(*exact.simulate_exact(scn, times, G), scn.mass)
    assert np.diff(total).max() <= 1e-13 * total[0]


def test_looking_only_at_neighbours_finds_the_same_motion(monkeypatch):
    """Twelve balls look at all others at any time; with homes of half a radius they look about
    again dozens of times. The motion is the same but for the rounding of the new starts."""
    scn, times = contact.build_scene("pile", 3, 12), np.arange(101) * 0.02
    everyone = exact.simulate_exact(scn, times, G)
    looked = []
    find = exact.Motion.move_home
    monkeypatch.setattr(exact.Motion, "move_home", lambda *a: (looked.append(1), find(*a))[1])
    monkeypatch.setattr(exact, "FEW", 0)
    neighbours = exact.simulate_exact(scn, times, G)
    assert len(looked) > 50
    assert np.abs(neighbours[0] - everyone[0]).max() <= 1e-9 * R


def test_a_ball_pushed_out_of_an_overlap_pushes_its_neighbour_on():
    """Two balls overlap by 0.6 r beside a third that is 0.1 r away and a fourth behind that: moved
    apart, the second closes the gap, and the third goes with it. All in the air, so that the
    centre of mass stays where it was."""
    x = np.array([0.0, 1.4, 3.5, 5.6]) * R
    scn = Scene(np.array((x, np.full(4, 10 * R))), np.zeros((2, 4)), np.ones(4), np.full(4, R), 0.0)
    q, _ = exact.simulate_exact(scn, np.array([0.0, 0.01]), G)
    for sample in q:
        assert np.diff(sample[0]).min() >= 2 * R - 1e-12 * R
        assert sample[0].mean() == pytest.approx(x.mean(), abs=1e-14)
