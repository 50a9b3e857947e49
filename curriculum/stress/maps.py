"""Stability maps: one ball dropped a metre, over every knob that decides whether it stays stable.

A job is one row of a map: all dt for one setting of the other knobs; `dt` stands for log_grid(*dt).
penalty rows also find, by bisection, the critical dt of a ball that is kept in contact, which the
theory speaks about.
"""

import math

import numpy as np

from curriculum.bench import closed_form
from curriculum.stress import jobs
from curriculum.stress.engine import contact, run_model

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
IMPACT_SPEED = closed_form.g * closed_form.first_impact_time(GAP)  # m/s
SECONDS = 4.0


def log_grid(low, high, count):
    """`count` values from low to high, equal ratios."""
    return [float(value) for value in np.geomspace(low, high, count)]


FULL = {
    "penalty": {
        "dt": [2e-4, 0.3, 60],
        "stiffness": log_grid(1e2, 1e7, 60),
        "damping": [0.0, 8.0, 80.0, 800.0],
    },
    "lcp": {
        "dt": [5e-4, 0.128, 60],
        "baumgarte": [k / 60 for k in range(61)],
        "restitution": [0.0, 0.3, 0.7, 1.0],
        "heights": 9,
    },
    "exact": {
        "dt": [1e-4, 0.128, 60],
        "restitution": [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0],
    },
}
QUICK = {
    "penalty": {
        "dt": [3e-4, 0.3, 14],
        "stiffness": log_grid(1e2, 1e7, 12),
        "damping": [0.0, 8.0, 80.0, 800.0],
    },
    "lcp": {
        "dt": [1e-3, 0.128, 10],
        "baumgarte": [0.0, 0.2, 0.6, 1.0],
        "restitution": [0.0, 0.7, 1.0],
        "heights": 2,
    },
    "exact": {"dt": [1e-3, 0.128, 6], "restitution": [0.0, 0.7, 1.0]},
}


def map_jobs(grids):
    """The jobs of all three maps on these grids."""
    penalty, lcp, exact = grids["penalty"], grids["lcp"], grids["exact"]
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
            jobs.job(
                "lcp-map",
                f"lcp e={e:g} beta={b:g}",
                restitution=e,
                baumgarte=b,
                dt=lcp["dt"],
                heights=lcp["heights"],
            )
            for e in lcp["restitution"]
            for b in lcp["baumgarte"]
        ),
        *(
            jobs.job("exact-map", f"exact e={e:g}", restitution=e, dt=exact["dt"])
            for e in exact["restitution"]
        ),
    ]


def penalty_row(stiffness, damping, dt):
    """Outcome of the drop at each dt, and the boundary of a ball kept in contact against theory."""
    scene, dts = SCENE._replace(damping=damping), log_grid(*dt)
    seconds = SECONDS + 8 * settling_time(stiffness, damping)
    outcomes = "".join(drop_outcome(scene, stiffness, step, seconds) for step in dts)
    theory = critical_dt(stiffness, damping)
    measured = boundary(stiffness, damping, theory)
    error = measured / theory - 1.0
    expected = f"critical dt {theory:.6g} s within 1 %"
    rows = [
        jobs.row(
            "ball kept in contact", expected, f"{measured:.6g} s ({error:+.2%})", abs(error) < 0.01
        )
    ]
    inside = [outcome for step, outcome in zip(dts, outcomes) if step < 0.5 * theory]
    if damping >= 0.1 * math.sqrt(stiffness):  # 5 % of critical damping or more
        exploded = inside.count(EXPLODES)
        rows.append(
            jobs.row(
                "drop, dt below half the critical one",
                "never explodes, the damper takes more than impacts gain",
                f"{exploded} of {len(inside)} explode",
                exploded == 0,
            )
        )
    return {
        "cells": len(dts) + 1,
        "rows": rows,
        "outcomes": outcomes,
        "theory": theory,
        "measured": measured,
    }


def critical_dt(stiffness, damping):
    """The theory's limit for the drop's ball: the damped one that contact.py prints [s]."""
    return contact.critical_dt(float(SCENE.mass[0]), stiffness, damping)


def settling_time(stiffness, damping):
    """Slowest time constant [s] of the damped spring; 0 without a damper (it never settles)."""
    if damping == 0.0:
        return 0.0
    root = damping * damping - 4.0 * stiffness
    return 2.0 / damping if root <= 0.0 else (damping + math.sqrt(root)) / (2.0 * stiffness)


