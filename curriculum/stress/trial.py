"""One random scene under test: its runs, each made once, and single steps taken again by hand.

`Step` takes one step of a recorded run again, contact by contact, by the plain functions of
contact.py, and keeps what a recording does not hold: contacts, targets, impulses, residuals.
"""

import math
from functools import cached_property

import numpy as np

from curriculum.stress import scenes, under_test
from curriculum.stress.under_test import contact

U = 2.0**-53  # the largest relative rounding error of one operation
STEPPED = ("penalty", "lcp", "soft")
SECONDS = 1.0  # of CPU time for a run of exact, then the rest of it is not waited for
FEW_EVENTS = 60  # of a run of exact that is made again, in a mirror or at another dt


class Trial:
    """A spec and the runs of it that were asked for."""

    def __init__(self, spec):
        self.spec, self.scene = spec, scenes.to_scene(spec)
        self.fixed = ~np.isfinite(self.scene.mass)
        self.mass = np.where(self.fixed, 0.0, self.scene.mass)  # what is fixed has no energy
        self.dt = spec["dt"]
        self.runs, self.taken = {}, {}

    def run(self, model, **changes):
        """The run of a model, with entries of the spec changed; of exact, as far as it is made."""
        if model == "exact" and not changes:
            return self.exact[0]
        if model == "exact":
            changes = {"steps": self.judged} | changes
        made = model, repr(sorted(changes.items()))
        if made not in self.runs:
            with np.errstate(all="ignore"):
                self.runs[made] = scenes.run(model, self.spec, **changes)
        return self.runs[made]

    @cached_property
    def exact(self):
        """(run of exact, its events in each step), up to the last sample that SECONDS of CPU time reach.

        Samples do not enter the motion, so the shorter run is the beginning of the longer one.
        """
        steps = self.spec["steps"]
        try:
            return under_test.run_exact(self.scene, self.dt, steps, SECONDS)
        except under_test.OutOfTime as stop:
            return under_test.run_exact(self.scene, self.dt, max(0, stop.samples - 1), math.inf)

    @property
    def judged(self):
        """How many steps of exact were made."""
        return len(self.exact[0].t) - 1

    def quality(self, model):
        return contact.contact_quality(self.run(model), self.scene, self.dt)

    def calm(self, model, **changes):
        """Whether the run stays finite and does not explode."""
        run = self.run(model, **changes)
        return contact.blow_up_step(contact.energy(run.q, run.v, self.mass)) is None

    @cached_property
    def overlaps(self):
        """Whether the scene starts in an overlap; exact promises nothing then."""
        return contact.max_penetration(self.scene.q0, self.scene.radius) > 1e-12

    def models(self):
        """The models that promise something about this scene."""
        return STEPPED if self.overlaps else contact.MODELS

    def again(self):
        """The models to run again in another form: exact only where that is quick."""
        slow = self.overlaps or self.exact[1].sum() > FEW_EVENTS
        return STEPPED if slow else contact.MODELS

    def samples(self, model):
        """Up to three steps that have contacts: the first, that of the deepest overlap, the last."""
        run, margin = self.run(model), contact.CONTACT_MARGIN if model == "lcp" else 0.0
        gap = contact.smallest_gap(run.q[:-1], self.scene.radius)
        touching = np.flatnonzero(gap < margin)
        if not len(touching) or not self.calm(model):
            return []
        return sorted({int(touching[0]), int(gap.argmin()), int(touching[-1])})

    def step(self, model, k):
        """Step k of a run, taken again."""
        if (model, k) not in self.taken:
            self.taken[model, k] = Step(self, model, k)
        return self.taken[model, k]


