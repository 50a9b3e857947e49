"""What leapfrog promises of impacts: no energy is gained, and at e = 1 none is lost.

A job is a number, from which scenes of six kinds are drawn: a heap of 2 to 12 balls that starts
apart, masses up to 100 : 1, radii up to 4 : 1; a ball that flies to and fro in a narrow gap between
two that are fixed, or up to 1e6 times as heavy; a column under a fixed ball, masses up to 1e5 : 1,
that flies apart; columns of two and of three balls; balls and their mirror images. Each runs 1.5 s,
with 1,000 sweeps a solve.
"""

import itertools

import numpy as np

import contact
from curriculum.stress import scenes
from curriculum.stress.trial import G, Trajectory, run_twin

STEPS = {0.002: 750, 0.016: 94}  # dt [s]: how many, 1.5 s in all
KINDS = "heap", "gap", "ceiling", "column of 2", "column of 3", "mirror"  # scenes that are drawn
BOUNCES = {"0": 0.0, "0.5": 0.5, "0.9": 0.9, "1": 1.0, "drawn": None}  # e, and one from 0 to 1
MODELS = "leapfrog", "lcp"
MIRROR = 1e-6  # m, that a mirror-symmetric scene may be off, chosen
KEPT = 1e-9  # share of the start's energy that may come or go, chosen


def heap_jobs(count):
    """Return the jobs of so many heaps."""
    energy = leapfrog_gains_no_energy, leapfrog_loses_none_where_all_bounces
    stated = *energy, leapfrog_stays_symmetric
    return [(f"heap {number}", Heap(number), stated) for number in range(count)]


class Heap:
    """A numbered heap; noted: [gained, lost] of each model, step, kind and restitution."""

    def __init__(self, number):
        self.number, self.noted = number, {"energy": {}}

    def rng(self, what):
        """Return random numbers of this heap."""
        return np.random.default_rng([20261125, self.number, what])

    def e(self, bounce):
        """Return the restitution that a key of BOUNCES means; of "drawn" this heap's own."""
        e = BOUNCES[bounce]
        return self.rng(9).uniform() if e is None else e

    def scene(self, kind, bounce):
        """Return the scene of that kind; bounce: of BOUNCES."""
        e, rng = self.e(bounce), self.rng(KINDS.index(kind))
        while True:
            scene = getattr(scenes, kind.split()[0])(rng, *map(int, kind.split()[2:]))
            if contact.smallest_gap(scene.q0[None], scene.radius)[0] > 0.0:
                return scene._replace(restitution=e)

    def run(self, model, dt, kind, bounce):
        """Return (scene, run, its energies as shares of the first) of the scene of that kind."""
        scene = self.scene(kind, bounce)
        run = run_twin(model, scene, dt, STEPS[dt], contact.Settings(iters=1000))
        total = contact.energy(run.q, run.v, scene.mass)
        total = (total - total[0]) / abs(total[0])
        self.noted["energy"][model, dt, kind, bounce] = total.max(), -total[-1]
        return scene, run, total


def leapfrog_gains_no_energy(heap):
    """leapfrog, e from 0 to 1, dt = 2 and 16 ms: no run that starts apart gains energy."""
    for model, dt, kind, bounce in itertools.product(MODELS, STEPS, KINDS, BOUNCES):
        total = heap.run(model, dt, kind, bounce)[2]
        if model == "leapfrog":
            words = f"{kind}, e = {heap.e(bounce):.3g}, dt = {1e3 * dt:g} ms: relative energy gain"
            yield words, total[1:].max(), KEPT


def leapfrog_loses_none_where_all_bounces(heap):
    """leapfrog, e = 1, dt = 2 ms: no step without resting contacts loses energy.

    Judged where no contact closes slower than gravity makes it in two steps, neither before nor
    after; and not under a ceiling, where more impacts meet in a step than leapfrog tells apart.
    """
    for kind in KINDS:
        if kind != "ceiling":
            scene, run, total = heap.run("leapfrog", 0.002, kind, "1")
            slow = Trajectory(scene, 0.002, run).slowest() < 2.0 * G * 0.002
            words = f"{kind}, e = 1, dt = 2 ms: relative energy loss"
            yield words, -np.diff(total), KEPT, ~(slow[1:] | slow[:-1])


def leapfrog_stays_symmetric(heap):
    """leapfrog, e from 0 to 1, at 2 and 16 ms: a mirror-symmetric scene stays symmetric for 0.5 s.

    Later round-off has grown where a ball stands on an edge. Bound: 1e-6 m, chosen.
    """
    for dt, bounce in itertools.product(STEPS, BOUNCES):
        q = heap.run("leapfrog", dt, "mirror", bounce)[1].q[: STEPS[dt] // 3]
        count = q.shape[2] // 2
        image = np.concatenate((q[:, :, count:-1], q[:, :, :count], q[:, :, -1:]), axis=2)
        image[:, 0] *= -1.0
        words = f"mirror, e = {heap.e(bounce):.3g}, dt = {1e3 * dt:g} ms: off its image [m]"
        yield words, np.abs(q - image), MIRROR


def energy_rows(cases):
    """Yield a row a step, kind and model: the largest gain of each restitution, and loss of 1."""
    columns = [(bounce, bounce, 0) for bounce in BOUNCES] + [("lost", "1", 1)]
    for dt, kind, model in itertools.product(STEPS, KINDS, MODELS):
        row = {"dt": f"{1e3 * dt:g} ms", "scenes": kind, "model": model}
        for name, bounce, which in columns:
            most = max(case[model, dt, kind, bounce][which] for case in cases)
            row[name] = float(f"{most:.1g}") if most > KEPT else 0.0
        yield row | {"runs": len(cases) * len(BOUNCES)}
