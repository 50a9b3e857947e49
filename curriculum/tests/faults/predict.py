"""Mutants of curriculum/predict.py: (file, what stands there, what is planted, the tests that must
name it)."""

PREDICT, T = "curriculum/predict.py", "test_predict.py -k "
FAULTS = [
    (PREDICT, "return count * mass * G", "return mass * G", T + "penalty_sinks"),
    (PREDICT, "(1.0 - 2.0 * zeta * left)", "0.0", T + "penalty_sinks"),
    (PREDICT, "- (1.0 - 0.5 * baumgarte)", "- (1.0 - baumgarte)", T + "lcp_dives"),
    (PREDICT, "return (1.0 - warm) *", "return", T + "lcp_dives"),
    (PREDICT, "/ (3.0 - d0)", "/ 3.0", T + "soft_flickers"),
    ("contact.py", "4.0 * math.cos(math.pi / (2 * count + 1)) ** 2", "4.0", T + "penalty_sinks"),
]  # fmt: skip
