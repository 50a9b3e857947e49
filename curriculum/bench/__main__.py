"""The benchmark's command line.

    python -m curriculum.bench            everything below, one after the other (15 minutes)
    python -m curriculum.bench accuracy   run time against error, on problems with a known answer
    python -m curriculum.bench pile       time a step of 12 to 10,000 balls, at equal depth
    python -m curriculum.bench skip       what whole processes take, and lcp's loops beside pymunk's
    python -m curriculum.bench draw       page and figures again, from the results alone

Each part writes its section of results.json, and the page and figures, into
curriculum/bench/results. With --quick it takes one or two minutes, measures little, and writes to
outputs/bench-quick, which nothing quotes.
"""

import json
import os
import sys
import time
from pathlib import Path

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from curriculum.commands import Parser, needs

with needs("bench"):
    from curriculum.bench import accuracy, piles, report, skips
    from curriculum.measured import results

PARTS = {
    "accuracy": accuracy.measure,
    "pile": piles.measure,
    "skip": skips.measure,
}
MADE_BY = {  # the modules of each section; what they import of bench/ is found
    "accuracy": ["curriculum/bench/accuracy.py"],
    "pile": ["curriculum/bench/piles.py"],
    "skip": ["curriculum/bench/skips.py", "contact.py"],  # which it times as whole processes
}
FULL = results.ROOT / results.FOLDERS["bench"]
QUICK = results.ROOT / "outputs" / "bench-quick"


def main(argv=None):
    """Returns the exit status: 1 where figures could not be drawn, 130 after Ctrl-C."""
    parser = Parser(prog="python -m curriculum.bench", description=__doc__)
    parser.add_argument("part", nargs="?", default="all", choices=("all", *PARTS, "draw"))
    parser.add_argument("--quick", action="store_true", help="reduced settings, for CI")
    parser.add_argument("--out", type=Path, help="a folder of your own, which nothing quotes")
    args = parser.parse_args(argv)
    folder = args.out or (QUICK if args.quick else FULL)
    try:
        for name in PARTS if args.part == "all" else {args.part} & set(PARTS):
            start, command = time.monotonic(), f"python -m curriculum.bench {name}"
            origin = results.origin(command, *MADE_BY[name], kept=folder == FULL)
            results.save(folder, name, PARTS[name](args.quick), origin)
            print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        sections = json.loads((folder / results.NAME).read_text("utf-8"))
        report.write(folder, sections)
        if folder == FULL:
            results.write_block("bench", report.readme(sections))
        for wanted, case, found, met in report.goals(sections):
            print(f"{'met   ' if met else 'MISSED'} {wanted}; {case}: {found}")
    except KeyboardInterrupt:
        print("stopped; what was finished is kept", file=sys.stderr)
        return 130
    except (ImportError, FileNotFoundError, ValueError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    print(f"wrote {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
