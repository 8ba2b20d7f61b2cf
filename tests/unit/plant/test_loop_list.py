"""Loop lists: every wrong line says what, where and what to do; lists on sources; proposals."""

import csv
import io
import pickle
from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from lostmotion.cli.propose import propose as propose_text
from lostmotion.errors import ColumnError, DataError, FileAccessError, InputError
from lostmotion.plant import PlantLoop, loop_list_text, open_plant, parse_loop_list, propose, read_loop_list
from lostmotion.records import LoopRecord
from tests.support.plants import TAGS, N, frame, make, put, side_by_side, signals

HEADER = "tag,op,pv,type,op_low,op_high,weight,file,time,slave"


def errors(text):
    with pytest.raises(DataError) as caught:
        parse_loop_list(text, "loops.csv")
    return str(caught.value).splitlines()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (",a,b", "expected a tag, got none in line 2 of loops.csv; name the loop"),
        ("F1,a,", "expected op and pv, or neither, got op without pv in line 2 of loops.csv; name both columns"),
        ("F1,,,flaw", "expected type as one of flow, pressure, temperature, level, analyser, concentration, other, got "
         "'flaw' in line 2 of loops.csv; choose one, or none"),
        ("F1,,,,0", "expected op_low below op_high, got 0 and none in line 2 of loops.csv; give both, or neither"),
        ("F1,,,,9,1", "expected op_low below op_high, got 9 and 1 in line 2 of loops.csv; give both, or neither"),
        ("F1,,,,0,full", "expected op_high as a number, got 'full' in line 2 of loops.csv; correct it"),
        ("F1,,,,,,nan", "expected weight as a number, got 'nan' in line 2 of loops.csv; correct it"),
        ("F1,,,,,,-1", "expected weight >= 0, got -1 in line 2 of loops.csv; 1 is usual"),
        ("F1,,,,,,,f,,F1", "expected another loop as slave, got 'F1' itself in line 2 of loops.csv; leave it out"),
        ("F1,,,,,,,f,,,g", "expected 10 cells, got 11 in line 2 of loops.csv; quote cells that hold a comma"),
    ],
)  # fmt: skip
def test_a_wrong_line_is_named(line, said):
    assert errors(f"{HEADER}\n{line}\n") == [said]


def test_all_wrong_lines_are_named_at_once():
    found = errors(f"{HEADER}\nF1,,,,,,x\n# a remark\n\nF2\nF2\nF3,,,,,,y\n")
    assert [line.split(" of loops.csv")[0].split("line ")[-1] for line in found] == ["2", "6", "7"]
    assert "got 'F2' in line 5 and line 6" in found[1]
    many = errors(HEADER + "\n" + "\n".join(f"F{k},,,,,,x" for k in range(30)))
    assert len(many) == 11
    assert many[-1] == "and 20 more lines"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "expected a header with the columns tag, op, pv"),
        ("tag,op,pv\n", "got a header only"),
        ("loop,op,pv\nF1,a,b\n", "expected a column 'tag' in loops.csv, got ['loop', 'op', 'pv']"),
        ("tag,weigth\nF1,2\n", "expected a column 'weight' in loops.csv, got 'weigth'; correct its name"),
        ("tag,op,op\nF1,a,b\n", "expected each column once in loops.csv, got 'op' twice"),
    ],
)
def test_a_wrong_header(text, said):
    assert said in errors(text)[0]


def test_unknown_columns_are_said():
    found = parse_loop_list("Tag;Op;Pv;owner;weight\nF1;a;b;Anna;1,5\n", "loops.csv")
    assert found.notes == ("Columns that are not known in loops.csv were passed over: owner.",)
    assert (found.loops[0].weight, found.loops[0].op) == (1.5, "a")


def test_files_as_spreadsheets_write_them(tmp_path):
    path = tmp_path / "loops.csv"
    path.write_bytes("\ufefftag\tarea\r\nF1\tSäure\r\n".encode())
    assert read_loop_list(path).loops == (PlantLoop("F1", area="Säure"),)
    path.write_bytes("tag,area\nF1,Säure\n".encode("latin-1"))
    assert read_loop_list(str(path)).loops[0].area == "Säure"
    with pytest.raises(FileAccessError, match="no such file"):
        read_loop_list(tmp_path / "absent.csv")


