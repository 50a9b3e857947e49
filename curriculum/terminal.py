"""The command line of contact.py: flags, the report that it prints, and the files that it writes.

Nothing here is about contact: contact.py, as `contact`, makes the runs and measures them.
"""

import argparse
import math
import os
import sys

import contact
from curriculum.common import arguments, device, memory, progress, results, shell
from curriculum.common.stoppable import stoppable

EXPLAINED = """\
scenes:
  drop     one ball falls about a metre onto the table, restitution 0
  bounce   the same ball with restitution 0.7
  stack    balls one upon the other, let go just above the table, restitution 0
  pile     many balls on a lattice fall into a heap, restitution 0
models:
  penalty  a stiff spring and a damper: contact is one more force
  lcp      impulses that solve a complementarity problem, by projected Gauss-Seidel sweeps
  soft     MuJoCo's contact: the same sweeps, with a spring as target and softness added
  exact    from event to event, every impact at its own time; what the others are measured against
examples:
  contact.py --contact exact                what should happen, and what the exercises ask about
  contact.py --contact penalty --dt 0.03    one model, a longer step
  contact.py --scene bounce --plot          a picture of the run: contact.svg, by matplotlib
  contact.py --seeds 0:20                   median and range over the seeds 0 to 19
"""


def parse_flags(argv):
    """The checked command line. Bad input ends with one line on stderr and exit status 2."""
    parser = arguments.Parser(prog="contact.py", epilog=EXPLAINED, description=(
        "Contact between balls and a table, built four times and measured.\n"
        "In parentheses: what a flag is when it is not given."))
    add_run_flags(parser.add_argument_group("what runs"))
    add_model_flags(parser.add_argument_group("the models' knobs"))
    add_output_flags(parser.add_argument_group("what is written"))
    args = parser.parse_args(argv)
    usual = parser.parse_args(["--out", args.out])
    args.usual = knobs(args) == knobs(usual)    # the run whose time the ledger knows
    if args.bodies and args.scene in ("drop", "bounce"):
        parser.error(f"argument --bodies: given {args.bodies}; allowed: stack and pile only")
    if args.solref and not (min(args.solref) > 0.0 or max(args.solref) <= 0.0):
        parser.error("argument --solref: given {:g} {:g}; allowed: two numbers > 0, or two that "
                     "are not".format(*args.solref))
    if args.solimp and not 1.0 <= args.solimp[4] <= 100.0:
        parser.error(f"argument --solimp: given the power {args.solimp[4]:g}; allowed: 1 to 100")
    args.steps = 800 if args.smoke else args.steps
    count = args.bodies or {"stack": 3, "pile": 200}.get(args.scene, 1)
    memory.need(parser, 800 * (args.steps + 1) * count, f"--steps {args.steps} of {count} balls")
    return args


def knobs(args):
    """The flags that decide what comes out, {name: value}."""
    apart = ("out", "rerun", "skip", "plot", "usual")
    return {name: value for name, value in vars(args).items()
            if name not in apart and (name not in ("seeds", "mass") or value)}


def add_run_flags(group):
    """The flags that say what runs: scene, model, seed and steps."""
    flag, number = group.add_argument, arguments.number
    flag("--scene", choices=contact.SCENES, default="drop", help="see below (drop)")
    flag("--contact", choices=("all", *contact.MODELS), default="all",
         help="the model, see below (all)")
    flag("--seed", type=number(int, low=0), default=0, help="draws the start height (0)")
    flag("--seeds", type=arguments.whole_range, metavar="A:B",
         help="every seed from A to B - 1 instead: prints median and range, writes seeds.json")
    flag("--dt", type=number(float, above=0), default=0.002, help="time step [s] (0.002)")
    flag("--steps", type=number(int, low=0), default=2000, metavar="N", help="how many (2000)")
    flag("--bodies", type=number(int, low=1), metavar="N", help="balls of stack (3), pile (200)")
    flag("--mass", type=number(float, above=0), metavar="M", help="of every ball [kg] (1)")
    flag("--smoke", action="store_true", help="a fixed 800 steps, for CI")
    flag("--device", choices=("cpu",), default="cpu", help="where it runs (cpu)")


