"""The order of the tests, what they start with, and two fixtures of several files."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from curriculum.tests.page_browser import running

FIRST = "test_page.py", "test_gate.py", "test_exercises.py", "test_recipes.py", "test_notebook.py"
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell's `&` leaves it so, to all children
    signal.signal(signal.SIGINT, signal.default_int_handler)
os.environ.pop("UV", None)  # `uv run pytest` sets it; commands are printed as for any other Python


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers():
    """What `-n auto` starts: one more than there are cores, since tests of the page often wait."""
    return (os.cpu_count() or 1) + 1


def pytest_configure(config):
    """Let xdist take files in the order of their tests, in place of the largest number first; and
    compile all loops once, beside the first files, which need none, if all tests are run."""
    config.option.loadscopereorder = False
    if config.getoption("numprocesses", None) and not config.option.file_or_dir:
        words, none = [sys.executable, "-m", "curriculum.compiled"], subprocess.DEVNULL
        config.compiles = subprocess.Popen(words, cwd=config.rootpath, stdout=none, stderr=none)


def pytest_collection_modifyitems(items):
    """Begin with the page, whose tests take longest, and with what needs no compiled loops."""
    items.sort(key=lambda item: [*FIRST, item.path.name].index(item.path.name))


@pytest.fixture(scope="session")
def numpy_alone(tmp_path_factory):
    """A folder with a link to numpy, for who is to find no other package."""
    folder = tmp_path_factory.mktemp("numpy")
    for part in Path(np.__file__).parents[1].glob("numpy*"):
        (folder / part.name).symlink_to(part)
    return str(folder)


@pytest.fixture(scope="session")
def start():
    """A function that starts "chromium" or "firefox", once."""
    with running() as started:
        yield started
