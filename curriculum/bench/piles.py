"""A pile of N balls: time per step early and settled, how it grows with N, and the depth it leaves.

All engines fall from the same lattice, in turns of a few steps, so that a slow spell of the machine
falls on all of them. Nothing is read while they are timed. Early is the first tenth of the run, when
most balls still fall; settled is the last quarter, which is the fair figure.
"""


import numpy as np

import contact
from curriculum.bench import peers, timing

DT, SWEEPS, TURN = 0.002, 10, 25        # s; sweeps of lcp and iterations of pymunk; steps at a time
ENGINES = ("pymunk", "box2d", "box2d3", "box2d3_stiff", "mujoco", "mujoco_stiff")
FIT_FROM = 1000                         # balls: the exponent is fitted from here on


class Pile(peers.Session):
    """contact.py's lcp as a session: its own step function, nothing recorded.

    all_pairs: rows of floats, so every pair is looked at and contacts are swept one by one; otherwise
    arrays. Both give the same bits.
    """

    def __init__(self, scene, dt, sweeps=SWEEPS, all_pairs=False):
        self.q, self.v = tuple(scene.q0), tuple(scene.v0)
        inv_mass, radius = 1.0 / scene.mass, scene.radius
        if all_pairs:
            inv_mass, radius = inv_mass.tolist(), radius.tolist()
            self.q, self.v = ([row.tolist() for row in rows] for rows in (self.q, self.v))

        def step():
            self.q, self.v = contact.lcp_step(self.q, self.v, inv_mass, radius, dt,
                                              scene.restitution, 0.2, sweeps)
        self.step = step

    def state(self):
        return np.array(self.q), np.array(self.v)


def measure(quick=False):
    """The whole benchmark; returns a JSON-ready dict: rows, one per method and N, and exponents."""
    sizes = {100: 200, 1000: 50} if quick else {100: 1500, 1000: 1500, 10000: 1500}     # balls: steps
    rows = [row for count, steps in sizes.items() for row in _one_size(count, steps)]
    return dict(quick=quick, dt=DT, sweeps=SWEEPS, rows=rows, headline=headline(rows),
                exponents=exponents(rows),
                missing={p.name: f"not installed: pip install {p.package}"
                         for p in peers.PEERS if not p.version()})


def _one_size(count, steps):
    scene = contact.build_scene("pile", 0, count)
    sessions = {"lcp": Pile(scene, DT)}
    for peer in peers.PEERS:
        if peer.name in ENGINES and peer.version():
            sessions[peer.name] = peer.build(scene, DT)
    turns = steps // TURN
    seconds = {name: [] for name in sessions}
    bar = timing.Progress(turns * len(sessions), f"pile of {count}")
    start = {name: session.state() for name, session in sessions.items()}
    for _ in range(turns):
        for name, session in sessions.items():
            seconds[name].append(timing.timed(lambda: session.advance(TURN)) / TURN)
            bar(name)
    bar.close()
    rows = []
    for name, session in sessions.items():
        q, v = session.state()
        rows.append(dict(method=name, bodies=count, steps=steps, **_phases(seconds[name]),
                         **depths(q, scene.radius)))
    rows.append(_all_pairs(scene, start["lcp"], sessions["lcp"].state(), rows[0]))
    return rows


def _phases(seconds):
    """Time per step [s], early and settled, each with its spread over the turns."""
    early, settled = max(1, len(seconds) // 10), max(1, len(seconds) // 4)
    return dict(early=timing.spread(seconds[:early]), settled=timing.spread(seconds[-settled:]))


def _all_pairs(scene, first, last, row):
    """The same two steps without skips, all pairs and contact by contact: from the first state and from
    the last one. Depths are those of the skipping run, since the bits are.
    """
    times = {}
    for phase, (q, v) in (("early", first), ("settled", last)):
        values = []
        for _ in range(1 if len(scene.mass) > 1000 else 3):
            session = Pile(scene._replace(q0=q, v0=v), DT, all_pairs=True)
            values.append(timing.timed(session.step))
        times[phase] = timing.spread(values)
    return {**row, **times, "method": "all pairs"}


def depths(q, radius):
    """Overlaps in a state (2, N): contacts counted, mean and worst depth in radii; finite or not."""
    if not np.isfinite(q).all():
        return dict(contacts=None, mean_depth=None, worst_depth=None, finite=False)
    depth = np.array([0.0])
    contacts = contact.detect_contacts(tuple(q), radius, 0.0)
    if contacts:
        depth = np.concatenate([np.atleast_1d(c[4]) for c in contacts])
    return dict(contacts=len(depth), mean_depth=float(depth.mean() / radius[0]),
                worst_depth=float(depth.max() / radius[0]), finite=True)


def headline(rows):
    """{balls: {method: {settled_ms, mean_depth}}}, for texts that quote a number."""
    result = {}
    for row in rows:
        result.setdefault(str(row["bodies"]), {})[row["method"].replace(" ", "_")] = dict(
            settled_ms=1e3 * row["settled"]["median"], mean_depth=row["mean_depth"])
    return result


def exponents(rows):
    """{method: {early, settled}}: slope of log(time per step) over log(N), from FIT_FROM balls on."""
    result = {}
    for name in dict.fromkeys(row["method"] for row in rows):
        mine = [row for row in rows if row["method"] == name and row["bodies"] >= FIT_FROM]
        if len(mine) >= 2:
            n = np.log([row["bodies"] for row in mine])
            result[name] = {phase: float(np.polyfit(n, np.log([r[phase]["median"] for r in mine]), 1)[0])
                            for phase in ("early", "settled")}
    return result
