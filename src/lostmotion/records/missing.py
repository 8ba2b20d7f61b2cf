"""Scattered missing samples of OP and PV: their most likely values given the rows before and after.

A piece of a record costs its initial states and may look back no further than the shortest piece, so cutting at
single missing samples costs far more than these. OP and PV together follow a vector autoregression: the process in one
direction, the controller in the other. The missing values are those that make its squared errors, weighted by their
covariance, smallest: the conditional expectation of a Gaussian process. In closed loop OP alone nearly gives the PV
of its row; a PV from its neighbours alone would contradict what the controller did with it, and sizes would be biased.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.records.quantum import quantum
from lostmotion.records.record import LoopRecord
from lostmotion.records.sampling import Bools, runs, short_gaps

ORDERS = (12, 6, 3)  # samples: the noise models of a fit reach back so far; fewer where few rows are complete
ROWS_PER_COEFFICIENT = 10  # complete rows at least, or the autoregression itself is noise
MAX_FIT_ROWS = 20_000  # more do not make the coefficients better than the values need
MAX_RESIDUAL = 6.0  # standard deviations of PV: beyond, the controller did something else (a move by hand, of SP)
MAX_JUMP = (
    12.0  # the same, with the process alone: beyond, the transmitter failed, and samples are not missing by chance
)
NEGLIGIBLE = 1e-10  # relative: directions that the rows do not tell of
EXACT = 1e-12  # of the variance: a controller without noise of its own is known no better


@dataclass(frozen=True, eq=False)
class _Autoregression:
    """Whitened errors: sum over lags of weights[lag] @ (PV, OP) minus inputs @ known, each of shape (2,)."""

    weights: FloatArray
    inputs: FloatArray

    @property
    def order(self) -> int:
        return len(self.weights) - 1


def bridge_missing(record: LoopRecord, usable: Bools, missing: Bools) -> tuple[LoopRecord, Bools]:
    """Fill short runs of missing OP or PV between usable rows.

    Parameters
    ----------
    record : LoopRecord
    usable, missing : ndarray of bool, shape (n,)
        Rows that are used as they are, and rows that are not used only because OP or PV is missing.

    Returns
    -------
    bridged : LoopRecord
        The record itself where nothing was filled.
    rows : ndarray of bool, shape (n,)
        Rows that were filled: runs of at most `limits.BRIDGE_ROWS` rows. In the first rows of a piece, which the
        autoregression needs, and where PV jumps, nothing is.

    Examples
    --------
    >>> pv = np.sin(np.arange(400) / 20.0)
    >>> op = np.cos(np.arange(400) / 20.0)
    >>> holed = np.where(np.arange(400) % 50 == 30, np.nan, pv)
    >>> bridged, rows = bridge_missing(LoopRecord(op, holed, dt=1.0), ~np.isnan(holed), np.isnan(holed))
    >>> int(rows.sum()), bool(np.allclose(bridged.pv, pv, atol=1e-3))
    (8, True)
    """
    nothing = np.zeros(len(record), dtype=np.bool_)
    wanted = short_gaps(record) & missing
    for start, length in zip(*runs(wanted), strict=True):
        wanted[start : start + length] &= usable[start - 1] and usable[start + length]
    if not wanted.any():
        return record, nothing
    values = np.column_stack([record.pv, record.op])
    centre, scale = np.nanmean(values, axis=0), np.nanstd(values, axis=0)
    if not scale.all():
        return record, nothing
    values = (values - centre) / scale
    values[~(usable | wanted)] = np.nan
    inputs = _inputs(record, usable | wanted)
    for order in ORDERS:
        model = _fitted(values, inputs, _windows(record, usable, order), order)
        if model is not None:
            filled, rows = _most_likely(record, values, inputs, model, usable, wanted)
            pv, op = (filled * scale + centre).T
            return replace(record, pv=_completed(record.pv, pv), op=_completed(record.op, op)), rows
    return record, nothing


def _inputs(record: LoopRecord, rows: Bools) -> FloatArray:
    """What is known of each row besides: one, and SP of this row and of the row before where it moves; (n, 1 or 3)."""
    one = np.ones((len(record), 1))
    sp = record.sp
    if sp is None or np.isnan(sp[rows]).any() or np.ptp(sp[rows]) == 0.0:
        return one
    known = np.where(rows, sp, sp[rows].mean())
    known = (known - known.mean()) / known.std()
    return np.column_stack([one, known, np.r_[known[:1], known[:-1]]])


def _windows(record: LoopRecord, known: Bools, order: int) -> Bools:
    """Rows that are known together with `order` rows before them, without a gap between; shape (n,)."""
    begins = np.zeros(len(record), dtype=np.bool_)
    begins[[row for row in record.gaps if 0 < row < len(record)]] = True
    return ~(_any_before(~known, order + 1) | _any_before(begins, order))


def _any_before(flags: Bools, width: int) -> Bools:
    """Whether any of the last `width` flags is set; the rows before the first one count as set."""
    padded = np.r_[np.ones(width - 1, dtype=np.bool_), flags]
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, width).any(axis=1))


def _fitted(values: FloatArray, inputs: FloatArray, complete: Bools, order: int) -> _Autoregression | None:
    """Least squares over complete rows; None where these are too few."""
    rows = np.flatnonzero(complete)
    unknowns = 2 * order + inputs.shape[1]
    if len(rows) < ROWS_PER_COEFFICIENT * unknowns:
        return None
    rows = rows[:: -(-len(rows) // MAX_FIT_ROWS)]
    past = values[rows[:, None] - np.arange(1, order + 1)].reshape(len(rows), -1)
    regressors = np.hstack([past, inputs[rows]])
    found = np.linalg.lstsq(regressors, values[rows], rcond=NEGLIGIBLE)[0]
    errors = values[rows] - regressors @ found
    whiten = _whitening(errors.T @ errors / (len(rows) - unknowns))
    lags = -found[: 2 * order].reshape(order, 2, 2).transpose(0, 2, 1)
    return _Autoregression(whiten @ np.concatenate([np.eye(2)[None], lags]), found[2 * order :] @ whiten.T)


def _whitening(covariance: FloatArray) -> FloatArray:
    """Matrix (2, 2) that makes errors white, those of PV first; an exact relation keeps a little variance."""
    deviation = np.sqrt(np.maximum(np.diag(covariance), EXACT))
    correlation = covariance / np.outer(deviation, deviation) + EXACT * np.eye(2)
    return np.asarray(np.linalg.inv(np.linalg.cholesky(correlation)) / deviation)


def _most_likely(
    record: LoopRecord, values: FloatArray, inputs: FloatArray, model: _Autoregression, usable: Bools, wanted: Bools
) -> tuple[FloatArray, Bools]:
    """Values with the missing ones filled, and the rows that were; rows near each other are filled together."""
    order, rows = model.order, wanted
    while True:  # a row that cannot be filled takes those with it that look back on it
        whole = _windows(record, usable | rows, order)
        if not (rows & ~whole).any():
            break
        rows = rows & whole
    filled, done = values.copy(), rows.copy()
    chosen = np.flatnonzero(rows)
    for part in np.split(chosen, np.flatnonzero(np.diff(chosen) > order) + 1) if len(chosen) else ():
        near = np.arange(part[0], min(part[-1] + order + 1, len(values)))
        near = near[whole[near]]
        filled[part], residual = _solved(values, inputs, model, near, part, errors=2)
        if residual > MAX_RESIDUAL:  # only the process is as elsewhere: OP is held, as an actuator does
            values[part, 1] = _held(values[part[0] - 1 : part[-1] + 1, 1])[part - part[0] + 1]
            filled[part], residual = _solved(values, inputs, model, near, part, errors=1)
        if residual > MAX_JUMP:
            filled[part], done[part] = np.nan, False
    return filled, done


def _held(signal: FloatArray) -> FloatArray:
    """Signal whose missing values are the last one before, the first being known."""
    return signal[np.maximum.accumulate(np.where(np.isnan(signal), 0, np.arange(len(signal))))]


def _solved(
    values: FloatArray, inputs: FloatArray, model: _Autoregression, rows: IntArray, part: IntArray, errors: int
) -> tuple[FloatArray, float]:
    """Values (k, 2) of the rows `part` that make the first (PV) or both errors of `rows` smallest; largest of PV."""
    weights = model.weights[:, :errors]
    window = np.nan_to_num(values[rows[:, None] - np.arange(model.order + 1)])
    known = np.einsum("kij,tkj->ti", weights, window) - inputs[rows] @ model.inputs[:, :errors]
    cells = np.argwhere(np.isnan(values[part]))
    if not len(cells):
        return values[part], 0.0
    lag = rows[:, None] - part[cells[:, 0]]
    reached = (lag >= 0) & (lag <= model.order)
    effect = weights[np.where(reached, lag, 0), :, cells[:, 1]] * reached[:, :, None]  # (row, cell, error)
    columns = effect.transpose(0, 2, 1).reshape(-1, len(cells))
    missing = np.linalg.lstsq(columns, -known.ravel(), rcond=NEGLIGIBLE)[0]
    left = known + (columns @ missing).reshape(known.shape)
    solved = values[part]
    solved[cells[:, 0], cells[:, 1]] = missing
    return solved, float(np.abs(left[:, 0]).max())


def _completed(signal: FloatArray, values: FloatArray) -> FloatArray:
    """Signal with values where it has none: none beyond the recorded ones, and on their levels where these show."""
    gone = np.isnan(signal) & ~np.isnan(values)
    levels = np.unique(signal[~np.isnan(signal)])
    within = np.clip(values[gone], levels[0], levels[-1])
    if quantum(signal) > 0.0:
        after = np.clip(np.searchsorted(levels, within), 1, len(levels) - 1)
        before = levels[after - 1]
        within = np.where(within - before <= levels[after] - within, before, levels[after])
    completed = signal.copy()
    completed[gone] = within
    return completed
