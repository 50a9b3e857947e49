"""The benchmark's command line.

    python -m curriculum.bench            everything below, one after the other (20 minutes)
    python -m curriculum.bench accuracy   run time against error, on problems with a known answer
    python -m curriculum.bench pile       time a step of 12 to 10,000 balls, at equal depth
    python -m curriculum.bench skip       what whole processes take
    python -m curriculum.bench draw       page and figures again, from the results alone

Each part writes its section of results.json, and the page and figures, into
curriculum/bench/results. With --quick it takes one or two minutes, measures little, and writes to
outputs/bench-quick, which nothing quotes.
"""

import json
import os
import sys
import time

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from curriculum.commands import Parser, needs

with needs("bench"):
    from curriculum.bench import accuracy, piles, report, skips
    from curriculum.measured import results

PARTS = {"accuracy": accuracy, "pile": piles, "skip": skips}
FULL = results.ROOT / results.FOLDERS["bench"]
QUICK = results.ROOT / "outputs" / "bench-quick"


def made_by(part):
    """Files of a section; what they import of bench/ is found. `skip` times contact.py whole."""
    return [PARTS[part].__name__.replace(".", "/") + ".py"] + ["contact.py"] * (part == "skip")


def main(argv=None):
    """Returns the exit status: 1 where figures could not be drawn."""
    parser = Parser(prog="python -m curriculum.bench", description=__doc__)
    parser.add_argument("part", nargs="?", default="all", choices=("all", *PARTS, "draw"))
    parser.add_argument("--quick", action="store_true", help="reduced settings, for CI")
    args = parser.parse_args(argv)
    folder = QUICK if args.quick else FULL
    try:
        for name in PARTS if args.part == "all" else {args.part} & set(PARTS):
            start, command = time.monotonic(), f"python -m curriculum.bench {name}"
            origin = results.origin(command, *made_by(name), kept=folder == FULL)
            results.save(folder, name, PARTS[name].measure(args.quick), origin)
            print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        sections = json.loads((folder / results.NAME).read_text("utf-8"))
        report.write(folder, sections)
        if folder == FULL:
            results.write_block("bench", report.readme(sections))
    except (ImportError, FileNotFoundError, ValueError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    print(f"wrote {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
