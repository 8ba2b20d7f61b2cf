"""One record in many dresses: a follower gives what read_loop gives, or refuses with its words."""

import json
from itertools import product

import numpy as np
import pytest

from lostmotion.errors import InputError
from lostmotion.files import read_loop
from lostmotion.files.follow import Follower
from lostmotion.files.layout import Asked
from lostmotion.files.number_cells import BAD_WORDS
from lostmotion.records import modes

N = 150
OP = np.round(50 + 5 * np.sin(np.arange(N) / 5), 2)
PV = np.round(3 * np.cos(np.arange(N) / 7) - 1, 3)
PLAIN_MODE = ["AUTO", "MAN", "CAS"] * (N // 3)
START = np.datetime64("2024-03-04T23:58:30")
SECOND = np.timedelta64(1, "s")


def table(
    times=None, names=("time", "OP", "PV", "Mode"), delimiter=",", decimal=".", quote="", end="\n", mode=PLAIN_MODE,
    op=None, encoding="utf-8",
):  # fmt: skip
    """Bytes of the record; `times` are one or more texts a row."""
    times = [f"{2 * k}" for k in range(N)] if times is None else times
    rows = [list(names)]
    for k in range(N):
        numbers = [f"{OP[k]}" if op is None else op[k], f"{PV[k]}"]
        cells = [*([times[k]] if isinstance(times[k], str) else times[k]), *numbers, mode[k]]
        rows.append([cell.replace(".", decimal) if cell in numbers else cell for cell in cells])
    lines = [delimiter.join(f"{quote}{cell}{quote}" for cell in row) for row in rows]
    return (end.join(lines) + end).encode(encoding)


def moments(form, step=2, start=START, rows=N):
    return [(start + step * k * SECOND).astype(object).strftime(form) for k in range(rows)]


DATES = {
    "ISO": "%Y-%m-%d %H:%M:%S",
    "ISO with T and zone": "%Y-%m-%dT%H:%M:%S+01:00",
    "day first": "%d.%m.%Y %H:%M:%S",
    "month first": "%m/%d/%Y %I:%M:%S %p",
    "month by name": "%d-%b-%y %H:%M:%S",
    "fraction": "%Y-%m-%d %H:%M:%S.000",
}
DRESSES = {
    **{
        f"{delimiter!r} {decimal} {quote} {end!r} {encoding}": (
            table(delimiter=delimiter, decimal=decimal, quote=quote, end=end, encoding=encoding), {}
        )
        for delimiter, decimal, quote, end, encoding in product(
            (",", ";", "\t", "  "), ".,", ("", '"'), ("\n", "\r\n", "\r"), ("utf-8", "utf-8-sig", "latin-1")
        )
        if not (delimiter == "," == decimal and not quote) and not (delimiter == "  " and quote)
    },
    **{f"dates, {name}": (table(moments(form)), {}) for name, form in DATES.items()},
    **{
        f"{date} beside {clock}, {delimiter!r}": (
            table(
                [(day, at) for day, at in zip(moments(day_form), moments("%H:%M:%S"), strict=True)],
                (date, clock, "OP", "PV", "Mode"), delimiter,
            ),
            {},
        )
        for date, clock, day_form, delimiter in (
            ("date", "time", "%Y-%m-%d", ","),
            ("Date", "Time of Day", "%d.%m.%Y", ";"),
            ("DAY", "Clock", "%m/%d/%y", ","),
        )
    },
    "time of day": (table(moments("%H:%M:%S", start=START - np.timedelta64(1, "h"))), {}),
    "day numbers": (table([f"{45000 + 2 * k / 86400:.11f}" for k in range(N)]), {}),
    "epoch in s": (table([f"{1_700_000_000 + 2 * k}" for k in range(N)]), {}),
    "epoch in ms": (table([f"{1_700_000_000_000 + 2000 * k}" for k in range(N)]), {}),
    "unit in the name": (table([f"{k / 20:.2f}" for k in range(N)], ("t_min", "OP", "PV", "Mode")), {}),
    "counter with dt": (table([str(k) for k in range(N)]), {"dt": 2.0}),
    "counter": (table([str(k) for k in range(N)]), {}),
    "no times": (table([()] * N, ("OP", "PV", "Mode")), {"dt": 2.0}),
    "column of sampling times": (table([("2",)] * N, ("ts", "OP", "PV", "Mode")), {}),
    "sampling times, time ignored": (table([("5", "2")] * N, ("time", "ts", "OP", "PV", "Mode")), {"time": False}),
    "minute stamps with dt": (table(moments("%Y-%m-%d %H:%M", step=12)), {"dt": 12.0}),
    "ignored times": (table(["never"] * N), {"dt": 2.0, "time": False}),
    "dates of one reading or another": (table(moments("%d/%m/%y", step=86_400 * 3)), {"dt": 259_200.0}),
    "stamps that scatter": (table([f"{2 * k + (k * 7 % 5) / 10}" for k in range(N)]), {"dt": 2.0}),
    "rounded stamps": (table([f"{round(1.6 * k)}" for k in range(N)]), {}),
    "other names": (table(names=("Timestamp", "FIC-1.OP", "FIC-1.PV", "A/M")), {"mode": "a/m"}),
    "named columns": (
        table(names=("When", "FV_211", "FT_211", "State")),
        {"op": "fv_211", "pv": "FT_211", "time": "When", "mode": "State"},
    ),
    "comments": (b"# exported by x\n\n" + table(), {}),
    "a row of units": (table().replace(b"Mode\n", b"Mode\ns,%,degC,-\n"), {}),
    "a preamble": (b"Trend export;plant 1\nmade,2024-03-01\n\n" + table(), {}),
    "a name with blanks": (table(names=("Time", " OP ", "PV [%]", "Mode")), {}),
    **{
        f"bad cells, {word}": (table(op=[word if k % 11 == 5 else f"{OP[k]}" for k in range(N)], delimiter=";"), {})
        for word in ("", *sorted(BAD_WORDS))
    },
    **{
        f"mode {word!r}": (table(mode=[[word, "AUTO", "", "Man"][k % 4] for k in range(N)]), {})
        for known in (*modes.WORDS, "bad")
        for word in (known, known.upper(), f" {known.title()} ")
    },
}  # fmt: skip


def followed(path, settings):
    """Rows of the file, as they reach the estimator, in two portions with a restart between."""
    asked = Asked(**{"mode": "Mode"} | settings)
    with Follower(path, asked) as first:
        parts = [first.finish(70)]
        position = json.loads(json.dumps(first.position, allow_nan=False))
    with Follower(path, asked, position) as second:
        while len(parts[-1]) or second.more:
            parts.append(second.finish(70))
    names = ("time", "op", "pv", "automatic")
    return [np.concatenate([getattr(part, name) for part in parts if len(part)]) for name in names], second


@pytest.mark.sampled(40)
@pytest.mark.parametrize("dress", DRESSES)
def test_rows_that_reach_the_estimator(tmp_path, dress):
    raw, settings = DRESSES[dress]
    path = tmp_path / "loop.csv"
    path.write_bytes(raw)
    record = read_loop(path, **settings)
    (time, op, pv, automatic), follower = followed(path, settings)
    assert follower.layout.dt == record.dt
    np.testing.assert_array_equal(op, record.op)
    np.testing.assert_array_equal(pv, record.pv)
    np.testing.assert_array_equal(automatic, modes.rows_of("automatic", record.mode))
    assert not record.gaps
    jitter = {"stamps that scatter": 0.5, "rounded stamps": 0.5, "day numbers": 1e-5}.get(dress, 1e-6)
    np.testing.assert_allclose(time - time[0], np.arange(N) * record.dt, atol=jitter * record.dt)
    assert follower.counts["garbled"] == follower.counts["repeated"] == follower.counts["inserted"] == 0


def test_dress_is_one_record():
    assert len(DRESSES) > 300
    assert {"AUTO", "MAN", "CAS"} == set(PLAIN_MODE)


ROWS = [f"{k},{k % 7},{k % 5}" for k in range(100)]


def text(rows, header="time,OP,PV"):
    return "\n".join([header, *rows, ""]).encode()


REFUSED = {
    "no header": (text(ROWS[1:], "0,1,2"), {}),
    "header only": (text([]), {}),
    "a text in OP": (text([*ROWS[:30], "30,open,1", *ROWS[31:]]), {}),
    "an infinite PV": (text([*ROWS[:30], "30,1,inf", *ROWS[31:]]), {}),
    "a row too long": (text([*ROWS[:30], "30,1,1,1", *ROWS[31:]]), {}),
    "two decimal marks": (text(["0;1,5;2", "1;1.5;2", "2;1,5;2"], "t_s;OP;PV"), {}),
    "thousands": (text([f'{k},"1,25{k % 10}",2' for k in range(20)]), {}),
    "no OP": (text(ROWS, "time,X,PV"), {}),
    "two OP": (text([f"{row},1" for row in ROWS], "time,Op,PV,op "), {}),
    "another OP": (text(ROWS), {"op": "FV_211"}),
    "one column twice": (text(ROWS), {"op": "PV"}),
    "no such time": (text(ROWS), {"time": "When"}),
    "no time": (text(ROWS, "x,OP,PV"), {}),
    "no such mode": (text(ROWS), {"mode": "State"}),
    "no mode": (text(ROWS), {"mode": "Mode"}),
    "no dt": (text(ROWS), {"time": False}),
    "dt of 0": (text(ROWS), {"dt": 0.0}),
    "another dt": (text([f"{2 * k},1,{k % 5}" for k in range(100)]), {"dt": 3.0}),
    "another ts": (text([f"{2 * k},1,{k % 5},3" for k in range(100)], "time,OP,PV,ts"), {}),
    "one time": (text(["7,1,2"] * 60), {}),
    "a date that is none": (text([f"2024-02-30 10:00:{k},1,2" for k in range(10, 50)]), {}),
    "a word as time": (text(["0,1,2", "soon,1,2", *ROWS[2:50]]), {}),
    "days or seconds": (text([f"{45000 + k / 100:.2f},1,{k % 3}" for k in range(50)]), {}),
    "dates of two readings": (text([f"{1 + k:02d}/0{1 + k % 2}/24,1,2" for k in range(12)]), {}),
    "binary": (b"MZ\0\0\n\0\n\0\n\0\n", {}),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_read_loop_refuses(tmp_path, case):
    raw, settings = REFUSED[case]
    path = tmp_path / "loop.csv"
    path.write_bytes(raw)
    said = []
    for read in (
        lambda: read_loop(path, sp=None, position=False, **settings),
        lambda: follow_to_the_end(path, settings),
    ):
        with pytest.raises(InputError) as caught:
            read()
        said.append((type(caught.value), str(caught.value)))
    assert said[0] == said[1]


WHOLE = {  # what only a whole file tells
    "newest first": (text(ROWS[:50][::-1]), "ascending order"),
    "minute stamps": (text([f"{60 * (k // 5)},1,{k % 3}" for k in range(60)]), "give dt=12"),
    "jitter": (text([f"{12 * k + (k * 7 % 5)},1,{k % 3}" for k in range(60)]), "equally spaced"),
}


@pytest.mark.parametrize("case", WHOLE)
def test_what_only_a_growing_file_is_refused_for(tmp_path, case):
    raw, said = WHOLE[case]
    path = tmp_path / "loop.csv"
    path.write_bytes(raw)
    assert len(read_loop(path)) >= 50
    with pytest.raises(InputError, match=said):
        follow_to_the_end(path, {})


def follow_to_the_end(path, settings):
    with Follower(path, Asked(**settings)) as follower:
        follower.finish()
