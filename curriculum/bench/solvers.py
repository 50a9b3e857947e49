"""The complementarity problem alone: time against residual, on towers and on piles.

    lam >= 0,  w = W lam + b >= 0,  lam w = 0        W = J M^-1 J', b = J v: lcp with no push

A problem is a set of contacts of balls at rest on which gravity has acted for one step. Every
solver gets it in the form it wants, which is not timed, and gives impulses; the residual
max |min(lam, W lam + b)| is computed here, from the impulses alone. The sweeps are contact.py's
own, and those of its compiled twin; the pivot is that of curriculum/exact.py.
"""

import importlib.util
import multiprocessing
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

import contact
from curriculum import measured
from curriculum.bench import engines, timing
from curriculum.common.stoppable import end_at_ctrl_c

COMMAND = "python -m curriculum.bench solvers"
CODE = ("contact.py", "curriculum/exact.py", "curriculum/piles.py")
DT = 0.002  # s, the step of which the problem is taken
SWEEPS = (1, 3, 10, 30, 100, 300, 1000, 3000, 10000)
CASES = (
    "tower of 10",
    "tower of 30",
    "tower of 100",
    "tower of 300",
    "pile of 50",
    "pile of 100",
    "pile of 200",
    "pile of 300",
)
TARGETS = (1e-3, 1e-9)  # m/s, residuals at which the profiles are drawn
START_UP = 20.0  # s that a fresh process may take beside it
LIMIT = 10.0  # s: a solver that takes longer on a problem is stopped


class Case(NamedTuple):
    """One problem: its balls and contacts as contact.py has them, and its matrices."""

    name: str
    balls: list  # after gravity has acted
    contacts: list  # with target 0
    J: np.ndarray  # (K, 2 N): v_n = J (vx, vy)
    inv_mass: np.ndarray  # (2 N,)
    W: np.ndarray
    b: np.ndarray

    def residual(self, lam):
        """max |min(lam, W lam + b)|: 0 for the answer, and for nothing else."""
        return float(np.abs(np.minimum(lam, self.W @ lam + self.b)).max())

    def scene(self):
        """The balls as an engine takes them, before gravity."""
        q, v = np.reshape(contact.state_of(self.balls), (-1, 2, 2)).transpose(1, 2, 0)
        return contact.Scene(
            self.name,
            q,
            np.zeros_like(v),
            np.array([ball.mass for ball in self.balls]),
            np.array([ball.radius for ball in self.balls]),
            0.0,
            0.0,
        )


class Solver(NamedTuple):
    """prepare(case) -> a call that returns impulses (K,); only the call is timed."""

    name: str
    prepare: Callable
    missing: str = ""


def case_of(name, scene):
    """The problem that a scene at rest poses in its next step."""
    balls = contact.make_balls(scene)
    contacts = contact.detect_contacts(balls)
    for ball in balls:
        ball.vx = ball.vy = 0.0
    contact.fall(balls, DT)
    number, count = {id(ball): k for k, ball in enumerate(balls)}, len(balls)
    J = np.zeros((len(contacts), 2 * count))
    for row, c in enumerate(contacts):
        for ball, sign in ((c.a, 1.0), (c.b, -1.0)):
            if ball is not contact.FLOOR:
                k = number[id(ball)]
                J[row, k], J[row, count + k] = sign * c.nx, sign * c.ny
    inv_mass = np.tile([ball.inv_mass for ball in balls], 2)
    v = np.array([[ball.vx for ball in balls], [ball.vy for ball in balls]]).ravel()
    return Case(name, balls, contacts, J, inv_mass, (J * inv_mass) @ J.T, J @ v)


@lru_cache
def case(name):
    """A tower that stands, or a pile that lcp has let fall for a second, by its name."""
    kind, count = name.split(" of ")
    if kind == "tower":
        tower = contact.build_scene("stack", 0, int(count))
        tower.q0[1] -= tower.q0[1, 0] - contact.RADIUS
        return case_of(name, tower)
    pile = contact.build_scene("pile", int(count) % 7, int(count))
    return case_of(
        name, pile._replace(q0=contact.run_model("lcp", pile, 0.004, 250, iters=30).q[-1])
    )


