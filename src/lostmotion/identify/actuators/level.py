"""Actuator kinds of a level: an integrating process under control with a drifting load disturbance.

Predictions with a rich noise model excluded backlash of 0.01 to 0.1 where 1.5 to 4 was true: without set-point moves
the process is not identifiable beside such a noise model, and a process that follows every ripple of OP excludes any
lost motion. With the noise model of a level (:mod:`..likelihood.drifting_load`) it is. The profile likelihood of the
size of each kind is evaluated with process and noise refitted at every size.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_quantile
from lostmotion.identify.actuators.choice import (
    KindChoice,
    confidence_of,
    gains_left_out,
    likelihood_gain,
    total_and_firm,
)
from lostmotion.identify.actuators.excluded import FALL
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, Kind, faults
from lostmotion.identify.actuators.no_fault import NONE
from lostmotion.identify.evidence import NEARLY_EXACT
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import log_densities
from lostmotion.identify.likelihood.drifting_load import LevelFit, LevelLikelihood
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine, settled
from lostmotion.identify.scaled import ScaledData

LATEST, LATEST_SHARE = 60, 20  # rows of delay, and rows of a segment for each
MOST_SEGMENTS = 10  # each has initial states of its own
FIRST_BLOCKS, FEWEST_BLOCKS = 2000, 100  # of a record, and of a segment
IN_MEMORY = 5.0  # blocks in the time in which the noise forgets
SIZES, LARGEST = 24, 0.95  # evaluated, up to so much of the range of OP
HOPELESS = 30.0  # of log-likelihood, that no fault makes up for
LEVEL = 0.95  # of the intervals
ANSWERED = 10.0  # of twice the log-likelihood over a valve that does not move; less excludes no lost motion
CLOSE = 10.0  # of twice the log-likelihood: other forms of a size that are refined as well
NEAR_STEPS = 4  # of noise, from that of a size nearby
HALVINGS = 6  # of the steps of own parameters, and of an end between two sizes
MOST_MOVES = 4  # with one step
FORGOTTEN = 3.0  # time constants of the zeros of the noise after which what was before is forgotten
MOST_FORGOTTEN = 8  # part of a segment that this may take


@dataclass(frozen=True)
class Place:
    """An actuator and the level behind it."""

    family: Family
    own: FloatArray
    fit: LevelFit


@dataclass(frozen=True)
class Level:
    """What is known of a level.

    Attributes
    ----------
    none, chosen : Fitted
        The healthy valve, and the likeliest kind or that which was asked for.
    kinds : KindChoice
        With `excluded` in scaled units.
    interval : (float, float)
        95 % interval of the size of `chosen`, in scaled units.
    answered : float
        Twice the gain in log-likelihood over a valve that stands still.
    """

    none: Fitted
    chosen: Fitted
    kinds: KindChoice
    interval: tuple[float, float]
    answered: float


def as_level(data: ScaledData, asked: Asked, linear: Fitted, kind: str | None = None) -> Level | None:
    """The kinds with a drifting load, where that is more likely than the linear model with any noise; else None.

    `kind`: that which was asked for; None: the likeliest.
    """
    loop = feedback(data)
    if not (loop.closed and asked.any_noise and asked.orders is None and asked.integrating is not False):
        return None
    if len(data.segments) > MOST_SEGMENTS or not (linear.problem.structure.integrating or loop.free < NEARLY_EXACT):
        return None
    search = _Search.on(data, linear.problem)
    if search is None or likelihood_gain(search.fitted(search.none), linear)[0] < -HOPELESS:
        return None
    found = search.level(kind)
    return found if likelihood_gain(found.chosen, linear)[0] > 0.0 else None


@dataclass(frozen=True)
class _Search:
    """On one set of data, seen in blocks."""

    data: ScaledData
    problem: Problem
    likelihood: LevelLikelihood

    @classmethod
    def on(cls, data: ScaledData, problem: Problem) -> _Search | None:
        """In blocks of a fifth of the time in which the noise of the level forgets; None: the record is too short."""
        latest = max(min(LATEST, data.shortest // LATEST_SHARE), 1)
        every = max(data.u.size // FIRST_BLOCKS, 1)
        if data.shortest // every < FEWEST_BLOCKS:
            return None
        first = LevelLikelihood(data, latest, every)
        memory = first.best(data.u, None).noise.memory * every
        every = max(min(int(memory / IN_MEMORY), data.shortest // FEWEST_BLOCKS), 1)
        return cls(data, problem, LevelLikelihood(data, latest, every))

    @cached_property
    def none(self) -> Place:
        """Without a fault."""
        found = self.likelihood.best(self.data.u, None)
        return Place(NONE.family(), np.zeros(0), self.likelihood.with_best_delay(self.data.u, found))

    def level(self, name: str | None) -> Level:
        """All kinds that have a size, and more of the likeliest, or of that which was asked for."""
        likelihood, none = self.likelihood, self.none
        sized = [kind for kind in faults() if kind.size is not None]
        profiles = {kind.name: _Profile(self.data, self.problem, kind, likelihood, none.fit) for kind in sized}
        answered = likelihood.gain_of(none.fit, likelihood.still())
        sizes = {
            name: found.largest(none.fit) if answered > ANSWERED else float(np.inf) for name, found in profiles.items()
        }
        intervals = {name: found.interval() for name, found in profiles.items()}
        places = {name: found.best for name, found in profiles.items()}
        kinds = self._kinds(places)
        name = name or kinds.best
        wanted = {NO_FAULT, name, *kinds.gains}
        fits = {kind: self.fitted(place) for kind, place in {NO_FAULT: none, **places}.items() if kind in wanted}
        kinds = replace(kinds, excluded=sizes, gains=gains_left_out(self.data, fits))
        return Level(fits[NO_FAULT], fits[name], kinds, intervals.get(name, (0.0, 0.0)), answered)

    def _kinds(self, places: dict[str, Place]) -> KindChoice:
        """By likelihood, less what parameters cost; the noise of each is its own, and costs all the same."""
        rows, healthy = self.likelihood.rows, self._densities(self.none)
        likelihoods, firm = {NO_FAULT: 0.0}, {NO_FAULT: 0.0}
        for name, place in places.items():
            total, robust = total_and_firm(self._densities(place) - healthy)
            cost = 0.5 * (place.own.size - place.family.places) * float(np.log(rows))  # slopes are as they are
            if total > cost:
                likelihoods[name], firm[name] = total - cost, robust - cost
        scores = {name: gain for name, gain in likelihoods.items() if firm[name] > NEEDED} | {NO_FAULT: NEEDED}
        chosen, *others = sorted(scores, key=lambda name: scores[name], reverse=True)
        runner_up = others[0] if others else chosen
        sure = confidence_of(scores[chosen] - scores[runner_up])
        return KindChoice(chosen, dict(likelihoods), likelihoods, firm, sure, runner_up)

    def _densities(self, place: Place) -> FloatArray:
        """Log density of every block, up to a constant."""
        errors = self.likelihood.errors(_course(place, self.data.u), place.fit)
        return log_densities(errors, float(errors @ errors) / errors.size)

    def fitted(self, place: Place) -> Fitted:
        """The same as a fit of the likelihood, row by row."""
        data, x = self.data, _course(place, self.data.u)
        begun = replace(place.fit, noise=place.fit.noise.over(1.0 / self.likelihood.every))
        fit = LevelLikelihood(data, self.likelihood.latest).best(x, begun)
        head = min(FORGOTTEN * fit.noise.memory, data.shortest / MOST_FORGOTTEN)
        structure = Structure(
            1, 0, fit.delay, fit.noise.d.size, int(head) + fit.delay + fit.noise.d.size, True, c=fit.noise.c
        )
        family = place.family.with_load(True)
        problem = Problem(data.u, data.y, data.segments, family, structure, self.problem.held)
        theta = problem.pack(np.array([-1.0]), np.array([fit.gain]), np.append(place.own, 0.0), fit.noise.d, 0.0)
        free = problem.free_but(range(problem.initial_at, problem.size))  # D(1) = 0: a level of PV is no error
        found = refine(problem, settled(problem, theta, free), problem.free_but(problem.own, free), tied=True)
        return Fitted(problem, found, free)


def _course(place: Place, u: FloatArray) -> FloatArray:
    x = np.empty(u.size)
    place.family.path(place.own, u, x)
    return x


class _Profile:
    """Likelihood of the sizes of one kind, everything else at its best."""

    def __init__(
        self, data: ScaledData, problem: Problem, kind: Kind, likelihood: LevelLikelihood, none: LevelFit
    ) -> None:
        self.data, self.problem, self.kind, self.likelihood, self.none = data, problem, kind, likelihood, none
        self.span = float(np.ptp(data.u))
        self.known: dict[float, Place] = {}
        for size in self.span * LARGEST * np.arange(1, SIZES + 1) / SIZES:
            self._look(float(size))
        self._refine(self.best)

    @property
    def best(self) -> Place:
        """The likeliest."""
        return min(self.known.values(), key=_cost)

    def interval(self) -> tuple[float, float]:
        """Sizes between which all lie that are not rejected; looking for its ends may find a likelier one."""
        best = None
        while best is not self.best:
            best = self.best
            limit = best.fit.cost * float(np.exp(chi2_quantile(LEVEL, 1) / self.likelihood.rows))
            inside = [size for size in sorted(self.known) if self.known[size].fit.cost <= limit]
            below = [size for size in self.known if size < inside[0]]
            above = [size for size in self.known if size > inside[-1]]
            high = self._between(inside[-1], min(above), limit) if above else float(np.inf)
            low = self._between(inside[0], max(below, default=0.0), limit) if self.none.cost > limit else 0.0
            if self.best is not best:
                self._refine(self.best)
        return low, high

    def largest(self, none: LevelFit) -> float:
        """Largest size that is not excluded beside a healthy valve (one-sided)."""
        limit = none.cost * float(np.exp(2.0 * FALL / self.likelihood.rows))
        sizes = sorted(self.known)
        if self.known[sizes[-1]].fit.cost <= limit:
            return float(np.inf)
        inside = [size for size in sizes if self.known[size].fit.cost <= limit]
        if not inside:
            return self._between(0.0, sizes[0], limit)
        return self._between(inside[-1], min(size for size in sizes if size > inside[-1]), limit)

    def _between(self, inside: float, outside: float, limit: float) -> float:
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            if self._look(middle).fit.cost <= limit:
                inside = middle
            else:
                outside = middle
        return outside

    def _look(self, size: float) -> Place:
        """Best form of a size; begun at the noise of the size nearest to it."""
        if size in self.known:
            return self.known[size]
        nearest = min(self.known, key=lambda one: abs(one - size)) if self.known else None
        near = self.none if nearest is None else self.known[nearest].fit
        found = [self._placed(family, own, near, 0) for family, own in self._forms(size, nearest)]
        least = min(map(_cost, found)) * float(np.exp(CLOSE / self.likelihood.rows))
        close = sorted((one for one in found if _cost(one) <= least), key=_cost)[:2]
        best = min((self._placed(one.family, one.own, near, NEAR_STEPS) for one in close), key=_cost)
        self.known[size] = self._at_best_delay(best)
        return self.known[size]

    def _forms(self, size: float, nearest: float | None) -> Iterator[tuple[Family, FloatArray]]:
        yield from self.kind.of_size(self.problem, size)
        if nearest and self.kind.sticks:  # as that one, only larger or smaller
            place = self.known[nearest]
            yield place.family, place.own * (size / nearest)

    def _placed(self, family: Family, own: FloatArray, near: LevelFit, steps: int) -> Place:
        place = Place(family, own, near)
        return replace(place, fit=self.likelihood.best(_course(place, self.data.u), near, steps))

    def _at_best_delay(self, place: Place) -> Place:
        return replace(place, fit=self.likelihood.with_best_delay(_course(place, self.data.u), place.fit, 2))

    def _refine(self, place: Place) -> None:
        """By a pattern search over the parameters of the actuator."""
        step = self.span * LARGEST / SIZES / 2
        for _ in range(HALVINGS):
            for _ in range(MOST_MOVES):
                trials = [self._placed(family, own, place.fit, 2) for family, own in self._moves(place, step)]
                winner = min(trials, key=_cost)
                if not _cost(winner) < _cost(place):
                    break
                place = winner
            step *= 0.5
        place = self._at_best_delay(place)
        size = self._size(place)
        self.known[size] = min(place, self.known.get(size, place), key=_cost)

    def _size(self, place: Place) -> float:
        return float(place.own[1] - place.own[0]) if place.family.places else float(place.own[0])

    def _moves(self, place: Place, step: float) -> Iterator[tuple[Family, FloatArray]]:
        own = place.own
        for index in range(2 if own.size > 1 else 1):
            for sign in (1.0, -1.0):
                moved = own.copy()
                moved[index] += sign * step
                yield place.family, place.family.valid(moved)


def _cost(place: Place) -> float:
    return place.fit.cost