class Step:
    """Step k of a run of lcp or soft, sweep by sweep.

    contacts, solved; before, predicted, after: their v_n at the start, after gravity, at the end;
    lam: their impulses; gap: their gaps at the start; moved: what the last sweep changed in each
    impulse; fastest: the larger speeds, of before and after the sweeps, |vx|, |vy| of every ball;
    objectives: 1/2 lam W lam + lam b after sweeps 0, 1, 2, 4, 8, ...; push_rounding: how far the
    pushes that were made may have rounded sum m v_x; peak: the largest m |v_x| of a ball.
    """

    def __init__(self, trial, model, k, backwards=False):
        run, spec = trial.run(model), trial.spec
        self.k, self.dt, self.model = k, trial.dt, model
        self.balls = contact.make_balls(trial.scene._replace(q0=run.q[k], v0=run.v[k]))
        margin = contact.CONTACT_MARGIN if model == "lcp" else 0.0
        self.contacts = contact.detect_contacts(self.balls, margin)
        if backwards:
            self.contacts.reverse()
        self.before = self.speeds()
        solref, solimp = contact.soft_defaults(spec["restitution"], self.dt, spec.get("solref"))
        for c in self.contacts:
            if model == "lcp":
                c.target = contact.contact_target(
                    c, spec["restitution"], spec["baumgarte"], self.dt
                )
            else:
                contact.soften(c, self.dt, solref, solimp)
        self.target = np.array([c.target for c in self.contacts])
        self.softness = np.array([c.softness for c in self.contacts])
        contact.fall(self.balls, self.dt)
        self.predicted, falling = self.speeds(), self.state()[2:]
        self.solve(spec["iters"] if model == "lcp" else contact.MOST_SWEEPS)
        self.after = self.speeds()
        self.lam = np.array([c.lam for c in self.contacts])
        self.fastest = np.maximum(np.abs(falling), np.abs(self.state()[2:])).ravel()
        contact.move(self.balls, self.dt)

    def solve(self, iters):
        """The sweeps one at a time, as solve_contacts goes on from the impulses there are."""
        self.objectives, tolerance = [0.0], self.tolerance()
        self.push_rounding, self.peak = 0.0, self.largest_momentum()
        for sweep in range(1, iters + 1):
            was = np.array([c.lam for c in self.contacts])
            contact.solve_contacts(self.contacts, 1)
            lam = np.array([c.lam for c in self.contacts])
            self.moved = np.abs(lam - was)
            self.count_pushes()
            if self.model == "lcp" and (sweep & (sweep - 1)) == 0:
                free = self.predicted - self.target
                self.objectives.append(float(0.5 * lam @ (self.speeds() - self.target + free)))
            if (self.moved <= tolerance).all():
                break

    def largest_momentum(self):
        """The largest m |v_x| of a ball now."""
        return max((ball.mass * abs(ball.vx) for ball in self.balls if ball.inv_mass), default=0.0)

    def count_pushes(self):
        """Add what the last sweep rounded: 6 U of each push along x, and U of two momenta each."""
        pushes = self.moved * [abs(c.nx) for c in self.contacts]
        self.peak = max(self.peak, self.largest_momentum() + pushes.sum())
        self.push_rounding += U * (6 * pushes.sum() + 2 * np.count_nonzero(pushes) * self.peak)

    def tolerance(self):
        """The change of each impulse below which soft has settled; lcp goes on to the last bit."""
        if self.model == "lcp":
            return 0.0
        speeds = [abs(s) for ball in self.balls for s in (ball.vx, ball.vy)]
        fastest = max([*speeds, *np.abs(self.target)])
        return contact.LAST_BITS * fastest * np.array([c.m_eff for c in self.contacts])

    def speeds(self):
        """v_n of every contact now."""
        return np.array([c.v_n() for c in self.contacts])

    @cached_property
    def gap(self):
        return np.array([-c.depth for c in self.contacts])

    @cached_property
    def residual(self):
        """w = v_n + softness lam - target of every contact at the end of the sweeps."""
        return self.after + self.softness * self.lam - self.target

    @cached_property
    def jacobian(self):
        """J (contacts, 2 N), with v_n = J (vx, vy)."""
        place = {id(ball): k for k, ball in enumerate(self.balls)}
        rows = np.zeros((len(self.contacts), 2, len(self.balls)))
        for row, c in zip(rows, self.contacts):
            row[:, place[id(c.a)]] += c.nx, c.ny
            if c.b is not contact.FLOOR:
                row[:, place[id(c.b)]] -= c.nx, c.ny
        return rows.reshape(len(rows), -1)

    @cached_property
    def delassus(self):
        """W = J M^-1 J^T."""
        inverse = np.tile([ball.inv_mass for ball in self.balls], 2)
        return (self.jacobian * inverse) @ self.jacobian.T

    def unsettled(self):
        """How far v_n of each contact can be off after its turn: sum over others of |W| |dlam|."""
        return np.abs(self.delassus) @ self.moved

    def state(self):
        """Positions and velocities (4, N) after the step."""
        return np.reshape(contact.state_of(self.balls), (-1, 4)).T
