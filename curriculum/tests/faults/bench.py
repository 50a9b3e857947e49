"""Faults for the benchmark: (file, what stands there, what is planted, the tests that name it)."""

ENGINES, ACCURACY, PROBLEMS, PILES, TIMING, REPORT = (
    f"curriculum/bench/{name}.py"
    for name in ("engines", "accuracy", "problems", "piles", "timing", "report")
)
T = "test_bench.py -k "
HAND, MEDIANS, BEST = T + "worked_out_by_hand", T + "has_medians", T + "may_compete"
FAULTS = [
    # engines
    (ENGINES, "        for _ in range(n):\n            steps()\n            rows.append(read())",
     "        for _ in range(n):\n            rows.append(read())\n            steps()",
     T + "falling_ball_lags"),
    (ENGINES, "point_stiffness=2.0 * stiffness", "point_stiffness=2e-3 * stiffness",
     T + "sinks_by"),
    (ENGINES, "session.substeps = substeps", "session.substeps = 1", T + "falling_ball_lags"),
    (ENGINES, "bounce = math.sqrt(scene.restitution)", "bounce = scene.restitution",
     T + "bounces_with"),
    (ENGINES, "density = 1.0 if fixed else mass / (math.pi", "density = 1.0 if fixed else 1.0 / (",
     T + "unequal_mass"),
    (ENGINES, "whole[:, self.moving] = part", "whole[:, : len(self.moving)] = part",
     T + "holds_the_fixed"),
    (ENGINES, 'self.options.get("inner", 4 if', 'self.options.get("inner", 1 if',
     T + "same_substeps"),
    # the contest
    (ACCURACY, 'float(f"{about[\'error\']:.3g}")', "about['error']", BEST),
    (ACCURACY, "found[key] = None if itself else statistics.median(",
     "found[key] = None if itself else max(", MEDIANS),
    (ACCURACY, 'p["work"] <= work', 'p["work"] <= 64 * work', BEST),
    (ACCURACY, 'or p["diverged"]:', "or False:", BEST),
    (ACCURACY, 'budget * p["balls"] * looks', "budget * looks * 99", BEST),
    (ACCURACY, "return session.substeps * c.inner", "return c.inner", T + "what_one_works_out"),
    (ACCURACY, "get_num_steps_taken() / looks", "get_num_steps_taken()", T + "chooses_them"),
    (ACCURACY, '{"user_error": user["error"]}', '{"user_error": quality["awake"]["error"]}',
     T + "may_sleep"),
    # problems
    (PROBLEMS, "error=float(distance.max())", "error=float(distance.mean())", HAND),
    (PROBLEMS, ").max(axis=1) / R", ").min(axis=1) / R", "test_bench.py"),
    (PROBLEMS, "leaving = g * t1 * e ** (k + 1)", "leaving = g * t1 * e**k", T + "closed_forms"),
    # piles and times
    (PILES, "return all(speed < AT_REST", "return any(speed < AT_REST", T + "no_ball_is_faster"),
    (PILES, "return min(found, key", "return max(found, key", T + "what_rests"),
    (PILES, "worst_depth=float(found.max(", "worst_depth=float(found.mean(", T + "depths_are"),
    (TIMING, "return time.process_time() - start, result", "return time.process_time(), result",
     T + "time_is_that"),
]  # fmt: skip
