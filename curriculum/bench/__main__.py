"""The benchmark's command line.

    python -m curriculum.bench              everything below but try (35 minutes)
    python -m curriculum.bench points       run time against error, where the answer is known
    python -m curriculum.bench piles        time a step of 12 to 10,000 balls, at equal depth
    python -m curriculum.bench collapse     depth against time of a heap of 216 (SimBenchmark's 666)
    python -m curriculum.bench processes    what whole processes take; --tier cpu-laptop enters
                                            contact.py's in wallclock.csv
    python -m curriculum.bench draw         page and figures again, from the results alone
    python -m curriculum.bench try bounce exact
                                            error and time of one setting of one problem, now and
                                            here; or depth and time of a pile: try 1000 "lcp iters=4
                                            baumgarte=1" --substeps 4

Results are CSV files in curriculum/bench/results. With --quick it takes a minute or two, measures
little, and writes to outputs/bench-quick, which nothing quotes.
"""

import subprocess
import sys

import contact
from curriculum import stored
from curriculum.commands import Parser, needs, write_json

with needs("bench"):
    from curriculum.bench import engines, measure, problems, report

FULL, QUICK = stored.ROOT / stored.FOLDERS["bench"], stored.ROOT / "outputs" / "bench-quick"
CODE = "curriculum/bench/measure.py", "curriculum/bench/settings.csv"  # and what they import


def take(part, quick, folder, tier=None):
    """Measure a part and write its file."""
    code = ("contact.py", "curriculum/bench/commands.csv") if part == "processes" else ()
    about = stored.origin(f"python -m curriculum.bench {part}", *CODE, *code, kept=folder == FULL)
    rows, made = measure.PARTS[part](quick), stored.load(folder)[1]
    if tier and part == "processes" and folder == FULL:
        stored.enter(tier, about, rows[0]["seconds"])
    stored.save(folder / f"{part}.csv", rows)
    made = {name: made[name] for name in measure.PARTS if name in made}
    write_json(folder / "made.json", made | {part: about})


def try_one(problem, setting, substeps):
    """Measure one setting of one problem, or of a pile of so many balls; say it in a line."""
    c, sizes = engines.BY_NAME.get(setting), [*measure.SIZES, *problems.BY_NAME]
    if c is None:
        raise ValueError(f"try: given setting {setting!r}; allowed: {', '.join(engines.BY_NAME)}")
    if problem not in map(str, sizes):
        raise ValueError(f"try: given problem {problem!r}; allowed: {', '.join(map(str, sizes))}")
    if problem.isdecimal():
        pile, row = measure.settle((int(problem), c, substeps, None))
        step = measure.time_of_step((pile, c, substeps, *measure.TIMED))
        rest = "at rest" if row["at_rest"] else "not at rest"
        depth = f"{contact.format_number(row['mean_depth'])} r deep in the mean"
        return f"{problem} balls by {setting}: {rest}, {depth}, {step:.3g} µs of CPU a step"
    about = problems.BY_NAME[problem]
    job = problem, setting, measure.DT, substeps, about.starts
    row, time = measure.errors_of(job), measure.time_of(job)
    error = "the reference" if row["error"] is None else f"error {row['error']:.2g} r"
    return f"{about.title}, by {setting}: {error} (median of {about.starts}), {time:.3g} ms of CPU"


def main(argv=None):
    parser = Parser(prog="python -m curriculum.bench", description=__doc__)
    allowed = "all", *measure.PARTS, "draw", "try"
    parser.add_argument("part", nargs="?", default="all", choices=allowed)
    parser.add_argument("what", nargs="*", help="of try: a problem or a number of balls; a setting")
    parser.add_argument("--substeps", type=int, default=1, help="of try: in 2 ms (1)")
    parser.add_argument("--tier", metavar="NAME", help="what the ledger calls this machine")
    parser.add_argument("--quick", action="store_true", help="reduced settings, for CI")
    args = parser.parse_args(argv)
    folder = QUICK if args.quick else FULL
    parts = [part for part in measure.PARTS if args.part in ("all", part)]
    try:
        if len(args.what) != (2 if args.part == "try" else 0):
            raise ValueError(f"{args.part}: given {args.what}; try takes a problem and a setting")
        if args.part == "try":
            return print(try_one(*args.what, args.substeps))
        if parts:  # or loops would be compiled while they are timed
            compile_all = [sys.executable, "-m", "curriculum.compiled"]
            subprocess.run(compile_all, cwd=stored.ROOT, check=True)
        for part in parts:
            take(part, args.quick, folder, args.tier)
        sections, made = stored.load(folder)
        report.write(folder, sections, made)
        if folder == FULL:
            stored.write_block("bench", report.written("readme.md", sections, made))
    except (ImportError, FileNotFoundError, ValueError) as error:
        parser.error(error)
    print(f"wrote {folder}")


if __name__ == "__main__":
    main()
