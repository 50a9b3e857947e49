"""Many seeds of a scene: the median and the range of every measure, on all cores or machines."""

import os
import statistics
import sys

import contact
from curriculum import pool


def report(args, models):
    """Run every model from every seed of args.seeds, print the table and write seeds.json.

    args: the flags as contact.parse_flags gives them; with args.scheduler the machines of a dask
    scheduler do the work. Returns the exit status.
    """
    seeds = range(*args.seeds)
    jobs = [(args, models, seed) for seed in seeds]
    try:
        found = pool.spread(qualities, jobs, "seeds", scheduler=args.scheduler)
    except (ImportError, OSError) as error:
        print(f"contact.py: error: argument --scheduler: {error}", file=sys.stderr)
        return 2
    rows = {}
    for model in models:
        rows |= summary(model, [each[model] for each in found])
    rows = contact.rounded(rows)
    title = f"seeds {seeds[0]} to {seeds[-1]}: {args.steps} steps of {args.dt:g} s"
    print(f"scene {args.scene}, {title}")
    contact.print_table(rows, lambda row: state(row, len(seeds)))
    return save(args, rows)


def qualities(job):
    """{model: its contact_quality} from one seed; a process of its own may run it."""
    args, models, seed = job
    scene, settings = contact.chosen_scene(args, seed), contact.chosen_settings(args)
    runs = {
        model: contact.run_model(model, scene, args.dt, args.steps, settings) for model in models
    }
    return {
        model: contact.contact_quality(run, scene, args.dt, runs.get("exact"))
        for model, run in runs.items()
    }


def summary(model, found):
    """{"model median": row, "model lowest": row, "model highest": row} of many qualities, by key.

    A row holds what is a number, and how many of the runs exploded or went through something. A
    number that is not finite counts as larger than any other; None where a run has none.
    """
    counts = {
        "blew_up": sum(row["blew_up"] for row in found),
        "through": sum(row["through"] is not None for row in found),
    }
    rows = {f"{model} {what}": dict(counts) for what in ("median", "lowest", "highest")}
    for key in contact.COLUMNS.values():
        values = [row[key] for row in found]
        if None in values:
            three = None, None, None
        else:
            values = [value if value < float("inf") else float("inf") for value in values]
            three = statistics.median(values), min(values), max(values)
        for row, value in zip(rows.values(), three):
            row[key] = value
    return rows


def state(row, count):
    """How the runs of a row ended."""
    ends = {"EXPLODED": row["blew_up"], "through": row["through"]}
    said = [f"{number} of {count} {end}" for end, number in ends.items() if number]
    return ", ".join(said) or "ok"


def save(args, rows):
    """Write seeds.json and say so. Returns the exit status."""
    path = os.path.join(args.out, "seeds.json")
    kept = {"scene": args.scene, "dt": args.dt, "steps": args.steps, "seeds": list(args.seeds)}
    try:
        contact.write_json(path, kept | {"rows": rows})
    except OSError as error:
        print(f"contact.py: error: cannot write {path}: {error.strerror}", file=sys.stderr)
        return 2
    print("seeds:", path)
    return 0