def add_model_flags(group):
    """The knobs of the models."""
    flag, number = group.add_argument, arguments.number
    flag("--stiffness", type=number(float, low=0), default=1e4, metavar="K",
         help="penalty: stiffness [N/m] (1e4)")
    flag("--damping", type=number(float, low=0), metavar="C",
         help="penalty: damping [N s/m] (80; bounce 0)")
    flag("--restitution", type=number(float, 0, 1), metavar="E",
         help="lcp, soft, exact: share of the speed that a bounce gives back (0; bounce 0.7)")
    flag("--baumgarte", type=number(float, 0, 1), default=0.2, metavar="BETA",
         help="lcp: share of an overlap that a step removes (0.2)")
    flag("--iters", type=number(int, low=1), default=20, metavar="N",
         help="lcp: Gauss-Seidel sweeps a step (20)")
    flag("--solref", type=number(float), nargs=2, metavar=("T", "ZETA"),
         help="soft: time constant [s] and damping ratio (0.02 1), or minus a stiffness and minus "
              "a damping (where balls bounce: 0 and -(1 + e) / dt)")
    flag("--solimp", type=number(float, low=0), nargs=5,
         metavar=("D0", "D1", "WIDTH", "MID", "POWER"),
         help="soft: the impedance (0.9 0.95 0.001 0.5 2; where balls bounce: 0.9999)")


def add_output_flags(group):
    """The flags that say what is written, and where."""
    flag, switch = group.add_argument, argparse.BooleanOptionalAction
    flag("--out", type=arguments.writable_folder, default="outputs/ch3.5-contact",
         metavar="FOLDER", help="for metrics.json, contact.rrd, contact.svg (%(default)s)")
    flag("--rerun", action=switch, default=True, help="write the recording contact.rrd (yes)")
    flag("--plot", action="store_true", help="draw contact.svg, by matplotlib (no)")
    flag("--skip", action=switch, default=True, help="leave out work that changes no bit (yes)")


COLUMNS = {"max pen/r": "max_penetration_frac", "rest gap/r": "rest_gap_frac",
           "rebound/r": "rebound_frac", "energy+": "energy_excess", "energy in": "contact_energy",
           "flight err/r": "flight_error_frac", "contact err/r": "contact_error_frac",
           "jitter/r": "rest_jitter"}
LEGEND = {
    "max pen/r": "the deepest overlap of two surfaces; r is the radius of a ball",
    "rest gap/r": "the smallest gap at the end: below 0 it is an overlap",
    "rebound/r": "how high the balls come off all surfaces after the first contact",
    "energy+": "the most energy above the start, as a share of the start's",
    "energy in": "all rises of the energy, step by step, added up: what contacts put in",
    "flight err/r": "the worst height error before the first contact, against exact",
    "contact err/r": "what contact adds to the worst height error",
    "jitter/r": "standard deviation of the overlap over the last quarter of the run"}


def critical_step(args, scene):
    """The critical step of penalty [s], and what it is the step of.

    The stiffest swing of n balls in a row is that of one ball whose spring and damper are
    4 cos(pi / (2 n + 1))^2 times as large. For a pile there is no such formula; it bears less.
    """
    count = len(scene.mass) if scene.name == "stack" else 1
    times = 4.0 * math.cos(math.pi / (2 * count + 1)) ** 2
    limit = contact.critical_dt(float(scene.mass[0]), times * args.stiffness,
                                times * scene.damping)
    return limit, f"a stack of {count}" if count > 1 else "one ball"


def print_report(args, quality, grid, critical=None):
    """Print one row per model, a legend, a verdict that claims what it tests, and stability.

    critical: the critical step of penalty [s] and of what it is, printed beside its explosion.
    """

    def state(row):
        if not row["blew_up"]:
            return "ok"
        known = critical is not None and row is quality.get("penalty")
        beside = ", critical dt of {1}: {0:.4g} s".format(*critical) if known else ""
        return f"EXPLODED at step {row['blew_up_step']}{beside}"

    print(f"scene {args.scene}, seed {args.seed}: {args.steps} steps of {args.dt:g} s")
    marks = results.best_and_worst(quality, COLUMNS.values(), "exact", unknown="rebound_frac")
    results.print_table("contact", COLUMNS, quality, state, marks)
    results.print_legend(LEGEND)
    if marks:
        results.print_legend({"* and !": "nearest to exact, and farthest; without exact, to 0"})
    if grid:
        print_verdict(quality["penalty"], quality["lcp"])
        print_stability(grid)
    if grid and critical and critical[1] != "one ball":
        print("critical dt of penalty, {1}: {0:.4g} s".format(*critical))


