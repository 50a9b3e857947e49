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
import sqlite3
import sys
import zlib
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import contact
from curriculum import parallel, said, stored
from curriculum.commands import Parser, near, write_json

PROG = "python -m curriculum.seeds"
KEYS = [key for key, _ in contact.COLUMNS.values()]
COLUMNS = ("line", "seed INTEGER", "model", "ending", *(f"{key} REAL" for key in KEYS))


def seed_range(text):
    """An argparse type: the seeds of "A:B", from A to B - 1."""
    first, _, last = text.partition(":")
    if not (first.isdecimal() and last.isdecimal() and int(first) < int(last) <= 10**18):
        allowed = "A:B, whole numbers up to 1e18, A < B, such as 0:20 for 0 to 19"
        raise argparse.ArgumentTypeError(f"given {text[:40]!r}; allowed: {allowed}")
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
        rows = Rows(path, made_by(args))
        run_missing(rows, args, seeds, len(models), scheduler)
        if clash := rows.clash():
            fail(f"{near(str(path))}: {clash}; take the rows of one machine out")
        summaries = {model: rows.summary(model, seeds) for model in models}
        summaries = contact.rounded({model: each for model, each in summaries.items() if each})
        kept = {"scene": args.scene, "dt": args.dt, "steps": args.steps, "rows": summaries}
        write_json(path.with_suffix(".json"), kept | {"seeds": [seeds[0], seeds[-1] + 1]})
    except (ImportError, OSError, sqlite3.Error) as error:
        kept = f"what is done is kept in {near(str(path))}: the same command goes on from there"
        fail(f"{said(error)}; {kept}")
    print(f"scene {args.scene}, seeds {seeds[0]} to {seeds[-1]}:", end=" ")
    print(f"{args.steps} steps of {args.dt:g} s")
    table = {
        f"{model} {way}": row for model, ways in summaries.items() for way, row in ways.items()
    }
    contact.print_table(table, lambda row: ending(row, len(seeds)))
    for model, ways in summaries.items():
        print(f"{model}, seeds of its lowest and highest:", extremes(ways) or "-")
    print("seeds:", path.with_suffix(".json"))
    return 0


def run_missing(rows, args, seeds, models, scheduler):
    """Run the seeds that are not in the file, and add each as soon as it is done."""
    todo = sum(1 for _ in rows.missing(seeds, models))
    if rows.others or 0 < todo < len(seeds):
        note = f"{near(str(rows.path))}: {len(seeds) - todo:,} of {len(seeds):,} seeds are there"
        others = f"; {rows.others:,} rows of other flags or other code are left alone"
        print(note + others * (rows.others > 0), file=sys.stderr)
    if todo:
        job, missing = partial(qualities, args, code()), rows.missing(seeds, models)
        with rows.opened() as file:
            for _, new in parallel.as_they_come(job, missing, todo, "seeds", None, scheduler):
                rows.add(file, new)


@cache
def code():
    """{what a row depends on: its stamp or version}, of what this process has."""
    return stored.stamp(*stored.made_by("curriculum/seeds.py")) | {"numpy": version("numpy")}


def made_by(args):
    """The mark of all rows of these flags, this code and this numpy."""
    no_matter = "seed", "out", "rerun", "plot", "smoke", "skip", "device"
    flags = {name: value for name, value in sorted(vars(args).items()) if name not in no_matter}
    return stored.digest([flags, code()])


def qualities(args, known, seed):
    """[[seed, model, how it ended, measures]] of one seed; another process may run it."""
    if other := {name.partition("#")[0] for name in known if code().get(name) != known[name]}:
        raise ImportError(f"another {', '.join(sorted(other))} is there; give all the same")
    _, without, quality = contact.run_all(args, contact.chosen_scene(args, seed))
    ends = {model: (f"no: {why}", {}) for model, why in without.items()}
    ends |= {model: (contact.ending(row), row) for model, row in quality.items()}
    return [[seed, m, end, *(finite(row.get(k)) for k in KEYS)] for m, (end, row) in ends.items()]


def finite(value):
    """A measure, where infinity stands for what is not finite."""
    return math.inf if value is not None and not math.isfinite(value) else value


