"""The ledger of measured wall-clock, /wallclock.csv: read it, show it, measure a row.

    python -m curriculum.common.wallclock              # the table, as the chapter shows it
    python -m curriculum.common.wallclock --measure    # time the default contact.py, write the row

Seven columns, no quoting: chapter,tier,wallclock_min,config_hash,commit,date,status. wallclock_min
is in minutes, for a whole process (`python contact.py`, recording included, the median of several).
status is MEASURED or PENDING; a PENDING row holds nothing else, and no time is ever guessed.

config_hash is over the flags of the default run (what contact.py prints) and over the code that
was timed, so a row is stale as soon as either changes. The single times of each measured row are
kept in curriculum/wallclock_runs.json, so that no row can be typed or edited alone.
"""

import os

from curriculum.common.stoppable import stoppable

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LEDGER = os.path.join(ROOT, "wallclock.csv")
CHAPTER = "ch3.5-contact"
COLUMNS = ("chapter", "tier", "wallclock_min", "config_hash", "commit", "date", "status")
COMMAND = "python -m curriculum.common.wallclock --measure"
RUNS = "curriculum/wallclock_runs.json"  # below the ledger's folder: the times behind each row
SHOWN = ("cpu-laptop", "mps", "t4", "4090")  # tiers the course shows, measured or not


def read(path=None):
    """The ledger's rows, dicts of str; none without a file. Raises ValueError `file:line: what`."""
    path = path or LEDGER
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    if not lines or tuple(lines[0].split(",")) != COLUMNS:
        raise ValueError(f"{path}:1: the header must be {','.join(COLUMNS)}")
    rows, seen = [], set()
    for number, line in enumerate(lines[1:], 2):
        row = dict(zip(COLUMNS, line.split(",")))
        trouble = _trouble(row) if line.count(",") == 6 else f"{line.count(',') + 1} columns, not 7"
        if trouble is None and (row["chapter"], row["tier"]) in seen:
            trouble = "a second row of this chapter and tier"
        if trouble:
            raise ValueError(f"{path}:{number}: {trouble}")
        rows.append(row)
        seen.add((row["chapter"], row["tier"]))
    return rows


def _trouble(row):
    """What is wrong with a row, or None."""
    facts = [row[name] for name in ("wallclock_min", "config_hash", "commit", "date")]
    if row["status"] == "PENDING":
        return "a PENDING row claims a measurement" if any(facts) else None
    if row["status"] != "MEASURED":
        return f"status {row['status']!r}; allowed: MEASURED, PENDING"
    if not all(facts):
        return "a MEASURED row needs wallclock_min, config_hash, commit and date"
    try:
        fits = 0 < float(row["wallclock_min"]) < float("inf")
        return None if fits else "wallclock_min must be > 0"
    except ValueError:
        return f"wallclock_min {row['wallclock_min']!r} is not a number"


def lookup(chapter, tier, path=None):
    """Measured minutes of a whole default run, or None where not measured."""
    for row in read(path):
        if (row["chapter"], row["tier"], row["status"]) == (chapter, tier, "MEASURED"):
            return float(row["wallclock_min"])
    return None


def show(minutes):
    """Minutes as text: two digits, and seconds beside them when that is the unit one feels."""
    if minutes is None:
        return "not yet measured"
    return f"{minutes:.2g} min" + (f" ({60 * minutes:.2g} s)" if minutes < 1 else "")


def render_line(chapter, tier, path=None, usual=True):
    """The banner's second line. usual: whether it is the default run, the one that was measured."""
    minutes = lookup(chapter, tier, path)
    if minutes is None:
        return f"wall-clock on {tier}: not yet measured"
    if usual:
        return f"expected wall-clock on {tier}: {show(minutes)}, measured"
    return (
        f"wall-clock on {tier}: not measured for these flags (the default run: "
        f"{show(minutes)}); a terminal shows the time left"
    )


def printed_hash(printed):
    """The fingerprint in what contact.py has printed."""
    return printed.rpartition("config_hash: ")[2].split()[0]


def run_hash(config_hash, root=ROOT):
    """The hash of a ledger row: of the config hash that contact.py prints, and of the code."""
    import hashlib
    import json

    from curriculum import measured

    code = {file: measured.code_hash(file, root) for file in measured.LITERATE}
    text = json.dumps([config_hash, code], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def read_runs(path=None):
    """{tier: {"seconds": [...], "config_hash", "commit", "date", "digest"}}, {} without a file."""
    import json

    path = os.path.join(os.path.dirname(path or LEDGER), RUNS)
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def digest(record):
    """12 hexadecimal digits of what is recorded of one measurement, but for the digest itself."""
    import hashlib
    import json

    facts = {key: value for key, value in record.items() if key != "digest"}
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:12]


