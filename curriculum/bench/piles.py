"""Piles between walls of fixed balls: time a step while they fall and when they rest, and how deep.

The same walls in every engine. First each setting lets the pile fall from the same lattice and
settle, untimed; it counts as settled only if no ball covers its way faster than AT_REST from look
to look while it is watched: speeds may hold what the next step takes back.
Then it is timed in fresh processes: from the lattice, while the pile falls, and from its own
settled state. Every step is taken: no state is copied and no ball sleeps. Engines are compared at
equal depth: of each the fastest setting at rest whose mean depth of the overlapping contacts is at
most a limit. 10,000 balls are ten shafts of 1,000 side by side, and
each of them begins as the one had settled; only the settings run that won with 1,000.
"""

import math
import statistics
import sys
import tempfile
from functools import partial

import numpy as np

import contact
from curriculum import parallel
from curriculum.bench import accuracy, timing
from curriculum.bench.settings import PILES

DT = 0.002  # s
WATCHED, TURN, TURNS = 250, 50, 3  # steps at the end; timed steps in one go; how many goes
AT_REST = 1e-3  # m/s
DEPTHS = (1e-3, 1e-4)  # r
SIZES, SETTLE = {12: 4, 100: 10, 1000: 25}, 6000  # balls: side by side; steps to settle
MANY, COPIES, AGAIN = 10_000, 10, 1500  # made of settled copies; steps to settle again
PROCESSES, QUICK_SIZES = 3, (12,)


