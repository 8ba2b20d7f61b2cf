"""Following a record: what the rows give, what is refused, and going on from a kept position."""

import io
import json
import os

import numpy as np
import polars as pl
import pytest

from lostmotion.errors import ColumnError, DataError, FileAccessError, ParameterError, TimeError
from lostmotion.files import read_loop
from lostmotion.files.dates import _iso_dates, _slow_dates, dates_in_order
from lostmotion.files.follow import Follower
from lostmotion.files.grid import LONGEST_GAP
from lostmotion.files.layout import HEAD_ROWS, Asked
from lostmotion.files.text_lines import LONGEST_LINE
from tests.support.refusals import refusal


def whole(raw, most=20_000, **asked):
    """All samples of a text that will not grow, and the follower."""
    follower = Follower(io.BytesIO(raw), Asked(**asked))
    parts = [follower.finish(most)]
    while len(parts[-1]) or follower.more:
        parts.append(follower.finish(most))
    return joined(parts), follower


def joined(parts):
    columns = [np.concatenate([getattr(part, name) for part in parts]) for name in ("time", "op", "pv")]
    automatic = [part.automatic for part in parts if part.automatic is not None]
    return *columns, np.concatenate(automatic) if automatic else None, [note for part in parts for note in part.notes]


def text(rows, header="time,OP,PV", end="\n"):
    return (end.join([header, *rows]) + end).encode()


def numbered(n, step=1.0, start=0.0):
    return [f"{start + step * k:.10g},{k % 7},{k % 5}" for k in range(n)]


def test_reads_what_read_loop_reads(tmp_path):
    raw = text([f"{k * 0.5},{k % 7},{'Bad' if k == 9 else k % 5}" for k in range(200)])
    (tmp_path / "a.csv").write_bytes(raw)
    record = read_loop(tmp_path / "a.csv")
    (time, op, pv, _, notes), follower = whole(raw)
    np.testing.assert_array_equal(op, record.op)
    np.testing.assert_array_equal(pv, record.pv)
    np.testing.assert_array_equal(time, np.arange(200) * 0.5)
    assert follower.layout.dt == record.dt
    assert notes == []


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\r\r\n"])
@pytest.mark.parametrize(
    ("delimiter", "decimal", "quote"),
    [(",", ".", ""), (";", ",", ""), ("\t", ",", ""), ("  ", ",", ""), (",", ",", '"'), (",", ".", '"')],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_text_formats(end, delimiter, decimal, quote, encoding):
    cells = [["time", "Größe", "OP", "PV"], *([k / 2, "°", k % 3 + 0.25, -k / 4] for k in range(80))]
    rows = [delimiter.join(f"{quote}{str(cell).replace('.', decimal)}{quote}" for cell in row) for row in cells]
    (time, op, pv, _, notes), follower = whole((end.join(rows) + end).encode(encoding))
    np.testing.assert_array_equal(time, np.arange(80) / 2)
    np.testing.assert_array_equal(op, np.arange(80) % 3 + 0.25)
    np.testing.assert_array_equal(pv, -np.arange(80) / 4)
    assert follower.layout.dt == 0.5
    assert notes == []


def test_last_line_waits_for_its_end():
    (_, op, _, _, _), follower = whole(text(numbered(80)) + b"80,3,4")
    assert op.size == 80
    assert follower._lines.waiting == b"80,3,4"


def test_waits_until_the_first_rows_are_there(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(text(numbered(HEAD_ROWS - 1)))
    with Follower(path) as follower, path.open("ab") as stream:
        assert len(follower.read()) == 0
        assert follower.layout is None
        stream.write(f"{HEAD_ROWS - 1},1,1\n{HEAD_ROWS},2,".encode())
        stream.flush()
        assert len(follower.read()) == HEAD_ROWS
        assert len(follower.read()) == 0
        stream.write(b"3\n")
        stream.flush()
        assert follower.read().pv.tolist() == [3.0]


def test_comments_blank_lines_and_repeated_headers():
    rows = numbered(100)
    raw = b"# made by x\n\n" + text([*rows[:70], "# shift change", "", "time,OP,PV", *rows[70:]])
    (time, _, _, _, notes), _ = whole(raw)
    np.testing.assert_array_equal(time, np.arange(100.0))
    assert notes == []


def test_cells_that_cannot_be_read_are_missing_and_told():
    rows = numbered(100)
    rows[70], rows[71], rows[72], rows[73], rows[74] = "70,?x,1", "71,1,2,3,4", '72,"1,2', "73", "74,3.4e38,I/O Timeout"
    (time, op, pv, _, notes), follower = whole(text(rows))
    assert time.size == 100
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(op)), [70, 71, 72, 73, 74])
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(pv)), [71, 72, 73, 74])
    assert [note.line for note in notes] == [72, 73, 74, 76]
    assert follower.counts["garbled"] == 4


