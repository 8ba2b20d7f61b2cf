"""What the worker does with files of every sort, without its process: an answer always, in the words of the reader."""

import gzip
import io
import json
import zipfile

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError
from lostmotion.evaluate import random_faulty_loop
from lostmotion.web.desk.desk import Desk
from lostmotion.web.desk.view_json import view_of_json
from lostmotion.web.kept_record import keep_record, kept_record
from lostmotion.web.worker.task import BRIEF, DROPPED, EXPORT, LOOK, RECORD, RESULT, STUDY, ZIP, Task, outcome_of
from lostmotion.web.worker.tasks import do


def read(folder, data, label="FIC-1.csv", **asked):
    path = folder / DROPPED
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    told = []
    said = do(Task("read", str(folder), (str(path),), label, "FIC-1", asked), lambda *news: told.append(news))
    return said, outcome_of(folder, LOOK), outcome_of(folder, RESULT)


def rows(head, count=20):
    return head + "\n" + "\n".join(f"{n},{50 + n % 3},{n % 7}" for n in range(count)) + "\n"


def test_columns_rows_and_roles_are_shown_where_the_reader_is_not_sure(tmp_path):
    _, look, result = read(tmp_path, rows("t,voltage,rpm"))
    assert look["columns"] == ["t", "voltage", "rpm"]
    assert look["rows"][0] == ["0", "50", "0"]
    assert result["error"]["parts"][0] == "a column 'OP'"
    assert result["error"]["ways"] == [{"op": "voltage", "pv": "rpm"}]


def test_the_columns_that_were_chosen_are_read(tmp_path):
    _, look, result = read(tmp_path, rows("t,voltage,rpm"), op="voltage", pv="rpm", dt=1.0)
    assert look["roles"] == {"op": "voltage", "pv": "rpm", "time": "t"}
    assert result["record"].startswith("LoopRecord('FIC-1': 20 samples")
    assert not result["check"]["usable"]
    assert "error" in result
    assert len(kept_record(tmp_path / RECORD)) == 20


def test_errors_name_the_file_as_people_do(tmp_path):
    _, _, result = read(tmp_path, "OP,PV\n1,2\n", label="mine.csv")
    assert DROPPED not in json.dumps(result)
    assert "mine.csv" in result["error"]["text"]


def test_several_loops_are_told(tmp_path):
    said, look, result = read(tmp_path, "t_s,FIC1.PV,FIC1.OUT,FIC2.PV,FIC2.OUT\n0,1,2,3,4\n1,2,3,4,5\n")
    assert said == {"loops": ["FIC1", "FIC2"]} == {"loops": look["loops"]}
    assert result is None


@pytest.mark.parametrize(
    "data", [b"\0" * 1000, b"\x89PNG\r\n", b"PK\x03\x04 broken", b"PAR1 broken", b"\xff\xfe", b"{}"]
)
def test_what_is_no_table_is_said_to_be_none(tmp_path, data):
    _, _, result = read(tmp_path, data)
    assert result["error"]["text"]
    assert result["error"]["type"] != "failure"


def test_a_zip_bomb_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("LOSTMOTION_MOST_GIB", "0.01")
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.csv", b"0" * 20_000_000)
    assert len(stream.getvalue()) < 50_000
    _, _, result = read(tmp_path, stream.getvalue())
    assert "0.01 GiB" in result["error"]["text"]
    _, _, result = read(tmp_path, gzip.compress(b"0" * 20_000_000))
    assert "0.01 GiB" in result["error"]["text"]


def test_a_million_columns_are_refused(tmp_path):
    names = ",".join(f"c{n}" for n in range(1_000_000))
    _, _, result = read(tmp_path, f"{names}\n")
    assert "at most 20000 columns" in result["error"]["text"]
    assert (tmp_path / RESULT).stat().st_size < 5000


def test_many_columns_are_shown_in_part(tmp_path):
    names = ",".join(f"c{n}" for n in range(3000))
    values = ",".join("1" for _ in range(3000))
    _, look, _ = read(tmp_path, f"{names}\n{values}\n{values}\n")
    assert (len(look["columns"]), look["more"]) == (200, 2800)


def test_no_memory_and_a_bug_are_answers_too(tmp_path, monkeypatch):
    def all_of_it(*args, **kwargs):
        raise MemoryError

    monkeypatch.setattr("lostmotion.web.worker.tasks.opened", all_of_it)
    _, _, result = read(tmp_path, "OP,PV\n1,2\n", op="x1")
    assert "LOSTMOTION_MOST_GIB" in result["error"]["text"]

    def bug(*args, **kwargs):
        raise KeyError("x")

    monkeypatch.setattr("lostmotion.web.worker.tasks.opened", bug)
    _, _, result = read(tmp_path, "OP,PV\n1,2\n", op="x2")
    assert result["error"]["text"] == "The worker failed: KeyError: 'x'"


