"""The stress test's command line.

    python -m curriculum.stress                         everything; writes curriculum/stress/results
    python -m curriculum.stress --quick                 under a minute, into outputs/stress-quick
    python -m curriculum.stress --scheduler HOST:PORT   on the workers of a dask scheduler
    python -m curriculum.stress --small 300             small scenes alone, to the first violation
    python -m curriculum.stress --scene small:17        what every property says of one scene

Exit status 0: no violation; 1: violations; 2: bad command line.
"""

import argparse
import os
import sys
from functools import partial

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

from curriculum.commands import needs

with needs("dev"):
    from contact import number
    from curriculum.run import pool
    from curriculum.stress import jobs


def parse(argv):
    """The checked command line."""
    parser = argparse.ArgumentParser(
        prog="python -m curriculum.stress",
        description=__doc__,
        usage=argparse.SUPPRESS,  # an error is one line then
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    flag, count = parser.add_argument, partial(number, int, 1, 1e6)
    flag("--quick", action="store_true", help="about a hundredth, into outputs/stress-quick")
    flag("--draw", action="store_true", help="page and figure again, from the results alone")
    flag("--workers", type=count, metavar="N", help="processes (all cores)")
    flag("--scheduler", metavar="HOST:PORT", help="run on the workers of this dask scheduler")
    flag("--small", type=count, metavar="N", help="small scenes alone, to the first violation")
    flag("--scene", type=scene, metavar="[small:]NUMBER", help="what all properties say of it")
    return parser.parse_args(argv)


def scene(text):
    """The job of one scene."""
    chosen = number(int, 0, 1e9, text.removeprefix("small:"))
    return jobs.scene_jobs([chosen], small=text.startswith("small:"))


def some_scenes(todo):
    """Print what every property says of some scenes, to the first violation. Returns violations."""
    found = []
    for job in todo:
        found.append(jobs.run(job))
        if any(words for _, _, words in found[-1][1].values()):
            break
    added = jobs.added_up(found)
    for name, (_, count, share) in added["properties"].items():
        print(f"{name}: {f'{count} comparisons, at {share:.1g} of the bound' if count else '-'}")
    for what in added["notes"]:
        print(f"met: {what}")
    return added["violations"]


def everything(args):
    """A full or quick run, and its report. Returns the violations."""
    from curriculum.measured import results
    from curriculum.stress import extremes, maps, mujoco_match, report

    command = "python -m curriculum.stress" + " --quick" * args.quick
    origins = {
        name: results.origin(command, *files, kept=not args.quick)
        for name, files in jobs.MADE_BY.items()
    }
    large, small = jobs.QUICK if args.quick else jobs.FULL
    sections = {
        "scenes": jobs.scene_jobs(range(large)) + jobs.scene_jobs(range(small), small=True),
        "maps": maps.map_jobs(args.quick),
        "extremes": extremes.extreme_jobs(args.quick),
        "mujoco": mujoco_match.match_jobs(args.quick),
    }
    found = {
        name: pool.run_jobs(jobs.run, todo, name, args.workers, args.scheduler)
        for name, todo in sections.items()
    }
    return report.write(found, origins, report.QUICK if args.quick else report.RESULTS)


def main(argv=None):
    """Print the violations. Returns the exit status."""
    args = parse(argv)
    if args.draw:
        from curriculum.stress import report

        report.draw(report.RESULTS, report.results.load("stress"))
        return 0
    if args.scene or args.small:
        violations = some_scenes(args.scene or jobs.scene_jobs(range(args.small), small=True))
    else:
        violations = everything(args)
    for violation in violations:
        print("VIOLATION:", ": ".join(violation))
    return 1 if violations else 0


if __name__ == "__main__":
    try:
        with needs("dev"):
            sys.exit(main())
    except (ImportError, OSError, ValueError) as error:  # no answer, a tree not committed
        sys.exit(f"python -m curriculum.stress: {error}")
