"""Store: rows there and back, runs, what is carried over, what pages ask; SQLite and PostgreSQL the same."""

import math
import sqlite3
from dataclasses import fields, replace
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
import sqlalchemy as sa

from lostmotion.errors import DataError, FileAccessError, ParameterError
from lostmotion.store import alive, news, runs
from lostmotion.store.carry import Known
from lostmotion.store.changed import ORDER, New, differences
from lostmotion.store.encoded import coded, decoded, encoded
from lostmotion.store.queries import Filter
from lostmotion.store.rows import UNDATED, AssessmentRow, GroupRow, SpectrumRow, Stage, TraceRow
from lostmotion.store.run_rows import LoopRow, ReviewRow, ReviewState, RunRow, RunState, UnreadRow
from lostmotion.store.schema import assessment, change, comparison, metadata
from lostmotion.store.store import Screened, Store

LATER = UNDATED + timedelta(hours=1)
KINDS = (AssessmentRow, SpectrumRow, TraceRow, GroupRow, LoopRow, UnreadRow, RunRow, ReviewRow, New)


@pytest.fixture(params=["sqlite", "postgresql"])
def store(request, tmp_path):
    address = tmp_path / "plant.db" if request.param == "sqlite" else request.getfixturevalue("postgresql").database()
    with Store(address) as one:
        yield one


def full():
    """A row in which every field has another value than the usual one."""
    made = {"moment": LATER, "text": "wörter\n'\"%_", "float": 1.0 / 3.0, "int": 7, "bool": False, "bytes": b"\0\xff"}
    values = {one.name: made.get(one.kind) for one in coded(AssessmentRow)}
    return AssessmentRow(**values | {
        "tag": "FIC-1", "stage": Stage.ASSESSED, "health": ("stale", "a"), "advice": (), "high": math.inf,
        "evidence": (("shape", 0.1, -2.5), ("b", 1e-300, 3.0)), "indices": {"b": 1.0, "a": 2.5},
    })  # fmt: skip


def begun(store, tags=("FIC-1", "LIC-2", "TIC-3"), **settings):
    run, _ = store.begin(RunRow("plant", **settings))
    store.put_loops(run, [LoopRow(tag, area=f"area {number % 2}") for number, tag in enumerate(tags)])
    return run


def row(tag, **settings):
    return AssessmentRow(tag, UNDATED, LATER, **{"fingerprint": f"f{tag}", "stamp": "1", "value": 0.5} | settings)


def test_every_field_of_every_row_has_a_column():
    for kind in KINDS:
        assert [one.name for one in coded(kind)] == [one.name for one in fields(kind)]
    there = {column.name for column in assessment.columns}
    assert {one.column for one in coded(AssessmentRow) if one.name != "tag"} < there


def test_rows_come_back_as_they_were(store):
    run = begun(store)
    store.put_screened(run, [Screened((full(), replace(full(), window_start=UNDATED)))])
    assert store.rows(run) == [replace(full(), window_start=UNDATED), full()]


def test_what_databases_keep_differently_is_not_kept():
    odd = row("a", size=np.float64(-0.0), low=math.nan, error="a\0b\ud800", health=("\0",), indices={"x": math.inf})
    found = decoded(AssessmentRow, encoded(odd))
    assert math.copysign(1.0, found.size) == 1.0
    assert (found.low, found.error, found.health, found.indices) == (None, "a\ufffdb?", ("\ufffd",), {"x": None})


@pytest.mark.parametrize("bad", [{"value": math.nan}, {"window_end": datetime(2026, 1, 1)}, {"rows": None}])
def test_what_cannot_be_kept_is_refused(bad):
    with pytest.raises(DataError, match=r"expected .*, got .*; "):
        encoded(replace(row("a"), **bad))


def test_moments_are_utc_whatever_the_zone(store):
    run = begun(store)
    there = datetime(2026, 3, 1, 2, tzinfo=timezone(timedelta(hours=2)))
    store.put_screened(run, [Screened((replace(row("FIC-1"), window_start=there),))])
    (found,) = store.rows(run)
    assert found.window_start == there
    assert found.window_start.tzinfo is UTC


