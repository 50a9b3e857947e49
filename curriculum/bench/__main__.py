"""The benchmark's command line.

    python -m curriculum.bench            run time against error, all problems and methods
    python -m curriculum.bench skip       same bytes with and without skips; what skipping saves
    python -m curriculum.bench pile       time per step of piles of 100, 1,000 and 10,000 balls
    python -m curriculum.bench draw       pages and figures again, from results.json alone
    python -m curriculum.bench readme     the README's generated blocks again, from results.json
    python -m curriculum.bench readme --check     or only say whether they are up to date

The first three write results.json, a page and figures into curriculum/bench/results. With --quick
they take seconds, measure less, and write to outputs/bench-quick, which nothing quotes.
"""

import os
import sys

for _library in ("OMP", "OPENBLAS", "MKL"):     # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from pathlib import Path

from curriculum.bench import (accuracy, accuracy_page, figures, piles, piles_page, readme, skips,
                              skips_page, store)
from curriculum.common.arguments import Parser, writable_folder
from curriculum.common.files import write_whole

MEASURE = {"error": accuracy, "skip": skips, "pile": piles}
PAGES = {"error": accuracy_page, "skip": skips_page, "pile": piles_page}


def pages(sections):
    """{file name: text} of every page that the sections give."""
    return {f"{name}.md": PAGES[name].page(section) for name, section in sections.items()}


def pictures(sections):
    """{file name: text} of every figure that the sections give. ImportError without matplotlib."""
    made = {}
    for name, section in sections.items():
        if name == "error":
            for problem in section["problems"]:
                made[f"error-{problem}.svg"] = figures.error_figure(section, problem)
        elif name == "skip":
            made["skip.svg"] = figures.skip_figure(section)
        else:
            made["pile.svg"] = figures.pile_figure(section)
    return made


def main(argv=None):
    """Returns the exit status."""
    parser = Parser(prog="python -m curriculum.bench", description="Run time against error.")
    parser.add_argument("what", nargs="?", default="error", choices=(*MEASURE, "draw", "readme"))
    parser.add_argument("--quick", action="store_true", help="reduced settings, in seconds, for CI")
    parser.add_argument("--check", action="store_true", help="readme: only look, exit 1 if stale")
    parser.add_argument("--out", type=writable_folder, help="folder of results.json and what it gives")
    args = parser.parse_args(argv)
    if args.check and args.what != "readme":
        parser.error("argument --check: allowed with readme only")
    folder = Path(args.out or (store.QUICK if args.quick else store.RESULTS))
    if args.what == "readme":
        return readme.main(folder, args.check)
    if args.what == "draw":
        sections = store.load(folder)
        if not sections:
            parser.error(f"nothing to draw: {folder / store.NAME} is missing; "
                         "run python -m curriculum.bench")
    else:
        measured = store.save(folder, args.what, MEASURE[args.what].measure(args.quick))[args.what]
        sections = {args.what: measured}
        for goal in PAGES[args.what].goals(measured):
            print(f"{goal.verdict().strip('*'):12} {goal.wanted}: {goal.measured}")
    made, trouble = pages(sections), None
    try:
        made |= pictures(sections)
    except ImportError as error:
        trouble = error
    for name, text in made.items():
        write_whole(str(folder / name), text)
    print(f"wrote {folder}: {', '.join([store.NAME, *made])}")
    if trouble:
        print(f"no figures: {trouble}", file=sys.stderr)
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
