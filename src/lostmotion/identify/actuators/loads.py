"""What acts on the process beside the actuator: swings of known period, and steps, found in what a model leaves over.

Without them a model of the wrong kind fills the gap: the memory of a backlash in front of the inverse of the controller
is also a filter of PV that keeps steps, and an autoregression of low order does not foretell a sine behind noise. Every
kind of actuator may have its own loads, and pays for each (information criterion), so that a fault which makes
slips and swings by itself is cheaper than the loads that would imitate it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import numpy.typing as npt
from scipy.signal import fftconvolve

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.spectral_lines import (
    FEWEST_PERIODS,
    SHORTEST_PERIOD,
    STANDS_OUT,
    dominant,
    lines,
    share_of,
    strongest,
)
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.family import LinearFamily, Loads, Step, Swing
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.parameters import information_inverse
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.linear import simulate

COST = 1.5  # of log n, in log-likelihood: what a swing or a step must bring, search for its time included
PROMISING = 0.9  # the same at the noise model of the fit, which has taken over a part of every load; then it is tried
# swings and steps together: one more would be explaining, not cleaning; each pays COST log n all the same
MOST_EVENTS = 20
MOST_ROUNDS = 4  # of finding, fitting, finding in what is left; it ends by itself where nothing pays
EDGE = 10  # samples at either end of a segment in which a step cannot be told from what was before, or from noise
SAME = 0.03  # relative difference of two periods that are one
LEAST_SHARE = 0.1  # of the variance of PV
FEW_STEPS = 8  # of a trial: enough to see whether its loads pay; the best is refined to the end


def with_own_loads(fitted: Fitted) -> Fitted:
    """The same model with the loads that its own errors show, where they pay."""
    best = fitted
    for _ in range(MOST_ROUNDS):
        errors = _Errors(best)
        found = errors.loads() or errors.hidden_swing()
        if found is None:
            break
        trial = pruned(loaded(best, best.problem.y, *found))
        if criterion(trial) >= criterion(best) - 1.0:
            break
        best = trial
    return _to_the_end(best)


def _to_the_end(fitted: Fitted) -> Fitted:
    """Converged."""
    if fitted.fit.converged:
        return fitted
    return replace(fitted, fit=refine(fitted.problem, fitted.fit.theta, fitted.basis))


def loaded(fitted: Fitted, y: FloatArray, loads: Loads, sizes: FloatArray) -> Fitted:
    """The model with further loads, everything refined on PV `y` by a few steps."""
    problem, at = fitted.problem, fitted.problem.noise_at
    family = problem.family.with_loads(loads if problem.family.loads is None else problem.family.loads.joined(loads))
    start = np.insert(fitted.fit.theta, at, sizes)
    basis = None
    if fitted.basis is not None:
        rows = np.insert(fitted.basis, [at] * sizes.size, 0.0, axis=0)
        basis = np.hstack([rows, np.eye(start.size)[:, at : at + sizes.size]])
    problem = replace(problem, y=y, family=family)
    return Fitted(problem, refine(problem, start, basis, FEW_STEPS), basis, fitted.rivals)


def pruned(fitted: Fitted) -> Fitted:
    """Without the loads that do not pay."""
    loads = fitted.problem.family.loads
    if loads is None:
        return fitted
    inverse, _ = information_inverse(fitted.fit.hessian, fitted.basis)
    limit = COST * np.log(fitted.problem.errors)
    kept = []
    for index, rows in enumerate(_rows(fitted)):
        size = fitted.fit.theta[rows]
        spread = fitted.variance * inverse[np.ix_(rows, rows)]
        if 0.5 * float(size @ np.linalg.lstsq(spread, size, rcond=1e-12)[0]) > limit:
            kept.append(index)
    return fitted if len(kept) == len(loads.events) else _with_only(fitted, kept)


def without_loads(fitted: Fitted, y: FloatArray | None = None) -> Fitted:
    """Without any of its loads, refined; on another PV where given."""
    if y is not None:
        fitted = replace(fitted, problem=replace(fitted.problem, y=y))
    return fitted if fitted.problem.family.loads is None else _to_the_end(_with_only(fitted, []))


def without_actuator(fitted: Fitted) -> Fitted:
    """The linear model of the same structure with the same loads."""
    problem = fitted.problem
    family = LinearFamily(load=problem.family.load, loads=problem.family.loads)
    dropped = list(range(problem.eta_at, problem.eta_at + len(problem.family.own)))
    problem = replace(problem, family=family)
    start = np.delete(fitted.fit.theta, dropped)
    return Fitted(problem, refine(problem, start, problem.basis), problem.basis)


def without_their_effect(fitted: Fitted, data: ScaledData) -> ScaledData:
    """PV without what the loads of a model do to it."""
    problem, loads = fitted.problem, fitted.problem.family.loads
    if loads is None:
        return data
    parts = fitted.parts
    course = sizes_of_loads(fitted) @ loads.shapes
    y = data.y.copy()
    for start, stop in data.segments:
        y[start:stop] -= simulate(parts.a, parts.b, problem.structure.delay, course[start:stop])
    return replace(data, y=y)


def swings_of(data: ScaledData) -> Loads | None:
    """Swings that stand out in PV and are a good part of it: smaller ones do not bend the process."""
    found = [
        _Option(ratio, Swing(period), start, stop)
        for start, stop in data.segments.tolist()
        for period, ratio in lines(data.y[start:stop])
        if share_of(data.y[start:stop], period) > LEAST_SHARE
    ]
    if not found:
        return None
    return Loads(_shapes(found, data.y.size), tuple(one.event for one in found))


def without_swings(data: ScaledData, loads: Loads) -> ScaledData:
    """OP and PV without their parts at these periods: what a linear process does to the rest is the same."""
    columns = np.column_stack([loads.shapes.T, np.ones(data.u.size)])
    both = np.column_stack([data.u, data.y])
    left = both - columns[:, :-1] @ np.linalg.lstsq(columns, both, rcond=1e-10)[0][:-1]
    return replace(data, u=np.ascontiguousarray(left[:, 0]), y=np.ascontiguousarray(left[:, 1]))


def with_loads(fitted: Fitted, data: ScaledData, loads: Loads) -> Fitted:
    """A model of other signals, refined on these with given loads, and with its own."""
    on_data = replace(fitted, problem=replace(fitted.problem, u=data.u, y=data.y))
    return with_own_loads(pruned(loaded(on_data, data.y, loads, _Errors(on_data).sizes(loads.shapes))))


def sizes_of_loads(fitted: Fitted) -> FloatArray:
    """Sizes of the shapes of its loads."""
    return fitted.fit.theta[[row for rows in _rows(fitted) for row in rows]]


def _rows(fitted: Fitted) -> list[list[int]]:
    """Places of the sizes of every event in the parameter vector."""
    loads, at = fitted.problem.family.loads, fitted.problem.noise_at
    counts = [] if loads is None else [len(event.names) for event in loads.events]
    ends = at - sum(counts) + np.cumsum(counts)
    return [list(range(end - count, end)) for end, count in zip(ends.tolist(), counts, strict=True)]


def _with_only(fitted: Fitted, kept: list[int]) -> Fitted:
    problem, loads = fitted.problem, fitted.problem.family.loads
    assert loads is not None  # noqa: S101  asked only of models with loads
    dropped = [row for index, rows in enumerate(_rows(fitted)) if index not in kept for row in rows]
    start = np.delete(fitted.fit.theta, dropped)
    basis = None
    if fitted.basis is not None:
        inside = ~np.any(fitted.basis[dropped] != 0.0, axis=0)
        basis = np.delete(fitted.basis[:, inside], dropped, axis=0)
    problem = replace(problem, family=problem.family.with_loads(loads.kept(kept)))
    return Fitted(problem, refine(problem, start, basis, FEW_STEPS), basis, fitted.rivals)


@dataclass(frozen=True)
class _Option:
    """An event, what it explains (sum of squares), and the rows of its segment."""

    gain: float
    event: Step | Swing
    start: int
    stop: int

    def courses(self, rows: int) -> FloatArray:
        """Shapes of the event, 0 in other segments: made when asked, as those of all trials would fill the memory."""
        courses = np.zeros((len(self.event.names), rows))
        if isinstance(self.event, Step):
            courses[0, self.event.row : self.stop] = 1.0
            return courses
        phase = 2.0 * np.pi / self.event.period * np.arange(self.stop - self.start)
        courses[0, self.start : self.stop], courses[1, self.start : self.stop] = np.sin(phase), np.cos(phase)
        return courses


def _shapes(options: list[_Option], rows: int) -> FloatArray:
    """Of all events."""
    shapes = np.empty((sum(len(option.event.names) for option in options), rows))
    at = 0
    for option in options:
        shapes[at : at + len(option.event.names)] = option.courses(rows)
        at += len(option.event.names)
    return shapes


class _Errors:
    """Prediction errors of a model, and what loads would do to them."""

    def __init__(self, fitted: Fitted) -> None:
        problem = fitted.problem
        s, n = problem.structure, problem.u.size
        self.fitted = fitted
        self.room = MOST_EVENTS - problem.family.sought
        self.limit = 2.0 * PROMISING * float(np.log(problem.errors)) * fitted.variance
        self.segments = [(start, start + s.start, stop) for start, stop in problem.segments.tolist()]
        self.dominant: dict[tuple[int, int], float | None] = {}
        self.errors = np.zeros(n)
        for (_, first, stop), part in zip(self.segments, problem.predict(fitted.fit.theta)[1], strict=True):
            self.errors[first:stop] = part

    def loads(self) -> tuple[Loads, FloatArray] | None:
        """Loads by orthogonal matching pursuit, and their sizes."""
        left, sizes, rows = self.errors, np.zeros(0), self.errors.size
        columns: list[FloatArray] = []
        options: list[_Option] = []
        gram, target = np.zeros((0, 0)), np.zeros(0)
        response = self._effect(np.ones(rows), 0, rows)
        trials = {each: list(self._options(left, response, *each)) for each in self.segments}
        while len(options) < self.room:
            best = max(chain(*trials.values()), key=lambda option: option.gain, default=None)
            if best is None or not best.gain > self.limit:
                break
            options.append(best)
            for course in best.courses(rows):
                columns.append(self._column(course))
                products = np.array([columns[-1] @ column for column in columns])
                gram = np.block([[gram, products[:-1, None]], [products[None, :-1], products[-1:, None]]])
                target = np.append(target, columns[-1] @ self.errors)
            sizes = _solved(gram, target)
            left = self.errors.copy()
            for size, column in zip(sizes, columns, strict=True):
                left -= size * column
            for each in self.segments:
                if each[0] == best.start:  # what is left elsewhere has not changed
                    trials[each] = list(self._options(left, response, *each))
        columns.clear()
        if not options:
            return None
        return Loads(_shapes(options, rows), tuple(option.event for option in options)), sizes

    def hidden_swing(self) -> tuple[Loads, FloatArray] | None:
        """The line that stands out most from what the model leaves of PV: an AR of high order may hide it in part."""
        if self.room < 1:
            return None
        residuals = self.fitted.output_residual()
        best, gain = None, STANDS_OUT
        for (start, _, stop), residual in zip(self.segments, residuals, strict=True):
            for period, ratio in lines(residual)[:1]:
                if ratio > gain and not self._made_by_the_loop(np.array([period]), start, stop)[0]:
                    best, gain = _Option(0.0, Swing(period), start, stop), ratio
        if best is None:
            return None
        shapes = best.courses(self.errors.size)
        return Loads(shapes, (best.event,)), self.sizes(shapes)

    def _made_by_the_loop(self, periods: FloatArray, start: int, stop: int) -> npt.NDArray[np.bool_]:
        """Which periods are harmonics of the swing of PV, where that is not a load itself.

        What swings from outside does so at its own period first; harmonics alone are made by the actuator.
        """
        if (start, stop) not in self.dominant:
            self.dominant[start, stop] = dominant(self.fitted.problem.y[start:stop])
        whole = self.dominant[start, stop]
        loads = self.fitted.problem.family.loads
        outside = [event.period for event in loads.events if isinstance(event, Swing)] if loads is not None else []
        if whole is None or any(abs(period / whole - 1.0) < SAME for period in outside):
            return np.zeros(periods.size, bool)
        order = whole / periods
        return np.asarray((order > 1.5) & (np.abs(order - np.round(order)) < SAME * order))

    def sizes(self, courses: FloatArray) -> FloatArray:
        """Sizes of loads of given courses, by least squares."""
        table = np.column_stack([self._column(course) for course in courses])
        return np.asarray(np.linalg.lstsq(table, self.errors, rcond=1e-10)[0])

    def _options(self, left: FloatArray, response: FloatArray, start: int, first: int, stop: int) -> Iterator[_Option]:
        """Best step and best swing of a segment."""
        part, skipped = left[start:stop], first - start
        if part.size - skipped > 4 * EDGE:
            w = response[: part.size]
            energy = np.cumsum(w**2)
            norms = energy[::-1].copy()
            if skipped:
                norms[:skipped] -= energy[skipped - 1 - np.arange(skipped)]
            scores = fftconvolve(part, w[::-1])[part.size - 1 :] ** 2 / np.maximum(norms, 1e-9 * energy[-1])
            row = EDGE + int(np.argmax(scores[EDGE:-EDGE]))
            yield _Option(float(scores[row]), Step(start + row), start, stop)
        n = stop - first
        if n > 2 * FEWEST_PERIODS * SHORTEST_PERIOD:
            period, gain = strongest(left[first:stop], lambda periods: self._made_by_the_loop(periods, start, stop))
            yield _Option(gain, Swing(float(period)), start, stop)

    def _column(self, course: FloatArray) -> FloatArray:
        """What a load does to the prediction errors."""
        column = np.zeros(course.size)
        for start, first, stop in self.segments:
            column[first:stop] = self._effect(course, start, stop)[first - start :]
        return column

    def _effect(self, course: FloatArray, start: int, stop: int) -> FloatArray:
        parts, delay = self.fitted.parts, self.fitted.problem.structure.delay
        z = simulate(parts.a, parts.b, delay, np.ascontiguousarray(course[start:stop]))
        result = z.copy()
        add_lagged(parts.d, z[:-1], result[1:])
        return result


def _solved(gram: FloatArray, target: FloatArray) -> FloatArray:
    """Least squares from the products of the columns with each other and with what they are to explain."""
    scale = np.sqrt(np.diag(gram)) + np.finfo(float).tiny
    return np.asarray(np.linalg.lstsq(gram / np.outer(scale, scale), target / scale, rcond=1e-13)[0] / scale)
