"""A test file that needs a package which is not installed is skipped, by the package's name."""

import importlib.util
import os
import re

import pytest

os.environ.pop("UV", None)  # `uv run pytest` sets it; commands are printed as for any other Python


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
