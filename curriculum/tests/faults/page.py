"""Faults for curriculum/page/: (file, what stands there, what is planted, the tests that must name
it). The pictures were once false in these ways, while all values beside them were right."""

FIGURES, PICTURE = "curriculum/page/figures", "test_page_figures.py -k test_picture_"
FAULTS = [
    ("curriculum/page/draw.js", ".map(([at, v]) => [sx(at), sy(v)]);",
     ".map(([at, v]) => [sx(at), within(box.top - 40, sy(v), box.bottom + 40)]);", PICTURE + "rod"),
    (f"{FIGURES}/falls.js", "const time = row * own.dt;", "const time = from + own.time;",
     PICTURE + "falls_shows"),
    ("curriculum/page/stage.js", "({ caption }, { own }) => worded(asked(caption, own))",
     "({ caption }, { text }) => worded(asked(caption, text))", PICTURE + "falls_shows"),
    (f"{FIGURES}/sag.js", "balls: 30 }", "balls: 8 }", PICTURE + "sag"),
    (f"{FIGURES}/gripper.js", "shown: states.slice(0, gone) }", "shown: states.slice(0, 1) }",
     PICTURE + "gripper"),
    (f"{FIGURES}/cliff.js", "column([R - ((1 - 1e-4) * G) / stiffness])",
     "column([R + 0.6])", PICTURE + "cliff"),
    (f"{FIGURES}/gripper.js", "fate === 2 && time === 0", "fate > 2 && time === 0",
     PICTURE + "gripper"),
    (f"{FIGURES}/falls.js", 'label(model, x, 15, "middle")', 'label(model, x, floor, "middle")',
     PICTURE + "falls_tells"),
]  # fmt: skip
