"""Quality of values: bad is no measurement, uncertain is kept and said, or left out where that is asked for."""

import shlex

import numpy as np
import polars as pl
import pytest

from lostmotion.errors import ColumnError, ParameterError
from lostmotion.files import read_loop, read_loops
from lostmotion.files.quality import BAD, GOOD, UNCERTAIN, marks_of
from tests.e2e.test_commands import run

N = 60
OP = np.round(50 + 9 * np.sin(np.arange(N) / 7), 2)
PV = np.round(20 + 3 * np.cos(np.arange(N) / 7), 2)
BAD_ROWS, DOUBTFUL = [5, 6, 30], [11, 40]
CODES = {  # good, uncertain, bad
    "words": ("Good", "Uncertain", "Bad"),
    "long words": ("Good, non-specific", "UncertainLastUsableValue", "BadNoCommunication"),
    "German": ("Gut", "Unsicher", "Gestört"),
    "OPC DA": ("192", "64", "0"),
    "OPC DA, substatus": ("216", "88", "24"),
    "OPC DA in hexadecimal": ("0xC0", "0x44", "0x08"),
    "OPC UA": ("0", "1083179008", "2147483648"),
    "OPC UA, signed": ("0", "1083179008", "-2147483648"),
    "OPC UA in hexadecimal": ("0x00000000", "0x40920000", "0x80310000"),
}


def marks(code):
    good, uncertain, bad = CODES[code]
    column = np.full(N, good, dtype=object)
    column[DOUBTFUL], column[BAD_ROWS] = uncertain, bad
    return column


def frame(of_pv, of_op=None, names=("t_s", "OP", "OP.Status", "PV", "PV.Status")):
    good = [of_pv[0]] * N if of_op is None else of_op
    columns = (np.arange(N), OP, [str(word) for word in good], PV, [str(word) for word in of_pv])
    return pl.DataFrame(dict(zip(names, columns, strict=True)))


def missing(values):
    return np.flatnonzero(np.isnan(values)).tolist()


@pytest.mark.parametrize("code", CODES)
def test_bad_is_missing_and_uncertain_as_asked(code):
    source = frame(marks(code))
    record = read_loop(source)
    assert missing(record.pv) == BAD_ROWS
    assert missing(record.op) == []
    notes = " ".join(record.notes)
    assert "3 values of 'PV' with bad quality" in notes
    assert "2 values of 'PV' with uncertain quality" in notes
    assert missing(read_loop(source, uncertain="bad").pv) == sorted(BAD_ROWS + DOUBTFUL)
    assert missing(read_loop(source, quality=False).pv) == []


@pytest.mark.parametrize("code", ["OPC DA", "OPC UA", "OPC UA, signed"])
def test_codes_as_numbers(code):
    source = frame(marks(code)).with_columns(pl.col("OP.Status", "PV.Status").cast(pl.Int64))
    assert missing(read_loop(source).pv) == BAD_ROWS


@pytest.mark.parametrize(
    "names",
    [
        ("t_s", "FIC1.OUT", "FIC1.OUT Quality", "FIC1.PV", "FIC1.PV Quality"),
        ("t_s", "FIC1/PID1/OUT.CV", "FIC1/PID1/OUT.ST", "FIC1/PID1/PV.CV", "FIC1/PID1/PV.ST"),
        ("t_s", "OP", "Status OP", "PV", "Status PV"),
        ("t_s", "OP", "Quality (1)", "PV", "Quality (2)"),
    ],
)
def test_columns_of_quality_by_name_and_by_place(names):
    record = read_loop(frame(marks("words"), names=names))
    assert (missing(record.pv), missing(record.op)) == (BAD_ROWS, [])


@pytest.mark.parametrize("name", ["Quality", "Status"])
def test_one_quality_of_the_row(name):
    source = frame(marks("words")).drop("OP.Status").rename({"PV.Status": name})
    record = read_loop(source)
    assert missing(record.pv) == missing(record.op) == BAD_ROWS


def test_a_status_that_is_none_is_passed_over():
    of_pv = np.where(np.arange(N) < 30, "AUTO", "MAN").astype(object)
    record = read_loop(frame(of_pv, of_pv))
    assert missing(record.pv) == []
    assert "'PV.Status' was not read as the quality of 'PV': no word of it is known ('auto', 'man')." in record.notes
    alone = frame(np.arange(N) % 3).drop("OP.Status").rename({"PV.Status": "Status"})
    assert missing(read_loop(alone).pv) == []


def test_unknown_words_are_uncertain():
    column = marks("words")
    column[20] = "Recalled by hand"
    notes = " ".join(read_loop(frame(column)).notes)
    assert "3 values of 'PV' with uncertain quality ('uncertain', 'recalled by hand') kept" in notes


def test_numbers_of_two_readings_are_refused_with_a_command_that_works(capsys, tmp_path):
    source = frame(np.arange(N) % 2)
    with pytest.raises(ColumnError, match=r"0, 1: no codes of OPC, and 0 may be good or bad"):
        read_loop(source)
    path = tmp_path / "FIC1.csv"
    source.write_csv(path)
    code, _, error = run(capsys, "check", path)
    commands = [shlex.split(line)[1:] for line in error.splitlines() if line.startswith("    lostmotion")]
    assert (code, commands) == (1, [["check", str(path), "--ignore-quality"]])
    assert run(capsys, *commands[0])[::2] == (0, "")


def test_the_option_that_the_note_names_works(capsys, tmp_path):
    path = tmp_path / "FIC1.csv"
    frame(marks("OPC DA")).write_csv(path)
    text = run(capsys, "check", path)[1]
    assert "2 values of 'PV' with uncertain quality ('64') kept; --uncertain bad leaves out such values." in text
    text = run(capsys, "check", path, "--uncertain", "bad")[1]
    assert "2 values of 'PV' with uncertain quality ('64') left out" in text
    with pytest.raises(ParameterError, match="uncertain='keep' or 'bad'"):
        read_loop(path, uncertain="drop")


def test_tables_of_tags_and_files_of_one_tag(tmp_path):
    rows = [("FIC1.PV", k, PV[k], word) for k, word in enumerate(marks("OPC DA"))]
    rows += [("FIC1.OP", k, OP[k], "192") for k in range(N)]
    long = pl.DataFrame(rows, schema=["Tag", "t_s", "Value", "Quality"], orient="row")
    for settings, expected in (({}, BAD_ROWS), ({"uncertain": "bad"}, sorted(BAD_ROWS + DOUBTFUL))):
        assert missing(read_loop(long, **settings).pv) == expected
        for (tag,), part in long.partition_by("Tag", as_dict=True).items():
            part.drop("Tag").write_csv(tmp_path / f"{tag.replace('.', '_')}.csv")
        assert missing(read_loop(tmp_path, **settings).pv) == expected
        assert missing(read_loops(tmp_path, **settings)["FIC1"].pv) == expected


def test_marks():
    assert marks_of(["0"], "Q").tolist() == [GOOD]
    assert marks_of(["3"], "Q") is None
    assert marks_of(["0", "64"], "Q").tolist() == [BAD, UNCERTAIN]
    assert marks_of(["1073741824", "3145728"], "Q").tolist() == [UNCERTAIN, GOOD]
