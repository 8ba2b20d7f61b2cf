"""Preparing any record: every row is used or left out, nothing is invented, no exception."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.errors import DataError
from lostmotion.records import LoopRecord, limits, prepare, resample
from lostmotion.records.quantum import quantum
from lostmotion.records.sampling import runs

KINDS = ("noise", "walk", "steps", "constant", "quantised", "ramp")


@st.composite
def signals(draw, n):
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    kind = draw(st.sampled_from(KINDS))
    scale = 10.0 ** draw(st.integers(-6, 6))
    offset = draw(st.sampled_from([0.0, 1.0, -1e4])) * scale
    noise = random.normal(size=n)
    values = {
        "noise": noise,
        "walk": np.cumsum(noise),
        "steps": np.repeat(noise, draw(st.integers(2, 60)))[:n],
        "constant": np.zeros(n),
        "quantised": np.round(np.cumsum(noise)),
        "ramp": np.arange(n) * 0.1,
    }[kind]
    values = offset + scale * values
    for _ in range(draw(st.integers(0, 4))):
        start = draw(st.integers(0, n - 1))
        stop = min(start + draw(st.integers(1, 80)), n)
        values[start:stop] = draw(st.sampled_from([np.nan, values[start], values.max() if n else 0.0]))
    return values


@st.composite
def records(draw):
    n = draw(st.integers(2, 500))
    gaps = tuple(sorted(draw(st.sets(st.integers(1, n - 1), max_size=3))))
    span = draw(st.sampled_from([None, (-1.0, 1.0), (0.0, 100.0)]))
    sp = draw(st.none() | signals(n))
    mode = draw(st.none() | st.just(draw(st.sampled_from(["AUTO", "MAN", "LOCAL", "x"]))))
    return LoopRecord(
        draw(signals(n)),
        draw(signals(n)),
        sp=sp,
        dt=draw(st.sampled_from([0.01, 1.0, 60.0])),
        mode=None if mode is None else np.where(np.arange(n) < n // 2, "AUTO", mode),
        gaps=gaps,
        op_span=span,
        pv_span=span,
    )


@given(records())
@settings(max_examples=150)
def test_every_row_is_used_or_left_out_once(record):
    prepared = prepare(record)
    if not prepared.usable:
        assert prepared.stretches == ()
        assert prepared.refusal.startswith("expected ")
        return
    count = len(record) if prepared.stretches[0].dt == record.dt else len(prepared.record)
    seen = np.zeros(count, dtype=int)
    for start, stop in prepared.rows:
        seen[start:stop] += 1
    for part in prepared.left_out:
        seen[part.start : part.stop] += 1
    assert (seen == 1).all()


@given(records())
@settings(max_examples=100)
def test_stretches_hold_what_was_recorded(record):
    prepared = prepare(record)
    for stretch, (start, stop) in zip(prepared.stretches, prepared.rows, strict=True):
        assert stretch.gaps == ()
        assert not stretch.missing.any()
        source = prepared.record
        known = ~np.isnan(source.pv[start:stop])
        np.testing.assert_array_equal(stretch.pv[known], source.pv[start:stop][known])
        assert runs(~known)[1].max(initial=0) <= limits.BRIDGE_ROWS
        same = stretch.op == source.op[start:stop]
        known = ~np.isnan(source.op[start:stop])
        inside = record.op_span is None or (source.op[start:stop] >= record.op_span[0]) & (
            source.op[start:stop] <= record.op_span[1]
        )
        assert (same | ~known | ~np.asarray(inside)).all()


@given(records(), st.integers(1, 20))
@settings(max_examples=100)
def test_resampling_keeps_the_range_and_the_clock(record, factor):
    pieces = np.diff([0, *record.gaps, len(record)])
    if factor > 1 and np.maximum(pieces // factor - 1, 0).sum() < 2:  # the first of a piece has no rows before it
        with pytest.raises(DataError, match="use a smaller factor"):
            resample(record, factor)
        return
    slower = resample(record, factor)
    assert slower.dt == record.dt * factor
    assert len(slower) <= len(record) // factor
    known = slower.pv[~np.isnan(slower.pv)]
    margin = 1e-9 * np.nanmax(np.abs(np.r_[record.pv, 0.0]))
    assert (known >= np.nanmin(np.r_[record.pv, np.inf]) - margin).all()
    assert (known <= np.nanmax(np.r_[record.pv, -np.inf]) + margin).all()
    assert np.isin(slower.op[~np.isnan(slower.op)], record.op).all()


@given(st.integers(0, 2**32 - 1), st.floats(-4, 4), st.floats(-1e3, 1e3))
def test_step_scales_with_the_signal(seed, power, offset):
    step = 10.0**power
    values = np.round(np.random.default_rng(seed).normal(scale=8.0, size=400)) * step
    assert np.isclose(quantum(values), step, rtol=1e-5)
    shifted = quantum(values + offset * step)
    assert np.isclose(shifted, step, rtol=1e-4)


@given(st.lists(st.booleans(), min_size=1, max_size=80))
def test_runs_rebuild_their_flags(flags):
    rebuilt = np.zeros(len(flags), dtype=bool)
    for start, length in zip(*runs(np.array(flags)), strict=True):
        rebuilt[start : start + length] = True
    assert rebuilt.tolist() == flags
