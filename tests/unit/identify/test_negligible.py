"""A lost motion that every sound valve has is no fault, and what is denied leaves no other kind open unseen."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose import Diagnosis
from lostmotion.models import Backlash, Hammerstein, LinearModel
from lostmotion.records import LoopRecord

ROWS = 2000
SPAN = (0.0, 100.0)
PLANT = LinearModel((-0.85,), (0.15,), 2, 1.0)


def found(width: float, seed: int = 1, noise: float = 0.02, **said: float) -> Diagnosis:
    rng = np.random.default_rng([seed, 21])
    sp = np.repeat(rng.normal(size=ROWS // 80), 80)
    load = np.repeat(0.2 * rng.normal(size=ROWS // 50), 50)
    loop = lm.simulate_loop(
        Hammerstein(Backlash(width), PLANT), lm.PI(0.5, 0.06), sp, disturbance=load, noise=noise * rng.normal(size=ROWS)
    )
    record = LoopRecord(50.0 + loop.control, 50.0 + loop.measured, 50.0 + loop.reference, dt=1.0, op_span=SPAN)
    return lm.diagnose(record, **said)


@pytest.mark.statistics
def test_a_small_part_of_a_percent_is_seen_and_is_no_fault() -> None:
    one = found(0.2, noise=0.003)
    assert one.fit.kind.sticks
    assert one.measured.negligible
    assert one.verdict == "none"
    assert one.cleared
    assert set(one.excluded) == {"dead zone", "backlash", "stiction"}
    assert one.excluded[one.fit.kind.name] >= one.fit.interval(one.fit.kind.size)[1]
    assert any("a sound valve has as much" in note for note in one.notes)


@pytest.mark.statistics
def test_who_tolerates_less_is_not_told_so() -> None:
    one = found(0.2, noise=0.003, tolerance=0.001)
    assert not one.measured.negligible
    assert not one.cleared


@pytest.mark.statistics
def test_a_percent_is_a_fault() -> None:
    one = found(1.0)
    assert one.verdict in ("backlash", "stiction")
    assert abs(one.size - 1.0) < 0.1
    assert not one.measured.negligible