def print_verdict(spring, solve):
    """Compare the depths of penalty and lcp, if these rows can be compared."""
    said = "a run exploded"
    if not (spring["blew_up"] or solve["blew_up"]):
        deeper = all(spring[key] > solve[key]
                     for key in ("max_penetration_frac", "rest_penetration_frac"))
        said = "yes" if deeper else "no"
        if spring["max_penetration_frac"] == solve["max_penetration_frac"] == 0.0:
            said = "neither overlaps at any step"
    print("verdict: penalty penetrates deeper than lcp, at worst and at rest:", said)


def print_stability(grid):
    """Print the largest step that each model stood, and the critical steps of penalty."""
    print("stability: tried at", ", ".join(map(str, contact.DT_GRID)), "times --dt")
    for model in ("penalty", "lcp"):
        if grid[model] is None:
            print(f"stability: {model} comes to no contact within these steps: nothing to say")
        elif grid[model] == 0.0:
            print(f"stability: {model} explodes at every dt tried")
        else:
            depth = results.figure(grid[f"{model}_penetration_frac"])
            print(f"stability: {model} does not explode up to dt = {grid[model]:g} s, "
                  f"where it goes {depth} r deep")
    damped, textbook = (results.figure(grid[key], 4)
                        for key in ("dt_crit_damped", "dt_crit_penalty"))
    print(f"critical dt of penalty, one ball: {damped} s; "
          f"without the damper, 2 sqrt(m/k), {textbook} s")


def written(what, path, write, *content, needs=None):
    """Have a file written, and say so. Returns the exit status.

    A folder that turns out unwritable costs the file and nothing else, since the report is
    printed. needs: the package that may be missing.
    """
    try:
        write(path, *content)
    except ImportError:
        print(f"no {what}: {needs} is not installed, {shell.install(needs)}")
        return 0
    except OSError as error:
        print(f"contact.py: error: cannot write {error.filename}: {error.strerror}; the report is "
              "whole, give another --out to keep its files", file=sys.stderr)
        return 2
    print(f"{what}:", path)
    return 0


def write_results(args, metrics, runs, scene):
    """Write metrics.json, and recording and picture as asked. Returns the exit status."""
    numbers, recording, drawing = (os.path.join(args.out, name)
                                   for name in ("metrics.json", "contact.rrd", "contact.svg"))
    status = written("metrics", numbers, results.write_json, metrics)
    if args.rerun and not status:
        status = written("recording", recording, contact.log_rerun, runs, scene, needs="rerun-sdk")
    if args.plot and not status:
        from curriculum.common import picture
        title = f"{args.scene}, seed {args.seed}, dt = {args.dt:g} s"
        for model, row in metrics["quality"].items():
            title += f", {model} EXPLODED at step {row['blew_up_step']}" if row["blew_up"] else ""
        status = written("picture", drawing, picture.write, title, runs,
                         contact.curves(runs, scene), contact.COLORS, needs="matplotlib")
    return status


def print_next(args, argv, status):
    """The last lines of a run: what to do next, as commands that work as printed."""
    here = os.path.dirname(os.path.abspath(contact.__file__))
    recording = os.path.join(args.out, "contact.rrd")
    if not status and args.rerun and os.path.exists(recording):
        print("next, watch it:", shell.tool("rerun"), recording)
    elif not status and not args.plot:
        same = [word for word in argv if word not in ("--skip", "--no-skip")]
        print("next, see it:", shell.python(os.path.join(here, "contact.py"), *same, "--plot"))
    bet = os.path.join(here, "exercises", "ex1_predict_contact.py")
    print("next, make a bet:", shell.python(bet, extra="learn"))


