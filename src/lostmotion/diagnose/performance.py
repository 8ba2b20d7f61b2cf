"""How well a loop works, whatever the reason: variance, Harris index, travel, reversals, class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.audit_class import LEAST_INDEX, audit_class
from lostmotion.diagnose.harris import harris_index
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.errors import DataError
from lostmotion.records.movement import reversals_per_hour, share_at_limits, travel_per_hour

if TYPE_CHECKING:
    from lostmotion.identify.data import IdentificationData

NOISE_BANDS = 3.0  # deviations of the moves of OP that are no reversal
WORST_DELAYS = 3  # times the identified delay: the longest that the Harris range looks at


@dataclass(frozen=True)
class Performance:
    """Indices of the record.

    Attributes
    ----------
    variance : float
        Of PV about SP (about its mean where SP is unknown), in units of PV squared.
    harris : (float, float)
        Minimum over actual variance for the identified delay and for three times that, 1 is best; NaN where unknown.
    travel : float
        Moves of OP in % of span per hour.
    reversals : float
        Turns of OP per hour by more than its noise.
    manual, limited : float
        Share of the rows not in automatic, and with OP at a limit.
    audit_class : str
        Excellent, acceptable, fair, poor, or open loop, as in the survey that the paper cites; "unknown" without a
        Harris index.
    loop_type : str
        Whose limits the class uses.
    """

    variance: float
    harris: tuple[float, float]
    travel: float
    reversals: float
    manual: float
    limited: float
    audit_class: str
    loop_type: str

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "variance": self.variance,
            "harris": [None if np.isnan(value) else value for value in self.harris],
            "travel_percent_per_hour": self.travel,
            "reversals_per_hour": self.reversals,
            "share_manual": self.manual,
            "share_at_limits": self.limited,
            "audit_class": self.audit_class,
            "loop_type": self.loop_type,
        }


def measure_performance(
    data: IdentificationData,
    sp: FloatArray | None,
    delay: int,
    span: tuple[float, float],
    oscillation: Oscillation,
    manual: float,
    loop_type: str,
) -> Performance:
    """Indices of the longest piece of a record.

    Parameters
    ----------
    data : IdentificationData
    sp : ndarray or None
        Set point on the rows of the data.
    delay : int
        Of the process, in samples.
    span : (float, float)
        Of OP.
    oscillation : Oscillation
        The stronger of OP and PV.
    manual : float
        Share of the record that was not in automatic.
    loop_type : str
        Key of LEAST_INDEX.
    """
    start, stop = max(data.segments.tolist(), key=lambda pair: pair[1] - pair[0])
    op, pv = data.u[start:stop], data.y[start:stop]
    target = float(pv.mean()) if sp is None else sp[start:stop]
    harris = _harris(pv, target, max(delay, 1))
    limited = share_at_limits(op, span)
    band = NOISE_BANDS * 1.4826 * float(np.median(np.abs(np.diff(op))))
    rated = (
        "unknown" if np.isnan(harris[0]) else audit_class(harris[0], loop_type, oscillation, min(manual + limited, 1.0))
    )
    return Performance(
        float(np.mean((pv - target) ** 2)),
        harris,
        travel_per_hour(op, data.dt, span),
        reversals_per_hour(op, data.dt, band),
        manual,
        limited,
        str(rated),
        loop_type if loop_type in LEAST_INDEX else "other",
    )


def _harris(pv: FloatArray, target: float | FloatArray, delay: int) -> tuple[float, float]:
    try:
        found = harris_index(pv, target, (delay, WORST_DELAYS * delay))
    except DataError:  # too short for the delay, or PV rests at SP
        return np.nan, np.nan
    return found.low, found.high
