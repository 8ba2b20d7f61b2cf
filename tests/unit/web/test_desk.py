"""The desk of the page: its folder, its limits, what stays and what goes; the worker is a small program of the test."""

import json
import os
import signal
import stat
import time

import pytest

from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.files.writer import lock_file
from lostmotion.web.desk.desk import AT_ONCE, Desk, Limits
from lostmotion.web.desk.workspace import LOCK, PREFIX, STALE, sweep
from lostmotion.web.worker import handle as worker_module
from tests.support.patience import until

SCRIPT = """
import json, os, pathlib, sys, time
from lostmotion.workers.child import Channel
channel = Channel()
def say(**news):
    channel.send(json.dumps(news).encode())
while True:
    task = json.loads(channel.receive())
    asked, folder = task["asked"], pathlib.Path(task["folder"])
    data = pathlib.Path(task["sources"][0]).read_text()
    if data.startswith("slow"):
        say(phase="reading", share=0.5, said="")
        time.sleep(60)
    loops = data.split()[1:] if data.startswith("loops") and "loop" not in asked else []
    if loops:
        look = {"columns": [], "rows": [], "roles": {}, "more": 0, "loops": loops}
        (folder / "look.json").write_text(json.dumps(look))
    else:
        (folder / "result.json").write_text(json.dumps({"asked": asked, "tag": task["tag"], "label": task["label"]}))
    say(ended=True, **({"loops": loops} if loops else {}))
"""


@pytest.fixture(autouse=True)
def small_worker(monkeypatch):
    monkeypatch.setattr(worker_module, "WORKER", ("-c", SCRIPT))


@pytest.fixture
def desk():
    made = Desk()
    yield made
    made.close()


def drop(desk, content=b"OP,PV", label="a.csv"):
    number, draft = desk.draft()
    draft.write(content)
    return desk.dropped(number, draft, label)


def over(desk, item):
    return desk.jobs.wait(desk.jobs.of(item.id).id, 10)


def test_the_folder_is_for_its_owner_and_goes_at_the_end():
    desk = Desk()
    item = drop(desk)
    assert stat.S_IMODE(desk.records.stat().st_mode) == stat.S_IMODE(item.folder.stat().st_mode) == 0o700
    over(desk, item)
    desk.close()
    assert not desk.records.exists()


def test_a_dropped_file_is_read_at_once(desk):
    item = drop(desk, label="FIC-1.csv.gz")
    assert over(desk, item).state == "done"
    assert item.result == {"asked": {}, "tag": "FIC-1", "label": "FIC-1.csv.gz"}
    assert desk.state(item) == "done"
    assert [one.id for one in desk.items()] == [item.id]


@pytest.mark.parametrize(
    "label", ["../../../etc/passwd", "..", "/etc/passwd", "C:\\x\\y.csv", "a\0b", "\n", "x" * 5000]
)
def test_a_name_from_outside_is_no_path(desk, label):
    item = drop(desk, label=label)
    assert item.folder.parent == desk.records
    assert sorted(path.name for path in item.folder.iterdir() if path.name != "result.json") == [
        "about.json",
        "dropped-file",
    ]
    assert "/" not in item.label
    assert item.label.isprintable()
    assert 0 < len(item.label) <= 120
    assert item.sources == (str(item.folder / "dropped-file"),)


def test_an_id_is_looked_up_and_never_a_path(desk):
    assert [desk.item(number) for number in ("..", "../x", "", "/etc/passwd", "\0")] == [None] * 5


def test_several_loops_become_items_of_their_own(desk):
    item = drop(desk, f"loops {' '.join(f'F{n}' for n in range(AT_ONCE + 2))}".encode())
    over(desk, item)
    loops = desk.loops(item)
    assert [one.loop for one in loops[:2]] == ["F0", "F1"]
    assert desk.state(item) == "several"
    over(desk, loops[AT_ONCE - 1])
    assert [desk.state(one) for one in loops[-3:]] == ["done", "new", "new"]
    assert loops[0].result["asked"] == {"loop": "F0"}
    assert [one.id for one in desk.items()] == [item.id]
    desk.remove(item)
    assert not any(one.folder.exists() for one in (item, *loops))


def test_other_settings_are_another_result(desk):
    item = drop(desk)
    over(desk, item)
    (item.folder / "study.json").write_text("{}")
    (item.folder / "record").mkdir()
    job = desk.change(item, {"op": "CO", "dt": 2.0})
    assert desk.jobs.wait(job.id, 10).state == "done"
    again = desk.item(item.id)
    assert again.result["asked"] == {"op": "CO", "dt": 2.0}
    assert again.study is None
    assert again.record_path is None
    assert (item.folder / "dropped-file").exists()


def test_what_is_cancelled_leaves_no_trace(desk):
    item = drop(desk, b"slow")
    desk.jobs.cancel_of({item.id})
    after = drop(desk)
    over(desk, after)
    assert desk.state(after) == "done"
    assert (desk.state(item), item.result) == ("new", None)


def test_a_killed_worker_is_the_result_of_its_file(desk):
    item = drop(desk, b"slow")
    until(lambda: desk.jobs.of(item.id).share == 0.5)
    os.kill(desk.jobs.worker, signal.SIGKILL)
    over(desk, item)
    assert desk.state(item) == "failed"
    assert "SIGKILL" in item.result["error"]["text"]