def listed(tmp_path, *lines, header="tag,op,pv,sp,type,op_low,op_high,weight,file,dt,time,area", source="wide parquet"):
    plant, settings = make(source, tmp_path / "data") if "database" not in source else make(source, tmp_path)
    (tmp_path / "loops.csv").write_text("\n".join([header, *lines]) + "\n")
    return open_plant(plant, tmp_path / "loops.csv", **settings)


@pytest.mark.parametrize(
    "source", ["wide parquet", "wide csv", "long parquet", "files csv", "rows parquet", "wide database"]
)
def test_loops_of_a_list(tmp_path, source):
    plant = listed(tmp_path, "fic-101,,,,level,0,50,3,,,,Z", "PIC103", source=source)
    first, second = plant.loops()
    assert (first.tag, first.loop_type, first.weight, first.area) == ("fic-101", "level", 3.0, "Z")
    assert second.loop_type == "pressure"
    found = {loop.tag: record for loop, record in pickle.loads(pickle.dumps(plant)).read((first, second))}  # noqa: S301
    np.testing.assert_array_equal(found["fic-101"].op, signals(0)["OP"])
    assert (found["fic-101"].loop_type, found["fic-101"].op_span) == ("level", (0.0, 50.0))
    assert found["fic-101"].tag == "fic-101"
    assert [(one.failed, "LIC102" in one.why) for one in plant.unread()] == [(False, True)]


@pytest.mark.parametrize("source", ["wide parquet", "wide csv", "long parquet", "long csv", "wide database"])
def test_loops_by_their_columns(tmp_path, source):
    plant = listed(tmp_path, "valve,FIC101.OP,LIC102.PV", source=source)
    (loop,) = plant.loops()
    ((_, record),) = plant.read([loop])
    assert isinstance(record, LoopRecord), record
    np.testing.assert_array_equal(record.op, signals(0)["OP"])
    np.testing.assert_array_equal(record.pv, signals(1)["PV"])


def test_columns_that_are_not_there(tmp_path):
    plant = listed(tmp_path, "FIC101,FIC101.OPP,FIC101.PV", "X,a,b", "Y,,,,,,,,absent.csv", "PIC103")
    assert [loop.tag for loop in plant.loops()] == ["FIC101", "PIC103"]
    told = {one.where: one.why for one in plant.unread() if one.failed}
    assert "expected data of 'X' nor of columns 'a' and 'b', got none" in told["X"]
    assert "expected a file for 'Y', got no such file" in told["Y"]
    found = {loop.tag: record for loop, record in plant.read(plant.loops())}
    assert isinstance(found["FIC101"], ColumnError)
    assert "did you mean 'FIC101.OP'?" in str(found["FIC101"])
    assert isinstance(found["PIC103"], LoopRecord)


def test_a_file_whose_columns_have_other_names(tmp_path):
    put(tmp_path / "data" / "rig.csv", frame(0).rename({"OP": "volt", "PV": "rpm"}))
    (tmp_path / "loops.csv").write_text("tag,op,pv,file,dt,time\nmotor,volt,rpm,rig.csv,2,none\n")
    plant = open_plant(tmp_path / "data", tmp_path / "loops.csv")
    assert not plant.unread()
    ((loop, record),) = plant.read(plant.loops())
    assert (loop.tag, record.dt, len(record)) == ("motor", 2.0, N)
    assert loop.size > 0
    assert loop.stamp


def test_several_files_of_one_loop_by_hand(tmp_path):
    for day in (1, 2):
        put(tmp_path / f"run{day}.csv", frame(day, start=frame(0)["time"][0].replace(day=day)))
    ((_, record),) = open_plant(tmp_path, [PlantLoop("F1", where="run1.csv|run2.csv")]).read(
        open_plant(tmp_path, [PlantLoop("F1", where="run1.csv|run2.csv")]).loops()
    )
    assert (len(record), record.gaps) == (2 * N, (N,))


def test_what_is_no_list():
    given = {"A": LoopRecord([1.0, 2.0], [1.0, 2.0], dt=1.0)}
    with pytest.raises(InputError, match="a path, or PlantLoops"):
        open_plant(given, ["A"])
    plant = open_plant(given, [PlantLoop("A", weight=2.0), PlantLoop("B")])
    assert [loop.weight for loop in plant.loops()] == [2.0]
    assert "the source has A" in plant.unread()[0].why


