"""What several test files share."""

import contextlib
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time

import pytest

from curriculum.source import ROOT, read_all, replace_once

CONTACT = ROOT / "contact.py"
NO_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # as a learner has pytest


def python(*words, cwd=ROOT, **environment):
    """A finished process of this Python, its output as text."""
    words = [sys.executable, *map(str, words)]
    how = {"cwd": cwd, "env": os.environ | environment, "timeout": 1800}  # for what hangs alone
    return subprocess.run(words, capture_output=True, text=True, **how)


def stopped(number, words, ready, terminal=False, cwd=ROOT):
    """Start this Python and, once ready(process), send a signal to it, or as a terminal does to its
    whole group. Return its status and what it printed, once no process of the group is left."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    words = [sys.executable, *map(str, words)]
    with subprocess.Popen(words, cwd=cwd, start_new_session=True, **pipes) as process:
        try:
            while not ready(process):
                assert process.poll() is None
                time.sleep(0.01)
            (os.killpg if terminal else os.kill)(process.pid, number)
            printed = process.communicate(timeout=100)  # one that ends takes a second
            with pytest.raises(ProcessLookupError):
                for _ in range(6000):  # a minute: what lives on would take longer
                    os.killpg(process.pid, 0)
                    time.sleep(0.01)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # or it would be waited for, or live on
            raise
    return process.returncode, *printed


def clone(folder, *leave):
    """Copy the course into a folder, but for hidden files and those so named; return the folder."""
    leave = shutil.ignore_patterns(".*", "__pycache__", "outputs", *leave)
    shutil.copytree(ROOT, folder, ignore=leave, dirs_exist_ok=True)
    with contextlib.suppress(OSError):  # share compiled loops, which are named by their source
        (ROOT / ".cache/loops").mkdir(parents=True, exist_ok=True)
        (folder / ".cache").mkdir()
        (folder / ".cache/loops").symlink_to(ROOT / ".cache/loops")
    return folder


def edit(path, old, new):
    """Replace a text that stands once in a file."""
    path.write_text(replace_once(path.read_text("utf-8"), old, new, path.name), "utf-8")


SHORT = """# Chapter

## A sponge

The ball rests {{quality.penalty.rest_penetration_frac|.5f}} r deep, seen from a margin of
{{contact.CONTACT_MARGIN * 1000|.0f}} mm, and [drops](#x) by {{friction:ahead|.1f}} m/s.
{{? quality.penalty.rest_penetration_frac > quality.lcp.rest_penetration_frac}} It stays there.
<!-- no 9 is
typed here -->

## A sweep

One sweep of `solve_contacts` pushes, as with `--iters 1`. Python 3.10 and $k = 10$ are not typed.
SLOTS
```
# 7, no heading
```

## Code
"""

FIGURE = r"""const x = 1;
export const figure = {
  title: "A `solve_contacts`",
  caption: ({ dt }) => `It pushes by ${1000 * dt} px.`,
  height: () => 9,
  start: () => ({ model: "lcp" }),
  draw: () => ({ picture: [], words: "", values: { x } }),
};
"""


def shorten(folder, slots):
    """Give a clone a short chapter with these slots and every region, one run, and no times."""
    shown = [f"\n```\n[include-by-region: {each.source}]\n```\n" for each in read_all().values()]
    text = SHORT.replace("SLOTS", slots) + "".join(shown)
    (folder / "curriculum/prose/chapter.md").write_text(text, "utf-8")
    (folder / "README.md").write_text("# Contact\n", "utf-8")
    (folder / "meta.yaml").write_text("runs:\n  drop: []\n\nregion_hashes: {}\nread: {}\n", "utf-8")
    (folder / "wallclock.csv").write_text(
        "chapter,tier,wallclock_min,config_hash,commit,date,status\nch3.5-contact,t4,,,,,PENDING\n"
    )


def gate(folder, *flags):
    """`python -m curriculum.gate FLAGS` in a clone."""
    return python("-m", "curriculum.gate", *flags, cwd=folder)


def review(folder):
    """Run the gate, and record as reviewed what it asks for; return the lines of the problems."""
    *lines, _, every = gate(folder).stdout.splitlines()
    done = gate(folder, "--read", *shlex.split(every.partition(" --read ")[2]))
    assert done.returncode == 0, every + done.stderr
    return lines
