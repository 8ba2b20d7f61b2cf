"""From data and a family to the global maximum of the likelihood: starts, noise order, refinement."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.arx import fit_arx, linear_start
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.coloured import autoregression_like, with_best_zero
from lostmotion.identify.likelihood.criterion import cost_of_equal, per_row
from lostmotion.identify.likelihood.excerpt import alone, excerpt
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.finished import finished, without_load
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.in_row import answers_in_row
from lostmotion.identify.likelihood.noise_order import autoregressions, choose_noise, without_mode
from lostmotion.identify.likelihood.plausible import FREE, Held
from lostmotion.identify.likelihood.poles import GridStart, exact_start, grid_starts, simpler
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import LocalFit, refine, settled
from lostmotion.identify.likelihood.rivals import rivals
from lostmotion.identify.likelihood.structure import LADDER, distinct, null_space_starts
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.linear import simulate

_Attempt = tuple[FloatArray, GridStart, FloatArray]
_Key = tuple[int, int, int, bool]

START_NOISE_LAGS = 15  # of a start; the order is chosen afterwards (noise_order.py, 0 to 20)
MOST_ROUNDS = 4  # of looking at other structures; it ends by itself where a round does not help
IMPLAUSIBLE = 1e12  # added to BIC: behind anything plausible, and still in order among themselves
FIRST_STEPS, ROUGH_STEPS = 6, 20
PATIENCE, UNDECIDED = 3, 12.0  # as many steps again for fits that have not converged, so near to the best (BIC)
MOST_FINISHED = 3  # structures that are refined to the end and only then compared
BEHIND = 25.0  # BIC of fits after the first steps: what is further behind the best is given up
# samples: a longer one is better resampled (remarks_on_fit.LATE), and a twentieth of the shortest piece if that is less
LATEST_DELAY = 25
MOST_STRUCTURES = 3  # refined of those that the grid scores: the best few by score (docs/method.md, "orders, delay")
MOST_NULL_SPACE = 2  # kept beside the grid for nearly exact feedback only (docs/method.md, "start in strong feedback")
START_LAGS = 30  # of the ARX of a start: LATEST_DELAY and five samples of response
HOPELESS = 60.0  # a structure that is so much behind on the grid is not refined
CLOSE = 30.0  # the same with the poles found
MOST_CLOSE = 6  # of these
WORTH_A_GRID = 10.0  # gain of a turn, from which on the actuator has moved and the whole grid is looked at again
NEAR = 3  # samples of delay about that of another fit
REACH = 8  # the same about the best so far


def best_fit(
    data: ScaledData,
    family: Family,
    etas: list[FloatArray],
    asked: Asked,
    near: Fitted | None = None,
    beside: Fitted | None = None,
) -> Fitted:
    """Refine from every start of the actuator and every likely structure; then settle the noise order.

    Parameters
    ----------
    data : ScaledData
    family : Family
    etas : list of ndarray
        Starts of the actuator parameters.
    asked : Asked
        Orders and noise, where they are not to be chosen from the data.
    near : Fitted or None
        Fit of another kind of actuator to the same data: its process and noise are where the search begins.
    beside : Fitted or None
        The same, but the search begins at its own processes as well.
    """
    search = _Search.on(data, family, asked)
    tried: list[Fitted | None] = []
    others = [] if beside is None else [beside]
    begun: list[_Attempt] = []
    if near is None:  # the other starts begin at the process that the first has found
        near = search.over(search.likely(etas[0]))
        assert near is not None  # noqa: S101  there is always a start
        tried, begun, etas = [near], search.like(others, etas[0]) if others else [], etas[1:]
    tried.append(search.over(begun + [attempt for eta in etas for attempt in search.like([near, *others], eta)]))
    best = min((one for one in tried if one is not None), key=search.score)
    if asked.orders is None:
        best = search.improve(best)
    finals = [finished(data, one, asked) for one in search.close_to(best)]
    final = search.simplest(best, min(finals, key=search.score))
    best = with_best_zero(final, asked)
    return replace(without_load(best), rivals=rivals(search.seen))


@dataclass(frozen=True)
class _Search:
    """Rough fits of many structures on common rows, compared by their information criterion."""

    data: ScaledData
    family: Family
    asked: Asked
    segments: IntArray
    delays: tuple[int, int]
    held: Held = FREE
    seen: list[tuple[FloatArray, float]] = field(default_factory=list)
    fits: list[Fitted] = field(default_factory=list)

    @classmethod
    def on(cls, data: ScaledData, family: Family, asked: Asked) -> _Search:
        """Search over the orders given, or over the ladder and all delays that the record can show."""
        rows = data.segments if family.needles else excerpt(data)  # the place in a needle is for all rows
        if asked.orders is not None:
            return cls(data, family, asked, rows, (asked.orders[2], asked.orders[2]))
        latest = max(min(LATEST_DELAY, data.shortest // 20), 1)
        loop = feedback(data)
        first = 1 if loop.closed and not answers_in_row(data) else 0
        return cls(data, family, asked, rows, (first, latest), Held(loop.closed, loop.direction))

    @cached_property
    def looked_at(self) -> ScaledData:
        """What the rough fits see: their rows alone, where the valve remembers no others."""
        whole = self.family.resting or self.family.loads is not None
        return replace(self.data, segments=self.segments) if whole else alone(self.data, self.segments)

    @cached_property
    def rows(self) -> int:
        """Rows of the rough fits."""
        return int((self.segments[:, 1] - self.segments[:, 0]).sum())

    @property
    def ladder(self) -> tuple[tuple[int, int], ...]:
        """Orders (na, nb) that are tried."""
        return LADDER if self.asked.orders is None else (self.asked.orders[:2],)

    def over(self, attempts: list[_Attempt], ahead: Fitted | None = None) -> Fitted | None:
        """Best of the attempts; all are remembered. After a few steps those far behind a plausible fit are given up.

        Those far behind a fit `ahead` at once, where that is plain: not behind one another, of which too much is open.
        """
        known = np.inf if ahead is None else self.score(ahead)
        fits = [self._rough(*attempt, known + BEHIND) for attempt in attempts]
        limit = min([known, *(self.score(fitted) for fitted in fits)]) + BEHIND
        fits = [_further(fitted) if self._misfit(fitted) < limit else fitted for fitted in fits]
        for _ in range(PATIENCE):
            limit, before = min([known, *(self.score(fitted) for fitted in fits)]) + UNDECIDED, fits
            fits = [_further(fitted) if self._misfit(fitted) < limit else fitted for fitted in fits]
            if all(fitted is one for fitted, one in zip(fits, before, strict=True)):
                break
        for fitted in fits:
            self.seen.append((fitted.actuator, self.score(fitted) * self.data.u.size / self.rows))
        self.fits.extend(fits)
        return min(fits, key=self.score) if fits else None

    def likely(self, eta: FloatArray) -> list[_Attempt]:
        """The structures to try for one start of the actuator: best on the grid, the output error white or coloured."""
        x = self._internal(eta)
        plain = self._best_of_grid(x, np.zeros(0))
        best = exact_start(self.data, x, np.zeros(0), self.ladder, self.delays, plain[0])
        d = self._noise_of(x, best)
        starts = self._best_of_grid(x, d) if d.size else []
        white = np.zeros(self.asked.noise or 0)
        attempts = [(eta, start, d) for start in starts]
        others = [(eta, start, white) for start in ([best] if starts else [best, *plain[1:]])]
        attempts += [self._coloured(*other) for other in others] if starts else others
        if self.asked.integrating or (self.asked.orders is None and not self.held.closed):
            return attempts
        arx = fit_arx(self.data, x, self.delays[0], START_LAGS)
        if self.asked.orders is not None:
            a, b, misfit = linear_start(arx, *self.asked.orders)
            return [*attempts, (eta, GridStart(*self.asked.orders, a, b, misfit, 0.0), d)]
        p = self._noise_lags if self.asked.noise is None else self.asked.noise
        longer = np.zeros(p)
        longer[: min(p, arx.a.size)] = arx.a[:p]
        starts = null_space_starts(arx)[:MOST_NULL_SPACE]
        return attempts + [(eta, start, longer) for start in starts if start.delay <= self.delays[1]]

    def _coloured(self, eta: FloatArray, start: GridStart, d: FloatArray) -> _Attempt:
        """Where a fit without a model of the noise ends, with the noise that it leaves: so it can be compared."""
        fitted = _further(self._rough(eta, start, d))
        if self.asked.noise is None:
            d = choose_noise(fitted.output_residual(), self._noise_lags)
        return (*_from(fitted, fitted.actuator)[:2], d)

    def like(self, near: list[Fitted], eta: FloatArray) -> list[_Attempt]:
        """The process and noise of other fits, and the best on the grid with that noise.

        Over all delays: the process beside another kind may be as wrong as that kind.
        """
        begun = [(*_from(one, eta)[:2], autoregression_like(one, self._noise_lags)) for one in near]
        d = begun[0][2]
        return begun + [(eta, start, d) for start in self._best_of_grid(self._internal(eta), d)]

    def improve(self, best: Fitted) -> Fitted:
        """Look at other structures from the actuator and noise found, while it helps.

        With the poles found or some of them, where a score is nearly that of the refined model, and over the whole grid
        at first and after a turn that gained much.
        """
        tried: set[_Key] = set()
        gained = np.inf
        for _ in range(MOST_ROUNDS):
            s = best.problem.structure
            tried.add((s.na, s.nb, s.delay, s.integrating))
            attempts = self._others(best, tried, everywhere=gained > WORTH_A_GRID)
            tried.update(start.key for _, start, _ in attempts)
            challenger = self.over(attempts, best)
            gained = 0.0 if challenger is None else self.score(best) - self.score(challenger)
            if challenger is None or gained < 1.0:
                break
            best = challenger
        return best

    def simplest(self, rough: Fitted, final: Fitted) -> Fitted:
        """A finished fit, or a likelier one with fewer poles: those were chosen beside a noise that it has not."""
        s = final.problem.structure
        if self.asked.orders is not None or s.na < 2 or 2 * s.noise_order > rough.problem.structure.noise_order:
            return final
        d = autoregression_like(final, self._noise_lags)
        x, here = self._internal(final.actuator), (s.delay, s.delay)
        starts = self._grid(x, d, here, simpler(final.parts.a, s.integrating))
        fewer = distinct([start for start in starts if start.na < s.na], s.na - 1)
        found = self.over([(final.actuator, start, d) for start in fewer], final)
        if found is None or self.score(found) > self.score(final):
            return final
        return min(final, finished(self.data, found, self.asked), key=self.score)

    def _others(self, best: Fitted, tried: set[_Key], everywhere: bool) -> list[_Attempt]:
        """Untried structures that score about as well as that of a fit: with its own poles, on the grid where asked."""
        s, eta, d, (low, high) = best.problem.structure, best.actuator, best.parts.d, self.delays
        x, near = self._internal(eta), (max(low, s.delay - NEAR), min(high, s.delay + NEAR))
        own = self._grid(x, d, near, simpler(best.parts.a, s.integrating))
        here = min((start.score for start in own if start.key == (s.na, s.nb, s.delay, s.integrating)), default=np.inf)
        starts = [start for start in own if start.score < here + CLOSE and start.key not in tried][:MOST_CLOSE]
        if everywhere:
            known = {start.key for start in starts} | tried
            about = (max(low, s.delay - REACH), min(high, s.delay + REACH))
            limit = here + HOPELESS
            grid = [one for one in self._grid(x, d, about, limit=limit) if one.score < limit and one.key not in known]
            starts += grid[:MOST_STRUCTURES]
        return [(eta, start, d) for start in starts]

    def close_to(self, best: Fitted) -> list[Fitted]:
        """The best, and other structures that are as likely as far as rough fits can tell."""
        if self.asked.orders is not None:
            return [best]
        limit, kept = self.score(best) + UNDECIDED, {_key(best): best}
        for fitted in sorted((one for one in self.fits if self.score(one) < limit), key=self.score):
            kept.setdefault(_key(fitted), fitted)
        return list(kept.values())[:MOST_FINISHED]

    def score(self, fitted: Fitted) -> float:
        """Information criterion; orders that were chosen here, not given, must also be plausible.

        A pole slower than the record is no process but a drift, which a long model of the noise explains as well; a
        known gain then makes any slope of it.
        """
        possible = not fitted.drifts(self.data.longest) and (self.asked.orders is not None or fitted.possible)
        return self._misfit(fitted) + (0.0 if possible else IMPLAUSIBLE)

    def _misfit(self, fitted: Fitted) -> float:
        """Information criterion for all rows: in short records a long model of the noise leaves fewer to be fitted."""
        return per_row(fitted) * self.rows

    def _internal(self, eta: FloatArray) -> FloatArray:
        data = self.data
        x, dx = np.empty(data.u.size), np.empty((len(self.family.names), data.u.size))
        self.family.evaluate(eta, data.u, x, dx)
        return x

    def _grid(
        self,
        x: FloatArray,
        d: FloatArray,
        delays: tuple[int, int],
        only: list[FloatArray] | None = None,
        limit: float | None = np.inf,
    ) -> list[GridStart]:
        starts = grid_starts(self.data, x, d, self.ladder, delays, self.asked.integrating, self.held, only, limit)
        na, nb = self.ladder[0]
        return starts or [GridStart(na, nb, delays[0], np.zeros(na), np.zeros(nb + 1), 0.0, 0.0)]

    def _best_of_grid(self, x: FloatArray, d: FloatArray) -> list[GridStart]:
        """The best starts of different orders over all delays; their B is settled beside the model of the noise."""
        return distinct(self._grid(x, d, self.delays, limit=None), MOST_STRUCTURES)

    def _noise_of(self, x: FloatArray, start: GridStart) -> FloatArray:
        """AR model of what a start leaves over; of the order asked for."""
        residuals = []
        for begin, stop in self.data.segments:
            z = simulate(np.ascontiguousarray(start.a), np.ascontiguousarray(start.b), start.delay, x[begin:stop])
            residuals.append(without_mode(self.data.y[begin:stop] - z, start.decay))
        order = self.asked.noise
        if order is not None:
            found = autoregressions(residuals, order)
            return found.model(order) if found.most == order else np.zeros(order)
        return choose_noise(residuals, self._noise_lags)

    @property
    def _noise_lags(self) -> int:
        """Lags of a noise model that the record carries."""
        return max(min(START_NOISE_LAGS, self.data.shortest // 20), 0)

    def _rough(self, eta: FloatArray, start: GridStart, d: FloatArray, limit: float = np.inf) -> Fitted:
        rows = self.delays[1] + (START_NOISE_LAGS if self.asked.noise is None else self.asked.noise)
        rows = max(min(rows, int(np.diff(self.segments).min()) // 5), start.delay + d.size)
        integrating = start.decay == 1.0
        structure = Structure(start.na, start.nb, start.delay, d.size, rows, integrating)
        family = self.family.with_load(integrating)
        seen = self.looked_at
        problem = Problem(seen.u, seen.y, seen.segments, family, structure, self.held)
        theta = problem.pack(start.a, start.b, np.append(eta, 0.0) if integrating else eta, d, 0.0)
        begun = settled(problem, theta)
        unfitted = Fitted(problem, LocalFit(begun, np.inf, np.zeros((0, 0)), 0, False), problem.basis)
        bound = cost_of_equal(unfitted, limit / self.rows) if limit < 0.5 * IMPLAUSIBLE else np.inf
        first = refine(problem, begun, _held(problem), most_steps=FIRST_STEPS, tied=family.needles, bound=bound)
        return replace(unfitted, fit=first)


def _key(fitted: Fitted) -> _Key:
    """What tells structures apart."""
    s = fitted.problem.structure
    return s.na, s.nb, s.delay, s.integrating


def _from(fitted: Fitted, eta: FloatArray) -> _Attempt:
    """An actuator at the process and noise of a fit."""
    s, parts = fitted.problem.structure, fitted.parts
    return eta, GridStart(s.na, s.nb, s.delay, parts.a, parts.b, 0.0, 1.0 if s.integrating else 0.0), parts.d


def _further(fitted: Fitted) -> Fitted:
    """More steps, where it has not converged."""
    if fitted.fit.converged:
        return fitted
    problem = fitted.problem
    held = _held(problem) if problem.family.needles else fitted.basis
    further = refine(problem, fitted.fit.theta, held, most_steps=ROUGH_STEPS, tied=problem.family.needles)
    return replace(fitted, fit=further)


def _held(problem: Problem) -> FloatArray | None:
    """Free directions of a start: the actuator stays in its needle until the process around it is known."""
    return problem.free_but(problem.own) if problem.family.needles else None
