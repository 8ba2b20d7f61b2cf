"""Supervisor against the kernel itself: what is asked, shown, accepted, refused, lost, and what stands in the log."""

import json
from types import SimpleNamespace

import pytest

from lostmotion.compensate.request import Request
from lostmotion.errors import FileAccessError, GateError
from lostmotion.live.audit_log import AuditLog, read_log
from lostmotion.live.link import LinkError
from lostmotion.live.supervisor import Supervisor
from lostmotion.live.virtual_plc import VirtualPlc
from tests.support.supervised import supervised


class Bench:
    """PLC, supervisor, operator and a clock, one scan after the other."""

    def __init__(self, folder, **settings):
        self.block = supervised("backlash", **settings)
        self.plc = VirtualPlc(self.block)
        self.plc.set("enable", 1.0)
        self.plc.set("auto_mode", 1.0)
        self.plc.set("cascade", 1.0)
        self.log = AuditLog(folder / "audit.jsonl")
        self.time = 0.0
        self.begin()

    def begin(self, **options):
        options = {"write": True, "least_interval": 5.0, "answer_within": 1.0, **options}
        self.supervisor = Supervisor(self.block, self.plc, self.log, name="FY-101", clock=lambda: self.time, **options)

    def scans(self, number=1, beat=True):
        for _ in range(number):
            self.time += 0.1
            self.plc.scan(50.0)
            if beat:
                self.supervisor.cycle()

    def study(self, safe=True, recommendation="compensate", **settings):
        tried = self.block.block.with_settings(**settings)
        return SimpleNamespace(safe=safe, recommendation=recommendation, block=tried, described="a test")

    def press(self):
        self.plc.set("accept", 1.0)
        self.scans()
        self.plc.set("accept", 0.0)

    def seen(self, name):
        return self.plc.read([name])[name]


@pytest.fixture
def bench(tmp_path):
    made = Bench(tmp_path)
    made.scans(3)
    return made


def arm(bench, **settings):
    bench.supervisor.propose(bench.study(**settings), "anna")
    bench.scans(4)
    bench.press()
    bench.scans(2)


def test_the_whole_way(bench):
    request = bench.supervisor.propose(bench.study(lead_up=0.6, factor=0.5), "anna")
    assert (request.factor, request.first, request.second) == (500, 600, 900)
    assert bench.supervisor.state == "requested"
    bench.scans(3)
    assert bench.supervisor.state == "verified"
    assert bench.seen("supervision") == 1.0
    bench.press()
    bench.scans(2)
    assert bench.supervisor.state == "accepted"
    assert bench.seen("supervision") == 3.0
    assert (bench.seen("force_factor"), bench.seen("force_first")) == (0.5, 0.6)
    lines = read_log(bench.log.path)
    assert [line["event"] for line in lines] == ["begin", "request", "verify", "accept"]
    assert lines[1]["who"] == "anna"
    assert lines[1]["new"] == {"factor": 500, "first": 600, "second": 900}
    assert lines[1]["old"]["factor"] == 0.0
    assert all(line["when"].endswith("+00:00") for line in lines)


def test_a_frozen_heartbeat_sheds_within_the_time_out_and_nothing_comes_back(bench):
    arm(bench)
    bench.scans(beat=False)  # sees the last change
    scans = 0
    while bench.seen("supervision") == 3.0:
        bench.scans(beat=False)
        scans += 1
    assert scans <= bench.block.settings["timeout"]
    assert bench.seen("shed_reason") == 2.0
    bench.scans(60)
    assert bench.seen("link_ok") == 1.0
    assert bench.seen("supervision") == 4.0
    assert bench.seen("offset") == 0.0
    bench.press()  # an accept of nothing
    bench.scans(5)
    assert bench.seen("supervision") == 4.0
    assert read_log(bench.log.path)[-1]["answer"] == "heartbeat"
    arm(bench)
    assert bench.seen("supervision") == 3.0


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("good", 0.0, 3.0),
        ("track", 1.0, 4.0),
        ("auto_mode", 0.0, 5.0),
        ("cascade", 0.0, 6.0),
        ("first_range", 0.0, 7.0),
    ],
)
def test_what_is_lost_is_shed_and_stays_away(bench, name, value, reason):
    arm(bench, lead_up=0.6)
    usual = bench.seen(name) if name != "first_range" else 0.35
    bench.plc.set(name, value)
    bench.scans()
    assert (bench.seen("supervision"), bench.seen("shed_reason")) == (4.0, reason)
    bench.plc.set(name, usual)
    bench.scans(80)
    assert (bench.seen("supervision"), bench.seen("force_id")) == (4.0, 0.0)


def test_only_what_a_study_has_passed(bench):
    for study in (
        bench.study(safe=False),
        bench.study(recommendation="maintain"),
        bench.study(band=0.1),
        SimpleNamespace(safe=True, recommendation="compensate", block=supervised("dead zone").block, described=""),
    ):
        with pytest.raises(GateError):
            bench.supervisor.propose(study, "anna")
    assert bench.seen("request_id") == 0.0
    assert [line["event"] for line in read_log(bench.log.path)] == ["begin"]


