"""detect_contacts and solve_contacts, used as chapter 3.6 will: a moving disc pushes discs along.

Seen from above: no gravity, no floor, no friction. The pusher moves along x as it is told.
"""

import numpy as np
import pytest

import contact

DT, SPEED = 0.01, 0.4


def lattice():
    """A pusher of radius 0.2 left of six discs of radius 0.1, a triangle with one in front.

    A long way from y = 0, which is no table here.
    """
    x = [0.0, 0.35, 0.52, 0.52, 0.70, 0.70, 0.70]
    y = [5.0, 5.0, 5.11, 4.89, 5.22, 5.0, 4.78]
    return [x, y], [0.2] + [0.1] * 6


def push(inv_mass, steps, as_rows=list):
    """Steps of: contacts, impulses, then move. Returns states, and the impulses along x by body."""
    q, radius = lattice()
    q, v = [as_rows(row) for row in q], [as_rows([SPEED] + [0.0] * 6), as_rows([0.0] * 7)]
    radius, inv_mass = as_rows(radius), as_rows(inv_mass)
    states, given = [], np.zeros(7)
    for _ in range(steps):
        contacts = contact.detect_contacts(q, radius)
        target = contact.contact_targets(v, contacts, 0.0, 0.2, DT)
        v, lam = contact.solve_contacts(v, inv_mass, contacts, target, 100)
        for (i, j, nx, ny, depth), impulse in zip(contacts, lam):
            assert impulse >= 0.0, "a contact pulled"
            given[i] += impulse * nx
            given[j] -= impulse * nx
        q = [[a + DT * b for a, b in zip(row, rate)] for row, rate in zip(q, v)]
        q = [as_rows(row) for row in q]
        states.append((np.array(q), np.array(v), contacts))
    return states, given


def test_a_disc_that_nothing_moves_pushes_a_cluster_and_keeps_its_own_speed():
    """inv_mass 0: it moves as it is told. After 2 s it has gone 0.8 m, and nothing is behind it."""
    states, given = push([0.0] + [1.0] * 6, 200)
    q, v, _ = states[-1]
    assert v[0, 0] == SPEED and v[1, 0] == 0.0
    assert q[0, 0] == pytest.approx(0.8)
    touched = v[0, 1:] > 0.0
    assert touched.sum() >= 4 and (v[0, 1:] > -1e-12).all()
    assert (q[0, 1:][np.abs(q[1, 1:] - 5.0) < 0.1] > q[0, 0]).all(), "a disc went through"


def test_what_the_discs_gain_along_x_is_what_the_contacts_gave_them():
    """Change of momentum = impulse, body by body; the pusher's impulses sum to the total."""
    mass = np.array([1.0, 2.0, 0.5, 1.0, 3.0, 1.0])
    states, given = push([0.0, *(1.0 / mass)], 200)
    _, v, _ = states[-1]
    assert mass * v[0, 1:] == pytest.approx(given[1:], abs=1e-12)
    assert given.sum() == pytest.approx(0.0, abs=1e-12)
    assert -given[0] == pytest.approx((mass * v[0, 1:]).sum(), abs=1e-12) and -given[0] > 0.5


def test_with_a_heavy_pusher_momentum_along_both_axes_stays_what_it_was():
    mass = np.array([50.0, 1.0, 2.0, 0.5, 1.0, 3.0, 1.0])
    states, _ = push((1.0 / mass).tolist(), 200)
    for _, v, _ in states:
        assert (mass * v[0]).sum() == pytest.approx(50.0 * SPEED, rel=1e-13)
        assert (mass * v[1]).sum() == pytest.approx(0.0, abs=1e-12)
    kinetic = [(0.5 * mass * (v * v).sum(0)).sum() for _, v, _ in states]
    assert kinetic[-1] < 0.5 * 50.0 * SPEED**2, "pushing without restitution lost no energy"


def test_discs_overlap_hardly_while_they_are_pushed():
    states, _ = push([0.0] + [1.0] * 6, 200)
    deepest = max((depth for _, _, contacts in states for *_, depth in contacts), default=0.0)
    print(f"deepest {deepest:.2e} m")
    assert 0.0 < deepest < 0.05 * 0.1


def test_a_symmetric_cluster_opens_symmetrically():
    q, v, _ = push([0.0] + [1.0] * 6, 120)[0][-1]
    assert q[0, 2] == pytest.approx(q[0, 3], abs=1e-9)
    assert q[1, 2] - 5.0 == pytest.approx(5.0 - q[1, 3], abs=1e-9)


def test_rows_may_be_lists_or_arrays():
    inv_mass = [0.0] + [1.0] * 6
    lists, arrays = (push(inv_mass, 60, as_rows=rows)[0][-1] for rows in (list, np.array))
    assert lists[0].tobytes() == arrays[0].tobytes() and lists[1].tobytes() == arrays[1].tobytes()


def test_a_pusher_against_a_wall_that_nothing_moves_changes_nothing():
    """Two bodies of inv_mass 0: no impulse can part them, and none is divided by zero."""
    contacts = [(0, 1, -1.0, 0.0, 0.01)]
    v, lam = contact.solve_contacts([[1.0, 0.0], [0.0, 0.0]], [0.0, 0.0], contacts, [0.0], 20)
    assert v == [[1.0, 0.0], [0.0, 0.0]] and lam == [0.0]
