"""What acts on the process beside the actuator: swings of known period, and steps, found in what a model leaves over.

Without them a model of the wrong kind fills the gap: the memory of a backlash in front of the inverse of the controller
is also a filter of PV that keeps steps, and an autoregression of low order does not foretell a sine behind noise. Every
kind of actuator may have its own loads, and pays for each (information criterion), so that a fault which makes
slips and swings by itself is cheaper than the loads that would imitate it. In a test, where OP is held long and moved
by hand, no steps are sought: at the moves they would imitate any actuator.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, own_pages
from lostmotion.identify.actuators.spectral_lines import (
    AT_ONCE,
    FEWEST_PERIODS,
    SHORTEST_PERIOD,
    STANDS_OUT,
    dominant,
    lines,
    share_of,
    strongest,
)
from lostmotion.identify.likelihood.courses import Loads, Step, Swing, courses_of, forget
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.family import LinearFamily
from lostmotion.identify.likelihood.feedback import held_by_hand
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.noise_order import autoregressions
from lostmotion.identify.likelihood.parameters import information_inverse
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine, settled
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.likelihood import add_lagged
from lostmotion.kernels.linear import simulate
from lostmotion.kernels.pole_filters import all_pole

COST = 1.5  # of log n, in log-likelihood: what a swing or a step must bring, search for its time included
PROMISING = 0.9  # the same at the noise model of the fit, which has taken over a part of every load; then it is tried
# swings and steps together: one more would be explaining, not cleaning; each pays COST log n all the same
MOST_EVENTS = 20
MOST_ROUNDS = 4  # of finding, fitting, finding in what is left; it ends by itself where nothing pays
MOST_BY_HAND = 0  # steps in a test of few moves
EDGE = 10  # samples at either end of a segment in which a step cannot be told from what was before, or from noise
SAME = 0.03  # relative difference of two periods that are one
LEAST_SHARE = 0.1  # of the variance of PV
# of noise model and sizes by turns before the refinement: the noise model has taken over a part of every load, and from
# there the likelihood may be flat (of 110 trials 17 end 1 to 160 higher so, two 10 and 34 lower)
TURNS = 2


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
    return best


def loaded(fitted: Fitted, y: FloatArray, loads: Loads, sizes: FloatArray) -> Fitted:
    """The model with further loads, everything refined on PV `y`."""
    problem, at = fitted.problem, fitted.problem.noise_at
    family = problem.family.with_loads(loads if problem.family.loads is None else problem.family.loads.joined(loads))
    start = np.insert(fitted.fit.theta, at, sizes)
    basis = None
    if fitted.basis is not None:
        rows = np.insert(fitted.basis, [at] * sizes.size, 0.0, axis=0)
        basis = np.hstack([rows, np.eye(start.size)[:, at : at + sizes.size]])
    problem = replace(problem, y=y, family=family)
    for _ in range(TURNS):
        start = settled(problem, _with_noise_left(problem, start), basis)
    return Fitted(problem, refine(problem, start, basis), basis, fitted.rivals)


def _with_noise_left(problem: Problem, theta: FloatArray) -> FloatArray:
    """The vector with the noise model of what it leaves of PV, of the same order."""
    order = problem.structure.noise_order
    found = autoregressions(problem.coloured_residual(theta), order)
    if found.most != order:
        return theta
    moved = theta.copy()
    moved[problem.noise_at : problem.initial_at] = found.model(order)
    return moved


def pruned(fitted: Fitted) -> Fitted:
    """Without the loads that do not pay."""
    loads = fitted.problem.family.loads
    if loads is None:
        return fitted
    inverse, _ = information_inverse(fitted.fit.hessian, fitted.basis)
    limit = COST * np.log(fitted.problem.errors)
    kept = []
    for index, rows in enumerate(places_of_loads(fitted.problem)):
        size = fitted.fit.theta[rows]
        spread = fitted.variance * inverse[np.ix_(rows, rows)]
        if 0.5 * float(size @ np.linalg.lstsq(spread, size, rcond=1e-12)[0]) > limit:
            kept.append(index)
    return fitted if len(kept) == len(loads.events) else _with_only(fitted, kept)


def without_loads(fitted: Fitted, y: FloatArray | None = None) -> Fitted:
    """Without any of its loads, refined; on another PV where given."""
    if y is not None:
        fitted = replace(fitted, problem=replace(fitted.problem, y=y))
    return fitted if fitted.problem.family.loads is None else _with_only(fitted, [])


def without_actuator(fitted: Fitted) -> Fitted:
    """The linear model of the same structure with the same loads."""
    problem = fitted.problem
    loads = problem.family.loads
    family = LinearFamily(load=problem.family.load, loads=None if loads is None else loads.along(problem.u))
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
        Swing(period, start, stop)
        for start, stop in data.segments.tolist()
        for period, _ in lines(data.y[start:stop])
        if share_of(data.y[start:stop], period) > LEAST_SHARE
    ]
    if not found:
        return None
    return Loads(tuple(found), data.y.size)


def without_swings(data: ScaledData, loads: Loads) -> ScaledData:
    """OP and PV without their parts at these periods: what a linear process does to the rest is the same."""
    columns = np.column_stack([loads.shapes.T, np.ones(data.u.size)])
    both = np.column_stack([data.u, data.y])
    left = both - columns[:, :-1] @ np.linalg.lstsq(columns, both, rcond=1e-10)[0][:-1]
    return replace(data, u=np.ascontiguousarray(left[:, 0]), y=np.ascontiguousarray(left[:, 1]))


def with_loads(fitted: Fitted, data: ScaledData, loads: Loads) -> Fitted:
    """A model of other signals, refined on these with given loads, and with its own."""
    on_data = replace(fitted, problem=replace(fitted.problem, u=data.u, y=data.y))
    return with_own_loads(pruned(loaded(on_data, data.y, loads, explained_by(on_data, loads.shapes)[0])))


def explained_by(fitted: Fitted, courses: Iterable[FloatArray]) -> tuple[FloatArray, float]:
    """Sizes of courses (n,) that explain most of the errors of a model, and what they gain in log-likelihood."""
    errors = _Errors(fitted)
    sizes, left = errors.explained(courses)
    gain = float(errors.errors @ errors.errors - left @ left)
    return sizes, 0.5 * gain / max(fitted.variance, 1e-300)


def sizes_of_loads(fitted: Fitted) -> FloatArray:
    """Sizes of the shapes of its loads."""
    return fitted.fit.theta[[row for rows in places_of_loads(fitted.problem) for row in rows]]


def places_of_loads(problem: Problem) -> list[list[int]]:
    """Places of the sizes of every event in the parameter vector."""
    loads, at = problem.family.loads, problem.noise_at
    counts = [] if loads is None else [len(event.names) for event in loads.events]
    ends = at - sum(counts) + np.cumsum(counts)
    return [list(range(end - count, end)) for end, count in zip(ends.tolist(), counts, strict=True)]


def _with_only(fitted: Fitted, kept: list[int]) -> Fitted:
    problem, loads = fitted.problem, fitted.problem.family.loads
    assert loads is not None  # noqa: S101  asked only of models with loads
    dropped = [row for index, rows in enumerate(places_of_loads(fitted.problem)) if index not in kept for row in rows]
    start = np.delete(fitted.fit.theta, dropped)
    basis = None
    if fitted.basis is not None:
        inside = ~np.any(fitted.basis[dropped] != 0.0, axis=0)
        basis = np.delete(fitted.basis[:, inside], dropped, axis=0)
    problem = replace(problem, family=problem.family.with_loads(loads.kept(kept)))
    return Fitted(problem, refine(problem, start, basis), basis, fitted.rivals)


@dataclass(frozen=True)
class _Option:
    """An event and what it explains (sum of squares)."""

    gain: float
    event: Step | Swing


class _Errors:
    """Prediction errors of a model, and what loads would do to them."""

    def __init__(self, fitted: Fitted) -> None:
        problem = fitted.problem
        s, n = problem.structure, problem.u.size
        self.fitted = fitted
        self.room = MOST_EVENTS - problem.family.sought
        self.limit = 2.0 * PROMISING * float(np.log(problem.errors)) * fitted.variance
        self.segments = [(start, start + s.start, stop) for start, stop in problem.segments.tolist()]
        self.errors = np.zeros(n)
        steps = sum(isinstance(event, Step) for event in problem.family.loads.events) if problem.family.loads else 0
        self.steps_left = (MOST_BY_HAND if held_by_hand(problem) else MOST_EVENTS) - steps
        for (_, first, stop), part in zip(self.segments, problem.predict(fitted.fit.theta)[1], strict=True):
            self.errors[first:stop] = part

    def loads(self) -> tuple[Loads, FloatArray] | None:
        """Loads by orthogonal matching pursuit, and their sizes."""
        forget()
        rows, count = self.errors.size, 0
        events: list[Swing | Step] = []
        # of a long record at half the precision: the sizes are refined
        columns = own_pages((2 * self.room, rows), np.float32 if rows > AT_ONCE else np.float64)
        left, sizes, gram, target = self.errors, np.zeros(0), np.zeros((0, 0)), np.zeros(0)
        response = self._effect(np.ones(rows), 0, rows)
        trials = {each: list(self._options(left, response, *each)) for each in self.segments}
        while len(events) < self.room:
            best = max(chain(*trials.values()), key=lambda option: option.gain, default=None)
            if best is None or not best.gain > self.limit:
                break
            events.append(best.event)
            self.steps_left -= isinstance(best.event, Step)
            for course in courses_of(best.event, rows):
                columns[count] = self._column(course)
                products = (columns[: count + 1] @ columns[count]).astype(float)
                gram = np.block([[gram, products[:-1, None]], [products[None, :-1], products[-1:, None]]])
                target = np.append(target, columns[count] @ self.errors.astype(columns.dtype))
                count += 1
            sizes = _solved(gram, target, 1e3 * float(np.finfo(columns.dtype).eps))
            left = self.errors - sizes.astype(columns.dtype) @ columns[:count]
            for each in self.segments:
                if each[0] == best.event.start:  # what is left elsewhere has not changed
                    trials[each] = list(self._options(left, response, *each))
        return (Loads(tuple(events), rows), sizes) if events else None

    def hidden_swing(self) -> tuple[Loads, FloatArray] | None:
        """The line that stands out most from what the model leaves of PV: an AR of high order may hide it in part."""
        if self.room < 1:
            return None
        residuals = self.fitted.output_residual()
        best, gain = None, STANDS_OUT
        for (start, _, stop), residual in zip(self.segments, residuals, strict=True):
            for period, ratio in lines(residual)[:1]:
                if ratio > gain and not self._made_by_the_loop(np.array([period]), start, stop)[0]:
                    best, gain = Loads((Swing(period, start, stop),), self.errors.size), ratio
        if best is None:
            return None
        return best, self.explained(best.shapes)[0]

    def _made_by_the_loop(self, periods: FloatArray, start: int, stop: int) -> npt.NDArray[np.bool_]:
        """Which periods are harmonics of the swing of PV, where that is not a load itself.

        What swings from outside does so at its own period first; harmonics alone are made by the actuator.
        """
        whole = _own_swing(self.fitted.problem.y, start, stop)
        loads = self.fitted.problem.family.loads
        outside = [event.period for event in loads.events if isinstance(event, Swing)] if loads is not None else []
        if whole is None or any(abs(period / whole - 1.0) < SAME for period in outside):
            return np.zeros(periods.size, bool)
        order = whole / periods
        return np.asarray((order > 1.5) & (np.abs(order - np.round(order)) < SAME * order))

    def explained(self, courses: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Sizes of loads of given courses, by least squares, and the errors that they leave."""
        columns = [self._column(course) for course in courses]
        gram = np.array([[one @ other for other in columns] for one in columns])
        sizes = _solved(gram, np.array([column @ self.errors for column in columns]), 1e-12)
        return sizes, self.errors - sum(size * column for size, column in zip(sizes, columns, strict=True))

    def _options(self, left: FloatArray, response: FloatArray, start: int, first: int, stop: int) -> Iterator[_Option]:
        """Best step and best swing of a segment."""
        part, skipped = left[start:stop], first - start
        if part.size - skipped > 4 * EDGE and self.steps_left > 0:
            w = response[: part.size]
            energy = np.cumsum(w**2)
            norms = energy[::-1].copy()
            if skipped:
                norms[:skipped] -= energy[skipped - 1 - np.arange(skipped)]
            # products with a step at each row: the response run backwards over what is left
            later = self._filtered(np.cumsum(part[::-1]))[::-1]
            scores = later**2 / np.maximum(norms, max(1e-9 * energy[-1], np.finfo(float).tiny))  # it may answer nothing
            row = EDGE + int(np.argmax(scores[EDGE:-EDGE]))
            yield _Option(float(scores[row]), Step(start + row, start, stop))
        n = stop - first
        if n > 2 * FEWEST_PERIODS * SHORTEST_PERIOD:
            period, gain = strongest(left[first:stop], lambda periods: self._made_by_the_loop(periods, start, stop))
            yield _Option(gain, Swing(float(period), start, stop))

    def _column(self, course: FloatArray) -> FloatArray:
        """What a load does to the prediction errors."""
        column = np.zeros(course.size)
        for start, first, stop in self.segments:
            column[first:stop] = self._effect(course, start, stop)[first - start :]
        return column

    def _effect(self, course: FloatArray, start: int, stop: int) -> FloatArray:
        return self._filtered(np.ascontiguousarray(course[start:stop]))

    def _filtered(self, course: FloatArray) -> FloatArray:
        """Through process and noise model, from rest."""
        parts, problem = self.fitted.parts, self.fitted.problem
        z = simulate(parts.a, parts.b, problem.structure.delay, course)
        result = z.copy()
        add_lagged(parts.d, z[:-1], result[1:])
        if problem.structure.zero != 0.0:
            all_pole(np.array([-problem.structure.zero]), result.copy(), result)
        return result


@remembered
def _own_swing(y: FloatArray, start: int, stop: int) -> float | None:
    """Period of the line that is most of PV (n,) in these rows."""
    return dominant(y[start:stop])


def _solved(gram: FloatArray, target: FloatArray, smallest: float) -> FloatArray:
    """Least squares from the products of the columns with each other and with what they are to explain.

    Correlations smaller than `smallest` are rounding.
    """
    scale = np.sqrt(np.diag(gram))
    scale[scale == 0.0] = 1.0
    return np.asarray(np.linalg.lstsq(gram / np.outer(scale, scale), target / scale, rcond=smallest)[0] / scale)
