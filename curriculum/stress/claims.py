"""How the claims of a property are held against what it is stated of, and what is counted.

A property is a generator of claims (words, off, allowed, where). off, allowed: arrays of what was
found to be off, and of what rounding explains; where: which of them are judged, all if it is left
out. It claims nothing where nothing could fail.
"""

import numpy as np


def judge(subject, *properties):
    """{property: [comparisons, off as a share of what is allowed at worst, words or None]}.

    comparisons: how many numbers could have failed; 0 where the property says nothing of the
    subject. words: the first claim that does not hold. An error of the code under test is a
    violation too.
    """
    found = {}
    for function in properties:
        found[function.__name__] = row = [0, 0.0, None]
        try:
            with np.errstate(all="ignore"):
                for claim in function(subject):
                    compare(row, *claim)
        except Exception as error:
            row[0], row[2] = row[0] + 1, f"{type(error).__name__}: {error}"
    return found


def compare(row, words, off, allowed, where=True):
    """Add a claim to the row of its property. What is not a number does not hold."""
    off, allowed, where = np.broadcast_arrays(np.asarray(off, float), allowed, where)
    row[0] += int(where.sum())
    share = np.where(off == 0.0, 0.0, off / allowed)[where]
    row[1] = float(np.nan_to_num(share, nan=np.inf).max(initial=row[1]))
    wrong = where & ~(off <= allowed)
    if wrong.any() and row[2] is None:
        place = tuple(np.argwhere(wrong)[0].tolist())
        row[2] = f"{words}: off by {off[place]:.3g}, allowed {allowed[place]:.3g} at {place}"


def unlike(run, other):
    """The claim that two runs have the same bits: (1 for each number that differs, 0)."""
    a, b = (np.concatenate((each.q, each.v), axis=1) for each in (run, other))
    return ~((a == b) | (a != a) & (b != b)), 0.0
