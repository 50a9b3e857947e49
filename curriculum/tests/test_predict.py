"""The six errors: what the chapter's formulas say of drawn settings, a run does."""

import math

import numpy as np
import pytest

from curriculum import predict

RNG = np.random.default_rng(72)


def drawn():
    """Two settings of any mass, radius and number of balls, a spring into which they sink by less
    than half a radius, a damper that lets it ring: a step for the spring, a step for lcp."""
    mass, radius = 10.0 ** RNG.uniform(-1.0, 1.5), RNG.uniform(0.03, 0.3)
    bodies, beta = int(RNG.integers(2, 9)), RNG.uniform(0.15, 1.0)
    stiffness = bodies * mass * predict.G / (RNG.uniform(0.02, 0.5) * radius)
    damping = 2.0 * RNG.uniform(0.05, 0.7) * math.sqrt(stiffness * mass)
    dts = predict.tremble(mass, stiffness, damping) / 60.0, RNG.uniform(0.002, 0.006)
    return [(mass, stiffness, damping, dt, bodies, radius, beta, 1) for dt in dts]


@pytest.mark.parametrize("spring, lcp", [drawn() for _ in range(4)])
def test_penalty_and_lcp_err_as_on_paper(spring, lcp):
    spring, lcp = (predict.compare(*setting) for setting in (spring, lcp))
    near = {"sink": 1e-3, "dive of penalty": 0.03, "tremble": 0.02}
    for rows, shares in ((spring, near), (lcp, {"dive of lcp": 0.1, "hop": 0.03, "sag": 0.03})):
        for error, share in shares.items():
            paper, run, _ = rows[error]
            assert run == pytest.approx(paper, rel=share), error


def test_the_command_prints_paper_beside_run_of_ones_own_numbers(capsys):
    assert predict.main("--mass 3 --stiffness 2e4 --damping 30 --dt 0.003 --bodies 5".split()) == 0
    rows = [line.rsplit(maxsplit=3) for line in capsys.readouterr().out.splitlines()[1:8]]
    assert rows[0] == ["sink", "0.014715", "0.014715", "r"] and len(rows) == 7
    for error, paper, run, _ in rows:
        assert float(run) == pytest.approx(float(paper), rel=0.12), error
