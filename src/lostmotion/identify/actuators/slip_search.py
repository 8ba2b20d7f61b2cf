"""Maximum and interval of the likelihood of a sticking valve, from pattern to pattern of its slips."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.polish import FINE_RESTS, rested
from lostmotion.identify.actuators.slip_draws import even_draws
from lostmotion.identify.actuators.slip_likelihood import Pattern, Patterns, SlipLikelihood, shortened
from lostmotion.identify.actuators.stiction_family import LARGEST_JUMP, own
from lostmotion.identify.likelihood.coloured import as_autoregression
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import refine

MOST_ROWS = 20_000  # of a search: on more, the place that it finds is refined
ROUNDS = 5  # of search and refinement
WORTH = 0.3  # of log-likelihood, for another round
# half the width of a box of trials, relative to the band, and their number
WIDE = ((0.06, 128), (0.03, 64))
CLOSE = ((0.012, 48), (0.004, 32), (0.0012, 24))
NEIGHBOURHOOD = ((0.02, 64), (0.006, 48), (0.002, 48))  # the same where an interval begins
JUMP_REACH, REST_REACH = 2.0, 6.0  # of a box: its other sides, in units of the first
HOPS = 20  # from a pattern to the best next to it
SCAN = 31  # places of one parameter, the others held
SCAN_BANDS, SCAN_SHARES, SCAN_RESTS = 0.08, 1.2, 0.2  # how far: relative, jump over band, halves of the band
REPEATS, SMALL = 4, 1e-4  # of settling; the last where the cost falls by less than this share
ROUNDING = 1e-9  # relative, of sums of squares that should be equal
OTHER = 12.0  # of log-likelihood behind after a close look: the other model is not searched further
STEPS = 6  # of everything else at a new place, before the valve moves as well
LEVEL = 0.95  # of the intervals
MARGIN = 4.0  # of log-likelihood: how much deeper a valley between two patterns may be
MOST_PATTERNS = 600  # met for an interval
EDGE = 0.02  # of a rectangle: what is nearer to a side may be beyond it
NUDGE = 1e-9  # relative: beyond the side of a rectangle

Intervals = dict[str, tuple[float, float]]


def slipped(fitted: Fitted) -> Fitted:
    """The best pattern that is met about a fit of stiction, of either model, and everything refined with it."""
    if fitted.problem.structure.zero == 0.0:
        return _slipped(fitted)
    found = _slipped(as_autoregression(fitted))
    theta = fitted.fit.theta.copy()
    at = fitted.problem.eta_at
    theta[at : at + 2] = found.actuator
    moved = _at(replace(fitted, problem=replace(fitted.problem, family=found.problem.family)), theta)
    return min(fitted, moved, key=lambda one: one.fit.cost)


def _slipped(fitted: Fitted) -> Fitted:
    for step in range(ROUNDS):
        better = min(_better(fitted, wide=step == 0), key=lambda one: one.fit.cost, default=None)
        if better is None or not better.fit.cost < fitted.fit.cost:
            break
        gained = 0.5 * fitted.problem.errors * float(np.log(fitted.fit.cost / max(better.fit.cost, 1e-300)))
        fitted = better
        if gained < WORTH:
            break
    return _centred(_settled(fitted))


def _settled(fitted: Fitted) -> Fitted:
    """First positions and half difference of band and jump by turns: within a pattern both are smooth."""
    for _ in range(REPEATS):
        before = fitted.fit.cost
        fitted = rested(_centred(fitted), FINE_RESTS)
        fitted = replace(fitted, fit=refine(fitted.problem, fitted.fit.theta, fitted.basis))
        if fitted.fit.cost > (1.0 - SMALL) * before:
            break
    return fitted


def _centred(fitted: Fitted) -> Fitted:
    """The same fit with band and jump in the middle of those that it cannot tell apart."""
    here = _here(_likelihood(fitted))
    middle = replace(here, behind=0.5 * float(fitted.actuator[0] - fitted.actuator[1])).eta
    theta = fitted.fit.theta.copy()
    theta[fitted.problem.eta_at : fitted.problem.eta_at + 2] = middle
    cost, _, hessian = fitted.problem.evaluate(theta)
    if cost <= fitted.fit.cost * (1.0 + ROUNDING):
        fitted = replace(fitted, fit=replace(fitted.fit, theta=theta, cost=cost, hessian=hessian))
    return replace(fitted, fit=replace(fitted.fit, converged=True))


def slip_intervals(fitted: Fitted) -> Intervals:
    """95 % intervals of band and jump (scaled): all patterns about the best that the record does not reject.

    Of a valve that turns often enough (``turns_seen``).
    """
    likelihood = _likelihood(fitted)
    accepted = list(_accepted(likelihood, _here(likelihood)))
    best = min(one.loss for one in accepted)
    drop = best + threshold_drop(LEVEL)
    kept = [(one, *one.reach(drop)) for one in accepted if one.loss <= drop]
    bands = [one.bands_at(least, most) for one, least, most in kept]
    jumps = [one.jumps_at(least, most) for one, least, most in kept]
    band, jump = fitted.actuator.tolist()
    return {"band": _hull([*bands, (band, band)]), "jump": _hull([*jumps, (jump, jump)])}


def turns_seen(fitted: Fitted) -> bool:
    """Whether the valve turns often enough for its band to be seen."""
    return bool(np.isfinite(_here(_likelihood(fitted)).loss))


def threshold_drop(level: float) -> float:
    """How far the log-likelihood falls from its maximum to the ends of an interval for a threshold.

    Band and jump are thresholds: the likelihood is a random walk from slip to slip, not a parabola, and its ratio has
    the distribution (1 - exp(-x / 2))^2, not chi-squared (Hansen, 2000, Econometrica 68, 575-603, theorem 2): 3.68 for
    95 %, where a parabola would ask for 1.92.
    """
    return -float(np.log1p(-np.sqrt(level)))


def _hull(parts: list[tuple[float, float]]) -> tuple[float, float]:
    lows, highs = zip(*(part for part in parts if part[0] <= part[1]), strict=True)
    return max(float(min(lows)), 0.0), float(max(highs))


def _better(fitted: Fitted, wide: bool) -> Iterator[Fitted]:
    """What is found from a fit with its own model, and at first with the other one."""
    family = own(fitted.problem.family)
    likelihood = _likelihood(fitted)
    best = _searched(likelihood, _here(likelihood), (*WIDE, *CLOSE) if wide else CLOSE)
    if best.loss < -WORTH:
        yield _refined(fitted, replace(family, rests=best.rests), best)
    if wide:
        other = _likelihood(fitted, family.as_other().code)
        rival = _searched(other, _here(other), CLOSE)
        if rival.loss < min(best.loss, 0.0) + OTHER:
            rival = _searched(other, rival, (*WIDE, *CLOSE))
        if rival.loss < min(best.loss, 0.0) - WORTH:
            yield _refined(fitted, replace(family.as_other(), rests=rival.rests), rival)


def _refined(fitted: Fitted, family: Family, place: Pattern) -> Fitted:
    """Everything refined at a place, first with the valve held."""
    problem = replace(fitted.problem, family=family)
    theta = fitted.fit.theta.copy()
    at = problem.eta_at
    theta[at : at + 2] = place.eta
    return _at(replace(fitted, problem=problem), theta)


def _at(fitted: Fitted, theta: FloatArray) -> Fitted:
    """Refined from a vector, first with the valve held."""
    problem = fitted.problem
    first = refine(problem, theta, problem.free_but(problem.own, fitted.basis), most_steps=STEPS, tied=True)
    return replace(fitted, fit=refine(problem, first.theta, fitted.basis))


def _likelihood(fitted: Fitted, model: int | None = None) -> SlipLikelihood:
    family = own(fitted.problem.family)
    fitted = shortened(as_autoregression(fitted), MOST_ROWS)
    return SlipLikelihood(fitted, family.code if model is None else model, family.widest, LARGEST_JUMP)


def _here(likelihood: SlipLikelihood) -> Pattern:
    """The pattern of the fit itself."""
    fitted = likelihood.fitted
    family = fitted.problem.family
    rests = (*family.rests, *[0.0] * (family.resting - len(family.rests)))
    band, jump = fitted.actuator.tolist()
    return likelihood.at(band, jump, tuple(rests))


def _searched(likelihood: SlipLikelihood, best: Pattern, boxes: tuple[tuple[float, int], ...]) -> Pattern:
    """The best of scans and boxes about a pattern, wider ones first."""
    best = _least(best, [_scans(likelihood, best, min(boxes[0][0] / WIDE[0][0], 1.0)).best])
    for reach, number in boxes:
        best = _least(best, [_box(likelihood, best, reach, number).best])
    best = _least(best, [_scans(likelihood, best, 0.1).best])
    for _ in range(HOPS):
        after = _least(best, _next_to(likelihood, best))
        if after is best:
            break
        best = after
    return best


def _least(best: Pattern, others: Iterable[Pattern]) -> Pattern:
    return min([best, *others], key=lambda one: one.loss)


def _box(likelihood: SlipLikelihood, middle: Pattern, reach: float, number: int) -> Patterns:
    """Patterns of places about another."""
    (band, jump), (by_band, by_jump, by_rest) = middle.eta.tolist(), even_draws(number).T
    bands, jumps = band * (1.0 + reach * by_band), np.maximum(jump + JUMP_REACH * reach * band * by_jump, 0.0)
    rests = np.array(middle.rests) + REST_REACH * reach * by_rest[:, None]
    return likelihood.patterns(np.column_stack([bands, jumps]), np.clip(rests, -1.0, 1.0))


def _scans(likelihood: SlipLikelihood, middle: Pattern, share: float) -> Patterns:
    """Patterns of places that differ in one parameter, up to a share of the range of a scan."""
    band, jump = middle.eta.tolist()
    steps = share * np.linspace(-1.0, 1.0, SCAN)
    etas = [np.column_stack([band * (1.0 + SCAN_BANDS * steps), np.full(SCAN, jump)])]
    etas += [np.column_stack([np.full(SCAN, band), np.maximum(jump + 0.5 * SCAN_SHARES * band * steps, 0.0)])]
    begun = [np.tile(np.array(middle.rests), (2 * SCAN, 1))]
    for index, rest in enumerate(middle.rests):
        moves = np.clip(rest + SCAN_RESTS * steps, -1.0, 1.0).tolist()
        if share == 1.0:
            moves = likelihood.first_rests(band, jump, index, SCAN)
        trials = np.tile(np.array(middle.rests), (len(moves), 1))
        trials[:, index] = moves
        etas.append(np.tile([band, jump], (len(moves), 1)))
        begun.append(trials)
    return likelihood.patterns(np.concatenate(etas), np.concatenate(begun))


def _inside(value: float, sides: tuple[float, float]) -> float:
    """The nearest value well between the sides."""
    margin = EDGE * (sides[1] - sides[0])
    return min(max(value, sides[0] + margin), sides[1] - margin)


def _accepted(likelihood: SlipLikelihood, best: Pattern) -> Iterator[Pattern]:
    """Patterns that hang together with the best, best first, while they are not far behind it."""
    drop = threshold_drop(LEVEL) + MARGIN
    queue: list[tuple[float, int, Pattern]] = []
    seen: set[tuple[object, ...]] = set()
    count = 0

    def meet(others: Iterable[Pattern]) -> None:
        nonlocal count
        for other in others:
            count += 1
            if _key(other) not in seen:
                seen.add(_key(other))
                heapq.heappush(queue, (other.loss, count, other))

    meet([best])
    for reach, number in NEIGHBOURHOOD:
        meet(_box(likelihood, best, reach, number))
    least = best.loss
    while queue:
        loss, _, one = heapq.heappop(queue)
        least = min(least, loss)
        if loss > least + drop:
            break
        yield one
        if count < MOST_PATTERNS:
            meet(_next_to(likelihood, one))


def _key(one: Pattern) -> tuple[object, ...]:
    return one.bands, one.jumps, one.firsts


def _next_to(likelihood: SlipLikelihood, one: Pattern) -> Iterator[Pattern]:
    """The patterns beyond each side of a rectangle, and with the first slip in another row."""
    band, jump = one.eta.tolist()
    for other in (one.bands[0] * (1.0 - NUDGE), one.bands[1] * (1.0 + NUDGE)):
        if 0.0 < other < likelihood.widest:
            for jumps in {_inside(other - 2.0 * one.behind, one.jumps), _inside(jump, one.jumps)}:
                yield likelihood.at(other, jumps, one.rests)
    for other in (one.jumps[0] * (1.0 - NUDGE), one.jumps[1] * (1.0 + NUDGE)):
        if 0.0 < other < likelihood.largest * band:
            for bands in {_inside(other + 2.0 * one.behind, one.bands), _inside(band, one.bands)}:
                yield likelihood.at(bands, other, one.rests)
    for index, rest in enumerate(one.rests):
        others = likelihood.first_rests(band, jump, index, MOST_PATTERNS)
        below = max((other for other in others if other < rest - NUDGE), default=rest)
        above = min((other for other in others if other > rest + NUDGE), default=rest)
        for moved in {below, above} - {rest}:
            yield likelihood.at(band, jump, (*one.rests[:index], moved, *one.rests[index + 1 :]))
