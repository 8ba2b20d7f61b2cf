"""Routes of dropped files, without a server: uploads, forms, states, downloads; the worker is a program of the test."""

import asyncio
import json
import re

import httpx
import numpy as np
import pytest

from lostmotion.audit.plant_view import LoopView
from lostmotion.plant import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import UNDATED, AssessmentRow, Stage
from lostmotion.web.app import create_app
from lostmotion.web.desk.desk import Desk, Limits
from lostmotion.web.desk.upload import AROUND
from lostmotion.web.desk.view_json import view_to_json
from lostmotion.web.kept_record import keep_record
from lostmotion.web.page import Page
from lostmotion.web.worker import handle as worker_module
from tests.support.patience import until

SCRIPT = """
import json, pathlib, sys, time
from lostmotion.workers.child import Channel
channel = Channel()
def say(**news):
    channel.send(json.dumps(news).encode())
while True:
    task = json.loads(channel.receive())
    folder = pathlib.Path(task["folder"])
    data = pathlib.Path(task["sources"][0]).read_bytes()
    say(phase="diagnosing", share=0.5, said="window 1 of 2")
    if data.startswith(b"slow"):
        time.sleep(60)
    (folder / (task["kind"] + ".task")).write_text(json.dumps(task))
    if data.startswith(b"{"):
        (folder / "look.json").write_text(json.dumps(json.loads(data)["look"]))
        (folder / "result.json").write_text(json.dumps(json.loads(data)["result"]))
    say(ended=True)
"""
EVIL = "<script>alert(1)</script>"
LOOK = {
    "columns": ["t", EVIL, '"><img src=x>'], "rows": [["0", "1", EVIL]], "roles": {"time": "t"}, "more": 0, "loops": [],
}  # fmt: skip
ERROR = {
    "text": f"expected a column 'OP', got {EVIL}; name it with op='<column>'",
    "parts": ["a column 'OP'", EVIL, "name it with op='<column>'"],
    "ways": [{"op": EVIL, "pv": "t"}, {"dt": 30.0, "time": False}],
    "type": "ColumnError",
}
ROW = AssessmentRow(
    "FIC-1", UNDATED, UNDATED, stage=Stage.ASSESSED, verdict="backlash", kind="actuator", size=2.0, low=1.5, high=2.5,
    size_percent=2.0, confidence=0.97, advice=("mend it",), evidence=(("sticking", 1.0, 2.0),), status="OK",
)  # fmt: skip
RESULT = {
    "record": "r", "tag": "FIC-1", "summary": "s",
    "check": {"usable": True, "said": "100 % of 20 rows are used.", "findings": [], "notes": [EVIL]},
    "view": view_to_json(LoopView(PlantLoop("FIC-1"), ROW, None)),
    "diagnosis": {"verdict": "backlash", "fit": {"status": "OK"}},
    "fit": {
        "status": "OK", "said": ["found"], "parameters": [["width", "2", "0.1", "1.5 .. 2.5", "m"]], "summary": "s",
    },
}  # fmt: skip
STUDY = {
    "asked": {"kp": 1.0}, "outcome": "closed", "said": "NO BLOCK", "verdict": "backlash", "block": None, "study": None,
    "steps": [{"name": "simulate", "passed": False, "said": EVIL, "remedy": "retune", "settings": {"retune": True},
               "acceptable": True}],
}  # fmt: skip


@pytest.fixture(autouse=True)
def small_worker(monkeypatch):
    monkeypatch.setattr(worker_module, "WORKER", ("-c", SCRIPT))


@pytest.fixture
def desk():
    made = Desk(limits=Limits(file_bytes=100_000))
    yield made
    made.close()


def ask(desk, method, path, read_only=False, **options):
    async def asked():
        transport = httpx.ASGITransport(create_app(Page(desk=desk, read_only=read_only)))
        async with httpx.AsyncClient(transport=transport, base_url="http://page") as client:
            return await client.request(method, path, **options)

    return asyncio.run(asked())


