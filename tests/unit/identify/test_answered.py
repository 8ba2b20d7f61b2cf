"""Whether PV answers OP: in a closed loop OP foretells PV even where the valve never moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

import lostmotion as lm
from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify.answered import pv_answers
from lostmotion.models import Backlash, Hammerstein, Identity, LinearModel, Nonlinearity

ROWS, SETTLED = 1500, 500
WIDE = 50.0  # a backlash that OP never crosses


def loop(
    seed: int, valve: Nonlinearity, moves: float = 0.0, scans: int = 1
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """OP, PV and SP of a loop with PI, load and noise, `scans` acts of the controller a row."""
    rng = np.random.default_rng([seed, scans, 5])
    n = (ROWS + SETTLED) * scans
    pole = float(np.exp(-1.0 / rng.uniform(3.0 * scans, 20.0 * scans)))
    process = LinearModel((-pole,), (1.0 - pole,), int(rng.integers(1, 4)), 1.0)
    load = lfilter([np.sqrt(1.0 - pole**2)], [1.0, -pole], rng.normal(size=n))
    sp = moves * np.repeat(rng.normal(size=n // (100 * scans) + 1), 100 * scans)[:n]
    response = lm.simulate_loop(
        Hammerstein(valve, process), lm.PI(0.4, 0.02 / scans), sp, disturbance=load,
        noise=0.1 * rng.normal(size=n), allow_unstable=True,
    )  # fmt: skip
    kept = slice(SETTLED * scans, n, scans)
    return response.control[kept], response.measured[kept], response.reference[kept]


def answers(op: FloatArray, pv: FloatArray, sp: FloatArray | None) -> bool:
    return pv_answers(op, pv, np.array([[0, op.size]]), sp)


def test_a_valve_that_never_moves_is_not_answered() -> None:
    assert not any(answers(*loop(seed, Backlash(WIDE))) for seed in range(20))


def test_nor_is_it_where_the_set_point_moves() -> None:
    assert not any(answers(*loop(seed, Backlash(WIDE), moves=3.0)) for seed in range(20))


@pytest.mark.parametrize("scans", [2, 4])
def test_nor_where_the_controller_acts_between_the_rows(scans: int) -> None:
    assert sum(answers(*loop(seed, Backlash(WIDE), scans=scans)) for seed in range(20)) <= 1


def test_moves_of_the_set_point_are_answered_by_a_sound_valve() -> None:
    assert sum(answers(*loop(seed, Identity(), moves=3.0)) for seed in range(20)) >= 19


def test_at_a_set_point_at_rest_a_sound_valve_and_one_that_stands_still_leave_the_same_record() -> None:
    assert not any(answers(*loop(seed, Identity())) for seed in range(20))


def test_what_else_moves_op_is_answered_as_well() -> None:
    rng = np.random.default_rng(2)
    op = np.cumsum(rng.normal(size=2000)) / 10.0
    pv = np.append(np.zeros(6), op[:-6]) + rng.normal(size=2000) / 10.0
    assert answers(op, pv, None)


def test_neither_units_nor_signs_matter() -> None:
    for valve, said in ((Identity(), True), (Backlash(WIDE), False)):
        op, pv, sp = loop(3, valve, moves=3.0)
        assert answers(op, pv, sp) is said
        assert answers(50.0 - 7.0 * op, 1e3 + 0.01 * pv, -30.0 * sp) is said


def test_segments_do_not_touch() -> None:
    op, pv, sp = loop(4, Identity(), moves=3.0)
    parts = np.array([[0, 700], [700, ROWS]])
    assert pv_answers(op, pv, parts, sp)
    op, pv, sp = loop(4, Backlash(WIDE), moves=3.0)
    assert not pv_answers(op, pv, parts, sp)


def test_a_record_too_short_to_tell_is_not_answered() -> None:
    op, pv, sp = loop(5, Identity(), moves=3.0)
    assert not pv_answers(op[:60], pv[:60], np.array([[0, 60]]), sp[:60])


def test_a_constant_and_exact_copies_do_no_harm() -> None:
    op, pv, _ = loop(6, Identity())
    assert not answers(op, pv, np.zeros(ROWS))
    assert not answers(np.ones(ROWS), pv, None)


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(3))
def test_no_size_is_excluded_beside_a_valve_that_may_stand_still(seed: int) -> None:
    op, pv, sp = loop(seed, Backlash(WIDE))
    found = lm.diagnose(lm.LoopRecord(op, pv, sp, dt=1.0, op_span=(-50.0, 50.0)))
    assert found.verdict not in ("none", "other oscillation") or found.confidence >= 0.9
    assert found.kind == "actuator" or set(found.excluded.values()) == {np.inf}


@pytest.mark.statistics
def test_identify_prefers_no_linear_model_then() -> None:
    op, pv, _ = loop(1, Backlash(WIDE))
    fit = lm.identify(op, pv, 1.0)
    assert not fit.evidence.answered
    assert fit.preferred == "cannot tell"
    zone = lm.identify(op, pv, 1.0, nonlinearity="dead zone")
    assert zone.widest is None
    for status in (Status.NOT_SEEN, Status.CANNOT_TELL):
        assert replace(zone, status=status).interval("width") == (0.0, np.inf)
    if zone.status is Status.NOT_SEEN:
        assert zone.preferred == "cannot tell"
