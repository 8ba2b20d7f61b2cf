"""A person's request on its way to the process that writes: taken once, for this start, soon, or not at all."""

import json
import time

import pytest

from lostmotion.errors import DataError, FileAccessError, GateError
from lostmotion.live.supervision.handed_over import OLDEST, Inbox, Outbox

FIT = {"model": {"kind": "dead zone"}}


@pytest.fixture
def door(tmp_path):
    folder = tmp_path / "door"
    folder.mkdir(mode=0o700)
    return folder


def test_a_request_is_taken_once(door):
    inbox = Inbox(door, ["FIC/1", "B"])
    with inbox.open() as left:
        assert left == []
        out = Outbox(door, "FIC/1")
        out.hand_over("anna", FIT)
        with pytest.raises(FileAccessError):  # one at a time
            Outbox(door, "FIC/1").hand_over("bert", FIT)
        assert inbox.take("B") is None
        asked = inbox.take("FIC/1")
        assert (asked.fit, asked.word, asked.why) == (FIT, out.word, "")
        assert asked.who.startswith("anna (")
        assert inbox.take("FIC/1") is None
        assert not out.withdraw()
        with pytest.raises(GateError, match="write = true"):
            Outbox(door, "C")
    assert list(door.iterdir()) == []
    with pytest.raises(GateError, match="at work"):
        Outbox(door, "B")


def test_what_is_withdrawn_is_not_taken(door):
    inbox = Inbox(door, ["A"])
    with inbox.open():
        out = Outbox(door, "A")
        out.hand_over("anna", FIT)
        assert out.withdraw()
        assert inbox.take("A") is None


def test_a_request_for_an_earlier_start_is_thrown_away(door):
    with Inbox(door, ["A"]).open():
        early, late = Outbox(door, "A"), Outbox(door, "A")
        early.hand_over("anna", FIT)
    again = Inbox(door, ["A"])
    with again.open() as left:
        assert left == ["A.request"]
        assert again.take("A") is None
        late.hand_over("anna", FIT)  # it has read the word of the start before
        assert "for this start" in again.take("A").why


@pytest.mark.parametrize("age", [OLDEST + 5.0, -OLDEST - 5.0])
def test_an_old_request_is_not_taken(door, age):
    inbox = Inbox(door, ["A"])
    with inbox.open():
        out = Outbox(door, "A")
        out.hand_over("anna", FIT)
        path = door / "A.request"
        said = json.loads(path.read_text())
        path.write_text(json.dumps({**said, "made": time.time() - age}))
        assert "not older than" in inbox.take("A").why


@pytest.mark.parametrize("text", ["", "{", '{"session": 1}', "[1]", '{"a": NaN}'])
def test_what_is_no_request_is_gone_and_told(door, text):
    inbox = Inbox(door, ["A"])
    with inbox.open():
        (door / "A.request").write_text(text)
        with pytest.raises(DataError):
            inbox.take("A")
        assert inbox.take("A") is None


def test_a_link_is_not_followed(door, tmp_path):
    (tmp_path / "elsewhere").write_text("{}")
    inbox = Inbox(door, ["A"])
    with inbox.open():
        (door / "A.request").symlink_to(tmp_path / "elsewhere")
        with pytest.raises(DataError):
            inbox.take("A")


def test_the_door_is_not_open_to_everybody(door, tmp_path):
    door.chmod(0o777)
    with pytest.raises(FileAccessError, match="not everybody"):
        Inbox(door, ["A"])
    with pytest.raises(FileAccessError, match="make it"):
        Inbox(tmp_path / "none", ["A"])
    (tmp_path / "file").write_text("")
    with pytest.raises(FileAccessError, match="which is none"):
        Inbox(tmp_path / "file", ["A"])