class Rows:
    """The rows of a file that have this mark, in a table on the disk, so that memory stays flat.

    others: how many have another one. cut: whether the last row is not whole.
    """

    def __init__(self, path, mark):
        self.path, self.mark, self.others, line = path, mark, 0, ""
        self.table = sqlite3.connect("", isolation_level=None)  # a file that goes at the end
        names = ", ".join((*COLUMNS, "UNIQUE (seed, model, line)"))
        self.table.execute(f"CREATE TABLE rows ({names})")
        if path.is_file():  # /dev/zero would never end
            self.table.execute("BEGIN")
            with path.open(encoding="utf-8", errors="replace") as file:
                for line in file:
                    self.take(line)
            self.table.execute("COMMIT")
        self.cut = not line.endswith("\n")

    def take(self, line):
        """A line of the file, if it is whole, which its sum says, and has the mark."""
        text, _, digest = line.rstrip("\n").rpartition(",")
        whole, (mark, *cells) = digest == summed(text), text.split(",")
        self.others += whole and mark != self.mark
        if whole and mark == self.mark:
            seed, model, end, *values = cells
            row = text, int(seed), model, end, *(float(v) if v else None for v in values)
            marks = ", ".join("?" * len(row))
            self.table.execute(f"INSERT OR IGNORE INTO rows VALUES ({marks})", row)

    def opened(self):
        """The file, to be written to at its end."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        file = self.path.open("a", encoding="utf-8", newline="\n")
        names = ",".join(("made by", "seed", "model", "ending", *KEYS, "sum"))
        file.write("\n" * self.cut if file.tell() else f"{names}\n")
        return file

    def add(self, file, rows):
        """Write the rows of a seed, all at once, and take them."""
        for row in rows:
            cells = ("" if cell is None else str(cell).replace(",", ";") for cell in row)
            text = ",".join((self.mark, *cells))
            line = f"{text},{summed(text)}\n"
            file.write(line)
            self.take(line)
        file.flush()

    def missing(self, seeds, models):
        """Those of the seeds that have not the rows of so many models."""
        for seed in seeds:
            found = self.table.execute("SELECT count(*) FROM rows WHERE seed = ?", (seed,))
            if found.fetchone()[0] < models:
                yield seed

    def clash(self):
        """Two results of one seed, of machines that differ, in words; or ""."""
        twice = "SELECT seed, model FROM rows GROUP BY seed, model HAVING count(*) > 1"
        found = self.table.execute(twice)
        return next((f"two results of seed {seed} by {model}" for seed, model in found), "")

    def summary(self, model, seeds):
        """{"median": row, "lowest": row, "highest": row} of a model's runs; None if it has none.

        A row counts the runs, those that exploded, and others that went through something; a key
        that a run lacks is None. seeds: by which seed it is the lowest or the highest.
        """

        def ask(what, order=""):
            where = "model = ? AND seed BETWEEN ? AND ? AND ending NOT LIKE 'no: %'"
            asked = f"SELECT {what} FROM rows WHERE {where} {order}"
            return self.table.execute(asked, (model, seeds[0], seeds[-1]))

        ended = "count(*), total(ending LIKE 'EXPLODED%'), total(ending LIKE 'through%')"
        counts = dict(zip(("runs", "blew_up", "through"), map(int, ask(ended).fetchone())))
        runs, ways = counts["runs"], {"median": counts | dict.fromkeys(KEYS)}
        ways |= {way: counts | {"seeds": {}} for way in ("lowest", "highest")}
        places = 0, (runs - 1) // 2, runs // 2, runs - 1
        for key in KEYS if runs else ():
            ordered = enumerate(ask(f"{key}, seed", f"ORDER BY {key}, seed"))
            at = {place: row for place, row in ordered if place in places}
            low, (below, _), (above, _), high = (at[place] for place in places)
            if whole := low[0] is not None:  # one that is unknown would stand first
                ways["median"][key] = (below + above) / 2.0
            for way, (value, seed) in ("lowest", low), ("highest", high):
                ways[way] |= {key: value if whole else None}
                ways[way]["seeds"] |= {key: seed if whole else None}
        return ways if runs else None


def extremes(ways):
    """By which seeds the measures of a model are the lowest and the highest, where they differ."""
    low, high = ways["lowest"], ways["highest"]
    columns = [(title, key) for title, (key, _) in contact.COLUMNS.items()]
    differ = [(t, k) for t, k in columns if contact.shown(low[k]) != contact.shown(high[k])]
    return ", ".join(f"{t} {low['seeds'][k]} and {high['seeds'][k]}" for t, k in differ)


def ending(row, count):
    """How the runs of a row ended."""
    lost = count - row["runs"]
    ends = {"EXPLODED": row["blew_up"], "went through": row["through"], "could not be run": lost}
    return ", ".join(f"{n} of {count} {end}" for end, n in ends.items() if n) or "ok"


def summed(text):
    """The sum of a row's text, as eight hexadecimal digits."""
    return f"{zlib.crc32(text.encode()):08x}"


if __name__ == "__main__":
    from curriculum.seeds import main  # whose functions another machine can import

    sys.exit(main())