def test_an_odd_quote_does_not_swallow_lines():
    rows = numbered(100)
    rows[80] = '80,"1,1'
    (time, op, _, _, _), _ = whole(text(rows))
    assert time.size == 100
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(op)), [80])


def test_decimal_mark_that_comes_late_is_kept():
    rows = [f"{k};1;2" for k in range(70)] + ["70;1,5;2", "71;1.5;2,5"]
    (_, op, pv, _, _), follower = whole(text(rows, "t_s;OP;PV"), most=3)
    assert follower.layout.decimal == ","
    assert op[-2] == 1.5
    assert np.isnan(op[-1])
    assert pv[-1] == 2.5


def test_gap_becomes_missing_samples():
    rows = numbered(80) + numbered(5, start=90)
    (time, op, _, _, notes), follower = whole(text(rows))
    np.testing.assert_array_equal(time, np.arange(95.0))
    assert np.isnan(op[80:90]).all()
    assert np.isfinite(op[90:]).all()
    assert follower.counts["inserted"] == 10
    assert notes == []


def test_long_gap_is_cut_and_told():
    rows = numbered(80) + numbered(5, start=1e5)
    (time, op, _, _, notes), _ = whole(text(rows))
    assert time.size == 85 + LONGEST_GAP
    assert time[-5] == 1e5
    assert time[-6] == 1e5 - 1
    assert np.isnan(op[80:-5]).all()
    assert "a long gap" in notes[0].text
    assert "Line 82 (100000 s)" in notes[0].text


def test_repeated_and_backward_stamps_are_left_out_and_told():
    rows = numbered(80)
    rows[70:70] = [rows[69], rows[60]]
    (time, _, _, _, notes), follower = whole(text(rows))
    np.testing.assert_array_equal(time, np.arange(80.0))
    assert [note.line for note in notes] == [72, 73]
    assert follower.counts["repeated"] == 2


def test_notes_get_rarer():
    rows = numbered(80) + [numbered(80)[-1]] * 1200
    (_, _, _, _, notes), follower = whole(text(rows), most=7)
    assert follower.counts["repeated"] == 1200
    assert len(notes) == 12
    assert "(1000 such rows so far)" in notes[-1].text


def test_a_clock_that_begins_anew_is_a_new_recording():
    rows = numbered(80, start=1e6) + numbered(80)
    follower = Follower(io.BytesIO(text(rows)))
    found = follower.finish()
    assert len(found) == 160 + LONGEST_GAP
    assert found.breaks.tolist() == [80]
    assert np.isnan(found.op[80 : 80 + LONGEST_GAP]).all()
    assert found.time[80 + LONGEST_GAP] == 0.0
    assert "new recording" in found.notes[0].text


STEPS = (-1e5, -7203.0, -3600.0, -60.0, -3.0, -0.5, 0.5, 3.0, 60.0, 3600.0, 1e5, 4e7)  # s, of NTP to a dead battery


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("row", [10, 30, 55, 100])
def test_a_clock_that_is_set_never_ends_it(step, row):
    """Also among the first rows, from which the sampling time is taken: once refused there."""
    seconds = 2.0 * np.arange(4000)
    seconds[row:] += step
    (time, op, _, _, notes), follower = whole(text([f"{t},{k},{k % 5}" for k, t in enumerate(seconds)]))
    assert follower.layout.dt == 2.0
    taken = op[~np.isnan(op)]
    late = 0 if step < -7200.0 else int(max(-step, 0.0) / 2.0) + 1
    np.testing.assert_array_equal(taken[:row], np.arange(row))
    np.testing.assert_array_equal(taken[-1000:], np.arange(3000, 4000))
    assert len(taken) >= 4000 - late
    assert bool(notes) == (step < -2.0 or step > 2000.0)
    assert time[-1] == seconds[-1]


