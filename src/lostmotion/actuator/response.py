"""ActuatorResponse: the dead band, resolution, rate and lag of an actuator whose position was measured."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief, between
from lostmotion.records import LoopRecord
from lostmotion.summary import Summary

CANNOT_TELL = "cannot tell"
NONE = "none"
# of a finding in the position: the kind is right in 71 of 75 simulated positioners that are named
# (benchmarks/positioners.py, seeds 200 to 305)
SEEN_CONFIDENCE = 0.95


class ActuatorStatus(Enum):
    """Outcome of :func:`lostmotion.actuator_response`; the value is the sentence that a report prints."""

    SEEN = "The position shows the dead band directly."
    LOAD = "The position moves at a constant command, pushed by a load that reverses: its range is the lost motion."
    NONE = "The position follows OP without a dead band that matters."
    FLAT = "OP or the position does not move. Record moves of OP of at least 5 % of span in both directions."
    SHORT = "Fewer than 30 samples of OP and position. Record longer."
    COARSE = (
        "OP moves in steps that are larger than the dead band may be, so a hold cannot be seen. "
        "Record a slow ramp, or steps of 0.25 % of span, in both directions."
    )
    FAST = (
        "The position follows with a lag or a rate limit that hides the dead band at this speed of OP. "
        "Record slower moves of OP, or sample faster."
    )
    AMBIGUOUS = (
        "A dead band is seen, but play and stick-slip fit alike: single slips are too near the noise of the position. "
        "Record a slow ramp with a finer resolution."
    )
    OPEN = "No dead band is seen, but one that matters is not excluded. Record slow moves of OP in both directions."
    WIDE = "A dead band is seen, but not how wide it is. Record slow moves of OP that reverse at least four times."

    @property
    def identified(self) -> bool:
        """Whether a kind is named."""
        return self in (ActuatorStatus.SEEN, ActuatorStatus.LOAD, ActuatorStatus.NONE)


@dataclass(frozen=True, eq=False, repr=False)
class ActuatorResponse(Brief):
    """Result of :func:`lostmotion.actuator_response`. Frozen; prints, draws and writes itself.

    The words are those of ISA-75.25.01 and IEC 60534-9, estimated from operating data instead of a step test.

    Attributes
    ----------
    kind : str
        "none"; "backlash": the position follows at a distance that depends on the direction (play); "stiction": it
        holds until OP is far enough away and then catches up (stick-slip, dead band of a positioner); "cannot tell".
    dead_band : float
        Full width in units of OP: how far OP moves, from one end of the band to the other, without motion. For stick
        and slip twice the distance of OP from the position at which it moves. 0 of "none", NaN where not known.
    interval : (float, float)
        95 % interval of it; of "none" (0, largest that is not excluded); (0, inf) where nothing is known.
    up, down : float
        Dead band by direction: twice the median distance of OP from the position at which a hold ends upwards, and
        downwards. Where no hold is seen: `dead_band`.
    resolution : float
        Smallest step of the motion in units of OP: a slip, or the resolution of the measurement where that is larger.
    rate_limit : float
        Largest speed in units of OP a second; inf where the record shows none.
    lag : float
        Time constant and dead time of the positioner in seconds.
    offset : float
        OP minus position in the middle of the dead band.
    status : ActuatorStatus
    events : int
        Holds or reversals on which the dead band rests.
    span : (float, float)
        Span of OP that percentages refer to.
    record : LoopRecord
    predicted : ndarray, shape (n,)
        Position of the fitted actuator; empty where none was fitted.
    """

    kind: str
    dead_band: float
    interval: tuple[float, float]
    status: ActuatorStatus
    up: float = np.nan
    down: float = np.nan
    resolution: float = np.nan
    rate_limit: float = np.inf
    lag: float = np.nan
    offset: float = np.nan
    events: int = 0
    span: tuple[float, float] = (0.0, 100.0)
    record: LoopRecord = field(repr=False, kw_only=True)
    predicted: FloatArray = field(repr=False, default_factory=lambda: np.empty(0))

    @property
    def message(self) -> str:
        """Sentence of the status: what the record shows, else what to record."""
        return self.status.value

    @property
    def percent(self) -> float:
        """1 % of span, in units of OP."""
        return 0.01 * (self.span[1] - self.span[0])

    def percent_text(self, size: float) -> str:
        """Size in % of span, two digits."""
        return f"{float(f'{size / self.percent:.2g}'):.9g} %"

    @property
    def finding(self) -> str:
        """Kind and size: one sentence."""
        low, high = self.interval
        if self.kind == NONE:
            return f"NO DEAD BAND larger than {self.percent_text(high)} of span."
        if self.kind == CANNOT_TELL:
            size = f": a dead band of at most {self.percent_text(high)} of span" if np.isfinite(high) else ""
            return f"CANNOT TELL{size}."
        between = f"({self.percent_text(low)[:-2]} .. {self.percent_text(high)[:-2]})"
        return f"{self.kind.upper()}: dead band {self.percent_text(self.dead_band)} of span {between}."

    @property
    def dead_band_percent(self) -> float:
        """Dead band in % of span."""
        return self.dead_band / self.percent

    @property
    def interval_percent(self) -> tuple[float, float]:
        """Interval of the dead band in % of span."""
        return self.interval[0] / self.percent, self.interval[1] / self.percent

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        size = between(*self.interval) if np.isfinite(self.interval[1]) else ""
        return f"{self.kind} {size}".strip(), self.status.name

    def summary(self) -> Summary:
        """Report as text: dead band, resolution, rate, lag and offset, in units of OP and in % of span."""
        return Summary(_verbs.text(self), self)

    def plot(self, **options: Any) -> Any:
        """Figure: OP and position over time, and OP minus position over OP with the dead band.

        ``figure=`` draws into a matplotlib Figure or SubFigure instead of a new one, ``ax=`` the trend alone into an
        Axes. Needs the extra ``lostmotion[plot]``; returns the matplotlib Figure.

        Raises
        ------
        ParameterError
            Both `figure` and `ax`.
        """
        return _verbs.plot(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Unknown and infinite numbers become None."""
        names = ("dead_band", "up", "down", "resolution", "rate_limit", "lag", "offset", "dead_band_percent")
        return {
            "fingerprint": self.record.fingerprint,
            "kind": self.kind,
            "status": self.status.name,
            "message": self.message,
            **{name: _finite(getattr(self, name)) for name in names},
            "interval_95": [_finite(end) for end in self.interval],
            "events": self.events,
            "span": list(self.span),
        }

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    def __str__(self) -> str:
        return self.summary()


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
