"""One valve over runs: its sizes, whether they grow, when a limit is reached, what a repair has changed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from lostmotion.audit.row_facts import ends_percent
from lostmotion.diagnose.pooled.trend_of_size import NORMAL, SizeTrend, size_trend
from lostmotion.errors import ParameterError
from lostmotion.store.rows import DENIED, FAULTS, UNDATED, AssessmentRow, EstimateRow, Stage

DAY = 86400.0
HORIZON = 3650.0  # days: later nobody plans


@dataclass(frozen=True)
class Crossing:
    """When the line through the sizes reaches a limit.

    Attributes
    ----------
    limit : float
        % of span.
    expected : datetime
    earliest : datetime
        95 %.
    latest : datetime, optional
        None: later than ten years after the last size, or never.
    """

    limit: float
    expected: datetime
    earliest: datetime
    latest: datetime | None


@dataclass(frozen=True)
class Change:
    """What a repair has changed.

    Attributes
    ----------
    before, after : (float, float, float), optional
        Size in % of span with its 95 % interval, of all windows before and after together. None: no size there.
    excluded : float, optional
        % of span that the windows after it exclude at best, where they show no fault.
    verdict : str
        "gone", "smaller", "as before", "larger" or "cannot tell".
    """

    before: tuple[float, float, float] | None
    after: tuple[float, float, float] | None
    excluded: float | None
    verdict: str

    def summary(self) -> str:
        """In one sentence."""
        was = "no size before" if self.before is None else f"before {_told(self.before)}"
        now = "no size after" if self.after is None else f"after {_told(self.after)}"
        if self.after is None and self.excluded is not None:
            now = f"after: nothing over {self.excluded:.2g} % of span"
        return f"{self.verdict}: {was}, {now}"


@dataclass(frozen=True)
class LoopHistory:
    """Assessments of one loop, oldest first, one of each window: the one of the latest run.

    Attributes
    ----------
    tag : str
    rows : tuple of AssessmentRow
    trend : SizeTrend
        % of span a day; without dates windows of one record are a day apart as their times say. Of the audits alone.
    live : tuple of EstimateRow
        What was told of the running plant (``lostmotion live --store``), oldest first, in units of OP.
    """

    tag: str
    rows: tuple[AssessmentRow, ...]
    trend: SizeTrend
    live: tuple[EstimateRow, ...] = ()

    @property
    def sized(self) -> tuple[AssessmentRow, ...]:
        """Those that show a lost motion with an interval in % of span."""
        return tuple(row for row in self.rows if _percent(row) is not None)

    @property
    def size(self) -> tuple[float, float, float] | None:
        """Size in % of span with its 95 % interval, of all windows together; None: none, cleared since, or changing.

        Windows count that name the fault of the last one and do not overlap a later one: no data twice. Sizes that
        are excluded are not joined: 95 % limits of several windows have no joint level.
        """
        told = [row for row in self.rows if row.verdict in FAULTS or row.cleared]
        if not self.sized or told[-1].cleared or self.trend.seen:
            return None
        apart: list[AssessmentRow] = []
        for row in reversed(self.sized):
            if row.verdict == self.sized[-1].verdict and all(row.window_end <= one.window_start for one in apart):
                apart.append(row)
        return _together(apart)

    def reaches(self, limit: float) -> Crossing | None:
        """When the size reaches a limit, from its growth; None: it does not surely grow, or is there already.

        Parameters
        ----------
        limit : float
            % of span.

        Raises
        ------
        ParameterError
            The limit is not positive.
        """
        if not limit > 0.0:
            raise ParameterError.expected("a limit above 0 % of span", limit, "4 is bad for a control valve")
        line, sized = self.trend, self.sized
        if not line.interval[0] > 0.0:
            return None
        last = (_middle(sized[-1]) - UNDATED).total_seconds() / DAY
        now = line.at_centre + line.slope * (last - line.centre)
        if now >= limit:
            return None
        days = [(limit - now) / slope for slope in (line.slope, line.interval[1], line.interval[0])]
        if days[0] > HORIZON:
            return None
        moments = [_middle(sized[-1]) + timedelta(days=one) for one in days[:2]]
        latest = _middle(sized[-1]) + timedelta(days=days[2]) if days[2] <= HORIZON else None
        return Crossing(limit, moments[0], moments[1], latest)

    def since(self, moment: datetime) -> Change:
        """Before against after a moment: a repair. A window that holds the moment belongs to neither.

        Parameters
        ----------
        moment : datetime
            With time zone.
        """
        before = [row for row in self.rows if row.window_end <= moment]
        after = [row for row in self.rows if row.window_start >= moment]
        was, now = _together(before), _together(after)
        denied = [row.excluded_percent for row in after if row.verdict in DENIED]
        excluded = min((one for one in denied if one is not None and math.isfinite(one)), default=None)
        return Change(was, now, excluded, _verdict(was, now, excluded))

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        points = [
            {
                "window_start": row.window_start.isoformat(),
                "said": row.said,
                "verdict": row.verdict,
                "percent": _percent(row),
            }
            for row in self.rows
        ]
        live = [
            {"at": row.at.isoformat(), "status": row.status, "width": [row.width, row.low, row.high]}
            for row in self.live
        ]
        return {"tag": self.tag, "windows": points, "trend_percent_of_span": self.trend.to_dict(), "live": live}


def history(rows: Sequence[AssessmentRow], live: Sequence[EstimateRow] = ()) -> LoopHistory:
    """History of one loop from its rows of all runs, in the order of the runs, and estimates of the running plant.

    Raises
    ------
    ParameterError
        No rows, or rows of several loops.
    """
    tags = sorted({row.tag for row in rows})
    if len(tags) != 1:
        raise ParameterError.expected("rows of one loop", f"of {len(tags)}", "choose them by tag")
    latest = {(row.window_start, row.window_end): row for row in rows if row.stage is Stage.ASSESSED}
    ordered = tuple(sorted(latest.values(), key=lambda row: (row.window_start, row.window_end)))
    sizes = [(row, one) for row in ordered if (one := _percent(row)) is not None]
    places = [(_middle(row) - UNDATED).total_seconds() / DAY for row, _ in sizes]
    line = size_trend(places, [one[0] for _, one in sizes], [one[1:] for _, one in sizes], "day")
    return LoopHistory(tags[0], ordered, line, tuple(live))


def _percent(row: AssessmentRow) -> tuple[float, float, float] | None:
    """Size and its ends in % of span."""
    ends = ends_percent(row) if row.kind == "actuator" else None
    return None if ends is None or row.size_percent is None else (row.size_percent, *ends)


def _middle(row: AssessmentRow) -> datetime:
    return row.window_start + (row.window_end - row.window_start) / 2


def _together(rows: Sequence[AssessmentRow]) -> tuple[float, float, float] | None:
    """Weighted mean of the sizes; it is no surer than their scatter allows."""
    sizes = [one for row in rows if (one := _percent(row)) is not None]
    if not sizes:
        return None
    weights = [(max(high - low, 1e-9) / (2.0 * NORMAL)) ** -2 for _, low, high in sizes]
    total = sum(weights)
    mean = sum(weight * one[0] for weight, one in zip(weights, sizes, strict=True)) / total
    misfit = sum(weight * (one[0] - mean) ** 2 for weight, one in zip(weights, sizes, strict=True))
    spread = max(misfit / max(len(sizes) - 1, 1), 1.0)
    reach = NORMAL * math.sqrt(spread / total)
    return mean, mean - reach, mean + reach


def _verdict(
    was: tuple[float, float, float] | None, now: tuple[float, float, float] | None, excluded: float | None
) -> str:
    if was is None:
        return "cannot tell"
    if now is None:
        return "gone" if excluded is not None and excluded < was[1] else "cannot tell"
    if now[2] < was[1]:
        return "smaller"
    return "larger" if now[1] > was[2] else "as before"


def _told(size: tuple[float, float, float]) -> str:
    return f"{size[0]:.2g} % of span ({size[1]:.2g} .. {size[2]:.2g})"
