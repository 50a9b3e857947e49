"""Faults for the exercises: (file, what stands there, what is planted, the tests that name it)."""

TRIALS, KNOBS, BETS = (f"exercises/kit/{name}.py" for name in ("trials", "knobs", "predict"))
ANSWERS, T = "exercises/kit/answers.json", "test_exercises.py -k "
FAULTS = [
    # what is judged
    (TRIALS, "allowed = within * np", "allowed = 1e7 * within * np", T + "wrong_fill"),
    (TRIALS, ".squeeze())", ".ravel())", T + "step_matrix"),
    ("exercises/kit/blanks.py", "len(made) > 3 and np", "False and np", T + "wrong_fill"),
    (TRIALS, 'trembling < 1e-5', 'trembling < 1e-3', T + "gripper"),
    (TRIALS, 'deepest < 1.001e-3', 'deepest < 1e-2', T + "gripper"),
    (TRIALS, 'if not held:', "if False:", T + "gripper"),
    (TRIALS, 'if state == "wrong" and states[after] != "right":', "if False:", T + "blame"),
    (TRIALS, 'states[blank] = "wrong"', "pass", T + "stops_in_a_trial"),
    # what is shown
    (TRIALS, '("yours", "contact.py"), rows', '("contact.py", "yours"), rows', T + "beside"),
    (TRIALS, "for q in found), *rest]", "for q in found[::-1]), *rest]", T + "beside"),
    (TRIALS, "1e4, np.mean", "1e4, np.max", T + "beside"),
    (TRIALS, "2.0 / math.sqrt(k)\n", "4.0 / math.sqrt(k)\n", T + "beside"),
    (TRIALS, "contact.critical_dt(0.1, k, c)", "contact.critical_dt(0.2, k, c)",
     T + "gripper"),
    (KNOBS, "sum(true == guess", "sum(true != guess", T + "beside"),
    (KNOBS, 'replace("\\N{MINUS SIGN}", "-")', 'replace("~", "-")', T + "sag_is"),
    (KNOBS, "measure_sag(), rel_tol=0.02", "measure_sag(), rel_tol=0.2", T + "sag_is"),
    (BETS, "key=lambda choice: choice != right", "key=lambda choice: choice == right",
     T + "word_on_every"),
    (BETS, "if choice == right else", "if choice != right else", T + "word_on_every"),
    # what is said of a bet
    (ANSWERS, "lcp_long > 10", "lcp_long < 10", T + "word_on_every"),
    (ANSWERS, "penalty_long > 10 and lcp_long < 1", "lcp_long < 0", T + "those_measured"),
    (ANSWERS, "d^2 K depth", "d K depth", T + "those_measured"),
    (ANSWERS, "`k depth = m g`, {sink", "`k depth = m g / 2`, {sink", T + "those_measured"),
    (ANSWERS, "{penalty_deepest:.3f} r. Nor", "0.351 r. Nor", T + "those_measured"),
    (BETS, "dt = 0.03 s", "dt = 0.02 s", T + "captions"),
    # what waits, what is noted
    ("exercises/kit/progress.py", "if key != name or right}", "}", T + "wrong_broken"),
    ("exercises/kit/time_limit.py", "Timeout (", "Timed out", T + "without_end"),
    # what names a slip
    (TRIALS, "agree(got, max(found), 1e-4)", "False", T + "learner_types"),
    (TRIALS, "0.45 < got / right", "1 < got / right", T + "learner_types"),
    (TRIALS, "{known}", "{ask}", T + "learner_types"),
    (TRIALS, "own[-1:]", "own[:0]", T + "wrong_broken"),
    (TRIALS, 'if prints[0] else ""', 'if not prints[0] else ""', T + "way_through"),
    ("exercises/kit/blanks.py", "(bool(got[0])", "(got[0]", T + "right_fill"),
]  # fmt: skip
