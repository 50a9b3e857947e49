"""Faults for the exercises: (file, what stands there, what is planted, the tests that name it)."""

KIT, ANSWERS, T = "exercises/kit/", "exercises/kit/answers.json", "test_exercises.py -k "
JUDGE, BETS, SCRIPT, TRIALS = (f"{KIT}{name}.py" for name in ("judge", "bets", "script", "trials"))
FAULTS = [
    # what is judged
    (JUDGE, "allowed = within * np", "allowed = 1e7 * within * np", T + "each_slip"),
    (JUDGE, "len(made) > 3 and np", "False and np", T + "each_slip"),
    (JUDGE, 'if states[blank] == "wrong" and states.get', "if 0 and states.get", T + "step_mat"),
    (TRIALS, "trembling < 1e-5", "trembling < 1e-3", T + "'types and ex8'"),
    (TRIALS, "deepest < 1.001e-3", "deepest < 1e-2", T + "'types and ex8'"),
    (TRIALS, "< 0.3).all()", "< 0.3).any()", T + "'types and ex8'"),
    (BETS, "math.isclose(mine, true, rel_tol=within)", "mine > 0.0", T + "each_slip"),
    # what is shown
    (TRIALS, "contact.critical_dt(1.0, k, c)", "contact.critical_dt(2.0, k, c)", T + "beside"),
    (TRIALS, "contact.critical_dt(0.1, k, c)", "contact.critical_dt(0.2, k, c)", T + "ex8"),
    (TRIALS, "partial(asking_twice, exercise", "partial(asking_twice, contact", T + "asking"),
    (BETS, "map(str.__eq__,", "map(str.__ne__,", T + "'types and BETS'"),
    (BETS, 'replace("\\N{MINUS SIGN}", "-")', 'replace("~", "-")', T + "'types and BETS'"),
    (BETS, "for choice in (right, *", "for choice in (*sorted(choices), *", T + "PREDICTION"),
    (BETS, "if choice == right else", "if choice != right else", T + "PREDICTION"),
    # what is said of a bet
    (ANSWERS, '"at rest", "key": "rest_penetration_frac", "mass": 4.0',
     '"at rest", "key": "rest_penetration_frac", "mass": 3.0', T + "right_letters"),
    (ANSWERS, "`k depth = m g`, here", "`k depth = m g / 2`, here", T + "those_measured"),
    (ANSWERS, "{penalty_deepest:.3f} r. lcp", "0.351 r. lcp", T + "those_measured"),
    (ANSWERS, '"10 kg", "key": "energy_excess", "mass": 10.0', '"10 kg", "key": "energy_excess", '
     '"mass": 9.0', T + "no_command"),
    # what waits, and however it ends
    (SCRIPT, "^    return", "^  return", T + "all_ten"),
    (SCRIPT, '"Timeout" in begun', '"Timed" in begun', T + "'types and pass'"),
    (SCRIPT, "[*lines(stack), *reversed(lines(begun)), 1]", "[1]", T + "'types and abort'"),
    (JUDGE, "next(events) > MOST_EVENTS", "next(events) < 0", T + "longest"),
    (JUDGE, "resource.setrlimit", "resource.getrlimit and len", T + "'types and append'"),
    (JUDGE, "os._exit(0)  #", "pass  #", T + "'types and time_to'"),
    # what names a slip
    (JUDGE, "agree(got, max(found), 1e-4)", "False", T + "longest"),
    (JUDGE, "min(shares) > 0.45", "min(shares) > 1", T + "longest"),
    (JUDGE, 'if name == "longest_step" and', "if False and", T + "longest"),
    (JUDGE, "likely: {known}", "likely: {hint}", T + "each_slip"),
    (JUDGE, ', *prints[0])', ',)', T + "time_to"),
]  # fmt: skip
