"""Files as they are packed: gzip, zip, Feather, spreadsheets."""

import gzip
import io
import zipfile

import numpy as np
import polars as pl
import pytest

from lostmotion.errors import DataError
from lostmotion.files import read_loop

TIMES = [f"2024-03-01 10:{k // 60:02d}:{k % 60:02d}" for k in range(200)]
FRAME = pl.DataFrame({"time": TIMES, "OP": np.arange(200) / 8, "PV": np.arange(200) / -4})
TEXT = FRAME.write_csv().encode()


def zipped(members):
    raw = io.BytesIO()
    with zipfile.ZipFile(raw, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return raw.getvalue()


def sheet(rows):
    """XML of a worksheet with the cells as inline text or numbers."""
    lines = []
    for row in rows:
        cells = (
            f"<c><v>{cell}</v></c>" if isinstance(cell, float) else f'<c t="inlineStr"><is><t>{cell}</t></is></c>'
            for cell in row
        )
        lines.append(f"<row>{''.join(cells)}</row>")
    start = '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>'
    return f"{start}{''.join(lines)}</sheetData></worksheet>"


def workbook(*sheets):
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    numbers = range(1, len(sheets) + 1)
    listed = "".join(f'<sheet name="S{k}" sheetId="{k}" r:id="r{k}"/>' for k in numbers)
    related = "".join(
        f'<Relationship Id="r{k}" Type="{office}/worksheet" Target="worksheets/sheet{k}.xml"/>' for k in numbers
    )
    parts = {
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>{listed}</sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">{related}</Relationships>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r1" '
        f'Type="{office}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="xml" '
        'ContentType="application/xml"/></Types>',
    }
    return zipped(parts | {f"xl/worksheets/sheet{k}.xml": sheet(rows) for k, rows in zip(numbers, sheets, strict=True)})


ROWS = [["Trend"], ["time", "OP", "PV"], ["", "%", "bar"], *([t, float(o), float(p)] for t, o, p in FRAME.iter_rows())]


def feather():
    raw = io.BytesIO()
    FRAME.write_ipc(raw)
    return raw.getvalue()


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("FIC-1.csv.gz", gzip.compress(TEXT)),
        ("FIC-1.csv.zip", zipped({"x/FIC-1.csv": TEXT, "__MACOSX/._x": b""})),
        ("FIC-1.feather", feather()),
    ],
)
def test_packed(tmp_path, name, raw):
    (tmp_path / name).write_bytes(raw)
    record = read_loop(tmp_path / name)
    np.testing.assert_array_equal(record.op, FRAME["OP"].to_numpy())
    assert (record.tag, record.dt, record.loop_type) == ("FIC-1", 1.0, "flow")


def test_damaged_spreadsheet_of_the_old_kind(tmp_path):
    path = tmp_path / "FIC-1.xls"
    path.write_bytes(bytes.fromhex("d0cf11e0a1b11ae1") + b"x" * 100)
    with pytest.raises(DataError, match=r"whole workbook|install lostmotion\[excel\]"):
        read_loop(path)


def test_spreadsheet(tmp_path):
    pytest.importorskip("fastexcel")
    path = tmp_path / "FIC-1.xlsx"
    path.write_bytes(workbook(ROWS, [["notes"]]))
    record = read_loop(path)
    np.testing.assert_array_equal(record.pv, FRAME["PV"].to_numpy())
    assert record.dt == 1.0
    path.write_bytes(workbook(ROWS, ROWS))
    with pytest.raises(DataError, match="one sheet with rows"):
        read_loop(path)
    path.write_bytes(workbook(ROWS)[:-400])
    with pytest.raises(DataError, match="damaged"):
        read_loop(path)


@pytest.mark.parametrize(
    ("raw", "said"),
    [
        (zipped({"a.csv": TEXT, "b.csv": TEXT}), "one file in"),
        (gzip.compress(TEXT)[:-200], "a whole archive"),
        (feather()[:300], "a whole Feather file"),
    ],
)
def test_what_cannot_be_unpacked(tmp_path, raw, said):
    path = tmp_path / "a.bin"
    path.write_bytes(raw)
    with pytest.raises(DataError, match=said):
        read_loop(path)
