"""On what a result was measured: the machine, and the commit."""

import os
import platform
import subprocess
from datetime import date
from importlib import metadata
from pathlib import Path

from curriculum.regions import ROOT

PACKAGES = ("numpy", "numba", "rerun-sdk", "mujoco", "pymunk", "pyb2d3", "drake", "scipy")
COMMIT = "describe --always --abbrev=10 --exclude=*".split()


def machine() -> dict:
    """Date, commit, processor, system and versions: texts, but for versions, {package: text}.

    Packages that are not installed are left out. The commit ends in "+" where Python files differ
    from it, and is "unknown" without git.
    """
    return {
        "date": date.today().isoformat(),
        "commit": (git(*COMMIT).strip() or "unknown") + "+" * bool(dirty()),
        "cpu": processor(),
        "cores": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {
            name: found.version for name in PACKAGES for found in metadata.distributions(name=name)
        },
    }


def dirty() -> str:
    """The Python files that differ from the commit, as git shows them; "" without git."""
    return git("status", "--porcelain", "--", "*.py").strip()


def git(*words) -> str:
    """What a git command prints; nothing where it fails or there is no git."""
    try:
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True).stdout
    except OSError:
        return ""


def processor() -> str:
    """The name of the processor, as the system gives it."""
    try:
        info = Path("/proc/cpuinfo").read_text("utf-8")
        return info.split("model name")[1].split(":", 1)[1].split("\n")[0].strip()
    except (OSError, IndexError):
        return platform.processor() or "unknown processor"
