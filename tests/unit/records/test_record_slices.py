"""Parts of a record by rows, times and dates: half-open, so that neighbouring parts share no sample."""

import dataclasses
import pickle
import re
from dataclasses import replace
from datetime import UTC, date, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.records import LoopRecord, resample
from lostmotion.records.resample import pick
from tests.support.places import ROOT

ROWS = np.arange(1000.0)
RECORD = LoopRecord(ROWS, -ROWS, dt=12.0, start="2026-03-01 06:00", op_unit="%", pv_unit="m3/h", tag="FIC-1")


def rows(record):
    """First and one past the last row of the whole record that a part holds."""
    return int(record.op[0]), int(record.op[-1]) + 1


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        (slice(0, 500), (0, 500)),
        (slice(np.int64(10), None), (10, 1000)),
        (slice(-600, None), (400, 1000)),
        (slice("600s", "1200s"), (50, 100)),
        (slice("10min", "0.5h"), (50, 150)),
        (slice("1h30min", None), (450, 1000)),
        (slice("601s", "1199 s"), (51, 100)),  # from the first row that is not before the bound
        (slice(None, "-1h"), (0, 700)),
        (slice("-20min", "-10min"), (900, 950)),
        (slice(timedelta(minutes=10), np.timedelta64(20, "m")), (50, 100)),
        (slice(pd.Timedelta("10min"), pd.Timedelta("20min")), (50, 100)),
        (slice("2026-03-01 07:00", "2026-03-01 08:00"), (300, 600)),
        (slice(datetime(2026, 3, 1, 7), "2026-03-01T08:00:00"), (300, 600)),
        (slice(np.datetime64("2026-03-01T07:00"), pd.Timestamp("2026-03-01 08:00")), (300, 600)),
        (slice("2026-03-01", "2026-03-02"), (0, 1000)),
        (slice(date(2026, 3, 1), date(2026, 3, 2)), (0, 1000)),
        (slice("2026-03-01 07:00", "2h"), (300, 600)),
        (slice("2025-01-01", "2026-03-01 06:10"), (0, 50)),
        (slice("1d", None), None),
        (slice("2026-03-02", None), None),
        (slice("20min", "10min"), None),
    ],
)
def test_parts(part, expected):
    if expected is None:
        with pytest.raises(
            DataError, match=r"rows 0 \.\. 1000, 0 s \.\. 12000 s, 2026-03-01 06:00:00 \.\. 2026-03-01 09"
        ):
            RECORD[part]
        return
    found = RECORD[part]
    assert rows(found) == expected
    assert found.start == RECORD.start + timedelta(seconds=12.0 * expected[0])
    assert (found.op_unit, found.pv_unit, found.tag) == ("%", "m3/h", "FIC-1")


@given(st.floats(24.0, 11_900.0), st.sampled_from(("s", "min", "date")))
def test_neighbouring_parts_are_the_whole(seconds, kind):
    cut = {
        "s": f"{seconds:f}s",
        "min": f"{seconds / 60:f}min",
        "date": RECORD.start + timedelta(seconds=seconds),
    }[kind]
    before, after = RECORD[:cut], RECORD[cut:]
    np.testing.assert_array_equal(np.concatenate([before.op, after.op]), RECORD.op)
    assert 12.0 * len(before) >= seconds - 1e-3 > 12.0 * (len(before) - 1) - 2e-3


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (5, "start:stop"),
        (slice(0, 100, 2), "start:stop"),
        (slice(0.0, 100.0), "rows .*, times .* or dates"),
        (slice("soon", None), "a date such as"),
        (slice("10 fortnights", None), "a date such as"),
        (slice("2026-03-01T06:00Z", None), "without time zone"),
    ],
)
def test_bounds_that_are_none(part, said):
    with pytest.raises(ParameterError, match=said):
        RECORD[part]


def test_dates_need_a_start():
    with pytest.raises(ParameterError, match=r"does not say when it began.*replace"):
        replace(RECORD, start=None)["2026-03-01":]
    with pytest.raises(ParameterError, match="a date such as"):
        replace(RECORD, start="yesterday")
    with pytest.raises(ParameterError, match="a date such as"):
        replace(RECORD, start=5)


