"""One line from penalty over MuJoCo to lcp: soft's impedance d moved from 0.0001 to 0.9999.

While a ball touches the floor and nothing is clamped, soft is a spring and a damper on it,

    k = m d^2 K,   c = m d B,   and only the share 1 - d of gravity presses on them.

So with k and c those of penalty, d -> 0 is penalty, resting at m g / k. And with K = beta / dt^2
and B = (1 + e) / dt, which turns an overlap and a speed around within one step, d -> 1 is lcp.
MuJoCo ships d from 0.9 to 0.95 in between.
"""

import itertools
import math
import random

import numpy as np

import contact
from curriculum import measured

COMMAND = "python -m curriculum.bench soft"
CODE = ("contact.py",)
DT, STEPS, BETA, STIFFNESS = 0.002, 2000, 0.2, 1e4
DS = (
    1e-4,
    1e-3,
    0.01,
    0.03,
    0.1,
    0.3,
    0.5,
    0.7,
    0.9,
    0.95,
    0.97,
    0.99,
    0.997,
    0.999,
    0.9997,
    0.9999,
)
PENALTY_END, LCP_END = "spring of penalty", "spring of lcp"
BETWEEN = "from MuJoCo to lcp"  # the spring moves with d, from solref 0.02 1 at d = 0.95
ORDERS = 20  # orders of the sweeps that are tried


# the line


def constant(d):
    """An impedance that does not depend on the depth."""
    return (d, d, 0.001, 0.5, 2.0)


def settings(end, d, dt, scene, beta=BETA):
    """solref and solimp that have this line's spring at impedance d.

    In the direct form solref holds -d^2 K and -d B: k / m and c / m, whatever d is.
    """
    hard = beta / dt**2, 1.0 / dt
    if end == LCP_END:
        return (-hard[0], -hard[1]), constant(d)
    if end == BETWEEN:
        timeconst = contact.SOLREF[0]
        shipped = 1.0 / timeconst**2, 2.0 / timeconst
        share = math.log(d / (1.0 - d) / 19.0) / math.log(0.9999 / 0.0001 / 19.0)  # 19: d = 0.95
        return tuple(-(a ** (1.0 - share)) * b**share for a, b in zip(shipped, hard)), constant(d)
    mass = float(scene.mass[0])
    return (-STIFFNESS / mass, -scene.damping / mass), constant(d)


def run_soft(end, d, scene, beta=BETA):
    solref, solimp = settings(end, d, DT, scene, beta)
    return contact.run_model("soft", scene, DT, STEPS, solref=solref, solimp=solimp)


def point(run, scene):
    """What a run is judged by: lengths in radii, energy in start energies."""
    told = contact.contact_quality(run, scene, DT)
    return dict(
        rest_gap=told["rest_gap_frac"],
        deepest=told["max_penetration_frac"],
        energy_in=told["contact_energy"],
    )


def the_line():
    """The points of both lines, and the models at their ends, on the drop."""
    scene = contact.build_scene("drop")
    models = {
        "penalty": contact.run_model("penalty", scene, DT, STEPS, stiffness=STIFFNESS),
        "lcp": contact.run_model("lcp", scene, DT, STEPS, baumgarte=BETA),
        "soft": contact.run_model("soft", scene, DT, STEPS),
    }
    plain = contact.run_model("lcp", scene, DT, STEPS, baumgarte=0.0)
    rows = []
    for end, d in itertools.product((PENALTY_END, BETWEEN, LCP_END), DS):
        if end == BETWEEN and d < 0.95:
            continue
        run = run_soft(end, d, scene)
        near = (
            distance(run_soft(end, d, scene, beta=0.0), plain)
            if end == LCP_END
            else distance(run, models["penalty" if end == PENALTY_END else "lcp"])
        )
        rows.append(
            dict(
                end=end,
                d=d,
                **point(run, scene),
                distance=near,
                critical_dt=critical_step(end, d, scene),
            )
        )
    return rows, {
        name: point(run, scene) | dict(critical_dt=known_critical(name, scene))
        for name, run in models.items()
    }


def distance(run, other):
    """The largest difference of the heights of two runs, in radii."""
    return float(np.abs(run.q[:, 1] - other.q[:, 1]).max() / contact.RADIUS)


