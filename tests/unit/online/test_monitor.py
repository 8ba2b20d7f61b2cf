"""OnlineMonitor: what it reports, and that neither cuts nor restarts change it."""

import json
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.files.cells import read_cells
from lostmotion.files.grid import Grid, Rows
from lostmotion.files.layout import Layout
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent, RecursiveEstimate, Trajectory
from lostmotion.models import DeadZone, Hammerstein, LinearModel, NoiseModel
from lostmotion.online import OnlineMonitor
from tests.support.refusals import refusal

NAMES = ("left", "right", "width", "slope_ratio")


@dataclass
class Fake:
    """Estimator whose width grows by 1e-3 a sample, and that starts after 50."""

    seen: list = field(default_factory=list)
    used: int = 0
    period_at: int = 0
    status: Status = Status.OK
    error: float = 0.01
    informed: int | None = None
    changes: tuple = ()

    @property
    def samples(self):
        return len(self.seen)

    @property
    def started(self):
        return self.samples >= 50

    @property
    def width(self):
        return 2.0 + 1e-3 * self.samples

    @property
    def estimate(self):
        values = {"left": -self.width / 2, "right": self.width / 2, "width": self.width, "slope_ratio": 1.0}
        model = Hammerstein(DeadZone(values["left"], values["right"]), LinearModel((), (1.0,)))
        informed = None if self.informed is None else {"left": self.informed, "right": self.samples}
        covariance = np.diag([self.error**2] * 4)
        return RecursiveEstimate(self.status, model, values, covariance, self.samples, NoiseModel((), 0.01), informed)

    @property
    def events(self):
        return tuple(event for event in self.changes if event.sample <= self.samples)

    def run(self, u, y, every=1, use=None):
        self.seen += list(u)
        self.used += int(np.sum(use))
        return Trajectory(np.zeros(0, dtype=np.int64), {}, np.where(np.isnan(y), np.nan, np.asarray(y)))

    def period(self):
        count, self.period_at = self.samples - self.period_at, self.samples
        middle = 2.0 + 1e-3 * (self.samples - count / 2)
        return {"width": middle}, {"width": 0.01}, count

    def to_bytes(self):
        return b""


def rows(n, start=0, pv=None, automatic=None):
    pv = np.zeros(n) if pv is None else pv
    return Rows(np.arange(start, start + n) * 1.0, np.zeros(n), pv, automatic)


def monitor(**settings):
    fake = settings.pop("fake", None) or Fake()
    return OnlineMonitor(fake, dt=1.0, report_every=20, **settings), fake


def reports(found):
    json.dumps(found, allow_nan=False)
    return [message for message in found if message["kind"] == "report"]


def test_reports_come_at_whole_intervals():
    watched, _ = monitor()
    found = reports(watched.take(rows(65)))
    assert [report["sample"] for report in found] == [20, 40, 60]
    assert [report["time"] for report in found] == [19.0, 39.0, 59.0]
    assert [report["status"] for report in found] == ["STARTING", "STARTING", "OK"]
    assert found[0]["width"] is None
    assert found[2]["width"]["value"] == pytest.approx(2.06)
    assert found[2]["width"]["low"] == pytest.approx(2.06 - 0.0196, abs=1e-5)
    assert watched.to_report == 15


JUMPS = {  # seconds from stamp to stamp
    "400 days ahead": lambda n: 400 * 86400.0 * np.arange(n),
    "999 samples ahead": lambda n: 999.0 * np.arange(n),
    "ahead and back": lambda n: 3e7 * (np.arange(n) % 2),
    "a day back": lambda n: 1e9 - 86400.0 * np.arange(n),
}


@pytest.mark.parametrize("jump", list(JUMPS))
@pytest.mark.parametrize("pieces", [1, 7])
def test_who_sets_a_clock_has_no_more_reports(jump, pieces):
    """Samples of gaps are no samples that came: at most ten times the reports of a clock that runs."""
    n = 2000
    layout = Layout("t,OP,PV", ("t", "OP", "PV"), ",", "OP", "PV", "t", None, ".", dt=1.0)
    lines = [b"%r,1.0,%d" % (float(t), k % 7) for k, t in enumerate(JUMPS[jump](n))]
    grid, watch, found = Grid(1.0), OnlineMonitor(Fake(), dt=1.0, report_every=1000), []
    for part in np.array_split(np.arange(n), pieces):
        cells, _ = read_cells([lines[k] for k in part], layout)
        found += watch.take(grid.place(cells, part + 1))
        fake = watch.estimator
        watch = OnlineMonitor.from_bytes(watch.to_bytes(), lambda _, fake=fake: fake)
    assert len(reports(found)) <= 10 * n // 1000
    assert watch.samples > 100 * n


