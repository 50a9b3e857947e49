"""Faults for curriculum/stress/: what its judges must see, and judges that see too little.

SEEN: what is wrong in contact.py or exact.py: (what stands there, what is planted, the property
that must see it, and those of its claims that must name it). Many are little larger than what the
property allows. test_stress.py plants them itself, many in a process. FAULTS, as in every room,
are of the judges, bounds that are too wide most of all: each asks test_stress.py for a row of SEEN.
"""

PROPERTIES, LAWS = "curriculum/stress/properties.py", "curriculum/stress/laws.py"
MAPS, MATCH, HEAPS = (f"curriculum/stress/{name}.py" for name in ("maps", "mujoco_match", "heaps"))
JOBS, EXTREMES = "curriculum/stress/jobs.py", "curriculum/stress/extremes.py"
FORCE = "f_n = penalty_normal_force(c.depth, c.v_n(), stiffness, damping)"
BACK, TARGET = "back = -restitution * c.v_n()", "target = -self.e * v_n"
SPRING, DAMPED = "        timeconst, dampratio = solref\n        K", "4.0 * mass / (root + damping)"
SWEEP = "settled = True\n        for c in contacts:"
SUM, SETTLED = "max(0.0, c.lam + missing * c.m_eff)", "LAST_BITS = 2.0**-42"
SOFT = "MOST_SWEEPS, LAST_BITS * max(map(abs, speeds)))"
AFTER = "c.after = min(-restitution * hit + left * a_n, back)"
SEEN = {
    "NaN is no explosion": ("~(total - total[0] < EXP", "(total - total[0] >= EXP",
        "finite_or_said_to_have_exploded", "a model is not finite, and that is not said"),
    "exact is no number after a short flight": ("evaluate(both, times[:, None, None])",
        "evaluate(both, times[:, None, None]) / (times < 1e-2)[:, None, None]",
        "finite_or_said_to_have_exploded", "exact is not finite"),
    "a flight moves with the old velocity": ("q[1:] = dt * fine[1::", "q[1:] = dt * fine[:-1:",
        "a_skip_changes_no_bit", "skips: a model"),
    "a flight goes on beside a NaN": ("~(gap >= reach)", "gap < reach",
        "a_skip_changes_no_bit", "skips beside NaN: a model"),
    "a flight ends a centimetre late": ("~(gap >= reach)", "~(gap >= reach - 1e-2)",
        "a_skip_changes_no_bit", "skips from afar: a model"),
    "a distance depends on the sign of x": ("dx = a.x - b.x\n", "dx = a.x - b.x + 1e-15\n",
        "what_nothing_touches_falls", "a model, fall"),
    "forces are kept": ("ball.fx = ball.fy = 0.0  # the", "pass  # the",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "a target depends on how many contacts there are":
        ("c.target = contact_target(c", "c.target = (1 + 1e-15 * len(contacts)) * contact_target(c",
        "a_far_ball_changes_nothing", "a model"),
    "of three contacts the third is missed":
        ("depth))\n    return contacts", "depth))\n    return contacts[:2] + contacts[3:]",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the first ball of a contact of exact.py feels 1e-7 more":
        ("1.0 * (pairs[0] == balls)", "(1.0 + 1e-7) * (pairs[0] == balls)",
        "exact_keeps_its_energy", "momentum [kg m/s]"),
    "the reaction is short by 1e-11":
        ("b.vx -= impulse * (b.inv", "b.vx -= (1.0 - 1e-11) * impulse * (b.inv",
        "contacts_push_along_their_normals_and_never_pull", "a model, not explained, step #"),
    "the reaction of exact.py is short by 1e-9":
        ("return (self.n * lam) @ self.sign.T", "return (self.n * lam) @ (self.sign + 1e-9).T",
        "exact_keeps_its_energy", "momentum [kg m/s]"),
    "gravity is short by 1e-14": ("GRAVITY = -9.81 ", "GRAVITY = -9.81 * (1 - 1e-14) ",
        "what_nothing_touches_falls", "a model, fall"),
    "balls move 1e-12 too far": ("ball.x += dt * ball.vx", "ball.x += (1 + 1e-12) * dt * ball.vx",
        "what_nothing_touches_falls", "a model, move"),
    "penalty pulls between balls":
        (FORCE, f"{FORCE} if c.b is FLOOR else stiffness * c.depth - damping * c.v_n()",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the damping is short by 1e-10": (FORCE, FORCE.replace("damping", "damping * (1 - 1e-10)"),
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "a length has its own unit": ("distance = math.sqrt(dx * dx + dy * dy)\n        depth",
        "distance = math.sqrt(dx * dx + dy * dy) + 1e-9\n        depth",
        "springs_push_as_hooke_and_the_damper_say", "impulse [N s]"),
    "the Baumgarte gain of pairs is halved":
        ("bias = baumgarte / dt", "bias = (1.0 if c.b is FLOOR else 0.5) * baumgarte / dt",
        "enough_sweeps_solve_lcp", "solved [m/s], step #"),
    "a contact of lcp pulls a little": (SUM, SUM.replace("0.0", "-1e-7"),
        "contacts_push_along_their_normals_and_never_pull", "a model, not explained, step #"),
    "a push is not along the normal":
        ("a.vx += impulse * (a.inv_mass * self.nx)",
        "a.vx += impulse * a.inv_mass * (self.nx + 1e-9 * self.ny)",
        "contacts_push_along_their_normals_and_never_pull", "a model, not explained, step #"),
    "a push is never taken back": (SUM, SUM.replace("0.0", "c.lam"),
        "enough_sweeps_solve_lcp", "solved [m/s], step #"),
    "the third contact is never swept":
        (SWEEP, SWEEP.replace("contacts", "contacts[:2]"),
        "enough_sweeps_solve_lcp", "solved [m/s], step #"),
    "lcp bounces with 1.01 e": ("bounce = -restitution", "bounce = -1.01 * restitution",
        "lcp_gains_energy_by_unfinished_sweeps_alone", "rise [J] with # sweeps"),
    "lcp bounces with e less 1e-9": ("bounce = -restitution", "bounce = 1e-9 - restitution",
        "an_impact_alone_returns_e_of_the_speed", "lcp, v_n [m/s]"),
    "soft bounces with e less 2e-3": ("-(1.0 + restitution) / dt",
        "(2e-3 - 1.0 - restitution) / dt",
        "an_impact_alone_returns_e_of_the_speed", "soft, v_n [m/s]"),
    "leapfrog bounces with e less 1e-9":
        (AFTER, AFTER.replace("-restitution", "(1e-9 - restitution)"),
        "an_impact_alone_returns_e_of_the_speed", "leapfrog, v_n [m/s]"),
    "the time constant of soft is 10 % longer for pairs":
        (SPRING, SPRING.replace("solref", "(1.0 if c.b is FLOOR else 1.1) * solref[0], solref[1]"),
        "soft_is_mujoco", "[m], step #"),
    "the sweeps of soft end too early": (SETTLED, SETTLED.replace("42", "32"),
        "soft_is_mujoco", "[m/s], step #"),
    "exact bounces with e less 1e-8 at the start":
        (TARGET, TARGET.replace("-self.e", "(1e-8 - self.e)"),
        "exact_pushes_and_never_pulls", "velocity after the impacts [m/s]"),
    "what begins to slide falls 1e-4 too slowly":
        ("(0.0, -self.g))[:, None] * (held", "(0.0, (1e-4 - 1) * self.g))[:, None] * (held",
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "what rests rises at 1e-3 m/s^2":
        ("held.match(a, -turn[pushes])", "held.match(a, 1e-3 - turn[pushes])",
        "exact_keeps_its_energy", "gained in a step [J]"),
    "what would part is held":
        ("pushes = lam * resting.share > NOISE", "pushes = lam * resting.share > -NOISE",
        "exact_pushes_and_never_pulls", "not explained [m/s]"),
    "exact.py leaves 1e-12 m of an overlap":
        ("resting.along(self.q) - self.found[touching])",
        "resting.along(self.q) - self.found[touching] - 1e-12)",
        "exact_never_overlaps", "overlap [m]"),
    "exact comes 1e-9 s late": ("span = min(roots)", "span = min(roots) + 1e-9",
        "exact_never_overlaps", "overlap [m]"),
    "exact loses 1e-9 of v at an event":
        ("ball.vy += span * a[k]", "ball.vy += span * a[k] - 1e-9 * ball.vy",
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "exact.py gains 1e-9 of v at an event":
        ("states[:, -1], now", "states[:, -1] * [[[1.0]], [[1 + 1e-9]]], now",
        "exact_keeps_its_energy", "gained since the start [J]", "gained in a step [J]"),
    "exact flies 1e-7 too high":
        ("(ball.vy + 0.5 * t * a[k])", "(ball.vy + (0.5 - 1e-7) * t * a[k])",
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "exact falls 1e-7 too slowly":
        ("ball.vy + t * a[k]\n", "ball.vy + (1 - 1e-7) * t * a[k]\n",
        "exact_keeps_its_energy", "gained in a step [J]"),
    "exact bounces with e less 1e-6": (BACK, BACK.replace("-rest", "1e-6 - rest"),
        "exact_keeps_its_energy", "lost with e = # [J]"),
    "leapfrog forgets what it gave on the way":
        ("c.target = c.after\n", "c.target = c.after\n        c.lam = 0.0\n",
        "leapfrog_throws_nobody_out_of_another", "speed [m/s]"),
    "leapfrog opens an overlap at once":
        ("min(-gap, OPENS * (c.a.radius + c.b.radius))", "-gap",
        "leapfrog_throws_nobody_out_of_another", "speed [m/s]"),
    "leapfrog's first half of gravity is whole":
        ("accelerate(balls, 0.5 * dt)\n    before", "accelerate(balls, dt)\n    before",
        "what_nothing_touches_falls", "a model, fall", "a model, move"),
    "a bounce of leapfrog begins at the end of its step":
        ("c.target = max(c.target, (end - max(gap, 0.0)) / dt)", "pass",
        "two_free_balls_pass_or_bounce_in_closed_form", "bounce, q [m]"),
    "leapfrog bounces with 1.01 e":
        (AFTER, "c.after = -1.01 * restitution * hit",
        "two_free_balls_pass_or_bounce_in_closed_form", "bounce, v [m/s]"),
    "leapfrog asks along the normal of now": ("    turn(c, dt)\n", "",
        "two_free_balls_pass_or_bounce_in_closed_form", "pass, q [m]", "pass, v [m/s]"),
    "leapfrog ends a step along the normal of its start":
        ("turn(c, 0.0)  # normal", "pass  # normal",
        "leapfrog_is_of_second_order",
        "slide, an eighth of the step", "spread, an eighth of the step"),
    "a bounce on the table keeps the speed that gravity adds":
        (AFTER, "c.after = min(-restitution * hit, back)",
        "leapfrog_adds_no_energy_once_its_sweeps_are_done", "gained since the start [J]"),
    "the critical step is 1 % too long": (DAMPED, f"1.01 * {DAMPED}",
        "penalty_leaves_above_its_critical_dt", "leaves below the critical dt"),
    "the critical step is 1 % too short": (DAMPED, f"0.99 * {DAMPED}",
        "penalty_leaves_above_its_critical_dt", "stays above the critical dt"),
    "lcp looks twice as far": ("contacts = detect_contacts(balls)\n",
        "contacts = detect_contacts(balls, 2e-3)\n",
        "what_nothing_touches_falls", "a model, fall"),
    "the spring of soft is 1e-5 weaker":
        (SPRING, SPRING.replace("K", "dampratio *= 1.00001\n        K"),
        "soft_is_mujoco", "[m], step #"),
    "soft is softer by 1e-9":
        ("(1.0 - d) / d * c.inv_mass)", "(1.0 - d) / d * (1 + 1e-9) * c.inv_mass)",
        "soft_is_mujoco", "[m], step #"),
    "a step of soft ends 1e-11 m/s too fast": ("move(balls, dt)\n    return settled",
        "move(balls, dt)\n    balls[0].vy += 1e-11\n    return settled",
        "soft_is_mujoco", "[m/s], step #"),
    "the steps of a run of soft are 1e-9 longer": ("soft_step(balls, dt, *soft)",
        "soft_step(balls, (1 + 1e-9) * dt, *soft)",
        "soft_is_mujoco", "[m], run"),
}  # fmt: skip


def sees(fault):
    """The test that a fault of contact.py or exact.py is seen."""
    return f"test_stress.py -k '{' and '.join(fault.split())} and names'"


FAULTS = [
    (PROPERTIES, "PROMISE = 1e-12", "PROMISE = 1e-8", sees("leaves 1e-12 m")),
    (PROPERTIES, "NEAR = 1e-9", "NEAR = 1e-6", sees("e less 1e-8 at")),
    (PROPERTIES, "~((a == b) | (a != a) & (b != b))", "abs(a - b) > 1e-9",
     sees("target depends many contacts")),
    (PROPERTIES, "allowed = 8 * U * (sweeps", "allowed = 8e6 * U * (sweeps",
     sees("short 1e-11")),
    (PROPERTIES, "4 * U * speed, free", "4e4 * U * speed, free", sees("gravity 1e-14")),
    (PROPERTIES, "4 * U * size, moves", "4e6 * U * size, moves", sees("balls move 1e-12")),
    (PROPERTIES, "off, moved + 1e-11 * top", "off, np.inf", sees("never taken back")),
    (PROPERTIES, '"lcp": 8 * U', '"lcp": 8e9 * U', sees("lcp bounces less 1e-9")),
    (PROPERTIES, '4 * exact_to', '4e9 * exact_to', sees("leapfrog bounces less 1e-9")),
    (PROPERTIES, '"soft": 2.1e-4', '"soft": 2.1e-2', sees("e less 2e-3")),
    (PROPERTIES, "np.maximum(np.diff(total), 0.0)", "0.0 * np.diff(total)",
     sees("exact falls 1e-7")),
    (LAWS, "return force, 8 * U", "return force, 8e6 * U", sees("damping 1e-10")),
    (MAPS, "LATE = 0.004", "LATE = 0.04", sees("critical step 1 long")),
    (MATCH, "- q[k + 1]), 1e-14", "- q[k + 1]), 1e-8", sees("softer 1e-9")),
    (MATCH, "- v[k + 1]), 1e-12", "- v[k + 1]), 1e-9", sees("ends 1e-11")),
    (MATCH, "run.q - q), 1e-11", "run.q - q), 1e-5", sees("steps of run 1e-9 longer")),
    (HEAPS, "EIGHTH = 8.0**-1.8", "EIGHTH = 8.0**-0.8", sees("normal of its start")),
    (JOBS, "if not count]", "if count is None]", "test_stress.py -k judges_nothing"),
    (JOBS, "total[0] + (count > 0)", "total[0] + 1", "test_stress.py -k counts_add_up"),
    (EXTREMES, 'or quality["through"] or unknown', "or unknown",
     "test_stress.py -k a_wrong_word"),
]  # fmt: skip
