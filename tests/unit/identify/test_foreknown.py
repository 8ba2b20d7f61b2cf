"""Where OP foretells PV against the way in which the valve moves it, the record excludes no lost motion."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.arrays import FloatArray
from lostmotion.identify.foreknown import AGAINST, LEAST, Foretold, foretold
from lostmotion.identify.saved_fit import facts_from_dict
from lostmotion.records import LoopRecord

ROWS, SCANS = 2500, 10


def loop(seed: int, feedforward: float = 0.0, derivative: float = 0.0) -> tuple[FloatArray, FloatArray, FloatArray]:
    """OP, PV and SP, every tenth scan; a sound valve, a load that PV feels and a controller may measure."""
    rng = np.random.default_rng([seed, 3])
    n = ROWS * SCANS
    sp = np.repeat(2.0 * rng.normal(size=n // 1500 + 1), 1500)[:n]
    load, pv, op = np.zeros(n), np.zeros(n), np.zeros(n)
    level = integral = 0.0
    shocks, noise = 0.1 * rng.normal(size=n), 0.02 * rng.normal(size=n)
    for now in range(1, n):
        load[now] = 0.995 * load[now - 1] + shocks[now]
        level += 0.02 * (op[now - 1] + load[now - 1] - level)
        pv[now] = level + noise[now]
        integral += 0.004 * (sp[now] - pv[now])
        op[now] = 0.8 * (sp[now] - pv[now]) + integral - feedforward * load[now]
        op[now] -= derivative * (pv[now] - pv[now - 1])
    return op[::SCANS], pv[::SCANS], sp[::SCANS]


def against(op: FloatArray, pv: FloatArray, sp: FloatArray | None = None, gain: float = 1.0) -> bool:
    return foretold(op, pv, np.array([[0, op.size]]), sp).against(gain)


@pytest.mark.parametrize("seed", range(4))
def test_feedforward_is_seen_and_a_plain_controller_is_not(seed: int) -> None:
    assert against(*loop(seed, feedforward=0.8))
    assert not against(*loop(seed))


def test_pv_that_is_late_is_seen() -> None:
    op, pv, sp = loop(5)
    assert against(op[1:], pv[:-1], sp[1:])


def test_it_counts_against_the_gain_of_the_process() -> None:
    op, pv, sp = loop(6, feedforward=0.8)
    assert against(op, -pv, -sp, gain=-1.0)
    assert not against(op, -pv, -sp, gain=1.0)


def test_what_is_hardly_new_does_not_count() -> None:
    errors = np.array([0.0, -2.0 * AGAINST, 0.0, 0.0, 0.0, 0.0])
    assert Foretold(errors, 2.0 * LEAST).against(1.0)
    assert not Foretold(errors, 0.5 * LEAST).against(1.0)
    assert not Foretold(0.4 * errors, 2.0 * LEAST).against(1.0)


def test_too_short_or_without_moves_says_nothing() -> None:
    short = foretold(np.arange(20.0), np.arange(20.0), np.array([[0, 20]]))
    assert (short.errors == 0.0).all()
    still = foretold(np.zeros(500), np.random.default_rng(1).normal(size=500), np.array([[0, 500]]))
    assert not still.against(1.0)


@pytest.mark.statistics
def test_then_nothing_is_excluded_and_it_is_said() -> None:
    op, pv, sp = loop(7, feedforward=0.8)
    found = lm.diagnose(LoopRecord(50.0 + op, 50.0 + pv, 50.0 + sp, dt=1.0, op_span=(0.0, 100.0)))
    assert found.fit.evidence.foreknown
    assert not found.fit.evidence.can_exclude
    assert not found.cleared
    assert found.excluded
    assert all(np.isinf(size) for size in found.excluded.values())
    assert found.verdict != "none"
    assert facts_from_dict(found.fit.to_dict())["evidence"].foreknown