def test_a_record_is_kept_as_it_is(tmp_path):
    record = lm.LoopRecord(
        op=[1.0, np.nan, 3.0], pv=[1.0, 2.0, 3.0], sp=[2.0] * 3, dt=0.5, mode=["AUTO", "", "MAN"], op_span=(0.0, 100.0),
        tag="FIC-1", gaps=(2,), gap_seconds=(7.0,), notes=("n",), start="2026-03-01 06:00", op_unit="%",
    )  # fmt: skip
    keep_record(tmp_path / "record", record)
    again = kept_record(tmp_path / "record")
    assert again.fingerprint == record.fingerprint
    for name in ("dt", "op_span", "pv_span", "tag", "gaps", "gap_seconds", "notes", "start", "op_unit", "made_up"):
        assert getattr(again, name) == getattr(record, name)
    assert again.mode.tolist() == ["AUTO", "", "MAN"]
    assert again.position is None


def test_a_damaged_record_is_an_error(tmp_path):
    keep_record(tmp_path / "record", lm.LoopRecord([1.0, 2.0], [3.0, 4.0], dt=1.0))
    (tmp_path / "record" / "op.npy").write_bytes(b"\x80\x04\x95 no array")
    with pytest.raises(DataError, match="as it was kept"):
        kept_record(tmp_path / "record")
    do(Task("study", str(tmp_path)), lambda *news: None)
    assert "as it was kept" in outcome_of(tmp_path, STUDY)["error"]["text"]


def test_the_worker_itself_answers():
    desk = Desk()
    number, draft = desk.draft()
    draft.write(rows("t,voltage,rpm").encode())
    item = desk.dropped(number, draft, "run.csv")
    assert desk.jobs.wait(desk.jobs.of(item.id).id, 100).state == "done"
    assert item.result["error"]["ways"] == [{"op": "voltage", "pv": "rpm"}]
    assert desk.state(item) == "failed"
    desk.close()


@pytest.mark.statistics
def test_from_a_record_to_the_code_of_its_block(tmp_path):
    loop = lm.evaluate.random_faulty_loop(4, cause="backlash", process="flow")
    table = np.column_stack([np.arange(len(loop.op)), loop.op, loop.pv, loop.sp])
    lines = "\n".join(",".join(f"{value:.6g}" for value in one) for one in table)
    _, _, result = read(tmp_path, f"t_s,OP,PV,SP\n{lines}\n")
    assert result["diagnosis"]["verdict"] == "backlash"
    assert result["fit"]["parameters"]
    assert outcome_of(tmp_path, BRIEF)["words"].startswith("Backlash")
    assert view_of_json(result["view"]).row.verdict == "backlash"
    few = {"runs": 2, "draws": 2}
    do(Task("study", str(tmp_path), given=few), lambda *news: None)
    study = outcome_of(tmp_path, STUDY)
    assert (study["outcome"], study["steps"][-1]["name"]) == ("closed", "simulate")
    do(Task("block", str(tmp_path), given={"to": "st", "name": "FY_1", "date": "2026-01-31"}), lambda *news: None)
    assert "error" in outcome_of(tmp_path, EXPORT)
    do(Task("study", str(tmp_path), given={**few, "accept": "changed in May"}), lambda *news: None)
    assert outcome_of(tmp_path, STUDY)["outcome"] == "block"
    do(Task("block", str(tmp_path), given={"to": "st", "name": "FY_1", "date": "2026-01-31"}), lambda *news: None)
    assert outcome_of(tmp_path, EXPORT)["file"] == "FY_1_st.zip"
    with zipfile.ZipFile(tmp_path / ZIP) as archive:
        assert len(archive.namelist()) == 3
        assert b"changed in May" in archive.read("FY_1/FY_1.st")


@pytest.mark.statistics
def test_the_page_has_the_fingerprint_and_the_numbers_of_the_record(tmp_path):
    made = random_faulty_loop(4, samples=1200, cause="stiction", process="flow")
    signals = zip(made.sp.tolist(), made.pv.tolist(), made.op.tolist(), strict=True)
    text = "\n".join(["t_s,SP,PV,OP", *(f"{k},{sp!r},{pv!r},{op!r}" for k, (sp, pv, op) in enumerate(signals)), ""])
    _, _, result = read(tmp_path, text)
    file = tmp_path / "FIC-1.csv"
    file.write_text(text)
    record = lm.read_loop(file)
    found, view = lm.diagnose(record), view_of_json(result["view"])
    page = result["diagnosis"]
    assert page["fingerprint"] == page["fit"]["data"]["fingerprint"] == view.row.fingerprint == record.fingerprint
    assert page["interval_95"] == page["fit"]["size_interval_95"] == list(found.interval)
    row = view.row
    assert (row.verdict, row.size, row.low, row.high) == (found.verdict, found.size, *found.interval)
