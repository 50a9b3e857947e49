"""The benchmark's command line.

    python -m curriculum.bench              everything below, one after the other (25 minutes)
    python -m curriculum.bench accuracy     run time against error, where the answer is known
    python -m curriculum.bench piles        time a step of 12 to 10,000 balls, at equal depth
    python -m curriculum.bench processes    what whole processes take
    python -m curriculum.bench draw         page and figures again, from the results alone

Results are CSV files in curriculum/bench/results. --only rapier, or --only "lcp iters=20", measures
the settings whose name contains these words; all other rows stay. With --quick it takes a minute or
two, measures little, and writes to outputs/bench-quick, which nothing quotes.
"""

import csv
import io
import json
import os
import sys
import time

for _library in ("OMP", "OPENBLAS", "MKL"):  # one thread each; said before numpy is loaded
    os.environ[f"{_library}_NUM_THREADS"] = "1"

from curriculum.commands import Parser, needs, write_json, write_whole

with needs("bench"):
    from curriculum.bench import engines, measure, report, settings
    from curriculum.measured import results

FILES = {"accuracy": "points.csv", "piles": "piles.csv", "processes": "processes.csv"}
FULL = results.ROOT / results.FOLDERS["bench"]
QUICK = results.ROOT / "outputs" / "bench-quick"
CODE = "curriculum/bench/measure.py"  # what it imports is found


def load(folder):
    """{part: rows} of a results folder, and its made.json; numbers are numbers, "" is None."""
    sections = {}
    for part, name in FILES.items():
        if (folder / name).exists():
            with (folder / name).open(encoding="utf-8", newline="") as file:
                sections[part] = [{k: value_of(k, v) for k, v in row.items()}
                                  for row in csv.DictReader(file)]  # fmt: skip
    made = folder / "made.json"
    return sections, json.loads(made.read_text("utf-8")) if made.exists() else {}


def value_of(column, text):
    """A cell of a CSV file: words in three columns, else a number, or None."""
    if column in ("problem", "engine", "setting", "process"):
        return text
    number = float(text) if text else None
    return int(number) if number is not None and number.is_integer() else number


def save(path, rows):
    """Rows as CSV, whole or not at all; floats with five digits, None and NaN empty."""
    out = io.StringIO()
    writer = csv.DictWriter(out, rows[0], lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({k: f"{v:.5g}" if isinstance(v, float) and v == v else
                         "" if v != v or v is None else v for k, v in row.items()})  # fmt: skip
    write_whole(path, out.getvalue())


def take(part, quick, only, folder):
    """Measure a part, or the settings of it that are named, and write its file."""
    wanted = [c.name for c in settings.EVERYBODY if not only or only in c.name]
    if not wanted:
        raise ValueError(f"--only {only}: no setting in settings.csv has this name")
    command = f"python -m curriculum.bench {part}" + f" --only {only!r}" * bool(only)
    about = results.origin(command, CODE, *["contact.py"] * (part == "processes"),
                           kept=folder == FULL)  # fmt: skip
    about["versions"] |= engines.versions()
    sections, made = load(folder)
    others = [c.name for c in settings.EVERYBODY if c.name not in wanted]
    stay = [row for row in sections.get(part, ()) if only and name_of(row) in others]
    found = measure.PARTS[part](quick, lambda c: c.name in wanted, stay)
    if not found:
        raise ValueError(f"{part}: nothing of {only or 'it'} runs here")
    save(folder / FILES[part], in_order(part, stay + found))
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
            results.write_block("bench", report.written("readme.md", sections, made))
    except (ImportError, FileNotFoundError, ValueError) as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    print(f"wrote {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
