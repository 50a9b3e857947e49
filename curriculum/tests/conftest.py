"""A test file that needs a package which is not installed is skipped, by the package's name."""

import functools
import importlib.metadata
import importlib.util
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from curriculum.tests.page_browser import start  # noqa: F401

FIRST = "test_page.py", "test_gate.py", "test_exercises.py", "test_recipes.py", "test_notebook.py"
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell's `&` leaves it so, to all children
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "pthread_sigmask"):  # a pool's process blocks it, for all that it starts
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
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


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Turn "No module named 'yaml'" into a skip; a misspelt import of our own stays an error."""
    report = yield
    lacking = re.search(r"No module named '(\w+)", str(report.longrepr)) if report.failed else None
    if lacking and importlib.util.find_spec(lacking[1]) is None:
        report.outcome = "skipped"
        words = f"Skipped: {lacking[1]} is missing, which the extra `dev` brings"
        report.longrepr = (str(collector.path), None, words)
    return report


@pytest.fixture(scope="session")
def only(tmp_path_factory):
    """A function: a folder of links to exactly these distributions and what they require."""

    @functools.cache
    def make(*names):
        folder, wanted = tmp_path_factory.mktemp("only"), list(names)
        for name in wanted:
            found = importlib.metadata.distribution(name)
            for part in {file.parts[0] for file in found.files} - {".."}:
                if not (folder / part).exists() and not part.startswith("__"):
                    (folder / part).symlink_to(Path(found.locate_file(part)))
            needs = [each for each in found.requires or [] if ";" not in each]
            wanted += [re.match(r"[\w.-]+", each)[0] for each in needs]
        return str(folder)

    return make
