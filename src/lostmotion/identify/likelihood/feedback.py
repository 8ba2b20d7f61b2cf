"""Does OP answer PV, and does anything else move it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import f_tail
from lostmotion.identify.likelihood.arx_gram import Lags, arx_products
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData, Signals
from lostmotion.kernels.products import factorise
from lostmotion.kernels.triangular import triangular

LAGS = 10  # past rows of OP and PV: a PI controller needs two, a filter in front of it a few more
LEVEL = 1e-4  # of the test whether OP answers PV
RESTS, LEAST_MOVE = 0.5, 0.02  # share of moves of PV at which OP rests, and of the range of OP that a move takes then
HELD = 0.97  # share of rows at which OP rests in a test: thirty rows and more at a level
# share of the moves of OP which PV explains, beside OP itself: of 6 tests at most 0.01; of 12 controllers that hold OP
# within a dead band or until a whole step of it is due 0.65 to 0.82 (loops of benchmarks/other_simulation.py)
ANSWERED, FEWEST_MOVES = 0.25, 30
BY_CHANCE, PAST = 0.05, 2  # that PV of so many rows before the moves tells as much of them
SURE = 8.0  # standard errors of a gain of the controller, from which on its sign is known
SURE_BY_SP = 5.0  # the same of its answer to SP, which is not weighed against that to PV then
LARGEST_CONDITION = 1e12  # above it the moves of PV and PV itself are one column to double precision
NORMAL = 1e-7  # share of the variance of OP, of which sums of products still tell seven digits
ROUNDING = 1e-15


@dataclass(frozen=True)
class Feedback:
    """How OP depends on PV.

    Attributes
    ----------
    closed : bool
        Past PV help to foretell OP beyond its own past (Granger's test), so a controller is at work; OP is not set
        by hand, that is at rest mostly while PV moves, and moved far where it moves.
    free : float
        Share of the variance of the moves of OP that past OP and PV up to now do not explain: set-point moves,
        operators, noise of the controller. At 0 a linear process cannot be told from the controller's inverse.
    direction : int
        Sign of the answer of OP to PV: by moves of the set point where they tell it, else that of a proportional and an
        integral part both; 0 where it is not sure.
    """

    closed: bool
    free: float
    direction: int = 0


@remembered
def feedback(data: ScaledData) -> Feedback:
    """Test for feedback from PV to OP with linear regressions of OP on ten past samples of both."""
    closed, free = _answered(data)
    return Feedback(closed, free, _direction(data) if closed else 0)


@remembered
def _answered(signals: Signals) -> tuple[bool, float]:
    """Whether the loop is closed, and the free share of the moves of OP."""
    u, y = signals.u, signals.y
    long = [(start, stop) for start, stop in signals.segments.tolist() if stop - start >= 4 * LAGS]
    samples = sum(stop - start - LAGS for start, stop in long)
    free = samples - 2 * LAGS - 2
    if free < LAGS:
        return True, 1.0
    alone, both = _left_over(ScaledData(y, u, np.array(long)))
    ratio = (alone - both) / (LAGS + 1) / max(both / free, 1e-300)
    closed = bool(f_tail(ratio, LAGS + 1, free) < LEVEL) and not _by_hand(signals)
    variance = sum(float(np.sum(np.diff(u[start + LAGS - 1 : stop]) ** 2)) for start, stop in long)
    return closed, min(both / variance, 1.0) if variance > 0 else 1.0


def held_by_hand(signals: Signals) -> bool:
    """Whether OP hardly ever moves, and no controller moves it: a test."""
    moves = np.concatenate([np.diff(signals.u[start:stop]) for start, stop in signals.segments.tolist()])
    return float(np.mean(moves == 0.0)) > HELD and not _answered(signals)[0]


def _left_over(turned: ScaledData) -> tuple[float, float]:
    """Sums of squares of OP that its own past leaves over, and that the past of both and PV now do.

    `turned` has PV as input and OP as output. Of sums of products nothing is left where a regression is nearly exact;
    there the rows themselves are brought to triangular form.
    """
    gram, target, total, samples = arx_products(turned.u, turned, Lags(LAGS, LAGS + 1, 0))
    around_mean = total - target[0] ** 2 / samples
    scale = np.sqrt(np.maximum(np.diag(gram), 0.0))  # rounding may leave less than 0
    scale[scale == 0.0] = 1.0
    gram, target = gram / np.outer(scale, scale), target / scale
    whole = gram.copy(), target.copy()
    alone = total - factorise(np.ascontiguousarray(gram[: LAGS + 1, : LAGS + 1]), target[: LAGS + 1].copy())
    both = total - factorise(*whole)
    if min(alone, both) > NORMAL * around_mean:
        return alone, both
    errors = _triangular(turned)[:, -1] ** 2
    return float(errors[LAGS + 1 :].sum()), float(errors[-1])


def _triangular(turned: ScaledData) -> FloatArray:
    """R of 1, past OP, PV now and past, and OP."""

    def rows(start: int, stop: int) -> FloatArray:
        now = np.arange(start, stop)[:, None]
        past = turned.y[now - np.arange(1, LAGS + 1)]
        return np.hstack([np.ones(now.shape), past, turned.u[now - np.arange(LAGS + 1)], turned.y[now]])

    spans = [(start + LAGS, stop) for start, stop in turned.segments.tolist()]
    return triangular(rows, spans, 2 * LAGS + 3)


def _direction(data: ScaledData) -> int:
    """Sign of the answer of OP to PV: by moves of SP where they are sure, else by PV."""
    return int(np.sign(data.against_pv)) if abs(data.against_pv) > SURE_BY_SP else _direction_by_pv(data)


def _direction_by_pv(signals: Signals) -> int:
    """Sign of kp and ki in du = kp dy + ki y + constant, where both are sure and agree, or one is sure."""
    gram, cross, moved, samples = np.zeros((3, 3)), np.zeros(3), 0.0, 0
    for start, stop in signals.segments.tolist():
        du, dy, now = np.diff(signals.u[start:stop]), np.diff(signals.y[start:stop]), signals.y[start + 1 : stop]
        columns = (dy, now, np.ones(now.size))
        gram += [[first @ second for second in columns] for first in columns]
        cross += [column @ du for column in columns]
        moved, samples = moved + float(du @ du), samples + now.size
    if np.linalg.cond(gram) > LARGEST_CONDITION:
        return 0
    gains = np.linalg.solve(gram, cross)
    left = max(moved - float(gains @ cross), ROUNDING * moved)
    errors = np.sqrt(left / max(samples - 3, 1) * np.diag(np.linalg.inv(gram)))
    sure = np.sign(gains[:2]) * (np.abs(gains[:2]) > SURE * errors[:2])
    return int(np.sign(sure.sum())) if abs(sure.sum()) == np.abs(sure).sum() else 0


def _by_hand(signals: Signals) -> bool:
    """Whether OP goes by steps that no controller takes; where OP rests at its ends it may be at a limit."""
    u, y, segments = signals.u, signals.y, signals.segments
    inner = (u > u.min()) & (u < u.max())
    moves = [(np.diff(u[a:b])[inner[a : b - 1]], np.diff(y[a:b])[inner[a : b - 1]]) for a, b in segments]
    of_op, of_pv = (np.concatenate(parts) for parts in zip(*moves, strict=True))
    answered, moved = of_op[of_pv != 0.0], np.abs(of_op[of_op != 0.0])
    if not answered.size or not moved.size:
        return False
    rests = float(np.mean(answered == 0.0)) > RESTS
    return rests and float(np.median(moved)) > LEAST_MOVE * float(np.ptp(u)) and not _answers(signals)


def _answers(signals: Signals) -> bool:
    """Whether PV says how far OP moves where it moves: a controller with a dead band, or with an output in steps.

    Before the move already: in the same row a fast process may have answered it (five of twelve records of motors).
    """
    u, y = signals.u, signals.y
    now = np.concatenate([np.arange(start + 2, stop) for start, stop in signals.segments.tolist()])
    now = now[(u[now] != u[now - 1]) & (u[now] > u.min()) & (u[now] < u.max())]
    if now.size < FEWEST_MOVES:
        return False
    moves, before = u[now] - u[now - 1], np.column_stack([np.ones(now.size), u[now - 1]])
    alone, past, both = (
        float(np.sum((moves - columns @ np.linalg.lstsq(columns, moves, rcond=None)[0]) ** 2))
        for columns in (
            before,
            np.column_stack([before, y[now - 1], y[now - 2]]),
            np.column_stack([before, y[now], y[now - 1]]),
        )
    )
    free = now.size - before.shape[1] - PAST
    by_chance = f_tail((alone - past) / PAST / max(past / free, 1e-300), PAST, free)
    return bool(both < (1.0 - ANSWERED) * alone and by_chance < BY_CHANCE)
