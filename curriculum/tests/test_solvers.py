"""The known solvers, rows of one table, are what their makers say: each beside its own witness."""

import math

import numpy as np
import pytest

import contact

optimize = pytest.importorskip("scipy.optimize", reason="scipy is missing: the extra `bench`")

from curriculum.bench import solvers  # noqa: E402

R, g = contact.RADIUS, 9.81


def touching(q, radius):
    """(J, depth) of all that could touch, by numpy: a row of normals for each."""
    n, rows, depth = len(radius), [], []
    for i in range(n):
        rows.append(np.zeros((n, 2)))
        rows[-1][i] = 0.0, 1.0
        depth.append(radius[i] - q[i, 1])
    for i in range(n):
        for j in range(i + 1, n):
            apart = q[i] - q[j]
            rows.append(np.zeros((n, 2)))
            rows[-1][i] = apart / np.linalg.norm(apart)
            rows[-1][j] = -rows[-1][i]
            depth.append(radius[i] + radius[j] - np.linalg.norm(apart))
    return np.array(rows).reshape(len(rows), -1), np.array(depth)


def least_change(J, inverse, v, target, soft):
    """v, lam of the least change, in energy, with J v + soft lam >= target (Lawson and Hanson)."""
    if not len(J):  # nnls without columns may end the process
        return v, np.zeros(0)
    G = np.hstack((J * np.sqrt(inverse), np.diag(np.sqrt(soft))))
    E = np.vstack((G.T, target - J @ v))
    u, _ = optimize.nnls(E, np.eye(len(E))[-1], maxiter=10_000)
    rest = E @ u - np.eye(len(E))[-1]
    lam = -u / rest[-1]
    return v + inverse * (J.T @ lam), lam


@pytest.mark.parametrize("row", solvers.SOLVERS)
def test_a_converged_solver_leaves_the_velocities_of_the_least_change(row):
    s = solvers.SOLVERS[row]._replace(substeps=1, sweeps=20_000)
    s, rng, h = s._replace(relax=20_000 * (s.relax > 0)), np.random.default_rng(3), 0.01
    for _ in range(3):
        q = np.array(((0, 0.95), (1.7, 0.97), (0.9, 2.5), (2.6, 2.4))) * R
        q, v = q + rng.uniform(-0.05, 0.05, (4, 2)) * R, rng.uniform(-1, 1, (4, 2))
        mass, radius = rng.uniform(0.2, 5.0, 4), np.full(4, R)
        balls = contact.make_balls(contact.scene_of(*q.T, mass, vx=v[:, 0], vy=v[:, 1]))
        reach = 2 * h * (np.linalg.norm(v, axis=1).max() + g * h) if s.ahead else 1e-3
        solvers.step(balls, h, s, [0])
        inverse, v = np.repeat(1 / mass, 2), (v - (0, g * h)).ravel()
        J, depth = touching(q, radius)
        near = depth > -reach
        J, depth = J[near], depth[near]
        omega = 2 * math.pi * min(s.hertz, 0.25 / h) * (1 + (np.abs(J).max(1) == 1))  # the floor's
        inside, target = depth > 0, depth / h * (1 if s.ahead else s.gain)
        target[inside] = (omega / (20 + h * omega) * depth if s.hertz else s.gain * depth / h)[
            inside
        ]
        soft = inside * (J**2 @ inverse) / (h * omega * (20 + h * omega)) if s.hertz else 0 * depth
        v, lam = least_change(J, inverse, v, target, soft)
        if s.relax:  # once more, where the balls are now, hard and with no overlap to open
            J, depth = (part[near] for part in touching(q + h * v.reshape(4, 2), radius))
            v, _ = least_change(
                J, inverse, v - inverse * (J.T @ lam), np.minimum(depth, 0) / h, 0 * lam
            )
        found = np.array([(ball.vx, ball.vy) for ball in balls]).ravel()
        assert found == pytest.approx(v, abs=1e-8)


def test_a_sweep_of_jacobi_shares_a_ball_among_its_contacts():
    low, high = contact.make_balls(contact.scene_of(0.0, [R, 3 * R], [1.0, 2.0], vy=-1.0))
    contacts = [contact.Contact(low, contact.FLOOR, 0.0, 1.0, 0.0) for _ in range(3)]
    solvers.jacobi([*contacts, contact.Contact(high, low, 0.0, 1.0, 0.0)], 1, [0])
    assert (low.vy, high.vy) == pytest.approx((-0.25, -1.0))  # a quarter of 1 m/s, three times


@pytest.mark.parametrize("row", ["lcp", "warm", "ahead"])
def test_the_rows_of_lcp_are_contact_py_bit_for_bit(row):
    s, scene = solvers.SOLVERS[row], contact.build_scene("pile", 0, 6)
    mine = contact.simulate(lambda balls: solvers.step(balls, 0.01, s, [0]), scene, 0.01, 60)
    knobs = dict(warm=s.warm, baumgarte=s.gain, ahead=s.ahead, skip=False)
    run = contact.run_model("lcp", scene, 0.01, 60, contact.Settings(**knobs))
    assert mine.q.tobytes() == run.q.tobytes()


def test_xpbd_is_position_based_dynamics():
    scene, dt, n = solvers.PROBLEMS["stack_10"][2](), solvers.DT, 10
    run = contact.simulate(
        lambda balls: solvers.step(balls, dt, solvers.SOLVERS["xpbd"], [0]), scene, dt, 64
    )
    y, v, h = scene.q0[1].copy(), np.zeros(n), dt / 20
    for _ in range(64 * 20):  # predict, push apart what overlaps, take the speeds from the places
        before, y, pairs = y, y + h * (v - h * g), [(k, k + 1) for k in range(n - 1)]
        y[0] = max(y[0], R)
        for low, high in pairs:
            overlap = max(0.0, 2 * R - (y[high] - y[low]))
            y[low], y[high] = y[low] - overlap / 2, y[high] + overlap / 2
        v = (y - before) / h
    assert run.q[-1, 1] == pytest.approx(y, abs=1e-11)


def test_unfinished_sweeps_leave_the_overlap_of_the_law_at_equal_work():
    assert solvers.sag(solvers.SOLVERS["lcp"]._replace(sweeps=1, gain=1.0), np.ones(3), 1e-3) == (
        pytest.approx(2 * g * 1e-6 / R)
    )
    for row, within in (("xpbd", 0.01), ("small_steps", 0.01), ("lcp", 0.15), ("ahead", 0.15)):
        about = solvers.judged((row, "heavy_100"))
        assert about["rest"] == pytest.approx(about["law"], rel=within)
        assert about["solves"] == 20.0 and 0.0 <= about["energy"] <= 1e-9
    about = solvers.judged(("direct", "stack_3"))  # lags by half a step, lands in the next, rests
    assert about["error"] == pytest.approx(g * solvers.DT**2 / 2 / R, rel=1e-3)
    assert (about["rest"], about["energy"]) == pytest.approx((0.0, 0.0), abs=1e-12)
    about = solvers.judged(("small_steps_warm", "heavy_10"))
    assert about["rest"] is None and about["energy"] > 0.1
