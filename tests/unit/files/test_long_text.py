"""A long text is read in blocks and column by column: the same table as in one piece, and in little memory."""

import gzip
import subprocess
import sys

import numpy as np
import pytest

from lostmotion.errors import DataError
from lostmotion.files import read_loop, text, text_blocks
from lostmotion.files.text import parse_text
from lostmotion.files.text_frame import TextFrame

LINES = [
    "made by a historian",
    "Date;Time;FIC1.OP;FIC1.PV;FIC2.OP;note",
    "d;s;%;m3/h;%;",
    *(f"1.3.2024;{k // 3600:02d}:{k // 60 % 60:02d}:{k % 60:02d};{k % 7},5;{k % 11};7;" for k in range(600)),
]


def variants():
    odd = list(LINES)
    odd[90:90] = ["", "# restarted", "   ", LINES[1], "//"]
    last = [*odd, "1.3.2024;00:10:00;1;2;3;°C"]
    odd += [";;;;;", "", ";;"]
    quoted = [line.replace("note", '"a ""note"""') for line in LINES]
    quoted[50] += '"two\nlines"'
    quoted[51] += '"; a field"'
    yield "row of empty cells", "\n".join([*LINES[:400], ";;;;;", *LINES[400:]]).encode()
    yield "plain", "\n".join(LINES).encode()
    yield "line end", "\n".join([*LINES, ""]).encode()
    yield "CR LF", "\r\n".join(odd).encode()
    yield "CR", "\r".join([*odd, ""]).encode()
    yield "odd lines", "\n".join(odd).encode()
    yield "quoted", "\n".join(quoted).encode()
    yield "mark", "\n".join(last).encode("utf-8-sig")
    yield "Latin-1", "\n".join(last).encode("latin-1")
    yield "UTF-16", "\n".join(odd).encode("utf-16")
    yield "line ends at the end", "\n".join([*LINES, "", ""]).encode()
    yield "delimiter at the end", ";\n".join([*LINES, ""]).encode()
    yield "short rows", "\n".join([*LINES[:300], "1.3.2024", "1.3.2024;00:04:57;5", *LINES[300:]]).encode()
    yield "blanks", "\n".join(f"{k}   {k % 7} {k % 5}" if k else "t OP  PV" for k in range(900)).encode()
    yield "comments first", "\n".join([*["# comment"] * 300, *LINES[1:]]).encode()
    yield "empty cells last", "\n".join([*LINES, *[";;;;;"] * 300]).encode()


NO_RECORD = (
    "blanks",
    "short rows",
    "comments first",
    "row of empty cells",
)  # without a column of a usual name, or a time


@pytest.fixture
def short_blocks(monkeypatch):
    monkeypatch.setattr(text_blocks.cuts, "__defaults__", (2500,))


@pytest.mark.parametrize("case", dict(variants()))
def test_blocks_are_read_as_one_piece(case, request):
    raw = dict(variants())[case]
    whole = parse_text(raw, "a.csv")
    request.getfixturevalue("short_blocks")
    parts = parse_text(raw, "a.csv")
    if case != "comments first":
        assert isinstance(parts.frame, TextFrame) or case == "empty cells last"
    assert (parts.names, parts.delimiter, parts.notes) == (whole.names, whole.delimiter, whole.notes)
    assert len(parts.frame) == len(whole.frame)
    assert (parts.lines is None) == (whole.lines is None)
    assert whole.lines is None or list(parts.lines) == list(whole.lines)
    for name in whole.names:
        assert parts.column(name).to_list() == whole.column(name).to_list()
    rows = np.array([5, 3, 299])
    taken = (parts.taken(rows), whole.taken(rows))
    assert taken[0].column(whole.names[2]).to_list() == taken[1].column(whole.names[2]).to_list()
    assert taken[0].where(1) == taken[1].where(1)


@pytest.mark.parametrize("case", [case for case, _ in variants() if case not in NO_RECORD])
def test_records_of_blocks_are_those_of_one_piece(case, request, tmp_path):
    path = tmp_path / "FIC-1.csv"
    path.write_bytes(dict(variants())[case])
    whole = read_loop(path, loop="FIC1")
    request.getfixturevalue("short_blocks")
    parts = read_loop(path, loop="FIC1")
    assert (parts.dt, parts.notes, parts.gaps, len(parts)) == (whole.dt, whole.notes, whole.gaps, len(whole))
    np.testing.assert_array_equal(parts.op, whole.op)
    np.testing.assert_array_equal(parts.pv, whole.pv)


@pytest.mark.usefixtures("short_blocks")
def test_a_row_too_long_is_named_wherever_it_stands():
    rows = [*LINES[1:2], *LINES[3:]]
    rows[450] += "x;more"
    with pytest.raises(DataError, match="7 in line 451 of "):
        parse_text("\n".join(rows).encode(), "a.csv")


def test_only_the_columns_asked_for_are_parsed(short_blocks, monkeypatch):
    asked = []
    read = text._Rows._read
    monkeypatch.setattr(text._Rows, "_read", lambda self, places: asked.extend(places) or read(self, places))
    table = parse_text("\n".join(LINES).encode(), "a.csv")
    table.read_ahead(["FIC1.OP", "FIC1.PV"])
    table.column("FIC1.OP")
    assert asked == [2, 3]
    assert len(table.frame.filter([True] * 10 + [False] * 590)) == 10


PEAK = """
import resource, sys
import lostmotion.files
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
record = lostmotion.files.read_loop(sys.argv[1], loop="FIC1")
print(len(record), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="sizes are in KiB on Linux only")
def test_memory_of_a_wide_packed_file_is_near_that_of_its_text(tmp_path):
    n, tags = 150_000, 12
    rows = np.char.mod("%d", np.arange(n))
    cells = np.char.mod("%.2f", 50 + 10 * np.sin(np.arange(n) / 50))
    line = np.char.add(np.char.add(rows, ","), np.char.add(np.char.add(cells, ","), cells))
    for _ in range(tags - 1):
        line = np.char.add(np.char.add(line, ","), np.char.add(np.char.add(cells, ","), cells))
    head = ",".join(["time_s", *(f"FIC{k}.{role}" for k in range(1, tags + 1) for role in ("OP", "PV"))])
    content = "\n".join([head, *line.tolist(), ""]).encode()
    path = tmp_path / "wide.csv.gz"
    path.write_bytes(gzip.compress(content, 1))
    done = subprocess.run([sys.executable, "-c", PEAK, str(path)], capture_output=True, text=True, check=True)
    length, peak = map(int, done.stdout.split())
    assert length == n
    assert peak * 1024 < 4 * len(content) + 30e6  # as strings of all columns it was ten times the text
