"""Which machine a run is on, and the two lines every chapter prints first. Needs no torch."""

import os
import sys

from curriculum.common import wallclock


def cpu_tier():
    """The tier of this machine's CPU: what it really is, or just "cpu" where that isn't known.

    Linux tells: "cpu-vm" where the kernel sees a hypervisor (cloud machines, CI, WSL), else
    "cpu-laptop" with a battery, "cpu-desktop" without. Elsewhere the name claims nothing: "cpu".
    """
    if not sys.platform.startswith("linux"):
        return "cpu"
    try:
        with open("/proc/cpuinfo", "rb") as file:
            first_core = file.read(4096)  # one core is enough; all of them can take 10 ms
        if b" hypervisor" in first_core or os.path.exists("/sys/hypervisor/type"):
            return "cpu-vm"
        supplies = os.listdir("/sys/class/power_supply")
    except OSError:
        return "cpu"
    return "cpu-laptop" if any(name.startswith("BAT") for name in supplies) else "cpu-desktop"


def banner(chapter_id, device="cpu", usual=True):
    """Print device and tier, then what the ledger knows about the time of this run.

    usual: whether it is the default run, the one that was measured.
    """
    tier = cpu_tier() if device == "cpu" else device
    print(f"[{chapter_id}] device: {device} | tier: {tier}")
    print(f"[{chapter_id}] {wallclock.render_line(chapter_id, tier, usual=usual)}")
