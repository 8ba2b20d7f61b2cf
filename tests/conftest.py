"""Hypothesis: the same examples in every CI run, new ones at the desk. Doctests that take minutes with the JIT off."""

import os

import pytest
from hypothesis import settings

from tests import stores

collect_ignore = ["plc/build.py", "plc/parse.py", "plc/trees.py"]  # run by the Python of .venv-plc

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("desk", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "desk")

SLOW_DOCTESTS = {
    "lostmotion.diagnose.one_record.diagnose",
    "lostmotion.identify.estimate.identify",
    "lostmotion.identify.recursive.ml.RecursiveML",
}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark them, before marked tests are deselected."""
    for item in items:
        if item.name in SLOW_DOCTESTS:
            item.add_marker(pytest.mark.statistics)


@pytest.fixture(scope="session")
def postgresql():
    """One server a session, ended by its own stop."""
    server = stores.started()
    yield server
    server.stop()