def drop(desk, content=b"OP,PV\n1,2\n", name="FIC-1.csv"):
    return ask(desk, "POST", "/files", files={"file": (name, content)})


def dropped(desk, content=b"OP,PV\n1,2\n", name="FIC-1.csv"):
    item = desk.item(drop(desk, content, name).headers["location"].rpartition("/")[2])
    if not content.startswith(b"slow"):
        desk.jobs.wait(desk.jobs.of(item.id).id, 10)
    return item


def made(desk, result, look=LOOK, name="FIC-1.csv"):
    return dropped(desk, json.dumps({"look": look, "result": result}).encode(), name)


def test_a_file_is_dropped_and_has_an_address(desk):
    answer = drop(desk, b"x" * 5000)
    assert answer.status_code == 303
    assert re.fullmatch("/files/[0-9a-f]{16}", answer.headers["location"])
    item = desk.items()[0]
    assert (item.folder / "dropped-file").read_bytes() == b"x" * 5000
    page = ask(desk, "GET", answer.headers["location"])
    assert page.status_code == 200
    assert "FIC-1.csv" in page.text


def test_script_asks_for_json(desk):
    answer = ask(desk, "POST", "/files", files={"file": ("a.csv", b"x")}, headers={"accept": "application/json"})
    assert answer.status_code == 201
    assert answer.json()["url"] == f"/files/{answer.json()['files'][0]}"


def test_several_files_come_together(desk):
    files = [("file", (f"{n}.csv", b"x" * n)) for n in (1, 2, 3)]
    assert ask(desk, "POST", "/files", files=files).headers["location"] == "/files"
    assert sorted(item.label for item in desk.items()) == ["1.csv", "2.csv", "3.csv"]


def test_too_much_is_refused_by_its_length_before_it_comes(desk):
    came = []

    async def pieces():
        came.append(1)
        yield b"x"

    length = {"content-length": str(200_000 + AROUND), "content-type": "multipart/form-data; boundary=b"}
    answer = ask(desk, "POST", "/files", content=pieces(), headers=length)
    assert answer.status_code == 413
    assert "at most 0.1 MB" in answer.text
    assert desk.items() == []


def test_too_much_is_refused_while_it_comes(desk):
    async def pieces():
        yield b'--b\r\ncontent-disposition: form-data; name="file"; filename="a.csv"\r\n\r\n'
        for _ in range(300):
            yield b"x" * 1000

    answer = ask(desk, "POST", "/files", content=pieces(), headers={"content-type": "multipart/form-data; boundary=b"})
    assert answer.status_code == 413
    assert [path.name for path in desk.records.iterdir() if path.is_dir()] == []


@pytest.mark.parametrize(
    ("kind", "body"),
    [
        ("multipart/form-data; boundary=b", b"--b\r\nno head"),
        (
            "multipart/form-data; boundary=b",
            b'--b\r\ncontent-disposition: form-data; name="file"; filename="a"\r\n\r\nhalf',
        ),
        ("multipart/form-data; boundary=b", b"--b\r\n" + b"x" * 9000 + b": y\r\n\r\n\r\n--b--\r\n"),
        (
            "multipart/form-data; boundary=b",
            b'--b\r\ncontent-disposition: form-data; name="x"\r\n\r\n1\r\n' * 60 + b"--b--",
        ),
        ("multipart/form-data; boundary=b", b"--b--\r\n"),
        ("multipart/form-data", b"x"),
        ("text/csv", b"OP,PV"),
        ("multipart/form-data; boundary=" + "b" * 5000, b"x"),
    ],
)
def test_what_is_no_form_is_refused_and_leaves_nothing(desk, kind, body):
    answer = ask(desk, "POST", "/files", content=body, headers={"content-type": kind})
    assert answer.status_code == 400
    assert [path.name for path in desk.records.iterdir() if path.is_dir()] == []