@pytest.mark.parametrize("source", ["files csv", "wide parquet", "days parquet", "long csv"])
def test_a_proposal_can_be_used_as_it_is(tmp_path, source):
    data, _ = make(source, tmp_path / "data")
    text = propose_text(data)
    (tmp_path / "loops.csv").write_text(text)
    plant = open_plant(data, tmp_path / "loops.csv")
    assert sorted(loop.tag for loop in plant.loops()) == sorted(TAGS)
    for loop, record in plant.read(plant.loops()):
        np.testing.assert_array_equal(record.op, signals(TAGS.index(loop.tag))["OP"])
        assert record.op_span == (0.0, 100.0)
    rows = list(csv.DictReader(io.StringIO(text)))
    assert {row["type"] for row in rows} == {"flow", "level", "pressure"}
    assert all("OP limits 0 .. 100 by the data" in row["remarks"] for row in rows)


def test_what_a_proposal_says(tmp_path):
    put(tmp_path / "FIC1.csv", frame(0).rename({"PV": "PV [bar]"}))
    put(tmp_path / "pump.csv", frame(1).rename({"PV": "PV [bar]"}).with_columns(pl.col("OP") / 100))
    put(tmp_path / "copy.csv", frame(0).with_columns(pl.col("OP").round(1), pl.col("time").dt.offset_by("1d")))
    put(tmp_path / "rig.csv", frame(2).rename({"OP": "volt", "PV": "rpm"}).with_columns(pl.col("volt") - 200.0))
    put(tmp_path / "torn.csv", frame(3).with_columns(pl.lit("?x").alias("OP")))
    found = {loop.tag: loop for loop in propose(open_plant(tmp_path))}
    said = {tag: " ".join(loop.notes) for tag, loop in found.items()}
    assert (found["pump"].op_span, found["pump"].loop_type, found["pump"].pv_unit) == ((0.0, 1.0), "pressure", "bar")
    assert "or 0 .. 100 and nearly closed" in said["pump"]
    assert found["FIC1"].loop_type == "flow"  # the letter, not the unit
    assert (found["rig"].op, found["rig"].pv) == ("volt", "rpm")
    assert "CHECK THEM" in said["rig"]
    assert "CANNOT BE READ" in said["torn"]
    assert parse_loop_list(loop_list_text(found.values())).loops


def test_a_remedy_of_a_proposal_is_in_words_of_the_list_and_works_there(tmp_path):
    put(
        tmp_path / "FIC1.csv",
        frame(0).with_columns(time=pl.Series(np.cumsum(np.random.default_rng(1).integers(1, 400, N)))),
    )
    (loop,) = propose(open_plant(tmp_path))
    said = " ".join(loop.notes)
    assert "dt=<seconds> and time=none to ignore the column (columns of the loop list)" in said
    assert "False" not in said
    text = loop_list_text([replace(loop, dt=1.0, time="none")])
    (tmp_path / "loops.csv").write_text(text)
    source = open_plant(tmp_path, loops=tmp_path / "loops.csv")
    ((_, record),) = source.read(source.loops())
    assert record.dt == 1.0


def test_a_proposal_of_nothing(tmp_path):
    (tmp_path / "README.md").write_text("nothing")
    with pytest.raises(DataError, match="data of at least one loop"):
        propose_text(tmp_path)


def test_the_same_record_under_two_names_is_remarked(tmp_path):
    put(tmp_path / "A.csv", side_by_side().select("time", OP="FIC101.OP", PV="FIC101.PV"))
    put(tmp_path / "B.csv", side_by_side().select("time", OP=pl.col("FIC101.OP").round(4), PV="FIC101.PV"))
    put(tmp_path / "C.csv", side_by_side().select("time", OP="LIC102.OP", PV="LIC102.PV"))
    notes = {loop.tag: " ".join(loop.notes) for loop in propose(open_plant(tmp_path))}
    assert "Begins with the values of A" in notes["B"]
    assert "Begins" not in notes["A"] + notes["C"]


def test_limits_of_pv_that_are_missing_are_remarked(tmp_path):
    put(tmp_path / "A.csv", side_by_side().select("time", OP="FIC101.OP", PV="FIC101.PV"))
    (loop,) = propose(open_plant(tmp_path))
    assert loop.pv_span is None
    assert "fill in pv_low and pv_high, else a noisy measurement is not told" in propose_text(tmp_path)
