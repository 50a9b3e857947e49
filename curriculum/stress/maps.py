"""Maps and curves: one ball dropped a metre, over every knob that decides what becomes of it.

A job is one row of a map: all dt for one setting of the other knobs; `dt` stands for log_grid(*dt).
penalty rows also find, by bisection, the critical dt of a ball that is kept in contact, which the
theory speaks about.
"""

import math

import numpy as np

from curriculum import exact
from curriculum.bench import closed_form
from curriculum.stress import jobs, trial
from curriculum.stress.under_test import contact, run_model

SETTLES, RESTLESS, GAINS, EXPLODES = "srgx"
OUTCOMES = {
    SETTLES: "settles at m g / k",
    RESTLESS: "keeps moving, gains no energy",
    GAINS: "gains more than 1 % energy",
    EXPLODES: "explodes (gains over 10x)",
}
SCENE = contact.build_scene("drop")
HEIGHT, RADIUS = float(SCENE.q0[1, 0]), float(SCENE.radius[0])
GAP = HEIGHT - RADIUS
G = closed_form.g
IMPACT_SPEED = G * float(closed_form.first_impact_time(GAP))  # m/s
SECONDS = 4.0
SEEDS = 9  # start heights: how deep a landing gets depends on where in a step it falls
BISECTED = 1.001  # ratio of the bounds at which the search for the critical dt ends
AMPLIFIED, WATCHED = 20.0, 2000  # a ball that gets 20 times as far off within 2,000 steps leaves


def log_grid(low, high, count):
    """`count` values from low to high, equal ratios."""
    return [float(value) for value in np.geomspace(low, high, count)]


FULL = {
    "penalty": {
        "dt": [2e-4, 0.3, 48],
        "stiffness": log_grid(1e2, 1e7, 41),
        "damping": [0.0, 8.0, 80.0, 800.0],
    },
    "lcp": {
        "dt": [5e-4, 0.128, 33],
        "baumgarte": [k / 20 for k in range(21)],
        "restitution": [0.0, 0.7],
    },
    "depth": {"dt": [5e-4, 0.128, 49]},
    "converges": [0.008 / 2**k for k in range(8)],
    "soft": {"dt": [5e-4, 0.128, 33], "timeconst": log_grid(1e-3, 0.3, 26)},
    "exact": {
        "dt": [1e-4, 0.128, 12],
        "restitution": [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0],
    },
}
QUICK = {
    "penalty": {"dt": [3e-4, 0.3, 12], "stiffness": log_grid(1e2, 1e7, 6), "damping": [0.0, 80.0]},
    "lcp": {"dt": [1e-3, 0.128, 8], "baumgarte": [0.0, 0.2, 1.0], "restitution": [0.0, 0.7]},
    "depth": {"dt": [1e-3, 0.128, 8]},
    "converges": [0.008 / 2**k for k in range(4)],
    "soft": {"dt": [1e-3, 0.128, 6], "timeconst": log_grid(1e-3, 0.3, 5)},
    "exact": {"dt": [1e-3, 0.128, 4], "restitution": [0.0, 0.7]},
}


def map_jobs(grids):
    """The jobs of all maps and curves on these grids."""
    penalty, lcp, depth, soft, exact = (
        grids[name] for name in ("penalty", "lcp", "depth", "soft", "exact")
    )
    return [
        *(
            jobs.job(
                "penalty-map",
                f"penalty k={k:.4g} c={c:g}",
                stiffness=k,
                damping=c,
                dt=penalty["dt"],
            )
            for c in penalty["damping"]
            for k in penalty["stiffness"]
        ),
        *(
            jobs.job("lcp-map", f"lcp e={e:g} beta={b:g}", restitution=e, baumgarte=b, dt=lcp["dt"])
            for e in lcp["restitution"]
            for b in lcp["baumgarte"]
        ),
        *(
            jobs.job(
                "lcp-depth", f"depth e={e:g} beta={b:g}", restitution=e, baumgarte=b, dt=depth["dt"]
            )
            for e in (0.0, 0.7)
            for b in (0.0, 0.2, 1.0)
        ),
        *(jobs.job("lcp-converges", f"bounce dt={dt:g}", dt=dt) for dt in grids["converges"]),
        *(
            jobs.job("soft-map", f"soft T={t:.4g}", timeconst=t, dt=soft["dt"])
            for t in soft["timeconst"]
        ),
        *(
            jobs.job("exact-map", f"exact e={e:g}", restitution=e, dt=exact["dt"])
            for e in exact["restitution"]
        ),
    ]


