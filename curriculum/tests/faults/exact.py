"""Faults for curriculum/exact.py: (file, what stands there, what is planted, the tests that name
it)."""

E, T = "curriculum/exact.py", "test_exact.py -k "
HEAP, PIVOT, BLOCKS = T + "another_integrator", T + "pivot", T + "digits_of_pi"
ANY = "test_exact.py"
FAULTS = [
    # its tolerances
    (E, "TOUCH_TOLERANCE = 1e-12", "TOUCH_TOLERANCE = 1e-8", ANY),
    (E, "MIN_BOUNCE = 1e-13", "MIN_BOUNCE = 1e-6", ANY),
    (E, "ROUNDING = 1e-12", "ROUNDING = 1e-8", ANY),
    (E, "(self.gap[near] <= 1e-4 * opened)", "(self.gap[near] <= 1.0)", BLOCKS),
    (E, "np.minimum(4.0 * self.bits, 1e-9 * gap)", "4.0 * self.bits", ANY),
    # the pivots
    (E, "x / np.maximum(-column, 1e-300)", "-x / np.maximum(-column, 1e-300)", PIVOT),
    (E, "left, -inverse @ rows", "left, inverse @ rows", PIVOT),
    # impacts and what rests
    (E, "target = -self.e * v_n\n", "target = -self.e * np.abs(v_n)\n", ANY),
    (E, "self.slip(touching, J, self.v) ** 2 / self.touch_distance[touching]",
     "0.0 * self.found[touching]",
     T + "slides"),
    (E, "lam[0] = np.maximum(lam[0], 0.0) + ROUNDING",
     "lam[0] = np.maximum(lam[0], 0.0) + 1e9 * ROUNDING", T + "two_thirds"),
    (E, "for _ in range(50):\n            if not (self.found",
     "for _ in range(0):\n            if not (self.found", T + "overlap_at_the_start"),
    (E, "force - solve @ (J @ a + turn + W @ force)", "force", T + "pyramid"),
    # flights
    (E, "slope, 2.0 * bend)", "slope, bend)", HEAP),
    (E, "np.vander(times[done:last] - now", "np.vander((1.0 + 1e-12) * (times[done:last] - now)",
     T + "parabolas"),
    (E, "turn = 0.5 * factor", "turn = 0.4 * factor", T + "slides"),
]  # fmt: skip