def shaft(count):
    """Balls on a lattice between two walls of fixed balls, and the floor. The seed is fixed."""
    if count == MANY:
        return side_by_side(shaft(MANY // COPIES))
    wide, r, rng = SIZES[count], contact.RADIUS, np.random.default_rng(0)
    place = rng.permutation(count)
    nudge = rng.uniform(-0.1 * r, 0.1 * r, (2, count))
    x = 2.5 * r * (place % wide - 0.5 * (wide - 1)) + nudge[0]
    y = 2.5 * r * (place // wide + 0.5) + nudge[1]
    wall = np.arange(1.05 * r, y.max() + 2.0 * r, 2.05 * r)  # no wall ball touches another
    side = 1.25 * r * wide + r
    x = np.concatenate((x, np.full(len(wall), -side), np.full(len(wall), side)))
    mass = np.repeat((1.0, math.inf), (count, 2 * len(wall)))
    return contact.scene_of(x, np.concatenate((y, wall, wall)), mass, name="shaft")


def side_by_side(scene):
    """So many copies of a shaft, each with its own walls; centred, for engines in float32."""
    places = (np.arange(COPIES) - 0.5 * (COPIES - 1)) * (np.ptp(scene.q0[0]) + 3.0 * contact.RADIUS)
    x = np.add.outer(places, scene.q0[0]).ravel()
    y, mass = np.tile(scene.q0[1], COPIES), np.tile(scene.mass, COPIES)
    return contact.scene_of(x, y, mass, name="shafts")


def measure(quick=False):
    """rows, one per setting and size; what compiling takes."""
    rows, states = [], {}
    for count in QUICK_SIZES if quick else (*SIZES, MANY):
        chosen = winners(rows) if count == MANY else range(0, len(PILES), 4 if quick else 1)
        rows += measured(count, chosen, states, quick)
    return dict(rows=rows, compile={} if quick else compiling())


def measured(count, chosen, states, quick):
    """The rows of one size: settle all settings, then time them. states[k]: the last settled."""
    scene, phases = shaft(count), ("falling", "resting")
    jobs = [(count, k, states.get(k)) for k in chosen if not PILES[k][0].refuses(scene)]
    print(f"pile of {count}: {len(jobs)} settings settle, then they are timed", flush=True)
    settled = parallel.run_jobs(settle, jobs, f"{count} balls settle")
    states.update((k, found[:2]) for (_, k, _), found in zip(jobs, settled))
    work = [(count, k, states[k]) for _, k, _ in jobs]
    processes = 1 if quick else PROCESSES - (count == MANY)
    times = timing.in_fresh_processes(time_of, work, processes, f"{count} balls")
    rows = []
    for (_, k, _), state, found in zip(jobs, settled, times):
        spreads = {phase: timing.spread([each[phase] for each in found]) for phase in phases}
        about = dict(bodies=count, family=PILES[k][0].engine, words=words(k))
        rows.append(about | state[2] | spreads)
    return rows


def words(k):
    setting, substeps = PILES[k]
    return setting.cut(substeps)


def build(k, scene):
    setting, substeps = PILES[k]
    return setting.build(scene, DT, substeps)


def settle(job):
    """q, v of the settled pile, and the row's depths and speed; the speed is watched to the end."""
    count, k, start = job
    scene, steps = shaft(count), SETTLE
    if count == MANY:
        one, steps = shaft(MANY // COPIES), AGAIN
        scene = side_by_side(one._replace(q0=np.array(start[0]), v0=np.array(start[1])))
    session = build(k, scene)
    session.go(steps - WATCHED)
    speeds, (before, _) = [], session.state()
    for _ in range(WATCHED // TURN):
        session.go(TURN)
        q, v = session.state()
        speeds.append(float(np.hypot(*(q - before)).max() / (TURN * DT)))
        before = q.copy()
    return q, v, dict(speed=float(np.max(speeds)), at_rest=rests(speeds), **depths(q, scene))


def rests(speeds):
    """Whether a pile rests, by the longest way of a ball from look to look, as a speed [m/s]."""
    return all(speed < AT_REST for speed in speeds)  # NaN is not


def depths(q, scene):
    """Overlaps in a state q (2, N): contacts counted, mean and worst depth [r]."""
    from curriculum import fast

    balls = fast.make_balls(q, 0.0 * q, scene.mass, scene.radius)
    a, b = fast.list_pairs(balls, 0.0)
    pairs = scene.radius[a] + scene.radius[b] - np.hypot(*(q[:, a] - q[:, b]))
    found = np.concatenate((scene.radius - q[1], pairs)) / contact.RADIUS
    found = found[found > 0.0]
    return dict(
        contacts=len(found),
        mean_depth=float(found.mean()) if len(found) else 0.0,
        worst_depth=float(found.max(initial=0.0)),
    )


def time_of(job, timed=timing.timed):
    """{falling, resting}: microseconds a step, from the lattice and from the settled state."""
    count, k, (q, v) = job
    scene, found = shaft(count), {}
    rest = scene._replace(q0=np.array(q, float), v0=np.array(v, float))
    for phase, start in (("falling", scene), ("resting", rest)):
        session = build(k, start)
        session.go(100)
        seconds = [timed(partial(session.go, TURN))[0] for _ in range(TURNS)]
        found[phase] = 1e6 * statistics.median(seconds) / TURN
    return found


def fastest(rows, depth):
    """{balls: {engine: its fastest row}} of what rests within a mean depth [r]."""
    may = (row for row in rows if row["at_rest"] and row["mean_depth"] <= depth)
    return accuracy.best(may, "bodies", time_at_rest)


def time_at_rest(row):
    """Microseconds a step."""
    return row["resting"]["median"]


def winners(rows):
    """The numbers of the settings that are worth running with 10,000 balls."""
    found = [row for depth in DEPTHS for row in fastest(rows, depth).get(1000, {}).values()]
    chosen = {(row["family"], row["words"]) for row in found}
    return [k for k, (s, _) in enumerate(PILES) if (s.engine, words(k)) in chosen]


def compiling():
    """{fresh, again}: seconds of a process that takes one step by the twin, compiled or not."""
    code = (
        "import contact; from curriculum import fast; "
        "fast.run_model('lcp', contact.build_scene('drop'), 0.002, 1, contact.Settings())"
    )
    with tempfile.TemporaryDirectory() as folder:
        return {
            name: timing.whole_process([sys.executable, "-c", code], folder)
            for name in ("fresh", "again")
        }