def test_an_odd_step_of_rounded_stamps_is_no_clock_that_is_set():
    seconds = np.round(2.03 * np.arange(400))
    assert whole(text([f"{t},{k % 7},{k % 5}" for k, t in enumerate(seconds)]))[1].layout.dt == pytest.approx(
        2.03, 0.01
    )


def test_one_wild_stamp_does_not_stop_the_service():
    rows = numbered(90)
    rows[70] = "1e15,1,1"
    (time, op, _, _, _), follower = whole(text(rows))
    assert follower.counts["restarts"] == 2
    assert time[-1] == 89.0
    assert np.isfinite(op[-19:]).all()


def test_jitter_neither_loses_nor_makes_samples():
    rng = np.random.default_rng(0)
    times = np.arange(2000) * 2.0 + rng.uniform(-0.4, 0.4, 2000)
    rows = [f"{time:.3f},{k % 7},{k % 5}" for k, time in enumerate(times)]
    (_, op, _, _, _), follower = whole(text(rows), dt=2.0)
    np.testing.assert_array_equal(op, np.arange(2000) % 7)
    assert follower.counts["inserted"] == follower.counts["repeated"] == 0


def test_rounded_stamps_neither_lose_nor_make_samples():
    rows = [f"{round(1.6 * k)},{k % 7},{k % 5}" for k in range(3000)]
    (_, op, _, _, _), follower = whole(text(rows))
    np.testing.assert_array_equal(op, np.arange(3000) % 7)
    assert follower.layout.dt == pytest.approx(1.6, rel=0.02)


def test_faster_logging_is_thinned_to_the_sampling_time():
    rows = numbered(80) + numbered(101, step=0.1, start=80)
    (time, op, _, _, _), follower = whole(text(rows))
    np.testing.assert_allclose(time, np.arange(91), atol=0.6)
    assert np.isfinite(op).all()
    assert follower.counts["repeated"] == 90


def test_dates_in_any_order_are_told_when_they_tell():
    moments = np.datetime64("2024-06-05T23:58") + np.arange(300) * np.timedelta64(1, "s")
    rows = []
    for moment in moments:
        day, clock = str(moment).split("T")
        year, month, number = day.split("-")
        rows.append(f"{number}/{month}/{year} {clock},1,2")
    expected = moments.astype("datetime64[s]").astype(float)
    for most in (1, 7, 1000):
        (time, op, _, _, _), follower = whole(text(rows), most=most)
        np.testing.assert_array_equal(time[120:], expected[120:])
        assert follower.layout.orders == ("day first",)
        assert op.size == 300
        assert follower.layout.calendar == "local"
    swapped = [f"{row[3:6]}{row[:3]}{row[6:]}" for row in rows]
    (time, _, _, _, _), follower = whole(text(swapped), most=11)
    assert follower.layout.orders == ("month first",)
    np.testing.assert_array_equal(time[120:], expected[120:])


def test_fast_and_slow_dates_are_the_same_to_the_last_bit():
    rng = np.random.default_rng(0)
    moments = (rng.integers(0, 2**41, 3000) * 997).astype("datetime64[us]")
    text = [str(moment) for moment in moments] + [str(moment.astype("datetime64[s]")) for moment in moments]
    text += [cell.replace("T", " ") for cell in text] + ["2024-02-30 00:00:00", "2024-02-03", "24-02-03 10:00", "?"]
    cells = pl.Series("t", [*text, None])
    fast, slow = dates_in_order(cells, "year first"), _slow_dates(cells, "year first")
    np.testing.assert_array_equal(fast, slow)
    assert np.isnan(fast).sum() == 3
    assert not np.isnan(_iso_dates(cells[:12_000])).any()


