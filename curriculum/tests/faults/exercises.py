"""Faults for the exercises: (file, what stands there, what is planted, the tests that name it)."""

KIT, ANSWERS, T = "exercises/kit/", "exercises/kit/answers.json", "test_exercises.py -k "
JUDGE, SCRIPT, TRIALS = (f"{KIT}{name}.py" for name in ("judge", "script", "trials"))
FAULTS = [
    # what is judged
    (JUDGE, "allowed = within * np", "allowed = 1e7 * within * np", T + "each_slip"),
    (JUDGE, "len(made) > 3 and np", "False and np", T + "each_slip"),
    (JUDGE, 'if states[blank] == "wrong" and states.get', "if 0 and states.get", T + "step_mat"),
    (TRIALS, "trembling < 1e-5", "trembling < 1e-3", T + "'types and ex9'"),
    (TRIALS, "deepest < 1.001e-3", "deepest < 1e-2", T + "'types and ex9'"),
    (TRIALS, "deepest < 0.499e-3", "deepest < 0.0", T + "'types and ex9'"),
    (TRIALS, "contact.RADIUS).all()", "contact.RADIUS).any()", T + "'types and ex9'"),
    (TRIALS, "math.isclose(mine, true, rel_tol=within)", "mine > 0.0", T + "each_slip"),
    (TRIALS, "float(written) if sign else", "abs(float(written)) if sign else", T + "each_slip"),
    (TRIALS, '"r": contact.RADIUS', '"r": 0.1', T + "larger"),
    # what is shown
    (TRIALS, "critical_dt(1.0, k, c), contact", "critical_dt(2.0, k, c), contact", T + "beside"),
    (TRIALS, "contact.critical_dt(0.1, k, c)", "contact.critical_dt(0.2, k, c)", T + "ex9"),
    (TRIALS, "partial(two_solves, exercise", "partial(two_solves, contact", T + "two_solves"),
    (TRIALS, "hits.append(bet == mark)", "hits.append(bet != mark)", T + "'types and BETS'"),
    (TRIALS, 'replace("\\N{MINUS SIGN}", "-")', 'replace("~", "-")', T + "'types and BETS'"),
    (TRIALS, "for choice in (right, *", "for choice in (*sorted(choices), *", T + "PREDICTION"),
    (TRIALS, "if choice == right else", "if choice != right else", T + "PREDICTION"),
    (JUDGE, "return f\"{name}(stack({', '", "return f\"{name}(({', '", T + "each_slip"),
    # what is said of a bet
    (ANSWERS, '"4 kg at rest", "key": "rest_penetration_frac", "mass": 4.0',
     '"4 kg at rest", "key": "rest_penetration_frac", "mass": 3.0', T + "right_letters"),
    (ANSWERS, "({lcp_deepest:.3f} r, since", "(0.351 r, since", T + "nothing_away"),
    (ANSWERS, '"10 kg", "key": "energy_excess", "mass": 10.0', '"10 kg", "key": "energy_excess", '
     '"mass": 9.0', T + "no_command"),
    # what waits, and however it ends
    (SCRIPT, "^    return", "^  return", T + "larger"),
    (SCRIPT, "*lines[:1]", "*lines[:0]", T + "'types and pass'"),
    (SCRIPT, 'errors="backslashreplace"', 'errors="strict"', T + "larger"),
    (JUDGE, "len(steps) > MAX_STEPS", "len(steps) < 0", T + "longest"),
    (JUDGE, "os.O_WRONLY), 1)", "os.O_WRONLY), 9)", T + "'types and time_to'"),
    # what names a slip
    (JUDGE, "agree(got, max(found), 1e-4)", "False", T + "longest"),
    (JUDGE, "min(shares) > 0.45", "min(shares) > 1", T + "longest"),
    (JUDGE, "likely: {known}", "likely: {hint}", T + "each_slip"),
    (JUDGE, ', *prints[0])', ',)', T + "time_to"),
    ("checks.py", r"\g<0>_", r"\g<0>", T + "larger"),
]  # fmt: skip
