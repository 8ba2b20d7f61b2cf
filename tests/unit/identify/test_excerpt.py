"""Pieces of a long record for rough fits."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.identify.likelihood.excerpt import MOST_ROWS, alone, excerpt
from lostmotion.identify.scaled import ScaledData


def record(lengths: list[int], lively: slice | None = None) -> ScaledData:
    """Noise that is ten times larger in one place."""
    ends = np.cumsum(lengths)
    u = np.random.default_rng(0).normal(size=ends[-1])
    if lively is not None:
        u[lively] *= 10.0
    return ScaledData(u, u.copy(), np.column_stack([ends - lengths, ends]))


def test_a_short_record_is_taken_whole():
    data = record([MOST_ROWS - 100, 100])
    assert excerpt(data) is data.segments


def test_the_liveliest_rows_are_inside():
    data = record([40_000], slice(12_300, 13_700))
    kept = excerpt(data)
    assert any(start <= 12_300 and stop >= 13_700 for start, stop in kept)


@given(st.lists(st.integers(60, 30_000), min_size=1, max_size=8))
def test_pieces_lie_inside_their_segments(lengths):
    data = record(lengths)
    kept = excerpt(data)
    rows = int((kept[:, 1] - kept[:, 0]).sum())
    assert min(sum(lengths), MOST_ROWS // 2) <= rows <= min(sum(lengths), 2 * MOST_ROWS)
    assert np.all(kept[1:, 0] >= kept[:-1, 1])
    for start, stop in kept:
        assert any(first <= start < stop <= last for first, last in data.segments)


def test_rows_alone_are_the_same_rows():
    data = record([9_000, 40_000], slice(12_300, 13_700))
    kept = excerpt(data)
    seen = alone(data, kept)
    assert seen.u.size == int((kept[:, 1] - kept[:, 0]).sum()) == seen.segments[-1, 1]
    for (start, stop), (first, last) in zip(kept.tolist(), seen.segments.tolist(), strict=True):
        np.testing.assert_array_equal(seen.u[first:last], data.u[start:stop])
    assert alone(data, data.segments) is data
