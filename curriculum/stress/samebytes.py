"""One command, the same bytes: over hash seeds, threads, folders, Pythons, numpy and numba.

`python contact.py --smoke --no-rerun` of every scene; what is compared is stdout and metrics.json.
Each cell of the matrix is a process of its own. The interpreters are those found on this machine,
each in fresh virtual environments: the oldest and the newest numpy that installs there, without
numba, so that the plain loops step the pile, and with it, so that the compiled twin does.
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
from curriculum.stress.under_test import ROOT, contact

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
OLDEST = ("2.0.0", "2.1.0", "2.2.0", "2.3.0")  # tried in this order
ASK = (
    "import importlib.metadata as m, platform; "
    "print(platform.python_version(), *[f'{d.name}-{d.version}' for d in m.distributions() "
    "if d.name in ('numpy', 'numba')])"
)


def byte_jobs(quick, pythons):
    """One job for the settings of this interpreter, one for each interpreter and environment."""
    result = [jobs.job("bytes", "same bytes: this Python", quick=quick)]
    return result + [
        jobs.job(
            "bytes",
            f"same bytes: Python {version}, {which} numpy{', numba' * numba}",
            quick=False,
            python=version,
            which=which,
            numba=numba,
        )
        for version in pythons
        for which in ("oldest", "newest")
        for numba in (False, True)
    ]


def version_of(place):
    """The version of the Python at `place` as a tuple, () where there is none."""
    ask = "import sys; print(*sys.version_info[:3])"
    try:
        done = subprocess.run([place, "-c", ask], capture_output=True, text=True)
    except OSError:
        return ()
    return tuple(map(int, done.stdout.split())) if done.returncode == 0 else ()


def pythons_at_hand(least=None):
    """{version: path} of the CPythons found on PATH and under pyenv, from `least` on."""
    least = least or required_python()
    places = [sys.executable, *(shutil.which(f"python3.{minor}") or "" for minor in range(10, 20))]
    root = os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv"
    places += sorted(str(path) for path in Path(root).glob("versions/*/bin/python"))
    found = {}
    for place in filter(None, places):
        version = version_of(place)
        if version >= least:
            found.setdefault(version, place)
    return {".".join(map(str, version)): found[version] for version in sorted(found)}


def required_python():
    """The least Python that pyproject.toml allows, as a tuple."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    return tuple(map(int, re.search(r'requires-python\s*=\s*">=\s*([\d.]+)', text)[1].split(".")))


def environment(python, which, numba, folder):
    """Path of a Python in a fresh virtual environment with these packages, or None and why not."""
    subprocess.run([python, "-m", "venv", folder], check=True, capture_output=True)
    inside = str(Path(folder) / ("Scripts" if os.name == "nt" else "bin") / "python")
    pip = [
        inside,
        "-m",
        "pip",
        "install",
        "-q",
        "--disable-pip-version-check",
        "--only-binary",
        ":all:",
    ]
    error = ""
    for wanted in [f"numpy=={version}" for version in OLDEST] if which == "oldest" else ["numpy"]:
        done = subprocess.run([*pip, wanted, *["numba"] * numba], capture_output=True, text=True)
        if done.returncode == 0:
            return inside, ""
        error = done.stderr.strip().splitlines()[-1]
    return None, error


def digest(python, scene, env=None, cwd=None):
    """sha256 (16 digits) of stdout and metrics.json of one smoke run, or words why there is none.

    It runs in a fresh folder unless `cwd` names one; the relative path of its results is the same
    in both, since stdout names it. A pile has few balls enough for the plain loops to end soon, and
    enough for the compiled ones to take over.
    """
    with tempfile.TemporaryDirectory() as folder:
        where, out = Path(cwd or folder), f"outputs/same-bytes-{os.getpid()}"
        command = [
            python,
            str(ROOT / "contact.py"),
            "--smoke",
            "--no-rerun",
            "--scene",
            scene,
            "--out",
            out,
            *(["--bodies", "20"] if scene == "pile" else []),
        ]
        try:
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
            return hashlib.sha256(told(done.stdout) + metrics).hexdigest()[:16]
        finally:
            if cwd:
                shutil.rmtree(where / out, ignore_errors=True)


def told(stdout):
    """What a run says about the scene: without its end, what to do next with which Python."""
    return stdout.partition(b"\nnext")[0]


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


def run(quick, python=None, which=None, numba=False):
    """Result of one job: a row for each setting, or one for the environment named.

    Raises KeyError where that Python is not at hand (on another machine of a cluster).
    """
    scenes = ("drop", "stack") if quick else contact.SCENES
    right = {scene: reference(scene) for scene in scenes}
    cells = {}
    if python is None:
        for label, options in list(settings().items())[: 2 if quick else None]:
            cells[label] = {scene: digest(sys.executable, scene, **options) for scene in scenes}
    else:
        with tempfile.TemporaryDirectory() as folder:
            inside, error = environment(pythons_at_hand((3, 0))[python], which, numba, folder)
            if inside is None:
                label = f"Python {python}, {which} numpy{', numba' * numba}"
                return {
                    "cells": 0,
                    "rows": [
                        jobs.row(
                            label, "installs", f"no: {error[-150:]}", False, "does not install"
                        )
                    ],
                }
            versions = subprocess.run(
                [inside, "-c", ASK], capture_output=True, text=True, check=True
            )
            label = "Python " + ", ".join(sorted(versions.stdout.split()))
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
