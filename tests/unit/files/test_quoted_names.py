"""Names of columns over several lines."""

from __future__ import annotations

import pytest

import lostmotion as lm
from lostmotion.files.quoted_names import joined

ROWS = "".join(f"{k},{k % 7},{k % 5}\n" for k in range(40))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_names_over_two_lines_are_read(tmp_path, end):
    path = tmp_path / "loop.csv"
    path.write_bytes(('Time,"OP\n%","PV\nm3/h"\n' + ROWS).replace("\n", end).encode())
    record = lm.read_loop(path)
    assert len(record) == 40
    assert (record.op[8], record.pv[8]) == (1.0, 3.0)


def test_errors_still_name_the_line_of_the_file(tmp_path):
    path = tmp_path / "loop.csv"
    path.write_text('Time,"OP\n%","PV\nm3/h"\n' + ROWS + "40,x,1\n")
    with pytest.raises(lm.DataError, match="line 44"):
        lm.read_loop(path)


@pytest.mark.parametrize(
    "raw",
    [b"Time,OP,PV\n0,1,2\n", b'Time,"OP","PV"\n0,1,2\n', b'3" valve,"OP\n0,1\n', b'a,"OP' + b"\n" * 12 + b'",c\n'],
)
def test_what_is_no_broken_name_stays(raw):
    assert joined(raw) == raw
