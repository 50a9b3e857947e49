"""Browsers as a fixture."""

import functools
import os

import pytest

from curriculum.page.browser import running


@pytest.fixture(scope="session")
def start():
    """start("chromium") or "firefox", once: a lacking one is a fault in CI, else a test less."""
    with running() as found:

        @functools.cache
        def start_or_skip(kind):
            try:
                return found(kind)
            except OSError as error:
                (pytest.fail if os.environ.get("CI") else pytest.skip)(str(error))

        yield start_or_skip