# --- penalty ------------------------------------------------------------------------------------


def penalty_row(stiffness, damping, dt):
    """Outcome of the drop at each dt, and the boundary of a ball kept in contact against theory.

    How late the search can be with a damper, `late` says. Without a damper x_n = x_0 cos((n - 1/2) w) / cos(w / 2), with
    cos(w) = 1 - k dt^2 / 2 m: it gets 20 times as far off already below the critical dt, by up to
    1 / (2 20^2) of it. And the search ends 0.1 % wide.
    """
    scene, dts = SCENE._replace(damping=damping), log_grid(*dt)
    seconds = SECONDS + 8 * settling_time(stiffness, damping)
    outcomes = "".join(drop_outcome(scene, stiffness, step, seconds) for step in dts)
    theory = contact.critical_dt(1.0, stiffness, damping)
    measured = boundary(stiffness, damping, theory)
    early = 0.5 / AMPLIFIED**2
    error, bound = measured / theory - 1.0, max(late(damping * theory), early) + BISECTED - 1.0
    rows = [
        jobs.row(
            "ball kept in contact",
            f"critical dt {theory:.6g} s within {bound:.2%}",
            f"{measured:.6g} s ({error:+.2%})",
            abs(error) <= bound,
        )
    ]
    return {
        "cells": len(dts) + 1,
        "rows": rows,
        "outcomes": outcomes,
        "theory": theory,
        "measured": measured,
    }


def late(b):
    """By what share of the critical dt a step must be above it to be seen to leave; b = c dt / m < 2.

    One eigenvalue of the step near the critical dt is -1 - s ln(dt / dt_crit), s = 2 (4 - b) / b,
    and a start off the rest depth has the share (2 - b) / b in its mode (1 at most). To be
    AMPLIFIED times as far off after WATCHED steps takes ln(AMPLIFIED / share) / WATCHED / s.
    """
    share = min(1.0, (2.0 - b) / b) if b > 0.0 else 1.0
    return math.log(AMPLIFIED / share) / WATCHED * b / (2.0 * (4.0 - b))


def settling_time(stiffness, damping):
    """Slowest time constant [s] of the damped spring; 0 without a damper (it never settles)."""
    if damping == 0.0:
        return 0.0
    root = damping * damping - 4.0 * stiffness
    return 2.0 / damping if root <= 0.0 else (damping + math.sqrt(root)) / (2.0 * stiffness)