def test_sqlite_keeps_what_others_can_read(tmp_path):
    with Store(tmp_path / "a.db") as store:
        run = begun(store)
        store.put_screened(run, [Screened((row("FIC-1", verdict="stiction", size=0.5),))])
    with sqlite3.connect(tmp_path / "a.db") as plain:
        query = (
            "SELECT l.tag, l.area, l.type, a.window_start, a.verdict, a.size, a.status, a.severity FROM assessment a"
        )
        found = plain.execute(f"{query} JOIN loop l ON l.id = a.loop_id JOIN run r ON r.id = a.run_id").fetchall()
    plain.close()
    assert found == [("FIC-1", "area 0", "", "1970-01-01 00:00:00.000000", "stiction", 0.5, "", "unknown")]


def test_writing_twice_changes_nothing(store):
    run = begun(store)
    spectrum, trace = (
        SpectrumRow("FIC-1", UNDATED, 0.1, 1.0, b"12"),
        TraceRow("FIC-1", UNDATED, 0.0, 9.0, b"", b"1", b"2"),
    )
    group = GroupRow(1, 60.0, "FIC-1", None, "first", (("FIC-1", UNDATED, 0.9, 0.5), ("LIC-2", UNDATED, 0.8, 0.1)))
    for _ in range(2):
        store.put_screened(run, [Screened((row("FIC-1"),), (spectrum,)), Screened((row("LIC-2"),))])
        for _ in range(2):
            store.put_assessed(run, [row("FIC-1", stage=Stage.ASSESSED)], [trace])
            store.put_groups(run, [group])
    assert [one.stage for one in store.rows(run)] == [Stage.ASSESSED, Stage.SCREENED]
    assert (store.spectra(run), store.traces(run, "FIC-1"), store.groups(run)) == ([spectrum], [trace], (group,))


def test_a_run_is_gone_on_with_only_if_it_is_the_same(store):
    run = begun(store, digest="d")
    store.finish(run, RunState.STOPPED, "by hand")
    assert store.begin(RunRow("plant", digest="d")) == (run, True)
    store.finish(run, RunState.STOPPED)
    assert store.begin(RunRow("plant", digest="other")) == (run + 1, False)
    assert store.runs()[1].state is RunState.ABANDONED
    store.finish(run + 1)
    assert store.begin(RunRow("plant", digest="other")) == (run + 2, False)
    assert store.last_run().number == run + 1, "finished ones first"


def test_a_second_coordinator_is_refused_while_the_first_lives(store, monkeypatch):
    run = begun(store)
    other = Store(store.engine.url.render_as_string(hide_password=False))
    with pytest.raises(
        FileAccessError, match=r"no audit is at work, got run 1 of process \d+ on .*, whose heart beats; "
    ):
        other.begin(RunRow("plant"))
    monkeypatch.setattr(alive, "SILENT", -1.0)
    assert other.begin(RunRow("plant")) == (run, True)
    with pytest.raises(FileAccessError, match="another audit has taken over"):
        store.put_screened(run, [Screened((row("FIC-1"),))])
    assert other.rows(run) == []
    other.close()


def test_a_heart_beats_while_nothing_is_written(store):
    run = begun(store)
    before = store.runs()[0].heartbeat
    with store.beating(run, 0.01):
        until = datetime.now(UTC) + timedelta(seconds=10)
        while store.runs()[0].heartbeat == before and datetime.now(UTC) < until:
            pass
    assert store.runs()[0].heartbeat > before


@pytest.mark.parametrize(
    ("host", "age", "expected"),
    [(None, 5, True), (None, 100, False), ("elsewhere", 5, True), ("elsewhere", 100, False)],
)
def test_who_lives(host, age, expected):
    me = alive.coordinator().split(" ")
    name = " ".join([host or me[0], *me[1:]])
    now = datetime.now(UTC)
    assert alive.lives(name, now - timedelta(seconds=age), now) is expected
    assert not alive.lives(f"{me[0]} 4194305 x", now, now), "no such process on this machine"


