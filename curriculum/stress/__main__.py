"""The stress test's command line.

    python -m curriculum.stress                         everything; writes curriculum/stress/results
    python -m curriculum.stress --quick                 under a minute, for CI; into outputs/stress-quick
    python -m curriculum.stress --small --first         small scenes alone, up to the first violation
    python -m curriculum.stress --scene small:17        what every property says of one scene

Exit status 0: no violation; 1: violations; 2: bad command line.
"""

import argparse
import os
import sys

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

import contact
from curriculum import pool
from curriculum.stress import jobs

SCENES, SMALL, QUICK, QUICK_SMALL = 10_000, 1_000, 60, 100


def parse(argv):
    """The checked command line."""
    parser = contact.Parser(prog="python -m curriculum.stress", description=__doc__)
    flag, number = parser.add_argument, contact.number(int, 1, 1e6)
    flag(
        "--quick", action="store_true", help="a hundredth of it, for CI; into outputs/stress-quick"
    )
    flag("--workers", type=number, metavar="N", help="processes (all cores)")
    flag("--scheduler", metavar="HOST:PORT", help="run on the workers of this dask scheduler")
    flag("--scenes", type=number, metavar="N", help=f"how many random scenes ({SCENES})")
    flag("--small", action="store_true", help="scenes of up to four balls alone; no report")
    flag("--first", action="store_true", help="with --small: one process, to the first violation")
    flag("--scene", type=scene, metavar="[small:]NUMBER", help="what all properties say of it")
    flag("--draw", action="store_true", help="README.md and figures again, from results.json")
    return parser.parse_args(argv)


def scene(text):
    """(number, small) of a scene."""
    kind, _, digits = text.rpartition(":")
    if kind not in ("", "small") or not digits.isdigit():
        raise argparse.ArgumentTypeError(f"given {text!r}; allowed: a number, or small:NUMBER")
    return int(digits), kind == "small"


def show_scene(chosen):
    """Print what every property says of one scene. Returns the exit status."""
    start, small = chosen
    found = jobs.judge_span((start, start + 1, small))
    for name, (judged, count, share) in found["properties"].items():
        print(f"{name}: {f'{count} comparisons, at {share:.1g} of the bound' if judged else '-'}")
    for what in found["notes"]:
        print(f"met: {what}")
    return show(found["violations"])


def show(violations):
    """Print the violations. Returns the exit status."""
    for place, name, words in violations:
        print(f"VIOLATION: {place}: {name}: {words}")
    return 1 if violations else 0


def small_scenes(args):
    """The properties on small scenes alone. Returns the exit status."""
    todo = jobs.scene_jobs(args.scenes or SMALL, small=True)
    if not args.first:
        found = pool.spread(jobs.run, todo, "small scenes", args.workers, args.scheduler)
        return show(jobs.added_up(found)["violations"])
    for job in todo:
        violations = jobs.run(job)["violations"]
        if violations:
            return show(violations[:1])
    return 0


def all_jobs(args):
    """{section: its jobs} of a full or quick run."""
    from curriculum.stress import extremes, maps, mujoco_match

    quick = args.quick
    return {
        "scenes": jobs.scene_jobs(args.scenes or (QUICK if quick else SCENES)),
        "small": jobs.scene_jobs(QUICK_SMALL if quick else SMALL, small=True),
        "maps": maps.map_jobs(quick),
        "extremes": list(extremes.extreme_jobs(quick)),
        "mujoco": mujoco_match.match_jobs(quick),
    }


def main(argv=None):
    """Returns the exit status."""
    args = parse(argv)
    if args.scene:
        return show_scene(args.scene)
    if args.small:
        return small_scenes(args)
    from curriculum.stress import report

    if args.draw:
        return report.draw()
    sections = all_jobs(args)
    todo = [(name, job) for name, given in sections.items() for job in given]
    found = pool.spread(jobs.run, [job for _, job in todo], "stress", args.workers, args.scheduler)
    results = {name: [] for name in sections}
    for (name, _), result in zip(todo, found):
        results[name].append(result)
    command = " ".join(["python -m curriculum.stress", *(sys.argv[1:] if argv is None else argv)])
    return show(report.write(results, command, report.QUICK if args.quick else report.RESULTS))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except OSError as error:  # a scheduler that does not answer, a folder that cannot be written
        sys.exit(f"python -m curriculum.stress: {error}")
