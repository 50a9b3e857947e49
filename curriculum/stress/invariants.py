"""What must hold on any scene, checked on random ones.

Each check is a function of a Trial (a spec and its runs) that returns None when the statement of
its docstring holds, else a few words: what came out. SKIPPED means the statement says nothing
about this scene; a Limit, that it fails in the way and by the amount that the docstring admits.
The energy statements follow from the step itself (docstrings give the lines).
"""

import math
from typing import NamedTuple

import numpy as np

from curriculum.stress import engine, jobs, scenes
from curriculum.stress.engine import contact


class Limit(NamedTuple):
    """A statement missed within what its check admits: by how much, and words for it."""

    size: float
    words: str


SKIPPED = object()
EPS = float(np.finfo(float).eps)
STEPPED = ("penalty", "lcp")
CHECKS = {}


def check(function):
    """Register a check under its name."""
    CHECKS[function.__name__] = function
    return function


class Trial:
    """A spec and the runs of it that were asked for, each made once."""

    def __init__(self, spec):
        self.spec, self.scene, self.runs, self.qualities = spec, scenes.to_scene(spec), {}, {}

    def run(self, model, **changes):
        made = (model, repr(sorted(changes.items())))
        if made not in self.runs:
            try:
                with np.errstate(all="ignore"):
                    self.runs[made] = scenes.run(model, self.spec, **changes)
            except engine.PileUp as pile_up:
                self.runs[made] = pile_up
        if isinstance(self.runs[made], engine.PileUp):
            raise self.runs[made]
        return self.runs[made]

    def quality(self, model):
        if model not in self.qualities:
            self.qualities[model] = contact.contact_quality(
                self.run(model), self.scene, self.spec["dt"]
            )
        return self.qualities[model]

    def exploded(self, model):
        return self.quality(model)["blew_up"]

    def overlaps(self):
        return contact.max_penetration(self.scene.q0, self.scene.radius) > 1e-12

    def models(self):
        """The models that promise something here: exact says nothing on overlapping starts."""
        return STEPPED if self.overlaps() or self.piles_up() else contact.MODELS

    def piles_up(self):
        """Whether exact meets more events than anybody wants to wait for."""
        try:
            self.run("exact")
        except engine.PileUp:
            return True
        return False


def same(a, b):
    """Two arrays hold equal numbers (NaN equals NaN, 0 equals -0)."""
    return np.array_equal(a, b, equal_nan=True)


def first_difference(a, b):
    """Words for where two recordings (steps, 2, N) part."""
    differ = ~((a == b) | (np.isnan(a) & np.isnan(b)))
    step, axis, ball = (int(k[0]) for k in np.nonzero(differ))
    return f"step {step}, {'xy'[axis]} of ball {ball}: {float(a[step, axis, ball])!r} and {float(b[step, axis, ball])!r}"


def unlike(model, run, other):
    """None when two runs are the same numbers, else where they part."""
    for name in ("q", "v"):
        a, b = getattr(run, name), getattr(other, name)
        if not same(a, b):
            return f"{model}, {name}, {first_difference(a, b)}"
    return None


@check
def finite_unless_reported(trial):
    """Every number of a run is finite, or contact_quality reports blew_up and the step."""
    for model in trial.models():
        run = trial.run(model)
        quality = trial.quality(model)
        finite = bool(np.isfinite(run.q).all() and np.isfinite(run.v).all())
        if not finite and not quality["blew_up"]:
            return f"{model}: not finite, yet not reported"
        if quality["blew_up"] != (quality["blew_up_step"] is not None):
            return f"{model}: blew_up {quality['blew_up']} at step {quality['blew_up_step']}"
    return None


