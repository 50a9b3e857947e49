"""What a run found, as strict JSON, and the fingerprint of its knobs."""

import json
import math

from curriculum.common.files import write_whole


def rounded(value, digits=12):
    """`value` with every float in it rounded; None where it is not finite, and 0.0 for -0.0."""
    if isinstance(value, dict):
        return {key: rounded(item, digits) for key, item in value.items()}
    if isinstance(value, float):
        return round(value, digits) + 0.0 if math.isfinite(value) else None
    return value


def write_json(path, value):
    """Write `value` whole: sorted keys, two spaces, newline at the end. Raises ValueError on NaN."""
    write_whole(path, json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n")


def show(value, form):
    """`value` in that format, "-" for None."""
    return "-" if value is None else format(value, form)


def print_table(title, columns, rows, state):
    """Print rows {name: {key: value}} under columns {heading: key}, and state(row) at the end."""
    print(f"{title:<8}" + "".join(f"{heading:>13}" for heading in columns) + "  state")
    for name, row in rows.items():
        print(f"{name:<8}" + "".join(f"{show(row[key], '.3e'):>13}" for key in columns.values())
              + f"  {state(row)}")


def fingerprint(knobs, but=()):
    """12 hexadecimal digits that change with any of the knobs {name: value}, except those in `but`."""
    import hashlib
    counted = {name: value for name, value in knobs.items() if name not in but}
    return hashlib.sha256(json.dumps(counted, sort_keys=True).encode()).hexdigest()[:12]
