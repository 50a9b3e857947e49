"""What a learner wrote is tried in a process of its own, which ends when its time is up."""

import contextlib
import faulthandler
import importlib.util
import json
import os
import re
import subprocess
import sys
import traceback
from pathlib import Path

from curriculum.commands import near

LIMIT = 20  # s, chosen: right answers take about one
START = (
    "import sys; sys.path.insert(0, sys.argv[1]); from kit import time_limit; time_limit.child()"
)


def judged(name, file):
    """The state of an exercise, and [what, state, words, shown] of all that it asks for."""
    kit = str(Path(__file__).resolve().parents[1])
    command = [sys.executable, "-B", "-c", START, kit, name, str(file)]
    streams = {"capture_output": True, "encoding": "utf-8", "errors": "replace"}
    done = subprocess.run(command, stdin=subprocess.DEVNULL, **streams)
    if done.returncode == 0 and done.stdout:
        return json.loads(done.stdout)
    what = (re.findall(r"^trying (\w+)$", done.stderr, re.MULTILINE) or [name])[-1]
    line = re.search(rf'File ".*{re.escape(Path(file).name)}", line (\d+)', done.stderr)
    place = f"{near(str(file))}, line {line[1]}" if line else near(str(file))
    words = f"{what} ended its process (exit status {done.returncode}), see {place}"
    if "Timeout (" in done.stderr:
        words = f"{what} takes too long, or does not end: stopped after {LIMIT} s in {place}"
    return "wrong", [[what, "wrong", words, ""]]


def child():
    """The other process: try, and write what was found. Nothing that is printed is in its way."""
    name, file = sys.argv[2:]
    from . import trials  # which takes its time, too

    faulthandler.dump_traceback_later(LIMIT, exit=True)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        try:
            found = trials.judged(name, load(file))
        except (Exception, SystemExit) as error:
            found = "wrong", [[name, "wrong", unreadable(file, error), ""]]
    sys.stdout.write(json.dumps(found))


def load(file):
    """The module of an exercise."""
    spec = importlib.util.spec_from_file_location(Path(file).stem, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def unreadable(file, error):
    """One line on a file that is no Python."""
    hint = f"; {error.name} needs quotes around it" if type(error) is NameError else ""
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == str(file)]
    line = getattr(error, "lineno", None) or next(iter(lines), None)
    place = f"{near(str(file))}{f', line {line}' if line else ''}"
    return f"{place}, cannot be read: {type(error).__name__}: {error}{hint}"
