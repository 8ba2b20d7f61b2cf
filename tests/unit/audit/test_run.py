"""A run of an audit: everything accounted for, the same rows however it is done, gone on with where it was stopped."""

from dataclasses import replace
from datetime import timedelta

import pytest
from benchmarks.audit.stand_in import BEGAN, HERE, STEPS, MadePlant

from lostmotion.audit.runner import plan
from lostmotion.audit.runner.batches import batches, by_loop, together
from lostmotion.audit.runner.engine import EngineError, Task, open_engine
from lostmotion.audit.runner.engine.protocol import DIED
from lostmotion.audit.runner.run import SCREEN, Progress, run_audit
from lostmotion.audit.runner.work import Job, Steps, screen_batch
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import DataError, FileAccessError
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import Stage
from lostmotion.store.run_rows import RunState, UnreadRow
from lostmotion.store.store import Store

TAGS = tuple(f"L{number:02d}" for number in range(20))
ODD = ("bad 1", "raise 1", "late raise")
HOURS = AuditSettings(window=7200.0)


def audited(store, source=None, settings=HOURS, engine="inline", workers=None, progress=None, **more):
    one = open_engine(engine, workers)
    try:
        return run_audit(source or MadePlant(TAGS + ODD), store, settings, one, progress, steps=STEPS, **more)
    finally:
        one.close()


def all_of(store, run):
    """What a run has left, but for the processor time, which is a measurement."""
    rows = [replace(row, seconds=0.0) for row in store.rows(run)]
    return rows, store.spectra(run), [store.traces(run, tag) for tag in TAGS], store.groups(run), store.unread(run)


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    with Store(tmp_path_factory.mktemp("reference") / "a.db") as store:
        return all_of(store, audited(store))


def test_every_loop_and_file_is_accounted_for(reference):
    rows, spectra, traces, groups, unread = reference
    assert {row.tag for row in rows} == {*TAGS, *ODD}
    assert {row.tag: row.error for row in rows if row.stage is Stage.FAILED} == {
        "bad 1": "expected a table, got noise; look at the file",
        "raise 1": "ZeroDivisionError: in the screen",
        "late raise": "ValueError: in the assessment",
    }
    assert len(rows) == 2 * 21 + 2
    assert len(spectra) == 2 * 21
    assert sum(len(one) for one in traces) == sum(row.stage is Stage.ASSESSED for row in rows) > 30
    assert [row.value for row in rows if row.stage is Stage.SCREENED] == [0.0]
    assert all(row.settings and row.code and row.stamp and row.definition for row in rows)
    assert len(groups) == 14
    assert unread == [UnreadRow("README.md", "a text", failed=False), UnreadRow("broken.csv", "no table")]


def test_processes_find_the_same_to_the_last_digit(reference, tmp_path, postgresql):
    with Store(tmp_path / "a.db") as store:
        assert all_of(store, audited(store, engine="processes", workers=2)) == reference
    with Store(postgresql.database()) as store:
        assert all_of(store, audited(store)) == reference


class Stop(Exception):  # noqa: N818
    """What a killed process leaves: nothing is finished."""


@pytest.mark.sampled(4)
@pytest.mark.parametrize("at", [("screen", 1), ("screen", 2), ("assess", 1), ("assess", 3), ("rank", 0), ("rank", 1)])
@pytest.mark.parametrize("how", [Stop, KeyboardInterrupt])
def test_a_run_is_gone_on_with_where_it_was_stopped(reference, tmp_path, at, how):
    calls = []

    def stop(progress):
        calls.append(progress.stage)
        if (progress.stage, calls.count(progress.stage) - 1) == at:
            raise how

    log = tmp_path / "read.txt"
    source = MadePlant(TAGS + ODD, log=str(log))
    with Store(tmp_path / "a.db") as store:
        with pytest.raises(how):
            audited(store, source, progress=stop)
        assert store.runs()[0].state is (RunState.RUNNING if how is Stop else RunState.STOPPED)
        if how is Stop:
            store.finish(1, RunState.STOPPED)  # this process lives
        assert audited(store, source) == 1
        assert all_of(store, 1) == reference
        assert store.runs()[0].state is RunState.FINISHED
    screened = log.read_text().splitlines()[: len(TAGS + ODD)]
    assert len(set(screened)) == len(TAGS + ODD) or at[0] == "screen"


