"""The stress test's command line.

    python -m curriculum.stress                         everything; writes curriculum/stress/results
    python -m curriculum.stress --quick                 under a minute, into outputs/stress-quick
    python -m curriculum.stress --scene 17              what every property says of one scene
    python -m curriculum.stress --scene small:0-299     of 300 small ones, to the first violation

Exit status 0: no violation; 1: violations; 2: bad command line, or code that is not committed.
"""

import sys
from functools import partial

from curriculum.commands import Parser, needs, number

with needs("dev"):
    from curriculum import parallel, stored
    from curriculum.stress import jobs, report


def chosen(text):
    """Return the jobs of one scene, or of a row of them."""
    first, _, last = text.removeprefix("small:").partition("-")
    first = number(int, 0, 1e9, first)
    last = number(int, first, 1e9, last) if last else first
    return jobs.scene_jobs(range(first, last + 1), small=text.startswith("small:"))


def some_scenes(todo):
    """Print what every property says of some scenes, to the first violation. Returns violations."""
    found = []
    for job in todo:
        found.append(jobs.run(job))
        if any(words for _, _, words in found[-1][1].values()):
            break
    judged, notes = jobs.added_up(found)
    for row in judged:
        say = f"{row['comparisons']} comparisons, at {row['share']:.1g} of the bound"
        print(f"{row['property']}: {say if row['judged'] else '-'}")
    for what in notes:
        print(f"met: {what}")
    wrong = [row for row in judged if row["judged"] and row["violations"]]
    print(*(f"VIOLATION: {row['property']}: {row['first']}" for row in wrong), sep="\n")
    return wrong


def everything(quick, workers, origin):
    """Run everything, or a hundredth, and write the report. Returns how many violations."""
    if not quick:
        with needs("bench"):
            import mujoco  # noqa: F401  # without it a section would judge nothing
    todo = jobs.all_jobs(quick).items()
    found = {name: parallel.run_jobs(jobs.run, each, name, workers) for name, each in todo}
    return report.write(found, origin, report.QUICK if quick else report.RESULTS)


def main(argv=None):
    """Print the violations. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.stress", description=__doc__)
    flag, count = parser.add_argument, partial(number, int, 1, 1e6)
    flag("--quick", action="store_true", help="about a hundredth, into outputs/stress-quick")
    flag("--draw", action="store_true", help="page and figure again, from the results alone")
    flag("--workers", type=count, metavar="N", help="processes (all cores)")
    flag("--scene", type=chosen, metavar="[small:]N[-N]", help="what all properties say of these")
    args = parser.parse_args(argv)
    if args.scene:
        return 1 if some_scenes(args.scene) else 0
    if args.draw:
        return 1 if report.draw(report.RESULTS) else 0
    command = parser.prog + " --quick" * args.quick
    try:
        origin = stored.origin(command, "curriculum/stress/jobs.py", kept=not args.quick)
    except ValueError as error:  # a tree that is not committed
        parser.error(error)
    return 1 if everything(args.quick, args.workers, origin) else 0


if __name__ == "__main__":
    with needs("dev"):
        sys.exit(main())