def test_what_is_unchanged_is_carried_over(store):
    first = begun(store, digest="d", code="c")
    spectrum = SpectrumRow("FIC-1", UNDATED, 0.1, 1.0, b"12")
    trace = TraceRow("FIC-1", UNDATED, 0.0, 9.0, b"", b"1", b"2")
    store.put_screened(first, [Screened((row("FIC-1"),), (spectrum,)), Screened((row("LIC-2"),))])
    store.put_screened(first, [Screened((row("TIC-3", stage=Stage.FAILED),))])
    store.put_assessed(first, [row("FIC-1", stage=Stage.ASSESSED)], [trace])
    told = row("FIC-1", stage=Stage.ASSESSED, priority=36.0, priority_reason="retune", rule="ringing")
    store.put_ranks(first, [told])
    store.finish(first)
    second = begun(store, digest="d", code="c")
    known = {"FIC-1": Known("1", ""), "LIC-2": Known("2", ""), "TIC-3": Known("1", "")}
    assert store.done(second, known) == {"FIC-1"}, "another stamp, and a failure, are looked at again"
    assert store.rows(second) == [told], "with its rule"
    assert (store.spectra(second), store.traces(second, "FIC-1")) == ([spectrum], [trace])
    store.finish(second)
    third = begun(store, digest="other", code="c")
    assert store.done(third, known) == set()


def test_the_same_data_behind_another_stamp_are_not_assessed_again(store):
    first = begun(store, digest="d", code="c")
    store.put_screened(first, [Screened((row("FIC-1"),)), Screened((row("LIC-2"),))])
    store.put_assessed(
        first, [row("FIC-1", stage=Stage.ASSESSED, verdict="stiction"), row("LIC-2", stage=Stage.ASSESSED)]
    )
    store.finish(first)
    second = begun(store, digest="d", code="c")
    store.put_screened(second, [Screened((row("FIC-1", stamp="2"),)), Screened((row("LIC-2", fingerprint="x"),))])
    assert store.rows(second) == [
        row("FIC-1", stamp="2", stage=Stage.ASSESSED, verdict="stiction"), row("LIC-2", fingerprint="x"),
    ]  # fmt: skip
    assert store.worth(second) == [("LIC-2", UNDATED)]


def test_loops_that_are_no_longer_in_the_source_leave_the_run(store):
    run = begun(store)
    store.put_screened(run, [Screened((row("FIC-1"),)), Screened((row("LIC-2"),))])
    store.finish(run, RunState.STOPPED)
    assert begun(store, tags=("LIC-2",)) == run
    assert [one.tag for one in store.rows(run)] == ["LIC-2"]


def filled(store):
    run = begun(store, tags=("b", "A", "ä", "%c", "a_"))
    words = [("stiction", "high", 0.5), ("none", "none", None), ("stiction", "low", 0.25), ("none", "low", 0.75)]
    found = [
        row(tag, verdict=verdict, severity=severity, priority=priority, stage=Stage.ASSESSED)
        for tag, (verdict, severity, priority) in zip(("b", "A", "ä", "%c"), words, strict=True)
    ]
    store.put_screened(run, [Screened((one,)) for one in [*found, row("a_")]])
    return run


def test_the_table_is_filtered_sorted_and_cut(store):
    run = filled(store)

    def tags(chosen=None, **how):
        return [line.row.tag for line in store.lines(run, chosen, **how).lines]

    assert tags() == ["%c", "b", "ä", "A", "a_"], "without a value last"
    assert tags(descending=False) == ["ä", "b", "%c", "A", "a_"]
    assert tags(sort="tag", descending=False) == ["%c", "A", "a_", "b", "ä"]
    assert tags(limit=2, offset=1) == ["b", "ä"]
    assert tags(sort="area", descending=False) == ["b", "ä", "a_", "A", "%c"]
    assert tags(Filter(said="stiction", severity="low")) == ["ä"]
    assert tags(Filter(text="Ä")) == ["ä"]
    assert tags(Filter(text="_")) == ["a_"]
    assert tags(Filter(area="area 1", stage="assessed")) == ["%c", "A"]
    assert store.lines(run, Filter(said="none"), limit=1).total == 2
    with pytest.raises(ParameterError, match="expected one of tag, "):
        store.lines(run, sort="evidence")
    assert store.counts(run)["said"] == {"stiction": 2, "none": 2, "not assessed": 1}
    assert ("area 0", "stiction", "high", 1) in store.areas(run)