@pytest.mark.parametrize("name", ["../../x.csv", "/etc/passwd", "..", "%2e%2e%2fx"])
def test_names_lead_nowhere(desk, name):
    item = dropped(desk, name=name)
    assert item.folder.parent == desk.records
    assert not (desk.records.parent / "x.csv").exists()


@pytest.mark.parametrize(
    "path", ["/files/../../etc/passwd", "/files/%2e%2e", "/files/..%2f..%2fetc%2fpasswd", "/files/0000000000000000",
             "/files/%00", "/api/v1/files/x", "/files/x/report.html", "/static/../app.py", "/static/%2e%2e/app.py"]
)  # fmt: skip
def test_paths_lead_nowhere(desk, path):
    assert ask(desk, "GET", path).status_code == 404


def test_script_in_names_is_text(desk):
    item = made(desk, {"error": ERROR}, name=EVIL + ".csv")
    for path in ("/files", f"/files/{item.id}", f"/files/{item.id}/columns"):
        text = ask(desk, "GET", path).text
        assert "<script>alert" not in text
        assert "<img" not in text
        assert "&lt;" in text


def test_no_page_has_script_or_style_of_its_own(desk):
    """What the CSP would not run."""
    failed, done = made(desk, {"error": ERROR}), made(desk, RESULT)
    keep_record(done.folder / "record", LoopRecord(np.arange(50.0) % 7, np.arange(50.0) % 5, dt=1.0))
    (done.folder / "study.json").write_text(json.dumps(STUDY))
    for path in ("/files", f"/files/{failed.id}", f"/files/{done.id}"):
        text = ask(desk, "GET", path).text
        assert not re.search(r"<script(?![^>]*\bsrc=\"/static/)", text)
        assert not re.search(r"<style|\sstyle=|\son\w+=\"|javascript:", text)
        assert not re.search(r"(?:src|href)=\"(?:https?:)?//", text)


def test_an_error_is_said_with_its_ways_out_as_buttons(desk):
    item = made(desk, {"error": ERROR})
    text = ask(desk, "GET", f"/files/{item.id}").text
    assert "name it with “OP, output of the controller”" in text
    assert "Sampling time, s: 30; Time: not read" in text
    assert ask(desk, "POST", f"/files/{item.id}/way", data={"way": "1"}).status_code == 303
    assert desk.item(item.id).asked == {"dt": 30.0, "time": False}
    assert ask(desk, "POST", f"/files/{item.id}/way", data={"way": "7"}).status_code == 404


@pytest.mark.parametrize("columns", [[], ["Dear colleague"]])
def test_what_is_no_table_gets_a_sentence_and_no_form(desk, columns):
    error = {"text": "expected a header, got 'Dear colleague'", "parts": [], "ways": [], "type": "DataError"}
    look = {**LOOK, "columns": columns, "rows": [], "roles": {}}
    item = made(desk, {"error": error}, look, "letter.csv")
    page = ask(desk, "GET", f"/files/{item.id}").text
    assert "No columns were found in the file" in page
    assert f"/files/{item.id}/columns" not in page
    assert f"/files/{item.id}/remove" in page
    assert "<select" not in ask(desk, "GET", f"/files/{item.id}/columns").text


def test_columns_are_corrected(desk):
    item = made(desk, {"error": ERROR})
    form = {
        "op": f"={EVIL}",
        "pv": "=t",
        "sp": "none",
        "dt": "2,5",
        "op_low": "0",
        "op_high": "100",
        "automatic": "1, 3",
    }
    assert ask(desk, "POST", f"/files/{item.id}/columns", data=form).status_code == 303
    desk.jobs.wait(desk.jobs.of(item.id).id, 10)
    task = json.loads((item.folder / "read.task").read_text())
    assert task["asked"] == {
        "op": EVIL, "pv": "t", "sp": False, "dt": 2.5, "op_span": [0.0, 100.0], "automatic": ["1", "3"],
    }  # fmt: skip
    assert ask(desk, "POST", f"/files/{item.id}/columns", data={"dt": "often"}).status_code == 400


