"""A pile of N balls: time per step early and settled, how it grows with N, and the depth it leaves.

All fall from the same lattice, in turns of a few steps in random order, so that a slow spell of
the machine falls on all of them. Nothing is read while they are timed; contact.py's compiled twin
records every state all the same. Early is the first tenth of the run, when most balls still fall;
settled is the last quarter, which is the fair figure.
"""

import importlib.util
import multiprocessing
import random
import statistics
from functools import partial

import numpy as np

import contact
from curriculum import measured
from curriculum.bench import engines, timing
from curriculum.common.stoppable import end_at_ctrl_c

COMMAND = "python -m curriculum.bench pile"
CODE = ("contact.py", "curriculum/piles.py")
DT, SWEEPS, TURN = 0.002, 10, 50  # s; sweeps of lcp, iterations of the others; steps at a time
SIZES = {
    12: (1500, 5),
    100: (1500, 5),
    1000: (1500, 3),
    10000: (1500, 1),
}  # balls: steps, processes
QUICK_SIZES = {12: (300, 1), 100: (200, 1)}
FIT_FROM = 1000  # balls: the exponent is fitted from here on
PLAIN_UP_TO = 1000  # balls that contact.py's plain loops are asked to step
LCP, PLAIN = "lcp, compiled", "lcp, plain loops"
# what the first edition of this benchmark measured for its lcp (numpy, groups of contacts), settled [s]
FIRST_EDITION = {12: 92e-6, 100: 1450e-6, 1000: 5970e-6, 10000: 17300e-6}
ENGINES = {  # label: engine, and how its world is built
    "pymunk, 10 iterations": ("pymunk", engines.Pymunk),
    "Box2D 2.3": ("box2d", engines.Box2d),
    "Box2D 3, 4 substeps": ("box2d3", lambda scene, dt: engines.Box2d3(scene, dt, 4, None)),
    "Box2D 3, 4 substeps, hardest": (
        "box2d3",
        lambda scene, dt: engines.Box2d3(scene, dt, 4, 1e9),
    ),
    "MuJoCo as shipped": ("mujoco", lambda scene, dt: engines.Mujoco(scene, dt, engines.shipped)),
    "MuJoCo direct, push 0.2, 10 iterations": (
        "mujoco",
        lambda scene, dt: engines.Mujoco(
            scene, dt, lambda scene, dt: engines.direct(0.2, 0.9999, scene, dt), iterations=SWEEPS
        ),
    ),
}
RIVALS = ("pymunk", "box2d3", "mujoco")  # the goal names these


class Twin(engines.Session):
    """The compiled twin as a session: whole turns, every state recorded."""

    def __init__(self, scene, dt):
        from curriculum import piles

        self.simulate, self.scene, self.dt, self.repeated = piles.simulate, scene, dt, 0

    def advance(self, n):
        q, v = self.simulate(
            "lcp",
            self.scene,
            self.dt,
            n,
            lambda k: None,
            contact.GRAVITY,
            contact.CONTACT_MARGIN,
            0.0,
            0.2,
            SWEEPS,
            contact.MOST_SWEEPS,
            contact.LAST_BITS,
            contact.SOLREF,
            contact.SOLIMP,
        )
        self.repeated += bool((q[-1] == q[-2]).all() and (v[-1] == v[-2]).all())
        self.scene = self.scene._replace(q0=q[-1], v0=v[-1])

    def state(self):
        return self.scene.q0, self.scene.v0


def measure(quick=False, cells=None):
    """rows (one per method and N), exponents, what is missing."""
    cells, sizes = {} if cells is None else cells, QUICK_SIZES if quick else SIZES
    spawn = multiprocessing.get_context("spawn")
    with measured.progress(sum(n for _, n in sizes.values()), "piles") as tick:
        for count, (steps, processes) in sizes.items():
            for number in range(processes):
                if timing.place("time", number, count) not in cells:
                    with spawn.Pool(1, end_at_ctrl_c) as pool:
                        found = pool.apply(one_process, ((count, steps, number),))
                    cells[timing.place("time", number, count)] = found
                tick(f"{count} balls")
    rows = [
        row
        for count, (_, processes) in sizes.items()
        for row in together(
            count, [cells[timing.place("time", number, count)] for number in range(processes)]
        )
    ]
    return dict(
        quick=quick,
        dt=DT,
        sweeps=SWEEPS,
        rows=rows,
        exponents=exponents(rows),
        headline=headline(rows),
        missing=missing(),
        sizes={
            str(count): dict(steps=steps, processes=processes)
            for count, (steps, processes) in sizes.items()
        },
    )