def drop_outcome(scene, stiffness, dt, seconds):
    """One letter of OUTCOMES for penalty on the drop."""
    run = run_model("penalty", scene, dt, max(50, math.ceil(seconds / dt)), stiffness=stiffness)
    total = contact.energy(run.q, run.v, scene.mass)
    if contact.blow_up_step(total) is not None:
        return EXPLODES
    depth = closed_form.rest_depth(1.0, stiffness)
    tail = slice(-max(10, len(run.t) // 10), None)
    off = np.abs(run.q[tail, 1, 0] - (RADIUS - depth)).max()
    if off < 0.01 * depth and np.abs(run.v[tail, 1, 0]).max() < 1e-3:
        return SETTLES
    return GAINS if (total - total[0]).max() > 0.01 * total[0] else RESTLESS


def boundary(stiffness, damping, guess):
    """Largest dt [s] at which a ball kept in contact stays where it rests, by bisection."""
    low, high = 0.5 * guess, 2.0 * guess
    if leaves(stiffness, damping, low) or not leaves(stiffness, damping, high):
        return math.nan
    while high / low > BISECTED:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if leaves(stiffness, damping, middle) else (middle, high)
    return math.sqrt(low * high)


def leaves(stiffness, damping, dt):
    """Whether a ball that starts a little off its rest depth moves away from it.

    So little, half a percent of what would lift it or stop the damper's push, that no clamp acts.
    """
    depth = closed_form.rest_depth(1.0, stiffness)
    little = 0.005 * G * min(1.0 / stiffness, dt * dt)
    rest = RADIUS - depth
    scene = SCENE._replace(q0=np.array([[0.0], [rest - little]]), damping=damping)
    run = run_model("penalty", scene, dt, WATCHED, stiffness=stiffness)
    return not np.abs(run.q[:, 1, 0] - rest).max() < AMPLIFIED * little


# --- lcp ----------------------------------------------------------------------------------------


def lcp_row(restitution, baumgarte, dt):
    """The worst over SEEDS start heights at each dt: height error, energy in, energy above start."""
    columns = {"height_error": [], "contact_energy": [], "energy_excess": []}
    wrong = {"pop": [], "energy": []}
    for step in log_grid(*dt):
        found = [lcp_drop(seed, restitution, baumgarte, step) for seed in range(SEEDS)]
        for name, values in columns.items():
            values.append(max(values_[name] for values_, _ in found))
        for name, places in wrong.items():
            places += [(step, seed) for seed, (_, held) in enumerate(found) if not held[name]]
    expected = {
        "pop": "rises no higher than L = max(e, beta) v carries it, L^2 / 2g + L dt / 2 + "
        "g dt^2 / 8 above the margin",
        "energy": "E above the start at most (e / (1 + e) + beta^2) v dt / h of it",
    }
    rows = [
        jobs.row(
            name,
            expected[name],
            f"otherwise at (dt, seed) {places[:5]}" if places else "so at every dt",
            not places,
        )
        for name, places in wrong.items()
    ]
    return {"cells": SEEDS * len(columns["height_error"]), "rows": rows, **columns}


def lcp_drop(seed, restitution, baumgarte, dt):
    """({column: value}, {expectation: held}) of one drop under lcp.

    v, the fastest there is, is the speed of the first impact, one step late. The bias velocity is
    beta depth / dt with a depth of at most v dt, so the ball leaves with L at most; what semi-
    implicit steps add to the parabola is L dt / 2 + g dt^2 / 8. Without bias the law of F (see
    invariants) holds the energy to e / (1 + e) dt g v above the start, and a ball that leaves with
    beta v had fallen g depth too deep, so beta^2 g v dt. A step rounds y and v twice each, which
    is 2 U (g y + v^2) of the energy at most.
    """
    scene = contact.build_scene("drop", seed)._replace(restitution=restitution)
    height = float(scene.q0[1, 0])
    run = run_model("lcp", scene, dt, max(50, math.ceil(SECONDS / dt)), baumgarte=baumgarte)
    y, gap = run.q[:, 1, 0], height - RADIUS
    truth = closed_form.ball_height(height, RADIUS, restitution, run.t)
    total = contact.energy(run.q, run.v, scene.mass)
    fastest = G * (float(closed_form.first_impact_time(gap)) + dt)
    landed = int(np.argmax(y - RADIUS < contact.CONTACT_MARGIN))
    leaving = max(restitution, baumgarte) * fastest
    highest = leaving**2 / (2 * G) + leaving * dt / 2 + G * dt * dt / 8 + contact.CONTACT_MARGIN
    excess = float((total - total[0]).max() / total[0])
    rounded = 2 * trial.U * len(run.t) * (G * max(height, RADIUS + highest) + fastest**2)
    allowed = (restitution / (1 + restitution) + baumgarte**2) * fastest * dt / height
    rises = float(np.maximum(np.diff(total), 0.0).sum() / total[0])
    return (
        {
            "height_error": float(np.abs(y - truth).max() / RADIUS),
            "contact_energy": rises,
            "energy_excess": excess,
        },
        {
            "pop": bool(y[landed + 1 :].max() - RADIUS <= highest),
            "energy": excess <= allowed + rounded / (G * height),
        },
    )


def depth_row(restitution, baumgarte, dt):
    """How deep lcp gets, worst over SEEDS heights, at each dt: neither e nor beta enters.

    e = 0: as deep as the first state within the margin, in closed form; bouncing: at most v dt. A
    step rounds y and v twice each, which moves y by 2 U (h + v t) <= 6 U h until the landing.
    """
    deepest, wrong = [], []
    for step in log_grid(*dt):
        depths = []
        for seed in range(SEEDS):
            scene = contact.build_scene("drop", seed)._replace(restitution=restitution)
            steps = max(50, math.ceil(SECONDS / step))
            run = run_model("lcp", scene, step, steps, baumgarte=baumgarte)
            depth = max(0.0, RADIUS - float(run.q[:, 1, 0].min()))
            gap = float(scene.q0[1, 0]) - RADIUS
            first = landing_depth(gap, step)
            most = G * (float(closed_form.first_impact_time(gap)) + step) * step
            rounded = 6 * trial.U * steps * float(scene.q0[1, 0])
            most = first if restitution == 0.0 else most
            if not first - rounded <= depth <= most + rounded:
                wrong.append((step, seed))
            depths.append(depth / RADIUS)
        deepest.append(max(depths))
    row = jobs.row(
        "depth",
        "the landing's, in closed form; at most v dt where it bounces",
        f"otherwise at (dt, seed) {wrong[:5]}" if wrong else "so at every dt",
        not wrong,
    )
    return {"cells": SEEDS * len(deepest), "rows": [row], "depth": deepest}


def landing_depth(gap, dt):
    """Depth [m] of the first state within the margin, in closed form: gap - g dt^2 n (n + 1) / 2."""
    fall = G * dt * dt / 2
    n = max(0, math.floor((math.sqrt(1.0 + 4.0 * (gap - contact.CONTACT_MARGIN) / fall) - 1) / 2))
    while gap - fall * n * (n + 1) >= contact.CONTACT_MARGIN:
        n += 1
    return max(0.0, fall * n * (n + 1) - gap)


def converges_row(dt):
    """Height error of the bounce (e = 0.7), median of SEEDS heights, and the worst gap at rest.

    At rest a contact is left at depth 0 but for the rounding of its height: U r for each of the
    few operations of the last step, 8 of them.
    """
    errors, rest = [], []
    for seed in range(SEEDS):
        scene = contact.build_scene("bounce", seed)
        run = run_model("lcp", scene, dt, round(SECONDS / dt))
        truth = closed_form.ball_height(float(scene.q0[1, 0]), RADIUS, 0.7, run.t)
        errors.append(float(np.abs(run.q[:, 1, 0] - truth).max()) / RADIUS)
        rest.append(abs(float(run.q[-1, 1, 0]) - RADIUS) / RADIUS)
    bound = 8 * 2.0**-53
    row = jobs.row(
        "gap at rest", f"0 within {bound:.1e} r", f"{max(rest):.1e} r", max(rest) <= bound
    )
    return {
        "cells": SEEDS,
        "rows": [row],
        "height_error": float(np.median(errors)),
        "rest_gap": max(rest),
    }


# --- soft and exact -----------------------------------------------------------------------------


def soft_row(timeconst, dt):
    """The drop under soft at each dt: how deep, how deep at rest, energy above the start.

    At rest (1 - d) g = d^2 K depth (facts of the model), with the time constant that counts,
    max(T, 2 dt). Tried where the ball has come to rest: it moves by under 1e-12 r in a step.
    """
    columns = {"depth": [], "rest": [], "energy_excess": []}
    wrong = []
    for step in log_grid(*dt):
        seconds = SECONDS + 20 * max(timeconst, 2 * step)
        run = run_model(
            "soft", SCENE, step, max(50, math.ceil(seconds / step)), solref=(timeconst, 1.0)
        )
        total = contact.energy(run.q, run.v, SCENE.mass)
        depth, rest = (RADIUS - float(y) for y in (run.q[:, 1, 0].min(), run.q[-1, 1, 0]))
        if abs(run.v[-1, 1, 0]) * step < 1e-12 * RADIUS:
            d = contact.impedance(rest, contact.SOLIMP)
            spring = d * d * rest / (contact.SOLIMP[1] * max(timeconst, 2 * step)) ** 2
            if abs(spring - (1 - d) * G) > 1e-6 * (1 - d) * G:
                wrong.append(step)
        columns["depth"].append(depth / RADIUS)
        columns["rest"].append(rest / RADIUS)
        columns["energy_excess"].append(float((total - total[0]).max() / total[0]))
    row = jobs.row(
        "depth at rest",
        "(1 - d) g = d^2 K depth within 1e-6",
        f"otherwise at dt {wrong[:5]}" if wrong else "so at every dt",
        not wrong,
    )
    return {"cells": len(columns["depth"]), "rows": [row], **columns}


def exact_row(restitution, dt):
    """Height error, depth and energy of exact on the drop at each dt, against the closed form."""
    scene = SCENE._replace(restitution=restitution)
    columns = {"height_error": [], "depth": [], "energy_excess": []}
    for step in log_grid(*dt):
        run = run_model("exact", scene, step, math.ceil(SECONDS / step))
        truth = closed_form.ball_height(HEIGHT, RADIUS, restitution, run.t)
        total = contact.energy(run.q, run.v, scene.mass)
        columns["height_error"].append(float(np.abs(run.q[:, 1, 0] - truth).max()) / RADIUS)
        columns["depth"].append(max(0.0, 1.0 - float(run.q[:, 1, 0].min()) / RADIUS))
        columns["energy_excess"].append(float((total - total[0]).max() / total[0]))
    limits = {"height_error": 1e-10, "depth": exact.TOUCH, "energy_excess": 1e-12}  # its promises
    rows = [
        jobs.row(
            name,
            f"at most {limit:g} at every dt",
            f"{max(columns[name]):.2g}",
            max(columns[name]) <= limit,
        )
        for name, limit in limits.items()
    ]
    return {"cells": len(columns["depth"]), "rows": rows, **columns}


# --- the order of the models --------------------------------------------------------------------


def run_seeds(scene, start, stop):
    """The ordering of a built scene over seeds start to stop - 1, at the length of --smoke.

    Penalty goes deeper than lcp, at worst and at rest, and exact least of all; nothing explodes,
    and only penalty and soft, which have springs, put energy in.
    """
    wrong = []
    for seed in range(start, stop):
        built = contact.build_scene(scene, seed)
        row = {
            model: contact.contact_quality(run_model(model, built, 0.002, 800), built, 0.002)
            for model in contact.MODELS
        }
        for measure in ("max_penetration_frac", "rest_penetration_frac"):
            spring, solve, least = (row[model][measure] for model in ("penalty", "lcp", "exact"))
            if not spring > solve >= least - exact.TOUCH:
                wrong.append(f"seed {seed}, {measure}: {spring:.3g}, {solve:.3g}, {least:.3g}")
        if any(quality["blew_up"] for quality in row.values()):
            wrong.append(f"seed {seed}: a run exploded")
        if row["exact"]["contact_energy"] > 1e-12:
            wrong.append(f"seed {seed}: exact puts in {row['exact']['contact_energy']:.2g}")
    expected = (
        "penalty deeper than lcp, lcp no less deep than exact, at worst and at rest; none "
        "explodes; exact puts no energy in"
    )
    got = "so for all" if not wrong else f"{len(wrong)} otherwise, first: {wrong[0]}"
    return {
        "cells": len(contact.MODELS) * (stop - start),
        "rows": [jobs.row(f"{scene}, seeds {start} to {stop - 1}", expected, got, not wrong)],
    }
