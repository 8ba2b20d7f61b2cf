import numpy as np
import polars as pl
import pytest

from lostmotion import files
from lostmotion.errors import ColumnError, TimeError
from lostmotion.files.resampled import _rate
from lostmotion.records import prepare
from lostmotion.records.compression import compression


def read(times, **settings):
    n = len(times)
    frame = pl.DataFrame({"time": times, "OP": np.arange(n), "PV": np.arange(n)}, strict=False)
    return files.read_loop(frame, **settings)


def minutes(start, n, dt, form="{d:02d}/{m:02d}/24 {h}:{mi:02d}"):
    """Stamps cut to the minute, starting at second `start` of 18 July."""
    seconds = (start + np.arange(n) * dt).astype(int)
    return [form.format(d=18 + s // 86400, m=7, h=s // 3600 % 24, mi=s // 60 % 60) for s in seconds.tolist()]


def test_seconds():
    assert read([0.0, 0.5, 1.0, 1.5]).dt == 0.5
    assert read(np.arange(6601) * 0.01).dt == 0.01


@pytest.mark.parametrize("scale", [1, 1_000, 1_000_000, 1_000_000_000])
def test_epoch(scale):
    record = read((1_700_000_000 + np.arange(10) * 5) * scale)
    assert record.dt == 5.0
    assert "since 1970" in record.notes[0]


@pytest.mark.parametrize(
    ("cells", "dt"),
    [
        (["2017-01-21T15:20:00", "2017-01-21T15:20:05", "2017-01-21T15:20:10"], 5.0),
        (["2017-01-21 15:20:00.25+01:00", "2017-01-21 15:20:00.50+01:00"], 0.25),
        (["2017-03-26T00:59:59Z", "2017-03-26T01:00:00Z"], 1.0),
        (["1/21/2017 15:20", "1/21/2017 15:21"], 60.0),
        (["21/1/2017 15:20", "21/1/2017 15:21"], 60.0),
        (["1/21/2017 11:59:59 AM", "1/21/2017 12:00:00 PM"], 1.0),
        (["21-Jan-17 23:59:59", "22-Jan-17 00:00:01"], 2.0),
        (["31.12.2023 23:59:30", "01.01.2024 00:00:00"], 30.0),
        (["15:20:05", "15:20:07"], 2.0),
        (["2024-02-28", "2024-02-29", "2024-03-01"], 86400.0),
        (["0", "12", "24"], 12.0),
        (["0,5", "1,0", "1,5"], 0.5),
    ],
)
def test_text(cells, dt):
    assert read(cells).dt == pytest.approx(dt)


def test_month_of_daylight_saving_by_offset():
    assert read(["2017-10-29T02:59:59+02:00", "2017-10-29T02:00:00+01:00"]).dt == 1.0


@pytest.mark.parametrize("zone", ["+24:00", "+99:99", "-99:00", "+2400", "+23:60", "+15:01", "-0160", "+01:75"])
@pytest.mark.parametrize("form", ["2026-01-0{}T00:00:00{}", "0{}/01/2026 10:00 {}", "10:00:0{}{}"])
@pytest.mark.parametrize("row", [0, 1])
def test_impossible_zones_are_refused(form, zone, row):
    cells = [form.format(day, zone if day == 1 + row else zone[0] + "02:00") for day in (1, 2, 3)]
    with pytest.raises(TimeError, match="expected times in column 'time' "):
        read(cells)


@pytest.mark.parametrize("zone", ["+14:00", "-12:00", "+05:45", "-0930", "+00:00", "-00:00", "+15:00", "Z"])
def test_every_zone_on_earth_is_read(zone):
    assert read([f"2026-01-01T00:00:{second:02d}{zone}" for second in (1, 3, 5)]).dt == 2.0


def test_date_columns_of_frames():
    stamps = pl.datetime_range(pl.datetime(2024, 1, 1), pl.datetime(2024, 1, 1, 0, 1), "5s", eager=True)
    assert read(stamps).dt == 5.0
    assert read(stamps - stamps[0]).dt == 5.0


def test_unit_in_the_name():
    frame = pl.DataFrame({"t_ms": [0, 250, 500], "OP": [1, 2, 3], "PV": [1, 2, 3]})
    assert files.read_loop(frame).dt == 0.25


def test_order_of_day_and_month_by_what_follows():
    # 12 January to 13 January, or 1 December to nothing: only day first exists in every row
    assert read(["12/01/17 23:59:59", "13/01/17 00:00:00"]).dt == 1.0
    # both exist; the other reading would step back or leap a month
    cells = [f"{4 + k // 24:02d}/05/17 {k % 24}:00" for k in range(200)]
    record = read(cells)
    assert record.dt == 3600.0
    assert "day first" in record.notes[0]


def test_order_that_does_not_matter_is_not_asked():
    record = read(["05/06/24 10:00:00", "05/06/24 10:00:10"])
    assert record.dt == 10.0
    assert "2024-06-05 (day first) or 2024-05-06 (month first)" in record.notes[0]  # the clock holds, the day is open


def test_order_that_cannot_be_told():
    cells = ["01/02/24", "02/03/24", "03/04/24", "04/05/24"]
    with pytest.raises(TimeError, match=r"one reading.*dt=<seconds>"):
        read(cells)
    record = read(cells, dt=5.0)
    assert record.dt == 5.0
    assert "not checked" in record.notes[0]


@pytest.mark.parametrize("cells", [["2017-02-29", "2017-03-01"], ["25:00:xx", "26"], ["10:00:00", "2024-01-01"]])
def test_no_date(cells):
    with pytest.raises(TimeError, match=r"row [12]"):
        read(cells)


def test_minute_stamps_are_spread():
    cells = minutes(26 * 60, 721, 12.0)
    record = read(cells)
    assert (record.dt, record.gaps) == (12.0, ())
    assert "about 5.0 rows a minute, 12 s each; they were spread evenly, 12 s apart" in record.notes[-1]
    assert read(cells, dt=12.0).dt == 12.0
    with pytest.raises(TimeError, match="dt = 12 s as in"):
        read(cells, dt=20.0)


@pytest.mark.parametrize("dt", [1.0, 7.0, 10.0, 40.0])
def test_rate_of_minute_stamps_is_close(dt):
    assert read(minutes(31, 600, dt)).dt == pytest.approx(dt, rel=0.01)


def test_minute_stamps_newest_first():
    assert read(minutes(31, 600, 10.0)[::-1]).op[0] == 599


def test_uneven_minute_stamps_need_dt():
    rng = np.random.default_rng(5)
    cells = minutes(0, 600, 10.0)
    left = [cell for cell, kept in zip(cells, rng.random(600) < 0.6, strict=True) if kept]
    with pytest.raises(TimeError, match=r"several rows carry one stamp.*give dt=") as caught:
        read(left)
    (way,) = caught.value.ways
    assert read(left, **way).dt == way["dt"]


def test_newest_first_is_turned_round():
    record = read([8.0, 6.0, 4.0, 2.0, 0.5][:4])
    assert record.op.tolist() == [3, 2, 1, 0]
    assert "newest first" in record.notes[0]


def test_newest_first_with_dates_of_two_readings():
    cells = [f"{4 + k // 24:02d}/05/17 {k % 24}:00" for k in range(200)]
    record = read(cells[::-1])
    assert (record.dt, record.op[0]) == (3600.0, 199)


def test_a_few_rows_in_disorder_are_sorted():
    times = (2.0 * np.arange(100)).tolist()
    times[10], times[11] = times[11], times[10]
    times.append(times.pop(40))
    record = read(times)
    assert (record.dt, record.gaps) == (2.0, ())
    np.testing.assert_array_equal(record.op[[10, 11, 40]], [11, 10, 99])
    assert "out of order" in record.notes[0]


def test_exact_duplicates_are_left_out():
    times = np.repeat(2.0 * np.arange(50), np.where(np.arange(50) % 20 == 3, 2, 1))
    values = np.round(np.sin(times), 3)
    record = files.read_loop(pl.DataFrame({"time": times, "OP": values, "PV": values}))
    assert (len(record), record.dt) == (50, 2.0)
    assert "3 rows stood twice" in record.notes[0]


def dated(start, seconds):
    return (np.datetime64(start) + np.asarray(seconds).astype("timedelta64[s]")).astype(str).tolist()


def test_overlap_of_two_exports():
    seconds = np.r_[np.arange(0, 500, 5), np.arange(400, 900, 5)]
    values = np.sin(seconds / 50.0)
    frame = pl.DataFrame({"time": dated("2024-03-01T10:00:00", seconds), "OP": values, "PV": values})
    record = files.read_loop(frame)
    np.testing.assert_array_equal(record.op, np.sin(np.arange(0, 900, 5) / 50.0))
    assert "20 rows stood twice" in record.notes[0]


def test_overlap_that_contradicts_is_refused():
    seconds = np.r_[np.arange(0, 500, 5), np.arange(400, 900, 5)]
    cells = dated("2024-03-01T10:00:00", seconds)
    with pytest.raises(TimeError, match="ascending order"):
        read(cells)


@pytest.mark.parametrize(("back", "day"), [(3, "2024-10-27"), (2, "2024-11-03")])
def test_clock_set_back_in_autumn(back, day):
    before = np.arange(-7200, 0, 10)
    seconds = np.r_[before, np.arange(-3600, 3600, 10)]
    cells = dated(f"{day}T0{back}:00:00", seconds)
    record = read(cells)
    assert (record.dt, record.gaps) == (10.0, ())
    np.testing.assert_array_equal(record.op, np.arange(len(seconds)))
    assert "set back an hour" in record.notes[0]
    np.testing.assert_array_equal(read(cells[::-1]).op, np.arange(len(seconds))[::-1])


def test_an_hour_back_on_another_day_is_refused():
    seconds = np.r_[np.arange(-7200, 0, 10), np.arange(-3600, 3600, 10)]
    with pytest.raises(TimeError, match="ascending order"):
        read(dated("2024-10-23T03:00:00", seconds))


def test_times_of_day_go_on_after_midnight():
    cells = [f"{s // 3600 % 24:02d}:{s // 60 % 60:02d}:{s % 60:02d}" for s in range(86000, 87000, 10)]
    record = read(cells)
    assert (record.dt, record.gaps) == (10.0, ())
    np.testing.assert_array_equal(record.op, np.arange(100))


def test_recordings_one_into_the_other_are_refused():
    times = np.r_[2.0 * np.arange(50), 1 + 2.0 * np.arange(50)] + 5
    with pytest.raises(TimeError, match="ascending order"):
        read(times)


def test_jitter_of_a_scan():
    rng = np.random.default_rng(4)
    steps = rng.choice([10.0, 11.0, 12.0, 13.0, 19.0], size=500, p=[0.1, 0.5, 0.3, 0.09, 0.01])
    record = read(np.r_[0.0, np.cumsum(steps)])
    assert record.dt == pytest.approx(steps[steps < 19].mean(), rel=0.005)
    assert "scatter from 10 to 19 s" in record.notes[0]
    with_time = np.r_[0.0, np.cumsum(steps)]
    assert "says 12 s" in with_ts(with_time, 12.0).notes[-1]
    with pytest.raises(TimeError, match="one sampling time"):
        with_ts(with_time, 20.0)


def test_two_rates_in_one_file_are_refused():
    rng = np.random.default_rng(6)
    steps = np.r_[rng.choice([1.0, 2.0], size=300), np.full(300, 2.0)] + rng.uniform(0, 0.1, 600)
    with pytest.raises(TimeError, match="equally spaced"):
        read(np.r_[3.0, 3.0 + np.cumsum(steps)])


def test_gap_in_minute_stamps():
    cells = minutes(0, 100, 12.0) + minutes(3600, 100, 12.0)
    assert read(cells, dt=12.0).gaps == (100,)
    assert read(cells).gaps == (100,)


@pytest.mark.parametrize("rows", [(60, 60), (60, 25), (20, 60)])
def test_rows_beside_a_gap_in_minute_stamps_do_not_tell_the_rate(rows):
    counts = {0: 60, 1: 60, 2: 60, 3: rows[0], 10: rows[1], 11: 60, 12: 60}
    record = read([f"2024-07-18 06:{minute:02d}" for minute, count in counts.items() for _ in range(count)])
    assert record.dt == 1.0
    assert record.gap_seconds == (420.0 - rows[0],)


def test_same_time_everywhere():
    with pytest.raises(TimeError, match="the same time in every row"):
        read(["2024-01-01 10:00"] * 5)


def test_unsorted_names_row_and_time():
    with pytest.raises(TimeError, match=r"ascending.*got 1\.0 in row 4 after 2\.0 in row 3"):
        read([0.5, 1.0, 2.0, 1.0, 3.0])


def test_repeated_names_row_and_time():
    times = [*np.arange(0.0, 20.0, 0.5), 19.5]
    with pytest.raises(TimeError, match=r"each time once.*19\.5 in row 41"):
        read(times)


def test_contradiction():
    with pytest.raises(TimeError, match=r"dt = 30 s as in column 'time', got dt = 1 s"):
        read([0, 30, 60, 90], dt=1.0)
    record = read([0, 30, 60, 90], dt=1.0, time=False)
    assert (record.dt, record.gaps) == (1.0, ())


@pytest.mark.parametrize("first", [0, 1])
def test_counter_yields_to_dt(first):
    record = read(np.arange(first, first + 50), dt=20.0)
    assert record.dt == 20.0
    assert record.notes == ("'time' counts samples; dt = 20 s was given.",)


def test_counter_alone_is_one_second_with_a_note():
    record = read(np.arange(50))
    assert record.dt == 1.0
    assert "taken as seconds" in record.notes[0]


def test_counter_with_missing_rows():
    rows = np.delete(np.arange(50), [10, 11, 30])
    record = read(rows, dt=5.0)
    assert (record.gaps, np.flatnonzero(record.missing).tolist()) == ((), [10, 11, 30])


def with_ts(times, ts, **settings):
    n = len(times)
    return files.read_loop(pl.DataFrame({"Time": times, "OP": range(n), "PV": range(n), "ts": [ts] * n}), **settings)


def test_sampling_column_that_contradicts():
    with pytest.raises(TimeError, match=r"10 s from column 'Time' and 12 s.*dt=10"):
        with_ts([0, 10, 20], 12.0)
    assert "says 12 s" in with_ts([0, 10, 20], 12.0, dt=10.0).notes[0]
    assert with_ts([0, 10, 20], 10.0).dt == 10.0


def test_a_counter_leaves_the_rate_to_the_sampling_column():
    record = with_ts([1, 2, 3], 20.0)
    assert record.dt == 20.0
    assert "'Time' counts the rows; dt = 20 s" in record.notes[0]
    assert with_ts([1, 2, 3], 20.0, dt=1.0).dt == 1.0


def test_ways_out_of_a_contradiction_lead_on():
    with pytest.raises(TimeError) as caught:
        with_ts([0, 10, 20], 12.0)
    assert [with_ts([0, 10, 20], 12.0, **way).dt for way in caught.value.ways] == [10.0, 12.0]
    with pytest.raises(TimeError) as caught:
        read([0, 30, 60, 90], dt=1.0)
    assert [read([0, 30, 60, 90], **way).dt for way in caught.value.ways] == [30.0, 1.0]


def test_sampling_column_near_the_mean_of_coarse_stamps_is_taken():
    assert with_ts(minutes(0, 601, 9.994), 10.0).dt == 10.0


def test_sampling_column_alone():
    frame = pl.DataFrame({"OP": [1, 2, 3], "PV": [1, 2, 3], "Ts": [4.0, None, None]})
    record = files.read_loop(frame)
    assert record.dt == 4.0
    assert "column of sampling times" in record.notes[0]


def test_ts_that_varies_is_a_time_column():
    frame = pl.DataFrame({"OP": [1, 2, 3], "PV": [1, 2, 3], "ts": [10.0, 14.0, 18.0]})
    assert files.read_loop(frame).dt == 4.0


def test_neither_time_nor_dt():
    frame = pl.DataFrame({"OP": [1, 2, 3], "PV": [1, 2, 3]})
    with pytest.raises(TimeError, match="give the sampling time"):
        files.read_loop(frame)
    assert files.read_loop(frame, dt=0.1).dt == 0.1


def test_jitter_uses_the_median():
    rng = np.random.default_rng(1)
    times = 100.0 + 2.0 * np.arange(500) + rng.uniform(-0.009, 0.009, 500)
    assert read(times).dt == pytest.approx(2.0, rel=1e-3)


def test_gaps_are_recorded():
    times = np.delete(2.5 * np.arange(100) + 7, [20, 21, 22, 70])
    record = read(times)
    assert (record.dt, record.gaps, len(record)) == (2.5, (), 100)
    assert np.flatnonzero(record.missing).tolist() == [20, 21, 22, 70]
    assert any("4 rows of the regular clock are absent" in note for note in record.notes)
    record = read(np.delete(2.5 * np.arange(100) + 7, [20, 21, 22, *range(70, 80)]))
    assert (record.gaps, record.gap_seconds, np.flatnonzero(record.missing).tolist()) == ((70,), (25.0,), [20, 21, 22])


def test_rounded_stamps_use_the_mean():
    times = np.round(1.6 * np.arange(1000)) + 3
    record = read(times)
    assert record.dt == pytest.approx(1.6, rel=1e-3)
    assert "rounded to 1 s" in record.notes[0]
    assert read(times, dt=1.6).dt == 1.6


def test_irregular():
    rng = np.random.default_rng(2)
    times = 5.0 + np.cumsum(rng.exponential(3.0, 300))
    with pytest.raises(TimeError, match=r"equally spaced.*fixed interval.*give dt=.*time=False") as caught:
        read(times)
    (way,) = caught.value.ways
    record = read(times, **way)
    assert record.dt == way["dt"]
    assert "of PV made up" in record.notes[-1]
    np.testing.assert_allclose(
        record.pv, np.interp(5 + (times[0] - 5) + np.arange(len(record)) * way["dt"], times, range(300))
    )
    assert set(record.op) <= set(range(300))
    with pytest.raises(TimeError):
        read(times, dt=30.0)


def test_scatter_about_a_given_dt_is_noted():
    rng = np.random.default_rng(3)
    times = 5.0 + np.cumsum(rng.uniform(10.0, 14.0, 300))
    record = read(times, dt=12.0)
    assert "vary from" in record.notes[0]


def test_missing_times():
    times = [5.0, 7.0, None, 11.0, 13.0]
    with pytest.raises(TimeError, match=r"a time in every row.*row 3"):
        read(times)
    record = read(times, dt=2.0)
    assert record.gaps == ()
    assert "1 rows have no time" in record.notes[0]
    with pytest.raises(TimeError, match="got none"):
        read(pl.Series([None, None], dtype=pl.Float64))


@pytest.mark.parametrize("first", [42756.6389, 736712.25])
@pytest.mark.parametrize("step", [1.0, 10.0, 60.0, 3600.0])
def test_day_numbers(first, step):
    record = read(first + np.arange(100) * step / 86400)
    assert record.dt == step
    assert "day numbers" in record.notes[0]
    assert read([f"{first + k * step / 86400:.6f}" for k in range(100)]).dt == pytest.approx(step, rel=0.01)


def test_day_numbers_or_seconds():
    times = 42756.5 + 0.01 * np.arange(100)
    with pytest.raises(TimeError, match="seconds or day numbers of a spreadsheet") as caught:
        read(times)
    assert [read(times, **way).dt for way in caught.value.ways] == [0.01, 864.0]


def test_stamps_of_mixed_kinds_are_refused():
    with pytest.raises(TimeError, match="all alike"):
        read(["01/02/2017 10:00", "01/02/17 10:01"])


def test_days_as_dates():
    days = pl.select(pl.date_range(pl.date(2024, 1, 1), pl.date(2024, 1, 5))).to_series()
    assert read(days).dt == 86400.0


def test_coarse_and_irregular_stamps_are_refused():
    with pytest.raises(TimeError, match="equally spaced"):
        read([5.0, 5.0, 6.0, 9.0, 9.0, 20.0, 21.0, 40.0, 40.0, 90.0], dt=1.0)


def test_stamps_that_change_once():
    assert read(["2024-01-01 10:00"] * 4 + ["2024-01-01 10:01"] * 4, dt=8.0).dt == 8.0


def test_dt_that_fits_the_mean_but_not_the_steps():
    rng = np.random.default_rng(7)
    times = 5.0 + np.cumsum(np.where(rng.random(400) < 0.2, 40.123, 10.456))
    assert "were resampled to 10.456 s" in read(times, dt=10.456).notes[-1]


def test_few_rows_far_apart_are_refused():
    with pytest.raises(TimeError, match="equally spaced"):
        read([2.0, 43.5, 1000.0])


def test_bad_dt():
    for dt in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="expected dt > 0"):
            read([0, 1, 2], dt=dt)


def compressed(values, deviation):
    """Places of values that exception reporting stores."""
    kept, last = [0], values[0]
    for place, value in enumerate(values):
        if abs(value - last) > deviation:
            kept.append(place)
            last = value
    return np.unique([*kept, len(values) - 1])


def test_exception_reports_are_resampled_to_their_scan():
    clean = np.sin(np.arange(2000) / 60.0) + np.random.default_rng(8).normal(scale=0.03, size=2000)
    rows = compressed(clean, 0.08)
    times = 5.0 * rows
    frame = pl.DataFrame({"t_s": times, "OP": clean[rows], "PV": clean[rows]})
    record = files.read_loop(frame)
    assert (record.dt, len(record)) == (5.0, 2000)
    np.testing.assert_array_equal(record.pv[rows], clean[rows])
    held = clean[rows][np.searchsorted(rows, np.arange(2000), side="right") - 1]
    np.testing.assert_array_equal(record.op, held)
    share = 100 * (1 - len(rows) / 2000)
    assert f"{share:.0f} % of OP, {share:.0f} % of PV made up" in record.notes[-1]
    assert compression(record, "pv").share >= share / 100 - 0.01


def test_nothing_is_made_up_over_a_hole():
    clean = np.sin(np.arange(3000) / 20.0)
    rows = compressed(clean, 0.05)
    rows = rows[(rows < 1000) | (rows > 2000)]
    frame = pl.DataFrame({"t_s": 5.0 * rows, "OP": clean[rows], "PV": clean[rows]})
    record = files.read_loop(frame, dt=5.0)
    assert record.missing[1010:1990].all()
    assert not record.missing[:990].any()


def test_each_tag_with_its_own_stamps():
    k = np.arange(400)
    op = pl.DataFrame(
        {"t_s": 10.0 * k + 3, "OP": np.sin(k / 9.0), "PV": [None] * 400}, schema_overrides={"PV": pl.Float64}
    )
    pv = pl.DataFrame({"t_s": 10.0 * k, "OP": [None] * 400, "PV": np.cos(k / 9.0)}, schema_overrides={"OP": pl.Float64})
    record = files.read_loop(pl.concat([op, pv]).sort("t_s"))
    assert record.dt == 10.0
    np.testing.assert_array_equal(record.pv, np.cos(k / 9.0))
    np.testing.assert_array_equal(record.op[1:], np.sin(k / 9.0)[:-1])


def test_tags_that_are_stored_in_turn_at_regular_times():
    k = np.arange(400)
    values = {"OP": np.where(k % 2 == 0, np.sin(k / 9.0), np.nan), "PV": np.where(k % 2, np.cos(k / 9.0), np.nan)}
    record = files.read_loop(pl.DataFrame({"t_s": 5.0 * k, **values}).fill_nan(None))
    assert (record.dt, record.missing.any()) == (10.0, False)
    np.testing.assert_array_equal(record.pv, values["PV"][1::2])
    np.testing.assert_array_equal(record.op, values["OP"][::2])
    assert record.made_up == (1.0, 0.0)  # half a sample before PV: what OP did between is not known
    assert "made up by the historian" in " ".join(prepare(record).notes)


def test_rows_are_absent_in_which_neither_had_moved():
    random = np.random.default_rng(5)
    n = 2000
    values = {name: np.sin(np.arange(n) / 60.0) + random.normal(scale=0.03, size=n) for name in ("OP", "PV")}
    stored = {name: np.isin(np.arange(n), compressed(cells, 0.006)) for name, cells in values.items()}
    rows = stored["OP"] | stored["PV"]
    frame = pl.DataFrame(
        {"t_s": 5.0 * np.arange(n), **{name: np.where(stored[name], values[name], np.nan) for name in values}}
    )
    record = files.read_loop(frame.fill_nan(None).filter(rows))
    assert (record.dt, len(record), record.missing.any()) == (5.0, n, False)
    np.testing.assert_array_equal(record.pv[stored["PV"]], values["PV"][stored["PV"]])
    assert 0.02 < record.made_up[0] < 0.2


def test_a_row_for_each_value_at_times_of_its_own():
    k = np.arange(200)
    op = [("FIC7.OP", 10 * n + 3, float(n)) for n in k]
    pv = [("FIC7.PV", 10 * n, -float(n)) for n in k]
    other = [("TI9", 7 * n + 1, 1.0) for n in k]
    long = pl.DataFrame([*op, *pv, *other], schema=["Tag", "t_s", "Value"], orient="row")
    record = files.read_loop(long)
    assert (record.dt, record.gaps) == (10.0, ())
    np.testing.assert_array_equal(record.pv, -k)
    np.testing.assert_array_equal(record.op[1:200], k[:199])


def test_a_wide_table_with_a_column_of_values_is_no_long_one():
    k = np.arange(50)
    frame = pl.DataFrame({"t_s": k, "Name": ["F7"] * 50, "OP": k, "PV": -k, "Value": k * 2})
    np.testing.assert_array_equal(files.read_loop(frame).pv, -k)


def test_empty_cells_on_regular_times_stay_missing():
    k = np.arange(200.0)
    op, pv = (np.where(np.random.default_rng(seed).random(200) < 0.4, k, np.nan) for seed in (1, 2))
    record = files.read_loop(pl.DataFrame({"t_s": k, "OP": op, "PV": pv}).fill_nan(None))
    np.testing.assert_array_equal(record.op, op)


def test_a_row_for_each_value_of_each_tag():
    k = np.arange(300)
    stamps = dated("2024-03-01T10:00:00", 5 * k)
    parts = {"FIC7.OP": np.sin(k / 9.0), "FIC7.PV": np.cos(k / 9.0), "FIC8.OP": k / 1.0, "FIC8.PV": -k / 1.0}
    long = pl.concat(
        pl.DataFrame({"Tag": [tag] * 300, "Timestamp": stamps, "Value": values, "Quality": ["Good"] * 299 + ["Bad"]})
        for tag, values in parts.items()
    )
    with pytest.raises(ColumnError, match="2 loops") as caught:
        files.read_loop(long)
    records = [files.read_loop(long, **way) for way in caught.value.ways]
    np.testing.assert_array_equal(records[0].op[:-1], np.sin(k / 9.0)[:-1])
    np.testing.assert_array_equal(records[1].pv[:-1], -k[:-1])
    assert np.isnan(records[0].op[-1])
    assert "bad quality" in " ".join(records[0].notes)
    with pytest.raises(ColumnError, match="one value of a tag"):
        files.read_loop(pl.concat([long, long.with_columns(pl.col("Value") + 1)]), loop="FIC7")


def test_a_step_of_next_to_nothing_is_no_scan():
    steps = np.ones(60)
    steps[[3, 7]] = 2.0, 5e-310
    seconds = np.concatenate([[0.0], np.cumsum(steps)])
    seconds[8] = seconds[7] + 5e-310
    assert _rate(seconds, steps, False, None) is None