def test_gaps_that_are_usual_change_no_report():
    """A sample in ten is enough; only the report that is nearly all of a long gap is left out."""
    layout = Layout("t,OP,PV", ("t", "OP", "PV"), ",", "OP", "PV", "t", None, ".", dt=1.0)
    times = np.concatenate([10.0 * np.arange(500), 10_000.0 + np.arange(2000)])
    cells, _ = read_cells([b"%r,1.0,2.0" % float(t) for t in times], layout)
    watch = OnlineMonitor(Fake(), dt=1.0, report_every=1000)
    found = reports(watch.take(Grid(1.0).place(cells, np.arange(2500) + 1)))
    assert [one["sample"] for one in found] == [1000, 2000, 3000, 4000, 5000, 7000]


def test_rows_after_the_last_report_are_told_at_the_end_and_the_monitor_stays():
    watched, _ = monitor(width_limit=2.055)
    assert watched.last() == []
    watched.take(rows(40))
    assert watched.last() == []
    watched.take(rows(39, 40))
    kept = watched.to_bytes()
    report, event = watched.last()
    assert (report["sample"], report["status"], report["counts"]["samples"]) == (79, "OK", 79)
    assert (event["sample"], event["name"]) == (79, "width limit")
    assert not watched.calm
    assert watched.to_bytes() == kept
    assert watched.last() == [report, event]
    found = watched.take(rows(1, 79))
    assert [(message["sample"], message["kind"]) for message in found] == [(80, "report"), (80, "event")]


@pytest.mark.parametrize("status", [Status.CANNOT_TELL, Status.INTEGRATING, Status.NOT_CONVERGED, Status.WRONG_GAIN])
def test_a_record_that_does_not_tell_is_not_calm(status):
    watched, _ = monitor(fake=Fake(status=status))
    watched.take(rows(60))
    assert not watched.calm


def test_masked_and_missing_samples_and_outliers_are_counted():
    pv = np.zeros(100)
    pv[[3, 70, 71]] = np.nan
    pv[[10, 80]] = 1.0  # 10 standard deviations; before there is an estimate nobody can tell
    automatic = np.ones(100, dtype=bool)
    automatic[60:65] = False
    watched, fake = monitor(op_limits=(-10.0, 10.0))
    last = reports(watched.take(rows(100, pv=pv, automatic=automatic)))[-1]
    assert last["counts"] == {
        "samples": 100, "missing": 3, "outliers": 1, "manual": 5, "saturated": 0, "frozen": 0,
    }  # fmt: skip
    assert fake.used == 95


def test_trend_and_time_to_the_limit():
    watched, _ = monitor(width_limit=5.0)
    report = reports(watched.take(rows(1600)))[-1]
    trend = report["trend"]
    assert trend["per_day"] == pytest.approx(86.4)
    assert trend["significant"]
    assert trend["width_now"] == pytest.approx(3.6, abs=0.01)
    assert trend["limit"]["time"] == pytest.approx(3000.0, rel=1e-3)
    assert trend["limit"]["earliest"] < 3000.0 < trend["limit"]["latest"]
    assert "in about 0.0162 days" in trend["limit"]["message"]


def test_an_impossible_estimate_is_told_and_ends_nothing():
    class Wild(Fake):
        @property
        def estimate(self):
            if self.samples == 80:
                raise ParameterError.expected("left <= right", "left=1.0, right=-1.0", "swap the break points")
            return super().estimate

    watched, _ = monitor(fake=Wild())
    report = reports(watched.take(rows(80)))[-1]
    assert (report["status"], report["width"]) == ("NOT_CONVERGED", None)
    assert "left=1.0, right=-1.0" in report["message"]
    assert not watched.calm
    assert reports(watched.take(rows(20, 80)))[-1]["status"] == "OK"
    assert watched.calm


def test_an_estimate_that_lags_behind_the_trend_is_told():
    class Slow(Fake):
        @property
        def width(self):
            return 2.0 + 8e-4 * self.samples

    watched, _ = monitor(fake=Slow())
    report = reports(watched.take(rows(1600)))[-1]
    assert "By the trend the width is 3.6" in report["lag"]
    watched, _ = monitor()
    assert reports(watched.take(rows(1600)))[-1]["lag"] is None


def test_width_above_its_limit_is_told_once():
    watched, _ = monitor(width_limit=2.1)
    assert watched.calm is False  # no estimate yet
    found = watched.take(rows(1000))
    events = [message for message in found if message["kind"] == "event"]
    assert [(event["name"], event["sample"]) for event in events] == [("width limit", 120)]
    assert not watched.calm
    assert reports(found)[-1]["trend"]["limit"]["state"] == "reached"


def test_changes_are_told_at_once_with_their_times():
    change = ChangeEvent(70, 61, "right", 1.0, 1.5, 0.05)
    watched, _ = monitor(fake=Fake(changes=(change,)))
    assert [message["kind"] for message in watched.take(rows(69))] == ["report"] * 3
    found = watched.take(rows(1, 69))
    assert [message["kind"] for message in found] == ["event"]
    assert (found[0]["time"], found[0]["since"], found[0]["name"]) == (69.0, 60.0, "right")
    assert "right break point has moved from 1 to 1.5" in found[0]["message"]
    assert watched.take(rows(5, 70)) == []