def unfounded(row, runs):
    """What a MEASURED row says that its recorded times do not, or None."""
    import statistics

    record = runs.get(row["tier"])
    if not record:
        return f"no times of {row['tier']} in {RUNS}"
    if record.get("digest") != digest(record):
        return f"{RUNS} was edited: its digest no longer fits"
    minutes = f"{statistics.median(record['seconds']) / 60:.3g}"
    for name, said in (
        ("wallclock_min", minutes),
        *((key, record[key]) for key in ("config_hash", "commit", "date")),
    ):
        if row[name] != said:
            return f"{name} is {row[name]}, but {RUNS} has {said}"
    return None


def measure(runs):
    """Time `python contact.py` as a whole process: (seconds of each run, config hash).

    The first run only warms the disk cache and the bytecode and is not counted. Raises RuntimeError
    when a run fails or makes no recording: a run without rerun is not the default run.
    """
    import subprocess
    import sys
    import tempfile
    import time

    script, times = os.path.join(ROOT, "contact.py"), []
    env = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryDirectory() as out:
        for _ in range(runs + 1):
            start = time.perf_counter()
            run = subprocess.run(
                [sys.executable, script, "--out", out], env=env, capture_output=True, text=True
            )
            times.append(time.perf_counter() - start)
            if run.returncode:
                raise RuntimeError(f"contact.py failed: {run.stderr.strip()}")
            if not os.path.exists(os.path.join(out, "contact.rrd")):
                raise RuntimeError(
                    "the default run records, and rerun is missing: pip install rerun-sdk"
                )
    return [round(seconds, 4) for seconds in times[1:]], printed_hash(run.stdout)


def write_row(tier, seconds, config_hash, commit, date, path=None):
    """Put a MEASURED row of this chapter into the ledger, and its times beside it.

    Other rows stay as they are.
    """
    import json
    import statistics

    from curriculum.common.files import write_whole

    path = path or LEDGER
    minutes = f"{statistics.median(seconds) / 60:.3g}"
    values = CHAPTER, tier, minutes, config_hash, commit, date, "MEASURED"
    record = {"seconds": list(seconds), "config_hash": config_hash, "commit": commit, "date": date}
    times = {**read_runs(path), tier: {**record, "digest": digest(record)}}
    rows = {(r["chapter"], r["tier"]): r for r in read(path)}
    for name in SHOWN:
        pending = CHAPTER, name, "", "", "", "", "PENDING"
        rows.setdefault((CHAPTER, name), dict(zip(COLUMNS, pending)))
    rows[CHAPTER, tier] = dict(zip(COLUMNS, values))
    lines = [",".join(COLUMNS)] + [",".join(r.values()) for r in rows.values()]
    write_whole(
        os.path.join(os.path.dirname(path), RUNS),
        json.dumps(times, indent=1, sort_keys=True) + "\n",
    )
    write_whole(path, "\n".join(lines) + "\n")


@stoppable
def main(argv=None):
    """Show the ledger, or measure this machine's row. Returns the exit status."""
    import datetime
    import subprocess
    import sys

    from curriculum.common.arguments import Parser, number
    from curriculum.common.device import cpu_tier

    parser = Parser(
        prog="python -m curriculum.common.wallclock", description="The wall-clock ledger."
    )
    parser.add_argument("--measure", action="store_true", help="time contact.py, write the row")
    parser.add_argument("--runs", type=number(int, low=3), default=9, help="counted runs (9)")
    args = parser.parse_args(argv)
    if args.measure:

        def git(*words):
            return subprocess.check_output(["git", "-C", ROOT, *words], text=True).strip()

        try:
            if git("status", "--porcelain", "*.py"):
                raise RuntimeError("the code differs from the commit; commit it first")
            seconds, config_hash = measure(args.runs)
            commit = git("rev-parse", "--short", "HEAD")
        except (RuntimeError, OSError, subprocess.CalledProcessError) as error:
            print(f"nothing written: {error}", file=sys.stderr)
            return 1
        write_row(
            cpu_tier(), seconds, run_hash(config_hash), commit, datetime.date.today().isoformat()
        )
    for row in read():
        minutes = float(row["wallclock_min"]) if row["status"] == "MEASURED" else None
        print(f"{row['tier']:<12}{show(minutes)}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