def test_nothing_is_read_again_where_nothing_has_changed(tmp_path, reference):
    log = tmp_path / "read.txt"
    source = MadePlant(TAGS, log=str(log))
    with Store(tmp_path / "a.db") as store:
        first = audited(store, source)
        log.unlink()
        second = audited(store, source)
        assert second == first + 1
        assert not log.exists()
        assert all_of(store, second) == all_of(store, first)
        audited(store, replace(source, stamp="2"))
        assert sorted(log.read_text().split()) == list(TAGS), "screened again, and not assessed: the data are the same"
        assert all_of(store, 3)[0] == [replace(row, stamp="2") for row in all_of(store, 2)[0]]
        log.unlink()
        audited(store, source, replace(HOURS, until=BEGAN + timedelta(days=1)))
        assert sorted(log.read_text().split()) == list(TAGS), "another period may have other windows"
        log.unlink()
        audited(store, source, AuditSettings())
        assert len(log.read_text().split()) == 2 * len(TAGS), "other windows"


def test_what_changed_while_it_was_stopped_is_done_again(tmp_path):
    with Store(tmp_path / "a.db") as store:

        def stop(progress):
            if progress.stage == "assess":
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            audited(store, MadePlant(TAGS), progress=stop)
        new = MadePlant(TAGS[1:], stamp="2", data=1)
        run = audited(store, new)
        assert run == 1
        with Store(tmp_path / "b.db") as other:
            assert all_of(store, run) == all_of(other, audited(other, new))


def test_what_failed_is_tried_again_in_the_next_run(tmp_path):
    log = tmp_path / "read.txt"
    source = MadePlant((*TAGS[:3], *ODD), log=str(log))
    with Store(tmp_path / "a.db") as store:
        audited(store, source)
        log.unlink()
        audited(store, source)
        assert set(log.read_text().splitlines()) == set(ODD)


def test_a_budget_goes_to_the_most_valuable_first(tmp_path):
    with Store(tmp_path / "a.db") as store:
        source = MadePlant(TAGS, cost=0.02)
        run = audited(store, source, replace(HOURS, cpu_minutes=0.15 / 60.0))
        rows = [row for row in store.rows(run) if row.value > 0.0]
        done = [row for row in rows if row.stage is Stage.ASSESSED]
        left = [row for row in rows if row.stage is Stage.SCREENED]
        assert 4 <= len(done) <= 16
        assert min(row.value for row in done) >= max(row.value for row in left)
        assert {row.reason for row in left} == {f"swings; {plan.BUDGET}"}
        more = audited(store, source, HOURS)
        assert {(row.stage, row.reason) for row in store.rows(more) if row.value > 0.0} == {(Stage.ASSESSED, "swings")}
        only = audited(store, MadePlant(TAGS, data=2), replace(HOURS, screen_only=True))
        assert {row.stage for row in store.rows(only)} == {Stage.SCREENED}


def test_a_loop_that_kills_its_worker_is_a_row(tmp_path):
    with Store(tmp_path / "a.db") as store:
        run = audited(store, MadePlant((*TAGS[:3], "late kill")), AuditSettings(), "processes", 1)
        assert [(row.tag, row.error) for row in store.rows(run) if row.error] == [("late kill", DIED)]
        assert len(store.rows(run)) == 4


# the interruption may hit a callback of the garbage collector, which drops it; it comes again after a second
@pytest.mark.long
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_loop_that_never_ends_is_a_row(tmp_path):
    slow = "expected a result within 0.005 minutes, got none; give a loop more minutes, or a shorter window"
    limited = AuditSettings(loop_minutes=0.005)
    with Store(tmp_path / "a.db") as store:
        run = audited(store, MadePlant((*TAGS[:3], "endless")), limited)
        assert [(row.tag, row.error) for row in store.rows(run) if row.error] == [("endless", slow)]
        both = audited(store, MadePlant((*TAGS[:3], "endless", "asleep")), limited, "processes", 1)
        assert [(row.tag, row.error) for row in store.rows(both) if row.error] == [("asleep", DIED), ("endless", slow)]
        assert len(store.rows(both)) == 5
        assert AuditSettings().digest() == limited.digest()


