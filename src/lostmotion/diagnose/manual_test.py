"""A test in manual, in words: steps of OP there and back, which need no model of the actuator."""

from __future__ import annotations

import numpy as np

from lostmotion.compensate.gate import PROCESS
from lostmotion.identify import HammersteinFit
from lostmotion.identify.data import IdentificationData

CYCLES = 3  # up, back, down, back: 12 moves, which is what `identify` needs
SIZES = 1.5  # step over the lost motion that it must cross
SETTLED = 4.0  # time constants of a hold
FEWEST = 5  # samples of a hold
LAST = 10  # samples whose mean is the present value
MARGIN = 0.05  # of the range of PV in the record, beyond which PV is not to go


def present(data: IdentificationData) -> tuple[float, float]:
    """OP and PV at the end of the record."""
    return float(data.u[-LAST:].mean()), float(data.y[-LAST:].mean())


def pv_limits(data: IdentificationData) -> tuple[float, float]:
    """The range of PV in the record and a little more: PV at rest may lie at its edge."""
    low, high = float(data.y.min()), float(data.y.max())
    room = MARGIN * (high - low)
    return float(f"{low - room:.4g}"), float(f"{high + room:.4g}")


def manual_test(fit: HammersteinFit, size: float, integrating: bool, op_span: tuple[float, float]) -> str:
    """Steps, sizes and holds of a test that tells a lost motion from none; safe for a level.

    Parameters
    ----------
    fit : HammersteinFit
        Of the record: its process, where it is known, gives the holds.
    size : float
        Lost motion that the steps must cross, in units of OP.
    integrating : bool
        Whether PV does not settle (a level).
    op_span : (float, float)
        Limits of OP.
    """
    step = min(SIZES * size, 0.5 * (op_span[1] - op_span[0]))
    start = float(np.clip(present(fit.data)[0], op_span[0] + step, op_span[1] - step))
    low, high = pv_limits(fit.data)
    seconds = _hold(fit, step, 0.5 * float(np.ptp(fit.data.y)), integrating)
    if integrating:
        held = f"hold at most {_rounded(seconds)} s" if seconds else "hold only until PV moves"
        last = f"Do not wait for PV to settle, and step back at once where PV leaves {low:g} .. {high:g}."
    else:
        held = f"hold {_rounded(seconds)} s" if seconds else "hold until PV has answered"
        last = f"Step back at once where PV leaves {low:g} .. {high:g}."
    return (
        f"With the controller in manual, step OP from {start:.4g} up by {_rounded(step)}, {held}, step back, hold as "
        f"long; then the same downwards; {CYCLES} times in all. {last}"
    )


def _rounded(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


def _hold(fit: HammersteinFit, step: float, excursion: float, integrating: bool) -> float | None:
    """Seconds of a hold; None where the record does not show the process."""
    linear, dt = fit.linear, fit.data.dt
    if fit.status not in PROCESS or linear.integrates() != integrating:
        return None
    if not integrating:
        seconds = dt * max(linear.delay + SETTLED * linear.slowest_lag(), FEWEST)
        return seconds if seconds < fit.data.u.size * dt / (4 * CYCLES) else None
    answer = linear.step_response(linear.delay + 1000)
    slope = abs(float(answer[-1] - answer[-2])) / dt
    return dt * linear.delay + excursion / (slope * step) if slope > 0.0 else None
