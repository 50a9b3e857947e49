"""Faults for curriculum/stress/, judges that are off and bounds that are too wide: (file, what
stands there, what is planted, the tests that must name it).

What a judge must see in contact.py and exact.py is planted by test_stress.py itself, many in a
process: each row here asks it for one of these.
"""

PROPERTIES, LAWS = "curriculum/stress/properties.py", "curriculum/stress/laws.py"
MAPS, MATCH, HEAPS = (f"curriculum/stress/{name}.py" for name in ("maps", "mujoco_match", "heaps"))
JOBS, EXTREMES = "curriculum/stress/jobs.py", "curriculum/stress/extremes.py"


def sees(fault):
    """The test that a fault of contact.py or exact.py is seen."""
    return f"test_stress.py -k '{' and '.join(fault.split())} and names'"


FAULTS = [
    (PROPERTIES, "PROMISE = 1e-12", "PROMISE = 1e-8", sees("leaves 1e-12 m")),
    (PROPERTIES, "NEAR = 1e-9", "NEAR = 1e-6", sees("e less 1e-8 at")),
    (PROPERTIES, "LOOSE = 1e-5", "LOOSE = 1e-3", sees("slide falls 1e-4")),
    (PROPERTIES, "~((a == b) | (a != a) & (b != b))", "abs(a - b) > 1e-9",
     sees("target depends many contacts")),
    (PROPERTIES, "allowed = 8 * U * (sweeps", "allowed = 8e6 * U * (sweeps",
     sees("short 1e-11")),
    (PROPERTIES, "4 * U * speed, free", "4e4 * U * speed, free", sees("gravity 1e-14")),
    (PROPERTIES, "4 * U * size, moves", "4e6 * U * size, moves", sees("balls move 1e-12")),
    (PROPERTIES, "np.maximum(-lam, 0.0), (sweeps", "np.maximum(-lam, 0.0), 1e9 * (sweeps",
     sees("pulls a little")),
    (PROPERTIES, "off, moved + 1e-11 * top", "off, np.inf", sees("never taken back")),
    (PROPERTIES, '("lcp", 8 * U', '("lcp", 8e9 * U', sees("e less 1e-9 lcp")),
    (PROPERTIES, '("soft", 2.1e-4)', '("soft", 2.1e-2)', sees("e less 2e-3")),
    (PROPERTIES, "np.maximum(np.diff(total), 0.0)", "0.0 * np.diff(total)",
     sees("exact falls 1e-7")),
    (LAWS, "return force, 8 * U", "return force, 8e6 * U", sees("damping 1e-10")),
    (MAPS, "LATE = 0.004", "LATE = 0.04", sees("critical step 1 long")),
    (MAPS, "6 * U * len", "6e14 * U * len", sees("looks twice")),
    (MAPS, "1e-6 * (1 - d) * G\n", "1e-4 * (1 - d) * G\n", sees("spring 1e-5 weaker")),
    (MATCH, "- q[k + 1]), 1e-14", "- q[k + 1]), 1e-8", sees("softer 1e-9")),
    (MATCH, "- v[k + 1]), 1e-12", "- v[k + 1]), 1e-9", sees("ends 1e-11")),
    (MATCH, "run.q - q), 1e-11", "run.q - q), 1e-5", sees("steps of run 1e-9 longer")),
    (HEAPS, "EIGHTH = 8.0**-1.8", "EIGHTH = 8.0**-0.8", sees("normal of its start")),
    (JOBS, "if not count]", "if count is None]", "test_stress.py -k judges_nothing"),
    (JOBS, "total[0] + (count > 0)", "total[0] + 1", "test_stress.py -k counts_add_up"),
    (EXTREMES, 'or quality["through"] or unknown', "or unknown",
     "test_stress.py -k a_wrong_word"),
]  # fmt: skip
