"""What one estimate is worth beside the truth, and what many are worth together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray

BREAK_POINTS = ("left", "right")
WITHIN = 3.0  # expected standard errors: what counts as found
Score = dict[str, float | int | None]


@dataclass(frozen=True)
class CaseResult:
    """One loop, what was found on it, and what could have been.

    Attributes
    ----------
    index, closed, coloured, order, process, delay, snr_db, share : as in ``RandomLoop``
    identifiable : bool
        The expected 95 % intervals of both break points are narrower than a third of the width.
    delay_told : bool
        The record tells the delay: models of the true orders with one sample more or less fit clearly worse.
    truth, expected : dict of float
        True values and the standard errors that the record allows: left, right, width, slope_ratio.
    found, reported : dict of float
        Estimates and the standard errors that came with them; NaN where there is none.
    intervals : dict of (float, float)
        Reported 95 % intervals of left and right.
    status, usable : str, bool
        Status of the fit, and whether it says that the numbers can be used.
    orders, delay_found : (na, nb) and samples of the fit; None without one.
    error : str or None
        What the estimator raised.
    seconds : float
        CPU time of the estimator.
    """

    index: int
    closed: bool
    coloured: bool
    order: int
    process: str
    delay: int
    snr_db: float
    share: float
    identifiable: bool
    delay_told: bool
    truth: dict[str, float]
    expected: dict[str, float]
    found: dict[str, float]
    reported: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    status: str
    usable: bool
    orders: tuple[int, int] | None
    delay_found: int | None
    error: str | None
    seconds: float

    def miss(self, name: str) -> float:
        """Error in expected standard errors."""
        return (self.found[name] - self.truth[name]) / self.expected[name]

    @property
    def within(self) -> bool:
        """Both break points within three expected standard errors."""
        return all(abs(self.miss(name)) <= WITHIN for name in BREAK_POINTS)

    @property
    def success(self) -> bool:
        """Found, and said to be usable."""
        return self.within and self.usable

    def covered(self, name: str) -> bool:
        """The reported interval holds the truth."""
        low, high = self.intervals[name]
        return low <= self.truth[name] <= high

    @property
    def honest(self) -> bool:
        """The status does not vouch for the numbers, or both reported intervals hold the truth."""
        return self.error is None and (not self.usable or all(self.covered(name) for name in BREAK_POINTS))

    def row(self) -> dict[str, Any]:
        """Flat, for a table."""
        plain = asdict(self)
        flat = {name: value for name, value in plain.items() if not isinstance(value, dict | tuple)}
        flat["na"], flat["nb"] = self.orders or (None, None)
        for part in ("truth", "expected", "found", "reported"):
            flat |= {f"{part}_{name}": value for name, value in plain[part].items()}
        for name, (low, high) in self.intervals.items():
            flat |= {f"low_{name}": low, f"high_{name}": high}
        return {**flat, "within": self.within, "success": self.success, "honest": self.honest}


GROUPS: dict[str, Callable[[CaseResult], bool]] = {
    "all": lambda _: True,
    "open loop": lambda case: not case.closed,
    "closed loop": lambda case: case.closed,
    "white noise": lambda case: not case.coloured,
    "coloured noise": lambda case: case.coloured,
    "order 1": lambda case: case.order == 1,
    "order 2": lambda case: case.order == 2,
    "order 3": lambda case: case.order == 3,
    "real poles": lambda case: case.process == "real",
    "complex poles": lambda case: case.process == "complex",
    "integrating": lambda case: case.process == "integrating",
}


def score(cases: Sequence[CaseResult]) -> Score:
    """Figures of one group of cases; None where no case bears on it.

    success : identifiable cases found (break points within three expected standard errors) and said to be usable;
    within : found, whatever the status; coverage : reported 95 % intervals of left and right that hold the truth;
    delay : exact; delay_told : the same where the record tells it; bias and efficiency : mean and root mean square
    of the error in expected standard errors, over the cases found (the others are no question of efficiency);
    honest : unidentifiable cases that are refused or whose intervals hold the truth. Shares are in 0 .. 1.
    """
    can = [case for case in cases if case.identifiable]
    cannot = [case for case in cases if not case.identifiable]
    misses = np.array([case.miss(name) for case in can if case.within for name in BREAK_POINTS])
    times = np.array([case.seconds for case in cases])
    return {
        "cases": len(cases),
        "identifiable": len(can),
        "success": _share([case.success for case in can]),
        "within": _share([case.within for case in can]),
        "coverage": _share([case.covered(name) for case in can for name in BREAK_POINTS]),
        "delay": _share([case.delay_found == case.delay for case in can]),
        "delays_told": sum(case.delay_told for case in can),
        "delay_told": _share([case.delay_found == case.delay for case in can if case.delay_told]),
        "bias": _of(np.mean, misses),
        "efficiency": _of(lambda values: np.sqrt(np.mean(values**2)), misses),
        "honest": _share([case.honest for case in cannot]),
        "refused": _share([not case.usable for case in cannot]),
        "errors": sum(case.error is not None for case in cases),
        "seconds_median": _of(np.median, times),
        "seconds_worst": _of(np.max, times),
    }


def _share(hits: list[bool]) -> float | None:
    return float(np.mean(hits)) if hits else None


def _of(figure: Callable[[FloatArray], Any], values: FloatArray) -> float | None:
    return float(figure(values)) if values.size else None
