"""Scattered missing cells never turn the verdict of a record, whichever they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop

N = 1000


def record(cause, op=None, pv=None):
    loop = random_faulty_loop(1, samples=N, cause=cause)
    op, pv = (np.zeros(N, dtype=bool) if rows is None else rows for rows in (op, pv))
    return lm.LoopRecord(np.where(op, np.nan, loop.op), np.where(pv, np.nan, loop.pv), loop.sp, dt=1.0)


@pytest.mark.parametrize("cause", ["none", "stiction"])
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.05), st.booleans())
@settings(max_examples=4, deadline=None, derandomize=True)
def test_verdict_is_that_of_the_whole_record(cause, seed, share, rows):
    missing = np.random.default_rng(seed).random(N) < share
    found = lm.diagnose(record(cause, op=missing if rows else None, pv=missing))
    assert found.verdict == {"none": "cannot tell", "stiction": "stiction"}[cause]
    assert not any("made up" in note for note in found.notes)
