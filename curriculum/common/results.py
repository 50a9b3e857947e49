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


def fingerprint(knobs):
    """12 hexadecimal digits that change with any knob {name: value}; the order of names doesn't count."""
    import hashlib
    return hashlib.sha256(json.dumps(knobs, sort_keys=True).encode()).hexdigest()[:12]
