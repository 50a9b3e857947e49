"""Many seeds of a scene: median, lowest and highest of every measure, on all cores or machines.

    python -m curriculum.seeds 0:20 --scene stack                   # seeds 0 to 19
    python -m curriculum.seeds 0:20 --scheduler localhost:8786      # on a dask cluster

Other flags are those of contact.py. The rows of a seed, one a model, are kept in seeds.csv of --out
as soon as they are there, and the same command again goes on from there. Files of several machines
are merged by writing them one after the other: cat a/seeds.csv b/seeds.csv > c/seeds.csv, then
--out c sums up. The first column says which flags, code and numpy made a row; others do not count.
The summary, seeds.json, names the seeds of the lowest and highest; it is the same bytes wherever,
in whatever order and parts the seeds ran.
"""

import argparse
import csv
import math
import platform
import sys
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import contact
from contact import np  # which says how to install it where it is missing
from curriculum import parallel, said, stored
from curriculum.commands import Parser, near, write_json

PROG = "python -m curriculum.seeds"
KEYS = [key for key, _ in contact.COLUMNS.values()]
HEAD = "made by", "seed", "model", "ending", *KEYS, "whole"
fail = Parser(prog=PROG).error


def seed_range(text):
    """Return the seeds of "A:B", from A to B - 1; an argparse type."""
    first, _, last = text.partition(":")
    numbers = first.isdecimal() and last.isdecimal()
    if not numbers or not 0 < int(last) - int(first) <= 10**5:
        allowed = "A:B, whole numbers, A < B, at most 1e5 seeds, such as 0:20 for 0 to 19"
        raise argparse.ArgumentTypeError(f"given {text[:40]!r}; allowed: {allowed}")
    return range(int(first), int(last))


def parse(argv):
    """Return the seeds, the scheduler or None, and the other flags from contact.parse_flags."""
    parser = Parser(prog=PROG, description=__doc__)
    parser.add_argument("seeds", type=seed_range, metavar="A:B", help="from A to B - 1")
    parser.add_argument("--scheduler", metavar="HOST:PORT", help="run them on a dask cluster")
    mine, rest = parser.parse_known_args(argv)
    for flag in ("--seed", "--plot", "--rerun"):
        if any(word.split("=")[0] == flag for word in rest):
            fail(f"{flag} is for one run: leave it out")
    return mine.seeds, mine.scheduler, contact.parse_flags(rest)


def main(argv=None):
    """Run what is missing, print the table, write seeds.json. Returns the exit status."""
    seeds, scheduler, args = parse(argv)
    models = contact.asked_for(args, 0)[3]
    path = Path(args.out, "seeds.csv")
    try:
        run_missing(path, args, seeds, models, scheduler)
        rows = read(path, args, seeds)
        found = {model: summary({seed: rows[seed, model] for seed in seeds}) for model in models}
        found = contact.json_safe({model: ways for model, ways in found.items() if ways})
        kept = {"scene": args.scene, "dt": args.dt, "steps": args.steps, "rows": found}
        write_json(path.with_suffix(".json"), kept | {"seeds": [seeds[0], seeds[-1] + 1]})
    except (ImportError, OSError) as error:
        kept = f"what is done is kept in {near(str(path))}: the same command goes on from there"
        fail(f"{said(error)}; {kept}")
    print(f"scene {args.scene}, seeds {seeds[0]} to {seeds[-1]}:", end=" ")
    print(f"{args.steps} steps of {args.dt:g} s")
    table = {f"{model} {way}": row for model, ways in found.items() for way, row in ways.items()}
    contact.print_table(table, lambda row: ending(row, len(seeds)))
    print("seeds:", path.with_suffix(".json"))
    return 0


