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
import sys
import time

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from curriculum import stored
from curriculum.commands import Parser, needs, write_json

with needs("bench"):
    from curriculum.bench import engines, measure, report, settings

FULL, QUICK = stored.ROOT / stored.FOLDERS["bench"], stored.ROOT / "outputs" / "bench-quick"
CODE = "curriculum/bench/measure.py", "curriculum/bench/settings.csv"  # and what they import


def load(folder):
    """{part: rows} of a results folder, and its made.json."""
    tables, made = stored.load(folder)
    for row in (*tables.get("points", ()), *tables.get("piles", ())):
        row["setting"] = row["setting"] or ""
    return tables, made


def take(part, quick, only, folder):
    """Measure a part, or the settings of it that are named, and write its file."""
    wanted = [c.name for c in settings.EVERYBODY if not only or only in c.name]
    if not wanted:
        raise ValueError(f"--only {only}: no setting in settings.csv has this name")
    command = f"python -m curriculum.bench {part}" + f" --only {only!r}" * bool(only)
    about = stored.origin(command, *CODE, *["contact.py"] * (part == "processes"),
                           kept=folder == FULL)  # fmt: skip
    about["versions"] |= engines.versions()
    sections, made = load(folder)
    others = [c.name for c in settings.EVERYBODY if c.name not in wanted]
    stay = [row for row in sections.get(part, ()) if only and name_of(row) in others]
    found = measure.PARTS[part](quick, lambda c: c.name in wanted, stay)
    if not found:
        raise ValueError(f"{part}: nothing of {only or 'it'} runs here")
    stored.save(folder / f"{part}.csv", in_order(part, stay + found))
    if not only:
        made = {key: value for key, value in made.items() if key.split()[0] != part}
    write_json(folder / "made.json", made | {f"{part} {only or ''}".strip(): about})


def in_order(part, rows):
    """Rows as a whole measurement has them: by problem or size, then as in settings.csv."""
    if part == "processes":
        return rows
    order = [c.name for c in settings.EVERYBODY]
    groups = list(report.problems.BY_NAME)
    return sorted(rows, key=lambda row: (
        row["bodies"] if part == "piles" else groups.index(row["problem"]),
        order.index(name_of(row))))  # fmt: skip


def name_of(row):
    return f"{row['engine']} {row['setting']}".strip()


def main(argv=None):
    """Returns the exit status: 1 where figures could not be drawn."""
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
        for name in parts:
            start = time.monotonic()
            take(name, args.quick, args.only, folder)
            print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
        sections, made = load(folder)
        report.write(folder, sections, made)
        if folder == FULL:
            stored.write_block("bench", report.written("readme.md", sections, made))
    except (ImportError, FileNotFoundError, ValueError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    print(f"wrote {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