@check
def forces_only_push(trial):
    """Penalty forces and lcp impulses are >= 0, and a pair's are equal and opposite."""
    spec, scene = trial.spec, trial.scene
    for model in STEPPED:
        if trial.exploded(model):
            continue
        run = trial.run(model)
        for k in samples(run, 12):
            q, v = rows(run.q[k]), rows(run.v[k])
            contacts = contact.detect_contacts(q, scene.radius)
            if model == "penalty":
                pushes = [
                    contact.penalty_normal_force(
                        c[4], approach(v, c), spec["stiffness"], spec["damping"]
                    )
                    for c in contacts
                    if c[4] > 0
                ]
                fx, fy = contact.penalty_force(
                    q, v, scene.mass, scene.radius, spec["stiffness"], spec["damping"]
                )
                total, size = math.fsum(fx), math.fsum(abs(f) for f in fx)
                if abs(total) > 64 * EPS * size + 1e-300:
                    return (
                        f"penalty, step {k}: forces along x add up to {total:.3g} N of {size:.3g} N"
                    )
            elif contacts:
                pushes = list(solve(trial, q, v, contacts, spec["iters"])[1])
            else:
                continue
            if not all(push >= 0 for push in pushes):
                return f"{model}, step {k}: a contact pulls with {float(min(pushes)):g}"
    return None


@check
def momentum_along_x_is_kept(trial):
    """The table pushes upwards only, so sum m v_x changes by rounding alone, in every model."""
    for model in trial.models():
        if trial.exploded(model):
            continue
        p = trial.run(model).v[:, 0] * trial.scene.mass
        drift = np.abs(p.sum(axis=1) - p[0].sum()).max()
        size = (
            np.abs(p).sum(axis=1).max()
            + np.abs(trial.run(model).v[:, 1] * trial.scene.mass).sum(axis=1).max()
        )
        if drift > 1e-12 * max(1.0, len(p) / 100) * max(size, 1e-3):
            return f"{model}: drifts by {drift:.3g} of {size:.3g} kg m/s"
    return None


@check
def more_sweeps_solve_better(trial):
    """A sweep never raises the solver's objective 1/2 lam W lam + lam (v_n - target) (coordinate descent)."""
    run, spec, scene = trial.run("lcp"), trial.spec, trial.scene
    if trial.exploded("lcp"):
        return SKIPPED
    for k in samples(run):
        q, v = rows(run.q[k]), rows(run.v[k])
        contacts = contact.detect_contacts(q, scene.radius)
        if not contacts:
            continue
        target = contact.contact_targets(
            v, contacts, spec["restitution"], spec["baumgarte"], spec["dt"]
        )
        before = [approach(predicted(v, spec["dt"]), c) - t for c, t in zip(contacts, target)]
        last, size = 0.0, 0.0
        for iters in (1, 2, 5, 20, 100):
            new_v, lam = solve(trial, q, v, contacts, iters)
            after = [approach(new_v, c) - t for c, t in zip(contacts, target)]
            objective = math.fsum(0.5 * l * (a + b) for l, a, b in zip(lam, after, before))
            size = max(
                size, math.fsum(abs(l) * (abs(a) + abs(b)) for l, a, b in zip(lam, after, before))
            )
            if objective > last + 1e-11 * size + 1e-300:
                return f"step {k}: objective {last!r} rises to {objective!r} at {iters} sweeps"
            last = objective
    return None


@check
def complementary_up_to_the_last_sweep(trial):
    """lam > 0 means v_n = target, lam = 0 means v_n >= target, to within what the last sweep still moved.

    A contact is exact when its turn comes; afterwards only the others' last changes of impulse move
    v_n, at most by sum w |dlam| over the two bodies. That sum is the solver's own residual.
    """
    run, spec, scene = trial.run("lcp"), trial.spec, trial.scene
    if trial.exploded("lcp"):
        return SKIPPED
    for k in samples(run):
        q, v = rows(run.q[k]), rows(run.v[k])
        contacts = contact.detect_contacts(q, scene.radius)
        if not contacts:
            continue
        target = contact.contact_targets(
            v, contacts, spec["restitution"], spec["baumgarte"], spec["dt"]
        )
        sweeps = spec["iters"]
        new_v, lam = solve(trial, q, v, contacts, sweeps)
        before = solve(trial, q, v, contacts, sweeps - 1)[1]
        moved = np.zeros(len(scene.mass) + 1)  # sum of |dlam| a body; the floor last
        for c, new, old in zip(contacts, lam, before):
            moved[[c[0], c[1]]] += abs(new - old)
        inverse = np.append(1.0 / scene.mass, 0.0)
        speed = max(
            abs(approach(predicted(v, spec["dt"]), c)) + abs(t) for c, t in zip(contacts, target)
        )
        for c, push, goal in zip(contacts, lam, target):
            off = approach(new_v, c) - goal
            off = abs(off) if push > 0 else max(0.0, -off)
            allowed = sum(inverse[b] * moved[b] for b in c[:2])
            if off > allowed * (1 + 1e-9) + 1e-11 * max(1.0, speed) * max(
                1.0, inverse.max() * scene.mass.max()
            ):
                return f"step {k}, contact {c[:2]}: v_n off by {off:.3g}, allowed {allowed:.3g} m/s"
    return None


