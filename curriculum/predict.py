"""Six errors of contact, by the chapter's formulas and by a run: put your own numbers in.

    python -m curriculum.predict --mass 3 --stiffness 2e4 --damping 30 --dt 0.003 --bodies 5

The formulas take and return SI units: lengths in m, angles in rad. The command prints radii.
"""

import math
from functools import partial

import contact
from contact import np  # which says how to install it where it is missing
from curriculum.commands import Parser, number

G = -contact.GRAVITY  # m/s^2
FALLS = np.linspace(0.88, 0.92, 40)  # m: how far a ball falls; a landing depends on it
START = 0.1  # rad from the top of the hill: where the sliding ball starts
USUAL = dict(mass=1.0, stiffness=1e4, damping=80.0, dt=0.002, bodies=3, radius=contact.RADIUS)
USUAL |= {"baumgarte": contact.Settings().baumgarte, "iters": 1}  # what the command begins with
HOLDS = """\
dive: of a step well below the critical one; of lcp at worst. sag: iters 1, or up to bodies^2 / 40
flicker: later in a run, since the ball must first come out of its depth. The others: always"""


def sink(mass, stiffness):
    """Compute how deep [m] a ball rests in penalty's floor that carries `mass`, its own too."""
    return mass * G / stiffness


def dive_of_penalty(speed, mass, stiffness, damping):
    """Compute how deep [m] a ball dives that lands on penalty's spring at `speed` [m/s].

    It is the first peak of the damped spring m x'' = m g - k x - c x', to first order in g. A run
    scatters about it by up to zeta dt sqrt(k / m): where in a step the ball lands decides.
    """
    zeta = damping / (2.0 * math.sqrt(stiffness * mass))
    root = np.emath.sqrt(1.0 - zeta * zeta)  # imaginary where nothing rings
    power = abs(zeta * np.emath.arccos(zeta) / root) if root else 1.0
    left = math.exp(-power)  # the share of the depth that the damper leaves
    undamped = speed * math.sqrt(mass / stiffness)
    return left * undamped + (1.0 - 2.0 * zeta * left) * sink(mass, stiffness)


def dive_of_lcp(speed, dt):
    """Compute how deep [m] lcp's ball may be when its contact is first seen: at worst so deep."""
    return max(0.0, speed * dt - contact.CONTACT_MARGIN)


def hop(depth, dt, baumgarte):
    """Compute how high [m] lcp's ball, e = 0, rises above the floor after a landing at `depth` [m].

    It leaves at u = beta depth / dt; in steps it rises u^2 / (2 g) - u dt / 2, from what is left
    of the overlap, (1 - beta) depth. It is right to g dt^2 / 8.
    """
    return max(0.0, (baumgarte * depth / dt) ** 2 / (2.0 * G) - (1.0 - 0.5 * baumgarte) * depth)


def sag(above, mass, dt, baumgarte, iters):
    """Compute how deep [m] lcp's ball rests that carries the mass `above`, in a column.

    Right with one sweep; with K within a tenth while K is below a fortieth of n^2, n balls.
    """
    return above / mass * G * dt * dt / (baumgarte * iters)


tremble = contact.critical_dt  # (mass, stiffness, damping, count): penalty trembles above this step


def flicker(start, d0):
    """Compute the angle [rad] at which soft's force begins to come and go, on a hill's slope.

    The ball starts at rest at the angle `start` from the top, d0 is the impedance at the surface.
    A run comes later, by the time that the ball takes to come out of the depth at which it lay.
    """
    return math.acos(min(1.0, 2.0 * math.cos(start) / (3.0 - d0)))


def quality(model, scene, dt, seconds, beside_exact=False, **knobs):
    """Run a model and measure it, beside exact for what is an error against it."""
    steps = round(seconds / dt)
    made = contact.run_model(model, scene, dt, steps, contact.Settings(**knobs))
    exact = contact.run_model("exact", scene, dt, steps) if beside_exact else None
    return contact.contact_quality(made, scene, dt, exact)