def test_work_is_shown_refreshes_itself_and_is_cancelled(desk):
    item = dropped(desk, b"slow")
    until(lambda: desk.jobs.of(item.id).phase == "diagnosing")
    text = ask(desk, "GET", f"/files/{item.id}").text
    assert "window 1 of 2" in text
    assert '<noscript><meta http-equiv="refresh"' in text
    state = ask(desk, "GET", f"/api/v1/files/{item.id}").json()
    assert (state["state"], state["job"]["phase"], state["job"]["share"]) == ("running", "diagnosing", 0.5)
    assert ask(desk, "POST", f"/jobs/{state['job']['id']}/cancel").status_code == 303
    assert "was cancelled" in ask(desk, "GET", f"/files/{item.id}").text
    assert ask(desk, "GET", f"/api/v1/files/{item.id}").json()["state"] == "new"
    assert ask(desk, "POST", "/jobs/x/cancel").status_code == 404


def test_a_verdict_has_its_page_and_its_files(desk):
    item = made(desk, RESULT)
    text = ask(desk, "GET", f"/files/{item.id}").text
    assert "Backlash, 2" in text
    assert "mend it" in text
    assert "1.5 .. 2.5" in text
    report = ask(desk, "GET", f"/files/{item.id}/report.html")
    assert report.headers["content-disposition"] == 'attachment; filename="FIC-1.html"'
    assert report.text.startswith("<!doctype html>")
    assert ask(desk, "GET", f"/files/{item.id}/diagnosis.json").json()["verdict"] == "backlash"
    assert ask(desk, "GET", f"/files/{item.id}/fit.json").json() == {"status": "OK"}
    assert ask(desk, "GET", f"/files/{item.id}/block.zip").status_code == 404
    assert ask(desk, "GET", "/api/v1/files").json()[0]["verdict"] == "backlash"


def test_no_block_past_a_closed_gate(desk):
    item = made(desk, RESULT)
    assert ask(desk, "POST", f"/files/{item.id}/block", data={"to": "st", "name": "FY_1"}).status_code == 404
    (item.folder / "study.json").write_text(json.dumps(STUDY))
    text = ask(desk, "GET", f"/files/{item.id}").text
    assert "CLOSED" in text
    assert "Write the block" not in text
    assert "Go on with Retune: yes" in text
    assert (
        ask(desk, "POST", f"/files/{item.id}/study", data={"accept": "changed in May", "ki": "0.5"}).status_code == 303
    )
    desk.jobs.wait(desk.jobs.of(item.id).id, 10)
    given = json.loads((item.folder / "study.task").read_text())["given"]
    assert given == {"kp": 1.0, "ki": 0.5, "accept": "changed in May"}


def test_a_gate_is_opened_by_what_the_study_says(desk):
    item = made(desk, RESULT)
    (item.folder / "study.json").write_text(json.dumps(STUDY))
    ask(desk, "POST", f"/files/{item.id}/study", data={"use": "1"})
    desk.jobs.wait(desk.jobs.of(item.id).id, 10)
    assert json.loads((item.folder / "study.task").read_text())["given"] == {"kp": 1.0, "retune": True}


def test_a_file_is_taken_off_the_desk(desk):
    item = dropped(desk)
    assert ask(desk, "POST", f"/files/{item.id}/remove").headers["location"] == "/files"
    assert not item.folder.exists()
    assert ask(desk, "GET", f"/files/{item.id}").status_code == 404


def test_a_read_only_page_has_no_forms(desk):
    item = made(desk, RESULT)
    for path in ("/files", f"/files/{item.id}"):
        assert "<form" not in ask(desk, "GET", path, read_only=True).text


def test_a_large_form_is_refused(desk):
    item = dropped(desk)
    body = b"op=" + b"x" * 100_000
    assert ask(desk, "POST", f"/files/{item.id}/columns", content=body).status_code == 413


def test_files_are_no_part_of_a_page_without_a_desk():
    assert ask(None, "GET", "/files").status_code == 404
