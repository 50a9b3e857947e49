"""Faults for the page's figures, its engine and what builds it: (file, what stands there, what is
planted, the tests that must name it)."""

FIGURES, ENGINE = "curriculum/page/figures/", "curriculum/page/engine.js"
FALLS, KIT = "curriculum/page/falls.js", "curriculum/page/kit.js"
GLANCE, SHOWS = "curriculum/page/glance.js", "test_page.py -k passage_shows"
LOST = "test_page_figures.py -k test_nothing_that_can_be_held"
BITS = "test_page_engine.py -k chromium"


def reads(words):
    """The test of test_page_figures.py with these words in its name."""
    return f"test_page_figures.py -k {words}"


FAULTS = [
    # figures: the drawn number
    (FIGURES + "clamp.js", "iters: 20, project", "iters: 2, project", reads("groove")),
    (FIGURES + "clamp.js", "nx: -0.6 * side", "nx: -0.5 * side", reads("groove")),
    (FIGURES + "cradle.js", "v / PACE / LENGTH", "v / PACE / LENGTH / 2", reads("cradle")),
    (FIGURES + "cradle.js", "(2 + (apart ? APART : 0)) * R", "2 * R", reads("cradle")),
    (FIGURES + "impedance.js", "(1 − d) / d = ${number((1 - d) / d)}",
     "(1 − d) / d = ${number(d / (1 - d))}", reads("impedance")),
    (FIGURES + "landing.js", "-Math.min(0, ...larger.ys.slice(0, 4))",
     "-0.5 * Math.min(0, ...larger.ys.slice(0, 4))", reads("landing")),
    (FIGURES + "landing.js", "(baumgarte / dt) * depth * R", "(baumgarte / dt) * depth",
     reads("landing")),
    (FIGURES + "inequality.js", "{ gap: run.y[1] / R - 1,", "{ gap: run.y[0] / R - 1,",
     reads("inequality")),
    (FIGURES + "bowl.js", "[v1 + table - upper,", "[v1 + table,",
     reads("bowl")),
    (FIGURES + "bowl.js", "solveWithMomentum(rows, [0, 0], vy, { iters })",
     "solveWithMomentum(rows, [0, 0], vy, { iters: 2 * iters })", reads("bowl")),
    (FIGURES + "sweeps.js", "top - 1], LAST", "top], LAST", reads("sweeps")),
    (FIGURES + "sag.js", "? Math.min(1, deep)", "? Math.min(1, 2 * deep)",
     reads("sag")),
    (FIGURES + "sag.js", "dt: dt / parts", "dt: dt", reads("sag")),
    (FIGURES + "corner.js", "Math.max(0, -gap * steep)]", "-gap * steep + 1]", reads("spring")),
    (FIGURES + "corner.js", "Math.round(own.time / DT)", "Math.round(own.time / DT / 2)",
     reads("spring")),
    (FIGURES + "signs.js", "within(8, tipX, width - 8)", "tipX", LOST),
    (FIGURES + "signs.js", "0.7 * R * scale * nx, -0.7", "0.7 * R * scale * nx, 0.7",
     reads("normals")),
    (FIGURES + "corner.js", "(stiffness * R) / G", "stiffness * R", reads("corner")),
    (FIGURES + "cliff.js", "STEPS / 4 + 1", "STEPS / 40", reads("cliff")),
    (FIGURES + "long-step.js", "-dt * (1 - c * dt)", "dt * (1 - c * dt)", reads("eigenvalues")),
    (FIGURES + "gripper.js", 'late ? "implicit" : "penalty"', '"penalty"', reads("gripper")),
    (FIGURES + "gripper.js", "Math.floor(LATE * (steps + 1))", "0", reads("gripper")),
    (FIGURES + "blocks.js", "run.vx[3 * row - 2]) > 1e-9", "run.vx[3 * row - 2]) > 9",
     reads("blocks")),
    (FIGURES + "twice.js", "[0.5, 1e-4, 5]", "[0.4, 1e-4, 5]", reads("twice")),
    (FIGURES + "twice.js", "{ vy: [v] }", "{ vy: [v / 2] }", reads("twice")),
    (FIGURES + "grab.js", "const BOUNCE = 0.6", "const BOUNCE = 0.5", reads("first_ball")),
    (FIGURES + "lanes.js", "models.split(\",\").includes(model)", "models.includes(\"lcp\")",
     "test_page.py -k link_of_the_text"),
    (FALLS, "height + lift)", "height + lift + 0.01)", reads("live_figure")),
    (FALLS, "gap[row] < 0 ? below", "gap[row] > 0 ? below", reads("live_figure")),
    (KIT, "Math.max(0, stiffness * depth - damping * speed)", "stiffness * depth - damping * speed",
     reads("one_loop")),
    # the engine
    (ENGINE, "/ dt - GRAVITY)", "/ dt + GRAVITY)", reads("landing_of_a_series")),
    (ENGINE, "(4 * mass) / (root + damping)", "(2 * mass) / (root + damping)", reads("cliff")),
    (ENGINE, "excess < EXPLODED", "excess < 9 * EXPLODED", reads("cliff")),
    (ENGINE, "landing = row;", "landing = row + 3;", reads("landing_of_a_series")),
    (ENGINE, "if (noRoom(rows)) {", "if (false) {", BITS),
    (ENGINE, "known < crowd.size", "false", BITS),
    (ENGINE, "c.after = fast ? back : least(0, back);", "c.after = 0;", BITS),
    (ENGINE, "if (!(c.hits || struck", "if ((c.hits || struck", BITS),
    (ENGINE, "fall(vy, mass, 0.5 * dt) };", "fall(vy, mass, dt) };", BITS),
    (ENGINE, "if (onward < 0) t = 1;", "", BITS),
    (ENGINE, "value === value ? value + 0 : NaN", "value", BITS),
    (ENGINE, "dt * stiffness * c.depth * softness", "dt * stiffness * c.depth", BITS),
    (ENGINE, "2 ** -50 * Math.max", "2 ** -30 * Math.max", BITS),
    # hands
    ("curriculum/page/stage.js", "if (event.pointerId !== this.#pointer) return;",
     "if (this.grabbed === null) return;", "test_page.py -k second_finger"),
    ("curriculum/page/stage.js", "|| event.button > 0", "", "test_page.py -k right_button"),
    ("curriculum/page/reader.js", "if (event.button > 0) return;", "",
     "test_page.py -k right_button"),
    # what a phone shows in place of the live figure
    (GLANCE, "svg.innerHTML = figures", "figures", SHOWS),
    (GLANCE, "URLSearchParams(this.look)", "URLSearchParams()", SHOWS),
    (GLANCE, "width), { open });", "width), { open: () => true });", SHOWS),
    ("curriculum/page/style.css", ".show button { display: block;", ".show button { color: red;",
     "test_page.py -k long_stretch"),
    # what builds and holds the page
    ("curriculum/page/build.py", "if count != 1:", "if count > 1:",
     "test_page.py -k lit_line"),
    ("curriculum/page/lines.js", '"return bias"', '"return close"', "test_page.py -k same_bytes"),
    ("curriculum/page/store.js", "this.#put(changed(from, changes), true)",
     "this.#put(changed(this.home, changes), true)", reads("section_keeps")),
    ("curriculum/page/style.css", ".js .printed { display: block", ".js .lost { display: block",
     "test_page.py -k print_has"),
    ("curriculum/page/style.css", '[width="2em"]) math { font-size: 1rem; }',
     '[width="2em"]) math { font-size: 3.7vw; }',
     "test_page.py -k formula"),
]  # fmt: skip
