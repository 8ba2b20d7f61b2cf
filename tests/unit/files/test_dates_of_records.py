"""Dates and units of a file stand in the record: from the first row, behind gaps, through every repair."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import polars as pl
import pytest

import lostmotion as lm
from tests.support.shared_data import shared

FIRST = datetime(2026, 3, 1, 6, 0)
N = 300
RNG = np.random.default_rng(5)
OP, PV = np.cumsum(RNG.normal(size=N)), RNG.normal(size=N)


def written(moments, form="%Y-%m-%d %H:%M:%S"):
    return [moment.strftime(form) for moment in moments]


def every(seconds, first=FIRST, n=N):
    return [first + timedelta(seconds=seconds * k) for k in range(n)]


def frame(times, name="Date"):
    n = len(times)
    return pl.DataFrame({name: times, "OP": np.resize(OP, n), "PV": np.resize(PV, n)})


def read(times, name="Date", **settings):
    return lm.read_loop(frame(times, name), **settings)


@pytest.mark.parametrize(
    ("times", "name", "expected"),
    [
        (written(every(60)), "Date", FIRST),
        (written(every(60))[::-1], "Date", FIRST),
        (every(60), "Date", FIRST),
        ([moment.replace(tzinfo=UTC) for moment in every(60)], "Date", FIRST.replace(tzinfo=UTC)),
        ([f"{text}Z" for text in written(every(60))], "Date", FIRST.replace(tzinfo=UTC)),
        (
            [f"{text}+02:00" for text in written(every(60))],
            "Date",
            FIRST.replace(tzinfo=timezone(timedelta(hours=2))),
        ),
        (written(every(60, n=2000), "%d/%m/%Y %H:%M"), "Date", FIRST),
        (written(every(60), "%d-%b-%y %H:%M:%S"), "Date", FIRST),
        ([1772344800 + 60 * k for k in range(N)], "Time", FIRST.replace(tzinfo=UTC)),
        ([1772344800000 + 60000 * k for k in range(N)], "t_ms", FIRST.replace(tzinfo=UTC)),
        ([46082.25 + k / 1440 for k in range(N)], "Time", FIRST),
    ],
)
def test_first_date_stands_as_the_file_writes_it(times, name, expected):
    found = read(times, name).start
    assert found == expected
    assert found.utcoffset() == expected.utcoffset()


@pytest.mark.parametrize("form", ["%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M", "%d.%m.%y %H:%M:%S"])
@pytest.mark.parametrize("first", [datetime(2026, 3, 2, 14, 5), datetime(2026, 3, 2, 23, 0)])
def test_where_dates_have_dots_the_day_is_first(first, form):
    assert read(written(every(60, first), form)).start == first


def test_days_that_follow_each_other_tell_the_order_of_slashes():
    first = datetime(2026, 3, 2, 23, 0)
    for form in ("%d/%m/%Y %H:%M", "%m/%d/%Y %H:%M"):
        assert read(written(every(60, first), form)).start == first


@pytest.mark.parametrize("reverse", [False, True])
def test_a_date_of_two_readings_keeps_the_clock_and_says_what_is_open(reverse):
    times = written(every(60, datetime(2026, 2, 3, 6, 0)), "%d/%m/%Y %H:%M:%S")
    found = read(times[::-1] if reverse else times)
    assert (found.start, found.dt, len(found)) == (None, 60.0, N)
    (note,) = [note for note in found.notes if "may be" in note]
    assert "may be 2026-02-03 (day first) or 2026-03-02 (month first)" in note
    assert "times of day and sampling time hold" in note


def test_files_of_one_tag_say_that_their_date_is_open(tmp_path):
    times = every(10, datetime(2026, 2, 3, 6, 0))
    for name, values, chosen in (("FIC1_OP", OP, times[::3]), ("FIC1_PV", PV, times[1:])):
        table = pl.DataFrame({"Time": written(chosen, "%d/%m/%Y %H:%M:%S"), name: np.resize(values, len(chosen))})
        table.write_csv(tmp_path / f"{name}.csv")
    found = lm.read_loop(tmp_path)
    assert found.start is None
    assert sum("(month first)" in note for note in found.notes) == 1


@pytest.mark.parametrize(
    "times",
    [
        [60.0 * k for k in range(N)],
        list(range(N)),
        written(every(60), "%H:%M:%S"),
        written(every(60, datetime(2026, 3, 1, 22, 0)), "%H:%M:%S"),
        every(60, datetime(1970, 1, 1)),
        [3_900_000_000 + 60 * k for k in range(N)],  # since 1904
        written(every(60, datetime(2026, 3, 4, 6, 0)), "%d/%m/%Y %H:%M:%S"),  # or the 3rd of April
    ],
)
def test_what_is_no_date_or_has_two_readings_is_none(times):
    found = read(times)
    assert found.dt in (1.0, 60.0)
    assert found.start is None


def test_behind_gaps_and_disorder_dates_are_those_of_the_rows():
    times = every(10)
    kept = [*times[40:90], *times[:40], *times[130:]]
    found = read(written(kept))
    assert (found.start, found.gaps, found.gap_seconds) == (FIRST, (90,), (400.0,))
    assert found.moment(90) == times[130]
    part = found["2026-03-01 06:21:40":"2026-03-01 06:30"]
    np.testing.assert_array_equal(part.op, found.op[90:140])


def test_counted_rows_miss_sampling_times():
    found = read([*range(100), *range(110, 310)], "Time", dt=5.0)
    assert (found.gaps, found.gap_seconds, found.start) == ((100,), (50.0,), None)


def test_stamps_of_a_minute_put_the_rows_behind_a_gap_into_theirs():
    minutes = [FIRST + timedelta(minutes=minute) for minute in (*range(100), *range(105, 200))]
    found = read(written([minute for minute in minutes for _ in range(60)], "%Y-%m-%d %H:%M"), dt=1.0)
    assert (found.dt, found.gaps, found.gap_seconds) == (1.0, (6000,), (300.0,))
    assert found.moment(6000) == minutes[100]


def test_an_hour_set_back_leaves_no_date_that_is_wrong_by_it():
    before = every(60, datetime(2026, 10, 25, 1, 0), 120)
    after = every(60, datetime(2026, 10, 25, 2, 0), 180)
    found = read(written([*before, *after]))
    assert any("set back" in note for note in found.notes)
    assert (len(found), found.gaps, found.start) == (N, (), None)


def test_drift_of_the_sampling_time_leaves_no_wrong_date():
    assert read(written(every(60, n=2000)), dt=60.2).start is None
    assert read(written(every(60, n=200)), dt=60.2).start == FIRST


def test_resampled_record_begins_with_its_first_value():
    steps = np.resize([1, 1, 5, 2, 9, 1, 3, 7], 400)
    times = [FIRST + timedelta(seconds=2 * int(second)) for second in np.cumsum(steps)]
    found = read(written(times))
    assert found.made_up[1] > 0.3
    assert found.start == times[0]
    assert found.moment(len(found) - 1) == times[-1]


def test_files_of_one_tag_keep_their_dates(tmp_path):
    times = every(10)
    for name, values, chosen in (("FIC1_OP", OP, times[::3]), ("FIC1_PV", PV, times[1:])):
        table = pl.DataFrame({"Time": written(chosen), name: np.resize(values, len(chosen))})
        table.write_csv(tmp_path / f"{name}.csv")
    found = lm.read_loop(tmp_path)
    assert found.start is not None
    assert found.start in times[:3]


@pytest.mark.parametrize("zone", ["UTC", "Europe/Berlin", "America/New_York"])
@pytest.mark.parametrize("form", [None, "%Y-%m-%dT%H:%M:%S%:z"])
def test_files_of_one_tag_keep_the_zone_of_their_dates(tmp_path, zone, form):
    moments = pl.datetime_range(FIRST, FIRST + timedelta(hours=6), "60s", eager=True, time_zone=zone)
    for late, name in enumerate(("OP", "PV")):
        times = moments[late:]
        columns = {
            "Time": times if form is None else times.dt.strftime(form),
            "Value": np.resize(PV, len(times)) + late,
        }
        pl.DataFrame(columns).write_parquet(tmp_path / f"FIC1_{name}.parquet")
    start = lm.read_loop(tmp_path).start
    assert start == moments[0]
    assert start.utcoffset() == moments[0].utcoffset()


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("Time;OP;PV\ns;%;m3/h\n", ("%", "m3/h")),
        ("Trend\n\nTime;OP;PV\n[s];[%];[kmol/h]\n", ("%", "kmol/h")),
        ("Time;OP (%);PV [°C]\n", ("%", "°C")),
        ("Time;OP;PV\ns;-;n/a\n", ("", "")),
        ("Time;OP [auto/man];PV (avg)\n", ("", "")),
    ],
)
def test_units_of_header_and_units_row(tmp_path, text, units):
    path = tmp_path / "a.csv"
    rows = "\n".join(f"{10 * k};{op:.3f};{pv:.3f}" for k, (op, pv) in enumerate(zip(OP, PV, strict=True)))
    path.write_text(text + rows, encoding="utf-8")
    found = lm.read_loop(path)
    assert (found.op_unit, found.pv_unit) == units
    assert (len(found), found.dt) == (N, 10.0)


def test_week_of_a_historian_is_sliced_by_dates():
    record = lm.read_loop(shared("historian_week/FIC-211.csv"))
    day = record["2024-11-23":"2024-11-24"]
    assert (len(day), day.start, day.dt) == (1440, datetime(2024, 11, 23), 60.0)
    assert record.moment(len(record) - 1) == datetime(2024, 11, 27, 23, 59)
