"""The slips that are seen most, as functions that make them: [(function, what it means)] by blank.

A wrong fill is named by comparing what it gives on all inputs with what these give.
"""

import math


def matrix(m, k, c, dt):
    """The right matrix of exercise 6, which most slips of it change in one place."""
    slowed = 1.0 - dt * c / m
    return [[1.0 - dt * dt * k / m, -dt * slowed], [dt * k / m, slowed]]


def solver(missing=lambda c: c.target - c.v_n(), total=lambda c, add: max(0.0, c.lam + add),
           mass=lambda c: c.m_eff, push=lambda c, change, lam: c.push(change), most=10**9, keep=True):
    """A solve_contacts with one of its parts exchanged."""
    def solve(contacts, iters):
        for _ in range(min(most, iters)):
            for c in contacts:
                lam = total(c, missing(c) * mass(c))
                push(c, lam - c.lam, lam)
                c.lam = lam if keep else 0.0
    return solve


def one_sided(c, change, lam):
    """A push of the upper body alone."""
    c.a.vy += change * c.a.inv_mass


def same_way(c, change, lam):
    """A push of both bodies upwards."""
    c.a.vy += change * c.a.inv_mass
    c.b.vy += change * c.b.inv_mass


PULLS = "nothing keeps the table from pulling"
SLIPS = {
    "penalty_normal_force": [
        (lambda x, v, k, c: k * x - c * v,
         PULLS + ": on the way out the damper can outweigh the spring"),
        (lambda x, v, k, c: max(0.0, k * x + c * v),
         "the damper pushes along with the motion: look up the sign of v_n"),
        (lambda x, v, k, c: k * x + c * v, "the damper pushes along with the motion, and " + PULLS),
        (lambda x, v, k, c: max(0.0, k * x - c * abs(v)),
         "the damper takes from the push on the way in too, where it should add to it"),
        (lambda x, v, k, c: max(0.0, k * x + c * abs(v)),
         "the damper adds to the push on the way out too, where it should take from it"),
        (lambda x, v, k, c: k * x, "the damper is missing"),
        (lambda x, v, k, c: max(0.0, -c * v), "the spring is missing"),
        (lambda x, v, k, c: max(0.0, k * x - c * min(0.0, v)),
         "the damper works on the way in only"),
        (lambda x, v, k, c: max(0.0, k * x - c * max(0.0, v)),
         "the damper works on the way out only"),
        (lambda x, v, k, c: min(0.0, k * x - c * v), "this lets the table pull and never push"),
        (lambda x, v, k, c: abs(k * x - c * v), "a pull has been turned round into a push"),
        (lambda x, v, k, c: max(0.0, -k * x - c * v), "the spring pulls: depth > 0 is an overlap"),
        (lambda x, v, k, c: max(0.0, 1e4 * x - 80.0 * v), "numbers stand where `stiffness` and "
         "`damping` should: they fit a single contact"),
    ],
    "project_impulse": [
        (lambda lam, dlam: lam + dlam, PULLS + ": the sum may not become negative"),
        (lambda lam, dlam: lam + max(0.0, dlam), "the clamp is on the change: a push that was too "
         "large can never be taken back"),
        (lambda lam, dlam: max(0.0, dlam),
         "only the last correction comes out: what was pushed before it is forgotten"),
        (lambda lam, dlam: max(0.0, lam - dlam), "the correction is taken off: dlam is to be added"),
        (lambda lam, dlam: abs(lam + dlam), "a negative sum has been turned round into a push"),
        (lambda lam, dlam: max(lam, dlam), "this is the larger of the two, and not their sum"),
        (lambda lam, dlam: min(0.0, lam + dlam), "this lets the table pull and never push"),
        (lambda lam, dlam: lam, "the correction is not used"),
    ],
    "solve_contacts": [
        (solver(total=lambda c, add: c.lam + max(0.0, add)), "the clamp is on the change, and it "
         "belongs on the sum: what was pushed too much must be taken back"),
        (solver(total=lambda c, add: c.lam + add),
         "no clamp: lam may not become negative, a contact never pulls"),
        (solver(missing=lambda c: c.v_n() - c.target),
         "the sign of what is missing: it is target - v_n"),
        (solver(missing=lambda c: -c.target - c.v_n()), "the sign of the target"),
        (solver(missing=lambda c: -c.v_n()), "the target is not used"),
        (solver(push=one_sided), "the other body is forgotten: push moves both"),
        (solver(push=same_way), "both bodies are pushed the same way"),
        (solver(most=1), "one sweep: the neighbours that it disturbs are never mended"),
        (solver(push=lambda c, change, lam: c.push(lam)),
         "the whole lam is pushed at each visit; push what it has changed by"),
        (solver(keep=False, total=lambda c, add: max(0.0, add)),
         "c.lam does not hold the sum of all corrections"),
        (solver(push=lambda c, change, lam: None), "lam is worked out and never pushed"),
        (solver(mass=lambda c: 1.0), "m_eff is missing: an impulse is a mass times a velocity"),
    ],
    "step_matrix": [
        (lambda m, k, c, dt: [[1.0, -dt], [dt * k / m, 1.0 - dt * c / m]],
         "the depth moves with the old velocity: that is explicit Euler"),
        (lambda m, k, c, dt: matrix(m, k, -c, dt), "the sign of the damper"),
        (lambda m, k, c, dt: matrix(m, -k, c, dt), "the sign of the spring: a depth pushes up"),
        (lambda m, k, c, dt: matrix(1.0, k, c, dt), "the mass is missing"),
        (lambda m, k, c, dt: matrix(m, k, 0.0, dt), "the damper is missing"),
        (lambda m, k, c, dt: list(zip(*matrix(m, k, c, dt))), "rows and columns are exchanged"),
        (lambda m, k, c, dt: [row[::-1] for row in matrix(m, k, c, dt)[::-1]],
         "the order is (v_n, depth), asked for is (depth, v_n)"),
        (lambda m, k, c, dt: [[1.0 + dt * dt * k / m, dt - dt * dt * c / m],
                              [dt * k / m, 1.0 - dt * c / m]],
         "v_n > 0 goes out of the table, so the depth becomes smaller"),
    ],
    "longest_step": [
        (lambda m, k, c: 2.0 * math.sqrt(m / k), "that is the limit without the damper"),
        (lambda m, k, c: (c + math.sqrt(c * c + 4.0 * k * m)) / k,
         "the damper's sign: it should bring the limit nearer"),
        (lambda m, k, c: 2.0 * m / c, "that is the limit without the spring"),
        (lambda m, k, c: math.sqrt(m / k), "that is where the ball would turn, and not the limit"),
    ],
    "implicit_spring": [
        (lambda x, k, c, dt: (1.0 / (k * dt * dt), x / dt), "the damper is missing"),
        (lambda x, k, c, dt: (1.0 / (k * dt + c), k * x / (k * dt + c)),
         "that softness is for a force; lam is an impulse, dt times as large"),
        (lambda x, k, c, dt: (k * dt * dt + c * dt, dt * k * x / (k * dt * dt + c * dt)),
         "the softness is upside down: a stiff spring is not soft"),
        (lambda x, k, c, dt: (1.0 / (k * dt * dt + c * dt), dt * k * x),
         "the target is an impulse still: the equation has to be divided as a whole"),
        (lambda x, k, c, dt: (1.0 / (k * dt * dt + c * dt), x / dt),
         "the target asks for the whole depth in one step, and the damper slows that"),
        (lambda x, k, c, dt: (1.0 / (k * dt * dt + c * dt), -dt * k * x / (k * dt * dt + c * dt)),
         "the sign of the target: an overlap should open"),
        (lambda x, k, c, dt: (dt * k * x / (k * dt * dt + c * dt), 1.0 / (k * dt * dt + c * dt)),
         "the order: softness first, then target"),
        (lambda x, k, c, dt: (0.0, x / dt), "no softness: that is a hard contact"),
    ],
}