def test_a_loop_counts_as_what_is_said_of_it(store):
    """A frozen measurement whose diagnosis reads saturation is none of a valve, in filters, counts and news."""
    first, tags = begun(store, tags=("a", "b", "c")), ("a", "b", "c")
    ended = [row(tag, stage=Stage.ASSESSED, verdict="saturation", severity="high", fingerprint="1") for tag in tags]
    store.put_screened(first, [Screened((one,)) for one in ended])
    store.finish(first)
    second = begun(store, tags=tags)
    rules = ("frozen measurement", "", "forced swing")
    now = [replace(one, rule=rule, fingerprint="2") for one, rule in zip(ended, rules, strict=True)]
    store.put_screened(second, [Screened((one,)) for one in now])
    store.finish(second)
    assert store.counts(second)["said"] == {"frozen measurement": 1, "saturation": 1, "forced swing": 1}
    assert [line.row.tag for line in store.lines(second, Filter(said="saturation")).lines] == ["b"]
    assert [line.row.tag for line in store.lines(second, Filter(said="frozen measurement")).lines] == ["a"]
    assert ("area 0", "frozen measurement", "high", 1) in store.areas(second)
    assert store.news(second) == [New("a", "another fault", "saturation", "frozen measurement", "high", "high")]
    third = begun(store, tags=tags)
    mended = replace(now[0], verdict="cannot tell", fingerprint="3")
    store.put_screened(third, [Screened((one,)) for one in (mended, *now[1:])])
    assert store.counts(third)["said"]["frozen measurement"] == 1
    store.put_ranks(third, [replace(mended, rule="")])
    store.finish(third)
    assert store.counts(third)["said"] == {"cannot tell": 1, "saturation": 1, "forced swing": 1}, "ranked again"
    assert store.news(third) == [New("a", "no longer found", "frozen measurement", "cannot tell", "high", "high")]


def test_reviews(store):
    run = filled(store)
    at = datetime(2026, 3, 1, tzinfo=UTC)
    store.review("b", ReviewState.ACCEPTED, "Ada", at=at)
    store.review("b", ReviewState.WORK_ORDER, "Ada", "4711", at=at)
    assert store.reviews("b")[1] == ReviewRow("b", ReviewState.WORK_ORDER, "Ada", at, "4711")
    assert [one.row.tag for one in store.lines(run, Filter(review="work order")).lines] == ["b"]
    assert store.lines(run, Filter(review="new")).total == 4
    assert store.lines(run, Filter(said="stiction")).lines[0].review is ReviewState.WORK_ORDER
    with pytest.raises(ParameterError, match="expected a loop of the store, got 'x'; "):
        store.review("x", ReviewState.ACCEPTED, "Ada")


SPOILT = {
    "text that is none": "update loop set search = cast(x'66ff' as text)",
    "a moment that is none": "update assessment set window_start = '2026-03-01 00:00:00\x0f000000'",
}


@pytest.mark.parametrize("what", SPOILT)
def test_rows_that_we_have_not_written_are_told_in_one_line(tmp_path, what):
    """By what reads, and by what reads before it writes."""
    path = tmp_path / "a.db"
    with Store(path) as store:
        store.finish(filled(store))
    with sqlite3.connect(path) as connection:
        connection.execute(SPOILT[what])
    connection.close()
    said = "got one that is damaged; take a copy of it from before, or begin a new one"
    with Store(path) as store, pytest.raises(FileAccessError, match=said):
        store.leading(1), store.rows(1), store.lines(1)
    if what == "a moment that is none":
        with Store(path) as store, pytest.raises(FileAccessError, match=said):
            store.finish(filled(store))


def test_news_and_history(store):
    first = filled(store)
    store.finish(first)
    second = filled(store)
    said = {"b": ("none", "unknown"), "A": ("stiction", "high"), "ä": ("backlash", "severe"), "%c": ("cannot tell", "")}
    changed = [
        row(tag, fingerprint="new", verdict=one, severity=severity, stage=Stage.ASSESSED)
        for tag, (one, severity) in said.items()
    ]
    store.put_screened(second, [Screened((one,)) for one in changed])
    store.finish(second)
    assert store.news(second) == [
        New("A", "new finding", "none", "stiction", "none", "high"),
        New("ä", "another fault", "stiction", "backlash", "low", "severe"),
        New("b", "no longer found", "stiction", "none", "high", "unknown"),
    ]
    assert store.news(second, limit=1) == store.news(second)[:1]
    assert store.news(first) == []
    assert [(run.number, found.verdict) for run, found in store.history("b")] == [(second, "none"), (first, "stiction")]
    assert store.loop("b").area == "area 0"
    assert (store.loop("x"), store.history("x")) == (None, [])


