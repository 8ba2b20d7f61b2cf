"""A fit in units of the record: what of it goes into the result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.break_away import break_point_ranges, break_points
from lostmotion.identify.actuators.characteristic import slopes
from lostmotion.identify.actuators.directional_lag import asymmetry
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.models import Hammerstein, LinearModel


def chosen_of(fitted: Fitted, scaling: Scaling) -> Chosen:
    """Structure, and what acts beside the actuator."""
    s, loads = fitted.problem.structure, fitted.problem.family.loads
    events = () if loads is None else loads.to_dicts()
    besides = slopes(fitted), asymmetry(fitted)
    found = Chosen(s.na, s.nb, s.delay, s.noise_order, s.integrating, events, s.zero, *besides)
    still, ranges = break_points(fitted), break_point_ranges(fitted)
    if still is None or ranges is None:
        return found
    intervals = _in_op(ranges[0], scaling), _in_op(ranges[1], scaling)
    return replace(found, break_away=_in_op(still, scaling), break_away_intervals=intervals)


def _in_op(pair: tuple[float, float], scaling: Scaling) -> tuple[float, float]:
    low, high = (scaling.u_centre + scaling.u_scale * end for end in pair)
    return low, high


def model_of(values: dict[str, float], fitted: Fitted, data: IdentificationData) -> Hammerstein:
    """Actuator, process and offset of these parameters."""
    s, family = fitted.problem.structure, fitted.problem.family
    linear = LinearModel(
        tuple(values[f"a{i + 1}"] for i in range(s.na)),
        tuple(values[f"b{i}"] for i in range(s.nb + 1)),
        s.delay,
        data.dt,
    )
    return Hammerstein(kind_of(family.kind).actuator(values, family), linear, values.get("offset", data.y_centre))


def on_rows(simulated: list[FloatArray], data: ScaledData, first: int) -> FloatArray:
    """Simulated output in engineering units on the rows of the data; NaN before the first simulated row."""
    rows, scaling = np.full(data.y.size, np.nan), data.scaling
    for (start, stop), z in zip(data.segments, simulated, strict=True):
        rows[start + first : stop] = scaling.y_centre + scaling.y_scale * z
    return rows


def fit_percent_of(data: ScaledData, simulated: list[FloatArray], first: int) -> float:
    """Share of PV about its mean that is simulated, in %."""
    y = np.concatenate([data.y[start + first : stop] for start, stop in data.segments])
    miss = y - np.concatenate(simulated)
    return float(100.0 * (1.0 - np.linalg.norm(miss) / max(float(np.linalg.norm(y - y.mean())), 1e-300)))