def first_without_force(dt, start, **knobs):
    """Return the angle [rad] of the first step in which soft does not push, or pi if none, on the
    hill of the scene slide; in 4 s a ball leaves it."""
    hill, force = contact.HILL, []
    far = hill + contact.RADIUS
    x, y = [0.0, far * math.sin(start)], [hill, hill + far * math.cos(start)]
    scene = contact.scene_of(x, y, [math.inf, 1.0], [hill, contact.RADIUS])
    push = contact.step_of("soft", scene, dt, contact.Settings(**knobs))
    step = lambda balls: force.append(sum(c.lam for c in push(balls)))  # noqa: E731
    q = contact.simulate(step, scene, dt, round(4.0 / dt)).q[:-1, :, 1]
    off = np.flatnonzero(np.array(force[10:]) == 0.0) + 10  # it begins on the surface, unpressed
    return math.atan2(q[off[0], 0], q[off[0], 1] - hill) if len(off) else math.pi


def compare(mass, stiffness, damping, dt, bodies, radius, baumgarte, iters):
    """Return {error: (by its formula, by a run, unit)}.

    Of lcp's landings the deepest and the highest hop count. tremble's run is the shortest of some
    steps, 1 % apart, after which the column of `bodies` balls does not come to rest.
    """
    own = partial(contact.scene_of, 0.0, mass=mass, radius=radius, damping=damping)
    column = own(radius * (1.0 + 2.0 * np.arange(bodies)))
    spring = partial(quality, "penalty", stiffness=stiffness)
    lcp = partial(quality, "lcp", dt=dt, baumgarte=baumgarte, iters=iters)
    drop, speed = spring(own(radius + FALLS[-1]), dt, 40.0), math.sqrt(2.0 * G * FALLS[-1])
    landings = [lcp(own(radius + fall), seconds=2.0) for fall in FALLS]
    highest = max(landings, key=lambda each: each["rebound_frac"])
    limit = tremble(mass, stiffness, damping, bodies)
    steps = [limit * (1.0 + 0.01 * percent) for percent in range(-5, 6)]
    moving = (each for each in steps if not spring(column, each, 4000 * each)["rests"])
    deep = highest["max_penetration_frac"] * radius
    dives = dive_of_penalty(speed, mass, stiffness, damping), dive_of_lcp(speed, dt)
    deepest = max(each["max_penetration_frac"] for each in landings)
    sags = sag((bodies - 1) * mass, mass, dt, baumgarte, iters), lcp(column, seconds=8.0)
    angles = flicker(START, contact.SOLIMP[0]), first_without_force(dt, START)
    return {
        "sink": (sink(mass, stiffness) / radius, drop["rest_penetration_frac"], "r"),
        "dive of penalty": (dives[0] / radius, drop["max_penetration_frac"], "r"),
        "dive of lcp": (dives[1] / radius, deepest, "r"),
        "hop": (hop(deep, dt, baumgarte) / radius, highest["rebound_frac"], "r"),
        "sag": (sags[0] / radius, sags[1]["rest_penetration_frac"], "r"),
        "tremble": (limit, next(moving, math.inf), "s"),
        "flicker": (*map(math.degrees, angles), "degrees"),
    }


def main(argv=None):
    """Print the comparison. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.predict", description=__doc__)
    for name, usual in USUAL.items():
        low = 1e-4 if type(usual) is float else 1  # s, m, ...; in smaller steps a run takes hours
        kind = partial(number, type(usual), low, min(contact.LIMITS[name][2], 1e9))
        parser.add_argument(f"--{name}", type=kind, default=usual, help=f"({usual:g})")
    rows = compare(**vars(parser.parse_args(argv)))
    print(f"{'':<16}{'paper':>12}{'run':>12}")
    for error, (paper, run, unit) in rows.items():
        print(f"{error:<16}{paper:>12.5g}{run:>12.5g} {unit}")
    print(HOLDS)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