@check
def lcp_without_push_never_gains_energy(trial):
    """baumgarte 0: E + e / (1 + e) dt sum m g v_y never rises by more than what sweeps left undone.

    A step changes it by exactly r / (1 + e) - (1 - e) / (1 + e) |v' - v|^2 / 2 (weighted by mass),
    with r = sum lam (v_n' + e v_n), which is 0 once the contacts are solved. From v' - v = dt g +
    M^-1 J^T lam, y' - y = dt v_y', and v_n' = -e v_n + r_n wherever lam > 0. Without e it is E.
    """
    settings, e = {"baumgarte": 0.0}, trial.spec["restitution"]
    run, mass, dt = trial.run("lcp", **settings), trial.scene.mass, trial.spec["dt"]
    lead = e / (1.0 + e) * dt * contact.GRAVITY * (run.v[:, 1] * mass).sum(axis=1)
    total = contact.energy(run.q, run.v, mass) + lead
    size = np.abs(total) + kinetic(run.v, mass) + 1e-3
    law = -(1.0 - e) / (1.0 + e) * kinetic(np.diff(run.v, axis=0), mass)
    for k in np.nonzero(np.diff(total) > law + 1e-11 * size[1:])[0]:
        q, v = rows(run.q[k]), rows(run.v[k])
        contacts = contact.detect_contacts(q, trial.scene.radius)
        goals = contact.contact_targets(v, contacts, e, 0.0, dt)
        if any(
            abs(goal + e * approach(v, c)) > 1e-12 * size[k] for goal, c in zip(goals, contacts)
        ):
            return f"step {k}: a target is not -e v_n"
        new_v, lam = solve(trial, q, v, contacts, trial.spec["iters"], **settings)
        undone = math.fsum(
            l * (approach(new_v, c) + e * approach(v, c)) for l, c in zip(lam, contacts)
        )
        rise = float(total[k + 1] - total[k])
        if abs(rise - law[k] - undone / (1.0 + e)) > 1e-10 * size[k]:
            return f"step {k}: changes by {rise:.3g} J of {size[k]:.3g}, unsolved {undone:.3g}"
    return None


@check
def exact_ends(trial):
    """exact reaches the end of the run within 20,000 events.

    Limit: events pile up where a ball rattles in a closing gap or balls slide in a cluster.
    """
    if trial.overlaps():
        return SKIPPED
    try:
        trial.run("exact")
    except engine.PileUp as pile_up:
        return Limit(float(len(trial.scene.mass)), str(pile_up))
    return None


@check
def exact_never_gains_energy(trial):
    """exact: E never rises by more than rounding, from the start through all sampled times.

    Limit: moving an overlap out (see below) lifts what lies on it, by at most that overlap.
    """
    if "exact" not in trial.models():
        return SKIPPED
    run, weight = trial.run("exact"), float(trial.scene.mass.sum()) * abs(contact.GRAVITY)
    start = contact.energy(trial.scene.q0, trial.scene.v0, trial.scene.mass)
    total = np.append(start, contact.energy(run.q, run.v, trial.scene.mass))
    rise = float(np.diff(total).max())
    size = float(np.abs(total).max() + kinetic(run.v, trial.scene.mass).max())
    if not rise > 1e-9 * size:
        return None
    words = f"E rises by {rise:.3g} J of {size:.3g}"
    return Limit(rise / size, words) if rise <= weight * overlap_bound(trial, run) else words


