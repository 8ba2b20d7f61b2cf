from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest

from lostmotion.audit.screen.windows import windows_of
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.store.rows import UNDATED


def record(rows=100, dt=60.0, **more):
    return LoopRecord(np.arange(rows), np.arange(rows), dt=dt, **more)


def test_whole_record_is_one_window_undated_from_the_epoch():
    (one,) = windows_of(record(), AuditSettings())
    assert (one.start, one.end) == (UNDATED, UNDATED + timedelta(minutes=100))
    assert len(one.record) == 100


def test_windows_begin_at_whole_multiples_in_utc_whatever_the_zone():
    there = timezone(timedelta(hours=2))
    made = record(start=datetime(2026, 3, 1, 1, 30, tzinfo=there))  # 23:30 UTC the day before
    found = list(windows_of(made, AuditSettings(window=3600.0)))
    assert [one.start.hour for one in found] == [23, 0, 1]
    assert all(one.start.tzinfo is UTC and (one.end - one.start).seconds == 3600 for one in found)
    assert [len(one.record) for one in found] == [30, 60, 10]
    assert sum(len(one.record) for one in windows_of(record(dt=60.0), AuditSettings(window=600.0))) == 100


def test_gaps_move_rows_into_later_windows_and_overlap_nothing():
    made = record(start=datetime(2026, 3, 1), gaps=(50,), gap_seconds=(7200.0,))
    found = list(windows_of(made, AuditSettings(window=3600.0)))
    assert [one.start.hour for one in found] == [0, 2, 3]
    assert np.concatenate([one.record.op for one in found]).tolist() == list(range(100))


@pytest.mark.parametrize("window", [0.0, -1.0, float("nan"), float("inf")])
def test_window_must_be_positive(window):
    with pytest.raises(ParameterError):
        list(windows_of(record(), AuditSettings(window=window)))
