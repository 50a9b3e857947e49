"""Faults for curriculum/run/, seeds.py, parallel.py and commands.py: (file, what stands there, what
is planted, the tests that must name it)."""

PLOTTING, RECORDING = "curriculum/run/plotting.py", "curriculum/run/recording.py"
REMARKS, SEEDS = "curriculum/run/remarks.py", "curriculum/seeds.py"
CURVES = "test_run.py::test_curves_are_the_runs_own_numbers_in_the_models_colour_with_their_peaks"
BALLS = "test_run.py -k test_balls_are_where_the_run_had_them"
OPENS = "test_run.py -k test_it_opens_slowed_down"
COUNT = "test_run.py::test_seeds_count_what_exploded_went_through_or_could_not_be_run"
RANGE = "test_run.py::test_seeds_give_median_and_range_and_a_dask_cluster_gives_the_same"

FAULTS = [
    (PLOTTING, "mass * (np.diff(run.v, axis=0) - gained)",
     "mass * np.abs(np.diff(run.v, axis=0) - gained)", CURVES),
    (PLOTTING, "gained = np.diff(run.t[:2]).sum()", "gained = 0.002", CURVES),
    (PLOTTING, "depth / scene.radius[0]", "depth / 0.1", CURVES),
    (PLOTTING, "run.q[:, 1].mean(-1)", "run.q[:, 1].max(-1)", CURVES),
    (PLOTTING, '"P", (0, (7, 1, 1, 1))', '"P", "-"', "test_run.py -k test_a_picture"),
    (RECORDING, "contact.GRAVITY * scene.mass", "contact.GRAVITY", BALLS),
    (RECORDING, "scene.mass * np.diff(run.t[:2]).sum()", "scene.mass * 0.002", BALLS),
    (RECORDING, "depths = [0.005", "depths = [-0.005", BALLS),
    (RECORDING, "GROUND, -10.0", "GROUND, 25.0", BALLS),
    (RECORDING, "rows[:, 0], -rows[:, 1]", "rows[:, 0], rows[:, 1]", BALLS),
    (RECORDING, '"MinMax"', '"Average"', CURVES),
    (RECORDING, "np.maximum(t, first)", "t", OPENS),
    (RECORDING, "< 0.01 * np.diff", "< 0.2 * np.diff", OPENS),
    (RECORDING, '"EXPLODED" not in ends[model]', 'ends[model] != ""',
     "test_run.py -k test_a_view_says_how_its_run_ended"),
    (RECORDING, "count > MOST_ARROWS", "count > 100", "test_run.py -k test_of_many_balls"),
    (SEEDS, 'sum(row["blew_up"] for row in qualities)', "0", COUNT),
    (SEEDS, 'row["through"] is not None and not row["blew_up"]', "False", COUNT),
    (SEEDS, 'count - row["runs"]', "0", COUNT),
    (SEEDS, "else math.inf", "else 0.0", COUNT),
    (SEEDS, '"lowest": min', '"lowest": max', RANGE),
    (SEEDS, "range(int(first), int(last))", "range(int(first) + 1, int(last))", RANGE),
    (REMARKS, "need <= have", "need <= 1000 * have", "test_command_line.py"),
    (REMARKS, "args.contact not in", "args.contact in", "test_command_line.py"),
    ("curriculum/parallel.py", "for job in jobs]\n", "for job in jobs[::-1]]\n",
     "test_run.py::test_work_is_spread_over_processes_in_the_order_of_the_jobs"),
    ("curriculum/commands.py", "path.exists() and not path.is_file()", "False",
     "test_packaging.py -k test_what_is_no_file"),
]  # fmt: skip
