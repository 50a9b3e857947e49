"""results.json: one section a command, each with the machine it was measured on."""

import importlib.metadata
import json
import math
import os
import platform
import subprocess
from datetime import date
from pathlib import Path

import contact
from curriculum.bench import peers
from curriculum.common.files import write_whole

ROOT = Path(contact.__file__).resolve().parent
RESULTS = Path(__file__).resolve().parent / "results"      # the full runs, which the repository keeps
QUICK = ROOT / "outputs" / "bench-quick"                   # the short ones, which it does not
NAME = "results.json"


def load(folder):
    """The sections in `folder`, {} where there are none yet."""
    path = Path(folder) / NAME
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def save(folder, name, section):
    """Put a section into results.json, whole or not at all; returns all sections, as read back."""
    sections = {**load(folder), name: {**section, "machine": machine()}}
    write_whole(str(Path(folder) / NAME), text(sections))
    return load(folder)


def text(value, level=0):
    """Strict JSON: dicts and lists over several lines three levels deep, everything below on one line.

    Six significant digits; what is not finite is null, as in metrics.json.
    """
    if not isinstance(value, (dict, list)) or level > 3 or not value or _flat(value):
        line = json.dumps(_plain(value), allow_nan=False)
    else:
        items = ([f"{json.dumps(key)}: {text(value[key], level + 1)}" for key in value]
                 if isinstance(value, dict) else [text(item, level + 1) for item in value])
        indent = "\n" + " " * (level + 1)
        opening, closing = "{}" if isinstance(value, dict) else "[]"
        line = opening + indent + ("," + indent).join(items) + "\n" + " " * level + closing
    return line if level else line + "\n"


def _flat(value):
    items = value.values() if isinstance(value, dict) else value
    return not any(isinstance(item, (dict, list)) for item in items)


def _plain(value):
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    return value


def machine():
    """Where and with what the numbers were measured, for the footer: nothing that names a host."""
    versions = {}
    for package in ("numpy", "matplotlib", *sorted({p.package for p in peers.PEERS}), "rerun-sdk"):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = None
    return dict(processor=_processor(), cores=os.cpu_count(), system=platform.system(),
                architecture=platform.machine(), python=platform.python_version(), versions=versions,
                date=date.today().isoformat(), **_commit())


def _processor():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown processor"


def _commit():
    """Short hash of the commit, and whether contact.py or the benchmark differed from it when measured."""
    def git(*command):
        run = subprocess.run(["git", *command], cwd=ROOT, capture_output=True, text=True)
        return run.stdout.strip() if run.returncode == 0 else None
    try:
        changed = git("status", "--porcelain", "--", "contact.py", "curriculum/bench/*.py",
                      "curriculum/common")
        return dict(commit=git("rev-parse", "--short=10", "HEAD"), changed=bool(changed))
    except OSError:         # no git
        return dict(commit=None, changed=None)


def footer(section):
    """One paragraph: machine, versions, commit and date of a section."""
    m = section["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in m["versions"].items() if version)
    commit = f"commit {m['commit']}" if m["commit"] else "no commit known"
    if m["changed"]:
        commit += " with uncommitted changes"
    short = " A quick run, on reduced settings: not for quoting." if section.get("quick") else ""
    return (f"Measured on {m['date']} at {commit}, on {m['cores']} cores of {m['processor']} "
            f"({m['system']}, {m['architecture']}), BLAS on one thread, with Python {m['python']}, "
            f"{versions}.{short}")
