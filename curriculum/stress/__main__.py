"""The stress test's command line.

    python -m curriculum.stress                     everything; writes curriculum/stress/results
    python -m curriculum.stress --quick             under a minute, into outputs/stress-quick
    python -m curriculum.stress "small scene 17"    what is checked there; or "heap 223"

Exit status 0: no violation; 1: violations; 2: bad command line, or code that is not committed.
"""

import sys

from curriculum.commands import Parser, needs

with needs("dev"):
    from curriculum import parallel, stored
    from curriculum.stress import jobs, report


def main(argv=None):
    """Print the violations. Returns the exit status."""
    parser = Parser(prog="python -m curriculum.stress", description=__doc__)
    flag = parser.add_argument
    flag("place", nargs="?", help="the only scene, heap or row of the map to check")
    flag("--quick", action="store_true", help="about a hundredth, into outputs/stress-quick")
    flag("--draw", action="store_true", help="page and figure again, from the results alone")
    args = parser.parse_args(argv)
    if args.place:
        every = {job[0]: job for each in jobs.all_jobs(quick=False).values() for job in each}
        if args.place not in every:
            parser.error(f"given {args.place!r}; allowed: {', '.join(list(every)[::3000])}, ...")
        rows = [row for row in jobs.added_up([jobs.run(every[args.place])])[0] if row["judged"]]
        print(*rows, sep="\n")
        return 1 if any(row["violations"] for row in rows) else 0
    if args.draw:
        return 1 if report.draw(report.RESULTS) else 0
    command = parser.prog + " --quick" * args.quick
    try:
        origin = stored.origin(command, "curriculum/stress/jobs.py", kept=not args.quick)
    except ValueError as error:  # a tree that is not committed
        parser.error(error)
    todo = jobs.all_jobs(args.quick).items()
    found = {name: parallel.run_jobs(jobs.run, each, name) for name, each in todo}
    return 1 if report.write(found, origin, report.QUICK if args.quick else report.RESULTS) else 0


if __name__ == "__main__":
    with needs("dev"):
        sys.exit(main())
