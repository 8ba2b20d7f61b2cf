"""One block and its thread: what it asks after a study, whom it answers, how it ends. The PLC is in this process."""

import threading
import time
from types import SimpleNamespace

import pytest

import lostmotion as lm
from lostmotion.errors import DataError, GateError
from lostmotion.live.audit_log import read_log
from lostmotion.live.link import LinkError
from lostmotion.live.supervision import writer as module
from lostmotion.live.supervision.handed_over import Asked
from lostmotion.live.supervision.said import ToldLog
from lostmotion.live.supervision.settings import BlockSettings
from lostmotion.live.supervision.studies import Running
from lostmotion.live.supervision.writer import BlockWriter
from lostmotion.live.virtual_plc import VirtualPlc
from tests.support.supervised import supervised


class AtOnce:
    """In place of a study in another process: done, with what `answers` says."""

    answers = None
    done = True

    def __init__(self, work, *given):
        self.given = given

    def result(self):
        answer = AtOnce.answers(*self.given)
        if isinstance(answer, Exception):
            raise answer
        return answer

    def close(self):
        pass


class Rig:
    """PLC that scans in a thread, and a writer whose messages are kept."""

    def __init__(self, folder, monkeypatch, **settings):
        monkeypatch.setattr(module, "Running", AtOnce)
        AtOnce.answers = lambda *given: self.study()
        self.block = supervised("dead zone", timeout=200, least_scans=1, accept_scans=9000)
        self.plc = VirtualPlc(self.block)
        for name in ("enable", "auto_mode", "cascade"):
            self.plc.set(name, 1.0)
        self.lines, self.asks, self.writes = [], [], []
        self.plc_write, self.plc.write = self.plc.write, self._write
        self.log = ToldLog(folder / "log", {"TY1": "TIC1"}, self.lines.append)
        known = {"write": True, "least_interval": 0.01, **settings}
        chosen = BlockSettings("TIC1", "TY1", self.block, {}, lm.PI(1.0, 0.1), **known)
        self.writer = BlockWriter(chosen, lambda: self.plc, self.log, self.lines.append, self)
        self._stop = threading.Event()
        self._scans = threading.Thread(target=self._scan)
        self._scans.start()
        self.writer.period = 0.1
        self.writer.start()

    def _write(self, values):
        self.writes.append(dict(values))
        self.plc_write(values)

    def _scan(self):
        while not self._stop.wait(0.02):
            self.plc.scan(50.0)

    def take(self, tag):
        """As an Inbox: what a person asks."""
        answer = self.asks.pop(0) if self.asks else None
        if isinstance(answer, Exception):
            raise answer
        return answer

    def study(self, safe=True, **changes):
        settings = self.block.block.settings
        first = {"left_break": settings["left_break"] + changes.get("more", 0.001)}
        tried = self.block.block.with_settings(**first)
        return SimpleNamespace(safe=safe, recommendation="compensate", block=tried, described="a test")

    def until(self, what, seconds=20.0):
        end = time.monotonic() + seconds
        while not what():
            assert time.monotonic() < end, [line["message"] for line in self.lines]
            time.sleep(0.01)

    def events(self):
        return [line["event"] for line in self.lines if line["kind"] == "request"]

    def close(self):
        self.writer.end()
        self.writer.wait()
        self._stop.set()
        self._scans.join()


@pytest.fixture
def rig(tmp_path, monkeypatch):
    made = Rig(tmp_path, monkeypatch)
    yield made
    made.close()


def test_a_person_asks_and_the_operator_accepts(rig):
    rig.asks.append(Asked("TIC1", "anna (root)", "w1", {}))
    rig.until(lambda: "verify" in rig.events())
    assert rig.plc.read(["supervision"])["supervision"] == 1.0
    rig.plc.set("accept", 1.0)
    rig.until(lambda: "accept" in rig.events())
    assert rig.plc.read(["supervision"])["supervision"] == 3.0
    rig.close()
    assert rig.events() == ["begin", "asked", "request", "verify", "accept", "end"]
    lines = read_log(rig.log.path)
    assert [line["event"] for line in lines] == rig.events()
    assert {line["who"] for line in lines[1:5]} == {"anna (root)"}
    assert lines[1]["ask"] == "w1"
    blocks = [line["block"] for line in rig.lines if line["kind"] == "block"]
    assert blocks[0] == "passive"
    assert "active" in blocks


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (lambda rig: rig.study(safe=False), "not safe"),
        (lambda rig: GateError.expected("a study", "a process that died", "nothing is asked"), "died"),
        (lambda rig: DataError.expected("a fit", "none", "give one"), "expected a fit"),
    ],
)
def test_what_no_study_has_passed_is_not_asked(rig, answer, said):
    AtOnce.answers = lambda *given: answer(rig)
    rig.asks.append(Asked("TIC1", "anna", "w1", {}))
    rig.until(lambda: "not asked" in rig.events())
    last = [line for line in rig.lines if line.get("event") == "not asked"][-1]
    assert said in last["answer"]
    assert last["who"] == "anna"
    assert all(set(values) == {"heartbeat"} for values in rig.writes)