def test_nothing_is_written_without_leave(tmp_path):
    bench = Bench(tmp_path)
    bench.begin(write=False)
    bench.scans(5)
    assert bench.seen("heartbeat") == 0.0
    with pytest.raises(GateError, match="write = true"):
        bench.supervisor.propose(bench.study(), "anna")
    assert not bench.log.path.exists()


def test_one_request_at_a_time_and_a_least_interval(bench):
    bench.supervisor.propose(bench.study(), "anna")
    with pytest.raises(GateError, match="under way"):
        bench.supervisor.propose(bench.study(), "anna")
    bench.scans(4)
    bench.press()
    with pytest.raises(GateError, match="since the last request"):
        bench.supervisor.propose(bench.study(lead_up=0.6), "anna")
    bench.scans(60)
    with pytest.raises(GateError, match="changes by"):
        bench.supervisor.propose(bench.study(), "anna")
    arm(bench, lead_up=0.6)
    assert bench.seen("force_first") == 0.6
    assert bench.seen("supervision") == 3.0


def test_a_write_that_fails_is_never_tried_again(bench, monkeypatch):
    calls = []

    def broken(values):
        calls.append(dict(values))
        raise LinkError("expected an answer, got none; the line is dead")

    whole = bench.plc.write
    monkeypatch.setattr(bench.plc, "write", broken)
    with pytest.raises(LinkError):
        bench.supervisor.propose(bench.study(), "anna")
    assert len(calls) == 1
    assert bench.supervisor.state == "failed"
    monkeypatch.setattr(bench.plc, "write", whole)
    bench.scans(30)
    assert bench.seen("request_id") == 0.0
    assert [line["event"] for line in read_log(bench.log.path)][-2:] == ["request", "failed"]


def test_without_a_log_nothing_is_sent(bench, tmp_path):
    bench.log.path.unlink()
    bench.log.path.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(FileAccessError, match="nothing is sent"):
        bench.supervisor.propose(bench.study(), "anna")
    assert bench.seen("request_id") == 0.0


def test_half_a_line_is_left_alone(bench):
    with bench.log.path.open("a") as log:
        log.write('{"when": "20')
    bench.supervisor.propose(bench.study(), "anna")
    assert [line["event"] for line in read_log(bench.log.path)] == ["begin", "request"]
    assert sum(1 for line in bench.log.path.read_text().splitlines() if not line.endswith("}")) == 1


def test_a_request_changed_by_another_hand_is_dropped(bench):
    bench.supervisor.propose(bench.study(), "anna")
    bench.scans(3)
    bench.plc.write({"asked_first": 1})
    bench.scans(2)
    assert bench.supervisor.state == "refused"
    bench.press()
    assert bench.seen("supervision") == 0.0


def test_a_restart_of_the_plc_forgets_and_asks_nobody(bench):
    arm(bench)
    bench.plc.restart()
    bench.scans(20)
    assert (bench.seen("supervision"), bench.seen("force_id")) == (0.0, 0.0)
    bench.press()
    assert bench.seen("supervision") == 0.0


def test_a_supervisor_that_begins_anew_withdraws_what_it_finds_waiting(bench):
    bench.supervisor.propose(bench.study(), "anna")
    bench.scans(3)
    bench.begin()
    bench.scans(3)
    assert bench.seen("waiting") == 0.0
    bench.time += 10.0
    arm(bench)
    assert bench.seen("supervision") == 3.0


def test_the_wall_clock_decides_nothing(tmp_path):
    import datetime as dt

    bench = Bench(tmp_path)
    stamps = iter([dt.datetime(year, 1, 1, tzinfo=dt.UTC) for year in (2026, 1990, 2090, 2000, 2026, 2027, 2028)])
    bench.log = AuditLog(bench.log.path, lambda: next(stamps))
    bench.begin()
    bench.scans(3)
    arm(bench)
    assert bench.seen("supervision") == 3.0


@pytest.mark.parametrize("value", [float("nan"), 0.5, 2.0**31])
def test_a_dint_takes_whole_numbers_only(bench, value):
    with pytest.raises(LinkError):
        bench.plc.write({"asked_first": value})
    with pytest.raises(LinkError):
        bench.plc.write({"op_in": 1})


def test_checksum_is_that_of_the_block(bench):
    request = Request(7, 500, 600, 900, 1234)
    wrong = {**request.values, "checksum": request.checksum + 1}
    bench.plc.write(wrong)
    bench.scans(2)
    assert bench.seen("refusal") == 2.0
    right = Request(8, 500, 600, 900, 1234)
    bench.plc.write(right.values)
    bench.scans(1)
    assert bench.seen("refusal") == 0.0
    assert json.loads(json.dumps(right.to_dict()))["id"] == 8