def drop_outcome(scene, stiffness, dt, seconds):
    """One letter of OUTCOMES for penalty on the drop."""
    run = run_model("penalty", scene, dt, max(50, math.ceil(seconds / dt)), stiffness=stiffness)
    quality = contact.contact_quality(run, scene, dt)
    if quality["blew_up"]:
        return EXPLODES
    depth = closed_form.rest_depth(1.0, stiffness)
    tail = slice(-max(10, len(run.t) // 10), None)
    off = np.abs(run.q[tail, 1, 0] - (RADIUS - depth)).max()
    if off < 0.01 * depth and np.abs(run.v[tail, 1, 0]).max() < 1e-3:
        return SETTLES
    return GAINS if quality["energy_excess"] > 0.01 else RESTLESS


def boundary(stiffness, damping, guess):
    """Largest dt [s] at which a ball kept in contact stays where it rests, by bisection to 0.1 %.

    The ball starts a little off its rest depth, so little (half a percent of what would lift it or
    stop the damper's push) that no clamp acts; it has left when it is 20 times as far off.
    """
    low, high = 0.5 * guess, 2.0 * guess
    if leaves(stiffness, damping, low) or not leaves(stiffness, damping, high):
        return math.nan
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if leaves(stiffness, damping, middle) else (middle, high)
    return math.sqrt(low * high)


def leaves(stiffness, damping, dt, steps=2000):
    """Whether a ball that starts a little off its rest depth moves away from it."""
    depth = closed_form.rest_depth(1.0, stiffness)
    little = 0.005 * closed_form.g * min(1.0 / stiffness, dt * dt)
    rest = RADIUS - depth
    scene = SCENE._replace(q0=np.array([[0.0], [rest - little]]), damping=damping)
    run = run_model("penalty", scene, dt, steps, stiffness=stiffness)
    return not np.abs(run.q[:, 1, 0] - rest).max() < 20.0 * little


def lcp_row(restitution, baumgarte, dt, heights):
    """The worst over the drop's first `heights` seeds at each dt: depth, height error, energies.

    One height alone is a lottery: how deep a landing gets depends on where in a step it falls.
    """
    columns = {"depth": [], "height_error": [], "contact_energy": [], "energy_excess": []}
    wrong = {"depth": [], "pop": [], "energy": []}
    for step in log_grid(*dt):
        found = [lcp_drop(seed, restitution, baumgarte, step) for seed in range(heights)]
        for name, values in columns.items():
            values.append(max(quality[name] for quality, _ in found))
        for name, values in wrong.items():
            values += [(step, seed) for seed, (_, held) in enumerate(found) if not held[name]]
    expected = {
        "depth": "at least the first landing's depth (closed form), at most the impact speed times dt",
        "pop": "rises at most as high as max(e, beta) times the impact speed carries it",
        "energy": "energy above the start at most max(e, beta) v dt / (2 h), the step's own zigzag",
    }
    rows = [
        jobs.row(
            name,
            expected[name],
            f"otherwise at (dt, seed) {wrong[name][:5]}" if wrong[name] else "so at every dt",
            not wrong[name],
        )
        for name in wrong
    ]
    return {"cells": heights * len(columns["depth"]), "rows": rows, **columns}


def lcp_drop(seed, restitution, baumgarte, dt):
    """({column: value}, {expectation: held}) of one drop under lcp."""
    scene = contact.build_scene("drop", seed)._replace(restitution=restitution)
    height = float(scene.q0[1, 0])
    run = run_model("lcp", scene, dt, max(50, math.ceil(SECONDS / dt)), baumgarte=baumgarte)
    y = run.q[:, 1, 0]
    truth = closed_form.ball_height(height, RADIUS, restitution, run.t)
    reference = contact.Run(run.t, np.stack((run.q[:, 0], truth[:, None]), axis=1), run.v)
    quality = contact.contact_quality(run, scene, dt, reference)
    depth, first = max(0.0, float((RADIUS - y).max())), landing_depth(height - RADIUS, dt)
    fastest = closed_form.g * (float(closed_form.first_impact_time(height - RADIUS)) + dt)
    landed = int(np.argmax(y - RADIUS < contact.CONTACT_MARGIN))
    leaving = max(restitution, baumgarte) * fastest
    highest = leaving**2 / (2 * closed_form.g) + leaving * dt + contact.CONTACT_MARGIN
    excess = 0.5 * fastest * dt / height * max(restitution, baumgarte)
    return (
        {
            "depth": quality["max_penetration_frac"],
            "height_error": quality["height_error_frac"],
            "contact_energy": quality["contact_energy"],
            "energy_excess": quality["energy_excess"],
        },
        {
            "depth": first - 1e-12 <= depth <= max(first, fastest * dt) + 1e-12,
            "pop": bool(y[landed + 1 :].max() - RADIUS <= highest),
            "energy": quality["energy_excess"] <= excess + 1e-12,
        },
    )


def landing_depth(gap, dt):
    """Depth [m] of the first state within the margin, in closed form: gap - g dt^2 n (n + 1) / 2."""
    fall = closed_form.g * dt * dt / 2
    n = max(0, math.floor((math.sqrt(1.0 + 4.0 * (gap - contact.CONTACT_MARGIN) / fall) - 1) / 2))
    while gap - fall * n * (n + 1) >= contact.CONTACT_MARGIN:
        n += 1
    return max(0.0, fall * n * (n + 1) - gap)


def exact_row(restitution, dt):
    """Height error, depth and energy of exact on the drop at each dt."""
    scene = SCENE._replace(restitution=restitution)
    columns = {"height_error": [], "depth": [], "energy_excess": []}
    for step in log_grid(*dt):
        run = run_model("exact", scene, step, math.ceil(SECONDS / step))
        quality = contact.contact_quality(run, scene, step)
        truth = closed_form.ball_height(HEIGHT, RADIUS, restitution, run.t)
        columns["height_error"].append(float(np.abs(run.q[:, 1, 0] - truth).max() / RADIUS))
        columns["depth"].append(quality["max_penetration_frac"])
        columns["energy_excess"].append(quality["energy_excess"])
    limits = {"height_error": 1e-10, "depth": 1e-12, "energy_excess": 1e-12}
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
