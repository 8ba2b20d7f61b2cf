"""The structure of a model that was chosen, or given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self


@dataclass(frozen=True)
class Chosen:
    """Structure of the linear part and the noise, and what acts beside the actuator.

    Attributes
    ----------
    na, nb, delay : int
        Orders, B having nb + 1 coefficients; delay in samples.
    noise_order : int
        Of its D(q).
    integrating : bool
        Whether A has a root at 1.
    loads : tuple of dict
        Swings ("period", in samples) and steps ("step_at", a row) of load.
    slopes : tuple of float, optional
        Of a characteristic that bends, at the lowest and the highest position of the valve, over its mean slope, which
        is that of the model; None: it is straight.
    asymmetry : tuple of float, optional
        Of a lag that differs with direction: by this share it is faster than its mean upwards, and away from PV at OP
        0, and slower the other way; the mean is that of the model. None: it is the same in all directions.
    break_away : tuple of float, optional
        OP between which a dead zone with a jump does not move; its `left` and `right` are where the lines beyond reach
        zero. `fit.simulate` has the jump, `fit.model` has not. None: it begins to move there.
    break_away_intervals : tuple of (float, float), optional
        95 % interval of either.
    noise_zero : float
        Zero of the noise; 0: it is autoregressive.
    """

    na: int
    nb: int
    delay: int
    noise_order: int
    integrating: bool = False
    loads: tuple[Mapping[str, float], ...] = ()
    noise_zero: float = 0.0
    slopes: tuple[float, float] | None = None
    asymmetry: tuple[float, float] | None = None
    break_away: tuple[float, float] | None = None
    break_away_intervals: tuple[tuple[float, float], tuple[float, float]] | None = None

    @property
    def periods(self) -> tuple[float, ...]:
        """Of the swings, in samples."""
        return tuple(load["period"] for load in self.loads if "period" in load)

    @property
    def steps(self) -> int:
        """Number of steps of load."""
        return sum("step_at" in load for load in self.loads)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {**asdict(self), "loads": [dict(load) for load in self.loads]}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        pairs = {name: _pair(data.get(name)) for name in ("slopes", "asymmetry", "break_away")}
        ranges = data.get("break_away_intervals")
        intervals = None if ranges is None else tuple(map(_pair, ranges))
        return cls(**{**data, "loads": tuple(data.get("loads", ())), **pairs, "break_away_intervals": intervals})


def _pair(saved: Any) -> tuple[float, float] | None:
    return None if saved is None else (float(saved[0]), float(saved[1]))
