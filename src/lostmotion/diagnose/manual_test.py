"""A test in manual, in words: steps of OP there and back, which need no model of the actuator."""

from __future__ import annotations

import numpy as np

from lostmotion.compensate.gate import PROCESS
from lostmotion.identify import HammersteinFit
from lostmotion.identify.data import IdentificationData

# up, back, down, back: with large steps, and with small ones. `identify` needs 12 moves, and steps of one size are
# three levels of OP, on which a sound valve and a dead zone about the middle are one
CYCLES = 2  # of each
SIZES = 1.5  # step over the lost motion that it must cross
NOT_EXCLUDED = 0.75  # the same over the largest that a record does not exclude: back and down together are two steps
SMALL = 0.8  # small step over the tolerance: friction below a step that PV answers cannot be seen nor excluded
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


def manual_test(
    fit: HammersteinFit,
    size: float,
    integrating: bool,
    op_span: tuple[float, float],
    tolerance: float | None = None,
    largest: float = 0.0,
) -> str:
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
    tolerance : float, optional
        Lost motion that does not matter, in units of OP; None: `size`.
    largest : float
        Lost motion that the record does not exclude: crossed as well, as far as OP has moved in the record.
    """
    within = 0.5 * float(np.ptp(fit.data.u))
    step = min(max(SIZES * size, min(NOT_EXCLUDED * largest, within)), 0.5 * (op_span[1] - op_span[0]))
    small = SMALL * (size if tolerance is None else tolerance)
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
        f"long; then the same downwards; twice, then twice with steps of {_rounded(small)}. {last}"
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
        return seconds if seconds < fit.data.u.size * dt / (8 * CYCLES) else None
    answer = linear.step_response(linear.delay + 1000)
    slope = abs(float(answer[-1] - answer[-2])) / dt
    return dt * linear.delay + excursion / (slope * step) if slope > 0.0 else None
