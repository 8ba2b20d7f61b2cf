"""Is what a fit claims earned by the record? What a process cannot be, or the record cannot show, is no result."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import Status
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.likelihood.fitted import Fitted

CLAIMS = (Status.OK, Status.MISFIT, Status.COLOURED, Status.WIDE)  # that a kind, or none, is what the record shows
SAME = 1e-4  # of the range of PV: noise and the lag of any process leave more
FEWEST_MOVES, MOST_ROWS = 10, 5000  # of OP in either direction, and of the rows in which they are looked for
LEAST_MOVE = 1e-3  # of the range of OP: a loop that has settled hardly moves either
LINE = 1e-18  # of the mean square of PV: what a straight line leaves over where only rounding is left
ROUNDING = 1e-8  # of the mean square of PV: less is left over by nothing that was measured
FEWEST_REVERSALS = 6  # of OP: with fewer, as in a test of a few steps, no lost motion is denied
PIECES, SHORTEST = 10, 20  # of a record at least, in which drift is a straight line, and the rows of one


def same_signal(u: FloatArray, y: FloatArray) -> bool:
    """Whether PV is an exact function of OP in the same sample.

    Behind a process PV at a value of OP differs between OP on its way up and on its way down.
    """
    u, y = u[:MOST_ROWS], y[:MOST_ROWS]
    if _off_a_line(y, u) <= LINE * float(y @ y):
        return True
    moves, least = np.diff(u, prepend=u[0]), LEAST_MOVE * float(np.ptp(u))
    up, down = np.flatnonzero(moves > least), np.flatnonzero(moves < -least)
    if min(up.size, down.size) < FEWEST_MOVES:
        return False
    up = up[np.argsort(u[up], kind="stable")]
    inside = down[(u[down] >= u[up[0]]) & (u[down] <= u[up[-1]])]
    if inside.size < FEWEST_MOVES:
        return False
    off = np.abs(y[inside] - np.interp(u[inside], u[up], y[up]))
    return bool(np.median(off) <= SAME * float(np.ptp(y)))


def reversals(u: FloatArray, segments: IntArray) -> int:
    """How often OP turns round.

    Parameters
    ----------
    u : ndarray, shape (n,)
    segments : ndarray, shape (s, 2)

    Examples
    --------
    >>> reversals(np.array([0.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 3.0]), np.array([[0, 8]]))
    2
    """
    moves = [np.sign(np.diff(u[start:stop])) for start, stop in segments.tolist()]
    return sum(int(np.count_nonzero(np.diff(part[part != 0.0]))) for part in moves)


def fit_without_drift(y: FloatArray, simulated: FloatArray, segments: IntArray) -> float:
    """Fit of a simulation in % where drift does not count: a straight line in every cycle of PV.

    A cycle is two crossings of the mean; pieces are no longer than a tenth of the record, and no shorter than 20 rows.

    Parameters
    ----------
    y, simulated : ndarray, shape (n,)
        Rows without simulation hold NaN.
    segments : ndarray, shape (s, 2)
    """
    crossings = int(np.count_nonzero(np.diff(y > y.mean())))
    length = max(min(2 * y.size // max(crossings, 1), y.size // PIECES), SHORTEST)
    missed = moved = 0.0
    for start, stop in segments.tolist():
        rows = np.arange(start, stop)[np.isfinite(simulated[start:stop])]
        for piece in np.array_split(rows, max(rows.size // length, 1)):
            if piece.size >= SHORTEST:
                missed += _off_a_line(y[piece] - simulated[piece], piece)
                moved += _off_a_line(y[piece], piece)
    return 100.0 * (1.0 - float(np.sqrt(missed / moved))) if moved > 0.0 else 0.0


def _off_a_line(values: FloatArray, along: npt.NDArray[Any]) -> float:
    """Sum of squares beside the best straight line."""
    values, along = values - values.mean(), along - along.mean()
    return max(float(values @ values - (along @ values) ** 2 / max(float(along @ along), 1e-300)), 0.0)


def inverse_of_controller(fitted: Fitted, evidence: Evidence) -> bool:
    """Whether nothing but an exact controller moves OP, and the model leaves nothing over: either explains the record.

    With noise in PV, or set-point moves, an exact controller does no harm.
    """
    left = fitted.fit.cost / max(float(fitted.problem.y @ fitted.problem.y), 1e-300)
    return evidence.exact_feedback and left < ROUNDING


def earned(
    claimed: Status,
    fitted: Fitted,
    evidence: Evidence,
    data: IdentificationData,
    values: Mapping[str, float],
    simulated: FloatArray,
    fit_percent: float,
) -> Status:
    """The status that is claimed, or why it is not earned.

    A process slower than the record is not seen to settle, so neither its gain nor that it settles at all is known;
    one that integrates is called so. Who gives orders of 0 has asked for a static characteristic. `simulated` (n,) is
    in units of PV.
    """
    s = fitted.problem.structure
    if s.na + s.nb + s.delay > 0 and same_signal(data.u, data.y):
        return Status.SAME_SIGNAL
    if inverse_of_controller(fitted, evidence):
        return Status.CANNOT_TELL
    if claimed not in CLAIMS:
        return claimed
    kind = kind_of(fitted.problem.family.kind)
    if not kind.met(fitted):
        return Status.CANNOT_TELL
    if kind.size is not None and values[kind.size] > kind.largest_share * float(np.ptp(data.u)):
        return Status.NEAR_RANGE
    if fitted.drifts(int(np.diff(data.segments).max())):
        return Status.NO_PROCESS
    if not s.c and fit_percent <= 0.0 and fit_without_drift(data.y, simulated, data.segments) <= 0.0:
        return Status.NOT_REPRODUCED
    return Status.FEW_CROSSINGS if like_a_slip(evidence) else claimed


def like_a_slip(evidence: Evidence) -> bool:
    """Whether nothing but the controller moves OP, and hardly through the dead zone: a valve that slips does so."""
    alone = evidence.exact_feedback
    return alone and not evidence.crossed_enough
