"""What several test files share."""

import os
import subprocess
import sys

from curriculum.source import ROOT

CONTACT = ROOT / "contact.py"
NO_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # as a learner has pytest


def python(*words, cwd=ROOT, **environment):
    """A finished process of this Python, its output as text."""
    words = [sys.executable, *map(str, words)]
    how = {"cwd": cwd, "env": os.environ | environment, "timeout": 1800}  # for what hangs alone
    return subprocess.run(words, capture_output=True, text=True, **how)
