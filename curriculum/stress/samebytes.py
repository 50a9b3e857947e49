"""One command, the same bytes: over hash seeds, threads, working folders, Pythons and numpy versions.

`python contact.py --smoke --no-rerun` of every scene; what is compared is stdout and metrics.json.
Each cell of the matrix is a process of its own. The interpreters are those found on this machine,
each in a fresh virtual environment with the oldest and with the newest numpy that installs there.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from curriculum.stress import jobs
from curriculum.stress.engine import ROOT, contact

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
OLDEST = ("2.0.0", "2.1.0", "2.2.0", "2.3.0")  # tried in this order
ASK = "import sys, numpy; print('.'.join(map(str, sys.version_info[:3])), numpy.__version__)"


def byte_jobs(quick, pythons):
    """One job for the settings of this interpreter, one for each interpreter and numpy at hand."""
    result = [jobs.job("bytes", "same bytes: this Python", quick=quick)]
    if not quick:
        result += [
            jobs.job(
                "bytes",
                f"same bytes: Python {version}, {which} numpy",
                quick=False,
                python=version,
                which=which,
            )
            for version in pythons
            for which in ("oldest", "newest")
        ]
    return result


def pythons_at_hand(least=None):
    """{version: path} of the CPythons found on PATH, under pyenv and by uv, from `least` on."""
    least = least or required_python()
    places = [sys.executable, *(shutil.which(f"python3.{minor}") or "" for minor in range(10, 20))]
    root = os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv"
    places += sorted(str(path) for path in Path(root).glob("versions/*/bin/python"))
    if shutil.which("uv"):
        places += subprocess.run(
            ["uv", "python", "find"], capture_output=True, text=True
        ).stdout.split("\n")
    found = {}
    for place in filter(None, places):
        done = subprocess.run(
            [place, "-c", "import sys; print('.'.join(map(str, sys.version_info[:3])))"],
            capture_output=True,
            text=True,
        )
        version = done.stdout.strip()
        if done.returncode == 0 and tuple(map(int, version.split("."))) >= least:
            found.setdefault(version, place)
    return dict(sorted(found.items(), key=lambda item: tuple(map(int, item[0].split(".")))))


def required_python():
    """The least Python that pyproject.toml allows, as a tuple."""
    try:
        text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
        return tuple(
            map(int, re.search(r'requires-python\s*=\s*">=\s*([\d.]+)', text)[1].split("."))
        )
    except (OSError, TypeError):
        return (3, 10)


def environment(python, which, folder):
    """Path of a Python in a fresh virtual environment with that numpy, or None and why not."""
    subprocess.run([python, "-m", "venv", folder], check=True, capture_output=True)
    inside = str(Path(folder) / ("Scripts" if os.name == "nt" else "bin") / "python")
    error = ""
    for wanted in [f"numpy=={version}" for version in OLDEST] if which == "oldest" else ["numpy"]:
        done = subprocess.run(
            [
                inside,
                "-m",
                "pip",
                "install",
                "-q",
                "--disable-pip-version-check",
                "--only-binary",
                "numpy",
                wanted,
            ],
            capture_output=True,
            text=True,
        )
        if done.returncode == 0:
            return inside, ""
        error = done.stderr.strip().splitlines()[-1]
    return None, error


def digest(python, scene, env=None, cwd=None):
    """sha256 (16 digits) of stdout and metrics.json of one smoke run, or words for why there is none.

    It runs in a fresh folder unless `cwd` names one; the relative path of its results is the same
    in both, since stdout names it.
    """
    with tempfile.TemporaryDirectory() as folder:
        where, out = Path(cwd or folder), f"outputs/same-bytes-{os.getpid()}"
        try:
            command = [python, str(ROOT / "contact.py"), "--smoke", "--no-rerun"]
            command += ["--scene", scene, "--out", out]
            command += (
                ["--bodies", "20"] if scene == "pile" else []
            )  # a full pile takes half a minute
            done = subprocess.run(
                command,
                cwd=where,
                env={**os.environ, **(env or {})},
                capture_output=True,
                timeout=600,
            )
            if done.returncode:
                return f"exit {done.returncode}: {done.stderr.decode().strip()[-100:]}"
            metrics = (where / out / "metrics.json").read_bytes()
            return hashlib.sha256(done.stdout + metrics).hexdigest()[:16]
        finally:
            if cwd:
                shutil.rmtree(where / out, ignore_errors=True)


def reference(scene):
    """What every cell must equal: this interpreter, hash seed 0, one thread."""
    return digest(sys.executable, scene, {"PYTHONHASHSEED": "0", **dict.fromkeys(THREADS, "1")})


def settings():
    """{label: keyword arguments of digest} for cells that differ in settings alone."""
    return {
        "PYTHONHASHSEED 1": dict(env={"PYTHONHASHSEED": "1"}),
        "PYTHONHASHSEED random": dict(env={"PYTHONHASHSEED": "random"}),
        "2 threads": dict(env=dict.fromkeys(THREADS, "2")),
        "64 threads": dict(env=dict.fromkeys(THREADS, "64")),
        "from the project's folder": dict(cwd=ROOT),
        "optimised, other locale and time zone": dict(
            env={"PYTHONOPTIMIZE": "2", "LC_ALL": "C", "TZ": "Asia/Tokyo"}
        ),
    }


def run(quick, python=None, which=None):
    """Result of one job: a row for each setting, or one for the version of Python and the numpy named.

    Raises KeyError where that Python is not at hand (on another machine of a cluster).
    """
    scenes = ("drop", "stack") if quick else contact.SCENES
    right = {scene: reference(scene) for scene in scenes}
    cells = {}
    if python is None:
        for label, options in list(settings().items())[: 3 if quick else None]:
            cells[label] = {scene: digest(sys.executable, scene, **options) for scene in scenes}
    else:
        with tempfile.TemporaryDirectory() as folder:
            inside, error = environment(pythons_at_hand((3, 0))[python], which, folder)
            if inside is None:
                return {
                    "cells": 0,
                    "rows": [
                        jobs.row(
                            f"{which} numpy",
                            "installs or is named as not installing",
                            f"does not install: {error[-150:]}",
                            True,
                        )
                    ],
                }
            versions = subprocess.run(
                [inside, "-c", ASK], capture_output=True, text=True, check=True
            ).stdout.split()
            label = "Python {}, numpy {}".format(*versions)
            cells[label] = {scene: digest(inside, scene) for scene in scenes}
    rows = []
    for label, got in cells.items():
        unlike = {scene: got[scene] for scene in scenes if got[scene] != right[scene]}
        rows.append(
            jobs.row(
                label,
                f"the bytes of {', '.join(scenes)} as with seed 0, one thread",
                "the same" if not unlike else json.dumps(unlike),
                not unlike,
            )
        )
    return {"cells": len(rows) * len(scenes), "rows": rows}
