"""Faults for curriculum/exact.py: (file, what stands there, what is planted, the tests that name
it)."""

E, T = "curriculum/exact.py", "test_exact.py -k "
HEAP, PILE, PIVOT = T + "heap_that_falls", T + "neither_overlaps", T + "pivot"
FAULTS = [
    # its tolerances
    (E, "TOUCH = 1e-12", "TOUCH = 1e-8", "test_exact.py"),
    (E, "LAST = 1e-13", "LAST = 1e-9", "test_exact.py"),
    (E, "NOISE = 1e-12", "NOISE = 1e-8", "test_exact.py"),
    (E, "NOISE = 1e-12", "NOISE = 1e-17", "test_exact.py"),
    (E, "np.minimum(self.small, 1e-4 * opened)", "self.small", T + "cycle or rattle"),
    (E, "np.minimum(4.0 * self.bits, 1e-9 * gap)", "4.0 * self.bits", T + "hair or cycle"),
    (E, "min((1e-16 / size)", "min((1e-9 / size)", T + "slides or pyramid"),
    (E, "step <= 1e-15 * t", "step <= 1e-9 * t", "test_exact.py"),
    # the pivots
    (E, "active[s.argmin()] = True", "active[s.argmax()] = True", PIVOT),
    (E, "lam + share.min() * way", "lam + way", PIVOT),
    (E, "way = trial if endless else trial - lam", "way = trial", PIVOT),
    # impacts
    (E, "target = -self.e * v_n\n", "target = -self.e * np.abs(v_n)\n", "test_exact.py"),
    (E, "resting.across(self.v) ** 2 / resting.reach", "0.0 * resting.reach",
     T + "slides_off or pyramid"),
    (E, "lam[0] = np.maximum(lam[0], 0.0) + NOISE", "lam[0] = lam[0] + 1e6 * NOISE",
     T + "two_thirds"),
    (E, "self.gap[near[first : first + 1]] = 0.0", "pass", "test_exact.py"),
    (E, "for _ in range(50):  # what a push", "for _ in range(0):  # what a push",
     "test_exact.py"),
    # flights
    (E, "end = np.minimum(np.maximum(2.0 * t, horizon / 16.0), horizon)", "end = 0.5 * horizon + t",
     HEAP),
    (E, "if state == self.saved and any(", "if state == self.saved or any(", T + "cycle"),
    (E, "times % starts[-1]", "times % (starts[-1] * (1.0 + 1e-9))", T + "cycle"),
    (E, "np.maximum(self.gap[near], 0.0)", "self.gap[near]", "test_exact.py"),
]  # fmt: skip
