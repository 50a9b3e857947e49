"""exact in many piles, and in towers of unequal masses beside 80 digits: a table on the screen.

    python -m curriculum.stress.exact_sweep piles --seeds 10      # 3 to 24 balls, minutes
    python -m curriculum.stress.exact_sweep towers --seeds 60     # masses 10^+-1.5 and 10^+-3

For a pile: the deepest overlap [r] and the largest rise of the energy [of the start's] over 4 s,
whether sampling every 8 ms and every 1 ms gives the same bits, and the time [s] until a start moved
by the last bit of one coordinate is 1e-8 r away. For a tower: the worst height error [r] over 1 s.
"""

import argparse
import time

import numpy as np

import contact
from curriculum import exact
from curriculum.common.stoppable import stoppable
from curriculum.stress import precise_tower

R, G = contact.RADIUS, contact.GRAVITY
COUNTS = (3, 6, 8, 12, 24)


def run(scene, times):
    """q, v, the number of events and the seconds of CPU time."""
    events, start = [], time.process_time()
    q, v = exact.simulate_exact(scene, times, G, events.append)
    return q, v, len(events), time.process_time() - start


def pile(count, seed, e):
    """One line about a pile."""
    scene = contact.build_scene("pile", seed, count, e)
    q, v, events, seconds = run(scene, np.arange(4001) * 1e-3)
    coarse = run(scene, np.arange(501) * 8e-3)[0]
    moved = scene.q0.copy()
    moved[0, 0] = np.nextafter(moved[0, 0], np.inf)
    other = run(scene._replace(q0=moved), np.arange(501) * 8e-3)[0]
    apart = np.abs(other - coarse).max((1, 2)) > 1e-8 * R
    total = contact.energy(q, v, scene.mass)
    return (
        f"pile of {count:>2}, seed {seed}, e {e:.1f}: {events:>6} events, {seconds:6.1f} s of CPU, "
        f"overlap {contact.max_penetration(q, scene.radius).max() / R:.1e} r, "
        f"rise {np.diff(total).max() / total[0]:.1e}, "
        f"bits {'the same' if coarse.tobytes() == q[::8].tobytes() else 'DIFFER'}, "
        + (f"parts at {apart.argmax() * 8e-3:.2f} s" if apart.any() else "does not part in 4 s")
    )


def random_tower(seed, spread):
    """A Scene of 2 to 10 balls, with and without gaps, masses up to 10^spread from 1 either way."""
    rng = np.random.default_rng([77, seed])
    count = int(rng.integers(2, 11))
    mass = 10.0 ** rng.uniform(-spread, spread, count)
    e = float(rng.choice([0.0, rng.uniform(0.0, 0.8), rng.uniform(0.0, 0.8)]))
    gaps = rng.uniform(0.0, 0.3, count) * (rng.random(count) < rng.choice([0.0, 0.5, 1.0]))
    gaps[0] += rng.uniform(0.0, 0.5)
    y = R * (2 * np.arange(count) + 1) + np.cumsum(gaps)
    q0 = np.array((np.zeros(count), y))
    return contact.Scene("tower", q0, 0.0 * q0, mass, np.full(count, R), e, 0.0)


def tower_error(scene):
    """The worst height error [r] over a second."""
    times = np.linspace(0.0, 1.0, 21)
    right = precise_tower.heights(
        scene.q0[1], scene.v0[1], scene.mass, scene.radius, scene.restitution, G, times
    )
    return np.abs(run(scene, times)[0][:, 1] - right).max() / R


@stoppable
def main(argv=None):
    """Print the lines. Returns 0."""
    parser = argparse.ArgumentParser(description="exact in many piles or towers.")
    parser.add_argument("what", choices=("piles", "towers"))
    parser.add_argument("--seeds", type=int, default=10)
    args = parser.parse_args(argv)
    if args.what == "piles":
        for count in COUNTS:
            for e in (0.0, 0.5):
                for seed in range(args.seeds):
                    print(pile(count, seed, e), flush=True)
        return 0
    for spread in (1.5, 3.0):
        errors = [tower_error(random_tower(seed, spread)) for seed in range(args.seeds)]
        good = [x for x in errors if x <= 1e-9]
        print(
            f"masses 10^+-{spread:g}: {len(good)} of {len(errors)} towers within 1e-9 r, "
            f"these within {max(good):.1e} r; the others: "
            + ", ".join(f"{k} ({x:.1e} r)" for k, x in enumerate(errors) if x > 1e-9)
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
