"""What an estimated model says of PV: simulated from OP alone, and predicted from PV up to some samples before."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from lostmotion.arguments import finite, finite_signal, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.pole_filters import all_pole
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.models.noise import white_share
from lostmotion.records.as_record import as_record, as_records
from lostmotion.records.compression import scan_factor
from lostmotion.records.pieces import bridge, clip_to_span
from lostmotion.records.prepare import prepare
from lostmotion.records.record import LoopRecord
from lostmotion.records.resample import pick
from lostmotion.records.sampling import runs

RESTS = np.linspace(-1.0, 1.0, 9).tolist()  # of half the band: where a valve with memory may begin
OP_UNKNOWN = ("stopped", "held OP", "mode", "splice")  # rows in which the valve need not have had the recorded OP
PV_UNKNOWN = ("stopped", "stuck PV", "clipped PV", "outlier")
TOLD = 1e-10  # relative: a direction of the initial state that shows less is not told
ROWS = 4  # of PV without a hole, for each number of the initial state: fewer would blow up its noise
TURNS = 4  # of least squares for the place near the best of these


@dataclass(frozen=True)
class _Begun:
    """A piece begun at one place of the valve: squared errors, simulated PV, and the place that suits them better."""

    squares: float
    simulated: FloatArray
    nearer: float


@dataclass(frozen=True)
class Predictor:
    """A model in engineering units, its noise, and the constant load of an integrating process, None where not known.

    `still`: OP between which a dead zone that is left with a jump does not move.

    The initial state of each piece of a record is estimated from its PV, as in the fit: max(na, nb) numbers by least
    squares on the whitened errors, for a valve with memory the place in its band where it rests at first, and the load
    where it is not known.
    """

    model: Hammerstein
    noise: NoiseModel
    load: float | None = None
    still: tuple[float, float] | None = None

    def from_rest(self, op: Any, pv: float | None) -> FloatArray:
        """PV for an array of OP: the valve rests at the first OP, the process at `pv` (None: at that same OP)."""
        x = self._inner(finite_signal("op", op), None)
        linear, offset = self.model.linear, self.model.offset
        level = None if pv is None else finite("pv", pv)
        if linear.integrates():
            return linear.simulate(x) + (offset if level is None else level)
        before = x[0] if level is None else (level - offset) / linear.gain
        return linear.simulate(x - before) + linear.gain * before + offset

    def from_initial(self, op: Any, initial: Any) -> FloatArray:
        """PV for an array of OP (n,), begun at the state that the first PV (m,) shows; these up to the delay."""
        u, y, delay = finite_signal("op", op), finite_signal("initial", initial), self.model.linear.delay
        fewest = delay + self._states + 1
        if not fewest <= y.size <= u.size:
            expected = f"from {fewest} to {u.size} samples of PV as initial"
            raise ParameterError.expected(expected, y.size, "give the measured PV of the first samples of op")
        found, pv = np.concatenate([y[:delay], np.empty(u.size - delay)]), np.full(u.size - delay, np.nan)
        pv[: y.size - delay] = y[delay:]
        found[delay:] = self._best_begun(u, pv)
        return found

    def on_record(self, record: LoopRecord) -> FloatArray:
        """Simulated PV on the rows of a record; NaN where OP of this row or of the delay before it is missing."""
        scans, rows = self._scans(record)
        return self._placed(self._simulated(scans), rows, len(record))

    def ahead(self, record: LoopRecord, horizon: int) -> FloatArray:
        """PV predicted `horizon` samples ahead on the rows of a record."""
        steps = whole("horizon", horizon, 1)
        scans, rows = self._scans(record)
        return self._placed(self._ahead(scans, steps), rows, len(record))

    def ahead_of(self, op: Any, pv: Any, horizon: int) -> FloatArray:
        """The same of arrays as they are."""
        steps = whole("horizon", horizon, 1)
        signals = finite_signal("op", op), finite_signal("pv", pv)
        return self._ahead(LoopRecord(*signals, dt=self.model.linear.dt), steps)

    def _ahead(self, scans: LoopRecord, steps: int) -> FloatArray:
        predicted = self._simulated(scans)
        gains = self._foretold_by(steps)
        for start, stop in _pieces(scans) if gains.size else ():
            left = scans.pv[start:stop] - predicted[start:stop]
            first = start + steps + gains.size - 1  # before it a PV is needed from before the piece
            if first < stop:
                add_lagged(gains, left[:-steps], predicted[start + steps : stop])
            predicted[start : min(first, stop)] = np.nan
        return predicted

    def _foretold_by(self, steps: int) -> FloatArray:
        """Weights (p,) of v(k), v(k-1) .. in the expectation of v(k + steps)."""
        order = self.noise.order
        if not order:
            return np.zeros(0)
        turn = np.eye(order, k=-1)
        turn[:1] = -np.array(self.noise.d)
        return np.asarray(np.linalg.matrix_power(turn, steps)[:1].ravel())

    def _scans(self, record: LoopRecord) -> tuple[LoopRecord, slice]:
        """The record as the fit takes it, at its sampling time; and its rows."""
        wanted = self.model.linear.dt
        rows = slice(None)
        if not _same(record.dt, wanted):
            factor, phase = scan_factor(record)
            if not _same(record.dt * factor, wanted):
                got = f"one every {record.dt:g} s"
                raise ParameterError.expected(f"a record of one sample every {wanted:g} s", got, "resample it first")
            record, rows = pick(record, factor, phase), slice(phase, None, factor)
        return _trusted(record), rows

    def _simulated(self, record: LoopRecord) -> FloatArray:
        found = np.full(len(record), np.nan)
        for start, stop in _pieces(record):
            found[start:stop] = self._piece(record.op[start:stop], record.pv[start:stop])
        return found

    def _piece(self, u: FloatArray, pv: FloatArray) -> FloatArray:
        """One piece without holes in OP, from the first PV that tells the initial state on; without one from rest."""
        delay = self.model.linear.delay
        starts, lengths = runs(np.isfinite(pv[delay:]))
        enough = starts[lengths > self.noise.order + ROWS * (self._states + 1)]
        if not enough.size:
            return self.from_rest(u, None)
        found = np.full(u.size, np.nan)
        first = delay + int(enough[0])  # a state before it would be told by what is left of it alone
        found[first:] = self._best_begun(u, pv[first:])
        return found

    def _best_begun(self, u: FloatArray, pv: FloatArray) -> FloatArray:
        """Simulated PV on the rows of `pv`, the last of `u`, from the state and the place of the valve that suit it."""
        best = min((self._begun(u, pv, rest) for rest in self._rests), key=lambda one: one.squares)
        for _ in range(TURNS if len(self._rests) > 1 else 0):
            best = min(best, self._begun(u, pv, best.nearer), key=lambda one: one.squares)
        return best.simulated

    def _begun(self, u: FloatArray, pv: FloatArray, rest: float) -> _Begun:
        """The rows of `pv`, the last of `u`, where the valve begins at a place and the process where PV shows."""
        begin = u.size - pv.size - self.model.linear.delay
        x = self._inner(u, rest)
        forced = self._driven(x[begin:]) + self.model.offset
        free = self._free_responses(forced.size)
        errors = self._whitened(pv - forced)
        known = np.isfinite(errors)
        columns = np.array([self._whitened(one)[known] for one in free]).reshape(len(free), -1).T
        state = _solved(columns, errors[known])
        left = errors[known] - columns @ state
        nearer = rest
        if len(self._rests) > 1:
            resting = np.logical_and.accumulate(x == x[0])[begin:]  # as long as the place matters
            stuck = self._driven(self._reach * resting)
            beside = np.column_stack([columns, self._whitened(stuck)[known]])
            nearer += float(_solved(beside, errors[known])[-1])
        return _Begun(float(left @ left), forced + state @ free, nearer)

    def _driven(self, x: FloatArray) -> FloatArray:
        """What x does to PV from row `delay` on, from rest at zero."""
        linear = self.model.linear
        drive = np.zeros(x.size - linear.delay)
        add_lagged(np.array(linear.b), x[: drive.size], drive)
        driven = np.empty(drive.size)
        all_pole(np.array(linear.a), drive, driven)
        return driven

    def _inner(self, u: FloatArray, rest: float | None) -> FloatArray:
        """Internal variable x (n,) with the load, or from its first value where that is not known.

        `rest`: place of a valve with memory, -1 to 1 in its band; None: in its middle.
        """
        valve: Any = self.model.nonlinearity
        if rest is None or len(self._rests) == 1:
            x = np.asarray(valve(u))
        else:
            x = np.asarray(valve.run(u, u[0] + rest * self._reach))
        if self.still is not None:
            x[(u > self.still[0]) & (u < self.still[1])] = 0.0
        if not self.model.linear.integrates():
            return x
        return x - x[0] if self.load is None else x + self.load

    @cached_property
    def _rests(self) -> list[float]:
        """Places to begin at; a single one for a valve without memory, which cannot be run from a place."""
        return RESTS if hasattr(self.model.nonlinearity, "run") else [0.0]

    @cached_property
    def _reach(self) -> float:
        """From the middle of the band of a valve with memory to its end."""
        valve: Any = self.model.nonlinearity
        return 0.5 * float(sum(getattr(valve, name) for name in valve.own))

    @property
    def _states(self) -> int:
        return max(len(self.model.linear.a), len(self.model.linear.b) - 1)

    def _free_responses(self, n: int) -> FloatArray:
        """What each initial state, and a load that is not known, does to PV, shape (states, n)."""
        impulse, response = np.zeros(n), np.empty(n)
        impulse[0] = 1.0
        all_pole(np.array(self.model.linear.a), impulse, response)
        found = np.zeros((self._states, n))
        for lag in range(min(self._states, n)):
            found[lag, lag:] = response[: n - lag]
        if self.load is None and self.model.linear.integrates():
            return np.vstack([found, self._driven(np.ones(n + self.model.linear.delay))])
        return found

    def _whitened(self, v: FloatArray) -> FloatArray:
        """D(q) v; of the first rows, before which the noise is taken as zero, only what they tell."""
        errors = v.copy()
        add_lagged(self._d, v[:-1], errors[1:])
        errors[: self._d.size] *= self._early
        return errors

    @cached_property
    def _d(self) -> FloatArray:
        return np.array(self.noise.d)

    @cached_property
    def _early(self) -> float:
        return float(np.sqrt(white_share(self._d)))

    @staticmethod
    def _placed(values: FloatArray, rows: slice, n: int) -> FloatArray:
        found = np.full(n, np.nan)
        found[rows] = values
        return found


def _trusted(record: LoopRecord) -> LoopRecord:
    """OP as the fit has it where it is missing; OP and PV missing where an identification does not trust them."""
    mended = clip_to_span(bridge(record)[0])[0]
    prepared = prepare(record)
    if len(prepared.record) != len(record):
        return mended  # it repeats a slower scan than that of the fit
    op, pv = mended.op.copy(), mended.pv.copy()
    for (start, stop), piece in zip(prepared.rows, prepared.stretches, strict=True):
        op[start:stop] = piece.op
    for part in prepared.left_out:
        for values, kinds in ((op, OP_UNKNOWN), (pv, PV_UNKNOWN)):
            if part.kind in kinds:
                values[part.start : part.stop] = np.nan
    return replace(mended, op=op, pv=pv)


def _solved(columns: FloatArray, wanted: FloatArray) -> FloatArray:
    """Least squares; what the rows do not tell of is zero."""
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    return np.asarray(np.linalg.lstsq(columns / scale, wanted, rcond=TOLD)[0] / scale)


def _same(one: float, other: float) -> bool:
    return abs(one - other) <= 1e-9 * other


def _pieces(record: LoopRecord) -> Iterator[tuple[int, int]]:
    """Runs of rows with OP, between gaps."""
    there = np.isfinite(record.op)
    edges = {0, len(record), *record.gaps, *(np.flatnonzero(np.diff(there)) + 1).tolist()}
    return ((start, stop) for start, stop in pairwise(sorted(edges)) if there[start])


def as_scans(source: Any) -> Any:
    """What is read as a record; records and arrays as they are."""
    found = as_records(source)
    return as_record(found) if isinstance(found, list) and any(isinstance(one, LoopRecord) for one in found) else found