def test_no_information_since():
    watched, _ = monitor(fake=Fake(informed=400))
    assert reports(watched.take(rows(1400)))[-1]["no_information"] is None
    stale = reports(watched.take(rows(20, 1400)))[-1]["no_information"]
    assert [(each["name"], each["since"], each["samples"]) for each in stale] == [("left", 399.0, 1020)]


@pytest.mark.parametrize("status", [Status.NOT_SEEN, Status.CANNOT_TELL])
def test_nothing_is_claimed_that_is_not_known(status):
    watched, _ = monitor(fake=Fake(status=status))
    report = reports(watched.take(rows(60)))[-1]
    assert report["left"] == {"value": None, "standard_error": None, "low": None, "high": None}
    assert report["width"]["high"] is not None


def test_infinite_errors_become_null():
    watched, _ = monitor(fake=Fake(error=np.inf))
    assert reports(watched.take(rows(60)))[-1]["width"] == {
        "value": pytest.approx(2.06), "standard_error": None, "low": 0.0, "high": None,
    }  # fmt: skip


def test_a_clock_that_begins_anew_does_not_bend_the_trend():
    watched, _ = monitor()
    watched.take(rows(800))
    again = Rows(np.arange(800) * 1.0, np.zeros(800), np.zeros(800), None, np.array([0]))
    trend = reports(watched.take(again))[-1]["trend"]
    assert trend["per_day"] == pytest.approx(86.4)
    assert trend["fits"]


def test_settings_are_checked():
    refusal(ParameterError, monitor, trend_every=30)
    refusal(ParameterError, monitor, width_limit=-1.0)
    refusal(ParameterError, OnlineMonitor, Fake(), dt=0.0)


def grown(n, seed=0):
    """Open-loop record whose right break point steps from 1 to 2 halfway, with trouble in it."""
    rng = np.random.default_rng(seed)
    u = lm.signals.prs(n, -5, 5, hold=8, seed=seed)
    linear = LinearModel((-0.8,), (0.2,), 1)
    x = np.where(np.arange(n) < n // 2, DeadZone(-1, 1)(u), DeadZone(-1, 2)(u))
    y = linear.simulate(x) + 0.05 * rng.normal(size=n)
    y[rng.random(n) < 0.002] = np.nan
    y[rng.random(n) < 0.002] += 5.0
    automatic = np.ones(n, dtype=bool)
    automatic[n // 4 : n // 4 + 30] = False
    time = np.arange(n) * 1.0
    time[3 * n // 4 :] += 5000.0
    return Rows(time, u, y, automatic)


def real(**settings):
    estimator = lm.RecursiveML(1, 0, 1, noise="white", start_samples=300)
    return OnlineMonitor(estimator, dt=1.0, report_every=100, trend_every=300, width_limit=2.5, **settings)


ONE_BY_ONE = [*range(0, 1900, 100), *range(1900, 2300), *range(2300, 4000, 100)]  # about the step at row 2000


@pytest.fixture(scope="module")
def whole():
    watched = real(op_limits=(-5, 5), frozen=50, calendar="UTC")
    return watched.take(grown(4000)), watched.to_bytes()


@pytest.mark.statistics
@pytest.mark.parametrize(
    "cuts",
    [[*range(0, 1900, 100), *range(1900, 2300), *range(2300, 4000, 100)], range(0, 4000, 37), range(0, 4000, 1000)],
)
def test_cuts_and_restarts_change_nothing(whole, cuts):
    record, watched, found = grown(4000), real(op_limits=(-5, 5), frozen=50, calendar="UTC"), []
    for start, stop in pairwise([*cuts, 4000]):
        found += watched.take(record.part(start, stop))
        if stop - start > 1 or start % 100 == 0:
            watched = OnlineMonitor.from_bytes(watched.to_bytes())
    assert found == whole[0]
    assert watched.to_bytes() == whole[1]


@pytest.mark.statistics
def test_a_step_is_seen(whole):
    events = [message for message in whole[0] if message["kind"] == "event"]
    assert {event["name"] for event in events} >= {"right", "width limit"}
    assert all(2000 < event["sample"] < 2600 for event in events)
    last = reports(whole[0])[-1]
    assert last["status"] == "OK"
    assert abs(last["right"]["value"] - 2.0) < 5 * last["right"]["standard_error"]
    assert last["counts"]["outliers"] > 0


def test_other_bytes_are_refused():
    refusal(DataError, OnlineMonitor.from_bytes, b"something else")
    refusal(DataError, OnlineMonitor.from_bytes, real().to_bytes()[:-5])
    refusal(DataError, OnlineMonitor.from_bytes, lm.RecursiveML(1, 0, 1).to_bytes())
