"""Watches of a running plant in the store of audits: beside them, told apart, each loop once."""

import json
import threading
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta

import pytest

from lostmotion.audit.audit_run import AuditRun
from lostmotion.audit.live_points import live_estimates, live_points
from lostmotion.audit.run_view import run_facts
from lostmotion.audit.stored_loop import stored_loop
from lostmotion.errors import FileAccessError
from lostmotion.live.estimates import Estimates, estimate_of
from lostmotion.report.plant.sizes import history_rows
from lostmotion.store import alive
from lostmotion.store.encoded import coded
from lostmotion.store.rows import UNDATED, EstimateRow, Stage
from lostmotion.store.run_rows import LoopRow, RunRow, RunState, WatchRow
from lostmotion.store.store import Screened, Store
from lostmotion.store.watched import WatchStore
from tests.unit.store.test_store import row

PLC = WatchRow("opc.tcp://plc1:4840", ("FIC-1", "LIC-2"), "d1")
LOOPS = [LoopRow("FIC-1", op="ns=2;s=FIC-1.OP"), LoopRow("LIC-2")]


@pytest.fixture(params=["sqlite", "postgresql"])
def address(request, tmp_path):
    return tmp_path / "plant.db" if request.param == "sqlite" else request.getfixturevalue("postgresql").database()


def at(hours, tag="FIC-1", width=2.0, status="OK"):
    moment = UNDATED + timedelta(days=20_000, hours=hours)
    return EstimateRow(tag, moment, 1000 * hours, status, width, width - 0.5, width + 0.5, 0.25, -1.0, 1.0)


def test_every_field_has_a_column_and_comes_back(address):
    for kind in (WatchRow, EstimateRow):
        assert [one.name for one in coded(kind)] == [one.name for one in fields(kind)]
    open_ended = replace(at(2), low=None, high=None, standard_error=None, left=None, right=None, status="NOT_SEEN")
    with WatchStore(address) as store:
        number = store.begin_watch(PLC, LOOPS)
        store.put_estimates(number, [at(1), open_ended, at(1, "LIC-2", 3.0)])
        store.put_estimates(number, [at(1)])  # told once more after a kill
        assert store.estimates("FIC-1") == [(1, open_ended), (1, at(1))]
        assert store.estimates("FIC-1", limit=1) == [(1, open_ended)]
        assert store.estimates("LIC-2") == [(1, at(1, "LIC-2", 3.0))]
        (watch,) = store.watches()
    assert (watch.source, watch.tags, watch.state, watch.number) == (PLC.source, PLC.tags, RunState.RUNNING, 1)


def test_a_loop_is_watched_by_one_process(address, monkeypatch):
    with WatchStore(address) as first, WatchStore(address) as second:
        number = first.begin_watch(PLC, LOOPS)
        other = WatchRow("opc.tcp://plc2:4840", ("LIC-2", "TIC-3"), "d2")
        with pytest.raises(FileAccessError, match=r"got LIC-2 of watch 1 of process .*, whose heart beats; stop it"):
            second.begin_watch(other, [LoopRow("TIC-3")])
        assert first.begin_watch(PLC, LOOPS) == number, "it may take its own again"
        assert second.begin_watch(replace(other, tags=("TIC-3",)), [LoopRow("TIC-3")]) == 2, "other loops are free"
        monkeypatch.setattr(alive, "SILENT", -1.0)  # the first was silent for too long
        assert second.begin_watch(PLC, LOOPS) == number, "it goes on, there is no second of the same"
        monkeypatch.undo()
        with pytest.raises(FileAccessError, match=r"expected watch 1 .* got one that another process has taken over"):
            first.put_estimates(number, [at(1)])
        assert first.estimates("FIC-1") == []


def test_a_stopped_watch_is_gone_on_with_and_another_one_of_its_loops_ends_it(address):
    with WatchStore(address) as store:
        number = store.begin_watch(PLC, LOOPS)
        store.end_watch(number)
        assert store.watches()[0].state is RunState.STOPPED
    with WatchStore(address) as store:
        assert store.begin_watch(PLC, LOOPS) == number
        store.end_watch(number)
        assert store.begin_watch(replace(PLC, digest="d2"), LOOPS) == 2
        assert [one.state for one in store.watches()] == [RunState.RUNNING, RunState.ABANDONED]


