"""The benchmark's command line.

    python -m curriculum.bench            everything below, one after the other
    python -m curriculum.bench accuracy   run time against error, on problems with a known answer
    python -m curriculum.bench solvers    the complementarity problem alone: time against residual
    python -m curriculum.bench cradle     Newton's cradle by gap, and the forces in a tower
    python -m curriculum.bench soft       from MuJoCo's contact to lcp, on one line
    python -m curriculum.bench pile       time per step of 12 to 10,000 balls
    python -m curriculum.bench skip       same bytes with and without skips; what skipping saves
    python -m curriculum.bench draw       pages and figures again, from the results alone

Each writes its section of results.json, a page and figures into curriculum/bench/results. A run
that is stopped goes on where it was; --fresh begins anew. With --quick it takes seconds, measures
less, and writes to outputs/bench-quick, which nothing quotes. `python -m curriculum.readme` puts
the results into the README.
"""

import os
import sys

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from importlib import import_module
from pathlib import Path

from curriculum import measured
from curriculum.bench import problems
from curriculum.common.arguments import Parser, writable_folder
from curriculum.common.files import write_whole
from curriculum.common.stoppable import stoppable
from curriculum.reporting import listed

WHAT = ("accuracy", "solvers", "cradle", "soft", "pile", "skip")
HARNESS = ("engines.py", "contestants.py", "problems.py", "closed_form.py", "timing.py")
MODULES = {"pile": "piles", "skip": "skips"}
RESULTS = Path(__file__).resolve().parent / "results"  # the full runs, which are kept
QUICK = measured.ROOT / "outputs" / "bench-quick"  # the short ones, which are not
CELLS = measured.ROOT / "outputs" / "bench-cells"  # what a stopped run has done so far
PACKAGES = (
    "matplotlib",
    "mujoco",
    "pymunk",
    "box2d",
    "pyb2d3",
    "drake",
    "scipy",
    "quadprog",
    "numba",
    "rerun-sdk",
)


def module(what):
    """What measures a section."""
    return import_module(f"curriculum.bench.{MODULES.get(what, what)}")


def report(what):
    """What writes about it."""
    return import_module(f"curriculum.bench.reports.{MODULES.get(what, what)}")


def measure(what, args):
    """Measure one section and save it; returns it as read back.

    Raises RuntimeError when the measured code was changed while it was measured.
    """
    work = module(what)
    options = {"only": args.only} if args.only else {}
    cells, before = {}, hashes(work.CODE)
    if not args.quick:
        path = CELLS / f"{what}.jsonl"
        if args.fresh and path.exists():
            path.unlink()
        cells = measured.Cells(path, work.CODE, about=depends_on(work))
    section = work.measure(args.quick, cells=cells, **options)
    if hashes(work.CODE) != before:
        raise RuntimeError(f"{listed(work.CODE)} changed while {what} was measured")
    return measured.save(args.folder, what, section, work.COMMAND, work.CODE, PACKAGES)


def hashes(names):
    return {name: measured.code_hash(name) for name in names}


def depends_on(work):
    """What a cell depends on beside the measured code: the engines' versions, and how we measure."""
    ours = (f"{work.__name__.rpartition('.')[2]}.py", *HARNESS)
    return {
        "versions": measured.provenance((), PACKAGES)["versions"],
        "harness": hashes(f"curriculum/bench/{name}" for name in ours),
    }


def write(folder, what, section):
    """Write the page and the figures of one section; returns what could not be drawn, or None."""
    trouble, made = None, {f"{what}.md": report(what).page(section)}
    try:
        made |= report(what).figures(section)
    except ImportError as error:
        trouble = error
    for name, text in made.items():
        write_whole(str(folder / name), text)
    print(f"wrote {folder}: {', '.join(made)}")
    return trouble


def parse(argv):
    parser = Parser(prog="python -m curriculum.bench", description="Run time against error.")
    parser.add_argument("what", nargs="?", default="all", choices=("all", *WHAT, "draw"))
    parser.add_argument("--quick", action="store_true", help="reduced settings, in seconds, for CI")
    parser.add_argument(
        "--only", metavar="PROBLEM", help="accuracy: one problem, the rest is reused"
    )
    parser.add_argument("--fresh", action="store_true", help="forget what a stopped run has done")
    parser.add_argument(
        "--out", type=writable_folder, help="folder of results.json and what it gives"
    )
    args = parser.parse_args(argv)
    if args.only and args.what != "accuracy":
        parser.error("argument --only: allowed with accuracy only")
    if args.only and args.only not in problems.BY_NAME:
        parser.error(
            f"argument --only: given {args.only!r}; allowed: {', '.join(problems.BY_NAME)}"
        )
    args.folder = Path(args.out or (QUICK if args.quick else RESULTS))
    if args.what == "draw" and not measured.load(args.folder):
        parser.error(
            f"nothing to draw: {args.folder / measured.NAME} is missing; "
            "run python -m curriculum.bench"
        )
    return args


@stoppable(said="stopped; the same command goes on from here")
def main(argv=None):
    """Returns the exit status: 1 when figures could not be drawn."""
    args, trouble = parse(argv), None
    if args.what == "draw":
        sections = measured.load(args.folder)
        chosen = [what for what in WHAT if what in sections]
    else:
        chosen = WHAT if args.what == "all" else (args.what,)
    for what in chosen:
        try:
            section = sections[what] if args.what == "draw" else measure(what, args)
        except RuntimeError as error:
            print(f"nothing written: {error}", file=sys.stderr)
            return 1
        for goal in report(what).goals(section):
            print(f"{goal.verdict().strip('*'):12} {goal.wanted}: {goal.measured}")
        trouble = write(args.folder, what, section) or trouble
    if trouble:
        print(f"no figures: {trouble}", file=sys.stderr)
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
