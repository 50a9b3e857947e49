"""How much memory a run may take."""

import os


def available():
    """Bytes that a new process can have, or infinity where the system doesn't say."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return 1024 * int(line.split()[1])
    except (OSError, ValueError):
        pass
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return float("inf")


def need(parser, size, what):
    """End with the parser's one-line error where `what` was asked for and needs more bytes than there are."""
    if size > 1e8 and size > available():
        parser.error(
            f"given {what}, which need {size / 1e9:.3g} GB of memory; "
            f"allowed: {available() / 1e9:.3g} GB, what is free here"
        )
