"""The stress test's command line.

    python -m curriculum.stress                     everything; writes curriculum/stress/results
    python -m curriculum.stress --quick             under a minute, for CI; writes outputs/stress-quick
    python -m curriculum.stress --workers 8         on so many processes (default: one a core)
    python -m curriculum.stress --dask HOST:PORT    on a running Dask cluster (pip install -e '.[stress]')
    python -m curriculum.stress --only 'tower*'     the jobs whose names match; prints, writes nothing
    python -m curriculum.stress --case FILE         what a violation names: runs it again
    python -m curriculum.stress --case scene:1234   one of the random scenes

Exit status 0: no violation; 1: violations, or a job died; 2: bad command line. A run that was
interrupted goes on where it stopped (--fresh: from the beginning); what is finished is kept in
outputs/stress-work, for as long as neither the code nor Python nor numpy changes.
"""

import os
import sys

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

import fnmatch
import json

from curriculum.common.arguments import Parser, number, writable_folder
from curriculum.stress import (
    engine,
    extremes,
    invariants,
    jobs,
    maps,
    report,
    runner,
    samebytes,
    scenes,
)

RESULTS = engine.ROOT / "curriculum" / "stress" / "results"
QUICK = engine.ROOT / "outputs" / "stress-quick"
WORK = engine.ROOT / "outputs" / "stress-work"
SCENES, QUICK_SCENES, BATCH = 10_000, 120, 20


def all_jobs(quick, count):
    """Every job of a full or quick run, longest kinds first."""
    seeds = 50 if quick else 1000
    step = 25 if quick else 50
    return [
        *samebytes.byte_jobs(quick, {} if quick else samebytes.pythons_at_hand()),
        *extremes.extreme_jobs(quick),
        *(
            jobs.job(
                "scenes",
                f"scenes {start} to {min(start + BATCH, count) - 1}",
                start=start,
                stop=min(start + BATCH, count),
            )
            for start in range(0, count, BATCH)
        ),
        *maps.map_jobs(maps.QUICK if quick else maps.FULL),
        *(
            jobs.job(
                "seeds",
                f"{scene}, seeds {start} to {start + step - 1}",
                scene=scene,
                start=start,
                stop=start + step,
            )
            for scene in ("drop", "stack")
            for start in range(0, seeds, step)
        ),
    ]


def read_case(text):
    """The job that --case names. Raises ValueError, OSError or KeyError with what is wrong."""
    if text.startswith("scene:"):
        return jobs.job("scene", text, spec=scenes.numbered_spec(int(text[6:])))
    with open(text, encoding="utf-8") as file:
        case = json.load(file)
    if "kind" not in case:  # a spec alone
        return jobs.job("scene", text, spec=case)
    if case["kind"] not in jobs.KINDS:
        raise ValueError(f"kind {case['kind']!r}; allowed: {', '.join(jobs.KINDS)}")
    return case


def show(results, everything=False):
    """Print the rows that are not as expected, or all of them."""
    for job, result in results:
        for row in result["rows"]:
            if everything or row["status"] in report.BAD:
                print(
                    f"{row['status']}: {job['name']}: {row['at']}\n    expected {row['expected']}\n    got      {row['got']}"
                )


def parse(argv):
    parser = Parser(prog="python -m curriculum.stress", description="Where each model breaks.")
    parser.add_argument(
        "--quick", action="store_true", help="reduced settings, under a minute, for CI"
    )
    parser.add_argument(
        "--workers",
        type=number(int, low=0),
        help="processes (default: one a core); 0: none, all in this one",
    )
    parser.add_argument("--dask", metavar="ADDRESS", help="scheduler of a Dask cluster to run on")
    parser.add_argument(
        "--scenes",
        type=number(int, low=0),
        help=f"random scenes ({SCENES}; with --quick {QUICK_SCENES})",
    )
    parser.add_argument(
        "--only",
        metavar="GLOB",
        action="append",
        help="run the jobs whose names match, print, write no report",
    )
    parser.add_argument("--case", metavar="FILE", help="a case file, or scene:NUMBER")
    parser.add_argument("--fresh", action="store_true", help="forget what earlier runs finished")
    parser.add_argument(
        "--out", type=writable_folder, help="folder of report.md, results.json and the figures"
    )
    args = parser.parse_args(argv)
    try:
        args.jobs = [read_case(args.case)] if args.case else None
    except (OSError, ValueError, KeyError, TypeError) as error:
        parser.error(
            f"argument --case: given {args.case!r}, but {error}; allowed: a case file or scene:NUMBER"
        )
    if args.jobs is None:
        count = args.scenes if args.scenes is not None else QUICK_SCENES if args.quick else SCENES
        args.jobs = all_jobs(args.quick, count)
        if args.only:
            args.jobs = [
                job
                for job in args.jobs
                if any(fnmatch.fnmatch(job["name"], glob) for glob in args.only)
            ]
            if not args.jobs:
                parser.error(
                    f"argument --only: given {args.only}, which no job's name matches; names look like "
                    "'tower_rest_lcp', 'scenes 0 to 19', 'penalty k=1e+04 c=80'"
                )
    return args


def main(argv=None):
    """Returns the exit status."""
    args = parse(argv)
    if args.case or args.only:
        results = runner.run_all(args.jobs, 0 if args.case else args.workers, args.dask)
        show(results, everything=True)
    else:
        memory = runner.Memory(WORK, engine.code_hash())
        if args.fresh:
            memory.forget()
        results = runner.run_all(args.jobs, args.workers, args.dask, memory)
        folder = args.out or (QUICK if args.quick else RESULTS)
        given = sys.argv[1:] if argv is None else argv
        report.write(
            results, folder, " ".join(["python -m curriculum.stress", *given]), WORK / "cases"
        )
        show(results)
        print(f"report: {report.shown(os.path.join(folder, 'report.md'))}")
    count = report.summary(results)
    print(", ".join(f"{value:,} {name}" for name, value in count.items()))
    return 1 if count["violations"] + count["died"] else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("stopped; the same command goes on from here", file=sys.stderr)
        sys.exit(130)