def known_critical(name, scene):
    """The critical step [s] of a model's own spring; None where its spring shrinks with the step."""
    if name == "penalty":
        return contact.critical_dt(1.0, STIFFNESS, scene.damping)
    return None


def critical_step(end, d, scene):
    """The largest step [s] at which a ball kept in contact comes to rest, by bisection; see above.

    None where the spring is made for the step, as lcp's is: there no step is too long.
    """
    if end != PENALTY_END:
        return None
    low, high = 1e-4, 1.0
    for _ in range(18):
        dt = (low * high) ** 0.5
        low, high = (dt, high) if comes_to_rest(end, d, scene, dt) else (low, dt)
    return low


def comes_to_rest(end, d, scene, dt, steps=400):
    """Whether a ball pressed 1e-9 m below its rest depth swings less and less.

    A swing that has grown a thousandfold has left the spring's range: the clamp may tame it then.
    """
    solref, solimp = settings(end, d, dt, scene)
    depth = (1.0 - d) * -contact.GRAVITY / -solref[0]
    balls = contact.make_balls(
        scene._replace(q0=np.array([[0.0], [contact.RADIUS - depth - 1e-9]]))
    )
    swings = []
    for _ in range(steps):
        contact.soft_step(balls, dt, solref, solimp)
        swings.append(abs(balls[0].y - contact.RADIUS + depth))
    return max(swings) < 1e-6 and max(swings[steps // 2 :]) <= max(swings[: steps // 2])


# the bill: one answer in any order, and where it rests


def vault():
    """Four balls in a row between two held ones, and three in the grooves above: 15 contacts.

    The seven have 14 directions to move in, so hard contacts can share the load in many ways.
    """
    R = contact.RADIUS
    x = [0.0, 10 * R, *(2 * R * k for k in range(1, 5)), *(2 * R * k + R for k in range(1, 4))]
    y = [R] * 6 + [R + math.sqrt(3.0) * R] * 3
    mass = np.array([math.inf] * 2 + [1.0] * 7)
    return contact.Scene(
        "vault", np.array([x, y]), np.zeros((2, 9)), mass, np.full(9, R), 0.0, 80.0
    )


def orders(count=ORDERS):
    """How much the impulses and velocities of one step depend on the order of the sweeps."""
    start = vault()
    rest = start._replace(q0=contact.run_model("soft", start, DT, 300).q[-1])
    rows = []
    for name, model, scene, sweeps in (
        ("soft, as shipped", "soft", rest, contact.MOST_SWEEPS),
        ("lcp, 20 sweeps", "lcp", start, 20),
        ("lcp, 10,000 sweeps", "lcp", start, 10_000),
    ):
        found = [solved(scene, model, sweeps, order) for order in range(count)]
        lam, speed = (np.array(part) for part in zip(*found))
        rows.append(
            dict(
                name=name,
                contacts=lam.shape[1],
                impulses=float(np.ptp(lam, axis=0).max() / lam.max()),
                speeds=float(np.ptp(speed, axis=0).max()),
            )
        )
    return rows


def solved(scene, model, sweeps, order):
    """Impulses [N s], by the unshuffled contact, and all velocities of one step at rest."""
    balls = contact.make_balls(scene._replace(v0=np.zeros_like(scene.v0)))
    contacts = contact.detect_contacts(balls, 0.0 if model == "soft" else contact.CONTACT_MARGIN)
    solref, solimp = contact.soft_defaults(0.0, DT)
    for c in contacts:
        if model == "soft":
            contact.soften(c, DT, solref, solimp)
        else:
            c.target = contact.contact_target(c, 0.0, BETA, DT)
    contact.fall(balls, DT)
    shuffled = random.Random(order).sample(contacts, len(contacts))
    contact.solve_contacts(shuffled, sweeps, contact.LAST_BITS * DT if model == "soft" else 0.0)
    return [c.lam for c in contacts], [(ball.vx, ball.vy) for ball in balls]


def measure(quick=False, cells=None):
    """line, models, orders."""
    cells = {} if cells is None else cells
    parts = dict(line=the_line, orders=orders)
    with measured.progress(len(parts), "soft") as tick:
        for name, part in parts.items():
            if name not in cells:
                cells[name] = measured.plain(part())
            tick(name)
    rows, models = cells["line"]
    return dict(quick=quick, line=rows, models=models, orders=cells["orders"])
