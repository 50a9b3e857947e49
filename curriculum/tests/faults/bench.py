"""Faults for the benchmark: (file, what stands there, what is planted, the tests that name it)."""

ENGINES, SETTINGS, ACCURACY, PROBLEMS, PILES, TIMING, SKIPS, REPORT = (
    f"curriculum/bench/{name}.py"
    for name in "engines settings accuracy problems piles timing skips report".split()
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
    (ENGINES, "return self.whole(n)[:, 1 : 3 *", "return self.whole(n)[:, 2 : 3 *",
     T + "falling_ball_lags"),
    (ENGINES, "sleeping_enabled = False", "sleeping_enabled = True", T + "rest_on_the_floor"),
    (ENGINES, "bounce = math.sqrt(scene.restitution)", "bounce = scene.restitution",
     T + "bounces_with"),
    (ENGINES, "density = 1.0 if fixed else mass / (math.pi", "density = 1.0 if fixed else 1.0 / (",
     T + "unequal_mass"),
    (ENGINES, "whole[:, self.moving] = part", "whole[:, : len(self.moving)] = part",
     T + "holds_the_fixed"),
    (ENGINES, "skip=False", "skip=True", T + "no_step_is_skipped"),
    # settings
    (SETTINGS, "session.substeps = substeps", "session.substeps = 1", T + "falling_ball_lags"),
    (SETTINGS, 'get("inner", 1)', 'get("outer", 1)', T + "falling_ball_lags"),
    (SETTINGS, "dt / self.inner / 2]", "dt / self.inner]", T + "falling_ball_lags"),
    # the contest
    (ACCURACY, 'float(f"{p[\'error\']:.3g}")', "p['error']", BEST),
    (ACCURACY, "* (2 if c.engine ==", "* (1 if c.engine ==", T + "count_twice"),
    (ACCURACY, "statistics.median(found[1:])", "statistics.median(found)", T + "after_a_short_one"),
    (ACCURACY, "found[key] = None if itself else statistics.median(",
     "found[key] = None if itself else max(", MEDIANS),
    (ACCURACY, 'p["work"] <= work', 'p["work"] <= 64 * work', BEST),
    (ACCURACY, ' or p["diverged"]:', ":", BEST),
    (ACCURACY, 'budget * p["balls"] * looks', "budget * looks * 99", BEST),
    (ACCURACY, "return session.substeps * c.inner", "return c.inner", T + "what_one_works_out"),
    (ACCURACY, "get_num_steps_taken() / looks", "get_num_steps_taken()", T + "chooses_them"),
    # problems
    (PROBLEMS, "error=float(distance.max())", "error=float(distance.mean())", HAND),
    (PROBLEMS, ").max(axis=1) / R", ").min(axis=1) / R", "test_bench.py"),
    (PROBLEMS, "leaving = g * t1 * e ** (k + 1)", "leaving = g * t1 * e**k", T + "closed_forms"),
    # piles and times
    (PILES, "return all(speed < AT_REST", "return any(speed < AT_REST", T + "no_ball_is_faster"),
    (ACCURACY, "min(rivals.get(", "max(rivals.get(", T + "what_rests"),
    (PILES, 'r["mean_depth"] <= depth', "True", T + "what_rests"),
    (PILES, "worst_depth=float(found.max(", "worst_depth=float(found.mean(", T + "depths_are"),
    (REPORT, "> accuracy.rank(other)[0]", "< accuracy.rank(other)[0]", T + "as_the_numbers_say"),
    (REPORT, 'max(wanted, key=lambda', 'min(wanted, key=lambda', T + "worst_of_its_problems"),
    (SKIPS, "values[1:]", "values", T + "time_is_that"),
    (TIMING, "return time.process_time() - start, result", "return time.process_time(), result",
     T + "time_is_that"),
]  # fmt: skip
