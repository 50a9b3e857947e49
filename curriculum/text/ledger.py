"""The ledger of measured wall-clock, wallclock.csv: show it, or measure this machine's row.

    python -m curriculum.text.ledger              # the rows, as the chapter shows them
    python -m curriculum.text.ledger --measure    # time `python contact.py`, write the row

Seven columns, no quoting: chapter,tier,wallclock_min,config_hash,commit,date,status. wallclock_min is
in minutes for a whole process, recording included, the median of several runs. status is MEASURED or
PENDING; a PENDING row holds nothing else, and no time is ever guessed. config_hash is of the code that
was timed, so a row is stale as soon as that changes.
"""

import argparse
import csv
import hashlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from curriculum.common.files import write_whole
from curriculum.machine import fingerprint, machine
from curriculum.text.regions import LITERATE, ROOT

LEDGER = ROOT / "wallclock.csv"
CHAPTER = "ch3.5-contact"
COLUMNS = ("chapter", "tier", "wallclock_min", "config_hash", "commit", "date", "status")
COMMAND = "python -m curriculum.text.ledger --measure"
CODE = (*LITERATE, "curriculum/recording.py")


def rows() -> list:
    """This chapter's rows, dicts of str. Raises ValueError `file:line: what`."""
    with open(LEDGER, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if tuple(reader.fieldnames or ()) != COLUMNS:
            raise ValueError(f"wallclock.csv:1: the header must be {','.join(COLUMNS)}")
        found = [row for row in reader if row["chapter"] == CHAPTER]
    for number, row in enumerate(found, 2):
        what = _trouble(row)
        if what:
            raise ValueError(f"wallclock.csv:{number}: {row['tier']}: {what}")
    return found


def _trouble(row):
    """What is wrong with a row, or None."""
    facts = [row[name] for name in ("wallclock_min", "config_hash", "commit", "date")]
    if None in row or None in row.values():
        return "not seven columns"
    if row["status"] == "PENDING":
        return "a PENDING row claims a measurement" if any(facts) else None
    if row["status"] != "MEASURED" or not all(facts):
        return "status is MEASURED with all columns filled, or PENDING with none"
    try:
        return None if 0 < float(row["wallclock_min"]) < float("inf") else "no time above 0"
    except ValueError:
        return f"wallclock_min {row['wallclock_min']!r} is not a number"


def lookup(tier: str):
    """Measured minutes of a whole default run on a tier, or None where nobody has measured."""
    times = [row["wallclock_min"] for row in rows() if row["tier"] == tier]
    return float(times[0]) if times and times[0] else None


def show(minutes) -> str:
    """Minutes as text: two digits, and seconds beside them where one feels those."""
    if minutes is None:
        return "not yet measured"
    return f"{minutes:.2g} min" + (f" ({60 * minutes:.2g} s)" if minutes < 1 else "")


def code_hash() -> str:
    """12 hexadecimal digits of the code that a default run runs."""
    text = json.dumps(fingerprint(*CODE), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def stale_tiers() -> list:
    """The tiers whose row was measured on other code than today's."""
    now = code_hash()
    return [row["tier"] for row in rows() if row["config_hash"] not in ("", now)]


def this_tier() -> str:
    """What this machine's CPU is: "cpu-vm" under a hypervisor, "cpu-laptop" with a battery, or "cpu"."""
    try:
        virtual = " hypervisor" in Path("/proc/cpuinfo").read_text("utf-8")[:4096]
        supplies = os.listdir("/sys/class/power_supply")
    except OSError:
        return "cpu"
    laptop = any(name.startswith("BAT") for name in supplies)
    return "cpu-vm" if virtual else "cpu-laptop" if laptop else "cpu-desktop"


def measure(runs: int) -> list:
    """Seconds of `python contact.py` as a whole process, so many times, after one that warms caches.

    Raises RuntimeError when a run fails or makes no recording: without rerun it is not the default.
    """
    seconds = []
    with tempfile.TemporaryDirectory() as out:
        for _ in range(runs + 1):
            start = time.perf_counter()
            command = [sys.executable, str(ROOT / "contact.py"), "--out", out]
            run = subprocess.run(command, capture_output=True, text=True)
            seconds.append(time.perf_counter() - start)
            if run.returncode or not list(Path(out).glob("*.rrd")):
                raise RuntimeError(run.stderr.strip() or "no recording: pip install rerun-sdk")
    return seconds[1:]


def measured_row(runs: int) -> dict:
    """This machine's row of the ledger, measured now."""
    about, minutes = machine(), statistics.median(measure(runs)) / 60
    facts = f"{minutes:.3g}", code_hash(), about["commit"], about["date"]
    return dict(zip(COLUMNS, (CHAPTER, this_tier(), *facts, "MEASURED")))


def main(argv=None) -> int:
    """Show the ledger, or measure this machine's row. Returns the exit status."""
    prog = "python -m curriculum.text.ledger"
    parser = argparse.ArgumentParser(prog=prog, description=__doc__.split("\n")[0])
    parser.add_argument("--measure", action="store_true", help="time contact.py, write the row")
    parser.add_argument("--runs", type=int, default=9, help="counted runs (9)")
    args = parser.parse_args(argv)
    table = {row["tier"]: row for row in rows()}
    if args.measure:
        try:
            table[this_tier()] = measured_row(args.runs)
        except (RuntimeError, OSError) as error:
            print(f"nothing written: {error}", file=sys.stderr)
            return 1
        lines = [COLUMNS, *(row.values() for row in table.values())]
        write_whole(LEDGER, "".join(",".join(line) + "\n" for line in lines))
    for tier, row in table.items():
        minutes = float(row["wallclock_min"]) if row["wallclock_min"] else None
        note = " (stale)" if tier in stale_tiers() else ""
        print(f"{tier:<12}{show(minutes)}{note}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