def test_a_file_that_is_too_large_is_refused_while_it_comes():
    desk = Desk(limits=Limits(file_bytes=10))
    _, draft = desk.draft()
    draft.write(b"12345")
    with pytest.raises(ParameterError, match="at most"):
        draft.write(b"678901")
    draft.drop()
    assert not draft.folder.exists()
    assert desk.items() == []
    desk.close()


def test_an_empty_file_is_refused(desk):
    number, draft = desk.draft()
    with pytest.raises(ParameterError, match="empty"):
        desk.dropped(number, draft, "a.csv")
    assert not draft.folder.exists()


def test_the_oldest_goes_when_there_are_too_many():
    desk = Desk(limits=Limits(files=3))
    made = [drop(desk, label=f"{n}.csv") for n in range(5)]
    assert [item.label for item in desk.items()] == ["4.csv", "3.csv", "2.csv"]
    assert [item.folder.exists() for item in made] == [False, False, True, True, True]
    desk.close()


def test_the_oldest_goes_when_there_is_too_much():
    desk = Desk(limits=Limits(file_bytes=1000, all_bytes=4000))
    made = [drop(desk, b"x" * 900, f"{n}.csv") for n in range(6)]
    there = [item for item in made if item.folder.exists()]
    assert there == made[-len(there) :]
    assert 2 <= len(there) <= 4
    desk.close()


def test_a_kept_folder_is_there_again(tmp_path):
    first = Desk(tmp_path / "kept")
    item = drop(first, label="FIC-1.csv")
    over(first, item)
    first.close()
    second = Desk(tmp_path / "kept")
    again = second.item(item.id)
    assert (again.label, again.result, second.state(again)) == ("FIC-1.csv", item.result, "done")
    second.close()


def test_a_kept_folder_belongs_to_one_page(tmp_path):
    first = Desk(tmp_path)
    with pytest.raises(FileAccessError, match="another one"):
        Desk(tmp_path)
    first.close()
    Desk(tmp_path).close()


def test_damaged_and_foreign_folders_are_passed_over(tmp_path):
    for name, text in (("0" * 16, "no JSON"), ("1" * 16, "[]"), ("2" * 16, '{"sources": 3}'), ("hers", "{}")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "about.json").write_text(text)
    desk = Desk(tmp_path)
    assert desk.items() == []
    desk.close()
    assert (tmp_path / "hers").is_dir()


def test_files_are_opened_where_they_are(tmp_path):
    path = tmp_path / "FIC-1.csv"
    path.write_text("OP,PV\n1,2\n")
    desk = Desk(files=[str(path)])
    (item,) = desk.items()
    over(desk, item)
    assert (item.label, item.sources, item.dropped) == ("FIC-1.csv", (str(path),), False)
    desk.remove(item)
    desk.close()
    assert path.exists()


def test_the_same_loop_is_opened_once_and_not_for_ever(tmp_path):
    paths = [tmp_path / f"{n}.csv" for n in range(4)]
    for path in paths:
        path.write_text("OP,PV")
    desk = Desk(files=[str(paths[0])], limits=Limits(files=2))
    asked = {"op": "CO", "op_span": (0.0, 100.0), "time": "none"}
    made = [desk.open([str(path)], "FIC-1", asked) for path in (paths[1], paths[1], *paths[1:])]
    assert made[0].id == made[1].id == made[2].id
    assert made[0].asked["time"] is False
    assert len(desk.items()) == 3
    assert desk.item(made[0].id) is None
    desk.close()


def test_files_of_one_tag_each_are_one_record(tmp_path):
    for role, values in (("OP", (1, 2)), ("PV", (3, 4))):
        rows = "\n".join(f"2026-01-01 00:00:0{n},{value}" for n, value in enumerate(values))
        (tmp_path / f"FIC1_{role}.csv").write_text(f"timestamp,value\n{rows}\n")
    desk = Desk(files=[str(tmp_path)])
    (item,) = desk.items()
    assert len(item.sources) == 2
    desk.close()


def test_a_missing_file_is_an_error_and_leaves_nothing(tmp_path):
    with pytest.raises(FileAccessError, match="not there"):
        Desk(tmp_path / "kept", [str(tmp_path / "none.csv")])
    assert not (tmp_path / "kept").exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_made_is_an_error(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(FileAccessError, match="keep files"):
        Desk(tmp_path / "kept")


def test_what_is_kept_is_json(desk):
    item = drop(desk)
    assert json.loads((item.folder / "about.json").read_text())["label"] == "a.csv"


def test_what_a_killed_page_has_left_goes_but_nothing_else(tmp_path):
    old = time.time() - 2 * STALE
    for name in (f"{PREFIX}old", f"{PREFIX}locked", f"{PREFIX}new", "other"):
        (tmp_path / name / "0123456789abcdef").mkdir(parents=True)
    lock = lock_file(tmp_path / f"{PREFIX}locked" / LOCK)
    (tmp_path / f"{PREFIX}link").symlink_to(tmp_path / "other")
    for name in (f"{PREFIX}old", f"{PREFIX}locked", "other"):
        os.utime(tmp_path / name, (old, old))
    sweep(tmp_path)
    lock.close()
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == [f"{PREFIX}{name}" for name in ("link", "locked", "new")] + ["other"]
    assert (tmp_path / "other" / "0123456789abcdef").is_dir()
