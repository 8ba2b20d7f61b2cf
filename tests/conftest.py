"""Hypothesis: the same examples in every CI run, new ones at the desk. Whole fits that take minutes without the JIT."""

import os
import signal
from collections.abc import Iterator

import pytest
from hypothesis import settings

collect_ignore = ["plc/build.py", "plc/parse.py"]  # run by the Python of .venv-plc

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("desk", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "desk")

SLOW_DOCTESTS = {
    "lostmotion.diagnose.diagnose.diagnose",
    "lostmotion.identify.estimate.identify",
    "lostmotion.identify.recursive.ml.RecursiveML",
}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark them, before marked tests are deselected."""
    for item in items:
        if item.name in SLOW_DOCTESTS:
            item.add_marker(pytest.mark.statistics)


LONGEST = 10  # seconds of a test without the JIT: that run is for kernels and their callers, whole fits run with it


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Without the JIT a test that takes too long ends, skipped; with it every test runs to its end."""
    if os.environ.get("NUMBA_DISABLE_JIT") != "1" or not hasattr(signal, "SIGALRM"):
        return (yield)

    def stop(*_: object) -> None:
        signal.alarm(LONGEST)  # should what runs have caught it
        pytest.skip(f"a whole fit: over {LONGEST} s without the JIT; it runs with it")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(LONGEST)
    try:
        return (yield)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
