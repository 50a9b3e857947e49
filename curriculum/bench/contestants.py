"""The contestants: contact.py's models and the peers behind one interface, each with its fixed look.

A look is colour, marker and dash together, so that lines are told apart in black and white.
"""

from typing import Callable, NamedTuple, Optional

import numpy as np

import contact
from curriculum.bench import peers

READ, BARE = "read", "bare"     # the two ways to time: see Method.prepare


class Method(NamedTuple):
    """One way of stepping a scene. `order` is the theoretical order of convergence, with its reason."""
    name: str
    label: str
    color: str
    marker: str
    dash: object
    order: Optional[int]
    why: str
    prepare: Callable       # (scene, dt, steps) -> {READ: call, BARE: call}; the calls step, no more
    record: Callable        # (scene, dt, steps) -> contact.Run, not timed
    missing: Optional[str] = None       # what to install, when it can't run


def _ours(model, **options):
    def run(scene, dt, steps):
        return contact.run_model(model, scene, dt, steps, **options)

    def prepare(scene, dt, steps):
        return {READ: lambda: run(scene, dt, steps)}    # it always records: there is no bare form

    return dict(prepare=prepare, record=run)


def _peer(name):
    peer = next(p for p in peers.PEERS if p.name == name)

    def prepare(scene, dt, steps):
        read, bare = peer.build(scene, dt), peer.build(scene, dt)
        return {READ: lambda: read.trace(steps), BARE: lambda: bare.advance(steps)}

    def record(scene, dt, steps):
        session = peer.build(scene, dt)
        states = [session.state()]
        for _ in range(steps):
            session.advance(1)
            states.append(session.state())
        q, v = (np.array(rows) for rows in zip(*states))
        return contact.Run(np.arange(steps + 1) * dt, q, v)

    missing = None if peer.version() else f"not installed: pip install {peer.package}"
    return dict(prepare=prepare, record=record, label=peer.label, missing=missing)


SOFT = "its contact is soft, whatever the step"
FLIGHT = "semi-implicit flight"
ONCE = f"{FLIGHT}, and no step is cut at an impact"

METHODS = (
    Method("penalty", "penalty", contact.COLORS["penalty"], "v", (0, (1, 1)), 0, SOFT, **_ours("penalty")),
    Method("lcp10", "lcp, 10 sweeps", "#56b4e9", "<", (0, (4, 2)), 1, ONCE, **_ours("lcp", iters=10)),
    Method("lcp", "lcp, 20 sweeps", contact.COLORS["lcp"], "o", "-", 1, ONCE, **_ours("lcp", iters=20)),
    Method("lcp100", "lcp, 100 sweeps", "#003f6b", ">", (0, (6, 2, 1, 2)), 1, ONCE,
           **_ours("lcp", iters=100)),
    Method("exact", "exact", contact.COLORS["exact"], "*", "-", None, "no step error", **_ours("exact")),
    Method("mujoco", color="#999999", marker="x", dash=(0, (2, 2)), order=0, why=SOFT, **_peer("mujoco")),
    Method("mujoco_stiff", color="#000000", marker="s", dash="-", order=1,
           why="its softness shrinks with the step", **_peer("mujoco_stiff")),
    Method("pymunk", color="#cc79a7", marker="D", dash=(0, (5, 1)), order=1, why=ONCE, **_peer("pymunk")),
    Method("box2d", color="#e69f00", marker="P", dash=(0, (3, 1, 1, 1)), order=1, why=FLIGHT,
           **_peer("box2d")),
    Method("box2d3", color="#8b6914", marker="^", dash=(0, (1, 2)), order=1, why=FLIGHT, **_peer("box2d3")),
    Method("box2d3_stiff", color="#5d3a9b", marker="h", dash="-", order=1, why=FLIGHT,
           **_peer("box2d3_stiff")),
)
BY_NAME = {method.name: method for method in METHODS}
OURS = tuple(m.name for m in METHODS if not any(m.name == p.name for p in peers.PEERS))
