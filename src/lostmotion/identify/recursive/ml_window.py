"""The batch fit of a first window, and whether the recursion may begin from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, Status
from lostmotion.identify.data import FEWEST_SAMPLES
from lostmotion.identify.estimate import identify_alone
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.records import LoopRecord
from lostmotion.records.quantum import quantum

GROSS = 20.0  # times the range of 98 % of the samples: no signal of a plant, but a code for a failure
OUTLIER = 6.0  # median deviations beyond which a residual of the first window is drawn in
MEDIAN = 1.4826  # standard deviation of normal noise over its median absolute deviation
GOOD = (Status.OK, Status.MISFIT, Status.COLOURED, Status.WIDE, Status.FEW_CROSSINGS)
CLEAR_WIDTH, CLEAR_RATIO = 0.1, 0.3  # relative standard errors with which a first window may begin
# the same of the static gain: a start with 0.28 (16.7 for 6.7) ended at the bound of the slope ratio and stayed there
CLEAR_GAIN = 0.25
COARSE = 1.5  # deviations of the errors, rounding among them: steps of 1.7 deviations of the noise
RESTING = 0.9  # share of rows in which OP stays as it was
SURE = 3.0  # standard errors of a break point by which OP stood inside
# values of OP: through few of them another dead zone with other slopes, gain and offset goes as well, to the last digit
FEWEST_PLACES = 10
CLEAR_WINDOW = 2  # times the first window: from then on a dead zone that is known less well may begin
UNSEEN_WINDOW = 4  # times the first window: that there is no dead zone is believed later than a dead zone
LARGEST_WINDOW = 8  # times the first window: how long a start may wait for information


@dataclass(frozen=True)
class Window:
    """Samples of the start, NaN where missing or masked; u and y in engineering units."""

    u: FloatArray
    y: FloatArray

    def segments(self, shortest: int) -> IntArray:
        """Start and stop of the stretches without a missing sample."""
        good = np.concatenate([[False], np.isfinite(self.u) & np.isfinite(self.y), [False]])
        edges = np.flatnonzero(np.diff(good.astype(np.int8)))
        pairs = edges.reshape(-1, 2)
        return np.asarray(pairs[pairs[:, 1] - pairs[:, 0] >= shortest])

    @property
    def places(self) -> int:
        """At how many values u stood."""
        return int(np.unique(self.u[np.isfinite(self.u)]).size)

    @property
    def plausible(self) -> Window:
        """The same with samples of u or y missing that are far out of the range of nearly all others."""
        return Window(_without_gross(self.u), _without_gross(self.y))


def _without_gross(values: FloatArray) -> FloatArray:
    known = values[np.isfinite(values)]
    if not known.size:
        return values
    low, high = np.quantile(known, [0.01, 0.99])
    gross = (values < low - GROSS * (high - low)) | (values > high + GROSS * (high - low))
    return np.where(gross & (high > low), np.nan, values)


def fit_window(window: Window, settings: Settings) -> tuple[HammersteinFit, Window] | None:
    """Batch fit of a start window, and the window with outliers drawn in; None where nothing can be fitted."""
    noise = settings.noise if isinstance(settings.noise, int) else 0
    segments = window.segments(max(3 * (sum(settings.orders) + noise) + 40, FEWEST_SAMPLES))  # what identify takes
    if not len(segments):
        return None
    try:
        fit = _fit(window.u, window.y, segments, settings)
        drawn = _drawn_in(fit, window.y, segments)
        if drawn is None:
            return fit, window
        return _fit(window.u, drawn, segments, settings), Window(window.u, drawn)
    except (DataError, np.linalg.LinAlgError):  # constant, or nearly: no information yet
        return None


def _fit(u: FloatArray, y: FloatArray, segments: IntArray, settings: Settings) -> HammersteinFit:
    records = [LoopRecord(op=u[start:stop], pv=y[start:stop], dt=settings.dt) for start, stop in segments]
    return identify_alone(records, "dead zone", settings.orders, settings.noise, settings.offset)


def may_begin(fit: HammersteinFit, waited: float, places: int) -> bool:
    """Whether the recursion may begin from this fit after a wait of so many first windows, u at so many values in them.

    A process that integrates is never followed.
    """
    accepted = (*GOOD, Status.NOT_SEEN) if waited >= UNSEEN_WINDOW else GOOD
    if waited >= LARGEST_WINDOW:
        accepted = (*accepted, Status.ONE_SIDED)
    clear = waited >= CLEAR_WINDOW or is_clear(fit)
    anchored = waited >= LARGEST_WINDOW or is_anchored(fit)
    seen = waited >= LARGEST_WINDOW or places >= FEWEST_PLACES
    placed = waited >= LARGEST_WINDOW or is_placed(fit)
    return fit.status in accepted and clear and anchored and placed and seen and not fit.chosen.integrating


def is_clear(fit: HammersteinFit) -> bool:
    """Whether the dead zone is known so well that the fit is hardly a wrong maximum (docs/online.md, false events)."""
    errors, values = fit.standard_errors, fit.parameters
    wide = errors["width"] < CLEAR_WIDTH * values["width"]
    return bool(wide and errors["slope_ratio"] < CLEAR_RATIO * values["slope_ratio"])


def is_placed(fit: HammersteinFit) -> bool:
    """Whether OP stood inside the dead zone, where there clearly is one.

    Where it never did, zone and offset slide along together, and the first OP inside is an error of many deviations,
    which the noise model takes for its own.
    """
    errors, values = fit.standard_errors, fit.parameters
    if errors["width"] >= CLEAR_WIDTH * values["width"]:
        return True
    low, high = values["left"] + SURE * errors["left"], values["right"] - SURE * errors["right"]
    return bool(np.any((fit.data.u > low) & (fit.data.u < high)))


def is_coarse(fit: HammersteinFit, y: FloatArray) -> bool:
    """Whether PV is rounded to steps beyond its noise, and OP rests: PV repeats then, and one rounding error stays.

    Where OP moves all the time a PV that repeats is stuck, and errors of rounding come and go like noise.
    """
    rests = np.mean(np.diff(fit.data.u) == 0.0) > RESTING
    return bool(rests and quantum(y) > COARSE * math.sqrt(fit.noise.variance))


def is_anchored(fit: HammersteinFit) -> bool:
    """Whether the static gain is known.

    Where it is not, poles stand next to 1, and what was linearised there counts as certainty for good.
    """
    return bool(fit.standard_errors["gain"] < CLEAR_GAIN * abs(fit.parameters["gain"]))


def _drawn_in(fit: HammersteinFit, y: FloatArray, segments: IntArray) -> FloatArray | None:
    """The same y with outliers drawn in to what still passes for noise; None where there are none."""
    errors = fit.residuals
    spread = MEDIAN * float(np.median(np.abs(errors - np.median(errors))))
    if spread == 0.0 or not np.any(np.abs(errors) > OUTLIER * spread):
        return None
    skipped = fit.chosen.delay + fit.chosen.noise_order
    result, at = y.copy(), 0
    for start, stop in segments:
        size = stop - start - skipped
        e = errors[at : at + size]
        result[start + skipped : stop] -= e - np.clip(e, -OUTLIER * spread, OUTLIER * spread)
        at += size
    return result
