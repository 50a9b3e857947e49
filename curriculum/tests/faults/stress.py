"""Faults for curriculum/stress/: what its properties must see, a row each, and judges that see too
little: (file, what stands there, what is planted, the tests that name it)."""

C, E, PROPERTIES = "contact.py", "curriculum/exact.py", "curriculum/stress/properties.py"
LAWS, JOBS = "curriculum/stress/laws.py", "curriculum/stress/jobs.py"
SEES, TIGHT = "test_stress.py -k no_claim", "test_stress.py -k as_tight"
FAULTS = [
    # NaN is no explosion
    (C, "~(total - total[0] < EXP", "(total - total[0] >= EXP", SEES),
    # a flight moves with the old velocity
    (C, "q[1:] = dt * fine[1::", "q[1:] = dt * fine[:-1:", SEES),
    # a distance depends on the sign of x
    (C, "dx = a.x - b.x\n", "dx = a.x - b.x + 1e-15\n", SEES),
    # forces are kept
    (C, "ball.fx = ball.fy = 0.0  # the", "pass  # the", SEES),
    # a target depends on how many contacts there are
    (
        C,
        "c.target = contact_target(c",
        "c.target = (1 + 1e-15 * len(contacts)) * contact_target(c",
        SEES,
    ),
    # the first ball of a contact of exact.py feels 1e-7 more
    (E, "1.0 * (pairs[0] == balls)", "(1.0 + 1e-7) * (pairs[0] == balls)", SEES),
    # the reaction is short by 1e-11
    (C, "b.vx -= impulse * (b.inv", "b.vx -= (1.0 - 1e-11) * impulse * (b.inv", SEES),
    # the reaction of exact.py is short by 1e-9
    (
        E,
        "return (self.n * lam) @ self.sign.T",
        "return (self.n * lam) @ (self.sign + 1e-9).T",
        SEES,
    ),
    # the Baumgarte gain of pairs is halved
    (C, "bias = baumgarte / dt", "bias = (1.0 if c.b is FLOOR else 0.5) * baumgarte / dt", SEES),
    # lcp bounces with 1.01 e
    (C, "bounce = -restitution", "bounce = -1.01 * restitution", SEES),
    # lcp bounces with e less 1e-9
    (C, "bounce = -restitution", "bounce = 1e-9 - restitution", SEES),
    # the time constant of soft is 10 % longer for pairs
    (
        C,
        "        timeconst, dampratio = solref\n        K",
        "        timeconst, dampratio = 1.1 * solref[0], solref[1]\n        K",
        SEES,
    ),
    # exact bounces with e less 1e-8 at the start
    (E, "target = -self.e * v_n", "target = (1e-8 - self.e) * v_n", SEES),
    # exact.py leaves 1e-12 m of an overlap
    (
        E,
        "resting.along(self.q) - self.found[touching])",
        "resting.along(self.q) - self.found[touching] - 1e-12)",
        SEES,
    ),
    # leapfrog forgets what it gave on the way
    (C, "c.target = c.after\n", "c.target = c.after\n        c.lam = 0.0\n", SEES),
    # a bounce of leapfrog begins at the end of its step
    (C, "c.target = max(c.target, (end - max(gap, 0.0)) / dt)", "pass", SEES),
    # leapfrog ends a step along the normal of its start
    (C, "turn(c, 0.0)  # normal", "pass  # normal", SEES),
    # a bounce on the table keeps the speed that gravity adds
    (
        C,
        "c.after = min(-restitution * hit + left * a_n, back)",
        "c.after = min(-restitution * hit, back)",
        SEES,
    ),
    # the critical step is 1 % too long
    (
        C,
        "4.0 * mass / (root + damping)",
        "1.01 * 4.0 * mass / (root + damping)",
        "test_models.py -k eigenvalue",
    ),
    # judges
    (PROPERTIES, "PROMISE = 1e-12", "PROMISE = 1e-8", TIGHT),
    (
        PROPERTIES,
        "~((a == b) | (a != a) & (b != b))",
        "abs(a - b) > 1e-9",
        "test_stress.py -k last_bit",
    ),
    (PROPERTIES, "allowed = 8 * U * (sweeps", "allowed = 8e6 * U * (sweeps", TIGHT),
    (PROPERTIES, "4 * U * speed, free", "4e4 * U * speed, free", TIGHT),
    (PROPERTIES, "off, moved + 1e-11 * top", "off, np.inf", TIGHT),
    (LAWS, "return force, 8 * U", "return force, 8e6 * U", TIGHT),
    (JOBS, "if not count]", "if count is None]", "test_stress.py -k judges_nothing"),
    (JOBS, "total[0] + (count > 0)", "total[0] + 1", "test_stress.py -k counts_add_up"),
]
