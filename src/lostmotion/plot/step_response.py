"""The panel of the process: what PV does after a step behind the valve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.identify import HammersteinFit
from lostmotion.models import LinearModel
from lostmotion.plot.style import MODEL, calm, labelled
from lostmotion.plot.time_axis import set_ticks, unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FEWEST_SAMPLES, TIME_CONSTANTS = 20, 5.0  # that are drawn
RATE_UNITS = ((1.0, "s"), (60.0, "min"), (3600.0, "h"))  # the shortest in which PV moves by LEAST_RATE
LEAST_RATE = 0.01


def draw_step_response(axes: Axes, fit: HammersteinFit) -> None:
    """Draw the step response of the linear part; of a process that does not settle its slope is given, not its gain.

    Where the fit shows no fault, the linear part is that of the linear model.
    """
    process = (fit.linear_alternative or fit).linear
    data = fit.data
    unsettled = process.integrates(1.0 / data.y.size)  # or its time constant is longer than the record
    samples = min(process.delay + max(FEWEST_SAMPLES, int(TIME_CONSTANTS * _lag(process, unsettled))), data.y.size)
    length = samples * data.dt
    unit = unit_of(length)
    response = process.step_response(samples)
    axes.step(np.arange(samples) * data.dt / unit.seconds, response, where="post", color=MODEL, lw=1.5)
    if unsettled:
        end = response[-max(samples // 4, 2) :]
        rate = _rate(float(end[-1] - end[0]) / (end.size - 1) / data.dt, data.pv_unit, data.op_unit)
        title = f"Process {'integrates' if process.integrates() else 'does not settle within the record,'} {rate}"
    else:
        axes.axhline(process.gain, color="0.6", lw=0.8, ls="--")
        per = f" {data.pv_unit} per {data.op_unit}" if data.pv_unit and data.op_unit else ""
        title = f"Process: step response, gain {process.gain:.3g}{per}"
    set_ticks(axes, unit, length)
    calm(axes, title, unit.label, labelled("PV", data.pv_unit))


def _lag(process: LinearModel, unsettled: bool) -> float:
    """Slowest time constant in samples, but for that of the pole at which the process does not settle."""
    poles = process.poles
    if unsettled:
        poles = np.delete(poles, np.argmin(np.abs(poles - 1.0)))
    slowest = float(np.abs(poles).max(initial=0.0))
    return -1.0 / np.log(slowest) if 0.0 < slowest < 1.0 else 0.0


def _rate(a_second: float, pv_unit: str, op_unit: str) -> str:
    """Slope of PV for a unit of OP behind the valve, in the shortest unit of time in which PV moves noticeably."""
    seconds, name = next((one for one in RATE_UNITS if abs(a_second) * one[0] >= LEAST_RATE), RATE_UNITS[-1])
    return f"{a_second * seconds:.3g} {pv_unit or 'PV'}/{name} per {op_unit or 'unit of OP'}"
