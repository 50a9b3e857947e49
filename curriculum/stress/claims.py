"""What a property is, how its claims are held against a Trial, and what is counted."""

import numpy as np

PROPERTIES = {}


def stated(function):
    """Register a property under its name: a generator of claims (words, off, allowed).

    off, allowed: arrays of what was found to be off, and of what rounding explains. A property
    claims nothing where nothing could fail.
    """
    PROPERTIES[function.__name__] = function
    return function


def judge(trial, names=None):
    """{property: [comparisons, off as a share of what is allowed at worst, words or None]}.

    comparisons: how many numbers could have failed; 0 where the property says nothing of the scene.
    words: the first claim that does not hold. An error of the code under test is a violation too.
    """
    found = {}
    for name in names or PROPERTIES:
        found[name] = row = [0, 0.0, None]
        try:
            with np.errstate(all="ignore"):
                for words, off, allowed in PROPERTIES[name](trial):
                    compare(row, words, np.asarray(off, float), np.asarray(allowed, float))
        except Exception as error:
            row[0], row[2] = row[0] + 1, f"{type(error).__name__}: {error}"
    return found


def compare(row, words, off, allowed):
    """Add a claim to the row of its property. What is not a number does not hold."""
    off, allowed = np.broadcast_arrays(off, allowed)
    if not off.size:
        return
    row[0] += off.size
    share = np.where(off == 0.0, 0.0, off / allowed)
    row[1] = max(row[1], float(np.nan_to_num(share, nan=np.inf).max()))
    wrong = ~(off <= allowed)
    if wrong.any() and row[2] is None:
        place = tuple(int(k[0]) for k in np.nonzero(wrong))
        row[2] = f"{words}: off by {off[place]:.3g}, allowed {allowed[place]:.3g} at {place}"


def chosen(where, off, allowed):
    """Both where `where` says so; the three are stretched to one shape."""
    where, off, allowed = np.broadcast_arrays(where, off, allowed)
    return off[where], allowed[where]


def unlike(run, other):
    """The claim that two runs have the same bits: (1 for each number that differs, 0)."""
    a, b = (np.concatenate((each.q, each.v), axis=1) for each in (run, other))
    return ~((a == b) | (a != a) & (b != b)), 0.0
