"""Recordings glued together are told from what the loop itself does in one row."""

import numpy as np
import pytest

from lostmotion.records import LoopRecord, prepare
from lostmotion.records.splices import splices

N = 600


def loop(seed, sp, speed, noise=0.1, op_noise=0.1, gain=2.0):
    """Loop whose PV goes this share of the way to SP in a row, and OP with it; op, pv of shape (n,)."""
    random = np.random.default_rng(seed)
    level, levels = float(sp[0]), []
    for wanted in sp:
        level += speed * (wanted - level)
        levels.append(level)
    pv = np.array(levels) + noise * random.standard_normal(len(sp))
    return 50.0 + (np.array(levels) - 50.0) / gain + op_noise * random.standard_normal(len(sp)), pv


def steps(*levels):
    return np.repeat(np.array(levels, dtype=float), N // len(levels))


def glued(first, second):
    return tuple(np.r_[one, other] for one, other in zip(first, second, strict=True))


@pytest.mark.parametrize("levels", [(40.0, 60.0), (40.0, 60.0, 45.0, 52.0)])
@pytest.mark.parametrize("speed", [0.7, 1.0])
def test_steps_of_sp_in_a_process_faster_than_the_rows_are_no_splice(levels, speed):
    sp = steps(*levels)
    record = LoopRecord(*loop(0, sp, speed), sp, dt=60.0)
    assert splices(record) == ()
    assert prepare(record).left_out == ()


def test_nor_are_moves_by_hand_that_pv_follows_at_once():
    op, pv = loop(1, steps(40.0, 60.0, 45.0, 52.0), 1.0)
    assert splices(LoopRecord(op, pv, dt=60.0)) == ()


def test_nor_is_a_jump_no_larger_than_the_loop_swings():
    """Most rows of a compressed archive hardly move, so any move is many of the usual ones."""
    row = np.arange(N)
    swing = np.interp(row, np.arange(0, N + 60, 60), 10.0 * (-1.0) ** np.arange(11)) / 50.0
    step = np.where(row >= 285, 2.2, 0.0)
    record = LoopRecord(50.0 + 10.0 * swing + step, 40.0 + 10.0 * swing + step, dt=1.0)
    moves = np.abs(np.diff(record.pv))
    assert moves.max() > 25.0 * np.median(moves)
    assert splices(record) == ()


def test_another_recording_is_still_found():
    at = steps(50.0)
    slow = loop(2, steps(45.0, 55.0, 50.0), 0.02)
    other = loop(3, at - 30.0, 0.02, gain=-0.5)
    assert splices(LoopRecord(*glued(slow, other), dt=1.0)) == (N,)


def test_also_where_sp_was_glued_on_with_it():
    """PV of the first is too slow to follow its SP in a row, so it did not at the joint either."""
    wanted = steps(40.0, 60.0, 48.0)
    first = (*loop(4, wanted, 0.02), wanted)
    second = (*loop(5, wanted - 30.0, 0.02), wanted - 30.0)
    assert splices(LoopRecord(*glued(first, second), dt=1.0)) == (N,)


def test_also_where_its_noise_is_another_one():
    at = steps(50.0)
    first, second = (*loop(6, at, 1.0), at), (*loop(7, at - 30.0, 1.0, noise=0.4), at - 30.0)
    assert splices(LoopRecord(*glued(first, second), dt=1.0)) == (N,)
