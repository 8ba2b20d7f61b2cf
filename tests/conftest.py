"""The stages: `make test` runs what is not `long`, `make test-all` all, and what touches kernels without the JIT.

Hypothesis has the same examples in every run, new ones at the desk.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from tests.support import stores

collect_ignore = [
    *("plc/build.py", "plc/parse.py", "plc/trees.py"),  # run by the Python of .venv-plc
    "support/windows_like",  # changes the process that imports it
]

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("desk", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "desk")

SLOW_DOCTESTS = {  # without the JIT
    "lostmotion.diagnose.any_record.diagnose",
    "lostmotion.diagnose.one_record.diagnose",
    "lostmotion.identify.estimate.identify",
    "lostmotion.identify.recursive.ml.RecursiveML",
}
COMPILED = ("lostmotion.kernels", "tests.naive")  # a file that names one of them tests kernels or their twins


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> Generator[None]:
    """Mark what a stage leaves out, before the order is made random and marked tests are deselected."""
    for item in left_of_samples(items):
        item.add_marker(pytest.mark.long)
    compiled = {path: tests_kernels(path) for path in {item.path for item in items}}
    for item in items:
        if item.name in SLOW_DOCTESTS:
            item.add_marker(pytest.mark.statistics)
        if compiled[item.path]:
            item.add_marker(pytest.mark.kernels)
    return (yield)


def left_of_samples(items: list[pytest.Item]) -> Iterator[pytest.Item]:
    """Cases of sampled tests but the first of each of so many equal parts."""
    sampled: dict[tuple[Path, str], list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker("sampled"):
            sampled[item.path, item.originalname].append(item)
    for cases in sampled.values():
        (kept,) = cases[0].get_closest_marker("sampled").args
        yield from (item for number, item in enumerate(cases) if number * kept % len(cases) >= kept)


def tests_kernels(path: Path) -> bool:
    """Whether a file tests what is compiled, or its twins."""
    text = path.read_text(encoding="utf-8")
    return "kernels" in path.parts or any(name in text for name in COMPILED)


@pytest.fixture(scope="session")
def postgresql():
    """One server a session, ended by its own stop."""
    server = stores.started()
    yield server
    server.stop()