def test_progress_says_how_far_and_how_long(tmp_path):
    seen = []
    with Store(tmp_path / "a.db") as store:
        audited(store, MadePlant(TAGS), progress=seen.append)
        audited(store, MadePlant(TAGS), progress=seen.append)
    assert seen[0] == Progress("screen", 0, 20)
    last = [one for one in seen if one.stage == "assess" and one.rate][-1]
    assert (last.done, last.seconds_left) == (last.total, 0.0)
    assert Progress("screen", 20, 20) in seen, "carried over"


def test_an_engine_that_fails_leaves_what_was_done(tmp_path):
    with Store(tmp_path / "a.db") as store:
        engine = open_engine("inline")
        steps = replace(STEPS, assess=f"{HERE}:none")
        with pytest.raises(EngineError, match=r"expected .*:none on the worker"):
            run_audit(MadePlant(TAGS), store, HOURS, engine, steps=steps)
        assert store.runs()[0].state is RunState.STOPPED
        assert "expected" in store.runs()[0].note
        assert len(store.rows(1)) == 40
        assert audited(store, MadePlant(TAGS)) == 1


def test_sources_that_cannot_be_audited(tmp_path):
    with Store(tmp_path / "a.db") as store:
        with pytest.raises(DataError, match="expected loops in the source, got none; "):
            audited(store, MadePlant(()))
        with pytest.raises(DataError, match="expected loops with different tags, got two with 'a'; "):
            audited(store, MadePlant(("a", "b", "a")))
        assert store.runs() == []
        audited(store, MadePlant(TAGS[:1]))
        store.begin(store.runs()[0])
        with Store(tmp_path / "a.db") as other, pytest.raises(FileAccessError, match="in which no audit is at work"):
            audited(other, MadePlant(TAGS[:1]))


class Raising(MadePlant):
    """A source that raises in the middle, and forgets a loop."""

    def read(self, loops, since=None, until=None):
        for loop, record in super().read([loop for loop in loops if loop.tag != "L03"], since, until):
            if loop.tag == "L02":
                raise OSError("no such\nhost")
            yield loop, record


def test_a_source_that_raises_costs_the_loops_that_it_is_about():
    source = Raising(TAGS[:6])
    found = screen_batch(Job(source, HOURS, STEPS), source.loops())
    assert [rows[0].error for rows, _ in found] == [
        "",
        "",
        "OSError: no such host",
        "the source gave nothing for it",
        "",
        "",
    ]
    with pytest.raises(EngineError, match="expected lostmotion old on the worker"):
        list(open_engine("inline").run(Task(SCREEN, Job(source, HOURS, STEPS, "old")), [source.loops()]))


def test_batches_hold_loops_of_a_file_and_so_many_bytes():
    loops = [PlantLoop(f"L{number}", where=f"f{number % 30}#x", size=10_000_000) for number in range(120)]
    found = list(batches(loops))
    assert {len(one) for one in found} == {16, 8}
    assert [loop for one in found for loop in one] == together(loops)
    assert [loop.where for loop in found[0]][::4] == ["f0#x", "f1#x", "f2#x", "f3#x"]
    assert [len(one) for one in batches(loops[:10], workers=2)] == [1] * 10
    pairs = by_loop([(loops[0], 1), (loops[31], 2), (loops[0], 3), (loops[30], 4)])
    assert pairs == [(loops[0], (1, 3)), (loops[30], (4,)), (loops[31], (2,))]


def test_what_decides_about_a_loop():
    loop = PlantLoop("a", op="OP", where="f.csv")
    same = replace(loop, area="x", weight=2.0, stamp="2", size=5, notes=("n",))
    assert plan.definition(loop) == plan.definition(same) != plan.definition(replace(loop, op_span=(0.0, 50.0)))


def test_the_steps_of_an_audit_are_where_they_are_said_to_be():
    assert all(path.startswith("lostmotion.audit.") and ":" in path for path in vars(Steps()).values())
