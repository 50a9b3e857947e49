"""Faults for curriculum/page/: (file, what stands there, what is planted, the tests that must name
it). The pictures were once false in these seven ways, while all values beside them were right."""

FIGURES = "curriculum/page/figures"
PICTURE = "test_page_figures.py -k test_picture_{}"

FAULTS = [
    (
        "curriculum/page/draw.js",
        ".map(([at, v]) => [sx(at), sy(v)]);",
        ".map(([at, v]) => [sx(at), within(box.top - 40, sy(v), box.bottom + 40)]);",
        PICTURE.format("rod"),
    ),
    (
        f"{FIGURES}/falls.js",
        "const time = row * own.dt;",
        "const time = from + own.time;",
        PICTURE.format("falls_shows"),
    ),
    (
        "curriculum/page/stage.js",
        "captionOf = ({ caption }, { own }) => worded(asked(caption, own))",
        "captionOf = ({ caption }, { text }) => worded(asked(caption, text))",
        PICTURE.format("falls_shows"),
    ),
    (f"{FIGURES}/sag.js", "balls: 30,", "balls: 8,", PICTURE.format("sag")),
    (
        f"{FIGURES}/gripper.js",
        "shown: states.slice(0, gone) }",
        "shown: states.slice(0, 1) }",
        PICTURE.format("gripper"),
    ),
    (f"{FIGURES}/sliding.js", "[0.48, 1e-4, 5]", "[0.5, 1e-4, 5]", PICTURE.format("sliding")),
    (
        f"{FIGURES}/cliff.js",
        "column([R - ((1 - 1e-4) * G) / stiffness])",
        "column([R + 0.6])",
        PICTURE.format("cliff"),
    ),
]