def missing():
    """{label: why} of whoever is not there."""
    found = {label: engines.missing(engine) for label, (engine, _) in ENGINES.items()}
    if importlib.util.find_spec("numba") is None:
        found[LCP] = "not installed: pip install numba"
    return {label: why for label, why in found.items() if why}


def one_process(key):
    """{method: {early, settled: seconds a step, repeated, depths}} of one size in this process."""
    count, steps, number = key
    scene = contact.build_scene("pile", 0, count)
    absent, sessions = missing(), {}
    if LCP not in absent:
        Twin(scene, DT).advance(2)  # compiles, or loads what was compiled
        sessions[LCP] = Twin(scene, DT)
    for label, (_, build) in ENGINES.items():
        if label not in absent:
            sessions[label] = build(scene, DT)
    turns, order = steps // TURN, random.Random(number)
    seconds = {name: [] for name in sessions}
    for _ in range(turns):
        for name in order.sample(list(sessions), len(sessions)):
            advance = sessions[name].advance
            seconds[name].append(timing.timed(partial(advance, TURN)) / TURN)
    early, settled = max(1, turns // 10), max(1, turns // 4)
    found = {
        name: dict(
            early=statistics.median(seconds[name][:early]),
            settled=statistics.median(seconds[name][-settled:]),
            repeated=getattr(session, "repeated", 0),
            **depths(session.state()[0], scene.radius),
        )
        for name, session in sessions.items()
    }
    if LCP in found and count <= PLAIN_UP_TO:
        found[PLAIN] = dict(found[LCP], **plain(scene, sessions[LCP].state()))
    return found


def plain(scene, last):
    """Time of contact.py's own steps [s], from the first state and from the twin's last one."""
    times = {}
    for phase, (q, v) in (("early", (scene.q0, scene.v0)), ("settled", last)):
        balls = contact.make_balls(scene._replace(q0=q, v0=v))
        times[phase] = statistics.median(
            timing.timed(partial(contact.lcp_step, balls, DT, 0.0, 0.2, SWEEPS)) for _ in range(9)
        )
    return times


def together(count, processes):
    """One row per method: times as median and spread over the processes, depths of the first."""
    for name in processes[0]:
        found = [process[name] for process in processes]
        times = {
            phase: timing.spread([one[phase] for one in found]) for phase in ("early", "settled")
        }
        yield {"method": name, "bodies": count, **found[0], **times}


def depths(q, radius):
    """Overlaps in a state (2, N): contacts counted, mean and worst depth in radii; finite or not."""
    if not np.isfinite(q).all():
        return dict(contacts=None, mean_depth=None, worst_depth=None, finite=False)
    scene = contact.Scene("", q, np.zeros_like(q), np.ones_like(radius), radius, 0.0, 0.0)
    found = [
        c.depth / radius[0] for c in contact.detect_contacts(contact.make_balls(scene), 0.0)
    ] or [0.0]
    return dict(
        contacts=len(found), mean_depth=float(np.mean(found)), worst_depth=max(found), finite=True
    )


def headline(rows):
    """{balls: {method: {settled_ms, mean_depth}}}, for texts that quote a number."""
    result = {}
    for row in rows:
        result.setdefault(str(row["bodies"]), {})[row["method"]] = dict(
            settled_ms=1e3 * row["settled"]["median"], mean_depth=row["mean_depth"]
        )
    return result


def exponents(rows):
    """{method: {early, settled}}: slope of log(time per step) over log(N), from FIT_FROM balls on."""
    result = {}
    for name in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == name and row["bodies"] >= FIT_FROM]
        if len(mine) >= 2:
            n = np.log([row["bodies"] for row in mine])
            result[name] = {
                phase: float(np.polyfit(n, np.log([r[phase]["median"] for r in mine]), 1)[0])
                for phase in ("early", "settled")
            }
    return result
