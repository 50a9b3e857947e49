"""Six errors of contact, by the chapter's formulas and by a run: put your own numbers in.

    python -m curriculum.predict --mass 3 --stiffness 2e4 --damping 30 --dt 0.003 --bodies 5

A formula takes and returns SI units: lengths in m, angles in rad. The command prints radii.
"""

import math
from functools import partial

import contact
from contact import np  # which says how to install it where it is missing
from curriculum.commands import Parser, number

G = -contact.GRAVITY  # m/s^2
HEIGHTS = np.linspace(0.98, 1.02, 40)  # m: where the centre starts; a landing depends on it
START = math.radians(6.0)  # from the top of the hill, where the sliding ball starts
USUAL = dict(mass=1.0, stiffness=1e4, damping=80.0, dt=0.002, bodies=3, radius=contact.RADIUS)
USUAL |= {"baumgarte": contact.Settings().baumgarte, "iters": 1}  # what the command begins with


def sink(mass, stiffness, count=1):
    """Compute how deep [m] the lowest of `count` balls rests in penalty's floor."""
    return count * mass * G / stiffness


def dive_of_penalty(speed, mass, stiffness, damping):
    """Compute how deep [m] a ball dives that lands on penalty's spring at `speed` [m/s].

    It is the first peak of the damped spring m x'' = m g - k x - c x', to first order in g. A run
    scatters about it by up to zeta dt sqrt(k / m): where in a step the ball lands decides.
    """
    zeta = damping / (2.0 * math.sqrt(stiffness * mass))
    if zeta < 1.0:
        power = zeta * math.acos(zeta) / math.sqrt(1.0 - zeta * zeta)
    else:
        power = zeta * math.acosh(zeta) / math.sqrt(zeta * zeta - 1.0) if zeta > 1.0 else 1.0
    left = math.exp(-power)  # the share of the depth that the damper leaves
    return (
        left * speed * math.sqrt(mass / stiffness)
        + (1.0 - 2.0 * zeta * left) * mass * G / stiffness
    )


def dive_of_lcp(speed, dt):
    """Compute how deep [m] lcp's ball may be when its contact is first seen: at worst so deep."""
    return max(0.0, speed * dt - contact.CONTACT_MARGIN)


def hop(depth, dt, baumgarte):
    """Compute how high [m] lcp's ball, e = 0, rises above the floor after a landing at `depth` [m].

    It leaves at u = beta depth / dt; in steps it rises u^2 / (2 g) - u dt / 2, from what is left
    of the overlap, (1 - beta) depth. It is right to g dt^2 / 8.
    """
    return max(0.0, (baumgarte * depth / dt) ** 2 / (2.0 * G) - (1.0 - 0.5 * baumgarte) * depth)


def sag(above, mass, dt, baumgarte, iters, warm=0.0):
    """Compute how deep [m] lcp's ball rests that carries the mass `above`, in a column.

    Right with one sweep; with K within a tenth while K is below a fortieth of n^2, n balls.
    """
    return (1.0 - warm) * above / mass * G * dt * dt / (baumgarte * iters)


tremble = contact.critical_dt  # (mass, stiffness, damping, count): penalty trembles above this step


def flicker(start, d0):
    """Compute the angle [rad] at which soft's force begins to come and go, on a hill's slope.

    The ball starts at rest at the angle `start` from the top, d0 is the impedance at the surface.
    A run comes later, by the time that the ball takes to come out of the depth at which it lay.
    """
    return math.acos(min(1.0, 2.0 * math.cos(start) / (3.0 - d0)))


def quality(model, scene, dt, seconds, **knobs):
    """Run a model and measure it."""
    made = contact.run_model(model, scene, dt, round(seconds / dt), contact.Settings(**knobs))
    return contact.contact_quality(made, scene, dt)


def first_without_force(dt, start, **knobs):
    """Return the angle [rad] of the first step in which soft does not push, or pi if none."""
    far, force = contact.HILL + contact.RADIUS, []
    x, y = [0.0, far * math.sin(start)], [contact.HILL, contact.HILL + far * math.cos(start)]
    scene = contact.scene_of(x, y, [math.inf, 1.0], [contact.HILL, contact.RADIUS])
    step = contact.step_of("soft", scene, dt, contact.Settings(**knobs))
    note = lambda k, contacts: force.append(sum(c.lam for c in contacts))  # noqa: E731
    q = contact.simulate(step, scene, dt, round(4.0 / dt), on_step=note).q[:-1, :, 1]
    off = np.flatnonzero(np.array(force[10:]) == 0.0) + 10  # it begins on the surface, unpressed
    return math.atan2(q[off[0], 0], q[off[0], 1] - contact.HILL) if len(off) else math.pi


def compare(mass, stiffness, damping, dt, bodies, radius, baumgarte, iters):
    """Return {error: (by its formula, by a run)}: lengths in radii, times in s, angles in rad.

    Of lcp's landings from HEIGHTS the deepest and the highest hop count. tremble has the shortest
    step, of some 1 % apart, after which the column of `bodies` balls does not come to rest.
    """
    own = partial(contact.scene_of, 0.0, mass=mass, radius=radius, damping=damping)
    column, r = own(radius * (1.0 + 2.0 * np.arange(bodies))), radius
    lcp, spring = {"baumgarte": baumgarte, "iters": iters}, {"stiffness": stiffness}
    speed = math.sqrt(2.0 * G * (HEIGHTS[-1] - radius))
    dropped = quality("penalty", own(HEIGHTS[-1]), dt, 40.0, **spring)
    landings = [quality("lcp", own(y), dt, 2.0, **lcp) for y in HEIGHTS]
    depths = [each["max_penetration_frac"] for each in landings]
    hops = max((each["rebound_frac"], depth) for each, depth in zip(landings, depths))
    limit = tremble(mass, stiffness, damping, bodies)
    tried = [limit * (0.95 + 0.01 * share) for share in range(11)]
    rests = lambda step: quality("penalty", column, step, 4000 * step, **spring)["rests"]  # noqa: E731
    rest = quality("lcp", column, dt, 8.0, **lcp)["rest_penetration_frac"]
    return {
        "sink": (sink(mass, stiffness) / r, dropped["rest_penetration_frac"]),
        "dive of penalty": (
            dive_of_penalty(speed, mass, stiffness, damping) / r,
            dropped["max_penetration_frac"],
        ),
        "dive of lcp": (dive_of_lcp(speed, dt) / r, max(depths)),
        "hop": (hop(hops[1] * r, dt, baumgarte) / r, hops[0]),
        "sag": (sag((bodies - 1) * mass, mass, dt, baumgarte, iters) / r, rest),
        "tremble": (limit, next((step for step in tried if not rests(step)), tried[-1])),
        "flicker": (flicker(START, contact.SOLIMP[0]), first_without_force(dt, START)),
    }


def main(argv=None):
    """Print the comparison. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.predict", description=__doc__)
    for name, usual in USUAL.items():
        low, high = contact.LIMITS[name][1:3]
        kind = partial(number, type(usual), max(low, 1e-6), min(high, 1e9))
        parser.add_argument(f"--{name}", type=kind, default=usual, help=f"({usual:g})")
    rows = compare(**vars(parser.parse_args(argv)))
    print(f"{'':<16}{'paper':>12}{'run':>12}")
    for error, (paper, found) in rows.items():
        unit = {"tremble": "s", "flicker": "rad"}.get(error, "r")
        print(f"{error:<16}{paper:>12.5g}{found:>12.5g} {unit}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
