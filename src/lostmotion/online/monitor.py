"""OnlineMonitor: rows -> estimator -> reports and events, the same however the rows are cut."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any, Self

import numpy as np

from lostmotion.arguments import positive, whole
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.files.grid import Rows
from lostmotion.identify import RecursiveEstimate, RecursiveML, WatchingEstimator
from lostmotion.online import messages
from lostmotion.online.masks import Masks
from lostmotion.online.packing import pack, unpack
from lostmotion.online.stored import REMEDY, check_monitor
from lostmotion.online.timeline import Timeline
from lostmotion.online.trend import Trend

KIND = "lostmotion online monitor 1"
TREND_REPORTS = 10  # reports to a point of the trend
UNTOLD = (Status.CANNOT_TELL, Status.INTEGRATING, Status.NOT_CONVERGED, Status.WRONG_GAIN)
# One in so many samples of a report has come, the others are gaps: else whoever sets a clock has as many reports as he
# likes. A record with fewer samples identifies nothing.
SPARSE = 10
OUTLIER = 4.0  # standard deviations of the prediction error: what counts as one in the reports


class OnlineMonitor:
    """Watches one loop.

    Parameters
    ----------
    estimator : WatchingEstimator
        Takes the samples that are not masked.
    dt : float
        Sampling time in seconds.
    report_every : int
        Samples from report to report; one in ten of them must have come, the rest may be gaps.
    trend_every : int, optional
        Samples to one point of the trend of the width; ten reports by default.
    op_limits, frozen : optional
        See :class:`lostmotion.online.masks.Masks`.
    width_limit : float, optional
        Width of the dead zone, in units of OP, at which something has to be done. It may be set anew at any time.
    calendar : "", "local" or "UTC"
        What the times of the rows are; see :class:`lostmotion.files.layout.Layout`.

    Examples
    --------
    >>> import lostmotion as lm
    >>> loop = lm.routine_operation(4000, drift="none", seed=0)
    >>> monitor = OnlineMonitor(lm.RecursiveML(3, 2, 3, dt=0.1), dt=0.1, report_every=2000)
    >>> last = monitor.take(Rows(loop.time, loop.command, loop.measured))[-1]
    >>> last["kind"], last["sample"], last["status"], abs(last["width"]["value"] - 2.0) < 0.1
    ('report', 4000, 'OK', True)
    """

    def __init__(
        self,
        estimator: WatchingEstimator,
        *,
        dt: float,
        report_every: int = 1000,
        trend_every: int | None = None,
        op_limits: tuple[float, float] | None = None,
        frozen: int | None = None,
        width_limit: float | None = None,
        calendar: str = "",
    ) -> None:
        self.estimator = estimator
        self.dt = positive("dt", dt)
        self.report_every = whole("report_every", report_every, 1)
        self.trend_every = whole("trend_every", trend_every or TREND_REPORTS * report_every, 1)
        if self.trend_every % self.report_every:
            raise ParameterError.expected(
                f"trend_every as a multiple of report_every = {report_every}", trend_every, "choose another"
            )
        self.masks = Masks(op_limits, frozen)
        self.width_limit = None if width_limit is None else positive("width_limit", width_limit)
        self.timeline = Timeline(self.dt, calendar)
        self.trend = Trend()
        self.counts = {"missing": 0, "outliers": 0}
        self._limit_told = False
        self._failure = ""  # why the last report had no estimate
        self._told = 0  # sample of the last event told
        self._period_from: float | None = None  # running time at which the period of the next trend point began
        self._came = 0  # samples since the last report for which a row has come
        self._sigma = float("nan")  # of the prediction error, at the last report

    @property
    def samples(self) -> int:
        """Samples taken, missing and masked ones included."""
        return self.estimator.samples

    @property
    def to_report(self) -> int:
        """Samples to the next report."""
        return self.report_every - self.samples % self.report_every

    @property
    def calm(self) -> bool:
        """There is an estimate that tells, of all rows taken, and the width is not known to be above its limit."""
        estimate, _ = self._estimate()
        return estimate is not None and estimate.status not in UNTOLD and not self._above(estimate)

    def take(self, rows: Rows) -> list[dict[str, Any]]:
        """Take rows; return the reports and events that they bring, in order, JSON-ready."""
        found: list[dict[str, Any]] = []
        first = 0
        while first < len(rows):
            stop = min(len(rows), first + self.to_report)
            self._learn(rows.part(first, stop))
            found += self._events()
            if self.samples % self.report_every == 0:
                report, *events = self._report()
                if SPARSE * self._came >= self.report_every:
                    self._came = 0
                    found.append(report)
                found += events
            first = stop
        return found

    def last(self) -> list[dict[str, Any]]:
        """Report on the rows that no report has told of, if there are any; the monitor stays as it is."""
        return copy.deepcopy(self)._report() if self.samples % self.report_every else []

    def _learn(self, rows: Rows) -> None:
        if self._period_from is None:
            self._period_from = float(rows.time[0]) - self.dt
        self.timeline.take(self.samples, rows)
        use = self.masks.use(rows)
        self._came += rows.came
        errors = self.estimator.run(rows.op, rows.pv, every=len(rows), use=use).errors
        self.counts["missing"] += int(np.isnan(rows.op + rows.pv).sum())
        self.counts["outliers"] += int((np.abs(errors) > OUTLIER * self._sigma).sum())

    def _events(self) -> list[dict[str, Any]]:
        """Changes that were not told yet."""
        new = [event for event in self.estimator.events if event.sample > self._told]
        self._told = max([self._told, *(event.sample for event in new)])
        return [messages.change(event, self.timeline) for event in new]

    def _report(self) -> list[dict[str, Any]]:
        estimate, self._failure = self._estimate()
        if estimate is not None and estimate.noise is not None:
            self._sigma = estimate.noise.variance**0.5
        if self.samples % self.trend_every == 0:
            self._trend_point()
        self.timeline.anchor(self.samples)
        report = messages.report(estimate, self.samples, self.timeline, self._failure)
        report["trend"] = messages.trend(self.trend.line, self.width_limit, self.timeline)
        report["lag"] = messages.lag(estimate, self.trend.line, self.timeline)
        report["counts"] = {"samples": self.samples, **self.counts, **self.masks.counts}
        return [report, *self._limit(estimate)]

    def _estimate(self) -> tuple[RecursiveEstimate | None, str]:
        """Present estimate; one outside the valid set is told in the report and ends no service."""
        try:
            return (self.estimator.estimate if self.estimator.started else None), ""
        except ParameterError as error:
            return None, str(error)

    def _trend_point(self) -> None:
        begin, now = self._period_from, self.timeline.running
        self._period_from = now
        period = self.estimator.period()
        if period is None or begin is None:
            return
        values, errors, count = period
        if not len(self.trend):
            begin = max(begin, now - count * self.dt)  # the first window is not in it
        if np.isfinite(errors["width"]) and errors["width"] > 0:
            self.trend.add(0.5 * (begin + now), values["width"], errors["width"])

    def _limit(self, estimate: RecursiveEstimate | None) -> list[dict[str, Any]]:
        """Tell once that the width is above its limit, with the confidence of its interval."""
        if estimate is None or self.width_limit is None:
            return []
        before, self._limit_told = self._limit_told, self._above(estimate)
        new = self._limit_told and not before
        return [messages.above_limit(estimate, self.width_limit, self.samples, self.timeline)] if new else []

    def _above(self, estimate: RecursiveEstimate) -> bool:
        """Whether the width is above its limit: as before while the limit is within the interval."""
        if self.width_limit is None:
            return False
        width = messages.number(estimate, "width")
        low, high = width["low"], width["high"]
        above = low is not None and low > self.width_limit
        return above or (self._limit_told and not (high is not None and high < self.width_limit))

    def to_bytes(self) -> bytes:
        """Whole state; :meth:`from_bytes` continues bit by bit where this one stands."""
        header = {
            "settings": self._settings,
            "counts": self.counts,
            "masks": self.masks.state,
            "timeline": self.timeline.state,
            "trend": self.trend.to_dict(),
            "period_from": self._period_from,
            "limit_told": self._limit_told,
            "failure": self._failure,
            "told": self._told,
            "came": self._came,
            "sigma": None if np.isnan(self._sigma) else self._sigma,
        }
        return pack(KIND, header, self.estimator.to_bytes())

    @property
    def _settings(self) -> dict[str, Any]:
        return {
            "dt": self.dt,
            "report_every": self.report_every,
            "trend_every": self.trend_every,
            "op_limits": self.masks.op_limits,
            "frozen": self.masks.frozen,
            "width_limit": self.width_limit,
            "calendar": self.timeline.calendar,
        }

    @classmethod
    def from_bytes(cls, data: bytes, estimator: Callable[[bytes], WatchingEstimator] = RecursiveML.from_bytes) -> Self:
        """Monitor from the bytes of :meth:`to_bytes`.

        Raises
        ------
        DataError
            The bytes are something else, of another version, or damaged.
        """
        header, blob = unpack(KIND, data)
        check_monitor(header)
        settings = header["settings"]
        if settings["op_limits"] is not None:
            settings["op_limits"] = tuple(settings["op_limits"])
        try:
            new = cls(estimator(blob), **settings)
        except ParameterError as error:
            raise DataError.expected("settings of a monitor in a state", str(error)[:200], REMEDY) from error
        new.counts = header["counts"]
        new.masks.state = header["masks"]
        new.timeline.state = header["timeline"]
        new.trend = Trend.from_dict(header["trend"])
        new._period_from = header["period_from"]
        new._failure = header["failure"]
        new._came = header.get("came", new.samples % new.report_every)  # earlier versions: as if there were no gaps
        new._limit_told, new._told = header["limit_told"], header["told"]
        new._sigma = float("nan") if header["sigma"] is None else header["sigma"]
        return new
