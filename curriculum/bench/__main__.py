"""The benchmark's command line.

    python -m curriculum.bench              everything below, one after the other (25 minutes)
    python -m curriculum.bench points       run time against error, where the answer is known
    python -m curriculum.bench piles        time a step of 12 to 10,000 balls, at equal depth
    python -m curriculum.bench processes    what whole processes take
    python -m curriculum.bench draw         page and figures again, from the results alone

Results are CSV files in curriculum/bench/results. --only rapier, or --only "lcp iters=20", measures
the settings whose name contains these words; all other rows stay. With --quick it takes a minute or
two, measures little, and writes to outputs/bench-quick, which nothing quotes.
"""

import os
import subprocess
import sys
from operator import itemgetter

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from curriculum import stored
from curriculum.commands import Parser, needs, write_json

with needs("bench"):
    from curriculum.bench import engines, measure, report

FULL, QUICK = stored.ROOT / stored.FOLDERS["bench"], stored.ROOT / "outputs" / "bench-quick"
CODE = "curriculum/bench/measure.py", "curriculum/bench/settings.csv"  # and what they import
who = itemgetter("engine", "setting")  # of a row


def take(part, quick, only, folder):
    """Measure a part, or the settings of it that are named, and write its file."""
    order, groups = [c[:2] for c in engines.EVERYBODY], list(report.problems.BY_NAME)
    wanted = [c[:2] for c in engines.EVERYBODY if not only or only in c.name]
    if not wanted:
        raise ValueError(f"--only {only}: no setting in settings.csv has this name")
    command = f"python -m curriculum.bench {part}" + f" --only {only!r}" * bool(only)
    code = ("contact.py", "curriculum/bench/commands.csv") if part == "processes" else ()
    about = stored.origin(command, *CODE, *code, kept=folder == FULL)
    about["versions"] |= engines.versions()
    sections, made = stored.load(folder)
    stay = [row for row in sections.get(part, ()) if only and who(row) in set(order) - set(wanted)]
    found = measure.PARTS[part](quick, lambda c: c[:2] in wanted, stay)
    if not found:
        raise ValueError(f"{part}: nothing of {only or 'it'} runs here")

    def place(row):  # that it has in a whole measurement
        return row.get("bodies") or groups.index(row["problem"]), order.index(who(row))

    rows = sorted(stay + found, key=place) if only else found
    if not only:
        made = {key: value for key, value in made.items() if key.split()[0] != part}
    stored.save(folder / f"{part}.csv", rows)
    write_json(folder / "made.json", made | {f"{part} {only or ''}".strip(): about})


def main(argv=None):
    parser = Parser(prog="python -m curriculum.bench", description=__doc__)
    parser.add_argument("part", nargs="?", default="all", choices=("all", *measure.PARTS, "draw"))
    parser.add_argument("--only", help="settings whose name contains this")
    parser.add_argument("--quick", action="store_true", help="reduced settings, for CI")
    args = parser.parse_args(argv)
    folder = QUICK if args.quick else FULL
    parts = [name for name in measure.PARTS if args.part in ("all", name)]
    if args.only and "processes" in parts:
        parts.remove("processes")  # which are no settings
    try:
        if parts:  # or loops would be compiled while they are timed
            subprocess.run([sys.executable, "-m", "curriculum.lesson"], cwd=stored.ROOT, check=True)
        for name in parts:
            take(name, args.quick, args.only, folder)
        sections, made = stored.load(folder)
        report.write(folder, sections, made)
        if folder == FULL:
            stored.write_block("bench", report.written("readme.md", sections, made))
    except (ImportError, FileNotFoundError, ValueError) as error:
        parser.error(error)
    print(f"wrote {folder}")


if __name__ == "__main__":
    main()
