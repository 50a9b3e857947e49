"""Faults for the exercises: (file, what stands there, what is planted, the tests that name it)."""

JUDGE, BETS, SLIPS, SCRIPT = (f"exercises/kit/{n}.py" for n in ("judge", "bets", "slips", "script"))
ANSWERS, T = "exercises/kit/answers.json", "test_exercises.py -k "
FAULTS = [
    # what is judged
    (JUDGE, "allowed = within * np", "allowed = 1e7 * within * np", T + "wrong_fill"),
    (JUDGE, ".squeeze())", ".ravel())", T + "step_matrix"),
    (SLIPS, "len(made) > 3 and np", "False and np", T + "wrong_fill"),
    (SLIPS, "(bool(got[0])", "(got[0]", T + "right_fill"),
    (JUDGE, "trembling < 1e-5", "trembling < 1e-3", T + "gripper"),
    (JUDGE, "deepest < 1.001e-3", "deepest < 1e-2", T + "gripper"),
    (JUDGE, "if not held:", "if False:", T + "gripper"),
    (JUDGE, 'if state == "wrong" and states[after] != "right":', "if False:", T + "blame"),
    (JUDGE, 'states[blank] = "wrong"', "pass", T + "stops_in_a_trial"),
    (JUDGE, "math.isclose(mine, true, rel_tol=within)", "mine > 0.0", T + "paper_gives"),
    # what is shown
    (JUDGE, '("yours", "contact.py"), rows', '("contact.py", "yours"), rows', T + "beside"),
    (JUDGE, "for q in found), *rest]", "for q in found[::-1]), *rest]", T + "beside"),
    (JUDGE, "vy=2.0), np.mean", "vy=2.0), np.max", T + "beside"),
    (JUDGE, "2.0 / math.sqrt(k)\n", "4.0 / math.sqrt(k)\n", T + "beside"),
    (JUDGE, "contact.critical_dt(0.1, k, c)", "contact.critical_dt(0.2, k, c)", T + "gripper"),
    (BETS, "sum(true == guess", "sum(true != guess", T + "beside"),
    (BETS, 'replace("\\N{MINUS SIGN}", "-")', 'replace("~", "-")', T + "beside"),
    (BETS, "key=lambda choice: choice != right", "key=lambda choice: choice == right",
     T + "word_on_every"),
    (BETS, "if choice == right else", "if choice != right else", T + "word_on_every"),
    # what is said of a bet
    (ANSWERS, "penalty_heavy < 1 and lcp_light < 1", "lcp_light > 1", T + "those_measured"),
    (ANSWERS, "`k depth = m g`, here", "`k depth = m g / 2`, here", T + "those_measured"),
    (ANSWERS, "{penalty_deepest:.3f} r. lcp", "0.351 r. lcp", T + "those_measured"),
    (BETS, '"heavy": ("10 kg", "energy_excess", 10.0', '"heavy": ("10 kg", "energy_excess", 9.0',
     T + "no_command"),
    # what waits, what is noted, however it ends
    (SCRIPT, "if key != name or right}", "}", T + "wrong_or_broken"),
    (SCRIPT, "if isinstance(noted, dict)", "if True", T + "lists_nothing"),
    (SCRIPT, "Timeout (\" in", "Timed out\" in", T + "however"),
    (JUDGE, "resource.setrlimit", "resource.getrlimit and len", T + "however"),
    (JUDGE, "leave(0)  #", "pass  #", T + "however"),
    # what names a slip
    (JUDGE, "agree(got, max(found), 1e-4)", "False", T + "learner_types"),
    (JUDGE, "0.45 < got / right", "1 < got / right", T + "learner_types"),
    (SCRIPT, 'what == "longest_step"', "False", T + "however"),
    (JUDGE, "{known}", "{ask}", T + "wrong_fill"),
    (JUDGE, "own_lines(error)[-1:]", "own_lines(error)[:0]", T + "wrong_or_broken"),
    (JUDGE, 'if prints[0] else ""', 'if not prints[0] else ""', T + "however"),
]  # fmt: skip