# the solvers


def sweeps(count):
    """So many of contact.py's sweeps, from zero."""

    def prepare(case):
        fresh = case_of(case.name, case.scene())

        def call():
            contact.solve_contacts(fresh.contacts, count)
            return [c.lam for c in fresh.contacts]

        return call

    return prepare


def compiled_sweeps(count):
    """The same sweeps by the compiled twin."""

    def prepare(case):
        from curriculum import piles

        balls = np.zeros(len(case.balls) + 1, piles.BALL)
        for row, ball in zip(balls, case.balls):
            row["vx"], row["vy"], row["inv_mass"] = ball.vx, ball.vy, ball.inv_mass
        contacts = np.zeros(len(case.contacts), piles.CONTACT)
        number = {id(ball): k for k, ball in enumerate((*case.balls, contact.FLOOR))}
        for row, c in zip(contacts, case.contacts):
            row["a"], row["b"], row["nx"], row["ny"] = number[id(c.a)], number[id(c.b)], c.nx, c.ny
            row["m_eff"] = c.m_eff

        def call():
            piles.solve_contacts(balls, contacts, count, 0.0)
            return contacts["lam"]

        return call

    return prepare


def pivot(case):
    from curriculum import exact

    return lambda: exact.solve_lcp(case.W, case.b)


def quadprog(case):
    """min lam'W lam / 2 + b'lam over lam >= 0. It wants W definite: 1e-12 on the diagonal."""
    from quadprog import solve_qp

    definite, unit = case.W + 1e-12 * np.eye(len(case.b)), np.eye(len(case.b))
    none = np.zeros(len(case.b))
    return lambda: solve_qp(definite, -case.b, unit, none)[0]


def nnls(case):
    """min |M^-1/2 J' lam + M^1/2 v| over lam >= 0: the same answer, for any rank of W."""
    from scipy.optimize import nnls as solve

    root = np.sqrt(case.inv_mass)
    matrix = (case.J * root).T
    v = np.array([[ball.vx for ball in case.balls], [ball.vy for ball in case.balls]]).ravel()
    return lambda: solve(matrix, -v / root, maxiter=100 * len(case.b))[0]


def nnls_cholesky(case):
    """min |L' lam + L^-1 b| with W = L L': for W of full rank only."""
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls as solve

    lower = np.linalg.cholesky(case.W)
    right = -solve_triangular(lower, case.b, lower=True)
    return lambda: solve(np.ascontiguousarray(lower.T), right, maxiter=100 * len(case.b))[0]


def lemke(case):
    """Lemke's complementary pivoting, as Drake has it (after Moby)."""
    from pydrake.solvers import MathematicalProgram, MobyLcpSolver

    program = MathematicalProgram()
    lam = program.NewContinuousVariables(len(case.b))
    program.AddLinearComplementarityConstraint(case.W, case.b, lam)
    solver = MobyLcpSolver()
    return lambda: solver.Solve(program).GetSolution(lam)


def mujoco_dual(count):
    """MuJoCo's PGS on its dual: hard as its solimp allows, so many sweeps, no warm start."""

    def prepare(case):
        import mujoco

        world = engines.Mujoco(
            case.scene(),
            DT,
            lambda scene, dt: (f"0 {-1.0 / dt!r}", "0.9999 0.9999 0.001"),
            solver="PGS",
            iterations=count,
            tolerance=0.0,
            flags=' warmstart="disable"',
            margin=0.5 * contact.CONTACT_MARGIN,
        )  # of two geoms the margins add
        model, data = world.model, world.data
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        rows = order_of(case, data)
        return MujocoCall(model, data, rows)

    return prepare


class MujocoCall:
    """The engine's solver alone; the impulses are read afterwards, untimed."""

    def __init__(self, model, data, rows):
        from mujoco import mj_fwdConstraint

        self.solve, self.model, self.data, self.rows = mj_fwdConstraint, model, data, rows

    def __call__(self):
        self.solve(self.model, self.data)

    def impulses(self):
        return self.data.efc_force[self.rows] * DT


