"""The stress test's command line.

    python -m curriculum.stress                     everything; writes curriculum/stress/results
    python -m curriculum.stress --quick             under a minute, for CI; into outputs/stress-quick
    python -m curriculum.stress --workers 8         on so many processes (default: one a core)
    python -m curriculum.stress --dask HOST:PORT    on a running Dask scheduler and its workers
    python -m curriculum.stress --only 'tower*'     jobs whose names match; prints, writes nothing
    python -m curriculum.stress --case FILE         what a violation names: runs it again
    python -m curriculum.stress --case scene:1234   one of the random scenes; board:12 of the boards
    python -m curriculum.stress --draw              report.md and figures again, from results.json

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

from curriculum import measured
from curriculum.common.arguments import Parser, number, writable_folder
from curriculum.common.stoppable import stoppable
from curriculum.stress import extremes, jobs, maps, report, runner, samebytes, scenes, under_test

RESULTS = under_test.ROOT / "curriculum" / "stress" / "results"
QUICK = under_test.ROOT / "outputs" / "stress-quick"
WORK = under_test.ROOT / "outputs" / "stress-work"
SCENES, QUICK_SCENES, BATCH = 10_000, 100, 20
BOARDS = 0.1  # for every random scene
SEEDS, QUICK_SEEDS, SEEDS_A_JOB = 1000, 50, 50


def all_jobs(quick, count):
    """Every job of a full or quick run, longest kinds first."""
    seeds = QUICK_SEEDS if quick else SEEDS
    return [
        *samebytes.byte_jobs(quick, {} if quick else samebytes.pythons_at_hand()),
        *extremes.extreme_jobs(quick),
        *batches("boards", int(BOARDS * count)),
        *batches("scenes", count),
        *maps.map_jobs(maps.QUICK if quick else maps.FULL),
        *(
            jobs.job(
                "seeds",
                f"{scene}, seeds {start} to {start + SEEDS_A_JOB - 1}",
                scene=scene,
                start=start,
                stop=start + SEEDS_A_JOB,
            )
            for scene in ("drop", "stack")
            for start in range(0, seeds, SEEDS_A_JOB)
        ),
    ]


def batches(kind, count):
    """Jobs on the random scenes of a kind, numbered 0 to count - 1, BATCH to a job."""
    spans = [(start, min(start + BATCH, count)) for start in range(0, count, BATCH)]
    return [
        jobs.job(kind, f"{kind} {start} to {stop - 1}", start=start, stop=stop)
        for start, stop in spans
    ]


def read_case(text):
    """The job that --case names. Raises ValueError, OSError or KeyError with what is wrong."""
    word, _, digits = text.partition(":")
    numbered = {"scene": scenes.numbered_spec, "board": scenes.board_spec}.get(word)
    if numbered:
        return jobs.job("scene", text, spec=numbered(int(digits)))
    with open(text, encoding="utf-8") as file:
        case = json.load(file)
    if case["kind"] not in jobs.KINDS:
        raise ValueError(f"kind {case['kind']!r}; allowed: {', '.join(jobs.KINDS)}")
    return case


def show(results, everything=False):
    """Print the rows that are not as expected, or all of them."""
    for job, result in results:
        for row in result["rows"]:
            if everything or row["status"] in report.BAD:
                print(
                    f"{row['status']}: {job['name']}: {row['at']}\n"
                    f"    expected {row['expected']}\n    got      {row['got']}"
                )


def parse(argv):
    """The checked command line, with the jobs it asks for."""
    parser = Parser(prog="python -m curriculum.stress", description="Where each model breaks.")
    flag = parser.add_argument
    flag("--quick", action="store_true", help="reduced settings, under a minute, for CI")
    flag("--workers", type=number(int, low=0), help="processes (one a core); 0: all in this one")
    flag("--dask", metavar="ADDRESS", help="of a running scheduler; needs dask[distributed]")
    flag(
        "--scenes",
        type=number(int, low=0),
        help=f"random scenes ({SCENES}; with --quick {QUICK_SCENES})",
    )
    flag("--only", metavar="GLOB", action="append", help="run the jobs whose names match")
    flag("--case", metavar="FILE", help="a case file, scene:NUMBER or board:NUMBER")
    flag("--draw", action="store_true", help="only write report.md and figures again")
    flag("--fresh", action="store_true", help="forget what earlier runs finished")
    flag("--out", type=writable_folder, help="folder of report.md, results.json and the figures")
    args = parser.parse_args(argv)
    try:
        args.jobs = [read_case(args.case)] if args.case else None
    except (OSError, ValueError, KeyError, TypeError) as error:
        parser.error(
            f"argument --case: given {args.case!r}, but {error}; allowed: a case file, "
            "scene:NUMBER or board:NUMBER"
        )
    args.out = args.out or (QUICK if args.quick else RESULTS)
    if args.jobs is None:
        count = args.scenes if args.scenes is not None else QUICK_SCENES if args.quick else SCENES
        args.jobs = chosen(parser, args.only, all_jobs(args.quick, count))
    return args


def chosen(parser, globs, todo):
    """The jobs whose names match one of `globs`; all without any."""
    found = [
        job
        for job in todo
        if globs is None or any(fnmatch.fnmatch(job["name"], glob) for glob in globs)
    ]
    if not found:
        parser.error(
            f"argument --only: given {globs}, which no job's name matches; names look "
            "like 'tower_rest_lcp', 'scenes 0 to 19', 'penalty k=1e+04 c=80'"
        )
    return found


@stoppable(said="stopped; the same command goes on from here")
def main(argv=None):
    """Returns the exit status."""
    args = parse(argv)
    if args.draw:
        report.redraw(measured.load(args.out), args.out)
        return 0
    if args.case or args.only:
        results = runner.run_all(args.jobs, 0 if args.case else args.workers, args.dask)
        show(results, everything=True)
    else:
        path = WORK / f"finished-{under_test.code_hash()}.jsonl"
        if args.fresh:
            path.unlink(missing_ok=True)
        results = runner.run_all(args.jobs, args.workers, args.dask, measured.Cells(path))
        given = sys.argv[1:] if argv is None else argv
        report.write(
            results, args.out, " ".join(["python -m curriculum.stress", *given]), WORK / "cases"
        )
        show(results)
        print(f"report: {report.shown(os.path.join(args.out, 'report.md'))}")
    count = report.summary(results)
    print(", ".join(f"{value:,} {name}" for name, value in count.items()))
    return 1 if count["violations"] + count["died"] else 0


if __name__ == "__main__":
    sys.exit(main())
