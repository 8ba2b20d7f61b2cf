"""A loop that never ends costs its batch a retry, and is a row with one line."""

from __future__ import annotations

import threading
import time

import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError, SlowError
from lostmotion.workers import interrupt
from lostmotion.workers.interrupt import AGAIN, within


def endless():
    while True:
        pass


def stubborn():
    began = time.monotonic()
    while time.monotonic() - began < 0.5 * AGAIN:
        try:
            endless()
        except BaseException:  # noqa: BLE001, S112
            continue
    endless()


def test_work_within_its_time_is_left_alone():
    assert within(None, divmod, 7, 2) == within(1.0, divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        within(1.0, divmod, 7, 0)
    before = threading.active_count()
    for _ in range(50):
        within(1e-3, time.sleep, 0.0)
    time.sleep(0.1)  # nothing comes late
    assert threading.active_count() <= before


@pytest.mark.parametrize("work", [endless, stubborn])
def test_work_that_never_ends_is_interrupted(work, monkeypatch):
    monkeypatch.setattr(interrupt, "_MAY_END", threading.Event())  # an engine in this process may have said so
    with pytest.raises(SlowError, match=r"expected a result within 0.002 minutes, got none; give a loop more"):
        within(0.002, work)
    time.sleep(1.1 * AGAIN)


def test_another_thread_is_interrupted_too():
    said = []

    def run():
        try:
            within(0.002, endless)
        except SlowError as error:
            said.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join(10.0)
    assert len(said) == 1


def test_a_limit_that_is_none_is_refused():
    with pytest.raises(ParameterError, match="loop_minutes > 0"):
        lm.audit({}, loop_minutes=0.0)
