"""Faults for contact.py: (file, what stands there, what is planted, the tests that name it)."""

MODELS, LINE = "test_models.py -k ", "test_command_line.py -k "
SLIDE, BOUNCES = MODELS + "second_order", MODELS + "any_angle"
C = "contact.py"
FAULTS = [
    # leapfrog's rules
    (C, "        c.target = c.after\n", "        c.target = c.after\n        c.lam = 0.0\n",
     MODELS + "throws_nobody"),
    (C, "            turn(c, 0.0)  # to", "            pass  # to", SLIDE),
    (C, "    accelerate(balls, 0.5 * dt)\n    solve_with",
     "    accelerate(balls, dt)\n    solve_with", MODELS + "with_one_step"),
    (C, "        c.target = max(c.target, (end - max(gap, 0.0)) / dt)\n", "", BOUNCES),
    (C, "    turn(c, dt)\n", "", MODELS + "pass_one_another"),
    (C, "        if onward < 0.0:\n            t = 1.0\n", "", MODELS + "momentum"),
    (C, "hit < dt * GRAVITY", "hit < 0.0", SLIDE),
    (C, "min(-gap, OPENS * (c.a.radius + c.b.radius))", "-gap", MODELS + "throws_nobody"),
    (C, "left = dt - when", "left = 0.9 * (dt - when)", BOUNCES),
    (C, "c.start = max(0.0, c.lam + share * (c.lam - c.before))",
     "c.start = c.lam + share * (c.lam - c.before)", "test_golden.py -k leapfrog"),
    (C, "bounces = [c for c in closed if c.hits and restitution > 0.0]", "bounces = []",
     MODELS + "keeps_its_normals"),
    (C, "if fast > 0.0 else dt  # 0", "if fast >= 0.0 else dt  # 0", MODELS + "too_slow_for"),
    (C, "if a_n is None or not (v_n < 0.0 or a_n < 0.0):",
     "if a_n is None or v_n >= 0.0 and a_n >= 0.0:", MODELS + "no_number_stops"),
    # the other models
    (C, "if bias > 0.0:  # an overlap", "if bias >= 0.0:  # an overlap", MODELS + "on_the_table"),
    (C, "max(0.0, stiffness * depth - damping * v_n)", "abs(stiffness * depth - damping * v_n)",
     "test_golden.py -k penalty"),
    (C, "max(power, 1.0))", "power)", MODELS + "mujocos_bounds"),
    (C, "if width <= 1e-15:", "if width <= -1.0:", MODELS + "impedance"),
    (C, "MOST_SWEEPS = 10_000", "MOST_SWEEPS = 1_000", MODELS + "unequal_columns"),
    (C, "TOGETHER = 1.0 + 1e-12", "TOGETHER = 1.0 + 1e-3", "test_exact.py"),
    # skips and measures
    (C, "first + 1 + np.arange(steps - k) % (k", "first + np.arange(steps - k) % (k",
     MODELS + "cycle"),
    (C, "near = np.flatnonzero(~(gap >= reach))", "near = np.flatnonzero(gap < reach)",
     MODELS + "is_nowhere"),
    (C, "rounding = 1e-9 * (np.abs(run.v", "rounding = 1e-3 * (np.abs(run.v",
     MODELS + "first_contact"),
    (C, "RESTLESS = 1e-6", "RESTLESS = 1e-2", MODELS + "trembles"),
    (C, "turns > len(late) / 8", "turns > len(late) / 800", MODELS + "swing_of_many"),
    (C, "gap = gap / float(scene.radius[0])", "gap = gap / float(scene.radius.max())",
     MODELS + "first_ball"),
    (C, "EXPLODED = 10.0", "EXPLODED = 11.0", MODELS + "ten_times"),
    (C, "falling = np.abs(last[1] - first[1]).max(initial=0.0) >= -0.5",
     "falling = False and -0.5 <", MODELS + "top_of_its_flight"),
    (C, "    if mass == math.inf:\n        return math.inf\n", "", MODELS + "critical_dt_also"),
    # the command line
    (C, 'if re.fullmatch("--[a-z]+=--", word)', 'if re.fullmatch("--[a-z]+=---", word)',
     LINE + "bad_input"),
    (C, "if unknown[0] in SCENES", "if unknown[0] in MODELS", LINE + "contradict"),
    (C, 'errors="backslashreplace"', 'errors="strict"', LINE + "cannot_encode"),
    (C, 'os.write(2, b"stopped\\n")', 'os.write(1, b"stopped\\n")', LINE + "modules_load"),
    (C, 'text = f"through {row[\'through\']}" if row["through"] else text', "text = text",
     LINE + "reader_would_ask"),
    (C, 'sorted(depth, key=depth.get, reverse=True)', "sorted(depth, key=depth.get)",
     LINE + "reader_would_ask"),
]  # fmt: skip