def test_times_of_day_go_on_after_midnight():
    seconds = (86_400 - 90 + np.arange(200)) % 86_400
    rows = [f"{s // 3600:02d}:{s // 60 % 60:02d}:{s % 60:02d},1,2" for s in seconds]
    (time, op, _, _, _), _ = whole(text(rows))
    np.testing.assert_array_equal(np.diff(time), 1.0)
    assert np.isfinite(op).all()


def test_epochs_are_utc_and_counters_count_samples():
    (time, *_), follower = whole(text([f"{1_700_000_000_000 + 100 * k},1,{k}" for k in range(80)]))
    assert (follower.layout.calendar, follower.layout.dt) == ("UTC", 0.1)
    np.testing.assert_allclose(time, 1.7e9 + np.arange(80) * 0.1)
    (time, *_), follower = whole(text(numbered(80)), dt=0.2)
    np.testing.assert_allclose(time, np.arange(80) * 0.2)


def test_without_times_rows_are_a_sampling_time_apart():
    raw = text([f"{k % 7},{k % 5}" for k in range(90)], "OP,PV")
    with pytest.raises(TimeError, match="a time column or dt"):
        whole(raw)
    (time, *_), _ = whole(raw, most=7, dt=0.25)
    np.testing.assert_array_equal(time, np.arange(90) * 0.25)


def test_mode_column():
    modes = ["AUTO", "Cas", "MAN", "", "Bad"] * 20
    rows = [f"{row},{mode}" for row, mode in zip(numbered(100), modes, strict=True)]
    (*_, automatic, _), _ = whole(text(rows, "time,OP,PV,Mode"), mode="mode")
    np.testing.assert_array_equal(automatic, [True, True, False, False, False] * 20)
    _, follower = whole(text(rows, "time,OP,PV,Mode"))
    assert "'Mode' was not used" in follower.layout.notes[0]
    numbers = [f"{row},{k % 2}" for k, row in enumerate(numbered(100))]
    with pytest.raises(ColumnError, match="which content means automatic"):
        whole(text(numbers, "time,OP,PV,Mode"), mode="Mode")
    (*_, automatic, _), _ = whole(text(numbers, "time,OP,PV,Mode"), mode="Mode", automatic=("1.0",))
    np.testing.assert_array_equal(automatic, np.arange(100) % 2 == 1)


def test_missing_samples_do_not_count_as_manual():
    rows = [f"{row},MAN" for row in numbered(80) + numbered(5, start=90)]
    (_, op, _, automatic, _), _ = whole(text(rows, "time,OP,PV,Mode"), mode="Mode")
    np.testing.assert_array_equal(automatic, np.isnan(op))


@pytest.mark.parametrize(
    ("raw", "kind", "said"),
    [
        (b"", DataError, "rows"),
        (b"time,OP,PV\n0,1,2\n", DataError, "at least 3 complete rows, got 1"),
        (b"1,2,3\n" * 5, DataError, "column names"),
        (text(["0,1,2", "0,1,2", "0,1,3", "60,1,2", "60,1,2"]), TimeError, "several rows carry one stamp"),
        (text(["0,1,2", "7,1,2", "9,1,3", "60,1,2", "61,1,2"]), TimeError, "equally spaced"),
        (text(["0,furlong,1", "0,1,2", "1,1,2", "2,1,3"]), DataError, "numbers in column"),
        (text(["0,1,2"] * 3, "time,OPP,PV"), ColumnError, "a column 'OP'"),
        (text(numbered(5)).decode().encode("utf-16"), DataError, "UTF-16"),
        (b"PAR1\0\0\n\0\n\0\n\0\n", DataError, "binary"),
    ],
)
def test_what_cannot_be_followed_is_refused_at_the_door(raw, kind, said):
    assert said in refusal(kind, whole, raw)


def test_an_endless_line_is_refused():
    assert "binary" in refusal(DataError, whole, b"OP,PV\0" + b"x" * (LONGEST_LINE + 1))
    assert "more than" in refusal(DataError, whole, b"OP,PV" + b"x" * (LONGEST_LINE + 1))


