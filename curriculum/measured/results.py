"""Measured results: kept with the machine and the code that they were measured on.

The benchmark and the stress report each keep one file results.json, with a section per command. A
section says under "measured" how it came to be: the command that measures it again, the machine,
and the fingerprints of the code that made it, by which it is stale or not (stale.py):

    origin = results.origin("python -m curriculum.bench skip", "curriculum/bench/skips.py")
    results.save(folder, "skip", skips.measure(), origin)
"""

import json
import os
import platform
import re
import subprocess
from datetime import date
from importlib import metadata
from pathlib import Path

from curriculum.commands import write_json, write_whole
from curriculum.lesson.regions import ROOT, read_text
from curriculum.measured import stale

BLOCK = re.compile(r"(<!-- generated: (\w+) by .*? -->)\n(.*?)(?=<!-- end -->)", re.DOTALL)
FOLDERS = {"bench": "curriculum/bench/results", "stress": "curriculum/stress/results"}
NAME = "results.json"
NAMES = {"bench": "made.json", "stress": NAME}
DIGITS = 6  # significant digits that a results file keeps
PACKAGES = ("numpy", "numba", "rerun-sdk", "mujoco", "pymunk", "pyb2d3", "drake", "scipy")
COMMIT = "describe --always --abbrev=10 --exclude=*".split()


def load(name: str) -> dict:
    """{section: results} of "bench" or "stress"; {} where nothing has been measured yet."""
    if name == "bench":  # its rows are CSV files, which nothing quotes
        made = json.loads(read_text(f"{FOLDERS[name]}/{NAMES[name]}") or "{}")
        return {section: {"measured": about} for section, about in made.items()}
    return json.loads(read_text(f"{FOLDERS[name]}/{NAME}") or "{}")


def origin(command: str, *files, kept=True) -> dict:
    """How a section comes to be; to be asked before it is measured.

    command: what measures it again, as one types it. files: the modules that measure; what they
    import of bench/ and stress/ is found. Raises ValueError where the results are to be kept, and
    the code is not that of a commit.
    """
    if kept and dirty():
        raise ValueError(f"{command} is kept with its commit; commit these first: {dirty()}")
    return {"command": command, **machine(), "code": stale.fingerprint(*stale.made_by(*files))}


def save(folder: Path, section: str, values: dict, origin: dict) -> dict:
    """Put one section into a folder's results, whole or not at all; returns it as it reads back."""
    path = folder / NAME
    sections = json.loads(path.read_text("utf-8")) if path.exists() else {}
    sections[section] = rounded({"measured": origin, **values})
    write_json(path, sections)
    return sections[section]


def rounded(value: dict) -> dict:
    """`value` as strict JSON: numpy unpacked, floats with six digits, None for not finite."""
    return json.loads(
        json.dumps(value, default=lambda array: array.tolist()),
        parse_float=lambda text: float(f"{float(text):.{DIGITS}g}"),
        parse_constant=lambda name: None,
    )


def table(head, rows) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in lines)


def footer(section: dict) -> str:
    """One paragraph for the end of a page: when and on what it was measured."""
    about = section["measured"]
    versions = ", ".join(f"{name} {number}" for name, number in about["versions"].items())
    return (
        f"Measured by `{about['command']}` on {about['date']} at commit {about['commit']}, on "
        f"{about['cores']} cores of {about['cpu']} ({about['os']}), with Python {about['python']}, "
        f"{versions}."
    )


def write_block(name: str, markdown: str) -> None:
    """Put the Markdown of "bench" or "stress" into the project's README, between its markers."""

    def block(match):
        return f"{match[1]}\n{markdown.strip()}\n" if match[2] == name else match[0]

    write_whole(ROOT / "README.md", BLOCK.sub(block, read_text("README.md")))


def machine() -> dict:
    """Date, commit ("unknown" without git; with "+" where Python files differ from it), processor
    and system; and the versions of packages that are installed, {package: text}."""
    versions = {
        name: each.version for name in PACKAGES for each in metadata.distributions(name=name)
    }
    return {
        "date": date.today().isoformat(),
        "commit": (git(*COMMIT).strip() or "unknown") + "+" * bool(dirty()),
        "cpu": processor(),
        "cores": str(os.cpu_count()),
        "os": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": versions,
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
    info = Path("/proc/cpuinfo")
    name = re.search(r"model name\s*: (.+)", info.read_text("utf-8") if info.exists() else "")
    return name[1] if name else platform.processor() or "unknown processor"