def run_missing(path, args, seeds, models, scheduler):
    """Run the seeds that the file lacks, and add the rows of each.

    A blank line stands where it went on, so that a row that was cut spoils no other.
    """
    rows = read(path, args, seeds)
    missing = [seed for seed in seeds if any((seed, model) not in rows for model in models)]
    if rows and missing:
        there = f"{len(seeds) - len(missing):,} of {len(seeds):,} seeds are there"
        print(f"{near(str(path))}: {there}", file=sys.stderr)
    if missing:
        job = partial(rows_of, args, made_by(args))
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a", buffering=1, encoding="utf-8", newline="\n") as file:
            file.write("\n" if file.tell() else f"{','.join(HEAD)}\n")
            for text in parallel.one_by_one(job, missing, "seeds", scheduler):
                file.write(text)


def read(path, args, seeds):
    """Return {(seed, model): row} of a file's whole rows of these seeds, flags, code and numpy."""
    mark, text = made_by(args), path.read_text("utf-8", "replace") if path.is_file() else ""
    rows = csv.DictReader(text.splitlines(), HEAD)
    rows = (row for row in rows if row["made by"] == mark and row["whole"] == "yes")
    return {(int(row["seed"]), row["model"]): row for row in rows if int(row["seed"]) in seeds}


@cache
def code():
    """Return {what a row depends on: its hash or version} in this process."""
    return stored.stamp(*stored.made_by("curriculum/seeds.py")) | {"numpy": version("numpy")}


def made_by(args):
    """Return the mark of all rows of these flags, this code and this numpy."""
    no_matter = "seed", "out", "rerun", "plot", "smoke", "skip", "device"
    flags = {name: value for name, value in sorted(vars(args).items()) if name not in no_matter}
    return stored.digest([flags, code()])


def rows_of(args, mark, seed):
    """Run one seed, perhaps in another process. Returns its rows, a line a model."""
    if made_by(args) != mark:
        raise ImportError(f"{platform.node()} has other code or another numpy; give all the same")
    _, without, quality = contact.run_models(*contact.asked_for(args, seed))
    ends = {model: (f"no: {why}", {}) for model, why in without.items()}
    ends |= {model: (contact.final_state(row), row) for model, row in quality.items()}
    text = ""
    for model, (end, row) in ends.items():
        values = (row.get(key) for key in KEYS)
        cells = ("" if x is None else str(x if math.isfinite(x) else math.inf) for x in values)
        text += ",".join((mark, str(seed), model, end.replace(",", ";"), *cells, "yes")) + "\n"
    return text


def summary(rows):
    """Return {"median": row, "lowest": row, "highest": row} of a model's rows {seed: row}; {}
    without a run.

    A row counts the runs, those that exploded, and others that went through something; a key
    that a run lacks is None. seeds: by which seed it is the lowest or the highest.
    """
    ran = {seed: row for seed, row in rows.items() if not row["ending"].startswith("no: ")}
    if not ran:
        return {}
    ends = [row["ending"].split()[0] for row in ran.values()]
    counts = {"runs": len(ran), "blew_up": ends.count("EXPLODED"), "through": ends.count("through")}
    median, lowest, highest = {**counts}, counts | {"seeds": {}}, counts | {"seeds": {}}
    for key in KEYS:
        values = sorted((float(row[key] or "nan"), seed) for seed, row in ran.items())
        known = all(row[key] for row in ran.values())
        median[key] = float(np.median([value for value, _ in values])) if known else None
        for way, place in (lowest, 0), (highest, -1):
            way[key], way["seeds"][key] = values[place] if known else (None, None)
    return {"median": median, "lowest": lowest, "highest": highest}


def ending(row, count):
    """Return in words how the runs of a row ended."""
    lost = count - row["runs"]
    ends = {"EXPLODED": row["blew_up"], "went through": row["through"], "could not be run": lost}
    return ", ".join(f"{n} of {count} {end}" for end, n in ends.items() if n) or "ok"


if __name__ == "__main__":
    from curriculum.seeds import main  # whose functions another machine can import

    sys.exit(main())
