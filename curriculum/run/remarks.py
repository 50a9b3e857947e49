"""What a run's table does not say: flags that change nothing, and when and how hard exact lands."""

from collections.abc import Iterator

import numpy as np

import contact

OWNERS = {  # of the knobs that some models do not have
    "stiffness": ["penalty"],
    "damping": ["penalty"],
    "restitution": ["lcp", "soft", "exact"],
    **dict.fromkeys(("baumgarte", "iters", "warm"), ["lcp"]),
    **dict.fromkeys(("solref", "solimp"), ["soft"]),
}
APEXES = 5  # heights of bounces that are printed


def print_remarks(args, runs: dict[str, contact.Run], scene: contact.Scene) -> None:
    """Print a line on each flag that changes nothing here, and of exact alone what it did.

    args: the flags as contact.parse_flags gives them; runs {model: Run}.
    """
    usual = contact.parse_flags([])
    for knob, owners in OWNERS.items():
        given = getattr(args, knob) != getattr(usual, knob)
        if given and args.contact not in ("all", *owners):
            print(f"--{knob} is for {' and '.join(owners)}, and changes nothing here")
    if list(runs) == ["exact"]:
        print(*landing(runs["exact"], scene), sep="\n")


def landing(run: contact.Run, scene: contact.Scene) -> Iterator[str]:
    """Lines on the lowest ball's landing and bounces, from the parabolas between two states."""
    k = int(scene.q0[1].argmin())
    gap, vy = run.q[:, 1, k] - scene.radius[k], run.v[:, 1, k]
    dt, g = float(run.t[1]) if len(run.t) > 1 else 0.0, contact.GRAVITY
    struck = [j for j in range(len(gap) - 1) if vy[j + 1] - vy[j] - g * dt > 1e-9]
    who = "the ball" if len(scene.mass) == 1 else "the lowest ball"
    if not struck:
        yield f"exact: {who} does not land within these steps"
        return
    after = contact.time_to_impact(float(gap[struck[0]]), float(vy[struck[0]]), g)
    speed = -contact.speed(after, vy[struck[0]], g)
    yield f"exact: {who} lands after {run.t[struck[0]] + after:.6g} s, at {speed:.6g} m/s"
    tops = [gap[j] - vy[j] ** 2 / (2 * g) for j in range(struck[0], len(gap) - 1) if turns(vy, j)]
    if tops:
        heights = ", ".join(f"{top:.4g}" for top in tops[:APEXES])
        yield f"exact: its bounces rise to {heights} m" + (" ..." if len(tops) > APEXES else "")
    else:
        yield "exact: it does not bounce"


def turns(vy: np.ndarray, j: int) -> bool:
    """Whether a ball is at the top of a flight between two states."""
    return vy[j] > 0.0 >= vy[j + 1] and vy[j] - vy[j + 1] > 0.0
