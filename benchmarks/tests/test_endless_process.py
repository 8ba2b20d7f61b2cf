"""A level that shows little of its pole: where no process is found that settles, an integrating one is."""

import importlib

import pytest
from benchmarks.verdicts.second_family import second_family

import lostmotion as lm

estimate = importlib.import_module("lostmotion.identify.estimate")
pytestmark = pytest.mark.statistics


def record():
    """A level with a dead zone of 1, of the second family: its best process that settles does so after the record."""
    loop = second_family(64)
    return lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))


def test_the_size_behind_a_level_is_told():
    fit = lm.identify(record())
    assert fit.status.ok
    assert fit.chosen.integrating
    low, high = fit.interval("width")
    assert low < 1.0 < high


def test_who_says_that_it_settles_gets_no_other(monkeypatch):
    assert not lm.identify(record(), integrating=False).chosen.integrating
    monkeypatch.setattr(estimate, "AS_LIKELY", -1e9)
    assert lm.identify(record()).status is lm.Status.NO_PROCESS
