"""The ledger of measured wall-clock, wallclock.csv, and the command that measures a row of it.

    python -m curriculum.measured.ledger cpu-laptop   # time `python contact.py` here, write its row

Seven columns, no quoting. wallclock_min is in minutes for a whole process, recording included, the
median of several. A row is MEASURED with every column filled, or PENDING with none; no time is ever
guessed. config_hash is of the code that was timed, so a row is stale as soon as that changes.
"""

import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from curriculum.commands import Parser, write_whole
from curriculum.measured.results import dirty, machine
from curriculum.measured.stale import digest, fingerprint
from curriculum.regions import ROOT

LEDGER = ROOT / "wallclock.csv"
CHAPTER = "ch3.5-contact"
COLUMNS = ("chapter", "tier", "wallclock_min", "config_hash", "commit", "date", "status")
FILLED = r"\d[\d.e-]*,[0-9a-f]{12},[0-9a-f]+\+?,\d{4}-\d\d-\d\d,MEASURED"
ROW = re.compile(rf"[\w.-]+,[\w-]+,({FILLED}|,,,,PENDING)")
COMMAND = "python -m curriculum.measured.ledger"
TIMED = ("contact.py", "curriculum/run/plotting.py", "curriculum/run/recording.py")  # a default run


def rows() -> list:
    """The rows, dicts of str. Raises ValueError `file:line: what`."""
    head, *lines = LEDGER.read_text("utf-8").splitlines()
    if head != ",".join(COLUMNS):
        raise ValueError(f"wallclock.csv:1: the header must be {','.join(COLUMNS)}")
    for k, line in enumerate(lines, 2):
        if not ROW.fullmatch(line):
            raise ValueError(f"wallclock.csv:{k}: neither a whole MEASURED row nor a PENDING one")
    return [dict(zip(COLUMNS, line.split(","))) for line in lines]


def show(row) -> str:
    """A row's time as text, with two digits: in seconds below a minute."""
    if row["status"] == "PENDING":
        return "not yet measured"
    taken = float(row["wallclock_min"])
    text = f"{taken:.2g} min" if taken >= 1 else f"{60 * taken:.2g} s"
    return text + " (stale)" * stale(row)


def code_hash() -> str:
    """12 hexadecimal digits of the code that a default run runs."""
    return digest(fingerprint(*TIMED))


def stale(row) -> bool:
    """Whether a row was measured on other code than today's."""
    return row["config_hash"] not in ("", code_hash())


def measure(runs: int) -> list:
    """Seconds of `python contact.py` as a whole process; the first of them also warms caches.

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
    return seconds


def minutes(seconds: list) -> float:
    """What the ledger holds of these times: the median in minutes, without the first."""
    return statistics.median(seconds[1:]) / 60


def main(argv=None) -> int:
    """Measure a tier's row, write and show it. Returns the exit status."""
    parser = Parser(prog=COMMAND, description=__doc__.split("\n")[0])
    parser.add_argument("tier", help="what the ledger calls this machine, such as cpu-laptop")
    parser.add_argument("--runs", type=int, default=9, help="counted runs (9)")
    args = parser.parse_args(argv)
    try:
        table = {row["tier"]: row for row in rows()}
        if dirty():
            raise ValueError(f"a row is kept with its commit; commit these first: {dirty()}")
        about, taken = machine(), minutes(measure(args.runs))
        facts = f"{taken:.3g}", code_hash(), about["commit"], about["date"], "MEASURED"
        table[args.tier] = dict(zip(COLUMNS, (CHAPTER, args.tier, *facts)))
        lines = [",".join(row.values()) for row in table.values()]
        write_whole(LEDGER, "\n".join([",".join(COLUMNS), *lines, ""]))
    except (OSError, RuntimeError, ValueError) as error:
        print(f"nothing written: {error}", file=sys.stderr)
        return 1
    print(f"{args.tier}: {show(table[args.tier])}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
