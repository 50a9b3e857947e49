"""The ledger of measured wall-clock, wallclock.csv, and the command that measures a row of it.

    python -m curriculum.measured.ledger cpu-laptop   # time `python contact.py` here, write its row

wallclock_min: minutes of a whole process, recording included, the median of nine. A row is MEASURED
or PENDING; it is stale as soon as the code of config_hash changes.
"""

import csv
import io
import statistics
import sys
import tempfile
from pathlib import Path

from curriculum.commands import Parser, write_whole
from curriculum.measured.results import dirty, machine
from curriculum.measured.stale import digest, fingerprint
from curriculum.regions import ROOT

LEDGER = ROOT / "wallclock.csv"
COMMAND = "python -m curriculum.measured.ledger"
TIMED = (
    "contact.py",
    "curriculum/show/picture.py",
    "curriculum/show/recording.py",
)  # a default run


def rows() -> list:
    """The rows, dicts of str."""
    return list(csv.DictReader(LEDGER.read_text("utf-8").splitlines()))


def show(row) -> str:
    """A row's time as text, with two digits: in seconds below a minute."""
    if row["status"] == "PENDING":
        return "not yet measured"
    taken = float(row["wallclock_min"])
    return f"{taken:.2g} min" if taken >= 1 else f"{60 * taken:.2g} s"


def stale(row) -> bool:
    """Whether a row was measured on other code than today's."""
    return row["config_hash"] not in ("", digest(fingerprint(*TIMED)))


def main(argv=None) -> int:
    """Measure a tier's row, write and show it. Returns the exit status."""
    parser = Parser(prog=COMMAND, description=__doc__.split("\n")[0])
    parser.add_argument("tier", help="what the ledger calls this machine, such as cpu-laptop")
    tier, about = parser.parse_args(argv).tier, machine()
    if dirty():
        parser.error(f"a row is kept with its commit; commit these first: {dirty()}")
    from curriculum.bench.timing import whole_process

    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "contact.py", "--out", out]
        seconds = [whole_process(command, out) for _ in range(10)]  # the first warms the caches
        if not list(Path(out).glob("*.rrd")):
            parser.error("no recording: pip install rerun-sdk")
    table = {row["tier"]: row for row in rows()}
    minutes = f"{statistics.median(seconds[1:]) / 60:.3g}"
    facts = minutes, digest(fingerprint(*TIMED)), about["commit"], about["date"], "MEASURED"
    table[tier] = dict(zip(rows()[0], ("ch3.5-contact", tier, *facts)))
    text = io.StringIO()
    writer = csv.DictWriter(text, table[tier], lineterminator="\n")
    writer.writeheader()
    writer.writerows(table.values())
    write_whole(LEDGER, text.getvalue())
    print(f"{tier}: {show(table[tier])}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
