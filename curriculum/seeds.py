"""Many seeds of a scene: median, lowest and highest of every measure, on all cores or machines.

    python -m curriculum.seeds 0:20 --scene stack                   # seeds 0 to 19
    python -m curriculum.seeds 0:20 --scheduler localhost:8786      # on a dask cluster

Other flags are those of contact.py. A seed is kept in seeds.csv of --out as soon as it is done, a
row a model, and the same command again goes on from there. Files of several machines are merged by
writing them one after the other: cat a/seeds.csv b/seeds.csv > c/seeds.csv, then --out c sums up.
The first column says which flags, code and numpy made a row; those of others are left alone. The
summary, seeds.json, is the same bytes wherever, in whatever order and parts the seeds ran.
"""

import argparse
import math
import re
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
HEAD = ",".join(("made by", "seed", "model", "ending", *KEYS, "whole"))
NUMBER = r"(?:inf|-?\d+(?:\.\d+)?(?:e[+-]\d+)?)?"  # of a cell, as Python writes it
WHOLE = re.compile(rf"\w+,\d+,\w+,[^,]*(?:,{NUMBER}){{{len(KEYS)}}},yes\n").fullmatch
ENDINGS = None, "no: ", "EXPLODED", "through", ""  # the words begin so; "": it came to its end
fail = Parser(prog=PROG).error


def seed_range(text):
    """Return the seeds of "A:B", from A to B - 1; an argparse type."""
    first, _, last = text.partition(":")
    numbers = first.isdecimal() and last.isdecimal() and int(last) <= 10**18
    if not (numbers and 0 < int(last) - int(first) <= 10**6):
        allowed = "A:B, whole numbers, A < B <= 1e18, at most 1e6 seeds, such as 0:20 for 0 to 19"
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
        rows, _ = read(path, made_by(args), seeds, models)
        found = {model: summary(each, seeds) for model, each in zip(models, rows)}
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
    for model, ways in found.items():
        low, high = ways["lowest"], ways["highest"]
        differ = ", ".join(
            f"{title} {low['seeds'][key]} and {high['seeds'][key]}"
            for title, (key, _) in contact.COLUMNS.items()
            if contact.format_number(low[key]) != contact.format_number(high[key])
        )
        print(f"{model}, seeds of its lowest and highest:", differ or "-")
    print("seeds:", path.with_suffix(".json"))
    return 0


def run_missing(path, args, seeds, models, scheduler):
    """Run the seeds that the file lacks, and add the rows of each as soon as it is done.

    A blank line stands where it went on, so that a row that was cut spoils no other.
    """
    rows, others = read(path, made_by(args), seeds, models)
    done = (rows[..., 0] > 0.0).all(axis=0)
    todo = len(seeds) - int(done.sum())
    if others or 0 < todo < len(seeds):
        note = f"{near(str(path))}: {len(seeds) - todo:,} of {len(seeds):,} seeds are there"
        alone = f"; {others:,} rows of other flags or other code are left alone"
        print(note + alone * (others > 0), file=sys.stderr)
    if todo:
        missing = (seed for seed, there in zip(seeds, done) if not there)
        job = partial(rows_of, args, code())
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a", buffering=1, encoding="utf-8", newline="\n") as file:
            file.write("\n" if file.tell() else f"{HEAD}\n")
            for text in parallel.one_by_one(job, missing, todo, "seeds", None, scheduler):
                file.write(text)


def read(path, mark, seeds, models):
    """Return the whole rows of these seeds in a file that have this mark, and how many have others.

    The rows are (models, seeds, 1 + KEYS). Column 0 is how a run ended, as a place in ENDINGS, and
    0 where there is no row. NaN: the run has no such measure.
    """
    rows, others = np.zeros((len(models), len(seeds), 1 + len(KEYS))), 0
    for line in path.open(encoding="utf-8", errors="replace") if path.is_file() else ():
        if not WHOLE(line):
            continue  # a head, or a row that was cut or that something fell into
        first, seed, model, end, *values, _ = line.split(",")
        others += first != mark
        if first == mark and int(seed) in seeds and model in models:
            row = [ended(end), *(float(value or "nan") for value in values)]
            there = rows[models.index(model), int(seed) - seeds[0]]
            if there[0] > 0.0 and not np.array_equal(there, row, equal_nan=True):
                twice = f"two results of seed {seed} by {model}; take the rows of one machine out"
                fail(f"{near(str(path))}: {twice}")
            there[:] = row
    return rows, others


@cache
def code():
    """Return {what a row depends on: its hash or version} in this process."""
    return stored.stamp(*stored.made_by("curriculum/seeds.py")) | {"numpy": version("numpy")}


def made_by(args):
    """Return the mark of all rows of these flags, this code and this numpy."""
    no_matter = "seed", "out", "rerun", "plot", "smoke", "skip", "device"
    flags = {name: value for name, value in sorted(vars(args).items()) if name not in no_matter}
    return stored.digest([flags, code()])


def rows_of(args, known, seed):
    """Run one seed, perhaps in another process. Returns its rows, a line a model."""
    if other := {name.partition("#")[0] for name in known if code().get(name) != known[name]}:
        raise ImportError(f"another {', '.join(sorted(other))} is there; give all the same")
    _, without, quality = contact.run_models(*contact.asked_for(args, seed))
    ends = {model: (f"no: {why}", {}) for model, why in without.items()}
    ends |= {model: (contact.final_state(row), row) for model, row in quality.items()}
    text = ""
    for model, (end, row) in ends.items():
        values = (row.get(key) for key in KEYS)
        cells = ("" if x is None else str(x if math.isfinite(x) else math.inf) for x in values)
        line = made_by(args), str(seed), model, end.replace(",", ";"), *cells, "yes"
        text += ",".join(line) + "\n"
    return text


def ended(end):
    """Return the place in ENDINGS of how a run ended."""
    return next(place for place, words in enumerate(ENDINGS) if place and end.startswith(words))


def summary(rows, seeds):
    """Return {"median": row, "lowest": row, "highest": row} of a model's rows; {} without a run.

    A row counts the runs, those that exploded, and others that went through something; a key
    that a run lacks is None. seeds: by which seed it is the lowest or the highest.
    """
    ran = np.flatnonzero(rows[:, 0] > ended("no: "))
    if not len(ran):
        return {}
    counts = {"runs": len(ran)}
    counts["blew_up"] = int((rows[:, 0] == ended("EXPLODED")).sum())
    counts["through"] = int((rows[:, 0] == ended("through")).sum())
    median, lowest, highest = {**counts}, counts | {"seeds": {}}, counts | {"seeds": {}}
    for place, key in enumerate(KEYS, 1):
        values = rows[ran, place]
        order = np.argsort(values, kind="stable")  # of equal ones the first seed is the lowest
        known = not np.isnan(values).any()
        median[key] = float(np.median(values)) if known else None
        for way, at in (lowest, order[0]), (highest, order[-1]):
            way[key] = float(values[at]) if known else None
            way["seeds"][key] = seeds[int(ran[at])] if known else None
    return {"median": median, "lowest": lowest, "highest": highest}


def ending(row, count):
    """Return in words how the runs of a row ended."""
    lost = count - row["runs"]
    ends = {"EXPLODED": row["blew_up"], "went through": row["through"], "could not be run": lost}
    return ", ".join(f"{n} of {count} {end}" for end, n in ends.items() if n) or "ok"


if __name__ == "__main__":
    from curriculum.seeds import main  # whose functions another machine can import

    sys.exit(main())