def test_one_request_at_a_time_nothing_is_queued(rig):
    rig.asks += [Asked("TIC1", "anna", "w1", {}), Asked("TIC1", "bert", "w2", {})]
    rig.until(lambda: "not asked" in rig.events())
    rig.until(lambda: "verify" in rig.events())
    last = next(line for line in rig.lines if line.get("event") == "not asked")
    assert (last["who"], last["ask"]) == ("bert", "w2")
    assert "nothing is queued" in last["answer"]
    assert sum("request_id" in values for values in rig.writes) == 1


def test_what_cannot_be_asked_is_told(rig):
    rig.asks += [DataError.expected("a request", "nonsense", "ask anew"), Asked("TIC1", "anna", "w", {}, "too old")]
    rig.until(lambda: rig.events().count("not asked") == 2)
    assert not any("request_id" in values for values in rig.writes)


def test_a_log_that_cannot_be_written_ends_the_heartbeat(rig, tmp_path):
    rig.until(lambda: len(rig.writes) > 2)
    rig.log.path.unlink()
    rig.log.path.symlink_to(tmp_path / "elsewhere")
    rig.asks.append(Asked("TIC1", "anna", "w1", {}))
    rig.until(lambda: rig.writer.failed)
    rig.writer.wait()
    written = len(rig.writes)
    time.sleep(0.3)
    assert len(rig.writes) == written
    assert not any("request_id" in values for values in rig.writes)
    assert rig.lines[-1]["kind"] == "failed"


def test_a_link_that_fails_is_told_once_and_nothing_is_sent_again(rig, monkeypatch):
    rig.until(lambda: "begin" in rig.events())

    def broken(values):
        rig.writes.append(dict(values))
        raise LinkError("expected an answer, got none; in a test")

    monkeypatch.setattr(rig.plc, "write", broken)
    rig.asks.append(Asked("TIC1", "anna", "w1", {}))
    rig.until(lambda: sum(line["kind"] == "lost" for line in rig.lines) == 1)
    time.sleep(0.5)
    assert sum(line["kind"] == "lost" for line in rig.lines) == 1
    assert sum("request_id" in values for values in rig.writes) == 0
    assert not rig.writer.failed


def test_estimates_are_looked_at_one_by_one_not_more_often_than_said(tmp_path, monkeypatch):
    rig = Rig(tmp_path, monkeypatch, adaptive=True, least_interval=0.5, who="the estimate")
    try:
        left, right = (rig.block.block.settings[name] for name in ("left_break", "right_break"))
        found = SimpleNamespace(
            status=lm.Status.OK, parameters={"left": left - 0.05, "right": right},
            standard_errors={"left": 0.001, "right": 0.001},
        )  # fmt: skip
        AtOnce.answers = lambda *given: rig.study(safe=False)
        begun = time.monotonic()
        rig.until(lambda: rig.writer.heard(found) or "not asked" in rig.events())
        assert time.monotonic() - begun > 0.4  # not before least_interval after the start
        end = time.monotonic() + 0.3
        while time.monotonic() < end:
            rig.writer.heard(found)
            time.sleep(0.01)
        assert rig.events().count("not asked") == 1
        AtOnce.answers = lambda *given: SimpleNamespace(
            safe=True, recommendation="compensate", block=given[2], described="a test"
        )
        rig.until(lambda: rig.writer.heard(found) or "request" in rig.events())
        line = next(line for line in rig.lines if line.get("event") == "request")
        assert line["who"] == "the estimate"
        assert line["new"]["first"] == pytest.approx(1000.0 * (left - 0.05 + 0.002), abs=1.0)
    finally:
        rig.close()


def dies():
    import os

    os._exit(3)


def fails():
    raise DataError.expected("a fit", "none", "give one")


def odd():
    raise ZeroDivisionError("odd")


@pytest.mark.long
@pytest.mark.parametrize(
    ("work", "error", "said"), [(dies, GateError, "died"), (fails, DataError, "a fit"), (odd, GateError, "odd")]
)
def test_a_study_in_a_process_of_its_own_that_goes_wrong(work, error, said):
    running = Running(work)
    end = time.monotonic() + 60.0
    while not running.done and time.monotonic() < end:
        time.sleep(0.05)
    with pytest.raises(error, match=said):
        running.result()
