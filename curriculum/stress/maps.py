"""Maps: one ball dropped a metre, over every knob that decides what becomes of it, with the theory.

A job is one row of a map: every dt for one setting of the other knobs. Rows of penalty also search
for the critical dt of a ball that is kept in contact, which the theory speaks about.
"""

import itertools
import math

import numpy as np

import contact
from curriculum.stress.jobs import row
from curriculum.stress.trial import G, U, fast

SETTLES, RESTLESS, GAINS, EXPLODES = OUTCOMES = "srgx"
WORDS = ("settles at m g / k", "keeps moving", "gains over 1 % energy", "explodes (gains over 10x)")
SCENE = contact.build_scene("drop")
R = contact.RADIUS
SECONDS = 4.0
SEEDS = 9  # start heights: how deep a landing gets depends on where in a step it falls
BISECTED = 1.001  # ratio of the bounds at which the search for the critical dt ends
AMPLIFIED, WATCHED = 20.0, 2000  # a ball that gets 20 times as far off within 2,000 steps leaves
LATE = 0.004  # share of the critical dt: 0.3 %, and what the search leaves open


def grid(low, high, count):
    """`count` values from low to high, equal ratios."""
    return [float(value) for value in np.geomspace(low, high, count)]


def map_jobs(quick):
    """The rows of all maps."""
    dts, stiff, times = (8, 6, 4) if quick else (40, 31, 26)
    springs = [(c, k) for c in (0.0, 80.0) for k in grid(1e2, 1e7, stiff)]
    return [
        *(("maps:penalty_row", (*spring, grid(3e-4, 0.3, dts))) for spring in springs),
        *(("maps:lcp_row", [dt]) for dt in grid(1e-3, 0.128, dts)),
        *(("maps:soft_row", (T, grid(1e-3, 0.128, dts))) for T in grid(2e-3, 0.3, times)),
    ]


def run(model, scene, dt, seconds, **knobs):
    """A run of that many seconds, at least 50 steps; compiled where it can be."""
    make = fast.simulate if fast else contact.run_model
    steps = max(50, math.ceil(seconds / dt))
    made = make(model, scene, dt, steps, contact.Settings(**knobs), None)
    return contact.Run(np.arange(steps + 1) * dt, *made) if fast else made


# --- penalty ------------------------------------------------------------------------------------


def penalty_row(given):
    """What the drop does at each dt, and the critical dt of a ball kept in contact, against theory.

    What leaves is seen to leave if it does so within WATCHED steps: its eigenvalue near -1 allows
    that from up to 0.3 % above the critical dt on.
    """
    damping, stiffness, dts = given
    theory = contact.critical_dt(1.0, stiffness, damping)
    measured = boundary(stiffness, damping, theory)
    error = measured / theory - 1.0
    expected = f"critical dt {theory:.6g} s within {LATE:.2%}"
    what = f"penalty, k {stiffness:.4g}, c {damping:g}, kept in contact"
    return {
        "map": "penalty",
        "at": (damping, stiffness),
        "outcomes": "".join(outcome(stiffness, damping, dt) for dt in dts),
        "dt": dts,
        "theory": theory,
        "measured": measured,
        "rows": [row(what, expected, f"{measured:.6g} s ({error:+.2%})", abs(error) <= LATE)],
    }


def outcome(stiffness, damping, dt):
    """One letter of OUTCOMES for penalty on the drop, watched until it should have settled.

    For eight times the slowest of: two decays of the damped spring, and the end of the bounces.
    """
    decay = max(2.0, damping**2 / stiffness, 0.1 * math.sqrt(stiffness)) / damping if damping else 0
    scene = SCENE._replace(damping=damping)
    found = run("penalty", scene, dt, SECONDS + 8 * decay, stiffness=stiffness)
    if contact.blow_up_step(contact.energy(found.q, found.v, scene.mass)) is not None:
        return EXPLODES
    depth, tail = G / stiffness, slice(-max(10, len(found.t) // 10), None)
    off = np.abs(found.q[tail, 1, 0] - (R - depth)).max()
    if off < 0.01 * depth and np.abs(found.v[tail, 1, 0]).max() < 1e-3:
        return SETTLES
    gained = found.v[:, 1, 0] ** 2 / 2 + G * found.q[:, 1, 0] > 1.01 * G * SCENE.q0[1, 0]
    return GAINS if gained.any() else RESTLESS


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
    rest, little = R - G / stiffness, 0.005 * G * min(1.0 / stiffness, dt * dt)
    scene = SCENE._replace(q0=np.array([[0.0], [rest - little]]), damping=damping)
    found = run("penalty", scene, dt, WATCHED * dt, stiffness=stiffness)
    return not np.abs(found.q[:, 1, 0] - rest).max() < AMPLIFIED * little


# --- lcp and soft -------------------------------------------------------------------------------


def lcp_row(dts):
    """How deep lcp lets the drop in at each dt: as deep as the first state within the margin.

    A step rounds y and v twice each, which moves y by 2 U (h + v t) <= 6 U h until the landing.
    """
    wrong, scenes = [], [contact.build_scene("drop", seed) for seed in range(SEEDS)]
    for dt, scene in itertools.product(dts, scenes):
        found, gap = run("lcp", scene, dt, SECONDS), float(scene.q0[1, 0]) - R
        deep = max(0.0, R - float(found.q[:, 1].min()))
        if abs(deep - landing_depth(gap, dt)) > 6 * U * len(found.t) * (gap + R):
            wrong.append(dt)
    got = f"otherwise at {wrong[:3]}" if wrong else "so"
    return {
        "map": "lcp",
        "rows": [row("lcp, depth", "the landing step's, closed form", got, not wrong)],
    }


def landing_depth(gap, dt):
    """Depth [m] of the first state within the margin: g dt^2 n (n + 1) / 2 - gap."""
    fall = G * dt * dt / 2
    n = max(0, math.floor((math.sqrt(1.0 + 4.0 * (gap - contact.CONTACT_MARGIN) / fall) - 1) / 2))
    while gap - fall * n * (n + 1) >= contact.CONTACT_MARGIN:
        n += 1
    return max(0.0, fall * n * (n + 1) - gap)


def soft_row(given):
    """How deep soft lets the drop in at each dt; at rest (1 - d) g = d^2 K depth, within 1e-6.

    K has the time constant that counts, max(T, 2 dt). Judged where the ball has come to rest: it
    moves by under 1e-12 r in a step.
    """
    timeconst, dts = given
    depth, wrong, judged = [], [], 0
    for dt in dts:
        T = max(timeconst, 2 * dt)
        found = run("soft", SCENE, dt, SECONDS + 20 * T, solref=(timeconst, 1.0))
        deep, rest = (R - float(y) for y in (found.q[:, 1].min(), found.q[-1, 1, 0]))
        depth.append(deep / R)
        if abs(found.v[-1, 1, 0]) * dt < 1e-12 * R:
            d, judged = contact.impedance(rest, contact.SOLIMP), judged + 1
            spring = d * d * rest / (contact.SOLIMP[1] * T) ** 2
            if abs(spring - (1 - d) * G) > 1e-6 * (1 - d) * G:
                wrong.append(dt)
    what = f"soft, T {timeconst:.4g} s, depth at rest at {judged} of {len(dts)} dt"
    got = f"otherwise at {wrong[:3]}" if wrong else "so"
    judgement = [row(what, "(1 - d) g = d^2 K depth", got, not wrong)] * (judged > 0)
    return {"map": "soft", "at": (timeconst,), "dt": dts, "depth": depth, "rows": judgement}