def order_of(case, data):
    """Which of MuJoCo's rows is each of our contacts."""
    number = {id(ball): k for k, ball in enumerate(case.balls)}
    number[id(contact.FLOOR)] = -1
    theirs = {
        tuple(sorted(int(geom) - 1 for geom in data.contact[k].geom)): k for k in range(data.ncon)
    }
    return [theirs[tuple(sorted((number[id(c.a)], number[id(c.b)])))] for c in case.contacts]


def need(module, package=None):
    """What to install, or an empty text."""
    if importlib.util.find_spec(module) is None:
        return f"not installed: pip install {package or module}"
    return ""


def solvers():
    """All of them, in the order of the page."""
    for count in SWEEPS:
        yield Solver(f"sweeps, {count}", sweeps(count))
    for count in SWEEPS:
        yield Solver(f"compiled sweeps, {count}", compiled_sweeps(count), need("numba"))
    yield Solver("pivot of exact", pivot)
    yield Solver("quadprog", quadprog, need("quadprog"))
    yield Solver("nnls", nnls, need("scipy"))
    yield Solver("nnls on Cholesky", nnls_cholesky, need("scipy"))
    yield Solver("Lemke (Drake)", lemke, need("pydrake", "drake"))
    for count in SWEEPS[:7]:
        yield Solver(f"MuJoCo's dual, {count}", mujoco_dual(count), need("mujoco"))


# measuring


def measure(quick=False, cells=None):
    """{cases, rows, missing}: for every case and solver the residual and the time [s].

    All run in a process of their own, which is stopped when a solver does not end.
    """
    cells = {} if cells is None else cells
    names, rounds = CASES[:2] + CASES[4:5] if quick else CASES, 2 if quick else 5
    chosen = [s for s in solvers() if not (quick and s.name.endswith("000"))]
    keys = [(name, s.name, rounds) for name in names for s in chosen if not s.missing]
    with measured.progress(len(keys), "solvers") as tick, Worker() as worker:
        for key in keys:
            if f"{key[0]}: {key[1]}" not in cells:
                cells[f"{key[0]}: {key[1]}"] = worker(solve, key)
            tick(key[1])
    rows = [
        dict(case=name, solver=solver, **cells[f"{name}: {solver}"]) for name, solver, _ in keys
    ]
    return dict(
        quick=quick,
        rounds=rounds,
        rows=rows,
        cases={name: about(name) for name in names},
        missing={s.name: s.missing for s in chosen if s.missing},
    )


def about(name):
    found = case(name)
    return dict(
        balls=len(found.balls),
        contacts=len(found.contacts),
        rank=int(np.linalg.matrix_rank(found.W)),
    )


class Worker:
    """A process that answers one call after the other; one that takes too long is replaced."""

    def __init__(self):
        self.pool = None

    def __enter__(self):
        return self

    def __exit__(self, *trouble):
        if self.pool:
            self.pool.terminate()

    def __call__(self, work, key):
        self.pool = self.pool or multiprocessing.get_context("spawn").Pool(1, end_at_ctrl_c)
        try:
            return self.pool.apply_async(work, (key,)).get(START_UP + LIMIT)
        except multiprocessing.TimeoutError:
            self.pool.terminate()
            self.pool = None
            return failure(f"stopped after {LIMIT:g} s")


def failure(why):
    return dict(residual=None, median=None, min=None, max=None, failed=why)


def solve(key):
    """Residual and times of one solver on one case; where it fails, why."""
    name, solver, rounds = key
    posed, solver = case(name), next(s for s in solvers() if s.name == solver)
    try:
        call = solver.prepare(posed)
        lam, first = call(), timing.timed(solver.prepare(posed))
        lam = call.impulses() if hasattr(call, "impulses") else lam
        more = rounds - 1 if first < 0.3 else 1
        seconds = [first, *(timing.timed(solver.prepare(posed)) for _ in range(more))]
    except Exception as error:  # a solver that gives up is a result, whatever it raises
        return failure(f"{type(error).__name__}: {error}"[:120])
    return dict(
        residual=posed.residual(np.array(lam, dtype=float)), failed=None, **timing.spread(seconds)
    )