@check
def exact_never_penetrates(trial):
    """exact: no overlap deeper than 1e-9 of the smallest radius, on starts that do not overlap.

    Limit: while balls slide over one another, normals turn by v dt / r in a sample and contacts that
    close slower than g dt wait for its end: overlaps of a few (v^2 / r + g) dt^2 at a sample.
    """
    if "exact" not in trial.models():
        return SKIPPED
    run, r = trial.run("exact"), float(trial.scene.radius.min())
    deepest = float(np.max(contact.max_penetration(run.q, trial.scene.radius)))
    words = f"{deepest / r:.3g} r deep"
    if not deepest > 1e-9 * r:
        return None
    return Limit(deepest / r, words) if deepest <= overlap_bound(trial, run) else words


def overlap_bound(trial, run):
    """4 (v^2 / r + g) dt^2 [m], a radius at most: the overlap exact may leave where balls slide."""
    speed, r = float(np.abs(run.v).max()), float(trial.scene.radius.min())
    return min(r, 4.0 * (speed**2 / r - contact.GRAVITY) * trial.spec["dt"] ** 2)


@check
def mirrored_in_x_runs_mirrored(trial):
    """x -> -x gives the mirrored run, the same bits."""
    flipped = {name: [-value for value in trial.spec[name]] for name in ("x", "vx")}
    for model in trial.models():
        run, other = trial.run(model), trial.run(model, **flipped)
        mirror = np.array([[-1.0], [1.0]])
        trouble = unlike(model, run, contact.Run(other.t, other.q * mirror, other.v * mirror))
        if trouble:
            return trouble
    return None


@check
def a_run_can_be_taken_up_anywhere(trial):
    """Time does not enter: starting again from the middle gives the second half's bits (penalty, lcp)."""
    steps = trial.spec["steps"]
    half = steps // 2
    for model in STEPPED:
        run = trial.run(model)
        if not np.isfinite(run.q[half]).all():
            continue
        start = dict(zip(("x", "y", "vx", "vy"), (*run.q[half].tolist(), *run.v[half].tolist())))
        again = trial.run(model, **start, steps=steps - half)
        trouble = unlike(model, contact.Run(run.t[half:], run.q[half:], run.v[half:]), again)
        if trouble:
            return trouble
    return None


@check
def a_far_ball_changes_nothing(trial):
    """One more ball, on the table and touching nobody, leaves the bits of the others alone."""
    spec = trial.spec
    extra = {
        "x": max(spec["x"]) + 1000.0,
        "y": 0.1,
        "vx": 0.0,
        "vy": 0.0,
        "mass": 1.0,
        "radius": 0.1,
    }
    more = {name: [*spec[name], value] for name, value in extra.items()}
    for model in trial.models():
        if trial.exploded(model):
            continue
        run, other = trial.run(model), trial.run(model, **more)
        trouble = unlike(model, run, contact.Run(other.t, other.q[..., :-1], other.v[..., :-1]))
        if trouble:
            return trouble
    return None


@check
def skipping_changes_no_bit(trial):
    """skip and no skip give the same bits."""
    for model in STEPPED:
        trouble = unlike(model, trial.run(model), trial.run(model, skip=False))
        if trouble:
            return trouble
    return None


@check
def other_units_give_the_same_run(trial):
    """Lengths x 4, times x 2, masses x 8 (gravity stays): penalty's run scales, the same bits.

    Powers of two are exact. lcp is left out: its contact margin is a length and does not scale.
    """
    if trial.exploded("penalty"):
        return SKIPPED
    spec, length, time, mass = trial.spec, 4.0, 2.0, 8.0
    scale = {
        "x": length,
        "y": length,
        "vx": length / time,
        "vy": length / time,
        "mass": mass,
        "radius": length,
    }
    other = {name: [value * factor for value in spec[name]] for name, factor in scale.items()}
    other |= {
        "dt": spec["dt"] * time,
        "stiffness": spec["stiffness"] * mass / time**2,
        "damping": spec["damping"] * mass / time,
    }
    run, scaled = trial.run("penalty"), trial.run("penalty", **other)
    return unlike("penalty", run, contact.Run(run.t, scaled.q / length, scaled.v * (time / length)))


def rows(state):
    """A recorded state (2, N) as the two rows of plain floats that the step functions take."""
    return state.tolist()


