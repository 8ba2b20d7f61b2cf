"""Means over several scans are told by the steps of a set point that is typed, and by nothing else."""

import numpy as np
import pytest

from lostmotion.records import LoopRecord, check
from lostmotion.records.averaged import steps_of


def typed(unit=0.1, count=20, scans=400, low=40.0, seed=6):
    """Set point at every scan, moved by hand."""
    random = np.random.default_rng(seed)
    moves = random.integers(1, 60, size=count) * random.choice([-1, 1], size=count)
    return np.repeat(low + unit * np.cumsum(moves), random.integers(scans // 2, scans, size=count))


def walk(size):
    return np.cumsum(np.random.default_rng(size).normal(size=size))


def means(values, many):
    return values[: len(values) // many * many].reshape(-1, many).mean(axis=1)


@pytest.mark.parametrize("many", [3, 4, 8, 10, 60])
@pytest.mark.parametrize("unit", [0.1, 0.5, 1.0])
def test_means_over_scans_are_told(many, unit):
    """Of three scans one step in three falls between two rows, and one mean in three on a typed value."""
    told = 0
    for seed in range(40):
        sp = typed(unit, scans=20 * many, seed=seed).astype(np.float32).astype(float)
        told += steps_of(means(sp, many)).averaged
        assert not steps_of(sp[1::many]).averaged
    assert told >= 36


def ramped(sp, rate):
    """Set point that follows what was typed by so much a sample."""
    found = sp.copy()
    for k in range(1, len(sp)):
        found[k] = found[k - 1] + np.clip(sp[k] - found[k - 1], -rate, rate)
    return found


@pytest.mark.parametrize(
    "sp",
    [
        np.repeat([40.0, 45.0, 55.0, 60.0, 65.0, 75.0], [50, 1, 50, 50, 1, 50]),  # twice by hand
        np.repeat([40.0, 42.5, 45.0, 40.0], [50, 1, 50, 50]),  # a slip of the hand
        ramped(typed(0.5), 0.13),
        walk(2000),  # of a cascade
        np.repeat(walk(200), 10),  # of a cascade that is slower
        np.full(100, 50.0),
        np.full(100, np.nan),
        None,
    ],
)
def test_no_other_set_point_is_taken_for_means(sp):
    assert not steps_of(sp).averaged


def test_check_warns_of_means():
    sp = typed()
    n = len(sp) // 4
    op, pv = np.random.default_rng(7).normal(size=(2, n))
    record = LoopRecord(50 + np.cumsum(op) / 9, pv, sp=means(sp, 4), dt=1.0)
    (said,) = [one for one in check(record).findings if "SP goes through an odd value" in one.what]
    assert said.level == "warning"
    assert "Export samples" in said.remedy
