"""The slips that are seen most: [(a function that makes it, what it means)] by blank.

A wrong fill is named by comparing what it gives on all inputs with what these give.
"""

from math import sqrt  # noqa: F401  expressions below use it


def table(names, slips):
    """The slips {expression: meaning} of a blank with these arguments."""
    return [(eval(f"lambda {names}: {text}", globals()), meaning)  # noqa: S307  our own text
            for text, meaning in slips.items()]


def matrix(m, k, c, dt):
    """The right matrix of exercise 6, which most slips of it change in one place."""
    slowed = 1.0 - dt * c / m
    return [[1.0 - dt * dt * k / m, -dt * slowed], [dt * k / m, slowed]]


def solver(missing="c.target - c.v_n()", total="max(0.0, c.lam + add)", mass="c.m_eff",
           push="c.push(lam - c.lam)", most=10**9, kept="lam"):
    """A solve_contacts with one of its parts exchanged."""
    lines = (f"for _ in range(min({most}, iters)):", " for c in contacts:",
             f"  add = ({missing}) * {mass}", f"  lam = {total}", f"  {push}", f"  c.lam = {kept}")
    code = compile("\n".join(lines), "a slip of solve_contacts", "exec")
    return lambda contacts, iters: exec(code, {"contacts": contacts, "iters": iters})  # noqa: S102


PULLS = "nothing keeps the table from pulling"
SPRING = "1 / (k * dt * dt + c * dt)"
SLIPS = {
    "penalty_normal_force": table("x, v, k, c", {
        "k * x - c * v": f"{PULLS}: the damper can outweigh the spring on the way out",
        "k * x + c * v": f"the damper pushes along with the motion, and {PULLS}",
        "max(0, k * x + c * v)": "the damper pushes along with the motion: look up the sign of v_n",
        "max(0, k * x - c * abs(v))": "the damper takes from the push on the way in too",
        "max(0, k * x + c * abs(v))": "the damper adds to the push on the way out too",
        "max(0, k * x - c * max(0, v))": "the damper works on the way out only",
        "k * x": "the damper is missing",
        "max(0, -c * v)": "the spring is missing",
        "abs(k * x - c * v)": "a pull has been turned round into a push",
        "max(0, -k * x - c * v)": "the spring pulls: depth > 0 is an overlap",
        "max(0, 1e4 * x - 80 * v)": "numbers stand where `stiffness` and `damping` should",
    }),
    "project_impulse": table("lam, dlam", {
        "lam + dlam": f"{PULLS}: the sum may not become negative",
        "lam + max(0, dlam)": "the clamp is on the change: what is too much stays for good",
        "max(0, dlam)": "only the last correction comes out: what was pushed before is forgotten",
        "max(0, lam - dlam)": "the correction is taken off: dlam is to be added",
        "abs(lam + dlam)": "a negative sum has been turned round into a push",
        "lam": "the correction is not used",
    }),
    "solve_contacts": [
        (solver(total="c.lam + max(0.0, add)"), "the clamp is on the change, and it belongs on the "
         "sum: what was pushed too much must be taken back"),
        (solver(total="c.lam + add"), "no clamp: a contact never pulls, so lam is never negative"),
        (solver("c.v_n() - c.target"), "the sign of what is missing: it is target - v_n"),
        (solver("-c.target - c.v_n()"), "the sign of the target"),
        (solver(push="c.a.vx += (lam - c.lam) * c.ax; c.a.vy += (lam - c.lam) * c.ay"),
         "the other body is forgotten: push moves both"),
        (solver(most=1), "one sweep: the neighbours that it disturbs are never mended"),
        (solver(push="c.push(lam)"), "the whole lam is pushed at each visit, and not its change"),
        (solver(total="max(0.0, add)", kept="0.0"), "c.lam does not hold the sum of corrections"),
        (solver(push=""), "lam is worked out and never pushed"),
        (solver(mass="1.0"), "m_eff is missing: an impulse is a mass times a velocity"),
    ],
    "step_matrix": table("m, k, c, dt", {
        "[[1, -dt], [dt * k / m, 1 - dt * c / m]]":
            "the depth moves with the old velocity: that is explicit Euler",
        "matrix(m, k, -c, dt)": "the sign of the damper",
        "matrix(m, -k, c, dt)": "the sign of the spring: a depth pushes up",
        "matrix(m, k, 0, dt)": "the damper is missing",
        "list(zip(*matrix(m, k, c, dt)))": "rows and columns are exchanged",
        "[row[::-1] for row in matrix(m, k, c, dt)[::-1]]":
            "the order is (v_n, depth), asked for is (depth, v_n)",
        "[[1 + dt * dt * k / m, dt - dt * dt * c / m], [dt * k / m, 1 - dt * c / m]]":
            "v_n > 0 goes out of the table, so the depth becomes smaller",
    }),
    "longest_step": table("m, k, c", {
        "2 * sqrt(m / k)": "that is the limit without the damper",
        "(c + sqrt(c * c + 4 * k * m)) / k": "the damper's sign: it should bring the limit nearer",
        "sqrt(m / k)": "that is half the limit without the damper",
    }),
    "implicit_spring": table("x, k, c, dt", {
        "(1 / (k * dt * dt), x / dt)": "the damper is missing",
        "(1 / (k * dt + c), k * x / (k * dt + c))":
            "that softness is for a force; lam is an impulse, dt times as large",
        "(k * dt * dt + c * dt, dt * k * x / (k * dt * dt + c * dt))":
            "the softness is upside down: a stiff spring is not soft",
        f"({SPRING}, dt * k * x)":
            "the target is an impulse still: the equation has to be divided as a whole",
        f"({SPRING}, x / dt)": "the target asks for the whole depth, and the damper slows that",
        f"({SPRING}, -dt * k * x * {SPRING})": "the sign of the target: an overlap should open",
        f"(dt * k * x * {SPRING}, {SPRING})": "the order: softness first, then target",
    }),
}
