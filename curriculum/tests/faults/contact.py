"""Faults for contact.py: (file, what stands there, what is planted, the tests that name it)."""

MODELS, LINE = "test_models.py -k ", "test_command_line.py -k "
SLIDE, STEP = MODELS + "second_order", MODELS + "with_one_step"
OWN, BOUNDED = MODELS + "own_moment", MODELS + "bounded_number"
SEES = "test_stress.py -k no_claim"
C, REMARKS = "contact.py", "curriculum/show/remarks.py"
FAULTS = [
    # leapfrog: resting contacts are solved twice
    (C, "        update_contact(c, 0.0)  # the normal after the drift\n", "", SLIDE),
    (C, "        c.target = 0.0\n    solve_accelerated(active",
     "        c.target = c.lam = 0.0\n    solve_accelerated(active", MODELS + "throws_nobody"),
    (C, "    accelerate(balls, 0.5 * dt)\n    solve_accelerated(contacts",
     "    accelerate(balls, dt)\n    solve_accelerated(contacts", STEP),
    (C, "radii - max(0.0, c.depth - MAX_CORRECTION * radii)", "radii", MODELS + "throws_nobody"),
    (C, "update_contact(c, time_of_closest_approach(c, dt))", "pass", "test_stress.py"),
    (C, "or speed2 == 0.0:", "or speed2 < 0.0:", OWN),
    # each impact is resolved at its time of impact
    (C, "and not is_resting(c, dt)]):", "and False]):", STEP),
    (C, "[c for c in contacts if c.gap", "[0] + [c for c in contacts if c.gap", BOUNDED),
    (C, "or lower.supported > 0.0:", "or lower.supported >= 0.0:", OWN),
    (C, " c.load = 1e-6 if restitution > 0.0 else -GRAVITY", " c.load = 1e-6",
     "test_golden.py -k leapfrog"),
    (C, "if distance > 2.0 * listed:", "if distance > 200.0 * listed:", MODELS + "was_far"),
    ("curriculum/compiled/to_loops.py", "W.farthest[0] = 2.0 * distance", "W.farthest[0] = 0.0",
     MODELS + "was_far"),
    (C, "latest = dt if final else toi + WINDOW * dt", "latest = dt", OWN),
    (C, "earliest_impact(contacts, toi, dt)", "earliest_impact(contacts, 0.0, dt)", BOUNDED),
    (C, "sweeps_left *= 0.5", "sweeps_left *= 1.0", BOUNDED),
    (C, "c.lam += c.impact_lam", "c.lam += 0.0", MODELS + "changed_the_momenta"),
    # the sweeps
    (C, "        if agreement < 0.0:\n            t = 1.0\n", "", MODELS + "momentum"),
    (C, "c.start = max(0.0, c.lam + share * (c.lam - c.previous))",
     "c.start = c.lam + share * (c.lam - c.previous)", "test_golden.py -k leapfrog"),
    # the other models
    (C, "(rows[k].tobytes(), *cached)", "(rows[k].tobytes(),)", "test_compiled.py -k stand_still"),
    (C, "if bias > 0.0:  # an overlap", "if bias >= 0.0:  # an overlap", SEES),
    (C, "max(0.0, stiffness * depth - damping * v_n)", "abs(stiffness * depth - damping * v_n)",
     "test_golden.py -k penalty"),
    (C, "max(power, 1.0)", "power", MODELS + "mujoco_in"),
    (C, "if width <= 1e-15:", "if width <= -1.0:", MODELS + "mujoco_in"),
    (C, "SIMULTANEOUS = 1.0 + 1e-12", "SIMULTANEOUS = 1.0 + 1e-3",
     "test_exact.py -k over_one_another"),
    # skips and measures
    (C, "first + 1 + np.arange(steps - k) % (k", "first + np.arange(steps - k) % (k",
     MODELS + "skip_never"),
    (C, "near = np.flatnonzero(~safe)",
     "near = np.flatnonzero((gap < detection_distance_at(fastest, dt)) | (gap < CONTACT_MARGIN))",
     MODELS + "is_nowhere"),
    (C, "rounding = 1e-9 * (np.abs(run.v", "rounding = 1e-3 * (np.abs(run.v",
     MODELS + "first_contact"),
    (C, "float(scene.radius.min())\n    scale", "float(scene.radius[0])\n    scale",
     MODELS + "smallest_ball"),
    (C, "if dx.min() > widest + gap.max():", "if dx.min() > gap.max():", MODELS + "all_pairs"),
    (C, "way = np.diff(q, axis=0, append=q[-1:])", "way = 0.0 * q", MODELS + "pair_by_pair"),
    (C, "if (inside & (free[lag:] | free[:-lag])).any():", "if inside.any():",
     MODELS + "pair_by_pair"),
    (C, "EXPLODED = 10.0", "EXPLODED = 11.0", MODELS + "ten_times"),
    (C, ".max(initial=0.0) >= kick", ".max(initial=0.0) >= 3.0 * kick", MODELS + "at_rest_is"),
    (C, "    if mass == math.inf:\n        return math.inf\n", "", MODELS + "critical_dt_also"),
    # the command line
    (C, 'errors="backslashreplace"', 'errors="strict"', LINE + "whatever_is"),
    (C, "except KeyboardInterrupt:\n        print", "except EOFError:\n        print",
     LINE + "ipython"),
    (C, "        del os.environ[THREADS]\n", "        pass\n", LINE + "ipython"),
    (C, 'if row["through"]:\n        return f"through', 'if False:\n        return f"through',
     LINE + "reader_would_ask"),
    (C, "if touches and dt > limit:", "if touches and dt > 2.0 * limit:", LINE + "verdict_names"),
    (C, "np.maximum(vy, -vy - kick).clip(0.0)", "0.0 * vy", MODELS + "at_rest_is"),
    (REMARKS, "if name not in runs or find_fault", "if name not in runs and find_fault",
     LINE + "verdict_names"),
]  # fmt: skip
