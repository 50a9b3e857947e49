"""Jobs: what can be computed on its own, anywhere, from a name and a few plain values.

A job is a dict {"name": str, "kind": str, "params": {...}}; its result is plain JSON as well,
the same on every worker, so reports from one process, many or a cluster are equal cell for cell,
but for how many runs of exact are cut by their limit of time (trial.SECONDS).
Every result has "cells" (how many runs were judged) and "rows", a list of judgements (`row`).
"""

import json
import math
from importlib import import_module

KINDS = {
    "penalty-map": "maps:penalty_row",
    "lcp-map": "maps:lcp_row",
    "lcp-depth": "maps:depth_row",
    "lcp-converges": "maps:converges_row",
    "soft-map": "maps:soft_row",
    "exact-map": "maps:exact_row",
    "extreme": "extremes:run",
    "scenes": "invariants:run_batch",
    "boards": "invariants:run_boards",
    "scene": "invariants:run_scene",
    "seeds": "maps:run_seeds",
    "bytes": "samebytes:run",
    "exact-pile": "exact_sweep:pile",
    "exact-wide": "exact_sweep:wide",
    "exact-towers": "exact_sweep:towers",
    "exact-tall": "exact_sweep:tall",
    "exact-first": "exact_sweep:first",
}
HOLDS, LIMIT, VIOLATION, DIED = "holds", "limit", "VIOLATION", "DIED"


def job(kind, label, /, **params):
    """A job of a kind in KINDS; `label` is unique within a report."""
    if kind not in KINDS:
        raise ValueError(f"kind {kind!r}; allowed: {', '.join(KINDS)}")
    return {"kind": kind, "name": label, "params": params}


def key(a_job):
    """The text a finished job is remembered by."""
    return json.dumps(a_job, sort_keys=True)


def run(a_job):
    """The result of one job. Raises what the job raises; KeyError for an unknown kind."""
    module, function = KINDS[a_job["kind"]].split(":")
    result = getattr(import_module(f"curriculum.stress.{module}"), function)(**a_job["params"])
    return plain(result)


def row(at, expected, got, ok, limit=None):
    """One judgement: where, what was expected, what came out, and a status.

    limit: words that name a limit of the model, given when the expectation is missed by no more
    than that limit's derived bound. Such a row is listed as a limit, any other miss is a violation.
    """
    found = {
        "at": at,
        "expected": expected,
        "got": got,
        "status": HOLDS if ok else LIMIT if limit else VIOLATION,
    }
    return found | {"limit": limit} if found["status"] == LIMIT else found


def plain(value):
    """`value` as strict JSON has it: numpy numbers unpacked, what is not finite as a word."""
    if isinstance(value, dict):
        return {str(name): plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value