def audited(store, size):
    run, _ = store.begin(RunRow("plant"))
    store.put_loops(run, [LoopRow("FIC-1", area="north", op_span=(0.0, 50.0))])
    found = {"size": size, "low": size - 0.5, "high": size + 0.5, "size_percent": 2.0 * size, "verdict": "dead zone"}
    rows = (row("FIC-1", stage=Stage.ASSESSED, kind="actuator", fingerprint=f"f{size}", **found),)
    store.put_screened(run, [Screened(rows)])
    return run


def test_audits_and_watches_leave_each_other_alone(address):
    with Store(address) as audit, WatchStore(address) as live:
        watch = live.begin_watch(PLC, LOOPS)  # before any audit
        first = audited(audit, 1.0)
        live.put_estimates(watch, [at(1)])  # while the audit is at work
        audit.finish(first)
        second = audited(audit, 2.0)
        live.put_estimates(watch, [at(2)])
        with WatchStore(address) as other:
            assert other.begin_watch(WatchRow("opc.tcp://plc3", ("TIC-3",)), [LoopRow("TIC-3"), *LOOPS]) == 2
        audit.finish(second)
        assert audit.loop("FIC-1").area == "north", "the loop list of the audit stays"
        assert [one.number for one in audit.runs()] == [second, first] == [2, 1]
        assert audit.last_run().number == second
        assert audit.last_run(second).number == first
        assert [(one.tag, one.what) for one in audit.news(second)] == []
        assert [line.row.tag for line in audit.lines(second).lines] == ["FIC-1"]
        assert [run.number for run, _ in audit.history("FIC-1")] == [second, first]


def test_the_history_of_an_audit_has_the_estimates_beside_its_sizes(address):
    with Store(address) as audit, WatchStore(address) as live:
        run = audited(audit, 1.0)
        audit.finish(run)
        watch = live.begin_watch(PLC, LOOPS)
        live.put_estimates(watch, [at(2, width=3.0), at(1)])
    found = AuditRun.of(address).loop("FIC-1")
    assert [one.size for one in found.sized] == [1.0]
    assert [one.width for one in found.live] == [2.0, 3.0], "the oldest first"
    assert found.size[0] == 2.0, "% of span, of the audit alone"
    said = json.loads(json.dumps(found.to_dict()))["live"]
    assert [one["width"] for one in said] == [[2.0, 1.5, 2.5], [3.0, 2.5, 3.5]]


def test_points_of_the_running_plant_are_told_apart(address):
    with Store(address) as audit, WatchStore(address) as live:
        run = audited(audit, 1.0)
        audit.finish(run)
        watch = live.begin_watch(PLC, LOOPS)
        live.put_estimates(watch, [at(1), at(2, width=0.25, status="NOT_SEEN")])
        made = audit.run(run)
        view = stored_loop(audit, made, "FIC-1", run_facts(made, None, "x"))
        assert [(one.run, one.live, one.size, one.low, one.high, one.excluded) for one in view.history] == [
            (1, False, 2.0, 1.0, 3.0, None),
            (1, True, 4.0, 3.0, 5.0, None),  # the span of OP is 50
            (1, True, None, None, None, 1.5),
        ]
        rows = history_rows(view.history)
        assert [(one[0], one[2], one[3]) for one in rows] == [
            ("1", "dead zone", "2.00 % (1.00 .. 3.00)"),
            ("live 1", "dead zone", "4.00 % (3.00 .. 5.00)"),
            ("live 1", "none seen", "up to 1.5 % not excluded"),
        ]
        later = audited(audit, 1.5)
        audit.finish(later)
        live.put_estimates(watch, [replace(at(3), at=datetime.now(UTC) + timedelta(hours=1))])
        assert [len(live_estimates(audit, audit.run(number), "FIC-1")) for number in (run, later)] == [2, 3]


def test_without_a_span_the_estimate_is_told_in_units_of_op():
    loop, sized = LoopRow("FIC-1"), row("FIC-1", size=2.0, size_percent=5.0)
    (known,), (unknown,) = live_points([(1, at(1))], loop, [sized]), live_points([(1, at(1))], loop, [row("FIC-1")])
    assert (known.size, known.said) == (5.0, "dead zone")
    assert (unknown.size, unknown.said) == (None, "dead zone, 2 (1.5 .. 2.5) units of OP")


def test_many_estimates_are_thinned_to_the_last_of_each_day(tmp_path):
    with Store(tmp_path / "plant.db") as audit, WatchStore(tmp_path / "plant.db") as live:
        run = audited(audit, 1.0)
        audit.finish(run)
        live.put_estimates(live.begin_watch(PLC, LOOPS), [at(hour) for hour in range(1, 100)])
        found = live_estimates(audit, audit.run(run), "FIC-1")
    assert [one.sample for _, one in found] == [23_000, 47_000, 71_000, 95_000, 99_000]


