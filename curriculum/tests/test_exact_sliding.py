"""exact where balls slide over one another, held to quadrature and to what is conserved."""

from typing import NamedTuple

import numpy as np
import pytest
from mpmath import mp

from curriculum import exact

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


def angle_at(time, theta0, length):
    """theta and its rate of a point that slides from rest at theta0 on a circle, in 30 digits.

    theta'' = (g / L) sin theta is the pendulum, upside down: Taylor steps of mpmath's own solver.
    """
    with mp.workdps(30):
        g = mp.mpf(-G)
        solution = mp.odefun(lambda t, y: [y[1], g / length * mp.sin(y[0])], 0, [theta0, 0])
        return [float(value) for value in solution(time)]


def test_a_ball_on_a_fixed_ball_slides_as_the_pendulum_upside_down():
    theta0, length = 0.1, 2 * R
    scn = scene([0.0, length * np.sin(theta0)], [1.0, 1.0 + length * np.cos(theta0)], [np.inf, 1.0])
    times = np.array([0.0, 0.1, 0.2, 0.3, 0.4])
    q, v = exact.simulate_exact(scn, times, G)
    for k in (1, 2, 3, 4):
        theta, _ = angle_at(times[k], theta0, length)
        assert q[k, :, 1] / R == pytest.approx(
            [length / R * np.sin(theta), (1.0 + length * np.cos(theta)) / R], abs=1e-12
        )
    assert (q[:, :, 0] == scn.q0[:, 0]).all() and (v[:, :, 0] == 0.0).all()


def test_sampling_does_not_enter_the_motion():
    """A ball lands on two and slides off: the same bits at common times, from any grid."""
    scn = scene([0.0, 0.23, 0.13], [R, R, 0.4], [1.0, 1.0, 1.0], restitution=0.3)
    coarse, _ = exact.simulate_exact(scn, np.arange(65) / 64, G)
    fine, _ = exact.simulate_exact(scn, np.arange(1500) / 1024, G)
    assert coarse.tobytes() == fine[:1025:16].tobytes()