def test_a_text_column_is_refused_and_dt_has_to_be_positive():
    refusal(ColumnError, whole, text([f"{k},open,{k}" for k in range(10)]))
    refusal(ParameterError, Asked, dt=0.0)
    said = refusal(TimeError, whole, text(numbered(10)), time=False)
    assert said == "expected a time column or dt, got neither; give the sampling time, dt=<seconds>"


def stored(follower):
    return json.loads(json.dumps(follower.position, allow_nan=False))


@pytest.mark.parametrize("cut", [1, 59, 60, 61, 75])
def test_goes_on_where_it_stood(tmp_path, cut):
    rows = [f"{row},{'AUTO' if k % 3 else 'MAN'}" for k, row in enumerate(numbered(80) + numbered(20, start=90))]
    raw = text(rows, "time,OP,PV,Mode", "\r\n")
    path = tmp_path / "a.csv"
    asked = Asked(mode="Mode")
    lines = raw.splitlines(keepends=True)
    path.write_bytes(b"".join(lines[: cut + 1]) + lines[cut + 1][:3])
    first = Follower(path, asked)
    parts = [first.read()]
    position = stored(first)
    first.close()
    path.write_bytes(raw)
    with Follower(path, asked, position) as second:
        parts += [second.read(most=5), *(second.read() for _ in range(4))]
        reached = second.position
    found, (expected, other) = joined(parts), whole(raw, mode="Mode")
    for got, wanted in zip(found[:4], expected[:4], strict=True):
        np.testing.assert_array_equal(got, wanted)
    assert second.counts == other.counts
    assert reached["grid"] == other.position["grid"]


OLD_POSITION = {  # of lostmotion 0.1.0 before the words of the mode column and two columns of times were known here
    "version": 1, "file": True,
    "asked": {"op": "OP", "pv": "PV", "time": "Zeit", "mode": "Mode", "automatic": [], "dt": None},
    "offset": 2257,
    "mark": {
        "offset": 2257,
        "head": "107c7da9d936ed4750504a52ec5f69b5efd21f1e862d8e7a070a4cc5c73cb766",
        "tail": "d9aa34b110d2c5dec315bfa0b8701aa1aeb2ad427562701b1050a9ef537b22df",
    },
    "lines": 81, "end": "\n",
    "layout": {
        "header": "Zeit;OP;PV;Mode", "names": ["Zeit", "OP", "PV", "Mode"], "delimiter": ";", "op": "OP", "pv": "PV",
        "time": "Zeit", "mode": "Mode", "decimal": ",", "dt": 60.0, "scale": 1.0,
        "orders": ["day first", "month first"], "calendar": "local",
        "automatic": ["auto", "automatic", "aut", "cas", "cascade", "rcas", "bcas"],
        "notes": ["Numbers were read with a decimal comma."], "last_date": "01.03.2024 01:19",
    },
    "grid": {
        "clock": [1709255940.0, 0.0, 0.0, 0.0],
        "counts": {
            "rows": 80, "inserted": 0, "garbled": 0, "untimed": 0, "repeated": 0, "long gaps": 0, "restarts": 0,
        },
    },
}  # fmt: skip


def test_goes_on_from_a_position_of_an_older_version(tmp_path):
    rows = [f"01.03.2024 {k // 60:02d}:{k % 60:02d};{k % 7},5;{k % 5};{'AUT' if k % 3 else 'MAN'}" for k in range(120)]
    path = tmp_path / "old_a.csv"
    path.write_bytes(text(rows, "Zeit;OP;PV;Mode", "\r\n"))
    with Follower(path, Asked(time="Zeit", mode="Mode"), OLD_POSITION) as follower:
        found = follower.read()
    np.testing.assert_array_equal(found.time, 1709251200.0 + 60.0 * np.arange(80, 120))
    np.testing.assert_array_equal(found.op, np.arange(80, 120) % 7 + 0.5)
    np.testing.assert_array_equal(found.automatic, np.arange(80, 120) % 3 > 0)
    assert found.notes == ()


