"""The six errors: what the chapter's formulas say of drawn settings, a run does."""

import math
from functools import partial

import numpy as np
import pytest

import contact
from curriculum import predict

RNG = np.random.default_rng(72)


def drawn():
    """A setting: any mass, radius and number of balls; a spring into which they sink by less than
    half a radius; a damper that lets it ring; a step, beta and a warm start; shares of the mass."""
    mass, radius = 10.0 ** RNG.uniform(-1.0, 1.5), RNG.uniform(0.03, 0.3)
    bodies = int(RNG.integers(2, 9))
    stiffness = bodies * mass * predict.G / (RNG.uniform(0.02, 0.5) * radius)
    damping = 2.0 * RNG.uniform(0.05, 0.7) * math.sqrt(stiffness * mass)
    lcp = RNG.uniform((0.001, 0.15, 0.0), (0.006, 1.0, 0.5))
    return mass, radius, bodies, stiffness, damping, lcp, 10.0 ** RNG.uniform(-0.5, 0.5, bodies)


SETTINGS = [drawn() for _ in range(4)]
NEAR = {"rel": 0.03}


@pytest.mark.parametrize("case", range(4))
def test_penalty_sinks_dives_and_trembles_as_on_paper(case):
    mass, radius, bodies, stiffness, damping, *_ = SETTINGS[case]
    spring = partial(predict.quality, "penalty", stiffness=stiffness)
    limit = predict.tremble(mass, stiffness, damping)
    scene = contact.scene_of(0.0, 1.0 + radius, mass, radius, damping=damping)
    found = spring(scene, limit / 60.0, 200.0 * limit + 1.0)
    speed = math.sqrt(2.0 * predict.G)
    dive = predict.dive_of_penalty(speed, mass, stiffness, damping) / radius
    assert found["max_penetration_frac"] == pytest.approx(dive, **NEAR)
    column = contact.scene_of(0.0, radius * (1.0 + 2.0 * np.arange(bodies)), mass, radius)
    column = column._replace(damping=damping)
    limit = predict.tremble(mass, stiffness, damping, bodies)
    for share, rests in ((0.985, True), (1.015, False)):
        step = share * limit
        found = spring(column, step, 20_000 * step)
        assert found["rests"] == rests, share
        if rests:
            sink = predict.sink(mass, stiffness, bodies) / radius
            assert found["rest_penetration_frac"] == pytest.approx(sink, **NEAR)


@pytest.mark.parametrize("case", range(4))
def test_lcp_dives_hops_and_sags_as_on_paper(case):
    mass, radius, bodies, _, _, (dt, beta, warm), shares = SETTINGS[case]
    most = predict.dive_of_lcp(math.sqrt(2.0 * predict.G * predict.FALLS[-1]), dt) / radius
    dives = []
    for fall in predict.FALLS:
        scene = contact.scene_of(0.0, radius + fall, mass, radius)
        found = predict.quality("lcp", scene, dt, 2.0, baumgarte=beta)
        dives.append(found["max_penetration_frac"])
        hop = predict.hop(dives[-1] * radius, dt, beta) / radius
        still = (predict.G * dt * dt + contact.CONTACT_MARGIN) / radius  # less is no hop
        assert found["rebound_frac"] == pytest.approx(hop, abs=still, **NEAR), fall
    assert 0.9 * most < max(dives) < 1.03 * most
    column = contact.scene_of(0.0, radius * (1.0 + 2.0 * np.arange(bodies)), mass, radius)
    masses, dt = mass * shares, 0.001
    knobs = {"baumgarte": beta, "iters": 1, "warm": warm}
    found = predict.quality("lcp", column._replace(mass=masses), dt, 8.0, **knobs)
    above = [masses[k + 1 :].sum() for k in range(bodies)]
    sags = [predict.sag(load, own, dt, beta, 1, warm) for load, own in zip(above, masses)]
    assert found["rest_penetration_frac"] == pytest.approx(max(sags) / radius, **NEAR)


def test_a_tower_sags_by_the_law_within_a_tenth_up_to_a_fortieth_of_its_squared_height():
    for bodies, iters in ((20, 10), (30, 20), (40, 30)):
        scene = contact.build_scene("stack", bodies=bodies)
        found = predict.quality("lcp", scene, 0.002, 6.0, iters=iters)["rest_penetration_frac"]
        sag = predict.sag(bodies - 1.0, 1.0, 0.002, contact.Settings().baumgarte, iters)
        assert found == pytest.approx(sag / contact.RADIUS, rel=0.1)


@pytest.mark.parametrize("start, d0", RNG.uniform((0.05, 0.3), (0.35, 0.9), (4, 2)))
def test_soft_flickers_from_the_angle_of_the_paper_on(start, d0):
    """A stiff contact and a short step, so that the ball is out of its depth at once."""
    solimp = (d0, max(d0, 0.95), 0.001, 0.5, 2.0)
    found = predict.first_without_force(2e-4, start, solref=(0.005, 1.0), solimp=solimp)
    assert found == pytest.approx(predict.flicker(start, d0), **NEAR)


def test_the_command_prints_paper_beside_run_of_ones_own_numbers(capsys):
    assert predict.main("--mass 3 --stiffness 2e4 --damping 30 --dt 0.003 --bodies 5".split()) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:8]]
    by_name = {" ".join(row[:-3]): [*map(float, row[-3:-1])] for row in rows}
    assert by_name["sink"] == [0.014715, 0.014715] and len(by_name) == 7
    for error, (paper, run) in by_name.items():
        assert run == pytest.approx(paper, rel=0.12 if error == "flicker" else 0.03), error
