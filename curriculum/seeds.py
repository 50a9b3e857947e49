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
import csv
import hashlib
import io
import json
import math
import os
import sqlite3
import statistics
import sys
import zlib
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import contact
from curriculum import parallel, said
from curriculum.commands import Parser, near, write_json

PROG = "python -m curriculum.seeds"
KEYS = [key for key, _ in contact.COLUMNS.values()]
CODE = "contact.py", "curriculum/exact.py", "curriculum/seeds.py"  # what a row depends on
ORDERS = {"median": "", "lowest": "ASC", "highest": "DESC"}


def seed_range(text):
    """An argparse type: the seeds of "A:B", from A to B - 1."""
    first, _, last = text.partition(":")
    if not (first.isdecimal() and last.isdecimal() and int(first) < int(last) <= 10**18):
        raise argparse.ArgumentTypeError(
            f"given {text[:40]!r}; allowed: A:B, whole numbers up to 1e18, A < B, "
            "such as 0:20 for 0 to 19"
        )
    return range(int(first), int(last))


def parse(argv):
    """The seeds, the scheduler or None, and the other flags as contact.parse_flags gives them."""
    parser = Parser(prog=PROG, description=__doc__)
    parser.add_argument("seeds", type=seed_range, metavar="A:B", help="from A to B - 1")
    parser.add_argument("--scheduler", metavar="HOST:PORT", help="run them on a dask cluster")
    mine, rest = parser.parse_known_args(argv)
    for flag in ("--seed", "--plot", "--rerun"):
        if any(word.split("=")[0] == flag for word in rest):
            parser.error(f"{flag} is for one run: leave it out")
    if mine.scheduler == "":
        parser.error("argument --scheduler: given ''; allowed: host:port")
    return mine.seeds, mine.scheduler, contact.parse_flags(rest)


def main(argv=None):
    """Run what is missing, print the table, write seeds.json. Returns the exit status."""
    seeds, scheduler, args = parse(argv)
    fail = Parser(prog=PROG).error
    models = list(contact.MODELS) if args.contact == "all" else [args.contact]
    path = Path(args.out, "seeds.csv")
    try:
        rows = Rows(path, made_by(args), models)
        run_missing(rows, args, seeds, scheduler)
        clash = rows.clash()
        summaries = {model: rows.summary(model, seeds) for model in models}
        summaries = contact.rounded({model: each for model, each in summaries.items() if each})
        kept = {"scene": args.scene, "dt": args.dt, "steps": args.steps, "rows": summaries}
        if not clash:
            write_json(path.with_suffix(".json"), kept | {"seeds": [seeds[0], seeds[-1] + 1]})
    except (ImportError, OSError, sqlite3.Error) as error:
        fail(f"{said(error)}; what is done is kept: the same command goes on from there")
    if clash:
        fail(f"{near(str(path))}: {clash}")
    print(
        f"scene {args.scene}, seeds {seeds[0]} to {seeds[-1]}: {args.steps} steps of {args.dt:g} s"
    )
    table = {
        f"{model} {way}": row for model, ways in summaries.items() for way, row in ways.items()
    }
    contact.print_table(table, lambda row: ending(row, len(seeds)))
    for model, ways in summaries.items():
        print(f"{model}, seeds of its lowest and highest:", extremes(ways) or "-")
    print("seeds:", path.with_suffix(".json"))
    return 0


def run_missing(rows, args, seeds, scheduler):
    """Run the seeds that are not in the file, and add each as soon as it is done."""
    todo = sum(1 for _ in rows.missing(seeds))
    if rows.others or 0 < todo < len(seeds):
        note = f"{near(str(rows.path))}: {len(seeds) - todo:,} of {len(seeds):,} seeds are there"
        others = f"; {rows.others:,} rows of other flags or other code are left alone"
        print(note + others * (rows.others > 0), file=sys.stderr)
    if todo:
        job = partial(qualities, args, code())
        found = parallel.as_they_come(job, rows.missing(seeds), todo, "seeds", None, scheduler)
        with rows.opened() as file:
            for _, new in found:
                rows.add(file, new)


@cache
def code():
    """{what a row depends on: its digest or version}, of what this process has."""
    home = Path(contact.__file__).parent
    texts = {name: (home / name).read_text("utf-8").encode() for name in CODE}
    found = {name: hashlib.sha256(text).hexdigest() for name, text in texts.items()}
    return found | {"numpy": version("numpy")}


def made_by(args):
    """The mark of all rows of these flags, this code and this numpy."""
    no_matter = "seed", "out", "rerun", "plot", "smoke", "skip", "device"
    flags = {name: value for name, value in vars(args).items() if name not in no_matter}
    return hashlib.sha256(json.dumps([flags, code()], sort_keys=True).encode()).hexdigest()[:12]


def qualities(args, known, seed):
    """[[seed, model, measures, how it ended]] of one seed; another process may run it."""
    if other := [name for name in known if code()[name] != known[name]]:
        raise ImportError(f"another {', '.join(other)} is there; give all machines the same")
    _, without, quality = contact.run_all(args, contact.chosen_scene(args, seed))
    ends = {model: (row, contact.ending(row)) for model, row in quality.items()}
    ends |= {model: (dict.fromkeys(KEYS), f"no: {why}") for model, why in without.items()}
    return [[seed, m, *(finite(row[key]) for key in KEYS), end] for m, (row, end) in ends.items()]


