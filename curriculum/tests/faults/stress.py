"""Faults for curriculum/stress/: what its properties must see, a row each, and judges that see too
little: (file, what stands there, what is planted, the tests that name it)."""

C, E, PROPERTIES = "contact.py", "curriculum/exact.py", "curriculum/stress/properties.py"
JOBS = "curriculum/stress/jobs.py"
SEES, TIGHT = "test_stress.py -k no_claim", "test_stress.py -k as_tight"
FAULTS = [
    # NaN is no explosion
    (C, "~(total - total[0] < EXP", "(total - total[0] >= EXP", "test_models.py -k explodes"),
    (C, "q[1:] = dt * fine[1::", "q[1:] = dt * fine[:-1:", SEES),
    (C, "clear_forces(balls)  # but", "pass  # but", SEES),
    (C, "stiffness * depth - damping", "stiffness * depth - 1.000000001 * damping", SEES),
    (C, "b.vx -= impulse * (b.inv", "b.vx -= (1.0 - 1e-11) * impulse * (b.inv", SEES),
    (C, "c.lam = lam\n", "c.lam = (1.0 - 1e-11) * lam\n", SEES),
    (E, "self.sides, self.curves = a - b", "self.sides, self.curves = (1 + 1e-7) * a - b", SEES),
    (C, "bias = baumgarte / dt", "bias = (1.0 if c.b is FLOOR else 0.5) * baumgarte / dt", SEES),
    (C, "bounce = -restitution", "bounce = 1e-9 - restitution", SEES),
    (C, "timeconst, dampratio = solref\n        K",
     "timeconst, dampratio = 1.1 * solref[0], solref[1]\n        K",
     "test_models.py -k mujoco_in"),
    (E, "target = -self.e * v_n", "target = (1e-8 - self.e) * v_n", SEES),
    (E, "self.q - self.found[held])", "self.q - self.found[held] - 1e-12)", SEES),
    (C, "move(balls, -toi)", "move(balls, -0.9 * toi)", SEES),
    (C, "-restitution * c.gap_rate if", "1e-8 - restitution * c.gap_rate if", SEES),
    (C, "-restitution * c.gap_rate if", "-1e-8 - restitution * c.gap_rate if", SEES),
    # impacts of one moment are told apart by their last bits
    (C, "latest = dt if final else toi + WINDOW * dt", "latest = dt if final else toi", SEES),
    (C, "4.0 * mass / (root + damping)", "1.01 * 4.0 * mass / (root + damping)",
     "test_models.py -k eigenvalue"),
    # judges
    (PROPERTIES, "PROMISE = 1e-12", "PROMISE = 1e-8", TIGHT),
    (PROPERTIES, "~((a == b) | (a != a) & (b != b))", "abs(a - b) > 1e-9",
     "test_stress.py -k last_bit"),
    ("curriculum/stress/trial.py", "U = 2.0**-53", "U = 2.0**-33", TIGHT),
    (PROPERTIES, "rounding = 1e-13 *", "rounding = 1e-3 *", TIGHT),
    (PROPERTIES, "grows = np.abs(lam", "grows = 1.0 + np.abs(lam", TIGHT),
    (JOBS, 'if not row["judged"]', 'if row["judged"] is None', "test_stress.py -k judges_nothing"),
    (JOBS, '+= count > 0', '+= 1', "test_stress.py -k judges_nothing"),
]  # fmt: skip