def test_time_zones_over_a_change_of_the_clock():
    berlin = ZoneInfo("Europe/Berlin")
    record = replace(RECORD, dt=60.0, start=datetime(2026, 3, 29, 0, 0, tzinfo=berlin))  # 2 o'clock is 3 o'clock
    assert rows(record["2026-03-29 03:30":"2026-03-29 04:00"]) == (150, 180)
    assert record["2026-03-29 03:30":].start == datetime(2026, 3, 29, 1, 30, tzinfo=UTC)
    assert rows(record[datetime(2026, 3, 29, 1, 30, tzinfo=UTC) :])[0] == 150


def test_gaps_whose_length_is_known():
    record = replace(RECORD, gaps=(300, 600), gap_seconds=(3600.0, 600.0))
    assert record.moment(299) == datetime(2026, 3, 1, 6, 59, 48)
    assert record.moment(300) == datetime(2026, 3, 1, 8, 0)
    assert rows(record["2026-03-01 07:30":"2026-03-01 08:10"]) == (300, 350)  # from inside the gap
    assert rows(record["2026-03-01 09:10":]) == (600, 1000)
    part = record["2026-03-01 08:20":]
    assert (part.gaps, part.gap_seconds, part.start) == ((200,), (600.0,), datetime(2026, 3, 1, 8, 20))
    assert part.moment(200) == record.moment(600) == datetime(2026, 3, 1, 9, 10)
    assert rows(record["1h":"2h"]) == (300, 600)  # times of what was recorded, as in all reports


def test_gaps_whose_length_is_not_known():
    record = replace(RECORD, gaps=(300,))
    assert rows(record["2026-03-01 06:10":"2026-03-01 07:00"]) == (50, 300)
    with pytest.raises(ParameterError, match="how much is missing is not known"):
        record["2026-03-01 06:10":"2026-03-01 07:10"]
    assert record[300:].start is None
    assert record.moment(299) == datetime(2026, 3, 1, 6, 59, 48)
    assert record.stretch_starts is None
    with pytest.raises(DataError, match="1 gap_seconds, got 2"):
        replace(record, gap_seconds=(1.0, 2.0))


def test_slower_records_keep_their_clock():
    assert resample(RECORD, 5).start == RECORD.moment(5)
    assert pick(RECORD, 5, 3).start == RECORD.moment(3)
    known = replace(RECORD, gaps=(300,), gap_seconds=(60.0,))
    assert resample(known, 5).gaps == (59,)
    assert resample(known, 5).gap_seconds == ()


def test_what_a_record_says_of_its_start():
    assert "from 2026-03-01 06:00:00" in repr(RECORD)
    assert "from" not in repr(replace(RECORD, start=None))
    assert pickle.loads(pickle.dumps(RECORD)).start == RECORD.start  # noqa: S301


def test_what_the_page_on_reading_shows(tmp_path, monkeypatch):
    """Its lines run as they stand, on ten hours of a loop."""
    pytest.importorskip("matplotlib")
    page = (ROOT / "docs" / "reading.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    u = np.repeat(np.random.default_rng(0).uniform(45.0, 55.0, 300), 10)
    y = lm.LinearModel([-0.8], [0.2], 1, 12.0).simulate(u - 50.0) + np.random.default_rng(1).normal(
        scale=0.1, size=3000
    )
    rows = np.column_stack([12.0 * np.arange(3000), u, y])
    np.savetxt(tmp_path / "FIC-101.csv", rows, delimiter=",", header="t_s,OP,PV", comments="")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lm, "identify", lambda record: lm_identify(record, nonlinearity="none", orders=(1, 0, 1)))
    names = {"lm": lm, "dataclasses": dataclasses}
    exec(code, names)  # noqa: S102
    assert names["record"].start == datetime(2026, 3, 1, 6)
    assert names["fit"].data.op_unit == "%"


lm_identify = lm.identify


@pytest.mark.parametrize("moment", ["0001-01-01T00:00+14:00", "9999-12-31T23:59-14:00", "2026-01-01T00:00+24:00"])
def test_moments_outside_the_years_of_utc_are_refused(moment):
    with pytest.raises(ParameterError, match=r"^expected a date such as .*, got '"):
        replace(RECORD, start="2026-03-01 06:00+01:00")[moment:]


def test_a_time_beyond_all_numbers_is_behind_the_last_row():
    with pytest.raises(DataError, match="at least 2 samples"):
        RECORD["9" * 400 + "s" :]
    assert len(RECORD[: "9" * 400 + "s"]) == len(RECORD)
