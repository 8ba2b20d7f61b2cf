"""Harris index of a window at its natural time scale, the delay from a cheap linear process."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.control_error.swing import thinned, usual_place
from lostmotion.diagnose.harris import harris_index
from lostmotion.errors import DataError

ROWS = 8192
ORDER = 12  # of the regression: so many rows of PV and of OP are looked back
PER_CORNER = 8.0  # rows in the period of the corner: what is faster is noise, what is slower needs no more rows
SURE = 4.0  # deviations from which on a coefficient of OP is there; of 12 one in 1,600 by chance
SMALLEST = 1e-12  # of the power: less is none


def natural_factor(corner: float, dt: float) -> int:
    """Rows to a block, so that the fastest motion above the noise keeps eight."""
    return max(int(1.0 / (corner * dt * PER_CORNER)), 1)


def harris_of(error: FloatArray, op: FloatArray, factor: int) -> float | None:
    """Minimum over actual variance of the error of control; None where no answer to OP is seen.

    Parameters
    ----------
    error, op : ndarray, shape (n,)
        NaN where they do not count.
    factor : int
        Rows to a block: OP is that of its last row, the error the mean.
    """
    slow = thinned(error, factor)
    place = usual_place(slow, ROWS)
    if place is None:
        return None
    rows = slice(place, place + ROWS)
    part = _longest_known(slow[rows], op[factor - 1 :: factor][: slow.size][rows])
    if part is None:
        return None
    delay = first_answer(*part)
    if delay is None:
        return None
    try:
        return harris_index(part[0], 0.0, delay).low
    except DataError:  # too short, or at rest
        return None


def _longest_known(error: FloatArray, op: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """The longest piece without a missing row."""
    known = np.isfinite(error) & np.isfinite(op)
    edges = np.flatnonzero(np.diff(np.r_[False, known, False].astype(np.int8)))
    if not edges.size:
        return None
    starts, stops = edges[::2], edges[1::2]
    longest = int(np.argmax(stops - starts))
    rows = slice(int(starts[longest]), int(stops[longest]))
    return (error[rows], op[rows]) if rows.stop - rows.start > 8 * ORDER else None


def first_answer(error: FloatArray, op: FloatArray) -> int | None:
    """Rows after which the error first answers to OP, by least squares; None where it is not seen to."""
    spread, reach = float(error.std()), float(op.std())
    if not (spread > 0.0 and reach > 0.0):
        return None
    y, u = (error - error.mean()) / spread, (op - op.mean()) / reach
    if not (np.isfinite(y).all() and np.isfinite(u).all()):
        return None
    count = y.size - ORDER
    columns = [signal[ORDER - lag : ORDER - lag + count] for signal in (y, u) for lag in range(1, ORDER + 1)]
    design = np.stack(columns, axis=1)
    gram = design.T @ design
    gram[np.diag_indices_from(gram)] += SMALLEST * count
    inverse = np.linalg.inv(gram)
    coefficients = inverse @ (design.T @ y[ORDER:])
    left = y[ORDER:] - design @ coefficients
    deviation = np.sqrt(np.maximum(float(left @ left) / count * np.diag(inverse), 1e-300))
    seen = np.flatnonzero(np.abs(coefficients[ORDER:]) > SURE * deviation[ORDER:])
    return int(seen[0]) + 1 if seen.size else None