def test_points_of_dates_prove_no_decimal_point():
    rows = [f"01.03.2024 10:{k // 60:02d}:{k % 60:02d};{k % 7};{k % 5}" for k in range(70)]
    (_, op, _, _, notes), follower = whole(text([*rows, "01.03.2024 10:01:10;1,5;2"], "time;OP;PV"))
    assert follower.layout.decimal == ","
    assert op[-1] == 1.5
    assert notes == []


@pytest.fixture
def followed(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(text(numbered(100)))
    with Follower(path) as follower:
        follower.read()
        yield path, follower


def test_another_shorter_or_rewritten_file_is_refused(tmp_path, followed):
    path, follower = followed
    position = stored(follower)
    path.write_bytes(text(numbered(99)))
    assert "only longer" in refusal(DataError, Follower, path, None, position)
    path.write_bytes(text(numbered(200, start=0.5)))
    assert "other bytes" in refusal(DataError, Follower, path, None, position)
    raw = bytearray(text(numbered(200)))
    raw[position["offset"] - 3] ^= 1
    path.write_bytes(raw)
    assert "other bytes" in refusal(DataError, Follower, path, None, position)
    with pytest.raises(FileAccessError, match="no such file"):
        Follower(tmp_path / "b.csv", None, position)


def test_rotation_in_service_is_told_after_the_rest_was_read(tmp_path, followed):
    path, follower = followed
    assert len(follower.read()) == 0
    with path.open("ab") as stream:
        stream.write(b"100,1,2\n")
    path.rename(tmp_path / "a.csv.1")
    assert len(follower.read()) == 1
    assert len(follower.read()) == 0  # the writer may put it back
    path.write_bytes(text(numbered(3)))
    assert "rotated" in refusal(DataError, follower.read)


@pytest.mark.parametrize("content", [text(numbered(3)), text(numbered(500, start=7))])
def test_rewriting_in_service_is_told(followed, content):
    path, follower = followed
    assert len(follower.read()) == 0
    path.write_bytes(content)  # same inode
    refusal(DataError, follower.read)


def test_other_columns_or_another_kind_of_source_are_refused(tmp_path, followed):
    path, follower = followed
    position = stored(follower)
    assert "op='OP' as before" in refusal(ParameterError, Follower, path, Asked(op="PV"), position)
    refusal(ParameterError, Follower, io.BytesIO(b""), None, position)
    refusal(DataError, Follower, path, None, position | {"version": 99})
    with pytest.raises(FileAccessError, match="regular file"):
        Follower(tmp_path)


def test_a_stream_may_begin_again_or_go_on():
    rows = numbered(120)
    first = Follower(io.BytesIO(text(rows[:80])))
    first.finish()
    position = stored(first)
    for raw in (text(rows), text(rows[80:]), "\n".join([*rows[80:], ""]).encode()):
        second = Follower(io.BytesIO(raw), None, position)
        time = joined([second.read(most=13) for _ in range(10)])[0]
        np.testing.assert_array_equal(time, np.arange(80.0, 120.0))
    other = Follower(io.BytesIO(text(rows, "time,MV,PV")), None, position)
    assert "the header" in refusal(DataError, other.read)


def test_a_stream_again_after_a_long_time_is_passed_over():
    rows = numbered(200, step=3600.0)
    first = Follower(io.BytesIO(text(rows[:150])))
    first.finish()
    second = Follower(io.BytesIO(text(rows)), None, stored(first))
    found = second.read()
    np.testing.assert_array_equal(found.time, np.arange(150, 200) * 3600.0)
    assert second.counts["restarts"] == 0


def test_pipe_without_rows_does_not_block():
    read_end, write_end = os.pipe()
    with os.fdopen(read_end, "rb") as stream:
        follower = Follower(stream)
        assert len(follower.read()) == 0
        assert not follower.source.ended
        os.write(write_end, text(numbered(70)))
        assert len(follower.read()) == 70
        os.close(write_end)
        assert len(follower.read()) == 0
        assert follower.source.ended
