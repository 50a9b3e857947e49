"""Many seeds of a scene: the median and the range of every measure, on all cores or machines.

    python -m curriculum.seeds 0:20 --scene stack                   # seeds 0 to 19
    python -m curriculum.seeds 0:20 --scheduler localhost:8786      # on a dask cluster

Other flags are those of contact.py. Writes seeds.json into the folder of --out.
"""

import argparse
import math
import os
import statistics
import sys
from functools import partial

import contact
from curriculum import parallel
from curriculum.commands import Parser, stoppable, write_json


def seed_range(text):
    """An argparse type: the seeds of "A:B", from A to B - 1."""
    first, _, last = text.partition(":")
    if not (first.isdecimal() and last.isdecimal() and 0 < int(last) - int(first) <= 10_000):
        raise argparse.ArgumentTypeError(
            f"given {text[:40]!r}; allowed: A:B, whole numbers, A < B, at most 10,000 seeds, "
            "such as 0:20 for 0 to 19"
        )
    return range(int(first), int(last))


def parse(argv):
    """The seeds, the scheduler or None, and the other flags as contact.parse_flags gives them."""
    parser = Parser(prog="python -m curriculum.seeds", description=__doc__)
    parser.add_argument("seeds", type=seed_range, metavar="A:B", help="from A to B - 1")
    parser.add_argument("--scheduler", metavar="HOST:PORT", help="run them on a dask cluster")
    mine, rest = parser.parse_known_args(argv)
    for flag in ("--seed", "--plot", "--rerun"):
        if any(word.split("=")[0] == flag for word in rest):
            parser.error(f"{flag} is for one run: leave it out")
    return mine.seeds, mine.scheduler, contact.parse_flags(rest)


@stoppable()
def main(argv=None):
    """Run the models from every seed, print the table, write seeds.json. Returns the exit status.

    With a scheduler the machines of a dask cluster do the work.
    """
    seeds, scheduler, args = parse(argv)
    try:
        measured = parallel.run_jobs(partial(qualities, args), seeds, "seeds", scheduler=scheduler)
    except (ImportError, OSError) as error:
        return contact.fail(f"argument --scheduler: {error}")
    runs = {model: [each[model] for each in measured if model in each] for model in contact.MODELS}
    rows = contact.rounded({model: summary(mine) for model, mine in runs.items() if mine})
    span = f"seeds {seeds[0]} to {seeds[-1]}"
    print(f"scene {args.scene}, {span}: {args.steps} steps of {args.dt:g} s")
    table = {f"{model} {way}": row for model, ways in rows.items() for way, row in ways.items()}
    contact.print_table(table, lambda row: ending(row, len(seeds)))
    path = os.path.join(args.out, "seeds.json")
    kept = {"scene": args.scene, "dt": args.dt, "steps": args.steps}
    try:
        write_json(path, kept | {"seeds": [seeds[0], seeds[-1] + 1], "rows": rows})
    except OSError as error:
        return contact.fail(f"cannot write to {args.out}: {error.strerror}; the report is whole")
    print("seeds:", path)
    return 0


def qualities(args, seed):
    """{model: its contact_quality} from one seed; a process of its own may run it."""
    scene = contact.chosen_scene(args, seed)
    return contact.run_all(args, scene)[2]


def summary(qualities):
    """{"median": row, "lowest": row, "highest": row} of many qualities of a model, by key.

    A row also counts the runs, those that exploded, and others that went through something.
    """
    counts = {
        "runs": len(qualities),
        "blew_up": sum(row["blew_up"] for row in qualities),
        "through": sum(row["through"] is not None and not row["blew_up"] for row in qualities),
    }
    keys = [key for key, _ in contact.COLUMNS.values()]
    ways = {"median": statistics.median, "lowest": min, "highest": max}
    return {
        name: counts | {key: chosen(way, [row[key] for row in qualities]) for key in keys}
        for name, way in ways.items()
    }


def chosen(way, values):
    """way(values), where infinity stands for a number that is not finite; None if one is None."""
    if None in values:
        return None
    return way([value if math.isfinite(value) else math.inf for value in values])


def ending(row, count):
    """How the runs of a row ended."""
    ends = {
        "EXPLODED": row["blew_up"],
        "went through": row["through"],
        "could not be run": count - row["runs"],
    }
    return ", ".join(f"{n} of {count} {end}" for end, n in ends.items() if n) or "ok"


if __name__ == "__main__":
    sys.exit(main())
