"""Faults for curriculum/fast.py: (file, what stands there, what is planted, the tests that name
it)."""

F, T = "curriculum/fast.py", "test_fast.py -k "
PLAIN, WALLS, REST = T + "plain_loops", T + "between_walls", T + "until_all_balls_rest"
FAULTS = [
    (F, "    return c.a if c.b == count - 1 else (c.a + 1) * count + c.b",
     "    return (c.a + 1) * count + c.b", PLAIN),
    (F, "0.499 * (listed - reach)", "0.6 * (listed - reach)", T + "list_looks"),
    (F, "gaps[k] < 0.999 * reach - 2.0 * farthest", "gaps[k] < 0.999 * reach - farthest",
     T + "list_looks"),
    (F, "rows[np.isnan(rows)] = math.nan", "pass", PLAIN),
    (F, "rows += 0.0  #", "#", PLAIN),
    (F, "settled = settled and abs(change)", "settled = abs(change)", PLAIN),
    (F, "fastest = larger(fastest, abs(c.target))", "pass", PLAIN),
    # leapfrog
    (F, "                turn(c, balls, 0.0)", "                pass", PLAIN),
    (F, "        if onward < 0.0:\n            t = 1.0\n", "", PLAIN),
    (F, "if no_room(balls, contacts, stays, free):", "if False:", WALLS),
    (F, "grows = crowd.any()", "grows = False", WALLS),
    (F, "if balls[other].inv_mass > 0.0:", "if True:", WALLS),
    (F, "        balls[\"vx\"][:], balls[\"vy\"][:] = vx, vy\n", "", WALLS),
    (F, "after = back if back < bounce else bounce", "after = bounce", PLAIN),
]  # fmt: skip
