"""What a browser draws: extremes of every pixel, nothing hidden, nothing invented."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.web.trend.stretch import trend_of


@given(
    rows=st.integers(2, 400),
    width=st.integers(1, 60),
    seed=st.integers(0, 99),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
)
def test_smallest_and_largest_of_every_stretch_are_there(
    rows: int, width: int, seed: int, ends: tuple[float, float]
) -> None:
    random = np.random.default_rng(seed)
    op = random.normal(size=rows)
    op[random.random(rows) < 0.2] = np.nan
    record = LoopRecord(op=op, pv=random.normal(size=rows), dt=0.5)
    first, last = int(min(ends) * (rows - 1)), int(max(ends) * (rows - 1)) + 1
    found = trend_of(record, first, last, width)
    assert len(found["t"]) == len(found["op"]) == len(found["pv"]) <= 2 * width
    assert found["t"] == sorted(found["t"])
    for name in ("op", "pv"):
        drawn = [one for one in found[name] if one is not None]
        inside = getattr(record, name)[first:last]
        known = inside[np.isfinite(inside)]
        assert set(drawn) <= set(known.tolist())
        if known.size:
            assert (min(drawn), max(drawn)) == (known.min(), known.max())


def test_one_spike_in_a_million_rows_is_drawn() -> None:
    pv = np.zeros(1_000_000)
    pv[654_321] = 7.0
    found = trend_of(LoopRecord(op=pv, pv=pv, sp=pv, dt=1.0), 0, 1_000_000, 1200)
    assert max(found["pv"]) == 7.0
    where = found["t"][found["pv"].index(7.0)]
    assert abs(where - 654_321) < 1_000_000 / 1200


def test_what_a_diagnosis_does_not_use_is_shaded() -> None:
    op = np.full(100, 50.0)
    op[10:20] = 100.0
    op[70:75] = np.nan
    mode = np.array(["AUTO"] * 40 + ["MAN"] * 20 + ["AUTO"] * 40)
    record = LoopRecord(op=op, pv=op, dt=2.0, mode=mode, op_span=(0.0, 100.0))
    shaded = trend_of(record, 0, 100, 100)["shaded"]
    assert sorted(shaded) == [(20.0, 40.0, "at a limit"), (80.0, 120.0, "manual"), (140.0, 150.0, "missing")]
    assert trend_of(record, 15, 50, 100)["shaded"] == [(80.0, 100.0, "manual"), (30.0, 40.0, "at a limit")]


def test_no_width_and_no_rows_are_refused() -> None:
    record = LoopRecord(op=[1.0, 2.0], pv=[1.0, 2.0], dt=1.0)
    with pytest.raises(ParameterError, match="1 to 4000 pixels"):
        trend_of(record, 0, 2, 0)
    with pytest.raises(ParameterError, match="rows of the record"):
        trend_of(record, 5, 9, 10)
