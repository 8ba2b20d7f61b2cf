"""PV recorded later than the controller saw it is moved back, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.arrays import FloatArray
from lostmotion.models import Backlash, Hammerstein, LinearModel
from lostmotion.records import LoopRecord, prepare
from lostmotion.records.late_pv import moved, rows_late

ROWS = 1200
LINEAR = LinearModel((-0.9,), (0.1,), 2, 1.0)


def loop(seed: int, width: float = 0.0, noise: float = 0.05, moves: float = 1.0) -> tuple[FloatArray, ...]:
    """OP, PV and SP behind a PI controller; without moves SP rests."""
    rng = np.random.default_rng([seed, 11])
    sp = moves * np.repeat(rng.normal(size=ROWS // 60), 60)
    load = 0.1 * rng.normal(size=ROWS).cumsum()
    made = lm.simulate_loop(
        Hammerstein(Backlash(width), LINEAR),
        lm.PI(0.8, 0.08),
        sp,
        disturbance=load,
        noise=noise * rng.normal(size=ROWS),
    )
    return made.control, made.measured, made.reference


def by(rows: int, op: FloatArray, pv: FloatArray, sp: FloatArray | None = None) -> LoopRecord:
    """With PV so many rows late."""
    of_op, of_pv = slice(max(rows, 0), op.size + min(rows, 0)), slice(max(-rows, 0), op.size + min(-rows, 0))
    return LoopRecord(op[of_op], pv[of_pv], None if sp is None else sp[of_op], dt=1.0)


@pytest.mark.parametrize("rows", [-1, 0, 1, 2])
@pytest.mark.parametrize("moves", [0.0, 1.0])
def test_the_rows_are_found(rows: int, moves: float) -> None:
    op, pv, sp = loop(1, width=0.5, moves=moves)
    record = by(rows, op, pv, sp if moves else None)
    found, said = rows_late([record])
    assert found == max(rows, 0)
    assert ("controller saw it" in said) == (rows > 0)


def test_moving_pv_back_gives_the_record_as_it_was() -> None:
    op, pv, _ = loop(2)
    for rows in (1, 2):
        record = moved(by(rows, op, pv), rows)
        known = np.isfinite(record.pv)
        assert np.count_nonzero(~known) == rows
        np.testing.assert_array_equal(record.pv[known], pv[rows : rows + len(record)][known])


def test_nothing_is_moved_across_a_gap() -> None:
    op, pv, _ = loop(3)
    record = LoopRecord(op, pv, dt=1.0, gaps=(500,))
    assert np.flatnonzero(np.isnan(moved(record, 2).pv)).tolist() == [498, 499, ROWS - 2, ROWS - 1]


@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_the_inverse_of_a_process_without_noise_is_no_controller(noise: float) -> None:
    """OP is an exact function of later rows of PV then, but one without an integral part."""
    rng = np.random.default_rng(4)
    op, pv = rng.normal(size=ROWS).cumsum() * 0.1, np.zeros(ROWS + 1)
    for now in range(ROWS):
        pv[now + 1] = 0.8 * pv[now] + 0.2 * op[now] + noise * rng.normal()
    assert rows_late([LoopRecord(op, pv[:-1], dt=1.0)])[0] == 0


def test_a_test_in_open_loop_and_a_short_record_stay() -> None:
    rng = np.random.default_rng(5)
    op = np.repeat(rng.normal(size=ROWS // 20), 20)
    assert rows_late([LoopRecord(op, rng.normal(size=ROWS), dt=1.0)])[0] == 0
    op, pv, _ = loop(6)
    assert rows_late([by(1, op[:100], pv[:100])])[0] == 0
    assert rows_late([])[0] == 0
    assert rows_late([LoopRecord(np.full(ROWS, 3.0), pv, dt=1.0)])[0] == 0


def test_prepare_moves_it_and_says_so() -> None:
    op, pv, sp = loop(7)
    record = by(1, op, pv, sp)
    found = prepare(record)
    assert found.record is record
    assert any("1 row later than the controller saw it" in note for note in found.notes)
    assert found.rows == ((0, len(record) - 1),)
    assert [(part.start, part.kind) for part in found.left_out] == [(len(record) - 1, "missing")]
    np.testing.assert_array_equal(found.stretches[0].pv, record.pv[1:])
    np.testing.assert_array_equal(found.stretches[0].op, record.op[:-1])


@pytest.mark.statistics
def test_a_backlash_behind_pv_that_is_late_is_found_as_without() -> None:
    op, pv, sp = loop(8, width=1.0)
    sizes = [lm.identify(by(rows, op, pv, sp), nonlinearity="backlash").parameters["width"] for rows in (0, 1)]
    np.testing.assert_allclose(sizes, 1.0, atol=0.15)
    assert abs(sizes[1] - sizes[0]) < 0.02
