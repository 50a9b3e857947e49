"""Faults for curriculum/exact.py: (file, what stands there, what is planted, the tests that name
it)."""

E, T = "curriculum/exact.py", "test_exact.py -k "
HEAP, PIVOT, BLOCKS = T + "another_integrator", T + "pivot", T + "digits_of_pi"
ANY = "test_exact.py"
FAULTS = [
    # its tolerances
    (E, "TOUCH = 1e-12", "TOUCH = 1e-8", ANY),
    (E, "LAST = 1e-13", "LAST = 1e-9", ANY),
    (E, "NOISE = 1e-12", "NOISE = 1e-8", ANY),
    (E, "NOISE = 1e-12", "NOISE = 1e-17", ANY),
    (E, "still | (self.gap[near] <= 1e-4 * opened)", "still | (self.gap[near] <= 1.0)", BLOCKS),
    (E, "np.minimum(4.0 * self.bits, 1e-9 * gap)", "4.0 * self.bits", ANY),
    (E, "min((1e-16 / size)", "min((1e-9 / size)", T + "'slides or pyramid'"),
    # the pivots
    (E, "closes = ~active & (", "closes = active & (", PIVOT),
    (E, "active[pulls[share == share.min()]]", "active[pulls[share == share.max()]]", PIVOT),
    # impacts and what rests
    (E, "target = -self.e * v_n\n", "target = -self.e * np.abs(v_n)\n", ANY),
    (E, "self.slip(touching, self.v) ** 2 / self.reach[touching]", "0.0 * self.reach[touching]",
     T + "'slides_off or pyramid'"),
    (E, "lam[0] = np.maximum(lam[0], 0.0) + NOISE",
     "lam[0] = np.maximum(lam[0], 0.0) + 1e9 * NOISE", T + "two_thirds"),
    (E, "for _ in range(50):  # move apart", "for _ in range(0):  # move apart",
     T + "overlap_at_the_start"),
    # flights
    (E, "4.0 * max(value, 0.0) * bend", "2.0 * max(value, 0.0) * bend", HEAP),
    (E, "min(span, 1e15) **", "min(0.5 * span, 1e15) **", ANY),
    (E, "np.vander(times, len(Q))", "np.vander(times * (1.0 + 1e-12), len(Q))", T + "parabolas"),
    # plain and compiled
    (E, "for each in these)))", "for each in these))).replace('0.5 * factor', '0.4 * factor')",
     T + "plain_and_compiled"),
]  # fmt: skip
