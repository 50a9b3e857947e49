"""What a run found, as strict JSON, and the fingerprint of its knobs."""

import json
import math
import os
import sys

from curriculum.common.files import write_whole


def rounded(value, digits=12, steps=()):
    """`value` with every float in it rounded; None where it is not finite, and 0.0 for -0.0.

    Floats under the keys `steps` are time steps, which may be tiny: they keep that many leading
    digits instead of decimals.
    """
    if isinstance(value, dict):
        return {
            key: float(f"{item:.{digits}g}")
            if key in steps and isinstance(item, float)
            else rounded(item, digits, steps)
            for key, item in value.items()
        }
    if isinstance(value, float):
        return round(value, digits) + 0.0 if math.isfinite(value) else None
    return value


def write_json(path, value):
    """Write `value` whole: sorted keys, two spaces, newline at the end. Raises ValueError on NaN."""
    write_whole(path, json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n")


def figure(value, digits=3):
    """A number as a person reads it, "-" for None: an exponent only where zeros would hide it."""
    if value is None or value != value:
        return "-"
    size = abs(value)
    if size == 0.0:
        return "0"
    if size < 1e-4 or size >= 1e6:
        return f"{value:.{digits - 2}e}"
    return f"{value:,.0f}" if size >= 10**digits else f"{value:.{digits}g}"


def best_and_worst(rows, keys, reference, unknown):
    """{(name, key): "*" or "!"}: the rows nearest to the row `reference` and farthest from it.

    Where that row is missing the aim is 0, except for the key `unknown`. A row that blew up, or a
    value that is None, is farthest.
    """
    marks = {}
    for key in keys:
        if reference not in rows and key == unknown:
            continue
        aim = rows[reference][key] if reference in rows else 0.0
        off = {
            name: math.inf if row["blew_up"] or row[key] is None else abs(row[key] - aim)
            for name, row in rows.items()
            if name != reference
        }
        best, worst = min(off.values(), default=0.0), max(off.values(), default=0.0)
        marks |= {
            (name, key): "*" if off[name] == best else "!"
            for name in off
            if best < worst and off[name] in (best, worst)
        }
    return marks


def summary(name, rows, keys):
    """{"name median": row, "name lowest": row, "name highest": row} of many rows, by key.

    A value that is not finite counts as larger than any other. blew_up counts the rows that did.
    """
    made = {f"{name} {what}": {} for what in ("median", "lowest", "highest")}
    for key in keys:
        found = [row[key] for row in rows]
        if None in found:
            values = None, None, None
        else:
            found = sorted(value if math.isfinite(value) else math.inf for value in found)
            half = len(found) // 2
            values = 0.5 * (found[half] + found[-1 - half]), found[0], found[-1]
        for row, value in zip(made.values(), values):
            row[key] = value
    burst = sum(row["blew_up"] for row in rows)
    return {what: row | {"blew_up": burst} for what, row in made.items()}


def print_legend(meanings):
    """Print {heading: meaning}, a line each."""
    for heading, meaning in meanings.items():
        print(f"  {heading:<15}{meaning}")


def print_table(title, columns, rows, state, marks=None):
    """Print rows {name: {key: value}} under columns {heading: key}, and state(row) at the end.

    A heading stands in two lines, its last word below. marks {(name, key): "*" or "!"} stand
    behind the best and the worst figures, which a terminal shows in green and red besides.
    """
    marks = marks or {}
    cells = {
        (name, key): figure(row[key]) + marks.get((name, key), " ")
        for name, row in rows.items()
        for key in columns.values()
    }
    above, below = [""], [title]
    wide = [max(map(len, [title, *rows]))]
    for heading, key in columns.items():
        top, _, bottom = heading.rpartition(" ")
        above.append(f"{top} ")
        below.append(f"{bottom} ")
        wide.append(
            1
            + max(
                len(text) for text in (above[-1], below[-1], *(cells[name, key] for name in rows))
            )
        )
    for line in (above, below):
        text = "".join(f"{part:>{width}}" for part, width in zip(line[1:], wide[1:]))
        print(f"{line[0]:<{wide[0]}}{text}".rstrip() + (" state" if line is below else ""))
    for name, row in rows.items():
        text = "".join(
            colored(f"{cells[name, key]:>{width}}", marks.get((name, key)))
            for key, width in zip(columns.values(), wide[1:])
        )
        print(f"{name:<{wide[0]}}{text} {state(row)}")


def colored(text, mark):
    """The text in green for "*" and red for "!", on a terminal that wants colour; else as it is."""
    code = {"*": 32, "!": 31}.get(mark)
    if code is None or not sys.stdout.isatty() or "NO_COLOR" in os.environ:
        return text
    return f"\x1b[{code}m{text}\x1b[0m"


def fingerprint(knobs, but=()):
    """12 hexadecimal digits that change with any of the knobs {name: value}, except those in `but`."""
    import hashlib

    counted = {name: value for name, value in knobs.items() if name not in but}
    return hashlib.sha256(json.dumps(counted, sort_keys=True).encode()).hexdigest()[:12]