def report(hours, tag="FIC-1", width=2.0):
    return {
        "tag": tag, "kind": "report", "time": f"{at(hours).at:%Y-%m-%dT%H:%M:%S}Z", "sample": 1000 * hours,
        "status": "OK",
        "width": {"value": width, "standard_error": 0.25, "low": width - 0.5, "high": width + 0.5},
        "left": {"value": -1.0, "standard_error": 0.1, "low": -1.2, "high": -0.8},
        "right": {"value": 1.0, "standard_error": 0.1, "low": 0.8, "high": 1.2},
    }  # fmt: skip


def test_what_is_no_estimate_is_not_stored():
    starting = report(1) | dict.fromkeys(("width", "left", "right"))
    unknown = report(1) | {"width": dict.fromkeys(("value", "standard_error", "low", "high"))}
    event = {"tag": "FIC-1", "kind": "event", "message": ""}
    assert [estimate_of(one) for one in (starting, unknown, event)] == [None] * 3
    assert estimate_of(report(1)) == at(1)


def test_a_store_that_is_locked_or_gone_is_told_once_and_what_waits_is_written_later(tmp_path, monkeypatch):
    monkeypatch.setattr("lostmotion.live.estimates.PATIENCE", 0.05)
    path, told = tmp_path / "plant.db", []
    estimates = Estimates(path, PLC, LOOPS, told.append)
    estimates.take(report(1))
    with Store(path) as other, other._writing():  # an audit in a long transaction
        estimates.write()
        estimates.take(report(2))
        estimates.write()
    assert len(told) == 1
    assert told[0].startswith("Estimates are not stored, and wait: expected a store")
    estimates.write()
    assert told[1:] == ["Estimates are stored again, 2 that have waited."]
    for name in ("plant.db", "plant.db-wal", "plant.db-shm"):
        if (tmp_path / name).exists():
            (tmp_path / name).rename(tmp_path / f"away-{name}")
    estimates.take(report(3))
    estimates.write()
    assert "got no such file; put it back" in told[2]
    assert not path.exists(), "none is made in its place"
    for one in tmp_path.glob("away-*"):
        one.rename(tmp_path / one.name.removeprefix("away-"))
    estimates.close()
    with Store(path, write=False) as store:
        assert [one.sample for _, one in store.estimates("FIC-1")] == [3000, 2000, 1000]
        assert store.watches()[0].state is RunState.STOPPED


def test_not_more_waits_than_is_allowed(tmp_path, monkeypatch):
    monkeypatch.setattr("lostmotion.live.estimates.PATIENCE", 0.05)
    monkeypatch.setattr("lostmotion.live.estimates.MOST", 3)
    told = []
    estimates = Estimates(tmp_path / "plant.db", PLC, LOOPS, told.append)
    with Store(tmp_path / "plant.db") as other, other._writing():
        for hour in range(1, 6):
            estimates.take(report(hour))
            estimates.write()
    estimates.write()
    assert told[-1] == "Estimates are stored again, 3 that have waited; 2 older ones were let go."
    estimates.close()
    with Store(tmp_path / "plant.db", write=False) as store:
        assert [one.sample for _, one in store.estimates("FIC-1")] == [5000, 4000, 3000]


def test_writers_at_the_same_time(address):
    """Two audits' worth of loops and two watches, each from a thread of its own: all is there, numbered once."""
    with Store(address) as audit:
        run, _ = audit.begin(RunRow("plant"))
        tags = [f"A-{k}" for k in range(60)]

        def watching(name):
            with WatchStore(address) as store:
                own = [f"{name}-{k}" for k in range(30)]
                number = store.begin_watch(WatchRow(name, tuple(own)), [LoopRow(tag) for tag in own])
                for hour in range(1, 11):
                    store.put_estimates(number, [at(hour, tag) for tag in own])

        threads = [threading.Thread(target=watching, args=(name,)) for name in ("B", "C")]
        for thread in threads:
            thread.start()
        for last in range(10, 61, 10):
            audit.put_loops(run, [LoopRow(tag) for tag in tags[:last]])
            audit.put_screened(run, [Screened((row(tag),)) for tag in tags[:last]])
        for thread in threads:
            thread.join()
        audit.finish(run)
        assert len(audit.rows(run)) == 60
        assert len({one.tag for one in audit.loops()}) == 120
        for tag in ("B-0", "C-29"):
            assert [one.sample for _, one in audit.estimates(tag)] == list(range(10_000, 0, -1000))