NAMED, RULED = (0.4, 0.15, 0.15, 0.15, 0.15), (0.8, 0.1, 0.1)


def random_run(store, rng, tags):
    run = begun(store, tags)
    rows = []
    for tag in rng.permutation(tags)[: rng.integers(len(tags) // 2, len(tags) + 1)]:
        size = float(rng.choice([0.5, 1.0, 1.5]))
        sized = {"size": size, "low": 0.8 * size, "high": 1.25 * size, "size_percent": 2.0 * size}
        verdict = str(rng.choice(["stiction", "backlash", "none", "cannot tell", "other oscillation"], p=NAMED))
        stage, rule = rng.choice(list(Stage), p=(0.2, 0.7, 0.1)), rng.choice(["", "ringing", "forced swing"], p=RULED)
        rows.append(
            row(
                str(tag),
                fingerprint=f"of run {run}",
                verdict=verdict,
                stage=Stage(stage),
                rule=str(rule),
                excluded_percent=float(rng.choice([0.5, 2.0])),
                **sized if rng.random() < 0.8 else {},
            )
        )
    store.put_screened(run, [Screened((one,)) for one in rows])
    return run


def test_news_that_were_kept_are_those_of_the_rule(store):
    rng, tags = np.random.default_rng(7), [f"FIC-{number}" for number in range(200)]
    kinds = set()
    for number in range(1, 4):
        run = random_run(store, rng, tags)
        if number == 2:
            store.finish(run, RunState.STOPPED)
            assert begun(store, tags) == run, "gone on with"
        slow = store.news(run)
        store.finish(run)
        rule = differences(store.rows(number - 1), store.rows(number)) if number > 1 else []
        assert [(what, (now or before).tag) for what, before, now in rule] == [(one.what, one.tag) for one in slow]
        assert store.news(run) == slow
        kinds.update(one.what for one in slow)
    assert kinds == set(ORDER)
    with store.engine.connect() as connection:
        assert connection.execute(sa.select(comparison).order_by("run_id")).all() == [(2, 1), (3, 2)]
        assert news.worked_out(connection, 3, 2) == store.news(3)
        assert news.worked_out(connection, 3, 1) == store.news(3, 1) != store.news(3)


def test_postgresql_knows_its_rows_before_it_is_asked_what_is_new(postgresql):
    """It counts rows a minute after they came; without numbers the join of two runs took over 49 minutes."""
    with Store(postgresql.database()) as one:
        for _ in range(2):
            run, _ = one.begin(RunRow("plant"))
            one.put_loops(run, [LoopRow(f"FIC-{number}") for number in range(40)])
            one.put_screened(run, [Screened((replace(full(), tag=f"FIC-{number}"),)) for number in range(40)])
            one.finish(run)
        with one.engine.connect() as connection:
            known = connection.scalar(sa.text("SELECT reltuples FROM pg_class WHERE relname = 'assessment'"))
    assert known == 80


def test_what_is_new_is_kept_with_the_end_of_a_run_or_not_at_all(store, monkeypatch):
    store.finish(filled(store))
    run = random_run(store, np.random.default_rng(1), ["b", "A", "c"])
    told = store.news(run)
    monkeypatch.setattr(runs, "end", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        store.finish(run)
    monkeypatch.undo()
    with store.engine.connect() as connection:
        assert connection.execute(sa.select(comparison)).all() == []
        assert connection.execute(sa.select(change)).all() == []
    store.finish(run)
    assert store.news(run) == told != []


def test_both_databases_have_the_same_rows(postgresql, tmp_path):
    found = []
    for address in (tmp_path / "a.db", postgresql.database()):
        with Store(address) as store:
            filled(store)
            store.review("b", ReviewState.ACCEPTED, "Ada", at=LATER)
            with store.engine.connect() as connection:
                tables = {
                    table.name: connection.execute(sa.select(table).order_by(*table.primary_key)).all()
                    for table in metadata.sorted_tables
                    if table.name != "run"
                }
        found.append(tables)
    assert found[0] == found[1]
    assert len(found[0]["assessment"]) == 5