def seed_quality(args, models, seed):
    """{model: contact.contact_quality} of one seed; a process of its own may run it."""
    scene = chosen_scene(args, seed)
    runs = {model: chosen_run(args, model, scene, args.dt) for model in models}
    return {model: contact.contact_quality(run, scene, args.dt, runs.get("exact"))
            for model, run in runs.items()}


def run_seeds(args, models):
    """Print median, lowest and highest of every measure over the seeds, and write seeds.json.

    Returns the exit status.
    """
    from curriculum.common import workers
    seeds = range(*args.seeds)
    found = workers.spread(seed_quality, [(args, models, seed) for seed in seeds], "seeds")
    rows = {}
    for model in models:
        rows |= results.summary(model, [each[model] for each in found], COLUMNS.values())
    rows = results.rounded(rows)
    print(f"scene {args.scene}, seeds {seeds[0]} to {seeds[-1]}: {args.steps} steps of "
          f"{args.dt:g} s")
    results.print_table("contact", COLUMNS, rows, lambda row: (
        f"{row['blew_up']} of {len(seeds)} EXPLODED" if row["blew_up"] else "ok"))
    results.print_legend(LEGEND)
    path = os.path.join(args.out, "seeds.json")
    return written("seeds", path, results.write_json, {
        "scene": args.scene, "dt": args.dt, "steps": args.steps, "seeds": list(args.seeds),
        "rows": rows})


def choose_models(args, count):
    """The models to run. Says what is left out of a scene of so many balls, and what is slow."""
    models = [model for model in contact.MODELS if args.contact in ("all", model)]
    if args.contact == "all" and count > 24:
        models.remove("exact")
        print("exact is left out of piles of more than 24 balls; ask for it by --contact exact")
    if args.skip and count > contact.FEW and contact.compiled_piles() is None:
        print("the extra `fast` is missing (pip install numba): many balls take longer, and soft "
              "is left out of piles of more than 24 unless asked for", file=sys.stderr)
        if args.contact == "all" and count > 24:
            models.remove("soft")
    return models


def chosen_scene(args, seed):
    """The scene that the flags ask for."""
    scene = contact.build_scene(args.scene, seed, args.bodies, args.restitution, args.damping)
    return scene if args.mass is None else scene._replace(mass=args.mass * scene.mass)


def chosen_run(args, model, scene, dt, report=lambda k: None):
    """A run of the scene with the knobs that the flags give."""
    return contact.run_model(model, scene, dt, args.steps, args.stiffness, args.baumgarte,
                             args.iters, args.skip, report, args.solref, args.solimp)


def collect(args, scene, runs, run):
    """What metrics.json holds: the flags that matter, the measures and the stability grid."""
    grid = {}
    if args.contact == "all" and args.scene != "pile":
        grid = contact.measure_stability(run, scene, args.dt, args.stiffness, runs)
    return {"scene": args.scene, "contact": args.contact, "dt": args.dt, "steps": args.steps,
            "seed": args.seed, "stiffness": args.stiffness, "restitution": scene.restitution,
            "stability": grid,
            "quality": {model: contact.contact_quality(found, scene, args.dt, runs.get("exact"))
                        for model, found in runs.items()}}


@stoppable
def main(argv=None):
    """Run the command line: print the report, write its files. Returns the exit status."""
    args = parse_flags(argv)
    config_hash = results.fingerprint(knobs(args))
    device.banner("ch3.5-contact", args.device, args.usual)
    scene = chosen_scene(args, args.seed)
    models = choose_models(args, len(scene.mass))
    if args.seeds:
        status = run_seeds(args, models)
        print("config_hash:", config_hash)
        return status

    def run(model, dt):
        place = f"model {1 + models.index(model)} of {len(models)}"
        label = f"{place}, {model}, dt = {dt:g} s"
        return chosen_run(args, model, scene, dt, progress.steps(args.steps, label))

    runs = {model: run(model, args.dt) for model in models}
    metrics = results.rounded(collect(args, scene, runs, run), steps=("dt", *contact.MODELS))
    print_report(args, metrics["quality"], metrics["stability"], critical_step(args, scene))
    status = write_results(args, metrics, runs, scene)
    print("config_hash:", config_hash)
    print_next(args, sys.argv[1:] if argv is None else argv, status)
    return status