def approach(v, a_contact):
    """Normal velocity of a contact (> 0 separating)."""
    i, j, nx, ny, _ = a_contact
    vx, vy = (0.0, 0.0) if j < 0 else (v[0][j], v[1][j])
    return nx * (v[0][i] - vx) + ny * (v[1][i] - vy)


def predicted(v, dt):
    """Velocities after gravity's part of a step."""
    return [v[0], [vy + dt * contact.GRAVITY for vy in v[1]]]


def solve(trial, q, v, contacts, iters, **changes):
    """(velocities, impulses) of the contact solve an lcp step makes at the state (q, v)."""
    spec = {**trial.spec, **changes}
    target = contact.contact_targets(
        v, contacts, spec["restitution"], spec["baumgarte"], spec["dt"]
    )
    inverse = [1.0 / m for m in spec["mass"]]
    return contact.solve_contacts(predicted(v, spec["dt"]), inverse, contacts, target, iters)


def kinetic(v, mass):
    """Kinetic energy of recorded velocities (steps, 2, N)."""
    return 0.5 * (mass * (v[:, 0] ** 2 + v[:, 1] ** 2)).sum(axis=1)


def samples(run, count=3):
    """A few steps of a run, ends included, where something can be looked at."""
    return sorted({int(k) for k in np.linspace(0, len(run.t) - 1, count)})


def outcomes(spec, only=None):
    """{check: None, SKIPPED, a Limit, or words for a violation} on this spec."""
    trial, found = Trial(spec), {}
    for name, function in CHECKS.items():
        if only and name not in only:
            continue
        try:
            found[name] = function(trial)
        except engine.PileUp:
            found[name] = SKIPPED
        except Exception as error:
            found[name] = f"{type(error).__name__}: {error}"
    return found


def violations(found, label, spec):
    """Rows for the checks that failed, each with the job that reproduces it."""
    return [
        jobs.row(f"{name}, {label}", CHECKS[name].__doc__.splitlines()[0], words, ok=False)
        | {"case": jobs.job("scene", name, spec=spec)}
        for name, words in found.items()
        if isinstance(words, str)
    ]


def run_scene(spec):
    """Result of a job on one scene."""
    return {"cells": 1, "rows": violations(outcomes(spec), "the scene given", spec)}


def run_batch(start, stop):
    """Result of a job on the random scenes numbered start to stop - 1.

    data: for each check the number of scenes it applied to, of those in limits, and the worst limit.
    """
    rows_ = []
    data = {
        name: {"applied": 0, "limits": 0, "worst": 0.0, "words": "", "scene": None}
        for name in CHECKS
    }
    for number in range(start, stop):
        spec = scenes.numbered_spec(number)
        found = outcomes(spec)
        rows_ += violations(found, f"scene {number}", spec)
        for name, outcome in found.items():
            entry = data[name]
            entry["applied"] += outcome is not SKIPPED
            if isinstance(outcome, Limit):
                entry["limits"] += 1
                if outcome.size > entry["worst"]:
                    entry.update(worst=outcome.size, words=outcome.words, scene=number)
    return {"cells": stop - start, "rows": rows_, "data": data}


def run_seeds(scene, start, stop):
    """Result of a job on the ordering of a built scene: seeds start to stop - 1, smoke length.

    Penalty goes deeper than lcp, on the way and at rest; exact least of all; none explodes.
    """
    wrong = []
    for seed in range(start, stop):
        built = contact.build_scene(scene, seed)
        quality = {
            model: contact.contact_quality(engine.run_model(model, built, 0.002, 800), built, 0.002)
            for model in contact.MODELS
        }
        for measure in ("max_penetration_frac", "rest_penetration_frac"):
            depth = [quality[model][measure] for model in contact.MODELS]
            if not depth[0] > depth[1] >= depth[2] - 1e-12 or any(
                q["blew_up"] for q in quality.values()
            ):
                wrong.append(f"seed {seed} {measure} {depth}")
    expected = "penalty deeper than lcp, lcp no less deep than exact, none exploded"
    got = "so for all" if not wrong else f"{len(wrong)} otherwise, first: {wrong[0]}"
    return {
        "cells": stop - start,
        "rows": [jobs.row(f"{scene}, seeds {start} to {stop - 1}", expected, got, not wrong)],
    }
