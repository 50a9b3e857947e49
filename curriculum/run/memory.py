"""How much memory a run of contact.py needs, and whether this machine has it."""

import os


def too_much(steps: int, count: int) -> str | None:
    """One line on a run of `count` balls that this machine cannot hold; None if it can."""
    need = steps * (320 * count + 1500)  # bytes, measured: all four models and their recording
    have = 8e9  # bytes, chosen, where the machine does not say
    if hasattr(os, "sysconf"):
        have = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if need <= have:
        return None
    return (
        f"--steps {steps} of {count} balls need {need / 1e9:.0f} GB of memory; "
        f"allowed: {have / 1e9:.0f} GB, what there is"
    )