def finite(value):
    """A measure, where infinity stands for what is not finite."""
    return math.inf if value is not None and not math.isfinite(value) else value


class Rows:
    """The rows of a file that have this mark, in a table on the disk, so that memory stays flat."""

    def __init__(self, path, mark, models):
        self.path, self.mark, self.models, self.others = path, mark, models, 0
        self.table = sqlite3.connect("", isolation_level=None)  # a file that goes at the end
        names = ", ".join(("seed INTEGER, model, ending, sum", *(f"{key} REAL" for key in KEYS)))
        self.table.execute(f"CREATE TABLE rows ({names}, UNIQUE (seed, model, sum))")
        if path.is_file():  # /dev/zero would never end
            self.table.execute("BEGIN")
            with path.open("rb") as file:
                for line in file:
                    self.take(line)
            self.table.execute("COMMIT")

    def take(self, line):
        """A line of the file, if it is whole, which its sum says, and has the mark."""
        text, _, digest = line.rstrip(b"\r\n").rpartition(b",")
        if digest != b"%08x" % zlib.crc32(text):
            return
        mark, seed, model, *values, end = next(csv.reader([text.decode()]))
        if mark != self.mark:
            self.others += 1
            return
        row = int(seed), model, end, digest, *(float(each) if each else None for each in values)
        self.table.execute(f"INSERT OR IGNORE INTO rows VALUES ({'?, ' * (len(row) - 1)}?)", row)

    def opened(self):
        """The file, to be written to at its end; a row that was cut short is closed."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        file = self.path.open("ab+")
        if file.tell() == 0:
            file.write(csv_line(["made by", "seed", "model", *KEYS, "ending"]) + b"sum\n")
        elif file.seek(-1, os.SEEK_END) and file.read() != b"\n":
            file.write(b"\n")
        return file

    def add(self, file, rows):
        """Write the rows of a seed, all at once, and take them."""
        texts = [csv_line([self.mark, *row]) for row in rows]
        lines = [b"%b%08x\n" % (text, zlib.crc32(text[:-1])) for text in texts]
        file.write(b"".join(lines))
        file.flush()
        for line in lines:
            self.take(line)

    def missing(self, seeds):
        """Those of the seeds of which a model is missing."""
        for seed in seeds:
            found = self.table.execute("SELECT count(*) FROM rows WHERE seed = ?", (seed,))
            if found.fetchone()[0] < len(self.models):
                yield seed

    def clash(self):
        """A line on two results of one seed by one model, of machines that differ; or ""."""
        twice = "SELECT seed, model FROM rows GROUP BY seed, model HAVING count(*) > 1"
        for seed, model in self.table.execute(twice):
            return f"two results of seed {seed} by {model}; take the rows of one machine out"
        return ""

    def summary(self, model, seeds):
        """{"median": row, "lowest": row, "highest": row} of a model's runs; None if it has none.

        A row counts the runs, those that exploded, and others that went through something; a key
        that a run lacks is None. seeds: by which seed it is the lowest or the highest.
        """
        where = "FROM rows WHERE model = ? AND seed BETWEEN ? AND ? AND ending NOT LIKE 'no: %'"

        def ask(what, order=""):
            which = model, seeds[0], seeds[-1]
            return self.table.execute(f"SELECT {what} {where} {order}", which).fetchall()

        ended = "count(*), total(ending LIKE 'EXPLODED%'), total(ending LIKE 'through%')"
        counts = dict(zip(("runs", "blew_up", "through"), map(int, ask(ended)[0])))
        ways, runs = {way: {**counts, "seeds": {}} for way in ORDERS}, counts["runs"]
        for key in KEYS if runs else ():
            whole = ask(f"count({key})") == [(runs,)]
            for way, order in ORDERS.items():
                ((value, seed),) = ask(f"{key}, seed", f"ORDER BY {key} {order}, seed LIMIT 1")
                ways[way] |= {key: value if whole else None}
                ways[way]["seeds"] |= {key: seed if whole else None}
            if whole:
                middle = f"ORDER BY {key} LIMIT {2 - runs % 2} OFFSET {(runs - 1) // 2}"
                ways["median"] |= {key: statistics.mean(value for (value,) in ask(key, middle))}
        del ways["median"]["seeds"]
        return ways if runs else None


def csv_line(values):
    """The values as bytes of CSV, up to the place of the sum."""
    text = io.StringIO()
    csv.writer(text, lineterminator=",").writerow(values)
    return text.getvalue().encode()


def extremes(ways):
    """By which seeds the measures of a model are the lowest and the highest, where they differ."""
    low, high = ways["lowest"], ways["highest"]
    differ = {
        t: k
        for t, (k, _) in contact.COLUMNS.items()
        if len({*map(contact.shown, (low[k], high[k]))}) > 1
    }
    return ", ".join(f"{t} {low['seeds'][k]} and {high['seeds'][k]}" for t, k in differ.items())


def ending(row, count):
    """How the runs of a row ended."""
    ends = {
        "EXPLODED": row["blew_up"],
        "went through": row["through"],
        "could not be run": count - row["runs"],
    }
    return ", ".join(f"{n} of {count} {end}" for end, n in ends.items() if n) or "ok"


if __name__ == "__main__":
    from curriculum.seeds import main  # whose functions another machine can import

    sys.exit(main())
